//! Texture filtering with mip maps.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, i32x4};

use crate::scene::Texture;

/// Texture wrap mode: the colour beyond an image's border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The image repeats.
    Repeat,
    /// The nearest pixel at the border.
    Clamp,
}

/// A mip map: an image at several levels, each half as wide and high as the previous one (Williams, Pyramidal
/// parametrics, 1983).
///
/// A texel of a level is the mean, rounded half up, of two by two texels of the previous level, or of one or two texels
/// if that level has only one row or column. If a number of rows or columns is odd, the last one is omitted.
///
/// # Filter
/// A pixel's footprint in the image has the axes a (a step to the next column) and b (to the next row), in texels. They
/// come from the derivatives of u and v at the pixel's centre; for a fisheye, from half the difference between the rays
/// of the neighbouring pixels. Let L be the longer axis and S the shorter one; the footprint is treated as |L| long and
/// |S| wide. It is sampled with n = |L| / max(3 |S|, 1) probes, limited to 1 to 2, each |L| / n long. So a footprint up
/// to three times as long as wide needs one probe, and no probe is shorter than a texel. Two probes are centred (1 -
/// 1/n) / 2 of L before and after the centre. The colour is the mean of the probes, and changes continuously with the
/// footprint.
///
/// A probe has the level log2(|L| / n). It samples the nearest integer level and blends the four nearest texels
/// linearly. Within an eighth of a level of the midpoint between two levels, it blends both levels, linearly in the
/// level. Level 0 is the image, also for probes smaller than a texel. Transparent texels show the material's colour.
///
/// Our choice, after Feline (McCormack et al., 1999) for the probes; blending two levels only on a part of the interval
/// is common in graphics drivers, and saves a third of the texels.
#[derive(Clone, Debug)]
pub struct MipMap {
    levels: Vec<MipLevel>,
    /// Texels of all levels, each level with a border of one texel, filled according to the wrap mode. An entry is a
    /// texel and the texel below it, so that the four texels around a position are adjacent. Red is the lowest byte,
    /// opacity the highest.
    texels: Vec<[i32; 2]>,
    wrap: Wrap,
    pub(super) is_opaque: bool,
}

#[derive(Clone, Copy, Debug)]
struct MipLevel {
    size: [u32; 2],
    /// Index of the border's first texel.
    start: usize,
}

impl MipLevel {
    fn stride(&self) -> usize {
        self.size[0] as usize + 2
    }
}

impl MipMap {
    /// Maximum number of probes of a footprint.
    pub(super) const PROBES: f32 = 2.0;

    /// The mip map of `image`.
    pub fn new(image: &Texture, wrap: Wrap) -> Self {
        let (width, height) = image.size();
        let mut pixels: Vec<[u8; 4]> =
            (0..height).flat_map(|row| (0..width).map(move |column| image.pixel(column, row))).collect();
        let is_opaque = pixels.iter().all(|pixel| pixel[3] == u8::MAX);
        let mut mip_map = Self { levels: Vec::new(), texels: Vec::new(), wrap, is_opaque };
        let mut size = [width, height];
        mip_map.add(size, &pixels);
        while size != [1, 1] {
            (size, pixels) = halved(size, &pixels);
            mip_map.add(size, &pixels);
        }
        mip_map
    }

    fn add(&mut self, size: [u32; 2], pixels: &[[u8; 4]]) {
        self.levels.push(MipLevel { size, start: self.texels.len() });
        let [width, height] = size.map(i64::from);
        let wrapped = |index: i64, size: i64| match self.wrap {
            Wrap::Repeat => index.rem_euclid(size),
            Wrap::Clamp => index.clamp(0, size - 1),
        };
        let texel = |column: i64, row: i64| {
            i32::from_le_bytes(pixels[(wrapped(row, height) * width + wrapped(column, width)) as usize])
        };
        for row in -1..=height {
            self.texels.extend((-1..=width).map(|column| [texel(column, row), texel(column, row + 1)]));
        }
    }

    /// Width and height of the image.
    pub fn size(&self) -> [u32; 2] {
        self.levels[0].size
    }

    /// The wrap mode.
    pub fn wrap(&self) -> Wrap {
        self.wrap
    }

