//! Collects the events of a run for the pages: rare kinds one by one, frequent kinds (readings and commands) as latest
//! values.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::mem::take;

use sim_core::RobotId;
use sim_core::time::Time;
use sim_view::protocol::{self, Reading};

use sim_core::record::{Digest, Event, Kind, KindSet, Record, WORLD};
use sim_host::record::log::Printable;
use sim_host::record::{RecordError, Sink};

/// Maximum number of events kept between two calls of [`Feed::take_events`]; further events are only counted, so that a
/// run at full speed is not slowed.
const MAX_EVENTS: usize = 200;

/// Sink that collects events until they are [taken](Feed::take_events), and the latest readings.
#[derive(Default)]
pub struct Feed {
    events: Vec<protocol::Event>,
    /// Number of events omitted since the last call of [`Feed::take_events`].
    omitted: u32,
    /// Number of events so far, including the omitted ones.
    count: u32,
    readings: BTreeMap<RobotId, BTreeMap<String, Value>>,
}

/// Latest reading of a device, or latest command to it.
#[derive(Clone, Copy)]
struct Value {
    value: Option<f64>,
    unit: &'static str,
    at: Time,
}

impl Feed {
    /// Takes the events since the last call, and the number of omitted ones.
    pub fn take_events(&mut self) -> (Vec<protocol::Event>, u32) {
        (take(&mut self.events), take(&mut self.omitted))
    }

    /// Latest readings and commands of the program of a robot.
    pub fn readings(&self, robot: RobotId) -> Vec<Reading> {
        let values = self.readings.get(&robot).into_iter().flatten();
        let reading = |(name, Value { value, unit, at }): (&String, &Value)| Reading {
            name: name.clone(),
            value: *value,
            unit: (*unit).to_owned(),
            at_s: at.seconds(),
        };
        values.map(reading).collect()
    }

    fn store(&mut self, record: &Record<'_>, name: &str, value: Option<f64>, unit: &'static str) {
        let readings = self.readings.entry(record.robot).or_default();
        let value = Value { value, unit, at: record.time };
        match readings.get_mut(name) {
            Some(slot) => *slot = value,
            None => drop(readings.insert(name.to_owned(), value)),
        }
    }

    /// Stores the readings in the event; returns false for an event of another kind.
    fn store_readings(&mut self, record: &Record<'_>) -> bool {
        let mut store = |name: &str, value: f64, unit| self.store(record, name, Some(value), unit);
        match record.event {
            Event::Distance { device, distance_m, .. } => self.store(record, device, distance_m, "m"),
            Event::Compass { device, angle_rad } => self.store(record, device, angle_rad, "rad"),
            Event::Reading { device, value } | Event::Output { device, value } => store(device, value as f64, ""),
            Event::Signal { device, signal, .. } => store(&format!("{device} signal"), signal, ""),
            Event::Motor { device, percent } => store(device, percent.into(), "%"),
            Event::Servo { device, position } => store(device, position.into(), ""),
            Event::DriveSpeed { v_m_per_s, omega_rad_per_s } => {
                store("commanded speed", v_m_per_s, "m/s");
                store("commanded turning speed", omega_rad_per_s, "rad/s");
            }
            Event::LegSpeed { vx_m_per_s, vy_m_per_s, omega_rad_per_s } => {
                store("commanded speed", vx_m_per_s, "m/s");
                store("commanded speed to the left", vy_m_per_s, "m/s");
                store("commanded turning speed", omega_rad_per_s, "rad/s");
            }
            Event::Gait { gait, .. } => store("commanded gait", gait.into(), ""),
            Event::StepHeight { height_m } => store("commanded step height", height_m, "m"),
            Event::LegCorrection { leg, dx_m, dy_m, dz_m } => {
                store(&format!("{leg} correction x"), dx_m, "m");
                store(&format!("{leg} correction y"), dy_m, "m");
                store(&format!("{leg} correction z"), dz_m, "m");
            }
            Event::Joint { joint, angle_rad } => store(joint, angle_rad, "rad"),
            Event::Link { link, x_m, y_m, z_m, .. } => {
                store(&format!("{link} x"), x_m, "m");
                store(&format!("{link} y"), y_m, "m");
                store(&format!("{link} z"), z_m, "m");
            }
            Event::BodyHeight { height_m } => store("body height", height_m, "m"),
            Event::Odometry { x_m, y_m, phi_rad } => {
                store("odometry x", x_m, "m");
                store("odometry y", y_m, "m");
                store("odometry phi", phi_rad, "rad");
            }
            Event::OdometrySpeed { v_m_per_s, omega_rad_per_s } => {
                store("odometry speed", v_m_per_s, "m/s");
                store("odometry turning speed", omega_rad_per_s, "rad/s");
            }
            Event::Scan { nearest_m, bearing_rad, .. } => {
                self.store(record, "LIDAR nearest", nearest_m, "m");
                self.store(record, "LIDAR bearing", bearing_rad, "rad");
            }
            Event::Image { frame, .. } => store("CAMERA image", frame as f64, ""),
            _ => return false,
        }
        true
    }
}

