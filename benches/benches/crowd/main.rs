//! Complete runs of the real binary: crowds of robots that avoid each other, crowds among cans, robots that wait or
//! send messages, and a swarm beside other simulators.
//!
//! A custom harness: criterion would run each scene a hundred times and does not measure memory.
#![forbid(unsafe_code)]

mod peers;
mod run;

use tests::{Scratch, write_crowd};

use run::{Run, run_with};

/// The program of the crowds: reads eight PSDs, sets its speed, and waits for the next multiple of 50 ms.
const AVOID: &str = "%sim%/example-programs/avoid";
/// Number of repetitions of each run. The fastest counts, since other load on the machine can only slow a run down.
const REPEATS: usize = 3;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let is_smoke_test = arguments.iter().any(|argument| argument == "--test");
    let filter = arguments.iter().find(|argument| !argument.starts_with('-'));
    let is_wanted = |name: &str| filter.is_none_or(|filter| name.contains(filter.as_str()));

    let mut alone = None;
    for (robots, seconds) in [(1, 6000.0), (10, 600.0), (100, 60.0), (1000, 20.0)] {
        let name = format!("crowd/{robots}");
        if is_wanted(&name) {
            let seconds = if is_smoke_test { 0.5 } else { seconds };
            let repeats = if is_smoke_test { 1 } else { REPEATS };
            crowd(&name, robots, seconds, repeats, &mut alone);
        }
    }
    if is_wanted("crowd/cans") {
        cans(is_smoke_test);
    }
    if is_wanted("crowd/waiting") {
        waiting(is_smoke_test);
    }
    if is_wanted("crowd/radio") {
        radio(is_smoke_test);
    }
    if is_wanted("crowd/swarm") {
        swarm(is_smoke_test);
    }
    if is_wanted("crowd/peers") {
        peers::compare(is_smoke_test);
    }
}

fn crowd(name: &str, robots: usize, seconds: f64, repeats: usize, alone: &mut Option<u64>) {
    let scratch = Scratch::new();
    write_crowd(&scratch, robots, AVOID);
    let best = fastest(&scratch, seconds, repeats);
    if repeats == 1 {
        println!("{name:<14} runs");
        return;
    }
    let steps = best.simulated / 0.05 * robots as f64;
    let times = best.simulated / best.real;
    let mut line = format!("{name:<14} {:>9.0} robot-steps/s {times:>9.1} times real time", steps / best.real);
    if let Some(peak) = best.peak {
        line += &format!(" {:>7.1} MiB at most", peak as f64 / 1024.0);
        match *alone {
            None if robots == 1 => *alone = Some(peak),
            Some(alone) if robots > 1 => {
                let each = peak.saturating_sub(alone) as f64 / (robots - 1) as f64;
                line += &format!(", {each:.0} KiB for each further robot, its program included");
            }
            _ => {}
        }
    }
    println!("{line}");
}

/// A hundred robots, and the same robots among as many cans, which they push: the cost of movable objects.
fn cans(is_smoke_test: bool) {
    const ROBOTS: usize = 100;
    let scratch = Scratch::new();
    let (seconds, repeats) = if is_smoke_test { (0.5, 1) } else { (60.0, REPEATS) };
    write_crowd(&scratch, ROBOTS, AVOID);
    let without = fastest(&scratch, seconds, repeats);
    let mut sim = scratch.read("crowd.sim");
    let side = ROBOTS.isqrt();
    for can in 0..ROBOTS {
        // Each can is half a metre away from the robot of its cell.
        let (x, y) = (1000 * (can % side) + 850, 1000 * (can / side) + 850);
        sim += &format!("can {x} {y} 0\n");
    }
    scratch.write("crowd.sim", &sim);
    let with = fastest(&scratch, seconds, repeats);
    if is_smoke_test {
        println!("crowd/cans     runs");
        return;
    }
    let times = |run: Run| run.simulated / run.real;
    println!("crowd/cans     {:>9.1} times real time, {:.1} without the cans", times(with), times(without));
}

/// A robot that drives among waiting robots, and without them: the cost of a waiting robot per slot.
fn waiting(is_smoke_test: bool) {
    const WAITING: usize = 1000;
    let scratch = Scratch::new();
    let seconds = if is_smoke_test { 0.5 } else { 600.0 };
    scratch.write("wait.c", "#include \"eyebot.h\"\nint main(void) { OSWait(1000000); KEYGet(); return 0; }\n");
    scratch.write("drive.c", "#include \"eyebot.h\"\nint main(void) { for (;;) OSWait(5); }\n");
    let of = |waiting: usize| {
        write_crowd(&scratch, waiting + 1, "wait.c");
        let sim = scratch.read("crowd.sim").replacen("wait.c", "drive.c", 1);
        scratch.write("crowd.sim", &sim);
        fastest(&scratch, seconds, if is_smoke_test { 1 } else { REPEATS })
    };
    let (few, many) = (of(1), of(WAITING));
    if is_smoke_test {
        println!("crowd/waiting  runs");
        return;
    }
    let slots = many.simulated / 0.05;
    let each = (many.real - few.real) / slots / (WAITING - 1) as f64;
    println!("crowd/waiting  {:>9.1} ns a slot for a robot that waits", each * 1e9);
}

