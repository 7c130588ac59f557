//! Semaphores of RoBIOS 6, identified by number: first come, first served, regardless of priorities.

use std::collections::VecDeque;

use crate::program::site::Site;

/// Maximum number of semaphores that a robot may create; our choice.
pub const MAX_SEMAPHORES: usize = 1 << 20;

/// Semaphores of one robot, numbered from 1.
#[derive(Default)]
pub struct Semaphores {
    list: Vec<Semaphore>,
}

/// One semaphore.
pub struct Semaphore {
    count: i32,
    waiting: VecDeque<u32>,
    /// Location in the program of the call that created it.
    pub made_at: Site,
    /// Name, as shown to the user, of the task that passed last, and the location of its call.
    pub last: Option<(String, Site)>,
}

/// Outcome of passing a semaphore.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PassOutcome {
    /// The task has passed.
    Passed,
    /// The semaphore is closed.
    Closed,
    /// There is no semaphore with this number.
    Unknown,
}

impl Semaphores {
    /// Creates a semaphore with this initial count and returns its number; `None` if there are too many.
    pub fn create(&mut self, count: i32, made_at: Site) -> Option<u32> {
        if self.list.len() >= MAX_SEMAPHORES {
            return None;
        }
        self.list.push(Semaphore { count, waiting: VecDeque::new(), made_at, last: None });
        u32::try_from(self.list.len()).ok()
    }

    /// The semaphore with this number.
    pub fn get(&self, number: u32) -> Option<&Semaphore> {
        self.list.get((number as usize).checked_sub(1)?)
    }

    fn get_mut(&mut self, number: u32) -> Option<&mut Semaphore> {
        self.list.get_mut((number as usize).checked_sub(1)?)
    }

    /// Passes a semaphore, if it is open.
    pub fn try_pass(&mut self, number: u32) -> PassOutcome {
        let Some(semaphore) = self.get_mut(number) else { return PassOutcome::Unknown };
        if semaphore.count == 0 {
            return PassOutcome::Closed;
        }
        semaphore.count -= 1;
        PassOutcome::Passed
    }

    /// Passes a semaphore for `task`, or puts the task at the end of its queue, unless it is in the queue already.
    pub fn pass(&mut self, number: u32, task: u32) -> PassOutcome {
        let outcome = self.try_pass(number);
        if outcome == PassOutcome::Closed
            && let Some(semaphore) = self.get_mut(number)
            && !semaphore.waiting.contains(&task)
        {
            semaphore.waiting.push_back(task);
        }
        outcome
    }

    /// Releases a semaphore. Returns `Some(Some(task))` for the longest waiting task, which passes; `Some(None)` if no
    /// task waits and the count rises; `None` if there is no such semaphore or its count is at its limit.
    pub fn release(&mut self, number: u32) -> Option<Option<u32>> {
        let semaphore = self.get_mut(number)?;
        let first = semaphore.waiting.pop_front();
        if first.is_none() {
            semaphore.count = semaphore.count.checked_add(1)?;
        }
        Some(first)
    }

    /// Removes `task` from the queue of a semaphore.
    pub fn dequeue(&mut self, number: u32, task: u32) {
        if let Some(semaphore) = self.get_mut(number) {
            semaphore.waiting.retain(|other| *other != task);
        }
    }

    /// Records that `task` has passed a semaphore at `site`.
    pub fn note_passing(&mut self, number: u32, task: String, site: Site) {
        if let Some(semaphore) = self.get_mut(number) {
            semaphore.last = Some((task, site));
        }
    }
}

impl Semaphore {
    /// Returns true while tasks wait at the semaphore.
    pub fn has_waiters(&self) -> bool {
        !self.waiting.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn semaphores_are_first_come_first_served() {
        let mut semaphores = Semaphores::default();
        let number = semaphores.create(1, Site::default()).unwrap();
        assert_eq!([2, 5, 3, 5].map(|task| semaphores.pass(number, task)), {
            [PassOutcome::Passed, PassOutcome::Closed, PassOutcome::Closed, PassOutcome::Closed]
        });
        assert_eq!(semaphores.release(number), Some(Some(5)));
        semaphores.dequeue(number, 3);
        assert_eq!(semaphores.release(number), Some(None));
        assert_eq!(semaphores.pass(number, 9), PassOutcome::Passed);
        assert_eq!(semaphores.pass(number + 1, 9), PassOutcome::Unknown);
        assert_eq!(semaphores.release(0), None);
    }

    #[test]
    fn release_fails_at_the_maximum_count() {
        let mut semaphores = Semaphores::default();
        let number = semaphores.create(i32::MAX, Site::default()).unwrap();
        assert_eq!(semaphores.release(number), None);
        assert_eq!(semaphores.pass(number, 1), PassOutcome::Passed);
        assert_eq!(semaphores.release(number), Some(None));
    }
}
