//! A drive and its maps. Each scan of the drive has the readings, the robot's pose by odometry, and its true pose.

use anyhow::{bail, ensure};
use mapping::grid::Grid;
use mapping::pose::{Pose, wrapped};
use mapping::score::{Occupancy, Score, Truth};
use mapping::sector::{Raster, Scan, SectorMap};
use mapping::tracker::{Correction, Tracker};

use super::rooms::Case;
use crate::trace::{Event, Trace};
use crate::wu::maps::{FAN, truth};

/// A drive in the frame of its start.
pub struct Drive {
    /// Name of the room and the start.
    pub name: String,
    /// Ground truth.
    pub truth: Grid<Truth>,
    /// Length of the path, m.
    pub path: f64,
    /// Number of contacts.
    pub contacts: usize,
    /// Scans of each stop, with poses by odometry; each scan has its true pose.
    stops: Vec<Vec<(Scan, Pose)>>,
}

/// Poses of a drive's scans, and the map with these poses.
pub struct Track {
    /// Pose of each scan.
    pub poses: Vec<Pose>,
    /// The map.
    pub map: Grid<Occupancy>,
    /// Score of the map.
    pub score: Score,
    /// Root mean square over the scans of the pose error: the norm of its position part (m) and heading part (rad).
    pub error: f64,
    /// Error of position (m) and heading (rad) at the last scan.
    pub end: (f64, f64),
}

impl Drive {
    /// Reads a drive from its trace.
    ///
    /// # Errors
    /// If the robot printed anything other than scans, stops and rows, or no scan.
    pub fn new(case: &Case, trace: &Trace) -> anyhow::Result<Self> {
        let (mut path, mut contacts) = (0.0, 0);
        let (mut at, mut scans, mut stops) = (case.start, Vec::new(), Vec::new());
        for entry in trace.of_robot(1) {
            match &entry.event {
                Event::Pose { x_m, y_m, phi_rad } => {
                    let next = Pose::new(*x_m, *y_m, *phi_rad);
                    path += (next.position - at.position).norm();
                    at = next;
                }
                Event::Contact => contacts += 1,
                Event::Stdout { text } => {
                    for line in text.lines() {
                        match line.split_once(' ') {
                            Some(("look", scan)) => {
                                let heading = wrapped(at.heading - case.start.heading);
                                scans.push((scan.parse()?, Pose { position: case.start.inward(at.position), heading }));
                            }
                            Some(("stop", _)) => stops.push(std::mem::take(&mut scans)),
                            Some(("row", _)) => {}
                            _ => bail!("`{line}`: expected `look`, `stop` or `row`"),
                        }
                    }
                }
                _ => {}
            }
        }
        ensure!(stops.iter().any(|stop| !stop.is_empty()), "no scan");
        let truth = truth(case.walls.iter().copied(), &case.frame());
        Ok(Self { name: case.start_name.clone(), truth, path, contacts, stops })
    }

    /// Number of scans.
    pub fn scans(&self) -> usize {
        self.stops.iter().map(Vec::len).sum()
    }

    /// The track with the true poses.
    pub fn exact(&self) -> Track {
        self.track(self.stops.iter().flatten().map(|(_, truth)| *truth).collect())
    }

    /// The track with the poses of odometry.
    pub fn raw(&self) -> Track {
        self.track(self.stops.iter().flatten().map(|(scan, _)| scan.robot).collect())
    }

    /// The track with corrected poses.
    pub fn corrected(&self, correction: Correction) -> Track {
        self.track(self.poses(correction))
    }

    /// Corrected poses of all scans.
    pub fn poses(&self, correction: Correction) -> Vec<Pose> {
        let mut tracker = Tracker::new(*self.truth.frame(), FAN, Raster::PointByPoint, correction);
        let mut poses = Vec::new();
        for stop in &self.stops {
            poses.extend(stop.iter().map(|(scan, _)| tracker.scan(scan).robot));
            tracker.end_stop();
        }
        poses
    }

    fn track(&self, poses: Vec<Pose>) -> Track {
        let mut map = SectorMap::new(*self.truth.frame(), FAN, Raster::PointByPoint);
        let mut next = poses.iter();
        let (mut square, mut end) = (0.0, (0.0, 0.0));
        for stop in &self.stops {
            let mut readings = Vec::new();
            for ((scan, truth), pose) in stop.iter().zip(&mut next) {
                readings.extend(Scan { robot: *pose, ..scan.clone() }.readings(FAN.sector));
                end = ((pose.position - truth.position).norm(), wrapped(pose.heading - truth.heading));
                square += end.0 * end.0 + end.1 * end.1;
            }
            map.add(&readings);
        }
        let map = map.probabilities().map(|probability| Occupancy::of(*probability));
        let score = Score::of(&map, &self.truth);
        Track { score, map, error: (square / poses.len() as f64).sqrt(), end, poses }
    }
}
