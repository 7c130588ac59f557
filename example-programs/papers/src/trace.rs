//! A sink that keeps, as typed values, those events of a run from which pages are made.

use sim_core::record::{self, Digest, Kind, KindSet, Record, WORLD};
use sim_core::time::Time;
use sim_host::record::{RecordError, Sink};

/// A finished run.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// The events in the order of the run; only the kinds that [`Event`] contains.
    pub entries: Vec<Entry>,
    /// Virtual time of the end of the run, s.
    pub end: f64,
    /// Digest of the run.
    pub digest: String,
}

/// An event with its time.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Virtual time, s.
    pub at: f64,
    /// Number of the robot; 0 for the world.
    pub robot: u32,
    /// The event.
    pub event: Event,
}

/// The events from which pages are made; fields and units as in `docs/trace.md`.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "they are described in docs/trace.md")]
pub enum Event {
    ProgramEnded,
    Pose {
        x_m: f64,
        y_m: f64,
        phi_rad: f64,
    },
    Posture {
        lift_m: f64,
        joints_rad: Vec<f64>,
    },
    Footfall {
        leg: String,
    },
    Odometry {
        x_m: f64,
        y_m: f64,
        phi_rad: f64,
    },
    Distance {
        device: String,
        distance_m: Option<f64>,
        measured_s: f64,
    },
    Contact,
    /// A leg or the body touches something.
    Touch,
    Stdout {
        text: String,
    },
}

/// The kinds of events that [`Event`] contains.
const KINDS: [Kind; 9] = [
    Kind::ProgramEnded,
    Kind::Pose,
    Kind::Posture,
    Kind::Footfall,
    Kind::Odometry,
    Kind::Distance,
    Kind::Contact,
    Kind::LegContact,
    Kind::Stdout,
];

impl Event {
    /// Typed copy of an event; `None` for other kinds.
    fn of(event: &record::Event<'_>) -> Option<Self> {
        use record::Event as Recorded;
        Some(match *event {
            Recorded::ProgramEnded { .. } => Self::ProgramEnded,
            Recorded::Pose { x_m, y_m, phi_rad, .. } => Self::Pose { x_m, y_m, phi_rad },
            Recorded::Posture { lift_m, joints_rad, .. } => {
                Self::Posture { lift_m, joints_rad: joints_rad.iter().collect() }
            }
            Recorded::Footfall { leg, .. } => Self::Footfall { leg: leg.to_owned() },
            Recorded::Odometry { x_m, y_m, phi_rad } => Self::Odometry { x_m, y_m, phi_rad },
            Recorded::Distance { device, distance_m, measured_s } => {
                Self::Distance { device: device.to_owned(), distance_m, measured_s }
            }
            Recorded::Contact { .. } => Self::Contact,
            Recorded::LegContact { .. } => Self::Touch,
            Recorded::Stdout { text } => Self::Stdout { text: text.to_owned() },
            _ => return None,
        })
    }
}

impl Sink for Trace {
    fn interest(&self) -> KindSet {
        KindSet::of(&KINDS)
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        let robot = if record.robot == WORLD { 0 } else { record.robot.0 };
        let at = record.time.seconds();
        self.entries.extend(Event::of(&record.event).map(|event| Entry { at, robot, event }));
        Ok(())
    }

    fn end_slot(&mut self, _: Time, _: Option<Digest>) -> Result<(), RecordError> {
        Ok(())
    }

    fn finish(&mut self, end: Time, digest: Digest) -> Result<(), RecordError> {
        (self.end, self.digest) = (end.seconds(), digest.to_string());
        Ok(())
    }
}

impl Trace {
    /// The events of one robot.
    pub fn of_robot(&self, robot: u32) -> impl Iterator<Item = &Entry> {
        self.entries.iter().filter(move |entry| entry.robot == robot)
    }

    /// The lines that a robot's program has printed, with their times in s.
    pub fn printed(&self, robot: u32) -> impl Iterator<Item = (f64, &str)> {
        self.of_robot(robot).filter_map(|entry| match &entry.event {
            Event::Stdout { text } => Some((entry.at, text.as_str())),
            _ => None,
        })
    }
}

#[cfg(test)]
mod tests {
    use sim_core::RobotId;

    use super::*;

    #[test]
    fn events_are_kept_typed_and_others_left_out() {
        let mut trace = Trace::default();
        let distance = record::Event::Distance { device: "PSD", distance_m: None, measured_s: 0.06 };
        for (ms, robot, event) in
            [(50, 1, record::Event::Beep {}), (60, 1, distance), (70, 2, record::Event::Stdout { text: "hello" })]
        {
            let record = Record { time: Time::from_millis(ms), robot: RobotId(robot), sequence: Some(0), event };
            trace.record(&record).expect("it takes everything");
        }
        let distance = Event::Distance { device: "PSD".to_owned(), distance_m: None, measured_s: 0.06 };
        assert_eq!(trace.of_robot(1).collect::<Vec<_>>(), [&Entry { at: 0.06, robot: 1, event: distance }]);
        assert_eq!(trace.printed(2).collect::<Vec<_>>(), [(0.07, "hello")]);
    }

    #[test]
    fn the_trace_requests_exactly_the_kinds_that_it_keeps() {
        let interest = Trace::default().interest();
        let kinds = Kind::ALL.iter().filter(|kind| interest.contains(**kind));
        assert_eq!(kinds.count(), KINDS.len());
    }
}
