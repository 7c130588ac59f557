//! `map.yaml`: the interpretation of an image as an occupancy grid, in the subset of YAML that map servers write.

use std::collections::BTreeMap;

use super::grid::{Cell, Grid};
use super::netpbm::Image;
use crate::code::Code;
use crate::diagnostic::Sink;
use crate::line::{self, Line, Quantity, Word};
use crate::spec::SpannedText;
use crate::{Severity, Span};
use sim_core::pose::Pose;

/// Conversion of pixels to cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    /// A cell is occupied above one threshold, free below the other, otherwise unknown.
    Trinary,
    /// Like `Trinary`, but pixels that are not opaque are unknown.
    Scale,
    /// The grey value is the probability in percent; above 100 the cell is unknown.
    Raw,
}

/// Content of a `map.yaml`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MapSpec {
    pub(crate) image: SpannedText,
    /// Side of the cells in metres.
    pub(crate) resolution: f64,
    pub(crate) origin: Pose,
    pub(crate) is_negated: bool,
    pub(crate) occupied_threshold: f64,
    pub(crate) free_threshold: f64,
    pub(crate) mode: Mode,
}

/// Thresholds of map_saver of ROS 1, for images without a `map.yaml`.
pub(crate) const OCCUPIED_THRESHOLD: f64 = 0.65;
pub(crate) const FREE_THRESHOLD: f64 = 0.196;

/// Keys of a `map.yaml`.
const KEYS: [&str; 7] = ["image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh", "mode"];

const FORM: &str =
    "one of image, resolution, origin, negate, occupied_thresh, free_thresh, mode, a colon, and its value";

/// Reads a `map.yaml`; `None`, with an error, if it has no image, or no valid resolution or thresholds.
pub(crate) fn read_map_yaml(sink: &mut Sink, text: &str) -> Option<MapSpec> {
    let entries = entries(sink, text);
    let mut values = Values { entries, sink };
    let image = values.image();
    let resolution = values.number("resolution", Quantity::number("resolution", 1e-6, 1e6), None);
    let origin = values.origin();
    let is_negated = values.negated();
    let fraction = |name| Quantity::number(name, 0.0, 1.0);
    let occupied_threshold = values.number("occupied_thresh", fraction("occupied_thresh"), Some(OCCUPIED_THRESHOLD));
    let free_threshold = values.number("free_thresh", fraction("free_thresh"), Some(FREE_THRESHOLD));
    let mode = values.mode();
    if let (Some(occupied), Some(free)) = (occupied_threshold, free_threshold)
        && free > occupied
    {
        let message = format!("free_thresh {free} is above occupied_thresh {occupied}");
        values.report(Severity::Warning, "free_thresh", message, "a free_thresh below occupied_thresh");
    }
    Some(MapSpec {
        image: image?,
        resolution: resolution?,
        origin,
        is_negated,
        occupied_threshold: occupied_threshold?,
        free_threshold: free_threshold?,
        mode,
    })
}

impl MapSpec {
    /// The interpretation of an image without a `map.yaml`.
    pub(crate) fn of_image(resolution: f64) -> Self {
        Self {
            image: SpannedText { text: String::new(), span: Span::default() },
            resolution,
            origin: Pose::default(),
            is_negated: false,
            occupied_threshold: OCCUPIED_THRESHOLD,
            free_threshold: FREE_THRESHOLD,
            mode: Mode::Trinary,
        }
    }

    /// The grid that `image` shows.
    ///
    /// Source: map_server of ROS, image_loader.cpp.
    pub(crate) fn grid(&self, image: &Image) -> Grid {
        let [columns, rows] = image.size;
        let kind = |index: usize| {
            let (level, white) = (f64::from(image.levels[index]), f64::from(image.white));
            let level = if self.is_negated { white - level } else { level };
            let occupancy = match self.mode {
                Mode::Scale if image.is_transparent.get(index) == Some(&true) => return Cell::Unknown,
                Mode::Trinary | Mode::Scale => (white - level) / white,
                Mode::Raw => {
                    let percent = (level / white * f64::from(image.max_grey)).round();
                    if percent > 100.0 {
                        return Cell::Unknown;
                    }
                    percent / 100.0
                }
            };
            if occupancy > self.occupied_threshold {
                Cell::Occupied
            } else if occupancy < self.free_threshold {
                Cell::Free
            } else {
                Cell::Unknown
            }
        };
        let cells = (0..rows).rev().flat_map(|row| (0..columns).map(move |column| row * columns + column)).map(kind);
        Grid { size: image.size, cell: self.resolution, origin: self.origin, cells: cells.collect() }
    }
}

/// A key with its values: a single value, or the values of a list.
struct KeyValues<'t> {
    key: Word<'t>,
    values: Vec<Word<'t>>,
}

