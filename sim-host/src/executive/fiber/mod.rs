//! Executor with one fiber for each task of a robot. A worker is an OS thread that runs the fibers of many robots. A
//! hand-over is a stack switch.
//!
//! A robot stays on the worker on which it is first resumed, because compilers keep addresses of thread-locals, such as
//! `errno`, across calls. A switch saves the program's state that is stored per thread: `errno` and the floating-point
//! environment.
//!
//! After a crash the fiber never runs again: the signal handler lets the worker continue as if the fiber had suspended
//! itself. The fiber, its stack and its program are kept unchanged until the process ends. The return path to the
//! worker does not use the fiber's stack, so this works even if the program has destroyed its stack.

mod stack;
mod switch;

pub use self::stack::mappings_per_stack;

use std::any::Any;
use std::cell::{Cell, UnsafeCell};
use std::collections::VecDeque;
use std::io;
use std::panic::{self, AssertUnwindSafe};
use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicU8, AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock, mpsc};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use parking_lot::Mutex;

use sim_core::RobotId;

use self::stack::{Stack, Stacks};
use super::failure::Failure;
use super::notifier::Notifier;
use super::prefetch::{prefetch, prefetch_value};
use super::process::Child;
use super::program::RobotProgram;
use super::run::Member;
use super::shared_loop::{Job, SharedLoop};
use super::signal::{self, FiberExits, FlowBlock, Handlers};
use super::thread::{self as threads, JOIN_TIMEOUT, STACK};
use super::watchdog::{FlowSample, ReleaseTimer};
use super::{Executor, damage, interrupt};
use crate::program::float::{self, Environment};
use crate::program::shared::Variables;

use crate::robios::task::MAIN;

/// Executor with one fiber for each task.
pub struct FiberExecutor {
    robots: boxcar::Vec<Arc<RobotFibers>>,
    /// Number of workers, which start with the first fiber.
    worker_count: usize,
    /// The workers, once they have started.
    workers: OnceLock<Vec<Arc<Worker>>>,
    /// The workers' threads, until they are joined.
    threads: Mutex<Vec<RunningWorker>>,
    /// The parallel loop with which idle workers help.
    shared_loop: Arc<SharedLoop>,
    stacks: Arc<Stacks>,
    /// Notifier that failed flows signal; unset before the run begins.
    notifier: OnceLock<Arc<Notifier>>,
}

/// The thread of a worker. It owns a reference count of the worker, which only [`RunningWorker::join`] releases.
struct RunningWorker {
    worker: Arc<Worker>,
    thread: JoinHandle<()>,
}

/// A worker, which runs fibers one after the other on a thread.
struct Worker {
    /// Provides the thread's alternate stack, which the fibers use.
    block: FlowBlock,
    queue: Mutex<VecDeque<(Arc<RobotFibers>, Arc<Fiber>)>>,
    /// Length of the queue.
    queued: AtomicUsize,
    /// Number of robots that are bound to this worker.
    residents: AtomicUsize,
    /// The worker waits in the kernel, which takes microseconds to wake a thread.
    is_parked: AtomicBool,
    thread: OnceLock<thread::Thread>,
    shared_loop: Arc<SharedLoop>,
    /// The fiber that runs; null for none.
    running: AtomicPtr<Fiber>,
    /// Context of the worker while a fiber runs, to which the fiber returns. Used only by the worker's thread.
    sp: UnsafeCell<usize>,
    is_ending: AtomicBool,
    /// Keeps the signal handlers installed, forever if the worker never ends.
    _handlers: Handlers,
}

// SAFETY: only the worker's thread uses `sp`.
unsafe impl Sync for Worker {}

