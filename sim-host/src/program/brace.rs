//! Search for the `{` without `}` of a C or C++ source by its indentation.

use super::plain::TYPES;

/// A `{` whose `}` is not met yet.
struct Open<'a> {
    line: usize,
    /// Blanks before the statement that it belongs to.
    indent: &'a str,
    /// It is that of a namespace, a class or `extern "C"`, in which functions may begin at the margin.
    holds_functions: bool,
}

/// The line, from 1, of the `{` that has no `}`, where the indentation tells it: a `}` at the begin of a line belongs to a `{` that is
/// further to the right, or a function begins at the margin within another one. `None` if it does not tell.
pub fn unclosed_brace(text: &str) -> Option<usize> {
    if text.contains("#else") || text.contains("#elif") {
        return None;
    }
    let mut open: Vec<Open<'_>> = Vec::new();
    let (mut parentheses, mut indent) = (0_i32, "");
    let (mut is_comment, mut before) = (false, "");
    for (index, line) in text.lines().enumerate() {
        let own_indent = &line[..line.len() - line.trim_start().len()];
        if parentheses == 0 && !line.trim().is_empty() {
            indent = own_indent;
        }
        let is_function = own_indent.is_empty()
            && TYPES.iter().any(|kind| line.strip_prefix(kind).is_some_and(|rest| rest.starts_with(' ')))
            && line.contains('(')
            && !line.contains([';', '=']);
        if let Some(last) = open.last().filter(|last| is_function && !is_comment && !last.holds_functions) {
            return Some(last.line);
        }
        for (place, mark) in marks(line, &mut is_comment) {
            match mark {
                '(' => parentheses += 1,
                ')' => parentheses -= 1,
                '{' => {
                    let head = if line.trim() == "{" { before } else { line.trim_start() };
                    let holds_functions =
                        ["namespace", "extern", "class", "struct", "union"].iter().any(|word| head.starts_with(word));
                    open.push(Open { line: index + 1, indent, holds_functions });
                }
                '}' => {
                    let closed = open.pop()?;
                    if place == own_indent.len() && closed.indent != own_indent && closed.indent.starts_with(own_indent)
                    {
                        return Some(closed.line);
                    }
                }
                _ => {}
            }
        }
        if !line.trim().is_empty() {
            before = line.trim_start();
        }
    }
    let last = open.pop()?;
    let next = text.lines().skip(last.line).find(|line| !line.trim().is_empty())?;
    let indent = next.len() - next.trim_start().len();
    (indent > last.indent.len()).then_some(last.line)
}

/// Braces and parentheses of a line with their places, without those in texts and comments.
fn marks(line: &str, is_comment: &mut bool) -> Vec<(usize, char)> {
    let mut found = Vec::new();
    let mut quote = None;
    let mut letters = line.char_indices();
    while let Some((place, letter)) = letters.next() {
        let rest = &line[place..];
        match (quote, letter) {
            _ if *is_comment => *is_comment = !rest.starts_with("*/"),
            (Some(_), '\\') => drop(letters.next()),
            (Some(end), letter) => quote = Some(end).filter(|end| *end != letter),
            (None, '"' | '\'') => quote = Some(letter),
            _ if rest.starts_with("//") => break,
            _ if rest.starts_with("/*") => *is_comment = true,
            (None, '{' | '}' | '(' | ')') => found.push((place, letter)),
            _ => {}
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_brace_that_is_not_closed_is_told_by_the_indentation() {
        let line = |text: &str| unclosed_brace(text);
        assert_eq!(line("int main()\n{\n  while (1) {\n    f();\n  return 0;\n}\n"), Some(3));
        assert_eq!(line("int main()\n{\n  if (1) {\n    f();\n  }\n  return 0;\n"), Some(2));
        assert_eq!(line("void f()\n{\n  g();\n\nint main()\n{\n  return 0;\n}\n"), Some(2));
        assert_eq!(line("void f() {\n  puts(\"}\"); // }\n  if (a &&\n      b) {\n  }\n\nint main() {\n}\n"), Some(1));
    }

    #[test]
    fn functions_of_a_namespace_or_a_class_begin_at_the_margin() {
        let inner = "void go() {\n  if (1) {\n    f();\n}\n";
        for (head, line) in [("namespace robot\n{\n", 4), ("extern \"C\" {\n", 3), ("class Robot {\npublic:\n", 4)] {
            assert_eq!(unclosed_brace(&format!("{head}{inner}void halt() {{\n}}\n}}\n")), Some(line), "{head}");
        }
    }

    #[test]
    fn a_line_left_of_the_brace_tells_nothing() {
        assert_eq!(unclosed_brace("int main(void)\n{\n          if (1) {\n  ;\n"), None);
    }

    #[test]
    fn without_indentation_nothing_is_told() {
        assert_eq!(unclosed_brace("int main()\n{\nwhile (1) {\nf();\nreturn 0;\n}\n"), None);
        assert_eq!(unclosed_brace("int main()\n{\n#if A\n  if (a) {\n#else\n  if (b) {\n#endif\n  }\n"), None);
        assert_eq!(unclosed_brace("int main()\n{\n  if (a &&\n      b) {\n  }\n  return 0;\n}\n"), None);
    }
}
