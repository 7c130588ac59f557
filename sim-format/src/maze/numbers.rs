//! Mazes as numbers, `.num`: a line `X Y N E S W` for each cell, the format of the simulator mms.

use std::collections::BTreeMap;

use super::cells::{CellWalls, StartAndGoals, add_start};
use super::{ContestMaze, Drawing};
use crate::Span;
use crate::code::Code;
use crate::diagnostic::Sink;
use crate::line;

const FORM: &str = "`X Y N E S W`: column and row from the south-west corner, then 1 for a wall and 0 for none";

/// Maximum number of columns and rows.
const MAX_SIDE: usize = 256;

/// Returns true if the first line consists of six whole numbers.
pub(super) fn is_numbers(text: &str) -> bool {
    let first = line::lines(text).map(|line| line.words()).find(|words| !words.is_empty());
    first.is_some_and(|words| words.len() == 6 && words.iter().all(|word| word.text.parse::<i64>().is_ok()))
}

pub(super) fn read(sink: &mut Sink, text: &str) -> ContestMaze {
    let mut cells: BTreeMap<[usize; 2], (u8, Span)> = BTreeMap::new();
    for line in line::lines(text) {
        let words = line.words();
        if words.is_empty() {
            continue;
        }
        let numbers: Vec<usize> = words.iter().map_while(|word| word.text.parse().ok()).collect();
        let (&[x, y, ref walls @ ..], 6) = (numbers.as_slice(), words.len()) else {
            let message = match words.get(numbers.len()) {
                Some(word) => format!("`{}` is not a whole number", word.text),
                None => format!("a line of {} numbers", words.len()),
            };
            sink.warn(Code::MazNumbers, line.span(), message, FORM);
            continue;
        };
        if x >= MAX_SIDE || y >= MAX_SIDE || walls.len() != 4 || walls.iter().any(|wall| *wall > 1) {
            let message = "a cell beyond 256 x 256, or a wall that is neither 0 nor 1";
            sink.warn(Code::MazNumbers, line.span(), message, FORM);
            continue;
        }
        let bits = walls.iter().zip(0..).fold(0, |bits, (wall, side)| bits | (*wall as u8) << side);
        if cells.insert([x, y], (bits, line.span())).is_some() {
            let message = format!("a second line of the cell ({x}, {y}); it replaces the first");
            sink.warn(Code::MazNumbers, line.span(), message, "one line for each cell");
        }
    }
    let size = cells.keys().fold([0, 0], |[columns, rows], [x, y]| [columns.max(x + 1), rows.max(y + 1)]);
    if cells.is_empty() {
        sink.error(Code::MazEmpty, Span::default(), "the file has no maze", FORM);
        return ContestMaze { drawing: Drawing::empty(0), rows: 1, note: None };
    }
    let missing = size[0] * size[1] - cells.len();
    let grid = CellWalls { size, walls: vec![0; size[0] * size[1]] };
    let first_missing = grid.cells().find(|cell| !cells.contains_key(cell));
    if let Some([x, y]) = first_missing {
        let which = if missing == 1 { "a cell has".to_owned() } else { format!("{missing} cells have") };
        let message = format!("{which} no line, the first ({x}, {y})");
        sink.warn(Code::MazNumbers, Span::default(), message, "a line for each cell of a rectangle");
    }
    let walls = grid.cells().map(|cell| cells.get(&cell).map_or(0, |cell| cell.0)).collect();
    let cell_walls = CellWalls { walls, ..grid };
    let span = |cell: [usize; 2]| cells.get(&cell).map_or(Span::default(), |cell| cell.1);
    cell_walls.check_shared(sink, |cell| (span(cell), String::new()));
    let mut drawing = cell_walls.drawing(span);
    let note = add_start(&mut drawing, size[1], &StartAndGoals::usual(size), span([0, 0]));
    ContestMaze { drawing, rows: size[1], note: Some(note) }
}
