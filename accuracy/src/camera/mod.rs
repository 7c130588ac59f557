//! What cameras see, the slow and plain way: one ray a place, each face tried in doubles, formulas other than the core's.
//!
//! Written from what the documentation of [`sim_core::camera`] says of pictures, colours and filters; shares with it the
//! scenery alone.

mod agreement;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DVec2, DVec3};
use sim_core::RobotId;
use sim_core::camera::{Label, Lens, Still, View};
use sim_core::math;
use sim_core::scene::{Material, Texture};

pub use agreement::{Agreement, DEPTH, NEAR, Shot, Wrong};

use crate::oracle;

/// What a camera sees at a place of its image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sight {
    /// What is there.
    pub shown: Shown,
    /// What it is.
    pub label: Label,
    /// Metres along the line of sight; infinite for the sky.
    pub depth: f64,
    /// Red, green, blue, 0 to 255.
    pub colour: [f64; 3],
    /// Whether the sun reaches it.
    pub is_sunlit: bool,
}

/// A surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Shown {
    /// What the lens does not show.
    Nothing,
    /// No surface.
    Sky,
    /// The plane z = 0.
    Ground,
    /// A face: place of its part, and its own in that part's mesh.
    Face(usize, usize),
}

/// All that one camera may see, in the world's frame.
pub struct Reference<'s> {
    still: &'s Still<'s>,
    bodies: Vec<Body<'s>>,
    images: BTreeMap<*const Texture, Vec<Image>>,
}

/// Some faces of a part of the scenery.
struct Body<'s> {
    part: usize,
    label: Label,
    /// A ball around all faces.
    centre: DVec3,
    radius: f64,
    faces: Vec<Face<'s>>,
    is_own: bool,
}

struct Face<'s> {
    number: usize,
    corners: [DVec3; 3],
    /// Of length 1, the corners counter-clockwise around it.
    normal: DVec3,
    normals: Option<[DVec3; 3]>,
    uv: Option<[DVec2; 3]>,
    material: &'s Material,
}

/// Colours beside and above each other, from the upper left, and opacity; 0 to 255.
struct Image {
    width: usize,
    height: usize,
    texels: Vec<[f64; 4]>,
}

impl<'s> Reference<'s> {
    /// What the camera of robot `by` may see: not that robot's own body.
    pub fn new(still: &'s Still<'s>, by: Option<RobotId>) -> Self {
        let scenery = still.scenery();
        let bodies = still.parts().flat_map(|(number, part, pose)| {
            let mesh: &'s sim_core::scene::Mesh = &part.mesh;
            let faces =
                mesh.triangles.iter().enumerate().filter(|(_, triangle)| mesh.material(triangle).opacity >= 0.5);
            let faces = faces.map(|(number, triangle)| {
                let corners @ [a, b, c] = mesh.corners(triangle).map(|corner| pose.transform_point(corner));
                Face {
                    number,
                    corners,
                    normal: (b - a).cross(c - a).normalize_or_zero(),
                    normals: triangle.normals.map(|all| all.map(|normal| pose.rotation * normal.as_dvec3())),
                    uv: triangle.uv.map(|all| all.map(|uv| uv.as_dvec2())),
                    material: mesh.material(triangle),
                }
            });
            let mut faces = faces.peekable();
            std::iter::from_fn(move || {
                faces.peek()?;
                Some(Body::new(number, part.label, faces.by_ref().take(IN_A_BALL).collect()))
            })
        });
        let bodies: Vec<Body> = bodies.collect();
        let on_faces = bodies.iter().flat_map(|body| &body.faces).filter_map(|face| face.material.texture.as_ref());
        let on_floor = scenery.ground().and_then(|ground| ground.floor.as_ref()?.texture.as_ref());
        let mut images = BTreeMap::new();
        for texture in on_faces.chain(on_floor) {
            images.entry(Arc::as_ptr(texture)).or_insert_with(|| Image::all(texture));
        }
        Self { still, bodies, images }.by(by)
    }

    /// The same for the camera of another robot, or of none.
    pub fn by(mut self, by: Option<RobotId>) -> Self {
        for body in &mut self.bodies {
            body.is_own = by.is_some_and(|by| body.label == Label::Robot(by));
        }
        self
    }

    /// What is seen at a place of the image (columns to the right, rows downwards from the upper left corner).
    pub fn look(&self, view: &View, at: DVec2) -> Sight {
        self.sights(view, at, 0.0)[0]
    }

