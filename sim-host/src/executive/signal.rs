//! Signals: what the kernel says of a broken robot program, and of a user who wants to stop.
//!
//! A fault of a program (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT) is caught on the thread's alternate stack, written into
//! the thread's [`ThreadBlock`] and the thread is parked for good: nothing of the program runs again. The supervisor does
//! the rest. The handler calls nothing but `write` and `pause`, and touches only memory allocated before.

use std::cell::Cell;
use std::io;
use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicI32, AtomicU16, AtomicU64, AtomicUsize, Ordering, compiler_fence};

use super::bell;

/// What a signal handler may read and write of one robot's thread; lives until the process ends.
pub struct ThreadBlock {
    /// Kernel's id of the thread, 0 before it runs.
    pub tid: AtomicI32,
    /// Lowest and highest address of the thread's stack.
    pub stack: [AtomicUsize; 2],
    /// How often the robot was resumed: a new number is a new release.
    pub releases: AtomicU64,
    /// Id of the RoBIOS call in progress or, in the program's own code, of the last one; `u16::MAX` before the first.
    pub last_call: AtomicU16,
    /// True while the host works for the program: its locks may be held, so the thread must not be parked there.
    pub in_host: AtomicBool,
    /// Set when the watchdog's signal came while `in_host`: the thread parks itself when it leaves the host.
    overdue: AtomicBool,
    fault_signal: AtomicI32,
    fault_address: AtomicUsize,
    fault_pc: AtomicUsize,
    fault_sp: AtomicUsize,
    faulted: AtomicBool,
    /// What takes a fault instead of parking the thread; async-signal-safe.
    report: Option<Report>,
    /// Where the alternate stack of this block's threads lies, 0 before the first.
    alternate_stack: AtomicUsize,
}

/// Takes a fault of the thread that the block belongs to, on whose alternate stack it runs; a return lets the thread go on.
pub type Report = fn(&ThreadBlock, Fault);

/// A fault as the kernel reported it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Number of the signal; [`OVERDUE_SIGNAL`] when the watchdog stopped the thread.
    pub signal: i32,
    /// Address that the program touched, for SIGSEGV and SIGBUS.
    pub address: usize,
    /// Program counter.
    pub pc: usize,
    /// Stack pointer.
    pub sp: usize,
}

/// The signal by which the watchdog stops an overdue thread.
pub const OVERDUE_SIGNAL: i32 = libc::SIGURG;

/// Signals that mean a broken program.
const FAULT_SIGNALS: [i32; 6] = [libc::SIGSEGV, libc::SIGBUS, libc::SIGFPE, libc::SIGILL, libc::SIGABRT, libc::SIGTRAP];

/// Size of a thread's alternate stack: the handler needs little, the kernel saves up to 12 KiB of registers there.
const ALTERNATE_STACK: usize = 64 * 1024;

thread_local! {
    static CURRENT: Cell<*const ThreadBlock> = const { Cell::new(ptr::null()) };
}

static BELL: AtomicI32 = AtomicI32::new(-1);
/// True while a debugger is to hear Ctrl-C.
static IS_DEBUGGING: AtomicBool = AtomicBool::new(false);
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

impl Default for ThreadBlock {
    /// A block whose thread does not run yet.
    fn default() -> Self {
        Self {
            tid: AtomicI32::new(0),
            stack: Default::default(),
            releases: AtomicU64::new(0),
            last_call: AtomicU16::new(u16::MAX),
            in_host: AtomicBool::new(false),
            overdue: AtomicBool::new(false),
            fault_signal: AtomicI32::new(0),
            fault_address: AtomicUsize::new(0),
            fault_pc: AtomicUsize::new(0),
            fault_sp: AtomicUsize::new(0),
            faulted: AtomicBool::new(false),
            report: None,
            alternate_stack: AtomicUsize::new(0),
        }
    }
}

impl ThreadBlock {
    /// A block whose faults are handed to `report`.
    pub fn reporting(report: Report) -> Self {
        Self { report: Some(report), ..Self::default() }
    }

    /// The fault that parked this thread.
    pub fn fault(&self) -> Option<Fault> {
        self.faulted.load(Ordering::Acquire).then(|| Fault {
            signal: self.fault_signal.load(Ordering::Relaxed),
            address: self.fault_address.load(Ordering::Relaxed),
            pc: self.fault_pc.load(Ordering::Relaxed),
            sp: self.fault_sp.load(Ordering::Relaxed),
        })
    }

    /// The host begins to work for the program.
    pub fn enter_host(&self) {
        self.in_host.store(true, Ordering::Relaxed);
        compiler_fence(Ordering::SeqCst);
    }

