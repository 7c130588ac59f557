//! Distance sensors: PSD sensors, which measure on request, and the laser scanner.

use robios_sys::ByteBuffer;
use robios_sys::robios7::MAX_LIDAR_POINTS;

use super::Robot;
use crate::device::Device;
use crate::error::checked;
use crate::psd::{RawDistance, Signal};
use crate::robot::robios7;
use crate::unit::{Angle, Length};
use crate::{Error, Result};

/// Reading of a sensor with nothing in range, in millimetres.
const OUT_OF_RANGE_MM: i32 = 9999;

/// Name of a PSD sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PsdAt {
    /// `PSD_FRONT`
    Front,
    /// `PSD_LEFT`
    Left,
    /// `PSD_RIGHT`
    Right,
    /// `PSD_BACK`
    Back,
    /// Sensor named only in the robi file: its number, 1 to 6.
    Other(u8),
}

impl PsdAt {
    /// Number of the sensor.
    pub const fn number(self) -> u8 {
        match self {
            Self::Front => 1,
            Self::Left => 2,
            Self::Right => 3,
            Self::Back => 4,
            Self::Other(number) => number,
        }
    }

    const fn device(self) -> Device {
        Device::Numbered("PSD sensor", self.number())
    }
}

/// A PSD distance sensor.
#[derive(Clone, Copy, Debug)]
pub struct Psd<'r> {
    robot: &'r Robot,
    at: PsdAt,
}

/// The laser scanner.
#[derive(Clone, Copy, Debug)]
pub struct Lidar<'r>(&'r Robot);

/// A scan: distances from left to right.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    distances: Vec<Option<Length>>,
    spacing: Angle,
}

impl Robot {
    /// A distance sensor; measures once to check that the sensor exists.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the robot has no such sensor.
    #[track_caller]
    pub fn psd(&self, at: PsdAt) -> Result<Psd<'_>> {
        let psd = Psd { robot: self, at };
        let distance_mm: i32 = robios7!(self, PSDGet(at.number().into()));
        // 0 also means an obstacle right at the sensor.
        if distance_mm == 0 && psd.signal().is_none() { Err(Error::Unavailable(at.device())) } else { Ok(psd) }
    }

    /// The laser scanner: all around, with the points of the robi file, unless changed by [`Lidar::set`]. For a robi file
    /// with another range, call [`Lidar::set`].
    pub fn lidar(&self) -> Lidar<'_> {
        Lidar(self)
    }
}

impl Psd<'_> {
    /// Name of the sensor.
    pub fn at(&self) -> PsdAt {
        self.at
    }

    /// Current distance; `None` if out of range.
    #[track_caller]
    pub fn distance(&self) -> Option<Length> {
        within_range(robios7!(self.robot, PSDGet(self.at.number().into())))
    }

    /// Signal underlying the current distance; `None` if there is no such sensor. An extension of this simulator.
    #[track_caller]
    pub fn signal(&self) -> Option<Signal> {
        Signal::from_robios(robios7!(self.robot, PSDGetSignal(self.at.number().into())))
    }

    /// Current raw value.
    #[track_caller]
    pub fn raw(&self) -> RawDistance {
        let raw: i32 = robios7!(self.robot, PSDGetRaw(self.at.number().into()));
        RawDistance(raw.clamp(0, 255) as u8)
    }
}

impl Lidar<'_> {
    /// Sets the scan: `range` is the angle covered, half of it to either side of straight ahead; `tilt` is the upward
    /// tilt of the scanner; `points` is the number of points, at most 65,535.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a range outside 1 to 360 degrees, a tilt outside -90 to 90 degrees, or no points.
    #[track_caller]
    pub fn set(&self, range: Angle, tilt: Angle, points: u16) -> Result {
        let (range_deg, tilt_deg) = (range.to_robios7(), tilt.to_robios7());
        if !(1..=360).contains(&range_deg) || !(-90..=90).contains(&tilt_deg) || points == 0 {
            return Err(Error::OutOfRange {
                what: "setting of a scan",
                value: format!("{range:.0} in {points} points, tilted by {tilt:.0}"),
                accepted: "1 to 360 degrees in 1 to 65535 points, tilted by -90 to 90 degrees",
            });
        }
        let () = robios7!(self.0, LIDARSet(range_deg, tilt_deg, points.into()));
        self.0.settings().scan_range_deg.set(range_deg);
        Ok(())
    }

    /// Scans once.
    ///
    /// # Errors
    /// [`Error::Refused`] if the robot has no scanner.
    #[track_caller]
    pub fn scan(&self) -> Result<Scan> {
        let range_deg = self.0.settings().scan_range_deg.get();
        // The scanner sets as many distances as it has points; none is negative.
        let mut distances_mm = vec![-1_i32; MAX_LIDAR_POINTS];
        let buffer = ByteBuffer { data: distances_mm.as_mut_ptr().cast(), len: distances_mm.len() };
        checked("LIDARGet", Device::Lidar, robios7!(self.0, LIDARGet(buffer)))?;
        let points = distances_mm.iter().position(|mm| *mm < 0).unwrap_or(MAX_LIDAR_POINTS);
        distances_mm.truncate(points);
        let spacings = if range_deg == 360 || points % 2 == 0 { points } else { points - 1 };
        Ok(Scan {
            distances: distances_mm.into_iter().map(within_range).collect(),
            spacing: Angle::degrees(f64::from(range_deg) / spacings.max(1) as f64),
        })
    }
}

impl Scan {
    /// Distances from left to right; `None` if out of range.
    pub fn distances(&self) -> &[Option<Length>] {
        &self.distances
    }

    /// Direction and distance of each point, from left to right; directions are the robot's, 0 straight ahead.
    pub fn points(&self) -> impl Iterator<Item = (Angle, Option<Length>)> {
        let middle = self.distances.len() / 2;
        let direction = move |index: usize| self.spacing * (middle as f64 - index as f64);
        self.distances.iter().enumerate().map(move |(index, distance)| (direction(index), *distance))
    }

    /// Distance of the point nearest to a direction; `None` if out of range or outside of the scan.
    pub fn towards(&self, direction: Angle) -> Option<Length> {
        let steps = (direction.wrapped() / self.spacing).round();
        let count = self.distances.len() as i64;
        let index = count / 2 - steps as i64;
        // A scan of 360 degrees wraps around.
        let is_closed = (self.spacing * count as f64 - Angle::degrees(360.0)).abs() < Angle::degrees(1e-6);
        let index = if is_closed { index.rem_euclid(count) } else { index };
        usize::try_from(index).ok().and_then(|index| self.distances.get(index).copied()).flatten()
    }

    /// Shortest distance of the points in directions from `right` to `left`; `None` if all these points are out of
    /// range.
    pub fn nearest(&self, right: Angle, left: Angle) -> Option<Length> {
        let inside = self.points().filter(|(direction, _)| (right..=left).contains(direction));
        inside.filter_map(|(_, distance)| distance).reduce(Length::min)
    }
}

fn within_range(distance_mm: i32) -> Option<Length> {
    (distance_mm < OUT_OF_RANGE_MM).then(|| Length::from_robios7(distance_mm))
}
