//! Child side: a process that loads one robot's program, runs it, and sends each of its calls to the host.

use std::cell::Cell;
use std::ffi::{CString, c_char, c_int, c_void};
use std::path::Path;
use std::process::ExitCode;
use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicUsize, Ordering};
use std::time::Duration;
use std::{io, thread};

use robios_sys::support::stream;
use robios_sys::wire::{HostConnection, Malformed, Plain as _, Reader, put_bytes};
use robios_sys::{
    CallSite, Callback, Host, Program, Robios6Table, Robios7Table, Status, Stop, SupportCall, SupportTable,
};

use super::channel::{Channel, Channels, Message, Turn, kind, refusal};
use crate::executive::confine::protect_host;
use crate::executive::failure::{MAX_SEARCH_WORDS, live_words};
use crate::executive::guard::below_guard;
use crate::executive::signal::{self, Crash, FlowBlock, OVERDUE_SIGNAL};
use crate::executive::thread::STACK;
use crate::program::load::{OpenError, open};

/// Time in which a host that is not asleep answers most calls. Our choice.
const ANSWER_TIME: Duration = Duration::from_micros(5);

/// A thread's end of its channel to the host.
struct Connection {
    channel: Channel,
}

thread_local! {
    /// The connection of this thread; null for a thread that does not belong to the robot.
    static CONNECTION: Cell<*const Connection> = const { Cell::new(ptr::null()) };
}

/// The program's variable with its call site; null until the program is loaded, and if the program has none.
static CALL_SITE: AtomicPtr<CallSite> = AtomicPtr::new(ptr::null_mut());

/// Address of the program's console streams; 0 until it is loaded, and if the program has none.
static CONSOLES: AtomicUsize = AtomicUsize::new(0);

/// Lowest and highest address of the program's library; 0 until it is loaded.
static LIBRARY: [AtomicUsize; 2] = [const { AtomicUsize::new(0) }; 2];

static SUPPORT: SupportTable = SupportTable::remote::<Connection>();
static ROBIOS6: Robios6Table = Robios6Table::remote::<Connection>();
static ROBIOS7: Robios7Table = Robios7Table::remote::<Connection>();
static HOST6: Host = Host::of_robios6(&SUPPORT, &ROBIOS6);
static HOST7: Host = Host::of_robios7(&SUPPORT, &ROBIOS7);

