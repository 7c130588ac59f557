//! Tests of building and loading with the real compiler. Without a compiler these tests print a message and end.

use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use robios_sys::{ABI_VERSION, CallContext, Robios6, Robios7, Support, c};

use super::build::{BuildError, Builder, BuiltProgram, Tools};
use super::cache::Cache;
use super::compile::{CompileError, Kits, ShimKit, split_flags};
use super::compiler::{Compiler, CompilerError};
use super::find::Found;
use super::find::ProgramSource;
use super::image::{ImageError, ProgramImage};
use super::language::Language;
use super::load::{LoadError, LoadedProgram, Loader, check_mappings};
use super::prepare::{Code, Prepared, prepare};
use super::sandbox::{Level, Sandbox};
use super::symbols::warnings_about;

/// A shim whose `run` calls `main` and returns its result.
const SHIM: &str = r#"
#include "abi.h"
#ifdef EYESIM_VOID_MAIN
extern void main(int argc, char **argv);
#else
extern int main(int argc, char **argv);
#endif
int TestAnswer(void) { return 42; }
static int run(const struct eyesim_host *host, void *robot, int argc, const char *const *argv) {
    (void)host; (void)robot;
#ifdef EYESIM_VOID_MAIN
    main(argc, (char **)argv);
    return 0;
#else
    return main(argc, (char **)argv);
#endif
}
const struct eyesim_program eyesim_program = {
    .size = sizeof eyesim_program, .abi = EYESIM_ABI_VERSION, .generation = 6,
    .language = EYESIM_LANGUAGE_C, .run = run };
"#;

/// A kit that needs no host.
fn kit() -> ShimKit {
    let abi_header = c::SHIM.iter().find(|file| file.name == "abi.h").expect("the header of the ABI");
    ShimKit {
        headers: vec![
            ("eyebot.h", "#include <stdio.h>\nint TestAnswer(void);\n"),
            ("hdt_sem.h", "#define PSD_FRONT -200\n"),
        ],
        shim: vec![("shim.c", SHIM), ("abi.h", abi_header.text)],
        shim_flags: &["-g", "-O1", "-fPIC"],
        digest: Default::default(),
    }
}

struct TestFolder {
    folder: tempfile::TempDir,
    cache: tempfile::TempDir,
    tools: Tools,
}

impl TestFolder {
    /// A folder with `files`, or `None` with a printed reason where no C compiler is installed.
    fn with(files: &[(&str, &str)]) -> Option<Self> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let cache = tempfile::tempdir().expect("a temporary folder");
        let test_folder = Self { folder, cache, tools: Tools::default() };
        for (name, text) in files {
            test_folder.write(name, text);
        }
        match Compiler::find(Language::C, None, &test_folder.cache()) {
            Err(CompilerError::Missing { .. }) => {
                println!("skipped: no C compiler is installed");
                None
            }
            found => found.map(|_| test_folder).map_err(|error| panic!("{error}")).ok(),
        }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path(name);
        fs::create_dir_all(path.parent().expect("a folder")).expect("folders");
        fs::write(&path, text).expect("a file");
        path
    }

    fn cache(&self) -> Cache {
        Cache::open(self.cache.path()).expect("a cache")
    }

    fn builder(&self) -> Builder {
        Builder::new(self.cache(), Kits::Only(kit()), self.tools.clone())
    }

    fn sources(&self, names: &[&str]) -> ProgramSource {
        ProgramSource::of_files(names.iter().map(|name| self.path(name)).collect())
    }

    fn build(&self, names: &[&str]) -> Result<BuiltProgram, BuildError> {
        self.builder().build(&self.sources(names))
    }

    fn built(&self, names: &[&str]) -> BuiltProgram {
        self.build(names).unwrap_or_else(|error| panic!("{error}"))
    }

    fn prepared(&self, names: &[&str]) -> Arc<Prepared> {
        let built = self.built(names);
        prepared(ProgramImage::read(&built.library, Some(self.folder.path())).expect("an image"))
    }

    fn loaded(&self, names: &[&str]) -> LoadedProgram {
        self.loaded_with(names, &[])
    }

    fn loaded_with(&self, names: &[&str], arguments: &[&str]) -> LoadedProgram {
        let arguments: Vec<String> = arguments.iter().map(|&argument| argument.to_owned()).collect();
        let loaded = Loader::new().expect("a run folder").load(&self.prepared(names), &arguments, None);
        loaded.unwrap_or_else(|error| panic!("{error}"))
    }

    /// Replaces the compiler by a script that logs its calls; returns a function that counts the calls, except queries
    /// of the version.
    fn count_compilations(&mut self) -> impl Fn() -> usize + use<> {
        let log = self.path("calls");
        let text = format!("#!/bin/sh\n[ \"$1\" = --version ] || echo \"$@\" >> '{}'\nexec cc \"$@\"\n", log.display());
        let wrapper = self.write("wrapper", &text);
        fs::set_permissions(&wrapper, fs::Permissions::from_mode(0o755)).expect("an executable script");
        self.tools.cc = Some(wrapper.display().to_string());
        move || fs::read_to_string(&log).map_or(0, |calls| calls.lines().count())
    }
}

