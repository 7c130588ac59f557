//! `reflectance`: distance recovered from the signal of a reflectance sensor, by the root as printed in the paper and
//! by the numerically stable root.
//!
//! Both invert s = (max - d) / d^2 for a surface at zero incidence (France et al. 1999, Eq. 1 and section 5). The
//! printed root subtracts two numbers that become equal as the signal vanishes.

use sim_core::sensor::recovered_distance;

use super::{Effort, Outcome, Row, Study, nanoseconds};
use crate::figure::{Figure, Mark, Scale, Series};

pub const STUDY: Study = Study {
    name: "reflectance",
    title: "Distance recovered from the signal of a reflectance sensor, as the signal vanishes",
    run,
};

/// Maximum distance of the paper's sensor, m.
const MAX: f64 = 1.0;
/// Exponents of ten of the signals in 1/m; each gives one setting.
const EXPONENTS: [i32; 9] = [3, 1, -1, -3, -5, -7, -9, -12, -16];
/// Number of signals at each setting, from the setting's signal to ten times that signal.
const SIGNALS: usize = 1_000;

/// Distance (m) from a signal (1/m) and a maximum distance (m).
type Root = fn(f64, f64) -> f64;

fn run(effort: Effort) -> Outcome {
    let methods: [(&str, Root); 2] = [("stable root", recovered_distance), ("printed root", printed_root)];
    let mut rows = Vec::new();
    let mut series = Vec::new();
    for (method, root) in methods {
        let mut points = Vec::new();
        for exponent in EXPONENTS {
            let min_signal = power_of_ten(exponent);
            let signals: Vec<f64> =
                (0..SIGNALS).map(|i| min_signal * (1.0 + 9.0 * i as f64 / SIGNALS as f64)).collect();
            let error = signals.iter().map(|s| (root(*s, MAX) - distance_of(*s)).abs()).fold(0.0, f64::max);
            points.push((min_signal, error));
            let recover_all = || signals.iter().map(|signal| root(*signal, MAX)).sum::<f64>();
            rows.push(Row {
                study: STUDY.name,
                method: method.to_owned(),
                setting: format!("signal from 1e{exponent}/m on"),
                error,
                unit: "m",
                time_ns: nanoseconds(effort.of(1_000), SIGNALS, recover_all),
                per: "reading",
            });
        }
        series.push(Series { name: method.to_owned(), mark: Mark::LineAndDots, points });
    }
    let figure = Figure {
        name: "reflectance-signal".to_owned(),
        title: "Maximum error of the recovered distance".to_owned(),
        x_label: "signal, 1/m".to_owned(),
        y_label: "error, m".to_owned(),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        series,
    };
    Outcome { rows, figures: vec![figure] }
}

/// 10 to the power of `exponent`.
fn power_of_ten(exponent: i32) -> f64 {
    let power = (0..exponent.abs()).fold(1.0, |power, _| power * 10.0);
    if exponent < 0 { 1.0 / power } else { power }
}

/// Reference distance d for a signal s: Newton's method for u = max - d with the equation u = s (max - u)^2, which
/// keeps digits that an equation for d would lose.
fn distance_of(signal: f64) -> f64 {
    let mut u = 0.0;
    for _ in 0..100 {
        let distance = MAX - u;
        u -= (u - signal * distance * distance) / (1.0 + 2.0 * signal * distance);
    }
    MAX - u
}

/// Positive root as printed in the paper; NaN for the signal 0.
fn printed_root(signal: f64, max: f64) -> f64 {
    ((1.0 + 4.0 * signal * max).sqrt() - 1.0) / (2.0 * signal)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn printed_root_loses_digits_and_stable_root_does_not() {
        let rows = run(Effort::Quick).rows;
        let errors = |method: &str| -> Vec<f64> {
            rows.iter().filter(|row| row.method == method).map(|row| row.error).collect()
        };
        assert!(errors("stable root").iter().all(|error| *error <= 3e-16), "{:?}", errors("stable root"));
        let printed = errors("printed root");
        assert!(printed[0] < 1e-14 && printed[4] > 1e-13 && printed[8] > 0.01, "{printed:?}");
    }
}
