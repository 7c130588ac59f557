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
    let Some((head, _)) = line.split_once('(').filter(|_| !line.contains([';', '='])) else { return false };
    let mut words = head.split([' ', '*', '&']).filter(|word| !word.is_empty());
    let first = words.next().unwrap_or_default();
    head.starts_with(|letter: char| letter.is_alphabetic() || letter == '_')
        && !STATEMENTS.contains(&first)
        && (words.next().is_some() || first == "main")
        && !head.replace("::", "").contains(':')
}

/// The variables through which `line` reads or writes, each declared as a pointer in `source`; `None` if the line may use others, such as
/// members, results of functions or what a macro hides.
pub fn pointers_of(line: &str, source: &str) -> Option<Vec<String>> {
    let (code, source) = (code_only(line), code_only(source));
    let defined = source.lines().filter_map(|line| line.trim().strip_prefix("#define"));
    let hiding = defined.filter(|rest| rest.contains(['*', '[', '>']));
    let mut macros = hiding.filter_map(|rest| rest.trim().split(|c| !is_name(c)).next());
    if macros.any(|name| code.split(|c| !is_name(c)).any(|word| word == name)) {
        return None;
    }
    let mut found = Vec::new();
    for (at, letter) in code.char_indices() {
        let (left, right) = (code[..at].trim_end(), code[at + letter.len_utf8()..].trim_start());
        let name = match letter {
            '[' => {
                let name = name_before(left)?;
                if declares_array(&source, name) {
                    continue;
                }
                Some(name).filter(|_| !is_member(left, name))
            }
            '-' if right.starts_with('>') => name_before(left).filter(|name| !is_member(left, name)),
            '*' if left.ends_with('*') || right.starts_with('*') => None,
            '*' if declares_at(left) || right.starts_with(['=', ')', ',']) => continue,
            '*' => match right.split(|c| !is_name(c)).next().filter(|name| declares_pointer(&source, name)) {
                None if is_value(left) || right.starts_with(|c: char| c.is_ascii_digit()) => continue,
                name => name,
            },
            _ => continue,
        };
        found.push(name.filter(|name| declares_pointer(&source, name))?);
    }
    found.sort_unstable();
    found.dedup();
    Some(found.into_iter().map(str::to_owned).collect())
}

/// Words that may stand before a statement or an expression, unlike a type.
const STATEMENTS: [&str; 10] = ["case", "delete", "do", "else", "goto", "new", "return", "throw", "typedef", "using"];

/// Returns true if `name`, with which `left` ends, is a member of another name.
fn is_member(left: &str, name: &str) -> bool {
    let before = left.strip_suffix(name).unwrap_or_default().trim_end();
    before.ends_with("->") || before.ends_with('.')
}

/// Returns true if `left` ends with a value, so that a `*` after it multiplies.
fn is_value(left: &str) -> bool {
    let word = left.rsplit(|c| !is_name(c)).next().unwrap_or_default();
    left.ends_with(']') || !word.is_empty() && !STATEMENTS.contains(&word)
}

/// Returns true if a `*` after `left` declares a pointer: a type stands before it, where a statement or a parameter begins.
fn declares_at(left: &str) -> bool {
    let line = left.trim_end_matches(['*', ' ', '\t']).rsplit('\n').next().unwrap_or_default();
    let Some(mut before) =
        name_before(line).filter(|word| !STATEMENTS.contains(word)).and_then(|word| line.strip_suffix(word))
    else {
        return false;
    };
    while let Some(shorter) =
        ["const", "struct", "static", "unsigned"].iter().find_map(|word| before.trim_end().strip_suffix(word))
    {
        before = shorter;
    }
    let before = before.trim();
    before.is_empty() || before.ends_with(['(', '{', ';', '}', ','])
}

/// Returns true if `source` declares a pointer `name`, as a variable or as a parameter `name[]`.
fn declares_pointer(source: &str, name: &str) -> bool {
    !name.is_empty()
        && places_of(source, name).any(|at| {
            let (left, right) = (&source[..at], source[at + name.len()..].trim_start());
            let is_pointer =
                left.trim_end().ends_with('*') && declares_at(left) && right.starts_with(['=', ';', ',', ')']);
            let mut behind = right.chars().filter(|c| !c.is_whitespace());
            let is_parameter =
                behind.next() == Some('[') && behind.next() == Some(']') && matches!(behind.next(), Some(',' | ')'));
            is_pointer || is_parameter
        })
}

