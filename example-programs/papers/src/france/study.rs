//! The page of the floors: what sensors on the leg find of holes, stairs and uneven ground, and how many of them should sit where.

use std::fs;
use std::thread;

use accuracy::comparison::{Difference, Interval, Verdict};
use accuracy::figure::{Figure as Chart, Mark, Scale, Series};
use anyhow::{Context as _, ensure};
use glam::DVec2;
use sim_core::spec::RobiSpec;

use super::SPEED_MM_S;
use super::crossing::{Crossing, Mount, PERIOD, Part, Reading, Step, cross, options};
use super::floors::{Edge, Floor, Kind};
use super::placement::{
    self, BUDGET, Placement, Sightings, Training, Trial, Where, elevations, evenly, mean, mounts, of_the_paper,
};
use super::{profile, side};
use crate::page::{Basis, Claim, Figure, Page, Picture, Table, Weight};
use crate::run::{Job, Run, Scene, root};
use crate::trace::{Event, Trace};

/// Number of training and of held-out floors of each kind.
const FLOORS: usize = 10;
/// First seeds of training and of held-out floors for the seed 1; those of another seed are farther by a multiple of [`APART`].
const TRAINING: u64 = 340_000;
const HELD_OUT: u64 = 345_000;
const APART: u64 = 100_000;
/// Noise that the placements are chosen for, and another one.
const CONDITIONS: [&str; 2] = ["real", "harsh"];
/// Maximum number of sensors on the legs, and on the body.
const ON_LEGS: usize = 6;
const ON_BODY: usize = 3;
/// A further sensor is worth its place if it lowers the training error by more than this share.
const WORTH: f64 = 0.05;
/// Minimum number of whole gait cycles in each walk.
const MIN_CYCLES: usize = 4;
/// Distance from an edge within which its points lie, m, at most.
const NEAR_EDGE: f64 = 0.15;
/// Error of the height of a foothold below which it counts as known, m.
const KNOWN: f64 = 0.03;
/// Times that a robot remembers points, gait cycles.
const MEMORIES: [f64; 5] = [0.25, 0.5, 1.0, 2.0, 4.0];
/// Maximum distance of the program's points from ours in the same run, m: it reads whole millimetres at slightly different times.
const SAME: f64 = 0.005;

/// Places in the list of placements.
const NONE: usize = 0;
const PAPER: usize = 1;
const EVEN: usize = 2;
const LEGS: usize = EVEN + ON_LEGS;
const BODY: usize = LEGS + ON_LEGS;

/// A held-out walk.
struct Outcome {
    floor: Floor,
    cycles: usize,
    touches: usize,
    /// Error of each placement, m.
    errors: Vec<f64>,
    /// Details of the paper's placement and of the chosen one.
    details: [Details; 2],
}

/// What a placement sees on a walk.
struct Details {
    /// Readings that met something, for each gait cycle.
    readings: f64,
    /// Footholds whose height is known, and all.
    footholds: [usize; 2],
    /// Error with points of the last cycles only, m.
    memories: [f64; MEMORIES.len()],
    edges: Vec<Sight>,
}

/// An edge as the robot knows it when a foot is about to pass it.
struct Sight {
    /// Errors of its place and of its rise, m, if it is found.
    errors: Option<[f64; 2]>,
    /// Distance from the toe of the standing foot at which it was found first, m.
    ahead: f64,
    /// Number of points near it, and the time in which they came, in gait cycles.
    points: usize,
    cycles: f64,
}

/// Floors of all kinds in turn.
fn floors(job: &Job, first: u64, each: usize) -> Vec<Floor> {
    let first = first + job.seed().wrapping_sub(1).wrapping_mul(APART);
    (0..each * Kind::ALL.len())
        .map(|index| Floor::new(Kind::ALL[index % Kind::ALL.len()], first + index as u64))
        .collect()
}

