//! Tests that the required claims of Gois and Hiller on walks hold, on a few of the page's terrains.

use papers::alduro;
use papers::page::Weight;
use papers::run::Job;

#[test]
fn the_robot_arrives_without_contact() {
    let folder = tempfile::tempdir().expect("a folder");
    let job = Job::new("alduro", folder.path(), 1).expect("a job");
    let page = alduro::run(&job, Some(2)).expect("all runs");
    let must: Vec<_> = page.claims.iter().filter(|claim| claim.weight == Weight::Must).collect();
    assert_eq!(must.len(), 1);
    for claim in must {
        assert!(claim.holds, "{}: {}", claim.ours, claim.number);
    }
}
