//! The examples in the references print the output in their comments, in C and in Python.

use std::collections::BTreeMap;
use std::fs;

use tests::{Scratch, root};

/// Runs `docs/examples/SCENE` and compares the output of each program with the comment at the end of its source.
fn check(scene: &str) {
    let folder = root().join("docs/examples");
    let text = fs::read_to_string(folder.join(scene)).expect("a scene");
    let programs: Vec<&str> = text.split_whitespace().filter(|word| word.starts_with("robios")).collect();
    assert!(programs.len() > 20, "{programs:?}");
    let scratch = Scratch::new();
    let keys = "1:KEY2, 1.5:TOUCH(120,40), 1.5:IRTV_OK";
    let mut command = scratch.command(&["run", "--keys", keys]);
    let output = command.arg(folder.join(scene)).output().expect("eyesim starts");
    let stdout = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{stdout}{}", String::from_utf8_lossy(&output.stderr));
    let mut printed: BTreeMap<&str, Vec<&str>> = programs.iter().map(|program| (*program, Vec::new())).collect();
    for line in stdout.lines().filter_map(|line| line.strip_prefix("[r")) {
        let (head, line) = line.split_once(" s] ").expect("`[r1 0.000 s] text`");
        let robot: usize = head.split(' ').next().and_then(|number| number.parse().ok()).expect("a robot's number");
        if !line.starts_with("hint: ") {
            printed.get_mut(programs[robot - 1]).expect("its program").push(line);
        }
    }
    for (program, lines) in printed {
        let source = fs::read_to_string(folder.join(program)).expect("a program");
        let (_, comment) = source.split_once(" Prints\n").unwrap_or_else(|| panic!("{program} says what it prints"));
        let expected: Vec<&str> =
            comment.lines().filter_map(|line| line.strip_prefix(" * ").or(line.strip_prefix("# "))).collect();
        assert_eq!(lines, expected, "{program}");
    }
}

#[test]
fn the_examples_of_robios_6_print_the_documented_output() {
    check("robios6.sim");
}

#[test]
fn the_examples_of_robios_7_print_the_documented_output() {
    check("robios7.sim");
}

#[test]
fn the_examples_of_robios_7_in_python_print_the_output_of_those_in_c() {
    check("robios7-python.sim");
    for example in fs::read_dir(root().join("docs/examples/robios7")).expect("the examples") {
        let path = example.expect("an example").path();
        if path.extension().is_some_and(|extension| extension == "py") {
            let prints = |path| {
                let source = fs::read_to_string(path).expect("an example");
                let (_, comment) = source.split_once(" Prints\n").expect("what it prints");
                comment.replace("# ", "").replace(" * ", "").replace(" */\n", "")
            };
            assert_eq!(prints(path.clone()), prints(path.with_extension("c")), "{}", path.display());
        }
    }
}
