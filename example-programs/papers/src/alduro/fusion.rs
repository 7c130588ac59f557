//! Sections 3 and 4: height maps from the same sonar readings by an occupancy grid, by TSK systems as printed, and by
//! our TSK system. They are compared by the protocol of `accuracy::comparison`.

use std::collections::HashMap;
use std::hint::black_box;
use std::sync::OnceLock;
use std::time::Instant;

use accuracy::comparison::{Difference, Interval, Parameter, Search, Tuned, Verdict, tune};
use anyhow::Context as _;
use mapping::inverse::{Side, SonarModel};
use mapping::occupancy::OccupancyGrid;
use mapping::tsk::{Activation, Fusion, Order, Partition, Settings, Tsk, activations};

use super::ridge::Equations;
use super::survey::{HEIGHT, SIDE, SonarReading, Survey};

/// Numbers of readings of a terrain.
pub const READINGS: [usize; 2] = [500, 174];
/// Rules of the search for parameters; all methods share them.
pub const SEARCH: Search = Search { cases: 40, few: 8, budget: 3000, first: 5 };
/// Number of training terrains on which processor time is measured.
const TIMED: usize = 3;
/// Minimum measured time, s: the kernel's clock of a thread's processor time advances in steps of some milliseconds.
const MIN_DURATION_S: f64 = 0.1;
/// Factors on the number of cells along a side. The chart shows error and time at each factor.
const FINENESS: [f64; 5] = [0.25, 0.5, 0.71, 1.0, 1.41];

/// Projection of the grid's boxes to heights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Projection {
    /// The highest occupied box, as in the paper.
    Highest,
    /// The most certainly occupied box.
    Likeliest,
    /// The mean of the occupied boxes.
    Mean,
}

/// A mapping method. Every method has the parameters cut (the minimum membership that counts) and cells; these two
/// follow the method's own parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Occupancy grid of cubes. Parameter: band.
    Grid(Projection),
    /// TSK by Eq. 3. Parameter: ridge.
    Printed(Order),
    /// TSK by Eq. 3, with the ridge of maximum evidence.
    Evidence(Order),
    /// TSK with an equation for each cell (our choice). Parameters: weight of equations that raise a height, error of a
    /// reading.
    Cells(Order),
}

/// The part of a terrain that is mapped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The whole terrain.
    Whole,
    /// The square at the start with half the side. It suffices to choose parameters, at a quarter of the cost.
    Quarter,
}

impl Part {
    /// Side of the square, m.
    fn side(self) -> f64 {
        match self {
            Self::Whole => SIDE,
            Self::Quarter => SIDE / 2.0,
        }
    }
}

/// A method that fuses readings.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// Name in tables.
    pub name: &'static str,
    kind: Kind,
}

/// The methods, in the order of the tables.
pub const METHODS: [Method; 9] = [
    Method { name: "grid, highest box", kind: Kind::Grid(Projection::Highest) },
    Method { name: "grid, likeliest box", kind: Kind::Grid(Projection::Likeliest) },
    Method { name: "grid, mean of boxes", kind: Kind::Grid(Projection::Mean) },
    Method { name: "TSK constants, Eq. 3, ridge tuned", kind: Kind::Printed(Order::Zero) },
    Method { name: "TSK planes, Eq. 3, ridge tuned", kind: Kind::Printed(Order::One) },
    Method { name: "TSK constants, Eq. 3, ridge by evidence", kind: Kind::Evidence(Order::Zero) },
    Method { name: "TSK planes, Eq. 3, ridge by evidence", kind: Kind::Evidence(Order::One) },
    Method { name: "our cells, constants", kind: Kind::Cells(Order::Zero) },
    Method { name: "our cells, planes", kind: Kind::Cells(Order::One) },
];
/// Groups of methods; one thread computes each group.
pub const GROUPS: [std::ops::Range<usize>; 4] = [0..3, 3..5, 5..7, 7..9];
/// Indices of the occupancy grids in [`METHODS`].
pub const GRIDS: [usize; 3] = [0, 1, 2];
/// Indices of TSK as printed with a tuned ridge, with constants and with planes.
pub const PRINTED: [usize; 2] = [3, 4];
/// Indices of our TSK system, with constants and with planes.
pub const OURS: [usize; 2] = [7, 8];

