use super::*;
use crate::RobotId;
use crate::noise::{Purpose, Stream};
use crate::scene::{Block, MeshIndex, Stairs, StairsDirection, Steps};

/// A hilly field on an uneven grid in which some coordinates occur twice.
pub(super) fn rough(seed: u64) -> HeightField {
    let mut stream = Stream::new(seed, RobotId(0), Purpose::Terrain, 99, 0);
    let mut lines = |low: f64| {
        let mut coordinate = low;
        let mut lines = vec![coordinate];
        for _ in 0..20 {
            coordinate += 0.02 + 0.3 * stream.unit();
            lines.push(coordinate);
            if stream.unit() < 0.3 {
                lines.push(coordinate);
            }
        }
        coordinate += 0.1;
        lines.push(coordinate);
        lines
    };
    let (xs, ys) = (lines(-1.5), lines(0.25));
    let heights = (0..xs.len() * ys.len()).map(|_| 0.8 * stream.unit() - 0.2).collect();
    HeightField::new(xs, ys, heights).expect("a field")
}

fn mesh_index(field: &HeightField) -> MeshIndex {
    let mesh = field.mesh(None);
    let corners: Vec<_> = mesh.triangles.iter().map(|triangle| mesh.corners(triangle)).collect();
    MeshIndex::new(&corners)
}

#[test]
fn height_and_normal_match_vertical_rays() {
    for seed in 0..8 {
        let field = rough(seed);
        let (mesh, index) = (field.mesh(None), mesh_index(&field));
        let mut stream = Stream::new(seed, RobotId(0), Purpose::Terrain, 98, 0);
        let Bounds { min, max } = field.bounds();
        for _ in 0..4000 {
            let [x, y] = [min.x + (max.x - min.x) * stream.unit(), min.y + (max.y - min.y) * stream.unit()];
            let hit = index.cast(DVec3::new(x, y, 5.0), DVec3::NEG_Z, 20.0).expect("the surface has no gap");
            // 1 nm on a field of several metres.
            assert!((5.0 - hit.distance - field.height(x, y)).abs() < 1e-9, "seed {seed} at {x}, {y}");
            let [a, b, c] = mesh.corners(&mesh.triangles[hit.triangle as usize]);
            let normal = (b - a).cross(c - a).normalize_or_zero();
            assert!(normal.distance(field.normal(x, y)) < 1e-9, "seed {seed} at {x}, {y}: {normal}");
        }
    }
}

/// Returns true if the coordinate `value` occurs twice in `lines`.
fn is_double(lines: &[f64], value: f64) -> bool {
    lines.windows(2).any(|pair| pair == [value; 2])
}

#[test]
fn rays_at_shared_edges_and_corners_hit_the_surface() {
    let mut oblique_count = 0;
    for seed in 0..4 {
        let field = rough(seed);
        let index = mesh_index(&field);
        let (columns, rows) = field.size();
        // Points on the border are omitted, because a ray may pass beside it within rounding.
        for row in 1..rows - 2 {
            for column in 1..columns - 2 {
                let corner = field.corner(column, row);
                let right = field.corner(column + 1, row);
                let opposite = field.corner(column + 1, row + 1);
                for point in [corner, 0.5 * (corner + right), 0.5 * (corner + opposite)] {
                    // Vertical edges of different heights on one line are not shared edges.
                    if is_double(&field.xs, point.x) && is_double(&field.ys, point.y) {
                        continue;
                    }
                    let hit = index.cast(DVec3::new(point.x, point.y, 3.0), DVec3::NEG_Z, 20.0);
                    let hit = hit.unwrap_or_else(|| panic!("seed {seed}: a gap at {point}"));
                    // At a step, the ray hits its upper edge, or passes the edge within rounding.
                    let height = 3.0 - hit.distance;
                    assert!(height <= field.height(point.x, point.y) + 1e-9, "seed {seed} at {point}");
                    // A steep ray may pass over a ridge within rounding; it then hits the ground beyond the ridge, at
                    // most 0.8 m lower.
                    let Bounds { min, max } = field.bounds();
                    let inner = Bounds { min: min + 0.15, max: max - 0.15 };
                    for offset in [DVec3::new(0.3, -0.2, 3.0), DVec3::new(-0.1, 0.4, 3.0)] {
                        if !inner.contains(point.truncate()) {
                            continue;
                        }
                        oblique_count += 1;
                        let origin = point + offset;
                        let direction = (point - origin).try_normalize().expect("the points differ");
                        assert!(index.cast(origin, direction, 100.0).is_some(), "seed {seed}: a gap at {point}");
                    }
                }
            }
        }
    }
    assert!(oblique_count > 5000, "{oblique_count} oblique rays");
}

