//! Batch of simulations of one scene; one call steps all of them on several threads.

use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use parking_lot::Mutex;
use pyo3::buffer::{Element, PyBuffer};
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use sim_core::RobotId;
use sim_core::build::range_sensors;
use sim_core::drive::Command;
use sim_core::pose::{Pose, Twist};
use sim_core::simulation::{self, Options};
use sim_core::spec::SceneSpec;
use sim_core::time::Time;

use super::error::error;
use super::simulation::{self as python, length, range, range_count, reach};

/// Number of simulations that a thread takes from the queue at a time.
const ROWS_AT_ONCE: usize = 4;

/// One simulation in a step, the kind of its step, and the speed and turning speed of each robot.
type Row<'a> = (&'a mut Member, StepKind, &'a [f64]);

/// Count of the numbers that follow a robot's ranges: x, y, heading, forward speed, turning speed.
const STATE: usize = 5;

/// Count of a robot's flags: a contact has begun in this step; the robot is stalled.
const FLAGS: usize = 2;

/// Simulations of one scene, side by side. Entry i of a buffer belongs to simulation i.
#[pyclass(module = "eyesim._native")]
pub struct Batch {
    beginnings: Beginnings,
    members: Vec<Member>,
    size: Size,
    workers: Workers,
}

/// Number of robots in each simulation, and number of range sensors of the robot with the most range sensors.
#[derive(Clone, Copy)]
struct Size {
    robots: usize,
    sensors: usize,
}

impl Size {
    /// Count of the numbers observed of a robot.
    fn numbers(self) -> usize {
        self.sensors + STATE
    }
}

/// Initial states of episodes.
struct Beginnings {
    /// Unused copies of the scene; the start poses of its robots are overwritten.
    scenes: Mutex<Vec<SceneSpec>>,
    scene: Arc<SceneSpec>,
    slot: Option<Time>,
    /// Start poses of the robots; if empty, the scene's poses apply.
    starts: Vec<[f64; 3]>,
    /// Maximum deviation of x, y and heading from these poses.
    jitter: [f64; 3],
}

/// A simulation with its episode counters and its last observation.
#[derive(Clone)]
struct Member {
    simulation: simulation::Simulation,
    /// Seed of the simulation.
    root: u64,
    /// Number of episodes begun since the simulation was seeded.
    episodes: u64,
    /// Number of steps of the episode.
    steps: i64,
    /// Ranges and state of each robot.
    numbers: Vec<f64>,
    /// Flags of each robot.
    flags: Vec<u8>,
    /// Number of contacts of each robot in the episode.
    contacts: Vec<u32>,
}

/// Kind of a member's step.
#[derive(Clone, Copy)]
enum StepKind {
    /// The member's robots drive.
    Drive,
    /// The member's next episode begins.
    Begin,
    /// The member does not change.
    Rest,
}

impl StepKind {
    /// The kind of step with this number in a buffer.
    fn of_number(number: u8) -> Result<Self, String> {
        match number {
            0 => Ok(Self::Drive),
            1 => Ok(Self::Begin),
            2 => Ok(Self::Rest),
            other => Err(format!("part {other} of a step: expected 0 (drive), 1 (begin) or 2 (rest)")),
        }
    }
}

/// Threads that step members together with the caller's thread. The threads wait between steps.
struct Workers {
    /// Number of threads, including the caller's.
    threads: usize,
    /// The pool and the process that created it: a child process has none of its threads.
    pool: Option<(u32, ThreadPool)>,
}

impl Workers {
    /// The pool of this process; `None` for one thread.
    fn pool(&mut self) -> Result<Option<&ThreadPool>, String> {
        if self.threads == 1 {
            return Ok(None);
        }
        self.forget_inherited_pool();
        if self.pool.is_none() {
            let named = |index| format!("eyesim-batch-{index}");
            let pool = ThreadPoolBuilder::new().num_threads(self.threads - 1).thread_name(named).build();
            self.pool = Some((std::process::id(), pool.map_err(|failed| format!("no threads for a batch: {failed}"))?));
        }
        Ok(self.pool.as_ref().map(|(_, pool)| pool))
    }

    /// Forgets a pool that the parent process created, without dropping it: its locks may have been held when this
    /// process was forked.
    fn forget_inherited_pool(&mut self) {
        std::mem::forget(self.pool.take_if(|(maker, _)| *maker != std::process::id()));
    }
}

