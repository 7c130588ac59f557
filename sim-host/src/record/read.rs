//! Reader of traces: line by line, or all contents that are needed to repeat a recorded run.
//!
//! For any file the result is a value or an error that names the line. The complete lines of a truncated trace
//! can be read.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read as _};
use std::path::{Path, PathBuf};

use serde::Deserialize;
use serde_json::Value;
use sim_core::record::{Action, Digest, Kind, Outcome};
use sim_core::time::Time;

use super::trace::{TRACE_SCHEMA, TraceHeader};
use super::zstd::{Frames, MAGIC};

/// Maximum length in bytes of a line that is accepted; longer than any line that is written.
const MAX_LINE: u64 = 1 << 26;

/// Maximum time in a trace, s; no run takes longer.
const MAX_SECONDS: f64 = 4e9;

/// Error when reading a trace.
#[derive(Debug, thiserror::Error)]
pub enum TraceError {
    /// The operating system cannot read the file.
    #[error("cannot read the trace `{}`: {source}", path.display())]
    Read {
        /// The file as the user named it.
        path: PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The file is not a trace.
    #[error("`{}` is not a trace: {why}", path.display())]
    NoTrace {
        /// The file as the user named it.
        path: PathBuf,
        /// Mistake in its first line.
        why: String,
    },
    /// The trace has the schema of another version of eyesim.
    #[error("`{}` is a trace of schema {schema}, made by eyesim {version}: this one reads schema {TRACE_SCHEMA}", path.display())]
    Schema {
        /// The file as the user named it.
        path: PathBuf,
        /// Schema of the trace.
        schema: u64,
        /// The version of the program that wrote it.
        version: String,
    },
    /// A line is invalid.
    #[error("`{}`, line {line}: {why}", path.display())]
    Line {
        /// The file as the user named it.
        path: PathBuf,
        /// Number of the line, from 1.
        line: u64,
        /// Mistake in the line.
        why: String,
    },
}

/// A line after the first.
#[derive(Clone, Debug, PartialEq)]
pub enum Line {
    /// An event.
    Event(RecordedEvent),
    /// The end of a slot with events.
    Slot {
        /// Time of the slot's end.
        end: Time,
        /// Digest of the run up to that time.
        digest: Digest,
    },
    /// The end of the run.
    End {
        /// Time of the end.
        end: Time,
        /// Digest of the run.
        digest: Digest,
    },
}

/// An event of a trace.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordedEvent {
    /// Virtual time.
    pub at: Time,
    /// Number of the robot; none for the world.
    pub robot: Option<u32>,
    /// Name of the event's kind, such as `pose`.
    pub kind: String,
    /// The whole line, a JSON object.
    pub fields: Value,
}

/// Reads a trace line by line.
pub struct TraceReader<R> {
    input: R,
    path: PathBuf,
    header: TraceHeader,
    version: String,
    digest_version: u64,
    line: u64,
    bytes: Vec<u8>,
    has_ended: bool,
}

/// Fields of every line.
#[derive(Deserialize)]
struct Head {
    event: String,
    t_s: f64,
    robot: Option<u32>,
    digest: Option<Digest>,
}

impl TraceReader<Box<dyn BufRead>> {
    /// Opens the trace `path`, which may be compressed or columnar.
    ///
    /// # Errors
    /// [`TraceError`] if it cannot be read or is not a trace.
    pub fn open(path: &Path) -> Result<Self, TraceError> {
        let text = open_text(path).map_err(|source| TraceError::Read { path: path.to_owned(), source })?;
        Self::new(text, path)
    }
}

