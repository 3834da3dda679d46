//! Lists, names and values that do not fit each other: the error says where and why.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use common::{SCENE, with};
use scene::Scene;

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
        ("body.0.constant_load", "[0,0,0,0,0,6]", &["body[0].constant_load = 6", "from 0 to 3"]),
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
            "fluid.gauge[0].name = '--': expected a name with a letter from a to z or a digit",
        ),
        ("body.0.member.0.name", "'theta'", "expected a name other than x, y and theta"),
        (
            "body.0.name",
            "'a long name that goes on and on and on, as nobody would give one to a body'",
            "at most 60 letters",
        ),
        ("body.0.name", "''", "body[0].name = '': expected a name with a letter from a to z or a digit"),
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
