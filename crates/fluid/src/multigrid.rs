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
use crate::matrix::Matrix;
use crate::parallel;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Vector2};
use rayon::prelude::*;

/// Cell size of the first grid in particle spacings.
const CELL: f64 = 3.0;
/// Damping of the Jacobi smoother.
const DAMPING: f64 = 0.8;
/// Vertices at or below which a level is solved directly.
const DIRECT: usize = 150;

/// Moments of the particles in a cell, with local coordinates (a, b) in 0..1.
#[derive(Debug, Clone, Copy, Default)]
struct Moments {
    count: f64,
    a: f64,
    b: f64,
    aa: f64,
    bb: f64,
    s: f64,
    sa: f64,
    sb: f64,
    sab: f64,
}

impl Moments {
    fn add(&mut self, a: f64, b: f64, s: f64) {
        self.count += 1.0;
        self.a += a;
        self.b += b;
        self.aa += a * a;
        self.bb += b * b;
        self.s += s;
        self.sa += s * a;
        self.sb += s * b;
        self.sab += s * a * b;
    }

    /// Adds a child cell at place (x, y) in {0, 1}^2 of this cell: a_parent = (a + x) / 2.
    fn add_child(&mut self, child: &Moments, x: f64, y: f64) {
        self.count += child.count;
        self.a += 0.5 * (child.a + x * child.count);
        self.b += 0.5 * (child.b + y * child.count);
        self.aa += 0.25 * (child.aa + 2.0 * x * child.a + x * x * child.count);
        self.bb += 0.25 * (child.bb + 2.0 * y * child.b + y * y * child.count);
        self.s += child.s;
        self.sa += 0.5 * (child.sa + x * child.s);
        self.sb += 0.5 * (child.sb + y * child.s);
        self.sab += 0.25 * (child.sab + x * child.sb + y * child.sa + x * y * child.s);
    }

    /// Contribution to the operator between corner k and corner m (k = x + 2 y), without kappa / H^2.
    fn stiffness(&self) -> [[f64; 4]; 4] {
        let along_b = [self.count - 2.0 * self.b + self.bb, self.b - self.bb, self.bb];
        let along_a = [self.count - 2.0 * self.a + self.aa, self.a - self.aa, self.aa];
        let mut out = [[0.0; 4]; 4];
        for (k, row) in out.iter_mut().enumerate() {
            for (m, value) in row.iter_mut().enumerate() {
                let (kx, ky, mx, my) = (k & 1, k >> 1, m & 1, m >> 1);
                let sign = |p: usize, q: usize| if p == q { 1.0 } else { -1.0 };
                *value = sign(kx, mx) * along_b[ky + my] + sign(ky, my) * along_a[kx + mx];
            }
        }
        out
    }

    /// Lumped boundary weight of each corner.
    fn boundary(&self) -> [f64; 4] {
        [self.s - self.sa - self.sb + self.sab, self.sa - self.sab, self.sb - self.sab, self.sab]
    }
}

/// One grid level: a nine-point operator on vertices.
#[derive(Debug, Clone, Default)]
struct Level {
    columns: usize,
    rows: usize,
    moments: Vec<Moments>,
    /// Entry (dx + 1) + 3 (dy + 1) of each vertex.
    stencil: Vec<[f64; 9]>,
    inverse_diagonal: Vec<f64>,
    right_side: Vec<f64>,
    solution: Vec<f64>,
    residual: Vec<f64>,
}

impl Level {
    fn vertices(&self) -> usize {
        (self.columns + 1) * (self.rows + 1)
    }

    fn reset(&mut self, columns: usize, rows: usize) {
        (self.columns, self.rows) = (columns, rows);
        self.moments.clear();
        self.moments.resize(columns * rows, Moments::default());
        for field in [&mut self.inverse_diagonal, &mut self.right_side, &mut self.solution, &mut self.residual] {
            field.clear();
            field.resize((columns + 1) * (rows + 1), 0.0);
        }
    }

    fn coarsen_into(&self, coarse: &mut Level) {
        coarse.reset(self.columns.div_ceil(2), self.rows.div_ceil(2));
        for y in 0..self.rows {
            for x in 0..self.columns {
                let parent = &mut coarse.moments[(y / 2) * coarse.columns + x / 2];
                parent.add_child(&self.moments[y * self.columns + x], (x % 2) as f64, (y % 2) as f64);
            }
        }
    }

