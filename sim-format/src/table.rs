//! TOML tables: common parts of the readers of companions and scenes.

use std::ops::{Range, RangeInclusive};

use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::Span;
use super::code::Code;
use super::diagnostic::{Severity, Sink};
use super::line::{self, Quantity};
use super::scene::DRAWS;
use super::spec::SpannedText;
use super::{builtin, path, sim};

/// Byte range of keys that settings have added ([`super::set`]): the text does not contain these keys.
pub(super) const SET: Range<usize> = usize::MAX..usize::MAX;

/// Reader of a TOML text, with its diagnostics.
pub(super) struct Reader {
    pub(super) sink: Sink,
    /// The text without byte order mark.
    pub(super) text: String,
    /// Length of the byte order mark.
    offset: usize,
    line_starts: Vec<usize>,
    /// Parts of the text that are not TOML.
    syntax_errors: Vec<Range<usize>>,
    /// True for a scene, whose values may be drawn.
    pub(super) has_draws: bool,
}

/// A table; records the keys that have been looked up.
pub(super) struct Section<'a, 'i> {
    pub(super) name: &'static str,
    pub(super) table: &'a DeTable<'i>,
    pub(super) span: Span,
    known_keys: Vec<&'static str>,
}

impl<'a, 'i> Section<'a, 'i> {
    /// The section that contains the whole document.
    pub(super) fn root(table: &'a DeTable<'i>) -> Self {
        Section { name: "", table, span: Span::default(), known_keys: Vec::new() }
    }

    /// Returns true if the table has this key, without marking the key as known.
    pub(super) fn has(&self, key: &str) -> bool {
        self.table.iter().any(|(name, _)| name.get_ref() == key)
    }

    /// Value of a key; marks the key as known.
    pub(super) fn get(&mut self, key: &'static str) -> Option<&'a Spanned<DeValue<'i>>> {
        if !self.known_keys.contains(&key) {
            self.known_keys.push(key);
        }
        self.table.iter().find(|(name, _)| name.get_ref() == key).map(|(_, value)| value)
    }
}

impl Reader {
    /// Parses the text of `file`; syntax errors are reported, and the valid part is kept.
    pub(super) fn parse<'t>(file: &str, text: &'t str) -> (Self, DeTable<'t>) {
        let byte_count = text.len();
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let (root, errors) = DeTable::parse_recoverable(text);
        let mut reader = Self {
            sink: Sink::new(file),
            line_starts: line::line_starts(text),
            offset: byte_count - text.len(),
            text: text.to_owned(),
            syntax_errors: errors.iter().filter_map(toml::de::Error::span).collect(),
            has_draws: false,
        };
        if let Some(span) = first_sim_word(text).filter(|_| !errors.is_empty()) {
            let expected = "TOML: `key = value` lines and `[section]` lines";
            let diagnostic = reader.sink.error(Code::TomlSyntax, span, "the file is a sim file, and no TOML", expected);
            let stem = path::stem(file);
            let stem = stem.strip_suffix(".scene").unwrap_or(stem);
            diagnostic.suggestion = Some(format!("name it `{stem}.sim`"));
            return (reader, DeTable::new());
        }
        for error in errors {
            let span = reader.span(error.span().unwrap_or(0..0));
            let expected = "TOML: `key = value` lines and `[section]` lines";
            let hint = error.span().and_then(|span| number_hint(text, span.start));
            reader.sink.error(Code::TomlSyntax, span, error.message().trim(), expected).suggestion = hint;
        }
        (reader, root.into_inner())
    }
}

