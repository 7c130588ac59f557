//! The trace: one JSON object per line, streamed during the run. `docs/trace.md` describes its schema.
//!
//! The lines of a slot are written at the end of the slot. The lines of a compressed trace are written at the end of
//! the slot in which they fill a frame. There is no fsync: a power failure may lose the last seconds.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sim_core::time::Time;

use super::file::RecordFile;
use super::report::Input;
use super::sink::{RecordError, Sink};
use super::zstd;
use sim_core::record::{Digest, Kind, KindSet, Record, digest};

/// Version of the trace's schema.
pub const TRACE_SCHEMA: u32 = 1;

/// First line of a trace, without the versions of schema, eyesim and digest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TraceHeader {
    /// Seed of the run.
    pub seed: u64,
    /// Length of a slot, us.
    pub slot_us: i64,
    /// All robots in order of their ids.
    pub robots: Vec<TraceRobot>,
    /// Arguments of `eyesim run` that repeat the run: the scene, then every option that affects the results.
    #[serde(default)]
    pub run: Vec<String>,
    /// Every file known at the start that determines the run.
    #[serde(default)]
    pub inputs: Vec<Input>,
    /// Kinds of events, or groups of kinds, that the trace contains; empty for all.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub only: Vec<String>,
}

/// Names, given by the user, of the kinds of events that a trace contains.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TraceFilter(Vec<String>);

/// Kinds of the group `poses`.
const POSES: &[Kind] = &[
    Kind::Pose,
    Kind::Object,
    Kind::Placed,
    Kind::ObjectPlaced,
    Kind::Joint,
    Kind::Link,
    Kind::BodyHeight,
    Kind::Posture,
];

/// Kinds of the group `readings`.
const READINGS: &[Kind] = &[
    Kind::Distance,
    Kind::Compass,
    Kind::Reading,
    Kind::Odometry,
    Kind::OdometrySpeed,
    Kind::Scan,
    Kind::Signal,
    Kind::Image,
];

/// Kinds that every trace contains: without them a run cannot be repeated.
const ALWAYS: &[Kind] = &[Kind::Intervention, Kind::ProgramEnded];

impl TraceFilter {
    /// Parses names of kinds and of the groups `poses`, `readings` and `events` (all others), with commas between them.
    ///
    /// # Errors
    /// A name is unknown; the message lists the known names.
    pub fn parse(text: &str) -> Result<Self, String> {
        let words: Vec<String> = text.split(',').map(|word| word.trim().to_owned()).collect();
        match words.iter().find(|word| kinds_of(word).is_none()) {
            Some(unknown) => Err(format!(
                "`{unknown}` is neither a group (poses, readings, events) nor a kind of event: {}",
                Kind::ALL
                    .iter()
                    .filter(|kind| **kind != Kind::Call)
                    .map(|kind| kind.name())
                    .collect::<Vec<_>>()
                    .join(", ")
            )),
            None => Ok(Self(words)),
        }
    }

    /// The names.
    pub fn words(&self) -> &[String] {
        &self.0
    }
}

/// Kinds of the group or the kind with this name; `None` for an unknown name.
fn kinds_of(word: &str) -> Option<KindSet> {
    match word {
        "poses" => Some(KindSet::of(POSES)),
        "readings" => Some(KindSet::of(READINGS)),
        "events" => Some(POSES.iter().chain(READINGS).fold(KindSet::ALL, |set, kind| set.without(*kind))),
        _ => Kind::ALL.iter().find(|kind| kind.name() == word && **kind != Kind::Call).map(|kind| kind.set()),
    }
}

/// Kinds of a trace with this `only` in its header.
pub(super) fn kinds_of_trace(only: &[String]) -> KindSet {
    let kinds = only.iter().filter_map(|word| kinds_of(word));
    let kinds = kinds.reduce(KindSet::union).map_or(KindSet::ALL, |kinds| kinds.union(KindSet::of(ALWAYS)));
    kinds.without(Kind::Call)
}

/// A robot in the first line of a trace.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TraceRobot {
    /// Number of the robot.
    pub id: u32,
    /// Name of the robot's type.
    pub name: String,
    /// The robot's program as the sim file names it.
    pub program: String,
}

/// Sink that writes a trace.
///
/// If it is dropped before [`Sink::finish`], it writes the lines that it has not compressed yet.
pub struct Trace {
    out: BufWriter<Box<dyn Write + Send>>,
    path: PathBuf,
    has_new_lines: bool,
    kinds: KindSet,
    /// Lines that are not compressed yet; `None` for a trace of plain text.
    uncompressed: Option<Vec<u8>>,
}

