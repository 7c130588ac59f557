//! Extreme numbers as arguments of the functions of both generations: the run continues, and the robot drives to its
//! target.

use std::collections::BTreeSet;

use robios_sys::c::{HEADERS6, HEADERS7, SourceFile};
use tests::{Scratch, root};

/// Runs the fixture on an S4 robot in a plane with a can. Its last line gives the numbers of its calls and failures.
fn run(fixture: &str) {
    let scratch = Scratch::new();
    let program = std::fs::read_to_string(root().join("tests/fixtures").join(fixture)).expect("the fixture");
    scratch.write("plane.wld", "floor 400000 400000\n");
    scratch.write(fixture, &program);
    scratch.write("plane.sim", &format!("world plane.wld\nS4 1000 1000 0 {fixture}\ncan 3000 3000 0\n"));
    let ran = scratch.eyesim(&["run", "plane.sim", "--until", "36000"]);
    let lines: Vec<_> = ran.stdout.lines().collect();
    let is_clean = ran.stdout.lines().any(|line| line.ends_with(" calls, 0 failures"));
    assert!(ran.code == Some(0) && is_clean, "exit {:?}\n{lines:#?}\n{}", ran.code, ran.stderr);
}

#[test]
fn extreme_floats_do_no_harm_in_robios_6() {
    run("extreme-floats.c");
}

#[test]
fn extreme_integers_do_no_harm_in_robios_7() {
    run("extreme-ints.c");
}

/// Names of the functions of a header that take a parameter of one of these types.
fn functions(headers: &[SourceFile], types: &[&str]) -> BTreeSet<String> {
    let text = &headers.iter().find(|header| header.name == "eyebot.h").expect("the header").text;
    let declarations = text.lines().filter(|line| line.contains(");") && !line.starts_with([' ', '*', '/', '#']));
    let takes = |parameters: &str| {
        parameters.split([',', ')']).any(|parameter| {
            let words: Vec<_> = parameter.split_whitespace().collect();
            words.len() == 2 && types.contains(&words[0]) && !words[1].starts_with('*') && !words[1].ends_with(']')
        })
    };
    let named = declarations.filter_map(|line| {
        let (before, parameters) = line.split_once('(')?;
        takes(parameters).then(|| before.rsplit([' ', '*']).next().unwrap_or_default().to_owned())
    });
    named.collect()
}

#[test]
fn the_programs_know_every_function_that_takes_a_number() {
    let left_out = ["KEYWait", "OSError", "RADIOReceive", "AURecord", "SERSend"];
    let floats = ["float", "double", "meter", "meterPerSec", "radians", "radPerSec"];
    for (header, fixture, types, least) in
        [(HEADERS6, "extreme-floats.c", &floats[..], 8), (HEADERS7, "extreme-ints.c", &["int"], 60)]
    {
        let program = std::fs::read_to_string(root().join("tests/fixtures").join(fixture)).expect("the fixture");
        let all = functions(header, types);
        assert!(all.len() >= least, "{all:?}");
        let is_missing = |name: &&String| !program.contains(&format!("{name}(")) && !left_out.contains(&name.as_str());
        let missing: Vec<_> = all.iter().filter(is_missing).collect();
        assert!(missing.is_empty(), "{fixture} does not call {missing:?}");
    }
}
