//! Cursor positions in a TOML text that may be unfinished: in a header, a key or a value.

use std::ops::Range;

/// A table of the text: the document's root, one under a header, or an inline table.
#[derive(Debug, PartialEq)]
pub struct Table {
    /// Keys from the document's root.
    pub path: Vec<String>,
    /// Bytes of the keys and values of the table.
    pub body: Range<usize>,
    pub entries: Vec<TableEntry>,
}

/// A key and its value.
#[derive(Debug, PartialEq)]
pub struct TableEntry {
    /// The key; several parts if it is dotted.
    pub key: Vec<String>,
    pub key_bytes: Range<usize>,
    /// Bytes after the equals sign.
    pub value: Option<Range<usize>>,
}

/// Position of the cursor.
#[derive(Debug, PartialEq)]
pub enum CursorPosition<'t> {
    /// In a header `[a.b]`: the keys before the one at the cursor, and that key.
    Header(Vec<String>, Option<String>),
    /// At a key of the table, written or not: the parts of a dotted key before the one at the cursor.
    Key(&'t Table, Vec<String>),
    /// In the value of an entry of the table.
    Value(&'t Table, &'t TableEntry),
}

/// The tables of a text, and the bytes of its headers with the keys in them.
#[derive(Debug, Default)]
pub struct Outline {
    tables: Vec<Table>,
    headers: Vec<(Range<usize>, Vec<String>)>,
}

impl Outline {
    /// Reads `text`, valid or not.
    pub fn of(text: &str) -> Self {
        let mut scanner = Scanner { text, position: 0, outline: Self::default() };
        scanner.document();
        scanner.outline
    }

    /// Cursor position at the byte `offset` of `text`.
    pub fn cursor(&self, offset: usize, text: &str) -> CursorPosition<'_> {
        let keys_before = |keys: &[String], start: usize| keys[..text[start..offset].matches('.').count()].to_vec();
        if let Some((bytes, keys)) = self.headers.iter().find(|(bytes, _)| bytes.start < offset && offset <= bytes.end)
        {
            let before = keys_before(keys, bytes.start);
            let key = keys.get(before.len()).cloned();
            return CursorPosition::Header(before, key);
        }
        let contains_cursor = |table: &&Table| table.body.start <= offset && offset <= table.body.end;
        // The first table is the root, even if its body is empty; inner tables follow the outer ones.
        let table = self.tables.iter().rfind(contains_cursor).unwrap_or(&self.tables[0]);
        for entry in &table.entries {
            if entry.value.as_ref().is_some_and(|value| value.start <= offset && offset <= value.end) {
                return CursorPosition::Value(table, entry);
            }
            if entry.key_bytes.start <= offset && offset <= entry.key_bytes.end {
                return CursorPosition::Key(table, keys_before(&entry.key, entry.key_bytes.start));
            }
        }
        CursorPosition::Key(table, Vec::new())
    }

    /// The value of the entry `key` of a table, without quotation marks; `None` if it is not a text.
    pub fn text_of<'s>(table: &Table, key: &str, text: &'s str) -> Option<&'s str> {
        let entry = table.entries.iter().find(|entry| entry.key == [key])?;
        let value = text[entry.value.clone()?].trim();
        value.strip_prefix(['"', '\''])?.strip_suffix(['"', '\''])
    }
}

struct Scanner<'t> {
    text: &'t str,
    position: usize,
    outline: Outline,
}

