//! The reactive planner (Gois and Hiller, section 5). It fuses readings into the local map, computes the perception of
//! each shank, and derives corrections of the steps. If a correction exceeds a leg's limit, the excess moves the body.
//!
//! P_H (Eq. 4) is the perception of points too high to step over: a vector from the shank towards them. P_L (Eq. 5) is
//! the perception of lower points around the foothold.

use std::f64::consts::PI;

use mapping::inverse::SonarModel;
use mapping::local_map::{LocalMap, Patch};
use mapping::pose::{self, direction, rotated};
use mapping::tsk::{Fusion, Order, Settings};
use nalgebra::{Vector2, Vector3};

use crate::body::{self, Pose};
use crate::operator;
use crate::perception::{self, Heights};

/// Side of a cell of the local map, m.
const CELL: f64 = 0.5;
/// Prior standard deviation of the height of an unmeasured cell, m.
pub const HEIGHT_SIGMA: f64 = 2.0;
/// Half the side of the local map, m: more than twice the range of the sonars, so that the robot remembers why it
/// turned back.
const MAP_HALF_WIDTH: f64 = 14.0;
/// Ramps of the fuzzy sets `low` (a step overcomes the obstacle) and `high` (no step does). Membership rises from 0 at
/// the first height to 1 at the second, m; membership in `low` falls as membership in `high` rises. The planner
/// underestimates rocks: the ring of sonars, 0.6 m high, measures nothing above this height, and the fitted surface
/// smooths rocks.
const HEIGHTS: Heights = Heights { low: (0.08, 0.2), high: (0.2, 0.4) };
/// A point blocks the operator's path if its membership in `high` is at least this.
const BLOCKING_MEMBERSHIP: f64 = 0.5;
/// Half angle about its line of sight within which a sonar reliably detects high obstacles, rad: a little less than
/// half the angle between two sonars. The gap between two sonars is cleared when the robot has moved on.
const CLEAR_ANGLE: f64 = 12.0 / 180.0 * PI;
/// Maximum range up to which cells are cleared, m. Within it, sonars reliably detect high obstacles.
const CLEAR_RANGE: f64 = 3.5;
/// Range up to which cells are cleared if there is no echo, m. It is smaller, since the echo may have dropped out.
const CLEAR_RANGE_NO_ECHO: f64 = 2.0;
/// Height to which clearing lowers a cell, m: the sonars that look around detect no lower obstacle. Its membership in
/// `high` is [`BLOCKING_MEMBERSHIP`], so a cell that has once returned an echo does not become level ground again.
const CLEARED_HEIGHT: f64 = 0.3;
/// l_max of Eq. 4, m from a shank.
const HIGH_REACH: f64 = 1.6;
/// l_max of Eq. 5, m from the tip of a leg.
const LOW_REACH: f64 = 1.0;
/// Look-ahead time of Eq. 5, s.
const AHEAD_S: f64 = 0.5;
/// Shift of a foothold for a P_H of length 1, m.
const SHIFT: f64 = 0.6;
/// Maximum shift of a leg, m; the body takes the excess.
const LEG_LIMIT: f64 = 0.2;
/// Speed of the body per metre of excess (the part of the shift that the legs could not take), 1/s.
const BODY_GAIN: f64 = 1.5;
/// Additional lift of a foot for a P_L of length 1, m.
const LIFT: f64 = 0.4;
/// Speed of the body if the path is free, m/s.
const SPEED: f64 = 0.3;
/// Minimum speed near a high obstacle, m/s: a slow approach may show that the obstacle is a phantom.
const MIN_SPEED: f64 = 0.06;
/// Gain of the controller that holds the initial heading, rad/s per rad.
const HEADING_GAIN: f64 = 0.8;
/// Maximum yaw rate, rad/s.
const MAX_YAW_RATE: f64 = 0.1;

/// Current state of a leg, in the robot's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LegState {
    /// The middle of the shank, m.
    pub shank: Vector3<f64>,
    /// The tip of the shank, m.
    pub tip: Vector3<f64>,
    pub is_in_the_air: bool,
}

/// A reading of one sonar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Number of the sonar, from 0.
    pub sonar: usize,
    /// Estimated pose of the robot at the reading.
    pub pose: Pose,
    /// Measured distance, m; `None` without an echo.
    pub distance: Option<f64>,
}

/// Commands to the legs.
#[derive(Clone, Debug, PartialEq)]
pub struct Orders {
    /// Velocity of the body in the frame of the robot, m/s.
    pub velocity: Vector2<f64>,
    /// Yaw rate, rad/s.
    pub turn: f64,
    /// Correction of each leg: shift of its foothold in the robot's frame (x, y) and additional lift (z), m.
    pub corrections: Vec<Vector3<f64>>,
}

