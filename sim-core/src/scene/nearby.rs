//! A short list of the bodies near a point, in a layout in which a ray tests all of them quickly.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, f32x8};
use glam::{DVec2, Vec2};

use super::{Bounds, grid::is_ray};

/// Number of bodies in a batch.
const WIDTH: usize = 8;

/// Maximum number of bodies near a point. With more bodies, a ray finds its bodies faster by a walk through the cells
/// of the index.
const CAPACITY: usize = 32;

/// The bodies whose rectangles overlap a circle, for rays that stay in the circle.
///
/// Rectangles are tested in `f32`, eight at a time, with margins wider than all rounding. The caller tests the bodies
/// themselves.
#[derive(Clone, Debug)]
pub struct Nearby<K> {
    /// Middle of the circle, the origin of the positions.
    centre: DVec2,
    /// Radius of the circle, m.
    reach: f64,
    level: Level,
    len: usize,
    rectangles: Rectangles,
    keys: [K; CAPACITY],
}

/// Middles and half sizes of rectangles; unused ones are NaN and compare as false.
#[derive(Clone, Debug)]
struct Rectangles {
    /// Margin by which rectangles are enlarged, m.
    slack: f32,
    x: [f32; CAPACITY],
    y: [f32; CAPACITY],
    half_x: [f32; CAPACITY],
    half_y: [f32; CAPACITY],
}

/// A rectangle in the frame of an index.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rectangle {
    pub middle: Vec2,
    pub half: Vec2,
}

impl Rectangle {
    /// The rectangle `bounds`, relative to `origin`.
    pub fn new(bounds: &Bounds, origin: DVec2) -> Self {
        let middle = 0.5 * (bounds.min + bounds.max) - origin;
        Self { middle: middle.as_vec2(), half: (0.5 * (bounds.max - bounds.min)).as_vec2() }
    }
}

impl<K: Copy> Nearby<K> {
    /// An empty list for rays that stay within `reach` metres of `centre`. `placeholder` is any key.
    pub fn new(centre: DVec2, reach: f64, placeholder: K) -> Self {
        let [x, y, half_x, half_y] = [[f32::NAN; CAPACITY]; 4];
        let rectangles = Rectangles { slack: 0.0, x, y, half_x, half_y };
        Self { centre, reach, level: Level::new(), len: 0, rectangles, keys: [placeholder; CAPACITY] }
    }

    /// The square around the circle.
    pub(super) fn square(&self) -> Bounds {
        let half = DVec2::splat(self.reach);
        Bounds { min: self.centre - half, max: self.centre + half }
    }

    /// Chooses the margin by which rectangles are enlarged: at least `margin` plus the error of rounding positions in
    /// an index over `extent` to `f32`. Returns the chosen margin, m.
    pub(super) fn set_slack(&mut self, extent: &Bounds, margin: f64) -> f64 {
        // Each of a few roundings is at most 2^-24 of the largest coordinate.
        let size = (extent.max - extent.min).max_element() + 4.0 * self.reach;
        let slack = &mut self.rectangles.slack;
        *slack = slack.max((2e-6 * size + margin) as f32);
        f64::from(*slack)
    }

    /// The function that adds a body with a rectangle relative to `origin` if it overlaps the circle. The function
    /// returns false if the list is full.
    pub(super) fn adder(&mut self, origin: DVec2) -> impl FnMut(K, &Rectangle) -> bool {
        let shift = (origin - self.centre).as_vec2();
        let Rectangles { slack, x, y, half_x, half_y } = &mut self.rectangles;
        let (limit, keys, len) = (self.reach as f32 + *slack, &mut self.keys, &mut self.len);
        move |key, rectangle| {
            let (middle, half, index) = (rectangle.middle + shift, rectangle.half, *len);
            if index >= CAPACITY {
                return false;
            }
            (x[index], y[index]) = (middle.x, middle.y);
            (half_x[index], half_y[index]) = (half.x, half.y);
            keys[index] = key;
            // A rectangle outside the circle is stored too, and the next one overwrites it: the processor could not
            // predict a branch here.
            let distance = limit + half.x + half.y;
            *len += usize::from(middle.length_squared() <= distance * distance);
            true
        }
    }

    /// Returns true if the first `range` metres of every ray from `origin` stay in the circle.
    pub fn contains(&self, origin: DVec2, range: f64) -> bool {
        let distance = self.reach - range;
        distance >= 0.0 && (origin - self.centre).length_squared() <= distance * distance
    }

    /// Visits each body whose rectangle a ray in the circle meets within `range` metres, in no particular order.
    /// `direction` is a unit vector.
    ///
    /// Bodies whose rectangle the ray misses by less than the rectangle's size may be visited too. An invalid ray (see
    /// [`Walls::cast`](super::Walls::cast)) visits nothing.
    pub fn along_ray(&self, origin: DVec2, direction: DVec2, range: f64, mut visit: impl FnMut(K)) {
        if !is_ray(origin, direction, range) {
            return;
        }
        let (from, direction, range) = ((origin - self.centre).as_vec2(), direction.as_vec2(), range as f32);
        let (len, rectangles) = (self.len, &self.rectangles);
        let mut hits = dispatch!(self.level, simd => rectangles.hits(simd, len, from, direction, range));
        while hits != 0 {
            visit(self.keys[hits.trailing_zeros() as usize % CAPACITY]);
            hits &= hits - 1;
        }
    }
}

