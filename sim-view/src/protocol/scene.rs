//! Parts of a run that do not change with every slot.

use serde::{Deserialize, Serialize};

/// A run and all bodies in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Scene {
    /// Number of the run since the window was opened, from 1.
    pub run: u32,
    /// Name of the scene.
    pub title: String,
    /// Seed of the run in decimal digits: JavaScript has no integers of 64 bits.
    pub seed: String,
    /// Length of a slot.
    pub slot_s: f64,
    /// Lower left and upper right corner of the occupied area.
    pub bounds_m: [[f64; 2]; 2],
    /// Images of textures.
    pub images: Vec<Image>,
    /// Surfaces; parts that look alike share one.
    pub meshes: Vec<Mesh>,
    /// Meshes placed in the world or on bodies.
    pub parts: Vec<Part>,
    /// The floor.
    pub ground: Option<Ground>,
    /// The sun.
    pub light: Light,
    /// The sky.
    pub sky: Sky,
    /// All robots that are in the world, in order of their numbers.
    pub robots: Vec<Robot>,
    /// All movable objects that are in the world, in order of their numbers.
    pub objects: Vec<Object>,
    /// Types that can be added.
    pub addable_types: AddableTypes,
}

/// An image.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Image {
    /// Its PNG as a `data:` URL.
    pub url: String,
}

/// A surface of triangles, seen from both sides, in its own frame. Numbers are little endian, in base64.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Mesh {
    /// Three corners of each triangle, x, y and z of each in metres, `f32`: 36 bytes a triangle.
    pub positions: String,
    /// Unit normals of the corners, `f32`, if any are smooth; none if all triangles are flat.
    pub normals: Option<String>,
    /// Texture coordinates of the corners, u to the right and v upwards, `f32`: 24 bytes a triangle.
    pub uvs: Option<String>,
    /// Materials in the order of the triangles: each applies to the next [`Material::triangles`] of them.
    pub materials: Vec<Material>,
}

/// Material of a range of triangles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Material {
    /// Number of triangles that have it.
    pub triangles: u32,
    /// Colour, multiplied by the colour of the image if there is one.
    pub colour: [u8; 3],
    /// Index of its texture in [`Scene::images`].
    pub image: Option<u32>,
}

/// Mesh placed in the world or on a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Part {
    /// Index of its mesh in [`Scene::meshes`].
    pub mesh: u32,
    /// Attachment of the mesh.
    pub place: Attachment,
}

/// Attachment of a part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "on", rename_all = "snake_case")]
pub enum Attachment {
    /// Fixed in the world.
    World {
        /// Kind of the part: `wall`, `object` or `terrain`.
        what: String,
        /// Pose of its frame in the world frame.
        at: Point,
    },
    /// On a robot, in its frame.
    Robot {
        /// Its number.
        robot: u32,
    },
    /// On a link of a robot, in the link's frame.
    Link {
        /// Number of the robot.
        robot: u32,
        /// Index of the link in [`Robot::links`].
        link: u32,
    },
    /// On a movable object, in its frame.
    Object {
        /// Its number.
        object: u32,
    },
}

/// A pose in space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Point {
    /// x, y, z.
    pub position_m: [f64; 3],
    /// Quaternion x, y, z, w.
    pub rotation: [f64; 4],
}

/// The plane z = 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Ground {
    /// Colour around the floor.
    pub colour: [u8; 3],
    /// The world's floor.
    pub floor: Option<Floor>,
    /// Discs painted on the floor; later ones cover earlier ones.
    pub spots: Vec<Spot>,
}

/// A rectangle with one corner at the origin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Floor {
    /// Size along x and y.
    pub size_m: [f64; 2],
    /// Colour if it has no image.
    pub colour: [u8; 3],
    /// Index in [`Scene::images`] of the image stretched over it.
    pub image: Option<u32>,
}

/// A disc on the floor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Spot {
    /// Its centre.
    pub centre_m: [f64; 2],
    /// Its radius.
    pub radius_m: f64,
    /// Red, green, blue and opacity.
    pub colour: [u8; 4],
}

/// The sun.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Light {
    /// Unit vector towards the sun.
    pub towards: [f64; 3],
    /// Share of ambient light.
    pub ambient: f64,
    /// Share of direct sunlight.
    pub diffuse: f64,
    /// True if bodies cast shadows.
    pub shadows: bool,
}

/// Colours of the sky.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Sky {
    /// At the horizon.
    pub horizon: [u8; 3],
    /// Straight above.
    pub zenith: [u8; 3],
}

/// Constant properties of a robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Robot {
    /// Its number.
    pub id: u32,
    /// Its name.
    pub name: String,
    /// Name of its type.
    pub kind: String,
    /// Its program; empty for none.
    pub program: String,
    /// Colour that distinguishes the robot from other robots.
    pub colour: [u8; 3],
    /// Its extent.
    pub body: Body,
    /// The links of its legs, parents before children.
    pub links: Vec<Link>,
    /// Angles of its joints while it stands.
    pub standing_rad: Vec<f64>,
    /// Its sensors.
    pub sensors: Vec<Sensor>,
    /// Its camera.
    pub camera: Option<Camera>,
    /// Its display.
    pub lcd: Lcd,
}

/// A rigid part of a robot that turns about an axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Link {
    /// Index of its parent in [`Robot::links`]; none for the body.
    pub parent: Option<u32>,
    /// Pose of its frame in its parent's frame at a joint angle of 0.
    pub origin: Point,
    /// Axis of its joint through its origin, a unit vector of its frame; angles are right-handed about it.
    pub axis: [f64; 3],
    /// Index of the joint's angle in [`RobotState::joints_rad`](super::RobotState::joints_rad); none for a fixed link.
    pub joint: Option<u32>,
}

/// Cylinder around a body; its axis passes through the origin of the body's frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Body {
    /// Radius.
    pub radius_m: f64,
    /// Height above the floor.
    pub height_m: f64,
}

/// A sensor of a robot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Sensor {
    /// Its name, unique among the robot's sensors.
    pub name: String,
    /// Its kind.
    pub kind: SensorKind,
    /// Pose in the robot's frame; the sensor looks along its own x axis.
    pub mount: Option<Point>,
    /// Minimum and maximum distance that it measures.
    pub range_m: Option<[f64; 2]>,
    /// Half the angle of its beam, scan, sector or view; 0 for a ray.
    pub half_angle_rad: f64,
}

/// Kinds of sensors.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(rename_all = "snake_case")]
#[expect(missing_docs, reason = "the names say it")]
pub enum SensorKind {
    Psd,
    Laser,
    Ultrasonic,
    Reflectance,
    Sonar,
    Lidar,
    Infrared,
    Bumper,
    Compass,
    Encoder,
    Camera,
}

/// A camera of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Camera {
    /// Pose in the robot's frame; the camera looks along its own x axis, z points upwards.
    pub mount: Point,
    /// Full horizontal angle of view.
    pub horizontal_rad: f64,
    /// Full vertical angle of view.
    pub vertical_rad: f64,
}

/// A display.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Lcd {
    /// Width and height.
    pub size_px: [u32; 2],
    /// True for the display of RoBIOS-7, which has colours and a touch screen.
    pub has_colours: bool,
}

/// Constant properties of a movable object.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Object {
    /// Its number.
    pub id: u32,
    /// Name of its type.
    pub kind: String,
    /// Its extent.
    pub body: Body,
}

/// Types of bodies that can be added to a scene.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct AddableTypes {
    /// Types of robots.
    pub robots: Vec<String>,
    /// Types of movable objects.
    pub objects: Vec<String>,
}
