//! Wu et al. 2013 with a robot's real odometry: the loss of map quality by raw odometry, and the fraction that a
//! corrected pose recovers.
//!
//! The robot drives by its raw odometry. The readings of one drive give three maps, all by the paper's method: with the
//! true poses, with the poses of odometry, and with poses corrected by [`mapping::tracker`]. So the maps differ only by
//! their poses.

mod drive;
mod rooms;

use std::time::Instant;

use accuracy::comparison::{Interval, Parameter, Search, Tuned, tune};
use anyhow::Context as _;
use mapping::grid::png;
use mapping::localise::OdometryNoise;
use mapping::measurement::Error;
use mapping::score::Score;
use mapping::tracker::Correction;

use self::drive::{Drive, Track};
use self::rooms::{Case, cases};
use crate::page::{Basis, Claim, Figure, Page, Picture, Table, Weight};
use crate::run::Job;

/// Seeds of the first training drive and the first held-out drive for the seed 1; another seed moves them up by a
/// multiple of 100,000.
const TRAINING: u64 = 331_100;
const HELD_OUT: u64 = 331_500;
const APART: u64 = 100_000;

/// Noise profile for which the settings are chosen.
const NOISE: &str = "real";
/// Noise profiles to which the settings are applied without a new choice.
const OTHERS: [&str; 2] = ["mild", "harsh"];

/// Rules of the search.
const SEARCH: Search = Search { cases: 12, few: 4, budget: 1200, first: 6 };
const GAIN: f64 = 0.01;
const PARAMETERS: [Parameter; 5] = [
    Parameter { name: "sigma, m", start: 0.04, ratio: 1.5, most: f64::INFINITY, gain: GAIN },
    Parameter { name: "outlier", start: 0.1, ratio: 2.0, most: 0.9, gain: GAIN },
    Parameter { name: "turn, rad/rad", start: 0.02, ratio: 2.0, most: f64::INFINITY, gain: GAIN },
    Parameter { name: "drift, rad/m", start: 0.03, ratio: 2.0, most: f64::INFINITY, gain: GAIN },
    Parameter { name: "distance, m/m", start: 0.02, ratio: 2.0, most: f64::INFINITY, gain: GAIN },
];

/// Decision rule: the correction is sufficient if it recovers at least this fraction of the loss by raw odometry in
/// each room, both for the fraction of right cells and for precision.
const ENOUGH: f64 = 0.5;

fn correction(setting: &[f64]) -> anyhow::Result<Correction> {
    let &[sigma, outlier, turn, drift, distance] = setting else {
        anyhow::bail!("{} numbers of a setting, expected {}", setting.len(), PARAMETERS.len());
    };
    Ok(Correction { error: Error { sigma, outlier }, odometry: OdometryNoise { turn, drift, distance } })
}

/// A drive with its poses and maps.
struct Judged {
    drive: Drive,
    exact: Track,
    raw: Track,
    corrected: Track,
}

impl Judged {
    fn of(drive: Drive, correction: Correction) -> Self {
        Self { exact: drive.exact(), raw: drive.raw(), corrected: drive.corrected(correction), drive }
    }
}

/// Makes the page: searches the settings on training rooms, then evaluates them in the three held-out rooms.
///
/// # Errors
/// If a scene does not run to its end, or a search does not enclose the optimum.
pub fn run(job: &Job) -> anyhow::Result<Page> {
    let first = |seed: u64| seed + job.seed().wrapping_sub(1).wrapping_mul(APART);
    let training = drives(job, &rooms::training(), first(TRAINING), NOISE)?;
    let error = |setting: &[f64], case: usize| match correction(setting) {
        Ok(correction) => training[case].corrected(correction).error,
        Err(_) => f64::NAN,
    };
    let tuned = tune(&PARAMETERS, SEARCH, error)?;
    let raw: Vec<f64> = training.iter().map(|drive| drive.raw().error).collect();
    let errors = [&raw, &tuned.errors].map(|errors| Interval::of(errors).mean);
    job.tell(&format!("{:?}, raw and corrected {errors:.4?}, {} evaluations", tuned.setting, tuned.evaluations));
    let correction = correction(&tuned.setting)?;
    // All choices are made above.
    let rooms = rooms::held_out()?;
    let judge = |noise: &str| -> anyhow::Result<Vec<Judged>> {
        drives(job, &rooms, first(HELD_OUT), noise)
            .map(|drives| drives.into_iter().map(|drive| Judged::of(drive, correction)).collect())
    };
    let begin = Instant::now();
    let results = judge(NOISE)?;
    let others = OTHERS.iter().map(|noise| judge(noise)).collect::<anyhow::Result<Vec<_>>>()?;
    job.tell(&format!("all drives and corrections: {:.0} s", begin.elapsed().as_secs_f64()));

    let source =
        "J. Wu, T. Qin, H. Si, J. Chen, K. Lin, C. Zhang: Environmental Modeling Based on Ultrasonic Ranging, 2013";
    let mut page = Page::new("Grid maps with real odometry", source);
    page.claims = claims(&results);
    page.table(settings_table(&tuned, errors));
    page.table(starts(&results));
    let conditions: Vec<(&str, &[Judged])> = std::iter::once((NOISE, &results[..]))
        .chain(OTHERS.into_iter().zip(others.iter().map(Vec::as_slice)))
        .collect();
    page.table(conditions_table(&conditions));
    for result in results.iter().filter(|result| result.drive.name.ends_with("-1")) {
        page.figure(picture(result)?);
    }
    Ok(page)
}

