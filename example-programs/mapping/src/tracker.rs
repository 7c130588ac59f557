//! Builds the map of sonar sectors ([`sector`](crate::sector)) from corrected poses: each scan (the readings of all
//! sonars at one instant) corrects the pose that odometry gives.
//!
//! A [`Tracker`] adds the motion since the last scan to its [`Belief`]. It corrects the belief by comparing the scan's
//! readings with the map so far, from all earlier stops and the earlier scans of this stop. Readings go into the map
//! with the corrected pose. The map itself is that of Wu et al. 2013, unchanged. Earlier poses are never corrected
//! again.
//!
//! Source: incremental maximum-likelihood mapping, Thrun, Burgard & Fox 2005, section 13.2 (one map, where a particle
//! filter keeps a map for each particle). Our choice: a scan is also compared with the earlier scans of its own stop.
//! After the robot has turned around at a stop, the readings from before the turn are already in the map.

use crate::grid::{Grid, GridGeometry};
use crate::localise::{Belief, OdometryNoise};
use crate::measurement::{Error, LikelihoodField, Points};
use crate::pose::{Point, Pose};
use crate::score::OCCUPIED;
use crate::sector::{Fan, Raster, Reading, Scan, SectorMap};

/// Settings of the pose correction.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Correction {
    /// Error distribution of a reading.
    pub error: Error,
    /// Errors of odometry.
    pub odometry: OdometryNoise,
}

/// A map with the robot's corrected pose.
#[derive(Clone, Debug)]
pub struct Tracker {
    fan: Fan,
    correction: Correction,
    map: SectorMap,
    belief: Belief,
    odometry: Pose,
    readings: Vec<Reading>,
}

impl Tracker {
    /// Starts with an empty map. The robot's pose in the map's frame is (0, 0) with the heading 0, known exactly.
    pub fn new(frame: GridGeometry, fan: Fan, raster: Raster, correction: Correction) -> Self {
        let start = Pose::new(0.0, 0.0, 0.0);
        Self {
            fan,
            correction,
            map: SectorMap::new(frame, fan, raster),
            belief: Belief::certain(start),
            odometry: start,
            readings: Vec::new(),
        }
    }

    /// The map of all stops that have ended.
    pub fn map(&self) -> &SectorMap {
        &self.map
    }

    /// Distribution of the pose at the last scan.
    pub fn belief(&self) -> &Belief {
        &self.belief
    }

    /// Corrects the pose with `scan`, whose `robot` is the pose by odometry, and keeps its readings for the map.
    /// Returns the scan with the corrected pose.
    pub fn scan(&mut self, scan: &Scan) -> Scan {
        self.belief = self.belief.moved(&self.odometry, &scan.robot, &self.correction.odometry);
        self.odometry = scan.robot;
        self.belief = self.corrected(scan);
        let corrected = Scan { robot: self.belief.mean, distances: scan.distances.clone() };
        self.readings.extend(corrected.readings(self.fan.sector));
        corrected
    }

    /// Ends a stop: adds its readings to the map.
    pub fn end_stop(&mut self) {
        self.map.add(&self.readings);
        self.readings.clear();
    }

    fn corrected(&self, scan: &Scan) -> Belief {
        let mut map = self.map.clone();
        map.add(&self.readings);
        let map: &Grid<f64> = map.probabilities();
        let field = LikelihoodField::new(map, |probability| *probability >= OCCUPIED, &self.correction.error);
        let readings = points(scan, &self.fan, map.frame().cell_size());
        self.belief.corrected(&Points { field: &field, readings })
    }
}

/// Directions of the sonars in the robot's frame, rad, from right to left.
fn angles(scan: &Scan, fan: &Fan) -> impl Iterator<Item = f64> + use<> {
    let (count, sector) = (scan.distances.len(), fan.sector);
    (0..count).map(move |index| (index as f64 - 0.5 * (count as f64 - 1.0)) * sector)
}

