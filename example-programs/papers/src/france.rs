//! France et al. 1999, sections 5 and 6: proximity sensors on the leg of a walking robot.
//!
//! The biped walks through a dining room towards a small obstacle, once for each sensor, mount point and noise setting
//! (no noise, or the noise of section 5). Its program computes the profile of the ground. This module compares the
//! profile with the truth.

pub mod floors;
mod side;
mod walk;

use std::f64::consts::PI;

use accuracy::figure::{Figure as Chart, Mark, Scale, Series};
use anyhow::Context as _;

use crate::page::{Basis, Claim, Figure, Page, Picture, Table, Weight};
use crate::run::{Job, Run, Scene};
use sim_core::drive::legged::natural_angles;
use sim_core::time::Time;
use sim_host::launch::Options;
pub use walk::{Hit, Kind, Moment, MountPoint, SCENE, Sample, Thing, Truth, Walk};

/// Speed of the walk, mm/s: one stride of the gait (1.43 m for legs of this length) per gait period.
pub const SPEED_MM_S: u32 = 1300;
/// Incidence angles on the ground in section 6.3, degrees.
const INCIDENCES: [f64; 2] = [33.0, 78.0];
/// Tolerance of our incidence angles, degrees.
const INCIDENCE_ERROR: f64 = 5.0;
/// The paper's standard deviation of N.
const SIGMA: f64 = 0.01;
/// Tolerance of a profile without noise, m. The program reads distance, position and posture within 1 ms of each other,
/// and distance and position in whole millimetres.
const EXACT: f64 = 0.01;

/// Scene of the robot without an obstacle.
const FREE: &str = r#"[scene]
until_s = 15

[world]
floor_mm = [10000, 4000]

[[robot]]
type = "%sim%/robis/biped.robi"
program = "%sim%/example-programs/walker"
arguments = ["body", "ultrasonic", "SPEED"]
x_mm = 1000
y_mm = 1500
api = 7
"#;

/// Tolerance of the joint angles: root mean square difference from the gait's source over the cycle, degrees.
const GAIT_ERROR: f64 = 5.0;

/// The walks for all sensors and mount points, with and without noise.
pub struct Walks {
    /// The room and the robot.
    pub truth: Truth,
    walks: Vec<Walk>,
    /// Walk of 4 m over an empty floor: two whole gait cycles.
    pub free: Walk,
}

/// Noise of the sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Noise {
    /// No noise.
    Without,
    /// The noise of section 5.
    Paper,
}

impl Noise {
    const ALL: [Self; 2] = [Self::Without, Self::Paper];
}

impl Walks {
    /// Runs all walks.
    ///
    /// # Errors
    /// If a walk does not run to its end.
    pub fn run(job: &Job) -> anyhow::Result<Self> {
        let truth = Truth::read()?;
        // Short slots, since the trace gives the true posture only at the end of a slot; nothing else depends on the
        // slot length.
        let slot = Some(Time::from_millis(2));
        let mut runs = Vec::new();
        let mut cases = Vec::new();
        for place in MountPoint::ALL {
            for kind in Kind::ALL {
                for noise in Noise::ALL {
                    let suffix = if noise == Noise::Paper { "-noise" } else { "" };
                    let (place_name, kind_name) = (place.name(), kind.name());
                    let options = Options {
                        slot,
                        arguments: vec![format!("1:{place_name} {kind_name} {SPEED_MM_S}")],
                        noise: (noise == Noise::Without).then(|| "none".to_owned()),
                        ..job.options()
                    };
                    let name = format!("{place_name}-{kind_name}{suffix}");
                    runs.push(Run { name, scene: Scene::File(SCENE.into()), options });
                    cases.push((place, kind));
                }
            }
        }
        let scene = Scene::Text(FREE.replace("SPEED", &SPEED_MM_S.to_string()));
        runs.push(Run { name: "free".to_owned(), scene, options: Options { slot, ..job.options() } });
        cases.push((MountPoint::Body, Kind::Ultrasonic));
        let mut walks = job.run(&runs, |run, trace| {
            let index = runs.iter().position(|other| other.name == run.name).context("a run of these")?;
            let (section, kind) = cases[index];
            truth.walk(section, kind, &trace)
        })?;
        let free = walks.pop().context("a walk over an empty floor")?;
        Ok(Self { truth, walks, free })
    }

