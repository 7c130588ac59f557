//! References in the documentation point to existing targets.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tests::root;

/// All Markdown files of the repository, relative to its root.
fn pages() -> Vec<PathBuf> {
    fn collect(folder: &Path, pages: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).expect("a folder") {
            let path = entry.expect("an entry").path();
            let name = path.file_name().expect("a name").to_string_lossy();
            if path.is_dir() && !name.starts_with('.') && name != "target" && name != "node_modules" {
                collect(&path, pages);
            } else if path.extension().is_some_and(|extension| extension == "md") {
                pages.push(path);
            }
        }
    }
    let mut pages = Vec::new();
    collect(root(), &mut pages);
    pages.sort();
    assert!(pages.len() >= 10, "{pages:?}");
    pages
}

/// The text without fenced blocks, since their brackets are not links.
fn prose(text: &str) -> String {
    let mut inside = false;
    let lines = text.lines().filter(|line| {
        let fence = line.trim_start().starts_with("```");
        inside ^= fence;
        !inside && !fence
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// Targets of `[text](target)` and `![text](target)`.
fn links(text: &str) -> Vec<&str> {
    text.split("](").skip(1).filter_map(|rest| rest.split_once(')')).map(|(target, _)| target).collect()
}

/// The anchor of a heading: lower case, blanks become hyphens, punctuation is dropped.
fn anchor(heading: &str) -> String {
    let slug = heading.trim().to_lowercase();
    slug.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// Error of a link on a page, if any.
fn broken(page: &Path, link: &str) -> Option<String> {
    if link.contains("://") || link.starts_with("mailto:") {
        return None;
    }
    let (file, fragment) = link.split_once('#').unwrap_or((link, ""));
    let target = if file.is_empty() { page.to_owned() } else { page.parent().expect("a folder").join(file) };
    if !target.exists() {
        return Some(format!("{}: the target of `{link}` does not exist", page.display()));
    }
    if fragment.is_empty() {
        return None;
    }
    let text = prose(&fs::read_to_string(&target).expect("a page"));
    let found =
        text.lines().filter(|line| line.starts_with('#')).any(|line| anchor(line.trim_start_matches('#')) == fragment);
    (!found).then(|| format!("{}: the page has no heading for `{link}`", page.display()))
}

#[test]
fn links_lead_to_files_of_the_repository() {
    let mut checked = 0;
    let mut wrong = Vec::new();
    for page in pages() {
        let text = prose(&fs::read_to_string(&page).expect("a page"));
        for link in links(&text) {
            checked += 1;
            wrong.extend(broken(&page, link));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(checked >= 20, "{checked} links only");
}

#[test]
fn broken_links_are_detected() {
    let page = root().join("README.md");
    assert_eq!(links("see [a](docs/a.md), ![b](b.svg)"), ["docs/a.md", "b.svg"]);
    assert!(broken(&page, "docs/no-such-page.md").is_some());
    assert!(broken(&page, "docs/robios6.md#no-such-heading").is_some());
    assert_eq!(broken(&page, "docs/robios6.md#cost-table"), None);
}

/// Paths in the list of rooms; an indented name belongs to the name above it.
fn rooms(architecture: &str) -> Vec<String> {
    let (_, list) = architecture.split_once("```text\n").expect("the list of rooms");
    let (list, _) = list.split_once("```").expect("its end");
    let mut parent = "";
    let mut paths = Vec::new();
    for line in list.lines() {
        // One column contains several names; the description begins after two or more blanks.
        let (names, _) = line.trim_start().split_once("  ").unwrap_or((line.trim(), ""));
        let nested = line.starts_with(' ');
        for name in names.split_whitespace() {
            paths.push(if nested { format!("{parent}src/{name}") } else { name.to_owned() });
            if !nested {
                parent = name;
            }
        }
    }
    paths
}

#[test]
fn the_architecture_names_rooms_that_exist() {
    let text = fs::read_to_string(root().join("ARCHITECTURE.md")).expect("ARCHITECTURE.md");
    let rooms = rooms(&text);
    assert!(rooms.len() >= 15, "{rooms:?}");
    // A module is a folder or the file with its name.
    let missing = |path: &&String| {
        let path = root().join(path.trim_end_matches('/'));
        !path.exists() && !path.with_extension("rs").exists()
    };
    assert_eq!(rooms.iter().filter(missing).collect::<Vec<_>>(), Vec::<&String>::new());
}

/// Files that the pages name in backquotes with a folder, such as `sim-host/src/robios/costs.toml`.
fn named_files(text: &str) -> BTreeSet<&str> {
    const FOLDERS: &[&str] = &[
        "sim-core/",
        "sim-host/",
        "eyesim/src/",
        "robios-sys/",
        "robios-api/",
        "accuracy/",
        "sims/",
        "worlds/",
        "robis/",
        "docs/",
        ".ci/",
    ];
    let quoted = text.split('`').skip(1).step_by(2);
    quoted
        .filter(|word| FOLDERS.iter().any(|folder| word.starts_with(folder)) && !word.contains([' ', '*', '<']))
        .collect()
}

#[test]
fn files_named_by_the_pages_exist() {
    let mut wrong = Vec::new();
    let mut checked = 0;
    for page in pages() {
        let text = prose(&fs::read_to_string(&page).expect("a page"));
        for name in named_files(&text) {
            checked += 1;
            if !root().join(name).exists() && !root().join(format!("{name}.rs")).exists() {
                wrong.push(format!("{}: `{name}`", page.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(checked >= 5, "{checked} files only");
}

#[test]
fn scenes_of_the_list_are_the_scenes_of_the_folder() {
    let text = fs::read_to_string(root().join("sims/README.md")).expect("sims/README.md");
    let listed: BTreeSet<String> = text
        .lines()
        .filter_map(|line| line.strip_prefix("| `")?.split_once('`'))
        .map(|(name, _)| name.to_owned())
        .collect();
    let there: BTreeSet<String> = fs::read_dir(root().join("sims"))
        .expect("sims")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .filter(|name| name.ends_with(".sim") || name.ends_with(".scene.toml"))
        .collect();
    assert_eq!(listed, there);
}

#[test]
fn a_fresh_checkout_has_no_file_that_names_a_machine() {
    let listed = Command::new("git").args(["ls-files", "-z"]).current_dir(root()).output();
    let Some(listed) = listed.ok().filter(|listed| listed.status.success()) else {
        println!("skipped: not a git checkout");
        return;
    };
    let home = concat!("/ho", "me/");
    // A folder of that name in a relative path is not a path of a machine.
    let is_absolute = |text: &str, at: usize| !text[..at].ends_with(|before: char| before.is_alphanumeric());
    let names = String::from_utf8(listed.stdout).expect("names in UTF-8");
    let pages =
        names.split('\0').filter(|name| name.ends_with(".md") || name.ends_with(".toml") || name.ends_with(".sim"));
    let wrong: Vec<_> = pages
        .filter(|name| {
            fs::read_to_string(root().join(name))
                .is_ok_and(|text| text.match_indices(home).any(|(at, _)| is_absolute(&text, at)))
        })
        .collect();
    assert_eq!(wrong, Vec::<&str>::new());
}

#[test]
fn the_list_of_diagnostics_is_that_of_their_pages() {
    let folder = root().join("docs/formats/codes");
    let mut rows: Vec<String> = fs::read_dir(&folder)
        .expect("the pages of the codes")
        .map(|entry| {
            let path = entry.expect("an entry").path();
            let code = path.file_stem().expect("a name").to_string_lossy().into_owned();
            let text = fs::read_to_string(&path).expect("a page");
            // The third line has the form `**warning**: message`.
            let (severity, message) = text.lines().nth(2).and_then(|line| line.split_once(": ")).expect("the message");
            format!(
                "| [`{code}`](codes/{code}.md) | {} | {} |\n",
                severity.replace("**", ""),
                message.replace('|', "\\|")
            )
        })
        .collect();
    rows.sort();
    let expected = format!(
        "# Diagnostics\n\nThis page lists the messages of the readers of files by their codes. `eyesim explain CODE` prints the page of a code. \
         `INSTA_UPDATE=always cargo test\n--workspace --test black_box docs::` writes this list.\n\n\
         | code | severity | message |\n|---|---|---|\n{}",
        rows.concat()
    );
    let page = folder.with_extension("md");
    if std::env::var("INSTA_UPDATE").is_ok_and(|value| value == "always") {
        fs::write(&page, &expected).expect("the page is writable");
    }
    assert_eq!(fs::read_to_string(page).expect("the page"), expected);
}
