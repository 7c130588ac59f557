//! Meshes prepared for rendering: faces in clusters that are culled together.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::DVec3;

use crate::scene::Mesh;

/// Maximum number of faces of a cluster.
const CLUSTER: usize = 64;

/// The visible faces of a mesh, in their order.
#[derive(Clone, Debug)]
pub struct RenderMesh {
    pub bounds: Sphere,
    pub clusters: Vec<Cluster>,
    /// Corners, cluster by cluster; each corner occurs once per cluster.
    pub corners: Vec<DVec3>,
    pub faces: Vec<ClusterFace>,
    /// For each triangle of the mesh, the unit normal on the side from which the corners are counter-clockwise; 0 for a
    /// triangle without area.
    pub normals: Vec<DVec3>,
}

/// A bounding sphere in the mesh's frame.
#[derive(Clone, Copy, Debug)]
pub struct Sphere {
    pub centre: DVec3,
    pub radius: f64,
}

/// Consecutive faces that are culled together.
#[derive(Clone, Debug)]
pub struct Cluster {
    pub bounds: Sphere,
    pub corners: Range<usize>,
    pub faces: Range<usize>,
    /// Bounding box of the surface to which the faces belong, if the surface is closed. From outside the box, the back
    /// sides of the faces are never visible.
    pub closed_bounds: Option<(DVec3, DVec3)>,
}

/// A face of a cluster; its corners are indices into the cluster's corners.
#[derive(Clone, Copy, Debug)]
pub struct ClusterFace {
    pub triangle: u32,
    pub corners: [u8; 3],
}

impl RenderMesh {
    /// The faces of `mesh` whose materials are visible.
    pub fn new(mesh: &Mesh, is_visible: impl Fn(u32) -> bool) -> Self {
        let visible: Vec<usize> =
            (0..mesh.triangles.len()).filter(|&number| is_visible(mesh.triangles[number].material)).collect();
        let (surface_of, closed_bounds) = surfaces(mesh, &visible);
        let normal = |triangle| {
            let [a, b, c] = mesh.corners(triangle);
            (b - a).cross(c - a).normalize_or_zero()
        };
        let mut render_mesh = Self {
            normals: mesh.triangles.iter().map(normal).collect(),
            bounds: Sphere::around(&mesh.positions),
            clusters: Vec::new(),
            corners: Vec::new(),
            faces: Vec::with_capacity(visible.len()),
        };
        let mut start = 0;
        while start < visible.len() {
            let surface = surface_of[start];
            let count = surface_of[start..].iter().take(CLUSTER).take_while(|next| **next == surface).count();
            render_mesh.add(mesh, &visible[start..start + count], closed_bounds[surface]);
            start += count;
        }
        render_mesh
    }

    fn add(&mut self, mesh: &Mesh, triangles: &[usize], closed_bounds: Option<(DVec3, DVec3)>) {
        let (first_corner, first_face) = (self.corners.len(), self.faces.len());
        let mut indices = BTreeMap::new();
        for &number in triangles {
            let triangle = &mesh.triangles[number];
            let corners = triangle.corners.map(|corner| {
                *indices.entry(corner).or_insert_with(|| {
                    self.corners.push(mesh.positions[corner as usize]);
                    // A face adds at most three corners.
                    (self.corners.len() - 1 - first_corner) as u8
                })
            });
            self.faces.push(ClusterFace { triangle: number as u32, corners });
        }
        self.clusters.push(Cluster {
            bounds: Sphere::around(&self.corners[first_corner..]),
            corners: first_corner..self.corners.len(),
            faces: first_face..self.faces.len(),
            closed_bounds,
        });
    }
}

impl Sphere {
    fn around(points: &[DVec3]) -> Self {
        let low = points.iter().copied().reduce(DVec3::min).unwrap_or_default();
        let high = points.iter().copied().reduce(DVec3::max).unwrap_or_default();
        let centre = 0.5 * low + 0.5 * high;
        let radius = points.iter().map(|point| point.distance(centre)).fold(0.0, f64::max);
        Self { centre, radius: radius * (1.0 + 1e-9) }
    }
}

/// Surfaces of a mesh: sets of triangles connected at corners. Returns the number of the surface of each triangle in
/// `triangles`, and for each surface its bounding box if it is closed and its faces point outwards.
fn surfaces(mesh: &Mesh, triangles: &[usize]) -> (Vec<usize>, Vec<Option<(DVec3, DVec3)>>) {
    let mut parents: Vec<u32> = (0..mesh.positions.len() as u32).collect();
    for &number in triangles {
        let [a, b, c] = mesh.triangles[number].corners;
        let root_a = root(&mut parents, a);
        for corner in [b, c] {
            let root = root(&mut parents, corner);
            parents[root as usize] = root_a;
        }
    }
    let mut numbers = BTreeMap::new();
    let mut surface_of = Vec::with_capacity(triangles.len());
    let mut volumes: Vec<(DVec3, f64)> = Vec::new();
    let mut edges: Vec<(u32, u32, bool, usize)> = Vec::with_capacity(3 * triangles.len());
    for &number in triangles {
        let triangle = &mesh.triangles[number];
        let [a, b, c] = mesh.corners(triangle);
        let surface = *numbers.entry(root(&mut parents, triangle.corners[0])).or_insert_with(|| {
            volumes.push((a, 0.0));
            volumes.len() - 1
        });
        surface_of.push(surface);
        let (origin, volume) = &mut volumes[surface];
        *volume += (a - *origin).dot((b - *origin).cross(c - *origin));
        let [a, b, c] = triangle.corners;
        edges.extend([(a, b), (b, c), (c, a)].map(|(from, to)| (from.min(to), from.max(to), from < to, surface)));
    }
    // A surface is closed if each edge occurs exactly once in each direction.
    edges.sort_unstable();
    let mut is_closed: Vec<bool> = volumes.iter().map(|(_, volume)| *volume > 0.0).collect();
    for uses in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        if !(uses.len() == 2 && uses[0].2 != uses[1].2) {
            is_closed[uses[0].3] = false;
        }
    }
    let mut boxes = vec![(DVec3::INFINITY, DVec3::NEG_INFINITY); volumes.len()];
    for (&number, &surface) in triangles.iter().zip(&surface_of) {
        for corner in mesh.corners(&mesh.triangles[number]) {
            let (low, high) = boxes[surface];
            boxes[surface] = (low.min(corner), high.max(corner));
        }
    }
    let closed = boxes.into_iter().zip(is_closed).map(|(bounds, is_closed)| is_closed.then_some(bounds)).collect();
    (surface_of, closed)
}

/// Root of a node in a forest of parent links; halves the path to it.
fn root(parents: &mut [u32], mut node: u32) -> u32 {
    while parents[node as usize] != node {
        let grandparent = parents[parents[node as usize] as usize];
        parents[node as usize] = grandparent;
        node = grandparent;
    }
    node
}
