//! Wu et al. 2013: grid maps from seven ultrasonic sectors.
//!
//! The robot of `sims/sonar-map*.scene.toml` prints all its readings and its odometry. From these readings this module
//! builds six maps and compares each with the walls of the scene:
//!
//! - the paper's map, with lines drawn by point-by-point comparison
//! - the paper's map, with lines drawn by DDA
//! - the paper's local grids, added as log-odds instead of by Eq. 4
//! - a plain sonar grid that ignores a missing echo
//! - a plain sonar grid that takes a missing echo as free
//! - a grid of log-odds of cones and arcs

mod case;
mod maps;
pub mod odometry;

use accuracy::figure::{Figure as Chart, Mark, Scale, Series};
use anyhow::Context as _;
use mapping::grid::{Cell, Grid, GridGeometry, png};
use mapping::log_odds::{LogOddsGrid, log_odds};
use mapping::pose::Point;
use mapping::score::{Occupancy, Score, Truth};
use mapping::sector::{UNKNOWN, updated};

use crate::page::{Basis, Claim, Figure, Page, Picture, Table, Weight};
use crate::run::{Job, Run, Scene};
use maps::{MapMethod, Mapped};
use sim_host::launch::Options;

/// The runs: name, file of the scene, and noise (a preset, or the noise of the sonars only).
const RUNS: [(&str, &str, &str); 7] = [
    ("room", "sims/sonar-map.scene.toml", "none"),
    ("room-sonar-noise", "sims/sonar-map.scene.toml", SONAR_NOISE),
    ("room-noise", "sims/sonar-map.scene.toml", "real"),
    ("mirrors", "sims/sonar-map-mirrors.scene.toml", "none"),
    ("mirrors-noise", "sims/sonar-map-mirrors.scene.toml", "real"),
    ("corridor", "sims/sonar-map-corridor.scene.toml", "none"),
    ("corridor-noise", "sims/sonar-map-corridor.scene.toml", "real"),
];

/// Noise profile with the sonars of `real`, and without errors of drive and odometry.
const SONAR_NOISE: &str = "[sonar]\nsigma_mm = 5\nsigma_percent = 0.5\nstep_mm = 10\noutlier = 0.002\ndropout = 0.01\n";

/// Makes the page.
///
/// # Errors
/// If a scene does not run to its end, or its robot prints no map.
pub fn run(job: &Job) -> anyhow::Result<Page> {
    let source =
        "J. Wu, T. Qin, H. Si, J. Chen, K. Lin, C. Zhang: Environmental Modeling Based on Ultrasonic Ranging, 2013";
    let mut page = Page::new("Grid maps from seven ultrasonic sectors", source);
    let profile = job.folder().join("sonar.noise.toml");
    std::fs::write(&profile, SONAR_NOISE).with_context(|| format!("cannot write `{}`", profile.display()))?;
    let runs = RUNS.map(|(name, file, noise)| {
        let noise = if noise == SONAR_NOISE { profile.to_string_lossy() } else { noise.into() };
        let options = Options { noise: Some(noise.into_owned()), ..job.options() };
        Run { name: name.to_owned(), scene: Scene::File(file.into()), options }
    });
    let mapped = job.run(&runs, |run, trace| {
        let Scene::File(file) = &run.scene else { anyhow::bail!("a scene without a file") };
        Mapped::new(&run.name, file, &trace)
    })?;
    let find = |name: &str| mapped.iter().find(|run| run.name == name).with_context(|| format!("no run `{name}`"));
    let (room, corridor) = (find("room")?, find("corridor")?);
    let folder = std::path::absolute(job.folder().join("runs")).context("the folder of the runs")?;
    let mirrors = job.run(&among_mirrors(job)?, |run, trace| {
        Mapped::new(&run.name, &folder.join(format!("{}.scene.toml", run.name)), &trace)
    })?;

    page.claims =
        vec![room_accuracy(room), room_precision(room), room_recall(room), against_plain(&mirrors), replayed(&mapped)];
    page.claims.extend([told_accuracy(room), told_accuracy(corridor), printed_limit(room), never_corrected(room)]);
    page.claims.extend([rasters(room), told_sonar_noise(find("room-sonar-noise")?), told_noise(find("room-noise")?)]);

    page.heading("The modelling cases");
    case::figures(&mut page)?;
    page.heading("Maps");
    page.text(
        "White: free, black: occupied, grey: not known. Where a map is wrong: red cells are marked occupied but are free, orange cells are \
         marked free but are not. The first picture is the truth: walls as cells that a wall passes, dots where the robot stopped.",
    );
    for run in &mapped {
        page.figure(map_figure(run)?);
    }
    page.table(scores(&mapped));
    page.table(mirror_scores(&mirrors));
    page.table(drives(&mapped));
    page.heading("The global update, Eq. 4");
    page.figure(equation_4()?);
    Ok(page)
}

