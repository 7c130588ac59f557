//! Pictures of cameras against the slow reference: every pixel equal to within a grey level, except on silhouettes.

use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use accuracy::camera::{Agreement, Reference, Shot};
use accuracy::room;
use accuracy::world::{Random, empty};
use glam::DVec3;
use sim_core::RobotId;
use sim_core::build;
use sim_core::camera::{Camera, Lens, Light, PosedScenery, View};
use sim_core::drive::Motion;
use sim_core::pose::Pose3;
use sim_core::spec::{RobotSpec, SceneSpec};
use sim_core::time::Time;
use sim_core::world::World;
use sim_format::{FileError, Files, MeshReader, load_scene, load_world};

/// Number of views of each sample world.
const VIEWS: usize = 100;

const LENSES: [Lens; 2] = [Lens::Pinhole { fov: 1.0 }, Lens::Fisheye { fov: 2.8 }];

/// File system rooted at the repository.
struct Disk(String);

impl Files for Disk {
    fn read(&self, path: &str) -> Result<Vec<u8>, FileError> {
        if !Path::new(path).is_file() {
            return Err(FileError::Missing);
        }
        fs::read(path).map_err(|error| FileError::Unreadable(error.to_string()))
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        entries.filter_map(|entry| entry.file_name().into_string().ok()).collect()
    }

    fn home(&self) -> Option<&str> {
        Some(&self.0)
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Sorted names of the files in a folder of the repository.
fn names(folder: &str) -> Vec<String> {
    let entries = fs::read_dir(root().join(folder)).expect("a folder").flatten();
    let mut names: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort();
    names
}

/// All scenes, and all worlds as scenes without robots.
fn scenes() -> Vec<(String, SceneSpec)> {
    let disk = Disk(root().to_string_lossy().into_owned());
    let scene = &|folder: &str, name: String| {
        let path = root().join(folder).join(&name).to_string_lossy().into_owned();
        let loaded = match Path::new(&name).extension()?.to_str()? {
            "sim" | "toml" => load_scene(&path, &disk),
            "wld" | "world" => load_world(&path, &disk),
            "maz" => load_world(&path, &disk),
            _ => return None,
        };
        assert!(!loaded.has_errors(), "{name}: {:?}", loaded.diagnostics);
        Some((name, loaded.scene))
    };
    let in_folder = |folder| names(folder).into_iter().filter_map(move |name| scene(folder, name));
    ["sims", "worlds"].into_iter().flat_map(in_folder).collect()
}

fn world(scene: &SceneSpec) -> World {
    let walls = build::obstacles(scene);
    let motion =
        |robot: &RobotSpec| Motion::new(robot.id, Arc::new(build::model(&robot.robi)), Arc::clone(&walls), robot.start);
    let mut motions: Vec<Motion> = scene.robots.iter().map(motion).collect();
    let objects = build::movable_objects(scene).map(|object| (build::properties(object), object.pose));
    World::new(Arc::clone(&walls), Time::from_millis(50), &mut motions).with_objects(objects)
}

/// View from a random point over the floor, every other one from a robot, and that robot.
fn any_view(random: &mut Random, scene: &SceneSpec, number: usize, size: [u32; 2]) -> (View, Option<RobotId>) {
    let lens = LENSES[number / 2 % 2];
    let [roll, pitch, yaw] = [0.3, 0.6, PI].map(|most| random.between(-most, most));
    let floor = scene.world.floor;
    let mut anywhere =
        || DVec3::new(random.between(0.0, floor.x), random.between(0.0, floor.y), random.between(0.02, 1.5));
    let robots = &scene.robots;
    let (from, by) = if number.is_multiple_of(2) || robots.is_empty() {
        (anywhere(), None)
    } else {
        let robot = &robots[random.below(robots.len())];
        (robot.start.position.extend(0.12), Some(robot.id))
    };
    let pose = Pose3::from_angles(from, roll, if by.is_some() { 0.3 * pitch } else { pitch }, yaw);
    (View::new(pose, lens, size).expect("a view"), by)
}

fn agreement_of(posed: &PosedScenery, views: impl IntoIterator<Item = (View, Option<RobotId>)>) -> Agreement {
    let mut reference = Reference::new(posed, None);
    let mut camera = Camera::default();
    let mut agreement = Agreement::default();
    for (view, by) in views {
        reference = reference.by(by);
        agreement += Agreement::of(&Shot::take(&mut camera, posed, &view, by), &reference, &view);
    }
    agreement
}

#[test]
fn sample_worlds_look_as_the_reference_says() {
    let mut all = Agreement::default();
    for (place, (name, mut scene)) in scenes().into_iter().enumerate() {
        // Every other scene with shadows, regardless of its own setting.
        scene.world.looks.light.shadows |= place % 2 == 1;
        let disk = Disk(root().to_string_lossy().into_owned());
        let scenery = build::scenery(&scene, &mut MeshReader::new(&disk));
        let world = world(&scene);
        let posed = scenery.pose_at(&world, Time::ZERO);
        let mut random = Random::new(72);
        let views = (0..VIEWS).map(|number| any_view(&mut random, &scene, number, [16, 12]));
        let agreement = agreement_of(&posed, views);
        println!("{name}: {} of {} pixels differ", agreement.differing, agreement.pixels);
        agreement.assert_right(&name);
        all += agreement;
    }
    println!("all: {} of {} pixels differ", all.differing, all.pixels);
    assert!(all.share() < 1e-3, "{}", all.share());
}

#[test]
fn a_furnished_room_looks_as_the_reference_says() {
    for shadows in [false, true] {
        let scenery = room::scenery(Light { shadows, ..room::light() });
        let posed = scenery.pose_at(&empty(), Time::ZERO);
        let mut random = Random::new(71);
        let mut view = |number: usize| {
            let from = DVec3::new(random.between(0.2, 7.8), random.between(0.2, 7.8), random.between(0.1, 1.5));
            let [roll, pitch, yaw] = [0.3, 0.6, PI].map(|most| random.between(-most, most));
            let pose = Pose3::from_angles(from, roll, pitch, yaw);
            (View::new(pose, LENSES[number % 2], [24, 18]).expect("a view"), None)
        };
        let agreement = agreement_of(&posed, (0..80).map(&mut view));
        println!("shadows {shadows}: {} of {} pixels differ", agreement.differing, agreement.pixels);
        agreement.assert_right("room");
        assert!(agreement.share() < 0.005, "{}", agreement.share());
    }
}
