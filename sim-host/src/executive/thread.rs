//! Executor with one OS thread for each task of a robot, which works with debuggers and all libraries.

use std::cell::Cell;
use std::io;
use std::os::unix::thread::JoinHandleExt as _;
use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, OnceLock, mpsc};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant, SystemTime};

use parking_lot::Mutex;

use robios_sys::support::stream;
use sim_core::RobotId;

use super::failure::{Failure, stack_words};
use super::guard::below_guard;
use super::notifier::Notifier;
use super::process::Child;
use super::process::child::Release;
use super::program::RobotProgram;
use super::run::Member;
use super::signal::{self, FlowBlock, Handlers};
use super::watchdog::{FlowSample, ReleaseTimer};
use super::{Executor, damage};
use crate::program::embedded::EmbeddedCode;

use crate::robios::task::MAIN;

/// Stack of a task's thread, in bytes of address space; memory is committed on first touch.
pub(super) const STACK: usize = 8 << 20;

/// Time within which the thread of a program that has ended must end; otherwise the thread is lost.
pub(super) const JOIN_TIMEOUT: Duration = Duration::from_secs(10);

/// Executor with one OS thread for each task.
pub struct ThreadExecutor {
    robots: boxcar::Vec<Arc<RobotThreads>>,
    /// The processor of each worker.
    processors: Arc<[usize]>,
    /// Notifier that failed flows signal; unset before the run begins.
    notifier: OnceLock<Arc<Notifier>>,
}

/// The threads of one robot.
struct RobotThreads {
    /// The worker to whose processor the threads are bound; `u32::MAX` for none.
    worker: AtomicU32,
    /// The processor of each worker; empty if threads are not bound to any.
    processors: Arc<[usize]>,
    /// The process that the threads serve.
    child: OnceLock<Arc<Child>>,
    /// The code of the embedding process that the first thread runs.
    embedded: OnceLock<Embedded>,
    flows: Mutex<Flows>,
}

/// Code of the embedding process, and a flag that is true once the watchdog has requested its end.
struct Embedded {
    code: Arc<dyn EmbeddedCode>,
    is_asked_to_end: AtomicBool,
}

#[derive(Default)]
struct Flows {
    /// Flows that have not ended, with their tasks' numbers.
    list: Vec<(u32, Arc<ThreadFlow>)>,
    /// The flow that holds the run token.
    token_holder: Option<Arc<ThreadFlow>>,
    /// The flow that handed on the run token as its last action. The new holder joins its thread before it runs, since
    /// that thread may still run the program's destructors of thread-locals.
    ending: Option<Arc<ThreadFlow>>,
}

/// State of one thread. The thread owns a reference count of it, which only [`ThreadFlow::join`] releases.
struct ThreadFlow {
    block: FlowBlock,
    /// The worker to whose processor the thread is bound.
    worker: AtomicU32,
    is_resumed: AtomicBool,
    /// `None` once it has been joined, or did not end in time.
    thread: Mutex<Option<JoinHandle<()>>>,
    timer: Mutex<ReleaseTimer>,
    /// Keeps the signal handlers installed, forever if the flow never ends.
    _handlers: Handlers,
}

thread_local! {
    /// The flow of this thread.
    static FLOW: Cell<*const ThreadFlow> = const { Cell::new(ptr::null()) };
}

impl ThreadExecutor {
    /// Creates an executor for `count` robots, with ids from 1, on `workers` workers; `flows` is the number of flows
    /// that will be started.
    ///
    /// If there are more flows than workers, the threads of a worker are bound to one processor: on the machines
    /// measured a hand-over to another processor costs two to three times as much.
    pub fn new(count: usize, flows: usize, workers: usize) -> Self {
        let processors: Arc<[usize]> = if flows > workers { processors(workers).into() } else { Arc::default() };
        let executor = Self { robots: boxcar::Vec::with_capacity(count), processors, notifier: OnceLock::new() };
        executor.make_room(count);
        executor
    }