/// The fibers of one robot.
#[derive(Default)]
struct RobotFibers {
    /// The program's variables, if the robot shares a copy of its library with other robots.
    variables: Option<Arc<Variables>>,
    /// The robot; `None` for a spawned robot, which is not prefetched.
    member: Option<Arc<Member>>,
    /// The worker on which the robot's fibers run, set when the robot is first resumed.
    bound_worker: OnceLock<Arc<Worker>>,
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
    block: FlowBlock,
    stack: Stack,
    /// See [`Status`].
    status: AtomicU8,
    timer: Mutex<ReleaseTimer>,
    /// Used only by the fiber and its worker, which run on the same thread.
    context: UnsafeCell<Context>,
}

// SAFETY: after its creation only the thread of its worker uses `context`. The captures of the closure in it may be
// sent to that thread.
unsafe impl Send for Fiber {}
// SAFETY: as above.
unsafe impl Sync for Fiber {}

/// State of a fiber.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
enum Status {
    /// The fiber has not run yet.
    New,
    /// The fiber waits for its worker.
    Suspended,
    Running,
    Ended,
    /// The fiber has crashed.
    Failed,
}

/// Runs `work` on the stack of the calling fiber's worker, or directly if the caller is not a fiber. `work` must not
/// suspend the flow.
#[inline]
pub(super) fn run_on_host_stack(work: &mut dyn FnMut()) {
    // SAFETY: see `Fiber::current`.
    match unsafe { CURRENT.get().as_ref() } {
        Some(fiber) => fiber.run_on_worker_stack(work),
        None => work(),
    }
}

/// State that a suspended fiber continues from.
struct Context {
    /// Stack pointer.
    sp: usize,
    /// Body of the fiber; `None` once the fiber has begun.
    flow: Option<Box<dyn FnOnce() -> Option<u32> + Send>>,
    /// Once the fiber has ended: the task that gets the run token next.
    next: Option<u32>,
    environment: Environment,
    errno: i32,
}

thread_local! {
    /// The worker of this thread; null on other threads.
    static WORKER: Cell<*const Worker> = const { Cell::new(ptr::null()) };
    /// The fiber that runs on this worker's thread.
    static CURRENT: Cell<*const Fiber> = const { Cell::new(ptr::null()) };
}

impl FiberExecutor {
    /// Creates an executor with `workers` workers.
    pub fn new(workers: usize) -> Self {
        Self {
            robots: boxcar::Vec::new(),
            worker_count: workers,
            workers: OnceLock::new(),
            threads: Mutex::default(),
            shared_loop: Arc::default(),
            stacks: Arc::default(),
            notifier: OnceLock::new(),
        }
    }

    fn robot(&self, robot: RobotId) -> &Arc<RobotFibers> {
        &self.robots[robot.index()]
    }

    fn notifier(&self) -> &Arc<Notifier> {
        let Some(notifier) = self.notifier.get() else { unreachable!("the run has begun") };
        notifier
    }

    /// The robot's running fiber. A fiber that waits for its worker is not overdue and cannot be stopped.
    fn running_fiber(&self, robot: RobotId) -> Option<Arc<Fiber>> {
        let fibers = self.robot(robot);
        let fiber = fibers.token_holder()?;
        let running = fibers.bound_worker.get()?.running.load(Ordering::Relaxed);
        ptr::eq(running, Arc::as_ptr(&fiber)).then_some(fiber)
    }

    /// Starts the workers unless they have been started.
    fn start_workers(&self) -> io::Result<()> {
        if self.workers.get().is_none() {
            let mut running = self.threads.lock();
            while running.len() < self.worker_count {
                let worker = RunningWorker::start(running.len(), self.notifier(), &self.shared_loop)?;
                running.push(worker);
            }
            self.workers.get_or_init(|| running.iter().map(|running| Arc::clone(&running.worker)).collect());
        }
        Ok(())
    }
}

