//! Natural walking: human joint angles over the gait cycle, and the resulting stride of a leg of any proportions.

use std::f64::consts::PI;

use glam::DVec2;

use super::{
    leg::{Foot, Leg},
    smooth::smooth,
};
use crate::math;

/// Number of samples of one cycle.
const SAMPLES: usize = 50;
/// Phase of toe-off. Phases are fractions of the gait cycle since heel strike.
pub(super) const TOE_OFF: f64 = 0.6;
/// The foot is flat from the phase `FOOT_FLAT`, when the forefoot has come down, to `HEEL_OFF`. In the measured data
/// below (see [`THIGH`]) its pitch is less than 1.5 degrees between these phases. Our choice.
const FOOT_FLAT: f64 = 0.12;
pub(super) const HEEL_OFF: f64 = 0.26;
/// Phase from which the foot's pitch is exactly the measured one (see [`natural_angles`]). Our choice.
const MEASURED_PITCH_FROM: f64 = 0.42;
/// Phase from which the hip sinks to the height that it has at the heel strike of the other leg. Our choice.
const HIP_SINKS_FROM: f64 = 0.4;
/// Number of intervals in the table of the swing path.
const SWING_INTERVALS: usize = 40;

/// Angles in degrees every 2 % of the gait cycle since heel strike, of children at free walking speed. They are the
/// angle of the thigh from the vertical (forwards positive), knee flexion, and ankle dorsiflexion (toes up) from the
/// right angle to the shank.
///
/// Source: Schwartz, Rozumalski and Trost 2008, "The effect of walking speed on the gait of typically developing
/// children", J. Biomechanics 41, 1639-1650, electronic addendum, free speed, means: hip flexion less pelvic tilt, knee
/// flexion, dorsiflexion. The source's values at 0 % and at 100 % of the cycle differ by up to 0.3 degrees; the first
/// sample is their mean.
const THIGH: [f64; SAMPLES] = [
    23.6, 23.7, 23.7, 23.5, 23.0, 21.9, 20.3, 18.4, 16.2, 13.9, 11.5, 9.1, 6.7, 4.3, 2.0, -0.3, -2.5, -4.7, -6.8, -8.9,
    -10.8, -12.6, -14.2, -15.5, -16.6, -17.3, -17.6, -17.4, -16.3, -14.4, -11.7, -8.3, -4.4, -0.5, 3.4, 7.0, 10.3,
    13.4, 16.1, 18.4, 20.4, 22.0, 23.2, 24.0, 24.4, 24.4, 24.1, 23.8, 23.5, 23.4,
];
const KNEE: [f64; SAMPLES] = [
    5.5, 7.9, 10.9, 14.1, 16.9, 18.6, 19.3, 19.2, 18.6, 17.6, 16.5, 15.2, 13.9, 12.6, 11.3, 10.1, 9.0, 8.0, 7.2, 6.6,
    6.2, 6.3, 6.8, 7.9, 9.5, 11.6, 14.5, 18.1, 22.6, 27.9, 33.9, 40.2, 46.3, 51.7, 55.7, 58.2, 59.1, 58.7, 56.9, 53.9,
    49.8, 44.7, 38.8, 32.4, 25.5, 18.7, 12.5, 7.6, 4.6, 4.0,
];
const ANKLE: [f64; SAMPLES] = [
    -2.2, -3.9, -5.6, -5.6, -4.1, -2.1, -0.2, 1.5, 2.9, 4.1, 5.2, 6.1, 6.8, 7.4, 8.0, 8.6, 9.1, 9.7, 10.2, 10.7, 11.1,
    11.5, 11.8, 11.8, 11.5, 10.4, 8.4, 4.9, -0.2, -6.9, -13.8, -18.5, -19.8, -18.0, -14.7, -11.2, -7.9, -4.9, -2.4,
    -0.3, 1.1, 2.1, 2.5, 2.4, 1.8, 1.0, 0.1, -0.6, -1.1, -1.4,
];

/// Angles of thigh (from the vertical, forwards positive), knee (flexion) and ankle (toes up), rad, at `phase`: the
/// fraction of the gait cycle since heel strike.
///
/// Cubic interpolation with continuous slope between the measured samples, which are 2 % apart.
pub fn natural_angles(phase: f64) -> [f64; 3] {
    [&THIGH, &KNEE, &ANKLE].map(|degrees| periodic(degrees, phase) / 180.0 * PI)
}

