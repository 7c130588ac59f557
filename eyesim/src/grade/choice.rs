//! Chooses the files of a submission that become robot programs, by the patterns of `submit` in the suite.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::path::Path;

use sim_format::suite::SubmitSpec;
use sim_host::files::slashed;
use sim_host::launch::settings::ProgramOption;
use sim_host::program::language::Language;
use sim_host::record::log::Pattern;

use super::archive::{Contents, printable};

/// Maximum number of sources of a program.
const MAX_SOURCES: usize = 200;
/// Maximum number of names in a message.
const MAX_NAMES: usize = 6;
/// Extensions of files that sources include.
const HEADERS: [&str; 8] = ["h", "hh", "hpp", "hxx", "inc", "ipp", "tpp", "def"];

/// The programs of a submission.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Choice {
    /// Robots, written as in an option `--program`, with the files that are compiled, loaded or interpreted.
    pub programs: Vec<(String, Vec<String>)>,
    /// All files that these programs may consist of, by their paths: the files above, headers and modules.
    pub files: BTreeMap<String, Vec<u8>>,
}

/// Kind of a file that matches a pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SourceKind {
    Source,
    Python,
    Library,
}

impl SourceKind {
    fn of(path: &str) -> Option<Self> {
        match extension(path).as_str() {
            "py" => Some(Self::Python),
            "so" => Some(Self::Library),
            _ => Language::of(Path::new(path)).map(|_| Self::Source),
        }
    }
}

/// Returns true for a file that may be part of a program: other files of a submission are not read.
pub fn is_wanted(submit: &[SubmitSpec], path: &str) -> bool {
    SourceKind::of(path).is_some() || is_header(path) || submit.iter().any(|submit| is_submitted(submit, path))
}

/// Chooses the files of each program. Files with a name in `supplied` are omitted: the suite supplies its own.
///
/// # Errors
/// A message for the student, if the files that match do not form a program: none, too many, or of several kinds.
pub fn choose(submit: &[SubmitSpec], supplied: &BTreeSet<String>, contents: &Contents) -> Result<Choice, String> {
    let mut choice = Choice::default();
    let mut robots_of_path: BTreeMap<&str, &str> = BTreeMap::new();
    let is_supplied = |path: &str| supplied.contains(file_name(path));
    for submit in submit {
        let matching =
            contents.files.keys().map(String::as_str).filter(|path| is_submitted(submit, path) && !is_supplied(path));
        let matching = without_copies(matching.collect(), contents);
        let expected = || patterns(submit);
        let Some(first) = matching.first() else { return Err(no_match_message(submit, supplied, contents)) };
        let kind_of = |path: &str| SourceKind::of(path);
        let Some(kind) = kind_of(first) else {
            return Err(format!(
                "`{}` is not a program: expected a source in C or C++, a program in Python, or a library",
                printable(first)
            ));
        };
        if matching.iter().any(|path| kind_of(path) != Some(kind)) {
            return Err(format!("files of several kinds fit {}: {}; expected one kind", expected(), names(&matching)));
        }
        let matching = if kind == SourceKind::Source { matching } else { vec![started(submit, &matching)?] };
        if matching.len() > MAX_SOURCES {
            return Err(format!("{} files fit {}; expected at most {MAX_SOURCES}", matching.len(), expected()));
        }
        let mut seen: BTreeMap<&str, &str> = BTreeMap::new();
        for path in &matching {
            if let Some(other) = seen.insert(file_name(path), path) {
                return Err(format!(
                    "`{}` and `{}` have the same name: expected one version of each file",
                    printable(other),
                    printable(path)
                ));
            }
            if let Some(robots) = robots_of_path.insert(path, &submit.robots) {
                return Err(format!(
                    "`{}` fits the patterns of `{robots}` and of `{}`: expected a file for each",
                    printable(path),
                    submit.robots
                ));
            }
        }
        choice.programs.push((submit.robots.clone(), matching.into_iter().map(str::to_owned).collect()));
    }
    let has_python = choice
        .programs
        .iter()
        .any(|(_, files)| files.iter().any(|path| SourceKind::of(path) == Some(SourceKind::Python)));
    let is_module = |path: &str| has_python && SourceKind::of(path) == Some(SourceKind::Python) && !is_supplied(path);
    let is_part = |path: &str| is_header(path) || is_module(path);
    let chosen = |path: &String| robots_of_path.contains_key(path.as_str()) || is_part(path);
    let files = contents.files.iter().filter(|(path, _)| chosen(path));
    choice.files = files.map(|(path, bytes)| (path.clone(), bytes.clone())).collect();
    Ok(choice)
}

