//! The cells of all particles.

use super::cell::{Bound, Cell, FAR, Facet, Shape, wall_of};
use super::notch::{Line, Lines};
use super::polygon::{self, Corner, Plane, Polygon, WALL};
use crate::grid::Grid;
use crate::parallel::{self, Lists};
use crate::walls::{Attachment, FIXED, Walls};
use nalgebra::{Matrix2, Vector2};
use rayon::prelude::*;

/// Half-width in spacings of the box that a cell starts from: it lies in empty space.
const BOX: f64 = FAR;
/// Share of a spacing below which a facet is dropped: touching corners of a square lattice.
const SLACK: f64 = 1e-9;
/// Distance in front of its wall, in spacings, from which a particle nearer or behind looks around.
const LEAST_IN_FRONT: f64 = 0.02;
/// Distance in spacings up to which neighbours are looked for first.
const NEAR: f64 = 1.7;
/// Largest number of neighbours that cut one cell.
const NEAREST: usize = 48;

/// A facet on a wall with the place of its middle on the wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallFacet {
    /// The facet.
    pub facet: Facet,
    /// Moving panel, or `FIXED`.
    pub panel: u32,
    /// Place on it, 0 to 1.
    pub fraction: f64,
    /// Whether it only closes a cell where another one sees less of their facet: it moves with the particle and loads
    /// nothing.
    pub filler: bool,
}

/// The cells of all particles at one instant.
#[derive(Debug, Clone, Default)]
pub struct Cells {
    /// Search grid.
    pub grid: Grid,
    /// Facets between particles.
    pub facets: Lists<Facet>,
    /// Facets on walls.
    pub walls: Lists<WallFacet>,
    /// One cell per particle.
    pub cells: Vec<Cell>,
    agreed: Lists<Facet>,
    agreed_walls: Lists<WallFacet>,
    odd: Vec<bool>,
    corners: Lists<Corner>,
    planes: Lists<WallPlane>,
    room: Vec<f64>,
    depths: Vec<f64>,
}

/// The plane of a wall that cuts a cell.
#[derive(Debug, Clone, Copy)]
struct WallPlane {
    plane: Plane,
    segment: u32,
}

/// What cells depend on.
#[derive(Clone, Copy)]
pub struct Setup<'a> {
    /// Positions \[m\].
    pub positions: &'a [Vector2<f64>],
    /// Areas that particles own \[m2\].
    pub volumes: &'a [f64],
    /// Walls near particles.
    pub attachments: &'a Lists<Attachment>,
    /// Walls.
    pub walls: &'a Walls,
    /// Particle spacing \[m\].
    pub spacing: f64,
}

impl Cells {
    /// Reach of a cell \[m\]: walls farther away than this, and particles farther than twice this, do not bound it.
    pub fn reach(spacing: f64) -> f64 {
        BOX * spacing
    }

    /// Whether a particle touches no other: it flies freely, and walls stop it as they stop a point.
    pub fn is_lone(&self, i: usize) -> bool {
        self.facets.of(i).is_empty()
    }

    /// Facets of cell i to particles, then those on walls.
    pub fn facets_and_walls(&self, i: usize) -> impl Iterator<Item = &Facet> {
        self.facets.of(i).iter().chain(self.walls.of(i).iter().map(|wall| &wall.facet))
    }

    /// Builds all cells.
    pub fn build(&mut self, setup: &Setup) {
        let count = setup.positions.len();
        self.grid.build(setup.positions, NEAR * setup.spacing);
        self.room.resize(count, 0.0);
        let grid = &self.grid;
        self.corners.build_with(count, &mut self.planes, &mut self.room, |i, corners, planes, room| {
            let begin = corners.len();
            take_out_solids(setup, i, &mut cut_out(setup, grid, i), corners, planes);
            *room = polygon::area(&corners[begin..]) / setup.volumes[i];
        });
        self.bound_cells(setup);
        self.depths.resize(count, 0.0);
        let (cells, facets) = (&self.cells, &mut self.facets);
        parallel::fill(&mut self.depths, |i| cells[i].depth);
        let depths = &self.depths;
        facets.change(|i, facet| {
            if facet.bound != Bound::Whole {
                facet.end_at(0.5 * (depths[i] + depths[facet.neighbour as usize]));
            }
        });
        self.agree(setup);
        self.close_surfaces(setup);
    }

