//! Every number of a scene outside its range: the error names the key and the value.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use common::{SCENE, with};
use scene::Scene;
use toml::Value;

/// Keys with a bound: the nearest values that are refused, and the bounds that are accepted.
const BOUNDS: &[(&str, &[&str], &[&str])] = &[
    ("gravity.0", &["-1.1e6", "1.1e6"], &["-1e6", "1e6"]),
    ("gravity.1", &["-1.1e6", "1.1e6"], &["-1e6", "0"]),
    ("run.end", &["-1", "0"], &["0.01"]),
    ("run.communication_step", &["-0.01", "0", "0.9e-9", "1.01"], &["1.0", "1e-3"]),
    ("output.interval", &["-1e-9"], &["0", "1e9"]),
    ("output.record_interval", &["-1e-9"], &["0", "1e9"]),
    ("output.checkpoint_interval", &["-1e-9", "1.1e9"], &["0", "1e9"]),
    ("fluid.density", &["-1", "0", "1e-16", "1.1e15"], &["1e-3"]),
    ("fluid.spacing", &["-0.01", "0", "2e-4", "1e-300"], &["3e-4", "0.1"]),
    ("fluid.threads", &["-1", "1025"], &["0", "1024"]),
    ("fluid.start.velocity.0", &["-1.1e5", "1e300"], &["-1e5", "1e5"]),
    ("fluid.start.velocity.1", &["1.1e5"], &["1e5"]),
    ("fluid.start.gradient.1.0", &["-1.1e5", "1.1e5"], &["-1e5", "1e5"]),
    ("fluid.start.jitter", &["-0.1", "0.21"], &["0.0", "0.2"]),
    ("fluid.damping.0.from", &["nan", "1e10"], &["0.5"]),
    ("fluid.damping.0.to", &["0.8", "inf"], &["0.0"]),
    ("fluid.damping.0.rate", &["-1.0", "1e7"], &["0.0", "1e6"]),
    ("fluid.attraction", &["-1.1e6", "1.1e6"], &["-1e6", "1e6"]),
    ("fluid.shaking.amplitude.0", &["-1.1e6", "1.1e6"], &["-1e6", "1e6"]),
    ("fluid.shaking.amplitude.1", &["-1.1e6", "1.1e6"], &["-1e6", "1e6"]),
    ("fluid.shaking.period", &["-1", "0", "0.9e-6", "1.1e9"], &["1e-6", "1e9"]),
    ("fluid.voronoi.alpha", &["-0.01", "1.01"], &["0", "1"]),
    ("fluid.voronoi.courant", &["0.009", "1.01"], &["0.01", "1"]),
    ("fluid.voronoi.shifting", &["-0.01", "10.1"], &["0", "10"]),
    ("fluid.voronoi.repulsion", &["-0.01", "101"], &["0", "100"]),
    ("fluid.voronoi.spreading", &["-0.01", "201"], &["0", "200"]),
    ("fluid.voronoi.smoothing", &["-0.01", "10.1"], &["0", "10"]),
    ("fluid.voronoi.enclosed_pressure", &["-1.1e12", "1.1e12"], &["-1e12", "1e12"]),
    ("fluid.mps.influence_radius", &["2.09", "4.01"], &["2.1", "4"]),
    ("fluid.mps.alpha", &["-0.01", "1.01"], &["0", "1"]),
    ("fluid.mps.courant", &["0.009", "0.51"], &["0.01", "0.5"]),
    ("fluid.mps.shifting", &["-0.01", "0.51"], &["0", "0.5"]),
    ("fluid.mps.collision_distance", &["-0.01", "1.01"], &["0", "1"]),
    ("fluid.mps.restitution", &["-0.01", "1.01"], &["0", "1"]),
    ("fluid.mps.surface_deviation", &["-0.01", "1.01"], &["0", "1"]),
    ("fluid.solve.tolerance", &["-1e-9", "0.11"], &["0", "0.1"]),
    ("fluid.solve.maximum_iterations", &["-1", "0", "1000001"], &["1", "1000000"]),
    ("fluid.probe.1.count", &["-1", "0", "1001", "9000000000000000000"], &["1", "1000"]),
    ("fluid.probe.0.size", &["-0.1", "1.1e9"], &["0", "1e9"]),
    ("fluid.probe.0.threshold", &["-1.1e12", "1.1e12"], &["-1e12", "1e12"]),
    ("gas.exponent", &["0.9", "3.1"], &["1", "3"]),
    ("gas.ambient", &["0.9", "1.1e9"], &["1", "1e9"]),
    ("gas.density", &["-1", "0", "1.1e15"], &["1e-3"]),
    ("gas.chamber.0.point.0", &["nan", "1.1e9"], &["0.5"]),
    ("gas.chamber.0.pressure", &["0.9", "1.1e12"], &["1", "1e12"]),
    ("gas.vent.0.point.1", &["nan", "1.1e9"], &["0.5"]),
    ("gas.vent.0.area", &["-0.1", "1.1e6"], &["0", "1e6"]),
    ("gas.vent.0.discharge", &["-0.1", "1.1"], &["0", "1"]),
    ("body.0.springs.0", &["-1", "1.1e15"], &["0", "1e15"]),
    ("body.0.springs.1", &["-1"], &["0"]),
    ("body.0.springs.2", &["-1"], &["0"]),
    ("body.0.angle", &["-10.1", "10.1"], &["-10", "10"]),
    ("body.0.mass", &["-1", "0", "1.1e15"], &["1e-3"]),
    ("body.0.inertia", &["-1", "0", "1.1e15"], &["1e-3"]),
    ("body.0.constant_load.0", &["-1.1e15", "1.1e15"], &["-1e15", "1e15"]),
    ("integrator.rho_infinity", &["-0.01", "1.01"], &["0", "1"]),
    ("integrator.beta", &["0.009", "1.01"], &["0.01", "1"]),
    ("integrator.gamma", &["0.49", "1.01"], &["0.5", "1"]),
    ("body.0.member.0.length", &["-1", "0", "1e-16", "1.1e15"], &["0.011"]),
    ("body.0.member.0.thickness", &["-1", "0", "0.1", "1e-16", "1.1e15"], &["1e-3", "0.099"]),
    ("body.0.member.0.density", &["-1", "0", "1e-16", "1.1e15"], &["1e-3"]),
    ("body.0.member.0.youngs_modulus", &["-1", "0", "1.1e15"], &["1e-3", "210000000000"]),
    ("body.0.member.0.poisson_ratio", &["-0.01", "0.51"], &["0", "0.5"]),
    ("body.0.contact.depth", &["0.0", "2.0"], &["1e-9", "1.0"]),
    ("body.0.contact.damping", &["-1.0", "inf"], &["0.0"]),
    ("body.0.member.0.deflection_limit", &["0.0", "inf"], &["1e-6", "1e6"]),
    ("body.0.member.0.modes", &["-1", "21"], &["1", "20"]),
    ("body.0.member.0.constant_load.0", &["-1.1e15"], &["1e15"]),
    ("body.0.member.0.damping.0", &["-0.01", "1.01"], &["0", "1"]),
    ("body.0.member.0.initial_modes.0", &["-1.1e15", "1.1e15"], &["-1e15", "1e15"]),
    ("coupling.relaxation", &["-1", "0", "1.01"], &["1e-6", "1"]),
    ("coupling.tolerance_relative", &["-1e-9", "1.01"], &["0", "1"]),
    ("coupling.tolerance_absolute", &["-1e-9"], &["0", "1e9"]),
    ("coupling.maximum_iterations", &["-1", "0", "10001"], &["1", "10000"]),
    ("coupling.smallest_step", &["-1e-9", "0.011"], &["0", "0.01"]),
    ("coupling.predictor_order", &["-1", "3"], &["0", "2"]),
    ("watch.energy", &["-0.1", "1.1e3", "nan"], &["0", "1e3"]),
    ("watch.lost", &["-0.1", "1.1"], &["0", "1"]),
    ("watch.speed", &["-0.1", "1.1e6"], &["0", "1e6"]),
    ("coupling.reused_steps", &["-1", "101"], &["0", "100"]),
    ("check.0.to", &["0.09"], &["0.1"]),
    ("check.0.time_scale", &["-1", "0"], &["0.1"]),
    ("check.0.limit", &["-1e-9"], &["0"]),
    ("check.0.quick.limit", &["-1e-9"], &["0"]),
    ("check.0.window", &["-1", "0"], &["0.1"]),
    ("check.0.depth", &["-1", "0"], &["0.1"]),
];

