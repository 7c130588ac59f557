//! Object types: `.esObj` files of EyeSim VR.
//!
//! Lengths in the file, multiplied by the factor of `scale`, are millimetres; lengths in the mesh file, multiplied by
//! the same factor, are metres. Coordinates are in the frame of EyeSim VR's graphics library (X right, Y up, Z
//! forward).

use glam::DVec3;

use super::code::Code;
use super::diagnostic::{Diagnostic, Severity, Sink};
use super::line::{self, Quantity, SingleKeywords, Word};
use super::spec::{Axis, Collider, DEFAULT_OBJECT_MASS, DEFAULT_ROLLING, MAX_LENGTH, ModelSpec, ObjectType};
use super::{Span, path};
use sim_core::unit;

pub(crate) const KEYWORDS: [&str; 15] = [
    "colour",
    "obj",
    "name",
    "scale",
    "mass",
    "collider",
    "box",
    "sphere",
    "capsule",
    "cylinder",
    "buoyancy",
    "fixed",
    "friction",
    "rolling",
    "restitution",
];
const SHAPES: [&str; 4] = ["box", "sphere", "capsule", "cylinder"];
/// Smallest size of a collider, in metres.
const MIN_SIZE: f64 = 1e-6;

/// Reads an object file.
///
/// Missing values get the defaults of docs/formats/esobj.md; a missing shape or mass gives a warning.
pub fn read_esobj(file: &str, text: &str) -> (ObjectType, Vec<Diagnostic>) {
    let mut reader = Reader {
        sink: Sink::new(file),
        object: ObjectType { colliders: Vec::new(), ..ObjectType::with_defaults(file) },
        collider_spans: Vec::new(),
        scale: 1.0,
        single: SingleKeywords::default(),
        has_mass: false,
    };
    for line in line::lines(text) {
        let words = line.words();
        if let Some((first, rest)) = words.split_first() {
            reader.read_line(first, rest);
        }
    }
    reader.finish()
}

struct Reader {
    sink: Sink,
    /// The object under construction. Until `finish`, its lengths are in units of the file, in the object's axes.
    object: ObjectType,
    /// Spans of the colliders' lines.
    collider_spans: Vec<Span>,
    /// Factor on all lengths: millimetres per unit of the file, metres per unit of the mesh file.
    scale: f64,
    single: SingleKeywords,
    has_mass: bool,
}

