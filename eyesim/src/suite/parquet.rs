//! Tables of results as Apache Parquet: data analysis tools read typed columns from such files.

use std::io;

use sim_host::record::parquet::{self, TableWriter};

use super::table::{Cell, Table, Type};

/// The bytes of a Parquet file with an optional column for each column of the table: texts as UTF-8 strings, numbers as
/// doubles, whole numbers as unsigned 64-bit integers, flags as booleans.
///
/// # Errors
/// Errors of the writer; none are known to occur.
pub fn parquet(table: &Table) -> io::Result<Vec<u8>> {
    let columns: Vec<_> = table.columns.iter().map(|(name, kind)| (name, stored_type(*kind))).collect();
    let mut bytes = Vec::new();
    let mut writer = TableWriter::new(&mut bytes, &columns)?;
    for row in &table.rows {
        for (column, cell) in row.iter().enumerate() {
            match cell {
                None => {}
                Some(Cell::Text(text)) => writer.text(column, text),
                Some(Cell::Number(number)) => writer.number(column, *number),
                Some(Cell::Count(count)) => writer.integer(column, count.cast_signed()),
                Some(Cell::Flag(flag)) => writer.flag(column, *flag),
            }
        }
        writer.end_row()?;
    }
    writer.finish()?;
    drop(writer);
    Ok(bytes)
}

fn stored_type(kind: Type) -> parquet::Type {
    match kind {
        Type::Text => parquet::Type::Text,
        Type::Number => parquet::Type::Number,
        Type::Count => parquet::Type::Count,
        Type::Flag => parquet::Type::Flag,
    }
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::io::Write as _;

    use ::parquet::file::reader::{FileReader as _, SerializedFileReader};
    use ::parquet::record::Field;

    use super::*;

    fn reader(table: &Table) -> SerializedFileReader<File> {
        let mut file = tempfile::tempfile().expect("a file");
        file.write_all(&parquet(table).expect("no error")).expect("room");
        SerializedFileReader::new(file).expect("a Parquet file")
    }

    #[test]
    fn tables_are_read_back_with_their_types() {
        let text = |text: &str| Some(Cell::Text(text.to_owned()));
        let table = Table {
            columns: [("case", Type::Text), ("mass", Type::Number), ("seed", Type::Count), ("check.goal", Type::Flag)]
                .map(|(name, kind)| (name.to_owned(), kind))
                .to_vec(),
            rows: vec![
                vec![text("a=1, \"ö\""), Some(Cell::Number(-0.1)), Some(Cell::Count(u64::MAX)), Some(Cell::Flag(true))],
                vec![text(""), None, Some(Cell::Count(0)), Some(Cell::Flag(false))],
                vec![None, Some(Cell::Number(f64::MAX)), None, None],
            ],
        };
        let read: Vec<Vec<Option<Cell>>> = reader(&table)
            .get_row_iter(None)
            .expect("rows")
            .map(|row| {
                let row = row.expect("a row");
                let cells = row.get_column_iter().map(|(_, field)| match field {
                    Field::Str(text) => Some(Cell::Text(text.clone())),
                    Field::Double(number) => Some(Cell::Number(*number)),
                    Field::ULong(count) => Some(Cell::Count(*count)),
                    Field::Bool(flag) => Some(Cell::Flag(*flag)),
                    Field::Null => None,
                    other => panic!("{other:?}"),
                });
                cells.collect()
            })
            .collect();
        assert_eq!(read, table.rows);
        assert_eq!(reader(&Table { rows: Vec::new(), ..table }).metadata().file_metadata().num_rows(), 0);
    }
}
