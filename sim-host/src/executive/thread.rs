//! One OS thread a robot: debuggers and all libraries work. The default.

use std::io;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, OnceLock, mpsc};
use std::thread::{self, Thread};

use parking_lot::Mutex;
use robios_sys::{Callback, Stop};
use sim_core::RobotId;

use super::Executor;
use super::fault::Broken;
use super::fault::stack_words;
use super::process::Child;
use super::signal::{self, ThreadBlock};
use super::watchdog::{Look, Watch};
use crate::robios::caller::Call;

/// Stack of a robot's thread, in bytes of address space; memory is used as the program touches it.
pub(super) const STACK: usize = 8 << 20;

/// Stack that a RoBIOS call may need, the slot loop included: below it the program has overflowed.
const RESERVE: usize = 128 << 10;

/// Executor with one OS thread a robot.
pub struct ThreadExecutor {
    robots: Vec<RobotThread>,
    /// The processor of each lane; empty where threads are not bound to any.
    processors: Vec<usize>,
}

struct RobotThread {
    /// Leaked, since the thread outlives the executor when its program never returns.
    block: &'static ThreadBlock,
    /// The lane to whose processor the thread is bound; `u32::MAX` for none.
    lane: AtomicU32,
    go: AtomicBool,
    thread: OnceLock<Thread>,
    /// The process that the thread serves.
    child: OnceLock<Arc<Child>>,
    watch: Mutex<Watch>,
}

impl ThreadExecutor {
    /// An executor for `count` robots, with ids from 1. As many as there are `lanes` run at one time of the `flows` that will be
    /// started.
    ///
    /// Where robots hand over to each other within a lane, the threads of a lane are bound to one processor: on the machines
    /// measured a hand-over to another one costs two to three times as much.
    pub fn new(count: usize, flows: usize, lanes: usize) -> Self {
        let robot = || RobotThread {
            block: Box::leak(Box::default()),
            lane: AtomicU32::new(u32::MAX),
            go: AtomicBool::new(false),
            thread: OnceLock::new(),
            child: OnceLock::new(),
            watch: Mutex::default(),
        };
        let processors = if flows > lanes { processors(lanes) } else { Vec::new() };
        Self { robots: (0..count).map(|_| robot()).collect(), processors }
    }

    fn robot(&self, robot: RobotId) -> &RobotThread {
        &self.robots[robot.index()]
    }
}

impl Executor for ThreadExecutor {
    fn start(&self, robot: RobotId, child: Option<Arc<Child>>, flow: Box<dyn FnOnce() + Send>) -> io::Result<()> {
        if let Some(child) = child {
            let _ = self.robot(robot).child.set(child);
        }
        let block = self.robot(robot).block;
        let (adopted, adoption) = mpsc::sync_channel(1);
        let handle = thread::Builder::new().name(robot.to_string()).stack_size(STACK).spawn(move || {
            let result = block.adopt_current_thread();
            let is_adopted = result.is_ok();
            // The receiver waits just below for this one message.
            let _ = adopted.send(result);
            if is_adopted {
                flow();
            }
        })?;
        // The handle is known before anybody is resumed: that comes after all flows have started.
        let _ = self.robot(robot).thread.set(handle.thread().clone());
        adoption.recv().unwrap_or_else(|_| Err(io::Error::other("the thread ended before it began")))
    }

    fn resume(&self, robot: RobotId, lane: u32) {
        let robot = self.robot(robot);
        if let Some(processor) = self.processors.get(lane as usize)
            && robot.lane.swap(lane, Ordering::Relaxed) != lane
        {
            bind(robot.block.tid.load(Ordering::Relaxed), *processor);
            if let Some(child) = robot.child.get() {
                bind(child.first().thread().cast_signed(), *processor);
            }
        }
        robot.go.store(true, Ordering::Release);
        if let Some(thread) = robot.thread.get() {
            thread.unpark();
        }
    }

    fn suspend(&self, robot: RobotId) {
        let robot = self.robot(robot);
        while !robot.go.swap(false, Ordering::Acquire) {
            thread::park();
        }
        robot.block.releases.fetch_add(1, Ordering::Relaxed);
    }

    fn enter(&self, robot: RobotId, call: Call) -> bool {
        let block = self.robot(robot).block;
        if let Some(number) = call.robios_number() {
            block.last_call.store(number, Ordering::Relaxed);
        }
        if block.stack_left() < RESERVE {
            return false;
        }
        block.enter_host();
        true
    }

    fn leave(&self, robot: RobotId) {
        self.robot(robot).block.leave_host();
    }

    fn call_back(&self, robot: RobotId, callback: Callback) -> Result<(), Stop> {
        let block = self.robot(robot).block;
        block.leave_host();
        // SAFETY: by this method's contract the robot's flow, which runs on this thread, is in a call of its program and
        // holds no lock; programs are never unloaded.
        let result = unsafe { callback.call() };
        block.enter_host();
        result
    }

    fn broken(&self) -> Vec<(RobotId, Broken)> {
        let broken = |(index, robot): (usize, &RobotThread)| {
            let fault = robot.block.fault()?;
            let (bounds, last_call) = (robot.block.stack_bounds(), robot.block.last_call.load(Ordering::Relaxed));
            let words = stack_words(fault.sp, bounds);
            Some((RobotId::from_index(index), Broken::new(fault, bounds, last_call, words)))
        };
        self.robots.iter().enumerate().filter_map(broken).collect()
    }

    fn is_overdue(&self, robot: RobotId, timeout: f64) -> bool {
        let robot = self.robot(robot);
        let look = match robot.child.get() {
            Some(child) => Look::at_process(child.pid(), robot.block),
            None => Look::at_thread(robot.block),
        };
        let is_overdue = look.is_some_and(|look| robot.watch.lock().is_overdue(&look, timeout));
        if let Some(child) = robot.child.get().filter(|_| !is_overdue) {
            child.forgive();
        }
        is_overdue
    }

    fn break_overdue(&self, robot: RobotId) {
        let robot = self.robot(robot);
        match robot.child.get() {
            Some(child) => child.stop_overdue(),
            None => signal::stop_overdue(robot.block),
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