impl Reader {
    fn read_line(&mut self, first: &Word<'_>, rest: &[Word<'_>]) {
        if let Some((keyword, line)) = line::without_equals_sign(&KEYWORDS, first, rest) {
            let message = format!("`=` follows the keyword `{keyword}`");
            self.sink.warn(Code::EsobjKeyword, first.span, message, KEYWORD_SYNTAX).suggestion =
                Some(format!("write `{line}`"));
            return;
        }
        if KEYWORDS.contains(&first.text) && first.text != "collider" && !SHAPES.contains(&first.text) {
            self.single.add(&mut self.sink, first.text, first.span);
        }
        match first.text {
            "obj" => {
                let path = path::reference(&mut self.sink, Severity::Warning, first, rest, "`obj FILE.obj`");
                self.object.model = path.map(|path| ModelSpec { path, offset: DVec3::ZERO, rotations: DVec3::ZERO });
            }
            "name" => {
                let syntax = "`name NAME`, between double quotes if it has blanks";
                match self.first_values(first, rest, 1, syntax) {
                    Some([name]) if name.text.trim().is_empty() => {
                        self.sink.warn(Code::EsobjArity, name.span, "the name is empty", syntax);
                    }
                    Some([name]) => self.object.name = name.text.to_owned(),
                    _ => {}
                }
            }
            "scale" => {
                if let Some([scale]) = self.read_numbers(first, rest, &[SCALE], "`scale FACTOR`") {
                    self.scale = scale;
                }
            }
            "mass" => self.read_mass(first, rest),
            "collider" => match rest.split_first() {
                Some((shape, values)) => self.read_collider(shape, values),
                None => {
                    let message = "`collider` names no shape";
                    self.sink.warn(Code::EsobjArity, first.span, message, COLLIDER_SYNTAX);
                }
            },
            word if SHAPES.contains(&word) => self.read_collider(first, rest),
            "buoyancy" => {
                if let Some([volume]) = self.read_numbers(first, rest, &[VOLUME], "`buoyancy VOLUME` in cubic metres") {
                    self.object.displaced_volume = volume;
                }
            }
            "fixed" => {
                self.warn_of_extra_values(first, rest, 0, "`fixed` alone");
                self.object.is_fixed = true;
            }
            "friction" => {
                if let Some([friction]) = self.read_numbers(first, rest, &[FRICTION], "`friction COEFFICIENT`") {
                    self.object.friction = friction;
                }
            }
            "rolling" => {
                if let Some([rolling]) = self.read_numbers(first, rest, &[ROLLING], "`rolling COEFFICIENT`") {
                    self.object.rolling = Some(rolling);
                }
            }
            "restitution" => {
                if let Some([restitution]) = self.read_numbers(first, rest, &[RESTITUTION], "`restitution COEFFICIENT`")
                {
                    self.object.restitution = restitution;
                }
            }
            "colour" | "color" => {
                if let Some(colour) = self.read_numbers(first, rest, &COLOUR, "`colour RED GREEN BLUE`, 0 to 255 each")
                {
                    self.object.colour = Some(colour.map(|shade| shade as u8));
                }
            }
            _ => self.report_unknown(first),
        }
    }

    /// The first `count` values of a line; reports missing or extra values.
    fn first_values<'w, 't>(
        &mut self,
        keyword: &Word<'_>,
        rest: &'w [Word<'t>],
        count: usize,
        syntax: &str,
    ) -> Option<&'w [Word<'t>]> {
        if rest.len() < count {
            let span = rest.last().map_or(keyword.span, |last| keyword.span.to(last.span));
            let message = format!("`{}` has {} of {count} values", keyword.text, rest.len());
            let line = std::iter::once(keyword).chain(rest);
            self.sink.warn(Code::EsobjArity, span, message, syntax).suggestion =
                line::without_commas(line, |words| words.len() == 1 + count);
            return None;
        }
        self.warn_of_extra_values(keyword, rest, count, syntax);
        rest.get(..count)
    }

    fn warn_of_extra_values(&mut self, keyword: &Word<'_>, rest: &[Word<'_>], count: usize, syntax: &str) {
        if let Some(extra) = rest.get(count) {
            let message = format!("`{}` is left over after the values of `{}`", extra.text, keyword.text);
            self.sink.warn(Code::WordExtra, extra.span, message, syntax).suggestion = line::comment_hint(extra.text);
        }
    }

    fn read_numbers<const N: usize>(
        &mut self,
        keyword: &Word<'_>,
        rest: &[Word<'_>],
        quantities: &[Quantity; N],
        syntax: &str,
    ) -> Option<[f64; N]> {
        let values = self.first_values(keyword, rest, N, syntax)?;
        line::numbers(&mut self.sink, Severity::Warning, values, quantities)
    }

    fn read_mass(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let syntax = "`mass KG` or `mass KG X Y Z`, the centre of mass";
        self.has_mass = true;
        if rest.len() == 1 {
            if let Some([mass]) = self.read_numbers(keyword, rest, &[MASS], syntax) {
                self.object.mass = mass;
            }
        } else if let Some([mass, x, y, z]) =
            self.read_numbers(keyword, rest, &[MASS, COORDINATES[0], COORDINATES[1], COORDINATES[2]], syntax)
        {
            self.object.mass = mass;
            self.object.centre_of_mass = from_graphics(x, y, z);
        }
    }

    /// Reads the `values` of a collider; the word `shape` is its shape.
    fn read_collider(&mut self, shape: &Word<'_>, values: &[Word<'_>]) {
        let [x, y, z] = COORDINATES;
        let collider = match shape.text {
            "box" => self.read_numbers(shape, values, &[x, y, z, SIZE[0], SIZE[1], SIZE[2]], BOX_SYNTAX).map(
                |[x, y, z, right, up, forward]| Collider::Box {
                    centre: from_graphics(x, y, z),
                    size: DVec3::new(forward, right, up),
                },
            ),
            "sphere" => self
                .read_numbers(shape, values, &[x, y, z, RADIUS], SPHERE_SYNTAX)
                .map(|[x, y, z, radius]| Collider::Sphere { centre: from_graphics(x, y, z), radius }),
            "cylinder" => self
                .read_numbers(shape, values, &[x, y, z, RADIUS, HEIGHT], CYLINDER_SYNTAX)
                .map(|[x, y, z, radius, height]| Collider::Cylinder { centre: from_graphics(x, y, z), radius, height }),
            "capsule" => self.read_capsule(shape, values),
            _ => {
                let message = format!("unknown shape `{}`", shape.text);
                let diagnostic = self.sink.warn(Code::EsobjColliderKind, shape.span, message, COLLIDER_SYNTAX);
                diagnostic.suggestion = line::nearest(shape.text, SHAPES).map(|shape| format!("write `{shape}`"));
                return;
            }
        };
        let Some(collider) = collider else { return };
        self.object.colliders.push(collider);
        self.collider_spans.push(values.last().map_or(shape.span, |last| shape.span.to(last.span)));
    }

    fn read_capsule(&mut self, shape: &Word<'_>, values: &[Word<'_>]) -> Option<Collider> {
        let [x, y, z] = COORDINATES;
        let values = self.first_values(shape, values, 6, CAPSULE_SYNTAX)?;
        let (numbers, axis) = values.split_at(5);
        let [x, y, z, radius, height] =
            line::numbers(&mut self.sink, Severity::Warning, numbers, &[x, y, z, RADIUS, HEIGHT])?;
        let axis = match axis[0].text {
            "x" | "X" => Axis::Y,
            "y" | "Y" => Axis::Z,
            "z" | "Z" => Axis::X,
            other => {
                let message = format!("`{other}` is not an axis of a capsule");
                self.sink.warn(Code::EsobjColliderKind, axis[0].span, message, "x, y or z");
                return None;
            }
        };
        // With a height below the diameter, only the two half spheres exist, as in EyeSim VR's graphics library.
        let height = height.max(2.0 * radius);
        Some(Collider::Capsule { centre: from_graphics(x, y, z), radius, height, axis })
    }

    fn report_unknown(&mut self, word: &Word<'_>) {
        let message = format!("unknown keyword `{}`", word.text);
        let diagnostic = self.sink.warn(Code::EsobjKeyword, word.span, message, KEYWORD_SYNTAX);
        let nearest = line::nearest(word.text, KEYWORDS).map(|keyword| format!("write `{keyword}`"));
        diagnostic.suggestion = line::comment_hint(word.text).or(nearest);
    }

    fn finish(mut self) -> (ObjectType, Vec<Diagnostic>) {
        let metres_per_unit = unit::metres_from_mm(self.scale);
        // One unit is a metre in the mesh and a millimetre in a collider.
        self.object.scale = self.scale;
        self.object.centre_of_mass *= metres_per_unit;
        let written = std::mem::take(&mut self.object.colliders);
        let has_collider = !written.is_empty();
        for (collider, span) in written.into_iter().zip(&self.collider_spans) {
            let collider = scaled(collider, metres_per_unit);
            if is_in_range(&collider) {
                self.object.colliders.push(collider);
            } else {
                let message = "times the factor of `scale`, the collider is out of range";
                let expected = "sizes from 1e-3 to 1e9 mm";
                self.sink.warn(Code::NumberRange, *span, message, expected);
            }
        }
        if self.object.centre_of_mass.abs().max_element() > MAX_LENGTH {
            let message = "times the factor of `scale`, the centre of mass is out of range";
            self.sink.warn(Code::NumberRange, Span::default(), message, "a place within 1e9 mm");
            self.object.centre_of_mass = DVec3::ZERO;
        }
        if !has_collider {
            let message = "no collider: an upright cylinder of 100 mm width and height is used";
            self.sink.warn(Code::EsobjColliderMissing, Span::default(), message, COLLIDER_SYNTAX);
        }
        if !self.has_mass && !self.object.is_fixed {
            let message = format!("no `mass` line: {DEFAULT_OBJECT_MASS} kg is used");
            self.sink.warn(Code::EsobjMassMissing, Span::default(), message, "`mass KG X Y Z`, or `fixed`");
        }
        if self.object.colliders.is_empty() {
            self.object.colliders = ObjectType::with_defaults(&self.object.file).colliders;
        }
        let is_ball = self.object.colliders.iter().all(|collider| matches!(collider, Collider::Sphere { .. }));
        if is_ball {
            self.object.rolling.get_or_insert(DEFAULT_ROLLING);
        }
        (self.object, self.sink.finish())
    }
}

