//! Section 5: the walk from (1, 5) to (9, 1) over unstructured terrain.

use std::fmt::Write as _;

use anyhow::{Context as _, ensure};
use glam::DVec2;
use mapping::astar::shortest_path;
use mapping::distance::distances;
use mapping::grid::{Cell, Grid, GridGeometry};
use mapping::pose::Point;
use sim_core::scene::{Boulders, Disc, HeightField};

use super::ground::Terrain;
use super::picture::{Panel, maps};
use crate::page::{Basis, Claim, Figure, Page, Table, Weight};
use crate::run::{Job, Run, Scene};
use crate::trace::{Event, Trace};
use sim_host::launch::Options;

/// The map's unit, m (our choice: the paper gives none). The robot's feet stand 1.8 m x 1.4 m apart, and the map has
/// ten units.
const UNIT: f64 = 4.0;
/// Start and goal in units.
const START: DVec2 = DVec2::new(1.0, 5.0);
const GOAL: DVec2 = DVec2::new(9.0, 1.0);
/// Side of the terrain in units.
const SIDE: f64 = 10.0;
/// One walk in this many may fail.
const MAY_FAIL: usize = 20;
/// Height above which the ground is an obstacle to A*, m.
const OBSTACLE: f64 = 0.5;
/// Clearance around the centre of the robot that a path needs, m.
const CLEARANCE: f64 = 2.0;
/// Maximum distance of the robot's true position from the goal that counts as arrival, m.
const ARRIVED: f64 = 1.0;
/// Height of the fence around the terrain, m.
const FENCE: f64 = 1.0;
/// Seed of the first terrain if the user's seed is 0.
const FIRST: u64 = 500;
/// Increment of that seed for each increment of the user's seed.
const APART: u64 = 1000;
/// Boulders of the rough terrains.
pub const ROUGH: Boulders = Boulders { count: 40, radius: [0.5, 2.0], height: [0.1, 1.6] };
/// Side of the cells in which A* searches, m.
const CELL: f64 = 0.2;
/// Time limit of a walk, s.
const UNTIL_S: u32 = 600;

/// A terrain with a path of sufficient clearance.
pub struct Route {
    /// Seed of terrain and noise.
    pub seed: u64,
    terrain: Terrain,
    field: HeightField,
    /// The shortest path, m.
    path: Vec<(f64, f64)>,
    /// Length of the shortest path, m.
    pub length: f64,
}

/// Outcome of a walk.
#[derive(Clone, Debug)]
pub struct Walk {
    path: Vec<(f64, f64)>,
    /// Length of the path, m.
    pub length: f64,
    /// Distance from the goal at the end, m.
    left: f64,
    /// Number of contacts of a leg or the body.
    pub touches: usize,
    time: f64,
}

impl Walk {
    /// Returns true if the walk ended near the goal.
    pub fn has_arrived(&self) -> bool {
        self.left <= ARRIVED
    }

    /// Returns true if nothing was touched.
    pub fn is_untouched(&self) -> bool {
        self.touches == 0
    }
}

/// Adds the walks to the page.
///
/// # Errors
/// If a scene does not run to its end.
pub fn add(job: &Job, page: &mut Page, terrains: usize) -> anyhow::Result<()> {
    let (routes, without) = routes(FIRST + APART * job.seed(), terrains, 0.2, ROUGH)?;
    let walks = walk(job, &routes, "alduro", "both", "real")?;
    page.heading("The walk from (1, 5) to (9, 1)");
    page.text(format!(
        "The map's unit is {UNIT} m (our choice, the paper gives none). {terrains} random terrains of {0} m x {0} m; {without} others were left out, on which A* on the \
         true heights found no path that keeps {CLEARANCE} m from the robot's centre to everything above {OBSTACLE} m; a fence stands around each. All errors are \
         those of `real`. The operator on board sees the goal: its bearing to whole degrees and its distance come from the true pose; map and planner know \
         odometry, sonars and what the legs tell, their height above the floor among it. The direction is that of the cheapest way over the local map, \
         on which it is dear to come near to what is high.",
        SIDE * UNIT
    ));
    page.text(
        "The perception vectors of Eq. 4 and 5 are sums of vectors p_k whose directions the equations leave out: ours have the unit vectors from the shank to the points. \
         Eq. 5 takes points at exactly l_max, which have p_k = 0; ours are those within it.",
    );
    page.table(table(&routes, &walks));
    page.figure(figure(&routes, &walks)?);
    let arrived = walks.iter().filter(|walk| walk.has_arrived()).count();
    let both = walks.iter().filter(|walk| walk.has_arrived() && walk.is_untouched()).count();
    page.claims.push(Claim {
        section: "5".to_owned(),
        paper: "the robot reaches the target and avoids what is in its way, on many unstructured terrains".to_owned(),
        ours: format!(
            "reached on {arrived} of {terrains}, within {ARRIVED} m; without a touch of thighs, body or shanks, except their lowest 180 mm, on at least {}",
            terrains - terrains / MAY_FAIL
        ),
        number: format!("{both} of {terrains}"),
        holds: both >= terrains - terrains / MAY_FAIL,
        weight: Weight::Must,
        basis: Basis::Found,
    });
    add_wheels(job, page)
}

