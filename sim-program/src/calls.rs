//! Scans a C or C++ source for the functions and constants that it uses. The result determines the headers with which
//! the source is compiled.

use std::collections::{BTreeMap, BTreeSet};

use super::code::code_only;

/// Names found in a source.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Calls {
    /// Names before `(` that are neither declared there nor methods, with the lines of their first calls, from 1.
    pub called: BTreeMap<String, usize>,
    /// Names of functions that the source defines outside of classes and namespaces.
    pub defined: BTreeSet<String>,
    /// Names of functions that the source declares without defining them.
    pub declared: BTreeSet<String>,
    /// Other names that the source uses and does not define, such as constants.
    pub used: BTreeSet<String>,
    /// Other names that the source defines: macros, enumerators, variables and types.
    pub other_definitions: BTreeSet<String>,
    /// Files that the source includes with `"..."`.
    pub includes: Vec<String>,
    /// The source contains `#include_next`: it is a header that wraps another header.
    pub is_wrapper: bool,
}

/// A class, or a method that is defined outside of it: calls without an object may be calls of the class's methods.
#[derive(Default)]
struct Class<'a> {
    name: &'a str,
    /// Number of blocks around it.
    depth: usize,
    methods: BTreeSet<&'a str>,
    /// Names before `(`, with their lines.
    called: Vec<(&'a str, usize)>,
}

/// Scans `text`. Comments and literals are skipped. Macros are not expanded, but calls in their definitions are
/// included.
pub fn calls_of(text: &str) -> Calls {
    let includes = text.lines().filter_map(included_file).map(str::to_owned).collect();
    let code = code_only(text);
    let (tokens, lines) = tokens_of(&code);
    let mut calls = Calls { includes, ..Calls::default() };
    let mut depth = 0_usize;
    let mut is_enum = false;
    // The first entry collects the names outside of classes.
    let mut classes = vec![Class::default()];
    let mut methods: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    for (index, token) in tokens.iter().enumerate() {
        let back = |count: usize| index.checked_sub(count).map(|position| tokens[position]);
        let previous = back(1);
        match *token {
            // The block of `extern "C"` does not nest: its names are at the outermost level (the literal "C" is
            // skipped).
            Token::Mark('{') if previous == Some(Token::Name("extern")) => {}
            Token::Mark('{') => depth += 1,
            Token::Mark('}') => {
                depth = depth.saturating_sub(1);
                is_enum = false;
                if let Some(class) = classes.pop_if(|class| !class.name.is_empty() && class.depth == depth) {
                    let outer = class.called.iter().filter(|(name, _)| !class.methods.contains(name)).copied();
                    classes.last_mut().expect("the program").called.extend(outer);
                    methods.entry(class.name).or_default().extend(class.methods);
                }
            }
            Token::Name("enum") => is_enum = true,
            Token::Name("include_next") => calls.is_wrapper = true,
            Token::Name(name)
                if matches!(previous, Some(Token::Name("class" | "struct"))) && begins_class(&tokens[index + 1..]) =>
            {
                classes.push(Class { name, depth, ..Class::default() });
            }
            Token::Name(name) if tokens.get(index + 1) == Some(&Token::Mark('(')) => {
                let class = classes.last_mut().expect("the program");
                let is_in_class = !class.name.is_empty() && depth == class.depth + 1;
                let after_call = after_parentheses(&tokens[index + 1..]);
                let is_scoped =
                    [previous, back(2)] == [Some(Token::Mark(':')); 2] && matches!(back(3), Some(Token::Name(_)));
                // Functions inside classes do not define the unqualified name.
                let is_definition = depth == 0 && after_call == Some(Token::Mark('{'));
                // If the previous token is on another line, its `;` may be missing. In a macro definition, the value
                // follows the name.
                let is_typed = (depth == 0 || is_in_class) && previous == Some(Token::Mark('*'))
                    || is_type(previous) && lines[index - 1] == lines[index] && back(2) != Some(Token::Name("define"));
                if depth == 0 && is_typed && after_call == Some(Token::Mark(';')) {
                    calls.declared.insert(name.to_owned());
                }
                if previous == Some(Token::Name("define")) {
                    calls.other_definitions.insert(name.to_owned());
                } else if is_in_class && is_typed {
                    class.methods.insert(name);
                } else if is_definition && is_scoped {
                    if let Some(Token::Name(class)) = back(3) {
                        let methods = methods.get(class).cloned().unwrap_or_default();
                        classes.push(Class { name: class, depth, methods, ..Class::default() });
                    }
                } else if is_definition {
                    calls.defined.insert(name.to_owned());
                } else if !is_typed && !is_scoped && !is_of_object(previous, back(2)) {
                    class.called.push((name, lines[index]));
                }
            }
            Token::Name(name) => {
                let is_enumerator = is_enum && matches!(previous, Some(Token::Mark('{' | ',')));
                let is_value = index.checked_sub(2).is_some_and(|position| tokens[position] == Token::Name("define"));
                let is_definition =
                    is_enumerator || previous == Some(Token::Name("define")) || is_type(previous) && !is_value;
                let names = if is_definition { &mut calls.other_definitions } else { &mut calls.used };
                names.insert(name.to_owned());
            }
            Token::Mark(_) => {}
        }
    }
    for (name, line) in classes.into_iter().flat_map(|class| class.called) {
        let first = calls.called.entry(name.to_owned()).or_insert(line);
        *first = line.min(*first);
    }
    calls.used.retain(|name| !calls.other_definitions.contains(name));
    calls
}

