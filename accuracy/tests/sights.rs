//! Rays in space, compared with brute force and in degenerate cases.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

use accuracy::oracle::{Body, nearest_body};
use accuracy::world::Random;
use glam::{DVec2, DVec3};
use sim_core::{
    ObjectId, RobotId,
    contact::Thing,
    math,
    object::{Figure, Properties, Resistance, Shape, Solid},
    pose::Pose,
    scene::{Segment, Surface, WallId, Walls},
    time::Time,
    world::{HitSurface, Ray, RayHit, Space, ThickWall, World},
};

const ROBOT: RobotId = RobotId(1);

fn world(walls: Walls, space: Space) -> World {
    World::new(Arc::new(walls), Time::from_millis(50), std::iter::empty()).with_space(space)
}

fn look(world: &World, origin: [f64; 3], direction: [f64; 3]) -> Option<RayHit> {
    world.cast(ROBOT, &Ray::new(DVec3::from(origin), DVec3::from(direction).normalize_or_zero(), 9.0), Time::ZERO)
}

fn normal_of(hit: &RayHit) -> DVec3 {
    hit.face.expect("a ray in space meets faces").normal
}

/// Random body, for the oracle and as a fixed body of the world.
fn body(random: &mut Random, room: DVec3, corner: DVec3) -> (Body, (Pose, Arc<Figure>)) {
    let mut point =
        || DVec3::new(random.between(0.0, room.x), random.between(0.0, room.y), random.between(0.0, room.z));
    let (centre, other) = (corner + point(), corner + point());
    let (turn, radius, half) = (random.between(-PI, PI), random.between(0.05, 0.5), random.between(0.05, 0.5));
    let pose = Pose { position: centre.truncate(), ..Pose::new(0.0, 0.0, turn) };
    let prism = |footprint, half: f64| {
        let (bottom, top) = (centre.z - half, centre.z + half);
        Solid::Prism { footprint, body_from_footprint: Pose::default(), bottom, top }
    };
    let (body, solid) = match random.below(4) {
        0 => {
            let half = DVec3::new(radius, half, random.between(0.05, 0.5));
            (Body::Box { centre, half, turn }, prism(Shape::Rectangle { half: half.truncate() }, half.z))
        }
        1 => (Body::Cylinder { centre, radius, half }, prism(Shape::Disc { radius }, half)),
        kind => {
            let ends = if kind == 2 { [centre; 2] } else { [centre, centre.lerp(other, 0.2)] };
            let local = ends.map(|end| pose.inverse_transform_point(end.truncate()).extend(end.z));
            (Body::Capsule { ends, radius }, Solid::Capsule { ends: local, radius })
        }
    };
    (body, (pose, Arc::new(Figure { solids: vec![solid], surface: Surface::default() })))
}

#[test]
fn rays_hit_the_same_bodies_as_brute_force() {
    let mut random = Random::new(20);
    let room = DVec3::new(8.0, 6.0, 3.0);
    let (mut hits, mut misses) = (0, 0);
    for scene in 0..20 {
        let corner = if scene % 2 == 0 { DVec3::Z } else { DVec3::new(1e4, -1e4, 1.0) };
        let (bodies, fixed): (Vec<_>, Vec<_>) = (0..60).map(|_| body(&mut random, room, corner)).unzip();
        let world = world(Walls::new(Vec::new()), Space { fixed, ..Space::default() });
        for _ in 0..500 {
            let origin =
                corner + DVec3::new(random.between(-1.0, 9.0), random.between(-1.0, 7.0), random.between(0.0, 3.0));
            let direction = random.direction_in_space();
            let found = world
                .cast(ROBOT, &Ray::new(origin, direction, 4.0), Time::ZERO)
                .filter(|hit| hit.thing != Thing::Floor);
            match nearest_body(&bodies, origin, direction, 4.0, 1e-11) {
                Some((metres, index)) => match found {
                    Some(RayHit { distance, thing, face: Some(HitSurface { normal, .. }) }) => {
                        // Brute force stops 10 pm in front of the body, measured along the normal.
                        let tolerance = 1e-9 + 2e-11 / normal.dot(direction).abs();
                        assert!((distance - metres).abs() < tolerance, "{distance} instead of {metres}");
                        assert!(thing == Thing::Fixed(index as u32) || distance == 0.0, "{scene}: {thing:?}");
                        hits += 1;
                    }
                    _ => {
                        let point = origin + direction * metres;
                        assert!(metres > 4.0 - 1e-9 || point.z < 1e-9, "missed at {metres} m: {:?}", bodies[index]);
                    }
                },
                None => {
                    assert_eq!(found, None);
                    misses += 1;
                }
            }
        }
    }
    assert!(hits > 2000 && misses > 2000, "{hits} {misses}");
}

