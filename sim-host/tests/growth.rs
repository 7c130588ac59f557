//! Many runs in one process, one after another, leave nothing behind.

mod common;

use std::fs;

use common::{DRIVE, has_compiler, run, scene};

/// As that of `eyesim`.
#[global_allocator]
static HEAP: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// A task beside `main`, files, and more output than a buffer holds.
const TASKS: &str = r#"
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include "eyebot.h"
static void *work(void *given) {
    char *memory = malloc(100000);
    int i;
    for (i = 0; i < 5; i++) {
        memory[i] = i;
        OSWait(3);
    }
    free(memory);
    return given;
}
int main(void) {
    pthread_t tasks[3];
    int i;
    for (i = 0; i < 3; i++)
        pthread_create(&tasks[i], NULL, work, NULL);
    for (i = 0; i < 3; i++)
        pthread_join(tasks[i], NULL);
    LCDPrintf("done\n");
    KEYWait(KEY1);
    return 0;
}
"#;

/// What of the process grows if something is left behind.
#[derive(Debug, PartialEq, Eq)]
struct Held {
    threads: usize,
    descriptors: usize,
    mappings: usize,
    /// Signals for which there is a handler.
    handlers: String,
}

fn held() -> Held {
    let count = |folder: &str| fs::read_dir(folder).expect("a folder of the kernel").count();
    let status = fs::read_to_string("/proc/self/status").expect("the kernel tells");
    Held {
        threads: count("/proc/self/task"),
        descriptors: count("/proc/self/fd"),
        mappings: fs::read_to_string("/proc/self/maps").expect("the kernel tells").lines().count(),
        handlers: status.lines().find(|line| line.starts_with("SigCgt")).unwrap_or_default().to_owned(),
    }
}

/// Memory that is in use, in KiB.
fn resident_kib() -> usize {
    let status = fs::read_to_string("/proc/self/status").expect("the kernel tells");
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).expect("a size");
    line.trim().trim_end_matches(" kB").parse().expect("a number")
}

/// `EYESIM_RUNS` says how many runs there are, 300 where it does not.
#[test]
fn many_runs_leave_nothing_behind() {
    if !has_compiler() {
        return;
    }
    let runs = std::env::var("EYESIM_RUNS").ok().and_then(|text| text.parse().ok()).unwrap_or(300);
    assert!(runs > 100, "memory after 100 runs is compared with that after more");
    let at_start = held();
    let folder = scene(&[DRIVE, TASKS]);
    let mut digest = None;
    let mut early = None;
    for number in 1..=runs {
        let ended = run(folder.path());
        assert_eq!(*digest.get_or_insert(ended.digest), ended.digest);
        drop(ended);
        if number % 100 == 0 {
            println!("after {number} runs: {:?}, {} KiB", held(), resident_kib());
        }
        if number == 100 {
            early = Some((held(), resident_kib()));
        }
    }
    let (early, early_kib) = early.expect("at least 100 runs");
    let late = held();
    assert_eq!((late.threads, late.descriptors), (early.threads, early.descriptors));
    assert_eq!(late.handlers, at_start.handlers, "the handlers that were there before are back");
    // Both heaps may take or give back a piece at any time; a run that left one thing behind would have left two hundred.
    assert!(late.mappings.abs_diff(early.mappings) < 20, "{early:?} {late:?}");
    // Of 60 KiB a run, what a thread's touched stack takes, there would be 12 MiB.
    let grown = resident_kib().saturating_sub(early_kib);
    assert!(grown < 4096, "{grown} KiB more");
}
