//! Mazes drawn with posts and walls, the format of collections of micro-mouse contests.
//!
//! Source: the collections of micromouseonline.com (`o---o`) and the simulator mms (`+---+`).

use super::cells::{StartAndGoals, add_start};
use super::{ContestMaze, Drawing};
use crate::Span;
use crate::code::Code;
use crate::diagnostic::Sink;
use crate::line::{self, Line};

const FORM: &str = "lines of posts, `o---o   o`, and of cells, `|   | S |`, in turn";

/// Number of columns from one tab stop to the next.
const TAB: usize = 8;

/// Positions of the posts in the lines of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Lattice {
    post: char,
    /// Characters before the first post.
    indent: usize,
    /// Characters from one post to the next.
    pitch: usize,
    columns: usize,
}

/// The characters of a line with their spans, tabs expanded.
fn characters(line: &Line<'_>) -> Vec<(char, Span)> {
    let mut out = Vec::new();
    for ((byte, character), column) in line.text.trim_end().char_indices().zip(1..) {
        let span = line.character_span(byte, column);
        if character == '\t' {
            let count = TAB - out.len() % TAB;
            out.extend(std::iter::repeat_n((' ', span), count));
        } else {
            out.push((character, span));
        }
    }
    out
}

impl Lattice {
    /// The lattice of a drawing with `line` as its first line of posts; `None` if `line` is not a line of posts.
    fn of(line: &[(char, Span)]) -> Option<Self> {
        let indent = line.iter().position(|(character, _)| *character != ' ')?;
        let characters: Vec<char> = line[indent..].iter().map(|(character, _)| *character).collect();
        let post = *characters.first().filter(|post| matches!(post, 'o' | 'O' | '+'))?;
        let pitch = 1 + characters[1..].iter().position(|character| *character == post)?;
        let is_post_line = characters.iter().enumerate().all(|(index, character)| {
            if index % pitch == 0 { *character == post } else { !character.is_alphanumeric() && *character != post }
        });
        let columns = (characters.len() - 1) / pitch;
        (pitch > 1 && is_post_line && characters.len() % pitch == 1).then_some(Self { post, indent, pitch, columns })
    }

    /// Position of the post to the left of this column.
    fn post_at(&self, column: usize) -> usize {
        self.indent + column * self.pitch
    }
}

/// Returns true if `text` has a line of posts with a wall between them, or two lines of the same posts with a row of
/// cells between them. A single line of letters `o` may be a row of EyeSim's drawing, with balls in its cells.
pub(super) fn is_posts(text: &str) -> bool {
    let lattice_of = |line: Line<'_>| {
        let is_short = line.text.len() < 1 << 16;
        let lattice = is_short.then(|| Lattice::of(&characters(&line))).flatten()?;
        Some((lattice, line.text.contains(|c| !matches!(c, ' ' | '\t' | '.' | '_') && c != lattice.post)))
    };
    let lattices: Vec<Option<(Lattice, bool)>> = line::lines(text).map(lattice_of).collect();
    let has_wall = lattices.iter().flatten().any(|(_, has_wall)| *has_wall);
    has_wall || lattices.windows(3).any(|lines| lines[0].is_some() && lines[0] == lines[2])
}

pub(super) fn read(sink: &mut Sink, text: &str) -> ContestMaze {
    let mut lines = line::lines(text);
    let mut lines_before = 0;
    let border_line = loop {
        let Some(line) = lines.next() else {
            sink.error(Code::MazEmpty, Span::default(), "the file has no maze", FORM);
            return ContestMaze { drawing: Drawing::empty(0), rows: 1, note: None };
        };
        match Lattice::of(&characters(&line)) {
            Some(lattice) => break (line, lattice),
            None => lines_before += usize::from(!line.text.trim().is_empty()),
        }
    };
    let (border, lattice) = border_line;
    let mut posts =
        Posts { lattice, drawing: Drawing::empty(lattice.columns as u32), starts: Vec::new(), goals: Vec::new() };
    posts.post_line(sink, &border, 0);
    let mut rows = 0;
    let mut lines_after = 0;
    while let Some(line) = lines.next() {
        let content = characters(&line);
        let is_row =
            content.get(lattice.indent).is_none_or(|(character, _)| matches!(character, '|' | ' ' | ':' | '!'))
                && content.iter().take(lattice.indent).all(|(character, _)| *character == ' ')
                && !content.is_empty();
        if !is_row {
            lines_after += usize::from(!content.is_empty());
            break;
        }
        rows += 1;
        posts.cell_line(sink, &line, rows);
        let posts_below = lines.next().filter(|line| posts.is_post_line(line));
        match posts_below {
            Some(line) => posts.post_line(sink, &line, rows),
            None => {
                let message = "the line of posts below this row is missing";
                sink.warn(Code::MazPosts, line.span(), message, FORM);
                break;
            }
        }
    }
    lines_after += lines.filter(|line| !line.text.trim().is_empty()).count();
    if rows == 0 {
        sink.error(Code::MazEmpty, border.span(), "the maze has no rows", FORM);
        return ContestMaze { drawing: Drawing::empty(0), rows: 1, note: None };
    }
    let Posts { mut drawing, starts, goals, .. } = posts;
    let from_south = |(column, row): (usize, usize)| [column, rows - row];
    let mut start_and_goals = StartAndGoals::usual([lattice.columns, rows]);
    let mut span = Span::default();
    if let Some((start, start_span)) = starts.first() {
        (start_and_goals.start, span) = (from_south(*start), *start_span);
    }
    if let Some((_, second_span)) = starts.get(1) {
        sink.warn(Code::MazLetter, *second_span, "a second start; the first one counts", "one `S`");
    }
    if !goals.is_empty() {
        start_and_goals.goals = goals.into_iter().map(from_south).collect();
    }
    let mut note = add_start(&mut drawing, rows, &start_and_goals, span);
    if lines_before + lines_after > 0 {
        note.push_str(&format!("; {} lines beside the drawing are left out", lines_before + lines_after));
    }
    ContestMaze { drawing, rows, note: Some(note) }
}

