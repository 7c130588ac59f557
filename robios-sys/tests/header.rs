//! The headers compile in every dialect of C and C++.

mod common;

use common::{compile, folder, folder_with, has_compiler};
use robios_sys::{c, reference};

#[test]
fn c_library_page_is_up_to_date() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/c-library.md");
    let committed = std::fs::read_to_string(page).expect("the page");
    assert!(committed == c::c_library_page(), "{page} is stale: cargo run -p robios-sys --bin generate");
}

#[test]
fn reference_pages_are_up_to_date() {
    let docs = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs"));
    let pages =
        reference::pages(|name| std::fs::read_to_string(docs.join("examples").join(name))).expect("the examples");
    for (name, text) in pages {
        let committed = std::fs::read_to_string(docs.join(name)).expect("a page");
        assert!(committed == text, "docs/{name} is stale: cargo run -p robios-sys --bin generate");
    }
}

#[test]
fn each_header_compiles_alone_and_twice_in_every_dialect() {
    if !has_compiler() {
        return;
    }
    // The RoBIOS-7 headers have always required types of C99. With `-pedantic` their variadic macros require C++11.
    let dialects6 = ["gnu89", "c99", "gnu17", "c++98", "c++17"];
    let dialects7 = ["gnu99", "c99", "gnu17", "c++11", "c++17", "c++20"];
    for (headers, dialects) in [(c::HEADERS6, &dialects6[..]), (c::HEADERS7, &dialects7)] {
        let folder = folder_with(headers);
        for header in headers {
            let text = format!("#include \"{0}\"\n#include \"{0}\"\nextern int unused;\n", header.name);
            std::fs::write(folder.path().join("each.c"), text).expect("the temporary folder is writable");
            for dialect in dialects {
                let language = if dialect.starts_with("c++") { "c++" } else { "c" };
                let standard = format!("-std={dialect}");
                let flags =
                    ["-Wall", "-Wextra", "-pedantic", "-Werror", "-I.", "-x", language, "-fsyntax-only", "each.c"];
                compile(folder.path(), &[&[standard.as_str()], &flags[..]].concat());
            }
        }
    }
}

#[test]
fn c_and_cpp_files_of_one_program_link() {
    if !has_compiler() {
        return;
    }
    let folder = folder();
    // These headers serve sources that include no other header with their declarations.
    let headers = c::HEADERS6.iter().filter(|header| ![c::TRUTH_HEADER, c::OLD_NAMES_HEADER].contains(&header.name));
    let include_all: String = headers.map(|header| format!("#include \"{}\"\n", header.name)).collect();
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), include_all.clone() + text).expect("the temporary folder is writable");
    };
    write("one.c", "int one(void);\nint main(void) { return LCDClear() + one(); }\n");
    write("two.c", "int one(void) { return VWDriveStraight(1, 0.5f, 0.2f) + RADIOCheck(); }\n");
    write("three.cpp", "extern \"C\" int three() { return LCDPrintf(\"%d\", KEYGet()) + RADIOCheck(); }\n");
    let strict = ["-Wall", "-Wextra", "-pedantic", "-Werror", "-fPIC", "-I.", "-c"];
    compile(folder.path(), &[&["-std=gnu89"], &strict[..], &["one.c", "two.c"]].concat());
    compile(folder.path(), &[&["-std=c++17"], &strict[..], &["three.cpp"]].concat());
    compile(folder.path(), &[c::SHIM_FLAGS, &["-I.", "-c", c::SHIM_SOURCE]].concat());
    let objects = ["one.o", "two.o", "three.o", "shim.o", "-o", "all.so"];
    compile(folder.path(), &[c::LINK_FLAGS, &objects, c::LIBRARIES].concat());
}

#[test]
fn the_shim_compiles_without_warnings() {
    if !has_compiler() {
        return;
    }
    for flags in [&[][..], &["-O0"], &["-O2"], &["-O3"]] {
        let strict = ["-Wall", "-Wextra", "-Werror", "-I.", "-c", c::SHIM_SOURCE];
        for headers in [c::HEADERS6, c::HEADERS7] {
            compile(folder_with(headers).path(), &[c::SHIM_FLAGS, flags, &strict].concat());
        }
    }
}
