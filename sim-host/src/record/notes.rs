//! Contacts, hints, metrics and forbidden calls of a run, collected for its report.

use std::collections::BTreeMap;

use sim_core::RobotId;
use sim_core::record::{Digest, Event, Kind, KindSet, Record};
use sim_core::time::Time;

use super::hint_locations::HintLocations;
use super::report::HintReport;
use super::sink::{RecordError, Sink};

/// Maximum number of contact times that are stored for a robot.
pub const MAX_CONTACT_TIMES: usize = 1000;

/// Maximum number of hints that are stored for a robot.
pub const MAX_HINTS: usize = 100;

/// Maximum number of metrics that are stored for a robot.
const MAX_METRICS: usize = 200;

/// Maximum number of remarks that are stored.
const MAX_REMARKS: usize = 20;

/// Prefix of a line that reports a metric of a program.
const METRIC: &str = "METRIC ";

/// Sink that collects the instants of contacts, the hints, calls of forbidden functions, and the metrics that programs
/// print: lines `METRIC name=value`.
#[derive(Clone, Debug, Default)]
pub struct Notes {
    robots: BTreeMap<RobotId, RobotNotes>,
    hint_locations: HintLocations,
    /// Remarks on metrics that are not stored: malformed lines, and metrics beyond the maximum number.
    pub remarks: Vec<String>,
}

/// Notes of one robot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotNotes {
    /// Instants at which the robot's contacts began, s.
    pub contact_times: Vec<f64>,
    /// Hints for the robot's program.
    pub hints: Vec<HintReport>,
    /// Last value of each metric.
    pub metrics: BTreeMap<String, f64>,
    /// Number of calls of each forbidden function, by name.
    pub forbidden_calls: BTreeMap<String, u64>,
}

impl Notes {
    /// Creates empty notes; `hint_locations` are the source lines to which hints refer.
    pub fn new(hint_locations: HintLocations) -> Self {
        Self { hint_locations, ..Self::default() }
    }

    /// The notes of a robot.
    pub fn of(&self, robot: RobotId) -> &RobotNotes {
        static NONE: RobotNotes = RobotNotes {
            contact_times: Vec::new(),
            hints: Vec::new(),
            metrics: BTreeMap::new(),
            forbidden_calls: BTreeMap::new(),
        };
        self.robots.get(&robot).unwrap_or(&NONE)
    }

    fn add_output_line(&mut self, robot: RobotId, line: &str) {
        let Some(text) = line.strip_prefix(METRIC) else { return };
        let metrics = &mut self.robots.entry(robot).or_default().metrics;
        let problem = match parse(text) {
            Ok((name, value)) if metrics.contains_key(name) || metrics.len() < MAX_METRICS => {
                metrics.insert(name.to_owned(), value);
                return;
            }
            Ok(_) => format!("a robot has at most {MAX_METRICS} metrics"),
            Err(why) => why,
        };
        if self.remarks.len() < MAX_REMARKS {
            self.remarks.push(format!("{robot}: `{}` is not kept: {problem}", line.trim_end()));
        }
    }
}

/// Name and value of `name=value`.
fn parse(text: &str) -> Result<(&str, f64), String> {
    const EXPECTED: &str = "expected `METRIC name=value`, such as `METRIC error_mm=12.5`";
    let (name, value) = text.split_once('=').ok_or(EXPECTED)?;
    let (name, value) = (name.trim(), value.trim());
    let is_name = |name: &str| name.chars().all(|c| c.is_alphanumeric() || "_-.".contains(c));
    if name.is_empty() || !is_name(name) {
        return Err(format!("`{name}` is not a name of letters, digits, `_`, `-` and `.`; {EXPECTED}"));
    }
    let number = value.parse::<f64>().ok().filter(|number| number.is_finite());
    number.map(|number| (name, number)).ok_or_else(|| format!("`{value}` is not a finite number; {EXPECTED}"))
}

impl Sink for Notes {
    fn interest(&self) -> KindSet {
        KindSet::of(&[Kind::Contact, Kind::Hint, Kind::Stdout, Kind::Forbidden])
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        match record.event {
            Event::Contact { at_s, .. } => {
                let times = &mut self.robots.entry(record.robot).or_default().contact_times;
                if times.len() < MAX_CONTACT_TIMES {
                    times.push(at_s);
                }
            }
            Event::Forbidden { function } => {
                let calls = &mut self.robots.entry(record.robot).or_default().forbidden_calls;
                *calls.entry(function.to_owned()).or_default() += 1;
            }
            Event::Hint { text } => {
                let hints = &mut self.robots.entry(record.robot).or_default().hints;
                if hints.len() < MAX_HINTS {
                    let at = self.hint_locations.of(record.robot, text);
                    hints.push(HintReport { at_s: record.time.seconds(), at, text: text.to_owned() });
                }
            }
            Event::Stdout { text } => text.lines().for_each(|line| self.add_output_line(record.robot, line)),
            _ => {}
        }
        Ok(())
    }

    fn end_slot(&mut self, _: Time, _: Option<Digest>) -> Result<(), RecordError> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_value_of_each_metric_is_kept() {
        let (mut notes, robot) = (Notes::default(), RobotId(1));
        for line in ["METRIC error_mm=12.5", "hello", "METRIC laps = 2", "METRIC error_mm=-3e1", "METRICS are fine"] {
            notes.add_output_line(robot, line);
        }
        let expected = [("error_mm".to_owned(), -30.0), ("laps".to_owned(), 2.0)].into();
        assert_eq!(notes.of(robot).metrics, expected);
        assert_eq!((notes.of(RobotId(2)).metrics.len(), notes.remarks.len()), (0, 0));
    }

    #[test]
    fn malformed_metric_gives_a_remark() {
        let (mut notes, robot) = (Notes::default(), RobotId(3));
        for line in ["METRIC 12.5", "METRIC error=", "METRIC error=nan", "METRIC my error=1", "METRIC =1"] {
            notes.add_output_line(robot, line);
        }
        assert!(notes.of(robot).metrics.is_empty());
        assert_eq!(notes.remarks.len(), 5);
        assert_eq!(
            notes.remarks[0],
            "r3: `METRIC 12.5` is not kept: expected `METRIC name=value`, such as `METRIC error_mm=12.5`"
        );
        assert!(notes.remarks[2].contains("`nan` is not a finite number"), "{}", notes.remarks[2]);
        for number in 0..2 * MAX_METRICS {
            notes.add_output_line(robot, &format!("METRIC m{number}=1"));
        }
        assert_eq!((notes.of(robot).metrics.len(), notes.remarks.len()), (MAX_METRICS, MAX_REMARKS));
        assert!(notes.remarks[19].contains("at most 200 metrics"), "{}", notes.remarks[19]);
    }
}
