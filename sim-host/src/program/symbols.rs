//! Warnings about functions of the C library that reach beyond the robot.

use std::collections::BTreeMap;

use robios_sys::{c, language};

use super::image::ProgramImage;

/// Symbols that the shim of C programs imports for itself, for descriptors other than the robot's console.
const SHIM: &[&str] = &["syscall"];

/// Symbols that the static C++ library imports for itself besides, for locales and streams. They do not tell if the program reads
/// the environment or changes its locale.
///
/// Found by looking at programs built with GCC 12.
const CPP_LIBRARY: &[&str] = &["syscall", "getenv", "secure_getenv", "uselocale", "setlocale", "ioctl", "readv"];

/// Symbols that the Rust standard library imports for itself, for panics and locks, in every program: they tell nothing about
/// the program. Its imports for `Instant` (`clock_gettime`), `sleep` (`clock_nanosleep`), threads (`pthread_create`) and `exit`
/// exist only if the program uses these.
///
/// Found by looking at programs built with Rust 1.95.
const RUST_RUNTIME: &[&str] = &["abort", "close", "getenv", "poll", "read", "sigaction", "syscall", "write", "writev"];

/// Warnings about imports of `image` that are outside the guarantee of equal runs: a line for each reason, with the names of the
/// functions; `name` is the program's. In a C program built by eyesim these are only functions that no shim interposes.
///
/// In Rust programs only imports count that their standard library does not have anyway, so `println!` and the order of a
/// `HashMap` are not reported, see `docs/programs.md`.
pub fn warnings_about(image: &ProgramImage, name: &str) -> Vec<String> {
    let own = match image.description().map(|description| description.language) {
        Some(language::C) => SHIM,
        Some(language::CPP) => CPP_LIBRARY,
        Some(language::RUST) => RUST_RUNTIME,
        _ => &[],
    };
    let told = image.undefined().iter().filter(|name| !own.contains(&name.as_str()));
    let mut by_reason: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for name in told {
        if let Some(reason) = c::outside_guarantee(name) {
            by_reason.entry(reason).or_default().push(name);
        }
    }
    let line = |(reason, names): (&str, Vec<&str>)| {
        let names: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
        format!("program `{name}` uses {}: {reason}", names.join(", "))
    };
    by_reason.into_iter().map(line).collect()
}
