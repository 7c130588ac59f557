//! The host's handle of a robot's process: start, messages, supervision, end.

use std::any::Any;
use std::collections::BTreeMap;
use std::io;
use std::os::unix::process::{CommandExt as _, ExitStatusExt as _};
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU16, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use parking_lot::Mutex;
use robios_sys::wire::{Malformed, Reader};

use super::channel::{Channel, Channels, CodeLocation, Message, Turn, kind};
use super::client::NO_ROOM_FOR_TASK;
use super::debugger::Debugger;
use super::output;
use super::spinning::Spinning;
use crate::executive::confine::protect_host;
use crate::executive::failure::{Failure, MAX_SEARCH_WORDS};
use crate::executive::signal::{Crash, OVERDUE_SIGNAL, THREAD_ENDED};
use crate::executive::watchdog::{self, FlowSample, ReleaseTimer};
use crate::host;
use crate::program::command;
use crate::program::sandbox::scratch::Scratch;

/// Prefix of the name of a robot's process in lists of processes.
pub const CHILD_NAME: &str = "eyesim: ";

/// Interval at which a child that has the turn is checked.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Processor time, or time asleep, in seconds within which a program's library must be loaded; our choice.
const LOAD_TIMEOUT: f64 = 10.0;

/// Time within which an overdue child must report its location before it is killed, even on a loaded machine.
const REPORT_TIMEOUT: Duration = Duration::from_secs(1);

/// Time within which the last output of a process must be printed; our choice.
const OUTPUT_TIMEOUT: Duration = Duration::from_millis(100);

/// A robot's process.
pub struct Child {
    process: Mutex<Process>,
    /// Id of the process, and of its process group.
    pid: i32,
    channels: Channels,
    first: Channel,
    /// Channels of tasks, in addition to the first channel.
    task_channels: Mutex<TaskChannels>,
    /// Last request of the watchdog for the program's location.
    location_request: Mutex<Option<LocationRequest>>,
    is_ending: AtomicBool,
    /// The process was found stopped by a signal; it would never continue by itself.
    was_stopped: AtomicBool,
    /// The process is a debugger that the user operates: it has no time limits.
    is_debugged: bool,
    /// `main` has returned.
    has_exited: AtomicBool,
    spinning: Spinning,
    /// The first failure of the child, after which it is lost.
    lost: OnceLock<Failure>,
    /// Number of the last RoBIOS call, `u16::MAX` before the first.
    pub(super) last_call: AtomicU16,
    /// Functions of the program that the host may call, by the addresses of their code and data in the child.
    pub(super) callbacks: Mutex<BTreeMap<(u64, u64), Box<dyn Any + Send>>>,
    /// Scratch folder of a restricted process, with its limits.
    scratch: Option<Scratch>,
    /// The thread that prints what the process prints past the simulator.
    output: Mutex<Option<JoinHandle<()>>>,
}

struct Process {
    handle: std::process::Child,
    /// Exit status, once the process has ended.
    status: Option<ExitStatus>,
}

/// One release of one of a robot's flows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Release {
    /// The flow's thread in the host.
    pub thread: i32,
    /// Number of the release.
    pub number: u64,
}

struct LocationRequest {
    requested_at: Instant,
    /// Release in which the location was requested.
    release: Release,
    /// The child was killed because it did not report its location.
    is_killed: bool,
}

#[derive(Default)]
struct TaskChannels {
    count: u32,
    idle: Vec<Channel>,
}

impl Child {
    /// Starts `command` with a file of channels as its standard input. The new process ends no later than this process.
    ///
    /// A restricted process has a folder `scratch`. Output that a process prints past the simulator goes through a
    /// pipe; this output is truncated and shown without control characters.
    ///
    /// # Errors
    /// The system lacks the resources for another process, or the command does not exist.
    pub fn start(mut command: Command, scratch: Option<Scratch>) -> io::Result<Self> {
        let channels = Channels::new()?;
        command.stdin(Stdio::from(channels.file()?)).process_group(0);
        let (reader, writer) = io::pipe()?;
        command.stdout(writer.try_clone()?).stderr(writer);
        let output = output::forward(reader)?;
        let child = Self::spawn(command, channels, false, scratch)?;
        *child.output.lock() = Some(output);
        Ok(child)
    }

