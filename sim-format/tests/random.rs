//! Random values and places of scenes.

use std::collections::BTreeMap;

use proptest::prelude::*;
use serde_json::Value;
use sim_format::{
    Code, ConvertOptions, Loaded, MemoryFiles, Overrides, check_scene, content, convert_with, load_scene_with,
};

const WORLD: &str = "[world]\nfloor_mm = [4000, 3000]\n";

fn files(text: &str) -> MemoryFiles {
    [("a.scene.toml", text)].into_iter().collect()
}

fn with_seed(seed: u64) -> Overrides<'static> {
    Overrides { seed: Some(seed), ..Overrides::default() }
}

fn load(text: &str, seed: u64) -> Loaded {
    load_scene_with("a.scene.toml", with_seed(seed), &files(text))
}

/// Drawn values by their paths, of a scene without mistakes.
fn drawn(text: &str, seed: u64) -> BTreeMap<String, Value> {
    let loaded = load(text, seed);
    assert_eq!(loaded.diagnostics, [], "{text}");
    loaded.scene.drawn.into_iter().map(|drawn| (drawn.path, drawn.value)).collect()
}

fn codes(loaded: &Loaded) -> Vec<Code> {
    loaded.diagnostics.iter().map(|diagnostic| diagnostic.code).collect()
}

fn robot(keys: &str) -> String {
    format!("{WORLD}[[robot]]\ntype = \"S4\"\n{keys}\n")
}

#[test]
fn values_lie_in_their_ranges_and_are_spread_over_them() {
    let text = robot(
        "x_mm = { uniform = [500, 503] }\ny_mm = { normal = [1500, 100], min = 1400, max = 1800 }\n\
         heading_deg = { uniform = [0.0, 90.0] }",
    );
    let mut wholes = BTreeMap::new();
    let mut sum = 0.0;
    for seed in 0..400 {
        let values = drawn(&text, seed);
        *wholes.entry(values["robot.1.x_mm"].as_i64().expect("a whole number")).or_insert(0) += 1;
        let y = values["robot.1.y_mm"].as_f64().expect("a number");
        assert!((1400.0..=1800.0).contains(&y), "{y}");
        sum += values["robot.1.heading_deg"].as_f64().expect("a number");
    }
    assert_eq!(wholes.keys().copied().collect::<Vec<_>>(), [500, 501, 502, 503]);
    assert!(wholes.values().all(|count| (60..140).contains(count)), "{wholes:?}");
    // The mean of 400 numbers with a standard deviation of 26.
    assert!((sum / 400.0 - 45.0).abs() < 4.0 * 26.0 / 20.0, "{sum}");
}

#[test]
fn arguments_may_be_numbers_and_are_passed_as_they_are_written() {
    let text = |arguments: &str| {
        robot(&format!("program = \"a.c\"\nx_mm = {{ uniform = [700, 700] }}\ny_mm = 500\narguments = [{arguments}]"))
    };
    let files =
        |text: &str| [("a.scene.toml", text), ("a.c", "int main() { return 0; }")].into_iter().collect::<MemoryFiles>();
    let load = |arguments: &str| load_scene_with("a.scene.toml", with_seed(1), &files(&text(arguments)));
    let loaded = load("\"-v\", 7, -2.50, { same_as = \"robot.1.x_mm\" }, { choice = [\"b\"] }, \"\"");
    assert_eq!(loaded.diagnostics, []);
    assert_eq!(loaded.scene.robots[0].arguments, ["-v", "7", "-2.50", "700", "b", ""]);
    for wrong in ["true", "[1]", "{ a = 1 }", "0x10", "1979-05-27"] {
        let loaded = load(wrong);
        assert!(loaded.has_errors(), "{wrong}");
        assert!(loaded.diagnostics[0].expected.contains("or a number"), "{wrong}: {:?}", loaded.diagnostics);
    }
}

