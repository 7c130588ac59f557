//! From a still to a picture: which face each pixel shows, and in which colour.

use glam::{DVec2, DVec3};

use super::face::Face;
use super::shade::Shading;
use super::{Label, Picture, Still, View};
use crate::RobotId;
use crate::pose::Pose3;

/// Renders pictures; keeps its memory from one to the next.
#[derive(Clone, Debug, Default)]
pub struct Camera {
    faces: Vec<Face>,
    /// By pixel its ray; with no length where the lens shows nothing.
    rays: Vec<DVec3>,
    /// By pixel the nearest thing so far.
    hits: Vec<Hit>,
}

/// What a pixel shows: what is nearest along its ray.
#[derive(Clone, Copy, Debug)]
struct Hit {
    /// 1 over the multiple of the ray; 0 for the sky.
    nearness: f64,
    shown: Shown,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Shown {
    Sky,
    Ground,
    Face(u32),
}

impl Camera {
    /// What a camera with this view sees: red, green, blue. The body of `by` is left out. Each pixel is the mean of `samples` x
    /// `samples` pixels of a larger picture, rounded; as many as [`View`] allows, at least 1.
    pub fn colour(&mut self, still: &Still, view: &View, by: Option<RobotId>, samples: u32) -> Picture<[u8; 3]> {
        let (samples, fine) =
            (1..=samples.max(1)).rev().find_map(|n| Some((n, view.enlarged(n).ok()?))).unwrap_or((1, *view));
        self.meet(still, &fine, by);
        let [width, height] = view.size();
        let n = samples as usize;
        let row_length = width as usize * n;
        let shading = Shading::new(still, &fine);
        let mut pixels = Vec::with_capacity(width as usize * height as usize);
        for row in 0..height as usize {
            for column in 0..width as usize {
                let mut sum = [0.0_f32; 3];
                for y in 0..n {
                    for x in 0..n {
                        let (fine_row, fine_column) = (row * n + y, column * n + x);
                        let pixel = fine_row * row_length + fine_column;
                        let at = DVec2::new(fine_column as f64 + 0.5, fine_row as f64 + 0.5);
                        let colour = match self.hits[pixel].shown {
                            _ if self.rays[pixel] == DVec3::ZERO => [0.0; 3],
                            Shown::Sky => shading.sky(self.rays[pixel]),
                            Shown::Ground => shading.ground(at, self.rays[pixel]),
                            Shown::Face(face) => shading.face(&self.faces[face as usize], at, self.rays[pixel]),
                        };
                        sum = std::array::from_fn(|channel| sum[channel] + colour[channel]);
                    }
                }
                // A conversion to an integer saturates.
                pixels.push(sum.map(|channel| (channel / (n * n) as f32 + 0.5) as u8));
            }
        }
        Picture::new(view.size(), pixels)
    }

    /// How far it is along each pixel's line of sight, m; infinite for the sky.
    pub fn depth(&mut self, still: &Still, view: &View, by: Option<RobotId>) -> Picture<f32> {
        self.meet(still, view, by);
        let depth = |(hit, ray): (&Hit, &DVec3)| (ray.length() / hit.nearness) as f32;
        Picture::new(view.size(), self.hits.iter().zip(&self.rays).map(depth).collect())
    }

    /// What each pixel shows.
    pub fn labels(&mut self, still: &Still, view: &View, by: Option<RobotId>) -> Picture<Label> {
        self.meet(still, view, by);
        let label = |hit: &Hit| match hit.shown {
            Shown::Sky => Label::Sky,
            Shown::Ground => Label::Ground,
            Shown::Face(face) => still.scenery().parts()[self.faces[face as usize].part as usize].label,
        };
        Picture::new(view.size(), self.hits.iter().map(label).collect())
    }

    /// Finds what each pixel shows.
    fn meet(&mut self, still: &Still, view: &View, by: Option<RobotId>) {
        self.collect(still, view.world_from_camera(), by);
        let [width, height] = view.size();
        self.rays.clear();
        for row in 0..height {
            let ray = |column| view.ray(DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5));
            self.rays.extend((0..width).map(|column| ray(column).unwrap_or_default()));
        }
        let ground = ground_nearness(still, view.world_from_camera());
        self.hits.clear();
        self.hits.extend(self.rays.iter().map(|ray| {
            let nearness = ground.dot(*ray).max(0.0);
            Hit { nearness, shown: if nearness > 0.0 { Shown::Ground } else { Shown::Sky } }
        }));
        for (number, face) in self.faces.iter().enumerate() {
            for (hit, ray) in self.hits.iter_mut().zip(&self.rays) {
                if face.is_met(*ray) {
                    let nearness = face.nearness(*ray);
                    if nearness > hit.nearness {
                        *hit = Hit { nearness, shown: Shown::Face(number as u32) };
                    }
                }
            }
        }
    }

    /// The faces of all parts but the body of `by`, in the camera's frame.
    fn collect(&mut self, still: &Still, world_from_camera: &Pose3, by: Option<RobotId>) {
        self.faces.clear();
        for (number, (part, pose)) in still.scenery().parts().iter().zip(still.poses()).enumerate() {
            if by.is_some_and(|by| part.label == Label::Robot(by)) {
                continue;
            }
            let in_camera = |point: &DVec3| world_from_camera.inverse_transform_point(pose.transform_point(*point));
            let corners: Vec<DVec3> = part.mesh.positions.iter().map(in_camera).collect();
            for (place, triangle) in part.mesh.triangles.iter().enumerate() {
                if still.scenery().look(number, triangle.material).is_seen {
                    let corners = triangle.corners.map(|corner| corners[corner as usize]);
                    self.faces.extend(Face::new(number as u32, place as u32, corners));
                }
            }
        }
    }
}

/// The vector whose product with a ray is 1 over the multiple of the ray that reaches the ground; none where it is 0 or less.
/// 0 where there is no ground, or the camera is not above it.
fn ground_nearness(still: &Still, world_from_camera: &Pose3) -> DVec3 {
    let height = world_from_camera.position.z;
    if still.scenery().ground().is_none() || height <= 0.0 {
        return DVec3::ZERO;
    }
    world_from_camera.rotation.transpose() * DVec3::NEG_Z / height
}
