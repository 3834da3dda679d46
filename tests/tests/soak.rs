//! Many steps of either FMU, with states saved, restored, serialised and freed on the way: memory stays what it is, no
//! particle is lost, no energy comes from nowhere.
#![allow(missing_docs, clippy::unwrap_used, reason = "test")]

use components::{FluidComponent, Interface, StructureComponent};
use fmi::Component;
use fmi2::ffi::Status;
use plimsoll_tests::{Library, Packed, Slave, real_outputs};

/// Steps between two saved states.
const BETWEEN: usize = 100;
/// How much memory may grow after the first tenth of the steps \[kB\]: pages that the allocator holds back.
const MOST_GROWTH: u64 = 1024;

const KINETIC_OF_WATER: u32 = 363;
const TOTAL_OF_WATER: u32 = 377;
const COUNT: u32 = 381;
const LOST: u32 = 382;

fn slave<'a, C: Component<Interface = Interface>>(library: &'a Library, scene: &str, overrides: &str) -> Slave<'a> {
    let packed = Packed::of(&[scene]);
    let slave =
        Slave::new(library, &packed.guid::<C>(), Some(&packed.location())).unwrap_or_else(|why| panic!("{why:?}"));
    assert_eq!(slave.set_text(1, scene), Status::OK);
    assert_eq!(slave.set_text(2, overrides), Status::OK);
    assert_eq!(slave.initialise(0.0), Status::OK, "{:?}", slave.messages());
    slave
}

/// Goes away from the present state and comes back to it, by its handle and by its bytes.
fn there_and_back(slave: &Slave, time: f64, step: f64) {
    let state = slave.save();
    let bytes = slave.bytes(&state);
    assert_eq!(slave.step(time, 0.5 * step), Status::OK, "{:?}", slave.messages());
    let copy = slave.from_bytes(&bytes).unwrap();
    assert_eq!(slave.restore(&copy), Status::OK);
    assert_eq!(slave.step(time, step), Status::OK, "{:?}", slave.messages());
    assert_eq!(slave.restore(&state), Status::OK);
    assert_eq!((slave.free(state), slave.free(copy)), (Status::OK, Status::OK));
}

/// Does `steps` steps and looks at the instance between them; memory after a tenth of them and at the end \[kB\].
fn soak<C: Component<Interface = Interface>>(
    slave: &Slave,
    scene: &str,
    steps: usize,
    step: f64,
    look: impl Fn(&Slave),
) -> [u64; 2] {
    let outputs = real_outputs(&C::model(&Packed::of(&[scene]).interface));
    let mut memory = [0; 2];
    for number in 0..steps {
        let time = step * number as f64;
        if number.is_multiple_of(BETWEEN) {
            there_and_back(slave, time, step);
            assert!(slave.reals(&outputs).iter().all(|value| value.is_finite()), "step {number}");
            look(slave);
        }
        assert_eq!(slave.step(time, step), Status::OK, "{:?}", slave.messages());
        if number + 1 == steps / 10 {
            memory[0] = fuzzing::memory("VmRSS").unwrap_or(0);
        }
    }
    memory[1] = fuzzing::memory("VmRSS").unwrap_or(0);
    memory
}

fn does_not_grow(what: &str, steps: usize, [early, late]: [u64; 2]) {
    println!("{what}: {steps} steps, {early} kB resident after a tenth of them, {late} kB at the end");
    assert!(late <= early + MOST_GROWTH, "{what}: {early} kB, {late} kB");
}

/// Kinetic and potential energy of the structure \[J/m\].
fn energy(slave: &Slave) -> f64 {
    let model = StructureComponent::model(&Packed::of(&["free_decay"]).interface);
    let wanted = ["energy.kinetic", "energy.potential"];
    slave.reals(&plimsoll_tests::references(&model, |variable| wanted.contains(&variable.name.as_str()))).iter().sum()
}

/// A bent plate in vacuum: the average acceleration keeps its energy.
fn plate(steps: usize) {
    let library = Library::load("structure_fmu").unwrap();
    let slave = slave::<StructureComponent>(&library, "free_decay", "");
    let first = energy(&slave);
    assert!(first > 0.0);
    let memory = soak::<StructureComponent>(&slave, "free_decay", steps, 0.001, |slave| {
        let now = energy(slave);
        assert!((now / first - 1.0).abs() < 1e-6, "{first} J/m at the start, {now} J/m now");
    });
    does_not_grow("structure", steps, memory);
}

/// A hundred particles that slosh until they are at rest: their energy falls.
fn tank(steps: usize) {
    let library = Library::load("fluid_fmu").unwrap();
    let sloshing = "fluid.spacing=0.0707; fluid.threads=1; fluid.start.velocity=[0.3,0.0]";
    let slave = slave::<FluidComponent>(&library, "hydrostatic", sloshing);
    let (count, first) = (slave.integer(COUNT), slave.reals(&[TOTAL_OF_WATER])[0]);
    let moving = slave.reals(&[KINETIC_OF_WATER])[0];
    assert!((80..=120).contains(&count) && moving > 10.0, "{count} particles, {moving} J/m");
    let memory = soak::<FluidComponent>(&slave, "hydrostatic", steps, 0.005, |slave| {
        assert_eq!((slave.integer(COUNT), slave.integer(LOST)), (count, 0));
        let now = slave.reals(&[TOTAL_OF_WATER])[0];
        assert!(now <= first + 0.01 * moving, "{first} J/m at the start, {now} J/m now");
    });
    let rest = slave.reals(&[KINETIC_OF_WATER])[0];
    println!("fluid: {moving} J/m of motion at the start, {rest} J/m at the end");
    assert!(rest < 0.05 * moving, "{moving} J/m of motion at the start, {rest} J/m at the end");
    does_not_grow("fluid", steps, memory);
}

/// One after the other: both count the memory of the process.
#[test]
fn a_hundred_thousand_steps_of_each() {
    plate(100_000);
    tank(100_000);
}
