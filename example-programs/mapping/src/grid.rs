//! Grid maps with square cells, and pictures of them.
//!
//! A [`GridGeometry`] defines position, size and number of the cells in the world; a [`Grid`] stores a value for each
//! cell. The column index increases with x and the row index with y, both from the grid's origin, its minimum corner. A
//! cell includes its lower and left edges, not its upper and right ones.

use std::io::Cursor;
use std::ops::{Index, IndexMut};

use image::{ImageError, ImageFormat, Rgb, RgbImage};

use crate::pose::Point;

/// A cell of a grid, by its column and row index, from 0.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub struct Cell {
    /// Index along x.
    pub column: usize,
    /// Index along y.
    pub row: usize,
}

impl Cell {
    /// The cell in a column and a row.
    pub fn new(column: usize, row: usize) -> Self {
        Self { column, row }
    }

    /// The cell offset by `columns` and `rows`; `None` if an index becomes negative.
    pub fn offset(self, columns: i64, rows: i64) -> Option<Self> {
        let column = usize::try_from(self.column as i64 + columns).ok()?;
        let row = usize::try_from(self.row as i64 + rows).ok()?;
        Some(Self { column, row })
    }
}

/// Position, size and number of the cells of a grid.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct GridGeometry {
    origin: Point,
    cell_size: f64,
    columns: usize,
    rows: usize,
}

impl GridGeometry {
    /// Cells of `cell_size` x `cell_size` metres, the first with its minimum corner at `origin`.
    ///
    /// # Panics
    /// If `cell_size` is infinite or not positive, `origin` is not finite, or there are no cells.
    pub fn new(origin: Point, cell_size: f64, columns: usize, rows: usize) -> Self {
        assert!(cell_size > 0.0 && cell_size.is_finite(), "a cell of {cell_size} m");
        assert!(origin.x.is_finite() && origin.y.is_finite(), "an origin at {origin}");
        assert!(columns > 0 && rows > 0, "a grid of {columns} x {rows} cells");
        Self { origin, cell_size, columns, rows }
    }

    /// The smallest grid that covers the rectangle from `min` to `max`, with cells of `cell_size` metres and its
    /// minimum corner at `min`.
    ///
    /// # Panics
    /// As [`GridGeometry::new`].
    pub fn covering(min: Point, max: Point, cell_size: f64) -> Self {
        // Tolerance: an excess of up to a millionth of a cell is rounding and adds no column or row.
        let cells = |length: f64| (length / cell_size - 1e-6).ceil().max(1.0) as usize;
        Self::new(min, cell_size, cells(max.x - min.x), cells(max.y - min.y))
    }

    /// The minimum corner, in metres.
    pub fn origin(&self) -> Point {
        self.origin
    }

    /// The length of a cell's side, in metres.
    pub fn cell_size(&self) -> f64 {
        self.cell_size
    }

    /// Number of cells along x.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of cells along y.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Returns true if the grid contains the cell.
    pub fn has(&self, cell: Cell) -> bool {
        cell.column < self.columns && cell.row < self.rows
    }

    /// The cell that contains a point; `None` outside the grid.
    pub fn cell_at(&self, point: Point) -> Option<Cell> {
        let in_cells = self.in_cells(point);
        let inside = |coordinate: f64, count: usize| (0.0..count as f64).contains(&coordinate);
        (inside(in_cells.x, self.columns) && inside(in_cells.y, self.rows))
            .then(|| Cell::new(in_cells.x as usize, in_cells.y as usize))
    }

    /// Converts a point to units of cells, relative to the grid's origin: (0.5, 0.5) is the centre of the first cell.
    pub fn in_cells(&self, point: Point) -> Point {
        Point::from((point - self.origin) / self.cell_size)
    }

    /// The centre of a cell, in metres; also for cells outside the grid.
    pub fn centre(&self, cell: Cell) -> Point {
        let middle = |index: usize| (index as f64 + 0.5) * self.cell_size;
        Point::new(self.origin.x + middle(cell.column), self.origin.y + middle(cell.row))
    }

