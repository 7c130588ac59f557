//! Conditions on motion.

use glam::DVec2;

use super::Finding;
use super::pending::BodyMotion;
use super::region::{
    DistanceBetween, DistanceToLine, DistanceToSegment, Negated, ROUNDING, edges, intervals, intervals_in, is_within,
};
use super::section::{MotionSection, Smooth, find_minimum, find_zeros};
use super::swarm::Swarm;
use crate::RobotId;
use crate::scene::{Bounds, Segment, Walls};
use crate::spec::{BodyRef, CheckKind, Neighbours, Region, SceneSpec, SwarmMetric};
use crate::time::Time;

/// Tolerance, in m^2, of minimum and maximum squared distances that are reported but do not decide a verdict.
const REPORTED_TOLERANCE: f64 = 1e-9;

/// Motion of all bodies in a cell, in the order of their ids; `None` for bodies that were not observed.
pub(super) struct Surroundings<'a> {
    pub walls: &'a Walls,
    pub robots: &'a [Option<BodyMotion>],
    pub objects: &'a [Option<BodyMotion>],
}

impl Surroundings<'_> {
    fn robot(&self, id: RobotId) -> Option<&BodyMotion> {
        self.robots.get(id.index())?.as_ref()
    }

    pub fn sections(&self, body: BodyRef) -> &[MotionSection] {
        let interval = match body {
            BodyRef::Robot(id) => self.robot(id),
            BodyRef::Object(id) => self.objects.get(id.index()).and_then(Option::as_ref),
        };
        interval.map_or(&[], |interval| &interval.body)
    }
}

/// A condition on motion, with its state so far.
#[derive(Clone, Debug)]
pub(super) enum Condition {
    Reach(Reach),
    Visits(Visits),
    StaysIn(StaysIn),
    Laps(Laps),
    Clearance(Clearance),
    FollowsWall(FollowsWall),
    Coverage(Coverage),
    OdometryError(OdometryError),
    Swarm(Swarm),
}

impl Condition {
    /// The condition of a check of this kind, in its state before the run; `None` if the check does not concern motion.
    pub fn new(kind: &CheckKind, scene: &SceneSpec) -> Option<Self> {
        let seconds = |deadline: Option<Time>| deadline.map_or(f64::INFINITY, Time::seconds);
        Some(match kind {
            CheckKind::Reach { body, region, by, stay } => Self::Reach(Reach {
                body: *body,
                region: region.clone(),
                deadline: seconds(*by),
                stay_s: stay.seconds(),
                since: None,
                met: None,
                nearest: NO_DISTANCE,
            }),
            CheckKind::Visits { body, places, within, by, any_order } => Self::Visits(Visits {
                body: *body,
                remaining: places.iter().map(|centre| Region::Disc { centre: *centre, radius: *within }).collect(),
                deadline: seconds(*by),
                any_order: *any_order,
                count: 0,
                last: None,
            }),
            CheckKind::StaysIn { body, region } => {
                Self::StaysIn(StaysIn { body: *body, region: region.clone(), exit: None })
            }
            CheckKind::Laps { body, gate, min, by } => Self::Laps(Laps {
                body: *body,
                gate: Segment::new(gate[0], gate[1]),
                min: *min as i64,
                deadline: seconds(*by),
                is_left: None,
                count: 0,
                met: None,
            }),
            CheckKind::Clearance { robot, min, to } => {
                Self::Clearance(Clearance { robot: *robot, min: *min, to: *to, violated: None, min_gap: None })
            }
            CheckKind::FollowsWall { robot, gap, share } => Self::FollowsWall(FollowsWall {
                robot: *robot,
                gap: *gap,
                min_fraction: *share,
                followed_length: 0.0,
                path_length: 0.0,
            }),
            CheckKind::Coverage { robots, width, area, cell, share, by } => {
                let (robots, corners) = (selected_robots(robots, scene), area_corners(area.as_deref(), scene));
                Self::Coverage(Coverage::new(robots, 0.5 * width, &corners, *cell, *share, seconds(*by)))
            }
            CheckKind::Swarm { robots, metric, min, max, since, at_end } => {
                let robots = selected_robots(robots, scene);
                let coverage = match metric {
                    SwarmMetric::Coverage { width, area, cell } => {
                        let corners = area_corners(area.as_deref(), scene);
                        Some(Coverage::new(robots.clone(), 0.5 * width, &corners, *cell, 1.0, f64::INFINITY))
                    }
                    _ => None,
                };
                let (metric, since, series) = (metric.clone(), *since, Vec::new());
                let (min, max, at_end) = (*min, *max, *at_end);
                let (last, violated) = (None, None);
                Self::Swarm(Swarm { robots, metric, min, max, since, at_end, coverage, last, violated, series })
            }
            CheckKind::OdometryError { robot, max, at_end } => Self::OdometryError(OdometryError {
                robot: *robot,
                max: *max,
                at_end: *at_end,
                violated: None,
                negated_max: (0.0, 0.0),
                last: None,
            }),
            _ => return None,
        })
    }