impl RunningWorker {
    fn start(number: usize, notifier: &Arc<Notifier>, shared_loop: &Arc<SharedLoop>) -> io::Result<Self> {
        let worker = Arc::new(Worker {
            block: FlowBlock::of_thread(Arc::clone(notifier)),
            queue: Mutex::default(),
            queued: AtomicUsize::new(0),
            residents: AtomicUsize::new(0),
            is_parked: AtomicBool::new(false),
            thread: OnceLock::new(),
            shared_loop: Arc::clone(shared_loop),
            running: AtomicPtr::default(),
            sp: UnsafeCell::new(0),
            is_ending: AtomicBool::new(false),
            _handlers: Handlers::install()?,
        });
        let own_worker = Arc::clone(&worker);
        let (sender, receiver) = mpsc::sync_channel(1);
        let body = move || {
            let own_worker: *const Worker = Arc::into_raw(own_worker);
            WORKER.set(own_worker);
            // SAFETY: this thread's reference count is released only after the thread has ended; the block has no other
            // thread.
            let (own_worker, result) = unsafe { (&*own_worker, (*own_worker).block.adopt_current_thread()) };
            let is_adopted = result.is_ok();
            // SAFETY: no fiber runs.
            unsafe { signal::set_current(ptr::null()) };
            // The receiver below waits for this one message.
            let _ = sender.send(result);
            if is_adopted {
                own_worker.run();
                // SAFETY: no fiber runs any more. A crash in the C library's work at the end of the thread is
                // attributed to this thread.
                unsafe { signal::set_current(&raw const own_worker.block) };
            }
        };
        let thread = thread::Builder::new().name(format!("worker {number}")).stack_size(STACK).spawn(body)?;
        // The cell is still empty.
        let _ = worker.thread.set(thread.thread().clone());
        let running = Self { worker, thread };
        match receiver.recv().map_err(io::Error::other)? {
            Ok(()) => Ok(running),
            Err(error) => {
                running.join();
                Err(error)
            }
        }
    }

    /// Ends the worker. Returns false if it runs a fiber that does not suspend itself; then the worker is lost.
    fn join(self) -> bool {
        const POLL_INTERVAL: Duration = Duration::from_micros(50);
        let Self { worker, thread } = self;
        worker.is_ending.store(true, Ordering::SeqCst);
        worker.wake();
        let start = Instant::now();
        while !thread.is_finished() {
            if start.elapsed() >= JOIN_TIMEOUT {
                return false;
            }
            thread::sleep(POLL_INTERVAL);
        }
        // At the end of a thread the C library frees memory; if a program failed with the heap locked, this would wait
        // forever.
        if damage::is_heap_lost() {
            return false;
        }
        // A program may have damaged the heap, to which the thread returns memory.
        let is_joined = threads::join(thread, &worker.block, JOIN_TIMEOUT);
        if is_joined {
            // SAFETY: the thread has ended and no longer uses its reference count.
            unsafe { Arc::decrement_strong_count(Arc::as_ptr(&worker)) };
        } else {
            interrupt::disarm_last_resort();
        }
        is_joined
    }
}

impl Worker {
    fn wake(&self) {
        if let Some(thread) = self.thread.get() {
            thread.unpark();
        }
    }

    /// Appends `fiber` of `robot` to the worker's queue.
    fn enqueue(&self, robot: &Arc<RobotFibers>, fiber: Arc<Fiber>) {
        let mut queue = self.queue.lock();
        queue.push_back((Arc::clone(robot), fiber));
        self.queued.store(queue.len(), Ordering::SeqCst);
        drop(queue);
        if self.is_parked.load(Ordering::SeqCst) {
            self.wake();
        }
    }

    /// Runs fibers until the worker ends.
    fn run(&self) {
        loop {
            if let Some((robot, fiber)) = self.next() {
                self.advance(&robot, &fiber);
            } else if self.is_ending.load(Ordering::SeqCst) {
                return;
            } else {
                self.wait();
            }
        }
    }

