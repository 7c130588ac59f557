//! Metrics of a swarm over time.

use glam::DVec2;

use super::region::ROUNDING;
use super::watch::{Coverage, Surroundings};
use super::{CELL, Finding};
use crate::RobotId;
use crate::math;
use crate::spec::{BodyRef, SwarmMetric};
use crate::time::Time;

/// Minimum speed, m/s, at which a robot's direction counts.
const MIN_MOVING_SPEED: f64 = 1e-6;

/// A metric of a group of robots at the end of each cell, with the demands on it.
#[derive(Clone, Debug)]
pub(super) struct Swarm {
    pub robots: Vec<RobotId>,
    pub of: SwarmMetric,
    pub min: Option<f64>,
    pub max: Option<f64>,
    /// Instant before which the demands do not count.
    pub since: Time,
    pub at_end: bool,
    /// Squares that a tool has covered; only for the metric coverage.
    pub coverage: Option<Coverage>,
    pub violated: Option<f64>,
    /// Instants at which the value changed, with the new values.
    pub series: Vec<[f64; 2]>,
}

impl Swarm {
    /// Evaluates the cells from `from` to `until`, s; in more than one cell all bodies are at rest.
    pub fn take(&mut self, surroundings: &Surroundings<'_>, (from, until): (Time, Time)) {
        if let Some(coverage) = &mut self.coverage {
            coverage.take(surroundings);
        }
        let Some(value) = self.value(surroundings) else { return };
        if self.series.last().is_none_or(|[_, last]| *last != value) {
            self.series.push([(from + CELL).min(until).seconds(), value]);
        }
        if !self.at_end && until >= self.since && self.violated.is_none() && !self.is_met(value) {
            let first = (from + CELL).max(Time((self.since.0 + CELL.0 - 1) / CELL.0 * CELL.0));
            self.violated = Some(first.min(until).seconds());
        }
    }

    fn is_met(&self, value: f64) -> bool {
        self.min.is_none_or(|min| value >= min - ROUNDING) && self.max.is_none_or(|max| value <= max + ROUNDING)
    }

    /// The metric at the end of the cell; `None` without robots, and for the order if no robot moves.
    fn value(&self, surroundings: &Surroundings<'_>) -> Option<f64> {
        let last = |id: &RobotId| surroundings.sections(BodyRef::Robot(*id)).last();
        let sections = || self.robots.iter().filter_map(last);
        let positions: Vec<DVec2> = sections().map(|section| section.position(section.to)).collect();
        if positions.is_empty() {
            return None;
        }
        let count = positions.len() as f64;
        match &self.of {
            SwarmMetric::Spread => {
                let middle = positions.iter().sum::<DVec2>() / count;
                Some(
                    positions.iter().map(|point| math::hypot(point.x - middle.x, point.y - middle.y)).sum::<f64>()
                        / count,
                )
            }
            SwarmMetric::Order => {
                let velocities = sections().map(|section| section.velocity(section.to));
                let directions: Vec<DVec2> = velocities
                    .filter_map(|velocity| {
                        let speed = math::hypot(velocity.x, velocity.y);
                        (speed >= MIN_MOVING_SPEED).then(|| velocity / speed)
                    })
                    .collect();
                let sum = directions.iter().sum::<DVec2>();
                (!directions.is_empty()).then(|| math::hypot(sum.x, sum.y) / directions.len() as f64)
            }
            SwarmMetric::Groups { reach } => Some(groups(&positions, *reach) as f64),
            SwarmMetric::Coverage { .. } => self.coverage.as_ref().and_then(|coverage| coverage.finding().value),
        }
    }

    pub fn finding(&self) -> Finding {
        let last = self.series.last().map(|[_, value]| *value);
        let violated = match (self.at_end, last) {
            (true, Some(value)) if !self.is_met(value) => self.series.last().map(|[at, _]| *at),
            (true, _) => None,
            (false, _) => self.violated,
        };
        Finding { is_met: last.is_some() && violated.is_none(), at: violated, position: None, value: last }
    }
}

/// Number of groups of points that are connected by steps of at most `reach`.
fn groups(points: &[DVec2], reach: f64) -> usize {
    let mut group: Vec<usize> = (0..points.len()).collect();
    fn root(group: &mut [usize], mut of: usize) -> usize {
        while group[of] != of {
            group[of] = group[group[of]];
            of = group[of];
        }
        of
    }
    let mut count = points.len();
    for (index, point) in points.iter().enumerate() {
        for (other, other_point) in points[..index].iter().enumerate() {
            if math::hypot(other_point.x - point.x, other_point.y - point.y) <= reach + ROUNDING {
                let (one, two) = (root(&mut group, index), root(&mut group, other));
                if one != two {
                    group[one.max(two)] = one.min(two);
                    count -= 1;
                }
            }
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_are_connected_by_short_steps() {
        let line: Vec<DVec2> = (0..6).map(|x| DVec2::new(f64::from(x), 0.0)).collect();
        assert_eq!(groups(&line, 1.0), 1);
        assert_eq!(groups(&line, 0.9), 6);
        let pairs = [0.0, 5.0, 0.5, 5.5, 20.0].map(|x| DVec2::new(x, 1.0));
        assert_eq!(groups(&pairs, 1.0), 3);
        assert_eq!(groups(&pairs, 4.5), 2);
        assert_eq!(groups(&[], 1.0), 0);
    }
}
