//! Executor with one fiber for each task of a robot, and one OS thread, the worker, for many robots: a hand-over is a switch of stacks.
//!
//! A robot stays on the worker on which it is resumed first: compilers keep addresses of thread-locals, such as that of `errno`, across
//! calls. What belongs to the thread and yet to the program is saved at each switch: `errno` and the floating-point environment.
//!
//! A fault leaves its fiber for good: the signal handler lets the worker go on as if the fiber had returned. The fiber, its stack and
//! its program are kept as they are until the process ends.

use std::cell::Cell;
use std::collections::VecDeque;
use std::io;
use std::mem::ManuallyDrop;
use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock, mpsc};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use corosensei::stack::{DefaultStack, Stack as _};
use corosensei::trap::CoroutineTrapHandler;
use corosensei::{Coroutine, CoroutineResult, Yielder};
use parking_lot::Mutex;
use robios_sys::{Callback, Stop};
use sim_core::RobotId;

use super::fault::Broken;
use super::notifier::Notifier;
use super::process::Child;
use super::signal::{self, Handlers, Leave, OVERDUE_SIGNAL, ThreadBlock};
use super::thread::{self as threads, JOIN_TIMEOUT, STACK};
use super::watchdog::{FlowSample, ReleaseTimer};
use super::{Executor, damage};
use crate::program::float::{self, Environment};
use crate::robios::call::Call;
use crate::robios::task::MAIN;

/// Executor with one fiber for each task.
pub struct FiberExecutor {
    robots: boxcar::Vec<Arc<RobotFibers>>,
    /// Number of workers that will be started with the first fiber.
    worker_count: usize,
    workers: Mutex<Vec<RunningWorker>>,
    /// Reads of `workers` without its lock, set when they start.
    shared_workers: OnceLock<Vec<Arc<Worker>>>,
    /// Notifier that broken flows signal; unset before the run begins.
    notifier: OnceLock<Arc<Notifier>>,
}

/// The thread of a worker. It owns a reference count of the worker, which [`RunningWorker::join`] alone gives back.
struct RunningWorker {
    worker: Arc<Worker>,
    thread: JoinHandle<()>,
}

/// A worker, which runs fibers one after the other on a thread.
struct Worker {
    /// Provides the thread's alternate stack, which the fibers use.
    block: ThreadBlock,
    queue: Mutex<VecDeque<(Arc<RobotFibers>, Arc<Fiber>)>>,
    thread: OnceLock<thread::Thread>,
    is_ending: AtomicBool,
    notifier: Arc<Notifier>,
    /// Keeps the signal handlers installed, for ever if the worker never ends.
    _handlers: Handlers,
}

/// The fibers of one robot.
struct RobotFibers {
    /// The worker on which the robot's fibers run, set when it is resumed first.
    home: OnceLock<Arc<Worker>>,
    flows: Mutex<Flows>,
}

#[derive(Default)]
struct Flows {
    /// Fibers that have not ended, with their tasks' numbers.
    list: Vec<(u32, Arc<Fiber>)>,
    /// The fiber that holds the run token.
    token_holder: Option<Arc<Fiber>>,
}

/// One fiber.
struct Fiber {
    block: ThreadBlock,
    state: Mutex<State>,
    timer: Mutex<ReleaseTimer>,
    /// What suspends the fiber; null before it runs first. Used on the fiber itself only.
    yielder: AtomicPtr<Yielder<(), ()>>,
    /// Top of the stack: the words above the first frame, which lead back to the worker.
    top: AtomicUsize,
    /// The words below `top`, as they were when the fiber was last resumed.
    link: [AtomicUsize; LINK_WORDS],
}

/// Words between the top of a fiber's stack and its first frame: corosensei keeps the worker's stack pointer there.
const LINK_WORDS: usize = 2;

