//! Camera of a robot: settings, instant and pose of each exposure, and errors of lens and sensor.
//!
//! An image is exposed [`READ_OUT`] before it is available. It shows the scene from the camera's pose at the exposure,
//! with the published poses of other bodies at that instant. Source: Koestler & Bräunl, section 4.1; the instant of
//! exposure is our choice.

use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::sync::Arc;

use super::level::Levels;
use super::servo::Servos;
use crate::RobotId;
use crate::camera::{Camera as Renderer, Lens, Picture, PosedScenery, Scenery, View, ViewError};
use crate::drive::HISTORY;
use crate::math;
use crate::noise::{ImageErrors, ImageNoise};
use crate::pose::Pose3;
use crate::spec::{CameraSpec, JointSpec, RobiSpec};
use crate::time::Time;

/// Delay from exposure to image: the read-out time of a sensor with 60 images per second. The delay is shorter than the
/// history of world and servos.
pub const READ_OUT: Time = Time(16_667);

/// Default width and height of images, in pixels.
pub const DEFAULT_SIZE: [u32; 2] = [320, 240];

/// The camera of a robot.
#[derive(Clone, Debug, Default)]
pub struct Camera {
    /// Settings; `None` while the camera is switched off.
    pub setting: Option<Setting>,
    /// `None` if images are exact.
    errors: Option<Box<ImageErrors>>,
    /// Number of images taken so far.
    image_count: u64,
    /// Instants of exposure of the latest images, in order.
    exposed: VecDeque<Time>,
    /// Last exposure since the last [`Camera::switch_on`]; `None` if there is none or the camera is off.
    last: Option<Arc<Exposure>>,
    workspace: Workspace,
}

/// Settings of a camera that is switched on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Width and height of the images in pixels.
    pub size: [u32; 2],
    /// Magnification relative to the lens that the robi describes.
    pub zoom: f64,
    /// Brightness, hue and other adjustments of the pixel levels.
    pub levels: Levels,
}

impl Default for Setting {
    fn default() -> Self {
        Self { size: DEFAULT_SIZE, zoom: 1.0, levels: Levels::default() }
    }
}

/// One exposure: its instant, its view, and the poses of all bodies.
#[derive(Clone, Debug)]
pub struct Exposure {
    /// Number of the image, counted per camera from 1.
    pub number: u64,
    /// Instant of the exposure.
    pub at: Time,
    /// Pose and lens of the camera, with the image size that was set.
    pub view: View,
    pub(crate) scenery: Arc<Scenery>,
    pub(crate) poses: Vec<Option<Pose3>>,
    /// True if an intervention has switched the camera off: the image is black, depths are infinite, and all labels are
    /// sky.
    pub(crate) is_dark: bool,
}

/// Reason why there is no image.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CameraError {
    /// The robot's type, described by this file, has no camera.
    #[error("`{0}` has no camera")]
    Absent(String),
    /// The camera is not switched on.
    #[error("the camera is switched off")]
    Off,
    /// No image has been taken yet, so there are no depths and labels.
    #[error("no image has been taken since the camera was switched on")]
    NotTaken,
    /// The simulation has no scenery.
    #[error("the simulation has no scenery: `Simulation::set_visuals` gives it one")]
    NoScenery,
    /// The renderer does not accept the view.
    #[error(transparent)]
    View(#[from] ViewError),
}

/// Buffers of the renderer. They are not part of the state, so a clone starts without them.
#[derive(Debug, Default)]
struct Workspace(Option<Box<Renderer>>);

impl Clone for Workspace {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Camera {
    /// Sets the noise model of the camera of `robot`, in a run with `seed`.
    pub fn set_errors(&mut self, model: ImageNoise, seed: u64, robot: RobotId) {
        let errors = || Box::new(ImageErrors::new(model, seed, robot, super::switch::CAMERA));
        self.errors = (model != ImageNoise::default()).then(errors);
    }

    /// Switches the camera on, or replaces its settings.
    pub fn switch_on(&mut self, setting: Setting) {
        self.setting = Some(setting);
        self.last = None;
    }

    /// Switches the camera off; returns false if it was off.
    pub fn switch_off(&mut self) -> bool {
        self.last = None;
        self.setting.take().is_some()
    }

    /// Last exposure since the last [`Camera::switch_on`]; `None` if there is none or the camera is off.
    pub fn last(&self) -> Option<&Exposure> {
        self.last.as_deref()
    }

    /// Number of an image exposed at `at`.
    pub fn number_at(&self, at: Time) -> u64 {
        self.image_count + 1 - self.exposed.iter().filter(|exposed| **exposed >= at).count() as u64
    }

