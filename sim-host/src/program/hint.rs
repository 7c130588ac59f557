//! Hints on programs that do not compile or link: headers of other systems, misspelled functions, functions of the other generation,
//! missing `extern "C"` between C and C++.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use object::{Object as _, ObjectSymbol as _};

use super::generation::Generation;

/// Headers of other systems and of terminals, and what programs of a robot use instead.
const ABSENT: &[(&[&str], &str)] = &[
    (
        &["conio.h", "curses.h", "ncurses.h", "ncurses/ncurses.h"],
        "a robot has no terminal: `KEYRead` and `KEYGet` read its keys, `getchar` reads the text of `--stdin`, `LCDPrintf` writes to its \
         display",
    ),
    (
        &["windows.h", "Windows.h"],
        "it is of Windows: `OSWait(ms)` or `usleep` in place of `Sleep`, `OSGetCount` in place of `GetTickCount`, \
         pthreads in place of `CreateThread`",
    ),
];

/// Functions of curses that almost every program of it calls.
const OF_CURSES: [&str; 4] = ["initscr", "endwin", "wgetch", "stdscr"];

/// Hint on the compiler's message `output` about a header that is missing, in a line of its own; empty for others.
pub fn of_compile(output: &str) -> String {
    let Some(missing) = output.lines().find_map(missing_header) else { return String::new() };
    let name = missing.rsplit(['/', '\\']).next().unwrap_or(missing);
    let mut hints = String::new();
    if let Some((_, instead)) = ABSENT.iter().find(|(headers, _)| headers.contains(&missing)) {
        line(&mut hints, &format!("`{missing}`: {instead}"));
    } else if let Some(own) = own_header(name) {
        line(&mut hints, &format!("`{missing}`: write `#include \"{own}\"`, which eyesim has"));
    }
    hints
}

/// The header of ours whose name is `name` but for capitals and two letters.
fn own_header(name: &str) -> Option<&'static str> {
    let distance = |own: &&str| strsim::osa_distance(own, &name.to_lowercase());
    let nearest = ["eyebot.h", "eyebot++.h", "types.h"].into_iter().min_by_key(distance)?;
    (distance(&nearest) <= name.len() / 4).then_some(nearest)
}

/// The header that the compiler does not find, as the program names it (gcc and clang, `LC_ALL=C`).
fn missing_header(line: &str) -> Option<&str> {
    let (_, rest) = line.split_once("fatal error: ")?;
    let missing = rest.strip_suffix(": No such file or directory").or_else(|| rest.strip_suffix(" file not found"))?;
    Some(missing.trim_matches('\''))
}

/// Hints on the linker's message `output`, each in its own line that begins with a line feed; `objects` are the sources with their
/// object files.
pub fn of_link(output: &str, objects: &[(&Path, PathBuf)], generation: Generation) -> String {
    let linkage = linkage_hints(&symbols_of(objects));
    let undefined: Vec<String> =
        undefined_symbols(output).into_iter().filter(|name| !linkage.contains_key(name)).collect();
    let mut hints = undefined_hint(&undefined, generation);
    if undefined.iter().any(|name| OF_CURSES.contains(&name.as_str())) {
        line(&mut hints, &format!("`curses.h`: {}", ABSENT[0].1));
    }
    linkage.values().for_each(|hint| line(&mut hints, hint));
    if ["multiple definition of `main'", "duplicate symbol: main"].iter().any(|phrase| output.contains(phrase)) {
        let example = objects.first().and_then(|(source, _)| source.file_name()).unwrap_or_default();
        line(
            &mut hints,
            &format!(
                "these files are several programs, each with a `main`: name one of them (`{}`) and not their folder",
                example.display()
            ),
        );
    }
    hints
}

/// Names in back-quotes with commas between them.
pub fn quoted(names: &[impl AsRef<str>]) -> String {
    names.iter().map(|name| format!("`{}`", name.as_ref())).collect::<Vec<_>>().join(", ")
}

