//! Channel between a robot's process and the host: shared memory with one message in flight, and a futex that stores
//! which side has the turn.
//!
//! `docs/protocol.md` describes the layout. The side that has the turn owns the message. Neither side trusts the bytes
//! of the other: it copies and checks them.

use std::fs::File;
use std::hint;
use std::io;
use std::os::fd::{AsRawFd as _, FromRawFd as _};
use std::path::PathBuf;
use std::ptr;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering, fence};
use std::time::{Duration, Instant};

use super::debugger;

/// Size of a channel in bytes, enough for a call with two images of the largest camera; only written pages take memory.
pub const CHANNEL_SIZE: usize = 32 << 20;

/// Offset of a message's body.
const BODY: usize = 64;

/// Maximum length of a body in bytes.
pub const MAX_BODY: usize = CHANNEL_SIZE - BODY;

const MAGIC: u32 = u32::from_le_bytes(*b"EYES");
const VERSION: u32 = 1;

/// Side that may write the message next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Turn {
    /// The child, while its program runs.
    Child = 0,
    /// The host, while it answers.
    Host = 1,
}

/// Kinds of messages; the child's are below 16.
pub mod kind {
    /// The child's thread is ready.
    pub const READY: u32 = 1;
    /// The program cannot be run.
    pub const REFUSED: u32 = 2;
    /// A call of a table's function.
    pub const CALL: u32 = 3;
    /// The function that the host called has returned.
    pub const RETURNED: u32 = 4;
    /// `main` has returned.
    pub const EXITED: u32 = 5;
    /// The program failed.
    pub const CRASH: u32 = 6;
    /// Run `main`.
    pub const RUN: u32 = 16;
    /// Outputs and result of the call.
    pub const OK: u32 = 17;
    /// The program must exit.
    pub const STOP: u32 = 18;
    /// Call a function of the program.
    pub const CALL_BACK: u32 = 19;
}

/// Reasons for a refusal: the first word of a REFUSED message's body.
pub mod refusal {
    /// The dynamic linker refuses the library.
    pub const LINKER: u32 = 1;
    /// The library does not fit this eyesim.
    pub const INCOMPATIBLE: u32 = 2;
    /// Any other reason.
    pub const OTHER: u32 = 3;
}

/// A message copied out of a channel.
#[derive(Debug)]
pub struct Message {
    /// One of [`kind`].
    pub kind: u32,
    /// Bytes of the body.
    pub body: Vec<u8>,
}

/// Header of a channel.
#[repr(C)]
struct Header {
    magic: AtomicU32,
    version: AtomicU32,
    turn: AtomicU32,
    kind: AtomicU32,
    length: AtomicU32,
    thread: AtomicU32,
    channels: AtomicU32,
    host: AtomicU32,
    is_importing: AtomicU32,
    import_ms: AtomicU32,
    location_state: AtomicU32,
    location_line: AtomicU32,
    location_words: [AtomicU32; LOCATION_BYTES / size_of::<u32>()],
}

/// Bytes of a reported location: two addresses, or the beginning of a file's name.
const LOCATION_BYTES: usize = 16;

/// States of the request for the location at which a program computes. They give the meaning of [`OVERDUE_SIGNAL`] for
/// the child.
///
/// [`OVERDUE_SIGNAL`]: crate::executive::signal::OVERDUE_SIGNAL
mod location_state {
    /// The child does not report it; the signal ends the child.
    pub const NOT_OFFERED: u32 = 0;
    /// There is no request: the signal is a late one, without effect.
    pub const READY: u32 = 1;
    pub const REQUESTED: u32 = 2;
    pub const REPORTED: u32 = 3;
    /// The signal ends the child; requests are refused.
    pub const OVERDUE: u32 = 4;
}

/// Location at which a program in a process computes, as the process reports it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum CodeLocation {
    /// Addresses in its library, the innermost first; 0 for none.
    Addresses([u64; 2]),
    /// A line of a source file; only the first bytes of the file's name are reported.
    Line {
        /// The beginning of the file's name.
        file: String,
        /// The line.
        line: u32,
    },
}

/// One mapped channel.
pub struct Channel {
    memory: *mut u8,
    /// The other side was asleep when this side last passed it the turn.
    has_woken: AtomicBool,
}

// SAFETY: the header is atomic, and the body is touched only by raw copies of the side that has the turn.
unsafe impl Send for Channel {}
// SAFETY: as above.
unsafe impl Sync for Channel {}

/// The file that contains all channels of one child: the turn page.
#[derive(Debug)]
pub struct Channels {
    file: File,
}

