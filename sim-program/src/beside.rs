//! Finds the C and C++ files beside a program, with the names that each file defines.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use super::calls::calls_of;
use super::code::{code_only, is_name};
use super::language::Language;
use crate::files::read_regular;

/// Maximum number of files that are read.
const MAX_FILES: usize = 200;
/// Maximum size of a file that is read, in bytes.
const MAX_BYTES: u64 = 1 << 20;

/// A file beside a program that is not part of it, and the names that it defines for other files.
#[derive(Debug)]
pub struct FileBeside {
    /// The file's name.
    pub name: String,
    /// The file defines `main`, so it is a program of its own.
    pub is_program: bool,
    definitions: BTreeSet<String>,
}

impl FileBeside {
    /// Returns true if the file defines the function or variable `name`.
    pub fn defines(&self, name: &str) -> bool {
        self.definitions.contains(name)
    }
}

/// The C and C++ files in the folder of the first of `sources` that are not among `sources`, sorted by name.
pub fn files_beside(sources: &[&Path]) -> Vec<FileBeside> {
    let Some(folder) = sources.first().and_then(|source| source.parent()) else { return Vec::new() };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let is_small = |path: &Path| fs::metadata(path).is_ok_and(|file| file.is_file() && file.len() <= MAX_BYTES);
    let mut paths: Vec<PathBuf> = entries
        .filter(|path| Language::of(path).is_some() && !sources.contains(&path.as_path()) && is_small(path))
        .collect();
    paths.sort();
    paths.iter().take(MAX_FILES).filter_map(|path| file_beside(path)).collect()
}

fn file_beside(path: &Path) -> Option<FileBeside> {
    let name = path.file_name()?.to_str()?.to_owned();
    let text = read_regular(path).ok()?;
    let text = String::from_utf8_lossy(&text);
    let mut definitions = calls_of(&text).defined;
    let code = code_only(&text);
    definitions.extend(code.lines().filter_map(defined_variable).map(str::to_owned));
    let statics = code.lines().filter(|line| line.trim_start().starts_with("static "));
    let hidden: BTreeSet<&str> = statics.flat_map(|line| declarator(line).split(|c| !is_name(c))).collect();
    definitions.retain(|name| !hidden.contains(name.as_str()));
    Some(FileBeside { name, is_program: definitions.contains("main"), definitions })
}

/// The part of a declaration before the parameters, the body or the value.
fn declarator(line: &str) -> &str {
    let head = line.split(['=', '{', ';']).next().unwrap_or_default().trim_end();
    let mut depth = 0;
    let opens_parameters = |letter: char| {
        depth += i32::from(letter == ')') - i32::from(letter == '(');
        depth <= 0 && letter == '('
    };
    let start = if head.ends_with(')') { head.rfind(opens_parameters) } else { head.find('(') };
    start.map_or(head, |start| &head[..start])
}

/// The variable that a line of code defines in its first column, such as `int count = 1;`.
fn defined_variable(line: &str) -> Option<&str> {
    let head = line.split(['=', ';', '[']).next()?.trim_end();
    let is_declaration = line.starts_with(|letter: char| letter.is_alphabetic()) && line.contains(['=', ';', '[']);
    let is_other = ["extern", "static", "typedef", "return", "using", "goto"].contains(&head.split(' ').next()?);
    let name = head.rsplit([' ', '*', '&']).next()?;
    let mut words = head.split_whitespace();
    let is_type = ["struct", "union", "enum", "class"].contains(&words.next()?) && words.count() == 1;
    (is_declaration && !is_other && !is_type && !head.contains(['(', ')', '{', '}', ':']) && head != name)
        .then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_beside_a_program_are_searched_for_definitions() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a file");
        write("main.c", "int plan(void);\nint main(void) { return plan(); }\n");
        write(
            "map.c",
            "#include \"map.h\"\nextern int other;\nint count = 1, map[3];\nchar *names[4];\nint plan(void)\n{ int inner; return 1; }\n\
             static int hidden(void) { return 2; }\nstatic int once(void) { return plan(); }\n\
             static __attribute__((noinline)) int far(int count)\n{ return count; }\nstatic int (*handler)(void);\nstruct type;\nstruct type *value;\n",
        );
        write("own.cpp", "int main() {}\nvoid draw() {}\n");
        write("notes.txt", "int draw(void) {}\n");
        let main = folder.path().join("main.c");
        let files = files_beside(&[&main]);
        let names: Vec<(&str, bool)> = files.iter().map(|file| (file.name.as_str(), file.is_program)).collect();
        assert_eq!(names, [("map.c", false), ("own.cpp", true)]);
        for name in ["plan", "count", "names", "value"] {
            assert!(files[0].defines(name), "{name}");
        }
        for name in ["hidden", "other", "inner", "type", "far", "handler"] {
            assert!(!files[0].defines(name), "{name}");
        }
        assert!(files[1].defines("draw"));
    }
}
