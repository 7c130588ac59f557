//! Rows as CSV (RFC 4180), which spreadsheets and tools of data analysis open.

use super::row::Row;
use crate::record::log::is_terminal_control;

/// Columns that every table of rows has.
pub const COLUMNS: [&str; 11] =
    ["case", "variant", "seed", "outcome", "points", "max_points", "message", "at_s", "sim_time_s", "digest", "key"];

/// The fields of a row in [`COLUMNS`].
pub fn fields(row: &Row) -> Vec<String> {
    let number = |number: Option<f64>| number.map(|number| number.to_string()).unwrap_or_default();
    vec![
        row.case.clone(),
        row.variant.clone(),
        row.seed.to_string(),
        row.outcome.word().to_owned(),
        row.points.to_string(),
        row.max_points.to_string(),
        row.message.clone(),
        number(row.at_s),
        row.sim_time_s.to_string(),
        row.digest.clone().unwrap_or_default(),
        row.key.clone(),
    ]
}

/// A line for each row. After [`COLUMNS`] it has a column for each setting of the matrix, for each check its verdict (`check.NAME`) and the
/// quantity that it measured (`value.NAME`), and for each metric that a program printed its last value (`r1.NAME`).
pub fn table(rows: &[Row]) -> String {
    let mut columns: Vec<String> = COLUMNS.map(str::to_owned).to_vec();
    let mut places: std::collections::HashMap<String, usize> = std::collections::HashMap::new();
    for row in rows {
        for (name, _) in further(row) {
            places.entry(name).or_insert_with_key(|name| {
                columns.push(name.clone());
                columns.len() - 1
            });
        }
    }
    let mut csv = line(&columns);
    for row in rows {
        let mut cells = fields(row);
        cells.resize(columns.len(), String::new());
        further(row).for_each(|(name, value)| cells[places[&name]] = value);
        csv.push_str(&line(&cells));
    }
    csv
}

/// Columns of a row after [`COLUMNS`], with its values.
fn further(row: &Row) -> impl Iterator<Item = (String, String)> {
    let name_of = |name: &str| if COLUMNS.contains(&name) { format!("setting.{name}") } else { name.to_owned() };
    let settings = row.settings.iter().filter(|(name, _)| name != "seed");
    let settings = settings.map(move |(name, value)| (name_of(name), value.clone()));
    let verdicts = row.checks.iter().map(|check| (format!("check.{}", check.name), check.passed.to_string()));
    let measured = row.checks.iter().filter_map(|check| Some((check, check.value?)));
    let values = measured.map(|(check, value)| (format!("value.{}", check.name), value.to_string()));
    let metrics = row.robots.iter().flat_map(|robot| {
        robot.metrics.iter().map(|(name, value)| (format!("r{}.{name}", robot.id), value.to_string()))
    });
    settings.chain(verdicts).chain(values).chain(metrics)
}

/// A line of fields.
pub fn line(fields: &[String]) -> String {
    let mut line = fields.iter().map(|text| field(text)).collect::<Vec<_>>().join(",");
    line.push_str("\r\n");
    line
}

/// A field: never a formula of a spreadsheet, and without control characters.
fn field(text: &str) -> String {
    let is_number = text.parse::<f64>().is_ok_and(f64::is_finite);
    let mut plain = String::new();
    if !is_number && text.starts_with(['=', '+', '-', '@', '\t', '\r']) {
        plain.push('\'');
    }
    for c in text.chars() {
        if is_terminal_control(c) && c != '\n' { plain.extend(c.escape_default()) } else { plain.push(c) }
    }
    if plain.contains(['"', ',', '\n', '\r']) { format!("\"{}\"", plain.replace('"', "\"\"")) } else { plain }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_are_no_formulas_and_have_no_controls() {
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
