//! The page of the fusion study: settings from training terrains, errors on held-out terrains, and verdicts on the
//! paper's claims.

use std::fmt::Write as _;
use std::ops::Range;
use std::thread;

use accuracy::comparison::{Difference, Interval, Tuned, Verdict};
use accuracy::figure::{Figure as Chart, Mark, Scale, Series};
use anyhow::Context as _;

use super::fusion::{
    GRIDS, GROUPS, Known, METHODS, Method, OURS, PRINTED, Part, READINGS, SEARCH, Surface, centimetres, closer,
};
use super::fusion::{errors, tuned, work};
use super::picture::{Panel, maps};
use super::survey::{Condition, SIDE, Survey, measure};
use crate::page::{Basis, Claim, Figure, Page, Picture, Table, Weight, escaped};
use crate::run::Job;

/// Seed of the first training terrain if the seed of the job is 1.
const TRAINING: u64 = 127_100;
/// Seed of the first held-out terrain if the seed of the job is 1.
const HELD_OUT: u64 = 127_500;
/// Difference of the terrains' seeds between successive seeds of the job.
const SEED_STRIDE: u64 = 100_000;

/// Errors of all methods for one number of readings.
struct Results {
    readings: usize,
    tuned: Vec<Tuned>,
    /// By condition, then method: an error for each held-out terrain, m.
    errors: Vec<Vec<Vec<f64>>>,
}

impl Results {
    /// Errors of a method in a condition, m.
    fn of(&self, condition: Condition, method: usize) -> &[f64] {
        &self.errors[condition as usize][method]
    }

    /// Of the given methods, the one with the minimum mean error in training.
    fn best(&self, methods: &[usize]) -> usize {
        let mean = |method: &usize| Interval::of(&self.tuned[*method].errors).mean;
        let best = methods.iter().min_by(|a, b| mean(a).total_cmp(&mean(b)));
        *best.expect("some methods")
    }

    fn difference(&self, condition: Condition, first: usize, second: usize) -> Difference {
        Difference::of(self.of(condition, first), self.of(condition, second))
    }
}

/// Makes the page with `terrains` training terrains and as many held-out ones.
///
/// # Errors
/// If a scene does not run to its end, or a search does not enclose the optimum.
pub fn page(job: &Job, terrains: usize) -> anyhow::Result<Page> {
    let seeds = |first: u64| {
        let first = first + (job.seed().wrapping_sub(1)).wrapping_mul(SEED_STRIDE);
        first..first + terrains as u64
    };
    let training = measure(job, seeds(TRAINING), Condition::AsAssumed)?;
    let groups: Vec<(usize, Range<usize>)> =
        READINGS.into_iter().flat_map(|readings| GROUPS.map(|group| (readings, group))).collect();
    let of_groups = on_two_threads(&groups, |(readings, group)| {
        let mut known = Known::new();
        METHODS[group.clone()]
            .iter()
            .map(|method| {
                let tuned = tuned(method, &training, *readings, &mut known)?;
                job.tell(&format!(
                    "{}, {readings} readings: {}, {:.1} cm, {} evaluations",
                    method.name,
                    method.words(&tuned.setting),
                    100.0 * Interval::of(&tuned.errors).mean,
                    tuned.evaluations
                ));
                Ok(tuned)
            })
            .collect::<anyhow::Result<Vec<Tuned>>>()
    })?;
    let all_tuned: Vec<Vec<Tuned>> = of_groups.chunks(GROUPS.len()).map(|groups| groups.concat()).collect();
    let chart = work_chart(&training, &all_tuned[0])?;
    // The held-out terrains are measured only after all settings are chosen, so no choice depends on them.
    let held_out: Vec<Vec<Survey>> = Condition::ALL
        .iter()
        .map(|condition| measure(job, seeds(HELD_OUT), *condition))
        .collect::<anyhow::Result<_>>()?;
    let mut results = Vec::new();
    for (readings, tuned) in READINGS.into_iter().zip(all_tuned) {
        job.tell(&format!("held-out terrains, {readings} readings"));
        let pairs: Vec<(&Method, &Tuned)> = METHODS.iter().zip(&tuned).collect();
        let of = |surveys: &Vec<Survey>| {
            on_two_threads(&pairs, |(method, tuned)| errors(method, &tuned.setting, surveys, readings))
        };
        let errors = held_out.iter().map(of).collect::<anyhow::Result<_>>()?;
        results.push(Results { readings, tuned, errors });
    }

    let source = "J. A. Morgado de Gois, M. Hiller: Implementation of a Sensor System for Obstacle Avoidance at a Four-Legged Robot";
    let mut page = Page::new("Maps from sonar: a fair comparison", source);
    page.text(format!(
        "{terrains} training and {terrains} held-out terrains of {SIDE} m x {SIDE} m, relief of 0.3 m with 12 boulders up to 1 m high. A beam with 16 sonars (SRF08) \
         passes over each, 2.5 m high; every second one looks straight down, the others 25 degrees ahead. Seeds {} to {} and {} to {}.",
        seeds(TRAINING).start,
        seeds(TRAINING).end - 1,
        seeds(HELD_OUT).start,
        seeds(HELD_OUT).end - 1
    ));
    page.claims = claims(&results);
    page.table(settings(&results));
    page.table(errors_table(&results));
    page.table(pairs_table(&results));
    page.table(exact_settings(&results));
    page.table(raw(&results, &held_out[0]));
    page.figure(intervals(&results));
    page.figure(chart);
    page.figure(figure(&held_out[0][0], &results[0])?);
    Ok(page)
}

