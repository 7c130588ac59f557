//! Mapping from metres of the world to pixels of the picture, with the same scale in both directions.

use glam::DVec2;

/// Longer side of the world's area in a picture without a given size, in pixels.
const LONG_SIDE: f64 = 800.0;
/// Minimum length of the area's shorter side, in pixels: enough for a short legend.
const SHORT_SIDE: f64 = 240.0;

/// Margin above the world's area, in pixels.
pub const TOP: f64 = 36.0;
/// Margin on the right, before the legend, in pixels.
pub const RIGHT: f64 = 14.0;
/// Margin below, for the axis, in pixels.
pub const BOTTOM: f64 = 50.0;
/// Margin on the left, for the axis, in pixels.
pub const LEFT: f64 = 72.0;
/// Width of the legend in pixels.
pub const LEGEND: f64 = 210.0;

/// Visible part of the world, and its scale.
#[derive(Clone, Copy, Debug)]
pub struct Viewport {
    min: DVec2,
    max: DVec2,
    /// Pixels per metre.
    scale: f64,
}

impl Viewport {
    /// Viewport that shows the rectangle between `low` and `high` with a margin around it, in a picture with a total
    /// size of `size` pixels, or a suitable size.
    pub fn around(low: DVec2, high: DVec2, size: Option<(u32, u32)>) -> Self {
        let (centre, extent) = (0.5 * (low + high), (high - low).max(DVec2::splat(1e-3)));
        let extent = extent + DVec2::splat(0.05 * extent.max_element());
        let (scale, pixels) = match size {
            Some((width, height)) => {
                let pixels = DVec2::new(f64::from(width) - LEFT - RIGHT - LEGEND, f64::from(height) - TOP - BOTTOM);
                let pixels = pixels.max(DVec2::ONE);
                ((pixels / extent).min_element(), pixels)
            }
            None => {
                let scale = LONG_SIDE / extent.max_element();
                // Whole pixels, so that both directions have the same scale.
                (scale, (extent * scale).max(DVec2::splat(SHORT_SIDE)).ceil())
            }
        };
        Self { min: centre - 0.5 * pixels / scale, max: centre + 0.5 * pixels / scale, scale }
    }

    /// Lower left and upper right corner of the visible part, in metres.
    pub fn corners(&self) -> (DVec2, DVec2) {
        (self.min, self.max)
    }

    /// Pixels per metre.
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// Width and height of the world's part in pixels.
    pub fn pixels(&self) -> DVec2 {
        ((self.max - self.min) * self.scale).round()
    }

    /// Width and height of the whole picture in pixels.
    pub fn picture_size(&self) -> (u32, u32) {
        let pixels = self.pixels() + DVec2::new(LEFT + RIGHT + LEGEND, TOP + BOTTOM);
        (pixels.x as u32, pixels.y as u32)
    }

    /// Position in the picture of a point of the world, in pixels from the upper left corner.
    pub fn pixel_of(&self, point: DVec2) -> DVec2 {
        DVec2::new(LEFT + (point.x - self.min.x) * self.scale, TOP + (self.max.y - point.y) * self.scale)
    }

    /// Returns true if the point is visible.
    pub fn contains(&self, point: DVec2) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }

    /// Visible parts of the line through `points`.
    pub fn clip_path(&self, points: &[DVec2]) -> Vec<Vec<DVec2>> {
        if points.iter().all(|point| self.contains(*point)) {
            return vec![points.to_vec()];
        }
        let mut parts: Vec<Vec<DVec2>> = Vec::new();
        for pair in points.windows(2) {
            let Some((from, to)) = self.clip_segment(pair[0], pair[1]) else { continue };
            match parts.last_mut() {
                Some(part) if part.last() == Some(&from) => part.push(to),
                _ => parts.push(vec![from, to]),
            }
        }
        parts
    }

    fn clip_segment(&self, from: DVec2, to: DVec2) -> Option<(DVec2, DVec2)> {
        let offset = to - from;
        let (mut first, mut last) = (0.0f64, 1.0f64);
        for (start, step, low, high) in
            [(from.x, offset.x, self.min.x, self.max.x), (from.y, offset.y, self.min.y, self.max.y)]
        {
            if step == 0.0 {
                if start < low || start > high {
                    return None;
                }
                continue;
            }
            let (at_low, at_high) = ((low - start) / step, (high - start) / step);
            first = first.max(at_low.min(at_high));
            last = last.min(at_low.max(at_high));
        }
        // End points inside are kept exactly, so that parts join.
        let point_at = |fraction: f64| {
            if fraction == 0.0 {
                from
            } else if fraction == 1.0 {
                to
            } else {
                from + fraction * offset
            }
        };
        (first <= last).then(|| (point_at(first), point_at(last)))
    }

    /// Visible part of an area.
    pub fn clip_area(&self, corners: &[DVec2]) -> Vec<DVec2> {
        if corners.iter().all(|corner| self.contains(*corner)) {
            return corners.to_vec();
        }
        // Clips the polygon at one side of the viewport after the other. Each function gives the distance of a point
        // from a side, positive inside.
        let sides: [&dyn Fn(DVec2) -> f64; 4] =
            [&|point| point.x - self.min.x, &|point| self.max.x - point.x, &|point| point.y - self.min.y, &|point| {
                self.max.y - point.y
            }];
        sides.iter().fold(corners.to_vec(), |corners, distance_inside| {
            let mut clipped = Vec::with_capacity(corners.len() + 1);
            for (index, corner) in corners.iter().enumerate() {
                let previous = corners[(index + corners.len() - 1) % corners.len()];
                let (distance, previous_distance) = (distance_inside(*corner), distance_inside(previous));
                if (distance < 0.0) != (previous_distance < 0.0) {
                    clipped
                        .push(previous + (*corner - previous) * (previous_distance / (previous_distance - distance)));
                }
                if distance >= 0.0 {
                    clipped.push(*corner);
                }
            }
            clipped
        })
    }
}

