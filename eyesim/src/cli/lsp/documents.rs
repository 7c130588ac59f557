//! The documents that are open in an editor, and positions in them.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::str::FromStr as _;

use lsp_types::{Position, Uri};
use sim_format::{Files as _, path};
use sim_host::files::DiskFiles;

use super::super::check::{is_noise, is_scene, is_suite_file};

/// Unit in which an editor counts columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Bytes.
    Utf8,
    /// UTF-16 code units.
    Utf16,
}

impl Encoding {
    fn length(self, character: char) -> usize {
        match self {
            Encoding::Utf8 => character.len_utf8(),
            Encoding::Utf16 => character.len_utf16(),
        }
    }
}

/// The files on the disk, with the open documents in place of their files.
pub struct Documents {
    disk: DiskFiles,
    /// `disk` with `texts` in place of their files.
    files: DiskFiles,
    /// Text of each open document, by its absolute path.
    texts: BTreeMap<String, String>,
    encoding: Encoding,
}

impl Documents {
    pub fn new(disk: DiskFiles, encoding: Encoding) -> Self {
        Self { files: disk.clone(), disk, texts: BTreeMap::new(), encoding }
    }

    /// Opens a document or replaces its text; returns false if `uri` is not a `file:` URI.
    pub fn open(&mut self, uri: &Uri, text: String) -> bool {
        let Some(name) = name_of(uri) else { return false };
        self.texts.insert(name, text);
        self.update_files();
        true
    }

    /// Closes a document, so that its file is read from the disk again; returns false if it was not open.
    pub fn close(&mut self, uri: &Uri) -> bool {
        let is_closed = name_of(uri).is_some_and(|name| self.texts.remove(&name).is_some());
        self.update_files();
        is_closed
    }

    fn update_files(&mut self) {
        let open = |files: DiskFiles, (name, text): (&String, &String)| files.with_text(Path::new(name), text);
        self.files = self.texts.iter().fold(self.disk.clone(), open);
    }

    /// The files as the editor shows them.
    pub fn files(&self) -> &DiskFiles {
        &self.files
    }

    /// Paths of the open documents.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.texts.keys().map(String::as_str)
    }

    /// Paths of the open documents that `eyesim check` reads. Most TOML files on a computer do not belong to EyeSim: a
    /// TOML file is included if it is a scene, a suite or a noise profile, or a companion file, that is, if a `.robi`
    /// file of the same name is beside it.
    pub fn checkable(&self) -> Vec<String> {
        let is_own_format = |name: &&str| match path::extension(name).as_str() {
            "sim" | "wld" | "maz" | "maze" | "esobj" | "robi" | "num" | "scen" => true,
            "toml" => {
                is_scene(name, &self.files)
                    || is_suite_file(name, &self.files)
                    || is_noise(name, &self.files)
                    || self.files.read(&path::with_extension(name, "robi")).is_ok()
            }
            _ => false,
        };
        self.names().filter(is_own_format).map(str::to_owned).collect()
    }

    /// The open document at a URI.
    pub fn open_document(&self, uri: &Uri) -> Option<Document> {
        let name = name_of(uri)?;
        let text = self.texts.get(&name)?.clone();
        Some(Document { name, text, encoding: self.encoding })
    }

    /// The document or file at the path `name`, with an empty text if it cannot be read; `None` if the path has no URI,
    /// so that an editor cannot show it.
    pub fn document(&self, name: &str) -> Option<Document> {
        let text = self.files.read(name).map_or(String::new(), |bytes| sim_format::decode(&bytes).0);
        uri_of(name).map(|_| Document { name: name.to_owned(), text, encoding: self.encoding })
    }

    /// Absolute path of the existing file that the word at `offset` names.
    pub fn named_file(&self, document: &Document, offset: usize) -> Option<String> {
        let (word, _) = document.word(offset)?;
        let candidates = path::candidates(word, path::folder_of(&document.name), self.files.home());
        candidates.into_iter().find(|name| Path::new(name).is_file()).and_then(|name| {
            let is_absolute = name.starts_with('/');
            if is_absolute {
                Some(name)
            } else {
                Some(sim_host::files::slashed(&std::env::current_dir().ok()?.join(name)))
            }
        })
    }
}

/// A text and the path of its file.
#[derive(Clone, Debug)]
pub struct Document {
    /// Absolute path.
    pub name: String,
    pub text: String,
    pub encoding: Encoding,
}

impl Document {
    /// Returns true for a TOML file.
    pub fn is_toml(&self) -> bool {
        path::extension(&self.name) == "toml"
    }

    /// Byte offset of a position; a position beyond the end of its line or of the text counts as that end.
    pub fn offset(&self, position: Position) -> usize {
        let Some(line) = self.lines().nth(position.line as usize) else { return self.text.len() };
        let mut units = 0;
        let text = self.text[line.clone()].char_indices();
        let target = text.clone().find(|(_, character)| {
            let is_target = units >= position.character as usize;
            units += self.encoding.length(*character);
            is_target
        });
        target.map_or(line.end, |(target, _)| line.start + target)
    }

    /// Position of a byte offset.
    pub fn position(&self, offset: usize) -> Position {
        let offset = self.text.floor_char_boundary(offset);
        let lines = self.lines().enumerate().take_while(|(_, line)| line.start <= offset);
        let (number, line) = lines.last().unwrap_or_default();
        let before = &self.text[line.start..offset.min(line.end)];
        let units: usize = before.chars().map(|character| self.encoding.length(character)).sum();
        Position { line: number as u32, character: units as u32 }
    }