    /// Like [`Child::start`], for a command that is not this binary and cannot [protect the host](protect_host) itself.
    ///
    /// # Errors
    /// See [`Child::start`].
    pub fn start_foreign(mut command: Command, scratch: Option<Scratch>) -> io::Result<Self> {
        let host = std::process::id().cast_signed();
        // SAFETY: the function is async-signal-safe.
        unsafe {
            command.pre_exec(move || {
                protect_host(host);
                Ok(())
            })
        };
        Self::start(command, scratch)
    }

    /// Starts the program in `library` under a debugger, which gets the terminal.
    ///
    /// # Errors
    /// The debugger cannot be started.
    pub fn start_debugged(debugger: &Debugger, library: &Path) -> io::Result<Self> {
        let channels = Channels::new()?;
        let command = debugger.command(library, &channels.path())?;
        Self::spawn(command, channels, true, None)
    }

    fn spawn(command: Command, channels: Channels, is_debugged: bool, scratch: Option<Scratch>) -> io::Result<Self> {
        let first = channels.map(0)?;
        let handle = command::spawn(command)?;
        Ok(Self {
            is_debugged,
            pid: handle.id() as i32,
            process: Mutex::new(Process { handle, status: None }),
            channels,
            first,
            task_channels: Mutex::default(),
            location_request: Mutex::new(None),
            is_ending: AtomicBool::new(false),
            was_stopped: AtomicBool::new(false),
            has_exited: AtomicBool::new(false),
            spinning: Spinning::of_child(),
            lost: OnceLock::new(),
            last_call: AtomicU16::new(u16::MAX),
            callbacks: Mutex::default(),
            scratch,
            output: Mutex::default(),
        })
    }

    /// The command that runs the C or Rust program in `library`, for a robot called `name` in lists of processes.
    ///
    /// # Errors
    /// The path of this executable cannot be determined.
    pub fn command(name: &str, library: &Path) -> io::Result<Command> {
        let mut command = host::command(format!("{CHILD_NAME}{name}"))?;
        command.arg("child").arg(library);
        Ok(command)
    }

    /// Raises this process's limit of open files to the number that this many children need, as far as the system
    /// allows.
    pub fn make_room(children: usize) {
        /// Number of open files that do not belong to children.
        const OTHERS: usize = 256;
        /// Number of open files of a child: the file of its channels and the pipe of its output.
        const PER_CHILD: usize = 2;
        let needed = (PER_CHILD * children + OTHERS) as u64;
        let mut limit = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
        // SAFETY: both calls get one valid limit; if they fail, starting a child fails later with a message.
        unsafe {
            if libc::getrlimit(libc::RLIMIT_NOFILE, &mut limit) == 0 && limit.rlim_cur < needed {
                limit.rlim_cur = limit.rlim_max.min(needed);
                libc::setrlimit(libc::RLIMIT_NOFILE, &limit);
            }
        }
    }

    /// Returns true if there is a processor for each child, and another one for each thread that serves a child.
    pub fn has_processors() -> bool {
        Spinning::has_processors()
    }

    /// The child's thread that runs `main`, to be bound to the processor of the thread that serves it: from now on, that
    /// thread does not spin. `None` if the child names a thread that is not its own.
    pub fn bound_thread(&self) -> Option<i32> {
        self.spinning.note_binding();
        let thread = self.first.thread().cast_signed();
        Path::new(&format!("/proc/{}/task/{thread}", self.pid)).exists().then_some(thread)
    }

    /// The channel of the thread that runs `main`.
    pub fn first(&self) -> &Channel {
        &self.first
    }

    /// Returns true if the child is importing a module, and the processor time that earlier imports have taken.
    pub fn imports(&self) -> (bool, Duration) {
        self.first.imports()
    }

    /// Id of the process.
    pub fn pid(&self) -> i32 {
        self.pid
    }