/// A dotted path as messages write it: `a.0.b` is `a[0].b`.
fn bracketed(key: &str) -> String {
    key.split('.').fold(String::new(), |text, part| match (text.is_empty(), part.parse::<usize>()) {
        (true, _) => part.to_string(),
        (false, Ok(index)) => format!("{text}[{index}]"),
        (false, Err(_)) => format!("{text}.{part}"),
    })
}

/// The message names the key, or the point that the key is a coordinate of, and the value.
fn names(message: &str, key: &str, value: &str) {
    let shown = bracketed(key);
    let point = shown.strip_suffix("[0]").or_else(|| shown.strip_suffix("[1]")).unwrap_or(&shown);
    let from_override = message.contains(&format!("'{key}={value}'"));
    assert!(
        from_override || message.contains(&format!("{point} = ")) || message.contains(&format!("{shown} = ")),
        "{key}={value}: {message}"
    );
    let number = value.parse::<f64>().map_or_else(|_| value.to_string(), |number| digits::six(number).to_string());
    assert!(message.contains(&number) || from_override, "{key}={value}: {message}");
    assert!(message.contains("expected"), "{key}={value}: {message}");
}

/// Paths of all numbers of a document, with whether they are integers.
fn numbers(value: &Value, path: &str, found: &mut Vec<(String, bool)>) {
    let below = |part: &str| if path.is_empty() { part.to_string() } else { format!("{path}.{part}") };
    match value {
        Value::Table(table) => table.iter().for_each(|(key, value)| numbers(value, &below(key), found)),
        Value::Array(items) => {
            items.iter().enumerate().for_each(|(i, item)| numbers(item, &below(&i.to_string()), found));
        }
        Value::Float(_) | Value::Integer(_) => found.push((path.to_string(), value.is_integer())),
        _ => {}
    }
}