    /// Lets two cells have the same facet between them where a wall cuts them differently, or rounding decided whether
    /// a corner lies in empty space: the matrix is symmetric, and what one cell gives the other takes. What only one of
    /// them sees becomes a piece of wall, so that cells stay closed; an open cell counts it to its free surface.
    fn agree(&mut self, setup: &Setup) {
        let (seen, walls, cells) = (&self.facets, &self.walls, &mut self.cells);
        self.odd.clear();
        self.odd.extend(cells.iter().map(|cell| cell.odd));
        let odd = &self.odd;
        self.agreed.build_with(setup.positions.len(), &mut self.agreed_walls, cells, |i, out, out_walls, cell| {
            out_walls.extend_from_slice(walls.of(i));
            for facet in seen.of(i) {
                let j = facet.neighbour as usize;
                if !(odd[i] || odd[j]) {
                    out.push(*facet);
                    continue;
                }
                let begin = out.len();
                let of_pair = seen.of(j).iter().filter(|other| other.neighbour as usize == i);
                out.extend(of_pair.filter_map(|other| facet.common(other)));
                if cell.is_open() {
                    continue;
                }
                out[begin..].sort_by(|a, b| a.from.total_cmp(&b.from));
                let mut from = facet.from;
                for (to, next) in out[begin..].iter().map(|part| (part.from, part.to)).chain([(facet.to, facet.to)]) {
                    if to - from > SLACK * setup.spacing {
                        let rest = Facet { from, to, ..*facet };
                        out_walls.push(WallFacet { facet: rest, panel: FIXED, fraction: 0.0, filler: true });
                    }
                    from = next;
                }
            }
        });
        std::mem::swap(&mut self.facets, &mut self.agreed);
        std::mem::swap(&mut self.walls, &mut self.agreed_walls);
    }

    /// Facets and cells from the polygons.
    fn bound_cells(&mut self, setup: &Setup) {
        let count = setup.positions.len();
        self.cells.resize(count, Cell::default());
        let (polygons, planes, room) = (&self.corners, &self.planes, &self.room);
        let fullness = |i: usize, label: u32| match label {
            polygon::BOX => room[i],
            label if (label as usize) < count => room[label as usize],
            _ => 0.0,
        };
        self.facets.build_with(count, &mut self.walls, &mut self.cells, |i, facets, wall_facets, cell| {
            let own = planes.of(i);
            let plane_of = |label: u32| match wall_of(label, own.len()) {
                Some(k) => own[k].plane,
                None if (label as usize) < count => plane_to(setup, i, label),
                None => Plane { normal: Vector2::zeros(), distance: 0.0 },
            };
            let room_of = |label: u32| fullness(i, label);
            let shape =
                Shape { corners: polygons.of(i), planes: &plane_of, fullness: &room_of, spacing: setup.spacing };
            let add = |facet: Facet| match wall_of(facet.neighbour, own.len()) {
                Some(k) => wall_facets.push(place_on_wall(setup, i, facet, own[k].segment)),
                None => facets.push(facet),
            };
            *cell = if shape.is_open() { shape.surface(setup.volumes[i], add) } else { shape.close(add) };
            cell.odd = shape.is_odd(own.len());
        });
    }

    /// What the free surfaces of cells add up to, from the facets that bound the rest.
    fn close_surfaces(&mut self, setup: &Setup) {
        let (facets, walls) = (&self.facets, &self.walls);
        self.cells.par_iter_mut().with_min_len(parallel::CHUNK).enumerate().for_each(|(i, cell)| {
            if !cell.is_open() {
                return;
            }
            let (mut closed, mut moment) = (Vector2::zeros(), Matrix2::zeros());
            for facet in facets.of(i).iter().chain(walls.of(i).iter().map(|wall| &wall.facet)) {
                let normal = facet.normal * facet.length();
                closed += normal;
                moment += facet.middle() * normal.transpose();
            }
            cell.outward = -closed;
            let rest = Matrix2::identity() * setup.volumes[i] - moment;
            let exact = rest * cell.outward / (cell.surface * cell.depth);
            cell.lift = cell.outward + (exact - cell.outward) * cell.flatness();
        });
    }
}

