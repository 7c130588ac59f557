//! Messages of C and C++ compilers in plain words: what is wrong and what to write, one line each, for people who do not know the
//! compiler's own words yet. Those follow after them.

/// Most lines that are put before the compiler's own words.
const MAX_LINES: usize = 5;

/// A message of the compiler about a line of the program (gcc and clang, `LC_ALL=C`).
struct Message<'a> {
    file: &'a str,
    line: &'a str,
    column: usize,
    is_error: bool,
    text: &'a str,
    /// Lines from this message to the next: excerpts and notes.
    more: &'a [&'a str],
}

/// The known messages among the compiler's `output`, in plain words: one line each, that of the first error if there is an error.
pub fn in_plain_words(output: &str) -> String {
    let lines: Vec<&str> = output.lines().collect();
    let heads: Vec<usize> = (0..lines.len()).filter(|&index| parse(&lines, index, lines.len()).is_some()).collect();
    let ends = heads.iter().skip(1).copied().chain([lines.len()]);
    let messages: Vec<Message<'_>> =
        heads.iter().zip(ends).filter_map(|(&head, end)| parse(&lines, head, end)).collect();
    let first_error = messages.iter().find(|message| message.is_error);
    let mut told: Vec<String> = Vec::new();
    // An error is often the cause of all that follows.
    let chosen = messages.iter().filter(|message| first_error.is_none_or(|error| std::ptr::eq(error, *message)));
    for line in chosen.filter_map(Message::in_plain_words) {
        if told.len() < MAX_LINES && !told.contains(&line) {
            told.push(line);
        }
    }
    told.concat()
}

