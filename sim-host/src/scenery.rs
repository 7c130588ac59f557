//! What the cameras of a run see: built when the first of them is asked for an image, and shared by all.

use std::sync::{Arc, OnceLock};

use parking_lot::Mutex;
pub use sim_core::build::Newcomer;
use sim_core::build::Visuals;
use sim_core::camera::{Light, Scenery, Sky};
use sim_core::spec::SceneSpec;
use sim_format::{Diagnostic, Files, InputFile, MeshReader};

/// The scenery of a run, which a run without cameras never builds: no mesh or image is read for it then.
///
/// What is built is a function of the scene and its files, and of who has come into the run, so it does not matter which robot asks
/// first.
pub struct LazyScenery {
    /// The scene and its files; none for a black sky.
    source: Option<Source>,
    built: OnceLock<Built>,
    present: Mutex<Present>,
    /// What was read for the scene itself.
    of_scene: Vec<InputFile>,
}

struct Source {
    scene: Arc<SceneSpec>,
    files: Box<dyn Files + Send + Sync>,
    /// What the user knows of the scene already.
    told: Vec<Diagnostic>,
}

/// What was read for a scenery.
#[derive(Debug)]
pub struct Built {
    /// What is wrong in meshes and images, as far as the user has not been told before.
    pub diagnostics: Vec<Diagnostic>,
    /// The files read, in order; those that the scene itself needed may be among them.
    pub inputs: Vec<InputFile>,
}

/// What can be seen now.
#[derive(Default)]
struct Present {
    visuals: Option<Visuals>,
    /// Those who have come into the run since it was built.
    newcomers: Vec<Newcomer>,
}

impl LazyScenery {
    /// The scenery of `scene`, whose meshes and images come from `files`; `told` is what the user knows of the scene already, and
    /// `of_scene` what was read for it.
    pub fn new(
        scene: Arc<SceneSpec>,
        files: impl Files + Send + Sync + 'static,
        told: Vec<Diagnostic>,
        of_scene: Vec<InputFile>,
    ) -> Self {
        let source = Some(Source { scene, files: Box::new(files), told });
        Self { source, built: OnceLock::new(), present: Mutex::default(), of_scene }
    }

    /// What can be seen; whoever asks first builds it, and who asks meanwhile waits.
    pub fn get(&self) -> Arc<Scenery> {
        let mut present = self.present.lock();
        let Present { visuals, newcomers } = &mut *present;
        let visuals = visuals.get_or_insert_with(|| self.build());
        if let Some(source) = &self.source {
            // Their types are built in, or were read for the scene: there is nothing new to be told.
            visuals.add(newcomers.drain(..), &mut MeshReader::new(&*source.files));
        }
        Arc::clone(visuals.scenery())
    }

    fn build(&self) -> Visuals {
        let Some(Source { scene, files, told }) = &self.source else {
            self.built.get_or_init(|| Built { diagnostics: Vec::new(), inputs: Vec::new() });
            let light = Light { towards: glam::DVec3::Z, ambient: 1.0, fill: 0.0, diffuse: 0.0, shadows: false };
            let sky = Sky { horizon: [0; 3], zenith: [0; 3] };
            return Visuals::of(Scenery::new(Vec::new(), None, light, sky));
        };
        let mut reader = MeshReader::new(&**files);
        let visuals = Visuals::new(scene, &mut reader);
        let (mut diagnostics, inputs) = reader.finish();
        diagnostics.retain(|diagnostic| !told.contains(diagnostic));
        self.built.get_or_init(|| Built { diagnostics, inputs });
        visuals
    }

    /// Somebody has come into the run, who is seen from now on.
    pub fn add(&self, newcomer: Newcomer) {
        self.present.lock().newcomers.push(newcomer);
    }

    /// What was read; `None` as long as nobody has asked for it.
    pub fn built(&self) -> Option<&Built> {
        self.built.get()
    }

    /// All files that diagnostics may speak of: the scene's and those read for cameras.
    pub fn inputs(&self) -> Vec<InputFile> {
        let built = self.built().map(|built| &built.inputs);
        self.of_scene.iter().chain(built.into_iter().flatten()).cloned().collect()
    }
}

impl Default for LazyScenery {
    /// Nothing but a black sky.
    fn default() -> Self {
        Self { source: None, built: OnceLock::new(), present: Mutex::default(), of_scene: Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_built_before_somebody_asks() {
        let lazy = LazyScenery::default();
        assert!(lazy.built().is_none());
        assert!(lazy.get().parts().is_empty());
        assert!(lazy.built().is_some());
    }
}
