//! `eyesim accuracy`: speed against error as tables, JSON, plots and in a page.

use tests::Scratch;

#[test]
fn a_study_is_written_in_every_form() {
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
fn what_cannot_be_done_is_said() {
    let scratch = Scratch::new();
    scratch.write("page.md", "nothing here\n");
    scratch.write("file", "");
    let cases: [(&[&str], &str); 4] = [
        (&["accuracy", "drivel"], "there is no study `drivel`, accepted: "),
        (
            &["accuracy", "reflectance", "--quick", "--page", "page.md"],
            "expected a line `<!-- accuracy: reflectance -->`",
        ),
        (&["accuracy", "reflectance", "--quick", "--page", "none.md"], "none.md"),
        (&["accuracy", "reflectance", "--quick", "--plots", "file"], "--plots `file`"),
    ];
    for (args, message) in cases {
        let ran = scratch.eyesim(args);
        assert_eq!(ran.code, Some(2), "{args:?}: {}", ran.stderr);
        assert!(ran.stderr.contains(message), "{args:?}: {}", ran.stderr);
    }
    assert_eq!(scratch.read("page.md"), "nothing here\n");
}
