//! Finds the parts of a program: headers that a C source includes and modules that a Python program imports.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::calls::included_file;
use super::files::read_regular;
use super::find::is_python;

/// Files that the source `program` includes or imports, directly or indirectly, from the folder of the file that names
/// them or from its own folder. Headers that a macro names or that the compiler finds elsewhere are missing.
pub fn parts_of(program: &Path) -> Vec<PathBuf> {
    let own_folder = program.parent().unwrap_or(Path::new(""));
    let mut parts = Vec::new();
    let mut seen = BTreeSet::from_iter(program.canonicalize());
    let mut pending = vec![program.to_owned()];
    while let Some(path) = pending.pop() {
        let Ok(bytes) = read_regular(&path) else { continue };
        // Modules of a package import each other from the folder of the program.
        let folders = BTreeSet::from([path.parent().unwrap_or(Path::new("")), own_folder]);
        for name in referenced_files(&path, &String::from_utf8_lossy(&bytes)) {
            let candidates = folders.iter().map(|folder| folder.join(&name)).filter(|file| file.is_file());
            pending.extend(candidates.filter(|file| file.canonicalize().is_ok_and(|file| seen.insert(file))));
        }
        if path != program {
            parts.push(path);
        }
    }
    parts
}

/// Names of the files that a C source may include or that a Python program may import.
fn referenced_files(path: &Path, text: &str) -> Vec<String> {
    if is_python(path) {
        let files = |module: String| [".py", "/__init__.py"].map(|end| module.clone() + end);
        return modules(text).into_iter().flat_map(files).collect();
    }
    text.lines().filter_map(included_file).map(str::to_owned).collect()
}

/// Paths without extension of the modules that a Python program may import: `a/b` for `import a.b` and for
/// `from a import b`, and the packages around them.
fn modules(text: &str) -> Vec<String> {
    let mut modules = Vec::new();
    let mut statement = String::new();
    for line in text.lines() {
        let line = line.split('#').next().unwrap_or_default().trim();
        statement.push_str(line.trim_end_matches('\\'));
        statement.push(' ');
        let is_import = statement.starts_with("from ") && statement.contains(" import");
        let is_open = is_import && statement.contains('(') && !statement.contains(')');
        if is_open || line.ends_with('\\') {
            continue;
        }
        for statement in std::mem::take(&mut statement).split(';').map(str::trim) {
            let from = statement.strip_prefix("from ").and_then(|rest| rest.split_once(" import"));
            let Some((package, names)) = from.or_else(|| Some(("", statement.strip_prefix("import ")?))) else {
                continue;
            };
            let name = package.trim().trim_start_matches('.');
            let up = "../".repeat((package.trim().len() - name.len()).saturating_sub(1));
            for imported in names.split([',', '(', ')']).filter_map(|name| name.split_whitespace().next()) {
                let parts = name.split('.').chain(imported.split('.')).filter(|part| !part.is_empty());
                let mut path = up.clone();
                for part in parts {
                    path.push_str(part);
                    modules.push(path.clone());
                    path.push('/');
                }
            }
        }
    }
    modules
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modules_of_all_forms_of_imports_are_found() {
        let check = |text: &str, expected: &[&str]| assert_eq!(modules(text), expected, "{text}");
        check("import h1, h2 as h3; import a.b  # import c", &["h1", "h2", "a", "a/b"]);
        check("from pkg import m, n as o", &["pkg", "pkg/m", "pkg", "pkg/n"]);
        check("  from .m import *\nfrom .. import (\n    x,  # one\n    y,\n)", &["m", "m/*", "../x", "../y"]);
        check("from a import \\\n    b\nprint('import c')", &["a", "a/b"]);
    }

    #[test]
    fn parts_are_found_once_and_in_circles() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |name: &str, text: &str| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            std::fs::write(&path, text).expect("a file");
            path
        };
        let program =
            write("lab/walk.c", "#include \"../common/a.h\"\n# include \"own.h\" // own\n#include <stdio.h>\n");
        write("common/a.h", "#include \"b.h\"\n#include \"../lab/walk.c\"\n");
        write("common/b.h", "#include \"../common/a.h\"\n#include \"own.h\"\n#include \"missing.h\"\n");
        write("lab/own.h", "");
        let names = |program: &Path| {
            let parts = parts_of(program).into_iter();
            parts.map(|part| part.file_name().expect("a name").to_string_lossy().into_owned()).collect::<BTreeSet<_>>()
        };
        assert_eq!(names(&program), BTreeSet::from(["a.h", "b.h", "own.h"].map(str::to_owned)));
        let program = write("py/walk.py", "from pkg.m import x\nimport os\n");
        write("py/pkg/__init__.py", "");
        write("py/pkg/m.py", "import helper\n");
        write("py/helper.py", "import walk\n");
        assert_eq!(names(&program), BTreeSet::from(["__init__.py", "m.py", "helper.py"].map(str::to_owned)));
    }
}