    /// Filtered red, green, blue and opacity, 0 to 255, at `uv` (to the right and downwards from the upper left corner;
    /// 1 is the full width or height). `axes[0]` and `axes[1]` are the steps to the next column and the next row, in
    /// texels. Only the lanes in the bit mask `wanted` are defined. `CHANNELS` is 3 without opacity, which is 0 then,
    /// and 4 with it.
    #[inline(always)]
    pub(super) fn sample<S: Simd, const CHANNELS: usize>(
        &self,
        simd: S,
        wanted: u64,
        uv: [S::f32s; 2],
        axes: [[S::f32s; 2]; 2],
    ) -> [S::f32s; 4] {
        let [a, b] = axes;
        let (a2, b2) = (a[0] * a[0] + a[1] * a[1], b[0] * b[0] + b[1] * b[1]);
        let is_a_longer = a2.simd_ge(b2);
        // All lengths in this function are squared.
        let (long, short) = (is_a_longer.select(a2, b2), is_a_longer.select(b2, a2));
        let max_length = (short * 9.0).max(1.0).max(long * (1.0 / (Self::PROBES * Self::PROBES)));
        // Length of a probe.
        let length = long.min(max_length);
        let zero = S::f32s::splat(simd, 0.0);
        let level = (log2(simd, length) * 0.5).max(zero).min((self.levels.len() - 1) as f32);
        let has_one_probe = long.simd_le(max_length);
        let [width, height] = self.size().map(|side| 1.0 / side as f32);
        let axis = [is_a_longer.select(a[0], b[0]) * width, is_a_longer.select(a[1], b[1]) * height];
        let (mut half_spread, mut probes) = (zero, 1);
        if has_one_probe.to_bitmask() & wanted != wanted {
            // 1 / n.
            let fraction = has_one_probe.select(S::f32s::splat(simd, 1.0), (length / long).sqrt());
            half_spread = (S::f32s::splat(simd, 1.0) - fraction) * 0.5;
            probes = 2;
        }
        let mut sum = [zero; 4];
        let mut number = 0;
        while number < probes {
            let offset = if number == 0 { half_spread } else { -half_spread };
            let probe_uv = [uv[0] + axis[0] * offset, uv[1] + axis[1] * offset];
            let colour = self.probe::<S, CHANNELS>(simd, wanted, probe_uv, level);
            let mut channel = 0;
            while channel < CHANNELS {
                sum[channel] += colour[channel];
                channel += 1;
            }
            number += 1;
        }
        let fraction = 1.0 / probes as f32;
        [sum[0] * fraction, sum[1] * fraction, sum[2] * fraction, sum[3] * fraction]
    }

    /// Colour of a probe, blended from one or two levels.
    #[inline(always)]
    fn probe<S: Simd, const CHANNELS: usize>(
        &self,
        simd: S,
        wanted: u64,
        uv: [S::f32s; 2],
        level: S::f32s,
    ) -> [S::f32s; 4] {
        let uv = [self.wrapped(simd, uv[0]), self.wrapped(simd, uv[1])];
        let (zero, one) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0));
        let whole = level.floor();
        let blend = ((level - whole - 0.5) * (1.0 / BLEND_WIDTH) + 0.5).max(zero).min(one);
        let is_upper = blend.simd_ge(one);
        let (lower, fraction) = (is_upper.select(whole + one, whole), is_upper.select(zero, blend));
        let numbers: S::i32s = lower.to_int();
        let last = self.levels.len() - 1;
        let mut colour = [zero; 4];
        let mut pending = wanted;
        while pending != 0 {
            let lane = pending.trailing_zeros() as usize % S::f32s::LEN;
            let number = numbers.as_slice()[lane];
            let same = numbers.simd_eq(number).to_bitmask() & pending | 1 << lane;
            pending &= !same;
            let mut number = (number as usize).min(last);
            let level_count = if fraction.simd_gt(zero).to_bitmask() & same == 0 { 1 } else { 2 };
            let mut weight = one - fraction;
            let mut blended = [zero; 4];
            let mut index = 0;
            while index < level_count {
                let sample = self.bilinear::<S, CHANNELS>(simd, same, uv, self.levels[number]);
                let mut channel = 0;
                while channel < CHANNELS {
                    blended[channel] += sample[channel] * weight;
                    channel += 1;
                }
                number = (number + 1).min(last);
                weight = fraction;
                index += 1;
            }
            if same == wanted {
                return blended;
            }
            let is_same = S::mask32s::from_bitmask(simd, same);
            let mut channel = 0;
            while channel < CHANNELS {
                colour[channel] = is_same.select(blended[channel], colour[channel]);
                channel += 1;
            }
        }
        colour
    }

    /// Wraps a coordinate into the image, 0 to 1, by the wrap mode; NaN becomes 0.
    #[inline(always)]
    fn wrapped<S: Simd>(&self, simd: S, coordinate: S::f32s) -> S::f32s {
        let (zero, one) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 1.0));
        match self.wrap {
            Wrap::Repeat => {
                let fraction = coordinate - coordinate.floor();
                (fraction.simd_ge(zero) & fraction.simd_le(one)).select(fraction, zero)
            }
            Wrap::Clamp => coordinate.simd_gt(zero).select(coordinate.simd_lt(one).select(coordinate, one), zero),
        }
    }

    /// Blends the four nearest texels of a level.
    #[inline(always)]
    fn bilinear<S: Simd, const CHANNELS: usize>(
        &self,
        simd: S,
        wanted: u64,
        uv: [S::f32s; 2],
        level: MipLevel,
    ) -> [S::f32s; 4] {
        let [width, height] = level.size.map(|side| side as f32);
        // Measured from the middle of the border's first texel.
        let (x, y) = (uv[0] * width + 0.5, uv[1] * height + 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (right_weight, lower_weight) = (x - left, y - top);
        let stride = level.stride();
        let (column, row): (S::i32s, S::i32s) = (left.to_int(), top.to_int());
        let first = row * S::i32s::splat(simd, stride as i32) + column;
        // Other lanes read the first texels of the level, so that all lanes take the same path.
        let first = S::mask32s::from_bitmask(simd, wanted).select(first, S::i32s::splat(simd, 0));
        let first = first.as_slice();
        let texels = &self.texels[level.start..];
        let (even_low, odd_low) = four_texels(simd, texels, first, 0).deinterleave(four_texels(simd, texels, first, 1));
        let (even_high, odd_high) =
            four_texels(simd, texels, first, 2).deinterleave(four_texels(simd, texels, first, 3));
        let (upper_left, upper_right) = even_low.deinterleave(even_high);
        let (lower_left, lower_right) = odd_low.deinterleave(odd_high);
        let found = [upper_left, upper_right, lower_left, lower_right];
        let one = S::f32s::splat(simd, 1.0);
        let (left_weight, upper_weight) = (one - right_weight, one - lower_weight);
        let weights = [
            left_weight * upper_weight,
            right_weight * upper_weight,
            left_weight * lower_weight,
            right_weight * lower_weight,
        ];
        let mut sum = [S::f32s::splat(simd, 0.0); 4];
        let low_byte = S::i32s::splat(simd, 255);
        let mut corner = 0;
        while corner < 4 {
            let texel = found[corner];
            let red: S::f32s = (texel & low_byte).to_float();
            let green: S::f32s = ((texel >> 8) & low_byte).to_float();
            let blue: S::f32s = ((texel >> 16) & low_byte).to_float();
            sum[0] += red * weights[corner];
            sum[1] += green * weights[corner];
            sum[2] += blue * weights[corner];
            if CHANNELS > 3 {
                let opacity: S::f32s = ((texel >> 24) & low_byte).to_float();
                sum[3] += opacity * weights[corner];
            }
            corner += 1;
        }
        sum
    }
}

