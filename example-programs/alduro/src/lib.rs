//! Walks over unstructured terrain on four legs, with a local map from sonar (Gois and Hiller).
//!
//! The arguments `survey DISTANCE` make the robot drive straight ahead for this many metres and measure with its
//! sonars. Another program makes maps from the readings afterwards.
//!
//! The arguments `X Y` are the goal in the world, in metres. An optional third argument names the equations that
//! correct the steps: `both`, `eq4`, `eq5` or `none`. The operator on board sees the goal and gives its direction, to
//! whole degrees, and its distance. Both come from the true pose, since odometry is useless after tens of metres. All
//! other parts of the program, such as the map, use only odometry, sonars and the encoders of the legs. The window
//! shows the heights of the cells that sonar readings have updated.

mod body;
#[cfg(test)]
mod offline;
mod operator;
mod perception;
mod planner;

use body::{Pose, SONARS};
use mapping::local_map::{LocalMap, Patch};
use mapping::math;
use nalgebra::{Rotation3, Vector3};
use planner::{Corrections, HEIGHT_SIGMA, LegState, Planner, Reading};
use robios_api::LayerFrame;
use robios_api::robios7::prelude::*;
use robios_api::robios7::{Leg, LegLink, Legs, Psd, TruePose};

robios_api::program!(main);

/// Period of measuring and planning. All sonars measure at once, since their beams point in different directions. An
/// echo from 6 m takes 35 ms.
const CYCLE: Duration = Duration::from_millis(250);
/// Measuring period of a survey.
const SCAN: Duration = Duration::from_millis(125);
/// Driving speed of a survey.
const SURVEY_SPEED: Speed = Speed::millimetres_per_second(500.0);
/// Distance from the goal at which the operator stops, m.
const ARRIVED: f64 = 0.5;
/// Length of a shank from knee to tip, m; as in the robi.
const SHANK: f64 = 1.1;
/// Ratio of a cell's standard deviation to the prior one below which the window shows the cell.
const KNOWN: f64 = 0.9;
/// Number of cycles between two prints of the map.
const PRINT_CYCLES: u32 = 20;

fn main(robot: &Robot) -> std::result::Result<(), Box<dyn std::error::Error>> {
    let words: Vec<&str> = robot.arguments().iter().map(String::as_str).collect();
    match words[..] {
        ["survey", distance] => survey(robot, metres(distance)?),
        [x, y] => walk(robot, (metres(x)?, metres(y)?), Corrections::Both),
        [x, y, equations] => walk(robot, (metres(x)?, metres(y)?), corrections(equations)?),
        _ => Err("usage: alduro X Y [both|eq4|eq5|none] or alduro survey DISTANCE, in metres".into()),
    }
}

/// Parses an argument in metres, at most ten kilometres.
fn metres(word: &str) -> std::result::Result<f64, String> {
    let value = word.parse().ok().filter(|metres: &f64| metres.abs() <= 10_000.0);
    value.ok_or_else(|| format!("`{word}`: expected a number of metres from -10000 to 10000"))
}

/// Parses the third argument: the equations that correct the steps.
fn corrections(word: &str) -> std::result::Result<Corrections, String> {
    Corrections::named(word).ok_or_else(|| format!("`{word}`: expected `both`, `eq4`, `eq5` or `none`"))
}

/// Measures with all sonars while the robot drives straight ahead.
fn survey(robot: &Robot, distance: f64) -> std::result::Result<(), Box<dyn std::error::Error>> {
    let sonars = sonars(robot)?;
    let drive = robot.drive();
    let ticker = robot.ticker(SCAN);
    drive.straight(distance.metres(), SURVEY_SPEED)?;
    while !drive.is_done() {
        for sonar in &sonars {
            sonar.distance();
        }
        ticker.wait();
    }
    Ok(())
}

