//! Meshes, materials and images: hand-computed values, mistakes, and comparison with tobj.

use std::f64::consts::FRAC_PI_2;
use std::io::Cursor;
use std::sync::Arc;

use glam::{DVec3, Vec2, Vec3};
use proptest::prelude::*;

use super::Memory;
use crate::{Diagnostic, FileError, Files, MeshReader, ModelSpec, ObjectType, Severity, Span, SpannedText};
use sim_core::build::MeshSource;
use sim_core::scene::Mesh;

/// Upright square of side 1 at z = 3 of the file, with one edge in the plane x = 0.
const QUAD: &str = "mtllib a.mtl\nv 0 0 3\nv 1 0 3\nv 1 1 3\nv 0 1 3\nusemtl red\nf 1 2 3 4\n";

fn model(rotations: DVec3, offset: DVec3) -> ModelSpec {
    let span = Span { start: 4, end: 9, line: 1, column: 5 };
    ModelSpec { path: SpannedText { text: "a.obj".into(), span }, offset, rotations }
}

fn object(model: ModelSpec, scale: f64) -> ObjectType {
    ObjectType {
        file: "o.esObj".into(),
        name: "o".into(),
        model: Some(model),
        scale,
        colliders: Vec::new(),
        mass: 1.0,
        centre_of_mass: DVec3::ZERO,
        is_fixed: true,
        friction: 0.5,
        rolling: None,
        restitution: 0.0,
        colour: None,
        surface: Default::default(),
        sensor_shape: Default::default(),
        displaced_volume: 0.0,
        lift: 0.0,
    }
}

fn load(files: &dyn Files, kind: &ObjectType) -> (Option<Arc<Mesh>>, Vec<Diagnostic>) {
    let mut reader = MeshReader::new(files);
    let mesh = reader.object(kind);
    (mesh, reader.finish().0)
}

/// Reads the mesh in `text`; also returns code and line of each diagnostic.
fn read(text: &str) -> (Option<Arc<Mesh>>, Vec<(String, u32)>) {
    let files = Memory::new(&[("a.obj", text), ("a.mtl", "newmtl red\nKd 1 0 0\n")]);
    let (mesh, diagnostics) = load(&files, &object(model(DVec3::ZERO, DVec3::ZERO), 1.0));
    assert!(diagnostics.iter().all(|d| d.severity == Severity::Warning), "nothing here stops a scene: {diagnostics:?}");
    if let Some(mesh) = &mesh {
        check(mesh);
    }
    (mesh, diagnostics.iter().map(|d| (d.code.to_string(), d.span.line)).collect())
}

/// Checks the invariants of [`Mesh`].
fn check(mesh: &Mesh) {
    assert!(mesh.positions.iter().all(|point| point.is_finite()));
    assert!(!mesh.triangles.is_empty());
    for triangle in &mesh.triangles {
        let [a, b, c] = mesh.corners(triangle);
        assert!((b - a).cross(c - a).length() > 0.0, "a triangle without area");
        let colour = mesh.material(triangle).colour;
        assert!(colour.iter().all(|part| (0.0..=1.0).contains(part)));
        assert!(triangle.uv.iter().flatten().all(|uv| uv.is_finite()));
        assert!(triangle.normals.iter().flatten().all(|normal| (normal.length() - 1.0).abs() < 1e-6));
    }
}

#[test]
fn mesh_is_transformed_to_the_body_frame() {
    let files = Memory::new(&[("a.obj", QUAD), ("a.mtl", "newmtl red\nKd 1 0 0\n")]);
    let (mesh, diagnostics) = load(&files, &object(model(DVec3::ZERO, DVec3::new(0.0, 0.0, 10.0)), 2.0));
    assert_eq!(diagnostics, []);
    let mesh = mesh.expect("a mesh");
    // 3 forward, 1 to the left, 1 up, times 2, and 10 up.
    assert_eq!(mesh.bounds(), Some((DVec3::new(6.0, 0.0, 10.0), DVec3::new(6.0, 2.0, 12.0))));
    assert_eq!(mesh.positions[2], DVec3::new(6.0, 2.0, 12.0));
    assert_eq!(mesh.triangles.len(), 2);
    assert_eq!(mesh.material(&mesh.triangles[1]).colour, [1.0, 0.0, 0.0]);
}