    /// All cells, row by row from the origin.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + use<> {
        let columns = self.columns;
        (0..self.rows).flat_map(move |row| (0..columns).map(move |column| Cell { column, row }))
    }

    /// The cells whose centre is at most `radius` metres from `point`, row by row.
    pub fn disc(&self, point: Point, radius: f64) -> impl Iterator<Item = Cell> + use<> {
        let frame = *self;
        let centre = self.in_cells(point);
        let span = |middle: f64, count: usize| {
            let half_width = radius / frame.cell_size + 0.5;
            let bound = |coordinate: f64| coordinate.clamp(0.0, count as f64) as usize;
            bound((middle - half_width).floor())..bound((middle + half_width).ceil())
        };
        let (columns, rows) = (span(centre.x, self.columns), span(centre.y, self.rows));
        rows.flat_map(move |row| columns.clone().map(move |column| Cell { column, row }))
            .filter(move |cell| (frame.centre(*cell) - point).norm() <= radius)
    }

    /// The up to eight neighbours of a cell: right, upper right, and so on counter-clockwise.
    pub fn neighbours(&self, cell: Cell) -> impl Iterator<Item = Cell> + use<> {
        const OFFSETS: [(i64, i64); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];
        let frame = *self;
        OFFSETS
            .into_iter()
            .filter_map(move |(columns, rows)| cell.offset(columns, rows))
            .filter(move |neighbour| frame.has(*neighbour))
    }

    fn index(&self, cell: Cell) -> usize {
        assert!(self.has(cell), "{cell:?} in a grid of {} x {} cells", self.columns, self.rows);
        cell.row * self.columns + cell.column
    }
}

/// A value for each cell of a [`GridGeometry`].
#[derive(Clone, PartialEq, Debug)]
pub struct Grid<T> {
    frame: GridGeometry,
    values: Vec<T>,
}

impl<T> Grid<T> {
    /// A grid of the values that `value` returns for the cells; `value` is called row by row.
    pub fn from_fn(frame: GridGeometry, value: impl FnMut(Cell) -> T) -> Self {
        Self { values: frame.cells().map(value).collect(), frame }
    }

    /// The geometry of the grid.
    pub fn frame(&self) -> &GridGeometry {
        &self.frame
    }

    /// The value of a cell; `None` outside the grid.
    pub fn get(&self, cell: Cell) -> Option<&T> {
        self.frame.has(cell).then(|| &self[cell])
    }

    /// Mutable access to the value of a cell; `None` outside the grid.
    pub fn get_mut(&mut self, cell: Cell) -> Option<&mut T> {
        if self.frame.has(cell) { Some(&mut self[cell]) } else { None }
    }

    /// The value at a point, in metres; `None` outside the grid.
    pub fn at(&self, point: Point) -> Option<&T> {
        self.frame.cell_at(point).map(|cell| &self[cell])
    }

    /// All cells with their values, row by row.
    pub fn iter(&self) -> impl Iterator<Item = (Cell, &T)> {
        self.frame.cells().zip(&self.values)
    }

    /// The values, row by row from the origin.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// Mutable access to the values, row by row from the origin.
    pub fn values_mut(&mut self) -> &mut [T] {
        &mut self.values
    }

    /// A grid of the same geometry whose values are the results of `change`.
    pub fn map<U>(&self, change: impl FnMut(&T) -> U) -> Grid<U> {
        Grid { frame: self.frame, values: self.values.iter().map(change).collect() }
    }

    /// A picture that shows each cell as a square of `pixels` x `pixels` in its colour (red, green, blue); x points to
    /// the right, y upwards. If `pixels` is 0, the picture is empty.
    ///
    /// # Panics
    /// If a side of the picture has 2^32 pixels or more.
    pub fn picture(&self, pixels: u32, colour: impl Fn(&T) -> [u8; 3]) -> RgbImage {
        let side = |cells: usize| u32::try_from(cells).ok().and_then(|cells| cells.checked_mul(pixels));
        let (Some(width), Some(height)) = (side(self.frame.columns), side(self.frame.rows)) else {
            panic!("a picture of {} x {} cells with {pixels} pixels each", self.frame.columns, self.frame.rows);
        };
        RgbImage::from_fn(width, height, |x, y| {
            let row = self.frame.rows - 1 - (y / pixels) as usize;
            Rgb(colour(&self[Cell::new((x / pixels) as usize, row)]))
        })
    }
}

impl<T: Clone> Grid<T> {
    /// A grid with the same value in each cell.
    pub fn new(frame: GridGeometry, value: T) -> Self {
        Self { values: vec![value; frame.columns * frame.rows], frame }
    }
}

