//! Mazes whose files state the walls of each cell, and shortest paths through mazes.

use std::collections::VecDeque;

use super::Drawing;
use crate::Span;
use crate::code::Code;
use crate::diagnostic::Sink;

/// Sides of a cell, in the order of the bits of a file: north, east, south, west.
pub(super) const SIDES: [(&str, [i32; 2]); 4] =
    [("north", [0, 1]), ("east", [1, 0]), ("south", [0, -1]), ("west", [-1, 0])];

/// Number of columns and rows of a classic maze, whose goal is the four cells in the middle.
pub(super) const CLASSIC: usize = 16;

/// The walls of each cell, column by column from the south-west corner: a bit for each of [`SIDES`].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct CellWalls {
    pub(super) size: [usize; 2],
    pub(super) walls: Vec<u8>,
}

impl CellWalls {
    fn walls_of(&self, [x, y]: [usize; 2]) -> u8 {
        self.walls[x * self.size[1] + y]
    }

    /// The cell on the other side of `side`; `None` at the border.
    fn neighbour(&self, [x, y]: [usize; 2], side: usize) -> Option<[usize; 2]> {
        let [dx, dy] = SIDES[side].1;
        let next = [x.checked_add_signed(dx as isize)?, y.checked_add_signed(dy as isize)?];
        (next[0] < self.size[0] && next[1] < self.size[1]).then_some(next)
    }

    /// All cells, column by column from the south-west corner.
    pub(super) fn cells(&self) -> impl Iterator<Item = [usize; 2]> + use<> {
        let [columns, rows] = self.size;
        (0..columns).flat_map(move |x| (0..rows).map(move |y| [x, y]))
    }

    /// Walls that the file states for only one of their two cells: this cell, the side of the wall, the other cell.
    pub(super) fn one_sided_walls(&self) -> impl Iterator<Item = ([usize; 2], usize, [usize; 2])> {
        self.cells().flat_map(move |cell| {
            (0..4).filter_map(move |side| {
                let next = self.neighbour(cell, side)?;
                let [own_side, other_side] =
                    [self.walls_of(cell) >> side & 1, self.walls_of(next) >> ((side + 2) % 4) & 1];
                (own_side == 1 && other_side == 0).then_some((cell, side, next))
            })
        })
    }

    /// Returns true if no wall of the border is missing.
    pub(super) fn is_closed(&self) -> bool {
        self.cells()
            .all(|cell| (0..4).all(|side| self.neighbour(cell, side).is_some() || self.walls_of(cell) >> side & 1 == 1))
    }

    /// Reports walls that the file states for only one of their two cells; `place` returns the location of a cell in
    /// the file.
    pub(super) fn check_shared(&self, sink: &mut Sink, place: impl Fn([usize; 2]) -> (Span, String)) {
        let count = self.one_sided_walls().count();
        let Some((cell, side, next)) = self.one_sided_walls().next() else { return };
        let ((span, at_cell), (_, at_next)) = (place(cell), place(next));
        let walls = if count == 1 { "a wall is".to_owned() } else { format!("{count} walls are") };
        let message = format!(
            "{walls} stated by one of its two cells only, the first {} of ({}, {}){at_cell} and not by ({}, {}){at_next}",
            SIDES[side].0, cell[0], cell[1], next[0], next[1]
        );
        sink.warn(Code::MazShared, span, message, "each inner wall in both of its cells; here it is a wall");
    }

    /// The maze as a drawing; `span` returns the location of a cell in the file.
    pub(super) fn drawing(&self, span: impl Fn([usize; 2]) -> Span) -> Drawing {
        let [columns, rows] = self.size;
        let mut drawing = Drawing::empty(columns as u32);
        for cell @ [x, y] in self.cells() {
            let row = (rows - y) as u32;
            for side in (0..4).filter(|side| self.walls_of(cell) >> side & 1 == 1) {
                let cell_span = span(cell);
                match side {
                    0 => drawing.horizontal.push((row - 1, x as u32, cell_span)),
                    1 => drawing.vertical.push((x as u32 + 1, row, cell_span)),
                    2 => drawing.horizontal.push((row, x as u32, cell_span)),
                    _ => drawing.vertical.push((x as u32, row, cell_span)),
                }
            }
        }
        drawing
    }
}

/// Start and goals of a maze, in columns and rows from the south-west corner.
pub(super) struct StartAndGoals {
    pub(super) start: [usize; 2],
    pub(super) goals: Vec<[usize; 2]>,
}

