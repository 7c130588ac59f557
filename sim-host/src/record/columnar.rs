//! The trace as a table in Parquet: one row for each line of the trace in JSON lines except the first, one column for
//! each field name. `docs/trace.md` describes the schema.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use parquet::file::reader::{FileReader as _, SerializedFileReader};
use parquet::record::reader::RowIter;
use parquet::record::{Field, Row};
use sim_core::record::{Cell, CellType, Digest, Event, Kind, KindSet, Obstacle, Record, WORLD};
use sim_core::time::Time;

use super::parquet::{TableWriter, Type, io_error};
use super::sink::{RecordError, Sink};
use super::trace::{TraceHeader, header_line, kinds_of_trace};

/// Key of the trace's first line in the metadata of the file.
const HEADER: &str = "header";

const T_S: usize = 0;
const ROBOT: usize = 1;
const SEQ: usize = 2;
const EVENT: usize = 3;
const DIGEST: usize = 4;

/// Columns of the table, and the columns of the fields of each kind.
struct Layout {
    columns: Vec<(String, Type)>,
    of_kinds: Vec<Vec<usize>>,
}

impl Layout {
    fn new() -> Self {
        let first = [("t_s", Type::Number), ("robot", Type::Integer), ("seq", Type::Integer), ("event", Type::Text)];
        let mut columns = [first.as_slice(), &[("digest", Type::Text)]].concat();
        let mut columns: Vec<_> = columns.drain(..).map(|(name, kind)| (name.to_owned(), kind)).collect();
        let mut column_of = |(name, cell): (&&str, &CellType)| {
            let known = columns.iter().position(|(known, _)| known == name);
            known.unwrap_or_else(|| {
                columns.push(((*name).to_owned(), type_of(*cell)));
                if *cell == CellType::Obstacle {
                    columns.push((format!("{name}_number"), Type::Integer));
                    return columns.len() - 2;
                }
                columns.len() - 1
            })
        };
        let mut columns_of =
            |kind: &Kind| kind.fields().iter().zip(Event::cell_types(*kind)).map(&mut column_of).collect::<Vec<_>>();
        let of_kinds = Kind::ALL.iter().map(&mut columns_of).collect();
        Self { columns, of_kinds }
    }
}

fn type_of(cell: CellType) -> Type {
    match cell {
        CellType::Number => Type::Number,
        CellType::Integer => Type::Integer,
        CellType::Text | CellType::Obstacle => Type::Text,
        CellType::Bytes => Type::Bytes,
        CellType::Numbers => Type::Numbers,
    }
}

/// Sink that writes a trace as a table.
///
/// If the sink is dropped before [`Sink::finish`], it completes the file without the row `end`.
pub struct ColumnarTrace {
    table: TableWriter<Box<dyn Write + Send>>,
    layout: Layout,
    path: PathBuf,
    kinds: KindSet,
    /// False after an error or the end.
    is_open: bool,
}

impl ColumnarTrace {
    /// Begins a trace in `out`; `path` is its name in error messages.
    ///
    /// # Errors
    /// [`RecordError::Write`] if `out` cannot be written.
    pub fn new(out: Box<dyn Write + Send>, path: &Path, header: &TraceHeader) -> Result<Self, RecordError> {
        let layout = Layout::new();
        let begin = || {
            let mut table = TableWriter::new(out, &layout.columns)?;
            table.add_metadata(HEADER, header_line(header)?);
            Ok(table)
        };
        let table = begin().map_err(|source| RecordError::write("trace", path, source))?;
        Ok(Self { table, layout, path: path.to_owned(), kinds: kinds_of_trace(&header.only), is_open: true })
    }

    fn checked(&mut self, written: io::Result<()>) -> Result<(), RecordError> {
        self.is_open &= written.is_ok();
        written.map_err(|source| RecordError::write("trace", &self.path, source))
    }

    /// Writes the row of the end of a slot or of the run.
    fn end_row(&mut self, event: &str, at: Time, digest: Digest) -> Result<(), RecordError> {
        self.table.number(T_S, at.seconds());
        self.table.text(EVENT, event);
        self.table.text(DIGEST, &digest.to_string());
        let written = self.table.end_row();
        self.checked(written)
    }
}

impl Sink for ColumnarTrace {
    fn interest(&self) -> KindSet {
        self.kinds
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        // A table with half a row cannot be completed.
        let was_open = std::mem::replace(&mut self.is_open, false);
        let table = &mut self.table;
        let kind = record.event.kind();
        table.number(T_S, record.time.seconds());
        if record.robot != WORLD {
            table.integer(ROBOT, record.robot.0.into());
        }
        if let Some(sequence) = record.sequence {
            table.integer(SEQ, sequence.cast_signed());
        }
        table.text(EVENT, kind.name());
        let mut columns = self.layout.of_kinds[kind as usize].iter();
        record.event.for_each_cell(|cell| {
            let Some(&column) = columns.next() else { unreachable!("the layout has a column for each field") };
            match cell {
                Cell::Null => {}
                Cell::Number(number) => table.number(column, number),
                Cell::Integer(integer) => table.integer(column, integer),
                Cell::Text(text) => table.text(column, text),
                Cell::Bytes(bytes) => table.bytes(column, bytes),
                Cell::Numbers(numbers) => table.numbers(column, numbers.iter()),
                Cell::Obstacle(obstacle) => {
                    let (name, number) = match obstacle {
                        Obstacle::Wall => ("wall", None),
                        Obstacle::Terrain => ("terrain", None),
                        Obstacle::Robot(number) => ("robot", Some(number)),
                        Obstacle::Object(number) => ("object", Some(number)),
                    };
                    table.text(column, name);
                    number.iter().for_each(|number| table.integer(column + 1, i64::from(*number)));
                }
            }
        });
        let written = table.end_row();
        self.is_open = was_open;
        self.checked(written)
    }

