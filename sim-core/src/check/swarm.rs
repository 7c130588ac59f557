//! Condition on a metric of a swarm over time.

use glam::DVec2;

use super::condition::{Coverage, Surroundings};
use super::region::ROUNDING;
use super::{CELL, Finding};
use crate::RobotId;
use crate::math;
use crate::spec::{BodyRef, SwarmMetric};
use crate::time::Time;

/// Minimum speed, m/s, of a robot whose direction is part of the order metric.
const MIN_MOVING_SPEED: f64 = 1e-6;

/// Condition: a metric of a group of robots, computed at the end of each cell, is within limits.
#[derive(Clone, Debug)]
pub(super) struct Swarm {
    pub robots: Vec<RobotId>,
    pub metric: SwarmMetric,
    pub min: Option<f64>,
    pub max: Option<f64>,
    /// Instant from which the limits apply.
    pub since: Time,
    /// True if the limits apply only at the end of the run.
    pub at_end: bool,
    /// Squares that a tool has covered; only for [`SwarmMetric::Coverage`].
    pub coverage: Option<Coverage>,
    /// The value in the last cell; `None` if the metric had no value there.
    pub last: Option<f64>,
    /// Instant of the first violation, s.
    pub violated: Option<f64>,
    /// Pairs: instant at which the value changed (s), new value.
    pub series: Vec<[f64; 2]>,
}

impl Swarm {
    /// Evaluates the cell from `from` to `until`, or several cells in which all bodies are at rest.
    pub fn evaluate(&mut self, surroundings: &Surroundings<'_>, (from, until): (Time, Time)) {
        if let Some(coverage) = &mut self.coverage {
            coverage.evaluate(surroundings);
        }
        self.last = self.value(surroundings);
        let Some(value) = self.last else { return };
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

    /// The metric at the end of the cell; `None` without robots, and for [`SwarmMetric::Order`] if no robot moves.
    fn value(&self, surroundings: &Surroundings<'_>) -> Option<f64> {
        let last_section = |id: &RobotId| surroundings.sections(BodyRef::Robot(*id)).last();
        let sections = || self.robots.iter().filter_map(last_section);
        let positions: Vec<DVec2> = sections().map(|section| section.position(section.to)).collect();
        if positions.is_empty() {
            return None;
        }
        let count = positions.len() as f64;
        match &self.metric {
            SwarmMetric::Spread => {
                let centroid = positions.iter().sum::<DVec2>() / count;
                Some(
                    positions.iter().map(|point| math::hypot(point.x - centroid.x, point.y - centroid.y)).sum::<f64>()
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
            SwarmMetric::Groups { reach } => Some(count_groups(&positions, *reach) as f64),
            SwarmMetric::Coverage { .. } => self.coverage.as_ref().and_then(|coverage| coverage.finding().value),
        }
    }

    pub fn finding(&self) -> Finding {
        let (changed, latest) = self.series.last().map(|[at, value]| (*at, *value)).unzip();
        let value = if self.at_end { self.last } else { latest };
        let violated = match (self.at_end, value) {
            (true, Some(value)) if !self.is_met(value) => changed,
            (true, _) => None,
            (false, _) => self.violated,
        };
        Finding { is_met: value.is_some() && violated.is_none(), at: violated, position: None, value }
    }
}

/// Number of groups of points that are connected by steps of at most `reach`.
fn count_groups(points: &[DVec2], reach: f64) -> usize {
    let mut parent: Vec<usize> = (0..points.len()).collect();
    fn root(parent: &mut [usize], mut index: usize) -> usize {
        while parent[index] != index {
            parent[index] = parent[parent[index]];
            index = parent[index];
        }
        index
    }
    let mut count = points.len();
    for (index, point) in points.iter().enumerate() {
        for (other, other_point) in points[..index].iter().enumerate() {
            if math::hypot(other_point.x - point.x, other_point.y - point.y) <= reach + ROUNDING {
                let (one, two) = (root(&mut parent, index), root(&mut parent, other));
                if one != two {
                    parent[one.max(two)] = one.min(two);
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
        assert_eq!(count_groups(&line, 1.0), 1);
        assert_eq!(count_groups(&line, 0.9), 6);
        let pairs = [0.0, 5.0, 0.5, 5.5, 20.0].map(|x| DVec2::new(x, 1.0));
        assert_eq!(count_groups(&pairs, 1.0), 3);
        assert_eq!(count_groups(&pairs, 4.5), 2);
        assert_eq!(count_groups(&[], 1.0), 0);
    }

    #[test]
    fn only_a_value_at_the_end_counts_at_the_end() {
        let swarm = |at_end, last| Swarm {
            robots: vec![RobotId(1)],
            metric: SwarmMetric::Order,
            min: Some(0.9),
            max: None,
            since: Time::ZERO,
            at_end,
            coverage: None,
            last,
            violated: None,
            series: vec![[0.1, 1.0]],
        };
        let found = |at_end, last| {
            let Finding { is_met, value, .. } = swarm(at_end, last).finding();
            (is_met, value)
        };
        assert_eq!(found(true, Some(1.0)), (true, Some(1.0)));
        assert_eq!(found(true, None), (false, None));
        assert_eq!(found(false, None), (true, Some(1.0)));
    }
}
