//! Views that are hard to render, compared with the slow reference or tested by a simpler criterion.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};
use std::sync::Arc;

use accuracy::camera::{Agreement, Reference, Shot};
use accuracy::room;
use accuracy::world::{Random, cuboid, empty};
use glam::{DMat3, DVec2, DVec3};
use sim_core::camera::{Attachment, Camera, Floor, Ground, Label, Lens, Light, Part, Scenery, Sky, Spot, View};
use sim_core::pose::Pose3;
use sim_core::scene::{Material, Mesh, Texture, Triangle};
use sim_core::time::Time;

const PINHOLE: Lens = Lens::Pinhole { fov: 1.2 };
const FISHEYE: Lens = Lens::Fisheye { fov: 3.0 };
const SKY: Sky = Sky { horizon: [200, 210, 230], zenith: [90, 140, 220] };

fn view(pose: Pose3, lens: Lens, size: [u32; 2]) -> View {
    View::new(pose, lens, size).expect("a view")
}

fn mesh(triangles: &[[DVec3; 3]]) -> Mesh {
    let face = |first: u32| Triangle { corners: [first, first + 1, first + 2], normals: None, uv: None, material: 0 };
    Mesh {
        positions: triangles.as_flattened().to_vec(),
        triangles: (0..triangles.len() as u32).map(|number| face(3 * number)).collect(),
        materials: vec![Material::default()],
    }
}

/// Scenery that consists only of these meshes.
fn scenery(meshes: impl IntoIterator<Item = Mesh>) -> Scenery {
    let part = |(number, mesh)| Part {
        mesh: Arc::new(mesh),
        label: Label::Wall(number),
        attachment: Attachment::Fixed(Pose3::IDENTITY),
    };
    Scenery::new((0..).zip(meshes).map(part).collect(), None, room::light(), SKY)
}

/// Asserts that each view agrees with the reference.
fn assert_agrees(context: &str, scenery: &Scenery, views: &[View]) -> Agreement {
    let posed = scenery.pose_at(&empty(), Time::ZERO);
    let reference = Reference::new(&posed, None);
    let mut camera = Camera::default();
    let mut total = Agreement::default();
    for view in views {
        let agreement = Agreement::of(&Shot::take(&mut camera, &posed, view, None), &reference, view);
        agreement.assert_right(&format!("{context}, {view:?}"));
        total += agreement;
    }
    println!("{context}: {} of {} pixels differ", total.differing, total.pixels);
    total
}

/// Pose at `position` with a random orientation.
fn random_orientation(random: &mut Random, position: DVec3) -> Pose3 {
    let [roll, pitch, yaw] = [PI, FRAC_PI_2, PI].map(|max| random.between(-max, max));
    Pose3::from_angles(position, roll, pitch, yaw)
}

#[test]
fn camera_in_a_wall_shows_its_inside_and_camera_on_a_face_does_not_show_that_face() {
    let wall = |x: f64| mesh(&cuboid(DVec3::new(0.1, 2.0, 1.0), 1, |point| point + DVec3::X * x));
    let scene = scenery([wall(0.0), wall(3.0)]);
    let mut random = Random::new(91);
    let inside = DVec3::new(0.03, 0.5, -0.25);
    let views: Vec<View> = (0..20)
        .map(|number| view(random_orientation(&mut random, inside), [PINHOLE, FISHEYE][number % 2], [20, 15]))
        .collect();
    assert_agrees("inside", &scene, &views);
    let posed = scene.pose_at(&empty(), Time::ZERO);
    let mut camera = Camera::default();
    for view in &views {
        assert!(camera.labels(&posed, view, None).pixels().iter().all(|label| *label == Label::Wall(0)));
    }
    // The camera is on the face at x = 0.1. Ahead is the other wall; behind is the opposite face of this wall.
    let touching = DVec3::new(0.1, 0.5, -0.25);
    let views = [0.0, 0.3, PI, 2.0].map(|yaw| view(Pose3::from_angles(touching, 0.0, 0.0, yaw), PINHOLE, [20, 15]));
    assert_agrees("touching", &scene, &views);
    let ahead = camera.labels(&posed, &views[0], None);
    assert_eq!(
        (ahead.pixel(10, 7), camera.labels(&posed, &views[2], None).pixel(10, 7)),
        (&Label::Wall(1), &Label::Wall(0))
    );
    assert!((camera.depth(&posed, &views[2], None).pixel(10, 7) - 0.2).abs() < 1e-3, "the wall is 20 cm thick");
}

