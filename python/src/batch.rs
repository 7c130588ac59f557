//! Many simulations of one scene, which one call steps on all cores.

use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use parking_lot::Mutex;
use pyo3::buffer::PyBuffer;
use pyo3::prelude::*;
use sim_core::RobotId;
use sim_core::build::range_sensors;
use sim_core::drive::Command;
use sim_core::pose::{Pose, Twist};
use sim_core::simulation::{self, Options};
use sim_core::spec::SceneSpec;
use sim_core::time::Time;

use super::error::error;
use super::simulation::{self as python, fill, length, range, range_count, reach};

/// Simulations that a thread takes at a time.
const ROWS_AT_ONCE: usize = 4;

/// Numbers of a robot in the state: x, y, heading, speed ahead, turning speed, contacts so far, 1 if stalled.
const STATE: usize = 7;

/// Simulations of one scene, side by side. Entry i of a buffer belongs to simulation i.
#[pyclass(module = "eyesim._native")]
pub struct Batch {
    episodes: Episodes,
    simulations: Vec<simulation::Simulation>,
    robots: usize,
    /// Range sensors of the robot that has most.
    sensors: usize,
    threads: usize,
    ranges: Vec<f64>,
    state: Vec<f64>,
}

/// Beginnings of episodes.
struct Episodes {
    scene: Arc<SceneSpec>,
    slot: Option<Time>,
    /// Poses at which robots begin; empty: those of the scene.
    starts: Vec<[f64; 3]>,
    /// Greatest deviation from these poses.
    jitter: [f64; 3],
}

/// One simulation's part of a step.
struct Row<'a> {
    simulation: &'a mut simulation::Simulation,
    part: Part<'a>,
    ranges: &'a mut [f64],
    state: &'a mut [f64],
}

/// What happens to a simulation in a step.
enum Part<'a> {
    /// Its robots drive with these speeds and turning speeds.
    Drive(&'a [f64]),
    /// The episode of this seed begins.
    Begin(u64),
    /// It stays as it is.
    Rest,
}

impl<'a> Part<'a> {
    /// The part with this number in a buffer.
    fn of_number(number: u8, actions: &'a [f64], seed: u64) -> Result<Self, String> {
        match number {
            0 => Ok(Self::Drive(actions)),
            1 => Ok(Self::Begin(seed)),
            2 => Ok(Self::Rest),
            other => Err(format!("part {other} of a step: expected 0 (drive), 1 (begin) or 2 (rest)")),
        }
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
        let value = &of.value;
        let simulations = py.detach(|| vec![value.clone(); count]);
        Ok(Self {
            episodes: Episodes { scene, slot: of.options.slot, starts, jitter },
            simulations,
            robots,
            sensors,
            threads: threads.unwrap_or_else(processors).clamp(1, count),
            ranges: vec![0.0; count * robots * sensors],
            state: vec![0.0; count * robots * STATE],
        })
    }

