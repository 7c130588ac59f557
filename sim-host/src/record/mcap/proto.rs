//! Messages of Foxglove in the wire format of Protocol Buffers, and their descriptors, which a recording contains.
//!
//! One table is the source of both. Messages are encoded from JSON values: an absent field is not written, and null is
//! an infinite number. Names and numbers are taken from Foxglove's schemas; fields that are never filled are omitted.
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

const fn single(number: u32, name: &'static str, kind: Type) -> Field {
    Field { name, number, kind, is_repeated: false }
}

const fn repeated(number: u32, name: &'static str, kind: Type) -> Field {
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

/// Fields of each message. The package of a message is its name without the last component. Each of Google's messages
/// has its own file.
const MESSAGES: &[(&str, &[Field])] = &[
    ("google.protobuf.Timestamp", &[single(1, "seconds", Type::Int64), single(2, "nanos", Type::Int32)]),
    ("google.protobuf.Duration", &[single(1, "seconds", Type::Int64), single(2, "nanos", Type::Int32)]),
    ("foxglove.Vector2", &[single(1, "x", Type::Double), single(2, "y", Type::Double)]),
    ("foxglove.Vector3", &[single(1, "x", Type::Double), single(2, "y", Type::Double), single(3, "z", Type::Double)]),
    ("foxglove.Point3", &[single(1, "x", Type::Double), single(2, "y", Type::Double), single(3, "z", Type::Double)]),
    (
        "foxglove.Quaternion",
        &[
            single(1, "x", Type::Double),
            single(2, "y", Type::Double),
            single(3, "z", Type::Double),
            single(4, "w", Type::Double),
        ],
    ),
    (
        "foxglove.Color",
        &[
            single(1, "r", Type::Double),
            single(2, "g", Type::Double),
            single(3, "b", Type::Double),
            single(4, "a", Type::Double),
        ],
    ),
    ("foxglove.Pose", &[single(1, "position", VECTOR), single(2, "orientation", Type::Message("foxglove.Quaternion"))]),
    (
        "foxglove.SceneUpdate",
        &[
            repeated(1, "deletions", Type::Message("foxglove.SceneEntityDeletion")),
            repeated(2, "entities", Type::Message("foxglove.SceneEntity")),
        ],
    ),
    (
        "foxglove.SceneEntityDeletion",
        &[single(1, "timestamp", TIME), single(2, "type", Type::Enum("Type", DELETIONS)), single(3, "id", Type::Text)],
    ),
    (
        "foxglove.SceneEntity",
        &[
            single(1, "timestamp", TIME),
            single(2, "frame_id", Type::Text),
            single(3, "id", Type::Text),
            single(4, "lifetime", Type::Message("google.protobuf.Duration")),
            single(5, "frame_locked", Type::Bool),
            repeated(10, "cylinders", Type::Message("foxglove.CylinderPrimitive")),
            repeated(12, "triangles", Type::Message("foxglove.TriangleListPrimitive")),
            repeated(13, "texts", Type::Message("foxglove.TextPrimitive")),
        ],
    ),
    (
        "foxglove.CylinderPrimitive",
        &[
            single(1, "pose", POSE),
            single(2, "size", VECTOR),
            single(3, "bottom_scale", Type::Double),
            single(4, "top_scale", Type::Double),
            single(5, "color", COLOUR),
        ],
    ),
    (
        "foxglove.TriangleListPrimitive",
        &[single(1, "pose", POSE), repeated(2, "points", POINT), single(3, "color", COLOUR)],
    ),
    (
        "foxglove.TextPrimitive",
        &[
            single(1, "pose", POSE),
            single(2, "billboard", Type::Bool),
            single(3, "font_size", Type::Double),
            single(4, "scale_invariant", Type::Bool),
            single(5, "color", COLOUR),
            single(6, "text", Type::Text),
        ],
    ),
    ("foxglove.FrameTransforms", &[repeated(1, "transforms", Type::Message("foxglove.FrameTransform"))]),
    (
        "foxglove.FrameTransform",
        &[
            single(1, "timestamp", TIME),
            single(2, "parent_frame_id", Type::Text),
            single(3, "child_frame_id", Type::Text),
            single(4, "translation", VECTOR),
            single(5, "rotation", Type::Message("foxglove.Quaternion")),
        ],
    ),
    (
        "foxglove.LaserScan",
        &[
            single(1, "timestamp", TIME),
            single(2, "frame_id", Type::Text),
            single(3, "pose", POSE),
            single(4, "start_angle", Type::Double),
            single(5, "end_angle", Type::Double),
            repeated(6, "ranges", Type::Double),
            repeated(7, "intensities", Type::Double),
        ],
    ),
    (
        "foxglove.CompressedImage",
        &[
            single(1, "timestamp", TIME),
            single(2, "data", Type::Bytes),
            single(3, "format", Type::Text),
            single(4, "frame_id", Type::Text),
        ],
    ),
    (
        "foxglove.PackedElementField",
        &[
            single(1, "name", Type::Text),
            single(2, "offset", Type::Fixed32),
            single(3, "type", Type::Enum("NumericType", NUMBERS)),
        ],
    ),
    (
        "foxglove.Grid",
        &[
            single(1, "timestamp", TIME),
            single(2, "frame_id", Type::Text),
            single(3, "pose", POSE),
            single(4, "column_count", Type::Fixed32),
            single(5, "cell_size", Type::Message("foxglove.Vector2")),
            single(6, "row_stride", Type::Fixed32),
            single(7, "cell_stride", Type::Fixed32),
            repeated(8, "fields", PACKED),
            single(9, "data", Type::Bytes),
        ],
    ),
    (
        "foxglove.PointCloud",
        &[
            single(1, "timestamp", TIME),
            single(2, "frame_id", Type::Text),
            single(3, "pose", POSE),
            single(4, "point_stride", Type::Fixed32),
            repeated(5, "fields", PACKED),
            single(6, "data", Type::Bytes),
        ],
    ),
    (
        "foxglove.Log",
        &[
            single(1, "timestamp", TIME),
            single(2, "level", Type::Enum("Level", LEVELS)),
            single(3, "message", Type::Text),
            single(4, "name", Type::Text),
            single(5, "file", Type::Text),
            single(6, "line", Type::Fixed32),
        ],
    ),
];

fn fields(message: &str) -> &'static [Field] {
    MESSAGES.iter().find(|(name, _)| *name == message).map_or(&[], |(_, fields)| fields)
}

