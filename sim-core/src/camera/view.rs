//! Camera pose and lens: projection of points into the image, and rays through its pixels.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};

use crate::math;
use crate::pose::Pose3;

/// Projection of a lens from directions to positions in the image. The optical axis passes through the centre of the
/// image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Straight lines stay straight: the distance from the centre is proportional to the tangent of the angle off the
    /// axis.
    Pinhole {
        /// Horizontal field of view over the width of the image, rad; below pi.
        fov: f64,
    },
    /// The distance from the centre is proportional to the angle off the axis (equidistant projection).
    Fisheye {
        /// Horizontal field of view over the width of the image, rad; up to 2 pi.
        fov: f64,
    },
}

impl Lens {
    /// Horizontal field of view over the width of the image, rad.
    pub fn fov(&self) -> f64 {
        let (Self::Pinhole { fov } | Self::Fisheye { fov }) = *self;
        fov
    }
}

/// A camera's pose, its lens and the size of its image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    world_from_camera: Pose3,
    lens: Lens,
    size: [u32; 2],
    /// Pixels per unit of the lens: of the tangent, or of the angle.
    focal: f64,
}

/// Reason why a view is invalid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ViewError {
    /// The size of the image is out of range.
    #[error("an image of {0} x {1} pixels, accepted: 1 to {MAX_SIDE} on either side")]
    Size(u32, u32),
    /// The field of view is out of range.
    #[error("a field of view of {0} rad, accepted: above 0, below pi for a pinhole, up to 2 pi for a fisheye")]
    Field(f64),
    /// The pose is not finite, or its position is too far away.
    #[error("a camera's position or direction is not finite, or farther than 1e9 m away")]
    Pose,
}

/// Maximum number of pixels on either side of an image.
pub const MAX_SIDE: u32 = 8192;

impl View {
    /// The view of a camera at `world_from_camera` through `lens`, `size` (width, height) pixels large.
    ///
    /// # Errors
    /// [`ViewError`] for a pose, lens or size that is out of range.
    pub fn new(world_from_camera: Pose3, lens: Lens, size: [u32; 2]) -> Result<Self, ViewError> {
        let [width, height] = size;
        if !size.iter().all(|side| (1..=MAX_SIDE).contains(side)) {
            return Err(ViewError::Size(width, height));
        }
        let is_position =
            world_from_camera.position.abs().max_element() <= 1e9 && world_from_camera.position.is_finite();
        if !is_position || !world_from_camera.rotation.is_finite() {
            return Err(ViewError::Pose);
        }
        let half_width = 0.5 * f64::from(width);
        let focal = match lens {
            Lens::Pinhole { fov } if fov > 0.0 && fov < PI => half_width / math::tan(0.5 * fov),
            Lens::Fisheye { fov } if fov > 0.0 && fov <= TAU => half_width / (0.5 * fov),
            Lens::Pinhole { fov } | Lens::Fisheye { fov } => return Err(ViewError::Field(fov)),
        };
        if !(focal.is_finite() && focal > 0.0) {
            return Err(ViewError::Field(lens.fov()));
        }
        Ok(Self { world_from_camera, lens, size, focal })
    }

    /// The camera's pose: x along the optical axis, y to the left of the image, z up in it.
    pub fn world_from_camera(&self) -> &Pose3 {
        &self.world_from_camera
    }

    /// The lens.
    pub fn lens(&self) -> Lens {
        self.lens
    }

    /// Width and height of the image in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Pixels per unit of the lens: of the tangent of the angle off the axis for a pinhole, of the angle for a fisheye.
    pub fn focal(&self) -> f64 {
        self.focal
    }

    /// This view with `factor` times as many pixels on either side.
    ///
    /// # Errors
    /// [`ViewError::Size`] if the image has too many pixels, or none.
    pub fn enlarged(&self, factor: u32) -> Result<Self, ViewError> {
        Self::new(self.world_from_camera, self.lens, self.size.map(|side| side.saturating_mul(factor)))
    }

    /// The ray through an image position (columns to the right, rows downwards), in the camera's frame. It is (1, y, z)
    /// for a pinhole and has length 1 for a fisheye. `None` beyond the end of a fisheye's image, more than pi off the
    /// axis.
    pub fn ray(&self, position: DVec2) -> Option<DVec3> {
        let (angle, ray) = self.continued_ray(position);
        (angle <= PI).then_some(ray)
    }

    /// Angle off the axis (0 for a pinhole), and ray through an image position. The position may be beyond the end of a
    /// fisheye's image, where the angle exceeds pi.
    pub(super) fn continued_ray(&self, position: DVec2) -> (f64, DVec3) {
        let [width, height] = self.size.map(f64::from);
        let (y, z) = ((0.5 * width - position.x) / self.focal, (0.5 * height - position.y) / self.focal);
        match self.lens {
            Lens::Pinhole { .. } => (0.0, DVec3::new(1.0, y, z)),
            Lens::Fisheye { .. } => {
                let angle = math::hypot(y, z);
                let sinc = math::sinc(angle);
                (angle, DVec3::new(math::cos(angle), y * sinc, z * sinc))
            }
        }
    }