/// Converts from the axes X right, Y up, Z forward to x forward, y left, z up.
fn from_graphics(right: f64, up: f64, forward: f64) -> DVec3 {
    // `0.0 - right` avoids -0, which `-right` would give.
    DVec3::new(forward, 0.0 - right, up)
}

/// The collider with all lengths multiplied by `factor`.
fn scaled(collider: Collider, factor: f64) -> Collider {
    match collider {
        Collider::Box { centre, size } => Collider::Box { centre: centre * factor, size: size * factor },
        Collider::Sphere { centre, radius } => Collider::Sphere { centre: centre * factor, radius: radius * factor },
        Collider::Capsule { centre, radius, height, axis } => {
            Collider::Capsule { centre: centre * factor, radius: radius * factor, height: height * factor, axis }
        }
        Collider::Cylinder { centre, radius, height } => {
            Collider::Cylinder { centre: centre * factor, radius: radius * factor, height: height * factor }
        }
    }
}

/// Returns true if a collider's sizes and position, in metres, are within reasonable limits.
fn is_in_range(collider: &Collider) -> bool {
    let (centre, smallest, largest) = match *collider {
        Collider::Box { centre, size } => (centre, size.min_element(), size.max_element()),
        Collider::Sphere { centre, radius } => (centre, radius, radius),
        Collider::Capsule { centre, radius, height, .. } | Collider::Cylinder { centre, radius, height } => {
            (centre, radius.min(height), radius.max(height))
        }
    };
    centre.abs().max_element() <= MAX_LENGTH && smallest >= MIN_SIZE && largest <= MAX_LENGTH
}

