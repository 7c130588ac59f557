//! The swarm in `eyesim` and in other simulators, with the same scene and controller.
//!
//! The programs of the peers are in `benches/peers/`. `SWARM_PYTHON` names a Python with the wheels `mujoco`, `ir-sim`
//! and `numpy`; without it only `eyesim` is measured. The plot is written to `target/swarm-peers.svg`, or to the path
//! in `SWARM_PLOT`.

use std::env;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use accuracy::figure::{Figure, Mark, Scale, Series};
use eyesim::plot::chart;
use serde_json::Value;
use tests::{Scratch, number};

use crate::REPEATS;
use crate::run::{Run, run_with};

/// Numbers of robots.
const SIZES: [usize; 5] = [1, 10, 100, 1_000, 10_000];
/// Robot-steps of a run of each simulator. Runs of the peers also end after [`LIMIT_S`].
const STEPS: f64 = 400_000.0;
/// Maximum duration of a run of a peer, s.
const LIMIT_S: f64 = 5.0;
/// Number of robots whose mean speed is printed.
const SPEED_ROBOTS: usize = 1_000;
/// Slot, s.
const SLOT_S: f64 = 0.05;

/// Simulators in the order of the table.
const SIMULATORS: [Simulator; 9] = [
    Simulator {
        name: "eyesim, fibers, 1 worker",
        kind: Kind::Eyesim(["fiber", "1"]),
        max_robots: 10_000,
        steps: STEPS,
    },
    Simulator {
        name: "eyesim, fibers, 2 workers",
        kind: Kind::Eyesim(["fiber", "2"]),
        max_robots: 10_000,
        steps: STEPS,
    },
    Simulator {
        name: "eyesim, threads, 2 workers",
        kind: Kind::Eyesim(["thread", "2"]),
        max_robots: 1_000,
        steps: STEPS,
    },
    Simulator {
        name: "eyesim, processes, 2 workers",
        kind: Kind::Eyesim(["process", "2"]),
        max_robots: 1_000,
        steps: STEPS / 20.0,
    },
    Simulator { name: "MuJoCo planar", kind: Kind::MuJoCo(["planar", "library"]), max_robots: 10_000, steps: STEPS },
    Simulator { name: "MuJoCo wheels", kind: Kind::MuJoCo(["wheels", "library"]), max_robots: 1_000, steps: STEPS },
    Simulator { name: "ir-sim", kind: Kind::IrSim, max_robots: 1_000, steps: STEPS },
    Simulator {
        name: "MuJoCo planar, our grid",
        kind: Kind::MuJoCo(["planar", "grid"]),
        max_robots: 10_000,
        steps: STEPS,
    },
    Simulator {
        name: "MuJoCo wheels, our grid",
        kind: Kind::MuJoCo(["wheels", "grid"]),
        max_robots: 1_000,
        steps: STEPS,
    },
];

/// Figures that were measured earlier, on another machine of the same kind: thousand robot-steps per second, as lowest
/// and highest, for 1 to 1,000 robots.
const QUOTED: [(&str, [(f64, f64); 4]); 2] = [
    ("ARGoS 3 (e-puck), 20 Nov. 2026", [(145.0, 145.0), (290.0, 290.0), (253.0, 253.0), (160.0, 177.0)]),
    ("Stage 4.3, 20 Nov. 2026", [(49.0, 112.0), (130.0, 240.0), (65.0, 72.0), (29.0, 39.0)]),
];

struct Simulator {
    name: &'static str,
    kind: Kind,
    /// Larger swarms take more than about a minute, or more threads or processes than a machine allows.
    max_robots: usize,
    /// Robot-steps of a run.
    steps: f64,
}

