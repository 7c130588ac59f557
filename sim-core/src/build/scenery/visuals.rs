//! What cameras see of a scene and of whoever comes into it later.

use std::sync::Arc;

use super::{Looks, MeshSource, scenery_with};
use crate::camera::Scenery;
use crate::scene::{Mesh, Texture};
use crate::spec::{ObjectType, RobiSpec, SceneSpec, WorldSpec};
use crate::{ObjectId, RobotId};

/// The scenery of a scene, to which robots and movable objects can be added. A copy shares all meshes and images.
#[derive(Clone, Debug)]
pub struct Visuals {
    scenery: Arc<Scenery>,
    looks: Looks,
}

/// No meshes and images at all: things look as their colliders are.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoMeshes;

/// Somebody who has come into a run.
#[derive(Clone, Debug)]
pub enum Newcomer {
    /// A robot.
    Robot(RobotId, Arc<RobiSpec>),
    /// A movable object.
    Object(ObjectId, Arc<ObjectType>),
}

impl Visuals {
    /// What cameras see of `scene`, whose meshes and images come from `reader`.
    pub fn new(scene: &SceneSpec, reader: &mut dyn MeshSource) -> Self {
        let mut looks = Looks::default();
        Self { scenery: Arc::new(scenery_with(scene, &mut looks, reader)), looks }
    }

    /// Nothing but this scenery.
    pub fn of(scenery: Scenery) -> Self {
        Self { scenery: Arc::new(scenery), looks: Looks::default() }
    }

    /// All that can be seen.
    pub fn scenery(&self) -> &Arc<Scenery> {
        &self.scenery
    }

    /// These can be seen from now on, too; `reader` is asked for the meshes of types that are new.
    pub fn add(&mut self, newcomers: impl IntoIterator<Item = Newcomer>, reader: &mut dyn MeshSource) {
        let mut parts = Vec::new();
        for newcomer in newcomers {
            match newcomer {
                Newcomer::Robot(id, robi) => {
                    parts.push(self.looks.robot(id, &robi, reader));
                    parts.extend(self.looks.legs(id, &robi));
                }
                Newcomer::Object(id, kind) => parts.push(self.looks.object(id, &kind, reader)),
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
