//! Map of Wu et al. 2013: lines between the readings of neighbouring sonars, drawn into a grid.
//!
//! The sonars are on the rim of a round robot, one sector apart, and each beam is as wide as its sector. A reading is
//! an arc that touches the nearest surface of the sector at some point; the neighbours' readings determine this point.
//! A [`Fan`] converts readings to a [`Model`] of lines. A [`SectorMap`] draws the models of one stop into a local grid
//! (Eq. 2 and 3) and merges this grid into the global one (Eq. 4).
//!
//! Source: Wu et al. 2013, "Environmental Modeling Based on Ultrasonic Ranging". The docs of the items, and
//! `docs/mapping.md`, list the errors and omissions of the text with our solutions.

use std::cmp::Ordering;
use std::fmt;
use std::str::FromStr;

use crate::grid::{Cell, Grid, GridGeometry};
use crate::line;
use crate::math;
use crate::pose::{Point, Pose, direction, wrapped};
use crate::sonar::polar;

/// Probability of a cell without information.
pub const UNKNOWN: f64 = 0.5;

/// Sonars around a robot. Lengths in metres, angles in radians.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Fan {
    /// The angle of a sector; also the angle between neighbouring sonars.
    pub sector: f64,
    /// The radius of the robot; the sonars are on its rim.
    pub radius: f64,
    /// Minimum distance that a sonar measures, R_min.
    pub nearest: f64,
    /// Maximum distance that a sonar measures, R_max.
    pub farthest: f64,
}

/// Relation between the readings of two neighbours ("Sensor Number and Definitions").
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Relation {
    /// d_A <= d_B <= d_A / cos a, where a is the angle of a sector: one straight wall can cause both readings. At the
    /// upper limit, the wall's foot is at the far edge of A's sector, and B measures the wall at the near edge of its
    /// own sector. The paper prints "d_A cos a", which no d_B satisfies.
    Continuous,
    /// d_A / cos a < d_B <= d_A + 2 r: too far apart for one wall, too near for the robot to pass.
    Interval,
    /// d_B > d_A + 2 r: the robot may fit between the two surfaces.
    Gap,
    /// At least one of the readings is without an echo.
    Open,
}

/// Cases of a sector ("Modeling Process").
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Case {
    /// Continuous on both sides, with one neighbour's reading smaller and the other's larger (Figure 2a): a wall whose
    /// foot is in the sector of the smaller reading.
    WallBeside,
    /// Continuous on both sides, with the smallest of the three readings (Figure 2b): a wall whose foot is in the
    /// sector.
    WallAhead,
    /// Continuous on both sides, with the largest of the three readings (Figure 2c): a corner.
    Corner,
    /// Fault on the far side: continuous on one side only, where the neighbour's reading is not larger (Figure 3a).
    FaultBeyond,
    /// Fault on the near side: continuous on one side only, where the neighbour's reading is larger (Figure 3b).
    FaultBefore,
    /// Continuous on neither side (Figure 4).
    FaultBothSides,
    /// No echo: the sector is free up to R_max, or has a mirror (Eq. 3).
    NoEcho,
}

/// A straight line segment, in metres.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Line {
    /// One end.
    pub from: Point,
    /// The other end.
    pub to: Point,
}

/// Model of the surfaces in a sector.
#[derive(Clone, PartialEq, Debug)]
pub struct Model {
    /// Case of the sector.
    pub case: Case,
    /// The lines in counter-clockwise order, in the sector's frame: origin in the robot's centre, x axis through the
    /// sonar.
    pub lines: Vec<Line>,
}

/// Fraction of a sector, centred at its axis, that the line of a fault on both sides covers. The paper has only the
/// word "short"; the value is our choice.
const SHORT_FRACTION: f64 = 0.5;

/// Maximum difference of readings that are treated as equal, in metres: two steps of a sonar with a resolution of 1 cm
/// (our choice).
pub const EQUAL_READINGS: f64 = 0.02;

impl Fan {
    /// Relation between two neighbouring readings; `None` is a reading without an echo.
    ///
    /// The distances are in metres from the rim, as the sonars measure them; the comparison uses distances from the
    /// robot's centre, where the sectors meet.
    pub fn relation(&self, a: Option<f64>, b: Option<f64>) -> Relation {
        let (Some(a), Some(b)) = (a, b) else { return Relation::Open };
        let (near, far) = (a.min(b) + self.radius, a.max(b) + self.radius);
        // A wall whose foot is at the far edge gives exactly the limit, which rounding must not exclude.
        if far <= near / math::cos(self.sector) * (1.0 + 1e-9) {
            Relation::Continuous
        } else if far <= near + 2.0 * self.radius {
            Relation::Interval
        } else {
            Relation::Gap
        }
    }

