//! Triangle meshes with materials: the appearance of bodies. [`MeshIndex`](super::MeshIndex) finds the triangles that
//! rays hit.

use glam::{DVec3, Vec2, Vec3};

use super::Material;

/// A surface of triangles in the frame of its body: x forward, y left, z up, in metres.
///
/// Invariant: all numbers are finite, all indices are valid, and every triangle has an area.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Corners, shared by the triangles that meet in them, in metres.
    pub positions: Vec<DVec3>,
    /// The faces.
    pub triangles: Vec<Triangle>,
    /// Materials of the faces; never empty if there are triangles.
    pub materials: Vec<Material>,
}

/// A face of a [`Mesh`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// Indices of its corners in [`Mesh::positions`], counter-clockwise as seen from outside.
    pub corners: [u32; 3],
    /// Unit normals at the corners for smooth shading, in single precision; `None` for a flat face.
    pub normals: Option<[Vec3; 3]>,
    /// Texture coordinates of the corners: see [`Texture::sample`](super::Texture::sample).
    pub uv: Option<[Vec2; 3]>,
    /// Index of its material in [`Mesh::materials`].
    pub material: u32,
}

impl Mesh {
    /// The corners of a face, in metres.
    ///
    /// # Panics
    /// If the face does not belong to this mesh.
    pub fn corners(&self, triangle: &Triangle) -> [DVec3; 3] {
        triangle.corners.map(|corner| self.positions[corner as usize])
    }

    /// The material of a face.
    ///
    /// # Panics
    /// If the face does not belong to this mesh.
    pub fn material(&self, triangle: &Triangle) -> &Material {
        &self.materials[triangle.material as usize]
    }

    /// Lowest and highest corner of the box around all faces; `None` without faces.
    pub fn bounds(&self) -> Option<(DVec3, DVec3)> {
        let corners = self.triangles.iter().flat_map(|triangle| self.corners(triangle));
        corners.fold(None, |bounds, corner| {
            let (low, high) = bounds.unwrap_or((corner, corner));
            Some((low.min(corner), high.max(corner)))
        })
    }
}
