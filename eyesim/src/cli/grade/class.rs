//! Writes the page of the class.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::Student;
use super::student::{STYLE, title};
use crate::cli::test::page::{FOOT, escaped, head};
use crate::cli::test::screen::{number, percent};
use crate::grade::Grader;
use crate::suite::RowOutcome;

/// Number of bars of the distribution.
const BARS: usize = 10;
/// Maximum number of submissions in the list of the slowest.
const MAX_SLOWEST: usize = 10;

/// Returns the page of the class: distribution of the points, submissions, checks, groups of equal behaviour, slowest
/// submissions.
pub(super) fn page(grader: &Grader, students: &[Student]) -> String {
    let title = title(grader);
    let mut html = head(&format!("{title}: eyesim grade"), STYLE);
    let mut points: Vec<f64> = students.iter().map(Student::points).collect();
    points.sort_by(f64::total_cmp);
    let max_points = students.iter().map(Student::max_points).fold(0.0, f64::max);
    let count = |verdict| students.iter().filter(|student| student.verdict() == verdict).count();
    let median = match points.len() {
        0 => 0.0,
        count if count % 2 == 1 => points[count / 2],
        count => (points[count / 2 - 1] + points[count / 2]) / 2.0,
    };
    // Writing to a string cannot fail.
    _ = write!(
        html,
        "<h1>{}</h1>\n<p>{} submissions: {} passed, {} failed, {} could not be run. Of {} points: mean {}, median {}.</p>\n\
         <p><a href=\"grades.csv\">grades.csv</a>, <a href=\"rows.csv\">rows.csv</a>, <a href=\"junit.xml\">junit.xml</a></p>\n",
        escaped(&title),
        students.len(),
        count("passed"),
        count("failed"),
        count("error"),
        number(max_points),
        number(points.iter().sum::<f64>() / points.len().max(1) as f64),
        number(median)
    );
    distribution(&mut html, &points, max_points);
    list(&mut html, students, max_points);
    heat_map(&mut html, grader, students);
    groups(&mut html, students);
    slowest(&mut html, students);
    html.push_str(FOOT);
    html
}

fn distribution(html: &mut String, points: &[f64], max_points: f64) {
    let mut bars = [0_usize; BARS];
    for points in points {
        let fraction = if max_points > 0.0 { points / max_points } else { 0.0 };
        bars[((fraction * BARS as f64) as usize).min(BARS - 1)] += 1;
    }
    let highest = bars.iter().copied().max().unwrap_or(0).max(1);
    html.push_str("<h2>Distribution of points</h2>\n<figure><svg class=\"chart\" viewBox=\"0 0 620 190\" width=\"620\" role=\"img\">\n");
    for (index, &count) in bars.iter().enumerate() {
        let (height, x) = (130.0 * count as f64 / highest as f64, 10 + 60 * index);
        let label = |bar: usize| number(max_points * bar as f64 / BARS as f64);
        _ = writeln!(
            html,
            "<rect x=\"{x}\" y=\"{:.1}\" width=\"54\" height=\"{height:.1}\"/>\
             <text x=\"{}\" y=\"{:.1}\" text-anchor=\"middle\">{count}</text>\
             <text x=\"{}\" y=\"174\" text-anchor=\"middle\">{}</text>",
            155.0 - height,
            x + 27,
            150.0 - height,
            x - 3,
            label(index)
        );
    }
    _ = writeln!(html, "<text x=\"607\" y=\"174\" text-anchor=\"middle\">{}</text>", number(max_points));
    html.push_str("<line x1=\"5\" y1=\"155.5\" x2=\"615\" y2=\"155.5\"/>\n</svg></figure>\n");
}

fn link(student: &Student) -> String {
    format!(
        "<a href=\"students/{0}/index.html\">{1}</a>",
        percent_encoded(&student.submission.folder),
        escaped(&student.submission.name)
    )
}

/// Percent-encodes the name of a folder for a link.
fn percent_encoded(folder: &str) -> String {
    let byte = |byte: u8| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' => char::from(byte).to_string(),
        byte => format!("%{byte:02X}"),
    };
    folder.bytes().map(byte).collect()
}

fn list(html: &mut String, students: &[Student], max_points: f64) {
    html.push_str(
        "<h2>Submissions</h2>\n<div class=\"wide\"><table class=\"list\">\n<tr><th>student</th><th class=\"number\">points</th><th></th>\
         <th class=\"number\">cases</th><th>first failure</th></tr>\n",
    );
    for student in students {
        let percent = if max_points > 0.0 { 100.0 * student.points() / max_points } else { 0.0 };
        _ = writeln!(
            html,
            "<tr class=\"{}\"><td>{}</td><td class=\"number\">{}</td><td><span class=\"bar\"><span style=\"width:{percent:.0}%\"></span>\
             </span></td><td class=\"number\">{} of {}</td><td class=\"message\">{}</td></tr>",
            student.verdict(),
            link(student),
            number(student.points()),
            student.passed(),
            student.graded.results.len(),
            escaped(&shortened(student.message()))
        );
    }
    html.push_str("</table></div>\n");
}

