//! The exact test of a ray against a triangle, in `f64`; only this test decides which triangles are hit.

use glam::DVec3;

use super::transform::{RayEntry, TreeTransform};

/// A ray and its nearest hit so far.
pub(super) struct Ray {
    pub origin: DVec3,
    pub direction: DVec3,
    /// Reciprocals of the direction's components; infinite for a component of 0.
    pub reciprocal: DVec3,
    /// Permutation of the axes; the last one is the dominant axis of the direction.
    axes: [usize; 3],
    /// Metres on the first two axes per metre on the last axis.
    shear: [f64; 2],
    /// Metres along the ray per metre on the last axis.
    length_per_axis: f64,
    /// Maximum absolute coordinate of origin and mesh, m.
    max_coordinate: f64,
    /// Tree units per metre.
    scale: f64,
    nearest: Nearest,
}

/// The nearest hit so far.
pub(super) struct Nearest {
    /// Metres along the ray; without a hit, the range of the ray.
    pub distance: f64,
    /// Number of the triangle; [`NO_TRIANGLE`] without a hit.
    pub triangle: u32,
    /// Batch and lane in which the triangle is stored.
    pub batch_lane: (usize, usize),
}

/// Distance behind the origin, in tree units, within which a hit may mean that the origin lies on the surface.
const ORIGIN_DEPTH: f64 = 1.0 / (1 << 20) as f64;

/// Part of the boxes' margin for the rounding of the origin, in tree units.
const ORIGIN_ROUNDING: f64 = 1.0 / (1 << 22) as f64;

const NO_TRIANGLE: u32 = u32::MAX;

/// Minimum ratio of twice a triangle's area, projected along the ray, to the square of the distance of its farthest
/// corner from the ray. With a smaller ratio the triangle is treated as a line.
///
/// The weight of a corner (three products) has an error of at most 2^-50 of that square, which shifts a hit by at most
/// 2^-50 / `SLIVER` = 2^-24 of the triangle's extent. Treating a triangle as a line shifts a hit by at most its width,
/// 2^-25 of its extent. Neither shift exceeds 2^-22 tree units, which the margin of the boxes covers.
const SLIVER: f64 = 1.0 / (1 << 26) as f64;

/// A corner in ray coordinates, sheared so that the ray runs along the last axis through 0.
#[derive(Clone, Copy)]
struct Corner {
    x: f64,
    y: f64,
    /// Coordinate on the dominant axis of the ray.
    z: f64,
}

impl Corner {
    /// Distance from the ray in the maximum norm.
    #[inline(always)]
    fn spread(&self) -> f64 {
        self.x.abs().max(self.y.abs())
    }
}

impl Ray {
    pub fn new(entry: &RayEntry, direction: DVec3, reciprocal: DVec3, range: f64, frame: &TreeTransform) -> Self {
        let [x, y, z] = direction.abs().to_array();
        let last = if x > y && x > z {
            0
        } else if y > z {
            1
        } else {
            2
        };
        let axes = [(last + 1) % 3, (last + 2) % 3, last];
        let length_per_axis = reciprocal[last];
        Self {
            origin: entry.origin,
            direction,
            reciprocal,
            axes,
            shear: [direction[axes[0]] * length_per_axis, direction[axes[1]] * length_per_axis],
            length_per_axis,
            max_coordinate: entry.origin.abs().max_element().max(frame.max_coordinate),
            scale: frame.scale,
            nearest: Nearest { distance: range, triangle: NO_TRIANGLE, batch_lane: (0, 0) },
        }
    }

    /// Permutation of the axes; the last one is the dominant axis of the direction.
    pub fn axes(&self) -> [usize; 3] {
        self.axes
    }

    /// Metres on the first two axes per metre on the last.
    pub fn shear(&self) -> [f64; 2] {
        self.shear
    }

    /// Distance of the nearest hit so far, m; the range of the ray if there is no hit.
    pub fn distance(&self) -> f64 {
        self.nearest.distance
    }

    /// The nearest hit so far.
    pub fn nearest(&self) -> Option<&Nearest> {
        Some(&self.nearest).filter(|nearest| nearest.triangle != NO_TRIANGLE)
    }

