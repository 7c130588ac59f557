//! Translates messages of C and C++ compilers into plain words: one line for each, with the mistake and what to write
//! instead. The compiler's own messages follow after these lines.

use std::path::Path;

use console::measure_text_width;

use super::access::{Accesses, IndexedArray, accesses_of};
use super::brace::unclosed_brace;
use super::calls::calls_of;
use super::code::{TYPES, begins_function, code_only, is_name};
use super::generation::SIZES_OF_7;
use super::language::{Language, without_txt};

/// Maximum number of translated lines.
const MAX_LINES: usize = 5;

/// Maximum number of messages that are examined.
const MAX_MESSAGES: usize = 50;

/// A message of the compiler about a line of the program (gcc and clang, `LC_ALL=C`).
struct Message<'a> {
    file: &'a str,
    line: &'a str,
    column: usize,
    is_error: bool,
    text: &'a str,
    /// Lines between this message and the next: excerpts and notes.
    details: &'a [&'a str],
    /// According to gcc, the line is inside a function or a lambda.
    is_in_function: bool,
    /// Signature of the function that contains the line, according to gcc: `int home(int)`; empty for a lambda and if
    /// unknown.
    function: &'a str,
    /// Text of the compiled source; empty for a message about another file.
    source: &'a str,
}

/// Translates the known messages in the compiler's `output`, one line each; if there are errors, only the first error.
///
/// `source` is the name and the text of the source, which is searched for braces and declarations.
pub fn in_plain_words(output: &str, source: (&str, &str)) -> String {
    let lines: Vec<&str> = output.lines().collect();
    if let Some(words) = constant_of_header(&lines) {
        return words;
    }
    let messages = messages(&lines, source);
    let first_error = messages.iter().find(|message| message.is_error);
    let mut translated: Vec<String> = Vec::new();
    // The first error often causes all later messages.
    let chosen = messages.iter().filter(|message| first_error.is_none_or(|error| std::ptr::eq(error, *message)));
    for line in chosen.take(MAX_MESSAGES).filter_map(Message::translated_line) {
        if !translated.contains(&line) {
            translated.push(line);
        }
        if translated.len() == MAX_LINES {
            break;
        }
    }
    translated.concat()
}

/// Explains a first error in a header whose constant the program uses as a name or calls, as in `enum { RED, GREEN };`.
fn constant_of_header(lines: &[&str]) -> Option<String> {
    let first = lines.iter().position(|line| line.contains(" error: "))?;
    let (place, text) = lines[first].split_once(": error: ")?;
    let note = lines[first + 1..].iter().take(3).find(|line| line.contains(": note: in expansion of macro '"))?;
    let mut parts = note.splitn(3, ':');
    let (file, line, name) = (parts.next()?, parts.next()?, quoted(note, 0)?);
    let header = Path::new(place.split(':').next()?);
    let header_name = header.file_name()?.display();
    let words = if ["expected identifier", "expected unqualified-id"].iter().any(|it| text.starts_with(it)) {
        format!("`{name}` is a constant of `{header_name}`: give yours another name")
    } else if text.contains("is not a function or function pointer") {
        format!("`{name}` is a constant of `{header_name}`, not a function: leave `( )` out")
    } else {
        return None;
    };
    header.is_absolute().then(|| format!("{file}:{line}: {words}\n"))
}

/// Removes from the compiler's `output` three kinds of warnings that mostly concern intended code:
/// - fractions that are cut off, unless the number becomes 0, or is an angle in radians for `VWTurn`;
/// - texts that are printed without a format, unless `+` joins the text;
/// - arrays of arrays where a pointer to their elements is expected, as in `BYTE image[120][160][3]; CAMGet(image);`.
pub fn without_harmless_warnings(output: &str) -> String {
    let mut kept = String::new();
    // Lines before a message that belong to it: `a.c: In function 'main':`.
    let mut introduction = String::new();
    let (mut is_dropped, mut is_any_dropped) = (false, false);
    let lines: Vec<&str> = output.split_inclusive('\n').collect();
    for (index, line) in lines.iter().copied().enumerate() {
        let text = line.trim_end();
        let is_introduction =
            !line.starts_with(' ') && text.ends_with([':', ',']) || text.starts_with("    ") && text.contains(" from ");
        let is_summary = text.ends_with(" warning generated.") || text.ends_with(" warnings generated.");
        if text.contains(": warning: ") {
            let is_joined_text =
                lines.get(index + 1).is_some_and(|code| code.contains("\" + ") && !code.contains("c_str()"));
            let is_turn = || lines.get(index + 1).is_some_and(|code| code.contains("VWTurn"));
            is_dropped = text.ends_with("[-Wfloat-conversion]")
                && !text.contains(" to '0' ")
                && !(changed_value(text).is_some_and(|(number, _)| is_in_radians(number)) && is_turn())
                || text.ends_with("[-Wformat-security]") && !is_joined_text
                || text.ends_with("[-Wincompatible-pointer-types]") && passes_array(&lines[index + 1..]);
            is_any_dropped |= is_dropped;
        } else if is_dropped && is_introduction && lines.get(index + 1).is_some_and(|next| next.contains(": note: ")) {
            continue;
        } else if !line.starts_with(' ') && !text.contains(": note: ") {
            is_dropped = is_summary && is_any_dropped;
        }
        if is_introduction {
            if is_dropped || !line.starts_with(' ') && !text.ends_with(',') {
                introduction.clear();
            }
            introduction.push_str(line);
        } else if !is_dropped {
            kept.push_str(&std::mem::take(&mut introduction));
            kept.push_str(line);
        }
    }
    kept
}

/// The number in a warning that a conversion changes it, and the text of the number that it becomes.
fn changed_value(text: &str) -> Option<(f64, &str)> {
    let (_, values) = text.split_once(" changes value from ")?;
    let (from, to) = values.split_once(" to ")?;
    let number = from.trim_matches('\'').trim_end_matches('f').parse().ok()?;
    Some((number, to.split_whitespace().next()?.trim_matches('\'')))
}

/// Angles in radians are usually multiples of this one, 15 degrees.
const RADIANS_STEP: f64 = std::f64::consts::PI / 12.0;

/// Returns true for a fraction close to a multiple of [`RADIANS_STEP`], up to a full turn: 1.57, but not 2.5. `eye.py`
/// has the same rule.
fn is_in_radians(angle: f64) -> bool {
    let steps = angle.abs() / RADIANS_STEP;
    let is_close = (steps - steps.round()).abs() < 0.001 * steps;
    is_close && angle.abs() < 6.4 && (2.0 * angle).fract() != 0.0
}

/// Returns true if the details of a warning, at the start of `lines`, name an array of arrays as the argument, and its
/// elements are those of the parameter.
fn passes_array(lines: &[&str]) -> bool {
    let mut details = lines.iter().take_while(|line| !line.contains(": warning: ") && !line.contains(": error: "));
    let types = details.find_map(|line| line.split_once("note: expected '")?.1.split_once(" but argument is of type "));
    types.is_some_and(|(expected, given)| given.contains("(*)[") && element_type(expected) == element_type(given))
}

/// The element type of a pointer in a message of gcc, without all `*` and `[ ]`, such as `unsigned char` for
/// `BYTE (*)[160]' {aka 'unsigned char (*)[160]'}`.
fn element_type(message: &str) -> &str {
    let quoted = message.trim_end().trim_end_matches(['}', '\'']);
    let meant = quoted.rsplit_once('\'').map_or(quoted, |(_, meant)| meant);
    meant.split(['(', '*', '[']).next().unwrap_or_default().trim()
}

/// The messages about the program among the compiler's `lines`.
fn messages<'a>(lines: &'a [&'a str], source: (&str, &'a str)) -> Vec<Message<'a>> {
    let mut messages: Vec<Message<'a>> = Vec::new();
    let (mut details_start, mut scope) = (0, None);
    for (index, line) in lines.iter().copied().enumerate() {
        if let Some(message) = parse(line, scope, source) {
            if let Some(last) = messages.last_mut() {
                last.details = &lines[details_start..index];
            }
            details_start = index + 1;
            messages.push(message);
        }
        if line.contains(": In ") || line.ends_with(": At top level:") || line.ends_with(": At global scope:") {
            scope = Some(line);
        }
    }
    if let Some(last) = messages.last_mut() {
        last.details = &lines[details_start..];
    }
    messages
}

/// Parses the first line of a message about the program, without its details; `None` for other lines. `scope` is the
/// last line that names a function.
fn parse<'a>(line: &'a str, scope: Option<&'a str>, (name, source): (&str, &'a str)) -> Option<Message<'a>> {
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let (file, rest) = line.split_once(':')?;
    let (line, rest) = rest.split_once(':')?;
    // `a.c:4: error: unterminated #if` has no column.
    let (column, rest) = rest.split_once(':').filter(|(column, _)| is_number(column)).unwrap_or(("", rest));
    let rest = rest.trim_start();
    let error_text = ["error: ", "fatal error: "].iter().find_map(|kind| rest.strip_prefix(kind));
    let text = error_text.or_else(|| rest.strip_prefix("warning: "))?;
    // Headers of the system and of the kit have absolute paths.
    let is_of_program = is_number(line) && !file.starts_with('/') && !file.starts_with(' ');
    is_of_program.then(|| Message {
        is_in_function: scope.is_some_and(|line| line.contains(": In ")),
        function: scope.and_then(|line| quoted(line, 0)).unwrap_or_default(),
        source: if file == name { source } else { "" },
        file,
        line,
        column: column.parse().unwrap_or(0),
        is_error: error_text.is_some(),
        text,
        details: &[],
    })
}

