//! Reference renderer: tests every face on every pixel, in `f64`.

use glam::{DVec2, DVec3};

use crate::RobotId;
use crate::camera::texture::{MipMap, Wrap};
use crate::camera::{Label, Picture, PosedScenery, View};
use crate::math;
use crate::pose::Pose3;
use crate::scene::Texture;

/// Surface shown by a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shown {
    Sky,
    Ground,
    /// Part and triangle.
    Face(usize, usize),
}

/// A rendered picture with its depths and the surface shown by each pixel.
pub struct Reference {
    pub shown: Picture<Shown>,
    pub depth: Picture<f64>,
    pub colour: Picture<[f64; 3]>,
}

struct Hit {
    shown: Shown,
    distance: f64,
    barycentric: [f64; 3],
}

/// Relative margin by which a face must be nearer to cover an earlier one, so that the first of several coplanar faces
/// is visible.
const COPLANAR: f64 = 1e-7;

pub fn render(posed: &PosedScenery, view: &View, observer: Option<RobotId>) -> Reference {
    let [width, height] = view.size();
    let (mut shown, mut depth, mut colour) = (Vec::new(), Vec::new(), Vec::new());
    for row in 0..height {
        for column in 0..width {
            let position = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
            let Some(ray) = direction(view, position) else {
                shown.push(Shown::Sky);
                depth.push(f64::INFINITY);
                colour.push([0.0; 3]);
                continue;
            };
            let eye = view.world_from_camera().position;
            let hit = cast(posed, eye, ray.normalize_or_zero(), observer);
            shown.push(hit.shown);
            depth.push(hit.distance);
            colour.push(colour_of(posed, view, position, ray, &hit));
        }
    }
    Reference {
        shown: Picture::new(view.size(), shown),
        depth: Picture::new(view.size(), depth),
        colour: Picture::new(view.size(), colour),
    }
}

/// The ray through a position of the image, in the world frame, not normalised.
fn direction(view: &View, position: DVec2) -> Option<DVec3> {
    view.ray(position).map(|ray| view.world_from_camera().rotation * ray)
}

fn corners(posed: &PosedScenery, part: usize, triangle: usize) -> [DVec3; 3] {
    let mesh = &posed.scenery().parts()[part].mesh;
    mesh.corners(&mesh.triangles[triangle]).map(|corner| pose(posed, part).transform_point(corner))
}

fn pose(posed: &PosedScenery, part: usize) -> Pose3 {
    posed.poses()[part].expect("the part is present")
}

fn cast(posed: &PosedScenery, eye: DVec3, ray: DVec3, observer: Option<RobotId>) -> Hit {
    let mut best = Hit { shown: Shown::Sky, distance: f64::INFINITY, barycentric: [0.0; 3] };
    if posed.scenery().ground().is_some() && eye.z > 0.0 && ray.z < 0.0 {
        best = Hit { shown: Shown::Ground, distance: eye.z / -ray.z, ..best };
    }
    for (number, part, _) in posed.parts() {
        if observer.is_some_and(|robot| part.label == Label::Robot(robot)) {
            continue;
        }
        for (index, triangle) in part.mesh.triangles.iter().enumerate() {
            if part.mesh.material(triangle).opacity < 0.5 {
                continue;
            }
            let corners = corners(posed, number, index);
            if let Some((distance, barycentric)) = intersect_plane(corners, eye, ray)
                && barycentric.iter().all(|fraction| *fraction >= 0.0)
                && distance < best.distance * (1.0 - COPLANAR)
            {
                best = Hit { shown: Shown::Face(number, index), distance, barycentric };
            }
        }
    }
    best
}

/// Intersection of the ray with the plane of a triangle: distance and barycentric coordinates. `None` if it is behind
/// the eye.
fn intersect_plane([a, b, c]: [DVec3; 3], eye: DVec3, ray: DVec3) -> Option<(f64, [f64; 3])> {
    let normal = (b - a).cross(c - a);
    let distance = normal.dot(a - eye) / normal.dot(ray);
    let point = eye + ray * distance;
    let fraction = |from: DVec3, to: DVec3| (to - from).cross(point - from).dot(normal) / normal.length_squared();
    (distance > 0.0 && distance.is_finite()).then(|| (distance, [fraction(b, c), fraction(c, a), fraction(a, b)]))
}

