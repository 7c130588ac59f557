//! Walks over random floors: scenes from a seed, and what the trace of a walk gives.

use std::fmt::Write as _;
use std::sync::Arc;

use anyhow::{Context as _, ensure};
use glam::{DVec2, DVec3};
use sim_core::RobotId;
use sim_core::build;
use sim_core::noise::{EventStreams, Purpose, Stream};
use sim_core::pose::{Pose, Pose3, link_pose};
use sim_core::scene::HeightField;
use sim_core::spec::RobiSpec;
use sim_core::time::Time;
use sim_core::world::{Ray, World};
use sim_format::load_scene;
use sim_host::files::DiskFiles;
use sim_host::launch::Options;

use super::placement::{LASER, MountPoint, SCENES, SENSORS, true_distance};
use crate::france::walk::{at_time, leg_points, moments, numbers};
use crate::run::{Job, Run, Scene, root};
use crate::trace::{Event, Trace};

/// Length of the walk, m.
pub const WAY: f64 = 8.5;
/// Start of the walk, m.
const START: DVec2 = DVec2::new(1.0, 1.5);
/// Length and width of the floor, m.
const SIZE: DVec2 = DVec2::new(13.0, 3.0);
/// Length of the level floor from the start on, m.
const LEVEL: f64 = 1.0;
/// Depth of the ground below the level floor to which a hole may reach, m.
const DEPTH: f64 = 0.3;
/// Lateral positions of the lines under the feet, m to the left of the body's centre.
pub const LINES: [f64; 2] = [-0.09, 0.09];
/// Number of readings between two postures that are kept for a drawing: half a gait cycle.
const DRAWN: usize = 22;
/// Time between two values of a sensor's noise, as in the simulator.
const NOISE_PERIOD: Time = Time::from_millis(60);
const ROBOT: RobotId = RobotId(1);

/// Kind of floor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Floor {
    /// Ditches across the way: 0.2 to 0.6 m wide, 0.1 to 0.3 m deep, 0.5 to 1.2 m apart.
    Holes,
    /// Stairs up and down across the way: 3 to 5 steps, 0.1 to 0.16 m high and 0.3 to 0.45 m deep.
    Stairs,
    /// Smooth random relief of 0.15 m with hills of 1 m.
    Uneven,
}

impl Floor {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Holes, Self::Stairs, Self::Uneven];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Holes => "holes",
            Self::Stairs => "stairs",
            Self::Uneven => "uneven",
        }
    }

    /// Table `terrain` of a scene with the floor of this seed.
    fn terrain(self, seed: u64) -> String {
        let mut stream = Stream::new(seed, ROBOT, Purpose::Scene, self as u32, 0);
        let mut draw = |low: f64, high: f64| low + (high - low) * stream.unit();
        let mut x = START.x + LEVEL;
        let mut blocks = Vec::new();
        match self {
            Self::Holes => {
                let mut from = 0.0;
                while x < SIZE.x {
                    let (width, depth) = (draw(0.2, 0.6), draw(0.1, DEPTH));
                    blocks.extend([(from, x, DEPTH), (x, x + width, DEPTH - depth)]);
                    from = x + width;
                    x = from + draw(0.5, 1.2);
                }
                blocks.push((from, SIZE.x, DEPTH));
                return steps(&blocks, -DEPTH);
            }
            Self::Stairs => {
                while x < SIZE.x {
                    let (count, rise, depth) = (3.0 + draw(0.0, 3.0).floor(), draw(0.1, 0.16), draw(0.3, 0.45));
                    let (landing, gap) = (draw(0.8, 1.6), draw(0.8, 1.6));
                    let length = 2.0 * (count - 1.0) * depth + landing;
                    for step in 0..count as u32 {
                        let (step, inset) = (f64::from(step) + 1.0, f64::from(step) * depth);
                        blocks.push((x + inset, x + length - inset, step * rise));
                    }
                    x += length + gap;
                }
                return steps(&blocks, 0.0);
            }
            Self::Uneven => {}
        }
        format!(
            "function = \"hills\"\nseed = {seed}\nrelief_mm = 150\nlength_mm = 1000\nclear = [{{ x_mm = {}, y_mm = {}, radius_mm = 500 }}]\n",
            1e3 * START.x,
            1e3 * START.y
        )
    }

    fn scene(self, seed: u64) -> String {
        format!(
            "[scene]\nuntil_s = 20\n\n[world]\nfloor_mm = [{}, {}]\n\n[world.terrain]\n{}\n[[robot]]\n\
             type = \"%sim%/robis/biped.robi\"\nprogram = \"%sim%/example-programs/walker\"\n\
             arguments = [\"tibia\", \"laser\", \"{}\", \"{}\"]\nx_mm = {}\ny_mm = {}\napi = 7\n",
            1e3 * SIZE.x,
            1e3 * SIZE.y,
            self.terrain(seed),
            crate::france::SPEED_MM_S,
            1e3 * WAY,
            1e3 * START.x,
            1e3 * START.y
        )
    }
}

