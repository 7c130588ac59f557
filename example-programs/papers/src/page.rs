//! A page that compares a paper's claims with our results: text, figures, tables and claims, each with a number.
//!
//! The page is one self-contained HTML file. Separate files beside it hold its figures, tables and claims.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use accuracy::figure::Figure as Chart;
use anyhow::Context as _;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use eyesim::plot::chart;

/// The page of a paper.
#[derive(Clone, Debug)]
pub struct Page {
    /// Title.
    pub title: String,
    /// Authors, title and year of the paper.
    pub source: String,
    /// Claims of the paper with our results, shown first.
    pub claims: Vec<Claim>,
    /// Parts below the claims, from top to bottom.
    pub parts: Vec<Part>,
}

/// A part of a page.
#[derive(Clone, Debug)]
pub enum Part {
    /// A heading.
    Heading(String),
    /// A paragraph of plain text.
    Text(String),
    /// A picture.
    Figure(Figure),
    /// Rows and columns.
    Table(Table),
}

/// A picture with its caption and its claim.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Name of its file, without the extension; unique in the page.
    pub name: String,
    /// Figure of the paper with which it is compared (`Figure 8`), or its subject.
    pub label: String,
    /// Description of the picture.
    pub caption: String,
    /// Statement that the picture supports, in words.
    pub claim: String,
    /// Number that quantifies the statement, with its unit.
    pub number: String,
    /// The picture.
    pub picture: Picture,
}

/// A picture's data.
#[derive(Clone, Debug)]
pub enum Picture {
    /// Scalable Vector Graphics without ids, since all pictures of a page are in one document.
    Svg(String),
    /// Portable Network Graphics, shown with sharp pixels, `scale` times as large.
    Png {
        /// The file.
        bytes: Vec<u8>,
        /// Screen pixels for each pixel of the picture, along a side.
        scale: u32,
    },
}

/// Rows and columns of text.
#[derive(Clone, Debug)]
pub struct Table {
    /// Name of its file, without the extension; unique in the page.
    pub name: String,
    /// Description of the table.
    pub caption: String,
    /// Heads of the columns, with units.
    pub head: Vec<String>,
    /// Rows, each with as many cells as there are heads.
    pub rows: Vec<Vec<String>>,
}

/// A claim of the paper and our result.
#[derive(Clone, Debug)]
pub struct Claim {
    /// Section of the paper with the claim, such as `6.3`, or another source of the claim.
    pub section: String,
    /// The claim, in our words.
    pub paper: String,
    /// Our result.
    pub ours: String,
    /// The number that supports the result, with its unit.
    pub number: String,
    /// True if our result agrees with the claim.
    pub holds: bool,
    /// Consequence if our result does not agree.
    pub weight: Weight,
    /// Origin of our result.
    pub basis: Basis,
}

/// Origin of a result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// The result could have been different.
    Found,
    /// The result follows from our own choices or definitions. The claim shows only that the scene is as intended.
    Set,
}

/// Consequence of a claim that does not hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// The command fails.
    Must,
    /// The page reports it: the paper's claim may be wrong, or hold under other conditions.
    Told,
    /// The page reports that the result is undecided: it neither supports nor refutes the paper's claim.
    Open,
}

impl Page {
    /// An empty page.
    pub fn new(title: &str, source: &str) -> Self {
        Self { title: title.to_owned(), source: source.to_owned(), claims: Vec::new(), parts: Vec::new() }
    }

    /// Adds a heading.
    pub fn heading(&mut self, text: impl Into<String>) {
        self.parts.push(Part::Heading(text.into()));
    }

    /// Adds a paragraph.
    pub fn text(&mut self, text: impl Into<String>) {
        self.parts.push(Part::Text(text.into()));
    }

    /// Adds a figure.
    pub fn figure(&mut self, figure: Figure) {
        self.parts.push(Part::Figure(figure));
    }

    /// Adds a table.
    pub fn table(&mut self, table: Table) {
        self.parts.push(Part::Table(table));
    }

    /// The tables, from top to bottom.
    pub fn tables(&self) -> impl Iterator<Item = &Table> {
        self.parts.iter().filter_map(|part| match part {
            Part::Table(table) => Some(table),
            _ => None,
        })
    }

    /// The figures, from top to bottom.
    pub fn figures(&self) -> impl Iterator<Item = &Figure> {
        self.parts.iter().filter_map(|part| match part {
            Part::Figure(figure) => Some(figure),
            _ => None,
        })
    }

    /// Returns true if a claim that must hold does not.
    pub fn has_failed(&self) -> bool {
        self.claims.iter().any(|claim| claim.weight == Weight::Must && !claim.holds)
    }

    /// The claims as a table.
    pub fn claims_table(&self) -> Table {
        let head = ["where", "the paper says", "we find", "number", "basis", "holds"].map(str::to_owned).to_vec();
        let row = |claim: &Claim| {
            let Claim { section, paper, ours, number, .. } = claim;
            [section, paper, ours, number, claim.basis(), claim.verdict()].map(str::to_owned).to_vec()
        };
        let rows = self.claims.iter().map(row).collect();
        Table { name: "claims".to_owned(), caption: "What the paper says, and what we find".to_owned(), head, rows }
    }

