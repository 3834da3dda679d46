//! The matrix of the pressure: symmetric, positive, over the particles that are not on the surface.
//!
//! Eight rows at a time are stored side by side, their k-th entries next to each other, filled up with zeros: products
//! need no decision where a row ends. Off-diagonal entries have single precision, and the diagonal, in double
//! precision, is made from them as they are: rows still add up exactly, and a solve reaches any residual.

use crate::neighbours::Neighbourhood;
use crate::parallel::{self, CHUNK};
use crate::voronoi::cells::Cells;
use crate::voronoi::enclosed::Groups;
use nalgebra::Vector2;
use rayon::prelude::*;
use std::ops::{AddAssign, Mul};

/// Row number of a particle that is no unknown.
pub const NO_ROW: u32 = u32::MAX;
/// Rows that stand side by side.
const WIDTH: usize = 8;

/// Off-diagonal entry: the negative of a weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// Column.
    pub column: u32,
    /// Weight, the negative of the matrix entry.
    pub weight: f32,
}

/// Rows of one chunk.
#[derive(Debug, Clone, Default)]
struct Rows {
    /// First group of entries of every eight rows, and the number of groups.
    starts: Vec<u32>,
    columns: Vec<[u32; WIDTH]>,
    weights: Vec<[f32; WIDTH]>,
    scratch: Vec<Entry>,
}

/// Numbers that products are added up in.
pub trait Real: Copy + Default + Send + Sync + From<f32> + Mul<Output = Self> + AddAssign {}
impl Real for f32 {}
impl Real for f64 {}

/// A p = b with (A p)_i = sum_j w_ij (p_i - p_j), the Laplacian (the paper's equation 3b) times -n0 lambda / (2 d).
#[derive(Debug, Clone, Default)]
pub struct Matrix {
    /// Particle of each row.
    pub particles: Vec<u32>,
    /// Row of each particle, or `NO_ROW`.
    pub rows: Vec<u32>,
    /// Diagonal.
    pub diagonal: Vec<f64>,
    /// Sum of each row: the weight of surface neighbours, where p = 0.
    pub row_sums: Vec<f64>,
    chunks: Vec<Rows>,
    groups: Groups,
    /// Whether some of them fill compartments.
    enclosed: bool,
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
        let (particles, rows) = (std::mem::take(&mut self.particles), std::mem::take(&mut self.rows));
        let near = |row: usize| {
            let i = particles[row] as usize;
            let direct = around.neighbours.of(i).iter().map(|entry| (entry.index, entry.weight));
            direct.chain(around.images.of(i).iter().map(|image| (image.neighbour, image.weight)))
        };
        self.fill(particles.len(), |row, out| {
            for (j, weight) in near(row) {
                let column = rows[j as usize];
                if column != NO_ROW && column != row as u32 {
                    out.push(Entry { column, weight: weight as f32 });
                }
            }
        });
        self.row_sums.resize(particles.len(), 0.0);
        parallel::fill(&mut self.row_sums, |row| {
            near(row).filter(|&(j, _)| surface[j as usize]).map(|(_, weight)| weight).sum()
        });
        (self.particles, self.rows) = (particles, rows);
        self.add_row_sums(regularise);
    }

    /// Assembles the matrix of Voronoi cells: every particle is an unknown, and free surfaces are row sums.
    pub fn assemble_cells(&mut self, cells: &Cells, volumes: &[f64]) {
        let count = cells.cells.len();
        if self.rows.len() != count {
            self.rows.clear();
            self.rows.extend(0..count as u32);
            self.particles.clone_from(&self.rows);
        }
        self.fill(count, |i, out| {
            let facets = cells.facets.of(i).iter();
            out.extend(facets.map(|facet| Entry { column: facet.neighbour, weight: facet.weight() as f32 }));
        });
        self.row_sums.resize(count, 0.0);
        parallel::fill(&mut self.row_sums, |i| {
            let cell = &cells.cells[i];
            if cell.is_open() { cell.surface / cell.depth } else { 0.0 }
        });
        self.enclosed = self.groups.settle(cells, volumes, &mut self.row_sums);
        self.add_row_sums(self.enclosed);
    }

    /// Groups of cells, where there is water that touches no free surface.
    pub fn compartments(&self) -> Option<&Groups> {
        self.enclosed.then_some(&self.groups)
    }

    /// Fills in the rows; the diagonal gets their sums.
    fn fill(&mut self, count: usize, collect: impl Fn(usize, &mut Vec<Entry>) + Sync) {
        self.chunks.resize_with(count.div_ceil(CHUNK), Rows::default);
        self.diagonal.resize(count, 0.0);
        let chunks = self.chunks.par_iter_mut().zip(self.diagonal.par_chunks_mut(CHUNK)).enumerate();
        chunks.for_each(|(chunk, (rows, diagonal))| rows.fill(chunk * CHUNK, diagonal, &collect));
    }

    fn add_row_sums(&mut self, regularise: bool) {
        let scale = if regularise { 1.0 + 1e-10 } else { 1.0 };
        let row_sums = &self.row_sums;
        parallel::update(&mut self.diagonal, |row, sum| ((sum + row_sums[row]) * scale).max(f64::MIN_POSITIVE));
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.particles.len()
    }

    /// Off-diagonal entries of a row; a column may appear twice, directly and as an image.
    #[cfg(test)]
    pub fn entries(&self, row: usize) -> impl Iterator<Item = Entry> {
        let rows = &self.chunks[row / CHUNK];
        let (slice, lane) = (row % CHUNK / WIDTH, row % WIDTH);
        let groups = rows.starts[slice] as usize..rows.starts[slice + 1] as usize;
        let all = groups.map(move |k| Entry { column: rows.columns[k][lane], weight: rows.weights[k][lane] });
        all.filter(|entry| entry.weight != 0.0)
    }

    /// Goes through all rows with the sums of weights times `x`, for `K` vectors at once, which stand side by side:
    /// `visit` gets row, sums and the row's slot in `out`. Returns the sums of what it returns, added in a fixed order.
    pub fn pass<X: Real, O: Send, const K: usize>(
        &self,
        x: &[[X; K]],
        out: &mut [O],
        partial: &mut Vec<[f64; K]>,
        visit: impl Fn(usize, [X; K], &mut O) -> [f64; K] + Sync,
    ) -> [f64; K] {
        partial.resize(self.chunks.len(), [0.0; K]);
        let chunks = (&self.chunks, out.par_chunks_mut(CHUNK), &mut *partial).into_par_iter().enumerate();
        chunks.for_each(|(chunk, (rows, out, partial))| {
            *partial = [0.0; K];
            for (slice, out) in out.chunks_mut(WIDTH).enumerate() {
                let sums = rows.slice_sums(slice, x);
                for ((lane, out), sums) in out.iter_mut().enumerate().zip(sums) {
                    let term = visit(chunk * CHUNK + slice * WIDTH + lane, sums, out);
                    partial.iter_mut().zip(term).for_each(|(sum, term)| *sum += term);
                }
            }
        });
        parallel::total(partial)
    }

    /// Position of the particle of each row.
    pub fn gather_positions(&self, positions: &[Vector2<f64>], out: &mut Vec<Vector2<f64>>) {
        out.clear();
        out.extend(self.particles.iter().map(|&i| positions[i as usize]));
    }
}

