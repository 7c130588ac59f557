//! References to other files: syntax and search paths.

use super::code::Code;
use super::diagnostic::{Severity, Sink};
use super::line::{self, Word};
use super::spec::SpannedText;
pub use sim_core::spec::{file_name, stem};

/// Placeholder for the installation's folder at the beginning of a path.
const INSTALLATION: &str = "%sim%";

/// Folders of the installation that are searched last.
const INSTALLATION_FOLDERS: [&str; 3] = ["", "worlds", "robis"];

/// Paths at which the file named `text` is searched for, in order.
///
/// `folder` is the folder of the referring file, `home` the installation's folder. Backslashes are read as slashes.
/// - A path that begins with `%sim%` is searched only in the installation.
/// - Any other relative path is searched in `folder`, in the working folder, in the installation and in its folders
///   `worlds` and `robis`.
/// - An absolute path is tried as it is. One that begins with `/` is then tried below the installation, since old files
///   contain such paths.
///
/// Source: files of the EyeSim versions. Our choice: `folder` precedes the working folder, so that a scene does not
/// depend on the directory from which it is run. A `..` removes the part before it, even if that part is a link.
pub fn candidates(text: &str, folder: &str, home: Option<&str>) -> Vec<String> {
    let text = text.replace('\\', "/");
    let mut paths = Vec::new();
    if let Some(rest) = strip_installation(&text) {
        paths.extend(home.map(|home| join(home, rest)));
    } else if is_absolute(&text) {
        paths.push(normalised(&text));
        if text.starts_with('/') {
            paths.extend(home.map(|home| join(home, &text)));
        }
    } else {
        paths.push(join(folder, &text));
        paths.push(normalised(&text));
        paths.extend(home.iter().flat_map(|home| INSTALLATION_FOLDERS.map(|folder| join(&join(home, folder), &text))));
    }
    let mut unique: Vec<String> = Vec::new();
    for path in paths {
        if !unique.contains(&path) {
            unique.push(path);
        }
    }
    unique
}

/// Maximum number of parts of a path that are searched elsewhere, so that a senseless path does not take long.
const MAX_PARTS: usize = 32;

/// Candidates for an absolute path `text` from another machine, or for a relative path that leads through other
/// folders, as in `../worlds/a.wld`; empty for a bare file name and for a path that begins with `%sim%`.
///
/// Each suffix of the path, the longest first, is searched below `folder`, below the two folders above `folder`, and
/// below the installation and its folders `worlds` and `robis`. The bare file name is not searched for in the folders
/// above.
pub fn relocated_candidates(text: &str, folder: &str, home: Option<&str>) -> Vec<String> {
    let text = text.replace('\\', "/");
    let is_step = |part: &&str| !["", ".", ".."].contains(part);
    let parts: Vec<&str> = text.split('/').filter(is_step).collect();
    if !is_absolute(&text) && (!text.contains('/') || strip_installation(&text).is_some()) {
        return Vec::new();
    }
    let above = ["..", "../.."].map(|up| join(folder, up));
    let mut paths: Vec<String> = Vec::new();
    for first in parts.len().saturating_sub(MAX_PARTS)..parts.len() {
        let suffix = parts[first..].join("/");
        paths.push(join(folder, &suffix));
        if first + 1 < parts.len() {
            paths.extend(above.iter().map(|folder| join(folder, &suffix)));
        }
        paths
            .extend(home.iter().flat_map(|home| INSTALLATION_FOLDERS.map(|folder| join(&join(home, folder), &suffix))));
    }
    paths
}

/// Folder part of a path; empty for the working folder.
pub fn folder_of(path: &str) -> &str {
    match path.rfind('/') {
        Some(0) => "/",
        Some(end) => &path[..end],
        None => "",
    }
}

/// Extensions, in lower case, that determine the kind of a file even with `.txt` after them, which editors and mail
/// programs add.
const KINDS: [&str; 8] = ["sim", "wld", "maz", "maze", "robi", "esobj", "toml", "num"];

/// Extension of a path in lower case, without the dot; empty if it has none. That of `a.wld.txt` is `wld`.
pub fn extension(path: &str) -> String {
    let name = file_name(without_txt(path));
    name.rfind('.').map_or(String::new(), |dot| name[dot + 1..].to_lowercase())
}

/// The path without a `.txt` that follows another extension: `a.wld` for `a.wld.txt`.
fn without_txt(path: &str) -> &str {
    let Some((rest, _)) = path.rsplit_once('.').filter(|(_, last)| last.eq_ignore_ascii_case("txt")) else {
        return path;
    };
    let has_kind = |(_, inner): (&str, &str)| KINDS.iter().any(|kind| kind.eq_ignore_ascii_case(inner));
    if file_name(rest).rsplit_once('.').is_some_and(has_kind) { rest } else { path }
}

