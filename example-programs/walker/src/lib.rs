//! Walks on two legs, computes the profile of the ground from one range sensor, and stops before an obstacle.
//!
//! Arguments: `walker PLACE SENSOR SPEED [WAY]`. PLACE is the sensor's link, `tibia`, `thigh` or `body`. SENSOR is its
//! type, `ideal`, `laser`, `ultrasonic` or `reflectance`. SPEED is in mm/s. With WAY, in mm, the robot walks that far
//! and does not stop before obstacles. Without arguments it uses `tibia laser 1300`. Every 25 ms the program reads the
//! sensor and adds the hit point to the profile. It computes the point from odometry, the height of the body, the pose
//! of the leg's link (from the joints) and the sensor's pose on the link. A reading of the sensor's maximum distance
//! adds no point.
//!
//! The program prints a line for each reading: `time_ms distance_mm x_mm z_mm`, with `-` for the coordinates if there
//! is no point. x counts from the start, z from the floor. The window shows the profile as a line. Source: France et
//! al. 1999, section 6.2.

use robios_api::robios7::prelude::*;
use robios_api::{LayerFrame, Leg, LegLink, Legs, LinkPose, Position};

robios_api::program!(main);

/// Time between two readings.
const PERIOD: Duration = Duration::from_millis(25);
/// Height above which a point is an obstacle: well above the paper's noise on the floor.
const OBSTACLE: Length = Length::millimetres(60.0);
/// Distance of the body's centre from an obstacle at which the robot stops: a step, a foot, and a margin.
const STOP: Length = Length::millimetres(650.0);
/// Maximum walking distance, even if the sensor detects nothing.
const WAY: Length = Length::metres(4.0);
/// Number of readings without progress after which the robot counts as stuck.
const STUCK: u32 = 40;
/// Number of new profile points after which the window shows the profile again.
const SHOWN: usize = 5;
/// Message for wrong arguments.
const USAGE: &str = "expected tibia, thigh or body; ideal, laser, ultrasonic or reflectance; mm/s; perhaps mm";
/// The leg that bears the sensors.
const LEG: Leg = Leg(2);

/// A range sensor, with the values of the robot's companion file.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sensor {
    at: PsdAt,
    /// Reading if nothing is hit.
    max: Length,
    mount: Mount,
}

/// Mounting of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mount {
    /// Link that bears the sensor; `None` for the body.
    link: Option<LegLink>,
    /// Forward in the link's frame.
    x: Length,
    /// Up in the link's frame.
    z: Length,
    /// Elevation of the beam.
    pitch: Angle,
}

impl Sensor {
    /// The sensor with the place and type that the arguments name.
    fn of_words(place: &str, kind: &str) -> Option<Self> {
        let mount = |link, x, z, pitch| Mount {
            link,
            x: Length::millimetres(x),
            z: Length::millimetres(z),
            pitch: Angle::degrees(pitch),
        };
        let (first, mount) = match place {
            "tibia" => (1, mount(Some(LegLink::Shank), 50.0, -98.0, -5.0)),
            "thigh" => (5, mount(Some(LegLink::Thigh), 70.0, -200.0, -40.0)),
            "body" => (9, mount(None, 120.0, 900.0, 0.0)),
            _ => return None,
        };
        let (kind, max) = match kind {
            "ideal" => (0, 2000.0),
            "laser" => (1, 2000.0),
            "ultrasonic" => (2, 1000.0),
            "reflectance" => (3, 1000.0),
            _ => return None,
        };
        Some(Self { at: PsdAt::Other(first + kind), max: Length::millimetres(max), mount })
    }
}

/// Pose of the link or body that bears the sensor: x ahead of the start, y to the left, z above the floor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Bearer {
    /// Pose of the robot by odometry.
    robot: Position,
    /// Height of the robot's frame above the floor.
    height: Length,
    /// Pose of the link in the robot's frame.
    link: LinkPose,
}

