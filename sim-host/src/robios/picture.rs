//! Image processing on images of any size: grey images have 1 byte per pixel, colour images 3, row by row from the top.
//!
//! Integer arithmetic only, so that results are the same on every machine. Every operator reads `source` and returns a
//! new image. Sources: RoBIOS 6 and RoBIOS-7 library, image processing; Bräunl, Embedded Robotics, for the operators
//! and for hue. Scaling and border of the operators are our choice.

use sim_core::device::camera::grey;

/// Width and height in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Pixels of a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

/// Maximum number of pixels of an image: those of `CAM5MP`, so that two colour images fit into a message of 32 MB.
const MAX_PIXELS: usize = 2592 * 1944;

impl Size {
    /// A size as programs pass it; `None` if it is empty or has more than `MAX_PIXELS` pixels.
    pub fn new(width: i32, height: i32) -> Option<Self> {
        let [width, height] = [width, height].map(|pixels| usize::try_from(pixels).unwrap_or_default());
        let pixels = width.checked_mul(height)?;
        (1..=MAX_PIXELS).contains(&pixels).then_some(Self { width, height })
    }

    /// Number of pixels.
    pub fn pixels(self) -> usize {
        self.width * self.height
    }
}

/// Edges of a grey image by the Laplace operator: |4 c - n - s - w - e|, at most 255. Border pixels are 0.
///
/// # Panics
/// If `source` has fewer pixels than `size`.
pub fn laplace(size: Size, source: &[u8]) -> Vec<u8> {
    map_inner_pixels(size, source, |[[_, n, _], [w, c, e], [_, s, _]]| (4 * c - n - s - w - e).abs())
}

/// Edges of a grey image by the Sobel operator: |gx| + |gy|, at most 255. Border pixels are 0.
///
/// # Panics
/// If `source` has fewer pixels than `size`.
pub fn sobel(size: Size, source: &[u8]) -> Vec<u8> {
    map_inner_pixels(size, source, |[[nw, n, ne], [w, _, e], [sw, s, se]]| {
        let gx = ne + 2 * e + se - nw - 2 * w - sw;
        let gy = sw + 2 * s + se - nw - 2 * n - ne;
        gx.abs() + gy.abs()
    })
}

/// Image whose inner pixels are `operator` of their 3 x 3 neighbourhoods, limited to 0..=255; border pixels are 0.
fn map_inner_pixels(size: Size, source: &[u8], operator: impl Fn([[i32; 3]; 3]) -> i32) -> Vec<u8> {
    let Size { width, height } = size;
    let mut result = vec![0; size.pixels()];
    if width < 3 || height < 3 {
        return result;
    }
    let row = |y: usize| &source[y * width..(y + 1) * width];
    for (y, out) in result.chunks_exact_mut(width).enumerate().skip(1).take(height - 2) {
        let [above, here, below] = [row(y - 1), row(y), row(y + 1)].map(|row| row.windows(3));
        for (((above, here), below), pixel) in above.zip(here).zip(below).zip(&mut out[1..width - 1]) {
            let neighbours = [above, here, below].map(|row| [row[0], row[1], row[2]].map(i32::from));
            *pixel = operator(neighbours).clamp(0, 255) as u8;
        }
    }
    result
}

/// Grey as the mean of red, green and blue, rounded down.
pub fn grey_of_colour(source: &[u8]) -> Vec<u8> {
    pixels(source).map(grey).collect()
}

/// Colour image with the grey levels of a grey image.
pub fn colour_of_grey(source: &[u8]) -> Vec<u8> {
    source.iter().flat_map(|grey| [*grey; 3]).collect()
}

/// Colour image with these three channels, as long as the shortest of them.
pub fn colour_of_channels([red, green, blue]: [&[u8]; 3]) -> Vec<u8> {
    red.iter().zip(green).zip(blue).flat_map(|((red, green), blue)| [*red, *green, *blue]).collect()
}

/// Hue, saturation and intensity of a colour image, one channel each.
pub fn hsi_of_colour(source: &[u8]) -> [Vec<u8>; 3] {
    let mut channels = [(); 3].map(|()| Vec::with_capacity(source.len() / 3));
    for rgb in pixels(source) {
        for (channel, value) in channels.iter_mut().zip(hsi(rgb)) {
            channel.push(value);
        }
    }
    channels
}

/// Overlays the colour image `over` on `under`, except where `over` is black.
pub fn overlay(under: &[u8], over: &[u8]) -> Vec<u8> {
    pixels(under).zip(pixels(over)).flat_map(|(under, over)| if over == [0; 3] { under } else { over }).collect()
}

/// Overlays `colour` on the grey image `under` where the grey image `over` is not 0; returns a colour image.
pub fn overlay_grey(under: &[u8], over: &[u8], colour: [u8; 3]) -> Vec<u8> {
    under.iter().zip(over).flat_map(|(under, over)| if *over == 0 { [*under; 3] } else { colour }).collect()
}

/// The colour of a number 0xRRGGBB; higher bits are ignored.
pub fn rgb_of_number(colour: i32) -> [u8; 3] {
    let [_, red, green, blue] = colour.to_be_bytes();
    [red, green, blue]
}

/// The number 0xRRGGBB of a colour.
pub fn number_of_rgb([red, green, blue]: [u8; 3]) -> i32 {
    i32::from_be_bytes([0, red, green, blue])
}

