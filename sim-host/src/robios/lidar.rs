//! The laser scanner of RoBIOS-7, and this simulator's function that reads it in RoBIOS 6.
//!
//! All points of a scan are taken at the call's end; the scanner turns with the robot. Source: RoBIOS-7 library, LIDAR;
//! position and range of a scanner that the robi does not place are our choice.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::DVec3;
use robios_sys::robios7::MAX_LIDAR_POINTS;
use robios_sys::{OutInts, Robios6Call as Call6, Robios7Call as Call};
use sim_core::time::Time;
use sim_core::world::World;

use super::call::Call as AnyCall;
use super::psd::mm_from_distance;
use super::robot::Robot;
use super::unit7::radians;
use crate::record::frame::StoredScan;
use sim_core::device::Devices;
use sim_core::device::range::Scanner;
use sim_core::device::switch::SensorId;
use sim_core::record::Event;
use sim_core::simulation;

/// Position of the robot's scanner in the world at time `at`, and the points that it would measure without errors;
/// `None` if the robot has no scanner.
pub fn points(robot: &mut Robot, world: &World, at: Time) -> Option<(DVec3, Vec<DVec3>)> {
    let simulation::Robot { spec, motion, devices, .. } = &mut robot.state;
    let lidar = spec.lidar.as_ref()?;
    let default_scanner;
    let scanner = match &devices.scanner {
        Some(scanner) => scanner,
        None => {
            default_scanner = Scanner::new(spec, lidar, [lidar.sweep, lidar.tilt], lidar.points);
            &default_scanner
        }
    };
    let (world_from_scanner, distances) = devices.ranges.exact_scan(scanner, &devices.servos, motion, world, at);
    let point = |(ray, distance): (u32, Option<f64>)| {
        Some(world_from_scanner.transform_point(scanner.fan().direction(ray) * distance?))
    };
    Some((world_from_scanner.position, (0..).zip(distances).filter_map(point).collect()))
}

/// Number of points of the robot's scanner; 0 if it has none.
pub fn point_count(robot: &Robot) -> i32 {
    let set = robot.devices.scanner.as_ref().map(|scanner| scanner.fan().len());
    set.or_else(|| Some(robot.spec.lidar.as_ref()?.points as usize)).unwrap_or_default() as i32
}

/// `LIDARGet`
pub fn get(robot: &mut Robot, world: &World, distances: &mut OutInts) -> i32 {
    scan(robot, world, Call::LIDARGet.into(), 1, distances).map_or_else(|failure| failure, |_| 0)
}

/// `LIDARScan`
pub fn scan6(robot: &mut Robot, world: &World, distances: &mut OutInts) -> i32 {
    scan(robot, world, Call6::LIDARScan.into(), -1, distances).map_or_else(|failure| failure, |points| points as i32)
}

/// Takes a scan, records it, and stores as many points as fit into `distances`; returns the number of points of the
/// scan, or `failure`.
fn scan(robot: &mut Robot, world: &World, call: AnyCall, failure: i32, distances: &mut OutInts) -> Result<usize, i32> {
    let spec = Arc::clone(&robot.spec);
    let Some(lidar) = &spec.lidar else { return Err(robot.refuse_call(call, failure, no_scanner_reason)) };
    if distances.is_null() {
        return Err(robot.refuse_call(call, failure, |_| "the buffer for the distances is null".to_owned()));
    }
    let Robot { state, robios, .. } = robot;
    let simulation::Robot { id, now, motion, journal, devices, .. } = state;
    let Devices { scanner, servos, ranges, switches, .. } = devices;
    let default_scanner = || Scanner::new(&spec, lidar, [lidar.sweep, lidar.tilt], lidar.points);
    let scanner = scanner.get_or_insert_with(default_scanner);
    let (world_from_scanner, mut metres) = ranges.scan(scanner, servos, motion, world, *now);
    if !switches.is_on(SensorId::Lidar) {
        metres.fill(None);
    }
    let numbers: Vec<i32> = metres.iter().map(|metres| mm_from_distance(*metres)).collect();
    distances.set(&numbers);
    let points = (0_u32..).zip(&metres).filter_map(|(ray, metres)| Some(((*metres)?, ray)));
    let nearest = points.min_by(|a, b| a.0.total_cmp(&b.0));
    journal.record(
        *now,
        &Event::Scan {
            points: numbers.len() as u32,
            nearest_m: nearest.map(|(metres, _)| metres),
            bearing_rad: nearest.map(|(_, ray)| ranges.bearing(scanner, ray, servos, motion, *now)),
            sum_mm: numbers.iter().map(|mm| i64::from(*mm)).sum(),
        },
    );
    if let Some(frames) = &robios.camera_output.frames {
        let fan = scanner.fan();
        let last = fan.len().saturating_sub(1) as u32;
        frames.store_scan(*id, *now, || StoredScan {
            world_from_scanner,
            bearings: [fan.bearing(0), fan.bearing(last)],
            metres,
        });
    }
    Ok(numbers.len())
}

/// `LIDARSet`: 360 degrees are exactly 2 pi.
pub fn set(robot: &mut Robot, range_degrees: i32, tilt_degrees: i32, points: i32) {
    let spec = Arc::clone(&robot.spec);
    let Some(lidar) = &spec.lidar else { return robot.skip_call(Call::LIDARSet, no_scanner_reason) };
    let is_valid = (1..=360).contains(&range_degrees)
        && (-90..=90).contains(&tilt_degrees)
        && (1..=MAX_LIDAR_POINTS as i32).contains(&points);
    if !is_valid {
        return robot.skip_call(Call::LIDARSet, |_| {
            format!("it takes a range of 1 to 360 degrees, a tilt of -90 to 90, and 1 to {MAX_LIDAR_POINTS} points")
        });
    }
    let sweep = if range_degrees == 360 { TAU } else { radians(range_degrees) };
    let scanner = Scanner::new(&spec, lidar, [sweep, radians(tilt_degrees)], points as u32);
    robot.devices.scanner = Some(scanner);
    let numbers = [("LIDAR range", range_degrees), ("LIDAR tilt", tilt_degrees), ("LIDAR points", points)];
    for (device, value) in numbers {
        robot.record(Event::Output { device, value: value.into() });
    }
}

fn no_scanner_reason(robot: &Robot) -> String {
    format!(
        "`{}` has no laser scanner; its line in a robi file is `lidar POINTS TILT`, its table in a companion `[lidar]`",
        robot.spec.file
    )
}
