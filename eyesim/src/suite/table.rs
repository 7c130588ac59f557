//! Result rows of a suite as tables of typed columns and as CSV (RFC 4180), for spreadsheets and data analysis tools.

use std::collections::HashMap;

use sim_host::record::log::is_terminal_control;

use super::row::Row;

/// Type of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Type {
    /// A text.
    Text,
    /// A number.
    Number,
    /// A whole number, not negative.
    Count,
    /// True or false.
    Flag,
}

/// A value of a row.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// A text.
    Text(String),
    /// A number.
    Number(f64),
    /// A whole number.
    Count(u64),
    /// True or false.
    Flag(bool),
}

/// The first columns of every table.
pub const COLUMNS: [(&str, Type); 11] = [
    ("case", Type::Text),
    ("variant", Type::Text),
    ("seed", Type::Count),
    ("outcome", Type::Text),
    ("points", Type::Number),
    ("max_points", Type::Number),
    ("message", Type::Text),
    ("at_s", Type::Number),
    ("sim_time_s", Type::Number),
    ("digest", Type::Text),
    ("key", Type::Text),
];

/// The cells of a row for [`COLUMNS`]; `None` for a value that the row does not have.
pub fn cells(row: &Row) -> Vec<Option<Cell>> {
    let text = |text: &str| Some(Cell::Text(text.to_owned()));
    vec![
        text(&row.case),
        text(&row.variant),
        Some(Cell::Count(row.seed)),
        text(row.outcome.word()),
        Some(Cell::Number(row.points)),
        Some(Cell::Number(row.max_points)),
        text(&row.message),
        row.at_s.map(Cell::Number),
        Some(Cell::Number(row.sim_time_s)),
        row.digest.clone().map(Cell::Text),
        text(&row.key),
    ]
}

/// Rows as a table with typed columns.
#[derive(Debug, PartialEq)]
pub struct Table {
    /// Name and type of each column.
    pub columns: Vec<(String, Type)>,
    /// The cells of each row: one for each column, of the column's type.
    pub rows: Vec<Vec<Option<Cell>>>,
}

impl Table {
    /// The table of `rows`. These columns follow [`COLUMNS`]:
    ///
    /// - `NAME`, or `setting.NAME` if [`COLUMNS`] contains `NAME`: a setting of the matrix;
    /// - `check.NAME`: the verdict of a check;
    /// - `value.NAME`: the quantity that the check measured;
    /// - `rID.NAME`, such as `r1.laps`: the last value of a metric that the program of robot `ID` printed.
    ///
    /// If all values of a setting are numbers, its column has the type [`Type::Number`].
    pub fn of(rows: &[Row]) -> Self {
        let mut columns: Vec<(String, Type)> = COLUMNS.map(|(name, kind)| (name.to_owned(), kind)).to_vec();
        let mut indices: HashMap<String, usize> = HashMap::new();
        for (name, cell) in rows.iter().flat_map(additional_cells) {
            let kind = cell.kind();
            let index = *indices.entry(name).or_insert_with_key(|name| {
                columns.push((name.clone(), kind));
                columns.len() - 1
            });
            if columns[index].1 != kind {
                columns[index].1 = Type::Text;
            }
        }
        let row_of = |row: &Row| {
            let mut row_cells = cells(row);
            row_cells.resize(columns.len(), None);
            for (name, cell) in additional_cells(row) {
                let index = indices[&name];
                row_cells[index] = Some(if columns[index].1 == Type::Text { Cell::Text(cell.text()) } else { cell });
            }
            row_cells
        };
        let mut table = Self { rows: rows.iter().map(row_of).collect(), columns };
        (COLUMNS.len()..table.columns.len()).for_each(|column| table.convert_to_numbers(column));
        table
    }

