//! Values that tasks share.

use std::ops::{Deref, DerefMut};
use std::sync::{Arc, Mutex, MutexGuard};

use super::{Permit, Semaphore};
use crate::robot::locked;
use crate::{Result, Robot};

/// A value that tasks share; a clone is the same one. Who has it locked is alone with it.
///
/// The semaphore is what tasks wait at; the mutex within, for which nobody waits then, is what makes sharing safe whatever the
/// schedule is.
#[derive(Debug)]
pub struct Shared<T> {
    semaphore: Semaphore,
    value: Arc<Mutex<T>>,
}

/// The value of a [`Shared`], which is locked until this is dropped.
#[derive(Debug)]
#[must_use = "the value is locked only while it lives"]
pub struct SharedGuard<'a, T> {
    // In this order: who waits at the semaphore finds the mutex free.
    value: MutexGuard<'a, T>,
    _permit: Permit<'a>,
}

impl<T> Shared<T> {
    #[track_caller]
    pub(super) fn new(robot: &Robot, value: T) -> Result<Self> {
        Ok(Self { semaphore: Semaphore::new(robot, 1)?, value: Arc::new(Mutex::new(value)) })
    }

    /// Locks the value; waits while another task has it.
    ///
    /// A task that locks it twice waits for itself for ever. What a task that is killed has locked is left as it was then.
    ///
    /// # Panics
    /// If it was made in another run.
    #[track_caller]
    pub fn lock<'a>(&'a self, robot: &'a Robot) -> SharedGuard<'a, T> {
        let permit = self.semaphore.acquire(robot);
        SharedGuard { value: locked(&self.value), _permit: permit }
    }
}

impl<T: Clone> Shared<T> {
    /// A copy of the value, locked no longer than that takes.
    ///
    /// # Panics
    /// As [`lock`](Self::lock).
    #[track_caller]
    pub fn get(&self, robot: &Robot) -> T {
        self.lock(robot).clone()
    }
}

impl<T> Clone for Shared<T> {
    fn clone(&self) -> Self {
        Self { semaphore: self.semaphore.clone(), value: Arc::clone(&self.value) }
    }
}

impl<T> Deref for SharedGuard<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T> DerefMut for SharedGuard<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.value
    }
}
