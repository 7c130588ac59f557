//! Copies of this process that work through cases for it: what has been read, built and loaded is there at once, and what a program
//! destroys is the copy's.

use std::fs;
use std::io;
use std::os::fd::AsRawFd as _;
use std::os::unix::net::UnixStream;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use super::confine::exit_at_once;

/// A copy of this process, made by [`ForkedWorker::start`]. It is killed when this value is dropped.
#[derive(Debug)]
pub struct ForkedWorker {
    pid: libc::pid_t,
    /// Connection to the copy.
    pub stream: UnixStream,
    is_over: bool,
}

impl ForkedWorker {
    /// Copies this process, which must have one thread; the copy calls `serve` with its end of the connection and then ends. It ends as
    /// well when this process does.
    ///
    /// # Errors
    /// This process has several threads, of which only one would be in the copy, or the kernel refuses.
    pub fn start(serve: impl FnOnce(UnixStream)) -> io::Result<Self> {
        await_single_thread()?;
        let (own, other) = UnixStream::pair()?;
        let parent = std::process::id();
        // SAFETY: the process has one thread, so that no lock is held and no state is half changed in the copy.
        match unsafe { libc::fork() } {
            -1 => Err(io::Error::last_os_error()),
            0 => {
                drop(own);
                // SAFETY: prctl and getppid take no pointers.
                let is_orphan = unsafe {
                    libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL, 0, 0, 0);
                    libc::getppid().cast_unsigned() != parent
                };
                if is_orphan {
                    exit_at_once(1);
                }
                let served = catch_unwind(AssertUnwindSafe(|| serve(other)));
                exit_at_once(if served.is_ok() { 0 } else { 3 })
            }
            pid => Ok(Self { pid, stream: own, is_over: false }),
        }
    }

    /// Kills the copy.
    pub fn kill(&mut self) {
        if !self.is_over {
            // SAFETY: the child has not been waited for, so that its number is still its own.
            unsafe { libc::kill(self.pid, libc::SIGKILL) };
        }
    }

    /// Waits for the end of the copy, and kills it after `timeout`; returns how it ended, in words.
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
        // SAFETY: a child that has not been waited for, and a valid pointer. If there is none, there is nothing to wait for.
        let result =
            self.is_over || unsafe { libc::waitid(libc::P_PID, self.pid.cast_unsigned(), &raw mut info, options) } != 0;
        // SAFETY: the kernel has filled in the structure of a child that has ended, or left it.
        result || unsafe { info.si_pid() } != 0
    }

    /// Waits for the end of the copy; returns how it ended, in words.
    pub fn wait(&mut self) -> String {
        let mut status = 0;
        if self.is_over {
            return "it has ended".to_owned();
        }
        // SAFETY: a child that has not been waited for, and a valid pointer.
        while unsafe { libc::waitpid(self.pid, &raw mut status, 0) } < 0
            && io::Error::last_os_error().kind() == io::ErrorKind::Interrupted
        {}
        self.is_over = true;
        if libc::WIFSIGNALED(status) {
            let signal = libc::WTERMSIG(status);
            format!("signal {signal}{}", name_of(signal))
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

fn name_of(signal: i32) -> &'static str {
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

/// Waits for threads that are about to end, such as those of a progress bar.
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

/// Indices of those `streams` that have something to read or are closed; waits for the first one, at most for `timeout`, or until a
/// signal arrives.
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

/// Limits the memory that this process may have besides what it has now, in bytes; processes that it starts inherit the limit.
///
/// # Errors
/// The kernel refuses.
pub fn limit_memory(more: u64) -> io::Result<()> {
    let status = fs::read_to_string("/proc/self/status")?;
    let kilobytes =
        status.lines().find_map(|line| line.strip_prefix("VmData:")?.split_whitespace().next()?.parse().ok());
    let limit = kilobytes.unwrap_or(0_u64) * 1024 + more;
    let limits = libc::rlimit { rlim_cur: limit, rlim_max: limit };
    // SAFETY: a valid pointer.
    if unsafe { libc::setrlimit(libc::RLIMIT_DATA, &raw const limits) } < 0 {
        Err(io::Error::last_os_error())
    } else {
        Ok(())
    }
}

/// Processor time that this process has used, in seconds.
pub fn processor_seconds() -> f64 {
    let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
    // SAFETY: a valid pointer.
    unsafe { libc::clock_gettime(libc::CLOCK_PROCESS_CPUTIME_ID, &raw mut time) };
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}
