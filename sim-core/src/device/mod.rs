//! What a robot carries and a program would touch, apart from the drive: models of its devices.
//!
//! A device is state that can be copied. It touches itself and nothing else: it reads the world as published, asks its robot's motion and
//! servos at an instant (mutable only because asking computes), and errs by the noise model that it was given. What it did is recorded
//! by [`Robot`](crate::simulation::Robot).
//! How a program asks for a device, in which numbers and with which handles, is not known here.

pub mod camera;
pub mod compass;
pub mod cycle;
pub mod encoder;
pub mod key;
pub mod level;
pub mod psd;
pub mod range;
pub mod servo;
pub mod switch;

use crate::RobotId;
use crate::noise::{AngleErrors, Profile};
use crate::spec::RobiSpec;
use crate::time::Time;

/// The devices of one robot.
#[derive(Clone, Debug, Default)]
pub struct Devices {
    /// Geometry and errors of range sensors and scanner.
    pub ranges: range::Ranges,
    /// The driver that measures with range sensors in cycles.
    pub psds: psd::Psds,
    /// The scanner, once its fan has been set; else it is as the robi describes it.
    pub scanner: Option<range::Scanner>,
    /// Percentages of the motors' greatest rate.
    pub motor_percent: [i32; 4],
    /// Encoders of the wheels.
    pub encoders: encoder::Encoders,
    /// Servos.
    pub servos: servo::Servos,
    /// The compass.
    pub compass: compass::Compass,
    /// The camera.
    pub camera: camera::Camera,
    /// The keys below the display, and touches of it.
    pub keys: key::Presses,
    /// The keys of a remote control.
    pub remote: key::Presses,
    /// Which sensors are off.
    pub switches: switch::Switches,
}

impl Devices {
    /// The devices of a robot of this type, without errors.
    pub fn new(spec: &RobiSpec) -> Self {
        Self { ranges: range::Ranges::new(spec), ..Self::default() }
    }

    /// Gives them the errors of `profile` on `robot`, in a run with `seed`, in place of those that they have.
    pub fn set_errors(&mut self, spec: &RobiSpec, profile: &Profile, seed: u64, robot: RobotId) {
        self.ranges.set_errors(spec, profile, seed, robot);
        self.camera.set_errors(profile.camera, seed, robot);
        let compass = spec.compass.as_ref();
        self.compass.errors = compass.map(|it| AngleErrors::new(profile.compass, seed, robot, &it.name));
    }

    /// Somebody presses a key, touches the display or uses a remote control at `at`.
    pub fn press(&mut self, at: Time, touch: key::Touch) {
        let presses = if matches!(touch, key::Touch::Remote(_)) { &mut self.remote } else { &mut self.keys };
        presses.press(at, touch);
    }

    /// When a measurement is to be computed next that the world would forget; [`Time::NEVER`] if there is none.
    pub fn due(&self) -> Time {
        self.psds.due().min(self.compass.due())
    }
}
