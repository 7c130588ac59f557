//! Sceneries built from scenes: the bodies that cameras see.

use std::f64::consts::TAU;
use std::io::Cursor;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use sim_core::build::{SpawnedEntity, Visuals, scenery};
use sim_core::camera::{Attachment, Camera, Label, Lens, Light, Part, Picture, Scenery, Sky, View};
use sim_core::math;
use sim_core::pose::Pose3;
use sim_core::scene::{Mesh, Triangle, Walls};
use sim_core::spec::{Collider, LightSpec, ObjectType, RobiSpec, SceneSpec};
use sim_core::time::Time;
use sim_core::world::World;
use sim_core::{ObjectId, RobotId};
use sim_format::{MemoryFiles, MeshReader, builtin, load_scene, load_world, read_companion, read_robi};

fn memory<const N: usize>(texts: [(&'static str, &str); N]) -> MemoryFiles {
    texts.into_iter().collect()
}

fn of(scene: &SceneSpec, files: &MemoryFiles) -> Scenery {
    let mut reader = MeshReader::new(files);
    let scenery = scenery(scene, &mut reader);
    assert_eq!(reader.finish().0, []);
    scenery
}

fn area(mesh: &Mesh, face: &Triangle) -> f64 {
    let [a, b, c] = mesh.corners(face);
    0.5 * (b - a).cross(c - a).length()
}

const WALLS: &str = "floor 4000 3000\n0 0 4000 0\n4000 0 4000 3000 0 150 1 2 3\n1000 1000 2500 1700 40 300\n";

#[test]
fn walls_stand_on_the_floor_and_share_bit_identical_corners() {
    let files = memory([("a.wld", WALLS)]);
    let scenery = of(&load_world("a.wld", &files).scene, &files);
    let [south, east, slanting] = scenery.parts() else { panic!("three walls") };
    assert_eq!([south.label, east.label, slanting.label], [0, 1, 2].map(Label::Wall));
    let foot = DVec3::new(4.0, 0.0, 0.0);
    for sheet in [south, east] {
        assert!(sheet.mesh.positions.contains(&foot), "{:?}", sheet.mesh.positions);
        assert_eq!(sheet.mesh.triangles.len(), 2);
    }
    let areas = |part: &Part| part.mesh.triangles.iter().map(|face| area(&part.mesh, face)).sum::<f64>();
    assert!((areas(south) - 4.0 * 0.2).abs() < 1e-12 && (areas(east) - 3.0 * 0.15).abs() < 1e-12);
    let length = math::hypot(1.5, 0.7);
    let expected = length * 0.04 + 2.0 * (length + 0.04) * 0.3;
    assert!((areas(slanting) - expected).abs() < 1e-12, "four sides and a top");
    assert_eq!(east.mesh.materials[0].colour, [1, 2, 3].map(|shade: u8| f32::from(shade) / 255.0));
    let low = slanting.mesh.bounds().expect("faces").0;
    assert_eq!(low.z, 0.0);
}

#[test]
fn a_scene_has_its_ground_markers_objects_and_robots() {
    const SCENE: &str = "[world]\nfloor_mm = [2000, 1000]\ncolour = [9, 8, 7]\nlight = { shadows = true, ambient = 0.2 }\n\
        sky = { ground = [3, 2, 1] }\n\
        [[object_type]]\nname = \"Post\"\nfixed = true\ncolour = [1, 1, 1]\ncollider = { kind = \"cylinder\", radius_mm = 20, height_mm = 300 }\n\
        [[object]]\ntype = \"Can\"\nx_mm = 300\ny_mm = 300\n[[object]]\ntype = \"Post\"\nx_mm = 500\ny_mm = 300\n\
        [[object]]\ntype = \"can\"\nx_mm = 900\ny_mm = 300\n\
        [[robot]]\ntype = \"S4\"\ncount = 7\nlayout = { kind = \"grid\", from_mm = [200, 500], spacing_mm = [250, 250], columns = 7 }\n\
        [[marker]]\nx_mm = 100\ny_mm = 900\ncolour = [0, 0, 255]\nopacity = 100\n";
    let files = memory([("a.scene.toml", SCENE)]);
    let loaded = load_scene("a.scene.toml", &files);
    assert_eq!(loaded.diagnostics, []);
    let scenery = of(&loaded.scene, &files);
    let ground = scenery.ground().expect("a ground");
    let floor = ground.floor.as_ref().expect("a floor");
    assert_eq!((ground.colour, floor.colour, floor.texture.is_none()), ([3, 2, 1], [9, 8, 7], true));
    assert_eq!((ground.spots.len(), ground.spots[0].colour), (1, [0, 0, 255, 100]));
    let light = scenery.light();
    assert!(light.shadows && (light.ambient + light.fill + light.diffuse - 1.0).abs() < 1e-12);
    assert!((light.sun_direction.length() - 1.0).abs() < 1e-12 && light.sun_direction.z > 0.7);
    let labels: Vec<Label> = scenery.parts().iter().map(|part| part.label).collect();
    assert_eq!(labels[..3], [Label::Object(ObjectId(1)), Label::Fixed(1), Label::Object(ObjectId(2))]);
    assert_eq!(labels[3..], [1, 2, 3, 4, 5, 6, 7].map(|id| Label::Robot(RobotId(id))));
    let meshes: Vec<_> = scenery.parts().iter().map(|part| Arc::as_ptr(&part.mesh)).collect();
    assert_eq!(meshes[0], meshes[2], "objects of one type share their mesh");
    assert_eq!(meshes[3], meshes[9], "and robots of one type and colour");
    assert_ne!(meshes[3], meshes[4]);
}

#[test]
fn a_terrain_takes_the_place_of_the_ground() {
    const SCENE: &str = "[world]\nfloor_mm = [2000, 1000]\nterrain = \"h.obj\"\n";
    let files = memory([("a.scene.toml", SCENE), ("h.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n")]);
    let scenery = of(&load_scene("a.scene.toml", &files).scene, &files);
    assert!(scenery.ground().is_none());
    assert_eq!((scenery.parts().len(), scenery.parts()[0].label), (1, Label::Ground));
}

/// Bounding boxes of the parts of a mesh whose faces are connected by shared corners.
fn pieces(mesh: &Mesh) -> Vec<(DVec3, DVec3)> {
    let mut pieces: Vec<(DVec3, DVec3)> = Vec::new();
    for face in &mesh.triangles {
        let corners = mesh.corners(face);
        let low = corners.into_iter().reduce(DVec3::min).expect("corners");
        let high = corners.into_iter().reduce(DVec3::max).expect("corners");
        pieces.push((low, high));
    }
    pieces
}

/// Returns true if all faces are supported: connected to the floor through faces whose boxes touch.
fn stands(mesh: &Mesh) -> bool {
    const TOUCH: f64 = 1e-6;
    let mut open = pieces(mesh);
    let mut reached: Vec<(DVec3, DVec3)> = Vec::new();
    let (on_floor, rest) = open.drain(..).partition(|(low, _)| low.z < TOUCH);
    let mut front: Vec<(DVec3, DVec3)> = on_floor;
    let mut rest: Vec<(DVec3, DVec3)> = rest;
    while let Some((low, high)) = front.pop() {
        let meets =
            |other: &(DVec3, DVec3)| (other.0 - high).max_element() <= TOUCH && (low - other.1).max_element() <= TOUCH;
        let (next, others) = rest.into_iter().partition(meets);
        rest = others;
        front.extend::<Vec<_>>(next);
        reached.push((low, high));
    }
    rest.is_empty() && !reached.is_empty()
}

/// Robot types with every kind of drive and body, and some unusual ones.
fn types() -> Vec<RobiSpec> {
    let vr = |shape: &str| format!("drive DIFFERENTIAL_DRIVE\ncollider {shape}\naxis 22 0\nwheel 45 3600 540 70\n");
    let texts = [
        include_str!("../../robis/car.robi").to_owned(),
        include_str!("../../robis/mecanum.robi").to_owned(),
        include_str!("../../robis/scout.robi").to_owned(),
        include_str!("../../robis/lab.robi").to_owned(),
        vr("box 180 145 200 0 102 20"),
        vr("sphere 90 0 100 0"),
        vr("capsule 60 200 0 120 0"),
        vr("box 80 45 100 0 200 0"),
        "drive DIFFERENTIAL_DRIVE\ndiameter 100\nwheel 120 3600 540 140\ncamera 0 0 20 0 0 80 60\n".to_owned(),
        "drive ACKERMANN_DRIVE\ndiameter 200\nwheel 20 3600 540 20\ncamera 90 0 300 30 -20 80 60\n".to_owned(),
    ];
    let read = texts.iter().map(|text| {
        let mut robi = read_robi("a.robi", text).0;
        assert_eq!(read_companion("a.toml", "", &mut robi), []);
        robi
    });
    read.chain(builtin::ROBOTS.iter().filter_map(|name| builtin::robot(name)).map(Arc::unwrap_or_clone)).collect()
}

/// Mesh of a robot of this type.
fn looks(robi: &RobiSpec) -> Arc<Mesh> {
    first_part_of(SpawnedEntity::Robot(RobotId(1), Arc::new(robi.clone())))
}

/// First part of the camera view of a spawned entity in an empty world.
fn first_part_of(entity: SpawnedEntity) -> Arc<Mesh> {
    let files = memory([]);
    let mut reader = MeshReader::new(&files);
    let mut visuals = Visuals::new(&SceneSpec::default(), &mut reader);
    visuals.add([entity], &mut reader);
    Arc::clone(&visuals.scenery().parts()[0].mesh)
}

#[test]
fn bodies_stand_on_the_floor_and_no_part_of_them_hangs_in_the_air() {
    for robi in types() {
        let mesh = looks(&robi);
        let (low, high) = mesh.bounds().expect("faces");
        // A polygonal wheel deviates slightly from its circle.
        assert!(low.z.abs() <= 0.01 * robi.wheel.diameter, "{}: {low}", robi.name);
        assert!(high.z < 3.0 * robi.diameter.max(robi.wheel.diameter).max(0.1), "{}: {high}", robi.name);
        assert!(mesh.triangles.iter().all(|face| area(&mesh, face) > 0.0));
        assert!(mesh.triangles.len() < 1200, "{}: {} faces", robi.name, mesh.triangles.len());
        assert!(stands(&mesh), "a part of `{}` hangs in the air", robi.name);
    }
}

#[test]
fn the_test_detects_a_part_in_the_air() {
    let boxes = |heights: &[f64]| {
        let collider = |z: &f64| Collider::Box { centre: DVec3::new(0.0, 0.0, *z), size: DVec3::splat(0.1) };
        let kind =
            ObjectType { colliders: heights.iter().map(collider).collect(), ..ObjectType::with_defaults("a.esObj") };
        first_part_of(SpawnedEntity::Object(ObjectId(1), Arc::new(kind)))
    };
    assert!(stands(&boxes(&[0.05, 0.13])));
    assert!(!stands(&boxes(&[0.05, 0.16])));
}

const RED: [u8; 3] = [255, 0, 0];
const GREEN: [u8; 3] = [0, 255, 0];
const BLUE: [u8; 3] = [0, 0, 255];
const YELLOW: [u8; 3] = [255, 255, 0];

/// Image of four fields: red and green above, blue and yellow below.
fn fields() -> image::RgbaImage {
    image::RgbaImage::from_fn(64, 64, |column, row| {
        let [red, green, blue] = [[RED, GREEN], [BLUE, YELLOW]][row as usize / 32][column as usize / 32];
        image::Rgba([red, green, blue, 255])
    })
}

/// Picture of a static scenery.
fn seen(scenery: &Scenery, from: DVec3, to: DVec3, size: [u32; 2]) -> Picture<[u8; 3]> {
    let pose = View::look_at(from, to).expect("a direction");
    let view = View::new(pose, Lens::Pinhole { fov: 0.7 }, size).expect("a view");
    let world = World::new(Arc::new(Walls::new(Vec::new())), Time::from_millis(50), []);
    Camera::default().colour(&scenery.pose_at(&world, Time::ZERO), &view, None, 1)
}

/// Scenery with a single mesh.
fn alone(mesh: Arc<Mesh>) -> Scenery {
    let attachment = Attachment::Fixed(Pose3::IDENTITY);
    let part = Part { mesh, label: Label::Fixed(0), attachment };
    let white = Light { sun_direction: DVec3::Z, ambient: 1.0, fill: 0.0, diffuse: 0.0, shadows: false };
    Scenery::new(vec![part], None, white, Sky { horizon: [0; 3], zenith: [0; 3] })
}

#[test]
fn the_image_of_the_floor_lies_as_the_world_is_drawn() {
    let mut png = Cursor::new(Vec::new());
    fields().write_to(&mut png, image::ImageFormat::Png).expect("an image");
    let mut files = memory([("a.wld", "floor 1000 1000\nfloor_texture f.png\n")]);
    files.insert("f.png", png.into_inner());
    let scene = SceneSpec { world: load_world("a.wld", &files).scene.world, ..SceneSpec::default() };
    let full = LightSpec { ambient: 1.0, ..LightSpec::default() };
    let mut scene = scene;
    scene.world.looks.light = full;
    let scenery = of(&scene, &files);
    // View from above, with y upwards in the picture; a `.wld` turns the floor's image by 180 degrees.
    let picture = seen(&scenery, DVec3::new(0.5, 0.5, 1.2), DVec3::new(0.5, 0.5, 0.0), [40, 40]);
    let corners = [(10, 10), (30, 10), (10, 30), (30, 30)].map(|(column, row)| *picture.pixel(column, row));
    assert_eq!(corners, [YELLOW, BLUE, GREEN, RED]);
    // View from a point at the floor's lower border.
    let picture = seen(&scenery, DVec3::new(0.5, -0.7, 0.6), DVec3::new(0.5, 0.5, 0.0), [40, 40]);
    let corners = [(14, 16), (26, 16), (12, 24), (28, 24)].map(|(column, row)| *picture.pixel(column, row));
    assert_eq!(corners, [YELLOW, BLUE, GREEN, RED]);
    // The image is upright if the world does not turn it.
    scene.world.texture_is_turned = false;
    let picture = seen(&of(&scene, &files), DVec3::new(0.5, 0.5, 1.2), DVec3::new(0.5, 0.5, 0.0), [40, 40]);
    let corners = [(10, 10), (30, 10), (10, 30), (30, 30)].map(|(column, row)| *picture.pixel(column, row));
    assert_eq!(corners, [RED, GREEN, BLUE, YELLOW]);
}

#[test]
fn the_heading_of_a_body_is_seen_from_every_side_and_from_above() {
    // Visible details on a blue body: lamps at the sides and the back, lamps at the front and the nose.
    let is_red = |[r, g, b]: [u8; 3]| r > 150 && g < 80 && b < 80;
    let is_green = |[r, g, b]: [u8; 3]| g > 180 && r < 80 && b < 110;
    let is_white = |[r, g, b]: [u8; 3]| r > 220 && g > 220 && b > 220;
    let is_screen = |[r, g, b]: [u8; 3]| g > 150 && (120..180).contains(&r) && b < 140;
    // On the unusual types wheels hide the sides.
    for robi in types().into_iter().filter(|robi| robi.colliders.is_empty() && robi.name != "a") {
        let scenery = alone(looks(&robi));
        let middle = DVec3::new(0.0, 0.0, 0.2 * robi.diameter);
        let count = |angle: f64, is: &dyn Fn([u8; 3]) -> bool| {
            let direction = DVec3::new(math::cos(angle), math::sin(angle), 0.3);
            let picture = seen(&scenery, middle + 3.0 * robi.diameter * direction, middle, [80, 60]);
            picture.pixels().iter().filter(|pixel| is(**pixel)).count()
        };
        let [front, left, back, right] = [0.0, 0.25, 0.5, 0.75].map(|turn| turn * TAU);
        let name = &robi.name;
        // From the front, the edges of the side lamps are visible.
        let white = count(front, &is_white);
        assert!(white > 4 && 3 * count(front, &is_red).max(count(front, &is_green)) < white, "{name} from its front");
        assert_eq!(count(front, &is_screen), 0, "{name} from its front");
        assert!(count(back, &is_red) > 4 && count(back, &is_screen) > 4, "{name} from behind");
        assert!(count(left, &is_red) > 2 && count(left, &is_green) == 0, "{name} from its left");
        assert!(count(right, &is_green) > 2, "{name} from its right");
        let picture = seen(&scenery, DVec3::new(0.0, 0.0, 4.0 * robi.diameter), DVec3::ZERO, [80, 80]);
        let mean = |is: &dyn Fn([u8; 3]) -> bool| {
            let pixels = (0..80).flat_map(|row| (0..80).map(move |column| (column, row)));
            let hits = pixels.filter(|(column, row)| is(*picture.pixel(*column, *row)));
            let hits: Vec<DVec2> = hits.map(|(column, row)| DVec2::new(f64::from(column), f64::from(row))).collect();
            hits.iter().sum::<DVec2>() / hits.len() as f64
        };
        // From above, x lies to the right.
        let (nose, screen) = (mean(&is_white), mean(&is_screen));
        assert!(nose.x > screen.x + 4.0 && (nose.y - screen.y).abs() < 2.0, "{name} from above: {nose} {screen}");
    }
}
