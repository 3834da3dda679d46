//! A step allocates a few small matrices and gives all of them back.
#![allow(clippy::unwrap_used, reason = "a test that cannot set up its case has failed")]

mod common;
use common::{cabin, tumbling};

#[test]
fn steps_do_not_pile_up_memory() {
    let solver = common::built(cabin(3, 508.4, 9.81)).unwrap();
    let (mut state, mut workspace) = (tumbling(&solver), solver.workspace());
    let mut count = |steps: usize| {
        let mut iterations = 0;
        let info = allocation_counter::measure(|| {
            for _ in 0..steps {
                iterations += solver.step(&mut state, &[0.0; 6], 1e-4, &mut workspace).unwrap().iterations;
            }
        });
        (info, iterations as u64)
    };
    for steps in [100, 1000] {
        let (info, iterations) = count(steps);
        // Per step the load, the factor of M, two vectors and the accelerations; per iteration a matrix, its pivots, a
        // vector.
        let allowed = 8 * steps as u64 + 4 * iterations;
        assert!(info.count_total <= allowed, "{} allocations in {steps} steps", info.count_total);
        assert_eq!((info.count_current, info.bytes_current), (0, 0));
        assert!(info.bytes_max < 4096, "{} bytes at once", info.bytes_max);
    }
}