    /// The walk with this sensor, mount point and noise.
    pub fn of(&self, place: MountPoint, kind: Kind, noise: Noise) -> &Walk {
        &self.walks[(place as usize * Kind::ALL.len() + kind as usize) * Noise::ALL.len() + noise as usize]
    }
}

impl Walk {
    /// Readings that gave a point of the profile and whose true hit point is on `thing`.
    pub fn points_on(&self, thing: Thing) -> impl Iterator<Item = &Sample> {
        self.samples.iter().filter(move |sample| sample.point.is_some() && sample.truth.thing == thing)
    }

    /// Time of the first detection of the small obstacle, s.
    pub fn first_obstacle(&self) -> Option<f64> {
        self.points_on(Thing::Obstacle).next().map(|sample| sample.at)
    }

    /// Periods of readings that see the ground before the obstacle is detected: begin and end of each, s. Readings that
    /// do not see the ground separate them.
    pub fn ground_periods(&self) -> Vec<(f64, f64)> {
        let until = self.first_obstacle().unwrap_or(f64::INFINITY);
        let mut periods: Vec<(f64, f64)> = Vec::new();
        let mut is_open = false;
        for sample in self.samples.iter().filter(|sample| sample.at < until) {
            let sees = sample.point.is_some() && sample.truth.thing == Thing::Floor;
            match periods.last_mut() {
                Some(period) if sees && is_open => period.1 = sample.at,
                _ if sees => periods.push((sample.at, sample.at)),
                _ => {}
            }
            is_open = sees;
        }
        periods
    }

    /// Distances of the profile's points from the true hits, m.
    pub fn profile_errors(&self) -> Vec<f64> {
        let error = |sample: &Sample| Some((sample.point? - sample.truth.point).length());
        self.samples.iter().filter_map(error).collect()
    }
}

/// Minimum and maximum incidence angle of the sensor's ray on the floor within the sensor's range, degrees, over all
/// moments of the trace until the robot stops.
pub fn incidences(truth: &Truth, walk: &Walk, place: MountPoint, kind: Kind) -> Option<(f64, f64)> {
    let on_floor = walk.moments.iter().filter(|moment| moment.at <= walk.stopped()).filter_map(|moment| {
        let hit = truth.hit(&truth.ray(place, kind, moment));
        (hit.thing == Thing::Floor && hit.distance <= kind.max()).then_some(hit.incidence * 180.0 / PI)
    });
    on_floor.fold(None, |range, degrees| {
        let (low, high) = range.unwrap_or((degrees, degrees));
        Some((degrees.min(low), degrees.max(high)))
    })
}

/// Makes the page.
///
/// # Errors
/// If a scene does not run to its end, or a chart cannot be drawn.
pub fn run(job: &Job) -> anyhow::Result<Page> {
    let walks = Walks::run(job)?;
    let mut page = Page::new(
        "Proximity sensors on a walking robot",
        "L. France, A. Girault, J-D. Gascuel, B. Espiau: Sensor Modeling for a Walking Robot Simulation, 1999",
    );
    page.claims = claims(&walks);
    introduce(&mut page, &walks);
    gait(&mut page, &walks)?;
    curves(&mut page, &walks)?;
    page.heading("Other places of the sensor");
    page.text(
        "The same walks with the sensor on the thigh, looking down by 40 degrees, and on the body, level, as on a robot with wheels. \
         The thigh swings by 24 degrees forward at most, so its sensor always looks down by more than 15 degrees: the ultrasonic sensor \
         never meets the face of the obstacle head on, and the robot collides with it. The sensor on the body sees nothing lower than \
         itself: neither ground nor obstacle.",
    );
    page.table(mount_points(&walks));
    Ok(page)
}

