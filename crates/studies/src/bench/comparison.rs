//! All runs of one scene, and what they say together.

use super::plan::Plan;
use super::rates::{TimeToError, least_squares_order, order_between, time_to_error};
use super::trial::Trial;
use scene::Scheme;

/// The runs of one scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// What was planned.
    pub plan: Plan,
    /// The scene's title.
    pub title: String,
    /// End of the run in the scene file \[s\].
    pub scene_end: f64,
    /// Runs in the order in which they were made: from coarse to fine, at each spacing one scheme after the other.
    pub trials: Vec<Trial>,
}

impl Comparison {
    /// The schemes in the order of their first runs.
    pub fn schemes(&self) -> Vec<Scheme> {
        let mut schemes = Vec::new();
        for trial in &self.trials {
            if !schemes.contains(&trial.scheme) {
                schemes.push(trial.scheme);
            }
        }
        schemes
    }

    /// The runs of a scheme, from coarse to fine.
    pub fn runs(&self, scheme: Scheme) -> Vec<&Trial> {
        self.trials.iter().filter(|trial| trial.scheme == scheme).collect()
    }

    /// The spacings \[m\], from coarse to fine.
    pub fn spacings(&self) -> Vec<f64> {
        let mut spacings: Vec<f64> = self.trials.iter().map(|trial| trial.spacing).collect();
        spacings.dedup();
        spacings
    }

    /// Pairs (spacing, error) of a figure of the plan.
    pub fn errors_by_spacing(&self, scheme: Scheme, figure: usize) -> Vec<(f64, f64)> {
        let runs = self.runs(scheme).into_iter();
        runs.filter_map(|trial| Some((trial.spacing, trial.errors[figure]?))).collect()
    }

    /// Pairs (time \[s\], error) of a figure of the plan.
    pub fn errors_by_time(&self, scheme: Scheme, figure: usize) -> Vec<(f64, f64)> {
        let runs = self.runs(scheme).into_iter();
        runs.filter_map(|trial| Some((trial.seconds(), trial.errors[figure]?))).collect()
    }

    /// Order of convergence of a figure by least squares over all runs of a scheme.
    pub fn order(&self, scheme: Scheme, figure: usize) -> Option<f64> {
        least_squares_order(&self.errors_by_spacing(scheme, figure))
    }

    /// Order of a figure from the next coarser run of the same scheme to this one.
    pub fn order_since(&self, trial: &Trial, figure: usize) -> Option<f64> {
        let fine = (trial.spacing, trial.errors[figure]?);
        let coarser = self.errors_by_spacing(trial.scheme, figure).into_iter().rev();
        order_between(coarser.into_iter().find(|(spacing, _)| *spacing > trial.spacing)?, fine)
    }

    /// How many times longer the paper's scheme takes to the error of this run of the scheme `voronoi`.
    pub fn factor(&self, voronoi: &Trial, figure: usize) -> Option<Factor> {
        let error = voronoi.errors[figure].filter(|_| voronoi.scheme == Scheme::Voronoi)?;
        let seconds = voronoi.seconds();
        let factor = match time_to_error(&self.errors_by_time(Scheme::Mps, figure), error)? {
            TimeToError::Reached(time) => Factor::Equal(time / seconds),
            TimeToError::AtMost(time) => Factor::AtMost(time / seconds),
            TimeToError::NotReached { more_than, nearest_error, nearest_time } => {
                Factor::MoreThan { factor: more_than / seconds, nearest: Some((nearest_error, nearest_time)) }
            }
        };
        Some(factor)
    }

    /// How many times longer the paper's scheme takes to the smallest of its errors than the scheme `voronoi`.
    pub fn factor_at_best_of_mps(&self, figure: usize) -> Option<Factor> {
        let mps = self.errors_by_time(Scheme::Mps, figure);
        let (seconds, error) = mps.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
        let factor = match time_to_error(&self.errors_by_time(Scheme::Voronoi, figure), error)? {
            TimeToError::Reached(time) => Factor::Equal(seconds / time),
            TimeToError::AtMost(time) => Factor::MoreThan { factor: seconds / time, nearest: None },
            TimeToError::NotReached { more_than, .. } => Factor::AtMost(seconds / more_than),
        };
        Some(factor)
    }
}

