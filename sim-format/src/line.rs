//! Lines, words and numbers, common to the classic formats.

use std::collections::BTreeMap;

pub(super) use sim_core::nearest::nearest;
pub(super) use sim_core::unit::Quantity;

use super::Span;
use super::code::Code;
use super::diagnostic::{Severity, Sink};

/// A line without its terminator.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<'a> {
    pub(super) text: &'a str,
    /// Byte offset of its first character in the whole text.
    start: usize,
    /// Number of the line, from 1.
    number: u32,
}

/// Maximum number of words per line, so that a file of a single line does not exhaust the memory.
const MAX_WORDS: usize = 1000;

/// A word of a line, without its quotes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Word<'a> {
    pub(super) text: &'a str,
    pub(super) span: Span,
    /// True if the word opens with a quotation mark that is never closed.
    pub(super) is_unclosed: bool,
}

/// The lines of a text, which end with LF, CR LF or CR; skips a byte order mark.
pub(super) fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    let bytes = text.as_bytes();
    let mut start = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
    let mut number = 0;
    std::iter::from_fn(move || {
        if start >= bytes.len() {
            return None;
        }
        let length =
            bytes[start..].iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(bytes.len() - start);
        number += 1;
        let line = Line { text: &text[start..start + length], start, number };
        let end = start + length;
        start = end + if text[end..].starts_with("\r\n") { 2 } else { 1 };
        Some(line)
    })
}

/// Byte offsets of the starts of a text's lines; lines end as in [`lines`].
pub(super) fn line_starts(text: &str) -> Vec<usize> {
    let bytes = text.as_bytes();
    let ends = (0..bytes.len()).filter(|&index| match bytes[index] {
        b'\n' => true,
        b'\r' => bytes.get(index + 1) != Some(&b'\n'),
        _ => false,
    });
    std::iter::once(0).chain(ends.map(|index| index + 1)).collect()
}

impl<'a> Line<'a> {
    /// Span of the whole line.
    pub(super) fn span(&self) -> Span {
        Span { start: self.start, end: self.start + self.text.len(), line: self.number, column: 1 }
    }

    /// Words of the line, separated by blanks and tabs; `"..."` and `'...'` are one word each. A comment begins with
    /// `;`, or with `#` at the start of a word. Words beyond [`MAX_WORDS`], more than any format needs, are ignored.
    pub(super) fn words(&self) -> Vec<Word<'a>> {
        let mut words = Vec::new();
        let mut characters = self.text.char_indices().zip(1..).peekable();
        while let Some(&((first, character), column)) = characters.peek() {
            if character.is_whitespace() {
                characters.next();
                continue;
            }
            if matches!(character, ';' | '#') || words.len() == MAX_WORDS {
                break;
            }
            let quote = matches!(character, '"' | '\'').then_some(character);
            if quote.is_some() {
                characters.next();
            }
            let ends = |c: char| quote.map_or(c.is_whitespace() || c == ';', |quote| c == quote);
            let mut end = self.text.len();
            let mut is_unclosed = quote.is_some();
            while let Some(&((index, character), _)) = characters.peek() {
                if ends(character) {
                    (end, is_unclosed) = (index, false);
                    break;
                }
                characters.next();
            }
            let text_start = first + usize::from(quote.is_some());
            let outer_end = if quote.is_some() && !is_unclosed {
                characters.next();
                end + 1
            } else {
                end
            };
            let span = Span { start: self.start + first, end: self.start + outer_end, line: self.number, column };
            words.push(Word { text: &self.text[text_start..end], span, is_unclosed });
        }
        words
    }

    /// Empty line just before this line's first character.
    pub(super) fn before(&self) -> Line<'a> {
        Line { text: "", ..*self }
    }

    /// Span of a single character of the line, given its byte and its column.
    pub(super) fn character_span(&self, byte: usize, column: u32) -> Span {
        let length = self.text[byte..].chars().next().map_or(0, char::len_utf8);
        Span { start: self.start + byte, end: self.start + byte + length, line: self.number, column }
    }
}

impl<'a> Word<'a> {
    /// Text of the word, between double quotes if it contains blanks.
    pub(super) fn quoted(&self) -> String {
        if self.text.contains(' ') { format!("\"{}\"", self.text) } else { self.text.to_owned() }
    }

    /// Extends this word to the end of `last`, a later word of the same `line`.
    pub(super) fn extend_to(&mut self, line: &Line<'a>, last: &Word<'a>) {
        self.span = self.span.to(last.span);
        self.text = &line.text[self.span.start - line.start..self.span.end - line.start];
    }
}

/// Dashes that word processors and PDF files have instead of a minus sign: en dash and U+2212.
const DASHES: [char; 2] = ['\u{2013}', '\u{2212}'];

