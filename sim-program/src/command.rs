//! Runs external commands (compilers, interpreters) with a time limit, and owns the thread that starts processes.

use std::io::{self, Read};
use std::os::unix::process::CommandExt as _;
use std::process::{Child, Command, Output, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, mpsc};
use std::thread;
use std::time::{Duration, Instant};

use parking_lot::Mutex;

/// Time limit of a compiler for one source; our choice.
pub const COMMAND_TIMEOUT: Duration = Duration::from_secs(180);

/// Time limit of cargo for one package with its dependencies; our choice.
pub const CARGO_TIMEOUT: Duration = Duration::from_secs(1800);

/// Environment variable that overrides the time limit of compilers and of cargo, in seconds.
pub const TIMEOUT_VARIABLE: &str = "EYESIM_BUILD_TIMEOUT";

/// The time limit of a build command: `default`, unless the user has set [`TIMEOUT_VARIABLE`] to a number above 0.
pub fn build_timeout(default: Duration) -> Duration {
    let set = std::env::var(TIMEOUT_VARIABLE).ok().and_then(|text| text.trim().parse::<f64>().ok());
    let seconds = set.filter(|seconds| *seconds > 0.0);
    seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()).unwrap_or(default)
}

/// Interval at which the start and the end of a command are checked.
const POLL_INTERVAL: Duration = Duration::from_millis(2);

/// Request to start a process.
struct SpawnRequest {
    command: Command,
    answer: mpsc::SyncSender<io::Result<Child>>,
}

/// Sender to the thread that starts processes; `None` before its start.
static SPAWNER: Mutex<Option<mpsc::Sender<SpawnRequest>>> = Mutex::new(None);

/// Starts the thread of [`spawn`] unless it is running. Call it on a thread without restrictions: the processes inherit
/// the restrictions of the first caller.
///
/// # Errors
/// The system lacks the resources for the thread.
pub fn start_spawner() -> io::Result<()> {
    let mut spawner = SPAWNER.lock();
    if spawner.is_none() {
        let (sender, incoming) = mpsc::channel::<SpawnRequest>();
        let serve = move || {
            for SpawnRequest { mut command, answer } in incoming {
                // The requester waits for this one message.
                let _ = answer.send(command.spawn());
            }
        };
        thread::Builder::new().name("spawner".to_owned()).spawn(serve)?;
        *spawner = Some(sender);
    }
    Ok(())
}

/// Starts a process on a dedicated thread. This thread lives as long as this process, since the kernel may kill a child
/// when the thread that started it ends. It is not a thread of a robot program: a child inherits the
/// restrictions of the thread that starts it.
///
/// # Errors
/// The command cannot be started.
pub fn spawn(command: Command) -> io::Result<Child> {
    start_spawner()?;
    let (answer, receiver) = mpsc::sync_channel(1);
    let sent = SPAWNER.lock().as_ref().is_some_and(|requests| requests.send(SpawnRequest { command, answer }).is_ok());
    let started = if sent { receiver.recv().ok() } else { None };
    started.unwrap_or_else(|| Err(io::Error::other("the thread that starts processes has gone")))
}

/// The user has interrupted this process.
static IS_INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Requests that all commands of this process, also those that start later, be killed with all processes that they have
/// started. The threads that wait for the commands kill them. Async-signal-safe.
pub fn interrupt() {
    IS_INTERRUPTED.store(true, Ordering::Release);
}

/// Returns true once [`interrupt`] was called.
pub fn is_interrupted() -> bool {
    IS_INTERRUPTED.load(Ordering::Acquire)
}

/// Limits of a command.
pub struct CommandLimits<'a> {
    /// Wall-clock time after which the command is killed.
    pub timeout: Duration,
    /// Number of bytes of each output stream after which the command is killed.
    pub max_output: usize,
    /// Returns true if the command must be killed.
    pub is_cancelled: &'a dyn Fn() -> bool,
}

impl CommandLimits<'static> {
    /// Limits only the time.
    pub fn of_time(timeout: Duration) -> Self {
        Self { timeout, max_output: usize::MAX, is_cancelled: &|| false }
    }
}

