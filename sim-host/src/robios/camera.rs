//! The camera of a robot, for both generations: when it is exposed, from where, and what becomes of what it sees.
//!
//! An image is exposed [`READ_OUT`] before the end of the call that takes it, from where the robot and the servos of the
//! camera stand then; other bodies stand as they were public then. `camera6.rs` and `camera7.rs` give images to programs.
//! Source: RoBIOS 6 and RoBIOS-7 library, camera; Koestler & Bräunl, section 4.1; the time of exposure is our choice.

use std::collections::VecDeque;
use std::f64::consts::TAU;
use std::sync::Arc;

use robios_sys::robios7::{CAM_BODY, CAM_FLOOR, CAM_SKY, CAM_WALL};
use robios_sys::{OutFloats, OutInts};
use sim_core::RobotId;
use sim_core::camera::{Camera as Renderer, Label, Lens, Picture, Scenery, View, ViewError};
use sim_core::drive::HISTORY;
use sim_core::math;
use sim_core::noise::{ImageErrors, Profile};
use sim_core::pose::Pose3;
use sim_core::spec::{CameraSpec, JointSpec, RobiSpec};
use sim_core::time::Time;
use sim_core::unit::mm_from_metres;
use sim_core::world::World;

use super::call::Call;
use super::level::Levels;
use super::picture;
use super::robot::Robot;
use super::truth::{Census, Counted};
use crate::record::frame::{Frame, Frames, Pixels};
use crate::scenery::LazyScenery;
use sim_core::device::servo::Servos;
use sim_core::device::switch::Sensor;
use sim_core::record::{Digest, Event};
use sim_core::simulation::{self, Placeable};

/// How long before the end of its call an image is exposed: what a sensor of 60 images a second takes to hand one over.
/// World and servos remember for longer.
pub const READ_OUT: Time = Time(16_667);

/// The size of images where no program has set any: that of `QVGA`.
pub const DEFAULT_SIZE: [u32; 2] = [320, 240];

/// The camera among the devices of its robot, whose errors are drawn by this name.
pub use sim_core::device::switch::CAMERA as NAME;

/// The camera of a robot.
#[derive(Default)]
pub struct Camera {
    scenery: Arc<LazyScenery>,
    /// Where all images and scans go that programs take, if the user wants them.
    pub(super) frames: Option<Arc<Frames>>,
    /// `None` where images are exact.
    errors: Option<Box<ImageErrors>>,
    /// While it is switched on.
    pub(super) setting: Option<Setting>,
    /// Images taken so far.
    taken: u64,
    /// When those were exposed that were taken lately, in order.
    exposed: VecDeque<Time>,
    /// The last one since it was switched on.
    last: Option<Exposure>,
    renderer: Box<Renderer>,
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
struct Exposure {
    number: u64,
    at: Time,
    view: View,
    scenery: Arc<Scenery>,
    poses: Vec<Option<Pose3>>,
    /// The camera was switched off by a hand: the image is black, and nothing of it is known.
    is_dark: bool,
}

/// Why there is no image.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoImage {
    /// The robot, whose robi file this is, has no camera.
    #[error(
        "`{0}` has no camera; its line in a robi file is `camera X Y Z PAN TILT`, its table in a companion `[camera]`"
    )]
    NoCamera(String),
    /// It is not switched on.
    #[error("the camera is off until `CAMInit`")]
    Off,
    /// There is nowhere to put it.
    #[error("it takes room for the image")]
    Null,
    /// No image has been taken to which depths and labels could belong.
    #[error("it tells of the image that was taken last, and there is none since `CAMInit`")]
    NotTaken,
    /// No camera can look from there.
    #[error(transparent)]
    View(#[from] ViewError),
}

impl Camera {
    /// Gives this camera the errors of `profile` on `robot`, in a run with `seed`.
    pub fn set_errors(&mut self, profile: &Profile, seed: u64, robot: RobotId) {
        self.errors = Some(Box::new(ImageErrors::new(profile.camera, seed, robot, NAME)));
    }

    /// This camera in a run that looks so; what programs take goes to `frames` too.
    pub fn in_run(self, scenery: Arc<LazyScenery>, frames: Option<Arc<Frames>>) -> Self {
        Self { scenery, frames, ..self }
    }

    /// Switches it on, or sets it anew.
    pub(super) fn switch_on(&mut self, setting: Setting) {
        self.setting = Some(setting);
        self.last = None;
    }

