//! A simulation without programs as an object of Python.

use std::path::PathBuf;
use std::sync::Arc;

use eyesim::plot::{PictureKind, draw_scene};
use pyo3::buffer::{Element, PyBuffer};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use sim_core::build::{Visuals, range_sensors};
use sim_core::camera::Label;
use sim_core::device::camera::Setting;
use sim_core::drive::Command;
use sim_core::pose::{Pose, Twist};
use sim_core::record::Action;
use sim_core::sensor::RangeModel;
use sim_core::simulation::{self, Options};
use sim_core::spec::{ObjectSpec, SceneSpec};
use sim_core::time::Time;
use sim_core::{ObjectId, RobotId};
use sim_format::{MeshReader, Setting as SceneSetting};
use sim_host::files::DiskFiles;
use sim_host::launch::{self, Scene};

use super::error::{error, of_launch, scene_error, warn};

/// Interval of virtual time at which a step checks for an interrupt by the user.
const SIGNAL_INTERVAL: Time = Time::from_millis(10_000);

/// Maximum virtual time that an argument may give, s.
const MAX_SECONDS: f64 = 1e9;

/// A simulation and the scene from which it started.
#[pyclass(module = "eyesim._native")]
pub struct Simulation {
    pub(crate) value: simulation::Simulation,
    pub(crate) scene: Arc<SceneSpec>,
    pub(crate) options: Options,
    has_visuals: bool,
}

#[pymethods]
impl Simulation {
    #[new]
    fn new(
        py: Python<'_>,
        path: PathBuf,
        text: Option<String>,
        seed: Option<u64>,
        noise: Option<String>,
        slot: Option<f64>,
        settings: Vec<String>,
    ) -> PyResult<Self> {
        let slot = slot.map(|slot| length(py, "slot", slot)).transpose()?;
        let settings = parse_settings(py, &settings)?;
        let options = launch::Options { seed, noise, slot, settings, ..launch::Options::default() };
        let opened = py.detach(|| match text {
            Some(text) => Scene::from_text(&path, &text, options),
            None => Scene::open(&path, options),
        });
        let scene = opened.map_err(|failed| of_launch(py, failed))?;
        if scene.is_rejected() {
            return Err(scene_error(py, scene.diagnostics()));
        }
        warn(py, scene.diagnostics())?;
        let options = Options { seed, slot };
        let value = simulation::Simulation::new(scene.spec(), &options).map_err(|failed| error(py, failed))?;
        Ok(Self { value, scene: Arc::new(scene.spec().clone()), options, has_visuals: false })
    }

    /// Current time, s.
    #[getter]
    fn now(&self) -> f64 {
        self.value.now().seconds()
    }

    #[getter]
    fn robot_count(&self) -> usize {
        self.value.robot_count()
    }

    #[getter]
    fn object_count(&self) -> usize {
        self.value.world().object_count()
    }

    #[getter]
    fn digest(&self) -> String {
        self.value.digest().to_string()
    }

    /// Advances by `seconds`.
    fn step(&mut self, py: Python<'_>, seconds: f64) -> PyResult<()> {
        let end = self.value.now().saturating_add(duration(py, "seconds", seconds)?);
        while self.value.now() < end {
            let next = end.min(self.value.now().saturating_add(SIGNAL_INTERVAL));
            py.detach(|| self.value.advance_to(next));
            py.check_signals()?;
        }
        Ok(())
    }

    /// Performs an intervention, given as JSON.
    fn act(&mut self, py: Python<'_>, action: &str) -> PyResult<()> {
        let action: Action = serde_json::from_str(action).map_err(|failed| error(py, failed))?;
        self.value.act(&action).map_err(|failed| error(py, failed))
    }

    fn snapshot(&self, py: Python<'_>) -> Self {
        let Self { value, scene, options, has_visuals } = self;
        let value = py.detach(|| value.clone());
        Self { value, scene: Arc::clone(scene), options: *options, has_visuals: *has_visuals }
    }