/// Adds walks with rear feet on wheels, on a terrain without obstacles that the robot must step over.
fn add_wheels(job: &Job, page: &mut Page) -> anyhow::Result<()> {
    let smooth = Boulders { count: 25, radius: [0.7, 2.0], height: [1.0, 1.6] };
    let (routes, _) = routes(FIRST + APART * job.seed(), 1, 0.1, smooth)?;
    let walks = walk(job, &routes, "alduro-wheels", "both", "real")?;
    let walk = &walks[0];
    page.claims.push(Claim {
        section: "1".to_owned(),
        paper: "on smoother terrain the rear feet may be wheels".to_owned(),
        ours: format!(
            "the same program, wheels behind, relief of 0.1 m between boulders: {}, {} touches",
            if walk.has_arrived() { "arrives" } else { "does not arrive" },
            walk.touches
        ),
        number: format!("{:.1} m, {:.0} s", walk.length, walk.time),
        holds: walk.has_arrived() && walk.is_untouched(),
        weight: Weight::Told,
        basis: Basis::Found,
    });
    Ok(())
}

/// Routes on the first terrains from the seed `first` on that have a path, and the number of terrains without one.
pub fn routes(first: u64, terrains: usize, relief: f64, boulders: Boulders) -> anyhow::Result<(Vec<Route>, usize)> {
    let (mut routes, mut without) = (Vec::new(), 0);
    for seed in first.. {
        ensure!(without < 20 * terrains, "hardly a terrain has a path");
        let clear = [START, GOAL].map(|point| Disc { centre: point * UNIT, radius: 3.0 });
        let terrain = Terrain::new(seed, SIDE * UNIT, relief, boulders, clear.to_vec());
        let field = terrain.field()?;
        match shortest(&field) {
            Some((path, length)) => routes.push(Route { seed, terrain, field, path, length }),
            None => without += 1,
        }
        if routes.len() == terrains {
            break;
        }
    }
    Ok((routes, without))
}

/// The shortest path with clearance and its length, m.
fn shortest(field: &HeightField) -> Option<(Vec<(f64, f64)>, f64)> {
    let count = (SIDE * UNIT / CELL).round() as usize;
    let frame = GridGeometry::new(Point::new(0.0, 0.0), CELL, count, count);
    let heights = Grid::from_fn(frame, |cell| {
        let middle = frame.centre(cell);
        field.height(middle.x, middle.y)
    });
    let room = distances(&heights, |height| *height > OBSTACLE);
    let factor = |cell: Cell| (room[cell] > CLEARANCE).then_some(1.0);
    let cell = |point: DVec2| frame.cell_at(Point::new(point.x * UNIT, point.y * UNIT));
    let path = shortest_path(&frame, factor, cell(START)?, cell(GOAL)?)?;
    let middle = |cell: &Cell| {
        let middle = frame.centre(*cell);
        (middle.x, middle.y)
    };
    Some((path.cells.iter().map(middle).collect(), path.cost))
}

/// Text of a scene in which a robot of type `robi` walks over a terrain. `equations` correct its steps.
fn scene(terrain: &Terrain, robi: &str, equations: &str) -> String {
    let (start, goal) = (START * UNIT, GOAL * UNIT);
    let heading = mapping::math::atan2(goal.y - start.y, goal.x - start.x).to_degrees();
    let mut text = format!("[scene]\nuntil_s = {UNTIL_S}\n\n{}\n", terrain.world());
    text.push_str(&fence());
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "[[robot]]\ntype = \"%sim%/robis/{robi}.robi\"\nprogram = \"%sim%/example-programs/alduro\"\narguments = [\"{}\", \"{}\", \"{equations}\"]\n\
         x_mm = {}\ny_mm = {}\nheading_deg = {heading:.3}\n",
        goal.x,
        goal.y,
        start.x * 1e3,
        start.y * 1e3
    );
    text
}

