//! Image processing on grey and colour images of 82 x 62 pixels: 80 x 60 with a border of one pixel.
//!
//! Border pixels of a result are 0. Source: RoBIOS 6 library, image processing; the scaling of Laplace and Sobel is our
//! choice.

use robios_sys::robios6::{ColImage, IMAGE_COLUMNS as COLUMNS, IMAGE_ROWS as ROWS, Image};
use robios_sys::{Out, Robios6Call as Call};

use super::picture::Size;
use super::robot::Robot;
use super::{lcd, picture};

const SIZE: Size = Size { width: COLUMNS, height: ROWS };

/// Edges by the Laplace operator: |4 c - n - s - w - e|, at most 255.
pub fn laplace(source: &Image) -> Image {
    bordered(&picture::laplace(SIZE, source.as_flattened()))
}

/// Edges by the Sobel operator: |gx| + |gy|, at most 255.
pub fn sobel(source: &Image) -> Image {
    bordered(&picture::sobel(SIZE, source.as_flattened()))
}

/// Black (0) and white (255) by ordered dithering with a 2 x 2 pattern.
pub fn dither(source: &Image) -> Image {
    from_inner_pixels(|row, column| if lcd::is_black(source[row][column], row - 1, column - 1) { 0 } else { 255 })
}

/// Absolute difference of two images.
pub fn differ(current: &Image, last: &Image) -> Image {
    from_inner_pixels(|row, column| (level(current, row, column) - level(last, row, column)).abs())
}

/// Grey as the mean of red, green and blue, rounded down.
pub fn grey_from_colour(source: &ColImage) -> Image {
    let grey = picture::grey_of_colour(source.as_flattened().as_flattened());
    from_inner_pixels(|row, column| i32::from(grey[row * COLUMNS + column]))
}

/// Pixels of the part of an image that `LCDPutGraphic` shows: the top 80 x 54 pixels inside the border.
pub fn shown_pixels(image: &Image) -> impl Iterator<Item = u8> + '_ {
    image[1..=54].iter().flat_map(|row| row[1..=80].iter().copied())
}

/// `IPLaplace` and the other operators: stores the result of `operator`, which is `None` if a pointer is null.
pub fn process(
    robot: &mut Robot,
    call: Call,
    result: &mut Out<Image>,
    operator: impl FnOnce() -> Option<Image>,
) -> i32 {
    match operator() {
        Some(image) if !result.is_null() => {
            result.set(image);
            0
        }
        _ => robot.fail_call(call, -1),
    }
}

/// Converts the pixels of an image whose border is black already.
fn bordered(pixels: &[u8]) -> Image {
    std::array::from_fn(|row| std::array::from_fn(|column| pixels[row * COLUMNS + column]))
}

/// Image whose pixels inside the border are `value(row, column)`, limited to 0..=255.
fn from_inner_pixels(value: impl Fn(usize, usize) -> i32) -> Image {
    std::array::from_fn(|row| {
        std::array::from_fn(|column| {
            let is_inner = (1..ROWS - 1).contains(&row) && (1..COLUMNS - 1).contains(&column);
            if is_inner { value(row, column).clamp(0, 255) as u8 } else { 0 }
        })
    })
}

fn level(image: &Image, row: usize, column: usize) -> i32 {
    i32::from(image[row][column])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Left half black, right half of `level`.
    fn step(level: u8) -> Image {
        [std::array::from_fn(|column| if column < 41 { 0 } else { level }); ROWS]
    }

    #[test]
    fn edges_are_found_at_the_step() {
        let (laplace, sobel) = (laplace(&step(10)), sobel(&step(10)));
        let row = |image: &Image| -> Vec<u8> { image[30][38..44].to_vec() };
        // Laplace: 10 on both sides of the step. Sobel: (1 + 2 + 1) * 10 on both sides.
        assert_eq!(row(&laplace), [0, 0, 10, 10, 0, 0]);
        assert_eq!(row(&sobel), [0, 0, 40, 40, 0, 0]);
        assert_eq!(super::sobel(&step(255))[30][40], 255, "limited");
        assert_eq!(laplace[0][40], 0, "border");
    }

    #[test]
    fn difference_and_grey() {
        let (a, b) = (step(10), step(30));
        assert_eq!(differ(&a, &b)[1][60], 20);
        assert_eq!(differ(&b, &a), differ(&a, &b));
        let colour: ColImage = [[[30, 60, 91]; COLUMNS]; ROWS];
        assert_eq!(grey_from_colour(&colour)[1][1], 60);
    }

    #[test]
    fn dithering_a_quarter_grey_leaves_one_black_of_four() {
        let light = dither(&[[192; COLUMNS]; ROWS]);
        assert_eq!(light.iter().flatten().filter(|pixel| **pixel == 255).count(), 80 * 60 * 3 / 4);
        assert_eq!(dither(&light), light, "black and white stay");
    }

    #[test]
    fn the_display_shows_80_by_54() {
        let image: Image = std::array::from_fn(|row| [row as u8; COLUMNS]);
        let pixels: Vec<u8> = shown_pixels(&image).collect();
        assert_eq!((pixels.len(), pixels[0], pixels[80 * 54 - 1]), (80 * 54, 1, 54));
    }
}