/// Returns true if a name after these two tokens is a method of an object: `robot.` or `robot->`.
fn is_of_object(previous: Option<Token<'_>>, second_previous: Option<Token<'_>>) -> bool {
    previous == Some(Token::Mark('.'))
        || [second_previous, previous] == [Some(Token::Mark('-')), Some(Token::Mark('>'))]
}

/// Returns true if `tokens`, which follow the name of a class, begin its block.
fn begins_class(tokens: &[Token<'_>]) -> bool {
    let first_mark = tokens.iter().find(|token| !matches!(token, Token::Name(_) | Token::Mark(':' | ',')));
    first_mark == Some(&Token::Mark('{'))
}

/// Returns true if the token may be a type, so that a name after it is a declaration.
fn is_type(token: Option<Token<'_>>) -> bool {
    const NO_TYPES: [&str; 18] = [
        "and", "case", "defined", "do", "elif", "else", "endif", "goto", "if", "ifdef", "ifndef", "new", "not", "or",
        "return", "sizeof", "throw", "undef",
    ];
    matches!(token, Some(Token::Name(name)) if !NO_TYPES.contains(&name))
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Token<'a> {
    Name(&'a str),
    Mark(char),
}

/// The file of a line `#include "file"`.
pub fn included_file(line: &str) -> Option<&str> {
    let rest = line.trim_start().strip_prefix('#')?.trim_start().strip_prefix("include")?.trim_start();
    rest.strip_prefix('"')?.split_once('"').map(|(name, _)| name)
}

/// The token after the parentheses with which `tokens` begin.
fn after_parentheses<'a>(tokens: &[Token<'a>]) -> Option<Token<'a>> {
    let mut depth = 0_usize;
    for (index, token) in tokens.iter().enumerate() {
        match token {
            Token::Mark('(') => depth += 1,
            Token::Mark(')') if depth == 1 => return tokens.get(index + 1).copied(),
            Token::Mark(')') => depth -= 1,
            Token::Mark(';' | '{') => return None,
            _ => {}
        }
    }
    None
}

