//! Sections 3 and 4: TSK surfaces and an occupancy grid from the same sonar readings of random terrains.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::hint::black_box;
use std::thread;
use std::time::Instant;

use anyhow::{Context as _, ensure};
use mapping::inverse::{SonarModel, SonarPose};
use mapping::occupancy::OccupancyGrid;
use mapping::tsk::{Fusion, Order, Partition, Settings, Tsk};
use nalgebra::Vector3;
use sim_core::scene::{Boulders, HeightField};

use super::ground::Terrain;
use super::picture::{Panel, maps};
use crate::page::{Claim, Figure, Page, Table, Weight};
use crate::run::{Job, Run, Scene};
use crate::trace::{Event, Trace};
use sim_host::launch::Options;

/// Side of the terrain, m.
const SIDE: f64 = 10.0;
/// Sonars on the beam across the terrain; the sensors of one bus.
const SONARS: usize = 16;
/// Height of the beam, m.
const HEIGHT: f64 = 2.5;
/// Forward tilt of every second sonar, degrees from straight down.
const TILT_DEG: f64 = 25.0;
/// Numbers of cells along a side.
const PARTITIONS: [usize; 5] = [8, 12, 20, 28, 40];
/// Greatest partition for the methods whose cost grows with the square of the number of parameters.
const MAX_JOINT: [usize; 2] = [20, 12];
/// Every n-th scan is used: about 160 and 640 readings.
const THINNED: [usize; 2] = [16, 4];
/// Height of the boxes of the occupancy grid, m.
const BOX: f64 = 0.1;
/// Places along a side at which heights are compared.
const PLACES: usize = 100;

/// A reading with the true pose of its sonar.
type Reading = (SonarPose, f64);

/// A terrain and its readings in the order of time, scan by scan.
struct Survey {
    field: HeightField,
    scans: Vec<Vec<Reading>>,
}

/// Method of fusing readings.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Method {
    /// TSK surface with its output functions and equations.
    Tsk(Order, Fusion),
    /// Occupancy grid, projected to the highest occupied box, or to the most certainly occupied one.
    Grid { is_likeliest: bool },
}

/// The share, of 0.03, 0.01, 0.003 and 0.001, that is good with few readings and with many.
const CELLS: Fusion = Fusion::Cells { above: 0.003 };
const METHODS: [(Method, &str); 7] = [
    (Method::Tsk(Order::Zero, CELLS), "zero-order TSK"),
    (Method::Tsk(Order::One, CELLS), "first-order TSK"),
    (Method::Grid { is_likeliest: false }, "occupancy grid, highest occupied box"),
    (Method::Grid { is_likeliest: true }, "occupancy grid, most certainly occupied box"),
    (Method::Tsk(Order::Zero, Fusion::Cells { above: 1.0 }), "zero-order TSK, equal weights"),
    (Method::Tsk(Order::Zero, Fusion::Average), "zero-order TSK, Eq. 3 as printed"),
    (Method::Tsk(Order::One, Fusion::Average), "first-order TSK, Eq. 3 as printed"),
];

/// Result of one method, partition and number of readings, over all terrains.
#[derive(Clone, Debug)]
struct Score {
    method: usize,
    cells: usize,
    thinned: usize,
    /// Root mean square error on each terrain, m.
    rms: Vec<f64>,
    readings: usize,
    /// Time per reading, s.
    time: f64,
}

impl Score {
    fn mean(&self) -> f64 {
        self.rms.iter().sum::<f64>() / self.rms.len() as f64
    }
}

/// Map of heights by a method.
enum Surface {
    Tsk(Tsk),
    Grid(OccupancyGrid, bool),
}

impl Surface {
    fn new(method: Method, cells: usize) -> Self {
        let partition = Partition { cell: SIDE / cells as f64, columns: cells, rows: cells, low: (0, 0) };
        match method {
            Method::Tsk(order, fusion) => {
                Self::Tsk(Tsk::new(partition, Settings { order, fusion, ..Settings::default() }))
            }
            Method::Grid { is_likeliest } => {
                let layers = (HEIGHT / BOX).round() as usize;
                Self::Grid(OccupancyGrid::new(partition, 0.0, BOX, layers), is_likeliest)
            }
        }
    }

