//! The descriptions and the packed FMUs in the hands of an importer that is not ours: the crate fmi-rs.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

use components::{DEFAULT_SCENE, FluidComponent, Interface, LOAD, POSITION, StructureComponent};
use fmi::{Access, Component, Logger, Model, Variable};
use fmi_rs::fmi2::builder::FMU2Builder;
use fmi_rs::fmi2::types::{fmi2False, fmi2Status};
use fmi_rs::fmi2::{CS, FMU2};
use fmi_rs::model_description::fmi2::{Causality, ModelDescription, ScalarVariable};
use fmi2::{Instance, describe};
use plimsoll_tests::{real_outputs, root};
use std::ptr::null_mut;

const STEP: f64 = 0.000_5;
const SCENE: [&str; 2] = [
    "dam_break_plate",
    // A coarse column beside the plate: 325 particles.
    "fluid.spacing = 0.012; fluid.water.0.polygon = [[0,0],[0.286,0],[0.286,0.14],[0,0.14]]",
];

/// Of FMUs that were packed for no scene.
fn default_interface() -> Interface {
    Interface::of_resources(None).unwrap()
}

/// Name, reference, causality, type and unit of a variable.
type Row<'a> = (&'a str, u32, Causality, &'static str, Option<&'a str>);

/// As the table has it.
fn written<'a, C: Component>(model: &'a Model<C>, variable: &'a Variable<C>) -> Row<'a> {
    let causality = match variable.causality {
        fmi::Causality::Parameter => Causality::Parameter,
        fmi::Causality::Input => Causality::Input,
        fmi::Causality::Output => Causality::Output,
    };
    let (kind, simple_type) = match variable.access {
        Access::Real { simple_type, .. } => ("Real", simple_type),
        Access::Integer { .. } => ("Integer", None),
        Access::Text { .. } => ("String", None),
    };
    let unit = simple_type.map(|name| model.types.iter().find(|simple| simple.name == name).unwrap().unit);
    (&variable.name, variable.reference, causality, kind, unit)
}

/// As the other parser found it.
fn read<'a>(description: &'a ModelDescription, variable: &'a ScalarVariable) -> Row<'a> {
    let unit = description.get_unit(variable);
    (&variable.name, variable.valueReference, variable.causality, variable.variableType.name(), unit)
}

fn is_read_as_written<C: Component<Interface = Interface>>(file: &str) {
    let path = root().join("modelDescription").join(DEFAULT_SCENE).join(file);
    let description = ModelDescription::from_path(&path).unwrap();
    let problems = description.validate();
    assert!(problems.is_empty(), "{problems:?}");
    let model = C::model(&default_interface());
    assert_eq!(description.guid, describe::guid(&model).unwrap().to_string());
    let rows: Vec<Row> = description.modelVariables.iter().map(|variable| read(&description, variable)).collect();
    let expected: Vec<Row> = model.variables.iter().map(|variable| written(&model, variable)).collect();
    assert_eq!(rows, expected);
    assert!(rows.iter().any(|row| row.4 == Some("N.m/m")), "or no unit would have been compared");
    for output in &description.outputs {
        let reference = |index: &u32| description.variable_by_index(*index).unwrap().valueReference;
        let found: Option<Vec<u32>> = output.dependencies.as_ref().map(|list| list.iter().map(reference).collect());
        let variable = model.variables.iter().find(|variable| variable.reference == reference(&output.index)).unwrap();
        assert_eq!(found.as_ref(), Some(&variable.dependencies), "{}", variable.name);
    }
    let interface = description.coSimulation.unwrap();
    assert_eq!(interface.modelIdentifier, model.identifier);
    assert!(interface.canGetAndSetFMUstate && interface.canSerializeFMUstate);
    assert_eq!(interface.providesDirectionalDerivative, model.directional_derivatives);
}

#[test]
fn descriptions_are_valid_and_read_as_written() {
    is_read_as_written::<FluidComponent>("fluid.xml");
    is_read_as_written::<StructureComponent>("structure.xml");
}

fn advance(slave: &FMU2<CS>, (reference, value): (u32, f64), steps: std::ops::Range<usize>) {
    for n in steps {
        assert_eq!(slave.setReal(&[reference], &[value]), fmi2Status::Ok);
        assert_eq!(slave.doStep(n as f64 * STEP, STEP, fmi2False), fmi2Status::Ok);
    }
}

fn bits<C: Component<Interface = Interface>>(slave: &FMU2<CS>) -> Vec<u64> {
    let references = real_outputs(&C::model(&default_interface()));
    let mut values = vec![f64::NAN; references.len()];
    assert_eq!(slave.getReal(&references, &mut values), fmi2Status::Ok);
    values.iter().map(|value| value.to_bits()).collect()
}

