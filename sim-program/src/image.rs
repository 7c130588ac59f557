//! Reads the file of a program's library: loaded segments, symbols, source lines.

use std::fs;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use object::read::elf::{ElfFile64, ElfSection64, FileHeader as _, ProgramHeader as _};
use object::{
    Object as _, ObjectSection as _, ObjectSegment as _, ObjectSymbol as _, RelocationFlags, SectionFlags, SymbolFlags,
    elf,
};
use parking_lot::Mutex;
use robios_sys::{PROGRAM_SYMBOL, language};

use super::constructors;
use super::kind::{FileKind, HEAD_BYTES, file_kind};
use super::share::page_size;
use crate::files::read_regular;

/// A library's file, read once for all robots that load it.
pub struct ProgramImage {
    path: PathBuf,
    source_folder: Option<PathBuf>,
    bytes: Vec<u8>,
    parts: ImageParts,
    /// Debug information, read when a line is first requested; the inner `None` if the file has none.
    lines: OnceLock<Option<Mutex<addr2line::Loader>>>,
}

/// A loaded, read-only segment of a library.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ReadOnlySegment {
    /// Address relative to the base.
    pub address: usize,
    /// Range in the file, in bytes.
    pub file: Range<usize>,
    /// The segment contains code.
    pub is_code: bool,
}

/// First fields of the symbol [`PROGRAM_SYMBOL`] that a library exports: numbers that can be read from the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Description {
    /// Size of the description in bytes.
    pub size: u32,
    /// ABI version against which the program was built.
    pub abi: u32,
    /// RoBIOS generation.
    pub generation: u32,
    /// Bits of [`robios_sys::flag`].
    pub flags: u32,
    /// One of [`robios_sys::language`].
    pub language: u32,
}

/// A line in a program's source.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SourceLine {
    /// The file: relative to the program's folder if it is inside, otherwise absolute.
    pub file: PathBuf,
    /// The line, from 1; 0 if only the file is known.
    pub line: u32,
    /// The function that contains the line, demangled.
    pub function: Option<String>,
}

impl std::fmt::Display for SourceLine {
    /// `maze.c:88`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}", self.file.display(), self.line)
    }
}

/// Reasons why a file is not a library that can be loaded.
#[derive(Debug, thiserror::Error)]
pub enum ImageError {
    /// The file cannot be read.
    #[error("cannot read `{}`: {error}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Reason for the error.
        error: io::Error,
    },
    /// A file of another kind or system.
    #[error("`{}` is {description}", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// Description of the file.
        description: String,
    },
    /// A library that is truncated or otherwise broken.
    #[error("`{}` is a broken library: {reason}", path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// Reason why it cannot be read.
        reason: String,
    },
}

impl ProgramImage {
    /// Reads the library at `path`; `source_folder` is the folder of its sources, if known.
    ///
    /// # Errors
    /// [`ImageError`] if the file cannot be read or is not a library for this system.
    pub fn read(path: &Path, source_folder: Option<&Path>) -> Result<Self, ImageError> {
        let mut bytes = read_regular(path).map_err(|error| ImageError::Read { path: path.to_owned(), error })?;
        if let FileKind::Foreign(description) = file_kind(&bytes[..bytes.len().min(HEAD_BYTES)]) {
            return Err(ImageError::Foreign { path: path.to_owned(), description });
        }
        let parts = read_parts(&bytes).map_err(|reason| ImageError::Broken { path: path.to_owned(), reason })?;
        // Libraries from C and C++ are already built with hidden constructors.
        if parts.description.is_some_and(|description| description.language == language::RUST) {
            let broken = |error: object::Error| ImageError::Broken { path: path.to_owned(), reason: error.to_string() };
            constructors::hide(&mut bytes).map_err(broken)?;
        }
        let source_folder = source_folder.map(|folder| {
            // A source that is named without a folder is in the working folder.
            let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
            fs::canonicalize(folder).unwrap_or_else(|_| folder.to_owned())
        });
        Ok(Self { path: path.to_owned(), source_folder, bytes, parts, lines: OnceLock::new() })
    }