#[test]
fn normals_match_the_distance_and_point_against_the_ray() {
    let mut random = Random::new(21);
    let room = DVec3::new(4.0, 4.0, 2.0);
    for _ in 0..2000 {
        let (body, fixed) = body(&mut random, room, DVec3::ZERO);
        let world = world(Walls::new(Vec::new()), Space { fixed: vec![fixed], ..Space::default() });
        let origin = DVec3::new(random.between(-1.0, 5.0), random.between(-1.0, 5.0), random.between(0.0, 3.0));
        let direction = random.direction_in_space();
        let Some(hit) = world.cast(ROBOT, &Ray::new(origin, direction, 9.0), Time::ZERO) else { continue };
        let normal = normal_of(&hit);
        assert!((normal.length() - 1.0).abs() < 1e-12 && normal.dot(direction) <= 1e-12, "{hit:?}");
        if hit.distance == 0.0 || hit.thing == Thing::Floor {
            assert_eq!(normal, if hit.distance == 0.0 { -direction } else { DVec3::Z });
            continue;
        }
        // A displacement along the normal increases the distance from the body by the length of the displacement.
        let outside = origin + direction * hit.distance + 1e-3 * normal;
        assert!((body.distance(outside) - 1e-3).abs() < 1e-9, "{body:?} {hit:?}");
    }
}

/// World with a wall from (2, -1) to (2, 1), 1 m high, and a thick wall around (5, 0): 0.4 m thick, 2 m long, 0.5 m
/// high.
fn two_walls() -> World {
    let thin = Segment::new(DVec2::new(2.0, -1.0), DVec2::new(2.0, 1.0));
    let line = Segment::new(DVec2::new(5.0, -1.0), DVec2::new(5.0, 1.0));
    let mut segments = vec![thin];
    segments.extend(line.thickened(0.4));
    let walls = Walls::new(segments).with_heights(vec![1.0, 0.5, 0.5, 0.5, 0.5]);
    world(walls, Space { thick_walls: vec![ThickWall::new(WallId(1), &line, 0.4, 0.5)], ..Space::default() })
}

