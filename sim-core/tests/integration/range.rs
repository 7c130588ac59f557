//! Three-dimensional range sensors against the closed forms of a box room, on links, and at their limits.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::sync::Arc;

use accuracy::world::Random;
use glam::{DVec2, DVec3};
use sim_core::{
    RobotId, math,
    object::{Figure, Part, Properties, Resistance, Shape, Solid},
    pose::{Link, Pose, Pose3},
    scene::{Bounds, MeshIndex, Segment, Surface, WallId, Walls},
    sensor::{Beam, Echo, Fan, Mount, Posture, RangeModel, RangeSensor, Reading, Scan, Sonar},
    time::Time,
    world::{Ray, Space, ThickWall, World},
};

const ROBOT: RobotId = RobotId(1);

/// Length, width and height of the room, m.
const ROOM: DVec3 = DVec3::new(4.0, 3.0, 2.5);

fn world(walls: Walls, space: Space) -> World {
    World::new(Arc::new(walls), Time::from_millis(50), std::iter::empty()).with_space(space)
}

/// A room with its lower left corner at `corner`, closed by a slab above, with the same surface everywhere.
fn room(corner: DVec2, surface: Surface) -> World {
    let corners = [[0.0, 0.0], [ROOM.x, 0.0], [ROOM.x, ROOM.y], [0.0, ROOM.y]].map(|[x, y]| corner + DVec2::new(x, y));
    let walls: Vec<_> = (0..4).map(|i| Segment::new(corners[i], corners[(i + 1) % 4])).collect();
    let ceiling = Solid::Prism {
        footprint: Shape::Rectangle { half: ROOM.truncate() },
        body_from_footprint: Pose::default(),
        bottom: ROOM.z,
        top: ROOM.z + 0.2,
    };
    let middle = corner + 0.5 * ROOM.truncate();
    let figure = Arc::new(Figure { solids: vec![ceiling], surface });
    let space = Space {
        floor: Some(surface),
        walls: vec![surface; 4],
        fixed: vec![(Pose { position: middle, ..Pose::default() }, figure)],
        ..Space::default()
    };
    world(Walls::new(walls).with_heights(vec![ROOM.z; 4]), space)
}

/// The same room as a mesh of twelve triangles, in a frame at `corner`.
fn mesh_room(corner: DVec2, surface: Surface) -> World {
    let corner_of = |bits: usize| ROOM * DVec3::new((bits & 1) as f64, (bits >> 1 & 1) as f64, (bits >> 2) as f64);
    let faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let triangles: Vec<_> =
        faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).map(|corners| corners.map(corner_of)).collect();
    let figure = Arc::new(Figure { solids: vec![Solid::Mesh(Arc::new(MeshIndex::new(&triangles)))], surface });
    let fixed = vec![(Pose { position: corner, ..Pose::default() }, figure)];
    world(Walls::new(Vec::new()), Space { floor: None, fixed, ..Space::default() })
}

/// Distance and incidence angle on the inside of a box from the origin to [`ROOM`].
fn in_box(origin: DVec3, direction: DVec3) -> (f64, f64) {
    let to_plane = |axis: usize| {
        let end = if direction[axis] > 0.0 { ROOM[axis] } else { 0.0 };
        (((end - origin[axis]) / direction[axis]).abs(), direction[axis].abs())
    };
    let (distance, cos) = (0..3).map(to_plane).min_by(|a, b| a.0.total_cmp(&b.0)).expect("three axes");
    (distance, math::atan2((1.0 - cos * cos).sqrt(), cos))
}

/// Panics unless the distance is within 1 nm of `expected`.
fn assert_close(found: Reading, expected: f64, context: &str) {
    let distance = found.distance.expect("a distance");
    assert!((distance - expected).abs() < 1e-9, "{context}: {distance} instead of {expected}");
}