/// Runs a drive from each start.
fn drives(job: &Job, rooms: &[rooms::Room], seed: u64, noise: &str) -> anyhow::Result<Vec<Drive>> {
    let cases = cases(rooms, seed, noise);
    let runs: Vec<_> = cases.iter().map(|case| case.run(job)).collect();
    let find = |name: &str| cases.iter().find(|case| case.name == name).with_context(|| format!("no case `{name}`"));
    job.run(&runs, |run, trace| find(&run.name).and_then(|case: &Case| Drive::new(case, &trace)))
}

fn percent(fraction: f64) -> String {
    if fraction.is_nan() { "-".to_owned() } else { format!("{:.1} %", 100.0 * fraction) }
}

/// Mean over the starts of each room, in the order of the rooms.
fn by_room(results: &[Judged], value: impl Fn(&Judged) -> f64) -> Vec<f64> {
    let starts = rooms::STARTS;
    results.chunks(starts).map(|room| room.iter().map(&value).sum::<f64>() / starts as f64).collect()
}

/// Mean over rooms, with the minimum and maximum, in percent.
fn over_rooms(values: &[f64]) -> String {
    let Interval { mean, low, high, .. } = Interval::of(values);
    format!("{:.1} % ({:.1} to {:.1})", 100.0 * mean, 100.0 * low, 100.0 * high)
}

/// Selects a track of a drive.
type Chosen = fn(&Judged) -> &Track;

type Value = fn(&Score) -> f64;
const RIGHT: Value = Score::accuracy;
const PRECISION: Value = |score| score.precision;
const RECALL: Value = |score| score.recall;

/// Fraction of the loss by raw odometry that the correction recovers, for the mean of each room.
fn returned(results: &[Judged], value: Value) -> Vec<f64> {
    let [exact, raw, corrected] = [
        by_room(results, |result| value(&result.exact.score)),
        by_room(results, |result| value(&result.raw.score)),
        by_room(results, |result| value(&result.corrected.score)),
    ];
    (0..exact.len()).map(|room| (corrected[room] - raw[room]) / (exact[room] - raw[room])).collect()
}

/// Minimum and maximum over all starts, in percent.
fn over_starts(results: &[Judged], value: impl Fn(&Judged) -> f64) -> String {
    let (low, high) = results
        .iter()
        .map(value)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    format!("{:.1} to {:.1} %", 100.0 * low, 100.0 * high)
}

