//! Recording of a run as MCAP, the file format that Foxglove and rerun open. Channels and schemas are in
//! `docs/mcap.md`.
//!
//! Foxglove's messages are Protocol Buffers; eyesim's own messages are JSON. Times are virtual, from the run's start.
//! Each complete slot is handed to the operating system before the next slot begins, in chunks that readers can recover
//! from a truncated file.

mod proto;
pub mod scene;
mod schema;

use std::collections::BTreeMap;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use mcap::records::{MessageHeader, Metadata};
use mcap::{McapError, WriteOptions, Writer};
use serde_json::{Value, json};
use sim_core::pose::Pose;
use sim_core::record::{Action, Digest, Event, Kind, KindSet, Record, WORLD};
use sim_core::time::Time;
use sim_core::{ObjectId, RobotId};
use sim_view::protocol::{Link, Point, Scene};

use super::file::{ExpectedFile, RecordFile};
use super::frame::{Frames, StoredCapture, StoredFrame, StoredScan};
use super::layer::{Layer, Shape};
use super::sink::{RecordError, Sink};
use schema::Content;

/// Initial contents of a recording.
pub struct InitialContents {
    /// Seed of the run.
    pub seed: u64,
    /// Length of a slot.
    pub slot: Time,
    /// Scene at the start.
    pub scene: Scene,
    /// Starting poses of the scene's robots, and the heights of their bodies, m, in the order of the scene.
    pub robots: Vec<(Pose, f64)>,
    /// Starting poses of the scene's movable objects, in the order of the scene.
    pub objects: Vec<Pose>,
    /// Source of images, scans and layers.
    pub frames: Arc<Frames>,
}

/// Output: a file, or memory in tests.
trait Output: Write + Seek + Send {}
impl<T: Write + Seek + Send> Output for T {}

/// Sink that writes a recording.
pub struct Mcap {
    /// `None` after the end.
    writer: Option<Writer<Box<dyn Output>>>,
    path: PathBuf,
    /// Channels by robot and topic.
    channels: BTreeMap<RobotId, BTreeMap<String, u16>>,
    sequence: u32,
    scene: Scene,
    frames: Arc<Frames>,
    /// Transforms that have changed in this slot.
    changed_transforms: Vec<Value>,
    /// Last places of the robots; those with legs or in the water are at the heights of their bodies.
    places: BTreeMap<RobotId, Point>,
    /// Links of the robots with legs.
    links: BTreeMap<RobotId, Vec<Link>>,
    /// Numbers of the next robot and the next object to be added.
    next_numbers: [u32; 2],
    /// True if messages have been written since the last flush.
    needs_flush: bool,
    /// Expected contents, which are checked at the end, if the recording is a file.
    expected_file: Option<Arc<ExpectedFile>>,
}

/// Time in Foxglove's format.
fn timestamp(Time(us): Time) -> Value {
    let us = us.max(0);
    json!({ "seconds": us / 1_000_000, "nanos": us % 1_000_000 * 1_000 })
}

impl Mcap {
    /// Creates the file `path`, or empties it, and writes the initial contents.
    ///
    /// # Errors
    /// [`RecordError::Write`] if the file cannot be written.
    pub fn create(path: &Path, contents: InitialContents) -> Result<Self, RecordError> {
        let file = RecordFile::create(path).map_err(|source| RecordError::write("recording", path, source))?;
        let expected_file = Some(file.expected_file());
        Ok(Self { expected_file, ..Self::new(Box::new(BufWriter::with_capacity(1 << 16, file)), path, contents)? })
    }

    fn new(out: Box<dyn Output>, path: &Path, contents: InitialContents) -> Result<Self, RecordError> {
        let InitialContents { seed, slot, scene, robots, objects, frames } = contents;
        // Compression would need a system library; chunks are written as a whole, so that the output need not be
        // seekable.
        let options = WriteOptions::new()
            .compression(None)
            .disable_seeking(true)
            .library(format!("eyesim {}", env!("CARGO_PKG_VERSION")));
        let writer = options.create(out).map_err(|error| RecordError::write("recording", path, io_error(error)))?;
        let next_numbers = [
            scene.robots.iter().map(|robot| robot.id).max().unwrap_or(0) + 1,
            scene.objects.iter().map(|object| object.id).max().unwrap_or(0) + 1,
        ];
        let (channels, changed_transforms) = (BTreeMap::new(), Vec::new());
        let path = path.to_owned();
        let mut mcap = Self {
            writer: Some(writer),
            path,
            channels,
            sequence: 0,
            scene,
            frames,
            changed_transforms,
            places: BTreeMap::new(),
            links: BTreeMap::new(),
            next_numbers,
            needs_flush: true,
            expected_file: None,
        };
        mcap.write_metadata("run", [("seed", seed.to_string()), ("slot_us", slot.0.to_string())])?;
        mcap.write_initial_contents(&robots, &objects)?;
        mcap.flush()?;
        Ok(mcap)
    }