impl Channels {
    /// Creates the file with channel 0, ready for a child. The file has no name, and `exec` closes it unless it is
    /// passed on.
    ///
    /// # Errors
    /// The process has no file descriptor left, or the kernel no memory.
    pub fn new() -> io::Result<Self> {
        // SAFETY: the name is a string that ends in 0; a descriptor that is not negative is new and has no other owner.
        let file = unsafe {
            let fd = libc::memfd_create(c"eyesim".as_ptr(), libc::MFD_CLOEXEC | libc::MFD_ALLOW_SEALING);
            if fd < 0 {
                return Err(io::Error::last_os_error());
            }
            File::from_raw_fd(fd)
        };
        let channels = Self { file };
        channels.grow_to(1)?;
        // Otherwise a child could make the host crash by truncating the file.
        // SAFETY: the descriptor is open; the call takes no pointer.
        if unsafe { libc::fcntl(channels.file.as_raw_fd(), libc::F_ADD_SEALS, libc::F_SEAL_SHRINK) } < 0 {
            return Err(io::Error::last_os_error());
        }
        let first = channels.map(0)?;
        first.header().channels.store(1, Ordering::Relaxed);
        first.header().host.store(std::process::id(), Ordering::Relaxed);
        first.set_up();
        Ok(channels)
    }

    /// Takes over the file of channels that a child has received as its standard input, and replaces the standard input
    /// by `/dev/null`.
    ///
    /// # Errors
    /// The standard input is not such a file.
    pub fn of_standard_input() -> io::Result<Self> {
        // SAFETY: the descriptors belong to this process; dup returns a new one without another owner.
        let file = unsafe {
            let fd = libc::fcntl(0, libc::F_DUPFD_CLOEXEC, 3);
            if fd < 0 {
                return Err(io::Error::last_os_error());
            }
            let null = libc::open(c"/dev/null".as_ptr(), libc::O_RDWR | libc::O_CLOEXEC);
            if null >= 0 {
                libc::dup2(null, 0);
                libc::close(null);
            }
            File::from_raw_fd(fd)
        };
        Self::of_file(file)
    }

    /// The channels in `file`, which another process has created.
    ///
    /// # Errors
    /// The length of the file is not a positive multiple of a channel's.
    pub fn of_file(file: File) -> io::Result<Self> {
        let length = file.metadata()?.len();
        if length < CHANNEL_SIZE as u64 || length % CHANNEL_SIZE as u64 != 0 {
            return Err(io::Error::other("the standard input is not a channel of eyesim"));
        }
        Ok(Self { file })
    }

    /// Path at which a process that does not inherit the file can open it; valid while this process lives.
    pub fn path(&self) -> PathBuf {
        debugger::file_of(self.file.as_raw_fd())
    }

    /// Extends the file to `count` channels; the host must [set up](Channel::set_up) each new one.
    ///
    /// # Errors
    /// The kernel refuses.
    pub fn grow_to(&self, count: u32) -> io::Result<()> {
        self.file.set_len(u64::from(count) * CHANNEL_SIZE as u64)
    }

    /// Maps the channel `number`, which the file must contain.
    ///
    /// # Errors
    /// The kernel lacks memory.
    pub fn map(&self, number: u32) -> io::Result<Channel> {
        let offset = libc::off_t::from(number) * CHANNEL_SIZE as libc::off_t;
        // SAFETY: a new mapping at an address that the kernel chooses; the file contains the channel and never shrinks.
        let memory = unsafe {
            libc::mmap(
                ptr::null_mut(),
                CHANNEL_SIZE,
                libc::PROT_READ | libc::PROT_WRITE,
                libc::MAP_SHARED | libc::MAP_NORESERVE,
                self.file.as_raw_fd(),
                offset,
            )
        };
        if memory == libc::MAP_FAILED {
            return Err(io::Error::last_os_error());
        }
        Ok(Channel { memory: memory.cast(), has_woken: AtomicBool::new(false) })
    }

    /// A duplicate of the file, to be passed to a child.
    ///
    /// # Errors
    /// The process has no file descriptor left.
    pub fn file(&self) -> io::Result<File> {
        self.file.try_clone()
    }
}

impl Channel {
    fn header(&self) -> &Header {
        // SAFETY: the mapping is aligned to pages, longer than the header, and lives as long as `self`; every bit
        // pattern is a header.
        unsafe { &*self.memory.cast::<Header>() }
    }

    /// Writes the magic number and the version of the protocol.
    pub fn set_up(&self) {
        self.header().magic.store(MAGIC, Ordering::Relaxed);
        self.header().version.store(VERSION, Ordering::Release);
    }

