//! Range sensors of a biped that walks over holes, stairs and uneven floor: their number and their mount points.
//!
//! Section 7 of the paper names the placement of few sensors as the next step. The walk does not depend on the sensors,
//! so each walk is simulated once, and the readings of each placement are computed from its true postures with the
//! simulator's sensor model.

mod course;
mod placement;

use accuracy::comparison::{Difference, Interval, Parameter, Search, Tuned, Verdict, tune};
use accuracy::figure::{Figure as Chart, Mark, Scale, Series};
use anyhow::{Context as _, ensure};
use glam::DVec2;
use sim_core::sensor::Echo;

use self::course::{Course, Floor, WAY, courses};
use self::placement::{
    Condition, JUDGED, MountPoint, SCENES, SEARCHED, SENSORS, STEP, Score, Sensor, known, points, score,
};
use super::side::{Canvas, FAR_LEG, NEAR_LEG, RAY};
use crate::alduro::on_two_threads;
use crate::page::{Basis, Claim, Figure, Page, Picture, Table, Weight};
use crate::run::Job;

/// First seeds of the training and the held-out floors for the seed 1; another seed moves them up by a multiple of
/// 100,000.
const TRAINING: u64 = 340_000;
const HELD_OUT: u64 = 345_000;
const APART: u64 = 100_000;
/// Number of training and of held-out seeds; each has three floors.
const SEEDS: usize = 50;

/// Rules of a search; one evaluation is one seed, with its three floors, and one setting.
const SEARCH: Search = Search { cases: SEEDS, few: 12, budget: 3000, first: 8 };
const GAIN: f64 = 0.005;
/// Tilts from which the searches begin, degrees. The first sensor begins with tilt k modulo 6 in search k. From each
/// sensor to the next, the tilt moves on in this list: by one in searches 0 to 5, by two in searches 6 to 11, etc.
const TILTS: [f64; 6] = [30.0, 40.0, 50.0, 60.0, 75.0, 90.0];
const SEARCHES: usize = 4 * TILTS.len();
const NAMES: [[&str; 2]; SENSORS] = [["below 1", "tilt 1"], ["below 2", "tilt 2"], ["below 3", "tilt 3"]];

/// Decision rule: one more sensor is worthwhile if the error falls by at least this fraction of the error without
/// that sensor, and the interval of the difference excludes 0.
const WORTH: f64 = 0.05;
/// Tolerance of the program's profile and of readings that are computed from the trace, m.
const EXACT: f64 = 0.01;

/// Conditions for which nothing is searched.
const OTHERS: [Condition; 4] = [
    Condition { name: "noise three times as large", sigma: 0.03, ..SEARCHED },
    Condition { name: "no limit of incidence", echo: Echo { max_incidence: f64::INFINITY, ..Echo::LASER }, ..SEARCHED },
    Condition { name: "half a step ahead", lead: 0.5 * STEP, ..SEARCHED },
    Condition { name: "two steps ahead", lead: 2.0 * STEP, ..SEARCHED },
];

type Case = [Course; Floor::ALL.len()];

/// A placement whose settings are searched.
#[derive(Clone, Debug, PartialEq)]
struct Method {
    mount_points: Vec<MountPoint>,
    kind: Kind,
}

/// Parameters of the search in addition to the radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Position and tilt of each sensor.
    Free,
    /// The tilt of a sensor on the body at the height of the hips.
    Hip,
    /// Nothing: the sensor is that of the scene `walker`.
    Scene,
}

impl Method {
    /// All methods: no sensor, the scene's sensor, a sensor on the body at the height of the hips, and one to three
    /// sensors at all mount points. Of two mirrored placements, only the first is included.
    fn all() -> Vec<Self> {
        let method = |kind, mount_points: &[MountPoint]| Self { mount_points: mount_points.to_vec(), kind };
        let mut all = vec![
            method(Kind::Free, &[]),
            method(Kind::Scene, &[SCENES.mount_point]),
            method(Kind::Hip, &[MountPoint::Body]),
        ];
        let mut shorter: Vec<Vec<MountPoint>> = vec![Vec::new()];
        for _ in 0..SENSORS {
            let longer = |mount_points: &Vec<MountPoint>| {
                let rest = MountPoint::ALL
                    .into_iter()
                    .filter(|mount_point| mount_points.last().is_none_or(|last| last <= mount_point));
                rest.map(|mount_point| [&mount_points[..], &[mount_point]].concat()).collect::<Vec<_>>()
            };
            shorter = shorter.iter().flat_map(longer).collect();
            let is_first = |mount_points: &&Vec<MountPoint>| {
                let mut mirrored: Vec<MountPoint> =
                    mount_points.iter().map(|mount_point| mount_point.mirrored()).collect();
                mirrored.sort();
                **mount_points <= mirrored
            };
            all.extend(shorter.iter().filter(is_first).map(|mount_points| method(Kind::Free, mount_points)));
        }
        all
    }