/// Suggestion for the malformed number around a byte of a TOML text: a number without leading zeros, with digits on both
/// sides of its point.
fn number_hint(text: &str, byte: usize) -> Option<String> {
    let separates = |c: char| c.is_whitespace() || "=[]{}#\"'".contains(c);
    let (before, after) = text.split_at_checked(byte)?;
    let start = before.trim_end_matches(|c| !separates(c)).len();
    let end = byte + after.find(separates).unwrap_or(after.len());
    let word = text[start..end].trim_matches(',');
    let guess = Some(word).filter(|word| line::looks_numeric(word)).and_then(line::guessed_number)?;
    let number = guess.parse::<f64>().ok()?.to_string();
    if !word.contains(',') {
        return (number != word).then(|| format!("write `{number}`"));
    }
    // Between the values of an array, only a comma before three digits is surely part of a number.
    let is_single = text[..start].trim_end().ends_with('=');
    let is_number = is_single || word.matches(',').count() == 1 && !guess.contains('.');
    is_number.then(|| format!("write `{number}`: a comma separates values"))
}

/// The first word of `text`, if the text begins like a sim file.
fn first_sim_word(text: &str) -> Option<Span> {
    let line = line::lines(text).find(|line| !line.words().is_empty())?;
    let words = line.words();
    let (first, rest) = words.split_first()?;
    let mut keywords = sim::KEYWORDS.iter().chain(&builtin::ROBOTS);
    let is_known = keywords.any(|keyword| keyword.eq_ignore_ascii_case(first.text));
    (is_known && rest.first().is_some_and(|word| !word.text.starts_with('='))).then_some(first.span)
}

impl Reader {
    /// Span of the bytes `range` in the file; the span of the whole file for [`SET`].
    pub(super) fn span(&self, range: Range<usize>) -> Span {
        if range == SET {
            return Span::default();
        }
        let mut start = range.start.min(self.text.len());
        while !self.text.is_char_boundary(start) {
            start -= 1;
        }
        let line = self.line_starts.partition_point(|begin| *begin <= start).max(1);
        let column = self.text[self.line_starts[line - 1]..start].chars().count() + 1;
        let end = range.end.clamp(start, self.text.len());
        Span { start: self.offset + start, end: self.offset + end, line: line as u32, column: column as u32 }
    }

    pub(super) fn missing(&mut self, section: &Section<'_, '_>, key: &str) {
        let message = match section.name {
            "" => format!("there is no `{key}`"),
            name => format!("`{name}` has no `{key}`"),
        };
        self.sink.error(Code::TomlMissing, section.span, message, format!("a line `{key} = ...`"));
    }

    pub(super) fn required(
        &mut self,
        section: &mut Section<'_, '_>,
        key: &'static str,
        quantity: &Quantity,
    ) -> Option<f64> {
        if !section.has(key) {
            section.get(key);
            self.missing(section, key);
            return None;
        }
        self.number(section, key, quantity)
    }

    pub(super) fn number(
        &mut self,
        section: &mut Section<'_, '_>,
        key: &'static str,
        quantity: &Quantity,
    ) -> Option<f64> {
        let value = section.get(key)?;
        self.as_number(key, value, quantity)
    }

    pub(super) fn as_number(&mut self, key: &str, value: &Spanned<DeValue<'_>>, quantity: &Quantity) -> Option<f64> {
        let span = self.span(value.span());
        let Some(number) = float(value.get_ref()) else {
            self.wrong_type(key, value, &quantity.expected());
            return None;
        };
        let checked = quantity.check(number);
        if checked.is_none() {
            let message = format!("{} `{number}` is out of range", quantity.name);
            self.sink.error(Code::NumberRange, span, message, quantity.expected());
        }
        checked
    }

    pub(super) fn integer(
        &mut self,
        section: &mut Section<'_, '_>,
        key: &'static str,
        low: i64,
        high: i64,
    ) -> Option<i64> {
        let value = section.get(key)?;
        self.as_integer(key, value, low, high)
    }

    pub(super) fn as_integer(&mut self, key: &str, value: &Spanned<DeValue<'_>>, low: i64, high: i64) -> Option<i64> {
        let expected = format!("an integer from {low} to {high}");
        let DeValue::Integer(digits) = value.get_ref() else {
            self.wrong_type(key, value, &expected);
            return None;
        };
        let number = i64::from_str_radix(digits.as_str(), digits.radix()).ok();
        let number = number.filter(|number| (low..=high).contains(number));
        if number.is_none() {
            let message = format!("{key} `{digits}` is out of range");
            self.sink.error(Code::NumberRange, self.span(value.span()), message, expected);
        }
        number
    }

