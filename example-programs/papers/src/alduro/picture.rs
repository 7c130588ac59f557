//! Heights as colours: maps side by side with one scale, and paths over them.

use std::fmt::Write as _;

use anyhow::Context as _;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use mapping::grid::{Grid, GridGeometry, png};
use mapping::pose::Point;

use crate::page::{Picture, escaped};

/// Colours from the lowest to the highest place (red, green, blue): violet through blue and green to yellow. Brightness
/// grows with height (our choice, after viridis by Smith and van der Walt).
const COLOURS: [[f64; 3]; 5] =
    [[68.0, 1.0, 84.0], [59.0, 82.0, 139.0], [33.0, 145.0, 140.0], [94.0, 201.0, 98.0], [253.0, 231.0, 37.0]];
/// Colour of unknown places.
const NOTHING: [u8; 3] = [200, 200, 200];
/// Margin around a panel for its title and its axes, in pixels.
const ROOM: f64 = 34.0;

/// One map.
pub struct Panel<'a> {
    pub title: String,
    pub height: Box<dyn Fn(f64, f64) -> Option<f64> + 'a>,
    /// Paths over the map, each with its colour, m.
    pub paths: Vec<(&'a str, Vec<(f64, f64)>)>,
}

/// Maps of the square from (0, 0) to (`side`, `side`), m, each `pixels` wide, all with the colours of heights from
/// `low` to `high`, m.
pub fn maps(side: f64, pixels: usize, (low, high): (f64, f64), panels: &[Panel<'_>]) -> anyhow::Result<Picture> {
    let (size, step) = (pixels as f64, pixels as f64 + ROOM);
    let columns = panels.len().min(2);
    let rows = panels.len().div_ceil(2);
    let (width, height) = (columns as f64 * step + ROOM + 60.0, rows as f64 * (step + 8.0) + ROOM);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"DejaVu Sans, sans-serif\" font-size=\"11\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    for (index, panel) in panels.iter().enumerate() {
        let (left, top) = (ROOM + (index % 2) as f64 * step, ROOM - 8.0 + (index / 2) as f64 * (step + 8.0));
        draw(&mut svg, panel, side, (left, top, size), (low, high))?;
    }
    let (left, top) = (width - 58.0, ROOM);
    let bar = size.min(260.0);
    for part in 0..64 {
        let fraction = 1.0 - part as f64 / 63.0;
        let [r, g, b] = colour(Some(low + fraction * (high - low)), low, high);
        let (y, h) = (top + part as f64 * bar / 64.0, bar / 64.0 + 0.5);
        let _ =
            writeln!(svg, "<rect x=\"{left}\" y=\"{y:.2}\" width=\"14\" height=\"{h:.2}\" fill=\"rgb({r},{g},{b})\"/>");
    }
    for part in 0..=4 {
        let fraction = part as f64 / 4.0;
        let (y, value) = (top + (1.0 - fraction) * bar + 4.0, low + fraction * (high - low));
        let _ = writeln!(svg, "<text x=\"{}\" y=\"{y:.1}\">{value:.2} m</text>", left + 17.0);
    }
    svg += "</svg>\n";
    Ok(Picture::Svg(svg))
}

fn draw(
    svg: &mut String,
    panel: &Panel<'_>,
    side: f64,
    (left, top, size): (f64, f64, f64),
    (low, high): (f64, f64),
) -> anyhow::Result<()> {
    const CELLS: usize = 200;
    let frame = GridGeometry::new(Point::new(0.0, 0.0), side / CELLS as f64, CELLS, CELLS);
    let grid = Grid::from_fn(frame, |cell| {
        let middle = frame.centre(cell);
        (panel.height)(middle.x, middle.y)
    });
    let image = png(&grid.picture(1, |height| colour(*height, low, high))).context("a picture of a map")?;
    let data = STANDARD.encode(image);
    let title = escaped(&panel.title);
    let _ = writeln!(
        svg,
        "<text x=\"{left}\" y=\"{}\">{title}</text>\n<image x=\"{left}\" y=\"{top}\" width=\"{size}\" height=\"{size}\" \
         preserveAspectRatio=\"none\" href=\"data:image/png;base64,{data}\"/>\n\
         <rect x=\"{left}\" y=\"{top}\" width=\"{size}\" height=\"{size}\" fill=\"none\" stroke=\"#444\"/>",
        top - 5.0
    );
    // One fifth of the side (10 m or 40 m) is a whole number of metres.
    for part in 0..=5 {
        let fraction = part as f64 / 5.0;
        let (value, x, y) = (fraction * side, left + fraction * size, top + (1.0 - fraction) * size);
        let _ = writeln!(
            svg,
            "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{value:.0}</text>\n\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{value:.0}</text>",
            top + size + 12.0,
            left - 3.0,
            y + 4.0
        );
    }
    for (stroke, path) in &panel.paths {
        let points: Vec<String> = path
            .iter()
            .map(|(x, y)| format!("{:.1},{:.1}", left + x / side * size, top + (1.0 - y / side) * size))
            .collect();
        let points = points.join(" ");
        let _ = writeln!(svg, "<polyline points=\"{points}\" fill=\"none\" stroke=\"{stroke}\" stroke-width=\"2\"/>");
    }
    Ok(())
}

fn colour(height: Option<f64>, low: f64, high: f64) -> [u8; 3] {
    let Some(height) = height else { return NOTHING };
    let position = ((height - low) / (high - low)).clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let below = (position as usize).min(COLOURS.len() - 2);
    let fraction = position - below as f64;
    std::array::from_fn(|index| {
        let (from, to) = (COLOURS[below][index], COLOURS[below + 1][index]);
        (from + fraction * (to - from)).round() as u8
    })
}
