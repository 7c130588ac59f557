//! The system's C compiler: which one, how it is called, which of the wanted flags it knows.

use std::ffi::OsString;
use std::io;
use std::path::Path;
use std::process::{Command, Stdio};

use robios_sys::c;

use super::cache::Cache;
use super::words::split_words;

/// Flags of every compilation of a robot program behind [`robios_sys::c::COMPILE_FLAGS`], understood by every gcc and
/// clang.
///
/// | flag | why |
/// |---|---|
/// | `-std=gnu17` | K&R functions and `bool` as a name still compile; newer standards refuse both |
/// | `-O2` | image and map code in loops; `-O0` gives the same results, add it to step through a program |
/// | `-fsigned-char` | `char` is signed as on the robot's processor, also on ARM |
/// | `-fwrapv`, `-fno-delete-null-pointer-checks` | old C does what it did: overflow wraps, and a null pointer faults where it is used |
/// | `-fno-omit-frame-pointer` | the call stack can be walked after a fault |
/// | `-Wall`, `-Wmain` | a student wants to know; `-Wmain` also tells that `main` returns nothing |
pub const COMPILE_FLAGS: &[&str] = &[
    "-std=gnu17",
    "-O2",
    "-fsigned-char",
    "-fwrapv",
    "-fno-delete-null-pointer-checks",
    "-fno-omit-frame-pointer",
    "-Wall",
    "-Wmain",
];

/// Flags that are used where the compiler knows them: the first group lets old C compile with compilers that made these
/// warnings errors (gcc 14, clang 16), then probed stacks (a big local array hits the guard page and not what lies
/// behind it).
const OPTIONAL_COMPILE_FLAGS: &[&str] = &[
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
];

/// Flags of the link that are used where the linker knows them: both halve the memory mappings of a private copy, of
/// which each robot has one.
const OPTIONAL_LINK_FLAGS: &[&str] = &["-Wl,-z,noseparate-code", "-Wl,-z,norelro"];

/// A C compiler that was found, with its flags.
#[derive(Clone, Debug)]
pub struct Compiler {
    command: Vec<String>,
    version: String,
    optional_compile_flags: Vec<String>,
    optional_link_flags: Vec<String>,
}

/// No C compiler, or none that works.
#[derive(Debug, thiserror::Error)]
pub enum CompilerError {
    /// `$CC` is not set and none of the usual names is on the search path.
    #[error(
        "no C compiler is found (tried {tried}): install one (Debian and Ubuntu: `apt install gcc libc6-dev`), or set \
         $CC to its name"
    )]
    Missing {
        /// The commands tried, quoted.
        tried: String,
    },
    /// The command in `$CC` does not start.
    #[error("the C compiler `{command}` set in $CC does not run: {error}")]
    Broken {
        /// What `$CC` says.
        command: String,
        /// Why it does not run.
        error: String,
    },
    /// A compiler that starts and cannot compile an empty file, or a link without the C library's development files.
    #[error(
        "the C compiler `{command}` cannot build a library (on Debian and Ubuntu `apt install gcc libc6-dev` gives what \
         it needs):\n{output}"
    )]
    Unusable {
        /// The compiler's command.
        command: String,
        /// What it printed.
        output: String,
    },
    /// A file of the probe cannot be written.
    #[error("cannot try the C compiler: {0}")]
    Io(#[from] io::Error),
}

impl Compiler {
    /// The compiler that `cc` (the value of `$CC`, which may carry arguments) names, else `cc`, `gcc` or `clang`.
    ///
    /// Which optional flags it knows is tried once and kept in `cache`.
    ///
    /// # Errors
    /// [`CompilerError`] if there is none or it does not work.
    pub fn find(cc: Option<&str>, cache: &Cache) -> Result<Self, CompilerError> {
        let (command, version) = match cc.map(str::trim).filter(|cc| !cc.is_empty()) {
            Some(cc) => {
                let broken = |error: String| CompilerError::Broken { command: cc.to_owned(), error };
                let command = split_words(cc).map_err(|error| broken(error.to_string()))?;
                let version = version_of(&command).map_err(|error| broken(error.to_string()))?;
                (command, version)
            }
            None => ["cc", "gcc", "clang"]
                .into_iter()
                .map(|name| vec![name.to_owned()])
                .find_map(|command| Some((command.clone(), version_of(&command).ok()?)))
                .ok_or_else(|| CompilerError::Missing { tried: "`cc`, `gcc`, `clang`".into() })?,
        };
        let mut compiler =
            Self { command, version, optional_compile_flags: Vec::new(), optional_link_flags: Vec::new() };
        compiler.probe(cache)?;
        Ok(compiler)
    }

