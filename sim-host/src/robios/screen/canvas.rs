//! Coloured pixels and integer drawing operations on them.
//!
//! The origin is the upper left corner, x to the right, y down. Shapes of any size and position are clipped to the
//! canvas; the time for drawing depends on the canvas, not on the size of the shape.

/// Red, green and blue.
pub type Rgb = [u8; 3];

/// Black.
pub const BLACK: Rgb = [0; 3];
/// White.
pub const WHITE: Rgb = [255; 3];

/// Colour of a RoBIOS colour code, 0xRRGGBB; higher bits are ignored.
pub fn rgb(colour: i32) -> Rgb {
    let [_, red, green, blue] = colour.to_be_bytes();
    [red, green, blue]
}

/// RoBIOS code of a colour, 0xRRGGBB.
pub fn code([red, green, blue]: Rgb) -> i32 {
    i32::from_be_bytes([0, red, green, blue])
}

/// The complement of a colour.
pub fn inverse(colour: Rgb) -> Rgb {
    colour.map(|channel| !channel)
}

/// Effect of drawing on a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ink {
    /// Sets this colour.
    Colour(Rgb),
    /// Inverts the colour to its complement.
    Invert,
}

/// A rectangle of pixels. Drawing functions return the number of changed pixels.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Canvas {
    width: usize,
    height: usize,
    pixels: Box<[Rgb]>,
}

