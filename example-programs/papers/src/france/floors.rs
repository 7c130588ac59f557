//! Floors under the biped, each a function of its kind and seed: the text of a scene, and the true edges.

use std::fmt::Write as _;

use sim_core::RobotId;
use sim_core::noise::{Purpose, Stream};

/// Length and width of the floor, mm. The robot walks along its middle.
const SIZE: [f64; 2] = [11_000.0, 3000.0];
/// Start of the robot, mm along the floor.
const START: f64 = 1000.0;
/// Length of a walk, mm: five strides of the gait and the start.
const WAY: f64 = 7500.0;

/// Kind of floor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Level.
    Flat,
    /// Level, with two holes across the way.
    Holes,
    /// Stairs up.
    Up,
    /// Stairs down.
    Down,
    /// Smooth random relief.
    Uneven,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 5] = [Self::Flat, Self::Holes, Self::Up, Self::Down, Self::Uneven];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Flat => "flat",
            Self::Holes => "holes",
            Self::Up => "stairs up",
            Self::Down => "stairs down",
            Self::Uneven => "uneven",
        }
    }
}

/// A vertical edge across the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Distance ahead of the start, m.
    pub at: f64,
    /// Height behind the edge minus height before it, m.
    pub rise: f64,
    /// Distance on both sides within which there is no other edge, m.
    pub room: f64,
}

/// A floor.
#[derive(Clone, Debug, PartialEq)]
pub struct Floor {
    /// Its kind.
    pub kind: Kind,
    /// Seed of the floor, and of the noise of a walk over it.
    pub seed: u64,
    /// Its edges, in the order of the way.
    pub edges: Vec<Edge>,
    /// Table `[world.terrain]` of a scene.
    terrain: String,
}

impl Floor {
    /// The floor of this kind with this seed. All lengths are uniform between two bounds (our choice), in whole millimetres.
    pub fn new(kind: Kind, seed: u64) -> Self {
        let mut stream = Stream::new(seed, RobotId(0), Purpose::Layout, 0, 0);
        let mut draw = |low: f64, high: f64| (low + (high - low) * stream.unit()).round();
        let [length, width] = SIZE;
        let middle = width / 2.0;
        let mut edges = Vec::new();
        let terrain = match kind {
            Kind::Flat => String::new(),
            Kind::Holes => {
                let depth = draw(80.0, 200.0);
                let mut from = 0.0;
                let mut blocks = Vec::new();
                for (low, high) in [(1800.0, 3000.0), (4000.0, 5500.0)] {
                    let hole = START + draw(low, high);
                    let end = hole + draw(400.0, 800.0);
                    blocks.push((from, hole));
                    edges.extend([(hole, -depth), (end, depth)]);
                    from = end;
                }
                blocks.push((from, length));
                let block = |(from, to): &(f64, f64)| {
                    format!("{{ from_mm = [{from}, 0], to_mm = [{to}, {width}], height_mm = {depth} }}")
                };
                let blocks: Vec<String> = blocks.iter().map(block).collect();
                format!("offset_mm = [0, 0, {}]\nblock = [{}]\n", -depth, blocks.join(", "))
            }
            Kind::Up | Kind::Down => {
                let first = START + draw(2000.0, 3500.0);
                let (count, rise, depth) = (draw(3.0, 5.0), draw(80.0, 140.0), draw(320.0, 450.0));
                let sign = if kind == Kind::Up { 1.0 } else { -1.0 };
                let (mut at, mut last) = (first, first);
                for _ in 0..count as usize {
                    edges.push((at, sign * rise));
                    (last, at) = (at, at + depth);
                }
                // Stairs begin at their lowest step; their landing reaches to the end of the floor.
                let (from, direction, landing, base) = match kind {
                    Kind::Up => (first, 0, length - last, 0.0),
                    _ => (last, 180, first, -count * rise),
                };
                format!(
                    "offset_mm = [0, 0, {base}]\nstairs = [{{ from_mm = [{from}, {middle}], direction_deg = {direction}, count = {count}, \
                     step_height_mm = {rise}, step_depth_mm = {depth}, landing_mm = {landing}, width_mm = {width} }}]\n"
                )
            }
            Kind::Uneven => {
                let relief = draw(80.0, 160.0);
                format!("function = \"hills\"\nseed = {seed}\nrelief_mm = {relief}\nlength_mm = 1000\ncell_mm = 50\n")
            }
        };
        let gaps: Vec<f64> = edges.windows(2).map(|pair: &[(f64, f64)]| pair[1].0 - pair[0].0).collect();
        let room = |index: usize| {
            let before = index.checked_sub(1).map_or(f64::INFINITY, |gap| gaps[gap]);
            before.min(gaps.get(index).copied().unwrap_or(f64::INFINITY))
        };
        let edge = |(index, (at, rise)): (usize, &(f64, f64))| Edge {
            at: (at - START) / 1e3,
            rise: rise / 1e3,
            room: room(index) / 1e3,
        };
        let edges = edges.iter().enumerate().map(edge).collect();
        Self { kind, seed, edges, terrain }
    }

    /// Scene of a walk of a biped over the floor at `speed` mm/s; its program reads `sensors`, in the words of the program `walker`.
    pub fn scene(&self, robi: &str, speed: u32, sensors: &[String]) -> String {
        let mut arguments = format!("\"scan\", \"{speed}\", \"{WAY}\"");
        for sensor in sensors {
            // Writing to a string cannot fail.
            let _ = write!(arguments, ", \"{sensor}\"");
        }
        let terrain = if self.terrain.is_empty() { "" } else { "\n[world.terrain]\n" };
        format!(
            "[scene]\nuntil_s = 20\n\n[world]\nfloor_mm = [{}, {}]\n{terrain}{}\n[[robot]]\ntype = \"{robi}\"\n\
             program = \"%sim%/example-programs/walker\"\narguments = [{arguments}]\nx_mm = {START}\ny_mm = {}\napi = 7\n",
            SIZE[0],
            SIZE[1],
            self.terrain,
            SIZE[1] / 2.0
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_are_where_the_text_says() {
        for seed in 0..20 {
            let holes = Floor::new(Kind::Holes, seed);
            let rises: Vec<f64> = holes.edges.iter().map(|edge| edge.rise).collect();
            assert_eq!((rises.len(), rises.iter().sum::<f64>()), (4, 0.0));
            assert!(holes.edges.windows(2).all(|pair| pair[1].at - pair[0].at >= 0.4));
            for (kind, sign) in [(Kind::Up, 1.0), (Kind::Down, -1.0)] {
                let stairs = Floor::new(kind, seed);
                assert!(
                    (3..=5).contains(&stairs.edges.len()) && stairs.edges.iter().all(|edge| sign * edge.rise > 0.0)
                );
            }
            assert_eq!(Floor::new(Kind::Flat, seed).edges, []);
        }
        assert_ne!(Floor::new(Kind::Up, 1), Floor::new(Kind::Up, 2));
    }
}
