//! What legged robots walk on.

use std::sync::Arc;

use glam::DVec2;

use super::HeightField;

/// The height of the ground at every place.
#[derive(Clone, Debug, Default)]
pub enum Ground {
    /// The floor: the plane z = 0.
    #[default]
    Flat,
    /// Terrain.
    Field(Arc<HeightField>),
}

impl Ground {
    /// Height of the ground at a place of the world, m.
    pub fn height(&self, place: DVec2) -> f64 {
        match self {
            Self::Flat => 0.0,
            Self::Field(field) => field.height(place.x, place.y),
        }
    }
}
