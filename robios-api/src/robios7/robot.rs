//! The robot that a program of RoBIOS-7 runs on.

use std::cell::Cell;
use std::time::Duration;

use super::{Audio, Drive, Images, Lcd, Ports, Simulation, TvRemote};
use crate::{Console, Random, Ticker};

/// The robot: every device and service is asked for here.
///
/// A clone is the same robot. It belongs to the thread that runs the program.
#[derive(Clone, Debug)]
pub struct Robot(pub(crate) crate::Robot);

/// What RoBIOS-7 does not tell again.
#[derive(Debug)]
pub(crate) struct State {
    /// The last drive was a turn on the spot.
    pub is_turning: Cell<bool>,
    /// What the laser scanner is set to: angle in degrees, and points.
    pub scan: Cell<(u16, u16)>,
}

impl Default for State {
    fn default() -> Self {
        Self { is_turning: Cell::new(false), scan: Cell::new((360, 360)) }
    }
}

impl Robot {
    pub(crate) fn state(&self) -> &State {
        &self.0.0.robios7
    }

    /// What the program was given on the command line, without the program's own name.
    pub fn arguments(&self) -> &[String] {
        self.0.arguments()
    }

    /// The colour display.
    pub fn lcd(&self) -> Lcd<'_> {
        Lcd(self)
    }

    /// The driving interface.
    pub fn drive(&self) -> Drive<'_> {
        Drive(self)
    }

    /// Images: files and filters.
    pub fn images(&self) -> Images<'_> {
        Images(self)
    }

    /// Loudspeaker and microphone.
    pub fn audio(&self) -> Audio<'_> {
        Audio(self)
    }

    /// Digital and analogue inputs and outputs.
    pub fn ports(&self) -> Ports<'_> {
        Ports(self)
    }

    /// The receiver of a TV remote control.
    pub fn tv_remote(&self) -> TvRemote<'_> {
        TvRemote(self)
    }

    /// Ground truth: what a real robot does not know.
    pub fn simulation(&self) -> Simulation<'_> {
        Simulation(self)
    }

    /// The console of the robot: whole lines, shown and recorded with the robot's name and virtual time.
    pub fn console(&self) -> Console<'_> {
        self.0.console()
    }

    /// The console for what went wrong.
    pub fn console_error(&self) -> Console<'_> {
        self.0.console_error()
    }

    /// The robot's own random numbers.
    pub fn random(&self) -> Random<'_> {
        self.0.random()
    }

    /// Virtual time since the robot's start, in whole microseconds.
    #[track_caller]
    pub fn now(&self) -> Duration {
        self.0.now()
    }

    /// Lets virtual time pass; parts of a microsecond are rounded up.
    #[track_caller]
    pub fn sleep(&self, span: Duration) {
        self.0.sleep(span);
    }

    /// Lets virtual time pass until a time since the robot's start; returns at once if it is past.
    #[track_caller]
    pub fn sleep_until(&self, time: Duration) {
        self.0.sleep_until(time);
    }

    /// For loops that run at regular times: [`Ticker::wait`] waits for the next multiple of the period.
    ///
    /// A period of 0 is taken as 1 us.
    pub fn ticker(&self, period: Duration) -> Ticker {
        self.0.ticker(period)
    }
}