    /// The host returns to the program; parks for good if the watchdog's signal came meanwhile.
    pub fn leave_host(&self) {
        compiler_fence(Ordering::SeqCst);
        self.in_host.store(false, Ordering::Relaxed);
        compiler_fence(Ordering::SeqCst);
        if self.overdue.load(Ordering::Relaxed) {
            self.park_faulted(Fault { signal: OVERDUE_SIGNAL, address: 0, pc: 0, sp: 0 });
        }
    }

    /// Publishes the fault, rings the bell and never returns; async-signal-safe.
    fn park_faulted(&self, fault: Fault) -> ! {
        self.fault_signal.store(fault.signal, Ordering::Relaxed);
        self.fault_address.store(fault.address, Ordering::Relaxed);
        self.fault_pc.store(fault.pc, Ordering::Relaxed);
        self.fault_sp.store(fault.sp, Ordering::Relaxed);
        self.faulted.store(true, Ordering::Release);
        bell::ring(BELL.load(Ordering::Acquire));
        loop {
            // SAFETY: pause is async-signal-safe; the thread stays here until the process ends.
            unsafe { libc::pause() };
        }
    }

    /// Lowest and highest address of the thread's stack.
    pub fn stack_bounds(&self) -> [usize; 2] {
        [self.stack[0].load(Ordering::Relaxed), self.stack[1].load(Ordering::Relaxed)]
    }

    /// Bytes of stack left below the caller's frame; `usize::MAX` where the bounds are unknown.
    pub fn stack_left(&self) -> usize {
        let here = 0u8;
        let low = self.stack[0].load(Ordering::Relaxed);
        if low == 0 { usize::MAX } else { ((&raw const here) as usize).saturating_sub(low) }
    }

    /// Makes this block the calling thread's: its bounds are noted and its faults are caught from now on. A thread that had it
    /// before has ended.
    ///
    /// # Errors
    /// When the alternate stack cannot be mapped or set.
    pub fn adopt_current_thread(&'static self) -> io::Result<()> {
        let (low, high) = stack_bounds()?;
        self.stack[0].store(low, Ordering::Relaxed);
        self.stack[1].store(high, Ordering::Relaxed);
        // SAFETY: gettid takes no arguments and always succeeds.
        self.tid.store(unsafe { libc::gettid() }, Ordering::Relaxed);
        self.last_call.store(u16::MAX, Ordering::Relaxed);
        self.in_host.store(false, Ordering::Relaxed);
        self.overdue.store(false, Ordering::Relaxed);
        let alternate = set_alternate_stack(self.alternate_stack.load(Ordering::Relaxed))?;
        self.alternate_stack.store(alternate, Ordering::Relaxed);
        CURRENT.set(self);
        Ok(())
    }
}

/// Catches faults of robot programs and the user's Ctrl-C from now on; `bell` is rung at each.
///
/// # Errors
/// When the kernel refuses a handler.
pub fn install(bell: &bell::Bell) -> io::Result<()> {
    BELL.store(bell.raw(), Ordering::Release);
    catch_faults()?;
    for signal in [libc::SIGINT, libc::SIGTERM] {
        set_handler(signal, on_interrupt as *const () as usize, libc::SA_RESTART)?;
    }
    Ok(())
}

/// In a robot's own process: catches faults of the threads whose blocks [report](ThreadBlock::reporting) them; what ends the host is
/// the host's to hear.
///
/// # Errors
/// When the kernel refuses a handler.
pub fn install_in_child() -> io::Result<()> {
    catch_faults()?;
    for signal in [libc::SIGINT, libc::SIGTERM, libc::SIGHUP, libc::SIGQUIT] {
        set_handler(signal, libc::SIG_IGN, 0)?;
    }
    Ok(())
}

/// Lets `signal` do to this process what it does by default; returns only if that is nothing. Async-signal-safe.
pub fn default_action(signal: i32) {
    // SAFETY: signal and raise are async-signal-safe.
    unsafe {
        libc::signal(signal, libc::SIG_DFL);
        libc::raise(signal);
    }
}

fn catch_faults() -> io::Result<()> {
    for signal in FAULT_SIGNALS.into_iter().chain([OVERDUE_SIGNAL]) {
        set_handler(signal, on_fault as *const () as usize, libc::SA_SIGINFO | libc::SA_ONSTACK)?;
    }
    Ok(())
}

/// No bell is rung any more: the run is over and its bell about to be closed.
pub fn uninstall() {
    BELL.store(-1, Ordering::Release);
}

/// True once the user has asked for the end, of this run and of all that would follow it.
pub fn is_interrupted() -> bool {
    INTERRUPTED.load(Ordering::Acquire)
}