    /// A command that runs this compiler, its messages in English and free of anything that differs from run to run.
    pub fn command(&self) -> Command {
        let mut command = Command::new(&self.command[0]);
        command.args(&self.command[1..]).env("LC_ALL", "C").env_remove("LANGUAGE").stdin(Stdio::null());
        if std::env::var_os("SOURCE_DATE_EPOCH").is_none() {
            // `__DATE__` would make what a program prints depend on the day it was built.
            command.env("SOURCE_DATE_EPOCH", "0");
        }
        command
    }

    /// What tells this compiler from another: its command, where that leads, what it says of its version.
    pub fn identity(&self) -> String {
        let program = which(&self.command[0]).unwrap_or_else(|| self.command[0].clone().into());
        format!("{:?}\n{}\n{}", self.command, program.display(), self.version)
    }

    /// The flags of a compilation to an object file.
    pub fn compile_flags(&self) -> impl Iterator<Item = &str> {
        c::COMPILE_FLAGS
            .iter()
            .chain(COMPILE_FLAGS)
            .copied()
            .chain(self.optional_compile_flags.iter().map(String::as_str))
    }

    /// The flags of the link, before the object files; [`robios_sys::c::LIBRARIES`] go behind them.
    pub fn link_flags(&self) -> impl Iterator<Item = &str> {
        c::LINK_FLAGS.iter().copied().chain(self.optional_link_flags.iter().map(String::as_str))
    }

    fn probe(&mut self, cache: &Cache) -> Result<(), CompilerError> {
        let base: (Vec<&str>, Vec<&str>) = (self.compile_flags().collect(), self.link_flags().collect());
        let wanted = format!("{base:?}{OPTIONAL_COMPILE_FLAGS:?}{OPTIONAL_LINK_FLAGS:?}");
        let digest = blake3::hash(format!("{}\n{wanted}", self.identity()).as_bytes());
        let key = format!("compiler-{}", &digest.to_hex()[..32]);
        let kept: Option<(Vec<String>, Vec<String>)> =
            cache.note(&key).and_then(|note| serde_json::from_str(&note).ok());
        if let Some((compile, link)) = kept {
            (self.optional_compile_flags, self.optional_link_flags) = (compile, link);
            return Ok(());
        }
        let folder = cache.build_folder()?;
        std::fs::write(folder.path().join("empty.c"), "int eyesim_probe(void) { return 0; }\n")?;
        let (compile, link) = base;
        let compile: Vec<&str> = compile.into_iter().chain(["-Werror", "-c", "empty.c", "-o", "empty.o"]).collect();
        let compile = self.accepted(folder.path(), &compile, OPTIONAL_COMPILE_FLAGS)?;
        let link: Vec<&str> = link.into_iter().chain(["empty.o", "-o", "empty.so", "-lm"]).collect();
        let link = self.accepted(folder.path(), &link, OPTIONAL_LINK_FLAGS)?;
        (self.optional_compile_flags, self.optional_link_flags) = (compile, link);
        cache.set_note(
            &key,
            &serde_json::to_string(&(&self.optional_compile_flags, &self.optional_link_flags))
                .map_err(io::Error::from)?,
        )?;
        Ok(())
    }

    /// Those of `wanted` with which the call with `base` works: all at once, or found out one by one.
    fn accepted(&self, folder: &Path, base: &[&str], wanted: &[&str]) -> Result<Vec<String>, CompilerError> {
        let run = |flags: &[&str]| -> io::Result<Result<(), String>> {
            let output = self.command().current_dir(folder).args(flags).args(base).output()?;
            // GNU ld only warns of a `-z` keyword that it does not know.
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            let accepted = output.status.success() && (flags.is_empty() || !said.contains("warning"));
            Ok(if accepted { Ok(()) } else { Err(said) })
        };
        if run(wanted)?.is_ok() {
            return Ok(wanted.iter().map(|&flag| flag.to_owned()).collect());
        }
        if let Err(output) = run(&[])? {
            return Err(CompilerError::Unusable { command: self.command.join(" "), output });
        }
        let mut accepted = Vec::new();
        for &flag in wanted {
            if run(&[flag])?.is_ok() {
                accepted.push(flag.to_owned());
            }
        }
        Ok(accepted)
    }
}

fn version_of(command: &[String]) -> io::Result<String> {
    let (program, arguments) =
        command.split_first().ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "no command"))?;
    let output =
        Command::new(program).args(arguments).arg("--version").env("LC_ALL", "C").stdin(Stdio::null()).output()?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(io::Error::other(format!("`--version` gives {}: {}", output.status, said.trim())));
    }
    Ok(String::from_utf8_lossy(&output.stdout).into_owned())
}

/// Where on the search path the command `name` is, links followed.
fn which(name: &str) -> Option<std::path::PathBuf> {
    if name.contains('/') {
        return std::fs::canonicalize(name).ok();
    }
    let path: OsString = std::env::var_os("PATH")?;
    std::env::split_paths(&path).find_map(|folder| std::fs::canonicalize(folder.join(name)).ok())
}
