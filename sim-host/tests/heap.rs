//! A program that crashes within the heap of the C library, which all programs of a process share.

mod common;

use std::sync::mpsc;
use std::thread;

use common::{DRIVE, has_compiler, run, scene, try_run};
use sim_core::record::Outcome;
use sim_host::executive::damage::is_heap_lost;
use sim_host::executive::dispatcher::EndReason;
use sim_host::executive::interrupt::Interrupt;

/// The allocator of `eyesim`, whose heap is not the one that breaks.
#[global_allocator]
static HEAP: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Frees memory that it never allocated. It bypasses the shim's `free`, which would detect this.
const FREE: &str = r#"
#include "eyebot.h"
extern void __libc_free(void *memory);
int main(void) {
    void *volatile memory = (void *)4096;
    OSWait(10);
    __libc_free(memory);
    return 0;
}
"#;

/// Runs until something ends it.
const ENDLESS: &str = r#"
#include "eyebot.h"
int main(void) { for (;;) OSWait(1); }
"#;

#[test]
fn a_fault_in_the_heap_ends_all_runs_of_the_process() {
    if !has_compiler() {
        return;
    }
    let (endless, free, other) = (scene(&[ENDLESS]), scene(&[FREE]), scene(&[DRIVE]));
    // Built before the crash.
    run(other.path());
    thread::scope(|scope| {
        let (started, starts) = mpsc::channel();
        let ended = scope.spawn(move || {
            started.send(()).expect("a listener");
            try_run(endless.path(), Interrupt::default())
        });
        starts.recv().expect("a thread");
        let broken = run(free.path());
        assert!(matches!(broken.end, EndReason::ProgramFailed), "{:?}", broken.end);
        let reason = broken.robots[0].reason.as_deref().unwrap_or_default();
        assert!(reason.contains("segmentation fault") && reason.contains("p0.c:7"), "{reason}");
        assert!(is_heap_lost());
        // If the run had not begun before the crash, it was refused.
        match ended.join().expect("a run") {
            Ok(ended) => {
                assert!(matches!(ended.end, EndReason::HeapLost), "{:?}", ended.end);
                assert_eq!(ended.robots[0].outcome, Outcome::Interrupted);
                let reason = ended.robots[0].reason.as_deref().unwrap_or_default();
                assert!(reason.contains("heap of the C library"), "{reason}");
            }
            Err(refused) => assert!(refused.to_string().contains("heap of the C library"), "{refused}"),
        }
    });
    let refused = try_run(other.path(), Interrupt::default()).err().map(|error| error.to_string()).unwrap_or_default();
    assert!(refused.contains("heap of the C library") && refused.contains("--exec process"), "{refused}");
}
