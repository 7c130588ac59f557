//! Tests of the planner without a simulator: a robot that follows every command exactly, on level ground with boulders
//! that are parabolic domes, whose ray hits have a closed form.

use std::f64::consts::{LN_2, PI};

use mapping::astar::shortest_path;
use mapping::distance::distances;
use mapping::grid::{Grid, GridGeometry};
use mapping::inverse::SonarPose;
use mapping::math;
use mapping::pose::{self, Point, rotated};
use nalgebra::{Vector2, Vector3};

use crate::body::{self, Pose, SONARS};
use crate::planner::{Corrections, LegState, Planner, Reading};

/// Pseudo-random numbers in [0, 1), determined by the seed.
struct Numbers(u64);

impl Numbers {
    fn new(seed: u64) -> Self {
        let mut numbers = Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) + 1);
        for _ in 0..10 {
            numbers.next();
        }
        numbers
    }

    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// Approximately normal number: the sum of twelve uniform ones.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() - 6.0
    }
}

/// Dome whose height is top (1 - (distance / radius)^2) where this value is positive.
struct Dome {
    x: f64,
    y: f64,
    radius: f64,
    top: f64,
}

impl Dome {
    fn height(&self, x: f64, y: f64) -> f64 {
        let (dx, dy) = (x - self.x, y - self.y);
        (self.top * (1.0 - (dx * dx + dy * dy) / (self.radius * self.radius))).max(0.0)
    }

    /// Distance along a ray from outside to the dome's surface, and the cosine of the incidence angle.
    fn met(&self, origin: &Vector3<f64>, direction: &Vector3<f64>) -> Option<(f64, f64)> {
        let (dx, dy) = (origin.x - self.x, origin.y - self.y);
        let curve = self.top / (self.radius * self.radius);
        let a = curve * (direction.x * direction.x + direction.y * direction.y);
        let b = 2.0 * curve * (dx * direction.x + dy * direction.y) + direction.z;
        let c = curve * (dx * dx + dy * dy) + origin.z - self.top;
        let root = (b * b - 4.0 * a * c).sqrt();
        let r = (-b - root) / (2.0 * a);
        let point = origin + direction * r;
        if r.is_nan() || r <= 0.0 || point.z < 0.0 {
            return None;
        }
        let normal = Vector3::new(2.0 * curve * (point.x - self.x), 2.0 * curve * (point.y - self.y), 1.0).normalize();
        Some((r, -normal.dot(direction)))
    }
}

/// Distance of the nearest echo that an SRF08 detects, m: the energy model of docs/sensors.md along 80 rays, without the
/// directions of nearest points.
fn first_echo(domes: &[Dome], sonar: &SonarPose) -> Option<f64> {
    const RAYS: usize = 80;
    let nearby: Vec<&Dome> = domes
        .iter()
        .filter(|dome| math::hypot(dome.x - sonar.origin.x, dome.y - sonar.origin.y) < 6.0 + dome.radius)
        .collect();
    let perpendicular =
        sonar.axis.cross(&if sonar.axis.z.abs() < 0.9 { Vector3::z() } else { Vector3::x() }).normalize();
    let up = sonar.axis.cross(&perpendicular);
    let mut nearest = f64::INFINITY;
    for ray in 0..RAYS {
        let (off, turn) = (1.1 * (ray as f64 / RAYS as f64).sqrt(), ray as f64 * 2.4);
        let direction =
            sonar.axis * math::cos(off) + (perpendicular * math::cos(turn) + up * math::sin(turn)) * math::sin(off);
        let ground = (direction.z < 0.0).then(|| (-sonar.origin.z / direction.z, -direction.z));
        let distances = nearby.iter().filter_map(|dome| dome.met(&sonar.origin, &direction)).chain(ground);
        let Some((r, cosine)) = distances.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        let ratio = off / (27.5 / 180.0 * PI);
        let gain = math::exp(-2.0 * LN_2 * ratio * ratio);
        if r < 6.0 && gain * gain / (r * r) * cosine >= 0.00186 {
            nearest = nearest.min(r);
        }
    }
    nearest.is_finite().then_some(nearest)
}

const START: Point = Point::new(0.0, 0.0);
const GOAL: Point = Point::new(36.0, 0.0);

/// Level ground with boulders.
struct Ground(Vec<Dome>);

