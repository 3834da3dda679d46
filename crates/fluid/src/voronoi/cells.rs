//! The cells of all particles.

use super::cell::Cell;
use super::facet::Facet;
use super::polygon::{self, Corner, Plane};
use super::shape::{Around, FAR, Shape, ShapeBuffers, wall_of};
use super::tessellate::{self, CellBuffers, GRID};
use crate::grid::Grid;
use crate::parallel::{self, CHUNK, Lists};
use crate::walls::{FIXED, WallProximity, Walls};
use nalgebra::Vector2;
use rayon::prelude::*;

/// Share of a spacing below which a facet is dropped, touching corners of a square lattice, and particles coincide.
pub const SLACK: f64 = 1e-9;

/// A facet on a wall with the place of its middle on the wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WallFacet {
    /// The facet.
    pub facet: Facet,
    /// Moving panel, or `FIXED`.
    pub panel: u32,
    /// The wall.
    pub segment: u32,
    /// Place on it, 0 to 1.
    pub fraction: f64,
    /// Whether it only closes a cell where another one sees less of their facet: it moves with the particle and loads
    /// nothing.
    pub is_closure: bool,
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
    interior: Lists<Facet>,
    boundary: Lists<Facet>,
    boundary_walls: Lists<WallFacet>,
    asymmetric: Vec<bool>,
    reconciled: Vec<bool>,
    corners: Lists<Corner>,
    planes: Lists<WallPlane>,
    relative_area: Vec<f64>,
}

/// The plane of a wall that cuts a cell.
#[derive(Debug, Clone, Copy)]
pub struct WallPlane {
    /// The plane.
    pub plane: Plane,
    /// Its wall.
    pub segment: u32,
}

/// What cells depend on.
#[derive(Clone, Copy)]
pub struct Setup<'a> {
    /// Positions \[m\].
    pub positions: &'a [Vector2<f64>],
    /// Areas that particles own \[m2\].
    pub areas: &'a [f64],
    /// Walls near particles.
    pub proximities: &'a Lists<WallProximity>,
    /// Walls.
    pub walls: &'a Walls,
    /// Particle spacing \[m\].
    pub spacing: f64,
}

impl Cells {
    /// Reach of a cell \[m\]: walls farther away than this, and particles farther than twice this, do not bound it.
    pub fn reach(spacing: f64) -> f64 {
        FAR * spacing
    }

    /// Whether a particle touches no other: it flies freely, and walls stop it as they stop a point.
    pub fn is_isolated(&self, i: usize) -> bool {
        self.facets.of(i).is_empty()
    }

    /// Facets of cell i to particles, then those on walls.
    pub fn facets_and_walls(&self, i: usize) -> impl Iterator<Item = &Facet> {
        self.facets.of(i).iter().chain(self.walls.of(i).iter().map(|wall| &wall.facet))
    }

    /// Builds all cells.
    pub fn build(&mut self, setup: &Setup) {
        let count = setup.positions.len();
        self.grid.build(setup.positions, GRID * setup.spacing);
        self.relative_area.resize(count, 0.0);
        self.cells.resize(count, Cell::default());
        let Self { grid, interior, corners, planes, relative_area, cells, .. } = &mut *self;
        tessellate::tessellate(setup, grid, CellBuffers { facets: interior, corners, planes, relative_area, cells });
        self.bound_cells(setup);
        self.agree(setup);
        self.close_surfaces(setup.areas);
    }

    /// Facets and cells from the outlines that walls or empty space may touch.
    fn bound_cells(&mut self, setup: &Setup) {
        let count = setup.positions.len();
        let (outlines, planes, relative_area) = (&self.corners, &self.planes, &self.relative_area);
        let area_of = |i: usize, label: u32| match label {
            polygon::BOX => relative_area[i],
            label if (label as usize) < count => relative_area[label as usize],
            _ => 0.0,
        };
        let bound = |i: usize,
                     buffers: &mut ShapeBuffers,
                     facets: &mut Vec<Facet>,
                     walls: &mut Vec<WallFacet>,
                     cell: &mut Cell| {
            let own = planes.of(i);
            let plane_of = |label: u32| match wall_of(label, own.len()) {
                Some(k) => own[k].plane,
                None if (label as usize) < count => plane_to(setup, i, label),
                None => Plane { normal: Vector2::zeros(), distance: 0.0 },
            };
            let area_of = |label: u32| area_of(i, label);
            let around = Around { planes: &plane_of, relative_area: &area_of, spacing: setup.spacing };
            let shape = Shape::new(outlines.of(i), around, buffers);
            let add = |facet: Facet| match wall_of(facet.neighbour, own.len()) {
                Some(k) => walls.push(place_on_wall(setup, i, facet, own[k].segment)),
                None => facets.push(facet),
            };
            *cell = shape.cell(setup.areas[i], add);
            cell.asymmetric = shape.is_asymmetric(own.len());
        };
        let lists =
            (self.boundary.writers(count), self.boundary_walls.writers(count), self.cells.par_chunks_mut(CHUNK));
        lists.into_par_iter().enumerate().for_each(|(chunk, (mut facets, mut walls, cells))| {
            let mut buffers = ShapeBuffers::default();
            for (k, cell) in cells.iter_mut().enumerate() {
                let i = chunk * CHUNK + k;
                if !outlines.of(i).is_empty() {
                    bound(i, &mut buffers, facets.items, walls.items, cell);
                }
                facets.end();
                walls.end();
            }
        });
        self.end_at_surfaces(setup.spacing);
    }