    fn name(&self) -> String {
        match (self.kind, &self.mount_points[..]) {
            (Kind::Scene, _) => "as in the scene".to_owned(),
            (Kind::Hip, _) => "body at the hips".to_owned(),
            (Kind::Free, []) => "no sensor".to_owned(),
            (Kind::Free, mount_points) => {
                mount_points.iter().map(|mount_point| mount_point.name()).collect::<Vec<_>>().join(" + ")
            }
        }
    }

    fn is_on_legs(&self) -> bool {
        !self.mount_points.contains(&MountPoint::Body)
    }

    fn searches(&self) -> usize {
        if self.kind == Kind::Scene { 1 } else { SEARCHES }
    }

    fn parameters(&self, search: usize) -> Vec<Parameter> {
        let parameter = |name, start, ratio, most| Parameter { name, start, ratio, most, gain: GAIN };
        let mut parameters = Vec::new();
        for (index, mount_point) in self.mount_points.iter().enumerate() {
            let [below, tilt] = NAMES[index];
            if self.kind == Kind::Free {
                parameters.push(parameter(below, 0.12, 1.5, mount_point.length()));
            }
            if self.kind != Kind::Scene {
                let start = TILTS[(search + index * (1 + search / TILTS.len())) % TILTS.len()];
                parameters.push(parameter(tilt, start, 1.1, 180.0));
            }
        }
        parameters.push(parameter("radius", 0.05, 1.4, f64::INFINITY));
        parameters
    }

    fn sensors(&self, setting: &[f64]) -> Vec<Sensor> {
        let sensor = |(mount_point, pair): (&MountPoint, &[f64])| Sensor {
            mount_point: *mount_point,
            below: pair[0],
            tilt_deg: pair[1],
        };
        match self.kind {
            Kind::Free => self.mount_points.iter().zip(setting.chunks(2)).map(sensor).collect(),
            Kind::Hip => {
                vec![Sensor { mount_point: MountPoint::Body, below: MountPoint::Body.length(), tilt_deg: setting[0] }]
            }
            Kind::Scene => vec![SCENES],
        }
    }

    fn scores(&self, setting: &[f64], case: &Case, condition: &Condition) -> [Score; 3] {
        let (sensors, radius) = (self.sensors(setting), setting.last().copied().unwrap_or_default());
        case.each_ref().map(|course| score(course, &points(course, &sensors, condition), radius, condition.lead))
    }

    /// Searches the setting; `None` without a sensor.
    fn tuned(&self, training: &[Case]) -> anyhow::Result<Option<Tuned>> {
        if self.mount_points.is_empty() {
            return Ok(None);
        }
        let search = Search { cases: training.len(), few: SEARCH.few.min(training.len()), ..SEARCH };
        let error = |setting: &[f64], case: usize| mean(&self.scores(setting, &training[case], &SEARCHED));
        let results = (0..self.searches()).map(|index| Ok(tune(&self.parameters(index), search, error)?));
        let results = results.collect::<anyhow::Result<Vec<Tuned>>>().with_context(|| self.name())?;
        let [settings, evaluations] =
            [|tuned: &Tuned| tuned.settings, |tuned: &Tuned| tuned.evaluations].map(|of| results.iter().map(of).sum());
        let best = results.into_iter().min_by(|a, b| training_error(a).total_cmp(&training_error(b)));
        Ok(best.map(|best| Tuned { settings, evaluations, ..best }))
    }

    /// Setting in words.
    fn words(&self, setting: &[f64]) -> String {
        let sensor = |sensor: &Sensor| {
            format!("{} {:.0} mm below, {:.0} degrees", sensor.mount_point.name(), 1e3 * sensor.below, sensor.tilt_deg)
        };
        let mut words: Vec<String> = self.sensors(setting).iter().map(sensor).collect();
        words.extend(setting.last().map(|radius| format!("radius {:.0} mm", 1e3 * radius)));
        words.join("; ")
    }
}

