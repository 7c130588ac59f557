//! Speed against error: brute-force oracles and naive integrators that the core is compared with.
//!
//! [`oracle`] answers the questions of `sim_core` the slow and plain way; [`world`] makes the random scenes, rays and
//! mazes on which the two are compared, the same for tests and benches; [`study`] measures how far off each method is and how
//! long it takes, for `eyesim accuracy`.
#![forbid(unsafe_code)]

pub mod oracle;
pub mod study;
pub mod world;
