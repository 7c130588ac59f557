//! One OS thread for each task of a robot: debuggers and all libraries work. The default.

use std::cell::Cell;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, OnceLock, mpsc};
use std::thread::{self, JoinHandle};

use parking_lot::Mutex;
use robios_sys::{Callback, Stop};
use sim_core::RobotId;

use super::Executor;
use super::fault::{Broken, stack_words};
use super::process::Child;
use super::process::child::Release;
use super::signal::{self, ThreadBlock};
use super::watchdog::{Look, Watch};
use crate::robios::caller::Call;
use crate::robios::task::MAIN;

/// Stack of a task's thread, in bytes of address space; memory is used as the program touches it.
pub(super) const STACK: usize = 8 << 20;

/// Stack that a RoBIOS call may need, the slot loop included: below it the program has overflowed.
const RESERVE: usize = 128 << 10;

/// Executor with one OS thread a task.
pub struct ThreadExecutor {
    robots: boxcar::Vec<Arc<Threads>>,
    /// The processor of each lane.
    processors: Arc<[usize]>,
}

/// The threads of one robot.
struct Threads {
    /// The lane to whose processor they are bound; `u32::MAX` for none.
    lane: AtomicU32,
    /// The processor of each lane; empty where threads are not bound to any.
    processors: Arc<[usize]>,
    /// The process that they serve.
    child: OnceLock<Arc<Child>>,
    flows: Mutex<Flows>,
}

#[derive(Default)]
struct Flows {
    /// Those that have not ended, with the tasks that they run.
    list: Vec<(u32, &'static Flow)>,
    /// The one that has the baton.
    holder: Option<&'static Flow>,
    /// The one that handed it on as the last thing it did: whoever has the baton waits for the end of its thread, which may still
    /// run the program's destructors of thread-locals.
    ending: Option<&'static Flow>,
    /// Those whose threads have ended, for further tasks.
    spare: Vec<&'static Flow>,
}

/// What is known of one thread. Leaked, since the thread outlives the executor when its program never returns.
#[derive(Default)]
struct Flow {
    block: ThreadBlock,
    /// The lane to whose processor the thread is bound.
    lane: AtomicU32,
    go: AtomicBool,
    thread: Mutex<Option<JoinHandle<()>>>,
    watch: Mutex<Watch>,
}

thread_local! {
    /// The flow of this thread.
    static FLOW: Cell<Option<&'static Flow>> = const { Cell::new(None) };
}

impl ThreadExecutor {
    /// An executor for `count` robots, with ids from 1. As many as there are `lanes` run at one time of the `flows` that will be
    /// started.
    ///
    /// Where robots hand over to each other within a lane, the threads of a lane are bound to one processor: on the machines
    /// measured a hand-over to another one costs two to three times as much.
    pub fn new(count: usize, flows: usize, lanes: usize) -> Self {
        let processors: Arc<[usize]> = if flows > lanes { processors(lanes).into() } else { Arc::default() };
        let executor = Self { robots: boxcar::Vec::with_capacity(count), processors };
        if count > 0 {
            executor.admit(RobotId::from_index(count - 1));
        }
        executor
    }

    fn robot(&self, robot: RobotId) -> &Arc<Threads> {
        &self.robots[robot.index()]
    }
}

impl Flow {
    /// The flow of the calling thread.
    fn current() -> &'static Self {
        let Some(flow) = FLOW.get() else { unreachable!("only flows of robots come here") };
        flow
    }

    /// It is released once more: its time begins anew for the watchdog.
    fn begin_release(&self) {
        self.block.releases.fetch_add(1, Ordering::Relaxed);
    }

    /// What tells its present release from all others.
    fn release(&self) -> Release {
        Release { thread: self.block.tid.load(Ordering::Relaxed), number: self.block.releases.load(Ordering::Relaxed) }
    }
}

impl Threads {
    /// Lets `flow` go on.
    fn go(&self, flow: &Flow) {
        let lane = self.lane.load(Ordering::Relaxed);
        if let Some(processor) = self.processors.get(lane as usize)
            && flow.lane.swap(lane, Ordering::Relaxed) != lane
        {
            bind(flow.block.tid.load(Ordering::Relaxed), *processor);
            if let Some(child) = self.child.get() {
                bind(child.first().thread().cast_signed(), *processor);
            }
        }
        flow.go.store(true, Ordering::Release);
        if let Some(thread) = &*flow.thread.lock() {
            thread.thread().unpark();
        }
    }