/// Makes the page, with so many training and held-out floors of each kind.
///
/// # Errors
/// A scene that does not run to its end; a search that does not enclose the optimum.
pub fn run(job: &Job, each: Option<usize>) -> anyhow::Result<Page> {
    let each = each.unwrap_or(FLOORS);
    let training = floors(job, TRAINING, each);
    let placements = placements(job, &training)?;
    let chosen = chosen(&placements);
    for placement in &placements {
        job.tell(&format!("{}: {:.2} mm in training", placement.name, 1e3 * placement.training));
    }
    let same = replay(job, &training, &placements[chosen])?;
    // Nothing is chosen from here on.
    let held_out = floors(job, HELD_OUT, each);
    let outcomes: Vec<Vec<Outcome>> = CONDITIONS
        .iter()
        .map(|noise| cross(job, &held_out, noise, SPEED_MM_S, |crossing| outcome(crossing, &placements, chosen)))
        .collect::<anyhow::Result<_>>()?;

    let mut page = Page::new(
        "Sensors on a walking robot over holes, stairs and uneven ground",
        "L. France, A. Girault, J-D. Gascuel, B. Espiau: Sensor Modeling for a Walking Robot Simulation, 1999",
    );
    page.claims = claims(&placements, chosen, &outcomes, &same);
    page.text(format!(
        "{each} training and {each} held-out floors of each kind, seeds {} to {} and {} to {}.",
        training[0].seed,
        training[training.len() - 1].seed,
        held_out[0].seed,
        held_out[held_out.len() - 1].seed
    ));
    page.table(edges_table(&outcomes[0]));
    page.table(kinds_table(&placements, chosen, &outcomes[0]));
    page.table(memory_table(&outcomes[0]));
    page.table(placements_table(&placements));
    page.table(errors_table(&placements, &outcomes));
    page.table(settings_table(&placements));
    page.table(raw_table(&placements, &outcomes));
    page.figure(number_chart(&outcomes)?);
    let stairs = training.iter().find(|floor| floor.kind == Kind::Up).context("stairs")?;
    let pictures = [(PAPER, "floors-paper", "The paper's place"), (chosen, "floors-stairs", "The places found")];
    let drawn = cross(job, std::slice::from_ref(stairs), "real", SPEED_MM_S, |crossing| {
        pictures.map(|(index, name, title)| picture(&crossing, &placements[index], name, title))
    })?;
    drawn.into_iter().flatten().for_each(|figure| page.figure(figure));
    Ok(page)
}

/// All placements with their parameters from the training floors.
fn placements(job: &Job, training: &[Floor]) -> anyhow::Result<Vec<Placement>> {
    let (on_legs, on_body) = (mounts(Where::Legs), mounts(Where::Body));
    let grids = [(0..on_legs.len()).collect::<Vec<_>>(), (on_legs.len()..on_legs.len() + on_body.len()).collect()];
    let mut all = [on_legs, on_body].concat();
    let paper = all.len();
    all.push(of_the_paper());
    let mut rows: Vec<Vec<Vec<usize>>> = Vec::new();
    for number in 1..=ON_LEGS {
        let row = |elevation: f64| {
            let first = all.len();
            all.extend(evenly(number, elevation));
            (first..all.len()).collect()
        };
        rows.push(elevations().map(row).collect());
    }
    let floors = cross(job, training, CONDITIONS[0], SPEED_MM_S, |crossing| Training::of(crossing, &all))?;
    let placement = |name: String, set: &[usize], (cell, training, evaluations): (f64, f64, usize)| Placement {
        name,
        mounts: set.iter().map(|index| all[*index]).collect(),
        cell,
        training,
        evaluations,
    };
    let chain = |name: &str, grid: &[usize], most: usize| -> anyhow::Result<Vec<Placement>> {
        let mut set = Vec::new();
        let mut chain = Vec::new();
        for number in 1..=most {
            let found = Trial::new(&floors).best(&set, grid).with_context(|| format!("{number} {name}"))?;
            set = found.0;
            chain.push(placement(format!("{number} {name}"), &set, (found.1, found.2, found.3)));
            job.tell(&format!("{number} {name}: {} evaluations", found.3));
        }
        Ok(chain)
    };
    let others = || -> anyhow::Result<[Vec<Placement>; 2]> {
        let mut fixed = vec![
            placement("no sensor".to_owned(), &[], Trial::new(&floors).fixed(&[])?),
            placement("the paper's".to_owned(), &[paper], Trial::new(&floors).fixed(&[paper])?),
        ];
        for (number, sets) in (1..).zip(&rows) {
            let (index, cell, training, evaluations) = Trial::new(&floors).best_of(sets)?;
            fixed.push(placement(format!("{number} evenly"), &sets[index], (cell, training, evaluations)));
        }
        Ok([fixed, chain("on the body", &grids[1], ON_BODY)?])
    };
    let (legs, others) = thread::scope(|scope| -> anyhow::Result<_> {
        let other = thread::Builder::new().name("others".to_owned()).spawn_scoped(scope, others);
        let legs = chain("on the legs", &grids[0], ON_LEGS);
        let others = other.context("a thread cannot be started")?.join().ok().context("a thread panicked")?;
        Ok((legs?, others?))
    })?;
    let [fixed, body] = others;
    Ok([fixed, legs, body].concat())
}

