//! The camera: how it is set, when and from where an image is exposed, and what lens and sensor make of it.
//!
//! An image is exposed [`READ_OUT`] before it is there, from where the robot and the servos of the camera stand then; other bodies
//! stand as they were public then. Source: Koestler & Bräunl, section 4.1; the time of exposure is our choice.

use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::sync::Arc;

use super::level::Levels;
use super::servo::Servos;
use crate::RobotId;
use crate::camera::{Camera as Renderer, Lens, Picture, Scenery, Still, View, ViewError};
use crate::drive::HISTORY;
use crate::math;
use crate::noise::{Image, ImageErrors};
use crate::pose::Pose3;
use crate::spec::{CameraSpec, JointSpec, RobiSpec};
use crate::time::Time;

/// How long after its exposure an image is there: what a sensor of 60 images a second takes to hand one over. World and servos
/// remember for longer.
pub const READ_OUT: Time = Time(16_667);

/// Width and height of images, in pixels, where nobody has set any.
pub const DEFAULT_SIZE: [u32; 2] = [320, 240];

/// The camera of a robot.
#[derive(Clone, Debug, Default)]
pub struct Camera {
    /// While it is switched on.
    pub setting: Option<Setting>,
    /// `None` where images are exact.
    errors: Option<Box<ImageErrors>>,
    /// Images taken so far.
    taken: u64,
    /// When those were exposed that were taken lately, in order.
    exposed: VecDeque<Time>,
    /// The last one since it was switched on.
    last: Option<Arc<Exposure>>,
    workspace: Workspace,
}

/// How a camera is set that is switched on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Width and height of its images in pixels.
    pub size: [u32; 2],
    /// How much larger things are in the image than through the lens that the robi describes.
    pub zoom: f64,
    /// What becomes of the levels of its pixels.
    pub levels: Levels,
}

impl Default for Setting {
    fn default() -> Self {
        Self { size: DEFAULT_SIZE, zoom: 1.0, levels: Levels::default() }
    }
}

/// When and from where an image was exposed, and where all else stood.
#[derive(Clone, Debug)]
pub struct Exposure {
    /// Number of the image among those of its camera, from 1.
    pub number: u64,
    /// When it was exposed.
    pub at: Time,
    /// From where, with the size that the camera was set to.
    pub view: View,
    pub(crate) scenery: Arc<Scenery>,
    pub(crate) poses: Vec<Option<Pose3>>,
    /// The camera was switched off by an intervention: the image is black, and nothing of it is known.
    pub(crate) is_dark: bool,
}

/// Why there is no image.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CameraError {
    /// The type of the robot, which this file describes, has no camera.
    #[error("`{0}` has no camera")]
    Absent(String),
    /// It is not switched on.
    #[error("the camera is switched off")]
    Off,
    /// No image has been taken to which depths and labels could belong.
    #[error("no image has been taken since the camera was switched on")]
    NotTaken,
    /// Nobody has said what cameras see.
    #[error("the simulation has no scenery: `Simulation::set_visuals` gives it one")]
    NoScenery,
    /// No camera can look from there.
    #[error(transparent)]
    View(#[from] ViewError),
}

/// Memory of the renderer, which is no part of the state: a copy begins without any.
#[derive(Debug, Default)]
struct Workspace(Option<Box<Renderer>>);

impl Clone for Workspace {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Camera {
    /// Gives it the errors of `model` on `robot`, in a run with `seed`.
    pub fn set_errors(&mut self, model: Image, seed: u64, robot: RobotId) {
        let errors = || Box::new(ImageErrors::new(model, seed, robot, super::switch::CAMERA));
        self.errors = (model != Image::default()).then(errors);
    }

    /// Switches it on, or sets it anew.
    pub fn switch_on(&mut self, setting: Setting) {
        self.setting = Some(setting);
        self.last = None;
    }

    /// Switches it off; false if it was off.
    pub fn switch_off(&mut self) -> bool {
        self.last = None;
        self.setting.take().is_some()
    }

    /// The last exposure since it was switched on.
    pub fn last(&self) -> Option<&Exposure> {
        self.last.as_deref()
    }

    /// Number of an image that is exposed at `at`.
    pub fn number_at(&self, at: Time) -> u64 {
        self.taken + 1 - self.exposed.iter().filter(|exposed| **exposed >= at).count() as u64
    }

