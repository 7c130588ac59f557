//! What a run has left behind: the events of its trace of which pages are made, typed.

use std::path::Path;

use serde::Deserialize;
use sim_host::record::read::{Line, TraceError, TraceReader};

/// A finished run.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// Its events in the order of the run, without those that no page is made of.
    pub entries: Vec<Entry>,
    /// Simulated time at its end, s.
    pub end: f64,
    /// Its digest; empty if the trace was cut off.
    pub digest: String,
}

/// An event with its time.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Virtual time, s.
    pub at: f64,
    /// Number of the robot; 0 for the world.
    pub robot: u32,
    /// What happened.
    pub event: Event,
}

/// The events of which pages are made; fields and units as in `docs/trace.md`.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "event", rename_all = "snake_case")]
#[allow(missing_docs, reason = "they are described in docs/trace.md")]
pub enum Event {
    ProgramEnded {
        outcome: String,
        exit_code: Option<i32>,
    },
    Pose {
        x_m: f64,
        y_m: f64,
        phi_rad: f64,
        turns: i64,
    },
    Posture {
        lift_m: f64,
        joints_rad: Vec<f64>,
    },
    Footfall {
        leg: String,
        x_m: f64,
        y_m: f64,
        z_m: f64,
    },
    Placed {
        x_m: f64,
        y_m: f64,
        phi_rad: f64,
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
    /// The signal is null where it is infinite.
    Signal {
        device: String,
        signal: Option<f64>,
        measured_s: f64,
    },
    /// With what is left as the trace has it: `"wall"`, `{"robot": 2}`, `{"object": 1}`.
    Contact {
        at_s: f64,
        with: serde_json::Value,
        x_m: f64,
        y_m: f64,
    },
    /// A leg or the body touches something.
    Touch,
    Stdout {
        text: String,
    },
    #[serde(other)]
    Other,
}

impl Trace {
    /// Reads a trace.
    ///
    /// # Errors
    /// [`TraceError`] for a file that cannot be read, is no trace, or has an event without the fields that belong to it.
    pub fn read(path: &Path) -> Result<Self, TraceError> {
        let mut reader = TraceReader::open(path)?;
        let mut trace = Self::default();
        while let Some(line) = reader.next_line()? {
            match line {
                Line::Event(recorded) => {
                    let (at, robot) = (recorded.at.seconds(), recorded.robot.unwrap_or(0));
                    let event = serde_json::from_value(recorded.fields)
                        .map_err(|error| reader.wrong(&format!("`{}`: {error}", recorded.kind)))?;
                    if event != Event::Other {
                        trace.entries.push(Entry { at, robot, event });
                    }
                }
                Line::Slot { .. } => {}
                Line::End { end, digest } => (trace.end, trace.digest) = (end.seconds(), digest.to_string()),
            }
        }
        Ok(trace)
    }

    /// The events of one robot.
    pub fn of_robot(&self, robot: u32) -> impl Iterator<Item = &Entry> {
        self.entries.iter().filter(move |entry| entry.robot == robot)
    }

    /// The lines that a robot's program has printed, with their times, s.
    pub fn printed(&self, robot: u32) -> impl Iterator<Item = (f64, &str)> {
        self.of_robot(robot).filter_map(|entry| match &entry.event {
            Event::Stdout { text } => Some((entry.at, text.as_str())),
            _ => None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str =
        r#"{"event":"header","schema":1,"eyesim_version":"0.1.0","seed":7,"slot_us":50000,"robots":[]}"#;

    fn read(lines: &str) -> Result<Trace, TraceError> {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("t.jsonl");
        std::fs::write(&path, format!("{HEADER}\n{lines}\n")).expect("a file");
        Trace::read(&path)
    }

    #[test]
    fn events_are_typed_and_others_left_out() {
        let trace = read(
            "{\"t_s\":0.05,\"robot\":1,\"seq\":0,\"event\":\"beep\"}\n\
             {\"t_s\":0.06,\"robot\":1,\"seq\":1,\"event\":\"distance\",\"device\":\"PSD\",\"distance_m\":null,\"measured_s\":0.06}\n\
             {\"t_s\":0.07,\"robot\":2,\"seq\":0,\"event\":\"stdout\",\"text\":\"hello\"}",
        )
        .expect("a trace");
        let distance = Event::Distance { device: "PSD".to_owned(), distance_m: None, measured_s: 0.06 };
        assert_eq!(trace.of_robot(1).collect::<Vec<_>>(), [&Entry { at: 0.06, robot: 1, event: distance }]);
        assert_eq!(trace.printed(2).collect::<Vec<_>>(), [(0.07, "hello")]);
        assert_eq!((trace.end, trace.digest.as_str()), (0.0, ""));
    }

    #[test]
    fn an_event_without_its_fields_is_told_with_its_line() {
        let error = read("{\"t_s\":0.05,\"robot\":1,\"seq\":0,\"event\":\"pose\",\"x_m\":1}").expect_err("no pose");
        assert!(error.to_string().contains("line 2: `pose`: missing field"), "{error}");
    }
}
