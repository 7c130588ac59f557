//! Trace that a separate thread writes to a file while the run continues.
//!
//! The run hands over its slots in batches through a bounded queue. If the writer is so far behind that the queue and a
//! batch are full, the run waits: no record is dropped, and memory is bounded. The waits do not influence the record.

use std::io;
use std::mem;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

use crossbeam_channel::{Receiver, Sender, TrySendError, bounded};
use sim_core::record::{Digest, KindSet, Record};
use sim_core::time::Time;

use super::file::{ExpectedFile, RecordFile};
use super::sink::{RecordError, Sink};
use super::stored::Stored;
use super::trace::{Trace, TraceHeader};

/// Message on a trace in Parquet, in a build without it.
#[cfg(not(feature = "parquet"))]
pub(super) const PARQUET_ABSENT: &str =
    "this eyesim is built without Parquet (cargo's feature `parquet`): traces are NAME.jsonl";

/// Size in bytes from which a batch is full: the run then waits for space in the queue. Our choice, like the next
/// constant.
const FULL_BATCH: usize = 1 << 20;

/// Maximum number of batches in the queue.
const QUEUE: usize = 8;

/// Number of batches in all queues of this process that are not written yet.
static UNWRITTEN: AtomicUsize = AtomicUsize::new(0);

/// Number of traces that wait for their last batches to be written.
static DRAINING: AtomicUsize = AtomicUsize::new(0);

/// True if a batch was written while a trace waited for its last batches.
static HAS_DRAINED: AtomicBool = AtomicBool::new(false);

/// Returns true if a trace waits for its last batches and a batch has been written since the last call.
/// Async-signal-safe.
pub fn has_drained() -> bool {
    HAS_DRAINED.swap(false, Ordering::AcqRel)
}

/// Returns true if every batch that was handed over in this process is written. Async-signal-safe.
pub fn is_all_written() -> bool {
    UNWRITTEN.load(Ordering::Acquire) == 0
}

/// Sink that writes a trace to a file on a separate thread.
///
/// If the sink is dropped before [`Sink::finish`], it still writes the records that it has taken. A later call returns
/// an error of the writer.
pub struct TraceFile {
    path: PathBuf,
    kinds: KindSet,
    /// Encoded records that are not handed over yet.
    batch: Vec<u8>,
    /// The queue to the writer; `None` after its end.
    queue: Option<Sender<Batch>>,
    /// Result of the writer, which the writer's thread sends at its end. The thread is not joined: its end may wait for
    /// a lock that a failed program holds.
    outcome: Receiver<Result<(), RecordError>>,
    expected_file: Option<Arc<ExpectedFile>>,
}

/// Encoded records on their way to the writer.
struct Batch(Vec<u8>);

impl TraceFile {
    /// Creates the file `path`, or empties it, and begins its trace: columns if the name ends with `.parquet`, else
    /// JSON lines, which are compressed if it ends with `.zst`.
    ///
    /// # Errors
    /// [`RecordError::Write`] if the file cannot be written, or the system has no thread left.
    pub fn create(path: &Path, header: &TraceHeader) -> Result<Self, RecordError> {
        let has_columns = path.extension().is_some_and(|extension| extension == "parquet");
        #[cfg(not(feature = "parquet"))]
        if has_columns {
            return Err(RecordError::write("trace", path, io::Error::new(io::ErrorKind::Unsupported, PARQUET_ABSENT)));
        }
        let file = RecordFile::create(path).map_err(|source| RecordError::write("trace", path, source))?;
        let expected_file = Some(file.expected_file());
        #[cfg(feature = "parquet")]
        if has_columns {
            let trace = super::columnar::ColumnarTrace::new(Box::new(file), path, header)?;
            return Self::start(trace, path, expected_file);
        }
        Self::start(Trace::of_file(file, path, header)?, path, expected_file)
    }

    /// Starts a writer that passes the records to `sink`; `path` is the name of the trace in error messages.
    fn start(
        sink: impl Sink + 'static,
        path: &Path,
        expected_file: Option<Arc<ExpectedFile>>,
    ) -> Result<Self, RecordError> {
        let kinds = sink.interest();
        let ((queue, batches), (outcome_sender, outcome)) = (bounded(QUEUE), bounded(1));
        let path = path.to_owned();
        let write = {
            let path = path.clone();
            move || {
                let written = write_batches(batches, sink, &path);
                // The trace may be dropped already.
                _ = outcome_sender.send(written);
            }
        };
        match thread::Builder::new().name("trace".to_owned()).spawn(write) {
            Ok(_) => Ok(Self { path, kinds, batch: Vec::new(), queue: Some(queue), outcome, expected_file }),
            Err(source) => Err(RecordError::write("trace", &path, source)),
        }
    }

