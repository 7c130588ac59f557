//! Terrain as a height over the plane: heights at points, and the surface as a mesh for rays.

mod clearance;
#[cfg(test)]
mod tests;

use glam::{DVec2, DVec3};

use super::{Bounds, Material, Mesh, Triangle};

/// Maximum number of cells of a height field: as many as an image of 1025 x 1025 pixels has.
pub const MAX_CELLS: usize = 1 << 20;

/// Number of height bands with different colours.
const BANDS: usize = 24;

/// Colours (red, green, blue) from the lowest to the highest ground. Source: the order of colours on relief maps (green
/// plains, brown heights, pale tops); our choice.
const TINTS: [[f32; 3]; 5] =
    [[0.42, 0.52, 0.36], [0.62, 0.64, 0.42], [0.74, 0.64, 0.44], [0.62, 0.48, 0.36], [0.92, 0.89, 0.84]];

/// Height as a function of the position in a rectangle of the plane, world frame, in metres.
///
/// The heights are given at the corners of a rectilinear grid. Each cell is divided into two triangles by the diagonal
/// from its minimum x and y to its maximum x and y, so the surface is continuous and rays find no gap. (There is one
/// exception: if steps along x and along y meet in one vertical line with more than two heights, a ray aimed exactly at
/// that line may pass within rounding.) A grid coordinate may occur twice. The cell between the two lines then has no
/// width and is an exact vertical step. Outside the rectangle the ground continues level from its border, see
/// [`height`](Self::height), but rays hit nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    xs: Vec<f64>,
    ys: Vec<f64>,
    /// Heights row by row along y, in each row along x.
    heights: Vec<f64>,
    min_height: f64,
    max_height: f64,
}

/// Reason why data do not form a height field.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FieldError {
    /// Too few coordinates, or too few distinct ones.
    #[error("a terrain has two different places at least along either axis")]
    Small,
    /// More cells than [`MAX_CELLS`].
    #[error("{0} cells are more than {MAX_CELLS}")]
    Large(usize),
    /// Decreasing coordinates, or three or more equal ones.
    #[error("the places along an axis do not rise, or come more than twice")]
    Order,
    /// The number of heights differs from the number of corners.
    #[error("{0} heights for {1} corners")]
    Count(usize, usize),
    /// A coordinate or height is infinite or NaN, or beyond 10^9 m.
    #[error("a place or height is not a number up to 1e9 m")]
    Number,
}

impl HeightField {
    /// The field with the corners `xs` times `ys` and their heights, row by row along y, in each row along x.
    ///
    /// # Errors
    /// See [`FieldError`].
    pub fn new(xs: Vec<f64>, ys: Vec<f64>, heights: Vec<f64>) -> Result<Self, FieldError> {
        // NaN fails this comparison.
        let is_number = |value: &f64| value.abs() <= 1e9;
        if !xs.iter().chain(&ys).chain(&heights).all(is_number) {
            return Err(FieldError::Number);
        }
        for lines in [&xs, &ys] {
            if lines.len() < 2 || lines[0] == lines[lines.len() - 1] {
                return Err(FieldError::Small);
            }
            let is_sorted = lines.windows(2).all(|pair| pair[0] <= pair[1]);
            if !is_sorted || lines.windows(3).any(|three| three[0] == three[2]) {
                return Err(FieldError::Order);
            }
        }
        let cells = (xs.len() - 1).saturating_mul(ys.len() - 1);
        if cells > MAX_CELLS {
            return Err(FieldError::Large(cells));
        }
        if heights.len() != xs.len() * ys.len() {
            return Err(FieldError::Count(heights.len(), xs.len() * ys.len()));
        }
        let min_height = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let max_height = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Ok(Self { xs, ys, heights, min_height, max_height })
    }

    /// The rectangle that the field covers, in metres.
    pub fn bounds(&self) -> Bounds {
        let [(left, right), (lower, upper)] = [&self.xs, &self.ys].map(|lines| (lines[0], lines[lines.len() - 1]));
        Bounds { min: DVec2::new(left, lower), max: DVec2::new(right, upper) }
    }

    /// Lowest and highest height, in metres.
    pub fn height_bounds(&self) -> (f64, f64) {
        (self.min_height, self.max_height)
    }

    /// Number of corners along x and along y.
    pub fn size(&self) -> (usize, usize) {
        (self.xs.len(), self.ys.len())
    }

    /// The corner in `column` along x and `row` along y, with its height.
    ///
    /// # Panics
    /// If the corner does not exist.
    pub fn corner(&self, column: usize, row: usize) -> DVec3 {
        DVec3::new(self.xs[column], self.ys[row], self.corner_height(column, row))
    }

