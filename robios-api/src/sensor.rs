//! Bumpers, infrared proximity sensors and the compass.

use std::time::Duration;

use robios_sys::robios6::{BumpHandle, IRHandle, TRUE, semantics};

use crate::device::{BumperAt, Device, InfraredAt};
use crate::error::checked;
use crate::robot::{release, robios};
use crate::unit::Angle;
use crate::{Error, Result, Robot};

/// A bumper.
#[derive(Debug)]
pub struct Bumper {
    robot: Robot,
    handle: BumpHandle,
}

/// An infrared proximity sensor.
#[derive(Debug)]
pub struct Infrared {
    robot: Robot,
    handle: IRHandle,
}

/// The compass, which measures continuously.
#[derive(Debug)]
pub struct Compass {
    robot: Robot,
}

/// A step of calibrating the compass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Calibration {
    /// Forget the calibration.
    Reset,
    /// Take a reading; needed once in each of two opposite headings.
    Take,
}

impl Robot {
    /// Initialises a bumper.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the robot has no such bumper.
    #[track_caller]
    pub fn bumper(&self, at: BumperAt) -> Result<Bumper> {
        match robios!(self, BUMPInit(at.semantics())) {
            0 => Err(Error::Unavailable(Device::Bumper(at))),
            handle => Ok(Bumper { robot: self.clone(), handle }),
        }
    }

    /// Initialises an infrared proximity sensor.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the robot has no such sensor.
    #[track_caller]
    pub fn infrared(&self, at: InfraredAt) -> Result<Infrared> {
        match robios!(self, IRInit(at.semantics())) {
            0 => Err(Error::Unavailable(Device::Infrared(at))),
            handle => Ok(Infrared { robot: self.clone(), handle }),
        }
    }

    /// Initialises the compass and starts it.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the robot has none; [`Error::Refused`] while another [`Compass`] exists.
    #[track_caller]
    pub fn compass(&self) -> Result<Compass> {
        let code: i32 = robios!(self, COMPASSInit(semantics::COMPASS));
        if code != 0 {
            return Err(Error::Unavailable(Device::Compass));
        }
        checked("COMPASSStart", Device::Compass, robios!(self, COMPASSStart(TRUE)))?;
        Ok(Compass { robot: self.clone() })
    }
}

impl Bumper {
    /// Time of the first contact since the last check, measured from the robot's start, to a hundredth of a second;
    /// `None` without contact.
    #[track_caller]
    pub fn bumped(&self) -> Option<Duration> {
        let mut hundredths = 0;
        let code: i32 = robios!(&self.robot, BUMPCheck(self.handle, &mut hundredths));
        (code == 0).then(|| Duration::from_millis(10) * i32::max(hundredths, 0) as u32)
    }
}

impl Infrared {
    /// Returns true if an object is near.
    #[track_caller]
    pub fn is_near(&self) -> bool {
        let value: i32 = robios!(&self.robot, IRRead(self.handle));
        value == 1
    }
}

impl Compass {
    /// The heading clockwise from north (the world's +y), [0, 360) degrees; `None` before the first result.
    ///
    /// This angle is clockwise, as on a compass; all other angles are counter-clockwise.
    #[track_caller]
    pub fn bearing(&self) -> Option<Angle> {
        let bearing_deg: i32 = robios!(&self.robot, COMPASSGet());
        (bearing_deg >= 0).then(|| Angle::degrees(bearing_deg.into()))
    }

    /// Returns true if a result is available.
    #[track_caller]
    pub fn is_ready(&self) -> bool {
        let ready: i32 = robios!(&self.robot, COMPASSCheck());
        ready == 1
    }

    /// Calibrates the compass.
    ///
    /// # Errors
    /// [`Error::Refused`] if RoBIOS refuses the call.
    #[track_caller]
    pub fn calibrate(&self, step: Calibration) -> Result {
        let mode = match step {
            Calibration::Reset => 1,
            Calibration::Take => 0,
        };
        checked("COMPASSCalibrate", Device::Compass, robios!(&self.robot, COMPASSCalibrate(mode)))
    }
}

impl Drop for Bumper {
    fn drop(&mut self) {
        release!(&self.robot, BUMPRelease(self.handle));
    }
}

impl Drop for Infrared {
    fn drop(&mut self) {
        release!(&self.robot, IRRelease(self.handle));
    }
}

impl Drop for Compass {
    fn drop(&mut self) {
        release!(&self.robot, COMPASSStop());
        release!(&self.robot, COMPASSRelease());
    }
}
