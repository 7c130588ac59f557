//! `slide`: positions of robots that slide along walls, by the closed forms and by an integrator in small steps.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec2;
use sim_core::RobotId;
use sim_core::contact::SKIN;
use sim_core::drive::{Command, ContactRule, Model, Motion};
use sim_core::math;
use sim_core::pose::{Pose, Twist};
use sim_core::scene::{Segment, Walls};
use sim_core::time::Time;

use super::{Effort, Outcome, Row, Study, nanoseconds};
use crate::course::model;
use crate::figure::{Figure, Mark, Scale, Series};
use crate::slide::Case;

pub const STUDY: Study =
    Study { name: "slide", title: "Position of a robot that slides along walls, against the length of the step", run };

/// Radius of the discs, m.
const RADIUS: f64 = 0.1;
/// Steps of the integrator, s.
const STEPS: [f64; 4] = [0.05, 0.01, 1e-3, 1e-4];
/// Number of steps of the coarser of the two runs from which the reference is extrapolated.
const REFERENCE_STEPS: u64 = 40_000;

/// A case with its name and its duration in s.
struct NamedCase {
    name: &'static str,
    case: Case,
    seconds: f64,
}

fn cases() -> Vec<NamedCase> {
    let wall = |ax: f64, ay: f64, bx: f64, by: f64| Segment::new(DVec2::new(ax, ay), DVec2::new(bx, by));
    // The disc starts below a wall along x, in contact with it.
    let touching = |angle: f64| Pose::new(0.0, -RADIUS - SKIN, angle);
    let named = |name, walls: Vec<Segment>, start, twist, seconds| {
        let case = Case { walls, radius: RADIUS, friction: 0.3, start, twist };
        NamedCase { name, case, seconds }
    };
    let ring = (0..64).map(|side| {
        let corner = |side: i32| {
            let (sin, cos) = math::sin_cos(TAU * f64::from(side) / 64.0);
            DVec2::new(0.5 * cos, 0.5 * sin)
        };
        Segment::new(corner(side), corner(side + 1))
    });
    let along = vec![wall(-1.0, 0.0, 3.0, 0.0)];
    let corner = vec![wall(-1.0, 0.0, 1.0, 0.0), wall(1.0, -1.0, 1.0, 0.0)];
    vec![
        named("along a wall", along.clone(), Pose::new(0.0, -0.2, 0.2), Twist::new(0.3, 0.0), 6.0),
        named("grazing at 1e-9 rad", along.clone(), touching(1e-9), Twist::new(0.3, 0.0), 6.0),
        named("turning at a wall", along, touching(0.2), Twist::new(0.3, 0.7), 6.0),
        named("into a corner", corner.clone(), Pose::new(0.0, -0.6, 0.7), Twist::new(0.3, 0.0), 6.0),
        named("turning in a corner", corner, Pose::new(0.5, -0.3, 0.3), Twist::new(0.3, 0.5), 6.0),
        named("round a wall's end", vec![wall(-1.0, 0.0, 0.3, 0.0)], touching(0.9), Twist::new(0.3, 0.0), 3.0),
        named("in a ring of 64 walls", ring.collect(), Pose::new(0.1, 0.05, 0.3), Twist::new(0.3, 0.4), 10.0),
    ]
}

impl NamedCase {
    fn motion(&self) -> Motion {
        let model = Model { body_radius: RADIUS, axis_offset: 0.0, ..model() };
        let walls = Arc::new(Walls::new(self.case.walls.clone()));
        let mut motion = Motion::new(RobotId(1), Arc::new(model), walls, self.case.start)
            .with_contact(ContactRule::Slide { friction: self.case.friction })
            .expect("a friction");
        motion.command(Time::ZERO, Command::Twist(self.case.twist), &[]).expect("a valid command");
        motion
    }

    fn simulate(&self) -> DVec2 {
        self.motion().pose(Time::from_seconds_ceil(self.seconds)).position
    }