/// Time of the paper's scheme over time of `voronoi` at equal error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Factor {
    /// As interpolated.
    Equal(f64),
    /// An upper bound: the paper's coarsest run is already as good, or no run of the scheme `voronoi` is.
    AtMost(f64),
    /// A lower bound: no run of the paper's scheme is as good, or the coarsest of `voronoi` already is.
    MoreThan {
        /// The bound, from the paper's longest run.
        factor: f64,
        /// The paper's smallest error and the time of that run \[s\], where the error was not reached.
        nearest: Option<(f64, f64)>,
    },
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::bench::plan::PLANS;
    use crate::bench::trial::Work;

    /// Made-up runs with errors h^2 and 10 h and times 1 / h^3 and 2 / h^3.
    pub(in crate::bench) fn example() -> Comparison {
        let plan = Plan { figures: &["pressure"], ..PLANS[0] };
        let run = |spacing: f64, scheme: Scheme| {
            let fast = scheme == Scheme::Voronoi;
            let (error, time) = if fast { (spacing.powi(2), 1.0) } else { (10.0 * spacing, 2.0) };
            Trial {
                scheme,
                spacing,
                errors: vec![Some(error)],
                units: vec!["m".to_string()],
                problem: String::new(),
                wall: 3.0 * time * spacing.powi(-3),
                processor: Some(time * spacing.powi(-3)),
                threads: 1,
                work: Work { steps: 10.0, particles: 100.0, particle_steps: 1000.0, ..Work::default() },
            }
        };
        let spacings = [0.4, 0.2, 0.1];
        let both = |spacing| [run(spacing, Scheme::Voronoi), run(spacing, Scheme::Mps)];
        let trials = spacings.into_iter().flat_map(both).collect();
        Comparison { plan, title: "tank".to_string(), scene_end: 10.0, trials }
    }

    #[test]
    fn orders_and_lists() {
        let comparison = example();
        assert_eq!(comparison.schemes(), [Scheme::Voronoi, Scheme::Mps]);
        assert_eq!(comparison.spacings(), [0.4, 0.2, 0.1]);
        assert!((comparison.order(Scheme::Voronoi, 0).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(comparison.order_since(&comparison.trials[0], 0), None);
        assert!((comparison.order_since(&comparison.trials[5], 0).unwrap() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_failed_run_does_not_break_the_order() {
        let mut comparison = example();
        comparison.trials[2].errors[0] = None;
        comparison.trials[2].problem = "failed at 0.1 s".to_string();
        assert!((comparison.order(Scheme::Voronoi, 0).unwrap() - 2.0).abs() < 1e-12);
        // From 0.4 straight to 0.1.
        assert!((comparison.order_since(&comparison.trials[4], 0).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(comparison.factor(&comparison.trials[2], 0), None);
    }

    #[test]
    fn the_factor_is_the_time_at_equal_error_or_a_bound() {
        let mut comparison = example();
        // The paper's best error is 1, the scheme `voronoi`'s worst 0.16: its longest run took 2000 s against 15.625 s.
        let Some(Factor::MoreThan { factor, nearest: Some((nearest_error, nearest_time)) }) =
            comparison.factor(&comparison.trials[0], 0)
        else {
            panic!()
        };
        // The other way round the scheme `voronoi`'s coarsest run is better than the paper's best: the same bound.
        let best = comparison.factor_at_best_of_mps(0);
        assert!(matches!(best, Some(Factor::MoreThan { factor: same, nearest: None }) if (same - factor).abs() < 1e-6));
        let time = 0.4_f64.powi(-3);
        assert!((factor - 2000.0 / time).abs() < 1e-6 * factor && (nearest_error - 1.0).abs() < 1e-12);
        assert!((nearest_time - 2000.0).abs() < 1e-6);
        // With errors 0.5 h, error 0.16 belongs to h = 0.32 and a time of 2 / 0.32^3.
        for trial in comparison.trials.iter_mut().filter(|trial| trial.scheme == Scheme::Mps) {
            trial.errors[0] = Some(0.5 * trial.spacing);
        }
        let Some(Factor::Equal(factor)) = comparison.factor(&comparison.trials[0], 0) else { panic!() };
        assert!((factor - 2.0 * 0.32_f64.powi(-3) / time).abs() < 1e-9, "{factor}");
        // The paper's best error 0.05 after 2000 s belongs to h = sqrt(0.05) and a time of 0.05^-1.5.
        let Some(Factor::Equal(factor)) = comparison.factor_at_best_of_mps(0) else { panic!() };
        assert!((factor - 2000.0 * 0.05_f64.powf(1.5)).abs() < 1e-9, "{factor}");
    }
}
