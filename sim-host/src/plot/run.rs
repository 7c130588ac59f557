//! The picture of a finished run: the world with the robots' trails.

use std::sync::Arc;

use glam::DVec2;
use sim_core::format::{RobiSpec, WorldSpec};
use sim_core::pose::Pose;

use super::colour::{self, INK};
use super::drawing::{Drawing, Form, Line, Paint, Shape, Symbol};
use super::ground;
use super::robot::{Looks, draw_body, draw_heading};
use super::scene::{MAX_LABELS, robot_label};

/// A robot of a run.
#[derive(Clone, Debug)]
pub struct RunRobot {
    /// Its number.
    pub id: u32,
    /// Its type.
    pub robi: Arc<RobiSpec>,
    /// Where it started.
    pub start: Pose,
    /// Where it ended.
    pub end: Pose,
    /// Where it has been.
    pub trail: Vec<DVec2>,
}

/// Draws the world, where the robots went, and where bodies touched.
pub fn draw_run(title: &str, world: &WorldSpec, robots: &[RunRobot], contacts: &[DVec2]) -> Drawing {
    let mut drawing = Drawing::new(title);
    ground::draw_world(&mut drawing, world, None);
    let line = |index: usize| Line::solid(colour::robot(index), 1.5);
    for (index, robot) in robots.iter().enumerate() {
        robot.trail.iter().for_each(|point| drawing.include(*point));
        drawing.push(Shape::outlined(Form::Path(robot.trail.clone()), line(index)));
    }
    for (index, robot) in robots.iter().enumerate() {
        let radius = 0.5 * robot.robi.diameter;
        drawing.include_around(robot.start.position, radius);
        let ring = Form::Disc { centre: robot.start.position, radius, least: 4.0 };
        drawing.push(Shape::outlined(ring, line(index)));
        draw_heading(&mut drawing, &robot.start, radius);
        draw_body(&mut drawing, &robot.robi, &robot.end, &Looks { colour: colour::robot(index), mesh: None });
        if robots.len() <= MAX_LABELS {
            drawing.labels.push(robot_label(robot.id, &robot.robi, &robot.end));
        }
    }
    let cross = Line::solid(INK, 1.5);
    for contact in contacts {
        drawing.include(*contact);
        drawing.push(Shape::outlined(Form::Cross(*contact), cross));
    }
    drawing.explain(Symbol::Disc(None, cross), "start");
    drawing.explain(Symbol::Disc(Some(Paint::veil(INK, 0.35)), cross), "end");
    drawing.explain(Symbol::Cross(cross), "contact");
    for (index, robot) in robots.iter().enumerate() {
        let line = Line { width: 3.0, ..line(index) };
        drawing.explain(Symbol::Line(line), format!("r{} {}", robot.id, robot.robi.name));
    }
    drawing
}