    /// Adds blur and noise of image `number` to a picture.
    pub(crate) fn add_errors<const CHANNELS: usize>(&self, number: u64, picture: &mut Picture<[u8; CHANNELS]>) {
        if let Some(errors) = &self.errors {
            errors.expose(number, picture.size()[0] as usize, picture.pixels_mut());
        }
    }

    /// Turns a rendered picture into image `number`: applies the level settings, blur and noise.
    pub fn develop(&self, number: u64, picture: &mut Picture<[u8; 3]>) {
        self.setting.unwrap_or_default().levels.colour(picture.pixels_mut());
        self.add_errors(number, picture);
    }

    /// Adapts the automatic brightness to an image with these grey levels.
    pub(crate) fn adapt_brightness(&mut self, levels: &[u8]) {
        if let Some(setting) = &mut self.setting {
            let sum: u64 = levels.iter().map(|level| u64::from(*level)).sum();
            setting.levels.adapt_brightness(sum as f64 / levels.len().max(1) as f64);
        }
    }

    /// Records an image that has been taken: counts the image and stores its exposure as the last one.
    pub(crate) fn record(&mut self, exposure: Exposure) {
        self.image_count = exposure.number;
        while self.exposed.front().is_some_and(|oldest| *oldest + HISTORY < exposure.at) {
            self.exposed.pop_front();
        }
        self.exposed.push_back(exposure.at);
        self.last = Some(Arc::new(exposure));
    }

    /// The camera's renderer, created on first use.
    pub(crate) fn renderer(&mut self) -> &mut Renderer {
        self.workspace.0.get_or_insert_default()
    }

    /// Renders the last exposure with `render`; all pixels are `dark` if an intervention had switched the camera off.
    ///
    /// # Errors
    /// [`CameraError::NotTaken`].
    pub(crate) fn render_last<T: Copy>(
        &mut self,
        dark: T,
        render: impl FnOnce(&mut Renderer, &PosedScenery<'_>, &View) -> Picture<T>,
    ) -> Result<Picture<T>, CameraError> {
        let exposure = Arc::clone(self.last.as_ref().ok_or(CameraError::NotTaken)?);
        let posed = exposure.scenery.with_poses(exposure.poses.clone());
        let mut picture = render(self.renderer(), &posed, &exposure.view);
        if exposure.is_dark {
            picture.pixels_mut().fill(dark);
        }
        Ok(picture)
    }
}

/// Grey level: the mean of red, green and blue, rounded down.
pub fn grey([red, green, blue]: [u8; 3]) -> u8 {
    ((u32::from(red) + u32::from(green) + u32::from(blue)) / 3) as u8
}

/// Pose of the camera in the robot's frame, with the servo angles just before `at`.
pub fn mount(spec: &RobiSpec, camera: &CameraSpec, servos: &Servos, at: Time) -> Pose3 {
    let [pan, tilt] = [&camera.pan, &camera.tilt].map(|joint| angle(joint, spec, servos, at));
    Pose3::from_angles(camera.position, 0.0, tilt, pan)
}

/// Angle of a joint just before `at`.
fn angle(joint: &JointSpec, spec: &RobiSpec, servos: &Servos, at: Time) -> f64 {
    match joint {
        JointSpec::Fixed(angle) => *angle,
        JointSpec::Servo { name, from, to } => {
            let refs = spec.all_servos();
            let index = refs.iter().position(|servo| servo.name == name);
            index.map_or(0.5 * (from + to), |index| servos.angle_before(index, refs[index].swing, at))
        }
    }
}

/// Lens of the same kind with `zoom` times the magnification.
pub(crate) fn zoomed(lens: Lens, zoom: f64) -> Lens {
    match lens {
        Lens::Pinhole { fov } if zoom != 1.0 => Lens::Pinhole { fov: 2.0 * math::atan(math::tan(0.5 * fov) / zoom) },
        Lens::Fisheye { fov } => Lens::Fisheye { fov: (fov / zoom).min(TAU) },
        lens => lens,
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    #[test]
    fn twice_the_zoom_doubles_the_size_in_the_image() {
        let tangent = |lens: Lens| match lens {
            Lens::Pinhole { fov } => math::tan(0.5 * fov),
            Lens::Fisheye { fov } => 0.5 * fov,
        };
        for lens in [Lens::Pinhole { fov: FRAC_PI_2 }, Lens::Fisheye { fov: 2.0 }] {
            assert_eq!(zoomed(lens, 1.0), lens);
            assert!((tangent(zoomed(lens, 2.0)) - 0.5 * tangent(lens)).abs() < 1e-15);
            assert!((tangent(zoomed(lens, 0.5)) - 2.0 * tangent(lens)).abs() < 1e-15);
        }
        assert_eq!(
            zoomed(Lens::Fisheye { fov: 1.5 * PI }, 0.5),
            Lens::Fisheye { fov: TAU },
            "a full turn is the maximum"
        );
    }
}