#[test]
fn an_additional_entity_does_not_change_the_others() {
    let robots = "[[robot]]\nname = \"hunter\"\ntype = \"S4\"\nx_mm = { uniform = [500, 3500] }\ny_mm = 500\n\
                  [[robot]]\ntype = \"S4\"\ncount = 3\nlayout = \"random\"\n";
    let cans = "[[object]]\ntype = \"Can\"\ncount = 4\nlayout = \"random\"\nfriction = { uniform = [0.1, 0.9] }\n";
    let before = drawn(&format!("{WORLD}{robots}{cans}"), 3);
    let golf = "[[object]]\ntype = \"Golf\"\nlayout = \"random\"\n[[marker]]\nx_mm = { uniform = [0, 9] }\ny_mm = 5\n";
    let after = drawn(&format!("{WORLD}{robots}{cans}{golf}"), 3);
    assert_eq!(after.len(), before.len() + 4, "{after:?}");
    assert!(before.iter().all(|(path, value)| after[path] == *value), "{before:?}\n{after:?}");
    // A named robot before all others does not change the named ones.
    let first = "[[robot]]\nname = \"prey\"\ntype = \"S4\"\nx_mm = { uniform = [500, 3500] }\ny_mm = 2500\n";
    let other = drawn(&format!("{WORLD}{first}{robots}{cans}"), 3);
    assert_eq!(other["robot.hunter.x_mm"], before["robot.hunter.x_mm"]);
    assert_ne!(other["robot.prey.x_mm"], before["robot.hunter.x_mm"]);
}

#[test]
fn invalid_random_values_are_reported() {
    let of = |value: &str| robot(&format!("x_mm = {value}\ny_mm = 500"));
    let cases = [
        ("the greatest first", of("{ uniform = [2, 1] }"), Code::SceneDraw),
        ("nothing to choose", of("{ choice = [] }"), Code::SceneDraw),
        ("two ways", of("{ choice = [1], uniform = [1, 2] }"), Code::SceneDraw),
        ("one end", of("{ uniform = [1] }"), Code::TomlType),
        ("texts", of("{ uniform = [\"1\", 2] }"), Code::TomlType),
        ("NaN", of("{ uniform = [nan, 2.0] }"), Code::NumberRange),
        ("infinity", of("{ uniform = [0.0, inf] }"), Code::NumberRange),
        ("no table", of("{ choice = 3 }"), Code::TomlType),
        ("an empty table", of("{}"), Code::TomlType),
        ("a negative sigma", of("{ normal = [0, -1] }"), Code::NumberRange),
        ("limits far away", of("{ normal = [0, 1], min = 900, max = 901 }"), Code::SceneDraw),
        ("limits in reverse", of("{ normal = [0, 1], min = 2, max = 1 }"), Code::SceneDraw),
        ("an unknown key", of("{ uniform = [1, 2], step = 1 }"), Code::TomlKey),
        ("a circle", of("{ same_as = \"robot.1.x_mm\" }"), Code::SceneDraw),
        ("nowhere", of("{ same_as = \"robot.2.x_mm\" }"), Code::SceneDraw),
        ("a text for a number", of("{ choice = [\"far\"] }"), Code::TomlType),
        ("out of range", of("{ uniform = [1e20, 2e20] }"), Code::NumberRange),
        ("a seed", format!("[scene]\nseed = {{ uniform = [1, 2] }}\n{}", robot("x_mm = 5\ny_mm = 5")), Code::SceneDraw),
        ("a maze of text", "[world]\nmaze = { random_maze = \"big\" }\n".into(), Code::TomlType),
        ("a huge maze", "[world]\nmaze = { random_maze = [9, 1000] }\n".into(), Code::NumberRange),
        (
            "a huge count",
            format!("{WORLD}[[object]]\ntype = \"Can\"\ncount = 1000000\nlayout = \"random\"\n"),
            Code::NumberRange,
        ),
        (
            "a line of cans",
            format!("{WORLD}[[object]]\ntype = \"Can\"\nlayout = {{ kind = \"starts\" }}\n"),
            Code::TomlChoice,
        ),
        ("no length", format!("{WORLD}[[world.wall]]\nlayout = \"random\"\n"), Code::TomlMissing),
        (
            "a place twice",
            format!("{WORLD}[[object]]\ntype = \"Can\"\nx_mm = 5\nlayout = \"random\"\n"),
            Code::TomlConflict,
        ),
        (
            "a way from nowhere",
            robot("x_mm = 500\ny_mm = 500\n[[reachable]]\nfrom = \"robot.7\"\nto = [5, 5]"),
            Code::SceneReach,
        ),
        (
            "a way without a width",
            robot("x_mm = 500\ny_mm = 500\n[[reachable]]\nfrom = [9, 9]\nto = [5, 5]"),
            Code::TomlMissing,
        ),
    ];
    for (what, text, code) in cases {
        let loaded = load(&text, 0);
        assert!(codes(&loaded).contains(&code), "{what}: {:?}", loaded.diagnostics);
        for diagnostic in &loaded.diagnostics {
            assert!(text.get(diagnostic.span.start..diagnostic.span.end).is_some(), "{what}: {:?}", diagnostic.span);
        }
    }
}

