//! The committed files that are generated from the tables, and what they must say.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

use components::{DEFAULT_SCENE, FluidComponent, Interface, StructureComponent};
use fmi::{Causality, Component};
use fmi2::describe;
use plimsoll_tests::{Packed, root};
use std::collections::{BTreeMap, BTreeSet};

const HINT: &str = "is stale: run `cargo run -p components --example describe` and commit the result";

fn is_fresh<C: Component<Interface = Interface>>(file: &str, interface: &Interface) {
    let committed = std::fs::read_to_string(root().join("modelDescription").join(file)).unwrap();
    assert!(committed == describe::xml(&C::model(interface)).unwrap(), "{file} {HINT}");
}

fn has_fresh_table<C: Component<Interface = Interface>>(readme: &str) {
    let committed = std::fs::read_to_string(root().join(readme)).unwrap();
    let model = C::model(&Interface::of_resources(None).unwrap());
    let expected = describe::with_table(&committed, &describe::markdown(&model)).unwrap();
    assert!(committed == expected, "{readme} {HINT}");
}

fn of_scene(name: &str) -> Interface {
    Packed::of(&[name]).interface
}

/// Of FMUs that were packed for no scene, whose variables are those of dam_break_plate, and of those for a cabin.
#[test]
fn descriptions_and_tables_are_fresh() {
    assert_eq!(of_scene(DEFAULT_SCENE), Interface::of_resources(None).unwrap());
    for scene in [DEFAULT_SCENE, "damaged_cabin"] {
        is_fresh::<FluidComponent>(&format!("{scene}/fluid.xml"), &of_scene(scene));
        is_fresh::<StructureComponent>(&format!("{scene}/structure.xml"), &of_scene(scene));
    }
    has_fresh_table::<FluidComponent>("fluid-fmu/README.md");
    has_fresh_table::<StructureComponent>("structure-fmu/README.md");
}

fn table<C: Component<Interface = Interface>>(interface: &Interface) -> BTreeMap<String, (u32, Causality, String)> {
    let model = C::model(interface);
    let rows = model.variables.iter().map(|variable| {
        let kind = match variable.access {
            fmi::Access::Real { simple_type, .. } => simple_type.unwrap_or_default().to_string(),
            fmi::Access::Integer { .. } => "integer".to_string(),
            fmi::Access::Text { .. } => "text".to_string(),
        };
        (variable.name.clone(), (variable.reference, variable.causality, kind))
    });
    let table: BTreeMap<_, _> = rows.collect();
    assert_eq!(table.len(), model.variables.len(), "names are unique");
    let references: BTreeSet<u32> = model.variables.iter().map(|variable| variable.reference).collect();
    assert_eq!(references.len(), model.variables.len(), "references are unique");
    table
}

/// No body, one without members, one with one member, and two bodies with members of other numbers of modes.
fn interfaces() -> [Interface; 4] {
    let scenes = ["hydrostatic", "piston", "damaged_cabin"];
    let [first, second, third] = scenes.map(of_scene);
    [first, second, third, Packed::of(&["damaged_cabin", "dam_break_plate"]).interface]
}

#[test]
fn inputs_of_one_are_outputs_of_the_other_with_equal_types() {
    for (interface, size) in interfaces().into_iter().zip([0, 3, 6, 12]) {
        let (fluid, structure) = (table::<FluidComponent>(&interface), table::<StructureComponent>(&interface));
        let mut inputs = 0;
        for (here, there) in [(&fluid, &structure), (&structure, &fluid)] {
            for (name, (reference, causality, kind)) in here {
                if *causality == Causality::Input {
                    assert_eq!(there[name], (*reference, Causality::Output, kind.clone()), "{name}");
                    inputs += 1;
                }
            }
        }
        let half = size * (size + 1) / 2;
        assert_eq!(inputs, 5 * size + half, "three families of motion, loads, their accelerations, added mass");
    }
}

/// Letters, digits, underscores and dots, each part beginning with a letter or an underscore: what every importer takes.
#[test]
fn names_are_words_joined_by_dots() {
    for interface in interfaces() {
        let names =
            table::<FluidComponent>(&interface).into_keys().chain(table::<StructureComponent>(&interface).into_keys());
        for name in names {
            let is_word = |part: &str| {
                part.starts_with(|first: char| first.is_ascii_alphabetic() || first == '_')
                    && part.chars().all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
            };
            assert!(name.split('.').all(is_word), "{name}");
        }
    }
}

#[test]
fn another_interface_has_another_guid() {
    let mut guids = BTreeSet::new();
    for interface in interfaces() {
        guids.insert(describe::guid(&FluidComponent::model(&interface)).unwrap());
        guids.insert(describe::guid(&StructureComponent::model(&interface)).unwrap());
    }
    assert_eq!(guids.len(), 8);
}
