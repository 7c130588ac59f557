//! Loads copies of a program's library, so that each robot has its own global variables of the program.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ffi::{CString, OsStr, c_char, c_int, c_void};
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::marker::PhantomData;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::ptr::NonNull;
use std::sync::{Arc, Once};

use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
use robios_sys::{
    ABI_VERSION, CallSite, Host, PROGRAM_SYMBOL, Program, Robios6, Robios6Call, Robios6Table, Robios7, Robios7Call,
    Robios7Table, Support, SupportTable, flag, language,
};

use super::constructors;
use super::float;
use super::image::{ProgramImage, SourceLine};
use super::prepare::Prepared;
use super::python::PythonError;
use super::run_folder::RunFolder;
use super::sandbox::scratch::Scratch;
use super::sandbox::{Grant, Role, Sandbox};
use super::share::share_pages;
use super::shared::{SharedCopy, Variables};

/// Number of copies in a run that are complete files with debug information, for debuggers and profilers; further
/// copies contain only the mapped part.
const WHOLE_COPIES: usize = 8;

/// Reasons why a library cannot be loaded as a robot program.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// A library without the entry symbol.
    #[error("`{}` was not built for eyesim: it does not export `{PROGRAM_SYMBOL}`{}", path.display(), robios_hint(robios))]
    NotAProgram {
        /// The library.
        path: PathBuf,
        /// RoBIOS functions that it imports from the simulator.
        robios: Vec<String>,
    },
    /// The library was built against another version of the interface.
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
    /// The version matches, but another property does not.
    #[error("`{}` cannot be run by this eyesim: {what}", path.display())]
    Incompatible {
        /// The library.
        path: PathBuf,
        /// Description of the mismatch.
        what: String,
    },
    /// The library uses a function or variable that neither it nor a library on which it depends defines.
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
        /// Message of the dynamic linker.
        what: String,
    },
    /// An argument contains a NUL and cannot be a C string.
    #[error("an argument of `{}` has a NUL character: {argument}", path.display())]
    Argument {
        /// The library.
        path: PathBuf,
        /// The argument.
        argument: String,
    },
    /// A copy cannot be written.
    #[error("cannot copy `{}` to the run folder `{}`: {error}; $TMPDIR chooses another place", path.display(), folder.display())]
    Copy {
        /// The library.
        path: PathBuf,
        /// The folder of the copies.
        folder: PathBuf,
        /// Reason for the error.
        error: io::Error,
    },
    /// The process ended or crashed before the program could begin.
    #[error("cannot load `{}` in a process of its own: {what}", path.display())]
    Process {
        /// The library.
        path: PathBuf,
        /// Description of the event.
        what: String,
    },
    /// The interpreter of a Python program cannot be used.
    #[error(transparent)]
    Python(#[from] PythonError),
    /// The copies need more memory mappings than the kernel allows for one process.
    #[error(
        "{robots} robots need about {needed} memory mappings for copies of their programs and for their stacks, and \
         the kernel allows {allowed} a process: run fewer robots, or raise the limit with `sudo sysctl \
         vm.max_map_count={advised}`"
    )]
    TooManyMappings {
        /// Robots in the run.
        robots: usize,
        /// Mappings needed, existing ones included.
        needed: usize,
        /// `vm.max_map_count`.
        allowed: usize,
        /// A sufficient limit.
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

/// A robot's copy of a program with its arguments, ready to run. When the last clone is dropped, the library is
/// unmapped if that is safe: see [`ProgramImage::can_unmap`].
#[derive(Clone)]
pub struct LoadedProgram {
    prepared: Arc<Prepared>,
    image: Arc<ProgramImage>,
    arguments: Vec<CString>,
    library: Arc<Opened>,
    /// The robot's variables in a copy that it shares with other robots; `None` for a private copy.
    variables: Option<Arc<Variables>>,
}

impl std::fmt::Debug for LoadedProgram {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LoadedProgram").field("name", &self.prepared.name).field("base", &self.library.base).finish()
    }
}

