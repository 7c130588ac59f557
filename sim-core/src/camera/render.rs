//! Renders pictures, tile by tile.

use fearless_simd::Level;
use glam::{DVec2, DVec3};

use super::bins::Bins;
use super::optics::{Optics, TILE};
use super::rays::{PIXELS, RayTable, Rays, Window};
use super::shade::{Colours, Shading, round_colours, shade};
use super::shadow::{Axes, ShadowGrid};
use super::surface::SurfaceContext;
use super::tile::{GROUND, SKY, Tile, find_visible};
use super::{Attachment, Label, Picture, PosedScenery, View};
use crate::RobotId;

/// Renders pictures and reuses its buffers from one picture to the next.
#[derive(Clone, Debug)]
pub struct Camera {
    level: Level,
    bins: Bins,
    rays: RayTable,
    moving_shadow_casters: ShadowGrid,
    /// Sum of the samples of each pixel.
    sums: Vec<[f32; 3]>,
}

impl Default for Camera {
    fn default() -> Self {
        Self::at_level(Level::new())
    }
}

/// Number of bytes of a tile's row.
const ROW_BYTES: usize = 3 * TILE as usize;

/// Red, green and blue of a tile's row, from [rounded colours](round_colours).
fn row_bytes(colours: &[i32]) -> [u8; ROW_BYTES] {
    let [a, b, c, d, e, f, g, h] = std::array::from_fn(|pixel| u64::from(colours[pixel] as u32 & 0xff_ffff));
    let words = [a | b << 24 | c << 48, c >> 16 | d << 8 | e << 32 | f << 56, f >> 8 | g << 16 | h << 40];
    let mut bytes = [0; ROW_BYTES];
    bytes.copy_from_slice(words.map(u64::to_le_bytes).as_flattened());
    bytes
}

/// Inputs of the rendering of tiles.
struct RenderInputs<'a> {
    context: SurfaceContext<'a>,
    optics: &'a Optics,
    view: &'a View,
    bins: &'a Bins,
    rays: &'a RayTable,
}

impl Camera {
    pub(super) fn at_level(level: Level) -> Self {
        Self {
            level,
            bins: Bins::default(),
            rays: RayTable::default(),
            moving_shadow_casters: ShadowGrid::default(),
            sums: Vec::new(),
        }
    }

    /// Colour picture of this view (red, green, blue) without the body of the robot `observer`. Each pixel is the
    /// rounded mean of `samples` x `samples` pixels of a larger picture. `samples` is reduced if the larger picture
    /// would exceed the size limit of [`View`], and is at least 1.
    pub fn colour(
        &mut self,
        posed: &PosedScenery,
        view: &View,
        observer: Option<RobotId>,
        samples: u32,
    ) -> Picture<[u8; 3]> {
        let (samples, fine) =
            (1..=samples.max(1)).rev().find_map(|n| Some((n, view.enlarged(n).ok()?))).unwrap_or((1, *view));
        let optics = Optics::new(&fine);
        self.prepare(posed, &fine, &optics, observer);
        let light = posed.scenery().light();
        if light.shadows {
            let is_moving = |part: &super::Part| !matches!(part.attachment, Attachment::Fixed(_));
            let axes = Axes::new(light.sun_direction);
            self.moving_shadow_casters.fill(posed.scenery(), Some(posed), &axes, is_moving);
        }
        let shadow_casters = light.shadows.then_some(&self.moving_shadow_casters);
        let context = SurfaceContext::new(posed, &fine, optics.camera_from_lens, shadow_casters);
        let inputs = RenderInputs { context, optics: &optics, view: &fine, bins: &self.bins, rays: &self.rays };
        let [width, height] = view.size();
        let mut pixels = vec![[0; 3]; width as usize * height as usize];
        let level = self.level;
        let write = |tile: &Tile, colours: &Colours| {
            let colours = round_colours(level, colours);
            let [columns, rows] = inputs.visible_size(tile.origin);
            for (row, colours) in colours.chunks_exact(TILE as usize).take(rows).enumerate() {
                let first = (tile.origin[1] as usize + row) * width as usize + tile.origin[0] as usize;
                let target = pixels[first..first + columns].as_flattened_mut();
                let bytes = row_bytes(colours);
                match <&mut [u8; ROW_BYTES]>::try_from(&mut *target) {
                    Ok(target) => *target = bytes,
                    Err(_) => target.copy_from_slice(&bytes[..target.len()]),
                }
            }
        };
        if samples == 1 {
            inputs.colour_tiles(self.level, write);
        } else {
            self.sums.clear();
            self.sums.resize(pixels.len(), [0.0; 3]);
            let sums = &mut self.sums;
            inputs.colour_tiles(self.level, |tile, colours| {
                let [columns, rows] = inputs.visible_size(tile.origin);
                for row in 0..rows {
                    let row_start = (tile.origin[1] + row as u32) / samples * width;
                    for column in 0..columns {
                        let sum = &mut sums[(row_start + (tile.origin[0] + column as u32) / samples) as usize];
                        for (sum, channel) in sum.iter_mut().zip(colours) {
                            *sum += channel[row * TILE as usize + column];
                        }
                    }
                }
            });
            let weight = 1.0 / (samples * samples) as f32;
            for (pixel, sum) in pixels.iter_mut().zip(sums) {
                // The cast saturates.
                *pixel = sum.map(|channel| (channel * weight + 0.5) as u8);
            }
        }
        Picture::new(view.size(), pixels)
    }