/// A fraction in percent; `-` for NaN.
fn percent(fraction: f64) -> String {
    if fraction.is_nan() { "-".to_owned() } else { format!("{:.1} %", 100.0 * fraction) }
}

fn claim(section: &str, paper: &str, ours: &str, number: String, holds: bool, weight: Weight) -> Claim {
    let [section, paper, ours] = [section, paper, ours].map(str::to_owned);
    Claim { section, paper, ours, number, holds, weight, basis: Basis::Found }
}

/// Minimum fraction of right cells among the observed ones, and minimum precision and recall of occupied cells. Chosen
/// for the room without noise, and applied to runs with noise too.
pub const MIN_SCORES: (f64, f64, f64) = (0.95, 0.8, 0.7);

fn room_accuracy(room: &Mapped) -> Claim {
    let score = room.score(MapMethod::Wu);
    let ours = "fraction of observed cells that are right, in the room without noise";
    claim(
        "Features (1)",
        "the accuracy of the model is improved",
        ours,
        percent(score.accuracy()),
        score.accuracy() >= MIN_SCORES.0,
        Weight::Must,
    )
}

fn room_precision(room: &Mapped) -> Claim {
    let precision = room.score(MapMethod::Wu).precision;
    let ours = "precision: fraction of the cells marked occupied that have a wall in them or in a neighbour";
    claim(
        "Features (1)",
        "the accuracy of the model is improved",
        ours,
        percent(precision),
        precision >= MIN_SCORES.1,
        Weight::Must,
    )
}

fn room_recall(room: &Mapped) -> Claim {
    let recall = room.score(MapMethod::Wu).recall;
    let ours = "recall: fraction of the wall cells that are marked occupied or have such a neighbour";
    claim("Summary", "the completeness of the map", ours, percent(recall), recall >= MIN_SCORES.2, Weight::Must)
}

/// A room for [`among_mirrors`], which makes mirrors of all walls without their own surface: name, scene, size in mm,
/// and starts in mm at multiples of a cell.
type Room = (&'static str, &'static str, [i64; 2], [[i64; 2]; 6]);
const MIRRORS: [Room; 2] = [
    (
        "room",
        "sims/sonar-map-mirrors.scene.toml",
        [4000, 3000],
        [[600, 600], [3000, 700], [3000, 2200], [600, 2200], [1300, 1500], [2900, 1500]],
    ),
    (
        "corridor",
        "sims/sonar-map-corridor.scene.toml",
        [6000, 1500],
        [[500, 700], [1000, 1100], [2700, 600], [3600, 600], [4600, 1000], [5600, 900]],
    ),
];

/// Runs in rooms with mirrors, one for each start.
fn among_mirrors(job: &Job) -> anyhow::Result<Vec<Run>> {
    let mut runs = Vec::new();
    for (name, file, [width, depth], starts) in MIRRORS {
        let path = crate::run::root().join(file);
        let text = std::fs::read_to_string(&path).with_context(|| format!("cannot read `{}`", path.display()))?;
        for (index, [x, y]) in starts.into_iter().enumerate() {
            let line = |line: &str| {
                let key = line.split_once('=').map_or("", |(key, _)| key.trim());
                match key {
                    "arguments" => {
                        let frame = [-75 - x, -75 - y, width + 75 - x, depth + 75 - y];
                        let [x0, y0, x1, y1] = frame.map(|number| format!("\"{number}\""));
                        format!("arguments = [{x0}, {y0}, {x1}, {y1}, \"50\"]\n")
                    }
                    "x_mm" => format!("x_mm = {x}\n"),
                    "y_mm" => format!("y_mm = {y}\n"),
                    // Walls without their own `surface`.
                    "{ from_mm" if !line.contains("surface") => {
                        line.replace(" },", ", surface = { specular = 1 } },\n")
                    }
                    _ => format!("{line}\n"),
                }
            };
            let scene = Scene::Text(text.lines().map(line).collect());
            runs.push(Run { name: format!("mirrors-{name}-{}", index + 1), scene, options: job.options() });
        }
    }
    Ok(runs)
}