/// Blocks across the whole floor, each from, to and height, m, above ground at `base`.
fn steps(blocks: &[(f64, f64, f64)], base: f64) -> String {
    let mut text = format!("offset_mm = [0, 0, {}]\nblock = [\n", 1e3 * base);
    for (from, to, height) in blocks.iter().filter(|(from, to, height)| from < to && *height > 1e-3) {
        // Writing to a string cannot fail.
        let [from, to, height] = [from, to, height].map(|metres| 1e3 * metres);
        let _ = writeln!(
            text,
            "  {{ from_mm = [{from:.1}, 0], to_mm = [{to:.1}, {}], height_mm = {height:.1} }},",
            1e3 * SIZE.y
        );
    }
    text + "]\n"
}

/// State of the robot at a reading.
#[derive(Clone, Debug)]
pub struct Instant {
    /// Distance of the body's centre from the start, m.
    pub ahead: f64,
    /// Poses of the links and the body that can bear sensors, in the order of [`MountPoint::ALL`].
    pub bearers: [Pose3; MountPoint::ALL.len()],
    /// Noise of each sensor: standard normal values.
    pub noise: [f64; SENSORS],
}

/// A walk over a floor.
pub struct Course {
    /// Kind of floor.
    pub floor: Floor,
    /// The scene's terrain.
    pub field: Arc<HeightField>,
    /// The terrain for rays.
    pub world: World,
    /// State at each reading of the program, in order.
    pub instants: Vec<Instant>,
    /// Distances ahead of the start at which the foot of the right leg came down, m.
    pub footfalls: Vec<f64>,
    /// Lines of both legs at some instants, in the world.
    pub legs: Vec<[Vec<DVec3>; 2]>,
    /// Distance of each point of the program's profile from the true hit, m.
    pub profile_errors: Vec<f64>,
    /// Difference between each reading of the program and the reading computed from the posture in the trace, m.
    pub reading_errors: Vec<f64>,
}

/// Walks over the three floors of each seed, in the order of [`Floor::ALL`].
///
/// # Errors
/// If a scene does not run to its end.
pub fn courses(job: &Job, seeds: &[u64]) -> anyhow::Result<Vec<[Course; 3]>> {
    let cases: Vec<(u64, Floor)> = seeds.iter().flat_map(|seed| Floor::ALL.map(|floor| (*seed, floor))).collect();
    let name = |(seed, floor): &(u64, Floor)| format!("{}-{seed}", floor.name());
    // Short slots, since the trace has the true posture only at a slot's end; nothing else depends on their length.
    let options = Options { slot: Some(Time::from_millis(2)), ..job.options() };
    let run = |case: &(u64, Floor)| {
        let scene = Scene::Text(case.1.scene(case.0));
        Run { name: name(case), scene, options: options.clone() }
    };
    let runs: Vec<Run> = cases.iter().map(run).collect();
    let mut courses = job.run(&runs, |run, trace| {
        let case = cases.iter().find(|case| name(case) == run.name).context("a case")?;
        let path = job.folder().join("runs").join(format!("{}.scene.toml", run.name));
        // A trace is large and is not needed any more.
        std::fs::remove_file(path.with_file_name(format!("{}.jsonl", run.name)))?;
        Course::read(&path, case.0, case.1, &trace)
    })?;
    let mut triples = Vec::new();
    while let Some(uneven) = courses.pop() {
        let (stairs, holes) = (courses.pop(), courses.pop());
        triples.push([holes.context("holes")?, stairs.context("stairs")?, uneven]);
    }
    triples.reverse();
    Ok(triples)
}

