//! Particle-quadrature geometric multigrid: the preconditioner of the pressure solve.
//!
//! The fine level is the particle matrix. The next level has its unknowns on the vertices of a background grid with
//! cells of three spacings, connected by bilinear interpolation at the particles. Its operator is not the Galerkin
//! product but that product's quadrature over particles,
//!
//!   A_c(a, b) = sum_i kappa grad N_a . grad N_b (x_i) + sum_i s_i N_a (x_i) delta_ab,
//!
//! with kappa = 1/4 sum_j w_ij r_ij^2 (its lattice value) and s_i the row sum of the fine matrix, non-zero beside the
//! free surface only (lumped). Bilinear gradients need five moments per cell, so the operator costs one pass over the
//! particles. Coarser levels have the Galerkin product of this one: the quadrature there as well needs a third more
//! iterations. One V(1,1) cycle with damped Jacobi smoothing is symmetric and
//! positive, as conjugate gradients require. It works in single precision: only its direction matters.

use super::level::{Level, Moments};
use super::sliced_matrix::Matrix;
use crate::grid::bounding_box;
use crate::parallel::{self, CHUNK};
use nalgebra::{Cholesky, DMatrix, Dyn, Vector2};
use rayon::prelude::*;

/// Cell size of the first grid in particle spacings.
const CELL: f64 = 3.0;
/// Vertices at or below which a level is solved directly.
const DIRECT: usize = 64;

/// The preconditioner: set up once per matrix, applied once per iteration.
#[derive(Debug, Clone, Default)]
pub struct Multigrid {
    levels: Vec<Level>,
    depth: usize,
    direct: Option<Cholesky<f64, Dyn>>,
    /// First particle of each cell in `order`, and the number of particles.
    starts: Vec<u32>,
    order: Vec<u32>,
    /// Cell of each particle, and where in it, in 0..1.
    cell_of: Vec<u32>,
    local: Vec<[f32; 2]>,
    /// Moments of the particles of each cell.
    moments: Vec<Moments>,
    place_of: Vec<u32>,
    counts: Vec<u32>,
    map: Vec<u32>,
    marks: Vec<bool>,
}

/// Vectors of a cycle for `K` right sides, level by level; the last entry of each stands for vertices that do not
/// exist.
#[derive(Debug, Clone)]
pub struct Cycle<const K: usize> {
    fine: Vec<[f32; K]>,
    by_corner: Vec<[[f32; K]; 4]>,
    levels: Vec<Vectors<K>>,
    direct: DMatrix<f64>,
}

#[derive(Debug, Clone, Default)]
struct Vectors<const K: usize> {
    right: Vec<[f32; K]>,
    solution: Vec<[f32; K]>,
    residual: Vec<[f32; K]>,
}

impl Multigrid {
    /// Sets up the hierarchy for a matrix whose first rows stand at `points`, tied to zero by `row_sums`; rows that stand nowhere
    /// are smoothed alone. `kappa` is n0 lambda / 4.
    pub fn set_up(&mut self, row_sums: &[f64], points: &[Vector2<f64>], spacing: f64, kappa: f64) {
        self.depth = 0;
        if points.is_empty() {
            return;
        }
        let size = CELL * spacing;
        self.bin(points, spacing, size);
        self.collect_moments(row_sums);
        self.levels[0].assemble(&self.moments, kappa / (size * size));
        self.depth = 1;
        while self.levels[self.depth - 1].size() > DIRECT {
            if self.levels.len() == self.depth {
                self.levels.push(Level::default());
            }
            let (finer, coarser) = self.levels.split_at_mut(self.depth);
            let (fine, coarse) = (&mut finer[self.depth - 1], &mut coarser[0]);
            fine.coarsen_into(coarse, &mut self.map, &mut self.marks);
            coarse.assemble_from(fine);
            self.depth += 1;
        }
        self.direct = factorise(&self.levels[self.depth - 1], self.direct.take());
    }

