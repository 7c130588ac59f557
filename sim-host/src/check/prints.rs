//! Search for a text, a pattern or numbers in the lines that a program prints.

use std::collections::VecDeque;

use sim_core::RobotId;
use sim_core::spec::ExpectedOutput;

/// Line-by-line search for the text or numbers that a program must print.
#[derive(Clone, Debug)]
pub(super) struct Search {
    expected: ExpectedOutput,
    is_found: bool,
    line_count: u64,
    /// Numbers of the most recent lines that contain numbers; at most as many lines as the check expects rows.
    numbers: VecDeque<Vec<f64>>,
    /// Number of rows in the longest match, and the numbers that followed instead of the next row.
    nearest: Option<(usize, Vec<f64>)>,
}

impl Search {
    pub fn new(expected: &ExpectedOutput) -> Self {
        Self { expected: expected.clone(), is_found: false, line_count: 0, numbers: VecDeque::new(), nearest: None }
    }

    pub fn is_found(&self) -> bool {
        self.is_found
    }

    /// Takes the next line; returns true if it completes the search.
    pub fn take(&mut self, line: &str) -> bool {
        if self.is_found {
            return false;
        }
        self.line_count += 1;
        self.is_found = match &self.expected {
            ExpectedOutput::Text(text) => line.contains(text.as_str()),
            ExpectedOutput::Pattern(pattern) => matches(pattern, line.trim_end()),
            ExpectedOutput::Numbers { rows, tolerance } => {
                let (rows, tolerance) = (rows.clone(), *tolerance);
                self.take_numbers(line, &rows, tolerance)
            }
        };
        self.is_found
    }

    fn take_numbers(&mut self, line: &str, rows: &[Vec<f64>], tolerance: f64) -> bool {
        let numbers = numbers_of(line);
        if numbers.is_empty() {
            return false;
        }
        if self.numbers.len() == rows.len() {
            self.numbers.pop_front();
        }
        self.numbers.push_back(numbers);
        // A match may begin at any of these lines.
        for start in 0..self.numbers.len() {
            let lines = self.numbers.iter().skip(start);
            let matched = lines.clone().zip(rows).take_while(|(line, row)| has_row(line, row, tolerance)).count();
            if matched == rows.len() {
                return true;
            }
            let mismatch = lines.clone().nth(matched);
            let is_nearer = self.nearest.as_ref().is_none_or(|(longest, _)| matched > *longest);
            if let Some(mismatch) = mismatch.filter(|_| is_nearer) {
                self.nearest = Some((matched, mismatch.clone()));
            }
        }
        false
    }

    /// Describes the match, or the nearest match. `verb` is `printed` or `shows`.
    pub fn explain(&self, robot: RobotId, verb: &str) -> String {
        let what = match &self.expected {
            ExpectedOutput::Text(text) => format!("`{text}`"),
            ExpectedOutput::Pattern(pattern) => format!("a line like `{pattern}`"),
            ExpectedOutput::Numbers { rows, .. } if rows.len() == 1 => "the numbers".to_owned(),
            ExpectedOutput::Numbers { rows, .. } => format!("the {} rows of numbers", rows.len()),
        };
        if self.is_found {
            return format!("{robot} {verb} {what}");
        }
        let lines = match self.line_count {
            0 => return format!("{robot} {verb} nothing"),
            1 => "in one line".to_owned(),
            count => format!("in {count} lines"),
        };
        let (ExpectedOutput::Numbers { rows, tolerance }, Some((matched, found))) = (&self.expected, &self.nearest)
        else {
            return format!("{robot} {verb} no {} {lines}", what.trim_start_matches("the ").trim_start_matches("a "));
        };
        let row = &rows[*matched];
        let mismatch = row.iter().zip(found).position(|(wanted, found)| !is_near(*wanted, *found, *tolerance));
        let prefix = if rows.len() > 1 { format!("row {}, ", matched + 1) } else { String::new() };
        match mismatch {
            Some(column) => {
                format!("{prefix}number {}: {robot} {verb} {}, not {}", column + 1, found[column], row[column])
            }
            None => format!("{prefix}{robot} {verb} {} numbers, not {}", found.len(), row.len()),
        }
    }
}

fn is_near(wanted: f64, found: f64, tolerance: f64) -> bool {
    // Decimal numbers that differ by exactly the tolerance may differ by slightly more as doubles.
    (wanted - found).abs() <= tolerance * (1.0 + 1e-12) + f64::EPSILON * wanted.abs()
}

/// Returns true if the numbers of a line contain the numbers of `row` in sequence.
fn has_row(line: &[f64], row: &[f64], tolerance: f64) -> bool {
    line.windows(row.len())
        .any(|window| window.iter().zip(row).all(|(found, wanted)| is_near(*wanted, *found, tolerance)))
}

/// Returns the numbers in a line; any other characters separate them.
fn numbers_of(line: &str) -> Vec<f64> {
    let is_part = |c: char| c.is_alphanumeric() || matches!(c, '.' | '+' | '-' | '_');
    let words = line.split(|c: char| !is_part(c)).map(|word| word.trim_end_matches('.'));
    let number = |word: &str| word.parse::<f64>().ok().filter(|number| number.is_finite());
    words.filter(|word| word.contains(|c: char| c.is_ascii_digit())).filter_map(number).collect()
}

/// Returns true if `line` matches `pattern`, in which `*` stands for any text.
fn matches(pattern: &str, line: &str) -> bool {
    let mut parts = pattern.split('*');
    let first = parts.next().unwrap_or_default();
    let Some(mut rest) = line.strip_prefix(first) else { return false };
    let mut parts: Vec<&str> = parts.collect();
    let Some(last) = parts.pop() else { return rest.is_empty() };
    for part in parts {
        // The earliest match leaves the most text for the following parts.
        let Some(start) = rest.find(part) else { return false };
        rest = &rest[start + part.len()..];
    }
    rest.len() >= last.len() && rest.ends_with(last)
}
