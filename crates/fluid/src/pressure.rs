//! Conjugate gradients for the pressure, preconditioned by the multigrid.

use crate::matrix::Matrix;
use crate::multigrid::Multigrid;
use crate::parallel;
use crate::parameters::SolveParameters;
use rayon::prelude::*;

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

fn update(values: &mut [f64], new: impl Fn(usize, f64) -> f64 + Sync) {
    values.par_iter_mut().with_min_len(parallel::CHUNK).enumerate().for_each(|(i, value)| *value = new(i, *value));
}
