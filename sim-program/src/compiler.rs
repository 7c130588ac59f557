//! Finds the system's compilers of C and C++, their command lines, and the flags that they support.

use std::ffi::OsString;
use std::io;
use std::iter;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use robios_sys::c;

use super::cache::Cache;
use super::command::{COMMAND_TIMEOUT, build_output};
use super::hint;
use super::language::Language;
use super::words::split_words;
use crate::host;

/// Standards for the first compilation of a source, newest first: the newest one that the compiler supports is used.
const fn standards(language: Language) -> &'static [&'static str] {
    match language {
        Language::C => OLD_C_STANDARDS,
        Language::Cpp => {
            &["-std=gnu++26", "-std=gnu++2c", "-std=gnu++23", "-std=gnu++2b", "-std=gnu++20", "-std=gnu++17"]
        }
    }
}

/// The standard of C: newer ones refuse K&R functions and `bool` as a name.
const OLD_C_STANDARDS: &[&str] = &["-std=gnu17"];

/// Older standards, for sources that the newest one refuses, in the order in which they are tried. Before C++17,
/// functions had `throw (...)` in their heads, and namespace `std` had no `byte`, `data` and `size`.
const OLD_CPP_STANDARDS: &[&str] = &["-std=gnu++17", "-std=gnu++14"];

/// Further flags of every compilation of a robot program, understood by every gcc and clang.
///
/// | flag | why |
/// |---|---|
/// | `-O2` | image and map code in loops; `-O0` gives the same results: add it to step through a program |
/// | `-fsigned-char` | `char` is signed as on the robot's processor, also on ARM |
/// | `-fwrapv`, `-fno-delete-null-pointer-checks` | as with old compilers, overflow wraps, and a null pointer crashes where it is used |
/// | `-fno-omit-frame-pointer`, `-fno-optimize-sibling-calls` | the call stack can be walked after a crash, and has each caller |
/// | `-Wall`, `-Wmain` | warnings for beginners; `-Wmain` also shows that `main` returns nothing |
pub const COMPILE_FLAGS: &[&str] = &[
    "-O2",
    "-fsigned-char",
    "-fwrapv",
    "-fno-delete-null-pointer-checks",
    "-fno-omit-frame-pointer",
    "-fno-optimize-sibling-calls",
    "-Wall",
    "-Wmain",
    // Only some of these warnings are shown, see `plain::without_harmless_warnings`.
    "-Wfloat-conversion",
    "-Wno-error=float-conversion",
    "-Wformat-security",
    "-Wno-error=format-security",
];

/// Flags that are used if the compiler supports them: flags for old sources whose constructs have become errors (gcc
/// 14, clang 16, C++11), index checks of `vector` and similar classes, and stack probes (with them, a big local array
/// hits the guard page and not the memory beyond it).
const fn optional_compile_flags(language: Language) -> &'static [&'static str] {
    match language {
        Language::C => &[
            "-Wno-error=implicit-int",
            "-Wno-error=implicit-function-declaration",
            "-Wno-error=int-conversion",
            "-Wno-error=incompatible-pointer-types",
            "-Wno-error=incompatible-function-pointer-types",
            "-Wno-error=return-type",
            "-Wno-error=return-mismatch",
            "-Wno-error=declaration-missing-parameter-type",
            "-Wno-error=main-return-type",
            "-fstack-clash-protection",
        ],
        Language::Cpp => &[
            "-Wno-error=narrowing",
            "-Wno-error=c++11-narrowing",
            "-Wno-error=register",
            "-Wno-error=writable-strings",
            "-fno-gnu-unique",
            "-D_GLIBCXX_ASSERTIONS",
            "-fstack-clash-protection",
        ],
    }
}

/// Linker flags that are used if the linker supports them: together they halve the number of memory mappings of a
/// robot's private copy.
const OPTIONAL_LINK_FLAGS: &[&str] = &["-Wl,-z,noseparate-code", "-Wl,-z,norelro"];

/// A compiler that was found, with its flags.
#[derive(Clone, Debug)]
pub struct Compiler {
    language: Language,
    command: Vec<String>,
    version: String,
    is_zig: bool,
    newest_standard: String,
    optional_compile_flags: Vec<String>,
    optional_link_flags: Vec<String>,
}

