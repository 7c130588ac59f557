//! `objects` and `objects-conserved`: sliding, rolling, colliding and pushed objects, compared with closed forms and
//! with short steps of the solver.

mod case;
mod impact;

use std::collections::BTreeMap;

use sim_core::ObjectId;
use sim_core::object::STEP;
use sim_core::time::Time;

use super::{Effort, Outcome, Row, Study, nanoseconds};
use crate::figure::{Figure, Mark, Scale, Series};
use case::{Case, STARTS, Trial};

pub const STUDY: Study = Study {
    name: "objects",
    title: "Positions and velocities of pushed, sliding and colliding objects, against the solver's step",
    run: motion,
};

pub const CONSERVED: Study = Study {
    name: "objects-conserved",
    title: "Momentum and energy of colliding objects, against the solver's step",
    run: conserved,
};

/// Steps of the solver; the simulator uses 1 ms. Each divides the duration of every case.
const STEPS: [Time; 4] = [Time(10_000), Time(1_000), Time(100), Time(20)];
/// Shortest step whose time is measured in several repetitions.
const SHORTEST_REPEATED: Time = Time(1_000);

fn motion(effort: Effort) -> Outcome {
    let mut rows = rows(STUDY.name, case::moving, effort);
    rows.extend(self_referenced(&case::struck_crate(), effort));
    rows.push(pushing_robot(effort));
    let is_impact = |row: &Row| case::IMPACTS.contains(&&*row.method);
    let (impacts, others): (Vec<_>, Vec<_>) = rows.iter().cloned().partition(is_impact);
    let title = "Error of position and velocity, relative to path and speed";
    let figures = vec![by_step(&others, "objects-step", title), by_step(&impacts, "objects-impacts-step", title)];
    Outcome { rows, figures }
}

fn conserved(effort: Effort) -> Outcome {
    let rows = rows(CONSERVED.name, case::conserving, effort);
    let title = "Error of momentum and energy, relative to those at the start";
    let figures = vec![by_step(&rows, "objects-conserved-step", title)];
    Outcome { rows, figures }
}

/// Rows of all cases: the maximum error over all starts.
fn rows(study: &'static str, cases: fn(usize) -> Vec<Case>, effort: Effort) -> Vec<Row> {
    let starts: Vec<Vec<Case>> = (0..STARTS).map(cases).collect();
    let case_rows = |index: usize| {
        let step_row = |step| {
            let error = starts.iter().map(|cases| cases[index].error(step)).fold(0.0, f64::max);
            timed_row(study, &starts[0][index].trial, step, effort, error)
        };
        STEPS.map(step_row)
    };
    (0..starts[0].len()).flat_map(case_rows).collect()
}

/// Rows of a trial without a closed form. The error is the distance of the first object's end position from that with
/// the shortest steps, relative to its path.
fn self_referenced(trial: &Trial, effort: Effort) -> Vec<Row> {
    let end_position = |step| trial.run(step).0.state(ObjectId(1)).world_from_object.position;
    let [longer @ .., shortest] = STEPS;
    let truth = end_position(shortest);
    let path = (truth - trial.objects[0].1.position).length();
    longer.map(|step| timed_row(STUDY.name, trial, step, effort, (end_position(step) - truth).length() / path)).into()
}

fn timed_row(study: &'static str, trial: &Trial, step: Time, effort: Effort, error: f64) -> Row {
    let repeats = if step < SHORTEST_REPEATED { 1 } else { effort.of(10) };
    let time_ns = nanoseconds(repeats, 1, || trial.run(step).1) / trial.seconds;
    row(study, trial.name, step, error, time_ns)
}

fn pushing_robot(effort: Effort) -> Row {
    let time_ns = nanoseconds(effort.of(10), 1, case::robot_and_heavy_crate) / case::PUSH_SECONDS;
    row(STUDY.name, "a robot and a heavy crate", STEP, case::robot_and_heavy_crate(), time_ns)
}

fn row(study: &'static str, method: &str, step: Time, error: f64, time_ns: f64) -> Row {
    let setting = match step.0 {
        us if us % 1_000 == 0 => format!("steps of {} ms", us / 1_000),
        us => format!("steps of {us} us"),
    };
    let (unit, per) = ("of 1", "simulated second");
    Row { study, method: method.to_owned(), setting, error, unit, time_ns, per }
}

/// Chart of the error against the length of the step, with a curve for each method.
fn by_step(rows: &[Row], name: &str, title: &str) -> Figure {
    let lengths: BTreeMap<String, f64> =
        STEPS.iter().map(|step| (row("", "", *step, 0.0, 0.0).setting, step.seconds())).collect();
    let curve = |rows: &[Row]| Series {
        name: rows[0].method.clone(),
        mark: Mark::LineAndDots,
        points: rows.iter().map(|row| (lengths[&row.setting], row.error)).collect(),
    };
    let series =
        rows.chunk_by(|one, next| one.method == next.method).filter(|rows| rows.len() > 1).map(curve).collect();
    Figure {
        name: name.to_owned(),
        title: title.to_owned(),
        x_label: "step, s".to_owned(),
        y_label: "error, of 1".to_owned(),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        series,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Name and maximum error over all starts of each case.
    fn errors(cases: fn(usize) -> Vec<Case>, step: Time) -> Vec<(&'static str, f64)> {
        let mut errors: Vec<(&str, f64)> = cases(0).iter().map(|case| (case.trial.name, 0.0)).collect();
        for case in (0..STARTS).flat_map(cases) {
            let (_, error) = errors.iter_mut().find(|(name, _)| *name == case.trial.name).expect("the same cases");
            *error = error.max(case.error(step));
        }
        errors
    }

    #[test]
    fn errors_fall_with_the_step() {
        for ((name, coarse), (_, fine)) in errors(case::moving, STEP).into_iter().zip(errors(case::moving, Time(100))) {
            if name == "a rough wall, restitution 0.5" {
                // With any step, the friction impulse lacks the part that the restitution adds to the normal impulse.
                assert!(fine > 0.05 && fine < 0.25, "{name}: {fine}");
                continue;
            }
            // The limit is a tenth of the path, so no object has passed through a wall or another object.
            assert!(coarse < 0.1, "{name}: {coarse}");
            // `fine` has a tenth of the step of `coarse`. The depth of the light ball decreases with the square root of
            // the step.
            let factor = if name.ends_with("depth") { 0.6 } else { 0.3 };
            assert!(fine < 1e-9 || fine < factor * coarse, "{name}: {fine}, {coarse}");
        }
    }

    #[test]
    fn free_object_has_the_stopping_distance_of_constant_friction() {
        for step in [Time(10_000), Time(1_000), Time(100)] {
            let error = case::moving(0)[0].error(step);
            assert!(error < 1e-12, "{step}: {error}");
        }
    }

    #[test]
    fn elastic_impacts_conserve_momentum_and_energy() {
        for (name, error) in errors(case::conserving, STEP).into_iter().filter(|(name, _)| name.ends_with(", elastic"))
        {
            // The limit allows for rounding; the crowd may lose energy where three discs meet.
            let limit = if name.starts_with("36") { 0.1 } else { 1e-12 };
            assert!(error < limit, "{name}: {error}");
        }
    }

    #[test]
    fn robot_and_heavy_crate_have_the_expected_stopping_distance() {
        // The limit is 3 % of 6.5 mm.
        assert!(case::robot_and_heavy_crate() < 0.03, "{}", case::robot_and_heavy_crate());
    }
}