/// The message that begins at line `index`, with the lines up to `end`; `None` if none about the program begins there.
fn parse<'a>(lines: &'a [&'a str], index: usize, end: usize) -> Option<Message<'a>> {
    let mut parts = lines[index].splitn(4, ':');
    let (file, line, column, rest) = (parts.next()?, parts.next()?, parts.next()?, parts.next()?.trim_start());
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    let errors = ["error: ", "fatal error: "].iter().find_map(|kind| rest.strip_prefix(kind));
    let text = errors.or_else(|| rest.strip_prefix("warning: "))?;
    // Headers of the system and of the kit have absolute paths.
    let is_own = is_number(line) && is_number(column) && !file.starts_with('/') && !file.starts_with(' ');
    is_own.then(|| Message {
        file,
        line,
        column: column.parse().unwrap_or(0),
        is_error: errors.is_some(),
        text,
        more: &lines[index + 1..end],
    })
}

impl Message<'_> {
    fn in_plain_words(&self) -> Option<String> {
        let words = self.words()?;
        Some(format!("{}:{}: {words}\n", self.file, self.line))
    }

    /// The `number`th text between quotes, from 0.
    fn quoted(&self, number: usize) -> Option<&str> {
        quoted(self.text, number)
    }

    fn words(&self) -> Option<String> {
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
            ("", "missing terminating \"", "the text has no end: write `\"` behind it"),
            ("", "missing terminating '", "write a single letter between `'`, and a text between `\"`"),
            ("", "character constant too long", "write a single letter between `'`, and a text between `\"`"),
            ("", "multi-character character constant", "write a single letter between `'`, and a text between `\"`"),
            ("", "at end of input", "the program ends too early: a `}` is missing above"),
            ("", "expected '}'", "the program ends too early: a `}` is missing above"),
            ("", "lvalue required", "the left side of `=` must be a variable"),
            ("", "expression is not assignable", "the left side of `=` must be a variable"),
            (
                "",
                "'else' without a previous 'if'",
                "the `else` has no `if`: look for a `;` behind the `if (...)`, or a missing `{ }`",
            ),
            ("", "unterminated comment", "a comment begins and has no end: write `*/`"),
            (
                "",
                "suggest braces around empty body",
                "the `;` ends the `if` here, so that it does nothing: leave the `;` out",
            ),
        ];
        if let Some((.., words)) = fixed.iter().find(|(first, second, _)| has(first) && has(second)) {
            return Some((*words).to_owned());
        }
        match self.text {
            text if text.contains("-overflow")
                || text.contains("-Warray-bounds")
                || text.contains("-Wfortify-source") =>
            {
                Some(overflow(text))
            }
            text if text.contains("invokes undefined behavior") => {
                let round = text.split_whitespace().nth(1)?.parse::<u64>().ok()?.checked_add(1)?;
                Some(format!(
                    "round {round} of the loop goes beyond the end of an array, whose last index is one less than its length, or a number \
                     becomes too large for its type"
                ))
            }
            text if text.starts_with("this '") && text.contains("does not guard") => {
                let word = self.quoted(0)?;
                Some(format!(
                    "the `{word}` covers one statement alone, or only its `;`: write `{{ }}` around what belongs to it"
                ))
            }
            text if text.contains("used after 'free'") || text.contains("-Wuse-after-free") => {
                let name = self.quoted(0)?;
                Some(format!("`{name}` is used, or given to `free` again, after `free({name})`"))
            }
            text if text.contains("uninitialized") => {
                let name = self.quoted(0)?;
                Some(format!("`{name}` has no value yet: give it one where it is declared, such as `{name} = 0`"))
            }
            text if text.starts_with("format '") || text.starts_with("format specifies") => self.format(),
            text if text.contains("expected ';'") || text.contains("expected ',' or ';'") => {
                Some(self.misspelt_start().unwrap_or_else(|| self.missing(";")))
            }
            text if text.starts_with("expected '=', ',', ';'") => {
                Some("a `;` is missing; a `for` has two, as in `for (int i = 0; i < 4; i++)`".to_owned())
            }
            text if text.starts_with("expected ':' or") => Some(self.missing(":")),
            text if text.starts_with("expected identifier or '('") || text.starts_with("expected declaration before '}'") => {
                Some("this line is outside of every function: there is a `}` too many above, or a `{` is missing".to_owned())
            }
            text if text.contains("statement with no effect") || text.contains("expression result unused") => {
                Some("this line does nothing: a function is called with `()`, as in `VWWait()`, and a variable is set by `=`".to_owned())
            }
            text if text.contains("unknown type name 'string'") => {
                Some("C has no type `string`: a text is a `const char *`".to_owned())
            }
            text if text.contains("implicit declaration of function") => {
                let name = self.quoted(0)?;
                Some(format!("`{name}` is not known up to this line: look how it is spelt, or write the function, or its first line with `;`, further up"))
            }
            text if text.contains("to binary 'operator+'") && text.contains("char") => {
                Some("`+` does not join texts in quotes: make the first one a `std::string(\"...\")`".to_owned())
            }
            text if text.contains("is not a member of 'std'") => self.undeclared(),
            text if text.starts_with("expected ')'") => Some(self.missing(")")),
            text if text.contains("undeclared") || text.contains("not declared in this scope") => self.undeclared(),
            text if text.contains("few arguments to function") || text.contains("many arguments to function") => {
                let name = self.quoted(0)?;
                let name = name.split('(').next()?.rsplit(' ').next()?;
                let extent = if text.contains("few") { "few" } else { "many" };
                Some(format!("`{name}` is called with too {extent} values{}", self.declared(name)))
            }
            text if ["passing argument ", "invalid conversion from", "cannot convert '"]
                .iter()
                .any(|it| text.starts_with(it)) =>
            {
                self.argument()
            }
            text if text.starts_with("expected ") => self.misspelt_start(),
            _ => None,
        }
    }

    /// A line that begins with nearly a word of C: `whlie (x)`.
    fn misspelt_start(&self) -> Option<String> {
        let code = self.more.first()?.split_once(" | ")?.1.trim_start();
        misspelt(code.split(|c: char| !c.is_alphanumeric() && c != '_').next()?)
    }

    /// A missing `mark`: the compiler points behind the last word before it.
    fn missing(&self, mark: &str) -> String {
        let code = self.more.first().and_then(|excerpt| excerpt.split_once(" | ")).map(|(_, code)| code.trim_end());
        let before = self.text.split_once("before '").and_then(|(_, rest)| rest.split('\'').next());
        let is_first =
            |code: &str| code.get(..self.column.saturating_sub(1)).is_some_and(|left| left.trim().is_empty());
        match (before, code) {
            (_, Some(code)) if is_first(code) => {
                format!("a `{mark}` is missing at the end of the line before this one")
            }
            (Some(before), Some(code)) if self.column <= code.len() => {
                format!("a `{mark}` is missing before `{before}`")
            }
            _ => format!("a `{mark}` is missing at the end of this line"),
        }
    }

    /// `%d` for a value of another type.
    fn format(&self) -> Option<String> {
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

    /// A name that is not known.
    fn undeclared(&self) -> Option<String> {
        let name = self.quoted(0)?;
        let header = self.more.iter().find_map(|line| line.split_once("defined in header '")?.1.split('\'').next());
        if let Some(header) = header {
            if header.ends_with(".h>") {
                return Some(format!("`{name}` is not defined: write `#include {header}` as the first line"));
            }
            return Some(format!(
                "`{name}` is of the C++ library: write `#include {header}` as the first line, and `std::{name}`"
            ));
        }
        let near = self.text.split_once("did you mean '").and_then(|(_, rest)| rest.split('\'').next());
        Some(match near {
            Some(near) => format!("`{name}` is not defined; did you mean `{near}`?"),
            None if near_keyword(name).is_some() => misspelt(name)?,
            None => format!(
                "`{name}` is not defined: declare it before this line, such as `int {name} = 0;`, or look how it is spelt"
            ),
        })
    }

    /// The declaration of `function` among the compiler's notes: ``: `int VWStraight(int dist, int lin_speed)```.
    fn declared(&self, function: &str) -> String {
        let begins = format!(" {function}(");
        let of_excerpt = |line: &&str| line.split_once(" | ").map(|(_, code)| code.trim().to_owned());
        // The first excerpt is that of the call.
        let is_call = |code: &str| self.more.first().is_some_and(|call| call.contains(code));
        let is_declaration = |code: &String| code.ends_with(");") && code.contains(&begins) && !is_call(code);
        let declared = self.more.iter().filter_map(of_excerpt).find(is_declaration);
        declared.map_or_else(String::new, |code| format!(": `{}`", code.trim_end_matches(';')))
    }

    /// A value of a wrong type for a function.
    fn argument(&self) -> Option<String> {
        let note = self.more.iter().find(|line| line.contains("note: expected '"));
        let (expected, given) = match note {
            Some(note) => (quoted(note, 0)?, quoted(note.split_once("of type ")?.1, 0)?),
            None if self.text.starts_with("passing") => return None,
            // g++ tells the types at once.
            None => (self.quoted(1)?, self.quoted(0)?),
        };
        let (expected, given) = (expected.trim(), given.trim());
        let pointee = expected.strip_suffix('*').map(str::trim);
        Some(match pointee {
            Some(pointee) if pointee == given => {
                format!("the function writes to the address of a variable: write `&` before its name (`{expected}`)")
            }
            _ => format!("the function takes `{expected}`, and is given `{given}`"),
        })
    }
}

