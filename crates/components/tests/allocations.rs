//! A step through the FMI allocates nothing once its memory is there, and a pass of the coupling, which saves and restores,
//! nothing that grows with the particles.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use components::{FluidComponent, Interface, StructureComponent};
use fmi::{Component, Logger};
use fmi2::Instance;
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// The system's allocator with a count of what it was asked for, and of its bytes.
struct Counting;

static COUNT: AtomicUsize = AtomicUsize::new(0);
static BYTES: AtomicUsize = AtomicUsize::new(0);

fn note(size: usize) {
    COUNT.fetch_add(1, Relaxed);
    BYTES.fetch_add(size, Relaxed);
}

// SAFETY: every call goes to the system's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        note(layout.size());
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        note(size);
        // SAFETY: the caller keeps the contract of `realloc`.
        unsafe { System.realloc(pointer, layout, size) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller keeps the contract of `dealloc`.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Steps that are looked at; a thread pool takes a block for every 63 of its tasks, and every step is one.
const STEPS: usize = 63;
const OF_THE_POOL: usize = 2;
/// Length of a step \[s\].
const STEP: f64 = 1e-3;

fn scene() -> String {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/dam_break_plate.toml");
    std::fs::canonicalize(path).unwrap().to_string_lossy().into_owned()
}

fn ready<C: Component<Interface = Interface>>() -> Instance<C> {
    let mut instance = Instance::<C>::new(Interface::of_resources(None).unwrap(), None, Logger::silent()).unwrap();
    let reference = |name: &str| {
        instance.model().variables.iter().find(|variable| variable.name == name).map(|variable| variable.reference)
    };
    let (scene_file, overrides) = (reference("scene").unwrap(), reference("scene_overrides").unwrap());
    // Water at rest beside a plate that does not move.
    let changes =
        "fluid.threads=1; fluid.water=[{polygon=[[0,0],[0.286,0],[0.286,0.07],[0,0.07]]}]; gravity=[0.0,-9.81]";
    instance.set_string(&[scene_file, overrides], &[&scene(), changes]).unwrap();
    instance.setup_experiment(None, 0.0, None).unwrap();
    instance.enter_initialization_mode().unwrap();
    instance.exit_initialization_mode().unwrap();
    instance
}

/// Allocations, and their bytes, of the last of many times `STEPS` steps; each is made twice where a pass is repeated.
fn counted<C: Component<Interface = Interface>>(passes: usize) -> (usize, usize) {
    let mut instance = ready::<C>();
    let mut saved = instance.get_state().unwrap();
    let mut step = 0;
    let mut run = || {
        let before = (COUNT.load(Relaxed), BYTES.load(Relaxed));
        for _ in 0..STEPS {
            if passes > 1 {
                instance.get_state_into(&mut saved).unwrap();
            }
            for pass in 0..passes {
                if pass > 0 {
                    instance.set_state(&saved).unwrap();
                }
                instance.do_step(STEP * f64::from(step), STEP).unwrap();
            }
            step += 1;
        }
        (COUNT.load(Relaxed) - before.0, BYTES.load(Relaxed) - before.1)
    };
    (0..12).for_each(|_| {
        run();
    });
    run()
}

/// In one test, since the count is that of the process. Saving and restoring copies a few short texts; of the structure a step
/// takes the factors of two matrices with as many rows as coordinates, and vectors for them.
#[test]
fn steps_and_repeated_passes_allocate_nothing_that_grows_with_the_particles() {
    let (count, _) = counted::<FluidComponent>(1);
    assert!(count <= OF_THE_POOL, "steps of the fluid: {count} allocations in {STEPS} steps");
    let (count, bytes) = counted::<FluidComponent>(2);
    let particles = 1250 * STEPS;
    assert!(bytes < particles, "repeated passes: {bytes} bytes in {count} allocations, {particles} particles saved");
    let (count, bytes) = counted::<StructureComponent>(1);
    assert!(count <= 16 * STEPS && bytes <= 2000 * STEPS, "structure: {count} allocations, {bytes} bytes");
}
