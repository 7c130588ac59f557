//! `eyesim new --lab`: a lab of the course without its solutions, from the folder `labs` of the installation.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context as _, bail};
use sim_format::Files as _;
use sim_host::files::DiskFiles;
use sim_host::program::Generation;

use super::{Language, NewArgs, check_name, editor_files, write_folder};
use crate::cli::output::tell;

/// Writes the folder of `lab` and prints how to run and test its program.
///
/// # Errors
/// There is no such lab, or it has no program in that language; the folder exists already, or a file cannot be read or
/// written.
pub(super) fn run(lab: &str, args: &NewArgs) -> anyhow::Result<ExitCode> {
    let extension = match args.lang {
        Language::C => "c",
        Language::Python => "py",
        Language::Cpp | Language::Rust => {
            bail!("labs begin with a program in C or Python: `--lang c` or `--lang python`")
        }
    };
    let files = DiskFiles::of_environment();
    let labs = files.home().map(|home| Path::new(home).join("labs")).filter(|labs| labs.is_dir());
    let labs = labs.context("this installation has no labs: set EYESIM_HOME to a folder that contains `labs`")?;
    let Some((_, source)) = lab_folders(&labs)?.into_iter().find(|(name, _)| name == lab) else {
        let names: Vec<String> = lab_folders(&labs)?.into_iter().map(|(name, _)| name).collect();
        bail!("`{lab}` is not a lab: expected one of {}", names.join(", "));
    };
    let name = args.name.as_deref().unwrap_or(lab);
    check_name(name, args.lang)?;
    let folder = args.folder(name);
    let mut texts = editor_files(args.lang, Generation::Robios7);
    texts.extend(files_of(&source, lab, extension)?);
    write_folder(&folder, &texts)?;
    let shown = folder.display();
    tell(format_args!("wrote `{shown}`: read `README.md`, complete `{lab}.{extension}`, run and test it with\n"));
    tell(format_args!("    eyesim run {shown}/{lab}.scene.toml\n    eyesim test {shown}\n"));
    Ok(ExitCode::SUCCESS)
}

/// Names and folders of all labs, in the order of the course; the folder `03-distbug` contains the lab `distbug`.
fn lab_folders(labs: &Path) -> anyhow::Result<Vec<(String, PathBuf)>> {
    let mut folders = Vec::new();
    for entry in fs::read_dir(labs).with_context(|| format!("cannot read `{}`", labs.display()))? {
        let path = entry?.path();
        if path.is_dir() {
            folders.push(path);
        }
    }
    folders.sort();
    let with_name = |path: PathBuf| {
        let (number, name) = path.file_name()?.to_str()?.split_once('-')?;
        number.bytes().all(|byte| byte.is_ascii_digit()).then(|| (name.to_owned(), path.clone()))
    };
    Ok(folders.into_iter().filter_map(with_name).collect())
}

/// The files of a lab, without its solutions and with only the program that has this extension.
fn files_of(source: &Path, lab: &str, extension: &str) -> anyhow::Result<Vec<(String, String)>> {
    let (program, programs) = (format!("{lab}.{extension}"), [format!("{lab}.c"), format!("{lab}.py")]);
    let mut files = Vec::new();
    for entry in fs::read_dir(source).with_context(|| format!("cannot read `{}`", source.display()))? {
        let path = entry?.path();
        let Some(name) = path.file_name().and_then(|name| name.to_str()).filter(|_| path.is_file()) else { continue };
        if name != program && programs.iter().any(|other| other == name) {
            continue;
        }
        let text = fs::read_to_string(&path).with_context(|| format!("cannot read `{}`", path.display()))?;
        let text = if name.ends_with(".scene.toml") {
            text.replace(&format!("program = \"{lab}.c\""), &format!("program = \"{program}\""))
        } else {
            text
        };
        files.push((name.to_owned(), text));
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use clap::Args as _;

    use super::*;

    #[test]
    fn help_names_every_lab() {
        let help = NewArgs::augment_args(clap::Command::new("new")).render_long_help().to_string();
        let names = lab_folders(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../labs"))).expect("the labs");
        let names: Vec<String> = names.into_iter().map(|(name, _)| name).collect();
        let (last, others) = names.split_last().expect("labs");
        let named = help.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(named.contains(&format!("{} or {last}", others.join(", "))), "{help}");
    }
}