/// The files of a choice at the paths where they are written, and its programs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Layout {
    /// Contents of the files by their paths.
    pub files: BTreeMap<String, Vec<u8>>,
    /// Robots, written as in an option `--program`, each with the paths of its program: one file, one folder, or
    /// several files.
    pub programs: Vec<(String, Vec<String>)>,
}

impl Choice {
    /// The files of each program in a folder of its own.
    pub fn layout(&self) -> Layout {
        let mut layout = Layout::default();
        for (robots, sources) in &self.programs {
            let program_folder = Self::folder_of(robots);
            let path_of = |path: &str| format!("{program_folder}/{}", sanitized_path(path));
            for (path, bytes) in &self.files {
                // Sources of other robots would otherwise be compiled along with these.
                if SourceKind::of(path).is_none_or(|kind| kind == SourceKind::Python) || sources.contains(path) {
                    layout.files.insert(path_of(path), bytes.clone());
                }
            }
            let paths: Vec<String> = sources.iter().map(|path| path_of(path)).collect();
            let parent = |path: &String| path.rsplit_once('/').map(|(folder, _)| folder.to_owned());
            let first_parent = paths.first().and_then(parent);
            // A program in a folder has the folder's name, so that equal programs in files with different names have
            // equal records.
            let is_source = sources.iter().all(|path| SourceKind::of(path) == Some(SourceKind::Source));
            let is_folder = is_source && paths.iter().all(|path| parent(path) == first_parent);
            let program = first_parent.filter(|_| is_folder).map_or(paths, |folder| vec![folder]);
            layout.programs.push((robots.clone(), program));
        }
        layout
    }

    /// Writes the files of each program below `folder`; returns the programs as options.
    ///
    /// # Errors
    /// A file cannot be written, or the name of a program cannot be given in an option.
    pub fn write(&self, folder: &Path) -> io::Result<Vec<ProgramOption>> {
        let layout = self.layout();
        for (path, bytes) in &layout.files {
            let target = folder.join(path);
            fs::create_dir_all(target.parent().unwrap_or(folder))?;
            fs::write(target, bytes)?;
        }
        let option = |(robots, paths): &(String, Vec<String>)| {
            let full_paths: Vec<String> = paths.iter().map(|path| slashed(&folder.join(path))).collect();
            ProgramOption::parse(&format!("{robots}={}", full_paths.join(","))).map_err(io::Error::other)
        };
        layout.programs.iter().map(option).collect()
    }

    /// Folder of the program of these robots.
    pub(super) fn folder_of(robots: &str) -> String {
        format!("robot-{}", sanitized_name(robots))
    }
}

/// Path at which a file is written, without characters that have a meaning in references to programs.
fn sanitized_path(path: &str) -> String {
    let part = |part: &str| part.trim().replace([',', '\\', '='], "_");
    path.split('/').map(part).filter(|part| !part.is_empty()).collect::<Vec<_>>().join("/")
}

fn sanitized_name(robots: &str) -> String {
    robots.chars().map(|c| if c.is_alphanumeric() || c == '.' || c == '-' { c } else { '_' }).collect()
}

/// Returns true if one of the patterns matches the file.
fn is_submitted(submit: &SubmitSpec, path: &str) -> bool {
    submit.patterns.iter().any(|pattern| is_match(pattern, path))
}

/// Returns true if the pattern matches the file's name, or the end of its path if the pattern has a slash.
fn is_match(pattern: &str, path: &str) -> bool {
    let parts = pattern.matches('/').count() + 1;
    let at = path.rmatch_indices('/').nth(parts - 1).map_or(0, |(at, _)| at + 1);
    Pattern::parse_list(pattern).iter().any(|pattern| pattern.matches(&path[at..]))
}