fn introduce(page: &mut Page, walks: &Walks) {
    let Truth { obstacle_at, obstacle_size, .. } = &walks.truth;
    page.text(format!(
        "The paper gives no measures of robot, gait and room; these are our choice. A biped of the size of a grown person walks at \
         {SPEED_MM_S} mm/s between a table with chairs and a sideboard towards a box, {:.0} mm high, whose face is {:.2} m ahead of \
         the start. Its program reads one sensor every 25 ms, computes the world position of what is met from odometry, the pose of the \
         leg's link and the place of the sensor on it (section 6.2), and stops 0.65 m before what is higher than 60 mm in the profile. \
         Times count from the start of the run; the paper's walk is slower.",
        1000.0 * obstacle_size.z, obstacle_at
    ));
    page.text(
        "The ideal sensor is one of 2 m that detects at any incidence, without noise. Each walk is run twice: without noise, and with the \
         noise of section 5, sigma 0.01, which is drawn anew every 60 ms.",
    );
}

/// Figures 6 and 7.
fn gait(page: &mut Page, walks: &Walks) -> anyhow::Result<()> {
    let walk = walks.of(MountPoint::Tibia, Kind::Ideal, Noise::Without);
    page.heading("Robot and gait");
    page.figure(Figure {
        name: "figure-6".to_owned(),
        label: "Figure 6: the biped, standing".to_owned(),
        caption: "Thighs, shanks and feet; the right leg, in blue, bears the sensors.".to_owned(),
        claim: "Length of thigh and shank".to_owned(),
        number: walks
            .truth
            .robi
            .legs
            .as_ref()
            .and_then(|legs| legs.legs.first())
            .map_or(String::new(), |leg| format!("{:.0} mm and {:.0} mm", 1000.0 * leg.thigh, 1000.0 * leg.shank)),
        picture: Picture::Svg(side::model(&walks.truth, walk)),
    });
    page.figure(Figure {
        name: "walk".to_owned(),
        label: "The walk of the ideal sensor on the tibia".to_owned(),
        caption: "The legs every 0.15 s, the rays of all readings that met something within 2 m, and where.".to_owned(),
        claim: "The robot stops before the obstacle".to_owned(),
        number: format!("{:.2} m from the body's centre to the face", walk.gap),
        picture: Picture::Svg(side::walk(
            &walks.truth,
            walk,
            MountPoint::Tibia,
            Kind::Ideal,
            0.15,
            "The walk, to scale",
        )),
    });
    page.figure(cycle(&walks.free)?);
    Ok(())
}

/// Joints of a leg that turn in the plane of the walk: name, and index in the leg.
const JOINTS: [(&str, usize); 3] = [("thigh, forward", 2), ("knee, bent", 3), ("ankle, toes up", 4)];
/// Number of joints in a leg of the biped.
const JOINTS_OF_LEG: usize = 5;

/// Angles of the right leg's joints at each percent of the gait cycle, from one footfall to the next, degrees. The
/// cycle is the last whole one before the robot stops; `None` if there is none.
pub fn cycle_angles(walk: &Walk) -> Option<Vec<[f64; 3]>> {
    let stopped = walk.stopped();
    let pair = walk.footfalls.windows(2).rfind(|pair| pair[1] <= stopped)?;
    let at = |percent: usize| walk.at_time(pair[0] + (pair[1] - pair[0]) * percent as f64 / 100.0);
    let angles = |percent| JOINTS.map(|(_, joint)| at(percent).joints[JOINTS_OF_LEG + joint] * 180.0 / PI);
    Some((0..=100).map(angles).collect())
}

/// Root mean square difference between our angles and those of the source over the cycle, for each joint, degrees.
pub fn source_differences(angles: &[[f64; 3]]) -> [f64; 3] {
    std::array::from_fn(|joint| {
        let difference = |(percent, ours): (usize, &[f64; 3])| ours[joint] - source(percent)[joint];
        let squares: f64 = angles.iter().enumerate().map(difference).map(|degrees| degrees * degrees).sum();
        (squares / angles.len() as f64).sqrt()
    })
}

/// Joint angles of the gait's source, degrees.
fn source(percent: usize) -> [f64; 3] {
    natural_angles(percent as f64 / 100.0).map(|radians| radians * 180.0 / PI)
}

