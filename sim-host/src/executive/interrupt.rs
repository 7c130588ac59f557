//! Interruption of runs by the user: a handle for the runs' owner, which a binary connects to Ctrl-C.

use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

use parking_lot::Mutex;

use super::confine::exit_at_once;
use super::signal::{self, Handlers, action, change_action, default_action};
use crate::program::command;
use crate::record::trace_file;

/// Interrupts, permanently, the runs that have a clone of this handle.
#[derive(Clone, Debug, Default)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Ends the runs at the end of their current slots. Returns true if the interrupt was already set.
    /// Async-signal-safe; may be called from any thread.
    pub fn set(&self) -> bool {
        self.0.swap(true, Ordering::AcqRel)
    }

    /// Returns true once [`set`](Self::set) was called.
    pub fn is_set(&self) -> bool {
        self.0.load(Ordering::Acquire)
    }
}

/// Interrupt that the signals of [`interrupts`] set.
static PROCESS_INTERRUPT: OnceLock<Interrupt> = OnceLock::new();

/// Ctrl-C is for a debugger and is ignored here.
static IS_DEBUGGING: AtomicBool = AtomicBool::new(false);

/// Lets writes beyond the limit of file sizes fail, which is reported, instead of ending the process.
///
/// # Errors
/// The kernel refuses to ignore the signal.
pub fn ignore_file_limit() -> io::Result<()> {
    // SAFETY: no handler.
    unsafe { change_action(libc::SIGXFSZ, Some(&action(libc::SIG_IGN, 0))) }.map(drop)
}

/// Installs the handlers of a binary, before its first build and run, and returns the interrupt that Ctrl-C, SIGTERM
/// and SIGHUP set; these signals also kill the compilers. The second such signal ends the process. A crash in a thread
/// that a robot program started by itself ends the process with a message.
///
/// # Errors
/// The kernel refuses a handler, or a run has already installed its own, which these would replace.
pub fn of_process() -> io::Result<Interrupt> {
    static IS_INSTALLED: Mutex<bool> = Mutex::new(false);
    let interrupt = PROCESS_INTERRUPT.get_or_init(Interrupt::default).clone();
    let mut is_installed = IS_INSTALLED.lock();
    if *is_installed {
        return Ok(interrupt);
    }
    if Handlers::are_installed() {
        return Err(io::Error::other("a run is already in progress"));
    }
    ignore_file_limit()?;
    // SAFETY: the call changes nothing.
    let hangup = unsafe { change_action(libc::SIGHUP, None) }?;
    IS_HANGUP_IGNORED.store(hangup.sa_sigaction == libc::SIG_IGN, Ordering::Release);
    for signal in interrupts() {
        // SAFETY: a handler without SA_SIGINFO gets a number; what it calls is async-signal-safe.
        unsafe { change_action(signal, Some(&interrupt_action())) }?;
    }
    for signal in [libc::SIGSEGV, libc::SIGBUS, libc::SIGFPE, libc::SIGILL, libc::SIGABRT, libc::SIGTRAP] {
        let action = action(on_foreign_fault as *const () as usize, libc::SA_ONSTACK);
        // SAFETY: as above.
        unsafe { change_action(signal, Some(&action)) }?;
    }
    LAST_RESORT.install()?;
    *is_installed = true;
    HAS_HANDLERS.store(true, Ordering::Release);
    Ok(interrupt)
}

/// The signals that interrupt the runs of a binary: Ctrl-C (SIGINT), SIGTERM, and SIGHUP at the end of the terminal,
/// unless the process was started with SIGHUP ignored (`nohup`).
fn interrupts() -> impl Iterator<Item = i32> {
    let hangup = (!IS_HANGUP_IGNORED.load(Ordering::Acquire)).then_some(libc::SIGHUP);
    [libc::SIGINT, libc::SIGTERM].into_iter().chain(hangup)
}

/// The process was started with SIGHUP ignored.
static IS_HANGUP_IGNORED: AtomicBool = AtomicBool::new(false);

