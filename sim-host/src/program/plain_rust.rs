//! Messages of the Rust compiler in plain words, for the few that need it: most say by themselves what to write.

use super::plain::RECURSION;

/// Parts of messages, each with what it means.
const WORDS: &[(&str, &str)] = &[
    ("cannot return without recursing", RECURSION),
    ("did not contain valid UTF-8", "the file is not saved as UTF-8: save it as UTF-8 in the editor"),
    ("attempt to divide `", "this divides by 0"),
    (
        "this operation will panic at runtime",
        "this cannot work: an index is outside of its array, or a number does not fit",
    ),
    ("isn't initialized", "the variable has no value yet: give it one where it is declared"),
];

/// The first known message among cargo's `output`, in one line: `src/lib.rs:7: this divides by 0`; empty if there is none.
pub fn in_plain_words(output: &str) -> String {
    let words = output.split("\n\n").find_map(|message| {
        let words = WORDS.iter().find(|(phrase, _)| message.contains(phrase))?.1;
        let place = message.lines().find_map(|line| line.trim_start().strip_prefix("--> "));
        // The column is left out.
        let place = place.and_then(|place| place.rsplit_once(':')).map_or("", |(place, _)| place);
        Some(if place.is_empty() { format!("{words}\n") } else { format!("{place}: {words}\n") })
    });
    words.unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_messages_are_told_with_their_line() {
        let output = "error: this operation will panic at runtime\n --> src/lib.rs:7:20\n  |\n7 |     100 / 0\n  |     ^^^ attempt to divide \
                      `100_i32` by zero\n\nerror: could not compile `mine` (lib) due to 1 previous error\n";
        assert_eq!(in_plain_words(output), "src/lib.rs:7: this divides by 0\n");
        let recursion = "warning: unused\n --> src/lib.rs:2:5\n\nwarning: function cannot return without recursing\n --> src/lib.rs:7:5\n";
        assert_eq!(in_plain_words(recursion), format!("src/lib.rs:7: {RECURSION}\n"));
        assert_eq!(in_plain_words("error[E0425]: cannot find value `x`\n --> src/lib.rs:3:1\n"), "");
    }
}
