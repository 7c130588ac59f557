//! The laser scanner of RoBIOS-7.
//!
//! A scan is taken as a whole at the call's end, and turns with the robot. Source: RoBIOS-7 library, LIDAR; place and reach of
//! the scanner: our choice.

use std::f64::consts::TAU;

use robios_sys::robios7::MAX_LIDAR_POINTS;
use robios_sys::{OutInts, Robios7Call as Call};
use sim_core::format::LidarSpec;
use sim_core::sensor::{Fan, Mount, Scan};
use sim_core::world::World;

use super::psd::mm_from_distance;
use super::robot::Robot;
use super::unit7::radians;
use crate::record::Event;

/// Height of the scanner above the floor, m.
const HEIGHT: f64 = 0.1;

/// How far it sees, m: the 9999 mm that stand for nothing.
const RANGE: f64 = 9.999;

/// The scanner of a robot.
#[derive(Clone, Debug, Default)]
pub struct Lidar {
    /// Its rays, once a scan was set or taken.
    scan: Option<Scan>,
}

/// `LIDARGet`
pub fn get(robot: &mut Robot, world: &World, distances: &mut OutInts) -> i32 {
    let Some(spec) = robot.spec.lidar.clone() else { return robot.refused(Call::LIDARGet, 1, has_none) };
    if distances.is_null() {
        return robot.refused(Call::LIDARGet, 1, |_| "it takes room for the distances".to_owned());
    }
    let Robot { now, motion, journal, devices, .. } = robot;
    let scan = devices.lidar.scan.get_or_insert_with(|| scan(&spec));
    let metres = scan.distances(world, motion.id(), &motion.pose(*now), *now);
    let numbers: Vec<i32> = metres.iter().map(|metres| mm_from_distance(*metres)).collect();
    distances.set(&numbers);
    let points = (0_u32..).zip(&metres).filter_map(|(ray, metres)| Some(((*metres)?, ray)));
    let nearest = points.min_by(|a, b| a.0.total_cmp(&b.0));
    journal.record(
        *now,
        &Event::Scan {
            points: scan.len() as u32,
            nearest_m: nearest.map(|(metres, _)| metres),
            bearing_rad: nearest.map(|(_, ray)| scan.bearing(ray)),
            sum_mm: numbers.iter().map(|mm| i64::from(*mm)).sum(),
        },
    );
    0
}

/// `LIDARSet`: a whole turn has 360 degrees.
pub fn set(robot: &mut Robot, range_degrees: i32, tilt_degrees: i32, points: i32) {
    if robot.spec.lidar.is_none() {
        return robot.rejected(Call::LIDARSet, has_none);
    }
    let is_sound = (1..=360).contains(&range_degrees)
        && (-90..=90).contains(&tilt_degrees)
        && (1..=MAX_LIDAR_POINTS as i32).contains(&points);
    if !is_sound {
        return robot.rejected(Call::LIDARSet, |_| {
            format!("it takes a range of 1 to 360 degrees, a tilt of -90 to 90, and 1 to {MAX_LIDAR_POINTS} points")
        });
    }
    robot.devices.lidar.scan = Some(Scan::new(
        Mount::default(),
        Fan {
            sweep: if range_degrees == 360 { TAU } else { radians(range_degrees) },
            points: points as u32,
            tilt: radians(tilt_degrees),
            height: HEIGHT,
            range: RANGE,
        },
    ));
    let numbers = [("LIDAR range", range_degrees), ("LIDAR tilt", tilt_degrees), ("LIDAR points", points)];
    for (device, value) in numbers {
        robot.record(Event::Output { device, value: value.into() });
    }
}

/// The scanner as the robi describes it.
fn scan(spec: &LidarSpec) -> Scan {
    let LidarSpec { points, tilt, sweep, .. } = *spec;
    Scan::new(Mount::default(), Fan { sweep, points, tilt, height: HEIGHT, range: RANGE })
}

fn has_none(robot: &Robot) -> String {
    format!("`{}` has no laser scanner; its line in a robi file is `lidar POINTS TILT`", robot.spec.file)
}
