//! Colours of a tile's pixels.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use glam::DVec3;

use super::face::Face;
use super::rays::{PIXELS, Rays, Window};
use super::surface::{
    Attribute, LightFractions, Lighting, PaintedGround, ShadedSurface, SurfaceContext, fill_direction,
};
use super::texture::Wrap;
use super::tile::{GROUND, SKY, Tile};

/// Red, green and blue of a tile's pixels, 0 to 255.
pub type Colours = [[f32; PIXELS]; 3];

type Rgb<S> = [<S as Simd>::f32s; 3];

/// An [`Attribute`] in a tile: its value at a reference ray, and a form for the differences at the other rays.
#[derive(Clone, Copy)]
struct LocalAttribute {
    reference: f64,
    form: [f32; 3],
}

impl LocalAttribute {
    #[inline(always)]
    fn new<const FLAT: bool>(attribute: &Attribute, plane: DVec3, ray: DVec3, window: &Window) -> Self {
        let difference = attribute.form.dot(ray) / plane.dot(ray);
        let difference = if difference.is_finite() { difference } else { 0.0 };
        let form = window.local::<FLAT>(attribute.form - plane * difference);
        Self { reference: attribute.base + difference, form }
    }
}

/// Inputs of the colours of a tile.
pub struct Shading<'a> {
    pub context: &'a SurfaceContext<'a>,
    pub faces: &'a [Face],
    pub is_flat: bool,
}

/// Colours the pixels of a tile that are in the bit mask `pixels.0`; `pixels.1` gives their rays in lens space.
pub fn shade(
    level: Level,
    shading: &Shading,
    rays: (&Rays, &Window),
    tile: &Tile,
    pixels: (u64, &dyn Fn(usize) -> DVec3),
    colours: &mut Colours,
) {
    if shading.is_flat {
        dispatch!(level, simd => shade_tile::<_, true>(simd, shading, rays, tile, pixels, colours));
    } else {
        dispatch!(level, simd => shade_tile::<_, false>(simd, shading, rays, tile, pixels, colours));
    }
}

#[inline(always)]
fn shade_tile<S: Simd, const FLAT: bool>(
    simd: S,
    Shading { context, faces, .. }: &Shading,
    (rays, window): (&Rays, &Window),
    tile: &Tile,
    (pixels, ray_of): (u64, &dyn Fn(usize) -> DVec3),
    colours: &mut Colours,
) {
    let mut pending = pixels;
    while pending != 0 {
        let pixel = pending.trailing_zeros() as usize % PIXELS;
        let number = tile.shown[pixel];
        let id = S::u32s::splat(simd, number);
        // Pixels that show the same face.
        let mut same = 1 << pixel;
        let mut first = 0;
        while first < PIXELS {
            let shown = S::u32s::from_slice(simd, &tile.shown[first..first + S::f32s::LEN]);
            same |= shown.simd_eq(id).to_bitmask() << first;
            first += S::f32s::LEN;
        }
        same &= pending;
        pending &= !same;
        if number == SKY {
            sky::<S, FLAT>(simd, context, (rays, window), same, colours);
            continue;
        }
        let surface = if number == GROUND {
            let Some(ground) = context.scenery.ground() else { continue };
            context.ground(ground)
        } else {
            context.face(&faces[number as usize])
        };
        let has_sun = match &surface.light {
            Lighting::Flat(fractions) => fractions.sun > 0.0,
            Lighting::Smooth(..) => true,
        };
        let lit = match &context.sun {
            Some(sun) if has_sun => sun.lit_pixels(surface.plane, surface.face_id, same, ray_of),
            _ => same,
        };
        paint::<S, FLAT>(simd, context, (rays, window), &surface, (same, lit, ray_of(pixel)), colours);
    }
}

/// Rounds the colours of a tile to integers; red is the lowest byte, then green and blue.
pub fn round_colours(level: Level, colours: &Colours) -> [i32; PIXELS] {
    dispatch!(level, simd => round_with(simd, colours))
}

