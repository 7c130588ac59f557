//! Finds the pointers and arrays through which a line of C or C++ reads and writes, from the declarations above the
//! line.

use std::collections::{BTreeMap, BTreeSet};

use super::code::{STATEMENTS, begins_function, code_only, is_name};

/// Maximum number of pointers that are collected for a line.
const MAX_POINTERS: usize = 3;

/// Number of lines above a line that are searched for assignments to its variables.
const MAX_LINES_ABOVE: usize = 30;

/// Words, besides [`STATEMENTS`], that do not begin a declaration of a variable.
const NOT_TYPES: [&str; 10] =
    ["break", "catch", "continue", "for", "if", "operator", "sizeof", "switch", "template", "while"];

/// Variables by their names.
type Variables<'a> = BTreeMap<&'a str, Variable>;

/// Pointers and arrays through which a line reads and writes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Accesses {
    /// The pointers, in the line's order, each once: `p`, `p->next`, `argv[1]`.
    pub pointers: Vec<String>,
    /// The arrays, in the line's order, each once.
    pub arrays: Vec<IndexedArray>,
}

/// An array that a line indexes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct IndexedArray {
    /// Name of the array, such as `d` or `robot.marks`.
    pub name: String,
    /// Length of the array, if it has one dimension and the source shows the length.
    pub len: Option<u64>,
    /// Every index is a number within the array.
    pub is_inside: bool,
}

/// Accesses of line `line` of `source`, counted from 1. `None` if the line may have accesses that are not found:
/// through members of unknown types, references, results of functions, names that are not declared above the line,
/// macros, or functions of the C library that a compiler replaces with its own code.
///
/// The result includes pointers from lines above that assign to variables of this line: a compiler may delay such a
/// read until the variable is used.
pub fn accesses_of(source: &str, line: usize) -> Option<Accesses> {
    let mut found = accesses_in(source, line)?;
    let code = code_only(source);
    let lines: Vec<&str> = code.lines().collect();
    let mut names: BTreeSet<&str> = words(lines.get(line.checked_sub(1)?)?).collect();
    for line_above in (1..line).rev().take(MAX_LINES_ABOVE) {
        if found.pointers.is_empty() || found.pointers.len() >= MAX_POINTERS {
            break;
        }
        let text = lines[line_above - 1];
        if begins_function(text) {
            return (!receives_accessed_value(text, &names, &lines)).then_some(found);
        }
        if names.iter().any(|name| assigns(text, name)) {
            for pointer in accesses_in(source, line_above)?.pointers {
                found.add_pointer(&pointer)?;
            }
            names.extend(words(text));
        }
    }
    Some(found)
}

/// The words of a line of code.
fn words(code: &str) -> impl Iterator<Item = &str> {
    code.split(|c| !is_name(c)).filter(|word| word.starts_with(|c: char| c.is_alphabetic() || c == '_'))
}

/// Returns true if a line of code assigns to the variable `name` with `=`.
fn assigns(code: &str, name: &str) -> bool {
    code.match_indices(name).any(|(offset, _)| {
        let value = code[offset + name.len()..].trim_start().strip_prefix('=');
        !code[..offset].ends_with(|c| is_name(c) || c == '.' || c == '>')
            && value.is_some_and(|value| !value.starts_with('='))
    })
}

/// Returns true if one of `names` is a parameter of the function that begins with `head`, but not a pointer, and some
/// call of the function may read the argument through a pointer or an array.
fn receives_accessed_value(head: &str, names: &BTreeSet<&str>, lines: &[&str]) -> bool {
    let Some((declaration, parameters)) = head.split_once('(') else { return false };
    let is_used_value = |parameter: &&str| {
        !parameter.contains(['*', '[']) && words(parameter).last().is_some_and(|name| names.contains(name))
    };
    let has_used_value = parameters.split(',').any(|parameter| is_used_value(&parameter));
    let is_head = |line: &str| line == head || begins_function(line.trim_end().trim_end_matches(';'));
    let call = format!("{}(", words(declaration).last().unwrap_or_default());
    let has_access = |line: &&str| {
        line.split(&call).skip(1).any(|arguments| arguments.contains(['*', '[']) || arguments.contains("->"))
    };
    has_used_value && lines.iter().filter(|line| !is_head(line)).any(has_access)
}