    /// Writes the entities of all bodies, and the transforms of the bodies and their sensors.
    fn write_initial_contents(&mut self, robots: &[(Pose, f64)], objects: &[Pose]) -> Result<(), RecordError> {
        let at = Time::ZERO;
        let mut transforms = Vec::new();
        for (robot, (pose, height_m)) in self.scene.robots.iter().zip(robots) {
            let frame = scene::robot_frame(RobotId(robot.id));
            let mut place = scene::pose_in_space(pose);
            place.position_m[2] = *height_m;
            self.places.insert(RobotId(robot.id), place);
            transforms.push(scene::transform(at, scene::WORLD, &frame, &place));
            transforms.extend(scene::links(at, RobotId(robot.id), &robot.links, &robot.standing_rad));
            self.links.insert(RobotId(robot.id), robot.links.clone());
            let mounts = robot.sensors.iter().filter_map(|sensor| Some((&sensor.name, sensor.mount?)));
            transforms
                .extend(mounts.map(|(name, mount)| scene::transform(at, &frame, &format!("{frame}/{name}"), &mount)));
        }
        for (object, pose) in self.scene.objects.iter().zip(objects) {
            let frame = scene::object_frame(ObjectId(object.id));
            transforms.push(scene::transform(at, scene::WORLD, &frame, &scene::pose_in_space(pose)));
        }
        let entities = scene::all(&self.scene);
        self.write(Content::Scene, WORLD, "/scene", at, &json!({ "deletions": [], "entities": entities }))?;
        self.write(Content::Transforms, WORLD, "/tf", at, &json!({ "transforms": transforms }))
    }

    /// Writes a message to the channel `topic` of `robot`.
    fn write(
        &mut self,
        content: Content,
        robot: RobotId,
        topic: &str,
        at: Time,
        message: &impl serde::Serialize,
    ) -> Result<(), RecordError> {
        let channel_id = match self.channels.get(&robot).and_then(|of_robot| of_robot.get(topic)) {
            Some(channel) => *channel,
            None => self.add_channel(content, robot, topic)?,
        };
        let data = if content.is_foxglove() {
            serde_json::to_value(message).map(|message| proto::encode(content.name(), &message))
        } else {
            serde_json::to_vec(message)
        };
        let data = data.map_err(|error| self.error(error.into()))?;
        let log_time = u64::try_from(at.0).unwrap_or(0) * 1_000;
        let header = MessageHeader { channel_id, sequence: self.sequence, log_time, publish_time: log_time };
        self.sequence = self.sequence.wrapping_add(1);
        self.needs_flush = true;
        self.with_writer(|writer| writer.write_to_known_channel(&header, &data))
    }

    fn add_channel(&mut self, content: Content, robot: RobotId, topic: &str) -> Result<u16, RecordError> {
        let (encoding, schema, messages) = if content.is_foxglove() {
            ("protobuf", proto::descriptors(), "protobuf")
        } else {
            ("jsonschema", content.schema().to_string().into_bytes(), "json")
        };
        let name = if robot == WORLD { topic.to_owned() } else { format!("/robot/{}{topic}", robot.0) };
        let channel = self.with_writer(|writer| {
            let schema = writer.add_schema(content.name(), encoding, &schema)?;
            writer.add_channel(schema, &name, messages, &BTreeMap::new())
        })?;
        self.channels.entry(robot).or_default().insert(topic.to_owned(), channel);
        Ok(channel)
    }

    /// Writes a metadata record: values without a time.
    fn write_metadata<const N: usize>(&mut self, name: &str, facts: [(&str, String); N]) -> Result<(), RecordError> {
        let metadata = facts.into_iter().map(|(key, value)| (key.to_owned(), value)).collect();
        let metadata = Metadata { name: name.into(), metadata };
        self.with_writer(|writer| writer.write_metadata(&metadata))
    }

    fn flush(&mut self) -> Result<(), RecordError> {
        self.needs_flush = false;
        self.with_writer(Writer::flush)
    }

    fn with_writer<T>(
        &mut self,
        act: impl FnOnce(&mut Writer<Box<dyn Output>>) -> Result<T, McapError>,
    ) -> Result<T, RecordError> {
        let ended = || RecordError::write("recording", &self.path, io::Error::other("it has ended"));
        let done = act(self.writer.as_mut().ok_or_else(ended)?);
        done.map_err(|error| self.error(io_error(error)))
    }

    fn error(&self, source: io::Error) -> RecordError {
        RecordError::write("recording", &self.path, source)
    }

