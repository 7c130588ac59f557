//! All that cameras can see of a scene, and where it stands at an instant.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use glam::{DVec2, DVec3};

use super::shadow::{Axes, ShadowGrid};
use super::shape::Shape;
use super::texture::{Pyramid, Wrap};
use crate::pose::Pose3;
use crate::scene::{Material, Mesh, Texture};
use crate::time::Time;
use crate::world::World;
use crate::{ObjectId, RobotId};

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Label {
    /// Nothing.
    Sky,
    /// The plane z = 0, with all that is painted on it; or the terrain in its place.
    Ground,
    /// A wall, by its place in the world file, from 0.
    Wall(u32),
    /// An object that nothing moves, by its place among all objects of the scene, from 0.
    Fixed(u32),
    /// A movable object.
    Object(ObjectId),
    /// A robot.
    Robot(RobotId),
}

/// Where a part stands: the part's frame in that of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// Always at this pose.
    Fixed(Pose3),
    /// Where the movable object stands.
    Object(ObjectId),
    /// Where the robot stands.
    Robot(RobotId),
    /// Where a part of the robot's legs is, by its place among them.
    Leg(RobotId, usize),
}

/// A part of what can be seen. Parts that look alike share their mesh.
#[derive(Clone, Debug)]
pub struct Part {
    /// Its surface, seen from both sides.
    pub mesh: Arc<Mesh>,
    /// What it is.
    pub label: Label,
    /// Where it stands.
    pub place: Place,
}

/// A light infinitely far away, the sun, and what comes from everywhere. The three shares should add up to 1: then white in
/// full light is white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Unit vector towards the sun, world frame.
    pub towards: DVec3,
    /// Share of light that reaches every surface alike.
    pub ambient: f64,
    /// Share that comes, without shadows, from the side opposite to the sun, so that surfaces in the shade differ, too.
    pub fill: f64,
    /// Share of the sun on a surface that looks straight at it.
    pub diffuse: f64,
    /// Whether what stands between the sun and a surface takes away the sun's share.
    pub shadows: bool,
}

/// Colours of the sky; between horizon and zenith they change with the sine of the elevation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Red, green, blue at the horizon and below it.
    pub horizon: [u8; 3],
    /// Straight above.
    pub zenith: [u8; 3],
}

/// The plane z = 0, seen from above.
#[derive(Clone, Debug)]
pub struct Ground {
    /// Red, green, blue around the floor, as far as the horizon.
    pub colour: [u8; 3],
    /// The world's floor.
    pub floor: Option<Floor>,
    /// What is painted on it; later ones cover earlier ones.
    pub spots: Vec<Spot>,
}

/// A rectangle on the ground with one corner in the origin.
#[derive(Clone, Debug)]
pub struct Floor {
    /// Its width (along x) and height (along y), m.
    pub size: DVec2,
    /// Red, green, blue where it has no image.
    pub colour: [u8; 3],
    /// Image stretched over it: its lower left corner is the origin.
    pub texture: Option<Arc<Texture>>,
}

/// A disc painted on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Its middle, m.
    pub centre: DVec2,
    /// Its radius, m.
    pub radius: f64,
    /// Red, green, blue and opacity.
    pub colour: [u8; 4],
}

/// All that cameras can see of a scene: immutable, and the same for all of them.
#[derive(Clone, Debug)]
pub struct Scenery {
    parts: Vec<Part>,
    /// By part the place of its mesh in `forms`.
    form: Vec<usize>,
    forms: Vec<Arc<Form>>,
    ground: Option<Ground>,
    floor: Option<Arc<Pyramid>>,
    light: Light,
    sky: Sky,
    /// What stands always in the sun's way; made when it is asked for.
    shadows: Arc<OnceLock<ShadowGrid>>,
}

/// A mesh made ready.
#[derive(Clone, Debug)]
struct Form {
    shape: Shape,
    /// By material.
    looks: Vec<Look>,
}

/// A material with its image made ready.
#[derive(Clone, Debug)]
pub(super) struct Look {
    /// Red, green, blue, 0 to 255.
    pub colour: [f32; 3],
    pub texture: Option<Arc<Pyramid>>,
    pub is_seen: bool,
}

impl Scenery {
    /// The scenery of these parts over `ground` (`None`: there is none) in this light.
    pub fn new(parts: Vec<Part>, ground: Option<Ground>, light: Light, sky: Sky) -> Self {
        let image = ground.as_ref().and_then(|ground| ground.floor.as_ref()?.texture.as_ref());
        let floor = image.map(|image| Arc::new(Pyramid::new(image, Wrap::Clamp)));
        let (form, forms, shadows) = (Vec::new(), Vec::new(), Arc::default());
        let nothing = Self { parts: Vec::new(), form, forms, ground, floor, light, sky, shadows };
        nothing.with_parts(parts)
    }

