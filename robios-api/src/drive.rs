//! The VW driving interface. Positions are in the odometry frame: x forward and y left when the interface was
//! initialised, angles counter-clockwise.

use std::cell::Cell;

use robios_sys::robios6::{PositionType, SpeedType, VWHandle, semantics};

use crate::device::Device;
use crate::error::checked;
use crate::robot::{release, robios};
use crate::unit::{Angle, Length, Speed, TurnRate};
use crate::{Error, Result, Robot};

/// Position and heading on the ground.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Position {
    /// Coordinate along the direction of heading 0.
    pub x: Length,
    /// Coordinate to the left of the direction of heading 0.
    pub y: Length,
    /// Heading, counter-clockwise.
    pub phi: Angle,
}

impl Position {
    /// The distance to another position.
    pub fn distance_to(self, other: Self) -> Length {
        Length::of_vector(other.x - self.x, other.y - self.y)
    }

    /// Turn that makes the robot face another position, from -180 to 180 degrees.
    pub fn turn_to(self, other: Self) -> Angle {
        (Angle::towards(other.x - self.x, other.y - self.y) - self.phi).wrapped()
    }
}

/// Forward speed and rate of turn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Velocity {
    /// Forward.
    pub forward: Speed,
    /// Counter-clockwise.
    pub turn: TurnRate,
}

/// Remaining length or angle of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Remaining {
    /// Remaining length of a straight drive or a curve.
    Length(Length),
    /// Remaining angle of a turn on the spot.
    Angle(Angle),
}

/// Gains of a PI controller: output = `gain` (e + integral of e / `reset_time`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlGains {
    /// Proportional gain, without unit.
    pub gain: f64,
    /// Reset time, in seconds.
    pub reset_time_s: f64,
}

/// The driving interface; dropping it stops the robot.
///
/// Only one exists at a time. It reserves the motors and encoders of the wheels.
///
/// ```
/// # use robios_api::prelude::*;
/// fn drive_round_a_corner(robot: &Robot) -> Result {
///     let drive = robot.drive()?;
///     drive.straight(0.4.metres(), 0.2.metres_per_second())?.wait()?;
///     drive.turn(90.degrees(), 1.radians_per_second())?.wait()?;
///     assert_eq!(format!("{:.3}", drive.position().x), "0.400 m");
///     Ok(())
/// }
/// # robios_api::fake::Fake::new().run(drive_round_a_corner).expect_finished();
/// ```
#[derive(Debug)]
pub struct Drive {
    robot: Robot,
    handle: VWHandle,
    is_turning: Cell<bool>,
}

impl Robot {
    /// Initialises the driving interface and sets position and heading to 0.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the robot cannot drive or its motors are in use.
    #[track_caller]
    pub fn drive(&self) -> Result<Drive> {
        let handle: VWHandle = robios!(self, VWInit(semantics::VW_DRIVE, 1));
        match handle {
            0 => Err(Error::Unavailable(Device::Drive)),
            handle => Ok(Drive { robot: self.clone(), handle, is_turning: Cell::new(false) }),
        }
    }
}

impl Drive {
    /// Sets the speed, until the next command; replaces a drive in progress.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the command.
    #[track_caller]
    pub fn set_speed(&self, forward: Speed, turn: TurnRate) -> Result {
        let code = robios!(&self.robot, VWSetSpeed(self.handle, forward.to_robios(), turn.to_robios()));
        checked("VWSetSpeed", Device::Drive, code)
    }

    /// Stops the robot; the same as speeds of 0.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the command.
    #[track_caller]
    pub fn stop(&self) -> Result {
        self.set_speed(Speed::ZERO, TurnRate::ZERO)
    }

    /// Speed by odometry.
    #[track_caller]
    pub fn velocity(&self) -> Velocity {
        let mut speed = SpeedType::default();
        let _: i32 = robios!(&self.robot, VWGetSpeed(self.handle, &mut speed));
        Velocity { forward: Speed::from_robios(speed.v), turn: TurnRate::from_robios(speed.w) }
    }

    /// Position by odometry.
    #[track_caller]
    pub fn position(&self) -> Position {
        let mut position = PositionType::default();
        let _: i32 = robios!(&self.robot, VWGetPosition(self.handle, &mut position));
        Position {
            x: Length::from_robios(position.x),
            y: Length::from_robios(position.y),
            phi: Angle::from_robios(position.phi),
        }
    }

