//! A furnished room, the common test scene for all renderers.

use std::f64::consts::TAU;
use std::sync::Arc;

use glam::{DMat3, DVec2, DVec3, Vec2};
use sim_core::camera::{Attachment, Label, Light, Part, Scenery, Sky};
use sim_core::math;
use sim_core::pose::Pose3;
use sim_core::scene::{Material, Mesh, Texture, Triangle};

use crate::world::Random;

/// Side of the room, m.
pub const SIDE: f64 = 8.0;
/// Height of the walls, m.
const HEIGHT: f64 = 2.5;
/// Number of boxes in the room, of 12 triangles each.
const BOXES: usize = 99;
/// Height of the cameras, m.
const EYE: f64 = 0.25;
/// Number of texels along a texture's side; a texture covers one square metre.
const TEXELS: u32 = 256;

/// The cameras' horizontal field of view, rad.
pub const FIELD: f64 = std::f64::consts::FRAC_PI_3;

/// Position and orientation of a camera, in the world frame.
#[derive(Clone, Copy, Debug)]
pub struct Stand {
    /// Position of the camera, m.
    pub eye: DVec3,
    /// Unit vector along its axis.
    pub forward: DVec3,
    /// Unit vector to its left.
    pub left: DVec3,
}

impl Stand {
    /// Pose of the camera frame in the world frame.
    pub fn pose(&self) -> Pose3 {
        let rotation = DMat3::from_cols(self.forward, self.left, self.forward.cross(self.left));
        Pose3 { position: self.eye, rotation }
    }
}

/// Mesh of 1,200 triangles with four textures: a square room with walls, a floor of two halves, and 99 boxes on the
/// floor.
pub fn room() -> Mesh {
    let mut mesh = Mesh { materials: (0..4).map(material).collect(), ..Mesh::default() };
    let (half, near, far) = (0.5 * SIDE, DVec2::ZERO, DVec2::splat(SIDE));
    for start in [0.0, half] {
        let corner = |x: f64, y: f64| DVec3::new(start + x, y, 0.0);
        push_rectangle(&mut mesh, 0, [corner(0.0, 0.0), corner(half, 0.0), corner(half, SIDE), corner(0.0, SIDE)]);
    }
    let corners = [near, DVec2::new(0.0, SIDE), far, DVec2::new(SIDE, 0.0)];
    for wall in 0..4 {
        push_wall(&mut mesh, 1, corners[wall], corners[(wall + 1) % 4], HEIGHT);
    }
    for block in blocks() {
        let corners = block.corners();
        let material = block.material;
        for side in 0..4 {
            push_wall(&mut mesh, material, corners[side], corners[(side + 1) % 4], block.height);
        }
        let [a, b, c, d] = corners;
        push_rectangle(&mut mesh, material, [a, b, c, d].map(|corner| corner.extend(block.height)));
        push_rectangle(&mut mesh, material, [a, d, c, b].map(|corner| corner.extend(0.0)));
    }
    mesh
}

/// Scenery that consists only of the room, under the sky.
pub fn scenery(light: Light) -> Scenery {
    let part = Part { mesh: Arc::new(room()), label: Label::Fixed(0), attachment: Attachment::Fixed(Pose3::IDENTITY) };
    Scenery::new(vec![part], None, light, Sky { horizon: [200, 210, 230], zenith: [90, 140, 220] })
}

/// Sunlight over the room, with shadows.
pub fn light() -> Light {
    Light { sun_direction: DVec3::new(0.36, 0.48, 0.8), ambient: 0.4, fill: 0.0, diffuse: 0.6, shadows: true }
}

/// `count` views at a robot's height, at least 20 cm away from every box.
pub fn stands(count: usize) -> Vec<Stand> {
    let mut random = Random::new(52);
    let blocks = blocks();
    let mut stand = || {
        loop {
            let position = DVec2::new(random.between(0.5, SIDE - 0.5), random.between(0.5, SIDE - 0.5));
            let forward = random.direction();
            if blocks.iter().all(|block| block.is_clear_of(position, 0.2)) {
                return Stand {
                    eye: position.extend(EYE),
                    forward: forward.extend(0.0),
                    left: forward.perp().extend(0.0),
                };
            }
        }
    };
    (0..count).map(|_| stand()).collect()
}

