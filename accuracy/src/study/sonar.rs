//! `sonar`: error of a sonar's readings as a function of its number of rays.
//!
//! For infinite rough walls at a slant, the reference is the nearest point whose echo reaches the threshold: one
//! equation in one unknown, solved by bisection. For low walls, the reference solves this equation at 41 heights. In
//! rooms of rough and smooth walls the reference is brute force: 30,000 rays, and the nearest point of each wall, by
//! formulas other than the core's. The study also measures a sensor with the same beam that only samples rays and
//! ignores the nearest points of the walls.

use std::f64::consts::{FRAC_PI_2, LN_2};
use std::sync::Arc;

use glam::{DVec2, DVec3};
use sim_core::math;
use sim_core::object::{Figure as Body, Solid};
use sim_core::pose::{Pose, Pose3};
use sim_core::scene::{Segment, Surface, Walls};
use sim_core::sensor::{Sonar, incidence};
use sim_core::time::Time;
use sim_core::world::{Ray, Space, World};
use sim_core::{RobotId, sensor::RangeModel};

use super::{Effort, Outcome, Row, Study, nanoseconds};
use crate::figure::{Figure, Mark, Scale, Series};
use crate::oracle::nearest_wall;
use crate::world::{Random, room_with_boxes};

pub const STUDY: Study =
    Study { name: "sonar", title: "Mean error of sonar readings as a function of the number of rays", run };

/// Numbers of rays.
const RAYS: [u32; 7] = [4, 16, 64, 256, 1_024, 4_096, 16_384];
/// Number of rays of the reference for rooms; they are about 1e-4 rad apart.
const REFERENCE_RAYS: u32 = 30_000;
/// Maximum angle from the line of sight of the rays of the reference and of the sensor that only samples rays, rad;
/// echoes from larger angles are below the threshold.
const REFERENCE_HALF_ANGLE: f64 = 1.5;
/// Height of the sensor in front of walls of unlimited height, m; there is no floor.
const HEIGHT: f64 = 40.0;
/// Height of the sensor in front of low walls, m.
const LOW_HEIGHT: f64 = 0.1;
/// Height of low walls, the default of world files, m.
const LOW_WALL: f64 = 0.2;
const ROBOT: RobotId = RobotId(1);

fn run(effort: Effort) -> Outcome {
    let count = effort.of(300);
    let level = slanting_walls(count, 0.0);
    let pitched = slanting_walls(count, 0.5);
    let level_low = low_walls(count, 0.0);
    let pitched_low = low_walls(count, 0.5);
    let rooms = rooms(count);
    let methods: [(&str, &[Case], Method); 6] = [
        ("level, slanting wall", &level, read_sonar),
        ("pitched, slanting wall", &pitched, read_sonar),
        ("level, low wall, ball", &level_low, read_sonar),
        ("pitched, low wall, ball", &pitched_low, read_sonar),
        ("level, room", &rooms, read_sonar),
        ("rays only, room", &rooms, read_rays_only),
    ];
    let mut rows = Vec::new();
    let mut series = Vec::new();
    for (method, cases, read) in methods {
        let measured: Vec<Row> = RAYS.iter().map(|rays| row(method, cases, *rays, read)).collect();
        let points = RAYS.iter().zip(&measured).map(|(rays, row)| (f64::from(*rays), row.error)).collect();
        series.push(Series { name: method.to_owned(), mark: Mark::LineAndDots, points });
        rows.extend(measured);
    }
    let figure = Figure {
        name: "sonar-rays".to_owned(),
        title: STUDY.title.to_owned(),
        x_label: "rays".to_owned(),
        y_label: "error, m".to_owned(),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        series,
    };
    Outcome { rows, figures: vec![figure] }
}

type Method = fn(&Case, &Sonar) -> Option<f64>;