impl Ground {
    fn new(numbers: &mut Numbers, boulders: usize) -> Self {
        let mut domes = Vec::new();
        while domes.len() < boulders {
            let dome = Dome {
                x: numbers.between(-2.0, 38.0),
                y: numbers.between(-14.0, 14.0),
                radius: numbers.between(0.6, 1.8),
                top: numbers.between(0.15, 1.8),
            };
            let middle = Point::new(dome.x, dome.y);
            if [START, GOAL].iter().all(|end| (middle - end).norm() > dome.radius + 3.5) {
                domes.push(dome);
            }
        }
        Self(domes)
    }

    fn height(&self, point: Point) -> f64 {
        self.0.iter().map(|dome| dome.height(point.x, point.y)).fold(0.0, f64::max)
    }

    /// Length of the shortest path that keeps 2 m from ground higher than 0.5 m.
    fn shortest(&self) -> Option<f64> {
        let frame = GridGeometry::new(Point::new(-4.0, -16.0), 0.25, 176, 128);
        let room = distances(&Grid::from_fn(frame, |cell| self.height(frame.centre(cell)) > 0.5), |is_high| *is_high);
        let factor = |cell| (room[cell] > 2.0).then_some(1.0);
        shortest_path(&frame, factor, frame.cell_at(START)?, frame.cell_at(GOAL)?).map(|path| path.cost)
    }
}

/// Points below the robot at which the ground must be low, m ahead of and to the left of its centre: about the reach of
/// the feet.
const UNDER: [(f64, f64); 9] =
    [(0.0, 0.0), (1.5, 1.0), (1.5, 0.0), (1.5, -1.0), (0.0, 1.0), (0.0, -1.0), (-1.5, 1.0), (-1.5, 0.0), (-1.5, -1.0)];

struct Outcome {
    length: f64,
    /// Maximum height of the ground at the points [`UNDER`], m.
    under: f64,
    remaining_distance: f64,
}

/// Simulates a walk with 1 % of the echoes lost, errors of 0.5 %, and a drift of the heading that odometry does not
/// see.
fn walk(ground: &Ground, numbers: &mut Numbers) -> Outcome {
    let mut planner = Planner::new(0.0, Corrections::Both);
    let mut truth = Pose { ground: pose::Pose { position: START, heading: 0.0 }, lift: 0.0 };
    let mut estimate = truth;
    let mut outcome = Outcome { length: 0.0, under: 0.0, remaining_distance: 36.0 };
    let feet = [(1.2, 0.8), (1.2, -0.8), (-1.2, 0.8), (-1.2, -0.8)];
    for _ in 0..1200 {
        let readings: Vec<Reading> = (0..SONARS)
            .map(|sonar| {
                let distance = first_echo(&ground.0, &truth.sonar(&body::mount(sonar)));
                let distance = distance.filter(|_| numbers.next() > 0.01).map(|d| d * (1.0 + 0.005 * numbers.normal()));
                Reading { sonar, pose: estimate, distance }
            })
            .collect();
        planner.observe(&readings);
        let to_goal = GOAL - truth.ground.position;
        outcome.remaining_distance = to_goal.norm();
        if outcome.remaining_distance < 0.5 {
            break;
        }
        let legs = feet.map(|(x, y)| LegState {
            shank: Vector3::new(x, y, 0.6),
            tip: Vector3::new(x, y, 0.0),
            is_in_the_air: true,
        });
        let bearing = math::atan2(to_goal.y, to_goal.x) - truth.ground.heading;
        let orders = planner.plan(&estimate, estimate.ground.heading + bearing, outcome.remaining_distance, &legs);
        for pose in [&mut truth.ground, &mut estimate.ground] {
            pose.position += 0.25 * rotated(orders.velocity, pose.heading);
            pose.heading += 0.25 * orders.turn;
        }
        truth.ground.heading += 0.004 * numbers.normal();
        outcome.length += 0.25 * orders.velocity.norm();
        for (x, y) in UNDER {
            let point = truth.ground.position + rotated(Vector2::new(x, y), truth.ground.heading);
            outcome.under = outcome.under.max(ground.height(point));
        }
    }
    outcome
}

#[test]
fn it_arrives_between_boulders_without_treading_on_a_high_one() {
    for seed in 0..6 {
        let mut numbers = Numbers::new(seed);
        let ground = Ground::new(&mut numbers, 18);
        let shortest = ground.shortest().expect("a way with room");
        let Outcome { length, under, remaining_distance: left } = walk(&ground, &mut numbers);
        assert!(left < 0.5, "seed {seed}: {left:.1} m left");
        assert!(under < 0.5, "seed {seed}: {under:.2} m under it");
        assert!(length < 1.5 * shortest, "seed {seed}: {length:.1} m, {shortest:.1} m at best");
    }
}
