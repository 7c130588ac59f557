//! Renders a drawing as SVG text or PNG bytes: axes, shapes, labels, legend.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;
use glam::DVec2;
use plotters::backend::{BitMapBackend, SVGBackend};
use sim_core::math;
use sim_host::record::png;

use super::PlotError;
use super::canvas::{Anchor, Canvas, Surface, TEXT, TITLE, lightened, text_width};
use super::colour::{GRID, INK, PAPER};
use super::drawing::{Backdrop, Drawing, Form, Line, Paint, Shape, Symbol};
use super::label::{Labels, Obstacle};
use super::viewport::{LEFT, LEGEND, RIGHT, TOP, Viewport, metres, round_step};

/// Units per pixel: a quarter of a pixel is fine enough for the eye.
const UNIT: i32 = 4;
/// PNG pictures with more pixels than this are drawn with half the units per pixel, to save memory.
const MANY_PIXELS: u64 = 4_000_000;
/// Details smaller than this number of pixels are omitted.
const MIN_DETAIL: f64 = 5.0;
/// Height of a line of the legend in pixels.
const ROW: f64 = 18.0;
/// Minimum distance of the ticks of an axis in pixels.
const MIN_TICK_DISTANCE: f64 = 50.0;
/// Minimum length of the scale bar in pixels.
const MIN_SCALE_BAR: f64 = 60.0;

const TEXT_PAINT: Paint = Paint::solid(INK);
const AXIS: Line = Line::solid(INK, 1.0);

/// The picture as SVG text; `size` is in pixels, see [`super::PictureKind::render`].
///
/// # Errors
/// [`PlotError::Draw`] if the drawing library fails.
pub fn to_svg(drawing: &Drawing, size: Option<(u32, u32)>) -> Result<String, PlotError> {
    let (low, high) = drawing.extent();
    let viewport = Viewport::around(low, high, size);
    let (width, height) = viewport.picture_size();
    let units = (width * UNIT as u32, height * UNIT as u32);
    let mut svg = String::new();
    {
        let mut backend = SVGBackend::with_string(&mut svg, units);
        Painter { viewport: &viewport, canvas: Canvas::new(&mut backend, UNIT) }.paint(drawing)?;
    }
    // The picture is drawn in fine units and shown at its size in pixels.
    let fine = format!("width=\"{}\" height=\"{}\"", units.0, units.1);
    let mut svg = svg.replacen(&fine, &format!("width=\"{width}\" height=\"{height}\""), 1);
    if let Some(backdrop) = &drawing.backdrop {
        // The image lies above the paper, which is the first rectangle, and below all other shapes.
        let end = svg.find("/>\n").map_or(svg.len(), |end| end + 3);
        svg.insert_str(end, &svg_image(backdrop, &viewport)?);
    }
    Ok(svg)
}

/// The picture as the bytes of a PNG file.
///
/// # Errors
/// [`PlotError::Draw`] if the drawing library fails.
pub fn to_png(drawing: &Drawing, size: Option<(u32, u32)>) -> Result<Vec<u8>, PlotError> {
    let (low, high) = drawing.extent();
    let viewport = Viewport::around(low, high, size);
    let (width, height) = viewport.picture_size();
    let unit = if u64::from(width) * u64::from(height) > MANY_PIXELS { UNIT / 2 } else { UNIT };
    let fine = (width * unit as u32, height * unit as u32);
    let mut buffer = vec![0; 3 * fine.0 as usize * fine.1 as usize];
    {
        let mut backend = BitMapBackend::with_buffer(&mut buffer, fine);
        Painter { viewport: &viewport, canvas: Canvas::new(&mut backend, unit) }.paint(drawing)?;
    }
    png(width, height, &mean_of_blocks(&buffer, fine.0 as usize, unit as usize))
}

/// Downsamples an image: each square of `side` times `side` pixels becomes one pixel, their mean. This smooths edges.
fn mean_of_blocks(pixels: &[u8], width: usize, side: usize) -> Vec<u8> {
    let mut means = Vec::with_capacity(pixels.len() / (side * side));
    let mut sums = vec![0u32; 3 * (width / side)];
    for rows in pixels.chunks_exact(3 * width * side) {
        sums.fill(0);
        for row in rows.chunks_exact(3 * width) {
            for (block, sum) in row.chunks_exact(3 * side).zip(sums.chunks_exact_mut(3)) {
                for pixel in block.chunks_exact(3) {
                    sum.iter_mut().zip(pixel).for_each(|(sum, part)| *sum += u32::from(*part));
                }
            }
        }
        let count = (side * side) as u32;
        means.extend(sums.iter().map(|sum| ((sum + count / 2) / count) as u8));
    }
    means
}

