//! Events of a run.

use serde::{Deserialize, Serialize};

/// A batch of events.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Events {
    /// Events in order.
    pub events: Vec<Event>,
    /// Number of other events that the page misses: it was too slow or connected too late, or too many happened at once.
    pub missed: u32,
}

/// Event in a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Event {
    /// Its number within the run, from 1.
    pub number: u32,
    /// Virtual time.
    pub t_s: f64,
    /// Number of the robot; none for the world.
    pub robot: Option<u32>,
    /// Kind as in `docs/trace.md`, such as `contact` or `radio_sent`.
    pub kind: String,
    /// Description in words.
    pub text: String,
    /// Fields as in `docs/trace.md`.
    #[cfg_attr(test, ts(type = "Record<string, unknown>"))]
    pub fields: serde_json::Value,
}
