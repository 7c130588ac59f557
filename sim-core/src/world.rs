//! (world)
