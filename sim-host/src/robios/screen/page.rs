//! Text and pixels of a display; the pixels are allocated lazily.
//!
//! Most programs only print; then the page is a list of characters on black. The first drawing allocates the pixels,
//! and from then on text is written to the list and to the pixels; [`Page::clear`] drops the pixels again. A page looks
//! the same with and without allocated pixels.

use std::collections::BTreeMap;

use super::canvas::{BLACK, Canvas, Ink, Rgb};
use super::font::Font;

/// A character on the page, as wide as its glyph and as high as its font's cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The character.
    pub character: char,
    /// Font of the character.
    pub font: Font,
    /// Width in pixels.
    pub width: u8,
    /// Colour of the character.
    pub ink: Rgb,
    /// Background colour; `None` for a transparent background.
    pub paper: Option<Rgb>,
}

/// Upper left corner of a character: y, then x.
type CellIndex = (u16, u16);

/// A rectangle: left, top, and the first column and row beyond the rectangle.
type Area = [i64; 4];

/// Content of a display except for list and menu.
#[derive(Clone, Debug)]
pub struct Page {
    width: u16,
    height: u16,
    /// Pixels; while `None`, the page is black except for `cells`, all of which have a background colour.
    canvas: Option<Canvas>,
    /// Characters that have not been covered since they were written; no two overlap.
    cells: BTreeMap<CellIndex, Cell>,
}

impl Cell {
    fn height(&self) -> u8 {
        self.font.size.cell()[1]
    }

    fn area(&self, (y, x): CellIndex) -> Area {
        let (x, y) = (i64::from(x), i64::from(y));
        [x, y, x + i64::from(self.width), y + i64::from(self.height())]
    }

    fn draw(&self, (y, x): CellIndex, canvas: &mut Canvas) {
        let (x, y) = (i32::from(x), i32::from(y));
        if let Some(paper) = self.paper {
            let corner = [x + i32::from(self.width) - 1, y + i32::from(self.height()) - 1];
            canvas.fill_area([x, y], corner, Ink::Colour(paper));
        }
        draw_glyph(canvas, [x, y], self.font, self.character, self.ink);
    }
}

impl Page {
    /// A black page.
    pub fn new(width: u16, height: u16) -> Self {
        Self { width, height, canvas: None, cells: BTreeMap::new() }
    }

    /// Makes the page black and removes its text.
    pub fn clear(&mut self) {
        (self.canvas, self.cells) = (None, BTreeMap::new());
    }

    /// The pixels for drawing, allocated if necessary.
    pub fn canvas_mut(&mut self) -> &mut Canvas {
        let Self { width, height, canvas, cells } = self;
        canvas.get_or_insert_with(|| paint(*width, *height, cells))
    }

    /// A copy of the current pixels.
    pub fn picture(&self) -> Canvas {
        self.canvas.clone().unwrap_or_else(|| paint(self.width, self.height, &self.cells))
    }

    /// Writes a character; a character that is not entirely on the page is ignored.
    pub fn put(&mut self, x: i32, y: i32, mut cell: Cell) {
        let (Ok(x), Ok(y)) = (u16::try_from(x), u16::try_from(y)) else { return };
        let index = (y, x);
        let area = cell.area(index);
        if area[2] > i64::from(self.width) || area[3] > i64::from(self.height) {
            return;
        }
        let overwritten =
            self.cells.get_mut(&index).filter(|old| (old.width, old.font.size) == (cell.width, cell.font.size));
        match overwritten {
            // The most frequent case by far: the cell is overwritten in place.
            Some(old) if cell.paper.is_some() => *old = cell,
            _ => self.replace_overlapping(area, &mut cell, index),
        }
        if let Some(canvas) = &mut self.canvas {
            cell.draw(index, canvas);
        }
    }

    fn replace_overlapping(&mut self, area: Area, cell: &mut Cell, index: CellIndex) {
        let under = self.overlapping(area);
        let is_covered = |under: &CellIndex| contains(area, self.cells[under].area(*under));
        if self.canvas.is_none() && !under.is_empty() && !(cell.paper.is_some() && under.iter().all(is_covered)) {
            self.canvas_mut();
        }
        if self.canvas.is_none() {
            // The background is black here.
            cell.paper.get_or_insert(BLACK);
        }
        under.iter().for_each(|under| _ = self.cells.remove(under));
        self.cells.insert(index, *cell);
    }

