//! Free positions for robots with a random start.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::spec::WorldSpec;
use sim_core::RobotId;
use sim_core::noise::{Purpose, Stream};
use sim_core::pose::Pose;
use sim_core::scene::{Bounds, Segment, Walls};

/// Number of positions tried for one robot before the room counts as full.
const TRIES: u32 = 2000;

/// Smallest side of the cells of the disc index, in metres.
const MIN_CELL: f64 = 0.01;

/// Walls of a world and discs that must not overlap.
pub(crate) struct FreeSpace {
    walls: Walls,
    thickness: Vec<f64>,
    thickest: f64,
    floor: DVec2,
    /// Side of the cells, so large that no disc reaches beyond the cells next to its own.
    cell: f64,
    discs: BTreeMap<(i64, i64), Vec<(DVec2, f64)>>,
}

impl FreeSpace {
    /// Free space of `world`, for discs with a radius of at most `widest`.
    pub(crate) fn new(world: &WorldSpec, widest: f64) -> Self {
        let thickness: Vec<f64> = world.walls.iter().map(|wall| wall.thickness).collect();
        Self {
            walls: Walls::new(world.walls.iter().map(|wall| Segment::new(wall.from, wall.to)).collect()),
            thickest: thickness.iter().copied().fold(0.0, f64::max),
            thickness,
            floor: world.floor,
            cell: (2.0 * widest).max(MIN_CELL),
            discs: BTreeMap::new(),
        }
    }

    /// Marks the disc at `centre` as occupied.
    pub(crate) fn take(&mut self, centre: DVec2, radius: f64) {
        self.discs.entry(self.cell_of(centre)).or_default().push((centre, radius));
    }

    /// Places a disc at a random pose within `area` (default: the floor), at least `clearance` from walls and occupied discs, with
    /// `heading` if given. Returns `None` if no pose is found.
    ///
    /// Random numbers come from the stream of `robot`, so they do not depend on the number of attempts for other robots.
    pub(crate) fn place(
        &mut self,
        seed: u64,
        robot: RobotId,
        radius: f64,
        (area, clearance, heading): (Option<[DVec2; 2]>, f64, Option<f64>),
    ) -> Option<Pose> {
        let [low, high] = area.unwrap_or([DVec2::ZERO, self.floor]);
        let (low, high) = (low + radius, high - radius);
        if low.cmpgt(high).any() {
            return None;
        }
        let mut stream = Stream::new(seed, robot, Purpose::Layout, 0, 0);
        for _ in 0..TRIES {
            let place = low + (high - low) * DVec2::new(stream.unit(), stream.unit());
            let turn = std::f64::consts::TAU * stream.unit();
            if self.is_free(place, radius + clearance) {
                self.take(place, radius);
                return Some(Pose::new(place.x, place.y, heading.unwrap_or(turn)));
            }
        }
        None
    }

    fn is_free(&self, centre: DVec2, radius: f64) -> bool {
        let mut is_free = true;
        self.walls.for_each_in(Bounds::of_disc(centre, radius + 0.5 * self.thickest), |id, segment| {
            is_free &= segment.distance(centre) >= radius + 0.5 * self.thickness[id.0 as usize];
        });
        let (column, row) = self.cell_of(centre);
        is_free
            && (column - 1..=column + 1)
                .flat_map(|column| (row - 1..=row + 1).map(move |row| (column, row)))
                .filter_map(|cell| self.discs.get(&cell))
                .flatten()
                .all(|(other, reach)| centre.distance(*other) >= radius + reach)
    }

    fn cell_of(&self, place: DVec2) -> (i64, i64) {
        ((place.x / self.cell).floor() as i64, (place.y / self.cell).floor() as i64)
    }
}
