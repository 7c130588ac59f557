//! Meshes of a local corpus of real files, if present.

use std::fs;
use std::path::{Path, PathBuf};

use glam::DVec3;
use sim_core::build::MeshSource;
use sim_core::spec::{ModelSpec, ObjectType, Span, SpannedText};
use sim_format::{FileError, Files, MeshReader};

/// The file system, without an installation.
struct Disk;

impl Files for Disk {
    fn read(&self, path: &str) -> Result<Vec<u8>, FileError> {
        fs::read(path).map_err(|_missing| FileError::Missing)
    }

    fn list(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        entries.filter_map(|entry| entry.file_name().into_string().ok()).collect()
    }

    fn home(&self) -> Option<&str> {
        None
    }
}

fn corpus() -> Option<PathBuf> {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/eyesim/corpus");
    if !corpus.is_dir() {
        eprintln!("skipped: no corpus at {}", corpus.display());
        return None;
    }
    Some(corpus)
}

fn object(file: &Path, mesh: &str, scale: f64) -> ObjectType {
    let path = SpannedText { text: mesh.to_owned(), span: Span::default() };
    ObjectType {
        file: file.to_string_lossy().into_owned(),
        name: "object".to_owned(),
        model: Some(ModelSpec { path, offset: DVec3::ZERO, rotations: DVec3::ZERO }),
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

#[test]
fn the_meshes_of_the_corpus_are_read() {
    let Some(corpus) = corpus() else { return };
    let signs = "vr-2025/Sims/Updated_Objects";
    // Each entry has the folder and the mesh as named by the .esObj file, the scale, the number of triangles (a quad
    // counts twice), the number of materials, the height in metres (the file's largest y times its scale), and the
    // codes of the diagnostics. One sign refers to `Grey.png`, but the file is `Grey.JPG`.
    for (folder, mesh, scale, triangles, materials, height, codes) in [
        (
            format!("{signs}/StopSign"),
            "Stop.obj",
            0.025,
            12 + 60 + 60 + 12,
            4,
            0.025 * 14.123_141,
            vec!["file-case", "file-case"],
        ),
        (format!("{signs}/SpeedLimitSign"), "SpeedLimit.obj", 0.025, 48, 4, 0.025 * 13.714_334, vec![]),
        (format!("{signs}/SpeedLimitSign"), "10SpeedLimit.obj", 0.025, 48, 4, 0.025 * 13.679_559, vec!["file-missing"]),
        (format!("{signs}/SpeedLimitSign"), "CancelSpeedLimit.obj", 0.03, 24, 2, 0.03 * 13.677_712, vec![]),
        ("vr-crate/LLMEyesim/eyesim/worlds/Crate".to_owned(), "Crate1.obj", 1.0, 12, 1, 0.24, vec![]),
    ] {
        let kind = object(&corpus.join(folder).join("x.esObj"), mesh, scale);
        let mut reader = MeshReader::new(&Disk);
        let read = reader.object(&kind).unwrap_or_else(|| panic!("{mesh} is read"));
        let (diagnostics, _) = reader.finish();
        let reported_codes: Vec<String> = diagnostics.iter().map(|diagnostic| diagnostic.code.to_string()).collect();
        assert_eq!(reported_codes, codes, "{mesh}: {diagnostics:#?}");
        assert_eq!((read.triangles.len(), read.materials.len()), (triangles, materials), "{mesh}");
        let (_, high) = read.bounds().expect("a mesh has a size");
        assert!((high.z - height).abs() < 1e-9, "{mesh}: {} m", high.z);
        assert!(read.materials.iter().any(|material| material.texture.is_some()), "{mesh} bears an image");
    }
}

/// The word on the stop sign reads from left to right for a viewer in front: the image is not mirrored.
#[test]
fn the_stop_sign_can_be_read() {
    let Some(corpus) = corpus() else { return };
    let kind = object(&corpus.join("vr-2025/Sims/Updated_Objects/StopSign/x.esObj"), "STOP.obj", 0.025);
    let mesh = MeshReader::new(&Disk).object(&kind).expect("a mesh");
    let mut faces = 0;
    for triangle in &mesh.triangles {
        let [a, b, c] = mesh.corners(triangle);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let Some(uv) = triangle.uv.filter(|_| mesh.material(triangle).name == "STOP") else { continue };
        // The plate lies across x; only its back and front, not its rim.
        if normal.x > -0.99 || (b - a).cross(c - a).length() < 1e-3 {
            continue;
        }
        faces += 1;
        // For a viewer facing +x, +y is on the left; u must grow to the right, v upwards.
        let (ab, ac) = (b - a, c - a);
        let (uv_b, uv_c) = ((uv[1] - uv[0]).as_dvec2(), (uv[2] - uv[0]).as_dvec2());
        // Both spans have the same sense of rotation exactly if the image is not mirrored.
        let orientation = (-ab.y) * ac.z - ab.z * (-ac.y);
        assert!(orientation * uv_b.perp_dot(uv_c) > 0.0, "{a} {b} {c}: {uv:?}");
    }
    assert!(faces >= 3, "{faces} faces looked at");
}