    /// Distance along each pixel's line of sight, m; infinite for the sky.
    pub fn depth(&mut self, posed: &PosedScenery, view: &View, observer: Option<RobotId>) -> Picture<f32> {
        let depth = |inputs: &RenderInputs, number, pixel: [u32; 2]| {
            let plane = match number {
                SKY => return f32::INFINITY,
                GROUND => inputs.context.ground,
                _ => inputs.bins.faces[number as usize].plane,
            };
            let ray = inputs.ray(pixel);
            let length = (inputs.optics.camera_from_lens * ray).length();
            (length / plane.dot(ray)) as f32
        };
        self.picture_of(posed, view, observer, f32::INFINITY, depth)
    }

    /// Label of the surface shown by each pixel.
    pub fn labels(&mut self, posed: &PosedScenery, view: &View, observer: Option<RobotId>) -> Picture<Label> {
        let label = |inputs: &RenderInputs, number, _| match number {
            SKY => Label::Sky,
            GROUND => Label::Ground,
            _ => posed.scenery().parts()[inputs.bins.faces[number as usize].part as usize].label,
        };
        self.picture_of(posed, view, observer, Label::Sky, label)
    }

    /// Picture of the results of `value`, called with the face number and position of each pixel. `fill` is the initial
    /// value of all pixels.
    fn picture_of<T: Copy>(
        &mut self,
        posed: &PosedScenery,
        view: &View,
        observer: Option<RobotId>,
        fill: T,
        value: impl Fn(&RenderInputs, u32, [u32; 2]) -> T,
    ) -> Picture<T> {
        let optics = Optics::new(view);
        self.prepare(posed, view, &optics, observer);
        let context = SurfaceContext::new(posed, view, optics.camera_from_lens, None);
        let inputs = RenderInputs { context, optics: &optics, view, bins: &self.bins, rays: &self.rays };
        let width = view.size()[0] as usize;
        let mut pixels = vec![fill; width * view.size()[1] as usize];
        inputs.for_each_tile(self.level, |tile, _, _| {
            let [columns, rows] = inputs.visible_size(tile.origin);
            for row in 0..rows {
                for column in 0..columns {
                    let index = row * TILE as usize + column;
                    let pixel = tile.pixel(index);
                    pixels[pixel[1] as usize * width + pixel[0] as usize] = value(&inputs, tile.shown[index], pixel);
                }
            }
        });
        Picture::new(view.size(), pixels)
    }

    fn prepare(&mut self, posed: &PosedScenery, view: &View, optics: &Optics, observer: Option<RobotId>) {
        self.rays.prepare(view, optics.tiles());
        self.bins.fill(posed, view, optics, &self.rays, observer);
    }
}

impl RenderInputs<'_> {
    /// Number of columns and rows of a tile that are inside the image.
    fn visible_size(&self, origin: [u32; 2]) -> [usize; 2] {
        [0, 1].map(|axis| (self.optics.size[axis] - origin[axis]).min(TILE) as usize)
    }

    /// The ray through a pixel's centre, in lens space.
    fn ray(&self, [column, row]: [u32; 2]) -> DVec3 {
        let middle = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
        if self.optics.is_flat { middle.extend(1.0) } else { self.view.ray(middle).unwrap_or_default() }
    }

    /// Computes the colours of each tile and calls `visit` with the tile and the colours.
    fn colour_tiles(&self, level: Level, mut visit: impl FnMut(&Tile, &Colours)) {
        let mut colours = [[0.0; PIXELS]; 3];
        let shading = Shading { context: &self.context, faces: &self.bins.faces, is_flat: self.optics.is_flat };
        self.for_each_tile(level, |tile, rays, window| {
            let visible = self.visible_pixels(tile, &mut colours);
            let ray_of = |pixel| self.ray(tile.pixel(pixel));
            shade(level, &shading, (rays, window), tile, (visible, &ray_of), &mut colours);
            visit(tile, &colours);
        });
    }

    /// Bit mask of the pixels of a tile that are inside the image. Sets pixels outside a fisheye's image to black.
    fn visible_pixels(&self, tile: &Tile, colours: &mut Colours) -> u64 {
        let [columns, rows] = self.visible_size(tile.origin);
        if self.optics.is_flat && [columns, rows] == [TILE as usize; 2] {
            return u64::MAX;
        }
        let mut visible = 0;
        for row in 0..rows {
            for column in 0..columns {
                let pixel = row * TILE as usize + column;
                if self.optics.is_flat || self.rays.ray(tile.pixel(pixel)) != DVec3::ZERO {
                    visible |= 1 << pixel;
                } else {
                    colours.iter_mut().for_each(|channel| channel[pixel] = 0.0);
                }
            }
        }
        visible
    }

    /// Finds the face shown by each pixel and calls `visit` with each tile.
    fn for_each_tile(&self, level: Level, mut visit: impl FnMut(&Tile, &Rays, &Window)) {
        let [columns, rows] = self.optics.tiles();
        let is_flat = self.optics.is_flat;
        let mut tile = Tile { origin: [0; 2], shown: [SKY; PIXELS] };
        let mut rays = Rays::flat();
        for row in 0..rows {
            for column in 0..columns {
                let number = (row * columns + column) as usize;
                tile.origin = [column * TILE, row * TILE];
                let window = if is_flat {
                    Window::flat([column, row])
                } else {
                    rays.load_curved(self.rays, [column, row]);
                    Window::curved(self.rays.cone(number))
                };
                let faces = (self.bins.faces.as_slice(), self.bins.tiles[number].as_slice());
                find_visible(level, is_flat, (&rays, &window), self.context.ground, faces, &mut tile.shown);
                visit(&tile, &rays, &window);
            }
        }
    }
}
