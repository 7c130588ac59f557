//! Sinks: consumers of a run's records, and the errors that end a record.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use parking_lot::Mutex;
use sim_core::record::{Digest, KindSet, Record, Recorder};
use sim_core::time::Time;

/// Reason why a requested record cannot be completed; it ends the run.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// Error of the operating system when writing: disk full, no permission, ...
    #[error("cannot write the {what} `{}`: {source}", path.display())]
    Write {
        /// `trace`, `report`.
        what: &'static str,
        /// The file as the user named it.
        path: PathBuf,
        /// The system's error.
        source: std::io::Error,
    },
    /// A stream of the process cannot be written.
    #[error("cannot write to {stream}: {source}")]
    Print {
        /// `standard output` or `standard error`.
        stream: &'static str,
        /// The system's error.
        source: std::io::Error,
    },
    /// The cameras' scenery has warnings, and the options treat warnings as errors.
    #[error("the run does not continue: {0}")]
    Strict(String),
    /// The report contains a value that its schema does not allow.
    #[error("cannot write the report: {0}")]
    Report(serde_json::Error),
}

impl RecordError {
    /// Error of the system when writing the file `path`; `what` names the kind of file.
    pub(crate) fn write(what: &'static str, path: &Path, source: std::io::Error) -> Self {
        Self::Write { what, path: path.to_owned(), source }
    }
}

/// Consumer of records.
pub trait Sink: Send {
    /// Kinds of records that the sink takes; constant during a run. If a slot has only records of other kinds, only
    /// [`Self::end_slot`] is called.
    fn interest(&self) -> KindSet;

    /// Takes one record of the slot, in the order (virtual time, robot, sequence).
    ///
    /// # Errors
    /// If the record cannot be stored.
    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError>;

    /// Returns true if the sink needs the digest after each slot, which takes time; constant during a run.
    fn needs_digests(&self) -> bool {
        false
    }

    /// Ends the slot at `end`; `digest` is the digest of the run so far, if the slot changed it and a sink
    /// [needs it](Self::needs_digests).
    ///
    /// # Errors
    /// If the slot's records cannot be stored.
    fn end_slot(&mut self, end: Time, digest: Option<Digest>) -> Result<(), RecordError>;

    /// Completes the record of the run, which has ended at `end` with `digest`.
    ///
    /// # Errors
    /// If the record cannot be completed.
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

    fn needs_digests(&self) -> bool {
        (**self).needs_digests()
    }

    fn end_slot(&mut self, end: Time, digest: Option<Digest>) -> Result<(), RecordError> {
        (**self).end_slot(end, digest)
    }

    fn finish(&mut self, end: Time, digest: Digest) -> Result<(), RecordError> {
        (**self).finish(end, digest)
    }
}

/// A sink that its owner can read during the run or after it.
impl<S: Sink> Sink for Arc<Mutex<S>> {
    fn interest(&self) -> KindSet {
        self.lock().interest()
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        self.lock().record(record)
    }

    fn needs_digests(&self) -> bool {
        self.lock().needs_digests()
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
/// What each sink needs is queried once, since it is constant during a run.
#[derive(Default)]
pub struct Sinks<'s> {
    needs_digests: bool,
    /// The sinks with their interests.
    sinks: Vec<(KindSet, Box<dyn Sink + 's>)>,
}

impl<'s> Sinks<'s> {
    /// A collection that contains only `sink`.
    pub fn one(sink: impl Sink + 's) -> Self {
        Self::from_iter([Box::new(sink) as Box<dyn Sink + 's>])
    }

    /// Ends the slot of `recorder` at `end`, and passes its records and digest to the sinks. The recorder must record
    /// all kinds of records that the sinks take.
    ///
    /// # Errors
    /// The first error of a sink; its record of the slot is then incomplete.
    pub fn take_slot(&mut self, recorder: &mut Recorder, end: Time) -> Result<(), RecordError> {
        let has_changed = recorder.end_slot(end, |record| self.record(record))?;
        self.end_slot(end, (has_changed && self.needs_digests).then(|| recorder.update_digest()))
    }

    /// Completes the record at the end of the run, `time`; returns the digest, and the error if the record is
    /// incomplete.
    pub fn finish_record(&mut self, recorder: &mut Recorder, time: Time) -> (Digest, Result<(), RecordError>) {
        let ended = self.take_slot(recorder, time);
        let digest = recorder.digest();
        let completed = ended.and_then(|()| self.finish(time, digest));
        // If a sink could not be completed, dropping it writes the records that it has taken.
        self.sinks.clear();
        (digest, completed)
    }
}

impl<'s> FromIterator<Box<dyn Sink + 's>> for Sinks<'s> {
    fn from_iter<I: IntoIterator<Item = Box<dyn Sink + 's>>>(sinks: I) -> Self {
        let sinks: Vec<_> = sinks.into_iter().map(|sink| (sink.interest(), sink)).collect();
        Self { needs_digests: sinks.iter().any(|(_, sink)| sink.needs_digests()), sinks }
    }
}

impl Sink for Sinks<'_> {
    /// Union of the sinks' interests.
    fn interest(&self) -> KindSet {
        self.sinks.iter().fold(KindSet::NONE, |set, (interest, _)| set.union(*interest))
    }

    fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
        let kind = record.event.kind();
        self.sinks
            .iter_mut()
            .filter(|(interest, _)| interest.contains(kind))
            .try_for_each(|(_, sink)| sink.record(record))
    }

    fn needs_digests(&self) -> bool {
        self.needs_digests
    }

    fn end_slot(&mut self, end: Time, digest: Option<Digest>) -> Result<(), RecordError> {
        self.sinks.iter_mut().try_for_each(|(_, sink)| sink.end_slot(end, digest))
    }

    /// Completes every sink, even if another sink fails; returns the first error.
    fn finish(&mut self, end: Time, digest: Digest) -> Result<(), RecordError> {
        let results = self.sinks.iter_mut().map(|(_, sink)| sink.finish(end, digest));
        results.fold(Ok(()), Result::and)
    }
}
