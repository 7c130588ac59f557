//! The radio of a scene: what carries messages between its robots.

use crate::line::Quantity;
use crate::table::{Reader, Section};
use sim_core::radio::{Medium, Model};

/// Media, in the order of [`Medium`].
const MEDIA: [&str; 3] = ["free", "aloha", "token_ring"];

/// Fastest radio, bits a second.
const MAX_BAUD: i64 = 1_000_000_000;

const LATENCY: Quantity = Quantity::milliseconds("latency");
const RANGE: Quantity = Quantity::size("range");

impl Reader<'_> {
    /// `[radio]`.
    pub(super) fn radio(&mut self, mut section: Section<'_, '_>) -> Model {
        let usual = Model::default();
        let medium = self.choice(&mut section, "medium", &MEDIA).map(|place| match MEDIA[place] {
            "aloha" => Medium::Aloha,
            "token_ring" => Medium::TokenRing,
            _ => Medium::Free,
        });
        let baud = self.integer(&mut section, "baud", 1, MAX_BAUD).map(|baud| baud as u32);
        let latency = self.whole_micros(&mut section, "latency_ms", &LATENCY);
        let range = self.number(&mut section, "range_mm", &RANGE);
        let line_of_sight = self.flag(&mut section, "line_of_sight");
        self.unknown_keys(&section);
        Model {
            medium: medium.unwrap_or(usual.medium),
            baud: baud.unwrap_or(usual.baud),
            latency: latency.unwrap_or(usual.latency),
            range,
            line_of_sight: line_of_sight.unwrap_or(usual.line_of_sight),
        }
    }
}
