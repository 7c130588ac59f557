//! Recorder: merges the robots' journals at each slot's end and computes the run's digest.

use super::digest::{Digest, RunDigest};
use super::event::{KindSet, Record};
use super::journal::{EndedJournal, Entry, Journal, Page};
use crate::RobotId;
use crate::time::Time;

/// Record of a run: merges the journals of a slot and computes the digest.
///
/// At each slot's end, call [`Self::collect`] for the robots that may have recorded events, in order of their ids, then
/// [`Self::end_slot`].
#[derive(Clone, Debug)]
pub struct Recorder {
    digest: RunDigest,
    interest: KindSet,
    /// Pages of the robots in this slot (the first `used`), followed by spare pages.
    pages: Vec<(RobotId, Page)>,
    used: usize,
    order: Vec<MergedEntry>,
}

/// Position of an event in the merged order.
#[derive(Clone, Copy, Debug)]
struct MergedEntry {
    time: Time,
    page: u32,
    entry: u32,
}

impl Recorder {
    /// Record of a run with `seed` and slots of length `slot`, before its first slot. The observer gets the events of the kinds in
    /// `interest`.
    pub fn new(seed: u64, slot: Time, interest: KindSet) -> Self {
        Self { digest: RunDigest::new(seed, slot), interest, pages: Vec::new(), used: 0, order: Vec::new() }
    }

    /// Sets the kinds of events to show, from this slot on.
    pub fn set_interest(&mut self, interest: KindSet) {
        self.interest = interest;
    }