impl Message<'_> {
    fn translated_line(&self) -> Option<String> {
        let unclosed_phrases =
            ["at end of input", "function-definition is not allowed", "invalid storage class for function"];
        if (self.text == "expected '}'" || unclosed_phrases.iter().any(|phrase| self.text.contains(phrase)))
            && let Some(line) = unclosed_brace(self.source)
        {
            return Some(format!("{}:{line}: this `{{` has no `}}`: write it where the block ends\n", self.file));
        }
        let words = self.plain_words()?;
        Some(format!("{}:{}: {words}\n", self.file, self.line))
    }

    /// The text between quotes with this index, from 0.
    fn quoted(&self, index: usize) -> Option<&str> {
        quoted(self.text, index)
    }

    /// Returns true if the message is about a source in C, not in C++ and not a header.
    fn is_c(&self) -> bool {
        Language::of(Path::new(self.file)) == Some(Language::C)
    }

    fn plain_words(&self) -> Option<String> {
        self.plain_words_from_code().or_else(|| self.plain_words_from_text())
    }

    /// Explains a mistake that the program's line shows better than the compiler's text.
    fn plain_words_from_code(&self) -> Option<String> {
        let line = self.code()?;
        let is_continued = self.is_continued(line);
        if let Some(words) = missing_quote(line).filter(|_| self.is_error && !is_continued && self.may_lack_quote(line))
        {
            return Some(words.to_owned());
        }
        let blanked = code_only(line);
        let code = blanked.trim();
        let is_syntax = self.text.starts_with("expected ");
        let lacks_name =
            self.text.starts_with("expected identifier or") || self.text.starts_with("expected unqualified-id");
        let has_digit = |text: &str, at_end: bool| {
            let mut letters = text.trim().chars();
            (if at_end { letters.next_back() } else { letters.next() }).is_some_and(|letter| letter.is_ascii_digit())
        };
        let comma = code.split_once('=').and_then(|(_, value)| value.split_once(','));
        if self.is_c() && starts_with_word(code, "extern") && line.replace(' ', "").contains("extern\"C\"") {
            return Some(EXTERN_C.to_owned());
        }
        if code == "include" || code.starts_with("include<") || code.starts_with("include <") {
            return Some("write `#include`, with `#`".to_owned());
        }
        if let Some(words) = python_list(code).filter(|_| is_syntax) {
            return Some(words);
        }
        if (lacks_name || self.text.starts_with("structured binding"))
            && let Some((kind, rest)) =
                code.split_once('[').filter(|(kind, _)| ["int", "double", "char"].contains(&kind.trim()))
            && let Some((size, name)) = rest.split_once(']')
        {
            let name = name.trim().split([';', '=', ' ']).next().unwrap_or_default();
            return Some(format!("write `[ ]` after the name: `{} {name}[{size}]`", kind.trim()));
        }
        if lacks_name && comma.is_some_and(|(left, right)| has_digit(left, true) && has_digit(right, false)) {
            return Some("a number has a decimal point, not a comma: `0.5`".to_owned());
        }
        if self.is_error && self.ends_no_comment() {
            return Some(
                "`*/` ends no comment here: a comment cannot contain another one, and ends at the first `*/`"
                    .to_owned(),
            );
        }
        if is_syntax && has_split_condition(code) {
            return Some("one pair of parentheses encloses the whole condition: `if ((a > 1) && (b < 2))`".to_owned());
        }
        if self.text.starts_with("expected identifier before")
            && starts_with_word(code.trim_start_matches("typedef "), "enum")
            && let Some((_, right)) = self.split_code()
            && let Some(name) = right.split(|letter| !is_name(letter)).next()
            && name.starts_with(|letter: char| letter.is_alphabetic() || letter == '_')
        {
            return Some(format!(
                "`{name}` is already defined: give yours another name; `bool`, `true` and `false` need no definition"
            ));
        }
        if is_syntax && self.found_token() == Some("-") && self.text.contains("'='") {
            return Some("a name cannot contain `-`: write `_`".to_owned());
        }
        if is_syntax && (is_wrong_define(code) || self.macro_definition().is_some_and(is_wrong_define)) {
            return Some("a `#define` has no `=` and no `;`: `#define SPEED 100`".to_owned());
        }
        let start = without_closing_braces(code);
        let is_clause = ["if", "while", "for", "else", "switch", "do"].iter().any(|word| starts_with_word(start, word));
        let is_declared = TYPES.iter().any(|kind| starts_with_word(start, kind));
        if is_syntax && starts_with_word(start, "else") && start[4..].trim_start().starts_with('(') {
            return Some("an `else` has no condition: write `else if (...)`".to_owned());
        }
        if is_syntax && self.found_token() == Some(":") && code.ends_with(':') {
            return Some(if starts_with_word(start, "case") {
                "a value is missing after `case`".to_owned()
            } else if is_clause || is_declared && code.contains('(') {
                "there must be no `:` here: a block is written between `{ }`".to_owned()
            } else {
                "a line ends with `;`, not with `:`".to_owned()
            });
        }
        let is_list = |values: &str| {
            values.split(',').map(str::trim).all(|value| !value.contains(' ') && !CPP_LIBRARY_NAMES.contains(&value))
        };
        let call = start.strip_suffix(");").and_then(|call| call.split_once('('));
        let values = line.get(blanked.find('(').map_or(0, |open| open + 1)..blanked.rfind(')').unwrap_or(0));
        if (self.text.contains("declared void") || self.text.starts_with("expected declaration specifiers or '...'"))
            && is_declared
            && let (Some((name, _)), Some(values)) = (call.filter(|(_, values)| is_list(values)), values)
        {
            let name = name.trim().rsplit(' ').next().unwrap_or_default();
            return Some(format!("a call has no type in front of it: write `{name}({values});`"));
        }
        if !is_declared && !self.is_in_function && self.text.starts_with("expected declaration specifiers or '...'") {
            return Some(OUTSIDE_FUNCTIONS.to_owned());
        }
        if self.text.contains("of unary '*'") {
            let is_operand = |left: &str| {
                left.trim_end().ends_with(|letter: char| letter.is_alphanumeric() || "_)]".contains(letter))
            };
            if !code.split_once("**").is_some_and(|(left, _)| is_operand(left)) {
                return Some("`*` stands before a value that is not a pointer: leave it out".to_owned());
            }
            return Some("there is no `**`: multiply, or write `pow(a, b)` with `#include <math.h>`".to_owned());
        }
        if ["subscripted value is", "for array subscript"].iter().any(|words| self.text.contains(words))
            && let Some(words) = self.indexed_value()
        {
            return Some(words);
        }
        if self.text.contains("[-Wformat-security]") {
            return Some("`+` does not join a text and a number: write `\"distance %d\", d`".to_owned());
        }
        let is_operator = |word: Option<&str>| {
            word.is_some_and(|word| {
                ["and", "or", "not"].contains(&word) && self.is_c() || ["AND", "OR", "NOT"].contains(&word)
            })
        };
        let is_unknown = |name: &str| {
            let phrases = ["undeclared", "not declared", "unknown type name", "implicit declaration"];
            phrases.iter().any(|phrase| self.text.contains(phrase)) && !calls_of(self.source).defined.contains(name)
        };
        if is_syntax && is_operator(self.found_token())
            || is_operator(self.quoted(0)) && self.quoted(0).is_some_and(is_unknown)
        {
            return Some("C writes `&&` for `and`, `||` for `or` and `!` for `not`".to_owned());
        }
        if is_syntax && code.contains(if self.is_c() { "<>" } else { " <> " }) {
            return Some("`<>` is not a comparison: write `!=`".to_owned());
        }
        None
    }

    fn plain_words_from_text(&self) -> Option<String> {
        let has = |phrase: &str| self.text.contains(phrase);
        let fixed = [
            ("[-Wparentheses]", "assignment", "`=` assigns a value; write `==` to compare"),
            ("", "using the result of an assignment as a condition", "`=` assigns a value; write `==` to compare"),
            (
                "",
                "comparison with string literal",
                "`==` compares addresses; write `strcmp(a, b) == 0` to compare texts",
            ),
            (
                "",
                "comparison against a string literal",
                "`==` compares addresses; write `strcmp(a, b) == 0` to compare texts",
            ),
            ("", "division by zero", "division by a number that is 0"),
            ("", "remainder by zero", "division by a number that is 0"),
            ("", "infinite recursion detected", RECURSION),
            ("", "function will call itself", RECURSION),
            ("", "returning non-void", "the function ends without `return` and a value"),
            ("", "non-void function", "the function ends without `return` and a value"),
            ("", "missing terminating \"", "the text has no end: write `\"` after it"),
            ("", "missing terminating '", "write a single letter between `'`, and a text between `\"`"),
            ("", "character constant too long", "write a single letter between `'`, and a text between `\"`"),
            ("", "multi-character character constant", "write a single letter between `'`, and a text between `\"`"),
            (
                "expected declaration or statement",
                "at end of input",
                "the program ends too early: a `}` is missing above",
            ),
            ("expected '}' at end of input", "", "the program ends too early: a `}` is missing above"),
            ("", "at end of input", "the file ends here, and its last line is not complete"),
            ("comparisons like", "mathematical meaning", "two comparisons are joined by `&&`: `100 < d && d < 200`"),
            ("expected constructor, destructor", "before", OUTSIDE_FUNCTIONS),
            (
                "initializer element is not",
                "constant",
                "outside of a function, a variable begins with a fixed number: set it within a function, such as `main`",
            ),
            ("octal constant", "", "a whole number is written without a 0 before it: write `90`, not `090`"),
            ("invalid operands", "^", "`^` is not a power: multiply, or write `pow(a, b)` with `#include <math.h>`"),
            ("invalid operands", "%", "`%` is for whole numbers: write `fmod(a, b)` with `#include <math.h>`"),
            (
                "invalid operands to binary +",
                "char *",
                "`+` does not join texts: write `\"%s%s\", a, b` in `LCDPrintf`",
            ),
            ("main", "must return 'int'", "write `int main()`"),
            ("return type of 'main'", "is not 'int'", "write `int main(void)`, and `return 0;` at its end"),
            ("no match for 'operator>>'", "ostream", "`cout` is followed by `<<`, not by `>>`, as in `std::cout << d`"),
            ("no match for 'operator<<'", "istream", "`cin` is followed by `>>`: `cin >> d`"),
            ("", "from an initializer list", LIST_ASSIGNED),
            ("", "lvalue required as left operand", "the left side of `=` must be a variable"),
            ("", "lvalue required as unary '&'", "`&` takes the address of a variable, not of a value"),
            ("lvalue required as", "crement operand", "`++` and `--` change a variable, not a value"),
            ("", "expression is not assignable", "the left side of `=` must be a variable"),
            (
                "",
                "'else' without a previous 'if'",
                "the `else` has no `if`: look for a `;` after the `if (...)`, or a missing `{ }`",
            ),
            ("", "unterminated comment", "a comment begins and has no end: write `*/`"),
            ("", "unterminated #", "this `#if` has no end: write `#endif` below the lines that belong to it"),
            ("#e", "without #if", "no `#if` stands above this line: delete it"),
            (
                "used with no following hex digits",
                "",
                "`\\x` in a text begins the number of a letter: write `\\\\` for a backslash, or `/` between folders",
            ),
            ("", "must be initialized with a brace-enclosed initializer", LIST_MISSING),
            ("", "initializer fails to determine size", LIST_MISSING),
            ("", "excess elements in array initializer", "there are more values than elements: make the array larger"),
            ("", "duplicate case value", "two `case` of this `switch` have the same value: delete one of them"),
            ("", "jump to case label", "a `case` that declares a variable needs `{ }` around its statements"),
            ("", "case label does not reduce to", "`case` needs a fixed number: compare variables with `if (a == b)`"),
            ("", "not within a switch", "`case` and `default` belong in a `switch`: is there a `}` too many above?"),
            ("", "invalid suffix", NOT_A_NUMBER),
            ("", "numeric literal operator", NOT_A_NUMBER),
            ("", "too many decimal points", NOT_A_NUMBER),
            ("size ", "is negative", "the length of an array is a positive number"),
            (
                "",
                "variable-sized object may not be initialized",
                "an array whose length is a variable has no first values: set its elements one by one, or give it a fixed length",
            ),
            ("array type has incomplete element type", "[", ROW_LENGTH),
            ("", "must have bounds for all dimensions", ROW_LENGTH),
            ("", "two or more data types", "two types stand here: delete one of them, or a `;` is missing"),
            ("expected statement before ')'", "", "there is a `)` too many"),
            ("", "assignment of function", "a function is called with `( )`, and `==` compares, as in `VWDone() == 1`"),
            (
                "",
                "expression cannot be used as a function",
                "this is a value, not a function: `*` multiplies, as in `2 * (a + b)`",
            ),
            (
                "",
                "suggest braces around empty body",
                "the `;` ends the `if` here, so that it does nothing: leave the `;` out",
            ),
            (
                "",
                "break statement not within",
                "`break` belongs in a loop or a `switch`: is there a `}` too many above?",
            ),
            ("", "continue statement not within", "`continue` belongs in a loop: is there a `}` too many above?"),
            ("", "subscripted value is neither", FUNCTION_INDEXED),
            ("", "for array subscript", FUNCTION_INDEXED),
            ("", "expression with array type", ARRAY_ASSIGNED),
            ("incompatible types in assignment", "[", ARRAY_ASSIGNED),
            ("", "with a value, in function returning", VOID_RETURNS),
            (
                "",
                "void value not ignored",
                "a `void` function gives no value: write the value's type in place of `void`, and `return`",
            ),
            ("", "#include expects", "write the name between quotes: `#include \"eyebot.h\"`"),
            ("", "extra tokens at end of #include", "no `;` belongs after `#include`"),
            ("", "cannot declare '::main' to be a global variable", BRACE_WITHOUT_FUNCTION),
        ];
        if let Some((.., words)) = fixed.iter().find(|(first, second, _)| has(first) && has(second)) {
            return Some((*words).to_owned());
        }
        match self.text {
            text if text.starts_with("expected 'while' before") => Some(if self.found_token() == Some("until") {
                "C has no `until`: write `while (...)`, which repeats as long as its condition is true".to_owned()
            } else {
                "a `do` needs a `while (...);` at its end; a loop that begins with `while` has no `do`".to_owned()
            }),
            text if text.starts_with("the value of '") && self.code().is_some_and(|code| code.contains("case ")) => {
                Some("`case` needs a fixed number: compare variables with `if (a == b)`".to_owned())
            }
            text if text.contains("invalid initializer") => {
                let (left, _) = self.code()?.split_once('=')?;
                left.contains('[').then(|| LIST_MISSING.to_owned())
            }
            text if text.starts_with("assignment of read-only variable") => {
                Some(format!("`{}` is `const`: leave `const` out where it is declared, if it changes", self.quoted(0)?))
            }
            text if text.starts_with("label '") && text.ends_with("used but not defined") => {
                let name = self.quoted(0)?;
                Some(format!("`goto {name}` needs a line `{name}:` in the same function"))
            }
            text if text.starts_with("reference to '")
                && text.ends_with("is ambiguous")
                && self.source.contains("using namespace std") =>
            {
                let name = self.quoted(0)?;
                Some(format!("`{name}` is a name of the C++ library too, because of `using namespace std;`: give yours another name"))
            }
            text if text.starts_with("invalid preprocessing directive") => {
                let word = text.rsplit('#').next()?;
                let known = ["include", "define", "if", "ifdef", "ifndef", "else", "elif", "endif"];
                let meant = known.into_iter().find(|known| strsim::osa_distance(known, &word.to_lowercase()) <= 1)?;
                Some(format!("`#{word}` is not known: write `#{meant}`"))
            }
            text if text.starts_with("request for member '") && ["not a structure", "non-class type"].iter().any(|it| text.contains(it)) => {
                Some(format!("what stands before `.{}` is a value without parts: check its type", self.quoted(0)?))
            }
            text if text.contains("will always evaluate as 'true'") => {
                let name = self.quoted(0)?;
                let is_array = self.source.contains(&format!("{name}["));
                (!is_array && self.code()?.contains(name) && !self.code()?.contains(&format!("&{name}")))
                    .then(|| format!("`{name}` is not called: write `{name}()`"))
            }
            text if text.contains("called on unallocated object") => {
                let name = self.quoted(1)?;
                Some(format!("`{name}` does not come from `malloc`: leave this `free` out"))
            }
            text if text.starts_with("conflicting types for built-in function") => {
                let name = self.quoted(0)?;
                Some(format!("`{name}` is the name of a function of the C library: give yours another one"))
            }
            text if text.ends_with("' has not been declared") => self.parameter_without_type(),
            text if text.ends_with("directive argument is null [-Wformat-overflow=]") => {
                Some(format!("the value for `{}` is NULL", self.quoted(0)?))
            }
            text if text.contains("-overflow")
                || text.contains("-Warray-bounds")
                || text.contains("-Wfortify-source") =>
            {
                self.overflow()
            }
            text if text.contains("invokes undefined behavior") => self.overrun_by_loop(),
            text if text.contains(" changes value from ") => {
                let (number, to) = changed_value(text)?;
                if to != "0" {
                    return is_in_radians(number).then(|| {
                        let degrees = (number / RADIANS_STEP).round() * 15.0;
                        format!("{number:.3} becomes {to} here: RoBIOS-7 takes degrees, not radians: write `{degrees}`")
                    });
                }
                number.is_finite().then(|| {
                    format!("{number} becomes 0 here: RoBIOS-7 takes whole numbers, in mm, mm/s, degrees and ms: 0.3 m is `300`, half a second is `500`")
                })
            }
            text if text.starts_with("this '") && text.contains("does not guard") => {
                let word = self.quoted(0)?;
                if self.code().is_some_and(is_empty_clause) {
                    return Some(format!("the `;` ends the `{word}` here, so that it does nothing: leave the `;` out"));
                }
                Some(format!(
                    "the `{word}` covers only one statement: write `{{ }}` around all that belong to it"
                ))
            }
            text if text.contains("used after 'free'") || text.contains("-Wuse-after-free") => {
                let name = self.quoted(0)?;
                // Without a name, the first quoted text is the function that frees.
                match (name.contains("operator delete"), name == "free") {
                    (true, _) => Some("memory is used, or deleted again, after its `delete`".to_owned()),
                    (_, true) => Some("memory is used, or given to `free` again, after its `free`".to_owned()),
                    _ => Some(format!("`{name}` is used, or given to `free` again, after `free({name})`")),
                }
            }
            text if text.contains("uninitialized") && self.is_declared_as_pointer() => Some(self.pointer_without_value(self.quoted(0)?)),
            text if text.contains("uninitialized") => {
                let name = source_name(self.quoted(0)?);
                Some(format!("`{name}` has no value yet: {}", self.first_value(name)))
            }
            text if text.contains("address of") && text.contains("local variable") => Some(self.returned_local()),
            text if text.starts_with("expected '}' before") && self.code().is_some_and(|code| code.contains('{')) => {
                Some(format!("a `,` is missing before `{}`, or a `}}`", self.found_token()?))
            }
            text if text.starts_with("expected '}'") => Some("the program ends too early: a `}` is missing above".to_owned()),
            text if text.starts_with("format '") || text.starts_with("format specifies") => self.wrong_format(),
            text if text.contains("expected ';'") || text.contains("expected ',' or ';'") => {
                Some(self.misspelt_first_word().unwrap_or_else(|| self.missing_mark(";")))
            }
            text if text.starts_with("expected '=', ',', ';'") => Some(match self.found_token() {
                Some("{") => self.missing_after_head().unwrap_or_else(|| BRACE_WITHOUT_FUNCTION.to_owned()),
                Some(word) if is_word(word) => self.separated_words(word),
                _ => "a `;` is missing; a `for` has two, as in `for (int i = 0; i < 4; i++)`".to_owned(),
            }),
            text if text.starts_with("expected identifier or '(' before '{'") || text.starts_with("expected unqualified-id before '{'") => {
                Some("no function starts at this `{`: is there an extra `;` at the end of the line above it?".to_owned())
            }
            text if text.starts_with("expected '(' before") => {
                let word = self.found_token()?;
                Some(format!("a `(` is missing before `{word}`: a condition is written between `( )`"))
            }
            text if text.starts_with("expected expression before") || text.starts_with("expected primary-expression before") => {
                let code = code_only(self.code().unwrap_or_default());
                let reversed = [("=>", ">="), ("=<", "<=")].into_iter().find(|(wrong, _)| code.contains(wrong));
                let is_list = code.split_once('{').is_some_and(|(left, _)| left.trim_end().ends_with('='));
                if let Some(words) = self.declaration_in_clause().or_else(|| self.cpp_keyword_as_name()) {
                    return Some(words);
                }
                Some(match reversed {
                    None if self.found_token() == Some("{") && is_list => LIST_ASSIGNED.to_owned(),
                    None if self.found_token().is_some_and(|word| TYPES.contains(&word)) => format!(
                        "`{}` does not belong here: a type is written where a name is declared, not where it is used",
                        self.found_token()?
                    ),
                    Some((wrong, right)) => format!("`{wrong}` is not a comparison: write `{right}`"),
                    None => format!("a value is missing before `{}`, or there is something too many", self.found_token()?),
                })
            }
            text if text.starts_with("redefinition of") || text.starts_with("redeclaration of") => self.defined_twice(),
            text if text.starts_with("conflicting types for") => {
                let name = self.quoted(0)?;
                if self.details.iter().any(|line| line.starts_with('/') && line.contains("note: previous")) {
                    return Some(format!("`{name}` is the name of another function already: give yours another one"));
                }
                Some(format!(
                    "`{name}` is used above before it is written, or written twice with other types: write its first line, with a `;`, above \
                     its first use"
                ))
            }
            text if text.contains("unknown type name") || text.contains("does not name a type") => self.unknown_type(),
            text if text.contains("is not a function or function pointer") || text.contains("cannot be used as a function") => {
                let name = self.quoted(0)?;
                Some(format!("`{name}` is a variable, not a function: a function has another name, `*` multiplies"))
            }
            text if text.contains("has no member named") => {
                let (whole, part) = (self.quoted(0)?, self.quoted(1)?);
                Some(match self.suggestion() {
                    Some(suggestion) => format!("`{whole}` has no `{part}`; did you mean `{suggestion}`?"),
                    None => format!("`{whole}` has no `{part}`: check the spelling"),
                })
            }
            text if text.starts_with("stray '") => Some(match self.quoted(0)? {
                "\\" => "`\\` belongs in a text only: leave it out".to_owned(),
                letter if letter.starts_with('\\') => {
                    "this line has a letter that C does not know, such as a blank copied from a page: type the line again".to_owned()
                }
                letter => format!("the letter `{letter}` does not belong here"),
            }),
            text if text.starts_with("initialization of '") || text.starts_with("assignment to '") => {
                let (variable, value) = (self.quoted(0)?, self.quoted(1)?);
                Some(type_mismatch(variable, value))
            }
            text if text.starts_with("incompatible types when ") => {
                let (variable, value) = (self.quoted(0)?, self.quoted(1)?);
                Some(type_mismatch(variable, value))
            }
            text if text.starts_with("expected ':'") => Some(self.missing_mark(":")),
            text if text.starts_with("expected declaration specifiers before") || text.starts_with("parameter '") => {
                Some(self.missing_above())
            }
            text if text.starts_with("expected initializer before") && self.found_token().is_some_and(is_word) => {
                Some(self.separated_words(self.found_token()?))
            }
            text if text.contains("function-definition is not allowed here") || text.contains("function definition is not allowed here") || text.starts_with("invalid storage class for function") => {
                Some(self.nested_function())
            }
            text if text.starts_with("expected identifier or '(' before numeric constant")
                || text.starts_with("expected unqualified-id before numeric constant") =>
            {
                Some("a name is missing: it begins with a letter, and is not a `#define` of a number".to_owned())
            }
            text if ["expected identifier or '('", "expected declaration before '}'", "expected unqualified-id before"]
                .iter()
                .any(|it| text.starts_with(it)) =>
            {
                Some(if self.is_in_function { self.missing_name()? } else { OUTSIDE_FUNCTIONS.to_owned() })
            }
            text if text.contains("not call, to function") => {
                let name = self.quoted(0)?;
                Some(format!("`{name}` is not called: write `{name}()`"))
            }
            text if text.contains("of pointer type") || text.contains("is a pointer; did you mean") => {
                let name = self.quoted(if text.contains("of pointer type") { 1 } else { 0 })?;
                Some(format!("`{name}` is a pointer: write `{name}->` in place of `{name}.`"))
            }
            text if text.contains("'->'") && (text.contains("non-pointer type") || text.contains("invalid type argument") || text.contains("is not a pointer")) => {
                Some("what stands before `->` is not a pointer: write `.`".to_owned())
            }
            text if text.contains("statement with no effect") || text.contains("expression result unused") => {
                Some("this line does nothing: a function is called with `()`, as in `VWWait()`, and a variable is set by `=`".to_owned())
            }
            text if text.contains("implicit declaration of function") => {
                Some(self.unknown_function(self.quoted(0)?))
            }
            text if text.contains("to binary 'operator+'") && text.contains("char") => {
                Some("`+` does not join texts in quotes: make the first one a `std::string(\"...\")`".to_owned())
            }
            text if text.contains("is not a member of 'std'") => self.undeclared(),
            text if text.starts_with("expected ')'") => Some(self.missing_mark(")")),
            text if text.contains("undeclared") || text.contains("not declared in this scope") => self.undeclared(),
            text if text.contains("few arguments to function") || text.contains("many arguments to function") => {
                let name = self.quoted(0)?;
                let name = name.split('(').next()?.rsplit(' ').next()?;
                let amount = if text.contains("few") { "few" } else { "many" };
                Some(format!("`{name}` is called with too {amount} values{}", self.function_declaration(name)))
            }
            text if ["passing argument ", "invalid conversion from", "cannot convert '"]
                .iter()
                .any(|it| text.starts_with(it)) =>
            {
                self.wrong_argument()
            }
            text if text.starts_with("expected ") => self.misspelt_first_word(),
            _ => None,
        }
    }

    /// Returns true if a backslash joins the line with the line before or after it.
    fn is_continued(&self, line: &str) -> bool {
        let line_before =
            self.line.parse::<usize>().ok().and_then(|number| self.source.lines().nth(number.checked_sub(2)?));
        [Some(line), line_before].into_iter().flatten().any(|line| line.trim_end().ends_with('\\'))
    }

    /// Returns true if a missing quote in `line` may be the cause of the message.
    fn may_lack_quote(&self, line: &str) -> bool {
        let lexical_errors = ["missing terminating", "expected ", "stray ", "unterminated "];
        let touches = |name: &str| line.contains(&format!("{name}\"")) || line.contains(&format!("\"{name}"));
        let is_unknown = self.text.contains("undeclared") || self.text.contains("not declared");
        !line.contains("/*")
            && (lexical_errors.iter().any(|beginning| self.text.starts_with(beginning))
                || is_unknown && (print_arguments(line).is_some() || self.quoted(0).is_some_and(touches)))
    }

    /// Explains a missing name in a function.
    fn missing_name(&self) -> Option<String> {
        Some(match self.found_token()? {
            word if is_word(word) => format!("`{word}` is a word of the language: give the variable another name"),
            "&" if self.is_c() => "C has no `&` variables: write a pointer, with `*`".to_owned(),
            mark => format!("a name is missing before `{mark}`"),
        })
    }

    /// The line that defines the macro that the message is about.
    fn macro_definition(&self) -> Option<&str> {
        let note = self.details.iter().position(|line| line.contains("note: in definition of macro"))?;
        self.details.get(note + 1)?.split_once(" | ").map(|(_, code)| code.trim())
    }

    /// The line that declares the variable of the message, as a note shows it.
    fn variable_declaration(&self) -> Option<&str> {
        let note = self.details.iter().position(|line| line.contains(" declared here"))?;
        self.details.get(note + 1)?.split_once(" | ").map(|(_, code)| code.trim())
    }

    /// Returns true if the name is declared with a `*`, and not as an array.
    fn is_declared_as_pointer(&self) -> bool {
        let Some((name, code)) = self.quoted(0).zip(self.variable_declaration()) else { return false };
        let is_name_end = |rest: &str| !rest.starts_with(|letter| is_name(letter) || letter == '[');
        code.split('*').skip(1).any(|rest| rest.trim_start().strip_prefix(name).is_some_and(is_name_end))
    }

    /// Explains the pointer `name`, which is used before it has a value.
    fn pointer_without_value(&self, name: &str) -> String {
        if self.text.contains("may be used") {
            return format!(
                "`{name}` may point nowhere in this line: set it to NULL where it is declared, and write `if ({name} != NULL)` before this line"
            );
        }
        let code = code_only(self.code().unwrap_or_default());
        let function = code.match_indices(name).find_map(|(offset, _)| {
            let (left, right) = (code[..offset].trim_end(), code[offset + name.len()..].trim_start());
            (left.ends_with(['(', ',']) && right.starts_with([',', ')'])).then(|| called_function(left))
        });
        let declaration = self.variable_declaration().unwrap_or_default();
        let Some(function) = function else {
            return format!(
                "`{name}` points nowhere: set it to the address of a variable first, as `{name} = &variable;` does"
            );
        };
        let is_of = |kind: &str| starts_with_word(declaration, kind);
        // A `char` pointer of these functions is the name of the file.
        let takes_name = ["IPReadFile", "IPWriteFile"].iter().any(|beginning| function.starts_with(beginning));
        let is_bytes = is_of("BYTE") || is_of("unsigned") || is_of("char") && !takes_name;
        let array = array_of(function, &code_only(self.source))
            .filter(|(kind, _)| if *kind == "BYTE" { is_bytes } else { is_of(kind) })
            .or_else(|| is_of("char").then(|| ("char", "20".to_owned())));
        match array {
            Some((kind, length)) => {
                format!("`{name}` points nowhere: declare an array in its place, such as `{kind} {name}[{length}]`")
            }
            None => format!("`{name}` points nowhere: declare it without `*`, and write `&{name}` in this line"),
        }
    }

    /// Explains a declaration that is the only statement of an `if` or a loop.
    fn declaration_in_clause(&self) -> Option<String> {
        let (left, right) = self.split_code()?;
        let is_declared = |word: &&&str| starts_with_word(right, word);
        let word = TYPES.iter().chain(&["static", "const", "struct"]).find(is_declared)?;
        let code = code_only(self.source);
        let lines_above = code.lines().take(self.line.parse::<usize>().ok()?.checked_sub(1)?);
        let line_above =
            lines_above.filter(|line| !line.trim().is_empty()).last().map(without_closing_braces)?.trim_end();
        let clause =
            ["if", "else", "while", "for", "do"].into_iter().find(|word| starts_with_word(line_above, word))?;
        let is_whole = line_above.ends_with(')') || line_above == clause;
        if !left.trim().is_empty() || !is_whole {
            return None;
        }
        Some(if begins_function(right) {
            self.nested_function()
        } else {
            format!(
                "`{word}` does not belong here: a variable is declared before the `{clause}`, or within its `{{ }}`"
            )
        })
    }

    /// Explains `[ ]` after a variable that is no array.
    fn indexed_value(&self) -> Option<String> {
        let (left, right) = self.split_code()?;
        // g++ and gcc point to the bracket behind or before the index, clang to the name.
        let left = left.rsplit_once('[').filter(|_| right.starts_with(']')).map_or(left, |(left, _)| left);
        let word = left.trim_end().rsplit(|c| !is_name(c)).next().filter(|word| !word.is_empty());
        let name = word.or_else(|| right.split(|c| !is_name(c)).next()).filter(|name| !name.is_empty())?;
        let code = code_only(self.source);
        let lines_above = code.lines().enumerate().take(self.line.parse().ok()?);
        let declared = lines_above.filter_map(|(index, line)| Some((index + 1, declared_type(line, name)?))).last();
        let (line, kind) = declared?;
        let size = if kind == "BYTE" { image_size(&code) } else { "10".to_owned() };
        let example = format!("such as `{kind} {name}[{size}];`");
        let others = if kind == "BYTE" { " (the size of a colour image)" } else { "" };
        Some(format!(
            "`{name}` is a single value, of line {line}, and `[ ]` belongs to an array: declare one, {example}{others}"
        ))
    }

    /// Explains a keyword of C++ that the line declares as a variable: `int class`.
    fn cpp_keyword_as_name(&self) -> Option<String> {
        let right = self.split_code()?.1;
        let kind = TYPES.iter().find(|kind| starts_with_word(right, kind))?;
        let word = right[kind.len()..].trim_start().split(|c| !is_name(c)).next()?;
        let is_cpp_keyword = !self.is_c() && CPP_KEYWORDS.contains(&word);
        is_cpp_keyword.then(|| format!("`{word}` is a word of C++: give the variable another name"))
    }

    /// Advice on a first value for the variable `name`, as far as its declaration shows one.
    fn first_value(&self, name: &str) -> String {
        if !is_word(name) {
            return "give it one before it is used".to_owned();
        }
        let code = self.variable_declaration().unwrap_or_default();
        // The length of an array must be a number here.
        let length = |word: &str| word.strip_prefix(name)?.strip_prefix('[')?.chars().next();
        let is_array = code
            .split(|letter| !is_name(letter) && letter != '[')
            .filter_map(length)
            .any(|letter| letter.is_ascii_digit());
        let is_struct = self.is_c() && starts_with_word(code, "struct") && !code.contains(['[', '*']);
        // gcc writes "was declared here" for numbers and pointers only.
        let is_number = self.details.iter().any(|line| line.contains(" was declared here"));
        let value = if is_number {
            format!(", such as `{name} = 0`")
        } else if is_array || is_struct {
            ", with `= {0}`".to_owned()
        } else {
            String::new()
        };
        format!("give it one where it is declared{value}")
    }

    /// The line of the program, as the message shows it.
    fn code(&self) -> Option<&str> {
        self.details.first()?.split_once(" | ").map(|(_, code)| code.trim_end())
    }

    /// Splits the program's line at the message's column. The caret and the column of gcc count the width of letters (1
    /// or 2), the column of clang counts bytes; the excerpt contains blanks in place of tabs.
    fn split_code(&self) -> Option<(&str, &str)> {
        let code = self.code()?;
        let caret = self.details.get(1).and_then(|line| line.split_once(" | ")?.1.find('^'));
        let column = caret.or(self.column.checked_sub(1))?;
        let positions = code.char_indices().scan(0, |columns, (offset, letter)| {
            let width_before = *columns;
            *columns += measure_text_width(letter.encode_utf8(&mut [0; 4]));
            Some((width_before, offset))
        });
        let offset = positions.skip_while(|(width_before, _)| *width_before < column).map(|(_, offset)| offset).next();
        Some(code.split_at(offset.unwrap_or(code.len())))
    }

    /// The mark or word that the compiler found where it expected something else.
    fn found_token(&self) -> Option<&str> {
        let quoted = self.text.split_once("before '").and_then(|(_, rest)| rest.split('\'').next());
        quoted.or_else(|| {
            let rest = self.split_code()?.1.trim_start();
            let word = rest.split(|c| !is_name(c) && c != '"').next()?;
            Some(word).filter(|word| !word.is_empty())
        })
    }

    /// The name that the compiler suggests.
    fn suggestion(&self) -> Option<&str> {
        self.text.split_once("did you mean '").and_then(|(_, rest)| rest.split('\'').next())
    }

    /// Explains a returned address of a variable that is gone when its function ends.
    fn returned_local(&self) -> String {
        let note = self.details.iter().position(|line| line.contains("note: declared here"));
        let declared = note.and_then(|note| {
            let code = self.details.get(note + 1)?.split_once(" | ")?.1.trim();
            Some((self.details[note].split(':').nth(1)?, code))
        });
        match declared {
            Some((line, code)) => {
                format!("`{code}` of line {line} is gone when the function ends: write `static {code}` in line {line}")
            }
            None => {
                let returned = self.code().and_then(|code| code.trim().strip_prefix("return ")?.strip_suffix(';'));
                let name = returned.map_or("", |value| value.trim_start_matches('&').trim());
                match name {
                    name if !name.is_empty() && name.chars().all(is_name) => format!(
                        "`{name}` is gone when the function ends: write `static` in front of the line that declares `{name}`"
                    ),
                    _ => "a variable is gone when its function ends: write `static` in front of the line that declares it".to_owned(),
                }
            }
        }
    }

    /// Explains a function or variable with two definitions.
    fn defined_twice(&self) -> Option<String> {
        // g++ prints the whole signature: `int home(int)`.
        let name = self.quoted(0)?.split('(').next()?.rsplit([' ', '*', '&']).next()?;
        let is_note = |line: &&&str| line.contains("note: ") && (line.contains("previous") || line.contains(name));
        let is_in_program = |line: &&&str| !line.starts_with('/');
        let first = self.details.iter().find(is_note).filter(is_in_program).and_then(|line| line.split(':').nth(1));
        let definitions =
            first.map_or_else(|| "defined twice".to_owned(), |line| format!("already defined in line {line}"));
        Some(format!("`{name}` is {definitions}: delete one of them, or give it another name"))
    }

    /// Explains a name where a type belongs.
    fn unknown_type(&self) -> Option<String> {
        let name = self.quoted(0)?;
        let kinds = ["struct", "enum", "union"];
        if let Some(kind) = kinds.iter().find(|kind| self.text.contains(&format!("use '{kind}' keyword"))) {
            return Some(format!("C wants the `{kind}` again: write `{kind} {name}`"));
        }
        if let Some(words) = self.parameter_without_type().or_else(|| self.word_of_other_language(name)) {
            return Some(words);
        }
        if CPP_LIBRARY_NAMES.contains(&name) {
            return Some(if self.is_c() { not_a_c_type(name) } else { belongs_to_cpp(name) });
        }
        misspelt_keyword(name).or_else(|| {
            if self.suggestion().is_none()
                && let Some(words) = self.split_name(name)
            {
                return Some(words);
            }
            let suggestion =
                self.suggestion().map_or_else(String::new, |suggestion| format!("; did you mean `{suggestion}`?"));
            let cause = if suggestion.is_empty() {
                ", or this line is outside of every function: is there a `}` too many above?"
            } else {
                ""
            };
            Some(format!("`{name}` is not a type{suggestion}{cause}"))
        })
    }

    /// Explains a name in a list of parameters that has no type of its own: `void f(int a, b)`.
    fn parameter_without_type(&self) -> Option<String> {
        let (left, right) = self.split_code()?;
        // A parameter with a type, even an unknown one, has two words.
        let is_single_word = right.trim_start().trim_start_matches(is_name).trim_start().starts_with([',', ')', '[']);
        let is_parameter =
            left.trim_end().ends_with(',') && left.contains('(') && right.contains(')') && begins_function(left);
        (is_parameter && is_single_word)
            .then(|| "each parameter has its own type, as in `void f(int a, int b)`".to_owned())
    }

    /// Explains a word of another language that the compiler takes for a name.
    fn word_of_other_language(&self, name: &str) -> Option<String> {
        let right = self.split_code().map_or("", |(_, right)| right);
        let rest = right.strip_prefix(name).unwrap_or_default().trim_start();
        // Some of these words may be names of variables: `var = 3;`.
        let is_of_cpp = match name {
            "std" => self.code().is_some_and(|code| code.contains("std::")),
            "try" => rest.is_empty() || rest.starts_with('{'),
            name => ["using", "namespace", "template", "cout", "cin"].contains(&name),
        };
        Some(match name {
            "then" => "C has no `then`: leave it out".to_owned(),
            "var" | "let" if rest.starts_with(is_name) => {
                format!("C has no `{name}`: write the type in its place, such as `int`")
            }
            "null" | "None" | "nil" => format!("`{name}` is not defined: write `NULL`"),
            "String" if self.is_c() => "C has no type `String`: a text is a `const char *`".to_owned(),
            "String" => "`String` is not a type: write `std::string`, with `#include <string>`".to_owned(),
            "import" => "C has no `import`: write `#include \"eyebot.h\"`".to_owned(),
            _ if is_of_cpp && self.is_c() => {
                let name_as_cpp = without_txt(Path::new(self.file)).with_extension("cpp");
                format!("`{name}` belongs to C++: name the file `{}`, and in the scene too", name_as_cpp.display())
            }
            _ => return None,
        })
    }

    /// Returns true if the line contains a `*/` that ends no comment.
    fn ends_no_comment(&self) -> bool {
        let line = self.line.parse::<usize>().ok().and_then(|number| number.checked_sub(1));
        line.is_some_and(|line| code_only(self.source).lines().nth(line).is_some_and(|code| code.contains("*/")))
    }

    /// Explains a line that begins with a misspelt keyword: `whlie (x)`.
    fn misspelt_first_word(&self) -> Option<String> {
        let code = without_closing_braces(self.code()?);
        let word = code.split(|c| !is_name(c)).next()?;
        // A word that occurs more than once is a name of the program.
        let count = self.source.split(|c| !is_name(c)).filter(|other| *other == word).count();
        misspelt_keyword(word).filter(|_| count <= 1 || ELSE_IF.contains(&word))
    }

    /// Explains a missing punctuation mark, `mark`; the message's column is after the last word before the mark.
    fn missing_mark(&self, mark: &str) -> String {
        let (code, found) = (self.code(), self.found_token());
        let is_open = |code: &str| code.matches('(').count() > code.matches(')').count();
        let mark = if found == Some("{") && code.is_some_and(is_open) { ")" } else { mark };
        match (found, self.split_code()) {
            (_, Some((left, _))) if left.trim().is_empty() => {
                format!("a `{mark}` is missing at the end of the line before this one")
            }
            (Some(found), Some((_, right))) if !right.is_empty() => {
                let marks = if mark == ")" && (is_word(found) || found.starts_with('"')) {
                    "`,` or a `)`"
                } else {
                    &format!("`{mark}`")
                };
                format!("a {marks} is missing before `{found}`")
            }
            _ => format!("a `{mark}` is missing at the end of this line"),
        }
    }

    /// Explains a format such as `%d` with a value of another type.
    fn wrong_format(&self) -> Option<String> {
        let (format, expected, given) = (self.quoted(0)?, self.quoted(1)?, self.quoted(2)?);
        let is_address = expected.ends_with('*');
        let fits = match given {
            "double" | "float" => Some("%f"),
            "int" => Some("%d"),
            "long int" | "long" => Some("%ld"),
            "char *" | "char*" => Some("%s"),
            _ => None,
        };
        Some(match fits {
            _ if is_address && !given.ends_with('*') && format != "%s" => {
                format!("`{format}` needs the address of a variable: write `&` before its name")
            }
            Some(fits) if !is_address || format == "%s" => {
                format!("`{format}` is for `{expected}`, and the value is `{given}`: write `{fits}`")
            }
            _ => format!("`{format}` is for `{expected}`, and the value is `{given}`"),
        })
    }

    /// Explains an unknown name.
    fn undeclared(&self) -> Option<String> {
        let name = self.quoted(0)?;
        let header = self.details.iter().find_map(|line| line.split_once("defined in header '")?.1.split('\'').next());
        if let Some(header) = header {
            if header.ends_with(".h>") {
                return Some(format!("`{name}` is not defined: write `#include {header}` as the first line"));
            }
            return Some(format!(
                "`{name}` belongs to the C++ library: write `#include {header}` as the first line, and `std::{name}`"
            ));
        }
        if !self.is_c() && (CPP_LIBRARY_NAMES.contains(&name) || self.means_cpp_function(name)) {
            return Some(belongs_to_cpp(name));
        }
        if let Some(given) = self.code().and_then(print_arguments).filter(|given| given.starts_with(name)) {
            let text = given.split([',', ')']).next()?;
            return Some(format!(
                "`{name}` is not defined: a text is written between quotes, as in `LCDPrintf(\"{text}\")`"
            ));
        }
        if let Some(words) = self.word_of_other_language(name).or_else(|| self.split_name(name)) {
            return Some(words);
        }
        Some(match self.suggestion() {
            Some(suggestion) => format!("`{name}` is not defined; did you mean `{suggestion}`?"),
            None if misspelt_keyword(name).is_some() => misspelt_keyword(name)?,
            None if self.code().is_some_and(|code| code.contains(&format!("{name}("))) => self.unknown_function(name),
            None => format!(
                "`{name}` is not defined: declare it before this line, such as `int {name} = 0;`, or check the spelling"
            ),
        })
    }

    /// Returns true if an unknown `name` is probably a function of the C++ library, and not a variable or a function that
    /// the source defines below.
    fn means_cpp_function(&self, name: &str) -> bool {
        let is_called = || self.code().is_some_and(|code| code.contains(&format!("{name}(")));
        let is_known = || ["max", "min", "sort"].contains(&name) || self.source.contains("using namespace std");
        let is_own = || calls_of(self.source).defined.contains(name);
        header_of_cpp_function(name).is_some()
            && (self.text.contains("'std'") || is_called() && is_known() && !is_own())
    }

    /// Explains two words without a mark between them; the message is at the second word.
    fn separated_words(&self, second: &str) -> String {
        let left = self.split_code().unwrap_or_default().0.trim_end();
        if left.is_empty() {
            return self.missing_above();
        }
        let first = left.rsplit(|c| !is_name(c)).next().unwrap_or_default();
        let missing = format!("a `,` or a `;` is missing before `{second}`");
        if first.is_empty() || similar_keyword(first).is_some() || TYPES.contains(&second) {
            return missing;
        }
        format!("{missing}, or `{first} {second}` is one name: write `{first}_{second}`")
    }

    /// Explains a `{` or a `;` that is missing above the line: the likelier one of the two.
    fn missing_above(&self) -> String {
        let code = code_only(self.source);
        let line_index = self.line.parse().map_or(0, |line: usize| line.saturating_sub(1));
        let line_above = code.lines().take(line_index).enumerate().filter(|(_, line)| !line.trim().is_empty()).last();
        match line_above {
            Some((index, head)) if !head.contains(['(', '#']) && head.trim_end().ends_with(is_name) => {
                format!("a `;` is missing at the end of line {}", index + 1)
            }
            // An unfinished declaration, with another declaration below it.
            Some((index, _)) if code.lines().nth(line_index).is_some_and(begins_function) => {
                format!("a `;` is missing at the end of line {}, or a block between `{{ }}` after it", index + 1)
            }
            Some((index, head)) if begins_function(head) => {
                format!("a `{{` is missing after line {}, `{}`", index + 1, head.trim())
            }
            _ => "a `{` is missing before this line, or a `;` at the end of the one before".to_owned(),
        }
    }

    /// Explains a missing `;` after the first line of a function, directly above another function; the message is at
    /// the `{` of that function.
    fn missing_after_head(&self) -> Option<String> {
        let code = code_only(self.source);
        let line_index = self.line.parse::<usize>().ok()?.checked_sub(1)?;
        let lines_above = code.lines().take(line_index).enumerate().filter(|(_, line)| !line.trim().is_empty());
        let lines_above: Vec<(usize, &str)> = lines_above.collect();
        let [.., (first, head), (_, second)] = lines_above.as_slice() else { return None };
        (begins_function(head) && begins_function(second) && head.trim_end().ends_with(')'))
            .then(|| format!("a `;` is missing at the end of line {}", first + 1))
    }

    /// Explains a function that is called and not declared.
    fn unknown_function(&self, name: &str) -> String {
        let first_line_below = self.line.parse().unwrap_or(usize::MAX);
        let code = code_only(self.source);
        let definition = code.lines().enumerate().skip(first_line_below).find_map(|(index, line)| {
            let (head, _) = line.split_once('(')?;
            let is_defined = head.trim_end().rsplit([' ', '*', '&']).next() == Some(name) && begins_function(line);
            is_defined.then(|| (index + 1, line.trim_end().trim_end_matches('{').trim_end()))
        });
        match definition {
            Some((line, head)) if head.ends_with(')') => format!(
                "`{name}` is defined below, in line {line}: move it above the function that calls it, or write `{head};` at the top, below `#include`"
            ),
            Some((line, _)) => {
                format!("`{name}` is defined below, in line {line}: move it above the function that calls it")
            }
            None if name == "gets" => {
                "`gets` has been removed from C, as it writes beyond its array: write `fgets(text, sizeof text, stdin)`"
                    .to_owned()
            }
            None if self.details.iter().any(|line| line.contains(": note: include '<")) => {
                let header = self.details.iter().find_map(|line| quoted(line.split_once(": note: include ")?.1, 0));
                format!("`{name}` is not known: write `#include {}` as the first line", header.unwrap_or_default())
            }
            None => {
                format!("`{name}` is not known: check the spelling, or define the function above the one that calls it")
            }
        }
    }

    /// Explains a function inside another function.
    fn nested_function(&self) -> String {
        let name = |head: &str| head.split('(').next()?.rsplit([' ', '*', '&']).next().map(str::to_owned);
        let code = code_only(self.source);
        let line_index = self.line.parse().map_or(0, |line: usize| line.saturating_sub(1));
        let head = code.lines().take(line_index + 1).filter(|line| line.contains('(')).last().and_then(name);
        let (Some(inner), Some(outer)) = (head, name(self.function).filter(|name| !name.is_empty())) else {
            return "a function cannot be written within another one: is a `}` missing above?".to_owned();
        };
        format!("`{inner}` cannot be written within `{outer}`: move it out of `{outer}`, above its first line")
    }

    /// Explains an unknown `name` that is followed by another word, as in `my speed`, and cannot be a type.
    fn split_name(&self, name: &str) -> Option<String> {
        let (left, code) = self.split_code()?;
        let rest = code.strip_prefix(name)?.strip_prefix(' ')?;
        let second = rest.split(|c| !is_name(c)).next()?;
        let is_call = rest[second.len()..].starts_with('(');
        let may_be_type = self.text.contains("type") || left.trim().is_empty() || name.starts_with(char::is_uppercase);
        let is_word = second.starts_with(char::is_alphabetic);
        let is_keyword = misspelt_keyword(name).is_some() || ["and", "or", "not"].contains(&second);
        (is_word && !is_keyword && (is_call || !may_be_type)).then(|| {
            format!(
                "`{name}` is not defined; if `{name} {second}` is one name, write it as one word, such as `{name}_{second}`"
            )
        })
    }

    /// The declaration of `function` in the compiler's notes, after a colon: ``:
    /// `int VWStraight(int dist, int lin_speed)```.
    fn function_declaration(&self, function: &str) -> String {
        let beginning = format!(" {function}(");
        let excerpt_code = |line: &&str| line.split_once(" | ").map(|(_, code)| code.trim().to_owned());
        // The first excerpt shows the call.
        let is_call = |code: &str| self.details.first().is_some_and(|call| call.contains(code));
        let is_declaration = |code: &String| code.ends_with(");") && code.contains(&beginning) && !is_call(code);
        let declared = self.details.iter().filter_map(excerpt_code).find(is_declaration);
        declared.map_or_else(String::new, |code| {
            let prototype = code.split(" EYESIM_").next().unwrap_or(&code).trim_end_matches(';');
            format!(": `{prototype}`")
        })
    }

    /// Explains a text or an index beyond its array. The messages of gcc contain sizes in bytes, its notes the array.
    fn overflow(&self) -> Option<String> {
        let code = self.code().unwrap_or_default();
        let texts = || std::iter::once(self.text).chain(self.details.iter().copied());
        let text_after = |words: &str| texts().find_map(|text| text.split_once(words)?.1.split('\'').next());
        let object = text_after("object '").or_else(|| text_after("referencing '")).map(source_name);
        let is_allocated = texts().any(|text| text.contains(" allocated by '"));
        let call = self.writing_call();
        // Destination of a function that writes a text up to the text's end.
        let text_destination =
            call.filter(|(function, _)| TEXT_WRITING_FUNCTIONS.contains(function)).map(|(_, destination)| destination);
        let subscript = ["array subscript ", "array index "].iter().find_map(|words| self.text.split_once(words));
        if let Some((_, rest)) = subscript {
            // gcc reports a copied text as an index, too.
            let is_copied = call.is_some_and(|(function, _)| ["strcpy", "strcat"].contains(&function))
                && self.text.contains(" is outside ");
            if !is_copied {
                return self.wrong_index(rest, object, is_allocated);
            }
            if code_only(code).contains(['[', '*']) {
                return None;
            }
        }
        // gcc reports the whole destination of `sprintf`, and the object to which other functions write.
        let number = |words: &str| texts().find_map(|text| number_after(text, words));
        let print_size = number("into a destination of size ");
        let is_member = |name: &&str| (name.contains('.') || name.contains("->")) && !name.contains('(');
        let member = text_destination.filter(is_member).filter(|_| !is_allocated);
        let printed_name = text_destination.filter(|name| print_size.is_some() && is_word(name));
        let name = member.or(object).or(printed_name);
        let is_part_of_object = member.is_some_and(|member| object != member.rsplit(['.', '>']).next());
        // The line writes through a pointer: the text may begin anywhere in the array.
        let is_indirect =
            member.is_none() && !is_allocated && text_destination.is_some_and(|destination| Some(destination) != name);
        let type_size =
            text_after("with type '").and_then(|kind| kind.strip_prefix("char")?.trim_start().strip_prefix('['));
        let note_size =
            texts().filter(|text| text.contains(" object ")).find_map(|text| number_after(text, "' of size "));
        let region = ["region of size ", "destination of size ", "has size "];
        let region = region.iter().find_map(|words| number_after(self.text, words));
        let capacity = type_size
            .and_then(|size| size.trim_end_matches(']').parse().ok())
            .or(note_size)
            .or_else(|| number("object of size "))
            .or(print_size)
            .or(region)
            .filter(|_| !is_part_of_object);
        let place = match name {
            Some(name) if is_indirect => format!("its place in `{name}`"),
            Some(name) => format!("`{name}`"),
            None if is_allocated => "memory".to_owned(),
            None => "an array".to_owned(),
        };
        let which = if place == "memory" { " that" } else { ", which" };
        let advice = match object {
            _ if is_allocated => "allocate more",
            Some(_) => "make the array larger",
            None => "give it more room",
        };
        let is_print = self.text.contains("directive");
        Some(match (number_after(self.text, "writing "), capacity) {
            (_, Some(capacity)) if call.is_some_and(|(function, _)| function == "strcat") && !is_indirect => format!(
                "`strcat` appends to the text in {place}, and both together are too long for its {capacity} bytes: {advice}"
            ),
            (Some(count), Some(capacity)) if region == Some(capacity) && !is_print => {
                let is_end = is_allocated && text_destination.is_some() && count == capacity + 1;
                let advice = if is_end { "allocate one byte more, for the end of the text" } else { advice };
                format!("{count} bytes are written to {place}{which} has room for {capacity}: {advice}")
            }
            (_, Some(capacity)) if is_indirect => {
                format!("the text is too long for {place}{which} has room for {capacity} bytes in all: {advice}")
            }
            (_, Some(capacity)) if text_destination.is_some() || is_print => {
                format!("the text is too long for {place}{which} has room for {capacity} bytes: {advice}")
            }
            _ if is_part_of_object && object.is_some() => format!("the text is too long for {place}"),
            (None, None) if member.is_some() && self.text.contains("forming offset") => {
                format!("the text is too long for `{}`", member?)
            }
            _ if ["writing ", "forming offset"].iter().any(|words| self.text.contains(words)) => {
                let bounded_call = call.filter(|(function, destination)| {
                    !TEXT_WRITING_FUNCTIONS.contains(function) && Some(*destination) == object
                });
                let end = number_after(self.text.split_once("forming offset")?.1.split(" is ").next()?, ", ");
                let size =
                    text_after("out of the bounds [0, ").and_then(|rest| rest.split(']').next()?.parse::<u64>().ok());
                if let (Some((function, destination)), Some(end), Some(size)) = (bounded_call, end, size) {
                    return Some(format!(
                        "`{function}` writes {} bytes to `{destination}`, which has room for {size}: write fewer, or {advice}",
                        end + 1
                    ));
                }
                let len = text_after("with type '").and_then(array_length);
                let indices = len.map_or_else(String::new, |len| valid_indices(Some(len)));
                format!("this line reads or writes outside of `{}`{indices}", object?)
            }
            _ => return None,
        })
    }

    /// A call that writes a text or bytes to its first argument: the function and that argument. The call is at the
    /// column of the message, or else the only such call in the line.
    fn writing_call(&self) -> Option<(&'static str, &str)> {
        let (code, right) = (self.code()?, self.split_code()?.1);
        let at_column = WRITING_FUNCTIONS
            .iter()
            .find(|function| starts_with_word(right, function))
            .map(|function| (*function, right));
        let calls: Vec<(&'static str, &str)> = WRITING_FUNCTIONS
            .iter()
            .flat_map(|function| code.match_indices(function).map(|(offset, _)| (*function, offset)))
            .filter(|(function, offset)| {
                !code[..*offset].ends_with(is_name) && starts_with_word(&code[*offset..], function)
            })
            .map(|(function, offset)| (function, &code[offset..]))
            .collect();
        let single_call = || <[_; 1]>::try_from(calls).ok().map(|[call]| call);
        let (function, call) = at_column.or_else(single_call)?;
        let values = call[function.len()..].trim_start().strip_prefix('(')?;
        let destination = values.split([',', ')']).next()?.trim();
        (!destination.is_empty()).then_some((function, destination))
    }

    /// Explains an index outside of an array or of memory; `rest` is the text of gcc after `array subscript `.
    fn wrong_index(&self, rest: &str, object: Option<&str>, is_allocated: bool) -> Option<String> {
        let kind = quoted(rest, 0);
        if rest.starts_with('\'') {
            // `Robot[0]`: the type to which the pointer points, in memory of another size.
            let kind = kind?.strip_suffix("[0]").filter(|_| is_allocated)?;
            let size = self.details.iter().find_map(|line| number_after(line, "object of size "))?;
            return Some(format!("memory of {size} bytes is too small for `{kind}`: allocate `sizeof({kind})` bytes"));
        }
        if kind.is_some_and(|kind| kind.ends_with("[0]")) && !self.details.iter().any(|line| line.contains("note: ")) {
            return match self.accesses()?.pointers.as_slice() {
                [] => None,
                [name] => Some(format!("`{name}` is NULL")),
                _ => Some("a pointer in this line is NULL".to_owned()),
            };
        }
        let index = rest.split([' ', ',']).next().unwrap_or_default();
        // `int[3]`; for memory without a type `void[12]`, a number of bytes.
        let len = kind.filter(|kind| !kind.starts_with("void")).and_then(array_length);
        // Memory of `malloc` has no name in the notes.
        let name = object.map(str::to_owned).or_else(|| {
            let accesses = self.accesses()?;
            <[String; 1]>::try_from(accesses.pointers).ok().filter(|_| accesses.arrays.is_empty()).map(|[name]| name)
        });
        let is_row = name.as_deref().is_some_and(|name| self.has_rows(name))
            && kind.is_some_and(|kind| kind.matches('[').count() == 1);
        let name = name.map_or_else(|| "an array".to_owned(), |name| format!("`{name}`"));
        let row = if is_row { "a row of " } else { "" };
        Some(format!("the index {index} is outside of {row}{name}{}", valid_indices(len)))
    }

    /// The line's reads and writes through pointers and arrays.
    fn accesses(&self) -> Option<Accesses> {
        accesses_of(self.source, self.line.parse().ok()?)
    }

    /// Returns true if a note shows that the array `name` has two dimensions or more.
    fn has_rows(&self, name: &str) -> bool {
        let note = self.details.iter().position(|line| line.contains("note: while referencing"));
        let code = note.and_then(|note| self.details.get(note + 1)?.split_once(" | ")).map_or("", |(_, code)| code);
        code.match_indices(name).any(|(offset, _)| {
            let dimension = code[offset + name.len()..].split_once(']');
            dimension.is_some_and(|(length, rest)| length.starts_with('[') && rest.starts_with('['))
        })
    }

    /// Explains a loop whose index leaves an array, with the array's name if the line has only one. `None` if the loop
    /// may instead have a number that becomes too large.
    fn overrun_by_loop(&self) -> Option<String> {
        let blanked = code_only(self.code().unwrap_or_default());
        let accesses = self.accesses().unwrap_or_default();
        let array = <[IndexedArray; 1]>::try_from(accesses.arrays)
            .ok()
            .filter(|_| accesses.pointers.is_empty())
            .map(|[array]| array);
        let is_length_reached = array
            .as_ref()
            .is_some_and(|array| array.len.is_some() && array.len == number_after(self.text, "iteration "));
        if !blanked.contains('[') || !is_length_reached && (blanked.contains('*') || blanked.contains("<<")) {
            return None;
        }
        let note = self.details.iter().find(|line| line.contains("note: within this loop"));
        let line =
            note.and_then(|note| note.split(':').nth(1)).map_or_else(String::new, |line| format!(" of line {line}"));
        Some(match array {
            Some(IndexedArray { name, len, .. }) => {
                format!("the loop{line} uses an index outside of `{name}`{}", valid_indices(len))
            }
            None => format!("the loop{line} uses an index outside of an array{}", valid_indices(None)),
        })
    }

    /// Explains an argument of a wrong type.
    fn wrong_argument(&self) -> Option<String> {
        let note = self.details.iter().find(|line| line.contains("note: expected '"));
        let (expected, given) = match note {
            Some(note) => (quoted(note, 0)?, quoted(note.split_once("of type ")?.1, 0)?),
            None if self.text.starts_with("passing") => return None,
            // The message of g++ itself contains the types.
            None => (self.quoted(1)?, self.quoted(0)?),
        };
        let (expected, given) = (expected.trim(), given.trim());
        let pointee = expected.strip_suffix('*').map(str::trim);
        Some(match pointee {
            Some(pointee) if pointee == given => {
                format!("the function writes to the address of a variable: write `&` before its name (`{expected}`)")
            }
            // g++ reports a function that is indexed as an argument of a wrong type.
            _ if given.contains("(*)[") && element_type(given) == element_type(expected) => {
                "an array of arrays stands where a pointer to its elements belongs: write `&` before its first element, as in `&image[0][0]`"
                    .to_owned()
            }
            _ if given.contains("(*)(") && self.split_code().is_some_and(|(_, right)| right.starts_with(']')) => {
                FUNCTION_INDEXED.to_owned()
            }
            _ if given.contains("(*)(") => {
                "the function is named here, but not called: write `( )` after it, as in `PSDGet(1)`".to_owned()
            }
            _ if NUMBERS.contains(&given) && self.code().is_some_and(|code| print_arguments(code).is_some()) => {
                let format = if ["double", "float"].contains(&given) { "%f" } else { "%d" };
                format!("to show a number, write `LCDPrintf(\"{format}\\n\", d)`")
            }
            _ if note.is_some() || self.details.iter().any(|line| line.contains("initializing argument")) => {
                format!("the function takes `{expected}`, and is given `{given}`")
            }
            _ => type_mismatch(expected, given),
        })
    }
}

