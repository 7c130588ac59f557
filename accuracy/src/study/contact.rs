//! `contact`: error of the instant at which a robot hits a wall, by the core's closed form and by testing for overlap
//! after each step.

use super::{Effort, Outcome, Row, Study, nanoseconds};
use crate::touch::{Approach, Case};
use crate::world::Random;

pub const STUDY: Study =
    Study { name: "contact", title: "Error of the contact time as a function of the step length", run };

/// Step lengths of the simulator that tests for overlap after each step, s.
const STEPS: [f64; 6] = [0.2, 0.05, 0.01, 1e-3, 1e-4, 1e-5];
/// Time after the exact instant up to which the steps continue, s; also the error of a contact that no step finds.
const HORIZON: f64 = 1.0;

fn run(effort: Effort) -> Outcome {
    let mut rows = Vec::new();
    for approach in Approach::ALL {
        let mut random = Random::new(5);
        let cases: Vec<Case> = (0..effort.of(1_000)).map(|_| Case::draw(&mut random, approach)).collect();
        let error_of = |case: &Case| (case.simulate().expect("every case is a contact") - case.instant).abs();
        let error = cases.iter().map(error_of).fold(0.0, f64::max);
        let time_ns = nanoseconds(20, cases.len(), || cases.iter().filter_map(Case::simulate).sum::<f64>());
        rows.push(row("closed form", approach.name().to_owned(), error, time_ns));
    }
    for step in STEPS {
        let mut random = Random::new(5);
        // Short steps take longer, so there are fewer cases.
        let count = ((effort.of(1_000) as f64 * step.sqrt()) as usize).clamp(8, 400);
        let cases: Vec<Case> = (0..count).map(|_| Case::draw(&mut random, Approach::Oblique)).collect();
        let delay = |case: &Case| {
            case.by_steps(step, case.instant + HORIZON).map_or(HORIZON, |instant| (instant - case.instant).abs())
        };
        let error = cases.iter().map(delay).fold(0.0, f64::max);
        let time_ns = nanoseconds(1, cases.len(), || {
            cases.iter().filter_map(|case| case.by_steps(step, case.instant + HORIZON)).sum::<f64>()
        });
        rows.push(row("overlap after each step", format!("oblique, steps of {} ms", step * 1e3), error, time_ns));
    }
    rows.into()
}

fn row(method: &str, setting: String, error: f64, time_ns: f64) -> Row {
    Row { study: STUDY.name, method: method.to_owned(), setting, error, unit: "s", time_ns, per: "contact" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_form_is_exact_and_steps_are_late() {
        let rows = run(Effort::Quick).rows;
        let errors =
            |method: &str| rows.iter().filter(|row| row.method == method).map(|row| row.error).collect::<Vec<_>>();
        // Within a nanosecond: a nanometre at 1 m/s.
        assert!(errors("closed form").iter().all(|error| *error < 1e-9), "{:?}", errors("closed form"));
        for (error, step) in errors("overlap after each step").into_iter().zip(STEPS) {
            assert!(error > 0.5 * step && error <= HORIZON, "{error} s late with steps of {step} s");
        }
    }
}