/// The path of the file `path` that was saved with `.txt` after its extension; `None` for extensions to which this does
/// not happen.
pub(super) fn with_txt(path: &str) -> Option<String> {
    KINDS.contains(&extension(path).as_str()).then(|| format!("{path}.txt"))
}

/// Returns true if the file `found` for the reference `text` in `folder` is one of the installation `home`, although
/// `text` is relative and `folder` is outside of the installation.
pub(super) fn is_from_installation(text: &str, folder: &str, found: &str, home: Option<&str>) -> bool {
    let text = text.replace('\\', "/");
    if strip_installation(&text).is_some() || is_absolute(&text) {
        return false;
    }
    let home = home.map(|home| join(home, ""));
    let is_in_home = |path: &str| {
        let rest = home.as_deref().and_then(|home| path.strip_prefix(home));
        rest.is_some_and(|rest| rest.starts_with('/'))
    };
    is_in_home(found) && !is_in_home(&join(folder, &text)) && found != normalised(&text)
}

/// The path with another extension: `robis/S4.robi` with `toml` is `robis/S4.toml`.
pub fn with_extension(path: &str, extension: &str) -> String {
    let path = without_txt(path);
    format!("{}{}.{extension}", &path[..path.len() - file_name(path).len()], stem(path))
}

/// The `path` relative to `folder`, if both are relative or both absolute: `../worlds/a.wld`. Otherwise the path
/// unchanged.
pub(super) fn relative(folder: &str, path: &str) -> String {
    if is_absolute(folder) != is_absolute(path) {
        return path.to_owned();
    }
    let folder_parts: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
    let path_parts: Vec<&str> = path.split('/').filter(|part| !part.is_empty()).collect();
    let shared = folder_parts.iter().zip(&path_parts).take_while(|(a, b)| a == b).count();
    // The name of a folder above the working folder is unknown here.
    if folder_parts[shared..].contains(&"..") {
        return path.to_owned();
    }
    let up = folder_parts[shared..].iter().map(|_| "..");
    up.chain(path_parts[shared..].iter().copied()).collect::<Vec<_>>().join("/")
}

/// The reference `text` in a file in the folder `from`, as a file in the folder `to` states it. Absolute paths and
/// paths that begin with `%sim%` do not change.
pub(super) fn moved(text: &str, from: &str, to: &str) -> String {
    let slashed = text.replace('\\', "/");
    if is_absolute(&slashed) || strip_installation(&slashed).is_some() {
        return text.to_owned();
    }
    relative(to, &join(from, &slashed))
}

fn strip_installation(text: &str) -> Option<&str> {
    let prefix = text.get(..INSTALLATION.len())?;
    prefix.eq_ignore_ascii_case(INSTALLATION).then(|| text[INSTALLATION.len()..].trim_start_matches('/'))
}

/// Returns true for `/NAME` and `C:/NAME`.
pub fn is_absolute(text: &str) -> bool {
    let bytes = text.as_bytes();
    text.starts_with('/') || bytes.len() > 2 && bytes[0].is_ascii_alphabetic() && &bytes[1..3] == b":/"
}

/// Path of `text` below `folder`.
pub(super) fn join(folder: &str, text: &str) -> String {
    let text = text.trim_start_matches('/');
    match folder {
        "" => normalised(text),
        "/" => normalised(&format!("/{text}")),
        folder => normalised(&format!("{folder}/{text}")),
    }
}

/// Path without `.` parts and double slashes, with `..` resolved textually.
fn normalised(path: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|last| *last != "..") => {
                parts.pop();
            }
            ".." if path.starts_with('/') && parts.is_empty() => {}
            part => parts.push(part),
        }
    }
    let root = if path.starts_with('/') { "/" } else { "" };
    format!("{root}{}", parts.join("/"))
}