impl<T> Index<Cell> for Grid<T> {
    type Output = T;

    fn index(&self, cell: Cell) -> &T {
        &self.values[self.frame.index(cell)]
    }
}

impl<T> IndexMut<Cell> for Grid<T> {
    fn index_mut(&mut self, cell: Cell) -> &mut T {
        let index = self.frame.index(cell);
        &mut self.values[index]
    }
}

/// A shade of grey for a probability: white for 0, black for 1.
pub fn grey(probability: f64) -> [u8; 3] {
    [(255.0 * (1.0 - probability.clamp(0.0, 1.0))).round() as u8; 3]
}

/// A picture as the bytes of a PNG file.
///
/// # Errors
/// If the picture cannot be encoded, e.g. if it has no pixels.
pub fn png(picture: &RgbImage) -> Result<Vec<u8>, ImageError> {
    let mut bytes = Cursor::new(Vec::new());
    picture.write_to(&mut bytes, ImageFormat::Png)?;
    Ok(bytes.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> GridGeometry {
        GridGeometry::new(Point::new(-1.0, 2.0), 0.5, 4, 3)
    }

    #[test]
    fn cells_exclude_their_upper_and_right_edges() {
        let check = |x, y, expected| assert_eq!(frame().cell_at(Point::new(x, y)), expected, "({x}, {y})");
        check(-1.0, 2.0, Some(Cell::new(0, 0)));
        check(-0.5, 2.49, Some(Cell::new(1, 0)));
        check(0.99, 3.49, Some(Cell::new(3, 2)));
        check(1.0, 3.0, None);
        check(0.0, 3.5, None);
        check(-1.000_001, 3.0, None);
        check(f64::NAN, 3.0, None);
    }

    #[test]
    fn cell_at_inverts_centre() {
        assert_eq!(frame().centre(Cell::new(3, 0)), Point::new(0.75, 2.25));
        for cell in frame().cells() {
            assert_eq!(frame().cell_at(frame().centre(cell)), Some(cell));
        }
    }

    #[test]
    fn covering_gives_the_smallest_grid() {
        let covering = |width, size| GridGeometry::covering(Point::origin(), Point::new(width, 1.0), size).columns();
        assert_eq!((covering(4.0, 0.05), covering(4.01, 0.05), covering(0.3, 0.1), covering(0.0, 0.1)), (80, 81, 3, 1));
    }

    #[test]
    fn disc_contains_the_cells_whose_middles_are_within_the_radius() {
        for (x, y, radius) in [(0.1, 2.9, 0.6), (-1.2, 2.0, 0.8), (5.0, 2.0, 0.5), (0.25, 2.25, 0.0)] {
            let point = Point::new(x, y);
            let expected: Vec<Cell> =
                frame().cells().filter(|cell| (frame().centre(*cell) - point).norm() <= radius).collect();
            assert_eq!(frame().disc(point, radius).collect::<Vec<_>>(), expected, "{point} {radius}");
        }
    }

    #[test]
    fn neighbours_are_inside_the_grid() {
        assert_eq!(frame().neighbours(Cell::new(1, 1)).count(), 8);
        let corner = [Cell::new(1, 0), Cell::new(1, 1), Cell::new(0, 1)];
        assert_eq!(frame().neighbours(Cell::new(0, 0)).collect::<Vec<_>>(), corner);
    }

    #[test]
    fn pictures_show_y_upwards() {
        let mut grid = Grid::new(frame(), 0.0);
        grid[Cell::new(3, 0)] = 1.0;
        let picture = grid.picture(2, |value| grey(*value));
        assert_eq!(picture.dimensions(), (8, 6));
        assert_eq!((picture[(7, 5)], picture[(6, 4)], picture[(5, 5)], picture[(7, 3)]), {
            let (black, white) = (Rgb([0; 3]), Rgb([255; 3]));
            (black, black, white, white)
        });
        let decoded = image::load_from_memory(&png(&picture).expect("encodes")).expect("decodes");
        assert_eq!(decoded.to_rgb8(), picture);
    }

    #[test]
    #[should_panic(expected = "in a grid of 4 x 3 cells")]
    fn indexing_outside_the_grid_panics() {
        let _ = Grid::new(frame(), 0)[Cell::new(4, 0)];
    }
}
