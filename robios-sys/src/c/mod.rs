//! The C side, as text: headers for programs, the shim that is compiled into every C program's library, the compiler's
//! flags, and the interposed functions of the C library. Files that are generated from the lists of functions begin
//! with a note; `cargo run -p robios-sys --bin generate` writes them.

mod generate;
mod library;
mod page;

pub use generate::{generated_files, prototype};
pub use library::{INTERPOSED, OUTSIDE_GUARANTEE, endangers_host, outside_guarantee};
pub use page::c_library_page;

/// A file of the C side.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SourceFile {
    /// Its name, without a folder.
    pub name: &'static str,
    /// Content of the file.
    pub text: &'static str,
}

macro_rules! files {
    ($($folder:literal / $name:literal),* $(,)?) => {
        &[$(SourceFile { name: $name, text: include_str!(concat!("../../", $folder, "/", $name)) }),*]
    };
}

/// The headers for programs of RoBIOS 6; the compiler gets their folder with `-I`.
pub const HEADERS6: &[SourceFile] = files![
    "include/robios6" / "eyebot.h",
    "include/robios6" / "hdt_sem.h",
    "include/robios6" / "hdt.h",
    "include/robios6" / "types.h",
    "include/robios6" / "keys.h",
    "include/robios6" / "kern.h",
    "include/robios6" / "protos.h",
    "include/robios6" / "variants.h",
    "include/both" / "eyesim-c-library.h",
    "include/both" / "eyesim-truth.h",
    "include/both" / "eyesim-old-names.h",
    "include/both" / "eyesim.h",
    "include/both" / "librobi/librobi.h",
];

/// The headers for programs of RoBIOS-7.
pub const HEADERS7: &[SourceFile] = files![
    "include/robios7" / "eyebot.h",
    "include/robios7" / "eyebot++.h",
    "include/robios7" / "types.h",
    "include/robios7" / "variants.h",
    "include/robios7" / "X11/Xlib.h",
    "include/both" / "eyesim-c-library.h",
    "include/both" / "eyesim-truth.h",
    "include/both" / "eyesim-old-names.h",
    "include/both" / "eyesim.h",
    "include/both" / "librobi/librobi.h",
];

/// The header of [`HEADERS6`] and [`HEADERS7`] that is included before a source that calls functions of the C library
/// without a declaration.
pub const C_LIBRARY_HEADER: &str = "eyesim-c-library.h";

/// The header of [`HEADERS6`] and [`HEADERS7`] that is included before a source that uses one of [`TRUTH`] without a
/// declaration. It is separate, since a source that uses `TRUE` may define some of [`OLD_NAMES`] itself.
pub const TRUTH_HEADER: &str = "eyesim-truth.h";

/// Names of [`TRUTH_HEADER`].
pub const TRUTH: [&str; 3] = ["TRUE", "FALSE", "BOOL"];

/// The header of [`HEADERS6`] and [`HEADERS7`] that is included before a source that uses one of [`OLD_NAMES`] without
/// a declaration.
pub const OLD_NAMES_HEADER: &str = "eyesim-old-names.h";

/// Names of [`OLD_NAMES_HEADER`]: those of the other generation, of demonstration programs and of older headers. They
/// are not in `eyebot.h`, since many programs define some of them themselves.
pub const OLD_NAMES: [&str; 7] = ["NONE", "RTSCTS", "NL", "CAMWAIT", "TimerHandle", "TIMER", "keycode_t"];

/// Flag for a source whose names collide with the additional names of RoBIOS-7's `types.h`.
pub const LEAN_FLAG: &str = "-DEYESIM_LEAN";

/// The header with further names of RoBIOS 6.
pub const VARIANTS6: &str = include_str!("../../include/robios6/variants.h");

/// The header with further names of RoBIOS-7.
pub const VARIANTS7: &str = include_str!("../../include/robios7/variants.h");

