//! Translates some messages of the Rust compiler into plain words; most messages need no translation.

use std::fs;
use std::path::Path;

use super::hint::quoted;
use super::plain::RECURSION;

/// Maximum number of names that are suggested for an unknown name.
const MAX_NAMES: usize = 5;

/// Parts of messages, each with its translation.
const TRANSLATIONS: &[(&str, &str)] = &[
    ("cannot return without recursing", RECURSION),
    ("did not contain valid UTF-8", "the file is not saved as UTF-8: save it as UTF-8 in the editor"),
    ("attempt to divide `", "this divides by 0"),
    (
        "this operation will panic at runtime",
        "this cannot work: an index is outside of its array, or a number does not fit",
    ),
    ("isn't initialized", "the variable has no value yet: give it one where it is declared"),
];

/// Translates the first known message in cargo's `output` into one line: `src/lib.rs:7: this divides by 0`; empty if
/// there is none.
pub fn in_plain_words(output: &str) -> String {
    let words = output.split("\n\n").find_map(|message| {
        let known =
            TRANSLATIONS.iter().find(|(phrase, _)| message.contains(phrase)).map(|(_, words)| (*words).to_owned());
        let words = known.or_else(|| unknown_name(message))?;
        let place = message.lines().find_map(|line| line.trim_start().strip_prefix("--> "));
        // The column is left out.
        let place = place.and_then(|place| place.rsplit_once(':')).map_or("", |(place, _)| place);
        Some(if place.is_empty() { format!("{words}\n") } else { format!("{place}: {words}\n") })
    });
    words.unwrap_or_default()
}

/// Explains an unknown method, variant or function: with the name that the compiler suggests, else with the most
/// similar methods if the type is one of `robios_api`.
fn unknown_name(message: &str) -> Option<String> {
    let is_head =
        |line: &&str| line.starts_with("error[E0599]: no ") || line.starts_with("error[E0425]: cannot find function ");
    let head = message.lines().find(is_head)?;
    let quoted_text = |index: usize| head.split('`').skip(1).step_by(2).nth(index);
    let (name, owner) = (quoted_text(0)?, quoted_text(1).filter(|_| head.contains(" found for ")));
    let path = owner
        .map(|owner| owner.trim_start_matches('&').trim_start_matches("mut ").split('<').next().unwrap_or_default());
    let kind = path.and_then(|path| path.rsplit("::").next());
    let subject = match kind.filter(|kind| kind.chars().all(char::is_alphanumeric) && !kind.is_empty()) {
        Some(kind) => format!("`{kind}` has no `{name}`"),
        None => format!("`{name}` is not defined"),
    };
    if let Some(suggestion) = suggested(message, name) {
        return Some(format!("{subject}; did you mean `{suggestion}`?"));
    }
    let path = path.filter(|_| head.contains("no method"))?.strip_prefix("robios_api::")?;
    let mut methods = methods_of(path);
    methods.sort_by_key(|method| strsim::osa_distance(method, name));
    methods.truncate(MAX_NAMES);
    (!methods.is_empty()).then(|| format!("{subject}; among its methods are {}", quoted(&methods)))
}

/// The name that the compiler suggests for `name`, if it is similar: the quoted name, else the name in the changed
/// line.
fn suggested<'m>(message: &'m str, name: &str) -> Option<&'m str> {
    let help = message.lines().find(|line| line.starts_with("help: ") && line.contains(" similar name"))?;
    let suggestion = help.split('`').nth(1).or_else(|| replacement(message, name))?;
    (strsim::osa_distance(&suggestion.to_lowercase(), &name.to_lowercase()) <= name.len().max(3) / 3)
        .then_some(suggestion)
}