#[test]
fn readings_in_a_room_match_the_closed_form() {
    let mut random = Random::new(31);
    let corners = [DVec2::ZERO, DVec2::new(1e4, -1e4)];
    for (corner, room) in corners.into_iter().flat_map(|corner| [room, mesh_room].map(|room| (corner, room))) {
        let world = room(corner, Surface::ROUGH);
        let mut echoes = [0; 3];
        for case in 0..10_000 {
            let centre = random.point_in(Bounds { min: DVec2::splat(0.3), max: ROOM.truncate() - DVec2::splat(0.3) });
            let heading = random.between(-PI, PI);
            let offset = DVec3::new(random.between(-0.2, 0.2), random.between(-0.2, 0.2), random.between(0.05, 2.4));
            let (roll, pitch, yaw) =
                (random.between(-PI, PI), random.between(-FRAC_PI_2, FRAC_PI_2), random.between(-PI, PI));
            let posture = Posture {
                world_from_robot: Pose { position: corner + centre, ..Pose::new(0.0, 0.0, heading) },
                ..Posture::default()
            };
            let read = |model| {
                let mount = Pose3::from_angles(offset, roll, pitch, yaw);
                RangeSensor { mount, link: None, model }.read(&world.caster(ROBOT, Time::ZERO), &posture, 0.0)
            };
            let (sin, cos) = math::sin_cos(heading);
            let origin = DVec3::new(
                centre.x + cos * offset.x - sin * offset.y,
                centre.y + sin * offset.x + cos * offset.y,
                offset.z,
            );
            let (horizontal, rise) = (math::cos(pitch), math::sin(pitch));
            let bearing = heading + yaw;
            let direction = DVec3::new(math::cos(bearing) * horizontal, math::sin(bearing) * horizontal, rise);
            let (distance, alpha) = in_box(origin, direction);

            let context = format!("{case} at {corner}");
            assert_close(read(RangeModel::Psd { range: 9.0 }), distance, &context);
            for (count, (echo, model)) in [
                (Echo::LASER, RangeModel::Laser(Echo::LASER)),
                (Echo::ULTRASONIC, RangeModel::Ultrasonic(Echo::ULTRASONIC)),
            ]
            .into_iter()
            .enumerate()
            {
                let is_at_limit = (alpha - echo.max_incidence).abs() < 1e-9
                    || [echo.min, echo.max].iter().any(|end| (distance - end).abs() < 1e-9);
                let has_echo = alpha <= echo.max_incidence && (echo.min..=echo.max).contains(&distance);
                if !is_at_limit {
                    assert_close(read(model), if has_echo { distance } else { echo.max }, &context);
                    echoes[count] += usize::from(has_echo);
                }
            }
            let reading = read(RangeModel::Reflectance(Echo::REFLECTANCE));
            let cos = math::cos(alpha);
            let signal = ((1.0 - distance) / (distance * distance) * cos * cos).max(0.0);
            assert_close(reading, 2.0 / (1.0 + (1.0 + 4.0 * signal).sqrt()), &context);
            assert!((reading.signal - signal).abs() <= 1e-8 * (1.0 + signal / distance), "{context}");
            echoes[2] += usize::from(signal > 0.0);
        }
        assert!(echoes.iter().all(|&count| count > 200), "{echoes:?}");
    }
}

#[test]
fn a_sonar_detects_the_nearest_mirror_that_faces_it() {
    let mut random = Random::new(32);
    let sonar = Sonar::srf08();
    for corner in [DVec2::ZERO, DVec2::new(1e4, -1e4)] {
        let world = room(corner, Surface::SMOOTH);
        let (mut detected, mut undetected) = (0, 0);
        for case in 0..10_000 {
            let position = DVec3::new(random.between(0.1, 3.9), random.between(0.1, 2.9), random.between(0.1, 2.4));
            let (pitch, yaw) = (random.between(-FRAC_PI_2, FRAC_PI_2), random.between(-PI, PI));
            let pose = Pose3::from_angles(position + corner.extend(0.0), random.between(-PI, PI), pitch, yaw);
            let found = RangeModel::Sonar(sonar).read(&world.caster(ROBOT, Time::ZERO), &pose, 0.0);

            // A mirror returns an echo only from the sensor's projection onto it.
            let forward = pose.forward();
            let projections = (0..3)
                .flat_map(|axis| [(position[axis], -forward[axis]), (ROOM[axis] - position[axis], forward[axis])]);
            let audible = projections.filter(|&(distance, cos)| {
                let angle = math::atan2((1.0 - cos * cos).max(0.0).sqrt(), cos);
                let ratio = angle / sonar.half_angle;
                // Gain squared: 12 dB at the half angle, for the way there and back.
                let gain_squared = math::exp(-4.0 * std::f64::consts::LN_2 * ratio * ratio);
                angle < FRAC_PI_2 && gain_squared / (distance * distance) >= sonar.threshold
            });
            let expected = audible.map(|(distance, _)| distance).min_by(f64::total_cmp);
            match (found.distance, expected) {
                (Some(distance), Some(expected)) => {
                    assert!((distance - expected).abs() < 1e-9, "{case}: {distance} instead of {expected}");
                    detected += 1;
                }
                (None, None) => undetected += 1,
                (found, expected) => panic!("{case}: {found:?} instead of {expected:?}"),
            }
        }
        assert!(detected > 5000 && undetected + detected == 10_000, "{detected} {undetected}");
    }
}