    /// Takes the events of `journal` in this slot and begins its next slot. Must be called in order of the robots' ids;
    /// robots without events may be left out.
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
        let is_recorded = |(_, entry): &(usize, &Entry)| self.interest.contains(entry.kind);
        let merged = |(index, entry): (usize, &Entry)| MergedEntry {
            time: entry.time,
            page: self.used as u32,
            entry: index as u32,
        };
        self.order.extend(page.entries().iter().enumerate().filter(is_recorded).map(merged));
        self.used += 1;
    }

    /// Kinds of the events to show.
    pub(crate) fn interest(&self) -> KindSet {
        self.interest
    }

    /// Takes the events of `journal` like [`Recorder::collect`], given the result of [`Journal::end_slot`].
    pub(crate) fn collect_ended(&mut self, robot: RobotId, ended: &EndedJournal, journal: &mut Journal) {
        match ended {
            EndedJournal::Empty => {}
            EndedJournal::Chain(chain) => self.digest.add(robot, chain),
            EndedJournal::Sealed => self.collect(journal),
        }
    }

    /// Ends the slot: passes the collected events of interest to `show`, in order of (virtual time, robot, sequence). Returns the
    /// digest of the run so far, if the slot changed it.
    ///
    /// # Errors
    /// The first error of `show`; the remaining events of the slot are then not shown.
    pub fn end_slot<E>(
        &mut self,
        end: Time,
        mut show: impl FnMut(&Record<'_>) -> Result<(), E>,
    ) -> Result<Option<Digest>, E> {
        let digest = self.digest.end_slot(end);
        // Pages are in the order of the robots, entries in the order of recording.
        self.order.sort_unstable_by_key(|entry| (entry.time, entry.page, entry.entry));
        self.used = 0;
        for entry in self.order.drain(..) {
            let (robot, page) = &self.pages[entry.page as usize];
            show(&page.decode(*robot, &page.entries()[entry.entry as usize]))?;
        }
        Ok(digest)
    }

    /// Digest of the run up to the last ended slot.
    pub fn digest(&self) -> Digest {
        self.digest.value()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    use crate::record::event::{Event, Kind, Obstacle};

    /// Output of a run: the JSON of its records, and the digest after each slot.
    #[derive(Default)]
    struct RunOutput(Vec<String>, Vec<Option<Digest>>);

    fn end_slot(recorder: &mut Recorder, end: Time, shown: &mut RunOutput) {
        let show = |record: &Record<'_>| -> Result<(), Infallible> {
            shown.0.push(serde_json::to_string(record).unwrap());
            Ok(())
        };
        let Ok(digest) = recorder.end_slot(end, show);
        shown.1.push(digest);
    }

    const SLOT: Time = Time::from_millis(50);

    /// Records two slots of two robots; `order` is the order in which their "threads" run.
    fn run(order: [usize; 2], is_verbose: bool, interest: KindSet) -> (Digest, RunOutput) {
        let mut journals = [1, 2].map(|id| Journal::new(RobotId(id), is_verbose));
        let mut recorder = Recorder::new(7, SLOT, interest);
        let mut shown = RunOutput::default();
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
            end_slot(&mut recorder, begin + SLOT, &mut shown);
        }
        (recorder.digest(), shown)
    }

    #[test]
    fn records_come_in_the_one_order() {
        let (_, shown) = run([1, 0], false, KindSet::ALL);
        insta::assert_snapshot!(shown.0.join("\n"));
    }

    #[test]
    fn only_what_is_of_interest_is_shown() {
        let (_, shown) = run([0, 1], true, Kind::Contact.set());
        assert_eq!(shown.0.len(), 2, "{:?}", shown.0);
        assert_eq!(shown.1.len(), 2);
    }

    #[test]
    fn an_error_ends_the_slot_and_leaves_the_digest_as_it_is() {
        let mut recorder = Recorder::new(7, SLOT, KindSet::ALL);
        let mut journal = Journal::new(RobotId(1), false);
        journal.record(Time(1), &Event::Beep {});
        journal.record(Time(2), &Event::Beep {});
        recorder.collect(&mut journal);
        let mut count = 0;
        let result = recorder.end_slot(SLOT, |_| {
            count += 1;
            Err("full")
        });
        assert_eq!((result, count), (Err("full"), 1));
        let (digest, mut shown) = (recorder.digest(), RunOutput::default());
        end_slot(&mut recorder, SLOT + SLOT, &mut shown);
        assert_eq!((recorder.digest(), shown.0.len()), (digest, 0));
    }

    #[test]
    fn the_digest_depends_neither_on_who_is_shown_it_nor_on_threads_nor_on_verbosity() {
        let (digest, _) = run([0, 1], false, KindSet::NONE);
        let (shown_all, shown) = run([1, 0], false, KindSet::ALL);
        assert_eq!(digest, shown_all);
        assert_eq!(digest, run([1, 0], true, Kind::Contact.set()).0);
        assert_eq!(shown.1.last(), Some(&Some(digest)));
    }

    #[test]
    fn slots_without_events_leave_the_digest_alone() {
        let mut recorder = Recorder::new(7, SLOT, KindSet::ALL);
        let empty = recorder.digest();
        let mut journal = Journal::new(RobotId(1), false);
        journal.record(Time(1), &Event::Hint { text: "PSDGet before PSDInit" });
        recorder.collect(&mut journal);
        end_slot(&mut recorder, SLOT, &mut RunOutput::default());
        assert_eq!(recorder.digest(), empty);
        assert_ne!(empty, Recorder::new(8, SLOT, KindSet::ALL).digest());
    }

    #[test]
    fn the_construction_is_the_documented_one() {
        let mut recorder = Recorder::new(7, SLOT, KindSet::ALL);
        let before = recorder.digest();
        let mut journal = Journal::new(RobotId(3), false);
        journal.record(Time(1), &Event::Reading { device: "IR", value: -1 });
        recorder.collect(&mut journal);
        end_slot(&mut recorder, SLOT, &mut RunOutput::default());

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
            run([0, 1], false, KindSet::NONE).0.to_string(),
            "8e7fe502083cc57b79bdc315b2dbf4e4388a5816eb2d64b0613cd2d99cf256ad"
        );
    }
}