/// Keywords with which statements begin, and `printf`.
const KEYWORDS: [&str; 18] = [
    "while", "for", "return", "if", "else", "switch", "case", "break", "continue", "double", "float", "int", "char",
    "void", "unsigned", "static", "struct", "printf",
];

/// Types of numbers.
const NUMBERS: [&str; 5] = ["int", "double", "float", "long int", "unsigned int"];

/// The line of code without leading closing braces.
fn without_closing_braces(code: &str) -> &str {
    code.trim_start().trim_start_matches('}').trim_start()
}

/// The function of the call whose arguments the code ends in: `CAMGet` for `if (CAMGet(`.
fn called_function(code: &str) -> &str {
    let mut depth = 0;
    let opening = code.rfind(|mark| {
        depth += i32::from(mark == ')') - i32::from(mark == '(');
        depth < 0
    });
    let left = code[..opening.unwrap_or(0)].trim_end();
    &left[left.trim_end_matches(is_name).len()..]
}

/// Type and length of the array that a function of RoBIOS takes in a program with this code.
fn array_of(function: &str, code: &str) -> Option<(&'static str, String)> {
    let takes_image = ["CAMGet", "IP", "LCDImage"].iter().any(|beginning| function.starts_with(beginning));
    let fixed = |kind, length: &str| Some((kind, length.to_owned()));
    match function {
        "LIDARGet" => fixed("int", argument_of("LIDARSet", 2, code).unwrap_or("360")),
        "SIMLaserScan" => fixed("int", "360"),
        "RADIOStatus" => fixed("int", "256"),
        "CAMGetFrameMono" => fixed("BYTE", "4800"),
        "CAMGetFrameColor" | "CAMGetFrameRGB" => fixed("BYTE", "14400"),
        "CAMGetFrameBayer" => fixed("BYTE", "19200"),
        _ if function.starts_with("IPP") || function.starts_with("CAMGetFrame") => None,
        _ => takes_image.then(|| ("BYTE", image_size(code))),
    }
}

