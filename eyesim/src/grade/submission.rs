//! Submissions in a folder or archive of a learning system: finds the owner of each, and the files that belong
//! together.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use super::archive::{ArchiveError, Contents, Reader, is_junk, stem_of_archive, stem_of_unsupported_archive};

/// A submission that has been read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Submission {
    /// Name of the student or team as the learning system writes it.
    pub name: String,
    /// Unique name for folders: letters of any script, digits, `-`, `_` and `.`.
    pub folder: String,
    /// Its files, or the reason why it is refused.
    pub contents: Result<Contents, String>,
}

/// Submissions of a folder, and the names of its other files.
#[derive(Debug, Default)]
pub struct Submissions {
    /// The submissions, in the order of their names.
    pub list: Vec<Submission>,
    /// Names of files without an owner.
    pub ignored: Vec<String>,
}

/// Part of a submission.
struct SubmissionPart {
    /// Name under which its files appear.
    name: String,
    /// The same without the number of an attempt.
    short_name: String,
    source: PartSource,
}

/// Place of the files of a part.
enum PartSource {
    /// A file or folder of the disk.
    Disk(PathBuf),
    /// Files of an archive with all submissions, below a folder or file with the name of the part in the archive.
    Files(BTreeMap<String, Vec<u8>>),
}

/// Reads the submissions in `path`: a folder, or an archive of one. Contents are read only for files for which
/// `is_wanted` returns true.
///
/// # Errors
/// The folder or archive as a whole cannot be read.
pub fn read_all(path: &Path, is_wanted: &dyn Fn(&str) -> bool) -> Result<Submissions, ArchiveError> {
    let mut groups: BTreeMap<String, (String, Vec<SubmissionPart>)> = BTreeMap::new();
    let mut ignored = Vec::new();
    let mut add = |entry: FolderEntry, source: PartSource| match owner(&entry, is_wanted) {
        Some(Owner { key, name, file, short_file }) => {
            let part = SubmissionPart { name: file, short_name: short_file, source };
            groups.entry(key).or_insert((name, Vec::new())).1.push(part);
        }
        None if is_junk(&entry.name) => {}
        None => ignored.push(entry.name),
    };
    if path.is_dir() {
        let error = |error| ArchiveError::Io { name: path.display().to_string(), error };
        let mut entries = fs::read_dir(path).map_err(error)?.collect::<Result<Vec<_>, _>>().map_err(error)?;
        entries.sort_by_key(fs::DirEntry::file_name);
        for entry in entries {
            let kind = entry.file_type().map_err(error)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            add(FolderEntry { name, is_folder: kind.is_dir() }, PartSource::Disk(entry.path()));
        }
    } else {
        for (name, (is_folder, files)) in entries_of_archive(path, is_wanted)? {
            add(FolderEntry { name, is_folder }, PartSource::Files(files));
        }
    }
    ignored.sort();
    let mut folders = BTreeMap::new();
    let mut list: Vec<Submission> = Vec::new();
    for (name, parts) in groups.into_values() {
        let base = folder_name(&name);
        let count = folders.entry(base.to_lowercase()).and_modify(|count| *count += 1).or_insert(1);
        let folder = if *count == 1 { base } else { format!("{base}-{count}") };
        list.push(Submission { name, folder, contents: read_parts(parts, is_wanted) });
    }
    list.sort_by(|a, b| (a.name.to_lowercase(), &a.folder).cmp(&(b.name.to_lowercase(), &b.folder)));
    Ok(Submissions { list, ignored })
}

/// Reads one submission: the file, archive or folder `path` as a whole.
pub fn read_one(path: &Path, name: &str, is_wanted: &dyn Fn(&str) -> bool) -> Submission {
    let file = if path.is_dir() { String::new() } else { name_of(path) };
    let source = PartSource::Disk(path.to_owned());
    let contents = read_parts(vec![SubmissionPart { name: file.clone(), short_name: file, source }], is_wanted);
    Submission { name: name.to_owned(), folder: folder_name(name), contents }
}

fn read_parts(mut parts: Vec<SubmissionPart>, is_wanted: &dyn Fn(&str) -> bool) -> Result<Contents, String> {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    parts.iter().for_each(|part| *counts.entry(part.short_name.clone()).or_default() += 1);
    for part in &mut parts {
        // Files that only their numbers distinguish are not attempts at one file.
        if counts[&part.short_name] == 1 {
            part.name.clone_from(&part.short_name);
        }
    }
    parts.sort_by(|a, b| a.name.cmp(&b.name));
    let mut reader = Reader::new(is_wanted);
    for SubmissionPart { name, source, .. } in parts {
        let read = match source {
            PartSource::Disk(path) => reader.read_path(&path, &name),
            PartSource::Files(files) => files.into_iter().try_for_each(|(path, bytes)| {
                let path = path.split_once('/').map_or(name.clone(), |(_, rest)| format!("{name}/{rest}"));
                reader.read_file(&path, bytes, 0)
            }),
        };
        read.map_err(|error| format!("the submission is refused: {error}"))?;
    }
    Ok(without_common_folders(reader.into_contents()))
}

