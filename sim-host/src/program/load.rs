//! Loads private copies of a library: each robot has the program's globals for itself.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ffi::{CString, OsStr, c_char, c_int, c_void};
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::marker::PhantomData;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::ptr::NonNull;
use std::sync::Arc;

use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
use robios_sys::{
    ABI_VERSION, CallSite, Host, PROGRAM_SYMBOL, Program, Robios6, Robios6Call, Robios6Table, Robios7, Robios7Call,
    Robios7Table, Support, SupportTable, flag,
};

use super::float;
use super::image::{ProgramImage, SourceLine};
use super::prepare::Prepared;
use super::share::share_pages;

/// So many copies of a run are whole files with their debug information, for debuggers and profilers; further ones hold
/// only what is mapped.
const WHOLE_COPIES: usize = 8;

/// A library that cannot be loaded as a robot program.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// A library without the entry symbol.
    #[error("`{}` was not built for eyesim: it does not export `{PROGRAM_SYMBOL}`{}", path.display(), robios_hint(robios))]
    NotAProgram {
        /// The library.
        path: PathBuf,
        /// RoBIOS functions that it expects to find in the simulator.
        robios: Vec<String>,
    },
    /// Built against another version of the interface.
    #[error(
        "`{}` was built for version {program} of the program interface, and this eyesim has version {ABI_VERSION}: build \
         it again",
        path.display()
    )]
    Abi {
        /// The library.
        path: PathBuf,
        /// The library's version.
        program: u32,
    },
    /// The version fits and the rest does not.
    #[error("`{}` cannot be run by this eyesim: {what}", path.display())]
    Misfit {
        /// The library.
        path: PathBuf,
        /// What does not fit.
        what: String,
    },
    /// A function that is used and neither in the library nor in those it names.
    #[error("`{}` needs `{symbol}`, which neither it nor any library that it names defines", path.display())]
    Undefined {
        /// The library.
        path: PathBuf,
        /// The missing function or variable.
        symbol: String,
    },
    /// The dynamic linker refuses the library.
    #[error("cannot load `{}`: {what}", path.display())]
    Refused {
        /// The library.
        path: PathBuf,
        /// What the dynamic linker says.
        what: String,
    },
    /// An argument that no C string can hold.
    #[error("an argument of `{}` has a NUL character: {argument}", path.display())]
    Argument {
        /// The library.
        path: PathBuf,
        /// What is wrong with it.
        argument: String,
    },
    /// A copy cannot be written.
    #[error("cannot copy `{}` to the run folder `{}`: {error}; $TMPDIR chooses another place", path.display(), folder.display())]
    Copy {
        /// The library.
        path: PathBuf,
        /// The folder of the copies.
        folder: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// Its process ended or broke before the program could begin.
    #[error("cannot load `{}` in a process of its own: {what}", path.display())]
    Process {
        /// The library.
        path: PathBuf,
        /// What happened.
        what: String,
    },
    /// More private copies than the kernel lets one process map.
    #[error(
        "{robots} robots need about {needed} memory mappings for private copies of their programs and for their stacks, and \
         the kernel allows {allowed} a process: run fewer robots, or raise the limit with `sudo sysctl \
         vm.max_map_count={advised}`"
    )]
    TooManyMappings {
        /// Robots in the run.
        robots: usize,
        /// Mappings needed, those that are there included.
        needed: usize,
        /// `vm.max_map_count`.
        allowed: usize,
        /// A limit that is enough.
        advised: usize,
    },
}

fn robios_hint(robios: &[String]) -> String {
    let build = "build it from its source with `eyesim cc`, or name the source itself";
    match robios {
        [] => format!("; {build}"),
        names => {
            let shown: Vec<String> = names.iter().take(5).map(|name| format!("`{name}`")).collect();
            let more = if names.len() > 5 { format!(" and {} more", names.len() - 5) } else { String::new() };
            format!(", and expects {}{more} in the simulator as classic programs do; {build}", shown.join(", "))
        }
    }
}

/// A robot's own copy of a program with its arguments, ready to run. Its library is unmapped with the last clone of it, as far as
/// that can be: see [`ProgramImage::leaves_nothing`].
#[derive(Clone)]
pub struct LoadedProgram {
    prepared: Arc<Prepared>,
    image: Arc<ProgramImage>,
    arguments: Vec<CString>,
    library: Arc<Opened>,
}