/// Number of bytes of a colour image in the resolution that a program sets, `VGA_SIZE` for `CAMInit(VGA)`; that of QVGA if
/// it is unknown.
fn image_size(code: &str) -> String {
    let resolution = argument_of("CAMInit", 0, code).filter(|name| SIZES_OF_7.contains(name));
    format!("{}_SIZE", resolution.unwrap_or("QVGA"))
}

/// Argument `index` in the first call of `function`, if no argument has parentheses.
fn argument_of<'a>(function: &str, index: usize, code: &'a str) -> Option<&'a str> {
    let (_, rest) = code.split_once(function)?;
    let (arguments, _) = rest.trim_start().strip_prefix('(')?.split_once(')')?;
    arguments.split(',').nth(index).map(str::trim).filter(|argument| !argument.is_empty() && !arguments.contains('('))
}

fn starts_with_word(code: &str, word: &str) -> bool {
    code.strip_prefix(word).is_some_and(|rest| !rest.starts_with(is_name))
}

/// The type with which a line of code declares the variable `name` as a single value: `BYTE` for `BYTE img;`.
fn declared_type<'a>(line: &'a str, name: &str) -> Option<&'a str> {
    let type_in = |part: &'a str| {
        let part = part.trim_start();
        let kind = TYPES.iter().chain(&["BYTE", "COLOR", "short"]).find(|kind| starts_with_word(part, kind))?;
        // What precedes `(` is a function.
        let names = part[kind.len()..].split_once([';', ')']).map(|(names, _)| names)?;
        let is_named = |declared: &str| declared.split('=').next().is_some_and(|declared| declared.trim() == name);
        names.split(',').any(is_named).then_some(&part[..kind.len()])
    };
    line.split(['(', '{']).find_map(type_in)
}

