//! Tables as Apache Parquet: data analysis tools read typed columns from such files.

use std::sync::Arc;

use parquet::basic::{LogicalType, Repetition, Type as Stored};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::Result;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types;

use super::table::{Cell, Table, Type};

/// The bytes of a Parquet file with one row group and an optional column for each column of the table: texts as UTF-8
/// strings, numbers as doubles, whole numbers as unsigned 64-bit integers, flags as booleans.
///
/// # Errors
/// Errors of the writer; none are known to occur.
pub fn parquet(table: &Table) -> Result<Vec<u8>> {
    let fields = table.columns.iter().map(|(name, kind)| field(name, *kind)).collect::<Result<_>>()?;
    let schema = types::Type::group_type_builder("rows").with_fields(fields).build()?;
    let properties =
        WriterProperties::builder().set_created_by(format!("eyesim {}", env!("CARGO_PKG_VERSION"))).build();
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, Arc::new(schema), Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    let mut column_index = 0;
    while let Some(mut column) = group.next_column()? {
        let cells: Vec<Option<&Cell>> = table.rows.iter().map(|row| row[column_index].as_ref()).collect();
        match table.columns[column_index].1 {
            Type::Text => write::<ByteArrayType>(&mut column, &cells, |cell| match cell {
                Cell::Text(text) => Some(ByteArray::from(text.as_str())),
                _ => None,
            }),
            Type::Number => write::<DoubleType>(&mut column, &cells, |cell| match cell {
                Cell::Number(number) => Some(*number),
                _ => None,
            }),
            Type::Count => write::<Int64Type>(&mut column, &cells, |cell| match cell {
                Cell::Count(count) => Some(count.cast_signed()),
                _ => None,
            }),
            Type::Flag => write::<BoolType>(&mut column, &cells, |cell| match cell {
                Cell::Flag(flag) => Some(*flag),
                _ => None,
            }),
        }?;
        column.close()?;
        column_index += 1;
    }
    group.close()?;
    writer.close()?;
    Ok(bytes)
}

fn field(name: &str, kind: Type) -> Result<types::TypePtr> {
    let (stored, logical) = match kind {
        Type::Text => (Stored::BYTE_ARRAY, Some(LogicalType::String)),
        Type::Number => (Stored::DOUBLE, None),
        Type::Count => (Stored::INT64, Some(LogicalType::integer(64, false))),
        Type::Flag => (Stored::BOOLEAN, None),
    };
    let field = types::Type::primitive_type_builder(name, stored).with_logical_type(logical);
    Ok(Arc::new(field.with_repetition(Repetition::OPTIONAL).build()?))
}

/// Writes a column; a cell without a value has definition level 0.
fn write<T: DataType>(
    column: &mut SerializedColumnWriter<'_>,
    cells: &[Option<&Cell>],
    value: impl Fn(&Cell) -> Option<T::T>,
) -> Result<()> {
    let values: Vec<Option<T::T>> = cells.iter().map(|cell| cell.and_then(&value)).collect();
    let levels: Vec<i16> = values.iter().map(|value| value.is_some().into()).collect();
    let values: Vec<T::T> = values.into_iter().flatten().collect();
    column.typed::<T>().write_batch(&values, Some(&levels), None)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs::File;
    use std::io::Write as _;

    use parquet::file::reader::{FileReader as _, SerializedFileReader};
    use parquet::record::Field;

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