    /// Waits for the child's first message, which it sends once its program is loaded.
    ///
    /// # Errors
    /// See [`Child::receive`]; also if the user has interrupted this process, or if the child has used the time limit
    /// of loading, or slept for as long, without sending the message.
    pub fn receive_first(&self) -> Result<Message, Failure> {
        let mut timer = ReleaseTimer::default();
        // A debugger has no time limit, and an interpreter reports when it imports modules, which may take long.
        while !self.is_debugged && !self.first.wait_for(Turn::Host, Some(POLL_INTERVAL)) && self.exit_status().is_none()
        {
            if command::is_interrupted() {
                return Err(self.lose(self.failure("it was interrupted while its library was loaded")));
            }
            let sample = FlowSample::of_loading(self.pid).map(|sample| sample.with_imports(self.imports()));
            if sample.is_some_and(|sample| timer.is_overdue(&sample, LOAD_TIMEOUT)) {
                return Err(self.lose(self.failure(&format!(
                    "its library was not loaded within {LOAD_TIMEOUT} s: a function that runs while it is being loaded does not return"
                ))));
            }
        }
        self.receive(&self.first)
    }

    /// Waits for the child's next message on `channel`.
    ///
    /// # Errors
    /// [`Failure`] if the child failed, ended or was ended; every later call returns the same.
    pub fn receive(&self, channel: &Channel) -> Result<Message, Failure> {
        if let Some(lost) = self.lost.get() {
            return Err(lost.clone());
        }
        self.spinning.spin(channel);
        let mut missing_before = None;
        loop {
            self.check_limits()?;
            if channel.wait_for(Turn::Host, Some(POLL_INTERVAL)) {
                break;
            }
            // A message that the child sent before it ended is still received.
            if let Some(status) = self.exit_status()
                && !channel.wait_for(Turn::Host, Some(Duration::ZERO))
            {
                return Err(self.lose(self.failure_of_end(status)));
            }
            // The next thread of a task replaces the previous one; a thread that is missing in two checks has ended by
            // itself.
            let missing = Some(channel.thread()).filter(|thread| *thread != 0 && self.has_lost_thread(*thread));
            if missing.is_some() && missing == missing_before {
                let crash = Crash { signal: THREAD_ENDED, ..Crash::default() };
                let last_call = self.last_call.load(Ordering::Relaxed);
                return Err(self.lose(Failure::new(crash, [0; 2], last_call, Vec::new())));
            }
            missing_before = missing;
        }
        match channel.message() {
            Some(message) if message.kind == kind::CRASH => Err(self.lose(self.crash(&message.body))),
            Some(message) => {
                self.has_exited.fetch_or(message.kind == kind::EXITED, Ordering::AcqRel);
                Ok(message)
            }
            None => Err(self.malformed()),
        }
    }

    /// Checks the limits of a restricted process, at most once per interval. Its threads may exceed them also while
    /// `main` waits in a call.
    ///
    /// # Errors
    /// [`Failure`] if the process exceeds a limit; it is then lost.
    pub fn check_limits(&self) -> Result<(), Failure> {
        let scratch = self.scratch.as_ref().filter(|_| !self.is_ending());
        let excess = scratch.and_then(|scratch| scratch.excess(self.pid));
        excess.map_or(Ok(()), |excess| Err(self.lose(self.failure(&excess))))
    }

    /// Returns true if the process is alive but its thread `thread` is not.
    fn has_lost_thread(&self, thread: u32) -> bool {
        !self.is_debugged && watchdog::is_gone(self.pid, thread.cast_signed())
    }

    /// Abandons a child that has sent a malformed message.
    pub fn malformed(&self) -> Failure {
        self.lose(self.failure("its process sent an invalid message: the program wrote where it may not"))
    }

    /// Takes a channel for a task, on which a thread of the child waits to be called back.
    ///
    /// # Errors
    /// [`Failure`] if the child was lost; also if the kernel lacks memory for another channel.
    pub fn take_task_channel(&self) -> Result<Channel, Failure> {
        let mut tasks = self.task_channels.lock();
        if let Some(channel) = tasks.idle.pop() {
            return Ok(channel);
        }
        let number = tasks.count + 1;
        let channel = self.channels.grow_to(number + 1).and_then(|()| self.channels.map(number));
        let channel = channel.map_err(|error| {
            let hint = if error.kind() == io::ErrorKind::FileTooLarge { ", see `ulimit -f`" } else { "" };
            self.lose(self.failure(&format!("no room for another task{hint}: {error}")))
        })?;
        tasks.count = number;
        drop(tasks);
        channel.set_up();
        self.first.set_count(number + 1);
        match self.receive(&channel)?.kind {
            kind::READY => Ok(channel),
            _ => Err(self.malformed()),
        }
    }

