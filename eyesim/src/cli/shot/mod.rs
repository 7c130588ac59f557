//! `eyesim shot`: runs a scene up to a time and takes a picture of a robot's view, of the scene from a free camera, or
//! of a robot's display.

mod display;
mod view;

use std::cmp::Ordering;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, bail};
use clap::Args;
use glam::DVec3;
use sim_core::device::camera::CameraError;
use sim_core::record::Outcome;
use sim_core::spec::SceneSpec;
use sim_core::time::Time;
use sim_host::executive::dispatcher::EndReason;
use sim_host::launch::settings::index_of;
use sim_host::record::frame::Pixels;
use sim_host::record::report::write_atomically;
use sim_host::robios::camera::ImageUnavailable;

use self::display::Caption;
use self::view::{Content, Shot, ShotCamera};
use super::output::{check_outputs, print, say};
use super::pack::open_for_run;
use super::run::{self, FinishedRun, RunArgs, carry_out, parse_seconds};
use super::{EXIT_INTERRUPTED, EXIT_PROGRAM};

/// Arguments of `eyesim shot`: those of a run, and what the picture shows.
#[derive(Args)]
#[command(after_help = AFTER_HELP, mut_arg("robot", |arg| arg.help(ROBOT_HELP)))]
pub struct ShotArgs {
    #[command(flatten)]
    run: RunArgs,
    /// Show the display of this robot
    #[arg(long, value_name = "ROBOT", num_args = 0..=1, default_missing_value = "1", value_parser = parse_robot)]
    lcd: Option<u32>,
    /// Simulated seconds at which the picture is taken [default: at the run's end]
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_negative_numbers = true, conflicts_with = "until")]
    at: Option<Time>,
    /// Look from this point of the world, in millimetres as in a sim file, z upwards
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true, requires = "to", conflicts_with = "lcd")]
    from: Option<DVec3>,
    /// Look at this point of the world; in a view straight down, y points to the top of the picture
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true, requires = "from")]
    to: Option<DVec3>,
    /// Angle that the picture's width covers, in degrees, with --from [default: 60]
    #[arg(long, value_name = "DEGREES", value_parser = parse_fov, allow_negative_numbers = true, requires = "from")]
    fov: Option<f64>,
    /// Pixels of the picture [default: as the program has set the camera, or 320x240; with --from 640x480]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size, conflicts_with = "lcd")]
    size: Option<[u32; 2]>,
    /// Samples along each side of a pixel [default: from the camera; with --from 4]
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u32).range(1..=8), conflicts_with = "lcd")]
    samples: Option<u32>,
    /// Show the depth: 16 bits per pixel, in mm along the line of sight, 0 for the sky
    #[arg(long, conflicts_with_all = ["lcd", "labels"])]
    depth: bool,
    /// Show the label of each pixel as a colour; the palette's indices are the labels of CAMGetLabels
    #[arg(long, conflicts_with = "lcd")]
    labels: bool,
    /// The picture [default: view.png, for a display lcd.png]
    #[arg(short, long, value_name = "FILE.png")]
    output: Option<PathBuf>,
    /// Picture pixels along each side of a display pixel [default: 4 for the small display of RoBIOS 6, otherwise 2]
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u8).range(1..=16), requires = "lcd")]
    scale: Option<u8>,
    /// Show only the display's pixels, without the frame around them
    #[arg(long, requires = "lcd")]
    bare: bool,
}

const AFTER_HELP: &str = "The picture shows the scene from above; with `--robot 2` the camera view of robot 2, with `--from X,Y,Z --to X,Y,Z` \
                          the scene from this viewpoint, with `--lcd 2` the display of robot 2.";

const ROBOT_HELP: &str = "Show the camera view of this robot";

/// Subject of the picture.
enum Subject {
    Display(u32),
    View(ShotCamera),
}