#[test]
fn walls_have_heights_and_thick_walls_have_tops() {
    let world = two_walls();
    let hit_of =
        |origin, direction| look(&world, origin, direction).map(|hit| (hit.thing, hit.distance, normal_of(&hit)));
    assert_eq!(hit_of([0.0, 0.0, 0.5], [1.0, 0.0, 0.0]), Some((Thing::Wall(WallId(0)), 2.0, DVec3::NEG_X)));
    assert_eq!(hit_of([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), Some((Thing::Wall(WallId(0)), 2.0, DVec3::NEG_X)), "the edge");
    assert_eq!(hit_of([0.0, 0.0, 1.0 + 1e-12], [1.0, 0.0, 0.0]), None, "both are lower");
    assert_eq!(hit_of([4.0, 0.0, 0.5], [-1.0, 0.0, 0.0]), Some((Thing::Wall(WallId(0)), 2.0, DVec3::X)), "from behind");
    // Downward rays hit the top of the thick wall, and the floor beside it.
    let (thing, distance, normal) = hit_of([5.1, 0.9, 2.0], [0.0, 0.0, -1.0]).unwrap();
    assert_eq!((distance, normal), (1.5, DVec3::Z));
    assert!(matches!(thing, Thing::Wall(WallId(1..=4))));
    assert_eq!(hit_of([5.3, 0.9, 2.0], [0.0, 0.0, -1.0]), Some((Thing::Floor, 2.0, DVec3::Z)));
    assert_eq!(hit_of([5.1, 0.9, 2.0], [0.0, 0.0, 1.0]), None);
    // Rays that fall by 1 in 2 hit the top of the thick wall, and the floor in front of the thin wall.
    let (_, distance, normal) = hit_of([3.0, 0.0, 1.5], [2.0, 0.0, -1.0]).unwrap();
    assert!((distance - 5.0_f64.sqrt()).abs() < 1e-15 && normal == DVec3::Z);
    let (thing, distance, _) = hit_of([1.0, 0.0, 0.25], [2.0, 0.0, -1.0]).unwrap();
    assert!((distance - (0.5_f64 * 0.5 + 0.25 * 0.25).sqrt()).abs() < 1e-15 && thing == Thing::Floor);
}

#[test]
fn rays_at_the_edge_of_a_thick_wall_do_not_enter_it() {
    let world = two_walls();
    for step in 0..=1000 {
        let step = f64::from(step) * 1e-3;
        // The rays come from above, at many angles, and aim at the two upper edges on the near sides.
        for edge in [DVec3::new(4.8, -1.0 + 2.0 * step, 0.5), DVec3::new(4.8 + 0.4 * step, -1.0, 0.5)] {
            let origin = DVec3::new(4.0 + 0.5 * step, -1.5, 0.7 + step);
            let direction = (edge - origin).normalize_or_zero();
            let hit = world.cast(ROBOT, &Ray::new(origin, direction, 9.0), Time::ZERO).expect("edge or floor");
            let is_at_edge = (hit.distance - (edge - origin).length()).abs() < 1e-12;
            let is_corner = step == 0.0 || step == 1.0;
            assert!(is_at_edge || is_corner && hit.thing == Thing::Floor, "{step}: {hit:?}");
            if is_corner {
                continue;
            }
            let inward = (edge + DVec3::new(1e-9, 1e-9, -1e-9) - origin).normalize_or_zero();
            let hit = world.cast(ROBOT, &Ray::new(origin, inward, 9.0), Time::ZERO).expect("the edge");
            assert!(matches!(hit.thing, Thing::Wall(_)) && (hit.distance - (edge - origin).length()).abs() < 1e-8);
        }
    }
}

#[test]
fn rays_from_and_along_surfaces_and_into_corners() {
    let side = Shape::Rectangle { half: DVec2::splat(0.5) };
    let cube = Solid::Prism { footprint: side, body_from_footprint: Pose::default(), bottom: 0.0, top: 1.0 };
    let ball = Solid::Capsule { ends: [DVec3::new(0.0, 5.0, 0.5); 2], radius: 0.5 };
    let figure = |solid| Arc::new(Figure { solids: vec![solid], surface: Surface::default() });
    let fixed = vec![(Pose::default(), figure(cube)), (Pose::default(), figure(ball))];
    let corner = [[9.0, 9.0, 9.0, 3.0], [9.0, 9.0, 3.0, 9.0]];
    let corner = corner.map(|[ax, ay, bx, by]| Segment::new(DVec2::new(ax, ay), DVec2::new(bx, by)));
    let world = world(Walls::new(corner.to_vec()), Space { fixed, ..Space::default() });
    let distance = |origin, direction| look(&world, origin, direction).map(|hit| hit.distance);
    // Rays that begin on a face or inside a body read 0 in any direction.
    for direction in [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.3, 0.2, -0.1]] {
        for origin in [[0.5, 0.0, 0.5], [0.0, 0.0, 1.0], [0.1, 0.2, 0.3], [0.0, 5.0, 0.5], [0.0, 5.0, 1.0]] {
            assert_eq!(distance(origin, direction), Some(0.0), "{origin:?} {direction:?}");
        }
    }
    // A ray along the top face hits its edge; a slightly higher ray hits nothing.
    assert_eq!(distance([-2.0, 0.0, 1.0], [1.0, 0.0, 0.0]), Some(1.5));
    assert_eq!(distance([-2.0, 0.0, 1.0 + 1e-12], [1.0, 0.0, 0.0]), None);
    // A downward ray along a side hits the upper edge; beside the body, it hits the floor.
    assert_eq!(distance([0.5, 0.0, 3.0], [0.0, 0.0, -1.0]), Some(2.0), "its upper edge");
    assert_eq!(distance([0.5 + 1e-12, 0.0, 3.0], [0.0, 0.0, -1.0]), Some(3.0));
    // Rays that graze the top of the ball.
    assert!((distance([-2.0, 5.0, 1.0], [1.0, 0.0, 0.0]).unwrap() - 2.0).abs() < 1e-7);
    assert_eq!(distance([-2.0, 5.0, 1.0 + 1e-9], [1.0, 0.0, 0.0]), None);
    // A ray into the corner of two walls and the floor.
    let depth = 3.0_f64.sqrt();
    let hit = look(&world, [8.0, 8.0, 1.0], [1.0, 1.0, -1.0]).unwrap();
    assert!((hit.distance - depth).abs() < 1e-15, "{hit:?}");
    // Rays that begin on a wall, and on the floor.
    assert_eq!(distance([9.0, 5.0, 0.5], [0.0, -1.0, 0.3]), Some(0.0));
    assert_eq!(distance([9.0, 5.0, 0.5], [0.0, 0.0, 1.0]), Some(0.0), "straight up along a wall");
    assert_eq!(distance([7.0, 5.0, 0.0], [0.0, -1.0, -0.3]), Some(0.0));
    assert_eq!(distance([7.0, 7.0, 0.0], [1.0, 0.0, 0.0]), Some(2.0), "the floor is not in the way of a level ray");
    assert_eq!(distance([7.0, 7.0, 0.0], [0.0, 0.0, 1.0]), None);
}

