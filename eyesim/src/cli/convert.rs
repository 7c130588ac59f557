//! `eyesim convert` converts a file into another format; `eyesim schema` prints the JSON schemas of scenes and suites
//! for editors.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, bail};
use clap::{Args, ValueEnum};
use sim_core::spec::{RobotSpec, SceneSpec};
use sim_format::print::scene_schema;
use sim_format::suite::suite_schema;
use sim_format::{ConvertOptions, Converted, convert_with, has_errors};
use sim_host::files::{DiskFiles, slashed};
use sim_host::launch::check::{known_generation, search_path};

use super::EXIT_USAGE;
use super::diagnostic::{self, Colour, Format, Screen};
use super::output::{print, print_error, say, tell};
use super::run::parse_maze_cell;

/// Arguments of `eyesim convert`.
#[derive(Args)]
pub struct ConvertArgs {
    /// File to convert: .sim, .scene.toml, .wld, .maz, .robi (with its .toml), .esObj; maps and mazes of other
    /// programs: .yaml, .pgm, .pbm, .map, .scen, .world, .num, .txt
    #[arg(value_name = "FILE")]
    pub file: PathBuf,
    /// File to write; its extension selects the format
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Seed for the random values of a scene; the written scene contains it [default: from the scene]
    #[arg(long, value_name = "SEED", value_parser = clap::value_parser!(u64).range(..=i64::MAX as u64))]
    pub seed: Option<u64>,
    /// Cell size of a maze, a MovingAI map or an image in millimetres; overrides the file
    #[arg(long, value_name = "MM", value_parser = parse_maze_cell, allow_hyphen_values = true)]
    pub maze_cell: Option<f64>,
    /// Cell size of a map made from walls, in millimetres [default: 50]
    #[arg(long, value_name = "MM", value_parser = parse_maze_cell, allow_hyphen_values = true)]
    pub map_cell: Option<f64>,
    /// Replace existing files
    #[arg(long)]
    pub force: bool,
}

/// Runs the command. The exit code is 0, or 2 if there are errors and nothing is written.
///
/// # Errors
/// If an output exists and may not be replaced, is also an input, or cannot be written.
pub fn run(args: &ConvertArgs) -> anyhow::Result<ExitCode> {
    let mut files = DiskFiles::of_environment();
    // References are rewritten relative to the output folder, so both paths must be relative or both absolute.
    let have_same_root = args.file.is_absolute() == args.output.is_absolute();
    let rooted = |path: &Path| if have_same_root { Ok(path.to_owned()) } else { std::path::absolute(path) };
    let from = rooted(&args.file).context("no working folder")?;
    let to = rooted(&args.output).context("no working folder")?;
    let search = search_path(&files).context("no working folder")?;
    let options = ConvertOptions { seed: args.seed, maze_cell: args.maze_cell, map_cell: args.map_cell };
    let generation_of = |scene: &SceneSpec, robot: &RobotSpec| known_generation(&search, scene, robot);
    let converted = convert_with(&files.name(&from), &slashed(&to), options, &files, &generation_of);
    if !converted.diagnostics.is_empty() {
        let screen = Screen::of_stderr(Colour::Auto);
        print_error(&diagnostic::render(&converted.diagnostics, &converted.inputs, Format::Auto, screen)?);
    }
    converted.notes.iter().for_each(|note| say(format_args!("{note}")));
    if has_errors(&converted.diagnostics) {
        say(format_args!("nothing is written: {}", sim_host::launch::check::count(&converted.diagnostics)));
        return Ok(ExitCode::from(EXIT_USAGE));
    }
    check_outputs(&converted, args.force)?;
    for output in &converted.outputs {
        std::fs::write(&output.path, &output.bytes).with_context(|| format!("`{}` cannot be written", output.path))?;
        tell(&output.path);
    }
    Ok(ExitCode::SUCCESS)
}

/// Checks that no output would replace an input or, without `force`, any existing file.
fn check_outputs(converted: &Converted, force: bool) -> anyhow::Result<()> {
    let inputs: Vec<PathBuf> =
        converted.inputs.iter().filter_map(|input| std::fs::canonicalize(&input.path).ok()).collect();
    for output in &converted.outputs {
        let Ok(canonical) = std::fs::canonicalize(&output.path) else { continue };
        if inputs.contains(&canonical) {
            bail!("`{}` would replace a file that it is made from", output.path);
        }
        // Devices such as /dev/stdout take any number of outputs.
        if !force && !canonical.starts_with("/dev") && canonical.is_file() {
            bail!("`{}` exists already: --force replaces it", output.path);
        }
    }
    Ok(())
}

/// Arguments of `eyesim schema`.
#[derive(Args)]
pub struct SchemaArgs {
    /// Kind of the file
    #[arg(value_enum, default_value_t)]
    pub of: SchemaOf,
}

/// A kind of file in TOML with a schema.
#[derive(Clone, Copy, Debug, Default, ValueEnum)]
pub enum SchemaOf {
    /// Scenes, NAME.scene.toml
    #[default]
    Scene,
    /// Suites, NAME.suite.toml
    Suite,
}

/// Prints the JSON schema of scenes or of suites.
///
/// # Errors
/// If standard output cannot be written to.
pub fn schema(args: &SchemaArgs) -> anyhow::Result<ExitCode> {
    print(&match args.of {
        SchemaOf::Scene => scene_schema(),
        SchemaOf::Suite => suite_schema(),
    })?;
    Ok(ExitCode::SUCCESS)
}