/// Kinds of events that are shown only by their latest value.
const READINGS: [Kind; 19] = [
    Kind::Distance,
    Kind::Compass,
    Kind::Reading,
    Kind::Output,
    Kind::Signal,
    Kind::Motor,
    Kind::Servo,
    Kind::DriveSpeed,
    Kind::Odometry,
    Kind::OdometrySpeed,
    Kind::Scan,
    Kind::Image,
    Kind::LegSpeed,
    Kind::Gait,
    Kind::StepHeight,
    Kind::LegCorrection,
    Kind::Joint,
    Kind::Link,
    Kind::BodyHeight,
];

/// Kinds that pages see in the scene and on the display.
const SHOWN: [Kind; 7] =
    [Kind::Pose, Kind::Object, Kind::LcdText, Kind::LcdClear, Kind::LcdGraphics, Kind::Posture, Kind::Footfall];

/// Returns true if pages get events of this kind one by one.
pub fn is_listed(kind: Kind) -> bool {
    !READINGS.contains(&kind) && !SHOWN.contains(&kind)
}

impl Sink for Feed {
    fn interest(&self) -> KindSet {
        SHOWN.iter().fold(KindSet::ALL, |set, kind| set.without(*kind))
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        if !self.store_readings(record) {
            self.count += 1;
            if self.events.len() < MAX_EVENTS {
                self.events.push(page_event(self.count, record));
            } else {
                self.omitted += 1;
            }
        }
        Ok(())
    }

    fn end_slot(&mut self, _: Time, _: Option<Digest>) -> Result<(), RecordError> {
        Ok(())
    }
}

/// Converts an event into the page's protocol; `number` is the number of the event in the run.
fn page_event(number: u32, record: &Record<'_>) -> protocol::Event {
    let fields = serde_json::to_value(record).unwrap_or_default();
    let robot = (record.robot != WORLD).then_some(record.robot.0);
    event_of(number, record.time, robot, record.event.kind().name(), fields)
}

/// Converts a line of a trace into an event of the page's protocol; `number` is the number of the event in the run.
pub fn event_of(
    number: u32,
    at: Time,
    robot: Option<u32>,
    kind: &str,
    mut fields: serde_json::Value,
) -> protocol::Event {
    if let Some(fields) = fields.as_object_mut() {
        ["t_s", "robot", "seq", "event"].iter().for_each(|name| drop(fields.remove(*name)));
    }
    let text = describe(kind, &Fields(&fields));
    protocol::Event { number, t_s: at.seconds(), robot, kind: kind.to_owned(), text, fields }
}

/// The fields of an event.
struct Fields<'a>(&'a serde_json::Value);

impl Fields<'_> {
    fn text(&self, name: &str) -> Printable<'_> {
        Printable(self.0[name].as_str().unwrap_or_default())
    }

    fn number(&self, name: &str) -> f64 {
        self.0[name].as_f64().unwrap_or_default()
    }

    fn degrees(&self, name: &str) -> f64 {
        sim_core::unit::degrees_from_radians(self.number(name))
    }

    fn length(&self, name: &str) -> usize {
        self.0[name].as_array().map_or(0, Vec::len)
    }

    fn position_text(&self) -> String {
        format!("({:.3} m, {:.3} m)", self.number("x_m"), self.number("y_m"))
    }

    fn obstacle(&self) -> String {
        let obstacle = &self.0["with"];
        match (obstacle["robot"].as_u64(), obstacle["object"].as_u64()) {
            (Some(robot), _) => format!("r{robot}"),
            (_, Some(object)) => format!("object {object}"),
            _ if obstacle == "terrain" => "the ground".to_owned(),
            _ => "a wall".to_owned(),
        }
    }
}

