//! Meshes and textures in the page's protocol.

use std::collections::BTreeMap;
use std::sync::Arc;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use glam::{Vec2, Vec3};
use sim_core::scene::{Material, Mesh, Texture, Triangle};
use sim_host::record::png;
use sim_view::protocol;

use super::png_url;

/// Collects meshes and textures without duplicates.
#[derive(Default)]
pub struct Surfaces {
    /// Meshes in the order of their first use.
    pub meshes: Vec<protocol::Mesh>,
    /// Images in the order of their first use.
    pub images: Vec<protocol::Image>,
    mesh_indices: BTreeMap<*const Mesh, u32>,
    image_indices: BTreeMap<*const Texture, u32>,
}

/// Minimum opacity of a visible material, as for the simulated cameras.
const MIN_OPACITY: f32 = 0.5;

impl Surfaces {
    /// Returns the index of `mesh` in [`Self::meshes`], and adds it on its first use.
    pub fn mesh(&mut self, mesh: &Arc<Mesh>) -> u32 {
        if let Some(index) = self.mesh_indices.get(&Arc::as_ptr(mesh)) {
            return *index;
        }
        let converted = self.convert(mesh);
        self.meshes.push(converted);
        let index = self.meshes.len() as u32 - 1;
        self.mesh_indices.insert(Arc::as_ptr(mesh), index);
        index
    }

    /// Returns the index of `texture` in [`Self::images`], and adds it on its first use.
    pub fn image(&mut self, texture: &Arc<Texture>) -> u32 {
        let images = &mut self.images;
        *self.image_indices.entry(Arc::as_ptr(texture)).or_insert_with(|| {
            images.push(protocol::Image { url: png_url(&png_of(texture)) });
            images.len() as u32 - 1
        })
    }

    /// Converts a mesh: triangles sorted by material, without materials less opaque than [`MIN_OPACITY`].
    fn convert(&mut self, mesh: &Mesh) -> protocol::Mesh {
        let is_smooth = mesh.triangles.iter().any(|triangle| triangle.normals.is_some());
        let has_image = mesh.materials.iter().any(|material| material.texture.is_some());
        let mut triangles_by_material: Vec<Vec<&Triangle>> = vec![Vec::new(); mesh.materials.len()];
        mesh.triangles.iter().for_each(|triangle| triangles_by_material[triangle.material as usize].push(triangle));
        let (mut positions, mut normals, mut uvs) = (Floats::default(), Floats::default(), Floats::default());
        let mut materials = Vec::new();
        for (material, triangles) in mesh.materials.iter().zip(triangles_by_material) {
            if triangles.is_empty() || material.opacity < MIN_OPACITY {
                continue;
            }
            for triangle in &triangles {
                let corners = mesh.corners(triangle);
                corners.iter().for_each(|corner| positions.push(&corner.as_vec3().to_array()));
                if is_smooth {
                    let face_normal =
                        (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or_zero().as_vec3();
                    let corner_normals: [Vec3; 3] = triangle.normals.unwrap_or([face_normal; 3]);
                    corner_normals.iter().for_each(|normal| normals.push(&normal.to_array()));
                }
                if has_image {
                    let corner_uvs = triangle.uv.unwrap_or([Vec2::ZERO; 3]);
                    corner_uvs.iter().for_each(|uv| uvs.push(&uv.to_array()));
                }
            }
            materials.push(self.material(material, triangles.len()));
        }
        protocol::Mesh {
            positions: positions.base64(),
            normals: is_smooth.then(|| normals.base64()),
            uvs: has_image.then(|| uvs.base64()),
            materials,
        }
    }

    fn material(&mut self, material: &Material, triangles: usize) -> protocol::Material {
        protocol::Material {
            triangles: triangles as u32,
            // A conversion to an integer saturates.
            colour: material.colour.map(|channel| (255.0 * channel).round() as u8),
            image: material.texture.as_ref().map(|texture| self.image(texture)),
        }
    }
}

/// Little-endian `f32` numbers to be sent as base64.
#[derive(Default)]
struct Floats(Vec<u8>);

impl Floats {
    fn push(&mut self, numbers: &[f32]) {
        numbers.iter().for_each(|number| self.0.extend_from_slice(&number.to_le_bytes()));
    }

    fn base64(&self) -> String {
        BASE64_STANDARD.encode(&self.0)
    }
}

fn png_of(texture: &Texture) -> Vec<u8> {
    let (width, height) = texture.size();
    let pixels = (0..height).flat_map(|row| (0..width).map(move |column| texture.pixel(column, row)));
    let bytes: Vec<u8> = pixels.flatten().collect();
    png::colour_and_opacity([width, height], &bytes)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn floats(text: &str) -> Vec<f32> {
        let bytes = BASE64_STANDARD.decode(text).expect("base64");
        bytes.chunks(4).map(|four| f32::from_le_bytes(four.try_into().expect("four bytes"))).collect()
    }

    #[test]
    fn triangles_are_sorted_by_material() {
        let red = Material { colour: [1.0, 0.0, 0.0], ..Material::default() };
        let glass = Material { opacity: 0.2, ..Material::default() };
        let triangle = |corners, material| Triangle { corners, normals: None, uv: None, material };
        let mesh = Arc::new(Mesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            triangles: vec![triangle([0, 1, 2], 1), triangle([1, 2, 3], 2), triangle([0, 1, 3], 0)],
            materials: vec![red, Material::default(), glass],
        });
        let mut surfaces = Surfaces::default();
        assert_eq!([surfaces.mesh(&mesh), surfaces.mesh(&Arc::clone(&mesh))], [0, 0]);
        let converted = &surfaces.meshes[0];
        let colours: Vec<_> =
            converted.materials.iter().map(|material| (material.triangles, material.colour)).collect();
        assert_eq!(colours, [(1, [255, 0, 0]), (1, [204; 3])], "materials that are nearly transparent are omitted");
        let corners = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        assert_eq!(floats(&converted.positions), corners);
        assert!(converted.normals.is_none() && converted.uvs.is_none());
    }

    #[test]
    fn smooth_and_flat_faces_share_a_surface() {
        let normals = [Vec3::X; 3];
        let image = Arc::new(Texture::new(1, 1, vec![[1, 2, 3, 255]]).expect("a pixel"));
        let material = Material { texture: Some(image), ..Material::default() };
        let smooth = Triangle { corners: [0, 1, 2], normals: Some(normals), uv: Some([Vec2::ONE; 3]), material: 0 };
        let flat_triangle = Triangle { normals: None, uv: None, ..smooth };
        let mesh = Mesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y],
            triangles: vec![smooth, flat_triangle],
            materials: vec![material.clone(), material],
        };
        let mut surfaces = Surfaces::default();
        surfaces.mesh(&Arc::new(mesh));
        let converted = &surfaces.meshes[0];
        let normals = floats(converted.normals.as_deref().expect("normals"));
        assert_eq!((&normals[..3], &normals[9..12]), (&[1.0, 0.0, 0.0][..], &[0.0, 0.0, 1.0][..]));
        assert_eq!(
            floats(converted.uvs.as_deref().expect("texture coordinates"))[..7],
            [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 0.0]
        );
        assert_eq!((converted.materials[0].image, surfaces.images.len()), (Some(0), 1));
    }
}