#[inline(always)]
fn round_with<S: Simd>(simd: S, colours: &Colours) -> [i32; PIXELS] {
    let mut pixels = [0; PIXELS];
    let mut first = 0;
    while first < PIXELS {
        let lanes = first..first + S::f32s::LEN;
        // All values are between 0 and 255.
        let red: S::i32s = (S::f32s::from_slice(simd, &colours[0][lanes.clone()]) + 0.5).to_int();
        let green: S::i32s = (S::f32s::from_slice(simd, &colours[1][lanes.clone()]) + 0.5).to_int();
        let blue: S::i32s = (S::f32s::from_slice(simd, &colours[2][lanes.clone()]) + 0.5).to_int();
        (red | green << 8 | blue << 16).store_slice(&mut pixels[lanes]);
        first += S::f32s::LEN;
    }
    pixels
}

/// Colours pixels that show one surface. `pixels` and `lit` are bit masks: the pixels, and those that the sun reaches
/// if the surface faces it. `ray` is the ray of one of the pixels.
#[inline(always)]
fn paint<S: Simd, const FLAT: bool>(
    simd: S,
    context: &SurfaceContext,
    (rays, window): (&Rays, &Window),
    surface: &ShadedSurface,
    (pixels, lit, ray): (u64, u64, DVec3),
    colours: &mut Colours,
) {
    let local = |attribute: &Attribute| LocalAttribute::new::<FLAT>(attribute, surface.plane, ray, window);
    let plane = window.local::<FLAT>(surface.plane);
    let image = surface
        .image
        .as_ref()
        .map(|image| (image.mip_map, [local(&image.coordinates[0]), local(&image.coordinates[1])]));
    let painted =
        surface.painted.as_ref().map(|painted| (painted, [local(&painted.position[0]), local(&painted.position[1])]));
    let one = S::f32s::splat(simd, 1.0);
    let mut first = 0;
    while first < PIXELS {
        let lanes = lanes_of::<S>(pixels, first);
        if lanes == 0 {
            first += S::f32s::LEN;
            continue;
        }
        let ray_parameter = one / rays.value::<S, FLAT>(simd, plane, first);
        let mut colour = rgb(simd, surface.colour);
        let mut with_image = lanes;
        let mut position = [one; 2];
        if let Some((painted, [x, y])) = &painted {
            position = [
                rays.value::<S, FLAT>(simd, x.form, first) * ray_parameter,
                rays.value::<S, FLAT>(simd, y.form, first) * ray_parameter,
            ];
            with_image &= on_floor(simd, painted, [x.reference, y.reference], position);
        }
        if let Some((mip_map, [u, v])) = &image
            && with_image != 0
        {
            let projected = [
                rays.value::<S, FLAT>(simd, u.form, first) * ray_parameter,
                rays.value::<S, FLAT>(simd, v.form, first) * ray_parameter,
            ];
            let [width, height] = mip_map.size().map(|side| side as f32);
            let base = |coordinate: f64| match mip_map.wrap() {
                Wrap::Repeat => (coordinate - coordinate.floor()) as f32,
                Wrap::Clamp => coordinate as f32,
            };
            let uv = [projected[0] + base(u.reference), projected[1] + base(v.reference)];
            let mut axes = [[one; 2]; 2];
            let mut axis = 0;
            while axis < 2 {
                let plane_step = rays.step::<S, FLAT>(simd, plane, first, axis);
                let u_step = rays.step::<S, FLAT>(simd, u.form, first, axis);
                let v_step = rays.step::<S, FLAT>(simd, v.form, first, axis);
                axes[axis][0] = (u_step - projected[0] * plane_step) * (ray_parameter * width);
                axes[axis][1] = (v_step - projected[1] * plane_step) * (ray_parameter * height);
                axis += 1;
            }
            let tint = rgb(simd, surface.tint);
            let sample = if mip_map.is_opaque {
                mip_map.sample::<S, 3>(simd, with_image, uv, axes)
            } else {
                mip_map.sample::<S, 4>(simd, with_image, uv, axes)
            };
            let tinted = [sample[0] * tint[0], sample[1] * tint[1], sample[2] * tint[2]];
            colour = if mip_map.is_opaque { tinted } else { over(simd, tinted, sample[3] * (1.0 / 255.0), colour) };
        }
        if let Some((painted, [x, y])) = &painted {
            let is_on_floor = S::mask32s::from_bitmask(simd, with_image);
            colour = select(simd, is_on_floor, colour, rgb(simd, painted.ground.colour.map(f32::from)));
            colour = paint_spots(simd, painted, [x.reference, y.reference], position, colour);
        }
        let [indirect, sun] = match &surface.light {
            Lighting::Flat(fractions) => {
                [S::f32s::splat(simd, fractions.indirect), S::f32s::splat(simd, fractions.sun)]
            }
            Lighting::Smooth(forms, flat_light) => {
                let forms =
                    [window.local::<FLAT>(forms[0]), window.local::<FLAT>(forms[1]), window.local::<FLAT>(forms[2])];
                smooth_light::<S, FLAT>(simd, context, rays, (forms, flat_light), first)
            }
        };
        let lit = S::mask32s::from_bitmask(simd, lanes_of::<S>(lit, first));
        let light = indirect + lit.select(sun, S::f32s::splat(simd, 0.0));
        store(simd, colours, first, lanes, [colour[0] * light, colour[1] * light, colour[2] * light]);
        first += S::f32s::LEN;
    }
}

