//! Builds programs: C and C++ sources through the cache, Cargo packages with cargo.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, OnceLock};

use super::cache::Cache;
use super::cargo::{CargoError, build_package};
use super::compile::{Compilation, CompileError, Compiled, Kits, ShimKit};
use super::compiler::{Compiler, CompilerError};
use super::find::ProgramSource;
use super::generation::{
    ChoiceReason, Generation, GenerationChoice, GenerationError, GenerationHint, MAX_SHOWN, choose,
};
use super::hint;
use super::language::Language;
use super::python::{Python, PythonError};
use super::sandbox::Sandbox;
use super::words::{WordsError, split_words};
use crate::files::read_regular;

/// Version of the cache's layout; part of every key.
const CACHE_VERSION: u32 = 2;

/// Sources of the code that translates compiler messages: part of every key, since the cache stores translated
/// warnings.
const TRANSLATORS: [&str; 3] = [include_str!("plain.rs"), include_str!("compile.rs"), include_str!("code.rs")];

/// Environment variables that change the output of a compiler.
const ENVIRONMENT: [&str; 7] = [
    "CPATH",
    "C_INCLUDE_PATH",
    "CPLUS_INCLUDE_PATH",
    "LIBRARY_PATH",
    "GCC_EXEC_PREFIX",
    "COMPILER_PATH",
    "SOURCE_DATE_EPOCH",
];

/// Tools named by the user's environment.
#[derive(Clone, Debug, Default)]
pub struct Tools {
    /// `$CC`: the C compiler, with arguments if any.
    pub cc: Option<String>,
    /// `$CXX`: the C++ compiler, with arguments if any.
    pub cxx: Option<String>,
    /// `$EYESIM_CFLAGS`: compiler flags that follow all other flags.
    pub cflags: Option<String>,
    /// `$CARGO`: the cargo command; if unset, `cargo` on the search path.
    pub cargo: Option<PathBuf>,
    /// `$PYTHON`: the interpreter of Python programs; if unset, the interpreter of the [host](crate::host), otherwise
    /// `python3` on the search path.
    pub python: Option<PathBuf>,
}

impl Tools {
    /// The tools that the environment of this process names.
    pub fn of_environment() -> Self {
        let text = |name: &str| std::env::var(name).ok().filter(|value| !value.trim().is_empty());
        let [cargo, python] = ["CARGO", "PYTHON"].map(|name| text(name).map(PathBuf::from));
        Self { cc: text("CC"), cxx: text("CXX"), cflags: text("EYESIM_CFLAGS"), cargo, python }
    }

    fn compiler(&self, language: Language) -> Option<&str> {
        match language {
            Language::C => self.cc.as_deref(),
            Language::Cpp => self.cxx.as_deref(),
        }
    }
}

/// A program that is ready to be loaded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BuiltProgram {
    /// The shared library, the file of a Python program, or the name of an embedded program.
    pub library: PathBuf,
    /// Source of the program.
    pub source: ProgramSource,
    /// Warnings of the compiler, also if the program was built earlier.
    pub output: String,
    /// A compiler has run for this build; false if the existing library was up to date.
    pub compiled: bool,
    /// The generation of RoBIOS for which sources were compiled, with the reason.
    pub choice: Option<GenerationChoice>,
}