impl std::fmt::Debug for LoadedProgram {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LoadedProgram").field("name", &self.prepared.name).field("base", &self.library.base).finish()
    }
}

/// The tables of a host type.
struct Tables<H>(PhantomData<H>);

impl<H: Support + Robios6 + Robios7> Tables<H> {
    const SUPPORT: &'static SupportTable = &SupportTable::of::<H>();
    const ROBIOS6: &'static Host = &Host::of_robios6(Self::SUPPORT, &Robios6Table::of::<H>());
    const ROBIOS7: &'static Host = &Host::of_robios7(Self::SUPPORT, &Robios7Table::of::<H>());

    /// The tables for a program of this generation.
    fn of(generation: u32) -> &'static Host {
        if generation == 7 { Self::ROBIOS7 } else { Self::ROBIOS6 }
    }
}

impl LoadedProgram {
    /// The program's name, its `argv[0]`.
    pub fn name(&self) -> &str {
        &self.prepared.name
    }

    /// What this is a copy of.
    pub fn prepared(&self) -> &Prepared {
        &self.prepared
    }

    /// Whether the program's exit code says anything: not where `main` returns no value.
    pub fn has_exit_code(&self) -> bool {
        self.library.description().flags & flag::VOID_MAIN == 0
    }

    /// Runs the program's `main` on this thread, its calls answered by `host`; gives its exit code.
    ///
    /// The program is native code of the user's and can do whatever this process can; faults are the executive's. One run
    /// at a time, as the copy has its globals once.
    pub fn run<H: Support + Robios6 + Robios7>(&self, host: &H) -> i32 {
        let mut argv: Vec<*const c_char> = self.arguments.iter().map(|argument| argument.as_ptr()).collect();
        argv.push(std::ptr::null());
        let argc = self.arguments.len() as c_int;
        let robot = std::ptr::from_ref(host).cast_mut().cast::<c_void>();
        let description = self.library.description();
        // SAFETY: the tables are those of `H`, so that `robot` leads to what their entries expect
        // (`CallContext::from_context`), shared and alive until `run` returns; argv has argc strings that end in 0, then
        // a null pointer, alive as long; the description was checked when it was loaded, and the library stays as long as `self`.
        let code = unsafe { (description.run)(Tables::<H>::of(description.generation), robot, argc, argv.as_ptr()) };
        // `main` has ended: what follows on this thread is the host's.
        float::hold_default();
        code
    }

    /// The addresses at which the copy's code and variables lie.
    pub fn addresses(&self) -> Range<usize> {
        let span = self.image.span();
        self.library.base + span.start..self.library.base + span.end
    }

    /// The line of the source at `address`, if it lies in this copy and the debug information tells it. See
    /// [`ProgramImage::source_line`].
    pub fn source_line(&self, address: usize) -> Option<SourceLine> {
        self.image.source_line(self.offset(address)?)
    }

    /// The line in the program's own sources that a call stack leads to: `addresses` are the program counter, then return
    /// addresses, innermost first; those outside of this copy are passed over. See [`ProgramImage::own_source_line`].
    pub fn own_source_line(&self, addresses: &[usize]) -> Option<SourceLine> {
        // An address outside of the copy becomes an offset outside of its code.
        let offsets = addresses.iter().map(|&address| self.offset(address).unwrap_or(usize::MAX));
        self.image.own_source_line(offsets)
    }

    /// Where the program called the function that it is in, if its shim tells. To be asked only while the program is in a call.
    pub fn call_site(&self) -> CallSite {
        let site = self.library.description().call_site;
        if site.is_null() || !site.is_aligned() {
            return CallSite::NONE;
        }
        // SAFETY: the description's contract: `call_site` leads to a variable of this copy, which is mapped as long as
        // `self` and which only the program writes, that is in a call now.
        unsafe { site.read() }
    }

    /// A place in this program in the user's words: `maze.c:88`.
    pub fn place_of(&self, site: &CallSite) -> Option<String> {
        let CallSite { address, file, file_len, line } = *site;
        if file.is_null() {
            // A return address lies behind the call.
            let offset = self.offset(address.addr().checked_sub(1)?)?;
            return self.image.call_line(offset).map(|line| line.to_string());
        }
        // SAFETY: the contract of a program's call site: a name of that many bytes in the program's constants, which are mapped as
        // long as `self`; a site is asked about at its own program only.
        let file = unsafe { std::slice::from_raw_parts(file, file_len) };
        Some(format!("{}:{line}", String::from_utf8_lossy(file)))
    }

