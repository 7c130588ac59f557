//! Pool of worker processes, forked from this one, that run cases. Cases whose programs all run on fibers may share a
//! worker; every other case has a worker of its own.

use std::collections::VecDeque;
use std::io::{self, Read as _, Write as _};
use std::ops::ControlFlow;
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use sim_host::executive::fork::{ForkedWorker, limit_memory, readable};

use super::case::{Case, Session, run_case, unfinished_case_result};
use super::row::{CaseResult, RowOutcome};
use super::{Preparation, Suite};

/// Options of a pool.
#[derive(Clone, Copy, Debug)]
pub struct PoolOptions {
    /// Number of cases that run at the same time.
    pub workers: usize,
    /// True if every case runs in a process of its own.
    pub isolate: bool,
}

/// Reasons why cases cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum PoolError {
    /// The system cannot start a process.
    #[error("cannot start a process for cases: {0}")]
    Start(io::Error),
    /// `poll` on the workers' sockets failed.
    #[error("cannot wait for cases: {0}")]
    Wait(io::Error),
}

/// Runs cases in forks of this process, which must be single-threaded.
pub struct Pool<'s> {
    suite: &'s Suite,
    cases: &'s [Case],
    preparation: Preparation,
    options: PoolOptions,
}

/// A worker process with the cases that it has been given.
struct Worker {
    process: ForkedWorker,
    /// The part of the next answer that has arrived.
    received: Vec<u8>,
    /// Time at which that answer began to arrive.
    answer_started: Instant,
    /// Indices of the assigned cases; the first one is running.
    assigned: VecDeque<usize>,
    /// True if the worker ends after its first case.
    runs_one_case: bool,
    /// Start of the running case.
    case_started: Instant,
}

/// Number of cases assigned to a worker that runs many: one runs and one waits, so that the worker is never idle.
const QUEUE_DEPTH: usize = 2;

/// Longest delay until an interrupt is noticed.
const POLL: Duration = Duration::from_millis(100);

/// Time within which workers must end after an interrupt.
const END_TIMEOUT: Duration = Duration::from_secs(2);

/// Time within which a worker that is idle or misbehaves must end.
const WORKER_END_TIMEOUT: Duration = Duration::from_secs(2);

/// Time within which the rest of an answer must arrive.
const ANSWER_TIMEOUT: Duration = Duration::from_secs(30);

/// Maximum length of an answer of a worker, in bytes; paths of many robots and output of programs are much shorter.
const MAX_ANSWER: usize = 256 << 20;

/// Wall-clock seconds that a case gets per second of its processor-time limits, in addition to 10 s; then its worker is
/// killed. The value is far beyond what a loaded machine needs.
const WALL_PER_PROCESSOR_SECOND: f64 = 20.0;

impl<'s> Pool<'s> {
    /// A pool for `cases`, whose programs `preparation` has built.
    pub fn new(suite: &'s Suite, cases: &'s [Case], preparation: Preparation, options: PoolOptions) -> Self {
        Self { suite, cases, preparation, options }
    }

    /// Cache key of the case's result row.
    ///
    /// # Errors
    /// See [`Session::key`].
    pub fn key(&mut self, index: usize) -> Result<String, Box<CaseResult>> {
        self.preparation.session.key(self.suite, &self.cases[index])
    }