/// The perception vectors that correct the steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corrections {
    /// P_H of Eq. 4 and P_L of Eq. 5.
    Both,
    /// P_H alone: footholds and body move away from high points.
    High,
    /// P_L alone: feet are lifted over low points.
    Low,
    /// No corrections: the steps follow the operator's path.
    Neither,
}

impl Corrections {
    /// The corrections with this name: `both`, `eq4`, `eq5` or `none`.
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "both" => Some(Self::Both),
            "eq4" => Some(Self::High),
            "eq5" => Some(Self::Low),
            "none" => Some(Self::Neither),
            _ => None,
        }
    }
}

/// The planner, with its map.
#[derive(Clone, Debug)]
pub struct Planner {
    map: LocalMap,
    corrections: Corrections,
    /// The heading that is held, rad.
    heading: f64,
    /// Last commanded velocity, in the odometry frame, m/s.
    velocity: Vector2<f64>,
}

impl Planner {
    /// A planner with an empty map, which holds `heading`, rad.
    pub fn new(heading: f64, corrections: Corrections) -> Self {
        // Tuned for a quick rise at a possible obstacle rather than for accuracy: the sonars detect a rock ahead only a
        // few times before the robot reaches it. Old readings are forgotten, since odometry drifts.
        let settings = Settings {
            order: Order::Zero,
            fusion: Fusion::Cells { above: 0.3 },
            height_sigma: HEIGHT_SIGMA,
            reading_sigma: 0.3,
            floor: 0.0,
            forgetting: 0.98,
            ..Settings::default()
        };
        // Excludes the edge of the beam, where a single reading is uncertain and would close gaps.
        let model = SonarModel { min_membership: 0.25, ..SonarModel::srf08() };
        let map = LocalMap::new(CELL, MAP_HALF_WIDTH, model, settings);
        Self { map, corrections, heading, velocity: Vector2::zeros() }
    }

    /// The local map.
    pub fn map(&self) -> &LocalMap {
        &self.map
    }

    /// Adds readings to the map.
    pub fn observe(&mut self, readings: &[Reading]) {
        for Reading { sonar, pose, distance } in readings {
            self.map.follow(pose.ground.position.x, pose.ground.position.y);
            let mount = body::mount(*sonar);
            let sonar = pose.sonar(&mount);
            if let Some(distance) = *distance {
                self.map.observe(&sonar, distance);
            }
            if mount.pitch > 0.0 {
                let distance = distance.map_or(CLEAR_RANGE_NO_ECHO, |distance| distance.min(CLEAR_RANGE));
                self.map.clear(&sonar, distance, CLEAR_ANGLE, pose.lift + CLEARED_HEIGHT);
            }
        }
    }

    /// Computes the commands for a goal `distance` m away in the direction `bearing` (rad, in the odometry frame).
    pub fn plan(&mut self, pose: &Pose, bearing: f64, distance: f64, legs: &[LegState]) -> Orders {
        let patches = self.map.grid();
        let is_high = patches.map(|patch| HEIGHTS.high(patch.z - pose.lift) >= BLOCKING_MEMBERSHIP);
        let goal = pose.ground.position + direction(bearing) * distance;
        let command = operator::look(&is_high, pose.ground.position, goal, body::OPERATOR_CLEARANCE);
        let speed = (SPEED * command.room / body::OPERATOR_CLEARANCE).clamp(MIN_SPEED, SPEED).min(distance);
        let desired_velocity = direction(command.direction) * speed;

        let mut excess = Vector2::zeros();
        let corrections = legs
            .iter()
            .map(|leg| {
                let (correction, leg_excess) = self.correct(pose, leg, patches.values());
                excess += leg_excess;
                correction
            })
            .collect();
        self.velocity = limited(desired_velocity + excess * BODY_GAIN, SPEED);
        let heading = pose.ground.heading;
        let turn = (HEADING_GAIN * pose::wrapped(self.heading - heading)).clamp(-MAX_YAW_RATE, MAX_YAW_RATE);
        Orders { velocity: rotated(self.velocity, -heading), turn, corrections }
    }

    /// Applies the two rules to one leg: away from high points, higher over low ones. The second value is the excess of
    /// the shift over the leg's limit, in the odometry frame.
    fn correct(&self, pose: &Pose, leg: &LegState, patches: &[Patch]) -> (Vector3<f64>, Vector2<f64>) {
        let above = |patch: &Patch| patch.z - pose.lift;
        let shank = pose.in_odometry(&leg.shank);
        let high = patches.iter().map(|patch| (*patch, HEIGHTS.high(above(patch))));
        let repulsion = match self.corrections {
            Corrections::Both | Corrections::High => -SHIFT * perception::high(shank.xy(), HIGH_REACH, high),
            Corrections::Low | Corrections::Neither => Vector2::zeros(),
        };
        let shift = limited(repulsion, LEG_LIMIT);
        let is_lifted = leg.is_in_the_air && matches!(self.corrections, Corrections::Both | Corrections::Low);
        let lift = match is_lifted {
            true => {
                // A foot in the air moves about twice as fast as the body.
                let ahead = 2.0 * AHEAD_S * self.velocity;
                let low = patches.iter().map(|patch| (*patch, HEIGHTS.low(above(patch))));
                let perceived =
                    perception::low(pose.in_odometry(&leg.tip), Vector3::new(ahead.x, ahead.y, 0.0), LOW_REACH, low);
                LIFT * perceived.norm()
            }
            false => 0.0,
        };
        let in_robot = rotated(shift, -pose.ground.heading);
        (in_robot.push(lift), repulsion - shift)
    }
}

