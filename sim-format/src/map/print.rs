//! Printing of occupancy grids as `map.yaml`, PGM and PBM, and of scenarios as suites.

use std::fmt::Write as _;

use super::grid::{Cell, Grid};
use super::movingai::Scenario;
use super::rounded_mm;
use super::yaml::{FREE_THRESHOLD, OCCUPIED_THRESHOLD};
use crate::print::number::{written, written_mm};

/// Grey value of free cells, as in map_saver of ROS.
const FREE: u8 = 254;
const UNKNOWN: u8 = 205;
const OCCUPIED: u8 = 0;

/// Text of the `map.yaml` of a grid whose image is in the file `image`.
pub(crate) fn map_yaml(grid: &Grid, image: &str) -> String {
    let [x, y] = grid.origin.position.to_array().map(|side| written(side + 0.0));
    let yaw = written(grid.origin.heading.radians());
    let resolution = written(grid.cell);
    let is_plain = image.chars().all(|c| c.is_alphanumeric() || matches!(c, '.' | '-' | '_'));
    let image = if is_plain && !image.starts_with('-') { image.to_owned() } else { format!("\"{image}\"") };
    format!(
        "image: {image}\nmode: trinary\nresolution: {resolution}\norigin: [{x}, {y}, {yaw}]\nnegate: 0\n\
         occupied_thresh: {OCCUPIED_THRESHOLD}\nfree_thresh: {FREE_THRESHOLD}\n"
    )
}

/// The image of a grid: a bitmap (`P4`), in which cells that are not free are black, or a PGM (`P5`).
pub(crate) fn image_file(grid: &Grid, is_bitmap: bool) -> Vec<u8> {
    let [columns, rows] = grid.size;
    let header = if is_bitmap { format!("P4\n{columns} {rows}\n") } else { format!("P5\n{columns} {rows}\n255\n") };
    let mut bytes = header.into_bytes();
    for row in (0..rows).rev() {
        let cells = &grid.cells[row * columns..(row + 1) * columns];
        if is_bitmap {
            let black = |cell: &Cell| u8::from(*cell != Cell::Free);
            let byte =
                |cells: &[Cell]| cells.iter().zip((0..8).rev()).fold(0, |byte, (cell, bit)| byte | black(cell) << bit);
            bytes.extend(cells.chunks(8).map(byte));
        } else {
            bytes.extend(cells.iter().map(|cell| match cell {
                Cell::Free => FREE,
                Cell::Occupied => OCCUPIED,
                Cell::Unknown => UNKNOWN,
            }));
        }
    }
    bytes
}

/// Texts of a scene and of a suite in which a robot drives the `scenarios` of one map, whose cells have the side `cell`
/// in metres.
///
/// `map` and `scene` are the names of their files.
pub(crate) fn suite_of_scenarios(scenarios: &[Scenario], map: &str, scene: &str, cell: f64) -> [String; 2] {
    let rows = scenarios.first().map_or(1, |scenario| scenario.size[1]);
    let position_mm = |[column, row]: [usize; 2]| {
        [column as f64 + 0.5, rows as f64 - row as f64 - 0.5].map(|side| written(rounded_mm(side * cell)))
    };
    let cell_mm = written_mm(cell);
    let [map, scene] = [map, scene].map(|name| toml::Value::String(name.to_owned()).to_string());
    let start = scenarios.first().map_or(Default::default(), |scenario| position_mm(scenario.start));
    let goal = scenarios.first().map_or(Default::default(), |scenario| position_mm(scenario.goal));
    let tolerance = written(rounded_mm(0.5 * cell));
    let scene_text = format!(
        "[world]\nfile = {map}\ncell_mm = {cell_mm}\n\n[[robot]]\ntype = \"S4\"\nx_mm = {}\ny_mm = {}\n\n[[check]]\n\
         name = \"the goal\"\nkind = \"reach\"\nat_mm = [{}, {}]\nwithin_mm = {tolerance}\n\n[[check]]\n\
         name = \"touches nothing\"\nkind = \"contacts\"\n",
        start[0], start[1], goal[0], goal[1]
    );
    let mut suite = format!(
        "[suite]\nscene = {scene}\nuntil_s = 600\n\
         arguments = [\"--scenario {{scenario}} --goal {{goal_x}} {{goal_y}} --optimum {{optimum}}\"]\n\n[matrix]\n\
         zip = [[\"scenario\", \"goal_x\", \"goal_y\", \"optimum\", \"robot[0].x_mm\", \"robot[0].y_mm\", \
         \"check[0].at_mm[0]\", \"check[0].at_mm[1]\"]]\n"
    );
    let numbers: Vec<String> = (1..=scenarios.len()).map(|number| number.to_string()).collect();
    let values_of = |value: &dyn Fn(&Scenario) -> String| scenarios.iter().map(value).collect::<Vec<_>>();
    let (x, y) = (|cell: [usize; 2]| position_mm(cell)[0].clone(), |cell: [usize; 2]| position_mm(cell)[1].clone());
    let (goal_x, goal_y) = (values_of(&|it| x(it.goal)), values_of(&|it| y(it.goal)));
    let parameters = [
        ("scenario", &numbers),
        ("goal_x", &goal_x),
        ("goal_y", &goal_y),
        ("optimum", &values_of(&|it| written(rounded_mm(it.length * cell)))),
    ];
    let settings = [
        ("\"robot[0].x_mm\"", &values_of(&|it| x(it.start))),
        ("\"robot[0].y_mm\"", &values_of(&|it| y(it.start))),
        ("\"check[0].at_mm[0]\"", &goal_x),
        ("\"check[0].at_mm[1]\"", &goal_y),
    ];
    for (table, lists) in [("parameter", parameters), ("set", settings)] {
        let _ = writeln!(suite, "\n[matrix.{table}]");
        for (name, values) in lists {
            let _ = writeln!(suite, "{name} = [{}]", values.join(", "));
        }
    }
    [scene_text, suite]
}
