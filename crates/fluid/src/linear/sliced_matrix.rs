//! A sparse matrix, symmetric and positive.
//!
//! Eight rows at a time are stored side by side, their k-th entries next to each other, filled up with zeros: products
//! need no decision where a row ends. Off-diagonal entries have single precision, and the diagonal, in double
//! precision, is made from them as they are: rows still add up exactly, and a solve reaches any residual.

use crate::parallel::{self, CHUNK};
use rayon::prelude::*;
use std::ops::{AddAssign, Mul};

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

/// (A x)_i = sum_j w_ij (x_i - x_j) + s_i x_i with weights w and row sums s.
#[derive(Debug, Clone, Default)]
pub struct Matrix {
    /// Diagonal.
    pub diagonal: Vec<f64>,
    /// Sum of each row: what ties its unknown to zero.
    pub row_sums: Vec<f64>,
    chunks: Vec<Rows>,
}

impl Matrix {
    /// Sets `count` rows, whose entries `collect` appends; the diagonal gets their weights. `close` adds the row sums to
    /// it, which are the caller's to set.
    pub fn set_rows(&mut self, count: usize, collect: impl Fn(usize, &mut Vec<Entry>) + Sync) {
        self.chunks.resize_with(count.div_ceil(CHUNK), Rows::default);
        self.diagonal.resize(count, 0.0);
        let chunks = self.chunks.par_iter_mut().zip(self.diagonal.par_chunks_mut(CHUNK)).enumerate();
        chunks.for_each(|(chunk, (rows, diagonal))| rows.fill(chunk * CHUNK, diagonal, &collect));
    }

    /// Adds the row sums to the diagonal. `regularise` adds 1e-10 of it, where nothing ties some unknowns to zero.
    pub fn close(&mut self, regularise: bool) {
        let scale = if regularise { 1.0 + 1e-10 } else { 1.0 };
        let row_sums = &self.row_sums;
        parallel::update(&mut self.diagonal, |row, sum| ((sum + row_sums[row]) * scale).max(f64::MIN_POSITIVE));
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.diagonal.len()
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
    pub fn multiply_with<X: Real, O: Send, const K: usize>(
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