/// A practically infinite wall, `distance` ahead of the origin, whose normal is turned by `angle` from the line of
/// sight.
fn oblique_wall(distance: f64, angle: f64, surface: Surface) -> World {
    let (sin, cos) = math::sin_cos(angle);
    let (middle, along) = (DVec2::new(distance, 0.0), DVec2::new(-sin, cos));
    let wall = Segment::new(middle - 40.0 * along, middle + 40.0 * along);
    world(Walls::new(vec![wall]), Space { walls: vec![surface], ..Space::default() })
}

/// Reading of a sensor at the origin, 0.5 m above the floor, that looks along x.
fn read_ahead(model: RangeModel, world: &World) -> Reading {
    model.read(&world.caster(ROBOT, Time::ZERO), &Pose3 { position: DVec3::new(0.0, 0.0, 0.5), ..Pose3::IDENTITY }, 0.0)
}

#[test]
fn incidence_limits_are_exact_to_a_nanoradian() {
    for (echo, model) in
        [(Echo::LASER, RangeModel::Laser(Echo::LASER)), (Echo::ULTRASONIC, RangeModel::Ultrasonic(Echo::ULTRASONIC))]
    {
        for side in [-1.0, 1.0] {
            let read =
                |angle: f64| read_ahead(model, &oblique_wall(0.5, side * angle, Surface::ROUGH)).distance.unwrap();
            assert!((read(echo.max_incidence - 1e-9) - 0.5).abs() < 1e-12);
            assert!((read(echo.max_incidence) - 0.5).abs() < 1e-12, "the limit is inclusive");
            assert_eq!(read(echo.max_incidence + 1e-9), echo.max);
        }
    }
    // Incidence limits for a sensor that is pitched over the floor.
    for offset in [-1e-9, 0.0, 1e-9] {
        let pose = Pose3::from_angles(DVec3::new(0.3, 0.2, 0.5), 0.7, -(FRAC_PI_4 - offset), 1.1);
        let world = world(Walls::new(Vec::new()), Space::default());
        let reading = RangeModel::Laser(Echo::LASER).read(&world.caster(ROBOT, Time::ZERO), &pose, 0.0);
        assert_eq!(reading.signal == 1.0, offset <= 0.0, "{offset}");
    }
}

#[test]
fn a_rough_wall_returns_echoes_that_a_smooth_wall_reflects_away() {
    let sonar = RangeModel::Sonar(Sonar { rays: 1001, ..Sonar::srf08() });
    // At an incidence of 60 degrees the sensor's projection onto the wall is 60 degrees off the line of sight.
    let angle = PI / 3.0;
    let distance = |surface| read_ahead(sonar, &oblique_wall(3.0, angle, surface)).distance;
    assert_eq!(distance(Surface::SMOOTH), None, "the projection is 1.5 m away, outside the beam");
    let rough = distance(Surface::ROUGH).expect("scattered");
    assert!(rough > 1.5 && rough < 3.0, "{rough}");
    let mixture = distance(Surface { reflectivity: 1.0, specular: 0.5 }).expect("scattered");
    assert!(mixture > rough, "half the energy: the nearest detectable point is nearer to the line of sight: {mixture}");
    assert_eq!(distance(Surface { reflectivity: 0.0, specular: 0.0 }), None);
    // At normal incidence both return an echo from the projection.
    for surface in [Surface::SMOOTH, Surface::ROUGH] {
        let reading = read_ahead(sonar, &oblique_wall(2.0, 0.0, surface));
        assert_eq!((reading.distance, reading.signal), (Some(2.0), 0.25));
    }
}