const KEYWORD_SYNTAX: &str = "one of obj, name, scale, mass, collider, box, sphere, capsule, cylinder, buoyancy, fixed, friction, rolling, \
     restitution, colour";
const COLLIDER_SYNTAX: &str = "`collider box|sphere|capsule|cylinder` and its values";
const BOX_SYNTAX: &str = "`collider box X Y Z SX SY SZ`: centre and sizes";
const SPHERE_SYNTAX: &str = "`collider sphere X Y Z RADIUS`";
const CAPSULE_SYNTAX: &str = "`collider capsule X Y Z RADIUS HEIGHT x|y|z`: centre, radius, whole height, axis";
const CYLINDER_SYNTAX: &str = "`collider cylinder X Y Z RADIUS HEIGHT`: centre, radius, height";

/// Positive length in units of the file.
const fn length(name: &'static str) -> Quantity {
    Quantity::number(name, 1e-9, 1e15).minor()
}

/// Coordinate in units of the file.
const fn coordinate(name: &'static str) -> Quantity {
    Quantity::number(name, -1e15, 1e15).minor()
}

const COORDINATES: [Quantity; 3] = [coordinate("x"), coordinate("y"), coordinate("z")];
const SIZE: [Quantity; 3] = [length("size along x"), length("size along y"), length("size along z")];
const RADIUS: Quantity = length("radius");
const HEIGHT: Quantity = length("height");
const SCALE: Quantity = Quantity::number("scale", 1e-9, 1e9).minor();
const MASS: Quantity = Quantity::number("mass", 1e-6, 1e9).minor();
const VOLUME: Quantity = Quantity::number("volume", 0.0, 1e9).minor();
const FRICTION: Quantity = Quantity::number("friction", 0.0, 10.0).minor();
const ROLLING: Quantity = Quantity::number("rolling resistance", 0.0, 10.0).minor();
const RESTITUTION: Quantity = Quantity::number("restitution", 0.0, 1.0).minor();
const COLOUR: [Quantity; 3] = [
    Quantity::number("red", 0.0, 255.0).minor(),
    Quantity::number("green", 0.0, 255.0).minor(),
    Quantity::number("blue", 0.0, 255.0).minor(),
];