/// A host that answers each call with its documented failure.
struct NoHost;

impl CallContext for NoHost {}
impl Support for NoHost {}
impl Robios6 for NoHost {}

impl Robios7 for NoHost {}

fn library_image(prepared: &Prepared) -> &ProgramImage {
    prepared.image().expect("a library")
}

fn prepared(image: ProgramImage) -> Arc<Prepared> {
    let source = ProgramSource::Library(image.path().to_owned());
    let (output, warnings) = (String::new(), Vec::new());
    Arc::new(Prepared {
        name: "program".into(),
        source,
        code: Code::Library(Arc::new(image)),
        output,
        compiled: true,
        choice: None,
        warnings,
        danger: None,
    })
}

fn run(program: &LoadedProgram) -> i32 {
    program.run(&NoHost)
}

#[test]
fn program_builds_and_runs_with_its_arguments() {
    let Some(test_folder) = TestFolder::with(&[(
        "args.c",
        "#include \"eyebot.h\"\n#include <string.h>\nint main(int argc, char **argv)\n{\n  return argc == 3 && !strcmp(argv[2], \"0.5\") && !argv[3] ? TestAnswer() : 1;\n}\n",
    )]) else {
        return;
    };
    assert_eq!(run(&test_folder.loaded_with(&["args.c"], &["--kp", "0.5"])), 42);
    assert_eq!(run(&test_folder.loaded(&["args.c"])), 1);
}

#[test]
fn build_with_files_beyond_the_quota_fails() {
    let Some(test_folder) =
        TestFolder::with(&[("big.c", "char big[8 << 20] = { 1 };\nint main(void) { return 0; }\n")])
    else {
        return;
    };
    let Ok(mut sandbox) = Sandbox::new(Level::Limits) else { return };
    test_folder
        .builder()
        .with_sandbox(Some(sandbox.clone()))
        .build(&test_folder.sources(&["big.c"]))
        .expect("within the quota");
    test_folder.write("big.c", "char big[8 << 20] = { 2 };\nint main(void) { return 0; }\n");
    sandbox.build_limits.scratch = 4 << 20;
    let error = test_folder
        .builder()
        .with_sandbox(Some(sandbox))
        .build(&test_folder.sources(&["big.c"]))
        .expect_err("too much");
    assert!(error.to_string().contains("its files exceed the limits of its sandbox: 4 MiB"), "{error}");
}