#[test]
fn rotations_are_about_z_then_x_then_y() {
    let files = Memory::new(&[("a.obj", QUAD), ("a.mtl", "newmtl red\n")]);
    let first_corner = |x: f64, y: f64, z: f64| {
        let rotations = DVec3::new(x, y, z) * FRAC_PI_2;
        load(&files, &object(model(rotations, DVec3::ZERO), 1.0)).0.expect("a mesh").positions[0]
    };
    // The first corner lies in front of the origin. A rotation about Y (up) moves it to the right, one about X (right)
    // down.
    for ((x, y, z), expected) in [
        ((0.0, 1.0, 0.0), DVec3::new(0.0, -3.0, 0.0)),
        ((1.0, 0.0, 0.0), DVec3::new(0.0, 0.0, -3.0)),
        ((0.0, 0.0, 1.0), DVec3::new(3.0, 0.0, 0.0)),
        ((1.0, 1.0, 0.0), DVec3::new(0.0, 0.0, -3.0)),
        ((0.0, 2.0, 0.0), DVec3::new(-3.0, 0.0, 0.0)),
    ] {
        let corner = first_corner(x, y, z);
        assert!((corner - expected).length() < 1e-12, "{x} {y} {z}: {corner} is not {expected}");
    }
}

#[test]
fn faces_of_all_forms_are_read() {
    let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0.5 0\nvt 0 0\nvt 1 0 0\nvt 1 1\nvn 0 0 2\n\
                f 1 2 3 4 5\nf -5/-3/-1 -4/2/1 3/3/1\nf 1//1 2//1 3//1\nf 1/1 2/2 3/3\nf 1/1 2 3//1\nf 1 1 2\nl 1 2\np 1\n";
    let (mesh, mistakes) = read(text);
    assert_eq!(mistakes, []);
    let mesh = mesh.expect("a mesh");
    // The pentagon gives three triangles. Four triangles follow; the triangle without area is dropped.
    let corners: Vec<_> = mesh.triangles.iter().map(|triangle| triangle.corners).collect();
    assert_eq!(corners, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 1, 2], [0, 1, 2], [0, 1, 2], [0, 1, 2]]);
    let normal = Some([Vec3::X; 3]);
    let uv = Some([Vec2::ZERO, Vec2::X, Vec2::ONE]);
    let looks: Vec<_> = mesh.triangles[2..].iter().map(|triangle| (triangle.normals, triangle.uv)).collect();
    assert_eq!(looks, [(None, None), (normal, uv), (normal, None), (None, uv), (None, None)]);
}

#[test]
fn each_kind_of_mistake_is_reported_once_and_the_rest_is_read() {
    let valid_lines = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
    for (lines, expected) in [
        ("v 1 2\nf 1 2 3\n", vec![("mesh-line", 4)]),
        ("v 1 2 x\nv NaN 0 0\nf 1 2 3\n", vec![("mesh-line", 4)]),
        ("v 1e9 0 0\nf 1 2 4\nf 1 2 3\n", vec![("mesh-line", 4)]),
        ("f 1 2\nf 1 2 3\n", vec![("mesh-line", 4)]),
        ("f a b c\nf 1/2/3/4 x 3\nf 1 2 3\n", vec![("mesh-line", 4)]),
        ("f 1 2 4\nf 1 2 -4\nf 0 1 2\nf 1 2 3\n", vec![("mesh-index", 4)]),
        ("f 1 2 99999999999999999999\nf 1 2 3\n", vec![("mesh-line", 4)]),
        ("f 1 2 -9223372036854775808\nf 1 2 9223372036854775807\nf 1 2 3\n", vec![("mesh-index", 4)]),
        ("f 1/1 2/-1 3//7\n", vec![("mesh-index", 4)]),
        ("vt 1\nvn x\nf 1/1/1 2/1/1 3/1/1\n", vec![("mesh-line", 4)]),
        ("usemtl blue\nf 1 2 3\n", vec![]),
        ("mtllib a.mtl\nusemtl blue\nf 1 2 3\nusemtl red\nusemtl blue\nf 1 2 3\n", vec![("mesh-material", 5)]),
        ("mtllib b.mtl\nusemtl red\nf 1 2 3\n", vec![("file-missing", 4)]),
        ("# nothing\n", vec![("mesh-empty", 0)]),
        ("f 1 1 1\nf 1 2 2\n", vec![("mesh-empty", 0)]),
    ] {
        let (mesh, mut mistakes) = read(&format!("{valid_lines}{lines}"));
        if lines.starts_with("usemtl") {
            // A face without any material file refers to a missing material.
            mistakes.retain(|(code, _)| code != "mesh-material");
        }
        let mistakes: Vec<(&str, u32)> = mistakes.iter().map(|(code, line)| (code.as_str(), *line)).collect();
        assert_eq!(mistakes, expected, "{lines}");
        assert_eq!(mesh.is_some(), !lines.starts_with('#') && !lines.starts_with("f 1 1 1"), "{lines}");
    }
}