/// A step doubles the number of cells and multiplies the number of boxes by 2.8, so it must gain more than a step of
/// another parameter.
const CELLS: Parameter =
    Parameter { name: "cells", start: 20.0, ratio: std::f64::consts::SQRT_2, most: f64::INFINITY, gain: 0.05 };
const CUT: Parameter = Parameter { name: "cut", start: 0.05, ratio: 2.0, most: 1.0, gain: 0.01 };
const BAND: Parameter = Parameter { name: "band", start: 0.03, ratio: 2.0, most: 1.0, gain: 0.01 };
const RIDGE: Parameter = Parameter { name: "ridge", start: 1.0, ratio: 4.0, most: f64::INFINITY, gain: 0.01 };
const ABOVE: Parameter = Parameter { name: "raise", start: 0.1, ratio: 2.0, most: 1.0, gain: 0.01 };
const SIGMA: Parameter = Parameter { name: "sigma, m", start: 0.1, ratio: 2.0, most: f64::INFINITY, gain: 0.01 };

impl Method {
    /// The free parameters of the method.
    pub fn parameters(&self) -> &'static [Parameter] {
        match self.kind {
            Kind::Grid(_) => &[BAND, CUT, CELLS],
            Kind::Printed(_) => &[RIDGE, CUT, CELLS],
            Kind::Evidence(_) => &[CUT, CELLS],
            Kind::Cells(_) => &[ABOVE, SIGMA, CUT, CELLS],
        }
    }

    /// The map that the method makes of readings with a setting of its parameters; `None` if rounding leaves no
    /// solution.
    pub fn map(&self, setting: &[f64], readings: &[SonarReading], part: Part) -> Option<Surface> {
        let [own @ .., least, cells] = setting else { return None };
        let count = cells.round().max(1.0) as usize;
        let cell = SIDE / count as f64;
        let side = (part.side() / cell).ceil() as usize;
        let partition = Partition { cell, columns: side, rows: side, low: (0, 0) };
        let rules = side * side;
        let model = SonarModel { min_membership: *least, ..SonarModel::srf08() };
        match self.kind {
            Kind::Grid(projection) => {
                let model = SonarModel { epsilon: own[0], ..model };
                let layers = (HEIGHT / cell).ceil() as usize;
                let mut grid = OccupancyGrid::new(partition, 0.0, cell, layers);
                readings.iter().for_each(|(sonar, distance)| {
                    grid.fuse(&model, sonar, *distance);
                });
                Some(Surface::Grid(grid, projection))
            }
            Kind::Printed(order) | Kind::Evidence(order) => {
                let ridge = own.first().map_or(Ridge::Likeliest, |ridge| Ridge::Given(*ridge));
                let parameters = match order {
                    Order::Zero => ridge.solve(&printed::<1>(&partition, &model, readings), rules),
                    Order::One => ridge.solve(&printed::<3>(&partition, &model, readings), rules),
                };
                Some(Surface::Rules { partition, order, parameters: parameters? })
            }
            Kind::Cells(order) => {
                let fusion = Fusion::Cells { above: own[0] };
                let settings = Settings { order, fusion, reading_sigma: own[1], floor: 0.0, ..Settings::default() };
                let mut tsk = Tsk::new(partition, settings);
                readings.iter().for_each(|(sonar, distance)| {
                    tsk.fuse(&model, sonar, *distance);
                });
                Some(Surface::Tsk(tsk))
            }
        }
    }

    /// Error of the method's map of a part of a survey, m. If there is no map (for example because the evidence has no
    /// maximum), the ground counts as unmeasured.
    ///
    /// # Errors
    /// If there are too few readings.
    pub fn error(&self, setting: &[f64], survey: &Survey, readings: usize, part: Part) -> anyhow::Result<f64> {
        let map = self.map(setting, &survey.readings(readings)?, part);
        Ok(survey.rms(part.side(), |x, y| map.as_ref().map_or(0.0, |map| map.height(x, y))))
    }

    /// Errors of a quarter by each projection of a grid, m; NaN without a map.
    fn projected(&self, setting: &[f64], survey: &Survey, readings: usize) -> [f64; 3] {
        let selection = survey.readings(readings).unwrap_or_default();
        let surface = if selection.is_empty() { None } else { self.map(setting, &selection, Part::Quarter) };
        let Some(Surface::Grid(grid, _)) = surface else { return [f64::NAN; 3] };
        let mut surface = Surface::Grid(grid, Projection::Highest);
        [Projection::Highest, Projection::Likeliest, Projection::Mean].map(|projection| {
            if let Surface::Grid(_, own) = &mut surface {
                *own = projection;
            }
            survey.rms(Part::Quarter.side(), |x, y| surface.height(x, y))
        })
    }

    /// The setting as text.
    pub fn words(&self, setting: &[f64]) -> String {
        let cells = setting.last().map_or(0.0, |cells| cells.round());
        let word = |(parameter, value): (&Parameter, &f64)| match parameter.name.split_once(", ") {
            Some((name, unit)) => format!("{name} {} {unit}", significant(*value)),
            None => format!("{} {}", parameter.name, significant(*value)),
        };
        let others = self.parameters().iter().zip(setting).take(setting.len() - 1).map(word).collect::<Vec<_>>();
        format!("{cells} x {cells}, {}", others.join(", "))
    }
}

