//! Slow reference renderer: it casts one ray per image point in `f64`, with formulas other than the core's. It tests
//! each face whose bounding sphere the ray hits.
//!
//! It implements the documentation of [`sim_core::camera`] on pictures, colours and filters, and shares only the
//! scenery and the views with the core.

mod agreement;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use sim_core::RobotId;
use sim_core::camera::{Label, Lens, PosedScenery, View};
use sim_core::math;
use sim_core::scene::{Material, Texture};

pub use agreement::{Agreement, DEPTH, NEAR, Shot, Wrong};

use crate::oracle;

/// Result of the reference at one point of the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// Surface at this point.
    pub shown: Shown,
    /// Label of that surface.
    pub label: Label,
    /// Distance along the line of sight through this point, in metres; infinite for the sky.
    pub depth: f64,
    /// Red, green, blue, 0 to 255.
    pub colour: [f64; 3],
    /// True if no face hides the sun from this surface, or if shadows are off; false without a surface.
    pub is_sunlit: bool,
}

/// Surface seen by a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Shown {
    /// Outside a fisheye's image, which ends 180 degrees from the optical axis.
    Nothing,
    /// No surface.
    Sky,
    /// The plane z = 0.
    Ground,
    /// A face: index of its part, and its index in that part's mesh.
    Face(usize, usize),
}

/// Reference renderer for the cameras of one robot, or of no robot, with all surfaces in the world frame.
pub struct Reference<'s> {
    posed: &'s PosedScenery<'s>,
    bodies: Vec<Body<'s>>,
    images: BTreeMap<*const Texture, Vec<Image>>,
}

/// Group of consecutive faces of a part of the scenery.
struct Body<'s> {
    part: usize,
    label: Label,
    /// Bounding sphere of the faces.
    centre: DVec3,
    radius: f64,
    faces: Vec<Face<'s>>,
    /// True if the faces belong to the robot that carries the camera.
    is_own: bool,
}

struct Face<'s> {
    number: usize,
    corners: [DVec3; 3],
    /// Unit normal on the side from which the corners are counter-clockwise.
    normal: DVec3,
    normals: Option<[DVec3; 3]>,
    uv: Option<[DVec2; 3]>,
    material: &'s Material,
}

/// Image of a texture: red, green, blue and opacity of each texel, 0 to 255, row by row from the upper left.
struct Image {
    width: usize,
    height: usize,
    texels: Vec<[f64; 4]>,
}

impl<'s> Reference<'s> {
    /// Reference for a camera on robot `by`, or on no robot. The robot is invisible to its own camera.
    pub fn new(posed: &'s PosedScenery<'s>, by: Option<RobotId>) -> Self {
        let scenery = posed.scenery();
        let bodies = posed.parts().flat_map(|(number, part, pose)| {
            let mesh: &'s sim_core::scene::Mesh = &part.mesh;
            let faces =
                mesh.triangles.iter().enumerate().filter(|(_, triangle)| mesh.material(triangle).opacity >= 0.5);
            let faces = faces.map(|(number, triangle)| {
                let corners @ [a, b, c] = mesh.corners(triangle).map(|corner| pose.transform_point(corner));
                Face {
                    number,
                    corners,
                    normal: (b - a).cross(c - a).normalize_or_zero(),
                    normals: triangle.normals.map(|normals| normals.map(|normal| pose.rotation * normal.as_dvec3())),
                    uv: triangle.uv.map(|corners| corners.map(|uv| uv.as_dvec2())),
                    material: mesh.material(triangle),
                }
            });
            let mut faces = faces.peekable();
            std::iter::from_fn(move || {
                faces.peek()?;
                Some(Body::new(number, part.label, faces.by_ref().take(FACES_PER_SPHERE).collect()))
            })
        });
        let bodies: Vec<Body> = bodies.collect();
        let on_faces = bodies.iter().flat_map(|body| &body.faces).filter_map(|face| face.material.texture.as_ref());
        let on_floor = scenery.ground().and_then(|ground| ground.floor.as_ref()?.texture.as_ref());
        let mut images = BTreeMap::new();
        for texture in on_faces.chain(on_floor) {
            images.entry(Arc::as_ptr(texture)).or_insert_with(|| Image::mip_map(texture));
        }
        Self { posed, bodies, images }.by(by)
    }

