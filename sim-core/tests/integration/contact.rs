//! Contact with walls: against a brute-force oracle, and in numerically difficult cases.

use std::f64::consts::{PI, TAU};

use accuracy::{oracle, world::Random};
use glam::DVec2;
use sim_core::{
    contact::{MovingDisc, Path, SKIN, TOUCH, first_contact, first_touch},
    pose::{Pose, Twist},
    scene::{Bounds, Segment},
};

/// The earliest contact with any of `walls` within `duration` seconds.
fn contact(walls: &[Segment], start: Pose, twist: Twist, radius: f64, duration: f64) -> Option<f64> {
    let path = Path::new(&start, twist);
    walls.iter().filter_map(|wall| first_contact(&path, radius, wall, duration)).map(|hit| hit.seconds).reduce(f64::min)
}

#[test]
fn first_contact_matches_brute_force() {
    let mut random = Random::new(7);
    let bounds = Bounds { min: DVec2::splat(-2.0), max: DVec2::splat(2.0) };
    let (mut contacts, mut free) = (0, 0);
    for _ in 0..20_000 {
        let count = 1 + random.below(4);
        let walls: Vec<_> =
            (0..count).map(|_| Segment::new(random.point_in(bounds), random.point_in(bounds))).collect();
        let position = random.point_in(bounds);
        let start = Pose { position, ..Pose::new(0.0, 0.0, random.between(-PI, PI)) };
        let radius = random.between(0.01, 0.3);
        // Discs that touch a wall at the start are skipped, because other rules apply to them.
        if oracle::clearance(&walls, position, radius) < 1e-5 {
            continue;
        }
        let omega = if random.chance(0.3) { 0.0 } else { random.between(-6.0, 6.0) };
        let sideways = if random.chance(0.5) { 0.0 } else { random.between(-1.0, 1.0) };
        let twist = Twist { vx: random.between(-1.0, 1.0), vy: sideways, omega };
        let horizon = random.between(0.1, 5.0);
        // Contact occurs at the skin, outside the disc.
        let expected = oracle::first_contact(&walls, start, twist, radius + SKIN, horizon);
        let found = contact(&walls, start, twist, radius, horizon);
        let gap = |seconds: f64| oracle::clearance(&walls, start.moved(twist.scaled(seconds)).position, radius);
        match (found, expected) {
            (Some(found), Some(expected)) => {
                contacts += 1;
                // For a grazing disc the gap at the instant of contact is a sharper test than the instant itself.
                assert!((gap(found) - SKIN).abs() < 1e-12, "gap {} at {found}", gap(found));
                assert!((found - expected).abs() < 1e-5, "{found} instead of {expected}");
            }
            (Some(found), None) => assert!((gap(found) - SKIN).abs() < 1e-12, "no contact at {found}"),
            (None, Some(expected)) => {
                panic!("missed the contact at {expected}: {start:?} {twist:?} {radius} {walls:?}")
            }
            (None, None) => free += 1,
        }
    }
    assert!(contacts > 2_000 && free > 2_000, "{contacts} contacts, {free} free: too few for a test");
}

#[test]
fn arc_meets_the_wall_at_the_closed_form_for_every_turning_speed() {
    // A wall across the path at 1 m. The arc of radius v / omega reaches the wall, or misses it if the radius is too
    // small.
    let wall = Segment::new(DVec2::new(1.0, -1e3), DVec2::new(1.0, 1e3));
    let (v, radius) = (0.5, 0.1);
    for exponent in -300..=4 {
        let omega = 10.0_f64.powi(exponent);
        for omega in [omega, -omega] {
            let twist = Twist::new(v, omega);
            let found = contact(&[wall], Pose::default(), twist, radius, f64::INFINITY);
            let sine = (1.0 - radius - SKIN) * omega.abs() / v;
            if sine >= 1.0 {
                assert_eq!(found, None, "omega {omega}");
                continue;
            }
            let expected = if sine < 1e-4 { sine * (1.0 + sine * sine / 6.0) } else { libm::asin(sine) } / omega.abs();
            let found = found.unwrap_or_else(|| panic!("no contact at omega {omega}"));
            assert!((found - expected).abs() < 1e-11, "{found} instead of {expected} at omega {omega}");
        }
    }
}