enum Kind {
    /// Kind of flow and number of workers.
    Eyesim([&'static str; 2]),
    /// Body and rays.
    MuJoCo([&'static str; 2]),
    IrSim,
}

/// Python and the compiled program of MuJoCo.
struct Peers {
    python: OsString,
    mujoco: PathBuf,
}

/// Measured runs of a simulator with a number of robots, in the order of time.
struct Measurement {
    simulator: &'static str,
    robots: usize,
    runs: Vec<Run>,
    /// Largest overlap of two bodies, mm.
    overlap_mm: Option<f64>,
}

/// Runs all simulators in turn, and prints the table.
pub fn compare(is_smoke_test: bool) {
    let scratch = Scratch::new();
    let peers = find_peers(scratch.path());
    let sizes = if is_smoke_test { &SIZES[1..2] } else { &SIZES[..] };
    let mut measurements = Vec::new();
    for &robots in sizes {
        benches::swarm::write(robots, scratch.path()).expect("the scene can be written");
        let mut row: Vec<Measurement> = Vec::new();
        for _ in 0..if is_smoke_test { 1 } else { REPEATS } {
            for simulator in SIMULATORS.iter().filter(|simulator| robots <= simulator.max_robots) {
                let steps = if is_smoke_test { 100.0 } else { simulator.steps };
                let seconds = (steps / robots as f64).ceil() * SLOT_S;
                let Some((run, overlap_mm)) = simulator.run(&scratch, peers.as_ref(), robots, seconds) else {
                    continue;
                };
                match row.iter_mut().find(|measurement| measurement.simulator == simulator.name) {
                    Some(measurement) => measurement.add(run, overlap_mm),
                    None => row.push(Measurement { simulator: simulator.name, robots, runs: vec![run], overlap_mm }),
                }
            }
        }
        measurements.extend(row);
    }
    if is_smoke_test {
        println!("crowd/peers    runs");
        return;
    }
    print_table(&measurements);
    write_plot(&measurements);
}

impl Simulator {
    /// Runs the swarm of the scratch folder; returns also the largest overlap in mm, where the simulator allows
    /// overlaps. `None` without the peer.
    fn run(&self, scratch: &Scratch, peers: Option<&Peers>, robots: usize, seconds: f64) -> Option<(Run, Option<f64>)> {
        let arguments = [robots.to_string(), seconds.to_string(), LIMIT_S.to_string()];
        match self.kind {
            Kind::Eyesim([exec, workers]) => {
                Some((run_with(scratch, &["swarm.sim", "--exec", exec, "--threads", workers], seconds), None))
            }
            Kind::MuJoCo(options) => Some(run_peer(Command::new(&peers?.mujoco).args(options).args(arguments))),
            Kind::IrSim => {
                let mut command = Command::new(&peers?.python);
                Some(run_peer(command.arg(source("swarm_irsim.py")).arg(scratch.path()).args(arguments)))
            }
        }
    }
}

impl Measurement {
    fn add(&mut self, run: Run, overlap_mm: Option<f64>) {
        self.runs.push(run);
        self.overlap_mm = self.overlap_mm.zip(overlap_mm).map(|(a, b)| a.max(b));
    }

    /// Multiple of real time of the median and of the fastest run.
    fn times_real_time(&self) -> [f64; 2] {
        let mut times: Vec<f64> = self.runs.iter().map(|run| run.simulated / run.real).collect();
        times.sort_by(f64::total_cmp);
        [times[times.len() / 2], times[times.len() - 1]]
    }

    /// Thousand robot-steps per second at a multiple of real time.
    fn thousand_steps(&self, times_real_time: f64) -> f64 {
        times_real_time / SLOT_S * self.robots as f64 / 1e3
    }

    /// Maximum memory, KiB.
    fn memory(&self) -> Option<u64> {
        self.runs.iter().filter_map(|run| run.peak).max()
    }
}

/// Compiles the program of MuJoCo into `folder`; prints the reason if there are no peers.
fn find_peers(folder: &Path) -> Option<Peers> {
    let Some(python) = env::var_os("SWARM_PYTHON") else {
        println!("no peers: SWARM_PYTHON names no Python with mujoco, ir-sim and numpy");
        return None;
    };
    match compile(&python, folder) {
        Ok(mujoco) => Some(Peers { python, mujoco }),
        Err(reason) => {
            println!("no peers: {reason}");
            None
        }
    }
}

/// Compiles the program of MuJoCo against the wheel; returns its path.
fn compile(python: &OsStr, folder: &Path) -> Result<PathBuf, String> {
    let output = |command: &mut Command| {
        let output = command.output().map_err(|error| error.to_string())?;
        if output.status.success() {
            Ok(String::from_utf8_lossy(&output.stdout).trim().to_owned())
        } else {
            Err(String::from_utf8_lossy(&output.stderr).trim().to_owned())
        }
    };
    let script = "import importlib.util, mujoco\n\
                  assert importlib.util.find_spec('irsim'), 'ir-sim is missing'\n\
                  print(mujoco.__path__[0])";
    let wheel = PathBuf::from(output(Command::new(python).args(["-c", script]))?);
    let entries = fs::read_dir(&wheel).map_err(|error| error.to_string())?;
    let library = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .find(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("libmujoco.so")))
        .ok_or("the wheel mujoco has no libmujoco.so")?;
    let program = folder.join("swarm_mujoco");
    let mut cc = Command::new("cc");
    cc.args(["-O3", "-o"]).arg(&program).arg(source("swarm_mujoco.c")).arg(library).arg("-lm");
    cc.arg("-I").arg(wheel.join("include")).arg(format!("-Wl,-rpath,{}", wheel.display()));
    output(&mut cc).map(|_| program)
}

/// Path of a program of the peers.
fn source(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("peers").join(name)
}

fn run_peer(command: &mut Command) -> (Run, Option<f64>) {
    let output = command.output().expect("the peer starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout);
    let result: Value = serde_json::from_str(text.lines().last().unwrap_or_default()).expect("the peer prints JSON");
    let run = Run {
        simulated: number(&result, "sim_time_s"),
        real: number(&result, "real_time_s"),
        peak: result["resident_kib"].as_u64(),
        speed: number(&result, "speed_m_per_s"),
    };
    (run, result["overlap_mm"].as_f64())
}

/// Prints a row for each simulator, with the median and the fastest run for each number of robots.
fn print_table(measurements: &[Measurement]) {
    let sizes = SIZES.map(|robots| format!(" {robots} |")).concat();
    println!("| 1,000 robot-steps/s, median (fastest) |{sizes} KiB per further robot | overlap, mm |");
    println!("|---|{}---|---|", "---|".repeat(SIZES.len()));
    for Simulator { name, max_robots, .. } in &SIMULATORS {
        let of_size = |robots| measurements.iter().find(|it| it.simulator == *name && it.robots == robots);
        let Some(alone) = of_size(1) else { continue };
        let cell = |robots| match of_size(robots) {
            Some(measurement) => {
                let [median, fastest] = measurement.times_real_time().map(|times| measurement.thousand_steps(times));
                format!(" {} ({}) |", short(median), short(fastest))
            }
            None if robots > *max_robots => " not run |".to_owned(),
            None => " |".to_owned(),
        };
        let cells = SIZES.map(cell).concat();
        let memory = SIZES.iter().rev().find_map(|robots| {
            let further = (*robots > 1).then(|| robots - 1)?;
            Some(of_size(*robots)?.memory()?.saturating_sub(alone.memory()?) as f64 / further as f64)
        });
        let overlaps = SIZES.iter().filter_map(|robots| of_size(*robots)?.overlap_mm);
        let overlap = overlaps.reduce(f64::max).map_or("none".to_owned(), |overlap| format!("{overlap:.1}"));
        println!("| {name} |{cells} {} | {overlap} |", memory.map_or(String::new(), short));
    }
    for (name, figures) in QUOTED {
        let range = |(low, high)| if low < high { format!(" {low} to {high} |") } else { format!(" {low} |") };
        println!("| {name}, quoted |{} | | |", figures.map(range).concat());
    }
    let speeds = measurements.iter().filter(|it| it.robots == SPEED_ROBOTS);
    let speeds = speeds.map(|it| format!("{}: {:.3}", it.simulator, it.runs[0].speed)).collect::<Vec<_>>();
    println!("mean speed of {SPEED_ROBOTS} robots, m/s: {}", speeds.join("; "));
}

/// A number with about three digits.
fn short(number: f64) -> String {
    let decimals = if number >= 100.0 {
        0
    } else if number >= 10.0 {
        1
    } else {
        2
    };
    format!("{number:.decimals$}")
}

/// Writes the curves of robot-steps per second over the number of robots.
fn write_plot(measurements: &[Measurement]) {
    let mut series: Vec<Series> = Vec::new();
    for simulator in &SIMULATORS {
        let runs = measurements.iter().filter(|measurement| measurement.simulator == simulator.name);
        let points: Vec<_> = runs.map(|m| (m.robots as f64, 1e3 * m.thousand_steps(m.times_real_time()[0]))).collect();
        if !points.is_empty() {
            series.push(Series { name: simulator.name.to_owned(), mark: Mark::LineAndDots, points });
        }
    }
    for (name, figures) in QUOTED {
        // The middle of a range on a logarithmic axis.
        let middles = figures.map(|(low, high): (f64, f64)| 1e3 * (low * high).sqrt());
        let points = SIZES.into_iter().map(|robots| robots as f64).zip(middles).collect();
        series.push(Series { name: name.to_owned(), mark: Mark::DashedLineAndDots, points });
    }
    let figure = Figure {
        name: "swarm-peers".to_owned(),
        title: "Robot-steps per second of the swarm".to_owned(),
        x_label: "robots".to_owned(),
        y_label: "robot-steps per second".to_owned(),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        series,
    };
    let path = env::var_os("SWARM_PLOT").map_or_else(|| tests::root().join("target/swarm-peers.svg"), PathBuf::from);
    let svg = chart::to_svg(&figure).expect("the chart can be drawn");
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).expect("the folder of the plot can be created");
    }
    fs::write(&path, svg).expect("the plot can be written");
    println!("plot: {}", path.display());
}
