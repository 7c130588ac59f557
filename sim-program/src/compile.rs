//! Compiles and links C and C++ sources into the library of one robot program.

use std::fs;
use std::io;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{LazyLock, OnceLock};

use robios_sys::c;

use super::cache::Cache;
use super::command::{COMMAND_TIMEOUT, CommandLimits, TIMEOUT_VARIABLE, build_timeout, output_within};
use super::compiler::Compiler;
use super::constructors::defer_constructors;
use super::generation::{Generation, is_robios_header};
use super::hint;
use super::inline::{InlineRule, inline_functions};
use super::language::Language;
use super::plain::{in_plain_words, missing_cpp_headers, without_harmless_warnings};
use super::sandbox::scratch::Quota;
use super::sandbox::{Grant, Role, Sandbox};

/// Source texts for every C or C++ program: the headers that it may include, and the shim that is linked to it.
#[derive(Clone, Debug)]
pub struct ShimKit {
    /// Headers: file name and text.
    pub headers: Vec<(&'static str, &'static str)>,
    /// The shim's files: file name and text; the first file is compiled.
    pub shim: Vec<(&'static str, &'static str)>,
    /// Compiler flags of the shim.
    pub shim_flags: &'static [&'static str],
    /// The digest, computed lazily.
    pub(super) digest: OnceLock<String>,
}

impl ShimKit {
    /// The kit of a generation.
    pub fn of(generation: Generation) -> Self {
        let headers = match generation {
            Generation::Robios6 => c::HEADERS6,
            Generation::Robios7 => c::HEADERS7,
        };
        let texts = |files: &'static [c::SourceFile]| files.iter().map(|file| (file.name, file.text)).collect();
        let mut shim: Vec<_> = texts(c::SHIM);
        shim.sort_by_key(|(name, _)| *name != c::SHIM_SOURCE);
        Self { headers: texts(headers), shim, shim_flags: c::SHIM_FLAGS, digest: OnceLock::new() }
    }

    /// A digest of everything in the kit, in hex.
    pub fn digest(&self) -> &str {
        self.digest.get_or_init(|| self.hash())
    }

    fn hash(&self) -> String {
        let mut hasher = blake3::Hasher::new();
        for (name, text) in self.headers.iter().chain(&self.shim) {
            hasher.update(format!("{name}\0{}\0{text}\0", text.len()).as_bytes());
        }
        let flags = (self.shim_flags, c::CPP_FLAGS, c::CPP_SHIM_FLAGS);
        hasher.update(format!("{flags:?}").as_bytes());
        hasher.finalize().to_hex()[..32].to_owned()
    }
}

/// Selects the kit with which a program is built.
#[derive(Clone, Debug)]
pub enum Kits {
    /// The kit of the program's generation.
    ByGeneration,
    /// This kit, for both generations.
    Only(ShimKit),
}

impl Kits {
    /// The kits of both generations.
    pub fn of_robios() -> Self {
        Self::ByGeneration
    }

    /// The kit for programs of a generation.
    pub fn of(&self, generation: Generation) -> &ShimKit {
        static ROBIOS6: LazyLock<ShimKit> = LazyLock::new(|| ShimKit::of(Generation::Robios6));
        static ROBIOS7: LazyLock<ShimKit> = LazyLock::new(|| ShimKit::of(Generation::Robios7));
        match (self, generation) {
            (Self::Only(kit), _) => kit,
            (Self::ByGeneration, Generation::Robios6) => &ROBIOS6,
            (Self::ByGeneration, Generation::Robios7) => &ROBIOS7,
        }
    }
}

/// One library to build.
#[derive(Debug)]
pub struct Compilation<'a> {
    /// The compilers: one for each language of the sources, and always the C compiler, for the shim.
    pub compilers: &'a [&'a Compiler],
    /// The generation of RoBIOS to which the kit belongs.
    pub generation: Generation,
    /// The kit, whose files are in `kit_folder`.
    pub kit: &'a ShimKit,
    /// Folder of the kit's files: headers in `include/`, the shim in `shim/`.
    pub kit_folder: &'a Path,
    /// Absolute paths of the sources; the extension of each determines its language.
    pub sources: &'a [PathBuf],
    /// Further compiler flags of the user; they follow all other flags. Those of libraries (`-l`, `-L`, `-Wl,`) are
    /// flags of the link.
    pub extra_flags: &'a [String],
    /// Folder for object files and the library.
    pub folder: &'a Path,
    /// Cache with the shims' object files.
    pub cache: &'a Cache,
    /// Restrictions of the compilers, which may read the folder of the first source and the kit, and write to the
    /// folder of the compilation.
    pub sandbox: Option<&'a Sandbox>,
}

