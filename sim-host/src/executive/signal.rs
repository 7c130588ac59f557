//! Signal handlers that catch the crashes of robot programs.
//!
//! A crash of a program (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS) is caught on the thread's alternate
//! stack and written into the [`FlowBlock`] of the flow. Then the thread is parked permanently or, for a fiber, leaves
//! the fiber: no code of the program runs on the flow again. The supervisor handles the rest. In a robot's own process,
//! the crash is reported to the host instead. The handler calls only functions that are async-signal-safe, and touches
//! only memory allocated before.
//!
//! [`Handlers`] are installed while any flow of any run lives. A crash in a thread that is not a robot's flow is passed
//! to the previous handler.

use std::cell::Cell;
use std::io;
use std::ptr;
use std::sync::Arc;
use std::sync::atomic::{
    AtomicBool, AtomicI32, AtomicU8, AtomicU16, AtomicU32, AtomicU64, AtomicUsize, Ordering, compiler_fence,
};
use std::time::{Duration, Instant};

use parking_lot::Mutex;
use robios_sys::{CONSOLE_LINE, Console};

use super::interrupt;
use super::notifier::Notifier;
use crate::program::float;

/// State of one flow, a thread or a fiber, that a signal handler may read and write.
pub struct FlowBlock {
    /// Kernel's id of the thread; 0 before the thread runs.
    pub tid: AtomicI32,
    /// Lowest and highest address of the thread's stack.
    pub stack: [AtomicUsize; 2],
    /// Stack pointer of a fiber whose call runs on the stack of its worker; 0 at other times.
    pub caller_sp: AtomicUsize,
    /// Number of the current release; increases whenever the flow is resumed or handed the run token.
    pub releases: AtomicU64,
    /// Number of the RoBIOS call in progress or, in the program's own code, of the last call; `u16::MAX` before the
    /// first call.
    pub last_call: AtomicU16,
    /// The flow is inside a call to the host and may hold its locks, so that the thread must not be parked.
    pub in_host: AtomicBool,
    /// Passes crashes of the thread to the handlers that the process had before the run.
    passes_faults_to_process: AtomicBool,
    /// The program's floating-point environment while the host uses the default one; 0 if the program also uses the
    /// default.
    float_environment: AtomicU32,
    /// The watchdog's signal came while `in_host`: the thread parks itself when it leaves the host.
    is_overdue: AtomicBool,
    /// State of a request for the location, see [`backtrace`].
    backtrace_state: AtomicU8,
    /// Program counter and stack pointer of the location.
    location_registers: [AtomicUsize; 2],
    crash_signal: AtomicI32,
    crash_code: AtomicI32,
    crash_address: AtomicUsize,
    crash_pc: AtomicUsize,
    crash_sp: AtomicUsize,
    /// Address of the program's console streams; 0 if it has none.
    consoles: AtomicUsize,
    /// For each stream, the length and address of its unfinished line at the crash.
    unfinished: [[AtomicUsize; 2]; 2],
    has_crashed: AtomicBool,
    on_crash: OnCrash,
    /// Address of the alternate stack of this block's threads, 0 before the first.
    alternate_stack: AtomicUsize,
    /// [`MARK`] combined with the block's address, once a thread has adopted the block; it distinguishes the block from
    /// other memory.
    mark: AtomicUsize,
}

/// Size of the two console streams of a program, in words.
const CONSOLES_LEN: usize = 2 * size_of::<Console>() / size_of::<usize>();

/// See [`FlowBlock::is_at`].
const MARK: usize = 0x5AFE_B10C_0DDB_A115;

/// No request for the location is open.
const BACKTRACE_READY: u8 = 0;

/// The signal that requests the location has been sent.
const BACKTRACE_REQUESTED: u8 = 1;

/// Action at a crash.
enum OnCrash {
    /// Parks the thread and notifies the supervisor of its run.
    Park(Arc<Notifier>),
    /// Leaves the fiber, whose worker then publishes the crash.
    Leave { exits: FiberExits, notifier: Arc<Notifier> },
    /// Calls this async-signal-safe function.
    Report(CrashCallback),
}

/// Functions that leave a failed fiber.
#[derive(Clone, Copy)]
pub struct FiberExits {
    /// Changes the context of a signal on the fiber so that the fiber's worker continues when the handler returns;
    /// async-signal-safe.
    pub from_signal: unsafe fn(context: *mut libc::ucontext_t),
    /// Leaves the fiber on which it is called.
    pub from_call: fn() -> !,
}

/// Callback for a crash of the thread that the block belongs to; runs on its alternate stack. If it returns, the thread
/// continues.
pub type CrashCallback = fn(&FlowBlock, Crash);

/// A crash as the kernel reported it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Crash {
    /// Number of the signal; [`OVERDUE_SIGNAL`] if the watchdog stopped the thread, [`THREAD_ENDED`] if the thread has
    /// ended.
    pub signal: i32,
    /// The kernel's code of the cause (`si_code`); 0 if unknown, negative if the signal was sent and no instruction
    /// caused it.
    pub code: i32,
    /// Address that the program accessed, for SIGSEGV and SIGBUS; number of the system call for SIGSYS.
    pub address: usize,
    /// Program counter.
    pub pc: usize,
    /// Stack pointer.
    pub sp: usize,
}