    fn offset(&self, address: usize) -> Option<usize> {
        self.addresses().contains(&address).then(|| address - self.library.base)
    }
}

/// Loads the programs of one run. Its folder holds each copy only while that is being loaded.
#[derive(Debug)]
pub struct Loader {
    folder: tempfile::TempDir,
    copies: usize,
    /// For each program (by its address, which the program kept beside it holds) the file of its first copy, whose pages of
    /// code and constants the others share.
    first_copies: BTreeMap<usize, (Arc<Prepared>, File)>,
    /// As `first_copies`, the file that processes of their own load.
    libraries: BTreeMap<usize, (Arc<Prepared>, PathBuf)>,
}

impl Loader {
    /// A loader with a run folder of its own under the temporary folder, removed when it is dropped.
    ///
    /// # Errors
    /// If the folder cannot be made.
    pub fn new() -> io::Result<Self> {
        let folder = tempfile::Builder::new().prefix("eyesim-run-").tempdir()?;
        Ok(Self { folder, copies: 0, first_copies: BTreeMap::new(), libraries: BTreeMap::new() })
    }

    /// Maps a private copy of `prepared` for one robot, which runs it with `arguments` behind the program's name.
    ///
    /// The library's constructors run on this thread. The copy is unmapped with the last clone of what this returns, unless something
    /// that it may leave behind (exit handlers, threads) would still lead into it.
    ///
    /// # Errors
    /// [`LoadError`] if it is no program for this eyesim or the dynamic linker refuses it.
    pub fn load(&mut self, prepared: &Arc<Prepared>, arguments: &[String]) -> Result<LoadedProgram, LoadError> {
        let image = library_of(prepared)?;
        check_description(image)?;
        let arguments = c_arguments(&prepared.name, arguments)
            .map_err(|argument| LoadError::Argument { path: image.path().to_owned(), argument })?;
        let (opened, copy) = self.map_copy(image)?;
        self.share(prepared, image, opened.base, copy);
        let library = Arc::new(if image.leaves_nothing() { opened } else { opened.kept() });
        Ok(LoadedProgram { prepared: Arc::clone(prepared), image: Arc::clone(image), arguments, library })
    }

    /// The file from which processes of their own load `prepared`: one copy for all of them, whose pages they share. It is there as
    /// long as the loader. The arguments are those of the program, to be checked.
    ///
    /// # Errors
    /// [`LoadError`] if it is no program for this eyesim, as far as that can be seen without loading it.
    pub fn library(&mut self, prepared: &Arc<Prepared>, arguments: &[String]) -> Result<PathBuf, LoadError> {
        let image = library_of(prepared)?;
        check_description(image)?;
        c_arguments(&prepared.name, arguments)
            .map_err(|argument| LoadError::Argument { path: image.path().to_owned(), argument })?;
        let key = Arc::as_ptr(prepared).addr();
        if let Some((_, path)) = self.libraries.get(&key) {
            return Ok(path.clone());
        }
        let stem = image.path().file_stem().unwrap_or(OsStr::new("program"));
        let path = self.folder.path().join(format!("{}.{}.so", stem.display(), self.libraries.len()));
        fs::write(&path, image.bytes()).map_err(|error| {
            let folder = self.folder.path().to_owned();
            LoadError::Copy { path: image.path().to_owned(), folder, error }
        })?;
        self.libraries.insert(key, (Arc::clone(prepared), path.clone()));
        Ok(path)
    }

    /// Writes a copy of `image` and maps it: the library, and the file, which has no name any more.
    fn map_copy(&mut self, image: &ProgramImage) -> Result<(Opened, File), LoadError> {
        self.copies += 1;
        let stem = image.path().file_stem().unwrap_or(OsStr::new("program"));
        let path = self.folder.path().join(format!("{}-{}.so", stem.display(), self.copies));
        let write = || {
            let mut file = File::options().read(true).write(true).create_new(true).open(&path)?;
            match self.copies {
                ..=WHOLE_COPIES => file.write_all(image.bytes())?,
                _ => file.write_all(&image.loaded_part())?,
            }
            Ok(file)
        };
        let copy = write().map_err(|error| {
            let folder = self.folder.path().to_owned();
            LoadError::Copy { path: image.path().to_owned(), folder, error }
        })?;
        let opened = open(&path);
        let _ = fs::remove_file(&path);
        Ok((opened.map_err(|error| error.of(image.path(), &path))?, copy))
    }

