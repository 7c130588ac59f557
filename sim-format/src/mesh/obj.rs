//! Wavefront OBJ: lines `v`, `vt`, `vn`, `f`, `usemtl`, `mtllib`. Other lines do not describe triangles and are
//! ignored.
//!
//! The tests compare this reader with the crate `tobj` 4 on valid files. This crate does not use `tobj`, for these
//! reasons: `Kd` with one number makes it panic; out-of-range indices of `vt` overflow; an object with some corners
//! without `vt` shifts the texture coordinates of all later corners; reading stops at the first mistake; and errors
//! carry no line number.

use std::collections::BTreeMap;

use glam::{DVec3, Vec2, Vec3};

use super::mistakes::Mistakes;
use crate::line::{Line, lines};
use crate::spec::{MAX_LENGTH, SpannedText};
use crate::{Code, Diagnostic, Span};
use sim_core::scene::Triangle;

/// Maximum number of triangles, and of entries in each list: a hundred times the number in typical robot models.
const MAX_COUNT: usize = 2_000_000;

const FACE_SYNTAX: &str = "`f` and three or more corners of the form V, V/T, V//N or V/T/N";

/// Content of a file, with its corners transformed into the body frame.
#[derive(Default)]
pub(super) struct Obj {
    pub(super) positions: Vec<DVec3>,
    pub(super) triangles: Vec<Triangle>,
    /// Names of the materials, to whose indices the triangles refer, with the span of the first use.
    pub(super) materials: Vec<(String, Span)>,
    /// The material files.
    pub(super) libraries: Vec<SpannedText>,
    /// True if the file has more than [`MAX_COUNT`] of some element; the rest was not read.
    pub(super) is_too_large: bool,
}

/// Reads the text of the file called `file`. `transform_point` transforms a point of the file into the body frame,
/// `rotate` a direction.
pub(super) fn read_obj(
    file: &str,
    text: &str,
    transform_point: impl Fn(DVec3) -> DVec3,
    rotate: impl Fn(DVec3) -> DVec3,
) -> (Obj, Vec<Diagnostic>) {
    let mut reader = Reader::new(file);
    for line in lines(text) {
        let (keyword, rest) = split_word(line.text.trim());
        match keyword {
            "v" => {
                let point = reader.read_numbers::<3>(&line, rest).map(|point| transform_point(DVec3::from(point)));
                let valid = point.filter(|point| point.abs().max_element() <= MAX_LENGTH);
                if point.is_some() && valid.is_none() {
                    let expected = "coordinates within 1000 km after `scale`";
                    reader.mistakes.warn(Code::MeshLine, &line, expected, || "a corner lies too far away".to_owned());
                }
                reader.positions.push(valid);
            }
            "vt" => {
                let point = reader.read_numbers::<2>(&line, rest);
                reader.uvs.push(point.map(|[u, v]| Vec2::new(u as f32, v as f32)).filter(|uv| uv.is_finite()));
            }
            "vn" => {
                let direction =
                    reader.read_numbers::<3>(&line, rest).and_then(|d| rotate(DVec3::from(d)).try_normalize());
                reader.normals.push(direction.map(|direction| direction.as_vec3()));
            }
            "f" => reader.add_face(&line, rest),
            "usemtl" => reader.material = Some(reader.material_number(rest, &line)),
            "mtllib" => reader.read_libraries(&line, rest),
            _ => {}
        }
        if reader.is_too_large() {
            reader.obj.is_too_large = true;
            break;
        }
    }
    reader.finish()
}

struct Reader {
    mistakes: Mistakes,
    /// Positions; `None` for lines that could not be read, so that later positions keep their numbers.
    positions: Vec<Option<DVec3>>,
    uvs: Vec<Option<Vec2>>,
    normals: Vec<Option<Vec3>>,
    /// Number of the current material.
    material: Option<u32>,
    material_numbers: BTreeMap<String, u32>,
    obj: Obj,
}

/// Corner of a face: position, texture coordinates and normal.
#[derive(Clone, Copy)]
struct Corner {
    position: u32,
    uv: Option<Vec2>,
    normal: Option<Vec3>,
}

impl Reader {
    fn new(file: &str) -> Self {
        Self {
            mistakes: Mistakes::new(file),
            positions: Vec::new(),
            uvs: Vec::new(),
            normals: Vec::new(),
            material: None,
            material_numbers: BTreeMap::new(),
            obj: Obj::default(),
        }
    }

