//! Detection of overdue programs by the processor time, or the time asleep in the kernel, of a thread or process since
//! its release. So no program becomes overdue because the machine is loaded.

use std::fs;
use std::io;
use std::sync::atomic::Ordering::Relaxed;
use std::time::{Duration, Instant};

use super::signal::FlowBlock;

/// Measurement of one flow since the watchdog first saw its current release.
#[derive(Default)]
pub struct ReleaseTimer {
    release: u64,
    baseline: Option<Baseline>,
    /// Release in which the thread was found to have ended.
    gone_in: Option<u64>,
}

/// State of a flow at the first sample of its release, and its last activity.
struct Baseline {
    processor_time: Duration,
    imports: Duration,
    /// Time asleep since the last sample in which the flow ran or was ready to run.
    asleep: Duration,
    last_sample: Instant,
    last_processor_time: Duration,
}

/// Sample of a flow's state.
pub struct FlowSample {
    /// Number of the flow's release, see [`FlowBlock::releases`](super::signal::FlowBlock::releases).
    pub release: u64,
    /// Total processor time that the flow has used.
    pub processor_time: Duration,
    /// The flow sleeps in the kernel.
    pub is_asleep: bool,
    /// The flow imports a module, for which the timeout is longer, see `IMPORT_TIMEOUT_FACTOR`.
    pub is_importing: bool,
    /// Processor time of earlier imports, which is not part of the measured time. The program's process reports it; the
    /// report may be false.
    pub imports: Duration,
}

/// Factor of the timeout while a module is imported, and for all imports of a release together.
const IMPORT_TIMEOUT_FACTOR: f64 = 12.0;

/// Maximum time asleep that one sample adds; our choice, ten sampling intervals. A longer gap between two samples means
/// that the watchdog itself did not run, and then the rest of the machine may have stood still, too.
const MAX_ASLEEP_PER_SAMPLE: Duration = Duration::from_millis(500);

impl FlowSample {
    /// Samples a thread of this process.
    pub fn of_thread(block: &FlowBlock) -> Option<Self> {
        let tid = block.tid.load(Relaxed);
        Some(Self {
            release: block.releases.load(Relaxed),
            processor_time: processor_time(tid)?,
            is_asleep: is_asleep(&format!("/proc/self/task/{tid}")),
            is_importing: false,
            imports: Duration::ZERO,
        })
    }

    /// Samples the process `pid`, which the thread of `block` serves; `None` while a debugger is attached to it.
    pub fn of_process(pid: i32, block: &FlowBlock) -> Option<Self> {
        if is_traced(&pid.to_string()) {
            return None;
        }
        Some(Self {
            release: block.releases.load(Relaxed),
            processor_time: process_time(pid)?,
            // Inside a call to the host, the program's threads must sleep.
            is_asleep: !block.in_host.load(Relaxed) && are_asleep(pid),
            is_importing: false,
            imports: Duration::ZERO,
        })
    }
}

impl FlowSample {
    /// Samples the process `pid`, which loads its program.
    pub fn of_loading(pid: i32) -> Option<Self> {
        Some(Self {
            release: 1,
            processor_time: process_time(pid)?,
            is_asleep: are_asleep(pid),
            is_importing: false,
            imports: Duration::ZERO,
        })
    }

    /// Adds the imports that the process reports.
    #[must_use]
    pub fn with_imports(self, (is_importing, imports): (bool, Duration)) -> Self {
        Self { is_importing, imports, ..self }
    }
}

impl ReleaseTimer {
    /// Discards the measurement while the flow is inside a call, such as for an image; the next sample restarts it.
    pub fn pause(&mut self) {
        self.baseline = None;
    }

    /// Records that the flow's thread does not exist in this release. Returns true the second time: this is not called
    /// twice for a thread that has ended normally, since its robot no longer runs.
    pub fn record_missing(&mut self, release: u64) -> bool {
        self.gone_in.replace(release) == Some(release)
    }

