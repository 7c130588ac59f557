//! Splits an argument string into words as a POSIX shell does, without expanding anything.

/// Reasons why an argument string cannot be split into words.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WordsError {
    /// A quote is opened and never closed; `column` counts characters from 1.
    #[error("the {quote} opened at column {column} of `{text}` is never closed")]
    OpenQuote {
        /// `'` or `"`.
        quote: char,
        /// Place of the quote, counted in characters from 1.
        column: usize,
        /// The whole argument string.
        text: String,
    },
    /// The last character is a backslash that escapes nothing.
    #[error("`{text}` ends with a back-slash that escapes nothing: write `\\\\` for a back-slash")]
    TrailingBackslash {
        /// The whole argument string.
        text: String,
    },
    /// A NUL character, which no C string can contain.
    #[error("`{text}` has a NUL character, which no program argument can hold")]
    Nul {
        /// The whole argument string, its NUL characters escaped.
        text: String,
    },
}

/// Splits `text` into words: blanks separate, `'...'` is literal, inside `"..."` a backslash escapes `"`, `\`, `$` and
/// ``
/// ` ``, outside of quotes it escapes any character. Nothing is expanded (`$HOME`, `*` and `~` are ordinary text) and `#`
/// starts no comment.
///
/// # Errors
/// [`WordsError`] if a quote stays open, `text` ends with a lone backslash or has a NUL.
///
/// Source: POSIX.1-2017, Shell Command Language, section 2.2.
pub fn split_words(text: &str) -> Result<Vec<String>, WordsError> {
    if text.contains('\0') {
        return Err(WordsError::Nul { text: text.replace('\0', "\\0") });
    }
    let mut words = Vec::new();
    let mut word: Option<String> = None;
    let mut characters = text.chars().enumerate();
    while let Some((index, character)) = characters.next() {
        if character.is_ascii_whitespace() {
            words.extend(word.take());
            continue;
        }
        let word = word.get_or_insert_default();
        match character {
            '\'' | '"' => loop {
                let open = || WordsError::OpenQuote { quote: character, column: index + 1, text: text.to_owned() };
                match characters.next().ok_or_else(open)?.1 {
                    end if end == character => break,
                    '\\' if character == '"' => match characters.next().ok_or_else(open)?.1 {
                        escaped @ ('"' | '\\' | '$' | '`') => word.push(escaped),
                        '\n' => {}
                        other => word.extend(['\\', other]),
                    },
                    other => word.push(other),
                }
            },
            '\\' => match characters.next() {
                Some((_, '\n')) => {}
                Some((_, escaped)) => word.push(escaped),
                None => return Err(WordsError::TrailingBackslash { text: text.to_owned() }),
            },
            other => word.push(other),
        }
    }
    words.extend(word);
    Ok(words)
}

/// Quotes a word for a shell, if necessary.
pub fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "_-./=:,+%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        word.to_owned()
    } else {
        format!("'{}'", word.replace('\'', "'\\''"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(text: &str, expected: &[&str]) {
        assert_eq!(split_words(text).expect(text), expected, "{text}");
    }

    #[test]
    fn words_are_split_by_the_rules_of_a_shell() {
        check("", &[]);
        check("  \t ", &[]);
        check("--kp 0.5", &["--kp", "0.5"]);
        check("a  b\tc\n", &["a", "b", "c"]);
        check(r#""two words" one"#, &["two words", "one"]);
        check("'it is' \"it's\"", &["it is", "it's"]);
        check(r#"--name="left wall"x"#, &["--name=left wallx"]);
        check(r"two\ words \\ \'", &["two words", r"\", "'"]);
        check(r#""a\"b\\c\n\$x""#, &[r#"a"b\c\n$x"#]);
        check(r"'\n'", &[r"\n"]);
        check("'' \"\"", &["", ""]);
        check("$HOME * ~ # no comment", &["$HOME", "*", "~", "#", "no", "comment"]);
    }

    #[test]
    fn open_quotes_are_reported_with_their_column() {
        let message = split_words("--kp '0.5").expect_err("open quote").to_string();
        assert_eq!(message, "the ' opened at column 6 of `--kp '0.5` is never closed");
        assert!(matches!(split_words("\"a\\"), Err(WordsError::OpenQuote { quote: '"', column: 1, .. })));
        assert!(matches!(split_words("a\\"), Err(WordsError::TrailingBackslash { .. })));
        assert!(matches!(split_words("a\0"), Err(WordsError::Nul { .. })));
    }
}
