//! The pages of docs/formats/: their examples can be read, and every keyword has a section.

use std::fs;
use std::path::PathBuf;

use sim_format::{Code, Diagnostic, read_esobj, read_maze, read_robi, read_sim, read_world};

/// Page, with the reader of its kind of file.
struct Page {
    name: &'static str,
    read: fn(&str) -> Vec<Diagnostic>,
    /// Lines inserted before an example, so that only the example can be wrong.
    before: &'static str,
    /// Code for a word that is not a keyword.
    unknown: Code,
}

const PAGES: [Page; 4] = [
    Page { name: "sim", read: |text| read_sim("a.sim", text).1, before: "world a.wld\n", unknown: Code::SimKeyword },
    Page {
        name: "wld",
        read: |text| read_world("a.wld", text).1,
        before: "floor 9000 9000\npush 0 0 0\n",
        unknown: Code::WldKeyword,
    },
    Page { name: "robi", read: |text| read_robi("a.robi", text).1, before: "", unknown: Code::RobiKeyword },
    Page { name: "esobj", read: |text| read_esobj("a.esObj", text).1, before: "", unknown: Code::EsobjKeyword },
];

impl Page {
    fn text(&self) -> String {
        text(self.name)
    }

    /// Keywords, from the reader's message about a misspelt one.
    fn keywords(&self) -> Vec<String> {
        let reported = (self.read)("qwertz\n");
        let unknown = reported.iter().find(|diagnostic| diagnostic.code == self.unknown).expect("an unknown keyword");
        let (_, list) = unknown.expected.split_once("one of ").expect("a list of keywords");
        let words = list.split(", ").map(str::to_owned);
        words.filter(|word| word.chars().all(|c| c.is_ascii_lowercase() || c == '_')).collect()
    }
}

fn text(name: &str) -> String {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("../docs/formats/{name}.md"));
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Texts in backquotes within sentences that begin with `Example:` or `Examples:`.
fn examples(text: &str) -> Vec<String> {
    let paragraphs = text.split("\n\n").filter(|paragraph| !paragraph.starts_with('|'));
    let behind = paragraphs.filter_map(|paragraph| {
        let (_, behind) = paragraph.split_once("Example: ").or_else(|| paragraph.split_once("Examples: "))?;
        Some(behind.replace('\n', " "))
    });
    let quoted = |text: String| text.split('`').skip(1).step_by(2).map(str::to_owned).collect::<Vec<_>>();
    behind.flat_map(quoted).filter(|word| !word.ends_with(".md")).collect()
}

/// The blocks fenced as text.
fn blocks(text: &str) -> Vec<&str> {
    text.split("```text\n").skip(1).filter_map(|rest| rest.split("```").next()).collect()
}

#[test]
fn lines_shown_as_examples_are_read() {
    for page in PAGES {
        let examples = examples(&page.text());
        assert!(examples.len() > 5, "{}.md: {examples:?}", page.name);
        for example in examples {
            let reported = (page.read)(&format!("{}{example}\n", page.before));
            // Lines missing in a file of one line are not the example's fault.
            let wrong = reported.iter().find(|diagnostic| {
                let name = diagnostic.code.name();
                diagnostic.code == page.unknown
                    || name.contains("-arity")
                    || name.starts_with("number-")
                    || name == "word-extra"
            });
            assert!(wrong.is_none(), "{}.md: `{example}`: {}", page.name, wrong.expect("a mistake"));
        }
    }
}

#[test]
fn files_shown_as_examples_have_no_mistake() {
    for page in PAGES {
        let text = page.text();
        assert!(!blocks(&text).is_empty(), "{}.md shows no file", page.name);
        for block in blocks(&text) {
            assert_eq!((page.read)(block), [], "{}.md:\n{block}", page.name);
        }
    }
    for block in blocks(&text("maz")) {
        assert_eq!(read_maze("a.maz", block).1, [], "{block}");
    }
}

#[test]
fn every_keyword_has_its_section() {
    for page in PAGES {
        let text = page.text();
        let headings: Vec<&str> = text.lines().filter(|line| line.starts_with("## ")).collect();
        let keywords = page.keywords();
        assert!(keywords.len() > 3, "{}: {keywords:?}", page.name);
        for keyword in keywords {
            // Synonyms of a keyword are listed in its section, with their values.
            let is_there = headings.iter().any(|heading| heading.contains(&format!("`{keyword}`")))
                || text.contains(&format!("| `{keyword}` "))
                || text.contains(&format!("`{keyword} FILE`"));
            assert!(is_there, "{}.md has no section on `{keyword}`; it has {headings:?}", page.name);
        }
    }
}

#[test]
fn tables_have_the_documented_columns() {
    for page in PAGES {
        let text = page.text();
        let sections = text.split("\n## ").skip(1).filter(|section| section.starts_with('`'));
        for section in sections.filter(|section| section.contains('|')) {
            let header = "| value | type | unit | default | range | meaning |";
            let name = section.lines().next().unwrap_or_default();
            assert!(section.contains(header), "{}.md: {name} has no table `{header}`", page.name);
            let states = ["All dialects", "Classic", "VR", "Ours"].iter().any(|word| section.contains(word));
            assert!(states, "{}.md: {name} does not say of which dialect it is", page.name);
            let rows = section.lines().filter(|line| line.starts_with('|'));
            let cells = |row: &str| row.replace("\\|", "").matches('|').count() - 1;
            assert!(rows.clone().all(|row| cells(row) == 6 || !section.contains(header)), "{}.md: {name}", page.name);
        }
    }
}