/// Hue, saturation and intensity of a colour, 0 to 255 each.
///
/// Hue: see [`hue`]. Saturation: 255 (1 - min / mean), 0 for black. Intensity: the mean of the channels, rounded down.
pub fn hsi(rgb: [u8; 3]) -> [u8; 3] {
    let [red, green, blue] = rgb;
    let sum = u32::from(red) + u32::from(green) + u32::from(blue);
    let min = u32::from(red.min(green).min(blue));
    let saturation = (255 * 3 * min).checked_div(sum).map_or(0, |white| 255 - white);
    [hue(rgb), saturation as u8, grey(rgb)]
}

/// Hue of a colour: red is 43, green 128, blue 213; other hues differ from the nearest of these by up to 42. The hue is
/// 0 for grey: a colour whose largest and smallest channel differ by at most half of the largest.
///
/// Source: Bräunl, Embedded Robotics, colour; the offset is that of the EyeBot's library.
pub fn hue([red, green, blue]: [u8; 3]) -> u8 {
    let (red, green, blue) = (i32::from(red), i32::from(green), i32::from(blue));
    let largest = red.max(green).max(blue);
    let range = largest - red.min(green).min(blue);
    if 2 * range <= largest {
        return 0;
    }
    let hue = if largest == red {
        43 + 42 * (green - blue) / range
    } else if largest == green {
        128 + 42 * (blue - red) / range
    } else {
        213 + 42 * (red - green) / range
    };
    hue as u8
}

fn pixels(colours: &[u8]) -> impl Iterator<Item = [u8; 3]> + '_ {
    colours.as_chunks().0.iter().copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Size = Size { width: 6, height: 4 };

    /// Left half black, right half of `level`.
    fn step(level: u8) -> Vec<u8> {
        [0, 0, 0, level, level, level].repeat(4)
    }

    #[test]
    fn edges_are_found_at_the_step_and_the_border_is_black() {
        // Laplace: 10 on both sides of the step. Sobel: (1 + 2 + 1) * 10 on both sides.
        assert_eq!(laplace(SIZE, &step(10)), [[0; 6], [0, 0, 10, 10, 0, 0], [0, 0, 10, 10, 0, 0], [0; 6]].concat());
        assert_eq!(sobel(SIZE, &step(10)), [[0; 6], [0, 0, 40, 40, 0, 0], [0, 0, 40, 40, 0, 0], [0; 6]].concat());
        assert_eq!(sobel(SIZE, &step(255))[8], 255, "limited");
    }

    #[test]
    fn sobel_adds_the_gradients_of_both_directions() {
        // One bright pixel in a corner of the neighbourhood: |gx| + |gy| = 2 * 7; over it: |gy| = 2 * 7.
        let size = Size { width: 5, height: 5 };
        let mut image = vec![0; 25];
        image[2 * 5 + 2] = 7;
        let edges = sobel(size, &image);
        assert_eq!([edges[6], edges[7], edges[12]], [14, 14, 0]);
        assert_eq!(laplace(size, &image)[12], 28);
    }

    #[test]
    fn images_without_inner_pixels_are_black() {
        for (width, height) in [(1, 1), (2, 9), (9, 2)] {
            let size = Size::new(width, height).unwrap();
            assert_eq!(sobel(size, &vec![9; size.pixels()]), vec![0; size.pixels()]);
        }
        for size in [(0, 5), (5, -1), (i32::MAX, i32::MAX), (2593, 1944)] {
            assert_eq!(Size::new(size.0, size.1), None);
        }
        assert_eq!(Size::new(2592, 1944).map(Size::pixels), Some(5_038_848));
    }

    #[test]
    fn channels_and_greys() {
        assert_eq!(grey_of_colour(&[30, 60, 91, 255, 255, 255]), [60, 255]);
        assert_eq!(colour_of_grey(&[3, 4]), [3, 3, 3, 4, 4, 4]);
        assert_eq!(colour_of_channels([&[1, 2], &[3, 4], &[5, 6]]), [1, 3, 5, 2, 4, 6]);
        assert_eq!(hsi_of_colour(&[255, 0, 0, 9, 9, 9]), [[43, 0], [255, 0], [85, 9]]);
    }

    #[test]
    fn overlays() {
        assert_eq!(overlay(&[1, 2, 3, 4, 5, 6], &[0, 0, 0, 0, 0, 7]), [1, 2, 3, 0, 0, 7]);
        assert_eq!(overlay_grey(&[8, 9], &[0, 1], [1, 2, 3]), [8, 8, 8, 1, 2, 3]);
    }

    #[test]
    fn hues() {
        // The six pure colours lie 42 or 43 apart.
        let pure = [[255, 0, 0], [255, 255, 0], [0, 255, 0], [0, 255, 255], [0, 0, 255], [255, 0, 255]];
        assert_eq!(pure.map(hue), [43, 85, 128, 170, 213, 1]);
        assert_eq!([[0; 3], [200; 3], [200, 100, 100], [200, 99, 100]].map(hue), [0, 0, 0, 43]);
    }

    #[test]
    fn saturation_and_intensity() {
        assert_eq!(hsi([0; 3]), [0; 3]);
        assert_eq!(hsi([255; 3]), [0, 0, 255]);
        assert_eq!(hsi([200, 50, 50]), [43, 128, 100]);
    }

    #[test]
    fn numbers_of_colours() {
        assert_eq!(rgb_of_number(0x12_34_56), [0x12, 0x34, 0x56]);
        assert_eq!(rgb_of_number(-1), [255; 3]);
        assert_eq!(number_of_rgb([0xff, 0xa5, 0]), 0xff_a5_00);
    }
}
