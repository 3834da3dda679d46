//! Communication points. Time is start + n H with n a whole number of ticks of 2^-k, never a running sum; the last step
//! is shorter than H where the end is no multiple of it.

use serde::{Deserialize, Serialize};

/// Steps in a row that must converge before a halved step is doubled again.
const STEPS_BEFORE_GROWTH: u32 = 4;
/// Ticks of the smallest step, as a power of 2: parts of a communication step are equal to this precision.
const TICKS: u32 = 10;

/// Where a run stands and how long its next step is.
///
/// What is left up to the next communication point is divided into equal steps, as few as are no longer than allowed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Clock {
    start: f64,
    end: f64,
    step: f64,
    steps: u64,
    finest: u32,
    /// Position in units of step / 2^(finest + TICKS).
    tick: u64,
    level: u32,
    streak: u32,
    /// Longest step wanted \[s\].
    longest: f64,
}

impl Clock {
    /// From `start` to `end` in steps of `step`, the last of which may be shorter; steps may be divided down to
    /// `smallest` (all in seconds, step and smallest positive).
    pub fn new(start: f64, end: f64, step: f64, smallest: f64) -> Self {
        let steps = steps_between(start, end, step);
        let finest = (step / smallest).max(1.0).log2().floor().min(30.0) as u32;
        Self { start, end, step, steps, finest, tick: 0, level: 0, streak: 0, longest: f64::INFINITY }
    }

    /// Current time \[s\].
    pub fn time(&self) -> f64 {
        if self.finished() {
            return self.end;
        }
        let (point, part) = (self.tick / self.parts(), self.tick % self.parts());
        if point + 1 < self.steps {
            return self.start + self.step * (self.tick as f64 / self.parts() as f64);
        }
        self.start + self.step * point as f64 + self.interval() * (part as f64 / self.parts() as f64)
    }

    /// Duration of the next step \[s\].
    pub fn duration(&self) -> f64 {
        self.interval() * (self.next() as f64 / self.parts() as f64)
    }

    /// Distance of the communication points on both sides \[s\]: the step, or what is left for the last one.
    fn interval(&self) -> f64 {
        let last = self.steps.saturating_sub(1);
        let left = self.end - (self.start + self.step * last as f64);
        let shorter = self.tick / self.parts() >= last && (left - self.step).abs() > SAME * self.step;
        if shorter { left } else { self.step }
    }

    /// Whether the end is reached.
    pub fn finished(&self) -> bool {
        self.tick >= self.steps * self.parts()
    }

    /// Takes step and end of another clock of the same start. The time stays the same, or it is none of the other clock:
    /// one beyond the end, or within a step that has another length there; [`Self::is_at`] tells.
    pub fn end_with(&mut self, other: &Self) {
        (self.end, self.step, self.steps) = (other.end, other.step, other.steps);
    }

    /// Whether the clock stands at `time` \[s\].
    pub fn is_at(&self, time: f64) -> bool {
        (self.time() - time).abs() <= SAME * self.step
    }

    /// Whether the clock stands at a full communication point, and its number.
    pub fn point(&self) -> Option<u64> {
        self.tick.is_multiple_of(self.parts()).then_some(self.tick / self.parts())
    }

    /// Full communication steps in the whole run.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Moves to the end of the step; doubles a step that was halved after some successes.
    pub fn advance(&mut self) {
        self.tick += self.next();
        self.streak += 1;
        if self.level > 0 && self.streak >= STEPS_BEFORE_GROWTH {
            self.level -= 1;
            self.streak = 0;
        }
    }

    /// Keeps the next steps no longer than `longest` \[s\], or the smallest allowed.
    pub fn limit(&mut self, longest: f64) {
        self.longest = longest;
    }

    /// Halves the step; false when it is the smallest already.
    pub fn halve(&mut self) -> bool {
        self.streak = 0;
        let before = self.next();
        while self.level < self.finest && self.next() == before {
            self.level += 1;
        }
        self.next() < before
    }

    /// Ticks of a communication step.
    fn parts(&self) -> u64 {
        1 << (self.finest + TICKS)
    }

    /// Ticks of the next step.
    fn next(&self) -> u64 {
        let left = self.parts() - self.tick % self.parts();
        let halved = self.parts() >> self.level;
        let interval = self.interval();
        let wanted = (self.longest / interval * self.parts() as f64 * (1.0 + 1e-12)) as u64;
        // Parts of a last step that is shorter are no smaller than those of the others.
        let least = ((1 << TICKS) as f64 * self.step / interval).ceil() as u64;
        let most = wanted.min(halved).max(least);
        left / left.div_ceil(most)
    }
}

/// Share of a step up to which the end counts as a multiple of it: rounding, and ends written with few digits.
const SAME: f64 = 1e-6;

/// Communication steps of `step` from `start` to `end`, the last of which may be shorter (all in seconds).
fn steps_between(start: f64, end: f64, step: f64) -> u64 {
    ((end - start) / step - SAME).ceil().max(0.0) as u64
}