/// Returns true if a word is probably meant as a number.
pub(super) fn looks_numeric(word: &str) -> bool {
    let unsigned = word.trim_start_matches(['+', '-']).trim_start_matches(DASHES);
    unsigned.starts_with(|c: char| c.is_ascii_digit() || c == '.') || word.parse::<f64>().is_ok()
}

/// Severity of a value out of the bounds of `quantity`.
fn severity_of(quantity: &Quantity) -> Severity {
    if quantity.is_minor() { Severity::Warning } else { Severity::Error }
}

/// Parses `word` as `quantity`, in SI units; reports mistakes.
///
/// A word that is not a number has the given `severity` (EyeSim either skips the line or loses a robot). A number out
/// of bounds, an infinity and NaN are errors, since EyeSim reads them and the whole file fails. If the quantity is
/// minor, they are warnings.
pub(super) fn number(sink: &mut Sink, severity: Severity, word: &Word<'_>, quantity: &Quantity) -> Option<f64> {
    let name = quantity.name;
    let Ok(value) = word.text.parse::<f64>() else {
        let message = format!("`{}` is not a number ({name})", word.text);
        let diagnostic = sink.report(severity, Code::NumberInvalid, word.span, message, quantity.expected());
        diagnostic.suggestion = number_hint(word.text).or_else(|| comment_hint(word.text));
        return None;
    };
    let checked = quantity.check(value);
    if checked.is_none() {
        let message = format!("{name} `{}` is out of range", word.text);
        sink.report(severity_of(quantity), Code::NumberRange, word.span, message, quantity.expected());
    }
    checked
}

/// Suggestion for a malformed number.
pub(super) fn number_hint(word: &str) -> Option<String> {
    let note = if word.ends_with([',', ';']) { ": blanks separate numbers" } else { "" };
    guessed_number(word).map(|text| format!("write `{text}`{note}"))
}

/// The keyword of a line such as `world=box.wld`, and the line without `=`; `None` for a line of another form.
pub(super) fn without_equals_sign<'k>(
    keywords: &[&'k str],
    first: &Word<'_>,
    rest: &[Word<'_>],
) -> Option<(&'k str, String)> {
    let line = std::iter::once(first).chain(rest).map(Word::quoted).collect::<Vec<_>>().join(" ");
    let (written, value) = line.split_once('=')?;
    let keyword = keywords.iter().find(|keyword| keyword.eq_ignore_ascii_case(written.trim()))?;
    Some((keyword, format!("{keyword} {}", value.trim())))
}

/// Keywords that a file has at most once, with the lines that they are in.
#[derive(Debug, Default)]
pub(super) struct SingleKeywords(BTreeMap<String, u32>);

impl SingleKeywords {
    /// Records a line with `keyword`; warns if an earlier line has it too.
    pub(super) fn add(&mut self, sink: &mut Sink, keyword: &str, span: Span) {
        let first_line = *self.0.entry(keyword.to_owned()).or_insert(span.line);
        if first_line != span.line {
            let message = format!("`{keyword}` is in line {first_line} too");
            sink.warn(Code::KeywordTwice, span, message, format!("one line with `{keyword}`"));
        }
    }
}

/// Suggestion for a word that begins a comment of C.
pub(super) fn comment_hint(word: &str) -> Option<String> {
    ["//", "/*"].iter().any(|mark| word.starts_with(mark)).then(|| "begin a comment with `#`".to_owned())
}

/// Suggestion for a line with commas between its numbers: the line with blanks, if `is_complete` accepts its words.
pub(super) fn without_commas<'w, 't: 'w>(
    words: impl IntoIterator<Item = &'w Word<'t>>,
    is_complete: impl Fn(&[String]) -> bool,
) -> Option<String> {
    let (mut separated, mut has_commas) = (Vec::new(), false);
    for word in words {
        let parts = || word.text.split(',').filter(|part| !part.is_empty());
        // A list of source files has commas too.
        if word.text.contains(',') && parts().any(|part| part.parse::<f64>().is_ok()) {
            has_commas = true;
            separated.extend(parts().map(str::to_owned));
        } else {
            separated.push(word.quoted());
        }
    }
    (has_commas && is_complete(&separated)).then(|| format!("write `{}`: blanks separate numbers", separated.join(" ")))
}

/// Guess of the number that the user meant. Corrects a comma instead of the point, after the number or before each
/// three digits, letters instead of digits, a dash instead of the minus sign, or an attached unit.
pub(super) fn guessed_number(word: &str) -> Option<String> {
    let word = word.trim_end_matches([',', ';']).replace(DASHES, "-");
    let without_unit =
        ["mm/s", "mm", "deg/s", "deg", "°", "kg"].iter().find_map(|unit| word.strip_suffix(unit)).unwrap_or(&word);
    let corrected = |c: char| match c {
        'O' | 'o' => '0',
        'l' | 'I' => '1',
        ',' => '.',
        c => c,
    };
    let guess = match has_thousands(without_unit) {
        true => without_unit.replace(',', ""),
        false => without_unit.chars().map(corrected).collect(),
    };
    guess.parse::<f64>().is_ok_and(f64::is_finite).then_some(guess)
}