/// The keys of a text with their values; a later key replaces an earlier one of the same name.
fn entries<'t>(sink: &mut Sink, text: &'t str) -> BTreeMap<&'t str, KeyValues<'t>> {
    let mut entries: BTreeMap<&str, KeyValues<'_>> = BTreeMap::new();
    // The key whose values may follow on further lines, and true if they are between brackets.
    let mut open_key: Option<(&str, bool)> = None;
    for line in line::lines(text) {
        let content = without_comment(&line);
        let trimmed = content.trim();
        if trimmed.is_empty() || matches!(trimmed, "---" | "...") || trimmed.starts_with("%YAML") {
            continue;
        }
        let start = content.len() - content.trim_start().len();
        if let Some((key, in_brackets)) = open_key {
            let is_item = trimmed == "-" || trimmed.starts_with("- ") || trimmed.starts_with("-\t");
            if in_brackets || is_item {
                let skip = if in_brackets { start } else { start + 1 };
                let values = scalars(&line, content, skip);
                if in_brackets && content.contains(']') {
                    open_key = None;
                }
                entries.entry(key).and_modify(|entry| entry.values.extend(values));
                continue;
            }
        }
        open_key = None;
        let Some(colon) = find_colon(content) else {
            let word = word_at(&line, content, start, content.trim_end().len());
            let message = format!("`{}` is not a key with a value", word.text);
            sink.warn(Code::MapKey, word.span, message, FORM);
            continue;
        };
        let key = unquoted(word_at(&line, content, start, start + content[start..colon].trim_end().len()));
        let rest = content[colon + 1..].trim();
        let values = scalars(&line, content, colon + 1);
        if rest.is_empty() || rest.starts_with('[') && !rest.contains(']') {
            open_key = Some((key.text, rest.starts_with('[')));
        }
        if !KEYS.contains(&key.text) {
            let message = format!("the key `{}` means nothing in a map", key.text);
            let diagnostic = sink.warn(Code::MapKey, key.span, message, FORM);
            diagnostic.suggestion = line::nearest(key.text, KEYS).map(|known| format!("write `{known}`"));
        } else if entries.contains_key(key.text) {
            let message = format!("a second `{}`; it replaces the first", key.text);
            sink.warn(Code::MapKey, key.span, message, "each key once");
        }
        entries.insert(key.text, KeyValues { key, values });
    }
    entries
}

/// The line up to a comment, which begins with `#` at its start or after a blank, outside quotes.
fn without_comment<'t>(line: &Line<'t>) -> &'t str {
    let text = line.text;
    let mut quote = None;
    let mut previous = ' ';
    for (index, character) in text.char_indices() {
        match (quote, character) {
            (None, '#') if previous.is_whitespace() => return &text[..index],
            (None, '"' | '\'') if previous.is_whitespace() || matches!(previous, ':' | '[' | ',' | '-') => {
                quote = Some(character);
            }
            (Some(opening_quote), _) if opening_quote == character => quote = None,
            _ => {}
        }
        previous = character;
    }
    text
}

/// Position of the colon after a key: a blank, a bracket, a quote or the end of the line follows it.
fn find_colon(content: &str) -> Option<usize> {
    content.match_indices(':').map(|(index, _)| index).find(|index| {
        content[index + 1..].chars().next().is_none_or(|next| next.is_whitespace() || matches!(next, '[' | '"' | '\''))
    })
}

/// The bytes `from..to` of a line as a word.
fn word_at<'t>(line: &Line<'t>, content: &'t str, from: usize, to: usize) -> Word<'t> {
    let first = line.character_span(from, content[..from].chars().count() as u32 + 1);
    let span = Span { end: first.start + (to - from), ..first };
    Word { text: &content[from..to], span, is_unclosed: false }
}

