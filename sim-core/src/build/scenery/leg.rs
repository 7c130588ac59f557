//! Default appearance of a robot's legs: a capsule for each thigh and shank, a box for each foot, a disc for each
//! wheel.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use glam::DVec3;

use super::mesh_builder::{MeshBuilder, RoundSize, SIDES};
use crate::build;
use crate::drive::legged::{Foot, Leg};
use crate::pose::Pose3;
use crate::scene::Mesh;
use crate::spec::{Axis, Collider, RobiSpec};

/// Colours (red, green, blue) of thighs, shanks and feet. Source: our choice.
const COLOURS: [[u8; 3]; 3] = [[96, 100, 108], [150, 154, 160], [52, 54, 58]];

/// Meshes of all leg parts, in the order and frames of [`Legs::parts`](crate::drive::legged::Legs::parts).
pub fn meshes(robi: &RobiSpec) -> Vec<Arc<Mesh>> {
    let Some(legs) = build::legs(robi) else { return Vec::new() };
    legs.legs.iter().flat_map(|leg| parts(leg, legs.radius.max(1e-3))).collect()
}

fn parts(leg: &Leg, radius: f64) -> Vec<Arc<Mesh>> {
    let limb = |length: f64, colour| {
        let mut builder = MeshBuilder::default();
        let paint = builder.paint(colour);
        let centre = DVec3::new(0.0, 0.0, -0.5 * length);
        builder.collider(&Collider::Capsule { centre, radius, height: length + 2.0 * radius, axis: Axis::Z }, paint);
        builder
    };
    let mut shank = limb(leg.shank, COLOURS[1]);
    if let Some(wheel) = leg.wheel {
        let paint = shank.paint(COLOURS[2]);
        let height = 2.0 * radius;
        let axle = Pose3::about_axis(DVec3::X, FRAC_PI_2);
        let frame = Pose3 { position: DVec3::new(0.0, 0.5 * height, -leg.shank), ..axle };
        shank.cylinder(&frame, RoundSize { radius: wheel, height, sides: SIDES }, 1, [paint; 2]);
    }
    let foot = leg.foot.map(|foot| sole(&foot, radius));
    [limb(leg.thigh, COLOURS[0]).finish(), shank.finish()].into_iter().chain(foot).collect()
}

/// A foot in the ankle's frame, from the sole up to the ankle, as wide as two limbs.
fn sole(foot: &Foot, radius: f64) -> Arc<Mesh> {
    let mut builder = MeshBuilder::default();
    let paint = builder.paint(COLOURS[2]);
    let centre = DVec3::new(0.5 * (foot.toe - foot.heel), 0.0, -0.5 * foot.height);
    let size = DVec3::new(foot.toe + foot.heel, 4.0 * radius, foot.height);
    builder.collider(&Collider::Box { centre, size: size.max(DVec3::splat(1e-3)) }, paint);
    builder.finish()
}