/// The placement on the legs after which no further sensor is worth its place in training; the last one if all are.
fn chosen(placements: &[Placement]) -> usize {
    let is_enough = |index: &usize| placements[index + 1].training >= (1.0 - WORTH) * placements[*index].training;
    (LEGS..BODY - 1).find(is_enough).unwrap_or(BODY - 1)
}

/// Comparison of the program's readings with ours in one run.
struct Same {
    readings: usize,
    /// Readings that only one of both has.
    missing: usize,
    /// Maximum distance between the points of a reading, m.
    farthest: f64,
}

/// Lets the program `walker` read the sensors of a placement, mounted on the robot, over training stairs, and computes their readings again from
/// the postures of the trace.
fn replay(job: &Job, training: &[Floor], placement: &Placement) -> anyhow::Result<Same> {
    let floor = training.iter().find(|floor| floor.kind == Kind::Up).context("stairs")?;
    let folder = job.folder().join("runs");
    let robi = biped(&folder, placement)?;
    let words: Vec<String> = placement.mounts.iter().zip(FIRST_ID..).map(|(mount, id)| mount.word(&robi, id)).collect();
    let name = "floor-mounted".to_owned();
    let scene = Scene::Text(floor.scene("mounted.robi", SPEED_MM_S, &words));
    let run = Run { name: name.clone(), scene, options: options(floor, CONDITIONS[0]) };
    let same = job.run(std::slice::from_ref(&run), |_, trace| {
        let crossing = Crossing::new(job, &name, floor.clone(), CONDITIONS[0], &trace)?;
        compare(&crossing, placement, &trace)
    })?;
    same.into_iter().next().context("a run")
}

/// Number of the first sensor of a placement on the robot, after those of `robis/biped.toml`.
const FIRST_ID: usize = 13;

/// Writes a biped with the sensors of a placement.
fn biped(folder: &std::path::Path, placement: &Placement) -> anyhow::Result<std::sync::Arc<RobiSpec>> {
    let robi = super::walk::Truth::read()?.robi;
    let sensors = placement.mounts.iter().zip(FIRST_ID..).map(|(mount, id)| mount.companion(&robi, id));
    let robis = root().join("robis");
    let companion = fs::read_to_string(robis.join("biped.toml")).context("robis/biped.toml")?;
    fs::create_dir_all(folder).context("the folder of the runs")?;
    fs::write(folder.join("mounted.toml"), companion + &sensors.collect::<String>()).context("mounted.toml")?;
    fs::copy(robis.join("biped.robi"), folder.join("mounted.robi")).context("mounted.robi")?;
    Ok(robi)
}

fn compare(crossing: &Crossing, placement: &Placement, trace: &Trace) -> anyhow::Result<Same> {
    let measured = trace.of_robot(1).filter_map(|entry| match &entry.event {
        Event::Distance { device, measured_s, .. } => Some((device, *measured_s)),
        _ => None,
    });
    // The program reads each sensor once before it walks, to check that it exists.
    let measured: Vec<(&String, f64)> = measured.skip(placement.mounts.len()).collect();
    let lines: Vec<&str> = trace.printed(1).map(|(_, line)| line).collect();
    ensure!(lines.len() == measured.len() && !lines.is_empty(), "{} lines, {} readings", lines.len(), measured.len());
    let mut same = Same { readings: lines.len(), missing: 0, farthest: 0.0 };
    for (line, (device, at)) in lines.into_iter().zip(measured) {
        let mount = placement.mounts.iter().find(|mount| mount.device(&crossing.robi) == *device);
        let ours = crossing.reading_at(mount.context("a sensor of the placement")?, at).map(|reading| reading.point);
        let words: Vec<&str> = line.split(' ').collect();
        let [_, _, _, x, z] = words[..] else { anyhow::bail!("a line of five words: `{line}`") };
        let theirs = x.parse().ok().zip(z.parse().ok()).map(|(x, z): (f64, f64)| DVec2::new(x, z) / 1e3);
        match (ours, theirs) {
            (Some(ours), Some(theirs)) => same.farthest = same.farthest.max((ours - theirs).length()),
            (None, None) => {}
            _ => same.missing += 1,
        }
    }
    Ok(same)
}