impl Course {
    fn read(path: &std::path::Path, seed: u64, floor: Floor, trace: &Trace) -> anyhow::Result<Self> {
        let (mut course, robi) = Self::on(path, floor)?;
        let links = build::links(&robi);
        let moments = moments(trace, Pose::new(START.x, START.y, 0.0));
        let noise = std::array::from_fn::<_, SENSORS, _>(|sensor| {
            EventStreams::new(seed, ROBOT, Purpose::Signal, &format!("{}-{sensor}", floor.name()))
        });
        let times = trace.of_robot(1).filter_map(|entry| match &entry.event {
            Event::Distance { measured_s, .. } => Some(*measured_s),
            _ => None,
        });
        // The program reads its sensor once before it walks, to check that the sensor exists.
        let lines = trace.printed(1).filter_map(|(_, line)| numbers(line));
        for (at, (distance, point)) in times.skip(1).zip(lines) {
            let moment = at_time(&moments, at);
            let world_from_robot = Pose3::from_planar(&moment.pose, moment.lift);
            let bearer = |mount_point: MountPoint| match mount_point.link() {
                Some(link) => world_from_robot.then(&link_pose(&links, &moment.joints, link)),
                None => world_from_robot,
            };
            let cycle = EventStreams::index(Time((1e6 * at).round() as i64), NOISE_PERIOD);
            let instant = Instant {
                ahead: moment.pose.position.x - START.x,
                bearers: MountPoint::ALL.map(bearer),
                noise: noise.each_ref().map(|stream| stream.at(cycle).normal()),
            };
            course.judge_program(&instant, distance, point);
            if course.instants.len().is_multiple_of(DRAWN) {
                course.legs.push([0, 1].map(|leg| leg_points(&robi, &links, leg, &moment)));
            }
            course.instants.push(instant);
        }
        ensure!(!course.instants.is_empty(), "the program has printed no reading");
        let footfalls = trace.of_robot(1).filter_map(|entry| match &entry.event {
            Event::Footfall { leg } if leg == "RIGHT" => Some(entry.at),
            _ => None,
        });
        course.footfalls = footfalls.map(|at| at_time(&moments, at).pose.position.x - START.x).collect();
        Ok(course)
    }

    /// The floor of a scene, without a walk, and the robot's type.
    fn on(path: &std::path::Path, floor: Floor) -> anyhow::Result<(Self, Arc<RobiSpec>)> {
        let mut files = DiskFiles::with_home(root());
        let name = files.name(path);
        let loaded = load_scene(&name, &files);
        ensure!(!loaded.has_errors(), "`{name}` has mistakes: {:?}", loaded.diagnostics);
        let scene = &loaded.scene;
        let slot = Time::from_millis(50);
        let course = Self {
            floor,
            field: Arc::clone(build::height_field(&scene.world).context("a terrain")?),
            world: World::new(build::obstacles(scene), slot, std::iter::empty()).with_space(build::space(scene)),
            instants: Vec::new(),
            footfalls: Vec::new(),
            legs: Vec::new(),
            profile_errors: Vec::new(),
            reading_errors: Vec::new(),
        };
        Ok((course, Arc::clone(&scene.robots.first().context("a robot")?.robi)))
    }

    /// A floor over which the robot's frame glides level, `height` above its start, with all links in that frame.
    #[cfg(test)]
    pub fn gliding(floor: Floor, seed: u64, height: f64) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("floor.scene.toml");
        std::fs::write(&path, floor.scene(seed)).expect("a file");
        let (mut course, _) = Self::on(&path, floor).expect("a scene");
        let instant = |index: i32| {
            let ahead = 0.03 * f64::from(index);
            let position = DVec3::new(START.x + ahead, START.y, height);
            let frame = Pose3 { position, ..Pose3::IDENTITY };
            Instant { ahead, bearers: [frame; MountPoint::ALL.len()], noise: [1.0; SENSORS] }
        };
        course.instants = (0..=(WAY / 0.03) as i32).map(instant).collect();
        course
    }

    /// Compares a reading and its point with the truth.
    fn judge_program(&mut self, instant: &Instant, distance: f64, point: Option<DVec2>) {
        let ray = SCENES.ray(instant);
        if let Some(point) = point {
            let hit = self.world.cast(ROBOT, &Ray::new(ray.position, ray.forward(), 20.0), Time::ZERO);
            let truth = hit.map(|hit| self.ahead(ray.position + ray.forward() * hit.distance));
            self.profile_errors.push(truth.map_or(f64::INFINITY, |truth| (point - truth).length()));
        }
        let from_trace = true_distance(&self.world, &ray, LASER);
        self.reading_errors.push((from_trace.unwrap_or(LASER.max) - distance).abs());
    }

    /// Height of the floor below a line, `ahead` of the start, m.
    pub fn height(&self, ahead: f64, line: f64) -> f64 {
        self.field.height(START.x + ahead, START.y + line)
    }

    /// Projects a point of the world onto the upright plane of the walk: ahead of the start, above the level floor.
    pub fn ahead(&self, point: DVec3) -> DVec2 {
        DVec2::new(point.x - START.x, point.z)
    }
}