impl Drop for Workers {
    fn drop(&mut self) {
        self.forget_inherited_pool();
    }
}

#[pymethods]
impl Batch {
    #[new]
    fn new(
        py: Python<'_>,
        of: PyRef<'_, python::Simulation>,
        count: usize,
        starts: Vec<[f64; 3]>,
        jitter: [f64; 3],
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let (robots, scene) = (of.value.robot_count(), Arc::clone(&of.scene));
        if robots == 0 || count == 0 {
            return Err(error(py, "a batch needs at least one robot and one simulation"));
        }
        if (1..robots).contains(&starts.len()) {
            return Err(error(
                py,
                format!("{} starts for {robots} robots: expected at least one for each", starts.len()),
            ));
        }
        let sensors = (1..=robots).map(|id| range_count(&of.value, RobotId(id as u32))).max().unwrap_or_default();
        let processors = || thread::available_parallelism().map_or(1, usize::from);
        let size = Size { robots, sensors };
        let member = Member {
            simulation: of.value.clone(),
            root: 0,
            episodes: 0,
            steps: 0,
            numbers: vec![0.0; robots * size.numbers()],
            flags: vec![0; robots * FLAGS],
            contacts: vec![0; robots],
        };
        Ok(Self {
            beginnings: Beginnings { scenes: Mutex::default(), scene, slot: of.options.slot, starts, jitter },
            members: py.detach(|| vec![member; count]),
            size,
            workers: Workers { threads: threads.unwrap_or_else(processors).clamp(1, count), pool: None },
        })
    }