/// State of a fiber.
enum State {
    /// It has not run yet.
    New(DefaultStack, Box<dyn FnOnce() -> Option<u32> + Send>),
    /// It waits for its worker.
    Suspended(Context),
    /// It runs.
    Running,
    Ended,
    /// It has faulted.
    Broken(#[expect(dead_code, reason = "keeps the stack")] Context),
}

/// A fiber that has run, and what a switch saves.
struct Context {
    /// Never dropped unless it has ended: the stack of a suspended fiber holds references to the run.
    coroutine: ManuallyDrop<Coroutine<(), (), Left>>,
    environment: Environment,
    errno: i32,
}

// SAFETY: the coroutine runs on the thread of its worker alone, which takes it from the fiber's state and puts it back: it begins there
// and never runs elsewhere. Other threads at most drop the state, which leaves the coroutine and its stack as they are.
unsafe impl Send for Context {}

/// How a fiber has been left.
#[derive(Clone, Copy)]
enum Left {
    /// Its task has ended; the number of the task that gets the run token next.
    Ended(Option<u32>),
    /// By a fault.
    Faulted,
}

thread_local! {
    /// The fiber that runs on this thread, a worker.
    static CURRENT: Cell<*const Fiber> = const { Cell::new(ptr::null()) };
    /// Leaves that fiber from a signal handler.
    static TRAP: Cell<Option<CoroutineTrapHandler<Left>>> = const { Cell::new(None) };
}

impl FiberExecutor {
    /// Creates an executor with up to `workers` workers.
    pub fn new(workers: usize) -> Self {
        Self {
            robots: boxcar::Vec::new(),
            worker_count: workers,
            workers: Mutex::default(),
            shared_workers: OnceLock::new(),
            notifier: OnceLock::new(),
        }
    }

    fn robot(&self, robot: RobotId) -> &Arc<RobotFibers> {
        &self.robots[robot.index()]
    }

    /// Starts the workers if that has not been done.
    fn start_workers(&self) -> io::Result<()> {
        let Some(notifier) = self.notifier.get() else { unreachable!("the run has begun") };
        let mut workers = self.workers.lock();
        while workers.len() < self.worker_count {
            let worker = RunningWorker::start(workers.len(), notifier)?;
            workers.push(worker);
        }
        self.shared_workers.get_or_init(|| workers.iter().map(|running| Arc::clone(&running.worker)).collect());
        Ok(())
    }
}

impl RunningWorker {
    fn start(number: usize, notifier: &Arc<Notifier>) -> io::Result<Self> {
        let worker = Arc::new(Worker {
            block: ThreadBlock::notifying(Arc::clone(notifier)),
            queue: Mutex::default(),
            thread: OnceLock::new(),
            is_ending: AtomicBool::new(false),
            notifier: Arc::clone(notifier),
            _handlers: Handlers::hold()?,
        });
        let own = Arc::clone(&worker);
        let (adopted, adoption) = mpsc::sync_channel(1);
        let life = move || {
            let own: *const Worker = Arc::into_raw(own);
            // SAFETY: the count that was just taken is given back only after this thread has ended; the block has no other thread.
            let (own, result) = unsafe { (&*own, (*own).block.adopt_current_thread()) };
            let is_adopted = result.is_ok();
            // SAFETY: no fiber runs.
            unsafe { signal::set_current(ptr::null()) };
            // The receiver waits just below for this one message.
            let _ = adopted.send(result);
            if is_adopted {
                own.run();
            }
        };
        let thread = thread::Builder::new().name(format!("worker {number}")).spawn(life)?;
        // Set once.
        let _ = worker.thread.set(thread.thread().clone());
        let running = Self { worker, thread };
        match adoption.recv().map_err(io::Error::other)? {
            Ok(()) => Ok(running),
            Err(error) => {
                running.join();
                Err(error)
            }
        }
    }

    /// Ends the worker; false if it runs a fiber that does not come back: it is lost.
    fn join(self) -> bool {
        const POLL_INTERVAL: Duration = Duration::from_millis(1);
        let Self { worker, thread } = self;
        worker.is_ending.store(true, Ordering::Release);
        worker.wake();
        let start = Instant::now();
        while !thread.is_finished() {
            if start.elapsed() >= JOIN_TIMEOUT {
                return false;
            }
            thread::sleep(POLL_INTERVAL);
        }
        // It does not panic: the process would have aborted.
        let _ = thread.join();
        // SAFETY: the thread has ended, and with it the use of the count that it took.
        unsafe { Arc::decrement_strong_count(Arc::as_ptr(&worker)) };
        true
    }
}

impl Worker {
    fn wake(&self) {
        if let Some(thread) = self.thread.get() {
            thread.unpark();
        }
    }

    /// Lets `fiber` of `robot` run after those that wait already.
    fn enqueue(&self, robot: &Arc<RobotFibers>, fiber: Arc<Fiber>) {
        // What the fibers before it use is not its time.
        fiber.begin_release();
        self.queue.lock().push_back((Arc::clone(robot), fiber));
        self.wake();
    }

    /// Runs fibers until the worker ends.
    fn run(&self) {
        loop {
            let next = self.queue.lock().pop_front();
            match next {
                Some((robot, fiber)) => self.advance(&robot, &fiber),
                None if self.is_ending.load(Ordering::Acquire) => return,
                None => thread::park(),
            }
        }
    }

