//! Statistical tests: p-values of samples under the hypothesis that they follow a given distribution.
//!
//! A p-value is uniform on [0, 1] if the hypothesis is true, and near 0 if it is false.

use sim_core::math;

/// Cumulative distribution function of the standard normal distribution.
pub fn normal_cdf(z: f64) -> f64 {
    0.5 * math::erfc(-z / std::f64::consts::SQRT_2)
}

/// Two-sided p-value: probability that the magnitude of a standard normal number is at least that of `z`.
pub fn two_sided(z: f64) -> f64 {
    math::erfc(z.abs() / std::f64::consts::SQRT_2)
}

/// Count, mean and central moments of a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moments {
    /// Number of values.
    pub count: f64,
    /// Mean.
    pub mean: f64,
    /// Variance of the sample (divided by n).
    pub variance: f64,
    /// Fourth central moment.
    pub fourth: f64,
}

impl Moments {
    /// Moments of `sample`; NaN if it is empty.
    pub fn of(sample: &[f64]) -> Self {
        let count = sample.len() as f64;
        let mean = sample.iter().sum::<f64>() / count;
        let central = |power: i32| sample.iter().map(|x| (x - mean).powi(power)).sum::<f64>() / count;
        Self { count, mean, variance: central(2), fourth: central(4) }
    }

    /// p-value of the hypothesis that the distribution has the mean `mean`, for a known variance `variance`.
    pub fn mean_is(&self, mean: f64, variance: f64) -> f64 {
        two_sided((self.mean - mean) / (variance / self.count).sqrt())
    }

    /// p-value of the hypothesis that the distribution has the variance `variance`: the variance of the sample variance
    /// is (m4 - v^2) / n.
    pub fn variance_is(&self, variance: f64) -> f64 {
        let standard_error = ((self.fourth - self.variance * self.variance) / self.count).sqrt();
        two_sided((self.variance - variance) / standard_error)
    }
}

/// Kolmogorov-Smirnov distance: the maximum difference between the empirical distribution of `sample`, sorted in place,
/// and `cdf`.
pub fn kolmogorov_distance(sample: &mut [f64], cdf: impl Fn(f64) -> f64) -> f64 {
    sample.sort_by(f64::total_cmp);
    let count = sample.len() as f64;
    let differences = sample.iter().enumerate().map(|(index, x)| {
        let (below, probability) = (index as f64 / count, cdf(*x));
        (probability - below).abs().max((below + 1.0 / count - probability).abs())
    });
    differences.fold(0.0, f64::max)
}

/// Kolmogorov-Smirnov test: p-value of the hypothesis that `sample` follows the continuous distribution `cdf`, by
/// Stephens' approximation.
pub fn kolmogorov(sample: &mut [f64], cdf: impl Fn(f64) -> f64) -> f64 {
    let distance = kolmogorov_distance(sample, cdf);
    let root = (sample.len() as f64).sqrt();
    let lambda = (root + 0.12 + 0.11 / root) * distance;
    if lambda < 0.2 {
        return 1.0;
    }
    let term = |j: i32| {
        let sign = if j % 2 == 1 { 2.0 } else { -2.0 };
        sign * math::exp(-2.0 * f64::from(j * j) * lambda * lambda)
    };
    (1..100).map(term).sum::<f64>().clamp(0.0, 1.0)
}

/// Pearson's chi-squared test in the approximation of Wilson and Hilferty: p-value of `counts` under the hypothesis
/// that their expected values are `expected`, which has the same sum. Adjacent classes are merged until each has an
/// expected count of at least 10.
///
/// # Panics
/// If fewer than two classes remain, or the numbers of counts and expectations differ.
pub fn chi_squared(counts: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(counts.len(), expected.len(), "a count for each expectation");
    let mut classes: Vec<(f64, f64)> = Vec::new();
    let mut merged = (0.0, 0.0);
    for (count, expected) in counts.iter().zip(expected) {
        merged = (merged.0 + count, merged.1 + expected);
        if merged.1 >= 10.0 {
            classes.push(std::mem::take(&mut merged));
        }
    }
    if let Some(last) = classes.last_mut() {
        *last = (last.0 + merged.0, last.1 + merged.1);
    }
    assert!(classes.len() > 1, "two classes at least");
    let squares = classes.iter().map(|(count, expected)| (count - expected).powi(2) / expected);
    let (statistic, freedom) = (squares.sum::<f64>(), classes.len() as f64 - 1.0);
    let variance = 2.0 / (9.0 * freedom);
    1.0 - normal_cdf(((statistic / freedom).cbrt() - (1.0 - variance)) / variance.sqrt())
}

