//! Checks that the generated files in the repository agree with the lists of functions.

use std::fs;
use std::path::Path;

#[test]
fn generated_files_are_up_to_date() {
    for (name, text) in robios_sys::c::generated_files() {
        let committed = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(name)).unwrap_or_default();
        assert!(committed == text, "{name} is out of date: `cargo run -p robios-sys --bin generate` renews it");
    }
}
