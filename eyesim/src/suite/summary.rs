//! Pass rates: the cases of a variant differ only in their seeds, and a fraction of them must pass.

use serde::Serialize;

use super::row::{Row, RowOutcome};

/// Quantile of the normal distribution for intervals of 95 %.
const Z: f64 = 1.959_963_984_540_054;

/// A success rate with its confidence interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Rate {
    /// Successes.
    pub passed: usize,
    /// Attempts.
    pub count: usize,
    /// Lower end of the interval, 0 to 1.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Rate {
    /// The rate of `passed` out of `count` attempts, with its Wilson score interval of 95 %.
    ///
    /// Source: E. B. Wilson, Probable inference, the law of succession, and statistical inference, JASA 22 (1927).
    pub fn of(passed: usize, count: usize) -> Self {
        if count == 0 {
            return Self { passed, count, low: 0.0, high: 1.0 };
        }
        let (n, p) = (count as f64, passed as f64 / count as f64);
        let middle = p + Z * Z / (2.0 * n);
        let half_width = Z * (p * (1.0 - p) / n + Z * Z / (4.0 * n * n)).sqrt();
        let scale = 1.0 + Z * Z / n;
        let [low, high] = [middle - half_width, middle + half_width].map(|end| (end / scale).clamp(0.0, 1.0));
        // Rounding must not exclude rates of 0 and 1.
        Self { passed, count, low: if passed == 0 { 0.0 } else { low }, high: if passed == count { 1.0 } else { high } }
    }

    /// The rate, 0 to 1; 0 without attempts.
    pub fn share(&self) -> f64 {
        if self.count == 0 { 0.0 } else { self.passed as f64 / self.count as f64 }
    }
}

/// A variant: cases that differ only in their seeds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Variant {
    /// Its name.
    pub name: String,
    /// Pass rate of its cases.
    pub rate: Rate,
    /// Name of each check, and the rate of the cases that meet it.
    pub checks: Vec<(String, Rate)>,
    /// Mean of the points of its cases.
    pub points: f64,
    /// Points if all checks pass.
    pub max_points: f64,
    /// True if at least the required fraction of its cases passes.
    pub passed: bool,
}

/// The variants of `rows`, in their order. A variant passes if at least the share `pass_rate` of its cases passes.
pub fn variants(rows: &[&Row], pass_rate: f64) -> Vec<Variant> {
    let mut names: Vec<&str> = Vec::new();
    let mut indices = std::collections::BTreeMap::new();
    let mut groups: Vec<Vec<&Row>> = Vec::new();
    for row in rows {
        let index = *indices.entry(row.variant.as_str()).or_insert_with(|| {
            names.push(&row.variant);
            groups.push(Vec::new());
            names.len() - 1
        });
        groups[index].push(row);
    }
    names.into_iter().zip(groups).map(|(name, rows)| variant(name, &rows, pass_rate)).collect()
}

fn variant(name: &str, rows: &[&Row], pass_rate: f64) -> Variant {
    let count = rows.len();
    let rate = Rate::of(rows.iter().filter(|row| row.outcome == RowOutcome::Passed).count(), count);
    let longest = rows.iter().map(|row| &row.checks).max_by_key(|checks| checks.len());
    let check = |(index, name): (usize, &String)| {
        let passed = rows.iter().filter(|row| row.checks.get(index).is_some_and(|check| check.passed)).count();
        (name.clone(), Rate::of(passed, count))
    };
    let names = longest.into_iter().flatten().map(|check| &check.name);
    let mean = |points: fn(&Row) -> f64| rows.iter().map(|row| points(row)).sum::<f64>() / count.max(1) as f64;
    let max_points = rows.iter().map(|row| row.max_points).fold(0.0, f64::max);
    Variant {
        name: name.to_owned(),
        rate,
        checks: names.enumerate().map(check).collect(),
        points: mean(|row| row.points),
        max_points,
        // A share such as 0.7 of 10 cases means 7 cases, despite rounding errors.
        passed: rate.passed as f64 >= pass_rate * count as f64 - 1e-9,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_match_r() {
        // Values from R's prop.test(x, n, correct = FALSE).
        let assert_near = |rate: Rate, low: f64, high: f64| {
            assert!((rate.low - low).abs() < 5e-5 && (rate.high - high).abs() < 5e-5, "{rate:?}");
        };
        assert_near(Rate::of(9, 10), 0.5958, 0.9821);
        assert_near(Rate::of(0, 10), 0.0, 0.2775);
        assert_near(Rate::of(10, 10), 0.7225, 1.0);
        assert_near(Rate::of(50, 100), 0.4038, 0.5962);
        assert_eq!(Rate::of(0, 0).share(), 0.0);
    }
}
