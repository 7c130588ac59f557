//! What the cameras of a run see: built when the first of them is asked for an image, and shared by all.

use std::sync::{Arc, OnceLock};

use sim_core::camera::{Light, Scenery, Sky};
use sim_core::format::{Diagnostic, Files, InputFile, MeshReader, SceneSpec};

/// The scenery of a run, which a run without cameras never builds: no mesh or image is read for it then.
///
/// What is built is a function of the scene and its files, so it does not matter which robot asks first.
pub struct LazyScenery {
    build: Box<dyn Fn() -> Built + Send + Sync>,
    built: OnceLock<Built>,
    /// What was read for the scene itself.
    of_scene: Vec<InputFile>,
}

/// A scenery, and what was read for it.
#[derive(Debug)]
pub struct Built {
    /// What can be seen.
    pub scenery: Scenery,
    /// What is wrong in meshes and images, as far as the user has not been told before.
    pub diagnostics: Vec<Diagnostic>,
    /// The files read, in order; those that the scene itself needed may be among them.
    pub inputs: Vec<InputFile>,
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
        let build = move || {
            let mut reader = MeshReader::new(&files);
            let scenery = sim_core::build::scenery(&scene, &mut reader);
            let (mut diagnostics, inputs) = reader.finish();
            diagnostics.retain(|diagnostic| !told.contains(diagnostic));
            Built { scenery, diagnostics, inputs }
        };
        Self { build: Box::new(build), built: OnceLock::new(), of_scene }
    }

    /// What can be seen; whoever asks first builds it, and who asks meanwhile waits.
    pub fn get(&self) -> &Scenery {
        &self.built.get_or_init(&self.build).scenery
    }

    /// What was built; `None` as long as nobody has asked for it.
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
        let build = || {
            let light = Light { towards: glam::DVec3::Z, ambient: 1.0, fill: 0.0, diffuse: 0.0, shadows: false };
            let sky = Sky { horizon: [0; 3], zenith: [0; 3] };
            Built { scenery: Scenery::new(Vec::new(), None, light, sky), diagnostics: Vec::new(), inputs: Vec::new() }
        };
        Self { build: Box::new(build), built: OnceLock::new(), of_scene: Vec::new() }
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
