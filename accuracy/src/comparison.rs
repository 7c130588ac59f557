//! Fair comparisons of methods: the same parameter search for each method, held-out cases, and intervals of paired
//! differences.
//!
//! [`tune`] searches the parameters of one method on training cases, with the same budget for all methods. It also
//! evaluates its result with each parameter one step lower and one step higher, so no optimum is at the edge of a
//! range, except where larger values of a parameter have no meaning. [`Difference`] compares two methods on cases that
//! no search has used. `docs/accuracy.md` describes the protocol.

use std::collections::HashMap;

use rand_chacha::ChaCha8Rng;
use rand_core::{Rng as _, SeedableRng as _};

/// Free parameter of a method; its values are `start` times powers of `ratio`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Name, with its unit.
    pub name: &'static str,
    /// Value from which the search begins.
    pub start: f64,
    /// Factor of one step, above 1.
    pub ratio: f64,
    /// Maximum meaningful value (1 for a fraction), at which an optimum may lie; infinite without a limit.
    pub most: f64,
    /// A step is an improvement if it lowers the mean error by more than this fraction; a coarse step counts as two
    /// steps. The value is the same for all methods with this parameter, and larger for a parameter whose steps
    /// multiply the computing time.
    pub gain: f64,
}

impl Parameter {
    /// The value after `step` steps from the start; `None` above the maximum.
    fn value(&self, step: i32) -> Option<f64> {
        let value = self.start * self.ratio.powi(step);
        (value <= self.most).then_some(value)
    }
}

/// Rules of a search, the same for all methods of a comparison.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// Number of training cases.
    pub cases: usize,
    /// Number of initial cases on which coarse steps are tried; fine steps are tried on all cases.
    pub few: usize,
    /// Maximum number of evaluations; one evaluation is one case with one setting.
    pub budget: usize,
    /// Number of cases after which a setting is rejected if it is worse by two standard errors.
    pub first: usize,
}

/// Result of a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Tuned {
    /// Value of each parameter.
    pub setting: Vec<f64>,
    /// Error of each training case.
    pub errors: Vec<f64>,
    /// Number of evaluations.
    pub evaluations: usize,
    /// Number of settings that were tried.
    pub settings: usize,
}

/// A search without a result.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TuneError {
    /// The budget was used up before both neighbours of the best setting had been tried along each parameter.
    #[error("{budget} evaluations did not enclose the optimum: at {at:?} the error may still fall")]
    NotEnclosed {
        /// The budget.
        budget: usize,
        /// The best setting found.
        at: Vec<f64>,
    },
    /// An error of a case is not a number.
    #[error("the error of case {case} at {at:?} is not finite")]
    NotFinite {
        /// Number of the case.
        case: usize,
        /// The setting.
        at: Vec<f64>,
    },
}

/// Searches for the setting of a method with the minimum mean error over the training cases.
///
/// A compass search moves each parameter two steps up and down on a few cases, then one step on all cases, as long as
/// this lowers the error; it ends when no single step of any parameter lowers the error. The search begins with the
/// last parameter, which should be the resolution: the optimum of the other parameters depends on it. `error` returns
/// the error of a setting in a case.
///
/// # Errors
/// [`TuneError`].
///
/// # Panics
/// If there are no cases, `few` exceeds `cases`, or the start of a parameter exceeds its maximum.
pub fn tune(
    parameters: &[Parameter],
    search: Search,
    error: impl FnMut(&[f64], usize) -> f64,
) -> Result<Tuned, TuneError> {
    assert!((1..=search.cases).contains(&search.few), "training cases, and a few of them");
    let mut trial = Trial { parameters, search, error, known_errors: HashMap::new(), evaluations: 0 };
    let mut best = vec![0; parameters.len()];
    for (stride, cases) in [(2, search.few), (1, search.cases)] {
        for case in 0..cases {
            trial.evaluate(&best, &best, case)?;
        }
        trial.descend(&mut best, stride, cases)?;
    }
    let errors = trial.known_errors[&best].clone();
    Ok(Tuned {
        setting: trial.setting(&best),
        errors,
        evaluations: trial.evaluations,
        settings: trial.known_errors.len(),
    })
}

/// Errors of the settings tried so far. A setting is a number of steps for each parameter.
struct Trial<'a, E> {
    parameters: &'a [Parameter],
    search: Search,
    error: E,
    /// Known errors of each setting, for its first cases.
    known_errors: HashMap<Vec<i32>, Vec<f64>>,
    evaluations: usize,
}