    /// Waits until the calling flow, `flow`, is to go on, and until the one before it has wholly ended.
    fn wait(&self, flow: &Flow) {
        while !flow.go.swap(false, Ordering::Acquire) {
            thread::park();
        }
        flow.begin_release();
        let ending = self.flows.lock().ending;
        if let Some(ending) = ending {
            let thread = ending.thread.lock().take();
            if let Some(thread) = thread {
                // What its flow did last cannot panic; if it could, the baton would be here all the same.
                let _ = thread.join();
            }
            let mut flows = self.flows.lock();
            flows.list.retain(|(_, flow)| !std::ptr::eq(*flow, ending));
            flows.spare.push(ending);
            flows.ending = None;
        }
    }

    /// Hands the baton from the calling flow to that of `task`; the calling one goes no further if it `is_ending`.
    fn hand_to(&self, task: u32, is_ending: bool) {
        let mut flows = self.flows.lock();
        let Some((_, next)) = flows.list.iter().find(|(number, _)| *number == task).copied() else {
            unreachable!("task {task} has no flow")
        };
        flows.holder = Some(next);
        if is_ending {
            flows.ending = Some(Flow::current());
        }
        drop(flows);
        self.go(next);
    }

    /// The flow that works for the robot now.
    fn working(&self) -> Option<&'static Flow> {
        let flows = self.flows.lock();
        flows.ending.or(flows.holder)
    }
}

/// How many times longer than anything else the import of a module may take.
const IMPORT_PATIENCE: f64 = 12.0;

impl Executor for ThreadExecutor {
    fn admit(&self, robot: RobotId) {
        while self.robots.count() <= robot.index() {
            self.robots.push(Arc::new(Threads {
                lane: AtomicU32::new(u32::MAX),
                processors: Arc::clone(&self.processors),
                child: OnceLock::new(),
                flows: Mutex::default(),
            }));
        }
    }

    fn start(&self, robot: RobotId, task: u32, flow: Box<dyn FnOnce() -> Option<u32> + Send>) -> io::Result<()> {
        let threads = Arc::clone(self.robot(robot));
        let place: &'static Flow = threads.flows.lock().spare.pop().unwrap_or_else(|| Box::leak(Box::default()));
        place.lane.store(u32::MAX, Ordering::Relaxed);
        let (adopted, adoption) = mpsc::sync_channel(1);
        let name = if task == MAIN { robot.to_string() } else { format!("{robot}.{task}") };
        let life = move || {
            let result = place.block.adopt_current_thread();
            let is_adopted = result.is_ok();
            // The receiver waits just below for this one message.
            let _ = adopted.send(result);
            if is_adopted {
                FLOW.set(Some(place));
                threads.wait(place);
                if let Some(next) = flow() {
                    threads.hand_to(next, true);
                }
            }
        };
        let started = thread::Builder::new().name(name).stack_size(STACK).spawn(life);
        let result = started.and_then(|thread| {
            // The handle is known before anybody lets the flow go on.
            *place.thread.lock() = Some(thread);
            adoption.recv().unwrap_or_else(|_| Err(io::Error::other("the thread ended before it began")))
        });
        // The place is lost after an error: its thread may not have ended yet.
        result?;
        let mut flows = self.robot(robot).flows.lock();
        flows.list.push((task, place));
        flows.holder.get_or_insert(place);
        Ok(())
    }

    fn serve(&self, robot: RobotId, child: Arc<Child>) {
        // A robot has one program, so this is the only time.
        let _ = self.robot(robot).child.set(child);
    }

    fn resume(&self, robot: RobotId, lane: u32) {
        let threads = self.robot(robot);
        threads.lane.store(lane, Ordering::Relaxed);
        let holder = threads.flows.lock().holder;
        if let Some(holder) = holder {
            threads.go(holder);
        }
    }

    fn suspend(&self, robot: RobotId) {
        self.robot(robot).wait(Flow::current());
    }

    fn go_on(&self, _: RobotId) {
        Flow::current().begin_release();
    }

    fn switch(&self, robot: RobotId, task: u32) {
        let threads = self.robot(robot);
        threads.hand_to(task, false);
        threads.wait(Flow::current());
    }

