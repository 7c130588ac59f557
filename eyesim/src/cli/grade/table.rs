//! Tables of grades in CSV format, for spreadsheets.

use super::Student;
use super::student::points_of_check;
use crate::suite::table::{COLUMNS, cells, line, texts};

/// Table with a line for each submission.
pub(super) fn grades(students: &[Student]) -> String {
    let mut checks = Vec::new();
    for variant in students.iter().flat_map(|student| &student.variants) {
        for (index, (check, _)) in variant.checks.iter().enumerate() {
            let column = (variant.name.as_str(), index, check.as_str());
            if !checks.contains(&column) {
                checks.push(column);
            }
        }
    }
    let mut head =
        vec!["student", "folder", "points", "max_points", "verdict", "passed", "cases", "first_failure", "behaviour"]
            .into_iter()
            .map(str::to_owned)
            .collect::<Vec<_>>();
    head.extend(checks.iter().map(|(variant, _, check)| match *variant {
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
        for (name, index, _) in &checks {
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

/// Table with a line for each case of each submission.
pub(super) fn rows(students: &[Student]) -> String {
    let head = ["student"].into_iter().chain(COLUMNS.map(|(name, _)| name)).map(str::to_owned);
    let mut csv = line(&head.collect::<Vec<_>>());
    for student in students {
        for result in &student.graded.results {
            let mut fields = vec![student.submission.folder.clone()];
            fields.extend(texts(&cells(&result.row)));
            csv.push_str(&line(&fields));
        }
    }
    csv
}

fn decimal(number: f64) -> String {
    let text = format!("{number:.4}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
