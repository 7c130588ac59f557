//! Finds data files that lie in the folder of a program, although the program opens files in the working folder.

use std::path::{Path, PathBuf};

use super::find::ProgramSource;

/// Maximum size of a source that is searched, in bytes.
const MAX_SOURCE: u64 = 1 << 20;
/// Parts of the names of functions and classes that open files, in C, C++ and Python.
const OPENERS: [&str; 2] = ["open", "fstream"];

/// Remarks on files that a program opens by a literal name, and that are in the folder of its source but not in the
/// working folder.
pub fn remarks(source: &ProgramSource, working_folder: &Path) -> Vec<String> {
    let files = match source {
        ProgramSource::Sources { files, .. } => files.as_slice(),
        ProgramSource::Python(file) => std::slice::from_ref(file),
        ProgramSource::Library(_) | ProgramSource::Cargo(_) | ProgramSource::Embedded(_) => &[],
    };
    files.iter().flat_map(|file| remarks_on(file, working_folder)).collect()
}

fn remarks_on(file: &PathBuf, working_folder: &Path) -> Vec<String> {
    let Some(folder) =
        file.parent().map(|folder| working_folder.join(folder)).filter(|folder| folder != working_folder)
    else {
        return Vec::new();
    };
    let is_small = std::fs::metadata(file).is_ok_and(|metadata| metadata.is_file() && metadata.len() <= MAX_SOURCE);
    let text = if is_small { std::fs::read(file).unwrap_or_default() } else { Vec::new() };
    let text = String::from_utf8_lossy(&text);
    let is_only_beside = |name: &&str| folder.join(name).is_file() && !working_folder.join(name).exists();
    let remark = |name: &str| {
        format!(
            "`{}` opens `{name}`, which lies beside it: programs open files in the folder in which eyesim runs, so run it in `{}`",
            file.file_name().unwrap_or_default().to_string_lossy(),
            folder.canonicalize().unwrap_or_else(|_| folder.clone()).display()
        )
    };
    opened_names(&text).filter(is_only_beside).map(remark).collect()
}

/// String literals in lines that call a function that opens files: the first literal after the function, if any.
fn opened_names(text: &str) -> impl Iterator<Item = &str> {
    text.lines().filter_map(|line| {
        let opener = OPENERS.iter().filter_map(|opener| line.find(opener)).min()?;
        let call = &line[opener..];
        let quote = call.find(['"', '\''])?;
        let rest = &call[quote + 1..];
        let name = &rest[..rest.find(call[quote..].chars().next()?)?];
        (!name.is_empty()).then_some(name)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_opened_files_are_found_in_each_language() {
        let text = "FILE* f = fopen(\"a.txt\", \"r\");\nstd::ifstream in{\"b.txt\"};\nwith open('c.txt') as f:\n\
                    puts(\"d.txt\");\nfopen(name, mode);\nopen(\"\");\nopen(\"unclosed";
        assert_eq!(opened_names(text).collect::<Vec<_>>(), ["a.txt", "b.txt", "c.txt"]);
    }

    #[test]
    fn file_beside_the_program_is_reported_if_the_working_folder_is_another() {
        let folder = tempfile::tempdir().expect("a folder");
        let (lab, elsewhere) = (folder.path().join("lab"), folder.path().join("x"));
        [&lab, &elsewhere].into_iter().for_each(|created| std::fs::create_dir(created).expect("a folder"));
        std::fs::write(lab.join("a.txt"), "1").expect("a file");
        let source = ProgramSource::of_files(vec![lab.join("read.c")]);
        std::fs::write(lab.join("read.c"), "fopen(\"a.txt\", \"r\"); \nfopen(\"b.txt\", \"w\");").expect("a file");
        let messages = remarks(&source, &elsewhere);
        assert!(
            messages.len() == 1 && messages[0].starts_with("`read.c` opens `a.txt`, which lies beside it"),
            "{messages:?}"
        );
        assert_eq!(remarks(&source, &lab), Vec::<String>::new());
        std::fs::write(elsewhere.join("a.txt"), "1").expect("a file");
        assert_eq!(remarks(&source, &elsewhere), Vec::<String>::new());
    }
}
