//! Conjugate gradients, preconditioned by the multigrid.

use super::level::SMOOTHING;
use super::multigrid::{Cycle, Multigrid};
use super::sliced_matrix::Matrix;
use crate::parallel::{self, CHUNK};
use keys::keys;
use rayon::prelude::*;

keys! {
    /// Pressure solver.
    pub struct SolveParameters {
        /// Relative residual at which the iteration stops; 0 takes 1e-8 where a body answers to the load, 1e-5 with the
        /// scheme `voronoi` and 1e-3 with `mps` elsewhere.
        tolerance: f64 = 0.0, in 0.0 to 0.1;
        /// Iterations after which the solve is an error.
        maximum_iterations: usize = 500, in 1 to 1e6;
    }
}

/// Vectors of the iteration: `K` systems with the same matrix side by side.
#[derive(Debug, Clone, Default)]
pub struct ConjugateGradient<const K: usize> {
    residual: Vec<[f64; K]>,
    direction: Vec<[f64; K]>,
    product: Vec<[f64; K]>,
    /// M^-1 r / |b|: the scale keeps it in the range of single precision.
    smoothed: Vec<[f32; K]>,
    preconditioned: Vec<[f32; K]>,
    cycle: Cycle<K>,
    partial: Vec<[f64; K]>,
}

/// How a solve ended.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Outcome {
    /// Iterations done.
    pub iterations: usize,
    /// |b - A x| / |b|, the largest of all systems.
    pub residual: f64,
}

/// Where a solve starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Guess {
    /// From what stands in `x`.
    Given,
    /// From zero, whatever stands in `x`.
    Zero,
}

impl<const K: usize> ConjugateGradient<K> {
    /// Solves A x = b until |r| <= tolerance |b|. Systems that are done wait for the others; those with b = 0 have x = 0.
    pub fn solve(
        &mut self,
        matrix: &Matrix,
        preconditioner: &Multigrid,
        b: &[[f64; K]],
        x: &mut [[f64; K]],
        guess: Guess,
        parameters: &SolveParameters,
    ) -> Outcome {
        self.resize(b.len());
        let norm = parallel::sums(b.len(), &mut self.partial, |i| b[i].map(|value| value * value)).map(f64::sqrt);
        if norm == [0.0; K] {
            x.fill([0.0; K]);
            self.residual.fill([0.0; K]);
            return Outcome::default();
        }
        let mut squares = match guess {
            Guess::Given => self.start(matrix, b, x, &norm),
            Guess::Zero => self.start_from_zero(b, x, &norm),
        };
        let scale = norm.map(|norm| if norm > 0.0 { 1.0 / norm } else { 0.0 });
        self.smooth(matrix, &scale);
        let mut rho = [0.0; K];
        for iteration in 0..=parameters.maximum_iterations {
            let left: [f64; K] = std::array::from_fn(|k| squares[k].sqrt() * scale[k]);
            let residual = left.iter().fold(0.0, |most: f64, &value| if value <= most { most } else { value });
            let stop = residual <= parameters.tolerance || iteration == parameters.maximum_iterations;
            if stop || !residual.is_finite() {
                return Outcome { iterations: iteration, residual };
            }
            let going: [bool; K] = std::array::from_fn(|k| left[k] > parameters.tolerance);
            let next = self.precondition(matrix, preconditioner, &scale);
            let beta = std::array::from_fn(|k| if iteration > 0 && going[k] { next[k] / rho[k] } else { 0.0 });
            rho = next;
            let curvature = self.turn(matrix, &beta);
            let alpha = std::array::from_fn(|k| if going[k] { rho[k] / curvature[k] } else { 0.0 });
            squares = self.advance(matrix, x, &alpha, &scale);
        }
        Outcome { iterations: parameters.maximum_iterations, residual: f64::NAN }
    }

    /// b - A x of the last solve.
    pub fn residual(&self) -> &[[f64; K]] {
        &self.residual
    }

    fn resize(&mut self, size: usize) {
        for vector in [&mut self.residual, &mut self.direction, &mut self.product] {
            vector.resize(size, [0.0; K]);
        }
        self.smoothed.resize(size, [0.0; K]);
        self.preconditioned.resize(size, [0.0; K]);
    }

    /// r = b - A x; returns |r|^2.
    fn start(&mut self, matrix: &Matrix, b: &[[f64; K]], x: &mut [[f64; K]], norm: &[f64; K]) -> [f64; K] {
        for k in (0..K).filter(|&k| norm[k] == 0.0) {
            x.iter_mut().for_each(|x| x[k] = 0.0);
        }
        let x = &*x;
        self.partial.clear();
        matrix.multiply_with(x, &mut self.residual, &mut self.partial, |row, sums: [f64; K], residual| {
            *residual = std::array::from_fn(|k| b[row][k] - (matrix.diagonal[row] * x[row][k] - sums[k]));
            residual.map(|value| value * value)
        })
    }