/// The signal that stops an overdue thread; the watchdog sends it.
pub const OVERDUE_SIGNAL: i32 = libc::SIGURG;

/// Code of a SIGFPE: an integer was divided by 0 (FPE_INTDIV, which the crate `libc` does not have).
pub const DIVISION_BY_ZERO: i32 = 1;

/// Code of a SIGFPE: the quotient of integers may not have fitted (FPE_INTOVF).
const DIVISION_OVERFLOW: i32 = 2;

/// Used instead of a signal number: the program called `exit` of the C library on a thread of the host.
pub const EXIT_CALLED: i32 = -2;

/// Used instead of a signal number: the thread has ended without the executor's knowledge.
pub const THREAD_ENDED: i32 = -1;

/// Size of a thread's alternate stack: the handler needs little, the kernel saves up to 12 KiB of registers there.
const ALTERNATE_STACK: usize = 64 * 1024;

thread_local! {
    /// Block of the flow that this thread runs; null for none.
    static CURRENT: Cell<*const FlowBlock> = const { Cell::new(ptr::null()) };
}

impl FlowBlock {
    /// Creates a block whose thread does not run yet; a crash parks the thread and signals `notifier`.
    pub fn of_thread(notifier: Arc<Notifier>) -> Self {
        Self::new(OnCrash::Park(notifier))
    }

    /// Creates the block of a fiber; at a crash, its thread leaves the fiber.
    pub fn of_fiber(exits: FiberExits, notifier: Arc<Notifier>) -> Self {
        Self::new(OnCrash::Leave { exits, notifier })
    }

    /// Creates a block whose crashes are passed to `report`.
    pub fn reporting(report: CrashCallback) -> Self {
        Self::new(OnCrash::Report(report))
    }

    fn new(on_crash: OnCrash) -> Self {
        Self {
            tid: AtomicI32::new(0),
            stack: Default::default(),
            caller_sp: AtomicUsize::new(0),
            releases: AtomicU64::new(0),
            last_call: AtomicU16::new(u16::MAX),
            in_host: AtomicBool::new(false),
            passes_faults_to_process: AtomicBool::new(false),
            float_environment: AtomicU32::new(0),
            is_overdue: AtomicBool::new(false),
            backtrace_state: AtomicU8::new(BACKTRACE_READY),
            location_registers: Default::default(),
            crash_signal: AtomicI32::new(0),
            crash_code: AtomicI32::new(0),
            crash_address: AtomicUsize::new(0),
            crash_pc: AtomicUsize::new(0),
            crash_sp: AtomicUsize::new(0),
            consoles: AtomicUsize::new(0),
            unfinished: Default::default(),
            has_crashed: AtomicBool::new(false),
            on_crash,
            alternate_stack: AtomicUsize::new(0),
            mark: AtomicUsize::new(0),
        }
    }

    /// The block of the flow that the calling thread runs; the reference must not leave that flow.
    #[inline]
    pub fn current<'a>() -> &'a Self {
        // SAFETY: null, or the block lives as long as its flow, see `adopt_current_thread` and `set_current`.
        let Some(block) = (unsafe { CURRENT.get().as_ref() }) else { unreachable!("only flows of robots come here") };
        block
    }

    /// Returns true if there is a block at this address, which need not be mapped. Async-signal-safe.
    ///
    /// A program that writes beyond the top of its stack overwrites the thread's own variables, [`CURRENT`] among them.
    fn is_at(address: *const Self) -> bool {
        let mut word = [0_usize];
        let copied = copy_own_memory(address.addr().wrapping_add(std::mem::offset_of!(Self, mark)), &mut word);
        copied == 1 && word[0] == address.addr() ^ MARK
    }

    /// Passes crashes of the block's thread to the handlers of the process from now on, for code that may hold locks of
    /// the process.
    pub fn pass_faults_to_process(&self) {
        self.passes_faults_to_process.store(true, Ordering::Relaxed);
    }

    /// The published crash of this flow; `None` before a crash.
    pub fn crash(&self) -> Option<Crash> {
        self.has_crashed.load(Ordering::Acquire).then(|| Crash {
            signal: self.crash_signal.load(Ordering::Relaxed),
            code: self.crash_code.load(Ordering::Relaxed),
            address: self.crash_address.load(Ordering::Relaxed),
            pc: self.crash_pc.load(Ordering::Relaxed),
            sp: self.crash_sp.load(Ordering::Relaxed),
        })
    }

    /// Marks the thread as working for the program in the host, in the default floating-point environment.
    #[inline]
    pub fn enter_host(&self) {
        self.in_host.store(true, Ordering::Relaxed);
        if let Some(environment) = float::set_default() {
            self.float_environment.store(environment, Ordering::Relaxed);
        }
        compiler_fence(Ordering::SeqCst);
    }