/// Reasons why no compiler of a language can be used.
#[derive(Debug, thiserror::Error)]
pub enum CompilerError {
    /// The language's variable is not set and none of the usual commands runs.
    #[error(
        "no {} compiler is found (tried {}): install one (Debian and Ubuntu: `apt install {}`{}), or set ${} to its name",
        language.name(), hint::quoted(language.commands()), language.packages(), host_install_hint(), language.variable()
    )]
    Missing {
        /// The language.
        language: Language,
    },
    /// The command in the language's variable does not start.
    #[error("the {} compiler `{command}` set in ${} does not run: {error}", language.name(), language.variable())]
    Broken {
        /// The language.
        language: Language,
        /// Value of the variable.
        command: String,
        /// Reason why it does not run.
        error: String,
    },
    /// A compiler starts, but does not print its version in time.
    #[error("the {} compiler `{command}` does not answer: {error}", language.name())]
    Silent {
        /// The language.
        language: Language,
        /// The compiler's command.
        command: String,
        /// The error with the time limit.
        error: io::Error,
    },
    /// The compiler starts, but cannot compile a small file, or cannot link because the library's development files are
    /// missing.
    #[error(
        "the {} compiler `{command}` cannot build a library (on Debian and Ubuntu `apt install {}` gives what it \
         needs):\n{output}",
        language.name(), language.packages()
    )]
    Unusable {
        /// The language.
        language: Language,
        /// The compiler's command.
        command: String,
        /// Output of the compiler.
        output: String,
    },
    /// The C++ library exists only as a shared library, whose streams all robots would share.
    #[error(
        "the C++ compiler `{command}` has no static C++ library (`libstdc++.a`), of which each robot needs a copy: install it \
         (Fedora: `dnf install libstdc++-static`; Debian and Ubuntu: `apt install g++`):\n{output}"
    )]
    NoStaticLibrary {
        /// The compiler's command.
        command: String,
        /// Output of the linker.
        output: String,
    },
    /// The cache, in which the compiler is tried, cannot be written.
    #[error("cannot try the compiler in the folder for built programs: {0}")]
    Io(#[from] io::Error),
}

/// Hint on the command that installs the compiler of the [host]; empty if there is none.
fn host_install_hint() -> String {
    let installer = host::current().map(|host| &host.zig_installer).filter(|installer| !installer.is_empty());
    installer.map_or_else(String::new, |installer| format!("; without the system's packages: `{installer}`"))
}

impl Compiler {
    /// Finds the compiler of `language`: the one that `setting` names (the value of `$CC` or `$CXX`, which may contain
    /// arguments), otherwise the first of the language's [usual commands](Language::commands) that runs, otherwise the
    /// zig of the [host].
    ///
    /// The optional flags that the compiler supports are determined once and stored in `cache`.
    ///
    /// # Errors
    /// [`CompilerError`] if there is no compiler or it does not work.
    pub fn find(language: Language, setting: Option<&str>, cache: &Cache) -> Result<Self, CompilerError> {
        let zig = zig(language);
        let (command, version) = match setting.map(str::trim).filter(|setting| !setting.is_empty()) {
            Some(setting) => {
                let broken = |error: String| CompilerError::Broken { language, command: setting.to_owned(), error };
                let command = split_words(setting).map_err(|error| broken(error.to_string()))?;
                let version = version_of(&command, cache).map_err(|error| broken(error.to_string()))?;
                (command, version)
            }
            None => first_working(language, zig.as_ref(), cache)?,
        };
        if let Some(key) = version_key(&command)
            && cache.note(&key).is_none()
        {
            cache.set_note(&key, &version)?;
        }
        let (optional_compile_flags, optional_link_flags) = (Vec::new(), Vec::new());
        let newest_standard = String::new();
        let is_zig = zig.is_some_and(|zig| zig == command);
        let mut compiler =
            Self { language, command, version, is_zig, newest_standard, optional_compile_flags, optional_link_flags };
        compiler.probe(cache)?;
        Ok(compiler)
    }

    /// The language that the compiler compiles.
    pub fn language(&self) -> Language {
        self.language
    }

    /// The compiler's command and version, for the user.
    pub fn description(&self) -> String {
        let version = self.version.lines().next().unwrap_or_default();
        format!("{} ({})", self.command.join(" "), version.trim())
    }