    /// Number of robots of each simulation, and of range sensors of the robot with the most range sensors.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.size.robots, self.size.sensors)
    }

    /// Range of each range sensor of each robot, m; sensors that a robot lacks have range 0.
    fn reach(&self) -> Vec<Vec<f64>> {
        let reach_of = |id: u32| {
            let sensors = range_sensors(&self.members[0].simulation.robot(RobotId(id)).spec);
            let reached = sensors.iter().map(|sensor| reach(&sensor.model)).chain(std::iter::repeat(0.0));
            reached.take(self.size.sensors).collect()
        };
        (1..=self.size.robots as u32).map(reach_of).collect()
    }

    /// Seeds simulation `index`: its next episode is the first one of the seed `root`.
    fn seed(&mut self, py: Python<'_>, index: usize, root: u64) -> PyResult<()> {
        let member = self.members.get_mut(index).ok_or_else(|| missing(py, index))?;
        (member.root, member.episodes) = (root, 0);
        Ok(())
    }

    /// Steps the simulations by `seconds`. The kind of step of each is: 0 drives every robot at its speed and turning
    /// speed in `actions`, 1 begins the next episode instead, 2 changes nothing. Then fills, for each robot, `numbers`
    /// (its ranges, m; x and y, m; heading, rad; forward speed, m/s; turning speed, rad/s) and `flags` (1 if a contact
    /// has begun in this step, 1 if the robot is stalled), and, for each simulation, `steps` (the steps of its
    /// episode).
    #[expect(clippy::too_many_arguments, reason = "one buffer for each kind of number")]
    fn step(
        &mut self,
        py: Python<'_>,
        seconds: f64,
        actions: PyBuffer<f64>,
        parts: PyBuffer<u8>,
        numbers: PyBuffer<f64>,
        flags: PyBuffer<u8>,
        steps: PyBuffer<i64>,
    ) -> PyResult<()> {
        let period = length(py, "seconds", seconds)?;
        let (actions, parts) = (actions.to_vec(py)?, parts.to_vec(py)?);
        let (count, size) = (self.members.len(), self.size);
        if actions.len() != count * size.robots * 2 || parts.len() != count {
            let expected = format!("actions {} numbers, parts {count}", count * size.robots * 2);
            return Err(error(py, format!("buffers of another size: expected {expected}")));
        }
        let parts = parts.into_iter().map(StepKind::of_number).collect::<Result<Vec<_>, _>>();
        let parts = parts.map_err(|failed| error(py, failed))?;
        let Self { beginnings, members, workers, .. } = self;
        let actions = actions.chunks(size.robots * 2);
        let mut rows: Vec<Row<'_>> = members
            .iter_mut()
            .zip(parts)
            .zip(actions)
            .map(|((member, part), actions)| (member, part, actions))
            .collect();
        let step = |(member, part, actions): &mut Row<'_>| member.step(beginnings, *part, actions, period, size);
        // A thread takes a few rows at a time, since rows that begin an episode take longer.
        let (left, failed) = (Mutex::new(rows.chunks_mut(ROWS_AT_ONCE)), Mutex::new(None));
        let work = || {
            let next = || left.lock().next();
            while let Some(some) = next() {
                if let Err(reason) = some.iter_mut().try_for_each(step) {
                    *failed.lock() = Some(reason);
                }
            }
        };
        py.detach(|| {
            match workers.pool()? {
                None => work(),
                Some(pool) => pool.in_place_scope(|scope| {
                    (0..pool.current_num_threads()).for_each(|_| scope.spawn(|_| work()));
                    work();
                }),
            }
            Ok(())
        })
        .map_err(|failed: String| error(py, failed))?;
        if let Some(reason) = failed.into_inner() {
            return Err(error(py, reason));
        }
        fill_from(py, &numbers, self.members.iter().map(|member| &member.numbers[..]))?;
        fill_from(py, &flags, self.members.iter().map(|member| &member.flags[..]))?;
        fill_from(py, &steps, self.members.iter().map(|member| std::slice::from_ref(&member.steps)))
    }

    /// Steps copies of the first simulation by `seconds` on the given number of threads, without Python, for the
    /// wall-clock time `real`. Each step reads the range sensors. The robots drive small circles by one command, or by
    /// a repeated command in each step if `is_commanded`. Returns the number of steps and their wall-clock time, s.
    fn bench(
        &self,
        py: Python<'_>,
        seconds: f64,
        real: f64,
        threads: usize,
        is_commanded: bool,
    ) -> PyResult<(u64, f64)> {
        /// Speed, m/s, and turning speed, rad/s.
        const CIRCLE: [f64; 2] = [0.05, 1.0];
        let period = length(py, "seconds", seconds)?;
        let real = Duration::try_from_secs_f64(real).map_err(|failed| error(py, failed))?;
        let steps_of = || -> Result<u64, String> {
            let mut member = self.members[0].clone();
            let start = Instant::now();
            let actions = CIRCLE.repeat(self.size.robots);
            let mut count = 0;
            while start.elapsed() < real {
                let actions = if count == 0 || is_commanded { &actions[..] } else { &[] };
                member.step(&self.beginnings, StepKind::Drive, actions, period, self.size)?;
                count += 1;
            }
            Ok(count)
        };
        let start = Instant::now();
        let counts = py.detach(|| {
            thread::scope(|scope| {
                let others: Vec<_> = (1..threads.max(1)).map(|_| scope.spawn(steps_of)).collect();
                let join = |other: thread::ScopedJoinHandle<'_, Result<u64, String>>| {
                    other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
                };
                others.into_iter().map(join).fold(steps_of(), |sum, count| Ok(sum? + count?))
            })
        });
        Ok((counts.map_err(|failed| error(py, failed))?, start.elapsed().as_secs_f64()))
    }

    /// Digest of simulation `index`.
    fn digest(&self, py: Python<'_>, index: usize) -> PyResult<String> {
        let member = self.members.get(index).ok_or_else(|| missing(py, index))?;
        Ok(member.simulation.digest().to_string())
    }

    /// Independent copy of simulation `index`.
    fn simulation(
        &self,
        py: Python<'_>,
        index: usize,
        of: PyRef<'_, python::Simulation>,
    ) -> PyResult<python::Simulation> {
        let member = self.members.get(index).ok_or_else(|| missing(py, index))?;
        Ok(of.with_value(member.simulation.clone()))
    }
}

fn missing(py: Python<'_>, index: usize) -> PyErr {
    error(py, format!("no simulation {index}"))
}

/// Fills a buffer with these parts, one after the other.
fn fill_from<'a, T: Element + 'a>(
    py: Python<'_>,
    out: &PyBuffer<T>,
    parts: impl Iterator<Item = &'a [T]>,
) -> PyResult<()> {
    out.copy_from_slice(py, &parts.flatten().copied().collect::<Vec<T>>())
}