#[test]
fn the_energy_of_an_echo_matches_its_formula() {
    // A rough wall at 20 degrees, with one ray along the line of sight: cos(20 degrees) / 1.5^2.
    let sonar = Sonar { rays: 1, half_angle: 1e-3, ..Sonar::srf08() };
    let reading = read_ahead(RangeModel::Sonar(sonar), &oblique_wall(1.5, PI / 9.0, Surface::ROUGH));
    assert!((reading.signal - math::cos(PI / 9.0) / 2.25).abs() < 1e-12, "{reading:?}");
    assert!((reading.distance.unwrap() - 1.5).abs() < 1e-12);
    // A specular rod of 1.5 cm radius, 2 m ahead, is just detected: the definition of the preset's threshold.
    let rod = |distance: f64| {
        let figure = Arc::new(Figure::cylinder(0.015, 1.0, Surface::SMOOTH));
        let fixed = vec![(Pose::new(distance + 0.015, 0.0, 0.0), figure)];
        read_ahead(
            RangeModel::Sonar(Sonar::srf08()),
            &world(Walls::new(Vec::new()), Space { fixed, ..Space::default() }),
        )
    };
    assert_eq!(rod(2.001).distance, None);
    let reading = rod(1.999);
    assert!((reading.distance.unwrap() - 1.999).abs() < 1e-12);
    assert!((reading.signal - 0.015 / 2.014 / (1.999 * 1.999)).abs() < 1e-12);
}

#[test]
fn a_sonar_reads_the_nearest_echo_beyond_its_dead_zone() {
    let near = Segment::new(DVec2::new(1.0, 0.3), DVec2::new(1.0, 0.6));
    let far = Segment::new(DVec2::new(2.0, -5.0), DVec2::new(2.0, 5.0));
    let sonar = RangeModel::Sonar(Sonar::srf08());
    let two_walls = world(Walls::new(vec![far, near]), Space::default());
    let reading = read_ahead(sonar, &two_walls).distance.unwrap();
    assert!((reading - math::hypot(1.0, 0.3)).abs() < 1e-12, "the near wall's end, 17 degrees off: {reading}");
    let blind = RangeModel::Sonar(Sonar { min: 1.5, ..Sonar::srf08() });
    assert_eq!(read_ahead(blind, &two_walls).distance, Some(2.0), "echoes from the dead zone are not detected");
    let short = RangeModel::Sonar(Sonar { max: 2.0, ..Sonar::srf08() });
    assert_eq!(
        read_ahead(short, &world(Walls::new(vec![far]), Space::default())).distance,
        Some(2.0),
        "the range is inclusive"
    );
    let shorter = RangeModel::Sonar(Sonar { max: 2.0 - 1e-9, ..Sonar::srf08() });
    assert_eq!(read_ahead(shorter, &world(Walls::new(vec![far]), Space::default())).distance, None);
}

#[test]
fn more_rays_reduce_the_error() {
    // The nearest detectable point of the wall is where its echo falls below the threshold; found by bisection.
    let (angle, distance) = (1.2, 3.0);
    let sonar = Sonar::srf08();
    let echo_at = |theta: f64| {
        let alpha = (angle - theta).abs();
        let metres = distance * math::cos(angle) / math::cos(alpha);
        let ratio = theta / sonar.half_angle;
        (metres, math::exp(-4.0 * std::f64::consts::LN_2 * ratio * ratio) * math::cos(alpha) / (metres * metres))
    };
    let (mut inside, mut outside) = (0.0, angle);
    assert!(echo_at(inside).1 >= sonar.threshold && echo_at(outside).1 < sonar.threshold);
    for _ in 0..60 {
        let middle = 0.5 * (inside + outside);
        *(if echo_at(middle).1 >= sonar.threshold { &mut inside } else { &mut outside }) = middle;
    }
    let truth = echo_at(inside).0;
    let world = oblique_wall(distance, angle, Surface::ROUGH);
    let error = |rays| read_ahead(RangeModel::Sonar(Sonar { rays, ..sonar }), &world).distance.unwrap() - truth;
    for (rays, limit) in [(16, 0.3), (128, 0.03), (1024, 0.003), (8192, 0.0004)] {
        assert!((-1e-12..limit).contains(&error(rays)), "{rays} rays: {} m", error(rays));
    }
}

