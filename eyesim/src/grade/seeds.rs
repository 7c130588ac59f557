//! Reads files of seeds.

/// Maximum number of seeds of a file.
const MAX_SEEDS: u64 = 100_000;

/// The text is not a list of seeds.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "line {line}: `{word}` {problem}; expected numbers and ranges such as `1..20`, with blanks or commas between them"
)]
pub struct SeedError {
    line: usize,
    word: String,
    problem: String,
}

/// Parses the seeds of a text: numbers and inclusive ranges, separated by blanks, commas and line ends; `#` begins a
/// comment.
///
/// # Errors
/// [`SeedError`].
pub fn parse_seeds(text: &str) -> Result<Vec<u64>, SeedError> {
    let mut seeds = Vec::new();
    for (index, line) in text.lines().enumerate() {
        let line_text = line.split('#').next().unwrap_or_default();
        for word in line_text.split([' ', '\t', ',', '\r']).filter(|word| !word.is_empty()) {
            let error =
                |problem: &str| SeedError { line: index + 1, word: word.to_owned(), problem: problem.to_owned() };
            let parse_seed = |text: &str| text.parse::<u64>().ok().filter(|seed| i64::try_from(*seed).is_ok());
            let range = match word.split_once("..") {
                Some((first, last)) => parse_seed(first).zip(parse_seed(last)).filter(|(first, last)| first <= last),
                None => parse_seed(word).map(|seed| (seed, seed)),
            };
            let (first, last) = range.ok_or_else(|| error("is not a seed"))?;
            if last - first >= MAX_SEEDS || seeds.len() as u64 + (last - first) >= MAX_SEEDS {
                return Err(error(&format!("makes more than {MAX_SEEDS} seeds")));
            }
            for seed in first..=last {
                if seeds.contains(&seed) {
                    return Err(error(&format!("repeats seed {seed}")));
                }
                seeds.push(seed);
            }
        }
    }
    if seeds.is_empty() {
        return Err(SeedError { line: 1, word: String::new(), problem: "has no seeds".to_owned() });
    }
    Ok(seeds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_ranges_are_parsed() {
        assert_eq!(parse_seeds("# secret\n7, 3..5\r\n\n11 # last\n"), Ok(vec![7, 3, 4, 5, 11]));
        for (text, line, what) in [
            ("1\nx", 2, "`x` is not a seed"),
            ("5..3", 1, "`5..3` is not a seed"),
            ("1 1", 1, "repeats seed 1"),
            ("-1", 1, "not a seed"),
            ("0..9999999", 1, "more than"),
            ("# nothing", 1, "has no seeds"),
        ] {
            let error = parse_seeds(text).expect_err(text).to_string();
            assert!(error.starts_with(&format!("line {line}: ")) && error.contains(what), "{error}");
        }
    }
}
