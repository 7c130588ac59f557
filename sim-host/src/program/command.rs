//! External commands (compilers, interpreters), run with a time limit, and the thread that starts processes.

use std::io::{self, Read};
use std::os::unix::process::CommandExt as _;
use std::process::{Child, Command, Output, Stdio};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use parking_lot::Mutex;

/// Time limit of a compiler for one source; our choice.
pub const COMMAND_TIMEOUT: Duration = Duration::from_secs(180);

/// Time limit of cargo for one package with all that it depends on; our choice.
pub const CARGO_TIMEOUT: Duration = Duration::from_secs(1800);

/// Variable with another time limit of compilers and of cargo, in seconds.
pub const TIMEOUT_VARIABLE: &str = "EYESIM_BUILD_TIMEOUT";

/// The time limit of a build command: `default`, unless the user has set [`TIMEOUT_VARIABLE`] to a number above 0.
pub fn build_timeout(default: Duration) -> Duration {
    let set = std::env::var(TIMEOUT_VARIABLE).ok().and_then(|text| text.trim().parse::<f64>().ok());
    let seconds = set.filter(|seconds| *seconds > 0.0);
    seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok()).unwrap_or(default)
}

/// Request to start a process.
struct SpawnRequest {
    command: Command,
    answer: mpsc::SyncSender<io::Result<Child>>,
}

/// Sends to the thread that starts processes; `None` before its start.
static SPAWNER: Mutex<Option<mpsc::Sender<SpawnRequest>>> = Mutex::new(None);

/// Starts the thread of [`spawn`] unless it runs. Call it on a thread without restrictions: the processes inherit those of the first caller.
///
/// # Errors
/// The system has no room for the thread.
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

/// Starts a process on a thread that lives as long as this process, since the kernel may kill a child when the thread that started it
/// ends, and that is no thread of a program, whose restrictions a child would inherit.
///
/// # Errors
/// The command cannot be started.
pub fn spawn(command: Command) -> io::Result<Child> {
    start_spawner()?;
    let (answer, answered) = mpsc::sync_channel(1);
    let sent = SPAWNER.lock().as_ref().is_some_and(|requests| requests.send(SpawnRequest { command, answer }).is_ok());
    let started = if sent { answered.recv().ok() } else { None };
    started.unwrap_or_else(|| Err(io::Error::other("the thread that starts processes has gone")))
}

/// Runs `command` to its end and collects its output; its standard input is empty. A command that has not ended after `timeout` is
/// killed with all processes that it has started.
///
/// # Errors
/// The command cannot be started; [`io::ErrorKind::TimedOut`] if it was killed.
pub fn output_within(command: &mut Command, timeout: Duration) -> io::Result<Output> {
    collect(prepared(command).spawn()?, timeout).map_err(|error| match error.kind() {
        io::ErrorKind::TimedOut => io::Error::new(error.kind(), format!("{error} (see {TIMEOUT_VARIABLE})")),
        _ => error,
    })
}

/// As [`output_within`], for a thread of a program, whose restrictions the command does not inherit.
///
/// # Errors
/// As [`output_within`].
pub fn output_apart(mut command: Command, timeout: Duration) -> io::Result<Output> {
    prepared(&mut command);
    collect(spawn(command)?, timeout)
}

/// Gives `command` pipes for its output and a process group, and lets it end with the thread that starts it.
fn prepared(command: &mut Command) -> &mut Command {
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
fn collect(mut child: Child, timeout: Duration) -> io::Result<Output> {
    /// Interval of the checks for its end.
    const POLL_INTERVAL: Duration = Duration::from_millis(2);
    let group = child.id() as i32;
    // SAFETY: kill takes no pointer; the number identifies the group as long as the group has a member.
    let kill = || unsafe { libc::kill(-group, libc::SIGKILL) };
    let readers = [read_all(child.stdout.take())?, read_all(child.stderr.take())?];
    let start = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait()? {
            break status;
        }
        if start.elapsed() > timeout {
            kill();
            child.wait()?;
            let what = format!("it had not ended after {} s and was killed", timeout.as_secs_f64());
            return Err(io::Error::new(io::ErrorKind::TimedOut, what));
        }
        thread::sleep(POLL_INTERVAL);
    };
    // Processes that the command has started and left running may hold the pipes open.
    let [stdout, stderr] = readers.map(|reader| {
        while !reader.is_finished() && start.elapsed() <= timeout {
            thread::sleep(POLL_INTERVAL);
        }
        if !reader.is_finished() {
            kill();
        }
        reader.join().unwrap_or_default()
    });
    Ok(Output { status, stdout, stderr })
}

/// Reads a stream to its end on a new thread, so that the other stream cannot block.
fn read_all(stream: Option<impl Read + Send + 'static>) -> io::Result<thread::JoinHandle<Vec<u8>>> {
    thread::Builder::new().name("output".to_owned()).spawn(move || {
        let mut bytes = Vec::new();
        // Bytes read before an error count.
        let _ = stream.map(|mut stream| stream.read_to_end(&mut bytes));
        bytes
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_that_hangs_is_killed_with_what_it_has_started() {
        let start = Instant::now();
        let error =
            output_within(Command::new("sh").args(["-c", "sleep 1000 & sleep 1000"]), Duration::from_millis(50));
        assert_eq!(error.expect_err("it hangs").kind(), io::ErrorKind::TimedOut);
        assert!(start.elapsed() < Duration::from_secs(500));
    }

    #[test]
    fn what_both_streams_say_is_collected() {
        let command = "i=0; while [ $i -lt 5000 ]; do echo out$i; echo err$i >&2; i=$((i+1)); done; exit 3";
        let output = output_within(Command::new("sh").args(["-c", command]), COMMAND_TIMEOUT).expect("a shell");
        assert_eq!(output.status.code(), Some(3));
        assert_eq!(
            [&output.stdout, &output.stderr].map(|text| text.iter().filter(|byte| **byte == b'\n').count()),
            [5000; 2]
        );
    }
}