/// Pitch of the foot, toes up, rad, at `phase`: the measured pitch, but exactly 0 while the foot is flat, with smooth
/// transitions.
pub(super) fn natural_pitch(phase: f64) -> f64 {
    let phase = phase - phase.floor();
    let weight = if phase < HEEL_OFF {
        1.0 - smooth(phase / FOOT_FLAT)
    } else {
        smooth((phase - HEEL_OFF) / (MEASURED_PITCH_FROM - HEEL_OFF))
    };
    if weight == 0.0 {
        return 0.0;
    }
    let [thigh, knee, ankle] = natural_angles(phase);
    (thigh - knee + ankle) * weight
}

/// Stride, hip height and swing path of a leg that follows the natural angles.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct NaturalGait {
    /// Length of a stride, m.
    pub stride: f64,
    /// Position of the foothold relative to the hip in the middle of the stance phase, m forwards.
    pub foothold_offset: f64,
    /// Height of the hip at each sample of half a gait cycle, m.
    heights: [f64; SAMPLES / 2],
    /// Swing path from toe-off to heel strike: x is the fraction of the horizontal distance, y the height, m.
    swing_path: [DVec2; SWING_INTERVALS + 1],
}

impl NaturalGait {
    /// Natural gait of `leg`; `None` for a leg without a foot.
    pub fn new(leg: &Leg) -> Option<Self> {
        let foot = leg.foot?;
        let hip_height = |index: usize| {
            let phase = index as f64 / SAMPLES as f64;
            -sole_point(leg, foot, phase, -foot.heel).y.min(sole_point(leg, foot, phase, foot.toe).y)
        };
        let heights: [f64; SAMPLES / 2] = std::array::from_fn(|index| {
            let sunk_fraction = smooth((index as f64 / SAMPLES as f64 - HIP_SINKS_FROM) / (0.5 - HIP_SINKS_FROM));
            hip_height(index) + (hip_height(0) - hip_height(index)) * sunk_fraction
        });
        let foothold_at_strike = sole_point(leg, foot, 0.0, -foot.heel).x + foot.heel;
        let foothold_at_toe_off = sole_point(leg, foot, TOE_OFF, foot.toe).x - foot.toe;
        let stride = (foothold_at_strike - foothold_at_toe_off) / TOE_OFF;
        let foothold_offset = 0.5 * (foothold_at_strike + foothold_at_toe_off);
        let mut natural = Self { stride, foothold_offset, heights, swing_path: [DVec2::ZERO; SWING_INTERVALS + 1] };
        let point_over_ground = |index: usize| {
            let fraction = index as f64 / SWING_INTERVALS as f64;
            let phase = TOE_OFF + (1.0 - TOE_OFF) * fraction;
            let from_ankle = foot.toe - (foot.heel + foot.toe) * smooth(fraction);
            sole_point(leg, foot, phase, from_ankle) + DVec2::new(stride * phase, natural.height(phase))
        };
        let (start, end) = (point_over_ground(0), point_over_ground(SWING_INTERVALS));
        let swing_path = std::array::from_fn(|index| {
            let fraction = index as f64 / SWING_INTERVALS as f64;
            let point = point_over_ground(index) - start;
            DVec2::new(point.x / (end.x - start.x), point.y - (end.y - start.y) * fraction)
        });
        natural.swing_path = swing_path;
        Some(natural)
    }

    /// Height of the hip above the ground, m, at `phase` of one leg; the other leg's phase differs by half a cycle.
    pub fn height(&self, phase: f64) -> f64 {
        periodic(&self.heights, 2.0 * phase)
    }

    /// Swing path at a fraction of the swing time: x is the fraction of the horizontal distance, y the height, m.
    pub fn swing_path(&self, fraction: f64) -> DVec2 {
        let position = fraction.clamp(0.0, 1.0) * SWING_INTERVALS as f64;
        let index = (position as usize).min(SWING_INTERVALS - 1);
        let sample = |index: usize| self.swing_path[index.min(SWING_INTERVALS)];
        cubic(
            [sample(index.saturating_sub(1)), sample(index), sample(index + 1), sample(index + 2)],
            position - index as f64,
        )
    }
}