fn outcome(crossing: Crossing, placements: &[Placement], chosen: usize) -> Outcome {
    let errors = placements.iter().map(|placement| placement.error(&crossing)).collect();
    let details = [PAPER, chosen].map(|index| details(&crossing, &placements[index]));
    Outcome { cycles: crossing.cycles, touches: crossing.touches, errors, details, floor: crossing.floor }
}

fn details(crossing: &Crossing, placement: &Placement) -> Details {
    let readings: Vec<Vec<Reading>> = placement.mounts.iter().map(|mount| crossing.readings(mount)).collect();
    let with_memory = |cycles: f64| {
        let seen: Vec<Sightings> =
            readings.iter().map(|readings| crossing.sightings(readings, cycles * PERIOD)).collect();
        let error = placement::error(&crossing.steps, &seen.iter().collect::<Vec<_>>(), placement.cell);
        (seen, error)
    };
    let (seen, _) = with_memory(f64::INFINITY);
    let is_known = |(index, step): &(usize, &Step)| {
        let known = profile::known(step, seen.iter().flat_map(|seen| &seen[*index]), placement.cell);
        let near = step
            .xs
            .iter()
            .zip(&step.truth)
            .min_by(|a, b| (a.0 - step.foothold).abs().total_cmp(&(b.0 - step.foothold).abs()));
        near.is_some_and(|(x, truth)| (profile::height(&known, x + step.shift) - truth).abs() < KNOWN)
    };
    let mut all: Vec<Reading> = readings.concat();
    all.sort_by(|a, b| a.at.total_cmp(&b.at));
    let span = crossing.steps.last().map_or(PERIOD, |step| step.at);
    Details {
        readings: all.len() as f64 * PERIOD / span,
        footholds: [crossing.steps.iter().enumerate().filter(is_known).count(), crossing.steps.len()],
        memories: MEMORIES.map(|cycles| with_memory(cycles).1),
        edges: crossing.floor.edges.iter().filter_map(|edge| sight(&crossing.steps, edge, &all)).collect(),
    }
}

/// What is known of an edge when a foot is about to pass it; `None` for an edge that no step after the first cycle passes.
fn sight(steps: &[Step], edge: &Edge, readings: &[Reading]) -> Option<Sight> {
    let passes = |step: &Step| step.xs[0] < edge.at && edge.at <= step.xs[step.xs.len() - 1];
    let last = steps.iter().position(passes)?;
    let room = NEAR_EDGE.min(0.5 * edge.room);
    let near = |step: &Step| -> Vec<(f64, DVec2)> {
        let points = readings.iter().filter(|reading| reading.at <= step.at);
        let points = points.map(|reading| (reading.at, reading.point - DVec2::new(step.shift, 0.0)));
        points.filter(|(_, point)| (point.x - edge.at).abs() <= room).collect()
    };
    let errors = |step: &Step| {
        let points: Vec<DVec2> = near(step).into_iter().map(|(_, point)| point).collect();
        let (at, rise) = profile::edge(&points)?;
        ((rise - edge.rise).abs() < 0.5 * edge.rise.abs()).then(|| [(at - edge.at).abs(), (rise - edge.rise).abs()])
    };
    let first = steps[..=last].iter().find(|step| errors(step).is_some());
    let points = near(&steps[last]);
    let span = points.last().zip(points.first()).map_or(0.0, |(last, first)| last.0 - first.0);
    Some(Sight {
        errors: errors(&steps[last]),
        ahead: first.map_or(f64::NAN, |step| edge.at - step.stand[1]),
        points: points.len(),
        cycles: span / PERIOD,
    })
}

/// Mean with its interval, mm.
fn millimetres(values: &[f64]) -> String {
    if values.is_empty() {
        return "-".to_owned();
    }
    let Interval { mean, low, high, .. } = Interval::of(values);
    format!("{:.1} ({:.1} to {:.1})", 1e3 * mean, 1e3 * low, 1e3 * high)
}

/// Difference with its interval, mm.
fn signed(difference: &Difference) -> String {
    let Interval { mean, low, high, .. } = difference.interval;
    format!("{:+.1} ({:+.1} to {:+.1})", 1e3 * mean, 1e3 * low, 1e3 * high)
}

