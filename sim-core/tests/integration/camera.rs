//! Pictures, depths and labels of a small scene, with values known from geometry.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};
use std::sync::Arc;

use glam::{DVec2, DVec3, Vec2};
use sim_core::RobotId;
use sim_core::camera::{Attachment, Camera, Floor, Ground, Label, Lens, Light, Part, Scenery, Sky, Spot, View};
use sim_core::pose::Pose3;
use sim_core::scene::{Material, Mesh, Texture, Triangle, Walls};
use sim_core::time::Time;
use sim_core::world::World;

const LIGHT: Light = Light { sun_direction: DVec3::Z, ambient: 0.5, fill: 0.0, diffuse: 0.5, shadows: false };
const SKY: Sky = Sky { horizon: [200, 210, 220], zenith: [100, 150, 200] };

/// An upright square with sides of 2 m, centred on the x axis at `x`, facing the origin.
fn square(x: f64, material: Material) -> Arc<Mesh> {
    let positions = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[y, z]| DVec3::new(x, -y, z));
    let uv = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let face = |corners: [u32; 3]| Triangle {
        corners,
        normals: None,
        uv: Some(corners.map(|corner| uv[corner as usize])),
        material: 0,
    };
    Arc::new(Mesh {
        positions: positions.to_vec(),
        triangles: vec![face([0, 1, 2]), face([0, 2, 3])],
        materials: vec![material],
    })
}

fn pose_at_height(z: f64) -> Pose3 {
    Pose3::from_angles(DVec3::new(0.0, 0.0, z), 0.0, 0.0, 0.0)
}

fn wall(material: Material) -> Part {
    Part { mesh: square(2.0, material), label: Label::Wall(3), attachment: Attachment::Fixed(pose_at_height(1.0)) }
}

fn world() -> World {
    World::new(Arc::new(Walls::new(Vec::new())), Time::from_millis(50), [])
}

fn ground() -> Ground {
    Ground {
        colour: [80, 80, 80],
        floor: Some(Floor { size: DVec2::splat(1.5), colour: [160, 120, 80], texture: None }),
        spots: vec![Spot { centre: DVec2::new(1.0, 0.5), radius: 0.2, colour: [0, 0, 200, 255] }],
    }
}

fn view(z: f64, pitch: f64, size: [u32; 2]) -> View {
    let pose = Pose3::from_angles(DVec3::new(0.0, 0.0, z), 0.0, pitch, 0.0);
    View::new(pose, Lens::Pinhole { fov: FRAC_PI_2 }, size).expect("a view")
}

#[test]
fn wall_ground_and_sky_have_known_pixels() {
    let scenery = Scenery::new(vec![wall(Material::default())], Some(ground()), LIGHT, SKY);
    let posed = scenery.pose_at(&world(), Time::ZERO);
    let (mut camera, view) = (Camera::default(), view(1.0, 0.0, [101, 101]));
    let labels = camera.labels(&posed, &view, None);
    assert_eq!([50, 3, 97].map(|row| *labels.pixel(50, row)), [Label::Wall(3), Label::Sky, Label::Ground]);
    // The tangent of the angle between an edge of the wall and the axis is 0.5: a quarter of the image's width.
    let wall_pixels = labels.pixels().iter().filter(|label| **label == Label::Wall(3)).count();
    assert_eq!(wall_pixels, 51 * 51);
    let depth = camera.depth(&posed, &view, None);
    assert_eq!(*depth.pixel(50, 50), 2.0);
    assert_eq!(*depth.pixel(50, 3), f32::INFINITY);
    // A ray falls by 1 / 50.5 m per metre for each row below the axis.
    let slope = 47.0_f64 / 50.5;
    let expected = (1.0 + slope * slope).sqrt() / slope;
    assert!((f64::from(*depth.pixel(50, 97)) - expected).abs() < 1e-6, "{} {expected}", depth.pixel(50, 97));
    let colour = camera.colour(&posed, &view, None, 1);
    // The wall is light grey at half the light; the floor has the full light.
    assert_eq!(*colour.pixel(50, 50), [102; 3]);
    assert_eq!([*colour.pixel(3, 97), *colour.pixel(97, 99)], [[160, 120, 80], [80; 3]]);
    assert_eq!(*colour.pixel(40, 99), [160, 120, 80]);
    let down = camera.colour(&posed, &self::view(1.0, -FRAC_PI_4, [101, 101]), None, 1);
    assert_eq!(*down.pixel(32, 50), [0, 0, 200], "the spot 1 m ahead and half a metre to the left");
}

