//! What of the room around a particle is nearer to it than to any other that it sees, and in front of the walls.

use super::cell::Cell;
use super::cells::{SLACK, Setup, WallPlane};
use super::facet::{Facet, turn};
use super::neighbour_lanes::NeighbourLanes;
use super::polygon::{self, Corner, Plane, Polygon, Ring, WALL};
use super::shape::{FAR, INTERIOR, OPEN};
use super::wall_clip::{Line, WallClipper};
use crate::grid::Grid;
use crate::parallel::{CHUNK, Lists, Writer};
use nalgebra::Vector2;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

/// Half-width in spacings of the box that a cell starts from: it lies in empty space.
const BOX: f64 = FAR;
/// Distance in front of its wall, in spacings, from which a particle nearer or behind looks around.
const LEAST_IN_FRONT: f64 = 0.02;
/// Size of the cells of the search grid in spacings.
pub const GRID: f64 = 1.0;
/// Cells around its own in which a particle looks for neighbours first, and how far that lets it see, in spacings.
const RINGS: i64 = 2;
const NEAR: f64 = RINGS as f64 * GRID;
/// Cells in which it looks where these do not close its cell.
const ALL_RINGS: i64 = (2.0 * BOX / GRID).ceil() as i64;

/// What is cut out, list by list.
pub struct CellBuffers<'a> {
    /// Facets of cells that no wall and no empty space can touch.
    pub facets: &'a mut Lists<Facet>,
    /// Outlines of the other cells.
    pub corners: &'a mut Lists<Corner>,
    /// Planes of the walls that may be edges of these.
    pub planes: &'a mut Lists<WallPlane>,
    /// Area of each outline over the particle's own.
    pub relative_area: &'a mut [f64],
    /// Cells, as far as they are known already.
    pub cells: &'a mut [Cell],
}

/// Cuts the cells of all particles out of their surroundings.
pub fn tessellate(setup: &Setup, grid: &Grid, buffers: CellBuffers) {
    let CellBuffers { facets, corners, planes, relative_area, cells } = buffers;
    let count = setup.positions.len();
    let lists = (facets.writers(count), corners.writers(count), planes.writers(count));
    let values = (relative_area.par_chunks_mut(CHUNK), cells.par_chunks_mut(CHUNK));
    let chunks = (lists.0, lists.1, lists.2, values.0, values.1).into_par_iter().enumerate();
    chunks.for_each_init(
        NeighbourLanes::default,
        |around, (chunk, (facets, corners, planes, relative_area, cells))| {
            let lists = (facets, corners, planes);
            Arch::new().dispatch(Tessellation {
                setup,
                grid,
                around,
                first: chunk * CHUNK,
                lists,
                relative_area,
                cells,
            });
        },
    );
}

/// The cells of one chunk of particles.
struct Tessellation<'a, 'b> {
    setup: &'a Setup<'b>,
    grid: &'a Grid,
    around: &'a mut NeighbourLanes,
    first: usize,
    lists: (Writer<'a, Facet>, Writer<'a, Corner>, Writer<'a, WallPlane>),
    relative_area: &'a mut [f64],
    cells: &'a mut [Cell],
}

impl WithSimd for Tessellation<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { setup, grid, around, first, lists: (mut facets, mut corners, mut planes), relative_area, cells } =
            self;
        for (k, (relative_area, cell)) in relative_area.iter_mut().zip(cells).enumerate() {
            let i = first + k;
            let here = setup.positions[i];
            let walls = setup.walls.candidates(&here);
            let distances = walls.iter().map(|&wall| setup.walls.segments[wall as usize].squared_distance(&here));
            let nearest_wall = distances.fold(f64::INFINITY, f64::min);
            let view = View { setup, grid, i, here, walls, nearest_wall };
            *cell = cut_one(simd, &view, around, facets.items, corners.items, planes.items);
            *relative_area = cell.area / setup.areas[i];
            facets.end();
            corners.end();
            planes.end();
        }
    }
}

/// One particle and what it looks at.
struct View<'a, 'b> {
    setup: &'a Setup<'b>,
    grid: &'a Grid,
    i: usize,
    here: Vector2<f64>,
    /// Walls that may be near, and the squared distance of the nearest \[m2\].
    walls: &'a [u32],
    nearest_wall: f64,
}

