//! Body of a robot in files of EyeSim VR: colliders, mass and mesh.

use glam::DVec3;

use super::{Reader, span_of};
use crate::Span;
use crate::code::Code;
use crate::diagnostic::{Severity, Sink};
use crate::line::{self, Quantity, Word};
use crate::path;
use crate::spec::{Axis, Collider, ModelSpec};

/// Converts a position from Unity's axes (X right, Y up, Z forward) to ours (x forward, y left, z up).
fn from_unity([right, up, forward]: [f64; 3]) -> DVec3 {
    DVec3::new(forward, 0.0 - right, up)
}

impl Reader {
    pub(super) fn collider(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let kind = rest.first().map_or("", |word| word.text);
        let values = rest.get(1..).unwrap_or_default();
        let span = span_of(keyword, rest);
        let sink = &mut self.sink;
        let collider = match kind {
            "box" => values_of(sink, "collider box", values, span, &BOX, BOX_SYNTAX).map(|[x, y, z, cx, cy, cz]| {
                // Sizes have no sign, so the conversion must only permute the axes.
                Collider::Box { centre: from_unity([cx, cy, cz]), size: from_unity([x, y, z]).abs() }
            }),
            "sphere" => values_of(sink, "collider sphere", values, span, &SPHERE, SPHERE_SYNTAX)
                .map(|[radius, cx, cy, cz]| Collider::Sphere { centre: from_unity([cx, cy, cz]), radius }),
            "capsule" => values_of(sink, "collider capsule", values, span, &CAPSULE, CAPSULE_SYNTAX).map(
                |[radius, height, cx, cy, cz]| Collider::Capsule {
                    centre: from_unity([cx, cy, cz]),
                    radius,
                    // A shorter capsule becomes a sphere, as in Unity.
                    height: height.max(2.0 * radius),
                    axis: Axis::Z,
                },
            ),
            other => {
                let word = rest.first().unwrap_or(keyword);
                let message = match other {
                    "" => "`collider` names no shape".to_owned(),
                    other => format!("unknown shape `{other}` of a collider"),
                };
                let diagnostic = sink.warn(Code::RobiColliderKind, word.span, message, COLLIDER_SYNTAX);
                diagnostic.suggestion =
                    line::nearest(other, ["box", "sphere", "capsule"]).map(|kind| format!("write `{kind}`"));
                None
            }
        };
        self.robi.colliders.extend(collider);
    }

    pub(super) fn mass(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let span = span_of(keyword, rest);
        if let Some([mass, x, y, z]) = values_of(&mut self.sink, "mass", rest, span, &MASS, MASS_SYNTAX) {
            self.robi.mass = mass;
            self.robi.centre_of_mass = from_unity([x, y, z]);
        }
    }

    pub(super) fn model(&mut self, keyword: &Word<'_>, rest: &[Word<'_>]) {
        let (name, values) = if rest.len() == 7 { rest.split_at(1) } else { (rest, &rest[rest.len()..]) };
        let values = line::numbers(&mut self.sink, Severity::Warning, values, &MODEL_POSE).unwrap_or_default();
        let path = path::reference(&mut self.sink, Severity::Warning, keyword, name, MODEL_SYNTAX);
        let [x, y, z, turns @ ..] = values;
        self.robi.model =
            path.map(|path| ModelSpec { path, offset: from_unity([x, y, z]), rotations: DVec3::from_array(turns) });
    }
}

/// Reads the `N` values of a `keyword` such as `mass` or `collider box`; warns about extra values, and about too few
/// values, for which it returns `None`.
pub(super) fn values_of<const N: usize>(
    sink: &mut Sink,
    keyword: &str,
    words: &[Word<'_>],
    span: Span,
    quantities: &[Quantity; N],
    syntax: &str,
) -> Option<[f64; N]> {
    if words.len() < N {
        let message = format!("`{keyword}` has {} of {N} numbers", words.len());
        let keywords: Vec<Word<'_>> = keyword.split(' ').map(|text| Word { text, span, is_unclosed: false }).collect();
        sink.warn(Code::RobiNumberMissing, span, message, syntax).suggestion =
            line::without_commas(keywords.iter().chain(words), |line| line.len() == keywords.len() + N);
        return None;
    }
    if let Some(extra) = words.get(N) {
        let message = format!("`{}` is left over after the values of `{keyword}`", extra.text);
        sink.warn(Code::WordExtra, extra.span, message, syntax).suggestion = line::comment_hint(extra.text);
    }
    line::numbers(sink, Severity::Warning, &words[..N], quantities)
}

const BOX_SYNTAX: &str = "`collider box WIDTH HEIGHT LENGTH RIGHT UP FORWARD` in mm: sizes, then the centre";
const SPHERE_SYNTAX: &str = "`collider sphere RADIUS RIGHT UP FORWARD` in mm: the radius, then the centre";
const CAPSULE_SYNTAX: &str =
    "`collider capsule RADIUS HEIGHT RIGHT UP FORWARD` in mm: radius and whole height, then the centre";
const COLLIDER_SYNTAX: &str = "`collider box ...`, `collider sphere ...` or `collider capsule ...`";
const MASS_SYNTAX: &str = "`mass KG RIGHT UP FORWARD` in kg and mm: the mass and where its centre is";
const MODEL_SYNTAX: &str =
    "`model FILE` or `model FILE RIGHT UP FORWARD RX RY RZ`: a mesh file, its position in mm, its rotations";

const BOX: [Quantity; 6] = [
    Quantity::size("width of the collider"),
    Quantity::size("height of the collider"),
    Quantity::size("length of the collider"),
    CENTRE[0],
    CENTRE[1],
    CENTRE[2],
];
const SPHERE: [Quantity; 4] = [Quantity::size("radius of the collider"), CENTRE[0], CENTRE[1], CENTRE[2]];
const CAPSULE: [Quantity; 5] = [
    Quantity::size("radius of the collider"),
    Quantity::size("height of the collider"),
    CENTRE[0],
    CENTRE[1],
    CENTRE[2],
];
const CENTRE: [Quantity; 3] = [
    Quantity::coordinate("centre of the collider"),
    Quantity::coordinate("centre of the collider"),
    Quantity::coordinate("centre of the collider"),
];
const MASS: [Quantity; 4] = [
    Quantity::mass("mass"),
    Quantity::coordinate("centre of mass"),
    Quantity::coordinate("centre of mass"),
    Quantity::coordinate("centre of mass"),
];
const MODEL_POSE: [Quantity; 6] = [
    Quantity::coordinate("position of the mesh").minor(),
    Quantity::coordinate("position of the mesh").minor(),
    Quantity::coordinate("position of the mesh").minor(),
    Quantity::angle("turn of the mesh").minor(),
    Quantity::angle("turn of the mesh").minor(),
    Quantity::angle("turn of the mesh").minor(),
];
