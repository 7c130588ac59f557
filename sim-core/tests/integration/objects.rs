//! Movable objects alone and among walls: closed forms, energy, tunnelling, sleep, bit-identical reproduction.

use std::sync::Arc;

use glam::DVec2;
use sim_core::{
    ObjectId,
    object::{Bodies, GRAVITY, Part, Properties, Resistance, Shape},
    pose::Pose,
    scene::{Segment, Walls},
};

fn object(shape: Shape, mass: f64, resistance: Resistance, restitution: f64) -> Arc<Properties> {
    Arc::new(Properties {
        mass,
        centre_of_mass: DVec2::ZERO,
        parts: vec![Part { shape, object_from_part: Pose::default() }],
        resistance,
        restitution,
        contact_friction: 0.0,
        lift: 0.0,
    })
}

fn ball(radius: f64, mass: f64, resistance: Resistance, restitution: f64) -> Arc<Properties> {
    object(Shape::Disc { radius }, mass, resistance, restitution)
}

const FREE: Resistance = Resistance::Sliding(0.0);

fn room(width: f64, height: f64) -> Walls {
    let corners = [DVec2::ZERO, DVec2::new(width, 0.0), DVec2::new(width, height), DVec2::new(0.0, height)];
    Walls::new((0..4).map(|side| Segment::new(corners[side], corners[(side + 1) % 4])).collect())
}

fn id(number: u32) -> ObjectId {
    ObjectId(number)
}

fn run(bodies: &mut Bodies, steps: usize) {
    let mut pushes = Vec::new();
    for _ in 0..steps {
        bodies.step(&[], &mut pushes);
    }
}

fn position(bodies: &Bodies, number: u32) -> DVec2 {
    bodies.state(id(number)).world_from_object.position
}

#[test]
fn stopping_distances_match_constant_deceleration() {
    for (resistance, coefficient) in [(Resistance::Sliding(0.4), 0.4), (Resistance::Rolling(0.02), 0.02)] {
        for speed in [0.003, 0.1, 0.77] {
            let mut bodies = Bodies::new(&Walls::new(vec![]), [(ball(0.02, 0.05, resistance, 0.5), Pose::default())]);
            bodies.set_velocity(id(1), DVec2::new(0.6, 0.8) * speed, 0.0);
            run(&mut bodies, 10_000);
            let distance = speed * speed / (2.0 * coefficient * GRAVITY);
            let path_length = position(&bodies, 1).length();
            assert!(
                (path_length - distance).abs() < 1e-12,
                "{resistance:?} {speed} m/s: {path_length} instead of {distance}, within a picometre"
            );
            assert!(bodies.state(id(1)).is_resting() && bodies.is_asleep(id(1)), "it rests and sleeps");
        }
    }
}

#[test]
fn spinning_disc_is_stopped_by_uniform_friction_torque() {
    let mut bodies =
        Bodies::new(&Walls::new(vec![]), [(ball(0.1, 1.0, Resistance::Sliding(0.5), 0.5), Pose::default())]);
    bodies.set_velocity(id(1), DVec2::ZERO, 10.0);
    run(&mut bodies, 2_000);
    // Torque 2/3 mu m g r on the inertia m r^2 / 2: 4/3 mu g / r.
    let angle = 10.0 * 10.0 / (2.0 * 4.0 / 3.0 * 0.5 * GRAVITY / 0.1);
    let turned = bodies.state(id(1)).world_from_object.heading.radians();
    assert!((turned / angle - 1.0).abs() < 1e-4, "{turned} instead of {angle}");
}

#[test]
fn equal_balls_exchange_their_velocities() {
    let shot = ball(0.02, 0.1, FREE, 1.0);
    let mut bodies =
        Bodies::new(&Walls::new(vec![]), [(shot.clone(), Pose::default()), (shot, Pose::new(0.1, 0.0, 0.0))]);
    bodies.set_velocity(id(1), DVec2::new(0.5, 0.0), 0.0);
    run(&mut bodies, 300);
    let (one, other) = (bodies.state(id(1)), bodies.state(id(2)));
    assert!(
        one.velocity.length() < 1e-9 && (other.velocity - DVec2::new(0.5, 0.0)).length() < 1e-9,
        "{one:?} {other:?}"
    );
    // The objects touch after 0.06 m, up to the distance covered in a step.
    assert!((one.world_from_object.position.x - 0.06).abs() < 0.5e-3, "{one:?}");
    assert!((other.world_from_object.position.x - (0.1 + 0.5 * 0.3 - 0.06)).abs() < 0.5e-3, "{other:?}");
}