impl Canvas {
    /// A canvas of one colour.
    pub fn new(width: usize, height: usize, colour: Rgb) -> Self {
        Self { width, height, pixels: vec![colour; width * height].into() }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// All pixels, rows from the top.
    pub fn pixels(&self) -> &[Rgb] {
        &self.pixels
    }

    /// Colour of a pixel; `None` outside.
    pub fn pixel(&self, x: i32, y: i32) -> Option<Rgb> {
        self.pixel_index(x.into(), y.into()).map(|index| self.pixels[index])
    }

    /// Draws one pixel.
    pub fn draw_pixel(&mut self, x: i32, y: i32, ink: Ink) -> u32 {
        self.draw(x.into(), y.into(), ink)
    }

    /// Draws a line including both ends, each pixel once; both directions draw the same pixels.
    pub fn draw_line(&mut self, from: [i32; 2], to: [i32; 2], ink: Ink) -> u32 {
        line(from, to, [self.width, self.height]).map(|[x, y]| self.draw(x, y, ink)).sum()
    }

    /// Fills the rectangle between two corners, edges included.
    pub fn fill_area(&mut self, from: [i32; 2], to: [i32; 2], ink: Ink) -> u32 {
        let ([left, top], [right, bottom]) = corners(from, to);
        let (top, bottom) = (top.max(0), bottom.min(self.height as i64 - 1));
        (top..=bottom).map(|y| self.draw_span(y, left, right, ink)).sum()
    }

    /// Draws the edges of the rectangle between two corners, each pixel once.
    pub fn draw_rectangle(&mut self, from: [i32; 2], to: [i32; 2], ink: Ink) -> u32 {
        let ([left, top], [right, bottom]) = corners(from, to);
        let mut changed = self.draw_span(top, left, right, ink);
        if bottom > top {
            changed += self.draw_span(bottom, left, right, ink);
        }
        for y in (top + 1).max(0)..bottom.min(self.height as i64) {
            changed += self.draw(left, y, ink);
            if right > left {
                changed += self.draw(right, y, ink);
            }
        }
        changed
    }

    /// Fills a circle: all pixels whose centres are nearer to the centre of pixel (x, y) than the radius plus half a
    /// pixel. Draws nothing for a negative radius.
    pub fn fill_circle(&mut self, [x, y]: [i32; 2], radius: i32, ink: Ink) -> u32 {
        let (x, y) = (i64::from(x), i64::from(y));
        let rows = visible_range(y, radius, self.height);
        rows.filter_map(|row| Some((row, half_chord(radius, row - y)?)))
            .map(|(row, half)| self.draw_span(row, x - half, x + half, ink))
            .sum()
    }

    /// Draws the rim of the circle that [`fill_circle`](Self::fill_circle) fills, one pixel wide, each pixel once.
    pub fn draw_circle(&mut self, [x, y]: [i32; 2], radius: i32, ink: Ink) -> u32 {
        let (x, y) = (i64::from(x), i64::from(y));
        let mut changed = 0;
        // Where the rim is flat, it is drawn column by column; where it is steep, row by row. So no pixel is drawn
        // twice, and there is no gap on the diagonal.
        for column in visible_range(x, radius, self.width) {
            let offset = column - x;
            if let Some(half) = half_chord(radius, offset).filter(|half| *half >= offset.abs()) {
                changed += self.draw_pair([column, y - half], [column, y + half], ink);
            }
        }
        for row in visible_range(y, radius, self.height) {
            let offset = row - y;
            if let Some(half) = half_chord(radius, offset).filter(|half| *half > offset.abs()) {
                changed += self.draw_pair([x - half, row], [x + half, row], ink);
            }
        }
        changed
    }

    /// Shows an image of `width` pixels per row, its upper left corner at (x, y). The last row may be incomplete.
    pub fn show(&mut self, [x, y]: [i32; 2], width: usize, image: impl Iterator<Item = Rgb>) -> u32 {
        let rows = self.height as i64 - i64::from(y);
        // Rows below the canvas are not read.
        let visible_pixels = usize::try_from(rows).unwrap_or(0).saturating_mul(width);
        let (mut dx, mut row, mut changed) = (0, i64::from(y), 0);
        for colour in image.take(visible_pixels) {
            changed += self.draw(i64::from(x) + dx, row, Ink::Colour(colour));
            dx += 1;
            if dx == width as i64 {
                (dx, row) = (0, row + 1);
            }
        }
        changed
    }

    /// Blends a colour into one pixel by its coverage, 0 to 255.
    pub fn blend(&mut self, x: i32, y: i32, colour: Rgb, coverage: u8) {
        if let Some(index) = self.pixel_index(x.into(), y.into()) {
            let under = self.pixels[index];
            self.pixels[index] = std::array::from_fn(|channel| mix(under[channel], colour[channel], coverage));
        }
    }

    /// Moves the rows above `bottom` up by `distance` and fills the rows that become free with black.
    pub fn scroll(&mut self, bottom: usize, distance: usize) {
        let bottom = bottom.min(self.height);
        let distance = distance.min(bottom);
        self.pixels.copy_within(distance * self.width..bottom * self.width, 0);
        self.pixels[(bottom - distance) * self.width..bottom * self.width].fill(BLACK);
    }

    fn draw_pair(&mut self, [x1, y1]: [i64; 2], [x2, y2]: [i64; 2], ink: Ink) -> u32 {
        let second = if [x1, y1] == [x2, y2] { 0 } else { self.draw(x2, y2, ink) };
        self.draw(x1, y1, ink) + second
    }

    fn draw_span(&mut self, y: i64, left: i64, right: i64, ink: Ink) -> u32 {
        let (left, right) = (left.max(0), right.min(self.width as i64 - 1));
        (left..=right).map(|x| self.draw(x, y, ink)).sum()
    }

    fn draw(&mut self, x: i64, y: i64, ink: Ink) -> u32 {
        let Some(index) = self.pixel_index(x, y) else { return 0 };
        let old = self.pixels[index];
        self.pixels[index] = match ink {
            Ink::Colour(colour) => colour,
            Ink::Invert => inverse(old),
        };
        u32::from(self.pixels[index] != old)
    }

    fn pixel_index(&self, x: i64, y: i64) -> Option<usize> {
        let x = usize::try_from(x).ok().filter(|x| *x < self.width)?;
        let y = usize::try_from(y).ok().filter(|y| *y < self.height)?;
        Some(y * self.width + x)
    }
}

/// Points of the line between two points, both included, clipped to a rectangle of `size` at the origin.
pub fn line(from: [i32; 2], to: [i32; 2], size: [usize; 2]) -> impl Iterator<Item = [i64; 2]> {
    let [[x1, y1], [x2, y2]] = [from, to].map(|point| point.map(i64::from));
    let is_flat = (x2 - x1).abs() >= (y2 - y1).abs();
    let (from, to, [end, cross_end]) = match is_flat {
        true => ([x1, y1], [x2, y2], size),
        false => ([y1, x1], [y2, x2], [size[1], size[0]]),
    };
    shallow_line(from, to, end as i64)
        .filter(move |(_, value)| (0..cross_end as i64).contains(value))
        .map(move |(index, value)| if is_flat { [index, value] } else { [value, index] })
}

/// Points of a line that is at least as long along its first coordinate as along its second, clipped to first
/// coordinates of `0..end`.
fn shallow_line(from: [i64; 2], to: [i64; 2], end: i64) -> impl Iterator<Item = (i64, i64)> {
    let ([start, first], [stop, last]) = if from[0] <= to[0] { (from, to) } else { (to, from) };
    let (length, rise) = (i128::from(stop - start), i128::from(last - first));
    (start.max(0)..=stop.min(end - 1)).map(move |index| {
        // The second coordinate is rounded to the nearest integer, halves up; a line of one point has length 0.
        let numerator = 2 * rise * i128::from(index - start) + length;
        (index, first + if length == 0 { 0 } else { numerator.div_euclid(2 * length) as i64 })
    })
}

/// Upper left and lower right corner of the rectangle between two points.
fn corners([x1, y1]: [i32; 2], [x2, y2]: [i32; 2]) -> ([i64; 2], [i64; 2]) {
    ([x1.min(x2), y1.min(y2)].map(i64::from), [x1.max(x2), y1.max(y2)].map(i64::from))
}

/// Coordinates of `0..end` within a radius of a centre.
fn visible_range(centre: i64, radius: i32, end: usize) -> std::ops::RangeInclusive<i64> {
    let radius = i64::from(radius);
    (centre - radius).max(0)..=(centre + radius).min(end as i64 - 1)
}

/// Half the chord of a circle at a distance from its centre; `None` outside the circle.
fn half_chord(radius: i32, distance: i64) -> Option<i64> {
    let radius = u64::try_from(radius).ok()?;
    let distance = distance.unsigned_abs();
    // A centre at distance d is nearer than r + 1/2 if d^2 <= r^2 + r, in integers.
    let rest = (radius * radius + radius).checked_sub(distance.checked_mul(distance)?)?;
    (distance <= radius).then(|| rest.isqrt() as i64)
}

fn mix(under: u8, over: u8, coverage: u8) -> u8 {
    let [under, over, coverage] = [under, over, coverage].map(u32::from);
    ((under * (255 - coverage) + over * coverage + 127) / 255) as u8
}
