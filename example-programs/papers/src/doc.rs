//! A page of the docs with sections for tables: `<!-- papers: PAPER -->` begins the section of a paper's claims,
//! `<!-- papers: PAPER/TABLE -->` that of one of its tables. The next `<!-- end -->` ends a section.

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};

use crate::page::{Page, Picture};

/// A Markdown page.
#[derive(Clone, Debug)]
pub struct Doc {
    path: PathBuf,
    text: String,
}

const BEGIN: &str = "<!-- papers: ";
const CLOSE: &str = " -->\n";
const END: &str = "<!-- end -->";

impl Doc {
    /// Reads the page.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let text = fs::read_to_string(path).with_context(|| format!("cannot read `{}`", path.display()))?;
        Ok(Self { path: path.to_owned(), text })
    }

    /// Writes the tables of a paper into their sections.
    ///
    /// # Errors
    /// If there is no section for the claims, the paper does not have a table of the page, or a section has no end.
    pub fn set(&mut self, paper: &str, page: &Page) -> anyhow::Result<()> {
        // From the last to the first, so that the ranges of earlier sections stay valid.
        for (range, table) in self.sections(paper, page)?.into_iter().rev() {
            self.text.replace_range(range, &table);
        }
        Ok(())
    }

    /// Writes the figures and tables to which the page links into the folder `papers` beside the page.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write_linked(&self, page: &Page) -> anyhow::Result<()> {
        let folder = self.path.with_file_name("papers");
        let svgs = page.figures().filter_map(|figure| match &figure.picture {
            Picture::Svg(svg) => Some((format!("{}.svg", figure.name), svg.clone())),
            Picture::Png { .. } => None,
        });
        let csvs = page.tables().map(|table| (format!("{}.csv", table.name), table.csv()));
        for (name, text) in svgs.chain(csvs).filter(|(name, _)| self.text.contains(&format!("](papers/{name})"))) {
            fs::create_dir_all(&folder).with_context(|| format!("cannot make the folder `{}`", folder.display()))?;
            let path = folder.join(name);
            fs::write(&path, text).with_context(|| format!("cannot write `{}`", path.display()))?;
        }
        Ok(())
    }

    /// Differences between the tables of a paper and the page, as one message for each line.
    ///
    /// # Errors
    /// If there is no section for the claims, the paper does not have a table of the page, or a section has no end.
    pub fn differences(&self, paper: &str, page: &Page) -> anyhow::Result<Vec<String>> {
        let path = self.path.display();
        let mut differences = Vec::new();
        for (range, table) in self.sections(paper, page)? {
            let first = self.text[..range.start].lines().count() + 1;
            let (mut old, mut new) = (self.text[range].lines(), table.lines());
            let mut line = first;
            loop {
                match (old.next(), new.next()) {
                    (None, None) => break,
                    (old, new) if old == new => {}
                    (old, new) => {
                        let (old, new) = (old.unwrap_or("nothing"), new.unwrap_or("nothing"));
                        differences.push(format!("`{path}`, line {line}: it says\n  {old}\nbut we find\n  {new}"));
                    }
                }
                line += 1;
            }
        }
        Ok(differences)
    }

    /// Writes the page.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(self) -> anyhow::Result<()> {
        fs::write(&self.path, self.text).with_context(|| format!("cannot write `{}`", self.path.display()))
    }

    /// Places of a paper's tables, from top to bottom, each with its new content.
    ///
    /// # Errors
    /// If there is no section for the claims, the paper does not have a table of the page, or a section has no end.
    fn sections(&self, paper: &str, page: &Page) -> anyhow::Result<Vec<(Range<usize>, String)>> {
        let path = self.path.display();
        let mut ranges = Vec::new();
        let mut has_claims = false;
        for (at, _) in self.text.match_indices(BEGIN) {
            let rest = &self.text[at + BEGIN.len()..];
            let Some(name) = rest.split_once(CLOSE).map(|(name, _)| name) else { continue };
            let table = match name.split_once('/') {
                None if name == paper => page.claims_table(),
                Some((owner, table)) if owner == paper => match page.tables().find(|own| own.name == table) {
                    Some(table) => table.clone(),
                    None => bail!("`{path}`: `{paper}` has no table `{table}`"),
                },
                _ => continue,
            };
            has_claims |= name == paper;
            let start = at + BEGIN.len() + name.len() + CLOSE.len();
            let Some(length) = self.text[start..].find(END) else { bail!("`{path}`: expected `{END}` after `{name}`") };
            ranges.push((start..start + length, table.markdown()));
        }
        if !has_claims {
            bail!(
                "`{path}` has no section for the claims of `{paper}`: expected a line `{BEGIN}{paper} -->`, and later `{END}`"
            );
        }
        Ok(ranges)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::Table;

    fn doc(text: &str) -> Doc {
        Doc { path: PathBuf::from("p.md"), text: text.to_owned() }
    }

    fn page() -> Page {
        let mut page = Page::new("T", "S");
        let mut table = Table::new("rows", "c", &["a"]);
        table.row(["1"]);
        page.table(table);
        page
    }

    #[test]
    fn tables_are_written_between_their_markers() {
        let mut doc = doc("x\n<!-- papers: wu -->\nold\n<!-- end -->\ny\n<!-- papers: wu/rows -->\n<!-- end -->\n");
        assert!(!doc.differences("wu", &page()).expect("sections").is_empty());
        for _ in 0..2 {
            doc.set("wu", &page()).expect("sections");
            assert!(
                doc.text.ends_with("y\n<!-- papers: wu/rows -->\n| a |\n|---|\n| 1 |\n<!-- end -->\n"),
                "{}",
                doc.text
            );
        }
        assert_eq!(doc.differences("wu", &page()).expect("sections"), Vec::<String>::new());
        doc.text = doc.text.replace("| 1 |", "| 2 |");
        let differences = doc.differences("wu", &page()).expect("sections");
        assert_eq!(differences, ["`p.md`, line 10: it says\n  | 2 |\nbut we find\n  | 1 |"]);
    }

    #[test]
    fn a_missing_marker_and_a_marker_without_a_table_are_reported() {
        let message = |text: &str| doc(text).differences("wu", &page()).expect_err("no section").to_string();
        assert!(message("").contains("no section for the claims of `wu`"));
        assert!(message("<!-- papers: wu -->\n").contains("expected `<!-- end -->` after `wu`"));
        assert!(message("<!-- papers: wu/x -->\n<!-- end -->").contains("`wu` has no table `x`"));
    }
}