/// Functions that are called without a declaration according to the compiler, each once (gcc and clang, `LC_ALL=C`).
pub fn undeclared_functions(output: &str) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for line in output.lines() {
        let rest = ["implicit declaration of function ", "implicitly declaring library function "]
            .iter()
            .find_map(|phrase| line.split_once(phrase));
        let name = rest.and_then(|(_, rest)| rest.trim_start_matches(['\'', '`']).split('\'').next());
        if let Some(name) = name
            && !names.iter().any(|known| known == name)
        {
            names.push(name.to_owned());
        }
    }
    names
}

/// Names of constants and types, in capitals, that the compiler does not know, each once (gcc and clang, `LC_ALL=C`).
pub fn undeclared_constants(output: &str) -> Vec<String> {
    let is_constant = |name: &&str| name.bytes().all(|b| b.is_ascii_uppercase() || b.is_ascii_digit() || b == b'_');
    let mut names: Vec<String> = Vec::new();
    let is_unknown = |line: &&str| {
        let phrases = ["declared", "unknown type name", "does not name a type"];
        line.contains("error: ") && phrases.iter().any(|phrase| line.contains(phrase))
    };
    for line in output.lines().filter(is_unknown) {
        let quoted = line.split(['\'', '`']).nth(1).filter(|name| !name.is_empty()).filter(is_constant);
        names.extend(quoted.map(str::to_owned).filter(|name| !names.contains(name)));
    }
    names
}

/// Returns true if the compiler refuses a name of the program because it is already defined differently.
pub fn is_collision(output: &str) -> bool {
    let phrases = [
        "conflicting",
        "redeclared",
        "redeclaration",
        "redefinition",
        "redefined",
        "ambiguat",
        "is ambiguous",
        "different exception",
        "previous declaration",
        "previous definition",
        "expected identifier before",
        "expected unqualified-id before",
    ];
    phrases.iter().any(|phrase| output.contains(phrase))
}

fn line(text: &mut String, hint: &str) {
    // Writing to a string does not fail.
    let _ = write!(text, "\n  {hint}");
}

fn undefined_hint(undefined: &[String], generation: Generation) -> String {
    let other = generation.other();
    let (of_other, rest): (Vec<&String>, Vec<&String>) =
        undefined.iter().partition(|name| other.has(name) && !generation.has(name));
    let mut hints = String::new();
    if !of_other.is_empty() {
        let (name, own, number) = (other.name(), generation.name(), other.number());
        let functions = quoted(&of_other);
        line(
            &mut hints,
            &format!("{name} has {functions}; this program is built for {own} (`--api {number}` changes that)"),
        );
    }
    for name in &rest {
        if generation.has(name) {
            line(
                &mut hints,
                &format!(
                    "`{name}` is a function of {}, and is declared otherwise: include `eyebot.h`",
                    generation.name()
                ),
            );
        } else if let Some(near) = near_function(name, generation) {
            line(&mut hints, &format!("`{name}` is not defined; did you mean `{near}`?"));
        }
    }
    match rest.as_slice() {
        [] => {}
        [main] if *main == "main" => line(&mut hints, "the program has no function `main`"),
        rest => line(
            &mut hints,
            &format!(
                "not defined: {}; a program of several files is named with all of them (`main.c,map.c`) or by its folder",
                quoted(rest)
            ),
        ),
    }
    hints
}

/// The function of `generation` whose name is most similar to `name`, within an edit distance of a quarter of its length.
fn near_function(name: &str, generation: Generation) -> Option<&'static str> {
    let distance = |function: &&str| strsim::osa_distance(&function.to_lowercase(), &name.to_lowercase());
    let nearest = generation.functions().into_iter().min_by_key(distance)?;
    (distance(&nearest) <= name.len() / 4).then_some(nearest)
}

/// Functions that GNU ld, gold, lld or mold report as undefined, each once; C++ functions without their parameters.
fn undefined_symbols(output: &str) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for line in output.lines() {
        let name = ["undefined reference to ", "undefined symbol: "]
            .iter()
            .find_map(|phrase| Some(line.split_once(phrase)?.1.trim_matches(['`', '\'', ' '])));
        let name = name.map(|name| name.split('(').next().unwrap_or(name));
        if let Some(name) = name
            && !names.iter().any(|known| known == name)
        {
            names.push(name.to_owned());
        }
    }
    names
}

