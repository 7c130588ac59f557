//! One walk of the biped over a floor: its steps, and what a sensor anywhere on the robot reads on it.
//!
//! The biped walks straight on whatever its sensors see, so a single run tells what every sensor would read: the pose of a sensor follows from
//! the posture of the trace, its reading from the simulator's own sensor and noise model.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::sync::Arc;

use anyhow::{Context as _, ensure};
use glam::{DVec2, DVec3};
use sim_core::RobotId;
use sim_core::build;
use sim_core::noise::{Events, Profile, RangeErrors, RangeKind};
use sim_core::pose::{Link, Pose, Pose3, link_pose};
use sim_core::scene::Ground;
use sim_core::sensor::{Echo, FRANCE_1999_SIGMA, RangeModel};
use sim_core::spec::RobiSpec;
use sim_core::time::Time;
use sim_core::world::World;
use sim_format::load_scene;
use sim_host::files::DiskFiles;
use sim_host::launch::Options;

use super::floors::Floor;
use super::walk::{Moment, at_time, leg_points, moments};
use crate::run::{Job, Run, Scene, root};
use crate::trace::{Event, Trace};

/// The robot's number.
const ROBOT: u32 = 1;
/// Period of the gait, s: `robis/biped.toml`.
pub const PERIOD: f64 = 1.1;
/// Time between two readings, s, as in the program `walker`.
const READ_EVERY: f64 = 0.025;
/// Interval in which a sensor keeps its noise: see `docs/noise.md`.
const CYCLE: Time = Time::from_millis(60);
/// Time after a footfall at which the foot is flat, as a fraction of the cycle: between 12 and 26 % in the curves of the gait.
const FLAT: f64 = 0.2;
/// Distance between two places at which heights are compared, m.
const SPACING: f64 = 0.02;
/// Length of ground behind and ahead of that which a step needs, of which points are kept, m.
const AROUND: f64 = 0.3;
/// Minimum advance of a step that counts, m: the last one of a walk is shorter.
const MIN_ADVANCE: f64 = 0.3;

/// Part of the robot that bears a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The body above the hips.
    Body,
    /// Thigh of a leg.
    Thigh(usize),
    /// Shank of a leg.
    Shank(usize),
    /// Foot of a leg.
    Foot(usize),
}

/// Legs by index.
const LEGS: [&str; 2] = ["LEFT", "RIGHT"];
/// The right leg.
pub const RIGHT: usize = 1;

impl Part {
    /// Name, as in the companion of a robi and in the words of the program `walker`.
    pub fn name(self) -> String {
        match self {
            Self::Body => "body".to_owned(),
            Self::Thigh(leg) => format!("{}.thigh", LEGS[leg]),
            Self::Shank(leg) => format!("{}.shank", LEGS[leg]),
            Self::Foot(leg) => format!("{}.foot", LEGS[leg]),
        }
    }

    /// Index in the frames of an [`Instant`].
    fn index(self) -> usize {
        match self {
            Self::Body => 0,
            Self::Thigh(leg) => 1 + 3 * leg,
            Self::Shank(leg) => 2 + 3 * leg,
            Self::Foot(leg) => 3 + 3 * leg,
        }
    }
}

/// Place and direction of a laser range finder on the robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mount {
    /// The part.
    pub part: Part,
    /// Place along the part, as a fraction: from the upper joint to the lower one, from heel to toe, from the hips to the shoulders.
    pub place: f64,
    /// Elevation of the beam above the part's x axis, degrees.
    pub elevation: f64,
}

impl Mount {
    /// Place on the part, whole mm ahead and up in its frame. Sensors sit in front of the part, as those of `robis/biped.toml`.
    pub fn offset_mm(&self, robi: &RobiSpec) -> [f64; 2] {
        let leg = |leg: usize| robi.legs.as_ref().and_then(|legs| legs.legs.get(leg)).expect("a biped");
        let offset = match self.part {
            Part::Body => [120.0, 900.0 + 600.0 * self.place],
            Part::Thigh(number) => [70.0, -1e3 * leg(number).thigh * self.place],
            Part::Shank(number) => [50.0, -1e3 * leg(number).shank * self.place],
            Part::Foot(number) => {
                let foot = leg(number).foot.expect("a foot");
                [1e3 * (self.place * (foot.heel + foot.toe) - foot.heel), -500.0 * foot.height]
            }
        };
        offset.map(f64::round)
    }

    /// Name of the sensor, on which its noise depends.
    pub fn device(&self, robi: &RobiSpec) -> String {
        let [x, z] = self.offset_mm(robi);
        let text = format!("{}_{x}_{z}_{}", self.part.name(), self.elevation);
        text.to_uppercase().replace(['.', '-'], "_")
    }