    /// Tests a triangle and records it if it is the nearest; among equal distances, the lowest number takes precedence.
    /// `batch_lane` tells the caller where the triangle is stored.
    #[inline(always)]
    pub fn test(&mut self, corners: &[DVec3; 3], triangle: u32, batch_lane: (usize, usize)) {
        let Nearest { distance: min_distance, triangle: nearest, .. } = self.nearest;
        if let Some(distance) = self.distance_to(corners)
            && (distance < min_distance || distance == min_distance && triangle < nearest)
        {
            self.nearest = Nearest { distance, triangle, batch_lane };
        }
    }

    /// Distance to a triangle, m, without the limit of the range; `None` if the ray misses the triangle.
    #[inline(always)]
    pub fn distance_to(&self, corners: &[DVec3; 3]) -> Option<f64> {
        let [a, b, c] = [self.sheared(corners[0]), self.sheared(corners[1]), self.sheared(corners[2])];
        // The sign of a difference of two products is never wrong, because rounding is monotonic. The products of an
        // edge are the same for both triangles that share this edge.
        let u = c.x * b.y - c.y * b.x;
        let v = a.x * c.y - a.y * c.x;
        let w = b.x * a.y - b.y * a.x;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let area = u + v + w;
        let spread = a.spread().max(b.spread()).max(c.spread());
        let ahead = self.length_per_axis * ((u * a.z + v * b.z + w * c.z) / area);
        let distance =
            if area.abs() <= SLIVER * spread * spread { self.through_sliver([a, b, c], spread, ahead)? } else { ahead };
        if distance >= 0.0 { Some(distance) } else { self.starts_on(corners, distance).then_some(0.0) }
    }

    /// A corner in ray coordinates.
    #[inline(always)]
    fn sheared(&self, corner: DVec3) -> Corner {
        let offset = (corner - self.origin).to_array();
        let [x, y, z] = [offset[self.axes[0]], offset[self.axes[1]], offset[self.axes[2]]];
        Corner { x: x - self.shear[0] * z, y: y - self.shear[1] * z, z }
    }

    /// Returns true if the origin lies on a triangle that the ray's line hits at `distance`, which is negative.
    #[cold]
    fn starts_on(&self, corners: &[DVec3; 3], distance: f64) -> bool {
        let normal = super::normal(corners, self.direction);
        let tolerance = (4.0 * f64::EPSILON * self.max_coordinate).min(ORIGIN_ROUNDING / self.scale);
        distance >= -ORIGIN_DEPTH / self.scale && normal.dot(corners[0] - self.origin).abs() <= tolerance
    }

    /// Distance to a triangle that projects almost to a line. `ahead` is an estimate of the distance, which may be the
    /// distance of any point of the triangle, or NaN.
    #[cold]
    fn through_sliver(&self, [a, b, c]: [Corner; 3], spread: f64, ahead: f64) -> Option<f64> {
        let edges = [(a, b), (b, c), (c, a)];
        // Length of the longest edge, its line's distance from the ray, and the components of its direction.
        let [_, offset, x, y] = edges.iter().fold([0.0, spread, 0.0, 0.0], |longest, (from, to)| {
            let (x, y) = (to.x - from.x, to.y - from.y);
            let length = (x * x + y * y).sqrt();
            if length > longest[0] {
                [length, (from.x * y - from.y * x) / length, x / length, y / length]
            } else {
                longest
            }
        });
        if offset.abs() > 2.0 * SLIVER * spread {
            return None;
        }
        // Coordinate along that line; the ray is at 0.
        let along = |corner: &Corner| corner.x * x + corner.y * y;
        let slack = 4.0 * f64::EPSILON * spread;
        let (mut near, mut far) = (f64::INFINITY, f64::NEG_INFINITY);
        for (from, to) in &edges {
            let (start, end) = (along(from), along(to));
            if start.min(end) > slack || start.max(end) < -slack {
                continue;
            }
            let (first, last) = if start == end {
                (from.z, to.z)
            } else {
                let z = from.z + (start / (start - end)).clamp(0.0, 1.0) * (to.z - from.z);
                (z, z)
            };
            for distance in [self.length_per_axis * first, self.length_per_axis * last] {
                near = near.min(distance);
                far = far.max(distance);
            }
        }
        (near <= far).then(|| if ahead.is_finite() { ahead.clamp(near, far) } else { near.max(far.min(0.0)) })
    }
}
