//! Appearance of bodies: meshes with their materials and images.
//!
//! A missing or broken file causes a warning, and the body is shown in its own shape. Only a missing mesh that range
//! sensors detect is an error, and prevents the run ([`super::load`]). `check`, pictures and cameras read meshes
//! through [`MeshReader`]; a run without a camera reads only the meshes that range sensors detect.
//!
//! # Frames
//! Coordinates in an OBJ file are right-handed: x left, y up, z forward. EyeSim VR inverts x on reading, which gives
//! the left-handed frame of its graphics library (X right, Y up, Z forward). Offset and rotations of a `model` line are
//! in that left-handed frame. The rotations are about Z, then X, then Y, each clockwise as seen from the tip of the
//! axis. Our body frames have x forward, y left and z up. If the line has no rotation, a mesh's point (x, y, z) is
//! therefore at (z, x, y) in the body frame.

mod bmp;
mod mistakes;
mod mtl;
mod obj;
mod terrain;
mod texture;

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DMat3, DVec3};

use self::mtl::MtlMaterial;
use self::obj::Obj;
use super::diagnostic::{Diagnostic, Severity, Sink};
use super::load::Loader;
use super::spec::{ModelSpec, ObjectType, RobiSpec, SensorShape, SpannedText, WorldSpec};
use super::{Code, Files, InputFile, Span, path};
use sim_core::build::MeshSource;
use sim_core::scene::{Material, Mesh, Texture};

/// Text of messages: the fallback for a missing mesh.
const FALLBACK: &str = "the body's own shape is shown instead";

/// Text of messages: the consequence of a missing mesh that range sensors need.
const NEEDED_BY_SENSORS: &str = "range sensors need it";

/// Metres per unit of a robot's mesh, for which robis state no scale.
const ROBOT_SCALE: f64 = 1.0;

/// A grey image, decoded from a png, jpg or bmp image.
pub(crate) struct GreyImage {
    /// Columns and rows.
    pub(crate) size: [usize; 2],
    /// Brightness of each pixel, row by row from the top.
    pub(crate) levels: Vec<u32>,
    /// Brightness of white pixels.
    pub(crate) white: u32,
    /// Value of white in one channel.
    pub(crate) max_grey: u32,
    /// For each pixel, true if it is not opaque; empty if all are opaque.
    pub(crate) is_transparent: Vec<bool>,
}

/// Decodes a png, jpg or bmp image as a grey image: the sum of its channels, including opacity if `with_opacity`.
///
/// # Errors
/// The reason, worded for the user.
pub(crate) fn read_grey(bytes: &[u8], with_opacity: bool) -> Result<GreyImage, String> {
    let pixels = texture::decode(bytes).map_err(|error| format!("the image cannot be read: {error}"))?;
    let (levels, white, max_grey, is_transparent) = pixels.sums(with_opacity);
    Ok(GreyImage { size: pixels.size.map(|side| side as usize), levels, white, max_grey, is_transparent })
}

/// Reads meshes and images, each file once for all bodies that use it.
pub struct MeshReader<'a> {
    loader: Loader<'a>,
    /// Meshes by the file that refers to them and the text of the reference.
    meshes: BTreeMap<(String, String), Option<Arc<Mesh>>>,
    /// Textures by the path of their image.
    textures: BTreeMap<String, Option<Arc<Texture>>>,
}

impl<'a> MeshReader<'a> {
    /// Creates a reader on the file system `files`.
    pub fn new(files: &'a dyn Files) -> Self {
        Self { loader: Loader::new(files), meshes: BTreeMap::new(), textures: BTreeMap::new() }
    }

    /// Mistakes in the files that were read, and these files.
    pub fn finish(self) -> (Vec<Diagnostic>, Vec<InputFile>) {
        // Bodies with different frames read the same mesh separately.
        let mut diagnostics: Vec<Diagnostic> = Vec::new();
        for diagnostic in self.loader.diagnostics {
            if !diagnostics.contains(&diagnostic) {
                diagnostics.push(diagnostic);
            }
        }
        (diagnostics, self.loader.inputs)
    }

    /// Reads a mesh; `consequence` is the text of messages about a missing one.
    fn mesh(&mut self, file: &str, model: &ModelSpec, scale: f64, consequence: &str) -> Option<Arc<Mesh>> {
        let key = (file.to_owned(), model.path.text.clone());
        if let Some(cached) = self.meshes.get(&key) {
            return cached.clone();
        }
        let mesh = self.read_mesh(file, model, scale, consequence).map(Arc::new);
        self.meshes.insert(key, mesh.clone());
        mesh
    }

    fn read_mesh(&mut self, file: &str, model: &ModelSpec, scale: f64, consequence: &str) -> Option<Mesh> {
        let extension = path::extension(&model.path.text);
        if extension != "obj" {
            let kind = match extension.as_str() {
                "ms3d" => "MilkShape meshes are",
                "iv" => "Open Inventor meshes are",
                _ => "meshes of this kind are",
            };
            let message = format!("`{}`: {kind} not read; {consequence}", model.path.text);
            self.warn(file, Code::MeshFormat, model.path.span, message, "an .obj file");
            return None;
        }
        let (path, bytes) = self.find(file, &model.path, consequence)?;
        let text = self.loader.decode_input(&path, bytes);
        let placement = Placement::new(model, scale);
        let (obj, mistakes) =
            obj::read_obj(&path, &text, |point| placement.point(point), |direction| placement.rotation * direction);
        self.loader.diagnostics.extend(mistakes);
        let whole_file = Span::default();
        if obj.is_too_large {
            let message = format!("the mesh has more than two million corners or triangles; {consequence}");
            self.warn(&path, Code::MeshSize, whole_file, message, "a mesh of fewer triangles");
            return None;
        }
        if obj.triangles.is_empty() {
            let message = format!("the mesh has no triangle; {consequence}");
            self.warn(&path, Code::MeshEmpty, whole_file, message, "lines `v X Y Z` and `f A B C`");
            return None;
        }
        let materials = self.read_materials(&path, &obj);
        Some(Mesh { positions: obj.positions, triangles: obj.triangles, materials })
    }

