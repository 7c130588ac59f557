//! Robots whose programs are code of the embedding process. Each program runs on the thread of its flow.

use std::collections::BTreeMap;
use std::ffi::c_void;
use std::ptr;
use std::sync::Arc;
use std::sync::atomic::{AtomicPtr, Ordering};
use std::thread::{self, ThreadId};

use parking_lot::Mutex;
use robios_sys::wire::Malformed;
use robios_sys::{Callback, Robios6, Robios7, Status, Support};
use sim_core::RobotId;

use super::answer::answer;
use super::failure::Failure;
use super::signal::FlowBlock;
use crate::program::embedded::{Calls, EmbeddedCode, EmbeddedEnd, EmbeddedProgram};
use crate::program::site::RemoteSite;

/// A robot's embedded program, ready to run.
pub struct EmbeddedRobot {
    robot: RobotId,
    code: Arc<dyn EmbeddedCode>,
    arguments: Vec<String>,
    /// Location of the program's current call.
    site: Arc<Mutex<RemoteSite>>,
}

impl EmbeddedRobot {
    /// Creates the program of `robot` with its arguments.
    pub fn new(robot: RobotId, program: &EmbeddedProgram, arguments: &[String]) -> Self {
        let code = Arc::clone(&program.code);
        Self { robot, code, arguments: arguments.to_vec(), site: Arc::default() }
    }

    /// Runs the program on the calling thread, which belongs to a flow, and answers its calls with `host`. Returns its
    /// exit code.
    ///
    /// # Errors
    /// [`Failure`] if the program was overdue.
    pub fn run<H: Support + Robios6 + Robios7 + Sync + 'static>(&self, host: &H) -> Result<i32, Failure> {
        FlowBlock::current().pass_faults_to_process();
        let calls = Arc::new(HostCalls {
            host: AtomicPtr::new(ptr::from_ref(host).cast_mut()),
            thread: thread::current().id(),
            robot: self.robot,
            code: Arc::clone(&self.code),
            site: Arc::clone(&self.site),
            functions: Mutex::default(),
        });
        // When this guard is dropped, also by a panic, `calls` becomes invalid. If the program has kept a copy, the
        // copy answers every call with `STOP`.
        let _revoke = Revoke(Arc::clone(&calls));
        match self.code.run(self.robot, &self.arguments, calls) {
            EmbeddedEnd::Exited(code) => Ok(code),
            EmbeddedEnd::Overdue(location) => {
                let last_call = FlowBlock::current().last_call.load(Ordering::Relaxed);
                Err(Failure::overdue(last_call, location))
            }
        }
    }

    /// The code, which the watchdog stops.
    pub fn code(&self) -> &Arc<dyn EmbeddedCode> {
        &self.code
    }

    /// Location of the call in progress.
    pub fn call_site(&self) -> RemoteSite {
        self.site.lock().clone()
    }
}

/// Passes the calls of a robot's program to the host `H` while the program runs.
struct HostCalls<H> {
    /// Null once the program has returned.
    host: AtomicPtr<H>,
    /// The thread that runs the program.
    thread: ThreadId,
    robot: RobotId,
    code: Arc<dyn EmbeddedCode>,
    site: Arc<Mutex<RemoteSite>>,
    /// Functions of the program that the host may call, by their numbers.
    functions: Mutex<BTreeMap<u64, Box<Function>>>,
}

/// Invalidates the calls when it is dropped.
struct Revoke<H>(Arc<HostCalls<H>>);

impl<H> Drop for Revoke<H> {
    fn drop(&mut self) {
        self.0.host.store(ptr::null_mut(), Ordering::Release);
    }
}

impl<H: Support + Robios6 + Robios7 + Sync> Calls for HostCalls<H> {
    fn call(&self, request: &[u8], reply: &mut Vec<u8>) -> Result<Status, Malformed> {
        if thread::current().id() != self.thread {
            return Ok(Status::STOP);
        }
        // SAFETY: null, or the host that `run` has borrowed further up the stack of this thread, which sets the pointer
        // to null before it returns.
        let Some(host) = (unsafe { self.host.load(Ordering::Acquire).cast_const().as_ref() }) else {
            return Ok(Status::STOP);
        };
        let callback = |number, _| self.callback(number);
        // The flow itself stores the number of its last call.
        answer(host, request, &self.site, |_| {}, &callback, reply)
    }
}

impl<H> HostCalls<H> {
    /// A callback through which the host calls the program's function `number`.
    fn callback(&self, number: u64) -> Callback {
        let mut functions = self.functions.lock();
        let new = || Box::new(Function { code: Arc::clone(&self.code), robot: self.robot, number });
        let function = ptr::from_ref::<Function>(functions.entry(number).or_insert_with(new));
        Callback { code: Some(call_function), data: function.cast_mut().cast::<c_void>() }
    }
}

/// A function of an embedded program.
struct Function {
    code: Arc<dyn EmbeddedCode>,
    robot: RobotId,
    number: u64,
}

/// Calls a function of the program.
///
/// # Safety
/// `data` must come from [`HostCalls::callback`], and the program must still be running: the function is freed when its
/// run returns.
unsafe extern "C" fn call_function(data: *mut c_void) -> Status {
    // SAFETY: by this function's contract.
    let function = unsafe { data.cast_const().cast::<Function>().as_ref() };
    function.map_or(Status::STOP, |Function { code, robot, number }| code.call_back(*robot, *number))
}
