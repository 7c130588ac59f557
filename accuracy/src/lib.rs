//! Speed and error of the core, compared with those of brute-force oracles and of simple integrators.
//!
//! [`oracle`] solves the problems of `sim_core` by brute force, [`camera`] renders with one ray per image point,
//! [`course`] is a long drive whose end is known to 30 digits (double-double arithmetic, [`wide`]), [`touch`] has
//! contacts at known instants, and [`slide`] integrates the sliding of a disc along walls in small steps.
//! [`comparison`] tunes all methods in the same way and compares them on held-out cases; [`statistics`] tests samples
//! against their distributions. [`world`] generates the random scenes, rays and mazes shared by tests and benches,
//! [`room`] the scene for comparing cameras, [`board`] a calibration target. [`study`] measures the error and the time
//! of each method, for `eyesim accuracy`. [`figure`] describes a chart; without the feature `studies` it is the only
//! module.
#![forbid(unsafe_code)]

#[cfg(feature = "studies")]
pub mod board;
#[cfg(feature = "studies")]
pub mod camera;
#[cfg(feature = "studies")]
pub mod comparison;
#[cfg(feature = "studies")]
pub mod course;
pub mod figure;
#[cfg(feature = "studies")]
pub mod oracle;
#[cfg(feature = "studies")]
pub mod room;
#[cfg(feature = "studies")]
pub mod slide;
#[cfg(feature = "studies")]
pub mod statistics;
#[cfg(feature = "studies")]
pub mod study;
#[cfg(feature = "studies")]
pub mod touch;
#[cfg(feature = "studies")]
pub mod wide;
#[cfg(feature = "studies")]
pub mod world;