/// Result of a compilation.
#[derive(Debug)]
pub struct Compiled {
    /// The library, in the folder of the compilation.
    pub library: PathBuf,
    /// The compiler's warnings, with our remarks and explanations.
    pub output: String,
    /// Absolute paths of all files that the compiler has read: the sources and their headers.
    pub read_files: Vec<PathBuf>,
    /// Commands of the build, one per line: those that ran, and those of shims that the cache already holds.
    pub commands: String,
}

/// Sources that cannot be compiled or linked.
#[derive(Debug, thiserror::Error)]
pub enum CompileError {
    /// The compiler refuses a source; our hints precede its messages, from which harmless warnings are removed.
    #[error("{hints}`{}` does not compile (paths below are seen from `{}`):\n{output}", source_file.display(), folder.display())]
    Refused {
        /// The source.
        source_file: PathBuf,
        /// The folder the compiler ran in.
        folder: PathBuf,
        /// Messages of the compiler.
        output: String,
        /// Possible causes, one per line.
        hints: String,
    },
    /// Functions or variables are used but not defined, or are defined twice.
    #[error("{}", unlinked(program, output, hints))]
    Unlinked {
        /// The first source.
        program: PathBuf,
        /// Messages of the linker.
        output: String,
        /// Possible causes, one per line.
        hints: String,
    },
    /// A file cannot be written, or the compiler cannot be started.
    #[error("cannot build `{}`: {error}", program.display())]
    Io {
        /// The first source.
        program: PathBuf,
        /// The system's error.
        error: io::Error,
    },
}

/// Message about a program that does not link: the hints, then the linker's messages unless the hints explain them.
fn unlinked(program: &Path, output: &str, hints: &str) -> String {
    let linker_message = format!("`{}` does not link:\n{output}", program.display());
    match hints.trim_end() {
        "" => linker_message,
        hints if hint::is_explained(output) => hints.to_owned(),
        hints => format!("{hints}\n{linker_message}"),
    }
}

impl<'a> Compilation<'a> {
    /// Compiles each source, then the shims, then links. The first attempt uses the newest standard and our headers; if
    /// the compiler refuses a source, the variants that older sources need are tried.
    ///
    /// The compiler runs in the folder of the first source and gets sources by their names relative to that folder, so
    /// that `__FILE__` is independent of the working folder.
    ///
    /// # Errors
    /// [`CompileError`] of the first variant that the compiler accepts but the linker does not; if the compiler refuses
    /// all variants, of the first attempt.
    pub fn run(&self) -> Result<Compiled, CompileError> {
        let hidden = self.hidden_headers();
        let first_attempt = self.try_run(&CompileVariant { hidden: &hidden, ..CompileVariant::default() });
        let result = match first_attempt {
            Err(Failure::Refused { source_file, output }) => {
                let variants = self.other_variants(&hidden, &output);
                let mut attempts = variants.iter().map(|variant| (variant, self.try_run(variant)));
                match attempts.find(|(_, result)| !matches!(result, Err(Failure::Refused { .. }))) {
                    Some((variant, Ok(mut compiled))) if variant.hidden.len() < hidden.len() => {
                        compiled.output.insert_str(0, &self.remark_on_own_headers(&hidden, &source_file, &output));
                        Ok(compiled)
                    }
                    Some((_, result)) => result,
                    None => Err(Failure::Refused { source_file, output }),
                }
            }
            result => result,
        };
        let program = self.sources.first().cloned().unwrap_or_default();
        result.map_err(|failure| match failure {
            Failure::Refused { source_file, output } => {
                let output = without_harmless_warnings(&output);
                let hints = hint::compile_hints(&output, &source_file, self.generation);
                let folder = self.source_folder().to_owned();
                CompileError::Refused { source_file, folder, output, hints }
            }
            Failure::Unlinked { output } => {
                let hints = hint::link_hints(&output, &self.objects(), self.generation);
                CompileError::Unlinked { program, output, hints }
            }
            Failure::Io(error) => CompileError::Io { program, error },
        })
    }

