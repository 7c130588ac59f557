//! `eyesim accuracy`: measures speed against error, and writes tables, plots, JSON and a page of the docs.

use std::fmt::Write as _;
use std::fs;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use accuracy::figure::Figure;
use accuracy::study::{Effort, Outcome, Row, STUDIES, Study};
use anyhow::{Context, anyhow, bail};
use clap::Args;
use sim_host::files::read_regular;
use sim_host::record::report::write_atomically;

use super::output::{check_outputs, output_path};
use super::output::{print, print_error, say, tell};
use crate::plot::chart;

/// Arguments of `eyesim accuracy`.
#[derive(Args)]
pub struct AccuracyArgs {
    /// The studies to run [default: all]
    #[arg(value_name = "STUDY")]
    pub studies: Vec<String>,
    /// Fewer repetitions: all studies take less than two minutes
    #[arg(long)]
    pub quick: bool,
    /// Write all rows as a JSON array; with `-` the rows go to standard output and the tables to standard error
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write each plot as SVG into this folder, which is created if it is missing
    #[arg(long, value_name = "DIR", value_parser = output_path())]
    pub plots: Option<PathBuf>,
    /// Write the tables into a Markdown page: each between its `<!-- accuracy: STUDY -->` and `<!-- end -->`
    #[arg(long, value_name = "FILE")]
    pub page: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// If a study does not exist, a page lacks the markers for the tables, or a file cannot be written.
pub fn run(args: &AccuracyArgs) -> anyhow::Result<ExitCode> {
    let studies = selected_studies(&args.studies)?;
    let is_json_printed = args.json.as_deref() == Some(Path::new("-"));
    let json_file = args.json.as_deref().filter(|_| !is_json_printed);
    let json = json_file.map(|path| ("--json", path));
    check_outputs(json.as_slice(), args.page.iter().filter_map(|page| page.to_str()))?;
    if let Some(folder) = &args.plots {
        check_folder(folder).with_context(|| format!("--plots `{}`", folder.display()))?;
    }
    let mut page = args.page.as_deref().map(MarkdownPage::read).transpose()?;
    if let Some(page) = &mut page {
        // Checked before measuring, which takes long.
        studies.iter().try_for_each(|study| page.range_of(study.name).map(|_| ()))?;
    }
    let effort = if args.quick { Effort::Quick } else { Effort::Full };
    let mut rows = Vec::new();
    for study in studies {
        let start = Instant::now();
        say(format_args!("{}: {} ...", study.name, study.title));
        let outcome = (study.run)(effort);
        say(format_args!("{}: measured in {:.1} s", study.name, start.elapsed().as_secs_f64()));
        let table = format!("{}\n\n{}\n", study.title, text_table(&outcome.rows));
        if is_json_printed {
            print_error(&table)
        } else {
            tell(table.trim_end_matches('\n'))
        }
        if let Some(folder) = &args.plots {
            write_figures(folder, &study, &outcome)?;
        }
        if let Some(page) = &mut page {
            page.insert(study.name, &markdown_table(&outcome.rows))?;
        }
        rows.extend(outcome.rows);
    }
    if args.json.is_some() {
        let text = serde_json::to_string_pretty(&rows).context("--json")? + "\n";
        match json_file {
            Some(path) => {
                write_atomically(path, text.as_bytes()).with_context(|| format!("--json `{}`", path.display()))?;
            }
            None => print(&text).context("--json")?,
        }
    }
    page.map(|page| page.write()).transpose()?;
    Ok(ExitCode::SUCCESS)
}

/// Creates a folder if it is missing, and checks that files can be created in it.
fn check_folder(folder: &Path) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    tempfile::tempfile_in(folder).map(|_| ())
}

/// The studies with these names; all studies if there are none.
fn selected_studies(names: &[String]) -> anyhow::Result<Vec<Study>> {
    if names.is_empty() {
        return Ok(STUDIES.to_vec());
    }
    let find = |name: &String| {
        STUDIES.iter().find(|study| study.name == name).copied().ok_or_else(|| {
            let names: Vec<&str> = STUDIES.iter().map(|study| study.name).collect();
            anyhow!("there is no study `{name}`, accepted: {}", names.join(", "))
        })
    };
    names.iter().map(find).collect()
}

/// Writes the plot of the rows, and the other plots of the study.
fn write_figures(folder: &Path, study: &Study, outcome: &Outcome) -> anyhow::Result<()> {
    let plot = Figure::of_rows(study.title, &outcome.rows);
    for figure in plot.iter().chain(&outcome.figures) {
        let path = folder.join(&figure.name).with_extension("svg");
        let svg = chart::to_svg(figure)?;
        write_atomically(&path, svg.as_bytes()).with_context(|| format!("--plots `{}`", path.display()))?;
    }
    Ok(())
}

const HEADINGS: [&str; 4] = ["method", "setting", "error", "time"];

