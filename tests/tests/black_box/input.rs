//! Standard input of programs (`--stdin`), as existing programs use it, in each language.

use std::io::Write as _;
use std::process::Stdio;

use tests::{Scratch, write_package, write_scene};

/// Programs that read a name, two numbers and the remaining text, and print all of them.
const READERS: [(&str, &str); 7] = [
    (
        "scanf.c",
        "#include <stdio.h>\n#include \"eyebot.h\"\nint main() { char name[20]; int a, b, n = 0; printf(\"Name? \"); scanf(\"%19s\", name);\n\
         scanf(\"%d %d\", &a, &b); while (getchar() != EOF) n++; printf(\"%s %d %d\\n\", name, a + b, n); return 0; }\n",
    ),
    (
        "fgets.c",
        "#include <stdio.h>\n#include \"eyebot.h\"\nint main() { char name[20], line[20]; int a, b, n = 0, c;\n\
         fgets(name, 20, stdin); sscanf(name, \"%19s\", name); fgets(line, 20, stdin); sscanf(line, \"%d %d\", &a, &b);\n\
         n++; while ((c = fgetc(stdin)) != EOF) n++; if (!feof(stdin)) return 1; printf(\"%s %d %d\\n\", name, a + b, n); return 0; }\n",
    ),
    (
        "read.c",
        "#include <stdio.h>\n#include <unistd.h>\n#include \"eyebot.h\"\nint main() { char all[100], name[20]; int a, b, len = 0, n, used;\n\
         while ((n = read(0, all + len, 99 - len)) > 0) len += n; all[len] = 0;\n\
         sscanf(all, \"%19s %d %d%n\", name, &a, &b, &used); printf(\"%s %d %d\\n\", name, a + b, len - used); return 0; }\n",
    ),
    (
        "getline.c",
        "#include <stdio.h>\n#include <stdlib.h>\n#include \"eyebot.h\"\nint main() { char *line = NULL, name[20], rest[50]; size_t room = 0; int a, b, n;\n\
         getline(&line, &room, stdin); sscanf(line, \"%19s\", name); fscanf(stdin, \"%d%d\", &a, &b); n = fread(rest, 1, 50, stdin);\n\
         printf(\"%s %d %d\\n\", name, a + b, n); free(line); return 0; }\n",
    ),
    (
        "cin.cpp",
        "#include <iostream>\n#include <string>\n#include \"eyebot.h\"\nint main() { std::string name; int a, b, n = 0; std::getline(std::cin, name);\n\
         std::cin >> a >> b; while (std::cin.get() != EOF) n++; std::cout << name << ' ' << a + b << ' ' << n << std::endl; }\n",
    ),
    (
        "fast.cpp",
        "#include <iostream>\n#include <string>\n#include \"eyebot.h\"\nint main() { std::ios::sync_with_stdio(false); std::string name, rest; int a, b;\n\
         std::cin >> name >> a >> b; char c; int n = 0; while (std::cin.get(c)) n++; std::cout << name << ' ' << a + b << ' ' << n << '\\n'; }\n",
    ),
    (
        "input.py",
        "import sys\nfrom eye import *\nname = input('Name? ')\na, b = map(int, sys.stdin.readline().split())\nrest = sys.stdin.read()\n\
         print(name, a + b, len(rest) + 1)\n",
    ),
];

#[test]
fn programs_in_each_language_read_the_same_text() {
    let scratch = Scratch::new();
    scratch.write("in.txt", "Ada\n3 4\nrest\n");
    let has_python =
        std::process::Command::new("python3").arg("--version").output().is_ok_and(|out| out.status.success());
    let readers: Vec<_> = READERS.iter().filter(|(name, _)| has_python || !name.ends_with(".py")).collect();
    readers.iter().for_each(|(name, text)| drop(scratch.write(name, text)));
    let names: Vec<&str> = readers.iter().map(|(name, _)| *name).collect();
    write_scene(&scratch, &names);
    for exec in ["thread", "process"] {
        let ran = scratch.eyesim(&[
            "run",
            "scene.sim",
            "--api",
            "7",
            "--stdin",
            "in.txt",
            "--exec",
            exec,
            "--report",
            "r.json",
        ]);
        assert_eq!(ran.code, Some(0), "{ran:#?}");
        // Each robot reads its own copy from the beginning: 3 + 4, and 6 more characters.
        assert_eq!(ran.stdout.matches("] Ada 7 6\n").count(), readers.len(), "{ran:#?}");
        assert!(!ran.stderr.contains("standard input"), "{ran:#?}");
    }
    let report: serde_json::Value = serde_json::from_str(&scratch.read("r.json")).expect("a report");
    let is_input = |input: &serde_json::Value| input["path"].as_str().is_some_and(|path| path.ends_with("in.txt"));
    assert!(report["inputs"].as_array().expect("inputs").iter().any(is_input), "{report:#}");
}