    /// Evaluates the next cell, or several cells in which all bodies are at rest; `times` are their start and end.
    pub fn evaluate(&mut self, surroundings: &Surroundings<'_>, times: (Time, Time)) {
        match self {
            Self::Reach(condition) => condition.evaluate(surroundings.sections(condition.body)),
            Self::Visits(condition) => condition.evaluate(surroundings.sections(condition.body)),
            Self::StaysIn(condition) => condition.evaluate(surroundings.sections(condition.body)),
            Self::Laps(condition) => condition.evaluate(surroundings.sections(condition.body)),
            Self::Clearance(condition) => condition.evaluate(surroundings),
            Self::FollowsWall(condition) => condition.evaluate(surroundings),
            Self::Coverage(condition) => condition.evaluate(surroundings),
            Self::OdometryError(condition) => condition.evaluate(surroundings),
            Self::Swarm(condition) => condition.evaluate(surroundings, times),
        }
    }

    /// Values over time of a metric of a swarm.
    pub fn series(&self) -> Option<&[[f64; 2]]> {
        match self {
            Self::Swarm(condition) => Some(&condition.series),
            _ => None,
        }
    }

    /// Ends the run at `end`, s; `is_settled` is true if nothing can happen any more.
    pub fn finish(&mut self, end: f64, is_settled: bool) {
        if let Self::Reach(condition) = self
            && is_settled
            && condition.met.is_none()
            && condition.since.is_some()
        {
            // The body would stay inside forever.
            condition.met = condition.since.map(|(since, position)| ((since + condition.stay_s).max(end), position));
        }
    }

    /// The finding so far.
    pub fn finding(&self) -> Finding {
        match self {
            Self::Reach(condition) => condition.finding(),
            Self::Visits(condition) => condition.finding(),
            Self::StaysIn(condition) => Finding::violated(condition.exit, None),
            Self::Laps(condition) => condition.finding(),
            Self::Clearance(condition) => condition.finding(),
            Self::FollowsWall(condition) => condition.finding(),
            Self::Coverage(condition) => condition.finding(),
            Self::OdometryError(condition) => condition.finding(),
            Self::Swarm(condition) => condition.finding(),
        }
    }
}

/// `robots`, or all robots of the scene if the list is empty.
fn selected_robots(robots: &[RobotId], scene: &SceneSpec) -> Vec<RobotId> {
    if robots.is_empty() { scene.robots.iter().map(|robot| robot.id).collect() } else { robots.to_vec() }
}

/// Corners of an area; by default the corners of the floor.
fn area_corners(area: Option<&[DVec2]>, scene: &SceneSpec) -> Vec<DVec2> {
    let floor = scene.world.floor;
    let floor = [DVec2::ZERO, DVec2::new(floor.x, 0.0), floor, DVec2::new(0.0, floor.y)];
    area.unwrap_or(&floor).to_vec()
}