impl Scanner<'_> {
    fn peek(&self) -> Option<char> {
        self.text[self.position..].chars().next()
    }

    fn skip(&mut self, is_skipped: impl Fn(char) -> bool) {
        let rest = &self.text[self.position..];
        self.position += rest.find(|character| !is_skipped(character)).unwrap_or(rest.len());
    }

    /// Skips blanks and comments; also line ends if `over_lines`.
    fn skip_blanks(&mut self, over_lines: bool) {
        loop {
            self.skip(|character| character == ' ' || character == '\t' || over_lines && character.is_whitespace());
            if self.peek() != Some('#') {
                return;
            }
            self.skip(|character| character != '\n');
            if !over_lines {
                return;
            }
        }
    }

    fn document(&mut self) {
        let mut table = self.begin_table(Vec::new());
        loop {
            self.skip_blanks(true);
            match self.peek() {
                None => break,
                Some('[') => {
                    self.outline.tables[table].body.end = self.position;
                    let start = self.position;
                    self.skip(|character| character == '[');
                    let keys_start = self.position;
                    self.skip(|character| character != ']' && character != '\n');
                    let path = keys(&self.text[keys_start..self.position]);
                    self.outline.headers.push((start..self.position, path.clone()));
                    self.skip(|character| character != '\n');
                    table = self.begin_table(path);
                }
                Some(_) => self.entry(table, false),
            }
        }
        self.outline.tables[table].body.end = self.text.len();
    }

    /// Adds a table that begins at the current position.
    fn begin_table(&mut self, path: Vec<String>) -> usize {
        self.outline.tables.push(Table { path, body: self.position..self.position, entries: Vec::new() });
        self.outline.tables.len() - 1
    }

    fn entry(&mut self, table: usize, is_inline: bool) {
        let start = self.position;
        let is_end =
            move |character| character == '=' || character == '\n' || is_inline && matches!(character, ',' | '}');
        self.skip(|character| !is_end(character));
        let key = keys(&self.text[start..self.position]);
        let mut entry = TableEntry { key, key_bytes: start..self.position, value: None };
        if self.peek() == Some('=') {
            self.position += 1;
            let value_start = self.position;
            let path = self.outline.tables[table].path.iter().chain(&entry.key).cloned().collect();
            self.skip_blanks(false);
            self.value(path);
            if !is_inline && !self.begins_statement() {
                // The rest of the line after the value belongs to it.
                self.skip(|character| character != '\n' && character != '#');
            }
            entry.value = Some(value_start..self.position);
        }
        self.outline.tables[table].entries.push(entry);
    }

    /// Skips a value, and adds the inline tables in it.
    fn value(&mut self, path: Vec<String>) {
        match self.peek() {
            Some(quote @ ('"' | '\'')) => self.string(quote),
            Some('[') => {
                self.position += 1;
                loop {
                    self.skip_blanks(true);
                    match self.peek() {
                        Some(']') => return self.position += 1,
                        Some(',') => self.position += 1,
                        Some(_) if !self.begins_statement() => self.value(path.clone()),
                        _ => return,
                    }
                }
            }
            Some('{') => {
                self.position += 1;
                let table = self.begin_table(path);
                loop {
                    self.skip_blanks(true);
                    match self.peek() {
                        Some('}') => break,
                        Some(',') => self.position += 1,
                        Some(_) if !self.begins_statement() => self.entry(table, true),
                        _ => break,
                    }
                }
                self.outline.tables[table].body.end = self.position;
                if self.peek() == Some('}') {
                    self.position += 1;
                }
            }
            _ => {
                let start = self.position;
                self.skip(|character| !matches!(character, ',' | ']' | '}' | '\n' | '#'));
                if self.position == start && matches!(self.peek(), Some(']' | '}')) {
                    self.position += 1; // a bracket that closes nothing
                }
            }
        }
    }

    fn string(&mut self, quote: char) {
        let rest = &self.text[self.position..];
        let long = String::from_iter([quote; 3]);
        if rest.starts_with(&long) {
            let end = rest[3..].find(&long).map_or(rest.len(), |length| length + 6);
            return self.position += end;
        }
        self.position += 1;
        let mut is_escaped = false;
        for character in rest[1..].chars() {
            if character == '\n' {
                return;
            }
            self.position += character.len_utf8();
            if character == quote && !is_escaped {
                return;
            }
            is_escaped = character == '\\' && !is_escaped && quote == '"';
        }
    }

    /// Returns true at the start of a line that looks like a header or a key, so that an unfinished array or table ends
    /// before it.
    fn begins_statement(&self) -> bool {
        let is_first = self.position == 0 || self.text[..self.position].ends_with('\n');
        let line = self.text[self.position..].lines().next().unwrap_or_default();
        let is_header =
            line.starts_with('[') && line[1..].trim_start_matches('[').starts_with(|c: char| c.is_ascii_alphabetic());
        let is_key = line.split_once('=').is_some_and(|(key, _)| is_bare(key.trim()));
        is_first && (is_header || is_key)
    }
}