/// Reads the text of the trace `path`, which may be compressed or columnar.
///
/// # Errors
/// The file cannot be read, or its compression is damaged.
pub fn read_text(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open_text(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn open_text(path: &Path) -> io::Result<Box<dyn BufRead>> {
    let mut file = BufReader::new(File::open(path)?);
    let start = file.fill_buf()?;
    if start.starts_with(b"PAR1") {
        #[cfg(feature = "parquet")]
        return super::columnar::open_text(file.into_inner());
        #[cfg(not(feature = "parquet"))]
        return Err(io::Error::new(io::ErrorKind::Unsupported, super::trace_file::PARQUET_ABSENT));
    }
    let is_compressed = start.starts_with(&MAGIC);
    Ok(if is_compressed { Box::new(BufReader::new(Frames::new(file))) } else { Box::new(file) })
}

impl<R: BufRead> TraceReader<R> {
    /// Reads the trace `input`; `path` is its name in error messages.
    ///
    /// # Errors
    /// [`TraceError`] if `input` cannot be read or is not a trace.
    pub fn new(input: R, path: &Path) -> Result<Self, TraceError> {
        let header = TraceHeader { seed: 0, slot_us: 0, robots: vec![], run: vec![], inputs: vec![], only: vec![] };
        let path = path.to_owned();
        let (version, digest_version, line) = (String::new(), 0, 0);
        let mut reader = Self { input, path, header, version, digest_version, line, bytes: vec![], has_ended: false };
        let no_trace =
            |reader: &Self, why: &str| TraceError::NoTrace { path: reader.path.clone(), why: why.to_owned() };
        match reader.read_line() {
            Ok(true) => {}
            Ok(false) => return Err(no_trace(&reader, "it is empty")),
            Err(TraceError::Line { why, .. }) => return Err(no_trace(&reader, &why)),
            Err(error) => return Err(error),
        }
        let value: Value = serde_json::from_slice(&reader.bytes)
            .map_err(|error| no_trace(&reader, &format!("its first line is not JSON: {error}")))?;
        if value["event"] != "header" {
            return Err(no_trace(&reader, "its first line is not a `header`"));
        }
        let version = value["eyesim_version"].as_str().unwrap_or("?").to_owned();
        // A trace with the first version of digests does not state the version.
        let digest_version = value["digest_version"].as_u64().unwrap_or(1);
        match value["schema"].as_u64() {
            Some(schema) if schema == u64::from(TRACE_SCHEMA) => {}
            Some(schema) => return Err(TraceError::Schema { path: reader.path, schema, version }),
            None => return Err(no_trace(&reader, "its header has no `schema`")),
        }
        let header: TraceHeader = serde_json::from_value(value)
            .map_err(|error| no_trace(&reader, &format!("its header is wrong: {error}")))?;
        if header.slot_us <= 0 {
            return Err(no_trace(&reader, "its header is wrong: a slot has a length"));
        }
        (reader.header, reader.version, reader.digest_version) = (header, version, digest_version);
        Ok(reader)
    }

    /// First line of the trace.
    pub fn header(&self) -> &TraceHeader {
        &self.header
    }

    /// Version of the program that wrote the trace.
    pub fn version(&self) -> &str {
        &self.version
    }

    /// Reads the next line; `None` after the last complete line.
    ///
    /// # Errors
    /// [`TraceError`] for an invalid line.
    pub fn next_line(&mut self) -> Result<Option<Line>, TraceError> {
        if !self.read_line()? {
            return Ok(None);
        }
        if self.has_ended {
            return Err(self.wrong("it comes after the end of the run"));
        }
        let is_complete = self.bytes.last() == Some(&b'\n');
        let value: Value = match serde_json::from_slice(&self.bytes) {
            Ok(value) => value,
            // The process was killed while it wrote this line.
            Err(_) if !is_complete => return Ok(None),
            Err(error) => return Err(self.wrong(&format!("it is not JSON: {error}"))),
        };
        let head =
            Head::deserialize(&value).map_err(|error| self.wrong(&format!("it is not a line of a trace: {error}")))?;
        if !(0.0..=MAX_SECONDS).contains(&head.t_s) {
            return Err(self.wrong(&format!("`t_s` {:?} is not a time: expected 0 to {MAX_SECONDS} seconds", head.t_s)));
        }
        let at = Time((head.t_s * 1e6).round() as i64);
        let digest = |this: &Self| head.digest.ok_or_else(|| this.wrong("it has no `digest`"));
        Ok(Some(match head.event.as_str() {
            "slot" => Line::Slot { end: at, digest: digest(self)? },
            "end" => {
                self.has_ended = true;
                Line::End { end: at, digest: digest(self)? }
            }
            _ => Line::Event(RecordedEvent { at, robot: head.robot, kind: head.event, fields: value }),
        }))
    }

    /// Error in the line that was read last.
    pub fn wrong(&self, why: &str) -> TraceError {
        TraceError::Line { path: self.path.clone(), line: self.line, why: why.to_owned() }
    }

    /// Reads a line; returns false after the last one.
    fn read_line(&mut self) -> Result<bool, TraceError> {
        self.bytes.clear();
        self.line += 1;
        let read = self.input.by_ref().take(MAX_LINE + 1).read_until(b'\n', &mut self.bytes);
        let length = read.map_err(|source| TraceError::Read { path: self.path.clone(), source })?;
        if length as u64 > MAX_LINE {
            return Err(self.wrong(&format!("it is longer than {MAX_LINE} bytes")));
        }
        Ok(length > 0)
    }
}

/// Contents of a trace that are needed to repeat the run and to compare the outcome.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    /// First line of the trace.
    pub header: TraceHeader,
    /// Version of the program that recorded it.
    pub version: String,
    /// [Version](sim_core::record::digest::VERSION) of its digests.
    pub digest_version: u64,
    /// User interventions, in order.
    pub interventions: Vec<(Time, Action)>,
    /// Ends of the slots with events, and the digests up to them.
    pub slots: Vec<(Time, Digest)>,
    /// End and digest of the run; none if the trace is truncated.
    pub end: Option<(Time, Digest)>,
    /// True if the user interrupted the run, with or without a recorded intervention.
    pub is_interrupted: bool,
}

impl Recorded {
    /// Reads the trace `path` as a whole.
    ///
    /// # Errors
    /// [`TraceError`] for a file that cannot be read or is not a trace.
    pub fn read(path: &Path) -> Result<Self, TraceError> {
        Self::of(TraceReader::open(path)?)
    }

    /// Reads the rest of a trace.
    ///
    /// # Errors
    /// [`TraceError`] for an invalid line.
    pub fn of<R: BufRead>(mut reader: TraceReader<R>) -> Result<Self, TraceError> {
        let (header, version, digest_version) =
            (reader.header().clone(), reader.version().to_owned(), reader.digest_version);
        let (interventions, slots) = (Vec::new(), Vec::new());
        let mut recorded =
            Self { header, version, digest_version, interventions, slots, end: None, is_interrupted: false };
        while let Some(line) = reader.next_line()? {
            match line {
                Line::Slot { end, digest } => {
                    if recorded.slots.last().is_some_and(|(last, _)| *last > end) {
                        return Err(reader.wrong("the slot ends before the one above it"));
                    }
                    recorded.slots.push((end, digest));
                }
                Line::End { end, digest } => recorded.end = Some((end, digest)),
                Line::Event(event) => recorded.add_event(&event).map_err(|why| reader.wrong(&why))?,
            }
        }
        Ok(recorded)
    }

    fn add_event(&mut self, event: &RecordedEvent) -> Result<(), String> {
        if event.kind == Kind::Intervention.name() {
            let action = Action::from_json(&event.fields["action"])
                .map_err(|error| format!("`action` is not an intervention: {error}"))?;
            if self.interventions.last().is_some_and(|(last, _)| *last > event.at) {
                return Err("it happened before the intervention above it".to_owned());
            }
            self.interventions.push((event.at, action));
        } else if event.kind == Kind::ProgramEnded.name() {
            self.is_interrupted |= event.fields["outcome"] == Outcome::Interrupted.name();
        }
        Ok(())
    }

    /// Length of a slot.
    pub fn slot(&self) -> Time {
        Time(self.header.slot_us)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str =
        r#"{"event":"header","schema":1,"eyesim_version":"0.1.0","seed":7,"slot_us":50000,"robots":[]}"#;
    const DIGEST: &str = "8e7fe502083cc57b79bdc315b2dbf4e4388a5816eb2d64b0613cd2d99cf256ad";

    fn read(text: impl AsRef<[u8]>) -> Result<Recorded, TraceError> {
        Recorded::of(TraceReader::new(text.as_ref(), Path::new("t.jsonl"))?)
    }

    fn message(text: impl AsRef<[u8]>) -> String {
        read(text).expect_err("no trace").to_string()
    }

    #[test]
    fn contents_to_repeat_a_run_are_read() {
        let press = r#"{"do":"press","robot":1,"key":"KEY1"}"#;
        let text = format!(
            "{HEADER}\n{{\"t_s\":0.05,\"seq\":0,\"event\":\"intervention\",\"action\":{press}}}\n\
             {{\"t_s\":0.06,\"robot\":1,\"seq\":0,\"event\":\"beep\"}}\n\
             {{\"event\":\"slot\",\"t_s\":0.1,\"digest\":\"{DIGEST}\"}}\n{{\"event\":\"end\",\"t_s\":0.1,\"digest\":\"{DIGEST}\"}}\n"
        );
        let recorded = read(&text).expect("a trace");
        assert_eq!((recorded.header.seed, recorded.slot()), (7, Time(50_000)));
        assert_eq!(recorded.interventions, [(Time(50_000), Action::Press { robot: 1, key: "KEY1".into() })]);
        let (end, digest) = recorded.end.expect("it is complete");
        assert_eq!((end, digest.to_string()), (Time(100_000), DIGEST.to_owned()));
        assert_eq!((&recorded.slots, recorded.is_interrupted), (&vec![(end, digest)], false));
        // Complete lines are read at any length of a truncated trace.
        for length in HEADER.len()..text.len() {
            let cut = read(&text[..length]).unwrap_or_else(|error| panic!("{length}: {error}"));
            assert!(cut.slots.len() <= 1 && (cut.end.is_none() || length == text.len() - 1), "{length}");
        }
    }

    #[test]
    fn other_files_give_an_error() {
        assert_eq!(message(""), "`t.jsonl` is not a trace: it is empty");
        assert_eq!(message("{}\n"), "`t.jsonl` is not a trace: its first line is not a `header`");
        assert!(message("robi eve.robi\n").starts_with("`t.jsonl` is not a trace: its first line is not JSON"));
        assert!(message([0xff, 0x00, b'\n']).starts_with("`t.jsonl` is not a trace: its first line is not JSON"));
        assert_eq!(
            message(HEADER.replace("\"schema\":1", "\"schema\":9")),
            "`t.jsonl` is a trace of schema 9, made by eyesim 0.1.0: this one reads schema 1"
        );
        for (old, new) in [("50000", "0"), ("50000", "-1"), ("50000", "NaN"), ("7", "-7"), ("[]", "3")] {
            let why = message(HEADER.replace(old, new));
            assert!(why.starts_with("`t.jsonl` is not a trace: "), "{old} to {new}: {why}");
        }
        let missing = Recorded::read(Path::new("no-such-trace.jsonl")).expect_err("there is none").to_string();
        assert!(missing.starts_with("cannot read the trace `no-such-trace.jsonl`: "), "{missing}");
    }

    #[test]
    fn error_names_the_invalid_line() {
        let line_2 = |line: &str| message(format!("{HEADER}\n{line}\n"));
        for (line, why) in [
            ("[", "it is not JSON"),
            ("{}", "it is not a line of a trace: missing field `event`"),
            ("[]", "it is not a line of a trace"),
            (r#"{"event":"pose"}"#, "it is not a line of a trace: missing field `t_s`"),
            (r#"{"event":"pose","t_s":NaN}"#, "it is not JSON"),
            (r#"{"event":"pose","t_s":null}"#, "it is not a line of a trace"),
            (r#"{"event":"pose","t_s":-1}"#, "`t_s` -1.0 is not a time"),
            (r#"{"event":"pose","t_s":1e300}"#, "`t_s` 1e300 is not a time"),
            (r#"{"event":"slot","t_s":1}"#, "it has no `digest`"),
            (r#"{"event":"slot","t_s":1,"digest":"12"}"#, "it is not a line of a trace: a digest has 64"),
            (r#"{"event":"intervention","t_s":1}"#, "`action` is not an intervention"),
            (r#"{"event":"intervention","t_s":1,"action":{"do":"fly"}}"#, "`action` is not an intervention"),
        ] {
            let found = line_2(line);
            assert!(found.starts_with(&format!("`t.jsonl`, line 2: {why}")), "{line}: {found}");
        }
        let slot = |seconds: f64| format!(r#"{{"event":"slot","t_s":{seconds:?},"digest":"{DIGEST}"}}"#);
        let unordered = message(format!("{HEADER}\n{}\n{}\n", slot(2.0), slot(1.0)));
        assert_eq!(unordered, "`t.jsonl`, line 3: the slot ends before the one above it");
        let end = slot(1.0).replace("slot", "end");
        let after = message(format!("{HEADER}\n{end}\n{end}\n"));
        assert_eq!(after, "`t.jsonl`, line 3: it comes after the end of the run");
    }

    #[test]
    fn endless_line_gives_an_error() {
        let endless = io::Cursor::new(HEADER).chain(io::Cursor::new("\n")).chain(io::repeat(b' '));
        let reader = TraceReader::new(BufReader::new(endless), Path::new("t.jsonl")).expect("a header");
        let why = Recorded::of(reader).expect_err("a line without an end").to_string();
        assert_eq!(why, format!("`t.jsonl`, line 2: it is longer than {MAX_LINE} bytes"));
    }
}
