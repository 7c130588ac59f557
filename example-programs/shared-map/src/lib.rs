//! Three robots map a maze of three lanes together, over a radio that loses and garbles messages.
//!
//! Each robot drives along the lane of its number, counted from the lowest, and senses the walls at both sides of every
//! cell. It sends its findings to every other robot until that robot acknowledges them (stop-and-wait). A checksum
//! detects garbled messages, which count as lost. In the end all robots have the same map. The window shows the map as
//! it grows.

mod link;

use robios_api::prelude::*;
use robios_api::{LayerFrame, LayerGrid, RobotNumber};

use link::{Link, Walls};

robios_api::program!(main);

/// Number of lanes, and of robots.
const LANES: u8 = 3;
const COLUMNS: u8 = 8;
const CELL: Length = Length::millimetres(360.0);
/// Threshold for a wall at the side, for a sensor 80 mm off the robot's centre; a robot in the next lane is farther
/// away.
const NEAR: Length = Length::millimetres(140.0);

/// Known walls, lane by lane.
type Map = [[Option<Walls>; COLUMNS as usize]; LANES as usize];

fn main(robot: &Robot) -> Result {
    let drive = robot.drive()?;
    let [left, right] = robot.psds([PsdAt::Left, PsdAt::Right])?;
    let is_near = |psd: &Psd| psd.distance().is_some_and(|distance| distance < NEAR);
    let me = robot.id();
    let lane = me.0 - 1;
    let mut link = Link::new(robot.radio()?, (1..=LANES).map(RobotNumber).filter(|other| *other != me));
    let mut map = Map::default();

    for column in 0..COLUMNS {
        // The sensors measure every 60 ms.
        link.serve(robot, 100.millis(), &mut map)?;
        let walls = Walls { left: is_near(&left), right: is_near(&right) };
        map[usize::from(lane)][usize::from(column)] = Some(walls);
        link.queue_report(lane, column, walls);
        show(robot, lane, &map)?;
        if column + 1 < COLUMNS {
            drive.straight(CELL, 0.2.metres_per_second())?;
            while !drive.is_done() {
                link.serve(robot, 50.millis(), &mut map)?;
            }
        }
    }
    while link.is_unacknowledged() || map.as_flattened().contains(&None) {
        link.serve(robot, 50.millis(), &mut map)?;
        show(robot, lane, &map)?;
    }
    for (lane, cells) in map.iter().enumerate() {
        writeln!(robot.console(), "lane {lane} {}", shown(cells));
    }
    // The others may still wait for an acknowledgement that was lost.
    link.serve_until_silent(robot, 3.seconds(), &mut map)?;
    writeln!(robot.console(), "{} repeats, {} garbled", link.repeats(), link.garbled());
    Ok(())
}

/// Shows the map in the window, in the frame of odometry, whose origin is the centre of the first cell of the robot's
/// own lane. Each cell of the maze is a square of smaller cells. The outer ones at its sides show the walls.
fn show(robot: &Robot, own_lane: u8, map: &Map) -> Result {
    const SQUARE: usize = 9;
    let row = |row: usize| {
        let (cells, at) = (&map[row / SQUARE], row % SQUARE);
        cells.iter().flat_map(move |cell| [shade(*cell, at == 0, at == SQUARE - 1); SQUARE])
    };
    let cells: Vec<u8> = (0..SQUARE * usize::from(LANES)).flat_map(row).collect();
    let corner = [CELL * -0.5, CELL * (-0.5 - f64::from(own_lane))];
    let grid = LayerGrid { corner, cell: CELL / SQUARE as f64, columns: SQUARE * usize::from(COLUMNS), cells: &cells };
    robot.layers().grid("map", LayerFrame::Odometry, &grid)
}

/// A small cell of the grid in the window, at the right or the left side of a cell of the maze.
fn shade(cell: Option<Walls>, is_right: bool, is_left: bool) -> u8 {
    match cell {
        None => LayerGrid::UNKNOWN,
        Some(walls) => 100 * u8::from(walls.right && is_right || walls.left && is_left),
    }
}

/// A lane as text: `=` for walls at both sides, `'` at the left, `.` at the right, `-` for none.
fn shown(cells: &[Option<Walls>]) -> String {
    let mark = |cell: &Option<Walls>| match cell {
        Some(Walls { left: true, right: true }) => '=',
        Some(Walls { left: true, right: false }) => '\'',
        Some(Walls { left: false, right: true }) => '.',
        Some(Walls { left: false, right: false }) => '-',
        None => '?',
    };
    cells.iter().map(mark).collect()
}
