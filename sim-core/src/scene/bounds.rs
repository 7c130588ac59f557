use glam::DVec2;

/// Component of a ray's direction below which the ray is treated as parallel to the other axis, because the reciprocal
/// of a smaller component would overflow in products.
pub(super) const PARALLEL: f64 = 1e-150;

/// An axis-parallel rectangle, borders included, in metres in the world frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bounds {
    /// Lower left corner.
    pub min: DVec2,
    /// Upper right corner; if it is below `min` in a coordinate, the rectangle is empty.
    pub max: DVec2,
}

impl Bounds {
    /// The empty rectangle: the neutral element of [`Bounds::union`].
    pub const EMPTY: Self = Self { min: DVec2::INFINITY, max: DVec2::NEG_INFINITY };

    /// The smallest rectangle that contains all points; [`Bounds::EMPTY`] without points.
    pub fn of_points(points: impl IntoIterator<Item = DVec2>) -> Self {
        points
            .into_iter()
            .fold(Self::EMPTY, |bounds, point| Self { min: bounds.min.min(point), max: bounds.max.max(point) })
    }

    /// The bounding square of a disc.
    pub fn of_disc(centre: DVec2, radius: f64) -> Self {
        Self { min: centre, max: centre }.grown(radius)
    }

    /// The smallest rectangle that contains both rectangles.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// This rectangle with each side moved outwards by `margin` metres.
    pub fn grown(self, margin: f64) -> Self {
        Self { min: self.min - DVec2::splat(margin), max: self.max + DVec2::splat(margin) }
    }

    /// Returns true if `point` lies inside or on the border.
    pub fn contains(&self, point: DVec2) -> bool {
        self.min.cmple(point).all() && point.cmple(self.max).all()
    }

    /// Returns true if the rectangles share a point, borders included; false if a coordinate is NaN.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// Returns true if both corners are finite and in order.
    pub fn is_finite(&self) -> bool {
        self.min.is_finite() && self.max.is_finite() && self.min.cmple(self.max).all()
    }

    /// Part of a ray inside the rectangle, as minimum and maximum distance from the origin; `None` if the ray misses
    /// the rectangle. `direction` is a unit vector.
    #[inline]
    pub(super) fn clip(&self, origin: DVec2, direction: DVec2, range: f64) -> Option<(f64, f64)> {
        let mut interval = (0.0_f64, range);
        for (o, d, min, max) in
            [(origin.x, direction.x, self.min.x, self.max.x), (origin.y, direction.y, self.min.y, self.max.y)]
        {
            if d.abs() < PARALLEL {
                if o < min || o > max {
                    return None;
                }
            } else {
                let reciprocal = 1.0 / d;
                let (to_min, to_max) = ((min - o) * reciprocal, (max - o) * reciprocal);
                interval = (interval.0.max(to_min.min(to_max)), interval.1.min(to_min.max(to_max)));
            }
        }
        (interval.0 <= interval.1).then_some(interval)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_belong_to_the_rectangle() {
        let unit = Bounds::of_points([DVec2::ZERO, DVec2::ONE]);
        assert!(unit.contains(DVec2::ONE) && unit.contains(DVec2::new(0.0, 0.5)));
        assert!(!unit.contains(DVec2::new(1.0 + 1e-15, 0.5)));
        assert!(unit.overlaps(&Bounds::of_disc(DVec2::new(1.5, 0.5), 0.5)));
        assert!(!unit.overlaps(&Bounds::of_disc(DVec2::new(1.5, 0.5), 0.4375)));
        assert!(!unit.overlaps(&Bounds::EMPTY));
    }

    #[test]
    fn union_with_the_empty_rectangle_changes_nothing() {
        let disc = Bounds::of_disc(DVec2::new(2.0, 3.0), 0.5);
        assert_eq!(disc.union(Bounds::EMPTY), disc);
        assert_eq!(
            disc.union(Bounds::of_points([DVec2::ZERO])),
            Bounds { min: DVec2::ZERO, max: DVec2::new(2.5, 3.5) }
        );
    }
}
