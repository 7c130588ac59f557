//! Source locations in texts.

use serde::Serialize;

/// A location in a text: bytes `start..end`, and line and column of its first character.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Span {
    /// First byte, counted in the decoded text (the file's own bytes unless it is not UTF-8).
    pub start: usize,
    /// Index of the first byte after the span.
    pub end: usize,
    /// Line, from 1; 0 if the span denotes the whole file.
    pub line: u32,
    /// Column in characters, from 1, without a byte order mark.
    pub column: u32,
}

impl Span {
    /// The span from the start of `self` to the end of `last`, which begins on the same line or later.
    pub fn to(self, last: Span) -> Span {
        Span { end: last.end.max(self.end), ..self }
    }
}