/// Runs the program in `library` for the host that has started this process, with the channels as its standard input.
///
/// With `is_debugged` a debugger runs between host and child, and the debugger ends the process instead of the kernel.
///
/// # Errors
/// This process was not started by `eyesim run`.
pub fn run(library: &Path, is_debugged: bool) -> io::Result<ExitCode> {
    // SAFETY: the calls take only numbers.
    unsafe {
        // A restricted process must be hidden from other processes of its user; exec has reset this.
        if libc::prctl(libc::PR_GET_NO_NEW_PRIVS, 0, 0, 0, 0) == 1 {
            libc::prctl(libc::PR_SET_DUMPABLE, 0, 0, 0, 0);
        }
    }
    let channels = Channels::of_standard_input()?;
    let first = channels.map(0)?;
    if !first.is_known() {
        return Err(io::Error::other("the standard input is not a channel of this eyesim"));
    }
    if !is_debugged {
        die_with_host(first.host())?;
        protect_host(first.host().cast_signed());
    }
    signal::install_in_child()?;
    // SAFETY: the handler only sets a flag. A failure means that memory is exhausted, as the next allocation will show.
    unsafe { libc::pthread_atfork(None, None, Some(on_fork)) };
    let library = library.to_owned();
    let channel = channels.map(0)?;
    start("program", move || Connection::adopt(channel).run_program(&library))?;
    // The main thread only waits: it starts a thread for each channel that the host adds.
    for number in 1.. {
        first.wait_for_more_than(number);
        let started =
            channels.map(number).and_then(|channel| start("tasks", move || Connection::leaked(channel).run_tasks()));
        if started.is_err() {
            // The program waits for the task, and has the turn on no channel, so that only the exit code can be
            // reported. SAFETY: _exit takes no pointer.
            unsafe { libc::_exit(NO_ROOM_FOR_TASK) };
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Exit code of a process that lacks the resources for another task.
pub const NO_ROOM_FOR_TASK: i32 = 173;

/// This process was forked by the robot's program: the channels are those of its parent.
static IS_FORKED: AtomicBool = AtomicBool::new(false);

extern "C" fn on_fork() {
    IS_FORKED.store(true, Ordering::Relaxed);
}

/// Makes the kernel kill this process when the thread in process `host` that started it ends.
fn die_with_host(host: u32) -> io::Result<()> {
    // SAFETY: neither call takes a pointer.
    let parent = unsafe {
        libc::prctl(libc::PR_SET_PDEATHSIG, libc::SIGKILL);
        libc::getppid()
    };
    if parent.unsigned_abs() == host { Ok(()) } else { Err(io::Error::other("eyesim has ended")) }
}

/// Starts a thread of the program, with as much stack as in the host.
fn start(name: &str, body: impl FnOnce() + Send + 'static) -> io::Result<()> {
    thread::Builder::new().name(name.to_owned()).stack_size(STACK).spawn(body).map(drop)
}

impl Connection {
    /// Binds the calling thread to `channel`, on which its crashes are reported.
    fn adopt(channel: Channel) -> &'static Self {
        let connection = Self::leaked(channel);
        connection.adopt_thread(Self::leaked_block());
        connection
    }

    fn leaked(channel: Channel) -> &'static Self {
        Box::leak(Box::new(Self { channel }))
    }

    fn leaked_block() -> &'static FlowBlock {
        Box::leak(Box::new(FlowBlock::reporting(report_crash)))
    }

    /// Sends a message of these parts; returns false if it is too long. Async-signal-safe. Ends a process that the
    /// program has forked: it has no robot, and would answer in its parent's place.
    fn send(&self, kind: u32, parts: &[&[u8]]) -> bool {
        const WORDS: &[u8] = b"error: a process that a robot program has forked cannot call RoBIOS or print with the C library: it is ended\n";
        if IS_FORKED.load(Ordering::Relaxed) {
            if let (kind::EXITED, [code]) = (kind, parts) {
                // SAFETY: _exit takes no pointer.
                unsafe { libc::_exit(code.first_chunk().map_or(0, |bytes| i32::from_le_bytes(*bytes))) };
            }
            // SAFETY: both calls are async-signal-safe; `WORDS` has as many bytes as are given.
            unsafe {
                libc::write(2, WORDS.as_ptr().cast(), WORDS.len());
                libc::_exit(1)
            }
        }
        self.channel.send(kind, parts)
    }

    /// Binds the calling thread to this connection and to `block`; a thread that was bound to them before must have
    /// ended.
    fn adopt_thread(&'static self, block: &'static FlowBlock) {
        self.channel.attach();
        CONNECTION.set(self);
        // SAFETY: the block is never freed, and its threads run one after the other.
        if let Err(error) = unsafe { block.adopt_current_thread() } {
            self.refuse(refusal::OTHER, &format!("no stack for signals: {error}"));
        }
    }

    /// Body of the thread that runs `main`.
    fn run_program(&self, library: &Path) {
        let library = match open(library) {
            Ok(opened) => opened.kept(),
            Err(OpenError::Linker(message)) => self.refuse(refusal::LINKER, &message),
            Err(OpenError::Incompatible(reason)) => self.refuse(refusal::INCOMPATIBLE, &reason),
        };
        CALL_SITE.store(library.description().call_site.cast_mut(), Ordering::Relaxed);
        CONSOLES.store(library.description().consoles(), Ordering::Relaxed);
        store_span(library.base);
        self.channel.offer_location();
        let run_message = self.converse(kind::READY, &(library.base as u64).to_le_bytes());
        let code = match arguments(&run_message) {
            Ok(arguments) => below_guard(|| {
                library.construct();
                run_main(library.description(), &arguments)
            }),
            // Stopped before `main` began.
            Err(Malformed) => robios_sys::EXIT_STOPPED,
        };
        self.send(kind::EXITED, &[&code.to_le_bytes()]);
        // Flushes the program's output in the C library's files.
        std::process::exit(0);
    }

    /// Serves a connection for tasks until the process ends; each task gets a new thread, and thus new thread-locals.
    fn run_tasks(&'static self) {
        let block = Self::leaked_block();
        let server = self.channel.attach();
        self.converse_with(kind::READY, &[0; 8], |body| {
            let run = move || {
                self.adopt_thread(block);
                let status = below_guard(|| call_back(&body));
                // The host takes a channel for broken if the thread that it names is missing.
                self.channel.name_thread(server);
                status
            };
            let task = thread::Builder::new().name("task".to_owned()).stack_size(STACK).spawn(run);
            task.map_or(None, |task| task.join().ok()).unwrap_or_else(|| self.break_off("no room for another task"))
        });
    }

    /// Sends a message, and calls functions of the program at the host's request until the host answers.
    fn converse(&self, kind: u32, body: &[u8]) -> Message {
        self.converse_with(kind, body, |body| call_back(&body))
    }

    /// Like [`converse`](Self::converse), with `call_back` to call the function that the body of a message names.
    fn converse_with(
        &self,
        mut kind: u32,
        body: &[u8],
        call_back: impl Fn(Vec<u8>) -> Result<Status, Malformed>,
    ) -> Message {
        let mut returned;
        let mut body = body;
        loop {
            if !self.send(kind, &[body]) {
                self.break_off("a call whose arguments are longer than a message can be");
            }
            // A host that is not asleep answers most calls soon.
            if !self.channel.has_woken() {
                self.channel.spin_for(Turn::Child, ANSWER_TIME);
            }
            while !self.channel.wait_for(Turn::Child, None) {}
            let Some(message) = self.channel.message() else { self.break_off("a message of an impossible length") };
            if message.kind != kind::CALL_BACK {
                return message;
            }
            let Ok(status) = call_back(message.body) else { self.break_off("a call back without its function") };
            returned = status.0.to_le_bytes();
            (kind, body) = (kind::RETURNED, &returned);
        }
    }

    /// Reports to the host that the program cannot be run, and ends the process.
    fn refuse(&self, reason: u32, text: &str) -> ! {
        self.send(kind::REFUSED, &[&reason.to_le_bytes(), text.as_bytes()]);
        std::process::exit(1)
    }

    /// Reports to the host why the program cannot continue, and ends the process.
    fn break_off(&self, reason: &str) -> ! {
        self.send(kind::CRASH, &[&crash_header(&Crash::default(), reason.len(), [0; 2]), reason.as_bytes()]);
        std::process::exit(1)
    }
}

