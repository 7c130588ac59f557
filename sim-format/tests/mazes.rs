//! Mazes: a robot can drive exactly to the cells that a flood fill on the characters reaches.
//!
//! The flood fill is independent of the reader: it looks for `|` and `_` between two cells of the text. The robot is a
//! body that drives from the centre of a cell to that of its neighbour in the world built from the reader's walls.

use std::collections::BTreeSet;
use std::f64::consts::FRAC_PI_2;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec2;
use proptest::prelude::*;
use sim_core::drive::{Command, Model, Motion};
use sim_core::pose::{Pose, Twist};
use sim_core::scene::Walls;
use sim_core::spec::{RobiSpec, WorldSpec};
use sim_core::time::Time;
use sim_core::{RobotId, build};
use sim_format::Severity;

/// Row (from the top, from 1) and column (from 0) of a cell; one row or column outside on each side.
type Cell = (i32, i32);

/// Right, up, left, down: change of row and column.
const WAYS: [Cell; 4] = [(0, 1), (-1, 0), (0, -1), (1, 0)];

/// Maze as characters.
struct Drawing {
    /// The upper border, then each row of cells.
    rows: Vec<Vec<char>>,
    columns: i32,
}

impl Drawing {
    fn new(text: &str) -> Self {
        let is_row = |line: &&str| {
            line.starts_with(['|', '_', ' ']) && line.trim().parse::<f64>().is_err() && !line.trim().is_empty()
        };
        let lines = text.split(['\n', '\r']).filter(is_row);
        let mut rows: Vec<Vec<char>> = lines.map(|line| line.trim_end().chars().collect()).collect();
        if rows.first().is_some_and(|row| row.iter().any(|c| !matches!(c, '_' | ' '))) {
            rows.insert(0, Vec::new());
        }
        if !rows.is_empty() {
            rows = in_usual_columns(&rows);
        }
        let width = |row: &Vec<char>| {
            let cells = (0..row.len()).filter(|&column| match row[column] {
                ' ' | '.' => false,
                '_' => column > 0,
                _ => true,
            });
            cells.map(|column| column.div_ceil(2)).max().unwrap_or(0)
        };
        let columns = rows.iter().map(width).max().unwrap_or(0) as i32;
        Self { rows, columns }
    }

    fn at(&self, row: i32, column: i32) -> char {
        let row = usize::try_from(row).ok().and_then(|row| self.rows.get(row));
        let character = usize::try_from(column).ok().and_then(|column| row?.get(column));
        character.copied().unwrap_or(' ')
    }

    /// Returns true if a line is drawn at the bottom of a cell; row 0 is the upper border.
    fn has_floor(&self, (row, column): Cell) -> bool {
        let beside = self.at(row, 2 * column + 2);
        let inside = self.at(row, 2 * column + 1);
        let closes = |character| character == '_' || is_walled_letter(character);
        column >= 0 && (closes(inside) || closes(beside))
    }

    fn has_wall(&self, from: Cell, to: Cell) -> bool {
        if from.0 == to.0 {
            // In an odd column a wall counts for the line on its right.
            let line = 2 * from.1.max(to.1);
            from.0 > 0 && [line, line - 1].iter().any(|line_index| self.at(from.0, *line_index) == '|')
        } else {
            self.has_floor((from.0.min(to.0), from.1))
        }
    }

    /// Cells with a robot's start letter, in the order of the text.
    fn starts(&self) -> Vec<Cell> {
        let cells = (0..).zip(&self.rows).flat_map(|(row, characters)| (0..).zip(characters).map(move |p| (row, p)));
        let letters = cells.filter(|(_, (_, character))| "surdlSURDL".contains(**character));
        letters.map(|(row, (index, _))| (row, (index + 1) / 2 - 1)).collect()
    }