#[test]
fn files_are_found_by_the_search_rules_and_missing_files_are_warnings() {
    let png = {
        let mut bytes = Cursor::new(Vec::new());
        let image = image::RgbImage::from_pixel(2, 2, image::Rgb([9, 8, 7]));
        image.write_to(&mut bytes, image::ImageFormat::Png).expect("an image");
        bytes.into_inner()
    };
    let mut files = Memory::new(&[
        (
            "o/A.obj",
            "mtllib my parts.mtl ..\\m\\B.MTL\nv 0 0 0\nv 1 0 0\nv 1 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 2\n",
        ),
        ("o/my parts.mtl", "newmtl a\nmap_Kd C:\\Users\\x\\red.png\n"),
        ("m/b.mtl", "newmtl b\nmap_Kd tex\\RED.png\nnewmtl unused\nmap_Kd none.png\n"),
    ]);
    files.files.insert("o/red.png", png.clone());
    files.files.insert("m/tex/red.png", png);
    let mut kind = object(model(DVec3::ZERO, DVec3::ZERO), 1.0);
    kind.file = "o/o.esObj".into();
    let (mesh, diagnostics) = load(&files, &kind);
    let mesh = mesh.expect("a mesh");
    let textures: Vec<_> = mesh.materials.iter().map(|m| m.texture.as_ref().map(|t| t.pixel(0, 0))).collect();
    assert_eq!(textures, [Some([9, 8, 7, 255]); 2]);
    let codes: Vec<_> = diagnostics.iter().map(|d| (d.code.to_string(), d.file.as_str(), d.span.line)).collect();
    let expected = [
        ("file-case", "o/o.esObj", 1),
        ("file-case", "o/A.obj", 1),
        ("file-moved", "o/my parts.mtl", 2),
        ("file-case", "m/b.mtl", 2),
    ];
    assert_eq!(codes, expected.map(|(code, file, line)| (code.to_owned(), file, line)));

    let (mesh, diagnostics) = load(&Memory::default(), &kind);
    assert!(mesh.is_none());
    assert_eq!((diagnostics.len(), diagnostics[0].severity), (1, Severity::Warning));
    assert!(diagnostics[0].message.ends_with("; the body's own shape is shown instead"), "{}", diagnostics[0].message);
}

#[test]
fn colour_is_used_instead_of_broken_images() {
    let files = Memory::new(&[("a.obj", QUAD), ("a.mtl", "newmtl red\nKd 1 0 0\nmap_Kd a.png\n"), ("a.png", "GIF89a")]);
    let (mesh, diagnostics) = load(&files, &object(model(DVec3::ZERO, DVec3::ZERO), 1.0));
    assert_eq!(mesh.expect("a mesh").materials[0].colour, [1.0, 0.0, 0.0]);
    let codes: Vec<_> = diagnostics.iter().map(|d| (d.code.to_string(), d.file.as_str(), d.span.line)).collect();
    assert_eq!(codes, [("texture-format".to_owned(), "a.mtl", 3)]);
}