#[test]
fn rebound_speed_at_a_wall_is_restitution_times_speed() {
    for restitution in [0.0, 0.3, 0.8, 1.0] {
        let mut bodies = Bodies::new(&room(1.0, 1.0), [(ball(0.05, 0.1, FREE, restitution), Pose::new(0.5, 0.5, 0.0))]);
        bodies.set_velocity(id(1), DVec2::new(1.0, 0.25), 0.0);
        run(&mut bodies, 600);
        let velocity = bodies.state(id(1)).velocity;
        assert!((velocity - DVec2::new(-restitution, 0.25)).length() < 1e-9, "{restitution}: {velocity}");
    }
}

/// Maximum relative increase of the energy in a step, and the ratio of the final to the initial energy.
fn watch_energy(bodies: &mut Bodies, steps: usize) -> (f64, f64) {
    let start = bodies.energy();
    let (mut last, mut rise) = (start, 0.0_f64);
    let mut pushes = Vec::new();
    for _ in 0..steps {
        bodies.step(&[], &mut pushes);
        let energy = bodies.energy();
        rise = rise.max((energy - last) / start.max(f64::MIN_POSITIVE));
        last = energy;
    }
    (rise, last / start)
}

/// Random numbers in [-1, 1] from a linear congruential generator.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

fn crowd(restitution: f64, resistance: Resistance, contact_friction: f64) -> Bodies {
    let mut random = Random(7);
    let mut objects = Vec::new();
    for row in 0..6 {
        for column in 0..6 {
            let shape = match (row + column) % 3 {
                0 => Shape::Disc { radius: 0.04 },
                1 => Shape::Rectangle { half: DVec2::new(0.05, 0.03) },
                _ => Shape::Capsule { half_length: 0.03, radius: 0.02 },
            };
            let mass = 0.05 + 0.1 * f64::from(row);
            let properties = Properties { contact_friction, ..(*object(shape, mass, resistance, restitution)).clone() };
            let pose = Pose::new(0.1 + 0.15 * f64::from(column), 0.1 + 0.15 * f64::from(row), random.next());
            objects.push((Arc::new(properties), pose));
        }
    }
    let mut bodies = Bodies::new(&room(1.0, 1.0), objects);
    for number in 1..=36 {
        bodies.set_velocity(id(number), DVec2::new(random.next(), random.next()) * 2.0, 10.0 * random.next());
    }
    bodies
}

fn all_inside(bodies: &Bodies, width: f64, height: f64) {
    for number in 1..=bodies.len() as u32 {
        let at = position(bodies, number);
        assert!(at.is_finite() && at.x > 0.0 && at.x < width && at.y > 0.0 && at.y < height, "o{number} is at {at}");
    }
}

#[test]
fn energy_of_many_objects_never_increases() {
    for (restitution, friction) in [(1.0, 0.0), (1.0, 0.5), (0.5, 0.3), (0.0, 0.8)] {
        let mut bodies = crowd(restitution, FREE, friction);
        let (rise, left) = watch_energy(&mut bodies, 3_000);
        println!("restitution {restitution}, friction {friction}: rises {rise:e} a step, {left} is left after 3 s");
        assert!(rise < 1e-12, "restitution {restitution}: {rise:e} a step; a thousand steps stay below 1e-6");
        all_inside(&bodies, 1.0, 1.0);
    }
}

#[test]
fn initial_overlaps_are_resolved_without_adding_energy() {
    let crate_ = object(Shape::Rectangle { half: DVec2::splat(0.05) }, 0.5, FREE, 0.5);
    let shot = ball(0.03, 0.05, FREE, 1.0);
    let mut bodies = Bodies::new(
        &room(1.0, 1.0),
        [
            (crate_.clone(), Pose::new(0.5, 0.5, 0.0)),
            (crate_.clone(), Pose::new(0.58, 0.52, 0.4)),
            (shot.clone(), Pose::new(0.5, 0.56, 0.0)),
            (crate_, Pose::new(0.03, 0.3, 0.2)),
            (shot, Pose::new(0.01, 0.8, 0.0)),
        ],
    );
    let mut pushes = Vec::new();
    for _ in 0..3_000 {
        bodies.step(&[], &mut pushes);
        assert!(bodies.energy() < 1e-20, "{} J out of nothing", bodies.energy());
    }
    all_inside(&bodies, 1.0, 1.0);
    assert!(position(&bodies, 5).x > 0.0299, "out of the wall: {}", position(&bodies, 5));
    assert!((position(&bodies, 1) - position(&bodies, 2)).length() > 0.0999, "apart");
}

