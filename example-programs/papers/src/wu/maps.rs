//! A run of the robot, and the maps made from its readings.

use std::f64::consts::FRAC_PI_6;
use std::path::Path;

use anyhow::{Context as _, bail, ensure};
use mapping::astar;
use mapping::grid::{Grid, GridGeometry};
use mapping::line::supercover;
use mapping::log_odds::{LogOddsGrid, SonarModel, log_odds};
use mapping::math;
use mapping::pose::{Point, Pose, wrapped};
use mapping::score::{Occupancy, Score, Truth};
use mapping::sector::{Fan, Raster, Reading, Relation, Scan, SectorMap, local_map};
use mapping::sonar::{Beam, Echo};
use mapping::sonar_grid::{NoEcho, SonarGrid};
use sim_core::spec::SceneSpec;
use sim_format::load_scene;
use sim_host::files::DiskFiles;

use crate::run::root;
use crate::trace::{Event, Trace};

/// Sonars of the robot `sectors`, as in `robis/sectors.toml`.
pub const FAN: Fan = Fan { sector: FRAC_PI_6, radius: 0.12, nearest: 0.03, farthest: 4.0 };
const BEAM: Beam = Beam { half_angle: 0.5 * FAN.sector, nearest: FAN.nearest, farthest: FAN.farthest };

/// Algorithm of a map.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum MapMethod {
    /// The paper's map, with lines drawn by point-by-point comparison.
    Wu,
    /// The paper's map, with lines drawn by DDA.
    WuDda,
    /// The paper's local grids, added as log-odds instead of by Eq. 4.
    WuLogOdds,
    /// The plain sonar grid; a missing echo gives no information.
    Plain,
    /// The plain sonar grid; a missing echo means free.
    PlainFree,
    /// Log-odds of cones and arcs.
    LogOdds,
}

impl MapMethod {
    /// All algorithms, in the order of the tables.
    pub const ALL: [Self; 6] = [Self::Wu, Self::WuDda, Self::WuLogOdds, Self::Plain, Self::PlainFree, Self::LogOdds];

    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wu => "Wu et al.",
            Self::WuDda => "Wu et al., DDA",
            Self::WuLogOdds => "Wu et al., log-odds for Eq. 4",
            Self::Plain => "plain",
            Self::PlainFree => "plain, free if no echo",
            Self::LogOdds => "log-odds",
        }
    }
}

/// A run and its maps, all in the frame of the robot's start.
pub struct Mapped {
    /// Name of the run.
    pub name: String,
    /// Ground truth.
    pub truth: Grid<Truth>,
    /// Estimated positions of the robot at its observations.
    pub stops: Vec<Point>,
    /// Number of scans: instants at which the robot read all its sonars.
    pub scans: usize,
    /// Virtual time at which the robot's program ended, s.
    pub time: f64,
    /// Length of the robot's path, m.
    pub path: f64,
    /// Number of contacts.
    pub contacts: usize,
    /// Error of the robot's odometry at the end: m, rad.
    pub odometry_error: (f64, f64),
    printed: Vec<String>,
    readings: Vec<Vec<Reading>>,
    neighbours: Vec<(f64, f64)>,
    maps: [Grid<Occupancy>; 6],
}

impl Mapped {
    /// Reads the output of a run of the scene `file` from its trace, and makes all maps of the run.
    ///
    /// # Errors
    /// If the scene cannot be read, or the robot printed no scans or no map with the frame that the scene's arguments
    /// give.
    pub fn new(name: &str, file: &Path, trace: &Trace) -> anyhow::Result<Self> {
        let mut files = DiskFiles::with_home(root());
        let path = files.name(&root().join(file));
        let loaded = load_scene(&path, &files);
        ensure!(!loaded.has_errors(), "`{path}` has mistakes");
        let (frame, start) = frame(&loaded.scene)?;
        let walls = loaded.scene.world.walls.iter();
        let walls = walls.map(|wall| [wall.from, wall.to].map(|end| start.inward(Point::new(end.x, end.y))));
        let mut run = Self {
            name: name.to_owned(),
            truth: truth(walls, &frame),
            stops: Vec::new(),
            scans: 0,
            time: 0.0,
            path: 0.0,
            contacts: 0,
            odometry_error: (0.0, 0.0),
            printed: Vec::new(),
            readings: Vec::new(),
            neighbours: Vec::new(),
            maps: std::array::from_fn(|_| Grid::new(frame, Occupancy::Unknown)),
        };
        run.read_output(trace)?;
        run.read_motion(trace, &start);
        run.maps = MapMethod::ALL.map(|kind| run.map(kind, &frame));
        Ok(run)
    }

    /// The cells as the map classifies them.
    pub fn cells(&self, kind: MapMethod) -> &Grid<Occupancy> {
        &self.maps[kind as usize]
    }