    /// Reserves entries for `count` robots.
    fn make_room(&self, count: usize) {
        while self.robots.count() < count {
            self.robots.push(Arc::new(RobotThreads {
                worker: AtomicU32::new(u32::MAX),
                processors: Arc::clone(&self.processors),
                child: OnceLock::new(),
                embedded: OnceLock::new(),
                flows: Mutex::default(),
            }));
        }
    }

    fn robot(&self, robot: RobotId) -> &Arc<RobotThreads> {
        &self.robots[robot.index()]
    }
}

/// Joins `thread`, which owns `block` and is about to end. Returns false if the thread crashes or has not ended after
/// `timeout`; then it is lost.
pub(super) fn join(thread: JoinHandle<()>, block: &FlowBlock, timeout: Duration) -> bool {
    /// Interval of the checks for a crash.
    const POLL_INTERVAL: Duration = Duration::from_millis(20);
    let thread = thread.into_pthread_t();
    let start = Instant::now();
    while block.crash().is_none() && start.elapsed() < timeout {
        let until = (SystemTime::now() + POLL_INTERVAL).duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
        let until =
            libc::timespec { tv_sec: until.as_secs() as libc::time_t, tv_nsec: until.subsec_nanos() as libc::c_long };
        // SAFETY: no other code has the handle, which has been neither joined nor detached; `until` is valid.
        if unsafe { libc::pthread_timedjoin_np(thread, ptr::null_mut(), &until) } == 0 {
            return true;
        }
    }
    false
}

impl ThreadFlow {
    fn new(notifier: Arc<Notifier>) -> io::Result<Self> {
        Ok(Self {
            block: FlowBlock::of_thread(notifier),
            worker: AtomicU32::new(u32::MAX),
            is_resumed: AtomicBool::new(false),
            thread: Mutex::default(),
            timer: Mutex::default(),
            _handlers: Handlers::install()?,
        })
    }

    /// Makes this the flow of the calling thread, which must be the only thread that does so.
    fn adopt_current_thread(self: Arc<Self>) -> io::Result<()> {
        let flow = Arc::into_raw(self);
        FLOW.set(flow);
        // SAFETY: the thread's reference count is released only after the thread has been joined, so that it has ended;
        // its block never had another thread.
        unsafe { (*flow).block.adopt_current_thread() }
    }

    /// The flow of the calling thread; the reference must not leave that thread.
    fn current<'a>() -> &'a Self {
        // SAFETY: null, or kept alive by this thread's count as long as the thread lives, see `adopt_current_thread`.
        let Some(flow) = (unsafe { FLOW.get().as_ref() }) else { unreachable!("only flows of robots come here") };
        flow
    }

    /// Joins the thread, which has adopted this flow and is about to end. Returns false if the thread crashes or has
    /// not ended after `timeout`; then it is lost.
    fn join(self: &Arc<Self>, timeout: Duration) -> bool {
        let Some(thread) = self.thread.lock().take() else { return false };
        let is_joined = join(thread, &self.block, timeout);
        if is_joined {
            // SAFETY: the thread has ended, and no other code releases the count that it took when it adopted the flow.
            unsafe { Arc::decrement_strong_count(Arc::as_ptr(self)) };
        }
        is_joined
    }

    /// Begins a new release; the watchdog restarts its measurement.
    fn begin_release(&self) {
        self.block.releases.fetch_add(1, Ordering::Relaxed);
    }

    /// Identifier of the current release.
    fn current_release(&self) -> Release {
        Release { thread: self.block.tid.load(Ordering::Relaxed), number: self.block.releases.load(Ordering::Relaxed) }
    }
}

