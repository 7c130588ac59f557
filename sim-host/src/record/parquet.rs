//! Writer of tables as Apache Parquet files, whose typed columns data analysis tools can read. It writes groups of rows
//! and needs bounded memory.

use std::io::{self, Write};
use std::mem;
use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Stored};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type as Schema, TypePtr};

/// Maximum number of rows of a group. Our choice, like the next constant.
pub const MAX_ROWS: usize = 1 << 16;

/// Bytes of texts and lists after which a group is written.
const MAX_BYTES: usize = 1 << 25;

/// Type of a column; each cell may also be empty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// UTF-8 strings.
    Text,
    /// Doubles.
    Number,
    /// Signed 64-bit integers.
    Integer,
    /// Unsigned 64-bit integers.
    Count,
    /// Booleans.
    Flag,
    /// Bytes.
    Bytes,
    /// Lists of doubles.
    Numbers,
}

/// Writer of a table, row by row: the cells of a row in any order, then [`Self::end_row`].
///
/// The methods for cells panic if `column` is not a column of their type.
pub struct TableWriter<W: Write + Send> {
    file: SerializedFileWriter<W>,
    columns: Vec<Column>,
    /// Number of complete rows, and bytes of texts and lists, of the group that is not written yet.
    rows: usize,
    bytes: usize,
}

/// Cells of a column in the group that is not written yet.
struct Column {
    values: Values,
    /// Definition levels: 0 for an empty cell, 1 for a value or an empty list, 2 for an element of a list.
    levels: Vec<i16>,
    /// Repetition levels of a column of lists: 1 for all elements but the first.
    repeats: Option<Vec<i16>>,
    /// Number of rows with levels.
    rows: usize,
}

enum Values {
    Bytes(Vec<ByteArray>),
    Numbers(Vec<f64>),
    Integers(Vec<i64>),
    Flags(Vec<bool>),
}

impl<W: Write + Send> TableWriter<W> {
    /// Begins a table with these columns in `out`, which need not seek.
    ///
    /// # Errors
    /// `out` cannot be written.
    pub fn new(out: W, columns: &[(impl AsRef<str>, Type)]) -> io::Result<Self> {
        let begin = || {
            let fields = columns.iter().map(|(name, kind)| field(name.as_ref(), *kind)).collect::<Result<_>>()?;
            let schema = Schema::group_type_builder("rows").with_fields(fields).build()?;
            let maker = format!("eyesim {}", env!("CARGO_PKG_VERSION"));
            let properties = WriterProperties::builder().set_created_by(maker).build();
            let mut file = SerializedFileWriter::new(out, Arc::new(schema), Arc::new(properties))?;
            file.flush()?;
            Ok(file)
        };
        let columns = columns.iter().map(|(_, kind)| Column::new(*kind)).collect();
        Ok(Self { file: begin().map_err(io_error)?, columns, rows: 0, bytes: 0 })
    }

    /// Adds an entry to the metadata of the file.
    pub fn add_metadata(&mut self, key: &str, value: String) {
        self.file.append_key_value_metadata(KeyValue::new(key.to_owned(), value));
    }

    /// Sets a cell of the type [`Type::Text`].
    pub fn text(&mut self, column: usize, text: &str) {
        self.bytes(column, text.as_bytes());
    }

    /// Sets a cell of the type [`Type::Bytes`].
    pub fn bytes(&mut self, column: usize, bytes: &[u8]) {
        self.bytes += bytes.len();
        let Values::Bytes(values) = self.define(column) else { unreachable!("no column of texts or bytes") };
        values.push(bytes.to_vec().into());
    }

    /// Sets a cell of the type [`Type::Number`].
    pub fn number(&mut self, column: usize, number: f64) {
        let Values::Numbers(values) = self.define(column) else { unreachable!("no column of numbers") };
        values.push(number);
    }

    /// Sets a cell of the type [`Type::Integer`], or [`Type::Count`] if `integer` holds the bits of an unsigned
    /// integer.
    pub fn integer(&mut self, column: usize, integer: i64) {
        let Values::Integers(values) = self.define(column) else { unreachable!("no column of integers") };
        values.push(integer);
    }