impl HostConnection for Connection {
    unsafe fn from_context<'a>(_: *mut c_void) -> Option<&'a Self> {
        // SAFETY: null, or leaked by `adopt`.
        unsafe { CONNECTION.get().as_ref() }
    }

    fn exchange(&self, table: u32, function: u32, arguments: &dyn Fn(&mut Vec<u8>)) -> Result<Vec<u8>, Stop> {
        let mut call = call_of(table, function);
        arguments(&mut call);
        let reply = self.converse(kind::CALL, &call);
        if reply.kind == kind::OK { Ok(reply.body) } else { Err(Stop) }
    }
}

/// The body of a CALL message before the arguments.
fn call_of(table: u32, function: u32) -> Vec<u8> {
    let mut call = Vec::with_capacity(128);
    table.put(&mut call);
    function.put(&mut call);
    put_call_site(&mut call);
    call
}

/// Appends the program's call site.
fn put_call_site(call: &mut Vec<u8>) {
    let site = CALL_SITE.load(Ordering::Relaxed);
    let site = if site.is_null() || !site.is_aligned() {
        CallSite::NONE
    } else {
        // SAFETY: by the description's contract it points to a variable of the program, written by this thread before
        // the call.
        unsafe { site.read() }
    };
    (site.address.addr() as u64).put(call);
    site.line.put(call);
    let file = if site.file.is_null() {
        &[]
    } else {
        // SAFETY: by the same contract, a name of that many bytes in the program's constants.
        unsafe { std::slice::from_raw_parts(site.file, site.file_len) }
    };
    put_bytes(Some(file), call);
}