/// Entries of an archive by their names: whether each is a folder, and its files by their paths.
type Entries = BTreeMap<String, (bool, BTreeMap<String, Vec<u8>>)>;

/// Entries of an archive with all submissions.
fn entries_of_archive(path: &Path, is_wanted: &dyn Fn(&str) -> bool) -> Result<Entries, ArchiveError> {
    let mut reader = Reader::of_class(is_wanted);
    reader.read_path(path, &name_of(path))?;
    let mut entries = Entries::new();
    // The first folder is named after the archive.
    let without_archive = |(path, bytes): (String, Vec<u8>)| Some((path.split_once('/')?.1.to_owned(), bytes));
    let mut files: Vec<(String, Vec<u8>)> =
        reader.into_contents().files.into_iter().filter_map(without_archive).collect();
    files.retain(|(path, _)| path != ".");
    // A folder around all submissions is not a submission itself.
    while let Some(folder) = common_folder(files.iter().map(|(path, _)| path.as_str()), is_wanted) {
        let skip = folder.len() + 1;
        for (path, _) in &mut files {
            if path.contains('/') {
                path.drain(..skip);
            }
        }
        files.retain(|(path, _)| path != ".");
    }
    for (path, bytes) in files {
        let (first, is_folder) = path.split_once('/').map_or((path.as_str(), false), |(first, _)| (first, true));
        let entry = entries.entry(first.to_owned()).or_insert((is_folder, BTreeMap::new()));
        entry.1.insert(path.clone(), bytes);
    }
    Ok(entries)
}

/// The only folder of an archive with these paths, if all submissions are in it. Files without an owner do not matter.
fn common_folder<'p>(paths: impl Iterator<Item = &'p str>, is_wanted: &dyn Fn(&str) -> bool) -> Option<String> {
    let file = |name: &str| FolderEntry { name: name.to_owned(), is_folder: false };
    let mut common = None;
    for path in paths {
        let Some((folder, rest)) = path.split_once('/') else {
            if owner(&file(path), is_wanted).is_some() {
                return None;
            }
            continue;
        };
        let is_submission =
            rest.contains('/') || stem_of_archive(rest).is_some() || owner_by_system(&file(rest)).is_some();
        if !is_submission && owner(&file(rest), is_wanted).is_some() {
            return None;
        }
        let (known, has_submission) = common.get_or_insert((folder, false));
        if *known != folder {
            return None;
        }
        *has_submission |= is_submission;
    }
    let (folder, has_submission) = common?;
    let is_of_student = owner_by_system(&FolderEntry { name: folder.to_owned(), is_folder: true }).is_some();
    (has_submission && !is_of_student).then(|| folder.to_owned())
}

