//! General perception of a shank (Gois and Hiller, section 5, after Braunstingl): two vectors towards the obstacles
//! around it.
//!
//! Eq. 4 and 5 print only the length of each p_k, the vector towards the k-th point, but sum the p_k as vectors. Here
//! each p_k has the direction from the reference to the point. The reference is the shank for P_H, and the tip's next
//! position for P_L.

use mapping::local_map::Patch;
use nalgebra::{Vector2, Vector3};

/// The two fuzzy sets of heights above the ground that the robot stands on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heights {
    /// Ramp from ground to low, m: ground up to the first height, low from the second height on.
    pub low: (f64, f64),
    /// Ramp from low to high, m: only low up to the first height, only high from the second height on.
    pub high: (f64, f64),
}

impl Heights {
    /// Membership in the set `high`: a ramp.
    pub fn high(&self, height: f64) -> f64 {
        ramp(height, self.high)
    }

    /// Membership in the set `low` of obstacles that a simple step overcomes. It rises from `low.0` to `low.1`, and
    /// falls from `high.0` to `high.1`, where the membership in `high` rises.
    pub fn low(&self, height: f64) -> f64 {
        ramp(height, self.low) * (1.0 - self.high(height))
    }
}

fn ramp(value: f64, (from, to): (f64, f64)) -> f64 {
    ((value - from) / (to - from)).clamp(0.0, 1.0)
}

/// P_H of Eq. 4: vector in the plane towards the high points around `shank`. Its length is that of the longest p_k. The
/// length of a p_k falls from 1 at the shank to 0 at `reach` m, and is weighted by the point's membership in `high` (our
/// choice; it makes the equation a fuzzy rule).
pub fn high(shank: Vector2<f64>, reach: f64, points: impl Iterator<Item = (Patch, f64)>) -> Vector2<f64> {
    let vectors = points.filter_map(|(patch, membership)| {
        let offset = Vector2::new(patch.x, patch.y) - shank;
        vector(offset, reach, membership)
    });
    combined(vectors, Vector2::zeros())
}

/// P_L of Eq. 5: vector towards the low points around `tip + ahead` (m), where the shank's tip, now at `tip`, will be.
/// The paper takes the points at the distance `reach`, whose p_k would all be about 0; here the points within that
/// distance count.
pub fn low(
    tip: Vector3<f64>,
    ahead: Vector3<f64>,
    reach: f64,
    points: impl Iterator<Item = (Patch, f64)>,
) -> Vector3<f64> {
    let vectors = points.filter_map(|(patch, membership)| {
        let offset = Vector3::new(patch.x, patch.y, patch.z) - tip - ahead;
        vector(offset, reach, membership)
    });
    combined(vectors, Vector3::zeros())
}

type Vector<const N: usize> = nalgebra::SVector<f64, N>;

/// p_k: (l_max - l_k) / l_max times the membership, along the unit vector from the reference to the point; `offset` is
/// the point relative to the reference, l_k its length, and `reach` is l_max. `None` from l_max on, for membership 0,
/// and for a point at the reference itself, which has no direction.
fn vector<const N: usize>(offset: Vector<N>, reach: f64, membership: f64) -> Option<Vector<N>> {
    let length = offset.norm();
    (length > 0.0 && length < reach && membership > 0.0)
        .then(|| offset / length * (membership * (reach - length) / reach))
}

/// Direction of the sum of all vectors, with the maximum of their lengths; `none` if the sum is zero.
fn combined<const N: usize>(vectors: impl Iterator<Item = Vector<N>>, none: Vector<N>) -> Vector<N> {
    let (sum, norm_max) = vectors.fold((none, 0.0f64), |(sum, norm_max), p| (sum + p, norm_max.max(p.norm())));
    let length = sum.norm();
    if length > 0.0 { sum * (norm_max / length) } else { none }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn patch(x: f64, y: f64, z: f64) -> Patch {
        Patch { x, y, z, sigma: 0.1 }
    }

    #[test]
    fn the_nearest_high_point_gives_the_length_and_all_give_the_direction() {
        let at = |points: &[(f64, f64)]| {
            high(Vector2::new(1.0, 0.0), 2.0, points.iter().map(|(x, y)| (patch(*x, *y, 1.0), 1.0)))
        };
        assert_eq!(at(&[]), Vector2::zeros());
        assert_eq!(at(&[(4.0, 0.0)]), Vector2::zeros());
        assert_eq!(at(&[(1.5, 0.0)]), Vector2::new(0.75, 0.0));
        // Two equal points, ahead to either side: the result points straight ahead and is as long as each vector.
        let both = at(&[(1.6, 0.8), (1.6, -0.8)]);
        assert!((both - Vector2::new(0.5, 0.0)).norm() < 1e-12, "{both}");
        assert_eq!(at(&[(1.0, 0.0)]), Vector2::zeros(), "the point itself has no direction");
    }

    #[test]
    fn distances_of_low_points_are_measured_from_the_next_foothold() {
        let tip = Vector3::new(0.0, 0.0, 0.3);
        let point = |x| [(patch(x, 0.0, 0.3), 1.0)].into_iter();
        assert_eq!(low(tip, Vector3::zeros(), 0.5, point(0.6)), Vector3::zeros());
        let near = low(tip, Vector3::new(0.2, 0.0, 0.0), 0.5, point(0.6));
        assert!((near - Vector3::new(0.2, 0.0, 0.0)).norm() < 1e-12, "{near}");
    }

    #[test]
    fn membership_of_heights_as_low_ground_and_high() {
        let heights = Heights { low: (0.1, 0.2), high: (0.4, 0.6) };
        assert_eq!((heights.low(0.05), heights.low(0.3), heights.low(0.7)), (0.0, 1.0, 0.0));
        assert_eq!((heights.high(0.3), heights.high(0.7)), (0.0, 1.0));
        assert!((heights.high(0.5) - 0.5).abs() < 1e-12 && (heights.low(0.5) - 0.5).abs() < 1e-12);
    }
}