/// A program that cannot be built.
#[derive(Debug, thiserror::Error)]
pub enum BuildError {
    /// No working compiler was found.
    #[error(transparent)]
    Compiler(#[from] CompilerError),
    /// The sources call functions of two generations.
    #[error(transparent)]
    Generation(#[from] GenerationError),
    /// The sources cannot be compiled or linked.
    #[error(transparent)]
    Compile(#[from] CompileError),
    /// The sources do not compile for the stated generation, and call functions that only the other one has.
    #[error(
        "the program calls {} of {}, but `--api` or the scene states {}: leave that out\n{error}",
        hint::quoted(&functions[..functions.len().min(MAX_SHOWN)]), stated.other().name(), stated.name()
    )]
    WrongGeneration {
        /// The stated generation.
        stated: Generation,
        /// Functions called that only the other generation has.
        functions: Vec<String>,
        /// Error of the compilation.
        error: Box<CompileError>,
    },
    /// A Cargo package cannot be built into a program.
    #[error(transparent)]
    Cargo(#[from] CargoError),
    /// `$EYESIM_CFLAGS` cannot be split into words.
    #[error("$EYESIM_CFLAGS: {0}")]
    Flags(#[from] WordsError),
    /// A source cannot be read.
    #[error("cannot read `{}`: {error}", path.display())]
    Source {
        /// The source.
        path: PathBuf,
        /// Reason for the error.
        error: io::Error,
    },
    /// A source is a link to a file outside the program's folder; a restricted program is built only from files in its
    /// folder.
    #[error("`{}` is a link out of its folder, and the sandbox builds a program only from the files in its own folder", path.display())]
    Outside {
        /// The source.
        path: PathBuf,
    },
    /// A package of Rust, whose build scripts cargo would run without restrictions.
    #[error(
        "`{}` is a Rust package, which the sandbox does not build: name its built library (`cargo build --release`), which it runs",
        folder.display()
    )]
    Package {
        /// The package's folder.
        folder: PathBuf,
    },
    /// There is no Python interpreter for a Python program.
    #[error(transparent)]
    Python(#[from] PythonError),
    /// The cache cannot be read or written.
    #[error("cannot use the cache `{}`: {error}", root.display())]
    Cache {
        /// The cache's folder.
        root: PathBuf,
        /// Reason for the error.
        error: io::Error,
    },
}

/// Observer of compilations, for progress displays. Called from the threads that build.
pub trait BuildObserver: std::fmt::Debug + Send + Sync {
    /// A compiler, or cargo, starts to work on `source`.
    fn begin(&self, source: &ProgramSource);

    /// The compiler has ended, with or without success.
    fn end(&self, source: &ProgramSource);
}

/// Builds the programs of a run; searches for each compiler only once.
#[derive(Debug)]
pub struct Builder {
    cache: Cache,
    kits: Kits,
    tools: Tools,
    /// The compilers of [`Language::ALL`].
    compilers: [OnceLock<Compiler>; 2],
    /// Locked while a thread searches for a compiler, so that only one thread does.
    search_lock: Mutex<()>,
    observer: Option<Box<dyn BuildObserver>>,
    /// Restrictions of the compilers.
    sandbox: Option<Sandbox>,
}

impl Builder {
    /// Creates a builder that stores its results in `cache` and builds C and C++ programs with the headers and the shim
    /// of `kits`.
    pub fn new(cache: Cache, kits: Kits, tools: Tools) -> Self {
        Self {
            cache,
            kits,
            tools,
            compilers: Default::default(),
            search_lock: Mutex::new(()),
            observer: None,
            sandbox: None,
        }
    }

    /// Restricts the compilers: a program is then built only from the files in its own folder.
    pub fn with_sandbox(self, sandbox: Option<Sandbox>) -> Self {
        Self { sandbox, ..self }
    }

    /// The cache of the builder's results.
    pub fn cache(&self) -> &Cache {
        &self.cache
    }

    /// Sets the observer.
    pub fn with_observer(self, observer: Box<dyn BuildObserver>) -> Self {
        Self { observer: Some(observer), ..self }
    }

    /// Drops the observer, and so the threads that it may have.
    pub fn remove_observer(&mut self) {
        self.observer = None;
    }

    /// Builds a library from `source`, or returns the existing one if it is up to date.
    ///
    /// # Errors
    /// [`BuildError`], with the compiler's own messages if the compiler refuses a source.
    pub fn build(&self, source: &ProgramSource) -> Result<BuiltProgram, BuildError> {
        match source {
            ProgramSource::Library(_) | ProgramSource::Python(_) | ProgramSource::Embedded(_) => {
                let (library, source) = (source.path().to_owned(), source.clone());
                Ok(BuiltProgram { library, source, output: String::new(), compiled: false, choice: None })
            }
            ProgramSource::Sources { files, hint } => self.build_sources(source, files, *hint),
            ProgramSource::Cargo(folder) if self.sandbox.is_some() => {
                Err(BuildError::Package { folder: folder.clone() })
            }
            ProgramSource::Cargo(folder) => {
                let cargo = self.tools.cargo.as_deref();
                let package = self.run_observed(source, || build_package(folder, cargo, &self.cache))?;
                Ok(BuiltProgram {
                    library: package.library,
                    source: source.clone(),
                    output: package.output,
                    compiled: !package.fresh,
                    choice: None,
                })
            }
        }
    }

    /// The interpreter of Python programs.
    ///
    /// # Errors
    /// [`BuildError::Python`].
    pub fn python(&self) -> Result<Python, BuildError> {
        Ok(Python::find(self.tools.python.as_deref(), &self.cache)?)
    }

    /// Builds each of `sources` once, on as many threads as there are processors; the results are in the order of
    /// `sources`.
    pub fn build_all(&self, sources: &[ProgramSource]) -> Vec<Result<BuiltProgram, BuildError>> {
        let threads = std::thread::available_parallelism().map_or(1, usize::from).min(sources.len());
        if threads < 2 {
            return sources.iter().map(|source| self.build(source)).collect();
        }
        let next = std::sync::atomic::AtomicUsize::new(0);
        let results: Vec<OnceLock<_>> = sources.iter().map(|_| OnceLock::new()).collect();
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| {
                    while let index = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed)
                        && let Some(source) = sources.get(index)
                    {
                        // Each index is taken by one thread only.
                        let _ = results[index].set(self.build(source));
                    }
                });
            }
        });
        results.into_iter().filter_map(OnceLock::into_inner).collect()
    }

    /// Compiles `sources` to the file `out` without the cache, with `flags` after all other flags.
    ///
    /// Returns the choice of the generation, the executed commands, one per line, and the compiler's warnings.
    ///
    /// # Errors
    /// [`BuildError`].
    pub fn build_to(
        &self,
        sources: &[PathBuf],
        hint: GenerationHint,
        out: &Path,
        flags: &[String],
    ) -> Result<(GenerationChoice, String, String), BuildError> {
        let choice = choose(sources, hint, None)?;
        let mut extra_flags = self.extra_flags()?;
        extra_flags.extend_from_slice(flags);
        let sources = absolute(sources)?;
        let folder = self.cache.build_folder().map_err(|error| self.cache_error(error))?;
        let compile = |choice: &GenerationChoice| -> Result<_, BuildError> {
            Ok((self.compile(&sources, choice.generation, &extra_flags, folder.path())?, choice.clone()))
        };
        let (compiled, choice) = try_both_generations(choice, compile, |(compiled, _)| &compiled.output)?;
        replace_file(&compiled.library, out).map_err(|error| CompileError::Io { program: out.to_owned(), error })?;
        Ok((choice, compiled.commands, compiled.output))
    }

    fn build_sources(
        &self,
        source: &ProgramSource,
        files: &[PathBuf],
        hint: GenerationHint,
    ) -> Result<BuiltProgram, BuildError> {
        let folders = self.sandbox.as_ref().map(|sandbox| sandbox.source_folders(files));
        if let Some(folders) = &folders {
            check_inside(files, folders)?;
        }
        let build = |choice: &GenerationChoice| self.build_for(source, files, choice);
        try_both_generations(choose(files, hint, folders.as_deref())?, build, |built| &built.output)
    }

    fn build_for(
        &self,
        source: &ProgramSource,
        files: &[PathBuf],
        choice: &GenerationChoice,
    ) -> Result<BuiltProgram, BuildError> {
        let generation = choice.generation;
        let sources = absolute(files)?;
        let extra_flags = self.extra_flags()?;
        let built = |entry: super::cache::CacheEntry, compiled| BuiltProgram {
            library: entry.library,
            source: source.clone(),
            output: entry.output,
            compiled,
            choice: Some(choice.clone()),
        };
        // A file saved during the compilation is compiled again: the key must match the contents that were read.
        let mut attempts = 0;
        loop {
            attempts += 1;
            let sources_key = self.sources_key(&sources, generation, &extra_flags)?;
            if let Some(note) = self.cache.note(&sources_key)
                && let Some(key) = program_key(&sources_key, &note)
                && let Some(entry) = self.cache.entry(&key)
            {
                return Ok(built(entry, false));
            }
            let folder = self.cache.build_folder().map_err(|error| self.cache_error(error))?;
            let started = std::time::SystemTime::now();
            let compile = || self.compile(&sources, generation, &extra_flags, folder.path());
            let compiled = self.run_observed(source, compile)?;
            let note: String = compiled.read_files.iter().map(|path| format!("{}\n", path.display())).collect();
            let changed = attempts < 3
                && compiled.read_files.iter().any(|path| {
                    fs::metadata(path).and_then(|metadata| metadata.modified()).is_ok_and(|modified| modified > started)
                });
            if changed {
                continue;
            }
            let missing = || io::Error::new(io::ErrorKind::NotFound, "a source is gone since it was compiled");
            let key = program_key(&sources_key, &note).ok_or_else(missing).map_err(|error| self.cache_error(error))?;
            let entry = self
                .cache
                .insert(&key, folder, &compiled.library, &compiled.output)
                .and_then(|entry| self.cache.set_note(&sources_key, &note).map(|()| entry))
                .map_err(|error| self.cache_error(error))?;
            return Ok(built(entry, true));
        }
    }

    fn compile(
        &self,
        sources: &[PathBuf],
        generation: Generation,
        extra_flags: &[String],
        folder: &Path,
    ) -> Result<Compiled, BuildError> {
        let kit = self.kits.of(generation);
        let compilers = self.compilers(sources)?;
        let compilation = Compilation {
            compilers: &compilers,
            generation,
            kit,
            kit_folder: &self.kit_folder(kit).map_err(|error| self.cache_error(error))?,
            sources,
            extra_flags,
            folder,
            cache: &self.cache,
            sandbox: self.sandbox.as_ref(),
        };
        let mut compiled = compilation.run()?;
        let notes: String = compilers.iter().filter_map(|compiler| compiler.note()).collect();
        compiled.output.insert_str(0, &notes);
        Ok(compiled)
    }

    /// Runs `work` on `source` and reports its begin and end to the observer.
    fn run_observed<T>(&self, source: &ProgramSource, work: impl FnOnce() -> T) -> T {
        self.observer.iter().for_each(|observer| observer.begin(source));
        let result = work();
        self.observer.iter().for_each(|observer| observer.end(source));
        result
    }

    /// The compilers that `sources` and the shim need.
    fn compilers(&self, sources: &[PathBuf]) -> Result<Vec<&Compiler>, BuildError> {
        let is_needed = |language: &Language| {
            *language == Language::C || sources.iter().any(|source| Language::of(source) == Some(*language))
        };
        // C++ first: its package installs the compiler of C, too.
        Language::ALL.into_iter().rev().filter(is_needed).map(|language| self.compiler(language)).collect()
    }

    fn compiler(&self, language: Language) -> Result<&Compiler, BuildError> {
        let _guard = self.search_lock.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let found = &self.compilers[language as usize];
        if let Some(compiler) = found.get() {
            return Ok(compiler);
        }
        let compiler = Compiler::find(language, self.tools.compiler(language), &self.cache)?;
        Ok(found.get_or_init(|| compiler))
    }

    fn extra_flags(&self) -> Result<Vec<String>, BuildError> {
        Ok(self.tools.cflags.as_deref().map(split_words).transpose()?.unwrap_or_default())
    }

    /// The files of `kit`, written into the cache: a permanent folder, for debuggers and editors.
    fn kit_folder(&self, kit: &ShimKit) -> io::Result<PathBuf> {
        let folder = self.cache.folder("kits")?.join(kit.digest());
        let headers = kit.headers.iter().map(|(name, text)| (folder.join("include").join(name), text));
        let shim = kit.shim.iter().map(|(name, text)| (folder.join("shim").join(name), text));
        for (path, text) in headers.chain(shim) {
            if fs::read(&path).is_ok_and(|existing| existing == text.as_bytes()) {
                continue;
            }
            self.cache.write_atomically(&path, text.as_bytes())?;
        }
        Ok(folder)
    }

    /// Digest of everything that determines the built program, except the contents of the headers included.
    fn sources_key(
        &self,
        sources: &[PathBuf],
        generation: Generation,
        extra_flags: &[String],
    ) -> Result<String, BuildError> {
        let mut hasher = blake3::Hasher::new();
        let mut add = |bytes: &[u8]| {
            hasher.update(&(bytes.len() as u64).to_le_bytes());
            hasher.update(bytes);
        };
        add(format!("eyesim {CACHE_VERSION}").as_bytes());
        TRANSLATORS.iter().for_each(|text| add(text.as_bytes()));
        // A program built without restrictions may contain data that a restricted program must not read.
        add(self.sandbox.as_ref().map_or("", |sandbox| sandbox.level().word()).as_bytes());
        add(self.kits.of(generation).digest().as_bytes());
        for compiler in self.compilers(sources)? {
            add(compiler.identity().as_bytes());
            for flag in compiler.compile_flags().chain(compiler.standards()).chain(compiler.link_flags()) {
                add(flag.as_bytes());
            }
        }
        for flag in extra_flags {
            add(flag.as_bytes());
        }
        for name in ENVIRONMENT {
            add(std::env::var_os(name).unwrap_or_default().as_encoded_bytes());
        }
        for source in sources {
            add(source.as_os_str().as_encoded_bytes());
            add(&read_regular(source).map_err(|error| BuildError::Source { path: source.clone(), error })?);
            // A new header in the folder of a source may take precedence over one that was included from elsewhere.
            for header in headers_beside(source) {
                add(header.as_os_str().as_encoded_bytes());
            }
        }
        Ok(hasher.finalize().to_hex()[..32].to_owned())
    }

    fn cache_error(&self, error: io::Error) -> BuildError {
        BuildError::Cache { root: self.cache.root().to_owned(), error }
    }
}