fn cells(row: &Row) -> [String; 4] {
    let error = if row.error == 0.0 { "0".to_owned() } else { format!("{:.1e}", row.error) };
    let time = format!("{} a {}", duration(row.time_ns), row.per);
    [row.method.clone(), row.setting.clone(), format!("{error} {}", row.unit), time]
}

/// Duration with three digits and a suitable unit.
fn duration(nanoseconds: f64) -> String {
    let (number, unit) = match nanoseconds {
        ns if ns < 1e3 => (ns, "ns"),
        ns if ns < 1e6 => (ns / 1e3, "us"),
        ns if ns < 1e9 => (ns / 1e6, "ms"),
        ns => (ns / 1e9, "s"),
    };
    let decimals = if number < 10.0 { 2 } else { usize::from(number < 100.0) };
    format!("{number:.decimals$} {unit}")
}

/// Table for a terminal.
fn text_table(rows: &[Row]) -> String {
    let lines: Vec<[String; 4]> = std::iter::once(HEADINGS.map(str::to_owned)).chain(rows.iter().map(cells)).collect();
    let widths: [usize; 4] =
        std::array::from_fn(|column| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or_default());
    let mut text = String::new();
    for line in &lines {
        let columns = line.iter().zip(widths).map(|(cell, width)| format!("{cell:<width$}")).collect::<Vec<_>>();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "  {}", columns.join("  ").trim_end());
    }
    text
}

/// Table for a page of the docs.
fn markdown_table(rows: &[Row]) -> String {
    let mut text = format!("| {} |\n|---|---|---|---|\n", HEADINGS.join(" | "));
    for row in rows {
        let _ = writeln!(text, "| {} |", cells(row).join(" | "));
    }
    text
}

/// Page with markers between which tables are inserted.
struct MarkdownPage {
    path: PathBuf,
    text: String,
}

/// Marker after a table.
const END: &str = "<!-- end -->";

impl MarkdownPage {
    fn read(path: &Path) -> anyhow::Result<Self> {
        let bytes = read_regular(path).with_context(|| format!("--page `{}`", path.display()))?;
        let text = String::from_utf8(bytes).with_context(|| format!("--page `{}`", path.display()))?;
        Ok(Self { path: path.to_owned(), text })
    }

    /// Inserts the table of a study between its markers.
    fn insert(&mut self, study: &str, table: &str) -> anyhow::Result<()> {
        let range = self.range_of(study)?;
        self.text.replace_range(range, &format!("\n{table}"));
        Ok(())
    }

    /// Byte range of a study's table, between its two markers.
    fn range_of(&self, study: &str) -> anyhow::Result<Range<usize>> {
        let marker = format!("<!-- accuracy: {study} -->");
        let path = self.path.display();
        let Some(start) = self.text.find(&marker).map(|position| position + marker.len()) else {
            bail!(
                "--page `{path}` has no section for the table of `{study}`: expected a line `{marker}`, and later `{END}`"
            )
        };
        let Some(length) = self.text[start..].find(END) else {
            bail!("--page `{path}`: expected `{END}` after `{marker}`")
        };
        Ok(start..start + length)
    }

    fn write(self) -> anyhow::Result<()> {
        write_atomically(&self.path, self.text.as_bytes()).with_context(|| format!("--page `{}`", self.path.display()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(error: f64, time_ns: f64) -> Row {
        let (method, setting) = ("closed-form".to_owned(), "slot of 1 ms".to_owned());
        Row { study: "drive", method, setting, error, unit: "m", time_ns, per: "second" }
    }

    #[test]
    fn times_have_three_digits() {
        let texts = [0.5, 12.34, 999.4, 1_234.0, 56_780.0, 1e9, 2.5e11].map(duration);
        assert_eq!(texts, ["0.50 ns", "12.3 ns", "999 ns", "1.23 us", "56.8 us", "1.00 s", "250 s"]);
    }

    #[test]
    fn table_is_replaced_between_its_markers() {
        let mut page = MarkdownPage {
            path: PathBuf::from("p.md"),
            text: "a\n<!-- accuracy: drive -->\nold\n<!-- end -->\nb <!-- end -->\n".to_owned(),
        };
        for _ in 0..2 {
            page.insert("drive", &markdown_table(&[row(0.0, 5.0)])).expect("there is a section");
            let table = "| method | setting | error | time |\n|---|---|---|---|\n\
                         | closed-form | slot of 1 ms | 0 m | 5.00 ns a second |\n";
            assert_eq!(page.text, format!("a\n<!-- accuracy: drive -->\n{table}<!-- end -->\nb <!-- end -->\n"));
        }
        assert!(page.insert("contact", "").is_err_and(|error| error.to_string().contains("accuracy: contact")));
    }

    #[test]
    fn columns_are_aligned() {
        let text = text_table(&[row(1.3e-10, 5.0), row(0.0, 1e12)]);
        assert_eq!(
            text,
            "  method       setting       error      time\n  \
             closed-form  slot of 1 ms  1.3e-10 m  5.00 ns a second\n  \
             closed-form  slot of 1 ms  0 m        1000 s a second\n"
        );
    }
}