impl StartAndGoals {
    /// Start and goals by the rules of contests: from the south-west corner to the four cells in the middle of a
    /// classic maze.
    pub(super) fn usual([columns, rows]: [usize; 2]) -> Self {
        let middle = [CLASSIC / 2 - 1, CLASSIC / 2];
        let goals = middle.iter().flat_map(|x| middle.map(|y| [*x, y]));
        let is_classic = columns == CLASSIC && rows == CLASSIC;
        Self { start: [0, 0], goals: goals.filter(|_| is_classic).collect() }
    }
}

/// Adds the start to a drawing of `rows` rows. Its letter states the heading: towards the only open side, or north if
/// several sides are open. Returns a note on the maze.
pub(super) fn add_start(drawing: &mut Drawing, rows: usize, start_and_goals: &StartAndGoals, span: Span) -> String {
    let columns = drawing.columns as usize;
    let passages = Passages::of(drawing, rows);
    let open_sides: Vec<usize> =
        (0..4).filter(|side| passages.open_neighbour(start_and_goals.start, *side).is_some()).collect();
    let letter = match open_sides.as_slice() {
        [1] => 'r',
        [2] => 'd',
        [3] => 'l',
        _ => 's',
    };
    let [x, y] = start_and_goals.start;
    drawing.letters.push((letter, x as u32, (rows - y) as u32, span));
    let mut note = format!("a maze of {columns} x {rows} cells; start in cell ({x}, {y})");
    match start_and_goals.goals.as_slice() {
        [] => note.push_str("; no goal is marked"),
        goals => {
            let cells: Vec<String> = goals.iter().map(|[x, y]| format!("({x}, {y})")).collect();
            let more = if cells.len() > 9 { ", ..." } else { "" };
            note.push_str(&format!("; goal {}{more}", cells[..cells.len().min(9)].join(", ")));
            note.push_str(&match passages.shortest_path_steps(start_and_goals.start, goals) {
                Some(steps) => format!("; {steps} steps from cell to cell on a shortest path from the start to it"),
                None => "; no path leads from the start to it".to_owned(),
            });
        }
    }
    note
}

/// Open sides of the cells of a drawing.
struct Passages {
    size: [usize; 2],
    /// True for a wall to the left of a cell; row by row from the south, with one column and one row more than cells.
    left: Vec<bool>,
    /// True for a wall below a cell, in the same order as `left`.
    below: Vec<bool>,
}

impl Passages {
    fn of(drawing: &Drawing, rows: usize) -> Self {
        let columns = drawing.columns as usize;
        let stride = columns + 1;
        let (mut left, mut below) = (vec![false; stride * (rows + 1)], vec![false; stride * (rows + 1)]);
        for (column, row, _) in &drawing.vertical {
            left[(rows - *row as usize) * stride + *column as usize] = true;
        }
        for (row, column, _) in &drawing.horizontal {
            below[(rows - *row as usize) * stride + *column as usize] = true;
        }
        Self { size: [columns, rows], left, below }
    }

    /// The cell on the other side of an open `side`; `None` if the side is closed.
    fn open_neighbour(&self, [x, y]: [usize; 2], side: usize) -> Option<[usize; 2]> {
        let ([columns, rows], stride) = (self.size, self.size[0] + 1);
        let (is_closed, next) = match side {
            0 => (self.below[(y + 1) * stride + x], [x, y + 1]),
            1 => (self.left[y * stride + x + 1], [x + 1, y]),
            2 => (self.below[y * stride + x], [x, y.wrapping_sub(1)]),
            _ => (self.left[y * stride + x], [x.wrapping_sub(1), y]),
        };
        (!is_closed && next[0] < columns && next[1] < rows).then_some(next)
    }

    /// Number of steps on a shortest path to one of the `goals`, by breadth-first search.
    fn shortest_path_steps(&self, start: [usize; 2], goals: &[[usize; 2]]) -> Option<u32> {
        let [columns, rows] = self.size;
        let mut is_visited = vec![false; columns * rows];
        let mut queue = VecDeque::from([(start, 0)]);
        is_visited[start[1] * columns + start[0]] = true;
        while let Some((cell, steps)) = queue.pop_front() {
            if goals.contains(&cell) {
                return Some(steps);
            }
            for next in (0..4).filter_map(|side| self.open_neighbour(cell, side)) {
                if !std::mem::replace(&mut is_visited[next[1] * columns + next[0]], true) {
                    queue.push_back((next, steps + 1));
                }
            }
        }
        None
    }
}