    /// Runs the cases with these indices and calls `done` with each result as soon as its case ends; `done` may stop
    /// the pool.
    ///
    /// # Errors
    /// [`PoolError`].
    pub fn run(
        &mut self,
        indices: &[usize],
        done: &mut dyn FnMut(usize, CaseResult) -> ControlFlow<()>,
    ) -> Result<(), PoolError> {
        let mut waiting: VecDeque<usize> = VecDeque::new();
        for &index in indices {
            match self.preparation.failure(self.suite, &self.cases[index]) {
                Some(result) => {
                    if done(index, result).is_break() {
                        return Ok(());
                    }
                }
                None => waiting.push_back(index),
            }
        }
        let mut isolated = VecDeque::new();
        if self.options.isolate || self.suite.spec.limits.memory.is_some() {
            isolated.append(&mut waiting);
        }
        waiting.retain(|&index| {
            let may_share = self.preparation.may_share(&self.cases[index]);
            if !may_share {
                isolated.push_back(index);
            }
            may_share
        });
        let mut workers: Vec<Worker> = Vec::new();
        // Cases during which a shared worker died; they are run again in a worker of their own.
        let mut suspects: Vec<usize> = Vec::new();
        while !self.preparation.session.interrupt.is_set() {
            self.fill_workers(&mut workers, &mut waiting, &mut isolated)?;
            if workers.is_empty() {
                break;
            }
            let streams: Vec<&UnixStream> = workers.iter().map(|worker| &worker.process.stream).collect();
            let ready = readable(&streams, POLL).map_err(PoolError::Wait)?;
            for position in ready.into_iter().rev() {
                let expected = workers[position].assigned.front().map(|&index| &self.cases[index]);
                let answer = match workers[position].receive(expected).transpose() {
                    Some(answer) => answer,
                    None => continue,
                };
                let running = workers[position].assigned.pop_front();
                let (result, is_over) = match (answer, running) {
                    (Ok((result, is_last)), Some(running)) => (Some((running, result)), is_last),
                    (Err(why), Some(running)) => {
                        let exit_status = workers[position].process.end_within(WORKER_END_TIMEOUT);
                        if workers[position].runs_one_case || suspects.contains(&running) {
                            let message = format!("the process of the case {why}: {exit_status}");
                            (Some((running, self.unfinished_result(running, &message))), true)
                        } else {
                            suspects.push(running);
                            isolated.push_front(running);
                            (None, true)
                        }
                    }
                    _ => (None, true),
                };
                workers[position].case_started = Instant::now();
                if is_over {
                    let worker = workers.remove(position);
                    worker.assigned.iter().rev().for_each(|&index| waiting.push_front(index));
                    let mut process = worker.process;
                    _ = process.stream.shutdown(std::net::Shutdown::Both);
                    process.end_within(WORKER_END_TIMEOUT);
                }
                if let Some((index, result)) = result
                    && (result.row.outcome != RowOutcome::Interrupted || !self.preparation.session.interrupt.is_set())
                    && done(index, result).is_break()
                {
                    return Ok(());
                }
            }
            if self.end_unresponsive(&mut workers, &mut waiting, done).is_break() {
                return Ok(());
            }
        }
        shut_down(workers);
        Ok(())
    }

    /// Tops up the queues of the workers, and starts workers while there are cases and fewer workers than allowed.
    fn fill_workers(
        &mut self,
        workers: &mut Vec<Worker>,
        waiting: &mut VecDeque<usize>,
        isolated: &mut VecDeque<usize>,
    ) -> Result<(), PoolError> {
        // A worker without a case is served first, so that the last cases are spread over all workers.
        for target_length in 1..=QUEUE_DEPTH {
            for worker in
                workers.iter_mut().filter(|worker| !worker.runs_one_case && worker.assigned.len() < target_length)
            {
                assign_next(worker, waiting);
            }
        }
        while workers.len() < self.options.workers {
            let runs_one_case = !isolated.is_empty();
            let queue = if runs_one_case { &mut *isolated } else { &mut *waiting };
            if queue.is_empty() {
                break;
            }
            let (suite, cases) = (self.suite, self.cases);
            let session = &mut self.preparation.session;
            let serve = |stream| serve(suite, cases, session, stream, runs_one_case);
            let process = ForkedWorker::start(serve).map_err(PoolError::Start)?;
            process.stream.set_nonblocking(true).map_err(PoolError::Start)?;
            let (received, assigned, now) = (Vec::new(), VecDeque::new(), Instant::now());
            let mut worker =
                Worker { process, received, answer_started: now, assigned, runs_one_case, case_started: now };
            assign_next(&mut worker, queue);
            workers.push(worker);
        }
        // A worker without a case is not needed any more: it removes its files and ends.
        for worker in workers.extract_if(.., |worker| worker.assigned.is_empty()) {
            let mut process = worker.process;
            _ = process.stream.shutdown(std::net::Shutdown::Write);
            process.end_within(WORKER_END_TIMEOUT);
        }
        Ok(())
    }