/// Returns true if `source` declares an array `name` and no pointer of this name.
fn declares_array(source: &str, name: &str) -> bool {
    let mut places = places_of(source, name);
    let is_array = places.any(|at| {
        let line = source[..at].rsplit('\n').next().unwrap_or_default();
        let is_typed = declares_at(line) && !line.trim_end().ends_with(['(', '{', ';', '}', ',']);
        is_typed && source[at + name.len()..].trim_start().starts_with('[')
    });
    is_array && !declares_pointer(source, name)
}

/// The places of the word `name` in `code`.
fn places_of<'a>(code: &'a str, name: &'a str) -> impl Iterator<Item = usize> + 'a {
    let is_whole = |at: &usize| !code[..*at].ends_with(is_name) && !code[at + name.len()..].starts_with(is_name);
    code.match_indices(name).map(|(at, _)| at).filter(is_whole)
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
            let is_declared = name_before(line)
                .is_some_and(|word| !STATEMENTS.contains(&word) && word != "sizeof" && before.ends_with([' ', '\t']))
                || !line.contains(['(', '='])
                    && before.ends_with([' ', ',', '*'])
                    && TYPES.iter().any(|kind| line.split(|c| !is_name(c)).next() == Some(*kind));
            let (length, behind) = code[at + 1..].split_once(']')?;
            is_declared.then(|| {
                let defined = |line: &str| {
                    let rest = line.trim().strip_prefix("#define")?.trim().strip_prefix(length.trim())?;
                    rest.strip_prefix([' ', '\t'])?.trim().parse().ok()
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
        let source = "#include <stdio.h>\n#define AT(x) (grid[x])\n#define FRONT (sensor->front)\nint d[10], sums[3];\nNode *robot;\n\
                      void f(const int *p, struct node *out, int q[], int **pp)\n{\n  int *place = 0, i;\n  int list[] = {1};\n}\n";
        let check = |line: &str, pointers: Option<&[&str]>| {
            let found = pointers_of(line, source);
            let found: Option<Vec<&str>> = found.as_ref().map(|names| names.iter().map(String::as_str).collect());
            assert_eq!(found.as_deref(), pointers, "{line}");
        };
        check("  printf(\", in %d * %p\", *place); // *other", Some(&["place"]));
        check("  for (i = 0; i < 10; i++) *place++ = d[i];", Some(&["place"]));
        check("  if (robot->value > 2) *out = 7;", Some(&["out", "robot"]));
        check("  x = (double)*place / d[2];", Some(&["place"]));
        check("  if (d[0] == 0) *p = 1;", Some(&["p"]));
        check("  do *p = d[1]; while (0);", Some(&["p"]));
        check("  if(ok)p->x = 3;", Some(&["p"]));
        check("  return *p;", Some(&["p"]));
        check("  q[3] = a * b;", Some(&["q"]));
        check("  d[i + 1] = a * b;", Some(&[]));
        check("  int *place = p, x = q[1] * 2;", Some(&["q"]));
        check("  f(a, b);", Some(&[]));
        check("  robot->next->x = 3;", None);
        check("  if (FRONT < robot->front)", None);
        check("  sums[1] = AT(2);", None);
        check("  robot->map[3] = 1;", None);
        check("  vector[3] = 1;", None);
        check("  x = f(a)->y;", None);
        check("  **pp = 3;", None);
        check("  *(p + 1) = 3;", None);
    }

    #[test]
    fn lengths_of_arrays_are_found_where_they_are_declared() {
        let length = |line: &str, source: &str| single_array(line, source).and_then(|(_, length)| length);
        assert_eq!(length("d[4] = 1;", "#define N 4\nint d[N];"), Some(4));
        assert_eq!(length("d[4] = 1;", "#define N5\nint d[N];"), None);
        assert_eq!(length("int first = big[3];", "int big[500];\nint first = big[3];"), Some(500));
        assert_eq!(length("d[3] = 1;", "#endif\n d[3] = 1;"), None);
        assert_eq!(length("d[3] = 1;", "int d[4]; float d[5];"), None);
    }
}
