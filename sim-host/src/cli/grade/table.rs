//! Tables as CSV (RFC 4180), which spreadsheets open.

use super::Student;
use super::student::points_of_check;
use crate::record::log::is_terminal_control;
use crate::suite::RowOutcome;

/// A line for each submission.
pub(super) fn grades(students: &[Student]) -> String {
    let mut names = Vec::new();
    for variant in students.iter().flat_map(|student| &student.variants) {
        for (index, (check, _)) in variant.checks.iter().enumerate() {
            let column = (variant.name.as_str(), index, check.as_str());
            if !names.contains(&column) {
                names.push(column);
            }
        }
    }
    let mut head =
        vec!["student", "folder", "points", "max_points", "verdict", "passed", "cases", "first_failure", "behaviour"]
            .into_iter()
            .map(str::to_owned)
            .collect::<Vec<_>>();
    head.extend(names.iter().map(|(variant, _, check)| match *variant {
        "run" => (*check).to_owned(),
        variant => format!("{check} ({variant})"),
    }));
    let mut csv = line(&head);
    for student in students {
        let mut fields = vec![
            student.submission.name.clone(),
            student.submission.folder.clone(),
            decimal(student.points()),
            decimal(student.max_points()),
            student.verdict().to_owned(),
            student.passed().to_string(),
            student.graded.results.len().to_string(),
            student.message().to_owned(),
            student.graded.behaviour().unwrap_or_default(),
        ];
        for (name, index, _) in &names {
            let variant = student.variants.iter().find(|variant| variant.name == *name);
            let points = variant
                .filter(|variant| variant.checks.len() > *index)
                .map(|variant| points_of_check(&student.graded.results, variant, *index).0);
            fields.push(points.map(decimal).unwrap_or_default());
        }
        csv.push_str(&line(&fields));
    }
    csv
}

/// A line for each case of each submission.
pub(super) fn rows(students: &[Student]) -> String {
    let head = [
        "student",
        "case",
        "variant",
        "seed",
        "outcome",
        "points",
        "max_points",
        "message",
        "at_s",
        "sim_time_s",
        "digest",
        "key",
    ];
    let mut csv = line(&head.map(str::to_owned));
    for student in students {
        for result in &student.graded.results {
            let row = &result.row;
            let outcome = match row.outcome {
                RowOutcome::Passed => "passed",
                RowOutcome::Failed => "failed",
                RowOutcome::Error => "error",
                RowOutcome::Interrupted => "interrupted",
            };
            csv.push_str(&line(&[
                student.submission.folder.clone(),
                row.case.clone(),
                row.variant.clone(),
                row.seed.to_string(),
                outcome.to_owned(),
                decimal(row.points),
                decimal(row.max_points),
                row.message.clone(),
                row.at_s.map(decimal).unwrap_or_default(),
                decimal(row.sim_time_s),
                row.digest.clone().unwrap_or_default(),
                row.key.clone(),
            ]));
        }
    }
    csv
}

fn decimal(number: f64) -> String {
    let text = format!("{number:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn line(fields: &[String]) -> String {
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
