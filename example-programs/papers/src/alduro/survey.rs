//! Sonar readings of random terrains: a beam with sonars passes over each terrain.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::fs;

use anyhow::{Context as _, ensure};
use mapping::inverse::SonarPose;
use mapping::math;
use nalgebra::Vector3;
use sim_core::scene::{Boulders, HeightField};
use sim_host::launch::Options;

use super::ground::Terrain;
use crate::run::{Job, Run, Scene};
use crate::trace::{Event, Trace};

/// Side of the terrain, m.
pub const SIDE: f64 = 10.0;
/// Height of the beam, m.
pub const HEIGHT: f64 = 2.5;
/// Number of points along a side at which heights are compared.
const PLACES: usize = 100;
/// Number of sonars on the beam across the terrain: as many as one bus takes.
const SONARS: usize = 16;
/// Forward tilt of every second sonar, degrees from straight down.
const TILT_DEG: f64 = 25.0;
/// Errors of the robot's odometry in [`Condition::Odometry`]: the fraction by which distances are too long, and the
/// drift of the heading in degrees per metre, to the left on every second terrain and to the right on the others.
const ODOMETRY: (f64, f64) = (0.02, 0.5);

/// Properties of sonars and poses in a survey. The maps always assume the first condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Condition {
    /// The beam of the inverse model, the noise of sonars in the profile `real` without outliers, and true poses.
    AsAssumed,
    /// Sonars with a narrower beam: 20 degrees from the line of sight to its points of -6 dB instead of 27.5.
    Beam,
    /// The noise of sonars in the profile `harsh`: 3 to 4 times the errors, a bias, outliers and more lost echoes.
    Noise,
    /// Poses from odometry with systematic errors.
    Odometry,
}

impl Condition {
    /// All conditions.
    pub const ALL: [Self; 4] = [Self::AsAssumed, Self::Beam, Self::Noise, Self::Odometry];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::AsAssumed => "as assumed",
            Self::Beam => "other beam",
            Self::Noise => "other noise",
            Self::Odometry => "odometry",
        }
    }

    /// Table `noise` of the scene.
    fn noise(self) -> &'static str {
        match self {
            Self::Noise => {
                "{ sonar = { sigma_mm = 15, sigma_percent = 2, step_mm = 30, bias_sigma_mm = 10, outlier = 0.02, dropout = 0.05 } }"
            }
            _ => "{ sonar = { sigma_mm = 5, sigma_percent = 0.5, step_mm = 10, dropout = 0.01 } }",
        }
    }

    /// Half angle of the sonars, degrees.
    fn half_angle_deg(self) -> f64 {
        if self == Self::Beam { 20.0 } else { 27.5 }
    }
}

/// A reading, with the sonar's pose as the robot estimates it.
pub type SonarReading = (SonarPose, f64);

/// A terrain and its readings in the order of their times.
pub struct Survey {
    /// Seed of the terrain and of the noise.
    pub seed: u64,
    /// The terrain.
    pub field: HeightField,
    /// Terrain heights at the compared points, m.
    heights: Vec<f64>,
    readings: Vec<SonarReading>,
}

impl Survey {
    /// `count` of the readings, at equal intervals.
    ///
    /// # Errors
    /// If there are fewer readings.
    pub fn readings(&self, count: usize) -> anyhow::Result<Vec<SonarReading>> {
        let all = self.readings.len();
        ensure!(all >= count, "terrain {} has {all} echoes, {count} are wanted", self.seed);
        Ok((0..count).map(|index| self.readings[index * all / count]).collect())
    }

    /// Root mean square error of a height map, m, in the square from (0, 0) with this side.
    pub fn rms(&self, side: f64, height: impl Fn(f64, f64) -> f64) -> f64 {
        let compared = compared_points().zip(&self.heights).filter(|((x, y), _)| *x < side && *y < side);
        let square = |((x, y), truth): ((f64, f64), &f64)| (height(x, y) - truth).powi(2);
        let (sum, count) = compared.map(square).fold((0.0, 0), |(sum, count), square| (sum + square, count + 1));
        (sum / f64::from(count)).sqrt()
    }
}

/// The compared points, m.
fn compared_points() -> impl Iterator<Item = (f64, f64)> {
    let coordinate = |index: usize| (index as f64 + 0.5) * SIDE / PLACES as f64;
    (0..PLACES * PLACES).map(move |index| (coordinate(index % PLACES), coordinate(index / PLACES)))
}