    /// Takes the first fiber from the queue. Prefetches the data of the following fibers, unless the robots are so few
    /// that they fit in the caches.
    fn next(&self) -> Option<(Arc<RobotFibers>, Arc<Fiber>)> {
        /// Number of robots that fit in the second-level cache: with a hundred, prefetching neither gains nor costs
        /// time (docs/performance.md).
        const MAX_CACHED: usize = 100;
        let mut queue = self.queue.lock();
        let first = queue.pop_front();
        self.queued.store(queue.len(), Ordering::SeqCst);
        if self.residents.load(Ordering::Relaxed) > MAX_CACHED {
            // Each step reads only what the step before has prefetched while another fiber ran.
            if let Some((robot, fiber)) = queue.get(2) {
                prefetch_value(&**robot);
                prefetch_value(&**fiber);
            }
            if let Some((robot, fiber)) = queue.get(1) {
                robot.members().for_each(|member| member.prefetch_fields());
                // SAFETY: fibers of this queue run only on the calling thread.
                unsafe {
                    fiber.prefetch_stack();
                    robot.prefetch_variables();
                }
            }
            if let Some((robot, _)) = queue.front() {
                robot.members().for_each(|member| member.prefetch_heap());
            }
        }
        first
    }

    /// Waits until a fiber is in the queue or the worker must end; the waiting worker helps with loops. It first spins
    /// for a short time, since the next slot of a few robots begins sooner than the kernel could wake a thread; then it
    /// waits in the kernel.
    fn wait(&self) {
        /// Time of a spinning worker before it waits in the kernel: more than a slot of a few robots takes, and more
        /// than the kernel needs to wake a thread. Our choice. It is measured by the clock, since the length of a spin
        /// differs between processors by a factor of ten.
        const SPIN_TIME: Duration = Duration::from_micros(100);
        /// Number of spins between two readings of the clock.
        const SPINS: usize = 64;
        let must_return = || self.queued.load(Ordering::SeqCst) > 0 || self.is_ending.load(Ordering::SeqCst);
        let (mut since, mut seen) = (Instant::now(), 0);
        while since.elapsed() < SPIN_TIME {
            for _ in 0..SPINS {
                if must_return() {
                    return;
                }
                if self.shared_loop.help(&mut seen) {
                    since = Instant::now();
                }
                std::hint::spin_loop();
            }
        }
        self.is_parked.store(true, Ordering::SeqCst);
        if !must_return() && !self.shared_loop.has_job(seen) {
            thread::park();
        }
        self.is_parked.store(false, Ordering::SeqCst);
    }

    /// Runs `fiber` until it suspends itself, ends or crashes.
    fn advance(&self, robot: &Arc<RobotFibers>, fiber: &Arc<Fiber>) {
        match fiber.status() {
            Status::New => fiber.block.adopt_fiber(&self.block, fiber.stack.bounds()),
            Status::Suspended => {}
            // The fiber was resumed while it ended, or its run gave it up.
            Status::Running | Status::Ended | Status::Failed => return,
        }
        fiber.set_status(Status::Running);
        fiber.begin_release();
        let context = fiber.context.get();
        CURRENT.set(Arc::as_ptr(fiber));
        self.running.store(Arc::as_ptr(fiber).cast_mut(), Ordering::Relaxed);
        // SAFETY: the caller's reference keeps the fiber alive until `CURRENT` and `running` are replaced below; the
        // fiber does not run, so that only this thread uses its context, which has not been continued since it was
        // stored; `errno` is this thread's variable. This worker is the home of all robots that share the copy of the
        // variables, which belong to a run's programs and are dropped after the run.
        unsafe {
            if let Some(variables) = &robot.variables {
                variables.swap_in();
            }
            signal::set_current(&raw const fiber.block);
            (*context).environment.apply();
            *libc::__errno_location() = (*context).errno;
            switch::switch(self.sp.get(), (*context).sp);
            (*context).errno = *libc::__errno_location();
            signal::set_current(ptr::null());
        }
        self.running.store(ptr::null_mut(), Ordering::Relaxed);
        CURRENT.set(ptr::null());
        if fiber.block.has_stored_fault() {
            float::reset();
            fiber.set_status(Status::Failed);
            // From here on, nothing writes to the stack.
            fiber.block.publish_stored();
        } else if fiber.status() == Status::Ended {
            Environment::INITIAL.apply();
            robot.flows.lock().list.retain(|(_, other)| !Arc::ptr_eq(other, fiber));
            // SAFETY: the fiber has ended.
            if let Some(next) = unsafe { (*context).next } {
                robot.hand_token_to(next);
            }
        } else {
            // SAFETY: the fiber does not run.
            unsafe { (*context).environment = Environment::current() };
            fiber.set_status(Status::Suspended);
        }
    }
}

