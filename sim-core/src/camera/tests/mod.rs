mod reference;

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use accuracy::world::Random;
use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use glam::{DVec2, DVec3, Vec2};

use super::render::Camera;
use super::texture::Wrap;
use super::*;
use crate::RobotId;
use crate::math;
use crate::pose::Pose3;
use crate::scene::{Material, Mesh, Texture, Triangle, Walls};
use crate::time::Time;
use crate::world::World;
use reference::Shown;

fn world() -> World {
    World::new(Arc::new(Walls::new(Vec::new())), Time::from_millis(50), [])
}

fn point(random: &mut Random, reach: f64) -> DVec3 {
    DVec3::new(random.between(-reach, reach), random.between(-reach, reach), random.between(-reach, reach))
}

fn pose(random: &mut Random, position: DVec3) -> Pose3 {
    let [roll, pitch, yaw] = [(); 3].map(|()| random.between(-PI, PI));
    Pose3::from_angles(position, roll, 0.5 * pitch, yaw)
}

fn byte(random: &mut Random) -> u8 {
    random.between(0.0, 256.0) as u8
}

fn image(random: &mut Random, width: u32, height: u32, is_opaque: bool) -> Arc<Texture> {
    let mut pixel = |_| [(); 3].map(|()| byte(random));
    let pixels = (0..width * height).map(|number| {
        let [red, green, blue] = pixel(number);
        [red, green, blue, if is_opaque || number % 3 > 0 { 255 } else { 40 }]
    });
    Arc::new(Texture::new(width, height, pixels.collect()).expect("as many pixels"))
}

/// A box with images on its faces; if `is_round`, its corners have the normals of a ball.
fn cuboid(random: &mut Random, half: DVec3, is_round: bool, materials: Vec<Material>) -> Arc<Mesh> {
    let sign = |corner: usize, axis: usize| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
    let corner = |corner: usize| DVec3::new(sign(corner, 0), sign(corner, 1), sign(corner, 2));
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let uv = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let mut triangles = Vec::new();
    for side in sides {
        let (material, repeats) = (random.between(0.0, materials.len() as f64) as u32, random.between(0.5, 6.0) as f32);
        for half in [[0, 1, 2], [0, 2, 3]] {
            triangles.push(Triangle {
                corners: half.map(|index| side[index] as u32),
                normals: is_round.then(|| half.map(|index| corner(side[index]).normalize_or_zero().as_vec3())),
                uv: Some(half.map(|index| uv[index] * repeats)),
                material,
            });
        }
    }
    Arc::new(Mesh { positions: (0..8).map(|number| corner(number) * half).collect(), triangles, materials })
}

/// A closed ball of `rows` times `2 rows` quadrilaterals.
fn ball(rows: u32) -> Arc<Mesh> {
    let columns = 2 * rows;
    let mut positions = vec![DVec3::Z];
    for row in 1..rows {
        let (sin, cos) = math::sin_cos(PI * f64::from(row) / f64::from(rows));
        positions.extend((0..columns).map(|column| {
            let (y, x) = math::sin_cos(2.0 * PI * f64::from(column) / f64::from(columns));
            DVec3::new(sin * x, sin * y, cos)
        }));
    }
    positions.push(DVec3::NEG_Z);
    let index = |row: u32, column: u32| match row {
        0 => 0,
        row if row == rows => (rows - 1) * columns + 1,
        row => 1 + (row - 1) * columns + column % columns,
    };
    let mut triangles = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let (a, b) = (index(row, column), index(row + 1, column));
            let (c, d) = (index(row + 1, column + 1), index(row, column + 1));
            let faces = [[a, b, c], [a, c, d]];
            triangles.extend(faces.iter().filter(|[a, b, c]| a != b && b != c && c != a).map(|&corners| Triangle {
                corners,
                normals: None,
                uv: None,
                material: 0,
            }));
        }
    }
    Arc::new(Mesh { positions, triangles, materials: vec![Material::default()] })
}