#[test]
fn a_sonar_measures_low_walls_with_a_body_of_another_shape_near_or_far() {
    // Walls of the default height, 200 mm, at a slant, and a ball behind the sensor, which returns no echo.
    let mut random = Random::new(71);
    let mut slanting = 0;
    for case in 0..500 {
        let (ahead, turn) = (random.between(0.3, 4.0), random.between(-1.4, 1.4));
        let (sin, cos) = math::sin_cos(turn);
        let (middle, along) = (DVec2::new(ahead, 0.0), DVec2::new(-sin, cos) * 40.0);
        let read = |ball: Option<DVec2>, pitch: f64| {
            let walls = Walls::new(vec![Segment::new(middle - along, middle + along)]).with_heights(vec![0.2]);
            let centre = DVec3::new(0.0, 0.0, 0.04);
            let ball = ball.map(|position| {
                let solid = Solid::Capsule { ends: [centre; 2], radius: 0.04 };
                let figure = Arc::new(Figure { solids: vec![solid], surface: Surface::ROUGH });
                (Pose { position, ..Pose::default() }, figure)
            });
            let space = Space { walls: vec![Surface::ROUGH], fixed: ball.into_iter().collect(), ..Space::default() };
            let pose = Pose3::from_angles(DVec3::new(0.0, 0.0, 0.1), 0.0, pitch, 0.0);
            let world = world(walls, space);
            RangeModel::Sonar(Sonar::srf08()).read(&world.caster(ROBOT, Time::ZERO), &pose, 0.0).distance.unwrap_or(6.0)
        };
        let fan = read(None, 0.0);
        assert_eq!(read(Some(DVec2::new(-70.0, 0.0)), 0.0), fan, "{case}: out of range");
        // With a body in range, a spiral is searched too. It can only find a nearer echo.
        let near = read(Some(DVec2::new(-0.2, 0.0)), 0.0);
        assert!(near <= fan && near > fan - 0.05, "{case}: {near} instead of {fan}");
        // A robot that nods by a degree still detects the wall.
        let pitched = read(None, 1.0 / 180.0 * PI);
        assert!((pitched - fan).abs() < 0.05, "{case}: {pitched} instead of {fan}");
        slanting += usize::from(fan > ahead * cos + 1e-3);
    }
    assert!(slanting > 200, "{slanting}");
}

#[test]
fn a_sensor_on_a_tilting_link_moves_with_it() {
    // A mast of 0.3 m on a pan joint, with a tilt joint on it, 5 cm ahead; a sensor 2 cm ahead of that.
    let at = |x: f64, z: f64| Pose3 { position: DVec3::new(x, 0.0, z), ..Pose3::IDENTITY };
    let pan = Link { parent: None, origin: at(0.1, 0.3), axis: DVec3::Z, joint: Some(0) };
    let tilt = Link { parent: Some(0), origin: at(0.05, 0.0), axis: DVec3::NEG_Y, joint: Some(1) };
    let links = [pan, tilt];
    let sensor = RangeSensor { mount: at(0.02, 0.0), link: Some(1), model: RangeModel::Psd { range: 9.0 } };
    let wall = Segment::new(DVec2::new(-9.0, 2.0), DVec2::new(9.0, 2.0));
    let world = world(Walls::new(vec![wall]).with_heights(vec![0.6]), Space::default());
    for (pan, tilt) in
        [(FRAC_PI_2, 0.0), (FRAC_PI_2, 0.1), (FRAC_PI_2, -0.1), (FRAC_PI_2, -0.5), (1.0, -0.1), (1.0, 0.3)]
    {
        let posture =
            Posture { world_from_robot: Pose::new(0.5, 0.2, 0.0), links: &links, angles: &[pan, tilt], lift: 0.0 };
        let found = sensor.read(&world.caster(ROBOT, Time::ZERO), &posture, 0.0).distance;
        let (sin_pan, sin_tilt, cos_tilt) = (math::sin(pan), math::sin(tilt), math::cos(tilt));
        let (y, z) = (0.2 + sin_pan * (0.05 + 0.02 * cos_tilt), 0.3 + 0.02 * sin_tilt);
        let to_wall = (2.0 - y) / (sin_pan * cos_tilt);
        let expected = match z + to_wall * sin_tilt {
            height if height > 0.6 => None,
            height if height < 0.0 => Some(-z / sin_tilt),
            _ => Some(to_wall),
        };
        assert_eq!(found.is_some(), expected.is_some(), "{pan} {tilt}");
        assert!((found.unwrap_or(0.0) - expected.unwrap_or(0.0)).abs() < 1e-12, "{pan} {tilt}: {found:?}");
    }
}

