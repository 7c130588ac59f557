//! Help on the classic formats: their pages have a section for each keyword.

use lsp_types::{CompletionItem, CompletionItemKind};
use sim_format::{Files, builtin, path};

use super::documents::Document;
use super::item;

/// Explanation of the line at `offset`.
pub fn hover(document: &Document, offset: usize) -> Option<String> {
    let line = &document.text[document.line(offset)];
    let first = line.split_whitespace().next()?.to_lowercase();
    let is_number = first.parse::<f64>().is_ok();
    let section = sections(&document.name).find(|section| match is_number {
        true => section.heading == "Walls",
        false => section.keywords().any(|keyword| keyword == first),
    })?;
    Some(section.text.to_owned())
}

/// Completions at `offset`: keywords and types as the first word of a line, otherwise files.
pub fn completions(document: &Document, offset: usize, files: &dyn Files) -> Vec<CompletionItem> {
    let before = &document.text[document.line(offset).start..offset];
    if !before.trim_start().contains(char::is_whitespace) {
        let keywords = sections(&document.name).flat_map(|section| {
            section
                .keywords()
                .map(|keyword| item(keyword, CompletionItemKind::KEYWORD, section.text))
                .collect::<Vec<_>>()
        });
        let names = builtin::ROBOTS.iter().chain(builtin::OBJECTS.iter());
        let types = names
            .filter(|_| path::extension(&document.name) == "sim")
            .map(|name| item(name, CompletionItemKind::CLASS, ""));
        return keywords.chain(types).collect();
    }
    files_at(document, offset, files)
}

/// Files and folders in the folder of the path that ends at `offset`.
pub fn files_at(document: &Document, offset: usize, files: &dyn Files) -> Vec<CompletionItem> {
    let typed = document.word(offset).map_or("", |(word, start)| &word[..offset - start]);
    let folder = path::folder_of(typed);
    let document_folder = path::folder_of(&document.name);
    let folders = path::candidates(if folder.is_empty() { "." } else { folder }, document_folder, files.home());
    let mut names: Vec<String> = folders.iter().flat_map(|candidate| files.list(candidate)).collect();
    names.retain(|name| !name.is_empty() && !name.starts_with('.'));
    names.sort();
    names.dedup();
    names.iter().map(|name| item(name, CompletionItemKind::FILE, "")).collect()
}

/// A section of a format's page.
struct PageSection {
    heading: &'static str,
    text: &'static str,
}

impl PageSection {
    /// The keywords that the section describes: the words of its heading that are written as code.
    fn keywords(&self) -> impl Iterator<Item = &'static str> {
        self.heading.split('`').skip(1).step_by(2)
    }
}

/// Sections of the page on the format of the file `name`.
fn sections(name: &str) -> impl Iterator<Item = PageSection> {
    let page = match path::extension(name).as_str() {
        "sim" => include_str!("../../../../docs/formats/sim.md"),
        "wld" => include_str!("../../../../docs/formats/wld.md"),
        "robi" => include_str!("../../../../docs/formats/robi.md"),
        "esobj" => include_str!("../../../../docs/formats/esobj.md"),
        _ => "",
    };
    page.split("\n## ").skip(1).map(|text| PageSection { heading: text.lines().next().unwrap_or_default(), text })
}

#[cfg(test)]
mod tests {
    use super::super::documents::Encoding;
    use super::*;
    use sim_format::MemoryFiles;

    fn document(name: &str, text: &str) -> Document {
        Document { name: name.to_owned(), text: text.to_owned(), encoding: Encoding::Utf8 }
    }

    #[test]
    fn each_keyword_has_a_section() {
        for (name, words) in sim_format::KEYWORDS {
            for word in words {
                let text = hover(&document(&format!("/a.{name}"), word), 0);
                assert!(text.is_some_and(|text| text.contains("xample")), "{name}: {word}");
            }
        }
        assert!(hover(&document("/a.wld", "0 0 1 1"), 2).is_some_and(|text| text.contains("centre line")));
        assert_eq!(hover(&document("/a.wld", "ush 0 0"), 2), None);
    }

    #[test]
    fn first_words_complete_to_keywords_and_others_to_files() {
        let files = MemoryFiles::from_iter([("/lab/a.wld", ""), ("/lab/sub/b.wld", "")]);
        let text = "wo\nworld sub/\nS4 1 2 3 ";
        let document = document("/lab/x.sim", text);
        let labels = |offset| -> Vec<String> {
            completions(&document, offset, &files).into_iter().map(|item| item.label).collect()
        };
        let first = labels(2);
        assert!(
            ["world", "marker", "S4", "Soccer"].iter().all(|word| first.iter().any(|label| label == word)),
            "{first:?}"
        );
        assert_eq!(labels(text.find("sub/").expect("a path") + 4), ["b.wld"]);
        assert_eq!(labels(text.len()), ["a.wld", "sub"]);
    }
}