/// Outputs after this number of steps in process, without archive, C ABI or states.
fn direct_bits<C: Component<Interface = Interface>>((reference, value): (u32, f64), steps: usize) -> Vec<u64> {
    let mut instance = Instance::<C>::new(default_interface(), Some(root()), Logger::silent()).unwrap();
    instance.set_string(&[1, 2], &SCENE).unwrap();
    instance.setup_experiment(None, 0.0, None).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
    for n in 0..steps {
        instance.set_real(&[reference], &[value]).unwrap();
        instance.do_step(n as f64 * STEP, STEP).unwrap();
    }
    let references = real_outputs(&C::model(&default_interface()));
    let mut values = vec![f64::NAN; references.len()];
    instance.get_real(&references, &mut values).unwrap();
    values.iter().map(|value| value.to_bits()).collect()
}

/// Six steps, with a detour taken back after the third; then the last three again in another instance.
fn packed_and_in_process_the_bits_are_the_same<C: Component<Interface = Interface>>(file: &str, input: (u32, f64)) {
    let folder = tempfile::tempdir().unwrap();
    plimsoll::pack::pack(folder.path()).unwrap();
    let archive = FMU2Builder::new(&folder.path().join(file)).unwrap();
    let first = archive.instantiate_cs("first").unwrap();
    assert_eq!(first.setString(&[1, 2], &SCENE), fmi2Status::Ok);
    assert_eq!(first.setupExperiment(None, 0.0, None), fmi2Status::Ok);
    assert_eq!(first.enterInitializationMode(), fmi2Status::Ok);
    assert_eq!(first.exitInitializationMode(), fmi2Status::Ok);
    advance(&first, input, 0..3);
    let (mut state, at_save) = (null_mut(), bits::<C>(&first));
    assert_eq!(first.getFMUstate(&mut state), fmi2Status::Ok);
    assert_eq!(at_save, direct_bits::<C>(input, 3));
    advance(&first, (input.0, -3.0 * input.1), 3..5);
    assert_ne!(bits::<C>(&first), direct_bits::<C>(input, 5), "the input matters");
    assert_eq!(first.setFMUstate(state), fmi2Status::Ok);
    assert_eq!(bits::<C>(&first), at_save);
    advance(&first, input, 3..6);
    let expected = direct_bits::<C>(input, 6);
    assert_eq!(bits::<C>(&first), expected, "restored");

    let mut size = 0;
    assert_eq!(first.serializedFMUstateSize(state, &mut size), fmi2Status::Ok);
    let mut bytes = vec![0; size];
    assert_eq!(first.serializeFMUstate(state, &mut bytes), fmi2Status::Ok);
    assert_eq!(first.freeFMUstate(&mut state), fmi2Status::Ok);
    assert!(state.is_null());
    let second = archive.instantiate_cs("second").unwrap();
    assert_eq!(second.deSerializeFMUstate(&bytes, &mut state), fmi2Status::Ok);
    assert_eq!(second.setFMUstate(state), fmi2Status::Ok);
    advance(&second, input, 3..6);
    assert_eq!(bits::<C>(&second), expected, "from bytes");
    assert_eq!(second.freeFMUstate(&mut state), fmi2Status::Ok);
    assert_eq!(second.terminate(), fmi2Status::Ok);
}

#[test]
fn structure_under_a_constant_load() {
    packed_and_in_process_the_bits_are_the_same::<StructureComponent>("structure.fmu", (LOAD + 3, 5.0));
}

#[test]
fn fluid_beside_a_bent_plate() {
    packed_and_in_process_the_bits_are_the_same::<FluidComponent>("fluid.fmu", (POSITION + 3, 1e-5));
}

#[test]
fn messages_arrive_with_the_number_at_fault() {
    let folder = tempfile::tempdir().unwrap();
    plimsoll::pack::pack(folder.path()).unwrap();
    let mut archive = FMU2Builder::new(&folder.path().join("structure.fmu")).unwrap();
    let log = folder.path().join("log.txt");
    archive.logFile = Some(log.clone());
    let slave = archive.instantiate_cs("slave").unwrap();
    assert_eq!(slave.setString(&[1], &["100 %s"]), fmi2Status::Ok);
    assert_eq!(slave.setupExperiment(None, 0.0, None), fmi2Status::Ok);
    assert_eq!(slave.enterInitializationMode(), fmi2Status::Error);
    let text = std::fs::read_to_string(log).unwrap();
    assert!(text.contains("100 %") && text.contains("logStatusError"), "{text}");
}