/// Applies a function to each item of a list, on two threads. The results are in the order of the list.
pub fn on_two_threads<T: Sync, R: Send>(
    list: &[T],
    each: impl Fn(&T) -> anyhow::Result<R> + Sync,
) -> anyhow::Result<Vec<R>> {
    let next = std::sync::atomic::AtomicUsize::new(0);
    let work = || {
        let mut done = Vec::new();
        loop {
            let index = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            let Some(item) = list.get(index) else { return done };
            done.push((index, each(item)));
        }
    };
    let mut done = thread::scope(|scope| -> anyhow::Result<Vec<(usize, anyhow::Result<R>)>> {
        let other = thread::Builder::new().name("pairs".to_owned()).spawn_scoped(scope, work);
        let mut done = work();
        let other = other.context("a thread cannot be started")?.join();
        done.extend(other.ok().context("a thread panicked")?);
        Ok(done)
    })?;
    done.sort_by_key(|(index, _)| *index);
    done.into_iter().map(|(_, result)| result).collect()
}

fn settings(results: &[Results]) -> Table {
    let caption = "Parameters with the least mean error on the training terrains: cells along the sides, least membership that counts (cut), \
                   and those of each method; each one step lower and higher is worse";
    let head = ["method", "readings", "setting", "training error, cm", "settings tried", "evaluations"];
    let mut table = Table::new("settings", caption, &head);
    for (index, method) in METHODS.iter().enumerate() {
        for result in results {
            let tuned = &result.tuned[index];
            table.row([
                method.name.to_owned(),
                result.readings.to_string(),
                method.words(&tuned.setting),
                format!("{:.1}", 100.0 * Interval::of(&tuned.errors).mean),
                tuned.settings.to_string(),
                format!("{} of {}", tuned.evaluations, SEARCH.budget),
            ]);
        }
    }
    table
}

/// The settings with all digits, in the order of the parameters, so that others can recompute the maps.
fn exact_settings(results: &[Results]) -> Table {
    let caption = "Parameters of each method, in the order of the table of settings, cut and cells last";
    let mut table = Table::new("fusion-settings", caption, &["method", "readings", "setting"]);
    for result in results {
        for (method, tuned) in METHODS.iter().zip(&result.tuned) {
            let values: Vec<String> = tuned.setting.iter().map(f64::to_string).collect();
            table.row([method.name.to_owned(), result.readings.to_string(), values.join(" ")]);
        }
    }
    table
}

/// Recomputes one row of the table of all errors from the table of exact settings: the first held-out terrain under the
/// assumed condition, with the smaller number of readings.
///
/// # Errors
/// If a table lacks settings for a method, or a scene does not run to its end.
pub fn sample(job: &Job, settings: &str) -> anyhow::Result<String> {
    let condition = Condition::AsAssumed;
    let survey = &measure(job, HELD_OUT..HELD_OUT + 1, condition)?[0];
    let readings = READINGS[1];
    let is_of = |line: &&str| line.rsplit(',').nth(1) == Some(&readings.to_string());
    let lines: Vec<&str> = settings.lines().filter(is_of).collect();
    anyhow::ensure!(lines.len() == METHODS.len(), "{} methods with {readings} readings", lines.len());
    let mut row = vec![condition.name().to_owned(), readings.to_string(), survey.seed.to_string()];
    for (method, line) in METHODS.iter().zip(lines) {
        let values = line.rsplit(',').next().unwrap_or_default().split(' ').map(str::parse);
        let setting: Vec<f64> = values.collect::<Result<_, _>>().with_context(|| line.to_owned())?;
        row.push(format!("{:.4}", 100.0 * method.error(&setting, survey, readings, Part::Whole)?));
    }
    Ok(row.join(","))
}