impl RobotFibers {
    /// Hands the run token to `task`, whose fiber runs next on the calling worker. Does nothing if the run is over and
    /// has given up its flows.
    fn hand_token_to(self: &Arc<Self>, task: u32) {
        let mut flows = self.flows.lock();
        let next = flows.list.iter().find(|(number, _)| *number == task).map(|(_, fiber)| Arc::clone(fiber));
        if let Some(next) = next {
            flows.token_holder = Some(Arc::clone(&next));
            drop(flows);
            if let Some(bound_worker) = self.bound_worker.get() {
                bound_worker.enqueue(self, next);
            }
        }
    }

    /// The robot, if its data can be prefetched.
    fn members(&self) -> impl Iterator<Item = &Member> {
        self.member.as_deref().into_iter()
    }

    /// Prefetches the program's variables.
    ///
    /// # Safety
    /// Called on the thread of the robot's worker.
    unsafe fn prefetch_variables(&self) {
        if let Some(variables) = &self.variables {
            // SAFETY: by this function's contract.
            prefetch(unsafe { variables.saved() });
        }
    }

    /// The fiber that holds the run token.
    fn token_holder(&self) -> Option<Arc<Fiber>> {
        self.flows.lock().token_holder.clone()
    }
}

impl Fiber {
    /// Creates a fiber, which runs `flow` on `stack`.
    fn new(stack: Stack, notifier: &Arc<Notifier>, flow: Box<dyn FnOnce() -> Option<u32> + Send>) -> Self {
        // SAFETY: no code uses the new stack.
        let sp = unsafe { switch::prepare(stack.bounds()[1], Self::begin) };
        Self {
            block: FlowBlock::of_fiber(
                FiberExits { from_signal: Self::leave_from_signal, from_call: Self::leave_from_call },
                Arc::clone(notifier),
            ),
            stack,
            status: AtomicU8::new(Status::New as u8),
            timer: Mutex::default(),
            context: UnsafeCell::new(Context {
                sp,
                flow: Some(flow),
                next: None,
                environment: Environment::INITIAL,
                errno: 0,
            }),
        }
    }

    /// Prefetches the part of the stack that RoBIOS calls use.
    ///
    /// # Safety
    /// Called on the thread of the fiber's worker, and not by the fiber.
    unsafe fn prefetch_stack(&self) {
        /// Bytes of the stack below and above the stack pointer of the suspended fiber.
        const EXTENT: [usize; 2] = [256, 2048];
        // SAFETY: no code changes the context meanwhile, by this function's contract.
        let sp = unsafe { (*self.context.get()).sp };
        let [from, to] = [sp - EXTENT[0], self.stack.top().min(sp + EXTENT[1])];
        prefetch(ptr::without_provenance(from)..ptr::without_provenance(to));
    }

    fn status(&self) -> Status {
        const ALL: [Status; 5] = [Status::New, Status::Suspended, Status::Running, Status::Ended, Status::Failed];
        ALL[usize::from(self.status.load(Ordering::Acquire))]
    }

    fn set_status(&self, status: Status) {
        self.status.store(status as u8, Ordering::Release);
    }

    /// The fiber that the calling thread runs; the reference must not leave that fiber.
    fn current<'a>() -> &'a Self {
        // SAFETY: null, or kept alive by the worker's reference as long as the fiber runs, see `Worker::advance`.
        let Some(fiber) = (unsafe { CURRENT.get().as_ref() }) else { unreachable!("only flows of robots come here") };
        fiber
    }