/// The accesses of a single line, without those of lines above, see [`accesses_of`].
fn accesses_in(source: &str, line: usize) -> Option<Accesses> {
    let end = source.split_inclusive('\n').take(line).map(str::len).sum();
    let text = source.get(..end)?;
    let (code, macros) = without_directives(code_only(text));
    let tokens = tokens_of(&code);
    let closing = closing_of(&tokens);
    let scopes = vec![Scope::default()];
    let scan = Scan {
        text,
        tokens,
        closing,
        macros,
        scopes,
        members: BTreeMap::new(),
        pending_parameters: Variables::new(),
        declared_tokens: BTreeSet::new(),
        statement: 0,
    };
    scan.run(line)
}

/// Declaration of a variable or a member, as far as accesses depend on it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Variable {
    /// Lengths of its dimensions, the outer one first.
    dimensions: Vec<Option<u64>>,
    /// Number of `*` in its declaration.
    stars: usize,
    is_reference: bool,
}

/// Macros of a source.
#[derive(Default)]
struct Macros {
    /// Names of macros that may hide an access.
    hiding: BTreeSet<String>,
    /// Values of macros that are numbers.
    numbers: BTreeMap<String, u64>,
}

/// Replaces directives in `code` by blank lines; also returns the macros that they define.
fn without_directives(code: String) -> (String, Macros) {
    let (mut rest, mut macros) = (String::with_capacity(code.len()), Macros::default());
    let mut directive: Option<String> = None;
    for line in code.split_inclusive('\n') {
        let mut text = directive.take().unwrap_or_default();
        if text.is_empty() && !line.trim_start().starts_with('#') {
            rest.push_str(line);
            continue;
        }
        rest.extend(line.bytes().map(|byte| if byte == b'\n' { '\n' } else { ' ' }));
        text.push_str(line);
        if let Some(begun) = text.trim_end().strip_suffix('\\') {
            directive = Some(begun.to_owned());
        } else if let Some(definition) = text.trim_start_matches([' ', '\t', '#']).strip_prefix("define") {
            let name = definition.trim_start().split(|c| !is_name(c)).next().unwrap_or_default();
            let value = definition.trim_start()[name.len()..].trim();
            let is_call = |place: usize| place > 0 && value[..place].trim_end().ends_with(is_name);
            if value.contains(['*', '[', '>']) || value.match_indices('(').any(|(place, _)| is_call(place)) {
                macros.hiding.insert(name.to_owned());
            } else if let Ok(number) = value.parse() {
                macros.numbers.insert(name.to_owned(), number);
            }
        }
    }
    (rest, macros)
}

/// A name, a number or a punctuation mark.
#[derive(Clone, Copy)]
struct Token<'a> {
    text: &'a str,
    /// Offset of the token in the source, in bytes.
    start: usize,
    line: usize,
}

impl Token<'_> {
    /// The offset of the token's end.
    fn end(&self) -> usize {
        self.start + self.text.len()
    }

    fn is_word(&self) -> bool {
        self.text.starts_with(|c: char| is_name(c) && !c.is_ascii_digit())
    }

    /// Returns true if the token may end a value or a type: a `*` after it multiplies, or declares a pointer.
    fn ends_value(&self) -> bool {
        self.text == "]" || self.text.starts_with(is_name) && !STATEMENTS.contains(&self.text)
    }
}

fn tokens_of(code: &str) -> Vec<Token<'_>> {
    let mut tokens = Vec::new();
    let (mut offset, mut line) = (0, 1);
    while let Some(first) = code[offset..].chars().next() {
        let rest = &code[offset..];
        let len = match first {
            _ if is_name(first) => rest.find(|c| !is_name(c)).unwrap_or(rest.len()),
            '-' if rest.starts_with("->") => 2,
            ':' if rest.starts_with("::") => 2,
            _ => first.len_utf8(),
        };
        line += usize::from(first == '\n');
        if !first.is_whitespace() {
            tokens.push(Token { text: &rest[..len], start: offset, line });
        }
        offset += len;
    }
    tokens
}