    fn move_to(&mut self, at: Time, child: &str, point: &Point) {
        self.changed_transforms.push(scene::transform(at, scene::WORLD, child, point));
    }

    /// Moves the robot in the plane; its height stays.
    fn place_robot(&mut self, at: Time, robot: RobotId, [x_m, y_m, phi_rad]: [f64; 3]) {
        let mut place = scene::upright(x_m, y_m, phi_rad);
        place.position_m[2] = self.places.get(&robot).map_or(0.0, |known| known.position_m[2]);
        self.places.insert(robot, place);
        self.move_to(at, &scene::robot_frame(robot), &place);
    }

    fn log(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        const INFO: u8 = 2;
        const WARNING: u8 = 3;
        const ERROR: u8 = 4;
        const FATAL: u8 = 5;
        let mut file = "";
        let (level, message) = match record.event {
            Event::ProgramStarted { program: "" } => return Ok(()),
            Event::ProgramStarted { program } => (INFO, format!("`{program}` begins")),
            Event::ProgramEnded { outcome, exit_code } => {
                let code = exit_code.map(|code| format!(", exit code {code}")).unwrap_or_default();
                (if outcome.is_failure() { ERROR } else { INFO }, format!("{}{code}", outcome.name()))
            }
            Event::Stdout { text } | Event::Reason { text } => (INFO, text.to_owned()),
            Event::Stderr { text } | Event::Hint { text } => (WARNING, text.to_owned()),
            Event::ProgramFailed { what, location, last_call } => {
                file = location;
                let call = if last_call.is_empty() { String::new() } else { format!(" after {last_call}") };
                (FATAL, format!("{what}{call}"))
            }
            _ => return Ok(()),
        };
        let (file, line) = match file.rsplit_once(':').map(|(file, line)| (file, line.parse::<u32>())) {
            Some((file, Ok(line))) => (file, line),
            _ => (file, 0),
        };
        let name = if record.robot == WORLD { scene::WORLD.into() } else { scene::robot_frame(record.robot) };
        let timestamp = timestamp(record.time);
        let message = json!({
            "timestamp": timestamp, "level": level, "message": message, "name": name, "file": file, "line": line,
        });
        self.write(Content::Log, WORLD, "/log", record.time, &message)
    }

    /// Writes the changes of the scene by an intervention that adds, removes or places a body.
    fn apply_intervention(&mut self, at: Time, action: &Action) -> Result<(), RecordError> {
        let (mut deletions, mut entities) = (Vec::new(), Vec::new());
        let deletion = |id: String| json!({ "timestamp": timestamp(at), "type": 0, "id": id });
        match action {
            Action::AddRobot { kind, x_m, y_m, phi_rad, .. } => {
                let id = self.next_number(0);
                self.place_robot(at, RobotId(id), [*x_m, *y_m, *phi_rad]);
                if let Some(model) = self.scene.robots.iter().find(|robot| robot.kind == *kind) {
                    entities.extend(scene::robot(&self.scene, id, model.id));
                    self.changed_transforms.extend(scene::links(at, RobotId(id), &model.links, &model.standing_rad));
                    self.links.insert(RobotId(id), model.links.clone());
                }
            }
            Action::AddObject { kind, x_m, y_m, phi_rad } => {
                let id = self.next_number(1);
                self.move_to(at, &scene::object_frame(ObjectId(id)), &scene::upright(*x_m, *y_m, *phi_rad));
                let model = self.scene.objects.iter().find(|object| object.kind == *kind).map(|object| object.id);
                entities.extend(model.and_then(|model| scene::object(&self.scene, id, model)));
            }
            Action::RemoveRobot { robot } => {
                let links = self.links.remove(&RobotId(*robot)).unwrap_or_default();
                deletions.push(deletion(scene::robot_frame(RobotId(*robot))));
                deletions.extend((0..links.len()).map(|link| deletion(scene::link_frame(RobotId(*robot), link))));
            }
            Action::RemoveObject { object } => deletions.push(deletion(scene::object_frame(ObjectId(*object)))),
            Action::PlaceRobot { robot, x_m, y_m, phi_rad } => {
                self.place_robot(at, RobotId(*robot), [*x_m, *y_m, *phi_rad]);
            }
            Action::PlaceObject { object, x_m, y_m, phi_rad } => {
                self.move_to(at, &scene::object_frame(ObjectId(*object)), &scene::upright(*x_m, *y_m, *phi_rad));
            }
            Action::Press { .. }
            | Action::Type { .. }
            | Action::SetNoise { .. }
            | Action::SwitchSensor { .. }
            | Action::HaltRobot { .. }
            | Action::StickSensor { .. }
            | Action::SwitchRadio { .. }
            | Action::Fault { .. }
            | Action::End {} => {}
        }
        if deletions.is_empty() && entities.is_empty() {
            return Ok(());
        }
        let update = json!({ "deletions": deletions, "entities": entities });
        self.write(Content::Scene, WORLD, "/scene", at, &update)
    }

