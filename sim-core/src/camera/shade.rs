//! The colour of what a pixel shows.

use glam::{DVec2, DVec3};

use super::face::Face;
use super::scenery::Look;
use super::{Scenery, Still, View};

/// Colours of a still in a view, 0 to 255 for each channel.
pub struct Shading<'a> {
    still: &'a Still<'a>,
    scenery: &'a Scenery,
    view: &'a View,
}

impl<'a> Shading<'a> {
    pub fn new(still: &'a Still<'a>, view: &'a View) -> Self {
        Self { still, scenery: still.scenery(), view }
    }

    /// Of the sky along `ray`.
    pub fn sky(&self, ray: DVec3) -> [f32; 3] {
        let up = (self.view.world_from_camera().rotation * ray.normalize_or_zero()).z.max(0.0) as f32;
        let sky = self.scenery.sky();
        std::array::from_fn(|channel| {
            let [horizon, zenith] = [sky.horizon, sky.zenith].map(|colour| f32::from(colour[channel]));
            horizon + up * (zenith - horizon)
        })
    }

    /// Of the ground along `ray`, at the place `at` of the image.
    pub fn ground(&self, at: DVec2, ray: DVec3) -> [f32; 3] {
        let Some(ground) = self.scenery.ground() else { return [0.0; 3] };
        let camera = self.view.world_from_camera();
        let way = camera.rotation * ray;
        let scale = camera.position.z / -way.z;
        let point = camera.position.truncate() + scale * way.truncate();
        let change = |step: DVec3| {
            let step = camera.rotation * step;
            scale * (step.truncate() - way.truncate() * (step.z / way.z))
        };
        let mut colour = ground.colour.map(f32::from);
        if let Some(floor) = &ground.floor
            && point.cmpge(DVec2::ZERO).all()
            && point.cmple(floor.size).all()
        {
            colour = floor.colour.map(f32::from);
            if let Some(image) = self.scenery.floor() {
                let [across, down] = self.steps(at).map(|step| change(step) / floor.size);
                colour = over(image.filtered(point / floor.size, across, down), colour);
            }
        }
        for spot in &ground.spots {
            if point.distance_squared(spot.centre) <= spot.radius * spot.radius {
                colour = over(spot.colour.map(f32::from), colour);
            }
        }
        lit(colour, self.light(DVec3::Z))
    }

    /// Of a face along `ray`, at the place `at` of the image.
    pub fn face(&self, face: &Face, at: DVec2, ray: DVec3) -> [f32; 3] {
        let part = &self.scenery.parts()[face.part as usize];
        let triangle = &part.mesh.triangles[face.triangle as usize];
        let shares = face.shares(ray, self.steps(at));
        let look = self.scenery.look(face.part as usize, triangle.material);
        let colour = match (&look.texture, triangle.uv) {
            (Some(image), Some(uv)) => {
                let uv = uv.map(|corner| corner.as_dvec2());
                let [across, down] = shares.changes(uv);
                tinted(look, image.filtered(shares.point(uv), across, down))
            }
            _ => look.colour,
        };
        let [a, b, c] = part.mesh.corners(triangle);
        let flat = (b - a).cross(c - a).normalize_or_zero();
        let normal = triangle.normals.map_or(flat, |normals| {
            let blended: DVec3 = normals.iter().zip(shares.here).map(|(normal, share)| normal.as_dvec3() * share).sum();
            blended.normalize_or(flat)
        });
        let normal = self.still.poses()[face.part as usize].rotation * normal;
        lit(colour, self.light(if face.is_outside { normal } else { -normal }))
    }

    /// How the ray changes from the pixel around `at` to the next column and the next row: its difference between two opposite
    /// borders of the pixel.
    fn steps(&self, at: DVec2) -> [DVec3; 2] {
        [DVec2::X, DVec2::Y].map(|step| {
            let [before, behind] = [-0.5, 0.5].map(|half| self.view.ray(at + half * step).unwrap_or_default());
            behind - before
        })
    }

    /// Share of light on a surface with this normal on the side that is seen.
    fn light(&self, normal: DVec3) -> f32 {
        let light = self.scenery.light();
        let fill_from = DVec3::new(-light.towards.x, -light.towards.y, light.towards.z);
        let fill = 0.5 * (1.0 + normal.dot(fill_from));
        let sun = normal.dot(light.towards).max(0.0);
        (light.ambient + light.fill * fill + light.diffuse * sun) as f32
    }
}

fn lit(colour: [f32; 3], light: f32) -> [f32; 3] {
    colour.map(|channel| (channel * light).min(255.0))
}

/// A colour with an opacity over another.
fn over([red, green, blue, opacity]: [f32; 4], under: [f32; 3]) -> [f32; 3] {
    let upper = [red, green, blue];
    std::array::from_fn(|channel| under[channel] + opacity / 255.0 * (upper[channel] - under[channel]))
}

/// A texture's colour in that of its material.
fn tinted(look: &Look, [red, green, blue, opacity]: [f32; 4]) -> [f32; 3] {
    let [r, g, b] = look.colour.map(|channel| channel / 255.0);
    over([red * r, green * g, blue * b, opacity], look.colour)
}
