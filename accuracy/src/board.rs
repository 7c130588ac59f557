//! Calibration target: a board of black and white squares, and a detector of its inner corners in a picture.

use glam::{DMat2, DVec2, DVec3};
use sim_core::camera::Picture;
use sim_core::math;
use sim_core::scene::{Material, Mesh, Triangle};

/// Checkerboard in the plane z = 0, centred on the origin.
#[derive(Clone, Copy, Debug)]
pub struct Board {
    /// Number of squares along x and y, black and white alternating.
    pub squares: [u32; 2],
    /// Side of a square, m.
    pub side: f64,
}

impl Board {
    /// Mesh of the board: two faces per square, and a white border one square wide.
    pub fn mesh(&self) -> Mesh {
        let grey = |level: f32| Material { colour: [level; 3], ..Material::default() };
        let mut mesh = Mesh { materials: vec![grey(0.1), grey(0.9)], ..Mesh::default() };
        let [columns, rows] = self.squares;
        for row in 0..rows + 2 {
            for column in 0..columns + 2 {
                let is_border = column == 0 || row == 0 || column > columns || row > rows;
                let first = mesh.positions.len() as u32;
                let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(x, y)| self.corner(column + x, row + y));
                mesh.positions.extend(corners);
                let material = u32::from(is_border || (column + row) % 2 == 0);
                mesh.triangles.extend([[0, 1, 2], [0, 2, 3]].map(|corners| Triangle {
                    corners: corners.map(|corner| first + corner),
                    normals: None,
                    uv: None,
                    material,
                }));
            }
        }
        mesh
    }

    /// Corners shared by four squares, m.
    pub fn inner_corners(&self) -> Vec<DVec3> {
        let [columns, rows] = self.squares;
        (2..=rows).flat_map(|row| (2..=columns).map(move |column| self.corner(column, row))).collect()
    }

    /// Corner at `column` and `row`, counted with the border.
    fn corner(&self, column: u32, row: u32) -> DVec3 {
        let [columns, rows] = self.squares.map(|count| 0.5 * f64::from(count) + 1.0);
        self.side * DVec3::new(f64::from(column) - columns, f64::from(row) - rows, 0.0)
    }
}

/// Points in a picture at which two dark and two light squares meet diagonally, with sub-pixel accuracy. Columns go to
/// the right, rows downwards; the centre of the first pixel is at (0.5, 0.5).
///
/// Finds saddle points of the brightness blurred by a Gaussian of 2.5 pixels. Newton's method refines candidates, at
/// every other pixel, to zeros of the gradient. The four squares are symmetric under a half turn about their crossing,
/// so the crossing remains the saddle point under any blur with that symmetry. The method is our choice.
pub fn crossings(picture: &Picture<[u8; 3]>) -> Vec<DVec2> {
    let brightness = Brightness(picture);
    let [width, height] = picture.size().map(|side| side as usize);
    let middle = |column: usize, row: usize| DVec2::new(column as f64 + 0.5, row as f64 + 0.5);
    let inner = |side: usize| (MARGIN..side.saturating_sub(MARGIN)).step_by(STEP);
    let (columns, rows) = (inner(width).len(), inner(height).len());
    let position = |cell: usize| middle(MARGIN + cell % columns * STEP, MARGIN + cell / columns * STEP);
    let strength: Vec<f64> =
        (0..columns * rows).map(|cell| -brightness.derivatives(position(cell)).1.determinant()).collect();
    let min_strength = 0.1 * strength.iter().copied().fold(0.0, f64::max);
    let is_local_maximum = |cell: usize| {
        let (column, row) = (cell % columns, cell / columns);
        let near = |index: usize, count: usize| index.saturating_sub(1)..(index + 2).min(count);
        let mut neighbours =
            near(row, rows).flat_map(|row| near(column, columns).map(move |column| row * columns + column));
        strength[cell] > min_strength && neighbours.all(|other| strength[cell] >= strength[other])
    };
    let mut found: Vec<DVec2> = Vec::new();
    for cell in (0..strength.len()).filter(|&cell| is_local_maximum(cell)) {
        found.extend(
            brightness
                .saddle(position(cell))
                .filter(|saddle| found.iter().all(|other| (*other - *saddle).length() > 1.0)),
        );
    }
    found
}

