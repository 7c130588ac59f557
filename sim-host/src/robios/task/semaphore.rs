//! The semaphores of RoBIOS 6: first come, first served, whatever the priorities. They are known by number.

use std::collections::VecDeque;

use crate::program::site::Site;

/// How many semaphores a robot may make; our choice.
pub const MAX_SEMAPHORES: usize = 1 << 20;

/// The semaphores of one robot; number 1 is the first.
#[derive(Default)]
pub struct Semaphores {
    list: Vec<Semaphore>,
}

/// One semaphore.
pub struct Semaphore {
    count: i32,
    waiting: VecDeque<u32>,
    /// Where it was made.
    pub made_at: Site,
    /// Who passed it last, as the user knows the task, and where.
    pub last: Option<(String, Site)>,
}

/// What comes of passing a semaphore.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Passing {
    /// It has been passed.
    Passed,
    /// It is closed.
    Closed,
    /// There is no semaphore of this number.
    Unknown,
}

impl Semaphores {
    /// Makes a semaphore that so many may pass at first; its number, none if there are too many.
    pub fn make(&mut self, count: i32, made_at: Site) -> Option<u32> {
        if self.list.len() >= MAX_SEMAPHORES {
            return None;
        }
        self.list.push(Semaphore { count, waiting: VecDeque::new(), made_at, last: None });
        u32::try_from(self.list.len()).ok()
    }

    /// The semaphore of this number.
    pub fn get(&self, number: u32) -> Option<&Semaphore> {
        self.list.get((number as usize).checked_sub(1)?)
    }

    fn get_mut(&mut self, number: u32) -> Option<&mut Semaphore> {
        self.list.get_mut((number as usize).checked_sub(1)?)
    }

    /// Passes a semaphore, if it is open.
    pub fn try_pass(&mut self, number: u32) -> Passing {
        let Some(semaphore) = self.get_mut(number) else { return Passing::Unknown };
        if semaphore.count == 0 {
            return Passing::Closed;
        }
        semaphore.count -= 1;
        Passing::Passed
    }

    /// `task` passes a semaphore, or is put at the end of its queue unless it is in it already.
    pub fn pass(&mut self, number: u32, task: u32) -> Passing {
        let passing = self.try_pass(number);
        if passing == Passing::Closed
            && let Some(semaphore) = self.get_mut(number)
            && !semaphore.waiting.contains(&task)
        {
            semaphore.waiting.push_back(task);
        }
        passing
    }

    /// Lets one more pass: the task that has waited longest, which is given, or a later one. None if there is no such semaphore or its count
    /// is as high as it can be.
    pub fn release(&mut self, number: u32) -> Option<Option<u32>> {
        let semaphore = self.get_mut(number)?;
        let first = semaphore.waiting.pop_front();
        if first.is_none() {
            semaphore.count = semaphore.count.checked_add(1)?;
        }
        Some(first)
    }

    /// `task` waits at a semaphore no more.
    pub fn leave(&mut self, number: u32, task: u32) {
        if let Some(semaphore) = self.get_mut(number) {
            semaphore.waiting.retain(|other| *other != task);
        }
    }

    /// `task` has passed a semaphore at `site`.
    pub fn note_passing(&mut self, number: u32, task: String, site: Site) {
        if let Some(semaphore) = self.get_mut(number) {
            semaphore.last = Some((task, site));
        }
    }
}

impl Semaphore {
    /// True while tasks wait at it.
    pub fn is_waited_at(&self) -> bool {
        !self.waiting.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_came_first_passes_first() {
        let mut semaphores = Semaphores::default();
        let number = semaphores.make(1, Site::default()).unwrap();
        assert_eq!([2, 5, 3, 5].map(|task| semaphores.pass(number, task)), {
            [Passing::Passed, Passing::Closed, Passing::Closed, Passing::Closed]
        });
        assert_eq!(semaphores.release(number), Some(Some(5)));
        semaphores.leave(number, 3);
        assert_eq!(semaphores.release(number), Some(None));
        assert_eq!(semaphores.pass(number, 9), Passing::Passed);
        assert_eq!(semaphores.pass(number + 1, 9), Passing::Unknown);
        assert_eq!(semaphores.release(0), None);
    }

    #[test]
    fn a_count_ends_at_its_limit() {
        let mut semaphores = Semaphores::default();
        let number = semaphores.make(i32::MAX, Site::default()).unwrap();
        assert_eq!(semaphores.release(number), None);
        assert_eq!(semaphores.pass(number, 1), Passing::Passed);
        assert_eq!(semaphores.release(number), Some(None));
    }
}