#[test]
fn a_level_psd_on_the_body_is_bit_identical_to_a_beam() {
    let mut random = Random::new(33);
    let walls = Walls::new(accuracy::world::room_with_boxes(3, DVec2::ZERO, 8.0, 12));
    // The walls are lower than all sensors, but a beam hits them.
    let count = walls.len();
    let world = world(walls.with_heights(vec![0.01; count]), Space::default());
    for _ in 0..2000 {
        let (x, y, angle) = (random.between(-0.2, 0.2), random.between(-0.2, 0.2), random.between(-PI, PI));
        let pose = Pose::new(random.between(0.5, 7.5), random.between(0.5, 7.5), random.between(-PI, PI));
        let mount = Pose3::from_angles(DVec3::new(x, y, 0.3), 0.0, 0.0, angle);
        let psd = RangeSensor { mount, link: None, model: RangeModel::Psd { range: 2.0 } };
        let posture = Posture { world_from_robot: pose, ..Posture::default() };
        let beam = Beam { mount: Mount::new(x, y, angle), range: 2.0 };
        let found = psd.read(&world.caster(ROBOT, Time::ZERO), &posture, 0.0).distance;
        assert_eq!(found, beam.distance(&world, ROBOT, &pose, Time::ZERO));
    }
}

#[test]
fn noise_scales_the_distance_or_the_signal() {
    let world = oblique_wall(0.5, 0.0, Surface::ROUGH);
    let read = |model: RangeModel, noise| {
        let pose = Pose3 { position: DVec3::new(0.0, 0.0, 0.5), ..Pose3::IDENTITY };
        model.read(&world.caster(ROBOT, Time::ZERO), &pose, noise)
    };
    for model in [
        RangeModel::Psd { range: 1.0 },
        RangeModel::Laser(Echo::LASER),
        RangeModel::Ultrasonic(Echo::ULTRASONIC),
        RangeModel::Sonar(Sonar::srf08()),
    ] {
        assert_eq!(read(model, 0.5).distance, Some(0.75), "{model:?}");
        assert_eq!(read(model, -2.0).distance, Some(0.0), "{model:?}");
    }
    assert_eq!(read(RangeModel::Reflectance(Echo::REFLECTANCE), 0.5).signal, 3.0);
    assert_eq!(read(RangeModel::Reflectance(Echo::REFLECTANCE), -1.5).distance, Some(1.0));
}

#[test]
fn a_scan_from_a_rolled_and_pitched_mount_matches_its_rays() {
    let world = room(DVec2::ZERO, Surface::ROUGH);
    let fan = Fan { sweep: PI, points: 19, tilt: 0.1, height: 0.4, range: 3.0 };
    let scan = Scan::new(Mount::new(0.1, 0.05, 0.3), fan);
    let robot = Pose::new(2.0, 1.5, 0.7);
    // For a level mount both functions agree.
    let level = Pose3::from_planar(&robot, 0.0).then(&Pose3::from_angles(DVec3::new(0.1, 0.05, 0.4), 0.0, 0.0, 0.3));
    let planar = scan.distances(&world, ROBOT, &robot, Time::ZERO);
    let spatial = scan.distances_from(&world, ROBOT, &level, Time::ZERO);
    for (planar, spatial) in planar.iter().zip(&spatial) {
        assert!((planar.unwrap_or(9.0) - spatial.unwrap_or(9.0)).abs() < 1e-12, "{planar:?} {spatial:?}");
    }
    let tilted = Pose3::from_planar(&robot, 0.0).then(&Pose3::from_angles(DVec3::new(0.1, 0.0, 0.4), 0.2, -0.3, 0.5));
    let found = scan.distances_from(&world, ROBOT, &tilted, Time::ZERO);
    for (ray, found) in found.iter().enumerate() {
        let (sin, cos) = math::sin_cos(scan.bearing(ray as u32));
        let local = DVec3::new(cos * math::cos(0.1), sin * math::cos(0.1), math::sin(0.1));
        let (expected, _) = in_box(tilted.position, tilted.rotation * local);
        match found {
            Some(distance) => assert!((distance - expected).abs() < 1e-12, "{ray}: {distance} instead of {expected}"),
            None => assert!(expected > 3.0, "{ray}: {expected}"),
        }
    }
}