#[test]
fn old_c_compiles_with_warnings() {
    let old = "#include \"eyebot.h\"\n#include \"hdt_sem.h\"\ncount;\nadd(a, b)\nint a, b;\n{\n  return a + b;\n}\nmain()\n{\n  char *text = 7;\n  count = add(40, (int)(long)text);\n  undeclared(count);\n  return count + (PSD_FRONT == -200);\n}\nundeclared(n) { return n; }\n";
    let Some(test_folder) = TestFolder::with(&[("old.c", old)]) else { return };
    let built = test_folder.built(&["old.c"]);
    assert!(built.output.contains("old.c:13:3: warning: implicit declaration"), "{}", built.output);
    assert_eq!(run(&test_folder.loaded(&["old.c"])), 48);
}

#[test]
fn void_main_returns_zero() {
    let Some(test_folder) =
        TestFolder::with(&[("void.c", "void main()\n{\n  volatile int i = 3;\n  while (i) i--;\n}\n")])
    else {
        return;
    };
    assert!(test_folder.built(&["void.c"]).output.contains("-Wmain"));
    assert_eq!(run(&test_folder.loaded(&["void.c"])), 0);
}

#[test]
fn main_without_return_statement_returns_zero() {
    let Some(test_folder) = TestFolder::with(&[("zero.c", "int main(void)\n{\n  volatile int i = 7;\n  i++;\n}\n")])
    else {
        return;
    };
    assert_eq!(run(&test_folder.loaded(&["zero.c"])), 0);
}

#[test]
fn several_files_are_linked_to_one_program() {
    let main = "extern int plan(int); int shared; int main(void) { shared = 2; return plan(40); }\n";
    let Some(test_folder) =
        TestFolder::with(&[("main.c", main), ("plan.c", "int shared; int plan(int n) { return n + shared; }\n")])
    else {
        return;
    };
    assert_eq!(run(&test_folder.loaded(&["main.c", "plan.c"])), 42);
}

#[test]
fn libraries_of_the_system_are_linked() {
    let main = "int answer(void);\nint main(void) { return answer(); }\n";
    let Some(mut test_folder) =
        TestFolder::with(&[("main.c", main), ("lib/answer.c", "int answer(void) { return 42; }\n")])
    else {
        return;
    };
    let folder = test_folder.path("lib");
    let mut cc = std::process::Command::new("cc");
    cc.args(["-shared", "-fPIC", "answer.c", "-o", "libanswer.so"]).current_dir(&folder);
    assert!(cc.status().is_ok_and(|status| status.success()));
    let folder = folder.display();
    for flags in ["-L{folder} -lanswer", "-L {folder} -l answer"] {
        let flags = flags.replace("{folder}", &folder.to_string());
        test_folder.tools.cflags = Some(format!("-DONE {flags} -Wl,-rpath,{folder}"));
        assert_eq!(run(&test_folder.loaded(&["main.c"])), 42, "{flags}");
    }
}

#[test]
fn flags_are_those_of_compilers_or_of_the_link_or_of_both() {
    let flags = ["-DONE", "-fopenmp", "-L", "/opt", "-lm", "-I", "/opt"].map(str::to_owned);
    let (of_compile, of_link) = split_flags(&flags);
    assert_eq!(of_compile, ["-DONE", "-fopenmp", "-I", "/opt"]);
    assert_eq!(of_link, ["-fopenmp", "-L", "/opt", "-lm"]);
}

#[test]
fn inline_functions_of_old_c_are_linked() {
    let main = "int two(void);\ninline int one(int n) { return n < 2 ? 20 : one(n - 1) + 1; }\nint (*function)(int) = one;\n\
                int main(void) { return function(2) + two(); }\n";
    let part = "__inline__ int two(void) { return 21; }\n";
    let Some(test_folder) = TestFolder::with(&[("main.c", main), ("part.c", part)]) else { return };
    assert_eq!(run(&test_folder.loaded(&["main.c", "part.c"])), 42);
    // A header that both files include.
    let main = "#include \"both.h\"\nint two(void);\nint (*function)(int) = one;\nint main(void) { return function(20) + two(); }\n";
    let part = "#include \"both.h\"\nstatic int (*function)(int) = one;\nint two(void) { return function(20); }\n";
    for (storage, real) in [("", ""), ("extern ", "int one(int n) { return n + 1; }\n")] {
        let header = format!("{storage}inline int one(int n) {{ return n + 1; }}\n");
        let Some(test_folder) =
            TestFolder::with(&[("main.c", main), ("part.c", part), ("both.h", &header), ("real.c", real)])
        else {
            return;
        };
        assert_eq!(run(&test_folder.loaded(&["main.c", "part.c", "real.c"])), 42, "{header}");
    }
    let double = [
        ("main.c", "inline int one(void) { return 1; }\nint main(void) { return one(); }\n"),
        ("b.c", "int main(void) {}\n"),
    ];
    let Some(test_folder) = TestFolder::with(&double) else { return };
    assert!(test_folder.build(&["main.c", "b.c"]).is_err());
}