impl Finding {
    /// Finding of a condition that must never be violated; `violation` is the instant and position of the first
    /// violation.
    fn violated(violation: Option<(f64, DVec2)>, value: Option<f64>) -> Self {
        let (at, position) = violation.unzip();
        Self { is_met: violation.is_none(), at, position, value }
    }
}

/// Initial value of [`Reach::nearest`]: no distance found yet.
const NO_DISTANCE: (f64, f64, DVec2) = (f64::INFINITY, 0.0, DVec2::ZERO);

/// Condition: a body reaches a place.
#[derive(Clone, Debug)]
pub(super) struct Reach {
    pub body: BodyRef,
    region: Region,
    /// Instant by which the condition must be met, s.
    deadline: f64,
    /// Duration for which the body must stay, s.
    stay_s: f64,
    /// Instant and position of the last entry, while the body is inside.
    since: Option<(f64, DVec2)>,
    /// Instant at which the condition was met, and the position of the entry.
    met: Option<(f64, DVec2)>,
    /// Minimum squared distance to the disc's centre or the polygon's border, with its instant and position.
    nearest: (f64, f64, DVec2),
}

impl Reach {
    fn evaluate(&mut self, sections: &[MotionSection]) {
        for section in sections {
            if self.met.is_some() {
                return;
            }
            for (from, to, is_inside) in intervals_in(section, &self.region) {
                if !is_inside {
                    self.since = None;
                } else {
                    let (since, position) = *self.since.get_or_insert((from, section.position(from)));
                    if to - since >= self.stay_s {
                        self.met = Some((since + self.stay_s, position));
                        return;
                    }
                }
            }
            if self.since.is_none() {
                self.update_nearest(section);
            }
        }
    }

    fn update_nearest(&mut self, section: &MotionSection) {
        let mut update_nearest = |segment: Segment| {
            let mut minimum = (self.nearest.0, self.nearest.1);
            find_minimum(
                &DistanceToSegment { section, segment, squared_reference: 0.0 },
                (section.from, section.to),
                &mut minimum,
                REPORTED_TOLERANCE,
            );
            if minimum.0 < self.nearest.0 {
                self.nearest = (minimum.0, minimum.1, section.position(minimum.1));
            }
        };
        match &self.region {
            Region::Disc { centre, .. } => update_nearest(Segment::new(*centre, *centre)),
            Region::Polygon(corners) => edges(corners).for_each(update_nearest),
        }
    }

    fn finding(&self) -> Finding {
        let (distance_squared, at, position) = self.nearest;
        match self.met.or(self.since) {
            Some((at, position)) => {
                let is_met = self.met.is_some() && at <= self.deadline + ROUNDING;
                Finding { is_met, at: Some(at), position: Some(position), value: None }
            }
            None if distance_squared.is_finite() => {
                Finding { is_met: false, at: Some(at), position: Some(position), value: Some(distance_squared.sqrt()) }
            }
            None => Finding { is_met: false, at: None, position: None, value: None },
        }
    }
}

/// Condition: a body visits several places.
#[derive(Clone, Debug)]
pub(super) struct Visits {
    pub body: BodyRef,
    /// Places that have not been visited.
    remaining: Vec<Region>,
    /// Instant by which the condition must be met, s.
    deadline: f64,
    any_order: bool,
    /// Number of visited places.
    count: u64,
    /// Instant and position of the last visit.
    last: Option<(f64, DVec2)>,
}

impl Visits {
    fn evaluate(&mut self, sections: &[MotionSection]) {
        for section in sections {
            let mut remaining_section = *section;
            while let Some((index, at)) = self.next_visit(&remaining_section) {
                self.remaining.remove(index);
                self.count += 1;
                self.last = Some((at, section.position(at)));
                remaining_section = section.part(at, section.to);
            }
        }
    }

    /// The next visit within a section: index of the place among the remaining ones, and instant.
    fn next_visit(&self, section: &MotionSection) -> Option<(usize, f64)> {
        let candidates = if self.any_order { self.remaining.len() } else { self.remaining.len().min(1) };
        let entry = |region: &Region| intervals_in(section, region).into_iter().find(|(.., is_inside)| *is_inside);
        let entries = self.remaining[..candidates].iter().enumerate();
        let entries = entries.filter_map(|(index, region)| entry(region).map(|(at, ..)| (index, at)));
        entries.min_by(|(_, a), (_, b)| a.total_cmp(b))
    }

