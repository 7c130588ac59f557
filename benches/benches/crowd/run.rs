//! Runs of `eyesim`: time, memory and speed of the robots.

use std::fs;
use std::process::{Child, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::Value;
use tests::{Scratch, number};

/// Interval between readings of the memory of a run's processes, which takes long for many processes.
const CHILDREN_INTERVAL: Duration = Duration::from_millis(100);

/// Time and memory of a run.
#[derive(Clone, Copy)]
pub struct Run {
    /// Virtual time, s.
    pub simulated: f64,
    /// Wall-clock time without loading and building, s.
    pub real: f64,
    /// Maximum resident memory in KiB, if the system reports it.
    pub peak: Option<u64>,
    /// Mean speed of the robots along their paths, m/s.
    pub speed: f64,
}

/// Runs a scene with these options for `seconds` of virtual time.
pub fn run_with(scratch: &Scratch, options: &[&str], seconds: f64) -> Run {
    let until = seconds.to_string();
    let mut all = vec!["run", "--until", &until, "--speed", "max", "--report", "r.json"];
    all.extend(options);
    let mut command = scratch.command(&all);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("eyesim starts");
    let peak = watch(&mut child);
    let status = child.wait().expect("eyesim ends");
    assert!(status.success(), "eyesim ends with {status}");
    let report: Value = serde_json::from_str(&scratch.read("r.json")).expect("a report is JSON");
    let simulated = number(&report, "sim_time_s");
    let robots = report["robots"].as_array().expect("a report lists its robots");
    let path: f64 = robots.iter().map(|robot| number(robot, "path_m")).sum();
    let speed = path / robots.len() as f64 / simulated;
    Run { simulated, real: number(&report, "real_time_s"), peak, speed }
}

/// Waits for the end of `child`; returns its maximum resident memory in KiB, as Linux reports it, plus the maximum
/// memory of the processes of its robots.
fn watch(child: &mut Child) -> Option<u64> {
    let path = format!("/proc/{}/status", child.id());
    let (mut peak, mut children, mut next) = (None, 0, Instant::now());
    while child.try_wait().expect("eyesim can be waited for").is_none() {
        // A process that has ended has no memory any more, so the last reading counts.
        peak = kib(&path, "VmHWM:").or(peak);
        if Instant::now() >= next {
            children = children.max(memory_of_children(child.id()));
            next = Instant::now() + CHILDREN_INTERVAL;
        }
        thread::sleep(Duration::from_millis(2));
    }
    peak.map(|peak| peak + children)
}

/// Memory of the children of a process in KiB, in which pages that several processes share count once.
fn memory_of_children(process: u32) -> u64 {
    let children = fs::read_to_string(format!("/proc/{process}/task/{process}/children")).unwrap_or_default();
    children.split_whitespace().filter_map(|child| kib(&format!("/proc/{child}/smaps_rollup"), "Pss:")).sum()
}

/// The number of KiB in the line of a file that begins with `name`.
fn kib(path: &str, name: &str) -> Option<u64> {
    let text = fs::read_to_string(path).ok()?;
    text.lines().find_map(|line| line.strip_prefix(name))?.split_whitespace().next()?.parse().ok()
}