    /// Note for the user if this is the compiler of the [host], which is used only if there is no other.
    pub fn note(&self) -> Option<String> {
        let language = self.language.name();
        self.is_zig
            .then(|| format!("no {language} compiler of the system is found: `{}` is used\n", self.command.join(" ")))
    }

    /// A command that runs this compiler, with messages in English and without anything that differs from run to run.
    pub fn command(&self) -> Command {
        let mut command = Command::new(&self.command[0]);
        command.args(&self.command[1..]).env("LC_ALL", "C").env_remove("LANGUAGE").stdin(Stdio::null());
        if std::env::var_os("SOURCE_DATE_EPOCH").is_none() {
            // `__DATE__` would make the output of a program depend on the day of its build.
            command.env("SOURCE_DATE_EPOCH", "0");
        }
        command
    }

    /// Text that identifies this compiler: its command, the resolved path of the command, and its version text.
    pub fn identity(&self) -> String {
        let program = which(&self.command[0]).unwrap_or_else(|| self.command[0].clone().into());
        format!("{:?}\n{}\n{}", self.command, program.display(), self.version)
    }

    /// Folders of the compiler's installation, which it needs in addition to the system's folders.
    pub fn folders(&self) -> Vec<PathBuf> {
        self.command.first().and_then(|name| which(name)).map_or_else(Vec::new, |program| tool_folders(&program))
    }

    /// Flags of a compilation to an object file, except the standard.
    pub fn compile_flags(&self) -> impl Iterator<Item = &str> {
        let flags = c::COMPILE_FLAGS.iter().chain(COMPILE_FLAGS).copied();
        flags.chain(self.optional_compile_flags.iter().map(String::as_str))
    }

    /// Flags of the newest standard that the compiler supports, and of older ones for sources that the newest refuses.
    pub fn standards(&self) -> impl Iterator<Item = &str> {
        let older = match self.language {
            Language::C => OLD_C_STANDARDS,
            Language::Cpp => OLD_CPP_STANDARDS,
        };
        iter::once(self.newest_standard.as_str()).chain(older.iter().copied())
    }

    /// Flags of the link that precede the object files; [`robios_sys::c::LIBRARIES`] follow these files.
    pub fn link_flags(&self) -> impl Iterator<Item = &str> {
        c::LINK_FLAGS
            .iter()
            .chain(self.library_flags())
            .copied()
            .chain(self.optional_link_flags.iter().map(String::as_str))
    }