/// A random heap of boxes and loose triangles, some intersecting, over a painted floor.
fn heap(seed: u64) -> Scenery {
    let mut random = Random::new(seed);
    let random = &mut random;
    let images = [
        image(random, 16, 16, true),
        image(random, 7, 30, true),
        image(random, 64, 5, false),
        image(random, 1, 1, true),
    ];
    let material =
        |number: usize, colour| Material { colour, texture: images.get(number).cloned(), ..Material::default() };
    let mut parts = Vec::new();
    for number in 0..25 {
        let half = DVec3::splat(0.1) + point(random, 0.5).abs();
        let colour = [(); 3].map(|()| random.between(0.0, 1.0) as f32);
        let materials = (0..=4).map(|number| material(number, colour)).collect();
        let position = point(random, 3.0) + DVec3::Z;
        let upright = Pose3::from_angles(position, 0.0, 0.0, 0.3 * position.x);
        let pose = if number % 3 == 0 { pose(random, position) } else { upright };
        let label = if number == 0 { Label::Robot(RobotId(1)) } else { Label::Fixed(number) };
        parts.push(Part {
            mesh: cuboid(random, half, number % 4 == 0, materials),
            label,
            attachment: Attachment::Fixed(pose),
        });
    }
    let loose = (0..40).map(|_| [(); 3].map(|()| point(random, 4.0)));
    let positions: Vec<DVec3> = loose.flatten().collect();
    let triangles = (0..40).map(|number| Triangle {
        corners: [3 * number, 3 * number + 1, 3 * number + 2],
        normals: None,
        uv: Some([Vec2::ZERO, 3.0 * Vec2::X, 2.0 * Vec2::Y]),
        material: number % 5,
    });
    let mesh = Mesh {
        positions,
        triangles: triangles.collect(),
        materials: (0..5).map(|number| material(number, [1.0; 3])).collect(),
    };
    parts.push(Part { mesh: Arc::new(mesh), label: Label::Wall(0), attachment: Attachment::Fixed(Pose3::IDENTITY) });
    let spot = |_| Spot {
        centre: point(random, 4.0).truncate(),
        radius: random.between(0.05, 0.6),
        colour: [(); 4].map(|()| byte(random)),
    };
    let spots = (0..10).map(spot).collect();
    let texture = Some(image(random, 40, 60, false));
    let ground = Ground {
        colour: [90, 100, 80],
        floor: Some(Floor { size: DVec2::new(3.0, 2.5), colour: [150, 150, 140], texture }),
        spots,
    };
    let sun_direction = point(random, 1.0).normalize_or(DVec3::Z);
    let light = Light { sun_direction, ambient: 0.3, fill: 0.2, diffuse: 0.5, shadows: seed % 2 == 1 };
    Scenery::new(parts, Some(ground), light, Sky { horizon: [200, 210, 220], zenith: [60, 110, 200] })
}

const LENSES: [Lens; 4] = [
    Lens::Pinhole { fov: 1.2 },
    Lens::Pinhole { fov: 2.6 },
    Lens::Fisheye { fov: 2.0 },
    Lens::Fisheye { fov: 2.0 * PI },
];

fn view(random: &mut Random, lens: Lens, size: [u32; 2]) -> View {
    let position = point(random, 3.0) + 0.6 * DVec3::Z;
    View::new(pose(random, position), lens, size).expect("a view")
}

/// Returns true if a pixel and all its neighbours show the same face.
fn is_inside_face(shown: &Picture<Shown>, column: u32, row: u32) -> bool {
    let [width, height] = shown.size();
    let rows = row.saturating_sub(1)..(row + 2).min(height);
    let expected = shown.pixel(column, row);
    rows.flat_map(|row| (column.saturating_sub(1)..(column + 2).min(width)).map(move |column| (column, row)))
        .all(|(column, row)| shown.pixel(column, row) == expected)
}

#[test]
fn pictures_match_the_reference_renderer() {
    let world = world();
    let mut camera = Camera::default();
    let (mut compared, mut differing, mut wrong) = (0_u32, 0_u32, 0_u32);
    for seed in 0..6 {
        let scenery = heap(seed);
        let posed = scenery.pose_at(&world, Time::ZERO);
        let mut random = Random::new(100 + seed);
        for lens in LENSES {
            let view = view(&mut random, lens, [83, 61]);
            let observer = (seed % 2 == 0).then_some(RobotId(1));
            let reference = reference::render(&posed, &view, observer);
            let colour = camera.colour(&posed, &view, observer, 1);
            let depth = camera.depth(&posed, &view, observer);
            for row in 0..61 {
                for column in 0..83 {
                    let expected = reference.colour.pixel(column, row);
                    let found = colour.pixel(column, row);
                    let difference = (0..3).map(|channel| (expected[channel] - f64::from(found[channel])).abs());
                    let difference = difference.fold(0.0, f64::max);
                    let expected_depth = *reference.depth.pixel(column, row);
                    let found_depth = f64::from(*depth.pixel(column, row));
                    let has_depth =
                        expected_depth == found_depth || (expected_depth - found_depth).abs() <= 1e-5 * expected_depth;
                    compared += 1;
                    if is_inside_face(&reference.shown, column, row) {
                        let context = (seed, lens, column, row, reference.shown.pixel(column, row));
                        assert!(has_depth, "{expected_depth} m, not {found_depth}: {context:?}");
                        // The limit allows half a colour level for rounding and half a level for the renderer's error.
                        if difference > 1.0 {
                            wrong += 1;
                            eprintln!("{expected:?}, not {found:?}: {context:?}");
                        }
                    } else if difference > 1.0 || !has_depth {
                        differing += 1;
                    }
                }
            }
        }
    }
    assert_eq!(wrong, 0, "of {compared} pixels");
    // Differences on silhouettes, where the ray passes within rounding of an edge.
    assert!(differing <= compared / 2000, "{differing} of {compared}");
}

