//! Rays that leave one point in many directions: each wall is tried on the rays that may meet it, instead of each ray on
//! the walls in its way.

use std::ops::Range;

use glam::DVec2;

use super::super::grid::{is_ray, is_usable};
use super::ray::{Nearest, Ray};
use super::{Bounds, Hit, WallId, Walls};

/// Rays from one point: their directions, found by their angle.
#[derive(Clone, Debug, PartialEq)]
pub struct RayFan {
    directions: Vec<DVec2>,
    /// Places of the directions in the order of their angles.
    by_angle: Vec<u32>,
    /// By part of a turn the first place in that order; one more for the end.
    first: Vec<u32>,
}

/// Parts of a turn for each direction.
const PARTS: usize = 4;

/// Walls for each ray up to which trying them all costs less than following the rays one by one.
const WALLS_PER_RAY: usize = 4;

impl RayFan {
    /// A fan of these directions, vectors of length 1.
    ///
    /// # Panics
    /// If there are 2^28 directions or more.
    pub fn new(directions: Vec<DVec2>) -> Self {
        assert!(directions.len() < 1 << 28, "a fan has fewer than 2^28 rays");
        let turn_of = |ray: u32| turn(directions[ray as usize]);
        let mut by_angle: Vec<u32> = (0..directions.len() as u32).collect();
        by_angle.sort_by(|a, b| turn_of(*a).total_cmp(&turn_of(*b)));
        let parts = PARTS * directions.len().max(1);
        let mut first = vec![0; parts + 1];
        directions.iter().for_each(|direction| first[part(*direction, parts) + 1] += 1);
        (0..parts).for_each(|part| first[part + 1] += first[part]);
        Self { directions, by_angle, first }
    }

    /// The directions, in the order that the fan was given.
    pub fn directions(&self) -> &[DVec2] {
        &self.directions
    }

    /// Number of rays.
    pub fn len(&self) -> usize {
        self.directions.len()
    }

    /// Whether there is no ray.
    pub fn is_empty(&self) -> bool {
        self.directions.is_empty()
    }

    /// The rays between the directions of `a` and `b`, by angle, those next to them included: a part of a turn more on either side.
    fn between(&self, a: DVec2, b: DVec2) -> [Range<usize>; 2] {
        let (from, to) = if a.perp_dot(b) > 0.0 { (a, b) } else { (b, a) };
        let parts = self.first.len() - 1;
        let (from, to) = (part(from, parts), part(to, parts));
        let from = if from == 0 { parts - 1 } else { from - 1 };
        let to = if to + 1 == parts { 0 } else { to + 1 };
        let (start, end) = (self.first[from] as usize, self.first[to + 1] as usize);
        if from <= to { [start..end, 0..0] } else { [start..self.len(), 0..end] }
    }
}

impl Walls {
    /// The nearest wall along each ray of `fan`, whose x axis is turned to the unit vector `ahead`, in the order of its directions: to
    /// the bit what [`Walls::cast_where`] finds for the rays one by one.
    pub fn cast_fan(
        &self,
        origin: DVec2,
        ahead: DVec2,
        fan: &RayFan,
        range: f64,
        counts: impl Fn(WallId, f64) -> bool,
    ) -> Vec<Option<Hit>> {
        let direction = |ray: u32| ahead.rotate(fan.directions[ray as usize]);
        let is_inside = |bounds: &Bounds| bounds.grown(self.margin).contains(origin);
        let Some(bounds) = self.bounds.filter(is_inside).filter(|_| self.len() <= WALLS_PER_RAY * fan.len()) else {
            let one_by_one = 0..fan.len() as u32;
            return one_by_one.map(|ray| self.cast_where(origin, direction(ray), range, &counts)).collect();
        };
        let ray = |ray: &u32| self.ray(origin, direction(*ray), self.inside_doubt, bounds);
        let rays: Vec<Ray> = fan.by_angle.iter().map(ray).collect();
        let doubt_area = self.ray(origin, ahead, self.inside_doubt, bounds).doubt_area;
        let mut nearest = vec![Nearest::within(range); fan.len()];
        // Nearer ends may touch more rays than those beside them: half a part of a turn is at least 1 / (8 rays) rad.
        let near = self.inside_doubt * (8 * PARTS * fan.len()) as f64;
        for (wall, segment) in (0..).map(WallId).zip(&self.segments) {
            if !(is_usable(segment.a) && is_usable(segment.b)) {
                continue;
            }
            let seen = |end: DVec2| DVec2::new(ahead.dot(end - origin), ahead.perp_dot(end - origin));
            let (a, b) = (seen(segment.a), seen(segment.b));
            let is_near = a.length_squared().min(b.length_squared()) <= near * near;
            let is_in_line = a.perp_dot(b).abs() <= doubt_area;
            let places = if is_near || is_in_line { [0..fan.len(), 0..0] } else { fan.between(a, b) };
            for places in places {
                for (nearest, ray) in nearest[places.clone()].iter_mut().zip(&rays[places]) {
                    nearest.offer(wall, ray.distance(segment), &counts);
                }
            }
        }
        let mut hits = vec![None; fan.len()];
        for ((nearest, ray), place) in nearest.into_iter().zip(&rays).zip(&fan.by_angle) {
            hits[*place as usize] = nearest.hit().filter(|_| is_ray(origin, ray.direction, range));
        }
        hits
    }
}