fn shortened(text: &str) -> String {
    const MAX_CHARACTERS: usize = 200;
    let mut short: String = text.chars().take(MAX_CHARACTERS).collect();
    if short.len() < text.len() {
        short.push_str(" ...");
    }
    short
}

/// Writes a table with a row for each student and a column for each check of each variant. Each cell gives the share of
/// the cases that meet the check.
fn heat_map(html: &mut String, grader: &Grader, students: &[Student]) {
    let mut columns: Vec<(&str, usize, &str)> = Vec::new();
    for (name, _) in grader.variants_of_suite() {
        let variants = students.iter().flat_map(|student| &student.variants).filter(|variant| variant.name == name);
        let longest = variants.max_by_key(|variant| variant.checks.len());
        let checks = longest.into_iter().flat_map(|variant| &variant.checks);
        columns.extend(checks.enumerate().map(|(index, (check, _))| (name, index, check.as_str())));
    }
    if columns.is_empty() {
        return;
    }
    html.push_str("<h2>Checks</h2>\n<p>Share of the cases that meet each check.</p>\n<div class=\"wide\"><table class=\"map\">\n<tr><th></th>");
    for (variant, _, check) in &columns {
        let label = if *variant == "run" { String::new() } else { format!("<br>{}", escaped(variant)) };
        _ = write!(html, "<th>{}{label}</th>", escaped(check));
    }
    html.push_str("</tr>\n");
    let mut totals = vec![(0, 0); columns.len()];
    for student in students {
        _ = write!(html, "<tr><th>{}</th>", link(student));
        for (column, (name, index, _)) in columns.iter().enumerate() {
            let variant = student.variants.iter().find(|variant| variant.name == *name);
            let found = variant.and_then(|variant| variant.checks.get(*index));
            totals[column].1 += variant.map_or(0, |variant| variant.rate.count);
            match found {
                Some((_, rate)) => {
                    totals[column].0 += rate.passed;
                    let class = match rate.passed {
                        0 => "failed",
                        passed if passed == rate.count => "passed",
                        _ => "partly",
                    };
                    _ = write!(html, "<td class=\"share {class}\">{:.0}</td>", 100.0 * rate.share());
                }
                None => html.push_str("<td class=\"share error\">?</td>"),
            }
        }
        html.push_str("</tr>\n");
    }
    html.push_str("<tr><th>all</th>");
    for (passed, count) in totals {
        _ = write!(html, "<td>{}</td>", percent((100.0 * passed as f64 / count.max(1) as f64).round() / 100.0));
    }
    html.push_str("</tr>\n</table></div>\n");
}

/// Writes the groups of submissions that behave the same in all cases; marks groups whose files are equal.
fn groups(html: &mut String, students: &[Student]) {
    let mut behaviours: BTreeMap<String, Vec<&Student>> = BTreeMap::new();
    for student in students {
        if let Some(behaviour) = student.graded.behaviour() {
            behaviours.entry(behaviour).or_default().push(student);
        }
    }
    let mut groups: Vec<Vec<&Student>> = behaviours.into_values().filter(|group| group.len() > 1).collect();
    groups.sort_by_key(|group| std::cmp::Reverse(group.len()));
    html.push_str("<h2>Equal behaviour</h2>\n");
    if groups.is_empty() {
        html.push_str("<p>No two submissions behave the same in all cases.</p>\n");
        return;
    }
    html.push_str(
        "<p>These submissions have the same digest in every case: their robots did the same at the same instants. Simple programs may agree \
         by chance; tools that compare sources can read the folder <code>sources</code>.</p>\n<ul>\n",
    );
    for group in groups {
        let files =
            |student: &Student| student.submission.contents.as_ref().ok().map(|contents| contents.files.clone());
        let is_copy = group.windows(2).all(|pair| files(pair[0]) == files(pair[1]));
        let names: Vec<String> = group.iter().map(|student| link(student)).collect();
        let copy = if is_copy { " (equal files)" } else { "" };
        _ = writeln!(html, "<li>{}{copy}</li>", names.join(", "));
    }
    html.push_str("</ul>\n");
}

fn slowest(html: &mut String, students: &[Student]) {
    let mut slowest: Vec<&Student> = students.iter().filter(|student| student.graded.real_time_s > 0.0).collect();
    slowest.sort_by(|a, b| b.graded.real_time_s.total_cmp(&a.graded.real_time_s));
    html.push_str(
        "<h2>Slowest</h2>\n<table class=\"list\">\n<tr><th>student</th><th class=\"number\">s</th><th>cases with a stopped program</th></tr>\n",
    );
    for student in slowest.into_iter().take(MAX_SLOWEST) {
        let is_stopped = |robot: &crate::suite::RowRobot| robot.outcome == sim_core::record::Outcome::Timeout;
        let rows = student.graded.results.iter().map(|result| &result.row);
        let stopped = rows.filter(|row| row.outcome != RowOutcome::Passed && row.robots.iter().any(is_stopped)).count();
        _ = writeln!(
            html,
            "<tr><td>{}</td><td class=\"number\">{:.2}</td><td>{stopped} of {}</td></tr>",
            link(student),
            student.graded.real_time_s,
            student.graded.results.len()
        );
    }
    html.push_str("</table>\n");
}