/// Row of the mean error over the cases and of the time per reading. A missing echo is treated as a reading of
/// `sonar.max`.
fn row(method: &str, cases: &[Case], rays: u32, read: Method) -> Row {
    let sonar = Sonar { rays, ..Sonar::srf08() };
    let absolute_error =
        |case: &Case| (read(case, &sonar).unwrap_or(sonar.max) - case.truth.unwrap_or(sonar.max)).abs();
    let repeats = if rays < 1_000 { 3 } else { 1 };
    let mut error = 0.0;
    let time_ns = nanoseconds(repeats, cases.len(), || {
        error = cases.iter().map(absolute_error).sum::<f64>() / cases.len() as f64;
    });
    Row {
        study: STUDY.name,
        method: method.to_owned(),
        setting: format!("{rays} rays"),
        error,
        unit: "m",
        time_ns,
        per: "reading",
    }
}

/// Sensor in front of walls, and its true reading.
struct Case {
    world: Arc<World>,
    world_from_sensor: Pose3,
    truth: Option<f64>,
}

/// Reading of the core's sonar.
fn read_sonar(case: &Case, sonar: &Sonar) -> Option<f64> {
    RangeModel::Sonar(*sonar).read(&case.world.caster(ROBOT, Time::ZERO), &case.world_from_sensor, 0.0).distance
}

/// Nearest echo along rays spread evenly over the horizontal plane in front of a level sensor.
fn read_rays_only(case: &Case, sonar: &Sonar) -> Option<f64> {
    let Pose3 { position, rotation } = case.world_from_sensor;
    let mut nearest = None;
    for ray in 0..sonar.rays {
        let angle = ray_angle(ray, sonar.rays);
        let (sin, cos) = math::sin_cos(angle);
        let direction = rotation.x_axis * cos + rotation.y_axis * sin;
        let ray = Ray::new(position, direction, nearest.unwrap_or(sonar.max));
        let Some(hit) = case.world.cast(ROBOT, &ray, Time::ZERO) else { continue };
        let face = hit.face.expect("a ray in space hits a face");
        let energy = sonar.energy(angle.abs(), hit.distance, &face, incidence(direction, face.normal));
        if hit.distance >= sonar.min && energy >= sonar.threshold {
            nearest = Some(hit.distance);
        }
    }
    nearest
}

/// Angle between ray number `ray` of `rays` and the line of sight, rad.
fn ray_angle(ray: u32, rays: u32) -> f64 {
    REFERENCE_HALF_ANGLE * ((f64::from(ray) + 0.5) / f64::from(rays) * 2.0 - 1.0)
}

/// Cases of a sensor pitched by up to `pitch` rad, and a rough wall 0.3 to 4 m ahead that is turned by up to 80
/// degrees.
fn slanting_walls(count: usize, pitch: f64) -> Vec<Case> {
    let mut random = Random::new(8);
    let draw = || {
        let (ahead, turn) = (random.between(0.3, 4.0), random.between(-1.4, 1.4));
        let pitch = random.between(-pitch, pitch);
        let (sin, cos) = math::sin_cos(turn);
        let (middle, along) = (DVec2::new(ahead, 0.0), DVec2::new(-sin, cos) * 100.0);
        let walls = Walls::new(vec![Segment::new(middle - along, middle + along)]);
        // Distance of the nearest point of the wall, and the angle between its direction and the line of sight.
        let nearest_distance = ahead * cos;
        let cos_off_axis = cos * math::cos(pitch);
        let off_axis = math::atan2((1.0 - cos_off_axis * cos_off_axis).sqrt(), cos_off_axis);
        Case {
            world: Arc::new(world(walls, vec![Surface::ROUGH])),
            world_from_sensor: Pose3::from_angles(DVec3::new(0.0, 0.0, HEIGHT), 0.0, pitch, 0.0),
            truth: nearest_echo(nearest_distance, off_axis),
        }
    };
    std::iter::repeat_with(draw).take(count).collect()
}

