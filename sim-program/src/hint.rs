//! Gives hints on programs that do not compile or link: headers of other systems, misspelled functions, functions of
//! the other generation, missing `extern "C"` between C and C++.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use object::{Object as _, ObjectSymbol as _};
use robios_sys::c;

use super::beside::files_beside;
use super::code::{code_only, is_name};
use super::generation::Generation;
use super::header::{library_hint, nearby_hint};
use super::language::{Language, without_txt};
use super::plain::in_plain_words;
use crate::files::read_regular;

/// Headers of other systems and of terminals, with their replacements in robot programs.
const ABSENT_HEADERS: &[(&[&str], &str)] = &[
    (
        &["conio.h", "curses.h", "ncurses.h", "ncurses/ncurses.h"],
        "a robot has no terminal: `KEYRead` and `KEYGet` read its keys, `getchar` reads the text of `--stdin`, `LCDPrintf` writes to its \
         display",
    ),
    (
        &["windows.h", "Windows.h"],
        "it belongs to Windows: `OSWait(ms)` or `usleep` in place of `Sleep`, `OSGetCount` in place of `GetTickCount`, \
         pthreads in place of `CreateThread`",
    ),
    (&["bool.h"], "write `#include <stdbool.h>`"),
];

/// Headers of RoBIOS 6 itself that its programs may name; our `eyebot.h` contains what they declare.
const ROBIOS_PARTS: [&str; 14] = [
    "cam.h",
    "hdt.h",
    "improc.h",
    "irtv.h",
    "kern.h",
    "key.h",
    "keys.h",
    "lcd.h",
    "librobi.h",
    "motors.h",
    "psd.h",
    "rob.h",
    "sensors.h",
    "vw.h",
];

/// Headers of C++ before its standard of 1998, without their extension.
const OLD_CPP_HEADERS: [&str; 5] = ["fstream", "iomanip", "iostream", "istream", "ostream"];

/// Symbols of the library curses; almost every program for curses uses one of them.
const CURSES_FUNCTIONS: [&str; 4] = ["initscr", "endwin", "wgetch", "stdscr"];

/// Functions of other systems, with their replacements in robot programs.
const FOREIGN_FUNCTIONS: &[(&[&str], &str)] = &[
    (&["Sleep"], "is a function of Windows: `OSWait(ms)` waits"),
    (&["delay"], "is a function of Arduino and Borland C: `OSWait(ms)` waits"),
    (&["clrscr"], "is a function of Borland C: `LCDClear()` clears the display"),
    (&["getch", "getche"], "is a function of Borland C: `KEYGet()` waits for a key of the robot"),
    (&["kbhit"], "is a function of Borland C: `KEYRead()` returns the key that is pressed, or 0"),
    (&["gotoxy"], "is a function of Borland C: `LCDSetPos(row, column)` sets the position of the next text"),
    (&["cprintf"], "is a function of Borland C: `LCDPrintf` writes to the display"),
    (&["itoa"], "is not in every C library: `sprintf(text, \"%d\", number)` does the same"),
    (
        &["digitalWrite", "analogWrite"],
        "is a function of Arduino: `MOTORDrive` and `SERVOSet` set outputs of the robot",
    ),
    (&["digitalRead", "analogRead"], "is a function of Arduino: `PSDGet` and `DIGITALRead` read inputs of the robot"),
    (&["GetTickCount"], "is a function of Windows: `OSGetCount` returns the time in ms"),
];

/// Hints on the compiler's message `output` about `source`, one per line: missing headers, another encoding,
/// typographic quotes. If there are none, returns the message in plain words, or an empty text.
pub fn compile_hints(output: &str, source: &Path, generation: Generation) -> String {
    let text = fs::read(source).unwrap_or_default();
    let name = source.file_name().unwrap_or_default().display().to_string();
    if text.starts_with(b"\xFF\xFE") || text.starts_with(b"\xFE\xFF") {
        return format!("{name} is UTF-16: save it as UTF-8\n");
    }
    let header = output.lines().find_map(missing_header).and_then(|missing| missing_header_hint(missing, source));
    let text = String::from_utf8_lossy(&text);
    let hints = [header, undeclared_hint(output, &text, generation), letter_hint(output, &text)];
    let hints: String = hints.into_iter().flatten().map(|hint| format!("{name}{hint}\n")).collect();
    if hints.is_empty() { in_plain_words(output, (&name, &text)) } else { hints }
}

