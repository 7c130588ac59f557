//! Mazes: EyeSim's drawings (`.maz`) and the formats of micro-mouse contests.

mod binary;
mod cells;
mod numbers;
mod posts;

use std::collections::BTreeSet;

use glam::DVec2;

use super::code::Code;
use super::diagnostic::{Diagnostic, Sink};
use super::line::{self, Line, Quantity, Word};
use super::spec::{
    DEFAULT_CELL, DEFAULT_WALL_HEIGHT, Dialect, MAX_LENGTH, ObjectLine, SpannedText, StartSpec, TypeRef, WallSpec,
    WorldSpec,
};
use super::{Severity, Span};
use sim_core::pose::Pose;
use sim_core::unit;

/// Rules for the size of a maze's cells.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CellRules {
    /// EyeSim version for which the maze was drawn; if it is `None`, a size that not every EyeSim reads causes a
    /// warning.
    pub dialect: Option<Dialect>,
    /// Side of the cells in metres, which overrides the file.
    pub cell: Option<f64>,
}

/// Format of a maze file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MazeFormat {
    /// EyeSim's drawing.
    Drawing,
    /// A drawing with posts.
    Posts,
    /// A line of numbers for each cell.
    Numbers,
    /// A byte for each cell.
    Binary,
}

/// Format of a maze file with these `bytes`.
pub(crate) fn format_of(bytes: &[u8]) -> MazeFormat {
    if binary::is_binary(bytes) {
        return MazeFormat::Binary;
    }
    let text = String::from_utf8_lossy(bytes);
    if numbers::is_numbers(&text) {
        MazeFormat::Numbers
    } else if posts::is_posts(&text) {
        MazeFormat::Posts
    } else {
        MazeFormat::Drawing
    }
}

/// A maze that was read from a file of micro-mouse contests.
struct ContestMaze {
    drawing: Drawing,
    /// Rows of cells; at least 1.
    rows: usize,
    /// Note on the interpretation of the file.
    note: Option<String>,
}

/// Reads a binary maze. Also returns a note on its interpretation.
pub(crate) fn read_maze_bytes(
    file: &str,
    bytes: &[u8],
    rules: CellRules,
) -> (WorldSpec, Vec<Diagnostic>, Option<String>) {
    let mut sink = Sink::new(file);
    let maze = binary::read(&mut sink, bytes);
    maze.into_world(sink, file, rules)
}

/// Reads a maze of posts or of numbers. Also returns a note on its interpretation.
pub(crate) fn read_maze_text(
    file: &str,
    text: &str,
    format: MazeFormat,
    rules: CellRules,
) -> (WorldSpec, Vec<Diagnostic>, Option<String>) {
    let mut sink = Sink::new(file);
    let maze =
        if format == MazeFormat::Numbers { numbers::read(&mut sink, text) } else { posts::read(&mut sink, text) };
    maze.into_world(sink, file, rules)
}

impl ContestMaze {
    fn into_world(self, mut sink: Sink, file: &str, rules: CellRules) -> (WorldSpec, Vec<Diagnostic>, Option<String>) {
        self.drawing.check_border(&mut sink, self.rows as u32, |_| Span::default());
        let cell = rules.cell.unwrap_or(DEFAULT_CELL);
        let note = self.note.map(|note| format!("{note}; cells of {} mm", unit::mm_from_metres(cell)));
        let world = self.drawing.into_world(&mut sink, file, self.rows as u32 + 1, cell);
        (world, sink.finish(), note)
    }
}

/// Reads a maze that is drawn as in EyeSim. A line that contains only a number, usually the last or the first one,
/// states the size of the cells.
///
/// `file` is the name for the diagnostics. The lower left corner is the origin; the first drawn line is the upper
/// border. Adjacent wall pieces on one line are merged, so that walls have no joints inside.
pub fn read_maze(file: &str, text: &str) -> (WorldSpec, Vec<Diagnostic>) {
    read_maze_with(file, text, CellRules::default())
}