/// Figure 7.
fn cycle(walk: &Walk) -> anyhow::Result<Figure> {
    let angles = cycle_angles(walk).context("no whole gait cycle before the robot stops")?;
    let differences = source_differences(&angles);
    let curve = |name: String, mark, angle: &dyn Fn(usize) -> f64| Series {
        name,
        mark,
        points: (0..=100).map(|percent| (percent as f64, angle(percent))).collect(),
    };
    let ours = JOINTS
        .iter()
        .enumerate()
        .map(|(place, (name, _))| curve((*name).to_owned(), Mark::Line, &|percent| angles[percent][place]));
    let theirs = JOINTS
        .iter()
        .enumerate()
        .map(|(place, (name, _))| curve(format!("{name}, source"), Mark::Dots, &|percent| source(percent)[place]));
    let chart = Chart {
        name: "figure-7".to_owned(),
        title: "Joint angles of the right leg from one footfall to the next".to_owned(),
        x_label: "fraction of the cycle, %".to_owned(),
        y_label: "angle, degrees".to_owned(),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        series: ours.chain(theirs).collect(),
    };
    Ok(Figure {
        name: chart.name.clone(),
        label: "Figure 7: the gait cycle".to_owned(),
        caption: "Lines: the last whole cycle of a walk of 4 m over an empty floor, as the trace tells it. Dots: children at free speed, Schwartz, Rozumalski \
                  and Trost 2008, electronic addendum; the paper shows the cycle of a child from Vaughan et al. 1992, without numbers."
            .to_owned(),
        claim: "Root mean square of the differences from the source: thigh, knee, ankle".to_owned(),
        number: differences.map(|degrees| format!("{degrees:.1}")).join(", ") + " degrees",
        picture: Picture::chart(&chart)?,
    })
}

/// Figures 8 to 15.
fn curves(page: &mut Page, walks: &Walks) -> anyhow::Result<()> {
    page.heading("Distance curves and profiles");
    for (number, kind) in (8..).step_by(2).zip(Kind::ALL) {
        let exact = walks.of(MountPoint::Tibia, kind, Noise::Without);
        let noisy = walks.of(MountPoint::Tibia, kind, Noise::Paper);
        let distances = |walk: &Walk| walk.samples.iter().map(|sample| (sample.at, sample.distance)).collect();
        let curve = |name: &str, walk| Series { name: name.to_owned(), mark: Mark::Line, points: distances(walk) };
        let mut series = vec![curve("exact", exact)];
        if kind != Kind::Ideal {
            series.push(curve("with noise", noisy));
        }
        let chart = Chart {
            name: format!("figure-{number}"),
            title: format!("Distance curve, {} sensor on the tibia", kind.name()),
            x_label: "time, s".to_owned(),
            y_label: "distance, m".to_owned(),
            x_scale: Scale::Linear,
            y_scale: Scale::Linear,
            series,
        };
        let [floor, obstacle] = [Thing::Floor, Thing::Obstacle].map(|thing| exact.points_on(thing).count());
        page.figure(Figure {
            name: chart.name.clone(),
            label: format!("Figure {number}"),
            caption: format!("What the {} sensor read; {} m where it detects nothing.", kind.name(), kind.max()),
            claim: "Readings that met the ground, the obstacle, and nothing within range or incidence".to_owned(),
            number: format!("{floor}, {obstacle}, {}", exact.samples.iter().filter(|s| s.point.is_none()).count()),
            picture: Picture::chart(&chart)?,
        });
        let chart = Chart {
            name: format!("figure-{}", number + 1),
            title: format!("Profile, {} sensor on the tibia", kind.name()),
            x_label: "ahead of the start, m".to_owned(),
            y_label: "height, m".to_owned(),
            series: profile(walks, kind),
            ..chart
        };
        let (mean, max) = mean_and_most(&exact.profile_errors());
        page.figure(Figure {
            name: chart.name.clone(),
            label: format!("Figure {}", number + 1),
            caption: format!("The points that the program computed from the distance curve of Figure {number}."),
            claim: "Distance of the points without noise from what was met, on average and at most".to_owned(),
            number: format!("{:.1} mm, {:.1} mm", 1000.0 * mean, 1000.0 * max),
            picture: Picture::chart(&chart)?,
        });
    }
    Ok(())
}