impl<E: FnMut(&[f64], usize) -> f64> Trial<'_, E> {
    fn setting(&self, steps: &[i32]) -> Vec<f64> {
        let value = |(parameter, step): (&Parameter, &i32)| parameter.value(*step).expect("a value with a meaning");
        self.parameters.iter().zip(steps).map(value).collect()
    }

    /// Evaluates the next case of a setting, unless its error is known. An error names the setting `best`.
    fn evaluate(&mut self, steps: &[i32], best: &[i32], case: usize) -> Result<(), TuneError> {
        if self.known_errors.get(steps).is_some_and(|errors| errors.len() > case) {
            return Ok(());
        }
        if self.evaluations == self.search.budget {
            return Err(TuneError::NotEnclosed { budget: self.search.budget, at: self.setting(best) });
        }
        let setting = self.setting(steps);
        let error = (self.error)(&setting, case);
        if !error.is_finite() {
            return Err(TuneError::NotFinite { case, at: setting });
        }
        self.evaluations += 1;
        self.known_errors.entry(steps.to_vec()).or_default().push(error);
        Ok(())
    }

    /// Moves `best` by `stride` steps of one parameter after the other, as long as this is an improvement on the first
    /// `cases` cases.
    fn descend(&mut self, best: &mut Vec<i32>, stride: i32, cases: usize) -> Result<(), TuneError> {
        let moves: Vec<(usize, i32)> =
            (0..self.parameters.len()).rev().flat_map(|index| [(index, stride), (index, -stride)]).collect();
        let (mut move_index, mut failures) = (0, 0);
        while failures < moves.len() {
            let (index, step) = moves[move_index];
            let mut steps = best.clone();
            steps[index] += step;
            if self.parameters[index].value(steps[index]).is_some()
                && self.is_better(&steps, best, (1.0 - self.parameters[index].gain).powi(stride), cases)?
            {
                *best = steps;
                failures = 0;
            } else {
                move_index = (move_index + 1) % moves.len();
                failures += 1;
            }
        }
        Ok(())
    }

    /// Returns true if the mean error of a setting is less than `factor` times that of the best setting. The comparison
    /// goes case by case and stops early if the setting is clearly worse.
    fn is_better(&mut self, steps: &[i32], best: &[i32], factor: f64, cases: usize) -> Result<bool, TuneError> {
        let mut excesses = Vec::with_capacity(cases);
        for case in 0..cases {
            self.evaluate(steps, best, case)?;
            let target = factor * self.known_errors[best][case];
            excesses.push(self.known_errors[steps][case] - target);
            let (mean, error) = mean_and_standard_error(&excesses);
            if excesses.len() >= self.search.first && mean > 2.0 * error {
                return Ok(false);
            }
        }
        Ok(excesses.iter().sum::<f64>() < 0.0)
    }
}

/// Mean and its standard error, infinite for a single value.
fn mean_and_standard_error(sample: &[f64]) -> (f64, f64) {
    let count = sample.len() as f64;
    let mean = sample.iter().sum::<f64>() / count;
    let squares = sample.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    (mean, if count > 1.0 { (squares / (count - 1.0) / count).sqrt() } else { f64::INFINITY })
}

/// Minimum number of values for a bootstrap interval; with fewer values it is unreliable.
const MIN_VALUES: usize = 10;
/// Number of resamples of the bootstrap.
const RESAMPLES: usize = 10_000;
/// Fraction of the resamples below the interval, and of those above it.
const TAIL: f64 = 0.025;

/// Mean of a sample with a lower and an upper bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// The mean.
    pub mean: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Kind of the ends.
    pub kind: Ends,
}

/// Kind of an interval's ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ends {
    /// Bootstrap interval of the mean at 95 %.
    Bootstrap,
    /// Minimum and maximum value, if there are too few values for a bootstrap interval.
    Range,
}

impl Interval {
    /// Interval of the mean of independent values: the 95 % percentile bootstrap (Efron 1979; 10,000 resamples with a
    /// fixed seed), or the range of fewer than ten values. Values of one cluster (room, robot) must be passed as one
    /// value, their mean.
    ///
    /// # Panics
    /// Without values.
    pub fn of(values: &[f64]) -> Self {
        assert!(!values.is_empty(), "values");
        let count = values.len();
        let mean = values.iter().sum::<f64>() / count as f64;
        if count < MIN_VALUES {
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            return Self { mean, low, high, kind: Ends::Range };
        }
        let mut random = ChaCha8Rng::seed_from_u64(0);
        let mut draw = || values[(random.next_u64() % count as u64) as usize];
        let mut means: Vec<f64> =
            (0..RESAMPLES).map(|_| (0..count).map(|_| draw()).sum::<f64>() / count as f64).collect();
        means.sort_by(f64::total_cmp);
        let tail = (TAIL * RESAMPLES as f64) as usize;
        Self { mean, low: means[tail], high: means[RESAMPLES - 1 - tail], kind: Ends::Bootstrap }
    }
}

/// Comparison of two methods on the same cases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Error of the first method minus the error of the second, case by case.
    pub interval: Interval,
    /// Number of cases in which the first method has the smaller error.
    pub wins: usize,
    /// Number of cases.
    pub cases: usize,
}

/// Outcome of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The first method has the smaller error.
    First,
    /// The second method has the smaller error.
    Second,
    /// The interval contains 0.
    Open,
}