    /// The library's file, with its debug information.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// All bytes of the file, with the constructors of a Rust program hidden from the dynamic linker.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// The part of the file that a run needs, without the linker's symbols and debug information.
    ///
    /// The header of this copy has no section table, since the table is cut off.
    pub fn loaded_part(&self) -> Vec<u8> {
        let mut bytes = self.bytes[..self.parts.loaded_len].to_vec();
        // e_shoff (8 bytes), e_shnum and e_shstrndx (2 bytes each) of a 64-bit header: ELF-64 Object File Format 1.5.
        for field in [0x28..0x30, 0x3c..0x40] {
            bytes[field].fill(0);
        }
        bytes
    }

    /// Addresses of the loaded segments, relative to the base at which a copy is loaded.
    pub fn span(&self) -> Range<usize> {
        self.parts.span.clone()
    }

    /// Number of memory mappings of one copy: one for each loaded segment, and the mappings that the dynamic linker
    /// splits off (variables that start as zero, the part that is read-only after loading, gaps between segments).
    pub fn mappings(&self) -> usize {
        self.parts.mappings
    }

    /// The segments that are identical in every copy: read-only, not changed by relocations, and sharing no page with
    /// other segments.
    pub fn read_only_segments(&self) -> &[ReadOnlySegment] {
        &self.parts.read_only
    }

    /// The library's description; `None` if it is not a robot program.
    pub fn description(&self) -> Option<Description> {
        self.parts.description
    }

    /// Functions and variables that the library imports, sorted.
    pub fn undefined(&self) -> &[String] {
        &self.parts.undefined
    }

    /// Returns true if code of the library runs while the dynamic linker loads it, because it has IFUNC symbols.
    pub fn has_resolvers(&self) -> bool {
        self.parts.has_resolvers
    }

    /// Returns true if a copy can be unmapped once its program has returned: the program imports no function that
    /// starts a thread or registers a function or memory with the C library, and it has no destructors other than those
    /// of the compiler's start files and of the shim. The dynamic linker itself keeps a copy as long as destructors of
    /// thread-locals are pending.
    pub fn can_unmap(&self) -> bool {
        self.parts.can_unmap
    }

    /// Address ranges of the variables, relative to the base, if robots on one worker can share a copy. This requires
    /// that their flows can share a thread, that the copy can be unmapped, and that the variables are few enough to be
    /// copied at each change of the robot.
    pub fn shared_variables(&self) -> Option<&[Range<usize>]> {
        let len: usize = self.parts.variables.iter().map(Range::len).sum();
        (self.why_thread_bound().is_none() && self.can_unmap() && (1..=MAX_SHARED_VARIABLES).contains(&len))
            .then_some(&self.parts.variables)
    }

    /// Reason why several flows of this program cannot share a thread, as a text without its subject: ``calls `gettid`,
    /// ...``. `None` if they can: no flow has state that is stored per thread, apart from `errno` and the
    /// floating-point environment, which are saved when flows are switched. This holds for a program in C that has no
    /// thread-local variables, uses no libraries except the C library, and calls no function that acts on its thread.
    pub fn why_thread_bound(&self) -> Option<&str> {
        self.parts.thread_bound.as_deref()
    }

    /// The line of the source at `offset` from the base, if the debug information contains it.
    ///
    /// For a return address pass the address minus one, which lies in the call instruction. Among inlined functions the
    /// result is the innermost one in the program's own folder. Allocates; safe to call after a crash of a program,
    /// since the host does not use the C library's heap.
    pub fn source_line(&self, offset: usize) -> Option<SourceLine> {
        if !self.parts.span.contains(&offset) {
            return None;
        }
        let lines = self.lines.get_or_init(|| addr2line::Loader::new(&self.path).ok().map(Mutex::new)).as_ref()?.lock();
        let mut frames = lines.find_frames(offset as u64).ok()?;
        let mut innermost = None;
        while let Ok(Some(frame)) = frames.next() {
            let Some(location) = frame.location else { continue };
            let (Some(file), line) = (location.file, location.line.unwrap_or(0)) else { continue };
            let function = frame.function.and_then(|name| name.demangle().ok().map(|name| name.into_owned()));
            let relative = self.within_source_folder(Path::new(file));
            let is_in_source_folder = relative.is_some();
            let place = SourceLine { file: relative.unwrap_or_else(|| file.into()), line, function };
            if is_in_source_folder {
                return Some(place);
            }
            innermost.get_or_insert(place);
        }
        innermost
    }

