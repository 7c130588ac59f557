//! Drawing in pixels on any plotters backend.

use std::sync::Once;

use glam::DVec2;
use plotters::backend::{BitMapBackend, DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontDesc, FontFamily, FontStyle, FontTransform, ShapeStyle, TextStyle, register_font};
use sim_core::scene::Texture;

use super::PlotError;
use super::drawing::{Line, Paint};

/// Height of text, in pixels.
pub const TEXT: f64 = 12.0;
/// Height of the title, in pixels.
pub const TITLE: f64 = 14.0;

/// Fraction of white mixed into an image on the floor, so that bodies on it remain visible.
const WHITENESS: f64 = 0.35;
/// Maximum total turn of a path that is drawn in one piece, in radians: our choice, below half a turn.
const MAX_TURN: f64 = 2.3;

/// A backend that can show an image.
pub trait Surface: DrawingBackend {
    /// Shows an image, stretched over the rectangle of `size` units whose upper left corner is `at`.
    ///
    /// # Errors
    /// Errors of the backend.
    fn image(&mut self, at: (i32, i32), size: (u32, u32), texture: &Texture) -> Result<(), PlotError>;
}

impl Surface for BitMapBackend<'_> {
    fn image(&mut self, at: (i32, i32), size: (u32, u32), texture: &Texture) -> Result<(), PlotError> {
        let mut pixels = Vec::with_capacity(3 * size.0 as usize * size.1 as usize);
        for row in 0..size.1 {
            for column in 0..size.0 {
                let (u, v) =
                    ((f64::from(column) + 0.5) / f64::from(size.0), (f64::from(row) + 0.5) / f64::from(size.1));
                pixels.extend(lightened(texture.sample(u, 1.0 - v)));
            }
        }
        check(self.blit_bitmap(at, size, &pixels))
    }
}

impl Surface for SVGBackend<'_> {
    /// Does nothing: the SVG backend of plotters does not support images. `to_svg` inserts the image afterwards.
    fn image(&mut self, _: (i32, i32), _: (u32, u32), _: &Texture) -> Result<(), PlotError> {
        Ok(())
    }
}

/// Colour of a pixel of an image on the floor: laid over white by its opacity, then lightened.
pub fn lightened([red, green, blue, opacity]: [u8; 4]) -> [u8; 3] {
    let weight = f64::from(opacity) / 255.0 * (1.0 - WHITENESS);
    [red, green, blue].map(|colour| (f64::from(colour) * weight + 255.0 * (1.0 - weight)).round() as u8)
}

/// Position of a text relative to its point.
#[derive(Clone, Copy)]
pub struct Anchor {
    /// Horizontal alignment; with `Left`, the text begins at its point.
    pub horizontal: HPos,
    /// Vertical alignment; with `Top`, the text is below its point.
    pub vertical: VPos,
}

impl Anchor {
    /// The text begins at its point, vertically centred.
    pub const START: Self = Self { horizontal: HPos::Left, vertical: VPos::Center };
    /// The text ends at its point, vertically centred.
    pub const END: Self = Self { horizontal: HPos::Right, vertical: VPos::Center };
    /// The text is below its point, horizontally centred.
    pub const BELOW: Self = Self { horizontal: HPos::Center, vertical: VPos::Top };
}

/// Backend with several units per pixel, since plotters takes integer coordinates only.
pub struct Canvas<'b, B> {
    backend: &'b mut B,
    /// Units per pixel.
    unit: i32,
}

impl<'b, B: Surface> Canvas<'b, B> {
    /// Creates a canvas on `backend`, with `unit` units of the backend per pixel.
    pub fn new(backend: &'b mut B, unit: i32) -> Self {
        register_fonts();
        Self { backend, unit }
    }

    /// Fills the polygon with these corners.
    ///
    /// # Errors
    /// Errors of the backend.
    pub fn area(&mut self, corners: &[DVec2], fill: Paint) -> Result<(), PlotError> {
        if corners.len() < 3 {
            return Ok(());
        }
        let points = self.all_to_units(corners);
        check(self.backend.fill_polygon(points, &filled_style(fill)))
    }

    /// Fills the rectangle from its upper left to its lower right corner.
    ///
    /// # Errors
    /// Errors of the backend.
    pub fn rectangle(&mut self, from: DVec2, to: DVec2, fill: Paint) -> Result<(), PlotError> {
        let (from, to) = (self.to_units(from), self.to_units(to));
        check(self.backend.draw_rect(from, to, &filled_style(fill), true))
    }