#[test]
fn compile_errors_are_shown_with_file_and_line() {
    let Some(test_folder) = TestFolder::with(&[("bad.c", "int main(void)\n{\n  return speed;\n}\n")]) else { return };
    let message = test_folder.build(&["bad.c"]).expect_err("an error").to_string();
    assert!(message.contains("bad.c` does not compile"), "{message}");
    assert!(message.contains("\nbad.c:3:10: error: 'speed' undeclared"), "{message}");
}

#[test]
fn undefined_functions_are_named_by_the_build() {
    let Some(test_folder) =
        TestFolder::with(&[("bad.c", "int Plan(void);\nint main(void) { return Plan(); }\n"), ("no.c", "int x;\n")])
    else {
        return;
    };
    match test_folder.build(&["bad.c"]) {
        Err(BuildError::Compile(CompileError::Unlinked { hints, output, .. })) => {
            assert!(hints.starts_with("bad.c:2: `Plan` is used and nowhere defined: "), "{hints}");
            assert!(output.contains("bad.c:2"), "{output}");
        }
        other => panic!("{other:?}"),
    }
    let message = test_folder.build(&["no.c"]).expect_err("no main").to_string();
    assert_eq!(message, "the program has no function `main`");
}

#[test]
fn nothing_is_compiled_when_nothing_has_changed() {
    let Some(mut test_folder) = TestFolder::with(&[
        ("maze.c", "#include \"map.h\"\nint main(void) { return SIZE; }\n"),
        ("map.h", "#define SIZE 3\n"),
    ]) else {
        return;
    };
    let compilations = test_folder.count_compilations();
    let first = test_folder.built(&["maze.c"]);
    let count = compilations();
    assert!(first.compiled && count > 0);
    let second = test_folder.built(&["maze.c"]);
    assert!(!second.compiled);
    assert_eq!((compilations(), second.library), (count, first.library));
    // A changed header causes a build, too.
    test_folder.write("map.h", "#define SIZE 4\n");
    assert!(test_folder.built(&["maze.c"]).compiled);
    assert_eq!(run(&test_folder.loaded(&["maze.c"])), 4);
    let count = compilations();
    // A source or header with its earlier contents is in the cache.
    test_folder.write("map.h", "#define SIZE 3\n");
    test_folder.built(&["maze.c"]);
    assert_eq!(run(&test_folder.loaded(&["maze.c"])), 3);
    // A changed flag causes a build, too.
    test_folder.tools.cflags = Some("-DOTHER='a b'".into());
    assert!(test_folder.built(&["maze.c"]).compiled);
    assert!(compilations() > count);
}

#[test]
fn new_header_beside_the_source_is_used() {
    let Some(test_folder) =
        TestFolder::with(&[("a.c", "#include \"hdt_sem.h\"\nint main(void) { return -PSD_FRONT; }\n")])
    else {
        return;
    };
    assert_eq!(run(&test_folder.loaded(&["a.c"])), 200);
    test_folder.write("hdt_sem.h", "#define PSD_FRONT -7\n");
    assert_eq!(run(&test_folder.loaded(&["a.c"])), 7);
}

