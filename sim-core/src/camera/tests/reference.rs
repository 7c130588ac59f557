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

struct Meeting {
    shown: Shown,
    distance: f64,
    /// Barycentric coordinates.
    barycentric: [f64; 3],
}

/// Relative margin by which a face must be nearer to cover an earlier one, so that the first of several coplanar faces
/// is visible.
const COPLANAR: f64 = 1e-7;

pub fn render(posed: &PosedScenery, view: &View, by: Option<RobotId>) -> Reference {
    let [width, height] = view.size();
    let (mut shown, mut depth, mut colour) = (Vec::new(), Vec::new(), Vec::new());
    for row in 0..height {
        for column in 0..width {
            let at = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
            let Some(ray) = direction(view, at) else {
                shown.push(Shown::Sky);
                depth.push(f64::INFINITY);
                colour.push([0.0; 3]);
                continue;
            };
            let eye = view.world_from_camera().position;
            let meeting = meet(posed, eye, ray.normalize_or_zero(), by);
            shown.push(meeting.shown);
            depth.push(meeting.distance);
            colour.push(colour_of(posed, view, at, ray, &meeting));
        }
    }
    Reference {
        shown: Picture::new(view.size(), shown),
        depth: Picture::new(view.size(), depth),
        colour: Picture::new(view.size(), colour),
    }
}

/// The ray through a position of the image, in the world frame, not normalised.
fn direction(view: &View, at: DVec2) -> Option<DVec3> {
    view.ray(at).map(|ray| view.world_from_camera().rotation * ray)
}

fn corners(posed: &PosedScenery, part: usize, triangle: usize) -> [DVec3; 3] {
    let mesh = &posed.scenery().parts()[part].mesh;
    mesh.corners(&mesh.triangles[triangle]).map(|corner| pose(posed, part).transform_point(corner))
}

fn pose(posed: &PosedScenery, part: usize) -> Pose3 {
    posed.poses()[part].expect("only of parts that are there")
}

fn meet(posed: &PosedScenery, eye: DVec3, ray: DVec3, by: Option<RobotId>) -> Meeting {
    let mut best = Meeting { shown: Shown::Sky, distance: f64::INFINITY, barycentric: [0.0; 3] };
    if posed.scenery().ground().is_some() && eye.z > 0.0 && ray.z < 0.0 {
        best = Meeting { shown: Shown::Ground, distance: eye.z / -ray.z, ..best };
    }
    for (number, part, _) in posed.parts() {
        if by.is_some_and(|by| part.label == Label::Robot(by)) {
            continue;
        }
        for (index, triangle) in part.mesh.triangles.iter().enumerate() {
            if part.mesh.material(triangle).opacity < 0.5 {
                continue;
            }
            let corners = corners(posed, number, index);
            if let Some((distance, barycentric)) = on_plane(corners, eye, ray)
                && barycentric.iter().all(|fraction| *fraction >= 0.0)
                && distance < best.distance * (1.0 - COPLANAR)
            {
                best = Meeting { shown: Shown::Face(number, index), distance, barycentric };
            }
        }
    }
    best
}

/// Intersection of the ray with the plane of a triangle: distance and barycentric coordinates. `None` behind the eye.
fn on_plane([a, b, c]: [DVec3; 3], eye: DVec3, ray: DVec3) -> Option<(f64, [f64; 3])> {
    let normal = (b - a).cross(c - a);
    let distance = normal.dot(a - eye) / normal.dot(ray);
    let point = eye + ray * distance;
    let fraction = |from: DVec3, to: DVec3| (to - from).cross(point - from).dot(normal) / normal.length_squared();
    (distance > 0.0 && distance.is_finite()).then(|| (distance, [fraction(b, c), fraction(c, a), fraction(a, b)]))
}

fn colour_of(posed: &PosedScenery, view: &View, at: DVec2, ray: DVec3, meeting: &Meeting) -> [f64; 3] {
    let scenery = posed.scenery();
    let eye = view.world_from_camera().position;
    // Points on the surface half a pixel to the sides, extrapolated from the change of the ray.
    let neighbours = |step: DVec2| {
        let [before, behind] = [-0.5, 0.5].map(|half| view.continued_ray(at + half * step).1);
        1e-4 * (view.world_from_camera().rotation * (behind - before))
    };
    match meeting.shown {
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
                    let change = |step| (on_ground(ray + neighbours(step)) - point) / floor.size * 1e4;
                    let found = filtered(image, Wrap::Clamp, point / floor.size, [change(DVec2::X), change(DVec2::Y)]);
                    colour = over(found, colour);
                }
            }
            for spot in &ground.spots {
                if point.distance(spot.centre) <= spot.radius {
                    colour = over(spot.colour.map(f64::from), colour);
                }
            }
            lit(posed, colour, DVec3::Z, (point.extend(0.0), meeting.shown))
        }
        Shown::Face(number, triangle) => {
            let part = &scenery.parts()[number];
            let own = triangle;
            let triangle = &part.mesh.triangles[own];
            let material = part.mesh.material(triangle);
            let plain = material.colour.map(|component| 255.0 * f64::from(component.clamp(0.0, 1.0)));
            let corners = corners(posed, number, own);
            let colour = match (&material.texture, triangle.uv) {
                (Some(image), Some(uv)) => {
                    let at = |ray: DVec3| {
                        let fractions =
                            on_plane(corners, eye, ray).map_or(meeting.barycentric, |(_, fractions)| fractions);
                        (0..3).map(|corner| uv[corner].as_dvec2() * fractions[corner]).sum::<DVec2>()
                    };
                    let point = at(ray);
                    let change = |step| (at(ray + neighbours(step)) - point) * 1e4;
                    let [red, green, blue, opacity] =
                        filtered(image, Wrap::Repeat, point, [change(DVec2::X), change(DVec2::Y)]);
                    let tint = plain.map(|channel| channel / 255.0);
                    over([red * tint[0], green * tint[1], blue * tint[2], opacity], plain)
                }
                _ => plain,
            };
            let [a, b, c] = corners;
            let face_normal = (b - a).cross(c - a).normalize_or_zero();
            let turned = |normal: glam::Vec3| pose(posed, number).rotation * normal.as_dvec3();
            let normal = triangle.normals.map_or(face_normal, |normals| {
                (0..3)
                    .map(|corner| turned(normals[corner]) * meeting.barycentric[corner])
                    .sum::<DVec3>()
                    .normalize_or(face_normal)
            });
            let intersection = eye + ray.normalize_or_zero() * meeting.distance;
            lit(posed, colour, if face_normal.dot(ray) < 0.0 { normal } else { -normal }, (intersection, meeting.shown))
        }
    }
}

