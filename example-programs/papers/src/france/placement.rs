//! The search for number and place of the sensors: exchange of sensors over a grid of mounts.
//!
//! The exchange algorithm of optimal design (Fedorov 1972): one sensor is added where the mean error over the training floors is least, then each
//! sensor in turn is moved to any other mount of the grid, as long as this lowers the error.

use accuracy::comparison::{Parameter, Search, tune};
use anyhow::{Context as _, ensure};
use glam::DVec2;

use super::crossing::{Crossing, Mount, Part, RIGHT, Step};
use super::profile;

/// Maximum number of evaluations of each method; one evaluation is one floor with one setting.
pub const BUDGET: usize = 2_000_000;
/// A change is an improvement if it lowers the mean error by more than this share.
const GAIN: f64 = 0.002;
/// Number of floors after which a setting is dropped if it is clearly worse, by two standard errors: two of each kind.
const FIRST: usize = 10;
/// Places along a part, as fractions.
const PLACES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// Step of elevations, degrees; the grid is the full circle, so it has no edge.
const TURN: f64 = 7.5;
/// Width of a cell of the profile from which its search begins, m, and the factor of a step.
const CELL: f64 = 0.04;
const CELL_RATIO: f64 = std::f64::consts::SQRT_2;

/// Points that each step of a walk knows from a sensor.
pub type Sightings = Vec<Vec<DVec2>>;

/// All elevations, degrees.
pub fn elevations() -> impl Iterator<Item = f64> {
    (0..(360.0 / TURN) as usize).map(|index| -180.0 + TURN * index as f64)
}

/// Where sensors may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Where {
    /// Thigh, shank and foot of both legs.
    Legs,
    /// The body above the hips.
    Body,
}

/// All mounts of the grid.
pub fn mounts(on: Where) -> Vec<Mount> {
    let parts: Vec<Part> = match on {
        Where::Legs => {
            [0, RIGHT].into_iter().flat_map(|leg| [Part::Thigh(leg), Part::Shank(leg), Part::Foot(leg)]).collect()
        }
        Where::Body => vec![Part::Body],
    };
    let places = parts.into_iter().flat_map(|part| PLACES.map(|place| (part, place)));
    places.flat_map(|(part, place)| elevations().map(move |elevation| Mount { part, place, elevation })).collect()
}

/// The paper's place, as in our walks through the dining room: on the right tibia.
pub fn of_the_paper() -> Mount {
    Mount { part: Part::Shank(RIGHT), place: 98.0 / 430.0, elevation: -5.0 }
}

/// `number` sensors at equal distances along the right shank, all with the same elevation.
pub fn evenly(number: usize, elevation: f64) -> Vec<Mount> {
    let place = |index: usize| (index as f64 + 0.5) / number as f64;
    (0..number).map(|index| Mount { part: Part::Shank(RIGHT), place: place(index), elevation }).collect()
}

/// A training floor: the steps of the walk over it, and the points of all mounts.
pub struct Training {
    /// The steps.
    pub steps: Vec<Step>,
    /// Points of each mount, in the order of the list of mounts.
    pub seen: Vec<Sightings>,
}

impl Training {
    /// What all `mounts` see on a walk.
    pub fn of(crossing: Crossing, mounts: &[Mount]) -> Self {
        let see = |mount: &Mount| crossing.sightings(&crossing.readings(mount), f64::INFINITY);
        let seen = mounts.iter().map(see).collect();
        Self { seen, steps: crossing.steps }
    }

    /// Mean error over the steps with sensors, given by their indices, m.
    fn error(&self, set: &[usize], cell: f64) -> f64 {
        let seen: Vec<&Sightings> = set.iter().map(|mount| &self.seen[*mount]).collect();
        error(&self.steps, &seen, cell)
    }
}

/// Mean over the steps of a walk of the error of the profile from these sensors, m.
pub fn error(steps: &[Step], sensors: &[&Sightings], cell: f64) -> f64 {
    let of = |(index, step): (usize, &Step)| {
        profile::error(step, sensors.iter().flat_map(|seen: &&Sightings| &seen[index]), cell)
    };
    steps.iter().enumerate().map(of).sum::<f64>() / steps.len() as f64
}

/// A method with its parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// Name in tables.
    pub name: String,
    /// The sensors.
    pub mounts: Vec<Mount>,
    /// Width of a cell of the profile, m.
    pub cell: f64,
    /// Mean error on the training floors, m.
    pub training: f64,
    /// Number of evaluations.
    pub evaluations: usize,
}