    fn push(&mut self, call: &Stored<'_>) -> Result<(), RecordError> {
        call.append_to(&mut self.batch).map_err(|source| RecordError::write("trace", &self.path, source))
    }

    /// Hands the batch over. If the queue is full, keeps a batch that is not full, and waits with a full batch.
    fn hand_over(&mut self) -> Result<(), RecordError> {
        let Some(queue) = &self.queue else {
            // The error of the writer was returned by an earlier call.
            self.batch.clear();
            return Ok(());
        };
        let is_full = self.batch.len() >= FULL_BATCH;
        let next = Vec::with_capacity(self.batch.len());
        let batch = Batch::new(mem::replace(&mut self.batch, next));
        match if is_full { queue.send(batch).map_err(Into::into) } else { queue.try_send(batch) } {
            Ok(()) => Ok(()),
            Err(TrySendError::Full(mut batch)) => {
                self.batch = mem::take(&mut batch.0);
                Ok(())
            }
            Err(TrySendError::Disconnected(_)) => self.end(),
        }
    }

    /// Waits until the writer has written everything that was handed over, and returns its error.
    fn end(&mut self) -> Result<(), RecordError> {
        self.queue = None;
        let is_gone = |_| RecordError::write("trace", &self.path, io::Error::other("its thread has failed"));
        DRAINING.fetch_add(1, Ordering::AcqRel);
        let outcome = self.outcome.recv();
        DRAINING.fetch_sub(1, Ordering::AcqRel);
        outcome.map_err(is_gone)?
    }
}

fn write_batches(batches: Receiver<Batch>, mut sink: impl Sink, path: &Path) -> Result<(), RecordError> {
    for batch in &batches {
        let mut calls = batch.0.as_slice();
        let damaged = |source| RecordError::write("trace", path, source);
        while let Some(call) = Stored::take(&mut calls).map_err(damaged)? {
            call.pass_to(&mut sink)?;
        }
    }
    Ok(())
}

impl Batch {
    fn new(records: Vec<u8>) -> Self {
        UNWRITTEN.fetch_add(1, Ordering::AcqRel);
        Self(records)
    }
}

impl Drop for Batch {
    fn drop(&mut self) {
        UNWRITTEN.fetch_sub(1, Ordering::AcqRel);
        if DRAINING.load(Ordering::Acquire) > 0 {
            HAS_DRAINED.store(true, Ordering::Release);
        }
    }
}

impl Sink for TraceFile {
    fn interest(&self) -> KindSet {
        self.kinds
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        self.push(&Stored::record(record))?;
        if self.batch.len() >= FULL_BATCH { self.hand_over() } else { Ok(()) }
    }

    fn needs_digests(&self) -> bool {
        true
    }

    fn end_slot(&mut self, end: Time, digest: Option<Digest>) -> Result<(), RecordError> {
        if digest.is_some() || !self.batch.is_empty() {
            self.push(&Stored::slot(end, digest))?;
            return self.hand_over();
        }
        // Reports an error even if nothing is recorded any more.
        if self.outcome.is_empty() { Ok(()) } else { self.end() }
    }

    fn finish(&mut self, end: Time, digest: Digest) -> Result<(), RecordError> {
        self.push(&Stored::end(end, digest))?;
        let Some(queue) = &self.queue else { return Ok(()) };
        // If the writer has failed, `end` returns its error.
        _ = queue.send(Batch::new(mem::take(&mut self.batch)));
        self.end()?;
        let checked = self.expected_file.as_ref().map_or(Ok(()), |expected_file| expected_file.check());
        checked.map_err(|source| RecordError::write("trace", &self.path, source))
    }
}

