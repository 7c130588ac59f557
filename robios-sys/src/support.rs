//! Services of the host, independent of the RoBIOS generation: console, random numbers, virtual time, tasks and the end
//! of the program for its language runtime, and layers that the program shows in the window.

use crate::param::{Bytes, Callback, OutBytes, Text};

/// The first argument of [`Support::console`].
pub mod stream {
    /// Standard output.
    pub const OUT: i32 = 1;
    /// Standard error.
    pub const ERR: i32 = 2;
}

/// The first argument of [`Support::random`] and [`Support::seed`]: each purpose has its own stream of numbers.
pub mod purpose {
    /// C's `rand` and `srand`.
    pub const RAND: u32 = 1;
    /// `random` and `srandom` of C.
    pub const RANDOM: u32 = 2;
    /// The initial state of C's `drand48` family.
    pub const DRAND48: u32 = 3;
    /// Replacement of the system's entropy: `getrandom`, `getentropy`, `arc4random`.
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
    /// The stack protector detected a smashed stack.
    pub const STACK: i32 = 4;
    /// `main` of a Rust program returned an error.
    pub const ERROR: i32 = 5;
    /// A C++ program threw an exception that it does not catch.
    pub const EXCEPTION: i32 = 6;
    /// A C program reserved less space on its stack for an image than the image takes.
    pub const IMAGE: i32 = 7;
    /// A C program corrupted the heap: it wrote beyond the end of a block, or freed a pointer that is not a block.
    pub const HEAP: i32 = 8;
}

/// Reason for a task's wait, the second argument of [`Support::task_wait`].
pub mod wait {
    /// A mutex or spin lock.
    pub const MUTEX: i32 = 1;
    /// A condition variable.
    pub const CONDITION: i32 = 2;
    /// A semaphore.
    pub const SEMAPHORE: i32 = 3;
    /// A read-write lock.
    pub const RWLOCK: i32 = 4;
    /// A barrier.
    pub const BARRIER: i32 = 5;
    /// The end of an initialisation by another task.
    pub const ONCE: i32 = 6;
    /// A stream of the C library that another task has locked.
    pub const STREAM: i32 = 7;
    /// The end of a task.
    pub const END: i32 = 8;
    /// The end of all other tasks.
    pub const ENDS: i32 = 9;
}

/// Frames, cell values and limits of [`Support::show_grid`], [`Support::show_points`] and [`Support::show_line`].
pub mod layer {
    /// The frame of the world.
    pub const WORLD: i32 = 0;
    /// The frame of the robot's odometry. It is fixed in the world at the robot's start, and again whenever the program
    /// sets the odometry.
    pub const ODOMETRY: i32 = 1;
    /// Cell that is certainly occupied; 0 is certainly free. Source: `nav_msgs/OccupancyGrid` of ROS.
    pub const OCCUPIED: u8 = 100;
    /// Unknown cell.
    pub const UNKNOWN: u8 = 255;
    /// Maximum number of cells of a grid.
    pub const MAX_CELLS: usize = 1 << 20;
    /// Maximum number of points of a layer.
    pub const MAX_POINTS: usize = 1 << 16;
    /// Maximum length of a layer's name, in bytes.
    pub const MAX_NAME: usize = 32;
    /// Maximum number of layers of a robot.
    pub const MAX_LAYERS: usize = 16;
    /// Maximum distance of a point from the origin of its frame along each axis, m.
    pub const MAX_COORDINATE: f64 = 1e6;
}