    /// What is seen at a place of the image, and behind it all that is farther away by no more than a `slack` of its distance:
    /// where surfaces lie in each other, rounding decides which of them is nearer.
    pub fn sights(&self, view: &View, at: DVec2, slack: f64) -> Vec<Sight> {
        let Some(ray) = ray(view, at, true) else {
            let nothing = (Shown::Nothing, Label::Sky, f64::INFINITY);
            return vec![sight(nothing, [0.0; 3], false)];
        };
        let origin = view.world_from_camera().position;
        let mut met: Vec<(f64, Met)> = Vec::new();
        for body in self.bodies.iter().filter(|body| !body.is_own && body.may_be_met(origin, ray)) {
            for face in body.faces.iter().filter(|face| (origin - face.corners[0]).dot(face.normal).abs() > EDGE_ON) {
                let distance = oracle::distance_to_triangle(&face.corners, origin, ray, WIDER);
                met.extend(distance.map(|metres| (metres, Met::Face(body, face))));
            }
        }
        if self.still.scenery().ground().is_some() && origin.z > 0.0 && ray.z < 0.0 {
            met.push((origin.z / -ray.z, Met::Ground));
        }
        met.sort_by(|one, other| one.0.total_cmp(&other.0));
        let reach = met.first().map_or(0.0, |nearest| nearest.0 * (1.0 + slack));
        let near = met.into_iter().take_while(|(metres, _)| *metres <= reach);
        let mut sights: Vec<Sight> = near
            .map(|(metres, met)| match met {
                Met::Ground => self.ground(view, at, metres),
                Met::Face(body, face) => self.face(view, at, body, face, metres),
            })
            .collect();
        if sights.is_empty() {
            sights.push(sight((Shown::Sky, Label::Sky, f64::INFINITY), self.sky(ray), false));
        }
        sights
    }

    /// The colour of a pixel: the mean of `samples` x `samples` pixels of a picture so many times as wide and high; `None` if that
    /// is larger than pictures can be.
    pub fn pixel(&self, view: &View, column: u32, row: u32, samples: u32) -> Option<[f64; 3]> {
        let fine = view.enlarged(samples).ok()?;
        let corner = DVec2::new(f64::from(column), f64::from(row)) * f64::from(samples);
        let places =
            (0..samples * samples).map(|part| DVec2::new(f64::from(part % samples), f64::from(part / samples)));
        let colours = places.map(|place| self.look(&fine, corner + place + 0.5).colour);
        let sum = colours.fold([0.0; 3], |sum, colour| std::array::from_fn(|channel| sum[channel] + colour[channel]));
        Some(sum.map(|channel| channel / f64::from(samples * samples)))
    }

    fn sky(&self, ray: DVec3) -> [f64; 3] {
        let sky = self.still.scenery().sky();
        mixed(sky.horizon.map(f64::from), sky.zenith.map(f64::from), ray.z.max(0.0))
    }