    /// Marks the flow as back in the program; stops it if the watchdog's signal came while the flow was in the host.
    #[inline]
    pub fn leave_host(&self) {
        let environment = self.float_environment.load(Ordering::Relaxed);
        if environment != 0 {
            self.float_environment.store(0, Ordering::Relaxed);
            float::restore(environment);
        }
        compiler_fence(Ordering::SeqCst);
        self.in_host.store(false, Ordering::Relaxed);
        compiler_fence(Ordering::SeqCst);
        if self.is_overdue.load(Ordering::Relaxed) {
            self.stop_crashed(Crash { signal: OVERDUE_SIGNAL, ..Crash::default() });
        }
    }

    /// Permanently stops the calling flow, to which the block belongs; async-signal-safe for threads.
    fn stop_crashed(&self, crash: Crash) -> ! {
        if let OnCrash::Leave { exits, .. } = &self.on_crash {
            self.store(crash);
            (exits.from_call)();
        }
        self.publish(crash);
        loop {
            // SAFETY: pause is async-signal-safe; the thread stays here until the process ends.
            unsafe { libc::pause() };
        }
    }

    /// Marks the block's thread as gone: it has ended without returning from its flow, by a system call of the program.
    pub fn set_gone(&self) {
        self.publish(Crash { signal: THREAD_ENDED, ..Crash::default() });
    }

    /// Publishes the crash and notifies the supervisor; async-signal-safe.
    fn publish(&self, crash: Crash) {
        self.store(crash);
        self.publish_stored();
    }

    /// Stores the crash, which is not published yet; async-signal-safe.
    fn store(&self, crash: Crash) {
        self.crash_signal.store(crash.signal, Ordering::Relaxed);
        self.crash_code.store(crash.code, Ordering::Relaxed);
        self.crash_address.store(crash.address, Ordering::Relaxed);
        self.crash_pc.store(crash.pc, Ordering::Relaxed);
        // While a call runs on the worker's stack, the frames of the program are those above the call.
        let caller_sp = self.caller_sp.load(Ordering::Relaxed);
        self.crash_sp.store(if caller_sp == 0 { crash.sp } else { caller_sp }, Ordering::Relaxed);
        self.store_unfinished();
    }

    /// Sets the address at which the program of this flow collects its output, see
    /// [`Program::consoles`](robios_sys::Program::consoles).
    pub fn set_consoles(&self, address: usize) {
        self.consoles.store(address, Ordering::Relaxed);
    }

    /// Stores the addresses of the program's unfinished lines: robots that share a copy of their library overwrite the
    /// variables that contain these addresses, but not the lines. Async-signal-safe.
    pub fn store_unfinished(&self) {
        let address = self.consoles.load(Ordering::Relaxed);
        let mut consoles = [0; CONSOLES_LEN];
        if address == 0 || copy_if_mapped(address, &mut consoles) != Some(consoles.len()) {
            return;
        }
        for (unfinished, console) in self.unfinished.iter().zip(consoles.chunks_exact(CONSOLES_LEN / 2)) {
            // The program may have overwritten these words.
            let used = if console[1] <= CONSOLE_LINE { console[1] } else { 0 };
            unfinished[0].store(used, Ordering::Relaxed);
            unfinished[1].store(console[2], Ordering::Relaxed);
        }
    }

    /// Copies the unfinished line of standard output (0) or standard error (1) at the crash to `line`; returns its
    /// length in bytes. Async-signal-safe.
    pub fn unfinished_line(&self, console: usize, line: &mut [usize; CONSOLE_LINE / size_of::<usize>()]) -> usize {
        let [used, address] = self.unfinished[console].each_ref().map(|word| word.load(Ordering::Relaxed));
        let copied = copy_if_mapped(address, &mut line[..used.div_ceil(size_of::<usize>())]).unwrap_or(0);
        used.min(copied * size_of::<usize>())
    }

    /// Returns true if a crash is stored.
    pub fn has_stored_fault(&self) -> bool {
        self.crash_signal.load(Ordering::Relaxed) != 0
    }

    /// Publishes the stored crash and notifies the supervisor; async-signal-safe. A fiber's crash is published once the
    /// fiber has been left.
    pub fn publish_stored(&self) {
        self.has_crashed.store(true, Ordering::Release);
        if let OnCrash::Park(notifier) | OnCrash::Leave { notifier, .. } = &self.on_crash {
            notifier.notify_break();
        }
    }

    /// Lowest and highest address of the thread's stack.
    pub fn stack_bounds(&self) -> [usize; 2] {
        [self.stack[0].load(Ordering::Relaxed), self.stack[1].load(Ordering::Relaxed)]
    }

    /// Bytes of stack that remain below the caller's frame; `usize::MAX` where the bounds are unknown.
    #[inline]
    pub fn remaining_stack(&self) -> usize {
        let local = 0u8;
        let low = self.stack[0].load(Ordering::Relaxed);
        if low == 0 { usize::MAX } else { ((&raw const local) as usize).saturating_sub(low) }
    }

