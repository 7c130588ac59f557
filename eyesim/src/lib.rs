//! The command `eyesim` as a library, used by the binary and by other callers such as the Python package: everything
//! except running programs.
//!
//! [`cli`] is the command line. Below it, [`suite`] runs the cases of suites in a pool of processes, [`sweep`] and
//! [`grade`] build on it, [`pack`] reads and writes archives, [`plot`] draws pictures from above, and `window` shows
//! runs in a browser. Programs are run by [`sim_host`].

pub mod cli;
#[cfg(feature = "grading")]
pub mod grade;
pub mod pack;
pub mod plot;
pub mod suite;
pub mod sweep;
#[cfg(feature = "window")]
pub mod window;
