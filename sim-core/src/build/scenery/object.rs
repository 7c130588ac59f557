//! Default appearance of objects without a mesh: coloured colliders, with more detail for the built-in objects.

use std::sync::Arc;

use glam::DVec3;

use super::mesh_builder::{MeshBuilder, RoundSize, SIDES};
use crate::pose::Pose3;
use crate::scene::{Mesh, Texture};
use crate::spec::{BUILT_IN_OBJECTS, Collider, ObjectType};

/// Default colour of objects (red, green, blue): yellow. Source: our choice.
const COLOUR: [u8; 3] = [240, 228, 66];

/// Colour of the rims of the built-in can.
const METAL: [u8; 3] = [200, 202, 206];

/// Mesh of an object type from its colliders.
pub fn mesh(kind: &ObjectType) -> Arc<Mesh> {
    let colour = kind.colour.unwrap_or(COLOUR);
    let is_built_in = BUILT_IN_OBJECTS.contains(&kind.file.as_str());
    let mut builder = MeshBuilder::default();
    for collider in &kind.colliders {
        match *collider {
            Collider::Cylinder { centre, radius, height } if is_built_in => {
                can(&mut builder, centre, RoundSize { radius, height, sides: SIDES }, colour);
            }
            Collider::Box { centre, size } if is_built_in => {
                let paint = builder.image(planks(colour));
                builder.cuboid(&Pose3 { position: centre, ..Pose3::IDENTITY }, size, paint);
            }
            _ => {
                let paint = builder.paint(colour);
                builder.collider(collider, paint);
            }
        }
    }
    builder.finish()
}

/// A drink can: a painted cylinder between two narrower metal rims.
fn can(builder: &mut MeshBuilder, centre: DVec3, size: RoundSize, colour: [u8; 3]) {
    let frame = |height: f64| Pose3 { position: centre - 0.5 * height * DVec3::Z, ..Pose3::IDENTITY };
    let (paint, metal) = (builder.paint(colour), builder.paint(METAL));
    let wall = RoundSize { height: 0.9 * size.height, ..size };
    builder.cylinder(&frame(wall.height), wall, 1, [paint; 2]);
    let rims = RoundSize { radius: 0.9 * size.radius, ..size };
    builder.cylinder(&frame(rims.height), rims, 1, [metal; 2]);
}

/// Texture of a wooden box: boards, with a frame and a diagonal brace from the lower left to the upper right.
fn planks(colour: [u8; 3]) -> Arc<Texture> {
    const SIZE: u32 = 64;
    const FRAME: u32 = 9;
    const BOARD: u32 = 12;
    let shade = |column: u32, row: u32| {
        let border = column.min(row).min(SIZE - 1 - column).min(SIZE - 1 - row);
        let brace = (column + row).abs_diff(SIZE - 1);
        // Brightness in percent of the colour.
        let light: u32 = match (border, brace) {
            (FRAME, _) => 60,
            (..FRAME, _) => 100,
            (_, ..7) => 94,
            (_, ..9) => 60,
            _ if (row - FRAME).is_multiple_of(BOARD) => 62,
            _ => 78 + (row - FRAME) / BOARD * 7 % 9,
        };
        let [red, green, blue] = colour.map(|level| (u32::from(level) * light / 100) as u8);
        [red, green, blue, 255]
    };
    let pixels = (0..SIZE * SIZE).map(|pixel| shade(pixel % SIZE, pixel / SIZE)).collect();
    Arc::new(Texture::new(SIZE, SIZE, pixels).expect("the number of pixels matches the size"))
}