/// The function tables of a host type.
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

    /// The number of the program's arguments, without `argv[0]`.
    pub fn argument_count(&self) -> usize {
        self.arguments.len().saturating_sub(1)
    }

    /// The program that was copied.
    pub fn prepared(&self) -> &Prepared {
        &self.prepared
    }

    /// Returns true if the program's exit code has a meaning: false if `main` returns no value.
    pub fn has_exit_code(&self) -> bool {
        self.library.description().flags & flag::VOID_MAIN == 0
    }

    /// The robot's variables, if it shares the copy with other robots: they must be swapped in before it runs.
    pub fn variables(&self) -> Option<&Arc<Variables>> {
        self.variables.as_ref()
    }

    /// Runs the program's `main` on this thread; `host` answers its calls. Returns the exit code.
    ///
    /// The program is native code of the user and can do anything that this process can; the executor handles its
    /// crashes. Only one run at a time is allowed, since the copy has a single set of globals.
    pub fn run<H: Support + Robios6 + Robios7>(&self, host: &H) -> i32 {
        let mut argv: Vec<*const c_char> = self.arguments.iter().map(|argument| argument.as_ptr()).collect();
        argv.push(std::ptr::null());
        let argc = self.arguments.len() as c_int;
        let robot = std::ptr::from_ref(host).cast_mut().cast::<c_void>();
        let description = self.library.description();
        self.library.construct();
        // SAFETY: the tables are `H`'s, so that `robot` points to the type that their entries expect
        // (`CallContext::from_context`), shared and alive until `run` returns; argv has argc strings that end in 0,
        // then a null pointer, alive as long; the description was checked when it was loaded, and the library stays
        // mapped as long as `self`.
        let code = unsafe { (description.run)(Tables::<H>::of(description.generation), robot, argc, argv.as_ptr()) };
        // `main` has ended: the thread now runs the host.
        float::set_default();
        code
    }

    /// Address range of the copy's code and variables.
    pub fn addresses(&self) -> Range<usize> {
        let span = self.image.span();
        self.library.base + span.start..self.library.base + span.end
    }

    /// The line of the source at `address`, if it lies in this copy and the debug information contains it. See
    /// [`ProgramImage::source_line`].
    pub fn source_line(&self, address: usize) -> Option<SourceLine> {
        self.image.source_line(self.offset(address)?)
    }

    /// The line in the program's own sources to which a call stack leads. `addresses` are the program counter, then
    /// return addresses, innermost first; addresses outside of this copy are skipped. See
    /// [`ProgramImage::own_source_line`].
    pub fn own_source_line(&self, addresses: &[usize]) -> Option<SourceLine> {
        // An address outside of the copy becomes an offset outside of its image.
        let offsets = addresses.iter().map(|&address| self.offset(address).unwrap_or(usize::MAX));
        self.image.own_source_line(offsets)
    }

    /// See [`ProgramImage::source_of`].
    pub fn source_of(&self, line: &SourceLine) -> Option<String> {
        self.image.source_of(line)
    }

    /// Address of the program's console streams, see [`Program::consoles`].
    pub fn consoles(&self) -> usize {
        self.library.description().consoles()
    }

    /// Location of the call in progress, if the program's shim reports it. May be called only while the program is in a
    /// call.
    #[inline]
    pub fn call_site(&self) -> CallSite {
        let site = self.library.description().call_site;
        if site.is_null() || !site.is_aligned() {
            return CallSite::NONE;
        }
        // SAFETY: by the description's contract `call_site` points to a variable of this copy, which is mapped as long
        // as `self` and which only the program writes; the program is in a call now.
        unsafe { site.read() }
    }

    /// A location in this program as text, such as `maze.c:88`.
    pub fn location_of(&self, site: &CallSite) -> Option<String> {
        let CallSite { address, file, file_len, line } = *site;
        if file.is_null() {
            // A return address lies after the call instruction.
            let offset = self.offset(address.addr().checked_sub(1)?)?;
            return self.image.call_line(offset).map(|line| line.to_string());
        }
        // SAFETY: by the contract of a program's call site, a name of that many bytes in the program's constants, which
        // are mapped as long as `self`; a site is only passed to its own program.
        let file = unsafe { std::slice::from_raw_parts(file, file_len) };
        Some(format!("{}:{line}", String::from_utf8_lossy(file)))
    }

    fn offset(&self, address: usize) -> Option<usize> {
        self.addresses().contains(&address).then(|| address - self.library.base)
    }
}

/// Loads the programs of one run. Its folder contains the files that robots' own processes load; a copy for a robot in
/// this process is there only while it is being loaded.
#[derive(Debug)]
pub struct Loader {
    folder: RunFolder,
    copies: usize,
    /// For each program, the file of its first copy, whose pages of code and constants the other copies share. Programs
    /// are keyed by their address, which is unique while the `Arc` stored with it lives.
    first_copies: BTreeMap<usize, (Arc<Prepared>, File)>,
    /// Like `first_copies`: the file that robots' own processes load.
    libraries: BTreeMap<usize, (Arc<Prepared>, PathBuf)>,
    /// Like `first_copies`, for each worker: the copy that its robots share.
    shared_copies: BTreeMap<(usize, u32), (Arc<Prepared>, Arc<SharedCopy>)>,
    /// Number of robots that share copies so far.
    sharing_robots: usize,
    /// Number of consecutive robots that are assigned to a worker before the next worker's turn, see
    /// [`robots_per_turn`].
    robots_per_turn: usize,
    /// Restrictions of programs that run in their own processes.
    sandbox: Option<Sandbox>,
}

