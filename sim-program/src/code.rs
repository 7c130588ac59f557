//! Reduces C and C++ sources to their code, without comments and literals, for scans.

/// Types of C with which declarations begin.
pub const TYPES: [&str; 8] = ["void", "int", "double", "float", "char", "long", "unsigned", "bool"];

/// Replaces each byte of comments and literals in `text` by a blank, quotes included; line numbers and byte offsets are
/// preserved.
///
/// A literal ends at the end of its line at the latest. Backslashes at the ends of lines continue comments.
pub fn code_only(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let (len, is_code) = match first {
            '/' if rest.starts_with("//") => (line_end(rest), false),
            '/' if rest.starts_with("/*") => (rest[2..].find("*/").map_or(rest.len(), |end| end + 4), false),
            '"' | '\'' => (literal_end(rest, first), false),
            'R' if rest.starts_with("R\"") => (raw_end(rest), false),
            // C++ groups digits, as in `1'000`.
            _ if first.is_ascii_digit() => (rest.find(|c| !is_name(c) && c != '\'').unwrap_or(rest.len()), true),
            _ if is_name(first) => (rest.find(|c| !is_name(c)).unwrap_or(rest.len()), true),
            _ => (first.len_utf8(), true),
        };
        let (token, remainder) = rest.split_at(len);
        match is_code {
            true => code.push_str(token),
            false => code.extend(token.bytes().map(|byte| if byte == b'\n' { '\n' } else { ' ' })),
        }
        rest = remainder;
    }
    code
}

/// Returns true if a function definition begins in the first column of this line of [code](code_only).
pub fn begins_function(line: &str) -> bool {
    let Some((head, _)) = line.split_once('(').filter(|_| !line.contains([';', '='])) else { return false };
    let mut words = head.split([' ', '*', '&']).filter(|word| !word.is_empty());
    let first = words.next().unwrap_or_default();
    head.starts_with(|letter: char| letter.is_alphabetic() || letter == '_')
        && !STATEMENTS.contains(&first)
        && (words.next().is_some() || first == "main")
        && !head.replace("::", "").contains(':')
}

/// Words that may precede a statement or an expression, and are not types.
pub const STATEMENTS: [&str; 10] =
    ["case", "delete", "do", "else", "goto", "new", "return", "throw", "typedef", "using"];

/// Returns true for a character that names may contain.
pub fn is_name(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_'
}

/// End of a `//` comment, as a byte offset; a backslash at the end of a line continues the comment on the next line.
fn line_end(text: &str) -> usize {
    let mut offset = 0;
    while let Some(end) = text[offset..].find('\n') {
        offset += end;
        if !text[..offset].trim_end_matches('\r').ends_with('\\') {
            return offset;
        }
        offset += 1;
    }
    text.len()
}

/// End of a literal that begins with `quote`, as a byte offset: after its closing quote, or at the end of the line.
fn literal_end(text: &str, quote: char) -> usize {
    let mut is_escaped = false;
    for (offset, c) in text.char_indices().skip(1) {
        match c {
            _ if is_escaped => is_escaped = false,
            '\\' => is_escaped = true,
            '\n' => return offset,
            c if c == quote => return offset + 1,
            _ => {}
        }
    }
    text.len()
}

/// End of a raw string literal `R"x(...)x"`, as a byte offset.
fn raw_end(text: &str) -> usize {
    let Some(open) = text.find('(') else { return text.len() };
    let close = format!("){}\"", &text[2..open]);
    text[open..].find(&close).map_or(text.len(), |end| open + end + close.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_literals_become_blanks() {
        let check = |text: &str, code: &str| assert_eq!(code_only(text), code, "{text}");
        check("f(\"a\\\"b\", 'c'); // d\ng();", "f(      ,    );     \ng();");
        check("a /* b\n */ c", "a     \n    c");
        check("x = 1'000 + '\"'; y", "x = 1'000 +    ; y");
        check("f(\"\u{F6}", "f(   ");
    }
}