#[test]
fn discs_never_tunnel_through_walls() {
    let wall = Segment::new(DVec2::new(1e3, -1.0), DVec2::new(1e3, 1.0));
    for speed in [1e-3, 1.0, 1e2, 1e6, 1e12] {
        let found = contact(&[wall], Pose::default(), Twist::new(speed, 0.0), 0.05, f64::INFINITY);
        let distance = found.expect("a contact") * speed;
        assert!((distance - (1e3 - 0.05 - SKIN)).abs() < 1e-12 * 1e3, "within rounding: {distance}");
    }
    // A post: a central hit, a grazing hit and a near miss.
    let post = Segment::new(DVec2::new(2.0, 0.0), DVec2::new(2.0, 0.0));
    for (offset, meets) in [(0.0, true), (0.1 - 1e-9, true), (0.1 + SKIN - 1e-9, true), (0.1 + SKIN + 1e-9, false)] {
        let start = Pose::new(0.0, offset, 0.0);
        assert_eq!(contact(&[post], start, Twist::new(100.0, 0.0), 0.1, 1.0).is_some(), meets, "{offset}");
    }
}

#[test]
fn circle_beside_a_wall_detects_grazing_contact() {
    // Circle of radius 1 around (0, 1): its lowest point, where the path starts, is 1 m above a wall at y = -1.
    for (y, meets) in [(3.1 + 1e-9 + SKIN, false), (3.1 - 1e-9 + SKIN, true), (2.5, true)] {
        let wall = Segment::new(DVec2::new(-5.0, y - 1.0), DVec2::new(5.0, y - 1.0));
        let found = contact(&[wall], Pose::default(), Twist::new(0.5, 0.5), 0.1, f64::INFINITY);
        assert_eq!(found.is_some(), meets, "wall at {}", y - 1.0);
        assert!(found.is_none_or(|after| after < TAU / 0.5));
    }
}

#[test]
fn disc_in_contact_is_stopped_only_if_it_approaches() {
    let wall = Segment::new(DVec2::new(-5.0, 0.0), DVec2::new(5.0, 0.0));
    let radius = 0.1;
    for gap in [SKIN, 0.5 * (SKIN + TOUCH), 0.5 * SKIN, 0.0, -0.03] {
        for turn in 0..8 {
            let heading = f64::from(turn) * PI / 4.0;
            let start = Pose::new(0.3, radius + gap, heading);
            let found = contact(&[wall], start, Twist::new(0.2, 0.0), radius, 1.0);
            // Headings of 5, 6 and 7 eighths of a turn point into the wall.
            assert_eq!(found, (5..8).contains(&turn).then_some(0.0), "gap {gap}, heading {heading}");
            assert_eq!(
                contact(&[wall], start, Twist::new(-0.2, 0.0), radius, 1.0),
                (1..4).contains(&turn).then_some(0.0)
            );
        }
        assert_eq!(contact(&[wall], Pose::new(0.0, radius + gap, 0.3), Twist::new(0.0, 5.0), radius, 9.0), None);
        // Away on an arc that returns to the wall at the end of the turn.
        let leaving = contact(&[wall], Pose::new(0.0, radius + gap, 0.0), Twist::new(0.2, 1.0), radius, f64::INFINITY);
        assert!(leaving.is_none_or(|after| after > 0.9 * TAU), "gap {gap}: {leaving:?}");
        let into = contact(&[wall], Pose::new(0.0, radius + gap, 0.0), Twist::new(0.2, -1.0), radius, f64::INFINITY);
        assert_eq!(into, Some(0.0), "gap {gap}");
    }
}