    /// Switches it off; false if it was off.
    pub(super) fn switch_off(&mut self) -> bool {
        self.last = None;
        self.setting.take().is_some()
    }

    /// What lens and sensor make of a picture as image `number`: blur and noise.
    fn err<const CHANNELS: usize>(&self, number: u64, picture: &mut Picture<[u8; CHANNELS]>) {
        if let Some(errors) = &self.errors {
            errors.expose(number, picture.size()[0] as usize, picture.pixels_mut());
        }
    }

    /// Number of an image that is exposed at `at`.
    fn number_at(&self, at: Time) -> u64 {
        self.taken + 1 - self.exposed.iter().filter(|exposed| **exposed >= at).count() as u64
    }
}

/// The setting of a robot's camera that is switched on.
///
/// # Errors
/// [`NoImage`] if it is off, or there is none.
pub(super) fn setting(robot: &Robot) -> Result<Setting, NoImage> {
    match (&robot.spec.camera, robot.robios.camera.setting) {
        (None, _) => Err(NoImage::NoCamera(robot.spec.file.clone())),
        (Some(_), None) => Err(NoImage::Off),
        (Some(_), Some(setting)) => Ok(setting),
    }
}

/// Takes a colour image.
pub(super) fn take_colour(robot: &mut Robot, world: &World) -> Result<Picture<[u8; 3]>, NoImage> {
    let (exposure, mut picture) = expose(robot, world, setting(robot)?.size)?;
    develop(robot, exposure.number, &mut picture);
    follow(robot, &picture::grey_of_colour(picture.pixels().as_flattened()));
    keep(robot, exposure, picture.size(), Pixels::Colour(picture.pixels().as_flattened()));
    Ok(picture)
}

/// Takes a grey image: the mean of red, green and blue, rounded down.
pub(super) fn take_grey(robot: &mut Robot, world: &World) -> Result<Picture<[u8; 1]>, NoImage> {
    let Setting { size, levels, .. } = setting(robot)?;
    let (exposure, picture) = expose(robot, world, size)?;
    let grey = picture::grey_of_colour(picture.pixels().as_flattened());
    let mut picture = Picture::new(size, grey.into_iter().map(|level| [level]).collect());
    levels.grey(picture.pixels_mut());
    robot.robios.camera.err(exposure.number, &mut picture);
    follow(robot, picture.pixels().as_flattened());
    keep(robot, exposure, size, Pixels::Grey(picture.pixels().as_flattened()));
    Ok(picture)
}

/// Takes an image of `size` behind the colour filter of the sensor: rows of green and blue, and of red and green, in turn.
pub(super) fn take_bayer(robot: &mut Robot, world: &World, size: [u32; 2]) -> Result<Vec<u8>, NoImage> {
    setting(robot)?;
    let (exposure, mut picture) = expose(robot, world, size)?;
    develop(robot, exposure.number, &mut picture);
    let filtered = |(row, pixels): (usize, &[[u8; 3]])| -> Vec<u8> {
        let channels = if row.is_multiple_of(2) { [1, 2] } else { [0, 1] };
        pixels.iter().zip(channels.into_iter().cycle()).map(|(pixel, channel)| pixel[channel]).collect()
    };
    let levels: Vec<u8> = picture.rows().enumerate().flat_map(filtered).collect();
    follow(robot, &levels);
    keep(robot, exposure, size, Pixels::Bayer(&levels));
    Ok(levels)
}

/// How far away what each pixel of the last image shows is, mm along the line of sight; infinite for the sky.
fn take_depth(robot: &mut Robot) -> Result<Vec<f32>, NoImage> {
    setting(robot)?;
    let Camera { last, renderer, .. } = &mut robot.robios.camera;
    let Exposure { view, scenery, poses, is_dark, .. } = last.as_ref().ok_or(NoImage::NotTaken)?;
    let depth = renderer.depth(&scenery.standing(poses.clone()), view, Some(robot.state.id));
    let (size, mut depth) = (view.size(), mm_of_depth(&depth));
    if *is_dark {
        depth.fill(f32::INFINITY);
    }
    tell(robot, size, Pixels::Depth(&depth));
    Ok(depth)
}

