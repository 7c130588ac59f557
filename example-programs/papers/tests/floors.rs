//! Rows of the published comparison of sensor placements, computed again.

use std::path::Path;

use papers::france::floors;
use papers::run::Job;

#[test]
fn published_settings_give_the_published_errors() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/papers");
    let published = |name: &str| std::fs::read_to_string(docs.join(name)).expect(name);
    let (settings, errors) = (published("floors-settings.csv"), published("floors.csv"));
    let folder = tempfile::tempdir().expect("a folder");
    let job = Job::new("floors", folder.path(), 1).expect("a job");
    let rows = floors::sample(&job, &settings).expect("all walks");
    // Two seeds, three floors each.
    assert_eq!(rows.len(), 6);
    for row in rows {
        assert!(errors.lines().any(|line| line == row), "not in floors.csv: {row}");
    }
}