crate::table::function_table! {
    /// Services for the language of a program: console, random numbers, virtual time, the program's end.
    table SupportTable, trait Support, call SupportCall, number 0, version 1;

    family support "services for the program's language", source "our choice" {
        /// Writes to the console of the robot: stream 1 is standard output, 2 standard error.
        /// Output comes in whole lines, except text that a program flushes or leaves at its end. Returns 0.
        fn console(stream: i32, bytes: Bytes) -> i32 = 0;

        /// The next 64 random bits of the robot's stream for a purpose.
        /// Depends only on the run's seed, the robot, the purpose, the last `seed` for it and the number of bits drawn
        /// since.
        fn random(purpose: u32) -> u64 = 0;

        /// Restarts the robot's stream for a purpose at a position derived from the seed; other robots get other
        /// numbers. Returns 0.
        fn seed(purpose: u32, seed: u64) -> i32 = 0;

        /// The robot's virtual time in microseconds, 0 at its start.
        /// Costs virtual time like any call, at least 1 us, so that a loop that waits for a time ends.
        fn time_us() -> i64 = 0;

        /// Lets virtual time pass, in microseconds; none for a negative span. Returns 0.
        fn sleep_us(span_us: i64) -> i32 = 0;

        /// Reports that the program has failed and will return from `run` next: kind of the failure and message for the
        /// user. The message of a failed assertion is `file:line: function: text`. `stack` has return addresses of the
        /// calls in progress, the innermost first, each of the size of a pointer; it is empty if they are not known.
        /// Returns 0.
        fn failed(kind: i32, text: Text, stack: Bytes) -> i32 = 0;

        /// Name of the program's sources without folder and extension, not terminated by 0.
        /// Returns its length in bytes; as many bytes as fit are written.
        fn program_name(name: OutBytes) -> i32 = 0;

        /// Number of the calling task: 1 for that of `main`, then in the order of their starts.
        /// Costs virtual time like any call, so that the operations between tasks that begin with it cost time too.
        fn task_self() -> i32 = 1;

        /// Starts a task of the robot at the end of its run queue: when first scheduled it calls `code`, once, in a
        /// flow of its own. Tasks switch at the first call that ends at or after a tick of 10 ms, and when the running
        /// task waits. Only one runs at a time. When `code` returns STOP, the whole program ends. No time passes.
        /// Returns the task's number, 0 when the robot has too many tasks.
        fn task_spawn(code: Callback) -> i32 = 0;

        /// Appends the calling task to the queue `key`; other tasks run until it is woken there or the virtual time
        /// `deadline_us` is reached. `kind` (see `wait`) and `holder`, the task that has the awaited resource or 0 if
        /// there is none, are for messages. No other time passes. Returns 1 if the task was woken, 0 at the deadline.
        /// The status is STOP also when `task_interrupt` has ended this wait or any other: then later calls of the
        /// program still work.
        fn task_wait(key: u64, kind: i32, holder: i32, deadline_us: i64) -> i32 = 0;

        /// Wakes the task that has waited longest in the queue `key`. The caller runs on, no time passes.
        /// Returns the number of the task, 0 if there is none.
        fn task_wake(key: u64) -> i32 = 0;

        /// Wakes all tasks in the queue `key`. The caller runs on, no time passes. Returns their count.
        fn task_wake_all(key: u64) -> i32 = 0;

        /// Interrupts a task that waits for time, the world, a condition, a semaphore or the end of a task.
        /// No time passes. Returns 1, or 0 if the task is in no such wait.
        fn task_interrupt(task: i32) -> i32 = 0;

        /// Lets the other tasks that are ready run first. Costs virtual time like any call. Returns 0.
        fn task_yield() -> i32 = 0;

        /// Lets the other tasks that are ready run first if a tick has passed since the calling task was resumed. No
        /// time passes. Used by the shim after a section in which tasks must not switch. Returns 0.
        fn task_turn() -> i32 = 0;

        /// Reads from standard input: the rest of the current line with its end, at most as many bytes as fit.
        /// Waits for a line while the input is interactive. Returns the number of bytes, 0 at the end of the input.
        fn input(bytes: OutBytes) -> i32 = 0;

        /// Records that the program could not open the file of this name, with the system's error number, so that a
        /// later crash by the null pointer can be explained. No time passes. Returns 0.
        fn open_failed(name: Text, error: i32) -> i32 = 0;

        /// Reports a likely mistake in the program as a hint, once for each call site. No time passes. Returns 0.
        fn hint(text: Text) -> i32 = 0;

        /// Like `open_failed`, for a failure that the program does not see, such as that of a `std::ifstream`: it is
        /// reported immediately. `stack` is as for `failed`. No time passes. Returns 0.
        fn open_failed_at(name: Text, error: i32, stack: Bytes) -> i32 = 0;

        /// Like `console`, for the text after the last line end of a program that crashes. No time passes. Returns 0.
        fn unfinished(stream: i32, bytes: Bytes) -> i32 = 0;

        /// Reports where the program has just read at the end of its standard input, if the call site is not in its own
        /// code, as with `std::cin`. `stack` is as for `failed`. No time passes. Returns 0.
        fn read_at_end(stack: Bytes) -> i32 = 0;

        /// Shows a grid as the robot's layer of this name, in place of an earlier one: in the window, below the robots,
        /// and in a recording. `frame` is one of `layer`. The grid's corner with the smallest coordinates is at (`x_m`,
        /// `y_m`), its cells are squares of `cell_m`. `cells` has a byte for each, row by row from the smallest y, each
        /// row from the smallest x: 0 (free) to 100 (occupied), or 255 (unknown). The simulation is not affected, and
        /// no time passes. Returns 0; 1, with a hint, if an argument is beyond the limits of `layer` or NaN.
        fn show_grid(name: Text, frame: i32, x_m: f64, y_m: f64, cell_m: f64, columns: i32, rows: i32, cells: Bytes) -> i32 = 1;

        /// Like `show_grid`, for points: `coordinates` has `count` times `dimensions` numbers of type f64, in m: x and
        /// y, or x, y and z, of each point. Without points the layer is empty.
        fn show_points(name: Text, frame: i32, dimensions: i32, count: i32, coordinates: Bytes) -> i32 = 1;

        /// Like `show_points`, for a line through the points, such as a path or a profile of the ground.
        fn show_line(name: Text, frame: i32, dimensions: i32, count: i32, coordinates: Bytes) -> i32 = 1;

        /// Number of points of the robot's laser scanner, as `LIDARSet` has set it. No time passes. Returns the number, 0
        /// if there is no scanner.
        fn lidar_points() -> i32 = 0;
    }
}