    /// Sorts the rows into the cells of the first grid.
    fn bin(&mut self, points: &[Vector2<f64>], spacing: f64, size: f64) {
        let (low, high) = bounding_box(points);
        let origin = low.add_scalar(-0.5 * spacing);
        let cells = |length: f64| ((length + spacing) / size).floor() as usize + 1;
        let (columns, rows) = (cells(high.x - low.x), cells(high.y - low.y));
        let place = |point: &Vector2<f64>| {
            let place = (point - origin) / size;
            let (x, y) = ((place.x as usize).min(columns - 1), (place.y as usize).min(rows - 1));
            (y * columns + x, [(place.x - x as f64) as f32, (place.y - y as f64) as f32])
        };
        self.place_of.resize(points.len(), 0);
        self.local.resize(points.len(), [0.0; 2]);
        let both = self.place_of.par_iter_mut().zip(&mut self.local).zip(points).with_min_len(CHUNK);
        both.for_each(|((cell, local), point)| {
            let (place, inside) = place(point);
            (*cell, *local) = (place as u32, inside);
        });
        self.counts.clear();
        self.counts.resize(columns * rows, 0);
        self.place_of.iter().for_each(|&place| self.counts[place as usize] += 1);
        if self.levels.is_empty() {
            self.levels.push(Level::default());
        }
        let counts = &self.counts;
        self.levels[0].lay_out(columns, rows, |cell| counts[cell] > 0, &mut self.map);
        self.levels[0].find_cells_around(&self.map);
        self.order_by_cell();
    }

    fn order_by_cell(&mut self) {
        let cells = &self.levels[0].cells;
        self.starts.clear();
        let mut start = 0;
        for &cell in cells {
            self.starts.push(start);
            start += std::mem::replace(&mut self.counts[cell as usize], start);
        }
        self.starts.push(start);
        self.order.resize(self.place_of.len(), 0);
        for (row, &place) in self.place_of.iter().enumerate() {
            let slot = &mut self.counts[place as usize];
            self.order[*slot as usize] = row as u32;
            *slot += 1;
        }
        self.cell_of.resize(self.place_of.len(), 0);
        let (map, place_of) = (&self.map, &self.place_of);
        parallel::fill(&mut self.cell_of, |row| map[place_of[row] as usize]);
    }

    fn collect_moments(&mut self, row_sums: &[f64]) {
        let (starts, order, local) = (&self.starts, &self.order, &self.local);
        self.moments.resize(self.levels[0].cells.len(), Moments::default());
        parallel::fill(&mut self.moments, |cell| {
            let mut moments = Moments::default();
            for &row in &order[starts[cell] as usize..starts[cell + 1] as usize] {
                let [a, b] = local[row as usize].map(f64::from);
                moments.add(a, b, row_sums[row as usize]);
            }
            moments
        });
    }

    /// Adds to z, in which one smoothing from zero stands already, what the grids make of the rest of r times `scale`.
    pub fn correct<const K: usize>(
        &self,
        matrix: &Matrix,
        r: &[[f64; K]],
        scale: &[f64; K],
        z: &mut [[f32; K]],
        cycle: &mut Cycle<K>,
        partial: &mut Vec<[f64; K]>,
    ) {
        if self.depth == 0 {
            return;
        }
        cycle.resize(&self.levels[..self.depth], r.len());
        let smoothed = &*z;
        matrix.multiply_with(smoothed, &mut cycle.fine, partial, |row, sums: [f32; K], out| {
            let diagonal = matrix.diagonal[row] as f32;
            let rest = |k: usize| (r[row][k] * scale[k]) as f32 - (diagonal * smoothed[row][k] - sums[k]);
            *out = std::array::from_fn(rest);
            [0.0; K]
        });
        self.restrict_particles(cycle);
        self.cycle(0, &mut cycle.levels, &mut cycle.direct);
        self.prolong_to_particles(&cycle.levels[0].solution, z);
    }

    fn restrict_particles<const K: usize>(&self, cycle: &mut Cycle<K>) {
        let (starts, order, local) = (&self.starts, &self.order, &self.local);
        let (level, fine) = (&self.levels[0], &cycle.fine);
        let none = level.cells.len();
        cycle.by_corner.resize(none + 1, [[0.0; K]; 4]);
        cycle.by_corner[none] = [[0.0; K]; 4];
        parallel::fill(&mut cycle.by_corner[..none], |cell| {
            let mut sums = [[0.0; K]; 4];
            for &row in &order[starts[cell] as usize..starts[cell + 1] as usize] {
                let (weights, value) = (corner_weights(&local[row as usize]), &fine[row as usize]);
                for (sum, weight) in sums.iter_mut().zip(weights) {
                    sum.iter_mut().zip(value).for_each(|(sum, value)| *sum += weight * value);
                }
            }
            sums
        });
        let by_corner = &cycle.by_corner;
        parallel::fill(&mut cycle.levels[0].right[..level.size()], |v| {
            let mut sum = [0.0; K];
            for (place, &cell) in level.cells_around[v].iter().enumerate() {
                let part = &by_corner[cell as usize][3 - place];
                sum.iter_mut().zip(part).for_each(|(sum, value)| *sum += value);
            }
            sum
        });
    }