    /// Makes this block the calling thread's: records the stack bounds and catches the thread's crashes from now on.
    ///
    /// # Errors
    /// The alternate stack cannot be mapped or set.
    ///
    /// # Safety
    /// The block must outlive the calling thread, and a thread that adopted it before must have ended.
    pub unsafe fn adopt_current_thread(&self) -> io::Result<()> {
        let (low, high) = stack_bounds()?;
        self.stack[0].store(low, Ordering::Relaxed);
        self.stack[1].store(high, Ordering::Relaxed);
        // SAFETY: gettid takes no arguments and always succeeds.
        self.tid.store(unsafe { libc::gettid() }, Ordering::Relaxed);
        self.last_call.store(u16::MAX, Ordering::Relaxed);
        self.in_host.store(false, Ordering::Relaxed);
        self.float_environment.store(0, Ordering::Relaxed);
        self.is_overdue.store(false, Ordering::Relaxed);
        let alternate = set_alternate_stack(self.alternate_stack.load(Ordering::Relaxed))?;
        self.alternate_stack.store(alternate, Ordering::Relaxed);
        self.mark.store(ptr::from_ref(self).addr() ^ MARK, Ordering::Relaxed);
        CURRENT.set(self);
        Ok(())
    }
}

impl FlowBlock {
    /// Makes this the block of a fiber that runs on the calling thread, that of `worker`, on the stack with these
    /// bounds.
    pub fn adopt_fiber(&self, worker: &Self, [low, top]: [usize; 2]) {
        self.stack[0].store(low, Ordering::Relaxed);
        self.stack[1].store(top, Ordering::Relaxed);
        self.tid.store(worker.tid.load(Ordering::Relaxed), Ordering::Relaxed);
        self.mark.store(ptr::from_ref(self).addr() ^ MARK, Ordering::Relaxed);
    }
}

/// Makes `block`, the block of the fiber that the calling worker's thread runs next, the thread's current block; null
/// for none. The alternate stack of the thread's own block remains in use.
///
/// # Safety
/// The block must be alive until it is replaced.
pub unsafe fn set_current(block: *const FlowBlock) {
    CURRENT.set(block);
}

impl Drop for FlowBlock {
    fn drop(&mut self) {
        let address = *self.alternate_stack.get_mut();
        if address != 0 {
            // SAFETY: mapped with this size by `set_alternate_stack`; by the contract of `adopt_current_thread` the
            // threads that adopted the block have ended, and no other code knows the address.
            unsafe { libc::munmap(ptr::with_exposed_provenance_mut(address), ALTERNATE_STACK) };
        }
    }
}

/// Catches the crashes of flows as long as any value of this type lives; dropping the last value restores the previous
/// handlers.
#[derive(Debug)]
pub struct Handlers(());

/// The signals that [`Handlers`] catch.
const CAUGHT_SIGNALS: [i32; 8] = [
    libc::SIGSEGV,
    libc::SIGBUS,
    libc::SIGFPE,
    libc::SIGILL,
    libc::SIGABRT,
    libc::SIGTRAP,
    libc::SIGSYS,
    OVERDUE_SIGNAL,
];

/// State shared by all values of [`Handlers`].
struct HandlerState {
    count: usize,
    /// The previous action of each signal of [`CAUGHT_SIGNALS`], while our handler is installed.
    previous: [Option<libc::sigaction>; CAUGHT_SIGNALS.len()],
}

static HANDLER_STATE: Mutex<HandlerState> =
    Mutex::new(HandlerState { count: 0, previous: [None; CAUGHT_SIGNALS.len()] });

/// True while any [`Handlers`] live; read in signal handlers.
static ARE_INSTALLED: AtomicBool = AtomicBool::new(false);

/// The parts of a signal's previous action that our handler needs.
struct PreviousAction {
    handler: AtomicUsize,
    flags: AtomicI32,
}

/// The previous actions of [`CAUGHT_SIGNALS`], valid once our handler has been installed. They are kept after that,
/// since other code may chain to our handler later.
static PREVIOUS_ACTIONS: [PreviousAction; CAUGHT_SIGNALS.len()] =
    [const { PreviousAction { handler: AtomicUsize::new(libc::SIG_DFL), flags: AtomicI32::new(0) } };
        CAUGHT_SIGNALS.len()];

impl Handlers {
    /// Installs the handlers unless they are already installed.
    ///
    /// # Errors
    /// The kernel refuses a handler.
    pub fn install() -> io::Result<Self> {
        let mut state = HANDLER_STATE.lock();
        if state.count == 0 {
            state.install().inspect_err(|_| state.restore())?;
        }
        state.count += 1;
        Ok(Self(()))
    }

    /// Reinstalls the handlers that programs have replaced: by the default action, by ignoring the signal, or by a
    /// function of their own, for which `is_of_program` returns true. Handlers that other code has installed over ours
    /// stay.
    pub fn reinstall(is_of_program: impl Fn(usize) -> bool) {
        let state = HANDLER_STATE.lock();
        let on_crash = action(on_crash as *const () as usize, libc::SA_SIGINFO | libc::SA_ONSTACK);
        for (signal, previous) in CAUGHT_SIGNALS.into_iter().zip(&state.previous) {
            if previous.is_some() {
                reinstall(signal, &on_crash, &is_of_program);
            }
        }
    }

