//! One OS thread a robot: debuggers and all libraries work. The default.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{OnceLock, mpsc};
use std::thread::{self, Thread};

use parking_lot::Mutex;
use robios_sys::{Callback, Stop};
use sim_core::RobotId;

use super::Executor;
use super::fault::Broken;
use super::signal::{self, ThreadBlock};
use super::watchdog::Watch;
use crate::robios::caller::Call;

/// Stack of a robot's thread, in bytes of address space; memory is used as the program touches it.
const STACK: usize = 8 << 20;

/// Stack that a RoBIOS call may need, the slot loop included: below it the program has overflowed.
const RESERVE: usize = 128 << 10;

/// Executor with one OS thread a robot.
pub struct ThreadExecutor {
    robots: Vec<RobotThread>,
}

struct RobotThread {
    /// Leaked, since the thread outlives the executor when its program never returns.
    block: &'static ThreadBlock,
    go: AtomicBool,
    thread: OnceLock<Thread>,
    watch: Mutex<Watch>,
}

impl ThreadExecutor {
    /// An executor for `count` robots, with ids from 1.
    pub fn new(count: usize) -> Self {
        let robot = || RobotThread {
            block: Box::leak(Box::default()),
            go: AtomicBool::new(false),
            thread: OnceLock::new(),
            watch: Mutex::default(),
        };
        Self { robots: (0..count).map(|_| robot()).collect() }
    }

    fn robot(&self, robot: RobotId) -> &RobotThread {
        &self.robots[robot.index()]
    }
}

impl Executor for ThreadExecutor {
    fn start(&self, robot: RobotId, flow: Box<dyn FnOnce() + Send>) -> io::Result<()> {
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

    fn resume(&self, robot: RobotId) {
        let robot = self.robot(robot);
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
        if let Call::Robios6(call) = call {
            block.last_call.store(call as u16, Ordering::Relaxed);
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
            Some((RobotId::from_index(index), Broken::new(fault, robot.block)))
        };
        self.robots.iter().enumerate().filter_map(broken).collect()
    }

    fn is_overdue(&self, robot: RobotId, timeout: f64) -> bool {
        let robot = self.robot(robot);
        robot.watch.lock().is_overdue(robot.block, timeout)
    }

    fn break_overdue(&self, robot: RobotId) {
        signal::stop_overdue(self.robot(robot).block);
    }
}