    /// Message about headers of the program that are used instead of ours, with the compiler's `refusal` of ours: one
    /// line.
    fn remark_on_own_headers(&self, headers: &[PathBuf], source: &Path, refusal: &str) -> String {
        let names = headers.iter().map(|path| path.file_name().unwrap_or_default().display().to_string());
        let text = fs::read(source).unwrap_or_default();
        let name = self.name_in_source_folder(source).display().to_string();
        let words = in_plain_words(refusal, (&name, &String::from_utf8_lossy(&text)));
        let reason = words.lines().next().or_else(|| refusal.lines().find(|line| line.contains("error: ")));
        format!(
            "{} beside the program is used, and may differ from the functions that run, since eyesim's does not fit: {}\n",
            hint::quoted(&names.collect::<Vec<_>>()),
            reason.unwrap_or_default()
        )
    }

    /// Further variants to try after the compiler has refused a source with the message `output`.
    fn other_variants<'m>(&self, hidden: &'m [PathBuf], output: &str) -> Vec<CompileVariant<'m>> {
        let oldest = match self.language() {
            Language::C => 0,
            Language::Cpp => 1 + usize::from(hint::is_refused_since_cpp17(output)),
        };
        let may_be_lean = self.generation == Generation::Robios7 && hint::is_collision(output);
        let mut variants = vec![CompileVariant { hidden, ..CompileVariant::default() }];
        for hidden in [hidden, &[]] {
            for is_lean in [false, may_be_lean] {
                for age in 0..=oldest {
                    let variant = CompileVariant { age, is_lean, hidden, ..CompileVariant::default() };
                    if !variants.contains(&variant) {
                        variants.push(variant);
                    }
                }
            }
        }
        variants.split_off(1)
    }

    /// RoBIOS headers of any version in the folder of the first source; they would take precedence over ours.
    fn hidden_headers(&self) -> Vec<PathBuf> {
        let beside = self.kit.headers.iter().map(|(name, _)| self.source_folder().join(name));
        beside.filter(|path| is_robios_header(path)).collect()
    }

    /// A folder with links to all files of the source folder except the hidden headers.
    fn folder_without(&self, hidden: &[PathBuf]) -> io::Result<PathBuf> {
        let folder = self.folder.join("sources");
        if !folder.exists() {
            fs::create_dir(&folder)?;
            for entry in fs::read_dir(self.source_folder())? {
                let path = entry?.path();
                if !hidden.contains(&path) {
                    symlink(&path, folder.join(path.file_name().unwrap_or_default()))?;
                }
            }
        }
        Ok(folder)
    }

    /// The sources, each with its object file.
    fn objects(&self) -> Vec<(&'a Path, PathBuf)> {
        let object = |(index, source): (usize, &'a PathBuf)| (source.as_path(), self.object(index));
        self.sources.iter().enumerate().map(object).collect()
    }

    /// The object file of the source with this index.
    fn object(&self, index: usize) -> PathBuf {
        self.folder.join(format!("{index}.o"))
    }

    fn source_folder(&self) -> &Path {
        let folder = self.sources.first().and_then(|source| source.parent());
        folder.unwrap_or(Path::new("/"))
    }

    /// Compiles and links one variant. If `inline` functions do not link by the rules of C99, older rules are tried.
    fn try_run(&self, variant: &CompileVariant<'_>) -> Result<Compiled, Failure> {
        let result = self.try_inline_rule(variant);
        let Err(Failure::Unlinked { output }) = &result else { return result };
        let inline = inline_functions(self.sources);
        let mut names = hint::unlinked_names(output);
        for inline_rule in [InlineRule::Gnu89, InlineRule::Gnu89Merged] {
            let is_cause = match inline_rule {
                InlineRule::Gnu89Merged => !names.is_empty() && names.iter().all(|name| inline.contains(name)),
                _ => names.iter().any(|name| inline.contains(name)),
            };
            if !is_cause {
                break;
            }
            match self.try_inline_rule(&CompileVariant { inline_rule, ..*variant }) {
                Ok(compiled) => return Ok(compiled),
                Err(Failure::Unlinked { output }) => names = hint::unlinked_names(&output),
                Err(_) => break,
            }
        }
        result
    }

    fn try_inline_rule(&self, variant: &CompileVariant<'_>) -> Result<Compiled, Failure> {
        let mut compiled = Compiled {
            library: self.folder.join("program.so"),
            output: variant.remark(),
            read_files: variant.hidden.to_vec(),
            commands: String::new(),
        };
        let mut objects = Vec::new();
        let mut void_main = false;
        for (index, source) in self.sources.iter().enumerate() {
            let (object, output) = self.compile_source(index, source, variant, &mut compiled)?;
            void_main |= returns_nothing_from_main(&output);
            let text = fs::read(source)?;
            compiled.output.push_str(&remark_on_encoding(source, &text));
            let output = without_harmless_warnings(&output);
            let name = self.name_in_source_folder(source).display().to_string();
            compiled.output.push_str(&in_plain_words(&output, (&name, &String::from_utf8_lossy(&text))));
            compiled.output.push_str(&output);
            objects.push(object);
        }
        let language = self.language();
        let mut flags = self.kit.shim_flags.to_vec();
        flags.extend(void_main.then_some(c::VOID_MAIN_FLAG));
        if language == Language::Cpp {
            flags.extend(c::CPP_FLAGS);
            objects.push(self.compile_shim(Language::Cpp, c::CPP_SHIM_SOURCE, c::CPP_SHIM_FLAGS, &mut compiled)?);
        }
        let name = self.kit.shim.first().map_or("", |(name, _)| name);
        objects.push(self.compile_shim(Language::C, name, &flags, &mut compiled)?);
        self.link(language, &objects, variant.inline_rule, &mut compiled)?;
        defer_constructors(&compiled.library)?;
        compiled.read_files.sort();
        compiled.read_files.dedup();
        Ok(compiled)
    }

    /// The language of the program: C++ if any source is C++.
    fn language(&self) -> Language {
        self.sources.iter().filter_map(|source| Language::of(source)).max().unwrap_or(Language::C)
    }

    fn compiler(&self, language: Language) -> Result<&Compiler, Failure> {
        let compiler = self.compilers.iter().find(|compiler| compiler.language() == language);
        compiler.copied().ok_or_else(|| Failure::Io(io::Error::other(format!("no compiler of {}", language.name()))))
    }

    /// Compiles a source; returns its object file and the output of the compiler.
    fn compile_source(
        &self,
        index: usize,
        source: &Path,
        variant: &CompileVariant<'_>,
        compiled: &mut Compiled,
    ) -> Result<(PathBuf, String), Failure> {
        let object = self.object(index);
        let first_result = self.compile_to(&object, source, variant, &[], compiled);
        let undeclared = match &first_result {
            Ok(output) => hint::undeclared_functions(output),
            Err(Failure::Refused { output, .. }) => hint::undeclared_constants(output),
            Err(_) => Vec::new(),
        };
        let cpp_headers = match &first_result {
            Err(Failure::Refused { output, .. }) if Language::of(source) == Some(Language::Cpp) => {
                missing_cpp_headers(output)
            }
            _ => Vec::new(),
        };
        let first_result = first_result.map(|output| (object, output));
        if undeclared.is_empty() && cpp_headers.is_empty() {
            return first_result;
        }
        // Calls of undeclared functions may pass arguments of wrong types, so the missing headers are included.
        let with_headers = self.folder.join(format!("{index}-with-headers.o"));
        let needs_robios_header = undeclared.iter().any(|name| self.generation.has_function(name));
        let needs_truth = undeclared.iter().any(|name| c::TRUTH.contains(&name.as_str()));
        let needs_old_names = undeclared.iter().any(|name| c::OLD_NAMES.contains(&name.as_str()));
        let headers = [
            (!undeclared.is_empty()).then_some(c::C_LIBRARY_HEADER),
            needs_truth.then_some(c::TRUTH_HEADER),
            needs_old_names.then_some(c::OLD_NAMES_HEADER),
            needs_robios_header.then_some("eyebot.h"),
        ];
        let path = |header| self.kit_folder.join("include").join(header);
        let headers = headers.into_iter().flatten().map(path).chain(cpp_headers.iter().map(PathBuf::from));
        let headers: Vec<PathBuf> = headers.collect();
        match self.compile_to(&with_headers, source, variant, &headers, compiled) {
            Ok(second_output) => {
                let still_undeclared = hint::undeclared_functions(&second_output);
                let declared: Vec<&String> =
                    undeclared.iter().filter(|name| !still_undeclared.contains(name)).collect();
                if declared.is_empty() && cpp_headers.is_empty() {
                    return first_result;
                }
                let name = source.file_name().unwrap_or_default().display();
                let (robios_names, other_names): (Vec<&String>, Vec<&String>) =
                    declared.into_iter().partition(|name| self.generation.has_function(name));
                let missing = "it was added for this run: write it as the first line\n";
                let cpp_remark = |header| format!("{name}: `#include <{header}>` is missing; {missing}");
                let mut remark: String = cpp_headers.iter().map(cpp_remark).collect();
                if !robios_names.is_empty() {
                    remark += &format!("{name}: {}; {missing}", hint::MISSING_HEADER);
                }
                if !other_names.is_empty() {
                    let other_names = hint::quoted(&other_names);
                    remark += &format!(
                        "{name}: the headers that declare {other_names} are included, as it does not include them\n"
                    );
                }
                Ok((with_headers, remark + &second_output))
            }
            Err(Failure::Refused { .. }) => first_result,
            Err(failure) => Err(failure),
        }
    }

    /// Compiles a source to the file `object`, with these headers included first; returns the output of the compiler.
    fn compile_to(
        &self,
        object: &Path,
        source: &Path,
        variant: &CompileVariant<'_>,
        headers: &[PathBuf],
        compiled: &mut Compiled,
    ) -> Result<String, Failure> {
        let compiler = self.compiler(Language::of(source).unwrap_or(Language::C))?;
        let dependencies = object.with_extension("d");
        let mut command = self.compile_command(compiler);
        command.args(compiler.compile_flags()).args(compiler.standards().take(variant.age + 1).last());
        // A source beside hidden headers is compiled by its link. The compiler still runs in the source folder, to
        // which the paths in flags and in `#include "../map.h"` are relative.
        let mut links = PathBuf::new();
        if !variant.hidden.is_empty() {
            links = self.folder_without(variant.hidden)?;
            command.arg(format!("-ffile-prefix-map={}/=", links.display()));
            command.arg("-iquote").arg(self.kit_folder.join("include")).args(["-iquote", "."]);
        }
        let without_links = |output: String| output.replace(&*links.join("").to_string_lossy(), "");
        let inline_flag = variant.inline_rule.compile_flag().filter(|_| compiler.language() == Language::C);
        command.args(inline_flag).args(variant.is_lean.then_some(c::LEAN_FLAG));
        command.args(split_flags(self.extra_flags).0);
        for header in headers {
            command.arg("-include").arg(header);
        }
        command.arg("-MD").arg("-MF").arg(&dependencies).args(["-MT", "o"]);
        // By its extension, the compiler would take `MAIN.C` for C++.
        let language = if Language::of(source) == Some(Language::Cpp) { "c++" } else { "c" };
        command.args(["-x", language, "-c"]).arg(links.join(self.name_in_source_folder(source))).arg("-o").arg(object);
        let output = self
            .execute(compiled, compiler, &mut command, self.folder)?
            .map(without_links)
            .map_err(|output| Failure::Refused { source_file: source.to_owned(), output: without_links(output) })?;
        let listed = parse_dependencies(&fs::read_to_string(&dependencies)?);
        let paths = listed.iter().map(|path| path.strip_prefix(&links).unwrap_or(path));
        compiled.read_files.extend(paths.map(|path| self.source_folder().join(path)));
        Ok(output)
    }

    /// The object file of the shim's file `name`, which is independent of the program: compiled once for each kit and
    /// compiler.
    fn compile_shim(
        &self,
        language: Language,
        name: &str,
        flags: &[&str],
        compiled: &mut Compiled,
    ) -> Result<PathBuf, Failure> {
        let compiler = self.compiler(language)?;
        let folder = self.kit_folder.join("shim");
        let key = format!("shim {} {} {name} {flags:?}", self.kit.digest(), compiler.identity());
        let key = &blake3::hash(key.as_bytes()).to_hex()[..32];
        let mut command = compiler.command();
        // Debug information contains this folder, so that it must not depend on the program.
        command.current_dir(&folder).arg("-I").arg(self.kit_folder.join("include")).args(flags);
        command.arg("-c").arg(folder.join(name)).arg("-o");
        if let Some(entry) = self.cache.entry(key) {
            compiled.log_command(command.arg(&entry.library));
            return Ok(entry.library);
        }
        let build = self.cache.build_folder()?;
        let object = build.path().join("shim.o");
        command.arg(&object);
        let refused = |output| Failure::Refused { source_file: folder.join(name), output };
        self.execute(compiled, compiler, &mut command, build.path())?.map_err(refused)?;
        Ok(self.cache.insert(key, build, &object, "")?.library)
    }

    fn link(
        &self,
        language: Language,
        objects: &[PathBuf],
        inline_rule: InlineRule,
        compiled: &mut Compiled,
    ) -> Result<(), Failure> {
        let compiler = self.compiler(language)?;
        let mut command = compiler.command();
        command.current_dir(self.source_folder()).args(compiler.link_flags());
        if language == Language::Cpp {
            let exports = self.kit_folder.join("shim").join(c::CPP_EXPORTS);
            command.arg("-Xlinker").arg(format!("--version-script={}", exports.display()));
        }
        command.args(inline_rule.link_flag()).args(objects);
        command.args(split_flags(self.extra_flags).1).args(c::LIBRARIES).arg("-o").arg(&compiled.library);
        let output = self
            .execute(compiled, compiler, &mut command, self.folder)?
            .map_err(|output| Failure::Unlinked { output })?;
        compiled.output.push_str(&output);
        Ok(())
    }

    /// Runs a command of `compiler` that writes to the folder `scratch`; returns its output, or the output as an error
    /// if it failed.
    fn execute(
        &self,
        compiled: &mut Compiled,
        compiler: &Compiler,
        command: &mut Command,
        scratch: &Path,
    ) -> io::Result<Result<String, String>> {
        compiled.log_command(command);
        if let Some(sandbox) = self.sandbox {
            let mut readable = compiler.folders();
            readable.extend([self.source_folder(), self.kit_folder, self.folder].map(Path::to_owned));
            readable.extend(sandbox.root.clone());
            // The shims' object files are entries of the cache.
            readable.extend(command.get_args().map(PathBuf::from).filter(|path| path.starts_with(self.cache.root())));
            sandbox.apply(command, &Grant { role: Role::Build, readable, scratch })?;
        }
        let quota = self.sandbox.map(|sandbox| Quota::new(scratch.to_owned(), sandbox.build_limits.scratch));
        compiled.execute(command, quota.as_ref())
    }

    /// A command of `compiler` with the path of the headers.
    fn compile_command(&self, compiler: &Compiler) -> Command {
        let mut command = compiler.command();
        command.current_dir(self.source_folder()).arg("-I").arg(self.kit_folder.join("include"));
        command
    }

    /// The path of `source` relative to the source folder, if possible.
    fn name_in_source_folder<'p>(&self, source: &'p Path) -> &'p Path {
        match source.strip_prefix(self.source_folder()) {
            // A name that starts with `-` would be an option.
            Ok(name) if !name.as_os_str().as_encoded_bytes().starts_with(b"-") => name,
            _ => source,
        }
    }
}