fn colour_of(posed: &PosedScenery, view: &View, position: DVec2, ray: DVec3, hit: &Hit) -> [f64; 3] {
    let scenery = posed.scenery();
    let eye = view.world_from_camera().position;
    // A ten-thousandth of the ray's change over one pixel.
    let ray_step = |step: DVec2| {
        let [previous, next] = [-0.5, 0.5].map(|half| view.continued_ray(position + half * step).1);
        1e-4 * (view.world_from_camera().rotation * (next - previous))
    };
    match hit.shown {
        Shown::Sky => {
            let up = ray.normalize_or_zero().z.max(0.0);
            let sky = scenery.sky();
            std::array::from_fn(|channel| {
                let [horizon, zenith] = [sky.horizon, sky.zenith].map(|colour| f64::from(colour[channel]));
                horizon + up * (zenith - horizon)
            })
        }
        Shown::Ground => {
            let Some(ground) = scenery.ground() else { return [0.0; 3] };
            let on_ground = |ray: DVec3| (eye + ray * (eye.z / -ray.z)).truncate();
            let point = on_ground(ray);
            let mut colour = ground.colour.map(f64::from);
            if let Some(floor) = &ground.floor
                && point.cmpge(DVec2::ZERO).all()
                && point.cmple(floor.size).all()
            {
                colour = floor.colour.map(f64::from);
                if let Some(image) = &floor.texture {
                    let change = |step| (on_ground(ray + ray_step(step)) - point) / floor.size * 1e4;
                    let sample = filtered(image, Wrap::Clamp, point / floor.size, [change(DVec2::X), change(DVec2::Y)]);
                    colour = over(sample, colour);
                }
            }
            for spot in &ground.spots {
                if point.distance(spot.centre) <= spot.radius {
                    colour = over(spot.colour.map(f64::from), colour);
                }
            }
            lit(posed, colour, DVec3::Z, (point.extend(0.0), hit.shown))
        }
        Shown::Face(number, index) => {
            let part = &scenery.parts()[number];
            let triangle = &part.mesh.triangles[index];
            let material = part.mesh.material(triangle);
            let plain = material.colour.map(|component| 255.0 * f64::from(component.clamp(0.0, 1.0)));
            let corners = corners(posed, number, index);
            let colour = match (&material.texture, triangle.uv) {
                (Some(image), Some(uv)) => {
                    let uv_at = |ray: DVec3| {
                        let fractions =
                            intersect_plane(corners, eye, ray).map_or(hit.barycentric, |(_, fractions)| fractions);
                        (0..3).map(|corner| uv[corner].as_dvec2() * fractions[corner]).sum::<DVec2>()
                    };
                    let point = uv_at(ray);
                    let change = |step| (uv_at(ray + ray_step(step)) - point) * 1e4;
                    let [red, green, blue, opacity] =
                        filtered(image, Wrap::Repeat, point, [change(DVec2::X), change(DVec2::Y)]);
                    let tint = plain.map(|channel| channel / 255.0);
                    over([red * tint[0], green * tint[1], blue * tint[2], opacity], plain)
                }
                _ => plain,
            };
            let [a, b, c] = corners;
            let face_normal = (b - a).cross(c - a).normalize_or_zero();
            let rotated = |normal: glam::Vec3| pose(posed, number).rotation * normal.as_dvec3();
            let normal = triangle.normals.map_or(face_normal, |normals| {
                (0..3)
                    .map(|corner| rotated(normals[corner]) * hit.barycentric[corner])
                    .sum::<DVec3>()
                    .normalize_or(face_normal)
            });
            let intersection = eye + ray.normalize_or_zero() * hit.distance;
            lit(posed, colour, if face_normal.dot(ray) < 0.0 { normal } else { -normal }, (intersection, hit.shown))
        }
    }
}

/// Returns true if no face except `shown` lies between the sun and a point.
fn is_in_sun(posed: &PosedScenery, point: DVec3, shown: Shown) -> bool {
    let light = posed.scenery().light();
    let covers = |number: usize, triangle: usize| {
        shown != Shown::Face(number, triangle)
            && intersect_plane(corners(posed, number, triangle), point, light.sun_direction)
                .is_some_and(|(distance, fractions)| distance > 1e-6 && fractions.iter().all(|share| *share >= 0.0))
    };
    let part_covers = |(number, part, _): (usize, &crate::camera::Part, &Pose3)| {
        let is_visible = |triangle: usize| part.mesh.material(&part.mesh.triangles[triangle]).opacity >= 0.5;
        (0..part.mesh.triangles.len()).any(|triangle| is_visible(triangle) && covers(number, triangle))
    };
    !light.shadows || !posed.parts().any(part_covers)
}

