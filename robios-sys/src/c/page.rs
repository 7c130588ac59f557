//! Documentation page of the interposed functions of the C library.

use std::fmt::Write as _;

use super::{INTERPOSED, OUTSIDE_GUARANTEE};

const BEGIN: &str = "\
# The C library inside a robot program

All robots run in one process, so they share one C library: one state of `rand`, one `exit`, one standard output, one
real-time clock. A program's calls must not affect other robots or depend on real time. So every C
program that `eyesim` builds is linked with a shim (`robios-sys/shim`) that interposes these functions, inside the
program's own library, as weak symbols. The library is linked with `-Bsymbolic`: the program's references end in the
shim, and a function of the program's own called `time`, `y1`, `send` or `index` wins over both, in all of its files.

The compiler's own replacements (`printf` by `puts` or `putchar`, the checked forms of `_FORTIFY_SOURCE`, `getchar` by
`getc(stdin)`) end in the shim too, at every level of optimisation. Functions that no C standard has (`y1`, `index`,
`gamma`, ...) are compiled with `-fno-builtin-NAME`, since a compiler would compute a call with constant arguments by
its own function of that name and not by the program's.

All this is for Linux with glibc and for the compilers gcc and clang.

## Decisions

- **The end.** `exit`, and returning from `main`, call what `atexit`, `on_exit` and C++ have registered, the last first,
  inside the robot: these functions may call RoBIOS. `_exit`, `_Exit`, `quick_exit`, `abort` and a failed assertion do
  not, and neither does a program that the simulator stops, since its calls are cancelled. The destructors of a stopped
  C++ program run, see [programs](programs.md).
- **Exit codes** are the numbers that the program gives, not cut to 8 bits. `void main()` gives 0. After `abort`, a failed
  assertion or an overrun buffer it is 134, as in a shell, and the robot counts as failed.
- **Random numbers.** `rand`, `random` and the system's entropy are streams of the robot's own, which follow from the
  run's seed, the robot and the function. `srand(s)` restarts the stream at a position given by `s`: the same `s`
  gives the same numbers again, but different ones for each robot, so that the robots of a swarm whose programs all call
  `srand(1)` behave differently. Without `srand` robots differ as well. The `drand48` family is the generator that POSIX fixes to the
  bit; `srand48` gives its sequence, and only the unseeded start is the robot's own. `rand_r` and `random_r` work on the
  state that they are given and need no replacement.
- **Time.** Virtual time 0 is 1 January 2000, 0:00 UTC; clocks without a date start at 0. CPU time is virtual
  time. Local time is UTC everywhere. Asking for the time costs virtual time (at least 1 us), so that a loop that waits
  for a time ends.
- **Memory** of `malloc`, `calloc` and `realloc` has 32 bytes or more behind its end that the program does not own: what is written there harms
  nothing, and is told with the line at which the block is given back to `free` or `realloc`. A program that writes beyond them, too, behind the
  block that it has got last, is ended as failed at its next output or call for memory, with the line that has got the block.
- **Output** goes to the robot's console a line at a time, with the virtual time at which the line ended; an incomplete
  last line is shown at the end, also when the program breaks. Lines above 1024 bytes are cut. `stdout` and `stderr` are streams of the library's own, so that
  everything that prints to them is caught; `setvbuf`, `fflush` and `fprintf` work on them.
- **Input** is the text of `--stdin`, of which each robot has a copy, a line at a time; without it, input is at its end. Text printed
  without an end of line, such as a question, is shown before a read.
- **C++.** The library of C++ is linked into each program, so that its streams, clocks and random numbers end in these
  functions. `std::random_device` draws from the robot's own stream.
- **Headers** beside a program, whatever they are called, change none of this: their declarations are linked to the
  functions below. The shim is compiled with eyesim's own headers alone.
- **Alarms** are refused: they would arrive by signal, in real time.

## Replaced

| functions | what they do |
|---|---|
";

const MIDDLE: &str = "
## Outside of the guarantee

Not interposed: these functions may behave differently between runs, affect other robots, or end the simulator. A library
built elsewhere that imports one of them, or one of the functions above, gets a warning that names it.

| functions | why |
|---|---|
";

const END: &str = "
Files are real files: two robots that write one file, and programs that read what changes between runs, are outside as
well.

What the C library itself finds broken (`free(): invalid pointer`) ends in a signal and is reported as a fault.
";

/// The text of `docs/c-library.md`.
pub fn c_library_page() -> String {
    [BEGIN, &rows(INTERPOSED), MIDDLE, &rows(OUTSIDE_GUARANTEE), END].concat()
}

/// One row for each reason, in the order of their first symbols.
fn rows(symbols: &[(&str, &str)]) -> String {
    let mut reasons: Vec<&str> = Vec::new();
    for (_, reason) in symbols {
        if !reasons.contains(reason) {
            reasons.push(reason);
        }
    }
    let mut text = String::new();
    for reason in reasons {
        let names: Vec<_> =
            symbols.iter().filter(|(_, other)| *other == reason).map(|(name, _)| format!("`{name}`")).collect();
        writeln!(text, "| {} | {reason} |", names.join(", ")).expect("a string takes every line");
    }
    text
}
