//! Claims of Gois and Hiller on maps and walks that must hold, on a few of the terrains of the page.

use papers::alduro;
use papers::page::Weight;
use papers::run::Job;

#[test]
fn surfaces_are_better_than_the_grid_and_the_robot_arrives_untouched() {
    let folder = tempfile::tempdir().expect("a folder");
    let job = Job::new("alduro", folder.path(), 1).expect("a job");
    let page = alduro::run_over(&job, 2, 2).expect("all runs");
    let must: Vec<_> = page.claims.iter().filter(|claim| claim.weight == Weight::Must).collect();
    assert_eq!(must.len(), 2);
    for claim in must {
        assert!(claim.holds, "{}: {}", claim.ours, claim.number);
    }
}