#[test]
fn heading_rounding_does_not_stop_a_drive_along_a_wall() {
    let (sin, cos) = (libm::sin(0.7), libm::cos(0.7));
    let along = DVec2::new(cos, sin);
    let wall = Segment::new(along * -100.0, along * 100.0);
    for error in [-1e-13, -1e-16, 0.0, 1e-16, 1e-13] {
        let start = Pose { position: along.perp() * (0.1 + SKIN), ..Pose::new(0.0, 0.0, 0.7 + error) };
        assert_eq!(contact(&[wall], start, Twist::new(0.5, 0.0), 0.1, f64::INFINITY), None, "error {error}");
    }
    let start = Pose { position: along.perp() * (0.1 + SKIN), ..Pose::new(0.0, 0.0, 0.7 - 1e-6) };
    assert_eq!(contact(&[wall], start, Twist::new(0.5, 0.0), 0.1, f64::INFINITY), Some(0.0));
}

#[test]
fn centre_on_a_wall_may_leave_it_but_not_cross_it() {
    let wall = Segment::new(DVec2::new(-1.0, 0.0), DVec2::new(1.0, 0.0));
    let crossing = contact(&[wall], Pose::new(0.0, -0.01, PI / 2.0), Twist::new(0.1, 0.0), 0.1, 1.0);
    assert_eq!(crossing, Some(0.0));
    assert_eq!(contact(&[wall], Pose::new(0.0, -0.01, -PI / 2.0), Twist::new(0.1, 0.0), 0.1, 1.0), None);
    // From the line itself, the disc can leave to either side.
    assert_eq!(contact(&[wall], Pose::new(0.0, 0.0, PI / 2.0), Twist::new(0.1, 0.0), 0.1, 1.0), None);
}

#[test]
fn extreme_numbers_give_valid_results() {
    let wall = Segment::new(DVec2::new(1.0, -1.0), DVec2::new(1.0, 1.0));
    let twists = [1e-300, 5e-324, 1e-9, 1e12, f64::MAX];
    for v in twists {
        for omega in [0.0, 5e-324, 1e-300, 1e4, 1e12, f64::MAX] {
            for v in [v, -v] {
                let found = contact(&[wall], Pose::default(), Twist::new(v, omega), 0.1, f64::INFINITY);
                assert!(found.is_none_or(|after| after >= 0.0), "{found:?} at {v} m/s, {omega} rad/s");
            }
        }
    }
}

#[test]
fn first_touch_of_moving_discs_matches_sampling() {
    let mut random = Random::new(11);
    let bounds = Bounds { min: DVec2::splat(-1.0), max: DVec2::splat(1.0) };
    let span = 2.0;
    let mut contacts = 0;
    for case in 0..3_000 {
        let mut disc = || {
            let pose = Pose { position: random.point_in(bounds), ..Pose::new(0.0, 0.0, random.between(-PI, PI)) };
            let omega = if random.chance(0.3) { 0.0 } else { random.between(-8.0, 8.0) };
            let twist = Twist { vx: random.between(-1.0, 1.0), vy: random.between(-0.3, 0.3), omega };
            let path = if random.chance(0.1) { Path::resting(pose.position) } else { Path::new(&pose, twist) };
            MovingDisc { path, elapsed: random.between(0.0, 1.0), radius: random.between(0.02, 0.3) }
        };
        let (a, b) = (disc(), disc());
        let gap = |t: f64| {
            let offset = a.path.position(a.elapsed + t) - b.path.position(b.elapsed + t);
            offset.length() - a.radius - b.radius
        };
        if gap(0.0) < 2.0 * SKIN {
            continue;
        }
        let sampled = (0..=4_000).map(|n| f64::from(n) * span / 4_000.0).find(|&t| gap(t) <= SKIN);
        match (first_touch(&a, &b, span), sampled) {
            (Some(found), Some(sampled)) => {
                contacts += 1;
                assert!(found <= sampled && sampled - found < span / 400.0, "case {case}: {found}, sampled {sampled}");
                assert!(gap(found) > SKIN - 1e-9 && gap(found) <= TOUCH, "case {case}: gap {}", gap(found));
            }
            // A grazing contact between two samples.
            (Some(found), None) => assert!(gap(found) > SKIN - 1e-9 && gap(found) <= TOUCH, "case {case}"),
            (None, Some(sampled)) => panic!("case {case}: missed the contact at {sampled}"),
            (None, None) => {}
        }
    }
    assert!(contacts > 150, "{contacts} contacts: too few for a test");
}