/// Hint on the missing header `missing` that `source` includes, as the text after the source's name.
fn missing_header_hint(missing: &str, source: &Path) -> Option<String> {
    let name = missing.rsplit(['/', '\\']).next().unwrap_or(missing);
    if let Some((_, instead)) = ABSENT_HEADERS.iter().find(|(headers, _)| headers.contains(&missing)) {
        Some(format!(": `{missing}`: {instead}"))
    } else if name.to_lowercase().starts_with("robios") || name.eq_ignore_ascii_case("eyebot.h") {
        Some(format!(": there is no `{missing}`: write `#include \"eyebot.h\"`"))
    } else if let Some(hint) = nearby_hint(missing, source).or_else(|| library_hint(missing)) {
        Some(hint)
    } else if ROBIOS_PARTS.contains(&name.to_lowercase().as_str()) {
        Some(format!(": `{missing}` is a part of RoBIOS: remove the line, since `eyebot.h` contains it"))
    } else if let Some(new) = name.strip_suffix(".h").filter(|new| OLD_CPP_HEADERS.contains(new)) {
        Some(format!(
            ": `{missing}` is older than standard C++: write `#include <{new}>` and below it `using namespace std;`"
        ))
    } else if let Some(similar) = similar_header(name) {
        Some(format!(": there is no `{missing}`: write `#include \"{similar}\"`"))
    } else if Language::of(source) == Some(Language::C) && !missing.contains(['.', '/']) {
        // Headers of the C++ library have no extension.
        let cpp = without_txt(source).with_extension("cpp");
        let cpp = cpp.file_name().unwrap_or_default().display();
        Some(format!(" includes `{missing}`, so this is C++: name the file `{cpp}`, and in the scene too"))
    } else {
        Some(format!(
            ": `{missing}` is not beside the program, and no part of eyesim or of the compiler: copy the file into the program's folder, or \
             remove the line"
        ))
    }
}

/// Hint on functions of RoBIOS that are undeclared because the program's `text` does not include their header.
fn undeclared_hint(output: &str, text: &str, generation: Generation) -> Option<String> {
    let is_unknown = |line: &&str| {
        line.contains("error: ")
            && ["not declared in this scope", "undeclared identifier"].iter().any(|phrase| line.contains(phrase))
    };
    let mut names = output.lines().filter(is_unknown).filter_map(|line| line.split(['\'', '`']).nth(1));
    let is_included = text.lines().any(|line| line.trim_start().starts_with('#') && line.contains("eyebot"));
    (!is_included && names.any(|name| generation.has_function(name)))
        .then(|| format!(": {MISSING_HEADER}: write it as the first line"))
}

/// Beginning of the message about a program that does not include the header of RoBIOS.
pub const MISSING_HEADER: &str = "`#include \"eyebot.h\"` is missing";

/// Hint on the first letter outside of ASCII that word processors, web pages and other systems put into code, with its
/// line, if the compiler reports such letters.
fn letter_hint(output: &str, text: &str) -> Option<String> {
    let is_stray = |line: &str| {
        line.contains("error: stray ")
            || line.contains("extended character")
            || line.contains("unexpected character <U+")
    };
    let advice = |letter: char| match letter {
        '\u{201C}' | '\u{201D}' | '\u{201E}' => Some(format!("`{letter}` is a typographic quote: write `\"`")),
        '\u{2018}' | '\u{2019}' | '\u{201A}' => Some(format!("`{letter}` is a typographic quote: write `'`")),
        '\u{2212}' | '\u{2013}' | '\u{2014}' => Some(format!("`{letter}` is a typographic dash: write `-`")),
        '\u{D7}' => Some(format!("`{letter}` is no operator: write `*`")),
        '\u{B0}' => Some(format!("`{letter}` is no part of a number: leave it out")),
        '\u{A0}' => Some("a blank of this line comes from a page or a word processor: type it again".to_owned()),
        '\u{1A}' => Some("this line has the letter with which DOS ends a file: delete it".to_owned()),
        char::REPLACEMENT_CHARACTER => Some("a letter of this line is not UTF-8: save the file as UTF-8".to_owned()),
        _ => None,
    };
    let code = code_only(text);
    let mut lines = code.lines().enumerate().filter(|_| output.lines().any(is_stray));
    lines.find_map(|(index, line)| Some(format!(":{}: {}", index + 1, line.chars().find_map(advice)?)))
}

/// The header of eyesim with a name similar to `name`: capitals are ignored, and a quarter of the letters may differ.
fn similar_header(name: &str) -> Option<&'static str> {
    let distance = |header: &&str| strsim::osa_distance(header, &name.to_lowercase());
    let nearest = ["eyebot.h", "eyebot++.h", "types.h"].into_iter().min_by_key(distance)?;
    (distance(&nearest) <= name.len() / 4 || name.eq_ignore_ascii_case("eyebot")).then_some(nearest)
}

/// The header that the compiler does not find, as written in the program (gcc and clang, `LC_ALL=C`).
fn missing_header(line: &str) -> Option<&str> {
    let (_, rest) = line.split_once("fatal error: ")?;
    let missing = rest.strip_suffix(": No such file or directory").or_else(|| rest.strip_suffix(" file not found"))?;
    Some(missing.trim_matches('\''))
}