fn png(width: u32, height: u32, pixels: &[u8]) -> Result<Vec<u8>, PlotError> {
    if pixels.is_empty() {
        return Err(PlotError::Draw("the picture has no pixels".to_owned()));
    }
    Ok(png::colour([width, height], pixels))
}

/// The image on the floor as an element of SVG.
fn svg_image(backdrop: &Backdrop, viewport: &Viewport) -> Result<String, PlotError> {
    let (from, to) = corners_of(backdrop, viewport);
    let (columns, rows) = backdrop.texture.size();
    let pixels = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
    let pixels = pixels.flat_map(|(column, row)| lightened(backdrop.texture.pixel(column, row)));
    let data = BASE64_STANDARD.encode(png(columns, rows, &pixels.collect::<Vec<u8>>())?);
    let unit = f64::from(UNIT);
    let mut element = String::new();
    let _ = writeln!(
        element,
        "<image x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" preserveAspectRatio=\"none\" \
         href=\"data:image/png;base64,{data}\"/>",
        from.x * unit,
        from.y * unit,
        (to.x - from.x) * unit,
        (to.y - from.y) * unit,
    );
    Ok(element)
}

/// Upper left and lower right corner of the backdrop, in pixels.
fn corners_of(backdrop: &Backdrop, viewport: &Viewport) -> (DVec2, DVec2) {
    let [low, high] = backdrop.corners.map(|corner| viewport.pixel_of(corner));
    (low.min(high), low.max(high))
}

struct Painter<'a, 'b, B> {
    viewport: &'a Viewport,
    canvas: Canvas<'b, B>,
}

impl<B: Surface> Painter<'_, '_, B> {
    fn paint(mut self, drawing: &Drawing) -> Result<(), PlotError> {
        let (width, height) = self.viewport.picture_size();
        let picture_size = DVec2::new(f64::from(width), f64::from(height));
        self.canvas.rectangle(DVec2::ZERO, picture_size, Paint::solid(PAPER))?;
        if let Some(backdrop) = &drawing.backdrop {
            let (from, to) = corners_of(backdrop, self.viewport);
            self.canvas.image(from, to, &backdrop.texture)?;
        }
        let title = shortened(&drawing.title, TITLE, picture_size.x - LEFT - RIGHT);
        self.canvas.text(&title, DVec2::new(LEFT, 18.0), TITLE, Anchor::START, TEXT_PAINT)?;
        // The floor, the first shape, lies below the grid.
        let (ground, others) = drawing.shapes.split_at(drawing.shapes.len().min(1));
        self.shapes(ground)?;
        self.axes()?;
        self.shapes(others)?;
        self.labels(drawing)?;
        self.legend(drawing)?;
        self.canvas.finish()
    }

    /// Draws the grid, the ticks with their numbers, and the names of the axes.
    fn axes(&mut self) -> Result<(), PlotError> {
        let (low, high) = self.viewport.corners();
        let step = round_step(MIN_TICK_DISTANCE / self.viewport.scale());
        let (corner, opposite) = (self.viewport.pixel_of(low), self.viewport.pixel_of(high));
        let grid = Line { paint: Paint::translucent(GRID, 0.8), width: 1.0 };
        for value in ticks(low.x, high.x, step) {
            let x = self.viewport.pixel_of(DVec2::new(value, low.y)).x;
            self.canvas.path(&[DVec2::new(x, opposite.y), DVec2::new(x, corner.y)], grid)?;
            self.canvas.path(&[DVec2::new(x, corner.y), DVec2::new(x, corner.y + 5.0)], AXIS)?;
            let at = DVec2::new(x, corner.y + 8.0);
            self.canvas.text(&metres(value, step), at, TEXT, Anchor::BELOW, TEXT_PAINT)?;
        }
        for value in ticks(low.y, high.y, step) {
            let y = self.viewport.pixel_of(DVec2::new(low.x, value)).y;
            self.canvas.path(&[DVec2::new(corner.x, y), DVec2::new(opposite.x, y)], grid)?;
            self.canvas.path(&[DVec2::new(corner.x - 5.0, y), DVec2::new(corner.x, y)], AXIS)?;
            let at = DVec2::new(corner.x - 8.0, y);
            self.canvas.text(&metres(value, step), at, TEXT, Anchor::END, TEXT_PAINT)?;
        }
        self.canvas.path(&[DVec2::new(corner.x, opposite.y), corner, DVec2::new(opposite.x, corner.y)], AXIS)?;
        let middle = 0.5 * (corner + opposite);
        self.canvas.text("x in m", DVec2::new(middle.x, corner.y + 28.0), TEXT, Anchor::BELOW, TEXT_PAINT)?;
        self.canvas.upward_text("y in m", DVec2::new(14.0, middle.y), TEXT, TEXT_PAINT)
    }