/// Bit mask of the lanes that show the world's floor; `position` is relative to the point `reference` of the ground.
#[inline(always)]
fn on_floor<S: Simd>(simd: S, painted: &PaintedGround, reference: [f64; 2], position: [S::f32s; 2]) -> u64 {
    let Some(floor) = &painted.ground.floor else { return 0 };
    let low = [-reference[0] as f32, -reference[1] as f32];
    let high = [(floor.size.x - reference[0]) as f32, (floor.size.y - reference[1]) as f32];
    let x = position[0].simd_ge(S::f32s::splat(simd, low[0])) & position[0].simd_le(S::f32s::splat(simd, high[0]));
    let y = position[1].simd_ge(S::f32s::splat(simd, low[1])) & position[1].simd_le(S::f32s::splat(simd, high[1]));
    (x & y).to_bitmask()
}

/// Paints the spots over `colour`; `position` is relative to the point `reference` of the ground.
#[inline(always)]
fn paint_spots<S: Simd>(
    simd: S,
    painted: &PaintedGround,
    reference: [f64; 2],
    position: [S::f32s; 2],
    mut colour: Rgb<S>,
) -> Rgb<S> {
    for spot in &painted.ground.spots {
        let (x, y) = ((spot.centre.x - reference[0]) as f32, (spot.centre.y - reference[1]) as f32);
        let (dx, dy) = (position[0] - x, position[1] - y);
        let is_inside = (dx * dx + dy * dy).simd_le(S::f32s::splat(simd, (spot.radius * spot.radius) as f32));
        if is_inside.to_bitmask() != 0 {
            let [red, green, blue, opacity] = spot.colour.map(f32::from);
            let opacity = S::f32s::splat(simd, opacity / 255.0);
            colour = select(simd, is_inside, over(simd, rgb(simd, [red, green, blue]), opacity, colour), colour);
        }
    }
    colour
}

/// Fractions of indirect light and of sunlight, for a normal that varies over the surface.
#[inline(always)]
fn smooth_light<S: Simd, const FLAT: bool>(
    simd: S,
    context: &SurfaceContext,
    rays: &Rays,
    (forms, flat_light): ([[f32; 3]; 3], &LightFractions),
    first: usize,
) -> [S::f32s; 2] {
    let light = context.scenery.light();
    let (sun, fill) = (light.sun_direction.as_vec3(), fill_direction(light).as_vec3());
    let x = rays.value::<S, FLAT>(simd, forms[0], first);
    let y = rays.value::<S, FLAT>(simd, forms[1], first);
    let z = rays.value::<S, FLAT>(simd, forms[2], first);
    let length = (x * x + y * y + z * z).sqrt();
    let inverse_length = S::f32s::splat(simd, 1.0) / length;
    let (x, y, z) = (x * inverse_length, y * inverse_length, z * inverse_length);
    let fill = (x * fill.x + y * fill.y + z * fill.z + 1.0) * (0.5 * light.fill as f32);
    let zero = S::f32s::splat(simd, 0.0);
    let cosine = x * sun.x + y * sun.y + z * sun.z;
    let sun = cosine.simd_gt(zero).select(cosine, zero) * light.diffuse as f32;
    let is_defined = length.simd_gt(f32::MIN_POSITIVE);
    [
        is_defined.select(fill + light.ambient as f32, S::f32s::splat(simd, flat_light.indirect)),
        is_defined.select(sun, S::f32s::splat(simd, flat_light.sun)),
    ]
}