fn errors_table(results: &[Results]) -> Table {
    let caption = "Height error on the held-out terrains: mean of the root mean square, and its 95 % interval, cm";
    let mut head = vec!["method", "readings"];
    head.extend(Condition::ALL.map(Condition::name));
    let mut table = Table::new("errors", caption, &head);
    for (index, method) in METHODS.iter().enumerate() {
        for result in results {
            let cell = |condition: Condition| centimetres(&Interval::of(result.of(condition, index)));
            let mut row = vec![method.name.to_owned(), result.readings.to_string()];
            row.extend(Condition::ALL.map(cell));
            table.row(row);
        }
    }
    table
}

/// Pairs of methods that are compared: TSK as printed with each projection of the grid and with the ridge of maximum
/// evidence, printed planes with printed constants, and our method with all others.
fn compared() -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    for first in PRINTED {
        pairs.extend(GRIDS.map(|grid| (first, grid)));
        pairs.push((first, first + 2));
    }
    pairs.push((PRINTED[1], PRINTED[0]));
    for second in 0..METHODS.len() {
        if second != OURS[0] {
            pairs.push((OURS[0], second));
        }
    }
    pairs
}

fn pairs_table(results: &[Results]) -> Table {
    let caption = "Paired differences on the held-out terrains as assumed: error of the first method minus error of the second, and its 95 % interval, cm; \
                   terrains on which the first is closer; which is closer by the rule of decision, in each condition";
    let mut head = vec!["first", "second", "readings", "difference, cm", "first is closer on"];
    head.extend(Condition::ALL.map(Condition::name));
    let mut table = Table::new("pairs", caption, &head);
    for (first, second) in compared() {
        for result in results {
            let difference = result.difference(Condition::AsAssumed, first, second);
            let mut row = vec![
                METHODS[first].name.to_owned(),
                METHODS[second].name.to_owned(),
                result.readings.to_string(),
                centimetres(&difference.interval),
                format!("{} of {}", difference.wins, difference.cases),
            ];
            let verdict = |condition: Condition| closer(&result.difference(condition, first, second)).to_owned();
            row.extend(Condition::ALL.map(verdict));
            table.row(row);
        }
    }
    table
}

/// All errors, from which others can recompute the tables.
fn raw(results: &[Results], held_out: &[Survey]) -> Table {
    let mut head = vec!["condition", "readings", "terrain"];
    head.extend(METHODS.iter().map(|method| method.name));
    let mut table = Table::new("fusion", "Root mean square error of the heights on each held-out terrain, cm", &head);
    for condition in Condition::ALL {
        for result in results {
            for (terrain, survey) in held_out.iter().enumerate() {
                let mut row = vec![condition.name().to_owned(), result.readings.to_string(), survey.seed.to_string()];
                let error = |method: usize| format!("{:.4}", 100.0 * result.of(condition, method)[terrain]);
                row.extend((0..METHODS.len()).map(error));
                table.row(row);
            }
        }
    }
    table
}

