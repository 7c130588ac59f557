//! Diagnostics of the readers: position, severity, message and expected input.

use std::borrow::Cow;

use serde::Serialize;

use super::{Code, Span};

/// Severity of a mistake.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// The line is skipped or read in part; EyeSim does the same without a message.
    Warning,
    /// The file or a robot is unusable, so the scene is not run.
    Error,
}

impl std::fmt::Display for Severity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Severity::Warning => "warning",
            Severity::Error => "error",
        })
    }
}

/// One mistake in one file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Diagnostic {
    /// Severity: an error makes the file or a robot unusable.
    pub severity: Severity,
    /// Kind of the mistake.
    pub code: Code,
    /// Name of the file as passed to the reader.
    pub file: String,
    /// Position in the file.
    #[serde(flatten)]
    pub span: Span,
    /// Description of the mistake, with the user's own words in backquotes; unprintable characters appear as `\u{1b}`.
    pub message: String,
    /// Expected input.
    pub expected: String,
    /// Suggested correction, if one can be guessed.
    pub suggestion: Option<String>,
}

impl std::fmt::Display for Diagnostic {
    /// Formats one line: `file:line:column: severity[code]: message`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.file)?;
        if self.span.line > 0 {
            write!(f, ":{}:{}", self.span.line, self.span.column)?;
        }
        write!(f, ": {}[{}]: {}", self.severity, self.code, self.message)
    }
}

/// Returns true if at least one of the `diagnostics` is an error.
pub fn has_errors(diagnostics: &[Diagnostic]) -> bool {
    diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
}

/// Maximum number of diagnostics kept per file; further ones are only counted.
const MAX_KEPT: usize = 1000;

/// Collects the diagnostics of one file.
#[derive(Debug)]
pub(super) struct Sink {
    file: String,
    diagnostics: Vec<Diagnostic>,
    omitted: usize,
    /// The last omitted diagnostic, with the worst severity of all omitted ones.
    last_omitted: Option<Diagnostic>,
}

impl Sink {
    pub(super) fn new(file: &str) -> Self {
        Self { file: file.to_owned(), diagnostics: Vec::new(), omitted: 0, last_omitted: None }
    }

    /// Name of the file that is being read.
    pub(super) fn file(&self) -> &str {
        &self.file
    }

    /// Returns true if there are no diagnostics so far.
    pub(super) fn is_empty(&self) -> bool {
        self.diagnostics.is_empty()
    }

    /// Adds a diagnostic and returns it, so that the caller can add a suggestion.
    pub(super) fn report(
        &mut self,
        severity: Severity,
        code: Code,
        span: Span,
        message: impl Into<String>,
        expected: impl Into<String>,
    ) -> &mut Diagnostic {
        let diagnostic = Diagnostic {
            severity,
            code,
            file: self.file.clone(),
            span,
            message: message.into(),
            expected: expected.into(),
            suggestion: None,
        };
        let index = self.diagnostics.len();
        if index < MAX_KEPT {
            self.diagnostics.push(diagnostic);
            return &mut self.diagnostics[index];
        }
        self.omitted += 1;
        let worst = self.last_omitted.take().map_or(severity, |last| last.severity.max(severity));
        self.last_omitted.insert(Diagnostic { severity: worst, ..diagnostic })
    }

    pub(super) fn warn(
        &mut self,
        code: Code,
        span: Span,
        message: impl Into<String>,
        expected: impl Into<String>,
    ) -> &mut Diagnostic {
        self.report(Severity::Warning, code, span, message, expected)
    }

    pub(super) fn error(
        &mut self,
        code: Code,
        span: Span,
        message: impl Into<String>,
        expected: impl Into<String>,
    ) -> &mut Diagnostic {
        self.report(Severity::Error, code, span, message, expected)
    }

    /// All diagnostics in the order of the text, and at the end the number of omitted ones. Long quotations are
    /// shortened, and unprintable characters are escaped.
    pub(super) fn finish(mut self) -> Vec<Diagnostic> {
        self.diagnostics.sort_by_key(|diagnostic| diagnostic.span);
        self.diagnostics.extend(self.last_omitted.map(|last| Diagnostic {
            code: Code::FileMore,
            message: format!("{} more mistakes in this file are left out", self.omitted),
            expected: "a file of this kind".to_owned(),
            suggestion: None,
            ..last
        }));
        for Diagnostic { message, expected, suggestion, .. } in &mut self.diagnostics {
            for words in [message, expected].into_iter().chain(suggestion) {
                shorten(words);
                if words.contains(is_unprintable) {
                    *words = words.chars().map(printable).collect();
                }
            }
        }
        self.diagnostics
    }
}

/// Returns true for characters that must not reach a terminal or a line of a log: they move the cursor, end the line or
/// change the writing direction.
fn is_unprintable(character: char) -> bool {
    let changes_direction =
        matches!(character, '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    character.is_control() || changes_direction
}

/// The character, or its escape such as `\u{1b}` if it is unprintable.
fn printable(character: char) -> String {
    if is_unprintable(character) { character.escape_unicode().to_string() } else { character.to_string() }
}

/// Maximum lengths of a quoted word and of a message, in bytes.
const MAX_WORD: usize = 300;
const MAX_MESSAGE: usize = 3000;

/// Cuts the middle out of long words, then out of the whole message, since a file may consist of a single word.
fn shorten(text: &mut String) {
    if text.len() > MAX_WORD {
        *text = text.split_inclusive(' ').map(|word| cut(word, MAX_WORD)).collect();
        *text = cut(text, MAX_MESSAGE).into_owned();
    }
}

/// The first and the last sixth of `max` bytes of `text` if it is longer than `max` bytes, otherwise the whole text.
fn cut(text: &str, max: usize) -> Cow<'_, str> {
    if text.len() <= max {
        return Cow::Borrowed(text);
    }
    let head = text.floor_char_boundary(max / 6);
    let tail = text.ceil_char_boundary(text.len() - max / 6);
    Cow::Owned(format!("{}…{}", &text[..head], &text[tail..]))
}
