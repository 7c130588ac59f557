use glam::DVec2;

use super::region::{DistanceBetween, DistanceToSegment, Negated, intervals_in};
use super::section::{MotionSection, Smooth, find_minimum, find_zeros, push, take_until};
use crate::contact::{LengthLaw, Pace, Path};
use crate::math;
use crate::pose::{Pose, Twist};
use crate::scene::Segment;
use crate::spec::Region;

fn section(x: f64, y: f64, phi: f64, (v, omega): (f64, f64), to: f64) -> MotionSection {
    MotionSection::on_path(Path::new(&Pose::new(x, y, phi), Twist::new(v, omega)), 0.0, (0.0, to))
}

fn disc(x: f64, y: f64, radius: f64) -> Region {
    Region::Disc { centre: DVec2::new(x, y), radius }
}

/// The intervals inside a place, as pairs of instants.
fn inside(section: &MotionSection, region: &Region) -> Vec<(f64, f64)> {
    intervals_in(section, region).into_iter().filter(|(.., inside)| *inside).map(|(from, to, _)| (from, to)).collect()
}

#[test]
fn straight_path_is_inside_a_disc_along_the_chord() {
    // The path y = 0.3 crosses a disc of radius 0.5 around (2, 0); half of the chord is 0.4 m long.
    let found = inside(&section(0.0, 0.3, 0.0, (0.2, 0.0), 20.0), &disc(2.0, 0.0, 0.5));
    let [(from, to)] = found[..] else { panic!("{found:?}") };
    assert!((from - 8.0).abs() < 1e-7 && (to - 12.0).abs() < 1e-7, "{from} {to}: within the rounding of 1 nm");
}

#[test]
fn path_reaches_a_disc_if_it_touches_the_circle() {
    for (offset, reaches) in [(0.0, true), (-1e-6, true), (1e-6, false), (1e-3, false)] {
        let path = section(0.0, 1.1 + offset, 0.0, (0.3, 0.0), 10.0);
        assert_eq!(!inside(&path, &disc(1.5, 1.0, 0.1)).is_empty(), reaches, "path {offset} m outside the circle");
    }
}

#[test]
fn circular_path_along_the_border_is_inside_a_disc() {
    // Radius 0.5 around (0, 0), from its rightmost point.
    let path = section(0.5, 0.0, 0.5 * std::f64::consts::PI, (0.25, 0.5), 0.1);
    let found = intervals_in(&path, &disc(0.0, 0.0, 0.5));
    assert_eq!(found, [(0.0, 0.1, true)]);
}

#[test]
fn intervals_inside_a_polygon_match_samples() {
    let corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 0.4), (0.0, 1.0)].map(DVec2::from);
    let region = Region::Polygon(corners.to_vec());
    for turn in 0..40 {
        let path = section(0.2, -0.4, 0.15 * f64::from(turn), (0.4, 0.13 * f64::from(turn % 7 - 3)), 12.0);
        let found = intervals_in(&path, &region);
        assert_eq!((found[0].0, found[found.len() - 1].1), (0.0, 12.0), "the section is covered");
        for sample in 1..1200 {
            let t = 0.01 * f64::from(sample);
            let (from, to, is_inside) =
                *found.iter().find(|(from, to, _)| (*from..=*to).contains(&t)).expect("covered");
            if (t - from).min(to - t) > 1e-6 {
                assert_eq!(is_inside, super::region::is_within(&corners, path.position(t)), "turn {turn} at {t} s");
            }
        }
    }
}