fn name_of(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// Entry of the folder with all submissions.
struct FolderEntry {
    name: String,
    is_folder: bool,
}

/// Owner of an entry, found in its name.
#[derive(Debug, PartialEq, Eq)]
struct Owner {
    /// Entries with the same key belong together.
    key: String,
    name: String,
    /// Name of the entry without its owner's name.
    file: String,
    /// The same without the number of an attempt.
    short_file: String,
}

impl Owner {
    fn new(key: &str, name: &str, file: &str) -> Self {
        Self { key: key.to_owned(), name: name.trim().to_owned(), file: file.to_owned(), short_file: file.to_owned() }
    }
}

/// Owner of an entry whose name is by the scheme of a learning system.
///
/// Sources: files as downloaded from Moodle (`Name_12345_assignsubmission_file_...`), Canvas
/// (`name_LATE_123_456_file.c`, `file-1.c` for a second attempt) and Blackboard
/// (`Lab_user_attempt_2024-03-01-12-00-00_file.c`).
fn owner_by_system(entry: &FolderEntry) -> Option<Owner> {
    let name = entry.name.as_str();
    if let Some((student, rest)) = name.split_once("_assignsubmission_") {
        let student_name = student.rsplit_once('_').filter(|(_, id)| is_number(id)).map_or(student, |(name, _)| name);
        let file = rest.split_once('_').map_or("", |(_, file)| file);
        return Some(Owner::new(student, student_name, file));
    }
    if entry.is_folder {
        return None;
    }
    let words: Vec<&str> = name.split('_').collect();
    if let [student, rest @ ..] = words.as_slice() {
        let rest = if rest.first() == Some(&"LATE") { &rest[1..] } else { rest };
        if let [user, submission, file @ ..] = rest
            && is_number(user)
            && is_number(submission)
            && !file.is_empty()
        {
            let file = file.join("_");
            let owner = Owner::new(&format!("{student}_{user}"), student, &file);
            return Some(Owner { short_file: without_attempt(&file), ..owner });
        }
    }
    let (before, after) = name.split_once("_attempt_")?;
    let user = before.rsplit('_').next().unwrap_or(before);
    let file = after.split_once('_').map_or("", |(_, file)| file);
    Some(Owner::new(user, user, file))
}

/// Owner of an entry; `None` for a file that is not a submission.
fn owner(entry: &FolderEntry, is_wanted: &dyn Fn(&str) -> bool) -> Option<Owner> {
    let name = entry.name.as_str();
    if is_junk(name) || name.starts_with('.') {
        return None;
    }
    if let Some(owner) = owner_by_system(entry) {
        return Some(owner);
    }
    let is_archive = !entry.is_folder && stem_of_archive(name).is_some();
    let found = |key: &str, name: &str, file: &str| Some(Owner::new(key, name, file));
    if entry.is_folder {
        return found(&format!("{name}/"), name, "");
    }
    if is_archive {
        let stem = stem_of_archive(name).unwrap_or(name);
        return found(name, stem, name);
    }
    // Sources and headers with the same stem belong to one owner.
    if is_wanted(name) {
        let stem = Path::new(name).file_stem().map_or(name.into(), std::ffi::OsStr::to_string_lossy);
        return found(&stem, &stem, name);
    }
    // An unsupported archive belongs to a submission, so that its owner learns that it cannot be read.
    found(name, stem_of_unsupported_archive(name)?, name)
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit())
}

/// `solve.c` for `solve-1.c`, the name that Canvas assigns to a second attempt.
fn without_attempt(file: &str) -> String {
    let split = || {
        let (stem, ending) = file.split_once('.')?;
        let (first_stem, attempt) = stem.rsplit_once('-')?;
        (is_number(attempt) && !first_stem.is_empty()).then(|| format!("{first_stem}.{ending}"))
    };
    split().unwrap_or_else(|| file.to_owned())
}

/// A name for a folder: letters of any script, digits, `-`, `_` and `.`.
fn folder_name(name: &str) -> String {
    const MAX_CHARACTERS: usize = 60;
    let sanitized = |c: char| if c.is_alphanumeric() || matches!(c, '-' | '_' | '.') { c } else { '_' };
    let text: String = name.trim().chars().take(MAX_CHARACTERS).map(sanitized).collect();
    let text = text.trim_matches(['.', '_']);
    if text.is_empty() { "unnamed".to_owned() } else { text.to_owned() }
}

