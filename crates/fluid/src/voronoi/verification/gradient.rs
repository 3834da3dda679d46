//! The pressure gradient on polynomials and smooth fields.

use super::super::operators::pressure_difference;
use super::{Arrangement, Noise, ORDERS, Order, largest, orders, square};
use nalgebra::Vector2;

type Field = fn(&Vector2<f64>) -> f64;
type Slope = fn(&Vector2<f64>) -> Vector2<f64>;

/// Error of G p / area at every particle, with the slope of `gradient` at the middle of every wall facet.
fn errors(water: &Arrangement, pressures: &[f64], gradient: impl Fn(&Vector2<f64>) -> Vector2<f64>) -> Vec<f64> {
    (0..water.positions.len())
        .map(|i| {
            let here = water.positions[i];
            let mut sum = pressure_difference(&water.cells, i, pressures);
            for wall in water.cells.walls.of(i) {
                let slope = gradient(&(here + wall.facet.middle())).dot(&wall.facet.normal);
                sum += wall.facet.middle() * (wall.facet.length() * slope);
            }
            (sum / water.cells.cells[i].area - gradient(&here)).norm()
        })
        .collect()
}

fn at_particles(water: &Arrangement, field: impl Fn(&Vector2<f64>) -> f64) -> Vec<f64> {
    water.positions.iter().map(field).collect()
}

/// Whatever the particles' order, a linear pressure has its exact gradient inside, at walls and in corners.
#[test]
fn a_linear_pressure_has_its_exact_gradient_in_a_closed_box() {
    let slope = Vector2::new(2.0, -3.0);
    for order in ORDERS.into_iter().chain([Order::Jittered(0.35)]) {
        let water = Arrangement::closed(order, 24).filled();
        let pressures = at_particles(&water, |place| 5.0 + slope.dot(place));
        let worst = largest(errors(&water, &pressures, |_| slope).into_iter());
        assert!(worst < 1e-10, "{order:?}: error {worst} of a gradient of {}", slope.norm());
    }
}

/// Particles jittered below a straight row just under the surface, unevenly spaced: still exact up to the surface.
#[test]
fn a_hydrostatic_pressure_has_its_exact_gradient_at_a_flat_free_surface() {
    let across = 24;
    let spacing = 1.0 / across as f64;
    let (mut noise, mut positions) = (Noise::new(3), square(across));
    for position in &mut positions {
        let top = position.y > 1.0 - spacing;
        let amount = if top { Vector2::new(0.2, 0.0) } else { Vector2::new(0.2, 0.2) };
        *position += noise.vector().component_mul(&amount) * spacing;
    }
    let closed = Arrangement::new(positions, None, &[super::unit_box()], spacing);
    let water = closed.without_lid();
    let slope = Vector2::new(0.0, -9810.0);
    let pressures = at_particles(&water, |place| 9810.0 * (1.0 - place.y));
    assert_eq!(water.cells.cells.iter().filter(|cell| cell.is_open()).count(), across);
    let worst = largest(errors(&water, &pressures, |_| slope).into_iter());
    assert!(worst < 1e-9 * 9810.0, "error {worst} Pa/m of 9810");
}

fn mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

/// Errors at four resolutions, of all particles or of those inside.
fn convergence(order: Order, field: Field, gradient: Slope, inside: bool) -> Vec<f64> {
    let error = |across| {
        let water = Arrangement::closed(order, across);
        let all = errors(&water, &at_particles(&water, field), gradient);
        let chosen = (0..all.len()).filter(|&i| !inside || water.is_inside(i)).map(|i| all[i]);
        mean_square(&chosen.collect::<Vec<_>>())
    };
    [16, 32, 64, 128].into_iter().map(error).collect()
}

fn wave(place: &Vector2<f64>) -> f64 {
    (3.0 * place.x + 1.0).sin() * (2.0 * place.y).cos()
}

fn wave_slope(place: &Vector2<f64>) -> Vector2<f64> {
    let (x, y) = (3.0 * place.x + 1.0, 2.0 * place.y);
    Vector2::new(3.0 * x.cos() * y.cos(), -2.0 * x.sin() * y.sin())
}

fn quadratic(place: &Vector2<f64>) -> f64 {
    place.x * place.x - 2.0 * place.x * place.y + 0.5 * place.y * place.y
}

fn quadratic_slope(place: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(2.0 * place.x - 2.0 * place.y, place.y - 2.0 * place.x)
}

/// On lattices the errors of opposite neighbours cancel: second order inside.
#[test]
fn smooth_pressures_converge_with_second_order_on_lattices() {
    for order in [Order::Square, Order::Hexagonal] {
        let errors = convergence(order, wave, wave_slope, true);
        let observed = orders(&errors);
        assert!(observed.iter().all(|&value| value > 1.9), "{order:?}: errors {errors:?}, orders {observed:?}");
    }
    let water = Arrangement::closed(Order::Square, 32);
    let worst = largest(errors(&water, &at_particles(&water, quadratic), quadratic_slope).into_iter());
    assert!(worst < 1e-10, "a quadratic pressure is exact on a square lattice, up to its walls: error {worst}");
}

/// On any other arrangement the gradient is that of the linear part: first order in the root of the mean square, and
/// between first and second where only the rows at the walls lack symmetry.
#[test]
fn smooth_pressures_converge_with_first_order_on_any_arrangement() {
    for (order, least) in [(Order::Hexagonal, 1.4), (Order::Jittered(0.2), 0.9), (Order::Relaxed, 0.9)] {
        for (field, slope) in [(quadratic as Field, quadratic_slope as Slope), (wave, wave_slope)] {
            let errors = convergence(order, field, slope, false);
            let observed = orders(&errors);
            assert!(observed.iter().all(|&value| value > least), "{order:?}: errors {errors:?}, orders {observed:?}");
        }
    }
}
