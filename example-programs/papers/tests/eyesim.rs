//! Tests that the statements of Koestler and Bräunl on the simulator hold.

use papers::eyesim;
use papers::page::Weight;
use papers::run::Job;

#[test]
fn claims_of_the_paper_about_the_simulator_hold() {
    let folder = tempfile::tempdir().expect("a folder");
    let page = eyesim::run(&Job::new("eyesim", folder.path(), 1).expect("a job")).expect("all runs");
    assert_eq!(page.claims.len(), 17);
    for claim in page.claims {
        // Only the printed third row of the Mecanum matrix is refuted.
        assert_eq!(claim.holds, claim.weight == Weight::Must, "{claim:#?}");
    }
}
