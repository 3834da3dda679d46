//! Every number of a scene outside its range: the error names the key and the value.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use scene::Scene;
use toml::Value;

/// A scene in which every key that holds numbers is written out.
const SCENE: &str = r#"
title = "everything"
gravity = [0.0, -9.81]
[run]
end = 1.0
communication_step = 0.01
[output]
interval = 0.1
record_interval = 0.1
checkpoint_interval = 10.0
[fluid]
density = 1000.0
spacing = 0.01
threads = 1
attraction = 1.0
start = { velocity = [1.0, 0.0], gradient = [[1.0, 0.0], [0.0, -1.0]], jitter = 0.1, seed = 3 }
damping = [{ from = 0.8, to = 1.0, rate = 5.0 }]
shaking = { amplitude = [0.1, 0.0], period = 2.0 }
water = [{ polygon = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.0, 0.5]] }]
wall = [{ points = [[0.0, 1.0], [0.0, 0.0], [1.0, 0.0], [1.0, 1.0]] }]
probe = [{ name = "p", point = [0.0, 0.1] }, { name = "l", from = [0.0, 0.1], to = [0.0, 0.4], count = 3 }]
gauge = [{ name = "g", x = 0.5 }]
region = [{ name = "r", polygon = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5]] }]
voronoi = { alpha = 0.01, courant = 0.4, shifting = 1.0, repulsion = 20.0, spreading = 30.0, smoothing = 1.0, enclosed_pressure = 0.0 }
mps = { influence_radius = 3.1, alpha = 0.01, courant = 0.2, shifting = 0.03, collision_distance = 0.8, restitution = 0.2, surface_deviation = 0.2 }
solve = { tolerance = 1e-3, maximum_iterations = 100 }
[[body]]
name = "cabin"
origin = [0.5, 0.6]
angle = 0.1
free = ["x", "theta"]
mass = 1.0
inertia = 1.0
springs = [1.0, 2.0, 3.0]
wall = [{ points = [[-0.1, 0.0], [0.1, 0.0]] }]
constant_load = [1.0, 0.0]
contact = { depth = 1e-3, damping = 1.0 }
[[body.member]]
name = "bulkhead"
support = "clamped_free"
middle = [0.0, 0.1]
length = 0.1
thickness = 0.01
density = 1000.0
youngs_modulus = 1e6
poisson_ratio = 0.3
deflection_limit = 0.2
modes = 2
damping = [0.01]
initial_modes = [0.1]
[integrator]
rho_infinity = 0.8
beta = 0.25
gamma = 0.5
[coupling]
relaxation = 0.2
tolerance_relative = 1e-6
tolerance_absolute = 1e-6
maximum_iterations = 30
smallest_step = 1e-4
predictor_order = 1
reused_steps = 4
[watch]
energy = 0.01
lost = 0.1
speed = 5.0
[[check]]
name = "c"
kind = "series_mean"
from = 0.1
to = 0.2
scale = 2.0
offset = 1.0
time_scale = 2.0
reference = 1.0
limit = 1.0
depth = 0.5
window = 0.05
level = 1.0
rest = 1.0
points = [[0.0, 1.0]]
quick = { limit = 0.1, reference = 1.0, from = 0.1, to = 0.2 }
"#;

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

fn with(key: &str, value: &str) -> Result<Scene, String> {
    let overrides = [(key.to_string(), value.to_string())];
    Scene::with_overrides(SCENE, "all.toml", &overrides).map_err(|error| error.to_string())
}

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