    fn is_too_large(&self) -> bool {
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len(), self.obj.triangles.len()];
        counts.iter().any(|count| *count > MAX_COUNT)
    }

    /// The first `N` numbers of a line; reports missing and non-finite numbers.
    fn read_numbers<const N: usize>(&mut self, line: &Line<'_>, rest: &str) -> Option<[f64; N]> {
        let mut numbers = [0.0; N];
        let mut words = rest.split_whitespace();
        for number in &mut numbers {
            let word = words.next().and_then(|word| word.parse::<f64>().ok()).filter(|number| number.is_finite());
            let Some(value) = word else {
                let message = || format!("`{}` has not {N} numbers", shortened(line.text));
                self.mistakes.warn(Code::MeshLine, line, "three numbers after `v` and `vn`, two after `vt`", message);
                return None;
            };
            *number = value;
        }
        Some(numbers)
    }

    /// Splits a face into triangles: a fan about its first corner.
    fn add_face(&mut self, line: &Line<'_>, rest: &str) {
        let (mut first, mut last, mut count) = (None, None, 0);
        let start = self.obj.triangles.len();
        for word in rest.split_whitespace() {
            let Some(corner) = self.read_corner(line, word) else {
                self.obj.triangles.truncate(start);
                return;
            };
            count += 1;
            if let (Some(first), Some(last)) = (first, last) {
                self.add_triangle(line, [first, last, corner]);
            }
            first = first.or(Some(corner));
            last = (count > 1).then_some(corner);
            if self.is_too_large() {
                return;
            }
        }
        if count < 3 {
            let message = || format!("`{}` has fewer than three corners", shortened(line.text));
            self.mistakes.warn(Code::MeshLine, line, FACE_SYNTAX, message);
        }
    }

    /// Corner of a face; `None`, with a warning, if it is invalid.
    fn read_corner(&mut self, line: &Line<'_>, word: &str) -> Option<Corner> {
        let Some([Some(position), uv, normal]) = corner_numbers(word) else {
            let message = || format!("`{}` is not a corner of a face", shortened(word));
            self.mistakes.warn(Code::MeshLine, line, FACE_SYNTAX, message);
            return None;
        };
        let Some(index) = index_in_list(position, self.positions.len()) else {
            return self.report_missing(line, word, "v", self.positions.len());
        };
        // Faces with a corner whose `v` could not be read are dropped.
        self.positions[index]?;
        let uv = uv.and_then(|number| match index_in_list(number, self.uvs.len()) {
            Some(index) => self.uvs[index],
            None => self.report_missing(line, word, "vt", self.uvs.len()),
        });
        let normal = normal.and_then(|number| match index_in_list(number, self.normals.len()) {
            Some(index) => self.normals[index],
            None => self.report_missing(line, word, "vn", self.normals.len()),
        });
        Some(Corner { position: index as u32, uv, normal })
    }

    /// Records a reference to a missing entry and returns `None`.
    fn report_missing<T>(&mut self, line: &Line<'_>, word: &str, keyword: &str, count: usize) -> Option<T> {
        let message = || format!("corner `{}` names none of the {count} `{keyword}` before it", shortened(word));
        self.mistakes.warn(Code::MeshIndex, line, "numbers from 1 on, or from -1 backwards", message);
        None
    }

    fn add_triangle(&mut self, line: &Line<'_>, corners: [Corner; 3]) {
        let [a, b, c] = corners.map(|corner| self.positions[corner.position as usize].unwrap_or_default());
        // Exporters leave behind invisible triangles of zero area.
        if (b - a).cross(c - a).try_normalize().is_none() {
            return;
        }
        let material = match self.material {
            Some(material) => material,
            None => self.material_number("", line),
        };
        let all_uvs = |uv: [Option<Vec2>; 3]| Some([uv[0]?, uv[1]?, uv[2]?]);
        let all_normals = |normals: [Option<Vec3>; 3]| Some([normals[0]?, normals[1]?, normals[2]?]);
        self.obj.triangles.push(Triangle {
            corners: corners.map(|corner| corner.position),
            normals: all_normals(corners.map(|corner| corner.normal)),
            uv: all_uvs(corners.map(|corner| corner.uv)),
            material,
        });
    }

    /// Number of a material; adds it at its first use.
    fn material_number(&mut self, name: &str, line: &Line<'_>) -> u32 {
        if let Some(number) = self.material_numbers.get(name) {
            return *number;
        }
        let number = self.obj.materials.len() as u32;
        self.obj.materials.push((name.to_owned(), line.span()));
        self.material_numbers.insert(name.to_owned(), number);
        number
    }

    /// Reads the file names of a line; there may be several, and a name may contain blanks.
    fn read_libraries(&mut self, line: &Line<'_>, rest: &str) {
        let mut name = String::new();
        for word in rest.split(' ') {
            name = if name.is_empty() { word.to_owned() } else { format!("{name} {word}") };
            if word.to_lowercase().ends_with(".mtl") {
                let text = std::mem::take(&mut name).trim().to_owned();
                self.obj.libraries.push(SpannedText { text, span: line.span() });
            }
        }
        if !name.trim().is_empty() {
            self.obj.libraries.push(SpannedText { text: name.trim().to_owned(), span: line.span() });
        }
    }

    fn finish(mut self) -> (Obj, Vec<Diagnostic>) {
        self.obj.positions = self.positions.into_iter().map(Option::unwrap_or_default).collect();
        (self.obj, self.mistakes.finish())
    }
}

/// Indices in `V`, `V/T`, `V//N` or `V/T/N`; `None` for any other word.
fn corner_numbers(word: &str) -> Option<[Option<i64>; 3]> {
    let mut numbers = [None; 3];
    for (index, part) in word.split('/').enumerate() {
        let number = numbers.get_mut(index)?;
        if !part.is_empty() {
            *number = Some(part.parse().ok()?);
        }
    }
    Some(numbers)
}

/// Converts a corner's number to an index in a list of `count` entries: 1 is the first, -1 the last. `None` if it is
/// out of range.
fn index_in_list(number: i64, count: usize) -> Option<usize> {
    let index = match number {
        1.. => usize::try_from(number - 1).ok(),
        0 => None,
        _ => usize::try_from(number.unsigned_abs()).ok().and_then(|back| count.checked_sub(back)),
    };
    index.filter(|index| *index < count)
}

/// First word of a line, and the rest.
pub(super) fn split_word(text: &str) -> (&str, &str) {
    text.split_once(char::is_whitespace).map_or((text, ""), |(word, rest)| (word, rest.trim()))
}

/// The user's text, shortened for a quotation.
pub(super) fn shortened(text: &str) -> String {
    const LENGTH: usize = 60;
    if text.chars().count() <= LENGTH {
        return text.trim().to_owned();
    }
    text.trim().chars().take(LENGTH).chain("...".chars()).collect()
}