/// Stops the thread of `block` where it is, as a fault of [`OVERDUE_SIGNAL`].
pub fn stop_overdue(block: &ThreadBlock) {
    let tid = block.tid.load(Ordering::Relaxed);
    // SAFETY: tgkill takes no pointer; the thread belongs to this process and is parked, never ended, by its handler.
    unsafe { libc::syscall(libc::SYS_tgkill, libc::getpid(), tid, OVERDUE_SIGNAL) };
}

extern "C" fn on_fault(signal: i32, info: *mut libc::siginfo_t, context: *mut libc::c_void) {
    let block = CURRENT.get();
    if block.is_null() {
        // SAFETY: neither call takes a pointer, and both always succeed.
        let is_first_thread = unsafe { libc::gettid() == libc::getpid() };
        if signal != OVERDUE_SIGNAL && !is_first_thread && BELL.load(Ordering::Relaxed) >= 0 {
            end_with_foreign_fault();
        }
        if signal != OVERDUE_SIGNAL {
            // The host's own fault: let the default action show it when the instruction is tried again.
            default_action(signal);
        }
        return;
    }
    // SAFETY: the block is 'static (see `adopt_current_thread`).
    let block = unsafe { &*block };
    if let Some(report) = block.report {
        // SAFETY: `info` and `context` are what the kernel passed to this SA_SIGINFO handler.
        let (address, (pc, sp)) = unsafe { ((*info).si_addr() as usize, registers(context)) };
        report(block, Fault { signal, address, pc, sp });
        return;
    }
    if signal == OVERDUE_SIGNAL && block.in_host.load(Ordering::Relaxed) {
        block.overdue.store(true, Ordering::Relaxed);
        return;
    }
    // SAFETY: `info` and `context` are what the kernel passed to this SA_SIGINFO handler.
    let (address, (pc, sp)) = unsafe { ((*info).si_addr() as usize, registers(context)) };
    block.park_faulted(Fault { signal, address, pc, sp });
}

/// Ends the process with a message: a thread that a program started itself has faulted. Such threads are outside the guarantee;
/// what is recorded up to the last slot is in the trace. Async-signal-safe.
fn end_with_foreign_fault() -> ! {
    const WORDS: &[u8] =
        b"error: a thread that a robot program started by itself has faulted: such threads are outside the \
        guarantee; the run ends here, the trace is complete up to the last slot\n";
    // SAFETY: write and _exit are async-signal-safe; `WORDS` has as many bytes as are given.
    unsafe {
        libc::write(2, WORDS.as_ptr().cast(), WORDS.len());
        libc::_exit(1)
    }
}

/// From now on Ctrl-C is a debugger's alone, whose process group this process shares.
pub fn leave_interrupts_to_debugger() {
    IS_DEBUGGING.store(true, Ordering::Release);
}

extern "C" fn on_interrupt(signal: i32) {
    if signal == libc::SIGINT && IS_DEBUGGING.load(Ordering::Acquire) {
        return;
    }
    if INTERRUPTED.swap(true, Ordering::AcqRel) {
        // The second Ctrl-C: the user does not want to wait for files to be closed.
        // SAFETY: _exit is async-signal-safe.
        unsafe { libc::_exit(130) };
    }
    bell::ring(BELL.load(Ordering::Acquire));
}

/// Program counter and stack pointer at the fault.
///
/// # Safety
/// `context` is the third argument of an SA_SIGINFO handler.
unsafe fn registers(context: *mut libc::c_void) -> (usize, usize) {
    // SAFETY: the caller's promise.
    let machine = unsafe { &(*context.cast::<libc::ucontext_t>()).uc_mcontext };
    #[cfg(target_arch = "x86_64")]
    return (machine.gregs[libc::REG_RIP as usize] as usize, machine.gregs[libc::REG_RSP as usize] as usize);
    #[cfg(target_arch = "aarch64")]
    return (machine.pc as usize, machine.sp as usize);
}

fn set_handler(signal: i32, handler: usize, flags: i32) -> io::Result<()> {
    // SAFETY: an all-zero sigaction is a valid value; the handlers have the signatures that their flags ask for.
    let status = unsafe {
        let mut action: libc::sigaction = std::mem::zeroed();
        action.sa_sigaction = handler;
        action.sa_flags = flags;
        libc::sigemptyset(&mut action.sa_mask);
        libc::sigaction(signal, &action, ptr::null_mut())
    };
    if status == 0 { Ok(()) } else { Err(io::Error::last_os_error()) }
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

/// Gives the calling thread an alternate signal stack that stays mapped until the process ends, as a parked thread sits on it: the
/// one at `address`, or a new one for 0. Returns its address.
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
    // SAFETY: the memory has the stated size, is never unmapped, and no other thread that lives has it.
    let status = unsafe { libc::sigaltstack(&stack, ptr::null_mut()) };
    if status == 0 { Ok(memory.expose_provenance()) } else { Err(io::Error::last_os_error()) }
}