/// The four texels around a position for the lanes of the quarter `quarter`, lane by lane. The vector is made of blocks
/// in registers: a vector read from memory to which the lanes were written one by one would wait for all of them.
#[inline(always)]
fn four_texels<S: Simd>(simd: S, texels: &[[i32; 2]], first: &[i32], quarter: usize) -> S::i32s {
    let blocks = S::i32s::LEN / 4;
    let mut vector = S::i32s::splat(simd, 0);
    let mut block = 0;
    while block < blocks {
        let index = first[quarter * blocks + block] as u32 as usize;
        let four = S::i32s::block_splat(i32x4::from_slice(simd, texels[index..index + 2].as_flattened()));
        vector = if block == 0 {
            four
        } else {
            S::mask32s::from_bitmask(simd, u64::MAX << (4 * block)).select(four, vector)
        };
        block += 1;
    }
    vector
}

/// Part of the interval between two levels in which both are blended.
const BLEND_WIDTH: f32 = 0.25;

/// Logarithm to base 2, within 5e-5; undefined for NaN and values of 0 or less.
#[inline(always)]
fn log2<S: Simd>(simd: S, x: S::f32s) -> S::f32s {
    let bits: S::u32s = x.bitcast();
    let exponent: S::i32s = (bits >> 23).bitcast();
    let exponent: S::f32s = (exponent - S::i32s::splat(simd, 127)).to_float();
    let mantissa = (bits & S::u32s::splat(simd, 0x007f_ffff)) | S::u32s::splat(simd, 0x3f80_0000);
    let mantissa: S::f32s = mantissa.bitcast();
    let t = mantissa - 1.0;
    // The polynomial interpolates the values at 0, 1 and four points in between, so the result is continuous.
    let curve = ((t * -0.044_873_955 + 0.150_533_2) * t - 0.269_578) * t + 0.442_418_58;
    exponent + t + t * (S::f32s::splat(simd, 1.0) - t) * curve
}

/// An image of half the width and height.
fn halved([width, height]: [u32; 2], pixels: &[[u8; 4]]) -> ([u32; 2], Vec<[u8; 4]>) {
    let half = [width, height].map(|side| (side / 2).max(1));
    let sources = |index: u32, size: u32| [(2 * index).min(size - 1), (2 * index + 1).min(size - 1)];
    let texel = |column: u32, row: u32| {
        let mut sum = [0_u32; 4];
        for y in sources(row, height) {
            for x in sources(column, width) {
                let texel = pixels[y as usize * width as usize + x as usize];
                sum = std::array::from_fn(|channel| sum[channel] + u32::from(texel[channel]));
            }
        }
        sum.map(|channel| ((channel + 2) / 4) as u8)
    };
    let texels = (0..half[1]).flat_map(|row| (0..half[0]).map(move |column| texel(column, row))).collect();
    (half, texels)
}
