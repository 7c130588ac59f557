//! What a picture shows, in metres of the world: shapes with their paint, labels, a legend. Knows no pixels.

use std::sync::Arc;

use glam::DVec2;
use plotters::style::RGBColor;
use sim_core::pose::Pose;
use sim_core::scene::Texture;

/// Everything in a picture; see `render` for how it becomes one. Shapes cover those before them.
#[derive(Clone, Debug, Default)]
pub struct Drawing {
    /// The line above the picture.
    pub title: String,
    /// An image below all shapes.
    pub backdrop: Option<Backdrop>,
    /// The shapes, the lowest first.
    pub shapes: Vec<Shape>,
    /// Words, above all shapes.
    pub labels: Vec<Label>,
    /// What the shapes mean.
    pub legend: Vec<Entry>,
    /// The part of the world that must be seen: opposite corners.
    extent: Option<(DVec2, DVec2)>,
}

/// An image stretched over a rectangle.
#[derive(Clone, Debug)]
pub struct Backdrop {
    /// Lower left and upper right corner.
    pub corners: [DVec2; 2],
    /// The image.
    pub texture: Arc<Texture>,
}

/// A form with its paint.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Where.
    pub form: Form,
    /// The colour of its inside.
    pub fill: Option<Paint>,
    /// Its outline.
    pub line: Option<Line>,
    /// Its size in metres where it is a detail: it is left out when that is too few pixels. Infinite for what must be seen.
    pub detail: f64,
}

/// A form in the world.
#[derive(Clone, Debug)]
pub enum Form {
    /// The area within these corners.
    Polygon(Vec<DVec2>),
    /// The line through these points.
    Path(Vec<DVec2>),
    /// A circle, never smaller than `least` pixels.
    Disc {
        /// Its middle.
        centre: DVec2,
        /// Its radius in metres.
        radius: f64,
        /// Least radius in pixels.
        least: f64,
    },
    /// A straight line, never shorter than `least` pixels.
    Needle {
        /// Where it begins, and its direction.
        pose: Pose,
        /// Its length in metres.
        length: f64,
        /// Least length in pixels.
        least: f64,
    },
    /// An arrow of constant size.
    Arrow(Pose),
    /// A cross of constant size.
    Cross(DVec2),
}

/// A colour that may let through what is below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paint {
    /// The colour.
    pub colour: RGBColor,
    /// 1 for what covers, 0 for nothing.
    pub opacity: f64,
}

/// A line's paint and width.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// Its colour.
    pub paint: Paint,
    /// Its width in pixels.
    pub width: f64,
}

/// Words at a place.
#[derive(Clone, Debug)]
pub struct Label {
    /// What stands there.
    pub text: String,
    /// The place that it belongs to.
    pub at: DVec2,
    /// Metres around the place that it should leave free.
    pub clearance: f64,
    /// Least pixels around the place that it should leave free.
    pub least: f64,
    /// Where it had best stand, as seen from the place; zero if that does not matter.
    pub direction: DVec2,
}

/// A line of the legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The sign.
    pub symbol: Symbol,
    /// What it means.
    pub text: String,
}

/// A sign of the legend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Symbol {
    /// A circle, filled or not, with an outline.
    Disc(Option<Paint>, Line),
    /// A square, filled or not, with an outline.
    Square(Option<Paint>, Line),
    /// A line.
    Line(Line),
    /// A line with a dot where it begins.
    Beam(Line),
    /// A part of a circle.
    Sector(Paint, Line),
    /// The arrow of a start.
    Arrow(Line),
    /// The cross of a contact.
    Cross(Line),
}

impl Drawing {
    /// A picture without anything below its title.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), ..Self::default() }
    }

    /// Makes sure that `point` is in the picture.
    pub fn include(&mut self, point: DVec2) {
        if point.is_finite() {
            let (low, high) = self.extent.unwrap_or((point, point));
            self.extent = Some((low.min(point), high.max(point)));
        }
    }

    /// Makes sure that all within `radius` metres of `centre` is in the picture.
    pub fn include_around(&mut self, centre: DVec2, radius: f64) {
        self.include(centre - DVec2::splat(radius));
        self.include(centre + DVec2::splat(radius));
    }

    /// Lower left and upper right corner of what must be in the picture; a square metre where there is nothing.
    pub fn extent(&self) -> (DVec2, DVec2) {
        self.extent.unwrap_or((DVec2::ZERO, DVec2::ONE))
    }

    /// Adds a shape above all others.
    pub fn push(&mut self, shape: Shape) {
        self.shapes.push(shape);
    }

    /// Adds a line to the legend unless it is there.
    pub fn explain(&mut self, symbol: Symbol, text: impl Into<String>) {
        let entry = Entry { symbol, text: text.into() };
        if !self.legend.contains(&entry) {
            self.legend.push(entry);
        }
    }
}

impl Shape {
    /// An area without an outline.
    pub fn filled(form: Form, fill: Paint) -> Self {
        Self { form, fill: Some(fill), line: None, detail: f64::INFINITY }
    }

    /// An outline, or a line.
    pub fn outlined(form: Form, line: Line) -> Self {
        Self { form, fill: None, line: Some(line), detail: f64::INFINITY }
    }

    /// The same with an outline.
    pub fn with_line(self, line: Line) -> Self {
        Self { line: Some(line), ..self }
    }

    /// The same, left out where `size` metres are too few pixels.
    pub fn detail(self, size: f64) -> Self {
        Self { detail: size, ..self }
    }
}

impl Paint {
    /// A colour that covers what is below it.
    pub const fn solid(colour: RGBColor) -> Self {
        Self { colour, opacity: 1.0 }
    }

    /// A colour of this `opacity`.
    pub const fn veil(colour: RGBColor, opacity: f64) -> Self {
        Self { colour, opacity }
    }
}

impl Line {
    /// A line of this `width` in pixels that covers what is below it.
    pub const fn solid(colour: RGBColor, width: f64) -> Self {
        Self { paint: Paint::solid(colour), width }
    }
}