/// Runs a build command to its end and collects its output; its standard input is empty. A command that has not ended
/// after `timeout` is killed with all processes that it has started.
///
/// # Errors
/// The command cannot be started; [`io::ErrorKind::TimedOut`] or [`io::ErrorKind::Interrupted`] if it was killed.
pub fn build_output(command: &mut Command, timeout: Duration) -> io::Result<Output> {
    output_within(command, &CommandLimits::of_time(timeout)).map_err(|error| match error.kind() {
        io::ErrorKind::TimedOut => io::Error::new(error.kind(), format!("{error} (see {TIMEOUT_VARIABLE})")),
        _ => error,
    })
}

/// Runs `command` to its end and collects its output; its standard input is empty. A command that exceeds a limit is
/// killed with all processes that it has started; output of processes that have left its group is then not awaited.
///
/// # Errors
/// The command cannot be started; [`io::ErrorKind::TimedOut`], [`io::ErrorKind::FileTooLarge`] or
/// [`io::ErrorKind::Interrupted`] if it was killed.
pub fn output_within(command: &mut Command, limits: &CommandLimits<'_>) -> io::Result<Output> {
    collect(start(with_pipes(command))?, limits)
}

/// Starts `command`. Its file is busy if it was written a moment ago and another thread has started a process meanwhile:
/// until that process executes its own file, it has a copy of the writer's descriptor. So this tries again.
fn start(command: &mut Command) -> io::Result<Child> {
    /// Time for which this tries again; our choice.
    const BUSY_TIME: Duration = Duration::from_secs(2);
    let deadline = Instant::now() + BUSY_TIME;
    loop {
        match command.spawn() {
            Err(error) if error.kind() == io::ErrorKind::ExecutableFileBusy && Instant::now() < deadline => {
                thread::sleep(POLL_INTERVAL);
            }
            started => return started,
        }
    }
}

/// Like [`output_within`], for callers on a program's thread, whose restrictions the command does not inherit.
///
/// # Errors
/// See [`output_within`].
pub fn output_apart(mut command: Command, timeout: Duration) -> io::Result<Output> {
    with_pipes(&mut command);
    collect(spawn(command)?, &CommandLimits::of_time(timeout))
}

/// Sets up `command` with pipes for its output and its own process group, and lets the kernel kill it when the thread
/// that starts it ends.
fn with_pipes(command: &mut Command) -> &mut Command {
    // SAFETY: prctl is async-signal-safe and takes no pointer; the thread that starts the command outlives it.
    unsafe {
        command.pre_exec(|| {
            libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL);
            Ok(())
        })
    };
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).process_group(0)
}

/// Collects the output of a process until it ends.
fn collect(mut child: Child, limits: &CommandLimits<'_>) -> io::Result<Output> {
    /// Time in which a reader takes what is left in a pipe.
    const DRAIN_TIME: Duration = Duration::from_millis(100);
    let group = child.id() as i32;
    // SAFETY: kill takes no pointer; the number identifies the group as long as the group has a member.
    let kill = || unsafe { libc::kill(-group, libc::SIGKILL) };
    let (timeout, is_flooded) = (limits.timeout, Arc::new(AtomicBool::new(false)));
    let readers = [
        start_reader(child.stdout.take(), limits.max_output, &is_flooded)?,
        start_reader(child.stderr.take(), limits.max_output, &is_flooded)?,
    ];
    let start = Instant::now();
    let excess = || match () {
        () if is_flooded.load(Ordering::Relaxed) => {
            let message = format!("it printed more than {} kB and was killed", limits.max_output / 1000);
            Some((io::ErrorKind::FileTooLarge, message))
        }
        () if start.elapsed() > timeout => {
            let message = format!("it had not ended after {} s and was killed", timeout.as_secs_f64());
            Some((io::ErrorKind::TimedOut, message))
        }
        () if is_interrupted() || (limits.is_cancelled)() => {
            Some((io::ErrorKind::Interrupted, "it was interrupted".to_owned()))
        }
        () => None,
    };
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if let Some((kind, message)) = excess() {
            kill();
            child.wait()?;
            return Err(io::Error::new(kind, message));
        }
        thread::sleep(POLL_INTERVAL);
    };
    // Processes that the command has started and left running may hold the pipes open.
    let [stdout, stderr] = readers.map(|(reader, bytes)| {
        while !reader.is_finished() && excess().is_none() {
            thread::sleep(POLL_INTERVAL);
        }
        if !reader.is_finished() {
            kill();
            // The reader takes what is in the pipe. A process that has left the group keeps the pipe open.
            let deadline = Instant::now() + DRAIN_TIME;
            while !reader.is_finished() && Instant::now() < deadline {
                thread::sleep(POLL_INTERVAL);
            }
        }
        std::mem::take(&mut *bytes.lock())
    });
    match excess() {
        Some((kind @ io::ErrorKind::FileTooLarge, message)) => Err(io::Error::new(kind, message)),
        _ => Ok(Output { status, stdout, stderr }),
    }
}