fn errors_of(outcomes: &[Outcome], placement: usize) -> Vec<f64> {
    outcomes.iter().map(|outcome| outcome.errors[placement]).collect()
}

const DETAILED: [&str; 2] = ["the paper's", "found"];

fn edges_table(outcomes: &[Outcome]) -> Table {
    let caption = "Edges on the held-out floors with `real` noise, when a foot is about to pass them: found by a fit of two levels, errors of those found \
                   as means over floors with 95 % intervals";
    let head = [
        "floor",
        "sensors",
        "edges found",
        "error of the place, mm",
        "error of the height, mm",
        "found first, m ahead of the toe",
        "points",
        "within, gait cycles",
    ];
    let mut table = Table::new("edges", caption, &head);
    for kind in [Kind::Holes, Kind::Up, Kind::Down] {
        for (index, name) in DETAILED.iter().enumerate() {
            let of_kind: Vec<&Details> =
                outcomes.iter().filter(|it| it.floor.kind == kind).map(|it| &it.details[index]).collect();
            let edges: Vec<&Sight> = of_kind.iter().flat_map(|details| &details.edges).collect();
            let found = edges.iter().filter(|edge| edge.errors.is_some()).count();
            // A floor is a cluster: its mean counts once.
            let per_floor = |which: usize| -> Vec<f64> {
                let of_floor = |details: &&Details| {
                    let errors: Vec<f64> = details.edges.iter().filter_map(|edge| Some(edge.errors?[which])).collect();
                    (!errors.is_empty()).then(|| mean(&errors))
                };
                of_kind.iter().filter_map(of_floor).collect()
            };
            let ahead: Vec<f64> = edges.iter().filter(|edge| edge.errors.is_some()).map(|edge| edge.ahead).collect();
            let of_edges = |of: fn(&Sight) -> f64| mean(&edges.iter().map(|edge| of(edge)).collect::<Vec<_>>());
            table.row([
                kind.name().to_owned(),
                (*name).to_owned(),
                format!("{found} of {}", edges.len()),
                millimetres(&per_floor(0)),
                millimetres(&per_floor(1)),
                if ahead.is_empty() { "-".to_owned() } else { format!("{:.2}", mean(&ahead)) },
                format!("{:.1}", of_edges(|edge| edge.points as f64)),
                format!("{:.2}", of_edges(|edge| edge.cycles)),
            ]);
        }
    }
    table
}

fn kinds_table(placements: &[Placement], chosen: usize, outcomes: &[Outcome]) -> Table {
    let caption = "Error of the profile by kind of floor, mm, on the held-out floors with `real` noise; footholds whose height is known to 30 mm; readings that \
                   met something in a gait cycle";
    let mut head = vec!["sensors"];
    head.extend(Kind::ALL.map(Kind::name));
    head.extend(["footholds known", "readings in a cycle"]);
    let mut table = Table::new("kinds", caption, &head);
    let even = EVEN + chosen - LEGS;
    for index in [NONE, PAPER, even, chosen, BODY] {
        let of_kind = |kind: Kind| {
            let of = outcomes.iter().filter(|outcome| outcome.floor.kind == kind);
            millimetres(&of.map(|outcome| outcome.errors[index]).collect::<Vec<_>>())
        };
        let mut row = vec![placements[index].name.clone()];
        row.extend(Kind::ALL.map(of_kind));
        let details: Option<Vec<&Details>> = [PAPER, chosen]
            .iter()
            .position(|it| *it == index)
            .map(|place| outcomes.iter().map(|outcome| &outcome.details[place]).collect());
        row.extend(match details {
            None => ["-".to_owned(), "-".to_owned()],
            Some(details) => {
                let sum = |which: usize| details.iter().map(|it| it.footholds[which]).sum::<usize>();
                let readings: Vec<f64> = details.iter().map(|it| it.readings).collect();
                [format!("{} of {}", sum(0), sum(1)), format!("{:.0}", mean(&readings))]
            }
        });
        table.row(row);
    }
    table
}