/// Returns true for a `#define` of a value with `=` or `;`.
fn is_wrong_define(code: &str) -> bool {
    code.strip_prefix("#define").is_some_and(|rest| {
        let rest = rest.trim();
        let (name, value) = rest.split_once(' ').unwrap_or((rest, ""));
        !name.contains('(') && (name.contains('=') || value.trim_start().starts_with('=') || value.ends_with(';'))
    })
}

/// Explains a list of numbers in the manner of Python, or the brackets before it: `int[2] a = [1, 2];`.
fn python_list(code: &str) -> Option<String> {
    let (head, values) = code.split_once('=')?;
    let values = values.trim().strip_prefix('[')?.split(']').next()?.trim();
    let is_listed = |letter: char| is_name(letter) || ",. -+".contains(letter);
    let kind = TYPES.iter().chain(&["BYTE", "short"]).find(|kind| starts_with_word(head, kind))?;
    let (mut name, mut size) = (head[kind.len()..].trim(), "");
    if let Some(rest) = name.strip_prefix('[') {
        let (inner, rest) = rest.split_once(']')?;
        (size, name) = (inner.trim(), rest.trim());
    } else if let Some((first, rest)) = name.split_once('[') {
        (name, size) = (first.trim(), rest.split(']').next()?.trim());
    }
    let is_plain = is_word(name) && !name.is_empty() && is_word(size) && values.chars().all(is_listed);
    is_plain.then(|| format!("a list of values is written between `{{ }}`: `{kind} {name}[{size}] = {{{values}}};`"))
}

/// Returns true for `while (...);`, `for (...);` and `if (...);`, also with blanks and a comment, but not for the
/// `while` of a `do`.
pub fn is_empty_clause(code: &str) -> bool {
    let code = code_only(code);
    let code = code.trim();
    let is_clause = ["while", "for", "if"].iter().any(|word| starts_with_word(code, word));
    is_clause && behind_parentheses(code).is_some_and(|rest| rest.trim() == ";")
}

/// Returns true if `&&` or `||` follows the parentheses of a condition: `if (a) && (b)`.
fn has_split_condition(code: &str) -> bool {
    let clause = ["if", "while"]
        .into_iter()
        .find_map(|word| code.find(&format!("{word} (")).or_else(|| code.find(&format!("{word}("))))
        .filter(|offset| !code[..*offset].ends_with(is_name));
    let rest = clause.and_then(|offset| behind_parentheses(&code[offset..]));
    rest.is_some_and(|rest| ["&&", "||"].iter().any(|operator| rest.trim_start().starts_with(operator)))
}

/// What follows the first pair of parentheses in `code`.
fn behind_parentheses(code: &str) -> Option<&str> {
    let mut depth = 0_i32;
    let end = code.find(|letter| {
        depth += i32::from(letter == '(') - i32::from(letter == ')');
        letter == ')' && depth == 0
    })?;
    code.get(end + 1..)
}

/// Explains a line with an odd number of quotes.
fn missing_quote(line: &str) -> Option<&'static str> {
    let mut rest = line;
    let mut open = None;
    while let Some(letter) = rest.chars().next() {
        let skipped = match letter {
            '\\' => 2,
            '\'' if rest.starts_with("'\"'") => 3,
            '/' if rest.starts_with("//") && open.is_none() => break,
            letter => letter.len_utf8(),
        };
        rest = rest.get(skipped..).unwrap_or_default();
        if letter == '"' {
            open = if open.is_none() { Some(rest) } else { None };
        }
    }
    Some(match open? {
        "" => "a text has no opening `\"`: write it before the text",
        rest if rest.starts_with([')', ',', ';']) => "a text has no opening `\"`: write it before the text",
        _ => "the text has no end: write `\"` after it",
    })
}

/// The arguments in a line that begins with a call of a printing function.
fn print_arguments(code: &str) -> Option<&str> {
    let code = code.trim_start();
    ["LCDPrintf(", "printf(", "std::printf("].iter().find_map(|call| code.strip_prefix(call))
}

/// The keyword that `word` resembles. Their edit distance is at most 1, or 2 for long keywords; swapped neighbouring
/// letters are one edit.
fn similar_keyword(word: &str) -> Option<&'static str> {
    let max_distance = |keyword: &str| {
        let has_same_start = word.len().abs_diff(keyword.len()) <= 1 && word.chars().next() == keyword.chars().next();
        if keyword.len() > 5 && has_same_start { 2 } else { 1 }
    };
    let is_similar = |keyword: &&&str| strsim::osa_distance(&word.to_lowercase(), keyword) <= max_distance(keyword);
    let is_other_case = |keyword: &str| keyword.eq_ignore_ascii_case(word);
    KEYWORDS
        .iter()
        .find(is_similar)
        .copied()
        .filter(|keyword| *keyword != word && (word.len() > 2 || is_other_case(keyword)))
}

/// Words of other languages for `else if`.
const ELSE_IF: [&str; 3] = ["elseif", "elsif", "elif"];

/// Explains a misspelt keyword; `None` for other words.
fn misspelt_keyword(word: &str) -> Option<String> {
    if ELSE_IF.contains(&word) {
        return Some(format!("`{word}` is not defined: write `else if`"));
    }
    similar_keyword(word).map(|keyword| format!("`{word}` is not defined; did you mean `{keyword}`?"))
}

/// Explains a value of the type `given` in place of one of the type `expected`.
fn type_mismatch(expected: &str, given: &str) -> String {
    if expected == "char" && ["char *", "char*", "const char *", "const char*"].contains(&given) {
        return "a single letter is written between `'`, as in `'a'`; a text between `\"` is a `const char *`"
            .to_owned();
    }
    if NUMBERS.contains(&expected) && ["char *", "char*", "const char *", "const char*"].contains(&given) {
        return format!("a text stands where a number (`{expected}`) belongs: write a number, without quotes");
    }
    format!("a value of type `{given}` stands where one of type `{expected}` belongs")
}

/// Explains a name of the C++ library without its header and `std::`.
fn belongs_to_cpp(name: &str) -> String {
    let header = match name {
        "cin" | "cout" | "endl" => "iostream",
        "pair" => "utility",
        name => header_of_cpp_function(name).unwrap_or(name),
    };
    format!("`{name}` belongs to the C++ library: write `#include <{header}>` at the top, and `std::{name}`")
}

/// Functions of the C++ library that older compilers also declared in other headers, with their own header.
const CPP_FUNCTIONS: [(&str, &[&str]); 2] = [
    (
        "algorithm",
        &[
            "all_of",
            "any_of",
            "binary_search",
            "clamp",
            "copy",
            "count",
            "count_if",
            "fill",
            "fill_n",
            "find",
            "find_if",
            "for_each",
            "generate",
            "lower_bound",
            "max",
            "max_element",
            "min",
            "min_element",
            "minmax_element",
            "next_permutation",
            "none_of",
            "nth_element",
            "partial_sort",
            "partition",
            "random_shuffle",
            "remove",
            "remove_if",
            "replace",
            "reverse",
            "rotate",
            "shuffle",
            "sort",
            "stable_sort",
            "swap",
            "transform",
            "unique",
            "upper_bound",
        ],
    ),
    ("numeric", &["accumulate", "inner_product", "iota", "partial_sum"]),
];

/// The header of a function of the C++ library, such as `algorithm` for `sort`; `None` for other functions.
fn header_of_cpp_function(name: &str) -> Option<&'static str> {
    CPP_FUNCTIONS.iter().find(|(_, functions)| functions.contains(&name)).map(|(header, _)| *header)
}

/// Headers of the C++ library, each once, that declare the functions unknown according to the compiler's `output` about
/// a C++ source (gcc and clang, `LC_ALL=C`).
pub fn missing_cpp_headers(output: &str) -> Vec<&'static str> {
    const UNKNOWN: [&str; 4] =
        ["is not a member of 'std'", "in namespace 'std'", "was not declared in this scope", "undeclared identifier"];
    let is_unknown = |line: &&str| line.contains("error: ") && UNKNOWN.iter().any(|phrase| line.contains(phrase));
    let mut headers = Vec::new();
    for line in output.lines().filter(is_unknown) {
        // g++ writes `'sort' is not a member of 'std'`, or `'std::sort'`.
        let name = quoted(line, 0).map(|name| name.strip_prefix("std::").unwrap_or(name));
        headers.extend(name.and_then(header_of_cpp_function).filter(|header| !headers.contains(header)));
    }
    headers
}