    /// The claims as text for a terminal, two lines each.
    pub fn summary(&self) -> String {
        let mut text = format!("{}\n", self.title);
        for claim in &self.claims {
            let Claim { section, paper, ours, number, .. } = claim;
            // Writing to a string cannot fail.
            let _ = writeln!(text, "  {:<5} {section}: {paper}\n        {ours}: {number}", claim.verdict());
        }
        text
    }

    /// Writes the page `index.html` into `folder`, with figures as SVG or PNG and tables as CSV beside it. Returns the
    /// path of the page.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write(&self, folder: &Path) -> anyhow::Result<PathBuf> {
        let write = |name: String, bytes: &[u8]| {
            let path = folder.join(name);
            fs::write(&path, bytes).with_context(|| format!("cannot write `{}`", path.display())).map(|()| path)
        };
        let claims = self.claims_table();
        write("claims.csv".to_owned(), claims.csv().as_bytes())?;
        write("claims.md".to_owned(), claims.markdown().as_bytes())?;
        for part in &self.parts {
            match part {
                Part::Figure(Figure { name, picture: Picture::Svg(svg), .. }) => {
                    write(format!("{name}.svg"), svg.as_bytes())?
                }
                Part::Figure(Figure { name, picture: Picture::Png { bytes, .. }, .. }) => {
                    write(format!("{name}.png"), bytes)?
                }
                Part::Table(table) => write(format!("{}.csv", table.name), table.csv().as_bytes())?,
                Part::Heading(_) | Part::Text(_) => continue,
            };
        }
        write("index.html".to_owned(), self.html().as_bytes())
    }

    /// The page as one file.
    pub fn html(&self) -> String {
        let (title, source) = (escaped(&self.title), escaped(&self.source));
        let mut html = format!(
            "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}</title>\n<style>{STYLE}</style>\n\
             <h1>{title}</h1>\n<p class=\"source\">{source}</p>\n"
        );
        if !self.claims.is_empty() {
            html += &self.claims_table().html();
        }
        for part in &self.parts {
            html += &match part {
                Part::Heading(text) => format!("<h2>{}</h2>\n", escaped(text)),
                Part::Text(text) => format!("<p>{}</p>\n", escaped(text)),
                Part::Figure(figure) => figure.html(),
                Part::Table(table) => table.html(),
            };
        }
        html
    }
}

impl Claim {
    /// The claim's basis as text: `found` or `set`.
    pub fn basis(&self) -> &'static str {
        match self.basis {
            Basis::Found => "found",
            Basis::Set => "set",
        }
    }

    /// The claim's verdict: `yes`, `no`, `open` for an undecided result, or `FAILS` for a claim that must hold and does
    /// not.
    pub fn verdict(&self) -> &'static str {
        match (self.holds, self.weight) {
            (true, _) => "yes",
            (false, Weight::Told) => "no",
            (false, Weight::Open) => "open",
            (false, Weight::Must) => "FAILS",
        }
    }
}

impl Picture {
    /// A chart of curves.
    ///
    /// # Errors
    /// If the drawing library returns an error.
    pub fn chart(figure: &Chart) -> anyhow::Result<Self> {
        let svg = chart::to_svg(figure).with_context(|| format!("the chart `{}`", figure.name))?;
        Ok(Self::Svg(svg))
    }
}

impl Figure {
    fn html(&self) -> String {
        let picture = match &self.picture {
            // The XML declaration belongs only into a separate file.
            Picture::Svg(svg) => svg.find("<svg").map_or(svg.as_str(), |start| &svg[start..]).to_owned(),
            Picture::Png { bytes, scale } => {
                let zoom = format!("image-rendering:pixelated;zoom:{scale}");
                let (name, data) = (escaped(&self.name), STANDARD.encode(bytes));
                format!("<img alt=\"{name}\" style=\"{zoom}\" src=\"data:image/png;base64,{data}\">")
            }
        };
        let [label, caption, claim, number] =
            [&self.label, &self.caption, &self.claim, &self.number].map(|t| escaped(t));
        format!(
            "<figure>\n{picture}\n<figcaption><b>{label}.</b> {caption} <span class=\"claim\">{claim}: <b>{number}</b></span>\
             </figcaption>\n</figure>\n"
        )
    }
}

impl Table {
    /// An empty table with these columns.
    pub fn new(name: &str, caption: &str, head: &[&str]) -> Self {
        let head = head.iter().map(|&text| text.to_owned()).collect();
        Self { name: name.to_owned(), caption: caption.to_owned(), head, rows: Vec::new() }
    }

    /// Adds a row.
    ///
    /// # Panics
    /// If the number of cells differs from the number of heads.
    pub fn row(&mut self, cells: impl IntoIterator<Item = impl ToString>) {
        let cells: Vec<String> = cells.into_iter().map(|cell| cell.to_string()).collect();
        assert_eq!(cells.len(), self.head.len(), "cells and heads of the table `{}`", self.name);
        self.rows.push(cells);
    }