    fn finding(&self) -> Finding {
        let (at, position) = self.last.unzip();
        let is_met = self.remaining.is_empty() && at.is_none_or(|at| at <= self.deadline + ROUNDING);
        Finding { is_met, at, position, value: Some(self.count as f64) }
    }
}

/// Condition: a body never leaves a place.
#[derive(Clone, Debug)]
pub(super) struct StaysIn {
    pub body: BodyRef,
    region: Region,
    /// Instant and position of the first exit.
    exit: Option<(f64, DVec2)>,
}

impl StaysIn {
    fn evaluate(&mut self, sections: &[MotionSection]) {
        for section in sections.iter().filter(|_| self.exit.is_none()) {
            let outside = intervals_in(section, &self.region).into_iter().find(|(.., is_inside)| !is_inside);
            if let Some((at, ..)) = outside {
                self.exit = Some((at, section.position(at)));
                return;
            }
        }
    }
}

/// Condition: a body passes a gate a minimum number of times from right to left. A passage from left to right cancels
/// one of these.
#[derive(Clone, Debug)]
pub(super) struct Laps {
    pub body: BodyRef,
    gate: Segment,
    min: i64,
    /// Instant by which the condition must be met, s.
    deadline: f64,
    /// Side of the gate's line on which the body was last.
    is_left: Option<bool>,
    /// Passages from right to left minus passages from left to right.
    count: i64,
    met: Option<(f64, DVec2)>,
}

impl Laps {
    fn evaluate(&mut self, sections: &[MotionSection]) {
        let along = self.gate.b - self.gate.a;
        let Some(normal) = along.perp().try_normalize() else { return };
        for section in sections {
            let line = DistanceToLine { section, point: self.gate.a, normal };
            let mut breaks = Vec::new();
            find_zeros(&line, section.from, section.to, &mut breaks);
            for (from, _, is_left) in intervals(section, breaks, |t| line.at(t).0 > 0.0) {
                let was_left = self.is_left.replace(is_left);
                let position = section.position(from);
                let is_within = self.gate.distance(position) <= 2.0 * ROUNDING;
                if was_left.is_none_or(|was_left| was_left == is_left) || !is_within {
                    continue;
                }
                self.count += if is_left { 1 } else { -1 };
                if self.count >= self.min && self.met.is_none() {
                    self.met = Some((from, position));
                }
            }
        }
    }

    fn finding(&self) -> Finding {
        let (at, position) = self.met.unzip();
        let is_met = at.is_some_and(|at| at <= self.deadline + ROUNDING);
        Finding { is_met, at, position, value: Some(self.count as f64) }
    }
}

/// Condition: a robot's body keeps a clearance from other bodies and walls.
#[derive(Clone, Debug)]
pub(super) struct Clearance {
    robot: RobotId,
    min: f64,
    to: Neighbours,
    /// Instant and position of the first violation.
    violated: Option<(f64, DVec2)>,
    /// Minimum gap, and its instant.
    min_gap: Option<(f64, f64)>,
}

impl Clearance {
    fn evaluate(&mut self, surroundings: &Surroundings<'_>) {
        let Some(motion) = surroundings.robot(self.robot) else { return };
        let mut violations: Vec<(f64, DVec2)> = Vec::new();
        for section in &motion.body {
            if self.to != Neighbours::Robots {
                self.update_walls(surroundings.walls, section, motion.radius, &mut violations);
            }
        }
        if self.to != Neighbours::Walls {
            for (index, other) in surroundings.robots.iter().enumerate() {
                let Some(other) = other.as_ref().filter(|_| index != self.robot.index()) else { continue };
                for (section, other_section) in overlaps(&motion.body, &other.body) {
                    let sections = [&section, &other_section];
                    self.update_gap(
                        |squared_reference| DistanceBetween { sections, squared_reference },
                        &section,
                        motion.radius + other.radius,
                        &mut violations,
                    );
                }
            }
        }
        if self.violated.is_none() {
            self.violated = violations.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        }
    }

