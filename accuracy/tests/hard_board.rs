//! Positions in pictures against true positions: corners of a calibration target and edges of faces.

use std::sync::Arc;

use accuracy::board::{Board, crossings};
use accuracy::world::{Random, empty};
use glam::{DVec2, DVec3};
use sim_core::camera::{Attachment, Camera, Label, Lens, Light, Part, Scenery, Sky, View};
use sim_core::pose::Pose3;
use sim_core::scene::{Material, Mesh, Triangle};
use sim_core::time::Time;

/// Uniform ambient light.
const LAMP: Light = Light { sun_direction: DVec3::Z, ambient: 1.0, fill: 0.0, diffuse: 0.0, shadows: false };
const SKY: Sky = Sky { horizon: [128; 3], zenith: [128; 3] };

#[test]
fn corners_of_a_board_are_found_where_they_are_projected() {
    let board = Board { squares: [5, 4], side: 0.1 };
    let part =
        Part { mesh: Arc::new(board.mesh()), label: Label::Fixed(0), attachment: Attachment::Fixed(Pose3::IDENTITY) };
    let scenery = Scenery::new(vec![part], None, LAMP, SKY);
    let posed = scenery.pose_at(&empty(), Time::ZERO);
    let mut camera = Camera::default();
    let mut random = Random::new(81);
    // Distance at which the board fills the image.
    for (lens, distance) in
        [(Lens::Pinhole { fov: 0.7 }, 1.15), (Lens::Pinhole { fov: 1.4 }, 0.5), (Lens::Fisheye { fov: 2.6 }, 0.3)]
    {
        let mut greatest: f64 = 0.0;
        for _ in 0..10 {
            let mut aside = || random.between(-0.5, 0.5);
            let offset = DVec3::new(aside(), aside(), 1.0).normalize_or_zero();
            let target = DVec3::new(0.1 * aside(), 0.1 * aside(), 0.0);
            let pose = View::look_at(target + distance * offset, target).expect("another place");
            let roll = Pose3::about_axis(DVec3::X, 2.0 * aside());
            let view = View::new(pose.then(&roll), lens, [240, 180]).expect("a view");
            let found = crossings(&camera.colour(&posed, &view, None, 12));
            let corners = board.inner_corners();
            for corner in &corners {
                let place = view.project(*corner).expect("before the camera");
                let error = found.iter().map(|there| (*there - place).length()).fold(f64::INFINITY, f64::min);
                greatest = greatest.max(error);
            }
            assert_eq!(found.len(), corners.len(), "all corners and nothing else");
        }
        println!("{lens:?}: {greatest:.4} pixels");
        assert!(greatest < 0.05, "{lens:?}: {greatest} pixels");
    }
}

/// Large face whose first edge passes through `middle` along `edge`; the face lies on the side of `inwards`.
fn half_plane(middle: DVec3, edge: DVec3, inwards: DVec3) -> Scenery {
    let corner = |along: f64, in_: f64| middle + along * edge + in_ * inwards;
    let mesh = Mesh {
        positions: vec![corner(-9.0, 0.0), corner(9.0, 0.0), corner(9.0, 9.0), corner(-9.0, 9.0)],
        triangles: [[0, 1, 2], [0, 2, 3]]
            .map(|corners| Triangle { corners, normals: None, uv: None, material: 0 })
            .to_vec(),
        materials: vec![Material::default()],
    };
    let part = Part { mesh: Arc::new(mesh), label: Label::Fixed(0), attachment: Attachment::Fixed(Pose3::IDENTITY) };
    Scenery::new(vec![part], None, LAMP, SKY)
}

#[test]
fn an_edge_parts_pixels_where_it_is_projected() {
    let mut random = Random::new(82);
    let mut camera = Camera::default();
    for (lens, size) in [
        (Lens::Pinhole { fov: 1.0 }, [640, 480]),
        (Lens::Pinhole { fov: 2.4 }, [160, 120]),
        (Lens::Fisheye { fov: 3.2 }, [160, 120]),
    ] {
        let mut greatest: f64 = 0.0;
        for _ in 0..10 {
            let from = 5.0 * random.direction_in_space();
            let roll = Pose3::about_axis(DVec3::X, random.between(-3.0, 3.0));
            let pose = View::look_at(from, random.direction_in_space()).expect("another place").then(&roll);
            let view = View::new(pose, lens, size).expect("a view");
            let [column, row] = size.map(|side| random.below(side as usize) as u32);
            let pixel = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
            let distance = random.between(0.5, 5.0);
            let (edge, inwards) = (random.direction_in_space(), random.direction_in_space());
            // Point of the edge that is seen at a point of the image.
            let point = |at: DVec2| from + distance * view.direction(at).expect("within the image");
            let [here, there] = [0.0, 1e-3].map(|along| view.project(point(pixel) + along * edge).expect("ahead"));
            let across = (there - here).perp().normalize_or_zero();
            let mut shows = |offset: f64| {
                let scenery = half_plane(point(pixel + offset * across), edge, inwards);
                *camera.labels(&scenery.pose_at(&empty(), Time::ZERO), &view, None).pixel(column, row) != Label::Sky
            };
            let (mut low, mut high) = (-0.5, 0.5);
            let is_at_low = shows(low);
            assert_ne!(is_at_low, shows(high), "half a pixel to either side");
            for _ in 0..14 {
                let middle = 0.5 * (low + high);
                if shows(middle) == is_at_low {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            greatest = greatest.max(low.abs().max(high.abs()));
        }
        println!("{lens:?}, {size:?}: {greatest:.1e} pixels");
        assert!(greatest < 0.01, "{lens:?}: {greatest} pixels");
    }
}
