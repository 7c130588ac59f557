//! Placement of labels, so that they cover neither each other nor the bodies that they name.

use glam::DVec2;

use super::canvas::{TEXT, text_width};
use super::drawing::Label;
use super::viewport::{LEFT, TOP, Viewport};

/// Pixels between a label and its body, and a part of the step between the distances at which a label is tried.
const GAP: f64 = 3.0;
/// Height of a label in pixels.
const HEIGHT: f64 = TEXT + 2.0;

/// Occupied rectangle of the picture: upper left and lower right corner in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    low: DVec2,
    high: DVec2,
}

impl Obstacle {
    /// Square around the body that a label names.
    pub fn around(label: &Label, viewport: &Viewport) -> Self {
        let (centre, radius) = (viewport.pixel_of(label.at), radius(label, viewport));
        Self { low: centre - DVec2::splat(radius), high: centre + DVec2::splat(radius) }
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.low.cmplt(other.high).all() && other.low.cmplt(self.high).all()
    }
}

/// Labels placed so far, and the bodies that they must not cover.
pub struct Labels<'a> {
    viewport: &'a Viewport,
    occupied: Vec<Obstacle>,
    /// Bodies that have labels; a label covers such a body only if there is no other place.
    bodies: Vec<Obstacle>,
}

impl<'a> Labels<'a> {
    /// Creates a placement without labels; `bodies` are all bodies that will get a label.
    pub fn new(viewport: &'a Viewport, bodies: Vec<Obstacle>) -> Self {
        Self { viewport, occupied: Vec::new(), bodies }
    }

    /// Places a label; returns its upper left corner in pixels, and its text. Takes the first of several positions
    /// around the body that covers neither a label nor another body, otherwise the first one that covers no label.
    /// `None` if there is no such position, or the labelled point is not visible.
    pub fn place(&mut self, label: &Label) -> Option<(DVec2, String)> {
        if !self.viewport.contains(label.at) {
            return None;
        }
        let width = text_width(&label.text, TEXT);
        let (centre, radius) = (self.viewport.pixel_of(label.at), radius(label, self.viewport) + GAP);
        let preferred = label.direction.try_normalize();
        let around =
            [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (0.7, 0.7), (-0.7, 0.7), (-0.7, -0.7), (0.7, -0.7)];
        let directions = preferred.into_iter().chain(around.map(|(x, y)| DVec2::new(x, y)));
        let directions: Vec<DVec2> = directions.collect();
        let candidates =
            [1.0, 1.0 + (HEIGHT + GAP) / radius, 1.0 + 2.5 * (HEIGHT + GAP) / radius].into_iter().flat_map(|factor| {
                directions.iter().map(move |direction| {
                    let middle = centre + factor * radius * DVec2::new(direction.x, -direction.y);
                    // The rectangle touches the circle from outside.
                    let half_size = DVec2::new(0.5 * width, 0.5 * HEIGHT);
                    let low =
                        middle + half_size * (DVec2::new(direction.x.clamp(-1.0, 1.0), -direction.y) - DVec2::ONE);
                    Obstacle { low, high: low + 2.0 * half_size }
                })
            });
        let visible: Vec<Obstacle> = candidates.filter(|candidate| self.is_inside(candidate)).collect();
        let is_free = |candidate: &&Obstacle| self.occupied.iter().all(|other| !other.overlaps(candidate));
        let own_body = Obstacle::around(label, self.viewport);
        let avoids_bodies =
            |candidate: &&Obstacle| self.bodies.iter().all(|other| *other == own_body || !other.overlaps(candidate));
        let best = visible
            .iter()
            .find(|candidate| is_free(candidate) && avoids_bodies(candidate))
            .or_else(|| visible.iter().find(is_free))?;
        self.occupied.push(*best);
        Some((best.low, label.text.clone()))
    }

    fn is_inside(&self, rectangle: &Obstacle) -> bool {
        let corner = DVec2::new(LEFT, TOP);
        corner.cmple(rectangle.low).all() && rectangle.high.cmple(corner + self.viewport.pixels()).all()
    }
}

/// Radius around the labelled point that the text must not cover, in pixels.
fn radius(label: &Label, viewport: &Viewport) -> f64 {
    (label.clearance * viewport.scale()).max(label.min_clearance_px)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn label(text: &str, x: f64, y: f64) -> Label {
        Label { text: text.into(), at: DVec2::new(x, y), clearance: 0.1, min_clearance_px: 4.0, direction: DVec2::ZERO }
    }

    #[test]
    fn labels_cover_neither_labels_nor_bodies() {
        let viewport = Viewport::around(DVec2::ZERO, DVec2::splat(4.0), None);
        // Sixteen robots close to each other.
        let requested: Vec<Label> = (0..16)
            .map(|i| label(&format!("robot {i}"), 1.5 + 0.22 * f64::from(i % 4), 1.5 + 0.22 * f64::from(i / 4)))
            .collect();
        let bodies: Vec<Obstacle> = requested.iter().map(|label| Obstacle::around(label, &viewport)).collect();
        let mut labels = Labels::new(&viewport, bodies.clone());
        let labelled: Vec<_> = requested.iter().filter_map(|label| labels.place(label)).collect();
        assert!(labelled.len() >= 12, "{} of 16 have a place", labelled.len());
        for (index, placed) in labels.occupied.iter().enumerate() {
            assert!(labels.occupied[..index].iter().all(|other| !other.overlaps(placed)));
        }
        // Labels placed while there is room keep clear of the bodies.
        let first = labels.occupied[0];
        assert!(bodies[1..].iter().all(|body| !body.overlaps(&first)));
    }

    #[test]
    fn label_has_the_preferred_direction() {
        let viewport = Viewport::around(DVec2::ZERO, DVec2::splat(4.0), None);
        let up = Label { direction: DVec2::Y, ..label("up", 2.0, 2.0) };
        let mut labels = Labels::new(&viewport, Vec::new());
        let (corner, _) = labels.place(&up).expect("there is room");
        let pixel = viewport.pixel_of(DVec2::splat(2.0));
        assert!(corner.y + HEIGHT < pixel.y && corner.x < pixel.x, "{corner} is above {pixel}");
        assert!(Labels::new(&viewport, Vec::new()).place(&label("far", 99.0, 0.0)).is_none(), "outside the picture");
    }
}