/// The number of what each pixel of the last image shows.
fn take_labels(robot: &mut Robot) -> Result<Vec<i32>, NoImage> {
    setting(robot)?;
    let Camera { last, renderer, .. } = &mut robot.robios.camera;
    let Exposure { view, scenery, poses, is_dark, .. } = last.as_ref().ok_or(NoImage::NotTaken)?;
    let labels = renderer.labels(&scenery.standing(poses.clone()), view, Some(robot.state.id));
    let (size, mut labels) = (view.size(), numbers_of_labels(&labels, &robot.robios.census));
    if *is_dark {
        labels.fill(CAM_SKY);
    }
    tell(robot, size, Pixels::Labels(&labels));
    Ok(labels)
}

/// `CAMGetDepth` of either generation.
pub(super) fn give_depth(robot: &mut Robot, call: impl Into<Call>, failure: i32, mm: &mut OutFloats) -> i32 {
    let depth = if mm.is_null() { Err(NoImage::Null) } else { take_depth(robot) };
    match depth {
        Ok(depth) => {
            mm.set(&depth);
            0
        }
        Err(why) => refused(robot, call, failure, &why),
    }
}

/// `CAMGetLabels` of either generation.
pub(super) fn give_labels(robot: &mut Robot, call: impl Into<Call>, failure: i32, numbers: &mut OutInts) -> i32 {
    let labels = if numbers.is_null() { Err(NoImage::Null) } else { take_labels(robot) };
    match labels {
        Ok(labels) => {
            numbers.set(&labels);
            0
        }
        Err(why) => refused(robot, call, failure, &why),
    }
}

/// The answer of a call that gives no image.
pub(super) fn refused(robot: &mut Robot, call: impl Into<Call>, answer: i32, why: &NoImage) -> i32 {
    robot.refused(call, answer, |_| why.to_string())
}

/// Where the robot's camera looks at `at`, as it is set, or as it would be when it is switched on; its images have `size`.
///
/// # Errors
/// [`NoImage`] if there is no camera, or no camera can look from there.
pub fn view(robot: &mut Robot, at: Time, size: Option<[u32; 2]>) -> Result<View, NoImage> {
    let simulation::Robot { motion, spec, devices, .. } = &mut robot.state;
    let camera = spec.camera.as_ref().ok_or_else(|| NoImage::NoCamera(spec.file.clone()))?;
    let setting = robot.robios.camera.setting.unwrap_or_default();
    let robot_from_camera = mount(spec, camera, &devices.servos, at);
    let world_from_camera = Pose3::from_planar(&motion.pose(at), motion.lift(at)).then(&robot_from_camera);
    Ok(View::new(world_from_camera, zoomed(camera.lens, setting.zoom), size.unwrap_or(setting.size))?)
}

/// Pose of the camera of a robot of this type in the robot's frame, as its servos hold it just before `at`.
pub fn mount(spec: &RobiSpec, camera: &CameraSpec, servos: &Servos, at: Time) -> Pose3 {
    let [pan, tilt] = [&camera.pan, &camera.tilt].map(|joint| angle(joint, spec, servos, at));
    Pose3::from_angles(camera.position, 0.0, tilt, pan)
}

/// Rays per side of a pixel.
pub fn samples(robot: &Robot) -> u32 {
    robot.spec.camera.as_ref().map_or(1, |camera| camera.samples)
}

/// Makes of what the robot's camera sees at `at` the image that a program gets: levels as they are set, blur and noise.
pub fn develop_at(robot: &Robot, at: Time, picture: &mut Picture<[u8; 3]>) {
    develop(robot, robot.robios.camera.number_at(at), picture);
}

/// Depths in metres as programs get them, in mm.
pub fn mm_of_depth(depth: &Picture<f32>) -> Vec<f32> {
    depth.pixels().iter().map(|metres| mm_from_metres(f64::from(*metres)) as f32).collect()
}

/// Labels as programs get them; bodies by their numbers among all robots and objects.
pub fn numbers_of_labels(labels: &Picture<Label>, census: &Census) -> Vec<i32> {
    // Movable objects count on their own.
    let movable: Vec<usize> =
        (0..census.objects.len()).filter(|place| matches!(census.objects[*place], Counted::Movable(_))).collect();
    let object = |place: usize| CAM_BODY + (census.robots + 1 + place) as i32;
    let newcomer = |who: Placeable| CAM_BODY + census.number_of_newcomer(who).unwrap_or_default();
    let number = |label: &Label| match label {
        Label::Sky => CAM_SKY,
        Label::Ground => CAM_FLOOR,
        Label::Wall(_) => CAM_WALL,
        Label::Fixed(place) => object(*place as usize),
        Label::Object(id) => match movable.get(id.index()) {
            Some(place) => object(*place),
            None => newcomer(Placeable::Object(*id)),
        },
        Label::Robot(id) if id.index() < census.robots => CAM_BODY + id.0 as i32,
        Label::Robot(id) => newcomer(Placeable::Robot(*id)),
    };
    labels.pixels().iter().map(number).collect()
}