/// Words with which statements begin, and `printf`.
const KEYWORDS: [&str; 18] = [
    "while", "for", "return", "if", "else", "switch", "case", "break", "continue", "double", "float", "int", "char",
    "void", "unsigned", "static", "struct", "printf",
];

/// The keyword that `word` nearly is: one letter differs or is in its neighbour's place, in long words two.
fn near_keyword(word: &str) -> Option<&'static str> {
    let most = |keyword: &str| if keyword.len() > 5 { 2 } else { 1 };
    let is_near = |keyword: &&&str| strsim::osa_distance(&word.to_lowercase(), keyword) <= most(keyword);
    KEYWORDS.iter().find(is_near).copied().filter(|keyword| *keyword != word && word.len() > 2)
}

fn misspelt(word: &str) -> Option<String> {
    near_keyword(word).map(|keyword| format!("`{word}` is not defined; did you mean `{keyword}`?"))
}

const RECURSION: &str = "the function calls itself for ever: it needs an `if` that ends with `return` before that";

/// A text or an index beyond its array; `text` tells sizes in bytes.
fn overflow(text: &str) -> String {
    let number_behind = |words: &str| {
        let (_, rest) = text.split_once(words)?;
        rest.split(|c: char| !c.is_ascii_digit()).next().filter(|digits| !digits.is_empty())
    };
    let room = ["region of size ", "destination of size ", "has size "].iter().find_map(|words| number_behind(words));
    if let Some((_, rest)) = text.split_once("array subscript ") {
        let index = rest.split(' ').next().unwrap_or_default();
        // `int[3]`; of memory without a type `void[12]`, which counts bytes.
        let size = quoted(rest, 0).and_then(|kind| kind.split_once('[')).filter(|(base, _)| !base.starts_with("void"));
        let len: Option<u64> = size.and_then(|(_, size)| size.split(']').next()?.parse().ok());
        return match len.and_then(|len| Some((len, len.checked_sub(1)?))) {
            Some((len, last)) => {
                format!("the index {index} is outside of its array: an array of {len} has the indices 0 to {last}")
            }
            None => format!("the index {index} is outside of its array: the last index is one less than the length"),
        };
    }
    match (number_behind("writing "), room) {
        (Some(count), Some(room)) if !text.contains("directive") => {
            format!("{count} bytes are written to an array that has room for {room}: make the array larger")
        }
        (_, Some(room)) => {
            format!("the text is too long for its array, which has room for {room} bytes: make the array larger")
        }
        _ => "more is written to an array than it has room for: make the array larger".to_owned(),
    }
}