    /// Runs `fiber` until it suspends itself, ends or faults.
    fn advance(&self, robot: &Arc<RobotFibers>, fiber: &Arc<Fiber>) {
        let state = std::mem::replace(&mut *fiber.state.lock(), State::Running);
        let mut context = match state {
            State::New(stack, flow) => {
                fiber.block.tid.store(self.block.tid.load(Ordering::Relaxed), Ordering::Relaxed);
                fiber.context(stack, flow)
            }
            State::Suspended(context) => context,
            other => {
                *fiber.state.lock() = other;
                return;
            }
        };
        fiber.begin_release();
        context.environment.apply();
        // SAFETY: the address is that of this thread's variable.
        unsafe { *libc::__errno_location() = context.errno };
        TRAP.set(Some(context.coroutine.trap_handler()));
        CURRENT.set(Arc::as_ptr(fiber));
        // SAFETY: the caller's reference keeps the block alive until it is replaced below.
        unsafe { signal::set_current(&raw const fiber.block) };
        let result = context.coroutine.resume(());
        // SAFETY: no fiber runs.
        unsafe { signal::set_current(ptr::null()) };
        CURRENT.set(ptr::null());
        TRAP.set(None);
        // SAFETY: as above.
        context.errno = unsafe { *libc::__errno_location() };
        if fiber.block.has_faulted() {
            float::reset();
            *fiber.state.lock() = State::Broken(context);
            // The stack is no longer written from here on.
            fiber.block.publish_fault();
            self.notifier.notify();
            return;
        }
        match result {
            CoroutineResult::Yield(()) => {
                context.environment = Environment::present();
                *fiber.state.lock() = State::Suspended(context);
            }
            CoroutineResult::Return(left) => {
                drop(ManuallyDrop::into_inner(context.coroutine));
                *fiber.state.lock() = State::Ended;
                let next = match left {
                    Left::Ended(next) => next,
                    Left::Faulted => unreachable!("a fault is stored before"),
                };
                robot.flows.lock().list.retain(|(_, other)| !Arc::ptr_eq(other, fiber));
                if let Some(next) = next {
                    robot.hand_token_to(next);
                }
            }
        }
    }
}

impl RobotFibers {
    /// Hands the run token to `task`, whose fiber runs next on the calling worker. Nothing runs if the run is over and its flows have
    /// been given up.
    fn hand_token_to(self: &Arc<Self>, task: u32) {
        let mut flows = self.flows.lock();
        let next = flows.list.iter().find(|(number, _)| *number == task).map(|(_, fiber)| Arc::clone(fiber));
        if let Some(next) = next {
            flows.token_holder = Some(Arc::clone(&next));
            drop(flows);
            if let Some(home) = self.home.get() {
                home.enqueue(self, next);
            }
        }
    }
}

impl Fiber {
    fn new(flow: Box<dyn FnOnce() -> Option<u32> + Send>) -> io::Result<Self> {
        let stack = DefaultStack::new(STACK)?;
        let block = ThreadBlock::leaving(Leave { from_signal: leave_from_signal, from_call: leave_from_call });
        let (low, top) = (stack.limit().get() + crate::program::share::page_size(), stack.base().get());
        block.stack[0].store(low, Ordering::Relaxed);
        block.stack[1].store(top, Ordering::Relaxed);
        Ok(Self {
            block,
            state: Mutex::new(State::New(stack, flow)),
            timer: Mutex::default(),
            yielder: AtomicPtr::default(),
            top: AtomicUsize::new(top),
            link: Default::default(),
        })
    }

    /// The context in which the fiber begins.
    fn context(self: &Arc<Self>, stack: DefaultStack, flow: Box<dyn FnOnce() -> Option<u32> + Send>) -> Context {
        let own = Arc::clone(self);
        // The host works until the fiber itself has begun.
        self.block.in_host.store(true, Ordering::Relaxed);
        let body = move |yielder: &Yielder<(), ()>, ()| {
            own.yielder.store(ptr::from_ref(yielder).cast_mut(), Ordering::Relaxed);
            own.keep_link();
            own.block.in_host.store(false, Ordering::Relaxed);
            let next = flow();
            own.block.in_host.store(true, Ordering::Relaxed);
            drop(own);
            Left::Ended(next)
        };
        Context {
            coroutine: ManuallyDrop::new(Coroutine::with_stack(stack, body)),
            environment: Environment::INITIAL,
            errno: 0,
        }
    }

    /// The fiber that the calling thread runs; the reference must not leave that fiber.
    fn current<'a>() -> &'a Self {
        // SAFETY: null, or kept alive by the worker's reference as long as the fiber runs, see `Worker::advance`.
        let Some(fiber) = (unsafe { CURRENT.get().as_ref() }) else { unreachable!("only flows of robots come here") };
        fiber
    }