    /// Returns true while any value of this type lives.
    pub fn are_installed() -> bool {
        ARE_INSTALLED.load(Ordering::Acquire)
    }
}

impl Drop for Handlers {
    fn drop(&mut self) {
        let mut state = HANDLER_STATE.lock();
        state.count -= 1;
        if state.count == 0 {
            state.restore();
        }
    }
}

impl HandlerState {
    fn install(&mut self) -> io::Result<()> {
        guard_process();
        let on_crash = action(on_crash as *const () as usize, libc::SA_SIGINFO | libc::SA_ONSTACK);
        for (index, signal) in CAUGHT_SIGNALS.into_iter().enumerate() {
            // SAFETY: nothing changes.
            let previous = unsafe { change_action(signal, None) }?;
            // Our handler may still be installed below another handler that chains to it, unless other code has
            // restored the default action.
            let is_reset = matches!(previous.sa_sigaction, libc::SIG_DFL | libc::SIG_IGN);
            if self.previous[index].is_none() || is_reset {
                PREVIOUS_ACTIONS[index].handler.store(previous.sa_sigaction, Ordering::Relaxed);
                PREVIOUS_ACTIONS[index].flags.store(previous.sa_flags, Ordering::Release);
                // SAFETY: `on_crash` has the type of an SA_SIGINFO handler; what it calls is async-signal-safe.
                unsafe { change_action(signal, Some(&on_crash)) }?;
                self.previous[index] = Some(previous);
            }
        }
        ARE_INSTALLED.store(true, Ordering::Release);
        Ok(())
    }

    /// Restores the previous handlers, unless other code has installed its own over ours.
    fn restore(&mut self) {
        ARE_INSTALLED.store(false, Ordering::Release);
        for (signal, previous) in CAUGHT_SIGNALS.into_iter().zip(&mut self.previous) {
            let is_ours = |now: libc::sigaction| now.sa_sigaction == on_crash as *const () as usize;
            // SAFETY: the first call changes nothing, the second restores the previous action, which came from the
            // kernel.
            unsafe {
                if previous.is_some() && change_action(signal, None).is_ok_and(is_ours) {
                    let _ = change_action(signal, previous.take().as_ref());
                }
            }
        }
    }
}

/// Registers the functions that the C library calls when a program on a thread of the host ends or forks the process;
/// does so once.
fn guard_process() {
    static ARE_REGISTERED: std::sync::Once = std::sync::Once::new();
    ARE_REGISTERED.call_once(|| {
        // SAFETY: the functions belong to this binary, which is never unloaded; if they cannot be registered, nothing
        // is guarded.
        unsafe {
            libc::atexit(on_exit);
            libc::pthread_atfork(None, None, Some(on_fork_in_child));
        }
    });
}

/// The block of the calling thread if the thread is a robot's flow and runs code of the program.
fn block_of_program<'a>() -> Option<&'a FlowBlock> {
    // SAFETY: null, or the block lives as long as this thread (see `adopt_current_thread`), which does not pass it on.
    let block = unsafe { CURRENT.get().as_ref() }?;
    (!matches!(block.on_crash, OnCrash::Report(_)) && !block.in_host.load(Ordering::Relaxed)).then_some(block)
}

/// Parks the flow of a program that ends the process by `exit`, before any other function registered for the end is
/// called.
extern "C" fn on_exit() {
    if let Some(block) = block_of_program() {
        let local = 0u8;
        block.stop_crashed(Crash { signal: EXIT_CALLED, sp: (&raw const local).addr(), ..Crash::default() });
    }
}

/// Ends the fork of the host that a program has made on a thread of the host.
extern "C" fn on_fork_in_child() {
    const WORDS: &[u8] =
        b"error: a robot program on a thread of eyesim has forked: the copy of eyesim is ended at once \
        (--exec process keeps such a program apart)\n";
    if block_of_program().is_some() {
        // SAFETY: all three are async-signal-safe, and `WORDS` has as many bytes as are given.
        unsafe {
            libc::write(2, WORDS.as_ptr().cast(), WORDS.len());
            libc::kill(libc::getpid(), libc::SIGKILL);
        }
    }
}

