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
//! particles; coarser levels shift the moments. One V(1,1) cycle with damped Jacobi smoothing is symmetric and
//! positive, as conjugate gradients require.

use crate::grid::bounding_box;
use crate::grid_level::{DAMPING, Level};
use crate::matrix::Matrix;
use crate::parallel;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Vector2};
use rayon::prelude::*;

/// Cell size of the first grid in particle spacings.
const CELL: f64 = 3.0;
/// Vertices at or below which a level is solved directly.
const DIRECT: usize = 150;

/// The preconditioner: set up once per matrix, applied once per iteration.
#[derive(Debug, Clone, Default)]
pub struct Multigrid {
    levels: Vec<Level>,
    direct: Option<Cholesky<f64, Dyn>>,
    starts: Vec<u32>,
    order: Vec<u32>,
    cell_of: Vec<u32>,
    local: Vec<Vector2<f64>>,
    residual: Vec<f64>,
}

impl Multigrid {
    /// Sets up the hierarchy for a matrix whose rows stand at `points`; `kappa` is n0 lambda / 4.
    pub fn set_up(&mut self, matrix: &Matrix, points: &[Vector2<f64>], spacing: f64, kappa: f64) {
        if points.is_empty() {
            self.levels.clear();
            return;
        }
        let size = CELL * spacing;
        let (low, high) = bounding_box(points);
        let origin = low.add_scalar(-0.5 * spacing);
        let cells = |length: f64| ((length + spacing) / size).floor() as usize + 1;
        let (columns, rows) = (cells(high.x - low.x), cells(high.y - low.y));
        self.bin(points, origin, size, columns, rows);
        let mut depth = 0;
        loop {
            if self.levels.len() == depth {
                self.levels.push(Level::default());
            }
            if depth == 0 {
                self.levels[0].reset(columns, rows);
                self.collect_moments(matrix);
            } else {
                let (fine, coarse) = self.levels.split_at_mut(depth);
                fine[depth - 1].coarsen_into(&mut coarse[0]);
            }
            let cell = size * 2f64.powi(depth as i32);
            self.levels[depth].assemble(kappa / (cell * cell));
            depth += 1;
            if self.levels[depth - 1].vertices() <= DIRECT {
                break;
            }
        }
        self.levels.truncate(depth);
        self.direct = factorise(&self.levels[depth - 1]);
    }

    /// Sorts the rows into the cells of the first grid.
    fn bin(&mut self, points: &[Vector2<f64>], origin: Vector2<f64>, size: f64, columns: usize, rows: usize) {
        self.cell_of.clear();
        self.local.clear();
        self.starts.clear();
        self.starts.resize(columns * rows + 1, 0);
        for point in points {
            let place = (point - origin) / size;
            let (x, y) = ((place.x as usize).min(columns - 1), (place.y as usize).min(rows - 1));
            self.cell_of.push((y * columns + x) as u32);
            self.local.push(place - Vector2::new(x as f64, y as f64));
            self.starts[y * columns + x + 1] += 1;
        }
        for cell in 0..columns * rows {
            self.starts[cell + 1] += self.starts[cell];
        }
        let mut next = self.starts.clone();
        self.order.resize(points.len(), 0);
        for (row, &cell) in self.cell_of.iter().enumerate() {
            let slot = &mut next[cell as usize];
            self.order[*slot as usize] = row as u32;
            *slot += 1;
        }
    }

    fn collect_moments(&mut self, matrix: &Matrix) {
        let (starts, order, local) = (&self.starts, &self.order, &self.local);
        self.levels[0].moments.par_iter_mut().enumerate().with_min_len(64).for_each(|(cell, moments)| {
            for &row in &order[starts[cell] as usize..starts[cell + 1] as usize] {
                let place = local[row as usize];
                moments.add(place.x, place.y, matrix.row_sums[row as usize]);
            }
        });
    }

