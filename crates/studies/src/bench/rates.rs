//! Orders of convergence, and run times at equal error.

/// Observed order between two runs (spacing, error), from coarse to fine: ln(e1 / e2) / ln(h1 / h2). None where an
/// error is zero or not a number.
pub fn order_between(coarse: (f64, f64), fine: (f64, f64)) -> Option<f64> {
    least_squares_order(&[coarse, fine])
}

/// Slope of the straight line of least squares through (ln spacing, ln error); none with fewer than two usable points
/// or only one spacing.
pub fn least_squares_order(points: &[(f64, f64)]) -> Option<f64> {
    let logarithms: Vec<(f64, f64)> =
        points.iter().filter(|(h, e)| usable(*h) && usable(*e)).map(|(h, e)| (h.ln(), e.ln())).collect();
    let count = logarithms.len() as f64;
    let mean_h = logarithms.iter().map(|(h, _)| h).sum::<f64>() / count;
    let mean_e = logarithms.iter().map(|(_, e)| e).sum::<f64>() / count;
    let square: f64 = logarithms.iter().map(|(h, _)| (h - mean_h).powi(2)).sum();
    let product: f64 = logarithms.iter().map(|(h, e)| (h - mean_h) * (e - mean_e)).sum();
    (logarithms.len() >= 2 && square > 1e-12).then(|| product / square)
}

fn usable(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

/// The time \[s\] that a series of runs needs for an error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum TimeToError {
    /// Between two runs, interpolated.
    Reached(f64),
    /// The coarsest run is already as good: at most its time.
    AtMost(f64),
    /// No run is as good: more than the time of the longest one.
    NotReached {
        /// Time of the longest run, a lower bound.
        more_than: f64,
        /// Smallest error of all runs.
        nearest_error: f64,
        /// Its time.
        nearest_time: f64,
    },
}

/// The time at which the runs (time, error), from coarse to fine, first come down to `error`, linear in the logarithms
/// of both between runs. None without usable runs.
pub fn time_to_error(runs: &[(f64, f64)], error: f64) -> Option<TimeToError> {
    let runs: Vec<(f64, f64)> = runs.iter().copied().filter(|(t, e)| usable(*t) && usable(*e)).collect();
    let first = runs.first()?;
    if first.1 <= error {
        return Some(TimeToError::AtMost(first.0));
    }
    if let Some(pair) = runs.windows(2).find(|pair| pair[1].1 <= error) {
        let ((t0, e0), (t1, e1)) = (pair[0], pair[1]);
        let share = (e0 / error).ln() / (e0 / e1).ln();
        return Some(TimeToError::Reached(t0 * (t1 / t0).powf(share)));
    }
    let nearest = runs.iter().copied().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let more_than = runs.iter().map(|run| run.0).fold(0.0, f64::max);
    Some(TimeToError::NotReached { more_than, nearest_error: nearest.1, nearest_time: nearest.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_gives_its_exponent() {
        let runs: Vec<(f64, f64)> = [0.04, 0.02, 0.01].iter().map(|h: &f64| (*h, 3.0 * h.powf(1.7))).collect();
        assert!((least_squares_order(&runs).unwrap() - 1.7).abs() < 1e-12);
        assert!((order_between(runs[0], runs[1]).unwrap() - 1.7).abs() < 1e-12);
    }

    #[test]
    fn least_squares_weighs_all_runs() {
        // ln e over ln h at 0, 1, 2 times ln 2: 0, 1, 4 times ln 2; the line of least squares has the slope 2.
        let slope = least_squares_order(&[(1.0, 1.0), (2.0, 2.0), (4.0, 16.0)]).unwrap();
        assert!((slope - 2.0).abs() < 1e-12, "{slope}");
    }

    #[test]
    fn errors_without_a_logarithm_and_single_spacings_give_no_order() {
        assert_eq!(least_squares_order(&[(0.02, 0.0), (0.01, 1e-3)]), None);
        assert_eq!(least_squares_order(&[(0.02, f64::NAN), (0.01, 1e-3)]), None);
        assert_eq!(least_squares_order(&[(0.01, 2e-3), (0.01, 1e-3)]), None);
        assert_eq!(least_squares_order(&[]), None);
    }

    #[test]
    fn times_are_interpolated_in_logarithms() {
        // Error 0.1 at 1 s and 0.001 at 100 s lie on e = 0.1 / t: 0.01 is reached at 10 s.
        let runs = [(1.0, 0.1), (100.0, 0.001)];
        let Some(TimeToError::Reached(time)) = time_to_error(&runs, 0.01) else { panic!() };
        assert!((time - 10.0).abs() < 1e-12);
        assert_eq!(time_to_error(&runs, 0.2), Some(TimeToError::AtMost(1.0)));
        let beyond = TimeToError::NotReached { more_than: 100.0, nearest_error: 0.001, nearest_time: 100.0 };
        assert_eq!(time_to_error(&runs, 1e-4), Some(beyond));
    }

    #[test]
    fn a_series_that_gets_worse_is_bounded_by_its_longest_run() {
        let runs = [(1.0, 0.1), (8.0, 0.05), (64.0, 0.07)];
        let expected = TimeToError::NotReached { more_than: 64.0, nearest_error: 0.05, nearest_time: 8.0 };
        assert_eq!(time_to_error(&runs, 0.01), Some(expected));
        // The first way down counts: 0.06 is reached between 1 s and 8 s.
        let Some(TimeToError::Reached(time)) = time_to_error(&runs, 0.06) else { panic!() };
        assert!(time > 1.0 && time < 8.0);
        assert_eq!(time_to_error(&[], 0.01), None);
        assert_eq!(time_to_error(&[(f64::NAN, 0.1)], 0.01), None);
    }
}
