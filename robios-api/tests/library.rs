//! Libraries of robot programs, loaded as by the simulator and run against the tables of the fake host.

use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use robios_api::fake::{End, Fake, Run};
use robios_api::prelude::*;
use robios_sys::{EXIT_PANICKED, Program};

/// The folder into which cargo builds libraries of this profile.
fn target_folder() -> PathBuf {
    let test = std::env::current_exe().expect("a test has a path");
    test.ancestors().nth(2).expect("tests lie in `deps`").to_owned()
}

/// Lock for the loaded libraries: one copy of a library runs one robot at a time.
static LIBRARY_LOCK: Mutex<()> = Mutex::new(());

/// The program of a library, which stays loaded.
fn load(library: &str) -> &'static Program {
    let path = target_folder().join(library);
    // SAFETY: the library was built from this workspace; its initialisers are those of `std`.
    let library = unsafe { libloading::Library::new(&path) };
    let library = library.unwrap_or_else(|error| panic!("{error} (`cargo test -p robios-api` builds it)"));
    let library = Box::leak(Box::new(library));
    // SAFETY: the symbol is a `Program`, as `program!` exports it.
    let program = unsafe { library.get::<*const Program>(b"eyesim_program\0") }.expect("it exports its program");
    // SAFETY: as above, and the library stays loaded.
    unsafe { &**program }
}

/// Runs the program of a library.
fn run(library: &str, fake: Fake) -> Run {
    let _lock = LIBRARY_LOCK.lock().unwrap_or_else(PoisonError::into_inner);
    // SAFETY: the library stays loaded.
    unsafe { fake.run_library(load(library)) }
}

fn mischief_library() -> String {
    format!("examples/{}mischief{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX)
}

fn mischief(kind: &str) -> Run {
    run(&mischief_library(), Fake::new().argument(kind).until(5.seconds()))
}

#[test]
fn square_program_drives_a_square() {
    let name = format!("deps/{}square{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    let run = run(&name, Fake::new().argument("0.5")).expect_finished();
    assert_eq!(run.calls_of("VWDriveStraight").count(), 4);
    assert_eq!(run.lcd_line(1), "2: 0.500 0.500");
    assert!(run.position().distance_to(Default::default()) < 0.001.millimetres());
}

#[test]
fn location_of_the_last_call_is_readable() {
    let lock = LIBRARY_LOCK.lock().unwrap_or_else(PoisonError::into_inner);
    let program = load(&mischief_library());
    // SAFETY: the library stays loaded.
    unsafe { Fake::new().argument("loop").until(1.seconds()).run_library(program) };
    // SAFETY: the variable lies in the library, and no program of the library runs now.
    let site = unsafe { program.call_site.read() };
    drop(lock);
    assert!(site.address.is_null());
    // The call in `drop`, which comes later, is not recorded.
    let line = include_str!("../examples/mischief.rs").lines().position(|line| line.contains("robot.key()"));
    assert_eq!(Some(site.line as usize), line.map(|index| index + 1));
    // SAFETY: pointer and length are those of a name in the library.
    let file = unsafe { std::slice::from_raw_parts(site.file, site.file_len) };
    assert!(file.ends_with(b"mischief.rs"), "{}", file.escape_ascii());
}

#[test]
fn panic_is_contained_and_reported_with_its_location() {
    let run = mischief("panic");
    let End::Failed { exit_code, reason } = run.end() else { panic!("{:?}", run.end()) };
    assert_eq!(*exit_code, EXIT_PANICKED);
    let location = reason.strip_prefix("panicked at ").and_then(|rest| rest.strip_suffix(": out of cheese"));
    assert!(location.is_some_and(|location| location.contains("mischief.rs:")), "{reason}");
    assert_eq!(run.console(), "bye\n");
}

#[test]
fn a_panic_in_a_timer_ends_the_program() {
    let run = mischief("panic-in-timer");
    assert!(run.expect_failed().ends_with(": tick"), "{}", run.expect_failed());
    assert_eq!(run.time().as_millis(), 100);
}

#[test]
fn error_is_reported_with_its_text() {
    let run = mischief("error");
    assert_eq!(run.end(), &End::Failed { exit_code: 1, reason: "the battery is flat".to_owned() });
}

#[test]
fn endless_program_is_stopped_at_the_limit() {
    for kind in ["loop", "wait"] {
        let run = mischief(kind).expect_time_up();
        assert_eq!(run.time(), 5.seconds());
    }
    assert!(matches!(mischief("wait").end(), End::TimeUp { during } if during == "KEYWait(8)"));
}

#[test]
fn first_program_of_the_documentation_equals_the_tested_one() {
    let page = include_str!("../../docs/rust-programs.md");
    let program = include_str!("../examples/first.rs");
    assert!(page.contains(&format!("```rust\n{program}```")), "copy examples/first.rs to docs/rust-programs.md");
}
