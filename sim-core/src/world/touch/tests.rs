use std::sync::Arc;

use glam::DVec2;

use super::*;
use crate::noise::{Purpose, Stream};
use crate::object::{Shape, Solid};
use crate::scene::{Segment, Surface, WallId, Walls};
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

fn touched(ends: [[f64; 3]; 2], radius: f64) -> Vec<Seen> {
    world().touched(RobotId(1), &Capsule { ends: ends.map(DVec3::from), radius }, Time::ZERO)
}

#[test]
fn walls_are_touched_up_to_their_heights() {
    let upright = |y: f64, z: f64| touched([[1.0, y, z], [1.0, y, z + 0.5]], 0.05);
    assert_eq!(upright(0.951, 0.1), [Seen::Wall(WallId(0))]);
    assert_eq!(upright(0.949, 0.1), []);
    assert_eq!(upright(1.0, 0.349), [Seen::Wall(WallId(0))]);
    assert_eq!(upright(1.0, 0.351), []);
    // Over the edge at 45 degrees.
    let aside = 0.05 * std::f64::consts::FRAC_1_SQRT_2;
    assert_eq!(upright(1.0 - aside + 1e-6, 0.3 + aside), [Seen::Wall(WallId(0))]);
    assert_eq!(upright(1.0 - aside - 1e-6, 0.3 + aside), []);
    // Through the wall, and through one without end far up.
    assert_eq!(touched([[1.0, 0.5, 0.2], [1.0, 1.5, 0.2]], 0.01), [Seen::Wall(WallId(0))]);
    assert_eq!(touched([[2.5, 1.0, 50.0], [3.5, 1.0, 50.0]], 1e-6), [Seen::Wall(WallId(1))]);
}

#[test]
fn bodies_are_touched_as_brute_force_finds() {
    let world = world();
    let mut stream = Stream::new(4, RobotId(0), Purpose::Terrain, 95, 0);
    let (mut touching, mut free) = (0, 0);
    for _ in 0..3000 {
        let mut unit = || stream.unit();
        let centre = if unit() < 0.5 { DVec2::new(-2.0, -2.0) } else { DVec2::new(-2.0, 1.0) };
        let mut point = || DVec3::new(centre.x + 2.4 * unit() - 1.2, centre.y + 2.4 * unit() - 1.2, unit());
        let capsule = Capsule { ends: [point(), point()], radius: 0.08 };
        // Over points of the axis, of which neighbours are at most 7 mm apart.
        let distance = |number: u32| {
            let (pose, figure) = &world.stage.space.fixed[number as usize];
            let mut least = f64::INFINITY;
            for step in 0..=500 {
                let point = capsule.ends[0].lerp(capsule.ends[1], f64::from(step) / 500.0);
                figure.for_each_nearest(pose, point, |nearest| least = least.min(nearest.distance(point)));
            }
            least
        };
        let things = world.touched(RobotId(1), &capsule, Time::ZERO);
        for number in 0..2 {
            let (distance, is_touched) = (distance(number), things.contains(&Seen::Fixed(number)));
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
fn the_ground_is_not_among_what_is_touched() {
    let slab = Arc::new(Figure { solids: vec![prism()], surface: Surface::default() });
    let pose = Pose::new(-2.0, -2.0, 0.3);
    let space = |floor| Space { floor, fixed: vec![(pose, Arc::clone(&slab))], ..Space::default() };
    let capsule = Capsule { ends: [DVec3::new(-1.9, -2.0, 0.3); 2], radius: 0.05 };
    let things = |floor| {
        let world = World::new(walls(), Time::from_millis(10), []).with_space(space(floor));
        world.touched(RobotId(1), &capsule, Time::ZERO)
    };
    assert_eq!(things(Some(Surface::SMOOTH)), [Seen::Fixed(0)]);
    assert_eq!(things(None), []);
}
