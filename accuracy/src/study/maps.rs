//! `maps`: fraction of wrong or unknown cells in maps from sonars, against the computing time of the map.
//!
//! A robot with a ring of twelve sonars, with the noise of the preset `real`, stops at random places of rooms with
//! boxes and makes two scans at each stop, half a sector apart. Five methods of `mapping` build maps from the same
//! readings at exact poses. The error is the fraction of free and surface cells that are wrong or unknown in the map,
//! as a mean over the rooms.

use std::f64::consts::{FRAC_PI_6, TAU};
use std::sync::Arc;

use glam::{DVec2, DVec3};
use mapping::astar;
use mapping::grid::{Cell, Grid, GridGeometry};
use mapping::line::supercover;
use mapping::log_odds::{LogOddsGrid, SonarModel, log_odds};
use mapping::pose::{Point, Pose};
use mapping::score::{Occupancy, Truth};
use mapping::sector::{Fan, Raster, Reading, SectorMap, local_map};
use mapping::sonar::{Beam, Echo};
use mapping::sonar_grid::{NoEcho, SonarGrid};
use sim_core::RobotId;
use sim_core::noise::{RangeErrors, RangeNoise};
use sim_core::pose::Pose3;
use sim_core::scene::{Bounds, Segment, Surface, Walls};
use sim_core::sensor::{RangeModel, Sonar};
use sim_core::time::Time;
use sim_core::world::{Space, World};

use super::{Effort, Outcome, Row, Study, nanoseconds};
use crate::figure::{Figure, Mark, Scale, Series};
use crate::world::{Random, room_with_boxes};

pub const STUDY: Study = Study { name: "maps", title: "Maps from sonars: wrong or unknown cells, against time", run };

/// Numbers of stops with cells of [`CELL`].
const STOPS: [usize; 5] = [1, 3, 10, 30, 100];
/// Side of a cell, m.
const CELL: f64 = 0.05;
/// Compared sides of cells, m.
const CELLS: [f64; 4] = [0.2, 0.1, 0.05, 0.025];
/// Number of stops in the comparison of cell sizes.
const CELL_SIZE_STOPS: usize = 30;
/// Readings at a stop: two scans of [`SONARS`].
const READINGS: usize = 2 * SONARS;
const SONARS: usize = 12;
/// Sonars like those of `robis/sectors.toml`, but on the whole rim.
const FAN: Fan = Fan { sector: FRAC_PI_6, radius: 0.12, nearest: 0.03, farthest: 4.0 };
const BEAM: Beam = Beam { half_angle: 0.5 * FAN.sector, nearest: FAN.nearest, farthest: FAN.farthest };
/// Noise of the sonars in the preset `real`; a test compares it with the preset.
const NOISE: RangeNoise = RangeNoise {
    sigma: 0.005,
    sigma_share: 0.005,
    sigma_per_m: 0.0,
    bias: 0.0,
    bias_sigma: 0.0,
    step: 0.01,
    outlier: 0.002,
    dropout: 0.01,
    drift: 0.0,
    drift_time: 60.0,
    device: 0.0,
};
/// Side of the rooms, m.
const SIDE: f64 = 5.0;
/// Number of boxes in each room.
const BOXES: usize = 5;
const SEED: u64 = 264_100;
const ROOMS: usize = 20;
/// Height of the sonars, m, large enough that the floor returns no echo.
const HEIGHT: f64 = 40.0;

