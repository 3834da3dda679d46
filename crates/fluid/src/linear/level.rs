//! One grid of the multigrid preconditioner: moments of its cells, a nine-point operator on its vertices, transfers.
//!
//! Only cells with particles, and their corners, exist: drops far from the rest cost nothing but themselves.

use crate::parallel;

/// Damping of the Jacobi smoother.
pub const SMOOTHING: f32 = 0.8;
/// Place in a map of a cell or vertex that does not exist.
const NONE: u32 = u32::MAX;
/// Weights of the nine fine vertices around a coarse one, and of its own.
const WEIGHTS: [f32; 9] = [0.25, 0.5, 0.25, 0.5, 1.0, 0.5, 0.25, 0.5, 0.25];
/// Along one axis, shares of the coarse vertices -1..1 in the value at places -2..2 of the fine grid.
const SHARES: [[f32; 3]; 5] = [[1.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.5, 0.5], [0.0, 0.0, 1.0]];

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

    /// Contribution to the operator between corner `k` and all corners (k = x + 2 y), without kappa / H^2.
    pub fn stiffness(&self, k: usize) -> [f64; 4] {
        let along_b = [self.count - 2.0 * self.b + self.bb, self.b - self.bb, self.bb];
        let along_a = [self.count - 2.0 * self.a + self.aa, self.a - self.aa, self.aa];
        let sign = |p: usize, q: usize| if p == q { 1.0 } else { -1.0 };
        std::array::from_fn(|m| {
            let (kx, ky, mx, my) = (k & 1, k >> 1, m & 1, m >> 1);
            sign(kx, mx) * along_b[ky + my] + sign(ky, my) * along_a[kx + mx]
        })
    }

    /// Lumped boundary weight of each corner.
    pub fn boundary(&self) -> [f64; 4] {
        [self.s - self.sa - self.sb + self.sab, self.sa - self.sab, self.sb - self.sab, self.sab]
    }
}

/// One grid level: a nine-point operator on the vertices that exist.
#[derive(Debug, Clone, Default)]
pub struct Level {
    columns: usize,
    rows: usize,
    /// Place of each cell in the full grid, ascending.
    pub cells: Vec<u32>,
    /// Vertices at the corners of each cell, k = x + 2 y.
    pub corners: Vec<[u32; 4]>,
    /// Cells around each vertex, k = x + 2 y; the number of cells for none.
    pub cells_around: Vec<[u32; 4]>,
    /// Place of each vertex in the full grid, ascending.
    vertices: Vec<u32>,
    /// Vertices around each one, entry (dx + 1) + 3 (dy + 1); the number of vertices for none.
    around: Vec<[u32; 9]>,
    /// Operator, in the same order.
    stencil: Vec<[f32; 9]>,
    /// Damping over the diagonal.
    inverse: Vec<f32>,
    /// Vertices of the next level whose mean each vertex takes over.
    parents: Vec<[u32; 4]>,
    /// Vertices of the finer level around each one.
    children: Vec<[u32; 9]>,
    map: Vec<u32>,
}

impl Level {
    /// Number of vertices.
    pub fn size(&self) -> usize {
        self.vertices.len()
    }

    /// Takes the cells where `exists` says so from a full grid, and numbers them and their vertices. Returns through
    /// `map` the number of every cell of the full grid.
    pub fn lay_out(&mut self, columns: usize, rows: usize, exists: impl Fn(usize) -> bool, map: &mut Vec<u32>) {
        (self.columns, self.rows) = (columns, rows);
        self.cells.clear();
        map.clear();
        for cell in 0..columns * rows {
            let known = exists(cell);
            map.push(if known { self.cells.len() as u32 } else { NONE });
            if known {
                self.cells.push(cell as u32);
            }
        }
        self.number_vertices();
    }

    fn number_vertices(&mut self) {
        let width = self.columns + 1;
        self.map.clear();
        self.map.resize(width * (self.rows + 1), NONE);
        let corners = |cell: u32| {
            let (x, y) = place(cell, self.columns);
            let first = y * width + x;
            [first, first + 1, first + width, first + width + 1]
        };
        for &cell in &self.cells {
            corners(cell).into_iter().for_each(|vertex| self.map[vertex] = 0);
        }
        self.vertices.clear();
        for (place, number) in self.map.iter_mut().enumerate().filter(|(_, number)| **number != NONE) {
            *number = self.vertices.len() as u32;
            self.vertices.push(place as u32);
        }
        self.corners.clear();
        self.corners.extend(self.cells.iter().map(|&cell| corners(cell).map(|vertex| self.map[vertex])));
    }

