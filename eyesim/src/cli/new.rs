//! `eyesim new`: writes a folder with a program, a robot, a world and a sim file that can be run immediately, or with a
//! lab of the course.

mod lab;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context as _, bail};
use clap::{Args, ValueEnum};
use sim_host::host;
use sim_host::program::Generation;

use super::output::tell;

/// Arguments of `eyesim new`.
#[derive(Args, Debug)]
pub struct NewArgs {
    /// Name of the program and of its folder; with `--lab` only of the folder, by default the lab's name
    #[arg(value_name = "NAME", required_unless_present = "lab")]
    pub name: Option<String>,
    /// Write a lab of the course, with a program to begin with in C or Python: lawn, waypoints, distbug, quadtree,
    /// brushfire, astar, mapping, lane, relay or maze
    #[arg(long, value_name = "LAB", conflicts_with_all = ["api", "suite"])]
    pub lab: Option<String>,
    /// Language of the program
    #[arg(long, value_enum, default_value_t = Language::C)]
    pub lang: Language,
    /// RoBIOS generation of the program [default: 6 for C and Rust, 7 for C++ and Python]
    #[arg(long, value_name = "GENERATION", value_parser = clap::value_parser!(u32).range(6..=7))]
    pub api: Option<u32>,
    /// Also write a suite for `eyesim test`: cases with noise and seeds, and checks
    #[arg(long)]
    pub suite: bool,
    /// Folder in which the program's folder is created
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub path: PathBuf,
}

/// A language for robot programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Language {
    /// C, compiled with the system's compiler
    C,
    /// C++, compiled with the system's compiler
    #[value(alias = "c++")]
    Cpp,
    /// Python, run by the system's python3
    Python,
    /// Rust, built with cargo
    Rust,
}

/// Writes the folder and prints how to run the program.
///
/// # Errors
/// If the name is invalid or exists already, or a file cannot be written.
pub fn run(args: &NewArgs) -> anyhow::Result<ExitCode> {
    if let Some(lab) = &args.lab {
        return lab::run(lab, args);
    }
    let name = args.name.as_deref().unwrap_or_default();
    check_name(name, args.lang)?;
    let folder = args.folder(name);
    let api = robios_api_folder();
    let eyesim = host::script().context("cannot tell the path of eyesim, which the tasks for VS Code name")?;
    let eyesim = eyesim.display().to_string();
    let generation = generation(args.lang, args.api)?;
    let project = Project { name, lang: args.lang, generation, eyesim: &eyesim };
    let mut files = project.files(api.as_deref());
    if args.suite {
        let text = include_str!("new/suite.toml").replace("@NAME@", name);
        files.push((format!("{name}.suite.toml"), text));
    }
    write_folder(&folder, &files)?;
    tell(format_args!("wrote `{}`; run it with\n\n    eyesim run {}/{name}.sim\n", folder.display(), folder.display()));
    if args.suite {
        tell(format_args!("and judge it with\n\n    eyesim test {}\n", folder.display()));
    }
    if args.lang == Language::Rust && api.is_none() {
        tell(format_args!(
            "The source of eyesim is not where this eyesim was built: set the path of `robios-api` in `{}` first.",
            folder.join("Cargo.toml").display()
        ));
    }
    Ok(ExitCode::SUCCESS)
}

impl NewArgs {
    /// The folder `name` in the folder of `--path`.
    fn folder(&self, name: &str) -> PathBuf {
        if self.path == Path::new(".") { PathBuf::from(name) } else { self.path.join(name) }
    }
}

/// Names that cargo refuses for a package, or that would shadow a crate that the program uses.
const RESERVED: &[&str] = &[
    "abstract",
    "alloc",
    "as",
    "async",
    "await",
    "become",
    "box",
    "break",
    "const",
    "continue",
    "core",
    "crate",
    "do",
    "dyn",
    "else",
    "enum",
    "extern",
    "false",
    "final",
    "fn",
    "for",
    "gen",
    "if",
    "impl",
    "in",
    "let",
    "loop",
    "macro",
    "match",
    "mod",
    "move",
    "mut",
    "override",
    "priv",
    "proc-macro",
    "proc_macro",
    "pub",
    "ref",
    "return",
    "robios-api",
    "robios_api",
    "robios-sys",
    "robios_sys",
    "self",
    "static",
    "std",
    "struct",
    "super",
    "test",
    "trait",
    "true",
    "try",
    "type",
    "typeof",
    "unsafe",
    "unsized",
    "use",
    "virtual",
    "where",
    "while",
    "yield",
];