#[test]
fn invalid_rays_hit_nothing() {
    let world = two_walls();
    let cast = |origin, direction, range| world.cast(ROBOT, &Ray::new(origin, direction, range), Time::ZERO);
    let origin = DVec3::new(0.0, 0.0, 0.5);
    assert!(cast(origin, DVec3::X, 2.0).is_some(), "the range is closed");
    assert!(cast(origin, DVec3::X, 2.0 - 1e-12).is_none());
    assert!(cast(origin, DVec3::NEG_Z, 0.5).is_some() && cast(origin, DVec3::NEG_Z, 0.5 - 1e-12).is_none());
    for (origin, direction, range) in [
        (DVec3::NAN, DVec3::X, 9.0),
        (DVec3::INFINITY, DVec3::X, 9.0),
        (origin, DVec3::NAN, 9.0),
        (origin, DVec3::ZERO, 9.0),
        (origin, DVec3::X * 2.0, 9.0),
        (origin, DVec3::X, f64::NAN),
        (origin, DVec3::X, -1.0),
    ] {
        assert_eq!(cast(origin, direction, range), None);
    }
    assert!(cast(origin, DVec3::X, f64::INFINITY).is_some() && cast(origin, DVec3::NEG_Z, f64::INFINITY).is_some());
    assert!(cast(origin, DVec3::Z, f64::INFINITY).is_none() && cast(origin, DVec3::NEG_X, f64::INFINITY).is_none());
}