#[test]
fn check_finds_mistakes_that_occur_only_with_other_seeds() {
    let text = robot("x_mm = { uniform = [500, 900] }\ny_mm = { choice = [500, 600, 700, \"far\"] }");
    let checked = check_scene("a.scene.toml", Overrides::default(), &files(&text));
    assert!(codes(&checked).contains(&Code::TomlType), "{:?}", checked.diagnostics);
    let wide =
        format!("{WORLD}[[object]]\ntype = \"Can\"\nx_mm = 5\ny_mm = 5\nfriction = {{ uniform = [0.5, 2e6] }}\n");
    let checked = check_scene("a.scene.toml", Overrides::default(), &files(&wide));
    assert!(codes(&checked).contains(&Code::NumberRange), "{:?}", checked.diagnostics);
    let good = check_scene(
        "a.scene.toml",
        Overrides::default(),
        &files(&robot("x_mm = { uniform = [500, 900] }\ny_mm = 500")),
    );
    assert_eq!(good.diagnostics, []);
}

#[test]
fn ten_thousand_objects_are_placed_at_random() {
    let text = |count: u32| {
        format!(
            "[world]\nfloor_mm = [100000, 100000]\n[[robot]]\ntype = \"S4\"\nx_mm = 500\ny_mm = 500\n\
             [[object]]\ntype = \"Golf\"\ncount = {count}\nlayout = {{ kind = \"random\", clearance_mm = 100 }}\n"
        )
    };
    let loaded = load(&text(10_000), 1);
    assert_eq!(loaded.diagnostics, []);
    assert_eq!(loaded.scene.objects.len(), 10_000);
    let crowded = load(&text(10_000).replace("100000, 100000", "3000, 3000"), 1);
    let room: Vec<_> = crowded.diagnostics.iter().filter(|diagnostic| diagnostic.code == Code::SceneRoom).collect();
    assert_eq!(room.len(), 1, "one message for all: {:?}", crowded.diagnostics.len());
    assert!(room[0].message.ends_with("of 10000 objects") && room[0].span.line > 0, "{}", room[0]);
}