/// Hint with the correct command, for a name that is a path.
fn path_hint(path: &str) -> Option<String> {
    let path = path.trim_end_matches('/');
    let (folder, name) = path.rsplit_once('/')?;
    let folder = if folder.is_empty() { "/" } else { folder };
    Some(format!("; write `eyesim new {name} --path {folder}`"))
}

fn check_name(name: &str, lang: Language) -> anyhow::Result<()> {
    let has_valid_characters = name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_');
    if !has_valid_characters || !name.starts_with(|first: char| first.is_ascii_alphabetic()) {
        bail!(
            "`{name}` is not a name for a program: it starts with a letter and has letters, digits, `-` and `_`{}",
            path_hint(name).unwrap_or_default()
        );
    }
    if lang == Language::Rust && RESERVED.contains(&name.to_ascii_lowercase().as_str()) {
        bail!("`{name}` is not a name for a Rust program: it means something else in Rust");
    }
    if lang == Language::Python && name.eq_ignore_ascii_case("eye") {
        bail!("`{name}` is not a name for a Python program: the module of RoBIOS has this name");
    }
    Ok(())
}

/// The folder of the crate `robios-api` in the source that this program was built from, if it is still there.
fn robios_api_folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).parent()?.join("robios-api");
    folder.join("Cargo.toml").is_file().then_some(folder)
}

/// RoBIOS generation of a program in `lang`: `requested`, or the generation that most programs in `lang` use.
fn generation(lang: Language, requested: Option<u32>) -> anyhow::Result<Generation> {
    match (requested, lang) {
        (Some(6), Language::Python) => bail!("there is no RoBIOS 6 in Python: `--api 7`, or C, C++ or Rust"),
        (Some(7), _) | (None, Language::Cpp | Language::Python) => Ok(Generation::Robios7),
        _ => Ok(Generation::Robios6),
    }
}

/// A new program.
struct Project<'a> {
    name: &'a str,
    lang: Language,
    generation: Generation,
    /// The path of `eyesim`, for the tasks of VS Code.
    eyesim: &'a str,
}

