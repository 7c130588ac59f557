//! What objects without a mesh look like: their shape in their colour.

use std::sync::Arc;

use super::sketch::Sketch;
use crate::format::{Collider, ObjectType};
use crate::scene::Mesh;

/// Red, green, blue of an object without a colour of its own: yellow. Source: our choice.
const COLOUR: [u8; 3] = [240, 228, 66];

/// Shape and colour of an object's type.
pub fn looks(kind: &ObjectType) -> Arc<Mesh> {
    let mut sketch = Sketch::default();
    let paint = sketch.paint(kind.colour.unwrap_or(COLOUR));
    kind.colliders.iter().for_each(|collider: &Collider| sketch.collider(collider, paint));
    sketch.finish()
}
