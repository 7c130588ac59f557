//! Maps a room with seven ultrasonic sensors, by lines between neighbouring readings (Wu et al. 2013).
//!
//! At each stop the robot observes its surroundings. If it finds a fault, it turns by half a sector and observes again.
//! Then it turns around, does the same behind, and adds all readings to its map. It then drives to the nearest position
//! from which it can see unknown cells, and ends when there is none.
//!
//! Arguments: minimum x, minimum y, maximum x, maximum y of the map, and the size of a cell, all in mm. The frame is
//! that of the start: x ahead, y to the left. Default: 4 m to each side, cells of 50 mm.
//!
//! It prints `look` with each [`Scan`], `stop` for each stop, and at the end the map as `row`s, the upper one first:
//! `#` occupied, `.` free, `?` unknown. The display shows the map; the window also shows its probabilities and the path
//! to the next stop.

mod plan;

use std::f64::consts::{FRAC_PI_6, PI};

use mapping::grid::{Cell, GridGeometry};
use mapping::pose::{Point, Pose};
use mapping::score::Occupancy;
use mapping::sector::{Fan, Raster, Reading, Scan, SectorMap};
use robios_api::{Drive, LayerFrame, LayerGrid, Psd, prelude::*};

use plan::Plan;

robios_api::program!(main);

/// Sonars of the robot `sectors`.
const FAN: Fan = Fan { sector: FRAC_PI_6, radius: 0.12, nearest: 0.03, farthest: 4.0 };
/// The sonars, from right to left.
const SONARS: [PsdAt; 7] = [
    PsdAt::Other(1),
    PsdAt::Other(2),
    PsdAt::Other(3),
    PsdAt::Other(4),
    PsdAt::Other(5),
    PsdAt::Other(6),
    PsdAt::Other(7),
];
/// Index of the sonar that looks ahead.
const AHEAD: usize = 3;
/// Two sonar cycles of 60 ms: the first may have begun before the robot stood still, the second began afterwards.
const TWO_CYCLES: Duration = Duration::from_millis(120);
/// Angle by which the robot turns to observe a fault again: half a sector.
const AGAIN: f64 = 0.5 * FAN.sector;
/// Distance ahead below which the robot stops while it drives.
const NEAR: Length = Length::metres(0.06);
/// Distance by which the robot backs off after such a stop.
const BACK: Length = Length::metres(0.08);
const SPEED: Speed = Speed::metres_per_second(0.3);
const TURN: TurnRate = TurnRate::radians_per_second(1.5);
/// Maximum number of stops.
const STOPS: usize = 80;

fn main(robot: &Robot) -> Result<(), Box<dyn std::error::Error>> {
    let mut mapper = Mapper {
        robot,
        drive: robot.drive()?,
        sonars: robot.psds(SONARS)?,
        map: SectorMap::new(frame(robot.arguments())?, FAN, Raster::PointByPoint),
        bumps: Vec::new(),
    };
    let mut been = Vec::new();
    while been.len() < STOPS {
        let here = mapper.observe()?;
        been.push(here);
        writeln!(robot.console(), "stop {} {:?} {:?}", been.len(), here.x, here.y);
        mapper.show();
        mapper.show_layer()?;
        let Some(path) = Plan::new(mapper.map.probabilities(), &mapper.bumps).next(here, &been) else { break };
        let way: Vec<[f64; 2]> = path.iter().map(|point| [point.x, point.y]).collect();
        robot.layers().line("path", LayerFrame::Odometry, &way)?;
        mapper.follow(&path)?;
    }
    mapper.print();
    Ok(())
}

/// Geometry of the grid of the map, from the arguments.
fn frame(arguments: &[String]) -> Result<GridGeometry, String> {
    let numbers: Vec<f64> = arguments.iter().filter_map(|argument| argument.parse().ok()).collect();
    let [x0, y0, x1, y1, cell] = match (arguments.len(), &numbers[..]) {
        (0, _) => [-4000.0, -4000.0, 4000.0, 4000.0, 50.0],
        (5, &[x0, y0, x1, y1, cell]) if x1 > x0 && y1 > y0 && cell > 0.0 => [x0, y0, x1, y1, cell],
        _ => return Err(format!("`{}`: expected X0 Y0 X1 Y1 CELL in mm", arguments.join(" "))),
    };
    Ok(GridGeometry::covering(Point::new(x0 / 1e3, y0 / 1e3), Point::new(x1 / 1e3, y1 / 1e3), cell / 1e3))
}

/// The robot with its map.
struct Mapper<'r> {
    robot: &'r Robot,
    drive: Drive,
    sonars: [Psd; 7],
    map: SectorMap,
    /// Positions of the obstacles that stopped the robot although they are not on the map.
    bumps: Vec<Point>,
}

