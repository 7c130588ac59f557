//! What the file of a robot program's library says of itself: the part that is loaded, its symbols, its source lines.

use std::fs;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use object::read::elf::{ElfFile64, FileHeader as _, ProgramHeader as _};
use object::{Object as _, ObjectSymbol as _, elf};
use parking_lot::Mutex;

use super::kind::{FileKind, HEAD_BYTES, file_kind};

/// A library's file, read once for all the robots that load it.
pub struct ProgramImage {
    path: PathBuf,
    source_folder: Option<PathBuf>,
    bytes: Vec<u8>,
    /// Length of the part of the file that is mapped: up to the end of the last loaded segment.
    loaded_len: usize,
    /// Addresses of the loaded segments, relative to the base.
    span: Range<usize>,
    segments: usize,
    defined: Vec<String>,
    undefined: Vec<String>,
    /// The debug information, read when a line is first asked for; `None` inside if there is none.
    lines: OnceLock<Option<Mutex<addr2line::Loader>>>,
}

/// A place in a program's source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SourceLine {
    /// The file: relative to the program's folder where it lies there, else absolute.
    pub file: PathBuf,
    /// The line, from 1; 0 if only the file is known.
    pub line: u32,
    /// The function around it, demangled.
    pub function: Option<String>,
}

impl std::fmt::Display for SourceLine {
    /// `maze.c:88`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}", self.file.display(), self.line)
    }
}

/// A file that is not a library that can be loaded.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// The file cannot be read.
    #[error("cannot read `{}`: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// A file of another kind or system.
    #[error("`{}` is {what}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What it is.
        what: String,
    },
    /// A library that is cut short or otherwise broken.
    #[error("`{}` is a broken library: {what}", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        what: String,
    },
}

impl ProgramImage {
    /// Reads the library at `path`; `source_folder` is where its sources lie, if that is known.
    ///
    /// # Errors
    /// [`ImageError`] if it cannot be read or is no library for this system.
    pub fn read(path: &Path, source_folder: Option<&Path>) -> Result<Self, ImageError> {
        let bytes = fs::read(path).map_err(|error| ImageError::Read { path: path.to_owned(), error })?;
        if let FileKind::Foreign(what) = file_kind(&bytes[..bytes.len().min(HEAD_BYTES)]) {
            return Err(ImageError::Foreign { path: path.to_owned(), what });
        }
        let parts = parts_of(&bytes).map_err(|what| ImageError::Broken { path: path.to_owned(), what })?;
        let Parts { loaded_len, span, segments, defined, undefined } = parts;
        let source_folder = source_folder.map(|folder| fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned()));
        let path = path.to_owned();
        let lines = OnceLock::new();
        Ok(Self { path, source_folder, bytes, loaded_len, span, segments, defined, undefined, lines })
    }

    /// The library's file, with its debug information.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The whole file.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The part of the file that a run needs, without symbols for linkers and without debug information.
    ///
    /// The header names no sections then, since their table is not there.
    pub fn loaded_part(&self) -> Vec<u8> {
        let mut bytes = self.bytes[..self.loaded_len].to_vec();
        // e_shoff (8 bytes), e_shnum and e_shstrndx (2 bytes each) of a 64-bit header: ELF-64 Object File Format 1.5.
        for field in [0x28..0x30, 0x3c..0x40] {
            bytes[field].fill(0);
        }
        bytes
    }

    /// Addresses of the loaded segments, relative to the base at which a copy is loaded.
    pub fn span(&self) -> Range<usize> {
        self.span.clone()
    }

    /// Memory mappings of one copy at most: one a loaded segment, one for the part that is made read-only, one for
    /// variables that start as zero.
    pub fn mappings(&self) -> usize {
        self.segments + 2
    }

    /// Whether the library exports `symbol`.
    pub fn defines(&self, symbol: &str) -> bool {
        self.defined.iter().any(|name| name == symbol)
    }

    /// Functions and variables that the library takes from elsewhere, sorted.
    pub fn undefined(&self) -> &[String] {
        &self.undefined
    }

    /// The line of the source at `offset` from the base, if the debug information tells it.
    ///
    /// For a return address give the address less one: the call is what lies before it. Where functions are inlined, the
    /// innermost one that lies in the program's own folder is told. Allocates; safe to call after a program has
    /// faulted, as the host's heap is its own.
    pub fn source_line(&self, offset: usize) -> Option<SourceLine> {
        let lines = self.lines.get_or_init(|| addr2line::Loader::new(&self.path).ok().map(Mutex::new)).as_ref()?.lock();
        let mut frames = lines.find_frames(offset as u64).ok()?;
        let mut innermost = None;
        while let Ok(Some(frame)) = frames.next() {
            let Some(location) = frame.location else { continue };
            let (Some(file), line) = (location.file, location.line.unwrap_or(0)) else { continue };
            let function = frame.function.and_then(|name| name.demangle().ok().map(|name| name.into_owned()));
            let within = self.within_source_folder(Path::new(file));
            let is_own = within.is_some();
            let place = SourceLine { file: within.unwrap_or_else(|| file.into()), line, function };
            if is_own {
                return Some(place);
            }
            innermost.get_or_insert(place);
        }
        innermost
    }

    /// The line of the first of `offsets` (a call stack, innermost first) that lies in the program's own sources, so not
    /// in its shim or in the library of its language; if none does, of the first that is known.
    pub fn own_source_line(&self, offsets: impl IntoIterator<Item = usize>) -> Option<SourceLine> {
        let mut first = None;
        for line in offsets.into_iter().filter_map(|offset| self.source_line(offset)) {
            if self.source_folder.is_none() || line.file.is_relative() {
                return Some(line);
            }
            first.get_or_insert(line);
        }
        first
    }

    fn within_source_folder(&self, file: &Path) -> Option<PathBuf> {
        file.strip_prefix(self.source_folder.as_ref()?).ok().map(Path::to_owned)
    }
}

