//! What the fuzz tests and the soak share: cases that repeat from run to run, and how much memory this process has.
//!
//! `PLIMSOLL_FUZZ_FACTOR` multiplies the number of cases, `PLIMSOLL_FUZZ_SEED` picks others.

use proptest::test_runner::{Config, RngSeed};

fn number(variable: &str, otherwise: u64) -> u64 {
    std::env::var(variable).ok().and_then(|text| text.parse().ok()).unwrap_or(otherwise)
}

/// This many cases, always the same.
pub fn config(cases: u32) -> Config {
    Config {
        cases: cases * number("PLIMSOLL_FUZZ_FACTOR", 1) as u32,
        rng_seed: RngSeed::Fixed(number("PLIMSOLL_FUZZ_SEED", 1)),
        failure_persistence: None,
        max_shrink_time: 60_000,
        ..Config::default()
    }
}

/// A line of /proc/self/status \[kB\]: `VmRSS` for what is resident, `VmHWM` for the most that was. None elsewhere than
/// on Linux.
pub fn memory(line: &str) -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let found = status.lines().find(|candidate| candidate.starts_with(line))?;
    found.split_whitespace().nth(1)?.parse().ok()
}
