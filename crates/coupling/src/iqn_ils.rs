//! Interface quasi-Newton with an inverse Jacobian from least squares.
//!
//! Degroote, Bathe and Vierendeels 2009, with the details of preCICE 3: from earlier iterations, columns of residual
//! differences V and output differences W are kept. The next guess is Q~ + W c, where c minimises |V c + r| in
//! weighted norm. Columns are taken newest first, at most as many as unknowns; a column that is nearly a combination
//! of newer ones is dropped (QR2 filter, Haelterman et al. 2016). Columns of a few past steps are reused.

use crate::acceleration::relaxed;
use crate::weights::ResidualSums;
use nalgebra::DVector;
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// A column is dropped when less than this share of it is orthogonal to the newer ones.
const FILTER: f64 = 1e-2;

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Column {
    residual: DVector<f64>,
    output: DVector<f64>,
}

/// State of the method.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct IqnIls {
    relaxation: f64,
    reused_steps: usize,
    /// Columns of this step, newest first.
    current: VecDeque<Column>,
    /// Columns of past steps, newest first.
    past: VecDeque<VecDeque<Column>>,
    /// Residual and output of the last iteration of this step.
    last: Option<(DVector<f64>, DVector<f64>)>,
    weights: ResidualSums,
}

impl IqnIls {
    /// `relaxation` is the factor while there are no columns yet.
    pub fn new(relaxation: f64, reused_steps: usize) -> Self {
        Self {
            relaxation,
            reused_steps,
            current: VecDeque::new(),
            past: VecDeque::new(),
            last: None,
            weights: ResidualSums::default(),
        }
    }

    /// Starts a step; columns of accepted steps stay.
    pub fn start_step(&mut self) {
        self.current.clear();
        self.last = None;
        self.weights.reset();
    }

    /// Next guess after the guess `used` gave `produced`.
    pub fn next(&mut self, used: &[f64], produced: &[f64]) -> Vec<f64> {
        let residual = self.learn(used, produced);
        match self.correction(&residual) {
            Some(correction) => produced.iter().zip(&correction).map(|(output, change)| output + change).collect(),
            None => relaxed(used, produced, self.relaxation),
        }
    }

    /// Keeps the columns of a converged step.
    pub fn accept(&mut self, used: &[f64], produced: &[f64]) {
        self.learn(used, produced);
        if !self.current.is_empty() {
            self.past.push_front(std::mem::take(&mut self.current));
        }
        self.past.truncate(self.reused_steps);
    }

    /// Drops everything learnt.
    pub fn forget(&mut self) {
        self.current.clear();
        self.past.clear();
        self.last = None;
    }

    /// Adds the column of this iteration and gives its residual.
    fn learn(&mut self, used: &[f64], produced: &[f64]) -> DVector<f64> {
        let output = DVector::from_column_slice(produced);
        let residual = &output - DVector::from_column_slice(used);
        self.weights.add(residual.as_slice());
        if let Some((last_residual, last_output)) = self.last.replace((residual.clone(), output.clone())) {
            let column = Column { residual: &residual - last_residual, output: output - last_output };
            if column.residual.norm() > 0.0 {
                self.current.push_front(column);
            }
        }
        residual
    }

    /// W c with c from the filtered QR factorisation of the weighted V; none without columns.
    fn correction(&self, residual: &DVector<f64>) -> Option<DVector<f64>> {
        let factors = DVector::from_vec(self.weights.factors());
        let mut basis: Vec<DVector<f64>> = Vec::new();
        let mut kept: Vec<(&Column, Vec<f64>)> = Vec::new();
        for column in self.current.iter().chain(self.past.iter().flatten()) {
            if basis.len() == residual.len() {
                break;
            }
            let weighted = column.residual.component_mul(&factors);
            if let Some((direction, projections)) = orthogonalise(&basis, &weighted) {
                basis.push(direction);
                kept.push((column, projections));
            }
        }
        let right = -residual.component_mul(&factors);
        let coefficients = back_substitute(&kept, &basis, &right);
        let terms = kept.iter().zip(coefficients).map(|((column, _), c)| &column.output * c);
        terms.reduce(|sum, term| sum + term).filter(|correction| correction.iter().all(|value| value.is_finite()))
    }
}

/// Direction of `vector` orthogonal to the basis, and its projections (with its own length last); none when too
/// little is left. Gram-Schmidt twice, which is enough for orthogonality to rounding.
fn orthogonalise(basis: &[DVector<f64>], vector: &DVector<f64>) -> Option<(DVector<f64>, Vec<f64>)> {
    let mut rest = vector.clone();
    let mut projections = vec![0.0; basis.len()];
    for _ in 0..2 {
        for (direction, projection) in basis.iter().zip(&mut projections) {
            let part = direction.dot(&rest);
            rest.axpy(-part, direction, 1.0);
            *projection += part;
        }
    }
    let length = rest.norm();
    (length > FILTER * vector.norm()).then(|| {
        projections.push(length);
        (rest / length, projections)
    })
}

/// Solves R c = B^T right, R given by columns.
fn back_substitute(kept: &[(&Column, Vec<f64>)], basis: &[DVector<f64>], right: &DVector<f64>) -> Vec<f64> {
    let mut rest: Vec<f64> = basis.iter().map(|direction| direction.dot(right)).collect();
    for k in (0..kept.len()).rev() {
        let column = &kept[k].1;
        rest[k] /= column[k];
        let c = rest[k];
        rest[..k].iter_mut().zip(column).for_each(|(value, r)| *value -= r * c);
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Q~ = b - A Q with a full 3 x 3 matrix whose eigenvalues are far outside the unit circle.
    fn produce(guess: &[f64]) -> Vec<f64> {
        let matrix = [[10.0, 2.0, 0.5], [2.0, 5.0, 1.0], [0.5, 1.0, 2.0]];
        let right = [1.0, -2.0, 3.0];
        (0..3).map(|i| right[i] - (0..3).map(|j| matrix[i][j] * guess[j]).sum::<f64>()).collect()
    }

    fn iterations(method: &mut IqnIls, mut guess: Vec<f64>) -> usize {
        method.start_step();
        for k in 1..50 {
            let produced = produce(&guess);
            let size: f64 = guess.iter().zip(&produced).map(|(a, b)| (a - b).abs()).sum();
            if size < 1e-9 {
                method.accept(&guess, &produced);
                return k;
            }
            guess = method.next(&guess, &produced);
        }
        50
    }

    #[test]
    fn linear_problem_takes_unknowns_plus_two_passes() {
        // One relaxed pass, n passes that fill the columns, one that confirms: n + 2 (Degroote et al. 2009).
        let mut method = IqnIls::new(0.1, 2);
        assert_eq!(iterations(&mut method, vec![0.0; 3]), 5);
        // Reused columns are exact for the same problem: one update and a confirmation.
        assert_eq!(iterations(&mut method, vec![5.0, 1.0, -7.0]), 2);
        method.forget();
        assert_eq!(iterations(&mut method, vec![5.0, 1.0, -7.0]), 5);
    }

    #[test]
    fn a_dependent_column_is_dropped() {
        let basis = [DVector::from_vec(vec![1.0, 0.0])];
        assert!(orthogonalise(&basis, &DVector::from_vec(vec![3.0, 0.001])).is_none());
        let (direction, projections) = orthogonalise(&basis, &DVector::from_vec(vec![3.0, 4.0])).unwrap();
        assert_eq!((direction[1], projections), (1.0, vec![3.0, 4.0]));
    }
}