impl Subject {
    /// Checks that the scene has the subject.
    fn check(&self, scene: &SceneSpec) -> anyhow::Result<()> {
        match self {
            Self::Display(robot) => index_of(scene, *robot).map(drop).context("--lcd"),
            Self::View(ShotCamera::Robot(robot)) => {
                let index = index_of(scene, *robot).context("--robot")?;
                let robi = &scene.robots[index].robi;
                match robi.camera {
                    Some(_) => Ok(()),
                    None => Err(ImageUnavailable::from(CameraError::Absent(robi.file.clone())))
                        .with_context(|| format!("--robot {robot}")),
                }
            }
            Self::View(ShotCamera::Point(_) | ShotCamera::Above) => Ok(()),
        }
    }
}

/// Runs the command. The exit code is 0, or 1 if a program failed; the picture is taken in both cases. A program that
/// still waits, for example for a key, has not failed.
///
/// # Errors
/// If files or arguments are wrong.
pub fn run(mut args: ShotArgs) -> anyhow::Result<ExitCode> {
    let subject = subject(&mut args)?;
    let _unpacked = open_for_run(&mut args.run)?;
    let default = if matches!(subject, Subject::Display(_)) { "lcd.png" } else { "view.png" };
    let output = args.output.take().unwrap_or_else(|| default.into());
    if !output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("png")) {
        bail!("-o `{}`: expected a name that ends in .png", output.display());
    }
    check_outputs(&[("-o", &output)], std::iter::empty())?;
    args.run.until = args.at.or(args.run.until);
    let Some(mut finished_run) = carry_out(&args.run, |scene| subject.check(scene))? else {
        return Ok(ExitCode::from(EXIT_PROGRAM));
    };
    finished_run.write_files(&args.run)?;
    if matches!(finished_run.finished.ended.end, EndReason::Interrupted) {
        say(format_args!("interrupted: no picture is written"));
        return Ok(ExitCode::from(EXIT_INTERRUPTED));
    }
    let (file, description) = match &subject {
        Subject::Display(robot) => display_picture(&finished_run, *robot, &args)?,
        Subject::View(camera) => view_picture(&finished_run, camera, &args)?,
    };
    let inputs = finished_run.finished.scenery.inputs();
    let inputs = inputs.iter().map(|input| input.path.as_str());
    check_outputs(
        &[("-o", &output)],
        inputs.chain(finished_run.finished.report.inputs.iter().map(|input| input.path.as_str())),
    )?;
    write_atomically(&output, &file).with_context(|| format!("-o `{}`", output.display()))?;

    // A program that still waits is not a failure here.
    finished_run.finished.report.robots.iter_mut().for_each(|robot| {
        if robot.outcome == Outcome::Waiting {
            robot.outcome = Outcome::Running;
        }
    });
    run::explain(&finished_run.finished);
    print(&format!("{}: {description}\n", output.display()))?;
    let is_failed = finished_run.finished.report.robots.iter().any(|robot| robot.outcome.is_failure());
    Ok(if is_failed { ExitCode::from(EXIT_PROGRAM) } else { ExitCode::SUCCESS })
}

/// Subject that the arguments select. Without --verbose, `--robot` selects only the camera: it is then removed from the
/// arguments of the run, where it selects the calls to show.
fn subject(args: &mut ShotArgs) -> anyhow::Result<Subject> {
    let robot = if args.run.verbose { args.run.robot } else { args.run.robot.take() };
    let subject = match (args.lcd, args.from.zip(args.to), robot) {
        (Some(_), _, Some(robot)) if !args.run.verbose => {
            bail!("--robot {robot} selects the camera view: `--lcd {robot}` shows its display")
        }
        (None, Some(_), Some(robot)) if !args.run.verbose => {
            bail!("--robot {robot} and --from are two views: expected one of them")
        }
        (Some(robot), ..) => Subject::Display(robot),
        (None, Some((from, to)), _) => Subject::View(ShotCamera::looking(from, to, args.fov)?),
        (None, None, Some(robot)) => Subject::View(ShotCamera::Robot(robot)),
        (None, None, None) => Subject::View(ShotCamera::Above),
    };
    Ok(subject)
}