/// Seed of an episode: a hash of the user's seed and the number of the episode.
#[pyfunction]
pub fn episode_seed(seed: u64, episode: u64) -> u64 {
    hash("eyesim: seed of an episode", [seed, episode])[0]
}

impl Member {
    /// Makes a step of the kind `part` and observes. `actions` has the speed and turning speed of each robot; robots
    /// without an action keep their speeds.
    fn step(
        &mut self,
        beginnings: &Beginnings,
        part: StepKind,
        actions: &[f64],
        period: Time,
        size: Size,
    ) -> Result<(), String> {
        match part {
            StepKind::Rest => return Ok(()),
            StepKind::Begin => {
                let seed = episode_seed(self.root, self.episodes);
                self.simulation = beginnings.begin(&self.simulation, seed)?;
                self.episodes += 1;
                self.steps = 0;
                self.contacts.fill(0);
            }
            StepKind::Drive => {
                for (action, id) in actions.chunks(2).zip(1..) {
                    let command = Command::Twist(Twist::new(action[0], action[1]));
                    self.simulation.command(RobotId(id), command).map_err(|failed| format!("robot {id}: {failed}"))?;
                }
                self.simulation.advance_to(self.simulation.now().saturating_add(period));
                self.steps += 1;
            }
        }
        self.observe(size);
        Ok(())
    }

    /// Fills the observations of each robot.
    fn observe(&mut self, size: Size) {
        let now = self.simulation.now();
        for (index, numbers) in self.numbers.chunks_mut(size.numbers()).enumerate() {
            let id = RobotId::from_index(index);
            let own = range_count(&self.simulation, id);
            let (readings, state) = numbers.split_at_mut(size.sensors);
            for (sensor, reading) in readings.iter_mut().enumerate() {
                *reading = if sensor < own { range(&mut self.simulation, id, sensor) } else { f64::INFINITY };
            }
            let (contacts, is_stalled) = self.simulation.with_robot(id, |robot, _| {
                let motion = &mut robot.motion;
                let (Pose { position, heading }, speed) = (motion.pose(now), motion.speed(now));
                state.copy_from_slice(&[position.x, position.y, heading.remainder(), speed.vx, speed.omega]);
                (motion.contacts(now), motion.is_stalled(now))
            });
            let before = std::mem::replace(&mut self.contacts[index], contacts);
            let flags = [contacts > before, is_stalled].map(u8::from);
            self.flags[index * FLAGS..(index + 1) * FLAGS].copy_from_slice(&flags);
        }
    }
}

impl Beginnings {
    /// Creates the initial state of the episode with `seed` from the previous simulation.
    fn begin(&self, before: &simulation::Simulation, seed: u64) -> Result<simulation::Simulation, String> {
        let spare = self.scenes.lock().pop();
        let mut scene = spare.unwrap_or_else(|| SceneSpec::clone(&self.scene));
        let of_scene = self.scene.robots.iter().map(|robot| robot.start);
        let first = hash("eyesim: start of an episode", [seed, 0])[0];
        for (index, (robot, start)) in scene.robots.iter_mut().zip(of_scene).enumerate() {
            let [x, y, phi] = match self.starts.len() {
                0 => [start.position.x, start.position.y, start.heading.radians()],
                count => self.starts[((first % count as u64) as usize + index) % count],
            };
            let drawn = hash("eyesim: start of a robot", [seed, index as u64]);
            // Maps 53 bits to a number from -1 to 1.
            let unit = |word: u64| (word >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
            let [dx, dy, dphi] = self.jitter;
            robot.start = Pose::new(x + dx * unit(drawn[0]), y + dy * unit(drawn[1]), phi + dphi * unit(drawn[2]));
        }
        let options = Options { seed: Some(seed), slot: self.slot };
        let begun = before.restarted(&scene, &options).map_err(|failed| failed.to_string());
        self.scenes.lock().push(scene);
        begun
    }
}

/// Four random words, determined by the purpose and by each number.
fn hash(purpose: &str, numbers: [u64; 2]) -> [u64; 4] {
    let mut hasher = blake3::Hasher::new_derive_key(purpose);
    numbers.iter().for_each(|number| {
        hasher.update(&number.to_le_bytes());
    });
    let digest = hasher.finalize();
    let mut words = [0; 4];
    for (word, bytes) in words.iter_mut().zip(digest.as_bytes().chunks(8)) {
        *word = bytes.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte));
    }
    words
}
