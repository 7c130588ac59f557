//! Legs of a fake robot: scripts define their state, and speed commands move the robot.

use robios_sys::{Out, OutFloats, Stop};

use super::robot::{FakeRobot, State};
use super::{Fake, Moment};
use crate::leg::LinkPose;
use crate::unit::{Angle, Length, Speed, TurnRate};

/// Implements the LEG functions, identical in both generations, by methods of [`FakeRobot`].
macro_rules! leg_functions {
    () => {
        fn LEGCount(&self) -> Result<i32, Stop> {
            self.leg_count()
        }

        fn LEGSetGait(&self, gait: i32) -> Result<i32, Stop> {
            self.with_legs(gait >= 1, |_| ())
        }

        fn LEGSetSpeed(&self, vx_mmps: i32, vy_mmps: i32, omega_degps: i32) -> Result<i32, Stop> {
            self.leg_speed(vx_mmps, vy_mmps, omega_degps)
        }

        fn LEGSetStep(&self, height_mm: i32) -> Result<i32, Stop> {
            self.with_legs(height_mm >= 0, |_| ())
        }

        fn LEGGetJoint(&self, leg: i32, joint: i32, degrees: &mut Out<f32>) -> Result<i32, Stop> {
            self.leg_joint(leg, joint, degrees)
        }

        fn LEGGetLink(&self, leg: i32, link: i32, pose: &mut OutFloats) -> Result<i32, Stop> {
            self.leg_link(leg, link, pose)
        }

        fn LEGGetHeight(&self, mm: &mut Out<f32>) -> Result<i32, Stop> {
            self.leg_height(mm)
        }

        fn LEGGetFoot(&self, leg: i32) -> Result<i32, Stop> {
            self.leg_foot(leg)
        }

        fn LEGCorrect(&self, leg: i32, _: i32, _: i32, _: i32) -> Result<i32, Stop> {
            self.leg_correction(leg)
        }
    };
}
pub(super) use leg_functions;

/// State of a leg of a fake robot at a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct FakeLeg {
    /// Joint angles in the order of [`LegJoint`](crate::LegJoint); the leg has only these joints.
    pub joints: Vec<Angle>,
    /// Poses of the links in the order of [`LegLink`](crate::LegLink); the leg has only these links.
    pub links: Vec<LinkPose>,
    /// The foot is on the ground.
    pub is_on_ground: bool,
}

impl Default for FakeLeg {
    /// A leg on the ground, without joints and links.
    fn default() -> Self {
        Self { joints: Vec::new(), links: Vec::new(), is_on_ground: true }
    }
}

impl Fake {
    /// Adds a leg with the script of its state. The robot accepts every gait from 1 on, every step height from 0 on and
    /// every correction.
    pub fn leg(mut self, leg: impl Fn(&Moment) -> FakeLeg + Send + 'static) -> Self {
        self.legs.push(Box::new(leg));
        self
    }

    /// Sets the script of the body height of a robot with legs; 0 by default.
    pub fn body_height(mut self, height: impl Fn(&Moment) -> Length + Send + 'static) -> Self {
        self.body_height = Some(Box::new(height));
        self
    }
}

/// Calls of both generations; each takes effect at its end.
impl FakeRobot {
    pub(super) fn leg_count(&self) -> Result<i32, Stop> {
        self.act(|_| self.fake.legs.len() as i32)
    }

    /// Runs `act` and returns 0; returns -1 if the robot has no legs or the command is not possible.
    pub(super) fn with_legs(&self, is_possible: bool, act: impl FnOnce(&mut State)) -> Result<i32, Stop> {
        self.act(|state| {
            if self.fake.legs.is_empty() || !is_possible {
                return -1;
            }
            act(state);
            0
        })
    }

    pub(super) fn leg_speed(&self, vx_mmps: i32, vy_mmps: i32, omega_degps: i32) -> Result<i32, Stop> {
        let [forward, left] = [vx_mmps, vy_mmps].map(|mmps| Speed::from_robios7(mmps).as_metres_per_second());
        let turn = TurnRate::from_robios7(omega_degps).as_radians_per_second();
        self.with_legs(true, |state| state.motion.set_twist(state.now_us, forward, left, turn))
    }

    /// Applies `read` to the current state of a leg; `None` if there is no such leg.
    fn read_leg<T>(&self, state: &State, leg: i32, read: impl FnOnce(&FakeLeg) -> T) -> Option<T> {
        let script = self.fake.legs.get(usize::try_from(leg).ok()?.checked_sub(1)?)?;
        Some(read(&script(&state.moment(state.now_us))))
    }

    pub(super) fn leg_joint(&self, leg: i32, joint: i32, degrees: &mut Out<f32>) -> Result<i32, Stop> {
        self.act(|state| {
            let angle = self.read_leg(state, leg, |leg| by_number(&leg.joints, joint)).flatten();
            match angle {
                Some(angle) if !degrees.is_null() => {
                    degrees.set(angle.as_degrees() as f32);
                    0
                }
                _ => -1,
            }
        })
    }

    pub(super) fn leg_link(&self, leg: i32, link: i32, pose: &mut OutFloats) -> Result<i32, Stop> {
        self.act(|state| {
            let link_pose = self.read_leg(state, leg, |leg| by_number(&leg.links, link)).flatten();
            match link_pose {
                Some(LinkPose { x, y, z, roll, pitch, yaw }) if !pose.is_null() => {
                    let position = [x, y, z].map(Length::as_millimetres);
                    let angles = [roll, pitch, yaw].map(Angle::as_degrees);
                    let numbers: Vec<f32> = position.into_iter().chain(angles).map(|number| number as f32).collect();
                    pose.set(&numbers);
                    0
                }
                _ => -1,
            }
        })
    }

    pub(super) fn leg_height(&self, mm: &mut Out<f32>) -> Result<i32, Stop> {
        self.with_legs(!mm.is_null(), |state| {
            let moment = state.moment(state.now_us);
            let height = self.fake.body_height.as_ref().map_or(Length::ZERO, |height| height(&moment));
            mm.set(height.as_millimetres() as f32);
        })
    }

    pub(super) fn leg_foot(&self, leg: i32) -> Result<i32, Stop> {
        self.act(|state| self.read_leg(state, leg, |leg| leg.is_on_ground).map_or(-1, i32::from))
    }

    pub(super) fn leg_correction(&self, leg: i32) -> Result<i32, Stop> {
        let has_leg = usize::try_from(leg).is_ok_and(|leg| (1..=self.fake.legs.len()).contains(&leg));
        self.with_legs(has_leg, |_| ())
    }
}

/// The element with a number, counted from 1.
fn by_number<T: Copy>(elements: &[T], number: i32) -> Option<T> {
    elements.get(usize::try_from(number).ok()?.checked_sub(1)?).copied()
}
