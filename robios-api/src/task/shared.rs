//! Values that tasks share.

use std::ops::{Deref, DerefMut};
use std::sync::{Arc, Mutex, MutexGuard};

use super::{Permit, Semaphore};
use crate::robot::locked;
use crate::{Result, Robot};

/// A value shared between tasks. Clones refer to the same value; one task at a time can lock it.
///
/// Tasks wait for a RoBIOS semaphore, so the mutex inside is never contended. Because of the mutex, memory safety does
/// not depend on the order in which tasks run.
#[derive(Debug)]
pub struct Shared<T> {
    semaphore: Semaphore,
    value: Arc<Mutex<T>>,
}

/// Guard that keeps a [`Shared`] value locked until the guard is dropped.
#[derive(Debug)]
#[must_use = "the value is unlocked when the guard is dropped"]
pub struct SharedGuard<'a, T> {
    // Field order matters: the mutex is released before the semaphore, so that the next task finds it free.
    value: MutexGuard<'a, T>,
    _permit: Permit<'a>,
}

impl<T> Shared<T> {
    #[track_caller]
    pub(super) fn new(robot: &Robot, value: T) -> Result<Self> {
        Ok(Self { semaphore: Semaphore::new(robot, 1)?, value: Arc::new(Mutex::new(value)) })
    }

    /// Locks the value; waits while another task has it locked.
    ///
    /// A task that locks the value twice deadlocks. If a task is killed while it holds the lock, the lock is released,
    /// and the changes that the task made to the value remain.
    ///
    /// # Panics
    /// If the value was created in another run.
    #[track_caller]
    pub fn lock<'a>(&'a self, robot: &'a Robot) -> SharedGuard<'a, T> {
        let permit = self.semaphore.acquire(robot);
        SharedGuard { value: locked(&self.value), _permit: permit }
    }
}

impl<T: Clone> Shared<T> {
    /// Returns a copy of the value; the lock is held only while the value is copied.
    ///
    /// # Panics
    /// See [`lock`](Self::lock).
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
