//! Many successive runs in one process leak nothing.

mod common;

use std::fs;

use common::{DRIVE, has_compiler, run, scene};

/// The allocator of `eyesim`.
#[global_allocator]
static HEAP: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Three tasks beside `main` that use the heap; `main` then waits for a key.
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

/// Resources of the process that grow if a run leaks.
#[derive(Debug, PartialEq, Eq)]
struct Held {
    threads: usize,
    descriptors: usize,
    mappings: usize,
    /// Mask of the signals that have a handler.
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

/// Resident memory in KiB.
fn resident_kib() -> usize {
    let status = fs::read_to_string("/proc/self/status").expect("the kernel tells");
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).expect("a size");
    line.trim().trim_end_matches(" kB").parse().expect("a number")
}

/// `EYESIM_RUNS` sets the number of runs, 300 by default.
#[test]
fn many_runs_leave_nothing_behind() {
    if !has_compiler() {
        return;
    }
    let runs = std::env::var("EYESIM_RUNS").ok().and_then(|text| text.parse().ok()).unwrap_or(300);
    assert!(runs >= 150, "memory after 100 runs is compared with that after more");
    let at_start = held();
    let folder = scene(&[DRIVE, TASKS]);
    let mut digest = None;
    let (mut early, mut early_kib, mut late_kib) = (None, usize::MAX, usize::MAX);
    for number in 1..=runs {
        let ended = run(folder.path());
        assert_eq!(*digest.get_or_insert(ended.digest), ended.digest);
        drop(ended);
        // The allocator gives memory back in its own time, so the least of fifty runs counts.
        match number {
            51..=100 => early_kib = early_kib.min(resident_kib()),
            _ if number > runs - 50 => late_kib = late_kib.min(resident_kib()),
            _ => {}
        }
        if number % 100 == 0 {
            println!("after {number} runs: {:?}, {} KiB", held(), resident_kib());
        }
        if number == 100 {
            early = Some(held());
        }
    }
    let early = early.expect("at least 100 runs");
    let late = held();
    assert_eq!((late.threads, late.descriptors), (early.threads, early.descriptors));
    assert_eq!(late.handlers, at_start.handlers, "the handlers that were there before are back");
    // Either heap may map or unmap memory at any time; a leak of one mapping per run would give two hundred.
    assert!(late.mappings.abs_diff(early.mappings) < 20, "{early:?} {late:?}");
    // A leak of 60 KiB per run, the touched part of a thread's stack, would give 12 MiB; the least of fifty runs swings by 5 MiB.
    let grown = late_kib.saturating_sub(early_kib);
    assert!(grown < 8192, "{grown} KiB more");
}
