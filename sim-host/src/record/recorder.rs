//! Merges the robots' journals at each slot's end and hands them to the sinks.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use parking_lot::Mutex;
use sim_core::RobotId;
use sim_core::time::Time;

use super::digest::{Digest, RunDigest};
use super::event::{KindSet, Record};
use super::journal::{Entry, Journal, Page};

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

/// The slot loop's door to everything recorded.
///
/// At each slot's end: [`Self::collect`] for the robots that may have recorded something, in order of their ids, then
/// [`Self::end_slot`].
pub struct Recorder<'s> {
    digest: RunDigest,
    /// Each sink with what it wants.
    sinks: Vec<(KindSet, Box<dyn Sink + 's>)>,
    interest: KindSet,
    /// The pages of this slot's robots, then spare ones: the first `used` are in use.
    pages: Vec<(RobotId, Page)>,
    used: usize,
    order: Vec<Place>,
}

/// An entry of a page, in the order of the run.
#[derive(Clone, Copy)]
struct Place {
    time: Time,
    page: u32,
    entry: u32,
}

impl<'s> Recorder<'s> {
    /// A recorder of a run with `seed` and slots of length `slot`, for `sinks`.
    pub fn new(seed: u64, slot: Time, sinks: Vec<Box<dyn Sink + 's>>) -> Self {
        let sinks: Vec<_> = sinks.into_iter().map(|sink| (sink.interest(), sink)).collect();
        let interest = sinks.iter().fold(KindSet::NONE, |set, (wanted, _)| set.union(*wanted));
        Self { digest: RunDigest::new(seed, slot), sinks, interest, pages: Vec::new(), used: 0, order: Vec::new() }
    }

    /// Takes what `journal` recorded in this slot and begins its next one. To be called in order of the robots' ids;
    /// robots that did nothing may be left out.
    pub fn collect(&mut self, journal: &mut Journal) {
        if journal.is_empty() {
            return;
        }
        journal.seal();
        if let Some(chain) = journal.changed_chain() {
            self.digest.add(journal.robot(), chain);
        }
        if !journal.kinds().intersects(self.interest) {
            journal.clear_page();
            return;
        }
        if self.used == self.pages.len() {
            self.pages.push((journal.robot(), Page::default()));
        }
        let (robot, page) = &mut self.pages[self.used];
        *robot = journal.robot();
        journal.turn_page(page);
        let wanted = |(_, entry): &(usize, &Entry)| self.interest.contains(entry.kind);
        let place =
            |(index, entry): (usize, &Entry)| Place { time: entry.time, page: self.used as u32, entry: index as u32 };
        self.order.extend(page.entries().iter().enumerate().filter(wanted).map(place));
        self.used += 1;
    }

    /// Ends the slot: gives what was collected to the sinks, in order of (virtual time, robot, sequence).
    ///
    /// # Errors
    /// The first of the sinks' errors; the slot is then incomplete for that sink.
    pub fn end_slot(&mut self, end: Time) -> Result<(), RecordError> {
        let digest = self.digest.end_slot(end);
        // Pages are in order of the robots, entries in order of recording.
        self.order.sort_unstable_by_key(|place| (place.time, place.page, place.entry));
        for place in &self.order {
            let (robot, page) = &self.pages[place.page as usize];
            let record = page.decode(*robot, &page.entries()[place.entry as usize]);
            for (wanted, sink) in &mut self.sinks {
                if wanted.contains(record.event.kind()) {
                    sink.record(&record)?;
                }
            }
        }
        self.order.clear();
        self.used = 0;
        self.sinks.iter_mut().try_for_each(|(_, sink)| sink.end_slot(end, digest))
    }

    /// Ends the run at `end`: every sink completes what it keeps, even where another one cannot.
    ///
    /// # Errors
    /// The first of the sinks' errors.
    pub fn finish(&mut self, end: Time) -> Result<Digest, RecordError> {
        let digest = self.digest();
        let results = self.sinks.iter_mut().map(|(_, sink)| sink.finish(end, digest));
        results.fold(Ok(()), Result::and).map(|()| digest)
    }