    /// Lets the copy at `base`, loaded from the file `copy`, use the code and constants of the program's first copy.
    fn share(&mut self, prepared: &Arc<Prepared>, image: &ProgramImage, base: usize, copy: File) {
        match self.first_copies.entry(Arc::as_ptr(prepared).addr()) {
            Entry::Vacant(first) => {
                first.insert((Arc::clone(prepared), copy));
            }
            Entry::Occupied(first) => {
                let segments = image.read_only_segments();
                // SAFETY: both files were written from this image, and differ at most in where the header says that the
                // table of sections is, which the dynamic linker does not read; they have no name any more and no other
                // owner. The segments are those of the image, which is loaded at `base` as long as the caller has it.
                unsafe { share_pages(base, segments, &first.get().1, &copy) };
            }
        }
    }
}

/// A library that is mapped as long as this lives.
pub struct Opened {
    /// Where it lies.
    pub base: usize,
    /// Checked; in the library's constants.
    description: NonNull<Program>,
    /// Is unmapped when it is dropped; none of a library that stays for ever.
    library: Option<Library>,
}

// SAFETY: the description is a constant, and the handle of the dynamic linker may be used on all threads.
unsafe impl Send for Opened {}
// SAFETY: as above.
unsafe impl Sync for Opened {}

impl Opened {
    /// Its description.
    pub fn description(&self) -> &Program {
        // SAFETY: checked by `open`, and mapped as long as `self`.
        unsafe { self.description.as_ref() }
    }

    /// The same, mapped until the process ends.
    #[must_use]
    pub fn kept(mut self) -> Self {
        std::mem::forget(self.library.take());
        self
    }
}

/// Why a library cannot be opened.
#[derive(Debug)]
pub enum OpenError {
    /// The dynamic linker's words.
    Linker(String),
    /// What does not fit.
    Misfit(String),
}

impl OpenError {
    /// The error for the library at `path`, which was opened as its copy `copy`.
    pub fn of(self, path: &Path, copy: &Path) -> LoadError {
        match self {
            Self::Linker(what) => refused(path, copy, &what),
            Self::Misfit(what) => LoadError::Misfit { path: path.to_owned(), what },
        }
    }
}

/// Maps the library at `path`, in which a description of this version was seen ([`Loader::library`] looks for one); its
/// constructors run on this thread, and its destructors on the one that drops it.
///
/// # Errors
/// Why it is not one that can be run.
pub fn open(path: &Path) -> Result<Opened, OpenError> {
    let linker = |error: &libloading::Error| {
        let source = std::error::Error::source(error).map(ToString::to_string);
        OpenError::Linker(source.unwrap_or_else(|| error.to_string()))
    };
    let misfit = |what: &str| OpenError::Misfit(what.to_owned());
    // SAFETY: loading runs the constructors of a library that the user asked to run; that is what a robot program
    // is. The flags are those of dlopen.
    let library = unsafe { Library::open(Some(path), RTLD_NOW | RTLD_LOCAL) }.map_err(|error| linker(&error))?;
    // Constructors have run on this thread: those of `-ffast-math` change its floats, which are the host's.
    float::hold_default();
    // SAFETY: the symbol is only used as an address here.
    let symbol = unsafe { library.get::<*const Program>(PROGRAM_SYMBOL) }.map_err(|error| linker(&error))?;
    let description =
        NonNull::new(symbol.as_raw_ptr().cast::<Program>()).filter(|description| description.is_aligned());
    let description = description.ok_or_else(|| misfit("its description is not where it should be"))?;
    // SAFETY: not null, aligned, and `check_description` has seen in the file that a description of this version and
    // at least this size is there; it is a constant in an image that is mapped as long as `library`.
    unsafe { description.as_ref() }.check().map_err(|why| misfit(&why.to_string()))?;
    let base = base_of(description.as_ptr().addr()).ok_or_else(|| misfit("its address is unknown"))?;
    Ok(Opened { base, description, library: Some(library) })
}