#[test]
fn unsupported_mesh_formats_are_reported() {
    for (name, word) in
        [("S4.ms3d", "MilkShape"), ("a.iv", "Open Inventor"), ("a.stl", "this kind"), ("mesh", "this kind")]
    {
        let mut model = model(DVec3::ZERO, DVec3::ZERO);
        model.path.text = name.into();
        let (mesh, diagnostics) = load(&Memory::new(&[(name, "x")]), &object(model, 1.0));
        assert!(mesh.is_none());
        assert_eq!((diagnostics.len(), diagnostics[0].code.to_string()), (1, "mesh-format".to_owned()));
        assert!(diagnostics[0].message.contains(word) && diagnostics[0].span.line == 1, "{}", diagnostics[0].message);
    }
}

#[test]
fn a_mesh_is_read_once() {
    struct Counting(Memory, std::cell::Cell<usize>);
    impl Files for Counting {
        fn read(&self, path: &str) -> Result<Vec<u8>, FileError> {
            self.1.set(self.1.get() + 1);
            self.0.read(path)
        }
        fn list(&self, folder: &str) -> Vec<String> {
            self.0.list(folder)
        }
        fn home(&self) -> Option<&str> {
            None
        }
    }
    let files = Counting(Memory::new(&[("a.obj", QUAD), ("a.mtl", "newmtl red\n")]), std::cell::Cell::new(0));
    let kind = object(model(DVec3::ZERO, DVec3::ZERO), 1.0);
    let mut reader = MeshReader::new(&files);
    let (first, second) = (reader.object(&kind), reader.object(&kind));
    assert!(Arc::ptr_eq(&first.expect("a mesh"), &second.expect("the same")));
    assert_eq!(files.1.get(), 2, "mesh and materials");
}

#[test]
fn two_bodies_with_one_mesh_report_its_mistakes_once() {
    let files = Memory::new(&[("a.obj", QUAD), ("a.mtl", "newmtl blue\n")]);
    let kind = object(model(DVec3::ZERO, DVec3::ZERO), 1.0);
    let mut reader = MeshReader::new(&files);
    reader.object(&kind);
    reader.object(&ObjectType { file: "large.esObj".into(), scale: 2.0, ..kind });
    let codes: Vec<String> = reader.finish().0.iter().map(|diagnostic| diagnostic.code.to_string()).collect();
    assert_eq!(codes, ["mesh-material"]);
}

#[test]
fn too_many_triangles_are_rejected() {
    let mut text = String::from("v 0 0 0\nv 1 0 0\nv 1 1 0\n");
    text.push_str(&"f 1 2 3\n".repeat(2_000_001));
    let (mesh, mistakes) = read(&text);
    assert!(mesh.is_none());
    assert_eq!(mistakes, [("mesh-size".to_owned(), 0)]);
}

/// Position of each corner of a triangle in the file's frame, and its texture coordinates.
type Corners = [([f32; 3], Option<[f32; 2]>); 3];

/// Corners of all triangles as read by tobj, with their texture coordinates, which are `None` if a part of
/// the file has none.
fn read_by_tobj(text: &str) -> Vec<Corners> {
    let options = tobj::LoadOptions { triangulate: true, single_index: true, ..Default::default() };
    let (models, _) =
        tobj::load_obj_buf(&mut text.as_bytes(), &options, |_| Ok(Default::default())).expect("a good file");
    let corner = |mesh: &tobj::Mesh, index: u32| {
        let index = index as usize;
        let position = [0, 1, 2].map(|axis| mesh.positions[3 * index + axis]);
        (position, mesh.texcoords.get(2 * index..2 * index + 2).map(|uv| [uv[0], uv[1]]))
    };
    let triangles = models.iter().flat_map(|model| model.mesh.indices.chunks(3).map(move |t| (&model.mesh, t)));
    triangles.map(|(mesh, t)| [0, 1, 2].map(|index| corner(mesh, t[index]))).collect()
}

