//! Writes the generated C headers and sources of this crate anew: `cargo run -p robios-sys --bin generate`.

use std::path::Path;

fn main() -> std::io::Result<()> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (path, text) in robios_sys::c::generated() {
        std::fs::write(folder.join(path), text)?;
    }
    Ok(())
}