    /// Assembles the operator; `scale` is kappa / H^2.
    fn assemble(&mut self, scale: f64) {
        let width = self.columns + 1;
        self.stencil.clear();
        self.stencil.resize(self.vertices(), [0.0; 9]);
        for y in 0..self.rows {
            for x in 0..self.columns {
                let cell = &self.moments[y * self.columns + x];
                if cell.count == 0.0 {
                    continue;
                }
                let (stiffness, boundary) = (cell.stiffness(), cell.boundary());
                for (k, line) in stiffness.iter().enumerate() {
                    let (kx, ky) = (k & 1, k >> 1);
                    let entries = &mut self.stencil[(y + ky) * width + x + kx];
                    for (m, value) in line.iter().enumerate() {
                        let (mx, my) = (m & 1, m >> 1);
                        entries[(mx + 1 - kx) + 3 * (my + 1 - ky)] += scale * value;
                    }
                    entries[4] += boundary[k];
                }
            }
        }
        for (inverse, entries) in self.inverse_diagonal.iter_mut().zip(&self.stencil) {
            *inverse = if entries[4] > 0.0 { 1.0 / entries[4] } else { 0.0 };
        }
    }

    fn product(&self, vertex: usize, x: &[f64]) -> f64 {
        let width = self.columns + 1;
        let (column, row) = (vertex % width, vertex / width);
        let entries = &self.stencil[vertex];
        let mut sum = 0.0;
        for dy in (if row == 0 { 1 } else { 0 })..(if row == self.rows { 2 } else { 3 }) {
            for dx in (if column == 0 { 1 } else { 0 })..(if column == self.columns { 2 } else { 3 }) {
                sum += entries[dx + 3 * dy] * x[vertex + dx + dy * width - 1 - width];
            }
        }
        sum
    }

    fn smooth_from_zero(&mut self) {
        for ((x, b), inverse) in self.solution.iter_mut().zip(&self.right_side).zip(&self.inverse_diagonal) {
            *x = DAMPING * inverse * b;
        }
    }

    fn update_residual(&mut self) {
        let mut residual = std::mem::take(&mut self.residual);
        parallel::fill(&mut residual, |v| self.right_side[v] - self.product(v, &self.solution));
        self.residual = residual;
    }

    fn smooth_again(&mut self) {
        self.update_residual();
        for ((x, r), inverse) in self.solution.iter_mut().zip(&self.residual).zip(&self.inverse_diagonal) {
            *x += DAMPING * inverse * r;
        }
    }

    /// Residual times the transpose of bilinear interpolation, gathered by coarse vertex.
    fn restrict_into(&self, coarse: &mut Level) {
        let width = self.columns + 1;
        let coarse_width = coarse.columns + 1;
        for (vertex, value) in coarse.right_side.iter_mut().enumerate() {
            let (x, y) = (2 * (vertex % coarse_width) as i64, 2 * (vertex / coarse_width) as i64);
            *value = 0.0;
            for (dy, wy) in [(-1, 0.5), (0, 1.0), (1, 0.5)] {
                for (dx, wx) in [(-1, 0.5), (0, 1.0), (1, 0.5)] {
                    let (fx, fy) = (x + dx, y + dy);
                    if (0..=self.columns as i64).contains(&fx) && (0..=self.rows as i64).contains(&fy) {
                        *value += wx * wy * self.residual[fy as usize * width + fx as usize];
                    }
                }
            }
        }
    }

    fn add_interpolated(&mut self, coarse: &Level) {
        let width = self.columns + 1;
        let coarse_width = coarse.columns + 1;
        for (vertex, value) in self.solution.iter_mut().enumerate() {
            if self.inverse_diagonal[vertex] == 0.0 {
                continue;
            }
            let (x, y) = (vertex % width, vertex / width);
            let (x0, x1, y0, y1) = (x / 2, x.div_ceil(2), y / 2, y.div_ceil(2));
            let at = |cx: usize, cy: usize| coarse.solution[cy * coarse_width + cx];
            *value += 0.25 * (at(x0, y0) + at(x1, y0) + at(x0, y1) + at(x1, y1));
        }
    }
}

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