fn is_bare(key: &str) -> bool {
    !key.is_empty()
        && key.chars().all(|character| character.is_ascii_alphanumeric() || matches!(character, '_' | '-' | '.'))
}

/// Parts of a dotted key; the last one is empty after a dot.
fn keys(text: &str) -> Vec<String> {
    text.split('.').map(|part| part.trim().trim_matches(['"', '\'']).to_owned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Describes the position of the cursor `|` in a text.
    fn description(text: &str) -> String {
        let offset = text.find('|').expect("a cursor");
        let text = text.replacen('|', "", 1);
        let outline = Outline::of(&text);
        match outline.cursor(offset, &text) {
            CursorPosition::Header(keys, _) => format!("header {}", keys.join(".")),
            CursorPosition::Key(table, keys) => format!("key of {}", [&table.path[..], &keys].concat().join(".")),
            CursorPosition::Value(table, entry) => {
                format!("value of {}", [&table.path[..], &entry.key].concat().join("."))
            }
        }
    }

    #[test]
    fn cursor_in_a_valid_text() {
        assert_eq!(description("|"), "key of ");
        assert_eq!(description("a = 1\nb|"), "key of ");
        assert_eq!(description("[wor|]"), "header ");
        assert_eq!(description("[world.li|]\n"), "header world");
        assert_eq!(description("[world]\nfile = \"a|.wld\"\n"), "value of world.file");
        assert_eq!(description("[[robot]]\nx_mm = 1\n|\n[[robot]]\n"), "key of robot");
        assert_eq!(description("[[robot]]\nx_mm = { uni| }"), "key of robot.x_mm");
        assert_eq!(description("[[robot]]\nx_mm = { uniform = [1, |2] }\n"), "value of robot.x_mm.uniform");
        assert_eq!(description("[a]\nb.c.d|"), "key of a.b.c");
        assert_eq!(description("[a]\nb.c|.d = 1"), "key of a.b");
        assert_eq!(description("[a|.b.c]\n"), "header ");
        assert_eq!(description("[a]\nwalls = [\n  { from_mm = [0, 0], t| },\n]\n"), "key of a.walls");
        assert_eq!(description("[a] # what = 1\nb = \"# no [x]\" \n|"), "key of a");
        assert_eq!(description("[a]\nt = \"\"\"\n[b]\nc = |\"\"\"\n"), "value of a.t");
    }

    #[test]
    fn cursor_in_an_unfinished_text() {
        assert_eq!(description("[world\nfile = \"a.wld\"\n[[robot]]\n|"), "key of robot");
        assert_eq!(description("a = [1, 2\n[b]\nc = |"), "value of b.c");
        assert_eq!(description("a = { b = 1,\nc = 2\n[d]\ne|"), "key of d");
        assert_eq!(description("a = \"open\nb = |1"), "value of b");
        assert_eq!(description("a = ]\nb = }\n|"), "key of ");
        assert_eq!(description("[|"), "header ");
    }

    #[test]
    fn any_text_has_an_outline() {
        for text in ["[[[", "a={{{[[[", "=", "\"", "'''", "]]}}", "[a\n=\n=", "{", "é = { ü = [", "a = [\n[b = 1]"] {
            let outline = Outline::of(text);
            text.char_indices().for_each(|(offset, _)| _ = outline.cursor(offset, text));
        }
    }
}