/// Lines of a trace that are not events.
#[derive(Serialize)]
#[serde(tag = "event", rename_all = "snake_case")]
enum ControlLine<'a> {
    Header {
        schema: u32,
        eyesim_version: &'static str,
        digest_version: u32,
        #[serde(flatten)]
        header: &'a TraceHeader,
    },
    Slot {
        t_s: f64,
        digest: Digest,
    },
    End {
        t_s: f64,
        digest: Digest,
    },
}

impl<'a> ControlLine<'a> {
    fn header(header: &'a TraceHeader) -> Self {
        let eyesim_version = env!("CARGO_PKG_VERSION");
        Self::Header { schema: TRACE_SCHEMA, eyesim_version, digest_version: digest::VERSION, header }
    }
}

/// The first line of a trace, without its line ending.
#[cfg(feature = "parquet")]
pub(super) fn header_line(header: &TraceHeader) -> io::Result<String> {
    Ok(serde_json::to_string(&ControlLine::header(header))?)
}

impl Trace {
    /// Trace in `file`, which is at `path`. If the name ends with `.zst`, the trace is compressed, and lines are
    /// written at the end of the slot in which they fill a frame of 1 MiB of text.
    pub(super) fn of_file(file: RecordFile, path: &Path, header: &TraceHeader) -> Result<Self, RecordError> {
        let is_compressed = path.extension().is_some_and(|extension| extension == "zst");
        Self::begin(Box::new(file), path, header, is_compressed.then(Vec::new))
    }

    /// Trace that is written to `out`; `path` is its name in error messages.
    ///
    /// # Errors
    /// [`RecordError::Write`] if the first line cannot be written.
    pub fn new(out: Box<dyn Write + Send>, path: &Path, header: &TraceHeader) -> Result<Self, RecordError> {
        Self::begin(out, path, header, None)
    }

    fn begin(
        out: Box<dyn Write + Send>,
        path: &Path,
        header: &TraceHeader,
        uncompressed: Option<Vec<u8>>,
    ) -> Result<Self, RecordError> {
        let mut trace = Self {
            out: BufWriter::with_capacity(1 << 16, out),
            path: path.to_owned(),
            has_new_lines: false,
            kinds: kinds_of_trace(&header.only),
            uncompressed,
        };
        trace.write_line(&ControlLine::header(header))?;
        trace.flush()?;
        Ok(trace)
    }

    fn write_line(&mut self, line: &impl Serialize) -> Result<(), RecordError> {
        self.has_new_lines = true;
        let written = match &mut self.uncompressed {
            Some(text) => write_json(text, line),
            None => write_json(&mut self.out, line),
        };
        written.map_err(|source| self.error(source))
    }

    /// Compresses the lines that are not compressed yet to a frame, if they have at least `min_bytes` bytes.
    fn compress(&mut self, min_bytes: usize) -> Result<(), RecordError> {
        let Some(text) = self.uncompressed.as_mut().filter(|text| text.len() >= min_bytes) else { return Ok(()) };
        let frame = zstd::frame(text);
        text.clear();
        self.out.write_all(&frame).map_err(|source| self.error(source))
    }

    fn flush(&mut self) -> Result<(), RecordError> {
        self.has_new_lines = false;
        self.compress(zstd::FRAME)?;
        self.out.flush().map_err(|source| self.error(source))
    }

    fn error(&self, source: io::Error) -> RecordError {
        RecordError::write("trace", &self.path, source)
    }
}

impl Sink for Trace {
    fn interest(&self) -> KindSet {
        self.kinds
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        self.write_line(record)
    }

    fn needs_digests(&self) -> bool {
        true
    }

    fn end_slot(&mut self, end: Time, digest: Option<Digest>) -> Result<(), RecordError> {
        if let Some(digest) = digest {
            self.write_line(&ControlLine::Slot { t_s: end.seconds(), digest })?;
        }
        if self.has_new_lines { self.flush() } else { Ok(()) }
    }

    /// Writes the last line, which marks the trace as complete.
    fn finish(&mut self, end: Time, digest: Digest) -> Result<(), RecordError> {
        self.write_line(&ControlLine::End { t_s: end.seconds(), digest })?;
        self.compress(1)?;
        self.flush()
    }
}

impl Drop for Trace {
    fn drop(&mut self) {
        // The error is ignored: the run has ended early because of another error, which is reported.
        _ = self.compress(1);
    }
}