#[test]
fn faces_across_the_camera_plane_match_the_reference() {
    let mut random = Random::new(92);
    // Large triangles around the camera, with corners in front of and behind it.
    for scene in 0..12 {
        let mut corner = || 20.0 * random.between(0.05, 1.0) * random.direction_in_space();
        let faces: Vec<[DVec3; 3]> = (0..8).map(|_| [corner(), corner(), corner()]).collect();
        let scene = (scene, scenery(faces.iter().map(|face| mesh(&[*face]))));
        let views: Vec<View> = (0..6)
            .map(|number| {
                let position = random.direction_in_space();
                view(
                    random_orientation(&mut random, position),
                    [PINHOLE, FISHEYE, Lens::Pinhole { fov: 2.9 }][number % 3],
                    [20, 15],
                )
            })
            .collect();
        assert_agrees(&format!("scene {}", scene.0), &scene.1, &views);
    }
}

/// A floor of 4 m by 3 m with a texture and two spots, on which a pole stands.
fn floor() -> Scenery {
    let pixels =
        (0..64).map(|index| if (index % 8 + index / 8) % 2 == 0 { [250, 240, 30, 255] } else { [20, 40, 90, 255] });
    let texture = Texture::new(8, 8, pixels.collect()).map(Arc::new);
    let spot = |x: f64, radius: f64| Spot { centre: DVec2::new(x, 1.0), radius, colour: [255, 0, 0, 128] };
    let ground = Ground {
        colour: [90, 110, 70],
        floor: Some(Floor { size: DVec2::new(4.0, 3.0), colour: [255; 3], texture }),
        spots: vec![spot(1.0, 0.3), spot(1.25, 0.2)],
    };
    let pole = mesh(&cuboid(DVec3::new(0.05, 0.05, 0.5), 1, |point| point + DVec3::new(2.0, 1.5, 0.5)));
    let part = Part { mesh: Arc::new(pole), label: Label::Fixed(0), attachment: Attachment::Fixed(Pose3::IDENTITY) };
    Scenery::new(vec![part], Some(ground), room::light(), SKY)
}

#[test]
fn vertical_and_grazing_views_match_the_reference() {
    let point = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let mut views = Vec::new();
    for lens in [PINHOLE, FISHEYE] {
        for pitch in [-FRAC_PI_2, FRAC_PI_2] {
            for (roll, yaw) in [(0.0, 0.0), (0.0, FRAC_PI_2), (1.0, 2.0)] {
                views.push(view(Pose3::from_angles(point(1.5, 1.25, 0.6), roll, pitch, yaw), lens, [20, 15]));
            }
        }
        for height in [1e-6, 1e-3, 0.02, 500.0, 1e5] {
            for yaw in [0.0, 0.5] {
                views.push(view(Pose3::from_angles(point(0.5, 1.0, height), 0.0, -1e-3, yaw), lens, [20, 15]));
            }
        }
        // Cameras below the floor and on it; the floor is visible only from above.
        views.push(view(Pose3::from_angles(point(1.0, 1.0, -0.5), 0.0, 0.3, 0.5), lens, [20, 15]));
        views.push(view(Pose3::from_angles(point(1.0, 1.0, 0.0), 0.0, -0.3, 0.5), lens, [20, 15]));
    }
    let agreement = assert_agrees("floor", &floor(), &views);
    assert!(agreement.share() < 0.03, "{}", agreement.share());
}

#[test]
fn pictures_do_not_depend_on_the_origin() {
    // 18 km from the origin.
    let far = DVec3::new(16_384.0, -8192.0, 0.0);
    let mesh = room::room();
    let part = |position: DVec3| Part {
        mesh: Arc::new(mesh.clone()),
        label: Label::Fixed(0),
        attachment: Attachment::Fixed(Pose3 { position, ..Pose3::IDENTITY }),
    };
    let [here, there] = [DVec3::ZERO, far].map(|position| Scenery::new(vec![part(position)], None, room::light(), SKY));
    let (here, there) = (here.pose_at(&empty(), Time::ZERO), there.pose_at(&empty(), Time::ZERO));
    let reference = Reference::new(&here, None);
    let mut camera = Camera::default();
    for (number, stand) in room::stands(12).into_iter().enumerate() {
        let view = |offset: DVec3| {
            view(Pose3 { position: stand.eye + offset, ..stand.pose() }, [PINHOLE, FISHEYE][number % 2], [32, 24])
        };
        let shot = Shot::take(&mut camera, &there, &view(far), None);
        Agreement::of(&shot, &reference, &view(DVec3::ZERO)).assert_right("18 km away");
    }
}

