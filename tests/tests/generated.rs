//! The committed files that are generated from the tables, and what they must say.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

use components::{DEFAULT_MODES, FluidComponent, StructureComponent};
use fmi2::{Causality, Component, describe};
use plimsoll_tests::root;
use std::collections::{BTreeMap, BTreeSet};

const HINT: &str = "is stale: run `cargo run -p components --example describe` and commit the result";

fn fresh<C: Component>(xml: &str, readme: &str) {
    let model = C::model(DEFAULT_MODES);
    let committed = std::fs::read_to_string(root().join(xml)).unwrap();
    assert!(committed == describe::xml(&model).unwrap(), "{xml} {HINT}");
    let committed = std::fs::read_to_string(root().join(readme)).unwrap();
    let expected = describe::with_table(&committed, &describe::markdown(&model)).unwrap();
    assert!(committed == expected, "{readme} {HINT}");
}

#[test]
fn descriptions_and_tables_are_fresh() {
    fresh::<FluidComponent>("modelDescription/fluid.xml", "fluid-fmu/README.md");
    fresh::<StructureComponent>("modelDescription/structure.xml", "structure-fmu/README.md");
}

fn table<C: Component>(modes: usize) -> BTreeMap<String, (u32, Causality, String)> {
    let model = C::model(modes);
    let rows = model.variables.iter().map(|variable| {
        let kind = match variable.access {
            fmi2::Access::Real { simple_type, .. } => simple_type.unwrap_or_default().to_string(),
            fmi2::Access::Integer { .. } => "integer".to_string(),
            fmi2::Access::Text { .. } => "text".to_string(),
        };
        (variable.name.clone(), (variable.reference, variable.causality, kind))
    });
    let table: BTreeMap<_, _> = rows.collect();
    assert_eq!(table.len(), model.variables.len(), "names are unique");
    let references: BTreeSet<u32> = model.variables.iter().map(|variable| variable.reference).collect();
    assert_eq!(references.len(), model.variables.len(), "references are unique");
    table
}

#[test]
fn inputs_of_one_are_outputs_of_the_other_with_equal_types() {
    for modes in 0..=8 {
        let (fluid, structure) = (table::<FluidComponent>(modes), table::<StructureComponent>(modes));
        let mut inputs = 0;
        for (here, there) in [(&fluid, &structure), (&structure, &fluid)] {
            for (name, (reference, causality, kind)) in here {
                if *causality == Causality::Input {
                    assert_eq!(there[name], (*reference, Causality::Output, kind.clone()), "{name}");
                    inputs += 1;
                }
            }
        }
        let size = 3 + modes;
        assert_eq!(inputs, 5 * size + size * size, "three families of motion, loads, their accelerations, added mass");
    }
}

#[test]
fn references_and_guids_by_number_of_modes() {
    let largest = table::<FluidComponent>(8);
    let mut guids = BTreeSet::new();
    for modes in 0..=8 {
        for (name, row) in table::<FluidComponent>(modes) {
            assert_eq!(largest[&name], row, "{name}");
        }
        guids.insert(describe::guid(&FluidComponent::model(modes)).unwrap());
        guids.insert(describe::guid(&StructureComponent::model(modes)).unwrap());
    }
    assert_eq!(guids.len(), 18);
}