    /// Returns the number of the next added robot (`which` 0) or object (1). Numbers are never reused.
    fn next_number(&mut self, which: usize) -> u32 {
        let id = self.next_numbers[which];
        self.next_numbers[which] += 1;
        id
    }

    fn write_scan(&mut self, at: Time, robot: RobotId, scan: &StoredScan) -> Result<(), RecordError> {
        let position = scene::point(&scan.world_from_scanner);
        let [start_angle, end_angle] = scan.bearings;
        let message = json!({
            "timestamp": timestamp(at),
            "frame_id": scene::WORLD,
            "pose": scene::pose(&position),
            "start_angle": start_angle,
            "end_angle": end_angle,
            "ranges": scan.metres,
            "intensities": [],
        });
        self.write(Content::Scan, robot, "/scan", at, &message)
    }

    fn write_frame(&mut self, at: Time, robot: RobotId, frame: &StoredFrame) -> Result<(), RecordError> {
        let topic = match frame.form {
            "depth" => "/camera/depth",
            "labels" => "/camera/labels",
            _ => "/camera",
        };
        let message = json!({
            "timestamp": timestamp(at),
            "frame_id": format!("{}/CAMERA", scene::robot_frame(robot)),
            "data": STANDARD.encode(&frame.png),
            "format": "png",
        });
        self.write(Content::Image, robot, topic, at, &message)
    }

    fn write_layer(&mut self, at: Time, robot: RobotId, name: &str, layer: &Layer) -> Result<(), RecordError> {
        const UINT8: u8 = 1;
        const FLOAT64: u8 = 8;
        let frame = &layer.world_from_frame;
        let field = |name: &str, offset: usize, kind: u8| json!({ "name": name, "offset": offset, "type": kind });
        match &layer.shape {
            Shape::Grid(grid) => {
                let corner = frame.compose(&Pose::new(grid.corner[0], grid.corner[1], 0.0));
                let message = json!({
                    "timestamp": timestamp(at),
                    "frame_id": scene::WORLD,
                    "pose": scene::pose(&scene::pose_in_space(&corner)),
                    "column_count": grid.columns,
                    "cell_size": { "x": grid.cell, "y": grid.cell },
                    "row_stride": grid.columns,
                    "cell_stride": 1,
                    "fields": [field("occupied", 0, UINT8)],
                    "data": STANDARD.encode(&grid.cells),
                });
                self.write(Content::Grid, robot, &format!("/grid/{name}"), at, &message)
            }
            Shape::Points(points) | Shape::Line(points) => {
                let bytes: Vec<u8> = points.as_flattened().iter().flat_map(|number| number.to_le_bytes()).collect();
                let message = json!({
                    "timestamp": timestamp(at),
                    "frame_id": scene::WORLD,
                    "pose": scene::pose(&scene::pose_in_space(frame)),
                    "point_stride": size_of::<[f64; 3]>(),
                    "fields": [field("x", 0, FLOAT64), field("y", 8, FLOAT64), field("z", 16, FLOAT64)],
                    "data": STANDARD.encode(bytes),
                });
                self.write(Content::Points, robot, &format!("/points/{name}"), at, &message)
            }
        }
    }
}

/// Returns the inner error of the operating system, if there is one.
fn io_error(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        error => io::Error::other(error),
    }
}

impl Sink for Mcap {
    fn interest(&self) -> KindSet {
        KindSet::ALL.without(Kind::Call)
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        let Record { time, robot, ref event, .. } = *record;
        match *event {
            Event::Pose { x_m, y_m, phi_rad, .. } | Event::Placed { x_m, y_m, phi_rad, .. } => {
                self.place_robot(time, robot, [x_m, y_m, phi_rad]);
            }
            Event::Posture { lift_m, joints_rad } => {
                // If the robot also moves in the plane, its pose event follows and replaces this transform.
                if let Some(place) = self.places.get_mut(&robot) {
                    place.position_m[2] = lift_m;
                    let place = *place;
                    self.move_to(time, &scene::robot_frame(robot), &place);
                }
                let links = self.links.get(&robot).map_or(&[][..], |links| links);
                let joints_rad: Vec<f64> = joints_rad.iter().collect();
                self.changed_transforms.extend(scene::links(time, robot, links, &joints_rad));
            }
            Event::Object { object, x_m, y_m, phi_rad, .. } | Event::ObjectPlaced { object, x_m, y_m, phi_rad, .. } => {
                self.move_to(time, &scene::object_frame(ObjectId(object)), &scene::upright(x_m, y_m, phi_rad));
            }
            Event::Intervention { action } => {
                if let Some(action) = action.action() {
                    self.apply_intervention(time, &action)?;
                }
            }
            _ => {}
        }
        let topic = match Content::of(event.kind()) {
            Some(Content::Log) => return self.log(record),
            Some(Content::Reading) => "/readings",
            Some(Content::Command) => "/commands",
            Some(Content::Contact) => "/contacts",
            Some(Content::Walk) => "/walk",
            Some(Content::Radio) => "/radio",
            Some(Content::Intervention) => "/interventions",
            _ => return Ok(()),
        };
        let content = Content::of(event.kind()).unwrap_or(Content::Reading);
        let channel_robot = if content == Content::Intervention { WORLD } else { robot };
        self.write(content, channel_robot, topic, time, record)
    }