    /// Finds the cells around each vertex; `map` is what [`Level::lay_out`] returned.
    pub fn find_cells_around(&mut self, map: &[u32]) {
        let (columns, rows, none) = (self.columns, self.rows, self.cells.len() as u32);
        self.cells_around.resize(self.vertices.len(), [0; 4]);
        let vertices = &self.vertices;
        parallel::fill(&mut self.cells_around, |v| {
            let (x, y) = place(vertices[v], columns + 1);
            std::array::from_fn(|k| {
                let (cx, cy) = ((x + (k & 1)).wrapping_sub(1), (y + (k >> 1)).wrapping_sub(1));
                if cx < columns && cy < rows { map[cy * columns + cx].min(none) } else { none }
            })
        });
    }

    /// The level of half as many cells each way.
    pub fn coarsen_into(&mut self, coarse: &mut Level, map: &mut Vec<u32>, marks: &mut Vec<bool>) {
        let (columns, rows) = (self.columns.div_ceil(2), self.rows.div_ceil(2));
        let parent = |cell: u32| {
            let (x, y) = place(cell, self.columns);
            (y / 2) * columns + x / 2
        };
        marks.clear();
        marks.resize(columns * rows, false);
        self.cells.iter().for_each(|&cell| marks[parent(cell)] = true);
        coarse.lay_out(columns, rows, |cell| marks[cell], map);
        self.find_relatives(coarse);
    }

    fn find_relatives(&mut self, coarse: &mut Level) {
        let (width, coarse_width) = (self.columns + 1, coarse.columns + 1);
        self.parents.resize(self.vertices.len(), [0; 4]);
        let (vertices, map) = (&self.vertices, &coarse.map);
        parallel::fill(&mut self.parents, |v| {
            let (x, y) = place(vertices[v], width);
            let at = |cx: usize, cy: usize| map[cy * coarse_width + cx];
            let (x0, x1, y0, y1) = (x / 2, x.div_ceil(2), y / 2, y.div_ceil(2));
            [at(x0, y0), at(x1, y0), at(x0, y1), at(x1, y1)]
        });
        let none = self.vertices.len() as u32;
        coarse.children.resize(coarse.vertices.len(), [0; 9]);
        let (columns, rows, map) = (self.columns, self.rows, &self.map);
        let vertices = &coarse.vertices;
        parallel::fill(&mut coarse.children, |v| {
            let (x, y) = place(vertices[v], coarse_width);
            neighbours(map, columns, rows, 2 * x, 2 * y, none)
        });
    }

    /// Assembles the operator from the moments of the cells; `scale` is kappa / H^2.
    pub fn assemble(&mut self, moments: &[Moments], scale: f64) {
        let cells_around = &self.cells_around;
        self.stencil.resize(cells_around.len(), [0.0; 9]);
        parallel::fill(&mut self.stencil, |v| {
            let mut entries = [0.0; 9];
            for (place, &cell) in cells_around[v].iter().enumerate() {
                let Some(cell) = moments.get(cell as usize) else { continue };
                // Seen from the cell, the vertex is the opposite corner.
                let (k, kx, ky) = (3 - place, 1 - (place & 1), 1 - (place >> 1));
                for (m, value) in cell.stiffness(k).iter().enumerate() {
                    entries[((m & 1) + 1 - kx) + 3 * ((m >> 1) + 1 - ky)] += scale * value;
                }
                entries[4] += cell.boundary()[k];
            }
            entries.map(|value| value as f32)
        });
        self.complete();
    }

    /// The Galerkin product of the finer level's operator with bilinear interpolation.
    pub fn assemble_from(&mut self, fine: &Level) {
        let children = &self.children;
        self.stencil.resize(children.len(), [0.0; 9]);
        parallel::fill(&mut self.stencil, |v| {
            // Rows of the children, by places -2..2 of the fine grid around this vertex.
            let mut rows = [[0.0_f32; 5]; 5];
            for (k, (&child, weight)) in children[v].iter().zip(WEIGHTS).enumerate() {
                let Some(entries) = fine.stencil.get(child as usize) else { continue };
                for (m, value) in entries.iter().enumerate() {
                    rows[k / 3 + m / 3][k % 3 + m % 3] += weight * value;
                }
            }
            let mut entries = [0.0; 9];
            for (y, row) in rows.iter().enumerate() {
                for (x, value) in row.iter().enumerate() {
                    for (m, entry) in entries.iter_mut().enumerate() {
                        *entry += value * SHARES[x][m % 3] * SHARES[y][m / 3];
                    }
                }
            }
            entries
        });
        self.complete();
    }

