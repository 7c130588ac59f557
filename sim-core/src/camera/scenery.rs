//! Scenery: everything that cameras can see of a scene, and the poses of its parts at an instant.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use glam::{DVec2, DVec3};

use super::render_mesh::RenderMesh;
use super::shadow::{Axes, ShadowGrid};
use super::texture::{MipMap, Wrap};
use crate::pose::Pose3;
use crate::scene::{Material, Mesh, Texture};
use crate::time::Time;
use crate::world::World;
use crate::{ObjectId, RobotId};

/// Class and id of the surface that a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Label {
    /// The sky: no surface.
    Sky,
    /// The plane z = 0 with everything painted on it, or the terrain.
    Ground,
    /// A wall, by its index in the world file, from 0.
    Wall(u32),
    /// A fixed object, by its index among all objects of the scene, from 0.
    Fixed(u32),
    /// A movable object.
    Object(ObjectId),
    /// A robot.
    Robot(RobotId),
}

/// The frame in which the mesh of a part is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Attachment {
    /// Fixed at this pose in the world.
    Fixed(Pose3),
    /// Attached to a movable object.
    Object(ObjectId),
    /// Attached to a robot's body.
    Robot(RobotId),
    /// Attached to a part of a robot's legs, by index.
    Leg(RobotId, usize),
}

/// A visible part of a scene. Parts of equal appearance share their mesh.
#[derive(Clone, Debug)]
pub struct Part {
    /// Its mesh, visible from both sides.
    pub mesh: Arc<Mesh>,
    /// Its label in label pictures.
    pub label: Label,
    /// Frame of its mesh.
    pub attachment: Attachment,
}

/// Directional light of the sun, infinitely far away, and ambient light. The three fractions should add up to 1, so
/// that white in full light is white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Unit vector towards the sun, world frame.
    pub sun_direction: DVec3,
    /// Fraction of light that reaches every surface equally.
    pub ambient: f64,
    /// Fraction of light from the side opposite to the sun. It casts no shadows; faces in shadow thus differ in
    /// brightness.
    pub fill: f64,
    /// Fraction of light from the sun, for a surface that faces it directly.
    pub diffuse: f64,
    /// If true, surfaces in shadow do not receive the sun's light.
    pub shadows: bool,
}

/// Colours of the sky, interpolated between horizon and zenith with the sine of the elevation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Red, green, blue at the horizon and below it.
    pub horizon: [u8; 3],
    /// Red, green, blue at the zenith.
    pub zenith: [u8; 3],
}

/// The plane z = 0, visible from above.
#[derive(Clone, Debug)]
pub struct Ground {
    /// Red, green, blue outside the floor, as far as the horizon.
    pub colour: [u8; 3],
    /// The world's floor.
    pub floor: Option<Floor>,
    /// Discs painted on the ground; later ones cover earlier ones.
    pub spots: Vec<Spot>,
}

/// A rectangle on the ground with its lower left corner at the origin.
#[derive(Clone, Debug)]
pub struct Floor {
    /// Its width (along x) and height (along y), m.
    pub size: DVec2,
    /// Red, green, blue where no image covers it.
    pub colour: [u8; 3],
    /// Image stretched over the floor, with its lower left corner at the origin.
    pub texture: Option<Arc<Texture>>,
}

/// A disc painted on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Centre, m.
    pub centre: DVec2,
    /// Radius, m.
    pub radius: f64,
    /// Red, green, blue and opacity.
    pub colour: [u8; 4],
}

/// Everything that cameras can see of a scene: immutable, and shared by all cameras.
#[derive(Clone, Debug)]
pub struct Scenery {
    parts: Vec<Part>,
    /// For each part, the index of its mesh in `meshes`.
    mesh_of: Vec<usize>,
    meshes: Vec<Arc<PreparedMesh>>,
    ground: Option<Ground>,
    floor: Option<Arc<MipMap>>,
    light: Light,
    sky: Sky,
    /// Shadow casters that never move; lazily initialised.
    shadows: Arc<OnceLock<ShadowGrid>>,
}

/// A mesh prepared for rendering.
#[derive(Clone, Debug)]
struct PreparedMesh {
    render_mesh: RenderMesh,
    /// One entry per material.
    materials: Vec<PreparedMaterial>,
}

/// A material prepared for rendering.
#[derive(Clone, Debug)]
pub(super) struct PreparedMaterial {
    /// Red, green, blue, 0 to 255.
    pub colour: [f32; 3],
    pub texture: Option<Arc<MipMap>>,
    pub is_visible: bool,
}

impl Scenery {
    /// The scenery of these parts over `ground` (`None` without ground) in this light.
    pub fn new(parts: Vec<Part>, ground: Option<Ground>, light: Light, sky: Sky) -> Self {
        let image = ground.as_ref().and_then(|ground| ground.floor.as_ref()?.texture.as_ref());
        let floor = image.map(|image| Arc::new(MipMap::new(image, Wrap::Clamp)));
        let (mesh_of, meshes, shadows) = (Vec::new(), Vec::new(), Arc::default());
        let empty = Self { parts: Vec::new(), mesh_of, meshes, ground, floor, light, sky, shadows };
        empty.with_parts(parts)
    }

