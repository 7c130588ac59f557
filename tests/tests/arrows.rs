//! Dependencies between the rooms of a crate: the table in ARCHITECTURE.md lists exactly the `use`s in the code.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use tests::root;

/// For each room of a crate: the rooms that it uses.
type Arrows = BTreeMap<String, BTreeSet<String>>;

/// Dependencies in the table of ARCHITECTURE.md, whose rows are crate, room, and the rooms that it uses.
fn documented() -> BTreeMap<String, Arrows> {
    let page = std::fs::read_to_string(root().join("ARCHITECTURE.md")).expect("the page");
    let (_, table) = page.split_once("| crate | room | uses |\n|---|---|---|\n").expect("the table of arrows");
    let mut crates: BTreeMap<String, Arrows> = BTreeMap::new();
    for row in table.lines().take_while(|line| line.starts_with('|')) {
        let cells: Vec<&str> = row.trim_matches('|').split('|').map(str::trim).collect();
        let [name, room, uses] = cells[..] else { panic!("`{row}`: three cells") };
        let uses = uses.split(", ").filter(|room| !room.is_empty()).map(str::to_owned).collect();
        crates.entry(name.to_owned()).or_default().insert(room.to_owned(), uses);
    }
    crates
}

/// Dependencies in the sources of a crate.
fn found(name: &str) -> Arrows {
    let source = root().join(name).join("src");
    let mut arrows = Arrows::new();
    walk(&source, &mut |path| {
        let relative = path.strip_prefix(&source).expect("a path below the sources");
        let room = relative.iter().next().expect("a name").to_string_lossy();
        let room = room.strip_suffix(".rs").unwrap_or(&room).to_owned();
        if room == "lib" || room == "main" {
            return;
        }
        let uses = uses_of(&std::fs::read_to_string(path).expect("a source"));
        arrows.entry(room.clone()).or_default().extend(uses.into_iter().filter(|other| *other != room));
    });
    // Functions and types that the crate's root re-exports are not rooms.
    let rooms: BTreeSet<String> = arrows.keys().cloned().collect();
    arrows.values_mut().for_each(|uses| uses.retain(|name| rooms.contains(name)));
    arrows.retain(|_, uses| !uses.is_empty());
    arrows
}

fn walk(folder: &Path, visit: &mut impl FnMut(&Path)) {
    for entry in std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()) {
        let is_test = entry.file_stem().is_some_and(|name| name == "tests");
        if entry.is_dir() && !is_test {
            walk(&entry, visit);
        } else if entry.extension().is_some_and(|ending| ending == "rs") && !is_test {
            visit(&entry);
        }
    }
}

/// The rooms that a source file names after `crate::`, except in comments and tests.
fn uses_of(text: &str) -> Vec<String> {
    let text = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let code: String = text.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n");
    let letter = |letter: char| letter.is_alphanumeric() || letter == '_';
    let inline =
        code.split("crate::").skip(1).map(|rest| rest.split(|other| !letter(other)).next().unwrap_or_default());
    let mut names: Vec<String> = inline.filter(|name| !name.is_empty()).map(str::to_owned).collect();
    let statements = code.split("use crate::").skip(1).filter_map(|rest| rest.split_once(';'));
    for (tree, _) in statements {
        let mut depth = 0;
        let mut name = String::new();
        for letter in tree.trim_start_matches('{').chars().chain([',']) {
            match letter {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth <= 0 => {
                    let room = name.split("::").next().unwrap_or_default().trim();
                    names.extend((!room.is_empty()).then(|| room.to_owned()));
                    name.clear();
                }
                letter if depth <= 0 => name.push(letter),
                _ => {}
            }
        }
    }
    names
}

#[test]
fn rooms_use_exactly_the_rooms_in_the_table() {
    let documented = documented();
    assert_eq!(documented.keys().collect::<Vec<_>>(), ["eyesim", "sim-core", "sim-host"]);
    for (name, documented) in documented {
        let found = found(&name);
        let row = |(room, uses): (&String, &BTreeSet<String>)| {
            format!("| {name} | {room} | {} |", uses.iter().cloned().collect::<Vec<_>>().join(", "))
        };
        let [found, documented] = [&found, &documented].map(|arrows| arrows.iter().map(row).collect::<Vec<_>>());
        assert_eq!(found, documented, "rows of the sources, rows of ARCHITECTURE.md");
    }
}

#[test]
fn rooms_have_no_cyclic_dependencies() {
    for name in ["sim-core", "sim-host", "eyesim"] {
        let mut rooms = found(name);
        loop {
            let left: BTreeSet<String> = rooms.keys().cloned().collect();
            // A room that uses none of the remaining rooms is below all of them.
            rooms.retain(|_, uses| !uses.is_disjoint(&left));
            if rooms.len() == left.len() {
                break;
            }
        }
        assert!(rooms.is_empty(), "circles among {rooms:#?} of {name}");
    }
}

#[test]
fn nested_names_are_understood() {
    let text = "use crate::{\n    a::{b, c},\n    d,\n};\nuse crate::e::f;\n// crate::i\nfn j() { crate::h::k() }\n#[cfg(test)]\nmod tests {\n    use crate::g;\n}\n";
    let uses: BTreeSet<String> = uses_of(text).into_iter().collect();
    assert_eq!(uses.into_iter().collect::<Vec<_>>(), ["a", "d", "e", "h"]);
}