    /// The lines of a sector from its own reading and those of its neighbours to the right and to the left, in metres
    /// from the rim.
    ///
    /// Our choices where the paper gives no rule:
    ///
    /// - Readings count as equal within [`EQUAL_READINGS`]. Three equal readings are `WallAhead`. Two are `WallBeside`,
    ///   on the side of the neighbour whose reading is not larger; otherwise a line would cut off a corner that lies at
    ///   a common edge.
    /// - Open on both sides (a post): the same as other faults on both sides.
    /// - A sector at the end of the fan has one neighbour. The other one is `None`, so the relation to it is open.
    /// - Length of the line of a one-sided fault: up to the axis of the sector (`FaultBeyond`), since the surface is
    ///   known only at the common edge; up to the tangent point (`FaultBefore`), from which the echo came.
    pub fn model(&self, right: Option<f64>, own: Option<f64>, left: Option<f64>) -> Model {
        let Some(own_distance) = own else { return Model { case: Case::NoEcho, lines: Vec::new() } };
        let if_continuous = |other: Option<f64>| match other {
            Some(other) if self.relation(own, Some(other)) == Relation::Continuous => Some(other + self.radius),
            _ => None,
        };
        let own = own_distance + self.radius;
        let (case, lines) = match (if_continuous(right), if_continuous(left)) {
            (Some(right), Some(left)) => self.wall(right, own, left),
            (Some(right), None) => self.fault(right, own),
            (None, Some(left)) => {
                let (case, line) = self.fault(left, own);
                (case, line.into_iter().map(mirrored).collect())
            }
            (None, None) => (Case::FaultBothSides, vec![self.short_line(own)]),
        };
        Model { case, lines }
    }

    /// Case and lines of a sector that is continuous on both sides. All distances are from the centre of the robot.
    fn wall(&self, right: f64, own: f64, left: f64) -> (Case, Vec<Line>) {
        let half_sector = 0.5 * self.sector;
        let compared_to_own =
            |other: f64| if (other - own).abs() <= EQUAL_READINGS { Ordering::Equal } else { other.total_cmp(&own) };
        let (right_order, left_order) = (compared_to_own(right), compared_to_own(left));
        if right_order.is_lt() && left_order.is_lt() {
            let (from_right, from_left) =
                (Tangent::at_right(self, right, own), Tangent::at_right(self, left, own).mirrored());
            let corner = from_right.intersection(from_left);
            let (from, to) = (own * direction(-half_sector), own * direction(half_sector));
            (Case::Corner, vec![Line { from: from.into(), to: corner }, Line { from: corner, to: to.into() }])
        } else if right_order == left_order {
            let (from, middle, to) =
                (right * direction(-half_sector), own * direction(0.0), left * direction(half_sector));
            let (from, middle, to) = (from.into(), middle.into(), to.into());
            (Case::WallAhead, vec![Line { from, to: middle }, Line { from: middle, to }])
        } else {
            // The smaller neighbouring reading may exceed this sector's by up to `EQUAL_READINGS`. It is then treated
            // as equal, and the tangent touches the arc at the common edge.
            let tangent = Tangent::at_right(self, right.min(left).min(own), own);
            let end = tangent.normal + math::acos(tangent.distance / right.max(left).max(own));
            let line = tangent.segment(-half_sector, end.clamp(-half_sector, half_sector));
            (Case::WallBeside, vec![if right < left { line } else { mirrored(line) }])
        }
    }

    /// Case and lines of a sector that is continuous only with its right neighbour. All distances are from the centre
    /// of the robot.
    fn fault(&self, right: f64, own: f64) -> (Case, Vec<Line>) {
        let half_sector = 0.5 * self.sector;
        if right <= own {
            (Case::FaultBeyond, vec![Tangent::at_right(self, right, own).segment(-half_sector, 0.0)])
        } else {
            // The line goes through the end of the neighbour's arc at the common edge and touches the arc of this
            // sector.
            let normal = -half_sector + math::acos(own / right);
            let tangent = Tangent { normal, distance: own };
            (Case::FaultBefore, vec![tangent.segment(-half_sector, normal)])
        }
    }