    /// Kills workers whose cases have taken far more time than their limits allow, or whose answers stay incomplete.
    fn end_unresponsive(
        &mut self,
        workers: &mut Vec<Worker>,
        waiting: &mut VecDeque<usize>,
        done: &mut dyn FnMut(usize, CaseResult) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let suite = self.suite;
        let max_seconds =
            WALL_PER_PROCESSOR_SECOND * (suite.spec.limits.processor + suite.spec.limits.slot_processor) + 10.0;
        let is_late = |worker: &Worker| {
            let answers_late = !worker.received.is_empty() && worker.answer_started.elapsed() > ANSWER_TIMEOUT;
            !worker.assigned.is_empty() && (answers_late || worker.case_started.elapsed().as_secs_f64() > max_seconds)
        };
        while let Some(position) = workers.iter().position(is_late) {
            let mut worker = workers.remove(position);
            worker.process.kill();
            worker.process.wait();
            let first = worker.assigned.pop_front();
            worker.assigned.iter().rev().for_each(|&index| waiting.push_front(index));
            if let Some(index) = first {
                let message = if worker.received.is_empty() {
                    format!("the case did not end within {max_seconds:.0} s of real time; its process was killed")
                } else {
                    "the process of the case sent only part of a result; it was killed".to_owned()
                };
                done(index, self.unfinished_result(index, &message))?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Result of a case whose process ended without one, with `message` as the reason.
    fn unfinished_result(&mut self, index: usize, message: &str) -> CaseResult {
        let mut result = unfinished_case_result(self.suite, &self.cases[index], message);
        result.row.key = self.key(index).unwrap_or_default();
        result
    }
}

/// Assigns the next case to the worker; returns false if there is none.
fn assign_next(worker: &mut Worker, queue: &mut VecDeque<usize>) -> bool {
    let Some(index) = queue.pop_front() else { return false };
    if worker.assigned.is_empty() {
        worker.case_started = Instant::now();
    }
    worker.assigned.push_back(index);
    // A worker that has ended is noticed when its answer is read.
    _ = worker.process.stream.write_all(&(index as u32).to_le_bytes());
    true
}

/// Waits for the workers to end after an interrupt; the signal has reached them too.
fn shut_down(mut workers: Vec<Worker>) {
    let start = Instant::now();
    workers.iter().for_each(|worker| _ = worker.process.stream.shutdown(std::net::Shutdown::Write));
    while !workers.is_empty() && start.elapsed() < END_TIMEOUT {
        let streams: Vec<&UnixStream> = workers.iter().map(|worker| &worker.process.stream).collect();
        let Ok(ready) = readable(&streams, POLL) else { break };
        for position in ready.into_iter().rev() {
            if workers[position].receive(None).is_err() {
                workers.remove(position);
            }
        }
    }
}

impl Worker {
    /// Reads the bytes that have arrived. Once a result is complete, returns it, and true if it is the worker's last.
    /// If `expected` is given, the result must belong to that case. A program shares the worker's process and may write
    /// anything into the connection.
    ///
    /// # Errors
    /// Verb phrase for the message, such as "ended without a result".
    fn receive(&mut self, expected: Option<&Case>) -> Result<Option<(CaseResult, bool)>, &'static str> {
        const HEADER_LENGTH: usize = 5;
        const ENDED: &str = "ended without a result";
        const MALFORMED: &str = "sent an invalid result";
        let mut bytes = [0; 1 << 16];
        loop {
            let missing = match self.received.get(..HEADER_LENGTH) {
                None => HEADER_LENGTH - self.received.len(),
                Some(head) => {
                    let length = u32::from_le_bytes([head[1], head[2], head[3], head[4]]) as usize;
                    if length > MAX_ANSWER {
                        return Err(MALFORMED);
                    }
                    HEADER_LENGTH + length - self.received.len()
                }
            };
            if missing == 0 && self.received.len() >= HEADER_LENGTH {
                let answer = std::mem::take(&mut self.received);
                let result: CaseResult =
                    serde_json::from_slice(&answer[HEADER_LENGTH..]).map_err(|_error| MALFORMED)?;
                let is_expected = expected.is_none_or(|case| result.row.case == case.name);
                return if is_expected { Ok(Some((result, answer[0] != 0))) } else { Err(MALFORMED) };
            }
            let byte_count = missing.min(bytes.len());
            match self.process.stream.read(&mut bytes[..byte_count]) {
                Ok(0) => return Err(ENDED),
                Ok(count) => {
                    if self.received.is_empty() {
                        self.answer_started = Instant::now();
                    }
                    self.received.extend_from_slice(&bytes[..count]);
                }
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => return Ok(None),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(_) => return Err(ENDED),
            }
        }
    }
}

/// Runs the cases that the pool requests, until it closes the connection; only one case if `runs_one_case`.
fn serve(suite: &Suite, cases: &[Case], session: &mut Session, mut stream: UnixStream, runs_one_case: bool) {
    if let Some(bytes) = suite.spec.limits.memory
        && let Err(error) = limit_memory(bytes)
    {
        // Without standard error there is nobody to tell.
        _ = writeln!(io::stderr(), "error: the memory of a case cannot be limited: {error}");
    }
    let mut request = [0; 4];
    while stream.read_exact(&mut request).is_ok() {
        let Some(case) = cases.get(u32::from_le_bytes(request) as usize) else { break };
        let result = run_case(suite, case, session);
        // A program that failed may have corrupted this process.
        let is_last = runs_one_case || session.interrupt.is_set() || result.has_failed_program();
        let sent = serde_json::to_vec(&result).map_err(io::Error::from).and_then(|bytes| {
            let mut message = vec![u8::from(is_last)];
            message.extend((bytes.len() as u32).to_le_bytes());
            message.extend(bytes);
            stream.write_all(&message)
        });
        if sent.is_err() || is_last {
            break;
        }
    }
    session.unload();
}
