//! Selects the layers to send to pages: those of the selected robots that have changed, as far as the bandwidth allows.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use sim_core::RobotId;
use sim_host::executive::run::Run;
use sim_host::record::layer::{Layer, Shape};
use sim_view::protocol::{self, LayerContent};

use super::planar;

/// Bytes of layers that pages receive in a second of real time, on average (our choice).
const BYTES_PER_SECOND: f64 = 2e6;

/// The layers that pages received last.
#[derive(Default)]
pub struct ShownLayers {
    shown: BTreeMap<(RobotId, String), Arc<Layer>>,
    /// The instant at which the bandwidth allows another layer.
    next: Option<Instant>,
}

impl ShownLayers {
    /// The layers of `robots` that differ from the shown ones. Layers whose shown version is oldest come first, until
    /// the bandwidth is used up. If the run `is_at_rest`, all changed layers are returned, since no later call might
    /// show the others. `number` is the number of the run.
    pub fn changed(
        &mut self,
        run: &Run,
        robots: impl Iterator<Item = RobotId>,
        number: u32,
        is_at_rest: bool,
    ) -> Vec<protocol::Layer> {
        let mut waiting = Vec::new();
        for id in robots {
            for (name, layer) in &run.robot(id).robios.layers {
                let key = (id, name.clone());
                let before = self.shown.get(&key);
                if before.is_none_or(|before| !Arc::ptr_eq(before, layer)) {
                    waiting.push((before.map(|before| before.at), key, Arc::clone(layer)));
                }
            }
        }
        waiting.sort_by_key(|(at, ..)| *at);
        let now = Instant::now();
        let mut next = self.next.unwrap_or(now).max(now);
        let mut changed = Vec::new();
        for (_, key, layer) in waiting {
            if !is_at_rest && next > now {
                break;
            }
            let (layer, bytes) = (message(&key, &layer, number), self.remember(key, layer));
            next += Duration::from_secs_f64(bytes as f64 / BYTES_PER_SECOND);
            changed.push(layer);
        }
        self.next = Some(next);
        changed
    }

    /// Stores a layer as shown, and returns its approximate number of bytes in a message.
    fn remember(&mut self, key: (RobotId, String), layer: Arc<Layer>) -> usize {
        let bytes = match &layer.shape {
            Shape::Grid(grid) => grid.cells.len(),
            Shape::Points(points) | Shape::Line(points) => points.len() * size_of::<[f32; 3]>(),
        };
        self.shown.insert(key, layer);
        bytes * 4 / 3
    }
}

fn message((robot, name): &(RobotId, String), layer: &Layer, run: u32) -> protocol::Layer {
    let positions = |points: &[[f64; 3]]| {
        let bytes = points.as_flattened().iter().flat_map(|number| (*number as f32).to_le_bytes());
        BASE64_STANDARD.encode(bytes.collect::<Vec<u8>>())
    };
    let content = match &layer.shape {
        Shape::Grid(grid) => LayerContent::Grid {
            corner_m: grid.corner,
            cell_m: grid.cell,
            columns: grid.columns,
            rows: grid.rows,
            cells: BASE64_STANDARD.encode(&grid.cells),
        },
        Shape::Points(points) => LayerContent::Points { positions: positions(points) },
        Shape::Line(points) => LayerContent::Line { positions: positions(points) },
    };
    let (t_s, frame) = (layer.at.seconds(), planar(&layer.world_from_frame));
    protocol::Layer { run, robot: robot.0, name: name.clone(), t_s, frame, content }
}
