//! Worlds of Gazebo in SDF: cylinders, boxes and spheres as walls.
//!
//! Source: sdformat.org/spec; worlds of the BARN challenge consist of cylinders.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use glam::DVec2;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::grid::MAX_WALLS;
use super::{origin_note, rounded_mm};
use crate::code::Code;
use crate::diagnostic::Sink;
use crate::line::line_starts;
use crate::spec::{MAX_LENGTH, WallSpec, WorldSpec};
use crate::{Severity, Span};
use sim_core::math;
use sim_core::pose::Pose;

/// Maximum distance in metres of a polygon's sides from the circle that the polygon replaces. Source: our choice.
const MAX_DEVIATION: f64 = 5e-4;

/// Minimum and maximum number of sides of a polygon that replaces a circle.
const SIDE_COUNT_LIMITS: [f64; 2] = [8.0, 256.0];

/// Maximum nesting depth of elements.
const MAX_DEPTH: usize = 64;

const FORM: &str = "an SDF world: `<sdf><world>` with a `<model>` for each obstacle";
const SHAPE_SYNTAX: &str = "a `<cylinder>`, `<box>` or `<sphere>` within a `<collision>`";

/// Reads an SDF world. The floor is the rectangle around all obstacles. Also returns a note on the interpretation.
pub(crate) fn read_sdf(sink: &mut Sink, file: &str, text: &str) -> (WorldSpec, String) {
    let line_starts = line_starts(text);
    let mut parser =
        SdfParser { sink, text, line_starts, open: Vec::new(), obstacles: Vec::new(), states: BTreeMap::new() };
    let is_read = parser.read();
    let SdfParser { obstacles, states, .. } = parser;
    let mut counts = [0; 3];
    let mut walls = Vec::new();
    let mut max_deviation: f64 = 0.0;
    for obstacle in &obstacles {
        if walls.len() > MAX_WALLS {
            let message = format!("the world has more than {MAX_WALLS} walls");
            sink.error(Code::MapSize, obstacle.span, message, "a smaller world");
            walls.clear();
            break;
        }
        let model = states.get(&obstacle.model).unwrap_or(&obstacle.model_pose);
        let pose = model.compose(&obstacle.pose);
        let (corners, deviation) = obstacle.shape.corners();
        max_deviation = max_deviation.max(deviation);
        counts[obstacle.shape.kind_index()] += 1;
        let corners: Vec<DVec2> = corners.into_iter().map(|corner| pose.transform_point(corner)).collect();
        for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            if from != to {
                let height = obstacle.height;
                walls.push(WallSpec { from: *from, to: *to, height, span: obstacle.span, ..WallSpec::default() });
            }
        }
    }
    let ends = || walls.iter().map(|wall| wall.from);
    let low = ends().reduce(DVec2::min).unwrap_or_default();
    let high = ends().reduce(DVec2::max).unwrap_or_default();
    if low.abs().max(high.abs()).max_element() > 0.5 * MAX_LENGTH {
        sink.error(Code::NumberRange, Span::default(), "the world is larger than 1000 km", "a smaller world");
        walls.clear();
    }
    for wall in &mut walls {
        (wall.from, wall.to) = (wall.from - low, wall.to - low);
    }
    walls.retain(|wall| wall.from != wall.to);
    if walls.is_empty() && is_read {
        sink.error(Code::SdfShape, Span::default(), "the world has no obstacles", SHAPE_SYNTAX);
    }
    let [cylinders, boxes, spheres] = counts;
    let mut note = format!("{cylinders} cylinders, {boxes} boxes, {spheres} spheres; {} walls", walls.len());
    if max_deviation > 0.0 {
        note.push_str(&format!(", at most {:.2} mm from their circles", 1e3 * max_deviation));
    }
    let floor = if walls.is_empty() { DVec2::ZERO } else { high - low };
    note.push_str(&format!("; floor {} x {} mm", rounded_mm(floor.x), rounded_mm(floor.y)));
    note.push_str(&origin_note(-low));
    (WorldSpec { file: file.to_owned(), floor, walls, ..WorldSpec::default() }, note)
}

