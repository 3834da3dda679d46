//! Checks of the scenes, before any of them runs.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use report::checks::reference;
use scene::CheckKind;
use std::path::Path;

/// Names of the variables of both FMUs of a scene.
fn variables(scene: &scene::Scene) -> Vec<String> {
    use components::{FluidComponent, Interface, StructureComponent};
    use fmi::Component;
    let interface = Interface::of(scene);
    let fluid = FluidComponent::model(&interface).variables.into_iter().map(|row| format!("fluid.{}", row.name));
    let structure = StructureComponent::model(&interface).variables.into_iter();
    fluid.chain(structure.map(|row| format!("structure.{}", row.name))).collect()
}

/// A slip in a scene's check would show only at the end of its run.
#[test]
fn every_scene_names_known_variables_and_readable_references() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let mut checked = 0;
    let files = std::fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path());
    for path in files.filter(|path| path.extension().is_some_and(|extension| extension == "toml")) {
        let scene = scene::Scene::from_file(&path).unwrap();
        let known = variables(&scene);
        let names: std::collections::BTreeSet<&str> = scene.check.iter().map(|check| check.name.as_str()).collect();
        assert_eq!(names.len(), scene.check.len(), "{}: two checks of one name", path.display());
        for check in &scene.check {
            let place = format!("{}: {}", path.display(), check.name);
            assert!(check.variable.is_empty() || known.contains(&check.variable), "{place}: {}", check.variable);
            let found = reference(check, &folder).unwrap_or_else(|reason| panic!("{place}: {reason}"));
            let curve = matches!(check.kind, CheckKind::CurveRms | CheckKind::CurveMaximum | CheckKind::Band);
            assert_eq!(found.is_some(), curve, "{place}");
            checked += 1;
        }
    }
    assert!(checked > 90, "{checked}");
}