    /// Positions of the centre between two times, s.
    fn path(&self, from: f64, to: f64) -> Vec<(f64, f64)> {
        let mut motion = self.motion();
        let points = (0..=200).map(|index| {
            let at = Time::from_seconds_ceil(from + (to - from) * f64::from(index) / 200.0);
            motion.pose(at).position.into()
        });
        points.collect()
    }
}

fn run(effort: Effort) -> Outcome {
    let cases = cases();
    let mut rows = Vec::new();
    let mut truths = Vec::new();
    for named in &cases {
        let steps = effort.of(REFERENCE_STEPS as usize) as u64;
        let (truth, _) = named.case.extrapolated(named.seconds, steps);
        let error = (named.simulate() - truth).length();
        let time_ns = nanoseconds(20, 1, || named.simulate().x) / named.seconds;
        rows.push(row("closed form", named.name.to_owned(), error, time_ns));
        truths.push(truth);
    }
    for step in STEPS {
        let count = |named: &NamedCase| (named.seconds / step).round() as u64;
        let step_error =
            |(named, truth): (&NamedCase, &DVec2)| (named.case.by_steps(named.seconds, count(named)) - *truth).length();
        let error = cases.iter().zip(&truths).map(step_error).fold(0.0, f64::max);
        let seconds: f64 = cases.iter().map(|named| named.seconds).sum();
        let run_all = || cases.iter().map(|named| named.case.by_steps(named.seconds, count(named)).x).sum::<f64>();
        let time_ns = nanoseconds(1, 1, run_all) / seconds;
        rows.push(row("steps", format!("all cases, steps of {} ms", step * 1e3), error, time_ns));
    }
    Outcome { rows, figures: vec![path_figure(&cases)] }
}

/// Plot of the walls of a corner and of the paths of discs in it.
fn path_figure(cases: &[NamedCase]) -> Figure {
    let corner = &cases[3].case;
    let line = |name: &str, points| Series { name: name.to_owned(), mark: Mark::Line, points };
    let outline = vec![(-1.0, 0.0), (1.0, 0.0), (1.0, -1.0)];
    let mut series = vec![line("walls", outline)];
    let starts = [
        ("10 degrees: along the wall", Pose::new(-0.9, -0.3, 10_f64.to_radians()), 0.0),
        ("140 degrees: round the end", Pose::new(-0.3, -0.6, 140_f64.to_radians()), 0.0),
        ("75 degrees: rests", Pose::new(0.2, -0.6, 75_f64.to_radians()), 0.0),
        ("turning left", Pose::new(0.4, -0.8, -20_f64.to_radians()), 0.5),
    ];
    for (name, start, omega) in starts {
        let case = Case { start, twist: Twist::new(0.3, omega), ..corner.clone() };
        let named = NamedCase { name, case, seconds: 6.0 };
        series.push(line(name, named.path(0.0, named.seconds)));
    }
    Figure {
        name: "slide-paths".to_owned(),
        title: "Centres of discs of 100 mm at a corner, friction 0.3".to_owned(),
        x_label: "x, m".to_owned(),
        y_label: "y, m".to_owned(),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        series,
    }
}

fn row(method: &str, setting: String, error: f64, time_ns: f64) -> Row {
    let (unit, per) = ("m", "simulated second");
    Row { study: STUDY.name, method: method.to_owned(), setting, error, unit, time_ns, per }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_forms_match_the_reference_better_than_steps() {
        let rows = run(Effort::Quick).rows;
        let errors =
            |method: &str| rows.iter().filter(|row| row.method == method).map(|row| row.error).collect::<Vec<_>>();
        // The closed form has to be accurate to a micrometre.
        assert!(errors("closed form").iter().all(|error| *error < 1e-6), "{:?}", errors("closed form"));
        let steps = errors("steps");
        assert!(steps[0] > 1e-4 && steps[3] < 1e-5, "{steps:?}");
    }
}