/// How far a vector is turned from the x axis, from 0 to 4: grows with its angle, by a right angle for 1.
fn turn(vector: DVec2) -> f64 {
    let up = vector.y / (vector.x.abs() + vector.y.abs());
    match vector.x >= 0.0 {
        true if up >= 0.0 => up,
        true => 4.0 + up,
        false => 2.0 - up,
    }
}

/// The part of a turn, out of `parts`, in which a vector lies.
fn part(vector: DVec2, parts: usize) -> usize {
    // What is no number is 0.
    ((turn(vector) * 0.25 * parts as f64) as usize).min(parts - 1)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::noise::{Purpose, Stream};
    use crate::scene::Segment;
    use crate::{RobotId, math};

    fn fan(rays: u32, from: f64, spacing: f64) -> RayFan {
        let directions: Vec<DVec2> = (0..rays)
            .map(|ray| math::sin_cos(from + f64::from(ray) * spacing))
            .map(|(sin, cos)| DVec2::new(cos, sin))
            .collect();
        RayFan::new(directions)
    }

    fn assert_same(walls: &Walls, origin: DVec2, ahead: DVec2, fan: &RayFan, range: f64) {
        let counts = |wall: WallId, distance: f64| !wall.0.is_multiple_of(7) || distance > 1.0;
        let found = walls.cast_fan(origin, ahead, fan, range, counts);
        for (direction, found) in fan.directions.iter().zip(found) {
            let alone = walls.cast_where(origin, ahead.rotate(*direction), range, counts);
            let bits = |hit: Option<Hit>| hit.map(|hit| (hit.distance.to_bits(), hit.wall));
            assert_eq!(bits(found), bits(alone), "from {origin}, ahead {ahead}, along {direction}");
        }
    }

    #[test]
    fn a_fan_meets_what_its_rays_meet_one_by_one() {
        let mut stream = Stream::new(3, RobotId(1), Purpose::Program, 0, 0);
        for case in 0..300 {
            let corner = DVec2::splat([0.0, 0.0, 1e4, -1e6][case % 4]);
            // On a lattice, so that corners are shared, walls overlap and origins lie on them and in line with them.
            let mut lattice =
                |count: f64| corner + DVec2::new((stream.unit() * count).floor(), (stream.unit() * count).floor());
            let walls: Vec<Segment> =
                (0..1 + case % 60).map(|_| Segment { a: lattice(8.0), b: lattice(8.0) }).collect();
            let on_it = lattice(9.0);
            let walls = Walls::new(walls);
            let inside = corner + 8.0 * DVec2::new(stream.unit(), stream.unit());
            let wide = fan(1 + (stream.unit() * 400.0) as u32, stream.unit() * TAU, 0.01 + stream.unit());
            let narrow = fan(360, stream.unit() * TAU, 1e-5);
            let (sin, cos) = math::sin_cos(stream.unit() * TAU);
            for ahead in [DVec2::X, DVec2::NEG_Y, DVec2::new(cos, sin)] {
                for range in [f64::INFINITY, 2.5, 0.0] {
                    for origin in [inside, on_it, on_it + DVec2::new(1e-13, -1e-9), corner - DVec2::splat(3.0)] {
                        assert_same(&walls, origin, ahead, &wide, range);
                        assert_same(&walls, origin, ahead, &narrow, range);
                        assert_same(&walls, origin, ahead, &fan(8, 0.0, TAU / 8.0), range);
                    }
                }
            }
        }
    }

    #[test]
    fn odd_fans_walls_and_numbers_meet_what_their_rays_meet() {
        let odd = [f64::NAN, f64::INFINITY, 1e300].map(|odd| Segment::new(DVec2::new(odd, 0.0), DVec2::ONE));
        let walls = Walls::new([&odd[..], &[Segment::new(DVec2::ZERO, DVec2::ONE)]].concat());
        for origin in [DVec2::splat(0.5), DVec2::new(f64::NAN, 0.0), DVec2::splat(f64::INFINITY)] {
            for range in [1.0, -1.0, f64::NAN] {
                for ahead in [DVec2::X, DVec2::ZERO, DVec2::splat(f64::NAN)] {
                    assert_same(&walls, origin, ahead, &fan(16, 0.0, 0.3), range);
                }
            }
        }
        assert!(walls.cast_fan(DVec2::ZERO, DVec2::X, &RayFan::new(Vec::new()), 1.0, |_, _| true).is_empty());
        assert_same(&Walls::new(Vec::new()), DVec2::ZERO, DVec2::X, &fan(3, 0.0, 1.0), 1.0);
    }

    #[test]
    fn turns_grow_with_the_angle() {
        let turns = (0..1000)
            .map(|step| math::sin_cos(f64::from(step) * TAU / 1000.0))
            .map(|(sin, cos)| turn(DVec2::new(cos, sin)));
        assert!(turns.clone().zip(turns.skip(1)).all(|(a, b)| a < b));
    }
}