    /// What lens and sensor make of a picture as image `number`: blur and noise.
    pub(crate) fn err<const CHANNELS: usize>(&self, number: u64, picture: &mut Picture<[u8; CHANNELS]>) {
        if let Some(errors) = &self.errors {
            errors.expose(number, picture.size()[0] as usize, picture.pixels_mut());
        }
    }

    /// Makes of what it sees image `number`: levels as they are set, blur and noise.
    pub fn develop(&self, number: u64, picture: &mut Picture<[u8; 3]>) {
        self.setting.unwrap_or_default().levels.colour(picture.pixels_mut());
        self.err(number, picture);
    }

    /// Lets an automatic brightness follow an image with these levels.
    pub(crate) fn follow(&mut self, levels: &[u8]) {
        if let Some(setting) = &mut self.setting {
            let sum: u64 = levels.iter().map(|level| u64::from(*level)).sum();
            setting.levels.follow(sum as f64 / levels.len().max(1) as f64);
        }
    }

    /// Counts an image that has been taken.
    pub(crate) fn keep(&mut self, exposure: Exposure) {
        self.taken = exposure.number;
        while self.exposed.front().is_some_and(|oldest| *oldest + HISTORY < exposure.at) {
            self.exposed.pop_front();
        }
        self.exposed.push_back(exposure.at);
        self.last = Some(Arc::new(exposure));
    }

    /// Its renderer.
    pub(crate) fn renderer(&mut self) -> &mut Renderer {
        self.workspace.0.get_or_insert_default()
    }

    /// What `render` makes of the last exposure; `nothing` everywhere where the camera was dark.
    ///
    /// # Errors
    /// [`CameraError::NotTaken`].
    pub(crate) fn render_last<T: Copy>(
        &mut self,
        nothing: T,
        render: impl FnOnce(&mut Renderer, &Still<'_>, &View) -> Picture<T>,
    ) -> Result<Picture<T>, CameraError> {
        let exposure = Arc::clone(self.last.as_ref().ok_or(CameraError::NotTaken)?);
        let still = exposure.scenery.standing(exposure.poses.clone());
        let mut picture = render(self.renderer(), &still, &exposure.view);
        if exposure.is_dark {
            picture.pixels_mut().fill(nothing);
        }
        Ok(picture)
    }
}

/// Grey as the mean of red, green and blue, rounded down.
pub fn grey(rgb: [u8; 3]) -> u8 {
    (rgb.into_iter().map(u32::from).sum::<u32>() / 3) as u8
}

/// Pose of the camera of a robot of this type in the robot's frame, as its servos hold it just before `at`.
pub fn mount(spec: &RobiSpec, camera: &CameraSpec, servos: &Servos, at: Time) -> Pose3 {
    let [pan, tilt] = [&camera.pan, &camera.tilt].map(|joint| angle(joint, spec, servos, at));
    Pose3::from_angles(camera.position, 0.0, tilt, pan)
}

/// Angle of a joint just before `at`.
fn angle(joint: &JointSpec, spec: &RobiSpec, servos: &Servos, at: Time) -> f64 {
    match joint {
        JointSpec::Fixed(angle) => *angle,
        JointSpec::Servo { name, from, to } => {
            let all = spec.all_servos();
            let place = all.iter().position(|servo| servo.name == name);
            place.map_or(0.5 * (from + to), |place| servos.angle_before(place, all[place].swing, at))
        }
    }
}

/// A lens of the same kind in whose image things are `zoom` times as large.
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
    fn twice_the_zoom_is_twice_the_size() {
        let tangent = |lens: Lens| match lens {
            Lens::Pinhole { fov } => math::tan(0.5 * fov),
            Lens::Fisheye { fov } => 0.5 * fov,
        };
        for lens in [Lens::Pinhole { fov: FRAC_PI_2 }, Lens::Fisheye { fov: 2.0 }] {
            assert_eq!(zoomed(lens, 1.0), lens);
            assert!((tangent(zoomed(lens, 2.0)) - 0.5 * tangent(lens)).abs() < 1e-15);
            assert!((tangent(zoomed(lens, 0.5)) - 2.0 * tangent(lens)).abs() < 1e-15);
        }
        assert_eq!(zoomed(Lens::Fisheye { fov: 1.5 * PI }, 0.5), Lens::Fisheye { fov: TAU }, "all around is most");
    }
}
