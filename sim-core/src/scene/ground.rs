//! Ground of legged robots.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::HeightField;

/// Height of the ground as a function of the position.
#[derive(Clone, Debug, Default)]
pub enum Ground {
    /// The floor: the plane z = 0.
    #[default]
    Flat,
    /// Terrain.
    Field(Arc<HeightField>),
}

impl Ground {
    /// Distance of a segment from the ground, m: see [`HeightField::clearance`]. On the flat floor, distances beyond
    /// `max_distance` are exact too.
    pub fn clearance(&self, ends: [DVec3; 2], max_distance: f64) -> f64 {
        match self {
            Self::Flat => self.min_height_above(ends).0,
            Self::Field(field) => field.clearance(ends, max_distance),
        }
    }

    /// Minimum height of the points of a segment above the ground, m, and the point with that height.
    pub fn min_height_above(&self, ends: [DVec3; 2]) -> (f64, DVec3) {
        match self {
            Self::Flat => {
                let lower = if ends[1].z < ends[0].z { ends[1] } else { ends[0] };
                (lower.z, lower)
            }
            Self::Field(field) => field.min_height_above(ends),
        }
    }

    /// Bounds of the ground's height in a disc, m: see [`HeightField::height_bounds_in`].
    pub fn height_bounds_in(&self, centre: DVec2, radius: f64) -> (f64, f64) {
        match self {
            Self::Flat => (0.0, 0.0),
            Self::Field(field) => field.height_bounds_in(centre, radius),
        }
    }

    /// Height of the ground at a point of the world plane, m.
    pub fn height(&self, point: DVec2) -> f64 {
        match self {
            Self::Flat => 0.0,
            Self::Field(field) => field.height(point.x, point.y),
        }
    }
}