    /// Height of the ground at a point in the world frame, in metres. At a step, it is the height of the upper side;
    /// outside the rectangle, it is the height of the nearest point of the border. NaN if a coordinate is NaN.
    pub fn height(&self, x: f64, y: f64) -> f64 {
        if x.is_nan() || y.is_nan() {
            return f64::NAN;
        }
        let (columns, rows) = (AxisPosition::new(&self.xs, x), AxisPosition::new(&self.ys, y));
        let mut highest = f64::NEG_INFINITY;
        for row in rows.iter() {
            for column in columns.iter() {
                highest = highest.max(self.interpolate(column, row));
            }
        }
        // Where a step along x crosses a step along y, the diagonal of the vertical cell may rise above both.
        let ((column, right), (row, up)) = (columns.first, rows.first);
        let fraction = if columns.second.is_some() { up } else { right };
        if fraction > 0.0 && (columns.second.is_some() || rows.second.is_some()) {
            let [a, _, c, _] = self.cell(column, row);
            highest = highest.max(a + fraction * (c - a));
        }
        highest
    }

    /// Upward unit normal of the ground at a point: the normal of the triangle that contains the point. A point on an
    /// edge belongs to the triangle at larger x, and if both have the same x, to the triangle at larger y. A point on a
    /// step belongs to the upper side. Outside the rectangle, the ground does not rise or fall with the distance from
    /// the border.
    ///
    /// The normal is straight up if a coordinate is NaN.
    pub fn normal(&self, x: f64, y: f64) -> DVec3 {
        if x.is_nan() || y.is_nan() {
            return DVec3::Z;
        }
        let (columns, rows) = (AxisPosition::new(&self.xs, x), AxisPosition::new(&self.ys, y));
        let mut upper = (f64::NEG_INFINITY, DVec3::Z);
        for row in rows.iter() {
            for column in columns.iter() {
                let height = self.interpolate(column, row);
                let slope = self.slope(column, row);
                if height >= upper.0 {
                    upper = (height, slope);
                }
            }
        }
        let Bounds { min: low, max: high } = self.bounds();
        let DVec3 { x: mut a, y: mut b, .. } = upper.1;
        if x < low.x || x > high.x {
            a = 0.0;
        }
        if y < low.y || y > high.y {
            b = 0.0;
        }
        DVec3::new(-a, -b, 1.0).normalize_or_zero()
    }

    /// The two triangles of the cell that starts at corner `column` along x and `row` along y, counter-clockwise as
    /// seen from above; the triangles of a step are vertical.
    ///
    /// # Panics
    /// If the cell does not exist.
    pub fn triangles(&self, column: usize, row: usize) -> [[DVec3; 3]; 2] {
        let corner = |right, up| self.corner(column + right, row + up);
        let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
        [[a, b, c], [a, c, d]]
    }

    /// Ranges of the columns and of the rows of the cells that touch the rectangle `bounds`; border cells represent the
    /// ground beyond the border.
    pub fn cells(&self, bounds: &Bounds) -> [std::ops::Range<usize>; 2] {
        let range = |lines: &[f64], low: f64, high: f64| {
            let last = lines.len() - 2;
            let first = lines.partition_point(|line| *line < low).saturating_sub(1).min(last);
            let end = lines.partition_point(|line| *line <= high).clamp(first + 1, last + 1);
            first..end
        };
        [range(&self.xs, bounds.min.x, bounds.max.x), range(&self.ys, bounds.min.y, bounds.max.y)]
    }

    /// Colour of the ground at a height, red, green, blue, 0 to 1: as on a relief map, from the field's lowest to its
    /// highest point.
    pub fn tint(&self, height: f64) -> [f32; 3] {
        let range = self.max_height - self.min_height;
        let fraction = if range > 0.0 { (height - self.min_height) / range } else { 0.0 };
        tint(fraction.clamp(0.0, 1.0) as f32)
    }

    /// The surface as a mesh in the world frame: each corner once, two triangles per cell except triangles without
    /// area. `colour` applies to the whole surface; without it, the surface is coloured by height.
    pub fn mesh(&self, colour: Option<[u8; 3]>) -> Mesh {
        let (columns, rows) = self.size();
        let positions = (0..rows).flat_map(|row| (0..columns).map(move |column| self.corner(column, row))).collect();
        let mut triangles = Vec::with_capacity(2 * (columns - 1) * (rows - 1));
        let range = self.max_height - self.min_height;
        let bands_per_metre = if range > 0.0 { BANDS as f64 / range } else { 0.0 };
        for row in 0..rows - 1 {
            for column in 0..columns - 1 {
                let corner = |right, up| ((row + up) * columns + column + right) as u32;
                let [a, b, c, d] = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
                let halves = self.triangles(column, row);
                for (corners, points) in [[a, b, c], [a, c, d]].into_iter().zip(halves) {
                    let [p, q, r] = points;
                    if (q - p).cross(r - p) == DVec3::ZERO {
                        continue;
                    }
                    let middle = (p.z + q.z + r.z) / 3.0;
                    let band = (((middle - self.min_height) * bands_per_metre) as usize).min(BANDS - 1);
                    let material = if colour.is_some() { 0 } else { band as u32 };
                    triangles.push(Triangle { corners, normals: None, uv: None, material });
                }
            }
        }
        Mesh { positions, triangles, materials: materials(colour) }
    }