/// Number of consecutive robots in the list of `robots` that are assigned to each of the `workers` in turn. Robots that
/// are neighbours in the list are often neighbours in the world, and detect each other. Each worker gets four parts of
/// the list, since robots in one part may have more to do than robots in another part.
pub fn robots_per_turn(robots: usize, workers: usize) -> usize {
    (robots / (4 * workers.max(1))).max(1)
}

impl Loader {
    /// Creates a loader with its own run folder in the temporary folder, removed when the loader is dropped.
    ///
    /// # Errors
    /// The folder cannot be created.
    pub fn new() -> io::Result<Self> {
        Ok(Self {
            folder: RunFolder::new()?,
            copies: 0,
            first_copies: BTreeMap::new(),
            libraries: BTreeMap::new(),
            shared_copies: BTreeMap::new(),
            sharing_robots: 0,
            robots_per_turn: 1,
            sandbox: None,
        })
    }

    /// Restricts the programs that run in their own processes.
    pub fn set_sandbox(&mut self, sandbox: Option<Sandbox>) {
        self.sandbox = sandbox;
    }

    /// Returns true if programs in their own processes are restricted.
    pub fn is_restricting(&self) -> bool {
        self.sandbox.is_some()
    }

    /// Restricts `command`, which runs `prepared`, and makes a scratch folder its working folder, which is returned.
    /// The command may read the files and folders `readable` in addition to the program's own. `None` if programs are
    /// not restricted.
    ///
    /// # Errors
    /// The folder cannot be created, or the kernel refuses.
    pub fn restrict(
        &self,
        command: &mut Command,
        prepared: &Prepared,
        mut readable: Vec<PathBuf>,
    ) -> io::Result<Option<Scratch>> {
        let Some(sandbox) = &self.sandbox else { return Ok(None) };
        let scratch = Scratch::new(sandbox.program_limits)?;
        readable.extend(prepared.own_folder());
        command.current_dir(scratch.folder());
        sandbox.apply(command, &Grant { role: Role::Program, readable, scratch: scratch.folder() })?;
        Ok(Some(scratch))
    }

    /// Sets the number of consecutive robots that are assigned to a worker, see [`robots_per_turn`].
    pub fn set_robots_per_turn(&mut self, robots: usize) {
        self.robots_per_turn = robots;
    }

    /// Maps a copy of `prepared` for one robot; `main` gets the program's name followed by `arguments`. The copy is
    /// private, unless robots may share one on each of the `sharing_workers`: see [`ProgramImage::shared_variables`].
    ///
    /// Constructors that are not hidden, such as those of further libraries that the library needs, run on this thread;
    /// hidden ones run with the program. The copy is unmapped with the last clone of the result, unless the program may
    /// leave references to it (exit handlers, threads).
    ///
    /// # Errors
    /// [`LoadError`] if it is not a program for this eyesim or the dynamic linker refuses it.
    pub fn load(
        &mut self,
        prepared: &Arc<Prepared>,
        arguments: &[String],
        sharing_workers: Option<usize>,
    ) -> Result<LoadedProgram, LoadError> {
        let image = library_of(prepared)?;
        check_description(image)?;
        let arguments = c_arguments(&prepared.name, arguments)
            .map_err(|argument| LoadError::Argument { path: image.path().to_owned(), argument })?;
        let (library, variables) = match (sharing_workers, image.shared_variables()) {
            (Some(workers), Some(places)) => {
                let copy = self.shared_copy(prepared, image, places, workers)?;
                (Arc::clone(copy.opened()), Some(Arc::new(Variables::new(copy))))
            }
            _ => {
                let opened = self.map_sharing_pages(prepared, image)?;
                (Arc::new(if image.can_unmap() { opened } else { opened.kept() }), None)
            }
        };
        Ok(LoadedProgram { prepared: Arc::clone(prepared), image: Arc::clone(image), arguments, library, variables })
    }