/// [`of_process`] has installed its handlers.
static HAS_HANDLERS: AtomicBool = AtomicBool::new(false);

fn interrupt_action() -> libc::sigaction {
    action(on_interrupt as *const () as usize, libc::SA_RESTART)
}

/// Reinstalls the handlers of [`of_process`] that programs have replaced, as [`Handlers::reinstall`] does.
pub(super) fn reinstall(is_of_program: impl Fn(usize) -> bool) {
    if HAS_HANDLERS.load(Ordering::Acquire) {
        interrupts().for_each(|signal| signal::reinstall(signal, &interrupt_action(), &is_of_program));
    }
}

/// Time in seconds within which the supervisor must respond after a program has failed on a thread of the host;
/// otherwise the program has damaged the host, and locks may be held forever. Our choice.
const LAST_RESORT_TIMEOUT: libc::time_t = 10;

/// The kernel's timer that [`arm_last_resort`] sets.
struct LastResort {
    /// Id of the timer; meaningful once `is_installed`.
    timer: AtomicUsize,
    is_installed: AtomicBool,
}

static LAST_RESORT: LastResort = LastResort { timer: AtomicUsize::new(0), is_installed: AtomicBool::new(false) };

impl LastResort {
    /// Creates the timer, which does not run yet.
    fn install(&self) -> io::Result<()> {
        let signal = libc::SIGRTMAX() - 1;
        let action = action(on_last_resort as *const () as usize, libc::SA_RESTART);
        // SAFETY: a handler without SA_SIGINFO gets a number; what it calls is async-signal-safe. An all-zero event is
        // valid, and both pointers are.
        unsafe {
            change_action(signal, Some(&action))?;
            let mut event: libc::sigevent = std::mem::zeroed();
            (event.sigev_notify, event.sigev_signo) = (libc::SIGEV_SIGNAL, signal);
            let mut timer: libc::timer_t = std::ptr::null_mut();
            if libc::timer_create(libc::CLOCK_MONOTONIC, &raw mut event, &raw mut timer) != 0 {
                return Err(io::Error::last_os_error());
            }
            self.timer.store(timer.expose_provenance(), Ordering::Release);
        }
        self.is_installed.store(true, Ordering::Release);
        Ok(())
    }

    /// Makes the timer end the process after `seconds`; 0 stops the timer. Async-signal-safe.
    fn set(&self, seconds: libc::time_t) {
        if !self.is_installed.load(Ordering::Acquire) {
            return;
        }
        let timer = std::ptr::with_exposed_provenance_mut(self.timer.load(Ordering::Acquire));
        let none = libc::timespec { tv_sec: 0, tv_nsec: 0 };
        let time = libc::itimerspec { it_interval: none, it_value: libc::timespec { tv_sec: seconds, tv_nsec: 0 } };
        // SAFETY: the timer exists until the process ends, and the time is valid.
        unsafe { libc::timer_settime(timer, 0, &raw const time, std::ptr::null_mut()) };
    }
}

/// Makes the process of a binary end with a message after [`LAST_RESORT_TIMEOUT`], unless this function or
/// [`disarm_last_resort`] is called before.
/// Async-signal-safe.
pub(super) fn arm_last_resort() {
    LAST_RESORT.set(LAST_RESORT_TIMEOUT);
}

/// Stops the timer of [`arm_last_resort`]: the run has ended by itself.
pub(super) fn disarm_last_resort() {
    LAST_RESORT.set(0);
}

extern "C" fn on_last_resort(_: i32) {
    if IS_ENDING.load(Ordering::Acquire) {
        const WORDS: &[u8] = b"error: a destructor of a robot program does not return: the process is ended\n";
        // SAFETY: write is async-signal-safe; `WORDS` has as many bytes as are given.
        unsafe { libc::write(2, WORDS.as_ptr().cast(), WORDS.len()) };
        exit_at_once(1)
    }
    if trace_file::has_drained() {
        // The run has ended, and a slow file still takes its trace.
        return arm_last_resort();
    }
    const WORDS: &[u8] = b"error: a robot program on a thread of eyesim has harmed eyesim itself, which cannot go on: the run ends here, and \
        its record is not complete (--exec process keeps such a program apart)\n";
    // SAFETY: write is async-signal-safe; `WORDS` has as many bytes as are given.
    unsafe { libc::write(2, WORDS.as_ptr().cast(), WORDS.len()) };
    exit_after_writing(1)
}

