//! Shards: independent parts of a sweep's cases.

use std::fmt;

/// One of N parts of the cases: every N-th case, from the I-th on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Shard {
    count: usize,
    /// Number of the shard, from 1.
    index: usize,
}

impl Shard {
    /// The part with all cases.
    pub const WHOLE: Self = Self { count: 1, index: 1 };

    /// Parses `I/N`.
    ///
    /// # Errors
    /// The text has another form, or I is not from 1 to N.
    pub fn parse(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').map(|(index, count)| (index.parse(), count.parse()));
        match numbers {
            Some((Ok(index), Ok(count))) if (1..=count).contains(&index) => Ok(Self { count, index }),
            _ => Err("expected I/N with I from 1 to N, such as 3/100".to_owned()),
        }
    }

    /// Number of the shard, from 1.
    pub fn index(self) -> usize {
        self.index
    }

    /// The number of shards.
    pub fn count(self) -> usize {
        self.count
    }

    /// Returns true if the case with this index belongs to the shard.
    pub fn contains(self, case: usize) -> bool {
        case % self.count == self.index - 1
    }

    /// Number of the first `cases` cases that belong to the shard.
    pub fn count_of(self, cases: usize) -> usize {
        (0..cases).filter(|&case| self.contains(case)).count()
    }

    /// Name of the shard's file.
    pub fn file_name(self) -> String {
        format!("rows-{}-of-{}.jsonl", self.index, self.count)
    }

    /// The shard whose file has this name.
    pub fn of_file_name(name: &str) -> Option<Self> {
        let (index, count) = name.strip_prefix("rows-")?.strip_suffix(".jsonl")?.split_once("-of-")?;
        Self::parse(&format!("{index}/{count}")).ok().filter(|shard| shard.file_name() == name)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_case_is_in_exactly_one_shard() {
        let shards: Vec<Shard> = (1..=7).map(|index| Shard::parse(&format!("{index}/7")).expect("a shard")).collect();
        for case in 0..50 {
            assert_eq!(shards.iter().filter(|shard| shard.contains(case)).count(), 1);
        }
        assert!((0..50).all(|case| Shard::WHOLE.contains(case)));
    }

    #[test]
    fn file_names_are_parsed() {
        let shard = Shard::parse("3/100").expect("a shard");
        assert_eq!(Shard::of_file_name(&shard.file_name()), Some(shard));
        for name in ["rows-3-of-2.jsonl", "rows-03-of-4.jsonl", "rows.jsonl", "rows-1-of-1.jsonl~"] {
            assert_eq!(Shard::of_file_name(name), None, "{name}");
        }
    }

    #[test]
    fn invalid_shards_are_reported() {
        for text in ["0/0", "0/2", "3/2", "1", "a/b", "1/", "-1/2", "1/2/3", ""] {
            assert!(Shard::parse(text).expect_err(text).contains("I/N"));
        }
    }
}
