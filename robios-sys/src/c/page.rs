//! Documentation page of the interposed functions of the C library.

use std::fmt::Write as _;

use super::{INTERPOSED, OUTSIDE_GUARANTEE};

const BEGIN: &str = "\
# The C library inside a robot program

Robots on fibers and threads run in one process, so they share one C library: one state of `rand`, one `exit`, one
standard output, one real-time clock. The guarantee of `eyesim` is that a program's calls neither affect other robots
nor depend on real time. Every C and C++ program that `eyesim` builds is therefore linked with a shim
(`robios-sys/shim`). The shim interposes functions of the C library with weak symbols inside the program's own library.
This library is linked with `-Bsymbolic`, so the program's references resolve to the shim. If the program itself defines
a function with the name of a library function, such as `time`, `y1`, `send` or `index`, this function takes precedence
over the shim and the C library in every source file of the program.

Calls that the compiler substitutes (`puts` or `putchar` for `printf`, the checked forms of `_FORTIFY_SOURCE`,
`getc(stdin)` for `getchar`) resolve to the shim too, at every optimisation level. Functions that are in no C standard
(`y1`, `index`, `gamma`, ...) are compiled with `-fno-builtin-NAME`; otherwise a compiler would evaluate a call with
constant arguments with its built-in function, even if the program defines a function with this name.

This page applies to Linux with glibc and to the compilers gcc and clang.

## Behaviour

- **Program exit.** `exit` and the return from `main` run the exit handlers that `atexit`, `on_exit` and C++ have
  registered, in reverse order. Exit handlers may call RoBIOS. `_exit`, `_Exit`, `quick_exit`, `abort` and a failed
  assertion run no exit handlers. A program that the simulator stops runs no exit handlers either, because its calls are
  cancelled; the destructors of a stopped C++ program do run, see [programs](programs.md).
- **Exit codes** are the numbers that the program passes, not truncated to 8 bits. `void main()` gives 0. After `abort`, a
  failed assertion or a detected buffer overflow the exit code is 134, as in a shell, and the robot counts as failed.
- **Random numbers.** `rand`, `random` and the system's entropy are per-robot streams, derived from the run's seed, the
  robot and the function. `srand(s)` restarts the stream at a position given by `s`: the same `s` gives the same numbers
  again, but each robot has different numbers. The robots of a swarm whose programs all call `srand(1)` therefore behave
  differently. Without `srand` robots differ as well. The `drand48` family is the generator specified bit-exactly by
  POSIX; `srand48` gives its sequence, and only the unseeded start differs between robots. `rand_r` and `random_r` work
  on the state that the program passes and are not interposed.
- **Time.** Virtual time 0 is 1 January 2000, 0:00 UTC; clocks without a date start at 0. CPU time is virtual time.
  Local time is UTC everywhere. A call that returns the time costs virtual time (at least 1 us), so a loop that waits
  for a time ends.
- **Memory.** Each block from `malloc`, `calloc` or `realloc` is followed by a guard zone of at least 32 bytes. A write
  into the guard zone does no damage; when `free` or `realloc` frees the block, the write is reported with the line of
  that call. A write past the guard zone of the newest block ends the program as failed at its next output or
  allocation; the message has the line that allocated the block.
- **Output** goes to the robot's console a line at a time, with the virtual time at which the line ended; an incomplete
  last line is shown at the end, also after a crash. Lines longer than 1024 bytes are truncated. `stdout` and `stderr`
  are streams of the program's own library, so that everything printed to them is captured; `setvbuf`, `fflush` and
  `fprintf` work on them.
- **Input** is the text of `--stdin`; each robot reads its own copy, a line at a time. Without `--stdin` reads return EOF.
  A prompt without a newline is flushed before a read.
- **C++.** libstdc++ is linked into each program, so that its streams, clocks and random numbers resolve to the
  functions of the shim. `std::random_device` draws from the robot's own stream.
- **Headers** beside a program may have any names: calls of interposed functions that they declare are linked to the
  shim all the same. The shim is compiled with eyesim's own headers only.
- **Alarms** are refused, since they would arrive by signal, in real time.

## Interposed functions

| functions | effect |
|---|---|
";

const MIDDLE: &str = "
## Outside of the guarantee

The functions of this table are not interposed. They may behave differently between runs, affect other robots, or end
the simulator. If a prebuilt library imports a function of this table or of the table above, the simulator prints a
warning that names the function.

| functions | reason |
|---|---|
";

const END: &str = "
Files are real files. The guarantee does not cover robots that write the same file, nor programs that read data which
changes between runs.

Heap corruption that glibc detects (`free(): invalid pointer`) raises a signal and is reported as a crash.
";

/// The text of `docs/c-library.md`.
pub fn c_library_page() -> String {
    [BEGIN, &rows(INTERPOSED), MIDDLE, &rows(OUTSIDE_GUARANTEE), END].concat()
}

/// Table rows, one for each reason, in the order of the reasons' first symbols.
fn rows(symbols: &[(&str, &str)]) -> String {
    let mut reasons: Vec<&str> = Vec::new();
    for (_, reason) in symbols {
        if !reasons.contains(reason) {
            reasons.push(reason);
        }
    }
    let mut text = String::new();
    for reason in reasons {
        let names: Vec<_> = symbols
            .iter()
            .filter(|(_, symbol_reason)| *symbol_reason == reason)
            .map(|(name, _)| format!("`{name}`"))
            .collect();
        writeln!(text, "| {} | {reason} |", names.join(", ")).expect("a string takes every line");
    }
    text
}
