//! Interface between the host and a program's library, apart from the calls: the status of a call, the root of the
//! tables, and the program's one exported symbol.

use std::ffi::{c_char, c_int, c_void};

use crate::{robios6::Robios6Table, robios7::Robios7Table, support::SupportTable};

/// Version of all layouts in this crate: a host runs only programs built for the same version.
///
/// The version increases when an existing layout changes, but not when functions are appended to a table: see
/// [`Program::support_size`].
pub const ABI_VERSION: u32 = 2;

/// The name of the one symbol that a program's library exports: a constant [`Program`].
pub const PROGRAM_SYMBOL: &str = "eyesim_program";

/// Result of [`Program::run`] after a call was answered with [`Status::STOP`].
///
/// The host does not detect by this number that it has stopped the program: a C program may return it too.
pub const EXIT_STOPPED: c_int = c_int::MIN;

/// Result of [`Program::run`] after `abort`, a failed assertion or a smashed stack: 128 + SIGABRT, as in a shell.
pub const EXIT_ABORTED: c_int = 134;

/// Result of [`Program::run`] of a Rust program after a panic, as in the Rust run time.
pub const EXIT_PANICKED: c_int = 101;

/// Tags that replace `DT_INIT_ARRAY` and `DT_INIT_ARRAYSZ` in a library's dynamic section: the dynamic linker ignores
/// them, and [`Program::run`] calls the constructors as a part of the program.
pub const CONSTRUCTOR_TAGS: [u32; 2] = [0x6579_0001, 0x6579_0002];

/// Status of a call: the program continues or must end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
#[must_use]
pub struct Status(pub i32);

impl Status {
    /// The call was executed and its result was written.
    pub const OK: Self = Self(0);
    /// The program must end: no result was written, and further calls have no effect.
    ///
    /// The program's shim ends it: C by `longjmp`, Rust by unwinding with a private payload.
    pub const STOP: Self = Self(1);
}

/// The host's side of [`Status::STOP`]: the error of every method of a table's trait.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stop;

impl std::fmt::Display for Stop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("the program is stopped")
    }
}

impl std::error::Error for Stop {}

/// Root structure passed to a program: all tables that the host offers. Valid until [`Program::run`] has returned.
///
/// Fields are only appended; tables of generations other than the program's are null.
#[repr(C)]
pub struct Host {
    /// Size of this struct in the host, in bytes.
    pub size: u32,
    /// [`ABI_VERSION`] of the host.
    pub abi: u32,
    /// Services for the program's language runtime; never null.
    pub support: *const SupportTable,
    /// RoBIOS 6; null for a program of another generation.
    pub robios6: *const Robios6Table,
    /// RoBIOS-7; null for a program of another generation.
    pub robios7: *const Robios7Table,
}

// SAFETY: the pointers lead to tables that are constant for the whole run.
unsafe impl Sync for Host {}
// SAFETY: as for `Sync`.
unsafe impl Send for Host {}

impl Host {
    /// The root for a program of RoBIOS 6, over static tables.
    pub const fn of_robios6(support: &'static SupportTable, robios6: &'static Robios6Table) -> Self {
        Self { robios6, ..Self::without_robios(support) }
    }

    /// The root for a program of RoBIOS-7, over static tables.
    pub const fn of_robios7(support: &'static SupportTable, robios7: &'static Robios7Table) -> Self {
        Self { robios7, ..Self::without_robios(support) }
    }

    const fn without_robios(support: &'static SupportTable) -> Self {
        let (robios6, robios7) = (std::ptr::null(), std::ptr::null());
        Self { size: size_of::<Self>() as u32, abi: ABI_VERSION, support, robios6, robios7 }
    }
}

/// Language of a program's shim, [`Program::language`].
pub mod language {
    /// C, with `shim.c`.
    pub const C: u32 = 1;
    /// Rust, with `robios-api`.
    pub const RUST: u32 = 2;
    /// C++, or C++ and C, with `shim.c` and `cpp.cpp`.
    pub const CPP: u32 = 3;
}

/// Bits of [`Program::flags`].
pub mod flag {
    /// `main` returns no value: the result of `run` is meaningless, and the exit code is 0.
    pub const VOID_MAIN: u32 = 1;
}

/// Runs the program's `main` once, on the calling thread, and returns its exit code.
///
/// `host` and `robot` are valid until it returns; `robot` is passed back in every call. `argv` has `argc` strings
/// that end in 0, then a null pointer, all valid until it returns; the C shim copies them, as `main` may change them.
pub type Run =
    unsafe extern "C" fn(host: *const Host, robot: *mut c_void, argc: c_int, argv: *const *const c_char) -> c_int;

/// Location of the program's call in progress. The shim writes it before each call, and the host reads it to report
/// where a program waits. After a call the shim of C makes `address` less by 1.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct CallSite {
    /// Address in the program's code just after the call; null if `file` is given.
    pub address: *const c_void,
    /// Name of the source file, valid as long as the program; null if `address` is given.
    pub file: *const u8,
    /// Length of the name in bytes.
    pub file_len: usize,
    /// Line in the file, from 1.
    pub line: u32,
}

// SAFETY: the pointers lead to constants of the program's image, which is never unloaded.
unsafe impl Send for CallSite {}
// SAFETY: as for `Send`.
unsafe impl Sync for CallSite {}

impl CallSite {
    /// No call yet.
    pub const NONE: Self = Self { address: std::ptr::null(), file: std::ptr::null(), file_len: 0, line: 0 };
}