    /// The short line of a fault on both sides; it touches the arc at its midpoint.
    fn short_line(&self, own: f64) -> Line {
        let end = 0.5 * SHORT_FRACTION * self.sector;
        Tangent { normal: 0.0, distance: own }.segment(-end, end)
    }

    /// Probabilities of the cells of a line and of the free cells in front of it, for the reading of their sector (Eq.
    /// 2).
    pub fn probabilities(&self, distance: f64) -> (f64, f64) {
        let fraction = ((distance - self.nearest) / (self.farthest - self.nearest)).clamp(0.0, 1.0);
        ((1.0 - fraction * fraction).max(0.6), (fraction * fraction).min(0.4))
    }

    /// Probability of the cells of a sector without an echo (Eq. 3). It is the mean of two probabilities: of free cells
    /// in front of an echo at R_max, and of cells behind a mirror, S, which are unknown (S = 0.5: our choice).
    pub fn silent_probability(&self) -> f64 {
        0.5 * (self.probabilities(self.farthest).1 + UNKNOWN)
    }
}

/// A straight line, given by the direction of its normal from the origin, in radians, and its distance from the origin.
#[derive(Clone, Copy, Debug)]
struct Tangent {
    normal: f64,
    distance: f64,
}

impl Tangent {
    /// The line that touches the arc of the right neighbour and goes through the end of this sector's arc at
    /// the common edge ("the reverse extension line of the arc tangent").
    fn at_right(fan: &Fan, neighbour: f64, own: f64) -> Self {
        Self { normal: -0.5 * fan.sector - math::acos(neighbour / own), distance: neighbour }
    }

    /// The line mirrored at the x axis.
    fn mirrored(self) -> Self {
        Self { normal: -self.normal, ..self }
    }

    /// Point of the line in the direction `angle` from the origin.
    fn point(self, angle: f64) -> Point {
        Point::from(direction(angle) * (self.distance / math::cos(angle - self.normal)))
    }

    /// Segment of the line between two directions from the origin.
    fn segment(self, first: f64, last: f64) -> Line {
        Line { from: self.point(first), to: self.point(last) }
    }

    /// Intersection with another line that is not parallel.
    fn intersection(self, other: Self) -> Point {
        let (a, b) = (direction(self.normal), direction(other.normal));
        let determinant = a.x * b.y - a.y * b.x;
        Point::new(
            (self.distance * b.y - other.distance * a.y) / determinant,
            (other.distance * a.x - self.distance * b.x) / determinant,
        )
    }
}

/// The line mirrored at the x axis.
fn mirrored(line: Line) -> Line {
    let flipped = |point: Point| Point::new(point.x, -point.y);
    Line { from: flipped(line.to), to: flipped(line.from) }
}

impl Line {
    /// Distance from the origin, in metres, at which a ray in the direction `angle` (radians) hits the line.
    fn distance_along(&self, angle: f64) -> Option<f64> {
        let (from, delta, ray) = (self.from.coords, self.to - self.from, direction(angle));
        let cross = |a: crate::pose::Vector, b: crate::pose::Vector| a.x * b.y - a.y * b.x;
        let (first_angle, last_angle) = (math::atan2(self.from.y, self.from.x), math::atan2(self.to.y, self.to.x));
        (angle >= first_angle && angle <= last_angle).then(|| cross(from, delta) / cross(ray, delta))
    }
}

impl Model {
    /// Free distance from the robot's centre at an angle (radians) from the sector's axis: up to the line or to the
    /// arc at `own`, whichever is nearer.
    fn free_distance(&self, own: f64, angle: f64) -> f64 {
        self.lines.iter().find_map(|line| line.distance_along(angle)).map_or(own, |line| line.min(own))
    }
}

/// Algorithm that draws lines into the grid.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Raster {
    /// Point-by-point comparison, which the paper uses.
    PointByPoint,
    /// DDA, which the paper also mentions.
    Dda,
}

/// Reading of one sector.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Reading {
    /// Position of the robot's centre in the map's frame, and heading of the sector's axis.
    pub axis: Pose,
    /// The distance from the rim, in metres; `None` without an echo.
    pub distance: Option<f64>,
}