#[test]
fn impact_passes_through_a_row_of_touching_crates() {
    let crate_ = object(Shape::Rectangle { half: DVec2::splat(0.05) }, 0.5, FREE, 1.0);
    let shot = ball(0.03, 0.2, FREE, 1.0);
    let mut objects: Vec<_> =
        (0..6).map(|index| (crate_.clone(), Pose::new(0.5 + 0.1 * f64::from(index), 0.5, 0.0))).collect();
    objects.push((shot, Pose::new(0.3, 0.51, 0.0)));
    let mut bodies = Bodies::new(&room(1.3, 1.0), objects);
    bodies.set_velocity(id(7), DVec2::new(3.0, 0.0), 0.0);
    let (rise, left) = watch_energy(&mut bodies, 2_000);
    println!("a row of crates: rises {rise:e} a step, {left} is left");
    assert!(rise < 1e-12, "{rise:e}");
    all_inside(&bodies, 1.3, 1.0);
}

#[test]
fn fast_balls_do_not_tunnel() {
    let shot = ball(0.002, 0.01, FREE, 1.0);
    let mut random = Random(3);
    let objects: Vec<_> =
        (0..20).map(|index| (shot.clone(), Pose::new(0.05 + 0.045 * f64::from(index), 0.5, 0.0))).collect();
    let mut bodies = Bodies::new(&room(1.0, 1.0), objects);
    for number in 1..=20 {
        bodies.set_velocity(id(number), DVec2::new(random.next(), random.next()) * 50.0, 0.0);
    }
    let mut pushes = Vec::new();
    let start = bodies.energy();
    for step in 0..2_000 {
        bodies.step(&[], &mut pushes);
        assert!(bodies.energy() <= start * (1.0 + 1e-9), "step {step}");
        all_inside(&bodies, 1.0, 1.0);
    }
    // A ball shot at a resting ball must hit it at any speed.
    let mut bodies =
        Bodies::new(&Walls::new(vec![]), [(shot.clone(), Pose::default()), (shot, Pose::new(0.5, 0.0, 0.0))]);
    bodies.set_velocity(id(1), DVec2::new(40.0, 0.0), 0.0);
    run(&mut bodies, 100);
    assert!(bodies.state(id(2)).velocity.x > 39.9, "{:?}", bodies.state(id(2)));
}

#[test]
fn ball_between_wall_and_crate_does_not_escape() {
    let heavy = object(Shape::Rectangle { half: DVec2::splat(0.1) }, 5.0, FREE, 0.5);
    let shot = ball(0.02, 0.01, FREE, 0.9);
    let mut bodies =
        Bodies::new(&room(1.0, 1.0), [(heavy, Pose::new(0.3, 0.5, 0.0)), (shot, Pose::new(0.05, 0.5, 0.0))]);
    bodies.set_velocity(id(1), DVec2::new(-1.0, 0.0), 0.0);
    let mut pushes = Vec::new();
    let start = bodies.energy();
    for _ in 0..1_000 {
        bodies.step(&[], &mut pushes);
        assert!(bodies.energy() <= start * (1.0 + 1e-12));
        // The ball has a five-hundredth of the crate's mass; it penetrates by less than 2.5 mm.
        assert!(position(&bodies, 2).x > 0.0175, "the ball is squeezed into the wall: {}", position(&bodies, 2));
    }
    all_inside(&bodies, 1.0, 1.0);
}

#[test]
fn chaotic_scene_matches_the_golden_hash() {
    let mut bodies = crowd(0.8, Resistance::Sliding(0.05), 0.3);
    run(&mut bodies, 1_500);
    let mut digest = 0xcbf2_9ce4_8422_2325_u64;
    for number in 1..=bodies.len() as u32 {
        let state = bodies.state(id(number));
        let heading = state.world_from_object.heading;
        for value in [
            state.world_from_object.position.x,
            state.world_from_object.position.y,
            heading.remainder(),
            state.velocity.x,
            state.velocity.y,
            state.omega,
        ] {
            digest = (digest ^ value.to_bits()).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
    assert_eq!(digest, 15_733_111_136_974_606_271, "the digest of debug and release builds alike");
}

#[test]
fn resting_objects_sleep_until_they_are_hit() {
    let crate_ = object(Shape::Rectangle { half: DVec2::splat(0.05) }, 0.5, Resistance::Sliding(0.4), 0.2);
    let shot = ball(0.02, 0.1, Resistance::Rolling(0.01), 0.5);
    let mut bodies =
        Bodies::new(&room(2.0, 1.0), [(crate_, Pose::new(1.0, 0.5, 0.0)), (shot, Pose::new(0.3, 0.5, 0.0))]);
    run(&mut bodies, 50);
    assert_eq!(bodies.awake().count(), 0);
    bodies.set_velocity(id(2), DVec2::new(1.0, 0.0), 0.0);
    run(&mut bodies, 300);
    assert_eq!(bodies.awake().collect::<Vec<_>>(), [id(2)], "the crate sleeps on while the ball rolls");
    run(&mut bodies, 500);
    let state = bodies.state(id(1));
    assert!(state.world_from_object.position.x > 1.001, "{state:?}");
    run(&mut bodies, 20_000);
    assert_eq!(bodies.awake().count(), 0);
}