fn memory_table(outcomes: &[Outcome]) -> Table {
    let caption = "Error of the profile from the points of the last gait cycles only, mm, on the held-out floors with `real` noise";
    let mut head = vec!["sensors".to_owned()];
    head.extend(MEMORIES.map(|cycles| format!("{cycles} cycles")));
    let mut table = Table::new("memory", caption, &head.iter().map(String::as_str).collect::<Vec<_>>());
    for (index, name) in DETAILED.iter().enumerate() {
        let cell = |memory: usize| {
            millimetres(&outcomes.iter().map(|it| it.details[index].memories[memory]).collect::<Vec<_>>())
        };
        table.row(std::iter::once((*name).to_owned()).chain((0..MEMORIES.len()).map(cell)));
    }
    table
}

fn placements_table(placements: &[Placement]) -> Table {
    let caption = "Placements with the least mean error on the training floors: part, place along it, elevation of the beam above the part's x axis; width of \
                   the profile's cells; evaluations";
    let head = ["sensors", "where", "cell, mm", "training error, mm", "evaluations"];
    let mut table = Table::new("placements", caption, &head);
    for placement in placements {
        let words: Vec<String> = placement.mounts.iter().map(Mount::words).collect();
        table.row([
            placement.name.clone(),
            if words.is_empty() { "-".to_owned() } else { words.join("; ") },
            format!("{:.0}", 1e3 * placement.cell),
            format!("{:.1}", 1e3 * placement.training),
            format!("{} of {BUDGET}", placement.evaluations),
        ]);
    }
    table
}

fn closer(difference: &Difference) -> &'static str {
    match difference.verdict() {
        Verdict::First => "closer",
        Verdict::Second => "farther",
        Verdict::Open => "undecided",
    }
}

fn errors_table(placements: &[Placement], outcomes: &[Vec<Outcome>]) -> Table {
    let caption = "Error of the profile on the held-out floors, mm, and its difference from that of the paper's placement on the same floors, with 95 % intervals";
    let head = ["sensors", "`real`", "difference", "it is", "`harsh`", "difference", "it is"];
    let mut table = Table::new("errors", caption, &head);
    for (index, placement) in placements.iter().enumerate() {
        let mut row = vec![placement.name.clone()];
        for outcomes in outcomes {
            let errors = errors_of(outcomes, index);
            row.push(millimetres(&errors));
            if index == PAPER {
                row.extend(["-".to_owned(), "-".to_owned()]);
            } else {
                let difference = Difference::of(&errors, &errors_of(outcomes, PAPER));
                row.extend([signed(&difference), closer(&difference).to_owned()]);
            }
        }
        table.row(row);
    }
    table
}

/// The placements with all digits, from which others may compute the errors again.
fn settings_table(placements: &[Placement]) -> Table {
    let caption = "Placements: width of a cell in m; part, place and elevation in degrees of each sensor";
    let mut table = Table::new("floors-settings", caption, &["sensors", "cell", "mounts"]);
    for Placement { name, mounts, cell, .. } in placements {
        let mount = |mount: &Mount| format!("{} {} {}", mount.part.name(), mount.place, mount.elevation);
        let mounts: Vec<String> = mounts.iter().map(mount).collect();
        table.row([name.clone(), cell.to_string(), mounts.join(";")]);
    }
    table
}

fn raw_row(noise: &str, floor: &Floor, errors: &[f64]) -> Vec<String> {
    let mut row = vec![noise.to_owned(), floor.kind.name().to_owned(), floor.seed.to_string()];
    row.extend(errors.iter().map(|error| format!("{:.4}", 1e3 * error)));
    row
}

fn raw_table(placements: &[Placement], outcomes: &[Vec<Outcome>]) -> Table {
    let mut head = vec!["noise", "floor", "seed"];
    head.extend(placements.iter().map(|placement| placement.name.as_str()));
    let mut table = Table::new("floors", "Error of the profile on each held-out floor, mm", &head);
    for (noise, outcomes) in CONDITIONS.iter().zip(outcomes) {
        for outcome in outcomes {
            table.row(raw_row(noise, &outcome.floor, &outcome.errors));
        }
    }
    table
}

/// Computes rows of the table of all errors again, from the table of settings: the first held-out floor of each kind with `real` noise.
///
/// # Errors
/// A table that cannot be read; a scene that does not run to its end.
pub fn sample(job: &Job, settings: &str) -> anyhow::Result<Vec<String>> {
    let placements: Vec<Placement> = settings.lines().skip(1).map(setting).collect::<anyhow::Result<_>>()?;
    let floors: Vec<Floor> = floors(job, HELD_OUT, 1);
    cross(job, &floors, CONDITIONS[0], SPEED_MM_S, |crossing| {
        let errors: Vec<f64> = placements.iter().map(|placement| placement.error(&crossing)).collect();
        raw_row(CONDITIONS[0], &crossing.floor, &errors).join(",")
    })
}