#[test]
fn broken_cache_entry_is_rebuilt() {
    let Some(test_folder) = TestFolder::with(&[("a.c", "int main(void) { return 5; }\n")]) else { return };
    let library = test_folder.built(&["a.c"]).library;
    fs::write(&library, "half").expect("broken");
    assert!(test_folder.built(&["a.c"]).compiled);
    assert_eq!(run(&test_folder.loaded(&["a.c"])), 5);
}

#[test]
fn concurrent_builds_share_the_cache() {
    let Some(test_folder) = TestFolder::with(&[("a.c", "int main(void) { return 5; }\n")]) else { return };
    let built: Vec<BuiltProgram> = std::thread::scope(|scope| {
        let runs: Vec<_> = (0..4).map(|_| scope.spawn(|| test_folder.built(&["a.c"]))).collect();
        runs.into_iter().map(|run| run.join().expect("a build")).collect()
    });
    assert!(built.iter().all(|one| one.library == built[0].library && one.library.exists()));
    let left: Vec<_> =
        fs::read_dir(test_folder.cache().root()).expect("the cache").flatten().map(|e| e.file_name()).collect();
    assert!(left.iter().all(|name| !name.to_string_lossy().starts_with("tmp-")), "{left:?}");
}

#[test]
fn several_programs_are_built_in_order() {
    let Some(test_folder) =
        TestFolder::with(&[("a.c", "int main(void) { return 5; }\n"), ("b.c", "int main(void) { return x; }\n")])
    else {
        return;
    };
    let results = test_folder.builder().build_all(&[
        test_folder.sources(&["a.c"]),
        test_folder.sources(&["b.c"]),
        test_folder.sources(&["a.c"]),
    ]);
    assert_eq!(results.iter().map(Result::is_ok).collect::<Vec<_>>(), [true, false, true]);
}

#[test]
fn broken_or_missing_compiler_is_reported() {
    let Some(mut test_folder) = TestFolder::with(&[("a.c", "int main(void) { return 5; }\n")]) else { return };
    test_folder.tools.cc = Some("no-such-compiler -m32".into());
    let message = test_folder.build(&["a.c"]).expect_err("no compiler").to_string();
    assert!(message.starts_with("the C compiler `no-such-compiler -m32` set in $CC does not run"), "{message}");
    let missing = CompilerError::Missing { language: Language::C }.to_string();
    assert!(missing.contains("apt install gcc libc6-dev"), "{missing}");
    // The package of the C++ compiler installs the compiler of C, too.
    test_folder.tools.cxx = Some("no-such-c++".into());
    test_folder.write("b.cpp", "int main() { return 5; }\n");
    let message = test_folder.build(&["b.cpp"]).expect_err("no compilers").to_string();
    assert!(message.starts_with("the C++ compiler `no-such-c++` set in $CXX does not run"), "{message}");
}

#[test]
fn a_cache_that_cannot_be_written_is_no_missing_compiler() {
    let Some(test_folder) = TestFolder::with(&[("a.c", "int main(void) { return 5; }\n")]) else { return };
    let notes = test_folder.cache.path().join("notes");
    fs::remove_dir_all(&notes).expect("the notes of the search for a compiler");
    fs::write(&notes, "").expect("a file");
    let message = test_folder.build(&["a.c"]).expect_err("no folder for notes").to_string();
    assert!(message.starts_with("cannot try the compiler in the folder for built programs: "), "{message}");
}

