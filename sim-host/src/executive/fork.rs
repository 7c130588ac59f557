//! Forks of this process, which run cases. A fork inherits everything that this process has read, built and loaded. A
//! faulty program can corrupt only its fork.

use std::fs;
use std::io;
use std::os::fd::AsRawFd as _;
use std::os::unix::net::UnixStream;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use super::confine::exit_at_once;
use super::watchdog::process_time;
use crate::program::run_folder::RunFolder;

/// A fork of this process, made by [`ForkedWorker::start`]. It is killed when this value is dropped.
#[derive(Debug)]
pub struct ForkedWorker {
    pid: libc::pid_t,
    /// Connection to the child.
    pub stream: UnixStream,
    /// The child has been waited for.
    is_reaped: bool,
}

impl ForkedWorker {
    /// Forks this process, which must be single-threaded; the child calls `serve` with its end of the connection and
    /// then ends. It also ends when this process ends.
    ///
    /// # Errors
    /// This process has several threads (only one of them would exist in the child), or the kernel refuses.
    pub fn start(serve: impl FnOnce(UnixStream)) -> io::Result<Self> {
        await_single_thread()?;
        let (own_end, child_end) = UnixStream::pair()?;
        let parent = std::process::id();
        // SAFETY: the process has one thread, so that no lock is held and no state is half changed in the child.
        match unsafe { libc::fork() } {
            -1 => Err(io::Error::last_os_error()),
            0 => {
                drop(own_end);
                // SAFETY: prctl and getppid take no pointers.
                let is_orphan = unsafe {
                    libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL, 0, 0, 0);
                    libc::getppid().cast_unsigned() != parent
                };
                if is_orphan {
                    exit_at_once(1);
                }
                let served = catch_unwind(AssertUnwindSafe(|| serve(child_end)));
                exit_at_once(if served.is_ok() { 0 } else { 3 })
            }
            pid => Ok(Self { pid, stream: own_end, is_reaped: false }),
        }
    }

    /// Kills the child unless it has been waited for.
    pub fn kill(&mut self) {
        if !self.is_reaped {
            // SAFETY: the child has not been waited for, so that its process id still identifies it.
            unsafe { libc::kill(self.pid, libc::SIGKILL) };
        }
    }

    /// Waits for the end of the child, and kills it after `timeout`; returns a description of its end.
    pub fn end_within(&mut self, timeout: Duration) -> String {
        let start = Instant::now();
        while !self.has_ended() {
            if start.elapsed() > timeout {
                self.kill();
                break;
            }
            std::thread::sleep(Duration::from_micros(200));
        }
        self.wait()
    }

    /// Returns true if [`ForkedWorker::wait`] would not block.
    fn has_ended(&self) -> bool {
        // SAFETY: a struct of numbers, for which zeros are valid.
        let mut info: libc::siginfo_t = unsafe { std::mem::zeroed() };
        let options = libc::WEXITED | libc::WNOHANG | libc::WNOWAIT;
        // SAFETY: a child that has not been waited for, and a valid pointer. The call fails if there is no child to
        // wait for.
        let result = self.is_reaped
            || unsafe { libc::waitid(libc::P_PID, self.pid.cast_unsigned(), &raw mut info, options) } != 0;
        // SAFETY: the kernel has filled in the structure for a child that has ended, or not changed it.
        result || unsafe { info.si_pid() } != 0
    }

    /// Waits for the end of the child; if it was killed, removes its abandoned run folders. Returns a description of
    /// its end.
    pub fn wait(&mut self) -> String {
        let mut status = 0;
        if self.is_reaped {
            return "it has ended".to_owned();
        }
        // SAFETY: a child that has not been waited for, and a valid pointer.
        while unsafe { libc::waitpid(self.pid, &raw mut status, 0) } < 0
            && io::Error::last_os_error().kind() == io::ErrorKind::Interrupted
        {}
        self.is_reaped = true;
        if libc::WIFSIGNALED(status) {
            RunFolder::remove_abandoned();
            let signal = libc::WTERMSIG(status);
            format!("signal {signal}{}", signal_name(signal))
        } else {
            format!("exit code {}", libc::WEXITSTATUS(status))
        }
    }
}

impl Drop for ForkedWorker {
    fn drop(&mut self) {
        self.kill();
        self.wait();
    }
}