    /// Evaluates the distance to the walls in a section.
    fn update_walls(
        &mut self,
        walls: &Walls,
        section: &MotionSection,
        radius: f64,
        violations: &mut Vec<(f64, DVec2)>,
    ) {
        let (middle, disc_radius) = section.surrounding_disc();
        // All walls are searched only once; after that, only a wall that is nearer than the minimum gap so far matters.
        let gap =
            self.min_gap.map_or_else(|| nearest_wall(walls, section.position(section.from)) - radius, |(gap, _)| gap);
        let search_radius = disc_radius + radius + gap.max(self.min) + 2.0 * ROUNDING;
        if search_radius.is_finite() {
            walls.for_each_in(Bounds::of_disc(middle, search_radius), |_, wall| {
                self.update_gap(
                    |squared_reference| DistanceToSegment { section, segment: *wall, squared_reference },
                    section,
                    radius,
                    violations,
                );
            });
        }
    }

    /// Evaluates the distance to one other body or wall in a section. `radius` is the distance of the robot's centre
    /// from the centre of that body, or from the wall, at contact. `distance_minus(d)` is the squared distance minus
    /// `d`.
    fn update_gap<F: Smooth>(
        &mut self,
        distance_minus: impl Fn(f64) -> F,
        section: &MotionSection,
        radius: f64,
        violations: &mut Vec<(f64, DVec2)>,
    ) {
        let times = (section.from, section.to);
        if self.violated.is_none() {
            let limit = (radius + self.min - ROUNDING).max(0.0);
            let function = distance_minus(limit * limit);
            let mut breaks = Vec::new();
            find_zeros(&function, section.from, section.to, &mut breaks);
            let violation =
                intervals(section, breaks, |t| function.at(t).0 < 0.0).into_iter().find(|(.., is_near)| *is_near);
            violations.extend(violation.map(|(at, ..)| (at, section.position(at))));
        }
        let (gap, at) = self.min_gap.unwrap_or((f64::INFINITY, section.from));
        let squared_distance = |gap: f64| (gap + radius) * (gap + radius);
        let mut minimum = (squared_distance(gap), at);
        find_minimum(&distance_minus(0.0), times, &mut minimum, REPORTED_TOLERANCE);
        if minimum.0 < squared_distance(gap) {
            self.min_gap = Some((minimum.0.max(0.0).sqrt() - radius, minimum.1));
        }
    }

    fn finding(&self) -> Finding {
        let value = self.min_gap.map(|(gap, _)| gap);
        Finding::violated(self.violated, value)
    }
}

/// Distance from `point` to the nearest wall, m; infinite without walls.
fn nearest_wall(walls: &Walls, point: DVec2) -> f64 {
    walls.segments().iter().map(|wall| wall.distance(point)).fold(f64::INFINITY, f64::min)
}

/// Splits two lists of sections at common instants: pairs of parts over the same time intervals.
fn overlaps<'a>(
    a: &'a [MotionSection],
    b: &'a [MotionSection],
) -> impl Iterator<Item = (MotionSection, MotionSection)> + 'a {
    a.iter().flat_map(move |first| {
        b.iter().filter_map(move |second| {
            let (from, to) = (first.from.max(second.from), first.to.min(second.to));
            (from < to).then(|| (first.part(from, to), second.part(from, to)))
        })
    })
}

/// Condition: a robot drives along walls for a minimum fraction of its path.
#[derive(Clone, Debug)]
pub(super) struct FollowsWall {
    robot: RobotId,
    /// Minimum and maximum gap between the robot's body and the nearest wall, m.
    gap: [f64; 2],
    min_fraction: f64,
    /// Length of the path with the gap within its limits, m.
    followed_length: f64,
    /// Length of the whole path, m.
    path_length: f64,
}