    /// The digest of the run up to the last slot that has ended.
    pub fn digest(&self) -> Digest {
        self.digest.value()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::event::{Event, Kind, Obstacle};

    /// Keeps the JSON of what it wants.
    struct Lines(KindSet, Vec<String>, Vec<Option<Digest>>);

    impl Sink for Lines {
        fn interest(&self) -> KindSet {
            self.0
        }
        fn record(&mut self, record: &Record<'_>) -> Result<(), RecordError> {
            self.1.push(serde_json::to_string(record).unwrap());
            Ok(())
        }
        fn end_slot(&mut self, _: Time, digest: Option<Digest>) -> Result<(), RecordError> {
            self.2.push(digest);
            Ok(())
        }
    }

    const SLOT: Time = Time::from_millis(50);

    /// Records two slots of two robots; `order` is the order in which their "threads" run.
    fn run(order: [usize; 2], is_verbose: bool, sinks: Vec<Box<dyn Sink + '_>>) -> Digest {
        let mut journals = [1, 2].map(|id| Journal::new(RobotId(id), is_verbose));
        let mut recorder = Recorder::new(7, SLOT, sinks);
        for slot in 0..2 {
            let begin = Time(50_000 * slot);
            for robot in order {
                let journal = &mut journals[robot];
                if journal.is_verbose() {
                    journal.record(begin, &Event::Call { function: "KEYRead", arguments: "", result: "0" });
                }
                journal.record(begin + Time(100 * robot as i64), &Event::Reading { device: "ENCODER", value: slot });
                journal.record(begin + Time(100), &Event::DriveSpeed { v_m_per_s: 0.1 + 0.2, omega_rad_per_s: -0.0 });
            }
            let (x_m, y_m) = (0.5, 0.25);
            let contact = Event::Contact { at_s: begin.seconds(), with: Obstacle::Robot(1), x_m, y_m };
            journals[1].record(begin, &contact);
            journals.iter_mut().for_each(|journal| recorder.collect(journal));
            recorder.end_slot(begin + SLOT).unwrap();
        }
        recorder.digest()
    }

    #[test]
    fn records_come_in_the_one_order() {
        let mut lines = Lines(KindSet::ALL, vec![], vec![]);
        run([1, 0], false, vec![Box::new(&mut lines)]);
        insta::assert_snapshot!(lines.1.join("\n"));
    }

    #[test]
    fn a_sink_gets_only_what_it_wants() {
        let mut lines = Lines(Kind::Contact.set(), vec![], vec![]);
        run([0, 1], true, vec![Box::new(&mut lines)]);
        assert_eq!(lines.1.len(), 2, "{:?}", lines.1);
        assert_eq!(lines.2.len(), 2);
    }

    #[test]
    fn the_digest_depends_neither_on_sinks_nor_on_threads_nor_on_verbosity() {
        let mut lines = Lines(KindSet::ALL, vec![], vec![]);
        let mut contacts = Lines(Kind::Contact.set(), vec![], vec![]);
        let digest = run([0, 1], false, vec![]);
        assert_eq!(digest, run([1, 0], false, vec![Box::new(&mut lines), Box::new(&mut contacts)]));
        assert_eq!(digest, run([1, 0], true, vec![]));
        assert_eq!(lines.2.last(), Some(&Some(digest)));
    }

    #[test]
    fn slots_without_events_leave_the_digest_alone() {
        let mut recorder = Recorder::new(7, SLOT, vec![]);
        let empty = recorder.digest();
        let mut journal = Journal::new(RobotId(1), false);
        journal.record(Time(1), &Event::Hint { text: "PSDGet before PSDInit" });
        recorder.collect(&mut journal);
        recorder.end_slot(SLOT).unwrap();
        assert_eq!(recorder.digest(), empty);
        assert_ne!(empty, Recorder::new(8, SLOT, vec![]).digest());
    }

    #[test]
    fn the_construction_is_the_documented_one() {
        let mut recorder = Recorder::new(7, SLOT, vec![]);
        let before = recorder.digest();
        let mut journal = Journal::new(RobotId(3), false);
        journal.record(Time(1), &Event::Reading { device: "IR", value: -1 });
        recorder.collect(&mut journal);
        recorder.end_slot(SLOT).unwrap();

        let hash = |parts: &[&[u8]]| *blake3::hash(&parts.concat()).as_bytes();
        let start = hash(&[b"eyesim record 1 robot", &3_u32.to_le_bytes()]);
        // Time 1 in zigzag form, number of the kind, length and letters of the name, value -1 in zigzag form.
        let chain = hash(&[&start, &[2, Kind::Reading as u8, 2, b'I', b'R', 1]]);
        let expected = hash(&[&before.0, &3_u32.to_le_bytes(), &chain, &50_000_i64.to_le_bytes()]);
        assert_eq!(recorder.digest(), Digest(expected));
    }

    #[test]
    fn the_digest_is_golden() {
        assert_eq!(
            run([0, 1], false, vec![]).to_string(),
            "8e7fe502083cc57b79bdc315b2dbf4e4388a5816eb2d64b0613cd2d99cf256ad"
        );
    }
}
