//! Semaphores.

use crate::device::Device;
use crate::error::checked;
use crate::robot::{release, robios};
use crate::{Result, Robot};

/// A semaphore. Clones refer to the same semaphore and can be passed to other tasks.
#[derive(Clone, Debug)]
pub struct Semaphore {
    number: robios_sys::robios6::Semaphore,
}

/// Permit taken from a semaphore; dropping it returns the permit.
#[derive(Debug)]
#[must_use = "dropping the permit returns it immediately"]
pub struct Permit<'a> {
    robot: &'a Robot,
    number: robios_sys::robios6::Semaphore,
}

impl Semaphore {
    #[track_caller]
    pub(super) fn new(robot: &Robot, permits: u32) -> Result<Self> {
        let permits = i32::try_from(permits).unwrap_or(i32::MAX);
        let mut number = 0;
        checked("OSSemInit", Device::Semaphore, robios!(robot, OSSemInit(&mut number, permits)))?;
        Ok(Self { number })
    }

    /// Takes a permit; waits until one is available.
    ///
    /// # Panics
    /// If the semaphore was created in another run.
    #[track_caller]
    pub fn wait(&self, robot: &Robot) {
        let code: i32 = robios!(robot, OSSemP(self.number));
        assert!(code == 0, "the semaphore was made in another run");
    }

    /// Adds a permit, which goes to the task that has waited longest, if any. Does not wait.
    ///
    /// # Panics
    /// If the semaphore was created in another run.
    #[track_caller]
    pub fn signal(&self, robot: &Robot) {
        let code: i32 = robios!(robot, OSSemV(self.number));
        assert!(code == 0, "the semaphore was made in another run");
    }

    /// Takes a permit as [`wait`](Self::wait) does; dropping the guard returns the permit.
    ///
    /// # Panics
    /// See [`wait`](Self::wait).
    #[track_caller]
    pub fn acquire<'a>(&self, robot: &'a Robot) -> Permit<'a> {
        self.wait(robot);
        Permit { robot, number: self.number }
    }
}

impl Drop for Permit<'_> {
    fn drop(&mut self) {
        release!(self.robot, OSSemV(self.number));
    }
}