/// Returns true for a whole number with a comma before each three digits, such as `2,000`.
fn has_thousands(word: &str) -> bool {
    let is_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let mut groups = word.trim_start_matches(['+', '-']).split(',');
    let head = groups.next().unwrap_or_default();
    let mut groups = groups.peekable();
    (1..=3).contains(&head.len())
        && is_digits(head)
        && !head.starts_with('0')
        && groups.peek().is_some()
        && groups.all(|group| group.len() == 3 && is_digits(group))
}

/// Numbers of a line of exactly `N` values; reports each invalid one. `None`, without a message, for another count.
pub(super) fn numbers<const N: usize>(
    sink: &mut Sink,
    severity: Severity,
    words: &[Word<'_>],
    quantities: &[Quantity; N],
) -> Option<[f64; N]> {
    let mut values = [0.0; N];
    let mut is_complete = words.len() == N;
    for ((value, word), quantity) in values.iter_mut().zip(words).zip(quantities) {
        match number(sink, severity, word, quantity) {
            Some(converted) => *value = converted,
            None => is_complete = false,
        }
    }
    is_complete.then_some(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<(String, u32, u32)> {
        let words = lines(text).flat_map(|line| line.words());
        words.map(|word| (word.text.to_owned(), word.span.line, word.span.column)).collect()
    }

    #[test]
    fn words_have_line_and_column_in_characters() {
        let expected = [("a", 1, 1), ("é", 1, 3), ("b", 1, 5), ("c d", 2, 2), ("1", 4, 1), ("2", 5, 1)];
        let expected = expected.map(|(word, line, column)| (word.to_owned(), line, column));
        assert_eq!(words("\u{feff}a é b;x\r\n\t'c d' # e\n\n1\r2"), expected);
    }

    #[test]
    fn spans_select_the_words_in_the_text() {
        let text = "\u{feff}é \"x y\" z";
        let spans: Vec<&str> = lines(text).flat_map(|l| l.words()).map(|w| &text[w.span.start..w.span.end]).collect();
        assert_eq!(spans, ["é", "\"x y\"", "z"]);
    }

    #[test]
    fn lines_start_after_each_kind_of_end() {
        let text = "a\r\n\rb\n\nc\r";
        assert_eq!(line_starts(text), [0, 3, 4, 6, 7, 9]);
        let numbered: Vec<usize> = lines(text).map(|line| line.start).collect();
        assert_eq!(numbered, [0, 3, 4, 6, 7]);
    }

    #[test]
    fn word_with_unclosed_quote_extends_to_the_end_of_the_line() {
        let word = lines("world \"a b").flat_map(|line| line.words()).nth(1).expect("two words");
        assert_eq!((word.text, word.is_unclosed), ("a b", true));
    }

    #[test]
    fn commas_between_numbers_become_blanks() {
        let suggested = |text, count| {
            let words: Vec<Word<'_>> = lines(text).flat_map(|line| line.words()).collect();
            without_commas(&words, |words| words.len() == count)
        };
        assert_eq!(suggested("floor 1,2", 3).as_deref(), Some("write `floor 1 2`: blanks separate numbers"));
        assert_eq!(suggested("floor 1,2", 4), None);
        assert_eq!(suggested("floor 1 2", 3), None);
        assert_eq!(
            suggested("S4 1,2, 3 a.c,b.c", 5).expect("commas"),
            "write `S4 1 2 3 a.c,b.c`: blanks separate numbers"
        );
    }

    #[test]
    fn numbers_with_comma_or_unit_are_guessed() {
        assert_eq!(guessed_number("12,5").as_deref(), Some("12.5"));
        assert_eq!(guessed_number("360mm").as_deref(), Some("360"));
        assert_eq!(guessed_number("1OO").as_deref(), Some("100"));
        assert_eq!(guessed_number("wide"), None);
        assert_eq!(guessed_number("\u{2013}90").as_deref(), Some("-90"));
        assert_eq!(guessed_number("5kg").as_deref(), Some("5"));
        assert_eq!(guessed_number("1,000,000").as_deref(), Some("1000000"));
        assert_eq!(guessed_number("\u{2013}2,000").as_deref(), Some("-2000"));
        assert_eq!(guessed_number("-2,000mm").as_deref(), Some("-2000"));
        assert_eq!(guessed_number("0,125").as_deref(), Some("0.125"));
    }
}