/// Description of an event.
fn describe(kind: &str, fields: &Fields<'_>) -> String {
    let text = |name| fields.text(name);
    let number = |name| fields.number(name);
    match kind {
        "program_started" if fields.0["program"] == "" => "has no program".to_owned(),
        "program_started" => format!("`{}` begins", text("program")),
        "program_ended" => match fields.0["exit_code"].as_i64() {
            Some(code) => format!("its program ends: {}, exit code {code}", text("outcome")),
            None => format!("its program ends: {}", text("outcome")),
        },
        "contact" => format!("touches {} at {}", fields.obstacle(), fields.position_text()),
        "touch" => {
            let position = format!("{} {:.3} m above the floor", fields.position_text(), number("z_m"));
            format!("touches {} with its {} at {position}", fields.obstacle(), text("part"))
        }
        "drive_straight" => {
            format!("starts a drive of {:.3} m straight at {:.3} m/s", number("distance_m"), number("v_m_per_s"))
        }
        "drive_turn" => format!("starts a turn of {:.1} degrees", fields.degrees("angle_rad")),
        "drive_curve" => {
            let (distance, angle) = (number("distance_m"), fields.degrees("angle_rad"));
            format!("starts a drive of {distance:.3} m on a curve of {angle:.1} degrees")
        }
        "set_odometry" => {
            format!("sets its odometry to {}, {:.1} degrees", fields.position_text(), fields.degrees("phi_rad"))
        }
        "control_started" => "starts its speed controller".to_owned(),
        "control_stopped" => "stops its speed controller".to_owned(),
        "lcd_menu" => format!("menu {}: `{}`", number("position"), text("text")),
        "tone" => format!("plays {:.0} Hz for {:.2} s", number("frequency_hz"), number("duration_s")),
        "beep" => "beeps".to_owned(),
        "sample" => format!("plays a sample of {} bytes", number("length_bytes")),
        "key" => format!("takes {}", text("key")),
        "serial_sent" => format!("sends {} bytes by {}", fields.length("data"), text("port")),
        "serial_received" => format!("takes {} bytes from {}", fields.length("data"), text("port")),
        "timer_attached" => format!("attaches timer {}, every {:.3} s", number("timer"), number("period_s")),
        "timer_detached" => format!("detaches timer {}", number("timer")),
        "stdout" | "stderr" | "reason" | "hint" => text("text").to_string(),
        "placed" => format!("is placed at {} by r{}", fields.position_text(), number("by")),
        "object_placed" => {
            format!("object {} is placed at {} by r{}", number("object"), fields.position_text(), number("by"))
        }
        "radio_sent" => {
            let to = fields.0["to"].as_u64().map_or("all".to_owned(), |to| format!("r{to}"));
            format!("sends message {} to {to}, {} bytes", number("message"), fields.length("data"))
        }
        "radio_arrived" => format!("message {} of r{} arrives", number("message"), number("from")),
        "radio_lost" => {
            format!("message {} of r{} is lost: {}", number("message"), number("from"), text("cause"))
        }
        "radio_received" => format!("takes message {} of r{}", number("message"), number("from")),
        "fault" if fields.0["location"] == "" => text("what").to_string(),
        "fault" => format!("{} at {}", text("what"), text("location")),
        "call" if fields.0["result"] == "" => format!("{}({})", text("function"), text("arguments")),
        "call" => format!("{}({}) = {}", text("function"), text("arguments"), text("result")),
        "intervention" => intervention(&fields.0["action"]),
        other => describe_fields(other, fields.0),
    }
}

/// Description of a user intervention.
fn intervention(action: &serde_json::Value) -> String {
    let fields = Fields(action);
    let number = |name| fields.number(name);
    match action["do"].as_str().unwrap_or_default() {
        "press" => format!("the user presses {} of r{}", fields.text("key"), number("robot")),
        "type" => format!("the user types `{}` to r{}", fields.text("line"), number("robot")),
        "place_robot" => format!("the user places r{} at {}", number("robot"), fields.position_text()),
        "place_object" => format!("the user places object {} at {}", number("object"), fields.position_text()),
        "set_noise" => {
            let robots = action["robot"].as_u64().map_or("all".to_owned(), |robot| format!("r{robot}"));
            format!("the user sets {} of {robots} to {}", fields.text("parameter"), number("value"))
        }
        "switch_sensor" => {
            let state = if action["on"] == true { "on" } else { "off" };
            format!("the user switches {} of r{} {state}", fields.text("sensor"), number("robot"))
        }
        "add_robot" => format!("the user adds a {} at {}", fields.text("kind"), fields.position_text()),
        "remove_robot" => format!("the user removes r{}", number("robot")),
        "add_object" => format!("the user adds a {} at {}", fields.text("kind"), fields.position_text()),
        "remove_object" => format!("the user removes object {}", number("object")),
        "end" => "the user ends the run".to_owned(),
        "fault" => format!("fault `{}`: {}", fields.text("name"), fault(&action["action"])),
        other => describe_fields(other, action),
    }
}