/// Returns the result of `build` for the choice. If the choice is a guess and the sources do not compile, the other
/// generation is tried; its result is used unless the compiler's `output` has warnings about types of arguments.
fn try_both_generations<T>(
    choice: GenerationChoice,
    build: impl Fn(&GenerationChoice) -> Result<T, BuildError>,
    output: impl Fn(&T) -> &str,
) -> Result<T, BuildError> {
    let fits = |built: &T| {
        !["[-Wint-conversion]", "[-Wincompatible-pointer-types]"].iter().any(|flag| output(built).contains(flag))
    };
    match build(&choice) {
        Err(BuildError::Compile(error)) if choice.is_guess() => {
            build(&choice.switched()).ok().filter(fits).ok_or(BuildError::Compile(error))
        }
        Err(BuildError::Compile(error)) => Err(match choice.reason {
            ChoiceReason::Stated(functions) if !functions.is_empty() => {
                BuildError::WrongGeneration { stated: choice.generation, functions, error: Box::new(error) }
            }
            _ => BuildError::Compile(error),
        }),
        result => result,
    }
}

/// Replaces `to` by a copy of `from` atomically: a process that has loaded the old file keeps it.
fn replace_file(from: &Path, to: &Path) -> io::Result<()> {
    let folder = to.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let copy = tempfile::NamedTempFile::new_in(folder)?;
    fs::copy(from, copy.path())?;
    copy.persist(to).map(drop).map_err(|error| error.error)
}