impl RobotThreads {
    /// Lets `flow` continue, bound to the processor of the robot's worker. A flow that serves a child is not bound if there
    /// is a processor for each of the two: they spin.
    fn wake(&self, flow: &ThreadFlow) {
        let worker = self.worker.load(Ordering::Relaxed);
        if let Some(processor) = self.processors.get(worker as usize)
            && flow.worker.swap(worker, Ordering::Relaxed) != worker
        {
            let child = self.child.get();
            if child.is_none() || !Child::has_processors() {
                bind(flow.block.tid.load(Ordering::Relaxed), *processor);
                if let Some(thread) = child.and_then(|child| child.bound_thread()) {
                    bind(thread, *processor);
                }
            }
        }
        flow.is_resumed.store(true, Ordering::Release);
        if let Some(thread) = &*flow.thread.lock() {
            thread.thread().unpark();
        }
    }

    /// Waits until the calling flow, `flow`, may continue, and until the thread of the previous flow has ended.
    fn wait(&self, flow: &ThreadFlow) {
        while !flow.is_resumed.swap(false, Ordering::Acquire) {
            thread::park();
        }
        flow.begin_release();
        let ending = self.flows.lock().ending.clone();
        if let Some(ending) = ending {
            // A flow that fails notifies the supervisor; no other flow of the robot runs then.
            while !ending.join(Duration::MAX) {
                thread::park();
            }
            let mut flows = self.flows.lock();
            flows.list.retain(|(_, flow)| !Arc::ptr_eq(flow, &ending));
            flows.ending = None;
        }
    }

    /// Hands the run token from the calling flow to the flow of `task`; if `is_ending`, the calling flow does not
    /// continue.
    fn hand_token_to(&self, task: u32, is_ending: bool) {
        let mut flows = self.flows.lock();
        let Some((_, next)) = flows.list.iter().find(|(number, _)| *number == task).cloned() else {
            // The run is over and its flows have been given up: the calling thread is parked permanently.
            drop(flows);
            loop {
                thread::park();
            }
        };
        let previous_holder = flows.token_holder.replace(Arc::clone(&next));
        if is_ending {
            debug_assert!(
                previous_holder
                    .as_ref()
                    .is_some_and(|previous_holder| ptr::eq(&**previous_holder, ThreadFlow::current())),
                "it held the run token"
            );
            flows.ending = previous_holder;
        }
        drop(flows);
        self.wake(&next);
    }

    /// The flow whose thread runs now: the ending flow, otherwise the holder of the run token.
    fn active_flow(&self) -> Option<Arc<ThreadFlow>> {
        let flows = self.flows.lock();
        flows.ending.as_ref().or(flows.token_holder.as_ref()).cloned()
    }
}

impl Executor for ThreadExecutor {
    fn begin(&self, notifier: &Arc<Notifier>) {
        damage::heap_functions();
        // A run begins once, so the cell is still empty.
        let _ = self.notifier.set(Arc::clone(notifier));
    }

    fn end(&self, has_departed: &dyn Fn(RobotId) -> bool) -> bool {
        let mut all_ended = true;
        for (index, threads) in &self.robots {
            let Flows { list, .. } = std::mem::take(&mut *threads.flows.lock());
            if list.is_empty() {
                continue;
            }
            let has_failed = list.iter().any(|(_, flow)| flow.block.crash().is_some());
            let should_end = !has_failed && has_departed(RobotId::from_index(index));
            for (_, flow) in list {
                if !(should_end && flow.join(JOIN_TIMEOUT)) {
                    damage::count_lost_flow();
                    all_ended = false;
                }
            }
        }
        all_ended
    }

    fn must_end(&self) -> bool {
        let has_program_in_host =
            |threads: &RobotThreads| threads.child.get().is_none() && !threads.flows.lock().list.is_empty();
        damage::is_heap_lost() && self.robots.iter().any(|(_, threads)| has_program_in_host(threads))
    }

    fn admit(&self, robot: RobotId, program: &RobotProgram, _: Option<&Arc<Member>>) {
        self.make_room(robot.index() + 1);
        if let Some(code) = program.embedded() {
            // A robot has one program, so the cell is still empty.
            let embedded = Embedded { code: Arc::clone(code), is_asked_to_end: AtomicBool::new(false) };
            let _ = self.robot(robot).embedded.set(embedded);
        }
    }