/// The shim: with these files and the headers of a generation in `-I` folders, [`SHIM_SOURCE`] is compiled and linked
/// into a program.
pub const SHIM: &[SourceFile] = files![
    "shim" / "abi.h",
    "shim" / "robios6.c",
    "shim" / "robios7.c",
    "shim" / "shim.c",
    "shim" / "cpp.cpp",
    "shim" / "exports.map",
    "shim" / "robios6_own.c",
    "shim" / "robios7_own.c",
    "shim" / "libc.c",
    "shim" / "layer.c",
    "shim" / "getopt.c",
    "shim" / "pthread.c",
];

/// The C file of [`SHIM`] that is compiled; it includes the other C files and the header.
pub const SHIM_SOURCE: &str = "shim.c";

/// The file of [`SHIM`] that is compiled by the C++ compiler for programs with parts in C++.
pub const CPP_SHIM_SOURCE: &str = "cpp.cpp";

/// Flags for compiling a program's files.
///
/// `-fcommon`: old programs define one variable in several files. `-ffp-contract=off`: bit-identical results on every
/// processor. `-fno-strict-aliasing`: old programs read images through other types. `-pipe`: the assembler's messages
/// name no temporary file, whose name differs each time.
///
/// `-fno-builtin-...`: functions outside of the C standards, which programs may define themselves; given the same type,
/// a compiler would substitute its own.
pub const COMPILE_FLAGS: &[&str] = &[
    "-g",
    "-pipe",
    "-fPIC",
    "-fcommon",
    "-ffp-contract=off",
    "-fno-strict-aliasing",
    "-fno-builtin-bcmp",
    "-fno-builtin-bzero",
    "-fno-builtin-drem",
    "-fno-builtin-exp10",
    "-fno-builtin-ffs",
    "-fno-builtin-gamma",
    "-fno-builtin-index",
    "-fno-builtin-isascii",
    "-fno-builtin-j0",
    "-fno-builtin-j1",
    "-fno-builtin-jn",
    "-fno-builtin-pow10",
    "-fno-builtin-rindex",
    "-fno-builtin-scalb",
    "-fno-builtin-significand",
    "-fno-builtin-toascii",
    "-fno-builtin-y0",
    "-fno-builtin-y1",
    "-fno-builtin-yn",
];

/// Flags for compiling the shim, which must not be checked by the functions that it interposes.
pub const SHIM_FLAGS: &[&str] = &[
    "-g",
    "-O1",
    "-fPIC",
    "-std=gnu11",
    "-U_FORTIFY_SOURCE",
    "-fno-stack-protector",
    "-fno-builtin",
    "-Wno-prio-ctor-dtor",
];

/// Flags for compiling the shim's part in C++.
pub const CPP_SHIM_FLAGS: &[&str] =
    &["-g", "-O1", "-fPIC", "-std=gnu++17", "-U_FORTIFY_SOURCE", "-fno-stack-protector", "-fexceptions", "-frtti"];

/// Flags for the shim of a program with parts in C++, whose functions are unwound.
pub const CPP_FLAGS: &[&str] = &["-DEYESIM_CPP", "-fexceptions"];

/// Flag for the shim of a program whose `main` returns no value: the exit code is then 0.
pub const VOID_MAIN_FLAG: &str = "-DEYESIM_VOID_MAIN";

/// Flags for linking a program's library.
///
/// `-Bsymbolic` binds a program's references to its own and the shim's functions instead of libc's; `-z defs` reports a
/// misspelled function when linking and not when loading.
pub const LINK_FLAGS: &[&str] = &["-shared", "-Wl,-Bsymbolic", "-Wl,-z,defs"];

/// Flags for linking a library with parts in C++: its copies share neither the C++ library nor symbols that C++ makes
/// unique in the process (`STB_GNU_UNIQUE`: static variables of templates and inline functions).
pub const CPP_LINK_FLAGS: &[&str] = &["-static-libstdc++", "-static-libgcc"];

/// The file of [`SHIM`] that is the linker's version script of a library with parts in C++, which exports only its
/// description.
pub const CPP_EXPORTS: &str = "exports.map";

/// Libraries, last on the linker's command line.
pub const LIBRARIES: &[&str] = &["-lm"];
