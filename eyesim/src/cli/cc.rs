//! `eyesim cc`: builds the library of a robot program from C and C++ sources, without a scene.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context as _, bail};
use clap::Args;
use sim_host::executive::interrupt;
use sim_host::program::build::{Builder, Tools};
use sim_host::program::cache::Cache;
use sim_host::program::compile::Kits;
use sim_host::program::language::Language;
use sim_host::program::{Generation, GenerationHint};

use super::output::{output_path, say};

/// Arguments of `eyesim cc`.
#[derive(Args, Debug)]
pub struct CcArgs {
    /// The C and C++ sources of one program
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// The library to write
    #[arg(short, long, value_name = "OUT", value_parser = output_path())]
    pub output: PathBuf,
    /// RoBIOS generation that the program is written for, 6 or 7 [default: from the functions that it calls]
    #[arg(long, value_name = "GENERATION", value_parser = parse_api)]
    pub api: Option<Generation>,
    /// Show the commands that are run
    #[arg(short, long)]
    pub verbose: bool,
    /// Further compiler flags, after `--`
    #[arg(last = true, value_name = "FLAGS")]
    pub flags: Vec<String>,
}

/// Compiles and links the sources, prints the compiler's warnings and writes the library.
///
/// # Errors
/// If a source is missing or refused, there is no compiler, or the library cannot be written.
pub fn run(args: &CcArgs) -> anyhow::Result<ExitCode> {
    check_files(&args.files, &args.output)?;
    interrupt::of_process().context("cannot install signal handlers")?;
    let cache = Cache::of_user().context("no folder to build in")?;
    let builder = Builder::new(cache, Kits::of_robios(), Tools::of_environment());
    let hint = GenerationHint { api: args.api, dialect: None };
    let (choice, commands, output) = builder.build_to(&args.files, hint, &args.output, &args.flags)?;
    choice.remark(&args.files[0]).iter().for_each(say);
    if args.verbose {
        say(commands.trim_end());
    }
    say(output.trim_end());
    Ok(ExitCode::SUCCESS)
}

/// Parses `6` or `7`.
///
/// # Errors
/// For any other text.
pub fn parse_api(text: &str) -> Result<Generation, String> {
    text.parse().ok().and_then(Generation::of_number).ok_or_else(|| "expected 6 or 7".to_owned())
}

fn check_files(files: &[PathBuf], output: &Path) -> anyhow::Result<()> {
    for file in files {
        if file.join("Cargo.toml").is_file() {
            bail!(
                "`{}` is a Cargo package: cargo builds it (`cargo build --release`), and `eyesim run` does so itself",
                file.display()
            );
        }
        if Language::of(file).is_none() {
            bail!(
                "`{}` is not C or C++ source: the files of a program are named `*.c`, `*.cpp`, `*.cc` or `*.cxx`",
                file.display()
            );
        }
    }
    let is_header = output
        .extension()
        .is_some_and(|extension| ["h", "hpp"].iter().any(|header| extension.eq_ignore_ascii_case(header)));
    let is_source = is_header || Language::of(output).is_some();
    if is_source {
        bail!("the library would be written over `{}`: give it a name that ends in `.so`", output.display());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(files: &[&str], output: &str) -> Result<(), String> {
        let files: Vec<PathBuf> = files.iter().map(PathBuf::from).collect();
        check_files(&files, Path::new(output)).map_err(|error| error.to_string())
    }

    #[test]
    fn sources_are_not_overwritten_and_objects_not_compiled() {
        assert_eq!(check(&["maze.c", "MAP.C", "plan.cpp"], "maze.so"), Ok(()));
        assert!(check(&["maze.c"], "map.c").expect_err("a source").contains("written over `map.c`"));
        assert!(check(&["maze.o"], "maze.so").expect_err("an object").contains("`maze.o` is not C or C++ source"));
    }
}