    fn ground(&self, view: &View, at: DVec2, metres: f64) -> Sight {
        let ray_around = rays_around(view, at);
        let point = |at: DVec2| {
            let (origin, ray) = (view.world_from_camera().position, ray_around(at));
            (origin + ray * (origin.z / -ray.z)).truncate()
        };
        let here = point(at);
        let mut colour = [0.0; 3];
        if let Some(ground) = self.still.scenery().ground() {
            colour = ground.colour.map(f64::from);
            if let Some(floor) = &ground.floor
                && here.cmpge(DVec2::ZERO).all()
                && here.cmple(floor.size).all()
            {
                colour = floor.colour.map(f64::from);
                if let Some(texture) = &floor.texture {
                    let texel = self.filtered(texture, at, false, |at| point(at) / floor.size);
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

    fn face(&self, view: &View, at: DVec2, body: &Body, face: &Face, metres: f64) -> Sight {
        let origin = view.world_from_camera().position;
        let ray_around = rays_around(view, at);
        let point = |at: DVec2| {
            let ray = ray_around(at);
            origin + ray * ((face.corners[0] - origin).dot(face.normal) / ray.dot(face.normal))
        };
        let shares = |at: DVec2| face.shares(point(at));
        let tint = face.material.colour.map(|share| 255.0 * f64::from(share).clamp(0.0, 1.0));
        let colour = match (&face.material.texture, face.uv) {
            (Some(texture), Some(uv)) => {
                let place = |at: DVec2| shares(at).into_iter().zip(uv).map(|(share, corner)| corner * share).sum();
                let [red, green, blue, opacity] = self.filtered(texture, at, true, place);
                let tinted = [red * tint[0], green * tint[1], blue * tint[2]].map(|product| product / 255.0);
                mixed(tint, tinted, opacity / 255.0)
            }
            _ => tint,
        };
        let blended = face.normals.map(|normals| {
            let weighted: DVec3 = shares(at).into_iter().zip(normals).map(|(share, normal)| normal * share).sum();
            weighted.normalize_or(face.normal)
        });
        let side = if (origin - face.corners[0]).dot(face.normal) < 0.0 { -1.0 } else { 1.0 };
        let normal = side * blended.unwrap_or(face.normal);
        let is_sunlit = self.is_sunlit(point(at), Some((body.part, face.number)));
        let colour = self.lit(colour, normal, is_sunlit);
        sight((Shown::Face(body.part, face.number), body.label, metres), colour, is_sunlit)
    }

    fn lit(&self, colour: [f64; 3], normal: DVec3, is_sunlit: bool) -> [f64; 3] {
        let light = self.still.scenery().light();
        let opposite = light.towards * DVec3::new(-1.0, -1.0, 1.0);
        let sun = if is_sunlit { light.diffuse * normal.dot(light.towards).max(0.0) } else { 0.0 };
        let share = light.ambient + light.fill * 0.5 * (1.0 + normal.dot(opposite)) + sun;
        colour.map(|channel| (channel * share).min(255.0))
    }

    /// Whether nothing but the surface itself stands between the point and the sun.
    fn is_sunlit(&self, point: DVec3, of: Option<(usize, usize)>) -> bool {
        let light = self.still.scenery().light();
        let is_met = |body: &Body, face: &Face| {
            of != Some((body.part, face.number))
                && oracle::distance_to_triangle(&face.corners, point, light.towards, WIDER)
                    .is_some_and(|metres| metres > NO_SHADOW)
        };
        !light.shadows
            || !self
                .bodies
                .iter()
                .filter(|body| body.may_be_met(point, light.towards))
                .any(|body| body.faces.iter().any(|face| is_met(body, face)))
    }

    /// The image's colour around `at` as its filter says; `place` maps places of the picture to those of the image.
    fn filtered(
        &self,
        texture: &Arc<Texture>,
        at: DVec2,
        is_repeated: bool,
        place: impl Fn(DVec2) -> DVec2,
    ) -> [f64; 4] {
        let levels = &self.images[&Arc::as_ptr(texture)];
        let texels = DVec2::new(levels[0].width as f64, levels[0].height as f64);
        // The footprint's axes, by differences over a thousandth of a pixel.
        let half = 5e-4;
        let axis = |step: DVec2| (place(at + step * half) - place(at - step * half)) / (2.0 * half);
        let mut axes = [axis(DVec2::X), axis(DVec2::Y)];
        axes.sort_by(|one, other| (*other * texels).length().total_cmp(&(*one * texels).length()));
        let [long, short] = axes.map(|axis| (axis * texels).length());
        let lengths = (long / (3.0 * short).max(1.0)).clamp(1.0, PROBES);
        let level = (math::ln(long / lengths) / std::f64::consts::LN_2).clamp(0.0, (levels.len() - 1) as f64);
        let (lower, upper) = (level.floor() as usize, level.ceil() as usize);
        // Share of the longer axis by which probes are off the middle.
        let apart = 0.5 * (1.0 - 1.0 / lengths);
        let mut sum = [0.0; 4];
        for probe in [-apart, apart] {
            let there = place(at) + axes[0] * probe;
            let colour = mixed(
                levels[lower].between_texels(there, is_repeated),
                levels[upper].between_texels(there, is_repeated),
                ((level - level.floor() - 0.5) / 0.25 + 0.5).clamp(0.0, 1.0),
            );
            sum = std::array::from_fn(|channel| sum[channel] + 0.5 * colour[channel]);
        }
        sum
    }
}

/// Faces are taken to be so much wider, m, that none slips through between two that share an edge.
const WIDER: f64 = 1e-9;
/// A camera that is so near to a face's plane, m, sees the face from its edge: not at all.
const EDGE_ON: f64 = 1e-9;
/// So many faces, one after the other in their mesh, are tried where the ray meets the ball around them.
const IN_A_BALL: usize = 12;
/// What is nearer than this to a surface casts no shadow on it, m: faces that share an edge with it.
const NO_SHADOW: f64 = 1e-6;
/// Longest footprint in an image, in probes.
const PROBES: f64 = 2.0;

enum Met<'a, 's> {
    Ground,
    Face(&'a Body<'s>, &'a Face<'s>),
}

fn sight((shown, label, depth): (Shown, Label, f64), colour: [f64; 3], is_sunlit: bool) -> Sight {
    Sight { shown, label, depth, colour, is_sunlit }
}

/// The unit vector seen at a place of the image, in the world's frame; `None` beyond the edge of a lens, if it shall count.
fn ray(view: &View, at: DVec2, has_edge: bool) -> Option<DVec3> {
    let [width, height] = view.size().map(f64::from);
    // To the left and up, in halves of the width.
    let aside = (DVec2::new(0.5 * width, 0.5 * height) - at) / (0.5 * width);
    let off_axis = |angle: f64| {
        let (sin, cos) = math::sin_cos(angle);
        let across = aside.normalize_or_zero() * sin;
        DVec3::new(cos, across.x, across.y)
    };
    let local = match view.lens() {
        Lens::Pinhole { fov } => off_axis(math::atan(aside.length() * math::tan(0.5 * fov))),
        Lens::Fisheye { fov } => {
            let angle = aside.length() * 0.5 * fov;
            if has_edge && angle > std::f64::consts::PI {
                return None;
            }
            off_axis(angle)
        }
    };
    Some(view.world_from_camera().rotation * local)
}

/// Rays through the places around the middle of a pixel: of a fisheye, as they change from one of the pixels beside it to the
/// other, which is how its footprints are defined.
fn rays_around(view: &View, middle: DVec2) -> impl Fn(DVec2) -> DVec3 {
    let ray = move |at| ray(view, at, false).unwrap_or_default();
    let change = move |step: DVec2| 0.5 * (ray(middle + step) - ray(middle - step));
    move |at| match view.lens() {
        Lens::Pinhole { .. } => ray(at),
        Lens::Fisheye { .. } => {
            let away = at - middle;
            ray(middle) + away.x * change(DVec2::X) + away.y * change(DVec2::Y)
        }
    }
}

fn mixed<const N: usize>(one: [f64; N], other: [f64; N], share: f64) -> [f64; N] {
    std::array::from_fn(|channel| (1.0 - share) * one[channel] + share * other[channel])
}

impl<'s> Body<'s> {
    fn new(part: usize, label: Label, faces: Vec<Face<'s>>) -> Self {
        let corners = || faces.iter().flat_map(|face| face.corners);
        let low = corners().fold(DVec3::INFINITY, DVec3::min);
        let centre = 0.5 * (low + corners().fold(DVec3::NEG_INFINITY, DVec3::max));
        let radius = corners().map(|corner| (corner - centre).length()).fold(0.0, f64::max);
        Self { part, label, centre, radius: 1.001 * radius + 1e-6, faces, is_own: false }
    }

    /// Whether the ray meets the ball around the body.
    fn may_be_met(&self, origin: DVec3, direction: DVec3) -> bool {
        let way = self.centre - origin;
        let along = way.dot(direction);
        let nearest = if along > 0.0 { way - along * direction } else { way };
        nearest.length() <= self.radius
    }
}

impl Face<'_> {
    /// Shares of the corners in a point of the face's plane: the triangles opposite to them, by their areas.
    fn shares(&self, point: DVec3) -> [f64; 3] {
        let [a, b, c] = self.corners.map(|corner| corner - point);
        let areas = [b.cross(c), c.cross(a), a.cross(b)].map(|area| area.dot(self.normal));
        let whole: f64 = areas.iter().sum();
        areas.map(|area| area / whole)
    }
}

impl Image {
    /// A texture, and then each image half as wide and high as the one before, down to a single texel.
    fn all(texture: &Texture) -> Vec<Self> {
        let (width, height) = texture.size();
        let texels = (0..width * height).map(|place| texture.pixel(place % width, place / width).map(f64::from));
        let mut all = vec![Self { width: width as usize, height: height as usize, texels: texels.collect() }];
        while let Some(last) = all.last().filter(|last| last.texels.len() > 1) {
            let half = last.half();
            all.push(half);
        }
        all
    }

    /// Means of two by two texels, rounded; of an odd number the last ones are left out, a single one is taken twice.
    fn half(&self) -> Self {
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let texels = (0..width * height).map(|place| {
            let (column, row) = (2 * (place % width), 2 * (place / width));
            let corners = [(0, 0), (1, 0), (0, 1), (1, 1)]
                .map(|(x, y)| self.texel((column + x).min(self.width - 1), (row + y).min(self.height - 1)));
            std::array::from_fn(|channel| (corners.iter().map(|texel| texel[channel]).sum::<f64>() / 4.0 + 0.5).floor())
        });
        Self { width, height, texels: texels.collect() }
    }

    fn texel(&self, column: usize, row: usize) -> [f64; 4] {
        self.texels[row * self.width + column]
    }

    /// The colour at u to the right and v upwards, 1 being the whole image: a blend of the four texels whose middles are
    /// around it.
    fn between_texels(&self, place: DVec2, is_repeated: bool) -> [f64; 4] {
        let place = if is_repeated { place } else { place.clamp(DVec2::ZERO, DVec2::ONE) };
        let (x, y) = (place.x * self.width as f64 - 0.5, (1.0 - place.y) * self.height as f64 - 0.5);
        let texel = |x: f64, y: f64| {
            let within = |part: f64, size: usize| {
                let (part, size) = (part as i64, size as i64);
                (if is_repeated { part.rem_euclid(size) } else { part.clamp(0, size - 1) }) as usize
            };
            self.texel(within(x, self.width), within(y, self.height))
        };
        let row = |y: f64| mixed(texel(x.floor(), y), texel(x.floor() + 1.0, y), x - x.floor());
        mixed(row(y.floor()), row(y.floor() + 1.0), y - y.floor())
    }
}