impl Project<'_> {
    /// The files of the program: path in its folder, and text. `api` is the folder of `robios-api`.
    fn files(&self, api: Option<&Path>) -> Vec<(String, String)> {
        let program = match self.lang {
            Language::C => format!("{}.c", self.name),
            Language::Cpp => format!("{}.cpp", self.name),
            Language::Python => format!("{}.py", self.name),
            Language::Rust => "Cargo.toml".to_owned(),
        };
        let fill = |template: &str| self.fill(template, &program, api);
        let mut files = vec![
            (format!("{}.wld", self.name), fill(include_str!("new/world.wld"))),
            (".vscode/tasks.json".into(), fill(include_str!("new/tasks.json"))),
        ];
        // gdb does not support Python.
        if self.lang != Language::Python {
            files.push((".vscode/launch.json".into(), fill(include_str!("new/launch.json"))));
        }
        match self.generation {
            Generation::Robios6 => {
                files.push((format!("{}.robi", self.name), fill(include_str!("new/robot.robi"))));
                files.push((format!("{}.sim", self.name), fill(include_str!("new/robios6.sim"))));
            }
            Generation::Robios7 => {
                files.push((format!("{}.sim", self.name), fill(include_str!("new/robios7.sim"))));
            }
        }
        match self.lang {
            Language::C | Language::Cpp => {
                files.push((program.clone(), fill(self.c_template())));
                files.push(("README.md".into(), fill(include_str!("new/readme-c.md"))));
                files.extend(editor_files(self.lang, self.generation));
            }
            Language::Python => {
                files.push((program.clone(), fill(include_str!("new/robios7.py"))));
                files.push(("README.md".into(), fill(include_str!("new/readme-python.md"))));
                files.extend(editor_files(self.lang, self.generation));
            }
            Language::Rust => {
                let source = match self.generation {
                    Generation::Robios6 => include_str!("new/robios6.rs"),
                    Generation::Robios7 => include_str!("new/robios7.rs"),
                };
                files.push((program.clone(), fill(include_str!("new/package.toml"))));
                files.push(("src/lib.rs".into(), fill(source)));
                files.push(("README.md".into(), fill(include_str!("new/readme-rust.md"))));
                files.push((".gitignore".into(), "/target\n".into()));
                // Locks the dependencies to the versions of this build of eyesim; cargo removes those that are not
                // needed.
                let lock = api.and_then(|api| fs::read_to_string(api.parent()?.join("Cargo.lock")).ok());
                files.extend(lock.map(|lock| ("Cargo.lock".into(), lock)));
            }
        }
        files
    }

    /// Template of a program in C or C++; the template for RoBIOS 6 is valid in both.
    fn c_template(&self) -> &'static str {
        match (self.generation, self.lang) {
            (Generation::Robios6, _) => include_str!("new/robios6.c"),
            (Generation::Robios7, Language::Cpp) => include_str!("new/robios7.cpp"),
            (Generation::Robios7, _) => include_str!("new/robios7.c"),
        }
    }

    fn fill(&self, template: &str, program: &str, api: Option<&Path>) -> String {
        let api_path =
            api.map_or_else(|| "path/to/eyesim/robios-api".to_owned(), |api| toml_text(&api.display().to_string()));
        let language = match self.lang {
            Language::C => "C",
            Language::Cpp => "C++",
            Language::Python => "Python",
            Language::Rust => "Rust",
        };
        let (robios, robot) = match self.generation {
            Generation::Robios6 => ("RoBIOS 6", format!("`{}.robi` is the robot, ", self.name)),
            Generation::Robios7 => ("RoBIOS-7", String::new()),
        };
        let matcher = if self.lang == Language::Rust { include_str!("new/cargo-matcher.json").trim_end() } else { "" };
        let debug = format!("'{}' debug {}.sim", self.eyesim.replace('\'', r"'\''"), self.name);
        template
            .replace("@EYESIM@", &json_text(self.eyesim))
            .replace("@DEBUG@", &json_text(&debug))
            .replace("@CARGO@", matcher)
            .replace("@NAME@", self.name)
            .replace("@PROGRAM@", program)
            .replace("@LANGUAGE@", language)
            .replace("@ROBIOS@", robios)
            .replace("@ROBOT@", &robot)
            .replace("@WHERE@", if api.is_some() { "" } else { ", which you must enter" })
            .replace("@API@", &api_path)
    }
}

/// Settings for editors, which then complete and check RoBIOS calls: path in the folder of the program, and text.
fn editor_files(lang: Language, generation: Generation) -> Vec<(String, String)> {
    let standard = match lang {
        Language::C => "-std=gnu17",
        Language::Cpp => "-xc++\n-std=gnu++17",
        Language::Python => return vec![("eye.py".into(), robios_sys::python::eye())],
        Language::Rust => return Vec::new(),
    };
    let headers = match generation {
        Generation::Robios6 => robios_sys::c::HEADERS6,
        Generation::Robios7 => robios_sys::c::HEADERS7,
    };
    let headers = headers.iter().map(|header| (format!("include/{}", header.name), header.text.to_string()));
    headers.chain([("compile_flags.txt".into(), format!("{standard}\n-Wall\n-Iinclude\n"))]).collect()
}