/// Description of the effect of a fault.
fn fault(action: &serde_json::Value) -> String {
    let fields = Fields(action);
    let robot = fields.number("robot");
    let is_on = action["on"] == true;
    match action["do"].as_str().unwrap_or_default() {
        "halt_robot" => format!("r{robot} halts"),
        "switch_sensor" => {
            format!("{} of r{robot} {}", fields.text("sensor"), if is_on { "works again" } else { "is off" })
        }
        "stick_sensor" => {
            format!("{} of r{robot} {}", fields.text("sensor"), if is_on { "sticks" } else { "works again" })
        }
        "switch_radio" => format!("the radio of r{robot} {}", if is_on { "works again" } else { "is silent" }),
        "set_noise" => format!("{} of r{robot} is {}", fields.text("parameter"), fields.number("value")),
        other => describe_fields(other, action),
    }
}

/// Description of other events: the kind, and the fields by their names.
fn describe_fields(kind: &str, fields: &serde_json::Value) -> String {
    let mut text = kind.replace('_', " ");
    for (name, value) in fields.as_object().into_iter().flatten() {
        // Writing to a string cannot fail.
        _ = write!(text, ", {} {value}", name.replace('_', " "));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use sim_core::record::{ActionText, Obstacle};

    fn record(event: Event<'_>) -> Record<'_> {
        Record { time: Time(1_500_000), robot: RobotId(2), sequence: Some(7), event }
    }

    #[test]
    fn frequent_kinds_become_readings_and_rare_ones_events() {
        let mut feed = Feed::default();
        for distance_m in [Some(0.5), None] {
            let event = Event::Distance { device: "PSD_FRONT", distance_m, measured_s: 1.0 };
            feed.record(&record(event)).expect("the feed accepts every record");
        }
        feed.record(&record(Event::Key { key: "KEY1" })).expect("the feed accepts every record");
        let readings = feed.readings(RobotId(2));
        assert_eq!((readings.len(), readings[0].value, readings[0].at_s), (1, None, 1.5), "the last one");
        let (events, omitted) = feed.take_events();
        assert_eq!(omitted, 0);
        assert_eq!((events.len(), events[0].number, &*events[0].text), (1, 1, "takes KEY1"));
        assert_eq!(events[0].fields, serde_json::json!({"key": "KEY1"}));
        assert!(feed.take_events().0.is_empty() && feed.readings(RobotId(1)).is_empty());
    }

    #[test]
    fn events_beyond_the_maximum_are_only_counted() {
        let mut feed = Feed::default();
        for _ in 0..MAX_EVENTS + 5 {
            feed.record(&record(Event::Beep {})).expect("the feed accepts every record");
        }
        let (events, omitted) = feed.take_events();
        assert_eq!((events.len(), omitted), (MAX_EVENTS, 5));
        feed.record(&record(Event::Beep {})).expect("the feed accepts every record");
        let (events, omitted) = feed.take_events();
        assert_eq!((events[0].number as usize, omitted), (MAX_EVENTS + 6, 0));
    }

    #[test]
    fn events_have_descriptions() {
        let description = |event| page_event(1, &record(event)).text;
        let contact = |with| Event::Contact { at_s: 1.0, with, x_m: 0.5, y_m: 1.25 };
        assert_eq!(description(contact(Obstacle::Wall)), "touches a wall at (0.500 m, 1.250 m)");
        assert_eq!(description(contact(Obstacle::Robot(3))), "touches r3 at (0.500 m, 1.250 m)");
        let touch = Event::LegContact { part: "LEFT.shank", with: Obstacle::Terrain, x_m: 0.5, y_m: 1.25, z_m: 0.1 };
        let position = "(0.500 m, 1.250 m) 0.100 m above the floor";
        assert_eq!(description(touch), format!("touches the ground with its LEFT.shank at {position}"));
        let sent = Event::RadioSent { message: 4, to: None, begins_s: None, data: &[1, 2] };
        assert_eq!(description(sent), "sends message 4 to all, 2 bytes");
        let press = ActionText(r#"{"do":"press","robot":1,"key":"KEY1"}"#);
        assert_eq!(description(Event::Intervention { action: press }), "the user presses KEY1 of r1");
        assert_eq!(description(Event::Call { function: "OSWait", arguments: "5", result: "" }), "OSWait(5)");
    }

    #[test]
    fn the_feed_receives_exactly_the_listed_kinds_and_the_readings() {
        let interest = Feed::default().interest();
        for kind in Kind::ALL {
            assert_eq!(interest.contains(*kind), is_listed(*kind) || READINGS.contains(kind), "{}", kind.name());
        }
    }
}
