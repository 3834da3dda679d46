//! Scenes that the scene file allows with numbers that nobody would write: setting them up gives finite particles and
//! numbers, or an error with a message; it does not panic, and does not fill the memory.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use components::{conversion, fluid_set_up, structure_set_up};
use proptest::prelude::*;
use proptest::sample::Index;
use proptest::test_runner::TestRunner;
use scene::Scene;
use std::cell::Cell;
use std::path::Path;
use std::time::Instant;
use toml::Value;

/// Most memory that this process may ever have \[kB\].
const MOST_MEMORY: u64 = 400_000;
/// Particles up to which a scene is set up here.
const MOST_PARTICLES: f64 = 3000.0;

/// Largest memory of this process so far \[kB\]; 0 where the system does not say.
fn most_memory() -> u64 {
    fuzzing::memory("VmHWM").unwrap_or(0)
}

/// Area of the water over the square of the spacing.
fn expected(scene: &Scene) -> f64 {
    let Some(fluid) = &scene.fluid else { return 0.0 };
    fluid.water.iter().map(|water| water.area()).sum::<f64>() / fluid.spacing.powi(2)
}

/// Text of a scene of the repository, with so few particles that it is set up in milliseconds, and the paths of its
/// numbers.
fn bases() -> Vec<(String, Vec<String>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<_> = entries.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
    paths.sort();
    let base = |path: &Path| {
        let mut scene = Scene::from_file(path).unwrap();
        let coarser = (expected(&scene) / 150.0).sqrt();
        if let Some(fluid) = &mut scene.fluid {
            fluid.threads = 1;
            fluid.spacing *= coarser.max(1.0);
        }
        scene.check.clear();
        let mut found = Vec::new();
        for part in ["fluid", "body"] {
            let value = Value::try_from(&scene).unwrap();
            value.get(part).into_iter().for_each(|value| numbers(value, part, &mut found));
        }
        (toml::to_string(&scene).unwrap(), found)
    };
    paths.iter().map(|path| base(path)).collect()
}

fn numbers(value: &Value, path: &str, found: &mut Vec<String>) {
    match value {
        Value::Table(table) => table.iter().for_each(|(key, value)| numbers(value, &format!("{path}.{key}"), found)),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, item)| numbers(item, &format!("{path}.{i}"), found));
        }
        Value::Float(_) | Value::Integer(_) if !path.ends_with("threads") => found.push(path.to_string()),
        _ => {}
    }
}

const NUMBERS: &[&str] = &[
    "0", "1", "-1", "2", "0.01", "-0.01", "0.1", "-0.3", "1e-9", "-1e-9", "1e-300", "5e-324", "1e3", "1e6", "-1e6",
    "1e9", "-1e9", "1e30", "-1e30", "1e154", "1e300", "-1e300", "1.7e308",
];

fn told(error: &dyn std::fmt::Display) -> Result<(), TestCaseError> {
    let message = error.to_string();
    prop_assert!(message.len() > 10, "no message: {message}");
    Ok(())
}

/// Sets a scene up as a run would do; what it gives is finite. Whether it can be run.
fn set_up(scene: &Scene) -> Result<bool, TestCaseError> {
    let bodies = structure_set_up(scene);
    if let Err(error) = &bodies {
        told(error)?;
    }
    let count = match fluid_set_up(scene) {
        Err(error) => return told(&error).map(|()| false),
        Ok((places, _)) => places.len(),
    };
    if count == 0 {
        return Ok(bodies.is_ok());
    }
    let (parameters, geometry) = conversion::fluid(scene).map_err(|error| TestCaseError::fail(error.to_string()))?;
    let solver = fluid::Solver::new(parameters, geometry).map_err(|error| TestCaseError::fail(error.to_string()))?;
    let state = solver.initial_state();
    prop_assert_eq!(state.positions.len(), count);
    prop_assert!(state.areas.iter().all(|volume| volume.is_finite() && *volume > 0.0), "areas {:?}", state.areas);
    prop_assert!(state.positions.iter().all(|place| place.x.is_finite() && place.y.is_finite()));
    Ok(bodies.is_ok())
}

#[test]
fn scenes_with_odd_numbers_are_set_up_or_refused() {
    let bases = bases();
    let [sound, refused, unread] = [Cell::new(0), Cell::new(0), Cell::new(0)];
    let strategy = (any::<Index>(), prop::collection::vec((any::<Index>(), any::<Index>()), 1..4));
    let outcome = TestRunner::new(fuzzing::config(1500)).run(&strategy, |(which, changes)| {
        let (text, paths) = &bases[which.index(bases.len())];
        let change = |(path, value): &(Index, Index)| {
            (paths[path.index(paths.len())].clone(), NUMBERS[value.index(NUMBERS.len())].to_string())
        };
        let overrides: Vec<_> = changes.iter().map(change).collect();
        let count = match Scene::with_overrides(text, "odd.toml", &overrides) {
            Err(_) => &unread,
            Ok(scene) if expected(&scene) > MOST_PARTICLES => &unread,
            Ok(scene) => {
                let clock = Instant::now();
                let is_sound = set_up(&scene)?;
                let seconds = clock.elapsed().as_secs_f64();
                prop_assert!(seconds < 30.0, "{seconds} s: {overrides:?}");
                if is_sound { &sound } else { &refused }
            }
        };
        count.set(count.get() + 1);
        prop_assert!(most_memory() < MOST_MEMORY, "{} kB", most_memory());
        Ok(())
    });
    assert!(outcome.is_ok(), "{outcome:?}");
    let counts = [&sound, &refused, &unread].map(Cell::get);
    println!("{counts:?} set up, refused, not a scene; at most {} kB", most_memory());
    assert!(counts.iter().all(|&count| count > 150), "{counts:?} set up, refused, not a scene");
}

/// What would fill the memory or take for ever is refused with numbers, and before.
#[test]
fn sizes_beyond_reason_are_refused() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    for (scene, key, value, words) in [
        ("hydrostatic", "fluid.spacing", "1e-9", &["1e7 particles"][..]),
        ("hydrostatic", "fluid.wall.0.points.1", "[-1e300, 0.0]", &["1e8 spacings", "from (-1e300, 0)"]),
        ("hydrostatic", "fluid.wall.0.points.1", "[-1e7, 0.0]", &["1e8 spacings", "10000001 m"]),
        ("dam_break_plate", "body.0.member.0.length", "1e6", &["pieces of two spacings", "10000"]),
        ("dam_break_plate", "body.0.member.0.thickness", "1e6", &["thickness = 1e6", "less than the length, 0.08 m"]),
        ("floating_box_heave", "body.0.wall.0.points.0", "[1e300, 0.0]", &["the body's surface"]),
    ] {
        let overrides = [(key.to_string(), value.to_string())];
        let result = Scene::from_file_with(&scenes.join(format!("{scene}.toml")), &overrides);
        let message = match result {
            Ok(scene) => fluid_set_up(&scene).expect_err(key).to_string(),
            Err(error) => error.to_string(),
        };
        assert!(words.iter().all(|word| message.contains(word)), "{message}: expected {words:?}");
    }
    assert!(most_memory() < MOST_MEMORY, "{} kB", most_memory());
}
