//! Free positions for randomly placed robots, objects and walls.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::spec::{Scatter, WallSpec};
use sim_core::noise::Stream;
use sim_core::pose::{Heading, Pose};
use sim_core::scene::{Bounds, Segment, Walls};
use sim_core::unit::{metres_from_mm, mm_from_metres, radians_from_degrees};

/// Maximum number of positions tried for one body.
const MAX_TRIES: u32 = 2000;

/// Smallest side of the cells of the disc index, in metres.
const MIN_CELL: f64 = 0.01;

/// Walls of a world, and occupied discs.
pub(crate) struct FreeSpace {
    walls: Walls,
    thickness: Vec<f64>,
    max_thickness: f64,
    floor: DVec2,
    /// Side of the cells of the disc index, at least the largest diameter of a disc.
    cell: f64,
    /// Centres and radii of the occupied discs, by the cell of the centre.
    discs: BTreeMap<(i64, i64), Vec<(DVec2, f64)>>,
}

impl FreeSpace {
    /// Free space between `walls` on a floor of this size; no disc has a radius larger than `max_radius`.
    pub(crate) fn new<'w>(walls: impl Iterator<Item = &'w WallSpec> + Clone, floor: DVec2, max_radius: f64) -> Self {
        let thickness: Vec<f64> = walls.clone().map(|wall| wall.thickness).collect();
        Self {
            walls: Walls::new(walls.map(|wall| Segment::new(wall.from, wall.to)).collect()),
            max_thickness: thickness.iter().copied().fold(0.0, f64::max),
            thickness,
            floor,
            cell: (2.0 * max_radius).max(MIN_CELL),
            discs: BTreeMap::new(),
        }
    }

    /// Marks the disc at `centre` as occupied.
    pub(crate) fn take(&mut self, centre: DVec2, radius: f64) {
        self.discs.entry(self.cell_of(centre)).or_default().push((centre, radius));
    }

    /// Finds a random pose for a disc and marks it as occupied; `None` if there is no room.
    pub(crate) fn place(&mut self, stream: &mut Stream, radius: f64, scatter: &Scatter) -> Option<Pose> {
        let [low, high] = self.area(scatter);
        let (low, high) = (low + radius, high - radius);
        if low.cmpgt(high).any() {
            return None;
        }
        for _ in 0..MAX_TRIES {
            let (point, turn) = draw_pose(stream, low, high);
            if self.is_free(point, radius + scatter.clearance) {
                self.take(point, radius);
                return Some(Pose::new(point.x, point.y, scatter.heading.unwrap_or(turn)));
            }
        }
        None
    }

    /// Finds a random position for a wall that also avoids the walls `added`; `None` if there is no room.
    pub(crate) fn place_wall(
        &self,
        stream: &mut Stream,
        (length, thickness): (f64, f64),
        scatter: &Scatter,
        added: &[WallSpec],
    ) -> Option<Segment> {
        let [low, high] = self.area(scatter);
        for _ in 0..MAX_TRIES {
            let (centre, turn) = draw_pose(stream, low, high);
            let half = 0.5 * length * Heading::new(scatter.heading.unwrap_or(turn)).direction();
            let wall = Segment::new(round_to_micrometres(centre - half), round_to_micrometres(centre + half));
            let bounds = wall.bounds();
            let is_inside = bounds.min.cmpge(low).all() && bounds.max.cmple(high).all();
            let gap = scatter.clearance + 0.5 * thickness;
            if is_inside && self.is_wall_free(&wall, gap) && is_apart(&wall, gap, added) {
                return Some(wall);
            }
        }
        None
    }

    /// Returns true if a disc overlaps neither walls nor occupied discs.
    pub(crate) fn is_free(&self, centre: DVec2, radius: f64) -> bool {
        let mut is_free = true;
        self.walls.for_each_in(Bounds::of_disc(centre, radius + 0.5 * self.max_thickness), |id, segment| {
            is_free &= segment.distance(centre) >= radius + 0.5 * self.thickness[id.0 as usize];
        });
        let (column, row) = self.cell_of(centre);
        is_free
            && (column - 1..=column + 1)
                .flat_map(|column| (row - 1..=row + 1).map(move |row| (column, row)))
                .filter_map(|cell| self.discs.get(&cell))
                .flatten()
                .all(|(other, other_radius)| centre.distance(*other) >= radius + other_radius)
    }

    /// Returns true if the centre line of a wall has at least the distance `gap` from all discs and from the surfaces
    /// of all walls.
    fn is_wall_free(&self, wall: &Segment, gap: f64) -> bool {
        let mut is_free = true;
        self.walls.for_each_in(wall.bounds().grown(gap + 0.5 * self.max_thickness), |id, other| {
            is_free &= distance(wall, other) >= gap + 0.5 * self.thickness[id.0 as usize];
        });
        is_free && self.discs.values().flatten().all(|(centre, radius)| wall.distance(*centre) >= gap + radius)
    }

    fn area(&self, scatter: &Scatter) -> [DVec2; 2] {
        scatter.area.unwrap_or([DVec2::ZERO, self.floor])
    }

    fn cell_of(&self, point: DVec2) -> (i64, i64) {
        ((point.x / self.cell).floor() as i64, (point.y / self.cell).floor() as i64)
    }
}

/// A random position and heading, rounded to micrometres and thousandths of a degree, so that a text can state both
/// exactly.
fn draw_pose(stream: &mut Stream, low: DVec2, high: DVec2) -> (DVec2, f64) {
    let point = low + (high - low) * DVec2::new(stream.unit(), stream.unit());
    let turn = (360_000.0 * stream.unit()).floor() / 1000.0;
    (round_to_micrometres(point), radians_from_degrees(turn))
}

fn round_to_micrometres(point: DVec2) -> DVec2 {
    let rounded = |metres: f64| metres_from_mm((mm_from_metres(metres) * 1000.0).round() / 1000.0);
    DVec2::new(rounded(point.x), rounded(point.y))
}

/// Returns true if the centre line of a wall has at least the distance `gap` from the surfaces of the walls `others`.
fn is_apart(wall: &Segment, gap: f64, others: &[WallSpec]) -> bool {
    let is_apart_from =
        |other: &WallSpec| distance(wall, &Segment::new(other.from, other.to)) >= gap + 0.5 * other.thickness;
    others.iter().all(is_apart_from)
}

/// Distance between two walls' centre lines; 0 if they cross.
fn distance(one: &Segment, other: &Segment) -> f64 {
    let side = |line: &Segment, point: DVec2| (line.b - line.a).perp_dot(point - line.a);
    let separates = |line: &Segment, ends: &Segment| side(line, ends.a) * side(line, ends.b) < 0.0;
    if separates(one, other) && separates(other, one) {
        return 0.0;
    }
    let distances = [one.distance(other.a), one.distance(other.b), other.distance(one.a), other.distance(one.b)];
    distances.into_iter().fold(f64::INFINITY, f64::min)
}
