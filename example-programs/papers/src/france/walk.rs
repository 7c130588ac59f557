//! One walk of the biped through the dining room: the sensor's readings, the profile that the program computed, and the
//! true motion.

use std::sync::Arc;

use anyhow::{Context as _, bail, ensure};
use glam::{DVec2, DVec3};
use sim_core::RobotId;
use sim_core::build;
use sim_core::contact;
use sim_core::pose::{Link, Pose, Pose3, link_pose};
use sim_core::sensor::{Posture, RangeSensor, incidence};
use sim_core::spec::{RobiSpec, SceneSpec};
use sim_core::time::Time;
use sim_core::world::{Ray, World};
use sim_format::load_scene;
use sim_host::files::{DiskFiles, slashed};

use crate::run::root;
use crate::trace::{Event, Trace};

/// The scene's file in the checkout.
pub const SCENE: &str = "sims/walker.scene.toml";
/// The robot's number.
const ROBOT: u32 = 1;
/// Range of the rays that determine the truth, m: across the room.
const FAR: f64 = 20.0;

/// Mount point of the sensor on the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MountPoint {
    /// On the tibia of the right leg.
    Tibia,
    /// On the thigh of the right leg.
    Thigh,
    /// On the body, level.
    Body,
}

/// Type of the sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Ideal sensor: the distance along the ray, up to 2 m, without noise and at any incidence angle.
    Ideal,
    /// The laser range finder of section 5.
    Laser,
    /// The ultrasonic sensor of section 5.
    Ultrasonic,
    /// The reflectance sensor of section 5.
    Reflectance,
}

impl MountPoint {
    /// All mount points.
    pub const ALL: [Self; 3] = [Self::Tibia, Self::Thigh, Self::Body];

    /// Name in the program's arguments.
    pub fn name(self) -> &'static str {
        match self {
            Self::Tibia => "tibia",
            Self::Thigh => "thigh",
            Self::Body => "body",
        }
    }
}

impl Kind {
    /// All types, in the order of the paper's figures.
    pub const ALL: [Self; 4] = [Self::Ideal, Self::Laser, Self::Ultrasonic, Self::Reflectance];

    /// Name in the program's arguments.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ideal => "ideal",
            Self::Laser => "laser",
            Self::Ultrasonic => "ultrasonic",
            Self::Reflectance => "reflectance",
        }
    }

    /// Reading if nothing is detected, m.
    pub fn max(self) -> f64 {
        match self {
            Self::Ideal | Self::Laser => 2.0,
            Self::Ultrasonic | Self::Reflectance => 1.0,
        }
    }
}

/// A reading of the sensor, as the program printed it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time of the measurement, s.
    pub at: f64,
    /// Distance that the sensor read, m.
    pub distance: f64,
    /// Point that the program computed from the reading, ahead of the start and above the floor, m.
    pub point: Option<DVec2>,
    /// True hit of the sensor's ray at the time of the measurement.
    pub truth: Hit,
}

/// True hit of a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance, m; infinite if nothing is hit.
    pub distance: f64,
    /// Incidence angle, rad.
    pub incidence: f64,
    /// Hit point, ahead of the start and above the floor, m.
    pub point: DVec2,
    /// Object that is hit.
    pub thing: Thing,
}

/// Objects in the dining room.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Thing {
    /// The floor.
    Floor,
    /// The small obstacle.
    Obstacle,
    /// Walls and furniture.
    Other,
    /// Nothing within 20 m.
    Nothing,
}

/// Pose and posture of the robot at an instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// Time, s.
    pub at: f64,
    /// Pose of the robot's frame on the ground.
    pub pose: Pose,
    /// Height of the robot's frame above the floor, m.
    pub lift: f64,
    /// Angles of the robot's joints, rad.
    pub joints: Vec<f64>,
}