/// The library of a program that is one.
fn library_of(prepared: &Prepared) -> Result<&Arc<ProgramImage>, LoadError> {
    let path = || prepared.source.path().to_owned();
    let none =
        || LoadError::Misfit { path: path(), what: "it is no library and runs in a process of its own only".into() };
    prepared.image().ok_or_else(none)
}

/// Checks what can be seen in the file, before any of the library's code runs.
fn check_description(image: &ProgramImage) -> Result<(), LoadError> {
    let path = || image.path().to_owned();
    let Some(description) = image.description() else {
        return Err(LoadError::NotAProgram { path: path(), robios: robios_functions(image) });
    };
    if description.abi != ABI_VERSION {
        return Err(LoadError::Abi { path: path(), program: description.abi });
    }
    if (description.size as usize) < size_of::<Program>() {
        return Err(LoadError::Misfit { path: path(), what: "its description is too short".into() });
    }
    Ok(())
}

/// The base address of the loaded image that `address` lies in.
fn base_of(address: usize) -> Option<usize> {
    let mut info = std::mem::MaybeUninit::<libc::Dl_info>::zeroed();
    // SAFETY: dladdr takes any address, compares it with the images that are loaded, and writes only to `info`, which is
    // valid when all zero.
    let (found, info) =
        unsafe { (libc::dladdr(std::ptr::without_provenance(address), info.as_mut_ptr()), info.assume_init()) };
    (found != 0).then(|| info.dli_fbase.addr())
}

/// The RoBIOS functions that a library expects the simulator to define.
fn robios_functions(image: &ProgramImage) -> Vec<String> {
    let is_robios = |name: &&String| Robios6Call::from_name(name).is_some() || Robios7Call::from_name(name).is_some();
    image.undefined().iter().filter(is_robios).cloned().collect()
}

/// What the dynamic linker says of `copy`, told of the library that it is a copy of.
fn refused(path: &Path, copy: &Path, what: &str) -> LoadError {
    let what = what.replace(&format!("{}: ", copy.display()), "").replace(&copy.display().to_string(), "the library");
    let path = path.to_owned();
    match what.split_once("undefined symbol: ") {
        Some((_, symbol)) => {
            let symbol = symbol.split([',', ' ', '\n']).next().unwrap_or(symbol).to_owned();
            LoadError::Undefined { path, symbol }
        }
        None if what.contains("failed to map segment") || what.contains("cannot allocate memory") => {
            let hint = "is the temporary folder mounted `noexec`? $TMPDIR chooses another";
            LoadError::Refused { path, what: format!("{what} ({hint})") }
        }
        None => LoadError::Refused { path, what },
    }
}

/// Checks that the kernel lets this process map the private copies of a run: for each program its image and how many
/// robots load it; each robot needs `others` mappings more (its stacks).
///
/// # Errors
/// [`LoadError::TooManyMappings`] if they do not fit. Where the kernel does not tell its limit nothing is checked.
pub fn check_mappings<'a>(
    programs: impl IntoIterator<Item = (&'a ProgramImage, usize)>,
    others: usize,
) -> Result<(), LoadError> {
    let Some(allowed) = fs::read_to_string("/proc/sys/vm/max_map_count").ok().and_then(|text| text.trim().parse().ok())
    else {
        return Ok(());
    };
    let there = fs::read_to_string("/proc/self/maps").map_or(0, |maps| maps.lines().count());
    check_against_limit(programs, others, there, allowed)
}

fn check_against_limit<'a>(
    programs: impl IntoIterator<Item = (&'a ProgramImage, usize)>,
    others: usize,
    there: usize,
    allowed: usize,
) -> Result<(), LoadError> {
    // The heap and the record grow during the run.
    const RESERVE: usize = 1000;
    let (mut robots, mut needed) = (0, there + RESERVE);
    for (image, count) in programs {
        robots += count;
        needed += count * (image.mappings() + others);
    }
    if needed <= allowed {
        return Ok(());
    }
    let advised = needed.next_power_of_two();
    Err(LoadError::TooManyMappings { robots, needed, allowed, advised })
}

/// The arguments of a program as C strings, `argv[0]` first; the argument that holds a NUL if one does.
fn c_arguments(name: &str, arguments: &[String]) -> Result<Vec<CString>, String> {
    let words = std::iter::once(name).chain(arguments.iter().map(String::as_str));
    words.map(|word| CString::new(word).map_err(|error| error.to_string())).collect()
}