    fn end_slot(&mut self, end: Time, _: Option<Digest>) -> Result<(), RecordError> {
        if !self.changed_transforms.is_empty() {
            let transforms = std::mem::take(&mut self.changed_transforms);
            self.write(Content::Transforms, WORLD, "/tf", end, &json!({ "transforms": transforms }))?;
        }
        for (at, robot, capture) in self.frames.clone().take() {
            match capture {
                StoredCapture::Scan(scan) => self.write_scan(at, robot, &scan)?,
                StoredCapture::Frame(frame) => self.write_frame(at, robot, &frame)?,
                StoredCapture::Layer(name, layer) => self.write_layer(at, robot, &name, &layer)?,
            }
        }
        if self.needs_flush { self.flush() } else { Ok(()) }
    }

    /// Writes the index, and the time and digest of the run's end.
    fn finish(&mut self, end: Time, digest: Digest) -> Result<(), RecordError> {
        self.write_metadata("end", [("t_s", end.seconds().to_string()), ("digest", digest.to_string())])?;
        self.with_writer(|writer| writer.finish().map(drop))?;
        let Some(writer) = self.writer.take() else { return Ok(()) };
        let flushed = writer.into_inner().flush();
        let checked =
            flushed.and_then(|()| self.expected_file.as_ref().map_or(Ok(()), |expected_file| expected_file.check()));
        checked.map_err(|error| self.error(error))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use sim_core::pose::Pose3;
    use sim_view::protocol;

    use super::super::trace::tests::every_event;
    use super::*;
    use crate::record::Sinks;
    use crate::record::frame::{Frame, Pixels};
    use crate::record::layer::Grid;
    use sim_core::record::{ActionText, FloatList, Journal, Recorder};

    const SLOT: Time = Time::from_millis(50);

    fn body() -> protocol::Body {
        protocol::Body { radius_m: 0.1, height_m: 0.2 }
    }

    /// Scene with a wall of two materials, a robot with a sensor, and an object.
    fn scene() -> Scene {
        let bytes: Vec<u8> = (0..18_u8).flat_map(|number| f32::from(number).to_le_bytes()).collect();
        let material = |colour| protocol::Material { triangles: 1, colour, image: None };
        Scene {
            run: 1,
            title: "t".into(),
            seed: "42".into(),
            slot_s: 0.05,
            bounds_m: [[0.0; 2], [1.0; 2]],
            images: vec![],
            meshes: vec![protocol::Mesh {
                positions: STANDARD.encode(bytes),
                normals: None,
                uvs: None,
                materials: vec![material([255, 0, 0]), material([0, 255, 0])],
            }],
            parts: vec![protocol::Part {
                mesh: 0,
                place: protocol::Attachment::World { what: "wall".into(), at: scene::upright(1.0, 2.0, 0.0) },
            }],
            ground: None,
            light: protocol::Light { towards: [0.0, 0.0, 1.0], ambient: 0.5, diffuse: 0.5, shadows: false },
            sky: protocol::Sky { horizon: [0; 3], zenith: [0; 3] },
            robots: vec![protocol::Robot {
                id: 1,
                name: "eve".into(),
                kind: "eve".into(),
                program: "maze.c".into(),
                colour: [0, 0, 255],
                body: body(),
                links: vec![],
                standing_rad: vec![],
                sensors: vec![protocol::Sensor {
                    name: "PSD_FRONT".into(),
                    kind: protocol::SensorKind::Psd,
                    mount: Some(scene::upright(0.1, 0.0, 0.0)),
                    range_m: None,
                    half_angle_rad: 0.0,
                }],
                camera: None,
                lcd: protocol::Lcd { size_px: [128, 64], has_colours: false },
            }],
            objects: vec![protocol::Object { id: 1, kind: "ball".into(), body: body() }],
            addable_types: protocol::AddableTypes::default(),
        }
    }

    fn create(path: &Path, frames: &Arc<Frames>) -> Mcap {
        let (robots, objects) = (vec![(Pose::new(0.5, 0.25, 0.0), 0.125)], vec![Pose::new(1.0, 1.0, 0.0)]);
        let frames = frames.clone();
        Mcap::create(path, InitialContents { seed: 42, slot: SLOT, scene: scene(), robots, objects, frames }).unwrap()
    }

    /// Records a slot with one event of each kind.
    fn record_everything(mcap: &mut Mcap, frames: &Frames, is_finished: bool) -> Digest {
        let (mut recorder, mut sinks) = (Recorder::new(42, SLOT, KindSet::ALL), Sinks::one(mcap));
        let mut world_journal = Journal::new(WORLD, true);
        for action in [
            r#"{"do":"add_robot","kind":"eve","program_of":null,"x_m":1.5,"y_m":2.5,"phi_rad":0.0}"#,
            r#"{"do":"add_object","kind":"ball","x_m":1.5,"y_m":2.5,"phi_rad":0.0}"#,
            r#"{"do":"remove_robot","robot":1}"#,
            r#"{"do":"remove_object","object":1}"#,
        ] {
            world_journal.record(Time(1_000), &Event::Intervention { action: ActionText(action) });
        }
        let mut journal = Journal::new(RobotId(1), true);
        for event in every_event() {
            journal.record(Time(2_350), &event);
        }
        let pixels = Pixels::Colour(&[255, 0, 0]);
        frames.write(RobotId(1), &Frame { number: 1, exposed: Time(2_000), size: [1, 1], pixels });
        let pixels = Pixels::Depth(&[f32::INFINITY]);
        frames.write(RobotId(1), &Frame { number: 1, exposed: Time(2_000), size: [1, 1], pixels });
        let layer = |at, shape| Arc::new(Layer { at: Time(at), world_from_frame: Pose::new(1.0, 2.0, 0.0), shape });
        let points = || Shape::Points(vec![[1.0, 2.0, 3.0]]);
        let grid = Grid { corner: [0.5, 0.25], cell: 0.1, columns: 2, rows: 1, cells: vec![100, 255] };
        frames.store_layer(RobotId(1), "map", layer(1_000, points()));
        frames.store_layer(RobotId(1), "map", layer(2_050, Shape::Grid(grid)));
        frames.store_layer(RobotId(1), "hits", layer(2_060, points()));
        frames.store_scan(RobotId(1), Time(2_100), || StoredScan {
            world_from_scanner: Pose3::IDENTITY,
            bearings: [1.0, -1.0],
            metres: vec![Some(0.5), None],
        });
        recorder.collect(&mut world_journal);
        recorder.collect(&mut journal);
        sinks.take_slot(&mut recorder, SLOT).unwrap();
        if is_finished {
            sinks.finish(SLOT, recorder.digest()).unwrap();
        }
        recorder.digest()
    }

    /// Topic, schema, time and content of each message.
    fn messages(bytes: &[u8], is_whole: bool) -> Vec<(String, Value, u64, Value)> {
        let options = if is_whole { Default::default() } else { mcap::read::Options::IgnoreEndMagic.into() };
        let stream = mcap::MessageStream::new_with_options(bytes, options).unwrap();
        let message = |message: Result<mcap::Message<'_>, McapError>| {
            let message = message.unwrap();
            let schema = message.channel.schema.as_ref().unwrap();
            let encodings = (schema.encoding.as_str(), message.channel.message_encoding.as_str());
            let (topic, time) = (message.channel.topic.clone(), message.log_time);
            if schema.name.starts_with("foxglove.") {
                assert_eq!(encodings, ("protobuf", "protobuf"));
                assert_eq!(schema.data, proto::descriptors());
                return (topic, json!({ "title": schema.name }), time, proto::decode(&schema.name, &message.data));
            }
            assert_eq!(encodings, ("jsonschema", "json"));
            let ours: Value = serde_json::from_slice(&schema.data).unwrap();
            assert_eq!(ours["title"], schema.name);
            (topic, ours, time, serde_json::from_slice(&message.data).unwrap())
        };
        stream.map(message).collect()
    }

