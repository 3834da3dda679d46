//! Times of the stages of a step by themselves: `cargo bench -p fluid`. One thread; a column of water that has begun to
//! fall.

use divan::Bencher;
use fluid::{Solver, Stages, State};
use samples::{Column, parameters, voronoi};

/// Particles.
const SIZES: [usize; 3] = [1_000, 10_000, 100_000];

fn main() {
    divan::main();
}

/// A column of about `count` particles after ten steps, and the length of the next one.
fn column(count: usize) -> Option<(Solver, State, f64)> {
    let column = Column::KOSHIZUKA;
    let spacing = (column.area() / count as f64).sqrt();
    let solver = Solver::new(parameters(voronoi(), spacing, 1e-4, 1), column.geometry(1.2)).ok()?;
    let (mut state, mut workspace) = (solver.initial_state(), solver.workspace());
    let time_step = 0.1 * (spacing / 9.81).sqrt();
    for _ in 0..10 {
        solver.step(&mut state, &solver.at_rest(), time_step, &mut workspace).ok()?;
    }
    Some((solver, state, time_step))
}

fn time(bencher: Bencher, count: usize, stage: impl Fn(&mut Stages)) {
    let Some((solver, state, time_step)) = column(count) else { return };
    let particles = state.positions.len();
    let Some(mut stages) = Stages::new(&solver, state, time_step) else { return };
    bencher.counter(divan::counter::ItemsCount::new(particles)).bench_local(|| stage(&mut stages));
}

#[divan::bench(args = SIZES)]
fn neighbours_and_cells(bencher: Bencher, count: usize) {
    time(bencher, count, |stages| stages.cells());
}

#[divan::bench(args = SIZES)]
fn assembly(bencher: Bencher, count: usize) {
    time(bencher, count, |stages| stages.assembly());
}

#[divan::bench(args = SIZES)]
fn solve(bencher: Bencher, count: usize) {
    time(bencher, count, |stages| {
        stages.solve();
    });
}

#[divan::bench(args = SIZES)]
fn gradient(bencher: Bencher, count: usize) {
    time(bencher, count, |stages| stages.gradient());
}