    pub(super) fn text(&mut self, section: &mut Section<'_, '_>, key: &'static str) -> Option<String> {
        self.text_of(section, key, "a text that is not empty, between double quotes")
    }

    /// Non-empty string; `expected` describes it in messages.
    pub(super) fn text_of(
        &mut self,
        section: &mut Section<'_, '_>,
        key: &'static str,
        expected: &str,
    ) -> Option<String> {
        let value = section.get(key)?;
        let text = value.get_ref().as_str().filter(|text| !text.trim().is_empty());
        if text.is_none() {
            self.wrong_type(key, value, expected);
        }
        text.map(str::to_owned)
    }

    /// Reference to a file, or the name of a type.
    pub(super) fn reference(&mut self, section: &mut Section<'_, '_>, key: &'static str) -> Option<SpannedText> {
        self.reference_to(section, key, "a text that is not empty, between double quotes")
    }

    /// Reference like [`Reader::reference`]; `expected` describes it in messages.
    pub(super) fn reference_to(
        &mut self,
        section: &mut Section<'_, '_>,
        key: &'static str,
        expected: &str,
    ) -> Option<SpannedText> {
        let text = self.text_of(section, key, expected)?;
        let span = section.get(key).map_or(section.span, |value| self.span(value.span()));
        Some(SpannedText { text, span })
    }

    /// Items of an array of strings and numbers. Strings may be empty; numbers are returned as strings.
    pub(super) fn words(&mut self, section: &mut Section<'_, '_>, key: &'static str) -> Vec<String> {
        let Some(items) = self.array(section, key, "an array of texts and numbers") else {
            return Vec::new();
        };
        let mut texts = Vec::with_capacity(items.len());
        for item in items {
            match item.get_ref() {
                DeValue::String(text) => texts.push(text.clone().into_owned()),
                DeValue::Integer(digits) if digits.radix() == 10 => texts.push(digits.as_str().to_owned()),
                DeValue::Float(digits) => texts.push(digits.as_str().to_owned()),
                _ => self.wrong_type(key, item, "a text between double quotes, or a number"),
            }
        }
        texts
    }

    /// Value of a Boolean key.
    pub(super) fn flag(&mut self, section: &mut Section<'_, '_>, key: &'static str) -> Option<bool> {
        let value = section.get(key)?;
        let DeValue::Boolean(flag) = value.get_ref() else {
            self.wrong_type(key, value, "true or false");
            return None;
        };
        Some(*flag)
    }

    /// One of `words`, as its index.
    pub(super) fn choice(&mut self, section: &mut Section<'_, '_>, key: &'static str, words: &[&str]) -> Option<usize> {
        let expected = format!("one of {}", words.join(", "));
        let value = section.get(key)?;
        let Some(text) = value.get_ref().as_str() else {
            self.wrong_type(key, value, &expected);
            return None;
        };
        let index = words.iter().position(|word| *word == text);
        if index.is_none() {
            let suggestion = line::nearest(text, words.iter().copied()).map(|word| format!("write `{word}`"));
            let message = format!("`{text}` is not a valid `{key}`");
            self.sink.error(Code::TomlChoice, self.span(value.span()), message, expected).suggestion = suggestion;
        }
        index
    }

    /// Array of `N` numbers.
    pub(super) fn numbers<const N: usize>(
        &mut self,
        section: &mut Section<'_, '_>,
        key: &'static str,
        quantities: &[Quantity; N],
    ) -> Option<[f64; N]> {
        let expected = format!("an array of {N} numbers");
        let value = section.get(key)?;
        let items = match value.get_ref() {
            DeValue::Array(items) if items.len() == N => items,
            DeValue::Array(items) => {
                self.wrong_length(key, value.span(), items.len(), &expected);
                return None;
            }
            _ => {
                self.wrong_type(key, value, &expected);
                return None;
            }
        };
        let mut values = [0.0; N];
        let mut is_complete = true;
        for ((target, item), quantity) in values.iter_mut().zip(items).zip(quantities) {
            match self.as_number(key, item, quantity) {
                Some(value) => *target = value,
                None => is_complete = false,
            }
        }
        is_complete.then_some(values)
    }