/// Exact binomial test: p-value of `count` hits in `trials`, each with `probability`; twice the smaller tail.
pub fn binomial(count: u64, trials: u64, probability: f64) -> f64 {
    if probability <= 0.0 || probability >= 1.0 {
        let only_count = if probability <= 0.0 { 0 } else { trials };
        return f64::from(u8::from(count == only_count));
    }
    // Sums the probabilities outwards from the mode, relative to the mode's probability, until they underflow to 0.
    let mode = ((trials + 1) as f64 * probability).floor().min(trials as f64) as u64;
    let odds = probability / (1.0 - probability);
    let (mut total, mut lower_tail, mut upper_tail) = (0.0, 0.0, 0.0);
    let mut add = |k: u64, weight: f64| {
        total += weight;
        lower_tail += if k <= count { weight } else { 0.0 };
        upper_tail += if k >= count { weight } else { 0.0 };
    };
    let (mut k, mut weight) = (mode, 1.0);
    while weight > 0.0 {
        add(k, weight);
        if k == trials {
            break;
        }
        weight *= (trials - k) as f64 / (k + 1) as f64 * odds;
        k += 1;
    }
    (k, weight) = (mode, 1.0);
    while k > 0 && weight > 0.0 {
        weight *= k as f64 / ((trials - k + 1) as f64 * odds);
        k -= 1;
        add(k, weight);
    }
    let tail = if lower_tail < upper_tail { lower_tail } else { upper_tail };
    (2.0 * tail / total).min(1.0)
}

/// p-value of the hypothesis that two paired samples are uncorrelated.
///
/// # Panics
/// If their lengths differ.
pub fn uncorrelated(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len(), "pairs");
    let (moments_a, moments_b) = (Moments::of(a), Moments::of(b));
    let products = a.iter().zip(b).map(|(a, b)| (a - moments_a.mean) * (b - moments_b.mean));
    let correlation = products.sum::<f64>() / (moments_a.count * (moments_a.variance * moments_b.variance).sqrt());
    two_sided(correlation * moments_a.count.sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_cdf_matches_published_values() {
        for (z, probability) in [(0.0, 0.5), (1.0, 0.841_344_746_068_542_9), (-3.0, 0.001_349_898_031_630_094_6)] {
            assert!((normal_cdf(z) - probability).abs() < 1e-15, "{z}");
        }
        assert!((two_sided(-1.959_963_984_540_054) - 0.05).abs() < 1e-15);
    }

    #[test]
    fn binomial_tails_are_exact() {
        // 10 throws of a fair coin: at most 2 heads with probability (1 + 10 + 45) / 1024.
        assert!((binomial(2, 10, 0.5) - 2.0 * 56.0 / 1024.0).abs() < 1e-15);
        assert!((binomial(8, 10, 0.5) - 2.0 * 56.0 / 1024.0).abs() < 1e-15);
        assert_eq!(binomial(5, 10, 0.5), 1.0);
        assert!((binomial(0, 3, 0.25) - 2.0 * 27.0 / 64.0).abs() < 1e-15);
        assert_eq!([binomial(0, 9, 0.0), binomial(1, 9, 0.0), binomial(9, 9, 1.0)], [1.0, 0.0, 1.0]);
        // Far in the tail, compared with the normal approximation.
        let far = binomial(500_000 + 2_500, 1_000_000, 0.5);
        assert!((far / two_sided(5.0) - 1.0).abs() < 0.02, "{far}");
    }

    #[test]
    fn kolmogorov_matches_published_values() {
        // The midpoints of n equal intervals have the minimum distance 1 / 2n; shifted by D, their distance is D + 1 /
        // 2n.
        let sample =
            |count: usize, shift: f64| (0..count).map(|k| (k as f64 + 0.5) / count as f64 + shift).collect::<Vec<_>>();
        assert_eq!(kolmogorov(&mut sample(1000, 0.0), |x| x), 1.0);
        // The 5 % point is 1.358 / sqrt(n) for large n.
        let count = 10_000;
        let shift = 1.358 / 100.0 - 0.5 / 10_000.0;
        assert!((kolmogorov(&mut sample(count, shift), |x| x) - 0.05).abs() < 1e-3);
    }

    #[test]
    fn chi_squared_matches_published_values() {
        // The 5 % points for 1, 9 and 99 degrees of freedom.
        for (freedom, point) in [(1_usize, 3.841_f64), (9, 16.919), (99, 123.225)] {
            let classes = freedom + 1;
            let mut counts = vec![1000.0; classes];
            let deviation = (point * 1000.0 / 2.0).sqrt();
            (counts[0], counts[1]) = (1000.0 + deviation, 1000.0 - deviation);
            let p = chi_squared(&counts, &vec![1000.0; classes]);
            assert!((p - 0.05).abs() < 0.004, "{freedom}: {p}");
        }
    }

    #[test]
    fn moments_match_their_definition() {
        let moments = Moments::of(&[1.0, 2.0, 3.0, 6.0]);
        assert_eq!((moments.mean, moments.variance, moments.fourth), (3.0, 3.5, (16.0 + 1.0 + 81.0) / 4.0));
    }

    #[test]
    fn sample_is_correlated_with_itself() {
        let a: Vec<f64> = (0..100).map(f64::from).collect();
        assert!(uncorrelated(&a, &a) < 1e-20);
    }
}