/// A finished walk.
#[derive(Clone, Debug)]
pub struct Walk {
    /// The program's readings in the order of their times.
    pub samples: Vec<Sample>,
    /// Pose and posture of the robot at the end of each slot.
    pub moments: Vec<Moment>,
    /// Times of the footfalls of the leg that carries the sensor, s.
    pub footfalls: Vec<f64>,
    /// Times at which the body or a leg touched something, s.
    pub touches: Vec<f64>,
    /// The last line that the program printed, its result.
    pub verdict: String,
    /// Distance from the body's centre to the face of the obstacle at the end, m.
    pub gap: f64,
    /// Digest of the run.
    pub digest: String,
}

/// True geometry of the room and the robot.
pub struct Truth {
    world: World,
    /// The robot's type.
    pub robi: Arc<RobiSpec>,
    links: Vec<Link>,
    sensors: Vec<RangeSensor>,
    start: Pose,
    /// Distance from the start to the obstacle's face, m.
    pub obstacle_at: f64,
    /// Size of the obstacle, m: along the walk, across it, and up.
    pub obstacle_size: DVec3,
}

impl Truth {
    /// Reads the scene.
    ///
    /// # Errors
    /// If the scene cannot be read, or has no robot or no obstacle.
    pub fn read() -> anyhow::Result<Self> {
        let mut files = DiskFiles::with_home(root());
        let name = files.name(&root().join(SCENE));
        let loaded = load_scene(&name, &files);
        ensure!(!loaded.has_errors(), "`{SCENE}` has mistakes: {:?}", loaded.diagnostics);
        Self::of(&loaded.scene).with_context(|| format!("`{}`", slashed(SCENE.as_ref())))
    }

    fn of(scene: &SceneSpec) -> anyhow::Result<Self> {
        let robot = scene.robots.first().context("it has no robot")?;
        let obstacle = scene.objects.iter().find(|object| object.kind.name == "Obstacle");
        let obstacle = obstacle.context("it has no obstacle")?;
        let size = match obstacle.kind.colliders[..] {
            [sim_core::spec::Collider::Box { size, .. }] => size,
            _ => bail!("the obstacle is not a box"),
        };
        let slot = Time::from_millis(50);
        let world = World::new(build::obstacles(scene), slot, std::iter::empty()).with_space(build::space(scene));
        Ok(Self {
            world,
            robi: Arc::clone(&robot.robi),
            links: build::links(&robot.robi),
            sensors: build::range_sensors(&robot.robi),
            start: robot.start,
            obstacle_at: obstacle.pose.position.x - 0.5 * size.x - robot.start.position.x,
            obstacle_size: size,
        })
    }

    /// The sensor of this type at this mount point.
    fn sensor(&self, place: MountPoint, kind: Kind) -> &RangeSensor {
        let on = match place {
            MountPoint::Tibia => "SHANK",
            MountPoint::Thigh => "THIGH",
            MountPoint::Body => "BODY",
        };
        let name = format!("{}_{on}", kind.name().to_uppercase());
        let index = self.robi.ranges.iter().position(|range| range.name == name);
        // The list begins with the PSDs.
        &self.sensors[self.robi.psds.len() + index.unwrap_or_else(|| panic!("the robot has a sensor `{name}`"))]
    }

    /// Pose of the sensor in the world.
    pub fn ray(&self, place: MountPoint, kind: Kind, moment: &Moment) -> Pose3 {
        let posture =
            Posture { world_from_robot: moment.pose, links: &self.links, angles: &moment.joints, lift: moment.lift };
        let sensor = self.sensor(place, kind);
        posture.world_from(&sensor.mount, sensor.link)
    }

    /// Positions of a leg's joints from the hip down and of its foot, ahead of the start and above the floor, m.
    pub fn leg(&self, leg: usize, moment: &Moment) -> Vec<DVec2> {
        leg_points(&self.robi, &self.links, leg, moment).into_iter().map(|point| self.ahead(point)).collect()
    }