    /// Who is around each vertex, and the damped inverse of the diagonal.
    fn complete(&mut self) {
        let (columns, rows, none) = (self.columns, self.rows, self.vertices.len() as u32);
        let (map, vertices, stencil) = (&self.map, &self.vertices, &self.stencil);
        self.around.resize(vertices.len(), [0; 9]);
        self.inverse.resize(vertices.len(), 0.0);
        parallel::fill(&mut self.around, |v| {
            let (x, y) = place(vertices[v], columns + 1);
            neighbours(map, columns, rows, x, y, none)
        });
        parallel::fill(&mut self.inverse, |v| if stencil[v][4] > 0.0 { SMOOTHING / stencil[v][4] } else { 0.0 });
    }

    /// Entries of the operator, for factors: vertex, other vertex, value.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let lists = self.around.iter().zip(&self.stencil).enumerate();
        lists.flat_map(|(v, (around, values))| {
            let known = around.iter().zip(values).filter(|(w, _)| (**w as usize) < self.around.len());
            known.map(move |(&w, &value)| (v, w as usize, f64::from(value)))
        })
    }

    /// One damped Jacobi step from zero.
    pub fn smooth_from_zero<const K: usize>(&self, right: &[[f32; K]], out: &mut [[f32; K]]) {
        parallel::fill(&mut out[..self.size()], |v| right[v].map(|value| value * self.inverse[v]));
    }

    /// What is left of the right side.
    pub fn residual<const K: usize>(&self, right: &[[f32; K]], x: &[[f32; K]], out: &mut [[f32; K]]) {
        parallel::fill(&mut out[..self.size()], |v| {
            let mut left = right[v];
            for (&w, &value) in self.around[v].iter().zip(&self.stencil[v]) {
                let x = &x[w as usize];
                left.iter_mut().zip(x).for_each(|(left, x)| *left -= value * x);
            }
            left
        });
    }

    /// One damped Jacobi step.
    pub fn smooth_again<const K: usize>(&self, residual: &[[f32; K]], x: &mut [[f32; K]]) {
        for ((x, residual), inverse) in x.iter_mut().zip(&residual[..self.size()]).zip(&self.inverse) {
            x.iter_mut().zip(residual).for_each(|(x, residual)| *x += inverse * residual);
        }
    }

    /// The finer level's residual times the transpose of bilinear interpolation.
    pub fn restrict<const K: usize>(&self, fine: &[[f32; K]], out: &mut [[f32; K]]) {
        parallel::fill(&mut out[..self.size()], |v| {
            let mut sum = [0.0; K];
            for (&child, weight) in self.children[v].iter().zip(WEIGHTS) {
                sum.iter_mut().zip(&fine[child as usize]).for_each(|(sum, value)| *sum += weight * value);
            }
            sum
        });
    }

    /// Adds the next level's values, interpolated.
    pub fn add_interpolated<const K: usize>(&self, coarse: &[[f32; K]], x: &mut [[f32; K]]) {
        for (x, parents) in x.iter_mut().zip(&self.parents) {
            for &parent in parents {
                x.iter_mut().zip(&coarse[parent as usize]).for_each(|(x, value)| *x += 0.25 * value);
            }
        }
    }
}

/// Column and row of a cell or vertex in rows of `width`.
fn place(number: u32, width: usize) -> (usize, usize) {
    (number as usize % width, number as usize / width)
}

/// Numbers of the vertices around (x, y), `none` where there is none.
fn neighbours(map: &[u32], columns: usize, rows: usize, x: usize, y: usize, none: u32) -> [u32; 9] {
    std::array::from_fn(|k| {
        let (nx, ny) = ((x + k % 3).wrapping_sub(1), (y + k / 3).wrapping_sub(1));
        if nx <= columns && ny <= rows { map[ny * (columns + 1) + nx].min(none) } else { none }
    })
}