#[test]
fn a_level_psd_detects_meshes() {
    let world = mesh_room(DVec2::ZERO, Surface::ROUGH);
    let read = |z: f64, heading: f64, range: f64| {
        let mount = Pose3 { position: DVec3::new(0.1, 0.0, z), ..Pose3::IDENTITY };
        let psd = RangeSensor { mount, link: None, model: RangeModel::Psd { range } };
        let posture = Posture { world_from_robot: Pose::new(1.0, 1.0, heading), ..Posture::default() };
        psd.read(&world.caster(ROBOT, Time::ZERO), &posture, 0.0).distance
    };
    assert!((read(0.5, 0.0, 9.0).unwrap() - 2.9).abs() < 1e-12);
    assert!((read(0.5, FRAC_PI_2, 9.0).unwrap() - 1.9).abs() < 1e-12);
    assert_eq!((read(0.5, 0.0, 2.8), read(ROOM.z + 0.1, 0.0, 9.0)), (None, None));
}

#[test]
fn a_level_scanner_detects_meshes() {
    // Regression: the scanner saw only the plane, and the floor z = 0 where a mesh is the ground.
    let world = mesh_room(DVec2::ZERO, Surface::ROUGH);
    let robot = Pose::new(1.0, 1.0, 0.3);
    for (tilt, height, range) in [(0.0, 0.1, 9.0), (-0.3, 0.4, 9.0), (0.2, 0.4, 9.0), (-0.1, 0.4, 2.0)] {
        let scan = Scan::new(Mount::new(0.1, 0.0, 0.2), Fan { sweep: 2.0 * PI, points: 36, tilt, height, range });
        let mount = Pose3::from_angles(DVec3::new(0.1, 0.0, height), 0.0, 0.0, 0.2);
        let sensor = Pose3::from_planar(&robot, 0.0).then(&mount);
        for (ray, found) in scan.distances(&world, ROBOT, &robot, Time::ZERO).into_iter().enumerate() {
            let (sin, cos) = math::sin_cos(scan.bearing(ray as u32));
            let local = DVec3::new(cos * math::cos(tilt), sin * math::cos(tilt), math::sin(tilt));
            let (expected, _) = in_box(sensor.position, sensor.rotation * local);
            match found {
                Some(distance) => {
                    assert!((distance - expected).abs() < 1e-9, "{ray}: {distance} instead of {expected}")
                }
                None => assert!(expected > range, "{ray}: {expected}"),
            }
        }
    }
    // Outside the mesh of the ground there is no floor.
    let scan = Scan::new(Mount::default(), Fan { sweep: 2.0 * PI, points: 8, tilt: -0.5, height: 0.4, range: 9.0 });
    let beside = Pose::new(-20.0, 0.0, 0.0);
    assert_eq!(scan.distances(&world, ROBOT, &beside, Time::ZERO), [None; 8]);
}