    /// The shared copy for the next robot.
    fn shared_copy(
        &mut self,
        prepared: &Arc<Prepared>,
        image: &ProgramImage,
        places: &[Range<usize>],
        workers: usize,
    ) -> Result<Arc<SharedCopy>, LoadError> {
        let worker = (self.sharing_robots / self.robots_per_turn % workers.max(1)) as u32;
        self.sharing_robots += 1;
        let key = (Arc::as_ptr(prepared).addr(), worker);
        if let Some((_, copy)) = self.shared_copies.get(&key) {
            return Ok(Arc::clone(copy));
        }
        let opened = self.map_sharing_pages(prepared, image)?;
        // SAFETY: the ranges are writable parts of the opened image.
        let copy = Arc::new(unsafe { SharedCopy::new(opened, worker, places) });
        self.shared_copies.insert(key, (Arc::clone(prepared), Arc::clone(&copy)));
        Ok(copy)
    }

    /// Maps a copy of `image`; copies after the first one share its pages of code and constants.
    fn map_sharing_pages(&mut self, prepared: &Arc<Prepared>, image: &ProgramImage) -> Result<Opened, LoadError> {
        let (opened, copy) = self.map_copy(image)?;
        self.share(prepared, image, opened.base, copy);
        Ok(opened)
    }

    /// The file that robots' own processes load for `prepared`: a copy whose pages all these processes share. It exists
    /// as long as the loader. `arguments` are only checked.
    ///
    /// # Errors
    /// [`LoadError`] if according to the file it is not a program for this eyesim.
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

    /// Writes a copy of `image`, maps it and removes its name; returns the library and the file.
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

    /// Maps the code and constants of the program's first copy into the copy at `base`, which was loaded from the file
    /// `copy`.
    fn share(&mut self, prepared: &Arc<Prepared>, image: &ProgramImage, base: usize, copy: File) {
        match self.first_copies.entry(Arc::as_ptr(prepared).addr()) {
            Entry::Vacant(first) => {
                first.insert((Arc::clone(prepared), copy));
            }
            Entry::Occupied(first) => {
                let segments = image.read_only_segments();
                // SAFETY: both files were written from this image, and differ at most in the header's fields on the
                // section table, which the dynamic linker does not read; the files have been unlinked and have no other
                // owner. The segments belong to the image, which the caller keeps loaded at `base`.
                unsafe { share_pages(base, segments, &first.get().1, &copy) };
            }
        }
    }
}

/// A mapped library.
pub struct Opened {
    /// Base address.
    pub base: usize,
    /// Checked by [`open`]; points to the library's constants.
    description: NonNull<Program>,
    is_constructed: Once,
    /// Unmaps the library when dropped; `None` if the library stays mapped until the process ends.
    library: Option<Library>,
}

// SAFETY: the description is a constant, and the handle of the dynamic linker may be used on all threads.
unsafe impl Send for Opened {}
// SAFETY: as above.
unsafe impl Sync for Opened {}

impl Opened {
    /// The program's description.
    #[inline]
    pub fn description(&self) -> &Program {
        // SAFETY: checked by `open`, and mapped as long as `self`.
        unsafe { self.description.as_ref() }
    }

    /// Runs, once, the library's hidden constructors on this thread, if it has no shim that runs them.
    pub fn construct(&self) {
        if self.description().language == language::RUST {
            // SAFETY: the library stays mapped as long as `self`; hidden constructors have not run, and run once.
            self.is_constructed.call_once(|| unsafe { constructors::run_hidden(self.base) });
        }
    }

    /// Keeps the library mapped until the process ends.
    #[must_use]
    pub fn kept(mut self) -> Self {
        std::mem::forget(self.library.take());
        self
    }
}

/// Reasons why a library cannot be opened.
#[derive(Debug)]
pub enum OpenError {
    /// The dynamic linker refuses the library; contains its message.
    Linker(String),
    /// The library is incompatible with this eyesim; contains the reason.
    Incompatible(String),
}

impl OpenError {
    /// Converts this into an error about the library at `path`, which was opened as its copy `copy`.
    pub fn of(self, path: &Path, copy: &Path) -> LoadError {
        match self {
            Self::Linker(what) => refused(path, copy, &what),
            Self::Incompatible(what) => LoadError::Incompatible { path: path.to_owned(), what },
        }
    }
}