fn setting(line: &str) -> anyhow::Result<Placement> {
    let [name, cell, words] = line.split(',').collect::<Vec<_>>()[..] else { anyhow::bail!("`{line}`") };
    let parts = [Part::Body]
        .into_iter()
        .chain((0..2).flat_map(|leg| [Part::Thigh(leg), Part::Shank(leg), Part::Foot(leg)]))
        .collect::<Vec<_>>();
    let mount = |word: &str| -> anyhow::Result<Mount> {
        let [part, place, elevation] = word.split(' ').collect::<Vec<_>>()[..] else { anyhow::bail!("`{word}`") };
        let part = parts.iter().find(|known| known.name() == part).context("a part")?;
        Ok(Mount { part: *part, place: place.parse()?, elevation: elevation.parse()? })
    };
    let mounts = words.split(';').filter(|word| !word.is_empty()).map(mount).collect::<anyhow::Result<_>>()?;
    Ok(Placement { name: name.to_owned(), mounts, cell: cell.parse()?, training: f64::NAN, evaluations: 0 })
}

fn number_chart(outcomes: &[Vec<Outcome>]) -> anyhow::Result<Figure> {
    let series = |name: &str, first: usize, count: usize, outcomes: &[Outcome]| Series {
        name: name.to_owned(),
        mark: Mark::LineAndDots,
        points: (0..count).map(|index| ((index + 1) as f64, 1e3 * mean(&errors_of(outcomes, first + index)))).collect(),
    };
    let [real, harsh] = [&outcomes[0], &outcomes[1]];
    let chart = Chart {
        name: "floors-number".to_owned(),
        title: "Error of the profile against the number of sensors".to_owned(),
        x_label: "number of sensors".to_owned(),
        y_label: "error on the held-out floors, mm".to_owned(),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        series: vec![
            series("evenly on the shank", EVEN, ON_LEGS, real),
            series("found, on the legs", LEGS, ON_LEGS, real),
            series("found, on the body", BODY, ON_BODY, real),
            series("found, on the legs, harsh noise", LEGS, ON_LEGS, harsh),
            Series {
                name: "the paper's".to_owned(),
                mark: Mark::Dots,
                points: vec![(1.0, 1e3 * mean(&errors_of(real, PAPER)))],
            },
        ],
    };
    Ok(Figure {
        name: chart.name.clone(),
        label: "Number of sensors".to_owned(),
        caption: "Means over the held-out floors, `real` noise unless the legend says otherwise.".to_owned(),
        claim: "Error without a sensor".to_owned(),
        number: format!("{:.1} mm", 1e3 * mean(&errors_of(real, NONE))),
        picture: Picture::chart(&chart)?,
    })
}

/// The robot on stairs, when it is about to pass the second edge.
fn picture(crossing: &Crossing, placement: &Placement, name: &str, title: &str) -> Figure {
    let second = crossing.floor.edges.get(1).map_or(f64::INFINITY, |edge| edge.at);
    let step = crossing.steps.iter().position(|step| step.xs[step.xs.len() - 1] >= second).unwrap_or(0);
    let step = &crossing.steps[step];
    let readings: Vec<Vec<Reading>> = placement.mounts.iter().map(|mount| crossing.readings(mount)).collect();
    let seen: Vec<Sightings> = readings.iter().map(|readings| crossing.sightings(readings, f64::INFINITY)).collect();
    let index = crossing.steps.iter().position(|other| other.at == step.at).unwrap_or(0);
    let known = profile::known(step, seen.iter().flat_map(|seen| &seen[index]), placement.cell);
    let known: Vec<DVec2> = step.xs.iter().map(|x| DVec2::new(*x, profile::height(&known, x + step.shift))).collect();
    let error = profile::error(step, seen.iter().flat_map(|seen| &seen[index]), placement.cell);
    Figure {
        name: name.to_owned(),
        label: title.to_owned(),
        caption: "Training stairs, `real` noise: the legs every quarter of a gait cycle, the beams of the last cycle that met something, and the ground that \
                  the next step needs, as the robot knows it (thick)."
            .to_owned(),
        claim: "Error of that profile".to_owned(),
        number: format!("{:.0} mm", 1e3 * error),
        picture: Picture::Svg(side::over_floor(crossing, &readings, step.at, &known, title)),
    }
}