/// Readings of all sonars at one instant.
///
/// As text, a scan is the robot's x, y and heading, then the distances from right to left with `-` for no echo, in
/// metres and radians. Printing and parsing are exact inverses.
#[derive(Clone, PartialEq, Debug)]
pub struct Scan {
    /// The robot's pose in the map's frame.
    pub robot: Pose,
    /// The distances, from right to left; the middle sonar points ahead.
    pub distances: Vec<Option<f64>>,
}

impl Scan {
    /// The readings of the sectors, whose axes are `sector` radians apart.
    pub fn readings(&self, sector: f64) -> impl Iterator<Item = Reading> {
        let middle = 0.5 * (self.distances.len() as f64 - 1.0);
        self.distances.iter().enumerate().map(move |(index, distance)| {
            let heading = wrapped(self.robot.heading + (index as f64 - middle) * sector);
            Reading { axis: Pose { heading, ..self.robot }, distance: *distance }
        })
    }

    /// Returns true if a sector with an echo has a fault on a side: the robot must turn and observe the sector again.
    pub fn has_fault(&self, fan: &Fan) -> bool {
        self.distances
            .windows(2)
            .any(|pair| pair != [None, None] && fan.relation(pair[0], pair[1]) != Relation::Continuous)
    }
}

impl fmt::Display for Scan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Pose { position, heading } = self.robot;
        write!(f, "{:?} {:?} {heading:?}", position.x, position.y)?;
        self.distances.iter().try_for_each(|distance| match distance {
            Some(distance) => write!(f, " {distance:?}"),
            None => f.write_str(" -"),
        })
    }
}

/// Error for a text that is not a [`Scan`].
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
#[error("`{0}` is not a scan: expected x, y, heading and distances")]
pub struct NotAScan(String);

impl FromStr for Scan {
    type Err = NotAScan;

    fn from_str(text: &str) -> Result<Self, NotAScan> {
        let number = |token: &str| token.parse::<f64>().ok().filter(|number| number.is_finite());
        let distance = |token: &str| if token == "-" { Some(None) } else { number(token).map(Some) };
        let mut tokens = text.split_whitespace();
        let mut parsed = || {
            let mut next = || tokens.next().and_then(number);
            let robot = Pose::new(next()?, next()?, next()?);
            Some(Self { robot, distances: tokens.by_ref().map(distance).collect::<Option<_>>()? })
        };
        parsed().ok_or_else(|| NotAScan(text.to_owned()))
    }
}

/// The map of Wu et al.: the global grid of probabilities.
#[derive(Clone, PartialEq, Debug)]
pub struct SectorMap {
    fan: Fan,
    raster: Raster,
    cells: Grid<f64>,
}

impl SectorMap {
    /// A map with all cells unknown.
    pub fn new(frame: GridGeometry, fan: Fan, raster: Raster) -> Self {
        Self { fan, raster, cells: Grid::new(frame, UNKNOWN) }
    }

    /// The probability of each cell of being occupied.
    pub fn probabilities(&self) -> &Grid<f64> {
        &self.cells
    }

    /// Adds all readings of one stop, at all headings to which the robot turned there.
    pub fn add(&mut self, readings: &[Reading]) {
        let local = local_map(self.cells.frame(), &self.fan, self.raster, readings);
        for (value, new) in self.cells.values_mut().iter_mut().zip(local.values()) {
            *value = updated(*value, *new);
        }
    }
}

/// Global probability of a cell after merging a local one (Eq. 4): the one farther from 0.5, or the old one if both are
/// equally far from it.
///
/// A confident error is therefore never corrected by any number of less confident readings; log-odds
/// ([`log_odds`](crate::log_odds)) correct it.
pub fn updated(old: f64, new: f64) -> f64 {
    if (new - UNKNOWN).abs() > (old - UNKNOWN).abs() { new } else { old }
}

/// Local grid of one stop: the models of all sectors, in the cells of the global frame.
///
/// The cells under the robot are free. Sectors overlap after the robot turned at a fault. There, a line's cell is
/// dropped if it is in the core of another sector and nearer than that sector's arc, since the other sonar would have
/// received its echo. Then occupied takes precedence over free, and a more certain value over a less certain one.
pub fn local_map(frame: &GridGeometry, fan: &Fan, raster: Raster, readings: &[Reading]) -> Grid<f64> {
    let sectors: Vec<Sector> = readings.iter().map(|reading| Sector::new(fan, reading, readings)).collect();
    let mut occupied = Grid::new(*frame, UNKNOWN);
    let mut free = Grid::new(*frame, UNKNOWN);
    for sector in &sectors {
        sector.mark_free(fan, &mut free);
        sector.mark_lines(fan, raster, &sectors, &mut occupied);
    }
    for reading in readings {
        for cell in frame.disc(reading.axis.position, fan.radius) {
            (free[cell], occupied[cell]) = (0.0, UNKNOWN);
        }
    }
    Grid::from_fn(*frame, |cell| if occupied[cell] > UNKNOWN { occupied[cell] } else { free[cell] })
}

