//! Scan of a C or C++ source for the functions and constants that it uses: enough to choose the header that it needs
//! before it is compiled.

use std::collections::BTreeSet;

use super::code::code_only;

/// Names found in a source.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Calls {
    /// Names before `(`, including names in declarations.
    pub called: BTreeSet<String>,
    /// Names of functions that the source defines outside of classes and namespaces.
    pub defined: BTreeSet<String>,
    /// Names of functions that the source declares without defining them.
    pub declared: BTreeSet<String>,
    /// Other names that the source uses and does not define, such as constants.
    pub used: BTreeSet<String>,
    /// Names that the source defines as macros, enumerators, variables or types.
    pub own: BTreeSet<String>,
    /// Files that the source includes with `"..."`.
    pub includes: Vec<String>,
    /// The source contains `#include_next`, as a header that wraps another one does.
    pub is_wrapper: bool,
}

/// Scans `text`. Comments and literals are skipped. Macros are not expanded, but calls in their definitions count.
pub fn calls_of(text: &str) -> Calls {
    let includes = text.lines().filter_map(included_file).map(str::to_owned).collect();
    let code = code_only(text);
    let tokens = tokens_of(&code);
    let mut calls = Calls { includes, ..Calls::default() };
    let mut depth = 0_usize;
    let mut is_enum = false;
    for (index, token) in tokens.iter().enumerate() {
        let before = index.checked_sub(1).map(|before| tokens[before]);
        match *token {
            // The block of `extern "C"` does not nest: its names are at the outermost level (the literal "C" is skipped).
            Token::Mark('{') if before == Some(Token::Name("extern")) => {}
            Token::Mark('{') => depth += 1,
            Token::Mark('}') => {
                depth = depth.saturating_sub(1);
                is_enum = false;
            }
            Token::Name("enum") => is_enum = true,
            Token::Name("include_next") => calls.is_wrapper = true,
            Token::Name(name) if tokens.get(index + 1) == Some(&Token::Mark('(')) => {
                // Functions inside classes do not define the unqualified name.
                let is_definition = depth == 0 && after_parentheses(&tokens[index + 1..]) == Some(Token::Mark('{'));
                let is_typed = before == Some(Token::Mark('*')) || is_type(before);
                if depth == 0 && is_typed && after_parentheses(&tokens[index + 1..]) == Some(Token::Mark(';')) {
                    calls.declared.insert(name.to_owned());
                }
                let names = if before == Some(Token::Name("define")) {
                    &mut calls.own
                } else if is_definition {
                    &mut calls.defined
                } else {
                    &mut calls.called
                };
                names.insert(name.to_owned());
            }
            Token::Name(name) => {
                let is_enumerator = is_enum && matches!(before, Some(Token::Mark('{' | ',')));
                let is_value = index.checked_sub(2).is_some_and(|at| tokens[at] == Token::Name("define"));
                let is_own = is_enumerator || before == Some(Token::Name("define")) || is_type(before) && !is_value;
                let names = if is_own { &mut calls.own } else { &mut calls.used };
                names.insert(name.to_owned());
            }
            Token::Mark(_) => {}
        }
    }
    calls.used.retain(|name| !calls.own.contains(name));
    calls
}

/// Returns true if the token may be a type, so that a name after it is a declaration.
fn is_type(token: Option<Token<'_>>) -> bool {
    const NO_TYPES: [&str; 12] =
        ["return", "case", "else", "goto", "sizeof", "do", "ifdef", "ifndef", "undef", "if", "elif", "defined"];
    matches!(token, Some(Token::Name(name)) if !NO_TYPES.contains(&name))
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Token<'a> {
    Name(&'a str),
    Mark(char),
}

/// The file of a line `#include "file"`.
fn included_file(line: &str) -> Option<&str> {
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

/// Names and punctuation of `code`, without numbers and blanks.
fn tokens_of(code: &str) -> Vec<Token<'_>> {
    let is_name = |c: char| c.is_alphanumeric() || c == '_';
    let mut tokens = Vec::new();
    let mut rest = code;
    while let Some(first) = rest.chars().next() {
        let end = if is_name(first) { rest.find(|c| !is_name(c)).unwrap_or(rest.len()) } else { first.len_utf8() };
        match first {
            _ if is_name(first) && !first.is_numeric() => tokens.push(Token::Name(&rest[..end])),
            _ if is_name(first) || first.is_whitespace() => {}
            _ => tokens.push(Token::Mark(first)),
        }
        rest = &rest[end..];
    }
    tokens
}

#[cfg(test)]
mod tests {
    use super::*;

    fn called(text: &str) -> Vec<String> {
        calls_of(text).called.into_iter().collect()
    }

    #[test]
    fn calls_are_names_before_parentheses() {
        assert_eq!(called("a(1); b (2) + c\n(3); d; e[f(4)];"), ["a", "b", "c", "f"]);
        assert_eq!(called("#define GO(x) move(x)"), ["move"]);
        assert_eq!(called("x = 3(4); y2k(1); ümlaut(1);"), ["y2k", "ümlaut"]);
    }

    #[test]
    fn comments_and_literals_are_passed_over() {
        assert_eq!(called("/* a() */ b(); // c() \\\n d()\ne(\"f()\", '(', \"\\\"g()\");"), ["b", "e"]);
        assert_eq!(called("a(R\"x(b() )\" c())x\", d()); /* never closed e()"), ["a", "d"]);
        assert_eq!(called("a(\"not closed b()\nc();"), ["a", "c"]);
        assert_eq!(called("a('\\'', b(1'000));"), ["a", "b"]);
    }

    #[test]
    fn definitions_are_told_from_calls() {
        let calls = calls_of("int own(int a) { if (test()) { go(); } while (x) { } return own(1); }");
        assert_eq!(calls.defined.into_iter().collect::<Vec<_>>(), ["own"]);
        assert_eq!(calls.called.into_iter().collect::<Vec<_>>(), ["go", "if", "own", "test", "while"]);
    }

    #[test]
    fn constants_are_told_from_names_of_the_programs_own() {
        let text = "#define SIZE QVGA_SIZE\nenum { RED, BLUE = 3 };\nint f(int mode) { int VGA; VGA = RED + KEY_LIST1; \
                    switch (mode) { case IRTV_OK: return LCD_MODE; } }";
        let calls = calls_of(text);
        for name in ["QVGA_SIZE", "KEY_LIST1", "IRTV_OK", "LCD_MODE"] {
            assert!(calls.used.contains(name), "{name}");
        }
        for name in ["SIZE", "RED", "BLUE", "VGA", "mode"] {
            assert!(calls.own.contains(name) && !calls.used.contains(name), "{name}");
        }
    }

    #[test]
    fn declarations_are_told_from_calls() {
        let header = "extern \"C\" {\nint VWWait(void); char *OSName(char *buf);\nstatic inline void go() { VWTurn(1, 2); }\n}\n\
                      VWDone();";
        let calls = calls_of(header);
        assert_eq!(calls.declared.into_iter().collect::<Vec<_>>(), ["OSName", "VWWait"]);
        assert!(!calls.is_wrapper && calls_of("#include_next <eyebot.h>").is_wrapper);
    }

    #[test]
    fn own_headers_are_listed() {
        let text = "#include <stdio.h>\n  # include \"map.h\"\n#include \"a/b.h\" // c\n#include MACRO\n";
        assert_eq!(calls_of(text).includes, ["map.h", "a/b.h"]);
    }
}