    /// The line of a call, given its return address minus one. `None` if the line is unknown, or if this address lies
    /// in the shim: then the program's `main` or task made the call as a tail call, which returns to the shim.
    pub fn call_line(&self, offset: usize) -> Option<SourceLine> {
        self.source_line(offset).filter(|line| !is_of_shim(&line.file))
    }

    /// The line of the innermost address in a call stack that lies in the program's own sources, not in its shim or in
    /// the library of its language. If there is none, returns the innermost known line outside of the shim.
    ///
    /// `offsets` are a program counter, then return addresses, from the innermost to the outermost. Other numbers among
    /// them are ignored unless they point into code.
    pub fn own_source_line(&self, offsets: impl IntoIterator<Item = usize>) -> Option<SourceLine> {
        let mut innermost = None;
        for (depth, offset) in offsets.into_iter().enumerate() {
            // A return address is after its call, which may be the last instruction of its line.
            let Some(line) = self.source_line(offset.saturating_sub(usize::from(depth > 0))) else { continue };
            if self.source_folder.is_none() || line.file.is_relative() {
                return Some(line);
            }
            innermost = innermost.or(Some(line).filter(|line| !is_of_shim(&line.file)));
        }
        innermost
    }

    /// The text of the program's source that contains `line`; `None` if it cannot be read.
    pub fn source_of(&self, line: &SourceLine) -> Option<String> {
        let file = self.source_folder.as_ref().filter(|_| line.file.is_relative())?.join(&line.file);
        Some(String::from_utf8_lossy(&read_regular(&file).ok()?).into_owned())
    }

    fn within_source_folder(&self, file: &Path) -> Option<PathBuf> {
        file.strip_prefix(self.source_folder.as_ref()?).ok().map(Path::to_owned)
    }
}

/// Returns true for a file of the shim that is compiled with each program.
fn is_of_shim(file: &Path) -> bool {
    file.is_absolute() && file.parent().is_some_and(|folder| folder.ends_with("shim"))
}

impl std::fmt::Debug for ProgramImage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ProgramImage").field("path", &self.path).field("loaded_len", &self.parts.loaded_len).finish()
    }
}

/// Functions of the C library that keep a function or memory of their caller, or start threads. The shim of C programs
/// interposes most of them, so that they are not imported.
const RETAINING_FUNCTIONS: &[&str] = &[
    "GOMP_parallel",
    "__cxa_at_quick_exit",
    "__cxa_atexit",
    "__kmpc_fork_call",
    "__register_atfork",
    "__sysv_signal",
    "at_quick_exit",
    "atexit",
    "clone",
    "dlmopen",
    "dlopen",
    "dlsym",
    "dlvsym",
    "initstate",
    "mq_notify",
    "on_exit",
    "pthread_atfork",
    "pthread_create",
    "pthread_key_create",
    "putenv",
    "setstate",
    "sigaction",
    "signal",
    "sigset",
    "thrd_create",
    "timer_create",
    "tss_create",
];

/// Maximum size of a program's variables, in bytes, up to which robots share a copy of it.
const MAX_SHARED_VARIABLES: usize = 16 << 10;

/// Prefixes of the names of the C library's files.
const C_LIBRARY_FILES: &[&str] = &["libc.so.", "libm.so.", "ld-linux"];

