//! Parallel loops of the scheduler step: idle workers help the worker that runs the step.

use std::ptr;
use std::sync::atomic::{AtomicPtr, AtomicUsize, Ordering};

use sim_core::parallel::Pool;

use super::Executor;

/// A loop whose iterations any thread may run.
pub struct Job<'a> {
    /// First iteration that no thread has taken.
    next: AtomicUsize,
    iterations: usize,
    /// Number of iterations that a thread takes at a time.
    chunk: usize,
    /// Runs the iteration with this number.
    act: &'a (dyn Fn(usize) + Sync),
}

impl Job<'_> {
    /// Runs iterations until none is left.
    pub fn work(&self) {
        loop {
            let first = self.next.fetch_add(self.chunk, Ordering::Relaxed);
            if first >= self.iterations {
                return;
            }
            (first..self.iterations.min(first + self.chunk)).for_each(self.act);
        }
    }
}

/// The parallel loop in progress, which the workers of an executor share.
#[derive(Default)]
pub struct SharedLoop {
    /// The job of the loop; null for none.
    job: AtomicPtr<Job<'static>>,
    /// Number of loops so far.
    loops: AtomicUsize,
    /// Number of threads that may be using the job.
    helpers: AtomicUsize,
}

impl SharedLoop {
    /// Returns true if a loop has begun since loop number `seen`, the last loop that the caller has helped.
    pub fn has_job(&self, seen: usize) -> bool {
        self.loops.load(Ordering::SeqCst) != seen
    }

    /// Helps with the loop in progress if it is newer than loop number `seen`, and sets `seen` to its number; returns
    /// false if there is none.
    pub fn help(&self, seen: &mut usize) -> bool {
        if !self.has_job(*seen) {
            return false;
        }
        *seen = self.loops.load(Ordering::SeqCst);
        let _helper = Helper::enter(self);
        // SAFETY: the job lives, since `run` does not return before there is no helper.
        if let Some(job) = unsafe { self.job.load(Ordering::SeqCst).as_ref() } {
            job.work();
        }
        true
    }

    /// Runs `job` on the calling thread and on the helping threads, which `wake_helpers` wakes. Only one thread may
    /// call it at a time.
    pub fn run(&self, job: &Job<'_>, wake_helpers: impl FnOnce()) {
        self.job.store(ptr::from_ref(job).cast_mut().cast(), Ordering::SeqCst);
        self.loops.fetch_add(1, Ordering::SeqCst);
        let _waiting = WaitForHelpers(self);
        wake_helpers();
        job.work();
    }
}

/// A thread that may be using the job.
struct Helper<'a>(&'a SharedLoop);

impl<'a> Helper<'a> {
    fn enter(shared_loop: &'a SharedLoop) -> Self {
        shared_loop.helpers.fetch_add(1, Ordering::SeqCst);
        Self(shared_loop)
    }
}

impl Drop for Helper<'_> {
    fn drop(&mut self) {
        self.0.helpers.fetch_sub(1, Ordering::SeqCst);
    }
}

/// Waits for the helpers when it is dropped.
struct WaitForHelpers<'a>(&'a SharedLoop);

impl Drop for WaitForHelpers<'_> {
    fn drop(&mut self) {
        /// Number of spins before the thread yields its processor: a helper may be waiting for the processor.
        const SPINS: usize = 500;
        self.0.job.store(ptr::null_mut(), Ordering::SeqCst);
        let mut spins = 0;
        while self.0.helpers.load(Ordering::SeqCst) > 0 {
            spins += 1;
            if spins < SPINS { std::hint::spin_loop() } else { std::thread::yield_now() }
        }
    }
}

/// The workers of an executor, for loops of the simulation.
pub struct WorkerPool<'a>(pub &'a dyn Executor);

/// Minimum number of iterations of a loop on several threads: with fewer, the hand-over costs more than it saves.
const MIN_ITERATIONS: usize = 6;

/// Maximum number of iterations that a thread takes at a time.
const MAX_CHUNK: usize = 4;

impl Pool for WorkerPool<'_> {
    fn is_parallel(&self, sections: usize) -> bool {
        sections >= MIN_ITERATIONS && self.0.helping_workers() > 1
    }

    fn run(&self, sections: usize, act: &(dyn Fn(usize) + Sync)) {
        let chunk = (sections / (8 * self.0.helping_workers())).clamp(1, MAX_CHUNK);
        self.0.run_loop(&Job { next: AtomicUsize::new(0), iterations: sections, chunk, act });
    }
}