struct Posts {
    lattice: Lattice,
    drawing: Drawing,
    starts: Vec<((usize, usize), Span)>,
    goals: Vec<(usize, usize)>,
}

impl Posts {
    fn is_post_line(&self, line: &Line<'_>) -> bool {
        let content = characters(line);
        let first = content.iter().position(|(character, _)| *character != ' ');
        first.is_some_and(|first| first == self.lattice.indent && content[first].0 == self.lattice.post)
    }

    /// Reads a line of posts, with the walls below row `row`.
    fn post_line(&mut self, sink: &mut Sink, line: &Line<'_>, row: usize) {
        let content = characters(line);
        let Lattice { post, pitch, columns, .. } = self.lattice;
        let character_at = |index: usize| content.get(index).map_or(' ', |character| character.0);
        if let Some(column) = (0..=columns).find(|column| character_at(self.lattice.post_at(*column)) != post) {
            let message = format!("post {} of this line is missing", column + 1);
            sink.warn(Code::MazPosts, line.span(), message, format!("a `{post}` after each {} characters", pitch - 1));
        }
        self.check_end(sink, &content);
        for column in 0..columns {
            let begin = self.lattice.post_at(column) + 1;
            let pieces = (begin..begin + pitch - 1).filter(|index| character_at(*index) != ' ').count();
            if pieces == 0 {
                continue;
            }
            let index = (begin..).find(|index| character_at(*index) != ' ').unwrap_or(begin);
            let span = content.get(index).map_or(line.span(), |character| character.1);
            if pieces < pitch - 1 {
                let message = "a wall with gaps; it is read as a complete wall";
                sink.warn(Code::MazPosts, span, message, format!("{} characters from post to post", pitch - 1));
            }
            self.drawing.horizontal.push((row as u32, column as u32, span));
        }
    }

    /// Reads a line of cells, row `row` from the top, counted from 1.
    fn cell_line(&mut self, sink: &mut Sink, line: &Line<'_>, row: usize) {
        let content = characters(line);
        self.check_end(sink, &content);
        let Lattice { indent, pitch, columns, .. } = self.lattice;
        for (text_column, (character, span)) in content.iter().enumerate().skip(indent) {
            let (column, offset) = ((text_column - indent) / pitch, (text_column - indent) % pitch);
            if *character == ' ' || column > columns || column == columns && offset > 0 {
                continue;
            }
            if offset == 0 {
                self.drawing.vertical.push((column as u32, row as u32, *span));
                continue;
            }
            match character.to_ascii_lowercase() {
                's' => self.starts.push(((column, row), *span)),
                'g' => self.goals.push((column, row)),
                _ => {
                    let message = format!("`{}` means nothing in a cell", character.escape_debug());
                    sink.warn(Code::MazLetter, *span, message, "`S` for the start, `G` for a goal, or blanks");
                }
            }
        }
    }

    /// Reports characters beyond the last post.
    fn check_end(&self, sink: &mut Sink, content: &[(char, Span)]) {
        let end = self.lattice.post_at(self.lattice.columns);
        if let Some((_, span)) = content.iter().skip(end + 1).find(|(character, _)| *character != ' ') {
            let message = format!("the line goes beyond the {} posts of the first one", self.lattice.columns + 1);
            sink.warn(Code::MazPosts, *span, message, FORM);
        }
    }
}
