//! Finds functions that are `inline` in the manner of GNU C before C99: `inline` alone defines a function for all
//! files, and `extern inline` defines none. With the rules of C99, which are the opposite, such programs do not link.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::code::{code_only, is_name};
use crate::files::read_regular;

/// The meaning of `inline` in C.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum InlineRule {
    /// That of C99.
    #[default]
    C99,
    /// That of GNU C before C99.
    Gnu89,
    /// As [`InlineRule::Gnu89`]; of several definitions of a function, as in a header that several files include, the
    /// first counts.
    Gnu89Merged,
}

impl InlineRule {
    /// Flag of the C compiler.
    pub fn compile_flag(self) -> Option<&'static str> {
        (self != Self::C99).then_some("-fgnu89-inline")
    }

    /// Flag of the linker.
    pub fn link_flag(self) -> Option<&'static str> {
        (self == Self::Gnu89Merged).then_some("-Wl,--allow-multiple-definition")
    }
}

/// The names of the functions that `sources`, and the headers beside the first of them, declare `inline`.
pub fn inline_functions(sources: &[PathBuf]) -> BTreeSet<String> {
    let folder = sources.first().and_then(|source| source.parent());
    let entries = folder.and_then(|folder| fs::read_dir(folder).ok()).into_iter().flatten().flatten();
    let is_header = |path: &Path| path.extension().is_some_and(|extension| extension == "h");
    let headers = entries.map(|entry| entry.path()).filter(|path| is_header(path));
    let texts = sources.iter().cloned().chain(headers).filter_map(|path| read_regular(&path).ok());
    texts.flat_map(|text| inline_names(&String::from_utf8_lossy(&text))).collect()
}

/// The names of the functions that `text` declares `inline`, `__inline` or `__inline__`.
fn inline_names(text: &str) -> Vec<String> {
    let code = code_only(text);
    let is_inline = |word: &str| ["inline", "__inline", "__inline__"].contains(&word);
    let mut names = Vec::new();
    // After `inline`, the last word before `(`.
    let mut name = None;
    for part in code.split_inclusive(|letter| !is_name(letter)) {
        let word = part.trim_end_matches(|letter| !is_name(letter));
        if is_inline(word) {
            name = Some("");
        } else if name.is_some() && !word.is_empty() {
            name = Some(word);
        }
        if part.ends_with('(') {
            names.extend(name.take().filter(|name| !name.is_empty()).map(str::to_owned));
        }
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inline_functions_are_found_in_each_spelling() {
        let text = "inline int one(int n) { return n; }\n// inline int no(void);\nint __inline__ two(void);\n\
                    static __inline BYTE *three(void) { return f(1); }\nextern inline double\nfour(double x);\nint five(void);\n";
        assert_eq!(inline_names(text), ["one", "two", "three", "four"]);
    }
}