    /// Checks a value against the part of JSON Schema that eyesim's schemas use; any other keyword fails the test.
    fn validate(schema: &Value, value: &Value, path: &str) {
        for (keyword, rule) in schema.as_object().unwrap() {
            let is_valid = match keyword.as_str() {
                "title" => true,
                "type" => match rule {
                    Value::Array(types) => types.iter().any(|kind| has_type(value, kind.as_str().unwrap())),
                    kind => has_type(value, kind.as_str().unwrap()),
                },
                "enum" => rule.as_array().unwrap().contains(value),
                "minimum" => value.as_f64().unwrap() >= rule.as_f64().unwrap(),
                "maximum" => value.as_f64().unwrap() <= rule.as_f64().unwrap(),
                "required" => rule.as_array().unwrap().iter().all(|name| value.get(name.as_str().unwrap()).is_some()),
                "additionalProperties" => {
                    assert_eq!(rule, false);
                    value.as_object().unwrap().keys().all(|name| schema["properties"].get(name).is_some())
                }
                "items" => {
                    for (number, item) in value.as_array().unwrap().iter().enumerate() {
                        validate(rule, item, &format!("{path}[{number}]"));
                    }
                    true
                }
                "properties" => {
                    for (name, property) in rule.as_object().unwrap() {
                        if let Some(value) = value.get(name) {
                            validate(property, value, &format!("{path}.{name}"));
                        }
                    }
                    true
                }
                other => panic!("{path}: `{other}` is not checked"),
            };
            assert!(is_valid, "{path}: {keyword} {rule} is not met by {value}");
        }
    }

