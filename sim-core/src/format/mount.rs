//! Where sensors sit and what they see: links, poses in space, range sensors beside the PSDs, solids of meshes.
//!
//! These are parts of [`super::spec`]: finite numbers within their ranges, SI units.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::DVec3;

use super::Span;
use super::spec::{Axis, JointSpec, ModelSpec, PathRef, RobiSpec, ServoSpec};
use crate::scene::Mesh;
use crate::sensor::RangeModel;

/// Name of the body among the links.
pub const BODY: &str = "body";

/// A pose on the body or on a link: x forward, y left, z up there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MountSpec {
    /// The link; `None`: the body.
    pub on: Option<PathRef>,
    /// Place of the origin, in metres.
    pub position: DVec3,
    /// Turn about x, the left side upwards, in radians; the first of the three turns.
    pub roll: f64,
    /// Turn of x upwards, in radians; the second.
    pub pitch: f64,
    /// Turn about z, counter-clockwise, in radians; the third.
    pub yaw: f64,
}

impl MountSpec {
    /// True for what sits on the body and looks along the floor.
    pub fn is_level(&self) -> bool {
        self.on.is_none() && self.roll == 0.0 && self.pitch == 0.0
    }
}

/// What turns a link.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnSpec {
    /// About which axis of the link: about y, positive angles turn x upwards, as a pitch does.
    pub axis: Axis,
    /// Name of the servo whose angle it has.
    pub servo: PathRef,
}

/// A rigid part on the body or on another link.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkSpec {
    /// Its name; never [`BODY`].
    pub name: String,
    /// Where it is while its servo stands at angle 0.
    pub mount: MountSpec,
    /// What turns it; `None` for a fixed one.
    pub turn: Option<TurnSpec>,
    /// Where it is written.
    pub span: Span,
}

/// A range sensor beside the PSDs.
#[derive(Clone, Debug, PartialEq)]
pub struct RangeSpec {
    /// Name, `US_FRONT`.
    pub name: String,
    /// Number under which programs ask for it; `None`: the number that `hdt_sem.h` gives to the name.
    pub id: Option<i32>,
    /// Where it sits; x is the middle of its beam.
    pub mount: MountSpec,
    /// How it measures.
    pub model: RangeModel,
    /// Standard deviation of its noise N, a share of what it measures.
    pub sigma: f64,
    /// Mean of N.
    pub mean: f64,
    /// Where it is written.
    pub span: Span,
}

/// What range sensors in space see of an object.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Solid {
    /// Its colliders.
    #[default]
    Colliders,
    /// Its mesh; contacts stay those of the colliders. `None` as long as the mesh has not been read.
    Mesh(Option<Arc<Mesh>>),
}

/// A mesh that range sensors see as the ground.
#[derive(Clone, Debug, PartialEq)]
pub struct TerrainSpec {
    /// The mesh file and its place in the world.
    pub model: ModelSpec,
    /// Factor on the lengths of the mesh, in metres per unit of the mesh file; positive.
    pub scale: f64,
    /// The mesh in the world frame; `None` as long as it has not been read.
    pub mesh: Option<Arc<Mesh>>,
}

/// A servo of a robot, wherever its files name it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoRef<'r> {
    /// Its name.
    pub name: &'r str,
    /// Number under which programs ask for it, where the files give one.
    pub id: Option<i32>,
    /// Angles at positions 0 and 255, in radians.
    pub swing: [f64; 2],
}

impl RobiSpec {
    /// All servos: that of the steering first, then those of the companion, then the camera's. That is the order in which
    /// programs number them.
    ///
    /// Where a servo is named twice, what its own table says counts.
    pub fn all_servos(&self) -> Vec<ServoRef<'_>> {
        let camera = self.camera.iter().flat_map(|camera| [&camera.pan, &camera.tilt]);
        let joints = camera.filter_map(|joint| match joint {
            JointSpec::Servo { name, from, to } => Some((name.as_str(), [*from, *to])),
            JointSpec::Fixed(_) => None,
        });
        // Position 0 steers to the left.
        let steer = self.drive.max_steer;
        let steering = self.drive.steering.iter().map(|name| (name.as_str(), [steer, -steer]));
        let own = self.servos.iter().map(|servo| (servo.name.as_str(), [servo.from, servo.to]));
        let mut servos: Vec<ServoRef<'_>> = Vec::new();
        let mut places: BTreeSet<&str> = BTreeSet::new();
        let tables: BTreeMap<&str, &ServoSpec> = self.servos.iter().rev().map(|servo| (&*servo.name, servo)).collect();
        for (name, swing) in steering.chain(own).chain(joints) {
            if places.insert(name) {
                let table = tables.get(name);
                let swing = table.map_or(swing, |servo| [servo.from, servo.to]);
                servos.push(ServoRef { name, id: table.and_then(|servo| servo.id), swing });
            }
        }
        servos
    }
}
