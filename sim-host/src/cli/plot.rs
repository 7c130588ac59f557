//! `eyesim plot`: a picture from above of a scene, a world, a robot type or an object type.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::bail;
use clap::Args;
use sim_core::format::{self, Loaded, MeshReader};

use super::output::check_outputs;
use super::{EXIT_USAGE, check};
use crate::files::{DiskFiles, slashed};
use crate::plot::{self, Drawing, Kind};

/// Least and greatest width and height of a picture in pixels.
const SIZES: std::ops::RangeInclusive<u32> = 320..=4000;

/// Arguments of `eyesim plot`.
#[derive(Args)]
pub struct PlotArgs {
    /// The file to draw: .sim (with all that it names), .wld, .maz, .robi (with its .toml), .esObj
    pub file: PathBuf,
    /// The picture: NAME.svg or NAME.png
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Width and height of the picture in pixels [default: as the world's shape asks for]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    pub size: Option<(u32, u32)>,
    /// The line above the picture [default: the file's name, and its size]
    #[arg(long, value_name = "TEXT")]
    pub title: Option<String>,
}

/// Runs the command: 0, or 2 where the file has errors; then what could be read of it is drawn all the same.
///
/// # Errors
/// A file that is not there or of a kind that cannot be drawn, a picture of an unknown kind or that cannot be written.
pub fn run(args: &PlotArgs) -> anyhow::Result<ExitCode> {
    Kind::of(&args.output)?;
    let files = DiskFiles::of_environment();
    let (drawing, loaded) = draw(&slashed(&args.file), &files)?;
    eprint!("{}", check::render(&loaded.diagnostics, &loaded.inputs));
    let Some(mut drawing) = drawing else { return Ok(ExitCode::from(EXIT_USAGE)) };
    check_outputs(&[("-o", &args.output)], loaded.inputs.iter().map(|input| input.path.as_str()))?;
    if let Some(title) = &args.title {
        drawing.title.clone_from(title);
    }
    plot::write(&drawing, &args.output, args.size)?;
    Ok(if loaded.has_errors() { ExitCode::from(EXIT_USAGE) } else { ExitCode::SUCCESS })
}

/// The drawing of a file, and what was wrong in all that was read for it; no drawing if the file itself cannot be read.
fn draw(name: &str, files: &DiskFiles) -> anyhow::Result<(Option<Drawing>, Loaded)> {
    let mut looks = MeshReader::new(files);
    let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension).to_lowercase();
    let (drawing, mut loaded) = match extension.as_str() {
        "sim" | "wld" | "maz" | "maze" => {
            let loaded = match extension.as_str() {
                "sim" => format::load_sim(name, files),
                "wld" => format::load_world(name, files),
                _ => format::load_maze(name, files),
            };
            let drawing = (!loaded.inputs.is_empty()).then(|| plot::draw_scene(&loaded.scene, &mut looks));
            (drawing, loaded)
        }
        "robi" => {
            let (robi, loaded) = format::load_robi(name, files);
            (robi.map(|robi| plot::draw_robi(&robi, &mut looks)), loaded)
        }
        "esobj" => {
            let (object, loaded) = format::load_object(name, files);
            (object.map(|object| plot::draw_object_type(&object, &mut looks)), loaded)
        }
        _ => bail!("`{name}` cannot be drawn: expected a name that ends in .sim, .wld, .maz, .maze, .robi or .esObj"),
    };
    let (diagnostics, inputs) = looks.finish();
    loaded.diagnostics.extend(diagnostics);
    loaded.inputs.extend(inputs);
    Ok((drawing, loaded))
}

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let expected = || {
        let (least, most) = (SIZES.start(), SIZES.end());
        format!("expected WIDTHxHEIGHT in pixels, {least} to {most} each, such as 1200x900")
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
        assert_eq!(parse_size("320X4000"), Ok((320, 4000)));
        for text in ["1200", "1200x", "x900", "10x10", "9999x900", "-500x500", "1200x900x3", "a x b"] {
            assert!(parse_size(text).is_err_and(|message| message.contains("1200x900")), "{text}");
        }
    }
}