/// Round number of metres (1, 2 or 5 times a power of ten) that is at least `min`.
pub fn round_step(min: f64) -> f64 {
    let mut decade = 1e-9;
    while decade * 10.0 <= min {
        decade *= 10.0;
    }
    [1.0, 2.0, 5.0, 10.0].map(|factor| factor * decade).into_iter().find(|step| *step >= min).unwrap_or(min)
}

/// Formats metres with the decimals that distinguish multiples of `step`.
pub fn metres(value: f64, step: f64) -> String {
    let decimals = (0..9).find(|digits| step * 10f64.powi(*digits) > 0.99).unwrap_or(9) as usize;
    // Avoids "-0".
    let value = if value.abs() < 0.01 * step { 0.0 } else { value };
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_axes_have_one_scale_and_y_points_up() {
        for size in [None, Some((1000, 500)), Some((400, 1000))] {
            let viewport = Viewport::around(DVec2::new(-1.0, 2.0), DVec2::new(3.0, 4.0), size);
            let (a, b, c) = (viewport.pixel_of(DVec2::ZERO), viewport.pixel_of(DVec2::X), viewport.pixel_of(DVec2::Y));
            assert!((b - a - DVec2::new(viewport.scale(), 0.0)).length() < 1e-9, "{a} {b}");
            assert!((c - a - DVec2::new(0.0, -viewport.scale())).length() < 1e-9, "{a} {c}");
            assert!(viewport.contains(DVec2::new(-1.0, 2.0)) && viewport.contains(DVec2::new(3.0, 4.0)));
            assert_eq!(viewport.picture_size(), size.unwrap_or((LEFT as u32 + 800 + 14 + 210, 36 + 420 + 50)));
        }
    }

    #[test]
    fn lines_and_areas_are_clipped_at_the_frame() {
        let viewport = Viewport::around(DVec2::ZERO, DVec2::splat(10.0), Some((1296, 1086)));
        let (low, high) = viewport.corners();
        assert!((low - DVec2::splat(-0.25)).length() < 1e-9 && (high - DVec2::splat(10.25)).length() < 1e-9);
        let parts = viewport.clip_path(&[
            DVec2::new(-5.0, 5.0),
            DVec2::new(5.0, 5.0),
            DVec2::new(5.0, 20.0),
            DVec2::new(6.0, 20.0),
            DVec2::new(6.0, 5.0),
        ]);
        assert_eq!(parts.len(), 2, "{parts:?}");
        assert!((parts[0][0] - DVec2::new(-0.25, 5.0)).length() < 1e-9);
        assert!((parts[0][2] - DVec2::new(5.0, 10.25)).length() < 1e-9);
        assert!(viewport.clip_path(&[DVec2::new(-5.0, -5.0), DVec2::new(-1.0, 20.0)]).is_empty());
        let area = viewport.clip_area(&[
            DVec2::new(5.0, 5.0),
            DVec2::new(20.0, 5.0),
            DVec2::new(20.0, 20.0),
            DVec2::new(5.0, 20.0),
        ]);
        assert_eq!(area.len(), 4);
        assert!(area.iter().all(|corner| viewport.contains(*corner) && corner.min_element() >= 5.0), "{area:?}");
        assert!(viewport.clip_area(&[DVec2::splat(20.0), DVec2::splat(30.0), DVec2::new(20.0, 30.0)]).is_empty());
    }

    #[test]
    fn steps_are_round_numbers() {
        let steps: Vec<String> =
            [0.0012, 0.02, 0.03, 0.7, 1.0, 3.1, 60.0].map(|min| metres(round_step(min), round_step(min))).into();
        assert_eq!(steps, ["0.002", "0.02", "0.05", "1", "1", "5", "100"]);
        assert_eq!(
            (metres(-1e-12, 0.5), metres(1.5, 0.5), metres(10.0, 5.0)),
            ("0.0".into(), "1.5".into(), "10".into())
        );
    }
}
