//! The system of the free coordinates: gathered from the full one, which it does not change in any other way.

use kinematics::{Coordinate, CoordinateLayout, Part};
use nalgebra::{DMatrix, DVector};

/// Which coordinates are solved for, in rising order.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct FreeCoordinates {
    indices: Vec<usize>,
    size: usize,
}

impl FreeCoordinates {
    /// Of bodies of which X, Y and theta are free or not; modes are.
    pub(crate) fn new(free: &[[bool; 3]], layout: &CoordinateLayout) -> Self {
        let is_free = |(index, coordinate): (usize, Coordinate)| {
            let [x, y, theta] = free[coordinate.body];
            let free = match coordinate.part {
                Part::X => x,
                Part::Y => y,
                Part::Theta => theta,
                Part::Mode { .. } => true,
            };
            free.then_some(index)
        };
        Self { indices: layout.coordinates().enumerate().filter_map(is_free).collect(), size: layout.size() }
    }

    pub(crate) fn count(&self) -> usize {
        self.indices.len()
    }

    pub(crate) fn contains(&self, index: usize) -> bool {
        self.indices.contains(&index)
    }

    /// sqrt(sum f_k^2/M_kk) over the free coordinates: a measure in which forces, moments and modal forces add up.
    pub(crate) fn force_norm(&self, force: &DVector<f64>, mass: &DMatrix<f64>) -> f64 {
        let square = |&index: &usize| force[index] * force[index] / mass[(index, index)];
        self.indices.iter().map(square).sum::<f64>().sqrt()
    }

    pub(crate) fn gather(&self, full: &DVector<f64>) -> DVector<f64> {
        DVector::from_iterator(self.count(), self.indices.iter().map(|&index| full[index]))
    }

    pub(crate) fn gather_matrix(&self, full: &DMatrix<f64>) -> DMatrix<f64> {
        self.gather_with(|row, column| full[(row, column)])
    }

    /// The reduced matrix whose entries are given for the rows and columns of the full one.
    pub(crate) fn gather_with(&self, entry: impl Fn(usize, usize) -> f64) -> DMatrix<f64> {
        DMatrix::from_fn(self.count(), self.count(), |row, column| entry(self.indices[row], self.indices[column]))
    }

    /// The full vector with zeros at the locked coordinates.
    pub(crate) fn scatter(&self, reduced: &DVector<f64>, full: &mut DVector<f64>) {
        full.fill(0.0);
        for (&index, &value) in self.indices.iter().zip(reduced.iter()) {
            full[index] = value;
        }
    }

    /// The full matrix with zero rows and columns at the locked coordinates.
    pub(crate) fn scatter_matrix(&self, reduced: &DMatrix<f64>) -> DMatrix<f64> {
        let mut full = DMatrix::zeros(self.size, self.size);
        for (row, &full_row) in self.indices.iter().enumerate() {
            for (column, &full_column) in self.indices.iter().enumerate() {
                full[(full_row, full_column)] = reduced[(row, column)];
            }
        }
        full
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn locked_coordinates_leave_and_come_back_as_zeros() {
        let free = FreeCoordinates::new(&[[false, true, false]], &CoordinateLayout::single(2));
        assert_eq!((free.count(), free.contains(0), free.contains(1), free.contains(4)), (3, false, true, true));
        let full = DVector::from_vec(vec![1.0, 2.0, 3.0, 4.0, 5.0]);
        let reduced = free.gather(&full);
        assert_eq!(reduced, DVector::from_vec(vec![2.0, 4.0, 5.0]));
        let mut back = full.clone();
        free.scatter(&reduced, &mut back);
        assert_eq!(back, DVector::from_vec(vec![0.0, 2.0, 0.0, 4.0, 5.0]));
        let matrix = DMatrix::from_fn(5, 5, |row, column| (10 * row + column) as f64);
        let small = free.gather_matrix(&matrix);
        assert_eq!((small[(0, 0)], small[(0, 2)], small[(2, 1)]), (11.0, 14.0, 43.0));
        let big = free.scatter_matrix(&small);
        assert_eq!((big[(1, 4)], big[(4, 3)], big[(0, 1)], big[(2, 2)]), (14.0, 43.0, 0.0, 0.0));
        // sqrt(2^2/11 + 4^2/33 + 5^2/44), the locked entries left out.
        let norm = free.force_norm(&full, &matrix);
        assert!((norm - (4.0_f64 / 11.0 + 16.0 / 33.0 + 25.0 / 44.0).sqrt()).abs() < 1e-15);
    }
}