#[test]
fn the_text_may_come_through_a_pipe_and_a_rust_program_reads_it() {
    let scratch = Scratch::new();
    write_package(
        &scratch,
        "reader",
        "use robios_api::prelude::*;\nrobios_api::program!(main);\nfn main(robot: &Robot) {\n    while let Some(line) = robot.read_line() {\n        \
         writeln!(robot.console(), \"<{line}>\");\n    }\n}\n",
    );
    write_scene(&scratch, &["reader"]);
    let mut command = scratch.command(&["run", "scene.sim", "--stdin", "-"]);
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("it starts");
    child.stdin.take().expect("a pipe").write_all(b"one\r\n\ntwo").expect("it is read");
    let out = child.wait_with_output().expect("the process ends");
    let said = String::from_utf8_lossy(&out.stdout);
    let errors = String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "{said}{errors}");
    let lines: Vec<&str> = said.lines().filter_map(|line| Some(line.split_once("] ")?.1)).collect();
    assert_eq!(lines[..3], ["<one>", "<>", "<two>"], "{said}{errors}");
}

#[test]
fn an_empty_input_is_reported_and_loops_at_its_end_are_stopped() {
    let scratch = Scratch::new();
    let run = |text: &str, args: &[&str]| {
        scratch.write("a.c", &format!("#include <stdio.h>\n#include \"eyebot.h\"\nint main() {{ {text} }}\n"));
        write_scene(&scratch, &["a.c"]);
        scratch.eyesim(&[&["run", "scene.sim", "--api", "7"], args].concat())
    };
    let hint = "run with `--stdin in.txt`";
    // A program that waits for the Enter key.
    let ran = run("printf(\"Press Enter\"); getchar(); VWStraight(100, 100); VWWait(); return 0;", &[]);
    assert!(ran.code == Some(0) && ran.stderr.matches(hint).count() == 1, "{ran:#?}");
    assert!(ran.stdout.contains("Press Enter"), "{ran:#?}");
    for text in [
        "while (getchar() != '\\n'); return 0;",
        "int n = 0; while (n <= 0) { printf(\"Number? \"); scanf(\"%d\", &n); } return 0;",
        "char line[9]; do { puts(\"Go?\"); fgets(line, 9, stdin); } while (line[0] != 'y'); return 0;",
    ] {
        let ran = run(text, &[]);
        assert_eq!(ran.code, Some(1), "{text}: {ran:#?}");
        assert!(ran.stderr.contains("reads its standard input in a loop, although the input has ended"), "{ran:#?}");
        assert!(ran.stderr.matches(hint).count() == 1 && ran.stdout.len() < 100_000, "{text}");
    }
    // A program that polls for input between its calls drives on.
    let ran = run("int i; for (i = 0; i < 1500; i++) { if (getchar() == 'q') return 1; OSWait(20); } return 0;", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    scratch.write("in.txt", "12\n");
    let ran =
        run("int a, b = 5; return scanf(\"%d%d\", &a, &b) == 1 && a == 12 && b == 5 ? 0 : 2;", &["--stdin", "in.txt"]);
    assert!(ran.code == Some(0) && !ran.stderr.contains(hint), "{ran:#?}");
    let missing = run("return 0;", &["--stdin", "none.txt"]);
    assert!(
        missing.code == Some(2) && missing.stderr.contains("--stdin") && missing.stderr.contains("none.txt"),
        "{missing:#?}"
    );
}

#[test]
fn a_run_with_input_can_be_repeated() {
    let scratch = Scratch::new();
    scratch.write("a.c", "#include <stdio.h>\n#include \"eyebot.h\"\nint main() { int mm; scanf(\"%d\", &mm); VWStraight(mm, 100); return VWWait(); }\n");
    scratch.write("in.txt", "250\n");
    write_scene(&scratch, &["a.c"]);
    let ran = scratch.eyesim(&["run", "scene.sim", "--stdin", "in.txt", "--trace", "t.jsonl"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    let verified = scratch.eyesim(&["replay", "--verify", "t.jsonl"]);
    assert_eq!(verified.code, Some(0), "{verified:#?}");
}