/// Reads a maze file like [`read_maze`], with `rules` for the size of its cells.
pub fn read_maze_with(file: &str, text: &str, rules: CellRules) -> (WorldSpec, Vec<Diagnostic>) {
    let mut sink = Sink::new(file);
    let (rows, sizes) = rows_and_sizes(&mut sink, text);
    let cell = cell_size(&mut sink, &sizes, rules);
    let mut drawing = Drawing::new(Grid::of(&mut sink, &rows));
    for (row, line) in rows.iter().enumerate() {
        drawing.read_row(&mut sink, row as u32, line);
    }
    drawing.check_border(&mut sink, (rows.len() as u32).saturating_sub(1), |row| rows[row as usize].span());
    let world = drawing.into_world(&mut sink, file, rows.len() as u32, cell);
    (world, sink.finish())
}

/// A line that contains only a number.
struct SizeLine<'a> {
    word: Word<'a>,
    /// The number in metres; `None` for an invalid one, which is already reported.
    size: Option<f64>,
    /// Rows drawn above the line.
    rows_above: usize,
    /// True if no row is drawn below the line.
    is_last: bool,
}

/// The cell size in metres according to the lines `sizes` and the `rules`.
fn cell_size(sink: &mut Sink, sizes: &[SizeLine<'_>], rules: CellRules) -> f64 {
    if let Some(cell) = rules.cell {
        return cell;
    }
    let in_mm = unit::mm_from_metres;
    if rules.dialect == Some(Dialect::Vr2018) {
        let (last, others) = match sizes.split_last() {
            Some((last, others)) if last.is_last => (last.size, others),
            _ => (None, sizes),
        };
        let cell = last.unwrap_or(DEFAULT_CELL);
        for other in others.iter().filter(|other| other.size.is_some_and(|size| size != cell)) {
            let message = format!(
                "EyeSim VR of 2018 reads the size of cells on the last line only: `{}` counts for nothing, cells have {} mm",
                other.word.text,
                in_mm(cell)
            );
            sink.warn(Code::MazCellFirst, other.word.span, message, CELL_SYNTAX);
        }
        return cell;
    }
    let mut cell: Option<f64> = None;
    for SizeLine { word, size, .. } in sizes {
        if let (Some(old), Some(new)) = (cell, *size)
            && old != new
        {
            let message = format!("a second cell size `{}`; it replaces {} mm", word.text, in_mm(old));
            sink.warn(Code::MazCellTwice, word.span, message, CELL_SYNTAX);
        }
        cell = size.or(cell);
    }
    if let ([first], None) = (sizes, rules.dialect)
        && first.rows_above == 0
        && first.size.is_some_and(|size| size.total_cmp(&DEFAULT_CELL).is_ne())
    {
        let message = format!(
            "cells of {} mm by the first line; EyeSim VR of 2018 reads the last line only and takes {} mm",
            first.word.text,
            in_mm(DEFAULT_CELL)
        );
        let diagnostic = sink.warn(Code::MazCellFirst, first.word.span, message, CELL_SYNTAX);
        diagnostic.suggestion = Some("`--maze-cell MM` or `cell_mm` of a scene says which one is meant".to_owned());
    }
    cell.unwrap_or(DEFAULT_CELL)
}

const CELL_SYNTAX: &str = "the cell size in mm, alone on the last line";

/// Drawn lines from top to bottom, the upper border first, and the lines with a cell size.
fn rows_and_sizes<'a>(sink: &mut Sink, text: &'a str) -> (Vec<Line<'a>>, Vec<SizeLine<'a>>) {
    let mut rows: Vec<Line<'_>> = Vec::new();
    let mut sizes: Vec<SizeLine<'_>> = Vec::new();
    let mut blank: Option<Line<'_>> = None;
    for line in line::lines(text) {
        let words = line.words();
        let Some(first) = words.first() else {
            // Blank lines before and after the drawing are ignored; one within it may have been meant as a row.
            if !rows.is_empty() && line.text.trim().is_empty() {
                blank = Some(line);
            }
            continue;
        };
        // A row may begin with `.` for an empty cell.
        if line::looks_numeric(first.text) && first.text.contains(|c: char| c.is_ascii_digit()) {
            if let Some(extra) = words.get(1) {
                let message = format!("`{}` is left over after the cell size", extra.text);
                sink.warn(Code::WordExtra, extra.span, message, CELL_SYNTAX);
            }
            let size = line::number(sink, Severity::Warning, first, &Quantity::size("cell size"));
            sizes.push(SizeLine { word: *first, size, rows_above: rows.len(), is_last: false });
        } else if line.text.starts_with(['|', ' ', '_', '\t']) {
            if let Some(blank) = blank.take() {
                let message = "a blank line inside the maze is left out";
                sink.warn(Code::MazBlank, blank.span(), message, "a row of cells that begins with `|` or a blank");
            }
            rows.push(line);
        } else {
            let message = format!("`{}` is neither a row of the maze nor a cell size", line.text.trim());
            sink.warn(Code::MazLine, line.span(), message, "a row that begins with `|`, `_` or a blank, or one number");
        }
    }
    sizes.iter_mut().for_each(|size| size.is_last = size.rows_above == rows.len());
    let is_border = |line: &Line<'_>| drawing_characters(line).all(|(_, c, _)| matches!(c, '_' | ' ' | '\t'));
    match rows.first() {
        None => {
            let message = "the file has no maze";
            sink.error(Code::MazEmpty, Span::default(), message, "a drawing of `|` and `_`, then the cell size in mm");
        }
        Some(first) if !is_border(first) => {
            let message = "the upper border is missing: the first row has cells";
            sink.warn(Code::MazBorder, first.span(), message, "a first line of blanks and `_` only");
            rows.insert(0, first.before());
        }
        Some(_) => {}
    }
    (rows, sizes)
}

