//! Excerpt of a file around a mistake, cut to the width of a terminal and without control characters.

use std::collections::VecDeque;
use std::ops::Range;

use console::measure_text_width;
use miette::{MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};
use sim_core::spec::Span;
use sim_host::record::log::is_terminal_control;

/// Columns from one tab stop to the next.
const TAB: usize = 4;
/// Marker where text was cut off.
const CUT: char = '…';
/// Minimum number of columns of source, even on a narrower terminal.
const MIN_COLUMNS: usize = 16;
/// Maximum length of the line above the mistake, in bytes; a longer line is not shown, since it would not help.
const MAX_NEIGHBOUR: usize = 1 << 16;

/// Line of a mistake, with its neighbouring lines unless the beginning of the line is cut off.
#[derive(Debug)]
pub struct Excerpt {
    file: String,
    /// Shown text: no tabs, no control characters, lines ended by `\n`.
    text: String,
    /// Number of the first shown line, from 0.
    first_line: usize,
    lines: usize,
    /// Line and column of the mistake in the file, from 0.
    location: (usize, usize),
    /// Byte range of the mistake in `text`.
    label: Range<usize>,
}

impl Excerpt {
    /// The lines around `span` in `text`, for a terminal of `width` columns.
    pub fn new(file: &str, text: &str, span: Span, width: usize) -> Self {
        let last_number = span.line as usize + 1;
        // Leaves room for ` 12 │ ` before the line, and for a marker after its end.
        let columns = width.saturating_sub(last_number.to_string().len() + 5).max(MIN_COLUMNS);
        let start = text.floor_char_boundary(span.start);
        let end = text.floor_char_boundary(span.end).max(start);
        let window = LineWindow::around(text, start..end, columns);
        let mut shown_text = String::new();
        let mut lines = 1;
        let mut first_line = (span.line as usize).saturating_sub(1);
        let above = if window.is_shifted { None } else { line_above(text, start) };
        if let Some(line) = above {
            shown_text.push_str(&head(line, columns));
            shown_text.push('\n');
            (lines, first_line) = (lines + 1, first_line.saturating_sub(1));
        }
        let label = shown_text.len() + window.label.start..shown_text.len() + window.label.end;
        shown_text.push_str(&window.text);
        let below = if window.is_shifted { None } else { line_below(text, start) };
        if let Some(line) = below {
            shown_text.push('\n');
            shown_text.push_str(&head(line, columns));
            lines += 1;
        }
        let location = ((span.line as usize).saturating_sub(1), (span.column as usize).saturating_sub(1));
        Self { file: printable(file), text: shown_text, first_line, lines, location, label }
    }

    /// Span of the mistake in the shown text.
    pub fn label(&self) -> SourceSpan {
        SourceSpan::from(self.label.clone())
    }
}

impl SourceCode for Excerpt {
    /// Returns the whole text for any span. A call without context lines is for the position that `miette` prints above
    /// the text: it returns the position of the mistake. Any other call returns the position of the first line.
    fn read_span<'a>(
        &'a self,
        _: &SourceSpan,
        lines_before: usize,
        lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let (line, column) = if lines_before + lines_after == 0 { self.location } else { (self.first_line, 0) };
        let whole_text = SourceSpan::from(0..self.text.len());
        let (file, text) = (self.file.clone(), self.text.as_bytes());
        Ok(Box::new(MietteSpanContents::new_named(file, text, whole_text, line, column, self.lines)))
    }
}

/// The part of a line around a mistake that fits into a number of columns.
struct LineWindow {
    text: String,
    label: Range<usize>,
    /// True if the beginning of the line is cut off.
    is_shifted: bool,
}

impl LineWindow {
    /// Reads only as much of the line as can be shown, since lines may be of any length.
    fn around(text: &str, span: Range<usize>, columns: usize) -> Self {
        let before_span = text[..span.start].char_indices().rev();
        let mut shown_start = span.start;
        let mut is_shifted = false;
        for (count, (index, c)) in before_span.enumerate() {
            if is_break(c) {
                break;
            }
            if count == columns {
                is_shifted = true;
                break;
            }
            shown_start = index;
        }
        let mut left = Cells::of(&text[shown_start..span.start], 0);
        if is_shifted || left.width > columns / 2 {
            let kept_width = columns / 3;
            while left.width > kept_width {
                left.pop_front();
                is_shifted = true;
            }
            if is_shifted {
                left.push_front(CUT);
            }
        }
        let rest = text[span.start..].split(is_break).next().unwrap_or_default();
        let mut line = left.text();
        let label_start = line.len();
        let mut label_end = label_start;
        let mut column = left.width;
        let mut characters = rest.char_indices().peekable();
        while let Some((index, c)) = characters.next() {
            let cell = cell(c, column);
            let width = measure_text_width(&cell);
            let available = columns.saturating_sub(column + usize::from(characters.peek().is_some()));
            if width > available {
                line.push(CUT);
                label_end = if span.start + index < span.end { line.len() } else { label_end };
                break;
            }
            line.push_str(&cell);
            column += width;
            if span.start + index < span.end {
                label_end = line.len();
            }
        }
        Self { text: line, label: label_start..label_end, is_shifted }
    }
}

/// Printable characters with their widths in columns.
struct Cells {
    cells: VecDeque<(String, usize)>,
    width: usize,
}

impl Cells {
    fn of(text: &str, column: usize) -> Self {
        let mut cells = Self { cells: VecDeque::new(), width: 0 };
        for c in text.chars() {
            let cell = cell(c, column + cells.width);
            let width = measure_text_width(&cell);
            cells.width += width;
            cells.cells.push_back((cell, width));
        }
        cells
    }

    fn pop_front(&mut self) {
        if let Some((_, width)) = self.cells.pop_front() {
            self.width -= width;
        }
    }

