//! What happens in a run, as pages are told: rare kinds of events as events, the others as the latest readings.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::mem::take;

use sim_core::RobotId;
use sim_core::time::Time;
use sim_view::protocol::{self, Reading};

use crate::record::digest::Digest;
use crate::record::event::{Event, Kind, KindSet, Record, WORLD};
use crate::record::log::Printable;
use crate::record::{RecordError, Sink};

/// Most events between two looks at the feed; what comes beyond is counted and left out, so that a run at full speed is not slowed.
const MOST_EVENTS: usize = 200;

/// Collects what there is to tell until somebody [takes](Feed::take_events) it.
#[derive(Default)]
pub struct Feed {
    events: Vec<protocol::Event>,
    /// Events so far, those that were left out too.
    count: u32,
    readings: BTreeMap<RobotId, BTreeMap<String, Value>>,
}

/// What was read of a device, or commanded.
#[derive(Clone, Copy)]
struct Value {
    value: Option<f64>,
    unit: &'static str,
    at: Time,
}

impl Feed {
    /// The events since the last time.
    pub fn take_events(&mut self) -> Vec<protocol::Event> {
        take(&mut self.events)
    }

    /// What the program of a robot has read and commanded last.
    pub fn readings(&self, robot: RobotId) -> Vec<Reading> {
        let of_robot = self.readings.get(&robot).into_iter().flatten();
        let reading = |(name, Value { value, unit, at }): (&String, &Value)| Reading {
            name: name.clone(),
            value: *value,
            unit: (*unit).to_owned(),
            at_s: at.seconds(),
        };
        of_robot.map(reading).collect()
    }

    fn keep(&mut self, record: &Record<'_>, name: &str, value: Option<f64>, unit: &'static str) {
        let readings = self.readings.entry(record.robot).or_default();
        let value = Value { value, unit, at: record.time };
        match readings.get_mut(name) {
            Some(place) => *place = value,
            None => drop(readings.insert(name.to_owned(), value)),
        }
    }

    /// Keeps what the event says of devices; false for an event of another kind.
    fn keep_readings(&mut self, record: &Record<'_>) -> bool {
        let mut keep = |name: &str, value: f64, unit| self.keep(record, name, Some(value), unit);
        match record.event {
            Event::Distance { device, distance_m, .. } => self.keep(record, device, distance_m, "m"),
            Event::Angle { device, angle_rad } => self.keep(record, device, angle_rad, "rad"),
            Event::Reading { device, value } | Event::Output { device, value } => keep(device, value as f64, ""),
            Event::Signal { device, signal, .. } => keep(&format!("{device} signal"), signal, ""),
            Event::Motor { device, percent } => keep(device, percent.into(), "%"),
            Event::Servo { device, position } => keep(device, position.into(), ""),
            Event::DriveSpeed { v_m_per_s, omega_rad_per_s } => {
                keep("commanded speed", v_m_per_s, "m/s");
                keep("commanded turning speed", omega_rad_per_s, "rad/s");
            }
            Event::Odometry { x_m, y_m, phi_rad } => {
                keep("odometry x", x_m, "m");
                keep("odometry y", y_m, "m");
                keep("odometry phi", phi_rad, "rad");
            }
            Event::OdometrySpeed { v_m_per_s, omega_rad_per_s } => {
                keep("odometry speed", v_m_per_s, "m/s");
                keep("odometry turning speed", omega_rad_per_s, "rad/s");
            }
            Event::Scan { nearest_m, bearing_rad, .. } => {
                self.keep(record, "LIDAR nearest", nearest_m, "m");
                self.keep(record, "LIDAR bearing", bearing_rad, "rad");
            }
            Event::Frame { frame, .. } => keep("CAMERA image", frame as f64, ""),
            _ => return false,
        }
        true
    }
}

/// Kinds of which pages are told by the last value alone.
const READINGS: [Kind; 12] = [
    Kind::Distance,
    Kind::Angle,
    Kind::Reading,
    Kind::Output,
    Kind::Signal,
    Kind::Motor,
    Kind::Servo,
    Kind::DriveSpeed,
    Kind::Odometry,
    Kind::OdometrySpeed,
    Kind::Scan,
    Kind::Frame,
];

/// Kinds that the scene and the display show.
const SHOWN: [Kind; 5] = [Kind::Pose, Kind::Object, Kind::LcdText, Kind::LcdClear, Kind::LcdGraphics];

/// True for kinds that pages are told one by one.
pub fn is_told(kind: Kind) -> bool {
    !READINGS.contains(&kind) && !SHOWN.contains(&kind)
}

impl Sink for Feed {
    fn interest(&self) -> KindSet {
        SHOWN.iter().fold(KindSet::ALL, |set, kind| set.without(*kind))
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        if !self.keep_readings(record) {
            self.count += 1;
            if self.events.len() < MOST_EVENTS {
                self.events.push(told(self.count, record));
            }
        }
        Ok(())
    }

    fn end_slot(&mut self, _: Time, _: Option<Digest>) -> Result<(), RecordError> {
        Ok(())
    }
}

