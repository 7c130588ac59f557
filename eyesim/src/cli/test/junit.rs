//! Results of suites in JUnit format.

use std::io;
use std::time::Duration;

use quick_xml::Writer;
use quick_xml::events::{BytesDecl, BytesText, Event};

use crate::suite::{CaseResult, RowOutcome};

/// Cases of a suite.
pub(in crate::cli) struct Cases<'r> {
    /// Name of the suite.
    pub suite: &'r str,
    /// Results of the cases that have run.
    pub results: Vec<&'r CaseResult>,
    /// Names of the selected cases that have not run.
    pub missing: Vec<&'r str>,
}

impl Cases<'_> {
    /// Number of results with this outcome.
    fn count(&self, outcome: RowOutcome) -> usize {
        self.results.iter().filter(|result| result.row.outcome == outcome).count()
    }

    /// The attributes `tests`, `failures` and `errors` of these suites.
    fn counts(suites: &[Self]) -> [(&'static str, String); 3] {
        let sum = |count: &dyn Fn(&Self) -> usize| suites.iter().map(count).sum::<usize>().to_string();
        [
            ("tests", sum(&|cases| cases.results.len() + cases.missing.len())),
            ("failures", sum(&|cases| cases.count(RowOutcome::Failed))),
            ("errors", sum(&|cases| cases.count(RowOutcome::Error))),
        ]
    }
}

/// The JUnit document of these suites.
pub(in crate::cli) fn document<'r>(
    suites: impl Iterator<Item = Cases<'r>>,
    elapsed: Duration,
) -> anyhow::Result<String> {
    let suites: Vec<_> = suites.collect();
    let mut writer = Writer::new_with_indent(Vec::new(), b' ', 4);
    writer.write_event(Event::Decl(BytesDecl::new("1.0", Some("UTF-8"), None)))?;
    let attributes = [("name", "eyesim".to_owned()), ("time", seconds(elapsed.as_secs_f64()))];
    let attributes = attributes.into_iter().chain(Cases::counts(&suites));
    element(&mut writer, "testsuites", attributes, |writer| {
        suites.iter().try_for_each(|cases| write_suite(writer, cases))
    })?;
    writer.write_indent()?;
    Ok(String::from_utf8(writer.into_inner())?)
}

fn write_suite(writer: &mut Writer<Vec<u8>>, cases: &Cases<'_>) -> io::Result<()> {
    let Cases { suite, results, missing } = cases;
    let disabled = missing.len() + cases.count(RowOutcome::Interrupted);
    let attributes = [
        ("name", (*suite).to_owned()),
        ("disabled", disabled.to_string()),
        ("time", seconds(results.iter().map(|result| result.real_time_s).sum())),
    ];
    let attributes = attributes.into_iter().chain(Cases::counts(std::slice::from_ref(cases)));
    element(writer, "testsuite", attributes, |writer| {
        results.iter().try_for_each(|result| write_case(writer, suite, result))?;
        missing.iter().try_for_each(|missing| {
            let attributes = [("name", (*missing).to_owned()), ("classname", (*suite).to_owned())];
            element(writer, "testcase", attributes, |writer| {
                element(writer, "skipped", [("message", "not run".to_owned())], |_| Ok(()))
            })
        })
    })
}

fn write_case(writer: &mut Writer<Vec<u8>>, suite: &str, result: &CaseResult) -> io::Result<()> {
    let row = &result.row;
    let attributes = [
        ("name", row.case.clone()),
        ("classname", suite.to_owned()),
        ("assertions", row.checks.len().to_string()),
        ("time", seconds(result.real_time_s)),
    ];
    let write_failure = |writer: &mut _, tag, kind: &str| {
        let checks = row.checks.iter().filter(|check| !check.passed);
        let mut lines: Vec<String> = checks.map(|check| format!("{}: {}", check.name, check.message)).collect();
        lines.extend(Some(row.details.clone()).filter(|details| !details.is_empty()));
        lines.extend(row.view_command().map(|command| format!("to see it: {command}")));
        let attributes = [("message", row.message.clone()), ("type", kind.to_owned())];
        element(writer, tag, attributes, |writer| write_text(writer, &lines))
    };
    element(writer, "testcase", attributes, |writer| {
        match row.outcome {
            RowOutcome::Passed => {}
            RowOutcome::Failed => write_failure(writer, "failure", "failed")?,
            RowOutcome::Error => write_failure(writer, "error", "error")?,
            RowOutcome::Interrupted => element(writer, "skipped", [], |_| Ok(()))?,
        }
        if result.output.is_empty() {
            return Ok(());
        }
        element(writer, "system-out", [], |writer| write_text(writer, &result.output))
    })
}

/// Writes an element with these attributes, and with what `write_content` writes.
fn element(
    writer: &mut Writer<Vec<u8>>,
    tag: &str,
    attributes: impl IntoIterator<Item = (&'static str, String)>,
    write_content: impl FnOnce(&mut Writer<Vec<u8>>) -> io::Result<()>,
) -> io::Result<()> {
    let mut element = writer.create_element(tag);
    for (name, value) in attributes {
        element = element.with_attribute((name, printable(&value).as_str()));
    }
    element.write_inner_content(write_content).map(drop)
}

fn write_text(writer: &mut Writer<Vec<u8>>, lines: &[String]) -> io::Result<()> {
    writer.write_event(Event::Text(BytesText::new(&printable(&lines.join("\n")))))
}

/// The text without colours and without the control characters that XML forbids.
fn printable(text: &str) -> String {
    let is_allowed = |letter: &char| match letter {
        '\t' | '\n' | '\r' | '\x7f' => true,
        '\u{fffe}' | '\u{ffff}' => false,
        letter => !letter.is_ascii_control(),
    };
    console::strip_ansi_codes(text).chars().filter(is_allowed).collect()
}

fn seconds(seconds: f64) -> String {
    // The sum of no numbers is -0.
    format!("{:.3}", seconds + 0.0)
}
