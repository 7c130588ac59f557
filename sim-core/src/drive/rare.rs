//! A part of a value that rarely differs from its default, and takes one word until then.

use std::ops::{Deref, DerefMut};

/// Default value of a [`Rare`] part, which holds until something is written to it.
pub(super) trait Usual: Clone + PartialEq + 'static {
    /// The usual value.
    const USUAL: &'static Self;
}

/// A `T` that is usually [`Usual::USUAL`]; any other value is kept apart. Stages are made at each tick of an erring drive, and copied.
#[derive(Clone, Debug)]
pub(super) struct Rare<T>(Option<Box<T>>);

impl<T> Rare<T> {
    /// The usual value.
    pub const USUAL: Self = Self(None);

    /// Returns true if nothing has been written.
    pub fn is_unwritten(&self) -> bool {
        self.0.is_none()
    }
}

impl<T: Usual> Deref for Rare<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.0.as_deref().unwrap_or(T::USUAL)
    }
}

impl<T: Usual> DerefMut for Rare<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.0.get_or_insert_with(|| Box::new(T::USUAL.clone()))
    }
}

impl<T: Usual> PartialEq for Rare<T> {
    fn eq(&self, other: &Self) -> bool {
        self.is_unwritten() && other.is_unwritten() || **self == **other
    }
}