/// All available SIMD levels, from scalar to the widest.
fn levels() -> Vec<Level> {
    let mut levels = vec![Level::fallback(), Level::baseline(), Level::new()];
    #[cfg(target_arch = "x86_64")]
    levels.extend(Level::new().as_avx2().map(fearless_simd::Simd::level));
    levels
}

#[test]
fn pictures_of_all_simd_levels_are_bit_identical() {
    let world = world();
    for seed in 10..14 {
        let scenery = heap(seed);
        let posed = scenery.pose_at(&world, Time::ZERO);
        let mut random = Random::new(seed);
        for lens in LENSES {
            let view = view(&mut random, lens, [70, 45]);
            let pictures = levels().into_iter().map(|level| {
                let mut camera = Camera::at_level(level);
                let fine = camera.colour(&posed, &view, None, 2);
                (camera.colour(&posed, &view, None, 1), fine, camera.depth(&posed, &view, None))
            });
            let pictures: Vec<_> = pictures.collect();
            assert!(pictures.iter().all(|picture| *picture == pictures[0]), "{lens:?}");
        }
    }
}

#[test]
fn a_closed_surface_has_no_holes() {
    let world = world();
    let part = Part { mesh: ball(12), label: Label::Wall(0), attachment: Attachment::Fixed(Pose3::IDENTITY) };
    let light = Light { sun_direction: DVec3::Z, ambient: 1.0, fill: 0.0, diffuse: 0.0, shadows: false };
    let scenery = Scenery::new(vec![part], None, light, Sky { horizon: [0; 3], zenith: [0; 3] });
    let posed = scenery.pose_at(&world, Time::ZERO);
    let mut random = Random::new(5);
    let mut camera = Camera::default();
    for number in 0..3000 {
        // With the camera on an axis, corners and edges lie exactly on rays.
        let position = match number % 4 {
            0 => DVec3::ZERO,
            1 => DVec3::new(0.5, 0.0, 0.0),
            _ => point(&mut random, 0.5),
        };
        let pose = if number % 8 < 2 {
            Pose3::from_angles(position, 0.0, 0.0, FRAC_PI_2 * f64::from(number / 8))
        } else {
            pose(&mut random, position)
        };
        let lens = LENSES[number as usize % 3];
        let view = View::new(pose, lens, [32, 32]).expect("a view");
        let labels = camera.labels(&posed, &view, None);
        assert!(labels.pixels().iter().all(|label| *label == Label::Wall(0)), "{number}: {pose:?} {lens:?}");
    }
}

/// The colour sampled in one lane.
#[inline(always)]
fn sampled<S: Simd>(simd: S, mip_map: &MipMap, uv: DVec2, axes: [DVec2; 2]) -> [f64; 4] {
    let splat = |value: f64| S::f32s::splat(simd, value as f32);
    let axes = axes.map(|axis| [splat(axis.x), splat(axis.y)]);
    let sample = mip_map.sample::<S, 4>(simd, 1 << 3, [splat(uv.x), splat(uv.y)], axes);
    sample.map(|channel| f64::from(channel.as_slice()[3]))
}

#[test]
fn texture_filter_matches_its_definition() {
    let mut random = Random::new(3);
    for (width, height) in [(16, 16), (7, 30), (1, 1), (64, 5), (33, 2)] {
        let image = image(&mut random, width, height, false);
        for wrap in [Wrap::Repeat, Wrap::Clamp] {
            let mip_map = texture::MipMap::new(&image, wrap);
            for _ in 0..300 {
                let size = random.between(-4.0, 1.0);
                let length = math::exp(size * std::f64::consts::LN_10);
                let mut pair = |reach: f64| DVec2::new(random.between(-reach, reach), random.between(-reach, reach));
                let (uv, steps) = (pair(1.5), [pair(length), pair(length)]);
                let expected = reference::filtered(&image, wrap, DVec2::new(uv.x, 1.0 - uv.y), steps);
                let texels = DVec2::new(f64::from(width), f64::from(height));
                let axes = steps.map(|step| step * texels * DVec2::new(1.0, -1.0));
                let found = dispatch!(Level::new(), simd => sampled(simd, &mip_map, uv, axes));
                for channel in 0..4 {
                    assert!(
                        (found[channel] - expected[channel]).abs() < 0.05,
                        "{found:?}, not {expected:?}: {width} x {height} {wrap:?} {uv} {steps:?}"
                    );
                }
            }
        }
    }
}