fn claims(results: &[Results]) -> Vec<Claim> {
    let claim = |section: &str, paper: &str, ours: String, number: String, holds: bool| Claim {
        section: section.to_owned(),
        paper: paper.to_owned(),
        ours,
        number,
        holds,
        weight: Weight::Told,
        basis: Basis::Found,
    };
    let mut claims = Vec::new();
    for result in results {
        let printed = result.best(&PRINTED);
        let grids = [(GRIDS[0], "the paper's projection"), (result.best(&GRIDS), "its best projection in training")];
        for (grid, which) in grids {
            let difference = result.difference(Condition::AsAssumed, printed, grid);
            claims.push(claim(
                "4",
                "at the best partition of both, TSK is closer to the terrain than the occupancy grid",
                format!(
                    "{} minus {} ({which}), {} readings; closer on {} of {} terrains",
                    METHODS[printed].name, METHODS[grid].name, result.readings, difference.wins, difference.cases
                ),
                format!("{} cm", centimetres(&difference.interval)),
                difference.verdict() == Verdict::First,
            ));
        }
    }
    let [many, few] = [&results[0], &results[1]];
    let [constants, planes] = PRINTED;
    let of_planes = few.difference(Condition::AsAssumed, planes, constants);
    claims.push(claim(
        "4",
        "with few samples planes are better than constants",
        format!(
            "{} minus {}, {} readings; closer on {} of {} terrains",
            METHODS[planes].name, METHODS[constants].name, few.readings, of_planes.wins, of_planes.cases
        ),
        format!("{} cm", centimetres(&of_planes.interval)),
        of_planes.verdict() == Verdict::First,
    ));
    // Lead of the better TSK over the grid's best projection, on each terrain, as a fraction of the grid's error.
    let lead = |result: &Results| -> Vec<f64> {
        let (tsk, grid) = (result.best(&PRINTED), result.best(&GRIDS));
        let pair = |(tsk, grid): (&f64, &f64)| (grid - tsk) / grid;
        result.of(Condition::AsAssumed, tsk).iter().zip(result.of(Condition::AsAssumed, grid)).map(pair).collect()
    };
    let leads = Difference::of(&lead(many), &lead(few));
    let Interval { mean, low, high, .. } = leads.interval;
    claims.push(claim(
        "4",
        "the lead of TSK over the grid is greater if just a few samples are available",
        format!(
            "lead of TSK over the grid's best projection as a fraction of the grid's error, with {} readings minus with {}",
            few.readings, many.readings
        ),
        format!("{:.1} % ({:.1} to {:.1})", -100.0 * mean, -100.0 * high, -100.0 * low),
        leads.verdict() == Verdict::First,
    ));
    claims
}

/// Chart of each method's error against its time, with coarser and finer partitions.
fn work_chart(training: &[Survey], tuned: &[Tuned]) -> anyhow::Result<Figure> {
    let series = |(method, tuned): (&Method, &Tuned)| {
        let points = work(method, &tuned.setting, training, READINGS[0])?;
        let points = points.into_iter().map(|(time, error)| (1e6 * time, 100.0 * error)).collect();
        Ok(Series { name: method.name.to_owned(), mark: Mark::LineAndDots, points })
    };
    let chart = Chart {
        name: "fusion-work".to_owned(),
        title: "Error against time, partitions coarser and finer than the best".to_owned(),
        x_label: "processor time of a reading, us".to_owned(),
        y_label: "height error on training terrains, cm".to_owned(),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        series: METHODS.iter().zip(tuned).map(series).collect::<anyhow::Result<_>>()?,
    };
    Ok(Figure {
        name: "fusion-work".to_owned(),
        label: "Work and precision".to_owned(),
        caption: format!(
            "A point is a partition: a quarter, half, 0.71, 1 and 1.41 times as many cells along a side as the best one; all other parameters as tuned, {} readings.",
            READINGS[0]
        ),
        claim: "Each method has its least error near the partition that the search found".to_owned(),
        number: format!("{} methods", METHODS.len()),
        picture: Picture::chart(&chart)?,
    })
}

/// Colours of the conditions.
const COLOURS: [&str; 4] = ["#222222", "#1f77b4", "#d95f02", "#1b9e77"];