fn claims(results: &[Judged]) -> Vec<Claim> {
    let claim = |ours: String, number: String, holds: bool| Claim {
        section: "Summary".to_owned(),
        paper: "real-time and complete maps".to_owned(),
        ours,
        number,
        holds,
        weight: Weight::Told,
        basis: Basis::Found,
    };
    let mut claims = Vec::new();
    let three: [(&str, Chosen); 3] = [
        ("true poses", |result| &result.exact),
        ("raw odometry", |result| &result.raw),
        ("corrected poses", |result| &result.corrected),
    ];
    for (poses, track) in three {
        let value = |value: Value| {
            let values = by_room(results, |result| value(&track(result).score));
            format!("{}, starts {}", over_rooms(&values), over_starts(results, |r| value(&track(r).score)))
        };
        let right = Interval::of(&by_room(results, |result| RIGHT(&track(result).score))).mean;
        claims.push(claim(
            format!(
                "`real` noise, {poses}: mean of three rooms, range of the rooms, range of their {} starts",
                results.len()
            ),
            format!("right {}; precision {}; recall {}", value(RIGHT), value(PRECISION), value(RECALL)),
            right >= super::MIN_SCORES.0,
        ));
    }
    let [right, precision, recall] = [RIGHT, PRECISION, RECALL].map(|value| returned(results, value));
    let is_enough = |shares: &[f64]| shares.iter().all(|share| *share >= ENOUGH);
    let holds = is_enough(&right) && is_enough(&precision);
    claims.push(claim(
        "share of the loss that corrected poses bring back; at least half in each room, in cells right and precision"
            .to_owned(),
        format!("right {}; precision {}; recall {}", over_rooms(&right), over_rooms(&precision), over_rooms(&recall)),
        holds,
    ));
    claims
}

fn settings_table(tuned: &Tuned, [raw, corrected]: [f64; 2]) -> Table {
    let mut head: Vec<&str> = PARAMETERS.iter().map(|parameter| parameter.name).collect();
    head.extend(["training error", "of raw odometry", "settings tried", "evaluations"]);
    let caption = "Setting with the least mean error on the training drives: root of the mean square of the error of the position (m) and of \
                   the heading (rad) over all scans; each one step lower and higher is no improvement";
    let mut table = Table::new("settings", caption, &head);
    let mut row: Vec<String> = tuned.setting.iter().map(f64::to_string).collect();
    row.extend([format!("{corrected:.4}"), format!("{raw:.4}"), tuned.settings.to_string()]);
    row.push(format!("{} of {}", tuned.evaluations, SEARCH.budget));
    table.row(row);
    table
}

const STARTS_HEAD: [&str; 9] = [
    "start",
    "scans",
    "path, m",
    "raw ends off",
    "corrected ends off",
    "right: exact, raw, corrected",
    "precision: exact, raw, corrected",
    "recall: exact, raw, corrected",
    "contacts",
];

fn start_row(result: &Judged) -> Vec<String> {
    let Judged { drive, exact, raw, corrected } = result;
    let off = |track: &Track| format!("{:.2} m, {:.1} degrees", track.end.0, track.end.1.to_degrees().abs());
    let of = |value: Value| [exact, raw, corrected].map(|track| percent(value(&track.score))).join(", ");
    vec![
        drive.name.clone(),
        drive.scans().to_string(),
        format!("{:.1}", drive.path),
        off(raw),
        off(corrected),
        of(RIGHT),
        of(PRECISION),
        of(RECALL),
        drive.contacts.to_string(),
    ]
}

fn starts(results: &[Judged]) -> Table {
    let caption = "Maps from six starts in each of three rooms, `real` noise: readings of one drive, with true, raw and corrected poses";
    let mut table = Table::new("starts", caption, &STARTS_HEAD);
    results.iter().for_each(|result| table.row(start_row(result)));
    table
}

/// Recomputes the rows of the first start in each room from the table of settings of a page.
///
/// # Errors
/// If the page has no settings, or a scene does not run to its end.
pub fn sample(job: &Job, doc: &str) -> anyhow::Result<Vec<String>> {
    let mut lines = doc.lines().skip_while(|line| *line != "<!-- papers: odometry/settings -->");
    let row = lines.nth(3).context("no settings")?;
    let values = row.split('|').map(str::trim).skip(1).take(PARAMETERS.len()).map(str::parse);
    let correction = correction(&values.collect::<Result<Vec<f64>, _>>().context("a setting")?)?;
    let runs: Vec<Case> = cases(&rooms::held_out()?, HELD_OUT, NOISE);
    let firsts: Vec<&Case> = runs.iter().filter(|case| case.name.contains("-1-")).collect();
    let scenes: Vec<_> = firsts.iter().map(|case| case.run(job)).collect();
    let find = |name: &str| firsts.iter().find(|case| case.name == name).with_context(|| format!("no case `{name}`"));
    let drives = job.run(&scenes, |run, trace| find(&run.name).and_then(|case| Drive::new(case, &trace)))?;
    let row = |drive| format!("| {} |", start_row(&Judged::of(drive, correction)).join(" | "));
    Ok(drives.into_iter().map(row).collect())
}