    fn corner_height(&self, column: usize, row: usize) -> f64 {
        self.heights[row * self.xs.len() + column]
    }

    /// Heights of the corners of a cell: at its minimum x and y, then counter-clockwise.
    fn cell(&self, column: usize, row: usize) -> [f64; 4] {
        [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(right, up)| self.corner_height(column + right, row + up))
    }

    /// Height at a position, given as a corner and the fraction of the cell to its right and above it.
    fn interpolate(&self, (column, right): (usize, f64), (row, up): (usize, f64)) -> f64 {
        if right == 0.0 && up == 0.0 {
            return self.corner_height(column, row);
        }
        if up == 0.0 {
            let [a, b] = [self.corner_height(column, row), self.corner_height(column + 1, row)];
            return a + right * (b - a);
        }
        if right == 0.0 {
            let [a, d] = [self.corner_height(column, row), self.corner_height(column, row + 1)];
            return a + up * (d - a);
        }
        let [a, b, c, d] = self.cell(column, row);
        if right >= up { a + right * (b - a) + up * (c - b) } else { a + up * (d - a) + right * (c - d) }
    }

    /// Slopes along x and along y (as x and y of the result) of the triangle at a position. In a cell without width,
    /// they are the slopes of the previous cell.
    fn slope(&self, (column, right): (usize, f64), (row, up): (usize, f64)) -> DVec3 {
        // The last corner, and the first of the two corners at a step, belong to the previous cell.
        let in_wide_cell = |lines: &[f64], cell: usize, fraction: f64| {
            let is_wide = cell + 1 < lines.len() && lines[cell + 1] > lines[cell];
            if is_wide { (cell, fraction) } else { (cell.saturating_sub(1), 1.0) }
        };
        let (column, right) = in_wide_cell(&self.xs, column, right);
        let (row, up) = in_wide_cell(&self.ys, row, up);
        let [a, b, c, d] = self.cell(column, row);
        let [along_x, along_y] = if right >= up { [b - a, c - b] } else { [c - d, d - a] };
        let width = self.xs[column + 1] - self.xs[column];
        let depth = self.ys[row + 1] - self.ys[row];
        DVec3::new(along_x / width, along_y / depth, 0.0)
    }
}

/// Position of a coordinate among the grid lines of an axis: one position, or the two sides of a step. A position is
/// the index of a grid line and the fraction of the cell that begins there.
struct AxisPosition {
    first: (usize, f64),
    second: Option<(usize, f64)>,
}

impl AxisPosition {
    fn new(lines: &[f64], value: f64) -> Self {
        let value = value.clamp(lines[0], lines[lines.len() - 1]);
        let next = lines.partition_point(|line| *line < value);
        if lines[next] == value {
            let is_step = lines.get(next + 1) == Some(&value);
            return Self { first: (next, 0.0), second: is_step.then_some((next + 1, 0.0)) };
        }
        let [low, high] = [lines[next - 1], lines[next]];
        Self { first: (next - 1, (value - low) / (high - low)), second: None }
    }

    fn iter(&self) -> impl Iterator<Item = (usize, f64)> + use<> {
        std::iter::once(self.first).chain(self.second)
    }
}

/// Materials of the height bands, or the single material of `colour`.
fn materials(colour: Option<[u8; 3]>) -> Vec<Material> {
    if let Some(colour) = colour {
        let colour = colour.map(|channel| f32::from(channel) / 255.0);
        return vec![Material { name: "ground".to_owned(), colour, ..Material::default() }];
    }
    let band = |band: usize| {
        let colour = tint(band as f32 / (BANDS - 1) as f32);
        Material { name: format!("ground{band}"), colour, ..Material::default() }
    };
    (0..BANDS).map(band).collect()
}

/// Colour at a fraction of the height range, 0 lowest, 1 highest.
fn tint(fraction: f32) -> [f32; 3] {
    let position = fraction * (TINTS.len() - 1) as f32;
    let index = (position as usize).min(TINTS.len() - 2);
    let part = position - index as f32;
    [0, 1, 2].map(|channel| TINTS[index][channel] + part * (TINTS[index + 1][channel] - TINTS[index][channel]))
}
