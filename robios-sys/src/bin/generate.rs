//! Regenerates the files that follow from the lists: headers and parts of the shim, `docs/c-library.md`, and the
//! references of both generations: `cargo run -p robios-sys --bin generate`.

use std::fs;
use std::path::Path;

fn main() -> std::io::Result<()> {
    let crate_folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (name, text) in robios_sys::c::generated_files() {
        fs::write(crate_folder.join(name), text)?;
    }
    let docs = crate_folder.join("../docs");
    fs::write(docs.join("c-library.md"), robios_sys::c::c_library_page())?;
    for (name, text) in robios_sys::reference::pages(|name| fs::read_to_string(docs.join("examples").join(name)))? {
        fs::write(docs.join(name), text)?;
    }
    Ok(())
}