/// Minimum and maximum of the fractions, in percent.
fn range(fractions: impl Iterator<Item = f64>) -> String {
    let (low, high) = fractions.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), s| (low.min(s), high.max(s)));
    format!("{:.0} to {:.0} %", 100.0 * low, 100.0 * high)
}

/// Compares the paper's maps in rooms with mirrors with two plain grids: one ignores a missing echo, the other
/// treats a beam without an echo as free.
fn against_plain(mirrors: &[Mapped]) -> Claim {
    let more = |of: fn(&Score) -> f64| {
        let is_more = |run: &&Mapped| {
            let own = of(&run.score(MapMethod::Wu));
            [MapMethod::Plain, MapMethod::PlainFree].into_iter().all(|plain| own > of(&run.score(plain)))
        };
        mirrors.iter().filter(is_more).count()
    };
    let (right, found) = (more(Score::accuracy), more(|score| score.recall));
    let accuracy = |kind: MapMethod| range(mirrors.iter().map(move |run| run.score(kind).accuracy()));
    let recall = |kind: MapMethod| range(mirrors.iter().map(move |run| run.score(kind).recall));
    let number = format!(
        "right {}, plain {}: more on {right} of {}; recall {}, plain {}: more on {found}",
        accuracy(MapMethod::Wu),
        accuracy(MapMethod::Plain),
        mirrors.len(),
        recall(MapMethod::Wu),
        recall(MapMethod::Plain)
    );
    let ours = "among mirrors, ranges over six starts in each of two rooms: more observed cells are right and more walls are \
                found than with either plain grid, one that ignores a missing echo and one that takes it as free";
    let holds = right == mirrors.len() && found == mirrors.len();
    claim(
        "Features (1)",
        "specular reflection is considered, thus the accuracy is improved",
        ours,
        number,
        holds,
        Weight::Told,
    )
}

fn mirror_scores(mirrors: &[Mapped]) -> Table {
    let head =
        ["run", "right of observed", "plain", "plain, free if no echo", "recall", "plain", "plain, free if no echo"];
    let mut table = Table::new("mirrors", "Maps among mirrors, from six starts in each of two rooms", &head);
    for run in mirrors {
        let kinds = [MapMethod::Wu, MapMethod::Plain, MapMethod::PlainFree].map(|kind| run.score(kind));
        let accuracies = kinds.iter().map(|score| percent(score.accuracy()));
        let recalls = kinds.iter().map(|score| percent(score.recall));
        table.row(std::iter::once(run.name.clone()).chain(accuracies).chain(recalls));
    }
    table
}

fn replayed(mapped: &[Mapped]) -> Claim {
    let different: usize = mapped.iter().map(Mapped::differing_cells).sum();
    let cells: usize = mapped.iter().map(|run| run.truth.values().len()).sum();
    let ours = "the map built on the robot equals the map rebuilt from the readings that it printed";
    let number = format!("{different} of {cells} cells differ");
    // The same library makes both maps.
    let replayed = claim("Global Model", "steps 2 to 4, on the robot", ours, number, different == 0, Weight::Must);
    Claim { basis: Basis::Set, ..replayed }
}

fn told_accuracy(run: &Mapped) -> Claim {
    let (score, plain) = (run.score(MapMethod::Wu), run.score(MapMethod::Plain));
    let ours = format!("{}: more observed cells are right, and fewer unknown, than in the plain grid", run.name);
    let number = format!(
        "{} and {} unknown, plain {} and {}",
        percent(score.accuracy()),
        score.unknown,
        percent(plain.accuracy()),
        plain.unknown
    );
    let holds = score.accuracy() > plain.accuracy() && score.unknown < plain.unknown;
    claim(
        "Features (1)",
        "overcomes the low angular resolution of an ultrasonic sensor",
        &ours,
        number,
        holds,
        Weight::Told,
    )
}

fn printed_limit(room: &Mapped) -> Claim {
    let (derived, printed, pairs) = room.continuous_pairs();
    let ours = "the limit must be d_A / cos a: d_A cos a is below d_A, so that as printed no pair is continuous";
    let number =
        format!("continuous, of {pairs} pairs with two echoes: {derived} with d_A / cos a, {printed} as printed");
    // The result follows from arithmetic, not from the runs.
    let limit = claim("Sensor Number", "continuous: d_A <= d_B <= d_A cos a", ours, number, printed > 0, Weight::Told);
    Claim { basis: Basis::Set, ..limit }
}