#[test]
fn lists_that_are_too_short_or_too_long() {
    for (key, value, words) in [
        ("gravity", "[0]", &["gravity"][..]),
        ("fluid.water", "[]", &["fluid.water = empty"]),
        ("fluid.water.0.polygon", "[[0,0],[1,0]]", &["fluid.water[0].polygon = 2 points", "at least 3"]),
        ("fluid.wall.0.points", "[[0,0]]", &["fluid.wall[0].points = 1 points", "at least 2"]),
        ("fluid.region.0.polygon", "[]", &["fluid.region[0].polygon = 0 points", "at least 3"]),
        ("fluid.probe.0", "{ name = 'n' }", &["fluid.probe[0]", "`point`, or `from`"]),
        ("fluid.probe.1.point", "[0,0]", &["fluid.probe[1]", "either"]),
        ("body.0.wall.0.points", "[[0,0]]", &["body[0].wall[0].points = 1 points"]),
        ("body.0.constant_load", "[0,0,0,0,0,6]", &["body[0].constant_load = 6", "from 0 to 5"]),
        ("body.0.member.0.damping", "[0,0,0]", &["body[0].member[0].damping = 3", "from 0 to 2"]),
        ("body.0.member.0.initial_modes", "[0,0,0]", &["body[0].member[0].initial_modes = 3", "from 0 to 2"]),
        ("fluid.scheme", "voronoy", &["fluid.scheme=voronoy", "did you mean `voronoi`"]),
        ("body.0.free", "['z']", &["unknown word `z`"]),
        ("fluid.spacing.deep", "1", &["fluid.spacing.deep=1", "no table"]),
        ("fluid.water.7.polygon", "[]", &["`7`", "below 1"]),
        ("fluid..spacing", "1", &["a key is empty"]),
    ] {
        let message = with(key, value).expect_err(&format!("{key}={value} is accepted"));
        assert!(words.iter().all(|word| message.contains(word)), "{message}: expected {words:?}");
    }
    let both = [("coupling.tolerance_relative", "0"), ("coupling.tolerance_absolute", "0")];
    let both = both.map(|(key, value)| (key.to_string(), value.to_string()));
    let message = Scene::with_overrides(SCENE, "all.toml", &both).unwrap_err().to_string();
    assert!(message.contains("tolerance_relative, tolerance_absolute = 0, 0"), "{message}");
    let nothing = "title = 'n'\n[run]\nend = 1.0\ncommunication_step = 0.1\n";
    let message = Scene::from_str(nothing, "n.toml").unwrap_err().to_string();
    assert!(message.contains("at least one of [fluid] and [[body]]"), "{message}");
}

/// Points, vectors and the lists of three springs have as many entries as they need, no more and no less.
#[test]
fn lists_of_a_fixed_length() {
    for (key, value, path, got, expected) in [
        ("gravity", "[0.0, 0.0, -9.81]", "gravity", 3, 2),
        ("fluid.start.velocity", "[1, 2, 3]", "fluid.start.velocity", 3, 2),
        ("fluid.start.gradient", "[[1, 0], [0, 1], [0, 0]]", "fluid.start.gradient", 3, 2),
        ("fluid.start.gradient", "[[1, 0], [0, 1, 2]]", "fluid.start.gradient[1]", 3, 2),
        ("fluid.shaking.amplitude", "[1, 2, 3, 4]", "fluid.shaking.amplitude", 4, 2),
        ("fluid.water.0.polygon.0", "[0, 0, 0]", "fluid.water[0].polygon[0]", 3, 2),
        ("fluid.wall.0.points.3", "[1, 1, 0]", "fluid.wall[0].points[3]", 3, 2),
        ("fluid.probe.0.point", "[0, 0.1, 0]", "fluid.probe[0].point", 3, 2),
        ("fluid.region.0.polygon.2", "[1, 0.5, 0]", "fluid.region[0].polygon[2]", 3, 2),
        ("body.0.origin", "[0.5, 0.6, 0]", "body[0].origin", 3, 2),
        ("body.0.springs", "[1, 2, 3, 4]", "body[0].springs", 4, 3),
        ("body.0.member.0.middle", "[0, 0.1, 0]", "body[0].member[0].middle", 3, 2),
        ("check.0.points.0", "[0, 1, 2]", "check[0].points[0]", 3, 2),
    ] {
        let message = with(key, value).expect_err(&format!("{key}={value} is accepted"));
        let words = format!("{path} has {got} entries, expected {expected}");
        assert!(message.contains(&words) && message.contains(key), "{message}: expected {words}");
        with(key, "[1]").expect_err(&format!("{key} with one entry"));
    }
    let springs = SCENE.replace("springs = [1.0, 2.0, 3.0]", "springs = [\n  1.0, 2.0, 3.0,\n  4.0,\n]");
    let line = 1 + SCENE[..SCENE.find("springs").unwrap()].matches('\n').count();
    let message = Scene::from_str(&springs, "all.toml").unwrap_err().to_string();
    assert_eq!(message, format!("all.toml, line {line}: body[0].springs has 4 entries, expected 3"));
    let short = SCENE.replace("origin = [0.5, 0.6]", "origin = [0.5]");
    let line = 1 + SCENE[..SCENE.find("origin").unwrap()].matches('\n').count();
    let message = Scene::from_str(&short, "all.toml").unwrap_err().to_string();
    assert!(
        message.starts_with(&format!("all.toml, line {line}: body[0].origin: got a list of 1, expected")),
        "{message}"
    );
}