/// Explains a name of the C++ library in a C program.
fn not_a_c_type(name: &str) -> String {
    match name {
        "string" => "C has no type `string`: a text is a `const char *`".to_owned(),
        name => format!("C has no type `{name}`: it belongs to C++"),
    }
}

/// Functions of the C library that write to their first argument.
const WRITING_FUNCTIONS: [&str; 9] =
    ["memcpy", "memmove", "memset", "snprintf", "sprintf", "strcat", "strcpy", "strncat", "strncpy"];

/// Writing functions that copy a text up to its end, without a limit.
const TEXT_WRITING_FUNCTIONS: [&str; 3] = ["sprintf", "strcat", "strcpy"];

/// Keywords of C++ that C does not have.
const CPP_KEYWORDS: [&str; 16] = [
    "catch",
    "class",
    "delete",
    "explicit",
    "export",
    "friend",
    "namespace",
    "new",
    "operator",
    "private",
    "protected",
    "public",
    "template",
    "this",
    "try",
    "using",
];

/// Names of the C++ library that beginners write without `std::`.
const CPP_LIBRARY_NAMES: [&str; 10] =
    ["array", "cin", "cout", "endl", "list", "map", "pair", "set", "string", "vector"];

/// Returns true if `text` consists of letters, digits and `_`.
fn is_word(text: &str) -> bool {
    text.chars().all(is_name)
}

const EXTERN_C: &str =
    "`extern \"C\"` belongs to C++: leave it out with its `{ }`, or write it between `#ifdef __cplusplus` and `#endif`";

const ARRAY_ASSIGNED: &str = "an array cannot be set with `=`: `strcpy(array, \"text\")`, with `#include <string.h>`, copies a text, a loop copies numbers";

const LIST_ASSIGNED: &str = "`{ }` sets an array only where it is declared, as in `int d[] = {1, 2, 3};`: set its elements one by one, as in `d[0] = 1;`";

const LIST_MISSING: &str = "an array begins with values between `{ }`, as in `int d[] = {1, 2, 3};`, or with a text between `\"`: set other values one by one, as \
     in `d[0] = 1;`";

const NOT_A_NUMBER: &str = "a number has only digits and one `.`, a name begins with a letter, and `*` multiplies";

const ROW_LENGTH: &str = "only the first `[ ]` may be empty: write the length into the others, as in `int d[][2]`";

const OUTSIDE_FUNCTIONS: &str = "this line is outside of every function: there is a `}` too many above, or a `{` is missing, or it should be within a \
                       function, such as `main`";

const VOID_RETURNS: &str =
    "a `void` function returns no value: write the value's type in place of `void`, such as `int`";

const FUNCTION_INDEXED: &str = "`[ ]` belongs to an array: a function is called with `( )`, as in `PSDGet(1)`";

const BRACE_WITHOUT_FUNCTION: &str = "this `{` belongs to no function: a function has `( )` after its name, as in `int main(void)`, or a `;` is missing further up";

/// Hint for a stack overflow by one function.
pub const RECURSION: &str = "the function calls itself for ever: it needs an `if` with a `return` before the call";

/// The number after `words` in `text`.
fn number_after(text: &str, words: &str) -> Option<u64> {
    let (_, rest) = text.split_once(words)?;
    rest.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()
}

/// The name of a variable without the suffix that the compiler adds: `d` for `d.2`.
fn source_name(name: &str) -> &str {
    match name.rsplit_once('.') {
        Some((stem, number)) if number.bytes().all(|byte| byte.is_ascii_digit()) => stem,
        _ => name,
    }
}

/// The length of an array of the type `kind`, such as `int[3]`.
fn array_length(kind: &str) -> Option<u64> {
    kind.split_once('[')?.1.split(']').next()?.parse().ok()
}

/// Describes the length of an array and its indices: ``, which has 4 elements with the indices 0 to 3``; returns a
/// general rule if the length is unknown.
fn valid_indices(len: Option<u64>) -> String {
    match len.and_then(|len| Some((len, len.checked_sub(1)?))) {
        Some((1, _)) => ", which has 1 element with the index 0".to_owned(),
        Some((len, last)) => format!(", which has {len} elements with the indices 0 to {last}"),
        None => ": the first one is 0, the last one is one less than the length".to_owned(),
    }
}