#[test]
fn each_copy_has_its_own_globals() {
    let counter = "int count;\nint main(void) { static int calls = 10; return ++count * 100 + ++calls; }\n";
    let Some(test_folder) = TestFolder::with(&[("count.c", counter)]) else { return };
    let prepared = test_folder.prepared(&["count.c"]);
    let mut loader = Loader::new().expect("a run folder");
    // Exceeds the number of complete copies, so that some contain only the loaded part.
    let programs: Vec<LoadedProgram> = (0..20).map(|_| loader.load(&prepared, &[], None).expect("a copy")).collect();
    for program in &programs {
        assert_eq!(run(program), 111);
        assert_eq!(run(program), 212);
    }
    // All copies share code and constants with the first copy, but not variables.
    assert!(!library_image(&prepared).read_only_segments().is_empty());
    if let Ok(maps) = fs::read_to_string("/proc/self/maps") {
        let inode_of = |program: &LoadedProgram| {
            let start = format!("{:x}-", program.addresses().start);
            maps.lines()
                .find(|line| line.starts_with(&start))
                .and_then(|line| line.split_whitespace().nth(4))
                .map(str::to_owned)
        };
        let inodes: Vec<Option<String>> = programs.iter().map(inode_of).collect();
        assert!(inodes[0].is_some() && inodes.iter().all(|inode| *inode == inodes[0]), "{inodes:?}");
    }
    let mut starts: Vec<usize> = programs.iter().map(|program| program.addresses().start).collect();
    starts.sort_unstable();
    starts.dedup();
    assert_eq!(starts.len(), programs.len());
}

#[test]
fn source_lines_are_found_by_address() {
    let text = "int depth;\n__attribute__((noinline)) int deeper(int n)\n{\n  depth += n;\n  return depth;\n}\nint main(void)\n{\n  return deeper(3);\n}\n";
    let Some(test_folder) = TestFolder::with(&[("line.c", text)]) else { return };
    let program = test_folder.loaded(&["line.c"]);
    let address_in = |function: &str| {
        program
            .addresses()
            .find(|&address| {
                program.source_line(address).is_some_and(|line| line.function.as_deref() == Some(function))
            })
            .unwrap_or_else(|| panic!("no code of `{function}`"))
    };
    let in_shim = address_in("run");
    assert!(program.source_line(in_shim).expect("a line").file.ends_with("shim.c"));
    let line = program.own_source_line(&[in_shim, address_in("deeper") + 1]).expect("a line");
    assert!(["line.c:3", "line.c:4"].contains(&line.to_string().as_str()), "{line:?}");
    assert_eq!(line.function.as_deref(), Some("deeper"));
    for address in [0, 1, usize::MAX] {
        assert_eq!(program.source_line(address), None);
        assert_eq!(program.own_source_line(&[address, address]), None);
    }
}

#[test]
fn incompatible_libraries_are_refused_with_a_reason() {
    let classic = "extern int VWDriveStraight(void); int main(void) { return VWDriveStraight(); }\n";
    let number = "const struct { unsigned size, abi, rest[8]; } eyesim_program = { 40, 99, { 6 } };\n";
    let short = format!("const struct {{ unsigned size, abi, rest[8]; }} eyesim_program = {{ 8, {ABI_VERSION} }};\n");
    let missing = format!(
        "extern int Plan(void); const struct {{ unsigned size, abi, rest[3]; int (*f)(void); char room[80]; }} \
         eyesim_program = {{ 96, {ABI_VERSION}, {{ 6, 0, 1 }}, Plan, {{0}} }};\n"
    );
    let files = [("classic.c", classic), ("number.c", number), ("short.c", &short), ("missing.c", &missing)];
    let Some(test_folder) = TestFolder::with(&files) else { return };
    let message = |name: &str| {
        let library = test_folder.path(name).with_extension("so");
        let mut compiler = std::process::Command::new("cc");
        compiler.args(["-shared", "-fPIC", "-o"]).arg(&library).arg(test_folder.path(name));
        assert!(compiler.status().expect("a compiler").success());
        let prepared = prepared(ProgramImage::read(&library, None).expect("an image"));
        Loader::new().expect("a run folder").load(&prepared, &[], None).expect_err("incompatible").to_string()
    };
    let classic = message("classic.c");
    assert!(
        classic.contains("does not export `eyesim_program`, and expects `VWDriveStraight` in the simulator"),
        "{classic}"
    );
    let versions = format!("built for version 99 of the program interface, and this eyesim has version {ABI_VERSION}");
    assert!(message("number.c").contains(&versions));
    assert!(message("short.c").contains("its description is too short"));
    assert!(message("missing.c").contains("needs `Plan`, which neither it nor any library"));
}