fn training_error(tuned: &Tuned) -> f64 {
    Interval::of(&tuned.errors).mean
}

/// Mean error of the floors of a seed, mm.
fn mean(scores: &[Score; 3]) -> f64 {
    1e3 * scores.iter().map(|score| score.rms).sum::<f64>() / scores.len() as f64
}

/// A method with its setting, and its scores on the held-out floors.
struct Judged {
    method: Method,
    tuned: Option<Tuned>,
    /// By seed.
    scores: Vec<[Score; 3]>,
}

impl Judged {
    fn setting(&self) -> &[f64] {
        self.tuned.as_ref().map_or(&[], |tuned| &tuned.setting)
    }

    fn judge(&self, cases: &[Case], condition: &Condition) -> Vec<[Score; 3]> {
        cases.iter().map(|case| self.method.scores(self.setting(), case, condition)).collect()
    }

    fn errors(&self) -> Vec<f64> {
        self.scores.iter().map(mean).collect()
    }

    fn errors_on(&self, floor: Floor) -> Vec<f64> {
        self.scores.iter().map(|scores| 1e3 * scores[floor as usize].rms).collect()
    }
}

/// Results, and the methods that are chosen by their training errors.
struct Results {
    all: Vec<Judged>,
    /// Best placement of 0, 1, 2 and 3 sensors.
    best: [usize; SENSORS + 1],
    /// Best placement of 0, 1, 2 and 3 sensors on the legs.
    on_legs: [usize; SENSORS + 1],
    body: usize,
    hip: usize,
    scene: usize,
}

impl Results {
    fn new(all: Vec<Judged>) -> anyhow::Result<Self> {
        let best = |is: &dyn Fn(&Method) -> bool| {
            let chosen = all.iter().enumerate().filter(|(_, result)| is(&result.method));
            let error = |result: &Judged| result.tuned.as_ref().map_or(0.0, training_error);
            chosen.min_by(|(_, a), (_, b)| error(a).total_cmp(&error(b))).map(|(index, _)| index).context("a placement")
        };
        let is_free = |method: &Method, count| method.mount_points.len() == count && method.kind == Kind::Free;
        let of = |count| best(&|method| is_free(method, count));
        let on_legs = |count| best(&|method| is_free(method, count) && method.is_on_legs());
        Ok(Self {
            best: [of(0)?, of(1)?, of(2)?, of(3)?],
            on_legs: [on_legs(0)?, on_legs(1)?, on_legs(2)?, on_legs(3)?],
            body: best(&|method| is_free(method, 1) && !method.is_on_legs())?,
            hip: best(&|method| method.kind == Kind::Hip)?,
            scene: best(&|method| method.kind == Kind::Scene)?,
            all,
        })
    }

    /// The results with at most one sensor, and the best result of each number of sensors.
    fn shown(&self) -> Vec<&Judged> {
        let is_shown = |(index, result): &(usize, &Judged)| {
            result.method.mount_points.len() < 2 || self.best.contains(index) || self.on_legs.contains(index)
        };
        self.all.iter().enumerate().filter(is_shown).map(|(_, result)| result).collect()
    }

    fn difference(&self, first: usize, second: usize) -> Difference {
        Difference::of(&self.all[first].errors(), &self.all[second].errors())
    }
}

