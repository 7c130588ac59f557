//! Tests of the light of sceneries and of images on the sides of boxes.

use super::*;
use crate::camera::{Camera, Lens, Picture, View};
use crate::scene::Walls;
use crate::time::Time;
use crate::world::World;

#[test]
fn walls_in_four_directions_and_floor_differ_in_brightness() {
    let light = light(&LightSpec::default());
    let fill_from = DVec3::new(-light.sun_direction.x, -light.sun_direction.y, light.sun_direction.z);
    let intensity = |normal: DVec3| {
        let fill = 0.5 * (1.0 + normal.dot(fill_from));
        light.ambient + light.fill * fill + light.diffuse * normal.dot(light.sun_direction).max(0.0)
    };
    let mut intensities = [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z].map(intensity);
    intensities.sort_by(f64::total_cmp);
    // A difference of six of 255 levels is visible side by side.
    assert!(intensities.windows(2).all(|pair| pair[1] - pair[0] > 6.0 / 255.0), "{intensities:?}");
    assert!(intensities[4] <= 1.0 && intensities[0] > 0.5, "{intensities:?}");
}

const RED: [u8; 3] = [255, 0, 0];
const GREEN: [u8; 3] = [0, 255, 0];
const BLUE: [u8; 3] = [0, 0, 255];
const YELLOW: [u8; 3] = [255, 255, 0];

/// Pixels of four quadrants: red and green above, blue and yellow below.
fn quadrant_pixels() -> Vec<[u8; 4]> {
    let colour_of = |pixel: usize| {
        let [red, green, blue] = [[RED, GREEN], [BLUE, YELLOW]][pixel / 64 / 32][pixel % 64 / 32];
        [red, green, blue, 255]
    };
    (0..64 * 64).map(colour_of).collect()
}

/// View of a scenery without moving parts.
fn render(scenery: &Scenery, from: DVec3, to: DVec3, size: [u32; 2]) -> Picture<[u8; 3]> {
    let pose = View::look_at(from, to).expect("a direction");
    let view = View::new(pose, Lens::Pinhole { fov: 0.7 }, size).expect("a view");
    let world = World::new(Arc::new(Walls::new(Vec::new())), Time::from_millis(50), []);
    Camera::default().colour(&scenery.pose_at(&world, Time::ZERO), &view, None, 1)
}

/// Scenery with a single mesh.
fn scenery_of(mesh: Arc<Mesh>) -> Scenery {
    let attachment = Attachment::Fixed(Pose3::IDENTITY);
    let part = Part { mesh, label: Label::Fixed(0), attachment };
    let white = Light { sun_direction: DVec3::Z, ambient: 1.0, fill: 0.0, diffuse: 0.0, shadows: false };
    Scenery::new(vec![part], None, white, Sky { horizon: [0; 3], zenith: [0; 3] })
}

#[test]
fn images_are_upright_on_every_side_of_a_box() {
    let texture = Arc::new(Texture::new(64, 64, quadrant_pixels()).expect("an image"));
    let mut builder = MeshBuilder::default();
    let paint = builder.image(texture);
    builder.cuboid(&Pose3::IDENTITY, DVec3::ONE, paint);
    let scenery = scenery_of(builder.finish());
    for normal in [DVec3::X, DVec3::Y, DVec3::NEG_X, DVec3::NEG_Y, DVec3::Z] {
        let picture = render(&scenery, 2.5 * normal, DVec3::ZERO, [40, 40]);
        let corners = [(14, 14), (26, 14), (14, 26), (26, 26)].map(|(column, row)| *picture.pixel(column, row));
        assert_eq!(corners, [RED, GREEN, BLUE, YELLOW], "from {normal}");
    }
}