/// The `number`th text between quotes, from 0.
fn quoted(text: &str, number: usize) -> Option<&str> {
    text.split('\'').skip(1).step_by(2).nth(number).filter(|text| !text.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(output: &str, expected: &str) {
        assert_eq!(in_plain_words(output), expected, "{output}");
    }

    #[test]
    fn warnings_of_gcc_are_told_in_plain_words() {
        let warnings = [
            (
                "suggest parentheses around assignment used as truth value [-Wparentheses]",
                "`=` assigns a value; write `==` to compare",
            ),
            (
                "'__builtin_memcpy' writing 24 bytes into a region of size 4 [-Wstringop-overflow=]",
                "24 bytes are written to an array that has room for 4: make the array larger",
            ),
            (
                "'distance ' directive writing 9 bytes into a region of size 4 [-Wformat-overflow=]",
                "the text is too long for its array, which has room for 4 bytes: make the array larger",
            ),
            (
                "array subscript 3 is above array bounds of 'int[3]' [-Warray-bounds]",
                "the index 3 is outside of its array: an array of 3 has the indices 0 to 2",
            ),
            (
                "iteration 4 invokes undefined behavior [-Waggressive-loop-optimizations]",
                "round 5 of the loop goes beyond the end of an array, whose last index is one less than its length, or a number becomes too \
                 large for its type",
            ),
            (
                "pointer 'map' used after 'free' [-Wuse-after-free]",
                "`map` is used, or given to `free` again, after `free(map)`",
            ),
            (
                "'speed' is used uninitialized [-Wuninitialized]",
                "`speed` has no value yet: give it one where it is declared, such as `speed = 0`",
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
                "the `if` covers one statement alone, or only its `;`: write `{ }` around what belongs to it",
            ),
            ("infinite recursion detected [-Winfinite-recursion]", RECURSION),
        ];
        for (warning, words) in warnings {
            check(
                &format!("mine.c: In function 'main':\nmine.c:7:3: warning: {warning}\n"),
                &format!("mine.c:7: {words}\n"),
            );
        }
    }

    #[test]
    fn the_first_error_alone_is_told() {
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
    fn words_of_c_that_are_misspelt_are_told() {
        let start = "mine.c:2:17: error: expected ';' before '{' token\n    2 |   whlie (i < 5) {\n";
        check(start, "mine.c:2: `whlie` is not defined; did you mean `while`?\n");
        let name = "mine.c:2:3: error: 'retrun' undeclared (first use in this function)\n    2 |   retrun 0;\n";
        check(name, "mine.c:2: `retrun` is not defined; did you mean `return`?\n");
        let other = "mine.c:2:3: error: 'sped' undeclared (first use in this function)\n    2 |   sped = 0;\n";
        let declare =
            "`sped` is not defined: declare it before this line, such as `int sped = 0;`, or look how it is spelt";
        check(other, &format!("mine.c:2: {declare}\n"));
    }

    #[test]
    fn calls_that_do_not_fit_show_the_declaration() {
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
    fn messages_about_headers_and_other_text_are_left_alone() {
        check("/usr/include/stdio.h:3:2: warning: division by zero\ncollect2: error: ld returned 1 exit status\n", "");
        check("", "");
    }
}
