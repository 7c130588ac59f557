//! C and C++ source without comments and literals, for scans of what is code.

/// Types of C that a declaration begins with.
pub const TYPES: [&str; 8] = ["void", "int", "double", "float", "char", "long", "unsigned", "bool"];

/// `text` with a blank for each byte of a comment or a literal, quotes included; lines and places stay.
///
/// A literal ends at the end of its line at the latest. Back-slashes at the ends of lines continue comments.
pub fn code_only(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let (taken, is_code) = match first {
            '/' if rest.starts_with("//") => (line_end(rest), false),
            '/' if rest.starts_with("/*") => (rest[2..].find("*/").map_or(rest.len(), |end| end + 4), false),
            '"' | '\'' => (literal_end(rest, first), false),
            'R' if rest.starts_with("R\"") => (raw_end(rest), false),
            // C++ groups digits, as in `1'000`.
            _ if first.is_ascii_digit() => (rest.find(|c| !is_name(c) && c != '\'').unwrap_or(rest.len()), true),
            _ if is_name(first) => (rest.find(|c| !is_name(c)).unwrap_or(rest.len()), true),
            _ => (first.len_utf8(), true),
        };
        let (piece, behind) = rest.split_at(taken);
        match is_code {
            true => code.push_str(piece),
            false => code.extend(piece.bytes().map(|byte| if byte == b'\n' { '\n' } else { ' ' })),
        }
        rest = behind;
    }
    code
}

/// Returns true if a function begins at the margin in this line of [code](code_only), without a `;` behind it.
pub fn begins_function(line: &str) -> bool {
    const STATEMENTS: [&str; 10] =
        ["case", "delete", "do", "else", "goto", "new", "return", "throw", "typedef", "using"];
    let Some((head, _)) = line.split_once('(').filter(|_| !line.contains([';', '='])) else { return false };
    let mut words = head.split([' ', '*', '&']).filter(|word| !word.is_empty());
    let first = words.next().unwrap_or_default();
    head.starts_with(|letter: char| letter.is_alphabetic() || letter == '_')
        && !STATEMENTS.contains(&first)
        && (words.next().is_some() || first == "main")
        && !head.replace("::", "").contains(':')
}

/// The pointers through which a line of C or C++ reads or writes, as `place` of `*place` and `robot` of `robot->x`; empty where a macro or
/// an expression may hide some.
pub fn pointers_of(line: &str) -> Vec<String> {
    let code = code_only(line);
    let mut found: Vec<&str> = Vec::new();
    for (place, letter) in code.char_indices() {
        let (left, right) = (code[..place].trim_end(), &code[place..]);
        let word = left.rsplit(|c| !is_name(c)).next().unwrap_or_default();
        let pointer = if letter == '[' || right.starts_with("->") {
            operand_before(left)
        } else if letter == '*'
            && (left.is_empty() || left.ends_with(|c| "(,=+-*/%<>!&|?:;{}[~^".contains(c)) || word == "return")
        {
            operand_behind(right[1..].trim_start())
        } else if letter == '(' && word.len() > 1 && !word.contains(char::is_lowercase) {
            None
        } else {
            continue;
        };
        let Some(pointer) = pointer else { return Vec::new() };
        found.push(pointer);
    }
    found.sort_unstable();
    found.dedup();
    found.into_iter().map(str::to_owned).collect()
}

/// The operand with which `code` ends: `d`, `robot->map`, `f(3)`.
fn operand_before(code: &str) -> Option<&str> {
    let mut depth = 0_usize;
    let mut start = code.len();
    for (place, letter) in code.char_indices().rev() {
        match letter {
            ')' | ']' => depth += 1,
            '(' | '[' if depth == 0 => break,
            '(' | '[' => depth -= 1,
            '>' if code[..place].ends_with('-') => {}
            '-' if code[place..].starts_with("->") => {}
            _ if depth > 0 || letter.is_alphanumeric() || "_.".contains(letter) => {}
            _ => break,
        }
        start = place;
    }
    Some(&code[start..]).filter(|operand| depth == 0 && operand.starts_with(|c: char| c.is_alphabetic() || c == '_'))
}