/// For each opening bracket, the index of its closing bracket; for other tokens and for unclosed brackets, the number
/// of tokens.
fn closing_of(tokens: &[Token<'_>]) -> Vec<usize> {
    let mut closing = vec![tokens.len(); tokens.len()];
    let mut open = Vec::new();
    for (index, token) in tokens.iter().enumerate() {
        match token.text {
            "(" | "[" | "{" => open.push(index),
            ")" | "]" | "}" => {
                if let Some(begin) = open.pop() {
                    closing[begin] = index;
                }
            }
            _ => {}
        }
    }
    closing
}

/// The names that a block has declared so far.
#[derive(Default)]
struct Scope<'a> {
    variables: Variables<'a>,
    /// The block belongs to a `struct`: its variables are members.
    is_type: bool,
}

/// A scan of a source from its start to the end of a line.
struct Scan<'a> {
    text: &'a str,
    tokens: Vec<Token<'a>>,
    closing: Vec<usize>,
    macros: Macros,
    /// The blocks around the current token, the outermost one first.
    scopes: Vec<Scope<'a>>,
    /// Members of all types by their names; `None` for names that differ between types.
    members: BTreeMap<&'a str, Option<Variable>>,
    /// Parameters of the function whose block may begin next.
    pending_parameters: Variables<'a>,
    /// Tokens of declarations that look like accesses: names and their `[`.
    declared_tokens: BTreeSet<usize>,
    /// First token of the current statement.
    statement: usize,
}

impl<'a> Scan<'a> {
    fn run(mut self, line: usize) -> Option<Accesses> {
        let mut found = Accesses::default();
        for index in 0..self.tokens.len() {
            if self.begins_statement(index) {
                self.statement = index;
                self.declare(index);
            }
            match self.text_at(index) {
                "{" => {
                    let variables = std::mem::take(&mut self.pending_parameters);
                    self.scopes.push(Scope { variables, is_type: self.begins_type(index) });
                }
                "}" => {
                    let scope = self.scopes.pop().filter(|_| !self.scopes.is_empty())?;
                    if scope.is_type {
                        self.note_members(scope.variables);
                        // Variables follow a type, and the type's name follows a `typedef`.
                        self.declarators(index + 1);
                    }
                }
                ";" => self.pending_parameters.clear(),
                // A lambda.
                "(" if index > 0 && self.text_at(index - 1) == "]" => self.pending_parameters = self.parameters(index),
                _ => {}
            }
            if self.tokens[index].line == line && found.pointers.len() < MAX_POINTERS {
                self.visit(index, &mut found)?;
            }
        }
        Some(found)
    }

