//! `eyesim shot`: runs a scene up to a time and takes a picture of a robot's display.

use std::io::Cursor;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, bail};
use clap::Args;
use image::{ImageFormat, RgbImage};
use sim_core::time::Time;

use super::EXIT_PROGRAM;
use super::options::index_of;
use super::output::check_outputs;
use super::run::{self, RunArgs, carry_out, parse_seconds};
use crate::record::Outcome;
use crate::record::report::write_whole;
use crate::robios::panel::Panel;
use crate::robios::screen::canvas::{Canvas, Ink, Rgb};
use crate::robios::screen::font::{Family, Font, Size, Variation};
use crate::robios::screen::{menu, page};

/// Arguments of `eyesim shot`: those of a run, and what the picture shows.
#[derive(Args)]
pub struct ShotArgs {
    #[command(flatten)]
    run: RunArgs,
    /// Show the display of this robot
    #[arg(long, value_name = "ROBOT", num_args = 0..=1, default_missing_value = "1", value_parser = parse_robot)]
    lcd: Option<u32>,
    /// Simulated seconds at which the picture is taken [default: at the run's end]
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, conflicts_with = "until")]
    at: Option<Time>,
    /// The picture
    #[arg(short, long, value_name = "FILE.png", default_value = "lcd.png")]
    output: PathBuf,
    /// Pixels of the picture in each direction for a pixel of the display [default: 2, for the small display of RoBIOS 6 4]
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u8).range(1..=16))]
    scale: Option<u8>,
    /// Show the display's pixels alone, without the frame around them
    #[arg(long)]
    bare: bool,
}

/// Runs the command: 0, or 1 if a program failed; the picture is taken all the same. A program that waits for a key is as it
/// should be.
///
/// # Errors
/// Files or arguments that are wrong.
pub fn run(mut args: ShotArgs) -> anyhow::Result<ExitCode> {
    let Some(robot) = args.lcd else {
        bail!("nothing to show: `--lcd` shows the display of robot 1, `--lcd 2` that of robot 2");
    };
    if !args.output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        bail!("-o `{}`: expected a name that ends in .png", args.output.display());
    }
    check_outputs(&[("-o", &args.output)], std::iter::empty())?;
    args.run.until = args.at.or(args.run.until);
    let Some(mut ran) = carry_out(&args.run)? else { return Ok(ExitCode::from(EXIT_PROGRAM)) };
    ran.write_files(&args.run)?;
    check_outputs(&[("-o", &args.output)], ran.report.inputs.iter().map(|input| input.path.as_str()))?;
    let index = index_of(&ran.scene, robot).context("--lcd")?;
    let panel = &ran.ended.robots[index].panel;
    let scale = args.scale.map_or(if matches!(panel, Panel::Classic(_)) { 4 } else { 2 }, usize::from);
    let display = enlarged(&panel.picture(), scale);
    let caption = Caption {
        name: format!("{robot} {}", ran.report.robots[index].name),
        time: format!("{:.3} s", ran.report.sim_time_s),
    };
    let picture = if args.bare { display } else { framed(&display, &caption) };
    write_whole(&args.output, &png(&picture)?).with_context(|| format!("-o `{}`", args.output.display()))?;

    // Who waits for a key is in the picture, not to blame.
    ran.report.robots.iter_mut().for_each(|robot| {
        if robot.outcome == Outcome::Waiting {
            robot.outcome = Outcome::Running;
        }
    });
    run::explain(&ran.options, &ran.report, &ran.ended);
    let [width, height] = panel.picture().size();
    run::print(&format!(
        "{}: the display of r{robot} at {}, {width} x {height} pixels\n",
        args.output.display(),
        caption.time
    ))?;
    let is_failed = ran.report.robots.iter().any(|robot| robot.outcome.is_failure());
    Ok(if is_failed { ExitCode::from(EXIT_PROGRAM) } else { ExitCode::SUCCESS })
}

fn parse_robot(text: &str) -> Result<u32, String> {
    let number = text.strip_prefix(['r', 'R']).unwrap_or(text).parse().ok().filter(|robot| *robot > 0);
    number.ok_or_else(|| "expected a robot's number from 1, such as `2` or `r2`".into())
}