/// A word without the quotes around it.
fn unquoted(word: Word<'_>) -> Word<'_> {
    let unquoted_text = ['"', '\''].iter().find_map(|quote| word.text.strip_prefix(*quote)?.strip_suffix(*quote));
    Word { text: unquoted_text.unwrap_or(word.text), ..word }
}

/// The values of a line that begin at the byte `from` or after it: a single value, or the values of a list between
/// brackets.
fn scalars<'t>(line: &Line<'t>, content: &'t str, from: usize) -> Vec<Word<'t>> {
    let rest = &content[from..];
    let is_list = rest.contains(['[', ']', ',']) && !rest.trim_start().starts_with(['"', '\'']);
    let mut words = Vec::new();
    let mut start = from;
    let mut add_word = |from: usize, to: usize| {
        let piece = &content[from..to];
        let trimmed = piece.trim();
        if !trimmed.is_empty() {
            let first = from + (piece.len() - piece.trim_start().len());
            words.push(unquoted(word_at(line, content, first, first + trimmed.len())));
        }
    };
    if is_list {
        for (index, _) in rest.match_indices(['[', ']', ',']) {
            add_word(start, from + index);
            start = from + index + 1;
        }
    }
    add_word(start, content.len());
    words
}

struct Values<'t, 's> {
    entries: BTreeMap<&'t str, KeyValues<'t>>,
    sink: &'s mut Sink,
}

impl<'t> Values<'t, '_> {
    fn report(&mut self, severity: Severity, key: &str, message: impl Into<String>, expected: impl Into<String>) {
        let span = self
            .entries
            .get(key)
            .map_or(Span::default(), |entry| entry.values.first().map_or(entry.key.span, |value| value.span));
        self.sink.report(severity, Code::MapKey, span, message, expected);
    }

    /// The only value of a key; reports several values, and a key without a value.
    fn single(&mut self, key: &str, expected: &str) -> Option<Word<'t>> {
        let values = &self.entries.get(key)?.values;
        match values.as_slice() {
            [value] => Some(*value),
            [] => {
                self.report(Severity::Error, key, format!("`{key}` has no value"), expected);
                None
            }
            [.., last] => {
                let (last, count) = (*last, values.len());
                self.sink.error(Code::MapKey, last.span, format!("`{key}` has {count} values"), expected);
                None
            }
        }
    }

    fn report_missing(&mut self, severity: Severity, key: &str, instead: &str, expected: &str) {
        let message = format!("the map has no `{key}`{instead}");
        self.sink.report(severity, Code::MapKey, Span::default(), message, expected);
    }

    fn image(&mut self) -> Option<SpannedText> {
        let expected = "`image: NAME.pgm`: a pgm, pbm, png, bmp or jpg file";
        if !self.entries.contains_key("image") {
            self.report_missing(Severity::Error, "image", "", expected);
            return None;
        }
        let word = self.single("image", expected)?;
        if word.text.trim().is_empty() {
            self.report(Severity::Error, "image", "the name of the image is empty", expected);
            return None;
        }
        Some(SpannedText { text: word.text.to_owned(), span: word.span })
    }

    /// The number of a key. If the key is missing, returns `default` and reports a warning, or an error without a
    /// default.
    fn number(&mut self, key: &str, quantity: Quantity, default: Option<f64>) -> Option<f64> {
        let expected = quantity.expected();
        if !self.entries.contains_key(key) {
            match default {
                Some(default) => {
                    let instead = format!(": {default} is used");
                    self.report_missing(Severity::Warning, key, &instead, &format!("`{key}: {default}`"));
                }
                None => self.report_missing(
                    Severity::Error,
                    key,
                    "",
                    &format!("`{key}: 0.05`, the side of a pixel in metres"),
                ),
            }
            return default;
        }
        let word = self.single(key, &expected)?;
        self.value(&word, &quantity)
    }

    /// A word as a number, in the forms of YAML.
    fn value(&mut self, word: &Word<'t>, quantity: &Quantity) -> Option<f64> {
        let text = match word.text.to_ascii_lowercase().as_str() {
            ".inf" | "+.inf" => "inf",
            "-.inf" => "-inf",
            ".nan" => "nan",
            _ => word.text,
        };
        line::number(self.sink, Severity::Error, &Word { text, ..*word }, quantity)
    }

    fn origin(&mut self) -> Pose {
        let expected = "`origin: [X, Y, YAW]`: the pose of the lower left pixel in metres and radians";
        let Some(entry) = self.entries.get("origin") else {
            self.report_missing(Severity::Warning, "origin", ": [0, 0, 0] is used", expected);
            return Pose::default();
        };
        let values = entry.values.clone();
        let quantities = [
            Quantity::number("x of the origin", -1e6, 1e6),
            Quantity::number("y of the origin", -1e6, 1e6),
            Quantity::number("yaw of the origin", -1e4, 1e4),
        ];
        let (2 | 3) = values.len() else {
            self.report(Severity::Error, "origin", format!("`origin` has {} numbers", values.len()), expected);
            return Pose::default();
        };
        let mut numbers = [0.0; 3];
        for ((number, word), quantity) in numbers.iter_mut().zip(&values).zip(&quantities) {
            *number = self.value(word, quantity).unwrap_or_default();
        }
        if values.len() == 2 {
            self.report(Severity::Warning, "origin", "`origin` has no yaw: 0 is used", expected);
        }
        Pose::new(numbers[0], numbers[1], numbers[2])
    }

    fn negated(&mut self) -> bool {
        let expected = "`negate: 0`, or 1 for an image in which white is occupied";
        if !self.entries.contains_key("negate") {
            self.report_missing(Severity::Warning, "negate", ": 0 is used", expected);
            return false;
        }
        let Some(word) = self.single("negate", expected) else { return false };
        match word.text.to_ascii_lowercase().as_str() {
            "0" | "false" | "no" | "off" => false,
            "1" | "true" | "yes" | "on" => true,
            _ => {
                self.report(Severity::Error, "negate", format!("`negate` is `{}`", word.text), expected);
                false
            }
        }
    }

    fn mode(&mut self) -> Mode {
        let expected = "`mode: trinary`, `scale` or `raw`";
        if !self.entries.contains_key("mode") {
            return Mode::Trinary;
        }
        let Some(word) = self.single("mode", expected) else { return Mode::Trinary };
        match word.text.to_ascii_lowercase().as_str() {
            "trinary" => Mode::Trinary,
            "scale" => Mode::Scale,
            "raw" => Mode::Raw,
            _ => {
                self.report(Severity::Error, "mode", format!("`{}` is not a mode", word.text), expected);
                Mode::Trinary
            }
        }
    }
}