/// Cases of a sensor pitched by up to `pitch` rad, a ball behind the sensor, and a low, rough wall 0.3 to 4 m ahead
/// that is turned by up to 80 degrees.
fn low_walls(count: usize, pitch: f64) -> Vec<Case> {
    let mut random = Random::new(10);
    let draw = || {
        let (ahead, turn) = (random.between(0.3, 4.0), random.between(-1.4, 1.4));
        let pitch = random.between(-pitch, pitch);
        let along = DVec2::from_angle(turn).perp();
        let ends = [-100.0, 100.0].map(|metres| DVec2::new(ahead, 0.0) + along * metres);
        let walls = Walls::new(vec![Segment::new(ends[0], ends[1])]).with_heights(vec![LOW_WALL]);
        let centre = DVec3::new(0.0, 0.0, 0.04);
        let solid = Solid::Capsule { ends: [centre; 2], radius: centre.z };
        let ball = Arc::new(Body { solids: vec![solid], surface: Surface::ROUGH });
        let space = Space {
            floor: None,
            walls: vec![Surface::ROUGH],
            fixed: vec![(Pose::new(-0.3, 0.0, 0.0), ball)],
            ..Space::default()
        };
        let world = World::new(Arc::new(walls), Time::from_millis(50), std::iter::empty()).with_space(space);
        Case {
            world: Arc::new(world),
            world_from_sensor: Pose3::from_angles(DVec3::new(0.0, 0.0, LOW_HEIGHT), 0.0, pitch, 0.0),
            truth: nearest_echo_of_low_wall(ahead, turn, pitch),
        }
    };
    std::iter::repeat_with(draw).take(count).collect()
}

/// Distance of the nearest detectable echo from a low, rough wall that cuts the horizontal line of sight `ahead` m from
/// the sensor.
///
/// The reference tests 41 heights. At each height it tests points of the wall at 2000 azimuths over a quarter turn,
/// from the nearest point towards the line of sight and beyond, and refines the first detectable point by bisection.
fn nearest_echo_of_low_wall(ahead: f64, turn: f64, pitch: f64) -> Option<f64> {
    let sonar = Sonar::srf08();
    let forward = DVec3::new(math::cos(pitch), 0.0, -math::sin(pitch));
    let normal = DVec2::from_angle(turn);
    let nearest = normal * (ahead * normal.x);
    let at_height = |step: u32| {
        let z = LOW_WALL * f64::from(step) / 40.0 - LOW_HEIGHT;
        // Offset from the sensor to the point of the wall that is `azimuth` rad from the nearest point.
        let point = |azimuth: f64| {
            let metres = nearest.length() * math::tan(azimuth);
            (nearest - normal.perp() * metres.copysign(turn)).extend(z)
        };
        let is_detected = |azimuth: f64| {
            let offset = point(azimuth);
            let distance = offset.length();
            let angle = math::atan2(forward.cross(offset).length(), forward.dot(offset));
            energy(angle, distance, nearest.length() / distance) >= sonar.threshold
        };
        let azimuths = (0..2_000).map(|step| FRAC_PI_2 * f64::from(step) / 2_000.0);
        let mut detected = azimuths.into_iter().find(|azimuth| is_detected(*azimuth))?;
        let mut undetected = (detected - FRAC_PI_2 / 2_000.0).max(0.0);
        if is_detected(undetected) {
            return Some(point(undetected).length());
        }
        for _ in 0..50 {
            let middle = 0.5 * (detected + undetected);
            *(if is_detected(middle) { &mut detected } else { &mut undetected }) = middle;
        }
        Some(point(detected).length())
    };
    (0..=40).filter_map(at_height).min_by(f64::total_cmp).filter(|distance| *distance <= sonar.max)
}