impl Rows {
    /// Fills in the rows from `first` on, and their sums.
    fn fill(&mut self, first: usize, sums: &mut [f64], collect: &(impl Fn(usize, &mut Vec<Entry>) + Sync)) {
        self.starts.clear();
        self.starts.push(0);
        self.columns.clear();
        self.weights.clear();
        for (slice, sums) in sums.chunks_mut(WIDTH).enumerate() {
            let begin = self.columns.len();
            for (lane, sum) in sums.iter_mut().enumerate() {
                let row = first + slice * WIDTH + lane;
                self.scratch.clear();
                collect(row, &mut self.scratch);
                *sum = self.scratch.iter().map(|entry| f64::from(entry.weight)).sum();
                let longest = self.columns.len().max(begin + self.scratch.len());
                self.columns.resize(longest, [row as u32; WIDTH]);
                self.weights.resize(longest, [0.0; WIDTH]);
                for (k, entry) in self.scratch.iter().enumerate() {
                    self.columns[begin + k][lane] = entry.column;
                    self.weights[begin + k][lane] = entry.weight;
                }
            }
            self.starts.push(self.columns.len() as u32);
        }
    }

    /// Sums of weights times `x` of eight rows.
    #[inline(always)]
    fn slice_sums<X: Real, const K: usize>(&self, slice: usize, x: &[[X; K]]) -> [[X; K]; WIDTH] {
        let groups = self.starts[slice] as usize..self.starts[slice + 1] as usize;
        let mut sums = [[X::default(); K]; WIDTH];
        for (columns, weights) in self.columns[groups.clone()].iter().zip(&self.weights[groups]) {
            for lane in 0..WIDTH {
                let (x, weight) = (&x[columns[lane] as usize], X::from(weights[lane]));
                for k in 0..K {
                    sums[lane][k] += weight * x[k];
                }
            }
        }
        sums
    }
}