    fn push_front(&mut self, c: char) {
        self.cells.push_front((c.to_string(), 1));
        self.width += 1;
    }

    fn text(&self) -> String {
        self.cells.iter().map(|(cell, _)| cell.as_str()).collect()
    }
}

/// The first `columns` of a line.
fn head(line: &str, columns: usize) -> String {
    LineWindow::around(line, 0..0, columns).text
}

/// The line above the line of byte `offset`; none if it is too long to help.
fn line_above(text: &str, offset: usize) -> Option<&str> {
    let start = text[..offset].rfind(is_break)?;
    // CR LF is one break.
    let end = if text[..=start].ends_with("\r\n") { start - 1 } else { start };
    let search_start = text.floor_char_boundary(end.saturating_sub(MAX_NEIGHBOUR));
    match text[search_start..end].rfind(is_break) {
        Some(previous) => Some(&text[search_start + previous + 1..end]),
        None if search_start == 0 => Some(&text[..end]),
        None => None,
    }
}

/// The line below the line of byte `offset`.
fn line_below(text: &str, offset: usize) -> Option<&str> {
    let end = offset + text[offset..].find(is_break)?;
    let next = end + if text[end..].starts_with("\r\n") { 2 } else { 1 };
    let rest = &text[next..];
    // No line follows the last one.
    (!rest.is_empty()).then(|| rest.split(is_break).next().unwrap_or_default())
}

fn is_break(c: char) -> bool {
    matches!(c, '\n' | '\r')
}

/// Printable form of a character in `column`.
fn cell(c: char, column: usize) -> String {
    match c {
        '\t' => " ".repeat(TAB - column % TAB),
        '\u{feff}' => String::new(),
        c => safe(c).to_string(),
    }
}

/// Replaces characters that could control the terminal or reorder a line.
fn safe(c: char) -> char {
    if is_terminal_control(c) { char::REPLACEMENT_CHARACTER } else { c }
}

/// Printable form of a message, with its line breaks.
pub fn printable(text: &str) -> String {
    text.chars().map(|c| if c == '\n' { c } else { safe(c) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn excerpt(text: &str, start: usize, end: usize, line: u32, column: u32, width: usize) -> Excerpt {
        Excerpt::new("a.wld", text, Span { start, end, line, column }, width)
    }

    fn label(excerpt: &Excerpt) -> &str {
        &excerpt.text[excerpt.label.clone()]
    }

    #[test]
    fn neighbouring_lines_are_shown() {
        for eol in ["\n", "\r\n", "\r"] {
            let text = ["a", "b", "c d", "e", "f"].join(eol);
            let start = text.find('d').expect("the text contains d");
            let excerpt = excerpt(&text, start, start + 1, 3, 3, 80);
            assert_eq!((excerpt.text.as_str(), label(&excerpt)), ("b\nc d\ne", "d"), "{eol:?}");
            assert_eq!((excerpt.first_line, excerpt.lines, excerpt.location), (1, 3, (2, 2)));
        }
    }

    #[test]
    fn first_and_last_line_have_one_neighbour() {
        let first = excerpt("ab\ncd\n", 0, 2, 1, 1, 80);
        assert_eq!((first.text.as_str(), label(&first), first.first_line), ("ab\ncd", "ab", 0));
        let last = excerpt("ab\ncd\n", 3, 5, 2, 1, 80);
        assert_eq!((last.text.as_str(), label(&last), last.first_line), ("ab\ncd", "cd", 0));
    }

    #[test]
    fn mistake_may_be_at_the_end_of_the_file() {
        for text in ["", "ab", "ab\n", "é"] {
            let excerpt = excerpt(text, text.len(), text.len(), 1 + u32::from(text.ends_with('\n')), 1, 80);
            assert_eq!(label(&excerpt), "", "{text:?}");
        }
        // A span beyond the end, as in a file that has changed meanwhile.
        assert_eq!(label(&excerpt("ab", 70, 90, 9, 1, 80)), "");
    }

    #[test]
    fn long_lines_are_cut_around_the_mistake() {
        let text = format!("{}X{}\nnext", "a".repeat(100_000), "b".repeat(100_000));
        let excerpt = excerpt(&text, 100_000, 100_001, 1, 100_001, 40);
        assert_eq!(label(&excerpt), "X");
        assert_eq!(excerpt.text, "…aaaaaaaaaaaXbbbbbbbbbbbbbbbbbbbb…");
        assert_eq!(excerpt.location, (0, 100_000));
    }

    #[test]
    fn long_mistakes_are_truncated() {
        let excerpt = excerpt(&"word ".repeat(40), 0, 200, 1, 1, 40);
        assert_eq!(excerpt.text, "word word word word word word wor…");
        assert_eq!(label(&excerpt), excerpt.text);
    }

    #[test]
    fn tabs_and_wide_characters_keep_their_columns() {
        let tabs = excerpt("a\t\tb", 3, 4, 1, 4, 80);
        assert_eq!((tabs.text.as_str(), label(&tabs)), ("a       b", "b"));
        let wide = excerpt(&"世界".repeat(100), 300, 303, 1, 101, 40);
        assert!(measure_text_width(&wide.text) <= 35, "{wide:?}");
        assert_eq!(label(&wide), "世");
    }

    #[test]
    fn control_characters_are_replaced() {
        let text = "\u{feff}a\x1b[2J\0\u{202e}b";
        let excerpt = excerpt(text, 3, text.len(), 1, 1, 80);
        assert_eq!(excerpt.text, "a\u{fffd}[2J\u{fffd}\u{fffd}b");
        assert_eq!(printable("a\n\x1bb\u{200b}"), "a\n\u{fffd}b\u{fffd}");
    }
}