/// A method to build maps: its name, and a function that returns the probabilities of all cells from the readings of
/// all stops.
type Method = (&'static str, fn(&GridGeometry, &[Vec<Reading>]) -> Grid<f64>);

const METHODS: [Method; 5] = [
    ("plain", |frame, stops| plain(frame, stops, NoEcho::Ignored)),
    ("plain, free if no echo", |frame, stops| plain(frame, stops, NoEcho::Free)),
    ("log-odds", |frame, stops| {
        let mut map = LogOddsGrid::new(*frame);
        echoes(stops).for_each(|echo| map.add_echo(echo, &SonarModel::new(BEAM)));
        map.probabilities()
    }),
    ("Wu et al.", |frame, stops| {
        let mut map = SectorMap::new(*frame, FAN, Raster::PointByPoint);
        stops.iter().for_each(|readings| map.add(readings));
        map.probabilities().clone()
    }),
    ("Wu et al., log-odds for Eq. 4", |frame, stops| {
        // Limit of probabilities, since those of the robot's own cells (0) and of the nearest echoes (1) have infinite
        // log-odds.
        const MAX_PROBABILITY: f64 = 0.99;
        let mut map = LogOddsGrid::new(*frame);
        for readings in stops {
            for (cell, probability) in local_map(frame, &FAN, Raster::PointByPoint, readings).iter() {
                map.add(cell, log_odds(probability.clamp(1.0 - MAX_PROBABILITY, MAX_PROBABILITY)));
            }
        }
        map.probabilities()
    }),
];

/// Probabilities of a plain sonar grid.
fn plain(frame: &GridGeometry, stops: &[Vec<Reading>], no_echo: NoEcho) -> Grid<f64> {
    let mut map = SonarGrid::new(*frame, BEAM, no_echo);
    echoes(stops).for_each(|echo| map.add(echo));
    map.probabilities()
}

/// Converts the readings to echoes of the sonars on the rim.
fn echoes(stops: &[Vec<Reading>]) -> impl Iterator<Item = Echo> {
    stops.iter().flatten().map(|reading| {
        let position = reading.axis.outward(Point::new(FAN.radius, 0.0));
        Echo { sonar: Pose { position, ..reading.axis }, distance: reading.distance }
    })
}

fn run(effort: Effort) -> Outcome {
    let rooms: Vec<Room> = (0..effort.of(ROOMS) as u64).map(|number| Room::new(SEED + number)).collect();
    let (mut rows, mut series) = (Vec::new(), Vec::new());
    for (name, build) in METHODS {
        let setting = |stops: usize| if stops == 1 { "1 stop".to_owned() } else { format!("{stops} stops") };
        let stop_rows: Vec<Row> =
            STOPS.iter().map(|stops| row(name, build, &rooms, *stops, CELL, setting(*stops))).collect();
        let readings = STOPS.iter().map(|stops| (stops * READINGS) as f64);
        let points = readings.zip(&stop_rows).map(|(readings, row)| (readings, row.error)).collect();
        series.push(Series { name: name.to_owned(), mark: Mark::LineAndDots, points });
        rows.extend(stop_rows);
    }
    for (name, build) in METHODS {
        let method = format!("{name}, {CELL_SIZE_STOPS} stops");
        rows.extend(CELLS.map(|cell| {
            let setting = format!("cells of {} mm", 1e3 * cell);
            row(&method, build, &rooms, CELL_SIZE_STOPS, cell, setting)
        }));
    }
    let figure = Figure {
        name: "maps-readings".to_owned(),
        title: "Wrong or unknown cells, against the number of readings".to_owned(),
        x_label: "readings".to_owned(),
        y_label: "fraction of cells".to_owned(),
        x_scale: Scale::Logarithmic,
        y_scale: Scale::Logarithmic,
        series,
    };
    Outcome { rows, figures: vec![figure] }
}

fn row(
    method: &str,
    build: fn(&GridGeometry, &[Vec<Reading>]) -> Grid<f64>,
    rooms: &[Room],
    stops: usize,
    cell: f64,
    setting: String,
) -> Row {
    let frame = frame(cell);
    let truths: Vec<Grid<Truth>> = rooms.iter().map(|room| truth(&room.walls, &frame)).collect();
    let mut maps = Vec::new();
    let time_ns = nanoseconds(1, rooms.len(), || {
        maps = rooms.iter().map(|room| build(&frame, &room.stops[..stops])).collect();
    });
    let error =
        maps.iter().zip(&truths).map(|(map, truth)| wrong_fraction(map, truth)).sum::<f64>() / rooms.len() as f64;
    Row { study: STUDY.name, method: method.to_owned(), setting, error, unit: "of the cells", time_ns, per: "map" }
}

/// Fraction of the free and surface cells that are wrong or unknown in a map.
fn wrong_fraction(map: &Grid<f64>, truth: &Grid<Truth>) -> f64 {
    let (mut count, mut right) = (0, 0);
    for (probability, truth) in map.values().iter().zip(truth.values()) {
        let expected = match truth {
            Truth::Free => Occupancy::Free,
            Truth::Surface => Occupancy::Occupied,
            Truth::Hidden => continue,
        };
        count += 1;
        right += usize::from(Occupancy::of(*probability) == expected);
    }
    1.0 - f64::from(right as u32) / f64::from(count as u32)
}

/// Geometry of the grid of a room, with a margin of 22.5 cm: the outer walls go through the centres of cells of 5 cm.
fn frame(cell: f64) -> GridGeometry {
    let margin = 0.2 + 0.5 * CELL;
    GridGeometry::covering(Point::new(-margin, -margin), Point::new(SIDE + margin, SIDE + margin), cell)
}

/// Ground truth: the largest connected region of cells without a wall is free, and wall cells next to it are surfaces.
fn truth(walls: &[Segment], frame: &GridGeometry) -> Grid<Truth> {
    let mut is_wall = Grid::new(*frame, false);
    for wall in walls {
        for cell in supercover(frame, Point::new(wall.a.x, wall.a.y), Point::new(wall.b.x, wall.b.y)) {
            is_wall[cell] = true;
        }
    }
    // Cells outside the outer walls are excluded.
    let inside = |cell: Cell| {
        let centre = frame.centre(cell);
        (0.0..SIDE).contains(&centre.x) && (0.0..SIDE).contains(&centre.y)
    };
    let mut region = Grid::new(*frame, false);
    let mut visited = Grid::new(*frame, false);
    let mut max_count = 0;
    for start in frame.cells().filter(|cell| inside(*cell)) {
        if is_wall[start] || visited[start] {
            continue;
        }
        let costs = astar::costs(frame, |cell| (inside(cell) && !is_wall[cell]).then_some(1.0), start);
        let connected = costs.map(|cost| cost.is_finite());
        for (visited, connected) in visited.values_mut().iter_mut().zip(connected.values()) {
            *visited |= connected;
        }
        let count = connected.values().iter().filter(|is_connected| **is_connected).count();
        if count > max_count {
            (max_count, region) = (count, connected);
        }
    }
    Grid::from_fn(*frame, |cell| {
        if region[cell] {
            Truth::Free
        } else if is_wall[cell] && frame.neighbours(cell).any(|next| region[next]) {
            Truth::Surface
        } else {
            Truth::Hidden
        }
    })
}

/// A room with the readings of its stops.
struct Room {
    walls: Vec<Segment>,
    stops: Vec<Vec<Reading>>,
}

impl Room {
    fn new(seed: u64) -> Self {
        let walls = room_with_boxes(seed, DVec2::ZERO, SIDE, BOXES);
        let space = Space { floor: None, walls: vec![Surface::ROUGH; walls.len()], ..Space::default() };
        let world = World::new(Arc::new(Walls::new(walls.clone())), Time::from_millis(50), std::iter::empty());
        let world = world.with_space(space);
        let max_stops = STOPS[STOPS.len() - 1];
        let frame = frame(CELL);
        let truth = truth(&walls, &frame);
        let bounds = Bounds { min: DVec2::ZERO, max: DVec2::splat(SIDE) };
        let mut random = Random::new(seed);
        let mut stops = Vec::new();
        while stops.len() < max_stops {
            let position = random.point_in(bounds);
            let heading = random.between(0.0, TAU);
            let is_free = truth.at(Point::new(position.x, position.y)) == Some(&Truth::Free);
            if is_free && walls.iter().all(|wall| distance(wall, position) > FAN.radius + 0.03) {
                stops.push(stop(&world, seed, stops.len(), position, heading));
            }
        }
        Self { walls, stops }
    }
}

/// Distance of a point from a wall, m.
fn distance(wall: &Segment, point: DVec2) -> f64 {
    let along = wall.b - wall.a;
    let fraction = ((point - wall.a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    (wall.a + fraction * along - point).length()
}

/// Readings of a stop: two scans, the second after a turn by half a sector.
fn stop(world: &World, seed: u64, number: usize, position: DVec2, heading: f64) -> Vec<Reading> {
    let sonar = Sonar { half_angle: BEAM.half_angle, max: FAN.farthest, ..Sonar::srf08() };
    let reading = |index: usize| {
        let (scan, sonar_index) = (index / SONARS, index % SONARS);
        let axis = Pose::new(position.x, position.y, heading + FAN.sector * (sonar_index as f64 + 0.5 * scan as f64));
        let rim = axis.outward(Point::new(FAN.radius, 0.0));
        let pose = Pose3::from_angles(DVec3::new(rim.x, rim.y, HEIGHT), 0.0, 0.0, axis.heading);
        let exact = RangeModel::Sonar(sonar).read(&world.caster(RobotId(1), Time::ZERO), &pose, 0.0).distance;
        let errors = RangeErrors::new(NOISE, seed, RobotId(1), &format!("SONAR_{sonar_index}"));
        let event = (2 * number + scan) as u64;
        Reading { axis, distance: errors.reading(event, Time::ZERO, [FAN.nearest, FAN.farthest], exact) }
    };
    (0..READINGS).map(reading).collect()
}

#[cfg(test)]
mod tests {
    use sim_core::noise::RangeKind;

    use super::*;

    #[test]
    fn noise_matches_the_preset() {
        let real = sim_format::preset("real").expect("a preset").profile();
        assert_eq!(real.range(RangeKind::Sonar, ""), NOISE);
    }

    #[test]
    fn truth_of_a_box_matches_a_count_by_hand() {
        let corners = [(1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0)].map(|(x, y)| DVec2::new(x + 0.05, y + 0.05));
        let mut walls: Vec<Segment> = (0..4).map(|side| Segment::new(corners[side], corners[(side + 1) % 4])).collect();
        let outer = [(0.0, 0.0), (SIDE, 0.0), (SIDE, SIDE), (0.0, SIDE)].map(|(x, y)| DVec2::new(x, y));
        walls.extend((0..4).map(|side| Segment::new(outer[side], outer[(side + 1) % 4])));
        let truth = truth(&walls, &frame(CELL));
        let count = |kind| truth.values().iter().filter(|truth| **truth == kind).count();
        // 99 by 99 cells between the walls are free, except for a box of 21 by 21 cells, whose inside is hidden.
        assert_eq!(count(Truth::Free), 99 * 99 - 21 * 21);
        assert_eq!(count(Truth::Surface), 4 * 100 + 4 * 20);
        assert_eq!(truth.at(Point::new(1.5, 1.5)), Some(&Truth::Hidden));
    }

    #[test]
    fn wrong_fraction_counts_wrong_and_unknown_cells() {
        let frame = GridGeometry::new(Point::origin(), 1.0, 4, 1);
        let truth = Grid::from_fn(frame, |cell| [Truth::Free, Truth::Free, Truth::Surface, Truth::Hidden][cell.column]);
        let fraction = |values: [f64; 4]| wrong_fraction(&Grid::from_fn(frame, |cell| values[cell.column]), &truth);
        assert_eq!(fraction([0.0, 0.1, 0.9, 0.0]), 0.0);
        assert!((fraction([0.5, 0.1, 0.1, 1.0]) - 2.0 / 3.0).abs() < 1e-12);
    }

    #[test]
    fn more_readings_reduce_the_error() {
        let rooms = [Room::new(SEED)];
        for (name, build) in METHODS {
            let [one, many] = [1, 30].map(|stops| row(name, build, &rooms, stops, CELL, String::new()).error);
            assert!(one > 0.5 && many < 0.5 * one, "{name}: {one}, {many}");
        }
    }
}