/// A name stands for one figure of the report.
#[test]
fn names_are_used_once() {
    let checks = r#"[{ name = "x", kind = "series_mean" }, { name = "x", kind = "series_maximum" }]"#;
    for (key, value, words) in [
        ("check", checks, "check[1].name = 'x': expected a name that is used once; check[0] has it too"),
        (
            "fluid.probe",
            "[{ name = 'a', point = [0, 0] }, { name = 'a', point = [0, 1] }]",
            "fluid.probe[1].name = 'a'",
        ),
        (
            "fluid.probe",
            "[{ name = 'l', from = [0, 0], to = [0, 1], count = 2 }, { name = 'l, 2', point = [0, 1] }]",
            "fluid.probe[1].name = 'l, 2'",
        ),
        ("fluid.gauge", "[{ name = 'a', x = 1 }, { name = 'b', x = 1 }, { name = 'a', x = 2 }]", "fluid.gauge[2].name"),
        (
            "fluid.region",
            "[{ name = 'r', polygon = [[0, 0], [1, 0], [1, 1]] }, { name = 'r', polygon = [[0, 0], [1, 0], [1, 1]] }]",
            "fluid.region[1].name = 'r'",
        ),
        (
            "fluid.gauge",
            "[{ name = 'in front', x = 1 }, { name = 'in_front', x = 2 }]",
            "expected a name with other letters and digits than 'in front' of fluid.gauge[0]: both are in_front as",
        ),
        (
            "fluid.gauge",
            "[{ name = '--', x = 1 }]",
            "fluid.gauge[0].name = '--': expected a name with a letter or a digit",
        ),
        ("body.0.name", "''", "body[0].name = '': expected a name with a letter or a digit"),
        (
            "fluid.probe.0.on_body",
            "'cabbin'",
            "fluid.probe[0].on_body = 'cabbin': expected the name of a body: 'cabin'",
        ),
    ] {
        let message = with(key, value).expect_err(&format!("{key}={value} is accepted"));
        assert!(message.contains(words), "{message}: expected {words}");
    }
    with("fluid.gauge", "[{ name = 'p', x = 1 }]").expect("a gauge may have the name of a probe");
}

/// What does not move needs no inertia; what moves says which key it lacks.
#[test]
fn mass_and_inertia_are_needed_where_they_move() {
    let freed = |free: &str, key: &str| {
        let text =
            SCENE.replace(r#"free = ["x", "theta"]"#, free).replace("contact = { depth = 1e-3, damping = 1.0 }", "");
        Scene::from_str(&text.replace(&format!("\n{key} = 1.0"), ""), "all.toml").map_err(|error| error.to_string())
    };
    freed(r#"free = ["y"]"#, "inertia").unwrap();
    freed(r#"free = ["theta"]"#, "mass").unwrap();
    freed("free = []", "mass").unwrap();
    let message = freed(r#"free = ["y"]"#, "mass").unwrap_err();
    assert!(message.contains("body[0].mass = 0") && message.contains("body[0].free has y"), "{message}");
    let message = freed(r#"free = ["x", "theta"]"#, "inertia").unwrap_err();
    assert!(message.contains("body[0].inertia = 0") && message.contains("body[0].free has theta"), "{message}");
}

/// A whole number of more than 32 bits is as good as any other, in a file and in a change.
#[test]
fn large_whole_numbers_are_numbers() {
    let modulus = |scene: Scene| scene.body[0].member[0].youngs_modulus;
    assert_eq!(modulus(with("body.0.member.0.youngs_modulus", "210000000000").unwrap()), 2.1e11);
    let text = SCENE.replace("youngs_modulus = 1e6", "youngs_modulus = 210000000000");
    assert_eq!(modulus(Scene::from_str(&text, "all.toml").unwrap()), 2.1e11);
}

#[test]
fn files_that_are_missing_or_no_scene() {
    let missing = std::path::Path::new("/no/such/scene.toml");
    let message = Scene::from_file(missing).unwrap_err().to_string();
    assert!(message.contains("cannot read /no/such/scene.toml"), "{message}");
    let message = Scene::from_str("title = 'cut'\n[run", "cut.toml").unwrap_err().to_string();
    assert!(message.contains("cut.toml, line 2"), "{message}");
    let message = Scene::from_str("", "empty.toml").unwrap_err().to_string();
    assert!(message.contains("missing key `title`"), "{message}");
}