impl Mapper<'_> {
    /// Observes all around, adds the readings to the map, and returns the robot's position.
    fn observe(&mut self) -> Result<Point> {
        let mut readings = self.scan_twice()?;
        self.turn(PI)?;
        readings.extend(self.scan_twice()?);
        self.map.add(&readings);
        Ok(self.pose().position)
    }

    /// Observes ahead, and again turned by half a sector if there is a fault; restores the heading.
    fn scan_twice(&self) -> Result<Vec<Reading>> {
        let first = self.scan();
        let mut readings: Vec<Reading> = first.readings(FAN.sector).collect();
        if first.has_fault(&FAN) {
            self.turn(AGAIN)?;
            readings.extend(self.scan().readings(FAN.sector));
            self.turn(-AGAIN)?;
        }
        Ok(readings)
    }

    /// Reads and prints all sonars.
    fn scan(&self) -> Scan {
        self.robot.sleep(TWO_CYCLES);
        let distances = self.sonars.iter().map(|sonar| sonar.distance().map(Length::as_metres)).collect();
        let scan = Scan { robot: self.pose(), distances };
        writeln!(self.robot.console(), "look {scan}");
        scan
    }

    fn pose(&self) -> Pose {
        let position = self.drive.position();
        Pose::new(position.x.as_metres(), position.y.as_metres(), position.phi.as_radians())
    }

    fn turn(&self, angle: f64) -> Result {
        self.drive.turn(Angle::radians(angle), TURN)?.wait()
    }

    /// Drives from point to point; stops and backs off at an obstacle that is not on the map.
    fn follow(&mut self, path: &[Point]) -> Result {
        for point in path {
            let pose = self.pose();
            let to = *point - pose.position;
            self.turn(mapping::pose::wrapped(mapping::math::atan2(to.y, to.x) - pose.heading))?;
            self.drive.straight(Length::metres(to.norm()), SPEED)?;
            while !self.drive.is_done() {
                if self.sonars[AHEAD].distance().is_some_and(|ahead| ahead < NEAR) || self.drive.is_stalled() {
                    return self.back_off();
                }
                self.robot.sleep(Duration::from_millis(20));
            }
        }
        Ok(())
    }

    /// Records an obstacle ahead and backs off.
    fn back_off(&mut self) -> Result {
        self.drive.stop()?;
        self.bumps.push(self.pose().outward(Point::new(FAN.radius, 0.0)));
        self.drive.straight(-BACK, SPEED)?.wait()
    }

    fn said(&self, cell: Cell) -> char {
        match Occupancy::of(self.map.probabilities()[cell]) {
            Occupancy::Free => '.',
            Occupancy::Occupied => '#',
            Occupancy::Unknown => '?',
        }
    }

    /// Prints the map.
    fn print(&self) {
        let frame = *self.map.probabilities().frame();
        for row in (0..frame.rows()).rev() {
            let text: String = (0..frame.columns()).map(|column| self.said(Cell { column, row })).collect();
            writeln!(self.robot.console(), "row {text}");
        }
    }

    /// Shows the map in the window; a probability of one half, the prior, is unknown.
    fn show_layer(&self) -> Result {
        let probabilities = self.map.probabilities();
        let frame = probabilities.frame();
        let cell = |probability: &f64| match *probability {
            0.5 => LayerGrid::UNKNOWN,
            probability => LayerGrid::cell_of(probability),
        };
        let cells: Vec<u8> = probabilities.values().iter().map(cell).collect();
        let corner = [frame.origin().x, frame.origin().y].map(Length::metres);
        let cell = Length::metres(frame.cell_size());
        let grid = LayerGrid { corner, cell, columns: frame.columns(), cells: &cells };
        self.robot.layers().grid("map", LayerFrame::Odometry, &grid)
    }

    /// Shows the map on the display, scaled to fit: occupied cells black, unknown ones as a checkerboard.
    fn show(&self) {
        const WIDTH: usize = 128;
        const HEIGHT: usize = 64;
        let frame = *self.map.probabilities().frame();
        let cells = frame.columns().div_ceil(WIDTH).max(frame.rows().div_ceil(HEIGHT));
        let mut image = [0; WIDTH * HEIGHT / 8];
        for y in 0..frame.rows().div_ceil(cells) {
            for x in 0..frame.columns().div_ceil(cells) {
                let mut said = (0..cells * cells)
                    .map(|index| Cell::new(x * cells + index % cells, y * cells + index / cells))
                    .filter(|&cell| frame.has(cell))
                    .map(|cell| self.said(cell));
                let is_black = said.clone().any(|said| said == '#') || (x + y) % 2 == 0 && said.all(|said| said == '?');
                let row = HEIGHT - 1 - y;
                image[(row * WIDTH + x) / 8] |= u8::from(is_black) << (7 - x % 8);
            }
        }
        self.robot.lcd().put_image(&image);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_frame_is_given_in_millimetres() {
        let words = |text: &str| text.split(' ').map(str::to_owned).collect::<Vec<_>>();
        let told = frame(&words("-500 0 1500 1000 100")).expect("a frame");
        assert_eq!((told.columns(), told.rows(), told.origin()), (20, 10, Point::new(-0.5, 0.0)));
        assert!(frame(&words("1 2 3")).is_err() && frame(&words("0 0 100 x 50")).is_err());
        assert!(frame(&words("0 0 -100 100 50")).is_err());
        assert_eq!(frame(&[]).expect("the default").columns(), 160);
    }
}