/// Ends this process as soon as the traces on their way to their files are written, after one second at the latest: a
/// reader of a pipe may have stopped. Async-signal-safe.
fn exit_after_writing(code: i32) -> ! {
    for _ in 0..1000 {
        if trace_file::is_all_written() {
            break;
        }
        // SAFETY: async-signal-safe; without descriptors it only waits for a millisecond.
        unsafe { libc::poll(std::ptr::null_mut(), 0, 1) };
    }
    exit_at_once(code)
}

/// Ends this process with exit code 1 after `seconds`, in case a destructor of a program hangs while the process ends
/// by itself; a signal of [`of_process`] ends it earlier. Does nothing without [`of_process`]. Allocates nothing, since
/// a program that failed inside the C library may hold the lock of its allocator.
pub fn end_within(seconds: u32) {
    IS_ENDING.store(true, Ordering::Release);
    LAST_RESORT.set(seconds.into());
}

/// [`end_within`] was called: the command is done.
static IS_ENDING: AtomicBool = AtomicBool::new(false);

/// Does `work` before or after a run, such as to open files: the first signal of [`of_process`] ends the process, since
/// `work` may wait for the reader of a pipe.
pub fn outside_of_run<T>(work: impl FnOnce() -> T) -> T {
    IS_OUTSIDE_OF_RUN.store(true, Ordering::Release);
    let result = work();
    IS_OUTSIDE_OF_RUN.store(false, Ordering::Release);
    result
}

/// [`outside_of_run`] is doing its work.
static IS_OUTSIDE_OF_RUN: AtomicBool = AtomicBool::new(false);

/// Ignores Ctrl-C from now on: it is meant for the debugger, which shares this process's process group.
pub fn leave_interrupts_to_debugger() {
    IS_DEBUGGING.store(true, Ordering::Release);
}

extern "C" fn on_interrupt(signal: i32) {
    if signal == libc::SIGINT && IS_DEBUGGING.load(Ordering::Acquire) {
        return;
    }
    command::interrupt();
    let is_second = PROCESS_INTERRUPT.get().is_some_and(Interrupt::set);
    if is_second || [&IS_OUTSIDE_OF_RUN, &IS_ENDING].iter().any(|flag| flag.load(Ordering::Acquire)) {
        // The second signal, and a signal outside of a run, do not wait for the end of a slot.
        exit_after_writing(130);
    }
}

/// Ends the process with a message: a thread that a program started itself has crashed. The isolation of programs does
/// not cover such threads; the trace contains the record up to the last slot.
extern "C" fn on_foreign_fault(signal: i32) {
    const WORDS: &[u8] =
        b"error: a thread that a robot program started by itself has crashed, or one whose stack and own variables a program has \
        overwritten: such threads are outside the guarantee; the run ends here, the trace is complete up to the last slot\n";
    // SAFETY: neither call takes a pointer, and both always succeed.
    let is_first_thread = unsafe { libc::gettid() == libc::getpid() };
    if is_first_thread || !Handlers::are_installed() {
        // A crash of the host itself: the default action ends the process when the instruction is tried again.
        return default_action(signal);
    }
    // SAFETY: write is async-signal-safe; `WORDS` has as many bytes as are given.
    unsafe { libc::write(2, WORDS.as_ptr().cast(), WORDS.len()) };
    exit_after_writing(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_clones_are_interrupted_together() {
        let interrupt = Interrupt::default();
        let copy = interrupt.clone();
        assert!(!copy.is_set());
        assert!(!interrupt.set());
        assert!(copy.is_set() && copy.set());
        assert!(!Interrupt::default().is_set());
    }
}
