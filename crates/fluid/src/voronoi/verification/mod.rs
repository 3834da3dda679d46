//! Verification of the cells and of the operators on them, on arrangements of every kind.

mod areas;
mod continuity;
mod divergence;
mod gradient;
mod poisson;
mod stiffness;

use super::cells::{Cells, Setup};
use crate::parallel::Lists;
use crate::parameters::Geometry;
use crate::walls::{WallLayout, Walls};
use nalgebra::Vector2;

/// Numbers from -1 to 1 that look random and are the same in every run.
pub struct Noise(u64);

impl Noise {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    }

    pub fn vector(&mut self) -> Vector2<f64> {
        Vector2::new(self.next(), self.next())
    }
}

/// How particles stand in the unit box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Order {
    /// A square lattice.
    Square,
    /// Rows shifted by half a spacing against each other.
    Hexagonal,
    /// A square lattice with every coordinate changed by up to this share of a spacing.
    Jittered(f64),
    /// Jittered by 0.4 spacings and taken to the centroids of the cells five times.
    Relaxed,
}

pub const ORDERS: [Order; 4] = [Order::Square, Order::Hexagonal, Order::Jittered(0.2), Order::Relaxed];

/// Particles between walls, with their cells.
pub struct Arrangement {
    pub positions: Vec<Vector2<f64>>,
    pub own_areas: Vec<f64>,
    pub spacing: f64,
    pub walls: Walls,
    pub cells: Cells,
}

impl Arrangement {
    /// Particles that own `own_areas`, or squares of the spacing where none are given, between fixed walls.
    pub fn new(
        positions: Vec<Vector2<f64>>,
        own_areas: Option<Vec<f64>>,
        lines: &[Vec<Vector2<f64>>],
        spacing: f64,
    ) -> Self {
        let geometry = Geometry { fixed_walls: lines.to_vec(), ..Geometry::default() };
        let mut walls = Walls::default();
        walls.place(&WallLayout::new(&geometry, spacing), None, 2.0 * Cells::reach(spacing), spacing);
        let own_areas = own_areas.unwrap_or_else(|| vec![spacing * spacing; positions.len()]);
        let mut arrangement = Self { positions, own_areas, spacing, walls, cells: Cells::default() };
        arrangement.rebuild();
        arrangement
    }

    /// The unit box, closed, with about `across` particles along each side.
    pub fn closed(order: Order, across: usize) -> Self {
        let spacing = 1.0 / across as f64;
        let start = match order {
            Order::Hexagonal => hexagonal(across),
            _ => square(across),
        };
        let mut arrangement = Self::new(start, None, &[unit_box()], spacing);
        let amount = match order {
            Order::Jittered(amount) => amount,
            Order::Relaxed => 0.4,
            _ => 0.0,
        };
        let mut noise = Noise::new(7);
        arrangement.positions.iter_mut().for_each(|position| *position += noise.vector() * (amount * spacing));
        arrangement.rebuild();
        if order == Order::Relaxed {
            for _ in 0..5 {
                arrangement.settle();
            }
        }
        arrangement
    }

    /// The same particles, owning their cells: there is no more room than they fill.
    pub fn filled(mut self) -> Self {
        self.own_areas = self.areas();
        self.rebuild();
        self
    }

    /// The unit box without its lid: the particles own what their cells hold under the lid.
    pub fn open(order: Order, across: usize) -> Self {
        Self::closed(order, across).without_lid()
    }

    /// The same particles, owning their cells, in the unit box without its lid.
    pub fn without_lid(self) -> Self {
        let own_areas = self.cells.cells.iter().map(|cell| cell.area).collect();
        let tank = points(&[(0.0, 1.5), (0.0, 0.0), (1.0, 0.0), (1.0, 1.5)]);
        Self::new(self.positions, Some(own_areas), &[tank], self.spacing)
    }

    /// Finds the cells of the particles where they stand now.
    pub fn rebuild(&mut self) {
        let mut proximities = Lists::default();
        proximities.build(self.positions.len(), |i, out| self.walls.attach(&self.positions[i], out));
        self.cells.build(&Setup {
            positions: &self.positions,
            areas: &self.own_areas,
            proximities: &proximities,
            walls: &self.walls,
            spacing: self.spacing,
        });
    }

    /// Takes every particle to the centroid of its cell.
    pub fn settle(&mut self) {
        for (position, cell) in self.positions.iter_mut().zip(&self.cells.cells) {
            *position += cell.centroid;
        }
        self.rebuild();
    }

    pub fn areas(&self) -> Vec<f64> {
        self.cells.cells.iter().map(|cell| cell.area).collect()
    }

    /// Whether a particle's cell touches neither a wall nor the free surface.
    pub fn is_inside(&self, i: usize) -> bool {
        self.cells.walls.of(i).is_empty() && !self.cells.cells[i].is_open()
    }
}

pub fn points(list: &[(f64, f64)]) -> Vec<Vector2<f64>> {
    list.iter().map(|&(x, y)| Vector2::new(x, y)).collect()
}

/// The unit box with the water inside.
pub fn unit_box() -> Vec<Vector2<f64>> {
    points(&[(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0)])
}

/// A square lattice in the unit box.
pub fn square(across: usize) -> Vec<Vector2<f64>> {
    let place = |k: usize| (k as f64 + 0.5) / across as f64;
    (0..across * across).map(|k| Vector2::new(place(k % across), place(k / across))).collect()
}

/// A hexagonal lattice in the unit box: as many rows as make the triangles nearly equilateral.
fn hexagonal(across: usize) -> Vec<Vector2<f64>> {
    let rows = (across as f64 * 2.0 / 3.0_f64.sqrt()).round() as usize;
    let step = 1.0 / across as f64;
    let mut positions = Vec::new();
    for row in 0..rows {
        let y = (row as f64 + 0.5) / rows as f64;
        let first = if row % 2 == 0 { 0.25 } else { 0.75 };
        positions.extend((0..across).map(|k| Vector2::new((k as f64 + first) * step, y)));
    }
    positions
}

/// Orders of convergence between successive resolutions, each twice as fine.
pub fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
}

pub fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.map(f64::abs).fold(0.0, f64::max)
}
