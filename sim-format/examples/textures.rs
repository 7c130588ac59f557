//! Draws the images of floors and terrains in `worlds/textures`: `cargo run -p sim-format --example textures` in the
//! repository root.

use std::f64::consts::TAU;
use std::path::Path;

use glam::DVec2;
use image::{ImageBuffer, Luma, Rgb, RgbImage};
use sim_core::math;
use sim_core::scene::{Disc, RandomTerrain};

type Colour = [u8; 3];

const WHITE: Colour = [240, 240, 236];

fn main() -> image::ImageResult<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../worlds/textures");
    for (name, draw) in FLOORS {
        turned(&draw()).save(folder.join(name))?;
    }
    for (name, draw) in TERRAINS {
        draw().save(folder.join(name))?;
    }
    Ok(())
}

/// An image of a floor as a `.wld` has it: turned by 180 degrees.
pub fn turned(floor: &RgbImage) -> RgbImage {
    image::imageops::rotate180(floor)
}

/// Function that draws an image.
type Draw = fn() -> RgbImage;

/// Images of floors by their file names.
pub const FLOORS: [(&str, Draw); 4] =
    [("track.png", track), ("road.png", road), ("soccer.png", soccer), ("tiles.png", tiles)];

/// Height map, 0 to 65535.
pub type Heights = ImageBuffer<Luma<u16>, Vec<u16>>;

/// Function that draws a height map.
type Survey = fn() -> Heights;

/// Height maps by their file names.
pub const TERRAINS: [(&str, Survey); 1] = [("hills.png", hills)];

/// Hills over 6 x 4 m, level and black around two points 1 m from the left and from the right side.
fn hills() -> Heights {
    let clear = [1.0, 5.0].map(|x| Disc { centre: DVec2::new(x, 2.0), radius: 0.5 });
    let terrain = RandomTerrain {
        seed: 1,
        origin: DVec2::ZERO,
        size: DVec2::new(6.0, 4.0),
        base: 0.0,
        cell: 0.05,
        relief_height: 1.0,
        hill_length: 2.0,
        boulders: None,
        clear: clear.to_vec(),
    };
    let (field, _) = terrain.field().expect("few enough cells");
    let (columns, rows) = field.size();
    ImageBuffer::from_fn(columns as u32, rows as u32, |column, row| {
        let height = field.corner(column as usize, rows - 1 - row as usize).z;
        Luma([(height * f64::from(u16::MAX)).round() as u16])
    })
}

/// Floor of `size` metres with pixels of `pixel` metres: each is the mean of `colour` at 3 x 3 points in it, x to the
/// right and y upwards from the lower left corner.
fn floor(size: DVec2, pixel: f64, colour: impl Fn(DVec2) -> Colour) -> RgbImage {
    const SIDE: u32 = 3;
    let [width, height] = (size / pixel).round().to_array().map(|count| count as u32);
    RgbImage::from_fn(width, height, |column, row| {
        let mut sum = [0_u32; 3];
        for index in 0..SIDE * SIDE {
            let within = DVec2::new(f64::from(index % SIDE), f64::from(index / SIDE)) + 0.5;
            let at = DVec2::new(f64::from(column), f64::from(height - 1 - row)) + within / f64::from(SIDE);
            let shades = colour(at * pixel);
            sum.iter_mut().zip(shades).for_each(|(sum, shade)| *sum += u32::from(shade));
        }
        Rgb(sum.map(|sum| (sum / (SIDE * SIDE)) as u8))
    })
}

/// Points of the closed line of [`track`].
pub fn track_line() -> Vec<DVec2> {
    const STEPS: u32 = 500;
    let point = |step| {
        let (sin, cos) = math::sin_cos(TAU * f64::from(step) / f64::from(STEPS));
        DVec2::new(1.5 + 1.15 * cos, 1.176 + 0.62 * sin + 0.18 * (cos * cos - sin * sin))
    };
    (0..STEPS).map(point).collect()
}

