//! Forms of what sensors see and where they sit: links, range sensors, surfaces, terrain.

use schemars::JsonSchema;
use serde::Serialize;

use super::{AxisForm, Number};

/// How a surface reflects.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SurfaceForm {
    /// Share of the energy that comes back, 0 to 1; 1 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub(crate) reflectivity: Option<Number>,
    /// Share of that which is reflected as by a mirror, 0 to 1; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1.0))]
    pub(crate) specular: Option<Number>,
}

/// Ground that is not the plane.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(untagged)]
pub(crate) enum TerrainForm {
    /// A mesh file whose unit is 1 m and whose origin is that of the world.
    File(String),
    /// A mesh file with its place in the world.
    Placed(PlacedTerrainForm),
    /// A grey image.
    Image(ImageTerrainForm),
    /// A function with a seed.
    Function(FunctionTerrainForm),
    /// Stairs and blocks.
    Steps(StepsTerrainForm),
}

/// Ground as high as a grey image is bright.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct ImageTerrainForm {
    /// The image file: a grey png of 8 or 16 bits. The middles of its pixels are the corners of the terrain's cells.
    pub(crate) image: String,
    /// Place of the lower left corner in mm, and height of black; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) offset_mm: Option<[Number; 3]>,
    /// Width along x and along y in mm; that of the floor if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) size_mm: Option<[Number; 2]>,
    /// As much higher than black is white, in mm.
    pub(crate) height_mm: Number,
}

/// Ground that is drawn from a seed: a smooth relief, with or without boulders.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct FunctionTerrainForm {
    /// What is drawn.
    pub(crate) function: FunctionForm,
    /// What it is drawn from; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 9_223_372_036_854_775_807_u64))]
    pub(crate) seed: Option<u64>,
    /// Place of the lower left corner in mm, and height of the lowest ground; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) offset_mm: Option<[Number; 3]>,
    /// Width along x and along y in mm; that of the floor if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) size_mm: Option<[Number; 2]>,
    /// Greatest side of a cell in mm; 50 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) cell_mm: Option<Number>,
    /// From the lowest to the highest place of the smooth relief in mm; 100 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) relief_mm: Option<Number>,
    /// Length of the longest hills in mm; 2000 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) length_mm: Option<Number>,
    /// Number of boulders; 40 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 100_000))]
    pub(crate) boulders: Option<u32>,
    /// Least and greatest half length of a boulder in mm; 100 and 400 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) radius_mm: Option<[Number; 2]>,
    /// Least and greatest height of a boulder in mm; 50 and 300 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) height_mm: Option<[Number; 2]>,
    /// Discs in which the ground is level and low.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) clear: Vec<DiscForm>,
}

/// A function of places and a seed.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum FunctionForm {
    /// A smooth relief.
    Hills,
    /// The same with boulders.
    Boulders,
}

/// A disc of level ground.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct DiscForm {
    /// Its middle along x in mm.
    pub(crate) x_mm: Number,
    /// Its middle along y in mm.
    pub(crate) y_mm: Number,
    /// Its radius in mm.
    pub(crate) radius_mm: Number,
}

/// Level ground with stairs and blocks.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct StepsTerrainForm {
    /// Place of the lower left corner in mm, and height of the ground; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) offset_mm: Option<[Number; 3]>,
    /// Width along x and along y in mm; that of the floor if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) size_mm: Option<[Number; 2]>,
    /// Flights of stairs; may be left out beside blocks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) stairs: Option<Vec<StairsForm>>,
    /// Single blocks.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub(crate) block: Vec<BlockForm>,
}

/// A flight of stairs.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct StairsForm {
    /// Middle of the foot of the first step, x and y in mm.
    pub(crate) from_mm: [Number; 2],
    /// The way up: 0, 90, 180 or 270 degrees; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) direction_deg: Option<Number>,
    /// Number of steps.
    #[schemars(range(min = 1, max = 1000))]
    pub(crate) count: u32,
    /// Height of each in mm.
    pub(crate) step_height_mm: Number,
    /// Depth of each in mm.
    pub(crate) step_depth_mm: Number,
    /// Width across the way in mm.
    pub(crate) width_mm: Number,
    /// Depth of the uppermost in mm; that of the others if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) landing_mm: Option<Number>,
    /// Whether as many steps go down again behind it; no if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) down: Option<bool>,
}

/// A block with level top and vertical sides.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct BlockForm {
    /// One corner, x and y in mm.
    pub(crate) from_mm: [Number; 2],
    /// The opposite one, x and y in mm.
    pub(crate) to_mm: [Number; 2],
    /// Its height above the ground in mm.
    pub(crate) height_mm: Number,
}

/// A mesh file with its place in the world.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlacedTerrainForm {
    /// The mesh file.
    pub(crate) file: String,
    /// Place of the mesh's origin in the world in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) offset_mm: Option<[Number; 3]>,
    /// Turns about the axes of the mesh file, in degrees; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) turns_deg: Option<[Number; 3]>,
    /// Length of the mesh's unit in mm; 1000 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) scale_mm: Option<Number>,
}