    /// Returns true if magic number and version match this protocol.
    pub fn is_known(&self) -> bool {
        let header = self.header();
        header.magic.load(Ordering::Relaxed) == MAGIC && header.version.load(Ordering::Relaxed) == VERSION
    }

    /// Side that has the turn.
    pub fn turn(&self) -> Turn {
        if self.header().turn.load(Ordering::Acquire) == Turn::Child as u32 { Turn::Child } else { Turn::Host }
    }

    /// Kernel's id of the child's thread that uses the channel; 0 before the thread is ready.
    pub fn thread(&self) -> u32 {
        self.header().thread.load(Ordering::Relaxed)
    }

    /// Registers the calling thread of the child as the user of the channel; returns the kernel's id of the thread.
    pub fn attach(&self) -> u32 {
        // SAFETY: gettid takes no arguments and always succeeds.
        let thread = unsafe { libc::gettid() }.unsigned_abs();
        self.name_thread(thread);
        thread
    }

    /// Registers the child's thread with this id as the user of the channel.
    pub fn name_thread(&self, thread: u32) {
        self.header().thread.store(thread, Ordering::Relaxed);
    }

    /// Sends a message made of `parts` and passes the turn to the other side. The caller must have the turn. Returns
    /// false, and sends nothing, if the message is too long. Async-signal-safe.
    pub fn send(&self, kind: u32, parts: &[&[u8]]) -> bool {
        let length: usize = parts.iter().map(|part| part.len()).sum();
        if length > MAX_BODY {
            return false;
        }
        let header = self.header();
        let mut offset = BODY;
        for part in parts {
            // SAFETY: by the check above, all parts fit in the body; the other side does not touch the body out of
            // turn, and no part is in the channel's memory.
            unsafe { ptr::copy_nonoverlapping(part.as_ptr(), self.memory.add(offset), part.len()) };
            offset += part.len();
        }
        header.kind.store(kind, Ordering::Relaxed);
        header.length.store(length as u32, Ordering::Relaxed);
        self.give_turn(if kind < kind::RUN { Turn::Host } else { Turn::Child });
        true
    }

    /// Passes the turn to `next`, which finds the message that is in the channel now. Async-signal-safe.
    pub fn give_turn(&self, next: Turn) {
        let turn = &self.header().turn;
        turn.store(next as u32, Ordering::Release);
        self.has_woken.store(wake(turn), Ordering::Relaxed);
    }

    /// Returns true if the other side was asleep when this side last passed it the turn.
    pub fn has_woken(&self) -> bool {
        self.has_woken.load(Ordering::Relaxed)
    }

    /// Spins until `side` has the turn, or for `limit`. Returns true if `side` has the turn. Async-signal-safe.
    pub fn spin_for(&self, side: Turn, limit: Duration) -> bool {
        /// Number of spins between two readings of the clock.
        const SPINS: usize = 32;
        let start = Instant::now();
        while start.elapsed() < limit {
            for _ in 0..SPINS {
                if self.turn() == side {
                    return true;
                }
                hint::spin_loop();
            }
        }
        self.turn() == side
    }

    /// Copies the message out of the channel; the caller must have the turn. `None` if the message's length is
    /// impossible.
    pub fn message(&self) -> Option<Message> {
        fence(Ordering::Acquire);
        let header = self.header();
        let (kind, length) = (header.kind.load(Ordering::Relaxed), header.length.load(Ordering::Relaxed) as usize);
        if length > MAX_BODY {
            return None;
        }
        let mut body = Vec::with_capacity(length);
        // SAFETY: the mapping has as many bytes after the header, and the vector has the capacity; if the other side
        // writes out of turn, the copy contains arbitrary bytes, which are checked like all others.
        unsafe {
            ptr::copy_nonoverlapping(self.memory.add(BODY), body.as_mut_ptr(), length);
            body.set_len(length);
        }
        Some(Message { kind, body })
    }

    /// Waits until `side` has the turn or `timeout` has passed, but may return earlier. Returns true if `side` has the
    /// turn.
    pub fn wait_for(&self, side: Turn, timeout: Option<Duration>) -> bool {
        let other = if side == Turn::Host { Turn::Child } else { Turn::Host };
        if self.turn() != side {
            wait(&self.header().turn, other as u32, timeout);
        }
        self.turn() == side
    }

    /// Process id of the host (channel 0 only).
    pub fn host(&self) -> u32 {
        self.header().host.load(Ordering::Relaxed)
    }

