//! Images of cameras and of image processing, for both generations.

use crate::Length;
use crate::lcd::Pixel;
use crate::robios7::Color;

/// Size of an image in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageSize {
    columns: u16,
    rows: u16,
}

impl ImageSize {
    /// 80 x 60 pixels, the images of RoBIOS 6.
    pub const EYECAM: Self = Self { columns: 80, rows: 60 };
    /// 160 x 120 pixels.
    pub const QQVGA: Self = Self { columns: 160, rows: 120 };
    /// 320 x 240 pixels.
    pub const QVGA: Self = Self { columns: 320, rows: 240 };
    /// 640 x 480 pixels.
    pub const VGA: Self = Self { columns: 640, rows: 480 };

    /// Creates a size from columns and rows.
    pub const fn new(columns: u16, rows: u16) -> Self {
        Self { columns, rows }
    }

    /// Number of columns.
    pub const fn columns(self) -> u16 {
        self.columns
    }

    /// Number of rows.
    pub const fn rows(self) -> u16 {
        self.rows
    }

    /// Number of pixels.
    pub const fn pixels(self) -> usize {
        self.columns as usize * self.rows as usize
    }

    /// Coordinates of all pixels: from the top, each row from the left.
    pub fn places(self) -> impl Iterator<Item = Pixel> {
        (0..i32::from(self.rows)).flat_map(move |y| (0..i32::from(self.columns)).map(move |x| Pixel { x, y }))
    }

    pub(crate) fn index_of(self, pixel: Pixel) -> Option<usize> {
        let (x, y) = (u16::try_from(pixel.x).ok()?, u16::try_from(pixel.y).ok()?);
        (x < self.columns && y < self.rows).then(|| usize::from(y) * usize::from(self.columns) + usize::from(x))
    }

    pub(crate) fn to_robios7(self) -> (i32, i32) {
        (self.columns.into(), self.rows.into())
    }
}

/// A grey image: one byte per pixel, 0 is black, row 0 at the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct GrayImage {
    pub(crate) size: ImageSize,
    pub(crate) bytes: Vec<u8>,
}

/// A colour image: red, green and blue of each pixel, row 0 at the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColorImage {
    pub(crate) size: ImageSize,
    pub(crate) bytes: Vec<u8>,
}

/// A depth image: distance along the line of sight of each pixel; row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthImage {
    pub(crate) size: ImageSize,
    /// Distances in millimetres; infinite for the sky.
    pub(crate) mm: Vec<f32>,
}

/// A label image: surface or body seen in each pixel; row 0 at the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LabelImage {
    pub(crate) size: ImageSize,
    pub(crate) numbers: Vec<i32>,
}

/// Label of a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Seen {
    /// Nothing.
    Sky,
    /// The floor, including paint on it, or a terrain.
    Floor,
    /// A wall.
    Wall,
    /// The robot or object of this number: robots from 1 on, then the objects, as `SIMGetRobot` and `SIMGetObject`
    /// number them.
    Body(u16),
}

impl Seen {
    pub(crate) fn from_number(number: i32) -> Self {
        use robios_sys::robios7::{CAM_BODY, CAM_SKY, CAM_WALL};
        match number {
            CAM_SKY => Self::Sky,
            CAM_WALL => Self::Wall,
            number if number > CAM_BODY => Self::Body(u16::try_from(number - CAM_BODY).unwrap_or(u16::MAX)),
            _ => Self::Floor,
        }
    }

    pub(crate) fn number(self) -> i32 {
        use robios_sys::robios7::{CAM_BODY, CAM_FLOOR, CAM_SKY, CAM_WALL};
        match self {
            Self::Sky => CAM_SKY,
            Self::Floor => CAM_FLOOR,
            Self::Wall => CAM_WALL,
            Self::Body(number) => CAM_BODY + i32::from(number),
        }
    }
}

impl GrayImage {
    /// A black image.
    pub fn new(size: ImageSize) -> Self {
        Self { size, bytes: vec![0; size.pixels()] }
    }

