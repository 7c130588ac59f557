//! Entry and exit of a program: the exported symbol, and the layer between the program's `main` and the host. No panic
//! crosses this layer.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::error::Error as StdError;
use std::ffi::{CStr, c_char, c_int, c_void};
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::sync::Once;

use robios_sys::support::failure;
use robios_sys::{ByteSlice, EXIT_PANICKED, EXIT_STOPPED, Status};

use crate::robot::Stopped;
use crate::{Robot, call_site};

/// Exit code of a program whose `main` returned an error; any Rust program then has this code.
const EXIT_FAILED: c_int = 1;

/// Exports a function as the robot program of this library, under the symbol that the simulator looks up.
///
/// The function takes `&Robot` and returns nothing or a [`Result`](crate::Result) with any error type (`anyhow`'s
/// included). The type of the argument selects the generation: [`robios_api::Robot`](crate::Robot) is RoBIOS 6,
/// [`robios_api::robios7::Robot`](crate::robios7::Robot) is RoBIOS-7. Use the macro once, in a library whose
/// `Cargo.toml` has `crate-type = ["cdylib"]`. The panic strategy must be `unwind`, which is the default.
///
/// ```standalone_crate
/// # mod program {
/// use robios_api::prelude::*;
///
/// robios_api::program!(main);
///
/// fn main(robot: &Robot) -> Result {
///     writeln!(robot.lcd(), "hello");
///     Ok(())
/// }
/// # pub fn check() {
/// #     assert_eq!(robios_api::fake::Fake::new().run(main).lcd_line(0), "hello");
/// # }
/// # }
/// # fn main() {
/// #     program::check();
/// # }
/// ```
#[macro_export]
macro_rules! program {
    ($main:path) => {
        const _: () = {
            #[cfg(not(panic = "unwind"))]
            compile_error!(
                "robot programs need `panic = \"unwind\"` in their profile: an abort would end the simulator"
            );

            unsafe extern "C" fn run(
                host: *const $crate::entry::Host,
                robot: *mut ::core::ffi::c_void,
                argc: ::core::ffi::c_int,
                argv: *const *const ::core::ffi::c_char,
            ) -> ::core::ffi::c_int {
                // SAFETY: the host upholds the contract of `robios_sys::Run`, and this function has that type.
                unsafe { $crate::entry::run(host, robot, argc, argv, $main) }
            }

            #[allow(non_upper_case_globals, reason = "the name that the host looks for")]
            #[unsafe(no_mangle)]
            pub static eyesim_program: $crate::entry::Program = $crate::entry::program($main, run);
        };
    };
}

pub use robios_sys::{Host, Program};

/// Return type of a program's function.
pub trait Outcome {
    /// Text of the failure; `None` for success.
    fn failure(self) -> Option<String>;
}

impl Outcome for () {
    fn failure(self) -> Option<String> {
        None
    }
}

/// Any error, with the chain of its sources.
impl<E: Into<Box<dyn StdError>>> Outcome for Result<(), E> {
    fn failure(self) -> Option<String> {
        let error = self.err()?.into();
        let mut text = error.to_string();
        let mut source = error.source();
        while let Some(cause) = source {
            text.push_str(&format!(": {cause}"));
            source = cause.source();
        }
        Some(text)
    }
}

/// Return type of a function that never returns.
impl Outcome for Never {
    fn failure(self) -> Option<String> {
        self
    }
}

/// The type `!`, named through a trait because stable Rust cannot name it directly.
type Never = <fn() -> ! as sealed::Function>::Output;

/// Robot of one generation of RoBIOS: the argument of a program's function.
pub trait Machine: sealed::Sealed + Sized {
    /// The generation, 6 or 7.
    const GENERATION: u32;

    /// Wraps a robot in the type of this generation.
    #[doc(hidden)]
    fn of(robot: &Robot) -> Self;
}

impl Machine for Robot {
    const GENERATION: u32 = 6;

    fn of(robot: &Robot) -> Self {
        robot.clone()
    }
}

impl Machine for crate::robios7::Robot {
    const GENERATION: u32 = 7;

    fn of(robot: &Robot) -> Self {
        Self(robot.clone())
    }
}

mod sealed {
    /// Restricts [`Machine`](super::Machine) to the robots of this crate.
    pub trait Sealed {}
    impl Sealed for crate::Robot {}
    impl Sealed for crate::robios7::Robot {}

    /// Function type, through which its return type is accessible.
    pub trait Function {
        /// Return type of the function.
        type Output;
    }
    impl<T> Function for fn() -> T {
        type Output = T;
    }
}

/// Description of a program, exported by [`program!`](crate::program); the type of `main` selects the generation.
pub const fn program<M: Machine, O: Outcome>(_main: fn(&M) -> O, run: robios_sys::Run) -> Program {
    let (language, call_site) = (robios_sys::language::RUST, call_site::of_library());
    match M::GENERATION {
        6 => Program::robios6(language, run, call_site),
        _ => Program::robios7(language, run, call_site),
    }
}

/// Runs a program's `main` for the host and returns its exit code.
///
/// # Safety
/// The arguments must meet the contract of [`robios_sys::Run`], for a host of the robot's generation.
pub unsafe fn run<M: Machine, O: Outcome>(
    host: *const Host,
    context: *mut c_void,
    argc: c_int,
    argv: *const *const c_char,
    main: fn(&M) -> O,
) -> c_int {
    // SAFETY: the caller vouches for the arguments.
    unsafe { run_for(call_site::Recorder::Host, host, context, argc, argv, main) }
}