    fn start(&self, robot: RobotId, task: u32, flow: Box<dyn FnOnce() -> Option<u32> + Send>) -> io::Result<()> {
        let Some(notifier) = self.notifier.get() else { unreachable!("the run has begun") };
        let threads = Arc::clone(self.robot(robot));
        let thread_flow = Arc::new(ThreadFlow::new(Arc::clone(notifier))?);
        let (sender, receiver) = mpsc::sync_channel(1);
        let name = if task == MAIN { robot.to_string() } else { format!("{robot}.{task}") };
        let adopted_flow = Arc::clone(&thread_flow);
        let body = move || {
            let result = adopted_flow.adopt_current_thread();
            let is_adopted = result.is_ok();
            // The receiver below waits for this one message.
            let _ = sender.send(result);
            if is_adopted {
                threads.wait(ThreadFlow::current());
                if let Some(next) = below_guard(flow) {
                    threads.hand_token_to(next, true);
                }
            }
        };
        let thread = thread::Builder::new().name(name).stack_size(STACK).spawn(body)?;
        // The handle must be known before the flow may continue.
        *thread_flow.thread.lock() = Some(thread);
        let adopted = receiver.recv().map_err(io::Error::other)?;
        adopted.inspect_err(|_| _ = thread_flow.join(JOIN_TIMEOUT))?;
        let mut flows = self.robot(robot).flows.lock();
        flows.token_holder.get_or_insert_with(|| Arc::clone(&thread_flow));
        flows.list.push((task, thread_flow));
        Ok(())
    }

    fn serve(&self, robot: RobotId, child: Arc<Child>) {
        // A robot has one program, so the cell is still empty.
        let _ = self.robot(robot).child.set(child);
    }

    fn resume(&self, robot: RobotId, worker: u32) {
        let threads = self.robot(robot);
        threads.worker.store(worker, Ordering::Relaxed);
        let token_holder = threads.flows.lock().token_holder.clone();
        if let Some(token_holder) = token_holder {
            threads.wake(&token_holder);
        }
    }

    fn suspend(&self, robot: RobotId) {
        self.robot(robot).wait(ThreadFlow::current());
    }

    fn continue_running(&self, _: RobotId) {
        ThreadFlow::current().begin_release();
    }

    fn switch(&self, robot: RobotId, task: u32) {
        let threads = self.robot(robot);
        threads.hand_token_to(task, false);
        threads.wait(ThreadFlow::current());
    }

    fn failures(&self) -> Vec<(RobotId, Failure)> {
        let mut all = Vec::new();
        for (index, threads) in &self.robots {
            let flows = threads.flows.lock();
            for (task, flow) in &flows.list {
                let is_only_flow = *task == MAIN && flows.list.len() == 1;
                let failure = failure(&flow.block, (!is_only_flow).then_some(*task));
                all.extend(failure.map(|failure| (RobotId::from_index(index), failure)));
            }
        }
        all
    }

    fn is_overdue(&self, robot: RobotId, timeout: f64) -> bool {
        let threads = self.robot(robot);
        let Some(flow) = threads.active_flow() else { return false };
        let sample = match threads.child.get() {
            Some(child) if child.is_debugged() => return false,
            Some(child) if child.is_location_requested(flow.current_release()) || child.is_stopped() => return true,
            Some(child) => {
                let sample = FlowSample::of_process(child.pid(), &flow.block);
                sample.map(|sample| sample.with_imports(child.imports()))
            }
            None if flow.block.in_host.load(Ordering::Relaxed) => {
                flow.timer.lock().pause();
                return false;
            }
            None => {
                let sample = FlowSample::of_thread(&flow.block);
                let release = flow.block.releases.load(Ordering::Relaxed);
                if sample.is_none() && flow.timer.lock().record_missing(release) {
                    flow.block.set_gone();
                }
                sample
            }
        };
        sample.is_some_and(|sample| flow.timer.lock().is_overdue(&sample, timeout))
    }