    /// Number of robots of each simulation, and of range sensors of each robot.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.robots, self.sensors)
    }

    /// Range of each range sensor of each robot, m; sensors that a robot lacks have range 0.
    fn reach(&self) -> Vec<Vec<f64>> {
        let reach_of = |id: u32| {
            let sensors = range_sensors(&self.simulations[0].robot(RobotId(id)).spec);
            let reached = sensors.iter().map(|sensor| reach(&sensor.model)).chain(std::iter::repeat(0.0));
            reached.take(self.sensors).collect()
        };
        (1..=self.robots as u32).map(reach_of).collect()
    }

    /// Steps the simulations by `seconds`, each with its part (see `Part`): 0 drives every robot as its two numbers of `actions` say, 1
    /// begins the episode of its seed instead, 2 leaves it as it is. Then `ranges` and `state` are filled.
    #[expect(clippy::too_many_arguments, reason = "one buffer for each kind of number")]
    fn step(
        &mut self,
        py: Python<'_>,
        seconds: f64,
        actions: PyBuffer<f64>,
        parts: PyBuffer<u8>,
        seeds: PyBuffer<u64>,
        ranges: PyBuffer<f64>,
        state: PyBuffer<f64>,
    ) -> PyResult<()> {
        let period = length(py, "seconds", seconds)?;
        let (actions, parts, seeds) = (actions.to_vec(py)?, parts.to_vec(py)?, seeds.to_vec(py)?);
        let (count, robots, sensors) = (self.simulations.len(), self.robots, self.sensors);
        if actions.len() != count * robots * 2 || parts.len() != count || seeds.len() != count {
            let expected = format!("actions {} numbers, parts and seeds {count}", count * robots * 2);
            return Err(error(py, format!("buffers of another size: expected {expected}")));
        }
        let Self { episodes, simulations, threads, ranges: own_ranges, state: own_state, .. } = self;
        let mut ranges_of = own_ranges.chunks_mut((robots * sensors).max(1));
        let parts = parts.iter().zip(actions.chunks(robots * 2)).zip(&seeds);
        let parts = parts.map(|((part, actions), seed)| Part::of_number(*part, actions, *seed));
        let parts = parts.collect::<Result<Vec<_>, _>>().map_err(|failed| error(py, failed))?;
        let mut rows: Vec<Row<'_>> = simulations
            .iter_mut()
            .zip(parts)
            .zip(own_state.chunks_mut(robots * STATE))
            .map(|((simulation, part), state)| Row {
                simulation,
                part,
                ranges: ranges_of.next().unwrap_or_default(),
                state,
            })
            .collect();
        // A thread takes a few rows at a time: those that begin an episode take longer than others.
        let parts = Mutex::new(rows.chunks_mut(ROWS_AT_ONCE));
        let work = || {
            let mut scene = None;
            let next = || parts.lock().next();
            while let Some(part) = next() {
                step_part(episodes, part, period, (robots, sensors), &mut scene)?;
            }
            Ok(())
        };
        let stepped = py.detach(|| {
            thread::scope(|scope| {
                let others: Vec<_> = (1..*threads).map(|_| scope.spawn(work)).collect();
                let join = |other: thread::ScopedJoinHandle<'_, Result<(), String>>| {
                    other.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
                };
                others.into_iter().map(join).fold(work(), Result::and)
            })
        });
        stepped.map_err(|failed| error(py, failed))?;
        fill(py, &ranges, own_ranges)?;
        fill(py, &state, own_state)
    }

    /// Steps copies of the first simulation by `seconds` on so many threads, without Python, for the real time `real`: each step reads the
    /// range sensors; the robots drive small circles, by one command, or by the same one in each step if `is_commanded`. Returns the
    /// number of steps and the real time that they took, s.
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
        let (robots, sensors) = (self.robots, self.sensors);
        let steps_of = || -> Result<u64, String> {
            let mut simulation = self.simulations[0].clone();
            let (mut ranges, mut state) = (vec![0.0; robots * sensors], vec![0.0; robots * STATE]);
            let start = Instant::now();
            let actions = CIRCLE.repeat(robots);
            let mut count = 0;
            while start.elapsed() < real {
                let part = Part::Drive(if count == 0 || is_commanded { &actions } else { &[] });
                let row = Row { simulation: &mut simulation, part, ranges: &mut ranges, state: &mut state };
                step_part(&self.episodes, &mut [row], period, (robots, sensors), &mut None)?;
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
        let simulation = self.simulations.get(index);
        let simulation = simulation.ok_or_else(|| error(py, format!("no simulation {index}")))?;
        Ok(simulation.digest().to_string())
    }

    /// Simulation `index` as a value of its own.
    fn simulation(
        &self,
        py: Python<'_>,
        index: usize,
        of: PyRef<'_, python::Simulation>,
    ) -> PyResult<python::Simulation> {
        let value = self.simulations.get(index).ok_or_else(|| error(py, format!("no simulation {index}")))?;
        Ok(of.with_value(value.clone()))
    }
}

