//! The command `eyesim`: see `eyesim --help` and the README.

use std::process::ExitCode;

/// The host's heap is not libc's, which a robot program that faults may leave locked or corrupted.
#[global_allocator]
static HEAP: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    sim_host::executive::save_memory();
    eyesim::cli::main()
}
