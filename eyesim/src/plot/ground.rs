//! The world from above: floor with its image, walls, markers, starts.

use std::sync::Arc;

use glam::DVec2;
use plotters::style::RGBColor;
use sim_core::build::MARKER_RADIUS;
use sim_core::scene::{Segment, Texture};
use sim_core::spec::{MarkerSpec, StartSpec, WallSpec, WorldSpec};

use super::colour::{FLOOR, INK, SHADE, WALL};
use super::drawing::{Backdrop, Drawing, Form, Label, Line, Paint, Shape, Symbol};
use super::terrain;

/// Width of walls without thickness, in pixels.
const WALL_WIDTH: f64 = 2.0;
/// Outline of a wall with a thickness.
const EDGE: Line = Line::solid(WALL, 0.75);

/// Draws floor and walls. The floor comes first, so that everything else covers it.
pub fn draw_world(drawing: &mut Drawing, world: &WorldSpec, texture: Option<Arc<Texture>>) {
    let (low, high) = world.bounds();
    drawing.include(low);
    drawing.include(high);
    let corners = [DVec2::ZERO, world.floor];
    if world.floor.cmpgt(DVec2::ZERO).all() {
        let [DVec2 { x: left, y: lower }, DVec2 { x: right, y: upper }] = corners;
        let outline = [(left, lower), (right, lower), (right, upper), (left, upper)].map(|(x, y)| DVec2::new(x, y));
        let terrain = world.terrain.as_ref().and_then(|terrain| terrain.field.as_deref());
        // An image or a terrain has its own colours, so the floor is transparent.
        let paint =
            if texture.is_some() || terrain.is_some() { Paint::translucent(FLOOR, 0.0) } else { Paint::solid(FLOOR) };
        drawing.push(Shape::filled(Form::Polygon(outline.to_vec()), paint));
        drawing.backdrop = texture.map(|texture| Backdrop { corners, texture });
        if let Some(field) = terrain {
            terrain::draw_terrain(drawing, field);
        }
    }
    world.walls.iter().for_each(|wall| draw_wall(drawing, wall));
    if !world.walls.is_empty() {
        drawing.add_legend(Symbol::Line(Line::solid(WALL, WALL_WIDTH)), "wall");
    }
}

fn draw_wall(drawing: &mut Drawing, wall: &WallSpec) {
    let colour = wall.colour.map_or(WALL, |[red, green, blue]| RGBColor(red, green, blue));
    let ends = vec![wall.from, wall.to];
    if wall.thickness > 0.0 {
        let sides = Segment { a: wall.from, b: wall.to }.thickened(wall.thickness);
        let corners: Vec<DVec2> = sides.iter().map(|side| side.a).collect();
        corners.iter().for_each(|corner| drawing.include(*corner));
        // The outline keeps thin walls visible in large worlds, and light walls on a light floor.
        drawing.push(Shape::filled(Form::Polygon(corners), Paint::solid(colour)).with_line(EDGE));
    } else {
        drawing.push(Shape::outlined(Form::Path(ends), Line::solid(colour, WALL_WIDTH)));
    }
}

/// Draws the markers: coloured spots on the floor.
pub fn draw_markers(drawing: &mut Drawing, markers: &[MarkerSpec]) {
    let edge = Line::solid(SHADE, 0.75);
    for marker in markers {
        drawing.include_around(marker.position, MARKER_RADIUS);
        let [red, green, blue, opacity] = marker.colour;
        let paint = Paint::translucent(RGBColor(red, green, blue), f64::from(opacity) / 255.0);
        let form = Form::Disc { centre: marker.position, radius: MARKER_RADIUS, min_radius_px: 3.0 };
        drawing.push(Shape::filled(form, paint).with_line(edge));
    }
    if let Some(marker) = markers.first() {
        let [red, green, blue, _] = marker.colour;
        let paint = Paint::solid(RGBColor(red, green, blue));
        drawing.add_legend(Symbol::Disc(Some(paint), edge), format!("marker ({})", markers.len()));
    }
}

/// Draws the starts of a world, with their letters.
pub fn draw_starts<'a>(drawing: &mut Drawing, starts: impl Iterator<Item = &'a StartSpec>) {
    let line = Line::solid(INK, 1.5);
    for start in starts {
        drawing.include(start.pose.position);
        drawing.push(Shape::outlined(Form::Arrow(start.pose), line));
        drawing.add_legend(Symbol::Arrow(line), "start of a robot");
        if let Some(letter) = start.letter {
            let direction = -start.pose.heading.direction();
            let label = Label {
                text: letter.to_string(),
                at: start.pose.position,
                clearance: 0.0,
                min_clearance_px: 1.0,
                direction,
            };
            drawing.labels.push(label);
        }
    }
}
