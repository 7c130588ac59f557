//! Sinks: everybody who wants to see a run's records, and what keeps one of them from being kept.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use parking_lot::Mutex;
use sim_core::record::{Digest, KindSet, Record, Recorder};
use sim_core::time::Time;

/// Why a record that was asked for cannot be completed; the run ends with it.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The operating system refused to write: disk full, no permission, ...
    #[error("cannot write the {what} `{}`: {source}", path.display())]
    Write {
        /// `trace`, `report`.
        what: &'static str,
        /// The file as the user named it.
        path: PathBuf,
        /// The system's own words.
        source: std::io::Error,
    },
    /// A stream of the process cannot be written.
    #[error("cannot write to {stream}: {source}")]
    Print {
        /// `standard output` or `standard error`.
        stream: &'static str,
        /// The system's own words.
        source: std::io::Error,
    },
    /// What cameras see has warnings, and the user wants none.
    #[error("the scene is not run on: {0}")]
    Strict(String),
    /// The report holds what its schema does not allow.
    #[error("cannot write the report: {0}")]
    Report(serde_json::Error),
}

impl RecordError {
    /// The system refused to write the `what` at `path`.
    pub(crate) fn write(what: &'static str, path: &Path, source: std::io::Error) -> Self {
        Self::Write { what, path: path.to_owned(), source }
    }
}

/// Somebody who wants to see records.
pub trait Sink: Send {
    /// The kinds that it wants, the same for the whole run; a slot without any of them costs it nothing but [`Self::end_slot`].
    fn interest(&self) -> KindSet;

    /// Takes one record of the slot; they come in order of (virtual time, robot, sequence).
    ///
    /// # Errors
    /// If the record cannot be kept.
    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError>;

    /// The slot that ends at `end` is complete; `digest` is the run's up to here, if the slot changed it.
    ///
    /// # Errors
    /// If what was recorded cannot be kept.
    fn end_slot(&mut self, end: Time, digest: Option<Digest>) -> Result<(), RecordError>;

    /// The run has ended at `end` with `digest`: completes what the sink keeps.
    ///
    /// # Errors
    /// If it cannot be completed.
    fn finish(&mut self, _end: Time, _digest: Digest) -> Result<(), RecordError> {
        Ok(())
    }
}

impl<S: Sink + ?Sized> Sink for &mut S {
    fn interest(&self) -> KindSet {
        (**self).interest()
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        (**self).record(record)
    }

    fn end_slot(&mut self, end: Time, digest: Option<Digest>) -> Result<(), RecordError> {
        (**self).end_slot(end, digest)
    }

    fn finish(&mut self, end: Time, digest: Digest) -> Result<(), RecordError> {
        (**self).finish(end, digest)
    }
}

/// A sink whose owner looks at it while the run records, or after it.
impl<S: Sink> Sink for Arc<Mutex<S>> {
    fn interest(&self) -> KindSet {
        self.lock().interest()
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        self.lock().record(record)
    }

    fn end_slot(&mut self, end: Time, digest: Option<Digest>) -> Result<(), RecordError> {
        self.lock().end_slot(end, digest)
    }

    fn finish(&mut self, end: Time, digest: Digest) -> Result<(), RecordError> {
        self.lock().finish(end, digest)
    }
}

/// All sinks of a run as one.
///
/// Unlike a single sink it is not asked again for what it wants: that is the same for the whole run.
#[derive(Default)]
pub struct Sinks<'s> {
    /// Each with what it wants.
    sinks: Vec<(KindSet, Box<dyn Sink + 's>)>,
}

impl<'s> Sinks<'s> {
    /// These sinks alone, of which there is one.
    pub fn one(sink: impl Sink + 's) -> Self {
        Self { sinks: vec![(sink.interest(), Box::new(sink))] }
    }

    /// Ends the slot of `recorder` at `end`, whose interest is that of these sinks: they get its records and its digest.
    ///
    /// # Errors
    /// The first error of a sink; the slot is then incomplete for it.
    pub fn take_slot(&mut self, recorder: &mut Recorder, end: Time) -> Result<(), RecordError> {
        let digest = recorder.end_slot(end, |record| self.record(record))?;
        self.end_slot(end, digest)
    }

    /// Completes the record at the end of the run, `time`: its digest, and what kept it from being complete.
    pub fn finish_record(&mut self, recorder: &mut Recorder, time: Time) -> (Digest, Result<(), RecordError>) {
        let ended = self.take_slot(recorder, time);
        let digest = recorder.digest();
        (digest, ended.and_then(|()| self.finish(time, digest)))
    }
}

impl<'s> FromIterator<Box<dyn Sink + 's>> for Sinks<'s> {
    fn from_iter<I: IntoIterator<Item = Box<dyn Sink + 's>>>(sinks: I) -> Self {
        Self { sinks: sinks.into_iter().map(|sink| (sink.interest(), sink)).collect() }
    }
}

impl Sink for Sinks<'_> {
    /// What any of them wants.
    fn interest(&self) -> KindSet {
        self.sinks.iter().fold(KindSet::NONE, |set, (wanted, _)| set.union(*wanted))
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        let kind = record.event.kind();
        self.sinks.iter_mut().filter(|(wanted, _)| wanted.contains(kind)).try_for_each(|(_, sink)| sink.record(record))
    }

    fn end_slot(&mut self, end: Time, digest: Option<Digest>) -> Result<(), RecordError> {
        self.sinks.iter_mut().try_for_each(|(_, sink)| sink.end_slot(end, digest))
    }

    /// Every sink completes what it keeps, even where another one cannot; the first of their errors.
    fn finish(&mut self, end: Time, digest: Digest) -> Result<(), RecordError> {
        let results = self.sinks.iter_mut().map(|(_, sink)| sink.finish(end, digest));
        results.fold(Ok(()), Result::and)
    }
}
