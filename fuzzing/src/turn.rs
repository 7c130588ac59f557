//! The host's side of the channel to a robot's process that violates the protocol.

use std::fs::File;
use std::os::unix::fs::FileExt as _;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock};
use std::time::Duration;

use robios_sys::{CallContext, Robios6, Robios7, Support};
use sim_host::executive::process::Child;
use sim_host::executive::process::channel::{Channels, Turn, kind};
use sim_host::executive::process::serve::{LoadRefusal, RemoteProgram};
use sim_host::program::find::ProgramSource;
use sim_host::program::image::ProgramImage;
use sim_host::program::prepare::{Code, Prepared};

/// Offset in a channel of the words after the turn, and their size in bytes; a record begins with these words.
const WORDS: u64 = 12;
const WORDS_SIZE: usize = 28;

/// Offset of the message's body.
const BODY: u64 = 64;

/// A robot that returns each call's documented failure.
struct Robot;

impl CallContext for Robot {}
impl Support for Robot {}
impl Robios6 for Robot {}
impl Robios7 for Robot {}

/// Serves the program of a process whose messages are the records of `input`. A record is a length in two bytes, then
/// as many bytes: the words of the channel's header after the turn, and the body of the message. A length of 0 in the
/// header stands for the length of the body.
///
/// The host must answer each message, or abandon the process with a reason.
pub fn turn(input: &[u8]) {
    let (is_over, program) = (AtomicBool::new(false), Arc::clone(&PROGRAM));
    // The process itself does nothing: this process writes its channel.
    let mut command = Command::new("sleep");
    command.arg("1000");
    let child = Child::start(command, None).expect("the system has room for a process");
    let path = format!("/proc/{}/fd/0", child.pid());
    let file = File::options().read(true).write(true).open(path).expect("the channel of a process that lives");
    std::thread::scope(|scope| {
        scope.spawn(|| write_records(&file, input, &is_over));
        let _over = Over(&is_over);
        match RemoteProgram::new(child, program, &["argument".to_owned()]) {
            Ok(program) => serve(&program),
            Err(LoadRefusal::Failed(why)) => assert!(!why.is_empty(), "given up without a reason"),
            Err(LoadRefusal::Linker(_) | LoadRefusal::Incompatible(_)) => {}
        }
    });
}

/// Sets its variable when dropped, including by a panic.
struct Over<'a>(&'a AtomicBool);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}

/// Runs the program to its end and reads all results that are then available.
fn serve(program: &RemoteProgram) {
    if let Err(failure) = program.run(&Robot) {
        assert!(!failure.description.is_empty(), "given up without a reason");
        let line = program.own_source_line(&failure.addresses);
        assert!(line.is_none_or(|line| !line.file.as_os_str().is_empty()), "a line of no file");
    }
    let location = program.location_of(&program.call_site());
    assert!(location.is_none_or(|location| !location.is_empty()), "a place without words");
}

/// Writes a record each time the process has the turn, and finally the end of `main`.
fn write_records(file: &File, input: &[u8], is_over: &AtomicBool) {
    let channels = file.try_clone().and_then(Channels::of_file).expect("the file of channels");
    let channel = channels.map(0).expect("room for a mapping");
    let mut rest = input;
    loop {
        while !channel.wait_for(Turn::Child, Some(Duration::from_millis(5))) {
            if is_over.load(Ordering::Acquire) {
                return;
            }
        }
        let Some((record, others)) = record(rest) else {
            channel.send(kind::EXITED, &[&0_i32.to_le_bytes()]);
            return;
        };
        rest = others;
        let (words, body) = record.split_at(record.len().min(WORDS_SIZE));
        let mut words = words.to_vec();
        if let Some(length) = words.get_mut(4..8).filter(|length| length.iter().all(|byte| *byte == 0)) {
            length.copy_from_slice(&(body.len() as u32).to_le_bytes());
        }
        file.write_all_at(&words, WORDS).and_then(|()| file.write_all_at(body, BODY)).expect("the channel has room");
        channel.give_turn(Turn::Host);
    }
}

/// The next record of an input, and the remaining input.
fn record(input: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = input.split_first_chunk::<2>()?;
    Some(rest.split_at(rest.len().min(u16::from_le_bytes(*length).into())))
}

/// The program of the process: any library, since only its source locations are used.
static PROGRAM: LazyLock<Arc<Prepared>> = LazyLock::new(|| {
    let maps = std::fs::read_to_string("/proc/self/maps").expect("the kernel lists the mappings");
    let library = maps.lines().filter_map(|line| line.split_once('/')).map(|(_, path)| format!("/{path}"));
    let library = library.into_iter().find(|path| path.contains("/ld-linux")).expect("the dynamic linker is mapped");
    let image = ProgramImage::read(Path::new(&library), None).unwrap_or_else(|error| panic!("{error}"));
    Arc::new(Prepared {
        name: "program".to_owned(),
        source: ProgramSource::Library(library.into()),
        code: Code::Library(Arc::new(image)),
        output: String::new(),
        compiled: false,
        choice: None,
        warnings: Vec::new(),
        danger: None,
    })
});
