//! Runs of small scenes with C programs through the library.

use std::path::Path;
use std::process::Command;

use sim_core::time::Time;
use sim_host::executive::interrupt::Interrupt;
use sim_host::executive::scheduler::Ended;
use sim_host::launch::{Error, Observers, Options, Scene};
use tempfile::TempDir;

/// Drives in a circle and prints for ten seconds.
pub const DRIVE: &str = r#"
#include <stdio.h>
#include <stdlib.h>
#include "eyebot.h"
static int rounds;
int main(void) {
    VWHandle vw = VWInit(VW_DRIVE, 1);
    char *memory = malloc(1000);
    VWSetSpeed(vw, 0.1, 0.5);
    for (rounds = 0; rounds < 100; rounds++) {
        sprintf(memory, "%d %d", rounds, rand() % 100);
        printf("%s\n", memory);
        OSWait(10);
    }
    free(memory);
    return 0;
}
"#;

/// A scene in its own folder, with one robot for each of these programs.
pub fn scene(programs: &[&str]) -> TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let mut sim = "world room.wld\n".to_owned();
    for (index, program) in programs.iter().enumerate() {
        sim += &format!("robi bot.robi p{index}.c {} 500 0\n", 500 + 600 * index);
        std::fs::write(folder.path().join(format!("p{index}.c")), program).expect("a file");
    }
    let robi = "diameter 200\nspeed 600\nturn 300\nwheel 54 3600 1100 90\n\
                drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";
    let room = "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n";
    for (name, text) in [("room.wld", room), ("bot.robi", robi), ("scene.sim", &sim)] {
        std::fs::write(folder.path().join(name), text).expect("a file");
    }
    folder
}

/// Runs the scene in `folder` with its robots' programs on threads of this process until they end.
///
/// # Errors
/// If the scene cannot be run.
pub fn try_run(folder: &Path, interrupt: Interrupt) -> Result<Ended, Error> {
    let options = Options { default_until: Time::NEVER, ..Options::default() };
    let ready = Scene::open(folder.join("scene.sim"), options)?.load()?;
    let mut running = ready.start(Observers { interrupt, ..Observers::default() })?;
    running.scheduler.advance_to(Time::NEVER);
    Ok(running.finish().ended)
}

/// Like [`try_run`], for a scene that can be run.
pub fn run(folder: &Path) -> Ended {
    try_run(folder, Interrupt::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Returns false and prints a notice if there is no C compiler.
pub fn has_compiler() -> bool {
    let there = Command::new("cc").arg("--version").output().is_ok_and(|output| output.status.success());
    if !there {
        println!("skipped: `cc` is not installed");
    }
    there
}