#[test]
fn a_texture_is_upright() {
    let [red, green, blue, white] = [[200, 0, 0, 255], [0, 200, 0, 255], [0, 0, 200, 255], [200, 200, 200, 255]];
    let texture = Some(Arc::new(Texture::new(2, 2, vec![red, green, blue, white]).expect("four pixels")));
    let material = Material { colour: [1.0; 3], texture, ..Material::default() };
    let scenery = Scenery::new(vec![wall(material)], None, LIGHT, SKY);
    let posed = scenery.pose_at(&world(), Time::ZERO);
    let picture = Camera::default().colour(&posed, &view(1.0, 0.0, [100, 100]), None, 1);
    let channels = |column, row| picture.pixel(column, row).map(|channel| channel > 80);
    assert_eq!([channels(37, 37), channels(62, 37)], [[true, false, false], [false, true, false]], "the upper row");
    assert_eq!([channels(37, 62), channels(62, 62)], [[false, false, true], [true; 3]], "the lower row");
}

#[test]
fn a_robot_is_visible_to_others_but_not_to_itself() {
    let robot = RobotId(1);
    let part = Part { label: Label::Robot(robot), ..wall(Material::default()) };
    let scenery = Scenery::new(vec![part], None, LIGHT, SKY);
    let posed = scenery.pose_at(&world(), Time::ZERO);
    let view = view(1.0, 0.0, [9, 9]);
    let middle = |observer| *Camera::default().labels(&posed, &view, observer).pixel(4, 4);
    assert_eq!(
        [middle(None), middle(Some(RobotId(2))), middle(Some(robot))],
        [Label::Robot(robot), Label::Robot(robot), Label::Sky]
    );
}

#[test]
fn a_fisheye_shows_walls_ahead_and_beside() {
    let scenery = Scenery::new(vec![wall(Material::default())], None, LIGHT, SKY);
    let posed = scenery.pose_at(&world(), Time::ZERO);
    let pose = |yaw| Pose3::from_angles(DVec3::new(0.0, 0.0, 1.0), 0.0, 0.0, yaw);
    for (yaw, column) in [(0.0, 50), (FRAC_PI_2, 75), (-FRAC_PI_2, 25)] {
        let view = View::new(pose(yaw), Lens::Fisheye { fov: 4.0 * FRAC_PI_2 }, [101, 101]).expect("a view");
        let labels = Camera::default().labels(&posed, &view, None);
        assert_eq!(*labels.pixel(column, 50), Label::Wall(3), "turned by {yaw}");
        assert_eq!(*labels.pixel(100 - column, 46), if column == 50 { Label::Wall(3) } else { Label::Sky });
    }
}

#[test]
fn more_samples_soften_only_edges() {
    let scenery = Scenery::new(vec![wall(Material::default())], None, LIGHT, SKY);
    let posed = scenery.pose_at(&world(), Time::ZERO);
    let view = view(1.0, 0.0, [50, 50]);
    let [hard, soft] = [1, 4].map(|samples| Camera::default().colour(&posed, &view, None, samples));
    let differing = hard.pixels().iter().zip(soft.pixels()).filter(|(hard, soft)| hard[0].abs_diff(soft[0]) > 2);
    // The edges run through the centres of pixels.
    assert_eq!(differing.count(), 4 * 26 - 4);
}