/// Series of a profile's points and of the true profile.
fn profile(walks: &Walks, kind: Kind) -> Vec<Series> {
    let points = |noise| {
        let samples = walks.of(MountPoint::Tibia, kind, noise).samples.iter();
        samples.filter_map(|sample| sample.point).map(|point| (point.x, point.y)).collect()
    };
    let end = walks.truth.obstacle_at + walks.truth.obstacle_size.x + 0.4;
    let mut series = vec![
        Series { name: "truth".to_owned(), mark: Mark::Line, points: side::profile(&walks.truth, 0.0, end).to_vec() },
        Series { name: "exact".to_owned(), mark: Mark::Dots, points: points(Noise::Without) },
    ];
    if kind != Kind::Ideal {
        series.push(Series { name: "with noise".to_owned(), mark: Mark::Dots, points: points(Noise::Paper) });
    }
    series
}

fn mean_and_most(values: &[f64]) -> (f64, f64) {
    let sum: f64 = values.iter().sum();
    (sum / values.len().max(1) as f64, values.iter().fold(0.0, |max, value| value.max(max)))
}

/// Table of all walks.
fn mount_points(walks: &Walks) -> Table {
    let head = [
        "place",
        "sensor",
        "noise",
        "readings",
        "on the ground",
        "on the obstacle",
        "elsewhere",
        "no echo",
        "profile error, mean (mm)",
        "profile error, maximum (mm)",
        "stops before the obstacle (m)",
    ];
    let mut table = Table::new("places", "All walks", &head);
    for place in MountPoint::ALL {
        for kind in Kind::ALL {
            for noise in Noise::ALL {
                let walk = walks.of(place, kind, noise);
                let (mean, max) = mean_and_most(&walk.profile_errors());
                let count = |thing| walk.points_on(thing).count().to_string();
                let nothing = walk.samples.iter().filter(|sample| sample.point.is_none()).count();
                let has_points = nothing < walk.samples.len();
                let error = |metres: f64| if has_points { format!("{:.1}", 1000.0 * metres) } else { "-".to_owned() };
                let end =
                    if walk.touches.is_empty() { format!("{:.2}", walk.gap) } else { "collides with it".to_owned() };
                table.row([
                    place.name().to_owned(),
                    kind.name().to_owned(),
                    if noise == Noise::Paper { "paper's" } else { "none" }.to_owned(),
                    walk.samples.len().to_string(),
                    count(Thing::Floor),
                    count(Thing::Obstacle),
                    count(Thing::Other),
                    nothing.to_string(),
                    error(mean),
                    error(max),
                    end,
                ]);
            }
        }
    }
    table
}

/// Claims of sections 5 to 6.3, compared with our results.
pub fn claims(walks: &Walks) -> Vec<Claim> {
    let tibia = |kind| walks.of(MountPoint::Tibia, kind, Noise::Without);
    let [ideal, laser, ultrasonic, reflectance] = Kind::ALL.map(tibia);
    let must = |section: &str, paper: &str, ours: String, number: String, holds: bool| Claim {
        section: section.to_owned(),
        paper: paper.to_owned(),
        ours,
        number,
        holds,
        weight: Weight::Must,
        basis: Basis::Found,
    };
    let told = |claim: Claim| Claim { weight: Weight::Told, ..claim };
    // The result depends on our own gait, room or definition.
    let set = |claim: Claim| Claim { basis: Basis::Set, ..claim };
    vec![
        set(gait_of_a_child(&walks.free, &must)),
        set(two_periods(ideal, &must)),
        fewer_points(ideal, laser, &must),
        obstacle_alone(ultrasonic, &must),
        set(range_of_incidence(walks, ideal, &must)),
        set(no_point_at_the_limit(walks, &must)),
        not_perfectly_adapted(laser, reflectance, &must),
        set(told(level_sensor(walks, &must))),
        exact_profile(walks, &must),
        noise_of_the_paper(walks, &must),
        stops(walks, &must),
    ]
}