    fn fuse(&mut self, model: &SonarModel, (sonar, distance): &Reading) {
        match self {
            Self::Tsk(tsk) => tsk.fuse(model, sonar, *distance),
            Self::Grid(grid, _) => grid.fuse(model, sonar, *distance),
        };
    }

    /// Height at (x, y); both methods take unmeasured places as ground at 0.
    fn height(&self, x: f64, y: f64) -> f64 {
        match self {
            Self::Tsk(tsk) => tsk.height(x, y),
            Self::Grid(grid, false) => grid.height(x, y),
            Self::Grid(grid, true) => grid.likeliest_height(x, y),
        }
        .unwrap_or(0.0)
    }

    fn rms(&self, field: &HeightField) -> f64 {
        let place = |index: usize| (index as f64 + 0.5) * SIDE / PLACES as f64;
        let places = (0..PLACES * PLACES).map(|index| (place(index % PLACES), place(index / PLACES)));
        let square = |(x, y)| {
            let error: f64 = self.height(x, y) - field.height(x, y);
            error * error
        };
        (places.map(square).sum::<f64>() / (PLACES * PLACES) as f64).sqrt()
    }
}

/// Adds the study to the page.
///
/// # Errors
/// A scene that does not run to its end.
pub fn add(job: &Job, page: &mut Page, terrains: usize) -> anyhow::Result<()> {
    let surveys = measure(job, terrains as u64)?;
    job.tell("fuses the readings");
    let scores = compare(&surveys);
    let readings = surveys.iter().map(|survey| survey.scans.iter().map(Vec::len).sum::<usize>()).sum::<usize>();
    page.heading("Maps from sonar: TSK and occupancy grid");
    page.text(format!(
        "{terrains} random terrains of {SIDE} m x {SIDE} m, relief of 0.3 m with 12 boulders up to 1 m high. A beam with {SONARS} sonars (SRF08) passes over \
         each, {HEIGHT} m high; every second one looks straight down, the others {TILT_DEG} degrees ahead. {readings} echoes in all, with the noise \
         that `real` has for sonars, and true poses. Every method gets the same readings in the same order; heights are compared at \
         {PLACES} x {PLACES} places. Eq. 3 lacks the division by the sum of w, without which it is no weighted average, and Eq. 1 has the domains of beta \
         and r exchanged; both are put right here."
    ));
    page.text(
        "TSK in the first two methods: one equation for each rule that a reading activates. An equation that would raise the ground has a weight of 0.3 %: the ground touches \
         the cap of a reading somewhere and lies below it everywhere else. `Equal weights` omits this weight. `Eq. 3 as printed` has one equation for each reading, about the \
         average over all its cells: a wide beam hears the nearest surface, not the average, and the deviation from the average adds to the noise.",
    );
    page.table(table(&scores));
    page.text(times(&scores));
    page.claims.extend(claims(&scores));
    page.figure(figure(&surveys[0], &scores)?);
    Ok(())
}

/// Runs the surveys of `terrains` terrains.
fn measure(job: &Job, terrains: u64) -> anyhow::Result<Vec<Survey>> {
    let terrain = |index: u64| {
        let boulders = Boulders { count: 12, radius: [0.5, 1.5], height: [0.2, 1.0] };
        Terrain::new(1000 * job.seed() + index, SIDE, 0.3, boulders, Vec::new())
    };
    let run = |index: u64| {
        let name = format!("survey-{index:02}");
        let scene = Scene::Text(scene(&terrain(index)));
        let options = Options { seed: Some(job.seed() * 1000 + index), ..Options::default() };
        Run { name, scene, options }
    };
    let runs: Vec<Run> = (0..terrains).map(run).collect();
    let scans = job.run(&runs, |_, trace| scans(&trace))?;
    scans.into_iter().zip(0..).map(|(scans, index)| Ok(Survey { field: terrain(index).field()?, scans })).collect()
}

/// Mounting of sonar `index` on the beam, in the frame of the robot: y, and the pitch in degrees.
fn mount(index: usize) -> (f64, f64) {
    let y = ((index as f64 + 0.5) / SONARS as f64 - 0.5) * SIDE;
    (y, if index.is_multiple_of(2) { -90.0 } else { -90.0 + TILT_DEG })
}