    /// z = M^-1 r, one V-cycle.
    pub fn apply(&mut self, matrix: &Matrix, r: &[f64], z: &mut [f64]) {
        parallel::fill(z, |row| DAMPING * r[row] / matrix.diagonal[row]);
        if self.levels.is_empty() {
            return;
        }
        let mut residual = std::mem::take(&mut self.residual);
        residual.resize(r.len(), 0.0);
        {
            let z = &*z;
            parallel::fill(&mut residual, |row| r[row] - matrix.row_product(row, z));
        }
        self.restrict_particles(&residual);
        self.cycle(0);
        self.prolong_to_particles(z);
        {
            let z = &*z;
            parallel::fill(&mut residual, |row| r[row] - matrix.row_product(row, z));
        }
        z.par_iter_mut()
            .with_min_len(parallel::CHUNK)
            .enumerate()
            .for_each(|(row, value)| *value += DAMPING * residual[row] / matrix.diagonal[row]);
        self.residual = residual;
    }

    fn restrict_particles(&mut self, residual: &[f64]) {
        let (starts, order, local) = (&self.starts, &self.order, &self.local);
        let level = &mut self.levels[0];
        let (columns, rows) = (level.columns, level.rows);
        level.right_side.par_chunks_mut(columns + 1).enumerate().for_each(|(y, line)| {
            for (x, value) in line.iter_mut().enumerate() {
                *value = 0.0;
                for cy in y.saturating_sub(1)..=y.min(rows - 1) {
                    for cx in x.saturating_sub(1)..=x.min(columns - 1) {
                        let cell = cy * columns + cx;
                        for &row in &order[starts[cell] as usize..starts[cell + 1] as usize] {
                            let place = local[row as usize];
                            let wx = if cx == x { 1.0 - place.x } else { place.x };
                            let wy = if cy == y { 1.0 - place.y } else { place.y };
                            *value += wx * wy * residual[row as usize];
                        }
                    }
                }
            }
        });
    }

    fn prolong_to_particles(&self, z: &mut [f64]) {
        let level = &self.levels[0];
        let width = level.columns + 1;
        let (cell_of, local, values) = (&self.cell_of, &self.local, &level.solution);
        z.par_iter_mut().with_min_len(parallel::CHUNK).enumerate().for_each(|(row, value)| {
            let cell = cell_of[row] as usize;
            let corner = (cell / level.columns) * width + cell % level.columns;
            let place = local[row];
            let low = values[corner] * (1.0 - place.x) + values[corner + 1] * place.x;
            let high = values[corner + width] * (1.0 - place.x) + values[corner + width + 1] * place.x;
            *value += low * (1.0 - place.y) + high * place.y;
        });
    }

    fn cycle(&mut self, depth: usize) {
        if depth + 1 == self.levels.len() {
            let level = &mut self.levels[depth];
            match &self.direct {
                Some(factor) => {
                    let solution = factor.solve(&DVector::from_column_slice(&level.right_side));
                    level.solution.copy_from_slice(solution.as_slice());
                }
                None => level.smooth_from_zero(),
            }
            return;
        }
        self.levels[depth].smooth_from_zero();
        self.levels[depth].update_residual();
        let (fine, coarse) = self.levels.split_at_mut(depth + 1);
        fine[depth].restrict_into(&mut coarse[0]);
        self.cycle(depth + 1);
        let (fine, coarse) = self.levels.split_at_mut(depth + 1);
        fine[depth].add_interpolated(&coarse[0]);
        self.levels[depth].smooth_again();
    }
}

/// Dense factors of the coarsest operator. Vertices without particles get a unit diagonal, and a tiny shift keeps
/// water without a free surface positive definite.
fn factorise(level: &Level) -> Option<Cholesky<f64, Dyn>> {
    let size = level.vertices();
    let width = level.columns + 1;
    let mut dense = DMatrix::zeros(size, size);
    let mut unit = vec![0.0; size];
    for v in 0..size {
        for w in 0..size {
            let (dx, dy) = ((w % width) as i64 - (v % width) as i64, (w / width) as i64 - (v / width) as i64);
            if dx.abs() <= 1 && dy.abs() <= 1 {
                dense[(v, w)] = level.stencil[v][(dx + 1 + 3 * (dy + 1)) as usize];
            }
        }
        unit[v] = dense[(v, v)];
        dense[(v, v)] = if unit[v] > 0.0 { unit[v] * (1.0 + 1e-8) } else { 1.0 };
    }
    dense.cholesky()
}