/// A dark closed line, 25 mm wide, on a light floor of 3 x 2 m; it bends to both sides, with radii from 0.19 m.
fn track() -> RgbImage {
    const SIZE: DVec2 = DVec2::new(3.0, 2.0);
    const HALF: f64 = 0.0125;
    /// Distance within which the line is searched, and side of the cells that list its parts.
    const NEAR: f64 = 4.0 * HALF;
    let cell_of = |at: DVec2| (at / NEAR).to_array().map(|cell| cell as usize);
    let [columns, rows] = cell_of(SIZE).map(|last| last + 1);
    let line = track_line();
    let mut cells = vec![Vec::new(); columns * rows];
    for (a, b) in line.iter().zip(line.iter().cycle().skip(1)) {
        let (first, last) = (cell_of(*a - NEAR), cell_of(*a + NEAR));
        for row in first[1]..=last[1] {
            for column in first[0]..=last[0] {
                cells[row * columns + column].push((*a, *b));
            }
        }
    }
    let distance = |at: DVec2| {
        let [column, row] = cell_of(at);
        cells[row * columns + column]
            .iter()
            .map(|(a, b)| {
                let along = *b - *a;
                let fraction = ((at - *a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
                at.distance(*a + fraction * along)
            })
            .fold(f64::INFINITY, f64::min)
    };
    floor(SIZE, 0.0025, |at| if distance(at) < HALF { [24, 24, 28] } else { [232, 229, 220] })
}

/// A road of two lanes, 400 mm each, around a lawn of 6 x 4 m: white lines at its edges, dashes of 200 mm between the
/// lanes.
fn road() -> RgbImage {
    const CENTRE: DVec2 = DVec2::new(3.0, 2.0);
    /// Half sizes of the rounded rectangle in the middle of the road, and the radius of its corners.
    const HALF: DVec2 = DVec2::new(2.2, 1.2);
    const RADIUS: f64 = 0.9;
    const LANE: f64 = 0.4;
    const LINE: f64 = 0.0125;
    floor(DVec2::new(6.0, 4.0), 0.005, |at| {
        let beyond = (at - CENTRE).abs() - (HALF - RADIUS);
        let corner = beyond.max(DVec2::ZERO);
        let distance = corner.length() + beyond.max_element().min(0.0) - RADIUS;
        // Arc length along the middle from the middle of a side, the same in all four quarters.
        let straight = HALF - RADIUS;
        let quarter = (at - CENTRE).abs();
        let way = if beyond.x <= 0.0 && beyond.y > beyond.x {
            quarter.x
        } else if beyond.y <= 0.0 {
            straight.x + 0.25 * TAU * RADIUS + straight.y - quarter.y
        } else {
            straight.x + RADIUS * math::atan2(beyond.x, beyond.y)
        };
        let is_dash = ((way + 0.1) / 0.2).floor() as i64 % 2 == 0;
        if distance.abs() > LANE + 0.04 {
            let is_dark = ((at.x / 0.25).floor() + (at.y / 0.25).floor()) as i64 % 2 == 0;
            if is_dark { [92, 128, 72] } else { [100, 136, 78] }
        } else if (distance.abs() - LANE + 0.03).abs() < LINE || distance.abs() < LINE && is_dash {
            WHITE
        } else {
            [72, 73, 78]
        }
    })
}

/// Field of `soccer.wld`: lines, mown stripes, the left goal yellow and the right one blue.
fn soccer() -> RgbImage {
    const SIZE: DVec2 = DVec2::new(2.8, 1.4);
    const END: f64 = 0.2;
    const HALF_LINE: f64 = 0.0075;
    floor(SIZE, 0.004, |at| {
        let from_middle = (at - 0.5 * SIZE).abs();
        let end = 0.5 * SIZE.x - END;
        let on = |distance: f64| distance.abs() < HALF_LINE;
        if from_middle.x > end + HALF_LINE {
            return if at.x < 0.5 * SIZE.x { [220, 200, 60] } else { [50, 90, 190] };
        }
        let box_line = |depth: f64, half: f64| {
            (on(from_middle.x - (end - depth)) && from_middle.y < half + HALF_LINE)
                || (on(from_middle.y - half) && from_middle.x > end - depth)
        };
        let touch = on(from_middle.y - 0.5 * SIZE.y + HALF_LINE) || on(from_middle.x - end);
        let middle = on(from_middle.x) || on(from_middle.length() - 0.25) || from_middle.length() < 0.02;
        if touch || middle || box_line(0.3, 0.4) {
            return WHITE;
        }
        let is_light = ((at.x - END) / 0.2).floor() as i64 % 2 == 0;
        if is_light { [58, 138, 62] } else { [48, 124, 54] }
    })
}

/// Tiles of 250 mm in two shades with joints of 5 mm, on 4 x 3 m.
fn tiles() -> RgbImage {
    const TILE: f64 = 0.25;
    floor(DVec2::new(4.0, 3.0), 0.005, |at| {
        let within = at - TILE * (at / TILE).floor();
        if within.min_element() < 0.0025 || within.max_element() > TILE - 0.0025 {
            return [126, 122, 116];
        }
        let tile = (at / TILE).floor();
        // No two neighbours alike, and no obvious pattern.
        let shade = (7.0 * tile.x + 13.0 * tile.y + tile.x * tile.y) as u32 * 5 % 11;
        let light = if (tile.x + tile.y) as i64 % 2 == 0 { 190 } else { 205 };
        [light + shade as u8, light - 4 + shade as u8, light - 14 + shade as u8]
    })
}