    /// Unit vector, in the world frame, of the line of sight through an image position; `None` beyond a fisheye's
    /// image.
    pub fn direction(&self, position: DVec2) -> Option<DVec3> {
        self.ray(position).map(|ray| self.world_from_camera.rotation * ray.normalize_or_zero())
    }

    /// Image position of a point in the world, possibly beyond the border. `None` for a point without a projection:
    /// beside or behind a pinhole, straight behind a fisheye, or in the camera itself.
    pub fn project(&self, point: DVec3) -> Option<DVec2> {
        let DVec3 { x, y, z } = self.world_from_camera.inverse_transform_point(point);
        let off_axis = math::hypot(y, z);
        let scale = match self.lens {
            Lens::Pinhole { .. } if x > 0.0 => 1.0 / x,
            Lens::Fisheye { .. } if off_axis > 0.0 => math::atan2(off_axis, x) / off_axis,
            Lens::Fisheye { .. } if x > 0.0 => 1.0 / x,
            _ => return None,
        };
        let [width, height] = self.size.map(f64::from);
        Some(DVec2::new(0.5 * width - self.focal * y * scale, 0.5 * height - self.focal * z * scale))
    }

    /// The pose of an upright camera at `from` that looks at `to`: the image's vertical lies in a vertical plane. For a
    /// camera that looks straight up or down, the top of the image is towards y. `None` if both points are equal or a
    /// coordinate is not finite.
    pub fn look_at(from: DVec3, to: DVec3) -> Option<Pose3> {
        let DVec3 { x, y, z } = to - from;
        let horizontal = math::hypot(x, y);
        let is_defined = from.is_finite() && to.is_finite() && (horizontal > 0.0 || z != 0.0);
        let yaw = if horizontal > 0.0 { math::atan2(y, x) } else { FRAC_PI_2 };
        is_defined.then(|| Pose3::from_angles(from, 0.0, math::atan2(z, horizontal), yaw))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view(lens: Lens) -> View {
        let pose = Pose3::from_angles(DVec3::new(1.0, 2.0, 0.5), 0.1, -0.2, 2.5);
        View::new(pose, lens, [160, 120]).expect("a view")
    }

    #[test]
    fn points_along_a_ray_are_projected_to_its_position() {
        for lens in [Lens::Pinhole { fov: 1.0 }, Lens::Fisheye { fov: 2.5 }, Lens::Fisheye { fov: 5.0 }] {
            let view = view(lens);
            for position in
                [DVec2::new(0.0, 0.0), DVec2::new(80.0, 60.0), DVec2::new(159.5, 3.25), DVec2::new(20.0, 120.0)]
            {
                let direction = view.direction(position).expect("within the image");
                let found = view.project(view.world_from_camera().position + 3.0 * direction).expect("ahead");
                assert!((found - position).length() < 1e-9, "{lens:?} {position} {found}");
            }
        }
    }

    #[test]
    fn points_to_the_left_and_above_appear_left_and_above_in_the_image() {
        let ahead = View::new(Pose3::IDENTITY, Lens::Pinhole { fov: FRAC_PI_2 }, [160, 120]).expect("a view");
        let found = ahead.project(DVec3::new(1.0, 0.5, 0.25)).expect("ahead");
        assert!((found - DVec2::new(40.0, 40.0)).length() < 1e-9, "{found}");
        assert_eq!(ahead.project(DVec3::new(-1.0, 0.5, 0.25)), None);
        let pose = View::look_at(DVec3::new(0.0, 0.0, 2.0), DVec3::ZERO).expect("a direction");
        let down = View::new(pose, Lens::Pinhole { fov: FRAC_PI_2 }, [100, 100]).expect("a view");
        let found = down.project(DVec3::new(1.0, 1.0, 0.0)).expect("below");
        assert!((found - DVec2::new(75.0, 25.0)).length() < 1e-9, "x to the right, y up: {found}");
    }

    #[test]
    fn invalid_views_are_rejected() {
        let pose = Pose3::IDENTITY;
        let view = |lens, size| View::new(pose, lens, size);
        assert_eq!(view(Lens::Pinhole { fov: 1.0 }, [0, 5]), Err(ViewError::Size(0, 5)));
        assert_eq!(view(Lens::Pinhole { fov: PI }, [5, 5]), Err(ViewError::Field(PI)));
        assert!(
            view(Lens::Pinhole { fov: f64::NAN }, [5, 5]).is_err() && view(Lens::Fisheye { fov: 0.0 }, [5, 5]).is_err()
        );
        assert!(view(Lens::Pinhole { fov: 1e-320 }, [5, 5]).is_err());
        let invalid_pose = Pose3 { position: DVec3::new(f64::NAN, 0.0, 0.0), ..pose };
        assert_eq!(View::new(invalid_pose, Lens::Pinhole { fov: 1.0 }, [5, 5]), Err(ViewError::Pose));
        assert_eq!(View::look_at(DVec3::ONE, DVec3::ONE), None);
    }
}