/// PNG file of a display, and its description.
fn display_picture(finished_run: &FinishedRun, robot: u32, args: &ShotArgs) -> anyhow::Result<(Vec<u8>, String)> {
    let index = index_of(&finished_run.finished.scene, robot).context("--lcd")?;
    let panel = &finished_run.finished.ended.robots[index].panel;
    let time = format!("{:.3} s", finished_run.finished.report.sim_time_s);
    let caption = Caption { name: format!("{robot} {}", finished_run.finished.report.robots[index].name), time };
    let picture = display::picture(panel, args.scale, Some(&caption).filter(|_| !args.bare));
    let size = picture.size().map(|side| side as u32);
    let [width, height] = panel.picture().size();
    let description = format!("the display of r{robot} at {}, {width} x {height} pixels", caption.time);
    Ok((Pixels::Colour(picture.pixels().as_flattened()).png(size), description))
}

/// PNG file of a view, and its description.
fn view_picture(finished_run: &FinishedRun, camera: &ShotCamera, args: &ShotArgs) -> anyhow::Result<(Vec<u8>, String)> {
    let content = match args {
        ShotArgs { depth: true, .. } => Content::Depth,
        ShotArgs { labels: true, .. } => Content::Labels,
        _ => Content::Colour { samples: args.samples },
    };
    let was_unbuilt = finished_run.finished.scenery.built().is_none();
    let shot = Shot { camera, at: args.at, size: args.size, content };
    let picture = shot.take(finished_run)?;
    if let Some(built) = finished_run.finished.scenery.built().filter(|_| was_unbuilt) {
        run::report_diagnostics(&built.diagnostics, &finished_run.finished.scenery.inputs(), args.run.strict)?;
    }
    let time_s = picture.time.seconds();
    match args.at.map(|at| (at, picture.time.cmp(&at))) {
        Some((at, Ordering::Less)) => {
            say(format_args!(
                "the run was over at {time_s:.3} s, before --at {:.3}: the picture shows that time",
                at.seconds()
            ));
        }
        Some((at, Ordering::Greater)) => {
            say(format_args!(
                "--at {:.3}: a slot is longer than the stored motion of the world, the picture is of {time_s:.3} s",
                at.seconds()
            ));
        }
        _ => {}
    }
    let [width, height] = picture.size;
    let subject = match (camera, content) {
        (_, Content::Depth) => "distances",
        (_, Content::Labels) => "labels",
        (ShotCamera::Robot(_), _) => "what it sees",
        (ShotCamera::Point(_), _) => "the scene",
        (ShotCamera::Above, _) => "the scene from above",
    };
    let owner = match camera {
        ShotCamera::Robot(robot) => format!("r{robot}, "),
        ShotCamera::Point(_) | ShotCamera::Above => String::new(),
    };
    let description = format!("{owner}{subject} at {time_s:.3} s, {width} x {height} pixels");
    Ok((picture.file, description))
}

fn parse_robot(text: &str) -> Result<u32, String> {
    let number = text.strip_prefix(['r', 'R']).unwrap_or(text).parse().ok().filter(|robot| *robot > 0);
    number.ok_or_else(|| "expected a robot's number from 1, such as `2` or `r2`".into())
}

/// Parses a point in millimetres; the result is in metres.
fn parse_point(text: &str) -> Result<DVec3, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|word| word.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some([x, y, z]) if [x, y, z].iter().all(|mm| mm.abs() <= 1e9) => {
            Ok(DVec3::new(*x, *y, *z).map(sim_core::unit::metres_from_mm))
        }
        _ => Err("expected three numbers of millimetres, such as `1000,500,300`".into()),
    }
}

/// Parses an angle in degrees; the result is in radians.
fn parse_fov(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(degrees) if (1.0..=view::MAX_FOV_DEG).contains(&degrees) => {
            Ok(sim_core::unit::radians_from_degrees(degrees))
        }
        _ => Err(format!("expected 1 to {} degrees", view::MAX_FOV_DEG)),
    }
}

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let sides =
        text.split_once(['x', 'X']).and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    let is_size = |sides: &[u32; 2]| sides.iter().all(|side| (1..=view::MAX_SIDE).contains(side));
    sides
        .filter(is_size)
        .ok_or_else(|| format!("expected WIDTHxHEIGHT, each 1 to {}, such as `640x480`", view::MAX_SIDE))
}