    fn restore(&mut self, snapshot: PyRef<'_, Self>) {
        self.value.clone_from(&snapshot.value);
        self.scene = Arc::clone(&snapshot.scene);
        self.options = snapshot.options;
        self.has_visuals = snapshot.has_visuals;
    }

    /// Name of the type of a robot.
    fn robot_name(&self, robot: u32) -> PyResult<String> {
        let id = self.id(robot)?;
        Ok(self.value.robot(id).spec.name.clone())
    }

    /// Maximum speed (m/s) and turning speed (rad/s) of a robot.
    fn limits(&self, robot: u32) -> PyResult<(f64, f64)> {
        let id = self.id(robot)?;
        let spec = &self.value.robot(id).spec;
        Ok((spec.max_speed, spec.max_turn))
    }

    /// Name and range (m) of each range sensor.
    fn range_sensors(&self, robot: u32) -> PyResult<Vec<(String, f64)>> {
        let id = self.id(robot)?;
        let spec = &self.value.robot(id).spec;
        let names = spec.psds.iter().map(|it| &it.name).chain(spec.ranges.iter().map(|it| &it.name));
        Ok(names.cloned().zip(range_sensors(spec).iter().map(|sensor| reach(&sensor.model))).collect())
    }

    /// True pose: x, y (m), heading (rad).
    fn pose(&mut self, robot: u32) -> PyResult<(f64, f64, f64)> {
        let id = self.id(robot)?;
        Ok(planar(&self.value.pose(id)))
    }

    fn odometry(&mut self, robot: u32) -> PyResult<(f64, f64, f64)> {
        let id = self.id(robot)?;
        Ok(planar(&self.value.odometry(id)))
    }

    /// Speed forward and to the left (m/s) and turning speed (rad/s), derived from the wheels.
    fn speed(&mut self, robot: u32) -> PyResult<(f64, f64, f64)> {
        let (id, now) = (self.id(robot)?, self.value.now());
        let Twist { vx, vy, omega } = self.value.with_robot(id, |robot, _| robot.motion.speed(now));
        Ok((vx, vy, omega))
    }

    /// Number of contacts so far, and whether the robot is stalled.
    fn contacts(&mut self, robot: u32) -> PyResult<(u32, bool)> {
        let (id, now) = (self.id(robot)?, self.value.now());
        Ok(self.value.with_robot(id, |robot, _| (robot.motion.contacts(now), robot.motion.is_stalled(now))))
    }

    /// Pose of a movable object.
    fn object_pose(&self, object: u32) -> PyResult<(f64, f64, f64)> {
        let count = self.value.world().object_count();
        if object == 0 || object as usize > count {
            return Err(PyIndexError::new_err(format!("no movable object {object}: the scene has {count}, from 1 on")));
        }
        Ok(planar(&self.value.world().object_pose(ObjectId(object), self.value.now())))
    }

    /// Readings of the range sensors, m; infinite if nothing is within range.
    fn ranges(&mut self, py: Python<'_>, robot: u32, out: PyBuffer<f64>) -> PyResult<()> {
        let id = self.id(robot)?;
        let readings: Vec<f64> =
            (0..range_count(&self.value, id)).map(|index| range(&mut self.value, id, index)).collect();
        fill(py, &out, &readings)
    }

    /// Takes an image of `width` x `height` pixels.
    fn image(&mut self, py: Python<'_>, robot: u32, size: (u32, u32), out: PyBuffer<u8>) -> PyResult<()> {
        let id = self.id(robot)?;
        self.show(py);
        let size = [size.0, size.1];
        let current = self.value.robot(id).devices.camera.setting;
        if current.is_none_or(|setting| setting.size != size) {
            let setting = Setting { size, ..current.unwrap_or_default() };
            self.value.with_robot(id, |robot, _| robot.devices.camera.switch_on(setting));
        }
        let image = py.detach(|| self.value.image(id)).map_err(|failed| error(py, failed))?;
        fill(py, &out, image.pixels().as_flattened())
    }

