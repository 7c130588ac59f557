//! Maps and scenarios of the MovingAI benchmarks: `.map` and `.scen`.
//!
//! Source: movingai.com/benchmarks/formats.html; N. Sturtevant, Benchmarks for Grid-Based Pathfinding, 2012.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::f64::consts::SQRT_2;

use super::grid::{Cell, Grid, MAX_CELLS};
use crate::code::Code;
use crate::diagnostic::{Diagnostic, Sink};
use crate::line::{self, Line, Word};
use crate::{Severity, Span};
use sim_core::pose::Pose;

const HEADER_SYNTAX: &str = "`type octile`, `height ROWS`, `width COLUMNS`, `map`, then the rows";
const ROW_SYNTAX: &str = "one of `.` `G` `S` (free), `@` `O` `T` `W` (not free) for each cell";

/// Returns true if the text begins like a map.
pub(crate) fn is_map(text: &str) -> bool {
    let first = line::lines(text).flat_map(|line| line.words()).next();
    first.is_some_and(|word| ["type", "height", "width", "map"].contains(&word.text))
}

/// Reads a map with cells of this side in metres; `None`, with an error, if there are no rows or too many cells.
pub(crate) fn read_map(sink: &mut Sink, text: &str, cell: f64) -> Option<Grid> {
    let mut lines = line::lines(text);
    let mut sides = [None, None];
    let has_map = read_header(sink, &mut lines, &mut sides);
    let mut rows: Vec<Line<'_>> = Vec::new();
    if has_map {
        rows = lines.filter(|line| !line.text.trim().is_empty()).collect();
    }
    if rows.is_empty() {
        let message = if has_map { "the map has no rows" } else { "the map has no line `map`" };
        sink.error(Code::MapSize, Span::default(), message, HEADER_SYNTAX);
        return None;
    }
    let max_width = rows.iter().map(|row| row.text.trim_end().chars().count()).max().unwrap_or_default();
    let [height, width] = sides.map(|side| side.map(|side: (u64, Span)| side.0));
    let (columns, count) = (width.unwrap_or(max_width as u64), height.unwrap_or(rows.len() as u64));
    if columns == 0 || count == 0 || columns.saturating_mul(count) > MAX_CELLS {
        let span = sides.iter().flatten().next().map_or(Span::default(), |side| side.1);
        let message = format!("the map has {columns} x {count} cells");
        sink.error(Code::MapSize, span, message, "1 to 67,108,864 cells, such as 8192 x 8192");
        return None;
    }
    if rows.len() as u64 != count {
        let span = sides[0].map_or(Span::default(), |side| side.1);
        let message = format!("the map states {count} rows and has {}", rows.len());
        let expected = "as many rows as its height; missing ones are not free";
        sink.warn(Code::MapSize, span, message, expected);
    }
    let (columns, count) = (columns as usize, count as usize);
    // Even a short file may state many cells.
    let mut cells = vec![Cell::Occupied; columns * count];
    let mut unknown = 0;
    for (row, line) in rows.iter().take(count).enumerate() {
        let row_from_bottom = count - 1 - row;
        let content = line.text.trim_end();
        let cell_count = content.chars().count();
        if cell_count != columns {
            let message = format!("a row of {cell_count} cells in a map of {columns} columns");
            sink.warn(
                Code::MapSize,
                line.span(),
                message,
                "rows as long as the map is wide; missing cells are not free",
            );
        }
        for (column, (byte, character)) in content.char_indices().take(columns).enumerate() {
            let is_free = match character {
                '.' | 'G' | 'S' => true,
                '@' | 'O' | 'T' | 'W' => false,
                _ => {
                    unknown += 1;
                    if unknown == 1 {
                        let span = line.character_span(byte, column as u32 + 1);
                        let message = format!("`{}` means nothing in a map; it is not free", character.escape_debug());
                        sink.warn(Code::MapCell, span, message, ROW_SYNTAX);
                    }
                    false
                }
            };
            cells[row_from_bottom * columns + column] = if is_free { Cell::Free } else { Cell::Occupied };
        }
    }
    if unknown > 1 {
        let message = format!("{unknown} characters mean nothing in a map");
        sink.warn(Code::MapCell, Span::default(), message, ROW_SYNTAX);
    }
    Some(Grid { size: [columns, count], cell, origin: Pose::default(), cells })
}

