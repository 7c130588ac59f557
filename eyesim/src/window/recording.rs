//! Builds, from the trace of a run, the recording that a page replays.

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::io::BufRead;

use sim_core::build;
use sim_core::record::{Action, Kind};
use sim_core::spec::SceneSpec;
use sim_core::time::Time;
use sim_host::record::read::{Line, RecordedEvent, TraceError, TraceReader};
use sim_host::robios::lcd::{self, Lcd};
use sim_view::protocol::{DisplayChange, Postures, Recording, RobotHistory, Scene, Standing, StandingChange, Track};

use super::feed::{event_of, is_listed};
use super::planar;

/// Maximum deviation of a track from the recorded positions, in metres.
const TOLERANCE: f64 = 2e-3;

/// Maximum deviation of a track from the recorded headings, in radians.
const TOLERANCE_RAD: f64 = TAU / 360.0;

/// Maximum number of events kept of one kind.
const MAX_OF_KIND: u32 = 5_000;

/// Initial minimum time between two contents of a display, in seconds; it doubles when there are more than
/// [`MAX_DISPLAY_CHANGES`] contents.
const DISPLAY_PERIOD: f64 = 0.1;

/// Minimum time between two postures of a robot, in seconds, less a margin for rounding errors.
const POSTURE_PERIOD: f64 = 0.02 - 1e-9;

/// Maximum number of contents kept of a display.
const MAX_DISPLAY_CHANGES: usize = 4_000;

/// Builds the recording of a run from its trace and its scene; `spec` contains the robots' starting poses, which traces
/// lack.
///
/// # Errors
/// [`TraceError`] for an invalid line; a truncated trace is not an error, but yields a remark in the recording.
pub fn recording<R: BufRead>(
    mut trace: TraceReader<R>,
    mut scene: Scene,
    spec: &SceneSpec,
    mut remarks: Vec<String>,
) -> Result<Recording, TraceError> {
    let slot = Time(trace.header().slot_us).seconds();
    let mut builder = RecordingBuilder {
        slot,
        robots: scene.robots.iter().map(|robot| (robot.id, RobotHistoryBuilder::of(robot))).collect(),
        objects: scene.objects.iter().map(|object| (object.id, TrackBuilder::default())).collect(),
        events: Vec::new(),
        counts_by_kind: BTreeMap::new(),
        event_count: 0,
        next_robot: spec.robots.len() as u32 + 1,
        next_object: build::movable_objects(spec).count() as u32 + 1,
    };
    for robot in &spec.robots {
        let start = planar(&robot.start);
        builder.put_robot(robot.id.0, 0.0, [start.x_m, start.y_m, start.phi_rad]);
    }
    let (mut duration_s, mut digest) = (0.0_f64, None);
    while let Some(line) = trace.next_line()? {
        match line {
            Line::Event(event) => builder.add_event(event),
            Line::Slot { end, .. } => duration_s = duration_s.max(end.seconds()),
            Line::End { end, digest: run_digest } => {
                duration_s = duration_s.max(end.seconds());
                digest = Some(run_digest);
            }
        }
    }
    if digest.is_none() {
        remarks.push(format!("the trace was cut off after {duration_s:.3} s"));
    }
    let RecordingBuilder { robots, objects, events, event_count, .. } = builder;
    for (robot, builder) in scene.robots.iter_mut().zip(robots.values()) {
        robot.lcd.has_colours |= builder.display.is_large;
    }
    Ok(Recording {
        scene,
        duration_s,
        why: if digest.is_some() { "the run ended".to_owned() } else { "the trace was cut off".to_owned() },
        digest: digest.map(|digest| digest.to_string()).unwrap_or_default(),
        remarks,
        robots: robots.into_values().map(RobotHistoryBuilder::finish).collect(),
        objects: objects.into_values().map(TrackBuilder::finish).collect(),
        events_left_out: event_count - events.len() as u32,
        events,
    })
}

/// Collects the contents of a recording.
struct RecordingBuilder {
    slot: f64,
    robots: BTreeMap<u32, RobotHistoryBuilder>,
    objects: BTreeMap<u32, TrackBuilder>,
    events: Vec<sim_view::protocol::Event>,
    /// Number of events of each kind.
    counts_by_kind: BTreeMap<String, u32>,
    /// Number of events for pages, including the omitted ones.
    event_count: u32,
    /// Number of the next robot that a user adds.
    next_robot: u32,
    /// Number of the next object that a user adds.
    next_object: u32,
}