impl FollowsWall {
    fn evaluate(&mut self, surroundings: &Surroundings<'_>) {
        let Some(motion) = surroundings.robot(self.robot) else { return };
        for section in motion.body.iter().filter(|section| !section.is_resting()) {
            let (middle, disc_radius) = section.surrounding_disc();
            let limits = [self.gap[0] + motion.radius - ROUNDING, self.gap[1] + motion.radius + ROUNDING];
            let (mut near_walls, mut breaks) = (Vec::new(), Vec::new());
            surroundings
                .walls
                .for_each_in(Bounds::of_disc(middle, disc_radius + limits[1]), |_, wall| near_walls.push(*wall));
            for (segment, limit) in near_walls.iter().flat_map(|wall| limits.map(|limit| (*wall, limit.max(0.0)))) {
                let function = DistanceToSegment { section, segment, squared_reference: limit * limit };
                find_zeros(&function, section.from, section.to, &mut breaks);
            }
            let is_followed = |t: f64| {
                let position = section.position(t);
                let gap = near_walls.iter().map(|wall| wall.distance(position)).fold(f64::INFINITY, f64::min);
                (limits[0]..=limits[1]).contains(&gap)
            };
            for (from, to, is_followed) in intervals(section, breaks, is_followed) {
                let length = section.length(from, to);
                self.path_length += length;
                self.followed_length += if is_followed { length } else { 0.0 };
            }
        }
    }

    fn finding(&self) -> Finding {
        let fraction = if self.path_length > 0.0 { self.followed_length / self.path_length } else { 0.0 };
        let is_met = self.path_length > 0.0 && fraction >= self.min_fraction - ROUNDING;
        Finding { is_met, at: None, position: None, value: Some(fraction) }
    }
}

/// Condition: a tool covers an area.
#[derive(Clone, Debug)]
pub(super) struct Coverage {
    robots: Vec<RobotId>,
    /// Half of the tool's width, m.
    half_width: f64,
    /// Side of a square, m.
    cell: f64,
    /// Lower left corner of the grid.
    origin: DVec2,
    columns: usize,
    /// The squares, row by row: true if the square must be covered and is not yet covered.
    is_uncovered: Vec<bool>,
    /// Total number of squares that must be covered.
    total_cells: usize,
    covered_cells: usize,
    min_fraction: f64,
    /// Instant by which the condition must be met, s.
    deadline: f64,
    met: Option<(f64, DVec2)>,
}

impl Coverage {
    fn new(
        robots: Vec<RobotId>,
        half_width: f64,
        corners: &[DVec2],
        cell: f64,
        min_fraction: f64,
        deadline: f64,
    ) -> Self {
        let bounds = Bounds::of_points(corners.iter().copied());
        let size = ((bounds.max - bounds.min) / cell).ceil();
        let (columns, rows) = (size.x.max(1.0) as usize, size.y.max(1.0) as usize);
        let middle = |index: usize| bounds.min + cell_centre(index, columns) * cell;
        let is_uncovered: Vec<bool> = (0..columns * rows).map(|index| is_within(corners, middle(index))).collect();
        let total_cells = is_uncovered.iter().filter(|is_uncovered| **is_uncovered).count();
        Self {
            robots,
            half_width,
            cell,
            origin: bounds.min,
            columns,
            is_uncovered,
            total_cells,
            covered_cells: 0,
            min_fraction,
            deadline,
            met: None,
        }
    }

    pub fn evaluate(&mut self, surroundings: &Surroundings<'_>) {
        let mut entries: Vec<(f64, usize, DVec2)> = Vec::new();
        for robot in &self.robots {
            let sections = surroundings.sections(BodyRef::Robot(*robot));
            sections.iter().for_each(|section| self.find_covered(section, &mut entries));
        }
        entries.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (at, index, position) in entries {
            self.covered_cells += usize::from(std::mem::take(&mut self.is_uncovered[index]));
            if self.met.is_none() && self.is_fraction_reached() {
                self.met = Some((at, position));
            }
        }
    }

    fn is_fraction_reached(&self) -> bool {
        self.covered_cells as f64 >= self.min_fraction * self.total_cells as f64 - 1e-6
    }

