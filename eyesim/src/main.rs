//! The command `eyesim`: see `eyesim --help` and the README.

use std::process::ExitCode;

/// Heap of the host. It is not the heap of libc, which a faulty robot program may leave locked or corrupted.
#[global_allocator]
static HEAP: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    sim_host::executive::save_memory();
    // If this fails, a write beyond the file size limit ends the process, as it does without this call.
    _ = sim_host::executive::interrupt::ignore_file_limit();
    eyesim::cli::main()
}