    fn has_type(value: &Value, kind: &str) -> bool {
        match kind {
            "object" => value.is_object(),
            "array" => value.is_array(),
            "string" => value.is_string(),
            "number" => value.is_number(),
            "integer" => value.is_i64() || value.is_u64(),
            "boolean" => value.is_boolean(),
            "null" => value.is_null(),
            other => panic!("`{other}`"),
        }
    }

    #[test]
    fn recording_can_be_read_and_matches_its_schemas() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.mcap");
        let frames = Arc::new(Frames::default().storing());
        let digest = record_everything(&mut create(&path, &frames), &frames, true);
        let bytes = std::fs::read(&path).unwrap();
        let messages = messages(&bytes, true);
        for (topic, schema, _, content) in &messages {
            validate(schema, content, topic);
        }
        let topics: BTreeSet<&str> = messages.iter().map(|(topic, ..)| topic.as_str()).collect();
        let messages_of = |topic: &str| messages.iter().filter(|(name, ..)| name == topic).collect::<Vec<_>>();
        assert_eq!(
            topics.into_iter().collect::<Vec<_>>(),
            [
                "/interventions",
                "/log",
                "/robot/1/camera",
                "/robot/1/camera/depth",
                "/robot/1/commands",
                "/robot/1/contacts",
                "/robot/1/grid/map",
                "/robot/1/points/hits",
                "/robot/1/radio",
                "/robot/1/readings",
                "/robot/1/scan",
                "/robot/1/walk",
                "/scene",
                "/tf",
            ]
        );
        let names: BTreeSet<_> = messages
            .iter()
            .map(|(_, schema, ..)| schema["title"].clone())
            .collect::<Vec<_>>()
            .into_iter()
            .map(|name| name.as_str().unwrap().to_owned())
            .collect();
        assert_eq!(names, Content::ALL.iter().map(|content| content.name().to_owned()).collect());

        let initial_entities = &messages_of("/scene")[0].3["entities"];
        let ids: Vec<_> =
            initial_entities.as_array().unwrap().iter().map(|entity| entity["id"].as_str().unwrap()).collect();
        assert_eq!(ids, ["world", "robot/1", "object/1"]);
        let walls = &initial_entities[0]["triangles"];
        assert_eq!(walls[1]["points"][2], json!({ "x": 15.0, "y": 16.0, "z": 17.0 }));
        assert_eq!(walls[1]["color"], json!({ "r": 0.0, "g": 1.0, "b": 0.0, "a": 1.0 }));
        assert_eq!(walls[0]["pose"]["position"], json!({ "x": 1.0, "y": 2.0, "z": 0.0 }));
        assert_eq!(initial_entities[1]["cylinders"][0]["size"], json!({ "x": 0.2, "y": 0.2, "z": 0.2 }));
        assert_eq!(messages_of("/scene")[1].3["entities"][0]["id"], "robot/2");
        assert_eq!(messages_of("/scene")[3].3["deletions"][0]["id"], "robot/1");