/// Returns true if no face except `own` lies between the sun and a point.
fn is_in_sun(posed: &PosedScenery, point: DVec3, own: Shown) -> bool {
    let light = posed.scenery().light();
    let covers = |number: usize, triangle: usize| {
        own != Shown::Face(number, triangle)
            && on_plane(corners(posed, number, triangle), point, light.towards)
                .is_some_and(|(distance, fractions)| distance > 1e-6 && fractions.iter().all(|share| *share >= 0.0))
    };
    let of_part = |(number, part, _): (usize, &crate::camera::Part, &Pose3)| {
        let is_seen = |triangle: usize| part.mesh.material(&part.mesh.triangles[triangle]).opacity >= 0.5;
        (0..part.mesh.triangles.len()).any(|triangle| is_seen(triangle) && covers(number, triangle))
    };
    !light.shadows || !posed.parts().any(of_part)
}

fn lit(posed: &PosedScenery, colour: [f64; 3], normal: DVec3, (point, own): (DVec3, Shown)) -> [f64; 3] {
    let light = posed.scenery().light();
    let sun = if is_in_sun(posed, point, own) { light.diffuse } else { 0.0 };
    let opposite = DVec3::new(-light.towards.x, -light.towards.y, light.towards.z);
    let fraction =
        light.ambient + light.fill * 0.5 * (1.0 + normal.dot(opposite)) + sun * normal.dot(light.towards).max(0.0);
    colour.map(|channel| (channel * fraction).min(255.0))
}

fn over([red, green, blue, opacity]: [f64; 4], under: [f64; 3]) -> [f64; 3] {
    let upper = [red, green, blue];
    std::array::from_fn(|channel| under[channel] + opacity / 255.0 * (upper[channel] - under[channel]))
}

/// The filter of [`MipMap`], implemented from its definition.
pub fn filtered(image: &Texture, wrap: Wrap, at: DVec2, changes: [DVec2; 2]) -> [f64; 4] {
    let (width, height) = image.size();
    let texels = DVec2::new(f64::from(width), f64::from(height));
    let [a, b] = changes.map(|change| (change * texels).length());
    let (long, short, axis) = if a >= b { (a, b, changes[0]) } else { (b, a, changes[1]) };
    let n = (long / (3.0 * short).max(1.0)).clamp(1.0, f64::from(MipMap::PROBES));
    let half_spread = (1.0 - 1.0 / n) / 2.0;
    let levels = smaller(image);
    let level = (math::ln(long / n) / std::f64::consts::LN_2).clamp(0.0, (levels.len() - 1) as f64);
    let mut sum = [0.0; 4];
    for offset in [-half_spread, half_spread] {
        let lower = level as usize;
        let uv = at + axis * offset;
        let fine = bilinear(&levels[lower], wrap, uv);
        let coarse = bilinear(&levels[(lower + 1).min(levels.len() - 1)], wrap, uv);
        let fraction = ((level - level.floor() - 0.5) / 0.25 + 0.5).clamp(0.0, 1.0);
        sum =
            std::array::from_fn(|channel| sum[channel] + fine[channel] + fraction * (coarse[channel] - fine[channel]));
    }
    sum.map(|channel| channel / 2.0)
}

/// The image and its smaller mip levels.
fn smaller(image: &Texture) -> Vec<Texture> {
    let mut levels = vec![image.clone()];
    while let Some(last) = levels.last().filter(|last| last.size() != (1, 1)) {
        let (width, height) = last.size();
        let half = |side: u32| (side / 2).max(1);
        let mut pixels = Vec::new();
        for row in 0..half(height) {
            for column in 0..half(width) {
                let (x, y) = ((2 * column + 1).min(width - 1), (2 * row + 1).min(height - 1));
                let below =
                    [(2 * column, 2 * row), (x, 2 * row), (2 * column, y), (x, y)].map(|(x, y)| last.pixel(x, y));
                let mean = |channel: usize| below.iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>() / 4.0;
                pixels.push([0, 1, 2, 3].map(|channel| (mean(channel) + 0.5).floor() as u8));
            }
        }
        levels.push(Texture::new(half(width), half(height), pixels).expect("as many pixels"));
    }
    levels
}

fn bilinear(image: &Texture, wrap: Wrap, at: DVec2) -> [f64; 4] {
    let (width, height) = image.size();
    let wrapped = |part: f64| match wrap {
        Wrap::Repeat => part,
        Wrap::Clamp => part.clamp(0.0, 1.0),
    };
    let x = wrapped(at.x) * f64::from(width) - 0.5;
    let y = (1.0 - wrapped(at.y)) * f64::from(height) - 0.5;
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
