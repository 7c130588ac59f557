//! Colours of a tile's pixels.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use glam::DVec3;

use super::face::Face;
use super::rays::{PIXELS, Rays, Window};
use super::surface::{Attribute, Lighting, Painted, ShadedSurface, Shares, SurfaceContext, fill_from};
use super::texture::Wrap;
use super::tile::{GROUND, SKY, Tile};

/// Red, green and blue of a tile's pixels, 0 to 255.
pub type Colours = [[f32; PIXELS]; 3];

type Rgb<S> = [<S as Simd>::f32s; 3];

/// An [`Attribute`] in a tile: its value at one pixel, and a form for its difference at the other pixels.
#[derive(Clone, Copy)]
struct Local {
    here: f64,
    form: [f32; 3],
}

impl Local {
    #[inline(always)]
    fn new<const FLAT: bool>(attribute: &Attribute, plane: DVec3, ray: DVec3, window: &Window) -> Self {
        let here = attribute.form.dot(ray) / plane.dot(ray);
        let here = if here.is_finite() { here } else { 0.0 };
        Self { here: attribute.base + here, form: window.local::<FLAT>(attribute.form - plane * here) }
    }
}

/// Inputs of the colours of a tile.
pub struct Shading<'a> {
    pub context: &'a SurfaceContext<'a>,
    pub faces: &'a [Face],
    pub is_flat: bool,
}

/// Colours the pixels of a tile in the bit mask `wanted`; `ray_of` gives their rays in lens space.
pub fn shade(
    level: Level,
    shading: &Shading,
    at: (&Rays, &Window),
    tile: &Tile,
    wanted: (u64, &dyn Fn(usize) -> DVec3),
    colours: &mut Colours,
) {
    if shading.is_flat {
        dispatch!(level, simd => shade_at::<_, true>(simd, shading, at, tile, wanted, colours));
    } else {
        dispatch!(level, simd => shade_at::<_, false>(simd, shading, at, tile, wanted, colours));
    }
}

#[inline(always)]
fn shade_at<S: Simd, const FLAT: bool>(
    simd: S,
    Shading { context, faces, .. }: &Shading,
    (rays, window): (&Rays, &Window),
    tile: &Tile,
    (wanted, ray_of): (u64, &dyn Fn(usize) -> DVec3),
    colours: &mut Colours,
) {
    let mut pending = wanted;
    while pending != 0 {
        let pixel = pending.trailing_zeros() as usize % PIXELS;
        let number = tile.shown[pixel];
        let id = S::u32s::splat(simd, number);
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
            Some(sun) if has_sun => sun.reaches(surface.plane, surface.face_id, same, ray_of),
            _ => same,
        };
        paint::<S, FLAT>(simd, context, (rays, window), &surface, (same, lit, ray_of(pixel)), colours);
    }
}

/// Rounds the colours of a tile to integers; red is the lowest byte, then green and blue.
pub fn rounded(level: Level, colours: &Colours) -> [u32; PIXELS] {
    dispatch!(level, simd => rounded_at(simd, colours))
}

#[inline(always)]
fn rounded_at<S: Simd>(simd: S, colours: &Colours) -> [u32; PIXELS] {
    let mut pixels = [0; PIXELS];
    let mut first = 0;
    while first < PIXELS {
        let at = first..first + S::f32s::LEN;
        // All values are between 0 and 255.
        let red: S::u32s = (S::f32s::from_slice(simd, &colours[0][at.clone()]) + 0.5).to_int();
        let green: S::u32s = (S::f32s::from_slice(simd, &colours[1][at.clone()]) + 0.5).to_int();
        let blue: S::u32s = (S::f32s::from_slice(simd, &colours[2][at.clone()]) + 0.5).to_int();
        (red | green << 8 | blue << 16).store_slice(&mut pixels[at]);
        first += S::f32s::LEN;
    }
    pixels
}

