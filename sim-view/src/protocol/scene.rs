//! What there is to see in a run, and does not change with every slot.

use serde::{Deserialize, Serialize};

/// A run and all that is in it.
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
    /// Lower left and upper right corner of all that stands there.
    pub bounds_m: [[f64; 2]; 2],
    /// Images of textures.
    pub images: Vec<Image>,
    /// Surfaces; parts that look alike share one.
    pub meshes: Vec<Mesh>,
    /// What stands where.
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
    /// What can be added.
    pub workshop: Workshop,
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
    /// Unit normals of the corners, `f32`, where they are smooth: else the triangles are flat.
    pub normals: Option<String>,
    /// Texture coordinates of the corners, u to the right and v upwards, `f32`: 24 bytes a triangle.
    pub uvs: Option<String>,
    /// The materials, each for the triangles from the end of the one before.
    pub materials: Vec<Material>,
}

/// How a range of triangles looks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Material {
    /// Number of triangles that have it.
    pub triangles: u32,
    /// Its colour; that of the image is multiplied with it.
    pub colour: [u8; 3],
    /// Place of its texture in [`Scene::images`].
    pub image: Option<u32>,
}

/// A surface that stands somewhere.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Part {
    /// Place of its surface in [`Scene::meshes`].
    pub mesh: u32,
    /// Where it stands.
    pub place: Place,
}

/// Where a part stands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
#[serde(tag = "on", rename_all = "snake_case")]
pub enum Place {
    /// Always here.
    World {
        /// What it is: `wall`, `object` or `terrain`.
        what: String,
        /// Its frame in that of the world.
        at: Point,
    },
    /// On a robot, in its frame.
    Robot {
        /// Its number.
        robot: u32,
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
    /// Around the floor.
    pub colour: [u8; 3],
    /// The world's floor.
    pub floor: Option<Floor>,
    /// Discs painted on it; later ones cover earlier ones.
    pub spots: Vec<Spot>,
}

/// A rectangle with one corner in the origin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Floor {
    /// Along x and y.
    pub size_m: [f64; 2],
    /// Where it has no image.
    pub colour: [u8; 3],
    /// Place in [`Scene::images`] of what is stretched over it.
    pub image: Option<u32>,
}

/// A disc on the floor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Spot {
    /// Its middle.
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
    /// Unit vector towards it.
    pub towards: [f64; 3],
    /// Share of light from everywhere.
    pub ambient: f64,
    /// Share of the sun.
    pub diffuse: f64,
    /// Whether things throw shadows.
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

/// What is known of a robot from the start.
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
    /// Colour by which it is told from others.
    pub colour: [u8; 3],
    /// Its extent.
    pub body: Body,
    /// Its sensors.
    pub sensors: Vec<Sensor>,
    /// Its camera.
    pub camera: Option<Camera>,
    /// Its display.
    pub lcd: Lcd,
}

/// The cylinder around a body, in whose middle its frame has its origin.
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
    /// Its name, unique among the robot's.
    pub name: String,
    /// What it is.
    pub kind: SensorKind,
    /// Where it sits, in the robot's frame; x of its own frame is where it looks.
    pub mount: Option<Point>,
    /// Least and greatest distance that it measures.
    pub range_m: Option<[f64; 2]>,
    /// Half the angle of its beam; 0 for a ray.
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
    /// Where it sits, in the robot's frame; x of its own frame is where it looks, z upwards.
    pub mount: Point,
    /// Whole horizontal angle of view.
    pub horizontal_rad: f64,
    /// Whole vertical angle of view.
    pub vertical_rad: f64,
}

/// A display.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Lcd {
    /// Width and height.
    pub size_px: [u32; 2],
    /// True for the display of RoBIOS-7, which has colours and feels touches.
    pub has_colours: bool,
}

/// What is known of a movable object from the start.
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

/// What can be added to a scene.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(test, derive(ts_rs::TS))]
pub struct Workshop {
    /// Types of robots.
    pub robots: Vec<String>,
    /// Types of movable objects.
    pub objects: Vec<String>,
}
