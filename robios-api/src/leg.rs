//! Legs, of both generations: functions of this simulator, RoBIOS has none.

use robios_sys::ByteRoom;

use crate::device::Device;
use crate::error::checked;
use crate::unit::{Angle, Length, Speed, TurnRate};
use crate::{Error, Result, Robot};

/// The legs of a walking robot. Dropping them changes nothing: it walks on.
///
/// ```
/// # use robios_api::prelude::*;
/// # use robios_api::fake::{Fake, FakeLeg};
/// use robios_api::{Leg, LegJoint};
///
/// fn walk(robot: &Robot) -> Result {
///     let legs = robot.legs()?;
///     legs.set_speed(300.millimetres_per_second(), Speed::ZERO, TurnRate::ZERO)?;
///     robot.sleep(2.seconds());
///     for leg in legs.all() {
///         writeln!(robot.console(), "knee {:.0}, on the ground: {}", legs.joint(leg, LegJoint::Knee)?, legs.is_on_ground(leg)?);
///     }
///     legs.stop()
/// }
/// # let knee = |_: &_| FakeLeg { joints: vec![Angle::ZERO, Angle::ZERO, Angle::ZERO, 20.degrees()], ..FakeLeg::default() };
/// # let run = Fake::new().leg(knee).run(walk).expect_finished();
/// # assert_eq!(run.console(), "knee 20°, on the ground: true\n");
/// # assert!((run.position().x - 600.millimetres()).abs() < 1.millimetres());
/// ```
#[derive(Clone, Debug)]
pub struct Legs {
    robot: Robot,
    count: u8,
}

/// A leg by its number, from 1 in the order of the robi.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Leg(pub u8);

/// A gait by its number, from 1 in the order of the robi.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Gait(pub u8);

/// A joint of a leg, from the body to the foot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(i32)]
pub enum LegJoint {
    /// At the hip, about the upright axis: positive to the left.
    Yaw = 1,
    /// At the hip, about the axis ahead.
    Roll = 2,
    /// At the hip: positive where the thigh is forward.
    Pitch = 3,
    /// Positive where the knee is bent.
    Knee = 4,
    /// Of legs with a foot: positive where the toes are up.
    Ankle = 5,
}

/// A link of a leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(i32)]
pub enum LegLink {
    /// From hip to knee.
    Thigh = 1,
    /// From the knee on.
    Shank = 2,
    /// Of legs that have one.
    Foot = 3,
}

/// Where a link is, in the frame of the body: x forward, y left, z up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkPose {
    /// Forward.
    pub x: Length,
    /// Left.
    pub y: Length,
    /// Up.
    pub z: Length,
    /// About the link's x.
    pub roll: Angle,
    /// Upwards: the frame is turned by yaw, then by pitch, then by roll.
    pub pitch: Angle,
    /// To the left.
    pub yaw: Angle,
}

/// Calls a function of the table that the program has.
macro_rules! leg {
    ($robot:expr, $name:ident($($argument:expr),*)) => {
        if $robot.tables().is_some_and(|tables| tables.robios.is_null()) {
            crate::robot::call!($robot, robios7, $name($($argument),*))
        } else {
            crate::robot::call!($robot, robios, $name($($argument),*))
        }
    };
}

impl Robot {
    /// The legs.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the robot has none.
    #[track_caller]
    pub fn legs(&self) -> Result<Legs> {
        let count: i32 = leg!(self, LEGCount());
        match u8::try_from(count) {
            Ok(count @ 1..) => Ok(Legs { robot: self.clone(), count }),
            _ => Err(Error::Unavailable(Device::Legs)),
        }
    }
}

impl crate::robios7::Robot {
    /// The legs.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the robot has none.
    #[track_caller]
    pub fn legs(&self) -> Result<Legs> {
        self.0.legs()
    }
}