/// A shape seen from above, in its own frame.
#[derive(Clone, Copy, Debug)]
enum Shape {
    Cylinder(f64),
    Box(f64, f64),
    Sphere(f64),
}

impl Shape {
    fn kind_index(self) -> usize {
        match self {
            Shape::Cylinder(_) => 0,
            Shape::Box(..) => 1,
            Shape::Sphere(_) => 2,
        }
    }

    /// The corners of the shape's outline, and the maximum distance between outline and shape.
    ///
    /// A circle of radius r becomes a regular polygon with n sides. Its corners are as far outside the circle as the
    /// middles of its sides are inside: r tan²(π/2n).
    fn corners(self) -> (Vec<DVec2>, f64) {
        let radius = match self {
            Shape::Box(x, y) => {
                let corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)];
                return (corners.map(|(a, b)| DVec2::new(a * x, b * y)).to_vec(), 0.0);
            }
            Shape::Cylinder(radius) | Shape::Sphere(radius) => radius,
        };
        let sides = (0.5 * PI / math::atan((MAX_DEVIATION / radius).sqrt()))
            .ceil()
            .clamp(SIDE_COUNT_LIMITS[0], SIDE_COUNT_LIMITS[1]);
        let cosine = math::cos(PI / sides);
        let corner_radius = 2.0 * radius / (1.0 + cosine);
        let angle = |number: usize| 2.0 * PI * number as f64 / sides;
        let corners = (0..sides as usize).map(|number| {
            let (sine, cosine) = math::sin_cos(angle(number));
            DVec2::new(cosine, sine) * corner_radius
        });
        (corners.collect(), corner_radius - radius)
    }
}

/// A collision shape of a model.
struct Obstacle {
    model: String,
    model_pose: Pose,
    /// Pose in the model's frame.
    pose: Pose,
    shape: Shape,
    /// Height of its upper edge above the floor.
    height: f64,
    span: Span,
}

/// An element whose end has not been read.
struct Element {
    tag: String,
    name: String,
    /// Pose in the frame of the parent element, and its height.
    pose: Pose,
    z: f64,
    text: String,
    span: Span,
    /// Numbers of the child elements, by their tags.
    values: BTreeMap<String, Vec<f64>>,
    /// Shape of a `<collision>`, and half its height.
    shape: Option<(Shape, f64)>,
}

struct SdfParser<'t, 's> {
    sink: &'s mut Sink,
    text: &'t str,
    line_starts: Vec<usize>,
    open: Vec<Element>,
    obstacles: Vec<Obstacle>,
    /// Poses of models in the saved state of a simulation.
    states: BTreeMap<String, Pose>,
}

impl SdfParser<'_, '_> {
    fn span(&self, from: usize, to: usize) -> Span {
        let (from, to) = (self.text.floor_char_boundary(from), self.text.ceil_char_boundary(to.min(self.text.len())));
        let line_number = self.line_starts.partition_point(|start| *start <= from);
        let line_text = &self.text[self.line_starts[line_number - 1]..from];
        let line_text =
            if line_number == 1 { line_text.strip_prefix('\u{feff}').unwrap_or(line_text) } else { line_text };
        Span { start: from, end: to.max(from), line: line_number as u32, column: line_text.chars().count() as u32 + 1 }
    }