/// What range sensors in space see of an object.
#[derive(Clone, Copy, Debug, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub(crate) enum SolidForm {
    /// Its colliders.
    #[allow(dead_code, reason = "the default is left out in print")]
    Colliders,
    /// Its mesh; contacts stay those of the colliders.
    Mesh,
}

/// Where something sits, and how it is turned: keys of links and sensors.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub(crate) struct MountForm {
    /// The link that it sits on; `body` if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) on: Option<String>,
    /// Place forward in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) x_mm: Option<Number>,
    /// Place to the left in mm; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) y_mm: Option<Number>,
    /// Place upwards in mm; of a laser scanner 100 if left out, else 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) z_mm: Option<Number>,
    /// Turn about x, the left side upwards, in degrees; the first of the three turns; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) roll_deg: Option<Number>,
    /// Turn upwards in degrees, the second; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) pitch_deg: Option<Number>,
    /// Turn to the left in degrees, the third; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) yaw_deg: Option<Number>,
}

/// A rigid part on the body or on another link; a servo may turn it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct LinkForm {
    /// Its name, by which sensors and links sit on it.
    pub(crate) name: String,
    #[serde(flatten)]
    pub(crate) mount: MountForm,
    /// Axis that the servo turns it about: x rolls, y pitches (upwards), z, if left out, yaws.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) axis: Option<AxisForm>,
    /// The servo whose angle it has; a fixed link if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) servo: Option<String>,
}

/// A range sensor with one ray: a laser, an ultrasonic or a reflectance sensor.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct EchoForm {
    /// Its name, such as `LASER_FRONT`.
    pub(crate) name: String,
    /// Its number for programs; that of `hdt_sem.h` if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) id: Option<i32>,
    #[serde(flatten)]
    pub(crate) mount: MountForm,
    /// Least distance in mm; of an ultrasonic sensor 100 if left out, else 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e9))]
    pub(crate) min_mm: Option<Number>,
    /// Greatest distance in mm; of a laser 2000 if left out, else 1000.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 1e9))]
    pub(crate) max_mm: Option<Number>,
    /// Greatest angle of incidence in degrees; of a laser 45 if left out, of an ultrasonic sensor 15, else 90.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 90.0))]
    pub(crate) incidence_deg: Option<Number>,
    /// Standard deviation of its noise, a share of what it measures; 0.01 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub(crate) sigma: Option<Number>,
    /// Mean of its noise, a share of what it measures; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1000.0, max = 1000.0))]
    pub(crate) mean: Option<Number>,
}

/// A sonar: an ultrasonic sensor with a beam.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SonarForm {
    /// Its name, such as `SONAR_FRONT`.
    pub(crate) name: String,
    /// Its number for programs; that of `hdt_sem.h` if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) id: Option<i32>,
    /// The device whose values it has where it says nothing else; `SRF08` if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) preset: Option<SonarPresetForm>,
    #[serde(flatten)]
    pub(crate) mount: MountForm,
    /// Least distance in mm; that of the preset if left out: 30.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e9))]
    pub(crate) min_mm: Option<Number>,
    /// Greatest distance in mm; that of the preset if left out: 6000.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.001, max = 1e9))]
    pub(crate) max_mm: Option<Number>,
    /// Half of the beam's angle in degrees, where it has fallen by 6 dB; that of the preset if left out: 27.5.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.1, max = 90.0))]
    pub(crate) half_angle_deg: Option<Number>,
    /// A ring of sensitivity around the main lobe; none if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) side_lobes: Option<SideLobesForm>,
    /// Least energy of an echo that it notices, in units of what a perfect reflector 1 m ahead returns; that of the preset if
    /// left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1e9))]
    pub(crate) threshold: Option<Number>,
    /// The bus that it is on, which has room for 16; 1 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 100))]
    pub(crate) bus: Option<u32>,
    /// Rays of its fan; that of the preset if left out: 64.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 4096))]
    pub(crate) rays: Option<u32>,
    /// Standard deviation of its noise, a share of what it measures; 0.01 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0, max = 1000.0))]
    pub(crate) sigma: Option<Number>,
    /// Mean of its noise, a share of what it measures; 0 if left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = -1000.0, max = 1000.0))]
    pub(crate) mean: Option<Number>,
}

/// Sonars whose values are known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub(crate) enum SonarPresetForm {
    /// The SRF08 by Devantech.
    #[serde(rename = "SRF08")]
    #[allow(dead_code, reason = "what it stands for is left out in print")]
    Srf08,
}

/// A ring of sensitivity around the main lobe of a sonar.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SideLobesForm {
    /// Angle between the line of sight and the middle of the ring in degrees.
    #[schemars(range(min = 0.0, max = 90.0))]
    pub(crate) angle_deg: Number,
    /// Half of the ring's width in degrees, where it has fallen by 6 dB from its middle.
    #[schemars(range(min = 0.01, max = 90.0))]
    pub(crate) half_width_deg: Number,
    /// Gain in the middle of the ring, against 1 for the main lobe.
    #[schemars(range(min = 0.0, max = 1.0))]
    pub(crate) gain: Number,
}
