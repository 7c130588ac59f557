//! Projection of a view for faces and tiles.
//!
//! Faces are transformed to *lens space*, a linear image of the camera's frame in which the ray of a pixel is simple.
//! For a pinhole, the ray through the point (x, y) of the image is (x, y, 1), in homogeneous coordinates of the image
//! (Olano and Greer, Triangle scan conversion using 2D homogeneous coordinates, 1997). For a fisheye, lens space is the
//! camera's frame, and rays come from a table.

use std::f64::consts::FRAC_PI_3;

use glam::{DMat3, DVec2, DVec3};

use super::{Lens, View};
use crate::math;

/// Width and height of a tile in pixels.
pub const TILE: u32 = 8;

/// Lens space and field of view of a view.
#[derive(Clone, Debug)]
pub struct Optics {
    /// True for a pinhole lens: straight lines are straight in the image.
    pub is_flat: bool,
    pub lens_from_camera: DMat3,
    pub camera_from_lens: DMat3,
    pub size: [u32; 2],
    /// Pixels per radian of a fisheye.
    focal: f64,
    field: Field,
}

/// Field of view: the part of the camera's frame that can be in the image.
#[derive(Clone, Debug)]
enum Field {
    /// Between four planes through the camera; their inward unit normals.
    Sides([DVec3; 4]),
    /// Within this angle of the axis.
    Cone(f64),
}

/// A rectangle of pixels, first and last pixel included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelRect {
    pub first: [u32; 2],
    pub last: [u32; 2],
}

/// Margin of a face's pixel rectangle around the face, in pixels: far above rounding.
const MARGIN: f64 = 0.0625;

impl Optics {
    pub fn new(view: &View) -> Self {
        let [width, height] = view.size().map(f64::from);
        let (half, focal) = (0.5 * DVec2::new(width, height), view.focal());
        let common = Self {
            is_flat: false,
            lens_from_camera: DMat3::IDENTITY,
            camera_from_lens: DMat3::IDENTITY,
            size: view.size(),
            focal,
            field: Field::Cone((half.length() + 1.0) / focal),
        };
        match view.lens() {
            Lens::Fisheye { .. } => common,
            Lens::Pinhole { .. } => {
                let sides = [
                    DVec3::new(half.x, -focal, 0.0),
                    DVec3::new(half.x, focal, 0.0),
                    DVec3::new(half.y, 0.0, -focal),
                    DVec3::new(half.y, 0.0, focal),
                ];
                let (x, y) = (DVec3::new(0.0, -1.0 / focal, 0.0), DVec3::new(0.0, 0.0, -1.0 / focal));
                Self {
                    is_flat: true,
                    lens_from_camera: DMat3::from_cols(
                        DVec3::new(half.x, half.y, 1.0),
                        DVec3::new(-focal, 0.0, 0.0),
                        DVec3::new(0.0, -focal, 0.0),
                    ),
                    camera_from_lens: DMat3::from_cols(x, y, DVec3::new(1.0, half.x / focal, half.y / focal)),
                    field: Field::Sides(sides.map(DVec3::normalize_or_zero)),
                    ..common
                }
            }
        }
    }

    /// Number of columns and rows of tiles.
    pub fn tiles(&self) -> [u32; 2] {
        self.size.map(|side| side.div_ceil(TILE))
    }

    /// Returns true if part of a sphere may be in the image; `centre` is in the camera's frame.
    pub fn may_show(&self, centre: DVec3, radius: f64) -> bool {
        match &self.field {
            Field::Sides(sides) => sides.iter().all(|side| side.dot(centre) >= -radius),
            Field::Cone(angle) => {
                let distance_squared = centre.length_squared();
                if distance_squared <= radius * radius {
                    return true;
                }
                let off_axis = math::atan2(math::hypot(centre.y, centre.z), centre.x);
                let half_width = math::atan2(radius, (distance_squared - radius * radius).sqrt());
                off_axis <= angle + half_width + 1e-9
            }
        }
    }

