//! The surface, its rates and its virtual work against finite differences and closed forms.
#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case has failed")]

use kinematics::{Beam, BeamModes, Body, MaterialPoint, Motion, Panel, RIGID, Support};
use nalgebra::{DVector, Vector2};
use proptest::prelude::*;

/// A cabin with a plate or a bulkhead of unit size; walls clockwise, so that the fluid is outside.
fn body(support: Support, count: usize) -> Body {
    let modes = BeamModes::new(support, 0.44, 44.9, count).unwrap();
    let corner = |x: f64, y: f64| Vector2::new(x, y);
    Body {
        origin: corner(1.3, 0.4),
        angle: 0.3,
        walls: vec![vec![corner(-0.35, -0.26), corner(-0.35, 0.26), corner(0.35, 0.26), corner(0.35, -0.26)]],
        members: vec![Beam { middle: corner(0.05, 0.03), thickness: 0.018, modes }],
    }
}

/// 3 + 4 numbers of a motion: rigid ones up to 2, modal ones up to 0.2 (deflections of centimetres).
fn coordinates() -> impl Strategy<Value = DVector<f64>> {
    (prop::array::uniform3(-2.0..2.0), prop::array::uniform4(-0.2..0.2))
        .prop_map(|(rigid, modal)| DVector::from_iterator(7, rigid.into_iter().chain(modal)))
}

fn support() -> impl Strategy<Value = Support> {
    prop::bool::ANY.prop_map(|fixed| if fixed { Support::FixedFixed } else { Support::ClampedFree })
}

fn point() -> impl Strategy<Value = MaterialPoint> {
    (prop::bool::ANY, 0.0..0.44, -0.3..0.3).prop_map(|(rigid, station, offset): (bool, f64, f64)| {
        if rigid {
            MaterialPoint::Rigid(Vector2::new(station, offset))
        } else {
            MaterialPoint::Beam { member: 0, station, offset: 0.03 * offset }
        }
    })
}

/// The motion after a time `t` of constant acceleration.
fn later(motion: &Motion, t: f64) -> Motion {
    Motion {
        position: &motion.position + t * &motion.velocity + 0.5 * t * t * &motion.acceleration,
        velocity: &motion.velocity + t * &motion.acceleration,
        acceleration: motion.acceleration.clone(),
    }
}

