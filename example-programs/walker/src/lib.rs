//! Walks on two legs, computes the profile of the ground from one range sensor, and stops before an obstacle.
//!
//! Arguments: `walker PLACE SENSOR SPEED`. PLACE is the sensor's link, `tibia`, `thigh` or `body`. SENSOR is its type,
//! `ideal`, `laser`, `ultrasonic` or `reflectance`. SPEED is in mm/s. Every 25 ms the program reads the sensor and adds
//! the hit point to the profile. It computes the point from odometry, the height of the body, the pose of the leg's
//! link (from the joints) and the sensor's pose on the link. A reading of the sensor's maximum distance adds no point.
//!
//! The program prints a line for each reading: `time_ms distance_mm x_mm z_mm`, with `-` for the coordinates if there
//! is no point. x counts from the start, z from the floor. The window shows the profile as a line. Source: France et
//! al. 1999, section 6.2.

use robios_api::robios7::prelude::*;
use robios_api::{LayerFrame, Leg, LegLink, Legs, LinkPose};

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

/// Pose of the link or body that bears the sensor, in the plane of the walk.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Bearer {
    /// Distance ahead of the start.
    x: Length,
    /// Height above the floor.
    z: Length,
    /// Elevation of its x axis.
    pitch: Angle,
}

impl Bearer {
    /// Pose from odometry, the height of the body, and the link's pose in the robot's frame.
    fn of(x: Length, height: Length, link: &LinkPose) -> Self {
        Self { x: x + link.x, z: height + link.z, pitch: link.pitch }
    }

    /// Mean of this pose and another.
    fn middle(&self, other: &Self) -> Self {
        Self { x: (self.x + other.x) * 0.5, z: (self.z + other.z) * 0.5, pitch: (self.pitch + other.pitch) * 0.5 }
    }

    /// Hit point of the sensor's ray at a distance: x ahead of the start, z above the floor.
    fn met(&self, mount: &Mount, distance: Length) -> (Length, Length) {
        let (sin, cos) = (self.pitch.sin(), self.pitch.cos());
        let ray = self.pitch + mount.pitch;
        (
            self.x + mount.x * cos - mount.z * sin + distance * ray.cos(),
            self.z + mount.x * sin + mount.z * cos + distance * ray.sin(),
        )
    }
}

fn main(robot: &Robot) -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<&str> = robot.arguments().iter().map(String::as_str).collect();
    let (sensor, speed) = match words[..] {
        [] => (Sensor::of_words("tibia", "laser"), Some(1300.0)),
        [place_word, kind, speed] => (Sensor::of_words(place_word, kind), speed.parse().ok()),
        _ => (None, None),
    };
    let (Some(sensor), Some(speed)) = (sensor, speed) else {
        return Err("expected tibia, thigh or body; ideal, laser, ultrasonic or reflectance; mm/s".into());
    };
    let legs = robot.legs()?;
    let psd = robot.psd(sensor.at)?;
    legs.set_speed(Speed::millimetres_per_second(speed), Speed::ZERO, TurnRate::ZERO)?;
    let mut nearest = WAY + STOP;
    let mut profile = Vec::new();
    let ticker = robot.ticker(PERIOD);
    let mut x = Length::ZERO;
    let mut stuck = 0;
    while x < nearest - STOP && stuck < STUCK {
        ticker.wait();
        // Calls cost virtual time. Values are read before and after the distance, in mirrored order, so their mean is
        // valid at the time of the reading.
        let last_x = x;
        let (before_x, before_height) = (robot.drive().position().x, legs.height()?);
        let before = Bearer::of(before_x, before_height, &link(&legs, &sensor.mount)?);
        let distance = psd.distance().unwrap_or(sensor.max);
        let time_ms = robot.now().as_millis();
        let after_link = link(&legs, &sensor.mount)?;
        let after_height = legs.height()?;
        x = robot.drive().position().x;
        stuck = if x > last_x { 0 } else { stuck + 1 };
        let bearer = before.middle(&Bearer::of(x, after_height, &after_link));
        let distance_mm = distance.as_millimetres();
        if distance >= sensor.max {
            writeln!(robot.console(), "{time_ms} {distance_mm} - -");
            continue;
        }
        let (point_x, point_z) = bearer.met(&sensor.mount, distance);
        if point_z > OBSTACLE {
            nearest = nearest.min(point_x);
        }
        let [x_mm, z_mm] = [point_x, point_z].map(Length::as_millimetres);
        writeln!(robot.console(), "{time_ms} {distance_mm} {x_mm:.1} {z_mm:.1}");
        profile.push([point_x.as_metres(), 0.0, point_z.as_metres()]);
        if profile.len() % SHOWN == 0 {
            robot.layers().line("profile", LayerFrame::Odometry, &profile)?;
        }
    }
    legs.stop()?;
    if stuck == STUCK {
        writeln!(robot.console(), "walked into something after {x:.2}");
    } else if nearest < WAY + STOP {
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
            let bearer = Bearer::of(now.position.x, Length::ZERO, &shank);
            let (from_x, from_z) = bearer.met(&mount, Length::ZERO);
            let to_floor = from_z / 15.degrees().sin();
            let to_step = (1.5.metres() - from_x) / 15.degrees().cos();
            let is_on_step = from_z > to_step * 15.degrees().sin();
            Some(if is_on_step { to_step } else { to_floor })
        })
    }

    #[test]
    fn a_point_is_where_the_ray_ends() {
        let mount = Mount { link: None, x: 100.millimetres(), z: 50.millimetres(), pitch: -90.degrees() };
        let bearer = Bearer { x: 1.metres(), z: 0.5.metres(), pitch: 90.degrees() };
        // The sensor sits above and behind the link's origin, and looks ahead.
        let (x, z) = bearer.met(&mount, 2.metres());
        assert!((x - 2.95.metres()).abs() < 1e-9.metres() && (z - 0.6.metres()).abs() < 1e-9.metres(), "{x} {z}");
        let other = Bearer { x: 2.metres(), z: 0.7.metres(), pitch: 100.degrees() };
        let middle = bearer.middle(&other);
        assert!(
            (middle.x - 1.5.metres()).abs() < 1e-9.metres() && (middle.pitch - 95.degrees()).abs() < 1e-9.degrees()
        );
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
    fn words_name_a_sensor_or_none() {
        let sensor = Sensor::of_words("thigh", "reflectance").expect("a sensor");
        assert_eq!((sensor.at.number(), sensor.max), (8, 1.metres()));
        assert_eq!(Sensor::of_words("tibia", "sonar"), None);
        assert_eq!(Sensor::of_words("head", "laser"), None);
    }
}