    /// This scenery with more parts; shares all prepared data. Fixed parts must be given to [`Scenery::new`], because
    /// appended fixed parts cast no shadows.
    pub fn with_parts(mut self, parts: Vec<Part>) -> Self {
        let mut mip_maps: BTreeMap<*const Texture, Arc<MipMap>> = BTreeMap::new();
        let mesh_indices = self.parts.iter().zip(&self.mesh_of).map(|(part, mesh)| (Arc::as_ptr(&part.mesh), *mesh));
        let mut mesh_indices: BTreeMap<*const Mesh, usize> = mesh_indices.collect();
        for part in &parts {
            let mesh = *mesh_indices.entry(Arc::as_ptr(&part.mesh)).or_insert_with(|| {
                self.meshes.push(Arc::new(PreparedMesh::new(&part.mesh, &mut mip_maps)));
                self.meshes.len() - 1
            });
            self.mesh_of.push(mesh);
        }
        self.parts.extend(parts);
        self
    }

    /// The parts.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// The ground; `None` without ground, and if the ground is one of the parts.
    pub fn ground(&self) -> Option<&Ground> {
        self.ground.as_ref()
    }

    /// The light.
    pub fn light(&self) -> &Light {
        &self.light
    }

    /// The sky.
    pub fn sky(&self) -> &Sky {
        &self.sky
    }

    /// The image on the floor.
    pub(super) fn floor(&self) -> Option<&MipMap> {
        self.floor.as_deref()
    }

    /// A prepared material of a part.
    pub(super) fn prepared_material(&self, part: usize, material: u32) -> &PreparedMaterial {
        &self.meshes[self.mesh_of[part]].materials[material as usize]
    }

    /// Shadow casters that never move.
    pub(super) fn fixed_shadows(&self) -> &ShadowGrid {
        self.shadows.get_or_init(|| {
            let mut grid = ShadowGrid::default();
            grid.fill(self, None, &Axes::new(self.light.sun_direction), |part| {
                matches!(part.attachment, Attachment::Fixed(_))
            });
            grid
        })
    }

    /// The prepared faces of a part.
    pub(super) fn render_mesh(&self, part: usize) -> &RenderMesh {
        &self.meshes[self.mesh_of[part]].render_mesh
    }

    /// The scenery with the published poses of all parts that are present at `at`, which is at most 100 ms before the
    /// world's current slot.
    pub fn pose_at(&self, world: &World, at: Time) -> PosedScenery<'_> {
        let pose = |part: &Part| match part.attachment {
            Attachment::Fixed(pose) => Some(pose),
            Attachment::Object(object) => {
                world.is_object_present(object, at).then(|| Pose3::from_planar(&world.object_pose(object, at), 0.0))
            }
            Attachment::Robot(robot) => world.is_robot_present(robot, at).then(|| world.robot_pose_in_space(robot, at)),
            Attachment::Leg(robot, part) => {
                world.leg_part_pose(robot, part, at).filter(|_| world.is_robot_present(robot, at))
            }
        };
        self.with_poses(self.parts.iter().map(pose).collect())
    }

    /// The scenery with the given poses of its parts, `None` for an absent part; for example the poses of another
    /// [`PosedScenery`] of this scenery.
    ///
    /// # Panics
    /// If the number of poses differs from the number of parts.
    pub fn with_poses(&self, poses: Vec<Option<Pose3>>) -> PosedScenery<'_> {
        assert_eq!(poses.len(), self.parts.len(), "a pose for each part");
        PosedScenery { scenery: self, poses }
    }
}

/// A scenery at an instant.
#[derive(Clone, Debug)]
pub struct PosedScenery<'s> {
    scenery: &'s Scenery,
    poses: Vec<Option<Pose3>>,
}

impl<'s> PosedScenery<'s> {
    /// The scenery.
    pub fn scenery(&self) -> &'s Scenery {
        self.scenery
    }

    /// Poses of the parts in the world frame, in the order of the parts; `None` for an absent part.
    pub fn poses(&self) -> &[Option<Pose3>] {
        &self.poses
    }

    /// The present parts, each with its index among all parts and its pose.
    pub fn parts(&self) -> impl Iterator<Item = (usize, &'s Part, &Pose3)> {
        let parts = self.scenery.parts.iter().zip(&self.poses).enumerate();
        parts.filter_map(|(number, (part, pose))| Some((number, part, pose.as_ref()?)))
    }
}

impl PreparedMesh {
    fn new(mesh: &Mesh, mip_maps: &mut BTreeMap<*const Texture, Arc<MipMap>>) -> Self {
        let materials: Vec<PreparedMaterial> =
            mesh.materials.iter().map(|material| PreparedMaterial::new(material, mip_maps)).collect();
        Self { render_mesh: RenderMesh::new(mesh, |material| materials[material as usize].is_visible), materials }
    }
}

impl PreparedMaterial {
    fn new(material: &Material, mip_maps: &mut BTreeMap<*const Texture, Arc<MipMap>>) -> Self {
        let texture = material.texture.as_ref().map(|texture| {
            let new = || Arc::new(MipMap::new(texture, Wrap::Repeat));
            Arc::clone(mip_maps.entry(Arc::as_ptr(texture)).or_insert_with(new))
        });
        let colour = material.colour.map(|channel| 255.0 * channel.clamp(0.0, 1.0));
        Self { colour, texture, is_visible: material.opacity >= 0.5 }
    }
}