/// Makes the page, with `seeds` training seeds and as many held-out ones (50 by default).
///
/// # Errors
/// If a scene does not run to its end, or a search does not enclose the optimum.
pub fn run(job: &Job, seeds: Option<usize>) -> anyhow::Result<Page> {
    let seeds = seeds.unwrap_or(SEEDS) as u64;
    let from = |first: u64| {
        let first = first + job.seed().wrapping_sub(1).wrapping_mul(APART);
        (first..first + seeds).collect::<Vec<u64>>()
    };
    let training = courses(job, &from(TRAINING))?;
    let methods = Method::all();
    let tuned = on_two_threads(&methods, |method| {
        let tuned = method.tuned(&training)?;
        if let Some(tuned) = &tuned {
            let (words, error) = (method.words(&tuned.setting), training_error(tuned));
            job.tell(&format!("{words}: {error:.1} mm, {} evaluations", tuned.evaluations));
        }
        Ok(tuned)
    })?;
    let mut all: Vec<Judged> =
        methods.into_iter().zip(tuned).map(|(method, tuned)| Judged { method, tuned, scores: Vec::new() }).collect();
    let tilts = tilt_chart(&all, &training)?;
    // The held-out floors influence no choice: `Results` chooses by training errors.
    let held_out = courses(job, &from(HELD_OUT))?;
    let scores = on_two_threads(&all, |result| Ok(result.judge(&held_out, &SEARCHED)))?;
    all.iter_mut().zip(scores).for_each(|(result, scores)| result.scores = scores);
    let results = Results::new(all)?;

    let source = "L. France, A. Girault, J-D. Gascuel, B. Espiau: Sensor Modeling for a Walking Robot Simulation, 1999";
    let mut page = Page::new("Number and place of sensors over holes, stairs and uneven floor", source);
    page.text(format!(
        "The biped walks {WAY} m over each floor at {} mm/s; {seeds} training and {seeds} held-out seeds, each with three floors. Error: root \
         mean square difference between the height that is known of a place when the body's centre is one step, {STEP} m, before it, and the \
         true height under both feet; that is the mean of the points within a radius, else the height of the nearest point, or that under the body if it is nearer.",
        super::SPEED_MM_S
    ));
    page.claims = claims(&results, &training, &held_out);
    page.table(settings(&results));
    page.table(errors(&results));
    page.table(conditions(&results, &held_out));
    page.table(exact_settings(&results));
    page.table(raw(&results, &from(HELD_OUT)));
    page.figure(walks(&results, &held_out[0]));
    page.figure(number_chart(&results)?);
    page.figure(tilts);
    Ok(page)
}

/// Recomputes the rows of the first two held-out seeds in the table of all errors from the table of exact settings.
///
/// # Errors
/// If the table lacks settings for a method, or a scene does not run to its end.
pub fn sample(job: &Job, settings: &str) -> anyhow::Result<Vec<String>> {
    let lines: Vec<&str> = settings.lines().skip(1).collect();
    let methods = Method::all();
    ensure!(lines.len() == methods.len(), "{} settings, expected {}", lines.len(), methods.len());
    let seeds = [HELD_OUT, HELD_OUT + 1];
    let cases = courses(job, &seeds)?;
    let mut rows: Vec<Vec<String>> =
        seeds.iter().flat_map(|seed| Floor::ALL.map(|floor| start_of_row(*seed, floor))).collect();
    for (method, line) in methods.iter().zip(lines) {
        let values = line.rsplit(',').next().unwrap_or_default().split_whitespace().map(str::parse);
        let setting: Vec<f64> = values.collect::<Result<_, _>>().with_context(|| line.to_owned())?;
        let scores = cases.iter().flat_map(|case| method.scores(&setting, case, &SEARCHED));
        rows.iter_mut().zip(scores).for_each(|(row, score)| row.push(exact(&score)));
    }
    Ok(rows.into_iter().map(|row| row.join(",")).collect())
}

fn start_of_row(seed: u64, floor: Floor) -> Vec<String> {
    vec![seed.to_string(), floor.name().to_owned()]
}

fn exact(score: &Score) -> String {
    format!("{:.3}", 1e3 * score.rms)
}

fn interval(values: &[f64]) -> String {
    let Interval { mean, low, high, .. } = Interval::of(values);
    format!("{mean:.1} ({low:.1} to {high:.1})")
}

/// Mean difference with its interval, and the number of seeds on which the first method is better.
fn words(difference: &Difference) -> String {
    let Interval { mean, low, high, .. } = difference.interval;
    format!("{mean:+.1} ({low:+.1} to {high:+.1}) mm, better on {} of {}", difference.wins, difference.cases)
}

