//! Concurrent runs with native programs in one process do not interfere.

mod common;

use std::thread;
use std::time::Duration;

use common::{DRIVE, has_compiler, run, scene, try_run};
use sim_core::record::Outcome;
use sim_host::executive::damage::lost_flows;
use sim_host::executive::dispatcher::EndReason;
use sim_host::executive::interrupt::Interrupt;

/// Faults in its own code while the other robots of the process run.
const CRASH: &str = r#"
#include "eyebot.h"
int main(void) {
    OSWait(50);
    *(volatile int *)8 = 1;
    return 0;
}
"#;

/// Runs until the run ends.
const ENDLESS: &str = r#"
#include "eyebot.h"
int main(void) { for (;;) OSWait(1); }
"#;

#[test]
fn concurrent_runs_have_the_digests_of_single_runs() {
    if !has_compiler() {
        return;
    }
    let folders = [scene(&[DRIVE, DRIVE]), scene(&[DRIVE])];
    let alone = folders.each_ref().map(|folder| run(folder.path()).digest);
    assert_ne!(alone[0], alone[1]);
    for _ in 0..3 {
        let together = thread::scope(|scope| {
            let runs = folders.each_ref().map(|folder| scope.spawn(|| run(folder.path()).digest));
            runs.map(|run| run.join().expect("a digest"))
        });
        assert_eq!(together, alone);
    }
}

#[test]
fn a_fault_affects_only_its_run() {
    if !has_compiler() {
        return;
    }
    let (good, bad) = (scene(&[DRIVE, DRIVE]), scene(&[DRIVE, CRASH]));
    let alone = run(good.path()).digest;
    let (together, broken) = thread::scope(|scope| {
        let good = scope.spawn(|| run(good.path()));
        let bad = scope.spawn(|| run(bad.path()));
        (good.join().expect("a run"), bad.join().expect("a run"))
    });
    assert_eq!(together.digest, alone);
    assert!(matches!(together.end, EndReason::Finished), "{:?}", together.end);
    assert!(matches!(broken.end, EndReason::ProgramFailed), "{:?}", broken.end);
    let reasons = broken.robots.iter().map(|robot| robot.reason.as_deref().unwrap_or_default());
    let [other, crashed] = reasons.collect::<Vec<_>>()[..] else { panic!("two robots") };
    assert_eq!(other, "another robot's program failed");
    assert!(crashed.starts_with("null pointer used (segmentation fault at address 0x8) at p1.c:5"), "{crashed}");
    assert_eq!(broken.robots[0].outcome, Outcome::Interrupted);
    assert_eq!(lost_flows(), 1, "that of the other robot has been let go");
    assert_eq!(run(good.path()).digest, alone, "this process runs on");
}

#[test]
fn an_interrupt_ends_only_its_runs() {
    if !has_compiler() {
        return;
    }
    let (endless, other) = (scene(&[ENDLESS]), scene(&[DRIVE]));
    let alone = run(other.path()).digest;
    let interrupt = Interrupt::default();
    thread::scope(|scope| {
        let ended = scope.spawn(|| try_run(endless.path(), interrupt.clone()).expect("a run"));
        assert_eq!(run(other.path()).digest, alone);
        thread::sleep(Duration::from_millis(10));
        interrupt.set();
        assert!(matches!(ended.join().expect("a run").end, EndReason::Interrupted));
    });
    let ended = try_run(other.path(), interrupt).expect("a run");
    assert!(matches!(ended.end, EndReason::Interrupted), "for ever");
}