    fn needs_digests(&self) -> bool {
        true
    }

    fn end_slot(&mut self, end: Time, digest: Option<Digest>) -> Result<(), RecordError> {
        digest.map_or(Ok(()), |digest| self.end_row("slot", end, digest))
    }

    fn finish(&mut self, end: Time, digest: Digest) -> Result<(), RecordError> {
        self.end_row("end", end, digest)?;
        let written = self.table.finish();
        self.checked(written)?;
        self.is_open = false;
        Ok(())
    }
}

impl Drop for ColumnarTrace {
    fn drop(&mut self) {
        if self.is_open {
            // The run has another error, which is reported.
            _ = self.table.finish();
        }
    }
}

/// Reads a trace in Parquet as the text of the same trace in JSON lines.
pub struct Lines {
    rows: RowIter<'static>,
    /// For each column of `layout`, the index of the file's column with its name; `None` if the file has none.
    columns: Vec<Option<usize>>,
    layout: Layout,
    /// Lines that are not read yet.
    text: io::Cursor<Vec<u8>>,
}

impl Lines {
    /// Opens the trace in `file`.
    ///
    /// # Errors
    /// If the file cannot be read or is not a trace.
    pub fn open(file: File) -> io::Result<Self> {
        let reader = SerializedFileReader::new(file).map_err(|error| damaged(io_error(error)))?;
        let metadata = reader.metadata().file_metadata();
        let header = metadata.key_value_metadata().and_then(|entries| entries.iter().find(|entry| entry.key == HEADER));
        let Some(header) = header.and_then(|entry| entry.value.as_deref()) else {
            return Err(damaged("it has no header"));
        };
        let layout = Layout::new();
        let fields = metadata.schema().get_fields();
        let columns = layout.columns.iter().map(|(name, _)| fields.iter().position(|field| field.name() == name));
        let (columns, text) = (columns.collect(), io::Cursor::new(format!("{header}\n").into_bytes()));
        Ok(Self { rows: reader.into_iter(), columns, layout, text })
    }

    /// Writes the line of `row`.
    fn write_line(&self, row: &Row, out: &mut Vec<u8>) -> io::Result<()> {
        let fields: Vec<&Field> = row.get_column_iter().map(|(_, field)| field).collect();
        let field = |column: usize| {
            self.columns[column].and_then(|column| fields.get(column)).map_or(&Field::Null, |field| *field)
        };
        let Field::Str(event) = field(EVENT) else { return Err(damaged("a row has no event")) };
        let mut line = Line { out, separator: "{" };
        if event == "slot" || event == "end" {
            [("event", EVENT), ("t_s", T_S), ("digest", DIGEST)]
                .into_iter()
                .try_for_each(|(name, column)| line.entry(name, field(column)))?;
            return line.end();
        }
        let kind =
            Kind::ALL.iter().find(|kind| kind.name() == event).ok_or_else(|| damaged("a row has an unknown event"))?;
        for (name, column) in [("t_s", T_S), ("robot", ROBOT), ("seq", SEQ), ("event", EVENT)] {
            if *field(column) != Field::Null {
                line.entry(name, field(column))?;
            }
        }
        for (name, column) in kind.fields().iter().zip(&self.layout.of_kinds[*kind as usize]) {
            match field(*column) {
                Field::Str(json) if *kind == Kind::Intervention => line.raw(name, json)?,
                Field::Str(obstacle) if *name == "with" && *field(column + 1) != Field::Null => {
                    line.raw(name, &format!("{{\"{obstacle}\":{}}}", field(column + 1)))?;
                }
                value => line.entry(name, value)?,
            }
        }
        line.end()
    }
}

/// A JSON object that is being written.
struct Line<'a> {
    out: &'a mut Vec<u8>,
    separator: &'static str,
}

