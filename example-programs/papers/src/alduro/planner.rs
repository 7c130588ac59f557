//! Section 5: the effect of the planner's equations. The same walks follow the path of A* alone, with the corrections
//! by Eq. 4, by Eq. 5, and by both.

use accuracy::comparison::{Difference, Interval, Verdict};
use eyesim::suite::summary::Rate;

use super::walk::{ROUGH, Route, Walk, routes, walk};
use crate::page::{Basis, Claim, Page, Table, Weight};
use crate::run::Job;

/// First seed of the terrains for the seed 1; another seed moves it up by a multiple of [`APART`].
const FIRST: u64 = 228_000;
const APART: u64 = 100_000;
/// Noise profiles.
const NOISES: [&str; 3] = ["none", "real", "harsh"];
/// Planners: name in tables, argument of the program.
const PLANNERS: [(&str, &str); 4] =
    [("A* alone", "none"), ("A* and Eq. 4", "eq4"), ("A* and Eq. 5", "eq5"), ("A*, Eq. 4 and 5", "both")];
/// Index of A* alone in [`PLANNERS`].
const ALONE: usize = 0;
/// Index of A* with both equations in [`PLANNERS`].
const BOTH: usize = 3;

/// Walks of a planner with a noise profile, terrain by terrain.
struct Walks {
    noise: &'static str,
    planner: usize,
    walks: Vec<Walk>,
}

impl Walks {
    /// For each terrain: 0 if the walk arrived without a contact, otherwise 1.
    fn failures(&self) -> Vec<f64> {
        self.each(|walk| f64::from(u8::from(!(walk.has_arrived() && walk.is_untouched()))))
    }

    fn touches(&self) -> Vec<f64> {
        self.each(|walk| walk.touches as f64)
    }

    fn each(&self, of: impl Fn(&Walk) -> f64) -> Vec<f64> {
        self.walks.iter().map(of).collect()
    }

    fn rate(&self, is: impl Fn(&Walk) -> bool) -> String {
        let rate = Rate::of(self.walks.iter().filter(|walk| is(walk)).count(), self.walks.len());
        format!("{} ({:.0} to {:.0} %)", rate.passed, 100.0 * rate.low, 100.0 * rate.high)
    }

    /// Ratio of each arriving walk's path length to the shortest path.
    fn ratios(&self, routes: &[Route]) -> Vec<f64> {
        let arrived = routes.iter().zip(&self.walks).filter(|(_, walk)| walk.has_arrived());
        arrived.map(|(route, walk)| walk.length / route.length).collect()
    }
}

/// Makes the page, over `terrains` terrains.
///
/// # Errors
/// If a scene does not run to its end.
pub fn page(job: &Job, terrains: usize) -> anyhow::Result<Page> {
    let first = FIRST + job.seed().wrapping_sub(1).wrapping_mul(APART);
    let (routes, without) = routes(first, terrains, 0.2, ROUGH)?;
    let mut all = Vec::new();
    for noise in NOISES {
        for (planner, (_, equations)) in PLANNERS.iter().enumerate() {
            all.push(Walks { noise, planner, walks: walk(job, &routes, "alduro", equations, noise)? });
        }
    }
    let source = "J. A. Morgado de Gois, M. Hiller: Implementation of a Sensor System for Obstacle Avoidance at a Four-Legged Robot";
    let mut page = Page::new("The planner's equations, one by one", source);
    page.text(format!(
        "The walks from (1, 5) to (9, 1) over {terrains} terrains (seeds {} to {}, without {without} on which no path keeps the clearance), on which nothing has been \
         tuned. Intervals of shares are Wilson's, others by the bootstrap, all at 95 %.",
        routes[0].seed,
        routes[routes.len() - 1].seed
    ));
    page.table(outcomes(&all, &routes));
    page.table(differences(&all));
    page.claims = NOISES.iter().map(|noise| claim(&all, noise)).collect();
    Ok(page)
}

fn mean(values: &[f64]) -> String {
    if values.is_empty() {
        return "-".to_owned();
    }
    let Interval { mean, low, high, .. } = Interval::of(values);
    format!("{mean:.2} ({low:.2} to {high:.2})")
}

fn outcomes(all: &[Walks], routes: &[Route]) -> Table {
    let head = ["noise", "planner", "arrived", "arrived untouched", "touches of a walk", "path / A*, of those arrived"];
    let mut table = Table::new("outcomes", "Walks by noise and planner, with 95 % intervals", &head);
    for walks in all {
        table.row([
            walks.noise.to_owned(),
            PLANNERS[walks.planner].0.to_owned(),
            walks.rate(Walk::has_arrived),
            walks.rate(|walk| walk.has_arrived() && walk.is_untouched()),
            mean(&walks.touches()),
            mean(&walks.ratios(routes)),
        ]);
    }
    table
}

fn find<'a>(all: &'a [Walks], noise: &str, planner: usize) -> &'a Walks {
    all.iter().find(|walks| walks.noise == noise && walks.planner == planner).expect("all walks")
}

fn differences(all: &[Walks]) -> Table {
    let caption = "Each planner minus A* alone, terrain by terrain, with 95 % intervals: fraction of walks that fail (do not arrive, or touch), and touches of a walk";
    let mut table = Table::new("equations", caption, &["noise", "planner", "fraction that fails", "touches of a walk"]);
    for walks in all.iter().filter(|walks| walks.planner != ALONE) {
        let alone = find(all, walks.noise, ALONE);
        let of = |of: fn(&Walks) -> Vec<f64>| {
            let Interval { mean, low, high, .. } = Difference::of(&of(walks), &of(alone)).interval;
            format!("{mean:+.2} ({low:+.2} to {high:+.2})")
        };
        let name = PLANNERS[walks.planner].0.to_owned();
        table.row([walks.noise.to_owned(), name, of(Walks::failures), of(Walks::touches)]);
    }
    table
}

/// Claim that both equations are better than A* alone. Its basis is [`Basis::Set`] if A* alone fails so rarely that
/// even a planner that never fails would not be better.
fn claim(all: &[Walks], noise: &str) -> Claim {
    let (alone, both) = (find(all, noise, ALONE).failures(), find(all, noise, BOTH).failures());
    let difference = Difference::of(&both, &alone);
    let verdict = difference.verdict();
    let best = Difference::of(&vec![0.0; alone.len()], &alone);
    let Interval { mean, low, high, .. } = difference.interval;
    Claim {
        section: "5".to_owned(),
        paper: "the robot avoids obstacles by the perception vectors of Eq. 4 and 5".to_owned(),
        ours: format!(
            "noise `{noise}`: fraction of walks that fail, with both equations minus with A* alone, over {} terrains",
            difference.cases
        ),
        number: format!("{mean:+.2} ({low:+.2} to {high:+.2})"),
        holds: verdict == Verdict::First,
        weight: if verdict == Verdict::Open { Weight::Open } else { Weight::Told },
        basis: if best.verdict() == Verdict::First { Basis::Found } else { Basis::Set },
    }
}
