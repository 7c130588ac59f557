//! Random numbers of the robot's own stream: a function of the run's seed and the robot, not of the time of day.

use std::convert::Infallible;
use std::ops::{Add, Mul, Range, Sub};

use robios_sys::support::purpose;

use crate::Robot;
use crate::robot::support;

/// The robot's random number generator; each number takes a call. Works with `rand` and its distributions
/// (`rand_core::Rng`).
#[derive(Debug)]
pub struct Random<'r>(&'r Robot);

impl<'r> Random<'r> {
    pub(crate) fn new(robot: &'r Robot) -> Self {
        Self(robot)
    }

    /// The next 64 random bits.
    #[track_caller]
    pub fn bits(&self) -> u64 {
        support!(self.0, random(purpose::RUST))
    }

    /// A number in [0, 1), uniformly distributed, with 53 bits.
    #[track_caller]
    pub fn fraction(&self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A quantity in a range, uniformly distributed.
    ///
    /// ```
    /// # use robios_api::prelude::*;
    /// fn draw(robot: &Robot) {
    ///     let turn = robot.random().within(-90.degrees()..90.degrees());
    ///     assert!(turn.abs() <= 90.degrees());
    /// }
    /// # robios_api::fake::Fake::new().run(draw).expect_finished();
    /// ```
    #[track_caller]
    pub fn within<T>(&self, range: Range<T>) -> T
    where
        T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>,
    {
        range.start + (range.end - range.start) * self.fraction()
    }

    /// A uniformly chosen element of a slice; `None` if the slice is empty.
    #[track_caller]
    pub fn choice<'a, T>(&self, elements: &'a [T]) -> Option<&'a T> {
        // 2^64 is not a multiple of most lengths; the resulting error in probability is below 2^-40 for lengths up to
        // 2^24.
        let index = (u128::from(self.bits()) * elements.len() as u128) >> 64;
        elements.get(index as usize)
    }

    /// True or false, with equal probability.
    #[track_caller]
    pub fn flip(&self) -> bool {
        self.bits() >> 63 == 1
    }

    /// Restarts the stream at a position derived from the seed; different robots still get different numbers.
    #[track_caller]
    pub fn seed(&self, seed: u64) {
        let _: i32 = support!(self.0, seed(purpose::RUST, seed));
    }
}

impl rand_core::TryRng for Random<'_> {
    type Error = Infallible;

    #[track_caller]
    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok((self.bits() >> 32) as u32)
    }

    #[track_caller]
    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        Ok(self.bits())
    }

    #[track_caller]
    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(8) {
            chunk.copy_from_slice(&self.bits().to_le_bytes()[..chunk.len()]);
        }
        Ok(())
    }
}
