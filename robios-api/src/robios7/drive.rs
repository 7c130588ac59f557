//! The VW driving interface. Positions are in the odometry frame: x forward and y left at the start of the program,
//! angles counter-clockwise. `set_position` changes the frame.

use super::Robot;
use crate::Result;
use crate::device::Device;
use crate::drive::{ControlGains, Position, Remaining, Velocity};
use crate::error::checked;
use crate::robot::robios7;
use crate::unit::{Angle, Length, Speed, TurnRate};

/// The driving interface.
#[derive(Clone, Copy, Debug)]
pub struct Drive<'r>(pub(super) &'r Robot);

/// Wheels that are stalled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stall {
    /// The left one.
    Left,
    /// The right one.
    Right,
    /// Both.
    Both,
}

impl Drive<'_> {
    /// Sets the speed, until the next command; replaces a drive in progress.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if RoBIOS refuses the command.
    #[track_caller]
    pub fn set_speed(&self, forward: Speed, turn: TurnRate) -> Result {
        let code = robios7!(self.0, VWSetSpeed(forward.to_robios7(), turn.to_robios7()));
        checked("VWSetSpeed", Device::Drive, code)
    }

    /// Stops the robot; the same as speeds of 0.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if RoBIOS refuses the command.
    #[track_caller]
    pub fn stop(&self) -> Result {
        self.set_speed(Speed::ZERO, TurnRate::ZERO)
    }

    /// Speed by odometry, to 1 mm/s and 1 degree/s.
    #[track_caller]
    pub fn velocity(&self) -> Velocity {
        let (mut forward, mut turn) = (0, 0);
        let _: i32 = robios7!(self.0, VWGetSpeed(&mut forward, &mut turn));
        Velocity { forward: Speed::from_robios7(forward), turn: TurnRate::from_robios7(turn) }
    }

    /// Position by odometry, to 1 mm and 1 degree.
    #[track_caller]
    pub fn position(&self) -> Position {
        let (mut x, mut y, mut phi) = (0, 0, 0);
        let _: i32 = robios7!(self.0, VWGetPosition(&mut x, &mut y, &mut phi));
        Position { x: Length::from_robios7(x), y: Length::from_robios7(y), phi: Angle::from_robios7(phi) }
    }

    /// Sets the position of the odometry; the robot does not move.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if RoBIOS refuses the position.
    #[track_caller]
    pub fn set_position(&self, position: Position) -> Result {
        let (x, y, phi) = (position.x.to_robios7(), position.y.to_robios7(), position.phi.to_robios7());
        checked("VWSetPosition", Device::Drive, robios7!(self.0, VWSetPosition(x, y, phi)))
    }

    /// Starts to drive straight ahead, and does not wait; replaces a drive in progress.
    ///
    /// `distance` is negative for backwards, `speed` above 0.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) for a speed that RoBIOS does not accept.
    #[track_caller]
    pub fn straight(&self, distance: Length, speed: Speed) -> Result<&Self> {
        let code = robios7!(self.0, VWStraight(distance.to_robios7(), speed.to_robios7()));
        self.started("VWStraight", false, code)
    }

    /// Starts to turn on the spot, and does not wait; replaces a drive in progress.
    ///
    /// `angle` is positive for counter-clockwise, `rate` above 0.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) for a rate that RoBIOS does not accept, or if the robot cannot turn on
    /// the spot.
    #[track_caller]
    pub fn turn(&self, angle: Angle, rate: TurnRate) -> Result<&Self> {
        self.started("VWTurn", true, robios7!(self.0, VWTurn(angle.to_robios7(), rate.to_robios7())))
    }

    /// Starts to drive along a circular arc, and does not wait; replaces a drive in progress.
    ///
    /// `length` is the length of the arc, negative for backwards. `angle` is the change of heading, positive for
    /// counter-clockwise. `speed` is above 0.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) for a speed that RoBIOS does not accept.
    #[track_caller]
    pub fn curve(&self, length: Length, angle: Angle, speed: Speed) -> Result<&Self> {
        let (length, angle, speed) = (length.to_robios7(), angle.to_robios7(), speed.to_robios7());
        self.started("VWCurve", false, robios7!(self.0, VWCurve(length, angle, speed)))
    }

    /// Starts to drive in one arc to a point in the robot's frame, and does not wait; replaces a drive in progress.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) for a speed that RoBIOS does not accept, or a point that the robot
    /// cannot reach.
    #[track_caller]
    pub fn drive_to(&self, ahead: Length, left: Length, speed: Speed) -> Result<&Self> {
        let (ahead, left, speed) = (ahead.to_robios7(), left.to_robios7(), speed.to_robios7());
        self.started("VWDrive", false, robios7!(self.0, VWDrive(ahead, left, speed)))
    }

    /// Checks the return code of a call that starts a drive. A refused call leaves the drive in progress unchanged.
    fn started(&self, call: &'static str, is_turning: bool, code: i32) -> Result<&Self> {
        checked(call, Device::Drive, code)?;
        self.0.settings().is_turning.set(is_turning);
        Ok(self)
    }

    /// Remaining length or angle of the drive in progress, to 1 mm or 1 degree; 0 when it is done.
    #[track_caller]
    pub fn remaining(&self) -> Remaining {
        let remaining: i32 = robios7!(self.0, VWRemain());
        if self.0.settings().is_turning.get() {
            Remaining::Angle(Angle::from_robios7(remaining))
        } else {
            Remaining::Length(Length::from_robios7(remaining))
        }
    }

    /// Returns true if the drive has ended.
    #[track_caller]
    pub fn is_done(&self) -> bool {
        let done: i32 = robios7!(self.0, VWDone());
        done != 0
    }

    /// Waits until the drive has ended.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if RoBIOS refuses to wait.
    #[track_caller]
    pub fn wait(&self) -> Result {
        checked("VWWait", Device::Drive, robios7!(self.0, VWWait()))
    }

    /// Wheels stalled by an obstacle; `None` if no wheel is.
    #[track_caller]
    pub fn stall(&self) -> Option<Stall> {
        match robios7!(self.0, VWStalled()) {
            1 => Some(Stall::Left),
            2 => Some(Stall::Right),
            3 => Some(Stall::Both),
            _ => None,
        }
    }

    /// Starts the PI controllers of speed and rate of turn; gains are rounded to tenths, reset times to hundredths of a
    /// second.
    ///
    /// Typical are gains of 7, with a reset time of 0.3 s for `speed` and 0.1 s for `turn`.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if RoBIOS refuses the gains.
    #[track_caller]
    pub fn start_control(&self, speed: ControlGains, turn: ControlGains) -> Result {
        let tenths = |gain: f64| (gain * 10.0).round() as i32;
        let hundredths = |time_s: f64| (time_s * 100.0).round() as i32;
        let [speed, turn] = [speed, turn].map(|gains| (tenths(gains.gain), hundredths(gains.reset_time_s)));
        checked("VWControl", Device::Drive, robios7!(self.0, VWControl(speed.0, speed.1, turn.0, turn.1)))
    }

    /// Stops the PI controllers.
    ///
    /// # Errors
    /// [`Error::Refused`](crate::Error::Refused) if RoBIOS refuses the call.
    #[track_caller]
    pub fn stop_control(&self) -> Result {
        checked("VWControlOff", Device::Drive, robios7!(self.0, VWControlOff()))
    }
}

impl Position {
    /// Offset of another position in this one's frame, ahead and to the left: the arguments of [`Drive::drive_to`].
    pub fn offset_to(self, other: Self) -> (Length, Length) {
        let (x, y) = (other.x - self.x, other.y - self.y);
        let (sin, cos) = (self.phi.sin(), self.phi.cos());
        (x * cos + y * sin, y * cos - x * sin)
    }
}