#[test]
fn files_other_than_libraries_are_refused() {
    let Some(test_folder) = TestFolder::with(&[("a.c", "int main(void) { return 5; }\n")]) else { return };
    let library = test_folder.built(&["a.c"]).library;
    let bytes = fs::read(&library).expect("the library");
    let cut = test_folder.path("cut.so");
    fs::write(&cut, &bytes[..bytes.len() / 8]).expect("a file");
    let refused = |path: &Path| ProgramImage::read(path, None).expect_err("refused");
    assert!(matches!(refused(&cut), ImageError::Broken { .. }));
    assert!(matches!(refused(&test_folder.path("a.c")), ImageError::Foreign { .. }));
    assert!(matches!(refused(&test_folder.path("none.so")), ImageError::Read { .. }));
    let this = std::env::current_exe().expect("this program");
    assert!(refused(&this).to_string().contains("executable"));
}

#[test]
fn robots_that_share_a_copy_have_their_own_variables() {
    const COUNT: &str =
        "static int count, steps = 5, zeros[100];\nint main(void) { zeros[9]++; return count += steps + zeros[9]; }\n";
    let Some(test_folder) = TestFolder::with(&[("a.c", COUNT)]) else { return };
    let prepared = test_folder.prepared(&["a.c"]);
    let mut loader = Loader::new().expect("a run folder");
    let programs: Vec<_> = (0..6).map(|_| loader.load(&prepared, &[], Some(2)).expect("a copy")).collect();
    let workers = programs.iter().map(|program| program.variables().map(|variables| variables.worker()));
    assert_eq!(workers.collect::<Vec<_>>(), [0, 1, 0, 1, 0, 1].map(Some));
    assert_eq!(programs[0].addresses(), programs[4].addresses());
    assert_ne!(programs[0].addresses(), programs[1].addresses());
    let run = |program: &LoadedProgram| {
        let Some(variables) = program.variables() else { panic!("a shared copy") };
        // SAFETY: this thread is the only one that uses the copies.
        unsafe { variables.swap_in() };
        program.run(&Listener::default())
    };
    assert_eq!(programs.iter().map(run).collect::<Vec<_>>(), [6; 6]);
    assert_eq!(programs.iter().rev().map(run).collect::<Vec<_>>(), [13; 6]);
    drop(programs.into_iter().nth(4));
}

#[test]
fn too_many_mappings_are_refused() {
    assert!(check_mappings(10, 20).is_ok());
    match check_mappings(100_000_010, 500_000_000) {
        Err(LoadError::TooManyMappings { robots, needed, allowed, advised }) => {
            assert_eq!(robots, 100_000_010);
            assert!(allowed < needed && needed <= advised);
        }
        other => panic!("{other:?}"),
    }
}

/// A host that collects the output of a program.
#[derive(Default)]
struct Listener {
    console: std::cell::RefCell<String>,
}

impl CallContext for Listener {}
impl Robios6 for Listener {}

impl Robios7 for Listener {}
impl Support for Listener {
    fn console(&self, _: i32, bytes: Option<&[u8]>) -> Result<i32, robios_sys::Stop> {
        self.console.borrow_mut().push_str(&String::from_utf8_lossy(bytes.unwrap_or_default()));
        Ok(0)
    }
}