/// Passes a signal to the previous handler; async-signal-safe if that handler is.
///
/// # Safety
/// The arguments must be those of an SA_SIGINFO handler.
unsafe fn chain_to_previous(signal: i32, info: *mut libc::siginfo_t, context: *mut libc::c_void) {
    let Some(previous) =
        CAUGHT_SIGNALS.iter().position(|caught| *caught == signal).map(|index| &PREVIOUS_ACTIONS[index])
    else {
        return;
    };
    let flags = previous.flags.load(Ordering::Acquire);
    let handler = ptr::with_exposed_provenance::<()>(previous.handler.load(Ordering::Relaxed));
    // SAFETY: the kernel's information, by this function's contract.
    let is_from_kernel = unsafe { (*info).si_code } > 0;
    match handler.addr() {
        libc::SIG_IGN if !is_from_kernel => {}
        // A crash cannot be ignored.
        libc::SIG_DFL | libc::SIG_IGN if signal != OVERDUE_SIGNAL => default_action(signal),
        libc::SIG_DFL | libc::SIG_IGN => {}
        _ if flags & libc::SA_SIGINFO != 0 => {
            type Handler = extern "C" fn(i32, *mut libc::siginfo_t, *mut libc::c_void);
            // SAFETY: neither of the two constants, so a handler of this type by its flags, which its owner keeps in
            // place.
            unsafe { std::mem::transmute::<*const (), Handler>(handler)(signal, info, context) }
        }
        // SAFETY: as above, of the other type.
        _ => unsafe { std::mem::transmute::<*const (), extern "C" fn(i32)>(handler)(signal) },
    }
}

/// Installs the handlers permanently in a robot's own process: they catch crashes of the threads whose blocks
/// [report](FlowBlock::reporting) them. Signals that interrupt the host are ignored: the host handles them.
///
/// # Errors
/// The kernel refuses a handler.
pub fn install_in_child() -> io::Result<()> {
    std::mem::forget(Handlers::install()?);
    for signal in [libc::SIGINT, libc::SIGTERM, libc::SIGHUP, libc::SIGQUIT] {
        // SAFETY: no handler.
        unsafe { change_action(signal, Some(&action(libc::SIG_IGN, 0))) }?;
    }
    Ok(())
}

/// Copies this process's memory at `address` into `words`, as far as it is mapped; returns the number of copied
/// words. If the kernel lacks the call that checks this, the memory must be mapped. Async-signal-safe.
pub fn copy_own_memory(address: usize, words: &mut [usize]) -> usize {
    copy_if_mapped(address, words).unwrap_or_else(|| {
        let from = ptr::with_exposed_provenance::<usize>(address);
        // SAFETY: callers pass addresses of stacks, which are assumed to be mapped; every bit pattern is a valid usize.
        words.iter_mut().enumerate().for_each(|(index, word)| *word = unsafe { from.add(index).read_unaligned() });
        words.len()
    })
}

/// Like [`copy_own_memory`], for an address that may be invalid; `None` if the kernel does not allow the copy.
/// Async-signal-safe.
fn copy_if_mapped(address: usize, words: &mut [usize]) -> Option<usize> {
    let local = libc::iovec { iov_base: words.as_mut_ptr().cast(), iov_len: size_of_val(words) };
    let remote = libc::iovec { iov_base: ptr::without_provenance_mut(address), iov_len: size_of_val(words) };
    // SAFETY: the kernel copies from this process itself, and stops where nothing is mapped; `words` has the stated
    // size.
    let copied = unsafe { libc::process_vm_readv(libc::getpid(), &raw const local, 1, &raw const remote, 1, 0) };
    // A kernel that does not allow the copy returns a different error.
    let is_allowed = copied >= 0 || io::Error::last_os_error().raw_os_error() == Some(libc::EFAULT);
    is_allowed.then_some(copied.max(0).unsigned_abs() / size_of::<usize>())
}

/// Sets the highest address of the stack in the calling thread's block, if there is one; returns the previous address.
pub fn set_stack_top(high: usize) -> usize {
    // SAFETY: null, or the block lives as long as this thread (see `adopt_current_thread`).
    unsafe { CURRENT.get().as_ref() }.map_or(0, |block| block.stack[1].swap(high, Ordering::Relaxed))
}

/// Performs the default action of `signal`; returns only if that does not end the process. Async-signal-safe.
pub fn default_action(signal: i32) {
    // SAFETY: signal and raise are async-signal-safe.
    unsafe {
        libc::signal(signal, libc::SIG_DFL);
        libc::raise(signal);
    }
}

/// Stops the thread of `block` where it is, as a crash of [`OVERDUE_SIGNAL`].
pub fn stop_overdue(block: &FlowBlock) {
    block.is_overdue.store(true, Ordering::Relaxed);
    let tid = block.tid.load(Ordering::Relaxed);
    // SAFETY: tgkill takes no pointer; if the thread has ended meanwhile, the call fails without effect.
    unsafe { libc::syscall(libc::SYS_tgkill, libc::getpid(), tid, OVERDUE_SIGNAL) };
}

/// Program counter and stack pointer of the running flow of `block`; its thread continues immediately. `None` if the
/// flow is inside a call, or no longer runs.
pub fn backtrace(block: &FlowBlock) -> Option<[usize; 2]> {
    /// Time within which a running thread receives the signal, even on a loaded machine.
    const TIMEOUT: Duration = Duration::from_millis(200);
    block.backtrace_state.store(BACKTRACE_REQUESTED, Ordering::Relaxed);
    let tid = block.tid.load(Ordering::Relaxed);
    // SAFETY: tgkill takes no pointer; if the thread has ended meanwhile, the call fails without effect.
    unsafe { libc::syscall(libc::SYS_tgkill, libc::getpid(), tid, OVERDUE_SIGNAL) };
    let start = Instant::now();
    while block.backtrace_state.load(Ordering::Acquire) == BACKTRACE_REQUESTED {
        if start.elapsed() > TIMEOUT {
            // The signal may still arrive; its handler then finds no request.
            block.backtrace_state.store(BACKTRACE_READY, Ordering::Relaxed);
            return None;
        }
        std::thread::sleep(Duration::from_micros(100));
    }
    Some([0, 1].map(|index| block.location_registers[index].load(Ordering::Relaxed)))
}

