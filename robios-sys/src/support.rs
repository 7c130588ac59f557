//! What every program's language needs of the host, whatever its RoBIOS generation: console, random numbers, virtual
//! time and the end of the program.

use crate::param::{Bytes, OutBytes, Text};

/// The first argument of [`Support::console`].
pub mod stream {
    /// Standard output.
    pub const OUT: i32 = 1;
    /// Standard error.
    pub const ERR: i32 = 2;
}

/// The first argument of [`Support::random`] and [`Support::seed`]: one stream of numbers for each.
pub mod purpose {
    /// `rand` and `srand` of C.
    pub const RAND: u32 = 1;
    /// `random` and `srandom` of C.
    pub const RANDOM: u32 = 2;
    /// The start of the `drand48` family of C: its first state.
    pub const DRAND48: u32 = 3;
    /// What takes the place of the system's entropy: `getrandom`, `getentropy`, `arc4random`.
    pub const ENTROPY: u32 = 4;
    /// `robios-api`'s own generator for Rust programs.
    pub const RUST: u32 = 5;
}

/// The first argument of [`Support::failed`].
pub mod failure {
    /// `abort` was called.
    pub const ABORT: i32 = 1;
    /// An assertion failed.
    pub const ASSERTION: i32 = 2;
    /// A Rust program panicked.
    pub const PANIC: i32 = 3;
    /// The stack protector found the stack smashed.
    pub const STACK: i32 = 4;
    /// `main` of a Rust program returned an error.
    pub const ERROR: i32 = 5;
}

crate::table::function_table! {
    /// Services for the language of a program: console, random numbers, virtual time, the program's end.
    table SupportTable, trait Support, call SupportCall, number 0, version 1;

    family support "services for the program's language", source "our choice" {
        /// Writes to the console of the robot: stream 1 is standard output, 2 standard error.
        /// Whole lines, except what a program flushes or leaves at its end. Returns 0.
        fn console(stream: i32, bytes: Bytes) -> i32 = 0;

        /// The next 64 random bits of the robot's stream for a purpose.
        /// A function of the run's seed, the robot, the purpose, the last `seed` for it and how many bits were drawn
        /// since.
        fn random(purpose: u32) -> u64 = 0;

        /// Starts the robot's stream for a purpose anew, at a place that the seed chooses; robots differ. Returns 0.
        fn seed(purpose: u32, seed: u64) -> i32 = 0;

        /// The robot's virtual time in microseconds, 0 at its start.
        /// Costs virtual time like any call, at least 1 us, so that a loop that waits for a time ends.
        fn time_us() -> i64 = 0;

        /// Lets so much virtual time pass, in microseconds; no time for a negative span. Returns 0.
        fn sleep_us(span_us: i64) -> i32 = 0;

        /// The program has failed and will return from `run` next: kind of the failure and what to tell the user.
        /// For a failed assertion `file:line: function: text`. Returns 0.
        fn failed(kind: i32, text: Text) -> i32 = 0;

        /// The program's name without folder and extension, as its sources are called; not ended by 0.
        /// Returns its length in bytes, of which as many as fit are written.
        fn program_name(name: OutBytes) -> i32 = 0;
    }
}