/// Name of `signal` in brackets; empty for a signal that has no name here.
fn signal_name(signal: i32) -> &'static str {
    match signal {
        libc::SIGSEGV => " (SIGSEGV)",
        libc::SIGABRT => " (SIGABRT)",
        libc::SIGBUS => " (SIGBUS)",
        libc::SIGKILL => " (SIGKILL)",
        libc::SIGTERM => " (SIGTERM)",
        libc::SIGINT => " (SIGINT)",
        libc::SIGFPE => " (SIGFPE)",
        libc::SIGILL => " (SIGILL)",
        libc::SIGTRAP => " (SIGTRAP)",
        _ => "",
    }
}

/// Waits until this process has one thread: another thread, such as that of a progress bar, may be about to end.
fn await_single_thread() -> io::Result<()> {
    const ATTEMPTS: u32 = 500;
    for _ in 0..ATTEMPTS {
        if fs::read_dir("/proc/self/task")?.count() == 1 {
            return Ok(());
        }
        std::thread::sleep(Duration::from_millis(2));
    }
    Err(io::Error::other("a process with several threads cannot be copied"))
}

/// Indices of those `streams` that have data to read or are closed. Waits until there is one, at most for `timeout`; a
/// signal ends the wait.
///
/// # Errors
/// The kernel refuses.
pub fn readable(streams: &[&UnixStream], timeout: Duration) -> io::Result<Vec<usize>> {
    let poll = |stream: &&UnixStream| libc::pollfd { fd: stream.as_raw_fd(), events: libc::POLLIN, revents: 0 };
    let mut polled: Vec<libc::pollfd> = streams.iter().map(poll).collect();
    let milliseconds = i32::try_from(timeout.as_millis()).unwrap_or(i32::MAX);
    // SAFETY: an array of as many valid entries as are given.
    let count = unsafe { libc::poll(polled.as_mut_ptr(), polled.len() as libc::nfds_t, milliseconds) };
    if count < 0 {
        let error = io::Error::last_os_error();
        return if error.kind() == io::ErrorKind::Interrupted { Ok(Vec::new()) } else { Err(error) };
    }
    Ok(polled.iter().enumerate().filter(|(_, polled)| polled.revents != 0).map(|(index, _)| index).collect())
}

/// Limits the memory that this process may allocate, beyond its present memory, to `additional` bytes; processes that
/// it starts inherit the limit.
///
/// # Errors
/// The kernel refuses.
pub fn limit_memory(additional: u64) -> io::Result<()> {
    let status = fs::read_to_string("/proc/self/status")?;
    let kilobytes =
        status.lines().find_map(|line| line.strip_prefix("VmData:")?.split_whitespace().next()?.parse().ok());
    let limit = kilobytes.unwrap_or(0_u64) * 1024 + additional;
    let limits = libc::rlimit { rlim_cur: limit, rlim_max: limit };
    // SAFETY: a valid pointer.
    if unsafe { libc::setrlimit(libc::RLIMIT_DATA, &raw const limits) } < 0 {
        Err(io::Error::last_os_error())
    } else {
        Ok(())
    }
}

/// Processor time in seconds that this process and its children have used; includes grandchildren only once they have
/// ended.
pub fn processor_seconds() -> f64 {
    // SAFETY: a struct of numbers, for which zeros are valid.
    let mut usage: libc::rusage = unsafe { std::mem::zeroed() };
    // SAFETY: a valid pointer.
    unsafe { libc::getrusage(libc::RUSAGE_CHILDREN, &raw mut usage) };
    let seconds = |time: libc::timeval| time.tv_sec as f64 + 1e-6 * time.tv_usec as f64;
    let own_pid = std::process::id().cast_signed();
    let running = children().chain([own_pid]).filter_map(process_time).map(|time| time.as_secs_f64());
    seconds(usage.ru_utime) + seconds(usage.ru_stime) + running.sum::<f64>()
}

/// Process ids of the children of this process; none if the kernel does not list them.
fn children() -> impl Iterator<Item = libc::pid_t> {
    let tasks = fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let lists = tasks.filter_map(|task| fs::read_to_string(task.path().join("children")).ok());
    lists.flat_map(|list| list.split_whitespace().filter_map(|pid| pid.parse().ok()).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn processor_time_includes_running_and_ended_children() {
        let before = processor_seconds();
        let mut child = std::process::Command::new("sh").args(["-c", "while :; do :; done"]).spawn().expect("a child");
        let start = std::time::Instant::now();
        while processor_seconds() < before + 0.2 {
            assert!(start.elapsed() < Duration::from_secs(60), "the time of the child is not counted");
            std::thread::sleep(Duration::from_millis(10));
        }
        let running = processor_seconds();
        child.kill().and_then(|()| child.wait()).expect("the child ends");
        assert!(processor_seconds() >= running);
    }
}