    /// This scenery with more parts behind its own; all that is made ready is shared. Parts that always stand are to be given to
    /// [`Scenery::new`]: others throw no shadows.
    pub fn with_parts(mut self, parts: Vec<Part>) -> Self {
        let mut pyramids: BTreeMap<*const Texture, Arc<Pyramid>> = BTreeMap::new();
        let known = self.parts.iter().zip(&self.form).map(|(part, form)| (Arc::as_ptr(&part.mesh), *form));
        let mut of_meshes: BTreeMap<*const Mesh, usize> = known.collect();
        for part in &parts {
            let form = *of_meshes.entry(Arc::as_ptr(&part.mesh)).or_insert_with(|| {
                self.forms.push(Arc::new(Form::new(&part.mesh, &mut pyramids)));
                self.forms.len() - 1
            });
            self.form.push(form);
        }
        self.parts.extend(parts);
        self
    }

    /// The parts.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// The ground; `None` where a part is the ground, or there is none.
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
    pub(super) fn floor(&self) -> Option<&Pyramid> {
        self.floor.as_deref()
    }

    /// The looks of a part's materials.
    pub(super) fn look(&self, part: usize, material: u32) -> &Look {
        &self.forms[self.form[part]].looks[material as usize]
    }

    /// The faces that stand always, in the way of the sun.
    pub(super) fn fixed_shadows(&self) -> &ShadowGrid {
        self.shadows.get_or_init(|| {
            let mut grid = ShadowGrid::default();
            grid.fill(self, None, &Axes::new(self.light.towards), |part| matches!(part.place, Place::Fixed(_)));
            grid
        })
    }

    /// A part's faces.
    pub(super) fn shape(&self, part: usize) -> &Shape {
        &self.forms[self.form[part]].shape
    }

    /// Where all parts stand that are there at `at`, as it was public then: not more than 100 ms before the world's present slot.
    pub fn still(&self, world: &World, at: Time) -> Still<'_> {
        let pose = |part: &Part| match part.place {
            Place::Fixed(pose) => Some(pose),
            Place::Object(object) => {
                world.is_object_there(object, at).then(|| Pose3::from_planar(&world.object_pose(object, at), 0.0))
            }
            Place::Robot(robot) => world.is_robot_there(robot, at).then(|| world.robot_pose_in_space(robot, at)),
            Place::Leg(robot, part) => world.leg_part_pose(robot, part, at).filter(|_| world.is_robot_there(robot, at)),
        };
        self.standing(self.parts.iter().map(pose).collect())
    }

    /// The parts at these poses, in their order, `None` for what is not there: those that another [`Still`] of this scenery had.
    ///
    /// # Panics
    /// If there is not a pose for each part.
    pub fn standing(&self, poses: Vec<Option<Pose3>>) -> Still<'_> {
        assert_eq!(poses.len(), self.parts.len(), "a pose for each part");
        Still { scenery: self, poses }
    }
}

/// A scenery at an instant.
#[derive(Clone, Debug)]
pub struct Still<'s> {
    scenery: &'s Scenery,
    poses: Vec<Option<Pose3>>,
}

impl<'s> Still<'s> {
    /// What can be seen.
    pub fn scenery(&self) -> &'s Scenery {
        self.scenery
    }

    /// Poses of the parts, in their order: the part's frame in that of the world. `None` for what is not there.
    pub fn poses(&self) -> &[Option<Pose3>] {
        &self.poses
    }

    /// The parts that are there, each with its place among all and its pose.
    pub fn parts(&self) -> impl Iterator<Item = (usize, &'s Part, &Pose3)> {
        let parts = self.scenery.parts.iter().zip(&self.poses).enumerate();
        parts.filter_map(|(number, (part, pose))| Some((number, part, pose.as_ref()?)))
    }
}

impl Form {
    fn new(mesh: &Mesh, pyramids: &mut BTreeMap<*const Texture, Arc<Pyramid>>) -> Self {
        let looks: Vec<Look> = mesh.materials.iter().map(|material| Look::new(material, pyramids)).collect();
        Self { shape: Shape::new(mesh, |material| looks[material as usize].is_seen), looks }
    }
}

impl Look {
    fn new(material: &Material, pyramids: &mut BTreeMap<*const Texture, Arc<Pyramid>>) -> Self {
        let texture = material.texture.as_ref().map(|texture| {
            let new = || Arc::new(Pyramid::new(texture, Wrap::Repeat));
            Arc::clone(pyramids.entry(Arc::as_ptr(texture)).or_insert_with(new))
        });
        let colour = material.colour.map(|share| 255.0 * share.clamp(0.0, 1.0));
        Self { colour, texture, is_seen: material.opacity >= 0.5 }
    }
}