/// The file that is started, of files of which a program has only one: the one that matches the first pattern that any
/// of them matches.
///
/// # Errors
/// A message for the student, if several files match that pattern.
fn started<'p>(submit: &SubmitSpec, matching: &[&'p str]) -> Result<&'p str, String> {
    let of_pattern = |pattern: &String| matching.iter().copied().filter(|path| is_match(pattern, path)).collect();
    let first: Option<Vec<&str>> = submit.patterns.iter().map(of_pattern).find(|files: &Vec<_>| !files.is_empty());
    match first.as_deref() {
        Some([file]) => Ok(file),
        _ => Err(format!(
            "{} files fit {}: {}; expected the one that is to be started",
            matching.len(),
            patterns(submit),
            names(matching)
        )),
    }
}

/// The paths without duplicates: of files with the same name and contents, the one in the fewest folders is kept.
fn without_copies<'p>(mut paths: Vec<&'p str>, contents: &Contents) -> Vec<&'p str> {
    paths.sort_by_key(|path| (path.matches('/').count(), *path));
    let mut kept: Vec<&str> = Vec::new();
    for path in paths {
        let is_copy = |other: &&str| {
            file_name(other) == file_name(path) && contents.files.get(*other) == contents.files.get(path)
        };
        if !kept.iter().any(is_copy) {
            kept.push(path);
        }
    }
    kept.sort_unstable();
    kept
}

fn no_match_message(submit: &SubmitSpec, supplied: &BTreeSet<String>, contents: &Contents) -> String {
    let paths: Vec<&str> = contents.files.keys().map(String::as_str).collect();
    let found = if paths.is_empty() { "no program files".to_owned() } else { names(&paths) };
    let left_out = paths.iter().find(|path| supplied.contains(file_name(path)) && is_submitted(submit, path));
    let left_out =
        left_out.map(|path| format!("\n`{}` is left out: the suite has a file of this name", printable(path)));
    let notes = contents.notes.iter().map(|note| format!("\n{note}"));
    let notes: String = left_out.into_iter().chain(notes).collect();
    format!(
        "no file fits {}, for the program of robot `{}`; the submission has {found}{notes}",
        patterns(submit),
        submit.robots
    )
}

fn patterns(submit: &SubmitSpec) -> String {
    let quoted: Vec<String> = submit.patterns.iter().map(|pattern| format!("`{pattern}`")).collect();
    quoted.join(" or ")
}

fn names(paths: &[&str]) -> String {
    let names: Vec<String> = paths.iter().take(MAX_NAMES).map(|path| format!("`{}`", printable(path))).collect();
    let more = paths.len().saturating_sub(MAX_NAMES);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("{}{more}", names.join(", "))
}

fn is_header(path: &str) -> bool {
    HEADERS.contains(&extension(path).as_str())
}

fn extension(path: &str) -> String {
    file_name(path).rsplit_once('.').map_or(String::new(), |(_, extension)| extension.to_lowercase())
}

