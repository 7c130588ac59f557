//! Loads private copies of a library: each robot has the program's globals for itself.

use std::ffi::{CString, OsStr};
use std::fs;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use libloading::os::unix::{Library, RTLD_LOCAL, RTLD_NOW};
use robios_sys::{ABI_VERSION, Misfit, PROGRAM_SYMBOL, Program, Robios6Call, Run};

use super::image::{ImageError, ProgramImage, SourceLine};

/// So many copies of a run are whole files with their debug information, for debuggers and profilers; further ones hold
/// only what is mapped.
const WHOLE_COPIES: usize = 8;

/// A library that cannot be loaded as a robot program.
#[derive(Debug, thiserror::Error)]
pub enum LoadError {
    /// The file is no library for this system, or cannot be read.
    #[error(transparent)]
    Image(#[from] ImageError),
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

/// A robot's own copy of a program, ready to run. It stays mapped until the process ends.
#[derive(Clone, Debug)]
pub struct LoadedProgram {
    image: Arc<ProgramImage>,
    base: usize,
    run: Run,
    language: u32,
    flags: u32,
}

impl LoadedProgram {
    /// The function that runs the program's `main`.
    pub fn run(&self) -> Run {
        self.run
    }

    /// The language of the program's shim, a constant of `robios_sys::language`.
    pub fn language(&self) -> u32 {
        self.language
    }

    /// Bits of `robios_sys::flag`.
    pub fn flags(&self) -> u32 {
        self.flags
    }

    /// The library that this is a copy of.
    pub fn image(&self) -> &ProgramImage {
        &self.image
    }

    /// The addresses at which the copy's code and variables lie.
    pub fn addresses(&self) -> Range<usize> {
        let span = self.image.span();
        self.base + span.start..self.base + span.end
    }

    /// The line of the source at `address`, if it lies in this copy and the debug information tells it. See
    /// [`ProgramImage::source_line`].
    pub fn source_line(&self, address: usize) -> Option<SourceLine> {
        self.image.source_line(self.offset(address)?)
    }

    /// The line in the program's own sources of the first of `addresses` (a call stack, innermost first) that has one. See
    /// [`ProgramImage::own_source_line`].
    pub fn own_source_line(&self, addresses: &[usize]) -> Option<SourceLine> {
        self.image.own_source_line(addresses.iter().filter_map(|&address| self.offset(address)))
    }

    fn offset(&self, address: usize) -> Option<usize> {
        self.addresses().contains(&address).then(|| address - self.base)
    }
}

/// Loads the programs of one run. Its folder holds each copy only while that is being loaded.
#[derive(Debug)]
pub struct Loader {
    folder: tempfile::TempDir,
    copies: usize,
}

impl Loader {
    /// A loader with a run folder of its own under the temporary folder, removed when it is dropped.
    ///
    /// # Errors
    /// If the folder cannot be made.
    pub fn new() -> io::Result<Self> {
        Ok(Self { folder: tempfile::Builder::new().prefix("eyesim-run-").tempdir()?, copies: 0 })
    }

    /// Maps a private copy of `image` for one robot.
    ///
    /// The library's constructors run on this thread. The copy is never unmapped: what it left behind (exit handlers,
    /// thread-locals) may still point into it.
    ///
    /// # Errors
    /// [`LoadError`] if it is no program for this eyesim or the dynamic linker refuses it.
    pub fn load(&mut self, image: &Arc<ProgramImage>) -> Result<LoadedProgram, LoadError> {
        if !image.defines(PROGRAM_SYMBOL) {
            return Err(LoadError::NotAProgram { path: image.path().to_owned(), robios: robios_functions(image) });
        }
        let library = self.map_copy(image)?;
        let missing = |_| LoadError::NotAProgram { path: image.path().to_owned(), robios: Vec::new() };
        // SAFETY: the symbol is only used as an address here.
        let program = unsafe { library.get::<*const Program>(PROGRAM_SYMBOL) }.map_err(missing)?.as_raw_ptr();
        // The copy stays for ever: a loaded image may have left pointers into itself anywhere.
        std::mem::forget(library);
        let program = program.cast_const().cast::<Program>();
        let (base, program) = checked(image, program)?;
        Ok(LoadedProgram {
            image: Arc::clone(image),
            base,
            run: program.run,
            language: program.language,
            flags: program.flags,
        })
    }

    fn map_copy(&mut self, image: &ProgramImage) -> Result<Library, LoadError> {
        self.copies += 1;
        let stem = image.path().file_stem().unwrap_or(OsStr::new("program"));
        let copy = self.folder.path().join(format!("{}-{}.so", stem.display(), self.copies));
        let written = if self.copies <= WHOLE_COPIES {
            fs::write(&copy, image.bytes())
        } else {
            fs::write(&copy, image.loaded_part())
        };
        written.map_err(|error| {
            let folder = self.folder.path().to_owned();
            LoadError::Copy { path: image.path().to_owned(), folder, error }
        })?;
        // SAFETY: loading runs the constructors of a library that the user asked to run; that is what a robot program
        // is. The flags are those of dlopen.
        let library = unsafe { Library::open(Some(&copy), RTLD_NOW | RTLD_LOCAL) };
        let _ = fs::remove_file(&copy);
        library.map_err(|error| refused(image.path(), &copy, &error))
    }
}

/// The base of a loaded copy and the description that it exports, if it fits this host.
fn checked(image: &ProgramImage, program: *const Program) -> Result<(usize, &'static Program), LoadError> {
    let path = || image.path().to_owned();
    let misfit = |what: &str| LoadError::Misfit { path: path(), what: what.to_owned() };
    if program.is_null() || !program.is_aligned() {
        return Err(misfit("its description is not where it should be"));
    }
    // SAFETY: a description starts with two numbers, its size and the version of its layout, in every version; the
    // pointer is the address of the exported symbol, not null and aligned.
    let [size, abi] = unsafe { program.cast::<[u32; 2]>().read() };
    if abi != ABI_VERSION {
        return Err(LoadError::Abi { path: path(), program: abi });
    }
    if (size as usize) < size_of::<Program>() {
        return Err(misfit("its description is too short"));
    }
    // SAFETY: the library says that a description of this version and at least this size is there; it is a constant
    // in an image that is never unmapped.
    let program = unsafe { &*program };
    program.check().map_err(|why| match why {
        Misfit::Abi { program } => LoadError::Abi { path: path(), program },
        other => misfit(&other.to_string()),
    })?;
    let base = base_of(std::ptr::from_ref(program).addr()).ok_or_else(|| misfit("its address is unknown"))?;
    Ok((base, program))
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
    let is_robios = |name: &&String| Robios6Call::ALL.iter().any(|call| call.name() == name.as_str());
    image.undefined().iter().filter(is_robios).cloned().collect()
}

/// What the dynamic linker says of `copy`, told of the library that it is a copy of.
fn refused(path: &Path, copy: &Path, error: &libloading::Error) -> LoadError {
    let source = std::error::Error::source(error).map(ToString::to_string);
    let what = source.unwrap_or_else(|| error.to_string());
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

/// The arguments of a program as C strings, `argv[0]` first.
///
/// # Errors
/// The place of the argument that holds a NUL.
pub fn c_arguments<'a>(name: &'a str, arguments: impl IntoIterator<Item = &'a str>) -> Result<Vec<CString>, usize> {
    let words = std::iter::once(name).chain(arguments);
    words.enumerate().map(|(at, word)| CString::new(word).ok().ok_or(at)).collect()
}