    /// Changes the reference to a camera on another robot, or on no robot.
    pub fn by(mut self, by: Option<RobotId>) -> Self {
        for body in &mut self.bodies {
            body.is_own = by.is_some_and(|by| body.label == Label::Robot(by));
        }
        self
    }

    /// Sight at a point of the image (columns to the right, rows downwards from the upper left corner).
    pub fn look(&self, view: &View, image_point: DVec2) -> Sight {
        self.sights(view, image_point, 0.0)[0]
    }

    /// Sights at a point of the image: the nearest surface, and all surfaces whose distance exceeds the nearest
    /// distance by at most the fraction `slack`. Rounding decides which of several coincident surfaces is the nearest.
    pub fn sights(&self, view: &View, image_point: DVec2, slack: f64) -> Vec<Sight> {
        let Some(ray) = ray(view, image_point, true) else {
            let nothing = (Shown::Nothing, Label::Sky, f64::INFINITY);
            return vec![sight(nothing, [0.0; 3], false)];
        };
        let origin = view.world_from_camera().position;
        let mut hits: Vec<(f64, Hit)> = Vec::new();
        for body in self.bodies.iter().filter(|body| !body.is_own && body.may_be_hit(origin, ray)) {
            for face in body.faces.iter().filter(|face| (origin - face.corners[0]).dot(face.normal).abs() > EDGE_ON) {
                let distance = oracle::distance_to_triangle(&face.corners, origin, ray, FACE_MARGIN);
                hits.extend(distance.map(|metres| (metres, Hit::Face(body, face))));
            }
        }
        if self.posed.scenery().ground().is_some() && origin.z > 0.0 && ray.z < 0.0 {
            hits.push((origin.z / -ray.z, Hit::Ground));
        }
        hits.sort_by(|one, other| one.0.total_cmp(&other.0));
        let max_distance = hits.first().map_or(0.0, |nearest| nearest.0 * (1.0 + slack));
        let nearest_hits = hits.into_iter().take_while(|(metres, _)| *metres <= max_distance);
        let mut sights: Vec<Sight> = nearest_hits
            .map(|(metres, hit)| match hit {
                Hit::Ground => self.ground(view, image_point, metres),
                Hit::Face(body, face) => self.face(view, image_point, body, face, metres),
            })
            .collect();
        if sights.is_empty() {
            sights.push(sight((Shown::Sky, Label::Sky, f64::INFINITY), self.sky(ray), false));
        }
        sights
    }

    /// Colour of a pixel: the mean of `samples` x `samples` pixels of a picture enlarged by the factor `samples`;
    /// `None` if the enlarged picture exceeds the maximum size.
    pub fn pixel(&self, view: &View, column: u32, row: u32, samples: u32) -> Option<[f64; 3]> {
        let fine = view.enlarged(samples).ok()?;
        let corner = DVec2::new(f64::from(column), f64::from(row)) * f64::from(samples);
        let offsets =
            (0..samples * samples).map(|part| DVec2::new(f64::from(part % samples), f64::from(part / samples)));
        let colours = offsets.map(|offset| self.look(&fine, corner + offset + 0.5).colour);
        let sum = colours.fold([0.0; 3], |sum, colour| std::array::from_fn(|channel| sum[channel] + colour[channel]));
        Some(sum.map(|channel| channel / f64::from(samples * samples)))
    }

    fn sky(&self, ray: DVec3) -> [f64; 3] {
        let sky = self.posed.scenery().sky();
        mixed(sky.horizon.map(f64::from), sky.zenith.map(f64::from), ray.z.max(0.0))
    }