/// The step that divides a run of FMUs that know one step only: `step` or a little less, so that `end` is reached.
pub fn even_step(start: f64, end: f64, step: f64) -> f64 {
    let steps = steps_between(start, end, step).max(1) as f64;
    let even = (end - start) / steps;
    if (even - step).abs() * steps <= SAME * step { step } else { even }
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
        assert_eq!(clock.duration(), 1.0);
        clock.limit(1e-9);
        assert_eq!(clock.duration(), 0.25, "never below the smallest");
    }

    #[test]
    fn what_is_left_is_divided_equally() {
        let mut clock = Clock::new(0.0, 1.0, 1.0, 1.0 / 64.0);
        clock.limit(0.4);
        assert!((clock.duration() - 1.0 / 3.0).abs() < 1e-4, "{}", clock.duration());
        clock.advance();
        clock.limit(0.2);
        let mut steps = 0;
        while !clock.finished() {
            assert!((clock.duration() - 1.0 / 6.0).abs() < 1e-4, "{}", clock.duration());
            clock.advance();
            steps += 1;
        }
        assert_eq!((steps, clock.time(), clock.point()), (4, 1.0, Some(1)));
    }

    #[test]
    fn another_end_changes_nothing_else() {
        let mut clock = Clock::new(0.0, 1.0, 0.5, 0.25);
        clock.advance();
        clock.end_with(&Clock::new(0.0, 1.5, 0.5, 0.25));
        clock.advance();
        assert!(!clock.finished() && clock.is_at(1.0));
        assert_eq!((clock.time(), clock.point(), clock.steps()), (1.0, Some(2), 3));
        clock.end_with(&Clock::new(0.0, 0.5, 0.5, 0.25));
        assert!(!clock.is_at(1.0), "it stands beyond the end");
    }

    #[test]
    fn another_end_is_none_within_a_step_that_it_divides_otherwise() {
        // 0.25 s lie within the last step of 0.1 s from 0.2 s to the end at 0.3 s.
        let at = |end: f64| {
            let mut clock = Clock::new(0.0, end, 0.1, 0.025);
            clock.limit(0.05);
            while clock.time() < 0.249 {
                clock.advance();
            }
            clock
        };
        let goes_on = |from: f64, to: f64| {
            let mut clock = at(from);
            let stood = clock.time();
            clock.end_with(&Clock::new(0.0, to, 0.1, 0.025));
            clock.is_at(stood)
        };
        assert!(goes_on(1.0, 0.7) && goes_on(0.3, 1.0) && goes_on(0.28, 0.28));
        assert!(!goes_on(1.0, 0.28) && !goes_on(0.28, 1.0) && !goes_on(1.0, 0.22));
        // At a communication point any later end will do, a shorter last step or none.
        let mut clock = Clock::new(0.0, 0.35, 0.1, 0.1);
        (0..3).for_each(|_| clock.advance());
        clock.end_with(&Clock::new(0.0, 0.37, 0.1, 0.1));
        assert!(clock.is_at(0.3) && (clock.duration() - 0.07).abs() < 1e-12);
        // Steps of one length only have another one.
        clock.end_with(&Clock::new(0.0, 0.4, 0.08, 0.08));
        assert!(!clock.is_at(0.3));
    }

    #[test]
    fn an_end_between_points_is_reached_by_a_shorter_step() {
        let run = |start: f64, end: f64, step: f64, longest: f64| {
            let mut clock = Clock::new(start, end, step, 0.05);
            clock.limit(longest);
            let mut times = vec![clock.time()];
            while !clock.finished() {
                let expected = clock.time() + clock.duration();
                clock.advance();
                assert!((clock.time() - expected).abs() < 1e-12, "{} {expected}", clock.time());
                times.push(clock.time());
            }
            times
        };
        assert_eq!(run(0.0, 1.0, 0.3, 1.0), [0.0, 0.3, 0.6, 0.3 * 3.0, 1.0]);
        assert_eq!(run(-0.5, 0.5, 0.4, 1.0), [-0.5, -0.5 + 0.4, -0.5 + 0.8, 0.5]);
        assert_eq!(run(0.0, 0.3, 0.1, 1.0), [0.0, 0.1, 0.2, 0.3], "0.1 * 3 is above 0.3 by rounding");
        // Divided by a limit: no part below the smallest of 0.05 s, in the last 0.1 s neither.
        let divided = run(0.0, 0.5, 0.4, 0.06);
        assert_eq!((divided.len(), divided.last()), (1 + 7 + 2, Some(&0.5)));
        assert_eq!(run(0.0, 0.45, 0.4, 1e-9).len(), 1 + 8 + 1);
    }

    #[test]
    fn a_run_is_divided_evenly() {
        assert_eq!((even_step(0.0, 1.0, 0.3), even_step(-1.0, 1.0, 0.5)), (0.25, 0.5));
        assert_eq!(even_step(0.0, 0.3, 0.1), 0.1, "rounding is no reason for another step");
    }
}