#[test]
fn paths_are_relative_to_the_source_folder_also_if_a_header_is_hidden() {
    let text = "#include \"eyebot.h\"\n#include \"../common/util.h\"\n#include \"more.h\"\n#include \"own.h\"\n#include <string.h>\n\
                int main(void) { return strcmp(__FILE__, \"a.c\") ? 1 : TestAnswer() + UTIL + MORE + OWN; }\n";
    let header = "int VWStraight(float);\nint TestAnswer(char *);\n";
    let files = [
        ("src/a.c", text),
        ("src/eyebot.h", header),
        ("src/own.h", "#define OWN 100\n"),
        ("common/util.h", "#include \"eyebot.h\"\n#define UTIL 1\n"),
        ("more/more.h", "#define MORE 10\n"),
    ];
    let Some(mut test_folder) = TestFolder::with(&files) else { return };
    test_folder.tools.cflags = Some("-I../more".to_owned());
    let built = test_folder.built(&["src/a.c"]);
    assert!(built.output.contains("RoBIOS's own: eyesim's is used instead"), "{}", built.output);
    assert_eq!(run(&test_folder.loaded(&["src/a.c"])), 42 + 111);
    // A change of any file that was read is noticed, and messages name files as the user does.
    test_folder.write("common/util.h", "#define UTIL 2\n");
    test_folder.write("src/own.h", "#define OWN 200\n");
    assert_eq!(run(&test_folder.loaded(&["src/a.c"])), 42 + 212);
    test_folder.write("src/own.h", "#define OWN oops\n");
    let message = test_folder.build(&["src/a.c"]).expect_err("it does not compile").to_string();
    assert!(message.contains("\na.c:6:") && message.contains("\nown.h:1:"), "{message}");
    assert!(!message.contains("sources/"), "{message}");
}

#[test]
fn kit_of_robios_6_has_its_headers() {
    let text = "#include <stdio.h>\n#include <stdlib.h>\n#include \"eyebot.h\"\n#include \"hdt_sem.h\"\nint main(int argc, char **argv)\n{\n  VWHandle vw = VWInit(VW_DRIVE, 1);\n  printf(\"%s %d %d\\n\", argv[1], argc, vw);\n  exit(PSD_FRONT == -200 ? 3 : 4);\n}\n";
    let Some(test_folder) = TestFolder::with(&[("a.c", text)]) else { return };
    let builder = Builder::new(test_folder.cache(), Kits::of_robios(), Tools::default());
    // The same source under two names, as by its file and by its folder.
    let found =
        ["b", "a"].map(|name| Found { name: name.into(), source: test_folder.sources(&["a.c"]), notes: vec![] });
    let mut all = prepare(&builder, &found).into_iter().map(|result| result.unwrap_or_else(|error| panic!("{error}")));
    assert_eq!(all.next().map(|prepared| prepared.name.clone()), Some("b".into()));
    let prepared = all.next().expect("a result");
    assert_eq!((prepared.output.as_str(), prepared.name.as_str()), ("", "a"));
    // No function that the shim itself uses is outside the guarantee.
    assert_eq!(prepared.warnings, Vec::<String>::new());
    let program = Loader::new().expect("a run folder").load(&prepared, &["b c".into()], None).expect("a program");
    let host = Listener::default();
    assert_eq!(program.run(&host), 3);
    assert_eq!(host.console.take(), "b c 2 0\n");
}

#[test]
fn nondeterministic_functions_of_a_foreign_library_are_reported() {
    let text = "#include <stdlib.h>\nint Answer(void) { return rand() + system(\"true\"); }\n";
    let Some(test_folder) = TestFolder::with(&[("other.c", text)]) else { return };
    let library = test_folder.path("other.so");
    let mut compiler = std::process::Command::new("cc");
    compiler.args(["-shared", "-fPIC", "-o"]).arg(&library).arg(test_folder.path("other.c"));
    assert!(compiler.status().expect("a compiler").success());
    let warnings = warnings_about(&ProgramImage::read(&library, None).expect("an image"), "other");
    let found =
        |name: &str| warnings.iter().any(|warning| warning.contains(&format!("program `other` uses `{name}`: ")));
    assert!(found("rand") && found("system") && warnings.len() == 2, "{warnings:?}");
}

#[test]
fn programs_and_builders_may_be_used_on_any_thread() {
    fn check<T: Send + Sync>() {}
    check::<LoadedProgram>();
    check::<Builder>();
}