    /// Depths of the last image, m.
    fn depth(&mut self, py: Python<'_>, robot: u32, out: PyBuffer<f32>) -> PyResult<()> {
        let id = self.id(robot)?;
        let depth = py.detach(|| self.value.depth(id)).map_err(|failed| error(py, failed))?;
        fill(py, &out, depth.pixels())
    }

    /// Labels of the last image: kinds, and numbers within the kind.
    fn labels(&mut self, py: Python<'_>, robot: u32, kinds: PyBuffer<u8>, numbers: PyBuffer<u32>) -> PyResult<()> {
        let id = self.id(robot)?;
        let labels = py.detach(|| self.value.labels(id)).map_err(|failed| error(py, failed))?;
        let pairs = labels.pixels().iter().map(|label| match *label {
            Label::Sky => (0, 0),
            Label::Ground => (1, 0),
            Label::Wall(index) => (2, index),
            Label::Fixed(index) => (3, index),
            Label::Object(id) => (4, id.0),
            Label::Robot(id) => (5, id.0),
        });
        let (of_kind, number): (Vec<u8>, Vec<u32>) = pairs.unzip();
        fill(py, &kinds, &of_kind)?;
        fill(py, &numbers, &number)
    }

    /// Width and height of the last image, in pixels.
    fn image_size(&self, robot: u32) -> PyResult<Option<(u32, u32)>> {
        let id = self.id(robot)?;
        let setting = self.value.robot(id).camera_setting();
        Ok(setting.ok().map(|Setting { size: [width, height], .. }| (width, height)))
    }

    /// Drives at a speed (m/s) and turning speed (rad/s) until the next command.
    fn drive(&mut self, py: Python<'_>, robot: u32, v: f64, omega: f64) -> PyResult<()> {
        self.command(py, robot, Command::Twist(Twist::new(v, omega)))
    }

    /// Drives a straight line, an arc or a turn of this length (m) and angle (rad), in `seconds` or as fast as
    /// possible.
    fn go(&mut self, py: Python<'_>, robot: u32, length: f64, angle: f64, seconds: f64) -> PyResult<()> {
        let displacement = Twist::new(length, angle);
        self.command(py, robot, Command::Drive { displacement, duration: seconds })
    }

    /// Sets the rates of the motors, rad/s.
    fn wheels(&mut self, py: Python<'_>, robot: u32, rates: Vec<f64>) -> PyResult<()> {
        let id = self.id(robot)?;
        let count = self.value.robot(id).motion.model().wheel_count();
        if rates.len() != count {
            return Err(error(py, format!("robot {robot} has {count} motors, not {}", rates.len())));
        }
        let mut wheels = [0.0; 4];
        wheels[..count].copy_from_slice(&rates);
        self.command(py, robot, Command::Wheels(wheels))
    }

    fn halt(&mut self, py: Python<'_>, robot: u32) -> PyResult<()> {
        self.command(py, robot, Command::Halt)
    }

    /// True if the robot's drive has ended.
    fn is_done(&mut self, robot: u32) -> PyResult<bool> {
        let (id, now) = (self.id(robot)?, self.value.now());
        Ok(self.value.with_robot(id, |robot, _| robot.motion.is_drive_done(now)))
    }

    /// The scene from above as SVG, with the robots and objects that are present, at their current poses.
    fn svg(&mut self, py: Python<'_>) -> PyResult<String> {
        let mut scene = SceneSpec::clone(&self.scene);
        let now = self.value.now();
        scene.robots = self.value.roster().robots().to_vec();
        scene.robots.retain(|robot| !self.value.robot(robot.id).is_removed);
        scene.robots.iter_mut().for_each(|robot| robot.start = self.value.pose(robot.id));
        let world = self.value.world();
        let movable = (1..).map(ObjectId).zip(self.value.roster().objects());
        let present = movable.filter(|(id, _)| world.is_object_present(*id, now));
        scene.objects.retain(|object| object.kind.is_fixed);
        scene
            .objects
            .extend(present.map(|(id, object)| ObjectSpec { pose: world.object_pose(id, now), ..object.clone() }));
        let drawn = py.detach(|| {
            let files = DiskFiles::of_environment();
            PictureKind::Svg.render(&draw_scene(&scene, &mut MeshReader::new(&files)), None)
        });
        let bytes = drawn.map_err(|failed| error(py, failed))?;
        String::from_utf8(bytes).map_err(|failed| error(py, failed))
    }
}

