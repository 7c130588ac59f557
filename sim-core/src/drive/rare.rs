//! A value that rarely differs from its default; an unwritten value takes one machine word.

use std::ops::{Deref, DerefMut};

/// Types with a constant default value, for [`Rare`].
pub(super) trait ConstDefault: Clone + PartialEq + 'static {
    /// The default value.
    const DEFAULT: &'static Self;
}

/// A `T` that is allocated when it is first written; until then the value is [`ConstDefault::DEFAULT`]. This keeps
/// stages small; a drive with errors makes and copies a stage at each tick.
#[derive(Clone, Debug)]
pub(super) struct Rare<T>(Option<Box<T>>);

impl<T> Rare<T> {
    /// The default value, not yet written.
    pub const DEFAULT: Self = Self(None);

    /// Returns true if nothing has been written.
    pub fn is_unwritten(&self) -> bool {
        self.0.is_none()
    }
}

impl<T: ConstDefault> Deref for Rare<T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.0.as_deref().unwrap_or(T::DEFAULT)
    }
}

impl<T: ConstDefault> DerefMut for Rare<T> {
    fn deref_mut(&mut self) -> &mut T {
        self.0.get_or_insert_with(|| Box::new(T::DEFAULT.clone()))
    }
}

impl<T: ConstDefault> PartialEq for Rare<T> {
    fn eq(&self, other: &Self) -> bool {
        self.is_unwritten() && other.is_unwritten() || **self == **other
    }
}
