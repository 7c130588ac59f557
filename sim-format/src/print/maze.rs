//! Printing of mazes as drawings.

use std::borrow::Cow;

use glam::DVec2;

use super::LOOKS;
use super::number::written_mm;
use crate::spec::{DEFAULT_CELL, LooksSpec, WorldSpec};
use crate::{content, read_maze};

/// Maximum number of cells of a drawing.
const MAX_CELLS: f64 = 1e6;

/// Reason why a world cannot be drawn as a maze.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NotAMaze(Cow<'static, str>);

/// Text of a maze file.
///
/// # Errors
/// [`NotAMaze`] if a wall is off the grid or has a thickness, a height or a colour, if a start has no letter, or if no
/// character represents an object.
pub fn print_maze(world: &WorldSpec) -> Result<String, NotAMaze> {
    let cell = world.cell.unwrap_or(DEFAULT_CELL);
    let size = (world.floor / cell).round();
    if !(size.x >= 1.0 && size.y >= 1.0 && size.x * size.y <= MAX_CELLS) {
        return Err(NotAMaze("the floor is not a grid of cells".into()));
    }
    let mut drawing = MazeCanvas::new(size.x as usize, size.y as usize);
    for wall in &world.walls {
        drawing.add_wall((wall.from / cell).round(), (wall.to / cell).round());
    }
    for start in &world.starts {
        let letter = start.letter.ok_or(NotAMaze("a start has no letter".into()))?;
        drawing.add_letter(start.pose.position / cell, letter);
    }
    for object in &world.objects {
        let letter = match object.kind.written().text.to_lowercase().as_str() {
            "soccer" => 'O',
            "crate" => 'X',
            other => return Err(NotAMaze(format!("no character of a maze stands for `{other}`").into())),
        };
        drawing.add_letter(object.pose.position / cell, letter);
    }
    let text = format!("{}{}\n", drawing.text(), written_mm(cell));
    let mut read_back = read_maze("", &text).0;
    read_back.texture.clone_from(&world.texture);
    read_back.texture_is_turned = world.texture_is_turned;
    read_back.terrain.clone_from(&world.terrain);
    read_back.water = world.water;
    read_back.surface = world.surface;
    read_back.looks = world.looks;
    let mut expected_content = content::world(world);
    expected_content.cell.get_or_insert(cell);
    if content::world(&read_back) == expected_content {
        return Ok(text);
    }
    let reasons = [
        (read_back.floor != world.floor, "its floor ends elsewhere"),
        (
            content::world(&read_back).walls != expected_content.walls,
            "its walls are not whole sides of cells, or they look special",
        ),
        (
            content::world(&read_back).starts != expected_content.starts,
            "its starts are not in the middle of cells, one each",
        ),
    ];
    let first_reason = reasons.into_iter().find(|(differs, _)| *differs);
    let reason = first_reason.map_or("its objects stand elsewhere", |(_, reason)| reason);
    Err(NotAMaze(format!("the world is not a maze: {reason}").into()))
}

/// Properties of a maze world that a maze file cannot represent.
pub(crate) fn lost_in_maze(world: &WorldSpec) -> Vec<String> {
    let texture = world.texture.as_ref().map(|texture| format!("the texture `{}`", texture.text));
    let surface = world.surface.map(|_| "the surface of floor and walls".to_owned());
    let terrain = world.terrain.as_ref().map(|_| "the terrain".to_owned());
    let looks = (world.looks != LooksSpec::default()).then(|| LOOKS.to_owned());
    let water = world.water.map(|_| "the water".to_owned());
    [texture, surface, terrain, water, looks].into_iter().flatten().collect()
}

/// Drawing of a maze in progress, with row 0 at the bottom.
struct MazeCanvas {
    columns: usize,
    rows: usize,
    /// `vertical[row][column]` is true for a wall to the left of the cell; there is one column more than cells.
    vertical: Vec<Vec<bool>>,
    /// `horizontal[row][column]` is true for a wall below the cell; there is one row more than cells.
    horizontal: Vec<Vec<bool>>,
    letters: Vec<Vec<Option<char>>>,
}

impl MazeCanvas {
    fn new(columns: usize, rows: usize) -> Self {
        Self {
            columns,
            rows,
            vertical: vec![vec![false; columns + 1]; rows],
            horizontal: vec![vec![false; columns]; rows + 1],
            letters: vec![vec![None; columns]; rows],
        }
    }

    /// Adds a wall between two grid points; a wall off the grid is detected when the drawing is read back.
    fn add_wall(&mut self, from: DVec2, to: DVec2) {
        let (low, high) = (from.min(to), from.max(to));
        let range = |low: f64, high: f64, end: usize| (low.max(0.0) as usize)..(high.max(0.0) as usize).min(end);
        if from.x == to.x {
            for row in range(low.y, high.y, self.rows) {
                if let Some(side) = self.vertical[row].get_mut(low.x.max(0.0) as usize) {
                    *side = true;
                }
            }
        } else if let Some(row) = self.horizontal.get_mut(low.y.max(0.0) as usize) {
            for column in range(low.x, high.x, self.columns) {
                row[column] = true;
            }
        }
    }

    fn add_letter(&mut self, point: DVec2, letter: char) {
        let (column, row) = (point.x.max(0.0) as usize, point.y.max(0.0) as usize);
        if let Some(cell) = self.letters.get_mut(row).and_then(|row| row.get_mut(column)) {
            *cell = Some(letter);
        }
    }

    fn text(&self) -> String {
        let border: String = self.horizontal[self.rows].iter().map(|wall| if *wall { " _" } else { "  " }).collect();
        let mut text = format!("{}\n", border.trim_end());
        for row in (0..self.rows).rev() {
            let mut line = String::new();
            for column in 0..=self.columns {
                line.push(if self.vertical[row][column] { '|' } else { ' ' });
                if column == self.columns {
                    break;
                }
                let has_wall_below = self.horizontal[row][column];
                line.push(match self.letters[row][column] {
                    Some(letter) if has_wall_below => letter,
                    Some(letter) => letter.to_ascii_lowercase(),
                    None if has_wall_below => '_',
                    None => ' ',
                });
            }
            // Readers skip blank lines.
            if line.trim().is_empty() {
                line.replace_range(1..2, ".");
            }
            text.push_str(line.trim_end());
            text.push('\n');
        }
        text
    }
}
