//! Colours of the pictures from above: the palette of Okabe & Ito, which is distinct with any kind of colour vision,
//! and greys.
//!
//! Colour is never the only distinction: shapes differ too, and robots have numbers.

use plotters::style::RGBColor;

/// The colours that stand out on white: blue, vermilion, bluish green, reddish purple, sky blue, orange.
const PALETTE: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
];

/// Walls without a specified colour.
pub const WALL: RGBColor = RGBColor(51, 51, 51);
/// The floor.
pub const FLOOR: RGBColor = RGBColor(248, 247, 243);
/// The lines of the grid.
pub const GRID: RGBColor = RGBColor(226, 226, 226);
/// Text, axes and outlines.
pub const INK: RGBColor = RGBColor(34, 34, 34);
/// Secondary elements: outlines of meshes, starts without a robot.
pub const SHADE: RGBColor = RGBColor(120, 120, 120);
/// Background of the picture.
pub const PAPER: RGBColor = RGBColor(255, 255, 255);
/// Wheels.
pub const WHEEL: RGBColor = RGBColor(68, 68, 68);
/// Beams of PSD sensors.
pub const PSD: RGBColor = RGBColor(86, 180, 233);
/// Beams of range sensors other than PSDs.
pub const RANGE: RGBColor = RGBColor(0, 114, 178);
/// Beams of infrared switches.
pub const INFRARED: RGBColor = RGBColor(213, 94, 0);
/// Bumpers.
pub const BUMPER: RGBColor = RGBColor(204, 121, 167);
/// Fields of view of cameras.
pub const CAMERA: RGBColor = RGBColor(230, 159, 0);
/// Laser scanners.
pub const LIDAR: RGBColor = RGBColor(0, 158, 115);
/// Objects without a specified colour.
pub const OBJECT: RGBColor = RGBColor(240, 228, 66);

/// Colour of the robot at `index` of a list; the colours repeat.
pub fn robot(index: usize) -> RGBColor {
    PALETTE[index % PALETTE.len()]
}
