//! Appearance of a face or the ground, common to all its pixels: linear forms on rays, and fractions of light.

use glam::{DMat3, DVec2, DVec3};

use super::face::Face;
use super::scenery::PreparedMaterial;
use super::shadow::{Axes, ShadowGrid};
use super::texture::MipMap;
use super::{Ground, Light, PosedScenery, Scenery, View};

/// A value that varies over a surface. Its value at a ray is base + form . ray / plane . ray, with the surface's plane.
#[derive(Clone, Copy, Debug)]
pub struct Attribute {
    pub base: f64,
    pub form: DVec3,
}

/// Properties of a surface, common to all pixels that show it.
pub struct ShadedSurface<'a> {
    /// Plane of the surface: its dot product with a ray is the reciprocal of the ray's parameter at the surface.
    pub plane: DVec3,
    /// Red, green, blue, 0 to 255, without an image.
    pub colour: [f32; 3],
    /// Factors that multiply the image's red, green and blue.
    pub tint: [f32; 3],
    pub image: Option<Image<'a>>,
    pub light: Lighting,
    /// Numbers of part and triangle; for the ground, numbers that no face has.
    pub face_id: (u32, u32),
    /// `None` for a face.
    pub painted: Option<PaintedGround<'a>>,
}

/// An image on a surface.
pub struct Image<'a> {
    pub mip_map: &'a MipMap,
    /// Image coordinates to the right and downwards from the upper left corner; 1 is the full width or height.
    pub coordinates: [Attribute; 2],
}

/// Light on a surface: indirect light and sunlight.
pub enum Lighting {
    Flat(LightFractions),
    /// Varies with the normal. The forms give the components of the normal (world frame, on the visible side, not
    /// normalised). The fractions are those of the flat face, for points where the normal vanishes.
    Smooth([DVec3; 3], LightFractions),
}

/// Fractions of the full light on a surface: indirect light, and sunlight where the sun reaches the surface.
#[derive(Clone, Copy, Debug)]
pub struct LightFractions {
    pub indirect: f32,
    pub sun: f32,
}

/// The ground with everything painted on it.
pub struct PaintedGround<'a> {
    pub ground: &'a Ground,
    /// World coordinates x and y.
    pub position: [Attribute; 2],
}

/// Shadow test: finds the points that the sun reaches.
pub struct Sun<'a> {
    /// Shadow casters that never move, and moving shadow casters.
    pub grids: [&'a ShadowGrid; 2],
    /// Coordinates of a surface in the grids' frame: two perpendicular to the sun's direction, the third towards the
    /// sun.
    coordinates: [Attribute; 3],
}

impl Sun<'_> {
    /// The pixels of the bit mask `pixels` that the sun reaches. The pixels show the face `shown_face`, in the plane
    /// `plane`; `ray_of` gives their rays in lens space.
    pub fn lit_pixels(
        &self,
        plane: DVec3,
        shown_face: (u32, u32),
        pixels: u64,
        ray_of: &dyn Fn(usize) -> DVec3,
    ) -> u64 {
        let mut lit = pixels;
        let mut last_casters = [usize::MAX; 2];
        let mut pending = pixels;
        while pending != 0 {
            let pixel = pending.trailing_zeros() as usize;
            pending &= pending - 1;
            let ray = ray_of(pixel);
            let scale = 1.0 / plane.dot(ray);
            let [x, y, z] = &self.coordinates;
            let point = DVec3::new(
                x.base + x.form.dot(ray) * scale,
                y.base + y.form.dot(ray) * scale,
                z.base + z.form.dot(ray) * scale,
            );
            let [fixed, moving] = &mut last_casters;
            if self.grids[0].is_shaded(point, shown_face, fixed) || self.grids[1].is_shaded(point, shown_face, moving) {
                lit &= !(1 << pixel);
            }
        }
        lit
    }
}

/// Data common to all surfaces in a picture.
pub struct SurfaceContext<'a> {
    pub posed: &'a PosedScenery<'a>,
    pub scenery: &'a Scenery,
    /// Position of the camera.
    pub eye: DVec3,
    pub world_from_lens: DMat3,
    /// The ground's plane in lens space; 0 without ground, and for a camera that is not above it.
    pub ground: DVec3,
    /// `None` if shadows are off.
    pub sun: Option<Sun<'a>>,
}

