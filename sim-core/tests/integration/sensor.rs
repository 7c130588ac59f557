//! Sensor readings against plane geometry.

use std::{f64::consts::PI, sync::Arc};

use accuracy::world::Random;
use glam::{DVec2, DVec3};
use sim_core::{
    RobotId,
    build::range_sensors,
    pose::Pose,
    scene::{Bounds, Segment, Walls},
    sensor::{Beam, Mount, Posture},
    spec::{DEFAULT_PSD_RANGE, PsdSpec, RobiSpec, Span},
    time::Time,
    world::World,
};

/// A room of 4 m by 3 m with its lower left corner at `corner`.
fn room(corner: DVec2) -> World {
    let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]].map(|[x, y]| corner + DVec2::new(x, y));
    let walls = (0..4).map(|i| Segment::new(corners[i], corners[(i + 1) % 4])).collect();
    World::new(Arc::new(Walls::new(walls)), Time::from_millis(50), std::iter::empty())
}

#[test]
fn readings_in_a_room_match_the_closed_form() {
    let mut random = Random::new(5);
    for corner in [DVec2::ZERO, DVec2::new(1e4, -1e4)] {
        let world = room(corner);
        for _ in 0..10_000 {
            let position = random.point_in(Bounds { min: DVec2::splat(0.3), max: DVec2::new(3.7, 2.7) });
            let heading = random.between(-PI, PI);
            let (x, y, angle) = (random.between(-0.2, 0.2), random.between(-0.2, 0.2), random.between(-PI, PI));
            let beam = Beam { mount: Mount::new(x, y, angle), range: 9.0 };
            let pose = Pose { position: corner + position, ..Pose::new(0.0, 0.0, heading) };
            let found = beam.distance(&world, RobotId(1), &pose, Time::ZERO).expect("walls all around");

            let (sin, cos) = (libm::sin(heading), libm::cos(heading));
            let (ox, oy) = (position.x + cos * x - sin * y, position.y + sin * x + cos * y);
            let (dx, dy) = (libm::cos(heading + angle), libm::sin(heading + angle));
            let to_x = if dx > 0.0 { (4.0 - ox) / dx } else { -ox / dx };
            let to_y = if dy > 0.0 { (3.0 - oy) / dy } else { -oy / dy };
            assert!((found - to_x.min(to_y)).abs() < 1e-9, "within 1 nm: {found} instead of {}", to_x.min(to_y));
        }
    }
}

#[test]
fn the_range_is_inclusive_and_nothing_beyond_it_is_detected() {
    let world = room(DVec2::ZERO);
    let pose = Pose::new(1.0, 1.0, 0.0);
    let distance = |range: f64| {
        let beam = Beam { mount: Mount::default(), range };
        let distance = beam.distance(&world, RobotId(1), &pose, Time::ZERO);
        assert_eq!(beam.is_interrupted(&world, RobotId(1), &pose, Time::ZERO), distance.is_some());
        distance
    };
    assert_eq!(distance(3.0), Some(3.0));
    assert_eq!(distance(3.0 - 1e-9), None);
    assert_eq!(distance(0.0), None);
}

#[test]
fn readings_of_a_level_psd_and_a_plane_beam_are_bit_identical() {
    let world = room(DVec2::ZERO);
    let mut random = Random::new(6);
    for _ in 0..2_000 {
        let psd = PsdSpec {
            name: "P".to_owned(),
            id: Some(1),
            position: DVec3::new(random.between(-0.09, 0.09), random.between(-0.09, 0.09), 0.06),
            angle: random.between(-14.0, 14.0),
            pitch: 0.0,
            link: None,
            range: DEFAULT_PSD_RANGE,
            span: Span::default(),
        };
        let robi = RobiSpec { psds: vec![psd], ..RobiSpec::with_defaults("r.robi") };
        let psd = &robi.psds[0];
        let beam = Beam { mount: Mount::new(psd.position.x, psd.position.y, psd.angle), range: psd.range };
        let world_from_robot = Pose::new(random.between(0.3, 3.7), random.between(0.3, 2.7), random.between(-9.0, 9.0));
        let posture = Posture { world_from_robot, ..Posture::default() };
        let reading = range_sensors(&robi)[0].read(&world.caster(RobotId(1), Time::ZERO), &posture, 0.0);
        let distance = beam.distance(&world, RobotId(1), &world_from_robot, Time::ZERO);
        assert_eq!(reading.distance.map(f64::to_bits), distance.map(f64::to_bits), "{psd:?}");
    }
}
