//! Checks of the readers, one function per reader.

use eyesim::pack::Pack;
use glam::DVec3;
use sim_core::build::MeshSource;
use sim_core::spec::{ModelSpec, RobiSpec, Span, SpannedText, WorldSpec};
use sim_format::map::read_scenarios;
use sim_format::suite::{MAX_CASES, read_suite};
use sim_format::{Diagnostic, MemoryFiles, MeshReader};

use crate::archive::Archive;
use crate::text::Lines;
use crate::{spec, text};

pub fn world(input: &[u8]) {
    plane(input, "a.wld", sim_format::read_world);
}

pub fn maze(input: &[u8]) {
    plane(input, "a.maz", sim_format::read_maze);
}

fn plane(input: &[u8], file: &str, read: fn(&str, &str) -> (WorldSpec, Vec<Diagnostic>)) {
    let (content, _) = sim_format::decode(input);
    let (world, diagnostics) = read(file, &content);
    text::check(&content, &diagnostics);
    spec::world(&world, &Lines::new(&content));
}

pub fn robi(input: &[u8]) {
    let (content, _) = sim_format::decode(input);
    let (robi, diagnostics) = sim_format::read_robi("a.robi", &content);
    text::check(&content, &diagnostics);
    spec::robi(&robi);
}

pub fn esobj(input: &[u8]) {
    let (content, _) = sim_format::decode(input);
    let (object, diagnostics) = sim_format::read_esobj("a.esObj", &content);
    text::check(&content, &diagnostics);
    spec::object_type(&object);
}

pub fn companion(input: &[u8]) {
    let (content, _) = sim_format::decode(input);
    let mut robi = RobiSpec::with_defaults("a.robi");
    let diagnostics = sim_format::read_companion("a.toml", &content, &mut robi);
    text::check(&content, &diagnostics);
    spec::robi(&robi);
}

pub fn sim(input: &[u8]) {
    let (content, _) = sim_format::decode(input);
    let (sim, diagnostics) = sim_format::read_sim("a.sim", &content);
    text::check(&content, &diagnostics);
    spec::sim(&sim, &Lines::new(&content));
}

pub fn scene(input: &[u8]) {
    let (content, _) = sim_format::decode(input);
    let (sim, diagnostics) = sim_format::read_scene("a.scene.toml", &content);
    text::check(&content, &diagnostics);
    spec::sim(&sim, &Lines::new(&content));
}

/// Checks that a suite's cases are those of its matrix, and that settings and arguments of cases can be formed.
pub fn suite(input: &[u8]) {
    let (content, _) = sim_format::decode(input);
    let (suite, diagnostics) = read_suite("a.suite.toml", &content);
    text::check(&content, &diagnostics);
    assert!((0.0..=1.0).contains(&suite.pass_rate));
    if sim_format::has_errors(&diagnostics) {
        return;
    }
    let axes = suite.matrix.axes();
    let cases = suite.matrix.cases();
    assert!(!cases.is_empty() && cases.len() as u64 <= suite.matrix.count().min(MAX_CASES));
    for case in cases.iter().take(100) {
        assert!(case.len() == axes.len() && case.iter().zip(&axes).all(|(index, axis)| *index < axis.values.len()));
        suite.settings(&axes, case);
        suite.arguments(&axes, case);
    }
}

/// Checks that the names of an archive's files lead to no other folder.
pub fn pack(input: &[u8]) {
    let Ok(pack) = Pack::read(input) else { return };
    assert!(pack.files.contains_key(&pack.manifest.main));
    for path in pack.files.keys() {
        assert!(!path.starts_with('/') && path.split('/').all(|part| !["", ".", ".."].contains(&part)), "{path}");
    }
}

pub fn costs(input: &[u8]) {
    let (content, _) = sim_format::decode(input);
    let (costs, diagnostics) = sim_format::read_costs("costs.toml", &content);
    text::check(&content, &diagnostics);
    spec::costs(&costs, &Lines::new(&content));
}

pub fn noise(input: &[u8]) {
    let (content, _) = sim_format::decode(input);
    let (noise, diagnostics) = sim_format::read_noise("a.noise.toml", &content);
    text::check(&content, &diagnostics);
    spec::noise(&noise, &Lines::new(&content));
}

pub fn load_scene(input: &[u8]) {
    let archive = Archive::new(input);
    let loaded = sim_format::load_scene(archive.first(), &archive);
    spec::scene(&loaded.scene);
    for robot in &loaded.scene.robots {
        spec::robi(&robot.robi);
    }
    for object in &loaded.scene.objects {
        spec::object_type(&object.kind);
    }
    diagnostics(&archive, &loaded.diagnostics);
}

/// Checks the mesh reader; the first file of the archive is the mesh of a robot.
pub fn mesh(input: &[u8]) {
    let archive = Archive::new(input);
    let path = SpannedText { text: archive.first().to_owned(), span: Span::default() };
    let mut robi = RobiSpec::with_defaults("a.robi");
    robi.model = Some(ModelSpec { path, offset: DVec3::ZERO, rotations: DVec3::ZERO });
    let mut reader = MeshReader::new(&archive);
    if let Some(mesh) = reader.robot(&robi) {
        spec::mesh(&mesh);
    }
    diagnostics(&archive, &reader.finish().0);
}

/// Checks the reader of maps with images; the first file of the archive is a `map.yaml` or a MovingAI map.
pub fn map(input: &[u8]) {
    let archive = Archive::new(input);
    let loaded = sim_format::load_world(archive.first(), &archive);
    spec::finite(&loaded.scene.world);
    diagnostics(&archive, &loaded.diagnostics);
}

/// Checks the reader of a map's image.
pub fn netpbm(input: &[u8]) {
    alone("a.pgm", input);
}

/// Checks the reader of mazes in the formats of contests.
pub fn contest(input: &[u8]) {
    alone("a.txt", input);
}

/// Checks the reader of Gazebo worlds.
pub fn sdf(input: &[u8]) {
    alone("a.sdf", input);
}

/// Checks a world in a single file. Walls of mazes and of Gazebo worlds have locations in the text; walls of images
/// have none.
fn alone(name: &str, input: &[u8]) {
    let files = MemoryFiles::from_iter([(name, input)]);
    let loaded = sim_format::load_world(name, &files);
    let (content, _) = sim_format::decode(input);
    let lines = Lines::new(&content);
    for diagnostic in &loaded.diagnostics {
        text::words(diagnostic);
        lines.check(diagnostic.span, diagnostic);
    }
    spec::world(&loaded.scene.world, &lines);
}

/// Checks that start and goal of MovingAI scenarios are on the map.
pub fn scenarios(input: &[u8]) {
    let (content, _) = sim_format::decode(input);
    let (scenarios, diagnostics) = read_scenarios("a.scen", &content);
    text::check(&content, &diagnostics);
    for scenario in scenarios {
        let [width, height] = scenario.size;
        assert!([scenario.start, scenario.goal].iter().all(|[x, y]| *x < width && *y < height), "{scenario:?}");
        assert!(scenario.length.is_finite(), "{scenario:?}");
    }
}

/// Checks the diagnostics of the files of an archive.
fn diagnostics(archive: &Archive, diagnostics: &[Diagnostic]) {
    for diagnostic in diagnostics {
        text::words(diagnostic);
        let Some(bytes) = archive.bytes(&diagnostic.file) else { continue };
        let (content, _) = sim_format::decode(bytes);
        Lines::new(&content).check(diagnostic.span, diagnostic);
    }
}
