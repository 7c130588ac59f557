//! `eyesim new`: writes a folder with a program, a robot, a world and a sim file that run at once.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context as _, bail};
use clap::{Args, ValueEnum};

/// Arguments of `eyesim new`.
#[derive(Args, Debug)]
pub struct NewArgs {
    /// Name of the program and of its folder
    #[arg(value_name = "NAME")]
    pub name: String,
    /// Language of the program
    #[arg(long, value_enum, default_value_t = Language::C)]
    pub lang: Language,
    /// Folder in which the program's folder is made
    #[arg(long, value_name = "DIR", default_value = ".")]
    pub path: PathBuf,
}

/// A language for robot programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Language {
    /// C, compiled with the system's compiler
    C,
    /// Rust, built with cargo
    Rust,
}

/// Writes the folder and says how to run what is in it.
///
/// # Errors
/// If the name is unfit, something of that name is there, or a file cannot be written.
pub fn run(args: &NewArgs) -> anyhow::Result<ExitCode> {
    check_name(&args.name, args.lang)?;
    let folder = if args.path == Path::new(".") { PathBuf::from(&args.name) } else { args.path.join(&args.name) };
    let api = robios_api_folder();
    write_folder(&folder, &files(&args.name, args.lang, api.as_deref()))?;
    println!("wrote `{}`; run it with\n\n    eyesim run {}/{}.sim\n", folder.display(), folder.display(), args.name);
    if args.lang == Language::Rust && api.is_none() {
        println!(
            "The source of eyesim is not where this eyesim was built: set the path of `robios-api` in `{}` first.",
            folder.join("Cargo.toml").display()
        );
    }
    Ok(ExitCode::SUCCESS)
}

/// Names that cargo refuses for a package, or that would hide a crate the program uses.
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

fn check_name(name: &str, lang: Language) -> anyhow::Result<()> {
    let plain = name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'-' || byte == b'_');
    if !plain || !name.starts_with(|first: char| first.is_ascii_alphabetic()) {
        bail!(
            "`{name}` is no name for a program: it starts with a letter and has letters, digits, `-` and `_`{}",
            if name.contains('/') { " (`--path` chooses the folder)" } else { "" }
        );
    }
    if lang == Language::Rust && RESERVED.contains(&name.to_ascii_lowercase().as_str()) {
        bail!("`{name}` is no name for a Rust program: it means something else in Rust");
    }
    Ok(())
}

/// The folder of the crate `robios-api` in the source that this program was built from, if it is still there.
fn robios_api_folder() -> Option<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).parent()?.join("robios-api");
    folder.join("Cargo.toml").is_file().then_some(folder)
}

/// The files of a new program: path in its folder, and text. `api` is the folder of `robios-api`.
fn files(name: &str, lang: Language, api: Option<&Path>) -> Vec<(String, String)> {
    let source = api;
    let (program, where_is_api) = match lang {
        Language::C => (format!("{name}.c"), String::new()),
        Language::Rust => {
            ("Cargo.toml".to_owned(), if api.is_some() { "" } else { ", which you must enter" }.to_owned())
        }
    };
    let api = api.map_or_else(|| "path/to/eyesim/robios-api".to_owned(), |api| toml_text(&api.display().to_string()));
    let fill = |template: &str| {
        template
            .replace("@NAME@", name)
            .replace("@PROGRAM@", &program)
            .replace("@WHERE@", &where_is_api)
            .replace("@API@", &api)
    };
    let mut files = vec![
        (format!("{name}.robi"), fill(include_str!("new/robot.robi"))),
        (format!("{name}.wld"), fill(include_str!("new/world.wld"))),
        (format!("{name}.sim"), fill(include_str!("new/scene.sim"))),
    ];
    match lang {
        Language::C => {
            files.push((program.clone(), fill(include_str!("new/program.c"))));
            files.push(("README.md".into(), fill(include_str!("new/readme-c.md"))));
            files.push(("compile_flags.txt".into(), "-std=gnu17\n-Wall\n-Iinclude\n".into()));
            let headers = robios_sys::c::HEADERS6.iter();
            files.extend(headers.map(|header| (format!("include/{}", header.name), header.text.to_owned())));
        }
        Language::Rust => {
            files.push((program.clone(), fill(include_str!("new/package.toml"))));
            files.push(("src/lib.rs".into(), fill(include_str!("new/program.rs"))));
            files.push(("README.md".into(), fill(include_str!("new/readme-rust.md"))));
            files.push((".gitignore".into(), "/target\n".into()));
            // The versions of dependencies that this eyesim was built with; cargo leaves out what is not needed.
            let lock = source.and_then(|source| fs::read_to_string(source.parent()?.join("Cargo.lock")).ok());
            files.extend(lock.map(|lock| ("Cargo.lock".into(), lock)));
        }
    }
    files
}

/// `text` as the inside of a TOML string.
fn toml_text(text: &str) -> String {
    text.replace('\\', r"\\").replace('"', r#"\""#)
}

fn write_folder(folder: &Path, files: &[(String, String)]) -> anyhow::Result<()> {
    if folder.symlink_metadata().is_ok() {
        bail!("`{}` is there already: choose another name, or another folder with `--path`", folder.display());
    }
    for (name, text) in files {
        let path = folder.join(name);
        let parent = path.parent().unwrap_or(folder);
        fs::create_dir_all(parent).with_context(|| format!("cannot make the folder `{}`", parent.display()))?;
        fs::write(&path, text).with_context(|| format!("cannot write `{}`", path.display()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn new(name: &str, lang: Language, path: &Path) -> Result<(), String> {
        run(&NewArgs { name: name.into(), lang, path: path.into() }).map(drop).map_err(|error| error.to_string())
    }

    #[test]
    fn nothing_is_overwritten() {
        let place = tempfile::tempdir().expect("a temporary folder");
        assert_eq!(new("maze", Language::C, place.path()), Ok(()));
        let message = new("maze", Language::Rust, place.path()).expect_err("it is there");
        assert!(message.contains("maze` is there already"), "{message}");
        assert!(!place.path().join("maze/Cargo.toml").exists());
    }

    #[test]
    fn unfit_names_are_refused() {
        let place = tempfile::tempdir().expect("a temporary folder");
        for name in ["", "1st", "a b", "../a", "-x", "ä"] {
            assert!(
                new(name, Language::C, place.path()).expect_err(name).contains("is no name for a program"),
                "{name}"
            );
        }
        assert!(
            new("loop", Language::Rust, place.path()).expect_err("a keyword").contains("no name for a Rust program")
        );
        assert_eq!(new("loop", Language::C, place.path()), Ok(()));
    }

    #[test]
    fn every_place_in_the_templates_is_filled() {
        for (lang, api) in
            [(Language::C, None), (Language::Rust, None), (Language::Rust, Some(Path::new("/e/robios-api")))]
        {
            for (name, text) in files("maze", lang, api) {
                assert!(!text.contains("@NAME@") && !text.contains("@PROGRAM@"), "{name}");
                assert!(!text.contains("@WHERE@") && !text.contains("@API@"), "{name}");
            }
        }
    }
}