#[test]
fn any_direction_of_the_sun_matches_the_reference() {
    let directions = [
        DVec3::Z,
        DVec3::new(1.0, 0.0, 0.0175),
        DVec3::new(0.0, -1.0, 0.05),
        DVec3::new(1.0, 1.0, 1e-3),
        DVec3::new(-1e-9, 0.0, 1.0),
        DVec3::X,
        DVec3::new(0.3, -0.2, -0.9),
    ];
    for direction in directions.map(|direction| direction.normalize_or(DVec3::Z)) {
        // Views of the room from inside and from above.
        let light = Light { sun_direction: direction, ..room::light() };
        let above = View::look_at(DVec3::new(4.0, 3.0, 9.0), DVec3::new(4.0, 4.0, 0.0)).expect("another place");
        let mut views = vec![view(above, PINHOLE, [32, 24])];
        let inside = room::stands(4).into_iter().zip([PINHOLE, FISHEYE, PINHOLE, FISHEYE]);
        views.extend(inside.map(|(stand, lens)| view(stand.pose(), lens, [24, 18])));
        assert_agrees(&format!("room, sun {direction}"), &room::scenery(light), &views);
        // Thin walls on the floor with common edges; for some directions one wall is parallel to the sun's rays.
        let sheet = |from: DVec2, to: DVec2| {
            let [a, b] = [from, to].map(|end| end.extend(0.0));
            let [c, d] = [b, a].map(|foot| foot + 0.5 * DVec3::Z);
            mesh(&[[a, b, c], [a, c, d]])
        };
        let corners = [[1.0, 1.0], [3.0, 1.0], [3.0, 2.0], [1.5, 2.25], [1.0, 1.0]].map(DVec2::from);
        let parts = corners.windows(2).zip(0..).map(|(ends, number)| Part {
            mesh: Arc::new(sheet(ends[0], ends[1])),
            label: Label::Wall(number),
            attachment: Attachment::Fixed(Pose3::IDENTITY),
        });
        let walls = Scenery::new(parts.collect(), floor().ground().cloned(), light, SKY);
        let mut random = Random::new(95);
        let views: Vec<View> = (0..8)
            .map(|number| {
                let mut between = |low, high| random.between(low, high);
                let position = DVec3::new(between(0.0, 4.0), between(0.0, 3.0), between(0.1, 2.0));
                let pose = Pose3::from_angles(position, 0.0, between(-1.2, 0.0), between(-PI, PI));
                view(pose, [PINHOLE, FISHEYE][number % 2], [24, 18])
            })
            .collect();
        assert_agrees(&format!("walls, sun {direction}"), &walls, &views);
    }
}

#[test]
fn pictures_of_any_size_match_the_reference() {
    let scene = room::scenery(room::light());
    let posed = scene.pose_at(&empty(), Time::ZERO);
    let reference = Reference::new(&posed, None);
    let mut camera = Camera::default();
    let stand = room::stands(1)[0];
    let pose = stand.pose();
    for size in [[1, 1], [1, 33], [33, 1], [17, 3], [8192, 1], [1920, 1080]] {
        // The fisheye's field of view is 3 rad over the longer side of the image.
        let share = f64::from(size[0]) / f64::from(size[0].max(size[1]));
        for lens in [PINHOLE, Lens::Fisheye { fov: 3.0 * share }] {
            let view = view(pose, lens, size);
            let shot = Shot::take(&mut camera, &posed, &view, None);
            assert_eq!(shot.colour.size(), size);
            let step = 1 + (size[0] * size[1]) as usize / 499;
            Agreement::of_some(&shot, &reference, &view, step).assert_right(&format!("{size:?}, {lens:?}"));
        }
    }
    for size in [[0, 10], [10, 0], [0, 0], [8193, 1]] {
        assert!(View::new(pose, PINHOLE, size).is_err(), "{size:?}");
    }
}

#[test]
fn extreme_fields_of_view_match_the_reference() {
    let scene = room::scenery(room::light());
    let stand = room::stands(3)[2];
    let pose = stand.pose();
    let lenses = [
        Lens::Pinhole { fov: 1e-3 },
        Lens::Pinhole { fov: 3.13 },
        Lens::Pinhole { fov: PI - 1e-4 },
        Lens::Fisheye { fov: 1e-3 },
        Lens::Fisheye { fov: PI },
        Lens::Fisheye { fov: 1.5 * PI },
        Lens::Fisheye { fov: TAU },
    ];
    assert_agrees("lenses", &scene, &lenses.map(|lens| view(pose, lens, [30, 30])));
}