/// Reads the single file reference on a keyword's line.
pub(super) fn reference(
    sink: &mut Sink,
    severity: Severity,
    keyword: &Word<'_>,
    rest: &[Word<'_>],
    syntax: &str,
) -> Option<SpannedText> {
    let Some((word, extra)) = rest.split_first() else {
        sink.report(severity, Code::FileNameMissing, keyword.span, format!("`{}` names no file", keyword.text), syntax);
        return None;
    };
    if let Some(extra) = extra.first() {
        let message = format!("`{}` is left over after the file name", extra.text);
        let diagnostic = sink.warn(Code::WordExtra, extra.span, message, syntax);
        let quotes = || "put a file name with blanks between double quotes".to_owned();
        diagnostic.suggestion = line::comment_hint(extra.text).or_else(|| Some(quotes()));
    }
    file_reference(sink, severity, word, syntax)
}

/// Reads `word` as a file reference.
pub(super) fn file_reference(
    sink: &mut Sink,
    severity: Severity,
    word: &Word<'_>,
    syntax: &str,
) -> Option<SpannedText> {
    if word.is_unclosed {
        sink.warn(
            Code::QuoteUnclosed,
            word.span,
            "a quotation mark is not closed",
            "the same mark at the end of the name",
        );
    }
    if word.text.trim().is_empty() {
        sink.report(severity, Code::FileNameMissing, word.span, "the file name is empty", syntax);
        return None;
    }
    Some(SpannedText { text: word.text.to_owned(), span: word.span })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relative_names_are_tried_beside_the_file_first() {
        let paths = candidates(r"..\worlds\a.wld", "sims/x", Some("/opt/eyesim"));
        let expected = ["sims/worlds/a.wld", "../worlds/a.wld", "/opt/worlds/a.wld", "/opt/eyesim/worlds/a.wld"];
        assert_eq!(paths, expected);
    }

    #[test]
    fn the_installation_replaces_sim() {
        assert_eq!(candidates("%sim%/worlds/a.wld", "x", Some("/opt/e")), ["/opt/e/worlds/a.wld"]);
        assert_eq!(candidates("%SIM%\\a.wld", "x", Some("../e")), ["../e/a.wld"]);
        assert!(candidates("%sim%/a.wld", "x", None).is_empty());
    }

    #[test]
    fn absolute_paths_are_also_tried_below_the_installation() {
        assert_eq!(candidates("/worlds/a.wld", "x", Some("/opt/e")), ["/worlds/a.wld", "/opt/e/worlds/a.wld"]);
        assert_eq!(candidates(r"C:\e\a.wld", "x", Some("/opt/e")), ["C:/e/a.wld"]);
    }

    #[test]
    fn paths_of_another_machine_are_searched_by_suffixes() {
        let paths = relocated_candidates(r"C:\eyesim\signs\stop.esObj", "a/sims", Some("/opt/e"));
        let expected = [
            "a/sims/signs/stop.esObj",
            "a/signs/stop.esObj",
            "signs/stop.esObj",
            "/opt/e/signs/stop.esObj",
            "/opt/e/worlds/signs/stop.esObj",
            "/opt/e/robis/signs/stop.esObj",
            "a/sims/stop.esObj",
            "/opt/e/stop.esObj",
            "/opt/e/worlds/stop.esObj",
            "/opt/e/robis/stop.esObj",
        ];
        assert_eq!(paths[paths.len() - expected.len()..], expected);
        assert_eq!(paths[0], "a/sims/C:/eyesim/signs/stop.esObj");
        let relative = relocated_candidates("../../worlds/small/a.wld", "sims", None);
        assert_eq!(
            relative,
            [
                "sims/worlds/small/a.wld",
                "worlds/small/a.wld",
                "../worlds/small/a.wld",
                "sims/small/a.wld",
                "small/a.wld",
                "../small/a.wld",
                "sims/a.wld"
            ]
        );
        assert_eq!(relocated_candidates("stop.esObj", "a", Some("/opt/e")), [""; 0]);
        assert_eq!(relocated_candidates("%sim%/stop.esObj", "a", Some("/opt/e")), [""; 0]);
    }

    #[test]
    fn paths_are_split() {
        assert_eq!((folder_of("a/b.c"), file_name(r"a\b.c"), stem("a/b.x.c"), stem(".x")), ("a", "b.c", "b.x", ".x"));
        assert_eq!((folder_of("b"), folder_of("/b")), ("", "/"));
        assert_eq!(with_extension("r.x/S4.robi", "toml"), "r.x/S4.toml");
        assert_eq!(with_extension("S4.robi.txt", "toml"), "S4.toml");
        let is_foreign = |found| is_from_installation("a.wld", "x", found, Some("/opt/e"));
        assert_eq!(["/opt/e/worlds/a.wld", "/opt/e2/a.wld", "a.wld"].map(is_foreign), [true, false, false]);
        let extensions = ["a.WLD.txt", "a.b/c.txt", "a.sim.TXT", "a.b.txt", "wld.txt"].map(extension);
        assert_eq!(extensions, ["wld", "txt", "sim", "txt", "txt"]);
        assert_eq!((with_txt("x/a.wld"), with_txt("a.png")), (Some("x/a.wld.txt".to_owned()), None));
        assert_eq!(normalised("../../a/./b//../c"), "../../a/c");
        assert_eq!(normalised("/../a"), "/a");
    }
}