/// Colours pixels that show one surface. The sun reaches the pixels in the bit mask `lit`, if the surface faces it.
#[inline(always)]
fn paint<S: Simd, const FLAT: bool>(
    simd: S,
    context: &SurfaceContext,
    (rays, window): (&Rays, &Window),
    surface: &ShadedSurface,
    (pixels, lit, ray): (u64, u64, DVec3),
    colours: &mut Colours,
) {
    let local = |attribute: &Attribute| Local::new::<FLAT>(attribute, surface.plane, ray, window);
    let plane = window.local::<FLAT>(surface.plane);
    let image = surface
        .image
        .as_ref()
        .map(|image| (image.mip_map, [local(&image.coordinates[0]), local(&image.coordinates[1])]));
    let painted = surface.painted.as_ref().map(|painted| (painted, [local(&painted.at[0]), local(&painted.at[1])]));
    let one = S::f32s::splat(simd, 1.0);
    let mut first = 0;
    while first < PIXELS {
        let lanes = lanes_of::<S>(pixels, first);
        if lanes == 0 {
            first += S::f32s::LEN;
            continue;
        }
        let per_near = one / rays.value::<S, FLAT>(simd, plane, first);
        let mut colour = rgb(simd, surface.colour);
        let mut wanted = lanes;
        let mut at = [one; 2];
        if let Some((painted, [x, y])) = &painted {
            at = [
                rays.value::<S, FLAT>(simd, x.form, first) * per_near,
                rays.value::<S, FLAT>(simd, y.form, first) * per_near,
            ];
            wanted &= on_floor(simd, painted, [x.here, y.here], at);
        }
        if let Some((mip_map, [u, v])) = &image
            && wanted != 0
        {
            let projected = [
                rays.value::<S, FLAT>(simd, u.form, first) * per_near,
                rays.value::<S, FLAT>(simd, v.form, first) * per_near,
            ];
            let [width, height] = mip_map.size().map(|side| side as f32);
            let base = |here: f64| match mip_map.wrap() {
                Wrap::Repeat => (here - here.floor()) as f32,
                Wrap::Clamp => here as f32,
            };
            let uv = [projected[0] + base(u.here), projected[1] + base(v.here)];
            let mut axes = [[one; 2]; 2];
            let mut axis = 0;
            while axis < 2 {
                let plane_step = rays.step::<S, FLAT>(simd, plane, first, axis);
                let u_step = rays.step::<S, FLAT>(simd, u.form, first, axis);
                let v_step = rays.step::<S, FLAT>(simd, v.form, first, axis);
                axes[axis][0] = (u_step - projected[0] * plane_step) * (per_near * width);
                axes[axis][1] = (v_step - projected[1] * plane_step) * (per_near * height);
                axis += 1;
            }
            let found = mip_map.sample(simd, wanted, uv, axes);
            let tint = rgb(simd, surface.tint);
            let tinted = [found[0] * tint[0], found[1] * tint[1], found[2] * tint[2]];
            colour = if mip_map.is_opaque { tinted } else { over(simd, tinted, found[3] * (1.0 / 255.0), colour) };
        }
        if let Some((painted, [x, y])) = &painted {
            let inside = S::mask32s::from_bitmask(simd, wanted);
            colour = select(simd, inside, colour, rgb(simd, painted.ground.colour.map(f32::from)));
            colour = spots(simd, painted, [x.here, y.here], at, colour);
        }
        let [dim, sun] = match &surface.light {
            Lighting::Flat(fractions) => [S::f32s::splat(simd, fractions.dim), S::f32s::splat(simd, fractions.sun)],
            Lighting::Smooth(forms, flat_light) => {
                let forms =
                    [window.local::<FLAT>(forms[0]), window.local::<FLAT>(forms[1]), window.local::<FLAT>(forms[2])];
                smooth::<S, FLAT>(simd, context, rays, (forms, flat_light), first)
            }
        };
        let lit = S::mask32s::from_bitmask(simd, lanes_of::<S>(lit, first));
        let light = dim + lit.select(sun, S::f32s::splat(simd, 0.0));
        store(simd, colours, first, lanes, [colour[0] * light, colour[1] * light, colour[2] * light]);
        first += S::f32s::LEN;
    }
}