/// Reads the lines up to `map` into `sides`, height and width; returns false if there is no line `map`.
fn read_header<'t>(
    sink: &mut Sink,
    lines: &mut impl Iterator<Item = Line<'t>>,
    sides: &mut [Option<(u64, Span)>; 2],
) -> bool {
    for line in lines {
        let words = line.words();
        match words.as_slice() {
            [] => {}
            [word] if word.text == "map" => {
                for (name, side) in ["height", "width"].iter().zip(sides.iter()) {
                    if side.is_none() {
                        let message = format!("the map does not state its {name}; the {name} of the rows is used");
                        sink.warn(Code::MapKey, word.span, message, HEADER_SYNTAX);
                    }
                }
                return true;
            }
            [key, kind] if key.text == "type" => {
                if !["octile", "tile"].contains(&kind.text) {
                    let message = format!("a map of the type `{}` is read as one of squares", kind.text);
                    sink.warn(Code::MapKey, kind.span, message, "`type octile`");
                }
            }
            [key, side] if ["height", "width"].contains(&key.text) => match side.text.parse::<u64>() {
                Ok(number) => sides[usize::from(key.text == "width")] = Some((number, side.span)),
                Err(_) => {
                    let message = format!("`{}` is not a number of cells", side.text);
                    sink.error(Code::MapKey, side.span, message, HEADER_SYNTAX);
                }
            },
            [first, ..] => {
                let message = format!("`{}` means nothing before the rows of a map", first.text);
                sink.warn(Code::MapKey, first.span, message, HEADER_SYNTAX);
            }
        }
    }
    false
}

/// A scenario: a task of finding a path from a start to a goal.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Number of the group of scenarios with similar lengths.
    pub bucket: u64,
    /// Name of the map, as written.
    pub map: String,
    /// Columns and rows of the map.
    pub size: [usize; 2],
    /// Column and row of the start, counted from the upper left corner.
    pub start: [usize; 2],
    /// Column and row of the goal, counted from the upper left corner.
    pub goal: [usize; 2],
    /// Length of a shortest path in sides of a cell.
    pub length: f64,
    /// The line of the scenario in the file.
    pub span: Span,
}

const SCENARIO_SYNTAX: &str =
    "`BUCKET MAP WIDTH HEIGHT START_X START_Y GOAL_X GOAL_Y LENGTH`, separated by tabs or blanks";

/// Reads the scenarios of a `.scen`.
pub fn read_scenarios(file: &str, text: &str) -> (Vec<Scenario>, Vec<Diagnostic>) {
    let mut sink = Sink::new(file);
    let mut scenarios = Vec::new();
    let mut lines = line::lines(text).filter(|line| !line.text.trim().is_empty()).peekable();
    match lines.peek().map(|line| (*line, line.words())) {
        Some((_, words)) if words.first().is_some_and(|word| word.text == "version") => {
            let version = words.get(1).map_or("", |word| word.text);
            if version.parse::<f64>().ok().is_none_or(|version| version.total_cmp(&1.0).is_ne()) {
                let message = format!("version `{version}` is read as version 1");
                sink.warn(Code::ScenLine, words[0].span, message, "`version 1`");
            }
            lines.next();
        }
        Some((line, _)) => {
            sink.warn(Code::ScenLine, line.span(), "the scenarios do not begin with their version", "`version 1`");
        }
        None => {
            sink.error(Code::ScenLine, Span::default(), "the file has no scenarios", SCENARIO_SYNTAX);
        }
    }
    for line in lines {
        scenarios.extend(read_scenario(&mut sink, &line));
    }
    (scenarios, sink.finish())
}