/// Escapes `text` for a TOML string.
fn toml_text(text: &str) -> String {
    text.replace('\\', r"\\").replace('"', r#"\""#)
}

/// `text` as a string of JSON.
fn json_text(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// Writes a new folder with all files, or nothing.
fn write_folder(folder: &Path, files: &[(String, String)]) -> anyhow::Result<()> {
    if folder.symlink_metadata().is_ok() {
        bail!("`{}` exists already: choose another name, or another folder with `--path`", folder.display());
    }
    let write = |(name, text): &(String, String)| {
        let path = folder.join(name);
        let parent = path.parent().unwrap_or(folder);
        fs::create_dir_all(parent).with_context(|| format!("cannot make the folder `{}`", parent.display()))?;
        fs::write(&path, text).with_context(|| format!("cannot write `{}`", path.display()))
    };
    files.iter().try_for_each(write).inspect_err(|_| drop(fs::remove_dir_all(folder)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn new(name: &str, lang: Language, path: &Path) -> Result<(), String> {
        run(&NewArgs { name: Some(name.into()), lab: None, lang, api: None, suite: false, path: path.into() })
            .map(drop)
            .map_err(|error| error.to_string())
    }

    #[test]
    fn existing_folders_are_not_overwritten() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        assert_eq!(new("maze", Language::C, folder.path()), Ok(()));
        let message = new("maze", Language::Rust, folder.path()).expect_err("it is there");
        assert!(message.contains("maze` exists already"), "{message}");
        assert!(!folder.path().join("maze/Cargo.toml").exists());
    }

    #[test]
    fn a_folder_that_cannot_be_completed_is_removed() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let new = folder.path().join("maze");
        let files = [("maze.c", "int main() {}"), ("maze.c/robot.robi", "a file is in the way")];
        let files = files.map(|(name, text)| (name.to_owned(), text.to_owned()));
        assert!(write_folder(&new, &files).is_err());
        assert!(!new.exists());
    }

    #[test]
    fn invalid_names_are_refused() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        for name in ["", "1st", "a b", "../a", "-x", "ä"] {
            assert!(
                new(name, Language::C, folder.path()).expect_err(name).contains("is not a name for a program"),
                "{name}"
            );
        }
        assert!(
            new("loop", Language::Rust, folder.path())
                .expect_err("a keyword")
                .contains("not a name for a Rust program")
        );
        assert_eq!(new("loop", Language::C, folder.path()), Ok(()));
    }

    #[test]
    fn python_has_no_robios_6() {
        assert_eq!(generation(Language::Python, None).expect("7"), Generation::Robios7);
        let message = generation(Language::Python, Some(6)).expect_err("refused").to_string();
        assert!(message.contains("`--api 7`"), "{message}");
    }

    #[test]
    fn vs_code_files_are_json_for_any_path() {
        let eyesim = r#"/it's "here"\eyesim"#;
        for lang in [Language::C, Language::Rust] {
            let project = Project { name: "maze", lang, generation: Generation::Robios6, eyesim };
            let files = project.files(None);
            let read = |name: &str| {
                let (_, text) = files.iter().find(|(other, _)| other == name).expect("the file");
                serde_json::from_str::<serde_json::Value>(text).expect("JSON")
            };
            assert_eq!(read(".vscode/tasks.json")["tasks"][0]["command"], eyesim);
            let launch = read(".vscode/launch.json");
            assert_eq!(launch["configurations"][0]["command"], r#"'/it'\''s "here"\eyesim' debug maze.sim"#);
        }
    }

    #[test]
    fn all_placeholders_of_the_templates_are_filled() {
        let library = Some(Path::new("/e/robios-api"));
        let python =
            Project { name: "maze", lang: Language::Python, generation: Generation::Robios7, eyesim: "/e/eyesim" };
        for (name, text) in python.files(None).into_iter().filter(|(name, _)| name != "eye.py") {
            assert!(!text.contains('@'), "{name}: {text}");
        }
        for lang in [Language::C, Language::Cpp, Language::Rust] {
            for (generation, api) in [(Generation::Robios6, None), (Generation::Robios7, library)] {
                for (name, text) in (Project { name: "maze", lang, generation, eyesim: "/e/eyesim" }).files(api) {
                    assert!(!text.contains('@'), "{name}: {text}");
                }
            }
        }
    }
}