fn lit(posed: &PosedScenery, colour: [f64; 3], normal: DVec3, (point, shown): (DVec3, Shown)) -> [f64; 3] {
    let light = posed.scenery().light();
    let sun = if is_in_sun(posed, point, shown) { light.diffuse } else { 0.0 };
    let opposite = DVec3::new(-light.sun_direction.x, -light.sun_direction.y, light.sun_direction.z);
    let fraction = light.ambient
        + light.fill * 0.5 * (1.0 + normal.dot(opposite))
        + sun * normal.dot(light.sun_direction).max(0.0);
    colour.map(|channel| (channel * fraction).min(255.0))
}

fn over([red, green, blue, opacity]: [f64; 4], under: [f64; 3]) -> [f64; 3] {
    let upper = [red, green, blue];
    std::array::from_fn(|channel| under[channel] + opacity / 255.0 * (upper[channel] - under[channel]))
}

/// The filter of [`MipMap`], implemented from its definition.
pub fn filtered(image: &Texture, wrap: Wrap, uv: DVec2, steps: [DVec2; 2]) -> [f64; 4] {
    let (width, height) = image.size();
    let texels = DVec2::new(f64::from(width), f64::from(height));
    let [a, b] = steps.map(|step| (step * texels).length());
    let (long, short, axis) = if a >= b { (a, b, steps[0]) } else { (b, a, steps[1]) };
    let n = (long / (3.0 * short).max(1.0)).clamp(1.0, f64::from(MipMap::PROBES));
    let half_spread = (1.0 - 1.0 / n) / 2.0;
    let levels = mip_levels(image);
    let level = (math::ln(long / n) / std::f64::consts::LN_2).clamp(0.0, (levels.len() - 1) as f64);
    let mut sum = [0.0; 4];
    for offset in [-half_spread, half_spread] {
        let lower = level as usize;
        let probe = uv + axis * offset;
        let fine = bilinear(&levels[lower], wrap, probe);
        let coarse = bilinear(&levels[(lower + 1).min(levels.len() - 1)], wrap, probe);
        let fraction = ((level - level.floor() - 0.5) / 0.25 + 0.5).clamp(0.0, 1.0);
        sum =
            std::array::from_fn(|channel| sum[channel] + fine[channel] + fraction * (coarse[channel] - fine[channel]));
    }
    sum.map(|channel| channel / 2.0)
}

/// The image and its smaller mip levels.
fn mip_levels(image: &Texture) -> Vec<Texture> {
    let mut levels = vec![image.clone()];
    while let Some(last) = levels.last().filter(|last| last.size() != (1, 1)) {
        let (width, height) = last.size();
        let half = |side: u32| (side / 2).max(1);
        let mut pixels = Vec::new();
        for row in 0..half(height) {
            for column in 0..half(width) {
                let (x, y) = ((2 * column + 1).min(width - 1), (2 * row + 1).min(height - 1));
                let sources =
                    [(2 * column, 2 * row), (x, 2 * row), (2 * column, y), (x, y)].map(|(x, y)| last.pixel(x, y));
                let mean = |channel: usize| sources.iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>() / 4.0;
                pixels.push([0, 1, 2, 3].map(|channel| (mean(channel) + 0.5).floor() as u8));
            }
        }
        levels.push(Texture::new(half(width), half(height), pixels).expect("as many pixels"));
    }
    levels
}

fn bilinear(image: &Texture, wrap: Wrap, uv: DVec2) -> [f64; 4] {
    let (width, height) = image.size();
    let wrapped = |coordinate: f64| match wrap {
        Wrap::Repeat => coordinate,
        Wrap::Clamp => coordinate.clamp(0.0, 1.0),
    };
    let x = wrapped(uv.x) * f64::from(width) - 0.5;
    let y = (1.0 - wrapped(uv.y)) * f64::from(height) - 0.5;
    let texel = |column: f64, row: f64| {
        let coordinate = |coordinate: f64, size: u32| match wrap {
            Wrap::Repeat => coordinate.rem_euclid(f64::from(size)) as u32,
            Wrap::Clamp => coordinate.clamp(0.0, f64::from(size - 1)) as u32,
        };
        image.pixel(coordinate(column, width), coordinate(row, height)).map(f64::from)
    };
    let (left, top) = (x.floor(), y.floor());
    let [nw, ne, sw, se] =
        [texel(left, top), texel(left + 1.0, top), texel(left, top + 1.0), texel(left + 1.0, top + 1.0)];
    std::array::from_fn(|channel| {
        let north = nw[channel] + (x - left) * (ne[channel] - nw[channel]);
        let south = sw[channel] + (x - left) * (se[channel] - sw[channel]);
        north + (y - top) * (south - north)
    })
}