/// Functions of the C library that change or return a property of the calling thread, in addition to
/// [`RETAINING_FUNCTIONS`].
const THREAD_BOUND_FUNCTIONS: &[&str] = &[
    "__tls_get_addr",
    "arch_prctl",
    "dlerror",
    "flockfile",
    "funlockfile",
    "getcontext",
    "gettid",
    "inet_ntoa",
    "makecontext",
    "personality",
    "prctl",
    "pthread_exit",
    "pthread_kill",
    "pthread_self",
    "pthread_sigmask",
    "ptrace",
    "sched_setaffinity",
    "sched_setscheduler",
    "setcontext",
    "setns",
    "sigaltstack",
    "sigblock",
    "sighold",
    "sigignore",
    "sigpause",
    "sigprocmask",
    "sigsetmask",
    "sigstack",
    "sigsuspend",
    "sigtimedwait",
    "sigwait",
    "sigwaitinfo",
    "strerror",
    "strsignal",
    "swapcontext",
    "unshare",
    "uselocale",
    "vfork",
];

/// Number of destructors in the compiler's start files and in the shim, which closes the console.
const STANDARD_DESTRUCTORS: usize = 2;

/// Data from the headers and tables of a library.
struct ImageParts {
    /// Length of the mapped part of the file: up to the end of the last loaded segment.
    loaded_len: usize,
    /// Addresses of the loaded segments, relative to the base.
    span: Range<usize>,
    mappings: usize,
    read_only: Vec<ReadOnlySegment>,
    description: Option<Description>,
    undefined: Vec<String>,
    /// While the dynamic linker loads the library, it calls functions of the library that select functions (IFUNC).
    has_resolvers: bool,
    /// See [`ProgramImage::can_unmap`].
    can_unmap: bool,
    /// See [`ProgramImage::why_thread_bound`].
    thread_bound: Option<String>,
    /// Address ranges of the variables, relative to the base.
    variables: Vec<Range<usize>>,
}

/// One loaded segment.
struct Segment {
    file: Range<usize>,
    memory: Range<usize>,
    flags: u32,
}

