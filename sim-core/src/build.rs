//! From specs to the things that are simulated.

use std::sync::Arc;

use crate::drive::Model;
use crate::format::{RobiSpec, WorldSpec};
use crate::scene::{Segment, Walls};

/// The static walls of a world; a wall with a thickness becomes the four sides of its rectangle.
pub fn walls(world: &WorldSpec) -> Arc<Walls> {
    let mut segments = Vec::with_capacity(world.walls.len());
    for wall in &world.walls {
        if wall.thickness > 0.0 {
            segments.extend(Segment { a: wall.from, b: wall.to }.thickened(wall.thickness));
        } else {
            segments.push(Segment { a: wall.from, b: wall.to });
        }
    }
    Arc::new(Walls::new(segments))
}

/// The drive and the body of a robot type.
pub fn model(robi: &RobiSpec) -> Model {
    Model {
        kind: robi.drive.kind,
        wheel_diameter: robi.wheel.diameter,
        max_wheel_rate: robi.wheel.max_rate,
        ticks_per_turn: robi.wheel.ticks_per_turn,
        track: robi.wheel.track,
        wheelbase: robi.drive.wheelbase,
        axis_offset: robi.axis_offset,
        max_speed: robi.max_speed,
        max_turn: robi.max_turn,
        body_radius: robi.diameter / 2.0,
        wheel_lag: robi.drive.wheel_lag,
        max_steering: robi.drive.max_steer,
        mass: robi.mass,
        traction: robi.traction,
    }
}
