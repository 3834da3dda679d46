//! The rate of the cells' areas, its adjoint, and momentum.

use super::super::operators::{area_rate, pressure_difference};
use super::{Arrangement, Noise, ORDERS, Order, largest};
use nalgebra::Vector2;

/// D u with walls that stand still.
pub fn rate(water: &Arrangement, i: usize, velocities: &[Vector2<f64>]) -> f64 {
    let at_walls =
        water.cells.walls.of(i).iter().map(|wall| wall.facet.length() * wall.facet.normal.dot(&velocities[i]));
    area_rate(&water.cells, i, velocities) - at_walls.sum::<f64>()
}

fn random_velocities(count: usize, seed: u64) -> Vec<Vector2<f64>> {
    let mut noise = Noise::new(seed);
    (0..count).map(|_| noise.vector()).collect()
}

#[test]
fn rigid_motion_changes_no_area() {
    for order in ORDERS {
        let water = Arrangement::closed(order, 24);
        let inside = || (0..water.positions.len()).filter(|&i| water.is_inside(i));
        let translation = vec![Vector2::new(0.7, -1.3); water.positions.len()];
        let rotation: Vec<_> = water.positions.iter().map(|place| Vector2::new(-place.y, place.x)).collect();
        for velocities in [translation, rotation] {
            let worst = largest(inside().map(|i| area_rate(&water.cells, i, &velocities) / water.cells.cells[i].area));
            assert!(worst < 1e-11, "{order:?}: rate {worst} 1/s");
        }
    }
}

/// Uniform expansion of 1/s: every area grows at twice that rate.
#[test]
fn expansion_has_its_exact_rate() {
    for order in ORDERS {
        let water = Arrangement::closed(order, 24);
        let velocities = water.positions.clone();
        let inside = (0..water.positions.len()).filter(|&i| water.is_inside(i));
        let worst = largest(inside.map(|i| area_rate(&water.cells, i, &velocities) / water.cells.cells[i].area - 2.0));
        assert!(worst < 1e-10, "{order:?}: error {worst} of a divergence of 2");
    }
}

/// Central differences of the areas along random velocities, at walls too.
#[test]
fn the_rate_is_that_of_the_areas() {
    let time = 1e-6;
    for order in [Order::Hexagonal, Order::Jittered(0.2), Order::Relaxed] {
        let water = Arrangement::closed(order, 24);
        let velocities = random_velocities(water.positions.len(), 5);
        let moved = |by: f64| {
            let mut other = Arrangement::closed(order, 24);
            other.positions.iter_mut().zip(&velocities).for_each(|(place, velocity)| *place += velocity * by);
            other.rebuild();
            other.areas()
        };
        let (later, earlier) = (moved(time), moved(-time));
        let scale = water.spacing;
        let error = |i: usize| (rate(&water, i, &velocities) - (later[i] - earlier[i]) / (2.0 * time)) / scale;
        let worst = largest((0..velocities.len()).map(error));
        assert!(worst < 1e-7, "{order:?}: rates differ by {worst} spacings times the speed");
    }
}

/// sum p_i (D u)_i = - sum u_i . (G p)_i for any p and u, with walls that stand still; at free surfaces G differs from
/// the adjoint of D by p times (lift - outward), which is what makes it exact there.
#[test]
fn gradient_and_rate_are_adjoint() {
    for order in ORDERS {
        for water in [Arrangement::closed(order, 24), Arrangement::open(order, 24)] {
            let count = water.positions.len();
            let velocities = random_velocities(count, 11);
            let pressures: Vec<f64> = random_velocities(count, 13).iter().map(|vector| vector.x).collect();
            let work: f64 = (0..count).map(|i| pressures[i] * rate(&water, i, &velocities)).sum();
            let force = |i: usize| {
                let cell = &water.cells.cells[i];
                pressure_difference(&water.cells, i, &pressures)
                    + (cell.free_surface_gradient - cell.outward) * pressures[i]
            };
            let other: f64 = (0..count).map(|i| velocities[i].dot(&force(i))).sum();
            let scale: f64 = (0..count).map(|i| velocities[i].dot(&force(i)).abs()).sum();
            assert!((work + other).abs() < 1e-12 * scale, "{order:?}: {work} against {other} of {scale}");
        }
    }
}

/// The forces on all particles add up to minus the force on the walls, but for the moments of the wall facets about
/// the feet of their particles. Along a straight wall these cancel up to its ends, and are of second order there.
#[test]
fn pressure_gives_the_water_what_it_takes_from_the_walls() {
    let gravity = Vector2::new(0.0, -9.81);
    for order in ORDERS {
        let water = Arrangement::closed(order, 24);
        let count = water.positions.len();
        let pressures: Vec<f64> = random_velocities(count, 17).iter().map(|vector| vector.x).collect();
        let (mut total, mut moments, mut scale) = (Vector2::zeros(), Vector2::zeros(), 0.0);
        for i in 0..count {
            total -= pressure_difference(&water.cells, i, &pressures);
            for wall in water.cells.walls.of(i) {
                let facet = &wall.facet;
                let slope = gravity.dot(&facet.normal);
                let on_wall = facet.normal * (facet.length() * (pressures[i] + slope * facet.height));
                total += on_wall - facet.middle() * (facet.length() * slope);
                moments += (facet.middle() - facet.normal * facet.height) * (facet.length() * slope);
                scale += on_wall.norm();
            }
        }
        let error = (total + moments).norm();
        assert!(error < 1e-13 * scale, "{order:?}: {error} of {scale} is lost");
        assert!(moments.y.abs() < 1e-13 * scale, "{order:?}: {moments:?}");
        assert!(moments.x.abs() < water.spacing.powi(2) * 9.81, "{order:?}: {moments:?}");
    }
}
