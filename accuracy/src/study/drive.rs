//! `drive`: ten minutes of driving, by the closed form and by the integrators of other simulators.
//!
//! `odometry`: position from the encoders after these ten minutes, for several reading periods and resolutions.

use sim_core::pose::Pose;
use sim_core::time::Time;

use super::{Effort, Outcome, Row, Study, nanoseconds};
use crate::course::{self, Course, EndPose};
use crate::figure::{Figure, Mark, Scale, Series};

pub const DRIVE: Study = Study {
    name: "drive",
    title: "Position after 10 minutes of straight lines, curves and turns, against the length of the slot",
    run: drive,
};

pub const ODOMETRY: Study = Study {
    name: "odometry",
    title: "Position by odometry after 10 minutes, against period and resolution of the encoders",
    run: odometry,
};

/// Lengths of slots and steps, us; each divides a second. Runge-Kutta is not run with steps of 1 us, at which it is
/// slowest and its error is mainly rounding.
const SLOTS: [i64; 10] = [1, 10, 100, 1_000, 5_000, 10_000, 50_000, 100_000, 200_000, 1_000_000];

fn drive(effort: Effort) -> Outcome {
    let rows = drives(&Course::ten_minutes(), effort);
    let mut series: Vec<Series> = Vec::new();
    for rows in rows.chunk_by(|one, next| one.method == next.method) {
        let slots = SLOTS[SLOTS.len() - rows.len()..].iter().map(|slot| *slot as f64 / 1e6);
        series.push(curve(&rows[0].method, slots.zip(rows)));
    }
    Outcome { rows, figures: vec![against_length("drive-slot", DRIVE.title, "slot or step, s", series)] }
}

/// Rows of each method on the course, for each length of slot or step.
fn drives(course: &Course, effort: Effort) -> Vec<Row> {
    let end = course.end();
    let methods: [(&str, &[i64], Method); 3] = [
        ("closed-form", &SLOTS, |course, slot| course::core(course, slot)),
        ("Euler", &SLOTS, |course, slot| course::euler(course, slot.seconds())),
        ("Runge-Kutta", &SLOTS[1..], |course, slot| course::runge_kutta(course, slot.seconds())),
    ];
    let measure = |method: &str, run: Method, slot: i64| {
        let mut pose = Pose::default();
        let repeats = if slot < 1_000 { 1 } else { effort.of(30) };
        let time_ns = nanoseconds(repeats, 1, || pose = run(course, Time(slot)));
        row(DRIVE, method, &duration(slot), end.distance(&pose), time_ns, course)
    };
    methods.iter().flat_map(|(method, slots, run)| slots.iter().map(|slot| measure(method, *run, *slot))).collect()
}

fn odometry(effort: Effort) -> Outcome {
    let course = Course::ten_minutes();
    let end = course.end();
    let mut rows = Vec::new();
    let mut series = Vec::new();
    for (method, ticks) in [
        ("exact angles", None),
        ("10,000 counts per turn", Some(10_000.0)),
        ("1,000 counts per turn", Some(1_000.0)),
        ("100 counts per turn", Some(100.0)),
    ] {
        let periods = &SLOTS[3..];
        let measured: Vec<Row> =
            periods.iter().map(|period| odometry_row(&course, &end, method, *period, ticks, effort)).collect();
        series.push(curve(method, periods.iter().map(|period| *period as f64 / 1e6).zip(&measured)));
        rows.extend(measured);
    }
    Outcome { rows, figures: vec![against_length("odometry-period", ODOMETRY.title, "period, s", series)] }
}

type Method = fn(&Course, Time) -> Pose;

fn odometry_row(course: &Course, end: &EndPose, method: &str, period: i64, ticks: Option<f64>, effort: Effort) -> Row {
    let mut pose = Pose::default();
    let time_ns = nanoseconds(effort.of(30), 1, || pose = course::odometry(course, Time(period), ticks));
    row(ODOMETRY, method, &format!("read every {}", duration(period)), end.distance(&pose), time_ns, course)
}

fn row(study: Study, method: &str, setting: &str, error: f64, time_ns: f64, course: &Course) -> Row {
    Row {
        study: study.name,
        method: method.to_owned(),
        setting: setting.to_owned(),
        error,
        unit: "m",
        time_ns: time_ns / f64::from(course.seconds()),
        per: "simulated second",
    }
}

fn curve<'r>(method: &str, points: impl Iterator<Item = (f64, &'r Row)>) -> Series {
    let points = points.map(|(length, row)| (length, row.error)).collect();
    Series { name: method.to_owned(), mark: Mark::LineAndDots, points }
}

fn against_length(name: &str, title: &str, x_label: &str, series: Vec<Series>) -> Figure {
    Figure {
        name: name.to_owned(),
        title: title.to_owned(),
        x_label: x_label.to_owned(),
        y_label: "error, m".to_owned(),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        series,
    }
}

/// Formats a duration as `5 us`, `50 ms` or `1 s`.
fn duration(micros: i64) -> String {
    match micros {
        us if us % 1_000_000 == 0 => format!("{} s", us / 1_000_000),
        us if us % 1_000 == 0 => format!("{} ms", us / 1_000),
        us => format!("{us} us"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_have_a_suitable_unit() {
        assert_eq!([1, 5_000, 1_000_000].map(duration), ["1 us", "5 ms", "1 s"]);
    }

    #[test]
    fn error_of_the_closed_form_is_constant_and_that_of_euler_grows() {
        // The first two seconds from the second drive on, which is a curve.
        let course = Course(Course::ten_minutes().0[1..].to_vec()).first(2);
        let rows = drives(&course, Effort::Quick);
        let errors = |method: &str| -> Vec<f64> {
            rows.iter().filter(|row| row.method == method).map(|row| row.error).collect()
        };
        let closed_form = errors("closed-form");
        assert_eq!(closed_form.len(), SLOTS.len());
        assert!(closed_form.iter().all(|error| *error == closed_form[0] && *error < 1e-9), "{closed_form:?}");
        let euler = errors("Euler");
        assert!(euler.is_sorted() && euler[0] > 1e-9 && euler[9] > 0.1 * euler[8], "{euler:?}");
    }

    #[test]
    fn error_grows_with_coarser_encoders() {
        let course = Course::ten_minutes().first(30);
        let end = course.end();
        let error = |ticks| odometry_row(&course, &end, "", 10_000, ticks, Effort::Quick).error;
        let (exact, fine, coarse) = (error(None), error(Some(10_000.0)), error(Some(100.0)));
        assert!(exact < fine && fine < coarse, "{exact} {fine} {coarse}");
    }
}
