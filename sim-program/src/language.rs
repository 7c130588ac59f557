//! Languages of compiled robot programs: extensions, compilers, packages.

use std::path::Path;

/// A language of sources that are compiled into robot programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Language {
    /// C: `.c`.
    C,
    /// C++: `.cpp`, `.cc`, `.cxx`, `.c++`.
    Cpp,
}

impl Language {
    /// Both languages, C first.
    pub const ALL: [Self; 2] = [Self::C, Self::Cpp];

    /// The language of the source at `path`, by its extension in either case; `None` for other files. A `.txt` after
    /// the extension, which some editors add, does not count.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = without_txt(path).extension()?.to_str()?.to_ascii_lowercase();
        Self::ALL.into_iter().find(|language| language.extensions().contains(&extension.as_str()))
    }

    /// The extensions of sources in this language, without a dot, in the order of the search.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::C => &["c"],
            Self::Cpp => &["cpp", "cc", "cxx", "c++"],
        }
    }

    /// The language's name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::C => "C",
            Self::Cpp => "C++",
        }
    }

    /// The environment variable that names the language's compiler.
    pub fn variable(self) -> &'static str {
        match self {
            Self::C => "CC",
            Self::Cpp => "CXX",
        }
    }

    /// The commands that are tried, in this order, as the language's compiler if the [variable](Self::variable) is not
    /// set.
    pub fn commands(self) -> &'static [&'static str] {
        match self {
            Self::C => &["cc", "gcc", "clang"],
            Self::Cpp => &["c++", "g++", "clang++"],
        }
    }

    /// The packages of Debian and Ubuntu that the language's compiler needs.
    pub fn packages(self) -> &'static str {
        match self {
            Self::C => "gcc libc6-dev",
            Self::Cpp => "g++",
        }
    }
}

/// The path, or only the name `maze.c` for a path `maze.c.txt` with a second extension.
pub(crate) fn without_txt(path: &Path) -> &Path {
    let is_txt = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("txt"));
    let stem = path.file_stem().map(Path::new).filter(|stem| is_txt && stem.extension().is_some());
    stem.unwrap_or(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn language_follows_from_the_extension() {
        let language_of = |name: &str| Language::of(Path::new(name));
        assert_eq!([language_of("maze.c"), language_of("MAZE.C")], [Some(Language::C); 2]);
        assert_eq!(
            [
                language_of("a/maze.cpp"),
                language_of("b.cc"),
                language_of("c.cxx"),
                language_of("D.CPP"),
                language_of("e.c++")
            ],
            [Some(Language::Cpp); 5]
        );
        assert_eq!(["a/maze.c.txt", "maze.cpp.TXT"].map(language_of), [Some(Language::C), Some(Language::Cpp)]);
        assert_eq!(["maze.txt", "c.txt", "a.c/maze.txt"].map(language_of), [None; 3]);
        assert_eq!([language_of("maze"), language_of("maze.h"), language_of("maze.py"), language_of(".c")], [None; 4]);
    }
}
