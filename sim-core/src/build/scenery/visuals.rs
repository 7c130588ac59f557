//! Scenery of a scene and of the entities that are spawned during the run.

use std::sync::Arc;

use super::{MeshCache, MeshSource, scenery_with};
use crate::camera::Scenery;
use crate::scene::{Mesh, Texture};
use crate::spec::{ObjectType, RobiSpec, SceneSpec, WorldSpec};
use crate::{ObjectId, RobotId};

/// The scenery of a scene, to which spawned robots and movable objects can be added. A clone shares all meshes and
/// images.
#[derive(Clone, Debug)]
pub struct Visuals {
    scenery: Arc<Scenery>,
    meshes: MeshCache,
}

/// A mesh source without meshes and images: objects appear as their colliders.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoMeshes;

/// An entity spawned during a run.
#[derive(Clone, Debug)]
pub enum SpawnedEntity {
    /// A robot.
    Robot(RobotId, Arc<RobiSpec>),
    /// A movable object.
    Object(ObjectId, Arc<ObjectType>),
}

impl Visuals {
    /// The scenery of `scene`, with meshes and images from `reader`.
    pub fn new(scene: &SceneSpec, reader: &mut dyn MeshSource) -> Self {
        let mut meshes = MeshCache::default();
        Self { scenery: Arc::new(scenery_with(scene, &mut meshes, reader)), meshes }
    }

    /// Wraps an existing scenery.
    pub fn from_scenery(scenery: Scenery) -> Self {
        Self { scenery: Arc::new(scenery), meshes: MeshCache::default() }
    }

    /// The current scenery.
    pub fn scenery(&self) -> &Arc<Scenery> {
        &self.scenery
    }

    /// Adds spawned entities to the scenery; the meshes of new types come from `reader`.
    pub fn add(&mut self, entities: impl IntoIterator<Item = SpawnedEntity>, reader: &mut dyn MeshSource) {
        let mut parts = Vec::new();
        for entity in entities {
            match entity {
                SpawnedEntity::Robot(id, robi) => {
                    parts.push(self.meshes.robot(id, &robi, reader));
                    parts.extend(self.meshes.legs(id, &robi));
                }
                SpawnedEntity::Object(id, kind) => parts.push(self.meshes.object(id, &kind, reader)),
            }
        }
        if !parts.is_empty() {
            self.scenery = Arc::new((*self.scenery).clone().with_parts(parts));
        }
    }
}

impl MeshSource for NoMeshes {
    fn robot(&mut self, _: &RobiSpec) -> Option<Arc<Mesh>> {
        None
    }

    fn object(&mut self, _: &ObjectType) -> Option<Arc<Mesh>> {
        None
    }

    fn floor(&mut self, _: &WorldSpec) -> Option<Arc<Texture>> {
        None
    }
}