#[test]
fn nearly_vertical_rays_are_exact() {
    let world = two_walls();
    for exponent in 0..320 {
        let horizontal = math::exp(-f64::from(exponent) * std::f64::consts::LN_10);
        let hit = look(&world, [1.0, 0.0, 0.5], [horizontal, 0.0, -1.0]).expect("the floor");
        let expected: f64 = 0.5 * math::hypot(1.0, horizontal);
        assert!(hit.thing == Thing::Floor && (hit.distance - expected).abs() < 1e-15, "{horizontal}: {hit:?}");
        assert_eq!(look(&world, [1.0, 0.0, 0.5], [horizontal * 1e-3, 0.0, 1.0]), None, "over the wall: {horizontal}");
    }
}

#[test]
fn objects_have_heights() {
    let ball = Figure {
        solids: vec![Solid::Capsule { ends: [DVec3::new(0.0, 0.0, 0.1); 2], radius: 0.1 }],
        surface: Surface::SMOOTH,
    };
    let properties = Arc::new(Properties {
        mass: 1.0,
        centre_of_mass: DVec2::ZERO,
        parts: vec![sim_core::object::Part { shape: Shape::Disc { radius: 0.1 }, object_from_part: Pose::default() }],
        resistance: Resistance::Sliding(0.4),
        restitution: 0.3,
        contact_friction: 0.3,
        lift: 0.0,
    });
    let bare = world(Walls::new(Vec::new()), Space::default()).with_objects([(properties, Pose::new(2.0, 0.0, 1.0))]);
    assert_eq!(look(&bare, [0.0, 0.0, 7.0], [1.0, 0.0, 0.0]).unwrap().distance, 1.9, "a footprint has no end above");
    let world = bare.with_space(Space { objects: vec![Arc::new(ball)], ..Space::default() });
    assert_eq!(look(&world, [0.0, 0.0, 0.3], [1.0, 0.0, 0.0]), None);
    let hit = look(&world, [0.0, 0.0, 0.1], [1.0, 0.0, 0.0]).unwrap();
    let face = hit.face.expect("a face");
    assert_eq!((hit.distance, hit.thing, face.surface), (1.9, Thing::Object(ObjectId(1)), Surface::SMOOTH));
    assert_eq!(face.curvature, DVec2::splat(10.0));
    // At three quarters of the ball's height the distance is larger.
    let hit = look(&world, [0.0, 0.0, 0.15], [1.0, 0.0, 0.0]).unwrap();
    assert!((hit.distance - (2.0 - 0.75_f64.sqrt() * 0.1)).abs() < 1e-15);
    assert_eq!(look(&world, [2.0, 0.0, 1.0], [0.0, 0.0, -1.0]).map(|hit| hit.distance), Some(0.8));
}

#[test]
fn rays_around_a_cylinder_have_equal_distances() {
    let fixed = vec![(Pose::new(3.0, 4.0, 0.3), Arc::new(Figure::cylinder(0.25, 1.0, Surface::default())))];
    let world = world(Walls::new(Vec::new()), Space { fixed, ..Space::default() });
    for step in 0..100 {
        let (sin, cos) = math::sin_cos(f64::from(step) * TAU / 100.0);
        let (sin_up, cos_up) = math::sin_cos(f64::from(step % 7 - 3) * 0.1 * FRAC_PI_2);
        let outward = DVec3::new(cos * cos_up, sin * cos_up, sin_up);
        let target = DVec3::new(3.0 + 0.25 * cos, 4.0 + 0.25 * sin, 0.5);
        let hit = world.cast(ROBOT, &Ray::new(target + outward, -outward, 3.0), Time::ZERO).expect("the cylinder");
        assert!((hit.distance - 1.0).abs() < 1e-14 && (normal_of(&hit) - DVec3::new(cos, sin, 0.0)).length() < 1e-14);
    }
}
