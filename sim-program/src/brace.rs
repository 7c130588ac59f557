//! Finds an unclosed `{` in a C or C++ source by the source's indentation.

use super::code::{begins_function, code_only};

/// A `{` whose `}` has not been found yet.
struct OpenBrace<'a> {
    line: usize,
    /// Indentation of the statement to which the brace belongs.
    indent: &'a str,
    /// The brace belongs to a namespace, a class or `extern "C"`, in which functions may begin in the first column.
    may_contain_functions: bool,
}

/// Returns the line, from 1, of the `{` that has no `}`, if the indentation shows it.
///
/// The indentation shows it in three cases: a `}` at the start of a line would close a `{` that is indented further; a
/// function begins in the first column inside another function; or the line after the last open `{` is indented further
/// than this `{`. Returns `None` for a source with `#else` or `#elif`, whose branches may open the same block twice.
pub fn unclosed_brace(text: &str) -> Option<usize> {
    if text.contains("#else") || text.contains("#elif") {
        return None;
    }
    let mut open: Vec<OpenBrace<'_>> = Vec::new();
    let (mut parentheses, mut indent) = (0_i32, "");
    let (code, mut previous_line) = (code_only(text), "");
    for (index, line) in code.lines().enumerate() {
        let line_indent = &line[..line.len() - line.trim_start().len()];
        if parentheses == 0 && !line.trim().is_empty() {
            indent = line_indent;
        }
        let is_function = begins_function(line);
        if let Some(last) = open.last().filter(|last| is_function && !last.may_contain_functions) {
            return Some(last.line);
        }
        for (place, mark) in line.char_indices() {
            match mark {
                '(' => parentheses += 1,
                ')' => parentheses -= 1,
                '{' => {
                    let head = if line.trim() == "{" { previous_line } else { line.trim_start() };
                    let may_contain_functions =
                        ["namespace", "extern", "class", "struct", "union"].iter().any(|word| head.starts_with(word));
                    open.push(OpenBrace { line: index + 1, indent, may_contain_functions });
                }
                '}' => {
                    let closed = open.pop()?;
                    if place == line_indent.len()
                        && closed.indent != line_indent
                        && closed.indent.starts_with(line_indent)
                    {
                        return Some(closed.line);
                    }
                }
                _ => {}
            }
        }
        if !line.trim().is_empty() {
            previous_line = line.trim_start();
        }
    }
    let last = open.pop()?;
    let next = text.lines().skip(last.line).find(|line| !line.trim().is_empty())?;
    let indent = next.len() - next.trim_start().len();
    (indent > last.indent.len()).then_some(last.line)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unclosed_brace_is_found_by_the_indentation() {
        let line = |text: &str| unclosed_brace(text);
        assert_eq!(line("int main()\n{\n  while (1) {\n    f();\n  return 0;\n}\n"), Some(3));
        assert_eq!(line("int main()\n{\n  if (1) {\n    f();\n  }\n  return 0;\n"), Some(2));
        assert_eq!(line("void f()\n{\n  g();\n\nint main()\n{\n  return 0;\n}\n"), Some(2));
        assert_eq!(line("void f() {\n  puts(\"}\"); // }\n  if (a &&\n      b) {\n  }\n\nint main() {\n}\n"), Some(1));
    }

    #[test]
    fn functions_of_any_type_begin_in_the_first_column() {
        for head in ["static int g()", "Place g(int a, int b)", "std::string g()", "int *g()", "main()"] {
            assert_eq!(unclosed_brace(&format!("void f()\n{{\nh();\n\n{head}\n{{\n}}\n")), Some(2), "{head}");
        }
        for line in ["h(3);", "else if (a)", "return (3)", "case A: g(3)"] {
            assert_eq!(unclosed_brace(&format!("void f()\n{{\n{line}\n{{\n}}\n}}\n")), None, "{line}");
        }
    }

    #[test]
    fn namespaces_and_classes_may_contain_functions() {
        let inner = "void go() {\n  if (1) {\n    f();\n}\n";
        for (head, line) in [("namespace robot\n{\n", 4), ("extern \"C\" {\n", 3), ("class Robot {\npublic:\n", 4)] {
            assert_eq!(unclosed_brace(&format!("{head}{inner}void halt() {{\n}}\n}}\n")), Some(line), "{head}");
        }
    }

    #[test]
    fn line_left_of_the_brace_shows_nothing() {
        assert_eq!(unclosed_brace("int main(void)\n{\n          if (1) {\n  ;\n"), None);
    }

    #[test]
    fn without_indentation_nothing_is_found() {
        assert_eq!(unclosed_brace("int main()\n{\nwhile (1) {\nf();\nreturn 0;\n}\n"), None);
        assert_eq!(unclosed_brace("int main()\n{\n#if A\n  if (a) {\n#else\n  if (b) {\n#endif\n  }\n"), None);
        assert_eq!(unclosed_brace("int main()\n{\n  if (a &&\n      b) {\n  }\n  return 0;\n}\n"), None);
    }
}