/// Chart of the mean errors with their confidence intervals: a row for each method, a panel for each number of
/// readings.
fn intervals(results: &[Results]) -> Figure {
    const LEFT: f64 = 250.0;
    const WIDTH: f64 = 330.0;
    const ROW: f64 = 44.0;
    const TOP: f64 = 64.0;
    let all = |condition: Condition| {
        results
            .iter()
            .flat_map(move |result| (0..METHODS.len()).map(move |m| Interval::of(result.of(condition, m)).high))
    };
    let max_value = (Condition::ALL.into_iter().flat_map(all).fold(0.0, f64::max) * 20.0).ceil() / 20.0;
    let bottom = TOP + ROW * METHODS.len() as f64;
    let (width, height) = (LEFT + 2.0 * (WIDTH + 24.0), bottom + 44.0);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"DejaVu Sans, sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    // Writing to a string cannot fail.
    for (place, condition) in Condition::ALL.iter().enumerate() {
        let x = LEFT + 130.0 * place as f64;
        let (colour, name) = (COLOURS[place], condition.name());
        let _ = writeln!(
            svg,
            "<circle cx=\"{x}\" cy=\"16\" r=\"4\" fill=\"{colour}\"/><text x=\"{}\" y=\"20\">{name}</text>",
            x + 9.0
        );
    }
    for (index, method) in METHODS.iter().enumerate() {
        let y = TOP + ROW * (index as f64 + 0.5);
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>",
            LEFT - 10.0,
            y + 4.0,
            escaped(method.name)
        );
    }
    for (panel, result) in results.iter().enumerate() {
        let left = LEFT + panel as f64 * (WIDTH + 24.0);
        let x = |error: f64| left + WIDTH * error / max_value;
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"48\" text-anchor=\"middle\" font-weight=\"bold\">{} readings</text>",
            left + WIDTH / 2.0,
            result.readings
        );
        for tick in 0..=(max_value * 20.0).round() as usize {
            let error = tick as f64 / 20.0;
            let _ = writeln!(
                svg,
                "<line x1=\"{0:.1}\" x2=\"{0:.1}\" y1=\"{TOP}\" y2=\"{bottom}\" stroke=\"#dddddd\"/>",
                x(error)
            );
            if tick.is_multiple_of(2) {
                let _ = writeln!(
                    svg,
                    "<text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">{:.0}</text>",
                    x(error),
                    bottom + 16.0,
                    100.0 * error
                );
            }
        }
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">height error, cm</text>",
            left + WIDTH / 2.0,
            bottom + 34.0
        );
        for index in 0..METHODS.len() {
            for (place, condition) in Condition::ALL.into_iter().enumerate() {
                let Interval { mean, low, high, .. } = Interval::of(result.of(condition, index));
                let y = TOP + ROW * (index as f64 + 0.2 + 0.2 * place as f64);
                let colour = COLOURS[place];
                let _ = writeln!(
                    svg,
                    "<line x1=\"{:.1}\" x2=\"{:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\" stroke=\"{colour}\" stroke-width=\"2\"/>\
                     <circle cx=\"{:.1}\" cy=\"{y:.1}\" r=\"3.5\" fill=\"{colour}\"/>",
                    x(low),
                    x(high),
                    x(mean)
                );
            }
        }
    }
    svg += "</svg>\n";
    let best = results[0].best(&(0..METHODS.len()).collect::<Vec<_>>());
    Figure {
        name: "fusion".to_owned(),
        label: "Errors of the maps".to_owned(),
        caption: "Height error on the held-out terrains, mean and 95 % interval, as assumed by the methods and with another beam, another noise and poses \
                  from odometry."
            .to_owned(),
        claim: format!("{} has the least error in training with {} readings; here", METHODS[best].name, results[0].readings),
        number: format!("{} cm", centimetres(&Interval::of(results[0].of(Condition::AsAssumed, best)))),
        picture: Picture::Svg(svg),
    }
}

/// Figure 3: a held-out terrain and its maps.
fn figure(survey: &Survey, result: &Results) -> anyhow::Result<Figure> {
    let methods = [PRINTED[1], PRINTED[0], GRIDS[0], GRIDS[1], OURS[0]];
    let readings = survey.readings(result.readings)?;
    let map = |(method, letter): (usize, &str)| -> anyhow::Result<(String, Surface, f64)> {
        let surface = METHODS[method].map(&result.tuned[method].setting, &readings, Part::Whole).context("no map")?;
        let rms = 100.0 * survey.rms(SIDE, |x, y| surface.height(x, y));
        Ok((format!("{letter}  {}: {rms:.1} cm", METHODS[method].name), surface, rms))
    };
    let surfaces: Vec<_> =
        methods.into_iter().zip(["b", "c", "d", "e", "f"]).map(map).collect::<anyhow::Result<_>>()?;
    let mut panels = vec![Panel {
        title: format!("a  terrain {} (m)", survey.seed),
        height: Box::new(|x, y| Some(survey.field.height(x, y))),
        paths: Vec::new(),
    }];
    for (title, surface, _) in &surfaces {
        let height = Box::new(move |x, y| Some(surface.height(x, y)));
        panels.push(Panel { title: title.clone(), height, paths: Vec::new() });
    }
    let number: Vec<String> = surfaces.iter().map(|(.., rms)| format!("{rms:.1}")).collect();
    Ok(Figure {
        name: "figure-3".to_owned(),
        label: "Figure 3".to_owned(),
        caption: format!("The first held-out terrain (a) and maps of it from the same {} readings.", result.readings),
        claim: "Root mean square errors of b to f".to_owned(),
        number: format!("{} cm", number.join(", ")),
        picture: maps(SIDE, 330, (0.0, 1.3), &panels)?,
    })
}
