//! Invariants of the diagnostics of any text.

use sim_core::spec::Span;
use sim_format::{Code, Diagnostic};

/// Maximum number of diagnostics per file: 1000, and one with the count of the remaining ones.
const MAX_KEPT: usize = 1001;

/// Panics unless the `diagnostics` of `text` are valid: each has a message, a span within the text and the right line
/// and column; they are sorted, and their number does not exceed the maximum.
pub fn check(text: &str, diagnostics: &[Diagnostic]) {
    assert!(diagnostics.len() <= MAX_KEPT, "{} diagnostics", diagnostics.len());
    let lines = Lines::new(text);
    for diagnostic in diagnostics {
        words(diagnostic);
        lines.check(diagnostic.span, diagnostic);
    }
    let sorted = diagnostics.iter().take_while(|diagnostic| diagnostic.code != Code::FileMore);
    assert!(sorted.is_sorted_by_key(|diagnostic| diagnostic.span), "not in the order of the text: {diagnostics:#?}");
}

/// Panics unless a diagnostic states the mistake and the expected input in one line each.
pub fn words(diagnostic: &Diagnostic) {
    let Diagnostic { code, message, expected, suggestion, .. } = diagnostic;
    for words in [message, expected].into_iter().chain(suggestion) {
        assert!(!words.trim().is_empty() && !words.contains(char::is_control), "{diagnostic:?}");
    }
    assert!(diagnostic.to_string().contains(&code.to_string()));
}

/// The lines of a text, ended by LF, CR LF or CR.
pub struct Lines<'t> {
    text: &'t str,
    /// Byte offset of each line's start.
    starts: Vec<usize>,
}

impl<'t> Lines<'t> {
    /// The lines of `text`.
    pub fn new(text: &'t str) -> Self {
        let bytes = text.as_bytes();
        let mut starts = vec![0];
        for (index, byte) in bytes.iter().enumerate() {
            let is_end = match byte {
                b'\n' => true,
                b'\r' => bytes.get(index + 1) != Some(&b'\n'),
                _ => false,
            };
            if is_end {
                starts.push(index + 1);
            }
        }
        Self { text, starts }
    }

    /// Panics unless `span` lies in the text and has the right line and column.
    pub fn check(&self, span: Span, what: &impl std::fmt::Debug) {
        let Span { start, end, line, column } = span;
        if line == 0 {
            assert_eq!((start, end, column), (0, 0, 0), "a whole file has no place: {what:?}");
            return;
        }
        assert!(self.text.get(start..end).is_some(), "not a piece of the text: {what:?}");
        let expected = self.starts.partition_point(|begin| *begin <= start);
        let before = &self.text[self.starts[expected - 1]..start];
        let is_first = expected == 1;
        let before = if is_first { before.strip_prefix('\u{feff}').unwrap_or(before) } else { before };
        let location = (expected, before.chars().count() + 1);
        assert_eq!((line as usize, column as usize), location, "line and column of {what:?}");
    }
}