fn claims(placements: &[Placement], chosen: usize, outcomes: &[Vec<Outcome>], same: &Same) -> Vec<Claim> {
    let claim = |section: &str, paper: &str, ours: String, number: String, holds: bool| Claim {
        section: section.to_owned(),
        paper: paper.to_owned(),
        ours,
        number,
        holds,
        weight: Weight::Told,
        basis: Basis::Found,
    };
    let real = &outcomes[0];
    let cycles = outcomes.iter().flatten().map(|outcome| outcome.cycles).min().unwrap_or_default();
    let touches: usize = real.iter().map(|outcome| outcome.touches).sum();
    let mut claims = vec![
        Claim {
            weight: Weight::Must,
            basis: Basis::Set,
            ..claim(
                "6",
                "the sensors follow the ups and downs of the legs during the walk",
                format!(
                    "whole gait cycles of each walk, at least {MIN_CYCLES}; the biped walks straight on whatever it sees, so its shins may touch steps"
                ),
                format!("{cycles} cycles at least; {touches} touches on {} held-out floors", real.len()),
                cycles >= MIN_CYCLES,
            )
        },
        Claim {
            weight: Weight::Must,
            ..claim(
                "6.2",
                "the point that is hit follows from the pose of the sensor and the distance",
                format!(
                    "sensors found, mounted on the robot and read by its program with `real` noise over stairs, against readings computed from the trace: points at most {:.0} mm apart",
                    1e3 * SAME
                ),
                format!(
                    "{:.1} mm at most; {} of {} readings in one only",
                    1e3 * same.farthest,
                    same.missing,
                    same.readings
                ),
                same.farthest <= SAME && 100 * same.missing <= same.readings,
            )
        },
    ];
    for kind in [Kind::Holes, Kind::Uneven, Kind::Up, Kind::Down] {
        let of_kind = |index: usize| -> Vec<f64> {
            real.iter().filter(|it| it.floor.kind == kind).map(|it| it.errors[index]).collect()
        };
        let difference = Difference::of(&of_kind(PAPER), &of_kind(NONE));
        claims.push(claim(
            "6",
            "the biped also detects holes in the ground, how the ground is uneven, or stairs",
            format!(
                "{}: error of the profile with a laser range finder at the paper's place minus without a sensor; closer on {} of {} floors",
                kind.name(),
                difference.wins,
                difference.cases
            ),
            format!("{} mm", signed(&difference)),
            difference.verdict() == Verdict::First,
        ));
    }
    let compared = |outcomes: &[Outcome], first: usize, second: usize| {
        Difference::of(&errors_of(outcomes, first), &errors_of(outcomes, second))
    };
    let pair = |section: &str, paper: &str, noise: usize, first: usize, second: usize| {
        let difference = compared(&outcomes[noise], first, second);
        let words = format!(
            "{} minus {}, `{}` noise; closer on {} of {} floors",
            placements[first].name, placements[second].name, CONDITIONS[noise], difference.wins, difference.cases
        );
        claim(section, paper, words, format!("{} mm", signed(&difference)), difference.verdict() == Verdict::First)
    };
    let moving = "a sensor on the leg has the advantage of an additional movement that gives further information";
    claims.push(pair("6", moving, 0, LEGS, BODY));
    let few = "few sensors at some strategic positions make the detection more robust";
    for noise in 0..CONDITIONS.len() {
        claims.push(pair("7", few, noise, chosen, PAPER));
        claims.push(pair("7", few, noise, chosen, EVEN + chosen - LEGS));
    }
    let is_inner = chosen < BODY - 1;
    claims.push(claim(
        "7",
        "few sensors suffice",
        format!(
            "smallest number on the legs after which one more lowers the training error by at most {:.0} %, of up to {ON_LEGS}",
            100.0 * WORTH
        ),
        format!("{} sensors", chosen - LEGS + 1),
        is_inner,
    ));
    if is_inner {
        let more = compared(real, chosen + 1, chosen);
        claims.push(claim(
            "7",
            "few sensors suffice",
            format!("{} minus {}, `real` noise, held-out floors", placements[chosen + 1].name, placements[chosen].name),
            format!("{} mm", signed(&more)),
            more.verdict() != Verdict::First,
        ));
    }
    claims
}