    fn prolong_to_particles<const K: usize>(&self, values: &[[f32; K]], z: &mut [[f32; K]]) {
        let (cell_of, local, corners) = (&self.cell_of, &self.local, &self.levels[0].corners);
        z[..cell_of.len()].par_iter_mut().with_min_len(CHUNK).enumerate().for_each(|(row, z)| {
            let weights = corner_weights(&local[row]);
            for (&corner, weight) in corners[cell_of[row] as usize].iter().zip(weights) {
                z.iter_mut().zip(&values[corner as usize]).for_each(|(z, value)| *z += weight * value);
            }
        });
    }

    fn cycle<const K: usize>(&self, depth: usize, vectors: &mut [Vectors<K>], columns: &mut DMatrix<f64>) {
        let level = &self.levels[depth];
        let (own, coarser) = vectors.split_at_mut(1);
        let Vectors { right, solution, residual } = &mut own[0];
        if depth + 1 == self.depth {
            match &self.direct {
                Some(factor) => solve_directly(factor, columns, right, solution, level.size()),
                None => level.smooth_from_zero(right, solution),
            }
            return;
        }
        level.smooth_from_zero(right, solution);
        level.residual(right, solution, residual);
        self.levels[depth + 1].restrict(residual, &mut coarser[0].right);
        self.cycle(depth + 1, coarser, columns);
        level.add_interpolated(&coarser[0].solution, &mut solution[..level.size()]);
        level.residual(right, solution, residual);
        level.smooth_again(residual, solution);
    }
}

impl<const K: usize> Default for Cycle<K> {
    fn default() -> Self {
        let direct = DMatrix::zeros(DIRECT, K);
        Self { fine: Vec::new(), by_corner: Vec::new(), levels: Vec::new(), direct }
    }
}

impl<const K: usize> Cycle<K> {
    fn resize(&mut self, levels: &[Level], rows: usize) {
        self.fine.resize(rows, [0.0; K]);
        self.levels.resize_with(levels.len(), Vectors::default);
        for (vectors, level) in self.levels.iter_mut().zip(levels) {
            for vector in [&mut vectors.right, &mut vectors.solution, &mut vectors.residual] {
                vector.resize(level.size() + 1, [0.0; K]);
                vector[level.size()] = [0.0; K];
            }
        }
    }
}

/// Bilinear weights of the corners of a cell.
#[inline(always)]
fn corner_weights(&[a, b]: &[f32; 2]) -> [f32; 4] {
    [(1.0 - a) * (1.0 - b), a * (1.0 - b), (1.0 - a) * b, a * b]
}

fn solve_directly<const K: usize>(
    factor: &Cholesky<f64, Dyn>,
    columns: &mut DMatrix<f64>,
    right: &[[f32; K]],
    solution: &mut [[f32; K]],
    size: usize,
) {
    for (k, mut column) in columns.column_iter_mut().enumerate() {
        column
            .iter_mut()
            .enumerate()
            .for_each(|(v, value)| *value = if v < size { f64::from(right[v][k]) } else { 0.0 });
    }
    factor.solve_mut(columns);
    for (v, solution) in solution[..size].iter_mut().enumerate() {
        *solution = std::array::from_fn(|k| columns[(v, k)] as f32);
    }
}

/// Dense factors of the coarsest operator, always of the same size, in the memory of the last ones. A tiny shift keeps
/// water without a free surface positive definite.
fn factorise(level: &Level, last: Option<Cholesky<f64, Dyn>>) -> Option<Cholesky<f64, Dyn>> {
    let mut dense = last.map_or_else(|| DMatrix::zeros(DIRECT, DIRECT), Cholesky::unpack_dirty);
    dense.fill(0.0);
    level.entries().for_each(|(v, w, value)| dense[(v, w)] += value);
    for v in 0..DIRECT {
        dense[(v, v)] = if dense[(v, v)] > 0.0 { dense[(v, v)] * (1.0 + 1e-5) } else { 1.0 };
    }
    dense.cholesky()
}