impl Rectangles {
    /// Bit mask of the rectangles, among the first `len`, that a ray may meet.
    #[inline(always)]
    fn hits<S: Simd>(&self, simd: S, len: usize, from: Vec2, direction: Vec2, range: f32) -> u32 {
        let (x, y) = (f32x8::splat(simd, direction.x), f32x8::splat(simd, direction.y));
        let (forward_x, forward_y) = (x.abs(), y.abs());
        let (from_x, from_y) = (f32x8::splat(simd, from.x), f32x8::splat(simd, from.y));
        let (slack, limit) = (f32x8::splat(simd, self.slack), f32x8::splat(simd, range));
        let (zero, mut hits) = (f32x8::splat(simd, 0.0), 0);
        for start in (0..len.min(CAPACITY)).step_by(WIDTH) {
            let offset_x = batch(simd, &self.x, start) - from_x;
            let offset_y = batch(simd, &self.y, start) - from_y;
            let (half_x, half_y) = (batch(simd, &self.half_x, start), batch(simd, &self.half_y, start));
            let aside = (x * offset_y - y * offset_x).abs();
            let ahead = x * offset_x + y * offset_y;
            let width = half_x * forward_y + half_y * forward_x + slack;
            let depth = half_x * forward_x + half_y * forward_y + slack;
            let is_hit = aside.simd_le(width) & (ahead + depth).simd_ge(zero) & (ahead - depth).simd_le(limit);
            hits |= (is_hit.to_bitmask() as u32) << start;
        }
        hits
    }
}

/// The numbers of a batch that begins at `start`.
#[inline(always)]
fn batch<S: Simd>(simd: S, numbers: &[f32; CAPACITY], start: usize) -> f32x8<S> {
    f32x8::simd_from(simd, numbers.as_chunks::<WIDTH>().0[start / WIDTH])
}

#[cfg(test)]
mod tests {
    use super::super::BoundsIndex;
    use super::*;

    #[test]
    fn a_ray_in_the_circle_misses_no_body_on_its_path() {
        // Linear congruential generator with values from 0 to 1.
        let mut state = 1_u64;
        let mut unit = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let (mut list_count, mut walk_count) = (0, 0);
        for (count, size, place) in [(2, 0.3, 0.0), (30, 0.1, 1e6), (30, 20.0, 0.0), (300, 0.2, -1e3), (3000, 0.2, 0.0)]
        {
            let side = 10.0_f64.max(f64::from(count / 10).sqrt());
            let discs: Vec<_> = (0..count)
                .map(|id| (id, DVec2::new(place + side * unit(), place + side * unit()), size * unit()))
                .collect();
            let mut index = BoundsIndex::default();
            index.rebuild(&discs.iter().map(|&(id, at, radius)| (id, Bounds::of_disc(at, radius))).collect::<Vec<_>>());
            for _ in 0..200 {
                let centre = DVec2::new(place + 1.2 * side * unit(), place + 1.2 * side * unit());
                let mut nearby = Nearby::new(centre, 2.0, 0);
                if !index.add_to(&mut nearby) {
                    walk_count += 1;
                    continue;
                }
                list_count += 1;
                for _ in 0..20 {
                    let origin = centre + 0.7 * DVec2::new(unit() - 0.5, unit() - 0.5);
                    let (sin, cos) = crate::math::sin_cos(7.0 * unit());
                    let (direction, range) = (DVec2::new(cos, sin), 1.5 * unit());
                    assert!(nearby.contains(origin, range));
                    let mut visited = Vec::new();
                    nearby.along_ray(origin, direction, range, |id| visited.push(id));
                    for &(id, middle, radius) in &discs {
                        let is_hit = Bounds::of_disc(middle, radius).clip(origin, direction, range).is_some();
                        assert!(
                            !is_hit || visited.contains(&id),
                            "{id} from {origin} along {direction} up to {range} m"
                        );
                    }
                    assert!(visited.len() <= 32);
                }
                nearby.along_ray(centre, DVec2::NAN, 1.0, |_| panic!("no ray"));
            }
        }
        let everywhere = Bounds { min: DVec2::NEG_INFINITY, max: DVec2::INFINITY };
        let mut index = BoundsIndex::default();
        index.rebuild(&[(1, everywhere), (2, Bounds::of_disc(DVec2::ONE, 0.1))]);
        assert!(!index.add_to(&mut Nearby::new(DVec2::ZERO, 2.0, 0)), "too large for single precision");
        assert!(list_count > 100 && walk_count > 100, "{list_count} lists, {walk_count} walks");
    }
}