fn never_corrected(room: &Mapped) -> Claim {
    let (stuck, wrong, corrected) = room.stuck();
    let ours = "free cells stay occupied although most scans that covered them marked them free: Eq. 4 never corrects a confident value; \
                the same local grids, added as log-odds, correct most of them";
    let number = format!("{stuck} of {wrong} false obstacles; {corrected} of the {stuck} corrected by log-odds");
    claim("Eq. 4", "the map is updated by the more certain value", ours, number, stuck == 0, Weight::Told)
}

fn rasters(room: &Mapped) -> Claim {
    let (by_points, by_dda) = (room.score(MapMethod::Wu), room.score(MapMethod::WuDda));
    let different = room.differing(MapMethod::Wu, MapMethod::WuDda);
    let ours = "point-by-point comparison makes lines thicker than DDA; the additional cells lie in front of and behind the wall";
    let number = format!(
        "{different} cells differ; right {} by points, {} by DDA",
        percent(by_points.accuracy()),
        percent(by_dda.accuracy())
    );
    let holds = by_points.accuracy() >= by_dda.accuracy();
    claim("Local Model (2)", "point-by-point comparison suits an 8-bit controller", ours, number, holds, Weight::Told)
}

fn told_sonar_noise(noisy: &Mapped) -> Claim {
    let score = noisy.score(MapMethod::Wu);
    let ours = "with the sonars of `real` noise (5 mm and 0.5 %, steps of 10 mm, 1 % of readings without an echo, 0.2 % at random distances) and exact odometry";
    let number = format!(
        "{} right, precision {}, recall {}",
        percent(score.accuracy()),
        percent(score.precision),
        percent(score.recall)
    );
    let holds = score.accuracy() >= MIN_SCORES.0 && score.precision >= MIN_SCORES.1 && score.recall >= MIN_SCORES.2;
    claim("Features (1)", "the accuracy of the model is improved", ours, number, holds, Weight::Told)
}

fn told_noise(noisy: &Mapped) -> Claim {
    let score = noisy.score(MapMethod::Wu);
    let ours = "with `real` noise and odometry alone the map is distorted: the method does not include localisation";
    let (off, turned) = noisy.odometry_error;
    let number = format!(
        "{} right, precision {}, recall {}; odometry ends {:.2} m and {:.0} degrees off",
        percent(score.accuracy()),
        percent(score.precision),
        percent(score.recall),
        off,
        turned.to_degrees().abs()
    );
    claim("Summary", "real-time and complete maps", ours, number, score.accuracy() >= MIN_SCORES.0, Weight::Told)
}

fn map_figure(run: &Mapped) -> anyhow::Result<Figure> {
    const PIXELS: u32 = 3;
    const GAP: u32 = 6;
    let maps = [MapMethod::Wu, MapMethod::Plain, MapMethod::LogOdds].map(|kind| shown(run.cells(kind), &run.truth));
    let panels: Vec<_> = std::iter::once(truth_shown(run)).chain(maps).map(|map| map.picture(PIXELS, |c| *c)).collect();
    let (width, height) = panels[0].dimensions();
    let count = panels.len() as u32;
    let mut picture = image::RgbImage::from_pixel(count * (width + GAP) - GAP, height, image::Rgb([90, 120, 200]));
    for (index, panel) in (0_u32..).zip(&panels) {
        image::imageops::replace(&mut picture, panel, i64::from(index * (width + GAP)), 0);
    }
    let score = run.score(MapMethod::Wu);
    let plain = run.score(MapMethod::Plain);
    Ok(Figure {
        name: format!("map-{}", run.name),
        label: format!("Map, {}", run.name),
        caption: "From left to right: the truth, the map of Wu et al., the plain sonar grid, the grid of log-odds."
            .to_owned(),
        claim: "Observed cells that are right, Wu et al. and plain".to_owned(),
        number: format!("{}, {}", percent(score.accuracy()), percent(plain.accuracy())),
        picture: Picture::Png { bytes: png(&picture)?, scale: 1 },
    })
}

const WHITE: [u8; 3] = [255; 3];
const BLACK: [u8; 3] = [0; 3];
const GREY: [u8; 3] = [185; 3];

