//! Legs, for both generations: an extension of this simulator, not part of RoBIOS.

use robios_sys::ByteBuffer;

use crate::device::Device;
use crate::error::checked;
use crate::unit::{Angle, Length, Speed, TurnRate};
use crate::{Error, Result, Robot};

/// The legs of a walking robot. Dropping the value does not stop the robot.
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
    /// Hip joint about the vertical axis: positive to the left.
    Yaw = 1,
    /// Hip joint about the forward axis: positive with the leg to the left.
    Roll = 2,
    /// Hip joint: positive with the thigh forward.
    Pitch = 3,
    /// Knee joint: positive when bent.
    Knee = 4,
    /// Ankle joint of legs with a foot: positive with the toes up.
    Ankle = 5,
}

/// A link of a leg.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(i32)]
pub enum LegLink {
    /// From hip to knee.
    Thigh = 1,
    /// From the knee down.
    Shank = 2,
    /// Foot, of legs that have one.
    Foot = 3,
}

/// Pose of a link in the frame of the body: x forward, y left, z up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LinkPose {
    /// Forward.
    pub x: Length,
    /// Left.
    pub y: Length,
    /// Up.
    pub z: Length,
    /// Rotation about the link's x axis, positive with the left side up.
    pub roll: Angle,
    /// Pitch, positive upwards. The frame is rotated by yaw, then by pitch, then by roll.
    pub pitch: Angle,
    /// Yaw, positive to the left.
    pub yaw: Angle,
}

/// Calls a function of the table of the program's generation.
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
    /// Number of legs.
    pub fn count(&self) -> usize {
        self.count.into()
    }

    /// All legs, in order.
    pub fn all(&self) -> impl Iterator<Item = Leg> + use<> {
        (1..=self.count).map(Leg)
    }

    /// Switches to another gait; each leg changes when it is next lifted.
    ///
    /// # Errors
    /// [`Error::Refused`] if there is no such gait.
    #[track_caller]
    pub fn set_gait(&self, gait: Gait) -> Result {
        checked("LEGSetGait", Device::Legs, leg!(&self.robot, LEGSetGait(gait.0.into())))
    }

    /// Walks at this speed until the next command: forward, to the left, and turning, rounded to whole mm/s and
    /// degrees/s. A speed beyond the capability of the legs is scaled down as a whole.
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

    /// Sets the height to which feet are lifted, rounded to 1 mm; each leg applies it from its next step on.
    ///
    /// # Errors
    /// [`Error::Refused`] for a height below 0 or beyond the reach of the legs.
    #[track_caller]
    pub fn set_step_height(&self, height: Length) -> Result {
        checked("LEGSetStep", Device::Legs, leg!(&self.robot, LEGSetStep(height.to_robios7())))
    }

    /// Current angle of a joint from its encoder, without noise.
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

    /// Current pose of a link in the frame of the body, computed from the joint angles.
    ///
    /// # Errors
    /// [`Error::Refused`] if there is no such leg, or it has no such link.
    #[track_caller]
    pub fn link(&self, leg: Leg, link: LegLink) -> Result<LinkPose> {
        let mut numbers = [0_f32; 6];
        let buffer = ByteBuffer { data: numbers.as_mut_ptr().cast(), len: numbers.len() };
        checked("LEGGetLink", Device::Legs, leg!(&self.robot, LEGGetLink(leg.0.into(), link as i32, buffer)))?;
        let [x, y, z, roll, pitch, yaw] = numbers.map(f64::from);
        let [x, y, z] = [x, y, z].map(Length::millimetres);
        let [roll, pitch, yaw] = [roll, pitch, yaw].map(Angle::degrees);
        Ok(LinkPose { x, y, z, roll, pitch, yaw })
    }

    /// Current height of the body frame above the world's floor, computed from the legs.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call.
    #[track_caller]
    pub fn height(&self) -> Result<Length> {
        let mut mm = 0_f32;
        checked("LEGGetHeight", Device::Legs, leg!(&self.robot, LEGGetHeight(&mut mm)))?;
        Ok(Length::millimetres(mm.into()))
    }

    /// Returns true if a foot is on the ground.
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

    /// Corrects the steps of a leg until the next correction. `forward` and `left` shift the foothold relative to that
    /// of the gait, and `lift` raises the foot further; each is rounded to 1 mm.
    ///
    /// # Errors
    /// [`Error::Refused`] if there is no such leg or the leg cannot reach the foothold.
    #[track_caller]
    pub fn correct(&self, leg: Leg, forward: Length, left: Length, lift: Length) -> Result {
        let [forward, left, lift] = [forward, left, lift].map(Length::to_robios7);
        let code = leg!(&self.robot, LEGCorrect(leg.0.into(), forward, left, lift));
        checked("LEGCorrect", Device::Legs, code)
    }
}
