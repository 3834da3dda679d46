//! The cells of all particles.

use super::cell::{Bound, Cell, Facet, Shape, wall_of};
use super::polygon::{self, Plane, Polygon, WALL};
use crate::grid::Grid;
use crate::parallel::{self, Lists};
use crate::walls::{Attachment, Walls};
use nalgebra::{Matrix2, Vector2};
use rayon::prelude::*;

/// Half-width in spacings of the box that a cell starts from: its corners lie in empty space.
const BOX: f64 = 1.4;
/// Share of a spacing below which a facet is dropped: touching corners of a square lattice.
const SLACK: f64 = 1e-9;
/// Ratio of |S| to the length of the surface at and below which the surface counts as round.
const ROUND: f64 = 0.8;
/// Largest number of wall planes that cut one cell.
const PLANES: usize = 8;
/// Largest number of neighbours that cut one cell.
const NEAREST: usize = 48;

/// A facet on a wall with the place of its middle on the wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallFacet {
    /// The facet.
    pub facet: Facet,
    /// Segment of the wall.
    pub segment: u32,
    /// Moving panel, or `FIXED`.
    pub panel: u32,
    /// Place on it, 0 to 1.
    pub fraction: f64,
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
    depths: Vec<f64>,
    room: Vec<f64>,
    polygons: Vec<Option<(Polygon, Cuts)>>,
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

    /// Builds all cells.
    pub fn build(&mut self, setup: &Setup) {
        let count = setup.positions.len();
        self.grid.build(setup.positions, 2.0 * Self::reach(setup.spacing));
        self.cells.resize(count, Cell::default());
        let grid = &self.grid;
        let mut room = std::mem::take(&mut self.room);
        room.resize(count, 0.0);
        self.polygons.resize(count, None);
        let mut polygons = std::mem::take(&mut self.polygons);
        let mut cells = std::mem::take(&mut self.cells);
        let mut wall_facets = std::mem::take(&mut self.walls);
        polygons.par_iter_mut().zip(&mut room).with_min_len(parallel::CHUNK).enumerate().for_each(|(i, (slot, room))| {
            let made = cut_out(setup, grid, i);
            *room = made.0.area() / setup.volumes[i];
            *slot = Some(made);
        });
        let room_of = &room;
        self.facets.build_with(count, &mut wall_facets, &mut cells, |i, facets, wall_facets, cell| {
            let Some((polygon, cuts)) = &polygons[i] else { return };
            *cell = make(setup, i, polygon, cuts, room_of, facets, wall_facets);
        });
        self.polygons = polygons;
        self.room = room;
        self.depths.resize(count, 0.0);
        parallel::fill(&mut self.depths, |i| cells[i].depth);
        let depths = &self.depths;
        self.facets.change(|i, facet| {
            if facet.bound != Bound::Whole {
                facet.end_at(0.5 * (depths[i] + depths[facet.neighbour as usize]));
            }
        });
        let (facets, walls) = (&self.facets, &wall_facets);
        cells.par_iter_mut().with_min_len(parallel::CHUNK).enumerate().for_each(|(i, cell)| {
            if cell.is_open() {
                let (mut closed, mut moment) = (Vector2::zeros(), Matrix2::zeros());
                let all = facets.of(i).iter().chain(walls.of(i).iter().map(|wall| &wall.facet));
                for facet in all {
                    let normal = facet.normal * facet.length();
                    closed += normal;
                    moment += facet.middle() * normal.transpose();
                }
                cell.outward = -closed;
                let rest = Matrix2::identity() * setup.volumes[i] - moment;
                let exact = rest * cell.outward / (cell.surface * cell.depth);
                let flatness = ((cell.outward.norm() / cell.surface - ROUND) / (1.0 - ROUND)).clamp(0.0, 1.0);
                cell.lift = cell.outward + (exact - cell.outward) * flatness;
            }
        });
        self.walls = wall_facets;
        self.cells = cells;
    }
}

#[derive(Debug, Clone, Copy)]
struct Cuts {
    planes: [Plane; PLANES],
    owners: [(u32, u32); PLANES],
    count: usize,
}

