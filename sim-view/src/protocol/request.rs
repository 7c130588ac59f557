//! What a page asks for.

use serde::{Deserialize, Serialize};

use super::Action;

/// What a page says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "type", rename_all = "snake_case", deny_unknown_fields)]
pub enum Request {
    /// The first message of a page.
    Hello {
        /// The page's version of the protocol.
        protocol: u32,
        /// The teacher's token, where the page has one.
        token: Option<String>,
    },
    /// Which robot the page wants to see more of.
    Look {
        /// Number of the robot; none for no robot.
        robot: Option<u32>,
        /// With what its camera sees.
        camera: bool,
        /// With its RoBIOS calls among the events.
        calls: bool,
    },
    /// A command; there is an [`Answer`](super::Answer) to each.
    Act {
        /// The page's own number of the command.
        number: u32,
        /// What to do.
        command: Command,
    },
}

/// What a page can have done.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "command", rename_all = "snake_case", deny_unknown_fields)]
pub enum Command {
    /// Lets the run go on.
    Run {},
    /// Stops it before the next slot.
    Pause {},
    /// Runs one slot and pauses.
    Step {},
    /// Sets the speed.
    Speed {
        /// Simulated seconds for each second of real time; none for as fast as possible.
        factor: Option<f64>,
    },
    /// Starts the run anew, as its files say.
    Restart {
        /// With which seed.
        seed: Seed,
    },
    /// Does something to the simulation.
    Act {
        /// What.
        action: Action,
    },
}

/// Seed of a run that starts anew.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Seed {
    /// That of the run before.
    Same,
    /// One that nobody has chosen.
    New,
    /// This one, in decimal digits: JavaScript has no integers of 64 bits.
    Number(String),
}