/// Layout of the drawing: columns for walls and columns for cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Grid {
    /// Characters from one wall column to the next.
    pitch: u32,
    /// Characters before the first wall column, all blank.
    indent: u32,
}

/// Role of a character position in a row.
enum ColumnRole {
    /// A position on the grid line to the left of the cell column with this number.
    Wall(u32),
    /// A position in this cell column.
    Cell(u32),
}

impl Grid {
    /// EyeSim's layout, with walls in the columns 1, 3, 5, ...
    const USUAL: Grid = Grid { pitch: 2, indent: 0 };
    /// EyeSim's layout, indented by one character.
    const SHIFTED: Grid = Grid { pitch: 2, indent: 1 };
    /// A layout with cells two characters wide.
    const WIDE: Grid = Grid { pitch: 3, indent: 0 };

    /// Layout with all `|` of the `rows` in wall columns; the usual layout if none fits.
    fn of(sink: &mut Sink, rows: &[Line<'_>]) -> Grid {
        let fits = |grid: &Grid| {
            rows.iter().all(|row| {
                let characters = || drawing_characters(row);
                let is_on_line = |column| matches!(grid.role(column), Some(ColumnRole::Wall(_)));
                characters().all(|(column, c, _)| c != '|' || is_on_line(column))
                    && characters().take(grid.indent as usize).all(|(_, c, _)| c == ' ')
            })
        };
        let Some(grid) = [Grid::USUAL, Grid::SHIFTED, Grid::WIDE].into_iter().find(fits) else {
            return Grid::USUAL;
        };
        let span = rows.first().map(Line::span).unwrap_or_default();
        if grid == Grid::SHIFTED {
            let message = "the maze is indented by an odd number of characters; its first column is left out";
            sink.warn(Code::MazIndent, span, message, "walls in the columns 1, 3, 5, ...");
        } else if grid == Grid::WIDE {
            let message = "cells two characters wide; EyeSim reads walls in the columns 1, 3, 5, ... only";
            sink.warn(Code::MazWide, span, message, "cells one character wide");
        }
        grid
    }

    /// Role of the character at `position`, counted from 0; `None` before the drawing.
    fn role(self, position: u32) -> Option<ColumnRole> {
        let offset = position.checked_sub(self.indent)?;
        let column = offset / self.pitch;
        Some(if offset % self.pitch == 0 { ColumnRole::Wall(column) } else { ColumnRole::Cell(column) })
    }
}

/// Characters of a row: position from 0, character, span.
fn characters<'a>(line: &Line<'a>) -> impl Iterator<Item = (u32, char, Span)> + use<'a> {
    let line = *line;
    let characters = line.text.trim_end().char_indices().zip(0..);
    characters.map(move |((byte, character), column)| (column, character, line.character_span(byte, column + 1)))
}

