//! Advice on headers that the compiler does not find: those of libraries, and those that lie in another folder.

use std::fs;
use std::path::Path;

/// A library whose headers programs include: beginnings of their names, its name, its package in Debian, and the flags
/// for `$EYESIM_CFLAGS`.
struct Library {
    headers: &'static [&'static str],
    name: &'static str,
    package: &'static str,
    flags: &'static str,
}

const LIBRARIES: [Library; 9] = [
    Library {
        headers: &["opencv2/", "opencv/", "cv.h", "cxcore.h", "highgui.h"],
        name: "OpenCV",
        package: "libopencv-dev",
        flags: "$(pkg-config --cflags --libs opencv4)",
    },
    Library { headers: &["floatfann.h"], name: "FANN", package: "libfann-dev", flags: "-lfloatfann" },
    Library { headers: &["doublefann.h"], name: "FANN", package: "libfann-dev", flags: "-ldoublefann" },
    Library { headers: &["fann.h", "fann_cpp.h"], name: "FANN", package: "libfann-dev", flags: "-lfann" },
    Library { headers: &["gsl/"], name: "GSL", package: "libgsl-dev", flags: "-lgsl -lgslcblas" },
    Library { headers: &["png.h"], name: "libpng", package: "libpng-dev", flags: "-lpng" },
    Library { headers: &["jpeglib.h"], name: "libjpeg", package: "libjpeg-dev", flags: "-ljpeg" },
    Library { headers: &["Eigen/"], name: "Eigen", package: "libeigen3-dev", flags: "-I/usr/include/eigen3" },
    Library { headers: &["boost/"], name: "Boost", package: "libboost-dev", flags: "" },
];

/// Maximum depth of the folders below a program's folder in which a header is searched.
const MAX_DEPTH: usize = 3;
/// Maximum number of files and folders that are visited.
const MAX_ENTRIES: usize = 2000;

/// Advice on the header `missing` of a library, as the text after the source's name.
pub fn library_hint(missing: &str) -> Option<String> {
    let is_of = |library: &&Library| library.headers.iter().any(|header| missing.starts_with(header));
    let Library { name, package, flags, .. } = LIBRARIES.iter().find(is_of)?;
    let flags = if flags.is_empty() { String::new() } else { format!(", and run with `EYESIM_CFLAGS=\"{flags}\"`") };
    Some(format!(
        ": `{missing}` belongs to {name}, which is no part of eyesim: install it (Debian: `apt install {package}`){flags}"
    ))
}

/// Advice on a file like `missing` in the folder of `source` or below it, as the text after the source's name: one with
/// the same name in another folder, or with a name in other case.
pub fn nearby_hint(missing: &str, source: &Path) -> Option<String> {
    let name = missing.rsplit(['/', '\\']).next().filter(|name| !name.is_empty())?;
    let found = find_below(source.parent()?, name)?;
    if found == missing {
        return Some(format!(": `{missing}` is in the program's folder: write `#include \"{missing}\"`, with quotes"));
    }
    let reason = if missing.eq_ignore_ascii_case(&found) { " (upper and lower case differ)" } else { "" };
    Some(format!(": there is no `{missing}`, but `{found}`: write `#include \"{found}\"`{reason}"))
}

/// Searches for a file `name`, in any case, in `root` and the folders below it. Returns the path relative to `root`;
/// among several files, of the nearest one, and at equal depth of the first by name. `None` also if there are more than
/// [`MAX_ENTRIES`] files and folders to visit.
fn find_below(root: &Path, name: &str) -> Option<String> {
    let mut visited = 0;
    // Paths of folders relative to `root`, with a slash at the end.
    let mut folders = vec![String::new()];
    for _depth in 0..=MAX_DEPTH {
        let mut deeper = Vec::new();
        for folder in folders {
            let path = root.join(&folder);
            let entries = fs::read_dir(&path).into_iter().flatten().flatten().take(MAX_ENTRIES + 1 - visited);
            let mut names: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
            visited += names.len();
            if visited > MAX_ENTRIES {
                return None;
            }
            names.sort_unstable();
            let is_file = |found: &&String| found.eq_ignore_ascii_case(name) && path.join(found.as_str()).is_file();
            // A name in the same case precedes others.
            let exact = names.iter().filter(|found| *found == name).find(is_file);
            if let Some(found) = exact.or_else(|| names.iter().find(is_file)) {
                return Some(format!("{folder}{found}"));
            }
            let is_folder = |path: &Path| path.is_dir() && !path.is_symlink();
            let below = names.iter().filter(|name| !name.starts_with('.') && is_folder(&path.join(name.as_str())));
            deeper.extend(below.map(|name| format!("{folder}{name}/")));
        }
        folders = deeper;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_of_libraries_name_the_package() {
        let hint = library_hint("opencv2/opencv.hpp").expect("a library");
        assert_eq!(
            hint,
            ": `opencv2/opencv.hpp` belongs to OpenCV, which is no part of eyesim: install it (Debian: `apt install libopencv-dev`), and run \
             with `EYESIM_CFLAGS=\"$(pkg-config --cflags --libs opencv4)\"`"
        );
        assert!(
            library_hint("doublefann.h")
                .is_some_and(|hint| hint.contains("libfann-dev") && hint.contains("-ldoublefann"))
        );
        assert!(library_hint("boost/array.hpp").is_some_and(|hint| hint.ends_with("`apt install libboost-dev`)")));
        assert_eq!(library_hint("map.h"), None);
    }

    #[test]
    fn headers_in_other_folders_and_in_other_case_are_found() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |name: &str| {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().expect("a parent")).expect("folders");
            fs::write(path, "").expect("a file");
        };
        ["Map.h", "lib/inc/draw.h", ".git/gone.h"].into_iter().for_each(write);
        let hint = |missing: &str| nearby_hint(missing, &folder.path().join("a.c"));
        let case = ": there is no `map.h`, but `Map.h`: write `#include \"Map.h\"` (upper and lower case differ)";
        assert_eq!(hint("map.h").as_deref(), Some(case));
        let other = ": there is no `../draw.h`, but `lib/inc/draw.h`: write `#include \"lib/inc/draw.h\"`";
        assert_eq!(hint("../draw.h").as_deref(), Some(other));
        let quotes = ": `Map.h` is in the program's folder: write `#include \"Map.h\"`, with quotes";
        assert_eq!(hint("Map.h").as_deref(), Some(quotes));
        write("a/b/near.h");
        write("z/near.h");
        assert!(hint("near.h").is_some_and(|hint| hint.contains("but `z/near.h`")), "the nearest one");
        assert_eq!(hint("gone.h"), None);
    }
}
