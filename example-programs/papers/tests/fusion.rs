//! A sample of the published errors of maps, computed again.

use papers::alduro;
use papers::run::{Job, root};

#[test]
fn published_errors_are_those_of_the_published_settings() {
    let read = |name: &str| std::fs::read_to_string(root().join("docs/papers").join(name)).expect("a file of the docs");
    let folder = tempfile::tempdir().expect("a folder");
    let job = Job::new("fusion", folder.path(), 1).expect("a job");
    let row = alduro::fusion_sample(&job, &read("fusion-settings.csv")).expect("a survey and its maps");
    assert!(read("fusion.csv").lines().any(|line| line == row), "no such line: {row}");
}