fn claims(results: &Results, training: &[Case], held_out: &[Case]) -> Vec<Claim> {
    let claim = |section: &str, paper: &str, ours: String, number: String, holds: bool| Claim {
        section: section.to_owned(),
        paper: paper.to_owned(),
        ours,
        number,
        holds,
        weight: Weight::Told,
        basis: Basis::Found,
    };
    let must = |claim: Claim| Claim { weight: Weight::Must, ..claim };
    let all = || training.iter().chain(held_out).flatten();
    let [blind, one, two, three] = results.best;
    let [_, one_on_leg, two_on_legs, three_on_legs] = results.on_legs;
    let mut claims = Vec::new();
    for floor in Floor::ALL {
        let difference =
            Difference::of(&results.all[results.scene].errors_on(floor), &results.all[blind].errors_on(floor));
        claims.push(claim(
            "6",
            "with the biped robot, we also detect eventual holes in the ground, or how the ground is uneven, or even stairs",
            format!("{}: error with the scene's sensor on the tibia minus error without a sensor, one step ahead", floor.name()),
            words(&difference),
            difference.verdict() == Verdict::First,
        ));
    }
    let mut compare = |section: &str, paper: &str, ours: &str, first: usize, second: usize, share: f64| {
        let difference = results.difference(first, second);
        let is_worth = -difference.interval.mean >= share * Interval::of(&results.all[second].errors()).mean;
        let [a, b] = [first, second].map(|index| results.all[index].method.name());
        let holds = difference.verdict() == Verdict::First && is_worth;
        claims.push(claim(section, paper, format!("{ours}: {a} minus {b}"), words(&difference), holds));
    };
    let advantage = "a sensor device placed on the legs will vertically scan the environment: a major advantage";
    compare(
        "6",
        advantage,
        "best sensor on a leg against one on the body at the height of the hips",
        one_on_leg,
        results.hip,
        0.0,
    );
    compare("6", advantage, "best sensor on a leg against the best on the body", one_on_leg, results.body, 0.0);
    let placing = "placing few sensors at some strategic positions can make the collision detection more robust";
    compare("7", placing, "best sensor against that of the scene", one, results.scene, 0.0);
    compare("7", placing, "legs only, best two against best one; better by 5 %", two_on_legs, one_on_leg, WORTH);
    compare("7", placing, "legs only, best three against best two; better by 5 %", three_on_legs, two_on_legs, WORTH);
    compare("7", placing, "best two against best one; better by 5 %", two, one, WORTH);
    compare("7", placing, "best three against best two; better by 5 %", three, two, WORTH);

    let body_at_judged = JUDGED.0 - STEP..=JUDGED.1 - STEP;
    let cycles =
        all().map(|course| course.footfalls.iter().filter(|x| body_at_judged.contains(*x)).count().saturating_sub(1));
    let cycles = cycles.min().unwrap_or(0);
    let whole = must(claim(
        "7",
        "(our own condition: at least four whole gait cycles)",
        "least number of whole gait cycles within which the judged places become due, all walks".to_owned(),
        cycles.to_string(),
        cycles >= 4,
    ));
    claims.push(Claim { basis: Basis::Set, ..whole });
    let profile: Vec<f64> = all().flat_map(|course| &course.profile_errors).copied().collect();
    let most = profile.iter().copied().fold(0.0, f64::max);
    let average = profile.iter().sum::<f64>() / profile.len() as f64;
    claims.push(must(claim(
        "6.2",
        "the point that is hit follows from the pose of the sensor and the distance",
        format!(
            "profile error of the program on these floors without noise, {} points; at most 10 mm on average",
            profile.len()
        ),
        format!("{:.1} mm on average, {:.0} mm at most", 1e3 * average, 1e3 * most),
        average <= EXACT,
    )));
    let readings: Vec<f64> = all().flat_map(|course| &course.reading_errors).copied().collect();
    let close = readings.iter().filter(|error| **error <= EXACT).count();
    claims.push(must(claim(
        "5",
        "(our own condition: readings from the trace are those of the simulator)",
        "readings of the scene's sensor that differ by at most 10 mm; at least 99 %".to_owned(),
        format!("{:.2} % of {}", 100.0 * close as f64 / readings.len() as f64, readings.len()),
        close as f64 >= 0.99 * readings.len() as f64,
    )));
    claims
}

fn settings(results: &Results) -> Table {
    let caption = "Settings with the least mean error on the training floors: distance below knee, hip or shoulder, angle from straight down, \
                   radius within which points count; best of 24 searches, each one step lower and higher is no improvement";
    let head = ["sensors", "setting", "training error, mm", "settings tried", "evaluations"];
    let mut table = Table::new("settings", caption, &head);
    for result in results.shown() {
        let Some(tuned) = &result.tuned else { continue };
        table.row([
            result.method.name(),
            result.method.words(&tuned.setting),
            format!("{:.1}", training_error(tuned)),
            tuned.settings.to_string(),
            format!("{} of {}", tuned.evaluations, SEARCH.budget * result.method.searches()),
        ]);
    }
    table
}