/// Variant of a compilation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct CompileVariant<'m> {
    /// Index in the compiler's standards, of which the first is the newest; a language with fewer uses its last.
    age: usize,
    /// Omits the declarations that EyeSim's `types.h` adds to its own names.
    is_lean: bool,
    /// The meaning of `inline` in C.
    inline_rule: InlineRule,
    /// Headers in the folder of the first source that are hidden from the compiler.
    hidden: &'m [PathBuf],
}

impl CompileVariant<'_> {
    /// Message about the hidden headers: one line, or empty.
    fn remark(&self) -> String {
        let names = self.hidden.iter().map(|path| path.file_name().unwrap_or_default().display().to_string());
        match names.collect::<Vec<_>>().as_slice() {
            [] => String::new(),
            names => format!("{} beside the program is RoBIOS's own: eyesim's is used instead\n", hint::quoted(names)),
        }
    }
}

/// The flags of the commands that compile, and those of the command that links: `-lfann`, `-L/opt/lib` (or `-L` and
/// `/opt/lib`), `-Wl,...`. Flags that add a library, such as `-pthread` and `-fsanitize=undefined`, are flags of both.
pub(super) fn split_flags(flags: &[String]) -> (Vec<&String>, Vec<&String>) {
    let (mut of_compile, mut of_link, mut is_value) = (Vec::new(), Vec::new(), false);
    for flag in flags {
        let is_of_link = is_value || ["-l", "-L", "-Wl,"].iter().any(|beginning| flag.starts_with(beginning));
        is_value = !is_value && ["-l", "-L"].contains(&flag.as_str());
        let adds_library =
            ["-pthread", "-fopenmp", "-fsanitize=", "--coverage"].iter().any(|beginning| flag.starts_with(beginning));
        if is_of_link || adds_library {
            of_link.push(flag);
        }
        if !is_of_link {
            of_compile.push(flag);
        }
    }
    (of_compile, of_link)
}