    fn ground(&self, view: &View, image_point: DVec2, metres: f64) -> Sight {
        let ray_around = rays_around(view, image_point);
        let point = |image_point: DVec2| {
            let (origin, ray) = (view.world_from_camera().position, ray_around(image_point));
            (origin + ray * (origin.z / -ray.z)).truncate()
        };
        let here = point(image_point);
        let mut colour = [0.0; 3];
        if let Some(ground) = self.posed.scenery().ground() {
            colour = ground.colour.map(f64::from);
            if let Some(floor) = &ground.floor
                && here.cmpge(DVec2::ZERO).all()
                && here.cmple(floor.size).all()
            {
                colour = floor.colour.map(f64::from);
                if let Some(texture) = &floor.texture {
                    let texel =
                        self.filtered(texture, image_point, false, |image_point| point(image_point) / floor.size);
                    colour = mixed(colour, [texel[0], texel[1], texel[2]], texel[3] / 255.0);
                }
            }
            for spot in ground.spots.iter().filter(|spot| (here - spot.centre).length() <= spot.radius) {
                let [red, green, blue, opacity] = spot.colour.map(f64::from);
                colour = mixed(colour, [red, green, blue], opacity / 255.0);
            }
        }
        let is_sunlit = self.is_sunlit(here.extend(0.0), None);
        let colour = self.lit(colour, DVec3::Z, is_sunlit);
        sight((Shown::Ground, Label::Ground, metres), colour, is_sunlit)
    }

    fn face(&self, view: &View, image_point: DVec2, body: &Body, face: &Face, metres: f64) -> Sight {
        let origin = view.world_from_camera().position;
        let ray_around = rays_around(view, image_point);
        let point = |image_point: DVec2| {
            let ray = ray_around(image_point);
            origin + ray * ((face.corners[0] - origin).dot(face.normal) / ray.dot(face.normal))
        };
        let weights = |image_point: DVec2| face.barycentric(point(image_point));
        let tint = face.material.colour.map(|channel| 255.0 * f64::from(channel).clamp(0.0, 1.0));
        let colour = match (&face.material.texture, face.uv) {
            (Some(texture), Some(uv)) => {
                let uv_at = |image_point: DVec2| {
                    weights(image_point).into_iter().zip(uv).map(|(weight, corner)| corner * weight).sum()
                };
                let [red, green, blue, opacity] = self.filtered(texture, image_point, true, uv_at);
                let tinted = [red * tint[0], green * tint[1], blue * tint[2]].map(|product| product / 255.0);
                mixed(tint, tinted, opacity / 255.0)
            }
            _ => tint,
        };
        let blended = face.normals.map(|normals| {
            let sum: DVec3 =
                weights(image_point).into_iter().zip(normals).map(|(weight, normal)| normal * weight).sum();
            sum.normalize_or(face.normal)
        });
        let side = if (origin - face.corners[0]).dot(face.normal) < 0.0 { -1.0 } else { 1.0 };
        let normal = side * blended.unwrap_or(face.normal);
        let is_sunlit = self.is_sunlit(point(image_point), Some((body.part, face.number)));
        let colour = self.lit(colour, normal, is_sunlit);
        sight((Shown::Face(body.part, face.number), body.label, metres), colour, is_sunlit)
    }

    fn lit(&self, colour: [f64; 3], normal: DVec3, is_sunlit: bool) -> [f64; 3] {
        let light = self.posed.scenery().light();
        let opposite = light.sun_direction * DVec3::new(-1.0, -1.0, 1.0);
        let sun = if is_sunlit { light.diffuse * normal.dot(light.sun_direction).max(0.0) } else { 0.0 };
        let brightness = light.ambient + light.fill * 0.5 * (1.0 + normal.dot(opposite)) + sun;
        colour.map(|channel| (channel * brightness).min(255.0))
    }

    /// Returns true if shadows are off, or if no face lies between the point and the sun. Ignores `surface`, the face
    /// on which the point is, and faces nearer than `MIN_SHADOW_DISTANCE`.
    fn is_sunlit(&self, point: DVec3, surface: Option<(usize, usize)>) -> bool {
        let light = self.posed.scenery().light();
        let is_hit = |body: &Body, face: &Face| {
            surface != Some((body.part, face.number))
                && oracle::distance_to_triangle(&face.corners, point, light.sun_direction, FACE_MARGIN)
                    .is_some_and(|metres| metres > MIN_SHADOW_DISTANCE)
        };
        !light.shadows
            || !self
                .bodies
                .iter()
                .filter(|body| body.may_be_hit(point, light.sun_direction))
                .any(|body| body.faces.iter().any(|face| is_hit(body, face)))
    }

