//! Tests that the required claims of Wu et al. on maps hold, on the scenes that come with the simulator.

use papers::page::Weight;
use papers::run::Job;
use papers::wu;

#[test]
fn maps_satisfy_the_claims_that_must_hold() {
    let folder = tempfile::tempdir().expect("a folder");
    let job = Job::new("wu", folder.path(), 1).expect("a job");
    let page = wu::run(&job).expect("all runs");
    let must: Vec<_> = page.claims.iter().filter(|claim| claim.weight == Weight::Must).collect();
    // Right cells, precision and recall in the room, and the robot's own map.
    assert_eq!(must.len(), 4);
    for claim in must {
        assert!(claim.holds, "{}: {}", claim.ours, claim.number);
    }
}

/// The published rows of the first start in each room can be recomputed from the published settings.
#[test]
fn corrected_poses_are_those_of_the_page() {
    let page = papers::run::root().join("docs/papers.md");
    let page = std::fs::read_to_string(page).expect("the page");
    let folder = tempfile::tempdir().expect("a folder");
    let job = Job::new("odometry", folder.path(), 1).expect("a job");
    let rows = wu::odometry::sample(&job, &page).expect("all drives");
    assert_eq!(rows.len(), 3);
    for row in rows {
        assert!(page.contains(&row), "the page lacks\n{row}");
    }
}