    /// The same with x = 0.
    fn start_from_zero(&mut self, b: &[[f64; K]], x: &mut [[f64; K]], norm: &[f64; K]) -> [f64; K] {
        x.fill([0.0; K]);
        self.residual.copy_from_slice(b);
        norm.map(|norm| norm * norm)
    }

    /// The first smoothing of the residual.
    fn smooth(&mut self, matrix: &Matrix, scale: &[f64; K]) {
        let residual = &self.residual;
        parallel::fill(&mut self.smoothed, |row| smooth(&residual[row], scale, matrix.diagonal[row]));
    }

    /// M^-1 r / |b|, one V-cycle between two smoothings; returns r . M^-1 r / |b|.
    fn precondition(&mut self, matrix: &Matrix, preconditioner: &Multigrid, scale: &[f64; K]) -> [f64; K] {
        let residual = &self.residual;
        let smoothed = &mut self.smoothed;
        preconditioner.correct(matrix, residual, scale, smoothed, &mut self.cycle, &mut self.partial);
        let smoothed = &self.smoothed;
        matrix.multiply_with(smoothed, &mut self.preconditioned, &mut self.partial, |row, sums: [f32; K], out| {
            let diagonal = matrix.diagonal[row] as f32;
            let (r, z) = (&residual[row], &smoothed[row]);
            let rest = |k: usize| (r[k] * scale[k]) as f32 - (diagonal * z[k] - sums[k]);
            *out = std::array::from_fn(|k| z[k] + SMOOTHING * rest(k) / diagonal);
            std::array::from_fn(|k| r[k] * f64::from(out[k]))
        })
    }

    /// Direction p = M^-1 r + beta p and product A p; returns p . A p.
    fn turn(&mut self, matrix: &Matrix, beta: &[f64; K]) -> [f64; K] {
        let preconditioned = &self.preconditioned;
        let directions = self.direction.par_iter_mut().zip(preconditioned).with_min_len(CHUNK);
        directions.for_each(|(direction, z)| {
            // What an earlier solve left behind may not be finite.
            let before = |k: usize| if beta[k] == 0.0 { 0.0 } else { beta[k] * direction[k] };
            *direction = std::array::from_fn(|k| f64::from(z[k]) + before(k));
        });
        let direction = &self.direction;
        matrix.multiply_with(direction, &mut self.product, &mut self.partial, |row, sums: [f64; K], product| {
            let own = &direction[row];
            *product = std::array::from_fn(|k| matrix.diagonal[row] * own[k] - sums[k]);
            std::array::from_fn(|k| own[k] * product[k])
        })
    }

    /// x += alpha p, r -= alpha A p, and the first smoothing of r; returns |r|^2.
    fn advance(&mut self, matrix: &Matrix, x: &mut [[f64; K]], alpha: &[f64; K], scale: &[f64; K]) -> [f64; K] {
        let Self { residual, direction, product, smoothed, partial, .. } = self;
        partial.resize(residual.len().div_ceil(CHUNK), [0.0; K]);
        let values = (x.par_chunks_mut(CHUNK), residual.par_chunks_mut(CHUNK), smoothed.par_chunks_mut(CHUNK));
        let chunks = (values.0, values.1, values.2, &mut *partial).into_par_iter().enumerate();
        chunks.for_each(|(chunk, (x, residual, smoothed, partial))| {
            *partial = [0.0; K];
            for (i, ((x, r), z)) in x.iter_mut().zip(residual).zip(smoothed).enumerate() {
                let row = chunk * CHUNK + i;
                for k in 0..K {
                    x[k] += alpha[k] * direction[row][k];
                    r[k] -= alpha[k] * product[row][k];
                    partial[k] += r[k] * r[k];
                }
                *z = smooth(r, scale, matrix.diagonal[row]);
            }
        });
        parallel::total(partial)
    }
}

impl ConjugateGradient<1> {
    /// Solves one system from the guess in `x`.
    pub fn solve_one(
        &mut self,
        matrix: &Matrix,
        preconditioner: &Multigrid,
        b: &[f64],
        x: &mut [f64],
        parameters: &SolveParameters,
    ) -> Outcome {
        self.solve(matrix, preconditioner, b.as_chunks().0, x.as_chunks_mut().0, Guess::Given, parameters)
    }
}

/// One damped Jacobi step from zero.
fn smooth<const K: usize>(residual: &[f64; K], scale: &[f64; K], diagonal: f64) -> [f32; K] {
    let share = f64::from(SMOOTHING) / diagonal;
    std::array::from_fn(|k| (residual[k] * scale[k] * share) as f32)
}