impl RecordingBuilder {
    fn add_event(&mut self, event: RecordedEvent) {
        let RecordedEvent { at, robot, kind, fields } = event;
        let t_s = at.seconds();
        self.move_bodies(t_s, robot, &kind, &fields);
        if let Some(builder) = robot.and_then(|robot| self.robots.get_mut(&robot)) {
            builder.add_event(t_s, &kind, &fields);
        }
        let event_kind = Kind::ALL.iter().find(|event_kind| event_kind.name() == kind);
        if event_kind.is_none_or(|kind| is_listed(*kind)) {
            self.event_count += 1;
            let kind_count = self.counts_by_kind.entry(kind.clone()).or_default();
            *kind_count += 1;
            if *kind_count <= MAX_OF_KIND {
                self.events.push(event_of(self.event_count, at, robot, &kind, fields));
            }
        }
    }

    /// Continues the tracks of bodies that the event moves.
    fn move_bodies(&mut self, t_s: f64, robot: Option<u32>, kind: &str, fields: &serde_json::Value) {
        let slot = self.slot;
        let object = fields["object"].as_u64().and_then(|object| u32::try_from(object).ok());
        let track = match kind {
            "pose" | "placed" => robot.and_then(|robot| self.robots.get_mut(&robot)).map(|builder| &mut builder.track),
            "object" | "object_placed" => object.and_then(|object| self.objects.get_mut(&object)),
            "intervention" => return self.intervene(t_s, &fields["action"]),
            _ => None,
        };
        let (Some(track), Some(pose)) = (track, pose_of(fields)) else { return };
        if matches!(kind, "placed" | "object_placed") { track.jump(t_s, pose) } else { track.push(t_s, pose, slot) }
    }

    /// Continues the tracks of bodies that a user intervention places, adds or removes.
    fn intervene(&mut self, t_s: f64, action: &serde_json::Value) {
        let Ok(action) = Action::from_json(action) else { return };
        match action {
            Action::PlaceRobot { robot, x_m, y_m, phi_rad } => self.put_robot(robot, t_s, [x_m, y_m, phi_rad]),
            Action::PlaceObject { object, x_m, y_m, phi_rad } => self.put_object(object, t_s, [x_m, y_m, phi_rad]),
            Action::AddRobot { x_m, y_m, phi_rad, .. } => {
                self.put_robot(self.next_robot, t_s, [x_m, y_m, phi_rad]);
                self.next_robot += 1;
            }
            Action::AddObject { x_m, y_m, phi_rad, .. } => {
                self.put_object(self.next_object, t_s, [x_m, y_m, phi_rad]);
                self.next_object += 1;
            }
            Action::RemoveRobot { robot } => {
                if let Some(builder) = self.robots.get_mut(&robot) {
                    builder.track.removed_s = Some(t_s);
                }
            }
            Action::RemoveObject { object } => {
                if let Some(track) = self.objects.get_mut(&object) {
                    track.removed_s = Some(t_s);
                }
            }
            _ => {}
        }
    }

    fn put_robot(&mut self, robot: u32, t_s: f64, pose: [f64; 3]) {
        if let Some(builder) = self.robots.get_mut(&robot) {
            builder.track.jump(t_s, pose);
        }
    }

    fn put_object(&mut self, object: u32, t_s: f64, pose: [f64; 3]) {
        if let Some(track) = self.objects.get_mut(&object) {
            track.jump(t_s, pose);
        }
    }
}

/// Position and heading, including whole turns, in the fields of an event.
fn pose_of(fields: &serde_json::Value) -> Option<[f64; 3]> {
    let number = |name: &str| fields[name].as_f64();
    let turns = number("turns").unwrap_or_default();
    Some([number("x_m")?, number("y_m")?, number("phi_rad")? + turns * TAU])
}

/// Collects the history of a robot.
#[derive(Default)]
struct RobotHistoryBuilder {
    track: TrackBuilder,
    postures: Postures,
    standings: Vec<StandingChange>,
    display: DisplayHistory,
}

impl RobotHistoryBuilder {
    fn of(robot: &sim_view::protocol::Robot) -> Self {
        let display = DisplayHistory { is_large: robot.lcd.has_colours, ..DisplayHistory::default() };
        Self { display, ..Self::default() }
    }

    fn add_event(&mut self, t_s: f64, kind: &str, fields: &serde_json::Value) {
        let mut add_standing =
            |standing| self.standings.push(StandingChange { t_s: round(t_s, 1e6), standing, why: String::new() });
        match kind {
            "program_started" if fields["program"] == "" => add_standing(Standing::NoProgram),
            "program_started" => add_standing(Standing::Running),
            "program_ended" => match fields["outcome"].as_str().unwrap_or_default() {
                "finished" => add_standing(Standing::Finished),
                "failed" | "timeout" => add_standing(Standing::Failed),
                "waiting" => add_standing(Standing::Waiting),
                _ => {}
            },
            "reason" => {
                if let Some(last) = self.standings.last_mut() {
                    last.why = fields["text"].as_str().unwrap_or_default().to_owned();
                }
            }
            "posture" => self.add_posture(t_s, fields),
            _ => self.display.add_event(t_s, kind, fields),
        }
    }