/// The first lines of a compiler's messages: a source that is not a text file causes thousands of lines.
fn beginning(messages: &str) -> String {
    const MAX_BYTES: usize = 32 << 10;
    let mut len = 0;
    let kept = messages.split_inclusive('\n').take_while(|line| {
        len += line.len();
        len <= MAX_BYTES
    });
    let mut text: String = kept.collect();
    let rest_count = messages[text.len()..].lines().count();
    if rest_count > 0 {
        text.push_str(&format!("... and {rest_count} more lines of the compiler\n"));
    }
    text
}

enum Failure {
    Refused { source_file: PathBuf, output: String },
    Unlinked { output: String },
    Io(io::Error),
}

impl From<io::Error> for Failure {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

impl Compiled {
    /// Appends `command` to the commands of the build.
    fn log_command(&mut self, command: &Command) {
        self.commands.push_str(&shell_text(command));
        self.commands.push('\n');
    }

    /// Runs `command`, whose files may take as much space as `quota` allows; returns its output, or the output as an
    /// error if it failed.
    fn execute(&mut self, command: &mut Command, quota: Option<&Quota>) -> io::Result<Result<String, String>> {
        let is_over = || quota.is_some_and(|quota| quota.is_due() && quota.excess().is_some());
        let limits = CommandLimits { is_cancelled: &is_over, ..CommandLimits::of_time(build_timeout(COMMAND_TIMEOUT)) };
        let output = output_within(command, &limits);
        if let Some(excess) = quota.and_then(Quota::excess) {
            return Ok(Err(format!("the compiler was stopped: {excess}")));
        }
        let output = match output {
            Err(error) if error.kind() == io::ErrorKind::TimedOut => {
                let question = "does an `#include` name a pipe or a device?";
                return Ok(Err(format!("the compiler hangs: {error} (see {TIMEOUT_VARIABLE}; {question})")));
            }
            output => output?,
        };
        let messages = beginning(&String::from_utf8_lossy(&output.stderr));
        Ok(match output.status.success() {
            true => Ok(messages),
            false if messages.trim().is_empty() => Err(format!("the compiler ended with {}", output.status)),
            false => Err(messages),
        })
    }
}

/// A command in the syntax of a shell.
fn shell_text(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    let words: Vec<String> = words
        .map(|word| {
            let word = word.to_string_lossy();
            let plain = word.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-_./=,+:@%".contains(&byte));
            if plain && !word.is_empty() { word.into_owned() } else { format!("'{}'", word.replace('\'', r"'\''")) }
        })
        .collect();
    words.join(" ")
}

/// Returns true if the compiler warns that `main` does not return `int` (gcc and clang, `LC_ALL=C`).
fn returns_nothing_from_main(output: &str) -> bool {
    output.lines().any(|line| {
        line.contains("return type of 'main'") && (line.contains("[-Wmain]") || line.contains("[-Wmain-return-type]"))
    })
}

/// Message about a source whose text is not UTF-8, for its first invalid byte: one line, or empty.
fn remark_on_encoding(source: &Path, text: &[u8]) -> String {
    let Err(error) = std::str::from_utf8(text) else { return String::new() };
    let (before, rest) = text.split_at(error.valid_up_to());
    let line = 1 + before.iter().filter(|byte| **byte == b'\n').count();
    let (name, byte) = (source.file_name().unwrap_or_default().display(), rest.first().copied().unwrap_or_default());
    // In Latin-1 a byte is the character with the same number; those below 0xA0 are not printable.
    let letter = if byte >= 0xA0 { format!(" (`{}` in Latin-1)", char::from(byte)) } else { String::new() };
    format!(
        "{name}:{line}: the byte 0x{byte:X}{letter} is not UTF-8, and is lost where it is printed: save the file as UTF-8\n"
    )
}

/// The files named by a dependency list of `-MD` (a rule of make).
fn parse_dependencies(text: &str) -> Vec<PathBuf> {
    let mut paths = Vec::new();
    let mut path = String::new();
    let text = text.split_once(':').map_or("", |(_, rest)| rest);
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        match (character, characters.peek()) {
            ('\\', Some('\n')) => {
                characters.next();
            }
            ('\\', Some(&escaped @ (' ' | '#' | '\\'))) | ('$', Some(&escaped @ '$')) => {
                path.push(escaped);
                characters.next();
            }
            (blank, _) if blank.is_whitespace() => {
                paths.extend((!path.is_empty()).then(|| PathBuf::from(std::mem::take(&mut path))));
            }
            (other, _) => path.push(other),
        }
    }
    paths.extend((!path.is_empty()).then(|| PathBuf::from(path)));
    paths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_messages_are_truncated() {
        let few = "a.c:1: error\n".repeat(100);
        assert_eq!(beginning(&few), few);
        let many = beginning(&"a.c:1: error\n".repeat(10_000));
        assert!(many.len() < 40_000 && many.ends_with("more lines of the compiler\n"), "{}", many.len());
        assert_eq!(beginning(&"x".repeat(100_000)), "... and 1 more lines of the compiler\n");
    }