/// The word that replaces `name` in the changed line that the message shows.
fn replacement<'m>(message: &'m str, name: &str) -> Option<&'m str> {
    let place = message.lines().find_map(|line| line.trim_start().strip_prefix("--> "))?;
    let number = place.rsplit(':').nth(1)?;
    // The number may be padded; the old line has `|` or `-`, the new one `|` or `+`.
    let code = |line: &'m str| line.trim_start().strip_prefix(number)?.trim_start().strip_prefix(['|', '-', '+']);
    let shown: Vec<&str> = message.lines().filter_map(code).collect();
    let words = |code: &'m str| code.split(|c: char| !c.is_alphanumeric() && c != '_');
    let mut changes =
        shown.windows(2).filter_map(|pair| words(pair[0]).zip(words(pair[1])).find(|(old, new)| old != new));
    changes.find(|(old, _)| *old == name).map(|(_, new)| new)
}

/// The public methods of a type of the crate `robios-api`, from its source; empty if the source is not available.
fn methods_of(path: &str) -> Vec<String> {
    let (folder, kind) = path.rsplit_once("::").unwrap_or(("", path));
    let Some(root) = Path::new(env!("CARGO_MANIFEST_DIR")).parent() else { return Vec::new() };
    let files = fs::read_dir(root.join("robios-api/src").join(folder)).into_iter().flatten().flatten();
    let begins = |line: &&str| {
        let type_name = line.strip_prefix("impl").and_then(|head| head.split(' ').nth(1));
        !line.contains(" for ") && type_name.is_some_and(|type_name| type_name.split('<').next() == Some(kind))
    };
    let mut methods: Vec<String> = Vec::new();
    for text in files.filter_map(|file| fs::read_to_string(file.path()).ok()) {
        let mut lines = text.lines();
        while lines.by_ref().any(|line| begins(&line)) {
            let impl_lines = lines.by_ref().take_while(|line| *line != "}");
            let names = impl_lines.filter_map(|line| line.strip_prefix("    pub fn ")?.split(['(', '<']).next());
            methods.extend(names.map(str::to_owned));
        }
    }
    methods
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_names_are_reported_with_similar_ones() {
        let added = "error[E0599]: no method named `straigt` found for struct `robios_api::Drive` in the current scope\n --> src/lib.rs:7:11\n  \
                     |\n7 |     drive.straigt(1)?;\n  |           ^^^^^^^\n  |\nhelp: there is a method `straight` with a similar name\n  \
                     |\n7 |     drive.straight(1)?;\n  |                 +\n";
        assert_eq!(in_plain_words(added), "src/lib.rs:7: `Drive` has no `straigt`; did you mean `straight`?\n");
        let replaced = "error[E0599]: no variant or associated item named `Frontleft` found for enum `robios_api::PsdAt` in the current scope\n \
                        --> src/lib.rs:7:22\n  |\n7 |     robot.psd(PsdAt::Frontleft)?;\n  |\nhelp: there is a variant with a similar \
                        name\n  |\n7 -     robot.psd(PsdAt::Frontleft)?;\n7 +     robot.psd(PsdAt::FrontLeft)?;\n  |\n";
        assert_eq!(in_plain_words(replaced), "src/lib.rs:7: `PsdAt` has no `Frontleft`; did you mean `FrontLeft`?\n");
        let unknown = "error[E0599]: no method named `turn_left` found for struct `robios_api::Drive` in the current scope\n --> src/lib.rs:7:20\n";
        let words = in_plain_words(unknown);
        assert!(
            words.starts_with("src/lib.rs:7: `Drive` has no `turn_left`; among its methods are `turn`, "),
            "{words}"
        );
        assert_eq!(
            in_plain_words("error[E0425]: cannot find function `strait` in this scope\n --> src/lib.rs:7:5\n"),
            ""
        );
    }

    #[test]
    fn suggestions_are_whole_names() {
        // rustc 1.95; it prints a tab as four blanks and counts it as one column.
        let tab = r"error[E0599]: no method named `straigt` found for mutable reference `&mut robios_api::Drive` in the current scope
 --> src/lib.rs:3:8
  |
3 |     drive.straigt(1);
  |           ^^^^^^^
  |
help: there is a method `straight` with a similar name
  |
3 |     drive.straight(1);
  |                 +
";
        assert_eq!(in_plain_words(tab), "src/lib.rs:3: `Drive` has no `straigt`; did you mean `straight`?\n");
        let arguments = r"error[E0599]: no method named `turnby` found for struct `Drive` in the current scope
 --> src/lib.rs:4:11
  |
4 |     drive.turnby(1);
  |           ^^^^^^
  |
help: there is a method `turn_by` with a similar name, but with different arguments
 --> x/src/lib.rs:4:48
  |
4 | impl Drive { pub fn straight(&self, _: i32) {} pub fn turn_by(&self, _: i32, _: i32) {} pub fn new() -> Self { Drive } }
  |                                                ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
";
        assert_eq!(in_plain_words(arguments), "src/lib.rs:4: `Drive` has no `turnby`; did you mean `turn_by`?\n");
        let padded = r"error[E0599]: no variant or associated item named `Frontleft` found for enum `At` in the current scope
  --> src/lib.rs:2:36
   |
 2 |     let größe = 3 - 1; let _ = At::Frontleft;
   |                                    ^^^^^^^^^ variant or associated item not found in `At`
...
11 | pub enum At { FrontLeft }
   | ----------- variant or associated item `Frontleft` not found for this enum
   |
help: there is a variant with a similar name
   |
 2 -     let größe = 3 - 1; let _ = At::Frontleft;
 2 +     let größe = 3 - 1; let _ = At::FrontLeft;
   |
";
        assert_eq!(in_plain_words(padded), "src/lib.rs:2: `At` has no `Frontleft`; did you mean `FrontLeft`?\n");
        let function = r"error[E0425]: cannot find function `hose` in this scope
  --> src/lib.rs:2:29
   |
 2 |     let größe = 3 - 1; let _ = hose(größe);
   |                                ^^^^
...
11 | pub fn hase(i: i32) {}
   | ------------------- similarly named function `hase` defined here
   |
help: a function with a similar name exists
   |
 2 -     let größe = 3 - 1; let _ = hose(größe);
 2 +     let größe = 3 - 1; let _ = hase(größe);
   |
";
        assert_eq!(in_plain_words(function), "src/lib.rs:2: `hose` is not defined; did you mean `hase`?\n");
        let far = r"error[E0599]: no method named `straight_ahead` found for mutable reference `&mut robios_api::Drive` in the current scope
 --> src/lib.rs:6:11
  |
6 |     drive.straight_ahead(1);
  |           ^^^^^^^^^^^^^^
  |
help: there is a method `straight` with a similar name
  |
6 -     drive.straight_ahead(1);
6 +     drive.straight(1);
  |
";
        let words = in_plain_words(far);
        assert!(
            words.starts_with("src/lib.rs:6: `Drive` has no `straight_ahead`; among its methods are `straight`, "),
            "{words}"
        );
    }

    #[test]
    fn known_messages_are_translated_with_their_line() {
        let output = "error: this operation will panic at runtime\n --> src/lib.rs:7:20\n  |\n7 |     100 / 0\n  |     ^^^ attempt to divide \
                      `100_i32` by zero\n\nerror: could not compile `mine` (lib) due to 1 previous error\n";
        assert_eq!(in_plain_words(output), "src/lib.rs:7: this divides by 0\n");
        let recursion = "warning: unused\n --> src/lib.rs:2:5\n\nwarning: function cannot return without recursing\n --> src/lib.rs:7:5\n";
        assert_eq!(in_plain_words(recursion), format!("src/lib.rs:7: {RECURSION}\n"));
        assert_eq!(in_plain_words("error[E0425]: cannot find value `x`\n --> src/lib.rs:3:1\n"), "");
    }
}
