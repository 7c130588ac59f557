//! The watchdog's measure: a thread's own processor time since its release, so that a loaded machine fails nobody.

use std::fs;
use std::time::{Duration, Instant};

use super::signal::ThreadBlock;

/// What is known of one thread since the watchdog first saw its present release.
#[derive(Default)]
pub struct Watch {
    release: u64,
    since: Option<Since>,
}

struct Since {
    processor_time: Duration,
    /// When the thread was last seen to run, or ready to.
    last_active: Instant,
    last_processor_time: Duration,
}

impl Watch {
    /// True when the thread has used `timeout` seconds of processor time, or slept in the kernel for as long, since its
    /// last release. Measured from the first look at a release, so up to one look's interval in the program's favour.
    pub fn is_overdue(&mut self, block: &ThreadBlock, timeout: f64) -> bool {
        use std::sync::atomic::Ordering::Relaxed;
        let (release, tid) = (block.releases.load(Relaxed), block.tid.load(Relaxed));
        let Some(processor_time) = processor_time(tid) else { return false };
        let now = Instant::now();
        if release != self.release || self.since.is_none() {
            self.release = release;
            self.since = Some(Since { processor_time, last_active: now, last_processor_time: processor_time });
            return false;
        }
        let Some(since) = &mut self.since else { return false };
        if processor_time != since.last_processor_time || !is_asleep(tid) {
            since.last_active = now;
            since.last_processor_time = processor_time;
        }
        let asleep = now - since.last_active;
        let used = processor_time.saturating_sub(since.processor_time);
        used.as_secs_f64() >= timeout || asleep.as_secs_f64() >= timeout
    }
}

/// True while a debugger holds the process: nothing is overdue then.
pub fn is_debugged() -> bool {
    fs::read_to_string("/proc/self/status")
        .ok()
        .and_then(|status| status.lines().find_map(|line| line.strip_prefix("TracerPid:").map(|pid| pid.trim() != "0")))
        .unwrap_or(false)
}

/// Processor time that the thread has used so far.
fn processor_time(tid: i32) -> Option<Duration> {
    if tid <= 0 {
        return None;
    }
    // The kernel's encoding of a thread's clock: ~tid << 3, per thread (4), all time (2).
    let clock = (!tid << 3) | 6;
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: `time` is one valid timespec; an unknown clock gives an error.
    let status = unsafe { libc::clock_gettime(clock, &mut time) };
    (status == 0).then(|| Duration::new(time.tv_sec.unsigned_abs(), time.tv_nsec.unsigned_abs() as u32))
}

/// True when the kernel says that the thread sleeps (as opposed to runs or waits for a processor).
fn is_asleep(tid: i32) -> bool {
    let Ok(stat) = fs::read_to_string(format!("/proc/self/task/{tid}/stat")) else { return false };
    // "tid (name) S ...": the name may hold blanks and brackets.
    stat.rsplit_once(')').is_some_and(|(_, rest)| matches!(rest.trim_start().chars().next(), Some('S' | 'D')))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_busy_thread_uses_processor_time_and_a_sleeping_one_does_not() {
        // SAFETY: gettid takes no arguments and always succeeds.
        let tid = unsafe { libc::gettid() };
        let before = processor_time(tid).unwrap();
        let start = Instant::now();
        while processor_time(tid).unwrap() - before < Duration::from_millis(5) {
            assert!(start.elapsed() < Duration::from_secs(60), "processor time stands still");
        }
        assert!(!is_asleep(tid));
        assert!(processor_time(-1).is_none());
    }
}