fn read_by_us(text: &str) -> Vec<Corners> {
    let Some(mesh) = read(text).0 else { return Vec::new() };
    let corners = |triangle: &sim_core::scene::Triangle| {
        let positions = mesh.corners(triangle);
        // Transform back into the file's frame.
        [0, 1, 2].map(|index| {
            let DVec3 { x, y, z } = positions[index];
            ([y as f32, z as f32, x as f32], triangle.uv.map(|uv| uv[index].to_array()))
        })
    };
    mesh.triangles.iter().map(corners).collect()
}

proptest! {
    /// Valid files result in the triangles that tobj finds, except triangles of zero area.
    #[test]
    fn valid_files_match_tobj(
        points in prop::collection::vec([-50i32..50, -50i32..50, -50i32..50], 3..12),
        faces in prop::collection::vec((prop::collection::vec((0usize..100, any::<bool>()), 3..7), any::<bool>()), 1..10),
        has_uv in any::<bool>(),
    ) {
        let mut text = String::new();
        for [x, y, z] in &points {
            text += &format!("v {} {} {}\nvt {} {}\n", f64::from(*x) / 8.0, y, z, f64::from(*x) / 64.0, f64::from(*y) / 64.0);
        }
        for (corners, opens_object) in &faces {
            text += if *opens_object { "o part\nf" } else { "f" };
            for (corner, is_relative) in corners {
                let index = (corner % points.len()) as i64;
                let number = if *is_relative { index - points.len() as i64 } else { index + 1 };
                text += &if has_uv { format!(" {number}/{number}") } else { format!(" {number}") };
            }
            text += "\n";
        }
        let has_area = |corners: &Corners| {
            let [a, b, c] = corners.map(|(position, _)| DVec3::from(position.map(f64::from)));
            (b - a).cross(c - a).length() > 0.0
        };
        let expected: Vec<_> = read_by_tobj(&text).into_iter().filter(has_area).collect();
        prop_assert_eq!(read_by_us(&text), expected);
    }

    /// Arbitrary words result in a mesh of finite numbers or in a diagnostic.
    #[test]
    fn arbitrary_words_give_a_mesh_or_a_diagnostic(
        words in prop::collection::vec(
            prop::sample::select(vec![
                "v", "vt", "vn", "f", "usemtl", "mtllib", "o", "\n", "\n", "1", "2", "3", "-1", "0", "1/1", "1//2", "/", "//",
                "-1/-1/-1", "4/5/6/7", "nan", "inf", "-1e39", "1e400", "1e-320", "9223372036854775807", "red", "a.mtl", "\\",
                "#", "\u{e9}", "\t", "\r", "a.obj", "99999999999999999999",
            ]),
            0..200,
        ),
    ) {
        let text = words.join(" ");
        let (mesh, mistakes) = read(&text);
        prop_assert!(mesh.is_some() || !mistakes.is_empty());
    }

    /// Arbitrary bytes in the three files cause no panic and no errors, only warnings.
    #[test]
    fn arbitrary_bytes_give_only_warnings(obj in prop::collection::vec(any::<u8>(), 0..300), mtl in ".{0,200}", png in prop::collection::vec(any::<u8>(), 0..300)) {
        let mut files = Memory::new(&[("a.obj", QUAD)]);
        files.files.insert("a.mtl", format!("newmtl red\n{mtl}\nmap_Kd a.png\n").into_bytes());
        let mut image = b"\x89PNG\r\n\x1a\n".to_vec();
        image.extend(&png);
        files.files.insert("a.png", image);
        let kind = object(model(DVec3::ZERO, DVec3::ZERO), 1.0);
        let (mesh, diagnostics) = load(&files, &kind);
        check(&mesh.expect("the mesh itself is good"));
        prop_assert!(diagnostics.iter().all(|d| d.severity == Severity::Warning));
        files.files.insert("a.obj", obj);
        if let Some(mesh) = load(&files, &kind).0 {
            check(&mesh);
        }
    }
}