/// A thread that reads a stream, and the bytes that it has read so far.
type Reader = (thread::JoinHandle<()>, Arc<Mutex<Vec<u8>>>);

/// Starts a thread that reads a stream to its end, but stops after more than `max_bytes` bytes. With a thread for each
/// stream, a full pipe of one stream does not block the command.
fn start_reader(
    stream: Option<impl Read + Send + 'static>,
    max_bytes: usize,
    is_flooded: &Arc<AtomicBool>,
) -> io::Result<Reader> {
    let (is_flooded, bytes) = (Arc::clone(is_flooded), Arc::<Mutex<Vec<u8>>>::default());
    let read = Arc::clone(&bytes);
    let reader = thread::Builder::new().name("output".to_owned()).spawn(move || {
        let Some(mut stream) = stream else { return };
        let mut buffer = [0; 1 << 14];
        loop {
            let count = match stream.read(&mut buffer) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                Ok(0) | Err(_) => return,
                Ok(count) => count,
            };
            let mut read = read.lock();
            read.extend_from_slice(&buffer[..count]);
            if read.len() > max_bytes {
                is_flooded.store(true, Ordering::Relaxed);
                return;
            }
        }
    })?;
    Ok((reader, bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hanging_command_is_killed_with_its_children() {
        let start = Instant::now();
        let error = build_output(Command::new("sh").args(["-c", "sleep 1000 & sleep 1000"]), Duration::from_millis(50));
        assert_eq!(error.expect_err("it hangs").kind(), io::ErrorKind::TimedOut);
        assert!(start.elapsed() < Duration::from_secs(500));
    }

    #[test]
    fn script_that_is_still_open_for_writing_is_started_once_it_is_closed() {
        let folder = tempfile::tempdir().expect("a folder");
        let script = folder.path().join("script");
        std::fs::write(&script, "#!/bin/sh\necho out\n").expect("a script");
        std::fs::set_permissions(&script, std::os::unix::fs::PermissionsExt::from_mode(0o755)).expect("a mode");
        let writer = std::fs::OpenOptions::new().append(true).open(&script).expect("the script");
        let output = thread::scope(|scope| {
            scope.spawn(move || {
                thread::sleep(Duration::from_millis(100));
                drop(writer);
            });
            build_output(&mut Command::new(&script), COMMAND_TIMEOUT).expect("a shell")
        });
        assert_eq!(output.stdout, b"out\n");
    }

    #[test]
    fn process_that_leaves_the_group_does_not_exceed_the_time_limit() {
        let start = Instant::now();
        let mut command = Command::new("sh");
        command.args(["-c", "echo out; setsid sleep 300 & exit 0"]);
        let output = build_output(&mut command, Duration::from_secs(20)).expect("a shell");
        assert_eq!(output.stdout, b"out\n");
        assert!(start.elapsed() < Duration::from_secs(200));
    }

    #[test]
    fn output_of_both_streams_is_collected() {
        let command = "i=0; while [ $i -lt 5000 ]; do echo out$i; echo err$i >&2; i=$((i+1)); done; exit 3";
        let output = build_output(Command::new("sh").args(["-c", command]), COMMAND_TIMEOUT).expect("a shell");
        assert_eq!(output.status.code(), Some(3));
        assert_eq!(
            [&output.stdout, &output.stderr].map(|text| text.iter().filter(|byte| **byte == b'\n').count()),
            [5000; 2]
        );
    }
}
