//! The equations of motion against the Lagrangian they stand for, at random configurations.
#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case has failed")]

mod common;
use common::{LENGTH, LINE_DENSITY, Parameters, cabin};
use kinematics::{Beam, Body, MaterialPoint, Motion, Support};
use nalgebra::{Cholesky, DMatrix, DVector, Vector2};
use proptest::prelude::*;
use structure::{Dynamics, Solver};

const STEP: f64 = 1e-5;

fn solver(fixed: bool, middle: [f64; 2], angle: f64) -> Solver {
    let mut parameters = Parameters { angle, ..cabin(3, 40.0, 9.81) };
    let support = if fixed { Support::FixedFixed } else { Support::ClampedFree };
    let mut beam = common::beam(support, 3, 40.0);
    beam.middle = Vector2::new(middle[0], middle[1]);
    beam.damping_ratios = vec![0.01, 0.02, 0.05];
    parameters.beam = Some(beam);
    common::built(parameters).unwrap()
}

fn solvers() -> impl Strategy<Value = Solver> {
    (prop::bool::ANY, prop::array::uniform2(-0.5..0.5), -3.0..3.0)
        .prop_map(|(fixed, middle, angle)| solver(fixed, middle, angle))
}

/// Six numbers: rigid ones up to 2, modal ones up to `modal`.
fn vector(modal: f64) -> impl Strategy<Value = DVector<f64>> {
    (prop::array::uniform3(-2.0..2.0), prop::array::uniform3(-modal..modal))
        .prop_map(|(rigid, modal)| DVector::from_iterator(6, rigid.into_iter().chain(modal)))
}

/// M(x) xdd + h + grad V + C xd.
fn force(dynamics: &Dynamics, x: &DVector<f64>, v: &DVector<f64>, a: &DVector<f64>) -> DVector<f64> {
    let (mut mass, mut restoring) = (DMatrix::zeros(6, 6), DVector::zeros(6));
    dynamics.mass_matrix(x, &mut mass);
    dynamics.restoring_force(x, v, &mut restoring);
    mass * a + restoring
}

/// Central difference of `function` by entry `k` of `x`.
fn difference<T>(x: &DVector<f64>, k: usize, function: impl Fn(&DVector<f64>) -> T) -> T
where
    T: std::ops::Sub<Output = T> + std::ops::Div<f64, Output = T>,
{
    let (mut minus, mut plus) = (x.clone(), x.clone());
    minus[k] -= STEP;
    plus[k] += STEP;
    (function(&plus) - function(&minus)) / (2.0 * STEP)
}

/// T and the height part of V, summed over the moving points of the body that the fluid would see.
fn energies_of_points(solver: &Solver, motion: &Motion) -> (f64, f64) {
    let parameters = solver.parameters();
    let source = &parameters.bodies[0].members[0];
    let beam = Beam { middle: source.middle, thickness: 0.018, modes: source.modes.clone() };
    let body =
        Body { origin: Vector2::zeros(), angle: parameters.bodies[0].angle, walls: Vec::new(), members: vec![beam] };
    let centre = MaterialPoint::Rigid(Vector2::zeros());
    let spin = motion.velocity[2];
    let mut kinetic = 0.5 * parameters.bodies[0].rigid_mass * body.velocity(centre, motion).norm_squared()
        + 0.5 * parameters.bodies[0].rigid_inertia * spin * spin;
    let mut weight = parameters.bodies[0].rigid_mass * 9.81 * body.position(centre, motion).y;
    // Simpson's rule on 400 cells.
    for node in 0..=800 {
        let ends = if node == 0 || node == 800 { 1.0 } else { 2.0 + 2.0 * f64::from(node % 2) };
        let element = ends / 2400.0 * LENGTH * LINE_DENSITY;
        let point = MaterialPoint::Beam { member: 0, station: LENGTH * f64::from(node) / 800.0, offset: 0.0 };
        kinetic += 0.5 * element * body.velocity(point, motion).norm_squared();
        weight += element * 9.81 * body.position(point, motion).y;
    }
    (kinetic, weight)
}