type Make<'a> = dyn Fn(&str, &str, String, String, bool) -> Claim + 'a;

fn gait_of_a_child(walk: &Walk, make: &Make<'_>) -> Claim {
    let differences = cycle_angles(walk).map_or([f64::NAN; 3], |angles| source_differences(&angles));
    let paper = "the gait cycle of a child is analogous for the biped robot";
    let ours = format!(
        "the legs walk by the data of children: rms difference of their thigh, knee and ankle angles from these data at free speed, over a steady cycle; at most {GAIT_ERROR} degrees each"
    );
    let number = differences.map(|degrees| format!("{degrees:.1}")).join(", ") + " degrees";
    make("6, Fig. 7", paper, ours, number, differences.iter().all(|degrees| *degrees <= GAIT_ERROR))
}

fn two_periods(ideal: &Walk, make: &Make<'_>) -> Claim {
    let periods = ideal.ground_periods();
    let times: Vec<String> = periods.iter().map(|(from, to)| format!("{from:.2} to {to:.2} s")).collect();
    let first_obstacle = ideal.first_obstacle();
    let number = format!(
        "{} periods ({}), then the obstacle at {:.2} s",
        periods.len(),
        times.join(", "),
        first_obstacle.unwrap_or(f64::NAN)
    );
    let paper = "the ideal sensor detects the ground for two periods only, before it detects the obstacle";
    make(
        "6.3",
        paper,
        "runs of consecutive readings on the ground before the first reading on the obstacle".to_owned(),
        number,
        periods.len() == 2 && first_obstacle.is_some(),
    )
}

fn fewer_points(ideal: &Walk, laser: &Walk, make: &Make<'_>) -> Claim {
    // Both walks are equal until one of them stops.
    let until = ideal.stopped().min(laser.stopped());
    let [of_ideal, of_laser] =
        [ideal, laser].map(|walk| walk.points_on(Thing::Floor).filter(|s| s.at <= until).count());
    let number = format!("{of_laser} against {of_ideal} points on the ground");
    let paper = "the laser range finder gives fewer points, as it loses surfaces at incidence angles beyond 45 degrees";
    make(
        "6.3",
        paper,
        "points on the ground in the same part of the walk, laser against ideal sensor".to_owned(),
        number,
        0 < of_laser && of_laser < of_ideal,
    )
}

fn obstacle_alone(ultrasonic: &Walk, make: &Make<'_>) -> Claim {
    let [floor, obstacle] = [Thing::Floor, Thing::Obstacle].map(|thing| ultrasonic.points_on(thing).count());
    let number = format!("{floor} points on the ground, {obstacle} on the obstacle");
    let paper = "the ultrasonic sensor detects the vertical obstacle only";
    make("6.3", paper, "points of its profile by surface".to_owned(), number, floor == 0 && obstacle > 0)
}

fn range_of_incidence(walks: &Walks, ideal: &Walk, make: &Make<'_>) -> Claim {
    let found = incidences(&walks.truth, ideal, MountPoint::Tibia, Kind::Ideal);
    let (low, high) = found.unwrap_or((f64::NAN, f64::NAN));
    let holds = (low - INCIDENCES[0]).abs() <= INCIDENCE_ERROR && (high - INCIDENCES[1]).abs() <= INCIDENCE_ERROR;
    let paper = "incidence on the ground varies within 33 to 78 degrees";
    let ours = format!(
        "incidence within the range of 2 m, from the true postures every 2 ms; each end at most {INCIDENCE_ERROR} degrees off"
    );
    make("6.3", paper, ours, format!("{low:.1} to {high:.1} degrees"), holds)
}