    /// Table of a companion, with the number `id`.
    pub fn companion(&self, robi: &RobiSpec, id: usize) -> String {
        let [x, z] = self.offset_mm(robi);
        let mut text = format!("\n[[laser]]\nname = \"{}\"\nid = {id}\n", self.device(robi));
        if self.part != Part::Body {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "on = \"{}\"", self.part.name());
        }
        let _ = writeln!(text, "x_mm = {x}\nz_mm = {z}\npitch_deg = {}", self.elevation);
        text
    }

    /// The sensor in the words of the program `walker`.
    pub fn word(&self, robi: &RobiSpec, id: usize) -> String {
        let [x, z] = self.offset_mm(robi);
        format!("{id}:{}:{x}:{z}:{}", self.part.name(), self.elevation)
    }

    /// The mount in words.
    pub fn words(&self) -> String {
        format!("{} {:.0} % {:+}°", self.part.name(), 100.0 * self.place, self.elevation)
    }

    /// Pose on the part.
    fn pose(&self, robi: &RobiSpec) -> Pose3 {
        let [x, z] = self.offset_mm(robi);
        Pose3::from_angles(DVec3::new(x / 1e3, 0.0, z / 1e3), 0.0, self.elevation / 180.0 * PI, 0.0)
    }
}

/// An instant at which sensors are read.
struct Instant {
    at: f64,
    /// Distance from the start by odometry, m.
    odometry: f64,
    /// Frames of body, thigh, shank and foot of the left leg, then of the right one: in the world, and in the frame that the robot knows.
    frames: [[Pose3; 2]; 7],
}

/// A sensor of this walk.
struct Sensor {
    /// Index of its part in the frames of an [`Instant`].
    frame: usize,
    /// Its pose on the part.
    pose: Pose3,
    errors: RangeErrors,
}

/// A reading that met something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading {
    /// Time, s.
    pub at: f64,
    /// Distance that was read, m.
    pub distance: f64,
    /// Point as the robot computes it (section 6.2), ahead of its start by odometry and above the floor, m.
    pub point: DVec2,
    /// The sensor, ahead of the true start and above the floor, m.
    pub from: DVec2,
    /// End of its beam at the distance read.
    pub to: DVec2,
}

/// A step of a foot, and the ground that it needs.
pub struct Step {
    /// Time at which the ground must be known, s: the footfall of the other foot, a tenth of a cycle before this foot lifts off.
    pub at: f64,
    /// Places of the compared heights: from the toe of the standing foot to that of the next foothold, m ahead of the start.
    pub xs: Vec<f64>,
    /// True heights at these places, along the line of the foot, m.
    pub truth: Vec<f64>,
    /// Heel and toe of the standing foot, m ahead of the start.
    pub stand: [f64; 2],
    /// Height under the standing foot, m.
    pub stand_height: f64,
    /// Ankle over the next foothold, m ahead of the start.
    pub foothold: f64,
    /// Odometry minus truth at that time, m.
    pub shift: f64,
}

/// A walk over a floor.
pub struct Crossing {
    /// The floor.
    pub floor: Floor,
    /// The robot.
    pub robi: Arc<RobiSpec>,
    /// Its links.
    pub links: Vec<Link>,
    /// Its true motion.
    pub moments: Vec<Moment>,
    /// Its steps after the first cycle.
    pub steps: Vec<Step>,
    /// Whole gait cycles of the right leg.
    pub cycles: usize,
    /// Touches of thighs and shanks.
    pub touches: usize,
    start: Pose,
    world: World,
    ground: Arc<Ground>,
    noise: Profile,
    instants: Vec<Instant>,
    odometry: Vec<(f64, f64)>,
}

/// Walks over floors with a preset of noise; `each` makes of a walk what is kept of it.
///
/// # Errors
/// A scene that does not run to its end.
pub fn cross<T: Send>(
    job: &Job,
    floors: &[Floor],
    noise: &str,
    speed: u32,
    each: impl Fn(Crossing) -> T + Sync,
) -> anyhow::Result<Vec<T>> {
    let run = |floor: &Floor| {
        let name = format!("floor-{noise}-{}", floor.seed);
        let scene = Scene::Text(floor.scene("%sim%/robis/biped.robi", speed, &[]));
        Run { name, scene, options: options(floor, noise) }
    };
    let runs: Vec<Run> = floors.iter().map(run).collect();
    job.run(&runs, |run, trace| {
        let index = runs.iter().position(|other| other.name == run.name).context("a run of these")?;
        Ok(each(Crossing::new(job, &run.name, floors[index].clone(), noise, &trace)?))
    })
}

