//! Sets of kinds of events.

use super::Kind;

// A `KindSet` has 64 bits, one for each kind. (A kind's number must also be one byte in postcard's varint form.)
const _: () = assert!(Kind::ALL.len() <= 64);

/// A set of kinds of events.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct KindSet(u64);

impl KindSet {
    /// The empty set.
    pub const NONE: Self = Self(0);
    /// The set of all kinds; bits without a kind are set as well.
    pub const ALL: Self = Self(u64::MAX);

    /// The set of these kinds.
    pub fn of(kinds: &[Kind]) -> Self {
        kinds.iter().fold(Self::NONE, |set, kind| set.union(kind.set()))
    }

    /// Union of the two sets.
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// This set without `kind`.
    pub fn without(self, kind: Kind) -> Self {
        Self(self.0 & !kind.set().0)
    }

    /// Returns true if the sets have a kind in common.
    pub fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Returns true if `kind` is in the set.
    pub fn contains(self, kind: Kind) -> bool {
        self.intersects(kind.set())
    }
}

impl Kind {
    /// The set that contains only this kind.
    pub fn set(self) -> KindSet {
        KindSet(1 << self as u8)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn set_operations() {
        let set = KindSet::of(&[Kind::Pose, Kind::Contact]);
        assert!(set.contains(Kind::Pose) && set.contains(Kind::Contact) && !set.contains(Kind::Call));
        assert!(!set.without(Kind::Pose).contains(Kind::Pose));
        assert!(!set.intersects(Kind::Hint.set()));
        assert!(Kind::ALL.iter().all(|kind| KindSet::ALL.contains(*kind)));
    }
}