    /// The text of a token; empty after the last one.
    fn text_at(&self, index: usize) -> &'a str {
        self.tokens.get(index).map_or("", |token| token.text)
    }

    fn text_before(&self, index: usize) -> &'a str {
        index.checked_sub(1).map_or("", |before| self.text_at(before))
    }

    fn begins_statement(&self, index: usize) -> bool {
        let second = index.checked_sub(2).map_or("", |second| self.text_at(second));
        match self.text_before(index) {
            "" | ";" | "{" | "}" => true,
            "(" => second == "for",
            ":" => ["public", "private", "protected"].contains(&second),
            _ => false,
        }
    }

    /// Returns true if the `{` at `index` begins the block of a `struct`, `class`, `union` or `enum`.
    fn begins_type(&self, index: usize) -> bool {
        let head = &self.tokens[self.statement..index];
        let has = |words: &[&str]| head.iter().any(|token| words.contains(&token.text));
        has(&["struct", "class", "union", "enum"]) && !has(&["(", "="])
    }

    fn note_members(&mut self, variables: Variables<'a>) {
        for (name, variable) in variables {
            let member = self.members.entry(name).or_insert_with(|| Some(variable.clone()));
            if member.as_ref() != Some(&variable) {
                *member = None;
            }
        }
    }

    /// Notes the variables, or the parameters of a function, that a statement at `index` declares.
    fn declare(&mut self, index: usize) {
        let Some((end, words)) = self.leading_words(index) else { return };
        if let Some(begin) = self.declarator_begin(end, words) {
            self.declarators(begin);
        } else if self.text_at(end) == "(" && matches!(self.text_at(self.index_after(end)), "{" | ":") {
            // A constructor.
            self.pending_parameters = self.parameters(end);
        }
    }

    /// The index after the words with which a declaration at `index` begins, and their number: `static Node`,
    /// `std::vector<int> list`.
    fn leading_words(&self, index: usize) -> Option<(usize, usize)> {
        let (mut cursor, mut words) = (index, 0);
        while let Some(token) = self.tokens.get(cursor) {
            match token.text {
                word if NOT_TYPES.contains(&word) || STATEMENTS.contains(&word) => return None,
                "::" => words -= usize::from(words > 0),
                "<" if words > 0 => {
                    let is_of_type = |token: &&Token<'_>| {
                        token.text.starts_with(is_name) || [",", "*", "::", "<", ">"].contains(&token.text)
                    };
                    let len = self.tokens[cursor..].iter().take_while(is_of_type).count();
                    cursor += self.tokens[cursor..cursor + len].iter().rposition(|token| token.text == ">")?;
                }
                _ if token.is_word() => words += 1,
                _ => break,
            }
            cursor += 1;
        }
        (words > 0).then_some((cursor, words))
    }

    /// The index of the first declarator after leading words, which end at `end`: it begins with a `*` or `&`, or is
    /// the last word.
    fn declarator_begin(&self, end: usize, words: usize) -> Option<usize> {
        let has_mark = matches!(self.text_at(end), "*" | "&");
        (has_mark || words > 1).then_some(if has_mark { end } else { end - 1 })
    }

    /// The index after the token at `index`, or after the closing bracket if the token is an opening one.
    fn index_after(&self, index: usize) -> usize {
        let is_open = matches!(self.text_at(index), "(" | "[" | "{");
        if is_open { self.closing[index] + 1 } else { index + 1 }
    }

    /// Notes the variables of the declarators that begin at `index`: `*head, *tail;`.
    fn declarators(&mut self, index: usize) {
        let mut cursor = index;
        while let Some((name, variable, end)) = self.declarator(cursor, false) {
            if let Some(scope) = self.scopes.last_mut() {
                scope.variables.insert(name, variable);
            }
            if self.text_at(end) == "(" {
                self.pending_parameters = self.parameters(end);
            }
            cursor = end;
            while !matches!(self.text_at(cursor), "," | ";" | ")" | "}" | "") {
                cursor = self.index_after(cursor);
            }
            if self.text_at(cursor) != "," {
                break;
            }
            cursor += 1;
        }
    }

    /// Parses the declarator at `index`, such as `*head` or `d[4]`; returns the name, the variable and the index after
    /// it.
    fn declarator(&mut self, index: usize, is_parameter: bool) -> Option<(&'a str, Variable, usize)> {
        let (mut cursor, mut variable) = (index, Variable::default());
        while let mark @ ("*" | "&" | "const" | "restrict" | "volatile") = self.text_at(cursor) {
            variable.stars += usize::from(mark == "*");
            variable.is_reference |= mark == "&";
            cursor += 1;
        }
        let name = self.tokens.get(cursor).filter(|token| token.is_word())?.text;
        self.declared_tokens.insert(cursor);
        cursor += 1;
        while self.text_at(cursor) == "[" {
            self.declared_tokens.insert(cursor);
            let end = self.closing[cursor];
            variable.dimensions.push(self.number(cursor + 1, end));
            cursor = end + 1;
        }
        if is_parameter && !variable.dimensions.is_empty() {
            variable.dimensions.remove(0);
            variable.stars += 1;
        }
        Some((name, variable, cursor))
    }

    /// The number at `begin`, if `end` is the next token.
    fn number(&self, begin: usize, end: usize) -> Option<u64> {
        let text = self.text_at(begin);
        let number = text.parse().ok().or_else(|| self.macros.numbers.get(text).copied());
        number.filter(|_| begin + 1 == end)
    }

    /// The parameters between the `(` at `open` and its `)`.
    fn parameters(&mut self, open: usize) -> Variables<'a> {
        let (mut cursor, close) = (open + 1, self.closing[open]);
        let mut variables = Variables::new();
        while cursor < close {
            let begin = self.leading_words(cursor).and_then(|(end, words)| self.declarator_begin(end, words));
            if let Some((name, variable, _)) = begin.and_then(|begin| self.declarator(begin, true)) {
                variables.insert(name, variable);
            }
            while cursor < close && self.text_at(cursor) != "," {
                cursor = self.index_after(cursor);
            }
            cursor += 1;
        }
        variables
    }

    /// The variable to which `name` refers at the current token.
    fn variable(&self, name: &str) -> Option<&Variable> {
        self.scopes.iter().rev().find_map(|scope| scope.variables.get(name))
    }

    /// Adds the accesses of the token at `index`; `None` if they are not known.
    fn visit(&self, index: usize, found: &mut Accesses) -> Option<()> {
        let (token, previous) = (self.tokens[index], index.checked_sub(1).map(|previous| self.tokens[previous]));
        if self.declared_tokens.contains(&index) {
            return Some(());
        }
        match token.text {
            // These tokens belong to the expression of the name before them.
            "[" | "->" => previous.filter(Token::ends_value).map(|_| ()),
            "*" => {
                let next =
                    (index..).map(|position| self.text_at(position)).find(|text| *text != "*").unwrap_or_default();
                let is_unknown =
                    matches!(next, "(" | "+" | "-") && previous.is_none_or(|previous| !previous.ends_value());
                (!is_unknown).then_some(())
            }
            _ if !token.is_word() => Some(()),
            name if self.macros.hiding.contains(name) => None,
            name if self.text_at(index + 1) == "(" => (!is_replaced_by_compilers(name)).then_some(()),
            _ if previous.is_some_and(|previous| ["->", ".", "::"].contains(&previous.text)) => Some(()),
            _ => self.visit_name(index, found),
        }
    }

    /// Adds the accesses of the expression that begins with the name at `index`, and of the `*` in front of it.
    fn visit_name(&self, index: usize, found: &mut Accesses) -> Option<()> {
        let mut cursor = index + 1;
        let Some(variable) = self.variable(self.text_at(index)) else {
            let is_plain = !["[", "->", "."].contains(&self.text_at(cursor)) && self.unary_stars(index, false) == 0;
            return is_plain.then_some(());
        };
        if variable.is_reference {
            return None;
        }
        let begin = self.tokens[index].start;
        let mut part = Part::Known { variable, indexed: 0, stars: variable.stars };
        loop {
            let text = self.text.get(begin..self.tokens.get(cursor - 1)?.end())?;
            match self.text_at(cursor) {
                "[" => {
                    let end = self.closing[cursor];
                    part = found.step(part, text, Step::Index(self.number(cursor + 1, end)))?;
                    cursor = end + 1;
                }
                mark @ ("->" | ".") => {
                    if mark == "->" {
                        found.step(part, text, Step::Target)?;
                    }
                    part = self.member(self.text_at(cursor + 1));
                    cursor += 2;
                }
                _ => break,
            }
        }
        let is_pointer = match part {
            Part::Known { variable, indexed, stars } => stars > 0 || indexed < variable.dimensions.len(),
            Part::UnknownMember => false,
        };
        let stars = self.unary_stars(index, is_pointer);
        // A `*` after a cast looks like a product, and the result of a method is not known.
        let is_unknown =
            self.text_at(cursor) == "(" || self.stars_before(index).1.is_some_and(|token| token.text == ")");
        if matches!(part, Part::UnknownMember) && is_unknown && self.text_before(index) == "*" {
            return None;
        }
        let expression = self.text.get(begin..self.tokens.get(cursor - 1)?.end())?;
        for number in 0..stars {
            part = found.step(part, &format!("{}{expression}", "*".repeat(number)), Step::Target)?;
        }
        Some(())
    }

    /// The member `name` of any type.
    fn member(&self, name: &str) -> Part<'_> {
        match self.members.get(name) {
            Some(Some(variable)) => Part::Known { variable, indexed: 0, stars: variable.stars },
            _ => Part::UnknownMember,
        }
    }

    /// Number of `*` in front of the name at `index` that dereference. The first `*` multiplies if a value precedes it;
    /// after a `)` it dereferences only if a pointer follows.
    fn unary_stars(&self, index: usize, is_pointer: bool) -> usize {
        let (count, previous) = self.stars_before(index);
        let multiplies = previous.is_some_and(|previous| previous.ends_value() || previous.text == ")" && !is_pointer);
        count - usize::from(multiplies && count > 0)
    }

    /// Number of `*` in front of the name at `index`, and the token before them.
    fn stars_before(&self, index: usize) -> (usize, Option<Token<'a>>) {
        let count = self.tokens[..index].iter().rev().take_while(|token| token.text == "*").count();
        (count, (index - count).checked_sub(1).map(|previous| self.tokens[previous]))
    }
}

