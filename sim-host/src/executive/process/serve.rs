//! Host side of a robot in its own process: a thread answers the child's calls, and calls functions of the child.

use std::cell::Cell;
use std::ffi::c_void;
use std::ptr;
use std::sync::Arc;
use std::sync::atomic::Ordering;

use parking_lot::Mutex;
use robios_sys::wire::{Malformed, Reader, put_bytes};
use robios_sys::{Callback, Robios6, Robios7, Status, Support};

use super::channel::{Channel, kind, refusal};
use super::child::Child;
use crate::executive::answer::answer;
use crate::executive::failure::Failure;
use crate::program::image::SourceLine;
use crate::program::prepare::Prepared;
use crate::program::site::RemoteSite;

/// A robot's program in its own process, loaded and ready to run.
pub struct RemoteProgram {
    child: Arc<Child>,
    prepared: Arc<Prepared>,
    arguments: Vec<String>,
    /// Address of the library in the child.
    base: u64,
    /// Location of the program's current call, as the child reported it with the call.
    site: Mutex<RemoteSite>,
}

/// Reasons why a child has no program to run.
#[derive(Debug)]
pub enum LoadRefusal {
    /// The dynamic linker refuses the library; contains the linker's message.
    Linker(String),
    /// The library is incompatible with this eyesim; contains the reason.
    Incompatible(String),
    /// The child ended or failed while it loaded the library.
    Failed(String),
}

impl RemoteProgram {
    /// Waits until the child has loaded `prepared`; `main` gets the program's name followed by `arguments`.
    ///
    /// # Errors
    /// [`LoadRefusal`] if the child cannot load the program.
    pub fn new(child: Child, prepared: Arc<Prepared>, arguments: &[String]) -> Result<Self, LoadRefusal> {
        let message = child.receive_first().map_err(|failure| LoadRefusal::Failed(failure.description))?;
        let mut body = Reader::new(&message.body);
        let malformed = |Malformed| LoadRefusal::Failed(child.malformed().description);
        match message.kind {
            kind::READY => {
                let base = body.get().map_err(malformed)?;
                let arguments = std::iter::once(&prepared.name).chain(arguments).cloned().collect();
                Ok(Self { child: Arc::new(child), prepared, arguments, base, site: Mutex::default() })
            }
            kind::REFUSED => {
                let reason: u32 = body.get().map_err(malformed)?;
                let text = String::from_utf8_lossy(body.rest()).into_owned();
                Err(match reason {
                    refusal::LINKER => LoadRefusal::Linker(text),
                    refusal::INCOMPATIBLE => LoadRefusal::Incompatible(text),
                    _ if text.trim().is_empty() => LoadRefusal::Failed(child.malformed().description),
                    _ => LoadRefusal::Failed(text),
                })
            }
            _ => Err(malformed(Malformed)),
        }
    }

    /// The number of the program's arguments, without `argv[0]`.
    pub fn argument_count(&self) -> usize {
        self.arguments.len().saturating_sub(1)
    }

    /// The process.
    pub fn child(&self) -> &Arc<Child> {
        &self.child
    }

    /// Runs the program, answers its calls with `host` on this thread, and returns its exit code.
    ///
    /// # Errors
    /// [`Failure`] if the program or its process failed.
    pub fn run<H: Support + Robios6 + Robios7 + Sync + 'static>(&self, host: &H) -> Result<i32, Failure> {
        let mut run_message = (self.arguments.len() as u32).to_le_bytes().to_vec();
        self.arguments.iter().for_each(|argument| put_bytes(Some(argument.as_bytes()), &mut run_message));
        let channel = self.child.first();
        channel.send(kind::RUN, &[&run_message]);
        let service = Service { program: self, channel, host };
        match service.serve()? {
            ServiceEnd::Exited(code) => Ok(code),
            ServiceEnd::Returned(_) => Err(self.child.malformed()),
        }
    }

    /// See [`LoadedProgram::own_source_line`](crate::program::load::LoadedProgram::own_source_line).
    pub fn own_source_line(&self, addresses: &[usize]) -> Option<SourceLine> {
        let offsets = addresses.iter().map(|&address| self.offset(address).unwrap_or(usize::MAX));
        self.prepared.image()?.own_source_line(offsets)
    }

    /// See [`ProgramImage::source_of`](crate::program::image::ProgramImage::source_of).
    pub fn source_of(&self, line: &SourceLine) -> Option<String> {
        self.prepared.image()?.source_of(line)
    }

    /// See [`LoadedProgram::source_line`](crate::program::load::LoadedProgram::source_line).
    pub fn source_line(&self, address: usize) -> Option<SourceLine> {
        self.prepared.image()?.source_line(self.offset(address)?)
    }

    /// Location of the call in progress, as the child reported it.
    pub fn call_site(&self) -> RemoteSite {
        self.site.lock().clone()
    }

    /// A location in this program as text, such as `maze.c:88`.
    pub fn location_of(&self, site: &RemoteSite) -> Option<String> {
        let location_of_address = || {
            // A return address lies after the call instruction.
            let offset = self.offset(usize::try_from(site.address).ok()?.checked_sub(1)?)?;
            self.prepared.image()?.call_line(offset).map(|line| line.to_string())
        };
        site.line().or_else(location_of_address)
    }

    /// Offset of `address` in the library; `None` if it is elsewhere.
    fn offset(&self, address: usize) -> Option<usize> {
        let offset = address.checked_sub(usize::try_from(self.base).ok()?)?;
        self.prepared.image()?.span().contains(&offset).then_some(offset)
    }
}