    /// Sets a cell of the type [`Type::Flag`].
    pub fn flag(&mut self, column: usize, flag: bool) {
        let Values::Flags(values) = self.define(column) else { unreachable!("no column of flags") };
        values.push(flag);
    }

    /// Sets a cell of the type [`Type::Numbers`].
    pub fn numbers(&mut self, column: usize, numbers: impl Iterator<Item = f64>) {
        let Values::Numbers(values) = self.define(column) else { unreachable!("no column of numbers") };
        let first = values.len();
        values.extend(numbers);
        let length = values.len() - first;
        self.bytes += length * size_of::<f64>();
        let Column { levels, repeats: Some(repeats), .. } = &mut self.columns[column] else {
            unreachable!("no column of lists")
        };
        if length > 0 {
            levels.pop();
            levels.extend((0..length).map(|_| 2));
            repeats.extend((1..length).map(|_| 1));
        }
    }

    /// Ends a row; cells that are not set are empty.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn end_row(&mut self) -> io::Result<()> {
        self.rows += 1;
        if self.rows >= MAX_ROWS || self.bytes >= MAX_BYTES { self.write_group().map_err(io_error) } else { Ok(()) }
    }

    /// Completes the file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finish(&mut self) -> io::Result<()> {
        let written = if self.rows > 0 { self.write_group() } else { Ok(()) };
        written.and_then(|()| self.file.finish()).map(drop).map_err(io_error)
    }

    /// Defines the cell of `column` in the current row; returns the column's values.
    fn define(&mut self, column: usize) -> &mut Values {
        let column = &mut self.columns[column];
        column.fill(self.rows);
        column.push_level(1);
        &mut column.values
    }

    fn write_group(&mut self) -> Result<()> {
        let mut group = self.file.next_row_group()?;
        for column in &mut self.columns {
            column.fill(self.rows);
            let Some(mut writer) = group.next_column()? else { break };
            column.write(&mut writer)?;
            writer.close()?;
        }
        group.close()?;
        (self.rows, self.bytes) = (0, 0);
        self.file.flush().map_err(Into::into)
    }
}

impl Column {
    fn new(kind: Type) -> Self {
        let values = match kind {
            Type::Text | Type::Bytes => Values::Bytes(Vec::new()),
            Type::Number | Type::Numbers => Values::Numbers(Vec::new()),
            Type::Integer | Type::Count => Values::Integers(Vec::new()),
            Type::Flag => Values::Flags(Vec::new()),
        };
        Self { values, levels: Vec::new(), repeats: (kind == Type::Numbers).then(Vec::new), rows: 0 }
    }

    /// Adds empty cells up to row `rows`.
    fn fill(&mut self, rows: usize) {
        let empty = rows - self.rows;
        self.levels.extend(std::iter::repeat_n(0, empty));
        self.repeats.iter_mut().for_each(|repeats| repeats.extend(std::iter::repeat_n(0, empty)));
        self.rows = rows;
    }

    /// Adds a cell with the definition level `level`.
    fn push_level(&mut self, level: i16) {
        self.levels.push(level);
        self.repeats.iter_mut().for_each(|repeats| repeats.push(0));
        self.rows += 1;
    }

    /// Writes the cells, and removes them.
    fn write(&mut self, writer: &mut SerializedColumnWriter<'_>) -> Result<()> {
        let levels = (self.levels.as_slice(), self.repeats.as_deref());
        match &mut self.values {
            Values::Bytes(values) => write::<ByteArrayType>(writer, values, levels),
            Values::Numbers(values) => write::<DoubleType>(writer, values, levels),
            Values::Integers(values) => write::<Int64Type>(writer, values, levels),
            Values::Flags(values) => write::<BoolType>(writer, values, levels),
        }?;
        self.levels.clear();
        self.repeats.iter_mut().for_each(Vec::clear);
        self.rows = 0;
        Ok(())
    }
}

fn write<T: DataType>(
    writer: &mut SerializedColumnWriter<'_>,
    values: &mut Vec<T::T>,
    (levels, repeats): (&[i16], Option<&[i16]>),
) -> Result<()> {
    writer.typed::<T>().write_batch(&mem::take(values), Some(levels), repeats).map(drop)
}