    /// Body of a fiber.
    extern "sysv64" fn begin() -> ! {
        let fiber = Self::current();
        // SAFETY: the fiber runs, so that no other code uses its context.
        unsafe {
            if let Some(flow) = (*fiber.context.get()).flow.take() {
                (*fiber.context.get()).next = flow();
            }
        }
        // Nothing of this stack is used any more.
        fiber.set_status(Status::Ended);
        Self::leave_from_call()
    }

    /// Begins a new release; the watchdog restarts its measurement.
    fn begin_release(&self) {
        self.block.releases.fetch_add(1, Ordering::Relaxed);
    }

    /// Suspends this fiber, the calling one, until its worker resumes it.
    fn suspend(&self) {
        let worker = WORKER.get();
        // SAFETY: the fiber runs on the thread of its worker, which has stored its context when it switched to the
        // fiber.
        unsafe { switch::switch(&raw mut (*self.context.get()).sp, *(*worker).sp.get()) };
    }

    /// Runs `work` on the stack of this fiber's worker; this fiber is the calling one. `work` must neither
    /// suspend the fiber nor make a call.
    ///
    /// All fibers of a worker share this stack, which therefore stays in the cache; of its own stack a fiber then
    /// touches only the frames of its program and of the entry of a call.
    fn run_on_worker_stack(&self, work: &mut dyn FnMut()) {
        struct Job<'a> {
            work: &'a mut dyn FnMut(),
            panic: Option<Box<dyn Any + Send>>,
        }
        /// # Safety
        /// `job` is a [`Job`] that nothing else uses.
        unsafe extern "sysv64" fn run(job: *mut u8) {
            // SAFETY: by this function's contract.
            let job = unsafe { &mut *job.cast::<Job<'_>>() };
            // A panic cannot unwind from one stack to another.
            job.panic = panic::catch_unwind(AssertUnwindSafe(&mut job.work)).err();
        }
        let mut job = Job { work, panic: None };
        // SAFETY: the worker's thread runs this fiber, and has stored its stack pointer when it switched to it: below,
        // its stack is unused until the fiber is suspended. `work` suspends nothing, and its panic does not leave
        // `run`.
        unsafe {
            let worker_sp = *(*WORKER.get()).sp.get();
            switch::call_on(self.block.caller_sp.as_ptr(), worker_sp, run, (&raw mut job).cast());
        }
        self.block.caller_sp.store(0, Ordering::Relaxed);
        if let Some(payload) = job.panic {
            panic::resume_unwind(payload);
        }
    }

    /// Leaves the calling fiber, never to return: it has ended, or its crash is stored.
    fn leave_from_call() -> ! {
        loop {
            Self::current().suspend();
        }
    }

    /// See [`FiberExits::from_signal`].
    ///
    /// # Safety
    /// `context` is the kernel's context of a signal on the thread of a worker that runs a fiber.
    unsafe fn leave_from_signal(context: *mut libc::ucontext_t) {
        // SAFETY: as above, and the worker's context was stored when it switched to the fiber.
        unsafe { switch::divert(context, *(*WORKER.get()).sp.get()) };
    }

    /// Waits until the fiber has ended, at most until `deadline`. Returns true if the fiber has ended or has never run,
    /// so that it holds no resources.
    fn wait_for_end(&self, deadline: Option<Instant>) -> bool {
        const POLL_INTERVAL: Duration = Duration::from_micros(100);
        while !matches!(self.status(), Status::New | Status::Ended) {
            if deadline.is_none_or(|deadline| Instant::now() >= deadline) {
                return false;
            }
            thread::sleep(POLL_INTERVAL);
        }
        true
    }
}

impl Executor for FiberExecutor {
    fn begin(&self, notifier: &Arc<Notifier>) {
        damage::heap_functions();
        // A run begins once, so the cell is still empty.
        let _ = self.notifier.set(Arc::clone(notifier));
    }