/// Maps the library at `path`, whose description must have been checked in the file ([`Loader::library`] does so). Its
/// constructors run on this thread unless they are hidden, and its destructors on the thread that drops it.
///
/// # Errors
/// [`OpenError`] if the dynamic linker refuses the library or its description does not fit.
pub fn open(path: &Path) -> Result<Opened, OpenError> {
    let linker = |error: &libloading::Error| {
        let source = std::error::Error::source(error).map(ToString::to_string);
        OpenError::Linker(source.unwrap_or_else(|| error.to_string()))
    };
    let incompatible = |what: &str| OpenError::Incompatible(what.to_owned());
    // SAFETY: loading runs the constructors of a library that the user asked to run, which is the purpose of a robot
    // program. The flags are valid for dlopen.
    let library = unsafe { Library::open(Some(path), RTLD_NOW | RTLD_LOCAL) }.map_err(|error| linker(&error))?;
    // Constructors have run on this thread; a constructor of `-ffast-math` changes the floating-point environment,
    // which the host uses from here on.
    float::set_default();
    // SAFETY: the symbol is only used as an address here.
    let symbol = unsafe { library.get::<*const Program>(PROGRAM_SYMBOL) }.map_err(|error| linker(&error))?;
    let description =
        NonNull::new(symbol.as_raw_ptr().cast::<Program>()).filter(|description| description.is_aligned());
    let description = description.ok_or_else(|| incompatible("its description is not where it should be"))?;
    // SAFETY: not null, aligned, and `check_description` has found in the file a description of this version and of at
    // least this size; it is a constant in an image that is mapped as long as `library`.
    unsafe { description.as_ref() }.check().map_err(|error| incompatible(&error.to_string()))?;
    let base = base_of(description.as_ptr().addr()).ok_or_else(|| incompatible("its address is unknown"))?;
    Ok(Opened { base, description, is_constructed: Once::new(), library: Some(library) })
}

/// The library of `prepared`; an error for a Python program and for an embedded one.
fn library_of(prepared: &Prepared) -> Result<&Arc<ProgramImage>, LoadError> {
    let path = || prepared.source.path().to_owned();
    let no_library = || LoadError::Incompatible {
        path: path(),
        what: "it is not a library and runs in a process of its own only".into(),
    };
    prepared.image().ok_or_else(no_library)
}

/// Checks the description in the file, before any of the library's code runs.
fn check_description(image: &ProgramImage) -> Result<(), LoadError> {
    let path = || image.path().to_owned();
    let Some(description) = image.description() else {
        return Err(LoadError::NotAProgram { path: path(), robios: robios_functions(image) });
    };
    if description.abi != ABI_VERSION {
        return Err(LoadError::Abi { path: path(), program: description.abi });
    }
    if (description.size as usize) < size_of::<Program>() {
        return Err(LoadError::Incompatible { path: path(), what: "its description is too short".into() });
    }
    Ok(())
}

/// The base address of the loaded image that contains `address`.
fn base_of(address: usize) -> Option<usize> {
    let mut info = std::mem::MaybeUninit::<libc::Dl_info>::zeroed();
    // SAFETY: dladdr takes any address, compares it with the images that are loaded, and writes only to `info`, which
    // is valid when all zero.
    let (found, info) =
        unsafe { (libc::dladdr(std::ptr::without_provenance(address), info.as_mut_ptr()), info.assume_init()) };
    (found != 0).then(|| info.dli_fbase.addr())
}

/// The RoBIOS functions that a library imports from the simulator.
fn robios_functions(image: &ProgramImage) -> Vec<String> {
    let is_robios = |name: &&String| Robios6Call::from_name(name).is_some() || Robios7Call::from_name(name).is_some();
    image.undefined().iter().filter(is_robios).cloned().collect()
}

/// The dynamic linker's message about `copy` as an error about the original library.
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

/// Checks that the kernel lets this process make the `mappings` for the copies of a run's programs and for the stacks
/// of its `robots`.
///
/// # Errors
/// [`LoadError::TooManyMappings`] if they do not fit. If the kernel's limit is unknown, nothing is checked.
pub fn check_mappings(robots: usize, mappings: usize) -> Result<(), LoadError> {
    // Mappings reserved for the heap and the record, which grow during the run.
    const RESERVE: usize = 1000;
    let limit = fs::read_to_string("/proc/sys/vm/max_map_count").ok();
    let Some(allowed) = limit.and_then(|text| text.trim().parse().ok()) else { return Ok(()) };
    let existing = fs::read_to_string("/proc/self/maps").map_or(0, |maps| maps.lines().count());
    let needed = existing + RESERVE + mappings;
    if needed <= allowed {
        return Ok(());
    }
    Err(LoadError::TooManyMappings { robots, needed, allowed, advised: needed.next_power_of_two() })
}

/// The arguments of a program as C strings, `argv[0]` first; the error describes an argument that contains a NUL.
fn c_arguments(name: &str, arguments: &[String]) -> Result<Vec<CString>, String> {
    let strings = std::iter::once(name).chain(arguments.iter().map(String::as_str));
    strings.map(|string| CString::new(string).map_err(|error| error.to_string())).collect()
}