#[test]
fn random_positions_are_redrawn_until_the_goal_is_reachable() {
    let text = "[world]\nfloor_mm = [2000, 1000]\n[[world.wall]]\nfrom_mm = [1000, 0]\nto_mm = { choice = [[1000, 1000], [1000, 500]] }\n\
                [[robot]]\ntype = \"S4\"\nx_mm = 300\ny_mm = 500\n[[object]]\nname = \"goal\"\ntype = \"Can\"\nx_mm = 1700\ny_mm = 500\n\
                [[reachable]]\nfrom = \"robot.1\"\nto = \"object.goal\"\n[[reachable]]\nfrom = \"object.goal\"\nto = \"robot.1\"\nwidth_mm = 180\n";
    for seed in 0..20 {
        assert_eq!(drawn(text, seed)["world.wall.1.to_mm"], serde_json::json!([1000, 500]), "seed {seed}");
    }
    let closed = text.replace("[1000, 500]]", "[1000, 1000]]");
    let loaded = load(&closed, 0);
    assert_eq!(codes(&loaded), [Code::SceneReach; 2], "{:?}", loaded.diagnostics);
    assert!(loaded.diagnostics[0].message.contains("from `robot.1` to `object.goal`"), "{}", loaded.diagnostics[0]);
    // A gap of 190 mm lets the robot of 186 mm pass, one of 180 mm does not.
    for (gap, is_open) in [(300, true), (180, false)] {
        let narrow = format!(
            "[world]\nfloor_mm = [2000, 1000]\nwall = [{{ from_mm = [1000, {gap}], to_mm = [1000, 1000] }}, \
             {{ from_mm = [0, 0], to_mm = [2000, 0] }}]\n[[robot]]\ntype = \"S4\"\nx_mm = 300\ny_mm = 500\n\
             [[reachable]]\nfrom = \"robot.1\"\nto = [1700, 500]\n"
        );
        assert_eq!(codes(&load(&narrow, 0)).is_empty(), is_open, "{gap}");
    }
}

/// A scene in which everything is drawn.
const EVERYTHING: &str = "[scene]\nuntil_s = 5\nnoise = { psd = { sigma_mm = { uniform = [1.0, 9.0] } } }\n\
    [world]\nfloor_mm = [5000, 4000]\ncolour = [{ uniform = [0, 255] }, 100, 100]\nlight = { azimuth_deg = { uniform = [0, 90] } }\n\
    [[world.wall]]\ncount = { uniform = [0, 5] }\nlength_mm = { uniform = [200, 600] }\nlayout = { kind = \"random\", clearance_mm = 60 }\n\
    [[robot]]\nname = \"a\"\ntype = \"S4\"\ncount = { uniform = [1, 4] }\nlayout = { kind = \"random\", clearance_mm = 50 }\n\
    [[robot]]\ntype = \"S4\"\ncount = 2\nx_mm = { uniform = [200.0, 4800.0] }\ny_mm = { uniform = [200.0, 3800.0] }\n\
    [[object]]\nname = \"goal\"\ntype = \"Can\"\ncount = 2\nlayout = \"random\"\n\
    [[object]]\ntype = \"Golf\"\nx_mm = { normal = [2000, 500], min = 0, max = 5000 }\ny_mm = 700\n";

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    #[test]
    fn a_drawn_scene_is_the_same_scene(seed in 0..u64::MAX / 2) {
        let loaded = load(EVERYTHING, seed);
        prop_assume!(loaded.diagnostics.iter().all(|diagnostic| diagnostic.severity != sim_format::Severity::Error));
        let options = ConvertOptions { seed: Some(seed), ..ConvertOptions::default() };
        let converted = convert_with("a.scene.toml", "b.scene.toml", options, &files(EVERYTHING), &|_, _| None);
        let [output] = &converted.outputs[..] else { panic!("one file: {:?}", converted.diagnostics) };
        let plain: MemoryFiles = [("b.scene.toml", output.text())].into_iter().collect();
        let again = load_scene_with("b.scene.toml", Overrides::default(), &plain);
        prop_assert!(again.scene.drawn.is_empty(), "{}", output.text());
        let [mut one, other] = [&loaded, &again].map(|loaded| content::scene(&loaded.scene));
        one.drawn.clear();
        prop_assert_eq!(one, other, "{}", output.text());
    }
}
