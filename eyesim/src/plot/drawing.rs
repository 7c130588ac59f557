//! Contents of a picture in metres of the world: shapes with their paint, labels, a legend. Independent of the
//! picture's scale.

use std::sync::Arc;

use glam::DVec2;
use plotters::style::RGBColor;
use sim_core::pose::Pose;
use sim_core::scene::Texture;

/// Everything in a picture, as input of `render`. Later shapes cover earlier ones.
#[derive(Clone, Debug, Default)]
pub struct Drawing {
    /// Title, shown above the picture.
    pub title: String,
    /// An image below all shapes.
    pub backdrop: Option<Backdrop>,
    /// The shapes, the lowest first.
    pub shapes: Vec<Shape>,
    /// Labels, above all shapes.
    pub labels: Vec<Label>,
    /// Meanings of the shapes.
    pub legend: Vec<LegendEntry>,
    /// Opposite corners of the area that must be visible.
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

/// A geometric form with its paint.
#[derive(Clone, Debug)]
pub struct Shape {
    /// Its form and position.
    pub form: Form,
    /// Colour of its interior.
    pub fill: Option<Paint>,
    /// Paint and width of its outline.
    pub line: Option<Line>,
    /// Size in metres: the shape is omitted if this is too few pixels. Infinite for a shape that is always drawn.
    pub detail: f64,
}

/// A geometric form in world coordinates.
#[derive(Clone, Debug)]
pub enum Form {
    /// The area within these corners.
    Polygon(Vec<DVec2>),
    /// The line through these points.
    Path(Vec<DVec2>),
    /// A circle with a radius of at least `min_radius_px`.
    Disc {
        /// Its middle.
        centre: DVec2,
        /// Its radius in metres.
        radius: f64,
        /// Minimum radius in pixels.
        min_radius_px: f64,
    },
    /// A straight line of at least `min_length_px`.
    Needle {
        /// Its start and direction.
        pose: Pose,
        /// Its length in metres.
        length: f64,
        /// Minimum length in pixels.
        min_length_px: f64,
    },
    /// An arrow of constant size.
    Arrow(Pose),
    /// A cross of constant size.
    Cross(DVec2),
}

/// A colour with an opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Paint {
    /// The colour.
    pub colour: RGBColor,
    /// 1 for opaque, 0 for invisible.
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

/// Text beside a point.
#[derive(Clone, Debug)]
pub struct Label {
    /// The text.
    pub text: String,
    /// The labelled point.
    pub at: DVec2,
    /// Radius around the point that the text must not cover, in metres.
    pub clearance: f64,
    /// Minimum of `clearance`, in pixels.
    pub min_clearance_px: f64,
    /// Preferred direction of the text from the point; zero for none.
    pub direction: DVec2,
}

/// A line of the legend.
#[derive(Clone, Debug, PartialEq)]
pub struct LegendEntry {
    /// The symbol.
    pub symbol: Symbol,
    /// Its meaning.
    pub text: String,
}

/// A symbol of the legend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Symbol {
    /// A circle, filled or not, with an outline.
    Disc(Option<Paint>, Line),
    /// A square, filled or not, with an outline.
    Square(Option<Paint>, Line),
    /// A line.
    Line(Line),
    /// A line with a dot at its start.
    Beam(Line),
    /// A sector of a circle.
    Sector(Paint, Line),
    /// The arrow of a start.
    Arrow(Line),
    /// The cross of a contact.
    Cross(Line),
}

impl Drawing {
    /// An empty picture with a title.
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), ..Self::default() }
    }

    /// Extends the visible area to `point`, if it is finite.
    pub fn include(&mut self, point: DVec2) {
        if point.is_finite() {
            let (low, high) = self.extent.unwrap_or((point, point));
            self.extent = Some((low.min(point), high.max(point)));
        }
    }

    /// Extends the visible area to everything within `radius` metres of `centre`.
    pub fn include_around(&mut self, centre: DVec2, radius: f64) {
        self.include(centre - DVec2::splat(radius));
        self.include(centre + DVec2::splat(radius));
    }

    /// Lower left and upper right corner of the area that must be visible; a square metre if nothing was included.
    pub fn extent(&self) -> (DVec2, DVec2) {
        self.extent.unwrap_or((DVec2::ZERO, DVec2::ONE))
    }

    /// Adds a shape above all others.
    pub fn push(&mut self, shape: Shape) {
        self.shapes.push(shape);
    }

    /// Adds a line to the legend, unless it is there already.
    pub fn add_legend(&mut self, symbol: Symbol, text: impl Into<String>) {
        let entry = LegendEntry { symbol, text: text.into() };
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

    /// Returns the shape with an outline.
    pub fn with_line(self, line: Line) -> Self {
        Self { line: Some(line), ..self }
    }

    /// Returns the shape as a detail: it is omitted if `size` metres are too few pixels.
    pub fn detail(self, size: f64) -> Self {
        Self { detail: size, ..self }
    }
}

impl Paint {
    /// Opaque colour.
    pub const fn solid(colour: RGBColor) -> Self {
        Self { colour, opacity: 1.0 }
    }

    /// A colour of this `opacity`.
    pub const fn translucent(colour: RGBColor, opacity: f64) -> Self {
        Self { colour, opacity }
    }
}

impl Line {
    /// Opaque line of this `width` in pixels.
    pub const fn solid(colour: RGBColor, width: f64) -> Self {
        Self { paint: Paint::solid(colour), width }
    }
}