impl Difference {
    /// Differences of two lists of errors, case by case.
    ///
    /// # Panics
    /// If the lists differ in length or are empty.
    pub fn of(first: &[f64], second: &[f64]) -> Self {
        assert_eq!(first.len(), second.len(), "pairs");
        let differences: Vec<f64> = first.iter().zip(second).map(|(first, second)| first - second).collect();
        let wins = differences.iter().filter(|difference| **difference < 0.0).count();
        Self { interval: Interval::of(&differences), wins, cases: differences.len() }
    }

    /// The verdict: a method has the smaller error if the whole interval is on its side of 0.
    pub fn verdict(&self) -> Verdict {
        match self.interval {
            Interval { high, .. } if high < 0.0 => Verdict::First,
            Interval { low, .. } if low > 0.0 => Verdict::Second,
            _ => Verdict::Open,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEARCH: Search = Search { cases: 12, few: 8, budget: 1000, first: 6 };

    fn parameter(start: f64) -> Parameter {
        Parameter { name: "p", start, ratio: 2.0, most: f64::INFINITY, gain: 0.001 }
    }

    /// Error with its minimum at 2^`optimum`.
    fn valley(value: f64, optimum: f64) -> f64 {
        1.0 + (value.log2() - optimum).powi(2)
    }

    #[test]
    fn tune_finds_the_optimum() {
        for optimum in [-9, -1, 0, 7, 10] {
            let error = |setting: &[f64], case: usize| {
                valley(setting[0], f64::from(optimum)) * valley(setting[1], -2.0) + case as f64
            };
            let tuned = tune(&[parameter(1.0), parameter(0.5)], SEARCH, error).expect("within the budget");
            assert_eq!(tuned.setting, [2.0_f64.powi(optimum), 0.25]);
            assert_eq!((tuned.errors.len(), tuned.errors[0]), (12, 1.0));
            assert!(tuned.evaluations <= 1000 && tuned.settings >= 5);
        }
    }

    /// An error that decreases without end must not give an optimum at the edge of the range.
    #[test]
    fn unbounded_descent_is_an_error() {
        let error = tune(&[parameter(1.0)], SEARCH, |setting, _| 1.0 / setting[0]).expect_err("no optimum");
        assert!(matches!(error, TuneError::NotEnclosed { budget: 1000, .. }), "{error}");
        let flat = tune(&[parameter(1.0)], SEARCH, |setting, _| 1.0 + 0.1 / setting[0]).expect("it stops falling");
        assert!(flat.setting[0] > 8.0 && flat.setting[0] < 512.0, "{flat:?}");
        let fraction = Parameter { most: 1.0, ..parameter(0.25) };
        let tuned = tune(&[fraction], SEARCH, |setting, _| 2.0 - setting[0]).expect("the edge has a meaning");
        assert_eq!(tuned.setting, [1.0]);
        let error = tune(&[fraction], SEARCH, |_, case| if case == 3 { f64::NAN } else { 1.0 }).expect_err("NaN");
        assert_eq!(error, TuneError::NotFinite { case: 3, at: vec![0.25] });
    }

    #[test]
    fn clearly_worse_settings_need_few_evaluations() {
        let error = |setting: &[f64], _| valley(setting[0], 0.0);
        let tuned = tune(&[parameter(1.0)], SEARCH, error).expect("an optimum");
        // All cases of the best setting; the first six cases of its four neighbours, which are one and two steps away.
        assert_eq!((tuned.evaluations, tuned.settings), (12 + 4 * 6, 5));
    }

    #[test]
    fn interval_has_its_nominal_coverage() {
        let mut random = ChaCha8Rng::seed_from_u64(5);
        let mut uniform = || (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        let covered = (0..200).filter(|_| {
            let values: Vec<f64> = (0..40).map(|_| uniform()).collect();
            let Interval { low, high, .. } = Interval::of(&values);
            low < 0.5 && 0.5 < high
        });
        // 95 % of 200, within three standard deviations of the binomial distribution, slightly widened since there are
        // only 40 values.
        let covered = covered.count();
        assert!((178..=200).contains(&covered), "{covered}");
    }

    #[test]
    fn few_values_give_a_range_and_differences_give_a_verdict() {
        let few = Interval::of(&[3.0, 1.0, 2.0]);
        assert_eq!(few, Interval { mean: 2.0, low: 1.0, high: 3.0, kind: Ends::Range });
        let level: Vec<f64> = (0..20).map(f64::from).collect();
        let lower: Vec<f64> = level.iter().map(|value| value - 0.1 - 0.01 * value).collect();
        let difference = Difference::of(&lower, &level);
        assert_eq!((difference.verdict(), difference.wins), (Verdict::First, 20));
        assert_eq!(Difference::of(&level, &lower).verdict(), Verdict::Second);
        let mixed: Vec<f64> =
            level.iter().map(|value| value + if (*value as u32).is_multiple_of(2) { 1.0 } else { -1.0 }).collect();
        assert_eq!(Difference::of(&mixed, &level).verdict(), Verdict::Open);
    }
}
