//! Messages of Foxglove in the wire format of Protocol Buffers, and the descriptors by which a file declares them.
//!
//! One table serves both. Messages are encoded from JSON values: an absent field is not written, and null is an
//! infinite number. Names and numbers are taken from Foxglove's schemas; fields that are never filled are omitted.
//!
//! Source: protobuf.dev, encoding; descriptor.proto.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;

/// The type of a field.
#[derive(Clone, Copy)]
enum Type {
    Double,
    Int64,
    Int32,
    Bool,
    Fixed32,
    Text,
    /// Base64 text in JSON.
    Bytes,
    Message(&'static str),
    /// An enumeration within the message, with its values.
    Enum(&'static str, &'static [&'static str]),
}

struct Field {
    name: &'static str,
    number: u32,
    kind: Type,
    is_repeated: bool,
}

const fn one(number: u32, name: &'static str, kind: Type) -> Field {
    Field { name, number, kind, is_repeated: false }
}

const fn many(number: u32, name: &'static str, kind: Type) -> Field {
    Field { name, number, kind, is_repeated: true }
}

const TIME: Type = Type::Message("google.protobuf.Timestamp");
const POSE: Type = Type::Message("foxglove.Pose");
const VECTOR: Type = Type::Message("foxglove.Vector3");
const POINT: Type = Type::Message("foxglove.Point3");
const COLOUR: Type = Type::Message("foxglove.Color");
const DELETIONS: &[&str] = &["MATCHING_ID", "ALL"];
const PACKED: Type = Type::Message("foxglove.PackedElementField");
const NUMBERS: &[&str] = &["UNKNOWN", "UINT8", "INT8", "UINT16", "INT16", "UINT32", "INT32", "FLOAT32", "FLOAT64"];
const LEVELS: &[&str] = &["UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"];

/// Fields of each message. A message's package is its name without the last word. Each of Google's messages has its own
/// file.
const MESSAGES: &[(&str, &[Field])] = &[
    ("google.protobuf.Timestamp", &[one(1, "seconds", Type::Int64), one(2, "nanos", Type::Int32)]),
    ("google.protobuf.Duration", &[one(1, "seconds", Type::Int64), one(2, "nanos", Type::Int32)]),
    ("foxglove.Vector2", &[one(1, "x", Type::Double), one(2, "y", Type::Double)]),
    ("foxglove.Vector3", &[one(1, "x", Type::Double), one(2, "y", Type::Double), one(3, "z", Type::Double)]),
    ("foxglove.Point3", &[one(1, "x", Type::Double), one(2, "y", Type::Double), one(3, "z", Type::Double)]),
    (
        "foxglove.Quaternion",
        &[one(1, "x", Type::Double), one(2, "y", Type::Double), one(3, "z", Type::Double), one(4, "w", Type::Double)],
    ),
    (
        "foxglove.Color",
        &[one(1, "r", Type::Double), one(2, "g", Type::Double), one(3, "b", Type::Double), one(4, "a", Type::Double)],
    ),
    ("foxglove.Pose", &[one(1, "position", VECTOR), one(2, "orientation", Type::Message("foxglove.Quaternion"))]),
    (
        "foxglove.SceneUpdate",
        &[
            many(1, "deletions", Type::Message("foxglove.SceneEntityDeletion")),
            many(2, "entities", Type::Message("foxglove.SceneEntity")),
        ],
    ),
    (
        "foxglove.SceneEntityDeletion",
        &[one(1, "timestamp", TIME), one(2, "type", Type::Enum("Type", DELETIONS)), one(3, "id", Type::Text)],
    ),
    (
        "foxglove.SceneEntity",
        &[
            one(1, "timestamp", TIME),
            one(2, "frame_id", Type::Text),
            one(3, "id", Type::Text),
            one(4, "lifetime", Type::Message("google.protobuf.Duration")),
            one(5, "frame_locked", Type::Bool),
            many(10, "cylinders", Type::Message("foxglove.CylinderPrimitive")),
            many(12, "triangles", Type::Message("foxglove.TriangleListPrimitive")),
            many(13, "texts", Type::Message("foxglove.TextPrimitive")),
        ],
    ),
    (
        "foxglove.CylinderPrimitive",
        &[
            one(1, "pose", POSE),
            one(2, "size", VECTOR),
            one(3, "bottom_scale", Type::Double),
            one(4, "top_scale", Type::Double),
            one(5, "color", COLOUR),
        ],
    ),
    ("foxglove.TriangleListPrimitive", &[one(1, "pose", POSE), many(2, "points", POINT), one(3, "color", COLOUR)]),
    (
        "foxglove.TextPrimitive",
        &[
            one(1, "pose", POSE),
            one(2, "billboard", Type::Bool),
            one(3, "font_size", Type::Double),
            one(4, "scale_invariant", Type::Bool),
            one(5, "color", COLOUR),
            one(6, "text", Type::Text),
        ],
    ),
    ("foxglove.FrameTransforms", &[many(1, "transforms", Type::Message("foxglove.FrameTransform"))]),
    (
        "foxglove.FrameTransform",
        &[
            one(1, "timestamp", TIME),
            one(2, "parent_frame_id", Type::Text),
            one(3, "child_frame_id", Type::Text),
            one(4, "translation", VECTOR),
            one(5, "rotation", Type::Message("foxglove.Quaternion")),
        ],
    ),
    (
        "foxglove.LaserScan",
        &[
            one(1, "timestamp", TIME),
            one(2, "frame_id", Type::Text),
            one(3, "pose", POSE),
            one(4, "start_angle", Type::Double),
            one(5, "end_angle", Type::Double),
            many(6, "ranges", Type::Double),
            many(7, "intensities", Type::Double),
        ],
    ),
    (
        "foxglove.CompressedImage",
        &[
            one(1, "timestamp", TIME),
            one(2, "data", Type::Bytes),
            one(3, "format", Type::Text),
            one(4, "frame_id", Type::Text),
        ],
    ),
    (
        "foxglove.PackedElementField",
        &[
            one(1, "name", Type::Text),
            one(2, "offset", Type::Fixed32),
            one(3, "type", Type::Enum("NumericType", NUMBERS)),
        ],
    ),
    (
        "foxglove.Grid",
        &[
            one(1, "timestamp", TIME),
            one(2, "frame_id", Type::Text),
            one(3, "pose", POSE),
            one(4, "column_count", Type::Fixed32),
            one(5, "cell_size", Type::Message("foxglove.Vector2")),
            one(6, "row_stride", Type::Fixed32),
            one(7, "cell_stride", Type::Fixed32),
            many(8, "fields", PACKED),
            one(9, "data", Type::Bytes),
        ],
    ),
    (
        "foxglove.PointCloud",
        &[
            one(1, "timestamp", TIME),
            one(2, "frame_id", Type::Text),
            one(3, "pose", POSE),
            one(4, "point_stride", Type::Fixed32),
            many(5, "fields", PACKED),
            one(6, "data", Type::Bytes),
        ],
    ),
    (
        "foxglove.Log",
        &[
            one(1, "timestamp", TIME),
            one(2, "level", Type::Enum("Level", LEVELS)),
            one(3, "message", Type::Text),
            one(4, "name", Type::Text),
            one(5, "file", Type::Text),
            one(6, "line", Type::Fixed32),
        ],
    ),
];

fn fields(message: &str) -> &'static [Field] {
    MESSAGES.iter().find(|(name, _)| *name == message).map_or(&[], |(_, fields)| fields)
}

const VARINT: u32 = 0;
const WIDE: u32 = 1;
const BYTES: u32 = 2;
const NARROW: u32 = 5;

fn varint(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

fn tag(out: &mut Vec<u8>, number: u32, wire: u32) {
    varint(out, u64::from(number << 3 | wire));
}

fn bytes(out: &mut Vec<u8>, number: u32, bytes: &[u8]) {
    tag(out, number, BYTES);
    varint(out, bytes.len() as u64);
    out.extend_from_slice(bytes);
}

impl Type {
    fn wire(self) -> u32 {
        match self {
            Self::Double => WIDE,
            Self::Fixed32 => NARROW,
            Self::Int64 | Self::Int32 | Self::Bool | Self::Enum(..) => VARINT,
            Self::Text | Self::Bytes | Self::Message(_) => BYTES,
        }
    }

    /// Number of the type in descriptor.proto.
    fn code(self) -> u64 {
        match self {
            Self::Double => 1,
            Self::Int64 => 3,
            Self::Int32 => 5,
            Self::Fixed32 => 7,
            Self::Bool => 8,
            Self::Text => 9,
            Self::Message(_) => 11,
            Self::Bytes => 12,
            Self::Enum(..) => 14,
        }
    }

    /// Appends a value without its tag.
    fn put(self, out: &mut Vec<u8>, value: &Value) {
        let mut put_bytes = |bytes: &[u8]| {
            varint(out, bytes.len() as u64);
            out.extend_from_slice(bytes);
        };
        match self {
            Self::Text => put_bytes(value.as_str().unwrap_or_default().as_bytes()),
            Self::Bytes => put_bytes(&STANDARD.decode(value.as_str().unwrap_or_default()).unwrap_or_default()),
            Self::Message(name) => put_bytes(&encode(name, value)),
            Self::Double => out.extend_from_slice(&value.as_f64().unwrap_or(f64::INFINITY).to_le_bytes()),
            Self::Fixed32 => out.extend_from_slice(&(value.as_u64().unwrap_or(0) as u32).to_le_bytes()),
            Self::Bool => varint(out, u64::from(value.as_bool().unwrap_or(false))),
            Self::Int64 | Self::Int32 | Self::Enum(..) => varint(out, value.as_i64().unwrap_or(0) as u64),
        }
    }
}

/// Encodes the message type `message`.
pub(super) fn encode(message: &str, value: &Value) -> Vec<u8> {
    let mut out = Vec::new();
    for field in fields(message) {
        let Some(value) = value.get(field.name) else { continue };
        let items = if field.is_repeated {
            value.as_array().map_or(&[][..], Vec::as_slice)
        } else {
            std::slice::from_ref(value)
        };
        if field.is_repeated && field.kind.wire() != BYTES {
            let mut packed = Vec::new();
            items.iter().for_each(|item| field.kind.put(&mut packed, item));
            bytes(&mut out, field.number, &packed);
            continue;
        }
        for item in items {
            tag(&mut out, field.number, field.kind.wire());
            field.kind.put(&mut out, item);
        }
    }
    out
}

/// The `FileDescriptorSet` of all messages: contents of a schema with the encoding `protobuf`.
pub(super) fn descriptors() -> Vec<u8> {
    const GOOGLE: &str = "google.protobuf";
    const TIMES: [(&str, &str); 2] =
        [("google/protobuf/timestamp.proto", "Timestamp"), ("google/protobuf/duration.proto", "Duration")];
    let of = |package: &str| {
        let last = |name: &'static str| name.strip_prefix(package)?.strip_prefix('.');
        MESSAGES.iter().filter_map(|(name, fields)| Some((last(name)?, *fields))).collect::<Vec<_>>()
    };
    let mut set = Vec::new();
    for (path, message) in TIMES {
        let messages: Vec<_> = of(GOOGLE).into_iter().filter(|(name, _)| *name == message).collect();
        bytes(&mut set, 1, &file(path, GOOGLE, &[], &messages));
    }
    bytes(&mut set, 1, &file("foxglove/messages.proto", "foxglove", &TIMES.map(|(path, _)| path), &of("foxglove")));
    set
}

/// Encodes a `FileDescriptorProto`.
fn file(name: &str, package: &str, dependencies: &[&str], messages: &[(&str, &[Field])]) -> Vec<u8> {
    let mut out = Vec::new();
    bytes(&mut out, 1, name.as_bytes());
    bytes(&mut out, 2, package.as_bytes());
    dependencies.iter().for_each(|dependency| bytes(&mut out, 3, dependency.as_bytes()));
    for (name, fields) in messages {
        bytes(&mut out, 4, &descriptor(package, name, fields));
    }
    bytes(&mut out, 12, b"proto3");
    out
}

/// Encodes a `DescriptorProto`.
fn descriptor(package: &str, message: &str, fields: &[Field]) -> Vec<u8> {
    let mut out = Vec::new();
    bytes(&mut out, 1, message.as_bytes());
    for Field { name, number, kind, is_repeated } in fields {
        let mut field = Vec::new();
        bytes(&mut field, 1, name.as_bytes());
        for (index, value) in [(3, u64::from(*number)), (4, if *is_repeated { 3 } else { 1 }), (5, kind.code())] {
            tag(&mut field, index, VARINT);
            varint(&mut field, value);
        }
        match kind {
            Type::Message(of) => bytes(&mut field, 6, format!(".{of}").as_bytes()),
            Type::Enum(of, _) => bytes(&mut field, 6, format!(".{package}.{message}.{of}").as_bytes()),
            _ => {}
        }
        bytes(&mut out, 2, &field);
    }
    for Field { kind, .. } in fields {
        if let Type::Enum(name, values) = kind {
            bytes(&mut out, 4, &enumeration(name, values));
        }
    }
    out
}

/// Encodes an `EnumDescriptorProto`.
fn enumeration(name: &str, values: &[&str]) -> Vec<u8> {
    let mut out = Vec::new();
    bytes(&mut out, 1, name.as_bytes());
    for (number, name) in (0..).zip(values) {
        let mut value = Vec::new();
        bytes(&mut value, 1, name.as_bytes());
        tag(&mut value, 2, VARINT);
        varint(&mut value, number);
        bytes(&mut out, 2, &value);
    }
    out
}

/// Decodes the message type `message` into JSON values, without absent fields.
///
/// # Panics
/// If the bytes do not encode such a message.
#[cfg(test)]
pub(super) fn decode(message: &str, mut rest: &[u8]) -> Value {
    let mut object = serde_json::Map::new();
    for field in fields(message).iter().filter(|field| field.is_repeated) {
        object.insert(field.name.into(), Value::Array(vec![]));
    }
    while !rest.is_empty() {
        let tag = take_varint(&mut rest) as u32;
        let field = fields(message).iter().find(|field| field.number == tag >> 3).expect("a field of the message");
        let is_packed = field.is_repeated && field.kind.wire() != BYTES;
        assert_eq!(tag & 7, if is_packed { BYTES } else { field.kind.wire() }, "{}", field.name);
        let mut values = Vec::new();
        if is_packed {
            let mut packed = take_bytes(&mut rest);
            while !packed.is_empty() {
                values.push(take(field.kind, &mut packed));
            }
        } else {
            values.push(take(field.kind, &mut rest));
        }
        match object.get_mut(field.name) {
            Some(Value::Array(list)) => list.append(&mut values),
            _ => drop(object.insert(field.name.into(), values.remove(0))),
        }
    }
    Value::Object(object)
}

#[cfg(test)]
fn take(kind: Type, rest: &mut &[u8]) -> Value {
    match kind {
        Type::Double => {
            let (number, others) = rest.split_first_chunk::<8>().expect("8 bytes");
            *rest = others;
            f64::from_le_bytes(*number).into()
        }
        Type::Fixed32 => {
            let (number, others) = rest.split_first_chunk::<4>().expect("4 bytes");
            *rest = others;
            u32::from_le_bytes(*number).into()
        }
        Type::Int64 | Type::Int32 | Type::Enum(..) => take_varint(rest).into(),
        Type::Bool => (take_varint(rest) == 1).into(),
        Type::Text => String::from_utf8(take_bytes(rest).to_vec()).expect("UTF-8").into(),
        Type::Bytes => STANDARD.encode(take_bytes(rest)).into(),
        Type::Message(name) => decode(name, take_bytes(rest)),
    }
}

#[cfg(test)]
fn take_varint(rest: &mut &[u8]) -> u64 {
    let mut value = 0;
    for shift in (0..64).step_by(7) {
        let (byte, others) = rest.split_first().expect("a byte");
        *rest = others;
        value |= u64::from(byte & 0x7f) << shift;
        if byte & 0x80 == 0 {
            break;
        }
    }
    value
}

#[cfg(test)]
fn take_bytes<'a>(rest: &mut &'a [u8]) -> &'a [u8] {
    let length = take_varint(rest) as usize;
    let (bytes, others) = rest.split_at(length);
    *rest = others;
    bytes
}