/// Event that ends a service.
enum ServiceEnd {
    Returned(Status),
    Exited(i32),
}

/// Service of one channel by a thread of the host.
struct Service<'a, H> {
    program: &'a RemoteProgram,
    channel: &'a Channel,
    host: &'a H,
}

thread_local! {
    /// The channel that this thread serves, and its child.
    static SERVED: Cell<(*const Child, *const Channel)> = const { Cell::new((ptr::null(), ptr::null())) };
}

impl<H: Support + Robios6 + Robios7 + Sync + 'static> Service<'_, H> {
    /// Answers calls until the program exits, or until the function of the program that the host has called returns.
    fn serve(&self) -> Result<ServiceEnd, Failure> {
        let child = &self.program.child;
        let outer = SERVED.replace((Arc::as_ptr(child), self.channel));
        let result = self.answer_all();
        SERVED.set(outer);
        result
    }

    fn answer_all(&self) -> Result<ServiceEnd, Failure> {
        let child = &self.program.child;
        let mut reply = Vec::new();
        loop {
            let message = child.receive(self.channel)?;
            let code = || Reader::new(&message.body).get::<i32>();
            let end = match message.kind {
                kind::CALL => {
                    reply.clear();
                    self.call(&message.body, &mut reply).and_then(|status| {
                        let kind = if status == Status::OK { kind::OK } else { kind::STOP };
                        // The reply is too long only if the child has requested more bytes than a message can contain.
                        if self.channel.send(kind, &[&reply]) { Ok(None) } else { Err(Malformed) }
                    })
                }
                kind::RETURNED => code().map(|status| Some(ServiceEnd::Returned(Status(status)))),
                kind::EXITED => code().map(|code| Some(ServiceEnd::Exited(code))),
                _ => Err(Malformed),
            };
            match end {
                Ok(None) => {}
                Ok(Some(end)) => return Ok(end),
                Err(Malformed) => return Err(child.malformed()),
            }
        }
    }

    /// Carries out a call.
    fn call(&self, body: &[u8], reply: &mut Vec<u8>) -> Result<Status, Malformed> {
        // The report of a crash contains the number of the last call.
        let store_number = |number| self.program.child.last_call.store(number, Ordering::Relaxed);
        answer(self.host, body, &self.program.site, store_number, &|code, data| self.callback(code, data), reply)
    }

    /// A callback through which the host calls the child's function identified by `code` and `data`.
    fn callback(&self, code: u64, data: u64) -> Callback {
        let mut callbacks = self.program.child.callbacks.lock();
        let remote = callbacks.entry((code, data)).or_insert_with(|| {
            Box::new(RemoteFunction {
                program: ptr::from_ref(self.program),
                host: ptr::from_ref(self.host),
                code,
                data,
            })
        });
        let remote = remote.downcast_ref::<RemoteFunction<H>>().map_or(ptr::null(), ptr::from_ref);
        Callback { code: Some(call_remote::<H>), data: remote.cast_mut().cast::<c_void>() }
    }
}

/// A function of a program in another process.
struct RemoteFunction<H> {
    program: *const RemoteProgram,
    host: *const H,
    code: u64,
    data: u64,
}

// SAFETY: program and host are shared by the threads of the robot, and both outlive the program's run, see `Callback`.
unsafe impl<H: Sync> Send for RemoteFunction<H> {}

/// Calls a function of the child: on the channel that this thread already serves, otherwise on the channel of a task.
///
/// # Safety
/// `data` must come from [`Service::callback`], and the program must not have returned from its `run`.
unsafe extern "C" fn call_remote<H: Support + Robios6 + Robios7 + Sync + 'static>(data: *mut c_void) -> Status {
    // SAFETY: by this function's contract; the child keeps the function, and program and host live as long as the run.
    let Some((function, program, host)) = (unsafe {
        data.cast_const()
            .cast::<RemoteFunction<H>>()
            .as_ref()
            .and_then(|function| Some((function, function.program.as_ref()?, function.host.as_ref()?)))
    }) else {
        return Status::STOP;
    };
    let call = |channel: &Channel| {
        let outer_site = program.site.lock().clone();
        channel.send(kind::CALL_BACK, &[&function.code.to_le_bytes(), &function.data.to_le_bytes()]);
        let end = Service { program, channel, host }.serve();
        *program.site.lock() = outer_site;
        end
    };
    let (child, channel) = SERVED.get();
    let end = if child == Arc::as_ptr(&program.child) {
        // SAFETY: a service of this thread, further up its stack, has set the channel and resets it before it returns.
        call(unsafe { &*channel })
    } else {
        program.child.take_task_channel().and_then(|channel| {
            let end = call(&channel)?;
            program.child.return_task_channel(channel);
            Ok(end)
        })
    };
    match end {
        Ok(ServiceEnd::Returned(status)) => status,
        // The process is lost, or exited within a function: the thread that serves the first channel finds this, too.
        Ok(ServiceEnd::Exited(_)) | Err(_) => Status::STOP,
    }
}