impl Drop for TraceFile {
    fn drop(&mut self) {
        if let Some(queue) = self.queue.take() {
            _ = queue.send(Batch::new(mem::take(&mut self.batch)));
            drop(queue);
            // The run has another error, which is reported.
            _ = self.end();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;
    use std::time::Duration;

    use sim_core::RobotId;
    use sim_core::record::Event;

    use super::*;

    /// Bytes of the text in each record.
    const TEXT: usize = 1 << 16;

    /// Sink that takes a millisecond for each record and calls `take`.
    struct Slow<T>(T);

    impl<T: FnMut(u64) -> io::Result<()> + Send> Sink for Slow<T> {
        fn interest(&self) -> KindSet {
            KindSet::ALL
        }
        fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
            thread::sleep(Duration::from_millis(1));
            let taken = (self.0)(record.sequence.unwrap());
            taken.map_err(|source| RecordError::write("trace", Path::new("t.jsonl"), source))
        }
        fn end_slot(&mut self, _: Time, _: Option<Digest>) -> Result<(), RecordError> {
            Ok(())
        }
    }

    fn trace(take: impl FnMut(u64) -> io::Result<()> + Send + 'static) -> TraceFile {
        TraceFile::start(Slow(take), Path::new("t.jsonl"), None).unwrap()
    }

    /// Records `sequence` in a slot of its own.
    fn record(trace: &mut TraceFile, sequence: u64) -> Result<(), RecordError> {
        let event = Event::Stdout { text: &"x".repeat(TEXT) };
        trace.record(&Record { time: Time(0), robot: RobotId(1), sequence: Some(sequence), event })?;
        trace.end_slot(Time(1), Some(Digest([0; 32])))
    }

    #[test]
    fn run_waits_for_a_slow_writer_and_loses_nothing() {
        const COUNT: u64 = 400;
        let recorded = Arc::new(AtomicUsize::new(0));
        let (written, most) = (Arc::new(Mutex::new(Vec::new())), Arc::new(AtomicUsize::new(0)));
        let mut trace = trace({
            let (recorded, written, most) = (Arc::clone(&recorded), Arc::clone(&written), Arc::clone(&most));
            move |sequence| {
                let mut written = written.lock().unwrap();
                most.fetch_max(recorded.load(Ordering::Acquire) - written.len(), Ordering::Relaxed);
                written.push(sequence);
                Ok(())
            }
        });
        for sequence in 0..COUNT {
            record(&mut trace, sequence).unwrap();
            recorded.fetch_add(1, Ordering::AcqRel);
        }
        trace.finish(Time(1), Digest([0; 32])).unwrap();
        assert!(written.lock().unwrap().iter().copied().eq(0..COUNT));
        // The queue, the batch of the run and that of the writer.
        let most = most.load(Ordering::Relaxed);
        assert!(most <= (QUEUE + 2) * FULL_BATCH / TEXT, "{most} records were waiting");
    }

    #[test]
    fn dropped_trace_is_written() {
        let written = Arc::new(AtomicUsize::new(0));
        let mut trace = trace({
            let written = Arc::clone(&written);
            move |_| {
                written.fetch_add(1, Ordering::AcqRel);
                Ok(())
            }
        });
        (0..100).for_each(|sequence| record(&mut trace, sequence).unwrap());
        drop(trace);
        assert_eq!(written.load(Ordering::Acquire), 100);
    }

    #[test]
    fn error_of_the_writer_ends_the_run() {
        let full = |sequence| if sequence == 3 { Err(io::ErrorKind::StorageFull.into()) } else { Ok(()) };
        let mut first = trace(full);
        // Far more than the queue holds.
        let error = (0..1000).find_map(|sequence| record(&mut first, sequence).err()).expect("an error");
        assert_eq!(error.to_string(), "cannot write the trace `t.jsonl`: no storage space");
        let mut at_end = trace(full);
        let recorded = (0..=3).try_for_each(|sequence| record(&mut at_end, sequence));
        let error = recorded.and_then(|()| at_end.finish(Time(1), Digest([0; 32]))).expect_err("an error");
        assert_eq!(error.to_string(), "cannot write the trace `t.jsonl`: no storage space");
        let mut quiet = trace(full);
        let recorded = (0..=3).try_for_each(|sequence| record(&mut quiet, sequence));
        let mut wait = || loop {
            quiet.end_slot(Time(1), None)?;
            thread::yield_now();
        };
        let error: Result<(), RecordError> = recorded.and_then(|()| wait());
        assert_eq!(error.expect_err("an error").to_string(), "cannot write the trace `t.jsonl`: no storage space");
    }

    #[test]
    fn panic_of_the_writer_is_an_error() {
        let mut trace = trace(|_| panic!("a defect"));
        let recorded = record(&mut trace, 0).and_then(|()| trace.finish(Time(1), Digest([0; 32])));
        assert_eq!(recorded.unwrap_err().to_string(), "cannot write the trace `t.jsonl`: its thread has failed");
    }
}