/// A reading with its model.
struct Sector {
    axis: Pose,
    distance: Option<f64>,
    model: Model,
}

/// Maximum deviation of the angle between neighbours from one sector, as a fraction of a sector.
const TOLERANCE: f64 = 0.2;

/// Fraction of a sector, centred at its axis, in which its sonar certainly detects surfaces.
const CORE: f64 = 0.8;

impl Sector {
    fn new(fan: &Fan, reading: &Reading, readings: &[Reading]) -> Self {
        let neighbour = |angle: f64| {
            let deviation = |other: &&Reading| wrapped(other.axis.heading - reading.axis.heading - angle).abs();
            let nearest = readings.iter().min_by(|a, b| deviation(a).total_cmp(&deviation(b)))?;
            if deviation(&nearest) <= TOLERANCE * fan.sector { nearest.distance } else { None }
        };
        let model = fan.model(neighbour(-fan.sector), reading.distance, neighbour(fan.sector));
        Self { axis: reading.axis, distance: reading.distance, model }
    }

    /// Marks the cells in front of the lines as free, from the rim on: a surface nearer than R_min would have hidden
    /// the echo.
    fn mark_free(&self, fan: &Fan, free: &mut Grid<f64>) {
        let frame = *free.frame();
        let (max_distance, probability) = match self.distance {
            None => (fan.radius + fan.farthest, fan.silent_probability()),
            Some(distance) => {
                let ends = self.model.lines.iter().flat_map(|line| [line.from.coords.norm(), line.to.coords.norm()]);
                (ends.fold(fan.radius + distance, f64::max), fan.probabilities(distance).1)
            }
        };
        for cell in frame.disc(self.axis.position, max_distance) {
            let (distance, angle) = polar(self.axis, frame.centre(cell));
            let is_in_front = |own: f64| distance < self.model.free_distance(fan.radius + own, angle);
            if angle.abs() <= 0.5 * fan.sector && self.distance.is_none_or(is_in_front) {
                free[cell] = free[cell].min(probability);
            }
        }
    }

    /// Marks the cells of the lines as occupied, except cells that another sector shows to be free.
    fn mark_lines(&self, fan: &Fan, raster: Raster, sectors: &[Self], occupied: &mut Grid<f64>) {
        let Some(distance) = self.distance else { return };
        let frame = *occupied.frame();
        let (probability, _) = fan.probabilities(distance);
        for line in &self.model.lines {
            for cell in line_cells(&frame, raster, self.axis.outward(line.from), self.axis.outward(line.to)) {
                if !sectors.iter().any(|other| other.shows_free(fan, &frame, cell)) {
                    occupied[cell] = occupied[cell].max(probability);
                }
            }
        }
    }

    /// Returns true if a surface in the cell would have caused an echo before that of this sector.
    fn shows_free(&self, fan: &Fan, frame: &GridGeometry, cell: Cell) -> bool {
        let Some(own) = self.distance else { return false };
        let (distance, angle) = polar(self.axis, frame.centre(cell));
        angle.abs() <= 0.5 * CORE * fan.sector && distance + frame.cell_size() < fan.radius + own
    }
}