/// Walks to `goal` in the world, m.
fn walk(
    robot: &Robot,
    goal: (f64, f64),
    corrections: Corrections,
) -> std::result::Result<(), Box<dyn std::error::Error>> {
    let legs = robot.legs()?;
    let sonars = sonars(robot)?;
    let mut planner = Planner::new(pose(robot, &legs)?.ground.heading, corrections);
    let ticker = robot.ticker(CYCLE);
    for cycle in 0.. {
        let pose = pose(robot, &legs)?;
        let distance = |sonar: &Psd<'_>| sonar.distance().map(|distance| distance.as_metres());
        let readings: Vec<Reading> = sonars
            .iter()
            .enumerate()
            .map(|(sonar, device)| Reading { sonar, pose, distance: distance(device) })
            .collect();
        planner.observe(&readings);
        let (bearing, distance) = seen(&robot.simulation().own_pose(), goal);
        if distance < ARRIVED {
            legs.stop()?;
            writeln!(robot.console(), "arrived after {:.1} s", robot.now().as_secs_f64());
            return Ok(());
        }
        let states = legs.all().map(|leg| state(&legs, leg)).collect::<Result<Vec<_>>>()?;
        let orders = planner.plan(&pose, pose.ground.heading + bearing, distance, &states);
        for (leg, correction) in legs.all().zip(&orders.corrections) {
            legs.correct(leg, correction.x.metres(), correction.y.metres(), correction.z.metres())?;
        }
        let (vx, vy) = (orders.velocity.x.metres_per_second(), orders.velocity.y.metres_per_second());
        legs.set_speed(vx, vy, orders.turn.radians_per_second())?;
        show(robot, planner.map())?;
        if cycle % PRINT_CYCLES == 0 {
            tell(robot, &pose, planner.map());
        }
        ticker.wait();
    }
    Ok(())
}

fn sonars(robot: &Robot) -> Result<Vec<Psd<'_>>> {
    (1..=SONARS as u8).map(|number| robot.psd(PsdAt::Other(number))).collect()
}

/// Pose of the body, estimated from odometry and the legs.
fn pose(robot: &Robot, legs: &Legs) -> Result<Pose> {
    let position = robot.drive().position();
    let lift = legs.height()?.as_metres();
    let ground = mapping::pose::Pose::new(position.x.as_metres(), position.y.as_metres(), position.phi.as_radians());
    Ok(Pose { ground, lift })
}

/// The operator's view of the goal: bearing from straight ahead, rad in whole degrees, and distance, m.
fn seen(own: &TruePose, (x, y): (f64, f64)) -> (f64, f64) {
    let (x, y) = (x - own.position.x.as_metres(), y - own.position.y.as_metres());
    let bearing = math::atan2(y, x) - own.position.phi.as_radians();
    (bearing.to_degrees().round().to_radians(), math::hypot(x, y))
}

/// State of a leg, from its encoders.
fn state(legs: &Legs, leg: Leg) -> Result<LegState> {
    let link = legs.link(leg, LegLink::Shank)?;
    let [x, y, z] = [link.x, link.y, link.z].map(Length::as_metres);
    let [roll, pitch, yaw] = [link.roll, link.pitch, link.yaw].map(Angle::as_radians);
    let down = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw)
        * Rotation3::from_axis_angle(&Vector3::y_axis(), -pitch)
        * Rotation3::from_axis_angle(&Vector3::x_axis(), roll)
        * Vector3::new(0.0, 0.0, -SHANK);
    let knee = Vector3::new(x, y, z);
    Ok(LegState { shank: knee + down / 2.0, tip: knee + down, is_in_the_air: !legs.is_on_ground(leg)? })
}

/// Shows the heights of the map in the window.
fn show(robot: &Robot, map: &LocalMap) -> Result {
    let is_known = |patch: &Patch| patch.sigma < KNOWN * HEIGHT_SIGMA;
    let points: Vec<[f64; 3]> = map.patches().filter(is_known).map(|patch| [patch.x, patch.y, patch.z]).collect();
    robot.layers().points("heights", LayerFrame::Odometry, &points)
}

/// Prints the map. The first line is `map X Y HEADING LOW_X LOW_Y CELL COLUMNS`, in m and rad: estimated pose of the
/// robot, centre of the cell with the minimum x and y (both in the odometry frame), side of a cell, number of columns.
/// Then follows a line `row` of heights in cm for each row of cells, from the minimum y upwards.
fn tell(robot: &Robot, pose: &Pose, map: &LocalMap) {
    let partition = map.surface().partition();
    let (x, y) = partition.centre(partition.low);
    writeln!(
        robot.console(),
        "map {:.3} {:.3} {:.4} {x:.2} {y:.2} {:.2} {}",
        pose.ground.position.x,
        pose.ground.position.y,
        pose.ground.heading,
        partition.cell,
        partition.columns
    );
    let heights: Vec<i64> = map.patches().map(|patch| (patch.z * 100.0).round() as i64).collect();
    for row in heights.chunks(partition.columns) {
        let row: Vec<String> = row.iter().map(i64::to_string).collect();
        writeln!(robot.console(), "row {}", row.join(" "));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_arguments_are_reported_with_what_is_expected() {
        assert_eq!(metres("-3.5"), Ok(-3.5));
        for word in ["", "x", "nan", "inf", "1e9"] {
            assert!(corrections(word).unwrap_err().contains("expected `both`"), "{word}");
            assert!(metres(word).unwrap_err().contains("expected a number of metres"), "{word}");
        }
    }
}