/// The vector, shortened to `max_length` if it is longer.
fn limited(vector: Vector2<f64>, max_length: f64) -> Vector2<f64> {
    let length = vector.norm();
    if length > max_length { vector * (max_length / length) } else { vector }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use mapping::pose::Pose as Planar;

    use super::*;

    /// A pose in which the odometry's x axis points to the robot's right.
    fn pose() -> Pose {
        Pose { ground: Planar::new(5.0, 2.0, FRAC_PI_2), lift: 0.1 }
    }

    fn leg(is_in_the_air: bool) -> LegState {
        LegState { shank: Vector3::new(1.0, 0.5, 0.6), tip: Vector3::new(1.0, 0.5, 0.1), is_in_the_air }
    }

    /// A patch of the map at a point of the robot's frame.
    fn patch(x: f64, y: f64, z: f64) -> Patch {
        let point = pose().in_odometry(&Vector3::new(x, y, z));
        Patch { x: point.x, y: point.y, z: point.z, sigma: 0.1 }
    }

    #[test]
    fn a_foothold_moves_away_from_high_points_and_the_body_takes_the_excess() {
        let (correction, excess) =
            Planner::new(0.0, Corrections::Both).correct(&pose(), &leg(false), &[patch(1.0, 1.3, 0.8)]);
        // P_H is (1.6 - 0.8) / 1.6 = 1/2 to the left: 0.3 m to the right, of which the leg takes 0.2 m.
        assert!((correction - Vector3::new(0.0, -LEG_LIMIT, 0.0)).norm() < 1e-12, "{correction}");
        assert!((excess - Vector2::new(0.1, 0.0)).norm() < 1e-12, "to the robot's right: {excess}");
        let (correction, excess) =
            Planner::new(0.0, Corrections::Both).correct(&pose(), &leg(false), &[patch(1.0, 1.9, 0.8)]);
        assert!((correction - Vector3::new(0.0, -0.075, 0.0)).norm() < 1e-12, "{correction}");
        assert!(excess.norm() < 1e-12, "{excess}");
    }

    #[test]
    fn a_foot_in_the_air_is_lifted_over_low_points() {
        let low = [patch(1.5, 0.5, 0.19), patch(1.0, 0.5, 0.0)];
        let (correction, excess) = Planner::new(0.0, Corrections::Both).correct(&pose(), &leg(true), &low);
        assert!(correction.z > 0.1 && correction.xy().norm() == 0.0, "{correction}");
        assert_eq!(excess, Vector2::zeros());
        assert_eq!(
            Planner::new(0.0, Corrections::Both).correct(&pose(), &leg(false), &low).0,
            Vector3::zeros(),
            "on the ground"
        );
    }

    #[test]
    fn corrections_that_are_off_are_zero() {
        let patches = [patch(1.0, 1.3, 0.8), patch(1.5, 0.5, 0.19)];
        let of = |corrections| Planner::new(0.0, corrections).correct(&pose(), &leg(true), &patches).0;
        let [both, high, low, neither] =
            [Corrections::Both, Corrections::High, Corrections::Low, Corrections::Neither].map(of);
        assert!(both.xy().norm() > 0.1 && both.z > 0.05, "{both}");
        assert_eq!((high.xy(), high.z), (both.xy(), 0.0));
        assert_eq!((low.xy(), low.z), (Vector2::zeros(), both.z));
        assert_eq!(neither, Vector3::zeros());
    }

    #[test]
    fn a_phantom_obstacle_is_lowered_to_the_cleared_height() {
        let mut planner = Planner::new(0.0, Corrections::Both);
        let pose = Pose { ground: Planar::new(0.0, 0.0, 0.0), lift: 0.0 };
        let reading = |distance| Reading { sonar: 0, pose, distance };
        let height = |planner: &Planner| planner.map.height(2.3, 0.1).unwrap();
        for _ in 0..20 {
            planner.observe(&[reading(Some(1.5))]);
        }
        assert!(height(&planner) > 0.5, "{}", height(&planner));
        for _ in 0..40 {
            planner.observe(&[reading(Some(5.0))]);
        }
        assert!((height(&planner) - CLEARED_HEIGHT).abs() < 0.02, "{}", height(&planner));
    }
}