#[test]
fn a_movable_mesh_is_detected_beyond_its_footprint() {
    // Regression: rays that missed the footprint (5 cm here) also missed the mesh (1 m).
    let sheet = [DVec3::new(0.0, -1.0, 0.0), DVec3::new(0.0, 1.0, 0.0), DVec3::new(0.0, 1.0, 2.0)];
    let figure = Figure { solids: vec![Solid::Mesh(Arc::new(MeshIndex::new(&[sheet])))], surface: Surface::ROUGH };
    let part = Part { shape: Shape::Disc { radius: 0.05 }, object_from_part: Pose::default() };
    let properties = Properties {
        mass: 1.0,
        centre_of_mass: DVec2::ZERO,
        parts: vec![part],
        resistance: Resistance::Sliding(0.5),
        restitution: 0.5,
        contact_friction: 0.3,
        lift: 0.0,
    };
    let objects = [(Arc::new(properties), Pose::new(2.0, 0.0, 0.0))];
    let world = World::new(Arc::new(Walls::new(Vec::new())), Time::from_millis(50), std::iter::empty())
        .with_objects(objects)
        .with_space(Space { objects: vec![Arc::new(figure)], ..Space::default() });
    for (y, expected) in [(0.0, Some(2.0)), (0.4, Some(2.0)), (0.9, Some(2.0)), (-0.9, None), (1.1, None)] {
        let hit = world.cast(ROBOT, &Ray::new(DVec3::new(0.0, y, 0.3), DVec3::X, 9.0), Time::ZERO);
        assert_eq!(hit.map(|hit| hit.distance), expected, "{y}");
    }
}

#[test]
fn a_tilted_scanner_detects_the_upper_face_of_a_thick_wall() {
    // Regression: the scanner detected the far side from inside the wall, 0.4 m away along the floor.
    let centre_line = Segment::new(DVec2::new(0.3, -1.0), DVec2::new(0.3, 1.0));
    let walls = Walls::new(centre_line.thickened(0.2).to_vec()).with_heights(vec![0.1; 4]);
    let block = ThickWall::new(WallId(0), &centre_line, 0.2, 0.1);
    let world = world(walls, Space { thick_walls: vec![block], ..Space::default() });
    let read = |height: f64| {
        let fan = Fan { sweep: 0.1, points: 1, tilt: -FRAC_PI_4, height, range: 9.0 };
        Scan::new(Mount::default(), fan).distances(&world, ROBOT, &Pose::default(), Time::ZERO)[0]
            .expect("wall or floor")
    };
    // Side, upper face, floor beyond.
    for (height, along) in [(0.25, 0.2), (0.4, 0.3), (0.55, 0.55)] {
        assert!((read(height) - along * 2.0_f64.sqrt()).abs() < 1e-12, "{height}: {}", read(height));
    }
}

#[test]
fn a_sonar_with_threshold_0_ignores_surfaces_without_echo() {
    // Regression: with a threshold of 0, a mirror slanting away hid the wall beside it.
    let mirror = Segment::new(DVec2::new(0.5, -0.1), DVec2::new(0.7, 0.1));
    let beside = Segment::new(DVec2::new(0.8, 0.4), DVec2::new(0.8, 0.6));
    let space = Space { walls: vec![Surface::SMOOTH, Surface::ROUGH], ..Space::default() };
    let world = world(Walls::new(vec![mirror, beside]), space);
    for threshold in [0.0, 1e-300] {
        let found = read_ahead(RangeModel::Sonar(Sonar { threshold, ..Sonar::srf08() }), &world).distance;
        assert!((found.expect("the wall") - math::hypot(0.8, 0.4)).abs() < 1e-12, "{threshold}: {found:?}");
    }
}

#[test]
fn a_sonar_detects_the_faces_of_a_mesh_that_its_fan_hits() {
    // Echoes come from the sensor's projections onto the planes; the fan must hit a triangle of each plane.
    let sonar = Sonar { rays: 256, ..Sonar::srf08() };
    let mut random = Random::new(34);
    let (walls, mesh) = (room(DVec2::ZERO, Surface::SMOOTH), mesh_room(DVec2::ZERO, Surface::SMOOTH));
    let mut echoes = 0;
    for case in 0..1000 {
        let position = DVec3::new(random.between(0.5, 3.5), random.between(0.5, 2.5), random.between(0.5, 2.0));
        let pose = Pose3::from_angles(position, 0.0, random.between(-1.0, 1.0), random.between(-PI, PI));
        let read = |world: &World| RangeModel::Sonar(sonar).read(&world.caster(ROBOT, Time::ZERO), &pose, 0.0).distance;
        match (read(&walls), read(&mesh)) {
            (Some(exact), Some(found)) => {
                assert!((found - exact).abs() < 1e-9, "{case}: {found} instead of {exact}");
                echoes += 1;
            }
            (exact, found) => assert_eq!(found, exact, "{case}"),
        }
    }
    assert!(echoes > 500, "{echoes}");
}