/// Unfinished line that a program has printed to a stream and that its shim has not passed on yet. The host reads it if
/// the program crashes.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Console {
    /// One of [`stream`](crate::support::stream).
    pub stream: i32,
    /// Length of the text in bytes, at most [`CONSOLE_LINE`].
    pub used: usize,
    /// The text; null before the first one.
    pub line: *const u8,
}

/// Maximum length of the text of a [`Console`], in bytes; longer lines are passed on in pieces.
pub const CONSOLE_LINE: usize = 1024;

/// Description of a program, exported by its library as [`PROGRAM_SYMBOL`]. Fields are only appended.
#[repr(C)]
pub struct Program {
    /// Size of this struct in the program, in bytes.
    pub size: u32,
    /// [`ABI_VERSION`] that the program was built against.
    pub abi: u32,
    /// RoBIOS generation: 6 or 7.
    pub generation: u32,
    /// Bits of [`flag`].
    pub flags: u32,
    /// One of [`language`].
    pub language: u32,
    /// Size of the [`SupportTable`] known to the program, in bytes. A host with a smaller table must refuse the
    /// program.
    pub support_size: u32,
    /// Size of the RoBIOS table known to the program, in bytes. A host with a smaller table must refuse the program.
    pub robios_size: u32,
    /// Runs the program.
    pub run: Run,
    /// Call site of the program in this copy of the library; null if its shim does not record it. Read only while the
    /// program is suspended in a call.
    pub call_site: *const CallSite,
    /// Console streams of the program in this copy of the library, standard output and standard error; null if its shim
    /// collects no text. Read by [`Program::consoles`].
    consoles: *const [Console; 2],
}

// SAFETY: the pointers lead to variables of the image in which this constant lies; they are read only as their docs
// say.
unsafe impl Sync for Program {}
// SAFETY: as for `Sync`.
unsafe impl Send for Program {}

impl Program {
    /// The description of a RoBIOS 6 program built against this crate.
    pub const fn robios6(language: u32, run: Run, call_site: *const CallSite) -> Self {
        Self::new(6, size_of::<Robios6Table>(), language, run, call_site)
    }

    /// The description of a RoBIOS-7 program built against this crate.
    pub const fn robios7(language: u32, run: Run, call_site: *const CallSite) -> Self {
        Self::new(7, size_of::<Robios7Table>(), language, run, call_site)
    }

    const fn new(generation: u32, table: usize, language: u32, run: Run, call_site: *const CallSite) -> Self {
        Self {
            size: size_of::<Self>() as u32,
            abi: ABI_VERSION,
            generation,
            flags: 0,
            language,
            support_size: size_of::<SupportTable>() as u32,
            robios_size: table as u32,
            run,
            call_site,
            consoles: std::ptr::null(),
        }
    }

    /// Address of the program's console streams, two values of [`Console`]; 0 if it has none. The program may have
    /// overwritten them.
    pub fn consoles(&self) -> usize {
        if self.size as usize >= size_of::<Self>() { self.consoles.addr() } else { 0 }
    }

    /// Checks that a host built with this crate can run the program.
    ///
    /// # Errors
    /// The reason why it cannot, to be shown to the user.
    pub fn check(&self) -> Result<(), Incompatibility> {
        if self.abi != ABI_VERSION {
            return Err(Incompatibility::Abi { program: self.abi });
        }
        let table = match self.generation {
            6 => size_of::<Robios6Table>(),
            7 => size_of::<Robios7Table>(),
            other => return Err(Incompatibility::Generation(other)),
        };
        let offered = [size_of::<SupportTable>(), table];
        if [self.support_size as usize, self.robios_size as usize]
            .iter()
            .zip(offered)
            .any(|(known, size)| *known > size)
        {
            return Err(Incompatibility::Newer);
        }
        Ok(())
    }
}

/// Reason why a host refuses a program, see [`Program::check`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Incompatibility {
    /// The program was built against another ABI version.
    Abi {
        /// ABI version of the program.
        program: u32,
    },
    /// The program's RoBIOS generation is unknown to the host.
    Generation(u32),
    /// The program was built against tables with functions that the host does not have.
    Newer,
}

impl std::fmt::Display for Incompatibility {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Abi { program } => {
                write!(f, "the program was built against ABI version {program}, this is {ABI_VERSION}: build it again")
            }
            Self::Generation(generation) => {
                write!(f, "the program was built for RoBIOS `{generation}`, known are 6 and 7")
            }
            Self::Newer => f.write_str("the program was built for a newer eyesim with more functions: build it again"),
        }
    }
}

impl std::error::Error for Incompatibility {}

#[cfg(test)]
mod tests {
    use super::*;

    unsafe extern "C" fn run(_: *const Host, _: *mut c_void, _: c_int, _: *const *const c_char) -> c_int {
        0
    }

    #[test]
    fn incompatible_program_is_refused() {
        let compatible = || Program::robios6(language::RUST, run, std::ptr::null());
        assert_eq!(compatible().check(), Ok(()));
        let older = Program { robios_size: compatible().robios_size - 8, ..compatible() };
        assert_eq!(older.check(), Ok(()), "a table is only appended to");
        let newer = Program { robios_size: compatible().robios_size + 8, ..compatible() };
        assert_eq!(newer.check(), Err(Incompatibility::Newer));
        let other_abi = Program { abi: ABI_VERSION + 1, ..compatible() };
        assert_eq!(other_abi.check(), Err(Incompatibility::Abi { program: ABI_VERSION + 1 }));
        assert_eq!(Program::robios7(language::C, run, std::ptr::null()).check(), Ok(()));
        let generation8 = Program { generation: 8, ..compatible() };
        assert_eq!(generation8.check(), Err(Incompatibility::Generation(8)));
    }
}