/// The symbols of one source's object file.
#[derive(Debug, Default)]
struct Symbols {
    file: String,
    defined: Vec<String>,
    undefined: Vec<String>,
}

fn symbols_of(objects: &[(&Path, PathBuf)]) -> Vec<Symbols> {
    objects
        .iter()
        .filter_map(|(source, object)| {
            let bytes = fs::read(object).ok()?;
            let object = object::File::parse(&*bytes).ok()?;
            let file = source.file_name()?.display().to_string();
            let mut symbols = Symbols { file, ..Symbols::default() };
            for symbol in object.symbols() {
                let names = if symbol.is_undefined() { &mut symbols.undefined } else { &mut symbols.defined };
                if symbol.is_global()
                    && let Ok(name) = symbol.name()
                {
                    names.push(name.to_owned());
                }
            }
            Some(symbols)
        })
        .collect()
}

/// Advice for each function that one file defines in C and another file uses in C++, or the reverse.
fn linkage_hints(files: &[Symbols]) -> BTreeMap<String, String> {
    let mut hints = BTreeMap::new();
    for user in files {
        for name in &user.undefined {
            let (function, as_what) = match function_of_mangled(name) {
                Some(function) => (function, "C++"),
                None => (name.as_str(), "C"),
            };
            let defines = |file: &&Symbols| match as_what {
                "C++" => file.defined.iter().any(|defined| defined == function),
                _ => file.defined.iter().any(|defined| function_of_mangled(defined) == Some(function)),
            };
            if files.iter().any(|file| file.defined.contains(name)) {
                continue;
            }
            let Some(definer) = files.iter().find(defines) else { continue };
            let own = if as_what == "C" { "C++" } else { "C" };
            let hint = format!(
                "`{function}` is defined in {} as {own} and used from {} as {as_what}: declare it `extern \"C\"` for C++",
                definer.file, user.file
            );
            hints.insert(function.to_owned(), hint);
        }
    }
    hints
}