fn conditions_table(conditions: &[(&str, &[Judged])]) -> Table {
    let caption = "The setting found in `real` noise, in this and other noise: mean of three rooms and their range";
    let head = ["noise", "poses", "error", "right", "precision", "recall"];
    let mut table = Table::new("conditions", caption, &head);
    for (noise, results) in conditions {
        let mut row = |name: &str, track: &dyn Fn(&Judged) -> &Track| {
            let of = |value: Value| over_rooms(&by_room(results, |result| value(&track(result).score)));
            let error = Interval::of(&by_room(results, |result| track(result).error));
            let error = format!("{:.3} ({:.3} to {:.3})", error.mean, error.low, error.high);
            table.row([(*noise).to_owned(), name.to_owned(), error, of(RIGHT), of(PRECISION), of(RECALL)]);
        };
        row("true", &|result| &result.exact);
        row("raw odometry", &|result| &result.raw);
        row("corrected", &|result| &result.corrected);
    }
    table
}

fn picture(result: &Judged) -> anyhow::Result<Figure> {
    use std::fmt::Write as _;

    use base64::Engine as _;
    use base64::engine::general_purpose::STANDARD;

    const SCALE: f64 = 60.0;
    const GAP: f64 = 14.0;
    const TOP: f64 = 44.0;
    // Unlike the red of false cells.
    const COLOURS: [&str; 3] = ["#0a7", "#a0a", "#15d"];
    let Judged { drive, exact, raw, corrected } = result;
    let frame = *drive.truth.frame();
    let cell = frame.cell_size();
    let (width, height) = (SCALE * cell * frame.columns() as f64, SCALE * cell * frame.rows() as f64);
    let (all_width, all_height) = (3.0 * (width + GAP) + GAP, TOP + height + GAP);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{all_width:.0}\" height=\"{all_height:.0}\" \
         viewBox=\"0 0 {all_width:.0} {all_height:.0}\" font-family=\"DejaVu Sans, sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    // Writing to a string cannot fail.
    for (index, name) in ["true path", "path by raw odometry", "corrected path"].iter().enumerate() {
        let x = GAP + 190.0 * index as f64;
        let _ = writeln!(
            svg,
            "<line x1=\"{x}\" x2=\"{}\" y1=\"14\" y2=\"14\" stroke=\"{}\" stroke-width=\"3\"/><text x=\"{}\" y=\"18\">{name}</text>",
            x + 18.0,
            COLOURS[index],
            x + 23.0
        );
    }
    for (index, (title, track)) in
        [("true poses", exact), ("raw odometry", raw), ("corrected poses", corrected)].into_iter().enumerate()
    {
        let left = GAP + index as f64 * (width + GAP);
        let colours = super::shown(&track.map, &drive.truth);
        let data = STANDARD.encode(png(&colours.picture(2, |colour| *colour))?);
        let right = percent(track.score.accuracy());
        let _ = writeln!(
            svg,
            "<text x=\"{left:.1}\" y=\"{}\">map with {title}: {right} right</text>\n<image x=\"{left:.1}\" y=\"{TOP}\" width=\"{width:.1}\" \
             height=\"{height:.1}\" preserveAspectRatio=\"none\" href=\"data:image/png;base64,{data}\"/>",
            TOP - 6.0
        );
        let mut line = |track: &Track, colour: &str| {
            let at = |x: f64, y: f64| {
                let place = frame.in_cells(mapping::pose::Point::new(x, y)) * cell;
                format!("{:.1},{:.1}", left + SCALE * place.x, TOP + height - SCALE * place.y)
            };
            let points: Vec<String> = track.poses.iter().map(|pose| at(pose.position.x, pose.position.y)).collect();
            let _ = writeln!(
                svg,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\"/>",
                points.join(" ")
            );
        };
        line(exact, COLOURS[0]);
        match index {
            1 => line(raw, COLOURS[1]),
            2 => line(corrected, COLOURS[2]),
            _ => {}
        }
    }
    svg += "</svg>\n";
    Ok(Figure {
        name: drive.name.clone(),
        label: format!("Maps and paths, {}", drive.name),
        caption: "Readings of one drive; black: occupied, white: free, red: marked occupied but free, orange: marked free but not, grey: unknown. \
                  Paths join the scans."
            .to_owned(),
        claim: "End of the path off the true one, raw and corrected".to_owned(),
        number: format!("{:.2} m, {:.2} m", raw.end.0, corrected.end.0),
        picture: Picture::Svg(svg),
    })
}
