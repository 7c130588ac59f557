//! Contents of a recording's channels, and the JSON schemas of eyesim's own messages, which `docs/mcap.md` documents.

use serde_json::{Map, Value, json};

use sim_core::record::Kind;

/// Content of a channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Content {
    /// Shapes of walls and bodies.
    Scene,
    /// Poses of bodies.
    Transforms,
    /// Scans of laser scanners.
    Scan,
    /// Images of cameras: colours, depths or labels.
    Image,
    /// Layers of programs that are grids.
    Grid,
    /// Layers of programs that are points or lines.
    Points,
    /// Output of programs, and messages about them.
    Log,
    /// Readings of devices by programs.
    Reading,
    /// Commands of programs to devices.
    Command,
    /// Contacts of bodies.
    Contact,
    /// Postures of legs, and footfalls.
    Walk,
    /// Messages by radio.
    Radio,
    /// Interventions in the world.
    Intervention,
}

impl Content {
    /// All contents.
    #[cfg(test)]
    pub const ALL: [Self; 13] = [
        Self::Scene,
        Self::Transforms,
        Self::Scan,
        Self::Image,
        Self::Grid,
        Self::Points,
        Self::Log,
        Self::Reading,
        Self::Command,
        Self::Contact,
        Self::Walk,
        Self::Radio,
        Self::Intervention,
    ];

    /// Name of the content's schema: Foxglove's schema if there is one.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scene => "foxglove.SceneUpdate",
            Self::Transforms => "foxglove.FrameTransforms",
            Self::Scan => "foxglove.LaserScan",
            Self::Image => "foxglove.CompressedImage",
            Self::Grid => "foxglove.Grid",
            Self::Points => "foxglove.PointCloud",
            Self::Log => "foxglove.Log",
            Self::Reading => "eyesim.Reading",
            Self::Command => "eyesim.Command",
            Self::Contact => "eyesim.Contact",
            Self::Walk => "eyesim.Walk",
            Self::Radio => "eyesim.Radio",
            Self::Intervention => "eyesim.Intervention",
        }
    }

    /// Content to which events of this kind belong; none for calls, which are not recorded, and for poses, which are
    /// recorded as transforms only.
    pub fn of(kind: Kind) -> Option<Self> {
        use Kind::*;
        Some(match kind {
            Pose | Object | Call => return None,
            Distance | Compass | Reading | Odometry | OdometrySpeed | Key | SerialReceived | Scan | Signal | Image
            | Joint | Link | BodyHeight => Self::Reading,
            DriveSpeed | DriveStraight | DriveTurn | DriveCurve | SetOdometry | ControlStarted | ControlStopped
            | Motor | Servo | Output | LcdText | LcdClear | LcdGraphics | LcdMenu | Tone | Beep | Sample
            | SerialSent | TimerAttached | TimerDetached | Gait | LegSpeed | StepHeight | LegCorrection | Forbidden => {
                Self::Command
            }
            Contact | LegContact => Self::Contact,
            Posture | Footfall => Self::Walk,
            RadioSent | RadioArrived | RadioLost | RadioReceived => Self::Radio,
            Placed | ObjectPlaced | Intervention => Self::Intervention,
            ProgramStarted | ProgramEnded | Stdout | Stderr | ProgramFailed | Reason | Hint => Self::Log,
        })
    }

    /// Returns true for a message of Foxglove, in Protocol Buffers; all other messages are JSON.
    pub fn is_foxglove(self) -> bool {
        use Content::{Grid, Image, Log, Points, Scan, Scene, Transforms};
        matches!(self, Scene | Transforms | Scan | Image | Grid | Points | Log)
    }

    /// JSON schema of one of eyesim's own message types. The messages are lines of the trace (`docs/trace.md`), whose
    /// fields depend on the event.
    pub fn schema(self) -> Value {
        let kinds: Vec<Kind> = Kind::ALL.iter().copied().filter(|kind| Self::of(*kind) == Some(self)).collect();
        let mut properties = Map::new();
        properties.insert("t_s".into(), number());
        properties.insert("robot".into(), integer());
        properties.insert("seq".into(), integer());
        let names: Vec<_> = kinds.iter().map(|kind| kind.name()).collect();
        properties.insert("event".into(), json!({ "type": "string", "enum": names }));
        for field in kinds.iter().flat_map(|kind| kind.fields()) {
            properties.insert((*field).into(), field_schema(field));
        }
        json!({
            "title": self.name(),
            "type": "object",
            "required": ["t_s", "event"],
            "properties": properties,
            "additionalProperties": false,
        })
    }
}

/// Schema of a field of events. A field whose name ends with a unit is a number, or null if there was nothing to
/// measure.
fn field_schema(field: &str) -> Value {
    const UNITS: [&str; 6] = ["_m", "_s", "_rad", "_hz", "_gain", "signal"];
    const INTEGERS: [&str; 21] = [
        "percent",
        "position",
        "value",
        "row",
        "column",
        "changed_pixels",
        "length_bytes",
        "timer",
        "object",
        "points",
        "sum_mm",
        "by",
        "frame",
        "width_px",
        "height_px",
        "message",
        "from",
        "bit_errors",
        "turns",
        "exit_code",
        "gait",
    ];
    match field {
        "data" => array(json!({ "type": "integer", "minimum": 0, "maximum": 255 })),
        "joints_rad" => array(number()),
        "to" => json!({ "type": ["integer", "null"] }),
        "with" => json!({ "type": ["string", "object"] }),
        "action" => json!({ "type": "object" }),
        _ if INTEGERS.contains(&field) => integer(),
        _ if UNITS.iter().any(|unit| field.ends_with(unit)) => json!({ "type": ["number", "null"] }),
        _ => text(),
    }
}

fn array(items: Value) -> Value {
    json!({ "type": "array", "items": items })
}

fn number() -> Value {
    json!({ "type": "number" })
}

fn integer() -> Value {
    json!({ "type": "integer" })
}

fn text() -> Value {
    json!({ "type": "string" })
}