/// One cell: with its facets where these are sure to be seen alike from both sides, with its outline elsewhere.
#[inline(always)]
fn cut_one<S: Simd>(
    simd: S,
    view: &View,
    around: &mut NeighbourLanes,
    facets: &mut Vec<Facet>,
    corners: &mut Vec<Corner>,
    planes: &mut Vec<WallPlane>,
) -> Cell {
    let begin = corners.len();
    let reach = surround(simd, view, around, corners);
    let walls = view.nearest_wall < reach;
    if !walls && reach <= (INTERIOR * OPEN * view.setup.spacing).powi(2) {
        let cell = close(around, &corners[begin..], facets);
        corners.truncate(begin);
        return cell;
    }
    if walls {
        take_out_solids(view, reach, begin, corners, planes);
    }
    Cell { area: polygon::area(&corners[begin..]), asymmetric: true, ..Cell::default() }
}

/// The outline of the part of the box around a particle that is nearer to it than to any other that it sees, appended
/// to `corners`; returns its largest squared distance \[m2\].
#[inline(always)]
fn surround<S: Simd>(simd: S, view: &View, around: &mut NeighbourLanes, corners: &mut Vec<Corner>) -> f64 {
    let spacing = view.setup.spacing;
    let (slack, own) = (SLACK * spacing, view.i as u32);
    around.clear();
    gather(view, RINGS, [0.0, NEAR], around);
    let begin = corners.len();
    let reach = around.walk(simd, own, slack, corners);
    if 4.0 * reach <= (NEAR * spacing).powi(2) {
        return reach;
    }
    // Most cells are finished by the nearest neighbours; only cells at surfaces and voids look farther.
    around.put_box(BOX * spacing);
    gather(view, ALL_RINGS, [NEAR, 2.0 * BOX], around);
    corners.truncate(begin);
    around.walk(simd, own, slack, corners)
}

/// Adds the particles between two distances, in spacings, that no wall hides.
#[inline(always)]
fn gather(view: &View, rings: i64, distances: [f64; 2], around: &mut NeighbourLanes) {
    let View { setup, grid, i, here, walls, nearest_wall } = view;
    let first = around.count();
    let squares = distances.map(|distance| (distance * setup.spacing).powi(2));
    grid.for_each_row(
        here,
        rings,
        #[inline(always)]
        |row| around.put_row(here, *i as u32, &row, squares),
    );
    if *nearest_wall < squares[1] {
        around.retain(first, *nearest_wall, |j| !setup.walls.hide(walls, here, &setup.positions[j]));
    }
}

/// Facets and cell of a particle that has neighbours only.
#[inline(always)]
fn close(around: &NeighbourLanes, corners: &[Corner], facets: &mut Vec<Facet>) -> Cell {
    let mut outline = Ring::default();
    for (k, corner) in corners.iter().enumerate() {
        let next = if k + 1 == corners.len() { 0 } else { k + 1 };
        let (normal, height) = around.bisector(k);
        let along = turn(&normal);
        let (from, to) = (along.dot(&corner.place), along.dot(&corners[next].place));
        outline.walk(corner.place);
        facets.push(Facet::new(corner.label, normal, height, [from, to]));
    }
    let (area, centroid) = outline.close();
    Cell::closed(area, centroid)
}

/// Takes the solids near particle i out of its outline, the corners from `begin` on. Appends a plane for every wall
/// that may be an edge of what remains.
fn take_out_solids(view: &View, reach: f64, begin: usize, corners: &mut Vec<Corner>, planes: &mut Vec<WallPlane>) {
    let View { setup, i, here, .. } = view;
    let (walls, spacing) = (setup.walls, setup.spacing);
    let first_plane = planes.len();
    let mut lines = WallClipper::of(&corners[begin..], spacing);
    for &index in view.walls {
        let wall = &walls.segments[index as usize];
        if wall.squared_distance(here) >= reach {
            continue;
        }
        let label = WALL - (planes.len() - first_plane) as u32;
        let line = Line { start: wall.start - here, tangent: wall.tangent, length: wall.length, label };
        if lines.add_wall(line) {
            let plane = Plane { normal: wall.normal, distance: wall.local(here).0 };
            planes.push(WallPlane { plane, segment: index });
        }
    }
    // A particle behind its wall sees what one just in front of it would.
    let least = LEAST_IN_FRONT * spacing;
    let own = || setup.proximities.of(*i).iter().filter(|entry| walls.is_beside(entry));
    let behind = own().filter(|entry| entry.distance < least);
    let inside = behind.fold(Vector2::zeros(), |place, entry| place - entry.normal * (least - entry.distance));
    let mut polygon = Polygon::of(&corners[begin..]);
    corners.truncate(begin);
    if lines.walk(&inside, corners) {
        return;
    }
    planes.truncate(first_plane);
    for (k, entry) in own().enumerate() {
        let plane = Plane { normal: entry.normal, distance: entry.distance.max(least) };
        planes.push(WallPlane { plane, segment: entry.segment });
        polygon.cut(&plane, WALL - k as u32, SLACK * spacing);
    }
    corners.extend_from_slice(polygon.corners());
}