/// Names and punctuation of `code`, without numbers and blanks, and their lines, from 1.
fn tokens_of(code: &str) -> (Vec<Token<'_>>, Vec<usize>) {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let (mut tokens, mut lines) = (Vec::new(), Vec::new());
    let (mut rest, mut line) = (code, 1);
    while let Some(first) = rest.chars().next() {
        let end = if is_name(first) { rest.find(|c| !is_name(c)).unwrap_or(rest.len()) } else { first.len_utf8() };
        match first {
            _ if is_name(first) && !first.is_numeric() => tokens.push(Token::Name(&rest[..end])),
            _ if is_name(first) || first.is_whitespace() => {}
            _ => tokens.push(Token::Mark(first)),
        }
        lines.resize(tokens.len(), line);
        line += usize::from(first == '\n');
        rest = &rest[end..];
    }
    (tokens, lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn called(text: &str) -> Vec<String> {
        calls_of(text).called.into_keys().collect()
    }

    #[test]
    fn calls_are_names_before_parentheses() {
        assert_eq!(called("a(1); b (2) + c\n(3); d; e[f(4)];"), ["a", "b", "c", "f"]);
        assert_eq!(called("#define GO(x) move(x)"), ["move"]);
        assert_eq!(called("x = 3(4); y2k(1); ümlaut(1);"), ["y2k", "ümlaut"]);
    }

    #[test]
    fn comments_and_literals_are_skipped() {
        assert_eq!(called("/* a() */ b(); // c() \\\n d()\ne(\"f()\", '(', \"\\\"g()\");"), ["b", "e"]);
        assert_eq!(called("a(R\"x(b() )\" c())x\", d()); /* never closed e()"), ["a", "d"]);
        assert_eq!(called("a(\"not closed b()\nc();"), ["a", "c"]);
        assert_eq!(called("a('\\'', b(1'000));"), ["a", "b"]);
    }

    #[test]
    fn definitions_are_distinguished_from_calls() {
        let calls = calls_of("int own(int a) { if (test()) { go(); } while (x) { } return own(1); }");
        assert_eq!(calls.defined.into_iter().collect::<Vec<_>>(), ["own"]);
        assert_eq!(calls.called.into_keys().collect::<Vec<_>>(), ["go", "if", "own", "test", "while"]);
    }

    #[test]
    fn first_calls_have_lines() {
        let calls = calls_of("void f(void);\n// a();\nint main()\n{\n  a(1); f();\n  a(2);\n}\n");
        let calls: Vec<_> = calls.called.iter().map(|(name, line)| (name.as_str(), *line)).collect();
        assert_eq!(calls, [("a", 5), ("f", 5)]);
    }

    #[test]
    fn declarations_and_methods_are_not_calls() {
        assert_eq!(called("int a(void); int main() { int b(int); return c(1) * d(2); }"), ["c", "d"]);
        assert_eq!(
            called("#define A a(1)\n#endif\nb(1);\nint main() {\n  x = speed\n  c(1); if (x or d()) else e(); }"),
            ["a", "b", "c", "d", "e", "if"]
        );
        assert_eq!(called("int main() { robot.a(); robot->b(); Robot::c(); ::d(); x > e(); }"), ["d", "e"]);
        let class = "class Robot : Base {\n public:\n  void a(int mm) { go(); b(); }\n  void b();\n  int *c() { return c(); }\n};\n";
        assert_eq!(called(class), ["go"]);
        let outside = "void Robot::b() { a(1); go(); }\nvoid Other::b() { c(); }\nint main() { a(2); }";
        assert_eq!(called(&format!("{class}{outside}")), ["a", "c", "go"]);
        assert_eq!(
            called("struct robot r; struct robot *f() { a(); }\nstruct robot { int x; };\nint g() { f(); }"),
            ["a", "f"]
        );
    }

    #[test]
    fn constants_are_distinguished_from_defined_names() {
        let text = "#define SIZE QVGA_SIZE\nenum { RED, BLUE = 3 };\nint f(int mode) { int VGA; VGA = RED + KEY_LIST1; \
                    switch (mode) { case IRTV_OK: return LCD_MODE; } }";
        let calls = calls_of(text);
        for name in ["QVGA_SIZE", "KEY_LIST1", "IRTV_OK", "LCD_MODE"] {
            assert!(calls.used.contains(name), "{name}");
        }
        for name in ["SIZE", "RED", "BLUE", "VGA", "mode"] {
            assert!(calls.other_definitions.contains(name) && !calls.used.contains(name), "{name}");
        }
    }

    #[test]
    fn declarations_are_distinguished_from_calls() {
        let header = "extern \"C\" {\nint VWWait(void); char *OSName(char *buf);\nstatic inline void go() { VWTurn(1, 2); }\n}\n\
                      VWDone();";
        let calls = calls_of(header);
        assert_eq!(calls.declared.into_iter().collect::<Vec<_>>(), ["OSName", "VWWait"]);
        assert!(!calls.is_wrapper && calls_of("#include_next <eyebot.h>").is_wrapper);
    }

    #[test]
    fn included_files_are_listed() {
        let text = "#include <stdio.h>\n  # include \"map.h\"\n#include \"a/b.h\" // c\n#include MACRO\n";
        assert_eq!(calls_of(text).includes, ["map.h", "a/b.h"]);
    }
}