    /// Adds a posture if the last posture is at least [`POSTURE_PERIOD`] old.
    fn add_posture(&mut self, t_s: f64, fields: &serde_json::Value) {
        let (Some(lift_m), Some(joints)) = (fields["lift_m"].as_f64(), fields["joints_rad"].as_array()) else { return };
        let postures = &mut self.postures;
        if postures.t_s.last().is_some_and(|last| t_s - last < POSTURE_PERIOD) {
            return;
        }
        postures.t_s.push(round(t_s, 1e6));
        postures.lift_m.push(round(lift_m, 1e4));
        postures.joints_rad.extend(joints.iter().map(|angle| round(angle.as_f64().unwrap_or_default(), 1e4)));
    }

    fn finish(self) -> RobotHistory {
        RobotHistory {
            track: self.track.finish(),
            postures: self.postures,
            standings: self.standings,
            lcd: self.display.finish(),
        }
    }
}

/// Contents of a display over time.
#[derive(Default)]
struct DisplayHistory {
    classic: Lcd,
    /// Lines of a display that is larger than the classic one.
    lines: Vec<String>,
    /// Texts of its menu.
    menu: [String; 4],
    /// True for the display of RoBIOS-7, or once a text does not fit on the classic one.
    is_large: bool,
    display_changes: Vec<DisplayChange>,
    /// Minimum time between two contents, in seconds.
    period: f64,
}

impl DisplayHistory {
    fn add_event(&mut self, t_s: f64, kind: &str, fields: &serde_json::Value) {
        let number = |name: &str| fields[name].as_u64().unwrap_or_default() as usize;
        let text = fields["text"].as_str().unwrap_or_default();
        match kind {
            "lcd_text" => self.write(number("row"), number("column"), text),
            "lcd_clear" => {
                self.classic.clear();
                self.lines.clear();
            }
            "lcd_menu" => {
                let position = number("position");
                // A position beyond the menu is ignored.
                _ = self.classic.set_menu(position as i32, text.as_bytes());
                if let Some(entry) = position.checked_sub(1).and_then(|index| self.menu.get_mut(index)) {
                    *entry = text.replace('\n', " ");
                }
            }
            _ => return,
        }
        self.show(t_s);
    }

    fn write(&mut self, row: usize, column: usize, text: &str) {
        self.is_large |= row >= lcd::LINES || column + text.chars().count() > lcd::COLUMNS * lcd::LINES;
        if self.classic.set_position(row as i32, column as i32).is_ok() {
            self.classic.write(text.as_bytes());
        }
        for (line_offset, part) in text.lines().enumerate() {
            let (row, column) = (row + line_offset, if line_offset == 0 { column } else { 0 });
            if row >= MAX_ROWS {
                return;
            }
            self.lines.resize(self.lines.len().max(row + 1), String::new());
            let mut line: Vec<char> = self.lines[row].chars().collect();
            line.resize(line.len().max(column + part.chars().count()), ' ');
            part.chars().enumerate().for_each(|(index, letter)| line[column + index] = letter);
            self.lines[row] = line.into_iter().collect();
        }
    }

    fn show(&mut self, t_s: f64) {
        let lines = if self.is_large { self.large_lines() } else { self.classic.lines().to_vec() };
        self.period = self.period.max(DISPLAY_PERIOD);
        match self.display_changes.last_mut() {
            Some(last) if t_s - last.t_s < self.period => last.lines = lines,
            Some(last) if last.lines == lines => {}
            _ => self.display_changes.push(DisplayChange { t_s: round(t_s, 1e3), lines }),
        }
        if self.display_changes.len() > MAX_DISPLAY_CHANGES {
            self.period *= 2.0;
            let mut last_kept = f64::NEG_INFINITY;
            self.display_changes.retain(|change| {
                let is_kept = change.t_s - last_kept >= self.period;
                last_kept = if is_kept { change.t_s } else { last_kept };
                is_kept
            });
        }
    }

    /// Lines of text as on the display of RoBIOS-7; the last one is the menu, and empty without a menu.
    fn large_lines(&self) -> Vec<String> {
        let has_menu = self.menu.iter().any(|text| !text.is_empty());
        let menu = if has_menu { self.menu.join(" | ").trim_end().to_owned() } else { String::new() };
        self.lines.iter().cloned().chain([menu]).collect()
    }