    /// The table as comma-separated values (RFC 4180), with a line of heads.
    pub fn csv(&self) -> String {
        let cell = |text: &String| {
            let is_plain = !text.contains(['"', ',', '\n', '\r']);
            if is_plain { text.clone() } else { format!("\"{}\"", text.replace('"', "\"\"")) }
        };
        let line = |cells: &Vec<String>| cells.iter().map(cell).collect::<Vec<_>>().join(",") + "\n";
        std::iter::once(&self.head).chain(&self.rows).map(line).collect()
    }

    /// The table in Markdown.
    pub fn markdown(&self) -> String {
        let line = |cells: &Vec<String>| {
            let cells: Vec<String> = cells.iter().map(|cell| cell.replace('|', "\\|").replace('\n', " ")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let rule = format!("|{}\n", "---|".repeat(self.head.len()));
        line(&self.head) + &rule + &self.rows.iter().map(line).collect::<String>()
    }

    fn html(&self) -> String {
        let line = |tag: &str, cells: &Vec<String>| {
            let cell = |text: &String| {
                let class = if text == "FAILS" { " class=\"fails\"" } else { "" };
                format!("<{tag}{class}>{}</{tag}>", escaped(text))
            };
            format!("<tr>{}</tr>\n", cells.iter().map(cell).collect::<String>())
        };
        let rows: String = self.rows.iter().map(|row| line("td", row)).collect();
        format!("<table>\n<caption>{}</caption>\n{}{rows}</table>\n", escaped(&self.caption), line("th", &self.head))
    }
}

/// Text escaped for HTML, also within the quotation marks of an attribute.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

const STYLE: &str = "
body { font: 15px/1.5 'DejaVu Sans', sans-serif; max-width: 64em; margin: 2em auto; padding: 0 1em; color: #222; }
h1 { font-size: 1.5em; } h2 { font-size: 1.2em; margin-top: 2em; }
.source { color: #555; }
figure { margin: 1.5em 0; } figure svg, figure img { max-width: 100%; height: auto; border: 1px solid #ddd; }
figcaption { font-size: 0.93em; } .claim { display: block; color: #024; }
table { border-collapse: collapse; margin: 1.5em 0; font-size: 0.9em; }
caption { text-align: left; font-weight: bold; padding-bottom: 0.4em; }
th, td { border: 1px solid #ccc; padding: 0.25em 0.6em; text-align: left; vertical-align: top; }
th { background: #f3f3f3; } .fails { background: #fcc; font-weight: bold; }
";

#[cfg(test)]
mod tests {
    use super::*;

    fn claim(holds: bool, weight: Weight) -> Claim {
        let [section, paper, ours, number] = ["6.3", "a < b", "a & b", "1 mm"].map(str::to_owned);
        Claim { section, paper, ours, number, holds, weight, basis: Basis::Found }
    }

    #[test]
    fn only_violated_must_claims_fail() {
        let mut page = Page::new("T", "S");
        assert!(!page.has_failed());
        page.claims = vec![claim(true, Weight::Must), claim(false, Weight::Told), claim(false, Weight::Open)];
        assert!(!page.has_failed());
        page.claims.push(claim(false, Weight::Must));
        assert!(page.has_failed());
        let verdicts: Vec<_> = page.claims.iter().map(Claim::verdict).collect();
        assert_eq!(verdicts, ["yes", "no", "open", "FAILS"]);
    }

    #[test]
    fn the_page_is_self_contained() {
        let mut page = Page::new("A & B", "S");
        page.claims.push(claim(false, Weight::Must));
        let [name, label, caption, claim, number] = ["f", "Figure 1", "c", "d", "2 mm"].map(str::to_owned);
        let picture = Picture::Svg("<?xml version=\"1.0\"?>\n<svg></svg>".to_owned());
        let figure = Figure { name, label, caption, claim, number, picture };
        page.figure(figure.clone());
        page.figure(Figure {
            name: "g".to_owned(),
            picture: Picture::Png { bytes: vec![1, 2, 3], scale: 2 },
            ..figure
        });
        let html = page.html();
        assert!(html.contains("<h1>A &amp; B</h1>") && html.contains("<td>a &lt; b</td>"), "{html}");
        assert!(html.contains("<svg></svg>") && !html.contains("<?xml"), "{html}");
        assert!(html.contains("src=\"data:image/png;base64,AQID\"") && !html.contains("src=\"g"), "{html}");
        let folder = tempfile::tempdir().expect("a folder");
        let index = page.write(folder.path()).expect("files");
        assert_eq!(fs::read_to_string(index).expect("the page"), html);
        assert!(folder.path().join("f.svg").exists() && folder.path().join("g.png").exists());
    }

    #[test]
    fn cells_keep_their_places() {
        let mut table = Table::new("t", "c", &["a", "b"]);
        table.row(["1,5", "say \"x\""]);
        table.row(["a|b", "2"]);
        assert_eq!(table.csv(), "a,b\n\"1,5\",\"say \"\"x\"\"\"\na|b,2\n");
        assert_eq!(table.markdown(), "| a | b |\n|---|---|\n| 1,5 | say \"x\" |\n| a\\|b | 2 |\n");
    }
}
