//! Binning of faces into tiles of the image.

use glam::DVec3;

use super::face::Face;
use super::optics::{Optics, PixelRect, TILE};
use super::rays::{RayTable, Window};
use super::{Label, PosedScenery, View};
use crate::RobotId;

/// The faces that may be visible: all of them, and those of each tile.
#[derive(Clone, Debug, Default)]
pub struct Bins {
    pub faces: Vec<Face>,
    /// For each tile, the numbers of its faces in ascending order.
    pub tiles: Vec<Vec<u32>>,
    /// Buffer: corners of the cluster in progress in lens space, with their [image positions](Optics::image_position).
    corners: Vec<(DVec3, DVec3)>,
}

impl Bins {
    /// Bins all faces in the view, except those of the robot `observer`.
    pub fn fill(
        &mut self,
        posed: &PosedScenery,
        view: &View,
        optics: &Optics,
        rays: &RayTable,
        observer: Option<RobotId>,
    ) {
        let [columns, rows] = optics.tiles().map(|count| count as usize);
        self.faces.clear();
        self.tiles.iter_mut().for_each(Vec::clear);
        self.tiles.resize_with(columns * rows, Vec::new);
        let camera = view.world_from_camera();
        let camera_from_world = camera.rotation.transpose();
        let scenery = posed.scenery();
        for (number, part, pose) in posed.parts() {
            if observer.is_some_and(|robot| part.label == Label::Robot(robot)) {
                continue;
            }
            let render_mesh = scenery.render_mesh(number);
            let offset = camera_from_world * (pose.position - camera.position);
            let rotation = camera_from_world * pose.rotation;
            let may_show =
                |sphere: &super::render_mesh::Sphere| optics.may_show(offset + rotation * sphere.centre, sphere.radius);
            if !may_show(&render_mesh.bounds) {
                continue;
            }
            let lens_from_part = optics.lens_from_camera * rotation;
            let offset = optics.lens_from_camera * offset;
            let eye = pose.inverse_transform_point(camera.position);
            for cluster in &render_mesh.clusters {
                if render_mesh.clusters.len() > 1 && !may_show(&cluster.bounds) {
                    continue;
                }
                let is_outside = |(low, high): (DVec3, DVec3)| eye.cmplt(low).any() || eye.cmpgt(high).any();
                let hides_back_sides = cluster.closed_bounds.is_some_and(is_outside);
                self.corners.clear();
                self.corners.extend(render_mesh.corners[cluster.corners.clone()].iter().map(|corner| {
                    let corner = lens_from_part * *corner + offset;
                    (corner, optics.image_position(corner))
                }));
                for face in &render_mesh.faces[cluster.faces.clone()] {
                    let corners = face.corners.map(|corner| self.corners[usize::from(corner)]);
                    let Some(area) = optics.area(corners.map(|corner| corner.1)) else { continue };
                    let corners = corners.map(|corner| corner.0);
                    if let Some(face) =
                        Face::new((number as u32, face.triangle), corners, &optics.lens_from_camera, hides_back_sides)
                    {
                        self.add(face, area, optics, rays);
                    }
                }
            }
        }
    }

    fn add(&mut self, face: Face, area: PixelRect, optics: &Optics, rays: &RayTable) {
        let number = self.faces.len() as u32;
        let columns = optics.tiles()[0];
        let (first, last) = (area.first.map(|pixel| pixel / TILE), area.last.map(|pixel| pixel / TILE));
        let is_in_one_tile = first == last;
        let mut is_visible = false;
        for row in first[1]..=last[1] {
            for column in first[0]..=last[0] {
                let tile = (row * columns + column) as usize;
                let may_show = is_in_one_tile
                    || if optics.is_flat {
                        may_hit::<true>(&face, &Window::flat([column, row]))
                    } else {
                        may_hit::<false>(&face, &Window::curved(rays.cone(tile)))
                    };
                if may_show {
                    self.tiles[tile].push(number);
                    is_visible = true;
                }
            }
        }
        if is_visible {
            self.faces.push(face);
        }
    }
}

/// Returns true if a ray of the tile may hit the face.
#[inline(always)]
fn may_hit<const FLAT: bool>(face: &Face, window: &Window) -> bool {
    face.edges.iter().all(|edge| {
        let (middle, deviation) = window.middle_and_deviation::<FLAT>(*edge);
        middle + deviation > -2.0 * window.slack::<FLAT>(*edge)
    })
}