    /// Facets that cross the free surface end there, at the mean depth of the two cells, each as far as it is open.
    fn end_at_surfaces(&mut self, spacing: f64) {
        let cells = &self.cells;
        self.boundary.change(|i, facet| {
            if facet.meets_surface() {
                let (own, other) = (&cells[i], &cells[facet.neighbour as usize]);
                let open = own.openness + other.openness;
                let depths = own.depth * own.openness + other.depth * other.openness;
                facet.end_at(if open > 0.0 { depths / open } else { 0.0 }, spacing);
            }
        });
        self.asymmetric.resize(cells.len(), false);
        parallel::fill(&mut self.asymmetric, |i| cells[i].asymmetric);
    }

    /// Brings the facets together, and lets two cells have the same facet between them where a wall cuts them
    /// differently, or rounding decided whether a corner lies in empty space: the matrix is symmetric, and what one
    /// cell gives the other takes. Chunks of particles whose facets are all interior ones are taken as they are.
    fn agree(&mut self, setup: &Setup) {
        let count = setup.positions.len();
        self.reconciled.resize(count.div_ceil(CHUNK), false);
        let seen = Seen {
            interior: &self.interior,
            boundary: &self.boundary,
            corners: &self.corners,
            asymmetric: &self.asymmetric,
        };
        let (boundary_walls, cells) = (&self.boundary_walls, &self.cells);
        let lists = (self.facets.writers(count), self.walls.writers(count), &mut self.reconciled);
        lists.into_par_iter().enumerate().for_each(|(chunk, (mut facets, mut walls, reconciled))| {
            let members = chunk * CHUNK..((chunk + 1) * CHUNK).min(count);
            *reconciled = members.clone().any(|i| seen.is_boundary(i) || seen.touches_asymmetric(i));
            for i in members {
                if *reconciled {
                    walls.items.extend_from_slice(boundary_walls.of(i));
                    let closed = 1.0 - cells[i].openness;
                    let closures = (closed > 0.0).then_some((&mut *walls.items, closed));
                    seen.agree(i, SLACK * setup.spacing, facets.items, closures);
                }
                facets.end();
                walls.end();
            }
        });
        let reconciled = &self.reconciled;
        self.facets.swap_chunks(&mut self.interior, |chunk| !reconciled[chunk]);
    }

    /// What the free surfaces of cells add up to, from the facets that bound the rest, and how far cells are stiffened.
    fn close_surfaces(&mut self, areas: &[f64]) {
        let (facets, walls) = (&self.facets, &self.walls);
        self.cells.par_iter_mut().with_min_len(parallel::CHUNK).enumerate().for_each(|(i, cell)| {
            if cell.is_open() {
                cell.close_surface(facets.of(i).iter().chain(walls.of(i).iter().map(|wall| &wall.facet)));
            }
            if cell.asymmetric {
                cell.stiffening = cell.stiffening_for(facets.of(i), areas[i]);
            }
        });
    }
}

/// Facets as each cell sees them.
struct Seen<'a> {
    interior: &'a Lists<Facet>,
    boundary: &'a Lists<Facet>,
    corners: &'a Lists<Corner>,
    asymmetric: &'a [bool],
}

impl Seen<'_> {
    fn is_boundary(&self, i: usize) -> bool {
        !self.corners.of(i).is_empty()
    }

    fn of(&self, i: usize) -> &[Facet] {
        if self.is_boundary(i) { self.boundary.of(i) } else { self.interior.of(i) }
    }

    fn touches_asymmetric(&self, i: usize) -> bool {
        self.interior.of(i).iter().any(|facet| self.asymmetric[facet.neighbour as usize])
    }

    /// The facets of cell i that its neighbours see too. What only it sees becomes a piece of wall among the closures,
    /// so that cells stay closed, with the share of the cell that is closed; the rest counts to its free surface.
    fn agree(&self, i: usize, slack: f64, out: &mut Vec<Facet>, mut closures: Option<(&mut Vec<WallFacet>, f64)>) {
        for facet in self.of(i) {
            let j = facet.neighbour as usize;
            if !(self.asymmetric[i] || self.asymmetric[j]) {
                out.push(*facet);
                continue;
            }
            let begin = out.len();
            let of_pair = self.of(j).iter().filter(|other| other.neighbour as usize == i);
            out.extend(of_pair.filter_map(|other| facet.common(other)));
            let Some((closures, closed)) = &mut closures else { continue };
            out[begin..].sort_by(|a, b| a.from.total_cmp(&b.from));
            let mut from = facet.from;
            for (to, next) in out[begin..].iter().map(|part| (part.from, part.to)).chain([(facet.to, facet.to)]) {
                if to - from > slack {
                    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from) * *closed);
                    let rest = facet.part([middle - half, middle + half]).with_empty_ends([0.0; 2]);
                    closures.push(WallFacet {
                        facet: rest,
                        panel: FIXED,
                        segment: FIXED,
                        fraction: 0.0,
                        is_closure: true,
                    });
                }
                from = next;
            }
        }
    }
}

/// Bisector between two particles. Coinciding particles part along x.
#[inline]
fn plane_to(setup: &Setup, i: usize, j: u32) -> Plane {
    let between = setup.positions[j as usize] - setup.positions[i];
    let distance = between.norm();
    if distance < SLACK * setup.spacing {
        let normal = Vector2::new(if (i as u32) < j { 1.0 } else { -1.0 }, 0.0);
        return Plane { normal, distance: SLACK * setup.spacing };
    }
    Plane { normal: between / distance, distance: 0.5 * distance }
}

/// Where on its wall a facet lies.
fn place_on_wall(setup: &Setup, i: usize, facet: Facet, segment: u32) -> WallFacet {
    let wall = &setup.walls.segments[segment as usize];
    let place = setup.positions[i] + facet.middle();
    let fraction = (wall.local(&place).1 / wall.length).clamp(0.0, 1.0);
    WallFacet { facet, panel: wall.panel, segment, fraction, is_closure: false }
}