/// Hints on the linker's message `output`, one per line; `objects` are the sources with their object files.
pub fn link_hints(output: &str, objects: &[(&Path, PathBuf)], generation: Generation) -> String {
    let symbols = symbols_of(objects);
    let linkage = linkage_hints(&symbols);
    let mut undefined = undefined_symbols(output);
    undefined.retain(|symbol| !linkage.contains_key(&symbol.name));
    let beside = beside_hints(&mut undefined, objects, generation);
    let defined: Vec<&str> =
        symbols.iter().flat_map(|file| &file.defined).map(|name| function_of_mangled(name).unwrap_or(name)).collect();
    let mut hints = undefined_hint(&undefined, &defined, generation);
    if undefined.iter().any(|symbol| symbol.name == "main") {
        push_line(&mut hints, &missing_main_hint(&symbols, objects));
    }
    if undefined.iter().any(|symbol| CURSES_FUNCTIONS.contains(&symbol.name.as_str())) {
        push_line(&mut hints, &format!("`curses.h`: {}", ABSENT_HEADERS[0].1));
    }
    linkage.values().for_each(|hint| push_line(&mut hints, hint));
    hints.insert_str(0, &beside);
    hints.push_str(&doubly_defined_hints(output));
    if DOUBLE_MAIN.iter().any(|phrase| output.contains(phrase)) {
        let example = objects.first().and_then(|(source, _)| source.file_name()).unwrap_or_default();
        push_line(
            &mut hints,
            &format!(
                "these files are several programs, each with a `main`: name one of them (`{}`) and not their folder",
                example.display()
            ),
        );
    }
    hints
}

/// Hints on functions and variables that several files define, one line each (GNU ld, `LC_ALL=C`), except on `main`.
fn doubly_defined_hints(output: &str) -> String {
    let mut hints = String::new();
    for line in output.lines() {
        let Some((before, rest)) = line.split_once(": multiple definition of `") else { continue };
        let Some((name, first)) = rest.split_once("'; ").filter(|(name, _)| *name != "main") else { continue };
        // The linker names the object file before the place of a variable only.
        let is_variable = before.contains(".o:");
        let place = |text: &str| {
            let (path, line) = text.rsplit_once(':')?;
            let path = Path::new(path.rsplit(".o:").next()?);
            let place = format!("{}:{line}", path.file_name()?.display());
            // For a function of a header, the linker names the file that includes it, with the line in the header.
            let line = line.parse().ok()?;
            (is_variable || names_function(path, line, name)).then_some(place)
        };
        let places = place(before).zip(first.strip_suffix(": first defined here").and_then(place));
        let hint = match places {
            Some((second, first)) if second != first && is_variable => format!(
                "{second}: `{name}` is also defined in {first}: if both files share it, write `extern` before it in one of them, and no \
                 value after it; otherwise give one of them another name"
            ),
            Some((second, first)) if second != first => format!(
                "{second}: `{name}` is also defined in {first}: give one of them another name, or write `static` before both"
            ),
            Some((_, first)) if is_variable => format!(
                "{first}: `{name}` is defined in every file that includes this header: write `extern` before it and no value after \
                 it, and define it in one of the files"
            ),
            None if is_variable => continue,
            _ => format!(
                "`{name}` is defined in several files, or in a header that several include: write `static` before it, or leave it in \
                 one of the files"
            ),
        };
        if !hints.lines().any(|line| line == hint) {
            push_line(&mut hints, &hint);
        }
    }
    hints
}

/// Returns true if a line of the source, or the line before it, contains the name of `function`, which may be a
/// signature of C++.
fn names_function(source: &Path, line: usize, function: &str) -> bool {
    let name = function.split('(').next().and_then(|name| name.rsplit(':').next()).unwrap_or(function);
    let Ok(bytes) = read_regular(source) else { return false };
    let text = String::from_utf8_lossy(&bytes);
    let mut lines = text.lines().skip(line.saturating_sub(2)).take(line.min(2));
    lines.any(|line| line.split(|letter| !is_name(letter)).any(|word| word == name))
}

const DOUBLE_MAIN: [&str; 2] = ["multiple definition of `main'", "duplicate symbol: main"];

/// Returns true if the linker's message `output` (GNU ld) is only about undefined symbols and a second `main`, for
/// which [`link_hints`] has hints.
pub fn is_explained(output: &str) -> bool {
    const KNOWN: [&str; 6] = [
        "undefined reference",
        "in function `",
        "ld returned",
        "first defined here",
        "multiple definition of `main'",
        "undefined references to",
    ];
    output.lines().filter(|line| !line.trim().is_empty()).all(|line| KNOWN.iter().any(|known| line.contains(known)))
}

