//! Merges the rows of several files, and sorts them.

use std::cmp::Ordering;
use std::collections::BTreeMap;

use sim_format::path::file_name;

use super::{Line, Lines, SweepError};
use crate::suite::{Row, RowOutcome};

/// The rows of `files`, each once, ordered by suite and settings. The row of a case that could not be run is replaced
/// by another row of the case.
///
/// # Errors
/// [`SweepError::Conflict`] if a key has two results.
pub fn merge(files: Vec<Lines>) -> Result<Vec<Row>, SweepError> {
    let mut rows: BTreeMap<String, (Row, String)> = BTreeMap::new();
    let mut errors: BTreeMap<(String, String), Row> = BTreeMap::new();
    for file in files {
        for Line { number, row } in file.rows {
            let location = format!("{}:{number}", file.path.display());
            if row.outcome == RowOutcome::Error {
                errors.insert(case_of(&row), row);
                continue;
            }
            match rows.get_mut(&row.key) {
                None => _ = rows.insert(row.key.clone(), (row, location)),
                Some(known) => join(known, row, location)?,
            }
        }
    }
    for (row, _) in rows.values() {
        errors.remove(&case_of(row));
    }
    let mut rows: Vec<Row> = rows.into_values().map(|(row, _)| row).chain(errors.into_values()).collect();
    rows.sort_by(compare);
    Ok(rows)
}

/// The case of a row, regardless of the location of the suite: the name of the suite's file, and the name of the case.
fn case_of(row: &Row) -> (String, String) {
    (file_name(&row.suite).to_owned(), row.case.clone())
}

/// Joins two rows with one key. A row of a run that was stopped for its processor time has no digest; it is replaced by
/// a row with a digest.
fn join(known: &mut (Row, String), row: Row, location: String) -> Result<(), SweepError> {
    let (known_row, known_location) = &*known;
    let conflict = |quantity, first: &str, second: &str| SweepError::Conflict {
        key: row.key.clone(),
        case: row.case.clone(),
        what: quantity,
        first: format!("`{first}` at {known_location}"),
        second: format!("`{second}` at {location}"),
    };
    match (&known_row.digest, &row.digest) {
        (Some(first), Some(second)) if first != second => return Err(conflict("digests", first, second)),
        (Some(_), Some(_)) | (None, None) if result_text(known_row) != result_text(&row) => {
            return Err(conflict("results", &result_text(known_row), &result_text(&row)));
        }
        (None, Some(_)) => *known = (row, location),
        _ => {}
    }
    Ok(())
}

fn result_text(row: &Row) -> String {
    format!("{}, {} of {} points at {} s", row.outcome.word(), row.points, row.max_points, row.sim_time_s)
}

fn compare(a: &Row, b: &Row) -> Ordering {
    let settings = a.settings.iter().zip(&b.settings).map(|((_, a), (_, b))| compare_values(a, b));
    let by_settings = settings.fold(Ordering::Equal, Ordering::then);
    a.suite.cmp(&b.suite).then(by_settings).then_with(|| (&a.case, &a.key).cmp(&(&b.case, &b.key)))
}

/// Orders numbers by value, before texts.
fn compare_values(a: &str, b: &str) -> Ordering {
    match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => a.total_cmp(&b),
        (Ok(_), Err(_)) => Ordering::Less,
        (Err(_), Ok(_)) => Ordering::Greater,
        (Err(_), Err(_)) => a.cmp(b),
    }
}
