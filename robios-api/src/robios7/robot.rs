//! The robot that a program of RoBIOS-7 runs on.

use std::cell::Cell;
use std::time::Duration;

use super::{Audio, Drive, Images, Lcd, Ports, Simulation, TvRemote};
use crate::{Console, Layers, Random, Ticker};

/// The robot, from which all devices and services are obtained.
///
/// Clones refer to the same robot. The value belongs to the thread that runs the program.
#[derive(Clone, Debug)]
pub struct Robot(pub(crate) crate::Robot);

/// Settings that cannot be queried from RoBIOS-7.
#[derive(Debug)]
pub(crate) struct DeviceSettings {
    /// True if the last drive was a turn on the spot.
    pub is_turning: Cell<bool>,
    /// Range of the laser scanner, in degrees.
    pub scan_range_deg: Cell<i32>,
}

impl Default for DeviceSettings {
    fn default() -> Self {
        Self { is_turning: Cell::new(false), scan_range_deg: Cell::new(360) }
    }
}

impl Robot {
    pub(crate) fn settings(&self) -> &DeviceSettings {
        &self.0.0.robios7
    }

    /// Command line arguments of the program, without its name.
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

    /// Image files and filters.
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

    /// Layers of the simulator's window, which real robots do not have.
    pub fn layers(&self) -> Layers<'_> {
        self.0.layers()
    }

    /// Ground truth, which a real robot does not know.
    pub fn simulation(&self) -> Simulation<'_> {
        Simulation(self)
    }

    /// The console of the robot: whole lines, shown and recorded with the robot's name and virtual time.
    pub fn console(&self) -> Console<'_> {
        self.0.console()
    }

    /// The console for error messages.
    pub fn console_error(&self) -> Console<'_> {
        self.0.console_error()
    }

    /// The next line of standard input (`--stdin`) without its end; `None` at the end of the input. Use it instead
    /// of `std::io::stdin`.
    #[track_caller]
    pub fn read_line(&self) -> Option<String> {
        self.0.read_line()
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

    /// Sleeps until a virtual time, counted from the robot's start; returns immediately if this time is past.
    #[track_caller]
    pub fn sleep_until(&self, time: Duration) {
        self.0.sleep_until(time);
    }

    /// Ticker for periodic loops: [`Ticker::wait`] waits for the next multiple of the period.
    ///
    /// A period of 0 is taken as 1 us.
    pub fn ticker(&self, period: Duration) -> Ticker {
        self.0.ticker(period)
    }
}