impl Bearer {
    /// Mean of this pose and another that differs little.
    fn middle(&self, other: &Self) -> Self {
        let length = |a: Length, b: Length| (a + b) * 0.5;
        let angle = |a: Angle, b: Angle| (a + b) * 0.5;
        let (robot, link) = (&self.robot, &self.link);
        Self {
            robot: Position {
                x: length(robot.x, other.robot.x),
                y: length(robot.y, other.robot.y),
                phi: angle(robot.phi, other.robot.phi),
            },
            height: length(self.height, other.height),
            link: LinkPose {
                x: length(link.x, other.link.x),
                y: length(link.y, other.link.y),
                z: length(link.z, other.link.z),
                roll: angle(link.roll, other.link.roll),
                pitch: angle(link.pitch, other.link.pitch),
                yaw: angle(link.yaw, other.link.yaw),
            },
        }
    }

    /// Hit point of the sensor's ray at a distance.
    fn met(&self, mount: &Mount, distance: Length) -> [Length; 3] {
        let (robot, link) = (&self.robot, &self.link);
        let x = mount.x + distance * mount.pitch.cos();
        let z = mount.z + distance * mount.pitch.sin();
        // From the link's frame into the robot's: roll, pitch, yaw.
        let (y, z) = turned(Length::ZERO, z, link.roll);
        let (x, z) = turned(x, z, link.pitch);
        let (x, y) = turned(x, y, link.yaw);
        let (x, y) = turned(link.x + x, link.y + y, robot.phi);
        [robot.x + x, robot.y + y, self.height + link.z + z]
    }
}

/// Rotation of a point of the plane by an angle from the first axis to the second.
fn turned(first: Length, second: Length, angle: Angle) -> (Length, Length) {
    let (sin, cos) = (angle.sin(), angle.cos());
    (first * cos - second * sin, first * sin + second * cos)
}

fn main(robot: &Robot) -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<&str> = robot.arguments().iter().map(String::as_str).collect();
    let (place, kind, speed, blind_way) = match words[..] {
        [] => ("tibia", "laser", "1300", None),
        [place, kind, speed] => (place, kind, speed, None),
        [place, kind, speed, way] => (place, kind, speed, Some(way)),
        _ => return Err(USAGE.into()),
    };
    let sensor = Sensor::of_words(place, kind).ok_or(USAGE)?;
    let speed: f64 = speed.parse().ok().ok_or(USAGE)?;
    let blind_way: Option<f64> = blind_way.map(|way| way.parse().ok().ok_or(USAGE)).transpose()?;
    let legs = robot.legs()?;
    let psd = robot.psd(sensor.at)?;
    legs.set_speed(Speed::millimetres_per_second(speed), Speed::ZERO, TurnRate::ZERO)?;
    let way = blind_way.map_or(WAY, Length::millimetres);
    let mut nearest = way + STOP;
    let mut profile = Vec::new();
    let ticker = robot.ticker(PERIOD);
    let mut x = Length::ZERO;
    let mut stuck = 0;
    while x < nearest - STOP && stuck < STUCK {
        ticker.wait();
        // Calls cost virtual time. Values are read before and after the distance, in mirrored order, so their mean is
        // valid at the time of the reading.
        let last_x = x;
        let (before_robot, before_height) = (robot.drive().position(), legs.height()?);
        let before = Bearer { robot: before_robot, height: before_height, link: link(&legs, &sensor.mount)? };
        let distance = psd.distance().unwrap_or(sensor.max);
        let time_ms = robot.now().as_millis();
        let after_link = link(&legs, &sensor.mount)?;
        let after_height = legs.height()?;
        let after_robot = robot.drive().position();
        x = after_robot.x;
        stuck = if x > last_x { 0 } else { stuck + 1 };
        let bearer = before.middle(&Bearer { robot: after_robot, height: after_height, link: after_link });
        let distance_mm = distance.as_millimetres();
        if distance >= sensor.max {
            writeln!(robot.console(), "{time_ms} {distance_mm} - -");
            continue;
        }
        let [point_x, point_y, point_z] = bearer.met(&sensor.mount, distance);
        if blind_way.is_none() && point_z > OBSTACLE {
            nearest = nearest.min(point_x);
        }
        let [x_mm, z_mm] = [point_x, point_z].map(Length::as_millimetres);
        writeln!(robot.console(), "{time_ms} {distance_mm} {x_mm:.1} {z_mm:.1}");
        profile.push([point_x, point_y, point_z].map(Length::as_metres));
        if profile.len() % SHOWN == 0 {
            robot.layers().line("profile", LayerFrame::Odometry, &profile)?;
        }
    }
    legs.stop()?;
    if stuck == STUCK {
        writeln!(robot.console(), "walked into something after {x:.2}");
    } else if nearest < way + STOP {
        writeln!(robot.console(), "stopped {:.2} before an obstacle", nearest - x);
    } else {
        writeln!(robot.console(), "no obstacle within {x:.2}");
    }
    // Wait until both feet are on the ground.
    robot.sleep(2.seconds());
    Ok(())
}

