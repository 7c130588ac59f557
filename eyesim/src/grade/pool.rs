//! Pool of worker processes that grade submissions: forks of this process, one for each submission.

use std::io::{self, Read as _, Write as _};
use std::os::unix::net::UnixStream;
use std::time::Duration;

use sim_host::executive::fork::{ForkedWorker, readable};

use super::submission::Submission;
use super::{GradeError, Graded, Grader};
use crate::suite::PoolError;

/// Longest delay until an interrupt is noticed.
const POLL: Duration = Duration::from_millis(100);

/// Grades the submissions with these indices in `workers` forks of this process, which must be single-threaded; calls
/// `done` with each result as soon as it is complete. After an interrupt no further submission is graded.
///
/// # Errors
/// The system cannot start a process or wait for one, or `done` fails.
pub fn grade_all(
    grader: &mut Grader,
    submissions: &[Submission],
    indices: &[usize],
    workers: usize,
    done: &mut dyn FnMut(usize, Graded) -> Result<(), GradeError>,
) -> Result<(), GradeError> {
    let mut waiting = indices.iter().copied();
    let mut working: Vec<(usize, ForkedWorker)> = Vec::new();
    // With fewer submissions than workers, each submission runs its cases in several workers.
    let workers_per_submission = (workers / indices.len().max(1)).max(1);
    while !grader.interrupt.is_set() {
        while working.len() < workers
            && let Some(index) = waiting.next()
        {
            let serve = |stream| serve(grader, &submissions[index], workers_per_submission, stream);
            let process = ForkedWorker::start(serve).map_err(PoolError::Start)?;
            working.push((index, process));
        }
        if working.is_empty() {
            break;
        }
        let streams: Vec<&UnixStream> = working.iter().map(|(_, process)| &process.stream).collect();
        for ready in readable(&streams, POLL).map_err(PoolError::Wait)?.into_iter().rev() {
            let (index, mut process) = working.remove(ready);
            let answer = receive(&mut process.stream);
            let exit_status = process.wait();
            match answer {
                Ok(graded) => done(index, graded)?,
                Err(_) if grader.interrupt.is_set() => {}
                Err(_) => {
                    let problem =
                        format!("the process that graded the submission ended without a result: {exit_status}");
                    done(index, grader.machine_failure(&problem))?;
                }
            }
        }
    }
    Ok(())
}

fn serve(grader: &mut Grader, submission: &Submission, workers: usize, mut stream: UnixStream) {
    let graded = grader.grade(submission, workers);
    // After an interrupt, the result may be incomplete and is not sent.
    if !grader.interrupt.is_set()
        && let Ok(bytes) = serde_json::to_vec(&graded)
    {
        _ = stream.write_all(&(bytes.len() as u64).to_le_bytes()).and_then(|()| stream.write_all(&bytes));
    }
}

fn receive(stream: &mut UnixStream) -> io::Result<Graded> {
    let mut length = [0; 8];
    stream.read_exact(&mut length)?;
    let mut bytes = Vec::new();
    stream.take(u64::from_le_bytes(length)).read_to_end(&mut bytes)?;
    Ok(serde_json::from_slice(&bytes)?)
}