    fn backtrace(&self, robot: RobotId) -> Vec<usize> {
        let threads = self.robot(robot);
        let flow = threads.active_flow().filter(|_| threads.child.get().is_none() && threads.embedded.get().is_none());
        flow.map(|flow| backtrace(&flow.block)).unwrap_or_default()
    }

    fn break_overdue(&self, robot: RobotId) {
        let threads = self.robot(robot);
        match (threads.child.get(), threads.active_flow()) {
            (Some(child), Some(flow)) => child.stop_overdue(flow.current_release()),
            (None, Some(flow)) => match threads.embedded.get() {
                Some(embedded) if embedded.is_asked_to_end.swap(true, Ordering::Relaxed) => {}
                Some(embedded) => embedded.code.stop(robot),
                None => signal::stop_overdue(&flow.block),
            },
            (_, None) => {}
        }
    }
}

/// Implements [`Executor::backtrace`] for the flow of `block`. Empty if the flow sleeps in the kernel, since the signal
/// of the request would end its sleep.
pub(super) fn backtrace(block: &FlowBlock) -> Vec<usize> {
    let is_computing = FlowSample::of_thread(block).is_some_and(|sample| !sample.is_asleep);
    let Some([pc, sp]) = is_computing.then(|| signal::backtrace(block)).flatten() else { return Vec::new() };
    std::iter::once(pc).chain(stack_words(sp, block.stack_bounds())).collect()
}

/// Describes the crash of the flow of `block`, if any, and names `task`.
pub(super) fn failure(block: &FlowBlock, task: Option<u32>) -> Option<Failure> {
    let crash = block.crash()?;
    let (bounds, last_call) = (block.stack_bounds(), block.last_call.load(Ordering::Relaxed));
    let stack_words = stack_words(crash.sp, bounds);
    damage::assess(&crash, &stack_words);
    let unfinished = [stream::OUT, stream::ERR].into_iter().enumerate().map(|(console, stream)| {
        let mut line = [0; _];
        let len = block.unfinished_line(console, &mut line);
        let bytes: Vec<u8> = line.iter().flat_map(|word| word.to_ne_bytes()).take(len).collect();
        (stream, String::from_utf8_lossy(&bytes).into_owned())
    });
    let failure = Failure::new(crash, bounds, last_call, stack_words).with_unfinished(unfinished.collect());
    Some(match task {
        Some(task) => failure.in_task(task),
        None => failure,
    })
}

/// Returns a processor for each worker, among those that this process may use, beginning with the calling thread's;
/// empty if there are fewer processors than workers.
fn processors(workers: usize) -> Vec<usize> {
    // SAFETY: an all-zero set is valid and is filled by the call, which gets its size; the other calls take no
    // pointers.
    let (allowed, current) = unsafe {
        let mut set: libc::cpu_set_t = std::mem::zeroed();
        if libc::sched_getaffinity(0, size_of::<libc::cpu_set_t>(), &mut set) != 0 {
            return Vec::new();
        }
        let allowed: Vec<usize> = (0..libc::CPU_SETSIZE as usize).filter(|cpu| libc::CPU_ISSET(*cpu, &set)).collect();
        (allowed, libc::sched_getcpu())
    };
    if allowed.len() < workers {
        return Vec::new();
    }
    let first = allowed.iter().position(|cpu| i32::try_from(*cpu) == Ok(current)).unwrap_or(0);
    allowed.iter().cycle().skip(first).take(workers).copied().collect()
}

/// Binds a thread to a processor; if the kernel refuses, the thread is not bound and only slower.
fn bind(tid: i32, processor: usize) {
    // SAFETY: an all-zero set is valid, `processor` was read from such a set, and the call gets the set's size.
    unsafe {
        let mut set: libc::cpu_set_t = std::mem::zeroed();
        libc::CPU_SET(processor, &mut set);
        libc::sched_setaffinity(tid, size_of::<libc::cpu_set_t>(), &set);
    }
}