/// The second number as a percentage of the first, both summed over the scores.
fn share<'a>(scores: impl Iterator<Item = &'a Score>, of: fn(&Score) -> (usize, usize)) -> String {
    let (all, part) = scores.map(of).fold((0, 0), |sum, pair| (sum.0 + pair.0, sum.1 + pair.1));
    format!("{:.1} %", 100.0 * part as f64 / all as f64)
}

fn errors(results: &Results) -> Table {
    let caption = "Errors on the held-out floors, mm, with 95 % intervals; share of the places that lie more than 50 mm higher or lower than \
                   the ground under the body and are known as such one step ahead, and of the others that are taken for such";
    let head = ["sensors", "mean", "holes", "stairs", "uneven", "hazards found", "false alarms"];
    let mut table = Table::new("errors", caption, &head);
    for result in results.shown() {
        let mut row = vec![result.method.name(), interval(&result.errors())];
        row.extend(Floor::ALL.map(|floor| interval(&result.errors_on(floor))));
        row.push(share(result.scores.iter().flatten(), |score| score.hazards));
        row.push(share(result.scores.iter().flatten(), |score| score.safe));
        table.row(row);
    }
    table
}

fn conditions(results: &Results, held_out: &[Case]) -> Table {
    let mut head = vec!["sensors", SEARCHED.name];
    head.extend(OTHERS.iter().map(|condition| condition.name));
    let mut table =
        Table::new("conditions", "The same settings under other conditions, errors on the held-out floors, mm", &head);
    for result in results.shown() {
        let mut row = vec![result.method.name(), interval(&result.errors())];
        let errors = |condition| result.judge(held_out, condition).iter().map(mean).collect::<Vec<f64>>();
        row.extend(OTHERS.iter().map(|condition| interval(&errors(condition))));
        table.row(row);
    }
    table
}

/// All settings, from which others may compute the errors again.
fn exact_settings(results: &Results) -> Table {
    let caption = "Setting of each placement: for each sensor the distance below the upper end of its place, m, and the angle, degrees; radius, m";
    let mut table = Table::new("floors-settings", caption, &["sensors", "training error, mm", "setting"]);
    for result in &results.all {
        let error = result.tuned.as_ref().map_or(String::new(), |tuned| format!("{:.3}", training_error(tuned)));
        let values: Vec<String> = result.setting().iter().map(f64::to_string).collect();
        table.row([result.method.name(), error, values.join(" ")]);
    }
    table
}

/// All errors.
fn raw(results: &Results, seeds: &[u64]) -> Table {
    let names: Vec<String> = results.all.iter().map(|result| result.method.name()).collect();
    let mut head = vec!["seed", "floor"];
    head.extend(names.iter().map(String::as_str));
    let mut table = Table::new("floors", "Error on each held-out floor, mm", &head);
    for (index, seed) in seeds.iter().enumerate() {
        for floor in Floor::ALL {
            let mut row = start_of_row(*seed, floor);
            row.extend(results.all.iter().map(|result| exact(&result.scores[index][floor as usize])));
            table.row(row);
        }
    }
    table
}