    /// Hit of the sensor's ray.
    pub fn hit(&self, ray: &Pose3) -> Hit {
        let direction = ray.forward();
        let Some(hit) = self.world.cast(RobotId(ROBOT), &Ray::new(ray.position, direction, FAR), Time::ZERO) else {
            let (distance, point) = (f64::INFINITY, DVec2::NAN);
            return Hit { distance, incidence: 0.0, point, thing: Thing::Nothing };
        };
        let point = self.ahead(ray.position + direction * hit.distance);
        // The furniture stands beside the path: within the obstacle's length and height there is only the obstacle.
        let size = self.obstacle_size;
        let is_obstacle = point.x >= self.obstacle_at - 1e-6
            && point.x <= self.obstacle_at + size.x + 1e-6
            && point.y <= size.z + 1e-6
            && hit.thing != contact::Thing::Floor;
        let thing = match hit.thing {
            contact::Thing::Floor => Thing::Floor,
            _ if is_obstacle => Thing::Obstacle,
            _ => Thing::Other,
        };
        let incidence = hit.face.map_or(0.0, |face| incidence(direction, face.normal));
        Hit { distance: hit.distance, incidence, point, thing }
    }

    /// Projects a world point onto the vertical plane of the walk: ahead of the start, above the floor.
    pub fn ahead(&self, point: DVec3) -> DVec2 {
        DVec2::new(point.x - self.start.position.x, point.z)
    }

    /// Reads the trace of a walk.
    ///
    /// # Errors
    /// If the trace lacks the program's lines or the postures.
    pub fn walk(&self, place: MountPoint, kind: Kind, trace: &Trace) -> anyhow::Result<Walk> {
        let moments = moments(trace, self.start);
        ensure!(!moments.is_empty(), "the trace has no postures");
        let mut samples = Vec::new();
        let mut verdict = String::new();
        let mut measured = trace.of_robot(ROBOT).filter_map(|entry| match &entry.event {
            Event::Distance { measured_s, .. } => Some(*measured_s),
            _ => None,
        });
        // The first reading is not part of the walk: the program uses it to check that the sensor exists.
        measured.next();
        for (_, line) in trace.printed(ROBOT) {
            let Some((distance, point)) = numbers(line) else {
                verdict = line.to_owned();
                continue;
            };
            let at = measured.next().context("a line without a reading")?;
            let truth = self.hit(&self.ray(place, kind, &at_time(&moments, at)));
            samples.push(Sample { at, distance, point, truth });
        }
        ensure!(!samples.is_empty(), "the program has printed no reading");
        let foot = self.robi.legs.as_ref().and_then(|legs| Some(legs.legs.last()?.name.text.clone()));
        let footfalls = trace
            .of_robot(ROBOT)
            .filter(|entry| matches!(&entry.event, Event::Footfall { leg } if Some(leg) == foot.as_ref()));
        let touches = trace.entries.iter().filter(|entry| matches!(entry.event, Event::Contact | Event::Touch));
        let end = moments.last().map_or(0.0, |moment| moment.pose.position.x - self.start.position.x);
        Ok(Walk {
            samples,
            footfalls: footfalls.map(|entry| entry.at).collect(),
            touches: touches.map(|entry| entry.at).collect(),
            verdict,
            gap: self.obstacle_at - end,
            digest: trace.digest.clone(),
            moments,
        })
    }
}

/// Positions of a leg's joints from the hip down and of its foot, in the world frame, m.
pub fn leg_points(robi: &RobiSpec, links: &[Link], leg: usize, moment: &Moment) -> Vec<DVec3> {
    let links_per_leg = links.len() / 2;
    let first = leg * links_per_leg;
    let world_from_robot = Pose3::from_planar(&moment.pose, moment.lift);
    let world_from = |link: usize| world_from_robot.then(&link_pose(links, &moment.joints, first + link));
    let mut points: Vec<DVec3> = (links_per_leg - 3..links_per_leg).map(|link| world_from(link).position).collect();
    if let Some(foot) = robi.legs.as_ref().and_then(|legs| legs.legs.get(leg)?.foot) {
        let ankle = world_from(links_per_leg - 1);
        let sole = |ahead| ankle.transform_point(DVec3::new(ahead, 0.0, -foot.height));
        points.extend([sole(-foot.heel), sole(foot.toe), ankle.position]);
    }
    points
}

