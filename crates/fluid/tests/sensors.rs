//! Pressure sensors: a patch on a wall reads force over area, over time it reads impulse over time.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::{Geometry, Probe, Scheme, Sensor, Solver, State, Workspace};
use nalgebra::Vector2;
use samples::{mps, parameters, rectangle, tank, voronoi};

fn probe(x: f64, y: f64, size: f64) -> Probe {
    Probe { size, ..Vector2::new(x, y).into() }
}

/// Water 0.2 m deep at rest in a tank of 0.4 m, or a column of 0.1 m that collapses in it.
fn solver(scheme: Scheme, width: f64, probes: Vec<Probe>) -> (Solver, State, Workspace) {
    let geometry = Geometry {
        water: vec![rectangle(0.0, 0.0, width, 0.2)],
        fixed_walls: vec![tank(0.4, 0.5)],
        probes,
        ..Geometry::default()
    };
    let solver = Solver::new(parameters(scheme, 0.01, 1e-8, 1), geometry).unwrap();
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    solver.begin(&mut state, &mut workspace).unwrap();
    (solver, state, workspace)
}

/// On walls, of any size and wherever it stands among the cells; half of one above the water is dry; one at an end of a wall is
/// the part of it that is there; in the water it is a point.
#[test]
fn a_patch_on_a_wall_reads_force_over_area() {
    let weight = 9810.0;
    let wet = |low: f64, high: f64| 0.5 * weight * ((0.2 - low).powi(2) - (0.2 - high).powi(2));
    let cases = [
        (probe(0.0, 0.1, 0.0), weight * 0.1),
        (probe(0.0, 0.0937, 0.01), weight * 0.1063),
        (probe(0.4, 0.0937, 0.06), weight * 0.1063),
        (probe(0.4, 0.2, 0.08), wet(0.16, 0.2) / 0.08),
        (probe(0.4, 0.3, 0.08), 0.0),
        (probe(0.2137, 0.0, 0.05), weight * 0.2),
        (probe(0.4, 0.0, 0.1), weight * 0.2),
        (probe(0.2, 0.1, 0.0), weight * 0.1),
    ];
    let (solver, mut state, mut workspace) = solver(voronoi(), 0.4, cases.iter().map(|(probe, _)| *probe).collect());
    let at_start = state.sensors.clone();
    solver.step(&mut state, &solver.at_rest(), 0.01, &mut workspace).unwrap();
    for (sensors, when) in [(&at_start, "at the start"), (&state.sensors, "after a step")] {
        for (sensor, (probe, expected)) in sensors.iter().zip(&cases) {
            // In a corner the floor or the side may be the nearer wall.
            let side = weight * (0.2 - 0.025);
            let alike = |value: f64| (sensor.mean - value).abs() < 0.003 * weight * 0.2;
            let corner = probe.place.x == 0.4 && probe.place.y == 0.0;
            assert!(alike(*expected) || (corner && alike(side)), "{probe:?} reads {sensor:?} {when}, not {expected}");
        }
    }
}

/// Steps of 8 ms, which have several internal ones: the largest of these, and impulses that are those of the means.
#[test]
fn a_reading_is_an_impulse_over_time() {
    for scheme in [voronoi(), mps()] {
        let at = Probe { threshold: 0.0, ..probe(0.4, 0.01, 0.02) };
        let beyond = Probe { threshold: 500.0, ..at };
        let (solver, mut state, mut workspace) = solver(scheme, 0.1, vec![at, beyond]);
        let (mut sum, mut peaks, mut substeps) = (0.0, 0, 0);
        for _ in 0..60 {
            let before = state.sensors[0].impulse;
            substeps += solver.step(&mut state, &solver.at_rest(), 0.008, &mut workspace).unwrap().substeps;
            let Sensor { mean, largest, impulse } = state.sensors[0];
            assert!(
                largest >= mean - 1e-9 * mean.abs() && (largest > 0.0) == (impulse > before),
                "{:?}",
                state.sensors
            );
            peaks += usize::from(largest > 1.2 * mean.abs() && mean != 0.0);
            sum += 0.008 * mean.max(0.0);
        }
        let [all, rest] = [0, 1].map(|k| state.sensors[k].impulse);
        // Means may have steps with suction in them.
        assert!(all >= sum * (1.0 - 1e-9) && all < 1.3 * sum && sum > 10.0, "{all} of {sum} Pa s");
        assert!(rest < all && rest > all - 500.0 * 0.48, "{rest} and {all} Pa s");
        assert!(substeps > 120 && peaks > 0, "{substeps} internal steps, {peaks} peaks");
    }
}