    /// Collects the uncovered squares whose centres the tool reaches in a section: instant, index, position of the
    /// tool.
    fn find_covered(&self, section: &MotionSection, entries: &mut Vec<(f64, usize, DVec2)>) {
        let (middle, disc_radius) = section.surrounding_disc();
        let bounds = Bounds::of_disc(middle, disc_radius + self.half_width + self.cell);
        let rows = self.is_uncovered.len() / self.columns;
        let grid_position = |point: DVec2| ((point - self.origin) / self.cell).max(DVec2::ZERO);
        let (low, high) = (grid_position(bounds.min), grid_position(bounds.max));
        for row in low.y as usize..(high.y as usize + 1).min(rows) {
            for column in low.x as usize..(high.x as usize + 1).min(self.columns) {
                let cell = row * self.columns + column;
                if !self.is_uncovered[cell] {
                    continue;
                }
                let point = self.origin + cell_centre(cell, self.columns) * self.cell;
                let tool_disc = Region::Disc { centre: point, radius: self.half_width };
                let entry = intervals_in(section, &tool_disc).into_iter().find(|(.., is_inside)| *is_inside);
                entries.extend(entry.map(|(at, ..)| (at, cell, section.position(at))));
            }
        }
    }

    pub fn finding(&self) -> Finding {
        let (at, position) = self.met.unzip();
        let is_met =
            self.total_cells > 0 && (self.is_fraction_reached() && at.is_none_or(|at| at <= self.deadline + ROUNDING));
        let fraction = if self.total_cells > 0 { self.covered_cells as f64 / self.total_cells as f64 } else { 0.0 };
        Finding { is_met, at, position, value: Some(fraction) }
    }
}

/// Centre of the square at `index`, relative to the corner of the grid, in units of the square's side.
fn cell_centre(index: usize, columns: usize) -> DVec2 {
    DVec2::new((index % columns) as f64 + 0.5, (index / columns) as f64 + 0.5)
}

/// Condition: the distance between odometry's position and the true position never exceeds a maximum.
#[derive(Clone, Debug)]
pub(super) struct OdometryError {
    robot: RobotId,
    max: f64,
    at_end: bool,
    violated: Option<(f64, DVec2)>,
    /// Negated square of the maximum error, and its instant.
    negated_max: (f64, f64),
    /// The last error, its instant and the true position.
    last: Option<(f64, f64, DVec2)>,
}

impl OdometryError {
    fn evaluate(&mut self, surroundings: &Surroundings<'_>) {
        let Some(motion) = surroundings.robot(self.robot) else { return };
        let [truth, odometry] = &motion.axle;
        for (truth, odometry) in overlaps(truth, odometry) {
            let (sections, to) = ([&truth, &odometry], truth.to);
            let limit = self.max + ROUNDING;
            let excess = DistanceBetween { sections, squared_reference: limit * limit };
            if self.violated.is_none() && !self.at_end {
                let mut breaks = Vec::new();
                find_zeros(&excess, truth.from, to, &mut breaks);
                let violation = intervals(&truth, breaks, |t| excess.at(t).0 > 0.0);
                let violation = violation.into_iter().find(|(.., is_beyond)| *is_beyond);
                self.violated = violation.map(|(at, ..)| (at, truth.position(at)));
            }
            let error = Negated(DistanceBetween { sections, squared_reference: 0.0 });
            find_minimum(&error, (truth.from, to), &mut self.negated_max, REPORTED_TOLERANCE);
            let position = truth.position(to);
            self.last = Some(((odometry.position(to) - position).length(), to, position));
        }
    }

    fn finding(&self) -> Finding {
        if self.at_end {
            let violation = self.last.filter(|(error, ..)| *error > self.max + ROUNDING);
            return Finding::violated(
                violation.map(|(_, at, position)| (at, position)),
                self.last.map(|(error, ..)| error),
            );
        }
        Finding::violated(self.violated, Some((-self.negated_max.0).max(0.0).sqrt()))
    }
}