/// A part of an expression: a variable or a member after some steps into it, or a member of an unknown type.
#[derive(Clone, Copy)]
enum Part<'a> {
    Known {
        variable: &'a Variable,
        /// Number of its dimensions that are already indexed.
        indexed: usize,
        stars: usize,
    },
    UnknownMember,
}

/// A step from a pointer or an array to its target or element.
#[derive(Clone, Copy)]
enum Step {
    /// By an index, with its value if that is a number.
    Index(Option<u64>),
    /// By `*` or `->`.
    Target,
}

impl Accesses {
    /// Adds the access by a step into `part`, whose text is `text`. Returns the resulting part; `None` if it is not
    /// known whether `part` is a pointer.
    fn step<'a>(&mut self, part: Part<'a>, text: &str, step: Step) -> Option<Part<'a>> {
        match (part, step) {
            (Part::Known { variable: Variable { dimensions, .. }, indexed, .. }, _) if indexed < dimensions.len() => {
                let number = if let Step::Index(number) = step { number } else { Some(0) };
                let is_inside = number.zip(dimensions[indexed]).is_some_and(|(number, len)| number < len);
                let is_array = |name: &str| {
                    let rest = text.strip_prefix(name);
                    rest.is_some_and(|rest| if indexed == 0 { rest.is_empty() } else { rest.starts_with('[') })
                };
                let known = self.arrays.iter_mut().filter(|array| is_array(&array.name));
                match known.max_by_key(|array| array.name.len()) {
                    Some(array) => array.is_inside &= is_inside,
                    None => {
                        let len = dimensions[0].filter(|_| dimensions.len() == 1);
                        self.arrays.push(IndexedArray { name: text.to_owned(), len, is_inside });
                    }
                }
            }
            (Part::Known { stars: 1.., .. }, _) | (Part::UnknownMember, Step::Target) => self.add_pointer(text)?,
            _ => return None,
        }
        Some(match part {
            Part::Known { variable, indexed, stars } if indexed < variable.dimensions.len() => {
                Part::Known { variable, indexed: indexed + 1, stars }
            }
            Part::Known { variable, indexed, stars } => Part::Known { variable, indexed, stars: stars - 1 },
            Part::UnknownMember => Part::UnknownMember,
        })
    }

    /// Adds a pointer; `None` if its text has several lines.
    fn add_pointer(&mut self, text: &str) -> Option<()> {
        if text.contains('\n') {
            return None;
        }
        if !self.pointers.iter().any(|pointer| pointer == text) {
            self.pointers.push(text.to_owned());
        }
        Some(())
    }
}

