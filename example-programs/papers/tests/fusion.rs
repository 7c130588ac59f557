//! Tests that a row of the published comparison of maps can be recomputed.

use std::path::Path;

use papers::alduro;
use papers::run::Job;

#[test]
fn published_settings_give_the_published_errors() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/papers");
    let published = |name: &str| std::fs::read_to_string(docs.join(name)).expect(name);
    let (settings, errors) = (published("fusion-settings.csv"), published("fusion.csv"));
    let folder = tempfile::tempdir().expect("a folder");
    let job = Job::new("fusion", folder.path(), 1).expect("a job");
    let row = alduro::fusion_sample(&job, &settings).expect("a row");
    assert!(errors.lines().any(|line| line == row), "not in fusion.csv: {row}");
}