fn read_scenario(sink: &mut Sink, line: &Line<'_>) -> Option<Scenario> {
    let words = fields(line);
    let [bucket, map, numbers @ .., length] = words.as_slice() else {
        sink.error(Code::ScenLine, line.span(), "a scenario has 9 values", SCENARIO_SYNTAX);
        return None;
    };
    if numbers.len() != 6 {
        let message = format!("a scenario of {} of 9 values", words.len());
        sink.error(Code::ScenLine, line.span(), message, SCENARIO_SYNTAX);
        return None;
    }
    let mut whole_number = |word: &Word<'_>| match word.text.parse::<u64>().ok().filter(|number| *number <= MAX_CELLS) {
        Some(number) => Some(number as usize),
        None => {
            let message = format!("`{}` is not a whole number", word.text);
            sink.error(Code::ScenLine, word.span, message, SCENARIO_SYNTAX);
            None
        }
    };
    let bucket = whole_number(bucket)?;
    let numbers: Vec<usize> = numbers.iter().map(&mut whole_number).collect::<Option<_>>()?;
    let value = length.text.parse::<f64>().ok().filter(|value| (0.0..=1e9).contains(value));
    let Some(value) = value else {
        let message = format!("`{}` is not a length", length.text);
        sink.error(Code::ScenLine, length.span, message, SCENARIO_SYNTAX);
        return None;
    };
    let &[width, height, from_x, from_y, to_x, to_y] = numbers.as_slice() else { return None };
    let scenario = Scenario {
        bucket: bucket as u64,
        map: map.text.to_owned(),
        size: [width, height],
        start: [from_x, from_y],
        goal: [to_x, to_y],
        length: value,
        span: line.span(),
    };
    for (name, [x, y]) in [("start", scenario.start), ("goal", scenario.goal)] {
        if x >= width || y >= height {
            let message = format!("the {name} ({x}, {y}) lies outside of the map of {width} x {height} cells");
            sink.error(Code::ScenLine, line.span(), message, "columns and rows from 0, below width and height");
            return None;
        }
    }
    Some(scenario)
}

/// The values of a line: separated by tabs if this gives the right number of values, otherwise by blanks. Only with
/// tabs, names may contain blanks.
fn fields<'t>(line: &Line<'t>) -> Vec<Word<'t>> {
    let mut start = 0;
    let mut words = Vec::new();
    for piece in line.text.split('\t') {
        let (from, trimmed) = (start + piece.len() - piece.trim_start().len(), piece.trim());
        start += piece.len() + 1;
        if !trimmed.is_empty() {
            let first = line.character_span(from, line.text[..from].chars().count() as u32 + 1);
            let span = Span { end: first.start + trimmed.len(), ..first };
            words.push(Word { text: trimmed, span, is_unclosed: false });
        }
    }
    if words.len() == 9 { words } else { line.words() }
}

/// Compares the lengths of scenarios with the shortest paths on their map and reports differences. Returns the number
/// of scenarios with the correct length.
pub(crate) fn check_lengths(sink: &mut Sink, grid: &Grid, scenarios: &[Scenario]) -> usize {
    let mut search = Search::new(grid);
    let mut matching = 0;
    for scenario in scenarios {
        if scenario.size != grid.size {
            let [columns, rows] = grid.size;
            let [width, height] = scenario.size;
            let message =
                format!("the scenario is for a map of {width} x {height} cells; this one has {columns} x {rows}");
            sink.warn(Code::ScenLength, scenario.span, message, "the size of the map; it is not scaled");
            continue;
        }
        let expected = "the length of a shortest path over eight neighbours that cuts no corner";
        let stated = scenario.length;
        match search.length(scenario.start, scenario.goal) {
            // Lengths are written with five to eight digits.
            Some(length) if (length - stated).abs() <= 1e-4 + 1e-5 * length => matching += 1,
            Some(length) => {
                let message = format!("a shortest path has the length {length:.6}, not {stated}");
                sink.report(Severity::Warning, Code::ScenLength, scenario.span, message, expected);
            }
            None => {
                let message = format!("no path leads from the start to the goal; its length is to be {stated}");
                sink.report(Severity::Warning, Code::ScenLength, scenario.span, message, expected);
            }
        }
    }
    matching
}