        let changed_transforms = messages_of("/tf");
        assert_eq!((changed_transforms[0].2, changed_transforms[1].2), (0, 50_000_000));
        assert_eq!(changed_transforms[0].3["transforms"][0]["translation"], json!({ "x": 0.5, "y": 0.25, "z": 0.125 }));
        assert_eq!(changed_transforms[0].3["transforms"][1]["child_frame_id"], "robot/1/PSD_FRONT");
        let scan = messages_of("/robot/1/scan");
        assert_eq!((scan[0].2, &scan[0].3["ranges"]), (2_100_000, &json!([0.5, null])), "infinity is null in JSON");
        let grid = messages_of("/robot/1/grid/map");
        assert_eq!((grid.len(), grid[0].2), (1, 2_050_000), "the last of the slot");
        assert_eq!(grid[0].3["pose"]["position"], json!({ "x": 1.5, "y": 2.25, "z": 0.0 }));
        assert_eq!(STANDARD.decode(grid[0].3["data"].as_str().unwrap()).unwrap(), [100, 255]);
        let points = messages_of("/robot/1/points/hits");
        let coordinates: Vec<u8> = [1.0_f64, 2.0, 3.0].iter().flat_map(|number| number.to_le_bytes()).collect();
        assert_eq!(STANDARD.decode(points[0].3["data"].as_str().unwrap()).unwrap(), coordinates);
        let image = STANDARD.decode(messages_of("/robot/1/camera")[0].3["data"].as_str().unwrap()).unwrap();
        assert_eq!(image::load_from_memory(&image).unwrap().to_rgb8().as_raw(), &[255, 0, 0]);
        let contact = messages_of("/robot/1/contacts");
        assert_eq!((contact[0].2, &contact[0].3["with"]), (2_350_000, &json!({ "robot": 2 })));
        let fault = messages_of("/log").into_iter().find(|(.., log)| log["level"] == 5).unwrap();
        assert_eq!((&fault.3["file"], &fault.3["line"]), (&json!("maze.c"), &json!(88)));

        let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
        assert_eq!(summary.stats.unwrap().message_count, messages.len() as u64);
        let index = summary.metadata_indexes.iter().find(|index| index.name == "end").unwrap();
        let end = mcap::read::metadata(&bytes, index).unwrap();
        assert_eq!(end.metadata["digest"], digest.to_string());
    }

    #[test]
    fn robot_that_only_rises_is_shown_at_its_height() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.mcap");
        let mut mcap = create(&path, &Arc::new(Frames::default().storing()));
        let (mut recorder, mut sinks) = (Recorder::new(42, SLOT, KindSet::ALL), Sinks::one(&mut mcap));
        let mut journal = Journal::new(RobotId(1), false);
        journal.record(SLOT, &Event::Posture { lift_m: 0.75, joints_rad: FloatList::new(&[]) });
        recorder.collect(&mut journal);
        sinks.take_slot(&mut recorder, SLOT).unwrap();
        sinks.finish(SLOT, recorder.digest()).unwrap();
        let messages = messages(&std::fs::read(&path).unwrap(), true);
        let (.., moved) = messages.iter().rfind(|(topic, ..)| topic == "/tf").unwrap();
        assert_eq!(moved["transforms"][0]["child_frame_id"], "robot/1");
        assert_eq!(moved["transforms"][0]["translation"], json!({ "x": 0.5, "y": 0.25, "z": 0.75 }));
    }

    #[test]
    fn aborted_run_keeps_every_complete_slot() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.mcap");
        let frames = Arc::new(Frames::default().storing());
        let mut mcap = create(&path, &frames);
        record_everything(&mut mcap, &frames, false);
        // The file is read as another process would read it while the run is in progress.
        let aborted = std::fs::read(&path).unwrap();
        std::mem::forget(mcap);
        let whole = folder.path().join("whole.mcap");
        record_everything(&mut create(&whole, &frames), &frames, true);
        assert_eq!(messages(&aborted, false), messages(&std::fs::read(&whole).unwrap(), true));
    }

    #[test]
    fn full_disk_gives_an_error() {
        if !Path::new("/dev/full").exists() {
            println!("skipped: no /dev/full here");
            return;
        }
        let (robots, objects, frames) = (vec![], vec![], Arc::new(Frames::default().storing()));
        let contents = InitialContents { seed: 42, slot: SLOT, scene: scene(), robots, objects, frames };
        let message = Mcap::create(Path::new("/dev/full"), contents).err().unwrap().to_string();
        assert!(message.starts_with("cannot write the recording `/dev/full`: No space left"), "{message}");
    }

    #[test]
    fn page_documents_every_channel_and_event() {
        let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/mcap.md")).unwrap();
        for content in Content::ALL {
            let rows: Vec<_> =
                page.lines().filter(|line| line.contains(&format!("| `{}` |", content.name()))).collect();
            assert!(!rows.is_empty(), "docs/mcap.md has no channel of `{}`", content.name());
            for kind in Kind::ALL.iter().filter(|kind| Content::of(**kind) == Some(content)) {
                let is_there = content == Content::Log || rows[0].contains(&format!("`{}`", kind.name()));
                assert!(is_there, "docs/mcap.md: no `{}` of `{}`", kind.name(), content.name());
            }
        }
    }
}