#[test]
fn bounds_are_kept_on_both_sides() {
    for (key, refused, accepted) in BOUNDS {
        for value in *refused {
            names(&with(key, value).expect_err(&format!("{key}={value} is accepted")), key, value);
        }
        for value in *accepted {
            with(key, value).unwrap_or_else(|error| panic!("{key}={value}: {error}"));
        }
    }
}

#[test]
fn no_number_may_be_infinite_or_none() {
    let scene = Scene::from_str(SCENE, "all.toml").unwrap();
    let mut found = Vec::new();
    numbers(&Value::try_from(&scene).unwrap(), "", &mut found);
    assert!(found.len() > 80, "{found:?}");
    for (key, integer) in &found {
        for value in ["nan", "inf", "-inf"] {
            let message = with(key, value).expect_err(&format!("{key}={value} is accepted"));
            names(&message, key, value);
            assert!(!integer || message.contains("expected a whole number"), "{message}");
        }
        let message = with(key, "'text'").expect_err(&format!("{key}='text' is accepted"));
        assert!(message.contains(key) && message.contains("\"text\""), "{message}");
    }
    for (key, ..) in BOUNDS {
        assert!(found.iter().any(|(known, _)| known == key), "{key} is in the table and not in the scene");
    }
}

/// The scene above writes out every number: adding one to the types makes this fail until it is tested too.
#[test]
fn the_scene_above_writes_out_every_number() {
    let written: Value = Value::Table(SCENE.parse().unwrap());
    let complete = Value::try_from(Scene::from_str(SCENE, "all.toml").unwrap()).unwrap();
    let (mut known, mut all) = (Vec::new(), Vec::new());
    numbers(&written, "", &mut known);
    numbers(&complete, "", &mut all);
    // The point probe has no `count` of its own.
    all.retain(|(key, _)| key != "fluid.probe.0.count");
    let missing: Vec<_> = all.iter().filter(|entry| !known.contains(entry)).collect();
    assert!(missing.is_empty(), "{missing:?}");
}