    /// Returns true if the flow has used `timeout` seconds of processor time, or slept in the kernel for as long, since
    /// its last release, not counting imports of modules. The measurement starts at the first sample of a release, so
    /// that a program may use up to one sampling interval more.
    pub fn is_overdue(&mut self, sample: &FlowSample, timeout: f64) -> bool {
        let processor_time = sample.processor_time;
        let now = Instant::now();
        if sample.release != self.release || self.baseline.is_none() {
            self.release = sample.release;
            let imports = sample.imports;
            self.baseline = Some(Baseline {
                processor_time,
                imports,
                asleep: Duration::ZERO,
                last_sample: now,
                last_processor_time: processor_time,
            });
            return false;
        }
        let Some(baseline) = &mut self.baseline else { return false };
        if processor_time != baseline.last_processor_time || !sample.is_asleep {
            baseline.asleep = Duration::ZERO;
            baseline.last_processor_time = processor_time;
        } else {
            baseline.asleep += (now - baseline.last_sample).min(MAX_ASLEEP_PER_SAMPLE);
        }
        baseline.last_sample = now;
        let used = processor_time.saturating_sub(baseline.processor_time);
        let imports =
            sample.imports.saturating_sub(baseline.imports).as_secs_f64().min(timeout * IMPORT_TIMEOUT_FACTOR);
        let limit = if sample.is_importing { timeout * IMPORT_TIMEOUT_FACTOR } else { timeout };
        used.as_secs_f64() - imports >= limit || baseline.asleep.as_secs_f64() >= limit
    }
}

/// Returns true while a debugger is attached to this process: nothing is overdue then.
pub fn is_debugged() -> bool {
    is_traced("self")
}

/// Returns true while a debugger is attached to the process `pid`: a tracer that no program has started, and that is
/// not this process, as it would be after `ptrace(PTRACE_TRACEME)` of a program.
pub fn is_traced(pid: &str) -> bool {
    number_in_status(pid, "TracerPid:").is_some_and(|tracer| tracer != 0 && !is_descendant(tracer))
}

/// Returns true if the process `pid` is this process, or was started by this process or its descendants.
fn is_descendant(pid: u32) -> bool {
    let own_pid = std::process::id();
    std::iter::successors(Some(pid), |pid| number_in_status(&pid.to_string(), "PPid:"))
        .take(64)
        .any(|pid| pid == own_pid)
}

/// The number after `key` in the kernel's description of the process `pid`.
fn number_in_status(pid: &str, key: &str) -> Option<u32> {
    let status = fs::read_to_string(format!("/proc/{pid}/status")).ok()?;
    status.lines().find_map(|line| line.strip_prefix(key)?.trim().parse().ok())
}

/// Returns true if the process `pid` has no thread `tid`.
pub fn is_gone(pid: i32, tid: i32) -> bool {
    // SAFETY: tgkill takes no pointer, and signal 0 only checks that the thread exists.
    let status = unsafe { libc::syscall(libc::SYS_tgkill, pid, tid, 0) };
    status < 0 && io::Error::last_os_error().raw_os_error() == Some(libc::ESRCH)
}

/// The kernel's ids of the threads of process `pid`; empty once it has ended.
pub fn threads(pid: i32) -> Vec<i32> {
    let threads = fs::read_dir(format!("/proc/{pid}/task")).into_iter().flatten().flatten();
    threads.filter_map(|thread| thread.file_name().to_str()?.parse().ok()).collect()
}

/// Processor time that the process has used so far.
pub(super) fn process_time(pid: i32) -> Option<Duration> {
    // The kernel's encoding of a process's clock: ~pid << 3, all time (2).
    (pid > 0).then(|| clock(!pid << 3 | 2)).flatten()
}

/// Processor time that the thread has used so far.
fn processor_time(tid: i32) -> Option<Duration> {
    if tid <= 0 {
        return None;
    }
    // The kernel's encoding of a thread's clock: ~tid << 3, per thread (4), all time (2).
    clock((!tid << 3) | 6)
}

fn clock(clock: libc::clockid_t) -> Option<Duration> {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `time` is one valid timespec; an unknown clock is an error.
    let status = unsafe { libc::clock_gettime(clock, &mut time) };
    (status == 0).then(|| Duration::new(time.tv_sec.unsigned_abs(), time.tv_nsec.unsigned_abs() as u32))
}

/// Returns true if the thread with this folder in `/proc` sleeps, and neither runs nor waits for a processor.
fn is_asleep(folder: &str) -> bool {
    matches!(state(folder), Some('S' | 'D'))
}

