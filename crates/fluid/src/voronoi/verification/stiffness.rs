//! What becomes of an error of the velocity in one projection after another.

use super::*;
use crate::voronoi::operators;
use crate::voronoi::unpaid::MOVED;
use nalgebra::{DMatrix, DVector};

/// The rate of the areas that is left of `rate` after one projection, cells and density 1: r - D G (A^-1 r) / V.
fn left(water: &Arrangement, matrix: &DMatrix<f64>, rate: &DVector<f64>) -> DVector<f64> {
    let pressures = matrix.clone().lu().solve(rate).expect("A is positive definite");
    let cells = &water.cells;
    let moved = |i: usize| cells.cells[i].filled.clamp(MOVED[0], MOVED[1]);
    let kick = |i: usize| operators::pressure_difference(cells, i, pressures.as_slice()) / moved(i);
    let velocities: Vec<_> = (0..water.positions.len()).map(|i| -kick(i)).collect();
    DVector::from_fn(water.positions.len(), |i, _| rate[i] - divergence::rate(water, i, &velocities))
}

/// A of the cells as they are.
fn matrix(water: &Arrangement) -> DMatrix<f64> {
    let sparse = poisson::assembled(water);
    let mut matrix = DMatrix::zeros(sparse.size(), sparse.size());
    for row in 0..sparse.size() {
        matrix[(row, row)] = sparse.diagonal[row];
        for entry in sparse.entries(row) {
            matrix[(row, entry.column as usize)] -= f64::from(entry.weight);
        }
    }
    matrix
}

/// How much an error grows from step to step in the long run.
fn growth(water: &Arrangement) -> f64 {
    let matrix = matrix(water);
    let mut noise = Noise::new(5);
    let mut rate = DVector::from_fn(water.positions.len(), |_, _| noise.next());
    let mut grown = 0.0;
    for _ in 0..60 {
        let next = left(water, &matrix, &rate);
        grown = next.norm();
        rate = next / grown;
    }
    grown
}

/// Twelve particles thrown on a floor, closer together than their areas allow.
fn crowd(noise: &mut Noise) -> Arrangement {
    let place = |across: f64, up: f64| Vector2::new(2.5 * across, 0.05 + 0.8 * (1.0 + up));
    let positions: Vec<_> = (0..12).map(|_| place(noise.next(), noise.next())).collect();
    Arrangement::new(positions, None, &[points(&[(-20.0, 0.0), (20.0, 0.0)])], 1.0)
}

#[test]
fn crowds_on_a_floor_are_damped() {
    let mut noise = Noise::new(13);
    let (mut rings, mut worst): (usize, f64) = (0, 0.0);
    for _ in 0..400 {
        let mut water = crowd(&mut noise);
        let stiff = growth(&water);
        water.cells.cells.iter_mut().for_each(|cell| cell.stiffening = 0.0);
        let without = growth(&water);
        worst = worst.max(stiff);
        rings += usize::from(without > 1.0);
    }
    // D is the adjoint of G but for the weights of surfaces, so that the bound is not strict there.
    assert!(worst < 1.1, "errors grow by {worst}");
    assert!(rings > 20, "{rings} of the crowds would ring with the weights as they are");
}

#[test]
fn ordinary_cells_are_not_stiffened() {
    for order in ORDERS {
        let water = Arrangement::open(order, 16);
        let largest = water.cells.cells.iter().map(|cell| 1.0 + cell.stiffening).fold(1.0, f64::max);
        assert!(largest == 1.0, "{order:?}: {largest}");
    }
}
