//! Selection of cases by an expression over their names, as in pytest: `real and not seed=3`.

/// An expression of words with `and`, `or`, `not` and parentheses; a word matches names that contain it, ignoring case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Selection(Term);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Term {
    Word(String),
    Not(Box<Term>),
    And(Box<Term>, Box<Term>),
    Or(Box<Term>, Box<Term>),
}

/// Error for a text that is not a valid expression.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{text}`: {problem}; expected words with `and`, `or`, `not` and parentheses, such as `real and not seed=3`")]
pub struct SelectionError {
    text: String,
    problem: String,
}

impl Selection {
    /// Parses an expression.
    ///
    /// # Errors
    /// [`SelectionError`].
    pub fn parse(text: &str) -> Result<Self, SelectionError> {
        let spaced = text.replace('(', " ( ").replace(')', " ) ");
        let mut words: Vec<&str> = spaced.split_whitespace().rev().collect();
        let error = |problem: String| SelectionError { text: text.to_owned(), problem };
        let term = parse_or(&mut words).map_err(error)?;
        match words.pop() {
            None => Ok(Self(term)),
            Some(word) => Err(error(format!("`{word}` is not allowed here"))),
        }
    }

    /// Returns true for a name that the expression selects.
    pub fn matches(&self, name: &str) -> bool {
        self.0.matches(&name.to_lowercase())
    }
}

impl Term {
    fn matches(&self, name: &str) -> bool {
        match self {
            Self::Word(word) => contains_word(name, word),
            Self::Not(term) => !term.matches(name),
            Self::And(a, b) => a.matches(name) && b.matches(name),
            Self::Or(a, b) => a.matches(name) || b.matches(name),
        }
    }
}

/// Returns true if `name` contains `word`. A number at the end of the word must also end there in the name: `seed=1`
/// does not match `seed=12`.
fn contains_word(name: &str, word: &str) -> bool {
    let is_digit = |c: char| c.is_ascii_digit() || c == '.';
    name.match_indices(word).any(|(start, found)| {
        let rest = &name[start + found.len()..];
        !(word.ends_with(is_digit) && rest.starts_with(is_digit))
    })
}

fn parse_or(words: &mut Vec<&str>) -> Result<Term, String> {
    let mut term = parse_and(words)?;
    while words.last() == Some(&"or") {
        words.pop();
        term = Term::Or(Box::new(term), Box::new(parse_and(words)?));
    }
    Ok(term)
}

fn parse_and(words: &mut Vec<&str>) -> Result<Term, String> {
    let mut term = parse_not(words)?;
    while words.last() == Some(&"and") {
        words.pop();
        term = Term::And(Box::new(term), Box::new(parse_not(words)?));
    }
    Ok(term)
}

fn parse_not(words: &mut Vec<&str>) -> Result<Term, String> {
    // Each level of parentheses uses a level of the stack.
    const MAX_WORDS: usize = 200;
    if words.len() > MAX_WORDS {
        return Err(format!("more than {MAX_WORDS} words"));
    }
    match words.pop() {
        Some("not") => Ok(Term::Not(Box::new(parse_not(words)?))),
        Some("(") => {
            let term = parse_or(words)?;
            match words.pop() {
                Some(")") => Ok(term),
                _ => Err("a `(` is not closed".to_owned()),
            }
        }
        Some(word @ ("and" | "or" | ")")) => Err(format!("`{word}` has no word before it")),
        Some(word) => Ok(Term::Word(word.to_lowercase())),
        None => Err("a word is missing at the end".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(text: &str, selected: &[&str]) {
        let names = ["noise=none,seed=1", "noise=real,seed=1", "noise=real,seed=12"];
        let selection = Selection::parse(text).expect("an expression");
        let found: Vec<&str> = names.into_iter().filter(|name| selection.matches(name)).collect();
        assert_eq!(found, selected, "{text}");
    }

    #[test]
    fn expressions_select_names() {
        check("real", &["noise=real,seed=1", "noise=real,seed=12"]);
        check("REAL and not seed=12", &["noise=real,seed=1"]);
        check("none or seed=12", &["noise=none,seed=1", "noise=real,seed=12"]);
        check("not (none or seed=12)", &["noise=real,seed=1"]);
        check("seed=1", &["noise=none,seed=1", "noise=real,seed=1"]);
        check("not not none", &["noise=none,seed=1"]);
    }

    #[test]
    fn invalid_expressions_are_reported() {
        for (text, problem) in [
            ("", "missing"),
            ("a and", "missing"),
            ("(a", "not closed"),
            ("a b", "`b` is not allowed here"),
            ("or a", "`or`"),
        ] {
            let error = Selection::parse(text).expect_err(text).to_string();
            assert!(error.contains(problem), "{error}");
        }
        assert!(Selection::parse(&"(".repeat(10_000)).is_err());
    }
}