extern "C" fn on_crash(signal: i32, info: *mut libc::siginfo_t, context: *mut libc::c_void) {
    let block = CURRENT.get();
    if block.is_null() || !FlowBlock::is_at(block) {
        // SAFETY: the arguments are what the kernel passed to this SA_SIGINFO handler.
        return unsafe { chain_to_previous(signal, info, context) };
    }
    // SAFETY: the block lives as long as this thread (see `adopt_current_thread`), and is at the address in the
    // variable.
    let block = unsafe { &*block };
    if block.passes_faults_to_process.load(Ordering::Relaxed) {
        // SAFETY: as above.
        return unsafe { chain_to_previous(signal, info, context) };
    }
    if !matches!(block.on_crash, OnCrash::Report(_)) && signal == OVERDUE_SIGNAL {
        // The signal may be late: another fiber runs on the thread by now. Inside a call, the thread stops when it
        // leaves the host.
        let in_host = block.in_host.load(Ordering::Relaxed);
        if block.backtrace_state.load(Ordering::Relaxed) == BACKTRACE_REQUESTED && !in_host {
            // SAFETY: `context` is what the kernel passed to this SA_SIGINFO handler.
            let (pc, sp) = unsafe { registers(context) };
            block.location_registers[0].store(pc, Ordering::Relaxed);
            block.location_registers[1].store(sp, Ordering::Relaxed);
            block.backtrace_state.store(BACKTRACE_READY, Ordering::Release);
        }
        if !block.is_overdue.load(Ordering::Relaxed) || in_host {
            return;
        }
    }
    // SAFETY: `info` and `context` are what the kernel passed to this SA_SIGINFO handler.
    let (code, address, (pc, sp)) = unsafe { ((*info).si_code, accessed_address(signal, info), registers(context)) };
    let code = match code {
        libc::SI_USER => -1,
        // SAFETY: as above.
        DIVISION_BY_ZERO if signal == libc::SIGFPE && unsafe { may_overflow(context) } => DIVISION_OVERFLOW,
        code => code,
    };
    let crash = Crash { signal, code, address, pc, sp };
    if !matches!(block.on_crash, OnCrash::Report(_)) {
        interrupt::arm_last_resort();
    }
    match &block.on_crash {
        OnCrash::Park(_) => block.stop_crashed(crash),
        OnCrash::Leave { exits, .. } => {
            block.store(crash);
            // SAFETY: `context` is the kernel's context of a signal on the worker that runs the fiber of this block.
            unsafe { (exits.from_signal)(context.cast()) };
        }
        OnCrash::Report(report) => report(block, crash),
    }
}

/// Accessed address; for SIGSYS, the number of the system call.
///
/// # Safety
/// `info` must be the second argument of an SA_SIGINFO handler.
unsafe fn accessed_address(signal: i32, info: *mut libc::siginfo_t) -> usize {
    if signal == libc::SIGSYS {
        // SAFETY: the kernel's siginfo_t, 128 bytes, has the number after the address of the call, at byte 24.
        return unsafe { info.cast::<i32>().add(6).read() } as usize;
    }
    // SAFETY: by this function's contract.
    unsafe { (*info).si_addr() as usize }
}

/// Returns true if the quotient of a division that has trapped may have overflowed: the dividend is the minimum
/// integer.
///
/// # Safety
/// `context` must be the third argument of an SA_SIGINFO handler.
unsafe fn may_overflow(context: *mut libc::c_void) -> bool {
    #[cfg(target_arch = "x86_64")]
    {
        // SAFETY: by this function's contract.
        let dividend = unsafe { (*context.cast::<libc::ucontext_t>()).uc_mcontext.gregs[libc::REG_RAX as usize] };
        dividend == i64::MIN || dividend as i32 == i32::MIN
    }
    #[cfg(not(target_arch = "x86_64"))]
    {
        let _ = context;
        true
    }
}

/// Program counter and stack pointer at the crash.
///
/// # Safety
/// `context` must be the third argument of an SA_SIGINFO handler.
unsafe fn registers(context: *mut libc::c_void) -> (usize, usize) {
    // SAFETY: by this function's contract.
    let machine = unsafe { &(*context.cast::<libc::ucontext_t>()).uc_mcontext };
    #[cfg(target_arch = "x86_64")]
    return (machine.gregs[libc::REG_RIP as usize] as usize, machine.gregs[libc::REG_RSP as usize] as usize);
    #[cfg(target_arch = "aarch64")]
    return (machine.pc as usize, machine.sp as usize);
}