/// Position, relative to the hip, at `phase`, of the point on the sole that is `from_ankle` m in front of the ankle.
/// The components are forwards and up in the plane of the leg, m.
fn sole_point(leg: &Leg, foot: Foot, phase: f64, from_ankle: f64) -> DVec2 {
    let [thigh, knee, _] = natural_angles(phase);
    let ((sin_thigh, cos_thigh), (sin_shank, cos_shank)) = (math::sin_cos(thigh), math::sin_cos(thigh - knee));
    let (sin, cos) = math::sin_cos(natural_pitch(phase));
    let ankle =
        DVec2::new(leg.thigh * sin_thigh + leg.shank * sin_shank, -leg.thigh * cos_thigh - leg.shank * cos_shank);
    ankle + DVec2::new(from_ankle * cos + foot.height * sin, from_ankle * sin - foot.height * cos)
}

/// Interpolated value of periodic samples, `cycles` after the first.
fn periodic<const N: usize>(samples: &[f64; N], cycles: f64) -> f64 {
    let position = (cycles - cycles.floor()) * N as f64;
    let index = (position as usize).min(N - 1);
    let sample = |offset: usize| DVec2::new(samples[(index + N + offset - 1) % N], 0.0);
    cubic([sample(0), sample(1), sample(2), sample(3)], position - index as f64).x
}

/// Catmull-Rom interpolation between the second and the third of four values.
fn cubic([a, b, c, d]: [DVec2; 4], fraction: f64) -> DVec2 {
    b + (c - a + (2.0 * a - 5.0 * b + 4.0 * c - d + (3.0 * (b - c) + d - a) * fraction) * fraction) * (0.5 * fraction)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    pub(crate) fn leg() -> Leg {
        Leg {
            name: "LEFT".to_owned(),
            hip: DVec3::new(0.0, 0.09, 0.9),
            thigh: 0.429,
            shank: 0.430,
            foot: Some(Foot { heel: 0.055, toe: 0.16, height: 0.068 }),
            wheel: None,
        }
    }

    #[test]
    fn curves_pass_through_their_samples_with_continuous_slope() {
        let degrees = |phase| natural_angles(phase).map(|angle| angle * 180.0 / PI);
        let assert_close = |found: [f64; 3], expected: [f64; 3]| {
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{found:?} {expected:?}");
        };
        assert_close(degrees(0.0), [23.6, 5.5, -2.2]);
        assert_close(degrees(1.72), [10.3, 59.1, -7.9]);
        assert_close(degrees(-0.02), [23.4, 4.0, -1.4]);
        for index in 0..5000 {
            let phase = f64::from(index) / 5000.0;
            let (before, at, after) = (degrees(phase - 1e-6), degrees(phase), degrees(phase + 1e-6));
            for joint in 0..3 {
                let kink = (after[joint] - 2.0 * at[joint] + before[joint]).abs();
                assert!(kink < 1e-6, "joint {joint} has a kink of {kink} degrees at {phase}");
            }
        }
    }

    #[test]
    fn stride_length_matches_humans() {
        let natural = NaturalGait::new(&leg()).expect("the leg has a foot");
        // The hip is at 0.52 of the body height; a stride is about 0.8 of the body height.
        assert!((1.3..1.5).contains(&natural.stride), "{}", natural.stride);
        let heights: Vec<f64> = (0..500).map(|index| natural.height(f64::from(index) / 500.0)).collect();
        let (low, high) =
            heights.iter().fold((f64::MAX, 0.0f64), |(low, high), height| (low.min(*height), high.max(*height)));
        assert!(low > 0.87 && high < 0.93 && high - low > 0.02, "{low} to {high}");
        assert!((natural.height(0.1) - natural.height(0.6)).abs() < 1e-12);
    }

    #[test]
    fn swing_path_begins_and_ends_on_the_ground() {
        let natural = NaturalGait::new(&leg()).expect("the leg has a foot");
        assert!(natural.swing_path(0.0).length() < 1e-12 && (natural.swing_path(1.0) - DVec2::X).length() < 1e-12);
        let highest = (0..100).map(|index| natural.swing_path(f64::from(index) / 100.0).y).fold(0.0, f64::max);
        assert!((0.02..0.3).contains(&highest), "{highest}");
    }
}
