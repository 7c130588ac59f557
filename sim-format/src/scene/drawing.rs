//! Reading of a maze that is drawn as a string in a scene.

use toml::Spanned;
use toml::de::DeValue;

use crate::diagnostic::Diagnostic;
use crate::spec::{Dialect, WorldSpec};
use crate::table::{Reader, Section};
use crate::{CellRules, Span, read_maze_with};

impl Reader {
    /// Reads a world drawn as the text of a `.maz`.
    pub(crate) fn maze(&mut self, section: &mut Section<'_, '_>, key: &'static str) -> WorldSpec {
        let value = section.get(key);
        let drawing = self.text(section, key).unwrap_or_default();
        let Some(value) = value.filter(|_| !drawing.is_empty()) else { return WorldSpec::default() };
        // No version of EyeSim reads inline drawings, so none determines how they are read.
        let rules = CellRules { dialect: Some(Dialect::default()), cell: None };
        let (mut world, diagnostics) = read_maze_with(self.sink.file(), &drawing, rules);
        let place = self.text_place(value, &drawing);
        for diagnostic in diagnostics {
            let Diagnostic { severity, code, span, message, expected, suggestion, .. } = diagnostic;
            self.sink.report(severity, code, place.span_in_file(span), message, expected).suggestion = suggestion;
        }
        for span in world.walls.iter_mut().map(|wall| &mut wall.span) {
            *span = place.span_in_file(*span);
        }
        world.starts.iter_mut().for_each(|start| start.span = place.span_in_file(start.span));
        world.objects.iter_mut().for_each(|object| object.span = place.span_in_file(object.span));
        world
    }

    /// Locations in the file of the characters of a string.
    fn text_place(&self, value: &Spanned<DeValue<'_>>, text: &str) -> TextPlace {
        let value_span = self.span(value.span());
        let source = self.text.get(value.span()).unwrap_or_default();
        // The file contains the value literally only if the string has no escapes.
        let offset = source.find(text).filter(|_| !text.is_empty());
        let line_offset = offset.map(|offset| source[..offset].matches('\n').count() as u32);
        match (offset, line_offset) {
            (Some(offset), Some(lines)) if lines > 0 => TextPlace::Written {
                start: value_span.start + offset,
                end: value_span.start + offset + text.len(),
                line: value_span.line + lines,
                mark: u32::from(text.starts_with('\u{feff}')),
            },
            _ => TextPlace::Whole(value_span),
        }
    }
}

/// Mapping of positions in a string value to positions in the file.
enum TextPlace {
    /// The string starts at the beginning of a line of the file and contains no escapes. `mark` is the number of byte
    /// order marks at its start, 0 or 1: readers of a file do not count them as characters, but here they are.
    Written { start: usize, end: usize, line: u32, mark: u32 },
    /// Any other notation: only the whole value has a span.
    Whole(Span),
}

impl TextPlace {
    /// Converts a span in the string to a span in the file.
    fn span_in_file(&self, span: Span) -> Span {
        match *self {
            TextPlace::Written { start, end, line, mark } if span.line > 0 => Span {
                start: (start + span.start).min(end),
                end: (start + span.end).min(end),
                line: line + span.line - 1,
                column: span.column + if span.line == 1 { mark } else { 0 },
            },
            TextPlace::Written { start, end, line, .. } => Span { start, end, line, column: 1 },
            TextPlace::Whole(whole) => whole,
        }
    }
}