fn read_parts(bytes: &[u8]) -> Result<ImageParts, String> {
    let message = |error: object::Error| error.to_string().to_lowercase();
    let file = ElfFile64::<object::Endianness>::parse(bytes).map_err(message)?;
    let endian = file.endian();
    let headers = file.elf_header().program_headers(endian, bytes).map_err(message)?;
    let to_usize = |value: u64| usize::try_from(value).map_err(|_ignored| "its addresses are too large".to_owned());
    let (mut segments, mut has_text_relocations, mut has_relro, mut destructors) = (Vec::new(), false, false, 0);
    let (mut has_thread_locals, mut library_name_offsets, mut string_table) = (false, Vec::new(), 0);
    for header in headers {
        match header.p_type(endian) {
            elf::PT_LOAD => {
                let range =
                    |start: u64, len: u64| Ok::<_, String>(to_usize(start)?..to_usize(start.saturating_add(len))?);
                segments.push(Segment {
                    file: range(header.p_offset(endian), header.p_filesz(endian))?,
                    memory: range(header.p_vaddr(endian), header.p_memsz(endian))?,
                    flags: header.p_flags(endian),
                });
            }
            elf::PT_INTERP => return Err("it is an executable, not a library".into()),
            elf::PT_GNU_RELRO => has_relro = true,
            elf::PT_TLS => has_thread_locals = true,
            elf::PT_DYNAMIC => {
                for entry in header.dynamic(endian, bytes).map_err(message)?.unwrap_or_default() {
                    let value = entry.d_val.get(endian);
                    match entry.d_tag.get(endian) {
                        elf::DT_FINI_ARRAYSZ => destructors = to_usize(value)? / size_of::<usize>(),
                        elf::DT_NEEDED => library_name_offsets.push(value),
                        elf::DT_STRTAB => string_table = value,
                        _ => {}
                    }
                    has_text_relocations |= match entry.d_tag.get(endian) {
                        elf::DT_TEXTREL => true,
                        elf::DT_FLAGS => value & u64::from(elf::DF_TEXTREL) != 0,
                        _ => false,
                    };
                }
            }
            _ => {}
        }
    }
    let loaded_len = segments.iter().map(|segment| segment.file.end).max().unwrap_or(0);
    let start = segments.iter().map(|segment| segment.memory.start).min().unwrap_or(0);
    let end = segments.iter().map(|segment| segment.memory.end).max().unwrap_or(0);
    if start == end {
        return Err("it has nothing to load".into());
    }
    if loaded_len > bytes.len() {
        return Err(format!("it is cut short: {} bytes of {loaded_len}", bytes.len()));
    }
    let (mut description, mut undefined) = (None, Vec::new());
    let is_resolver = |flags| matches!(flags, SymbolFlags::Elf { st_info, .. } if st_info & 0xf == elf::STT_GNU_IFUNC);
    let is_resolved = |flags| matches!(flags, RelocationFlags::Elf { r_type } if r_type == IRELATIVE);
    let has_resolvers = file.dynamic_symbols().any(|symbol| !symbol.is_undefined() && is_resolver(symbol.flags()))
        || file
            .dynamic_relocations()
            .is_some_and(|mut list| list.any(|(_, relocation)| is_resolved(relocation.flags())));
    for symbol in file.dynamic_symbols() {
        match symbol.name() {
            Ok(name) if symbol.is_undefined() && !name.is_empty() => undefined.push(name.to_owned()),
            Ok(PROGRAM_SYMBOL) => description = description_at(&file, symbol.address()),
            _ => {}
        }
    }
    undefined.sort();
    undefined.dedup();
    let libraries: Vec<String> = library_name_offsets
        .iter()
        .filter_map(|offset| string_at(&file, string_table.saturating_add(*offset)))
        .collect();
    let language = description.map(|description| description.language);
    let thread_bound = match language {
        Some(language::C) if has_thread_locals => Some("has thread-local variables".to_owned()),
        Some(language::C) => why_thread_bound(&libraries, &undefined),
        _ => Some("is not only in C".to_owned()),
    };
    Ok(ImageParts {
        loaded_len,
        span: start..end,
        mappings: mappings_of(&segments) + usize::from(has_relro),
        read_only: if has_text_relocations { Vec::new() } else { read_only_segments(&segments) },
        description,
        can_unmap: destructors <= STANDARD_DESTRUCTORS && !undefined.iter().any(|name| is_retaining(name, language)),
        undefined,
        has_resolvers,
        thread_bound,
        variables: variables_of(&file),
    })
}

/// The relocation for which the dynamic linker calls a function that returns an address.
const IRELATIVE: u32 = if cfg!(target_arch = "aarch64") { elf::R_AARCH64_IRELATIVE } else { elf::R_X86_64_IRELATIVE };

/// The smallest page size: with larger pages there are never more mappings.
const SMALL_PAGE: usize = 4096;

/// Number of mappings: one for each segment, one for each segment with zeroed memory beyond the file, one for each gap
/// between segments.
fn mappings_of(segments: &[Segment]) -> usize {
    let zeroed = |segment: &&Segment| {
        let from_file = segment.memory.start + segment.file.len();
        segment.memory.end.div_ceil(SMALL_PAGE) > from_file.div_ceil(SMALL_PAGE)
    };
    let gap = |pair: &&[Segment]| pair[1].memory.start / SMALL_PAGE > pair[0].memory.end.div_ceil(SMALL_PAGE);
    segments.len() + segments.iter().filter(zeroed).count() + segments.windows(2).filter(gap).count()
}

