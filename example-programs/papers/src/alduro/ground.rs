//! Random terrains, both as the text of a scene and as true heights.

use std::fmt::Write as _;

use anyhow::Context as _;
use glam::DVec2;
use sim_core::scene::{Boulders, Disc, HeightField, RandomTerrain};

/// A terrain of boulders over relief.
#[derive(Clone, Debug)]
pub struct Terrain(pub RandomTerrain);

impl Terrain {
    /// A terrain with the boulders of `seed` on a square of `side` m.
    pub fn new(seed: u64, side: f64, relief: f64, boulders: Boulders, clear: Vec<Disc>) -> Self {
        let size = DVec2::splat(side);
        let boulders = Some(boulders);
        let (origin, base, cell, relief_height, hill_length) = (DVec2::ZERO, 0.0, 0.1, relief, 4.0);
        Self(RandomTerrain { seed, origin, size, base, cell, relief_height, hill_length, boulders, clear })
    }

    /// The true heights.
    ///
    /// # Errors
    /// If the terrain has no size.
    pub fn field(&self) -> anyhow::Result<HeightField> {
        Ok(self.0.field().context("the terrain")?.0)
    }

    /// Table `[world]` of a scene with the terrain. The soil scatters sound like a rough surface.
    pub fn world(&self) -> String {
        let RandomTerrain { seed, size, cell, relief_height, hill_length, boulders, clear, .. } = &self.0;
        let mm = |metres: f64| metres * 1e3;
        let mut text = format!(
            "[world]\nfloor_mm = [{}, {}]\nsurface = {{ specular = 0 }}\n\n[world.terrain]\nfunction = \"boulders\"\nseed = {seed}\n\
             cell_mm = {}\nrelief_mm = {}\nlength_mm = {}\n",
            mm(size.x),
            mm(size.y),
            mm(*cell),
            mm(*relief_height),
            mm(*hill_length)
        );
        if let Some(Boulders { count, radius: [r0, r1], height: [h0, h1] }) = boulders {
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "boulders = {count}\nradius_mm = [{}, {}]\nheight_mm = [{}, {}]",
                mm(*r0),
                mm(*r1),
                mm(*h0),
                mm(*h1)
            );
        }
        for Disc { centre, radius } in clear {
            let (x, y, radius) = (mm(centre.x), mm(centre.y), mm(*radius));
            let _ = writeln!(text, "\n[[world.terrain.clear]]\nx_mm = {x}\ny_mm = {y}\nradius_mm = {radius}");
        }
        text
    }
}
