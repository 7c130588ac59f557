use std::sync::Arc;

use glam::DVec2;

use super::*;
use crate::drive::legged::{Gait, Leg, Legs};
use crate::drive::{DriveKind, Model};
use crate::noise::{Purpose, Stream};
use crate::object::{Figure, Shape, Solid};
use crate::pose::Pose;
use crate::scene::{self, Ground, Segment, Steps, Surface, WallId, Walls};
use crate::world::Space;

fn walls() -> Arc<Walls> {
    let wall = |a: [f64; 2], b: [f64; 2]| Segment::new(a.into(), b.into());
    let segments = vec![wall([0.0, 1.0], [2.0, 1.0]), wall([3.0, 0.0], [3.0, 2.0])];
    Arc::new(Walls::new(segments).with_heights(vec![0.3, f64::INFINITY]))
}

fn prism() -> Solid {
    let footprint = Shape::Rectangle { half: DVec2::new(0.3, 0.2) };
    Solid::Prism { footprint, body_from_footprint: Pose::new(0.1, 0.0, 0.4), bottom: 0.1, top: 0.5 }
}

fn world() -> World {
    let figure = |solids: Vec<Solid>| Arc::new(Figure { solids, surface: Surface::default() });
    let ball = Solid::Capsule { ends: [DVec3::new(0.0, 0.0, 0.2); 2], radius: 0.2 };
    let disc = Shape::Disc { radius: 0.25 };
    let post = Solid::Prism { footprint: disc, body_from_footprint: Pose::new(0.8, 0.0, 0.0), bottom: 0.0, top: 0.7 };
    let fixed = vec![
        (Pose::new(-2.0, -2.0, 0.3), figure(vec![prism()])),
        (Pose::new(-2.0, 1.0, 1.0), figure(vec![ball, post])),
    ];
    World::new(walls(), Time::from_millis(10), []).with_space(Space { fixed, ..Space::default() })
}

fn capsule_contacts(ends: [[f64; 3]; 2], radius: f64) -> Vec<Thing> {
    things(&world(), &Capsule { ends: ends.map(DVec3::from), radius })
}

/// Contacts of a capsule; checks that each point of contact lies within the capsule.
fn things(world: &World, capsule: &Capsule) -> Vec<Thing> {
    let contacts = world.capsule_contacts(RobotId(1), capsule, Time::ZERO);
    for (thing, point) in &contacts {
        let distance = crate::scene::distance::segment_to_segment(capsule.ends, [*point; 2]);
        assert!(distance <= capsule.radius + 1e-12, "{thing:?} is touched at {point}, {distance} m off");
    }
    contacts.into_iter().map(|(thing, _)| thing).collect()
}

#[test]
fn capsule_touches_walls_up_to_their_heights() {
    let upright = |y: f64, z: f64| capsule_contacts([[1.0, y, z], [1.0, y, z + 0.5]], 0.05);
    assert_eq!(upright(0.951, 0.1), [Thing::Wall(WallId(0))]);
    assert_eq!(upright(0.949, 0.1), []);
    assert_eq!(upright(1.0, 0.349), [Thing::Wall(WallId(0))]);
    assert_eq!(upright(1.0, 0.351), []);
    // The capsule lies beyond the upper edge, at 45 degrees.
    let offset = 0.05 * std::f64::consts::FRAC_1_SQRT_2;
    assert_eq!(upright(1.0 - offset + 1e-6, 0.3 + offset), [Thing::Wall(WallId(0))]);
    assert_eq!(upright(1.0 - offset - 1e-6, 0.3 + offset), []);
    // Through the wall, and far up through a wall of unlimited height.
    assert_eq!(capsule_contacts([[1.0, 0.5, 0.2], [1.0, 1.5, 0.2]], 0.01), [Thing::Wall(WallId(0))]);
    assert_eq!(capsule_contacts([[2.5, 1.0, 50.0], [3.5, 1.0, 50.0]], 1e-6), [Thing::Wall(WallId(1))]);
}

#[test]
fn capsule_contacts_match_brute_force() {
    let world = world();
    let mut stream = Stream::new(4, RobotId(0), Purpose::Terrain, 95, 0);
    let (mut touching, mut free) = (0, 0);
    for _ in 0..3000 {
        let mut unit = || stream.unit();
        let centre = if unit() < 0.5 { DVec2::new(-2.0, -2.0) } else { DVec2::new(-2.0, 1.0) };
        let mut point = || DVec3::new(centre.x + 2.4 * unit() - 1.2, centre.y + 2.4 * unit() - 1.2, unit());
        let capsule = Capsule { ends: [point(), point()], radius: 0.08 };
        // Samples along the axis; neighbouring points are at most 7 mm apart.
        let distance = |number: u32| {
            let (pose, figure) = &world.indexed_space.space.fixed[number as usize];
            let mut minimum = f64::INFINITY;
            for step in 0..=500 {
                let point = capsule.ends[0].lerp(capsule.ends[1], f64::from(step) / 500.0);
                figure.for_each_nearest(pose, point, |nearest| minimum = minimum.min(nearest.distance(point)));
            }
            minimum
        };
        let things = things(&world, &capsule);
        for number in 0..2 {
            let (distance, is_touched) = (distance(number), things.contains(&Thing::Fixed(number)));
            if distance <= capsule.radius {
                touching += 1;
                assert!(is_touched, "{capsule:?} is {distance} m from body {number}");
            } else if distance > capsule.radius + 0.004 {
                free += 1;
                assert!(!is_touched, "{capsule:?} is {distance} m from body {number}");
            }
        }
    }
    assert!(touching > 500 && free > 500, "{touching} touching, {free} free");
}

