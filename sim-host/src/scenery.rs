//! Scenery of a run for its cameras: built when the first camera takes an image, and shared by all.

use std::sync::{Arc, OnceLock};

use parking_lot::Mutex;
pub use sim_core::build::SpawnedEntity;
use sim_core::build::{MeshSource as _, Visuals};
use sim_core::camera::{Light, Scenery, Sky};
use sim_core::scene::Texture;
use sim_core::spec::SceneSpec;
use sim_format::{Diagnostic, Files, InputFile, MeshReader};

/// Lazily built scenery of a run. A run without cameras never builds it, and reads no meshes or images.
///
/// The scenery is a function of the scene, its files, and the robots and objects added to the run, so its contents do
/// not depend on which robot needs it first.
pub struct LazyScenery {
    /// The scene and its files; `None` for a black sky.
    source: Option<Source>,
    build_report: OnceLock<BuildReport>,
    state: Mutex<SceneryState>,
    /// Files that were read for the scene.
    scene_inputs: Vec<InputFile>,
}

struct Source {
    scene: Arc<SceneSpec>,
    files: Box<dyn Files + Send + Sync>,
    /// Diagnostics that the user has already seen.
    reported: Vec<Diagnostic>,
}

/// Diagnostics and files of the construction of a scenery.
#[derive(Debug)]
pub struct BuildReport {
    /// Mistakes in meshes and images, except those that the user has already seen.
    pub diagnostics: Vec<Diagnostic>,
    /// The files read, in order; files that the scene itself needed may be among them.
    pub inputs: Vec<InputFile>,
}

/// Current state of the scenery.
#[derive(Default)]
struct SceneryState {
    visuals: Option<Visuals>,
    /// Robots and objects added to the run that are not yet in `visuals`.
    spawned: Vec<SpawnedEntity>,
}

impl LazyScenery {
    /// The scenery of `scene`, with meshes and images from `files`; `reported` are the diagnostics that the user has
    /// seen already, and `scene_inputs` the files that were read for the scene.
    pub fn new(
        scene: Arc<SceneSpec>,
        files: impl Files + Send + Sync + 'static,
        reported: Vec<Diagnostic>,
        scene_inputs: Vec<InputFile>,
    ) -> Self {
        let source = Some(Source { scene, files: Box::new(files), reported });
        Self { source, build_report: OnceLock::new(), state: Mutex::default(), scene_inputs }
    }

    /// The current scenery. The first caller builds it; further callers wait.
    pub fn get(&self) -> Arc<Scenery> {
        let mut state = self.state.lock();
        let SceneryState { visuals, spawned } = &mut *state;
        let visuals = visuals.get_or_insert_with(|| self.build());
        if let Some(source) = &self.source {
            // The types of added robots and objects are built in, or were read for the scene: there are no new
            // diagnostics.
            visuals.add(spawned.drain(..), &mut MeshReader::new(&*source.files));
        }
        Arc::clone(visuals.scenery())
    }

    fn build(&self) -> Visuals {
        let Some(Source { scene, files, reported }) = &self.source else {
            self.build_report.get_or_init(|| BuildReport { diagnostics: Vec::new(), inputs: Vec::new() });
            let light = Light { sun_direction: glam::DVec3::Z, ambient: 1.0, fill: 0.0, diffuse: 0.0, shadows: false };
            let sky = Sky { horizon: [0; 3], zenith: [0; 3] };
            return Visuals::from_scenery(Scenery::new(Vec::new(), None, light, sky));
        };
        let mut reader = MeshReader::new(&**files);
        let visuals = Visuals::new(scene, &mut reader);
        let (mut diagnostics, inputs) = reader.finish();
        diagnostics.retain(|diagnostic| !reported.contains(diagnostic));
        self.build_report.get_or_init(|| BuildReport { diagnostics, inputs });
        visuals
    }

    /// Adds a spawned robot or object, which is visible in all later images.
    pub fn add(&self, spawned: SpawnedEntity) {
        self.state.lock().spawned.push(spawned);
    }

    /// The image on the floor, for a picture from above; `None` if there is none or it cannot be read. The scene's
    /// diagnostics report an image that cannot be read.
    pub fn floor(&self) -> Option<Arc<Texture>> {
        let Source { scene, files, .. } = self.source.as_ref()?;
        MeshReader::new(&**files).floor(&scene.world)
    }

    /// Diagnostics and files of the scenery; `None` until it is built.
    pub fn built(&self) -> Option<&BuildReport> {
        self.build_report.get()
    }

    /// All files to which diagnostics may refer: the scene's, and the files read for cameras.
    pub fn inputs(&self) -> Vec<InputFile> {
        let built = self.built().map(|built| &built.inputs);
        self.scene_inputs.iter().chain(built.into_iter().flatten()).cloned().collect()
    }
}

impl Default for LazyScenery {
    /// Creates a scenery of only a black sky.
    fn default() -> Self {
        Self { source: None, build_report: OnceLock::new(), state: Mutex::default(), scene_inputs: Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenery_is_built_at_first_use() {
        let lazy = LazyScenery::default();
        assert!(lazy.built().is_none());
        assert!(lazy.get().parts().is_empty());
        assert!(lazy.built().is_some());
    }
}
