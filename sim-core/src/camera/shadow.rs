//! Shadows: the shadow-casting faces, binned in a grid perpendicular to the sun's direction.
//!
//! The shadows are hard and exact, without a shadow map. A point is in shadow if another face, farther from the point
//! than [`SHADOW_BIAS`], hides the sun from it. Everything visible except the ground casts shadows, including the robot
//! that carries the camera. Source: our choice; the papers do not mention shadows.

use glam::{DVec2, DVec3};

use super::{Attachment, Part, PosedScenery, Scenery};

/// Shadow bias in metres. A face nearer to a point than this casts no shadow on it; otherwise rounding would make
/// touching faces shadow each other.
pub const SHADOW_BIAS: f64 = 1e-6;

/// Enlargement of a face on all sides, in metres, so that no light passes between two faces.
const SLACK: f64 = 1e-9;

/// Axes of a frame in which the sun is infinitely far away along the third axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes([DVec3; 3]);

/// Shadow casters, binned in a grid perpendicular to the sun's direction.
#[derive(Clone, Debug, Default)]
pub struct ShadowGrid {
    /// Lower left corner of the grid.
    low: DVec2,
    cells_per_metre: f64,
    /// Number of columns and rows.
    size: [usize; 2],
    /// For each cell, the index of its first entry in `members`; the last element is the length of `members`.
    starts: Vec<u32>,
    /// Indices of the faces of each cell, in descending order of [`Caster::highest`].
    members: Vec<u32>,
    faces: Vec<Caster>,
}

/// A face that casts a shadow.
#[derive(Clone, Debug)]
struct Caster {
    /// For each edge, the signed distance from it (m, positive inside) as a linear function of the position
    /// perpendicular to the sun's direction.
    edges: [[f64; 3]; 3],
    /// Coordinate of the face towards the sun (m), as a linear function of the position perpendicular to the sun's
    /// direction.
    plane: [f64; 3],
    /// Maximum coordinate towards the sun.
    highest: f64,
    /// Lower left corner of its bounding rectangle; `high` is the upper right one.
    low: DVec2,
    high: DVec2,
    part: u32,
    triangle: u32,
}

#[inline(always)]
fn evaluate([a, b, c]: [f64; 3], position: DVec2) -> f64 {
    a * position.x + b * position.y + c
}

impl Axes {
    /// Axes for a sun in the direction `sun_direction`, a unit vector.
    pub fn new(sun_direction: DVec3) -> Self {
        let (first, second) = sun_direction.any_orthonormal_pair();
        Self([first, second, sun_direction])
    }

    /// The two axes perpendicular to the sun's direction and the axis towards the sun.
    pub fn directions(&self) -> [DVec3; 3] {
        self.0
    }

    fn coordinates(&self, point: DVec3) -> DVec3 {
        DVec3::from(self.0.map(|axis| axis.dot(point)))
    }
}

impl Caster {
    /// The face with these corners; `None` if it is edge-on to the sun. Also `None` for a face of a closed surface that
    /// points away from the sun, because the faces that point towards the sun cast the same shadow.
    fn new((part, triangle): (u32, u32), corners: [DVec3; 3], is_closed: bool) -> Option<Self> {
        let [a, b, c] = corners.map(DVec3::truncate);
        let area = (b - a).perp_dot(c - a);
        let longest = (b - a).length_squared().max((c - a).length_squared());
        // A ray towards the sun leaves a closed surface through a face that points towards the sun.
        let is_redundant = is_closed && area < 0.0;
        // False for NaN.
        let is_usable = area.abs() > 1e-9 * longest && longest < 1e30;
        if is_redundant || !is_usable {
            return None;
        }
        let edge = |from: DVec2, to: DVec2| {
            let inwards = (to - from).perp().normalize_or_zero() * area.signum();
            [inwards.x, inwards.y, -inwards.dot(from)]
        };
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let (x, y) = (-normal.x / normal.z, -normal.y / normal.z);
        let heights = corners.map(|corner| corner.z);
        Some(Self {
            edges: [edge(a, b), edge(b, c), edge(c, a)],
            plane: [x, y, corners[0].z - x * a.x - y * a.y],
            highest: heights[0].max(heights[1]).max(heights[2]),
            low: a.min(b).min(c),
            high: a.max(b).max(c),
            part,
            triangle,
        })
    }

    /// Returns true if the face hides the sun from a point.
    #[inline(always)]
    fn hides_sun_from(&self, position: DVec2, height: f64) -> bool {
        self.edges.iter().all(|edge| evaluate(*edge, position) >= -SLACK)
            && evaluate(self.plane, position) > height + SHADOW_BIAS
    }
}