fn file_name(path: &str) -> &str {
    path.rsplit('/').next().unwrap_or(path)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn submit(robots: &str, patterns: &[&str]) -> SubmitSpec {
        let patterns = patterns.iter().map(|pattern| (*pattern).to_owned()).collect();
        SubmitSpec { robots: robots.to_owned(), patterns, ..SubmitSpec::default() }
    }

    fn contents(files: &[(&str, &str)]) -> Contents {
        let files = files.iter().map(|(path, text)| ((*path).to_owned(), text.as_bytes().to_vec())).collect();
        Contents { files, notes: vec!["`x.rar` is an archive".to_owned()] }
    }

    #[track_caller]
    fn check(submits: &[SubmitSpec], files: &[(&str, &str)], expected: Result<&[&[&str]], &str>) {
        let supplied = ["eye.py", "check.py"].map(str::to_owned).into();
        let found = choose(submits, &supplied, &contents(files));
        match (found, expected) {
            (Ok(choice), Ok(expected)) => {
                let programs: Vec<Vec<&str>> =
                    choice.programs.iter().map(|(_, files)| files.iter().map(String::as_str).collect()).collect();
                assert_eq!(programs, expected);
            }
            (Err(message), Err(part)) => assert!(message.contains(part), "{message}"),
            (found, expected) => panic!("{found:?}, expected {expected:?}"),
        }
    }

    #[test]
    fn files_are_chosen_by_patterns() {
        let c_or_cpp = [submit("1", &["*.c", "*.cpp"])];
        check(&c_or_cpp, &[("solve.c", "")], Ok(&[&["solve.c"]]));
        check(&c_or_cpp, &[("src/SOLVE.C", ""), ("src/map.h", ""), ("x.py", "")], Ok(&[&["src/SOLVE.C"]]));
        check(&c_or_cpp, &[("a.c", "1"), ("lib/b.cpp", "2")], Ok(&[&["a.c", "lib/b.cpp"]]));
        check(&c_or_cpp, &[("a.c", "1"), ("again/a.c", "1")], Ok(&[&["a.c"]]));
        check(&c_or_cpp, &[("a.c", "1"), ("old/a.c", "2")], Err("have the same name"));
        check(
            &c_or_cpp,
            &[("map.h", "")],
            Err("no file fits `*.c` or `*.cpp`, for the program of robot `1`; the submission has `map.h`\n`x.rar`"),
        );
        check(&c_or_cpp, &[], Err("no program files"));
        let python = [submit("1", &["*.py"])];
        check(&python, &[("a.py", "1"), ("b.py", "2")], Err("2 files fit"));
        check(&[submit("1", &["main.py"])], &[("main.py", "1"), ("b.py", "2")], Ok(&[&["main.py"]]));
        let named = [submit("1", &["main.py", "*.c", "*.py"])];
        check(&named, &[("a/__init__.py", "1"), ("a/b.py", "2"), ("lab/Main.py", "3")], Ok(&[&["lab/Main.py"]]));
        check(&named, &[("solve.py", "1")], Ok(&[&["solve.py"]]));
        check(&named, &[("a.py", "1"), ("b.py", "2")], Err("2 files fit `main.py` or `*.c` or `*.py`: `a.py`, `b.py`"));
        check(&named, &[("x/main.py", "1"), ("y/main.py", "2")], Err("2 files fit"));
        check(&named, &[("main.py", "1"), ("main.c", "2")], Err("several kinds"));
        check(&python, &[("check.py", "1"), ("lab/eye.py", "2"), ("lab/solve.py", "3")], Ok(&[&["lab/solve.py"]]));
        check(&python, &[("x/check.py", "1")], Err("`x/check.py` is left out: the suite has a file of this name"));
        check(&[submit("1", &["*"])], &[("main.py", "1"), ("b.c", "2")], Err("several kinds"));
        check(&[submit("1", &["*.txt"])], &[("main.txt", "1")], Err("not a program"));
        let two = [submit("1", &["leader.c"]), submit("2", &["roles/*.c"])];
        check(&two, &[("leader.c", ""), ("x/roles/b.c", "")], Ok(&[&["leader.c"], &["x/roles/b.c"]]));
        check(&two, &[("roles/leader.c", "")], Err("fits the patterns of `1` and of `2`"));
    }

    #[test]
    fn each_program_gets_its_own_files_and_the_headers() {
        let two = [submit("1", &["leader.c"]), submit("2", &["follower*.c", "b/*.c"])];
        let files = [("leader.c", "1"), ("a/follower, 2.c", "2"), ("b/x.c", "3"), ("map.h", "4")];
        let choice = choose(&two, &BTreeSet::new(), &contents(&files)).expect("a choice");
        let folder = tempfile::tempdir().expect("a folder");
        let options = choice.write(folder.path()).expect("programs");
        let relative = |option: &ProgramOption| option.to_string().replace(&format!("{}/", slashed(folder.path())), "");
        assert_eq!(relative(&options[0]), "1=robot-1");
        assert_eq!(relative(&options[1]), "2=robot-2/a/follower_ 2.c,robot-2/b/x.c");
        assert!(folder.path().join("robot-1/map.h").exists() && !folder.path().join("robot-1/b").exists());
    }
}