    fn enter(&self, _: RobotId, call: Call) -> bool {
        let block = &Flow::current().block;
        if let Some(number) = call.robios_number() {
            block.last_call.store(number, Ordering::Relaxed);
        }
        if block.stack_left() < RESERVE {
            return false;
        }
        block.enter_host();
        true
    }

    fn leave(&self, _: RobotId) {
        Flow::current().block.leave_host();
    }

    fn call_back(&self, _: RobotId, callback: Callback) -> Result<(), Stop> {
        let block = &Flow::current().block;
        block.leave_host();
        // SAFETY: by this method's contract the robot's flow, which runs on this thread, is in a call of its program, or the
        // first in a task that such a call started, and holds no lock; programs are never unloaded.
        let result = unsafe { callback.call() };
        block.enter_host();
        result
    }

    fn broken(&self) -> Vec<(RobotId, Broken)> {
        let mut all = Vec::new();
        for (index, threads) in &self.robots {
            let flows = threads.flows.lock();
            for (task, Flow { block, .. }) in &flows.list {
                if let Some(fault) = block.fault() {
                    let (bounds, last_call) = (block.stack_bounds(), block.last_call.load(Ordering::Relaxed));
                    let broken = Broken::new(fault, bounds, last_call, stack_words(fault.sp, bounds));
                    let is_alone = *task == MAIN && flows.list.len() == 1;
                    let broken = if is_alone { broken } else { broken.in_task(*task) };
                    all.push((RobotId::from_index(index), broken));
                }
            }
        }
        all
    }

    fn is_overdue(&self, robot: RobotId, timeout: f64) -> bool {
        let threads = self.robot(robot);
        let Some(flow) = threads.working() else { return false };
        let mut timeout = timeout;
        let look = match threads.child.get() {
            Some(child) if child.is_asked(flow.release()) => return true,
            Some(child) => {
                let (is_importing, spent) = child.imports();
                timeout *= if is_importing { IMPORT_PATIENCE } else { 1.0 };
                Look::at_process(child.pid(), &flow.block).map(|look| look.without(spent))
            }
            None if flow.block.in_host.load(Ordering::Relaxed) => {
                flow.watch.lock().pause();
                return false;
            }
            None => Look::at_thread(&flow.block),
        };
        look.is_some_and(|look| flow.watch.lock().is_overdue(&look, timeout))
    }

    fn break_overdue(&self, robot: RobotId) {
        let threads = self.robot(robot);
        match (threads.child.get(), threads.working()) {
            (Some(child), Some(flow)) => child.stop_overdue(flow.release()),
            (None, Some(flow)) => signal::stop_overdue(&flow.block),
            (_, None) => {}
        }
    }
}

/// A processor for each lane, of those that this process may use, beginning with the one that it runs on; none where there
/// are fewer processors than lanes.
fn processors(lanes: usize) -> Vec<usize> {
    // SAFETY: an all-zero set is valid and is filled by the call, which gets its size; the others take no pointers.
    let (allowed, here) = unsafe {
        let mut set: libc::cpu_set_t = std::mem::zeroed();
        if libc::sched_getaffinity(0, size_of::<libc::cpu_set_t>(), &mut set) != 0 {
            return Vec::new();
        }
        let allowed: Vec<usize> = (0..libc::CPU_SETSIZE as usize).filter(|cpu| libc::CPU_ISSET(*cpu, &set)).collect();
        (allowed, libc::sched_getcpu())
    };
    if allowed.len() < lanes {
        return Vec::new();
    }
    let first = allowed.iter().position(|cpu| i32::try_from(*cpu) == Ok(here)).unwrap_or(0);
    allowed.iter().cycle().skip(first).take(lanes).copied().collect()
}

/// Binds a thread to a processor; where the kernel refuses, the thread runs where it likes, only slower.
fn bind(tid: i32, processor: usize) {
    // SAFETY: an all-zero set is valid, `processor` was read from such a set, and the call gets the set's size.
    unsafe {
        let mut set: libc::cpu_set_t = std::mem::zeroed();
        libc::CPU_SET(processor, &mut set);
        libc::sched_setaffinity(tid, size_of::<libc::cpu_set_t>(), &set);
    }
}