    fn shapes(&mut self, shapes: &[Shape]) -> Result<(), PlotError> {
        // Pixels at which a cross has been drawn: coinciding crosses are drawn once.
        let mut crosses = BTreeSet::new();
        for shape in shapes {
            if shape.detail * self.viewport.scale() < MIN_DETAIL {
                continue;
            }
            if let Form::Cross(point) = shape.form {
                let pixel = self.viewport.pixel_of(point).round();
                if !crosses.insert((pixel.x as i64, pixel.y as i64)) {
                    continue;
                }
            }
            self.shape(shape)?;
        }
        Ok(())
    }

    fn shape(&mut self, shape: &Shape) -> Result<(), PlotError> {
        match &shape.form {
            Form::Polygon(corners) => {
                if let Some(fill) = shape.fill {
                    let corners = self.viewport.clip_area(corners);
                    self.canvas.area(&self.pixels_of(&corners), fill)?;
                }
                let mut outline = corners.clone();
                outline.extend(corners.first());
                shape.line.map_or(Ok(()), |line| self.path(&outline, line))
            }
            Form::Path(points) => shape.line.map_or(Ok(()), |line| self.path(points, line)),
            Form::Disc { centre, radius, min_radius_px } => {
                if !self.viewport.contains(*centre) {
                    return Ok(());
                }
                let radius = (radius * self.viewport.scale()).max(*min_radius_px);
                self.canvas.disc(self.viewport.pixel_of(*centre), radius, shape.fill, shape.line)
            }
            Form::Needle { pose, length, min_length_px } => {
                let length = length.max(min_length_px / self.viewport.scale());
                let points = [pose.position, pose.position + pose.heading.direction() * length];
                shape.line.map_or(Ok(()), |line| self.path(&points, line))
            }
            Form::Arrow(pose) => {
                let direction = pose.heading.direction();
                shape.line.map_or(Ok(()), |line| self.arrow(self.viewport.pixel_of(pose.position), direction, line))
            }
            Form::Cross(point) => shape.line.map_or(Ok(()), |line| self.cross(self.viewport.pixel_of(*point), line)),
        }
    }

    fn path(&mut self, points: &[DVec2], line: Line) -> Result<(), PlotError> {
        for part in self.viewport.clip_path(points) {
            self.canvas.path(&self.pixels_of(&part), line)?;
        }
        Ok(())
    }

    fn pixels_of(&self, points: &[DVec2]) -> Vec<DVec2> {
        points.iter().map(|point| self.viewport.pixel_of(*point)).collect()
    }

    /// Draws an arrow of 20 pixels from `at` (in pixels) along `direction`, a unit vector in the world frame.
    fn arrow(&mut self, at: DVec2, direction: DVec2, line: Line) -> Result<(), PlotError> {
        let forward = DVec2::new(direction.x, -direction.y);
        let tip = at + 20.0 * forward;
        let barb = |side: f64| tip - 7.0 * forward + side * 4.0 * forward.perp();
        self.canvas.path(&[at, tip - 3.0 * forward], line)?;
        self.canvas.area(&[tip, barb(1.0), barb(-1.0)], line.paint)
    }

    fn cross(&mut self, at: DVec2, line: Line) -> Result<(), PlotError> {
        for arm in [DVec2::new(4.0, 4.0), DVec2::new(4.0, -4.0)] {
            self.canvas.path(&[at - arm, at + arm], line)?;
        }
        Ok(())
    }

    fn labels(&mut self, drawing: &Drawing) -> Result<(), PlotError> {
        let obstacles = drawing.labels.iter().map(|label| Obstacle::around(label, self.viewport));
        let mut labels = Labels::new(self.viewport, obstacles.collect());
        for label in &drawing.labels {
            let Some((corner, text)) = labels.place(label) else { continue };
            // A translucent background separates the text from the lines below it.
            let (width, height) = (text_width(&text, TEXT), TEXT + 2.0);
            let background = Paint::translucent(PAPER, 0.7);
            self.canvas.rectangle(corner, corner + DVec2::new(width, height), background)?;
            let at = corner + DVec2::new(0.0, 0.5 * height);
            self.canvas.text(&text, at, TEXT, Anchor::START, TEXT_PAINT)?;
        }
        Ok(())
    }