fn write_json(mut out: impl Write, line: &impl Serialize) -> io::Result<()> {
    serde_json::to_writer(&mut out, line)?;
    out.write_all(b"\n")
}

#[cfg(test)]
pub(super) mod tests {
    use std::sync::Arc;

    use parking_lot::Mutex;
    use sim_core::RobotId;

    use super::*;
    use crate::record::{Sinks, TraceFile};
    use sim_core::record::{ActionText, Event, FloatList, Journal, Obstacle, Outcome, Recorder};

    /// Shared memory, read by tests while the trace writes to it.
    #[derive(Clone, Default)]
    struct Shared(Arc<Mutex<Vec<u8>>>);

    impl Write for Shared {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().extend_from_slice(bytes);
            Ok(bytes.len())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Shared {
        fn text(&self) -> String {
            String::from_utf8(self.0.lock().clone()).unwrap()
        }
    }

    pub(in crate::record) fn header() -> TraceHeader {
        let robot = |id, name: &str| TraceRobot { id, name: name.into(), program: "maze.c".into() };
        TraceHeader {
            seed: 42,
            slot_us: 50_000,
            robots: vec![robot(1, "eve"), robot(2, "S4")],
            run: ["a.sim", "--seed", "42"].map(str::to_owned).to_vec(),
            inputs: vec![Input::new(Path::new("a.sim"), b"robi eve.robi")],
            only: Vec::new(),
        }
    }

    /// Angles of two joints.
    const JOINTS: [[u8; 8]; 2] = [0.5_f64.to_le_bytes(), (-0.25_f64).to_le_bytes()];