    /// Flags of the link for the language's own library.
    fn library_flags(&self) -> &'static [&'static str] {
        match self.language {
            Language::C => &[],
            Language::Cpp => c::CPP_LINK_FLAGS,
        }
    }

    fn probe(&mut self, cache: &Cache) -> Result<(), CompilerError> {
        let base: (Vec<&str>, Vec<&str>) = (self.compile_flags().collect(), self.link_flags().collect());
        let optional = optional_compile_flags(self.language);
        let standards = standards(self.language);
        let flags_text = format!("{base:?}{optional:?}{standards:?}{OPTIONAL_LINK_FLAGS:?}");
        let digest = blake3::hash(format!("{}\n{flags_text}", self.identity()).as_bytes());
        let key = format!("compiler-{}", &digest.to_hex()[..32]);
        let cached: Option<(Vec<String>, Vec<String>, String)> =
            cache.note(&key).and_then(|note| serde_json::from_str(&note).ok());
        if let Some((compile, link, standard)) = cached {
            (self.optional_compile_flags, self.optional_link_flags, self.newest_standard) = (compile, link, standard);
            return Ok(());
        }
        let folder = cache.build_folder()?;
        let (name, text) = match self.language {
            Language::C => ("probe.c", "int eyesim_probe(void) { return 0; }\n"),
            Language::Cpp => ("probe.cpp", "#include <string>\nstd::string eyesim_probe() { throw 1; }\n"),
        };
        std::fs::write(folder.path().join(name), text)?;
        let (compile, link) = base;
        let compile: Vec<&str> = compile.into_iter().chain(["-Werror", "-c", name, "-o", "probe.o"]).collect();
        let mut newest = String::new();
        for &standard in standards {
            newest = self.accepted_flags(folder.path(), &compile, &[standard])?.pop().unwrap_or_default();
            if !newest.is_empty() {
                break;
            }
        }
        let compile = self.accepted_flags(folder.path(), &compile, optional)?;
        let link: Vec<&str> = link.into_iter().chain(["probe.o", "-o", "probe.so", "-lm"]).collect();
        let link = self.accepted_flags(folder.path(), &link, OPTIONAL_LINK_FLAGS).map_err(|error| match error {
            CompilerError::Unusable { command, output, .. } if self.links_with_shared_library(folder.path()) => {
                CompilerError::NoStaticLibrary { command, output }
            }
            error => error,
        })?;
        let note = serde_json::to_string(&(&compile, &link, &newest)).map_err(io::Error::from)?;
        (self.optional_compile_flags, self.optional_link_flags, self.newest_standard) = (compile, link, newest);
        Ok(cache.set_note(&key, &note)?)
    }

    /// Returns true if the probe file links with the shared C++ library.
    fn links_with_shared_library(&self, folder: &Path) -> bool {
        let mut command = self.command();
        command.current_dir(folder).args(c::LINK_FLAGS).args(["probe.o", "-o", "probe.so"]);
        self.language == Language::Cpp
            && build_output(&mut command, COMMAND_TIMEOUT).is_ok_and(|output| output.status.success())
    }

    /// The flags of `candidates` that the compiler accepts in a call with the flags `base`. All candidates are tried
    /// together; if the compiler refuses them, they are tried one by one.
    fn accepted_flags(&self, folder: &Path, base: &[&str], candidates: &[&str]) -> Result<Vec<String>, CompilerError> {
        let run = |flags: &[&str]| -> io::Result<Result<(), String>> {
            let output = build_output(self.command().current_dir(folder).args(flags).args(base), COMMAND_TIMEOUT)?;
            // GNU ld only warns about an unknown `-z` keyword.
            let messages = String::from_utf8_lossy(&output.stderr).into_owned();
            let is_accepted = output.status.success() && (flags.is_empty() || !messages.contains("warning"));
            Ok(if is_accepted { Ok(()) } else { Err(messages) })
        };
        if run(candidates)?.is_ok() {
            return Ok(candidates.iter().map(|&flag| flag.to_owned()).collect());
        }
        if let Err(output) = run(&[])? {
            let (language, command) = (self.language, self.command.join(" "));
            return Err(CompilerError::Unusable { language, command, output });
        }
        let mut accepted = Vec::new();
        for &flag in candidates {
            if run(&[flag])?.is_ok() {
                accepted.push(flag.to_owned());
            }
        }
        Ok(accepted)
    }
}

/// Tries the usual commands of `language`, then `zig`; returns the first command that prints its version, and this
/// version.
fn first_working(
    language: Language,
    zig: Option<&Vec<String>>,
    cache: &Cache,
) -> Result<(Vec<String>, String), CompilerError> {
    let mut missing = CompilerError::Missing { language };
    for command in language.commands().iter().map(|&name| vec![name.to_owned()]).chain(zig.cloned()) {
        match version_of(&command, cache) {
            Ok(version) => return Ok((command, version)),
            Err(error) if error.kind() == io::ErrorKind::TimedOut => {
                missing = CompilerError::Silent { language, command: command.join(" "), error };
            }
            Err(_) => {}
        }
    }
    Err(missing)
}

/// The command of the [host]'s zig, for systems without another compiler. It runs clang; its default check for
/// undefined behaviour is turned off, since it would stop programs that run with other compilers.
fn zig(language: Language) -> Option<Vec<String>> {
    let zig = host::current().map(|host| &host.zig).filter(|zig| !zig.is_empty())?;
    let subcommand = match language {
        Language::C => "cc",
        Language::Cpp => "c++",
    };
    let words = zig.iter().map(String::as_str).chain([subcommand, "-fno-sanitize=undefined"]);
    Some(words.map(str::to_owned).collect())
}

/// The version text of a compiler: from `cache` if the compiler's file has not changed since the last query.
fn version_of(command: &[String], cache: &Cache) -> io::Result<String> {
    let known = version_key(command).and_then(|key| cache.note(&key));
    known.map_or_else(|| query_version(command), Ok)
}