/// The arguments of `main` in a RUN message.
fn arguments(run_message: &Message) -> Result<Vec<CString>, Malformed> {
    if run_message.kind != kind::RUN {
        return Err(Malformed);
    }
    let mut body = Reader::new(&run_message.body);
    let count: u32 = body.get()?;
    (0..count).map(|_| CString::new(body.bytes()?.unwrap_or_default()).map_err(|_nul| Malformed)).collect()
}

/// Runs the program's `main` on this thread and returns its exit code.
fn run_main(description: &Program, arguments: &[CString]) -> i32 {
    let mut argv: Vec<*const c_char> = arguments.iter().map(|argument| argument.as_ptr()).collect();
    argv.push(ptr::null());
    let robot = CONNECTION.get().cast_mut().cast::<c_void>();
    let host: &'static Host = if description.generation == 7 { &HOST7 } else { &HOST6 };
    // SAFETY: the tables are `Connection`'s, whose entries find the connection of their thread; argv has argc strings
    // that end in 0, then a null pointer, alive until `run` returns; the description was checked when it was loaded.
    unsafe { (description.run)(host, robot, arguments.len() as c_int, argv.as_ptr()) }
}

/// Calls the function that the program has passed as a [`Callback`].
fn call_back(body: &[u8]) -> Result<Status, Malformed> {
    let mut body = Reader::new(body);
    let (code, data): (u64, u64) = (body.get()?, body.get()?);
    let callback = Callback {
        // SAFETY: the program has passed the address of a function of this type, or 0; an optional function pointer is
        // that pointer or null.
        code: unsafe {
            std::mem::transmute::<*const c_void, Option<unsafe extern "C" fn(*mut c_void) -> Status>>(
                ptr::with_exposed_provenance(code as usize),
            )
        },
        data: ptr::with_exposed_provenance_mut(data as usize),
    };
    // SAFETY: the host calls back only while the program is in its `run`: in a call of this thread, or on the thread of
    // a task; this thread holds no lock.
    let result = unsafe { callback.call() };
    Ok(result.map_or(Status::STOP, |()| Status::OK))
}

/// Fixed-size part of a CRASH message, before its text.
fn crash_header(crash: &Crash, text: usize, [low, high]: [usize; 2]) -> [u8; 40] {
    let mut header = [0; 40];
    header[0..2].copy_from_slice(&(crash.signal as i16).to_le_bytes());
    header[2..4].copy_from_slice(&(crash.code as i16).to_le_bytes());
    header[4..8].copy_from_slice(&(text as u32).to_le_bytes());
    for (index, value) in header[8..].chunks_exact_mut(8).zip([crash.address, crash.pc, low, high]) {
        index.copy_from_slice(&(value as u64).to_le_bytes());
    }
    header
}

/// Stores the addresses of the library at `base`, from its first mapping to the last one of the same file.
fn store_span(base: usize) {
    let maps = std::fs::read_to_string("/proc/self/maps").unwrap_or_default();
    let mapping = |line: &str| {
        let (low, rest) = line.split_once('-')?;
        let (high, rest) = rest.split_once(' ')?;
        let number = |text| usize::from_str_radix(text, 16).ok();
        Some((number(low)?, number(high)?, rest.split_once('/')?.1.to_owned()))
    };
    let mappings: Vec<_> = maps.lines().filter_map(mapping).collect();
    let Some((_, _, file)) = mappings.iter().find(|(low, ..)| *low == base) else { return };
    let high = mappings.iter().filter(|(.., other)| other == file).map(|(_, high, _)| *high).max();
    LIBRARY[0].store(base, Ordering::Relaxed);
    LIBRARY[1].store(high.unwrap_or(base), Ordering::Relaxed);
}