/// Returns true if the thread `tid` of the process `pid` sleeps.
pub fn is_thread_asleep(pid: i32, tid: i32) -> bool {
    is_asleep(&format!("/proc/{pid}/task/{tid}"))
}

/// Returns true if all threads of the process `pid` sleep.
fn are_asleep(pid: i32) -> bool {
    threads(pid).into_iter().all(|tid| is_thread_asleep(pid, tid))
}

/// Returns true if the process `pid` was stopped by a signal, or by a tracer that is not a debugger; false if a
/// debugger stopped it.
pub fn is_stopped(pid: i32) -> bool {
    match state(&format!("/proc/{pid}")) {
        Some('T') => true,
        Some('t') => !is_traced(&pid.to_string()),
        _ => false,
    }
}

/// The kernel's state letter of the thread or process with this folder in `/proc`.
fn state(folder: &str) -> Option<char> {
    let stat = fs::read_to_string(format!("{folder}/stat")).ok()?;
    // "tid (name) S ...": the name may contain blanks and brackets.
    stat.rsplit_once(')').and_then(|(_, rest)| rest.trim_start().chars().next())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_in_the_host_is_not_measured() {
        let mut timer = ReleaseTimer::default();
        let sample = |seconds| FlowSample { processor_time: Duration::from_secs(seconds), ..sample_at_start() };
        assert!(!timer.is_overdue(&sample(0), 1.0));
        timer.pause();
        assert!(!timer.is_overdue(&sample(5), 1.0), "five seconds of the host's");
        assert!(timer.is_overdue(&sample(6), 1.0), "one of the program's");
    }

    fn sample_at_start() -> FlowSample {
        FlowSample {
            release: 1,
            processor_time: Duration::ZERO,
            is_asleep: false,
            is_importing: false,
            imports: Duration::ZERO,
        }
    }

    #[test]
    fn false_reports_of_imports_do_not_prevent_the_timeout() {
        let sample = |seconds, imports| {
            FlowSample { processor_time: Duration::from_secs(seconds), ..sample_at_start() }.with_imports(imports)
        };
        let mut timer = ReleaseTimer::default();
        assert!(!timer.is_overdue(&sample(0, (false, Duration::ZERO)), 1.0));
        assert!(!timer.is_overdue(&sample(11, (true, Duration::ZERO)), 1.0), "it imports");
        assert!(!timer.is_overdue(&sample(11, (false, Duration::from_secs(11))), 1.0), "it has imported");
        assert!(!timer.is_overdue(&sample(20, (true, Duration::MAX)), 1.0));
        assert!(timer.is_overdue(&sample(24, (true, Duration::MAX)), 1.0), "the longest time of all");
    }

    #[test]
    fn gap_between_samples_counts_as_half_a_second_asleep() {
        let mut timer = ReleaseTimer::default();
        let asleep = FlowSample { is_asleep: true, ..sample_at_start() };
        let mut sample_after_a_minute = || {
            if let Some(baseline) = &mut timer.baseline {
                baseline.last_sample -= Duration::from_secs(60);
            }
            timer.is_overdue(&asleep, 1.0)
        };
        assert_eq!([(); 3].map(|()| sample_after_a_minute()), [false, false, true]);
        assert!(!timer.is_overdue(&sample_at_start(), 1.0), "it runs");
    }

    #[test]
    fn busy_threads_use_processor_time_and_do_not_sleep() {
        // SAFETY: gettid takes no arguments and always succeeds.
        let tid = unsafe { libc::gettid() };
        let before = processor_time(tid).unwrap();
        let start = Instant::now();
        while processor_time(tid).unwrap() - before < Duration::from_millis(5) {
            assert!(start.elapsed() < Duration::from_secs(60), "processor time stands still");
        }
        assert!(!is_asleep(&format!("/proc/self/task/{tid}")));
        assert!(processor_time(-1).is_none());
        let own = std::process::id() as i32;
        assert!(process_time(own) > processor_time(tid), "other threads have used some, too");
        assert!(process_time(0).is_none());
        assert!(threads(own).contains(&tid) && threads(0).is_empty());
    }
}