impl Legs {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.count.into()
    }

    /// All of them, in order.
    pub fn all(&self) -> impl Iterator<Item = Leg> + use<> {
        (1..=self.count).map(Leg)
    }

    /// Walks in another gait from now on; each leg takes it up when it is lifted next.
    ///
    /// # Errors
    /// [`Error::Refused`] if there is no such gait.
    #[track_caller]
    pub fn set_gait(&self, gait: Gait) -> Result {
        checked("LEGSetGait", Device::Legs, leg!(&self.robot, LEGSetGait(gait.0.into())))
    }

    /// Walks at this speed until the next command, to whole mm/s and degrees/s: forward, to the left, and turning. What is
    /// beyond the legs is slowed down as a whole.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the command.
    #[track_caller]
    pub fn set_speed(&self, forward: Speed, left: Speed, turn: TurnRate) -> Result {
        let [forward, left, turn] = [forward.to_robios7(), left.to_robios7(), turn.to_robios7()];
        checked("LEGSetSpeed", Device::Legs, leg!(&self.robot, LEGSetSpeed(forward, left, turn)))
    }

    /// Stops; the same as speeds of 0.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the command.
    #[track_caller]
    pub fn stop(&self) -> Result {
        self.set_speed(Speed::ZERO, Speed::ZERO, TurnRate::ZERO)
    }

    /// Sets how high feet are lifted, to a millimetre, each from its next step on.
    ///
    /// # Errors
    /// [`Error::Refused`] for a height below 0 or beyond the legs.
    #[track_caller]
    pub fn set_step_height(&self, height: Length) -> Result {
        checked("LEGSetStep", Device::Legs, leg!(&self.robot, LEGSetStep(height.to_robios7())))
    }

    /// The angle of a joint now, by its encoder, which makes no errors.
    ///
    /// # Errors
    /// [`Error::Refused`] if there is no such leg, or it has no such joint.
    #[track_caller]
    pub fn joint(&self, leg: Leg, joint: LegJoint) -> Result<Angle> {
        let mut degrees = 0_f32;
        let code = leg!(&self.robot, LEGGetJoint(leg.0.into(), joint as i32, &mut degrees));
        checked("LEGGetJoint", Device::Legs, code)?;
        Ok(Angle::degrees(degrees.into()))
    }

    /// Where a link is now in the frame of the body, by the angles of the joints.
    ///
    /// # Errors
    /// [`Error::Refused`] if there is no such leg, or it has no such link.
    #[track_caller]
    pub fn link(&self, leg: Leg, link: LegLink) -> Result<LinkPose> {
        let mut numbers = [0_f32; 6];
        let room = ByteRoom { data: numbers.as_mut_ptr().cast(), len: numbers.len() };
        checked("LEGGetLink", Device::Legs, leg!(&self.robot, LEGGetLink(leg.0.into(), link as i32, room)))?;
        let [x, y, z, roll, pitch, yaw] = numbers.map(f64::from);
        let [x, y, z] = [x, y, z].map(Length::millimetres);
        let [roll, pitch, yaw] = [roll, pitch, yaw].map(Angle::degrees);
        Ok(LinkPose { x, y, z, roll, pitch, yaw })
    }

    /// How high the frame of the body is above the world's floor now, as the legs tell it.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS does not tell it.
    #[track_caller]
    pub fn height(&self) -> Result<Length> {
        let mut mm = 0_f32;
        checked("LEGGetHeight", Device::Legs, leg!(&self.robot, LEGGetHeight(&mut mm)))?;
        Ok(Length::millimetres(mm.into()))
    }

    /// Whether a foot is on the ground now.
    ///
    /// # Errors
    /// [`Error::Refused`] if there is no such leg.
    #[track_caller]
    pub fn is_on_ground(&self, leg: Leg) -> Result<bool> {
        match leg!(&self.robot, LEGGetFoot(leg.0.into())) {
            code @ ..0 => Err(Error::Refused { call: "LEGGetFoot", device: Device::Legs, code }),
            code => Ok(code == 1),
        }
    }

    /// Moves where a leg treads, forward and to the left of the gait's foothold, and how much higher it is lifted on the way, to
    /// a millimetre; until it is said again.
    ///
    /// # Errors
    /// [`Error::Refused`] if there is no such leg or it cannot reach so far.
    #[track_caller]
    pub fn correct(&self, leg: Leg, forward: Length, left: Length, higher: Length) -> Result {
        let [forward, left, higher] = [forward, left, higher].map(Length::to_robios7);
        let code = leg!(&self.robot, LEGCorrect(leg.0.into(), forward, left, higher));
        checked("LEGCorrect", Device::Legs, code)
    }
}