    fn finish(self) -> Vec<DisplayChange> {
        self.display_changes
    }
}

/// Maximum number of rows, more than any display has.
const MAX_ROWS: usize = 256;

/// Collects the track of a body and drops redundant points. Keeps the range of slopes of the lines through the last
/// corner that pass all later points within the tolerance (swinging door, Bristol 1990).
#[derive(Default)]
struct TrackBuilder {
    corners: Vec<Corner>,
    /// The newest point, not yet a corner, and for each axis the range of slopes that all points since the last corner
    /// allow.
    open_segment: Option<(Corner, [[f64; 2]; 3])>,
    /// Time at which the body was removed, in seconds.
    removed_s: Option<f64>,
}

/// Point of a track: time and pose (x, y, heading).
#[derive(Clone, Copy)]
struct Corner {
    t_s: f64,
    pose: [f64; 3],
}

impl TrackBuilder {
    /// Adds `pose` at `t_s`. If the last point is older than 1.5 slots, the body has rested until one slot (of length
    /// `slot`) before `t_s`.
    fn push(&mut self, t_s: f64, pose: [f64; 3], slot: f64) {
        if let Some(last) = self.last()
            && t_s - last.t_s > 1.5 * slot
        {
            self.add(Corner { t_s: t_s - slot, pose: last.pose });
        }
        self.add(Corner { t_s, pose });
    }

    /// Places the body at `pose` at `t_s`, without motion in between.
    fn jump(&mut self, t_s: f64, pose: [f64; 3]) {
        if let Some(last) = self.last() {
            self.add(Corner { t_s, pose: last.pose });
        }
        self.close();
        self.corners.push(Corner { t_s, pose });
    }

    fn last(&self) -> Option<Corner> {
        self.open_segment.map(|(point, _)| point).or(self.corners.last().copied())
    }

    fn close(&mut self) {
        self.corners.extend(self.open_segment.take().map(|(point, _)| point));
    }

    fn add(&mut self, point: Corner) {
        let Some(corner) = self.corners.last() else { return self.corners.push(point) };
        let seconds = point.t_s - corner.t_s;
        if seconds <= 0.0 {
            return;
        }
        let slope = |axis: usize, tolerance: f64| (point.pose[axis] - corner.pose[axis] + tolerance) / seconds;
        let tolerance = [TOLERANCE, TOLERANCE, TOLERANCE_RAD];
        let new_slopes: [[f64; 2]; 3] =
            std::array::from_fn(|axis| [slope(axis, -tolerance[axis]), slope(axis, tolerance[axis])]);
        let slopes = match &self.open_segment {
            None => new_slopes,
            Some((_, allowed))
                if (0..3).all(|axis| (allowed[axis][0]..=allowed[axis][1]).contains(&slope(axis, 0.0))) =>
            {
                std::array::from_fn(|axis| {
                    [allowed[axis][0].max(new_slopes[axis][0]), allowed[axis][1].min(new_slopes[axis][1])]
                })
            }
            Some(_) => {
                self.close();
                return self.add(point);
            }
        };
        self.open_segment = Some((point, slopes));
    }

    fn finish(mut self) -> Track {
        self.close();
        let axis = |axis: usize| self.corners.iter().map(|corner| round(corner.pose[axis], 1e4)).collect();
        Track {
            t_s: self.corners.iter().map(|corner| round(corner.t_s, 1e6)).collect(),
            x_m: axis(0),
            y_m: axis(1),
            phi_rad: axis(2),
            until_s: self.removed_s,
        }
    }
}

/// Rounds to a multiple of 1 / `steps`, for short texts.
fn round(number: f64, steps: f64) -> f64 {
    (number * steps).round() / steps
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn large_display_has_long_lines_and_a_menu() {
        let mut display = DisplayHistory { is_large: true, ..DisplayHistory::default() };
        display.add_event(0.0, "lcd_text", &json!({"row": 0, "column": 0, "text": "wider than 16 columns"}));
        for (position, text) in [(1, "GO"), (3, "STOP"), (5, "none")] {
            display.add_event(1.0, "lcd_menu", &json!({"position": position, "text": text}));
        }
        display.add_event(2.0, "lcd_clear", &json!({}));
        let changes = display.finish();
        let lines: Vec<_> = changes.iter().map(|change| change.lines.join("/")).collect();
        assert_eq!(lines, ["wider than 16 columns/", "wider than 16 columns/GO |  | STOP |", "GO |  | STOP |"]);
    }
}
