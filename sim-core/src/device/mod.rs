//! Device models of a robot, apart from the drive: sensors, servos, camera, keys.
//!
//! A device is copyable state and changes only itself. It reads the published world, queries its robot's motion and
//! servos at an instant, and adds the errors of its noise model. (Queries take `&mut` because they may compute more of
//! the motion.) A device does not record events; [`Robot`](crate::simulation::Robot) does. A device does not know how a
//! program addresses it (handles, numbers, units).

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
use crate::noise::{CompassErrors, Profile};
use crate::spec::RobiSpec;
use crate::time::Time;

/// The devices of one robot. The fields are laid out in this order: those that most readings access come first, side by
/// side.
#[derive(Clone, Debug, Default)]
#[repr(C)]
pub struct Devices {
    /// The driver that measures with range sensors in cycles.
    pub psds: psd::Psds,
    /// Geometry and noise models of the range sensors and the scanner.
    pub ranges: range::Ranges,
    /// Sensors that are switched off.
    pub switches: switch::Switches,
    /// The compass.
    pub compass: compass::Compass,
    /// The scanner with the fan of rays that a program has set; `None` while the settings of the robi apply.
    pub scanner: Option<range::Scanner>,
    /// Encoders of the wheels.
    pub encoders: encoder::Encoders,
    /// Servos.
    pub servos: servo::Servos,
    /// The camera.
    pub camera: camera::Camera,
    /// Presses of the keys below the display and touches of the display.
    pub keys: key::InputQueue,
    /// Presses of the keys of a remote control.
    pub remote: key::InputQueue,
}

impl Devices {
    /// The devices of a robot of this type, without noise models.
    pub fn new(spec: &RobiSpec) -> Self {
        Self { ranges: range::Ranges::new(spec), ..Self::default() }
    }

    /// Replaces the noise models of the devices of `robot` with the models of `profile`, in a run with `seed`.
    pub fn set_errors(&mut self, spec: &RobiSpec, profile: &Profile, seed: u64, robot: RobotId) {
        self.ranges.set_errors(spec, profile, seed, robot);
        self.psds.forget_unread();
        self.camera.set_errors(profile.camera, seed, robot);
        let compass = spec.compass.as_ref();
        self.compass.errors = compass.map(|it| CompassErrors::new(profile.compass, seed, robot, &it.name));
    }

    /// Queues a press of a key, a touch of the display or a press on the remote control at `at`.
    pub fn press(&mut self, at: Time, input: key::UserInput) {
        let queue = if matches!(input, key::UserInput::Remote(_)) { &mut self.remote } else { &mut self.keys };
        queue.press(at, input);
    }

    /// Earliest end of a measurement whose value must be computed at its end, because the world keeps only a short
    /// history; [`Time::NEVER`] if there is no such measurement.
    #[inline]
    pub fn due(&self) -> Time {
        self.psds.due().min(self.compass.due())
    }
}