/// Options of a walk: short slots, since the trace has the true posture only at a slot's end; nothing else depends on them.
pub fn options(floor: &Floor, noise: &str) -> Options {
    let slot = Some(Time::from_millis(2));
    Options { seed: Some(floor.seed), slot, noise: Some(noise.to_owned()), ..Options::default() }
}

impl Crossing {
    /// Reads the trace of the run `name`.
    ///
    /// # Errors
    /// A trace without postures, odometry or steps.
    pub fn new(job: &Job, name: &str, floor: Floor, noise: &str, trace: &Trace) -> anyhow::Result<Self> {
        let mut files = DiskFiles::with_home(root());
        let path = files.name(&job.folder().join("runs").join(format!("{name}.scene.toml")));
        let loaded = load_scene(&path, &files);
        ensure!(!loaded.has_errors(), "`{path}` has mistakes: {:?}", loaded.diagnostics);
        let scene = &loaded.scene;
        let robot = scene.robots.first().context("it has no robot")?;
        let slot = Time::from_millis(50);
        let moments = moments(trace, robot.start);
        let odometry: Vec<(f64, f64)> = trace
            .of_robot(ROBOT)
            .filter_map(|entry| match entry.event {
                Event::Odometry { x_m, .. } => Some((entry.at, x_m)),
                _ => None,
            })
            .collect();
        ensure!(moments.len() > 1 && odometry.len() > 1, "the trace has no postures or no odometry");
        let mut crossing = Self {
            floor,
            robi: Arc::clone(&robot.robi),
            links: build::links(&robot.robi),
            moments,
            steps: Vec::new(),
            cycles: 0,
            touches: trace.entries.iter().filter(|entry| matches!(entry.event, Event::Touch)).count(),
            start: robot.start,
            world: World::new(build::obstacles(scene), slot, std::iter::empty()).with_space(build::space(scene)),
            ground: build::ground(&scene.world),
            noise: sim_format::preset(noise).context("a preset of noise")?.profile(),
            instants: Vec::new(),
            odometry,
        };
        crossing.instants = crossing.read_instants();
        (crossing.steps, crossing.cycles) = crossing.find_steps(trace)?;
        Ok(crossing)
    }

    /// Pose and posture at a time.
    pub fn at_time(&self, at: f64) -> Moment {
        at_time(&self.moments, at)
    }

    /// Distance from the start by odometry at a time, m: linear between two readings of the program.
    fn odometry_at(&self, at: f64) -> f64 {
        let next = self.odometry.partition_point(|(time, _)| *time <= at).clamp(1, self.odometry.len() - 1);
        let ((t0, x0), (t1, x1)) = (self.odometry[next - 1], self.odometry[next]);
        x0 + (x1 - x0) * if t1 > t0 { ((at - t0) / (t1 - t0)).clamp(0.0, 1.0) } else { 0.0 }
    }

    fn instant(&self, at: f64) -> Instant {
        let moment = self.at_time(at);
        let bases = [Pose3::from_planar(&moment.pose, moment.lift), Pose3::from_planar(&Pose::default(), moment.lift)];
        let each = self.links.len() / 2;
        let frames = std::array::from_fn(|part| {
            if part == 0 {
                return bases;
            }
            let (leg, link) = ((part - 1) / 3, (part - 1) % 3);
            let pose = link_pose(&self.links, &moment.joints, leg * each + each - 3 + link);
            bases.map(|base| base.then(&pose))
        });
        Instant { at, odometry: self.odometry_at(at), frames }
    }

    fn read_instants(&self) -> Vec<Instant> {
        let end = self.odometry[self.odometry.len() - 1].0;
        (1..).map(|index| f64::from(index) * READ_EVERY).take_while(|at| *at < end).map(|at| self.instant(at)).collect()
    }

    /// Ground along the way, m: height at a distance ahead of the start, `left` of its line.
    pub fn height(&self, x: f64, left: f64) -> f64 {
        self.ground.height(self.start.position + DVec2::new(x, left))
    }

    /// Projects a point of the world onto the upright plane of the walk: ahead of the start, above the floor.
    pub fn ahead(&self, point: DVec3) -> DVec2 {
        DVec2::new(point.x - self.start.position.x, point.z)
    }