    /// Filtered colour of a texture around the point `image_point` of the picture; `uv_at` maps points of the picture
    /// to points of the texture.
    fn filtered(
        &self,
        texture: &Arc<Texture>,
        image_point: DVec2,
        is_repeated: bool,
        uv_at: impl Fn(DVec2) -> DVec2,
    ) -> [f64; 4] {
        let levels = &self.images[&Arc::as_ptr(texture)];
        let texels = DVec2::new(levels[0].width as f64, levels[0].height as f64);
        // Axes of the footprint, by central differences over 1/1000 pixel.
        let half = 5e-4;
        let axis = |step: DVec2| (uv_at(image_point + step * half) - uv_at(image_point - step * half)) / (2.0 * half);
        let mut axes = [axis(DVec2::X), axis(DVec2::Y)];
        axes.sort_by(|one, other| (*other * texels).length().total_cmp(&(*one * texels).length()));
        let [long, short] = axes.map(|axis| (axis * texels).length());
        let probes = (long / (3.0 * short).max(1.0)).clamp(1.0, MAX_PROBES);
        let level = (math::ln(long / probes) / std::f64::consts::LN_2).clamp(0.0, (levels.len() - 1) as f64);
        let (lower, upper) = (level.floor() as usize, level.ceil() as usize);
        // Offset of the probes from the centre, as a fraction of the longer axis.
        let offset = 0.5 * (1.0 - 1.0 / probes);
        let mut sum = [0.0; 4];
        for probe in [-offset, offset] {
            let uv = uv_at(image_point) + axes[0] * probe;
            let colour = mixed(
                levels[lower].interpolated(uv, is_repeated),
                levels[upper].interpolated(uv, is_repeated),
                ((level - level.floor() - 0.5) / 0.25 + 0.5).clamp(0.0, 1.0),
            );
            sum = std::array::from_fn(|channel| sum[channel] + 0.5 * colour[channel]);
        }
        sum
    }
}

/// Distance by which faces are widened, m, so that no ray slips between two faces that share an edge.
const FACE_MARGIN: f64 = 1e-9;
/// Distance of a camera from a face's plane, m, up to which the face is edge-on and therefore invisible.
const EDGE_ON: f64 = 1e-9;
/// Number of consecutive faces of a mesh that share a bounding sphere.
const FACES_PER_SPHERE: usize = 12;
/// Distance from a point towards the sun, m, up to which a face casts no shadow on the point, so that a face casts no
/// shadow on points of an edge that it shares.
const MIN_SHADOW_DISTANCE: f64 = 1e-6;
/// Maximum number of probes along a footprint.
const MAX_PROBES: f64 = 2.0;

enum Hit<'a, 's> {
    Ground,
    Face(&'a Body<'s>, &'a Face<'s>),
}

fn sight((shown, label, depth): (Shown, Label, f64), colour: [f64; 3], is_sunlit: bool) -> Sight {
    Sight { shown, label, depth, colour, is_sunlit }
}

/// Unit vector of the ray through a point of the image, in the world frame. `None` outside a fisheye's image, more than
/// 180 degrees from the optical axis, if `has_edge`.
fn ray(view: &View, image_point: DVec2, has_edge: bool) -> Option<DVec3> {
    let [width, height] = view.size().map(f64::from);
    // Offset to the left and up, in half widths of the image.
    let offset = (DVec2::new(0.5 * width, 0.5 * height) - image_point) / (0.5 * width);
    let off_axis = |angle: f64| {
        let (sin, cos) = math::sin_cos(angle);
        let across = offset.normalize_or_zero() * sin;
        DVec3::new(cos, across.x, across.y)
    };
    let local = match view.lens() {
        Lens::Pinhole { fov } => off_axis(math::atan(offset.length() * math::tan(0.5 * fov))),
        Lens::Fisheye { fov } => {
            let angle = offset.length() * 0.5 * fov;
            if has_edge && angle > std::f64::consts::PI {
                return None;
            }
            off_axis(angle)
        }
    };
    Some(view.world_from_camera().rotation * local)
}

/// Function that returns the rays through points around a pixel's centre. For a fisheye, rays are interpolated linearly
/// between the neighbouring pixels, as in the definition of its footprints.
fn rays_around(view: &View, middle: DVec2) -> impl Fn(DVec2) -> DVec3 {
    let ray = move |image_point| ray(view, image_point, false).unwrap_or_default();
    let change = move |step: DVec2| 0.5 * (ray(middle + step) - ray(middle - step));
    move |image_point| match view.lens() {
        Lens::Pinhole { .. } => ray(image_point),
        Lens::Fisheye { .. } => {
            let offset = image_point - middle;
            ray(middle) + offset.x * change(DVec2::X) + offset.y * change(DVec2::Y)
        }
    }
}