    /// Neighbours of a cell, including cells just outside the maze.
    fn neighbours(&self, cell: Cell) -> impl Iterator<Item = Cell> {
        let (rows, columns) = (self.rows.len() as i32, self.columns);
        let cells = WAYS.map(|(down, right)| (cell.0 + down, cell.1 + right));
        cells.into_iter().filter(move |(row, column)| (0..=rows).contains(row) && (-1..=columns).contains(column))
    }

    fn is_outside(&self, (row, column): &Cell) -> bool {
        !(1..self.rows.len() as i32).contains(row) || !(0..self.columns).contains(column)
    }

    /// All cells reachable from `start` by moves that `can_pass` allows.
    fn flood(&self, start: Cell, mut can_pass: impl FnMut(Cell, Cell) -> bool) -> BTreeSet<Cell> {
        let mut reached = BTreeSet::from([start]);
        let mut front = vec![start];
        while let Some(cell) = front.pop() {
            for next in self.neighbours(cell) {
                if !reached.contains(&next) && can_pass(cell, next) {
                    reached.insert(next);
                    front.push(next);
                }
            }
        }
        reached
    }
}

/// Rows normalised to walls at even positions, from 0. A drawing with all walls at odd positions is indented; a drawing
/// with walls at positions 0, 3, 6, ... has cells of two characters.
fn in_usual_columns(rows: &[Vec<char>]) -> Vec<Vec<char>> {
    let walls = || rows.iter().flat_map(|row| (0..row.len()).filter(|&column| row[column] == '|'));
    if walls().all(|column| column % 2 == 0) {
        rows.to_vec()
    } else if walls().all(|column| column % 2 == 1) && rows.iter().all(|row| row.first().is_none_or(|&c| c == ' ')) {
        rows.iter().map(|row| row.iter().copied().skip(1).collect()).collect()
    } else if walls().all(|column| column % 3 == 0) {
        let narrow = |cell: &[char]| {
            let inner = cell.iter().skip(1);
            let letter = inner.clone().find(|c| c.is_ascii_alphabetic()).copied();
            let is_floor = inner.clone().any(|&c| c == '_');
            let character = match letter {
                Some(letter) => Some(if is_floor { letter.to_ascii_uppercase() } else { letter }),
                None => is_floor.then_some('_').or(inner.clone().next().copied()),
            };
            [cell[0]].into_iter().chain(character)
        };
        rows.iter().map(|row| row.chunks(3).flat_map(narrow).collect()).collect()
    } else {
        rows.to_vec()
    }
}

fn is_walled_letter(character: char) -> bool {
    "SURDLOX".contains(character)
}

/// A small robot for cells of any size.
struct Robot {
    model: Arc<Model>,
    walls: Arc<Walls>,
    cell: f64,
    rows: i32,
}

impl Robot {
    fn new(world: &WorldSpec, drawing: &Drawing) -> Self {
        let cell = world.cell.expect("a maze has cells");
        let robi = RobiSpec { diameter: 0.7 * cell, max_speed: cell, ..RobiSpec::with_defaults("mouse.robi") };
        let model = Arc::new(build::model(&robi));
        Self { model, walls: build::walls(world), cell, rows: drawing.rows.len() as i32 }
    }

    fn middle(&self, (row, column): Cell) -> DVec2 {
        DVec2::new(f64::from(column) + 0.5, f64::from(self.rows - 1 - row) + 0.5) * self.cell
    }

    /// Drives straight from the centre of `from` to that of `to`; returns true if the robot arrives.
    fn drives(&self, from: Cell, to: Cell) -> bool {
        let direction =
            WAYS.iter().position(|direction| *direction == (to.0 - from.0, to.1 - from.1)).expect("a neighbour");
        let middle = self.middle(from);
        let start = Pose::new(middle.x, middle.y, direction as f64 * FRAC_PI_2);
        let mut motion = Motion::new(RobotId(1), self.model.clone(), self.walls.clone(), start);
        let displacement = Twist { vx: self.cell, ..Twist::default() };
        let drive = Command::Drive { displacement, duration: 0.0 };
        motion.command(Time::ZERO, drive, &[]).expect("a straight line can be driven");
        let end = motion.pose(Time::from_millis(3_600_000));
        (end.position - self.middle(to)).length() < 1e-3 * self.cell
    }
}