/// Bit mask of the lanes that show the world's floor.
#[inline(always)]
fn on_floor<S: Simd>(simd: S, painted: &Painted, here: [f64; 2], uv: [S::f32s; 2]) -> u64 {
    let Some(floor) = &painted.ground.floor else { return 0 };
    let low = [-here[0] as f32, -here[1] as f32];
    let high = [(floor.size.x - here[0]) as f32, (floor.size.y - here[1]) as f32];
    let x = uv[0].simd_ge(S::f32s::splat(simd, low[0])) & uv[0].simd_le(S::f32s::splat(simd, high[0]));
    let y = uv[1].simd_ge(S::f32s::splat(simd, low[1])) & uv[1].simd_le(S::f32s::splat(simd, high[1]));
    (x & y).to_bitmask()
}

/// Paints the spots over the colour beneath them.
#[inline(always)]
fn spots<S: Simd>(simd: S, painted: &Painted, here: [f64; 2], uv: [S::f32s; 2], under: Rgb<S>) -> Rgb<S> {
    let mut colour = under;
    for spot in &painted.ground.spots {
        let (x, y) = ((spot.centre.x - here[0]) as f32, (spot.centre.y - here[1]) as f32);
        let (dx, dy) = (uv[0] - x, uv[1] - y);
        let within = (dx * dx + dy * dy).simd_le(S::f32s::splat(simd, (spot.radius * spot.radius) as f32));
        if within.to_bitmask() != 0 {
            let [red, green, blue, opacity] = spot.colour.map(f32::from);
            let opacity = S::f32s::splat(simd, opacity / 255.0);
            colour = select(simd, within, over(simd, rgb(simd, [red, green, blue]), opacity, colour), colour);
        }
    }
    colour
}

/// Fractions of indirect light and of sunlight, for a normal that varies over the surface.
#[inline(always)]
fn smooth<S: Simd, const FLAT: bool>(
    simd: S,
    context: &SurfaceContext,
    rays: &Rays,
    (forms, flat): ([[f32; 3]; 3], &Shares),
    first: usize,
) -> [S::f32s; 2] {
    let light = context.scenery.light();
    let (sun, fill) = (light.towards.as_vec3(), fill_from(light).as_vec3());
    let x = rays.value::<S, FLAT>(simd, forms[0], first);
    let y = rays.value::<S, FLAT>(simd, forms[1], first);
    let z = rays.value::<S, FLAT>(simd, forms[2], first);
    let length = (x * x + y * y + z * z).sqrt();
    let per_length = S::f32s::splat(simd, 1.0) / length;
    let (x, y, z) = (x * per_length, y * per_length, z * per_length);
    let fill = (x * fill.x + y * fill.y + z * fill.z + 1.0) * (0.5 * light.fill as f32);
    let zero = S::f32s::splat(simd, 0.0);
    let to_sun = x * sun.x + y * sun.y + z * sun.z;
    let to_sun = to_sun.simd_gt(zero).select(to_sun, zero) * light.diffuse as f32;
    let is_sound = length.simd_gt(f32::MIN_POSITIVE);
    [
        is_sound.select(fill + light.ambient as f32, S::f32s::splat(simd, flat.dim)),
        is_sound.select(to_sun, S::f32s::splat(simd, flat.sun)),
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
        let before = S::f32s::from_slice(simd, output);
        // NaN becomes black.
        let within = colour[channel].simd_gt(black).select(colour[channel].min(white), black);
        mask.select(within, before).store_slice(output);
        channel += 1;
    }
}