    /// Returns true if the child is importing a module, and the processor time that earlier imports have taken (channel
    /// 0 only).
    pub fn imports(&self) -> (bool, Duration) {
        let header = self.header();
        let spent_ms = header.import_ms.load(Ordering::Relaxed);
        (header.is_importing.load(Ordering::Relaxed) != 0, Duration::from_millis(spent_ms.into()))
    }

    /// Declares that the child can report the location at which it computes.
    pub fn offer_location(&self) {
        self.header().location_state.store(location_state::READY, Ordering::Release);
    }

    /// Requests the location at which the child's thread of this channel computes; the child checks for the request
    /// when it receives a signal. Returns false if the child does not report its location.
    pub fn request_location(&self) -> bool {
        let requested = |state| {
            let may_request =
                matches!(state, location_state::READY | location_state::REQUESTED | location_state::REPORTED);
            may_request.then_some(location_state::REQUESTED)
        };
        self.header().location_state.fetch_update(Ordering::AcqRel, Ordering::Relaxed, requested).is_ok()
    }

    /// Declares the child overdue: from now on the signal ends it.
    pub fn set_overdue(&self) {
        let overdue = |state| (state != location_state::NOT_OFFERED).then_some(location_state::OVERDUE);
        // The signal ends a child that does not offer its location anyway.
        _ = self.header().location_state.fetch_update(Ordering::AcqRel, Ordering::Relaxed, overdue);
    }

    /// Returns true if a signal has no meaning for the child: it belongs to an earlier request, and came late.
    /// Async-signal-safe.
    pub fn is_signal_late(&self) -> bool {
        let state = self.header().location_state.load(Ordering::Acquire);
        matches!(state, location_state::READY | location_state::REPORTED)
    }

    /// Returns true if the host has requested the location; the request ends with [`Channel::report_location`].
    /// Async-signal-safe.
    pub fn is_location_requested(&self) -> bool {
        self.header().location_state.load(Ordering::Acquire) == location_state::REQUESTED
    }

    /// Reports the addresses of the location at which the calling thread computes. Async-signal-safe.
    pub fn report_location(&self, addresses: [u64; 2]) {
        let header = self.header();
        header.location_line.store(0, Ordering::Relaxed);
        for (word, value) in
            header.location_words.iter().zip(addresses.iter().flat_map(|address| [*address, address >> 32]))
        {
            word.store(value as u32, Ordering::Relaxed);
        }
        let (requested, reported) = (location_state::REQUESTED, location_state::REPORTED);
        // The host may have withdrawn the request meanwhile.
        _ = header.location_state.compare_exchange(requested, reported, Ordering::AcqRel, Ordering::Relaxed);
    }

    /// Returns true once the child has reported its location.
    pub fn is_location_reported(&self) -> bool {
        self.header().location_state.load(Ordering::Acquire) == location_state::REPORTED
    }

    /// Takes the location that the child has reported since the request. A request without a report stays, so that its
    /// signal, if it is late, does not end the program.
    pub fn take_location(&self) -> Option<CodeLocation> {
        let header = self.header();
        let (ready, reported) = (location_state::READY, location_state::REPORTED);
        header.location_state.compare_exchange(reported, ready, Ordering::AcqRel, Ordering::Relaxed).ok()?;
        let words: Vec<u32> = header.location_words.iter().map(|word| word.load(Ordering::Relaxed)).collect();
        let line = header.location_line.load(Ordering::Relaxed);
        if line == 0 {
            let address = |low: usize| u64::from(words[low]) | u64::from(words[low + 1]) << 32;
            return Some(CodeLocation::Addresses([address(0), address(2)]));
        }
        let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).take_while(|byte| *byte != 0).collect();
        Some(CodeLocation::Line { file: String::from_utf8_lossy(&bytes).into_owned(), line })
    }

    /// Number of channels (channel 0 only).
    pub fn count(&self) -> u32 {
        self.header().channels.load(Ordering::Acquire)
    }

    /// Sets the number of channels and wakes the child (channel 0 only).
    pub fn set_count(&self, count: u32) {
        self.header().channels.store(count, Ordering::Release);
        wake(&self.header().channels);
    }

    /// Waits until there are more than `count` channels (channel 0 only).
    pub fn wait_for_more_than(&self, count: u32) {
        while self.count() <= count {
            wait(&self.header().channels, count, None);
        }
    }
}

impl Drop for Channel {
    fn drop(&mut self) {
        // SAFETY: the mapping was made with this size, and nothing borrowed from it outlives `self`.
        unsafe { libc::munmap(self.memory.cast(), CHANNEL_SIZE) };
    }
}