#[test]
fn path_along_an_edge_is_inside_the_polygon() {
    let square = Region::Polygon([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(DVec2::from).to_vec());
    assert_eq!(intervals_in(&section(0.1, 1.0, 0.0, (0.1, 0.0), 5.0), &square), [(0.0, 5.0, true)]);
    let found = intervals_in(&section(0.5, 0.5, 0.0, (0.1, 0.0), 10.0), &square);
    assert!((found[0].1 - 5.0).abs() < 1e-7 && found.len() == 2, "{found:?}");
}

#[test]
fn all_zeros_of_the_distance_between_circling_bodies_are_found() {
    let a = section(0.0, 0.0, 0.0, (0.5, 1.0), 30.0);
    let b = section(0.9, 0.3, 2.0, (0.4, -0.7), 30.0);
    let distance = DistanceBetween { sections: [&a, &b], squared_reference: 1.0 };
    let mut zeros = Vec::new();
    find_zeros(&distance, 0.0, 30.0, &mut zeros);
    let sampled = (0..300_000).filter(|i| {
        let t = 1e-4 * f64::from(*i);
        (distance.at(t).0 < 0.0) != (distance.at(t + 1e-4).0 < 0.0)
    });
    assert_eq!(zeros.len(), sampled.count());
    assert!(zeros.len() > 6 && zeros.windows(2).all(|pair| pair[0] < pair[1]), "{zeros:?}");
    assert!(zeros.iter().all(|t| distance.at(*t).0.abs() < 1e-12));
}

#[test]
fn curvature_bounds_exceed_second_differences() {
    let law = LengthLaw::Round { radius: 0.1, speed: 0.3, phase: 0.4, rate: 0.9, sense: 1.0 };
    let round = Path {
        pace: Pace::Sliding { omega: 0.9, law },
        ..Path::new(&Pose::new(0.3, 0.1, 1.0), Twist { vx: 1.0, vy: 0.0, omega: -10.0 })
    };
    let sliding = MotionSection::on_path(round, 0.0, (0.0, 2.0));
    let turning = section(0.0, 0.0, 0.3, (0.5, 2.0), 2.0);
    for section in [sliding, turning] {
        let wall = DistanceToSegment {
            section: &section,
            segment: Segment::new(DVec2::new(1.0, -1.0), DVec2::new(1.0, 0.2)),
            squared_reference: 0.01,
        };
        for step in 1..199 {
            let (t, h) = (0.01 * f64::from(step), 1e-4);
            let (slope, next) = (wall.at(t - h).1, wall.at(t + h).1);
            let second = ((next - slope) / (2.0 * h)).abs();
            assert!(second <= wall.curvature_bound(t, 2.0 * h) + 1e-6, "{second} at {t} s");
        }
    }
}

#[test]
fn extremal_distances_match_plane_geometry() {
    let path = section(0.0, 0.3, 0.0, (0.2, 0.0), 20.0);
    let point = Segment::new(DVec2::new(2.0, 0.0), DVec2::new(2.0, 0.0));
    let (mut minimum, mut maximum) = ((f64::INFINITY, 0.0), (0.0, 0.0));
    let distance = || DistanceToSegment { section: &path, segment: point, squared_reference: 0.0 };
    find_minimum(&distance(), (0.0, 20.0), &mut minimum, 1e-12);
    find_minimum(&Negated(distance()), (0.0, 20.0), &mut maximum, 1e-12);
    assert!((minimum.0 - 0.09).abs() < 1e-9 && (minimum.1 - 10.0).abs() < 1e-3, "{minimum:?}");
    assert!((maximum.0 + 4.09).abs() < 1e-9, "{maximum:?}");
}

#[test]
fn sections_are_independent_of_slot_length() {
    let path = section(0.0, 0.0, 0.0, (0.2, 0.3), 1.0);
    let observe_in_slots = |slot: f64| {
        let mut sections = Vec::new();
        let mut from = 0.0;
        for slot in (1..).map(|n| f64::from(n) * slot).take_while(|end| *end <= 1.0) {
            push(&mut sections, path.part(from, slot));
            from = slot;
        }
        sections
    };
    assert_eq!(observe_in_slots(0.125), [path]);
    assert_eq!(observe_in_slots(0.5), observe_in_slots(0.0625));
    let (mut remaining, middle) = (observe_in_slots(0.25), 0.3);
    assert_eq!(take_until(&mut remaining, middle), [path.part(0.0, middle)]);
    assert_eq!(remaining, [path.part(middle, 1.0)]);
    assert_eq!(math::hypot(remaining[0].position(0.5).x, 0.0), path.position(0.5).x, "the path keeps its origin");
}