/// Runs the surveys of the terrains with these seeds. It also writes the true heights at the compared points beside the
/// traces, in m, with a row of points along x on each line, so that others can compute errors of maps without this
/// program.
///
/// # Errors
/// If a scene does not run to its end, or a file cannot be written.
pub fn measure(job: &Job, seeds: impl Iterator<Item = u64>, condition: Condition) -> anyhow::Result<Vec<Survey>> {
    let seeds: Vec<u64> = seeds.collect();
    let terrain = |seed: u64| {
        let boulders = Boulders { count: 12, radius: [0.5, 1.5], height: [0.2, 1.0] };
        Terrain::new(seed, SIDE, 0.3, boulders, Vec::new())
    };
    let run = |seed: &u64| {
        let name = format!("survey-{}-{seed}", condition.name().replace(' ', "-"));
        let scene = Scene::Text(scene(&terrain(*seed), condition));
        Run { name, scene, options: Options { seed: Some(*seed), ..Options::default() } }
    };
    let runs: Vec<Run> = seeds.iter().map(run).collect();
    let echoes = job.run(&runs, |_, trace| echoes(&trace))?;
    let survey = |(seed, mut readings): (u64, Vec<SonarReading>)| {
        if condition == Condition::Odometry {
            readings.iter_mut().for_each(|(sonar, _)| *sonar = by_odometry(sonar, seed));
        }
        let field = terrain(seed).field()?;
        let heights: Vec<f64> = compared_points().map(|(x, y)| field.height(x, y)).collect();
        let row = |row: &[f64]| row.iter().map(|height| format!("{height:.6}")).collect::<Vec<_>>().join(",");
        let table: Vec<String> = heights.chunks(PLACES).map(row).collect();
        let path = job.folder().join("runs").join(format!("heights-{seed}.csv"));
        fs::write(&path, table.join("\n")).with_context(|| format!("cannot write `{}`", path.display()))?;
        Ok(Survey { seed, field, heights, readings })
    };
    seeds.into_iter().zip(echoes).map(survey).collect()
}

/// The pose of a sonar according to odometry with systematic errors: the robot drives straight, and its odometry
/// follows an arc.
fn by_odometry(sonar: &SonarPose, seed: u64) -> SonarPose {
    let (scale, drift_deg) = ODOMETRY;
    let side = if seed.is_multiple_of(2) { 1.0 } else { -1.0 };
    let curvature = side * drift_deg.to_radians();
    let driven = (1.0 + scale) * sonar.origin.x;
    let heading = curvature * driven;
    let (sine, cosine) = math::sin_cos(heading);
    let lateral = sonar.origin.y - SIDE / 2.0;
    let (x, y) = (sine / curvature, SIDE / 2.0 + (1.0 - cosine) / curvature);
    let origin = Vector3::new(x - lateral * sine, y + lateral * cosine, sonar.origin.z);
    let axis = Vector3::new(
        cosine * sonar.axis.x - sine * sonar.axis.y,
        sine * sonar.axis.x + cosine * sonar.axis.y,
        sonar.axis.z,
    );
    SonarPose { origin, axis }
}

/// Mounting of sonar `index` on the beam, in the robot's frame: y in m, and the pitch in degrees.
fn mount(index: usize) -> (f64, f64) {
    let y = ((index as f64 + 0.5) / SONARS as f64 - 0.5) * SIDE;
    (y, if index.is_multiple_of(2) { -90.0 } else { -90.0 + TILT_DEG })
}

fn scene(terrain: &Terrain, condition: Condition) -> String {
    let mut text = format!(
        "[scene]\nuntil_s = 60\nnoise = {}\n\n{}\n[[robot_type]]\nname = \"Surveyor\"\n\n",
        condition.noise(),
        terrain.world()
    );
    for index in 0..SONARS {
        let ((y, pitch), number, z) = (mount(index), index + 1, HEIGHT * 1e3);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "[[robot_type.sonar]]\nname = \"SONAR_{number}\"\nid = {number}\ny_mm = {}\nz_mm = {z}\npitch_deg = {pitch}\n\
             half_angle_deg = {}\n",
            y * 1e3,
            condition.half_angle_deg()
        );
    }
    let _ = write!(
        text,
        "[[robot]]\ntype = \"Surveyor\"\nprogram = \"%sim%/example-programs/alduro\"\narguments = [\"survey\", \"{SIDE}\"]\n\
         x_mm = 0\ny_mm = {}\n",
        SIDE / 2.0 * 1e3
    );
    text
}

/// The echoes of a run in the order of their times, each with the true pose of its sonar.
fn echoes(trace: &Trace) -> anyhow::Result<Vec<SonarReading>> {
    let poses: Vec<(f64, f64, f64)> = trace
        .of_robot(1)
        .filter_map(|entry| match entry.event {
            Event::Pose { x_m, y_m, .. } => Some((entry.at, x_m, y_m)),
            _ => None,
        })
        .collect();
    // The robot drives straight at constant speed.
    let position_at = |at: f64| -> Option<(f64, f64)> {
        let after = poses.partition_point(|pose| pose.0 < at).clamp(1, poses.len().checked_sub(1)?);
        let ((t0, x0, y0), (t1, x1, y1)) = (poses.get(after - 1)?, poses.get(after)?);
        let fraction = ((at - t0) / (t1 - t0)).clamp(0.0, 1.0);
        Some((x0 + fraction * (x1 - x0), y0 + fraction * (y1 - y0)))
    };
    let mut echoes = Vec::new();
    for entry in trace.of_robot(1) {
        let Event::Distance { device, distance_m: Some(distance), measured_s } = &entry.event else { continue };
        let number: usize =
            device.strip_prefix("SONAR_").and_then(|n| n.parse().ok()).context("a device that is not a sonar")?;
        let (x, y) = position_at(*measured_s).context("no poses")?;
        let (lateral, pitch_deg) = mount(number - 1);
        let origin = Vector3::new(x, y + lateral, HEIGHT);
        echoes.push((SonarPose::new(origin, 0.0, pitch_deg / 180.0 * PI), *distance));
    }
    Ok(echoes)
}