fn read_only_segments(segments: &[Segment]) -> Vec<ReadOnlySegment> {
    let page = page_size();
    let pages = |segment: &Segment| segment.memory.start / page..segment.memory.end.div_ceil(page);
    let is_alone = |segment: &Segment| {
        let own_pages = pages(segment);
        let mut others = segments.iter().filter(|other| other.memory != segment.memory).map(pages);
        others.all(|other| other.end <= own_pages.start || own_pages.end <= other.start)
    };
    segments
        .iter()
        .filter(|segment| segment.flags & elf::PF_W == 0 && segment.file.len() == segment.memory.len())
        .filter(|segment| is_alone(segment))
        .map(|segment| ReadOnlySegment {
            address: segment.memory.start,
            file: segment.file.clone(),
            is_code: segment.flags & elf::PF_X != 0,
        })
        .collect()
}

/// Returns true if a program in `language` that imports this function may have started a thread, or registered a
/// function or memory with the C library.
fn is_retaining(function: &str, language: Option<u32>) -> bool {
    // Rust's standard library imports these for executables only, or to look up newer functions.
    let is_unused =
        language == Some(language::RUST) && matches!(function, "sigaction" | "pthread_key_create" | "dlsym");
    RETAINING_FUNCTIONS.contains(&function) && !is_unused
}

/// See [`ProgramImage::why_thread_bound`]: the reason from the libraries on which a C program depends and the functions
/// that it imports.
fn why_thread_bound(libraries: &[String], functions: &[String]) -> Option<String> {
    if cfg!(not(target_arch = "x86_64")) {
        return Some("runs on a processor for which eyesim has no fibers".to_owned());
    }
    if let Some(library) = libraries.iter().find(|name| !C_LIBRARY_FILES.iter().any(|own| name.starts_with(own))) {
        return Some(format!("uses the library `{library}`"));
    }
    let is_bound =
        |name: &&String| [THREAD_BOUND_FUNCTIONS, RETAINING_FUNCTIONS].iter().any(|list| list.contains(&name.as_str()));
    functions
        .iter()
        .find(is_bound)
        .map(|name| format!("calls `{name}`, which concerns its thread or the whole process"))
}

/// Address ranges of the variables according to the section table: writable sections, except those that contain only
/// addresses, which are equal for all robots of a copy. Empty if there is no section table.
fn variables_of(file: &ElfFile64<'_>) -> Vec<Range<usize>> {
    /// Prefixes of the names of sections that are not written to once the library is loaded.
    const CONSTANT_SECTIONS: [&str; 6] =
        [".dynamic", ".got", ".init_array", ".fini_array", ".data.rel.ro", ".eh_frame"];
    let is_variable = |section: &ElfSection64<'_, '_>| {
        let SectionFlags::Elf { sh_flags } = section.flags() else { return false };
        let name = section.name().unwrap_or_default();
        sh_flags & u64::from(elf::SHF_WRITE) != 0
            && !CONSTANT_SECTIONS.iter().any(|constant| name.starts_with(constant))
    };
    let range = |section: ElfSection64<'_, '_>| {
        let start = usize::try_from(section.address()).ok()?;
        Some(start..start.checked_add(usize::try_from(section.size()).ok()?)?)
    };
    let mut ranges: Vec<Range<usize>> = file.sections().filter(is_variable).filter_map(range).collect();
    ranges.retain(|range| !range.is_empty());
    ranges.sort_by_key(|range| range.start);
    ranges
}

/// The string at this address of the loaded image, up to its NUL.
fn string_at(file: &ElfFile64<'_>, address: u64) -> Option<String> {
    file.segments().find_map(|segment| {
        let start = usize::try_from(address.checked_sub(segment.address())?).ok()?;
        let string = segment.data().ok()?.get(start..)?.split(|byte| *byte == 0).next()?;
        Some(String::from_utf8_lossy(string).into_owned())
    })
}

fn description_at(file: &ElfFile64<'_>, address: u64) -> Option<Description> {
    const BYTES: u64 = 20;
    let data = file.segments().find_map(|segment| segment.data_range(address, BYTES).ok().flatten())?;
    let field = |index: usize| Some(u32::from_ne_bytes(data.get(4 * index..4 * index + 4)?.try_into().ok()?));
    Some(Description { size: field(0)?, abi: field(1)?, generation: field(2)?, flags: field(3)?, language: field(4)? })
}