/// Colours of a map's cells.
fn shown(cells: &Grid<Occupancy>, truth: &Grid<Truth>) -> Grid<[u8; 3]> {
    Grid::from_fn(*cells.frame(), |cell| match (cells[cell], truth[cell]) {
        (Occupancy::Free, Truth::Free) => WHITE,
        (Occupancy::Free, _) => [255, 150, 0],
        (Occupancy::Occupied, Truth::Free) => [225, 0, 0],
        (Occupancy::Occupied, _) => BLACK,
        (Occupancy::Unknown, _) => GREY,
    })
}

fn truth_shown(run: &Mapped) -> Grid<[u8; 3]> {
    let mut colours = run.truth.map(|truth| match truth {
        Truth::Free => WHITE,
        Truth::Surface => BLACK,
        Truth::Hidden => GREY,
    });
    for stop in &run.stops {
        if let Some(cell) = colours.frame().cell_at(*stop) {
            colours[cell] = [0, 90, 220];
        }
    }
    colours
}

fn scores(mapped: &[Mapped]) -> Table {
    let head = ["run", "map", "right", "wrong", "unknown", "right of observed", "precision", "recall"];
    let mut table = Table::new("maps", "Maps against the truth: cells of 50 mm; occupied cells within one cell", &head);
    for run in mapped {
        for kind in MapMethod::ALL {
            let Score { right, wrong, unknown, precision, recall } = run.score(kind);
            let accuracy = percent(run.score(kind).accuracy());
            let counts = [right, wrong, unknown].map(|count| count.to_string());
            let [right, wrong, unknown] = counts;
            let kind = kind.name().to_owned();
            table.row([run.name.clone(), kind, right, wrong, unknown, accuracy, percent(precision), percent(recall)]);
        }
    }
    table
}

fn drives(mapped: &[Mapped]) -> Table {
    let head =
        ["run", "stops", "scans", "time s", "path m", "contacts", "odometry error, m", "odometry error, degrees"];
    let mut table = Table::new("drives", "What the robot did", &head);
    for run in mapped {
        let (off, turned) = run.odometry_error;
        table.row([
            run.name.clone(),
            run.stops.len().to_string(),
            run.scans.to_string(),
            format!("{:.0}", run.time),
            format!("{:.1}", run.path),
            run.contacts.to_string(),
            format!("{off:.3}"),
            format!("{:.1}", turned.to_degrees()),
        ]);
    }
    table
}

/// History of a free cell: first classified as occupied from nearby, then again and again as free from farther away.
fn equation_4() -> anyhow::Result<Figure> {
    const WRONG: f64 = 0.98;
    const RIGHT: f64 = 0.06;
    const TIMES: usize = 12;
    let cell = Cell::new(0, 0);
    let mut by_log_odds = LogOddsGrid::new(GridGeometry::new(Point::origin(), 1.0, 1, 1));
    let mut by_equation_4 = UNKNOWN;
    let mut curves = [vec![(0.0, UNKNOWN)], vec![(0.0, UNKNOWN)]];
    for time in 1..=TIMES {
        let evidence = if time == 1 { WRONG } else { RIGHT };
        by_equation_4 = updated(by_equation_4, evidence);
        by_log_odds.add(cell, log_odds(evidence));
        curves[0].push((time as f64, by_equation_4));
        curves[1].push((time as f64, by_log_odds.probabilities()[cell]));
    }
    let (last, other) = (curves[0][TIMES].1, curves[1][TIMES].1);
    let [equation_4, log_odds] = curves;
    let series = [("Eq. 4", equation_4), ("log-odds", log_odds)];
    let chart = Chart {
        name: "equation-4".to_owned(),
        title: "A free cell, once said to be occupied".to_owned(),
        x_label: "observation".to_owned(),
        y_label: "probability of being occupied".to_owned(),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        series: series.map(|(name, points)| Series { name: name.to_owned(), mark: Mark::LineAndDots, points }).into(),
    };
    Ok(Figure {
        name: "equation-4".to_owned(),
        label: "Eq. 4".to_owned(),
        caption: format!(
            "The first observation says {WRONG}, all others {RIGHT}: less certain, as from a longer reading. Eq. 4 keeps the first \
             for ever, the sum of log-odds follows."
        ),
        claim: format!("Probability after {TIMES} observations, by Eq. 4 and by log-odds"),
        number: format!("{last:.2}, {other:.2}"),
        picture: Picture::chart(&chart)?,
    })
}