    /// Materials of the faces, in the order of their numbers.
    fn read_materials(&mut self, file: &str, obj: &Obj) -> Vec<Material> {
        let mut entries: BTreeMap<String, MtlMaterial> = BTreeMap::new();
        // Material file of each entry. The reference to the entry's image is relative to this file.
        let mut material_files: BTreeMap<String, String> = BTreeMap::new();
        let mut is_complete = true;
        for library in &obj.libraries {
            let Some((path, bytes)) = self.find(file, library, "grey is shown instead of its materials") else {
                is_complete = false;
                continue;
            };
            let text = self.loader.decode_input(&path, bytes);
            let (new_entries, mistakes) = mtl::read_mtl(&path, &text);
            self.loader.diagnostics.extend(mistakes);
            for (name, entry) in new_entries {
                material_files.entry(name.clone()).or_insert_with(|| path.clone());
                entries.entry(name).or_insert(entry);
            }
        }
        let mut materials = Vec::with_capacity(obj.materials.len());
        for (name, span) in &obj.materials {
            let Some(entry) = entries.get(name) else {
                // A missing file is already reported.
                if is_complete && !name.is_empty() {
                    let message = format!("there is no material `{name}`; grey is shown instead");
                    self.warn(file, Code::MeshMaterial, *span, message, "a material of the files that `mtllib` names");
                }
                materials.push(Material { name: name.clone(), ..Material::default() });
                continue;
            };
            let texture = entry.image.as_ref().and_then(|image| {
                let file = material_files.get(name)?.clone();
                self.find_texture(&file, image, "the material's colour is shown instead")
            });
            materials.push(Material { texture, ..entry.material.clone() });
        }
        materials
    }

    fn find_texture(&mut self, file: &str, reference: &SpannedText, instead: &str) -> Option<Arc<Texture>> {
        let (path, bytes) = self.find(file, reference, instead)?;
        if let Some(cached) = self.textures.get(&path) {
            return cached.clone();
        }
        let texture = match texture::read_texture(&bytes) {
            Ok(texture) => Some(Arc::new(texture)),
            Err(error) => {
                let message = format!("`{path}` cannot be shown: {error}; {instead}");
                let (code, expected) = match error {
                    texture::TextureError::Format(_) => (Code::TextureFormat, "a png, jpg or bmp image"),
                    texture::TextureError::Size(..) => (Code::TextureSize, "an image of at most 4096 x 4096 pixels"),
                };
                self.warn(file, code, reference.span, message, expected);
                None
            }
        };
        self.loader.inputs.push(InputFile { path: path.clone(), bytes });
        self.textures.insert(path, texture.clone());
        texture
    }

    /// Finds the file that `reference` in `file` refers to; all diagnostics become warnings.
    fn find(&mut self, file: &str, reference: &SpannedText, instead: &str) -> Option<(String, Vec<u8>)> {
        let count_before = self.loader.diagnostics.len();
        let found = self.loader.find(file, path::folder_of(file), reference);
        for diagnostic in &mut self.loader.diagnostics[count_before..] {
            if diagnostic.severity == Severity::Error {
                diagnostic.severity = Severity::Warning;
                diagnostic.message += &format!("; {instead}");
            }
        }
        found
    }

    fn warn(&mut self, file: &str, code: Code, span: Span, message: String, expected: &str) {
        let mut sink = Sink::new(file);
        sink.warn(code, span, message, expected);
        self.loader.diagnostics.extend(sink.finish());
    }
}

impl MeshSource for MeshReader<'_> {
    fn robot(&mut self, robi: &RobiSpec) -> Option<Arc<Mesh>> {
        self.mesh(&robi.file, robi.model.as_ref()?, ROBOT_SCALE, FALLBACK)
    }

    fn object(&mut self, kind: &ObjectType) -> Option<Arc<Mesh>> {
        let consequence = if kind.sensor_shape == SensorShape::Colliders { FALLBACK } else { NEEDED_BY_SENSORS };
        self.mesh(&kind.file, kind.model.as_ref()?, kind.scale, consequence)
    }

    fn floor(&mut self, world: &WorldSpec) -> Option<Arc<Texture>> {
        let texture = self.find_texture(&world.file, world.texture.as_ref()?, "the floor is shown without an image")?;
        Some(if world.texture_is_turned { Arc::new(texture.turned()) } else { texture })
    }
}

/// Transform from the frame of a mesh file to the frame of the body.
struct Placement {
    rotation: DMat3,
    scale: f64,
    offset: DVec3,
}

impl Placement {
    fn new(model: &ModelSpec, scale: f64) -> Self {
        let rotation = DMat3::from_rotation_y(model.rotations.y)
            * DMat3::from_rotation_x(model.rotations.x)
            * DMat3::from_rotation_z(model.rotations.z);
        // Columns: the graphics axes X (right), Y (up), Z (forward) in the body frame; then the file's axes in the
        // graphics frame.
        let body_from_graphics = DMat3::from_cols(DVec3::NEG_Y, DVec3::Z, DVec3::X);
        let graphics_from_file = DMat3::from_diagonal(DVec3::new(-1.0, 1.0, 1.0));
        Self { rotation: body_from_graphics * rotation * graphics_from_file, scale, offset: model.offset }
    }

    fn point(&self, point: DVec3) -> DVec3 {
        self.rotation * (point * self.scale) + self.offset
    }
}