/// Characters of a row without its comment. A comment begins at `;` or `#`, unless only blanks and walls follow: then
/// the character stands in a cell.
fn drawing_characters<'a>(line: &Line<'a>) -> impl Iterator<Item = (u32, char, Span)> + use<'a> {
    let is_comment = |(byte, character): &(usize, char)| {
        let rest = line.text[byte + character.len_utf8()..].trim_end();
        matches!(character, ';' | '#')
            && (rest.is_empty() || rest.contains(|c| !matches!(c, ' ' | '.' | '|' | '_' | '#' | ';')))
    };
    let length = line.text.char_indices().position(|entry| is_comment(&entry)).unwrap_or(usize::MAX);
    characters(line).take(length)
}

/// Content of a drawing, by columns and rows of cells; row 0 is the upper border.
struct Drawing {
    grid: Grid,
    /// Vertical wall pieces: (grid line to the left of this cell column, row, span).
    vertical: Vec<(u32, u32, Span)>,
    /// Horizontal wall pieces: (row above the wall, cell column, span).
    horizontal: Vec<(u32, u32, Span)>,
    /// Letters in cells: (lower-case letter, column, row, span).
    letters: Vec<(char, u32, u32, Span)>,
    columns: u32,
}

impl Drawing {
    fn new(grid: Grid) -> Self {
        Self { grid, vertical: Vec::new(), horizontal: Vec::new(), letters: Vec::new(), columns: 0 }
    }

    fn read_row(&mut self, sink: &mut Sink, row: u32, line: &Line<'_>) {
        let mut has_wall_in_cell = false;
        for (text_column, character, span) in drawing_characters(line) {
            let Some(role) = self.grid.role(text_column) else {
                continue;
            };
            match (character, role) {
                (' ' | '.', _) => {}
                ('|', ColumnRole::Wall(column)) => {
                    self.columns = self.columns.max(column);
                    self.vertical.push((column, row, span));
                }
                ('|', ColumnRole::Cell(column)) => {
                    if !has_wall_in_cell {
                        let message =
                            "`|` in the middle of a cell closes it on the right, and so do others in this row";
                        sink.warn(Code::MazWallColumn, span, message, "`|` in the columns 1, 3, 5, ...");
                    }
                    has_wall_in_cell = true;
                    self.columns = self.columns.max(column + 1);
                    self.vertical.push((column + 1, row, span));
                }
                ('_', ColumnRole::Cell(column)) => self.add_wall_below(row, column, span),
                // An underscore in a wall column belongs to the cell on the left.
                ('_', ColumnRole::Wall(0)) => {}
                ('_', ColumnRole::Wall(column)) => self.add_wall_below(row, column - 1, span),
                (letter, role) => self.add_letter(sink, row, role, letter, span),
            }
        }
    }

    /// Adds the wall below a cell.
    fn add_wall_below(&mut self, row: u32, column: u32, span: Span) {
        self.columns = self.columns.max(column + 1);
        self.horizontal.push((row, column, span));
    }

    fn add_letter(&mut self, sink: &mut Sink, row: u32, role: ColumnRole, letter: char, span: Span) {
        let kind = letter.to_ascii_lowercase();
        if !matches!(kind, 's' | 'u' | 'r' | 'd' | 'l' | 'o' | 'x') {
            let message = format!("`{}` means nothing in a maze", letter.escape_debug());
            let expected =
                "`|`, `_`, blank, `.`, or one of s u r d l (robot), o (ball), x (box), upper case with a wall below";
            sink.warn(Code::MazLetter, span, message, expected);
            return;
        }
        let column = match role {
            ColumnRole::Cell(column) => column,
            // A letter in a wall column belongs to the cell on the left; no row begins with a letter.
            ColumnRole::Wall(column) => column.saturating_sub(1),
        };
        self.columns = self.columns.max(column + 1);
        self.letters.push((kind, column, row, span));
        if letter.is_ascii_uppercase() {
            self.add_wall_below(row, column, span);
        }
    }

    /// A drawing without walls, in the usual layout.
    fn empty(columns: u32) -> Self {
        Self { columns, ..Self::new(Grid::USUAL) }
    }