/// Like [`run`], with a given recorder of call sites.
///
/// # Safety
/// See [`run`].
pub(crate) unsafe fn run_for<M: Machine, O: Outcome>(
    recorder: call_site::Recorder,
    host: *const Host,
    context: *mut c_void,
    argc: c_int,
    argv: *const *const c_char,
    main: impl FnOnce(&M) -> O,
) -> c_int {
    install_hook();
    // SAFETY: the caller vouches for the arguments.
    let arguments = unsafe { arguments(argc, argv) };
    // SAFETY: the caller vouches for host and context, and the robot is closed below.
    let robot = unsafe { Robot::new(host, context, arguments, recorder) };
    let code = catch_failure(&robot, || main(&M::of(&robot)).failure());
    robot.end_tasks();
    robot.close();
    robot.common().failure.get().copied().unwrap_or(code)
}

/// Runs `main` or the function of a task, reports its failure to the host and returns the exit code.
fn catch_failure(robot: &Robot, function: impl FnOnce() -> Option<String>) -> c_int {
    let outcome = {
        let _guard = ProgramGuard::enter();
        panic::catch_unwind(AssertUnwindSafe(function))
    };
    match outcome {
        Ok(None) => 0,
        Ok(Some(text)) => {
            report(robot, failure::ERROR, &text);
            EXIT_FAILED
        }
        Err(payload) if payload.is::<Stopped>() => EXIT_STOPPED,
        Err(payload) => {
            report(robot, failure::PANIC, &panic_text(payload));
            EXIT_PANICKED
        }
    }
}

/// Runs the function of a task other than `main`; its failure is a failure of the program.
pub(crate) fn run_task(robot: &Robot, function: impl FnOnce() -> Option<String>) -> Status {
    match catch_failure(robot, function) {
        0 => Status::OK,
        EXIT_STOPPED => Status::STOP,
        code => {
            let _already_set = robot.common().failure.set(code);
            Status::STOP
        }
    }
}

/// Reports the panic of a timer's function; the enclosing call then ends the program. A panic with [`Stopped`] is not
/// reported.
pub(crate) fn report_callback_panic(robot: &Robot, payload: Box<dyn Any + Send>) {
    if !payload.is::<Stopped>() {
        report(robot, failure::PANIC, &panic_text(payload));
        let _already_set = robot.common().failure.set(EXIT_PANICKED);
    }
}

/// Reports the program's failure to the host.
fn report(robot: &Robot, kind: i32, text: &str) {
    if let Some(tables) = robot.tables() {
        // SAFETY: the tables are valid until the robot is closed, the text outlives the call, and the result may be
        // null. The status is ignored: the program ends anyway.
        let _ = unsafe {
            ((*tables.support).failed)(
                tables.context,
                kind,
                ByteSlice::from(text),
                ByteSlice::from(""),
                std::ptr::null_mut(),
            )
        };
    }
}

/// Arguments of the program, without its name (the first).
///
/// # Safety
/// `argv` is null or has `argc` strings that end in 0.
unsafe fn arguments(argc: c_int, argv: *const *const c_char) -> Vec<String> {
    if argv.is_null() {
        return Vec::new();
    }
    (1..usize::try_from(argc).unwrap_or(0))
        // SAFETY: the index is below argc, and the caller vouches for the strings.
        .map(|index| unsafe { CStr::from_ptr(*argv.add(index)) }.to_string_lossy().into_owned())
        .collect()
}

thread_local! {
    /// Number of programs that run on this thread; more than one only in tests of this crate.
    static RUNNING_PROGRAMS: Cell<u32> = const { Cell::new(0) };
    /// Location and text of the program's last panic on this thread.
    static LAST_PANIC: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Guard: while it lives, panics of this thread belong to the program.
struct ProgramGuard;

impl ProgramGuard {
    fn enter() -> Self {
        RUNNING_PROGRAMS.set(RUNNING_PROGRAMS.get() + 1);
        Self
    }
}

impl Drop for ProgramGuard {
    fn drop(&mut self) {
        RUNNING_PROGRAMS.set(RUNNING_PROGRAMS.get() - 1);
    }
}

/// Keeps panics of a program off standard error: the host shows them with the robot's name.
///
/// A library has its own copy of `std` and thus its own hook. In a unit test the hook is shared with the test harness,
/// which still receives all other panics.
fn install_hook() {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| {
        let previous_hook = panic::take_hook();
        panic::set_hook(Box::new(move |panic| {
            if RUNNING_PROGRAMS.get() == 0 {
                previous_hook(panic);
            } else {
                LAST_PANIC.set(Some(formatted(panic)));
            }
        }));
    });
}

/// Formats a panic as `src/lib.rs:12:5: text`.
fn formatted(panic: &PanicHookInfo<'_>) -> String {
    let text = panic.payload_as_str().unwrap_or("a panic without a text");
    match panic.location() {
        Some(location) => format!("{location}: {text}"),
        None => text.to_owned(),
    }
}

/// Text of a caught panic, with its location if the hook has recorded it.
fn panic_text(payload: Box<dyn Any + Send>) -> String {
    LAST_PANIC.take().unwrap_or_else(|| match payload.downcast::<String>() {
        Ok(text) => *text,
        Err(payload) => match payload.downcast::<&str>() {
            Ok(text) => (*text).to_owned(),
            Err(_other) => "a panic without a text".to_owned(),
        },
    })
}