/// Hints on `undefined` functions and variables that files beside the program define, one line per file; removes these
/// from `undefined`.
fn beside_hints(undefined: &mut Vec<Undefined>, objects: &[(&Path, PathBuf)], generation: Generation) -> String {
    let sources: Vec<&Path> = objects.iter().map(|(source, _)| *source).collect();
    let names: Vec<String> = sources
        .iter()
        .filter_map(|source| source.file_name())
        .map(|name| name.to_string_lossy().into_owned())
        .collect();
    let mut files = files_beside(&sources);
    // A file without `main` can be added to the program.
    files.sort_by_key(|file| file.is_program);
    let (mut hints, mut added) = (String::new(), names.clone());
    for file in &files {
        let is_here = |symbol: &Undefined| {
            symbol.name != "main" && file.defines(&symbol.name) && !generation.has_function(&symbol.name)
        };
        let (here, elsewhere): (Vec<Undefined>, Vec<Undefined>) =
            std::mem::take(undefined).into_iter().partition(is_here);
        *undefined = elsewhere;
        if here.is_empty() {
            continue;
        }
        let (defined, is_are) = (quoted_names(&here), if here.len() == 1 { "is" } else { "are" });
        let (name, program) = (&file.name, names.join(","));
        if file.is_program {
            push_line(
                &mut hints,
                &format!(
                    "{defined} {is_are} defined in `{name}`, which is a program of its own: copy from there what `{program}` uses"
                ),
            );
        } else {
            added.push(name.clone());
            push_line(
                &mut hints,
                &format!(
                    "{defined} {is_are} defined in `{name}`, which is not a part of the program: write `{}` in place of `{program}`",
                    added.join(",")
                ),
            );
        }
    }
    hints
}

/// The names of the first five symbols in backquotes, and the number of the others.
fn quoted_names(symbols: &[Undefined]) -> String {
    const MAX_NAMES: usize = 5;
    let names: Vec<&String> = symbols.iter().take(MAX_NAMES).map(|symbol| &symbol.name).collect();
    match symbols.len().saturating_sub(MAX_NAMES) {
        0 => quoted(&names),
        more => format!("{} and {more} more", quoted(&names)),
    }
}

/// Hint on a program without `main`.
fn missing_main_hint(files: &[Symbols], objects: &[(&Path, PathBuf)]) -> String {
    let is_blank = |(source, _): &&(&Path, PathBuf)| fs::read(source).is_ok_and(|text| text.trim_ascii().is_empty());
    let names = |(source, _): &(&Path, PathBuf)| source.file_name().unwrap_or_default().display().to_string();
    if let [source] = objects
        && is_blank(&source)
    {
        return format!("`{}` is empty", names(source));
    }
    let functions: Vec<(&str, &str)> = files
        .iter()
        .flat_map(|file| {
            file.defined.iter().map(|name| (file.file.as_str(), function_of_mangled(name).unwrap_or(name)))
        })
        .collect();
    let has = |wanted: &str| functions.iter().any(|(_, name)| *name == wanted);
    if has("setup") && has("loop") {
        return "the program has no function `main`: `setup` and `loop` are called by Arduino only; \
                write `int main(void) { setup(); while (1) loop(); }`"
            .to_owned();
    }
    match functions.iter().find(|(_, name)| strsim::osa_distance(&name.to_lowercase(), "main") <= 1) {
        Some((file, name)) => format!("{file}: the program has no function `main`; did you mean `main` by `{name}`?"),
        None => "the program has no function `main`".to_owned(),
    }
}

/// The names in backquotes, separated by commas.
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