/// Figure of the floors, the legs, and the heights that are known one step ahead.
fn walks(results: &Results, case: &Case) -> Figure {
    /// Height of a panel, and the drawn part of the way, m.
    const PANEL: f64 = 2.0;
    const DRAWN: [f64; 2] = [-0.4, 6.8];
    const KNOWN: &str = "#009e73";
    let best = &results.all[results.best[2]];
    let (sensors, radius) = (best.method.sensors(best.setting()), best.setting().last().copied().unwrap_or_default());
    let title = "Floors of one seed: legs every half gait cycle; points of the profile (red); height known one step ahead (green)";
    let mut canvas = Canvas::new(DRAWN, [-2.0 * PANEL - 0.4, 1.5], title);
    for (panel, course) in case.iter().enumerate() {
        let shift = DVec2::new(0.0, -PANEL * panel as f64);
        canvas.text(DVec2::new(0.0, 1.3) + shift, course.floor.name());
        for legs in &course.legs {
            for (points, colour) in legs.iter().zip([FAR_LEG, NEAR_LEG]) {
                let line: Vec<DVec2> = points.iter().map(|point| course.ahead(*point) + shift).collect();
                if line.iter().all(|point| point.x < DRAWN[1]) {
                    canvas.path(&line, colour, 1.2);
                }
            }
        }
        let steps = ((DRAWN[1] - DRAWN[0]) / 0.01) as usize;
        let floor = (0..=steps).map(|index| DRAWN[0] + 0.01 * index as f64);
        let floor: Vec<DVec2> = floor.map(|x| DVec2::new(x, course.height(x, 0.0)) + shift).collect();
        canvas.path(&floor, "#333333", 1.2);
        let points = points(course, &sensors, &SEARCHED);
        for (x, height) in known(course, &points, radius, SEARCHED.lead).take_while(|(x, _)| *x < DRAWN[1]) {
            let Some(height) = height else { continue };
            let end = |side: f64| DVec2::new(x + 0.4 * side * JUDGED.2, height) + shift;
            canvas.path(&[end(-1.0), end(1.0)], KNOWN, 4.0);
        }
        for point in points.iter().filter(|point| point.x < DRAWN[1]) {
            canvas.dot(DVec2::new(point.x, point.z) + shift, RAY, 1.2);
        }
    }
    Figure {
        name: "floors-walks".to_owned(),
        label: "Floors and profiles".to_owned(),
        caption: format!("First held-out seed, sensors: {}.", best.method.words(best.setting())),
        claim: "Error on these three floors".to_owned(),
        number: best.scores[0].map(|score| format!("{:.0} mm", 1e3 * score.rms)).join(", "),
        picture: Picture::Svg(canvas.finish()),
    }
}

fn chart(name: &str, title: &str, x_label: &str, series: Vec<Series>) -> Chart {
    Chart {
        name: name.to_owned(),
        title: title.to_owned(),
        x_label: x_label.to_owned(),
        y_label: "height error one step ahead, mm".to_owned(),
        x_scale: Scale::Linear,
        y_scale: Scale::Linear,
        series,
    }
}

fn number_chart(results: &Results) -> anyhow::Result<Figure> {
    let error = |index: usize| Interval::of(&results.all[index].errors()).mean;
    let curve = |name: &str, indices: [usize; SENSORS + 1]| Series {
        name: name.to_owned(),
        mark: Mark::LineAndDots,
        points: (0..=SENSORS).map(|count| (count as f64, error(indices[count]))).collect(),
    };
    let series = vec![curve("all places", results.best), curve("legs only", results.on_legs)];
    let chart =
        chart("floors-number", "Error of the best placement on the held-out floors", "number of sensors", series);
    Ok(Figure {
        name: chart.name.clone(),
        label: "Number of sensors".to_owned(),
        caption: "The placement of each number is the one with the least error on the training floors.".to_owned(),
        claim: "Mean error with no to three sensors".to_owned(),
        number: results.best.map(|index| format!("{:.0} mm", error(index))).join(", "),
        picture: Picture::chart(&chart)?,
    })
}

fn tilt_chart(all: &[Judged], training: &[Case]) -> anyhow::Result<Figure> {
    let singles: Vec<&Judged> =
        all.iter().filter(|result| result.method.mount_points.len() == 1 && result.method.kind == Kind::Free).collect();
    let tilts: Vec<f64> = (2..=32).map(|step| 5.0 * f64::from(step)).collect();
    let curves = on_two_threads(&singles, |result| {
        let mut setting = result.setting().to_vec();
        let mut error = |tilt: f64| {
            setting[1] = tilt;
            let errors = training.iter().map(|case| mean(&result.method.scores(&setting, case, &SEARCHED)));
            (tilt, errors.sum::<f64>() / training.len() as f64)
        };
        let points = tilts.iter().map(|tilt| error(*tilt)).collect();
        Ok(Series { name: result.method.name(), mark: Mark::Line, points })
    })?;
    let title = "One sensor: error on the training floors by its angle, the rest as searched";
    let chart = chart("floors-tilt", title, "angle from straight down, degrees", curves);
    Ok(Figure {
        name: chart.name.clone(),
        label: "Angle of one sensor".to_owned(),
        caption: "Angle between beam and tibia, thigh or upright body; 90 degrees is straight ahead.".to_owned(),
        claim: "Angles found by the search".to_owned(),
        number: singles
            .iter()
            .map(|result| format!("{} {:.0}", result.method.name(), result.setting()[1]))
            .collect::<Vec<_>>()
            .join(", "),
        picture: Picture::chart(&chart)?,
    })
}