/// Pose of the link that bears the sensor, in the robot's frame.
fn link(legs: &Legs, mount: &Mount) -> Result<LinkPose> {
    mount.link.map_or(Ok(LinkPose::default()), |link| legs.link(LEG, link))
}

#[cfg(test)]
mod tests {
    use robios_api::fake::{Fake, FakeLeg};

    use super::*;

    /// A stiff leg whose sensor is 0.4 m above the floor and looks down by 15 degrees, before a step at 1.5 m.
    fn fake() -> Fake {
        let shank = LinkPose { z: 0.4.metres(), pitch: -15.degrees(), ..LinkPose::default() };
        let leg = move |_: &_| FakeLeg { links: vec![LinkPose::default(), shank], ..FakeLeg::default() };
        let mount = Sensor::of_words("tibia", "laser").expect("a sensor").mount;
        Fake::new().leg(leg).leg(leg).body_height(|_| Length::ZERO).psd(PsdAt::Other(2), move |now| {
            let bearer = Bearer {
                robot: Position { x: now.position.x, ..Position::default() },
                height: Length::ZERO,
                link: shank,
            };
            let [from_x, _, from_z] = bearer.met(&mount, Length::ZERO);
            let to_floor = from_z / 15.degrees().sin();
            let to_step = (1.5.metres() - from_x) / 15.degrees().cos();
            let is_on_step = from_z > to_step * 15.degrees().sin();
            Some(if is_on_step { to_step } else { to_floor })
        })
    }

    #[test]
    fn a_point_is_where_the_ray_ends() {
        let mount = Mount { link: None, x: 100.millimetres(), z: 50.millimetres(), pitch: -90.degrees() };
        let link = LinkPose { pitch: 90.degrees(), ..LinkPose::default() };
        let at = |x: f64| Position { x: x.metres(), ..Position::default() };
        let bearer = Bearer { robot: at(1.0), height: 0.5.metres(), link };
        let is_at = |bearer: &Bearer, expected: [f64; 3]| {
            let point = bearer.met(&mount, 2.metres()).map(Length::as_metres);
            let errors = point.iter().zip(expected).map(|(is, expected)| (is - expected).abs());
            assert!(errors.into_iter().all(|error| error < 1e-9), "{point:?}, expected {expected:?}");
        };
        // The sensor sits above and behind, and looks ahead.
        is_at(&bearer, [2.95, 0.0, 0.6]);
        // Turned to the left the leg looks to the left; with its left side up, what is above the link is to the right
        // of it.
        is_at(&Bearer { link: LinkPose { yaw: 90.degrees(), ..link }, ..bearer }, [1.0, 1.95, 0.6]);
        is_at(&Bearer { robot: Position { phi: 90.degrees(), ..at(1.0) }, ..bearer }, [1.0, 1.95, 0.6]);
        let rolled = LinkPose { roll: 90.degrees(), ..LinkPose::default() };
        is_at(&Bearer { link: rolled, ..bearer }, [1.1, 1.95, 0.5]);
        let other = Bearer { robot: at(2.0), height: 0.7.metres(), link: LinkPose { pitch: 90.degrees(), ..link } };
        is_at(&bearer.middle(&other), [3.45, 0.0, 0.7]);
    }

    #[test]
    fn it_stops_before_what_stands_on_the_floor() {
        let run = fake().run_robios7(main).expect_finished();
        let console = run.console();
        assert!(console.lines().last().is_some_and(|line| line.starts_with("stopped 0.6")), "{console}");
        let x = run.position().x;
        assert!(x > 0.8.metres() && x < 0.9.metres(), "{x}");
    }

    #[test]
    fn words_select_a_sensor() {
        let sensor = Sensor::of_words("thigh", "reflectance").expect("a sensor");
        assert_eq!((sensor.at.number(), sensor.max), (8, 1.metres()));
        assert_eq!(Sensor::of_words("tibia", "sonar"), None);
        assert_eq!(Sensor::of_words("head", "laser"), None);
    }
}
