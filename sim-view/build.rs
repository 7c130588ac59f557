//! Embeds the page in release builds. `EYESIM_PAGE=skip` leaves it out.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

#[path = "src/page/build.rs"]
mod page;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=src/page/build.rs");
    println!("cargo::rerun-if-env-changed=EYESIM_PAGE");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo says where to write"));
    fs::write(out.join("embedded.rs"), embedded(&out)).expect("the page is written beside the crate's output");
}

/// The page's files as a Rust expression; an empty slice if the page is omitted.
fn embedded(out: &Path) -> String {
    let is_release = env::var("PROFILE").is_ok_and(|profile| profile == "release");
    if !is_release || env::var("EYESIM_PAGE").is_ok_and(|page| page == "skip") {
        return "&[]".into();
    }
    let folder = Path::new(&env::var_os("CARGO_MANIFEST_DIR").expect("cargo says where the crate is")).join("page");
    for source in page::SOURCES {
        println!("cargo::rerun-if-changed={}", folder.join(source).display());
    }
    let files = page::built(&folder, &mut warn).unwrap_or_else(|why| {
        warn(&why);
        warn("eyesim is built without its page");
        Vec::new()
    });
    let mut list = String::from("&[");
    for (number, (name, content)) in files.iter().enumerate() {
        let copy = out.join(format!("page-{number}"));
        fs::write(&copy, content).expect("the page is written beside the crate's output");
        list.push_str(&format!("({name:?}, include_bytes!({copy:?})),"));
    }
    list + "]"
}

fn warn(text: &str) {
    for line in text.lines() {
        println!("cargo::warning={line}");
    }
}