impl ShadowGrid {
    /// Fills the grid with the faces of all parts for which `casts_shadow` returns true.
    pub fn fill(
        &mut self,
        scenery: &Scenery,
        posed: Option<&PosedScenery>,
        axes: &Axes,
        casts_shadow: impl Fn(&Part) -> bool,
    ) {
        self.faces.clear();
        let mut corners = Vec::new();
        for (number, part) in scenery.parts().iter().enumerate().filter(|(_, part)| casts_shadow(part)) {
            let pose = match (part.attachment, posed) {
                (Attachment::Fixed(pose), _) => Some(pose),
                (_, posed) => posed.and_then(|posed| posed.poses()[number]),
            };
            let Some(pose) = pose else { continue };
            let render_mesh = scenery.render_mesh(number);
            for cluster in &render_mesh.clusters {
                corners.clear();
                let cluster_corners = &render_mesh.corners[cluster.corners.clone()];
                corners.extend(cluster_corners.iter().map(|corner| axes.coordinates(pose.transform_point(*corner))));
                for face in &render_mesh.faces[cluster.faces.clone()] {
                    let corners = face.corners.map(|corner| corners[usize::from(corner)]);
                    let face_id = (number as u32, face.triangle);
                    self.faces.extend(Caster::new(face_id, corners, cluster.closed_bounds.is_some()));
                }
            }
        }
        self.bin_faces();
    }

    /// Bins the faces into a grid of about four cells per face.
    fn bin_faces(&mut self) {
        let low = self.faces.iter().fold(DVec2::INFINITY, |low, face| low.min(face.low)) - 2.0 * SLACK;
        let high = self.faces.iter().fold(DVec2::NEG_INFINITY, |high, face| high.max(face.high)) + 2.0 * SLACK;
        self.starts.clear();
        self.members.clear();
        if self.faces.is_empty() {
            self.size = [0; 2];
            return;
        }
        let extent = high - low;
        let cells = (4 * self.faces.len()).clamp(64, 1 << 20) as f64;
        let cell = (extent.x * extent.y / cells).sqrt().max(extent.max_element() / 4096.0);
        self.low = low;
        self.cells_per_metre = 1.0 / cell;
        self.size = [extent.x, extent.y].map(|side| (side * self.cells_per_metre) as usize + 1);
        self.starts.resize(self.size[0] * self.size[1] + 1, 0);
        let mut starts = std::mem::take(&mut self.starts);
        for face in &self.faces {
            self.for_each_cell(face, |cell| starts[cell + 1] += 1);
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let mut members = std::mem::take(&mut self.members);
        members.resize(starts.last().map_or(0, |end| *end as usize), 0);
        let mut next = starts.clone();
        let mut order: Vec<u32> = (0..self.faces.len() as u32).collect();
        order.sort_by(|a, b| {
            let highest = |face: &u32| self.faces[*face as usize].highest;
            highest(b).total_cmp(&highest(a)).then(a.cmp(b))
        });
        for number in order {
            self.for_each_cell(&self.faces[number as usize], |cell| {
                members[next[cell] as usize] = number;
                next[cell] += 1;
            });
        }
        (self.starts, self.members) = (starts, members);
    }

    /// Visits the cells that a face overlaps.
    fn for_each_cell(&self, face: &Caster, mut visit: impl FnMut(usize)) {
        let [columns, rows] = self.size;
        let cell_coordinates = |position: DVec2| ((position - self.low) * self.cells_per_metre).max(DVec2::ZERO);
        let (first, last) = (cell_coordinates(face.low - SLACK), cell_coordinates(face.high + SLACK));
        let half = 0.5 / self.cells_per_metre;
        for row in first.y as usize..=(last.y as usize).min(rows - 1) {
            for column in first.x as usize..=(last.x as usize).min(columns - 1) {
                let middle = self.low + DVec2::new(column as f64 + 0.5, row as f64 + 0.5) / self.cells_per_metre;
                let touches = face.edges.iter().all(|edge| {
                    let reach = (edge[0].abs() + edge[1].abs()) * half;
                    evaluate(*edge, middle) >= -reach * (1.0 + 1e-6) - 2.0 * SLACK
                });
                if touches {
                    visit(row * columns + column);
                }
            }
        }
    }

    /// Returns true if another face hides the sun from a point on the face `shown_face` (numbers of part and triangle).
    /// `last_caster` caches the index of the face that hid the sun in the last call that returned true.
    #[inline]
    pub fn is_shaded(&self, point: DVec3, shown_face: (u32, u32), last_caster: &mut usize) -> bool {
        let position = point.truncate();
        let cell = (position - self.low) * self.cells_per_metre;
        let [columns, rows] = self.size;
        // False for NaN.
        let is_inside = cell.x >= 0.0 && cell.y >= 0.0 && cell.x < columns as f64 && cell.y < rows as f64;
        if !is_inside {
            return false;
        }
        let is_shown = |face: &Caster| (face.part, face.triangle) == shown_face;
        if let Some(face) = self.faces.get(*last_caster)
            && face.hides_sun_from(position, point.z)
            && !is_shown(face)
        {
            return true;
        }
        let cell = cell.y as usize * columns + cell.x as usize;
        for &number in &self.members[self.starts[cell] as usize..self.starts[cell + 1] as usize] {
            let face = &self.faces[number as usize];
            if face.highest <= point.z + SHADOW_BIAS {
                return false;
            }
            if face.hides_sun_from(position, point.z) && !is_shown(face) {
                *last_caster = number as usize;
                return true;
            }
        }
        false
    }
}
