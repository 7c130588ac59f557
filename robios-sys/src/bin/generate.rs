//! Regenerates `docs/c-library.md` from the list of interposed functions: `cargo run -p robios-sys --bin generate`.

fn main() -> std::io::Result<()> {
    std::fs::write(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/c-library.md"), robios_sys::c::c_library_page())
}