    /// Begins a new release, for which the watchdog measures anew.
    fn begin_release(&self) {
        self.block.releases.fetch_add(1, Ordering::Relaxed);
    }

    /// Suspends this fiber, the calling one, until its worker resumes it.
    fn suspend(&self) {
        // SAFETY: the fiber runs, so that the pointer has been set; the yielder lives on its stack as long as it.
        unsafe { &*self.yielder.load(Ordering::Relaxed) }.suspend(());
        self.keep_link();
    }

    /// Keeps a copy of the way back to the worker, which a program may overwrite when it writes beyond an array on its stack.
    fn keep_link(&self) {
        for (place, word) in self.link.iter().zip(self.link_words()) {
            // SAFETY: a word of the calling fiber's stack, above its first frame.
            place.store(unsafe { word.read() }, Ordering::Relaxed);
        }
    }

    /// The words of the stack that lead back to the worker.
    fn link_words(&self) -> [*mut usize; LINK_WORDS] {
        let top: *mut usize = ptr::with_exposed_provenance_mut(self.top.load(Ordering::Relaxed));
        std::array::from_fn(|index| top.wrapping_sub(index + 1))
    }
}

/// Changes the context of a signal on a fiber so that the fiber returns to its worker; see [`Leave::from_signal`].
///
/// # Safety
/// `context` is what the kernel passed to the handler of a signal on the thread of a worker, which runs a fiber.
unsafe fn leave_from_signal(context: *mut libc::ucontext_t, signal: i32) -> bool {
    // SAFETY: `context` is valid by this function's contract, and no other reference to it exists.
    let context = unsafe { &mut *context };
    let Some(trap) = TRAP.get() else { return false };
    #[cfg(target_arch = "x86_64")]
    let sp = context.uc_mcontext.gregs[libc::REG_RSP as usize] as usize;
    #[cfg(target_arch = "aarch64")]
    let sp = context.uc_mcontext.sp as usize;
    if signal == OVERDUE_SIGNAL && !trap.stack_ptr_in_bounds(sp) {
        return false;
    }
    let fiber = Fiber::current();
    for (place, word) in fiber.link.iter().zip(fiber.link_words()) {
        // SAFETY: a word of the fiber's stack, which is mapped; no code of the fiber will run again but the function below, which
        // needs these words as they were when it was resumed.
        unsafe { word.write(place.load(Ordering::Relaxed)) };
    }
    // SAFETY: the coroutine is running on this thread and alive. Its stack is given up: no code that it interrupts here goes on, and
    // its owner never runs it again. The registers are set below as told. Where the program has lost its stack pointer, the way back
    // does not depend on it.
    let registers = unsafe { trap.setup_trap_handler(|| Left::Faulted) };
    #[cfg(target_arch = "x86_64")]
    {
        /// Flags that calls require to be clear: trap, direction, alignment check.
        const CLEAR: i64 = 0x100 | 0x400 | 0x4_0000;
        let places = &mut context.uc_mcontext.gregs;
        places[libc::REG_RIP as usize] = registers.rip.cast_signed();
        places[libc::REG_RSP as usize] = registers.rsp.cast_signed();
        places[libc::REG_RBP as usize] = registers.rbp.cast_signed();
        places[libc::REG_RDI as usize] = registers.rdi.cast_signed();
        places[libc::REG_RSI as usize] = registers.rsi.cast_signed();
        places[libc::REG_EFL as usize] &= !CLEAR;
    }
    #[cfg(target_arch = "aarch64")]
    {
        let places = &mut context.uc_mcontext;
        (places.pc, places.sp) = (registers.pc, registers.sp);
        (places.regs[0], places.regs[1]) = (registers.x0, registers.x1);
        (places.regs[29], places.regs[30]) = (registers.x29, registers.lr);
    }
    true
}

/// Leaves the calling fiber for good, with its fault stored.
fn leave_from_call() -> ! {
    loop {
        Fiber::current().suspend();
    }
}

impl Executor for FiberExecutor {
    fn begin(&self, notifier: &Arc<Notifier>) {
        damage::heap_functions();
        // A run begins once.
        let _ = self.notifier.set(Arc::clone(notifier));
    }