    fn end(&self, has_departed: &dyn Fn(RobotId) -> bool) -> bool {
        let mut all_ended = true;
        self.stacks.end();
        let deadline = Instant::now() + JOIN_TIMEOUT;
        for (index, robot) in &self.robots {
            let list = std::mem::take(&mut *robot.flows.lock()).list;
            let has_failed = list.iter().any(|(_, fiber)| fiber.block.crash().is_some());
            let should_end = !has_failed && has_departed(RobotId::from_index(index));
            for (_, fiber) in list {
                if !fiber.wait_for_end(should_end.then_some(deadline)) {
                    damage::count_lost_flow();
                    // The fiber's program may have kept addresses of its stack, and the robot's other flows wait for
                    // it.
                    std::mem::forget(fiber);
                    all_ended = false;
                }
            }
        }
        for worker in self.threads.lock().drain(..) {
            if !worker.join() {
                damage::count_lost_flow();
                all_ended = false;
            }
        }
        all_ended
    }

    fn must_end(&self) -> bool {
        damage::is_heap_lost() && self.robots.iter().any(|(_, robot)| !robot.flows.lock().list.is_empty())
    }

    fn admit(&self, robot: RobotId, program: &RobotProgram, member: Option<&Arc<Member>>) {
        while self.robots.count() < robot.index() {
            self.robots.push(Arc::default());
        }
        let variables = program.variables().cloned();
        self.robots.push(Arc::new(RobotFibers { variables, member: member.cloned(), ..RobotFibers::default() }));
    }

    fn start(&self, robot: RobotId, task: u32, flow: Box<dyn FnOnce() -> Option<u32> + Send>) -> io::Result<()> {
        self.start_workers()?;
        let fiber = Arc::new(Fiber::new(self.stacks.take()?, self.notifier(), flow));
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
        let Some(workers) = self.workers.get() else { return };
        let worker = fibers.variables.as_ref().map_or(worker, |variables| variables.worker());
        let bound_worker = fibers.bound_worker.get_or_init(|| {
            let bound_worker = Arc::clone(&workers[worker as usize]);
            bound_worker.residents.fetch_add(1, Ordering::Relaxed);
            bound_worker
        });
        if let Some(token_holder) = fibers.token_holder() {
            bound_worker.enqueue(fibers, token_holder);
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

    fn helping_workers(&self) -> usize {
        self.workers.get().map_or(1, Vec::len)
    }

    fn run_loop(&self, job: &Job<'_>) {
        let wake_workers = || {
            let workers = self.workers.get().into_iter().flatten();
            workers.filter(|worker| worker.is_parked.load(Ordering::SeqCst)).for_each(|worker| worker.wake());
        };
        self.shared_loop.run(job, wake_workers);
    }

    fn failures(&self) -> Vec<(RobotId, Failure)> {
        let mut all = Vec::new();
        for (index, robot) in &self.robots {
            let flows = robot.flows.lock();
            for (task, fiber) in &flows.list {
                let is_only_flow = *task == MAIN && flows.list.len() == 1;
                let failure = threads::failure(&fiber.block, (!is_only_flow).then_some(*task));
                all.extend(failure.map(|failure| (RobotId::from_index(index), failure)));
            }
        }
        all
    }

    fn is_overdue(&self, robot: RobotId, timeout: f64) -> bool {
        let Some(fiber) = self.running_fiber(robot) else { return false };
        if fiber.block.in_host.load(Ordering::Relaxed) {
            fiber.timer.lock().pause();
            return false;
        }
        let sample = FlowSample::of_thread(&fiber.block);
        if sample.is_none() && fiber.timer.lock().record_missing(fiber.block.releases.load(Ordering::Relaxed)) {
            fiber.block.set_gone();
        }
        sample.is_some_and(|sample| fiber.timer.lock().is_overdue(&sample, timeout))
    }

    fn backtrace(&self, robot: RobotId) -> Vec<usize> {
        self.running_fiber(robot).map(|fiber| threads::backtrace(&fiber.block)).unwrap_or_default()
    }

    fn break_overdue(&self, robot: RobotId) {
        if let Some(fiber) = self.running_fiber(robot) {
            signal::stop_overdue(&fiber.block);
        }
    }
}
