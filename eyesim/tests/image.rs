//! A robot commanded through the library gets the same images as a program: pixel by pixel, with camera noise, at the
//! same instants.

use std::path::Path;
use std::process::Command;

use serde_json::Value;
use sim_core::RobotId;
use sim_core::build::Visuals;
use sim_core::drive;
use sim_core::pose::Twist;
use sim_core::simulation::{Options, Simulation};
use sim_core::time::Time;
use sim_format::{MeshReader, load_scene};
use sim_host::files::DiskFiles;

/// Program that drives a curve and takes three images.
const LOOK: &str = r#"
#include "eyebot.h"
static BYTE image[QVGA_SIZE];
int main(void) {
    CAMInit(QVGA);
    CAMGet(image);
    VWSetSpeed(300, 40);
    OSWait(333);
    CAMGet(image);
    OSWait(777);
    CAMGet(image);
    return 0;
}
"#;

const SCENE: &str = r#"
[world]
floor_mm = [4000, 3000]
wall = [{ from_mm = [3500, 0], to_mm = [3500, 3000] }]

[[robot]]
type = "LabBot"
x_mm = 1000
y_mm = 1500
noise = "harsh"
program = "look.c"

[[robot]]
type = "S4"
x_mm = 2500
y_mm = 1800

[[object]]
type = "Soccer"
x_mm = 2500
y_mm = 1250
"#;

/// Converts seconds of a trace to a time.
fn time(seconds: f64) -> Time {
    Time((seconds * 1e6).round() as i64)
}

/// Names and pixels of the images in `folder`, sorted by name.
fn images(folder: &Path) -> Vec<(String, image::RgbImage)> {
    let files = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
    let mut files: Vec<_> = files.collect();
    files.sort();
    let read = |path: &std::path::PathBuf| {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        (name, image::open(path).expect("an image").into_rgb8())
    };
    files.iter().map(read).collect()
}

#[test]
fn library_commands_take_the_same_images_as_a_program() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("look.c"), LOOK).expect("a program");
    std::fs::write(path("look.scene.toml"), SCENE).expect("a scene");
    let output = Command::new(env!("CARGO_BIN_EXE_eyesim"))
        .args(["run", "look.scene.toml", "--seed", "7", "--quiet", "--trace", "trace.jsonl", "--frames", "frames"])
        .current_dir(folder.path())
        .output()
        .expect("eyesim starts");
    assert!(output.status.success(), "{output:?}");
    let trace = std::fs::read_to_string(path("trace.jsonl")).expect("a trace");
    let lines: Vec<Value> = trace.lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    let frames: Vec<&Value> = lines.iter().filter(|line| line["event"] == "frame").collect();
    let driven = lines.iter().find(|line| line["event"] == "drive_speed").expect("the command");
    let images = images(&path("frames"));
    assert_eq!((frames.len(), images.len()), (3, 3));

    let name = path("look.scene.toml");
    let scene = load_scene(&name.to_string_lossy(), &DiskFiles::default()).scene;
    let mut simulation = Simulation::new(&scene, &Options { seed: Some(7), ..Options::default() }).expect("robots");
    simulation.set_visuals(Visuals::new(&scene, &mut MeshReader::new(&DiskFiles::default())));
    let robot = RobotId(1);
    for (frame, (name, expected)) in frames.iter().zip(&images) {
        let at = time(frame["t_s"].as_f64().expect("a time"));
        let command = time(driven["t_s"].as_f64().expect("a time"));
        if simulation.now() < command && command <= at {
            simulation.advance_to(command);
            let twist = Twist::new(0.3, 40_f64.to_radians());
            simulation.command(robot, drive::Command::Twist(twist)).expect("it drives");
        }
        simulation.advance_to(at);
        let image = simulation.image(robot).expect("an image");
        assert_eq!(image.size(), [expected.width(), expected.height()]);
        assert!(image.pixels().as_flattened() == expected.as_raw().as_slice(), "{name}");
    }
}
