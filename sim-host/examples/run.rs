//! Runs a scene with its robots' programs through the library: in one call to its end, or step by step with a check
//! every second.
//!
//! `cargo run --release -p sim-host --example run -- sims/demo.sim`

use std::path::PathBuf;

use sim_core::RobotId;
use sim_core::time::Time;
use sim_host::executive::scheduler::Progress;
use sim_host::launch::{Error, Observers, Options, Scene};

fn main() -> Result<(), Error> {
    let path = std::env::args_os().nth(1).map_or_else(|| PathBuf::from("sims/demo.sim"), PathBuf::from);
    let until = Some(Time::from_millis(10_000));

    // To the end in one call.
    let options = Options { seed: Some(7), until, ..Options::default() };
    let finished = Scene::open(&path, options.clone())?.load()?.run()?;
    for robot in &finished.report.robots {
        println!("robot {} (`{}`): {:?}, {:.3} m", robot.id, robot.program, robot.outcome, robot.path_m);
    }

    // In steps: between two steps no program runs, and reading the state changes nothing.
    let mut running = Scene::open(&path, options)?.load()?.start(Observers::default())?;
    for second in 1..=10 {
        let time = Time::from_millis(1_000 * second);
        if running.scheduler.advance_to(time) == Progress::Over {
            break;
        }
        let position = running.scheduler.run().world().robot_pose(RobotId(1), time).position;
        println!("after {time}: robot 1 is at {:.3} m, {:.3} m", position.x, position.y);
    }
    let stepped = running.finish();
    assert_eq!(stepped.report.digest, finished.report.digest, "the same run");
    println!("digest {}", finished.report.digest);
    Ok(())
}