    /// Draws the scale bar, and as many lines of the legend as fit.
    fn legend(&mut self, drawing: &Drawing) -> Result<(), PlotError> {
        let (width, height) = self.viewport.picture_size();
        let left_edge = f64::from(width) - LEGEND;
        let row = |index: usize| TOP + ROW * (index as f64 + 0.5);
        let length = round_step(MIN_SCALE_BAR / self.viewport.scale());
        let (from, to) =
            (DVec2::new(left_edge, row(0)), DVec2::new(left_edge + length * self.viewport.scale(), row(0)));
        let serif = DVec2::new(0.0, 4.0);
        self.canvas.path(&[from - serif, from + serif], AXIS)?;
        self.canvas.path(&[from, to], Line::solid(INK, 2.0))?;
        self.canvas.path(&[to - serif, to + serif], AXIS)?;
        let length_text = format!("{} m", metres(length, length));
        self.canvas.text(&length_text, to + DVec2::new(8.0, 0.0), TEXT, Anchor::START, TEXT_PAINT)?;

        let capacity = (((f64::from(height) - TOP - 4.0) / ROW) as usize).saturating_sub(2).max(1);
        let count = if drawing.legend.len() > capacity { capacity - 1 } else { drawing.legend.len() };
        for (index, entry) in drawing.legend[..count].iter().enumerate() {
            let y = row(index + 2);
            self.symbol(entry.symbol, DVec2::new(left_edge + 10.0, y))?;
            let text = shortened(&entry.text, TEXT, LEGEND - 36.0);
            self.canvas.text(&text, DVec2::new(left_edge + 28.0, y), TEXT, Anchor::START, TEXT_PAINT)?;
        }
        if count < drawing.legend.len() {
            let words = format!("and {} more", drawing.legend.len() - count);
            self.canvas.text(&words, DVec2::new(left_edge + 28.0, row(count + 2)), TEXT, Anchor::START, TEXT_PAINT)?;
        }
        Ok(())
    }

    fn symbol(&mut self, symbol: Symbol, at: DVec2) -> Result<(), PlotError> {
        let (left, right) = (at - DVec2::new(10.0, 0.0), at + DVec2::new(10.0, 0.0));
        match symbol {
            Symbol::Disc(fill, line) => self.canvas.disc(at, 5.0, fill, Some(line)),
            Symbol::Square(fill, line) => {
                let corners = [(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0), (-5.0, -5.0)];
                let corners = corners.map(|(x, y)| at + DVec2::new(x, y));
                if let Some(fill) = fill {
                    self.canvas.area(&corners[..4], fill)?;
                }
                self.canvas.path(&corners, line)
            }
            Symbol::Line(line) => self.canvas.path(&[left, right], line),
            Symbol::Beam(line) => {
                self.canvas.path(&[left, right], line)?;
                self.canvas.disc(left, 2.5, Some(line.paint), None)
            }
            Symbol::Sector(fill, line) => {
                let arc = (-3..=3).map(|step| 0.15 * f64::from(step));
                let arc = arc.map(|angle| left + 20.0 * DVec2::new(math::cos(angle), math::sin(angle)));
                let corners: Vec<DVec2> = std::iter::once(left).chain(arc).chain([left]).collect();
                self.canvas.area(&corners, fill)?;
                self.canvas.path(&corners, line)
            }
            Symbol::Arrow(line) => self.arrow(left, DVec2::X, line),
            Symbol::Cross(line) => self.cross(at, line),
        }
    }
}

/// The whole multiples of `step` from `low` to `high`.
fn ticks(low: f64, high: f64, step: f64) -> impl Iterator<Item = f64> {
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    (first..=last).map(move |number| number as f64 * step)
}

/// Shortens `text` to at most `width` pixels; an ellipsis marks the cut.
pub fn shortened(text: &str, height: f64, width: f64) -> String {
    if text_width(text, height) <= width {
        return text.to_owned();
    }
    let mut characters: Vec<char> = text.chars().collect();
    loop {
        characters.pop();
        let cut: String = characters.iter().copied().chain(['\u{2026}']).collect();
        if characters.is_empty() || text_width(&cut, height) <= width {
            return cut;
        }
    }
}