impl std::fmt::Debug for ProgramImage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ProgramImage").field("path", &self.path).field("loaded_len", &self.loaded_len).finish()
    }
}

struct Parts {
    loaded_len: usize,
    span: Range<usize>,
    segments: usize,
    defined: Vec<String>,
    undefined: Vec<String>,
}

fn parts_of(bytes: &[u8]) -> Result<Parts, String> {
    let text = |error: object::Error| error.to_string().to_lowercase();
    let file = ElfFile64::<object::Endianness>::parse(bytes).map_err(text)?;
    let endian = file.endian();
    let headers = file.elf_header().program_headers(endian, bytes).map_err(text)?;
    let mut loaded_len = 0;
    let mut span: Option<Range<u64>> = None;
    let mut segments = 0;
    for header in headers {
        match header.p_type(endian) {
            elf::PT_LOAD => {}
            elf::PT_INTERP => return Err("it is an executable, not a library".into()),
            _ => continue,
        }
        segments += 1;
        let file_end = header.p_offset(endian).saturating_add(header.p_filesz(endian));
        loaded_len = loaded_len.max(usize::try_from(file_end).unwrap_or(usize::MAX));
        let range = header.p_vaddr(endian)..header.p_vaddr(endian).saturating_add(header.p_memsz(endian));
        span = Some(match span {
            None => range,
            Some(span) => span.start.min(range.start)..span.end.max(range.end),
        });
    }
    let Some(span) = span else { return Err("it has nothing to load".into()) };
    if loaded_len > bytes.len() {
        return Err(format!("it is cut short: {} bytes of {loaded_len}", bytes.len()));
    }
    let (mut defined, mut undefined) = (Vec::new(), Vec::new());
    for symbol in file.dynamic_symbols() {
        let Ok(name) = symbol.name() else { continue };
        let names = if symbol.is_undefined() { &mut undefined } else { &mut defined };
        if !name.is_empty() {
            names.push(name.to_owned());
        }
    }
    undefined.sort();
    undefined.dedup();
    let address = |value: u64| usize::try_from(value).map_err(|error| format!("its addresses are too large ({error})"));
    Ok(Parts { loaded_len, span: address(span.start)?..address(span.end)?, segments, defined, undefined })
}