proptest! {
    #[test]
    fn rates_are_time_derivatives(support in support(), point in point(), x in coordinates(), v in coordinates(), a in coordinates()) {
        let body = body(support, 4);
        let motion = Motion { position: x, velocity: v, acceleration: a };
        let (before, after) = (later(&motion, -1e-5), later(&motion, 1e-5));
        let velocity = (body.position(point, &after) - body.position(point, &before)) / 2e-5;
        let acceleration = (body.velocity(point, &after) - body.velocity(point, &before)) / 2e-5;
        prop_assert!((velocity - body.velocity(point, &motion)).norm() < 1e-8);
        prop_assert!((acceleration - body.acceleration(point, &motion)).norm() < 1e-7);
    }

    #[test]
    fn jacobian_is_the_derivative_of_the_place(support in support(), point in point(), x in coordinates()) {
        let body = body(support, 4);
        let mut jacobian = [Vector2::zeros(); 7];
        body.jacobian(point, x.as_slice(), &mut jacobian);
        for (k, column) in jacobian.iter().enumerate() {
            let (mut minus, mut plus) = (x.clone(), x.clone());
            minus[k] -= 1e-5;
            plus[k] += 1e-5;
            let difference = (body.place(point, plus.as_slice()) - body.place(point, minus.as_slice())) / 2e-5;
            prop_assert!((difference - column).norm() < 1e-9, "{k}: {difference} {column}");
        }
    }

    #[test]
    fn load_does_the_work_of_the_pressure(support in support(), x in coordinates(), dx in coordinates(), trend in prop::array::uniform3(-5.0..5.0)) {
        // An arbitrary smooth pressure in space; its work is summed over the surface points moved by +-dx.
        let body = body(support, 4);
        let trend: [f64; 3] = trend;
        let pressure = |place: Vector2<f64>| 100.0 * (1.0 + (trend[0] * place.x + trend[1] * place.y + trend[2]).sin());
        let step = 1e-6;
        let (minus, plus) = (&x - step * &dx, &x + step * &dx);
        let mut load = vec![0.0; 7];
        let mut work = 0.0;
        for panel in body.panels(0.01) {
            let middle = panel.point(0.5).unwrap();
            let force = pressure(body.place(middle, x.as_slice())) * body.area_vector(&panel, x.as_slice());
            body.add_force(middle, x.as_slice(), force, &mut load);
            work += force.dot(&(body.place(middle, plus.as_slice()) - body.place(middle, minus.as_slice()))) / (2.0 * step);
        }
        let product: f64 = load.iter().zip(dx.iter()).map(|(q, d)| q * d).sum();
        let size: f64 = load.iter().zip(dx.iter()).map(|(q, d)| (q * d).abs()).sum();
        prop_assert!((product - work).abs() < 1e-8 * (size + 100.0), "{product} {work}");
    }

    #[test]
    fn moment_is_about_the_moved_centre(x in coordinates(), force in prop::array::uniform2(-3.0..3.0), point in point()) {
        let body = body(Support::FixedFixed, 4);
        let force = Vector2::new(force[0], force[1]);
        let mut load = vec![0.0; 7];
        body.add_force(point, x.as_slice(), force, &mut load);
        let lever = body.place(point, x.as_slice()) - body.place(MaterialPoint::Rigid(Vector2::zeros()), x.as_slice());
        prop_assert!((load[2] - lever.perp(&force)).abs() < 1e-12);
    }

    #[test]
    fn uniform_pressure_on_one_face_loads_the_modes_alone_by_psi0(support in support(), x in coordinates()) {
        // n dl.e_w = -ds on the face at -h/2 however the beam is bent, so Q_q = -p psi0 / rho_l.
        let body = body(support, 4);
        let modes = &body.members[0].modes;
        let mut load = vec![0.0; 7];
        for panel in body.panels(0.001).iter().filter(|panel| on_face(panel, -1.0)) {
            body.add_force(panel.point(0.5).unwrap(), x.as_slice(), 50.0 * body.area_vector(panel, x.as_slice()), &mut load);
        }
        for (i, psi0) in modes.psi0().iter().enumerate() {
            let expected = -50.0 * psi0 / 44.9;
            prop_assert!((load[RIGID + i] - expected).abs() < 1e-4, "{i}: {} {expected}", load[RIGID + i]);
        }
    }

    #[test]
    fn uniform_pressure_all_round_a_plate_does_no_work_on_it(x in coordinates()) {
        // The area of the plate does not change with q: both faces are the same curve, h apart.
        let body = body(Support::ClampedFree, 4);
        let mut load = vec![0.0; 7];
        let mut face = vec![0.0; 7];
        for panel in body.panels(0.002).iter().filter(|panel| matches!(panel.ends[0], MaterialPoint::Beam { .. })) {
            let force = 50.0 * body.area_vector(panel, x.as_slice());
            body.add_force(panel.point(0.5).unwrap(), x.as_slice(), force, &mut load);
            if on_face(panel, -1.0) {
                body.add_force(panel.point(0.5).unwrap(), x.as_slice(), force, &mut face);
            }
        }
        prop_assert!(face[3].abs() > 1.0);
        for (i, value) in load[RIGID..].iter().enumerate() {
            prop_assert!(value.abs() < 1e-12 * 50.0, "{i}: {value}");
        }
    }
}

/// Whether a panel lies on the face of the beam at `side` times half the thickness.
fn on_face(panel: &Panel, side: f64) -> bool {
    let on =
        |end: MaterialPoint| matches!(end, MaterialPoint::Beam { offset, .. } if (offset - side * 0.009).abs() < 1e-15);
    on(panel.ends[0]) && on(panel.ends[1])
}

#[test]
fn zero_coordinates_leave_the_body_where_the_scene_puts_it() {
    let body = body(Support::ClampedFree, 4);
    let rest = Motion::at_rest(4);
    assert_eq!(body.position(MaterialPoint::Rigid(Vector2::zeros()), &rest), body.origin);
    // The foot of the beam: Rot(0.3) (0.05, 0.03 - 0.22) from the origin.
    let (sin, cos) = 0.3_f64.sin_cos();
    let expected = Vector2::new(1.3 + 0.05 * cos + 0.19 * sin, 0.4 + 0.05 * sin - 0.19 * cos);
    let foot = body.position(MaterialPoint::Beam { member: 0, station: 0.0, offset: 0.0 }, &rest);
    assert!((foot - expected).norm() < 1e-15);
    assert_eq!(body.velocity(MaterialPoint::Rigid(Vector2::new(0.1, 0.2)), &rest), Vector2::zeros());
}

