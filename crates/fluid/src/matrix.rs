//! The matrix of the pressure: symmetric, positive, over the particles that are not on the surface.

use crate::neighbours::Neighbourhood;
use crate::parallel::{self, Lists};
use crate::voronoi::cell::Facet;
use crate::voronoi::cells::Cells;
use crate::voronoi::enclosed::Groups;
use nalgebra::Vector2;

/// Row number of a particle that is no unknown.
pub const NO_ROW: u32 = u32::MAX;

/// Off-diagonal entry: the negative of a weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// Column.
    pub column: u32,
    /// Weight, the negative of the matrix entry.
    pub weight: f64,
}

/// A p = b with (A p)_i = sum_j w_ij (p_i - p_j), the Laplacian (the paper's equation 3b) times -n0 lambda / (2 d).
#[derive(Debug, Clone, Default)]
pub struct Matrix {
    /// Particle of each row.
    pub particles: Vec<u32>,
    /// Row of each particle, or `NO_ROW`.
    pub rows: Vec<u32>,
    /// Off-diagonal entries by row; a column may appear twice, directly and as an image.
    pub entries: Lists<Entry>,
    /// Diagonal.
    pub diagonal: Vec<f64>,
    /// Sum of each row: the weight of surface neighbours, where p = 0.
    pub row_sums: Vec<f64>,
    groups: Groups,
}

impl Matrix {
    /// Assembles the matrix over the particles that are not on the surface. `regularise` adds 1e-10 of the diagonal,
    /// for water without any free surface.
    pub fn assemble(&mut self, around: &Neighbourhood, surface: &[bool], regularise: bool) {
        self.particles.clear();
        self.rows.clear();
        for (i, &on_surface) in surface.iter().enumerate() {
            self.rows.push(if on_surface { NO_ROW } else { self.particles.len() as u32 });
            if !on_surface {
                self.particles.push(i as u32);
            }
        }
        let (particles, rows) = (&self.particles, &self.rows);
        self.entries.build(particles.len(), |row, out| {
            let i = particles[row] as usize;
            let direct = around.neighbours.of(i).iter().map(|entry| (entry.index, entry.weight));
            let mirrored = around.images.of(i).iter().map(|image| (image.neighbour, image.weight));
            for (j, weight) in direct.chain(mirrored) {
                let column = rows[j as usize];
                if column != NO_ROW && column != row as u32 {
                    out.push(Entry { column, weight });
                }
            }
        });
        self.row_sums.resize(particles.len(), 0.0);
        parallel::fill(&mut self.row_sums, |row| {
            let i = particles[row] as usize;
            let direct = around.neighbours.of(i).iter().map(|entry| (entry.index, entry.weight));
            let mirrored = around.images.of(i).iter().map(|image| (image.neighbour, image.weight));
            direct.chain(mirrored).filter(|&(j, _)| surface[j as usize]).map(|(_, weight)| weight).sum()
        });
        self.fill_diagonal(regularise);
    }

    /// Assembles the matrix of Voronoi cells: every particle is an unknown, and free surfaces are row sums.
    pub fn assemble_cells(&mut self, cells: &Cells) {
        let count = cells.cells.len();
        if self.rows.len() != count {
            self.rows = (0..count as u32).collect();
            self.particles.clone_from(&self.rows);
        }
        self.entries.build(count, |i, out| {
            let entry = |facet: &Facet| Entry { column: facet.neighbour, weight: facet.weight() };
            out.extend(cells.facets.of(i).iter().map(entry));
        });
        self.row_sums.resize(count, 0.0);
        parallel::fill(&mut self.row_sums, |i| {
            let cell = &cells.cells[i];
            if cell.is_open() { cell.surface / cell.depth } else { 0.0 }
        });
        let enclosed = self.groups.settle(cells, &mut self.row_sums);
        self.fill_diagonal(enclosed);
    }

    /// Diagonal from the off-diagonal entries and the row sums.
    fn fill_diagonal(&mut self, regularise: bool) {
        let scale = if regularise { 1.0 + 1e-10 } else { 1.0 };
        self.diagonal.resize(self.particles.len(), 0.0);
        let (entries, row_sums) = (&self.entries, &self.row_sums);
        parallel::fill(&mut self.diagonal, |row| {
            let sum: f64 = entries.of(row).iter().map(|entry| entry.weight).sum();
            ((sum + row_sums[row]) * scale).max(f64::MIN_POSITIVE)
        });
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.particles.len()
    }

    /// (A x) at one row.
    #[inline]
    pub fn row_product(&self, row: usize, x: &[f64]) -> f64 {
        let coupled: f64 = self.entries.of(row).iter().map(|entry| entry.weight * x[entry.column as usize]).sum();
        self.diagonal[row] * x[row] - coupled
    }

    /// Position of the particle of each row.
    pub fn gather_positions(&self, positions: &[Vector2<f64>], out: &mut Vec<Vector2<f64>>) {
        out.clear();
        out.extend(self.particles.iter().map(|&i| positions[i as usize]));
    }
}