#[test]
fn capsule_contacts_exclude_the_ground() {
    let slab = Arc::new(Figure { solids: vec![prism()], surface: Surface::default() });
    let pose = Pose::new(-2.0, -2.0, 0.3);
    let space = |floor| Space { floor, fixed: vec![(pose, Arc::clone(&slab))], ..Space::default() };
    let capsule = Capsule { ends: [DVec3::new(-1.9, -2.0, 0.3); 2], radius: 0.05 };
    let of = |floor| {
        let world = World::new(walls(), Time::from_millis(10), []).with_space(space(floor));
        things(&world, &capsule)
    };
    assert_eq!(of(Some(Surface::SMOOTH)), [Thing::Fixed(0)]);
    assert_eq!(of(None), []);
}

fn model(kind: DriveKind) -> Model {
    Model {
        kind,
        wheel_diameter: 0.05,
        max_wheel_rate: 60.0,
        ticks_per_turn: 1000.0,
        track: 0.1,
        wheelbase: 0.1,
        axis_offset: 0.0,
        max_speed: 1.0,
        max_turn: 1.0,
        body_radius: 0.3,
        wheel_lag: 0.0,
        max_steering: 0.7,
        mass: 10.0,
        traction: 0.6,
    }
}

/// A robot with two legs without feet; thighs and shanks are 0.44 m long, the hips 0.8 m high. Its heading is along x.
fn walker(position: DVec2, ground: Ground) -> Motion {
    let leg = |name: &str, y: f64| Leg {
        name: name.to_owned(),
        hip: DVec3::new(0.0, y, 0.8),
        thigh: 0.44,
        shank: 0.44,
        foot: None,
        wheel: None,
    };
    let gait = Gait {
        name: "walk".to_owned(),
        period: Time(1_000_000),
        duty: 0.7,
        offsets: vec![0.0, 0.5],
        is_natural: false,
    };
    let legs = vec![leg("LEFT", 0.2), leg("RIGHT", -0.2)];
    let legs = Legs { legs, gaits: vec![gait], step_height: 0.05, radius: 0.03, underside: 0.7 };
    let pose = Pose::new(position.x, position.y, 0.0);
    Motion::new(RobotId(1), Arc::new(model(DriveKind::Legged)), walls(), pose)
        .with_legs(Arc::new(legs), Arc::new(ground))
}

fn leg_clearance(position: [f64; 2], ground: Ground) -> LegClearance {
    let mut motion = walker(position.into(), ground);
    world().leg_clearance(&mut motion, Time::ZERO, 0.5).expect("legs")
}

fn block(from: [f64; 2], to: [f64; 2], height: f64) -> Ground {
    let (origin, size) = (DVec2::new(-10.0, -20.0), DVec2::splat(40.0));
    let block = scene::Block { bounds: Bounds { min: from.into(), max: to.into() }, height };
    let steps = Steps { origin, size, base: 0.0, stairs: vec![], blocks: vec![block] };
    Ground::Field(Arc::new(steps.field().expect("a field")))
}

#[test]
fn standing_legs_have_no_contacts() {
    let standing = leg_clearance([8.0, -8.0], Ground::Flat);
    assert_eq!(standing.contacts, []);
    // The shanks are tested down to 90 mm above their tips, have a radius of 30 mm, and are nearly upright.
    assert!((0.05..=0.06).contains(&standing.clearance), "{standing:?}");
    let mut gliding = Motion::new(RobotId(1), Arc::new(model(DriveKind::Differential)), walls(), Pose::default());
    assert_eq!(world().leg_clearance(&mut gliding, Time::ZERO, 0.5), None);
}

#[test]
fn leg_parts_touch_ground_and_obstacles() {
    let parts = |position, ground| -> Vec<(BodyPart, Thing)> {
        leg_clearance(position, ground).contacts.iter().map(|touch| (touch.part, touch.thing)).collect()
    };
    // The knees lie ahead of the hips, by less than 0.2 m. A block 0.3 m high is between knees and shanks of the left
    // leg.
    let beside = |from: f64, to: f64, height| block([8.0 + from, -7.85], [8.0 + to, -7.75], height);
    assert_eq!(parts([8.0, -8.0], beside(0.25, 0.4, 0.6)), []);
    assert_eq!(parts([8.0, -8.0], beside(0.11, 0.4, 0.3)), [(BodyPart::Shank(0), Thing::Floor)]);
    let high = [(BodyPart::Thigh(0), Thing::Floor), (BodyPart::Shank(0), Thing::Floor)];
    assert_eq!(parts([8.0, -8.0], beside(0.11, 0.4, 0.6)), high);
    // A block under the body only, higher than its underside.
    let under = block([7.95, -8.05], [8.05, -7.95], 0.71);
    assert_eq!(parts([8.0, -8.0], under), [(BodyPart::Body, Thing::Floor)]);
    let low = leg_clearance([8.0, -8.0], block([7.95, -8.05], [8.05, -7.95], 0.66));
    assert!(low.contacts.is_empty() && (low.clearance - 0.04).abs() < 1e-9, "{low:?}");
    // The left leg is inside a wall that is 0.3 m high.
    assert_eq!(parts([1.0, 0.8], Ground::Flat), [(BodyPart::Shank(0), Thing::Wall(WallId(0)))]);
}
