//! Checks that many successive runs in one process leak nothing.

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
struct ResourceUse {
    threads: usize,
    descriptors: usize,
    mappings: usize,
    /// Mask of the signals that have a handler.
    handlers: String,
}

fn held() -> ResourceUse {
    let count = |folder: &str| fs::read_dir(folder).expect("a folder of the kernel").count();
    let status = fs::read_to_string("/proc/self/status").expect("the kernel tells");
    ResourceUse {
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

/// Median of a number of sizes. Single sizes differ by 10 MiB, since the allocator returns memory with a delay.
fn median(mut sizes: Vec<usize>) -> usize {
    sizes.sort_unstable();
    sizes[sizes.len() / 2]
}

/// `EYESIM_RUNS` sets the number of runs, 500 by default.
#[test]
fn many_runs_leak_no_resources() {
    if !has_compiler() {
        return;
    }
    let runs = std::env::var("EYESIM_RUNS").ok().and_then(|text| text.parse().ok()).unwrap_or(500);
    assert!(runs >= 150, "memory after 100 runs is compared with that after more");
    let at_start = held();
    let folder = scene(&[DRIVE, TASKS]);
    let mut digest = None;
    let (mut early, mut early_kib, mut late_kib) = (None, Vec::new(), Vec::new());
    for number in 1..=runs {
        let ended = run(folder.path());
        assert_eq!(*digest.get_or_insert(ended.digest), ended.digest);
        drop(ended);
        match number {
            51..=100 => early_kib.push(resident_kib()),
            _ if number > runs - 50 => late_kib.push(resident_kib()),
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
    // Either heap may map or unmap memory at any time; a leak of one mapping per run would map four hundred.
    assert!(late.mappings.abs_diff(early.mappings) < 20, "{early:?} {late:?}");
    // A leak of 60 KiB per run, the touched part of a thread's stack, would give 24 MiB.
    let grown = median(late_kib).saturating_sub(median(early_kib));
    println!("{grown} KiB more");
    assert!(grown < 12_288, "{grown} KiB more");
}