impl Placement {
    /// Mean error over the steps of a walk, m.
    pub fn error(&self, crossing: &Crossing) -> f64 {
        let seen: Vec<Sightings> =
            self.mounts.iter().map(|mount| crossing.sightings(&crossing.readings(mount), f64::INFINITY)).collect();
        error(&crossing.steps, &seen.iter().collect::<Vec<_>>(), self.cell)
    }
}

/// A search over the training floors.
pub struct Trial<'a> {
    floors: &'a [Training],
    evaluations: usize,
}

impl<'a> Trial<'a> {
    /// A search with its own budget.
    pub fn new(floors: &'a [Training]) -> Self {
        Self { floors, evaluations: 0 }
    }

    fn evaluate(&mut self, case: usize, set: &[usize], cell: f64) -> anyhow::Result<f64> {
        ensure!(self.evaluations < BUDGET, "{BUDGET} evaluations did not enclose the optimum");
        self.evaluations += 1;
        Ok(self.floors[case].error(set, cell))
    }

    /// Errors of a set of sensors on all floors.
    fn errors(&mut self, set: &[usize], cell: f64) -> anyhow::Result<Vec<f64>> {
        (0..self.floors.len()).map(|case| self.evaluate(case, set, cell)).collect()
    }

    /// Errors of a set of sensors, if their mean is less than that of `best` by more than [`GAIN`]. Stops when it clearly is not.
    fn better(&mut self, set: &[usize], best: &[f64], cell: f64) -> anyhow::Result<Option<Vec<f64>>> {
        let mut errors = Vec::with_capacity(best.len());
        let (mut sum, mut squares) = (0.0, 0.0);
        for (case, wanted) in best.iter().enumerate() {
            let error = self.evaluate(case, set, cell)?;
            let loss = error - (1.0 - GAIN) * wanted;
            errors.push(error);
            (sum, squares) = (sum + loss, squares + loss * loss);
            let count = errors.len() as f64;
            if errors.len() >= FIRST {
                let variance = ((squares - sum * sum / count) / (count - 1.0) / count).max(0.0);
                if sum / count > 2.0 * variance.sqrt() {
                    return Ok(None);
                }
            }
        }
        Ok((sum < 0.0).then_some(errors))
    }

    /// Adds a sensor to a set of mounts of the `grid`, then exchanges sensors until no exchange is an improvement.
    fn exchange(
        &mut self,
        set: &mut Vec<usize>,
        is_added: bool,
        grid: &[usize],
        cell: f64,
    ) -> anyhow::Result<Vec<f64>> {
        let mut best = self.errors(set, cell)?;
        if is_added {
            let mut chosen = None;
            for mount in grid {
                let trial = [set.as_slice(), &[*mount]].concat();
                if let Some(errors) = self.better(&trial, &best, cell)? {
                    (best, chosen) = (errors, Some(trial));
                }
            }
            // A sensor that lowers the error by too little still has its best place.
            if chosen.is_none() {
                best.fill(f64::INFINITY);
                for mount in grid {
                    let trial = [set.as_slice(), &[*mount]].concat();
                    let errors = self.errors(&trial, cell)?;
                    if mean(&errors) < mean(&best) {
                        (best, chosen) = (errors, Some(trial));
                    }
                }
            }
            *set = chosen.context("no mounts")?;
        }
        let (mut slot, mut unchanged) = (0, 0);
        while unchanged < set.len() {
            let mut is_changed = false;
            for mount in grid {
                let mut trial = set.clone();
                trial[slot] = *mount;
                if let Some(errors) = self.better(&trial, &best, cell)? {
                    (best, *set, is_changed) = (errors, trial, true);
                }
            }
            unchanged = if is_changed { 1 } else { unchanged + 1 };
            slot = (slot + 1) % set.len();
        }
        Ok(best)
    }

    /// The width of a cell with the least error.
    fn tuned_cell(&mut self, set: &[usize]) -> anyhow::Result<(f64, Vec<f64>)> {
        let cases = self.floors.len();
        let search = Search { cases, few: cases.min(20), budget: BUDGET - self.evaluations, first: FIRST };
        let floors = self.floors;
        let tuned = tune(&[cell_parameter()], search, |setting, case| floors[case].error(set, setting[0]))?;
        self.evaluations += tuned.evaluations;
        Ok((tuned.setting[0], tuned.errors))
    }

