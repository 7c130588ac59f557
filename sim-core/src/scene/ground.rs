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
    /// Distance of a segment from the ground, see [`HeightField::clearance`]; over the flat floor the distance is exact
    /// even beyond `within`.
    pub fn clearance(&self, ends: [DVec3; 2], within: f64) -> f64 {
        match self {
            Self::Flat => self.min_height_above(ends).0,
            Self::Field(field) => field.clearance(ends, within),
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

    /// Minimum and maximum height in a disc, m: see [`HeightField::range_in`].
    pub fn range_in(&self, centre: DVec2, radius: f64) -> (f64, f64) {
        match self {
            Self::Flat => (0.0, 0.0),
            Self::Field(field) => field.range_in(centre, radius),
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