    /// The steps after the first cycle, and the number of whole cycles of the right leg.
    fn find_steps(&self, trace: &Trace) -> anyhow::Result<(Vec<Step>, usize)> {
        let names: Vec<&str> =
            self.robi.legs.iter().flat_map(|legs| &legs.legs).map(|leg| leg.name.text.as_str()).collect();
        let foot = self.robi.legs.as_ref().and_then(|legs| legs.legs.first()?.foot).context("no feet")?;
        let end = self.odometry[self.odometry.len() - 1].0;
        let falls: Vec<(f64, usize)> = trace
            .of_robot(ROBOT)
            .filter(|entry| entry.at <= end)
            .filter_map(|entry| match &entry.event {
                Event::Footfall { leg } => Some((entry.at, names.iter().position(|name| name == leg)?)),
                _ => None,
            })
            .collect();
        let first = falls.first().context("no steps")?.0;
        let ankle = |(at, leg): (f64, usize)| -> anyhow::Result<DVec3> {
            let points = leg_points(&self.robi, &self.links, leg, &self.at_time(at + FLAT * PERIOD));
            points.get(2).copied().context("no ankle")
        };
        let mut steps = Vec::new();
        for pair in falls.windows(2) {
            let [stands, lands] = [pair[0], pair[1]];
            if stands.1 == lands.1 || stands.0 < first + PERIOD {
                continue;
            }
            let (stand, landing) = (ankle(stands)?, ankle(lands)?);
            let [stand_x, foothold] = [stand, landing].map(|point| self.ahead(point).x);
            if foothold - stand_x < MIN_ADVANCE {
                continue;
            }
            let left = landing.y - self.start.position.y;
            let count = ((foothold - stand_x) / SPACING).floor() as usize;
            let xs: Vec<f64> = (0..=count).map(|index| stand_x + foot.toe + index as f64 * SPACING).collect();
            steps.push(Step {
                at: stands.0,
                truth: xs.iter().map(|x| self.height(*x, left)).collect(),
                xs,
                stand: [stand_x - foot.heel, stand_x + foot.toe],
                stand_height: self.height(stand_x, stand.y - self.start.position.y),
                foothold,
                shift: self.odometry_at(stands.0) - (self.at_time(stands.0).pose.position.x - self.start.position.x),
            });
        }
        let rights = falls.iter().filter(|(_, leg)| *leg == RIGHT).count();
        ensure!(!steps.is_empty(), "no steps after the first cycle");
        Ok((steps, rights.saturating_sub(1)))
    }

    /// What a laser range finder at a mount reads, at the instants of the program, without the readings that meet nothing.
    pub fn readings(&self, mount: &Mount) -> Vec<Reading> {
        let sensor = self.sensor(mount);
        self.instants.iter().filter_map(|instant| self.read(&sensor, instant)).collect()
    }

    /// What it reads at any time.
    pub fn reading_at(&self, mount: &Mount, at: f64) -> Option<Reading> {
        self.read(&self.sensor(mount), &self.instant(at))
    }

    fn sensor(&self, mount: &Mount) -> Sensor {
        let name = mount.device(&self.robi);
        let noise = self.noise.range(RangeKind::Laser, &name);
        Sensor {
            frame: mount.part.index(),
            pose: mount.pose(&self.robi),
            errors: RangeErrors::new(noise, self.floor.seed, RobotId(ROBOT), &name),
        }
    }

    fn read(&self, sensor: &Sensor, instant: &Instant) -> Option<Reading> {
        let [world_from_sensor, known_from_sensor] = instant.frames[sensor.frame].map(|frame| frame.then(&sensor.pose));
        let model = RangeModel::Laser(Echo::LASER);
        let time = Time::from_seconds_ceil(instant.at - 1e-9);
        let event = Events::index(time, CYCLE);
        let own = sensor.errors.own(event, FRANCE_1999_SIGMA, 0.0);
        let exact = model.read(&self.world, RobotId(ROBOT), &world_from_sensor, Time::ZERO, own);
        let reading = sensor.errors.reading_of(event, time, &model, exact);
        let distance = reading.distance.filter(|distance| reading.signal > 0.0 && *distance < Echo::LASER.max)?;
        let end = |pose: &Pose3| pose.position + pose.forward() * distance;
        let point = end(&known_from_sensor);
        Some(Reading {
            at: instant.at,
            distance,
            point: DVec2::new(instant.odometry + point.x, point.z),
            from: self.ahead(world_from_sensor.position),
            to: self.ahead(end(&world_from_sensor)),
        })
    }

    /// Points of a sensor that each step knows, of the ground around that which it needs, in the last `memory` seconds before it.
    pub fn sightings(&self, readings: &[Reading], memory: f64) -> Vec<Vec<DVec2>> {
        let of = |step: &Step| {
            let [low, high] = [step.xs[0] - AROUND, step.xs[step.xs.len() - 1] + AROUND].map(|x| x + step.shift);
            let is_known = |reading: &&Reading| reading.at <= step.at && reading.at >= step.at - memory;
            let points = readings.iter().filter(is_known).map(|reading| reading.point);
            points.filter(|point| (low..=high).contains(&point.x)).collect()
        };
        self.steps.iter().map(of).collect()
    }
}
