//! Side views of the walk: the robot as a stick figure, the rays of its sensor, the room's floor and the obstacle.

use std::fmt::Write as _;

use glam::DVec2;

use super::walk::{Kind, MountPoint, Thing, Truth, Walk};

/// Pixels per metre.
const SCALE: f64 = 190.0;
/// Margin around the drawing, m.
const MARGIN: f64 = 0.12;
/// Colour of the leg that bears the sensor.
pub const NEAR_LEG: &str = "#0072b2";
/// Colour of the other leg.
pub const FAR_LEG: &str = "#999999";
/// Colour of rays and points.
pub const RAY: &str = "#d55e00";

/// A drawing in metres: x ahead of the start, y up.
pub struct Canvas {
    svg: String,
    left: f64,
    top: f64,
}

impl Canvas {
    /// An empty drawing with these borders.
    pub fn new([left, right]: [f64; 2], [bottom, top]: [f64; 2], title: &str) -> Self {
        let (width, height) = ((right - left) * SCALE, (top - bottom + MARGIN) * SCALE + 24.0);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" font-family=\"DejaVu Sans, sans-serif\" font-size=\"12\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
        );
        let _ = writeln!(svg, "<text x=\"10\" y=\"18\" font-size=\"14\">{title}</text>");
        Self { svg, left, top }
    }

    fn place(&self, point: DVec2) -> (f64, f64) {
        ((point.x - self.left) * SCALE, (self.top - point.y) * SCALE + 24.0)
    }

    /// A line through points.
    pub fn path(&mut self, points: &[DVec2], colour: &str, width: f64) {
        let corners: Vec<String> =
            points.iter().map(|point| self.place(*point)).map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(
            self.svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linejoin=\"round\"/>",
            corners.join(" ")
        );
    }

    /// A dot.
    pub fn dot(&mut self, at: DVec2, colour: &str, radius: f64) {
        let (x, y) = self.place(at);
        let _ = writeln!(self.svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" fill=\"{colour}\"/>");
    }

    /// Centred text.
    pub fn text(&mut self, at: DVec2, words: &str) {
        let (x, y) = self.place(at);
        let _ = writeln!(self.svg, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{words}</text>");
    }

    /// The drawing as SVG.
    pub fn finish(mut self) -> String {
        self.svg.push_str("</svg>\n");
        self.svg
    }
}

/// Draws the robot's legs at intervals of `every` seconds of a walk, above the floor and the obstacle. It also draws
/// the ray of each reading that hits something within the sensor's range.
pub fn walk(truth: &Truth, walk: &Walk, place: MountPoint, kind: Kind, every: f64, title: &str) -> String {
    let end = truth.obstacle_at + truth.obstacle_size.x;
    let mut canvas = Canvas::new([-0.6, end + 0.3], [0.0, 1.05], title);
    ground(&mut canvas, truth, -0.6, end + 0.3);
    for sample in walk.samples.iter().filter(|sample| sample.point.is_some()) {
        let origin = truth.ray(place, kind, &walk.at_time(sample.at)).position;
        let from = truth.ahead(origin);
        canvas.path(&[from, sample.truth.point], RAY, 0.35);
    }
    let mut at = 0.0;
    while at <= walk.stopped() + every {
        figure(&mut canvas, truth, walk, at.min(walk.stopped()));
        at += every;
    }
    for sample in &walk.samples {
        let colour = if sample.truth.thing == Thing::Obstacle { "#000000" } else { RAY };
        if sample.point.is_some() {
            canvas.dot(sample.truth.point, colour, 1.6);
        }
    }
    canvas.finish()
}

/// Draws the standing robot with its sensors.
pub fn model(truth: &Truth, walk: &Walk) -> String {
    let mut canvas = Canvas::new([-1.0, 1.0], [0.0, 1.05], "Places of the sensors, and where they look");
    canvas.path(&[DVec2::new(-1.0, 0.0), DVec2::new(1.0, 0.0)], "#333333", 1.5);
    figure(&mut canvas, truth, walk, 0.0);
    for place in MountPoint::ALL {
        let ray = truth.ray(place, Kind::Ideal, &walk.at_time(0.0));
        let from = truth.ahead(ray.position);
        let to = truth.ahead(ray.position + ray.forward() * 0.45);
        canvas.path(&[from, to], RAY, 1.0);
        canvas.dot(from, RAY, 3.5);
        canvas.text(to + DVec2::new(0.14, -0.02), place.name());
    }
    canvas.finish()
}

/// Draws the floor and the obstacle.
fn ground(canvas: &mut Canvas, truth: &Truth, left: f64, right: f64) {
    canvas.path(&profile(truth, left, right).map(|(x, y)| DVec2::new(x, y)), "#333333", 1.5);
}

/// The true profile under the walk: corners of floor and obstacle between `left` and `right`, m.
pub fn profile(truth: &Truth, left: f64, right: f64) -> [(f64, f64); 6] {
    let (front, back, top) = (truth.obstacle_at, truth.obstacle_at + truth.obstacle_size.x, truth.obstacle_size.z);
    [(left, 0.0), (front, 0.0), (front, top), (back, top), (back, 0.0), (right, 0.0)]
}

/// Draws the legs and the hip at an instant.
fn figure(canvas: &mut Canvas, truth: &Truth, walk: &Walk, at: f64) {
    let moment = walk.at_time(at);
    // The right leg, which bears the sensor, is drawn over the left one.
    for (leg, colour) in [(0, FAR_LEG), (1, NEAR_LEG)] {
        let points = truth.leg(leg, &moment);
        canvas.path(&points, colour, 2.0);
        for joint in points.iter().take(3) {
            canvas.dot(*joint, colour, 2.2);
        }
    }
}
