//! Small pictures of failures for a terminal, drawn with Braille characters: walls, the paths of the robots and the
//! location of the failure.

use glam::DVec2;
use sim_host::launch::Scene;

use crate::suite::{Case, CaseResult};

/// Maximum numbers of characters across and down.
const SIZE: [usize; 2] = [44, 13];
/// Numbers of dots of a character across and down.
const DOTS: [usize; 2] = [2, 4];

/// Lines of the picture; none if the result has no paths or the scene cannot be read.
pub(super) fn lines(case: &Case, result: &CaseResult) -> Vec<String> {
    if result.traces.is_empty() {
        return Vec::new();
    }
    let Ok(scene) = Scene::open(&case.scene, case.options.clone()) else { return Vec::new() };
    let (mut low, mut high) = scene.spec().world.bounds();
    let paths =
        || result.traces.iter().flat_map(|trace| &trace.lines).map(|line| line.iter().map(|point| DVec2::from(*point)));
    for point in paths().flatten() {
        (low, high) = (low.min(point), high.max(point));
    }
    let mut canvas = Canvas::new(low, high);
    for wall in &scene.spec().world.walls {
        canvas.draw(wall.from, wall.to);
    }
    for path in paths() {
        let points: Vec<DVec2> = path.collect();
        points.windows(2).for_each(|pair| canvas.draw(pair[0], pair[1]));
    }
    for start in paths().filter_map(|mut path| path.next()) {
        canvas.mark(start, 'o');
    }
    if let (Some(x), Some(y)) = (result.row.x_m, result.row.y_m) {
        canvas.mark(DVec2::new(x, y), 'X');
    }
    canvas.lines()
}

/// Grid of characters with eight dots each.
struct Canvas {
    low: DVec2,
    /// Dots per metre.
    scale: f64,
    columns: usize,
    rows: usize,
    cells: Vec<u8>,
    marks: Vec<Option<char>>,
}

impl Canvas {
    fn new(low: DVec2, high: DVec2) -> Self {
        let size = (high - low).max(DVec2::splat(1e-6));
        let dots = |axis: usize| (SIZE[axis] * DOTS[axis] - 1) as f64;
        let scale = (dots(0) / size.x).min(dots(1) / size.y);
        let characters = |length: f64, axis: usize| ((length * scale) as usize / DOTS[axis] + 1).min(SIZE[axis]);
        let (columns, rows) = (characters(size.x, 0), characters(size.y, 1));
        Self { low, scale, columns, rows, cells: vec![0; columns * rows], marks: vec![None; columns * rows] }
    }

    /// Dot of a point, counted from the upper left one.
    fn dot(&self, point: DVec2) -> [i64; 2] {
        let offset = (point - self.low) * self.scale;
        let last = (self.rows * DOTS[1]) as i64 - 1;
        [offset.x as i64, last - offset.y as i64]
    }

    fn cell(&self, [x, y]: [i64; 2]) -> Option<usize> {
        let [column, row] = [x.checked_div(DOTS[0] as i64)?, y.checked_div(DOTS[1] as i64)?];
        let is_inside = x >= 0 && y >= 0 && (column as usize) < self.columns && (row as usize) < self.rows;
        is_inside.then(|| row as usize * self.columns + column as usize)
    }

    fn draw(&mut self, from: DVec2, to: DVec2) {
        /// Bits of the dots of a Braille character, by row and column.
        const BITS: [[u8; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];
        // Two steps per dot, so that no dot is omitted.
        let steps = (2.0 * (to - from).abs().max_element() * self.scale).ceil().clamp(1.0, 1e4) as usize;
        for step in 0..=steps {
            let [x, y] = self.dot(from + (to - from) * (step as f64 / steps as f64));
            if let Some(cell) = self.cell([x, y]) {
                self.cells[cell] |= BITS[y as usize % DOTS[1]][x as usize % DOTS[0]];
            }
        }
    }

    fn mark(&mut self, at: DVec2, sign: char) {
        if let Some(cell) = self.cell(self.dot(at)) {
            self.marks[cell] = Some(sign);
        }
    }

    fn lines(&self) -> Vec<String> {
        let character = |(bits, mark): (&u8, &Option<char>)| {
            mark.unwrap_or_else(|| char::from_u32(0x2800 + u32::from(*bits)).filter(|_| *bits > 0).unwrap_or(' '))
        };
        let rows = self.cells.chunks(self.columns).zip(self.marks.chunks(self.columns));
        rows.map(|(cells, marks)| cells.iter().zip(marks).map(character).collect::<String>().trim_end().to_owned())
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn square_is_drawn_with_corners_and_marks() {
        let mut canvas = Canvas::new(DVec2::ZERO, DVec2::ONE);
        let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y, DVec2::ZERO];
        corners.windows(2).for_each(|pair| canvas.draw(pair[0], pair[1]));
        canvas.mark(DVec2::splat(0.5), 'X');
        let lines = canvas.lines();
        assert_eq!(lines.len(), SIZE[1]);
        assert!(lines.iter().all(|line| line.chars().count() == lines[0].chars().count()), "{lines:#?}");
        assert!(lines[SIZE[1] / 2].contains('X') || lines[SIZE[1] / 2 - 1].contains('X'), "{lines:#?}");
        assert!(lines[0].starts_with('⡏') && lines[SIZE[1] - 1].starts_with('⣇'), "{lines:#?}");
    }
}
