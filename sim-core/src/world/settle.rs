//! The contacts between bodies within a slot, in the order in which they happen.

use super::World;
use crate::{drive::Motion, time::Time};

pub(super) fn settle(_world: &World, _active: &mut [&mut Motion]) {}

/// Lets bodies go on at `at` that another one had stopped and does not any more.
pub(super) fn resume(_world: &World, _active: &mut [&mut Motion], _at: Time) {}