/// A hundred robots that send eight bytes to all others in each slot, and the same number of calls without a radio.
fn radio(is_smoke_test: bool) {
    const ROBOTS: usize = 100;
    let scratch = Scratch::new();
    let (seconds, repeats) = if is_smoke_test { (0.5, 1) } else { (20.0, REPEATS) };
    // Each slot has 1 RADIOSend, 99 RADIOReceive of 100 us and 100 RADIOCheck of 5 us, then the wait for the next slot.
    scratch.write(
        "talk.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n    char text[16];\n    int id;\n    RADIOInit();\n    for (;;) {\n        \
         RADIOSend(0, \"position\");\n        while (RADIOCheck() > 0) RADIOReceive(&id, text, sizeof text);\n        \
         OSWait(50 - OSGetCount() % 50);\n    }\n}\n",
    );
    scratch.write(
        "mute.c",
        "#include \"eyebot.h\"\nint main(void)\n{\n    int i, n = 0;\n    for (;;) {\n        \
         for (i = 0; i < 200; i++) n += OSMachineID();\n        OSWait(50 - OSGetCount() % 50);\n    }\n}\n",
    );
    let of = |program: &str| {
        write_crowd(&scratch, ROBOTS, program);
        fastest(&scratch, seconds, repeats)
    };
    let (talk, mute) = (of("talk.c"), of("mute.c"));
    if is_smoke_test {
        println!("crowd/radio    runs");
        return;
    }
    let messages = talk.simulated / 0.05 * (ROBOTS * (ROBOTS - 1)) as f64;
    println!(
        "crowd/radio    {:>9.0} messages/s heard {:>9.1} times real time, {:.1} without the radio",
        messages / talk.real,
        talk.simulated / talk.real,
        mute.simulated / mute.real
    );
}

/// The swarm in each kind of flow with one worker and two: thousands of robot-steps per second, and memory.
fn swarm(is_smoke_test: bool) {
    /// Numbers of robots, and simulated seconds of the run.
    const SIZES: [(usize, f64); 5] = [(1, 20_000.0), (10, 2_000.0), (100, 200.0), (1_000, 20.0), (10_000, 4.0)];
    /// Kinds of flow, numbers of workers, and maximum swarm size of each combination.
    const WAYS: [(&str, &str, usize); 5] = [
        ("fiber", "1", usize::MAX),
        ("fiber", "2", usize::MAX),
        ("thread", "1", 1_000),
        ("thread", "2", 1_000),
        ("process", "2", 100),
    ];
    let scratch = Scratch::new();
    if !is_smoke_test {
        println!(
            "| robots | flows | workers | 1,000 robot-steps/s | times real time | MiB |\n|---|---|---|---|---|---|"
        );
    }
    for (robots, seconds) in if is_smoke_test { &SIZES[1..2] } else { &SIZES[..] } {
        benches::swarm::write(*robots, scratch.path()).expect("the scene can be written");
        for (exec, workers, max_robots) in WAYS {
            if *robots > max_robots {
                continue;
            }
            let options = ["swarm.sim", "--exec", exec, "--threads", workers];
            if is_smoke_test {
                run_with(&scratch, &options, 0.5);
                continue;
            }
            let seconds = if exec == "process" { seconds / 10.0 } else { *seconds };
            let runs = (0..REPEATS).map(|_| run_with(&scratch, &options, seconds));
            let best = runs.min_by(|a, b| a.real.total_cmp(&b.real)).expect("at least one run");
            let steps = best.simulated / 0.05 * *robots as f64 / best.real / 1e3;
            let (times, peak) = (best.simulated / best.real, best.peak.unwrap_or(0) as f64 / 1024.0);
            println!("| {robots} | {exec} | {workers} | {steps:.0} | {times:.1} | {peak:.0} |");
        }
    }
    if is_smoke_test {
        println!("crowd/swarm    runs");
    }
}

fn fastest(scratch: &Scratch, seconds: f64, repeats: usize) -> Run {
    let runs = (0..repeats).map(|_| run_with(scratch, &["crowd.sim"], seconds));
    runs.min_by(|a, b| a.real.total_cmp(&b.real)).expect("at least one run")
}