/// The operand of the `*` before `code`.
fn operand_behind(code: &str) -> Option<&str> {
    let stars = code.len() - code.trim_start_matches('*').len();
    let operand = &code[stars..];
    let mut depth = 0_usize;
    let end = operand.char_indices().find(|(place, letter)| match letter {
        '(' | '[' => {
            depth += 1;
            false
        }
        ')' | ']' if depth > 0 => {
            depth -= 1;
            false
        }
        '>' if operand[..*place].ends_with('-') => false,
        '-' if operand[*place..].starts_with("->") => false,
        letter => depth == 0 && !letter.is_alphanumeric() && !"_.".contains(*letter),
    });
    let operand = &code[..stars + end.map_or(operand.len(), |(place, _)| place)];
    Some(operand).filter(|operand| operand[stars..].starts_with(|c: char| c.is_alphabetic() || c == '_'))
}

/// The only array that `line` indexes, and its length if `source` declares it.
pub fn single_array(line: &str, source: &str) -> Option<(String, Option<u64>)> {
    let code = code_only(line);
    let mut names: Vec<&str> = code.match_indices('[').filter_map(|(at, _)| name_before(&code[..at])).collect();
    names.dedup();
    match names.as_slice() {
        [name] => Some(((*name).to_owned(), declared_length(source, name))),
        _ => None,
    }
}

/// The name with which `code` ends.
fn name_before(code: &str) -> Option<&str> {
    let name = code.trim_end().rsplit(|c| !is_name(c)).next()?;
    Some(name).filter(|name| name.starts_with(|c: char| c.is_alphabetic() || c == '_'))
}

/// The length of the array `name`, if `source` declares it, always with the same number or `#define`d number and in one dimension.
fn declared_length(source: &str, name: &str) -> Option<u64> {
    let code = code_only(source);
    let mut lengths =
        code.match_indices('[').filter(|(at, _)| name_before(&code[..*at]) == Some(name)).filter_map(|(at, _)| {
            let before = code[..at].trim_end().strip_suffix(name)?;
            let line = before.rsplit('\n').next()?.trim();
            let is_declared = name_before(before).is_some_and(|word| {
                !["return", "case", "else", "do", "sizeof"].contains(&word) && before.ends_with([' ', '\t', '\n'])
            }) || !line.contains('(')
                && before.ends_with([' ', ',', '*'])
                && TYPES.iter().any(|kind| line.split(|c| !is_name(c)).next() == Some(*kind));
            let (length, behind) = code[at + 1..].split_once(']')?;
            is_declared.then(|| {
                let defined = |line: &str| {
                    line.trim().strip_prefix("#define")?.trim().strip_prefix(length.trim())?.trim().parse().ok()
                };
                let number = length.trim().parse().ok().or_else(|| code.lines().find_map(defined));
                number.filter(|_| !behind.trim_start().starts_with('['))
            })
        });
    let first: u64 = lengths.next()??;
    lengths.all(|length| length == Some(first)).then_some(first)
}

/// Returns true for a letter of a name.
pub fn is_name(letter: char) -> bool {
    letter.is_alphanumeric() || letter == '_'
}

/// End of a `//` comment, as a byte offset; a back-slash at the end of a line continues the comment on the next line.
fn line_end(text: &str) -> usize {
    let mut at = 0;
    while let Some(end) = text[at..].find('\n') {
        at += end;
        if !text[..at].trim_end_matches('\r').ends_with('\\') {
            return at;
        }
        at += 1;
    }
    text.len()
}

/// End of a literal that begins with `quote`, as a byte offset: after its closing quote, or at the end of the line.
fn literal_end(text: &str, quote: char) -> usize {
    let mut is_escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if is_escaped => is_escaped = false,
            '\\' => is_escaped = true,
            '\n' => return at,
            c if c == quote => return at + 1,
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

    #[test]
    fn pointers_of_a_line_are_found() {
        let check = |line: &str, pointers: &[&str]| assert_eq!(pointers_of(line), pointers, "{line}");
        check("  printf(\", in %d * %p\", *place); // *other", &["place"]);
        check("  d[i + 1] = a * b;", &["d"]);
        check("  robot->x = (*map).x;", &["map", "robot"]);
        check("  return *next;", &["next"]);
        check("  node->next->x = 3;", &["node", "node->next"]);
        check("  m[i][j]++;", &["m", "m[i]"]);
        check("  x = f(a)->y;", &["f(a)"]);
        check("  int *p = q; x = 3 > 2 ? a->b : 1;", &["a"]);
        check("  *p++ = 3;", &["p"]);
        check("  **q = 3;", &["*q", "q"]);
        check("  *(p + 1) = q->x;", &[]);
        check("  x = (int)2.5 * y;", &[]);
        check("  GO(*p);", &[]);
        check("  f(a, b);", &[]);
    }
}