    /// Reads the whole text; returns false, with an error, if it is not SDF.
    fn read(&mut self) -> bool {
        let text = self.text;
        let skipped = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        let mut reader = Reader::from_str(&text[skipped..]);
        let mut has_root = false;
        loop {
            let from = skipped + reader.buffer_position() as usize;
            let event = reader.read_event();
            let to = skipped + reader.buffer_position() as usize;
            match event {
                Ok(Event::Start(start)) => {
                    has_root |= self.open_element(&start, self.span(from, to), has_root);
                    if self.open.len() > MAX_DEPTH {
                        let message = format!("more than {MAX_DEPTH} elements lie within each other");
                        self.sink.error(Code::SdfSyntax, self.span(from, to), message, FORM);
                        return false;
                    }
                }
                Ok(Event::Empty(start)) => {
                    has_root |= self.open_element(&start, self.span(from, to), has_root);
                    self.close_element();
                }
                Ok(Event::Text(words)) => {
                    if let Some(element) = self.open.last_mut() {
                        element.text.push_str(&String::from_utf8_lossy(&words));
                    }
                }
                Ok(Event::End(_)) => self.close_element(),
                Ok(Event::Eof) => break,
                Ok(_) => {}
                Err(error) => {
                    let error_index = skipped + (reader.error_position() as usize).min(text.len() - skipped);
                    let span = self.span(error_index, error_index);
                    self.sink.error(Code::SdfSyntax, span, format!("the file is not XML: {error}"), FORM);
                    return false;
                }
            }
        }
        if let Some(element) = self.open.last() {
            let (tag, span) = (element.tag.clone(), element.span);
            self.sink.error(Code::SdfSyntax, span, format!("`<{tag}>` is not closed"), FORM);
        } else if !has_root {
            self.sink.error(Code::SdfSyntax, Span::default(), "the file has no element `<sdf>`", FORM);
        }
        self.open.is_empty() && has_root
    }

    /// Opens an element and returns true. Reports an error if the first element of the file is not `<sdf>`.
    fn open_element(&mut self, start: &BytesStart<'_>, span: Span, has_root: bool) -> bool {
        let tag = String::from_utf8_lossy(start.name().as_ref()).into_owned();
        if !has_root && tag != "sdf" {
            self.sink.error(Code::SdfSyntax, span, format!("the file begins with `<{tag}>`"), FORM);
        }
        let attribute = |name: &str| {
            let value = start.try_get_attribute(name).ok().flatten()?.value;
            Some(String::from_utf8_lossy(&value).into_owned())
        };
        let name = attribute("name").unwrap_or_default();
        if tag == "pose" {
            let frame = ["frame", "relative_to"].iter().find_map(|name| attribute(name).filter(|it| !it.is_empty()));
            if let Some(frame) = frame {
                let message = format!("a pose in the frame `{frame}` is read as one in the frame of its element");
                self.sink.warn(Code::SdfShape, span, message, "a pose without `relative_to`");
            }
        }
        let text = String::new();
        let (values, shape) = (BTreeMap::new(), None);
        self.open.push(Element { tag, name, pose: Pose::default(), z: 0.0, text, span, values, shape });
        true
    }

    fn close_element(&mut self) {
        let Some(element) = self.open.pop() else { return };
        let is_within = |tag: &str, open: &[Element]| open.iter().any(|element| element.tag == tag);
        match element.tag.as_str() {
            "pose" => self.read_pose(&element),
            "radius" | "length" | "size" | "scale" => {
                let numbers = self.read_numbers(&element, "numbers");
                if let Some(parent) = self.open.last_mut() {
                    parent.values.insert(element.tag, numbers);
                }
            }
            "cylinder" | "box" | "sphere" if is_within("collision", &self.open) => {
                let shape = self.read_shape(&element);
                let collision = self.open.iter_mut().rfind(|parent| parent.tag == "collision");
                if let (Some(collision), Some(shape)) = (collision, shape) {
                    collision.shape = Some(shape);
                }
            }
            "plane" => {}
            "mesh" | "polyline" | "heightmap" | "capsule" | "ellipsoid" | "cone" | "image"
                if is_within("collision", &self.open) =>
            {
                let message = format!("a `<{}>` is left out", element.tag);
                self.sink.warn(Code::SdfShape, element.span, message, SHAPE_SYNTAX);
            }
            "include" => {
                self.sink.warn(Code::SdfShape, element.span, "an `<include>` is left out", SHAPE_SYNTAX);
            }
            "collision" => self.add_obstacle(&element),
            "model" if self.open.last().is_some_and(|parent| parent.tag == "state") => {
                self.states.insert(element.name, element.pose);
            }
            _ => {}
        }
    }