impl Simulation {
    fn id(&self, robot: u32) -> PyResult<RobotId> {
        let count = self.value.robot_count();
        if robot == 0 || robot as usize > count {
            return Err(PyIndexError::new_err(format!("no robot {robot}: the scene has {count}, from 1 on")));
        }
        Ok(RobotId(robot))
    }

    fn command(&mut self, py: Python<'_>, robot: u32, command: Command) -> PyResult<()> {
        let id = self.id(robot)?;
        self.value.command(id, command).map_err(|failed| error(py, failed))
    }

    /// Another simulation of the same scene, with this state.
    pub(crate) fn with_value(&self, value: simulation::Simulation) -> Self {
        Self { value, scene: Arc::clone(&self.scene), options: self.options, has_visuals: false }
    }

    /// Builds the scenery for the cameras at the first image.
    fn show(&mut self, py: Python<'_>) {
        if !self.has_visuals {
            let scene = &self.scene;
            let visuals = py.detach(|| Visuals::new(scene, &mut MeshReader::new(&DiskFiles::of_environment())));
            self.value.set_visuals(visuals);
            self.has_visuals = true;
        }
    }
}

/// Number of range sensors of a robot.
pub fn range_count(simulation: &simulation::Simulation, id: RobotId) -> usize {
    let spec = &simulation.robot(id).spec;
    spec.psds.len() + spec.ranges.len()
}

/// Reading of a range sensor, m; infinite if nothing is within range.
pub fn range(simulation: &mut simulation::Simulation, id: RobotId, index: usize) -> f64 {
    simulation.range(id, index).unwrap_or(f64::INFINITY)
}

/// Range of a sensor, m.
pub fn reach(model: &RangeModel) -> f64 {
    match model {
        RangeModel::Psd { range } => *range,
        RangeModel::Laser(echo) | RangeModel::Ultrasonic(echo) | RangeModel::Reflectance(echo) => echo.max,
        RangeModel::Sonar(sonar) => sonar.max,
    }
}

/// Settings of a scene in TOML: `robot[0].x_mm=500`.
pub fn parse_settings(py: Python<'_>, settings: &[String]) -> PyResult<Vec<SceneSetting>> {
    settings.iter().map(|text| SceneSetting::parse(text).map_err(|failed| error(py, failed))).collect()
}

/// A span of virtual time from 0 on, rounded up to a microsecond; `name` is the name of the argument.
pub fn duration(py: Python<'_>, name: &str, seconds: f64) -> PyResult<Time> {
    if !(0.0..=MAX_SECONDS).contains(&seconds) {
        return Err(error(py, format!("{name} = {seconds}: expected 0 to 1e9 seconds")));
    }
    Ok(Time::from_seconds_ceil(seconds))
}

/// A span of virtual time above 0.
pub fn length(py: Python<'_>, name: &str, seconds: f64) -> PyResult<Time> {
    match duration(py, name, seconds)? {
        Time(0) => Err(error(py, format!("{name} = {seconds}: expected more than 0 seconds"))),
        length => Ok(length),
    }
}

/// Copies `values` to a buffer of the same size.
pub fn fill<T: Element>(py: Python<'_>, out: &PyBuffer<T>, values: &[T]) -> PyResult<()> {
    out.copy_from_slice(py, values)
}

fn planar(pose: &Pose) -> (f64, f64, f64) {
    (pose.position.x, pose.position.y, pose.heading.remainder())
}