impl<'a> SurfaceContext<'a> {
    /// The context of a view. `moving` contains the moving shadow casters; `None` turns shadows off.
    pub fn new(
        posed: &'a PosedScenery<'a>,
        view: &View,
        camera_from_lens: DMat3,
        moving: Option<&'a ShadowGrid>,
    ) -> Self {
        let scenery = posed.scenery();
        let camera = view.world_from_camera();
        let world_from_lens = camera.rotation * camera_from_lens;
        let height = camera.position.z;
        let is_above = scenery.ground().is_some() && height > 0.0;
        let ground = if is_above { -world_from_lens.row(2) / height } else { DVec3::ZERO };
        let ground = if ground.abs().max_element() <= 1e30 { ground } else { DVec3::ZERO };
        let eye = camera.position;
        let sun = moving.map(|moving| {
            let axes = Axes::new(scenery.light().sun_direction).directions();
            let coordinates =
                axes.map(|axis| Attribute { base: axis.dot(eye), form: world_from_lens.transpose() * axis });
            Sun { grids: [scenery.fixed_shadows(), moving], coordinates }
        });
        Self { posed, scenery, eye, world_from_lens, ground, sun }
    }

    /// The surface of a face.
    pub fn face(&self, face: &Face) -> ShadedSurface<'a> {
        let part = &self.scenery.parts()[face.part as usize];
        let triangle = &part.mesh.triangles[face.triangle as usize];
        let material: &'a PreparedMaterial = self.scenery.prepared_material(face.part as usize, triangle.material);
        let rotation = self.posed.poses()[face.part as usize].unwrap_or_default().rotation;
        let side = if face.is_outside { 1.0 } else { -1.0 };
        let face_normal =
            rotation * self.scenery.render_mesh(face.part as usize).normals[face.triangle as usize] * side;
        let flat_light = light_fractions(self.scenery.light(), face_normal);
        let light = triangle.normals.map_or(Lighting::Flat(flat_light), |normals| {
            let [a, b, c] = normals.map(|normal| rotation * normal.as_dvec3() * (side * face.inverse_det));
            let [x, y, z] = face.edges;
            let form = |axis: usize| x * a[axis] + y * b[axis] + z * c[axis];
            Lighting::Smooth([form(0), form(1), form(2)], flat_light)
        });
        let image = material.texture.as_deref().zip(triangle.uv).map(|(mip_map, uv)| {
            let [a, b, c] = uv.map(|uv| uv.as_dvec2());
            let u = Attribute { base: a.x, form: face.form([a.x, b.x, c.x]) };
            let v = Attribute { base: 1.0 - a.y, form: -face.form([a.y, b.y, c.y]) };
            Image { mip_map, coordinates: [u, v] }
        });
        let tint = material.colour.map(|channel| channel / 255.0);
        ShadedSurface {
            plane: face.plane,
            colour: material.colour,
            tint,
            image,
            light,
            face_id: (face.part, face.triangle),
            painted: None,
        }
    }

    /// The surface of the ground.
    pub fn ground(&self, ground: &'a Ground) -> ShadedSurface<'a> {
        let size = ground.floor.as_ref().map_or(DVec2::ONE, |floor| floor.size);
        let [x, y] = [0, 1].map(|axis| Attribute { base: self.eye[axis], form: self.world_from_lens.row(axis) });
        let image = self.scenery.floor().map(|mip_map| {
            let u = Attribute { base: x.base / size.x, form: x.form / size.x };
            let v = Attribute { base: 1.0 - y.base / size.y, form: -y.form / size.y };
            Image { mip_map, coordinates: [u, v] }
        });
        ShadedSurface {
            plane: self.ground,
            colour: ground.floor.as_ref().map_or(ground.colour, |floor| floor.colour).map(f32::from),
            tint: [1.0; 3],
            image,
            light: Lighting::Flat(light_fractions(self.scenery.light(), DVec3::Z)),
            face_id: (u32::MAX, u32::MAX),
            painted: Some(PaintedGround { ground, position: [x, y] }),
        }
    }
}

/// Unit vector towards the fill light, which comes from the side opposite to the sun.
pub fn fill_direction(light: &Light) -> DVec3 {
    DVec3::new(-light.sun_direction.x, -light.sun_direction.y, light.sun_direction.z)
}

/// Fractions of light on a surface with this normal on its visible side.
fn light_fractions(light: &Light, normal: DVec3) -> LightFractions {
    let fill = 0.5 * (1.0 + normal.dot(fill_direction(light)));
    let sun = normal.dot(light.sun_direction).max(0.0);
    LightFractions { indirect: (light.ambient + light.fill * fill) as f32, sun: (light.diffuse * sun) as f32 }
}