fn scene(terrain: &Terrain) -> String {
    let mut text = format!(
        "[scene]\nuntil_s = 60\nnoise = {{ sonar = {{ sigma_mm = 5, sigma_percent = 0.5, step_mm = 10, dropout = 0.01 }} }}\n\n{}\n\
         [[robot_type]]\nname = \"Surveyor\"\n\n",
        terrain.world()
    );
    for index in 0..SONARS {
        let ((y, pitch), number, z) = (mount(index), index + 1, HEIGHT * 1e3);
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "[[robot_type.sonar]]\nname = \"SONAR_{number}\"\nid = {number}\ny_mm = {}\nz_mm = {z}\npitch_deg = {pitch}\n",
            y * 1e3
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

/// The echoes of a run, scan by scan, each with the true pose of its sonar.
fn scans(trace: &Trace) -> anyhow::Result<Vec<Vec<Reading>>> {
    let poses: Vec<(f64, f64, f64)> = trace
        .of_robot(1)
        .filter_map(|entry| match entry.event {
            Event::Pose { x_m, y_m, .. } => Some((entry.at, x_m, y_m)),
            _ => None,
        })
        .collect();
    // The robot drives straight at constant speed.
    let place = |at: f64| -> Option<(f64, f64)> {
        let after = poses.partition_point(|pose| pose.0 < at).clamp(1, poses.len().checked_sub(1)?);
        let ((t0, x0, y0), (t1, x1, y1)) = (poses.get(after - 1)?, poses.get(after)?);
        let share = ((at - t0) / (t1 - t0)).clamp(0.0, 1.0);
        Some((x0 + share * (x1 - x0), y0 + share * (y1 - y0)))
    };
    let mut scans = Vec::new();
    for entry in trace.of_robot(1) {
        let Event::Distance { device, distance_m, measured_s } = &entry.event else { continue };
        let number: usize =
            device.strip_prefix("SONAR_").and_then(|n| n.parse().ok()).context("a device that is no sonar")?;
        if number == 1 {
            scans.push(Vec::new());
        }
        let (Some(distance), Some(scan)) = (distance_m, scans.last_mut()) else { continue };
        let (x, y) = place(*measured_s).context("no poses")?;
        let (aside, pitch_deg) = mount(number - 1);
        let origin = Vector3::new(x, y + aside, HEIGHT);
        scan.push((SonarPose::new(origin, 0.0, pitch_deg / 180.0 * PI), *distance));
    }
    ensure!(scans.len() > 100, "only {} scans", scans.len());
    Ok(scans)
}

fn compare(surveys: &[Survey]) -> Vec<Score> {
    let mut scores = Vec::new();
    for (method, (kind, _)) in METHODS.iter().enumerate() {
        for cells in PARTITIONS {
            let most = match kind {
                Method::Tsk(order, Fusion::Average) => MAX_JOINT[usize::from(*order == Order::One)],
                _ => usize::MAX,
            };
            if cells > most {
                continue;
            }
            for thinned in THINNED {
                scores.push(score(surveys, method, cells, thinned));
            }
        }
    }
    scores
}

fn fused(survey: &Survey, method: usize, cells: usize, thinned: usize) -> Surface {
    let mut surface = Surface::new(METHODS[method].0, cells);
    let model = SonarModel::srf08();
    survey.scans.iter().step_by(thinned).flatten().for_each(|reading| surface.fuse(&model, reading));
    surface
}

fn score(surveys: &[Survey], method: usize, cells: usize, thinned: usize) -> Score {
    let one = |survey: &Survey| {
        let begin = Instant::now();
        let surface = black_box(fused(survey, method, cells, thinned));
        (begin.elapsed().as_secs_f64(), surface.rms(&survey.field))
    };
    // Two processors: half of the terrains each.
    let (first, second) = surveys.split_at(surveys.len() / 2);
    let results: Vec<(f64, f64)> = thread::scope(|scope| {
        let half = thread::Builder::new().name("fusion".to_owned());
        let half = half.spawn_scoped(scope, || first.iter().map(one).collect::<Vec<_>>());
        let second: Vec<_> = second.iter().map(one).collect();
        let first = half.ok().and_then(|half| half.join().ok());
        first
            .unwrap_or_else(|| surveys[..surveys.len() / 2].iter().map(one).collect())
            .into_iter()
            .chain(second)
            .collect()
    });
    let readings = surveys.iter().flat_map(|survey| survey.scans.iter().step_by(thinned)).map(Vec::len).sum::<usize>();
    let time: f64 = results.iter().map(|(time, _)| time).sum();
    let rms = results.into_iter().map(|(_, rms)| rms).collect();
    Score { method, cells, thinned, rms, readings: readings / surveys.len(), time: time / readings as f64 }
}

fn best(scores: &[Score], method: usize, thinned: usize) -> &Score {
    let of_method = scores.iter().filter(|score| score.method == method && score.thinned == thinned);
    of_method.min_by(|a, b| a.mean().total_cmp(&b.mean())).expect("every method has a partition")
}

fn table(scores: &[Score]) -> Table {
    let caption = "Height error against the true terrain (mean over the terrains of the root mean square, cm), cells along a side, \
                   readings a terrain; the best partition of each row, and its error on the worst terrain";
    let mut head = vec!["method".to_owned(), "readings".to_owned()];
    head.extend(PARTITIONS.map(|cells| format!("{cells} x {cells}")));
    head.extend(["best", "worst terrain"].map(str::to_owned));
    let mut table = Table { name: "heights".to_owned(), caption: caption.to_owned(), head, rows: Vec::new() };
    for (method, (_, name)) in METHODS.iter().enumerate() {
        for thinned in THINNED {
            let cell = |cells: usize| {
                let found = scores.iter().find(|s| (s.method, s.cells, s.thinned) == (method, cells, thinned));
                found.map_or("-".to_owned(), |score| format!("{:.1}", 100.0 * score.mean()))
            };
            let best = best(scores, method, thinned);
            let worst = best.rms.iter().copied().fold(0.0, f64::max);
            let mut row = vec![(*name).to_owned(), best.readings.to_string()];
            row.extend(PARTITIONS.map(cell));
            row.extend([format!("{} x {}", best.cells, best.cells), format!("{:.1}", 100.0 * worst)]);
            table.row(row);
        }
    }
    table
}

/// Time of an update, as text: tables are the same in every run and times are not.
fn times(scores: &[Score]) -> String {
    let one = |method: usize| {
        let best = best(scores, method, THINNED[1]);
        format!("{} ({1} x {1}) {2:.0} us", METHODS[method].1, best.cells, 1e6 * best.time)
    };
    let all: Vec<String> = (0..METHODS.len()).map(one).collect();
    format!("Time of fusing a reading, on this machine, at the best partition of each: {}.", all.join("; "))
}

fn claims(scores: &[Score]) -> Vec<Claim> {
    let (constants, planes, grid, likeliest) = (0, 1, 2, 3);
    let all = THINNED[1];
    let tsk = [constants, planes].map(|method| best(scores, method, all));
    let tsk = if tsk[0].mean() < tsk[1].mean() { tsk[0] } else { tsk[1] };
    let against = |grid: &Score| {
        let better = tsk.rms.iter().zip(&grid.rms).filter(|(ours, theirs)| ours < theirs).count();
        (grid.mean() > tsk.mean(), better)
    };
    let claim = |place: &str, paper: &str, ours: String, number: String, holds: bool, weight: Weight| Claim {
        place: place.to_owned(),
        paper: paper.to_owned(),
        ours,
        number,
        holds,
        weight,
    };
    let mut claims = Vec::new();
    for (method, weight) in [(grid, Weight::Must), (likeliest, Weight::Told)] {
        let grid = best(scores, method, all);
        let (holds, better) = against(grid);
        let name = METHODS[method].1;
        claims.push(claim(
            "4",
            "at the best partition of both, TSK is closer to the terrain than the occupancy grid",
            format!(
                "{} ({1} x {1}) against {name} ({2} x {2}); on {better} of {3} terrains",
                METHODS[tsk.method].1,
                tsk.cells,
                grid.cells,
                tsk.rms.len()
            ),
            format!("{:.1} cm against {:.1} cm", 100.0 * tsk.mean(), 100.0 * grid.mean()),
            holds && (weight == Weight::Told || better == tsk.rms.len()),
            weight,
        ));
    }
    // The paper's own equations, without ours of single cells.
    let printed = [5, 6].map(|method| best(scores, method, all));
    let printed = if printed[0].mean() < printed[1].mean() { printed[0] } else { printed[1] };
    let maximum = best(scores, grid, all);
    claims.push(claim(
        "3",
        "TSK is closer than the grid, with Eq. 3 as printed: one equation for each reading",
        format!(
            "{} ({1} x {1}) against the highest occupied box of the grid",
            METHODS[printed.method].1, printed.cells
        ),
        format!("{:.1} cm against {:.1} cm", 100.0 * printed.mean(), 100.0 * maximum.mean()),
        printed.mean() < maximum.mean(),
        Weight::Told,
    ));
    // With few readings against many: the factor between grid and TSK.
    let gain =
        |method: usize, thinned: usize| best(scores, likeliest, thinned).mean() / best(scores, method, thinned).mean();
    let few = THINNED[0];
    claims.push(claim(
        "4",
        "the advantage over the grid with few samples is greater with planes (first order)",
        format!(
            "error of the grid (most certainly occupied box) over that of first-order TSK, and over that of zero-order TSK, with {} readings",
            best(scores, planes, few).readings
        ),
        format!("{:.2} and {:.2}", gain(planes, few), gain(constants, few)),
        gain(planes, few) > gain(constants, few),
        Weight::Told,
    ));
    let joint = [5, 6].map(|method| scores.iter().find(|s| (s.method, s.cells, s.thinned) == (method, 12, all)));
    if let [Some(constants), Some(planes)] = joint {
        let is_slower = planes.time > 1.5 * constants.time;
        claims.push(claim(
            "4",
            "planes (first order) are much slower than constants (zero order), since the matrices grow with the number of parameters",
            "computing time for each reading, 12 x 12 rules estimated jointly: first-order over zero-order TSK".to_owned(),
            // Times are not the same in every run, tables are.
            format!("{} than 1.5 times", if is_slower { "more" } else { "no more" }),
            is_slower,
            Weight::Told,
        ));
    }
    claims
}

/// Figure 3: the first terrain and its map by each method.
fn figure(survey: &Survey, scores: &[Score]) -> anyhow::Result<Figure> {
    let order = [(1, "b"), (0, "c"), (2, "d")];
    let thinned = THINNED[1];
    let surfaces = order.map(|(method, letter)| {
        let cells = best(scores, method, thinned).cells;
        let surface = fused(survey, method, cells, thinned);
        let rms = surface.rms(&survey.field);
        (format!("{letter}  {}, {cells} x {cells}: rms {:.1} cm", METHODS[method].1, 100.0 * rms), surface, rms)
    });
    let mut panels = vec![Panel {
        title: "a  terrain (m)".to_owned(),
        height: Box::new(|x, y| Some(survey.field.height(x, y))),
        paths: Vec::new(),
    }];
    for (title, surface, _) in &surfaces {
        let height = Box::new(move |x, y| Some(surface.height(x, y)));
        panels.push(Panel { title: title.clone(), height, paths: Vec::new() });
    }
    let readings = survey.scans.iter().step_by(thinned).map(Vec::len).sum::<usize>();
    let [planes, constants, grid] = [0, 1, 2].map(|index| 100.0 * surfaces[index].2);
    Ok(Figure {
        name: "figure-3".to_owned(),
        label: "Figure 3".to_owned(),
        caption: format!(
            "One of the terrains (a) and the maps of it from the same {readings} readings, each at the partition that is best over all terrains: TSK with planes (b), \
             with constants (c), and the highest occupied box of the occupancy grid (d)."
        ),
        claim: "The TSK maps are closer to the terrain than the occupancy grid; rms of b, c, d".to_owned(),
        number: format!("{planes:.1}, {constants:.1}, {grid:.1} cm"),
        picture: maps(SIDE, 330, (0.0, 1.3), &panels)?,
    })
}