    /// Converts a column of texts to numbers, if all its texts are numbers.
    fn convert_to_numbers(&mut self, column: usize) {
        let number = |cell: &Cell| match cell {
            Cell::Text(text) => text.parse::<f64>().ok().filter(|number| number.is_finite()).map(Cell::Number),
            _ => None,
        };
        // `None` for a row without a value, `Some(None)` for a row whose value is not a number.
        let cells: Vec<Option<Option<Cell>>> = self.rows.iter().map(|row| row[column].as_ref().map(number)).collect();
        if !cells.contains(&Some(None)) {
            self.columns[column].1 = Type::Number;
            self.rows.iter_mut().zip(cells).for_each(|(row, cell)| row[column] = cell.flatten());
        }
    }

    /// The table as CSV: a header line with the names of the columns, then a line for each row.
    pub fn csv(&self) -> String {
        let mut csv = line(&self.columns.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>());
        self.rows.iter().for_each(|row| csv.push_str(&line(&texts(row))));
        csv
    }
}

impl Cell {
    fn kind(&self) -> Type {
        match self {
            Self::Text(_) => Type::Text,
            Self::Number(_) => Type::Number,
            Self::Count(_) => Type::Count,
            Self::Flag(_) => Type::Flag,
        }
    }

    fn text(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Number(number) => number.to_string(),
            Self::Count(count) => count.to_string(),
            Self::Flag(flag) => flag.to_string(),
        }
    }
}

/// Texts of cells; a cell without a value has an empty text.
pub fn texts(cells: &[Option<Cell>]) -> Vec<String> {
    cells.iter().map(|cell| cell.as_ref().map(Cell::text).unwrap_or_default()).collect()
}

/// Names and cells of a row in the columns after [`COLUMNS`].
fn additional_cells(row: &Row) -> impl Iterator<Item = (String, Cell)> {
    let is_taken = |name: &str| COLUMNS.iter().any(|(column, _)| *column == name);
    let name_of = move |name: &str| if is_taken(name) { format!("setting.{name}") } else { name.to_owned() };
    let settings = row.settings.iter().filter(|(name, _)| name != "seed");
    let settings = settings.map(move |(name, value)| (name_of(name), Cell::Text(value.clone())));
    let verdicts = row.checks.iter().map(|check| (format!("check.{}", check.name), Cell::Flag(check.passed)));
    let measured = row.checks.iter().filter_map(|check| Some((check, check.value?)));
    let values = measured.map(|(check, value)| (format!("value.{}", check.name), Cell::Number(value)));
    let metrics = row.robots.iter().flat_map(|robot| {
        robot.metrics.iter().map(|(name, value)| (format!("r{}.{name}", robot.id), Cell::Number(*value)))
    });
    settings.chain(verdicts).chain(values).chain(metrics)
}

/// Fields as a line of CSV, with its line break.
pub fn line(fields: &[String]) -> String {
    let mut line = fields.iter().map(|text| field(text)).collect::<Vec<_>>().join(",");
    line.push_str("\r\n");
    line
}

/// Quotes a field of CSV where necessary, and escapes control characters. Puts an apostrophe before a formula, so that
/// a spreadsheet does not evaluate it.
fn field(text: &str) -> String {
    let is_number = text.parse::<f64>().is_ok_and(f64::is_finite);
    let mut escaped = String::new();
    if !is_number && text.starts_with(['=', '+', '-', '@', '\t', '\r']) {
        escaped.push('\'');
    }
    for c in text.chars() {
        if is_terminal_control(c) && c != '\n' { escaped.extend(c.escape_default()) } else { escaped.push(c) }
    }
    if escaped.contains(['"', ',', '\n', '\r']) { format!("\"{}\"", escaped.replace('"', "\"\"")) } else { escaped }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_and_control_characters_are_escaped() {
        for (text, expected) in [
            ("Ana", "Ana"),
            ("-3.5", "-3.5"),
            ("=SUM(A1)", "'=SUM(A1)"),
            ("@x,y", "\"'@x,y\""),
            ("say \"hi\"", "\"say \"\"hi\"\"\""),
            ("\u{1b}[31mred", "\\u{1b}[31mred"),
            ("two\nlines", "\"two\nlines\""),
        ] {
            assert_eq!(field(text), expected);
        }
    }
}