#[test]
fn a_step_is_vertical_and_exact() {
    let block = Block { bounds: Bounds { min: DVec2::new(1.0, 1.0), max: DVec2::new(2.0, 2.0) }, height: 0.3 };
    let steps = Steps { origin: DVec2::ZERO, size: DVec2::splat(3.0), base: 0.0, stairs: vec![], blocks: vec![block] };
    let field = steps.field().expect("a field");
    for (x, height) in [(1.0_f64.next_down(), 0.0), (1.0, 0.3), (2.0, 0.3), (2.0_f64.next_up(), 0.0)] {
        assert_eq!(field.height(x, 1.5), height, "at {x}");
        assert_eq!(field.height(1.5, x), height, "at {x}");
        assert_eq!(field.normal(x, 1.5), DVec3::Z);
    }
    let index = mesh_index(&field);
    for z in [0.001, 0.1, 0.299] {
        let hit = index.cast(DVec3::new(0.25, 1.5, z), DVec3::X, 10.0).expect("the ray hits the side of the block");
        assert!((hit.distance - 0.75).abs() < 1e-12, "{hit:?}");
    }
    assert!(index.cast(DVec3::new(0.25, 1.5, 0.301), DVec3::X, 10.0).is_none(), "above the block");
    // 9 horizontal cells (ground and top) and 4 vertical ones (sides), two triangles each, and no triangle without
    // area.
    assert_eq!(field.mesh(None).triangles.len(), 2 * 9 + 2 * 4);
}

#[test]
fn ground_continues_level_beyond_the_border() {
    let heights = vec![0.0, 1.0, 2.0, 3.0];
    let field = HeightField::new(vec![0.0, 1.0], vec![0.0, 1.0], heights).expect("a field");
    assert_eq!([field.height(-5.0, 0.0), field.height(9.0, 0.5), field.height(1e300, f64::INFINITY)], [0.0, 2.0, 3.0]);
    assert!(field.height(f64::NAN, 0.0).is_nan());
    assert_eq!(field.normal(-5.0, -5.0), DVec3::Z);
    assert!(field.normal(-5.0, 0.5).distance(DVec3::new(0.0, -2.0, 1.0).normalize_or_zero()) < 1e-15);
}

#[test]
fn invalid_fields_are_rejected() {
    let error = |xs: &[f64], ys: &[f64], heights: &[f64]| {
        HeightField::new(xs.to_vec(), ys.to_vec(), heights.to_vec()).expect_err("the field is invalid")
    };
    let four = [0.0; 4];
    assert_eq!(error(&[], &[0.0, 1.0], &[]), FieldError::Small);
    assert_eq!(error(&[1.0], &[0.0, 1.0], &[0.0; 2]), FieldError::Small);
    assert_eq!(error(&[1.0, 1.0], &[0.0, 1.0], &four), FieldError::Small);
    assert_eq!(error(&[1.0, 0.0, 2.0], &[0.0, 1.0], &[0.0; 6]), FieldError::Order);
    assert_eq!(error(&[0.0, 1.0, 1.0, 1.0, 2.0], &[0.0, 1.0], &[0.0; 10]), FieldError::Order);
    assert_eq!(error(&[0.0, 1.0], &[0.0, 1.0], &[0.0; 3]), FieldError::Count(3, 4));
    for bad in [f64::NAN, f64::INFINITY, -1e10] {
        assert_eq!(error(&[0.0, bad], &[0.0, 1.0], &four), FieldError::Number);
        assert_eq!(error(&[0.0, 1.0], &[0.0, 1.0], &[0.0, 0.0, bad, 0.0]), FieldError::Number);
    }
    let many: Vec<f64> = (0..2000).map(f64::from).collect();
    assert_eq!(error(&many, &many, &[]), FieldError::Large(1999 * 1999));
}

#[test]
fn level_rays_hit_the_risers_of_stairs() {
    let stairs = Stairs {
        from: DVec2::new(1.0, 1.0),
        uphill: StairsDirection::East,
        count: 5,
        rise: 0.1,
        depth: 0.3,
        landing: 0.3,
        width: 1.0,
        goes_down: false,
    };
    let steps =
        Steps { origin: DVec2::ZERO, size: DVec2::new(4.0, 2.0), base: 0.0, stairs: vec![stairs], blocks: vec![] };
    let index = mesh_index(&steps.field().expect("a field"));
    for step in 0..5 {
        let origin = DVec3::new(0.0, 1.2, 0.1 * f64::from(step) + 0.05);
        let hit = index.cast(origin, DVec3::X, 10.0).expect("the ray hits a riser");
        assert!((hit.distance - (1.0 + 0.3 * f64::from(step))).abs() < 1e-12, "{step}: {hit:?}");
    }
}

#[test]
fn cells_cover_the_rectangle() {
    let field = rough(2);
    let bounds = |low: [f64; 2], high: [f64; 2]| Bounds { min: low.into(), max: high.into() };
    let Bounds { min, max } = field.bounds();
    let (columns, rows) = field.size();
    assert_eq!(field.cells(&Bounds { min, max }), [0..columns - 1, 0..rows - 1]);
    let [outside, _] = field.cells(&bounds([-90.0, -90.0], [-80.0, -80.0]));
    assert_eq!(outside, 0..1);
    let [outside, _] = field.cells(&bounds([80.0, 80.0], [90.0, 90.0]));
    assert_eq!(outside, columns - 2..columns - 1);
    let point = DVec2::new(0.5 * (min.x + max.x), 0.5 * (min.y + max.y));
    let [columns, rows] = field.cells(&bounds(point.to_array(), point.to_array()));
    assert!(
        columns
            .clone()
            .all(|column| { field.corner(column, 0).x <= point.x && point.x <= field.corner(column + 1, 0).x })
    );
    assert_eq!((columns.len(), rows.len()), (1, 1));
}