/// Exposes an image of `size`, which is the next one.
fn expose(robot: &mut Robot, world: &World, size: [u32; 2]) -> Result<(Exposure, Picture<[u8; 3]>), NoImage> {
    let at = (robot.now - READ_OUT).max(Time::ZERO);
    let [view, exposed] = [view(robot, at, None)?, view(robot, at, Some(size))?];
    let samples = samples(robot);
    let is_dark = !robot.devices.switches.is_on(Sensor::Camera);
    let Camera { scenery, renderer, taken, .. } = &mut robot.robios.camera;
    let scenery = scenery.get();
    let still = scenery.still(world, at);
    let mut picture = renderer.colour(&still, &exposed, Some(robot.state.id), samples);
    if is_dark {
        picture.pixels_mut().fill([0; 3]);
    }
    let poses = still.poses().to_vec();
    Ok((Exposure { number: *taken + 1, at, view, scenery, poses, is_dark }, picture))
}

/// Makes of what the camera sees image `number`.
fn develop(robot: &Robot, number: u64, picture: &mut Picture<[u8; 3]>) {
    let camera = &robot.robios.camera;
    camera.setting.unwrap_or_default().levels.colour(picture.pixels_mut());
    camera.err(number, picture);
}

/// Lets an automatic brightness follow an image with these levels.
fn follow(robot: &mut Robot, levels: &[u8]) {
    if let Some(setting) = &mut robot.robios.camera.setting {
        let sum: u64 = levels.iter().map(|level| u64::from(*level)).sum();
        setting.levels.follow(sum as f64 / levels.len().max(1) as f64);
    }
}

/// Counts an image that has been taken, and records it.
fn keep(robot: &mut Robot, exposure: Exposure, size: [u32; 2], pixels: Pixels<'_>) {
    let Camera { taken, exposed, last, .. } = &mut robot.robios.camera;
    *taken = exposure.number;
    while exposed.front().is_some_and(|oldest| *oldest + HISTORY < exposure.at) {
        exposed.pop_front();
    }
    exposed.push_back(exposure.at);
    *last = Some(exposure);
    tell(robot, size, pixels);
}

