//! Warns about functions of the C library whose effects extend beyond the robot.

use std::collections::BTreeMap;

use robios_sys::{c, language};

use super::image::ProgramImage;

/// Symbols that the static C++ library imports for itself, for locales and streams. They do not show whether the
/// program reads the environment or changes its locale.
///
/// Source: programs built with GCC 12.
const CPP_LIBRARY: &[&str] = &["syscall", "getenv", "secure_getenv", "uselocale", "setlocale", "ioctl", "readv"];

/// Symbols that the Rust standard library imports for itself, for panics and locks, in every program: they show nothing
/// about the program itself. Its imports for `Instant` (`clock_gettime`), `sleep` (`clock_nanosleep`), threads
/// (`pthread_create`) and `exit` exist only if the program uses these.
///
/// Source: programs built with Rust 1.95.
const RUST_RUNTIME: &[&str] = &["abort", "close", "getenv", "poll", "read", "sigaction", "syscall", "write", "writev"];

/// Warnings about imports of `image` that make runs nondeterministic, one line for each reason, with the names of the
/// functions. `name` is the program's. In a C program built by eyesim these are only functions that no shim interposes.
///
/// In Rust programs, imports that every program has because of the standard library are ignored, so `println!` and the
/// order of a `HashMap` are not reported, see `docs/programs.md`.
pub fn warnings_about(image: &ProgramImage, name: &str) -> Vec<String> {
    uses(image, reason_in_program(image)).into_iter().map(|line| format!("program `{name}` {line}")).collect()
}

/// Returns the function that gives the reason why a symbol makes programs of this language nondeterministic.
fn reason_in_program(image: &ProgramImage) -> fn(&str) -> Option<&'static str> {
    match image.description().map(|description| description.language) {
        Some(language::RUST) => |symbol| match symbol {
            "clock_nanosleep" | "nanosleep" => {
                Some("`std::thread::sleep` lets no time of the robot pass: write `robot.sleep(Duration::from_secs(2))`")
            }
            _ => c::outside_guarantee(symbol),
        },
        _ => c::outside_guarantee,
    }
}

/// Returns the reason why the program of `image` could end or stop the host on one of its threads, according to its
/// imports and symbols: `` uses `fork`: starts or waits for processes, which are copies of the host ``.
pub fn danger_to_host(image: &ProgramImage) -> Option<String> {
    let resolver_danger =
        image.has_resolvers().then(|| "has IFUNC symbols: its code runs while it is being loaded".to_owned());
    uses(image, c::endangers_host).into_iter().next().or(resolver_danger)
}

/// Imports of `image` for which there is a `reason`, except those of its language's own library: one line for each
/// reason.
fn uses(image: &ProgramImage, reason: fn(&str) -> Option<&'static str>) -> Vec<String> {
    let library_imports = match image.description().map(|description| description.language) {
        Some(language::CPP) => CPP_LIBRARY,
        Some(language::RUST) => RUST_RUNTIME,
        _ => &[],
    };
    let mut by_reason: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for name in image.undefined().iter().filter(|name| !library_imports.contains(&name.as_str())) {
        if let Some(reason) = reason(name) {
            by_reason.entry(reason).or_default().push(format!("`{name}`"));
        }
    }
    by_reason.into_iter().map(|(reason, names)| format!("uses {}: {reason}", names.join(", "))).collect()
}