/// The planes of the walls near a particle: those that it stands beside, and a tangent plane at each corner of a solid
/// that it stands off.
fn wall_planes(setup: &Setup, i: usize) -> Cuts {
    let none = Plane { normal: Vector2::zeros(), distance: 0.0 };
    let mut cuts = Cuts { planes: [none; PLANES], owners: [(0, 0); PLANES], count: 0 };
    let mut push = |plane: Plane, entry: &Attachment| {
        if cuts.count < PLANES {
            cuts.planes[cuts.count] = plane;
            cuts.owners[cuts.count] = (entry.segment, entry.chain);
            cuts.count += 1;
        }
    };
    let walls = setup.walls;
    let least = 0.02 * setup.spacing;
    let own = setup.attachments.of(i);
    for entry in own.iter().filter(|entry| walls.is_beside(entry)) {
        push(Plane { normal: entry.normal, distance: entry.distance.max(least) }, entry);
    }
    for entry in own.iter().filter(|entry| !walls.is_beside(entry)) {
        let chain = &walls.chains[entry.chain as usize];
        let corner = if entry.arc < 0.0 {
            walls.segments[chain.first].start
        } else {
            walls.segments[chain.last - 1].end()
        };
        let to_corner = corner - setup.positions[i];
        let covered = own.iter().any(|other| {
            let line = &walls.segments[other.segment as usize];
            walls.is_beside(other) && line.normal.dot(&(corner - line.start)) > -1e-6 * setup.spacing
        });
        let distance = to_corner.norm();
        if !covered && distance < setup.walls.radius() && distance > least {
            push(Plane { normal: to_corner / distance, distance }, entry);
        }
    }
    cuts
}

fn cut_out(setup: &Setup, grid: &Grid, i: usize) -> (Polygon, Cuts) {
    let spacing = setup.spacing;
    let here = setup.positions[i];
    let mut polygon = Polygon::square(BOX * spacing);
    let cuts = wall_planes(setup, i);
    let slack = SLACK * spacing;
    for (k, plane) in cuts.planes[..cuts.count].iter().enumerate() {
        polygon.cut(plane, WALL - k as u32, slack);
    }
    let near_wall = !setup.walls.candidates(&here).is_empty();
    let mut nearest = [(0.0, 0u32); NEAREST];
    let mut found = 0;
    let limit = (2.0 * Cells::reach(spacing)).powi(2);
    grid.for_each_near(&here, |j| {
        let squared = (setup.positions[j] - here).norm_squared();
        if squared >= limit || j == i || (near_wall && setup.walls.separates(&here, &setup.positions[j])) {
            return;
        }
        insert(&mut nearest, &mut found, (squared, j as u32));
    });
    let mut reach = polygon.squared_reach();
    for &(squared, j) in &nearest[..found] {
        if squared > 4.0 * reach {
            break;
        }
        if polygon.cut(&plane_to(setup, i, j), j, slack) {
            reach = polygon.squared_reach();
        }
    }
    (polygon, cuts)
}

fn make(
    setup: &Setup,
    i: usize,
    polygon: &Polygon,
    cuts: &Cuts,
    room: &[f64],
    facets: &mut Vec<Facet>,
    wall_facets: &mut Vec<WallFacet>,
) -> Cell {
    let count = setup.positions.len();
    let planes = |label: u32| match wall_of(label, cuts.count) {
        Some(k) => cuts.planes[k],
        None if (label as usize) < count => plane_to(setup, i, label),
        None => Plane { normal: Vector2::zeros(), distance: 0.0 },
    };
    let fullness = |label: u32| match label {
        polygon::BOX => room[i],
        label if (label as usize) < count => room[label as usize],
        _ => 0.0,
    };
    let shape = Shape { polygon, planes: &planes, fullness: &fullness, spacing: setup.spacing };
    let mut add = |label: u32, facet: Facet| match wall_of(label, cuts.count) {
        Some(k) => wall_facets.push(place_on_wall(setup, i, facet, cuts.owners[k])),
        None => facets.push(facet),
    };
    if shape.is_open() { shape.surface(setup.volumes[i], &mut add) } else { shape.close(&mut add) }
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

fn place_on_wall(setup: &Setup, i: usize, facet: Facet, owner: (u32, u32)) -> WallFacet {
    let walls = setup.walls;
    let place = setup.positions[i] + facet.middle();
    let chain = &walls.chains[owner.1 as usize];
    let run = &walls.segments[chain.first..chain.last];
    let nearest = run
        .iter()
        .enumerate()
        .min_by(|a, b| a.1.squared_distance(&place).total_cmp(&b.1.squared_distance(&place)))
        .map_or(owner.0 as usize, |(k, _)| chain.first + k);
    let segment = &walls.segments[nearest];
    let fraction = (segment.local(&place).1 / segment.length).clamp(0.0, 1.0);
    WallFacet { facet, segment: nearest as u32, panel: segment.panel, fraction }
}