/// Undeclared names in capitals, of constants and types, and old names of types according to the compiler, each once
/// (gcc and clang, `LC_ALL=C`).
pub fn undeclared_constants(output: &str) -> Vec<String> {
    let is_capital = |b: u8| b.is_ascii_uppercase() || b.is_ascii_digit() || b == b'_';
    let is_constant = |name: &&str| name.bytes().all(is_capital) || c::OLD_NAMES.contains(name);
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

/// Returns true if a source in C++ may be refused only because its standard is C++17 or newer.
pub fn is_refused_since_cpp17(output: &str) -> bool {
    ["ISO C++17 does not allow", "is ambiguous"].iter().any(|phrase| output.contains(phrase))
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

fn push_line(text: &mut String, hint: &str) {
    text.push_str(hint);
    text.push('\n');
}

/// A function or variable that is used and not defined.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Undefined {
    name: String,
    /// File and line of the first use, if the linker reports them.
    place: Option<String>,
}

/// Hints on undefined symbols except `main`: a line for each, but a single line for all functions of the other
/// generation.
/// `defined` are the functions of the program.
fn undefined_hint(undefined: &[Undefined], defined: &[&str], generation: Generation) -> String {
    let other = generation.other();
    let (other_symbols, rest): (Vec<&Undefined>, Vec<&Undefined>) =
        undefined.iter().partition(|symbol| other.has_function(&symbol.name) && !generation.has_function(&symbol.name));
    let mut hints = String::new();
    if !other_symbols.is_empty() {
        let (name, built_for, number) = (other.name(), generation.name(), other.number());
        let functions = quoted(&other_symbols.iter().map(|symbol| &symbol.name).collect::<Vec<_>>());
        push_line(
            &mut hints,
            &format!("{name} has {functions}; this program is built for {built_for} (`--api {number}` changes that)"),
        );
    }
    for Undefined { name, place } in rest.into_iter().filter(|symbol| symbol.name != "main") {
        let place = place.as_ref().map(|place| format!("{place}: ")).unwrap_or_default();
        let foreign = FOREIGN_FUNCTIONS.iter().find(|(names, _)| names.contains(&name.as_str()));
        let explanation = if generation.has_function(name) {
            format!("is a function of {}, and is declared otherwise: include `eyebot.h`", generation.name())
        } else if let Some((_, explanation)) = foreign {
            (*explanation).to_owned()
        } else if let Some(similar) =
            nearest(defined.iter().copied(), name).or_else(|| similar_function(name, generation))
        {
            format!("is not defined; did you mean `{similar}`?")
        } else {
            "is used and nowhere defined: write it; a program of several files is named with all of them \
             (`main.c,map.c`) or by its folder"
                .to_owned()
        };
        push_line(&mut hints, &format!("{place}`{name}` {explanation}"));
    }
    hints
}

/// Functions of the C library that beginners use.
const C_FUNCTIONS: [&str; 14] = [
    "printf", "scanf", "puts", "getchar", "malloc", "free", "strlen", "strcmp", "strcpy", "atoi", "abs", "rand",
    "sqrt", "exit",
];

/// The function whose name is most similar to `name`, within an edit distance of a quarter of its length. At equal
/// distance, functions of `generation` precede those of the other generation, and these precede those of C.
fn similar_function(name: &str, generation: Generation) -> Option<&'static str> {
    nearest(generation.functions().into_iter().chain(generation.other().functions()).chain(C_FUNCTIONS), name)
}

fn nearest<'a>(functions: impl Iterator<Item = &'a str>, name: &str) -> Option<&'a str> {
    let distance = |function: &&str| strsim::osa_distance(&function.to_lowercase(), &name.to_lowercase());
    let nearest = functions.min_by_key(distance)?;
    (distance(&nearest) <= name.len() / 4).then_some(nearest)
}

/// The names that a linker reports as undefined or as defined more than once.
pub fn unlinked_names(output: &str) -> Vec<String> {
    let phrases = ["multiple definition of ", "duplicate symbol: "];
    let duplicates = output.lines().filter_map(|line| {
        let (_, rest) = phrases.iter().find_map(|phrase| line.split_once(phrase))?;
        Some(rest.trim_start_matches('`').split(['\'', ';', ' ']).next()?.to_owned())
    });
    duplicates.chain(undefined_symbols(output).into_iter().map(|symbol| symbol.name)).collect()
}

/// Functions that GNU ld, gold, lld or mold report as undefined, each once; C++ functions without their parameters.
/// Only GNU ld reports their places.
fn undefined_symbols(output: &str) -> Vec<Undefined> {
    let mut found: Vec<Undefined> = Vec::new();
    for line in output.lines() {
        let parts = ["undefined reference to ", "undefined symbol: "].iter().find_map(|phrase| line.split_once(phrase));
        let Some((prefix, name)) = parts else { continue };
        let name = name.trim_matches(['`', '\'', ' ']);
        let name = name.split('(').next().unwrap_or(name);
        if !found.iter().any(|known| known.name == name) {
            found.push(Undefined { name: name.to_owned(), place: place_of(prefix) });
        }
    }
    found
}

/// Parses the place before a linker's message: `maze.c:3` from `/p/maze.c:3: ` or `/p/maze.c:3:(.text+0x1f): `.
fn place_of(prefix: &str) -> Option<String> {
    let (path, rest) = prefix.rsplit_once('/').map_or(("", prefix), |(folder, rest)| (folder, rest));
    let (file, rest) = rest.split_once(':')?;
    let number = rest.split(':').next()?.trim();
    let is_place = !path.contains(": ") && !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit());
    is_place.then(|| format!("{file}:{number}"))
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