impl Line<'_> {
    fn raw(&mut self, name: &str, json: &str) -> io::Result<()> {
        write!(self.out, "{}\"{name}\":{json}", self.separator)?;
        self.separator = ",";
        Ok(())
    }

    fn entry(&mut self, name: &str, value: &Field) -> io::Result<()> {
        self.raw(name, "")?;
        match value {
            Field::Null => self.out.write_all(b"null")?,
            Field::Double(number) => serde_json::to_writer(&mut self.out, number)?,
            Field::Long(integer) => serde_json::to_writer(&mut self.out, integer)?,
            Field::Str(text) => serde_json::to_writer(&mut self.out, text)?,
            Field::Bytes(bytes) => serde_json::to_writer(&mut self.out, bytes.data())?,
            Field::ListInternal(list) => {
                let number = |field: &Field| if let Field::Double(number) = field { Some(*number) } else { None };
                let numbers: Vec<Option<f64>> = list.elements().iter().map(number).collect();
                serde_json::to_writer(&mut self.out, &numbers)?;
            }
            _ => return Err(damaged("a column has another type than in a trace")),
        }
        Ok(())
    }

    fn end(self) -> io::Result<()> {
        self.out.write_all(b"}\n")
    }
}

/// Calls `read` and converts a panic to an error: the reader of the Parquet crate panics on some damaged files.
fn guarded<T>(read: impl FnOnce() -> io::Result<T>) -> io::Result<T> {
    catch_unwind(AssertUnwindSafe(read)).unwrap_or_else(|_| Err(damaged("its content is damaged")))
}

fn damaged(why: impl std::fmt::Display) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, format!("it is a Parquet file, but no complete trace: {why}"))
}

impl Read for Lines {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.text.fill_buf()?.is_empty()
            && let Some(row) = guarded(|| Ok(self.rows.next()))?
        {
            let mut line = std::mem::take(self.text.get_mut());
            line.clear();
            self.write_line(&row.map_err(|error| damaged(io_error(error)))?, &mut line)?;
            self.text = io::Cursor::new(line);
        }
        self.text.read(buffer)
    }
}

/// Opens the trace in `file` as text.
///
/// # Errors
/// As [`Lines::open`].
pub fn open_text(file: File) -> io::Result<Box<dyn BufRead>> {
    Ok(Box::new(BufReader::new(guarded(|| Lines::open(file))?)))
}

#[cfg(test)]
mod tests {
    use sim_core::RobotId;
    use sim_core::record::{Journal, Recorder};

    use super::*;
    use crate::record::read::read_text;
    use crate::record::trace::tests::{every_event, header};
    use crate::record::{Sinks, TraceFile};

    /// A trace `name` with events of every kind in each of `slots` slots.
    fn trace(name: &str, slots: i64) -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        let mut recorder = Recorder::new(42, Time(50_000), KindSet::ALL);
        let mut sinks = Sinks::one(TraceFile::create(&path, &header()).unwrap());
        let (mut world, mut journal) = (Journal::new(WORLD, false), Journal::new(RobotId(7), false));
        for slot in 0..slots {
            let now = Time(slot * 50_000);
            every_event().iter().for_each(|event| journal.record(now, event));
            world.record(now, &Event::Object { object: 1, x_m: 0.1, y_m: -0.0, phi_rad: f64::NAN, turns: i64::MIN });
            journal.record(now, &Event::Stdout { text: "\"\u{1b}[31m \u{fffd}\u{10ffff} \u{4e16}\0" });
            journal.record(now, &Event::RadioSent { message: 1, to: None, begins_s: None, data: &[] });
            recorder.collect(&mut world);
            recorder.collect(&mut journal);
            sinks.take_slot(&mut recorder, now + Time(50_000)).unwrap();
        }
        sinks.finish_record(&mut recorder, Time(slots * 50_000)).1.unwrap();
        (folder, path)
    }

    #[test]
    fn table_has_the_text_of_the_lines() {
        for slots in [0, 1, 1200] {
            let [table, lines] = ["t.parquet", "t.jsonl"].map(|name| {
                let (_folder, path) = trace(name, slots);
                String::from_utf8(read_text(&path).unwrap()).unwrap()
            });
            assert!(table == lines, "{slots} slots: {:?}", table.lines().zip(lines.lines()).find(|(a, b)| a != b));
        }
    }

    #[test]
    fn dropped_trace_is_readable() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["t.jsonl", "t.jsonl.zst", "t.parquet"] {
            let path = folder.path().join(name);
            let mut trace = TraceFile::create(&path, &header()).unwrap();
            trace.end_slot(Time(1), Some(Digest([0; 32]))).unwrap();
            drop(trace);
            let text = String::from_utf8(read_text(&path).unwrap()).unwrap();
            assert!(
                text.lines().count() == 2 && text.lines().last().unwrap().starts_with(r#"{"event":"slot""#),
                "{text}"
            );
        }
    }

    #[test]
    fn damaged_file_gives_an_error_or_text() {
        let (_folder, path) = trace("t.parquet", 1);
        let whole = std::fs::read(&path).unwrap();
        let read = |bytes: &[u8]| {
            std::fs::write(&path, bytes).unwrap();
            read_text(&path)
        };
        for length in (4..whole.len()).step_by(97) {
            let error = read(&whole[..length]).unwrap_err().to_string();
            assert!(error.starts_with("it is a Parquet file, but no complete trace: "), "{error}");
        }
        for position in (4..whole.len()).step_by(31) {
            let mut bytes = whole.clone();
            bytes[position] ^= 0x55;
            _ = read(&bytes);
        }
    }
}