/// Colours pixels that show the sky.
#[inline(always)]
fn sky<S: Simd, const FLAT: bool>(
    simd: S,
    context: &SurfaceContext,
    (rays, window): (&Rays, &Window),
    pixels: u64,
    colours: &mut Colours,
) {
    let sky = context.scenery.sky();
    let (horizon, zenith) = (rgb(simd, sky.horizon.map(f32::from)), rgb(simd, sky.zenith.map(f32::from)));
    let zero = S::f32s::splat(simd, 0.0);
    let x = window.local::<FLAT>(context.world_from_lens.row(0));
    let y = window.local::<FLAT>(context.world_from_lens.row(1));
    let z = window.local::<FLAT>(context.world_from_lens.row(2));
    let mut first = 0;
    while first < PIXELS {
        let lanes = lanes_of::<S>(pixels, first);
        if lanes != 0 {
            let x = rays.value::<S, FLAT>(simd, x, first);
            let y = rays.value::<S, FLAT>(simd, y, first);
            let z = rays.value::<S, FLAT>(simd, z, first);
            let up = z / (x * x + y * y + z * z).sqrt();
            let up = up.simd_gt(zero).select(up, zero);
            let blend = |channel: usize| horizon[channel] + up * (zenith[channel] - horizon[channel]);
            store(simd, colours, first, lanes, [blend(0), blend(1), blend(2)]);
        }
        first += S::f32s::LEN;
    }
}

/// Bit mask of the pixels of the vector that starts at `first`.
#[inline(always)]
fn lanes_of<S: Simd>(pixels: u64, first: usize) -> u64 {
    pixels >> first & ((1 << S::f32s::LEN) - 1)
}

#[inline(always)]
fn rgb<S: Simd>(simd: S, [red, green, blue]: [f32; 3]) -> Rgb<S> {
    [S::f32s::splat(simd, red), S::f32s::splat(simd, green), S::f32s::splat(simd, blue)]
}

/// Blends `upper` over `under` with an opacity of 0 to 1.
#[inline(always)]
fn over<S: Simd>(_: S, upper: Rgb<S>, opacity: S::f32s, under: Rgb<S>) -> Rgb<S> {
    [
        under[0] + opacity * (upper[0] - under[0]),
        under[1] + opacity * (upper[1] - under[1]),
        under[2] + opacity * (upper[2] - under[2]),
    ]
}

#[inline(always)]
fn select<S: Simd>(_: S, mask: S::mask32s, upper: Rgb<S>, under: Rgb<S>) -> Rgb<S> {
    [mask.select(upper[0], under[0]), mask.select(upper[1], under[1]), mask.select(upper[2], under[2])]
}

/// Stores colours, clamped to 0 to 255, in these lanes.
#[inline(always)]
fn store<S: Simd>(simd: S, colours: &mut Colours, first: usize, lanes: u64, colour: Rgb<S>) {
    let mask = S::mask32s::from_bitmask(simd, lanes);
    let (black, white) = (S::f32s::splat(simd, 0.0), S::f32s::splat(simd, 255.0));
    let mut channel = 0;
    while channel < 3 {
        let output = &mut colours[channel][first..first + S::f32s::LEN];
        let previous = S::f32s::from_slice(simd, output);
        // NaN becomes black.
        let clamped = colour[channel].simd_gt(black).select(colour[channel].min(white), black);
        mask.select(clamped, previous).store_slice(output);
        channel += 1;
    }
}