/// For each sector, points on the lines of its model, in the robot's frame, m. Neighbouring points of a line are at
/// most `apart` from each other.
fn points(scan: &Scan, fan: &Fan, apart: f64) -> Vec<Vec<Point>> {
    let at = |index: usize| scan.distances.get(index).copied().flatten();
    let of_sector = |(index, angle): (usize, f64)| {
        let model = fan.model(index.checked_sub(1).and_then(at), at(index), at(index + 1));
        let sector = Pose::new(0.0, 0.0, angle);
        let along = |line: &crate::sector::Line| {
            let (from, to) = (sector.outward(line.from), sector.outward(line.to));
            let count = ((to - from).norm() / apart).ceil().max(1.0) as usize;
            (0..=count).map(move |step| from + (to - from) * (step as f64 / count as f64)).collect::<Vec<Point>>()
        };
        model.lines.iter().flat_map(along).collect()
    };
    angles(scan, fan).enumerate().map(of_sector).collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_6, PI};

    use super::*;
    use crate::pose::{Vector, wrapped};
    use crate::sonar::polar;

    const FAN: Fan = Fan { sector: FRAC_PI_6, radius: 0.12, nearest: 0.03, farthest: 4.0 };

    /// A room of 4 m x 3 m with a box, as closely spaced points.
    fn room() -> Vec<Point> {
        let corners = |points: &[[f64; 2]]| points.iter().map(|[x, y]| Point::new(*x, *y)).collect::<Vec<_>>();
        let outlines = [
            corners(&[[-1.0, -1.0], [3.0, -1.0], [3.0, 2.0], [-1.0, 2.0], [-1.0, -1.0]]),
            corners(&[[1.2, 0.8], [1.8, 0.8], [1.8, 1.4], [1.2, 1.4], [1.2, 0.8]]),
        ];
        let along = |pair: &[Point]| {
            let (from, to) = (pair[0], pair[1]);
            (0..2000).map(move |index| from + (to - from) * (f64::from(index) / 2000.0)).collect::<Vec<_>>()
        };
        outlines.iter().flat_map(|outline| outline.windows(2).flat_map(along)).collect()
    }

    fn distances(room: &[Point], robot: &Pose) -> Vec<Option<f64>> {
        let of_sonar = |index: i32| {
            let heading = robot.heading + f64::from(index) * FAN.sector;
            let position = robot.position + crate::pose::direction(heading) * FAN.radius;
            let polar_points = room.iter().map(|point| polar(Pose { position, heading }, *point));
            let in_sector = polar_points.filter(|(_, off)| off.abs() <= 0.5 * FAN.sector);
            let distances = in_sector.map(|(distance, _)| distance);
            distances.min_by(f64::total_cmp).filter(|distance| *distance <= FAN.farthest)
        };
        (-3..=3).map(of_sonar).collect()
    }

    /// Odometry turns too far and drifts to one side; the tracker removes most of this error.
    #[test]
    fn drift_is_taken_back() {
        let room = room();
        let correction = Correction {
            error: Error { sigma: 0.04, outlier: 0.1 },
            odometry: OdometryNoise { turn: 0.05, drift: 0.05, distance: 0.05 },
        };
        let frame = GridGeometry::covering(Point::new(-1.1, -1.1), Point::new(3.1, 2.1), 0.05);
        let mut tracker = Tracker::new(frame, FAN, Raster::PointByPoint, correction);
        let (mut truth, mut odometry) = (Pose::new(0.0, 0.0, 0.0), Pose::new(0.0, 0.0, 0.0));
        let off = |pose: &Pose, truth: &Pose| {
            ((pose.position - truth.position).norm(), wrapped(pose.heading - truth.heading).abs())
        };
        let mut worst = [(0.0_f64, 0.0_f64); 2];
        for stop in 0..10 {
            for turn in [0.0, 0.5 * FAN.sector, PI] {
                (truth, odometry) =
                    (truth.then(&Pose::new(0.0, 0.0, turn)), odometry.then(&Pose::new(0.0, 0.0, 1.03 * turn)));
                let scan = Scan { robot: odometry, distances: distances(&room, &truth) };
                let corrected = tracker.scan(&scan).robot;
                for (worst, pose) in worst.iter_mut().zip([&corrected, &odometry]) {
                    let (distance, turned) = off(pose, &truth);
                    *worst = (worst.0.max(distance), worst.1.max(turned));
                }
            }
            tracker.end_stop();
            let way = Vector::new(if stop < 5 { 0.25 } else { -0.25 }, if stop % 2 == 0 { 0.15 } else { -0.15 });
            let step = Pose { position: truth.inward(truth.position + way), heading: 0.0 };
            truth = truth.then(&step);
            odometry = odometry.then(&Pose { position: step.position * 1.03, heading: 0.01 });
        }
        let [corrected, raw] = worst;
        assert!(corrected.0 < 0.25 * raw.0 && corrected.1 < 0.5 * raw.1, "corrected {corrected:?}, raw {raw:?}");
    }
}
