//! Ground of level blocks and stairs with exactly vertical sides.

use glam::DVec2;

use super::{Bounds, FieldError, HeightField};

/// Maximum number of steps of a flight of stairs.
pub const MAX_STEPS: u32 = 1000;

/// Level ground with blocks and stairs on it; in metres, world frame. Where they overlap, the highest one is the
/// surface.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Steps {
    /// Corner with the minimum x and y.
    pub origin: DVec2,
    /// Width along x and along y; positive.
    pub size: DVec2,
    /// Height of the ground.
    pub base: f64,
    /// Flights of stairs.
    pub stairs: Vec<Stairs>,
    /// Single blocks.
    pub blocks: Vec<Block>,
}

/// Direction in which stairs go up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StairsDirection {
    /// Towards larger x.
    #[default]
    East,
    /// Towards larger y.
    North,
    /// Towards smaller x.
    West,
    /// Towards smaller y.
    South,
}

impl StairsDirection {
    /// All directions, by quarter turns counter-clockwise from x.
    pub const ALL: [StairsDirection; 4] =
        [StairsDirection::East, StairsDirection::North, StairsDirection::West, StairsDirection::South];

    fn direction(self) -> DVec2 {
        match self {
            StairsDirection::East => DVec2::X,
            StairsDirection::North => DVec2::Y,
            StairsDirection::West => DVec2::NEG_X,
            StairsDirection::South => DVec2::NEG_Y,
        }
    }
}

/// A flight of stairs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stairs {
    /// Middle of the lower edge of the first riser.
    pub from: DVec2,
    /// Direction in which the stairs go up.
    pub uphill: StairsDirection,
    /// Number of steps; at most [`MAX_STEPS`].
    pub count: u32,
    /// Height of each step; positive.
    pub rise: f64,
    /// Depth of each step except the last; positive.
    pub depth: f64,
    /// Depth of the last step, the landing; positive.
    pub landing: f64,
    /// Width perpendicular to the direction; positive.
    pub width: f64,
    /// If true, the same number of steps leads down after the landing; otherwise the landing ends in a vertical side.
    pub goes_down: bool,
}

/// A block with level top and vertical sides.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Block {
    /// Rectangle that the block covers.
    pub bounds: Bounds,
    /// Height above the ground; positive.
    pub height: f64,
}

impl Stairs {
    /// The stairs as blocks stacked on each other: each block extends beneath all the blocks above it.
    pub fn blocks(&self) -> impl Iterator<Item = Block> {
        let ahead = self.uphill.direction();
        let half_width = 0.5 * self.width * ahead.perp();
        let stairs = *self;
        (0..self.count).map(move |step| {
            let start = f64::from(step) * stairs.depth;
            let top = f64::from(stairs.count - 1) * stairs.depth + stairs.landing;
            let end = top + if stairs.goes_down { top - stairs.landing - start } else { 0.0 };
            let corners = [stairs.from + start * ahead + half_width, stairs.from + end * ahead - half_width];
            Block { bounds: Bounds::of_points(corners), height: f64::from(step + 1) * stairs.rise }
        })
    }
}