/// Removes the folders that are common to all files.
fn without_common_folders(contents: Contents) -> Contents {
    let Contents { files, notes } = contents;
    let mut folders = files.keys().map(|path| path.rsplit_once('/').map_or("", |(folder, _)| folder));
    let first = folders.next().unwrap_or_default();
    let shared = folders.fold(first.split('/').collect::<Vec<_>>(), |shared, folder| {
        shared.into_iter().zip(folder.split('/')).take_while(|(a, b)| a == b).map(|(a, _)| a).collect()
    });
    let skip = shared.iter().filter(|part| !part.is_empty()).map(|part| part.len() + 1).sum::<usize>();
    // A path that began with a slash has an empty part.
    let shortened = |(path, bytes): (&String, &Vec<u8>)| (path[skip.min(path.len())..].to_owned(), bytes.clone());
    Contents { files: files.iter().map(shortened).collect(), notes }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(entry: &str, is_folder: bool, expected: Option<(&str, &str, &str)>) {
        let is_wanted = |path: &str| path.ends_with(".c") || path.ends_with(".h");
        let found = owner(&FolderEntry { name: entry.to_owned(), is_folder }, &is_wanted);
        let found = found.as_ref().map(|owner| (owner.key.as_str(), owner.name.as_str(), owner.short_file.as_str()));
        assert_eq!(found, expected, "{entry}");
    }

    #[test]
    fn owners_are_found_in_names_of_learning_systems() {
        check(
            "Ana María Núñez_12345_assignsubmission_file_",
            true,
            Some(("Ana María Núñez_12345", "Ana María Núñez", "")),
        );
        check("王小明_77_assignsubmission_file_lab 1.zip", false, Some(("王小明_77", "王小明", "lab 1.zip")));
        check("nunezana_LATE_123_4567_solve_it-2.c", false, Some(("nunezana_123", "nunezana", "solve_it.c")));
        check("nunezana_123_4567_map.h", false, Some(("nunezana_123", "nunezana", "map.h")));
        check("Lab 1_u22_attempt_2024-03-01-12-00-00_solve.c", false, Some(("u22", "u22", "solve.c")));
        check("submission_9911", true, Some(("submission_9911/", "submission_9911", "")));
        check("group 7.tar.gz", false, Some(("group 7.tar.gz", "group 7", "group 7.tar.gz")));
        check("ali.c", false, Some(("ali", "ali", "ali.c")));
        check("ali.h", false, Some(("ali", "ali", "ali.h")));
        check("old.rar", false, Some(("old.rar", "old", "old.rar")));
        check("README.txt", false, None);
        check("__MACOSX", true, None);
        check(".hidden", true, None);
    }

    #[test]
    fn folder_names_are_sanitized() {
        for (name, folder) in [
            ("Ana María", "Ana_María"),
            ("../../etc", "etc"),
            ("<b>x</b>", "b_x__b"),
            ("\u{1b}[31m", "31m"),
            ("...", "unnamed"),
            ("=SUM(A1)", "SUM_A1"),
        ] {
            assert_eq!(folder_name(name), folder);
        }
    }

    #[test]
    fn common_folders_are_removed() {
        let files = |paths: &[&str]| paths.iter().map(|path| ((*path).to_owned(), Vec::new())).collect();
        let check = |paths: &[&str], expected: &[&str]| {
            let found = without_common_folders(Contents { files: files(paths), notes: Vec::new() });
            assert_eq!(found.files, files(expected));
        };
        check(&["x/lab/a.c", "x/lab/lib/b.h"], &["a.c", "lib/b.h"]);
        check(&["x/a.c", "y/a.c"], &["x/a.c", "y/a.c"]);
        check(&["a.c"], &["a.c"]);
        check(&["x/ab/a.c", "x/abc/a.c"], &["ab/a.c", "abc/a.c"]);
        check(&[], &[]);
    }

    #[test]
    fn submissions_of_a_folder_are_read() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |name: &str| {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            fs::write(path, name).expect("a file");
        };
        for name in [
            "Zoë_1_assignsubmission_file_/lab/a.c",
            "Zoë_2_assignsubmission_file_/a.c",
            "bob_1_2_a.c",
            "bob_1_3_map-1.h",
            "bob_1_4_part-1.c",
            "bob_1_5_part-2.c",
            "Lab_u1_attempt_2024-03-01-12-00-00_a.c",
            "Lab_u1_attempt_2024-03-02-12-00-00_a.c",
            "single.c",
            "notes.txt",
        ] {
            write(name);
        }
        std::os::unix::fs::symlink("/etc/passwd", folder.path().join("link.c")).expect("a link");
        let is_wanted = |path: &str| path.ends_with(".c") || path.ends_with(".h");
        let found = read_all(folder.path(), &is_wanted).expect("submissions");
        let list: Vec<(&str, &str, Vec<&str>)> = found
            .list
            .iter()
            .map(|submission| {
                let contents = submission.contents.as_ref().expect("files");
                let files = contents.files.keys().map(String::as_str).collect();
                (submission.name.as_str(), submission.folder.as_str(), files)
            })
            .collect();
        assert_eq!(
            list,
            [
                ("bob", "bob", vec!["a.c", "map.h", "part-1.c", "part-2.c"]),
                ("link", "link", vec![]),
                ("single", "single", vec!["single.c"]),
                ("u1", "u1", vec!["a.c", "version 2/a.c"]),
                ("Zoë", "Zoë", vec!["a.c"]),
                ("Zoë", "Zoë-2", vec!["a.c"]),
            ]
        );
        assert_eq!(found.ignored, ["notes.txt"]);
    }

    #[test]
    fn folders_around_all_submissions_are_found() {
        let is_wanted = |path: &str| path.ends_with(".c") || path.ends_with(".h");
        let check = |paths: &[&str], expected: Option<&str>| {
            assert_eq!(common_folder(paths.iter().copied(), &is_wanted).as_deref(), expected, "{paths:?}");
        };
        check(&["Lab/ana/a.c", "Lab/bob.zip"], Some("Lab"));
        check(&["README.txt", "Lab/README.txt", "Lab/ana/a.c"], Some("Lab"));
        check(&["Lab/ana_1_2_a.c", "Lab/Lab_u22_attempt_2024-03-01-12-00-00_a.c"], Some("Lab"));
        check(&["Lab/ana/a.c", "bob.c"], None);
        check(&["Lab/ana/a.c", "Other/a.c"], None);
        check(&["ana/a.c", "ana/src/b.c"], None);
        check(&["ana/essay.txt"], None);
        check(&["Ana_1_assignsubmission_file_/lab.zip"], None);
        check(&["README.txt"], None);
    }
}