#[test]
fn degenerate_faces_and_needles_match_the_reference() {
    let mut random = Random::new(93);
    for _ in 0..10 {
        let mut faces = Vec::new();
        for kind in 0..60 {
            let [a, b] = [(); 2].map(|()| 2.0 * random.direction_in_space());
            let tiny = random.direction_in_space();
            faces.push(match kind % 6 {
                0 => [a, a, b],
                1 => [a, b, a.lerp(b, 0.5)],
                2 => [a, b, b + 1e-3 * tiny],
                3 => [a, b, b + 1e-7 * tiny],
                4 => [a, a + 1e-7 * tiny, a + 1e-7 * tiny.any_orthonormal_vector()],
                _ => [a, b, b + 0.05 * tiny],
            });
        }
        let views: Vec<View> = (0..4)
            .map(|number| view(random_orientation(&mut random, DVec3::ZERO), [PINHOLE, FISHEYE][number % 2], [24, 18]))
            .collect();
        assert_agrees("needles", &scenery([mesh(&faces)]), &views);
    }
}

#[test]
fn closed_room_shows_no_sky() {
    let rotation = DMat3::from_cols_array(&[2.0, 2.0, -1.0, -1.0, 2.0, 2.0, 2.0, -1.0, 2.0]) * (1.0 / 3.0);
    let half = DVec3::new(2.0, 1.5, 1.25);
    let far = DVec3::new(1e4, -1e4, 0.0);
    let rooms = [
        ("on the grid", mesh(&cuboid(half, 4, |point| point)), DVec3::ZERO),
        ("on the grid, 14 km away", mesh(&cuboid(half, 4, |point| point + far)), far),
        ("turned", mesh(&cuboid(half, 7, |point| rotation * point)), DVec3::ZERO),
    ];
    let mut random = Random::new(94);
    let mut camera = Camera::default();
    for (name, mesh, middle) in rooms {
        let scene = scenery([mesh]);
        let posed = scene.pose_at(&empty(), Time::ZERO);
        for number in 0..1000 {
            // Every other view is from a grid position with a heading of n * 90 degrees, so edges pass through the
            // centres of pixels.
            let (offset, pose): (DVec3, Pose3) = if number % 2 == 0 {
                let offset = 0.25 * DVec3::new(random.below(5) as f64, random.below(5) as f64, random.below(3) as f64);
                (
                    offset - DVec3::new(0.5, 0.5, 0.25),
                    Pose3::from_angles(DVec3::ZERO, 0.0, 0.0, number as f64 * FRAC_PI_4),
                )
            } else {
                (random.between(0.0, 1.0) * random.direction_in_space(), random_orientation(&mut random, DVec3::ZERO))
            };
            let lens = [Lens::Pinhole { fov: FRAC_PI_2 }, Lens::Fisheye { fov: 4.0 }][number / 2 % 2];
            let size = [[25, 25], [32, 24]][number / 4 % 2];
            let view = view(Pose3 { position: middle + offset, ..pose }, lens, size);
            let holes =
                camera.labels(&posed, &view, None).pixels().iter().filter(|label| **label == Label::Sky).count();
            assert_eq!(holes, 0, "{name}, {view:?}");
        }
    }
}

#[test]
fn camera_has_no_state_between_pictures() {
    let scene = room::scenery(Light { shadows: true, ..room::light() });
    let posed = scene.pose_at(&empty(), Time::ZERO);
    let (mut colour_camera, mut depth_camera) = (Camera::default(), Camera::default());
    let views: Vec<View> = room::stands(6)
        .into_iter()
        .zip([[40, 30], [7, 5], [64, 64], [1, 1], [33, 17], [40, 30]])
        .enumerate()
        .map(|(number, (stand, size))| view(stand.pose(), [PINHOLE, FISHEYE][number % 2], size))
        .collect();
    for _ in 0..2 {
        for view in &views {
            for samples in [1, 3] {
                let fresh = Camera::default().colour(&posed, view, None, samples);
                assert_eq!(colour_camera.colour(&posed, view, None, samples), fresh);
            }
            let (depth, labels) = (depth_camera.depth(&posed, view, None), depth_camera.labels(&posed, view, None));
            assert_eq!(depth, Camera::default().depth(&posed, view, None));
            assert_eq!(labels, Camera::default().labels(&posed, view, None));
        }
    }
}

#[test]
fn empty_scenery_shows_only_sky() {
    let scene = scenery([]);
    let posed = scene.pose_at(&empty(), Time::ZERO);
    let up = view(Pose3::from_angles(DVec3::ZERO, 0.0, FRAC_PI_2, 0.0), PINHOLE, [3, 3]);
    let picture = Camera::default().colour(&posed, &up, None, 1);
    assert_eq!(*picture.pixel(1, 1), SKY.zenith);
    assert!(Camera::default().depth(&posed, &up, None).pixels().iter().all(|depth| depth.is_infinite()));
}