/// A box on the floor.
struct Block {
    centre: DVec2,
    /// Half sizes along the axes of the box.
    half: DVec2,
    /// Unit vector along the first axis.
    axis: DVec2,
    height: f64,
    material: u32,
}

fn blocks() -> Vec<Block> {
    let mut random = Random::new(51);
    let mut block = |number: u32| {
        let (sin, cos) = math::sin_cos(random.between(0.0, TAU));
        Block {
            centre: DVec2::new(random.between(0.5, SIDE - 0.5), random.between(0.5, SIDE - 0.5)),
            half: DVec2::new(random.between(0.05, 0.3), random.between(0.05, 0.3)),
            axis: DVec2::new(cos, sin),
            height: random.between(0.1, 0.8),
            material: 2 + number % 2,
        }
    };
    (0..BOXES as u32).map(&mut block).collect()
}

impl Block {
    /// Corners in counter-clockwise order, seen from above.
    fn corners(&self) -> [DVec2; 4] {
        let (x, y) = (self.axis * self.half.x, self.axis.perp() * self.half.y);
        [self.centre - x - y, self.centre + x - y, self.centre + x + y, self.centre - x + y]
    }

    /// Returns true if a point is more than `distance` m outside a side of the box.
    fn is_clear_of(&self, point: DVec2, distance: f64) -> bool {
        let offset = point - self.centre;
        let outside = DVec2::new(offset.dot(self.axis).abs(), offset.dot(self.axis.perp()).abs()) - self.half;
        outside.max_element() > distance
    }
}

/// Adds an upright rectangle on the line from `from` to `to`, visible from the right of that line.
fn push_wall(mesh: &mut Mesh, material: u32, from: DVec2, to: DVec2, height: f64) {
    push_rectangle(mesh, material, [from.extend(0.0), to.extend(0.0), to.extend(height), from.extend(height)]);
}

/// Adds a rectangle with these corners, counter-clockwise on its visible side. The texture's horizontal axis is along
/// the first side.
fn push_rectangle(mesh: &mut Mesh, material: u32, corners: [DVec3; 4]) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(corners);
    let (width, height) = ((corners[1] - corners[0]).length(), (corners[3] - corners[0]).length());
    let uv = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]].map(|[u, v]| Vec2::new(u as f32, v as f32));
    for [a, b, c] in [[0, 1, 2], [0, 2, 3]] {
        let corners = [a, b, c].map(|corner| first + corner as u32);
        mesh.triangles.push(Triangle { corners, normals: None, uv: Some([uv[a], uv[b], uv[c]]), material });
    }
}

fn material(number: u32) -> Material {
    let name = ["tiles", "bricks", "boards", "cardboard"][number as usize].to_owned();
    let pixels = (0..TEXELS * TEXELS).map(|index| texel(number, index % TEXELS, index / TEXELS)).collect();
    let texture = Texture::new(TEXELS, TEXELS, pixels).map(Arc::new);
    Material { name, colour: [1.0; 3], opacity: 1.0, texture }
}

/// Texel of tiles, bricks, boards or cardboard with a letter L, so that pictures show the orientation.
fn texel(number: u32, column: u32, row: u32) -> [u8; 4] {
    let grain =
        ((column.wrapping_mul(0x9e37_79b1) ^ row.wrapping_mul(0x85eb_ca6b)).wrapping_mul(0xc2b2_ae35) >> 28) as u8;
    let [red, green, blue] = match number {
        0 if column % 64 < 3 || row % 64 < 3 => [90, 90, 95],
        0 if (column / 64 + row / 64).is_multiple_of(2) => [190, 185, 175],
        0 => [150, 150, 150],
        1 if row % 32 < 3 || (column + row / 32 % 2 * 32) % 64 < 3 => [200, 195, 185],
        1 => [160, 80, 60],
        2 if column % 32 < 2 => [80, 50, 25],
        2 => [170, 125, 70],
        _ if (16..24).contains(&column) && (16..64).contains(&row) => [20, 20, 60],
        _ if (16..48).contains(&column) && (56..64).contains(&row) => [20, 20, 60],
        _ => [60, 140, 170],
    };
    [red + grain, green + grain, blue + grain, 255]
}