/// Signal action for [`change_action`], with an empty mask.
pub(super) fn action(handler: usize, flags: i32) -> libc::sigaction {
    // SAFETY: an all-zero sigaction is a valid value: no flags, an empty mask.
    let mut action: libc::sigaction = unsafe { std::mem::zeroed() };
    (action.sa_sigaction, action.sa_flags) = (handler, flags);
    action
}

/// Reinstalls the handler of `action` for `signal` if a program has replaced it, see [`Handlers::reinstall`].
pub(super) fn reinstall(signal: i32, action: &libc::sigaction, is_of_program: &impl Fn(usize) -> bool) {
    let is_replaced = |now: &libc::sigaction| {
        matches!(now.sa_sigaction, libc::SIG_DFL | libc::SIG_IGN) || is_of_program(now.sa_sigaction)
    };
    // SAFETY: the first call changes nothing; `action` has been installed before.
    unsafe {
        if change_action(signal, None).is_ok_and(|now| now.sa_sigaction != action.sa_sigaction && is_replaced(&now)) {
            let _ = change_action(signal, Some(action));
        }
    }
}

/// Returns the current action of `signal`, and installs `new` if given.
///
/// # Safety
/// The handler of `new` must have the type that its flags require, and be async-signal-safe.
pub(super) unsafe fn change_action(signal: i32, new: Option<&libc::sigaction>) -> io::Result<libc::sigaction> {
    let mut old = action(libc::SIG_DFL, 0);
    // SAFETY: `new` is null or valid, as `old` is; the handler is safe by this function's contract.
    let status = unsafe { libc::sigaction(signal, new.map_or(ptr::null(), ptr::from_ref), &mut old) };
    if status == 0 { Ok(old) } else { Err(io::Error::last_os_error()) }
}

/// Lowest and highest address of the calling thread's stack, without its guard page.
fn stack_bounds() -> io::Result<(usize, usize)> {
    let (mut low, mut size) = (ptr::null_mut(), 0);
    // SAFETY: the attribute object is filled by pthread_getattr_np before it is read, and destroyed once.
    let status = unsafe {
        let mut attributes: libc::pthread_attr_t = std::mem::zeroed();
        let status = libc::pthread_getattr_np(libc::pthread_self(), &mut attributes);
        if status == 0 {
            libc::pthread_attr_getstack(&attributes, &mut low, &mut size);
            libc::pthread_attr_destroy(&mut attributes);
        }
        status
    };
    if status == 0 { Ok((low as usize, low as usize + size)) } else { Err(io::Error::from_raw_os_error(status)) }
}

/// Gives the calling thread an alternate signal stack: the one at `address`, or a new one for 0. Returns its address.
fn set_alternate_stack(address: usize) -> io::Result<usize> {
    let mut memory = ptr::with_exposed_provenance_mut(address);
    if address == 0 {
        // SAFETY: a fresh anonymous mapping of the stated size.
        memory = unsafe {
            libc::mmap(
                ptr::null_mut(),
                ALTERNATE_STACK,
                libc::PROT_READ | libc::PROT_WRITE,
                libc::MAP_PRIVATE | libc::MAP_ANONYMOUS | libc::MAP_NORESERVE,
                -1,
                0,
            )
        };
        if memory == libc::MAP_FAILED {
            return Err(io::Error::last_os_error());
        }
    }
    let stack = libc::stack_t { ss_sp: memory, ss_flags: 0, ss_size: ALTERNATE_STACK };
    // SAFETY: the memory has the stated size, stays mapped as long as the thread's block, and no other living thread
    // uses it.
    let status = unsafe { libc::sigaltstack(&stack, ptr::null_mut()) };
    if status == 0 { Ok(memory.expose_provenance()) } else { Err(io::Error::last_os_error()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    static RECEIVED: AtomicI32 = AtomicI32::new(0);

    extern "C" fn receive(signal: i32) {
        RECEIVED.store(signal, Ordering::Relaxed);
    }

    #[test]
    fn previous_handler_gets_other_signals_and_is_restored() {
        let handler = || {
            // SAFETY: nothing changes.
            unsafe { change_action(OVERDUE_SIGNAL, None) }.unwrap().sa_sigaction
        };
        // SAFETY: a handler without SA_SIGINFO gets a number, and stores it.
        let previous =
            unsafe { change_action(OVERDUE_SIGNAL, Some(&action(receive as *const () as usize, 0))) }.unwrap();
        let held = [Handlers::install().unwrap(), Handlers::install().unwrap()];
        assert_eq!(handler(), on_crash as *const () as usize);
        // SAFETY: raise takes no pointer.
        unsafe { libc::raise(OVERDUE_SIGNAL) };
        assert_eq!(RECEIVED.load(Ordering::Relaxed), OVERDUE_SIGNAL);
        let [first, second] = held;
        drop(first);
        assert!(Handlers::are_installed());
        drop(second);
        assert_eq!(handler(), receive as *const () as usize);
        // SAFETY: the previous action came from the kernel.
        unsafe { change_action(OVERDUE_SIGNAL, Some(&previous)) }.unwrap();
    }
}