/// Cells of a line that are in the grid.
fn line_cells(frame: &GridGeometry, raster: Raster, from: Point, to: Point) -> Vec<Cell> {
    // A line may be partly outside the grid, so its cells are determined in a larger grid, and the cells outside
    // `frame` are dropped.
    let margin = ((to - from).norm() / frame.cell_size()).ceil() + 2.0;
    let origin = frame.origin() - crate::pose::Vector::repeat(margin * frame.cell_size());
    let enlarged = |cells: usize| cells + 2 * margin as usize;
    let larger = GridGeometry::new(origin, frame.cell_size(), enlarged(frame.columns()), enlarged(frame.rows()));
    let (Some(from), Some(to)) = (larger.cell_at(from), larger.cell_at(to)) else { return Vec::new() };
    let cells = match raster {
        Raster::PointByPoint => line::point_by_point(from, to),
        Raster::Dda => line::dda(from, to),
    };
    let back = -(margin as i64);
    cells.into_iter().filter_map(|cell| cell.offset(back, back)).filter(|cell| frame.has(*cell)).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use proptest::prelude::*;

    use super::*;
    use crate::log_odds::{LogOddsGrid, log_odds};

    const FAN: Fan = Fan { sector: PI / 6.0, radius: 0.12, nearest: 0.03, farthest: 4.0 };
    const HALF: f64 = PI / 12.0;

    /// Reading of a sector in front of an infinite straight wall: the point nearest to the robot's centre within the
    /// sector.
    fn wall_reading(sector: f64, foot: f64, distance: f64) -> Option<f64> {
        let off = (wrapped(foot - sector).abs() - HALF).max(0.0);
        (off < 0.5 * PI - 1e-6)
            .then(|| distance / math::cos(off) - FAN.radius)
            .filter(|reading| *reading <= FAN.farthest)
    }

    fn check_on_wall(lines: &[Line], foot: f64, distance: f64, tolerance: f64) {
        for line in lines {
            for point in [line.from, line.to] {
                let error = point.coords.dot(&direction(foot)) - distance;
                assert!(error.abs() <= tolerance, "foot at {foot}: {point} is {error} m off");
            }
        }
    }

    #[test]
    fn relation_changes_at_its_limits() {
        let check = |a: f64, b: f64, expected| {
            let (a, b) = (Some(a - FAN.radius), Some(b - FAN.radius));
            assert_eq!((FAN.relation(a, b), FAN.relation(b, a)), (expected, expected), "{a:?} {b:?}");
        };
        let limit = 1.0 / math::cos(FAN.sector);
        check(1.0, 1.0, Relation::Continuous);
        check(1.0, limit, Relation::Continuous);
        check(1.0, limit + 1e-6, Relation::Interval);
        check(1.0, 1.24 - 1e-9, Relation::Interval);
        check(1.0, 1.24 + 1e-9, Relation::Gap);
        // At a large distance d no relation is an interval, since d / cos a - d is more than 2 r.
        check(2.0, 2.0 * limit + 1e-6, Relation::Gap);
        for pair in [(None, Some(1.0)), (Some(1.0), None), (None, None)] {
            assert_eq!(FAN.relation(pair.0, pair.1), Relation::Open);
        }
    }

    #[test]
    fn printed_condition_of_continuity_is_never_satisfied() {
        // No d_B satisfies d_A <= d_B <= d_A cos a. A wall whose foot is at the far edge of A's sector gives exactly
        // d_B = d_A / cos a.
        let a = wall_reading(0.0, -HALF, 1.0);
        let b = wall_reading(FAN.sector, -HALF, 1.0);
        let (a, b) = (a.expect("an echo") + FAN.radius, b.expect("an echo") + FAN.radius);
        assert!(a <= b && b > a * math::cos(FAN.sector));
        assert!((b - a / math::cos(FAN.sector)).abs() < 1e-12);
    }

    #[test]
    fn wall_beside_is_exact() {
        for foot in [-1.4 * HALF, -2.0 * HALF, -2.9 * HALF] {
            let readings = [-FAN.sector, 0.0, FAN.sector].map(|sector| wall_reading(sector, foot, 1.0));
            let model = FAN.model(readings[0], readings[1], readings[2]);
            if model.case == Case::WallBeside {
                check_on_wall(&model.lines, foot, 1.0, 1e-12);
            } else {
                // The relation to the far neighbour is not continuous, so the line is only half as long.
                assert_eq!(model.case, Case::FaultBeyond);
                check_on_wall(&model.lines, foot, 1.0, 1e-12);
                assert!((model.lines[0].to.y).abs() < 1e-12);
            }
            let model = FAN.model(readings[2], readings[1], readings[0]);
            check_on_wall(&model.lines, -foot, 1.0, 1e-12);
        }
    }

    #[test]
    fn wall_ahead_is_exact_except_for_the_bulge_of_the_arc() {
        for foot in [0.0, 0.1 * HALF, -0.2 * HALF] {
            let readings = [-FAN.sector, 0.0, FAN.sector].map(|sector| wall_reading(sector, foot, 1.0));
            let model = FAN.model(readings[0], readings[1], readings[2]);
            assert_eq!((model.case, model.lines.len()), (Case::WallAhead, 2));
            // The ends are on the wall; the midpoint of the arc is in front of it by 1 - cos(foot).
            check_on_wall(&model.lines, foot, 1.0, 1.0 - math::cos(foot) + 1e-12);
            assert!((model.lines[0].from.coords.dot(&direction(foot)) - 1.0).abs() < 1e-12);
            assert!((model.lines[1].to.coords.dot(&direction(foot)) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn corner_of_two_walls_is_exact() {
        // Two walls with their feet in the neighbours' sectors, mirror images about the sector's axis, so they meet
        // the two edges of the sector at the same distance.
        for off in [1.9 * HALF, 2.4 * HALF, 2.9 * HALF] {
            let own = 1.0 / math::cos(off - HALF) - FAN.radius;
            let model = FAN.model(Some(1.0 - FAN.radius), Some(own), Some(1.0 - FAN.radius));
            assert_eq!(model.case, Case::Corner);
            check_on_wall(&model.lines[..1], -off, 1.0, 1e-12);
            check_on_wall(&model.lines[1..], off, 1.0, 1e-12);
            let corner = 1.0 / math::cos(off);
            assert!((model.lines[0].to - Point::new(corner, 0.0)).norm() < 1e-12);
        }
    }

    #[test]
    fn faults_give_one_line_of_the_right_case() {
        let far = Some(2.0);
        for (right, own, left, case) in [
            (Some(0.9), Some(0.95), far, Case::FaultBeyond),
            (Some(0.9), Some(0.95), None, Case::FaultBeyond),
            (None, Some(0.95), Some(0.9), Case::FaultBeyond),
            (Some(0.95), Some(0.9), far, Case::FaultBefore),
            (far, Some(0.9), Some(0.95), Case::FaultBefore),
            (far, Some(0.9), far, Case::FaultBothSides),
            (None, Some(0.9), far, Case::FaultBothSides),
            (None, Some(0.9), None, Case::FaultBothSides),
            (Some(0.5), Some(0.9), Some(0.5), Case::FaultBothSides),
            (Some(0.9), None, Some(0.9), Case::NoEcho),
        ] {
            let model = FAN.model(right, own, left);
            assert_eq!(
                (model.case, model.lines.len()),
                (case, usize::from(own.is_some())),
                "{right:?} {own:?} {left:?}"
            );
        }
        // Figure 3b: the line goes from the neighbour's arc at the common edge to the point where it touches this
        // sector's arc.
        let line = FAN.model(Some(0.95), Some(0.9), None).lines[0];
        let (edge, touched) = (line.from.coords, line.to.coords);
        assert!((edge.norm() - 1.07).abs() < 1e-12 && (math::atan2(edge.y, edge.x) + HALF).abs() < 1e-12);
        assert!((touched.norm() - 1.02).abs() < 1e-12 && touched.dot(&(edge - touched)).abs() < 1e-12);
    }

    #[test]
    fn probabilities_match_equations_2_and_3() {
        let is_close = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0).abs() < 1e-12 && (a.1 - b.1).abs() < 1e-12;
        assert!(is_close(FAN.probabilities(0.03), (1.0, 0.0)));
        assert!(is_close(FAN.probabilities(0.03 + 3.97 * 0.5), (0.75, 0.25)));
        assert!(is_close(FAN.probabilities(0.03 + 3.97 * 0.9), (0.6, 0.4)));
        assert!(is_close(FAN.probabilities(4.0), (0.6, 0.4)));
        assert!((FAN.silent_probability() - 0.45).abs() < 1e-12);
    }

    #[test]
    fn equation_4_keeps_a_confident_error_and_log_odds_correct_it() {
        let (wrong, right) = (0.98, 0.03);
        let mut by_equation_4 = updated(UNKNOWN, wrong);
        let cell = Cell::new(0, 0);
        let mut by_log_odds = LogOddsGrid::new(GridGeometry::new(Point::origin(), 1.0, 1, 1));
        by_log_odds.add(cell, log_odds(wrong));
        for _ in 0..1000 {
            by_equation_4 = updated(by_equation_4, right);
        }
        by_log_odds.add(cell, log_odds(right));
        assert_eq!(by_equation_4, updated(wrong, 1.0 - wrong + 1e-12));
        assert_eq!(by_equation_4, wrong);
        by_log_odds.add(cell, log_odds(right));
        assert!(by_log_odds.probabilities()[cell] < 0.05);
        // Only a value with more confidence than the error replaces the error.
        assert_eq!(updated(wrong, 0.01), 0.01);
    }

    /// Readings of a stop in the middle of a square room of 2 m; each is the distance of the nearest point of a wall in
    /// the sector.
    fn room_readings(turns: &[f64]) -> Vec<Reading> {
        let headings = turns.iter().flat_map(|turn| (0..12).map(move |sector| turn + f64::from(sector) * FAN.sector));
        headings
            .map(|heading| {
                let walls = (0..4).filter_map(|wall| wall_reading(heading, f64::from(wall) * 0.5 * PI, 1.0));
                let distance = walls.min_by(f64::total_cmp);
                Reading { axis: Pose::new(1.05, 1.05, heading), distance }
            })
            .collect()
    }

    #[test]
    fn room_is_mapped_from_its_middle() {
        let frame = GridGeometry::new(Point::new(-0.2, -0.2), 0.1, 25, 25);
        for raster in [Raster::PointByPoint, Raster::Dda] {
            let mut map = SectorMap::new(frame, FAN, raster);
            map.add(&room_readings(&[0.0, HALF]));
            let mut occupied = 0;
            for (cell, probability) in map.probabilities().iter() {
                // Walls at 0.05 and 2.05.
                let centre = frame.centre(cell);
                let wall_distance = 1.0 - (centre.x - 1.05).abs().max((centre.y - 1.05).abs());
                occupied += usize::from(*probability >= 0.6);
                assert!(*probability < 0.6 || wall_distance.abs() < 0.15, "{centre} is occupied");
                assert!(*probability > 0.4 || wall_distance > -0.05, "{centre} is free");
            }
            assert!(occupied >= 60, "{occupied} of 80 cells of the walls");
            assert_eq!(map.probabilities().at(Point::new(1.05, 1.05)), Some(&0.0));
        }
    }

    #[test]
    fn scan_parses_its_printed_form() {
        let scan = Scan { robot: Pose::new(0.1, -2.0, 1.0 / 3.0), distances: vec![Some(0.7), None, Some(1e-3)] };
        assert_eq!(scan.to_string(), "0.1 -2.0 0.3333333333333333 0.7 - 0.001");
        assert_eq!(scan.to_string().parse(), Ok(scan.clone()));
        for text in ["", "1 2", "1 2 x", "1 2 3 4 y", "1 2 NaN"] {
            assert_eq!(text.parse::<Scan>(), Err(NotAScan(text.to_owned())));
        }
        let headings: Vec<f64> = scan.readings(0.5).map(|reading| reading.axis.heading).collect();
        assert!(
            headings.iter().zip([-0.5, 0.0, 0.5]).all(|(heading, offset)| (heading - offset - 1.0 / 3.0).abs() < 1e-12)
        );
        assert!(scan.has_fault(&FAN) && !Scan { distances: vec![Some(1.0), Some(1.1)], ..scan }.has_fault(&FAN));
    }

    #[test]
    fn lines_are_clipped_at_the_grid() {
        let frame = GridGeometry::new(Point::origin(), 0.1, 5, 5);
        let cells = line_cells(&frame, Raster::Dda, Point::new(-1.0, 0.25), Point::new(3.0, 0.25));
        assert_eq!(cells, (0..5).map(|column| Cell::new(column, 2)).collect::<Vec<_>>());
    }

    proptest! {
        #[test]
        fn lines_are_not_nearer_than_the_reading(
            right in prop::option::of(0.05..4.0f64), own in 0.05..4.0f64, left in prop::option::of(0.05..4.0f64),
        ) {
            let model = FAN.model(right, Some(own), left);
            for line in &model.lines {
                for fraction in [0.0, 0.25, 0.5, 0.75, 1.0] {
                    let point = line.from + fraction * (line.to - line.from);
                    let angle = math::atan2(point.y, point.x);
                    prop_assert!(angle.abs() <= HALF + 1e-9);
                    // A chord that ends at the midpoint of the arc runs inside the arc, by less than the arc's bulge.
                    prop_assert!(point.coords.norm() >= (own + FAN.radius) * math::cos(HALF) - 1e-9, "{:?}", model);
                    prop_assert!(point.coords.norm() < 2.1 * (own + FAN.radius), "{:?}", model);
                }
            }
        }
    }
}