/// Distance of the nearest detectable echo from a rough plane whose nearest point is at `nearest_distance` m,
/// `off_axis` rad from the line of sight.
///
/// A point of the plane at the incidence angle alpha is at the distance nearest_distance / cos(alpha), and at least
/// off_axis - alpha from the line of sight. The smallest alpha with a detectable echo is searched from 0 on and refined
/// by bisection.
fn nearest_echo(nearest_distance: f64, off_axis: f64) -> Option<f64> {
    let sonar = Sonar::srf08();
    let distance = |alpha: f64| nearest_distance / math::cos(alpha);
    let is_detected = |alpha: f64| energy(off_axis - alpha, distance(alpha), math::cos(alpha)) >= sonar.threshold;
    let steps = 10_000;
    let alphas = (0..=steps).map(|step| off_axis * f64::from(step) / f64::from(steps));
    let first = alphas.clone().position(is_detected)?;
    let alphas: Vec<f64> = alphas.collect();
    let mut detected = alphas[first];
    if first > 0 {
        let mut undetected = alphas[first - 1];
        for _ in 0..100 {
            let middle = 0.5 * (detected + undetected);
            *(if is_detected(middle) { &mut detected } else { &mut undetected }) = middle;
        }
    }
    Some(distance(detected)).filter(|distance| *distance <= sonar.max)
}

/// Energy of an echo from `distance` m, `angle` rad from the line of sight; the surface reflects the fraction
/// `reflectance` of the energy in this direction.
fn energy(angle: f64, distance: f64, reflectance: f64) -> f64 {
    let angle_ratio = angle / Sonar::srf08().half_angle;
    let two_way_gain = math::exp(-4.0 * LN_2 * angle_ratio * angle_ratio);
    if angle.abs() > FRAC_PI_2 { 0.0 } else { two_way_gain * reflectance / (distance * distance) }
}

/// Cases of sensors in rooms of 6 m with 12 boxes; every other wall is 80 % specular.
fn rooms(count: usize) -> Vec<Case> {
    let mut random = Random::new(9);
    let smooth = Surface { reflectivity: 0.9, specular: 0.8 };
    let mut cases = Vec::new();
    for seed in 0.. {
        let segments = room_with_boxes(seed, DVec2::ZERO, 6.0, 12);
        let surfaces: Vec<Surface> =
            (0..segments.len()).map(|wall| if wall % 2 == 0 { smooth } else { Surface::ROUGH }).collect();
        let world = Arc::new(world(Walls::new(segments.clone()), surfaces.clone()));
        for _ in 0..10 {
            if cases.len() == count {
                return cases;
            }
            let origin = DVec2::new(random.between(0.1, 5.9), random.between(0.1, 5.9));
            let forward = random.direction();
            let yaw = math::atan2(forward.y, forward.x);
            let truths = [true, false]
                .map(|include_hidden| nearest_echo_in_room(&segments, &surfaces, origin, forward, include_hidden));
            // Whether the hidden wall of a corner returns an echo is a matter of definition, so cases in which this
            // echo changes the reading are skipped.
            if truths[0] != truths[1] {
                continue;
            }
            cases.push(Case {
                world: Arc::clone(&world),
                world_from_sensor: Pose3::from_angles(origin.extend(HEIGHT), 0.0, 0.0, yaw),
                truth: truths[0],
            });
        }
    }
    cases
}

