//! Explains the last messages of programs that end by an error of the C++ or Rust library.

use std::path::PathBuf;

use crate::program::image::SourceLine;
use crate::robios::storage::missing_file;

/// Explains `reason`, followed by the library's message in brackets:
/// `src/lib.rs:8: this divides by 0 (panicked: attempt to divide by zero)`. `None` for an unknown message. `text_of`
/// returns the text of a line of the program.
pub fn explain(reason: &str, text_of: impl Fn(&SourceLine) -> Option<String>) -> Option<String> {
    let (message, line) = if let Some((task, panic)) = reason.split_once("panicked: ") {
        let mut parts = panic.splitn(4, ':');
        let (file, line) = (parts.next()?, parts.next()?);
        (format!("{task}panicked: {}", parts.nth(1)?.trim_start()), Some((file, line)))
    } else {
        let location = reason
            .rsplit_once(" at ")
            .and_then(|(message, location)| Some((message.to_owned(), location.split_once(':')?)));
        location.map_or_else(|| (reason.to_owned(), None), |(message, location)| (message, Some(location)))
    };
    let source_line = || Some(SourceLine { file: PathBuf::from(line?.0), line: line?.1.parse().ok()?, function: None });
    let explanation = explanation(&message, &|| text_of(&source_line()?))?;
    let location = line.map_or_else(String::new, |(file, line)| format!("{file}:{line}: "));
    Some(format!("{location}{explanation} ({message})"))
}

/// The line of the program at the end of `reason`: ` at a.cpp:6`.
pub fn source_line(reason: &str) -> Option<SourceLine> {
    let (file, line) = reason.rsplit_once(" at ")?.1.split_once(':')?;
    Some(SourceLine { file: PathBuf::from(file), line: line.parse().ok()?, function: None })
}

/// Explanation of `message`; `text` returns the line of the program that caused it.
fn explanation(message: &str, text: &dyn Fn() -> Option<String>) -> Option<String> {
    let fixed = [
        ("panicked: ", "attempt to divide by zero", "this divides by 0"),
        ("panicked: ", "with a divisor of zero", "this divides by 0"),
        (
            "panicked: ",
            "`Option::unwrap()` on a `None` value",
            "`unwrap` finds no value: `if let Some(value) = ...` looks for one",
        ),
        ("`std::out_of_range`: map::at", "", "the map has no such key"),
        (
            "assertion of the C++ library failed",
            "__n < ",
            "an index is outside of its array: the first one is 0, the last one is one less than the size",
        ),
        ("assertion of the C++ library failed", "!this->empty()", "there is no element: the container is empty"),
    ];
    if let Some((.., explanation)) =
        fixed.iter().find(|(first, second, _)| message.contains(first) && message.contains(second))
    {
        return Some((*explanation).to_owned());
    }
    let number_parsers = ["stoi", "stol", "stoll", "stoul", "stoull", "stof", "stod", "stold"];
    if message
        .split_once("`std::invalid_argument`: ")
        .is_some_and(|(_, function)| number_parsers.contains(&function.trim()))
    {
        return Some("the text does not begin with a number".to_owned());
    }
    let is_panic = message.contains("panicked: ");
    if is_panic && message.contains("kind: NotFound") {
        return Some(missing_file(text().as_deref().and_then(opened_file)));
    }
    if is_panic && message.contains("index out of bounds: ") {
        return Some(index_error("array", number_after(message, "index is ")?, number_after(message, "len is ")?));
    }
    let (_, checked) = message.split_once("`std::out_of_range`: ")?;
    let kind = match checked.split_once("::")?.0 {
        "basic_string" => "string",
        kind => kind,
    };
    let (_, rest) = checked.split_once("(which is ")?;
    Some(index_error(&format!("`{kind}`"), number_after(checked, "(which is ")?, number_after(rest, "(which is ")?))
}

fn number_after(text: &str, words: &str) -> Option<u64> {
    let (_, rest) = text.split_once(words)?;
    rest.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
}

/// Explanation of an index that is out of range for a `kind` with `len` elements.
fn index_error(kind: &str, index: u64, len: u64) -> String {
    let indices = match len.checked_sub(1) {
        None => "which is empty".to_owned(),
        Some(last) => format!("which has {len} elements with the indices 0 to {last}"),
    };
    // An index below 0 has become a very large unsigned number.
    format!("the index {} is outside of the {kind}, {indices}", index.cast_signed())
}

/// The name of the file that a line of Rust opens.
fn opened_file(line: &str) -> Option<&str> {
    let calls = ["open(\"", "read_to_string(\"", "read(\""];
    calls.iter().find_map(|call| line.split_once(call)?.1.split('"').next())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(reason: &str, expected: &str) {
        let line = |line: &SourceLine| {
            assert_eq!(line.to_string(), "src/lib.rs:7");
            Some("let map = format!(\"{}\", read_to_string(\"/none/map.txt\").unwrap());".to_owned())
        };
        let explanation = explain(reason, line).unwrap_or_default();
        assert_eq!(explanation, expected, "{reason}");
    }

    #[test]
    fn panics_are_explained() {
        check(
            "panicked: src/lib.rs:7:20: attempt to divide by zero",
            "src/lib.rs:7: this divides by 0 (panicked: attempt to divide by zero)",
        );
        check(
            "task `a`: panicked: src/lib.rs:7:5: index out of bounds: the len is 4 but the index is 4",
            "src/lib.rs:7: the index 4 is outside of the array, which has 4 elements with the indices 0 to 3 (task `a`: panicked: index \
             out of bounds: the len is 4 but the index is 4)",
        );
        check(
            "panicked: src/lib.rs:7:5: called `Result::unwrap()` on an `Err` value: Os { code: 2, kind: NotFound }",
            "src/lib.rs:7: there is no folder `/none` (panicked: called `Result::unwrap()` on an `Err` value: Os { code: 2, kind: NotFound })",
        );
        check("panicked: src/lib.rs:7:20: on purpose", "");
    }

    #[test]
    fn exceptions_are_explained() {
        check(
            "uncaught exception `std::out_of_range`: vector::_M_range_check: __n (which is 18446744073709551615) >= this->size() (which is 0) at a.cpp:6",
            "a.cpp:6: the index -1 is outside of the `vector`, which is empty (uncaught exception `std::out_of_range`: vector::_M_range_check: __n \
             (which is 18446744073709551615) >= this->size() (which is 0))",
        );
        check("uncaught exception `std::runtime_error`: (which is 3) (which is 4)", "");
    }
}