    /// Position in the image, or direction, of a corner in lens space: the argument of [`area`](Self::area).
    pub fn image_position(&self, corner: DVec3) -> DVec3 {
        if !self.is_flat {
            corner.normalize_or_zero()
        } else if corner.z > 0.0 {
            DVec3::new(corner.x / corner.z, corner.y / corner.z, 1.0)
        } else {
            // A corner that is not ahead of the camera is not projected.
            DVec3::new(corner.x, corner.y, corner.z.min(0.0))
        }
    }

    /// The pixels that may show part of a face whose corners have these [image positions](Self::image_position); `None`
    /// for a face outside the image.
    pub fn area(&self, [a, b, c]: [DVec3; 3]) -> Option<PixelRect> {
        if !self.is_flat {
            return self.curved_area([a, b, c]);
        }
        if a.z > 0.0 && b.z > 0.0 && c.z > 0.0 {
            let (low, high) = (a.min(b).min(c).truncate(), a.max(b).max(c).truncate());
            return self.rect_between(low, high);
        }
        // A face that crosses the camera's plane is invisible only if all corners are beyond the same border.
        let all_corners = |is_beyond: fn(DVec3, DVec2) -> bool| {
            let size = DVec2::from(self.size.map(f64::from));
            is_beyond(a, size) && is_beyond(b, size) && is_beyond(c, size)
        };
        let is_outside = all_corners(|h, _| h.z <= 0.0)
            || all_corners(|h, _| h.x < -MARGIN * h.z)
            || all_corners(|h, _| h.y < -MARGIN * h.z)
            || all_corners(|h, size| h.x > (size.x + MARGIN) * h.z)
            || all_corners(|h, size| h.y > (size.y + MARGIN) * h.z);
        (!is_outside).then_some(self.whole_image())
    }

    fn whole_image(&self) -> PixelRect {
        PixelRect { first: [0; 2], last: self.size.map(|side| side - 1) }
    }

    /// Pixels whose centres lie between these positions.
    fn rect_between(&self, low: DVec2, high: DVec2) -> Option<PixelRect> {
        let low = (low - 0.5 - MARGIN).ceil().max(DVec2::ZERO);
        let high = (high - 0.5 + MARGIN).floor();
        let side = |low: f64, high: f64, size: u32| {
            let last = high.min(f64::from(size - 1));
            // False for NaN.
            (low <= last).then_some([low as u32, last as u32])
        };
        let [left, right] = side(low.x, high.x, self.size[0])?;
        let [top, bottom] = side(low.y, high.y, self.size[1])?;
        Some(PixelRect { first: [left, top], last: [right, bottom] })
    }

    /// Pixels that may show part of a face through a fisheye: the bounding rectangle of a circle about the face's
    /// centre. The radius of the circle is computed with the lens's maximum magnification in the circle.
    fn curved_area(&self, corners: [DVec3; 3]) -> Option<PixelRect> {
        let middle = (corners[0] + corners[1] + corners[2]).normalize_or_zero();
        let chord = corners.iter().map(|corner| middle.distance(*corner)).fold(0.0, f64::max);
        if !(middle != DVec3::ZERO && chord <= 1.0) {
            return Some(self.whole_image());
        }
        // The angle of a chord up to 1 is less than pi / 3 times the chord.
        let radius_angle = 1.0001 * FRAC_PI_3 * chord + 1e-9;
        let off_axis_distance = math::hypot(middle.y, middle.z);
        let off_axis = math::atan2(off_axis_distance, middle.x);
        let farthest = off_axis + radius_angle;
        if farthest > 3.0 {
            return Some(self.whole_image());
        }
        // The magnification of a fisheye is angle / sin(angle) perpendicular to the radius, and not larger along it.
        let radius = self.focal * radius_angle / math::sinc(farthest) + 1.0;
        let scale = if off_axis_distance > 0.0 { self.focal * off_axis / off_axis_distance } else { 0.0 };
        let centre = 0.5 * DVec2::from(self.size.map(f64::from)) - scale * DVec2::new(middle.y, middle.z);
        self.rect_between(centre - radius, centre + radius)
    }
}
