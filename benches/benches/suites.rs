//! Cases of suites per second: `eyesim test` runs one robot with a compiled C program for 10 s, with many cases in a
//! process and with a process for each case.
//!
//! The bench measures processor time instead of real time, so other load on the machine has little effect.

use tests::Scratch;

const SCENE: &str = r#"[world]
floor_mm = [3000, 2000]
wall = [{ from_mm = [0, 0], to_mm = [3000, 0] }, { from_mm = [0, 2000], to_mm = [3000, 2000] }]

[[robot]]
type = "S4"
program = "square.c"
x_mm = 500
y_mm = 500
"#;

const PROGRAM: &str = r#"#include "eyebot.h"
int main() {
    for (;;) {
        VWStraight(1000, 400);
        VWWait();
        VWTurn(90, 90);
        VWWait();
    }
}
"#;

/// Processor time of all ended children of this process, s.
fn of_children() -> f64 {
    /// Clock ticks per second in /proc, the same on every Linux architecture.
    const TICKS: f64 = 100.0;
    let stat = std::fs::read_to_string("/proc/self/stat").expect("Linux");
    // User and kernel time of children are words 14 and 15 after the name in parentheses.
    let fields: Vec<&str> = stat.rsplit_once(')').expect("a name").1.split_whitespace().collect();
    fields[13..15].iter().map(|ticks| ticks.parse::<f64>().expect("a number") / TICKS).sum()
}

fn main() {
    let args: Vec<String> = std::env::args().collect();
    let is_smoke_test = args.iter().any(|arg| arg == "--test");
    let wanted = args.iter().skip(1).find(|arg| !arg.starts_with('-'));
    for (name, cases, option) in [("suites/shared", 2000, "--quiet"), ("suites/isolated", 500, "--isolate")] {
        if wanted.is_some_and(|wanted| !name.contains(wanted.as_str())) {
            continue;
        }
        let cases = if is_smoke_test { 4 } else { cases };
        let scratch = Scratch::new();
        scratch.write("room.scene.toml", SCENE);
        scratch.write("square.c", PROGRAM);
        let suite = |seeds: u32| {
            format!(
                "[suite]\nscene = \"room.scene.toml\"\nuntil_s = 10\n[matrix]\nseed = \"1..{seeds}\"\n\
                     [[check]]\nkind = \"contacts\"\n"
            )
        };
        let run = |seeds: u32| {
            scratch.write("a.suite.toml", &suite(seeds));
            let before = of_children();
            let ran = scratch.eyesim(&["test", "a.suite.toml", option]);
            assert!(ran.code == Some(0) && ran.stdout.contains(&format!("{seeds} passed")), "{ran:#?}");
            of_children() - before
        };
        // The first run compiles the program.
        run(1);
        let each = run(cases) / f64::from(cases);
        if !is_smoke_test {
            println!(
                "{name}: {:.2} ms of processor time for each of {cases} runs, {:.0} runs/s on two cores",
                1e3 * each,
                2.0 / each
            );
        }
    }
}