/// Sleeps while `word` is `value`, in memory shared between processes; may return at any time.
fn wait(word: &AtomicU32, value: u32, timeout: Option<Duration>) {
    let timeout = timeout.map(|timeout| libc::timespec {
        tv_sec: timeout.as_secs() as libc::time_t,
        tv_nsec: timeout.subsec_nanos() as libc::c_long,
    });
    let timeout = timeout.as_ref().map_or(ptr::null(), ptr::from_ref);
    // SAFETY: the word is mapped and aligned, the timeout null or valid.
    unsafe { libc::syscall(libc::SYS_futex, word.as_ptr(), libc::FUTEX_WAIT, value, timeout) };
}

/// Wakes one thread that sleeps on `word`; returns false if there is none. Async-signal-safe.
fn wake(word: &AtomicU32) -> bool {
    // SAFETY: the word is mapped and aligned.
    unsafe { libc::syscall(libc::SYS_futex, word.as_ptr(), libc::FUTEX_WAKE, 1) > 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_call_gets_a_reply() {
        let channels = Channels::new().unwrap();
        let (host, child) = (channels.map(0).unwrap(), channels.map(0).unwrap());
        assert!(child.is_known());
        assert_eq!((host.turn(), host.count()), (Turn::Child, 1));
        std::thread::scope(|scope| {
            scope.spawn(|| {
                assert!(child.send(kind::CALL, &[b"ab", b"", b"c"]));
                while !child.wait_for(Turn::Child, None) {}
                let reply = child.message().unwrap();
                assert_eq!((reply.kind, reply.body.len()), (kind::OK, MAX_BODY));
                assert_eq!(reply.body[MAX_BODY - 1], 7);
            });
            while !host.wait_for(Turn::Host, Some(Duration::from_secs(60))) {}
            let message = host.message().unwrap();
            assert_eq!((message.kind, &*message.body), (kind::CALL, &b"abc"[..]));
            let long = vec![7; MAX_BODY + 1];
            assert!(!host.send(kind::OK, &[&long]), "too long");
            assert_eq!(host.turn(), Turn::Host, "nothing was sent");
            assert!(host.send(kind::OK, &[&long[1..]]));
        });
    }

    #[test]
    fn spinning_ends_at_the_turn_or_at_the_limit() {
        let channels = Channels::new().unwrap();
        let (host, child) = (channels.map(0).unwrap(), channels.map(0).unwrap());
        assert!(!host.spin_for(Turn::Host, Duration::from_micros(1)));
        assert!(child.send(kind::READY, &[]));
        assert!(!child.has_woken(), "the host does not sleep");
        assert!(host.spin_for(Turn::Host, Duration::from_secs(600)));
    }

    #[test]
    fn channels_are_independent() {
        let channels = Channels::new().unwrap();
        let first = channels.map(0).unwrap();
        channels.grow_to(2).unwrap();
        let second = channels.map(1).unwrap();
        second.set_up();
        first.set_count(2);
        first.wait_for_more_than(1);
        assert!(second.send(kind::READY, &[]));
        assert_eq!((first.turn(), second.turn()), (Turn::Child, Turn::Host));
        assert!(channels.file.set_len(0).is_err(), "the file cannot be cut");
    }

    #[test]
    fn location_request_without_a_report_stays_until_the_child_is_overdue() {
        let channel = Channels::new().unwrap().map(0).unwrap();
        assert!(!channel.request_location(), "the child does not report it");
        channel.set_overdue();
        assert!(!channel.is_signal_late(), "any signal ends the child");
        channel.offer_location();
        assert!(channel.request_location());
        assert_eq!(channel.take_location(), None);
        assert!(channel.is_location_requested(), "the signal may be late");
        channel.report_location([1, 2]);
        assert!(channel.request_location(), "the late report is out of date");
        assert_eq!(channel.take_location(), None);
        channel.report_location([3, 4]);
        assert_eq!(channel.take_location(), Some(CodeLocation::Addresses([3, 4])));
        assert!(channel.is_signal_late() && !channel.is_location_requested(), "a second signal does no harm");
        assert!(channel.request_location());
        channel.set_overdue();
        assert!(!channel.is_location_requested() && !channel.is_signal_late(), "the signal ends the child");
        assert!(!channel.request_location());
    }

    #[test]
    fn an_impossible_length_gives_no_message() {
        let channel = Channels::new().unwrap().map(0).unwrap();
        channel.header().length.store(u32::MAX, Ordering::Relaxed);
        assert!(channel.message().is_none());
    }
}