impl Walk {
    /// Pose and posture at an instant of the walk, interpolated linearly between the ends of two slots.
    pub fn at_time(&self, at: f64) -> Moment {
        at_time(&self.moments, at)
    }

    /// The last instant at which the body moved, s.
    pub fn stopped(&self) -> f64 {
        let still = self.moments.last().map_or(DVec2::ZERO, |moment| moment.pose.position);
        self.moments.iter().rev().find(|moment| moment.pose.position != still).map_or(0.0, |moment| moment.at)
    }
}

/// Parses a line of the program: the distance, and the point if there is one, m.
pub fn numbers(line: &str) -> Option<(f64, Option<DVec2>)> {
    let words: Vec<&str> = line.split(' ').collect();
    let [time, distance, x, z] = words[..] else { return None };
    time.parse::<u64>().ok()?;
    let metres = |word: &str| Some(word.parse::<f64>().ok()? / 1000.0);
    let point = metres(x).zip(metres(z)).map(|(x, z)| DVec2::new(x, z));
    Some((metres(distance)?, point))
}

/// Pose and posture at each time of the trace with a pose or a posture, for a robot that starts at `start`.
pub fn moments(trace: &Trace, start: Pose) -> Vec<Moment> {
    let mut moments: Vec<Moment> = Vec::new();
    let (mut pose, mut lift, mut joints) = (start, None, Vec::new());
    for entry in trace.of_robot(ROBOT) {
        match &entry.event {
            Event::Pose { x_m, y_m, phi_rad } => pose = Pose::new(*x_m, *y_m, *phi_rad),
            Event::Posture { lift_m, joints_rad } => (lift, joints) = (Some(*lift_m), joints_rad.clone()),
            _ => continue,
        }
        let Some(lift) = lift else { continue };
        let moment = Moment { at: entry.at, pose, lift, joints: joints.clone() };
        match moments.last_mut() {
            Some(last) if last.at == entry.at => *last = moment,
            _ => moments.push(moment),
        }
    }
    moments
}

/// Linear interpolation between two moments.
pub fn at_time(moments: &[Moment], at: f64) -> Moment {
    let next = moments.partition_point(|moment| moment.at <= at).clamp(1, moments.len().max(2) - 1);
    let (a, b) = (&moments[next - 1], moments.get(next).unwrap_or(&moments[next - 1]));
    let span = b.at - a.at;
    let fraction = if span > 0.0 { ((at - a.at) / span).clamp(0.0, 1.0) } else { 0.0 };
    let between = |a: f64, b: f64| a + (b - a) * fraction;
    let position = a.pose.position.lerp(b.pose.position, fraction);
    let heading = between(a.pose.heading.remainder(), b.pose.heading.remainder());
    Moment {
        at,
        pose: Pose::new(position.x, position.y, heading),
        lift: between(a.lift, b.lift),
        joints: a.joints.iter().zip(&b.joints).map(|(a, b)| between(*a, *b)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_the_program_are_read() {
        assert_eq!(numbers("125 2000 - -"), Some((2.0, None)));
        assert_eq!(numbers("150 812.5 750.0 -500.0"), Some((0.8125, Some(DVec2::new(0.75, -0.5)))));
        assert_eq!(numbers("stopped 0.65 m before an obstacle"), None);
    }

    #[test]
    fn poses_between_two_moments_are_interpolated_linearly() {
        let moment = |at, x| Moment { at, pose: Pose::new(x, 0.0, 0.0), lift: x, joints: vec![2.0 * x] };
        let moments = [moment(0.0, 0.0), moment(1.0, 1.0), moment(3.0, 2.0)];
        for (at, x) in [(-1.0, 0.0), (0.25, 0.25), (1.0, 1.0), (2.0, 1.5), (9.0, 2.0)] {
            let there = at_time(&moments, at);
            assert_eq!((there.pose.position.x, there.lift, there.joints[0]), (x, x, 2.0 * x), "{at}");
        }
    }
}
