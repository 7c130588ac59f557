//! Filtered images on surfaces.

use glam::DVec2;

use crate::scene::Texture;

/// What is beyond an image's border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The image again.
    Repeat,
    /// The pixel at the border.
    Clamp,
}

/// An image in all its smaller versions, each half as wide and high as the one before (mip map).
///
/// # Filter
/// A pixel's footprint in the image has the axes a (a step to the next column) and b (to the next row), in texels, from the
/// derivatives of u and v at the pixel's middle. With the longer of them L and the shorter S, n = ceil(|L| / |S|), 1 to
/// [`PROBES`](Self::PROBES), probes lie evenly along L about the middle ((i + 1/2) / n - 1/2 of it); each blends, linearly
/// in level = log2(|L| / n), two versions of the image, in each of which it blends the four nearest texels linearly. Level 0
/// is the image, and the first where the footprint is smaller than a texel. Transparent texels show the material's colour.
#[derive(Clone, Debug)]
pub struct Pyramid {
    levels: Vec<Level>,
    wrap: Wrap,
}

#[derive(Clone, Debug)]
struct Level {
    width: u32,
    height: u32,
    /// Row by row from the top.
    texels: Vec<[u8; 4]>,
}

impl Pyramid {
    /// Most probes of a footprint that is longer than wide.
    pub const PROBES: u32 = 8;

    /// The versions of `image`: a texel of the next one is the mean of the two by two below it, or of the one or two that there
    /// are, rounded half up; a last odd row or column is left out.
    pub fn new(image: &Texture, wrap: Wrap) -> Self {
        let (width, height) = image.size();
        let texels = (0..height).flat_map(|row| (0..width).map(move |column| image.pixel(column, row))).collect();
        let mut levels = vec![Level { width, height, texels }];
        while let Some(level) = levels.last().filter(|level| level.width > 1 || level.height > 1) {
            let half = level.halved();
            levels.push(half);
        }
        Self { levels, wrap }
    }

    /// Width and height of the image.
    pub fn size(&self) -> [u32; 2] {
        [self.levels[0].width, self.levels[0].height]
    }

    /// Red, green, blue and opacity, 0 to 255, at u to the right and v upwards from the lower left corner, 1 being the whole
    /// image, where the next column's pixel is `across` away, and the next row's `down`.
    pub fn filtered(&self, uv: DVec2, across: DVec2, down: DVec2) -> [f32; 4] {
        let texels = DVec2::from(self.size().map(f64::from));
        let (a, b) = ((across * texels).length(), (down * texels).length());
        let (long, axis, short) = if a >= b { (a, across, b) } else { (b, down, a) };
        let is_sound = uv.is_finite() && long.is_finite();
        if !is_sound {
            return self.bilinear(self.levels.len() - 1, DVec2::ZERO);
        }
        let probes = (long / short).ceil().clamp(1.0, f64::from(Self::PROBES));
        let level = libm::log2(long / probes).clamp(0.0, (self.levels.len() - 1) as f64);
        let mut sum = [0.0; 4];
        for probe in 0..probes as u32 {
            let at = uv + axis * ((f64::from(probe) + 0.5) / probes - 0.5);
            let colour = self.trilinear(level, at);
            sum = std::array::from_fn(|channel| sum[channel] + colour[channel]);
        }
        sum.map(|channel| channel / probes as f32)
    }

    fn trilinear(&self, level: f64, at: DVec2) -> [f32; 4] {
        let (lower, share) = (level as usize, (level - level.floor()) as f32);
        let fine = self.bilinear(lower, at);
        if share == 0.0 {
            return fine;
        }
        let coarse = self.bilinear(lower + 1, at);
        std::array::from_fn(|channel| fine[channel] + share * (coarse[channel] - fine[channel]))
    }

    fn bilinear(&self, level: usize, at: DVec2) -> [f32; 4] {
        let level = &self.levels[level];
        let wrapped = |part: f64| match self.wrap {
            Wrap::Repeat => part - part.floor(),
            Wrap::Clamp => part.clamp(0.0, 1.0),
        };
        let x = wrapped(at.x) * f64::from(level.width) - 0.5;
        let y = (1.0 - wrapped(at.y)) * f64::from(level.height) - 0.5;
        let (left, top) = (x.floor(), y.floor());
        let column = |column: i64| self.within(column, level.width);
        let row = |row: i64| self.within(row, level.height);
        let [x0, x1] = [column(left as i64), column(left as i64 + 1)];
        let [y0, y1] = [row(top as i64), row(top as i64 + 1)];
        let texel = |x: u32, y: u32| level.texels[(y * level.width + x) as usize].map(f32::from);
        let (fx, fy) = ((x - left) as f32, (y - top) as f32);
        let [nw, ne, sw, se] = [texel(x0, y0), texel(x1, y0), texel(x0, y1), texel(x1, y1)];
        std::array::from_fn(|channel| {
            let north = nw[channel] + fx * (ne[channel] - nw[channel]);
            let south = sw[channel] + fx * (se[channel] - sw[channel]);
            north + fy * (south - north)
        })
    }

    fn within(&self, place: i64, size: u32) -> u32 {
        let size = i64::from(size);
        (match self.wrap {
            Wrap::Repeat => place.rem_euclid(size),
            Wrap::Clamp => place.clamp(0, size - 1),
        }) as u32
    }
}

impl Level {
    fn halved(&self) -> Self {
        let [width, height] = [self.width, self.height].map(|side| (side / 2).max(1));
        let below = |place: u32, size: u32| [(2 * place).min(size - 1), (2 * place + 1).min(size - 1)];
        let texel = |column: u32, row: u32| {
            let mut sum = [0_u32; 4];
            for y in below(row, self.height) {
                for x in below(column, self.width) {
                    let texel = self.texels[(y * self.width + x) as usize];
                    sum = std::array::from_fn(|channel| sum[channel] + u32::from(texel[channel]));
                }
            }
            sum.map(|channel| ((channel + 2) / 4) as u8)
        };
        let texels = (0..height).flat_map(|row| (0..width).map(move |column| texel(column, row))).collect();
        Self { width, height, texels }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checks() -> Pyramid {
        let grey = |level| [level, level, level, 255];
        let image = Texture::new(2, 2, vec![grey(0), grey(200), grey(200), grey(0)]).expect("four pixels");
        Pyramid::new(&image, Wrap::Repeat)
    }

    #[test]
    fn a_small_footprint_shows_texels_and_what_is_between() {
        let image = checks();
        let at = |u, v| image.filtered(DVec2::new(u, v), DVec2::new(1e-3, 0.0), DVec2::new(0.0, 1e-3))[0];
        assert_eq!([at(0.25, 0.75), at(0.75, 0.75), at(0.5, 0.5), at(0.5, 0.75)], [0.0, 200.0, 100.0, 100.0]);
        assert_eq!(at(0.0, 0.75), 100.0, "the image repeats");
    }

    #[test]
    fn a_large_footprint_shows_the_mean() {
        let found = checks().filtered(DVec2::new(0.3, 0.1), DVec2::new(5.0, 0.0), DVec2::new(0.0, 5.0));
        assert_eq!(found, [100.0, 100.0, 100.0, 255.0]);
    }
}