/// Seed of an episode: a hash of the user's seed and the number of the episode.
#[pyfunction]
pub fn episode_seed(seed: u64, episode: u64) -> u64 {
    hash("eyesim: seed of an episode", [seed, episode])[0]
}

/// Steps these simulations and observes them. `scene` is for those that begin an episode: a copy of the scene, made when it is needed.
fn step_part(
    episodes: &Episodes,
    rows: &mut [Row<'_>],
    period: Time,
    (robots, sensors): (usize, usize),
    scene: &mut Option<SceneSpec>,
) -> Result<(), String> {
    for Row { simulation, part, ranges, state } in rows {
        match part {
            Part::Rest => continue,
            Part::Begin(seed) => {
                let scene = scene.get_or_insert_with(|| SceneSpec::clone(&episodes.scene));
                **simulation = episodes.begin(simulation, scene, *seed)?;
            }
            Part::Drive(actions) => {
                for (action, id) in actions.chunks(2).zip(1..) {
                    let command = Command::Twist(Twist::new(action[0], action[1]));
                    simulation.command(RobotId(id), command).map_err(|failed| format!("robot {id}: {failed}"))?;
                }
                simulation.advance_to(simulation.now().saturating_add(period));
            }
        }
        observe(simulation, (robots, sensors), ranges, state);
    }
    Ok(())
}

impl Episodes {
    /// The episode of `seed`, after another one; `scene` is a copy of the scene, whose starts are overwritten.
    fn begin(
        &self,
        before: &simulation::Simulation,
        scene: &mut SceneSpec,
        seed: u64,
    ) -> Result<simulation::Simulation, String> {
        let of_scene = self.scene.robots.iter().map(|robot| robot.start);
        let first = hash("eyesim: start of an episode", [seed, 0])[0];
        for (index, (robot, start)) in scene.robots.iter_mut().zip(of_scene).enumerate() {
            let [x, y, phi] = match self.starts.len() {
                0 => [start.position.x, start.position.y, start.heading.radians()],
                count => self.starts[((first % count as u64) as usize + index) % count],
            };
            let drawn = hash("eyesim: start of a robot", [seed, index as u64]);
            // 53 bits make a number from -1 to 1.
            let unit = |word: u64| (word >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
            let [dx, dy, dphi] = self.jitter;
            robot.start = Pose::new(x + dx * unit(drawn[0]), y + dy * unit(drawn[1]), phi + dphi * unit(drawn[2]));
        }
        let options = Options { seed: Some(seed), slot: self.slot };
        before.restarted(scene, &options).map_err(|failed| failed.to_string())
    }
}

/// Fills the numbers that are observed of one simulation.
fn observe(
    simulation: &mut simulation::Simulation,
    (robots, sensors): (usize, usize),
    ranges: &mut [f64],
    state: &mut [f64],
) {
    let now = simulation.now();
    for index in 0..robots {
        let id = RobotId::from_index(index);
        let own = range_count(simulation, id);
        let readings = &mut ranges[index * sensors..(index + 1) * sensors];
        for (sensor, reading) in readings.iter_mut().enumerate() {
            *reading = if sensor < own { range(simulation, id, sensor) } else { f64::INFINITY };
        }
        let numbers = simulation.with_robot(id, |robot, _| {
            let motion = &mut robot.motion;
            let (pose, speed) = (motion.pose(now), motion.speed(now));
            let Pose { position, heading } = pose;
            let (contacts, stalled) = (motion.contacts(now), motion.is_stalled(now));
            let stalled = f64::from(u8::from(stalled));
            [position.x, position.y, heading.remainder(), speed.vx, speed.omega, f64::from(contacts), stalled]
        });
        state[index * STATE..(index + 1) * STATE].copy_from_slice(&numbers);
    }
}

/// Four random words, which depend on the purpose and on each number.
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
