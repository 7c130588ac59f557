//! Tasks of Rust programs in the simulator: failing, killing, and the end of the program.

use serde_json::Value;
use tests::{Scratch, write_package};

const PROGRAM: &str = r#"use robios_api::prelude::*;
use robios_api::{Priority, TaskMode};

robios_api::program!(main);

struct LetGo(&'static str, Robot);
impl Drop for LetGo {
    fn drop(&mut self) {
        writeln!(self.1.console(), "{} let go", self.0);
    }
}

fn main(robot: &Robot) -> Result {
    let tasks = robot.multi_tasking(TaskMode::Preemptive)?;
    let value = tasks.shared(0)?;
    let _main = LetGo("main", robot.clone());
    match robot.arguments()[0].as_str() {
        "panic" => {
            tasks.spawn("doomed", Priority::P2, |robot| {
                let _task = LetGo("doomed", robot.clone());
                robot.sleep(1.seconds());
                panic!("out of cheese");
            })?.ready(robot)?;
        }
        "error" => tasks.spawn("poor", Priority::P2, |robot| robot.psd(PsdAt::Back).map(drop))?.ready(robot)?,
        "deadlock" => {
            let other = tasks.shared(0)?;
            for (name, first, second) in [("left", value.clone(), other.clone()), ("right", other, value)] {
                let take_both = move |robot: &Robot| -> Result {
                    let _first = first.lock(robot);
                    robot.tasks().reschedule()?;
                    let _second = second.lock(robot);
                    Ok(())
                };
                tasks.spawn(name, Priority::P4, take_both)?.ready(robot)?;
            }
            tasks.permit()?;
            return tasks.suspend_self();
        }
        "kill" => {
            let own = value.clone();
            let task = tasks.spawn("holder", Priority::P2, move |robot| -> Result {
                let _task = LetGo("holder", robot.clone());
                *own.lock(robot) = 7;
                let _held = own.lock(robot);
                robot.tasks().suspend_self()
            })?;
            task.ready(robot)?;
            tasks.permit()?;
            task.kill(robot)?;
            writeln!(robot.console(), "value {}", value.get(robot));
            assert!(task.ready(robot).is_err());
            return Ok(());
        }
        "leave" => {
            for name in ["one", "other"] {
                tasks.spawn(name, Priority::P3, move |robot| -> Result {
                    let _task = LetGo(name, robot.clone());
                    robot.tasks().suspend_self()
                })?.ready(robot)?;
            }
            tasks.spawn("unready", Priority::P3, |robot| writeln!(robot.console(), "never"))?;
            tasks.permit()?;
            return Ok(());
        }
        way => panic!("unknown way `{way}`"),
    }
    tasks.permit()?;
    tasks.sleep(100.seconds())
}
"#;

/// Number of the first line of the program's source that contains this text, counted from 1.
fn line_of(text: &str) -> usize {
    1 + PROGRAM.lines().position(|line| line.contains(text)).expect("a line of the program")
}

/// Writes a scene with a robot for each of `modes`. The program has its own folder, so it is built once.
fn write_modes(scratch: &Scratch, modes: &[&str]) {
    write_package(scratch, "ways", PROGRAM);
    let robot = |(index, mode): (usize, &&str)| {
        format!(
            "[[robot]]\ntype = \"%sim%/robis/feeler.robi\"\nprogram = \"ways\"\narguments = [\"{mode}\"]\nx_mm = {}\ny_mm = 500\n",
            500 + 500 * index
        )
    };
    let robots: String = modes.iter().enumerate().map(robot).collect();
    let world = "[scene]\nuntil_s = 10\n[world]\nfile = \"%sim%/worlds/empty.wld\"\n";
    scratch.write("ways.scene.toml", &format!("{world}{robots}"));
}

/// Runs the scene; returns each robot's report and output, and the digest.
fn run(scratch: &Scratch, args: &[&str]) -> (Vec<(Value, Vec<String>)>, Value) {
    let mut all = vec!["run", "ways.scene.toml", "--report", "r.json", "--trace", "t.jsonl"];
    all.extend(args);
    let ran = scratch.eyesim(&all);
    assert!(ran.code == Some(0) || ran.code == Some(1), "{ran:#?}");
    let report: Value = serde_json::from_str(&scratch.read("r.json")).expect("a report is JSON");
    let trace = scratch.trace("t.jsonl");
    let lines = |robot: usize| {
        let lines = trace.iter().filter(|line| line["event"] == "stdout" && line["robot"] == robot);
        lines.map(|line| line["text"].as_str().expect("a text").to_owned()).collect()
    };
    let robots = report["robots"].as_array().expect("a report has robots");
    let robots = robots.iter().enumerate().map(|(index, robot)| (robot.clone(), lines(index + 1))).collect();
    (robots, report["digest"].clone())
}

fn reason(robot: &Value) -> &str {
    robot["reason"].as_str().unwrap_or_else(|| panic!("a reason: {robot:#}"))
}

#[test]
fn tasks_fail_and_end_as_documented() {
    let modes = ["panic", "error", "deadlock", "kill", "leave"];
    let scratch = Scratch::new();
    write_modes(&scratch, &modes);
    let (robots, digest) = run(&scratch, &[]);
    let [(panicked, panicked_lines), (error, _), (deadlock, _), (kill, kill_lines), (leave, leave_lines)] = &robots[..]
    else {
        panic!("five robots")
    };

    let location = format!("src/lib.rs:{}:", line_of("out of cheese"));
    assert!(reason(panicked).starts_with("task `doomed`: panicked: "), "{panicked:#}");
    assert!(reason(panicked).contains(&location) && reason(panicked).ends_with("out of cheese"), "{panicked:#}");
    assert_eq!(panicked_lines, &["doomed let go", "main let go"]);
    assert!(reason(error).contains("no PSD sensor `PsdAt::Back`"), "{error:#}");
    for expected in ["deadlock", "left", "right", "semaphore 1", "semaphore 2"] {
        assert!(reason(deadlock).contains(expected), "`{expected}`: {deadlock:#}");
    }
    assert_eq!(kill["outcome"], "finished", "{kill:#}");
    assert_eq!(kill_lines, &["holder let go", "value 7", "main let go"]);
    assert_eq!(leave["outcome"], "finished", "{leave:#}");
    assert_eq!(leave_lines, &["main let go", "one let go", "other let go"]);

    for args in [["--threads", "1"], ["--threads", "2"], ["--exec", "process"]] {
        assert_eq!(run(&scratch, &args).1, digest, "{args:?}");
    }
}