#[cfg(test)]
mod tests {
    use super::super::sliced_matrix::Entry;
    use super::*;
    use faer::linalg::solvers::Solve as _;
    use faer::sparse::{SparseColMat, Triplet};
    use nalgebra::Vector2;

    /// A jittered square of `side` x `side` points with unit spacing, whose uppermost row is zero: weights 3.1 / r - 1
    /// within 3.1 spacings.
    fn system(side: usize) -> (Matrix, Multigrid, Vec<f64>) {
        let noise = |k: usize| ((k * 7919 + 31) % 1009) as f64 / 1009.0 - 0.5;
        let points: Vec<_> = (0..side * side)
            .map(|k| Vector2::new((k % side) as f64 + 0.3 * noise(2 * k), (k / side) as f64 + 0.3 * noise(2 * k + 1)))
            .collect();
        let near = |i: usize| {
            let (column, row) = ((i % side) as i64, (i / side) as i64);
            let inside = |k: i64| (0..side as i64).contains(&k);
            let places = (-4..=4).flat_map(move |dy| (-4..=4).map(move |dx| (column + dx, row + dy)));
            places.filter(move |&(x, y)| inside(x) && inside(y)).map(move |(x, y)| y as usize * side + x as usize)
        };
        let weight = |i: usize, j: usize| (3.1 / (points[i] - points[j]).norm().max(0.3) - 1.0).max(0.0);
        let unknowns = side * (side - 1);
        let (mut matrix, mut multigrid) = (Matrix::default(), Multigrid::default());
        matrix.set_rows(unknowns, |i, out| {
            let others = near(i).filter(|&j| j != i && j < unknowns && weight(i, j) > 0.0);
            out.extend(others.map(|j| Entry { column: j as u32, weight: weight(i, j) as f32 }));
        });
        let tied = |i: usize| near(i).filter(|&j| j >= unknowns).map(|j| weight(i, j)).sum();
        matrix.row_sums = (0..unknowns).map(tied).collect();
        matrix.close(false);
        let points = &points[..unknowns];
        // A quarter of sum w r^2 on the lattice.
        let lattice = (-3_i32..=3).flat_map(|x| (-3_i32..=3).map(move |y| f64::from(x * x + y * y)));
        let kappa = 0.25 * lattice.filter(|r2| *r2 > 0.0).map(|r2| (3.1 / r2.sqrt() - 1.0).max(0.0) * r2).sum::<f64>();
        multigrid.set_up(&matrix.row_sums, points, 1.0, kappa);
        let b = points.iter().map(|point| 1.0 + (point.x * 0.37).sin() * (point.y * 0.21).cos()).collect();
        (matrix, multigrid, b)
    }

    fn cholesky(matrix: &Matrix, b: &[f64]) -> Vec<f64> {
        let mut triplets = Vec::new();
        for row in 0..matrix.size() {
            triplets.push(Triplet::new(row, row, matrix.diagonal[row]));
            let entries = matrix.entries(row);
            triplets.extend(entries.map(|entry| Triplet::new(row, entry.column as usize, -f64::from(entry.weight))));
        }
        let sparse =
            SparseColMat::<usize, f64>::try_new_from_triplets(matrix.size(), matrix.size(), &triplets).unwrap();
        let factor = sparse.sp_cholesky(faer::Side::Lower).unwrap();
        let right = faer::Mat::from_fn(b.len(), 1, |i, _| b[i]);
        let solution = factor.solve(&right);
        (0..b.len()).map(|i| solution[(i, 0)]).collect()
    }

    #[test]
    fn agrees_with_a_direct_solve() {
        let (matrix, multigrid, b) = system(40);
        let expected = cholesky(&matrix, &b);
        let parameters = SolveParameters { tolerance: 1e-11, maximum_iterations: 100 };
        let mut x = vec![0.0; b.len()];
        let outcome = ConjugateGradient::default().solve_one(&matrix, &multigrid, &b, &mut x, &parameters);
        let largest = expected.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let worst = x.iter().zip(&expected).map(|(a, e)| (a - e).abs()).fold(0.0, f64::max);
        assert!(worst < 1e-8 * largest, "largest difference {worst} against {largest}, {outcome:?}");
    }

    #[test]
    fn iterations_do_not_grow_with_size() {
        let parameters = SolveParameters { tolerance: 1e-6, maximum_iterations: 100 };
        let iterations: Vec<usize> = [24, 48, 96, 192]
            .into_iter()
            .map(|side| {
                let (matrix, multigrid, b) = system(side);
                let mut x = vec![0.0; b.len()];
                ConjugateGradient::default().solve_one(&matrix, &multigrid, &b, &mut x, &parameters).iterations
            })
            .collect();
        assert!(iterations.iter().all(|&count| count <= 9), "iterations {iterations:?} for 576 to 36864 unknowns");
        assert!(iterations[3] <= iterations[0] + 1, "iterations grow: {iterations:?}");
    }
}