/// Hints on functions that one file defines in C and another file uses in C++, or vice versa, by their names.
fn linkage_hints(files: &[Symbols]) -> BTreeMap<String, String> {
    let mut hints = BTreeMap::new();
    for user in files {
        for name in &user.undefined {
            let (function, used_as) = match function_of_mangled(name) {
                Some(function) => (function, "C++"),
                None => (name.as_str(), "C"),
            };
            let defines = |file: &&Symbols| match used_as {
                "C++" => file.defined.iter().any(|defined| defined == function),
                _ => file.defined.iter().any(|defined| function_of_mangled(defined) == Some(function)),
            };
            if files.iter().any(|file| file.defined.contains(name)) {
                continue;
            }
            let Some(definer) = files.iter().find(defines) else { continue };
            let defined_as = if used_as == "C" { "C++" } else { "C" };
            let hint = format!(
                "`{function}` is defined in {} as {defined_as} and used from {} as {used_as}: declare it `extern \"C\"` for C++",
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

    fn source_hints(output: &str, name: &str, text: &[u8]) -> String {
        let folder = tempfile::tempdir().expect("a folder");
        let source = folder.path().join(name);
        fs::write(&source, text).expect("a source");
        compile_hints(output, &source, Generation::Robios7)
    }

    #[test]
    fn headers_of_other_systems_have_replacements() {
        let gcc = source_hints("a.c:2:10: fatal error: conio.h: No such file or directory\n", "a.c", b"");
        assert!(gcc.starts_with("a.c: `conio.h`: a robot has no terminal: `KEYRead`"), "{gcc}");
        let bool = source_hints("a.c:2:10: fatal error: bool.h: No such file or directory\n", "a.c", b"");
        assert_eq!(bool, "a.c: `bool.h`: write `#include <stdbool.h>`\n");
        let clang = source_hints("a.c:1:10: fatal error: 'windows.h' file not found\n", "a.c", b"");
        assert!(clang.starts_with("a.c: `windows.h`: it belongs to Windows: `OSWait(ms)`"), "{clang}");
        for missing in ["../include/EyeBot.h", "eyebott.h", "eyebot", "robios.h", "RoBIOS7.h"] {
            let output = format!("a.c:1:10: fatal error: {missing}: No such file or directory\n");
            let expected = format!("a.c: there is no `{missing}`: write `#include \"eyebot.h\"`\n");
            assert_eq!(source_hints(&output, "a.c", b""), expected);
        }
        let old = source_hints("a.cpp:1:10: fatal error: iostream.h: No such file or directory\n", "a.cpp", b"");
        assert!(
            old.starts_with("a.cpp: `iostream.h` is older than standard C++: write `#include <iostream>`"),
            "{old}"
        );
        let part = source_hints("a.c:1:10: fatal error: lcd.h: No such file or directory\n", "a.c", b"");
        assert!(part.starts_with("a.c: `lcd.h` is a part of RoBIOS: remove the line"), "{part}");
        let other = source_hints("a.c:1:10: fatal error: im.h: No such file or directory\n", "a.c", b"");
        assert!(other.starts_with("a.c: `im.h` is not beside the program"), "{other}");
        let library = source_hints("a.c:1:10: fatal error: fann.h: No such file or directory\n", "a.c", b"");
        assert!(library.starts_with("a.c: `fann.h` belongs to FANN"), "{library}");
        let unlinked = link_hints("undefined reference to `initscr'", &[], Generation::Robios7);
        assert!(unlinked.contains("`curses.h`: a robot has no terminal"), "{unlinked}");
        let borland = link_hints("undefined reference to `getch'", &[], Generation::Robios7);
        assert!(borland.contains("`getch` is a function of Borland C: `KEYGet()` waits"), "{borland}");
    }

    #[test]
    fn cpp_in_a_c_file_is_reported() {
        let output = "a.c:1:10: fatal error: iostream: No such file or directory\n";
        let hint = "a.c includes `iostream`, so this is C++: name the file `a.cpp`, and in the scene too\n";
        assert_eq!(source_hints(output, "a.c", b""), hint);
        assert!(!source_hints(output, "a.cpp", b"").contains("C++"));
    }

    #[test]
    fn missing_include_is_reported_in_one_line() {
        let output = "a.cpp:3:3: error: 'VWStraight' was not declared in this scope\n";
        let hint = "a.cpp: `#include \"eyebot.h\"` is missing: write it as the first line\n";
        assert_eq!(source_hints(output, "a.cpp", b"int main() {}"), hint);
        assert!(!source_hints(output, "a.cpp", b"# include \"eyebot.h\"\n").contains("eyebot.h"));
        let other = "a.cpp:3:3: error: 'Plan' was not declared in this scope\n";
        assert!(!source_hints(other, "a.cpp", b"").contains("eyebot.h"));
    }

    #[test]
    fn letters_of_other_systems_are_reported() {
        let hint = |code: &str| letter_hint("a.c:1:9: error: stray '\\302' in program\n", code).unwrap_or_default();
        assert_eq!(hint("VWTurn(90\u{B0}, 45); /* 90\u{B0} */"), ":1: `\u{B0}` is no part of a number: leave it out");
        assert_eq!(hint("// \u{2212}\nx = \u{2212}5;"), ":2: `\u{2212}` is a typographic dash: write `-`");
        assert_eq!(hint("int gr\u{FFFD};"), ":1: a letter of this line is not UTF-8: save the file as UTF-8");
        assert_eq!(hint("}\n\u{1A}"), ":2: this line has the letter with which DOS ends a file: delete it");
        assert_eq!(hint("\"90\u{B0}\" @"), "");
    }

    #[test]
    fn functions_and_variables_of_several_files_are_reported() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().display();
        fs::write(folder.path().join("a.cpp"), "#include \"robot.h\"\n\nint turn(int a)\n{ return a; }\n")
            .expect("a source");
        fs::write(folder.path().join("b.cpp"), "#include \"robot.h\"\nint turn(int a)\n{\n return a; }\n")
            .expect("a source");
        // `step` and `counter` are in line 4 and 7 of the header.
        let output = format!(
            "/usr/bin/ld: /t/1.o: in function `step':\n\
             {path}/b.cpp:4: multiple definition of `step'; /t/0.o:{path}/a.cpp:4: first defined here\n\
             /usr/bin/ld: /t/1.o:{path}/robot.h:7: multiple definition of `counter'; /t/0.o:{path}/robot.h:7: first defined here\n\
             /usr/bin/ld: /t/1.o: in function `turn(int)':\n\
             {path}/b.cpp:3: multiple definition of `turn(int)'; /t/0.o:{path}/a.cpp:4: first defined here\n\
             {path}/b.cpp:7: multiple definition of `main'; /t/0.o:{path}/a.cpp:8: first defined here\n\
             /usr/bin/ld: /t/2.o: in function `step':\n\
             {path}/c.cpp:4: multiple definition of `step'; /t/0.o:{path}/a.cpp:4: first defined here\n"
        );
        let expected = "`step` is defined in several files, or in a header that several include: write `static` before it, or leave it in \
                        one of the files\n\
                        robot.h:7: `counter` is defined in every file that includes this header: write `extern` before it and no value after \
                        it, and define it in one of the files\n\
                        b.cpp:3: `turn(int)` is also defined in a.cpp:4: give one of them another name, or write `static` before both\n";
        assert_eq!(doubly_defined_hints(&output), expected);
    }

    #[test]
    fn other_encodings_and_typographic_quotes_are_reported() {
        assert_eq!(
            source_hints("error: stray '\\377' in program", "a.c", b"\xFF\xFEi\0"),
            "a.c is UTF-16: save it as UTF-8\n"
        );
        let text = "int i;\nf(\u{201C}a\u{201D});\n".as_bytes();
        let hint = "a.c:2: `\u{201C}` is a typographic quote: write `\"`\n";
        assert_eq!(source_hints("a.c:2:3: error: stray '\\342' in program", "a.c", text), hint);
        assert!(!source_hints("a.c:1:3: error: expected ';'", "a.c", text).contains("quote"));
    }

    fn undefined(name: &str, place: Option<&str>) -> Undefined {
        Undefined { name: name.to_owned(), place: place.map(str::to_owned) }
    }

    #[test]
    fn undefined_symbols_of_each_linker_are_parsed() {
        let gnu = "ld: 0.o: in function `main':\n/p/maze.c:3: undefined reference to `Plan'\n/p/maze.c:4: undefined reference to `Plan'";
        let lld = "ld.lld: error: undefined symbol: Plan\n>>> referenced by maze.c:3";
        assert_eq!(undefined_symbols(gnu), [undefined("Plan", Some("maze.c:3"))]);
        assert_eq!(undefined_symbols(lld), [undefined("Plan", None)]);
        let cpp = "/usr/bin/ld: /p/a.cpp:3:(.text+0x1f): undefined reference to `Plan(int, char*)'";
        assert_eq!(undefined_symbols(cpp), [undefined("Plan", None)]);
        let cpp = "/p/a.cpp:3:(.text+0x1f): undefined reference to `Plan(int, char*)'";
        assert_eq!(undefined_symbols(cpp), [undefined("Plan", Some("a.cpp:3"))]);
        assert!(undefined_symbols("maze.c:3: multiple definition of `main'").is_empty());
        let twice = "ld: 1.o: in function `turn':\n/p/a.c:2: multiple definition of `turn'; 0.o:/p/a.c:2: first defined here\n\
                     ld.lld: error: duplicate symbol: draw\n/p/a.c:3: undefined reference to `Plan'";
        assert_eq!(unlinked_names(twice), ["turn", "draw", "Plan"]);
        assert!(is_explained(gnu) && is_explained(&format!("{gnu}\ncollect2: error: ld returned 1 exit status\n")));
        assert!(!is_explained(&format!("{gnu}\n/usr/bin/ld: cannot find -lmap")));
    }

    #[test]
    fn hint_on_a_missing_main_names_similar_functions() {
        let hint = |functions: &[&str]| {
            let defined = functions.iter().map(|&name| name.to_owned()).collect();
            missing_main_hint(&[Symbols { file: "a.c".into(), defined, undefined: Vec::new() }], &[])
        };
        assert_eq!(hint(&["Main"]), "a.c: the program has no function `main`; did you mean `main` by `Main`?");
        assert_eq!(hint(&["_Z4mianv"]), "a.c: the program has no function `main`; did you mean `main` by `mian`?");
        assert!(hint(&["setup", "loop"]).contains("Arduino"));
        assert_eq!(hint(&["plan"]), "the program has no function `main`");
        let folder = tempfile::tempdir().expect("a folder");
        let source = folder.path().join("a.c");
        fs::write(&source, " \n").expect("a source");
        assert_eq!(missing_main_hint(&[], &[(&source, PathBuf::new())]), "`a.c` is empty");
    }

    #[test]
    fn files_beside_the_program_that_define_its_functions_are_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let source = |name: &str, text: &str| {
            let path = folder.path().join(name);
            fs::write(&path, text).expect("a source");
            path
        };
        let main = source("main.c", "int main(void) { return plan() + draw() + count + turn(); }\n");
        source("map.c", "int count = 2;\nint plan(void)\n{ return 1; }\nint draw(void) { return 1; }\n");
        source(
            "other.c",
            "int turn(void) { return 3; }\nint draw(void) { return 4; }\nint main(void) { return turn(); }\n",
        );
        let output = "ld: main.c:1: undefined reference to `plan'\nmain.c:1: undefined reference to `draw'\n\
                      main.c:1: undefined reference to `count'\nmain.c:1: undefined reference to `turn'\n\
                      main.c:1: undefined reference to `nothing'\n";
        let hints = link_hints(output, &[(&main, PathBuf::new())], Generation::Robios7);
        let lines: Vec<&str> = hints.lines().collect();
        assert_eq!(
            lines[..2],
            [
                "`plan`, `draw`, `count` are defined in `map.c`, which is not a part of the program: write `main.c,map.c` in place of `main.c`",
                "`turn` is defined in `other.c`, which is a program of its own: copy from there what `main.c` uses",
            ]
        );
        assert!(lines.len() == 3 && lines[2].contains("`nothing` is used and nowhere defined"), "{hints}");
    }

    #[test]
    fn undeclared_functions_of_each_compiler_are_parsed() {
        let gcc = "a.c:1:3: warning: implicit declaration of function 'sleep' [-Wimplicit-function-declaration]\n\
                   a.c:9:3: warning: implicit declaration of function 'sleep'; did you mean 'strsep'?";
        assert_eq!(undeclared_functions(gcc), ["sleep"]);
        let clang = "a.c:1:3: warning: implicitly declaring library function 'sqrt' with type 'double (double)'";
        assert_eq!(undeclared_functions(clang), ["sqrt"]);
    }

    #[test]
    fn undeclared_constants_of_each_compiler_are_parsed() {
        let gcc = "a.c:1:3: error: 'M_PI' undeclared (first use in this function); did you mean 'MIN_PRI'?\n\
                   a.c:2:3: error: 'index' undeclared (first use in this function)\n\
                   a.cpp:3:3: error: 'M_PI' was not declared in this scope";
        assert_eq!(undeclared_constants(gcc), ["M_PI"]);
        assert_eq!(undeclared_constants("a.c:1:3: error: use of undeclared identifier 'TRUE'"), ["TRUE"]);
        assert_eq!(undeclared_constants("a.c:1:3: error: unknown type name 'keycode_t'"), ["keycode_t"]);
    }

    #[test]
    fn misspelled_functions_and_those_of_another_generation_are_reported() {
        let hint = |names: &[&str], generation| {
            let undefined: Vec<_> = names.iter().map(|name| undefined(name, None)).collect();
            undefined_hint(&undefined, &["driveHome", "main"], generation)
        };
        let of_6 = |names: &[&str]| hint(names, Generation::Robios6);
        let of_7 = |names: &[&str]| hint(names, Generation::Robios7);
        assert!(of_6(&["VWDriveStrait"]).contains("`VWDriveStrait` is not defined; did you mean `VWDriveStraight`?"));
        assert!(of_7(&["VWStrait"]).contains("did you mean `VWStraight`?"));
        assert!(of_7(&["driveHom"]).contains("did you mean `driveHome`?"));
        assert!(of_6(&["psdget"]).contains("did you mean `PSDGet`?"));
        assert_eq!(
            of_6(&["VWStraight"]),
            "RoBIOS-7 has `VWStraight`; this program is built for RoBIOS 6 (`--api 7` changes that)\n"
        );
        assert!(of_7(&["VWInit"]).contains("RoBIOS 6 has `VWInit`; this program is built for RoBIOS-7 (`--api 6`"));
        assert!(of_7(&["VWStraight"]).contains("include `eyebot.h`"));
        assert!(!of_6(&["Plan"]).contains("did you mean"));
        assert!(of_6(&["Plan"]).contains("named with all of them"));
        assert_eq!(of_6(&["main"]), "");
    }

    #[test]
    fn linkage_mismatch_of_c_and_cpp_is_reported() {
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
