//! Conditions on motion, each with its state so far.

use glam::DVec2;

use super::Finding;
use super::pending::Interval;
use super::region::{Between, Negative, ROUNDING, ToLine, ToSegment, edges, intervals, intervals_in, is_within};
use super::section::{MotionSection, Smooth, find_minimum, find_zeros};
use super::swarm::Swarm;
use crate::RobotId;
use crate::scene::{Bounds, Segment, Walls};
use crate::spec::{BodyRef, CheckKind, Neighbours, Region, SceneSpec, SwarmMetric};
use crate::time::Time;

/// Tolerance of the minima and maxima of squared distances that are only reported, m^2.
const REPORTED_TOLERANCE: f64 = 1e-9;

/// Motion of all bodies in a cell, in the order of their ids; `None` for bodies that were not observed.
pub(super) struct Surroundings<'a> {
    pub walls: &'a Walls,
    pub robots: &'a [Option<Interval>],
    pub objects: &'a [Option<Interval>],
}

impl Surroundings<'_> {
    fn robot(&self, id: RobotId) -> Option<&Interval> {
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
pub(super) enum Watch {
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

impl Watch {
    /// The condition of this kind before the run; `None` if it does not concern motion.
    pub fn new(kind: &CheckKind, scene: &SceneSpec) -> Option<Self> {
        let seconds = |by: Option<Time>| by.map_or(f64::INFINITY, Time::seconds);
        Some(match kind {
            CheckKind::Reach { body, region, by, stay } => Self::Reach(Reach {
                body: *body,
                region: region.clone(),
                by: seconds(*by),
                stay: stay.seconds(),
                since: None,
                done: None,
                nearest: NO_DISTANCE,
            }),
            CheckKind::Visits { body, places, within, by, any_order } => Self::Visits(Visits {
                body: *body,
                remaining: places.iter().map(|centre| Region::Disc { centre: *centre, radius: *within }).collect(),
                by: seconds(*by),
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
                by: seconds(*by),
                is_left: None,
                count: 0,
                done: None,
            }),
            CheckKind::Clearance { robot, min, to } => {
                Self::Clearance(Clearance { robot: *robot, min: *min, to: *to, violated: None, min_gap: None })
            }
            CheckKind::FollowsWall { robot, gap, share } => {
                Self::FollowsWall(FollowsWall { robot: *robot, gap: *gap, share: *share, followed: 0.0, path: 0.0 })
            }
            CheckKind::Coverage { robots, width, area, cell, share, by } => {
                let (robots, corners) = (robots_of(robots, scene), corners_of(area.as_deref(), scene));
                Self::Coverage(Coverage::new(robots, 0.5 * width, &corners, *cell, *share, seconds(*by)))
            }
            CheckKind::Swarm { robots, metric, min, max, since, at_end } => {
                let robots = robots_of(robots, scene);
                let coverage = match metric {
                    SwarmMetric::Coverage { width, area, cell } => {
                        let corners = corners_of(area.as_deref(), scene);
                        Some(Coverage::new(robots.clone(), 0.5 * width, &corners, *cell, 1.0, f64::INFINITY))
                    }
                    _ => None,
                };
                let (of, since, series) = (metric.clone(), *since, Vec::new());
                let (min, max, at_end) = (*min, *max, *at_end);
                Self::Swarm(Swarm { robots, of, min, max, since, at_end, coverage, violated: None, series })
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

    /// Evaluates the next cell, or several cells in which all bodies are at rest; `times` are start and end.
    pub fn take(&mut self, surroundings: &Surroundings<'_>, times: (Time, Time)) {
        match self {
            Self::Reach(watch) => watch.take(surroundings.sections(watch.body)),
            Self::Visits(watch) => watch.take(surroundings.sections(watch.body)),
            Self::StaysIn(watch) => watch.take(surroundings.sections(watch.body)),
            Self::Laps(watch) => watch.take(surroundings.sections(watch.body)),
            Self::Clearance(watch) => watch.take(surroundings),
            Self::FollowsWall(watch) => watch.take(surroundings),
            Self::Coverage(watch) => watch.take(surroundings),
            Self::OdometryError(watch) => watch.take(surroundings),
            Self::Swarm(watch) => watch.take(surroundings, times),
        }
    }

    /// Values over time of a metric of a swarm.
    pub fn series(&self) -> Option<&[[f64; 2]]> {
        match self {
            Self::Swarm(watch) => Some(&watch.series),
            _ => None,
        }
    }

    /// Ends the run at `end`, s; `is_settled` if nothing can happen any more.
    pub fn finish(&mut self, end: f64, is_settled: bool) {
        if let Self::Reach(watch) = self
            && is_settled
            && watch.done.is_none()
            && watch.since.is_some()
        {
            // The body stays where it is forever.
            watch.done = watch.since.map(|(since, position)| ((since + watch.stay).max(end), position));
        }
    }

    /// The finding so far.
    pub fn finding(&self) -> Finding {
        match self {
            Self::Reach(watch) => watch.finding(),
            Self::Visits(watch) => watch.finding(),
            Self::StaysIn(watch) => Finding::violated(watch.exit, None),
            Self::Laps(watch) => watch.finding(),
            Self::Clearance(watch) => watch.finding(),
            Self::FollowsWall(watch) => watch.finding(),
            Self::Coverage(watch) => watch.finding(),
            Self::OdometryError(watch) => watch.finding(),
            Self::Swarm(watch) => watch.finding(),
        }
    }
}

/// `robots`, or all robots of the scene if the list is empty.
fn robots_of(robots: &[RobotId], scene: &SceneSpec) -> Vec<RobotId> {
    if robots.is_empty() { scene.robots.iter().map(|robot| robot.id).collect() } else { robots.to_vec() }
}

/// Corners of an area; by default the corners of the floor.
fn corners_of(area: Option<&[DVec2]>, scene: &SceneSpec) -> Vec<DVec2> {
    let floor = scene.world.floor;
    let floor = [DVec2::ZERO, DVec2::new(floor.x, 0.0), floor, DVec2::new(0.0, floor.y)];
    area.unwrap_or(&floor).to_vec()
}

impl Finding {
    /// Finding of a condition that is met unless it was violated at this instant and position.
    fn violated(violation: Option<(f64, DVec2)>, value: Option<f64>) -> Self {
        let (at, position) = violation.unzip();
        Self { is_met: violation.is_none(), at, position, value }
    }
}

/// Initial value: no squared distance found yet.
const NO_DISTANCE: (f64, f64, DVec2) = (f64::INFINITY, 0.0, DVec2::ZERO);

/// Condition: a body reaches a place.
#[derive(Clone, Debug)]
pub(super) struct Reach {
    pub body: BodyRef,
    region: Region,
    by: f64,
    stay: f64,
    /// Instant and position of the last entry, while the body is inside.
    since: Option<(f64, DVec2)>,
    /// Instant at which the condition was met, and the position of the entry.
    done: Option<(f64, DVec2)>,
    /// Squared minimum distance to the centre or border, with its instant and position.
    nearest: (f64, f64, DVec2),
}

impl Reach {
    fn take(&mut self, sections: &[MotionSection]) {
        for section in sections {
            if self.done.is_some() {
                return;
            }
            for (from, to, is_inside) in intervals_in(section, &self.region) {
                if !is_inside {
                    self.since = None;
                } else {
                    let (since, position) = *self.since.get_or_insert((from, section.position(from)));
                    if to - since >= self.stay {
                        self.done = Some((since + self.stay, position));
                        return;
                    }
                }
            }
            if self.since.is_none() {
                self.approach(section);
            }
        }
    }

    fn approach(&mut self, section: &MotionSection) {
        let mut approach = |segment: Segment| {
            let mut best = (self.nearest.0, self.nearest.1);
            find_minimum(
                &ToSegment { section, segment, less: 0.0 },
                (section.from, section.to),
                &mut best,
                REPORTED_TOLERANCE,
            );
            if best.0 < self.nearest.0 {
                self.nearest = (best.0, best.1, section.position(best.1));
            }
        };
        match &self.region {
            Region::Disc { centre, .. } => approach(Segment::new(*centre, *centre)),
            Region::Polygon(corners) => edges(corners).for_each(approach),
        }
    }

    fn finding(&self) -> Finding {
        let (square, at, position) = self.nearest;
        match self.done.or(self.since) {
            Some((at, position)) => {
                let is_met = self.done.is_some() && at <= self.by + ROUNDING;
                Finding { is_met, at: Some(at), position: Some(position), value: None }
            }
            None if square.is_finite() => {
                Finding { is_met: false, at: Some(at), position: Some(position), value: Some(square.sqrt()) }
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
    by: f64,
    any_order: bool,
    /// Number of visited places.
    count: u64,
    /// The last visit.
    last: Option<(f64, DVec2)>,
}

impl Visits {
    fn take(&mut self, sections: &[MotionSection]) {
        for section in sections {
            let mut rest = *section;
            while let Some((region, at)) = self.next(&rest) {
                self.remaining.remove(region);
                self.count += 1;
                self.last = Some((at, section.position(at)));
                rest = section.part(at, section.to);
            }
        }
    }

    /// The next visit within a section: index of the place, and instant.
    fn next(&self, section: &MotionSection) -> Option<(usize, f64)> {
        let candidates = if self.any_order { self.remaining.len() } else { self.remaining.len().min(1) };
        let entry = |region: &Region| intervals_in(section, region).into_iter().find(|(.., is_inside)| *is_inside);
        let entries = self.remaining[..candidates].iter().enumerate();
        let entries = entries.filter_map(|(index, region)| entry(region).map(|(at, ..)| (index, at)));
        entries.min_by(|(_, a), (_, b)| a.total_cmp(b))
    }

    fn finding(&self) -> Finding {
        let (at, position) = self.last.unzip();
        let is_met = self.remaining.is_empty() && at.is_none_or(|at| at <= self.by + ROUNDING);
        Finding { is_met, at, position, value: Some(self.count as f64) }
    }
}

/// Condition: a body never leaves a place.
#[derive(Clone, Debug)]
pub(super) struct StaysIn {
    pub body: BodyRef,
    region: Region,
    exit: Option<(f64, DVec2)>,
}

impl StaysIn {
    fn take(&mut self, sections: &[MotionSection]) {
        for section in sections.iter().filter(|_| self.exit.is_none()) {
            let outside = intervals_in(section, &self.region).into_iter().find(|(.., is_inside)| !is_inside);
            if let Some((at, ..)) = outside {
                self.exit = Some((at, section.position(at)));
                return;
            }
        }
    }
}

/// Condition: a body passes a gate.
#[derive(Clone, Debug)]
pub(super) struct Laps {
    pub body: BodyRef,
    gate: Segment,
    min: i64,
    by: f64,
    /// Side of the gate's line on which the body was last.
    is_left: Option<bool>,
    count: i64,
    done: Option<(f64, DVec2)>,
}

impl Laps {
    fn take(&mut self, sections: &[MotionSection]) {
        let along = self.gate.b - self.gate.a;
        let Some(normal) = along.perp().try_normalize() else { return };
        for section in sections {
            let line = ToLine { section, point: self.gate.a, normal };
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
                if self.count >= self.min && self.done.is_none() {
                    self.done = Some((from, position));
                }
            }
        }
    }

    fn finding(&self) -> Finding {
        let (at, position) = self.done.unzip();
        let is_met = at.is_some_and(|at| at <= self.by + ROUNDING);
        Finding { is_met, at, position, value: Some(self.count as f64) }
    }
}

/// Condition: a robot's body keeps a clearance from other bodies and walls.
#[derive(Clone, Debug)]
pub(super) struct Clearance {
    robot: RobotId,
    min: f64,
    to: Neighbours,
    violated: Option<(f64, DVec2)>,
    /// Smallest gap, and its instant.
    min_gap: Option<(f64, f64)>,
}

impl Clearance {
    fn take(&mut self, surroundings: &Surroundings<'_>) {
        let Some(own) = surroundings.robot(self.robot) else { return };
        let mut violations: Vec<(f64, DVec2)> = Vec::new();
        for section in &own.body {
            if self.to != Neighbours::Robots {
                self.walls(surroundings.walls, section, own.radius, &mut violations);
            }
        }
        if self.to != Neighbours::Walls {
            for (index, other) in surroundings.robots.iter().enumerate() {
                let Some(other) = other.as_ref().filter(|_| index != self.robot.index()) else { continue };
                for (section, theirs) in overlaps(&own.body, &other.body) {
                    let sections = [&section, &theirs];
                    self.meet(|less| Between { sections, less }, &section, own.radius + other.radius, &mut violations);
                }
            }
        }
        if self.violated.is_none() {
            self.violated = violations.into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
        }
    }

    fn walls(&mut self, walls: &Walls, section: &MotionSection, radius: f64, violations: &mut Vec<(f64, DVec2)>) {
        let (middle, half_way) = section.surrounding_disc();
        // The nearest wall of the whole world is searched once; later only a nearer wall counts.
        let gap =
            self.min_gap.map_or_else(|| nearest_wall(walls, section.position(section.from)) - radius, |(gap, _)| gap);
        let reach = half_way + radius + gap.max(self.min) + 2.0 * ROUNDING;
        if reach.is_finite() {
            walls.for_each_in(Bounds::of_disc(middle, reach), |_, wall| {
                self.meet(|less| ToSegment { section, segment: *wall, less }, section, radius, violations);
            });
        }
    }

    /// Evaluates the distance to one other body; `radius` is the distance at which the two touch.
    fn meet<F: Smooth>(
        &mut self,
        function: impl Fn(f64) -> F,
        section: &MotionSection,
        radius: f64,
        violations: &mut Vec<(f64, DVec2)>,
    ) {
        let times = (section.from, section.to);
        if self.violated.is_none() {
            let limit = (radius + self.min - ROUNDING).max(0.0);
            let function = function(limit * limit);
            let mut breaks = Vec::new();
            find_zeros(&function, section.from, section.to, &mut breaks);
            let violation =
                intervals(section, breaks, |t| function.at(t).0 < 0.0).into_iter().find(|(.., is_near)| *is_near);
            violations.extend(violation.map(|(at, ..)| (at, section.position(at))));
        }
        let (gap, at) = self.min_gap.unwrap_or((f64::INFINITY, section.from));
        let square = |gap: f64| (gap + radius) * (gap + radius);
        let mut best = (square(gap), at);
        find_minimum(&function(0.0), times, &mut best, REPORTED_TOLERANCE);
        if best.0 < square(gap) {
            self.min_gap = Some((best.0.max(0.0).sqrt() - radius, best.1));
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

/// The parts of two lists of sections over the same time intervals.
fn overlaps<'a>(
    a: &'a [MotionSection],
    b: &'a [MotionSection],
) -> impl Iterator<Item = (MotionSection, MotionSection)> + 'a {
    a.iter().flat_map(move |one| {
        b.iter().filter_map(move |other| {
            let (from, to) = (one.from.max(other.from), one.to.min(other.to));
            (from < to).then(|| (one.part(from, to), other.part(from, to)))
        })
    })
}

/// Condition: a robot drives along walls.
#[derive(Clone, Debug)]
pub(super) struct FollowsWall {
    robot: RobotId,
    gap: [f64; 2],
    share: f64,
    /// Length of the path with the gap within its limits, m.
    followed: f64,
    /// Length of the path, m.
    path: f64,
}

impl FollowsWall {
    fn take(&mut self, surroundings: &Surroundings<'_>) {
        let Some(own) = surroundings.robot(self.robot) else { return };
        for section in own.body.iter().filter(|section| !section.is_resting()) {
            let (middle, half_way) = section.surrounding_disc();
            let limits = [self.gap[0] + own.radius - ROUNDING, self.gap[1] + own.radius + ROUNDING];
            let (mut near_walls, mut breaks) = (Vec::new(), Vec::new());
            surroundings
                .walls
                .for_each_in(Bounds::of_disc(middle, half_way + limits[1]), |_, wall| near_walls.push(*wall));
            for (segment, limit) in near_walls.iter().flat_map(|wall| limits.map(|limit| (*wall, limit.max(0.0)))) {
                let function = ToSegment { section, segment, less: limit * limit };
                find_zeros(&function, section.from, section.to, &mut breaks);
            }
            let is_followed = |t: f64| {
                let position = section.position(t);
                let gap = near_walls.iter().map(|wall| wall.distance(position)).fold(f64::INFINITY, f64::min);
                (limits[0]..=limits[1]).contains(&gap)
            };
            for (from, to, is_followed) in intervals(section, breaks, is_followed) {
                let length = section.length(from, to);
                self.path += length;
                self.followed += if is_followed { length } else { 0.0 };
            }
        }
    }

    fn finding(&self) -> Finding {
        let fraction = if self.path > 0.0 { self.followed / self.path } else { 0.0 };
        let is_met = self.path > 0.0 && fraction >= self.share - ROUNDING;
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
    /// The squares, row by row: true if the square is to be covered and is not yet covered.
    is_open: Vec<bool>,
    /// Total number of squares to be covered.
    whole: usize,
    covered_cells: usize,
    share: f64,
    by: f64,
    done: Option<(f64, DVec2)>,
}

impl Coverage {
    fn new(robots: Vec<RobotId>, half_width: f64, corners: &[DVec2], cell: f64, share: f64, by: f64) -> Self {
        let bounds = Bounds::of_points(corners.iter().copied());
        let size = ((bounds.max - bounds.min) / cell).ceil();
        let (columns, rows) = (size.x.max(1.0) as usize, size.y.max(1.0) as usize);
        let middle = |index: usize| bounds.min + middle_of(index, columns) * cell;
        let is_open: Vec<bool> = (0..columns * rows).map(|index| is_within(corners, middle(index))).collect();
        let whole = is_open.iter().filter(|is_open| **is_open).count();
        Self {
            robots,
            half_width,
            cell,
            origin: bounds.min,
            columns,
            is_open,
            whole,
            covered_cells: 0,
            share,
            by,
            done: None,
        }
    }

    pub fn take(&mut self, surroundings: &Surroundings<'_>) {
        let mut found: Vec<(f64, usize, DVec2)> = Vec::new();
        for robot in &self.robots {
            let sections = surroundings.sections(BodyRef::Robot(*robot));
            sections.iter().for_each(|section| self.pass(section, &mut found));
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for (at, index, position) in found {
            self.covered_cells += usize::from(std::mem::take(&mut self.is_open[index]));
            if self.done.is_none() && self.is_enough() {
                self.done = Some((at, position));
            }
        }
    }

    fn is_enough(&self) -> bool {
        self.covered_cells as f64 >= self.share * self.whole as f64 - 1e-6
    }

    /// Collects the squares over whose middles the tool passes in a section: instant, index, position of the tool.
    fn pass(&self, section: &MotionSection, found: &mut Vec<(f64, usize, DVec2)>) {
        let (middle, half_way) = section.surrounding_disc();
        let bounds = Bounds::of_disc(middle, half_way + self.half_width + self.cell);
        let rows = self.is_open.len() / self.columns;
        let index = |point: DVec2| ((point - self.origin) / self.cell).max(DVec2::ZERO);
        let (low, high) = (index(bounds.min), index(bounds.max));
        for row in low.y as usize..(high.y as usize + 1).min(rows) {
            for column in low.x as usize..(high.x as usize + 1).min(self.columns) {
                let cell = row * self.columns + column;
                if !self.is_open[cell] {
                    continue;
                }
                let point = self.origin + middle_of(cell, self.columns) * self.cell;
                let within = Region::Disc { centre: point, radius: self.half_width };
                let entry = intervals_in(section, &within).into_iter().find(|(.., is_inside)| *is_inside);
                found.extend(entry.map(|(at, ..)| (at, cell, section.position(at))));
            }
        }
    }

    pub fn finding(&self) -> Finding {
        let (at, position) = self.done.unzip();
        let is_met = self.whole > 0 && (self.is_enough() && at.is_none_or(|at| at <= self.by + ROUNDING));
        let fraction = if self.whole > 0 { self.covered_cells as f64 / self.whole as f64 } else { 0.0 };
        Finding { is_met, at, position, value: Some(fraction) }
    }
}

/// Middle of the square at `index`, in sides of squares from the corner of the grid.
fn middle_of(index: usize, columns: usize) -> DVec2 {
    DVec2::new((index % columns) as f64 + 0.5, (index / columns) as f64 + 0.5)
}

/// Condition: odometry deviates little from the true pose.
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
    fn take(&mut self, surroundings: &Surroundings<'_>) {
        let Some(own) = surroundings.robot(self.robot) else { return };
        let [truth, odometry] = &own.axle;
        for (truth, odometry) in overlaps(truth, odometry) {
            let (sections, to) = ([&truth, &odometry], truth.to);
            let limit = self.max + ROUNDING;
            let within = Between { sections, less: limit * limit };
            if self.violated.is_none() && !self.at_end {
                let mut breaks = Vec::new();
                find_zeros(&within, truth.from, to, &mut breaks);
                let beyond = intervals(&truth, breaks, |t| within.at(t).0 > 0.0);
                let beyond = beyond.into_iter().find(|(.., is_beyond)| *is_beyond);
                self.violated = beyond.map(|(at, ..)| (at, truth.position(at)));
            }
            let error = Negative(Between { sections, less: 0.0 });
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