    /// The numbers between the tags of an element; reports words that are not numbers.
    fn read_numbers(&mut self, element: &Element, expected: &str) -> Vec<f64> {
        let mut numbers = Vec::new();
        for word in element.text.split_whitespace() {
            match word.parse::<f64>().ok().filter(|number| number.abs() <= MAX_LENGTH) {
                Some(number) => numbers.push(number),
                None => {
                    let message = format!("`{word}` in `<{}>` is not a number up to 1e6", element.tag);
                    self.sink.error(Code::NumberInvalid, element.span, message, expected);
                    return Vec::new();
                }
            }
        }
        numbers
    }

    fn read_pose(&mut self, element: &Element) {
        let expected = "`X Y Z ROLL PITCH YAW` in metres and radians";
        let numbers = self.read_numbers(element, expected);
        let values = match numbers.as_slice() {
            [] => return,
            [x, y, z, roll, pitch, yaw] => [*x, *y, *z, *roll, *pitch, *yaw],
            _ => {
                let message = format!("a pose of {} numbers", numbers.len());
                self.sink.error(Code::SdfShape, element.span, message, expected);
                return;
            }
        };
        let [x, y, z, roll, pitch, yaw] = values;
        let is_checked_for_tilt =
            self.open.last().is_some_and(|parent| ["model", "link", "collision"].contains(&parent.tag.as_str()));
        if is_checked_for_tilt && roll.abs().max(pitch.abs()) > 1e-3 {
            self.sink.warn(
                Code::SdfShape,
                element.span,
                "a shape that is tilted is read as upright",
                "no roll and pitch",
            );
        }
        if let Some(parent) = self.open.last_mut() {
            (parent.pose, parent.z) = (Pose::new(x, y, yaw.clamp(-1e4, 1e4)), z);
        }
    }

    /// Shape and half height of a `<cylinder>`, `<box>` or `<sphere>`.
    fn read_shape(&mut self, element: &Element) -> Option<(Shape, f64)> {
        let value = |key: &str| element.values.get(key).map(Vec::as_slice).unwrap_or_default();
        let shape = match (element.tag.as_str(), value("radius"), value("length"), value("size")) {
            ("cylinder", [radius], [length], _) => Some((Shape::Cylinder(*radius), 0.5 * length)),
            ("box", _, _, [x, y, z]) => Some((Shape::Box(*x, *y), 0.5 * z)),
            ("sphere", [radius], ..) => Some((Shape::Sphere(*radius), *radius)),
            _ => None,
        };
        let is_positive = shape.is_some_and(|(shape, half_height)| {
            half_height > 1e-6
                && match shape {
                    Shape::Cylinder(radius) | Shape::Sphere(radius) => radius > 1e-6,
                    Shape::Box(x, y) => x > 1e-6 && y > 1e-6,
                }
        });
        if !is_positive {
            let message = format!("a `<{}>` without its size is left out", element.tag);
            let expected = "a cylinder with radius and length, a box with size, a sphere with radius, all above 0";
            self.sink.report(Severity::Warning, Code::SdfShape, element.span, message, expected);
            return None;
        }
        shape
    }

    fn add_obstacle(&mut self, element: &Element) {
        let Some((shape, half_height)) = element.shape else { return };
        let Some(model_index) = self.open.iter().position(|parent| parent.tag == "model") else { return };
        let mut pose = Pose::default();
        let mut z = self.open[model_index].z;
        for nested in self.open[model_index + 1..].iter().chain([element]) {
            pose = pose.compose(&nested.pose);
            z += nested.z;
        }
        if z + half_height <= 0.0 {
            return;
        }
        if z - half_height > 0.05 {
            let message = format!("a shape {} mm above the floor reaches down to it", rounded_mm(z - half_height));
            self.sink.warn(Code::SdfShape, element.span, message, "shapes that stand on the floor");
        }
        let (model, model_pose) = (self.open[model_index].name.clone(), self.open[model_index].pose);
        self.obstacles.push(Obstacle { model, model_pose, pose, shape, height: z + half_height, span: element.span });
    }
}