fn no_point_at_the_limit(walks: &Walks, make: &Make<'_>) -> Claim {
    let (mut limits, mut points) = (0, 0);
    for kind in Kind::ALL {
        for noise in Noise::ALL {
            for sample in &walks.of(MountPoint::Tibia, kind, noise).samples {
                if sample.distance >= kind.max() {
                    limits += 1;
                    points += usize::from(sample.point.is_some());
                }
            }
        }
    }
    let paper = "a reading of the maximum distance (no echo) adds no point to the profile";
    let number = format!("{points} points from {limits} such readings");
    make("6.2", paper, "all walks with the sensor on the tibia".to_owned(), number, points == 0 && limits > 0)
}

fn not_perfectly_adapted(laser: &Walk, reflectance: &Walk, make: &Make<'_>) -> Claim {
    let [(of_laser, _), (mean, max)] = [laser, reflectance].map(|walk| mean_and_most(&walk.profile_errors()));
    let number = format!(
        "{:.0} mm on average, {:.0} mm at most; the laser {:.1} mm on average",
        1000.0 * mean,
        1000.0 * max,
        1000.0 * of_laser
    );
    let paper = "the reflectance sensor is not perfectly adapted";
    let ours = "profile error without noise: surfaces hit obliquely appear farther away, so the ground appears lower"
        .to_owned();
    make("6.3", paper, ours, number, mean > 10.0 * of_laser && mean > 0.02)
}

fn level_sensor(walks: &Walks, make: &Make<'_>) -> Claim {
    let walk = walks.of(MountPoint::Body, Kind::Ideal, Noise::Without);
    let [floor, obstacle] = [Thing::Floor, Thing::Obstacle].map(|thing| walk.points_on(thing).count());
    let paper = "a mobile robot's sensor detects vertical obstacles only, no ground";
    let ours = "ideal sensor level on the body, 0.9 m high: it does not even detect the small obstacle".to_owned();
    make("6", paper, ours, format!("{floor} points on the ground, {obstacle} on the obstacle"), floor == 0)
}

fn exact_profile(walks: &Walks, make: &Make<'_>) -> Claim {
    let worst = [Kind::Ideal, Kind::Laser, Kind::Ultrasonic]
        .map(|kind| mean_and_most(&walks.of(MountPoint::Tibia, kind, Noise::Without).profile_errors()).1);
    let max_error = worst.into_iter().fold(0.0, f64::max);
    let paper = "the point that is hit follows from the pose of the sensor and the distance";
    let ours =
        format!("profile error of ideal, laser and ultrasonic sensor without noise; at most {:.0} mm", 1000.0 * EXACT);
    make("6.2", paper, ours, format!("{:.1} mm", 1000.0 * max_error), max_error <= EXACT)
}

fn noise_of_the_paper(walks: &Walks, make: &Make<'_>) -> Claim {
    let walk = walks.of(MountPoint::Tibia, Kind::Laser, Noise::Paper);
    let ratios: Vec<f64> =
        walk.samples.iter().filter(|s| s.point.is_some()).map(|s| s.distance / s.truth.distance - 1.0).collect();
    let square = ratios.iter().map(|ratio| ratio * ratio).sum::<f64>() / ratios.len().max(1) as f64;
    let sigma = square.sqrt();
    let paper = "the distance of the laser range finder has the noise d (1 + N), sigma 0.01";
    let ours = format!("rms of d / d_true - 1 over {} readings; 0.01 +- 50 %", ratios.len());
    make("5", paper, ours, format!("{sigma:.4}"), (sigma - SIGMA).abs() <= 0.5 * SIGMA)
}

fn stops(walks: &Walks, make: &Make<'_>) -> Claim {
    let all = Kind::ALL.iter().flat_map(|kind| Noise::ALL.map(|noise| walks.of(MountPoint::Tibia, *kind, noise)));
    let (mut min_distance, mut touches) = (f64::INFINITY, 0);
    for walk in all {
        min_distance = min_distance.min(walk.gap);
        touches += walk.touches.len();
    }
    let paper = "the walk stops before robot and obstacle collide";
    let ours = "minimum distance of the body's centre from the obstacle, and touches, in all walks with the sensor on the tibia";
    make(
        "6.3",
        paper,
        ours.to_owned(),
        format!("{min_distance:.2} m, {touches} touches"),
        touches == 0 && min_distance > 0.3,
    )
}