#[test]
fn positive_modes_deflect_towards_minus_x_of_the_body() {
    let mut body = body(Support::ClampedFree, 1);
    body.angle = 0.0;
    let tip = MaterialPoint::Beam { member: 0, station: 0.44, offset: 0.0 };
    let mut motion = Motion::at_rest(1);
    let before = body.position(tip, &motion);
    motion.position[3] = 0.1;
    let moved = body.position(tip, &motion) - before;
    // phi_1(l) = 2/sqrt(M_F).
    assert!((moved - Vector2::new(-0.2 / (44.9_f64 * 0.44).sqrt(), 0.0)).norm() < 1e-13);
}

#[test]
fn panels_follow_each_other_with_the_fluid_on_the_left() {
    let body = body(Support::ClampedFree, 2);
    let x = DVector::from_vec(vec![0.1, -0.2, 0.7, 0.1, -0.05]);
    let panels = body.panels(0.01);
    let rigid: Vec<&Panel> = panels.iter().filter(|panel| matches!(panel.ends[0], MaterialPoint::Rigid(_))).collect();
    // 0.52 + 0.7 + 0.52 m of wall; 0.44 m of beam twice; 0.018 m of tip.
    assert_eq!((rigid.len(), panels.len()), (52 + 70 + 52, 52 + 70 + 52 + 44 + 2 + 44));
    for pair in panels.windows(2) {
        let joined = body.place(pair[0].ends[1], x.as_slice()) == body.place(pair[1].ends[0], x.as_slice());
        assert!(
            joined
                || matches!((pair[0].ends[1], pair[1].ends[0]), (MaterialPoint::Rigid(_), MaterialPoint::Beam { .. }))
        );
    }
    // Into the solid: the normal of every rigid panel looks towards the body's centre.
    for panel in rigid {
        let inward = body.place(MaterialPoint::Rigid(Vector2::zeros()), x.as_slice())
            - body.place(panel.point(0.5).unwrap(), x.as_slice());
        assert!(body.normal(panel, x.as_slice()).dot(&inward) > 0.0);
        assert!((body.normal(panel, x.as_slice()).norm() - 1.0).abs() < 1e-14);
    }
    // And of every panel of the plate towards the neutral axis.
    for panel in panels.iter().filter(|panel| on_face(panel, -1.0) || on_face(panel, 1.0)) {
        let Some(MaterialPoint::Beam { member: 0, station, .. }) = panel.point(0.5) else {
            panic!("a beam panel has beam points")
        };
        let axis = body.place(MaterialPoint::Beam { member: 0, station, offset: 0.0 }, x.as_slice());
        assert!(
            body.normal(panel, x.as_slice()).dot(&(axis - body.place(panel.point(0.5).unwrap(), x.as_slice()))) > 0.0
        );
    }
}

#[test]
fn a_fixed_fixed_beam_has_two_faces_and_no_tip() {
    let body = body(Support::FixedFixed, 2);
    let beam = |panel: &&Panel| matches!(panel.ends[0], MaterialPoint::Beam { .. });
    assert_eq!(body.panels(0.01).iter().filter(beam).count(), 88);
    // Without a positive limit every straight piece stays whole.
    assert_eq!(body.panels(0.0).len(), 3 + 2);
}

#[test]
fn impossible_bodies_are_refused_with_their_numbers() {
    let mut bad = body(Support::FixedFixed, 2);
    assert!(bad.validate().is_ok());
    bad.walls[0][2] = bad.walls[0][1];
    assert_eq!(
        bad.validate().unwrap_err().to_string(),
        "points 1 and 2 of wall 0 of the body coincide at (-0.35, 0.26) m; remove one of them"
    );
    bad.walls[0].truncate(1);
    assert_eq!(
        bad.validate().unwrap_err().to_string(),
        "wall 0 of the body has 1 point(s), but a polyline needs at least 2"
    );
    let mut bad = body(Support::FixedFixed, 2);
    bad.origin.y = f64::NAN;
    assert_eq!(bad.validate().unwrap_err().to_string(), "the body's origin y is NaN, but has to be finite");
    bad.members[0].thickness = 0.0;
    assert_eq!(
        bad.validate().unwrap_err().to_string(),
        "the thickness of the beam is 0 m, but has to be positive and finite"
    );
}