/// The key in the cache of a compiler's version text, if its [state](file_state) is known.
fn version_key(command: &[String]) -> Option<String> {
    file_state(command).map(|state| format!("version-{}", &blake3::hash(state.as_bytes()).to_hex()[..32]))
}

/// The command with path, size, times and inode of its file. `None` unless the file is gcc, clang or zig itself: a
/// script or a launcher such as ccache may start a changed compiler although its own file has not changed.
fn file_state(command: &[String]) -> Option<String> {
    use std::os::unix::fs::MetadataExt as _;
    let path = which(command.first()?)?;
    let name = path.file_name()?.to_str()?;
    let mut magic = [0; 4];
    io::Read::read_exact(&mut std::fs::File::open(&path).ok()?, &mut magic).ok()?;
    let is_compiler = name == "zig" || ["gcc", "g++", "clang"].iter().any(|compiler| name.contains(compiler));
    if !is_compiler || magic != *b"\x7fELF" {
        return None;
    }
    let file = std::fs::metadata(&path).ok()?;
    let times = [file.mtime(), file.mtime_nsec(), file.ctime(), file.ctime_nsec()];
    Some(format!("{command:?} {} {} {} {times:?}", path.display(), file.len(), file.ino()))
}

fn query_version(command: &[String]) -> io::Result<String> {
    let (program, arguments) =
        command.split_first().ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "no command"))?;
    let mut command = Command::new(program);
    let output = build_output(command.args(arguments).arg("--version").env("LC_ALL", "C"), COMMAND_TIMEOUT)?;
    if !output.status.success() {
        let messages = String::from_utf8_lossy(&output.stderr);
        return Err(io::Error::other(format!("`--version` gives {}: {}", output.status, messages.trim())));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// The folders of the installation of `program`, such as `bin/python3`: its own folder, and the folders of its
/// libraries next to it.
pub(super) fn tool_folders(program: &Path) -> Vec<PathBuf> {
    let folder = program.parent().unwrap_or(Path::new("/"));
    let installation = folder.parent().unwrap_or(folder);
    let beside = ["lib", "lib64", "libexec", "include", "pyvenv.cfg"].map(|name| installation.join(name));
    std::iter::once(folder.to_owned()).chain(beside).collect()
}

/// The path of the command `name`, with links resolved: a name with a `/` is itself a path; other names are searched on
/// the search path. `None` if there is no such executable file.
pub(super) fn which(name: &str) -> Option<std::path::PathBuf> {
    if name.contains('/') {
        return std::fs::canonicalize(name).ok();
    }
    let path: OsString = std::env::var_os("PATH")?;
    let is_executable = |path: &std::path::PathBuf| {
        use std::os::unix::fs::PermissionsExt as _;
        std::fs::metadata(path).is_ok_and(|file| file.is_file() && file.permissions().mode() & 0o111 != 0)
    };
    let found = std::env::split_paths(&path).map(|folder| folder.join(name)).find(is_executable)?;
    std::fs::canonicalize(found).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn versions_are_cached_only_for_files_of_compilers() {
        use std::os::unix::fs::PermissionsExt as _;
        let folder = tempfile::tempdir().expect("a folder");
        let cache = Cache::open(&folder.path().join("cache")).expect("a cache");
        let script = folder.path().join("gcc");
        let write = |version: &str| {
            std::fs::write(&script, format!("#!/bin/sh\necho {version}\n")).expect("a script");
            std::fs::set_permissions(&script, std::fs::Permissions::from_mode(0o755)).expect("an executable script");
        };
        let command = [script.display().to_string()];
        for version in ["1.0", "2.0"] {
            write(version);
            assert_eq!(version_of(&command, &cache).expect("a version").trim(), version);
        }
        assert_eq!(file_state(&["sh".to_owned()]), None, "no compiler");
        assert_eq!(file_state(&["no-such-command".to_owned()]), None);
        let executable = std::env::current_exe().expect("this program");
        let binary = folder.path().join("clang-99");
        std::fs::copy(executable, &binary).expect("a binary");
        let command = [binary.display().to_string()];
        let initial_state = file_state(&command).expect("its own file");
        assert_eq!(file_state(&command).as_ref(), Some(&initial_state));
        std::fs::write(&binary, b"\x7fELF and something else").expect("another binary");
        assert_ne!(file_state(&command), Some(initial_state));
    }
}