/// An event as pages get it, with its number within the run.
pub fn told(number: u32, record: &Record<'_>) -> protocol::Event {
    let mut fields = serde_json::to_value(record).unwrap_or_default();
    if let Some(fields) = fields.as_object_mut() {
        ["t_s", "robot", "seq", "event"].iter().for_each(|name| drop(fields.remove(*name)));
    }
    protocol::Event {
        number,
        t_s: record.time.seconds(),
        robot: (record.robot != WORLD).then_some(record.robot.0),
        kind: record.event.kind().name().to_owned(),
        text: words(&record.event, &fields),
        fields,
    }
}

/// What happened, in words.
fn words(event: &Event<'_>, fields: &serde_json::Value) -> String {
    match event {
        Event::ProgramStarted { program: "" } => "stands there without a program".to_owned(),
        Event::ProgramStarted { program } => format!("`{}` begins", Printable(program)),
        Event::ProgramEnded { outcome, exit_code: None } => format!("its program ends: {}", outcome.name()),
        Event::ProgramEnded { outcome, exit_code: Some(code) } => {
            format!("its program ends: {}, exit code {code}", outcome.name())
        }
        Event::Contact { with, x_m, y_m, .. } => {
            let with = match with {
                crate::record::Obstacle::Wall => "a wall".to_owned(),
                crate::record::Obstacle::Robot(robot) => format!("r{robot}"),
                crate::record::Obstacle::Object(object) => format!("object {object}"),
            };
            format!("touches {with} at ({x_m:.3} m, {y_m:.3} m)")
        }
        Event::DriveStraight { distance_m, v_m_per_s } => {
            format!("is to drive {distance_m:.3} m straight at {v_m_per_s:.3} m/s")
        }
        Event::DriveTurn { angle_rad, .. } => format!("is to turn by {:.1} degrees", degrees(*angle_rad)),
        Event::DriveCurve { distance_m, angle_rad, .. } => {
            format!("is to drive {distance_m:.3} m on a curve of {:.1} degrees", degrees(*angle_rad))
        }
        Event::SetOdometry { x_m, y_m, phi_rad } => {
            format!("sets its odometry to ({x_m:.3} m, {y_m:.3} m, {:.1} degrees)", degrees(*phi_rad))
        }
        Event::LcdMenu { position, text } => format!("menu {position}: `{}`", Printable(text)),
        Event::Tone { frequency_hz, duration_s } => format!("plays {frequency_hz:.0} Hz for {duration_s:.2} s"),
        Event::Beep {} => "beeps".to_owned(),
        Event::Sample { length_bytes } => format!("plays a sample of {length_bytes} bytes"),
        Event::Key { key } => format!("takes {key}"),
        Event::SerialSent { port, data } => format!("sends {} bytes by {port}", data.len()),
        Event::SerialReceived { port, data } => format!("takes {} bytes from {port}", data.len()),
        Event::Stdout { text } | Event::Stderr { text } => Printable(text).to_string(),
        Event::Placed { by, x_m, y_m, .. } => format!("is put at ({x_m:.3} m, {y_m:.3} m) by r{by}"),
        Event::ObjectPlaced { object, by, x_m, y_m, .. } => {
            format!("object {object} is put at ({x_m:.3} m, {y_m:.3} m) by r{by}")
        }
        Event::RadioSent { message, to: Some(to), data, .. } => {
            format!("sends message {message} to r{to}, {} bytes", data.len())
        }
        Event::RadioSent { message, to: None, data, .. } => {
            format!("sends message {message} to all, {} bytes", data.len())
        }
        Event::RadioArrived { from, message, .. } => format!("message {message} of r{from} arrives"),
        Event::RadioLost { from, message, cause, .. } => format!("message {message} of r{from} is lost: {cause}"),
        Event::RadioReceived { from, message, .. } => format!("takes message {message} of r{from}"),
        Event::Fault { what, location, .. } if !location.is_empty() => format!("{what} at {location}"),
        Event::Fault { what, .. } => (*what).to_owned(),
        Event::Reason { text } | Event::Hint { text } => Printable(text).to_string(),
        Event::Call { function, arguments, result: "" } => format!("{function}({})", Printable(arguments)),
        Event::Call { function, arguments, result } => {
            format!("{function}({}) = {}", Printable(arguments), Printable(result))
        }
        Event::ControlStarted { .. } => "starts its speed controller".to_owned(),
        Event::ControlStopped {} => "stops its speed controller".to_owned(),
        Event::TimerAttached { timer, period_s } => format!("attaches timer {timer}, every {period_s:.3} s"),
        Event::TimerDetached { timer } => format!("detaches timer {timer}"),
        other => plain_words(other.kind(), fields),
    }
}

/// The fields by their names.
fn plain_words(kind: Kind, fields: &serde_json::Value) -> String {
    let mut words = kind.name().replace('_', " ");
    for (name, value) in fields.as_object().into_iter().flatten() {
        // Writing to a string cannot fail.
        _ = write!(words, ", {} {value}", name.replace('_', " "));
    }
    words
}

fn degrees(radians: f64) -> f64 {
    sim_core::unit::degrees_from_radians(radians)
}