    /// `N` colour channels, each 0 to 255.
    pub(super) fn shades<const N: usize>(
        &mut self,
        section: &mut Section<'_, '_>,
        key: &'static str,
    ) -> Option<[u8; N]> {
        let expected = format!("an array of {N} integers from 0 to 255");
        let items = self.array(section, key, &expected)?;
        if items.len() != N {
            let span = section.get(key).map_or(SET, Spanned::span);
            self.wrong_length(key, span, items.len(), &expected);
            return None;
        }
        let shades: Vec<u8> =
            items.iter().filter_map(|item| self.as_integer(key, item, 0, 255)).map(|shade| shade as u8).collect();
        shades.try_into().ok()
    }

    /// Items of an array.
    pub(super) fn array<'a, 'i>(
        &mut self,
        section: &mut Section<'a, 'i>,
        key: &'static str,
        expected: &str,
    ) -> Option<&'a [Spanned<DeValue<'i>>]> {
        let value = section.get(key)?;
        let DeValue::Array(items) = value.get_ref() else {
            self.wrong_type(key, value, expected);
            return None;
        };
        Some(items)
    }

    /// Reports the `keys` that a table has although `other` excludes them; returns true if the table has none of these
    /// keys.
    pub(super) fn exclude(&mut self, section: &mut Section<'_, '_>, other: &str, keys: &[&'static str]) -> bool {
        let mut is_clean = true;
        for key in keys {
            if section.get(key).is_some() {
                let span = self.key_span(section, key);
                let message = format!("`{key}` and `{other}` exclude each other");
                self.sink.error(Code::TomlConflict, span, message, format!("either `{key}` or `{other}`"));
                is_clean = false;
            }
        }
        is_clean
    }

    /// Span of a key; the span of the table if the key is missing.
    pub(super) fn key_span(&self, section: &Section<'_, '_>, key: &str) -> Span {
        let entry = section.table.iter().find(|(name, _)| name.get_ref() == key);
        entry.map_or(section.span, |(name, _)| self.span(name.span()))
    }

    /// Span of a key's value; the span of the table if the key is missing.
    pub(super) fn value_span(&self, section: &Section<'_, '_>, key: &str) -> Span {
        let entry = section.table.iter().find(|(name, _)| name.get_ref() == key);
        entry.map_or(section.span, |(_, value)| self.span(value.span()))
    }

    /// Parses a key itself as a number, as in `3 = 512`.
    pub(super) fn number_of(
        &mut self,
        key: &Spanned<DeString<'_>>,
        numbers: &RangeInclusive<u8>,
        noun: &str,
    ) -> Option<u8> {
        let number = key.get_ref().parse().ok().filter(|number| numbers.contains(number));
        if number.is_none() {
            let message = format!("`{}` is not a valid {noun}", key.get_ref());
            let expected = format!("a number from {} to {}", numbers.start(), numbers.end());
            self.sink.error(Code::TomlKey, self.span(key.span()), message, expected);
        }
        number
    }

    pub(super) fn section<'a, 'i>(
        &mut self,
        parent: &mut Section<'a, 'i>,
        key: &'static str,
    ) -> Option<Section<'a, 'i>> {
        let value = parent.get(key)?;
        self.as_section(key, value)
    }

    /// Subtable; `example` shows its content in messages, unless it is empty.
    pub(super) fn section_like<'a, 'i>(
        &mut self,
        parent: &mut Section<'a, 'i>,
        key: &'static str,
        example: &str,
    ) -> Option<Section<'a, 'i>> {
        let value = parent.get(key)?;
        match example {
            "" => self.as_section(key, value),
            example => self.as_section_or(key, value, &format!("a table such as `{key} = {{ {example} }}`")),
        }
    }

    pub(super) fn as_section<'a, 'i>(
        &mut self,
        key: &'static str,
        value: &'a Spanned<DeValue<'i>>,
    ) -> Option<Section<'a, 'i>> {
        self.as_section_or(key, value, "a table")
    }

    fn as_section_or<'a, 'i>(
        &mut self,
        key: &'static str,
        value: &'a Spanned<DeValue<'i>>,
        expected: &str,
    ) -> Option<Section<'a, 'i>> {
        let span = self.span(value.span());
        match value.get_ref() {
            DeValue::Table(table) => Some(Section { name: key, table, span, known_keys: Vec::new() }),
            _ => {
                self.wrong_type(key, value, expected);
                None
            }
        }
    }

    /// Tables of an array `[[key]]`; a single `[key]` is read as an array of one table.
    pub(super) fn sections<'a, 'i>(&mut self, parent: &mut Section<'a, 'i>, key: &'static str) -> Vec<Section<'a, 'i>> {
        let Some(value) = parent.get(key) else {
            return Vec::new();
        };
        match value.get_ref() {
            DeValue::Array(items) => items.iter().filter_map(|item| self.as_section(key, item)).collect(),
            _ => self.as_section(key, value).into_iter().collect(),
        }
    }

    /// Reports an array of a wrong length, unless a part of it is not TOML.
    fn wrong_length(&mut self, key: &str, span: Range<usize>, length: usize, expected: &str) {
        if !self.is_guess(&span) {
            let message = format!("`{key}` has {length} values");
            self.sink.error(Code::TomlType, self.span(span), message, expected);
        }
    }

    /// Returns true for a value at or in which the text is not TOML.
    fn is_guess(&self, span: &Range<usize>) -> bool {
        self.syntax_errors.iter().any(|error| error.start <= span.end && span.start <= error.end)
    }

    /// Reports a value of a wrong type, unless it is the guess for a part that is not TOML.
    pub(super) fn wrong_type(&mut self, key: &str, value: &Spanned<DeValue<'_>>, expected: &str) {
        let span = value.span();
        if self.is_guess(&span) {
            return;
        }
        let message = format!("`{key}` is of type {}", value.get_ref().type_str());
        let draw = match value.get_ref() {
            DeValue::Table(table) => table.keys().find_map(|key| line::nearest(key.get_ref(), DRAWS)),
            _ => None,
        };
        self.sink.error(Code::TomlType, self.span(span), message, expected).suggestion =
            draw.map(|key| match self.has_draws {
                true => format!("write `{key}`"),
                false => "only scenes have random values".to_owned(),
            });
    }

    pub(super) fn unknown_keys(&mut self, section: &Section<'_, '_>) {
        for (key, _) in section.table {
            let name = key.get_ref().as_ref();
            if section.known_keys.contains(&name) {
                continue;
            }
            let suffix = if section.name.is_empty() { String::new() } else { format!(" in `{}`", section.name) };
            let message = format!("unknown key `{name}`{suffix}");
            let expected = format!("one of {}", section.known_keys.join(", "));
            let keys = || section.known_keys.iter().copied();
            // A key without its unit is similar to the key with the unit.
            let with_unit = keys().find(|key| key.strip_prefix(name).is_some_and(|unit| unit.starts_with('_')));
            let nearest = line::nearest(name, keys()).or(with_unit);
            let suggestion = nearest.map(|key| format!("write `{key}`"));
            // A setting is never meant for a future version or for another program.
            let severity = if key.span() == SET { Severity::Error } else { Severity::Warning };
            let span = self.span(key.span());
            self.sink.report(severity, Code::TomlKey, span, message, expected).suggestion = suggestion;
        }
    }
}

/// Returns true for a TOML text with one of `keys` at its top level.
pub(super) fn has_top_key(text: &str, keys: &[&str]) -> bool {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let (root, _) = DeTable::parse_recoverable(text);
    root.get_ref().keys().any(|key| keys.contains(&key.get_ref().as_ref()))
}

fn float(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Integer(digits) => {
            i64::from_str_radix(digits.as_str(), digits.radix()).ok().map(|number| number as f64)
        }
        DeValue::Float(digits) => digits.as_str().parse().ok(),
        _ => None,
    }
}