    /// Sets the position of the odometry; the robot does not move.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the position.
    #[track_caller]
    pub fn set_position(&self, position: Position) -> Result {
        let (x, y, phi) = (position.x.to_robios(), position.y.to_robios(), position.phi.to_robios());
        let code = robios!(&self.robot, VWSetPosition(self.handle, x, y, phi));
        checked("VWSetPosition", Device::Drive, code)
    }

    /// Starts the PI controllers of speed and rate of turn; without them speeds are open loop.
    ///
    /// Typical are a gain of 7 with a reset time of 0.3 s for `speed`, and a gain of 10 with 0.1 s for `turn`.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the gains.
    #[track_caller]
    pub fn start_control(&self, speed: ControlGains, turn: ControlGains) -> Result {
        let [speed_gain, speed_reset, turn_gain, turn_reset] =
            [speed.gain, speed.reset_time_s, turn.gain, turn.reset_time_s].map(|number| number as f32);
        let code = robios!(&self.robot, VWStartControl(self.handle, speed_gain, speed_reset, turn_gain, turn_reset));
        checked("VWStartControl", Device::Drive, code)
    }

    /// Stops the PI controllers.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call.
    #[track_caller]
    pub fn stop_control(&self) -> Result {
        checked("VWStopControl", Device::Drive, robios!(&self.robot, VWStopControl(self.handle)))
    }

    /// Starts to drive straight ahead and does not wait; replaces a drive in progress.
    ///
    /// `distance` is negative for backwards, `speed` above 0.
    ///
    /// # Errors
    /// [`Error::Refused`] for a speed that RoBIOS does not accept.
    #[track_caller]
    pub fn straight(&self, distance: Length, speed: Speed) -> Result<&Self> {
        let code = robios!(&self.robot, VWDriveStraight(self.handle, distance.to_robios(), speed.to_robios()));
        self.started("VWDriveStraight", false, code)
    }

    /// Starts to turn on the spot, and does not wait; replaces a drive in progress.
    ///
    /// `angle` is positive for counter-clockwise, `rate` above 0.
    ///
    /// # Errors
    /// [`Error::Refused`] for a rate that RoBIOS does not accept, or if the robot cannot turn on the spot.
    #[track_caller]
    pub fn turn(&self, angle: Angle, rate: TurnRate) -> Result<&Self> {
        let code = robios!(&self.robot, VWDriveTurn(self.handle, angle.to_robios(), rate.to_robios()));
        self.started("VWDriveTurn", true, code)
    }

    /// Starts to drive along a circular arc, and does not wait; replaces a drive in progress.
    ///
    /// `length` is the length of the arc, negative for backwards. `angle` is the change of heading, positive for
    /// counter-clockwise. `speed` is above 0.
    ///
    /// # Errors
    /// [`Error::Refused`] for a speed that RoBIOS does not accept.
    #[track_caller]
    pub fn curve(&self, length: Length, angle: Angle, speed: Speed) -> Result<&Self> {
        let (length, angle, speed) = (length.to_robios(), angle.to_robios(), speed.to_robios());
        let code = robios!(&self.robot, VWDriveCurve(self.handle, length, angle, speed));
        self.started("VWDriveCurve", false, code)
    }

    /// Checks the return code of a call that starts a drive. A refused call leaves the drive in progress unchanged.
    fn started(&self, call: &'static str, is_turning: bool, code: i32) -> Result<&Self> {
        checked(call, Device::Drive, code)?;
        self.is_turning.set(is_turning);
        Ok(self)
    }

    /// Remaining length or angle of the drive in progress; 0 when it is done.
    #[track_caller]
    pub fn remaining(&self) -> Remaining {
        let remaining: f32 = robios!(&self.robot, VWDriveRemain(self.handle));
        if self.is_turning.get() {
            Remaining::Angle(Angle::from_robios(remaining))
        } else {
            Remaining::Length(Length::from_robios(remaining))
        }
    }

    /// Returns true if the drive has ended.
    #[track_caller]
    pub fn is_done(&self) -> bool {
        let done: i32 = robios!(&self.robot, VWDriveDone(self.handle));
        done != 0
    }

    /// Waits until the drive has ended.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses to wait.
    #[track_caller]
    pub fn wait(&self) -> Result {
        checked("VWDriveWait", Device::Drive, robios!(&self.robot, VWDriveWait(self.handle)))
    }

    /// Returns true if a motor is stalled because an obstacle blocks the robot.
    #[track_caller]
    pub fn is_stalled(&self) -> bool {
        let stalled: i32 = robios!(&self.robot, VWStalled(self.handle));
        stalled == 1
    }
}

impl Drop for Drive {
    fn drop(&mut self) {
        release!(&self.robot, VWRelease(self.handle));
    }
}