/// Standard deviation of the Gaussian, in pixels. The error due to the averaging over the area of a pixel falls with
/// the square of this value (0.01 pixel at 2.5). The board's squares should be at least 15 pixels wide.
const BLUR: f64 = 2.5;
/// Radius at which the Gaussian is truncated, in pixels.
const TRUNCATION_RADIUS: isize = 11;
/// Distance between the starting points of the search for saddles, in pixels.
const STEP: usize = 2;
/// Width of the picture's border that the search excludes, in pixels.
const MARGIN: usize = 13;

/// Brightness of a picture.
struct Brightness<'p>(&'p Picture<[u8; 3]>);

impl Brightness<'_> {
    /// First and second derivatives of the blurred brightness at `point`.
    fn derivatives(&self, point: DVec2) -> (DVec2, DMat2) {
        let (column, row) = (point.x.floor() as isize, point.y.floor() as isize);
        // The Gaussian is separable.
        let weights = |middle: isize, coordinate: f64| {
            (middle - TRUNCATION_RADIUS..=middle + TRUNCATION_RADIUS).map(move |pixel| {
                let offset = pixel as f64 + 0.5 - coordinate;
                let weight = math::exp(-0.5 * offset * offset / (BLUR * BLUR));
                (pixel as u32, weight, offset / (BLUR * BLUR))
            })
        };
        let columns: Vec<_> = weights(column, point.x).collect();
        let (mut gradient, mut hessian) = (DVec2::ZERO, DMat2::ZERO);
        for (row, row_weight, y) in weights(row, point.y) {
            for &(column, column_weight, x) in &columns {
                let light = row_weight * column_weight * f64::from(self.0.pixel(column, row)[1]);
                gradient += light * DVec2::new(x, y);
                let curvature = [x * x - 1.0 / (BLUR * BLUR), x * y, x * y, y * y - 1.0 / (BLUR * BLUR)];
                hessian += DMat2::from_cols_array(&curvature) * light;
            }
        }
        (gradient, hessian)
    }

    /// The saddle point nearest to `start`; `None` if there is none within three pixels.
    fn saddle(&self, start: DVec2) -> Option<DVec2> {
        let mut point = start;
        for _ in 0..20 {
            let (gradient, hessian) = self.derivatives(point);
            let step = (hessian.determinant() < 0.0).then(|| hessian.inverse() * gradient)?;
            point -= step;
            if (point - start).abs().max_element() > 3.0 {
                return None;
            }
            if step.length() < 1e-9 {
                break;
            }
        }
        Some(point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossings_have_subpixel_accuracy() {
        // Two lines through the crossing, rotated, each pixel the mean of 16 by 16 samples.
        for (crossing, turn) in
            [(DVec2::new(20.3, 15.8), 0.2), (DVec2::new(19.0, 16.25), 0.6), (DVec2::new(20.5, 15.5), 1.4)]
        {
            let (sin, cos) = math::sin_cos(turn);
            let is_light = |point: DVec2| {
                let local = DVec2::new(cos, -sin).rotate(point - crossing);
                local.x * local.y > 0.0
            };
            let pixel = |number: u32| {
                let corner = DVec2::new(f64::from(number % 40), f64::from(number / 40));
                let sample = |part: u32| DVec2::new(f64::from(part % 16) + 0.5, f64::from(part / 16) + 0.5) / 16.0;
                let light = (0..256).filter(|&part| is_light(corner + sample(part))).count();
                [(20.0 + light as f64 / 256.0 * 200.0) as u8; 3]
            };
            let picture = Picture::new([40, 32], (0..40 * 32).map(pixel).collect());
            let found = crossings(&picture);
            assert!(found.len() == 1 && (found[0] - crossing).length() < 0.015, "{found:?} instead of {crossing}");
        }
    }

    #[test]
    fn board_is_centred_on_the_origin() {
        let board = Board { squares: [3, 2], side: 0.1 };
        assert_eq!(board.mesh().triangles.len(), 2 * 5 * 4);
        let corners = board.inner_corners();
        assert!(corners.len() == 2 && (corners[0] - DVec3::new(-0.05, 0.0, 0.0)).length() < 1e-15, "{corners:?}");
    }
}
