//! Conjugate gradients for the pressure, preconditioned by the multigrid.

use crate::matrix::Matrix;
use crate::multigrid::Multigrid;
use crate::parallel::{self, update};
use crate::parameters::SolveParameters;

/// Vectors of the iteration.
#[derive(Debug, Clone, Default)]
pub struct ConjugateGradient {
    r: Vec<f64>,
    z: Vec<f64>,
    direction: Vec<f64>,
    product: Vec<f64>,
    partial: Vec<f64>,
}

/// How a solve ended.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Outcome {
    /// Iterations done.
    pub iterations: usize,
    /// |b - A x| / |b|.
    pub residual: f64,
}

impl ConjugateGradient {
    /// Solves A x = b from the starting guess in `x` until |r| <= tolerance |b|.
    pub fn solve(
        &mut self,
        matrix: &Matrix,
        preconditioner: &mut Multigrid,
        b: &[f64],
        x: &mut [f64],
        parameters: &SolveParameters,
    ) -> Outcome {
        let size = b.len();
        for vector in [&mut self.r, &mut self.z, &mut self.direction, &mut self.product] {
            vector.resize(size, 0.0);
        }
        let norm = parallel::sum(size, &mut self.partial, |i| b[i] * b[i]).sqrt();
        if norm == 0.0 {
            x.fill(0.0);
            return Outcome::default();
        }
        {
            let x = &*x;
            parallel::fill(&mut self.r, |i| b[i] - matrix.row_product(i, x));
        }
        let mut rho = 0.0;
        for iteration in 0..=parameters.maximum_iterations {
            let residual = self.residual_norm() / norm;
            let stop = residual <= parameters.tolerance || iteration == parameters.maximum_iterations;
            if stop || !residual.is_finite() {
                return Outcome { iterations: iteration, residual };
            }
            preconditioner.apply(matrix, &self.r, &mut self.z);
            let (r, z) = (&self.r, &self.z);
            let next = parallel::sum(size, &mut self.partial, |i| r[i] * z[i]);
            let beta = if iteration == 0 { 0.0 } else { next / rho };
            rho = next;
            update(&mut self.direction, |i, old| z[i] + beta * old);
            let direction = &self.direction;
            parallel::fill(&mut self.product, |i| matrix.row_product(i, direction));
            let product = &self.product;
            let alpha = rho / parallel::sum(size, &mut self.partial, |i| direction[i] * product[i]);
            update(x, |i, old| old + alpha * direction[i]);
            update(&mut self.r, |i, old| old - alpha * product[i]);
        }
        Outcome { iterations: parameters.maximum_iterations, residual: f64::NAN }
    }

    fn residual_norm(&mut self) -> f64 {
        let r = &self.r;
        parallel::sum(r.len(), &mut self.partial, |i| r[i] * r[i]).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::Kernel;
    use crate::neighbours::Neighbourhood;
    use crate::parallel::Lists;
    use crate::walls::Walls;
    use faer::linalg::solvers::Solve as _;
    use faer::sparse::{SparseColMat, Triplet};
    use nalgebra::Vector2;

    /// A jittered square of `side` x `side` particles with unit spacing whose uppermost row is the surface.
    fn system(side: usize) -> (Matrix, Multigrid, Vec<f64>) {
        let noise = |k: usize| ((k * 7919 + 31) % 1009) as f64 / 1009.0 - 0.5;
        let positions: Vec<_> = (0..side * side)
            .map(|k| Vector2::new((k % side) as f64 + 0.3 * noise(2 * k), (k / side) as f64 + 0.3 * noise(2 * k + 1)))
            .collect();
        let kernel = Kernel::new(3.1, Vector2::new(1.0, 1.0));
        let mut attachments = Lists::default();
        attachments.build(positions.len(), |_, _: &mut Vec<_>| ());
        let mut around = Neighbourhood::default();
        let mut walls = Walls::default();
        let layout = crate::walls::WallLayout::new(&crate::Geometry::default(), 1.0);
        walls.place(&layout, None, kernel.radius, 1.0);
        around.build(&positions, &attachments, &walls, &kernel);
        let surface: Vec<_> = (0..side * side).map(|k| k / side == side - 1).collect();
        let (mut matrix, mut multigrid) = (Matrix::default(), Multigrid::default());
        matrix.assemble(&around, &surface, false);
        let mut points = Vec::new();
        matrix.gather_positions(&positions, &mut points);
        multigrid.set_up(&matrix, &points, 1.0, kernel.reference_density * kernel.lambda / 4.0);
        let b = points.iter().map(|point| 1.0 + (point.x * 0.37).sin() * (point.y * 0.21).cos()).collect();
        (matrix, multigrid, b)
    }

    fn cholesky(matrix: &Matrix, b: &[f64]) -> Vec<f64> {
        let mut triplets = Vec::new();
        for row in 0..matrix.size() {
            triplets.push(Triplet::new(row, row, matrix.diagonal[row]));
            let entries = matrix.entries.of(row).iter();
            triplets.extend(entries.map(|entry| Triplet::new(row, entry.column as usize, -entry.weight)));
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
        let (matrix, mut multigrid, b) = system(40);
        let expected = cholesky(&matrix, &b);
        let parameters = SolveParameters { tolerance: 1e-11, maximum_iterations: 100 };
        let mut x = vec![0.0; b.len()];
        let outcome = ConjugateGradient::default().solve(&matrix, &mut multigrid, &b, &mut x, &parameters);
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
                let (matrix, mut multigrid, b) = system(side);
                let mut x = vec![0.0; b.len()];
                ConjugateGradient::default().solve(&matrix, &mut multigrid, &b, &mut x, &parameters).iterations
            })
            .collect();
        assert!(iterations.iter().all(|&count| count <= 13), "iterations {iterations:?} for 576 to 36864 unknowns");
        assert!(iterations[3] <= iterations[1] + 2, "iterations grow: {iterations:?}");
    }
}
