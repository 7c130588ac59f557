//! Takes a picture with a robot's camera and writes its colours, depths and labels as three PNG files into a folder.
//!
//! `cargo run --release -p sim-format --example picture FOLDER`

use std::path::Path;

use image::{GrayImage, Luma, Rgb, RgbImage};
use sim_core::RobotId;
use sim_core::build::Visuals;
use sim_core::camera::{Label, Picture};
use sim_core::simulation::{Options, Simulation};
use sim_core::time::Time;
use sim_format::{MemoryFiles, MeshReader, load_scene};

const SCENE: &str = r#"
[world]
floor_mm = [4000, 3000]
wall = [
    { from_mm = [3500, 0], to_mm = [3500, 3000] },
    { from_mm = [0, 3000], to_mm = [3500, 3000] },
]

[[robot]]
type = "LabBot"
x_mm = 1000
y_mm = 1500
noise = "mild"

[[robot]]
type = "S4"
x_mm = 1800
y_mm = 1750
heading_deg = 200

[[object]]
type = "Soccer"
x_mm = 1700
y_mm = 1400

[[object]]
type = "Can"
x_mm = 2000
y_mm = 1200
"#;

/// Depth shown as black in the picture of depths, m.
const FAR: f32 = 3.0;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = std::env::args().nth(1).ok_or("expected a folder for the pictures")?;
    let files: MemoryFiles = [("room.scene.toml", SCENE)].into_iter().collect();
    let scene = load_scene("room.scene.toml", &files).scene;

    let mut simulation = Simulation::new(&scene, &Options::default())?;
    simulation.set_visuals(Visuals::new(&scene, &mut MeshReader::new(&files)));
    simulation.advance_to(Time::from_millis(1_000));
    let robot = RobotId(1);
    let image = simulation.image(robot)?;
    let (depth, labels) = (simulation.depth(robot)?, simulation.labels(robot)?);

    std::fs::create_dir_all(&folder)?;
    let path = |name: &str| Path::new(&folder).join(name);
    drawn(&image, |rgb| *rgb).save(path("colour.png"))?;
    let [width, height] = depth.size();
    // The nearer, the brighter.
    let shade = |metres: &f32| (255.0 * (1.0 - metres / FAR)) as u8;
    GrayImage::from_fn(width, height, |column, row| Luma([shade(depth.pixel(column, row))])).save(path("depth.png"))?;
    drawn(&labels, colour).save(path("labels.png"))?;
    Ok(())
}

fn drawn<T>(picture: &Picture<T>, colour: impl Fn(&T) -> [u8; 3]) -> RgbImage {
    let [width, height] = picture.size();
    RgbImage::from_fn(width, height, |column, row| Rgb(colour(picture.pixel(column, row))))
}

/// Colour of a label: one per kind of entity, several for the numbers of robots and objects.
fn colour(label: &Label) -> [u8; 3] {
    match label {
        Label::Sky => [210, 230, 250],
        Label::Ground => [150, 150, 150],
        Label::Wall(number) => [90, 90 + 25 * (number % 4) as u8, 110],
        Label::Fixed(_) => [60, 60, 60],
        Label::Object(id) => [230, 60 + 70 * (id.0 % 3) as u8, 30],
        Label::Robot(id) => [40, 60 + 70 * (id.0 % 3) as u8, 220],
    }
}
