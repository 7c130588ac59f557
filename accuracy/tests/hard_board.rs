//! Positions in pictures, compared with true positions: corners of a calibration target and edges of faces.

use std::sync::Arc;

use accuracy::board::{Board, crossings};
use accuracy::world::{Random, empty};
use glam::{DVec2, DVec3};
use sim_core::camera::{Attachment, Camera, Label, Lens, Light, Part, Scenery, Sky, View};
use sim_core::pose::Pose3;
use sim_core::scene::{Material, Mesh, Triangle};
use sim_core::time::Time;

/// Uniform ambient light.
const AMBIENT_LIGHT: Light = Light { sun_direction: DVec3::Z, ambient: 1.0, fill: 0.0, diffuse: 0.0, shadows: false };
const SKY: Sky = Sky { horizon: [128; 3], zenith: [128; 3] };

#[test]
fn detected_corners_match_their_projections() {
    let board = Board { squares: [5, 4], side: 0.1 };
    let part =
        Part { mesh: Arc::new(board.mesh()), label: Label::Fixed(0), attachment: Attachment::Fixed(Pose3::IDENTITY) };
    let scenery = Scenery::new(vec![part], None, AMBIENT_LIGHT, SKY);
    let posed = scenery.pose_at(&empty(), Time::ZERO);
    let mut camera = Camera::default();
    let mut random = Random::new(81);
    // At these distances the board fills the image.
    for (lens, distance) in
        [(Lens::Pinhole { fov: 0.7 }, 1.15), (Lens::Pinhole { fov: 1.4 }, 0.5), (Lens::Fisheye { fov: 2.6 }, 0.3)]
    {
        let mut max_error: f64 = 0.0;
        for _ in 0..10 {
            let mut draw = || random.between(-0.5, 0.5);
            let offset = DVec3::new(draw(), draw(), 1.0).normalize_or_zero();
            let target = DVec3::new(0.1 * draw(), 0.1 * draw(), 0.0);
            let pose = View::look_at(target + distance * offset, target).expect("another place");
            let roll = Pose3::about_axis(DVec3::X, 2.0 * draw());
            let view = View::new(pose.then(&roll), lens, [240, 180]).expect("a view");
            let found = crossings(&camera.colour(&posed, &view, None, 12));
            let corners = board.inner_corners();
            for corner in &corners {
                let expected = view.project(*corner).expect("before the camera");
                let error = found.iter().map(|corner| (*corner - expected).length()).fold(f64::INFINITY, f64::min);
                max_error = max_error.max(error);
            }
            assert_eq!(found.len(), corners.len(), "all corners and nothing else");
        }
        println!("{lens:?}: {max_error:.4} pixels");
        assert!(max_error < 0.05, "{lens:?}: {max_error} pixels");
    }
}

/// Scenery of a large parallelogram. Its first edge passes through `middle` along `edge`; the other points are on the
/// side of `inwards`.
fn half_plane(middle: DVec3, edge: DVec3, inwards: DVec3) -> Scenery {
    let corner = |along: f64, inside: f64| middle + along * edge + inside * inwards;
    let mesh = Mesh {
        positions: vec![corner(-9.0, 0.0), corner(9.0, 0.0), corner(9.0, 9.0), corner(-9.0, 9.0)],
        triangles: [[0, 1, 2], [0, 2, 3]]
            .map(|corners| Triangle { corners, normals: None, uv: None, material: 0 })
            .to_vec(),
        materials: vec![Material::default()],
    };
    let part = Part { mesh: Arc::new(mesh), label: Label::Fixed(0), attachment: Attachment::Fixed(Pose3::IDENTITY) };
    Scenery::new(vec![part], None, AMBIENT_LIGHT, SKY)
}

#[test]
fn edges_divide_pixels_at_their_projections() {
    let mut random = Random::new(82);
    let mut camera = Camera::default();
    for (lens, size) in [
        (Lens::Pinhole { fov: 1.0 }, [640, 480]),
        (Lens::Pinhole { fov: 2.4 }, [160, 120]),
        (Lens::Fisheye { fov: 3.2 }, [160, 120]),
    ] {
        let mut max_error: f64 = 0.0;
        for _ in 0..10 {
            let position = 5.0 * random.direction_in_space();
            let roll = Pose3::about_axis(DVec3::X, random.between(-3.0, 3.0));
            let pose = View::look_at(position, random.direction_in_space()).expect("another place").then(&roll);
            let view = View::new(pose, lens, size).expect("a view");
            let [column, row] = size.map(|side| random.below(side as usize) as u32);
            let pixel = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
            let distance = random.between(0.5, 5.0);
            let (edge, inwards) = (random.direction_in_space(), random.direction_in_space());
            // Point at `distance` from the camera on the line of sight through a point of the image.
            let point = |at: DVec2| position + distance * view.direction(at).expect("within the image");
            let [here, there] = [0.0, 1e-3].map(|along| view.project(point(pixel) + along * edge).expect("ahead"));
            let across = (there - here).perp().normalize_or_zero();
            let mut is_face_visible = |offset: f64| {
                let scenery = half_plane(point(pixel + offset * across), edge, inwards);
                *camera.labels(&scenery.pose_at(&empty(), Time::ZERO), &view, None).pixel(column, row) != Label::Sky
            };
            let (mut low, mut high) = (-0.5, 0.5);
            let is_visible_at_low = is_face_visible(low);
            assert_ne!(is_visible_at_low, is_face_visible(high), "half a pixel to either side");
            for _ in 0..14 {
                let middle = 0.5 * (low + high);
                if is_face_visible(middle) == is_visible_at_low {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            max_error = max_error.max(low.abs().max(high.abs()));
        }
        println!("{lens:?}, {size:?}: {max_error:.1e} pixels");
        assert!(max_error < 0.01, "{lens:?}: {max_error} pixels");
    }
}
