//! Speed against error: brute-force oracles and naive integrators that the core is compared with.
//!
//! [`oracle`] answers the questions of `sim_core` the slow and plain way, [`camera`] sees what cameras see, one ray a place,
//! [`course`] is a long drive with an end known to 30 digits (by numbers of two doubles, [`wide`]), and [`touch`] are contacts
//! whose instants are known. [`statistics`] says whether a sample is what it should be. [`world`] makes the random scenes, rays
//! and mazes on which they are compared, the same for tests and benches, [`room`] what cameras are compared on, [`board`] a
//! calibration target; [`study`] measures how far off each method is and how long it takes, for `eyesim accuracy`.
#![forbid(unsafe_code)]

pub mod board;
pub mod camera;
pub mod course;
pub mod oracle;
pub mod room;
pub mod statistics;
pub mod study;
pub mod touch;
pub mod wide;
pub mod world;