// Wire types.
const VARINT: u32 = 0;
const I64: u32 = 1;
const LEN: u32 = 2;
const I32: u32 = 5;

fn varint(out: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        out.push(value as u8 | 0x80);
        value >>= 7;
    }
    out.push(value as u8);
}

fn tag(out: &mut Vec<u8>, number: u32, wire_type: u32) {
    varint(out, u64::from(number << 3 | wire_type));
}

fn bytes_field(out: &mut Vec<u8>, number: u32, bytes: &[u8]) {
    tag(out, number, LEN);
    varint(out, bytes.len() as u64);
    out.extend_from_slice(bytes);
}

impl Type {
    fn wire_type(self) -> u32 {
        match self {
            Self::Double => I64,
            Self::Fixed32 => I32,
            Self::Int64 | Self::Int32 | Self::Bool | Self::Enum(..) => VARINT,
            Self::Text | Self::Bytes | Self::Message(_) => LEN,
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

    /// Appends `value` without a tag.
    fn append(self, out: &mut Vec<u8>, value: &Value) {
        let mut append_bytes = |bytes: &[u8]| {
            varint(out, bytes.len() as u64);
            out.extend_from_slice(bytes);
        };
        match self {
            Self::Text => append_bytes(value.as_str().unwrap_or_default().as_bytes()),
            Self::Bytes => append_bytes(&STANDARD.decode(value.as_str().unwrap_or_default()).unwrap_or_default()),
            Self::Message(name) => append_bytes(&encode(name, value)),
            Self::Double => out.extend_from_slice(&value.as_f64().unwrap_or(f64::INFINITY).to_le_bytes()),
            Self::Fixed32 => out.extend_from_slice(&(value.as_u64().unwrap_or(0) as u32).to_le_bytes()),
            Self::Bool => varint(out, u64::from(value.as_bool().unwrap_or(false))),
            Self::Int64 | Self::Int32 | Self::Enum(..) => varint(out, value.as_i64().unwrap_or(0) as u64),
        }
    }
}

/// Encodes `value` as a message of type `message`.
pub(super) fn encode(message: &str, value: &Value) -> Vec<u8> {
    let mut out = Vec::new();
    for field in fields(message) {
        let Some(value) = value.get(field.name) else { continue };
        let items = if field.is_repeated {
            value.as_array().map_or(&[][..], Vec::as_slice)
        } else {
            std::slice::from_ref(value)
        };
        if field.is_repeated && field.kind.wire_type() != LEN {
            let mut packed = Vec::new();
            items.iter().for_each(|item| field.kind.append(&mut packed, item));
            bytes_field(&mut out, field.number, &packed);
            continue;
        }
        for item in items {
            tag(&mut out, field.number, field.kind.wire_type());
            field.kind.append(&mut out, item);
        }
    }
    out
}

/// The `FileDescriptorSet` of all messages: contents of a schema with the encoding `protobuf`.
pub(super) fn descriptors() -> Vec<u8> {
    const GOOGLE: &str = "google.protobuf";
    const TIMES: [(&str, &str); 2] =
        [("google/protobuf/timestamp.proto", "Timestamp"), ("google/protobuf/duration.proto", "Duration")];
    let messages_of = |package: &str| {
        let last = |name: &'static str| name.strip_prefix(package)?.strip_prefix('.');
        MESSAGES.iter().filter_map(|(name, fields)| Some((last(name)?, *fields))).collect::<Vec<_>>()
    };
    let mut set = Vec::new();
    for (path, message) in TIMES {
        let messages: Vec<_> = messages_of(GOOGLE).into_iter().filter(|(name, _)| *name == message).collect();
        bytes_field(&mut set, 1, &file(path, GOOGLE, &[], &messages));
    }
    bytes_field(
        &mut set,
        1,
        &file("foxglove/messages.proto", "foxglove", &TIMES.map(|(path, _)| path), &messages_of("foxglove")),
    );
    set
}

/// Encodes a `FileDescriptorProto`.
fn file(name: &str, package: &str, dependencies: &[&str], messages: &[(&str, &[Field])]) -> Vec<u8> {
    let mut out = Vec::new();
    bytes_field(&mut out, 1, name.as_bytes());
    bytes_field(&mut out, 2, package.as_bytes());
    dependencies.iter().for_each(|dependency| bytes_field(&mut out, 3, dependency.as_bytes()));
    for (name, fields) in messages {
        bytes_field(&mut out, 4, &descriptor(package, name, fields));
    }
    bytes_field(&mut out, 12, b"proto3");
    out
}

/// Encodes a `DescriptorProto`.
fn descriptor(package: &str, message: &str, fields: &[Field]) -> Vec<u8> {
    let mut out = Vec::new();
    bytes_field(&mut out, 1, message.as_bytes());
    for Field { name, number, kind, is_repeated } in fields {
        let mut field = Vec::new();
        bytes_field(&mut field, 1, name.as_bytes());
        for (index, value) in [(3, u64::from(*number)), (4, if *is_repeated { 3 } else { 1 }), (5, kind.code())] {
            tag(&mut field, index, VARINT);
            varint(&mut field, value);
        }
        match kind {
            Type::Message(type_name) => bytes_field(&mut field, 6, format!(".{type_name}").as_bytes()),
            Type::Enum(type_name, _) => {
                bytes_field(&mut field, 6, format!(".{package}.{message}.{type_name}").as_bytes())
            }
            _ => {}
        }
        bytes_field(&mut out, 2, &field);
    }
    for Field { kind, .. } in fields {
        if let Type::Enum(name, values) = kind {
            bytes_field(&mut out, 4, &enumeration(name, values));
        }
    }
    out
}

/// Encodes an `EnumDescriptorProto`.
fn enumeration(name: &str, values: &[&str]) -> Vec<u8> {
    let mut out = Vec::new();
    bytes_field(&mut out, 1, name.as_bytes());
    for (number, name) in (0..).zip(values) {
        let mut value = Vec::new();
        bytes_field(&mut value, 1, name.as_bytes());
        tag(&mut value, 2, VARINT);
        varint(&mut value, number);
        bytes_field(&mut out, 2, &value);
    }
    out
}

/// Decodes a message of type `message` into JSON values. An absent list is empty; other absent fields are omitted.
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
        let is_packed = field.is_repeated && field.kind.wire_type() != LEN;
        assert_eq!(tag & 7, if is_packed { LEN } else { field.kind.wire_type() }, "{}", field.name);
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