    /// Size of the image.
    pub fn size(&self) -> ImageSize {
        self.size
    }

    /// All pixels, row by row.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// All pixels, row by row.
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        &mut self.bytes
    }

    /// One pixel; `None` outside of the image.
    pub fn pixel(&self, at: Pixel) -> Option<u8> {
        self.size.index_of(at).map(|index| self.bytes[index])
    }
}

impl ColorImage {
    /// A black image.
    pub fn new(size: ImageSize) -> Self {
        Self { size, bytes: vec![0; 3 * size.pixels()] }
    }

    /// Size of the image.
    pub fn size(&self) -> ImageSize {
        self.size
    }

    /// Red, green and blue of all pixels, row by row.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Red, green and blue of all pixels, row by row.
    pub fn bytes_mut(&mut self) -> &mut [u8] {
        &mut self.bytes
    }

    /// One pixel; `None` outside of the image.
    pub fn pixel(&self, at: Pixel) -> Option<Color> {
        let start = 3 * self.size.index_of(at)?;
        let [red, green, blue] = [0, 1, 2].map(|channel| self.bytes[start + channel]);
        Some(Color { red, green, blue })
    }

    /// Coordinates and colour of each pixel: from the top, each row from the left.
    pub fn pixels(&self) -> impl Iterator<Item = (Pixel, Color)> {
        let colors =
            self.bytes.as_chunks().0.iter().map(|[red, green, blue]| Color { red: *red, green: *green, blue: *blue });
        self.size.places().zip(colors)
    }
}

impl DepthImage {
    /// Size of the image.
    pub fn size(&self) -> ImageSize {
        self.size
    }

    /// Distance seen in one pixel; `None` for the sky and outside of the image.
    pub fn distance(&self, at: Pixel) -> Option<Length> {
        self.size.index_of(at).and_then(|index| finite_distance(self.mm[index]))
    }

    /// The distances of all pixels, row by row; `None` for the sky.
    pub fn distances(&self) -> impl Iterator<Item = Option<Length>> {
        self.mm.iter().map(|mm| finite_distance(*mm))
    }
}

impl LabelImage {
    /// Size of the image.
    pub fn size(&self) -> ImageSize {
        self.size
    }

    /// Label of one pixel; `None` outside of the image.
    pub fn seen(&self, at: Pixel) -> Option<Seen> {
        self.size.index_of(at).map(|index| Seen::from_number(self.numbers[index]))
    }

    /// Coordinates and label of each pixel, row by row.
    pub fn pixels(&self) -> impl Iterator<Item = (Pixel, Seen)> {
        self.size.places().zip(self.numbers.iter().map(|number| Seen::from_number(*number)))
    }
}

/// Distance seen in a pixel; `None` for the sky.
fn finite_distance(mm: f32) -> Option<Length> {
    mm.is_finite().then(|| Length::millimetres(mm.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_converted_to_numbers_and_back() {
        for seen in [Seen::Sky, Seen::Floor, Seen::Wall, Seen::Body(1), Seen::Body(300)] {
            assert_eq!(Seen::from_number(seen.number()), seen);
        }
    }

    #[test]
    fn pixels_are_ordered_row_by_row_from_the_top() {
        let pixels: Vec<_> = ImageSize::new(2, 2).places().map(|Pixel { x, y }| (x, y)).collect();
        assert_eq!(pixels, [(0, 0), (1, 0), (0, 1), (1, 1)]);
        let depth = DepthImage { size: ImageSize::new(2, 1), mm: vec![f32::INFINITY, 250.0] };
        assert_eq!(depth.distances().collect::<Vec<_>>(), [None, Some(Length::millimetres(250.0))]);
        assert_eq!(depth.distance(Pixel { x: 1, y: 0 }), Some(Length::millimetres(250.0)));
        assert_eq!(depth.distance(Pixel { x: 2, y: 0 }), None);
    }
}
