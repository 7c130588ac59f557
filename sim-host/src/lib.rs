//! Runs of robot programs in simulated worlds, as a library: the command `eyesim` and the Python package use it.
//!
//! ```no_run
//! use sim_core::RobotId;
//! use sim_core::time::Time;
//! use sim_host::launch::{Observers, Options, Scene};
//!
//! # fn main() -> Result<(), sim_host::launch::Error> {
//! let options = Options { seed: Some(7), noise: Some("real".into()), ..Options::default() };
//! let finished = Scene::open("sims/demo.sim", options.clone())?.load()?.run()?; // to its end
//! for robot in &finished.report.robots {
//!     println!("{} {:?} {:?}", robot.name, robot.outcome, robot.reason);
//! }
//!
//! let mut running = Scene::open("sims/demo.sim", options)?.load()?.start(Observers::default())?; // step by step
//! running.scheduler.advance_to(Time::from_millis(1_000));
//! println!("{:?}", running.scheduler.run().robot(RobotId(1)).now);
//! println!("{}", running.finish().report.digest);
//! # Ok(())
//! # }
//! ```
//!
//! Start at [`launch`]: scenes, options, runs, results. Below it, [`executive`] runs the programs' flows over a
//! simulation of `sim_core`, [`robios`] implements the calls, [`program`] finds, builds and loads programs, and
//! [`mod@record`] contains the sinks of the record. A simulation without programs does not need this crate: see
//! `sim_core::simulation`.

pub mod check;
pub mod executive;
pub mod launch;
pub mod record;
pub mod robios;
pub mod scenery;

pub use sim_program as program;
pub use sim_program::{files, host};
