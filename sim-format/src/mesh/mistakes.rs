//! Mistakes in a mesh or material file: one diagnostic per kind of mistake, independent of the number of lines.

use crate::diagnostic::{Diagnostic, Sink};
use crate::line::Line;
use crate::{Code, Span};

/// Mistakes in one file. A mesh of a hundred thousand faces repeats its mistake in each; only the first is reported,
/// with the number of further ones.
pub(super) struct Mistakes {
    file: String,
    kinds: Vec<MistakeKind>,
}

struct MistakeKind {
    code: Code,
    span: Span,
    message: String,
    expected: &'static str,
    count: usize,
}

impl Mistakes {
    pub(super) fn new(file: &str) -> Self {
        Self { file: file.to_owned(), kinds: Vec::new() }
    }

    /// Records a line that is skipped or read in part.
    pub(super) fn warn(
        &mut self,
        code: Code,
        line: &Line<'_>,
        expected: &'static str,
        message: impl FnOnce() -> String,
    ) {
        match self.kinds.iter_mut().find(|kind| kind.code == code) {
            Some(kind) => kind.count += 1,
            None => self.kinds.push(MistakeKind { code, span: line.span(), message: message(), expected, count: 1 }),
        }
    }

    pub(super) fn finish(self) -> Vec<Diagnostic> {
        let mut sink = Sink::new(&self.file);
        for kind in self.kinds {
            let suffix = match kind.count - 1 {
                0 => String::new(),
                1 => ", and so is 1 more line".to_owned(),
                more => format!(", and so are {more} more lines"),
            };
            sink.warn(kind.code, kind.span, kind.message + &suffix, kind.expected);
        }
        sink.finish()
    }
}
