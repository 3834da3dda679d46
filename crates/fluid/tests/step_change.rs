//! Verification: the load on a body and the pressure on it do not depend on the length of the step, nor on its changes.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

mod common;

use common::{accurate, parameters, points, rectangle};
use fluid::{Geometry, Parameters, Probe, Solver};
use kinematics::{Body, Motion};
use nalgebra::Vector2;

/// Speed at which the wedge goes down \[m/s\].
const SPEED: f64 = 1.0;
/// Steps of one length before the next change.
const RUN: usize = 8;

/// A wedge over water 6 m wide and 2 m deep, without gravity; a probe on its right side.
fn wedge(degrees: f64, spacing: f64, tolerance: f64) -> Solver {
    let (half, height) = (1.2, 1.2 * degrees.to_radians().tan());
    let tip = 2.0 + 0.5 * spacing;
    let body = Body {
        origin: Vector2::new(0.0, tip),
        angle: 0.0,
        walls: vec![points(&[(0.0, 0.0), (-half, height), (half, height), (0.0, 0.0)])],
        beam: None,
    };
    let probe = Probe { place: Vector2::new(0.1, tip + 0.1 * height / half), on_body: true };
    let geometry = Geometry {
        water: vec![rectangle(-3.0, 0.0, 3.0, 2.0)],
        fixed_walls: vec![points(&[(-3.0, 4.0), (-3.0, 0.0), (3.0, 0.0), (3.0, 4.0)])],
        body: Some(body),
        probes: vec![probe],
        ..Geometry::default()
    };
    let parameters = Parameters { gravity: Vector2::zeros(), ..parameters(accurate(), spacing, tolerance, 2) };
    Solver::new(parameters, geometry).unwrap()
}

/// Load and pressure after every step up to `last` \[s\]; `duration` gives the length of step k.
fn entry(solver: &Solver, last: f64, duration: impl Fn(usize) -> f64) -> [Vec<f64>; 2] {
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    state.motion.velocity[1] = -SPEED;
    let (mut time, mut series) = (0.0, [Vec::new(), Vec::new()]);
    while time < last {
        let duration = duration(series[0].len());
        time += duration;
        let mut end = Motion::at_rest(0);
        end.position[1] = -SPEED * time;
        end.velocity[1] = -SPEED;
        let report = solver.step(&mut state, &end, duration, &mut workspace).unwrap();
        assert_eq!(report.substeps, 1);
        series[0].push(state.load[1]);
        series[1].push(solver.observe_with(&state, &mut workspace).probes[0]);
    }
    series
}

/// The same from 0.06 s on, with `long` steps that change to `short` ones and back again and again.
fn changing(long: f64, short: f64) -> [Vec<f64>; 2] {
    let begin = (0.06 / long).round() as usize;
    let duration = |k: usize| if k >= begin && (k - begin) % (2 * RUN) < RUN { short } else { long };
    entry(&wedge(30.0, 0.03, 1e-8), 0.28, duration).map(|values| values[begin..].to_vec())
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Median over all cycles of the difference from the running median, step by step after each change.
fn offsets(values: &[f64]) -> Vec<f64> {
    let whole = values.len() / (2 * RUN) * (2 * RUN);
    let course = |k: usize| median(values[k.saturating_sub(2 * RUN)..(k + 2 * RUN + 1).min(whole)].to_vec());
    let relative: Vec<f64> = (0..whole).map(|k| values[k] / course(k) - 1.0).collect();
    (0..2 * RUN).map(|k| median(relative.iter().skip(k).step_by(2 * RUN).copied().collect())).collect()
}

/// Half the step and back: nothing is seen of it beyond the scatter of medians of 20 values that scatter by 6 %.
#[test]
fn halving_the_step_changes_no_load() {
    let [load, pressure] = changing(1e-3, 5e-4).map(|values| offsets(&values));
    println!("load {load:.3?}, pressure {pressure:.3?}");
    assert!(load.iter().all(|offset| offset.abs() < 0.08), "load {load:?}");
    assert!(pressure.iter().all(|offset| offset.abs() < 0.05), "pressure {pressure:?}");
}

/// A fifth of the step and back: medians of 26 values that scatter by 12 %, so that a median has a standard deviation of
/// 3 % and the farthest of 30 is off by 10 % once in a hundred runs. The first two short steps are off by up to 15 and 12 %
/// either way, from one arrangement of the jet to another; with positions in the middle of the last step it was 96 %.
#[test]
fn a_fifth_of_the_step_shows_in_its_first_two_steps_only() {
    let [load, pressure] = changing(1e-3, 2e-4).map(|values| offsets(&values));
    println!("load {load:.3?}, pressure {pressure:.3?}");
    for offsets in [load, pressure] {
        assert!(offsets[..2].iter().all(|offset| offset.abs() < 0.2), "{offsets:?}");
        assert!(offsets[2..].iter().all(|offset| offset.abs() < 0.1), "{offsets:?}");
    }
}

/// The load of single steps of one length about its running median over seven, a wedge of 25 degrees at 15 mm. The goal
/// is 0.12; single runs of versions that differ in nothing that matters here had 0.11 to 0.15.
#[test]
#[ignore = "a validation of about a minute"]
fn the_load_of_a_step_stays_near_its_course() {
    let [load, _] = entry(&wedge(25.0, 0.015, 1e-5), 0.2, |_| 5e-4);
    let course = |k: usize| median(load[k - 3..(k + 4).min(load.len())].to_vec());
    let offsets: Vec<f64> = (100..load.len()).map(|k| load[k] / course(k) - 1.0).collect();
    let mean = offsets.iter().sum::<f64>() / offsets.len() as f64;
    let scatter = (offsets.iter().map(|offset| (offset - mean).powi(2)).sum::<f64>() / offsets.len() as f64).sqrt();
    let far = offsets.iter().filter(|offset| offset.abs() > 0.3).count();
    println!("standard deviation {scatter:.3}, {far} of {} off by more than 30 %", offsets.len());
    assert!(scatter < 0.2, "{scatter}: 0.22 with cells that open and close at once");
}