/// Nearest echo in a room with walls of unlimited height, by brute force.
///
/// A corner belongs to two walls, one of which may be hidden; with `include_hidden` the hidden wall also returns an
/// echo.
fn nearest_echo_in_room(
    segments: &[Segment],
    surfaces: &[Surface],
    origin: DVec2,
    forward: DVec2,
    include_hidden: bool,
) -> Option<f64> {
    let sonar = Sonar::srf08();
    let mut nearest: Option<f64> = None;
    let mut add_echo = |distance: f64, wall: usize, direction: DVec2, is_perpendicular: bool| {
        let along = segments[wall].b - segments[wall].a;
        let cos = (direction.perp_dot(along) / along.length()).abs();
        let Surface { reflectivity, specular } = surfaces[wall];
        let reflectance = reflectivity * ((1.0 - specular) * cos + if is_perpendicular { specular } else { 0.0 });
        let angle = math::atan2(forward.perp_dot(direction), forward.dot(direction));
        if distance >= sonar.min && energy(angle, distance, reflectance) >= sonar.threshold {
            nearest = Some(nearest.map_or(distance, |nearest| nearest.min(distance)));
        }
    };
    for ray in 0..REFERENCE_RAYS {
        let (sin, cos) = math::sin_cos(ray_angle(ray, REFERENCE_RAYS));
        let direction = forward.rotate(DVec2::new(cos, sin));
        if let Some((distance, wall)) = nearest_wall(segments, origin, direction, sonar.max, 0.0) {
            add_echo(distance, wall, direction, false);
        }
    }
    for (wall, segment) in segments.iter().enumerate() {
        let along = segment.b - segment.a;
        let fraction = (origin - segment.a).dot(along) / along.length_squared();
        let point = segment.a + fraction.clamp(0.0, 1.0) * along;
        let (distance, direction) = ((point - origin).length(), (point - origin).normalize_or_zero());
        // The tolerance of a nanometre allows for walls that share the point. A second ray aims at a point of this wall
        // 0.1 um further inwards: if the ray hits another wall, this wall is hidden.
        let first = nearest_wall(segments, origin, direction, sonar.max, 0.0);
        let is_unobstructed = first.is_none_or(|(first, _)| first > distance - 1e-9);
        let inward = (0.5 * (segment.a + segment.b) - point).normalize_or_zero();
        let inner_direction = (point + 1e-7 * inward - origin).normalize_or_zero();
        let is_seen =
            || nearest_wall(segments, origin, inner_direction, sonar.max, 0.0).is_some_and(|(_, hit)| hit == wall);
        if distance <= sonar.max && is_unobstructed && (include_hidden || is_seen()) {
            add_echo(distance, wall, direction, (0.0..=1.0).contains(&fraction));
        }
    }
    nearest
}

/// World that consists of walls only.
fn world(walls: Walls, surfaces: Vec<Surface>) -> World {
    let space = Space { floor: None, walls: surfaces, ..Space::default() };
    World::new(Arc::new(walls), Time::from_millis(50), std::iter::empty()).with_space(space)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn error_converges_with_the_number_of_rays() {
        // In the plane the error falls as 1/rays, in space as 1/sqrt(rays).
        for (pitch, limits) in [(0.0, [(64, 0.1), (4_096, 2e-3)]), (0.5, [(64, 0.3), (4_096, 0.03)])] {
            let cases = slanting_walls(60, pitch);
            for (rays, limit) in limits {
                let row = row("", &cases, rays, read_sonar);
                assert!(row.error > 0.0 && row.error < limit, "{} m off with {rays} rays, pitched {pitch}", row.error);
            }
        }
    }

    #[test]
    fn both_references_agree_before_the_middle_of_a_level_sensor() {
        for (ahead, turn) in [(0.5, 0.1), (2.0, 1.3), (3.5, -0.9)] {
            let low = nearest_echo_of_low_wall(ahead, turn, 0.0).expect("an echo");
            let infinite = nearest_echo(ahead * math::cos(turn), turn.abs()).expect("an echo");
            assert!((low - infinite).abs() < 1e-9, "{low} and {infinite} m");
        }
    }

    #[test]
    fn reading_in_a_room_matches_the_reference() {
        let rooms = rooms(40);
        let [core_error, rays_only_error] =
            [read_sonar as Method, read_rays_only].map(|read| row("", &rooms, 4_096, read).error);
        assert!(core_error < 1e-3 && rays_only_error > core_error, "{core_error} and {rays_only_error} m");
    }
}