    fn end(&self, departed: &dyn Fn(RobotId) -> bool) -> bool {
        let mut all_end = true;
        let deadline = Instant::now() + JOIN_TIMEOUT;
        for (index, robot) in &self.robots {
            let list = std::mem::take(&mut *robot.flows.lock()).list;
            let is_broken = list.iter().any(|(_, fiber)| fiber.block.fault().is_some());
            let ends = !is_broken && departed(RobotId::from_index(index));
            for (_, fiber) in list {
                if !fiber.gives_up(ends.then_some(deadline)) {
                    damage::lose_flow();
                    // Its program may have kept addresses of its stack, and the robot's other flows wait for it.
                    std::mem::forget(fiber);
                    all_end = false;
                }
            }
        }
        for worker in self.workers.lock().drain(..) {
            if !worker.join() {
                damage::lose_flow();
                all_end = false;
            }
        }
        all_end
    }

    fn must_end(&self) -> bool {
        damage::is_heap_lost() && self.robots.iter().any(|(_, robot)| !robot.flows.lock().list.is_empty())
    }

    fn admit(&self, robot: RobotId, _: bool) {
        while self.robots.count() <= robot.index() {
            self.robots.push(Arc::new(RobotFibers { home: OnceLock::new(), flows: Mutex::default() }));
        }
    }

    fn start(&self, robot: RobotId, task: u32, flow: Box<dyn FnOnce() -> Option<u32> + Send>) -> io::Result<()> {
        self.start_workers()?;
        let fiber = Arc::new(Fiber::new(flow)?);
        let mut flows = self.robot(robot).flows.lock();
        flows.token_holder.get_or_insert_with(|| Arc::clone(&fiber));
        flows.list.push((task, fiber));
        Ok(())
    }

    fn serve(&self, _: RobotId, _: Arc<Child>) {
        unreachable!("programs in processes of their own are served by threads")
    }

    fn resume(&self, robot: RobotId, worker: u32) {
        let fibers = self.robot(robot);
        let Some(workers) = self.shared_workers.get() else { return };
        let home = fibers.home.get_or_init(|| Arc::clone(&workers[worker as usize]));
        let token_holder = fibers.flows.lock().token_holder.clone();
        if let Some(token_holder) = token_holder {
            home.enqueue(fibers, token_holder);
        }
    }

    fn suspend(&self, _: RobotId) {
        Fiber::current().suspend();
    }

    fn continue_running(&self, _: RobotId) {
        Fiber::current().begin_release();
    }

    fn switch(&self, robot: RobotId, task: u32) {
        self.robot(robot).hand_token_to(task);
        Fiber::current().suspend();
    }

    fn enter(&self, _: RobotId, call: Call) -> bool {
        threads::enter(&Fiber::current().block, call)
    }

    fn leave(&self, _: RobotId) {
        Fiber::current().block.leave_host();
    }

    fn call_back(&self, _: RobotId, callback: Callback) -> Result<(), Stop> {
        // SAFETY: by this method's contract the robot's flow, which is the calling fiber, is in a call of its program, or the first
        // in a task that such a call started, and holds no lock; its frames keep the run alive, and with it the program.
        unsafe { threads::call_back(&Fiber::current().block, callback) }
    }

    fn broken(&self) -> Vec<(RobotId, Broken)> {
        let mut all = Vec::new();
        for (index, robot) in &self.robots {
            let flows = robot.flows.lock();
            for (task, fiber) in &flows.list {
                let is_alone = *task == MAIN && flows.list.len() == 1;
                let broken = threads::broken(&fiber.block, (!is_alone).then_some(*task));
                all.extend(broken.map(|broken| (RobotId::from_index(index), broken)));
            }
        }
        all
    }

    fn is_overdue(&self, robot: RobotId, timeout: f64) -> bool {
        let Some(fiber) = self.robot(robot).flows.lock().token_holder.clone() else { return false };
        if fiber.block.in_host.load(Ordering::Relaxed) {
            fiber.timer.lock().pause();
            return false;
        }
        let sample = FlowSample::at_thread(&fiber.block);
        sample.is_some_and(|sample| fiber.timer.lock().is_overdue(&sample, timeout))
    }

    fn break_overdue(&self, robot: RobotId) {
        let token_holder = self.robot(robot).flows.lock().token_holder.clone();
        if let Some(fiber) = token_holder {
            signal::stop_overdue(&fiber.block);
        }
    }
}

impl Fiber {
    /// Returns true once the fiber holds nothing any more: it has never run, or it ends by this time.
    fn gives_up(&self, deadline: Option<Instant>) -> bool {
        const POLL_INTERVAL: Duration = Duration::from_micros(100);
        loop {
            match &*self.state.lock() {
                State::New(..) | State::Ended => return true,
                State::Suspended(_) | State::Running | State::Broken(_) => {}
            }
            if deadline.is_none_or(|deadline| Instant::now() >= deadline) {
                return false;
            }
            thread::sleep(POLL_INTERVAL);
        }
    }
}