/// Returns true for functions of the C library that compilers replace with their own reads and writes: `strcpy`.
fn is_replaced_by_compilers(function: &str) -> bool {
    ["str", "mem", "sprintf", "snprintf", "vsprintf"].iter().any(|begin| function.starts_with(begin))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The pointers of `line` after `declarations`.
    fn pointers(declarations: &str, line: &str) -> Option<Vec<String>> {
        let source = format!("{declarations}\n{line}\n");
        accesses_of(&source, source.lines().count()).map(|found| found.pointers)
    }

    const DECLARATIONS: &str = "#include <stdio.h>\n#define AT(x) (grid[x])\n#define FRONT (sensor->front)\n#define LONG(x) \\\n  *(x)\n\
        #define SPEED 100\n#define CALL(x) AT(x)\nint d[10], sums[3];\n\
        typedef struct item { int marks[3], n; char *text, same; struct item *next; } Item;\nstruct other { int same[2]; } one;\nItem *s;\nNode *robot, a, *list[4];\n\
        void f(const int *p, struct node *out, int q[], int **pp, char *argv[], Node &r)\n{\n  int *place = 0, i, map[3][4];\n  int list2[] = {1};";

    #[test]
    fn pointers_of_a_line_are_found() {
        let check = |line: &str, expected: Option<&[&str]>| {
            let found = pointers(DECLARATIONS, line);
            let found: Option<Vec<&str>> = found.as_ref().map(|names| names.iter().map(String::as_str).collect());
            assert_eq!(found.as_deref(), expected, "{line}");
        };
        check("  printf(\", in %d * %p\", *place); // *other", Some(&["place"]));
        check("  for (i = 0; i < 10; i++) *place++ = d[i];", Some(&["place"]));
        check("  if (robot->value > 2) *out = 7;", Some(&["robot", "out"]));
        check("  x = (double)*place / d[2];", Some(&["place"]));
        check("  if (d[0] == 0) *p = 1;", Some(&["p"]));
        check("  do *p = d[1]; while (0);", Some(&["p"]));
        check("  if(ok)p->x = 3;", Some(&["p"]));
        check("  return *p;", Some(&["p"]));
        check("  q[3] = a * b;", Some(&["q"]));
        check("  d[i + 1] = a * b;", Some(&[]));
        check("  int *place = p, x = q[1] * 2;", Some(&["q"]));
        check("  Node *one = robot, **two = pp, three[2];", Some(&[]));
        check("  area = width * i + *p * SPEED;", Some(&["p"]));
        check("  area = (i + 1) * d[0] + i ** p;", Some(&["p"]));
        check("  f(a, b, &i);", Some(&[]));
        check("  robot->next->x = 3;", Some(&["robot", "robot->next"]));
        check("  n = argv[1][0] - argv[i + 1][2];", Some(&["argv", "argv[1]", "argv[i + 1]"]));
        check("  a.next->x = list[2]->x;", Some(&["a.next", "list[2]"]));
        check("  **pp = map[1][4];", Some(&["pp", "*pp"]));
        check("  int *n = malloc(3 * sizeof *n);", Some(&[]));
        check("  s->marks[i] = (i + 1) * s->next->marks[2];", Some(&["s", "s->next"]));
        check("  s->text[i] = (s + 1)->n;", None);
        check("  s->text[i] = s->next[1].n;", Some(&["s", "s->text", "s->next"]));
        check("  s->same[i] = 3;", None);
        check("  *s->text = *s->marks;", Some(&["s", "s->text"]));
        for line in [
            "  if (FRONT < robot->front)",
            "  sums[1] = AT(2);",
            "  sums[1] = LONG(p);",
            "  sums[1] = CALL(2);",
            "  robot->map[3] = 1;",
            "  vector[3] = 1;",
            "  x = f(a)->y;",
            "  *(p + 1) = 3;",
            "  strcpy(text, robot->name);",
            "  r.x = *p;",
            "  n = (double) *robot->place;",
            "  robot->x = unknown->y;",
        ] {
            check(line, None);
        }
    }

    #[test]
    fn names_refer_to_the_enclosing_blocks() {
        let other = "int *best;\nvoid show(int *d, int *best) { *best = d[0]; }\nstruct node { int *d, **x; } *root;\nint main(void)\n{\n  int d[4];\n";
        let check = |line: &str, expected: &[&str]| {
            assert_eq!(pointers(other, line).expect("known accesses"), expected, "{line}");
        };
        check("  *best = d[0];", &["best"]);
        check("  { int best[3]; { best[1] = root->n; } }", &["root"]);
        check("  { int best[3]; } *best = 3;", &["best"]);
        check("  int *p = best ? d : 0, *q = p; *q = *p;", &["q", "p"]);
        check("  for (int *p = d; p; p++) sum += *p;", &["p"]);
        assert_eq!(pointers(other, "  *x = 3;"), None);
        assert_eq!(
            pointers("void f(int *p)\n{\n#if A\n  if (a) {\n#else\n  if (b) {\n#endif\n  }", "*p = 3;"),
            Some(vec!["p".to_owned()])
        );
        assert_eq!(pointers("}\nint *p;", "*p = 3;"), None);
        let class =
            "class Robot {\npublic:\n  Robot(int *start) : place(start) {}\n  int *place;\n  void f(int *p)\n  {";
        assert_eq!(pointers(class, "*p = *place; // *start"), Some(vec!["p".to_owned(), "place".to_owned()]));
    }

    #[test]
    fn pointers_of_assigned_values_are_included() {
        let above = "int other(int *p)\n{\n  v = *p;\n}\nint sum(int *p, int *q, int n)\n{\n  int v = *p;\n  int w = v, x = 3;\n  x = n;";
        assert_eq!(pointers(above, "  return w + *q;"), Some(vec!["q".to_owned(), "p".to_owned()]));
        assert_eq!(pointers(above, "  return n + *q;"), Some(vec!["q".to_owned()]));
        let called = |call: &str| {
            pointers(&format!("int sum(int *, int *, int);\nint f() {{ {call} }}\n{above}"), "  return n + *q;")
        };
        assert_eq!(called("sum(a, b, 3);"), Some(vec!["q".to_owned()]));
        assert_eq!(called("sum(a, b, r->x);"), None);
    }

    #[test]
    fn array_lengths_come_from_declarations() {
        let array = |declarations: &str, line: &str| {
            let source = format!("{declarations}\n{line}\n");
            let found = accesses_of(&source, source.lines().count()).expect("known accesses");
            assert_eq!(found.arrays.len(), 1, "{line}");
            let IndexedArray { len, is_inside, .. } = found.arrays[0];
            (len, is_inside)
        };
        assert_eq!(array("#define N 4\nint d[N];", "d[4] = 1;"), (Some(4), false));
        assert_eq!(array("int k, n = 4, d[4];", "d[k] = 1;"), (Some(4), false));
        assert_eq!(array("int big[500];", "int first = big[3];"), (Some(500), true));
        assert_eq!(array("int d[4];", "LCDPrintf(\"%s %d\", d[0], d[3]);"), (Some(4), true));
        assert_eq!(array("static int d[4];", "d[0] = d[i] + d[1];"), (Some(4), false));
        assert_eq!(array("struct robot { int x; } robots[3];", "robots[k].x = 3;"), (Some(3), false));
        assert_eq!(array("typedef struct { int x; } Robot;\nRobot robots[3];", "robots[k].x = 3;"), (Some(3), false));
        assert_eq!(array("struct robot { int marks[3]; } r;", "r.marks[2] = r.marks[0];"), (Some(3), true));
        assert_eq!(array("struct robot { int x; } r[4];", "r[2].x = r[1].x;"), (Some(4), true));
        assert_eq!(array("int map[3][4];", "map[2][3] = 1;"), (None, true));
        assert_eq!(array("int map[3][4];", "map[2][4] = 1;"), (None, false));
    }

    #[test]
    fn unfinished_and_long_lines_are_scanned() {
        for line in
            ["p->", "p[", "d[1", "*", "p[3]->", "int x[", "f(p * ", "struct", "for (", "a.", "* *p", "{ int *", "}}"]
        {
            let _ = pointers("int *p, d[4];", line);
            let _ = pointers("", line);
        }
        let line: String = (0..10_000).map(|place| format!("p[{place}] + d[{place}] * x{place} + ")).collect();
        assert_eq!(pointers("int *p, d[4];", &format!("{line}3;")), Some(vec!["p".to_owned()]));
        let nested = format!("{}0{}", "p[".repeat(10_000), "]".repeat(10_000));
        assert_eq!(pointers("int *p;", &nested), Some(vec!["p".to_owned()]));
    }
}
