//! What happens in a run.

use serde::{Deserialize, Serialize};

/// A batch of events.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Events {
    /// In order.
    pub events: Vec<Event>,
    /// How many before them this page has not got, since it was too slow or came too late.
    pub missed: u32,
}

/// Something that happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Event {
    /// Its number within the run, from 1.
    pub number: u32,
    /// Virtual time.
    pub t_s: f64,
    /// Whose it is; none for the world.
    pub robot: Option<u32>,
    /// The name of `docs/trace.md`, such as `contact` or `radio_sent`.
    pub kind: String,
    /// In words.
    pub text: String,
    /// The fields of `docs/trace.md`.
    #[cfg_attr(test, ts(type = "Record<string, unknown>"))]
    pub fields: serde_json::Value,
}