    /// Score of a map against the ground truth.
    pub fn score(&self, kind: MapMethod) -> Score {
        Score::of(self.cells(kind), &self.truth)
    }

    /// Number of cells in which two maps differ.
    pub fn differing(&self, a: MapMethod, b: MapMethod) -> usize {
        self.cells(a).values().iter().zip(self.cells(b).values()).filter(|(a, b)| a != b).count()
    }

    /// Number of cells in which the map of the robot's program differs from our map by the same algorithm.
    pub fn differing_cells(&self) -> usize {
        let frame = self.truth.frame();
        let own = |cell: mapping::grid::Cell| {
            let row = self.printed.get(frame.rows() - 1 - cell.row)?;
            row.chars().nth(cell.column)
        };
        let is_other = |(cell, class): &(mapping::grid::Cell, &Occupancy)| {
            own(*cell)
                != Some(match class {
                    Occupancy::Free => '.',
                    Occupancy::Occupied => '#',
                    Occupancy::Unknown => '?',
                })
        };
        self.cells(MapMethod::Wu).iter().filter(is_other).count()
    }

    /// Counts pairs of neighbouring sonars that both have an echo: the continuous pairs, the continuous pairs by the
    /// printed condition, and all pairs.
    pub fn continuous_pairs(&self) -> (usize, usize, usize) {
        let is_continuous = |&&(a, b): &&(f64, f64)| FAN.relation(Some(a), Some(b)) == Relation::Continuous;
        let as_printed = |&&(a, b): &&(f64, f64)| {
            let (near, far) = (a.min(b) + FAN.radius, a.max(b) + FAN.radius);
            far <= near * math::cos(FAN.sector)
        };
        let pairs = &self.neighbours;
        (pairs.iter().filter(is_continuous).count(), pairs.iter().filter(as_printed).count(), pairs.len())
    }

    /// Three counts of free cells that the map classifies as occupied: the cells that more stops classified as free
    /// than as occupied, all cells, and the cells of the first count that log-odds of the same local grids correct.
    pub fn stuck(&self) -> (usize, usize, usize) {
        let frame = *self.truth.frame();
        let mut votes = Grid::new(frame, (0_u32, 0_u32));
        for readings in &self.readings {
            let local = local_map(&frame, &FAN, Raster::PointByPoint, readings);
            for ((occupied, free), probability) in votes.values_mut().iter_mut().zip(local.values()) {
                match Occupancy::of(*probability) {
                    Occupancy::Occupied => *occupied += 1,
                    Occupancy::Free => *free += 1,
                    Occupancy::Unknown => {}
                }
            }
        }
        let wrong = |kind| {
            let cells = self.cells(kind);
            frame.cells().filter(move |cell| cells[*cell] == Occupancy::Occupied && self.truth[*cell] == Truth::Free)
        };
        let is_stuck = |cell: &mapping::grid::Cell| votes[*cell].1 > votes[*cell].0;
        let log_odds = self.cells(MapMethod::WuLogOdds);
        let stuck: Vec<_> = wrong(MapMethod::Wu).filter(is_stuck).collect();
        let corrected = stuck.iter().filter(|cell| log_odds[**cell] != Occupancy::Occupied).count();
        (stuck.len(), wrong(MapMethod::Wu).count(), corrected)
    }

    /// Reads the output of the robot's program.
    fn read_output(&mut self, trace: &Trace) -> anyhow::Result<()> {
        let mut readings = Vec::new();
        for (_, line) in trace.printed(1) {
            for line in line.lines() {
                match line.split_once(' ') {
                    Some(("look", scan)) => {
                        let scan: Scan = scan.parse()?;
                        self.scans += 1;
                        let pairs = scan.distances.windows(2).filter_map(|pair| Some((pair[0]?, pair[1]?)));
                        self.neighbours.extend(pairs);
                        readings.extend(scan.readings(FAN.sector));
                    }
                    Some(("stop", stop)) => {
                        let numbers: Vec<f64> = stop.split(' ').filter_map(|word| word.parse().ok()).collect();
                        let [_, x, y] = numbers[..] else { bail!("`{line}`: expected a number, x and y") };
                        self.stops.push(Point::new(x, y));
                        self.readings.push(std::mem::take(&mut readings));
                    }
                    Some(("row", row)) => self.printed.push(row.to_owned()),
                    _ => bail!("`{line}`: expected `look`, `stop` or `row`"),
                }
            }
        }
        ensure!(self.printed.len() == self.truth.frame().rows(), "the robot printed {} rows", self.printed.len());
        Ok(())
    }

