//! The planner without a simulator: a robot that goes exactly where it is told, over level ground with boulders that are parabolic
//! domes, which rays meet in closed form.

use std::f64::consts::{LN_2, PI};

use mapping::inverse::SonarPose;
use mapping::math;
use nalgebra::Vector3;

use crate::body::{self, Pose, SONARS};
use crate::planner::{LegState, Planner, Reading};

/// Numbers in [0, 1), always the same of one seed.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// About normal: the sum of twelve.
    fn normal(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() - 6.0
    }
}

/// Height top (1 - (distance / radius)^2) where that is positive.
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

    /// Distance along a ray to its surface from outside, and the cosine of the incidence.
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

/// What an SRF08 hears first, m, as docs/sensors.md has it.
fn heard(domes: &[Dome], sonar: &SonarPose) -> Option<f64> {
    const RAYS: usize = 80;
    let near: Vec<&Dome> = domes
        .iter()
        .filter(|dome| math::hypot(dome.x - sonar.origin.x, dome.y - sonar.origin.y) < 6.0 + dome.radius)
        .collect();
    let aside = sonar.axis.cross(&if sonar.axis.z.abs() < 0.9 { Vector3::z() } else { Vector3::x() }).normalize();
    let up = sonar.axis.cross(&aside);
    let mut nearest = f64::INFINITY;
    for ray in 0..RAYS {
        let (off, turn) = (1.1 * (ray as f64 / RAYS as f64).sqrt(), ray as f64 * 2.4);
        let direction = sonar.axis * math::cos(off) + (aside * math::cos(turn) + up * math::sin(turn)) * math::sin(off);
        let ground = (direction.z < 0.0).then(|| (-sonar.origin.z / direction.z, -direction.z));
        let met = near.iter().filter_map(|dome| dome.met(&sonar.origin, &direction)).chain(ground);
        let Some((r, cosine)) = met.min_by(|a, b| a.0.total_cmp(&b.0)) else { continue };
        let ratio = off / (27.5 / 180.0 * PI);
        let gain = math::exp(-2.0 * LN_2 * ratio * ratio);
        if r < 6.0 && gain * gain / (r * r) * cosine >= 0.00186 {
            nearest = nearest.min(r);
        }
    }
    nearest.is_finite().then_some(nearest)
}

/// A walk from (0, 0) to (36, 0).
struct Outcome {
    length: f64,
    has_arrived: bool,
    /// The highest that stood under a foot or the body's middle, m.
    under: f64,
    left: f64,
}

fn walk(seed: u64, boulders: usize) -> Outcome {
    let mut numbers = Numbers(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) + 1);
    for _ in 0..10 {
        numbers.next();
    }
    let goal = (36.0, 0.0);
    let mut domes = Vec::new();
    while domes.len() < boulders {
        let dome = Dome {
            x: numbers.between(-2.0, 38.0),
            y: numbers.between(-14.0, 14.0),
            radius: numbers.between(0.6, 1.8),
            top: numbers.between(0.15, 1.8),
        };
        let is_clear = |(x, y): (f64, f64)| math::hypot(dome.x - x, dome.y - y) > dome.radius + 3.5;
        if is_clear((0.0, 0.0)) && is_clear(goal) {
            domes.push(dome);
        }
    }
    let height = |x: f64, y: f64| domes.iter().map(|dome| dome.height(x, y)).fold(0.0, f64::max);
    let mut planner = Planner::new(0.0);
    let mut pose = Pose::default();
    let (mut length, mut under) = (0.0, 0.0f64);
    let feet = [(1.2, 0.8), (1.2, -0.8), (-1.2, 0.8), (-1.2, -0.8)];
    for _ in 0..1200 {
        let readings: Vec<Reading> = (0..SONARS)
            .map(|sonar| {
                let distance = heard(&domes, &pose.sonar(&body::mount(sonar)));
                let distance = distance.filter(|_| numbers.next() > 0.01).map(|d| d * (1.0 + 0.005 * numbers.normal()));
                Reading { sonar, pose, distance }
            })
            .collect();
        planner.observe(&readings);
        let (dx, dy) = (goal.0 - pose.x, goal.1 - pose.y);
        let left = math::hypot(dx, dy);
        if left < 0.5 {
            return Outcome { length, has_arrived: true, under, left };
        }
        let legs = feet.map(|(x, y)| LegState {
            shank: Vector3::new(x, y, 0.6),
            tip: Vector3::new(x, y, 0.0),
            is_in_the_air: true,
        });
        let orders = planner.plan(&pose, math::atan2(dy, dx), left, &legs);
        if std::env::var_os("ALDURO_TELL").is_some() {
            println!("{:.2} {:.2} v {:.2} {:.2}", pose.x, pose.y, orders.velocity.x, orders.velocity.y);
        }
        let (vx, vy) = pose.turned(orders.velocity.x, orders.velocity.y);
        pose.x += 0.25 * vx;
        pose.y += 0.25 * vy;
        length += 0.25 * orders.velocity.norm();
        pose.heading += 0.25 * orders.turn + 0.004 * numbers.normal();
        for foot in feet.into_iter().chain([(0.0, 0.0)]) {
            let (x, y) = pose.turned(foot.0, foot.1);
            under = under.max(height(pose.x + x, pose.y + y));
        }
    }
    let left = math::hypot(goal.0 - pose.x, goal.1 - pose.y);
    Outcome { length, has_arrived: false, under, left }
}

#[test]
#[ignore = "open: of some boulders it hears too little, and treads on 0.64 m (seed 1)"]
fn it_arrives_between_boulders_without_treading_on_a_high_one() {
    for seed in 0..4 {
        let outcome = walk(seed, 18);
        assert!(outcome.has_arrived, "seed {seed}: {:.1} m left", outcome.left);
        assert!(outcome.under < 0.6, "seed {seed}: {:.2} m under a foot", outcome.under);
        assert!(outcome.length < 60.0, "seed {seed}: {:.1} m", outcome.length);
    }
}

#[test]
#[ignore = "prints many walks"]
fn many() {
    let boulders = std::env::var("BOULDERS").map_or(18, |n| n.parse().unwrap());
    for seed in 0..12 {
        let Outcome { length, has_arrived, under, left } = walk(seed, boulders);
        println!("{seed}: {has_arrived} length {length:.1} left {left:.1} under {under:.2}");
    }
}