    /// The best set with one sensor more than `fewer`, from mounts of the `grid`, and its width of a cell: exchange and width in turn until
    /// neither changes.
    ///
    /// # Errors
    /// A budget that does not suffice.
    pub fn best(mut self, fewer: &[usize], grid: &[usize]) -> anyhow::Result<(Vec<usize>, f64, f64, usize)> {
        let (mut set, mut cell) = (fewer.to_vec(), CELL);
        self.exchange(&mut set, true, grid, cell)?;
        loop {
            let (tuned, errors) = self.tuned_cell(&set)?;
            let old = set.clone();
            let errors = if tuned == cell { errors } else { self.exchange(&mut set, false, grid, tuned)? };
            cell = tuned;
            if set == old {
                return Ok((set, cell, mean(&errors), self.evaluations));
            }
        }
    }

    /// A fixed set with its best width of a cell.
    ///
    /// # Errors
    /// A budget that does not suffice.
    pub fn fixed(mut self, set: &[usize]) -> anyhow::Result<(f64, f64, usize)> {
        let (cell, errors) = self.tuned_cell(set)?;
        Ok((cell, mean(&errors), self.evaluations))
    }

    /// The best of several sets with its width of a cell: sets and width in turn until neither changes.
    ///
    /// # Errors
    /// A budget that does not suffice; no sets.
    pub fn best_of(mut self, sets: &[Vec<usize>]) -> anyhow::Result<(usize, f64, f64, usize)> {
        let (mut chosen, mut cell) = (None, CELL);
        loop {
            let mut best: Option<(usize, Vec<f64>)> = None;
            for (index, set) in sets.iter().enumerate() {
                match &best {
                    None => best = Some((index, self.errors(set, cell)?)),
                    Some((_, errors)) => {
                        let errors = errors.clone();
                        best = self.better(set, &errors, cell)?.map(|errors| (index, errors)).or(best);
                    }
                }
            }
            let (index, _) = best.context("no sets")?;
            let (tuned, errors) = self.tuned_cell(&sets[index])?;
            if chosen == Some(index) && tuned == cell {
                return Ok((index, cell, mean(&errors), self.evaluations));
            }
            (chosen, cell) = (Some(index), tuned);
        }
    }
}

/// The mean.
pub fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn cell_parameter() -> Parameter {
    Parameter { name: "cell, m", start: CELL, ratio: CELL_RATIO, most: f64::INFINITY, gain: GAIN }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three floors with one step each, of which only mount 2 sees the ground.
    fn floors() -> Vec<Training> {
        let floor = |level: f64| {
            let xs: Vec<f64> = (0..=35).map(|index| 1.0 + 0.02 * f64::from(index)).collect();
            let points: Vec<DVec2> = xs.iter().map(|x| DVec2::new(*x, level)).collect();
            let blind = vec![Vec::new()];
            let step = Step {
                at: 1.0,
                truth: vec![level; xs.len()],
                xs,
                stand: [0.75, 0.95],
                stand_height: 0.0,
                foothold: 1.5,
                shift: 0.0,
            };
            let half = vec![points.iter().copied().filter(|point| point.x < 1.3).collect()];
            Training { steps: vec![step], seen: vec![blind.clone(), half, vec![points], blind] }
        };
        [0.1, -0.1, 0.2].map(floor).into_iter().collect()
    }

    #[test]
    fn the_exchange_finds_the_sensor_that_sees() {
        let floors = floors();
        let (set, _, error, evaluations) = Trial::new(&floors).best(&[], &[0, 1, 2, 3]).expect("an optimum");
        assert_eq!(set, [2]);
        assert!(error < 0.02 && evaluations > 12, "{error} {evaluations}");
        let (_, blind, _) = Trial::new(&floors).fixed(&[0]).expect("an optimum");
        assert!((blind - 0.4 / 3.0).abs() < 1e-9, "{blind}");
        let sets = [vec![0], vec![1], vec![2], vec![3]];
        assert_eq!(Trial::new(&floors).best_of(&sets).expect("an optimum").0, 2);
    }

    #[test]
    fn the_grid_has_no_edge_in_elevation() {
        let all = mounts(Where::Legs);
        assert_eq!(all.len(), 6 * PLACES.len() * 48);
        assert_eq!(mounts(Where::Body).len(), PLACES.len() * 48);
        assert_eq!(elevations().last().map(|last| last + TURN), Some(180.0));
    }
}