    /// Warns about the first gap in the border of a maze with `rows` rows, if more than three quarters of it are
    /// closed.
    fn check_border(&self, sink: &mut Sink, rows: u32, span_of_row: impl Fn(u32) -> Span) {
        let vertical: BTreeSet<(u32, u32)> = self.vertical.iter().map(|(column, row, _)| (*column, *row)).collect();
        let horizontal: BTreeSet<(u32, u32)> = self.horizontal.iter().map(|(row, column, _)| (*row, *column)).collect();
        let sides = (1..=rows).flat_map(|row| {
            [("left", 0), ("right", self.columns)].map(|(side, column)| (side, row, vertical.contains(&(column, row))))
        });
        let ends = (0..self.columns).flat_map(|column| {
            [("upper", 0), ("lower", rows)].map(|(side, row)| (side, row, horizontal.contains(&(row, column))))
        });
        let edges: Vec<(&str, u32, bool)> = sides.chain(ends).collect();
        let open_count = edges.iter().filter(|(.., is_closed)| !is_closed).count();
        let Some((side, row, _)) = edges.iter().find(|(.., is_closed)| !is_closed) else { return };
        if 4 * open_count < edges.len() {
            let pieces = if open_count == 1 { "a wall is".to_owned() } else { format!("{open_count} walls are") };
            let message = format!("the border has a gap: {pieces} missing, the first on the {side} side");
            let expected = "a closed border, or a robot can leave the floor";
            sink.warn(Code::MazGap, span_of_row(*row), message, expected);
        }
    }

    fn into_world(mut self, sink: &mut Sink, file: &str, rows: u32, mut cell: f64) -> WorldSpec {
        let last = rows.saturating_sub(1);
        if f64::from(self.columns.max(last)) * cell > MAX_LENGTH {
            let message = "the maze is larger than 1000 km; cells of 360 mm are used instead";
            sink.error(Code::NumberRange, Span::default(), message, "a smaller cell size");
            cell = DEFAULT_CELL;
        }
        let corner = |column: u32, row: u32| DVec2::new(f64::from(column) * cell, f64::from(last - row) * cell);
        self.vertical.sort_unstable();
        self.horizontal.sort_unstable();
        // The upper border is row 0; a vertical piece begins at the lower edge of its row.
        let vertical = merge_runs(&self.vertical).map(|(column, first, end, span)| {
            let top = first.saturating_sub(1);
            (corner(column, end - 1), corner(column, top), span)
        });
        let horizontal =
            merge_runs(&self.horizontal).map(|(row, first, end, span)| (corner(first, row), corner(end, row), span));
        let walls = vertical.chain(horizontal).filter(|(from, to, _)| from != to).map(|(from, to, span)| WallSpec {
            from,
            to,
            thickness: 0.0,
            height: DEFAULT_WALL_HEIGHT,
            colour: None,
            surface: None,
            scatter: None,
            span,
        });
        let mut world = WorldSpec {
            file: file.to_owned(),
            floor: corner(self.columns, 0),
            cell: Some(cell),
            walls: walls.collect(),
            ..WorldSpec::default()
        };
        for (letter, column, row, span) in self.letters {
            let centre = corner(column, row) + DVec2::splat(0.5 * cell);
            let pose = |degrees| Pose::new(centre.x, centre.y, unit::radians_from_degrees(degrees));
            let mut start = |degrees| {
                let letter = Some(letter.to_ascii_uppercase());
                world.starts.push(StartSpec { pose: pose(degrees), letter, span });
            };
            match letter {
                's' | 'u' => start(90.0),
                'l' => start(180.0),
                'd' => start(270.0),
                'r' => start(0.0),
                'o' => world.objects.push(object_line(BALL, pose(0.0), span)),
                _ => world.objects.push(object_line(BOX, pose(0.0), span)),
            }
        }
        world
    }
}

/// Built-in types for the letters `o` and `x`.
const BALL: &str = "Soccer";
const BOX: &str = "Crate";

fn object_line(name: &str, pose: Pose, span: Span) -> ObjectLine {
    ObjectLine { kind: TypeRef::Name(SpannedText { text: name.to_owned(), span }), pose, span, ..ObjectLine::default() }
}

/// Merges adjacent pieces (line, position along it, span) of a sorted list into (line, first position, position after
/// the last, span of the first).
fn merge_runs(pieces: &[(u32, u32, Span)]) -> impl Iterator<Item = (u32, u32, u32, Span)> + '_ {
    pieces
        .chunk_by(|a, b| a.0 == b.0 && b.1 - a.1 <= 1)
        .filter_map(|run| Some((run.first()?.0, run.first()?.1, run.last()?.1 + 1, run.first()?.2)))
}
