//! Dialects of robot files: the EyeSim version that a file was written for.

use crate::line::{self, Word};

/// Dialects of robot files, oldest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Dialect {
    /// EyeSim 5 and 6.
    Classic,
    /// EyeSim VR since 2017.
    Vr,
    /// EyeSim VR since 2022: the id of a PSD comes first, the camera's first number is ignored.
    Newest,
}

impl Dialect {
    /// Newest dialect that any line requires: a whole file is read as one dialect.
    ///
    /// Source: reference section 4.3, "telling apart"; `wheel drive|turn`, `model` with an offset and `fisheye` for the
    /// newest: our reading of the same files.
    pub(super) fn of<'a>(lines: impl IntoIterator<Item = &'a [Word<'a>]>) -> Self {
        lines.into_iter().map(Self::of_line).max().unwrap_or(Dialect::Classic)
    }

    fn of_line(words: &[Word<'_>]) -> Self {
        let Some((keyword, rest)) = words.split_first() else {
            return Dialect::Classic;
        };
        let is_number = |index: usize| rest.get(index).is_some_and(|word| line::looks_numeric(word.text));
        match keyword.text {
            "psd" if is_number(0) && !is_number(1) && rest.len() > 1 => Dialect::Newest,
            "fisheye" => Dialect::Newest,
            "collider" | "mass" | "axel" | "lidar" => Dialect::Vr,
            "axis" if rest.len() == 2 && is_number(1) => Dialect::Vr,
            // A legged drive has no device names in any dialect.
            "drive" if rest.len() == 1 && rest[0].text != "LEGGED_DRIVE" => Dialect::Vr,
            "wheel" if matches!(rest.first().map(|word| word.text), Some("drive" | "turn")) => Dialect::Vr,
            "model" if rest.len() == 7 && (1..7).all(is_number) => Dialect::Vr,
            _ => Dialect::Classic,
        }
    }
}