fn mixed<const N: usize>(one: [f64; N], other: [f64; N], fraction: f64) -> [f64; N] {
    std::array::from_fn(|channel| (1.0 - fraction) * one[channel] + fraction * other[channel])
}

impl<'s> Body<'s> {
    fn new(part: usize, label: Label, faces: Vec<Face<'s>>) -> Self {
        let corners = || faces.iter().flat_map(|face| face.corners);
        let low = corners().fold(DVec3::INFINITY, DVec3::min);
        let centre = 0.5 * (low + corners().fold(DVec3::NEG_INFINITY, DVec3::max));
        let radius = corners().map(|corner| (corner - centre).length()).fold(0.0, f64::max);
        Self { part, label, centre, radius: 1.001 * radius + 1e-6, faces, is_own: false }
    }

    /// Returns true if the ray hits the body's bounding sphere.
    fn may_be_hit(&self, origin: DVec3, direction: DVec3) -> bool {
        let to_centre = self.centre - origin;
        let along = to_centre.dot(direction);
        let nearest = if along > 0.0 { to_centre - along * direction } else { to_centre };
        nearest.length() <= self.radius
    }
}

impl Face<'_> {
    /// Barycentric coordinates of a point in the face's plane.
    fn barycentric(&self, point: DVec3) -> [f64; 3] {
        let [a, b, c] = self.corners.map(|corner| corner - point);
        let areas = [b.cross(c), c.cross(a), a.cross(b)].map(|area| area.dot(self.normal));
        let sum: f64 = areas.iter().sum();
        areas.map(|area| area / sum)
    }
}

impl Image {
    /// Mip map of a texture: each image is half as wide and high as the previous one, down to a single texel.
    fn mip_map(texture: &Texture) -> Vec<Self> {
        let (width, height) = texture.size();
        let texels = (0..width * height).map(|index| texture.pixel(index % width, index / width).map(f64::from));
        let mut levels = vec![Self { width: width as usize, height: height as usize, texels: texels.collect() }];
        while let Some(last) = levels.last().filter(|last| last.texels.len() > 1) {
            let half = last.half();
            levels.push(half);
        }
        levels
    }

    /// Image of half the size: rounded means of two by two texels. An odd last row or column is dropped; a single row
    /// or column is used twice.
    fn half(&self) -> Self {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let texels = (0..width * height).map(|index| {
            let (column, row) = (2 * (index % width), 2 * (index / width));
            let corners = [(0, 0), (1, 0), (0, 1), (1, 1)]
                .map(|(x, y)| self.texel((column + x).min(self.width - 1), (row + y).min(self.height - 1)));
            std::array::from_fn(|channel| (corners.iter().map(|texel| texel[channel]).sum::<f64>() / 4.0 + 0.5).floor())
        });
        Self { width, height, texels: texels.collect() }
    }

    fn texel(&self, column: usize, row: usize) -> [f64; 4] {
        self.texels[row * self.width + column]
    }

    /// Bilinear interpolation between the four texels around `uv`: u to the right and v upwards, from 0 to 1 over the
    /// image.
    fn interpolated(&self, uv: DVec2, is_repeated: bool) -> [f64; 4] {
        let uv = if is_repeated { uv } else { uv.clamp(DVec2::ZERO, DVec2::ONE) };
        let (x, y) = (uv.x * self.width as f64 - 0.5, (1.0 - uv.y) * self.height as f64 - 0.5);
        let texel = |x: f64, y: f64| {
            let index = |coordinate: f64, size: usize| {
                let (index, size) = (coordinate as i64, size as i64);
                (if is_repeated { index.rem_euclid(size) } else { index.clamp(0, size - 1) }) as usize
            };
            self.texel(index(x, self.width), index(y, self.height))
        };
        let row = |y: f64| mixed(texel(x.floor(), y), texel(x.floor() + 1.0, y), x - x.floor());
        mixed(row(y.floor()), row(y.floor() + 1.0), y - y.floor())
    }
}