    /// Returns the channel of a task, whose thread waits to be called back again.
    pub fn return_task_channel(&self, channel: Channel) {
        self.task_channels.lock().idle.push(channel);
    }

    /// Returns true if the process runs under a debugger.
    pub fn is_debugged(&self) -> bool {
        self.is_debugged
    }

    /// Returns true once the process was found stopped, by SIGSTOP or another signal: it would never continue.
    pub fn is_stopped(&self) -> bool {
        if !self.is_debugged && watchdog::is_stopped(self.pid) {
            self.was_stopped.store(true, Ordering::Release);
        }
        self.was_stopped.load(Ordering::Acquire)
    }

    /// Ends a child that is overdue in this release, or stopped: requests its location, and kills it if it does not
    /// report the location in time.
    pub fn stop_overdue(&self, release: Release) {
        if self.is_debugged {
            return;
        }
        let mut location_request = self.location_request.lock();
        match &mut *location_request {
            Some(location_request) if location_request.release == release => {
                if location_request.requested_at.elapsed() > REPORT_TIMEOUT {
                    location_request.is_killed = true;
                    self.kill();
                }
            }
            location_request => {
                *location_request = Some(LocationRequest { requested_at: Instant::now(), release, is_killed: false });
                self.first.set_overdue();
                // Threads that are inside a call to the host, and threads that are not the robot's, ignore the signal.
                for thread in watchdog::threads(self.pid) {
                    // SAFETY: tgkill takes no pointer; a thread that has ended is an error.
                    unsafe { libc::syscall(libc::SYS_tgkill, self.pid, thread, OVERDUE_SIGNAL) };
                }
                // A stopped process reports once it continues.
                let process = self.process.lock();
                if process.status.is_none() {
                    // SAFETY: kill takes no pointer; the process has not been waited for, so the number still
                    // identifies it.
                    unsafe { libc::kill(self.pid, libc::SIGCONT) };
                }
            }
        }
    }

    /// Location at which the thread of `main` computes; the thread then continues. `None` if it does not compute, or
    /// does not report its location in time. A thread that sleeps in the kernel gets no request, since the signal would
    /// end its sleep.
    pub fn current_location(&self) -> Option<CodeLocation> {
        /// Time within which a running thread receives the signal, even on a loaded machine.
        const TIMEOUT: Duration = Duration::from_millis(200);
        let thread = self.first.thread().cast_signed();
        let is_computing = self.first.turn() == Turn::Child && !watchdog::is_thread_asleep(self.pid, thread);
        if self.is_debugged || self.is_ending() || !is_computing || !self.first.request_location() {
            return None;
        }
        // SAFETY: tgkill takes no pointer; a thread that has ended is an error.
        unsafe { libc::syscall(libc::SYS_tgkill, self.pid, thread, OVERDUE_SIGNAL) };
        let start = Instant::now();
        while !self.first.is_location_reported() && start.elapsed() < TIMEOUT {
            std::thread::sleep(Duration::from_millis(1));
        }
        self.first.take_location()
    }

    /// Returns true if the child was found overdue in this release, so that its location was requested; the report also
    /// takes processor time.
    pub fn is_location_requested(&self, release: Release) -> bool {
        self.location_request.lock().as_ref().is_some_and(|request| request.release == release)
    }

