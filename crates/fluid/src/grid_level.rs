//! One grid of the multigrid preconditioner: moments of its cells, a nine-point operator on its vertices, transfers.

use crate::parallel;

/// Damping of the Jacobi smoother.
pub const DAMPING: f64 = 0.8;

/// Moments of the particles in a cell, with local coordinates (a, b) in 0..1.
#[derive(Debug, Clone, Copy, Default)]
pub struct Moments {
    pub count: f64,
    pub a: f64,
    pub b: f64,
    pub aa: f64,
    pub bb: f64,
    pub s: f64,
    pub sa: f64,
    pub sb: f64,
    pub sab: f64,
}

impl Moments {
    pub fn add(&mut self, a: f64, b: f64, s: f64) {
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
    pub fn add_child(&mut self, child: &Moments, x: f64, y: f64) {
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
    pub fn stiffness(&self) -> [[f64; 4]; 4] {
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
    pub fn boundary(&self) -> [f64; 4] {
        [self.s - self.sa - self.sb + self.sab, self.sa - self.sab, self.sb - self.sab, self.sab]
    }
}

/// One grid level: a nine-point operator on vertices.
#[derive(Debug, Clone, Default)]
pub struct Level {
    pub columns: usize,
    pub rows: usize,
    pub moments: Vec<Moments>,
    /// Entry (dx + 1) + 3 (dy + 1) of each vertex.
    pub stencil: Vec<[f64; 9]>,
    pub inverse_diagonal: Vec<f64>,
    pub right_side: Vec<f64>,
    pub solution: Vec<f64>,
    pub residual: Vec<f64>,
}

impl Level {
    pub fn vertices(&self) -> usize {
        (self.columns + 1) * (self.rows + 1)
    }

    pub fn reset(&mut self, columns: usize, rows: usize) {
        (self.columns, self.rows) = (columns, rows);
        self.moments.clear();
        self.moments.resize(columns * rows, Moments::default());
        for field in [&mut self.inverse_diagonal, &mut self.right_side, &mut self.solution, &mut self.residual] {
            field.clear();
            field.resize((columns + 1) * (rows + 1), 0.0);
        }
    }

    pub fn coarsen_into(&self, coarse: &mut Level) {
        coarse.reset(self.columns.div_ceil(2), self.rows.div_ceil(2));
        for y in 0..self.rows {
            for x in 0..self.columns {
                let parent = &mut coarse.moments[(y / 2) * coarse.columns + x / 2];
                parent.add_child(&self.moments[y * self.columns + x], (x % 2) as f64, (y % 2) as f64);
            }
        }
    }

    /// Assembles the operator; `scale` is kappa / H^2.
    pub fn assemble(&mut self, scale: f64) {
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

    pub fn product(&self, vertex: usize, x: &[f64]) -> f64 {
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

    pub fn smooth_from_zero(&mut self) {
        for ((x, b), inverse) in self.solution.iter_mut().zip(&self.right_side).zip(&self.inverse_diagonal) {
            *x = DAMPING * inverse * b;
        }
    }

    pub fn update_residual(&mut self) {
        let mut residual = std::mem::take(&mut self.residual);
        parallel::fill(&mut residual, |v| self.right_side[v] - self.product(v, &self.solution));
        self.residual = residual;
    }

    pub fn smooth_again(&mut self) {
        self.update_residual();
        for ((x, r), inverse) in self.solution.iter_mut().zip(&self.residual).zip(&self.inverse_diagonal) {
            *x += DAMPING * inverse * r;
        }
    }

    /// Residual times the transpose of bilinear interpolation, gathered by coarse vertex.
    pub fn restrict_into(&self, coarse: &mut Level) {
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

    pub fn add_interpolated(&mut self, coarse: &Level) {
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