/// Takes the solids near particle i out of its polygon. Appends the corners of what remains, and a plane for every wall
/// that may be an edge of it.
fn take_out_solids(
    setup: &Setup,
    i: usize,
    polygon: &mut Polygon,
    corners: &mut Vec<Corner>,
    planes: &mut Vec<WallPlane>,
) {
    let (walls, spacing) = (setup.walls, setup.spacing);
    let here = setup.positions[i];
    let reach = polygon.squared_reach();
    let near = |segment: &&u32| walls.segments[**segment as usize].squared_distance(&here) < reach;
    let begin = planes.len();
    let mut walls_near = walls.candidates(&here).iter().filter(near).peekable();
    if walls_near.peek().is_none() {
        corners.extend_from_slice(polygon.corners());
        return;
    }
    let mut lines = Lines::of(polygon.corners(), spacing);
    for &index in walls_near {
        let wall = &walls.segments[index as usize];
        let label = WALL - (planes.len() - begin) as u32;
        let line = Line { start: wall.start - here, tangent: wall.tangent, length: wall.length, label };
        if lines.add_wall(line) {
            let plane = Plane { normal: wall.normal, distance: wall.local(&here).0 };
            planes.push(WallPlane { plane, segment: index });
        }
    }
    // A particle behind its wall sees what one just in front of it would.
    let least = LEAST_IN_FRONT * spacing;
    let own = || setup.attachments.of(i).iter().filter(|entry| walls.is_beside(entry));
    let behind = own().filter(|entry| entry.distance < least);
    let inside = behind.fold(Vector2::zeros(), |place, entry| place - entry.normal * (least - entry.distance));
    if lines.walk(&inside, corners) {
        return;
    }
    planes.truncate(begin);
    for (k, entry) in own().enumerate() {
        let plane = Plane { normal: entry.normal, distance: entry.distance.max(least) };
        planes.push(WallPlane { plane, segment: entry.segment });
        polygon.cut(&plane, WALL - k as u32, SLACK * spacing);
    }
    corners.extend_from_slice(polygon.corners());
}

/// The part of the box around a particle that is nearer to it than to any other that it sees.
fn cut_out(setup: &Setup, grid: &Grid, i: usize) -> Polygon {
    let spacing = setup.spacing;
    let here = setup.positions[i];
    let mut polygon = Polygon::square(BOX * spacing);
    let slack = SLACK * spacing;
    let near_wall = !setup.walls.candidates(&here).is_empty();
    let mut reach = polygon.squared_reach();
    let mut nearest = [(0.0, 0u32); NEAREST];
    // Most cells are finished by the nearest neighbours; only cells at surfaces and voids look farther.
    for (rings, from, to) in [(1, 0.0, NEAR), (2, NEAR, 2.0 * BOX)] {
        let (from, to) = ((from * spacing).powi(2), (to * spacing).powi(2));
        if from > 4.0 * reach {
            break;
        }
        let mut found = 0;
        grid.for_each_within(&here, rings, |j| {
            let squared = (setup.positions[j] - here).norm_squared();
            let outside = squared >= to || squared < from || j == i;
            let hidden = || near_wall && setup.walls.hides(&here, &setup.positions[j]);
            if !outside && !hidden() {
                insert(&mut nearest, &mut found, (squared, j as u32));
            }
        });
        for &(squared, j) in &nearest[..found] {
            if squared > 4.0 * reach {
                break;
            }
            if polygon.cut(&plane_to(setup, i, j), j, slack) {
                reach = polygon.squared_reach();
            }
        }
    }
    polygon
}

/// Bisector between two particles. Coinciding particles part along x.
#[inline]
fn plane_to(setup: &Setup, i: usize, j: u32) -> Plane {
    let between = setup.positions[j as usize] - setup.positions[i];
    let distance = between.norm();
    if distance < 1e-9 * setup.spacing {
        let normal = Vector2::new(if (i as u32) < j { 1.0 } else { -1.0 }, 0.0);
        return Plane { normal, distance: 1e-9 * setup.spacing };
    }
    Plane { normal: between / distance, distance: 0.5 * distance }
}

/// Keeps the nearest in ascending order; equal distances in the order of particles.
#[inline]
fn insert(nearest: &mut [(f64, u32); NEAREST], found: &mut usize, entry: (f64, u32)) {
    let mut at = (*found).min(NEAREST - 1);
    if *found == NEAREST && entry >= nearest[at] {
        return;
    }
    while at > 0 && nearest[at - 1] > entry {
        nearest[at] = nearest[at - 1];
        at -= 1;
    }
    nearest[at] = entry;
    *found = (*found + 1).min(NEAREST);
}

/// Where on its wall a facet lies.
fn place_on_wall(setup: &Setup, i: usize, facet: Facet, segment: u32) -> WallFacet {
    let segment = &setup.walls.segments[segment as usize];
    let place = setup.positions[i] + facet.middle();
    let fraction = (segment.local(&place).1 / segment.length).clamp(0.0, 1.0);
    WallFacet { facet, panel: segment.panel, fraction, filler: false }
}