    /// Draws the line through `points`.
    ///
    /// # Errors
    /// Errors of the backend.
    pub fn path(&mut self, points: &[DVec2], line: Line) -> Result<(), PlotError> {
        if points.len() < 2 {
            return Ok(());
        }
        let style = self.stroke(line);
        // The pixel backend fills the outline of a stroke by the even-odd rule, so that a self-intersecting path would
        // have gaps, and joins segments with mitres, which become long spikes where a path turns back. So the path is
        // cut before its turns add up to half a turn: until then it advances in one direction.
        let mut total_turn = 0.0;
        let is_cut = |index: &usize| {
            let turn = (points[*index] - points[index - 1]).angle_to(points[index + 1] - points[*index]).abs();
            total_turn = if total_turn + turn > MAX_TURN { 0.0 } else { total_turn + turn };
            turn > 0.0 && total_turn == 0.0
        };
        let cuts = (1..points.len().saturating_sub(1)).filter(is_cut).chain([points.len().saturating_sub(1)]);
        let mut from = 0;
        for cut in cuts {
            let part = self.all_to_units(points.get(from..=cut).unwrap_or(points));
            check(self.backend.draw_path(part, &style))?;
            from = cut;
        }
        Ok(())
    }

    /// Draws a circle, filled or not.
    ///
    /// # Errors
    /// Errors of the backend.
    pub fn disc(
        &mut self,
        centre: DVec2,
        radius: f64,
        fill: Option<Paint>,
        line: Option<Line>,
    ) -> Result<(), PlotError> {
        let (centre, radius) = (self.to_units(centre), (radius * f64::from(self.unit)).round().max(1.0) as u32);
        if let Some(fill) = fill {
            check(self.backend.draw_circle(centre, radius, &filled_style(fill), true))?;
        }
        if let Some(line) = line {
            let style = self.stroke(line);
            check(self.backend.draw_circle(centre, radius, &style, false))?;
        }
        Ok(())
    }

    /// Draws a line of text of `height` pixels.
    ///
    /// # Errors
    /// Errors of the backend.
    pub fn text(&mut self, text: &str, at: DVec2, height: f64, anchor: Anchor, paint: Paint) -> Result<(), PlotError> {
        self.rotated_text(text, at, height, anchor, paint, FontTransform::None)
    }

    /// Draws a line of text that reads upwards.
    ///
    /// # Errors
    /// Errors of the backend.
    pub fn upward_text(&mut self, text: &str, at: DVec2, height: f64, paint: Paint) -> Result<(), PlotError> {
        self.rotated_text(text, at, height, Anchor::BELOW, paint, FontTransform::Rotate270)
    }

    fn rotated_text(
        &mut self,
        text: &str,
        at: DVec2,
        height: f64,
        anchor: Anchor,
        paint: Paint,
        rotation: FontTransform,
    ) -> Result<(), PlotError> {
        let font = font(height * f64::from(self.unit)).transform(rotation);
        let colour = paint.colour.mix(paint.opacity);
        let style = TextStyle::from(font).color(&colour).pos(Pos::new(anchor.horizontal, anchor.vertical));
        let at = self.to_units(at);
        check(self.backend.draw_text(text, &style, at))
    }

    /// Draws an image, stretched over the rectangle from its upper left to its lower right corner.
    ///
    /// # Errors
    /// Errors of the backend.
    pub fn image(&mut self, from: DVec2, to: DVec2, texture: &Texture) -> Result<(), PlotError> {
        let (from, to) = (self.to_units(from), self.to_units(to));
        let size = ((to.0 - from.0).max(0) as u32, (to.1 - from.1).max(0) as u32);
        self.backend.image(from, size, texture)
    }

    /// Finishes the picture.
    ///
    /// # Errors
    /// Errors of the backend.
    pub fn finish(self) -> Result<(), PlotError> {
        check(self.backend.present())
    }

    fn to_units(&self, point: DVec2) -> (i32, i32) {
        let point = (point * f64::from(self.unit)).round();
        (point.x as i32, point.y as i32)
    }

    fn all_to_units(&self, points: &[DVec2]) -> Vec<(i32, i32)> {
        points.iter().map(|point| self.to_units(*point)).collect()
    }

    fn stroke(&self, line: Line) -> ShapeStyle {
        let width = (line.width * f64::from(self.unit)).round().max(1.0);
        ShapeStyle { filled: false, stroke_width: width as u32, ..filled_style(line.paint) }
    }
}

/// Width in pixels of a text of `height` pixels.
pub fn text_width(text: &str, height: f64) -> f64 {
    register_fonts();
    // The text is measured at a larger size, since plotters rounds to integer units.
    const MAGNIFICATION: f64 = 16.0;
    let estimate = 0.6 * height * text.chars().count() as f64;
    font(height * MAGNIFICATION)
        .layout_box(text)
        .map_or(estimate, |(low, high)| f64::from(high.0 - low.0) / MAGNIFICATION)
}

fn filled_style(paint: Paint) -> ShapeStyle {
    ShapeStyle { color: paint.colour.mix(paint.opacity), filled: true, stroke_width: 0 }
}

fn font(size: f64) -> FontDesc<'static> {
    FontDesc::new(FontFamily::SansSerif, size, FontStyle::Normal)
}

/// Registers the embedded font with plotters, once: pictures must not depend on installed fonts.
pub fn register_fonts() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // A failure is not reported here: without the font, every test of a picture would fail.
        let _ = register_font("sans-serif", FontStyle::Normal, dejavu::sans::regular());
    });
}

fn check<T, E: std::fmt::Display>(result: Result<T, E>) -> Result<T, PlotError> {
    result.map_err(|error| PlotError::Draw(error.to_string()))
}