/// A number with three significant digits.
fn significant(value: f64) -> String {
    let digits = (2 - value.abs().log10().floor() as i32).max(0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Eq. 3 gives one equation for each reading. A reading activates rules at the point (x_k, y_k, z_k). The average of
/// their outputs, weighted by the activations, equals the height of this point.
///
/// The point has the membership 1: it lies ahead of the sonar at the reading's distance. The sum is divided by the sum
/// of the weights, since the text says average; the printed equation omits the division. Planes are relative to the
/// centre of their cell, in m, so the ridge has the same meaning everywhere.
fn printed<const N: usize>(partition: &Partition, model: &SonarModel, readings: &[SonarReading]) -> Equations<N> {
    let mut equations = Equations::default();
    for (sonar, distance) in readings {
        let rules = activations(partition, model, sonar, *distance, Side::MostPossible);
        let total: f64 = rules.iter().map(|rule| rule.weight).sum();
        if total <= 0.0 {
            continue;
        }
        let point = sonar.ahead(*distance);
        let term = |rule: &Activation| {
            let (x, y) = partition.centre(rule.cell_index);
            let (fraction, factors) = (rule.weight / total, [1.0, point.x - x, point.y - y]);
            (rule.slot, std::array::from_fn(|index| fraction * factors[index]))
        };
        equations.terms.push(rules.iter().map(term).collect());
        equations.values.push(point.z.max(0.0));
    }
    equations
}

/// Ridge of Eq. 3.
enum Ridge {
    Given(f64),
    /// The ridge of maximum evidence.
    Likeliest,
}

impl Ridge {
    fn solve<const N: usize>(&self, equations: &Equations<N>, rules: usize) -> Option<Vec<f64>> {
        let ridge = match self {
            Self::Given(ridge) => *ridge,
            Self::Likeliest => equations.likeliest_ridge(rules)?,
        };
        equations.solve(rules, ridge)
    }
}

/// Map of heights by a method.
pub enum Surface {
    /// Occupancy grid.
    Grid(OccupancyGrid, Projection),
    /// Outputs of rules.
    Rules {
        /// The cells.
        partition: Partition,
        /// Output function.
        order: Order,
        /// Parameters of the rules; those of one slot are adjacent.
        parameters: Vec<f64>,
    },
    /// Surface by recursive least squares.
    Tsk(Tsk),
}

impl Surface {
    /// Height at (x, y), m. All methods take unmeasured places as ground at 0 and limit heights to the range from 0 to
    /// the sonars.
    pub fn height(&self, x: f64, y: f64) -> f64 {
        let height = match self {
            Self::Grid(grid, Projection::Highest) => grid.height(x, y),
            Self::Grid(grid, Projection::Likeliest) => grid.likeliest_height(x, y),
            Self::Grid(grid, Projection::Mean) => grid.mean_height(x, y),
            Self::Rules { partition, order, parameters } => {
                let cell_index = partition.cell_index(x, y);
                partition.slot(cell_index).map(|slot| {
                    let own = &parameters[slot * order.parameters()..][..order.parameters()];
                    let (middle_x, middle_y) = partition.centre(cell_index);
                    own.iter()
                        .zip([1.0, x - middle_x, y - middle_y])
                        .map(|(parameter, factor)| parameter * factor)
                        .sum()
                })
            }
            Self::Tsk(tsk) => tsk.height(x, y),
        };
        height.unwrap_or(0.0).clamp(0.0, HEIGHT)
    }
}

/// Errors of the three projections of a grid, by setting (its bits) and training terrain. Methods that use the same map
/// share its computation.
pub type Known = HashMap<(Vec<u64>, usize), [f64; 3]>;

/// Searches the optimal parameters of a method on the training terrains.
///
/// # Errors
/// If a search does not enclose the optimum, or there are too few readings.
pub fn tuned(method: &Method, training: &[Survey], readings: usize, known: &mut Known) -> anyhow::Result<Tuned> {
    let search = Search { cases: training.len(), few: SEARCH.few.min(training.len()), ..SEARCH };
    // Every search begins with the first case, which detects too few readings.
    let error = |setting: &[f64], case: usize| {
        let survey = &training[case];
        let Kind::Grid(projection) = method.kind else {
            return method.error(setting, survey, readings, Part::Quarter).unwrap_or(f64::NAN);
        };
        let key = (setting.iter().map(|value| value.to_bits()).collect(), case);
        known.entry(key).or_insert_with(|| method.projected(setting, survey, readings))[projection as usize]
    };
    tune(method.parameters(), search, error).with_context(|| format!("{}, {readings} readings", method.name))
}

/// Errors of a method on terrains, m.
///
/// # Errors
/// If there are too few readings.
pub fn errors(method: &Method, setting: &[f64], surveys: &[Survey], readings: usize) -> anyhow::Result<Vec<f64>> {
    surveys.iter().map(|survey| method.error(setting, survey, readings, Part::Whole)).collect()
}

/// Processor time per reading (s) and mean error (m) of a method on training terrains, with partitions coarser and
/// finer than its best one.
///
/// # Errors
/// If there are too few readings.
pub fn work(method: &Method, setting: &[f64], training: &[Survey], readings: usize) -> anyhow::Result<Vec<(f64, f64)>> {
    let training = &training[..training.len().min(TIMED)];
    let point = |fineness: &f64| {
        let mut setting = setting.to_vec();
        setting.iter_mut().rev().take(1).for_each(|cells| *cells = (*cells * fineness).max(1.0));
        let error = Interval::of(&errors(method, &setting, training, readings)?).mean;
        let time = |survey: &Survey| -> anyhow::Result<f64> {
            let selection = survey.readings(readings)?;
            let (begin, mut maps, mut taken_s) = (processor_time(), 0.0, 0.0);
            while taken_s < MIN_DURATION_S {
                black_box(method.map(&setting, &selection, Part::Whole));
                maps += 1.0;
                taken_s = processor_time() - begin;
            }
            Ok(taken_s / maps / readings as f64)
        };
        // The minimum over all terrains: other programs on the machine only lengthen a time.
        let times = training.iter().map(time).collect::<anyhow::Result<Vec<f64>>>()?;
        Ok((times.into_iter().fold(f64::INFINITY, f64::min), error))
    };
    FINENESS.iter().map(point).collect()
}

/// Processor time of this thread, s, from an arbitrary start. Linux does not count the time of other programs;
/// elsewhere this is wall-clock time.
fn processor_time() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    let account = std::fs::read_to_string("/proc/thread-self/schedstat").unwrap_or_default();
    let nanoseconds: Option<f64> = account.split(' ').next().and_then(|word| word.parse().ok());
    nanoseconds.map_or_else(|| START.get_or_init(Instant::now).elapsed().as_secs_f64(), |time| 1e-9 * time)
}

/// A mean with its interval, in cm.
pub fn centimetres(interval: &Interval) -> String {
    let Interval { mean, low, high, .. } = interval;
    format!("{:.1} ({:.1} to {:.1})", 100.0 * mean, 100.0 * low, 100.0 * high)
}

/// A difference in words: which method is closer, by the decision rule.
pub fn closer(difference: &Difference) -> &'static str {
    match difference.verdict() {
        Verdict::First => "first",
        Verdict::Second => "second",
        Verdict::Open => "open",
    }
}
