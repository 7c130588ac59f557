//! `eyesim plot`: a picture from above of a scene, a world, a robot type or an object type.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::bail;
use clap::Args;
use sim_format::map::WORLD_EXTENSIONS;
use sim_format::path::extension;
use sim_format::{Loaded, MeshReader};
use sim_host::files::DiskFiles;

use super::EXIT_USAGE;
use super::check::is_scene;
use super::diagnostic::{self, Colour, Format, Screen};
use super::output::{check_outputs, print_error};
use crate::plot::{self, Drawing, PictureKind};

/// Minimum and maximum width and height of a picture in pixels.
const SIZES: std::ops::RangeInclusive<u32> = 480..=4000;

/// Arguments of `eyesim plot`.
#[derive(Args)]
pub struct PlotArgs {
    /// The file to draw: .sim or .scene.toml (with all that it names), .wld, .maz, .robi (with its .toml), .esObj; maps
    /// and mazes of others: .yaml, .pgm, .pbm, .map, .world, .num, .txt
    pub file: PathBuf,
    /// The picture: NAME.svg or NAME.png
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Width and height of the picture in pixels [default: from the world's shape]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    pub size: Option<(u32, u32)>,
    /// Title above the picture [default: the file's name and a summary]
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
}

/// Runs the command. The exit code is 0, or 2 if the file has errors; its readable part is drawn nevertheless.
///
/// # Errors
/// If the file is missing or cannot be drawn, or the picture is of an unknown kind or cannot be written.
pub fn run(args: &PlotArgs) -> anyhow::Result<ExitCode> {
    PictureKind::of(&args.output)?;
    let mut files = DiskFiles::of_environment();
    let name = files.name(&args.file);
    let (drawing, loaded) = draw(&name, &files)?;
    let screen = Screen::of_stderr(Colour::Auto);
    print_error(&diagnostic::render(&loaded.diagnostics, &loaded.inputs, Format::Auto, screen)?);
    let Some(mut drawing) = drawing else { return Ok(ExitCode::from(EXIT_USAGE)) };
    check_outputs(&[("-o", &args.output)], loaded.inputs.iter().map(|input| input.path.as_str()))?;
    if let Some(title) = &args.title {
        drawing.title.clone_from(title);
    }
    plot::write(&drawing, &args.output, args.size)?;
    Ok(if loaded.has_errors() { ExitCode::from(EXIT_USAGE) } else { ExitCode::SUCCESS })
}

/// Drawing of a file, and the diagnostics of all files read for it; no drawing if the file itself cannot be read.
fn draw(name: &str, files: &DiskFiles) -> anyhow::Result<(Option<Drawing>, Loaded)> {
    let mut mesh_reader = MeshReader::new(files);
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let (drawing, mut loaded) = match extension(name).as_str() {
        "sim" => draw_scene(sim_format::load_scene(name, files), &mut mesh_reader),
        "toml" if is_scene(name, files) => draw_scene(sim_format::load_scene(name, files), &mut mesh_reader),
        extension if extension == "txt" || WORLD_EXTENSIONS.contains(&extension) => {
            draw_scene(sim_format::load_world(name, files), &mut mesh_reader)
        }
        "robi" => draw_robi(name, files, &mut mesh_reader),
        "toml" => draw_robi(&format!("{stem}.robi"), files, &mut mesh_reader),
        "esobj" => {
            let (object, loaded) = sim_format::load_object(name, files);
            (object.map(|object| plot::draw_object_type(&object, &mut mesh_reader)), loaded)
        }
        _ => {
            let kinds = ".sim, .scene.toml, .wld, .maz, .maze, .robi, .toml, .esObj, .yaml, .pgm, .pbm, .map, .world, .num or .txt";
            bail!("`{name}` cannot be drawn: expected a name that ends in {kinds}")
        }
    };
    let (diagnostics, inputs) = mesh_reader.finish();
    loaded.diagnostics.extend(diagnostics);
    loaded.inputs.extend(inputs);
    Ok((drawing, loaded))
}

/// Drawing of a scene; none if not even its own file was read.
fn draw_scene(loaded: Loaded, mesh_reader: &mut MeshReader<'_>) -> (Option<Drawing>, Loaded) {
    let drawing = (!loaded.inputs.is_empty()).then(|| plot::draw_scene(&loaded.scene, mesh_reader));
    (drawing, loaded)
}

fn draw_robi(name: &str, files: &DiskFiles, mesh_reader: &mut MeshReader<'_>) -> (Option<Drawing>, Loaded) {
    let (robi, loaded) = sim_format::load_robi(name, files);
    (robi.map(|robi| plot::draw_robi(&robi, mesh_reader)), loaded)
}

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let expected = || {
        let (min, max) = (SIZES.start(), SIZES.end());
        format!("expected WIDTHxHEIGHT in pixels, {min} to {max} each, such as 1200x900")
    };
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(expected)?;
    let side = |word: &str| word.trim().parse().ok().filter(|side| SIZES.contains(side)).ok_or_else(expected);
    Ok((side(width)?, side(height)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_width_times_height() {
        assert_eq!(parse_size("1200x900"), Ok((1200, 900)));
        assert_eq!(parse_size("480X4000"), Ok((480, 4000)));
        for text in ["1200", "1200x", "x900", "10x10", "9999x900", "-500x500", "1200x900x3", "a x b"] {
            assert!(parse_size(text).is_err_and(|message| message.contains("1200x900")), "{text}");
        }
    }
}