/// The name of a C++ function outside of classes and namespaces, from its symbol: `_Z4planii` is `plan`.
fn function_of_mangled(symbol: &str) -> Option<&str> {
    let rest = symbol.strip_prefix("_Z")?;
    let digits = rest.find(|c: char| !c.is_ascii_digit())?;
    let length: usize = rest[..digits].parse().ok()?;
    rest.get(digits..digits.checked_add(length)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_of_other_systems_name_what_to_use_instead() {
        let gcc = of_compile("a.c:2:10: fatal error: conio.h: No such file or directory\n");
        assert!(gcc.starts_with("\n  `conio.h`: a robot has no terminal: `KEYRead`"), "{gcc}");
        let clang = of_compile("a.c:1:10: fatal error: 'windows.h' file not found\n");
        assert!(clang.starts_with("\n  `windows.h`: it is of Windows: `OSWait(ms)`"), "{clang}");
        let elsewhere = of_compile("a.c:1:10: fatal error: ../include/EyeBot.h: No such file or directory\n");
        assert_eq!(elsewhere, "\n  `../include/EyeBot.h`: write `#include \"eyebot.h\"`, which eyesim has");
        let misspelt = of_compile("a.c:1:10: fatal error: eyebott.h: No such file or directory\n");
        assert_eq!(misspelt, "\n  `eyebott.h`: write `#include \"eyebot.h\"`, which eyesim has");
        assert_eq!(of_compile("a.c:1:10: fatal error: map.h: No such file or directory\n"), "");
        let unlinked = of_link("undefined reference to `initscr'", &[], Generation::Robios7);
        assert!(unlinked.contains("`curses.h`: a robot has no terminal"), "{unlinked}");
    }

    #[test]
    fn undefined_symbols_are_read_from_each_linker() {
        let gnu = "ld: 0.o: in function `main':\nmaze.c:3: undefined reference to `Plan'\nmaze.c:4: undefined reference to `Plan'";
        let lld = "ld.lld: error: undefined symbol: Plan\n>>> referenced by maze.c:3";
        assert_eq!(undefined_symbols(gnu), ["Plan"]);
        assert_eq!(undefined_symbols(lld), ["Plan"]);
        assert_eq!(undefined_symbols("a.cpp:3: undefined reference to `Plan(int, char*)'"), ["Plan"]);
        assert!(undefined_symbols("maze.c:3: multiple definition of `main'").is_empty());
    }

    #[test]
    fn undeclared_functions_are_read_from_each_compiler() {
        let gcc = "a.c:1:3: warning: implicit declaration of function 'sleep' [-Wimplicit-function-declaration]\n\
                   a.c:9:3: warning: implicit declaration of function 'sleep'; did you mean 'strsep'?";
        assert_eq!(undeclared_functions(gcc), ["sleep"]);
        let clang = "a.c:1:3: warning: implicitly declaring library function 'sqrt' with type 'double (double)'";
        assert_eq!(undeclared_functions(clang), ["sqrt"]);
    }

    #[test]
    fn undeclared_constants_are_read_from_each_compiler() {
        let gcc = "a.c:1:3: error: 'M_PI' undeclared (first use in this function); did you mean 'MIN_PRI'?\n\
                   a.c:2:3: error: 'index' undeclared (first use in this function)\n\
                   a.cpp:3:3: error: 'M_PI' was not declared in this scope";
        assert_eq!(undeclared_constants(gcc), ["M_PI"]);
        assert_eq!(undeclared_constants("a.c:1:3: error: use of undeclared identifier 'TRUE'"), ["TRUE"]);
    }

    #[test]
    fn misspelled_functions_and_those_of_another_generation_are_told() {
        let hint = |names: &[&str], generation| {
            undefined_hint(&names.iter().map(|&name| name.to_owned()).collect::<Vec<_>>(), generation)
        };
        let of_6 = |names: &[&str]| hint(names, Generation::Robios6);
        let of_7 = |names: &[&str]| hint(names, Generation::Robios7);
        assert!(of_6(&["VWDriveStrait"]).contains("`VWDriveStrait` is not defined; did you mean `VWDriveStraight`?"));
        assert!(of_7(&["VWStrait"]).contains("did you mean `VWStraight`?"));
        assert!(of_6(&["psdget"]).contains("did you mean `PSDGet`?"));
        assert_eq!(
            of_6(&["VWStraight"]),
            "\n  RoBIOS-7 has `VWStraight`; this program is built for RoBIOS 6 (`--api 7` changes that)"
        );
        assert!(of_7(&["VWInit"]).contains("RoBIOS 6 has `VWInit`; this program is built for RoBIOS-7 (`--api 6`"));
        assert!(of_7(&["VWStraight"]).contains("include `eyebot.h`"));
        assert!(!of_6(&["Plan"]).contains("did you mean"));
        assert!(of_6(&["Plan"]).contains("named with all of them"));
        assert_eq!(of_6(&["main"]), "\n  the program has no function `main`");
    }

    #[test]
    fn c_and_cpp_that_do_not_meet_are_told() {
        let file = |file: &str, defined: &[&str], undefined: &[&str]| Symbols {
            file: file.to_owned(),
            defined: defined.iter().map(|&name| name.to_owned()).collect(),
            undefined: undefined.iter().map(|&name| name.to_owned()).collect(),
        };
        let hints = linkage_hints(&[
            file("main.cpp", &["main"], &["_Z3mapii", "_Z4plani"]),
            file("map.c", &["map"], &["draw"]),
            file("b.cpp", &["_Z4plani", "_Z4drawv"], &[]),
        ]);
        assert_eq!(hints.len(), 2);
        assert_eq!(
            hints["map"],
            "`map` is defined in map.c as C and used from main.cpp as C++: declare it `extern \"C\"` for C++"
        );
        assert!(hints["draw"].contains("defined in b.cpp as C++ and used from map.c as C"));
        assert_eq!(function_of_mangled("_ZN4maze4planEi"), None);
        assert_eq!(function_of_mangled("_Z99x"), None);
    }
}
