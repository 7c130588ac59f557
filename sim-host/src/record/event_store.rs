//! Compact storage of a run's events during the run, which can be converted to a trace.
//!
//! Events are stored in their canonical form in an unnamed temporary file.

use std::fs::File;
use std::io::{self, Write as _};
use std::os::unix::fs::FileExt as _;
use std::path::Path;
use std::sync::Arc;

use parking_lot::Mutex;
use sim_core::time::Time;

use super::sink::{RecordError, Sink};
use super::stored::Stored;
use super::trace::{Trace, TraceHeader};
use sim_core::record::{Digest, Kind, KindSet, Record};

/// Maximum number of bytes stored for one run.
const MAX_BYTES: u64 = 128 << 20;

/// Bytes written to the file at a time.
const BATCH: usize = 1 << 16;

/// Reason why a run has no trace.
#[derive(Debug, thiserror::Error)]
pub enum EventStoreError {
    /// The events exceed `MAX_BYTES`.
    #[error("this run has too many events to store: `--trace FILE` writes all of them")]
    Full,
    /// Error of the operating system.
    #[error("the temporary file of the run cannot be used: {0}")]
    File(#[from] io::Error),
    /// The trace cannot be written.
    #[error(transparent)]
    Record(#[from] RecordError),
}

/// Sink that stores the events of a run.
pub struct EventStore {
    header: TraceHeader,
    file: Arc<File>,
    /// Entries not yet written to the file.
    batch: Vec<u8>,
    length: u64,
    failure: Option<EventStoreError>,
}

impl EventStore {
    /// Empty storage for a run whose trace begins with `header`.
    ///
    /// # Errors
    /// If the temporary file cannot be created.
    pub fn new(header: TraceHeader) -> io::Result<Self> {
        let file = Arc::new(tempfile::tempfile()?);
        Ok(Self { header, file, batch: Vec::with_capacity(2 * BATCH), length: 0, failure: None })
    }

    /// The trace up to now. The run can continue during the call.
    ///
    /// # Errors
    /// [`EventStoreError`] if the events were not stored.
    pub fn trace(event_store: &Mutex<Self>) -> Result<Vec<u8>, EventStoreError> {
        let (file, length, header) = {
            let mut event_store = event_store.lock();
            event_store.flush();
            if let Some(failure) = event_store.failure.take() {
                event_store.failure = Some(EventStoreError::Full);
                return Err(failure);
            }
            (Arc::clone(&event_store.file), event_store.length, event_store.header.clone())
        };
        let mut bytes = vec![0; length as usize];
        file.read_exact_at(&mut bytes, 0)?;
        let lines = Arc::new(Mutex::new(Vec::new()));
        let mut trace = Trace::new(Box::new(Shared(Arc::clone(&lines))), Path::new("trace.jsonl"), &header)?;
        let mut rest = &bytes[..];
        while let Some(call) = Stored::take(&mut rest)? {
            call.pass_to(&mut trace)?;
        }
        // Flushes the lines since the last slot's end.
        trace.end_slot(Time::ZERO, None)?;
        drop(trace);
        Ok(std::mem::take(&mut *lines.lock()))
    }

    fn store(&mut self, call: &Stored<'_>) {
        if self.failure.is_some() {
            return;
        }
        if let Err(error) = call.append_to(&mut self.batch) {
            self.failure = Some(error.into());
        }
        if self.batch.len() >= BATCH {
            self.flush();
        }
    }

    fn flush(&mut self) {
        let batch = &mut self.batch;
        let written = (&*self.file).write_all(batch);
        self.length += batch.len() as u64;
        batch.clear();
        if let Err(error) = written {
            self.failure = Some(error.into());
        } else if self.length > MAX_BYTES {
            self.failure = Some(EventStoreError::Full);
            // The stored events are no longer needed.
            let _ = self.file.set_len(0);
        }
    }
}

/// Methods never return an error: a trace that cannot be provided must not end the run.
impl Sink for EventStore {
    fn interest(&self) -> KindSet {
        KindSet::ALL.without(Kind::Call)
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        self.store(&Stored::record(record));
        Ok(())
    }

    fn needs_digests(&self) -> bool {
        true
    }

    fn end_slot(&mut self, end: Time, digest: Option<Digest>) -> Result<(), RecordError> {
        if digest.is_some() {
            self.store(&Stored::slot(end, digest));
        }
        Ok(())
    }

    fn finish(&mut self, end: Time, digest: Digest) -> Result<(), RecordError> {
        self.store(&Stored::end(end, digest));
        Ok(())
    }
}

/// Shared memory that outlives its writer.
struct Shared(Arc<Mutex<Vec<u8>>>);

impl io::Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
