//! Surfaces of triangles, for looks: cameras and pictures see them, contacts and distance sensors do not.

use glam::{DVec3, Vec2, Vec3};

use super::Material;

/// A surface of triangles in the frame of the body that it shows: x forward, y left, z up, in metres.
///
/// All numbers are finite, all indices within their lists, and no triangle is without area.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Corners, each once for all triangles that meet in it, in metres.
    pub positions: Vec<DVec3>,
    /// The faces.
    pub triangles: Vec<Triangle>,
    /// The looks that faces name; never empty where there are triangles.
    pub materials: Vec<Material>,
}

/// A face of a [`Mesh`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Places of its corners in [`Mesh::positions`], counter-clockwise as seen from outside.
    pub corners: [u32; 3],
    /// Directions of the light's reflection at the corners, of length 1; `None` for a flat face. For shading only, and so
    /// in single precision.
    pub normals: Option<[Vec3; 3]>,
    /// Place of the corners in the texture, as in [`Texture::at`](super::Texture::at).
    pub uv: Option<[Vec2; 3]>,
    /// Its looks: place in [`Mesh::materials`].
    pub material: u32,
}

impl Mesh {
    /// The corners of a face, in metres.
    ///
    /// # Panics
    /// If it is no face of this mesh.
    pub fn corners(&self, triangle: &Triangle) -> [DVec3; 3] {
        triangle.corners.map(|corner| self.positions[corner as usize])
    }

    /// The looks of a face.
    ///
    /// # Panics
    /// If it is no face of this mesh.
    pub fn material(&self, triangle: &Triangle) -> &Material {
        &self.materials[triangle.material as usize]
    }

    /// Lowest and highest corner of the box around all faces; `None` without any.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let corners = self.triangles.iter().flat_map(|triangle| self.corners(triangle));
        corners.fold(None, |bounds, corner| {
            let (low, high) = bounds.unwrap_or((corner, corner));
            Some((low.min(corner), high.max(corner)))
        })
    }
}
