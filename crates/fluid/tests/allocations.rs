//! A step allocates nothing once its memory is there.
#![allow(clippy::unwrap_used, reason = "a panic is how a test fails")]

use fluid::{Geometry, Solver};
use samples::{dam_break_plate, parameters, rectangle, tank, voronoi};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// The system's allocator with a count of what it was asked for.
struct Counting;

static COUNT: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call goes to the system's allocator as it is.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.fetch_add(1, Relaxed);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        COUNT.fetch_add(1, Relaxed);
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

/// Steps that are looked at.
const STEPS: usize = 100;
/// A task queue of the thread pool takes a block for every 63 entries, and every step is one.
const OF_THE_POOL: usize = STEPS.div_ceil(63);

/// Allocations in the steps that follow twelve times as many: rows of the matrix grow now and then at first.
fn allocations(geometry: Geometry, threads: usize) -> usize {
    let solver = Solver::new(parameters(voronoi(), 0.004, 1e-4, threads), geometry).unwrap();
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    let still = solver.at_rest();
    let mut run = || {
        let before = COUNT.load(Relaxed);
        for _ in 0..STEPS {
            solver.step(&mut state, &still, 0.0005, &mut workspace).unwrap();
        }
        COUNT.load(Relaxed) - before
    };
    (0..12).for_each(|_| {
        run();
    });
    run()
}

/// Water at rest; a plate in still water whose modes answer to the load.
#[test]
fn a_step_allocates_nothing() {
    let still = || Geometry {
        water: vec![rectangle(0.0, 0.0, 0.584, 0.146)],
        fixed_walls: vec![tank(0.584, 0.3)],
        ..Geometry::default()
    };
    let answering = || {
        let dam_break = dam_break_plate();
        let water = vec![rectangle(0.0, 0.0, 0.286, 0.072), rectangle(0.298, 0.0, 0.584, 0.072)];
        Geometry { water, active: vec![3, 4], ..dam_break }
    };
    for threads in [1, 2] {
        let count = allocations(still(), threads);
        assert!(count <= OF_THE_POOL, "water at rest, {threads} threads: {count} in {STEPS} steps");
        let count = allocations(answering(), threads);
        assert!(count <= OF_THE_POOL, "a plate that answers, {threads} threads: {count} in {STEPS} steps");
    }
}