impl Steps {
    /// Generates the terrain; blocks and stairs are cut off at its border.
    ///
    /// # Errors
    /// [`FieldError`] if the size is not positive, or the sides of all blocks give too many cells.
    pub fn field(&self) -> Result<HeightField, FieldError> {
        let (low, high) = (self.origin, self.origin + self.size);
        let blocks: Vec<Block> =
            self.stairs.iter().flat_map(Stairs::blocks).chain(self.blocks.iter().copied()).collect();
        let grid_lines = |coordinate: fn(DVec2) -> f64| {
            let sides = blocks.iter().flat_map(|block| [coordinate(block.bounds.min), coordinate(block.bounds.max)]);
            let mut sides: Vec<f64> =
                sides.filter(|side| coordinate(low) < *side && *side < coordinate(high)).collect();
            sides.sort_by(f64::total_cmp);
            sides.dedup();
            let doubled = sides.into_iter().flat_map(|side| [side; 2]);
            std::iter::once(coordinate(low)).chain(doubled).chain([coordinate(high)]).collect::<Vec<f64>>()
        };
        let (xs, ys) = (grid_lines(|point| point.x), grid_lines(|point| point.y));
        let corners = xs.len().saturating_mul(ys.len());
        if corners > 2 * super::MAX_CELLS {
            return Err(FieldError::Large(corners));
        }
        // The ground is level between the grid lines 2i and 2i + 1 of an axis.
        let mut heights = vec![0.0_f64; corners];
        for block in &blocks {
            let lines_between = |lines: &[f64], min: f64, max: f64| {
                let first = (0..lines.len()).step_by(2).find(|index| lines[*index] >= min).unwrap_or(lines.len());
                let end = (1..lines.len()).step_by(2).rfind(|index| lines[*index] <= max).map_or(0, |index| index + 1);
                first..end.max(first)
            };
            let Bounds { min, max } = block.bounds;
            for row in lines_between(&ys, min.y.max(low.y), max.y.min(high.y)) {
                for column in lines_between(&xs, min.x.max(low.x), max.x.min(high.x)) {
                    let height = &mut heights[row * xs.len() + column];
                    *height = height.max(block.height);
                }
            }
        }
        heights.iter_mut().for_each(|height| *height += self.base);
        HeightField::new(xs, ys, heights)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(stairs: Vec<Stairs>, blocks: Vec<Block>) -> HeightField {
        let steps = Steps { origin: DVec2::ZERO, size: DVec2::new(4.0, 3.0), base: 0.0, stairs, blocks };
        steps.field().expect("a field")
    }

    fn stairs(uphill: StairsDirection) -> Stairs {
        let (from, count) = (DVec2::new(2.0, 1.5), 3);
        Stairs { from, uphill, count, rise: 0.125, depth: 0.25, landing: 0.5, width: 1.0, goes_down: false }
    }

    #[test]
    fn stairs_go_up_in_all_four_directions() {
        for uphill in StairsDirection::ALL {
            let field = steps(vec![stairs(uphill)], Vec::new());
            let height_at = |ahead: f64, lateral: f64| {
                let point = DVec2::new(2.0, 1.5) + ahead * uphill.direction() + lateral * uphill.direction().perp();
                field.height(point.x, point.y)
            };
            let expected =
                [(-0.01, 0.0), (0.0, 0.125), (0.24, 0.125), (0.25, 0.25), (0.5, 0.375), (1.0, 0.375), (1.01, 0.0)];
            for (ahead, height) in expected {
                assert_eq!(height_at(ahead, 0.0), height, "{uphill:?}, {ahead} m ahead");
                assert_eq!(height_at(ahead, 0.5), height, "on the side");
                assert_eq!(height_at(ahead, -0.51), 0.0, "beside the stairs");
            }
        }
    }

    #[test]
    fn stairs_may_go_down_again() {
        let field = steps(vec![Stairs { goes_down: true, landing: 0.25, ..stairs(StairsDirection::West) }], Vec::new());
        let heights: Vec<f64> = (0..8).map(|step| field.height(2.125 - 0.25 * f64::from(step), 1.5)).collect();
        assert_eq!(heights, [0.0, 0.125, 0.25, 0.375, 0.25, 0.125, 0.0, 0.0]);
    }

    #[test]
    fn the_highest_block_is_the_surface_and_blocks_are_cut_off_at_the_border() {
        let block = |min: [f64; 2], max: [f64; 2], height| Block {
            bounds: Bounds { min: min.into(), max: max.into() },
            height,
        };
        let blocks = vec![
            block([1.0, 1.0], [2.0, 2.0], 0.3),
            block([1.5, 0.5], [3.0, 1.5], 0.1),
            block([3.5, -1.0], [9.0, 9.0], 0.5),
            block([7.0, 1.0], [8.0, 2.0], 0.9),
        ];
        let field = steps(Vec::new(), blocks);
        let heights = [(1.2, 1.2, 0.3), (1.7, 1.2, 0.3), (2.5, 1.2, 0.1), (3.7, 0.1, 0.5), (0.5, 0.5, 0.0)];
        for (x, y, height) in heights {
            assert_eq!(field.height(x, y), height, "at {x}, {y}");
        }
        assert_eq!((field.height_bounds(), field.bounds().max), ((0.0, 0.5), DVec2::new(4.0, 3.0)));
    }
}