    /// One event of each kind.
    pub(in crate::record) fn every_event() -> Vec<Event<'static>> {
        vec![
            Event::ProgramStarted { program: "maze.c" },
            Event::ProgramEnded { outcome: Outcome::Failed, exit_code: Some(3) },
            Event::Pose { x_m: 0.5, y_m: -0.25, phi_rad: 1.5, turns: -1 },
            Event::Contact { at_s: 2.35, with: Obstacle::Robot(2), x_m: 0.5, y_m: 1.0 },
            Event::DriveSpeed { v_m_per_s: 0.3, omega_rad_per_s: -1.0 },
            Event::DriveStraight { distance_m: 0.4, v_m_per_s: 0.1 },
            Event::DriveTurn { angle_rad: 3.1, omega_rad_per_s: 1.0 },
            Event::DriveCurve { distance_m: 0.4, angle_rad: 0.7, v_m_per_s: 0.1 },
            Event::SetOdometry { x_m: 0.0, y_m: 1.0, phi_rad: -1.0 },
            Event::ControlStarted { v_gain: 7.0, v_reset_s: 0.3, omega_gain: 7.0, omega_reset_s: 0.1 },
            Event::ControlStopped {},
            Event::Motor { device: "MOTOR_LEFT", percent: -100 },
            Event::Servo { device: "SERVO1", position: 127 },
            Event::Output { device: "latch 0", value: 255 },
            Event::Distance { device: "PSD_FRONT", distance_m: None, measured_s: 0.06 },
            Event::Compass { device: "COMPASS", angle_rad: Some(0.5) },
            Event::Reading { device: "QUAD_LEFT", value: -12 },
            Event::Odometry { x_m: 0.1, y_m: 0.2, phi_rad: 0.3 },
            Event::OdometrySpeed { v_m_per_s: 0.1, omega_rad_per_s: 0.0 },
            Event::LcdText { row: 2, column: 0, text: "a \"b\"\n\u{e4}" },
            Event::LcdClear {},
            Event::LcdGraphics { function: "LCDLine", changed_pixels: 40 },
            Event::LcdMenu { position: 4, text: "END" },
            Event::Tone { frequency_hz: 440.0, duration_s: 0.2 },
            Event::Beep {},
            Event::Sample { length_bytes: 8000 },
            Event::Key { key: "KEY4" },
            Event::SerialSent { port: "SERIAL1", data: &[0, 255] },
            Event::SerialReceived { port: "SERIAL2", data: &[65] },
            Event::TimerAttached { timer: 1, period_s: 0.01 },
            Event::TimerDetached { timer: 1 },
            Event::Stdout { text: "hello" },
            Event::Object { object: 1, x_m: 1.5, y_m: 0.25, phi_rad: 0.5, turns: 2 },
            Event::Scan { points: 360, nearest_m: Some(0.25), bearing_rad: Some(-0.5), sum_mm: 1_234_567 },
            Event::Placed { by: 2, x_m: 1.5, y_m: 0.25, phi_rad: 0.5 },
            Event::ObjectPlaced { object: 1, by: 2, x_m: 1.5, y_m: 0.25, phi_rad: 0.5 },
            Event::Signal { device: "REFLECTANCE", signal: f64::INFINITY, measured_s: 0.06 },
            Event::Image {
                frame: 1,
                form: "colour",
                width_px: 320,
                height_px: 240,
                exposed_s: 0.05,
                hash: "af1349b9f5f9a1a6a0404dea36dcc9499bcb25c9adc112b7cc9a93cae41f3262",
            },
            Event::RadioSent { message: 1, to: Some(2), begins_s: Some(0.001), data: &[0, 255] },
            Event::RadioArrived { from: 2, message: 7, arrived_s: 0.002, bit_errors: 3 },
            Event::RadioLost { from: 2, message: 8, arrived_s: 0.002, cause: "packet" },
            Event::RadioReceived { from: 2, message: 7, data: &[65] },
            Event::Intervention { action: ActionText(r#"{"do":"press","robot":1,"key":"KEY1"}"#) },
            Event::Gait { gait: 2, name: "trot" },
            Event::LegSpeed { vx_m_per_s: 0.2, vy_m_per_s: -0.1, omega_rad_per_s: 0.5 },
            Event::StepHeight { height_m: 0.05 },
            Event::LegCorrection { leg: "LEFT", dx_m: 0.02, dy_m: 0.0, dz_m: 0.01 },
            Event::Joint { joint: "LEFT.knee", angle_rad: 0.5 },
            Event::Link {
                link: "LEFT.shank",
                x_m: 0.1,
                y_m: 0.2,
                z_m: -0.4,
                roll_rad: 0.0,
                pitch_rad: -0.5,
                yaw_rad: 0.0,
            },
            Event::BodyHeight { height_m: -0.01 },
            Event::Posture { lift_m: -0.01, joints_rad: FloatList::new(&JOINTS) },
            Event::Footfall { leg: "LEFT", x_m: 1.5, y_m: 0.25, z_m: 0.0 },
            Event::LegContact { part: "LEFT.shank", with: Obstacle::Terrain, x_m: 1.5, y_m: 0.25, z_m: 0.1 },
            Event::Stderr { text: "thread main panicked" },
            Event::ProgramFailed { what: "SIGSEGV", location: "maze.c:88", last_call: "KEYGet" },
            Event::Reason { text: "fault" },
            Event::Hint { text: "metres" },
            Event::Call { function: "OSWait", arguments: "5", result: "0" },
            Event::Forbidden { function: "SIMSetRobot" },
        ]
    }

    /// A trace with one event of each kind in its first slot.
    fn trace_of_everything() -> String {
        let shared = Shared::default();
        let mut trace = Trace::new(Box::new(shared.clone()), Path::new("t.jsonl"), &header()).unwrap();
        let mut journal = Journal::new(RobotId(1), true);
        let slot = Time::from_millis(50);
        let (mut recorder, mut sinks) = (Recorder::new(42, slot, KindSet::ALL), Sinks::one(&mut trace));
        for event in every_event() {
            journal.record(Time(2_350), &event);
        }
        recorder.collect(&mut journal);
        sinks.take_slot(&mut recorder, slot).unwrap();
        sinks.take_slot(&mut recorder, slot + slot).unwrap();
        sinks.finish(slot + slot, recorder.digest()).unwrap();
        shared.text()
    }

    #[test]
    fn line_of_every_kind() {
        assert_eq!(every_event().iter().map(Event::kind).collect::<Vec<_>>(), Kind::ALL);
        insta::assert_snapshot!(trace_of_everything());
    }

    #[test]
    fn every_line_is_a_json_object_with_an_event() {
        for line in trace_of_everything().lines() {
            let value: serde_json::Value = serde_json::from_str(line).unwrap();
            assert!(value["event"].is_string(), "{line}");
        }
    }

    #[test]
    fn slot_is_written_at_its_end() {
        let shared = Shared::default();
        let mut trace = Trace::new(Box::new(shared.clone()), Path::new("t.jsonl"), &header()).unwrap();
        assert_eq!(shared.text().lines().count(), 1);
        let slot = Time::from_millis(50);
        let (mut recorder, mut sinks) = (Recorder::new(42, slot, KindSet::ALL), Sinks::one(&mut trace));
        let mut journal = Journal::new(RobotId(1), false);
        journal.record(Time(1), &Event::Beep {});
        recorder.collect(&mut journal);
        sinks.take_slot(&mut recorder, slot).unwrap();
        assert_eq!(shared.text().lines().count(), 3);
    }

    #[test]
    fn full_disk_gives_an_error() {
        let Ok(full) = std::fs::File::create("/dev/full") else {
            println!("skipped: no /dev/full here");
            return;
        };
        let error = Trace::new(Box::new(full), Path::new("t.jsonl"), &header()).err().expect("the device is full");
        let message = error.to_string();
        assert!(message.starts_with("cannot write the trace `t.jsonl`: No space left"), "{message}");
    }

    #[test]
    fn disk_that_fills_up_gives_an_error_at_the_end_of_the_slot() {
        /// Device that accepts one write and is full afterwards.
        struct Full(bool);
        impl Write for Full {
            fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
                if std::mem::replace(&mut self.0, true) {
                    Err(io::ErrorKind::StorageFull.into())
                } else {
                    Ok(bytes.len())
                }
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let trace = Trace::new(Box::new(Full(false)), Path::new("t.jsonl"), &header()).unwrap();
        let (mut recorder, mut sinks) = (Recorder::new(42, Time(1), KindSet::ALL), Sinks::one(trace));
        let mut journal = Journal::new(RobotId(1), false);
        journal.record(Time(0), &Event::Beep {});
        recorder.collect(&mut journal);
        let message = sinks.take_slot(&mut recorder, Time(1)).unwrap_err().to_string();
        assert_eq!(message, "cannot write the trace `t.jsonl`: no storage space");
    }

    #[test]
    fn filter_selects_kinds_and_groups() {
        let kinds = |text: &str| kinds_of_trace(TraceFilter::parse(text).expect("a filter").words());
        let poses = kinds("poses, contact");
        for kind in [Kind::Pose, Kind::Object, Kind::Contact, Kind::Intervention, Kind::ProgramEnded] {
            assert!(poses.contains(kind), "{kind:?}");
        }
        assert!(![Kind::Stdout, Kind::Distance, Kind::Call].iter().any(|kind| poses.contains(*kind)));
        let all = kinds("poses,readings,events");
        assert!(Kind::ALL.iter().all(|kind| all.contains(*kind) == (*kind != Kind::Call)));
        assert_eq!(kinds_of_trace(&[]), KindSet::ALL.without(Kind::Call));
        for wrong in ["pose,posse", "", "call"] {
            let error = TraceFilter::parse(wrong).expect_err("no filter");
            assert!(error.contains("is neither a group (poses, readings, events)"), "{error}");
        }
    }

    #[test]
    fn compressed_trace_has_the_text_of_the_plain_one() {
        let folder = tempfile::tempdir().expect("a folder");
        let texts = ["a.jsonl", "a.jsonl.zst"].map(|name| {
            let path = folder.path().join(name);
            let mut recorder = Recorder::new(42, Time(50_000), KindSet::ALL);
            let mut sinks = Sinks::one(TraceFile::create(&path, &header()).expect("a trace"));
            let mut journal = Journal::new(RobotId(1), false);
            for event in every_event() {
                journal.record(Time(0), &event);
            }
            recorder.collect(&mut journal);
            sinks.take_slot(&mut recorder, Time(50_000)).expect("a slot");
            sinks.finish_record(&mut recorder, Time(50_000)).1.expect("an end");
            let bytes = std::fs::read(&path).expect("a file");
            assert_eq!(bytes.starts_with(&zstd::MAGIC), name.ends_with("zst"));
            crate::record::read::read_text(&path).expect("a trace")
        });
        assert!(texts[0].ends_with(b"}\n") && texts[0] == texts[1]);
    }

    #[test]
    fn page_documents_every_kind_and_field() {
        let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/trace.md")).unwrap();
        // The rows must be in the order of the kinds' numbers in the digest.
        let mut rows = page.lines();
        for kind in Kind::ALL {
            let heading = format!("| `{}` |", kind.name());
            let row = rows.find(|line| line.starts_with(&heading));
            let row = row.unwrap_or_else(|| panic!("docs/trace.md has no row of `{}` at its place", kind.name()));
            for field in kind.fields() {
                assert!(row.contains(&format!("`{field}`")), "docs/trace.md: no field `{field}` of `{}`", kind.name());
            }
        }
    }
}