/// Reads a maze and compares both floods from every start; returns the cells reached by driving from each.
fn compare(name: &str, text: &str) -> (WorldSpec, Vec<BTreeSet<Cell>>) {
    let (world, _) = sim_format::read_maze(name, text);
    let drawing = Drawing::new(text);
    let cell = world.cell.expect("a maze has cells");
    let size = DVec2::new(f64::from(drawing.columns), (drawing.rows.len() as f64 - 1.0).max(0.0)) * cell;
    assert!((world.floor - size).abs().max_element() < 1e-9, "{name}: floor {} is not {size}\n{text}", world.floor);
    let robot = Robot::new(&world, &drawing);
    let starts = drawing.starts();
    let positions: Vec<DVec2> = world.starts.iter().map(|start| start.pose.position).collect();
    assert_eq!(positions.len(), starts.len(), "{name}: starts {positions:?}\n{text}");
    let mut reached = Vec::new();
    for start in starts {
        assert!(
            positions.iter().any(|position| (*position - robot.middle(start)).length() < 1e-9),
            "{name}: no start in {start:?}"
        );
        let reachable = drawing.flood(start, |from, to| !drawing.has_wall(from, to));
        let driven = drawing.flood(start, |from, to| robot.drives(from, to));
        assert_eq!(driven, reachable, "{name}: cells driven to and cells drawn, from {start:?}\n{text}");
        reached.push(driven);
    }
    (world, reached)
}

fn mazes_below(folder: &Path) -> Vec<PathBuf> {
    let mut mazes = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).into_iter().flatten() {
            let path = entry.expect("a readable folder").path();
            let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
            if path.is_dir() {
                folders.push(path);
            } else if matches!(extension.to_lowercase().as_str(), "maz" | "maze") {
                mazes.push(path);
            }
        }
    }
    mazes.sort();
    mazes
}

fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

fn text_of(path: &Path) -> String {
    sim_format::decode(&fs::read(path).expect("a readable file")).0
}

#[test]
fn robots_reach_the_same_cells_in_our_mazes_as_in_their_drawings() {
    let mazes = mazes_below(&root().join("worlds"));
    assert!(!mazes.is_empty(), "there are mazes in worlds/");
    for path in mazes {
        let (world, reached) = compare(&path.display().to_string(), &text_of(&path));
        assert_eq!(reached.len(), world.starts.len());
    }
}

#[test]
fn robots_reach_the_same_cells_in_mazes_of_eyesim_as_in_their_drawings() {
    let corpus = root().join("../shared/eyesim/corpus");
    let mazes = mazes_below(&corpus);
    if mazes.is_empty() {
        println!("skipped: there are no files of EyeSim at {}", corpus.display());
        return;
    }
    let mut starts = 0;
    let mut contests = BTreeSet::new();
    for path in mazes {
        let text = text_of(&path);
        let (world, reached) = compare(&path.display().to_string(), &text);
        starts += reached.len();
        let name = path.file_stem().and_then(|name| name.to_str()).unwrap_or_default();
        if ["chicago-1986", "reno-1993", "regional1-1991", "size-example", "soccer"].contains(&name) {
            contests.insert(name.to_owned());
            let drawing = Drawing::new(&text);
            // From the start, or from the middle if there is none.
            let inside =
                drawing.starts().first().copied().unwrap_or((drawing.rows.len() as i32 / 2, drawing.columns / 2));
            let robot = Robot::new(&world, &drawing);
            let reached = drawing.flood(inside, |from, to| robot.drives(from, to));
            let escape = reached.iter().find(|cell| drawing.is_outside(cell));
            assert_eq!(escape, None, "{name} is not closed\n{text}");
        }
        let (_, diagnostics) = sim_format::read_maze(name, &text);
        assert!(diagnostics.iter().all(|mistake| mistake.severity == Severity::Warning), "{name}: {diagnostics:?}");
    }
    assert!(starts >= 20, "only {starts} starts");
    assert_eq!(contests.len(), 5, "contest mazes seen: {contests:?}");
}