    #[test]
    fn escapes_in_dependency_lists_are_decoded() {
        let text = "o: maze.c \\\n /usr/include/stdio.h my\\ map.h \\\n  a\\#b.h cost$$.h\n";
        let expected = ["maze.c", "/usr/include/stdio.h", "my map.h", "a#b.h", "cost$.h"].map(PathBuf::from);
        assert_eq!(parse_dependencies(text), expected);
    }

    #[test]
    fn latin_1_sources_are_reported() {
        let remark = |text: &[u8]| remark_on_encoding(Path::new("/p/maze.c"), text);
        assert_eq!(remark("int main(void) { return 0; } // größer".as_bytes()), "");
        assert_eq!(
            remark(b"int i;\n// gr\xF6\xDFer\n"),
            "maze.c:2: the byte 0xF6 (`\u{F6}` in Latin-1) is not UTF-8, and is lost where it is printed: save the file as UTF-8\n"
        );
        assert!(remark(b"\x80").starts_with("maze.c:1: the byte 0x80 is not UTF-8"));
    }

    #[test]
    fn void_main_is_distinguished_from_other_warnings_about_main() {
        assert!(returns_nothing_from_main("a.c:1:6: warning: return type of 'main' is not 'int' [-Wmain]"));
        assert!(returns_nothing_from_main("a.c:1:1: warning: return type of 'main' is not 'int' [-Wmain-return-type]"));
        assert!(!returns_nothing_from_main("a.c:1:5: warning: 'main' takes only zero or two arguments [-Wmain]"));
    }

    #[test]
    fn commands_are_shown_in_shell_syntax() {
        let mut command = Command::new("cc");
        command.args(["-Dx='y z'", "a b.c", "-O2"]);
        assert_eq!(shell_text(&command), r"cc '-Dx='\''y z'\''' 'a b.c' -O2");
    }
}