/// Records the last image, or what it shows.
fn tell(robot: &mut Robot, size: [u32; 2], pixels: Pixels<'_>) {
    let Robot { state, robios, .. } = robot;
    let simulation::Robot { id, now, journal, .. } = state;
    let Camera { last, frames, .. } = &robios.camera;
    let Some(Exposure { number, at, .. }) = last else { return };
    let hash = Digest(*blake3::hash(&pixels.bytes()).as_bytes()).to_string();
    let [width_px, height_px] = size;
    let exposed_s = at.seconds();
    let event = Event::Frame { frame: *number, form: pixels.form(), width_px, height_px, exposed_s, hash: &hash };
    journal.record(*now, &event);
    if let Some(frames) = frames {
        frames.write(*id, &Frame { number: *number, exposed: *at, size, pixels });
    }
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
fn zoomed(lens: Lens, zoom: f64) -> Lens {
    match lens {
        Lens::Pinhole { fov } if zoom != 1.0 => Lens::Pinhole { fov: 2.0 * math::atan(math::tan(0.5 * fov) / zoom) },
        Lens::Fisheye { fov } => Lens::Fisheye { fov: (fov / zoom).min(TAU) },
        lens => lens,
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use sim_core::ObjectId;
    use sim_core::build;
    use sim_core::drive::{Command, Motion};
    use sim_core::pose::{Pose, Twist};
    use sim_format::read_robi;

    use super::super::{Robios, key, servo};
    use super::*;

    /// A robot at (1, 0.5) that looks along y, with a camera 100 mm ahead of it, 50 mm to its left and 200 mm high.
    fn bench() -> (Robot, World) {
        let robi = "name Rover\ndiameter 200\nspeed 5000\nturn 720\nwheel 100 3600 1000 100\n\
                    drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n\
                    camera 100 50 200 SERVO1(-90,90) SERVO2(-45,45) 80 60\n";
        let (spec, _) = read_robi("rover.robi", robi);
        let walls = Arc::new(sim_core::scene::Walls::new(Vec::new()));
        let model = Arc::new(build::model(&spec));
        let mut motion = Motion::new(RobotId(1), model, walls.clone(), Pose::new(1.0, 0.5, FRAC_PI_2));
        let world = World::new(walls, Time::from_millis(100_000), [&mut motion]);
        let robios = Robios::new(&spec, key::Keys::default());
        let state = simulation::Robot::new(motion, Arc::new(spec), Time::ZERO, 0, false);
        (Robot::new(state, robios, "test".to_owned()), world)
    }

    #[test]
    fn an_image_is_exposed_where_the_robot_was_a_sixtieth_of_a_second_ago() {
        let (mut robot, world) = bench();
        robot.robios.camera.switch_on(Setting::default());
        robot.command(&world, Command::Twist(Twist::new(3.0, 0.0))).expect("it drives");
        robot.now = Time(100_000 + READ_OUT.0);
        take_colour(&mut robot, &world).expect("an image");
        let exposure = robot.robios.camera.last.clone().expect("the last image");
        assert_eq!((exposure.number, exposure.at), (1, Time(100_000)));
        // 300 mm on, and the camera ahead and to the left: x to the right, so left is -x.
        let place = exposure.view.world_from_camera().position;
        assert!((place - glam::DVec3::new(0.95, 0.9, 0.2)).length() < 1e-12, "{place}");
        robot.now = Time(10);
        let (early, _) = expose(&mut robot, &world, [8, 6]).expect("an image");
        assert_eq!(early.at, Time::ZERO, "nothing was before");
    }

    #[test]
    fn servos_turn_the_camera() {
        let (mut robot, world) = bench();
        robot.now = Time(200_000);
        let ahead = |robot: &mut Robot, at| view(robot, at, None).expect("a view").world_from_camera().forward();
        servo::turn(&mut robot, &world, 0, 255);
        servo::turn(&mut robot, &world, 1, 0);
        let before = ahead(&mut robot, Time(200_000));
        assert!((before - glam::DVec3::Y).length() < 1e-12, "not yet: {before}");
        // Pan to the left of y is -x; 45 degrees downwards.
        let after = ahead(&mut robot, Time(200_001));
        let expected = glam::DVec3::new(-1.0, 0.0, -1.0) * 0.5_f64.sqrt();
        assert!((after - expected).length() < 1e-12, "{after}");
    }

    #[test]
    fn an_image_has_the_number_that_it_had() {
        let (mut robot, world) = bench();
        robot.robios.camera.switch_on(Setting { size: [8, 6], ..Setting::default() });
        for at in [100_000, 200_000, 900_000] {
            robot.now = Time(at) + READ_OUT;
            take_grey(&mut robot, &world).expect("an image");
        }
        let camera = &robot.robios.camera;
        let numbers = [850_000, 900_000, 900_001].map(|at| camera.number_at(Time(at)));
        assert_eq!(numbers, [3, 3, 4]);
        assert_eq!(camera.exposed.len(), 1, "what is long ago is forgotten");
    }

    #[test]
    fn without_a_camera_or_an_image_there_is_a_reason() {
        let (mut robot, world) = bench();
        assert_eq!(take_colour(&mut robot, &world).err(), Some(NoImage::Off));
        robot.robios.camera.switch_on(Setting::default());
        assert_eq!(take_depth(&mut robot).err(), Some(NoImage::NotTaken));
        take_grey(&mut robot, &world).expect("an image");
        assert_eq!(take_depth(&mut robot).map(|depth| depth.len()), Ok(320 * 240));
        robot.robios.camera.switch_on(Setting::default());
        assert_eq!(take_labels(&mut robot).err(), Some(NoImage::NotTaken), "a new start");
        assert!(robot.robios.camera.switch_off() && !robot.robios.camera.switch_off());
    }

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

    #[test]
    fn bodies_have_their_numbers() {
        let objects = vec![
            Counted::Movable(ObjectId(1)),
            Counted::Fixed(sim_core::pose::Pose::default()),
            Counted::Movable(ObjectId(2)),
        ];
        let census = Census { robots: 2, objects, ..Census::default() };
        let labels = [
            Label::Sky,
            Label::Ground,
            Label::Wall(7),
            Label::Robot(RobotId(2)),
            Label::Object(ObjectId(1)),
            Label::Fixed(1),
            Label::Object(ObjectId(2)),
        ];
        let picture = Picture::new([7, 1], labels.to_vec());
        assert_eq!(numbers_of_labels(&picture, &census), [0, 1, 2, 12, 13, 14, 15]);
    }
}