    /// Ends the child. If its `main` has returned, the child may end by itself until `deadline`, as it has files to
    /// close; otherwise it is killed with its process group. The wait for a debugger has no limit.
    pub fn end(&self, deadline: Instant) {
        self.is_ending.store(true, Ordering::Release);
        let deadline = if self.has_exited.load(Ordering::Acquire) { deadline } else { Instant::now() };
        while self.exit_status().is_none() {
            if Instant::now() >= deadline && !self.is_debugged {
                self.kill();
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    /// Returns true once the host is ending the child: a failure after that is not caused by its program.
    pub fn is_ending(&self) -> bool {
        self.is_ending.load(Ordering::Acquire)
    }

    /// Exit status of the process, if it has ended; the call reaps it.
    fn exit_status(&self) -> Option<ExitStatus> {
        let mut process = self.process.lock();
        if process.status.is_none() {
            process.status = process.handle.try_wait().unwrap_or(None);
        }
        process.status
    }

    /// Kills the process and its group.
    fn kill(&self) {
        let process = self.process.lock();
        if process.status.is_none() {
            // SAFETY: kill takes no pointer; the process has not been waited for, so the number still identifies it.
            unsafe {
                libc::kill(-self.pid, libc::SIGKILL);
                libc::kill(self.pid, libc::SIGKILL);
            }
        }
    }

    /// Marks the child as lost, kills it, and returns its first failure.
    fn lose(&self, mut failure: Failure) -> Failure {
        if failure.is_overdue && self.was_stopped.load(Ordering::Acquire) {
            failure.is_overdue = false;
            failure.description = "the program stopped its own process by a signal (SIGSTOP)".to_owned();
        }
        let failure = self.lost.get_or_init(|| failure).clone();
        self.kill();
        failure
    }

    /// A failure of the child with this description, after its last call.
    fn failure(&self, description: &str) -> Failure {
        let last_call = self.last_call.load(Ordering::Relaxed);
        Failure {
            description: description.to_owned(),
            is_overdue: false,
            last_call,
            task: None,
            location: String::new(),
            unfinished: Vec::new(),
            addresses: Vec::new(),
        }
    }

    /// Describes the unexpected end of the process as a failure.
    fn failure_of_end(&self, status: ExitStatus) -> Failure {
        if self.is_debugged {
            return self.failure("the debugger exited before the program");
        }
        if self.location_request.lock().as_ref().is_some_and(|request| request.is_killed) {
            let crash = Crash { signal: OVERDUE_SIGNAL, ..Crash::default() };
            return Failure::new(crash, [0; 2], self.last_call.load(Ordering::Relaxed), Vec::new());
        }
        match (status.signal(), status.code()) {
            (Some(signal), _) => self.failure(&format!("its process was killed by signal {signal}")),
            (_, Some(NO_ROOM_FOR_TASK)) => {
                self.failure("the system has no room for another task in its process: see `ulimit -v` and `ulimit -u`")
            }
            (_, code) => {
                self.failure(&format!("its process ended (exit code {}) without a message", code.unwrap_or_default()))
            }
        }
    }

    /// Parses the body of a CRASH message.
    fn crash(&self, body: &[u8]) -> Failure {
        let parse = || {
            let mut body = Reader::new(body);
            let [signal, code]: [i16; 2] = body.get()?;
            let (signal, code) = (i32::from(signal), i32::from(code));
            let text = body.get::<u32>()? as usize;
            let [address, pc, low, high]: [u64; 4] = body.get()?;
            let text = String::from_utf8_lossy(body.take(text)?).into_owned();
            let words = body.rest().chunks_exact(8).take(MAX_SEARCH_WORDS);
            let words = words.map(|word| word.iter().rev().fold(0, |value, byte| value << 8 | usize::from(*byte)));
            if signal == 0 {
                return if text.trim().is_empty() { Err(Malformed) } else { Ok(self.failure(&text)) };
            }
            let crash = Crash { signal, code, address: address as usize, pc: pc as usize, sp: 0 };
            let last_call = self.last_call.load(Ordering::Relaxed);
            let failure = Failure::new(crash, [low as usize, high as usize], last_call, words.collect());
            Ok(Failure { location: text, ..failure })
        };
        parse().unwrap_or_else(|Malformed| self.failure("its process crashed without a report"))
    }
}

impl Drop for Child {
    fn drop(&mut self) {
        self.end(Instant::now());
        // Processes that the program has left behind may hold the pipe open.
        let deadline = Instant::now() + OUTPUT_TIMEOUT;
        let is_open = |output: &JoinHandle<()>| !output.is_finished() && Instant::now() < deadline;
        while self.output.lock().as_ref().is_some_and(is_open) {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}