fn field(name: &str, kind: Type) -> Result<TypePtr> {
    let (stored, logical) = match kind {
        Type::Text => (Stored::BYTE_ARRAY, Some(LogicalType::String)),
        Type::Bytes => (Stored::BYTE_ARRAY, None),
        Type::Number => (Stored::DOUBLE, None),
        Type::Integer => (Stored::INT64, None),
        Type::Count => (Stored::INT64, Some(LogicalType::integer(64, false))),
        Type::Flag => (Stored::BOOLEAN, None),
        Type::Numbers => return list(name),
    };
    let field = Schema::primitive_type_builder(name, stored).with_logical_type(logical);
    Ok(Arc::new(field.with_repetition(Repetition::OPTIONAL).build()?))
}

/// A column of lists of doubles, in the form that Parquet's specification demands.
fn list(name: &str) -> Result<TypePtr> {
    let element = Schema::primitive_type_builder("element", Stored::DOUBLE).with_repetition(Repetition::REQUIRED);
    let group =
        |name, repetition, field| Schema::group_type_builder(name).with_repetition(repetition).with_fields(vec![field]);
    let elements = group("list", Repetition::REPEATED, Arc::new(element.build()?)).build()?;
    let lists = group(name, Repetition::OPTIONAL, Arc::new(elements));
    Ok(Arc::new(lists.with_logical_type(Some(LogicalType::List)).build()?))
}

/// Returns the I/O error that an error of the Parquet crate contains; any other error is wrapped.
pub(super) fn io_error(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(error) => error.downcast().map_or_else(io::Error::other, |error: Box<io::Error>| *error),
        error => io::Error::other(error),
    }
}

#[cfg(test)]
mod tests {
    use std::fs::File;

    use parquet::file::reader::{FileReader as _, SerializedFileReader};

    use super::*;

    /// The rows of a table in the notation of the Parquet crate, after `fill`.
    fn rows(columns: &[(&str, Type)], fill: impl FnOnce(&mut TableWriter<File>) -> io::Result<()>) -> Vec<String> {
        let file = tempfile::tempfile().unwrap();
        let mut table = TableWriter::new(file.try_clone().unwrap(), columns).unwrap();
        fill(&mut table).and_then(|()| table.finish()).unwrap();
        let reader = SerializedFileReader::new(file).unwrap();
        let rows = reader.get_row_iter(None).unwrap().map(|row| row.unwrap().to_string());
        rows.collect()
    }

    #[test]
    fn lists_and_empty_cells_are_kept_across_groups() {
        let columns = [("list", Type::Numbers), ("bytes", Type::Bytes), ("never", Type::Text), ("row", Type::Integer)];
        let lists: [&[f64]; 3] = [&[], &[1.5], &[2.5, -0.0, f64::INFINITY]];
        let rows = rows(&columns, |table| {
            (0..MAX_ROWS + 4).try_for_each(|row| {
                if let Some(list) = lists.get(row % 4) {
                    table.numbers(0, list.iter().copied());
                }
                if row == MAX_ROWS {
                    table.bytes(1, &[0, 255]);
                }
                table.integer(3, row as i64);
                table.end_row()
            })
        });
        assert_eq!(rows.len(), MAX_ROWS + 4);
        for (row, text) in rows.iter().enumerate() {
            let list = ["[]", "[1.5]", "[2.5, -0E0, inf]", "null"][row % 4];
            let bytes = if row == MAX_ROWS { "[0, 255]" } else { "null" };
            assert_eq!(*text, format!("{{list: {list}, bytes: {bytes}, never: null, row: {row}}}"));
        }
    }

    #[test]
    fn long_texts_end_a_group() {
        let file = tempfile::tempfile().unwrap();
        let mut table = TableWriter::new(file.try_clone().unwrap(), &[("text", Type::Text)]).unwrap();
        for _ in 0..5 {
            table.text(0, &"x".repeat(MAX_BYTES / 2));
            table.end_row().unwrap();
        }
        table.finish().unwrap();
        assert_eq!(SerializedFileReader::new(file).unwrap().metadata().num_row_groups(), 3);
    }

    #[test]
    fn empty_table_is_a_file() {
        assert!(rows(&[("a", Type::Number)], |_| Ok(())).is_empty());
    }
}
