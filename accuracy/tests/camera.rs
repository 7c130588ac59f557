//! Pictures of cameras, compared with the slow reference: the colours of every pixel agree within a grey level, except
//! on silhouettes.

use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use accuracy::camera::{Agreement, Reference, Shot};
use accuracy::room;
use accuracy::world::{Random, empty};
use glam::DVec3;
use rayon::iter::{IndexedParallelIterator as _, IntoParallelIterator as _, ParallelIterator as _};
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
const VIEWS: usize = 24;

const LENSES: [Lens; 2] = [Lens::Pinhole { fov: 1.0 }, Lens::Fisheye { fov: 2.8 }];

/// File system of this machine, with the repository as the installation's folder.
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

/// All sample scenes, and all sample worlds as scenes without robots.
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

/// Random view number `number`, and the robot that carries the camera. Every other view is from a robot, if the scene
/// has robots; the others are from points above the floor.
fn random_view(random: &mut Random, scene: &SceneSpec, number: usize, size: [u32; 2]) -> (View, Option<RobotId>) {
    let lens = LENSES[number / 2 % 2];
    let [roll, pitch, yaw] = [0.3, 0.6, PI].map(|max| random.between(-max, max));
    let floor = scene.world.floor;
    let mut random_point =
        || DVec3::new(random.between(0.0, floor.x), random.between(0.0, floor.y), random.between(0.02, 1.5));
    let robots = &scene.robots;
    let (position, by) = if number.is_multiple_of(2) || robots.is_empty() {
        (random_point(), None)
    } else {
        let robot = &robots[random.below(robots.len())];
        (robot.start.position.extend(0.12), Some(robot.id))
    };
    let pose = Pose3::from_angles(position, roll, if by.is_some() { 0.3 * pitch } else { pitch }, yaw);
    (View::new(pose, lens, size).expect("a view"), by)
}

fn compare(posed: &PosedScenery, views: impl IntoIterator<Item = (View, Option<RobotId>)>) -> Agreement {
    let mut reference = Reference::new(posed, None);
    let mut camera = Camera::default();
    let mut agreement = Agreement::default();
    for (view, by) in views {
        reference = reference.by(by);
        agreement += Agreement::of(&Shot::take(&mut camera, posed, &view, by), &reference, &view);
    }
    agreement
}

/// Agreement of random pictures of a sample scene, number `index` of all, with the reference.
fn agreement_in((index, (name, mut scene)): (usize, (String, SceneSpec))) -> Agreement {
    // Every other scene has shadows, regardless of its setting.
    scene.world.looks.light.shadows |= index % 2 == 1;
    let disk = Disk(root().to_string_lossy().into_owned());
    let scenery = build::scenery(&scene, &mut MeshReader::new(&disk));
    let world = world(&scene);
    let posed = scenery.pose_at(&world, Time::ZERO);
    let mut random = Random::new(72);
    let views = (0..VIEWS).map(|number| random_view(&mut random, &scene, number, [16, 12]));
    let agreement = compare(&posed, views);
    println!("{name}: {} of {} pixels differ", agreement.differing, agreement.pixels);
    agreement.assert_right(&name);
    agreement
}

#[test]
fn sample_worlds_match_the_reference() {
    let agreements: Vec<Agreement> = scenes().into_par_iter().enumerate().map(agreement_in).collect();
    let mut total = Agreement::default();
    agreements.into_iter().for_each(|agreement| total += agreement);
    println!("all: {} of {} pixels differ", total.differing, total.pixels);
    assert!(total.share() < 1e-3, "{}", total.share());
}

#[test]
fn furnished_room_matches_the_reference() {
    for shadows in [false, true] {
        let scenery = room::scenery(Light { shadows, ..room::light() });
        let posed = scenery.pose_at(&empty(), Time::ZERO);
        let mut random = Random::new(71);
        let mut view = |number: usize| {
            let position = DVec3::new(random.between(0.2, 7.8), random.between(0.2, 7.8), random.between(0.1, 1.5));
            let [roll, pitch, yaw] = [0.3, 0.6, PI].map(|max| random.between(-max, max));
            let pose = Pose3::from_angles(position, roll, pitch, yaw);
            (View::new(pose, LENSES[number % 2], [24, 18]).expect("a view"), None)
        };
        let agreement = compare(&posed, (0..80).map(&mut view));
        println!("shadows {shadows}: {} of {} pixels differ", agreement.differing, agreement.pixels);
        agreement.assert_right("room");
        assert!(agreement.share() < 0.005, "{}", agreement.share());
    }
}