    /// Reads the true motion of the robot.
    fn read_motion(&mut self, trace: &Trace, start: &Pose) {
        let mut at = *start;
        let mut odometry = None;
        for entry in trace.of_robot(1) {
            match &entry.event {
                Event::Pose { x_m, y_m, phi_rad } => {
                    let next = Pose::new(*x_m, *y_m, *phi_rad);
                    self.path += (next.position - at.position).norm();
                    at = next;
                }
                Event::Odometry { x_m, y_m, phi_rad } => odometry = Some((Pose::new(*x_m, *y_m, *phi_rad), at)),
                Event::Contact => self.contacts += 1,
                Event::ProgramEnded => self.time = entry.at,
                _ => {}
            }
        }
        if let Some((odometry, _)) = odometry {
            let odometry = start.then(&odometry);
            self.odometry_error = ((odometry.position - at.position).norm(), wrapped(odometry.heading - at.heading));
        }
    }

    /// Makes a map of the readings.
    fn map(&self, kind: MapMethod, frame: &GridGeometry) -> Grid<Occupancy> {
        let probabilities = match kind {
            MapMethod::Wu => self.wu(frame, Raster::PointByPoint),
            MapMethod::WuDda => self.wu(frame, Raster::Dda),
            MapMethod::WuLogOdds => self.wu_log_odds(frame),
            MapMethod::Plain => self.plain(frame, NoEcho::Ignored),
            MapMethod::PlainFree => self.plain(frame, NoEcho::Free),
            MapMethod::LogOdds => {
                let mut map = LogOddsGrid::new(*frame);
                self.echoes().for_each(|echo| map.add_echo(echo, &SonarModel::new(BEAM)));
                map.probabilities()
            }
        };
        probabilities.map(|probability| Occupancy::of(*probability))
    }

    fn wu(&self, frame: &GridGeometry, raster: Raster) -> Grid<f64> {
        let mut map = SectorMap::new(*frame, FAN, raster);
        self.readings.iter().for_each(|readings| map.add(readings));
        map.probabilities().clone()
    }

    fn wu_log_odds(&self, frame: &GridGeometry) -> Grid<f64> {
        // Limits the evidence of one stop: probabilities of 0 and 1, as under the robot, have infinite log-odds.
        const SUREST: f64 = 0.99;
        let mut map = LogOddsGrid::new(*frame);
        for readings in &self.readings {
            let local = local_map(frame, &FAN, Raster::PointByPoint, readings);
            for (cell, probability) in local.iter() {
                map.add(cell, log_odds(probability.clamp(1.0 - SUREST, SUREST)));
            }
        }
        map.probabilities()
    }

    fn plain(&self, frame: &GridGeometry, no_echo: NoEcho) -> Grid<f64> {
        let mut map = SonarGrid::new(*frame, BEAM, no_echo);
        self.echoes().for_each(|echo| map.add(echo));
        map.probabilities()
    }

    /// The readings as echoes of sonars on the robot's rim.
    fn echoes(&self) -> impl Iterator<Item = Echo> {
        self.readings.iter().flatten().map(|reading| {
            let position = reading.axis.outward(Point::new(FAN.radius, 0.0));
            Echo { sonar: Pose { position, ..reading.axis }, distance: reading.distance }
        })
    }
}

/// The frame of the map, and the pose of the robot's start, in the world.
fn frame(scene: &SceneSpec) -> anyhow::Result<(GridGeometry, Pose)> {
    let robot = scene.robots.first().context("a scene without a robot")?;
    let numbers: Vec<f64> = robot.arguments.iter().filter_map(|argument| argument.parse().ok()).collect();
    let [x0, y0, x1, y1, cell] = numbers[..] else { bail!("`{}`: expected five numbers", robot.arguments.join(" ")) };
    let frame = GridGeometry::covering(Point::new(x0 / 1e3, y0 / 1e3), Point::new(x1 / 1e3, y1 / 1e3), cell / 1e3);
    let start = &robot.start;
    Ok((frame, Pose::new(start.position.x, start.position.y, start.heading.radians())))
}

/// Ground truth from the walls, in the frame of the start. A cell is free if it can be reached from the start without
/// crossing a wall. A wall cell with a free neighbour is a surface. All other cells are hidden.
pub fn truth(walls: impl Iterator<Item = [Point; 2]>, frame: &GridGeometry) -> Grid<Truth> {
    let mut is_wall = Grid::new(*frame, false);
    for [from, to] in walls {
        for cell in supercover(frame, from, to) {
            is_wall[cell] = true;
        }
    }
    let Some(begin) = frame.cell_at(Point::origin()) else { return Grid::new(*frame, Truth::Hidden) };
    let free = astar::costs(frame, |cell| (!is_wall[cell]).then_some(1.0), begin);
    Grid::from_fn(*frame, |cell| {
        if free[cell].is_finite() {
            Truth::Free
        } else if is_wall[cell] && frame.neighbours(cell).any(|next| free[next].is_finite()) {
            Truth::Surface
        } else {
            Truth::Hidden
        }
    })
}
