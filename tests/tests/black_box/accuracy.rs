//! `eyesim accuracy`: tables, JSON, plots and a page of time against error.

use tests::{Scratch, root};

#[test]
fn a_study_writes_rows_plots_and_page() {
    let scratch = Scratch::new();
    scratch.write("page.md", "before\n<!-- accuracy: reflectance -->\nold\n<!-- end -->\nafter\n");
    let forms = ["--json", "rows.json", "--plots", "plots/new", "--page", "page.md"];
    let ran = scratch.eyesim(&[&["accuracy", "reflectance", "--quick"][..], &forms].concat());
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    assert!(ran.stdout.contains("stable root") && ran.stdout.contains("a reading"), "{}", ran.stdout);

    let rows: serde_json::Value = serde_json::from_str(&scratch.read("rows.json")).expect("JSON");
    let rows = rows.as_array().expect("an array of rows");
    assert!(rows.len() > 10);
    for row in rows {
        let text = |key: &str| row[key].as_str().unwrap_or_else(|| panic!("`{key}` in {row}")).to_owned();
        assert_eq!((&*text("study"), &*text("unit"), &*text("per")), ("reflectance", "m", "reading"));
        assert!(!text("method").is_empty() && !text("setting").is_empty());
        assert!(row["error"].as_f64().is_some_and(|error| error >= 0.0), "{row}");
        assert!(row["time_ns"].as_f64().is_some_and(|time| time > 0.0), "{row}");
    }

    let page = scratch.read("page.md");
    assert!(page.starts_with("before\n<!-- accuracy: reflectance -->\n| method |"), "{page}");
    assert!(page.ends_with("|\n<!-- end -->\nafter\n") && !page.contains("old"), "{page}");
    let svg = scratch.read("plots/new/reflectance.svg");
    assert!(svg.starts_with("<svg") && svg.contains("printed root") && svg.contains("error, m"));
}

#[test]
fn rows_on_standard_output_are_only_json() {
    let ran = Scratch::new().eyesim(&["accuracy", "range-sensors", "reflectance", "--quick", "--json", "-"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let rows: serde_json::Value = serde_json::from_str(&ran.stdout).expect("JSON and nothing else");
    let studies: Vec<&str> = rows.as_array().expect("rows").iter().filter_map(|row| row["study"].as_str()).collect();
    assert!(studies.is_sorted() && studies.contains(&"range-sensors") && studies.contains(&"reflectance"));
    assert!(ran.stderr.contains("stable root"), "the tables: {}", ran.stderr);
}

#[test]
fn the_page_of_the_docs_has_a_place_for_every_study_and_every_picture_is_there() {
    let scratch = Scratch::new();
    let page = std::fs::read_to_string(root().join("docs/accuracy.md")).expect("the page");
    // An unknown name lists all valid names.
    let refused = scratch.eyesim(&["accuracy", "?"]);
    let (_, names) = refused.stderr.trim().split_once("accepted: ").expect("the names");
    for study in names.split(", ") {
        assert!(page.contains(&format!("<!-- accuracy: {study} -->\n| method |")), "no table of `{study}`");
        assert!(page.contains(&format!("\n## {study}\n")), "no section on `{study}`");
    }
    let pictures: Vec<&str> = page.split("](").skip(1).filter_map(|rest| rest.split(')').next()).collect();
    let pictures: Vec<_> = pictures.into_iter().filter(|link| link.ends_with(".svg")).collect();
    assert!(pictures.len() > 5);
    for picture in pictures {
        assert!(root().join("docs").join(picture).is_file(), "there is no `{picture}`");
    }
}

#[test]
fn the_curves_on_the_radio_page_are_those_of_the_studies() {
    let scratch = Scratch::new();
    let ran = scratch.eyesim(&["accuracy", "radio", "radio-latency", "--quick", "--plots", "accuracy"]);
    assert_eq!(ran.code, Some(0), "{}", ran.stderr);
    let docs = root().join("docs");
    let page = std::fs::read_to_string(docs.join("radio.md")).expect("the page");
    let pictures: Vec<&str> = page.split("](").skip(1).filter_map(|rest| rest.split(')').next()).collect();
    let pictures: Vec<_> = pictures.into_iter().filter(|link| link.ends_with(".svg")).collect();
    assert_eq!(pictures.len(), 6);
    let (_, rest) = page.split_once("cargo run --release -- ").expect("the command");
    for picture in pictures {
        let committed = std::fs::read_to_string(docs.join(picture)).unwrap_or_else(|_| panic!("no `{picture}`"));
        let advice = rest.lines().next().unwrap_or_default();
        assert!(scratch.read(picture) == committed, "`{picture}`: draw it again: cargo run --release -- {advice}");
    }
}

#[test]
fn the_sweep_in_the_page_is_what_a_program_prints() {
    let page = std::fs::read_to_string(root().join("docs/accuracy.md")).expect("the page");
    let (_, rest) = page.split_once("\n```text\n").expect("the sweep");
    let (sweep, _) = rest.split_once("```").expect("its end");
    assert_eq!(sweep.lines().count(), 23);
    let scene = root().join("sims/step.scene.toml");
    let ran = Scratch::new().eyesim(&["run", scene.to_str().expect("a path")]);
    let printed: Vec<&str> = ran.stdout.lines().filter_map(|line| Some(line.split_once(" s] ")?.1)).collect();
    assert_eq!(printed, sweep.lines().collect::<Vec<_>>(), "{}", ran.stderr);
}

#[test]
fn invalid_requests_are_reported() {
    let scratch = Scratch::new();
    scratch.write("page.md", "nothing here\n");
    scratch.write("file", "");
    let cases: [(&[&str], &str); 6] = [
        (&["accuracy", "drivel"], "there is no study `drivel`, accepted: "),
        (
            &["accuracy", "reflectance", "--quick", "--page", "page.md"],
            "expected a line `<!-- accuracy: reflectance -->`",
        ),
        (&["accuracy", "reflectance", "--quick", "--page", "none.md"], "none.md"),
        (&["accuracy", "reflectance", "--quick", "--plots", "file"], "--plots `file`"),
        (&["accuracy", "reflectance", "--quick", "--plots", "/proc/plots"], "--plots `/proc/plots`"),
        (&["accuracy", "reflectance", "--quick", "--json", "none/rows.json"], "there is no folder `none`"),
    ];
    for (args, message) in cases {
        let ran = scratch.eyesim(args);
        assert_eq!(ran.code, Some(2), "{args:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(message), "{args:?}: {}", ran.stderr);
        assert!(!ran.stderr.contains("measured in"), "{args:?} is refused before anything is measured: {}", ran.stderr);
    }
    assert_eq!(scratch.read("page.md"), "nothing here\n");
}