    /// Positions of the characters that share a pixel with `area`.
    fn overlapping(&self, area: Area) -> Vec<CellIndex> {
        let [left, top, right, bottom] = area;
        let min_y = top - i64::from(super::font::Size::Huge.cell()[1]);
        let range = (min_y.max(0) as u16, 0)..(bottom.clamp(0, i64::from(u16::MAX)) as u16, 0);
        let overlaps = |(cell_index, cell): &(&CellIndex, &Cell)| {
            let [x1, y1, x2, y2] = cell.area(**cell_index);
            x1 < right && x2 > left && y1 < bottom && y2 > top
        };
        self.cells.range(range).filter(overlaps).map(|(cell_index, _)| *cell_index).collect()
    }

    /// Removes the text that the rectangle between two corners, edges included, covers entirely.
    pub fn cover(&mut self, [x1, y1]: [i32; 2], [x2, y2]: [i32; 2]) {
        let [left, top] = [x1.min(x2), y1.min(y2)].map(i64::from);
        let [right, bottom] = [x1.max(x2), y1.max(y2)].map(|last| i64::from(last) + 1);
        self.cells.retain(|index, cell| !contains([left, top, right, bottom], cell.area(*index)));
    }

    /// Moves everything above `bottom` up by `distance` pixels.
    pub fn scroll(&mut self, bottom: u16, distance: u16) {
        let (end, first) = (i64::from(bottom), i64::from(distance));
        let is_cut = |(index, cell): (&CellIndex, &Cell)| {
            let [_, y1, _, y2] = cell.area(*index);
            (y1 < first && y2 > first) || (y1 < end && y2 > end)
        };
        if self.canvas.is_none() && self.cells.iter().any(is_cut) {
            self.canvas_mut();
        }
        if let Some(canvas) = &mut self.canvas {
            canvas.scroll(bottom.into(), distance.into());
        }
        let moved = |((y, x), cell): (CellIndex, Cell)| {
            let [_, y1, _, y2] = cell.area((y, x));
            if y1 >= end { Some(((y, x), cell)) } else { (y1 >= first && y2 <= end).then(|| ((y - distance, x), cell)) }
        };
        self.cells = std::mem::take(&mut self.cells).into_iter().filter_map(moved).collect();
    }

    /// The text from the top, one string per row of its font, without trailing blanks and without empty rows at the
    /// end.
    pub fn lines(&self) -> Vec<String> {
        let mut lines: Vec<String> = Vec::new();
        let mut previous: Option<(u16, i64)> = None;
        for (&(y, x), cell) in &self.cells {
            let [column_width, row_height] = cell.font.size.cell().map(usize::from);
            let end = match previous {
                Some((line, end)) if line == y => end,
                _ => {
                    lines.resize_with(lines.len().max(usize::from(y) / row_height) + 1, String::new);
                    0
                }
            };
            let gap = usize::try_from(i64::from(x) - end).unwrap_or(0);
            if let Some(line) = lines.last_mut() {
                line.extend(std::iter::repeat_n(' ', (gap + column_width / 2) / column_width));
                line.push(cell.character);
            }
            previous = Some((y, i64::from(x) + i64::from(cell.width)));
        }
        lines.iter_mut().for_each(|line| line.truncate(line.trim_end().len()));
        let count = lines.iter().rposition(|line| !line.is_empty()).map_or(0, |last| last + 1);
        lines.truncate(count);
        lines
    }

    /// Returns true while the page needs no memory for pixels.
    #[cfg(test)]
    pub fn has_only_text(&self) -> bool {
        self.canvas.is_none()
    }
}

/// Draws a character with the upper left corner of its cell at (x, y), on a transparent background.
pub fn draw_glyph(canvas: &mut Canvas, [x, y]: [i32; 2], font: Font, character: char, ink: Rgb) {
    if character == ' ' {
        return;
    }
    let glyph = font.glyph(character);
    for (row, coverage) in (y..).zip(glyph.coverage.chunks(usize::from(glyph.width).max(1))) {
        for (column, &pixel_coverage) in (x..).zip(coverage) {
            if pixel_coverage > 0 {
                canvas.blend(column, row, ink, pixel_coverage);
            }
        }
    }
}

/// Draws the characters on a black canvas.
fn paint(width: u16, height: u16, cells: &BTreeMap<CellIndex, Cell>) -> Canvas {
    let mut canvas = Canvas::new(width.into(), height.into(), BLACK);
    cells.iter().for_each(|(index, cell)| cell.draw(*index, &mut canvas));
    canvas
}

fn contains(outer: Area, inner: Area) -> bool {
    outer[0] <= inner[0] && outer[1] <= inner[1] && outer[2] >= inner[2] && outer[3] >= inner[3]
}