    /// Positions of a range of bytes.
    pub fn range(&self, bytes: Range<usize>) -> lsp_types::Range {
        lsp_types::Range { start: self.position(bytes.start), end: self.position(bytes.end) }
    }

    /// The bytes of each line without its line break, which is LF, CR LF or CR.
    pub fn lines(&self) -> impl Iterator<Item = Range<usize>> {
        let mut next = Some(0);
        std::iter::from_fn(move || {
            let start = next?;
            let end = self.text[start..].find(['\n', '\r']).map(|length| start + length);
            next = end.map(|end| end + if self.text[end..].starts_with("\r\n") { 2 } else { 1 });
            Some(start..end.unwrap_or(self.text.len()))
        })
    }

    /// The bytes of the line that contains `offset`.
    pub fn line(&self, offset: usize) -> Range<usize> {
        self.lines().take_while(|line| line.start <= offset).last().unwrap_or_default()
    }

    /// The word at `offset` and the offset of its start. A word is the text between two quotation marks or blanks.
    pub fn word(&self, offset: usize) -> Option<(&str, usize)> {
        let line = self.line(offset);
        let text = &self.text[line.clone()];
        let position = offset.clamp(line.start, line.end) - line.start;
        let quotes: Vec<usize> = text.match_indices(['"', '\'']).map(|(quote, _)| quote).collect();
        let quoted = quotes.chunks(2).find(|pair| pair[0] < position && pair.get(1).is_none_or(|end| position <= *end));
        let (start, end) = match quoted {
            Some(pair) => (pair[0] + 1, pair.get(1).copied().unwrap_or(text.len())),
            None => {
                let start = text[..position].rfind(char::is_whitespace).map_or(0, |blank| blank + 1);
                (start, text[position..].find(char::is_whitespace).map_or(text.len(), |length| position + length))
            }
        };
        let word = text.get(start..end)?;
        (!word.is_empty()).then_some((word, line.start + start))
    }
}

/// Path of a `file:` URI; `None` for other URIs.
fn name_of(uri: &Uri) -> Option<String> {
    let is_file = uri.scheme().is_some_and(|scheme| scheme.as_str().eq_ignore_ascii_case("file"));
    let path = uri.path().as_estr().decode().into_string().ok()?;
    (is_file && path.starts_with('/')).then(|| path.into_owned())
}

/// `file:` URI of the path `name`, which is absolute or relative to the working folder.
pub fn uri_of(name: &str) -> Option<Uri> {
    let path = std::path::absolute(name).ok()?;
    let mut text = String::from("file://");
    for byte in path.to_str()?.bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'/' | b'-' | b'.' | b'_' | b'~' => text.push(byte as char),
            _ => text.push_str(&format!("%{byte:02X}")),
        }
    }
    Uri::from_str(&text).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn document(text: &str, encoding: Encoding) -> Document {
        Document { name: "/a/b.sim".to_owned(), text: text.to_owned(), encoding }
    }

    #[test]
    fn positions_and_offsets_are_inverse_in_both_encodings() {
        let text = "wörld 𝒜.wld\r\n\rrobi \u{feff}x\nend";
        for encoding in [Encoding::Utf8, Encoding::Utf16] {
            let document = document(text, encoding);
            let is_in_line =
                |(offset, _): &(usize, char)| document.lines().any(|line| (line.start..=line.end).contains(offset));
            for (offset, _) in text.char_indices().filter(is_in_line) {
                assert_eq!(document.offset(document.position(offset)), offset, "{encoding:?}");
            }
        }
        let position = |encoding| document(text, encoding).position(text.find(".wld").expect("a world"));
        assert_eq!(position(Encoding::Utf8), Position { line: 0, character: 11 });
        assert_eq!(position(Encoding::Utf16), Position { line: 0, character: 8 });
        let document = document(text, Encoding::Utf16);
        assert_eq!(document.offset(Position { line: 0, character: 999 }), text.find('\r').expect("an end"));
        assert_eq!(document.offset(Position { line: 99, character: 0 }), text.len());
        assert_eq!(document.position(text.len()), Position { line: 3, character: 3 });
    }

    #[test]
    fn words_end_at_blanks_and_quotation_marks() {
        let text = "robi \"my robi.robi\" wall.c 500\nworld = 'a b.wld'";
        let document = document(text, Encoding::Utf8);
        let word =
            |text_before: &str| document.word(text.find(text_before).expect("the place") + 1).map(|(word, _)| word);
        assert_eq!(
            [word("robi.robi"), word("wall"), word("b.wld")],
            [Some("my robi.robi"), Some("wall.c"), Some("a b.wld")]
        );
        assert_eq!(word("obi"), Some("robi"));
    }

    #[test]
    fn uris_and_paths_are_inverse() {
        for name in ["/a b/ü%/c.sim", "/x/y.scene.toml"] {
            let uri = uri_of(name).expect("a URI");
            assert_eq!(name_of(&uri).as_deref(), Some(name), "{}", uri.as_str());
        }
        assert_eq!(name_of(&Uri::from_str("untitled:1").expect("a URI")), None);
    }
}