proptest! {
    #[test]
    fn energies_are_those_of_the_moving_points(solver in solvers(), x in vector(0.3), v in vector(3.0)) {
        let motion = Motion { position: x.clone(), velocity: v.clone(), acceleration: DVector::zeros(6) };
        let (kinetic, weight) = energies_of_points(&solver, &motion);
        let dynamics = solver.dynamics();
        let bending: f64 = (0..3).map(|i| 0.5 * (dynamics.frequency(0, i) * x[3 + i]).powi(2)).sum();
        prop_assert!((dynamics.kinetic_energy(&x, &v) - kinetic).abs() < 1e-7 * (1.0 + kinetic));
        prop_assert!((dynamics.potential_energy(&x) - weight - bending).abs() < 1e-7 * (1.0 + weight.abs() + bending));
    }

    #[test]
    fn mass_matrix_is_symmetric_and_positive_definite(solver in solvers(), x in vector(10.0)) {
        let mut mass = DMatrix::zeros(6, 6);
        solver.dynamics().mass_matrix(&x, &mut mass);
        prop_assert_eq!(&mass, &mass.transpose());
        prop_assert!(Cholesky::new(mass).is_some());
    }

    #[test]
    fn forces_are_the_euler_lagrange_expression(solver in solvers(), x in vector(0.3), v in vector(3.0), a in vector(30.0)) {
        // d/dt dT/dv - dT/dx + dV/dx + C v, each derivative by central differences of the scalar energies.
        let dynamics = solver.dynamics();
        let momenta = |t: f64| {
            let mut mass = DMatrix::zeros(6, 6);
            dynamics.mass_matrix(&(&x + t * &v + 0.5 * t * t * &a), &mut mass);
            mass * (&v + t * &a)
        };
        let inertial = (momenta(STEP) - momenta(-STEP)) / (2.0 * STEP);
        let exact = force(dynamics, &x, &v, &a);
        for k in 0..6 {
            let kinetic = difference(&x, k, |x| dynamics.kinetic_energy(x, &v));
            let potential = difference(&x, k, |x| dynamics.potential_energy(x));
            let damping = if k < 3 { 0.0 } else { 2.0 * [0.01, 0.02, 0.05][k - 3] * dynamics.frequency(0, k - 3) * v[k] };
            let expected = inertial[k] - kinetic + potential + damping;
            prop_assert!((exact[k] - expected).abs() < 1e-8 * exact.norm() + 1e-4, "{k}: {} {expected}", exact[k]);
        }
    }

    #[test]
    fn potential_gradient_is_the_force_at_rest(solver in solvers(), x in vector(0.3)) {
        let zero = DVector::zeros(6);
        let exact = force(solver.dynamics(), &x, &zero, &zero);
        for k in 0..6 {
            let expected = difference(&x, k, |x| solver.dynamics().potential_energy(x));
            prop_assert!((exact[k] - expected).abs() < 1e-9 * exact.norm() + 1e-6, "{k}: {} {expected}", exact[k]);
        }
    }

    #[test]
    fn tangents_are_exact(solver in solvers(), x in vector(0.3), v in vector(3.0), a in vector(30.0)) {
        let dynamics = solver.dynamics();
        let (mut stiffness, mut velocity_tangent) = (DMatrix::zeros(6, 6), DMatrix::zeros(6, 6));
        dynamics.stiffness(&x, &v, &a, &mut stiffness);
        dynamics.velocity_tangent(&x, &v, &mut velocity_tangent);
        let size = force(dynamics, &x, &v, &a).norm();
        for k in 0..6 {
            let by_position = difference(&x, k, |x| force(dynamics, x, &v, &a));
            let by_velocity = difference(&v, k, |v| force(dynamics, &x, v, &a));
            let bound = 1e-9 * size + 1e-6;
            prop_assert!((stiffness.column(k) - by_position).norm() < bound + 1e-9 * stiffness.column(k).norm());
            prop_assert!((velocity_tangent.column(k) - by_velocity).norm() < bound);
        }
    }

    #[test]
    fn momenta_are_those_of_the_moving_points(solver in solvers(), x in vector(0.3), v in vector(3.0)) {
        // Linear momentum is dT/d(uniform speed), angular momentum dT/d(uniform turn about the scene's o_R).
        let dynamics = solver.dynamics();
        let linear = dynamics.linear_momentum(&x, &v);
        let turn = DVector::from_vec(vec![-x[1], x[0], 1.0, 0.0, 0.0, 0.0]);
        let along = |direction: &DVector<f64>| {
            let energy = |speed: f64| dynamics.kinetic_energy(&x, &(&v + speed * direction));
            0.5 * (energy(1.0) - energy(-1.0))
        };
        let unit = |k: usize| DVector::from_fn(6, |row, _| if row == k { 1.0 } else { 0.0 });
        prop_assert!((along(&unit(0)) - linear.x).abs() < 1e-9 * (1.0 + linear.norm()));
        prop_assert!((along(&unit(1)) - linear.y).abs() < 1e-9 * (1.0 + linear.norm()));
        let angular = dynamics.angular_momentum(&x, &v);
        prop_assert!((along(&turn) - angular).abs() < 1e-8 * (1.0 + angular.abs() + linear.norm()));
    }
}