/// The words of the stack in `words` that are not left over from earlier calls, if the crash at `pc` is outside the
/// program's code.
fn without_stale(words: &mut [usize], pc: usize) -> &[usize] {
    let library = LIBRARY[0].load(Ordering::Relaxed)..LIBRARY[1].load(Ordering::Relaxed);
    let site = CALL_SITE.load(Ordering::Relaxed);
    if library.contains(&pc) || site.is_null() || !site.is_aligned() {
        return words;
    }
    // SAFETY: by the description's contract it points to a variable of the program, which runs on this thread.
    live_words(words, unsafe { site.read() }.address.addr())
}

/// The bytes of words.
fn bytes_of(words: &[usize]) -> &[u8] {
    // SAFETY: the words have this many bytes, all of them initialised.
    unsafe { std::slice::from_raw_parts(words.as_ptr().cast::<u8>(), size_of_val(words)) }
}

/// Passes on the unfinished lines that the program has printed. Async-signal-safe.
fn print_unfinished(connection: &Connection, block: &FlowBlock) {
    block.set_consoles(CONSOLES.load(Ordering::Relaxed));
    block.store_unfinished();
    for (console, stream) in [stream::OUT, stream::ERR].into_iter().enumerate() {
        let mut words = [0; _];
        let len = block.unfinished_line(console, &mut words);
        if len == 0 {
            continue;
        }
        // The call, without a location.
        let head = [SupportCall::TABLE, SupportCall::unfinished as u32, 0, 0, 0, 0, stream.cast_unsigned(), len as u32];
        let head = head.map(u32::to_le_bytes);
        connection.send(kind::CALL, &[head.as_flattened(), &bytes_of(&words)[..len]]);
        // The answer no longer matters.
        while !connection.channel.wait_for(Turn::Child, None) {}
    }
}

/// Reports a crash of this thread to the host and ends the process; returns if the program is inside a call, or if the
/// host only requests the location at which the program computes. Async-signal-safe.
fn report_crash(block: &FlowBlock, crash: Crash) {
    // SAFETY: null, or leaked by `adopt`.
    let connection = unsafe { CONNECTION.get().as_ref() };
    let is_of_robot = !IS_FORKED.load(Ordering::Relaxed);
    let Some(connection) = connection.filter(|connection| is_of_robot && connection.channel.turn() == Turn::Child)
    else {
        if crash.signal != OVERDUE_SIGNAL {
            signal::default_action(crash.signal);
        }
        return;
    };
    let [low, high] = block.stack_bounds();
    let sp = crash.sp.next_multiple_of(align_of::<usize>());
    let mut words = [0_usize; MAX_SEARCH_WORDS];
    let count = if (low..high).contains(&sp) { ((high - sp) / size_of::<usize>()).min(MAX_SEARCH_WORDS) } else { 0 };
    // The program may have unmapped its stack, or a part of it.
    let count = signal::copy_own_memory(sp, &mut words[..count]);
    if crash.signal == OVERDUE_SIGNAL && connection.channel.is_location_requested() {
        let library = LIBRARY[0].load(Ordering::Relaxed)..LIBRARY[1].load(Ordering::Relaxed);
        let caller = words[..count].iter().find(|word| library.contains(*word));
        return connection.channel.report_location([crash.pc as u64, caller.map_or(0, |word| *word as u64)]);
    }
    if crash.signal == OVERDUE_SIGNAL && connection.channel.is_signal_late() {
        return;
    }
    print_unfinished(connection, block);
    let words = bytes_of(without_stale(&mut words[..count], crash.pc));
    connection.send(kind::CRASH, &[&crash_header(&crash, 0, [low, high]), words]);
    // SAFETY: _exit is async-signal-safe.
    unsafe { libc::_exit(128 + crash.signal) }
}