/// The text between quotes with this index, from 0.
fn quoted(text: &str, index: usize) -> Option<&str> {
    text.split('\'').skip(1).step_by(2).nth(index).filter(|text| !text.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(output: &str, expected: &str) {
        assert_eq!(in_plain_words(output, ("", "")), expected, "{output}");
    }

    #[test]
    fn gcc_warnings_are_translated() {
        let warnings = [
            (
                "suggest parentheses around assignment used as truth value [-Wparentheses]",
                "`=` assigns a value; write `==` to compare",
            ),
            (
                "'__builtin_memcpy' writing 24 bytes into a region of size 4 [-Wstringop-overflow=]",
                "24 bytes are written to an array, which has room for 4: give it more room",
            ),
            (
                "'distance ' directive writing 9 bytes into a region of size 4 [-Wformat-overflow=]",
                "the text is too long for an array, which has room for 4 bytes: give it more room",
            ),
            (
                "array subscript 3 is above array bounds of 'int[3]' [-Warray-bounds]",
                "the index 3 is outside of an array, which has 3 elements with the indices 0 to 2",
            ),
            (
                "pointer 'map' used after 'free' [-Wuse-after-free]",
                "`map` is used, or given to `free` again, after `free(map)`",
            ),
            (
                "'speed' is used uninitialized [-Wuninitialized]",
                "`speed` has no value yet: give it one where it is declared",
            ),
            (
                "format '%d' expects argument of type 'int', but argument 2 has type 'double' [-Wformat=]",
                "`%d` is for `int`, and the value is `double`: write `%f`",
            ),
            (
                "format '%d' expects argument of type 'int *', but argument 2 has type 'int' [-Wformat=]",
                "`%d` needs the address of a variable: write `&` before its name",
            ),
            (
                "this 'if' clause does not guard... [-Wmisleading-indentation]",
                "the `if` covers only one statement: write `{ }` around all that belong to it",
            ),
            ("infinite recursion detected [-Winfinite-recursion]", RECURSION),
            (
                "pointer used after 'void operator delete [](void*)' [-Wuse-after-free]",
                "memory is used, or deleted again, after its `delete`",
            ),
            (
                "conversion from 'double' to 'int' changes value from '2.9999999999999999e-1' to '0' [-Wfloat-conversion]",
                "0.3 becomes 0 here: RoBIOS-7 takes whole numbers, in mm, mm/s, degrees and ms: 0.3 m is `300`, half a second is `500`",
            ),
            (
                "conversion from 'double' to 'int' changes value from '-1.5707963267948966e+0' to '-1' [-Wfloat-conversion]",
                "-1.571 becomes -1 here: RoBIOS-7 takes degrees, not radians: write `-90`",
            ),
        ];
        for (warning, words) in warnings {
            check(
                &format!("mine.c: In function 'main':\nmine.c:7:3: warning: {warning}\n"),
                &format!("mine.c:7: {words}\n"),
            );
        }
    }

    #[test]
    fn mistakes_of_syntax_and_words_of_other_languages_are_explained() {
        // The compiler's message at a column, the line of the program, and the words.
        let mistakes = [
            (
                3,
                "expected identifier before '(' token",
                "if (d > 5) && (d < 9) stop();",
                "one pair of parentheses encloses the whole condition: `if ((a > 1) && (b < 2))`",
            ),
            (
                11,
                "expected ')' before 'AND'",
                "if (d > 5 AND d < 9) stop();",
                "C writes `&&` for `and`, `||` for `or` and `!` for `not`",
            ),
            (
                12,
                "'then' undeclared (first use in this function)",
                "if (d > 5) then stop();",
                "C has no `then`: leave it out",
            ),
            (16, "expected ';' before '{' token", "} elif (d < 3) {", "`elif` is not defined: write `else if`"),
            (
                4,
                "expected identifier or '(' before '[' token",
                "int[] a = {1,2,3};",
                "write `[ ]` after the name: `int a[]`",
            ),
            (13, "invalid initializer", "int a[4] = f(1);", LIST_MISSING),
            (
                14,
                "unknown type name 'b'",
                "void f(int a, b) {",
                "each parameter has its own type, as in `void f(int a, int b)`",
            ),
            (
                14,
                "'b' has not been declared",
                "void f(int a, b) {",
                "each parameter has its own type, as in `void f(int a, int b)`",
            ),
            (1, "unknown type name 'var'", "var x = 5;", "C has no `var`: write the type in its place, such as `int`"),
            (
                9,
                "'null' undeclared (first use in this function)",
                "int *p = null;",
                "`null` is not defined: write `NULL`",
            ),
            (
                1,
                "unknown type name 'using'",
                "using namespace std;",
                "`using` belongs to C++: name the file `a.cpp`, and in the scene too",
            ),
            (
                16,
                "expected identifier before numeric constant",
                "typedef enum { false, true } bool;",
                "`false` is already defined: give yours another name; `bool`, `true` and `false` need no definition",
            ),
            (
                18,
                "expected 'while' before 'until'",
                "do { stop(); } until (d > 5);",
                "C has no `until`: write `while (...)`, which repeats as long as its condition is true",
            ),
            (7, "invalid preprocessing directive #DEFINE", "#DEFINE X 5", "`#DEFINE` is not known: write `#define`"),
            (
                5,
                "the address of 'VWDone' will always evaluate as 'true' [-Waddress]",
                "if (VWDone) stop();",
                "`VWDone` is not called: write `VWDone()`",
            ),
            (
                1,
                "implicit declaration of function 'gets'; did you mean 'fgets'?",
                "gets(name);",
                "`gets` has been removed from C, as it writes beyond its array: write `fgets(text, sizeof text, stdin)`",
            ),
            (
                6,
                "conflicting types for built-in function 'log'; expected 'double(double)'",
                "void log(char *text);",
                "`log` is the name of a function of the C library: give yours another one",
            ),
            (
                22,
                "reference to 'left' is ambiguous",
                "using namespace std; left = 5;",
                "`left` is a name of the C++ library too, because of `using namespace std;`: give yours another name",
            ),
        ];
        for (column, message, code, words) in mistakes {
            let caret = " ".repeat(column - 1);
            let output = format!(
                "a.c: In function 'main':\na.c:1:{column}: error: {message}\n    1 | {code}\n      | {caret}^~~\n"
            );
            assert_eq!(in_plain_words(&output, ("a.c", code)), format!("a.c:1: {words}\n"), "{output}");
        }
    }

    #[test]
    fn similar_mistakes_are_not_confused() {
        let undefined = |name: &str| {
            format!(
                "`{name}` is not defined: declare it before this line, such as `int {name} = 0;`, or check the spelling"
            )
        };
        let undeclared = |name: &str| format!("'{name}' undeclared (first use in this function)");
        // The file, the compiler's message at a column, the line of the program, and the words.
        let mistakes = [
            (
                "a.c",
                15,
                "unknown type name 'string'".to_owned(),
                "void f(int a, string s) {",
                "C has no type `string`: a text is a `const char *`".to_owned(),
            ),
            ("a.cpp", 15, "'colour' has not been declared".to_owned(), "void f(int a, colour c) {", String::new()),
            (
                "a.c",
                24,
                "expected ';' before 'return'".to_owned(),
                "ok = (a > 5) && (b < 3)",
                "a `;` is missing at the end of this line".to_owned(),
            ),
            (
                "a.c",
                37,
                "expected ';' before 'return'".to_owned(),
                "ok = check_if(x) && check_if(y)",
                "a `;` is missing at the end of this line".to_owned(),
            ),
            (
                "a.c",
                21,
                "the address of 'name' will always evaluate as 'true' [-Waddress]".to_owned(),
                "char name[20]; if (name) stop();",
                String::new(),
            ),
            ("a.c", 14, "invalid initializer".to_owned(), "struct p b = 0;", String::new()),
            (
                "a.c",
                12,
                "array type has incomplete element type 'struct foo'".to_owned(),
                "struct foo arr[5];",
                String::new(),
            ),
            ("a.c", 1, undeclared("var"), "var = a * b;", undefined("var")),
            ("a.c", 1, undeclared("std"), "std = sqrt(v);", undefined("std")),
            ("a.c", 1, undeclared("try"), "try = 3;", undefined("try")),
            (
                "a.c",
                23,
                "expected identifier before numeric constant".to_owned(),
                "enum state { RED = 1, 2 };",
                String::new(),
            ),
            (
                "a.c",
                5,
                "implicit declaration of function 'not'".to_owned(),
                "if (not (d > 3)) stop();",
                "C writes `&&` for `and`, `||` for `or` and `!` for `not`".to_owned(),
            ),
            (
                "a.c",
                8,
                "too few arguments to function 'AND'".to_owned(),
                "return AND(x);",
                "`AND` is called with too few values".to_owned(),
            ),
        ];
        for (file, column, message, code, words) in mistakes {
            let caret = " ".repeat(column - 1);
            let output = format!("{file}:1:{column}: error: {message}\n    1 | {code}\n      | {caret}^\n");
            let expected = if words.is_empty() { words } else { format!("{file}:1: {words}\n") };
            assert_eq!(in_plain_words(&output, (file, code)), expected, "{output}");
        }
    }

    #[test]
    fn an_error_without_a_column_is_translated() {
        check(
            "a.c:4: error: unterminated #if\n    4 | #if SIM\n",
            "a.c:4: this `#if` has no end: write `#endif` below the lines that belong to it\n",
        );
    }

    #[test]
    fn constants_of_the_header_cannot_be_names_or_functions() {
        let output = |error: &str, name: &str| {
            format!(
                "In file included from a.c:1:\n/kit/eyebot.h:24:27: error: {error}\n   24 | #define RED 0xFF0000\n      |             ^~~~\n\
                 a.c:2:13: note: in expansion of macro '{name}'\n"
            )
        };
        check(
            &output("expected identifier before numeric constant", "RED"),
            "a.c:2: `RED` is a constant of `eyebot.h`: give yours another name\n",
        );
        check(
            &output("called object is not a function or function pointer", "PSD_FRONT"),
            "a.c:2: `PSD_FRONT` is a constant of `eyebot.h`, not a function: leave `( )` out\n",
        );
    }

    #[test]
    fn a_comment_in_a_comment_is_reported() {
        let code = "/* a /* b */ c */ stop();";
        let output = format!("a.c:1:14: error: unknown type name 'c'\n    1 | {code}\n      |              ^\n");
        let words = "`*/` ends no comment here: a comment cannot contain another one, and ends at the first `*/`";
        assert_eq!(in_plain_words(&output, ("a.c", code)), format!("a.c:1: {words}\n"));
    }

    #[test]
    fn overrun_arrays_are_named() {
        let words_of = |output: &str, code: &str| in_plain_words(output, ("a.c", code));
        let appended = "a.c:7:3: warning: '__builtin_memcpy' writing 24 bytes into a region of size 4 [-Wstringop-overflow=]\n    7 |   \
                        strcat(name, \"a name\");\n      |   ^~~\na.c:5:8: note: at offset [0, 3] into destination object 'name' of size 4\n";
        let words = "`strcat` appends to the text in `name`, and both together are too long for its 4 bytes: make the array larger";
        assert_eq!(words_of(appended, ""), format!("a.c:7: {words}\n"));
        let printed = "a.c:8:24: warning: '%d' directive writing 3 bytes into a region of size 1 [-Wformat-overflow=]\n    8 |   sprintf(t, \
                       \"distance %d\", 100);\na.c:8:3: note: 'sprintf' output 13 bytes into a destination of size 10\n";
        let words = "the text is too long for `t`, which has room for 10 bytes: give it more room";
        assert_eq!(words_of(printed, ""), format!("a.c:8: {words}\n"));
        let copied = "a.c:9:3: warning: '__builtin_memcpy' forming offset [4, 23] is out of the bounds [0, 4] of object 'name' with type \
                      'char [4]' [-Warray-bounds]\n    9 |   strcpy(name, \"a name\");\n";
        let words = "the text is too long for `name`, which has room for 4 bytes: make the array larger";
        assert_eq!(words_of(copied, ""), format!("a.c:9: {words}\n"));
        let looped = "a.c:4:10: warning: iteration 4 invokes undefined behavior [-Waggressive-loop-optimizations]\n    4 |     d[i] = f(1);\n\
                      a.c:3:21: note: within this loop\n";
        let words = "the loop of line 3 uses an index outside of `d`";
        let known = format!("a.c:4: {words}, which has 4 elements with the indices 0 to 3\n");
        let words = "the loop of line 3 uses an index outside of an array";
        let unknown = format!("a.c:4: {words}: the first one is 0, the last one is one less than the length\n");
        let words_with_source = |output: &str, code: &str| words_of(output, &format!("{code}\nint i;\nd[i] = f(1);\n"));
        for code in [
            "int d[4];\n",
            "#define N 4\nstatic Place d[N];",
            "int a, d[4];\nint b = f(d[3]);",
            "int d[4];\nvoid f() { int d[8]; }",
        ] {
            assert_eq!(words_with_source(looped, code), known, "{code}");
        }
        for code in ["\n", "int *d = a;\nint x = f(1, d[3]);", "\nx = d[3];"] {
            assert_eq!(words_with_source(looped, code), unknown, "{code}");
        }
        let words = "the loop of line 3 uses an index outside of `d`";
        let rows = format!("a.c:4: {words}: the first one is 0, the last one is one less than the length\n");
        assert_eq!(words_with_source(looped, "\nint d[4][5];"), rows);
        let too_large = "a.c:4:10: warning: iteration 3 invokes undefined behavior [-Waggressive-loop-optimizations]\n    4 |     d[i] = i * 900000000;\n";
        assert_eq!(words_of(too_large, ""), "");
        assert_eq!(words_of(&too_large.replace("d[i]", "x"), ""), "");
        let subscript = "a.c:4:10: warning: array subscript 3 is above array bounds of 'int[3]' [-Warray-bounds]\n    4 |   e[3] = 2;\n\
                         a.c:3:7: note: while referencing 'e'\n";
        let words = "the index 3 is outside of `e`, which has 3 elements with the indices 0 to 2";
        assert_eq!(words_of(subscript, ""), format!("a.c:4: {words}\n"));
    }

    #[test]
    fn overrun_memory_is_described_without_builtin_functions() {
        let words_of = |warning: &str, code: &str, note: &str| {
            let note = if note.is_empty() { String::new() } else { format!("a.c:5:16: note: {note}\n") };
            let caret = " ".repeat(code.len() - code.trim_start().len());
            let output = format!("a.c:6:3: warning: {warning}\n    6 | {code}\n      | {caret}^~~\n{note}");
            let source = format!("\n\n\n\nint *p = NULL; Robot *r;\n{code}\n");
            in_plain_words(&output, ("a.c", &source)).trim_end().trim_start_matches("a.c:6: ").to_owned()
        };
        let cases = [
            (
                "'__builtin_memcpy' writing 6 bytes into a region of size 5 [-Wstringop-overflow=]",
                "  strcpy(name, \"robot\");",
                "destination object of size 5 allocated by 'malloc'",
                "6 bytes are written to memory that has room for 5: allocate one byte more, for the end of the text",
            ),
            (
                "'void* __builtin_memcpy(void*, const void*, long unsigned int)' writing 7 bytes into a region of size 5 [-Wstringop-overflow=]",
                "  strcpy(name, \"robots\");",
                "destination object of size 5 allocated by 'operator new []'",
                "7 bytes are written to memory that has room for 5: allocate more",
            ),
            (
                "'memset' writing 5 bytes into a region of size 4 [-Wstringop-overflow=]",
                "  memset(a, 1, 5);",
                "destination object of size 4 allocated by 'malloc'",
                "5 bytes are written to memory that has room for 4: allocate more",
            ),
            (
                "'__builtin_memcpy' writing 7 bytes into a region of size 3 [-Wstringop-overflow=]",
                "  strcat(copy, \"abcdef\");",
                "destination object of size 3 allocated by 'calloc'",
                "`strcat` appends to the text in memory, and both together are too long for its 3 bytes: allocate more",
            ),
            (
                "'__builtin_memcpy' writing 6 bytes into a region of size 0 overflows the destination [-Wstringop-overflow=]",
                "  strcpy(b, \"text that is too long\");",
                "at offset 16 into destination object 'a' of size 10",
                "the text is too long for its place in `a`, which has room for 10 bytes in all: make the array larger",
            ),
            (
                "array subscript 16 is outside array bounds of 'char[10]' [-Warray-bounds]",
                "  strcpy(b, \"text that is too long\");",
                "at offset 16 into object 'a' of size 10",
                "the text is too long for its place in `a`, which has room for 10 bytes in all: make the array larger",
            ),
            (
                "array subscript 16 is outside array bounds of 'struct robot[1]' [-Warray-bounds]",
                "  strcpy(name, d[16]);",
                "at offset 16 into object 'd' of size 10",
                "",
            ),
            (
                "'memcpy' forming offset [10, 15] is out of the bounds [0, 10] of object 'a' with type 'char[10]' [-Warray-bounds]",
                "  memcpy(a, \"0123456789012345\", 16);",
                "'a' declared here",
                "`memcpy` writes 16 bytes to `a`, which has room for 10: write fewer, or make the array larger",
            ),
            (
                "'memcpy' forming offset [10, 15] is out of the bounds [0, 10] of object 'a' with type 'char[10]' [-Warray-bounds]",
                "  memcpy(b, a, 16);",
                "'a' declared here",
                "this line reads or writes outside of `a`, which has 10 elements with the indices 0 to 9",
            ),
            (
                "'__builtin_memcpy' forming offset [10, 15] is out of the bounds [0, 10] of object 'a' with type 'char[10]' [-Warray-bounds]",
                "  strcpy(&a[6], \"long text\");",
                "'a' declared here",
                "the text is too long for its place in `a`, which has room for 10 bytes in all: make the array larger",
            ),
            (
                "'__builtin_memcpy' writing 2 bytes into a region of size 1 [-Wstringop-overflow=]",
                "  strcat(a, \"s\"); strcpy(a, greet(\"a\"));",
                "at offset 5 into destination object 'a' of size 6",
                "`strcat` appends to the text in `a`, and both together are too long for its 6 bytes: make the array larger",
            ),
            (
                "array subscript 4 is above array bounds of 'int[4]' [-Warray-bounds]",
                "  n = map[1][4];",
                "while referencing 'map'\n    5 |   int map[3][4];",
                "the index 4 is outside of a row of `map`, which has 4 elements with the indices 0 to 3",
            ),
            (
                "array subscript 3 is above array bounds of 'int[3][4]' [-Warray-bounds]",
                "  n = map[3][1];",
                "while referencing 'map'\n    5 |   int map[3][4];",
                "the index 3 is outside of `map`, which has 3 elements with the indices 0 to 2",
            ),
            (
                "'__builtin_memcpy' forming offset [12, 19] is out of the bounds [0, 12] of object 'a' with type 'int[3]' [-Warray-bounds]",
                "    b[i] = a[i];",
                "'a' declared here",
                "this line reads or writes outside of `a`, which has 3 elements with the indices 0 to 2",
            ),
            (
                "'__builtin_memcpy' forming offset [8, 11] is out of the bounds [0, 8] of object 'r' with type 'struct robot' [-Warray-bounds]",
                "  strcpy(p->name, \"Scout robot\");",
                "'r' declared here",
                "the text is too long for `p->name`",
            ),
            (
                "array subscript 3 is above array bounds of 'int[<Uf7e0>]' [-Warray-bounds]",
                "    d[i] = i;",
                "while referencing 'd.2'",
                "the index 3 is outside of `d`: the first one is 0, the last one is one less than the length",
            ),
            (
                "array subscript 'Robot[0]' is partly outside array bounds of 'unsigned char[8]' [-Warray-bounds]",
                "  r->n = 3;",
                "object of size 8 allocated by 'malloc'",
                "memory of 8 bytes is too small for `Robot`: allocate `sizeof(Robot)` bytes",
            ),
            (
                "array subscript 0 is outside array bounds of 'int[0]' [-Warray-bounds]",
                "  p[1] = 2;",
                "",
                "`p` is NULL",
            ),
            ("array subscript 0 is outside array bounds of 'int[0]' [-Warray-bounds]", "  *(int *)0x40 = 3;", "", ""),
            (
                "'__builtin_memcpy' forming offset 2 is out of the bounds [0, 2] [-Warray-bounds]",
                "  strcpy(name, \"S4\");",
                "",
                "",
            ),
            (
                "'__builtin_memcpy' forming offset [8, 16] is out of the bounds [0, 8] [-Warray-bounds]",
                "  strcpy(r->name, \"a very long name\");",
                "",
                "the text is too long for `r->name`",
            ),
            (
                "'%s' directive argument is null [-Wformat-overflow=]",
                "  LCDPrintf(\"%s\", NULL);",
                "",
                "the value for `%s` is NULL",
            ),
        ];
        for (warning, code, note, words) in cases {
            assert_eq!(words_of(warning, code, note), words, "{warning}");
        }
    }

    #[test]
    fn suggested_first_values_fit_the_declaration() {
        let words_of = |name: &str, note: &str, code: &str| {
            let output = format!(
                "a.c:7:2: warning: '{name}' is used uninitialized [-Wuninitialized]\n    7 |  f({name});\n      |  ^~~\n\
                 a.c:6:7: note: {note}\n    6 |   {code}\n      |       ^\n"
            );
            in_plain_words(&output, ("a.c", "")).trim_end().trim_start_matches("a.c:7: ").to_owned()
        };
        let declared = "give it one where it is declared";
        assert_eq!(
            words_of("n", "'n' was declared here", "int n, *n2;"),
            format!("`n` has no value yet: {declared}, such as `n = 0`")
        );
        let list = format!("`d` has no value yet: {declared}, with `= {{0}}`");
        assert_eq!(words_of("d", "'d' declared here", "int n, d[4];"), list);
        assert_eq!(words_of("d", "'d' declared here", "struct place d;"), list);
        assert_eq!(words_of("d", "'d' declared here", "char *d[4];"), list);
        let unknown = format!("`d` has no value yet: {declared}");
        for code in ["Place d;", "int d[N];", "struct place d[N];"] {
            assert_eq!(words_of("d", "'d' declared here", code), unknown, "{code}");
        }
        let member = "`p.x` has no value yet: give it one before it is used";
        assert_eq!(words_of("p.x", "'p' declared here", "Place p;"), member);
        let pointer = |code: &str| words_of("z", "'z' was declared here", code);
        assert_eq!(pointer("int* z;"), "`z` points nowhere: declare it without `*`, and write `&z` in this line");
        assert_eq!(pointer("char *z;"), "`z` points nowhere: declare an array in its place, such as `char z[20]`");
        let argument = |declaration: &str, code: &str| {
            let output = format!(
                "a.c:7:2: warning: 'z' is used uninitialized [-Wuninitialized]\n    7 |  {code}\n      |  ^~~\n\
                 a.c:6:7: note: 'z' was declared here\n    6 |   {declaration}\n      |       ^\n"
            );
            in_plain_words(&output, ("a.c", code)).trim_end().trim_start_matches("a.c:7: ").to_owned()
        };
        let array = |array: &str| format!("`z` points nowhere: declare an array in its place, such as `{array}`");
        assert_eq!(argument("BYTE *z;", "if (CAMGet(z) != 0)"), array("BYTE z[QVGA_SIZE]"));
        assert_eq!(argument("unsigned char *z;", "IPOverlay(mask(a), z, b);"), array("BYTE z[QVGA_SIZE]"));
        assert_eq!(argument("char *z;", "CAMGet(z);"), array("BYTE z[QVGA_SIZE]"));
        assert_eq!(argument("BYTE *z;", "CAMInit( VGA ); CAMGet(z);"), array("BYTE z[VGA_SIZE]"));
        assert_eq!(argument("int *z;", "LIDARSet(180, 0, 90); LIDARGet(z);"), array("int z[90]"));
        assert_eq!(argument("char *z;", "IPReadFile(z, img);"), array("char z[20]"));
        assert_eq!(argument("BYTE *z;", "IPReadFile(name, z);"), array("BYTE z[QVGA_SIZE]"));
        assert_eq!(argument("int *z;", "n = LIDARGet(z);"), array("int z[360]"));
        let single = "`z` points nowhere: declare it without `*`, and write `&z` in this line";
        assert_eq!(argument("BYTE *z;", "IPPCol2RGB(RED, z, z, z);"), single);
        assert_eq!(argument("int *z;", "CAMGet(z, &offset, &contrast);"), single, "RoBIOS 6 gives a number");
        let output = |kind: &str, code: &str| {
            let note = "a.c:6:7: note: 'z' was declared here\n    6 |   Place *z;\n      |       ^\n";
            let output = format!(
                "a.c:7:2: warning: 'z' {kind} uninitialized [-Wuninitialized]\n    7 |  {code}\n      |  ^~~\n{note}"
            );
            in_plain_words(&output, ("a.c", "")).trim_end().trim_start_matches("a.c:7: ").to_owned()
        };
        let words = "`z` points nowhere: set it to the address of a variable first, as `z = &variable;` does";
        assert_eq!(output("is used", "z->x = d[0];"), words);
        assert_eq!(
            output("may be used", "*z = 0;"),
            "`z` may point nowhere in this line: set it to NULL where it is declared, and write `if (z != NULL)` before this line"
        );
    }

    #[test]
    fn misplaced_declarations_and_cpp_keywords_are_explained() {
        let words_of = |line: &str, above: &str, file: &str| {
            let column = line.len() - line.trim_start().len();
            let word = line.trim().split(' ').next().unwrap_or_default();
            let output = format!(
                "{file}: In function 'main':\n{file}:3:{}: error: expected expression before '{word}'\n    3 | {line}\n      | {}^~~\n",
                column + 1,
                " ".repeat(column)
            );
            let source = format!("int main(void) {{\n{above}\n{line}\n");
            in_plain_words(&output, (file, &source)).trim_end().trim_start_matches(&format!("{file}:3: ")).to_owned()
        };
        let inner = "`home` cannot be written within `main`: move it out of `main`, above its first line";
        assert_eq!(words_of("    static void home(int a)", "  if (KEYRead() == 0)", "a.c"), inner);
        let declared = "`int` does not belong here: a variable is declared before the `if`, or within its `{ }`";
        assert_eq!(words_of("    int n = 3;", "  } if (KEYRead() == 0) // none", "a.c"), declared);
        assert!(words_of("    int n = 3;", "  n = ", "a.c").contains("a type is written where a name is declared"));
        let word = "`class` is a word of C++: give the variable another name";
        assert_eq!(words_of("    int class = 3;", "  n = 2;", "a.cpp"), word);
        assert!(!words_of("    int class = 3;", "  n = 2;", "a.c").contains("C++"));
    }

    #[test]
    fn continued_texts_do_not_lack_a_quote() {
        let source = "int main(void)\n{\n  LCDPrintf(\"a\\\n b\" 3);\n";
        let output = "a.c:4:4: error: expected ')' before numeric constant\n    4 |  b\" 3);\n      |    ^~\n";
        assert_eq!(in_plain_words(output, ("a.c", source)), "a.c:4: a `,` or a `)` is missing before `3`\n");
    }

    #[test]
    fn lambda_lines_are_inside_a_function() {
        let output = "a.cpp: In lambda function:\na.cpp:8:9: error: expected unqualified-id before 'new'\n    8 |     int new = x;\n";
        check(output, "a.cpp:8: `new` is a word of the language: give the variable another name\n");
    }

    #[test]
    fn columns_are_counted_in_display_width() {
        let error = "expected ')' before numeric constant";
        let output = |column: usize, code: &str| format!("a.c:3:{column}: error: {error}\n    3 | {code}\n");
        let words = "a.c:3: a `,` or a `)` is missing before `3`\n";
        check(&output(25, "  LCDPrintf(\"gr\u{F6}\u{DF}e %d\\n\" 3);"), words);
        // gcc prints a tab as blanks, and counts these.
        check(&output(31, "        LCDPrintf(\"gr\u{F6}\u{DF}e %d\\n\" 3);"), words);
        // Chinese letters are two columns wide; clang counts bytes, but its caret is below the token.
        check(&output(25, "  LCDPrintf(\"\u{4F60}\u{597D}e %d\\n\" 3);"), words);
        let caret = format!("      | {}^\n", " ".repeat(24));
        check(&(output(28, "  LCDPrintf(\"\u{4F60}\u{597D}e %d\\n\" 3);") + &caret), words);
        let semicolon = "a.c:3:12: error: expected ';' before 'return'\n    3 |   x = \"\u{F6}\u{DF}\u{E4}\"\n";
        check(semicolon, "a.c:3: a `;` is missing at the end of this line\n");
    }

    #[test]
    fn unfinished_declarations_lack_a_semicolon() {
        let output =
            "a.cpp:3:1: error: expected initializer before 'double'\n    3 | double factor = 2;\n      | ^~~~~~\n";
        let words_of = |source: &str| in_plain_words(output, ("a.cpp", source));
        let words = "a.cpp:3: a `;` is missing at the end of line 2\n";
        assert_eq!(words_of("#include \"eyebot.h\"\nint counter\ndouble factor = 2;\n"), words);
        assert_ne!(words_of("int home()\n#define N 4\ndouble factor = 2;\n"), words);
    }

    #[test]
    fn missing_braces_between_functions_are_reported() {
        let check = |output: &str, code: &str, words: &str| {
            assert_eq!(in_plain_words(output, ("a.cpp", code)), format!("{words}\n"), "{code}");
        };
        let first = "a.cpp:2:3: error: expected initializer before 'VWWait'\n    2 |   VWWait();\n";
        check(first, "int main()\n  VWWait();\n}\n", "a.cpp:2: a `{` is missing after line 1, `int main()`");
        let second = "a.cpp:2:1: error: expected initializer before 'int'\n    2 | int main()\n";
        let words = "a.cpp:2: a `;` is missing at the end of line 1, or a block between `{ }` after it";
        check(second, "void home()\nint main()\n{\n}\n", words);
        let nested = "a.cpp: In function 'int main()':\na.cpp:4:3: error: a function-definition is not allowed here before '{' token\n    4 |   {\n";
        let words = "a.cpp:4: `home` cannot be written within `main`: move it out of `main`, above its first line";
        check(nested, "int main()\n{\n  void home()\n  {\n  }\n}\n", words);
        let words = "a.cpp:2: this `{` has no `}`: write it where the block ends";
        check(nested, "int main()\n{\n  void home()\n  {\n  }\n", words);
    }

    #[test]
    fn only_fractions_that_become_zero_are_reported() {
        let output = "a.c: In function 'one':\n\
                      a.c:2:3: warning: conversion from 'double' to 'int' may change value [-Wfloat-conversion]\n    2 |   f(d);\n      |     ^\n\
                      a.c: In function 'main':\n\
                      a.c:5:3: warning: conversion from 'double' to 'int' changes value from '2.5e+0' to '2' [-Wfloat-conversion]\n    5 |   f(2.5);\n\
                      a.c:6:3: warning: conversion from 'double' to 'int' changes value from '5.0e-1' to '0' [-Wfloat-conversion]\n    6 |   f(0.5);\n\
                      a.c:7:3: warning: unused variable 'a' [-Wunused-variable]\n";
        let kept = "a.c: In function 'main':\n\
                    a.c:6:3: warning: conversion from 'double' to 'int' changes value from '5.0e-1' to '0' [-Wfloat-conversion]\n    6 |   f(0.5);\n\
                    a.c:7:3: warning: unused variable 'a' [-Wunused-variable]\n";
        assert_eq!(without_harmless_warnings(output), kept);
        assert_eq!(without_harmless_warnings(kept), kept);
        let turn = |angle: &str| {
            format!(
                "a.c:5:3: warning: conversion from 'double' to 'int' changes value from '{angle}' to '1' [-Wfloat-conversion]\n    5 |   VWTurn(a, 1);\n"
            )
        };
        for (angle, is_kept) in
            [("1.5707963267948966e+0", true), ("1.57e+0", true), ("-4.71e+0", true), ("1.5e+0", false)]
        {
            assert_eq!(without_harmless_warnings(&turn(angle)) == turn(angle), is_kept, "{angle}");
        }
        assert_eq!(without_harmless_warnings(&turn("1.57e+0").replace("VWTurn", "VWStraight")), "");
        let array = "a.c: In function 'main':\n\
                     a.c:5:36: warning: passing argument 1 of 'CAMGet' from incompatible pointer type [-Wincompatible-pointer-types]\n    5 | CAMGet(img);\n      |        ^~~\n\
                     In file included from a.c:1:\n\
                     /k/eyebot.h:330:18: note: expected 'BYTE *' {aka 'unsigned char *'} but argument is of type 'BYTE (*)[160][3]' {aka 'unsigned char (*)[160][3]'}\n  330 | int CAMGet(BYTE *buf);\n\
                     a.c:7:3: warning: unused variable 'a' [-Wunused-variable]\n";
        let kept_alone = "a.c: In function 'main':\na.c:7:3: warning: unused variable 'a' [-Wunused-variable]\n";
        assert_eq!(without_harmless_warnings(array), kept_alone);
        let of_int = array.replace("type 'BYTE (*)[160][3]' {aka 'unsigned char (*)[160][3]'}", "type 'int (*)[160]'");
        assert_eq!(without_harmless_warnings(&of_int), of_int);
        let included = "In file included from a.c:1:\nb.h: In function 'two':\n\
                        b.h:2:3: warning: conversion from 'double' to 'int' may change value [-Wfloat-conversion]\n";
        assert_eq!(without_harmless_warnings(included), "");
    }

    #[test]
    fn only_the_first_error_is_translated() {
        let output = "mine.c:2:1: warning: unused variable 'a' [-Wunused-variable]\n\
                      mine.c:4:23: error: expected ';' before 'return'\n    4 |   VWStraight(100, 100)\n\
                      mine.c:9:3: error: 'sped' undeclared (first use in this function); did you mean 'speed'?\n";
        check(output, "mine.c:4: a `;` is missing at the end of this line\n");
        let bracket = "mine.c:4:22: error: expected ')' before '{' token\n    4 |   if (PSDGet(1) < 200 {\n";
        check(bracket, "mine.c:4: a `)` is missing before `{`\n");
        let above = "mine.cpp:6:5: error: expected ',' or ';' before 'if'\n    6 |     if (d < 100) break;\n";
        check(above, "mine.cpp:6: a `;` is missing at the end of the line before this one\n");
        check("mine.c:3:2: error: something new\nmine.c:4:2: error: lvalue required as left operand\n", "");
        let unknown = "mine.cpp:4:3: error: 'VWStraigt' was not declared in this scope; did you mean 'VWStraight'?\n";
        check(unknown, "mine.cpp:4: `VWStraigt` is not defined; did you mean `VWStraight`?\n");
    }

    #[test]
    fn common_errors_are_translated() {
        let errors = [
            (
                "4:17",
                "expected ')' before numeric constant",
                "  VWStraight(100 100);",
                "a `,` or a `)` is missing before `100`",
            ),
            (
                "4:9",
                "expected '(' before 'PSDGet'",
                "  while PSDGet(1) {",
                "a `(` is missing before `PSDGet`: a condition is written between `( )`",
            ),
            (
                "4:9",
                "expected '=', ',', ';', 'asm' or '__attribute__' before 'y'",
                "  int x y;",
                "a `,` or a `;` is missing before `y`, or `x y` is one name: write `x_y`",
            ),
            ("4:1", "expected '=', ',', ';', 'asm' or '__attribute__' before '{' token", "{", BRACE_WITHOUT_FUNCTION),
            (
                "4:1",
                "expected identifier or '(' before '{' token",
                "{",
                "no function starts at this `{`: is there an extra `;` at the end of the line above it?",
            ),
            (
                "4:18",
                "expected expression before '>' token",
                "  if (KEYRead() => 3) {",
                "`=>` is not a comparison: write `>=`",
            ),
            (
                "4:9",
                "expected expression before ')' token",
                "  VWWait(,);",
                "a value is missing before `)`, or there is something too many",
            ),
            (
                "4:3",
                "unknown type name 'Int'; did you mean 'int'?",
                "  Int n;",
                "`Int` is not defined; did you mean `int`?",
            ),
            (
                "4:3",
                "unknown type name 'boolean'; did you mean 'bool'?",
                "  boolean n;",
                "`boolean` is not a type; did you mean `bool`?",
            ),
            ("4:4", "'place' has no member named 'y'", "  p.y = 3;", "`place` has no `y`: check the spelling"),
            ("4:7", "assignment to expression with array type", "  name = \"S4\";", ARRAY_ASSIGNED),
            (
                "4:16",
                "subscripted value is neither array nor pointer nor vector",
                "  return PSDGet[1];",
                FUNCTION_INDEXED,
            ),
            (
                "4:3",
                "'elseif' was not declared in this scope",
                "  elseif (n) {",
                "`elseif` is not defined: write `else if`",
            ),
            ("4:9", "stray '#' in program", "  n = 3; #", "the letter `#` does not belong here"),
            (
                "4:13",
                "invalid conversion from 'const char*' to 'int' [-fpermissive]",
                "  int n = \"3\";",
                "a text stands where a number (`int`) belongs: write a number, without quotes",
            ),
            (
                "4:11",
                "expression cannot be used as a function",
                "  return 2(a + b);",
                "this is a value, not a function: `*` multiplies, as in `2 * (a + b)`",
            ),
            ("4:7", "array type has incomplete element type 'int[]'", "  int m[][] = {{1}};", ROW_LENGTH),
        ];
        for (place, error, code, words) in errors {
            let column: usize = place.trim_start_matches("4:").parse().expect("a column");
            let caret = " ".repeat(column - 1);
            let output = format!("mine.c:{place}: error: {error}\n    4 | {code}\n      | {caret}^\n");
            check(&output, &format!("mine.c:4: {words}\n"));
        }
        let twice = "mine.cpp:3:5: error: redefinition of 'int home()'\n    3 | int home() { return 2; }\n      |     ^~~~\n\
                     mine.cpp:2:5: note: 'int home()' previously defined here\n";
        check(twice, "mine.cpp:3: `home` is already defined in line 2: delete one of them, or give it another name\n");
    }

    #[test]
    fn functions_of_the_cpp_library_name_their_header() {
        let qualified =
            "a.cpp:3:8: error: 'sort' is not a member of 'std'; did you mean 'sqrt'?\n    3 |   std::sort(v, v + 2);\n";
        assert_eq!(missing_cpp_headers(qualified), ["algorithm"]);
        check(
            qualified,
            "a.cpp:3: `sort` belongs to the C++ library: write `#include <algorithm>` at the top, and `std::sort`\n",
        );
        let plain =
            "a.cpp:3:3: error: 'accumulate' was not declared in this scope\n    3 |   accumulate(v, v + 2, 0);\n";
        assert_eq!(missing_cpp_headers(&format!("{plain}{qualified}{plain}")), ["numeric", "algorithm"]);
        assert!(!in_plain_words(plain, ("a.cpp", "")).contains("numeric"));
        assert!(in_plain_words(plain, ("a.cpp", "using namespace std;")).contains("#include <numeric>"));
        let own = "using namespace std;\nvoid f() { rotate(9); count = 1; }\nvoid rotate(int n) {}\n";
        for (name, code) in [("rotate", "rotate(9);"), ("count", "count = 1;")] {
            let output = format!("a.cpp:2:12: error: '{name}' was not declared in this scope\n    2 | {code}\n");
            let words = in_plain_words(&output, ("a.cpp", own));
            assert!(words.contains(name) && !words.contains("C++ library"), "{words}");
        }
        assert!(missing_cpp_headers("a.cpp:3:3: error: 'home' was not declared in this scope").is_empty());
    }

    #[test]
    fn lists_and_indices_are_explained() {
        let syntax = |file: &str, error: &str, code: &str| {
            in_plain_words(&format!("{file}:4:6: error: {error}\n    4 | {code}\n"), ("", ""))
        };
        let list = "a list of values is written between `{ }`: `int A[2] = {1, 2};`\n";
        let bracket = "expected identifier or '(' before '[' token";
        assert_eq!(syntax("a.c", bracket, "  int[2] A = [1, 2];"), format!("a.c:4: {list}"));
        let number = "expected identifier before numeric constant";
        assert_eq!(syntax("a.cpp", number, "  int A[2] = [1, 2];"), format!("a.cpp:4: {list}"));
        assert!(
            syntax("a.c", "expected expression before '[' token", "  int A = [1, 2];").contains("`int A[] = {1, 2};`")
        );
        let linkage = syntax("a.c", "expected identifier or '(' before string constant", "extern \"C\" {");
        assert!(linkage.starts_with("a.c:4: `extern \"C\"` belongs to C++"), "{linkage}");
        let indexed = "a.c:4:13: error: subscripted value is neither array nor pointer nor vector\n    4 |   return img[3];\n      |             ^\n";
        assert_eq!(
            in_plain_words(indexed, ("a.c", "int main()\n{\n  BYTE img, old;\n  return img[3];\n}\n")),
            "a.c:4: `img` is a single value, of line 3, and `[ ]` belongs to an array: declare one, such as `BYTE img[QVGA_SIZE];` (the size of a colour image)\n"
        );
        let cpp = "a.cpp:2:10: error: invalid types 'int[int]' for array subscript\n    2 |   return d[3];\n      |           ^\n";
        assert!(
            in_plain_words(cpp, ("a.cpp", "int f(int d) {\n  return d[3];\n}\n"))
                .contains("`d` is a single value, of line 1")
        );
    }

    #[test]
    fn name_with_a_blank_is_not_taken_for_a_type() {
        let words = |name: &str, code: &str, column: usize| {
            let output =
                format!("a.c:4:{column}: error: '{name}' undeclared (first use in this function)\n    4 | {code}\n");
            in_plain_words(&output, ("", ""))
        };
        let joined_name =
            "a.c:4: `my` is not defined; if `my speed` is one name, write it as one word, such as `my_speed`\n";
        assert_eq!(words("my", "  VWSetSpeed(my speed, 0);", 14), joined_name);
        assert!(words("drive", "  drive home();", 3).contains("`drive_home`"));
        for (name, code, column) in
            [("Place", "  Place p;", 3), ("place", "  place p;", 3), ("Place", "for (Place p = 0;", 6)]
        {
            assert!(!words(name, code, column).contains("one name"), "{code}");
        }
    }

    #[test]
    fn empty_loops_are_recognised() {
        assert!(is_empty_clause("  while (d > f(2)) ; // wait"));
        assert!(is_empty_clause("for (;;);"));
        for code in ["} while (d > 2);", "while (d > 2) f();", "while (d > 2) {", "whilst(2);", "f(2);"] {
            assert!(!is_empty_clause(code), "{code}");
        }
    }

    #[test]
    fn format_warnings_remain_only_for_joined_texts() {
        let output = |code: &str| {
            format!(
                "a.cpp:4:3: warning: format not a string literal and no format arguments [-Wformat-security]\n    4 |   {code}\n"
            )
        };
        for code in ["LCDPrintf(name);", "LCDPrintf((\"a\" + name).c_str());"] {
            assert_eq!(without_harmless_warnings(&output(code)), "", "{code}");
        }
        assert_eq!(without_harmless_warnings(&output("LCDPrintf(\"a\" + d);")), output("LCDPrintf(\"a\" + d);"));
    }

    #[test]
    fn quotes_are_counted_by_the_rules_of_c() {
        assert!(missing_quote("  LCDPrintf(hello\\n\");").is_some_and(|words| words.contains("opening")));
        assert!(missing_quote("  LCDPrintf(\"hello\\n);").is_some_and(|words| words.contains("end")));
        for line in ["f(\"http://a\")", "f(\"a\\\\\")", "f('\"')", "f(\"say \\\"a\")", "x; // say \"a"] {
            assert_eq!(missing_quote(line), None, "{line}");
        }
    }

    #[test]
    fn misspelt_keywords_are_reported() {
        let start = "mine.c:2:17: error: expected ';' before '{' token\n    2 |   whlie (i < 5) {\n";
        check(start, "mine.c:2: `whlie` is not defined; did you mean `while`?\n");
        let name = "mine.c:2:3: error: 'retrun' undeclared (first use in this function)\n    2 |   retrun 0;\n";
        check(name, "mine.c:2: `retrun` is not defined; did you mean `return`?\n");
        let other = "mine.c:2:3: error: 'sped' undeclared (first use in this function)\n    2 |   sped = 0;\n";
        let declare =
            "`sped` is not defined: declare it before this line, such as `int sped = 0;`, or check the spelling";
        check(other, &format!("mine.c:2: {declare}\n"));
    }

    #[test]
    fn wrong_calls_show_the_declaration() {
        let few = "mine.c:2:17: error: too few arguments to function 'VWStraight'\n    2 |   VWStraight(100);\n\
                   In file included from mine.c:1:\n/k/eyebot.h:726:5: note: declared here\n  726 | int VWStraight(int dist, int lin_speed);\n";
        check(few, "mine.c:2: `VWStraight` is called with too few values: `int VWStraight(int dist, int lin_speed)`\n");
        let integer = "p.c:2:50: warning: passing argument 1 of 'VWGetPosition' makes pointer from integer without a cast [-Wint-conversion]\n\
                       /k/eyebot.h:720:24: note: expected 'int *' but argument is of type 'int'\n";
        check(
            integer,
            "p.c:2: the function writes to the address of a variable: write `&` before its name (`int *`)\n",
        );
        let other = "p.c:2:50: warning: passing argument 1 of 'VWGetPosition' from incompatible pointer type\n\
                     /k/eyebot.h:720:24: note: expected 'int *' but argument is of type 'double *'\n";
        check(other, "p.c:2: the function takes `int *`, and is given `double *`\n");
        check(
            "p.cpp:2:46: error: invalid conversion from 'int' to 'int*' [-fpermissive]\n",
            "p.cpp:2: the function writes to the address of a variable: write `&` before its name (`int*`)\n",
        );
    }

    #[test]
    fn messages_about_headers_are_not_translated() {
        check("/usr/include/stdio.h:3:2: warning: division by zero\ncollect2: error: ld returned 1 exit status\n", "");
        check("", "");
    }
}