fn absolute(sources: &[PathBuf]) -> Result<Vec<PathBuf>, BuildError> {
    let canonical =
        |path: &PathBuf| fs::canonicalize(path).map_err(|error| BuildError::Source { path: path.clone(), error });
    sources.iter().map(canonical).collect()
}

/// Checks that no source is a link that leads out of `folders`.
fn check_inside(sources: &[PathBuf], folders: &[PathBuf]) -> Result<(), BuildError> {
    let is_inside = |source: &Path| folders.iter().any(|folder| source.starts_with(folder));
    match sources.iter().zip(absolute(sources)?).find(|(_, source)| !is_inside(source)) {
        Some((path, _)) => Err(BuildError::Outside { path: path.clone() }),
        None => Ok(()),
    }
}

fn headers_beside(source: &Path) -> Vec<PathBuf> {
    let entries = source.parent().map(fs::read_dir).and_then(Result::ok).into_iter().flatten().flatten();
    let mut headers: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| is_header(path)).collect();
    headers.sort();
    headers
}

fn is_header(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    ["h", "hh", "hpp", "hxx", "inc"].contains(&extension)
}

/// Digest of the sources' key and of the contents of the files that `note` lists, one per line; `None` if a file no
/// longer exists.
fn program_key(sources_key: &str, note: &str) -> Option<String> {
    let mut hasher = blake3::Hasher::new();
    hasher.update(sources_key.as_bytes());
    for path in note.lines() {
        hasher.update(blake3::hash(path.as_bytes()).as_bytes());
        hasher.update(blake3::hash(&read_regular(Path::new(path)).ok()?).as_bytes());
    }
    Some(hasher.finalize().to_hex()[..32].to_owned())
}