/// What stands on the frame.
struct Caption {
    name: String,
    time: String,
}

/// Width of the frame at the sides.
const SIDE: usize = 16;
/// Height of the frame above the display, with the caption.
const TOP: usize = 28;
/// Height of the frame below the display, with the keys.
const BOTTOM: usize = 46;
/// The frame.
const BODY: Rgb = [0x2b, 0x2f, 0x36];
/// Its edges, and those of the display in it.
const EDGE: Rgb = [0x11, 0x13, 0x16];
/// The keys.
const KEY: Rgb = [0x58, 0x5f, 0x69];
/// Text on frame and keys.
const INK: Rgb = [0xe8, 0xea, 0xed];

const LABEL: Font = Font { family: Family::Helvetica, variation: Variation::Normal, size: Size::Normal };

/// Each pixel as a square of `scale` x `scale`.
fn enlarged(display: &Canvas, scale: usize) -> Canvas {
    let [width, height] = display.size();
    let mut picture = Canvas::new(width * scale, height * scale, EDGE);
    let rows = display.pixels().chunks(width).flat_map(|row| std::iter::repeat_n(row, scale));
    let pixels = rows.flat_map(|row| row.iter().flat_map(|pixel| std::iter::repeat_n(*pixel, scale)));
    picture.show([0, 0], width * scale, pixels);
    picture
}

/// The display in its frame, with the four keys below it: where they are drawn is where the display feels them.
fn framed(display: &Canvas, caption: &Caption) -> Canvas {
    let [width, height] = display.size();
    let (left, right) = (SIDE as i32, (SIDE + width) as i32 - 1);
    let (top, bottom) = (TOP as i32, (TOP + height) as i32 - 1);
    let mut picture = Canvas::new(width + 2 * SIDE, height + TOP + BOTTOM, BODY);
    let [outer_right, outer_bottom] = picture.size().map(|side| side as i32 - 1);
    picture.draw_frame([0, 0], [outer_right, outer_bottom], Ink::Colour(EDGE));
    picture.draw_frame([left - 2, top - 2], [right + 2, bottom + 2], Ink::Colour(EDGE));
    picture.draw_frame([left - 1, top - 1], [right + 1, bottom + 1], Ink::Colour(EDGE));
    picture.show([left, top], width, display.pixels().iter().copied());
    let row = i32::from(LABEL.size.cell()[1]);
    let caption_top = (top - row) / 2;
    write(&mut picture, [left, caption_top], &caption.name);
    write(&mut picture, [right + 1 - length(&caption.time), caption_top], &caption.time);
    for index in 0..menu::KEYS {
        let [start, end] = menu::columns(index, width).map(|column| left + column as i32);
        let (key_left, key_right) = (start + 6, end - 7);
        let (key_top, key_bottom) = (bottom + 10, outer_bottom - 8);
        picture.fill_area([key_left, key_top + 2], [key_right, key_bottom - 2], Ink::Colour(KEY));
        picture.fill_area([key_left + 2, key_top], [key_right - 2, key_bottom], Ink::Colour(KEY));
        let label = format!("KEY{}", index + 1);
        let middle = [(key_left + key_right + 1 - length(&label)) / 2, (key_top + key_bottom + 1 - row) / 2];
        write(&mut picture, middle, &label);
    }
    picture
}

/// Pixels that a text on the frame is long.
fn length(text: &str) -> i32 {
    text.chars().map(|character| i32::from(LABEL.advance(character))).sum()
}

fn write(picture: &mut Canvas, [mut x, y]: [i32; 2], text: &str) {
    for character in text.chars() {
        page::draw_glyph(picture, [x, y], LABEL, character, INK);
        x += i32::from(LABEL.advance(character));
    }
}

fn png(picture: &Canvas) -> anyhow::Result<Vec<u8>> {
    let [width, height] = picture.size().map(|side| side as u32);
    let bytes = picture.pixels().as_flattened().to_vec();
    let image = RgbImage::from_raw(width, height, bytes).context("a picture of that size")?;
    let mut png = Cursor::new(Vec::new());
    image.write_to(&mut png, ImageFormat::Png).context("png")?;
    Ok(png.into_inner())
}
