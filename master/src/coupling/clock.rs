//! Communication points. Time is start + n H with n a multiple of a power of 1/2, never a running sum.

/// Steps in a row that must converge before a halved step is doubled again.
const STEPS_BEFORE_GROWTH: u32 = 4;

/// Where a run stands and how long its next step is.
#[derive(Debug, Clone, PartialEq)]
pub struct Clock {
    start: f64,
    step: f64,
    steps: u64,
    finest: u32,
    /// Position in units of step / 2^finest.
    tick: u64,
    level: u32,
    streak: u32,
    /// Longest step wanted \[s\].
    longest: f64,
}

impl Clock {
    /// From `start` to the first multiple of `step` at or after `end`; steps may be halved down to `smallest`
    /// (all in seconds, step and smallest positive).
    pub fn new(start: f64, end: f64, step: f64, smallest: f64) -> Self {
        let steps = steps_between(start, end, step);
        let finest = (step / smallest).max(1.0).log2().floor().min(30.0) as u32;
        Self { start, step, steps, finest, tick: 0, level: 0, streak: 0, longest: f64::INFINITY }
    }

    /// Current time \[s\].
    pub fn time(&self) -> f64 {
        let parts = (1_u64 << self.finest) as f64;
        self.start + self.step * (self.tick as f64 / parts)
    }

    /// Duration of the next step \[s\].
    pub fn duration(&self) -> f64 {
        self.step / (1_u64 << self.level) as f64
    }

    /// Whether the end is reached.
    pub fn finished(&self) -> bool {
        self.tick >= self.steps << self.finest
    }

    /// Whether the clock stands at a full communication point, and its number.
    pub fn point(&self) -> Option<u64> {
        let parts = 1_u64 << self.finest;
        self.tick.is_multiple_of(parts).then_some(self.tick / parts)
    }

    /// Full communication steps in the whole run.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Moves to the end of the step; doubles a halved step after some successes, where it fits the grid.
    pub fn advance(&mut self) {
        self.tick += 1 << (self.finest - self.level);
        self.streak += 1;
        let coarser = 1_u64 << (self.finest + 1 - self.level.max(1));
        let wanted = 2.0 * self.duration() <= self.longest;
        if self.level > 0 && wanted && self.streak >= STEPS_BEFORE_GROWTH && self.tick.is_multiple_of(coarser) {
            self.level -= 1;
            self.streak = 0;
        }
    }

    /// Halves the next steps until they are no longer than `longest` \[s\], or the smallest allowed.
    pub fn limit(&mut self, longest: f64) {
        self.longest = longest;
        while self.duration() > longest && self.level < self.finest {
            self.level += 1;
            self.streak = 0;
        }
    }

    /// Halves the step; false when it is the smallest already.
    pub fn halve(&mut self) -> bool {
        self.streak = 0;
        let possible = self.level < self.finest;
        self.level += u32::from(possible);
        possible
    }
}

/// Communication steps of `step` from `start` up to the first at or after `end` (all in seconds).
pub fn steps_between(start: f64, end: f64, step: f64) -> u64 {
    ((end - start) / step - 1e-6).ceil().max(0.0) as u64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_is_a_multiple_of_the_step() {
        let mut clock = Clock::new(0.0, 1.0, 0.1, 0.1);
        for n in 0..10 {
            assert_eq!(clock.point(), Some(n));
            // 0.1 * 3 = 0.30000000000000004, while a running sum drifts on from there.
            assert_eq!(clock.time(), 0.1 * n as f64);
            clock.advance();
        }
        assert!(clock.finished());
        assert_eq!(clock.steps(), 10);
    }

    #[test]
    fn halves_and_grows_back_on_the_grid() {
        let mut clock = Clock::new(0.0, 4.0, 1.0, 0.25);
        assert!(clock.halve() && clock.halve() && !clock.halve());
        let mut durations = Vec::new();
        while !clock.finished() {
            durations.push(clock.duration());
            clock.advance();
        }
        assert_eq!(durations, [0.25, 0.25, 0.25, 0.25, 0.5, 0.5, 0.5, 0.5, 1.0]);
        assert_eq!(clock.time(), 4.0);
    }

    #[test]
    fn a_limit_shortens_steps_and_lets_them_grow_again() {
        let mut clock = Clock::new(0.0, 4.0, 1.0, 0.25);
        clock.limit(0.6);
        assert_eq!(clock.duration(), 0.5);
        (0..6).for_each(|_| clock.advance());
        assert_eq!((clock.duration(), clock.time()), (0.5, 3.0));
        clock.limit(1.1);
        clock.advance();
        clock.advance();
        assert_eq!((clock.duration(), clock.time()), (1.0, 4.0));
        clock.limit(1e-9);
        assert_eq!(clock.duration(), 0.25, "never below the smallest");
    }

    #[test]
    fn an_end_between_points_is_passed() {
        assert_eq!(Clock::new(0.0, 0.25, 0.1, 0.1).steps(), 3);
        assert_eq!(Clock::new(0.0, 0.3, 0.1, 0.1).steps(), 3);
    }
}