/// Searches for shortest paths on one map, by A*. Lengths are a + b sqrt(2) with integers a and b, so rounding does not
/// accumulate.
struct Search<'g> {
    grid: &'g Grid,
    /// For each cell, the numbers of straight and of diagonal steps to it, and the number of the search that found
    /// these steps.
    best: Vec<(u32, u32, u32)>,
    search_number: u32,
}

/// Length of a path with these numbers of straight and diagonal steps, in sides of a cell.
fn length_of(straight: u32, diagonal: u32) -> f64 {
    f64::from(straight) + f64::from(diagonal) * SQRT_2
}

impl<'g> Search<'g> {
    fn new(grid: &'g Grid) -> Self {
        Self { grid, best: vec![(0, 0, 0); grid.cells.len()], search_number: 0 }
    }

    /// Length of a shortest path between two cells, counted from the upper left corner, in sides of a cell.
    fn length(&mut self, start: [usize; 2], goal: [usize; 2]) -> Option<f64> {
        let [columns, rows] = self.grid.size;
        let index = |[column, row]: [usize; 2]| (rows - 1 - row) * columns + column;
        let is_free = |cell: usize| self.grid.cells[cell] == Cell::Free;
        let (start, goal) = (index(start), index(goal));
        if !is_free(start) || !is_free(goal) {
            return None;
        }
        self.search_number += 1;
        let search_number = self.search_number;
        let estimate = |cell: usize| {
            let column_distance = (cell % columns).abs_diff(goal % columns) as u32;
            let row_distance = (cell / columns).abs_diff(goal / columns) as u32;
            length_of(column_distance.abs_diff(row_distance), column_distance.min(row_distance))
        };
        // Positive `f64` numbers have the same order as their bit patterns.
        let key = |straight, diagonal, cell| Reverse((length_of(straight, diagonal) + estimate(cell)).to_bits());
        let mut open = BinaryHeap::from([(key(0, 0, start), 0, 0, start)]);
        self.best[start] = (0, 0, search_number);
        while let Some((_, straight, diagonal, cell)) = open.pop() {
            if cell == goal {
                return Some(length_of(straight, diagonal));
            }
            if self.best[cell] != (straight, diagonal, search_number) {
                continue;
            }
            let (column, row) = (cell % columns, cell / columns);
            let free = |dx: isize, dy: isize| {
                let (x, y) = (column.checked_add_signed(dx)?, row.checked_add_signed(dy)?);
                (x < columns && y < rows && is_free(y * columns + x)).then_some(y * columns + x)
            };
            for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)] {
                let Some(next) = free(dx, dy) else { continue };
                let is_diagonal = dx != 0 && dy != 0;
                if is_diagonal && (free(dx, 0).is_none() || free(0, dy).is_none()) {
                    continue;
                }
                let (straight_steps, diagonal_steps) =
                    (straight + u32::from(!is_diagonal), diagonal + u32::from(is_diagonal));
                let (old_straight, old_diagonal, found_in) = self.best[next];
                if found_in != search_number
                    || length_of(straight_steps, diagonal_steps) < length_of(old_straight, old_diagonal)
                {
                    self.best[next] = (straight_steps, diagonal_steps, search_number);
                    open.push((key(straight_steps, diagonal_steps, next), straight_steps, diagonal_steps, next));
                }
            }
        }
        None
    }
}
