//! Requests of a page.

use serde::{Deserialize, Serialize};

use super::Action;

/// Message of a page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Request {
    /// The first message of a page.
    Hello {
        /// The page's version of the protocol.
        protocol: u32,
        /// The teacher's token, if the page has one.
        token: Option<String>,
    },
    /// Selects the robot whose details the page gets.
    Look {
        /// Number of the robot; none for no robot.
        robot: Option<u32>,
        /// True to include pictures of its camera.
        camera: bool,
        /// True to include its RoBIOS calls in the events.
        calls: bool,
    },
    /// A command; the server sends an [`Answer`](super::Answer) to each.
    Act {
        /// Number of the command, chosen by the page.
        number: u32,
        /// The command.
        command: Command,
    },
}

/// Command of a page.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "command", rename_all = "snake_case", deny_unknown_fields)]
pub enum Command {
    /// Continues the run.
    Run {},
    /// Pauses the run before the next slot.
    Pause {},
    /// Runs one slot and pauses.
    Step {},
    /// Sets the speed.
    Speed {
        /// Simulated seconds for each second of real time; none for as fast as possible.
        factor: Option<f64>,
    },
    /// Restarts the run from its files.
    Restart {
        /// Seed of the new run.
        seed: Seed,
    },
    /// Applies a user intervention.
    Act {
        /// The intervention.
        action: Action,
    },
}

/// Seed of a restarted run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Seed {
    /// Seed of the previous run.
    Same,
    /// New random seed.
    New,
    /// This seed, in decimal digits: JavaScript has no integers of 64 bits.
    Number(String),
}
