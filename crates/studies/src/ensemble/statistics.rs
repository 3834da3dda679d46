//! What a sample of equal runs says of a figure, and whether two samples differ.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// Statistics of a sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Number of values.
    pub count: usize,
    /// Mean.
    pub mean: f64,
    /// Median.
    pub median: f64,
    /// Smallest value.
    pub least: f64,
    /// Largest value.
    pub most: f64,
    /// Standard deviation of single values, from one value less than there are; none of fewer than two.
    pub deviation: Option<f64>,
}

/// Share of cases that a band takes in.
const SHARE: f64 = 0.95;

impl Sample {
    /// Of these values; none of no values.
    pub fn of(values: &[f64]) -> Option<Self> {
        let count = values.len();
        let mut sorted = values.to_vec();
        sorted.sort_by(f64::total_cmp);
        let (&least, &most) = (sorted.first()?, sorted.last()?);
        let mean = values.iter().sum::<f64>() / count as f64;
        let median = 0.5 * (sorted[(count - 1) / 2] + sorted[count / 2]);
        let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
        let deviation = (count > 1).then(|| (square / (count - 1) as f64).sqrt());
        Some(Self { count, mean, median, least, most, deviation })
    }

    /// Standard deviation over the size of the mean: how well a single run repeats.
    pub fn repeatability(&self) -> Option<f64> {
        self.deviation.filter(|_| self.mean != 0.0).map(|deviation| deviation / self.mean.abs())
    }

    /// Half the width of the interval about the mean in which the true one lies in 95 % of cases, for values that are
    /// distributed normally (Student 1908).
    pub fn uncertainty(&self) -> Option<f64> {
        Some(self.factor()? * self.deviation? / (self.count as f64).sqrt())
    }

    /// The interval in which the next run lies in 95 % of cases, for values that are distributed normally.
    pub fn band(&self) -> Option<[f64; 2]> {
        let half = self.factor()? * self.deviation? * (1.0 + 1.0 / self.count as f64).sqrt();
        Some([self.mean - half, self.mean + half])
    }

    fn factor(&self) -> Option<f64> {
        quantile(self.count.checked_sub(1)? as f64)
    }
}

/// Two-sided quantile of Student's distribution.
fn quantile(freedoms: f64) -> Option<f64> {
    Some(StudentsT::new(0.0, 1.0, freedoms).ok()?.inverse_cdf(0.5 + 0.5 * SHARE))
}

/// Probability of two means at least as far apart if both samples were of one distribution, by the t-test for unequal
/// variances (Welch 1947); none of fewer than two values. 1 where all values are the same number.
pub fn welch(one: &Sample, other: &Sample) -> Option<f64> {
    let [a, b] = [one, other].map(|sample| Some(sample.deviation?.powi(2) / sample.count as f64));
    let (a, b) = (a?, b?);
    if a + b == 0.0 {
        return Some(if one.mean == other.mean { 1.0 } else { 0.0 });
    }
    let freedoms = (a + b).powi(2) / (a.powi(2) / (one.count - 1) as f64 + b.powi(2) / (other.count - 1) as f64);
    let distance = (one.mean - other.mean).abs() / (a + b).sqrt();
    Some(2.0 * StudentsT::new(0.0, 1.0, freedoms).ok()?.sf(distance))
}

/// Probabilities of several tests made at once, each raised so that none below a level means that one of all is false with
/// that probability (Holm 1979).
pub fn holm(probabilities: &[f64]) -> Vec<f64> {
    let count = probabilities.len();
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&i, &j| probabilities[i].total_cmp(&probabilities[j]));
    let (mut adjusted, mut least) = (vec![0.0; count], 0.0_f64);
    for (rank, &index) in order.iter().enumerate() {
        least = least.max((probabilities[index] * (count - rank) as f64).min(1.0));
        adjusted[index] = least;
    }
    adjusted
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Student's sleep data (1908), the additional hours of two drugs: means 0.75 and 2.33, t = 1.8608, df = 17.776,
    /// p = 0.07939 by Welch's test, as textbooks have it.
    #[test]
    fn welch_finds_what_textbooks_have() {
        let one = Sample::of(&[0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0]).unwrap();
        let two = Sample::of(&[1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4]).unwrap();
        assert!((one.mean - 0.75).abs() < 1e-12 && (two.median - 1.75).abs() < 1e-12);
        let probability = welch(&one, &two).unwrap();
        assert!((probability - 0.07939).abs() < 5e-6, "{probability}");
        assert_eq!(welch(&one, &one), Some(1.0));
    }

    #[test]
    fn bands_are_those_of_students_distribution() {
        let sample = Sample::of(&[9.0, 10.0, 11.0]).unwrap();
        assert_eq!((sample.deviation, sample.repeatability()), (Some(1.0), Some(0.1)));
        // t of 2 degrees of freedom at 97.5 %: 4.302653.
        assert!((sample.uncertainty().unwrap() - 4.302_653 / 3.0_f64.sqrt()).abs() < 1e-6);
        assert!((sample.band().unwrap()[1] - 10.0 - 4.302_653 * (4.0_f64 / 3.0).sqrt()).abs() < 1e-6);
        let single = Sample::of(&[3.0]).unwrap();
        assert_eq!((single.uncertainty(), single.deviation, single.median), (None, None, 3.0));
        assert_eq!(Sample::of(&[]), None);
    }

    #[test]
    fn many_tests_are_judged_together() {
        let adjusted = holm(&[0.01, 0.04, 0.03, 0.005]);
        // 4 * 0.005, 3 * 0.01, 2 * 0.03, and not below the one before.
        assert_eq!(adjusted.iter().map(|p| (p * 1e6).round() / 1e6).collect::<Vec<_>>(), [0.03, 0.06, 0.06, 0.02]);
    }
}