/// Mazes in users' styles: rows of any length, either line end, the size first, last or missing.
fn maze() -> impl Strategy<Value = String> {
    let walls = prop::collection::vec(0..100_u8, 15 * 8);
    let letters = prop::collection::vec((1..8_usize, 1..14_usize, prop::sample::select(LETTERS)), 1..5);
    let size = prop::option::of((prop::sample::select(&[90, 180, 360, 500, 720][..]), any::<bool>()));
    (1..8_usize, 1..7_usize, walls, letters, size, any::<[bool; 3]>()).prop_map(
        |(rows, columns, walls, letters, size, [is_crlf, is_open, is_ragged])| {
            let density = if is_open { 25 } else { 45 };
            let mut lines: Vec<Vec<char>> = Vec::new();
            for row in 0..=rows {
                let draw = |column: usize| match (column % 2, walls[15 * row + column] < density) {
                    (0, true) if row > 0 => '|',
                    (1, true) => '_',
                    _ => ' ',
                };
                lines.push((0..=2 * columns).map(draw).collect());
            }
            // A blank border or row would not count.
            lines[0][1] = '_';
            lines[1..].iter_mut().for_each(|line| line[0] = '|');
            for (row, column, letter) in letters {
                if row <= rows && column <= 2 * columns {
                    lines[row][column] = letter;
                }
            }
            let mut texts: Vec<String> = lines.iter().map(|line| line.iter().collect()).collect();
            if is_ragged {
                texts.iter_mut().for_each(|text| text.truncate(text.trim_end().len()));
            }
            match size {
                Some((size, true)) => texts.insert(0, size.to_string()),
                Some((size, false)) => texts.push(size.to_string()),
                None => {}
            }
            texts.join(if is_crlf { "\r\n" } else { "\n" })
        },
    )
}

const LETTERS: &[char] = &['s', 'S', 'u', 'U', 'r', 'R', 'd', 'D', 'l', 'L', 'o', 'O', 'x', 'X', '.'];

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
    #[test]
    fn robots_reach_the_same_cells_in_random_mazes_as_in_their_drawings(text in maze()) {
        compare("random.maz", &text);
    }
}

#[test]
fn a_gap_is_found_and_a_wall_is_not_driven_through() {
    let closed = " ___\n|s  |\n|_|_|\n";
    let (_, reached) = compare("closed.maz", closed);
    assert_eq!(reached, [BTreeSet::from([(1, 0), (1, 1), (2, 0), (2, 1)])]);
    let (_, reached) = compare("open.maz", &closed.replacen("|_|_|", "|_|_", 1));
    assert!(reached[0].contains(&(2, 2)) && reached[0].contains(&(0, -1)), "all around: {reached:?}");
    // The same maze with wide cells, and indented.
    let wide = BTreeSet::from([(1, 0), (1, 1), (2, 0), (2, 1)]);
    assert_eq!(compare("wide.maz", " _____\n| s   |\n|__|__|\n").1, std::slice::from_ref(&wide));
    assert_eq!(compare("indented.maz", "  ___\n |s  |\n |_|_|\n").1, [wide]);
    // A letter in a wall column belongs to the cell on its left; in upper case it adds a wall below that cell.
    let (_, reached) = compare("letter.maz", " _____\n| | S |\n|_|___|\n");
    assert_eq!(reached, [BTreeSet::from([(1, 1), (1, 2), (2, 1), (2, 2)])]);
}