/// Walls around the terrain, which reflect sound; beyond the terrain there would be no echo.
fn fence() -> String {
    let side = SIDE * UNIT * 1e3;
    let corners = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]];
    let wall = |index: usize| {
        let ([x0, y0], [x1, y1]) = (corners[index], corners[(index + 1) % corners.len()]);
        format!("[[world.wall]]\nfrom_mm = [{x0}, {y0}]\nto_mm = [{x1}, {y1}]\nheight_mm = {}\n\n", FENCE * 1e3)
    };
    (0..corners.len()).map(wall).collect()
}

/// Walks of a robot of type `robi` over terrains, with a noise profile. `equations` (`both`, `eq4`, `eq5` or `none`)
/// correct its steps.
///
/// # Errors
/// If a scene does not run to its end.
pub fn walk(job: &Job, routes: &[Route], robi: &str, equations: &str, noise: &str) -> anyhow::Result<Vec<Walk>> {
    let run = |(index, route): (usize, &Route)| Run {
        name: format!("{robi}-{equations}-{noise}-{index:02}"),
        scene: Scene::Text(scene(&route.terrain, robi, equations)),
        options: Options { seed: Some(route.seed), noise: Some(noise.to_owned()), ..Options::default() },
    };
    let runs: Vec<Run> = routes.iter().enumerate().map(run).collect();
    job.run(&runs, |_, trace| outcome(&trace))
}

fn outcome(trace: &Trace) -> anyhow::Result<Walk> {
    let mut path = vec![(START.x * UNIT, START.y * UNIT)];
    let (mut touches, mut time) = (0, trace.end);
    for entry in trace.of_robot(1) {
        match &entry.event {
            Event::Pose { x_m, y_m, .. } => path.push((*x_m, *y_m)),
            Event::Touch | Event::Contact => touches += 1,
            Event::ProgramEnded => time = entry.at,
            _ => {}
        }
    }
    let last = path.last().copied().context("no poses")?;
    let remaining_distance = DVec2::from(last).distance(GOAL * UNIT);
    let length = path.windows(2).map(|pair| DVec2::from(pair[0]).distance(DVec2::from(pair[1]))).sum();
    Ok(Walk { path, length, left: remaining_distance, touches, time })
}

fn table(routes: &[Route], walks: &[Walk]) -> Table {
    let caption = "Walks from (1, 5) to (9, 1): the robot's path and the shortest that A* finds with the clearance on the true terrain";
    let head = ["terrain", "A*, m", "robot, m", "robot / A*", "time, s", "from the goal, m", "touches"];
    let mut table = Table::new("walks", caption, &head);
    for (route, walk) in routes.iter().zip(walks) {
        table.row([
            route.seed.to_string(),
            format!("{:.1}", route.length),
            format!("{:.1}", walk.length),
            format!("{:.2}", walk.length / route.length),
            format!("{:.0}", walk.time),
            format!("{:.1}{}", walk.left, if walk.has_arrived() { "" } else { " not reached" }),
            walk.touches.to_string(),
        ]);
    }
    table
}

/// Figure 4: the four walks with the longest paths.
fn figure(routes: &[Route], walks: &[Walk]) -> anyhow::Result<Figure> {
    let mut order: Vec<usize> = (0..routes.len()).collect();
    order.sort_by(|a, b| walks[*b].length.total_cmp(&walks[*a].length));
    let panel = |index: usize| {
        let (route, walk) = (&routes[index], &walks[index]);
        Panel {
            title: format!("terrain {}: {:.1} m, A* {:.1} m", route.seed, walk.length, route.length),
            height: Box::new(|x, y| Some(route.field.height(x, y))),
            paths: vec![("#ffffff", route.path.clone()), ("#ff2a2a", walk.path.clone())],
        }
    };
    let panels: Vec<Panel<'_>> = order.into_iter().take(4).map(panel).collect();
    let arrived: Vec<&Walk> = walks.iter().filter(|walk| walk.has_arrived()).collect();
    let ratios =
        routes.iter().zip(walks).filter(|(_, walk)| walk.has_arrived()).map(|(route, walk)| walk.length / route.length);
    let mean = ratios.sum::<f64>() / arrived.len().max(1) as f64;
    Ok(Figure {
        name: "figure-4".to_owned(),
        label: "Figure 4".to_owned(),
        caption: format!(
            "Paths of the robot (red) and of A* (white) from (1, 5) to (9, 1) over the terrains on which the robot went farthest; axes in m, {UNIT} m a unit of the \
             paper's map. A* goes along eight directions and keeps its clearance everywhere, \
             the robot passes nearer where it must: its path may be the shorter one."
        ),
        claim: "The robot finds its way by its local map; mean length against A*, which knows the terrain".to_owned(),
        number: format!("{mean:.2}"),
        picture: maps(SIDE * UNIT, 330, (0.0, 1.8), &panels)?,
    })
}
