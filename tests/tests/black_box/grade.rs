//! Grading: a class of submissions in every file format, equal verdicts in any order, and the files for lecturers,
//! students and services.

#[path = "grade/class.rs"]
mod class;

use std::collections::BTreeMap;
use std::os::unix::fs::PermissionsExt as _;
use std::os::unix::process::CommandExt as _;
use std::path::Path;
use std::process::Command;

use class::{Case, class, honest, program, zip_of};
use serde_json::Value;
use tests::stranger::{chown_all, listing, processes_in, users};
use tests::{Ran, Scratch, copy_eyesim, eyesim_path};

/// Environment variable that has all submissions graded in three orders and each by itself. If the user is root, an
/// ordinary user grades them as well.
const ALL: &str = "EYESIM_GRADE";

/// Creates a folder `lab/` with a suite whose task is to drive 900 mm ahead without a contact.
fn lab() -> Scratch {
    let scratch = Scratch::new();
    scratch.write(
        "lab/lab.scene.toml",
        "[world]\nfloor_mm = [2000, 1000]\nwall = [{ from_mm = [0, 0], to_mm = [2000, 0] }]\n\n[[robot]]\ntype = \"S4\"\n\
         x_mm = 500\ny_mm = 500\n",
    );
    scratch.write(
        "lab/lab.suite.toml",
        "[suite]\nscene = \"lab.scene.toml\"\nsubmit = { 1 = [\"*.c\", \"*.cpp\", \"*.so\"] }\nuntil_s = 20\nforbid = [\"SIM*\"]\n\n[matrix]\n\
         noise = \"mild\"\nseed = 1\n\n[limits]\nslot_processor_s = 0.4\noutput_mb = 0.1\n\n\
         [[check]]\nname = \"goal\"\nkind = \"reach\"\nat_mm = [1400, 500]\nwithin_mm = 60\npoints = 3\n\n\
         [[check]]\nname = \"no contact\"\nkind = \"contacts\"\nmax = 0\n",
    );
    scratch
}

/// Runs `eyesim grade` on the lab, which must succeed.
fn grade(scratch: &Scratch, args: &[&str]) -> Ran {
    let ran = scratch.eyesim(&[&["grade", "lab/lab.suite.toml"], args].concat());
    assert_eq!(ran.code, Some(0), "{args:?}: {ran:#?}");
    ran
}

/// Rows of a CSV table by their first field; quotes around fields are removed.
fn table(text: &str) -> BTreeMap<String, Vec<String>> {
    let mut rows: Vec<Vec<String>> = vec![vec![String::new()]];
    let mut is_quoted = false;
    let mut characters = text.chars().peekable();
    while let Some(c) = characters.next() {
        let row = rows.last_mut().expect("a row");
        match c {
            '"' if is_quoted && characters.peek() == Some(&'"') => {
                row.last_mut().expect("a field").push(characters.next().expect("a quote"))
            }
            '"' => is_quoted = !is_quoted,
            ',' if !is_quoted => row.push(String::new()),
            '\r' if !is_quoted => {}
            '\n' if !is_quoted => rows.push(vec![String::new()]),
            c => row.last_mut().expect("a field").push(c),
        }
    }
    rows.into_iter().filter(|row| row.len() > 1).skip(1).map(|row| (row[0].clone(), row)).collect()
}

/// The results of a submission: its JSON without times and without the prefixes of file names.
fn result(folder: &Path, prefix: &str) -> Value {
    let text = std::fs::read_to_string(folder.join("results.json")).expect("results").replace(prefix, "");
    let mut value: Value = serde_json::from_str(&text).expect("JSON");
    value["execution_time"] = Value::Null;
    value
}

/// Checks that a document has the fields that Gradescope documents.
fn validate(results: &Value) {
    let fields = results.as_object().expect("an object");
    let keys = [
        "score",
        "execution_time",
        "output",
        "output_format",
        "test_output_format",
        "test_name_format",
        "visibility",
        "stdout_visibility",
        "extra_data",
        "tests",
    ];
    assert!(fields.keys().all(|key| keys.contains(&key.as_str())), "{results:#}");
    let visibilities = ["visible", "hidden", "after_due_date", "after_published"];
    let is_visibility = |value: &Value| visibilities.contains(&value.as_str().expect("a visibility"));
    assert!(results["score"].is_f64() && results["output"].is_string(), "{results:#}");
    assert!(is_visibility(&results["visibility"]) && is_visibility(&results["stdout_visibility"]));
    let tests = results["tests"].as_array().expect("tests");
    assert!(!tests.is_empty());
    for test in tests {
        let keys = ["name", "score", "max_score", "status", "output", "visibility"];
        assert!(test.as_object().expect("an object").keys().all(|key| keys.contains(&key.as_str())), "{test:#}");
        let [score, max_score] = ["score", "max_score"].map(|key| test[key].as_f64().expect("a number"));
        assert!((0.0..=max_score).contains(&score), "{test:#}");
        assert!(["passed", "failed"].contains(&test["status"].as_str().expect("a status")));
        assert!(test["name"].is_string() && test["output"].is_string() && is_visibility(&test["visibility"]));
    }
    let sum: f64 = tests.iter().map(|test| test["score"].as_f64().expect("a number")).sum();
    assert!((sum - results["score"].as_f64().expect("a number")).abs() < 1e-3, "{results:#}");
}

fn write_class(scratch: &Scratch, folder: &str, cases: &[&Case], order: &dyn Fn(usize) -> usize) {
    let folder = scratch.path().join(folder);
    std::fs::create_dir_all(&folder).expect("a folder");
    for (index, case) in cases.iter().enumerate() {
        case.write(&folder, &format!("{:03} ", order(index)));
    }
}

/// The complete results for each submission, by the name of its case: its line of grades without names, and its JSON.
fn verdicts(scratch: &Scratch, output: &str) -> BTreeMap<String, (Vec<String>, Value)> {
    let grades = table(&scratch.read(&format!("{output}/grades.csv")));
    let of_row = |row: Vec<String>| {
        let (prefix, name) = row[0].trim_start_matches('\'').split_at(4);
        let results = result(&scratch.path().join(output).join("students").join(&row[1]), prefix);
        let row = row[2..].iter().map(|field| field.replace(prefix, "")).collect();
        (name.to_owned(), (row, results))
    };
    grades.into_values().map(of_row).collect()
}

/// Folders for grading a class: the lab, a user's home, a cache and a temporary folder, all owned by one user.
struct GradingFolders {
    scratch: Scratch,
    user: Option<u32>,
}

impl GradingFolders {
    fn new(user: Option<u32>) -> Self {
        let scratch = lab();
        std::fs::set_permissions(scratch.path(), std::fs::Permissions::from_mode(0o755)).expect("a mode");
        scratch.write("lab/hidden.h", "#error \"the seeds of the examination\"\n");
        scratch.write("home/diary.txt", "dear diary");
        for folder in ["home/photos", "cache", "tmp"] {
            std::fs::create_dir_all(scratch.path().join(folder)).expect("a folder");
        }
        copy_eyesim(&scratch.path().join("eyesim"));
        Self { scratch, user }
    }

    /// Runs `eyesim grade` as the user, which must succeed. Limits protect the machine from holes in the sandbox.
    fn grade(&self, args: &[&str]) -> Ran {
        let path = self.scratch.path();
        let script = "ulimit -c 0; ulimit -t 3000; ulimit -f 2000000; exec timeout -k 5 3000 \"$@\"";
        let mut command = Command::new("sh");
        command.args(["-c", script, "sh"]).arg(path.join("eyesim")).args(["grade", "lab/lab.suite.toml"]).args(args);
        command.current_dir(path).env("HOME", path.join("home")).env("EYESIM_CACHE", path.join("cache"));
        command.env("TMPDIR", path.join("tmp")).env("EYESIM_SECRET", "the seeds").env("LD_PRELOAD", "");
        if let Some(user) = self.user {
            chown_all(path, user);
            command.uid(user).gid(user);
        }
        let listings = || ["home", "lab", "in"].map(|folder| listing(&path.join(folder)));
        let before = listings();
        let ran = Ran::from(command.output().expect("a shell"));
        assert_eq!(ran.code, Some(0), "{args:?}: {ran:#?}");
        assert_eq!(listings(), before, "nothing outside of the scratch folders is touched");
        let remaining: Vec<_> = std::fs::read_dir(path.join("tmp")).expect("a folder").collect();
        assert!(remaining.is_empty(), "{remaining:?}");
        assert_eq!(processes_in(path), Vec::<String>::new(), "nothing is left running");
        ran
    }
}

#[test]
fn a_class_has_a_row_for_every_student_for_any_submission() {
    if tests::lacks_sandbox() {
        return;
    }
    let is_all = std::env::var_os(ALL).is_some();
    for user in users().into_iter().take(if is_all { 2 } else { 1 }) {
        grade_class(&GradingFolders::new(user), is_all);
    }
}

/// Grades the class twice, then in other orders, on one worker and two, and then single submissions: all of them if
/// `is_all`, otherwise some.
fn grade_class(folders: &GradingFolders, is_all: bool) {
    let scratch = &folders.scratch;
    let cases = class(&scratch.path().canonicalize().expect("a path"));
    let all: Vec<&Case> = cases.iter().collect();
    assert!(all.len() >= 100, "{}", all.len());
    write_class(scratch, "in", &all, &|index| index);
    let ran = folders.grade(&["--submissions", "in", "-o", "out", "-j", "2"]);
    assert!(ran.stdout.contains(&format!("{} submissions: ", all.len())), "{}", ran.stdout);
    assert!(!ran.stdout.contains('\u{1b}') && !ran.stderr.contains('\u{1b}'), "{ran:#?}");
    let found = verdicts(scratch, "out");
    let mut wrong = Vec::new();
    for case in &cases {
        let name: String = case.name.chars().flat_map(char::escape_default).collect();
        let known = found.iter().find(|(other, _)| {
            **other == case.name
                || other.chars().flat_map(char::escape_default).collect::<String>().replace("\\\\", "\\") == name
        });
        let Some((_, (row, results))) = known else { panic!("{} is missing in {:?}", case.name, found.keys()) };
        validate(results);
        let (verdict, message) = case.expected;
        if row[2] != verdict || !row[5].contains(message) || (verdict == "passed") != (row[0] == "4") {
            wrong.push(format!("{}: {:?}, expected {verdict}: {message}", case.name, &row[..6]));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert_eq!(found.len(), cases.len());
    pages_are_harmless(&scratch.path().join("out"));
    // The second grading neither builds nor runs anything.
    let again = folders.grade(&["--submissions", "in", "-o", "out"]);
    assert!(again.stdout.starts_with(&format!("{0} of {0} submissions are unchanged", all.len())), "{}", again.stdout);
    assert_eq!(verdicts(scratch, "out"), found);
    let some: Vec<&Case> = cases.iter().step_by(if is_all { 1 } else { 7 }).collect();
    let count = some.len();
    let orders: [(&str, &dyn Fn(usize) -> usize); 2] =
        [("1", &|index| count - 1 - index), ("2", &|index| index * 37 % count.next_multiple_of(37).max(1) + index)];
    for (jobs, order) in &orders[..if is_all { 2 } else { 1 }] {
        let (folder, output) = (format!("in{jobs}"), format!("out{jobs}"));
        write_class(scratch, &folder, &some, order);
        folders.grade(&["--submissions", &folder, "-o", &output, "-j", jobs]);
        for (name, verdict) in verdicts(scratch, &output) {
            // If a submission exceeds two limits, either may be reported.
            if cases.iter().any(|case| case.name == name && case.expected == ("failed", "")) {
                assert_eq!(found.get(&name).map(|(row, _)| &row[..5]), Some(&verdict.0[..5]), "{name}");
                continue;
            }
            assert_eq!(found.get(&name), Some(&verdict), "{name}");
        }
        println!("{count} submissions as {:?} on {jobs} workers: the same rows", folders.user);
    }
    let entries = std::fs::read_dir(scratch.path().join("in")).expect("a folder").flatten();
    let names: Vec<_> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    for index in (0..cases.len()).step_by(if is_all { 1 } else { 17 }) {
        let Some(name) = names.iter().find(|name| name.starts_with(&format!("{index:03} "))) else { panic!("{index}") };
        folders.grade(&["--single", "--submissions", &format!("in/{name}"), "--results", "alone/results.json"]);
        let alone = result(&scratch.path().join("alone"), &format!("{index:03} "));
        let known = found.values().filter(|(_, results)| *results == alone).count();
        assert!(known > 0, "{name}: {alone:#}");
    }
}

/// No page contains an HTML tag or an escape sequence from a student.
fn pages_are_harmless(output: &Path) {
    let mut pages = vec![output.join("index.html")];
    for entry in std::fs::read_dir(output.join("students")).expect("students").flatten() {
        pages.push(entry.path().join("index.html"));
    }
    for page in pages {
        let text = std::fs::read_to_string(&page).expect("a page");
        assert!(!text.contains("the seeds") && !text.contains("root:x:0"), "{}", page.display());
        assert!(
            !text.contains("<script") && !text.contains("<b>bold") && !text.contains('\u{1b}'),
            "{}",
            page.display()
        );
        assert!(text.ends_with("</html>\n"), "{}", page.display());
    }
}

#[test]
fn submissions_in_one_archive_are_graded_and_hidden_seeds_stay_hidden() {
    if tests::lacks_sandbox() {
        return;
    }
    let scratch = lab();
    scratch.write("seeds.txt", "# secret\n770011, 880022\n");
    let bad = program("VWStraight(300, 200); VWWait();");
    let entries: [(&str, &[u8]); 5] = [
        ("Lab 1/Ana María_101_assignsubmission_file_/solve.c", &honest(200)),
        ("Lab 1/王小明_102_assignsubmission_file_/lab/solve.c", &bad),
        ("Lab 1/Nobody_103_assignsubmission_file_/", b""),
        ("Lab 1/Zoë_104_assignsubmission_file_/lab.zip", &zip_of(&[("a/solve.c", &honest(180))])),
        ("Lab 1/Zoë_105_assignsubmission_file_/essay.pdf", b"%PDF"),
    ];
    std::fs::write(scratch.path().join("all.zip"), zip_of(&entries)).expect("an archive");
    let ran = grade(&scratch, &["--submissions", "all.zip", "-o", "out", "--hidden-seeds", "seeds.txt"]);
    assert!(ran.stdout.contains("5 submissions: 2 passed, 1 failed, 2 could not be run"), "{}", ran.stdout);
    let grades = table(&scratch.read("out/grades.csv"));
    assert_eq!(grades.len(), 4, "two have one name: {grades:#?}");
    let failed = &grades["王小明"];
    assert_eq!(failed[6], "3", "{failed:?}");
    let folder = scratch.path().join("out/students").join(&failed[1]);
    for entry in std::fs::read_dir(&folder).expect("a folder").flatten() {
        let text = String::from_utf8_lossy(&std::fs::read(entry.path()).expect("a file")).into_owned();
        assert!(!text.contains("770011") && !text.contains("880022"), "{}", entry.path().display());
    }
    let page = std::fs::read_to_string(folder.join("index.html")).expect("a page");
    for part in ["hidden 1", "hidden 2", "<svg", "replay.zip", "eyesim view replay.zip", "goal", "1 of 4 points"] {
        assert!(page.contains(part), "{part}: {page}");
    }
    assert!(scratch.read("out/rows.csv").contains("770011"));
    // The replay shows the case of the row.
    let rows = scratch.read("out/rows.csv");
    let row = rows.lines().find(|line| line.starts_with("王小明,") && line.contains(",1,failed")).expect("a row");
    let ran = Command::new(eyesim_path())
        .args(["run", "replay.zip", "--seed=1", "--slot=50", "--until=20", "--noise=mild", "--report", "r.json"])
        .current_dir(&folder)
        .output()
        .expect("eyesim starts");
    let report = std::fs::read_to_string(folder.join("r.json")).unwrap_or_else(|error| panic!("{error}: {ran:?}"));
    let report: Value = serde_json::from_str(&report).expect("a report");
    assert!(row.contains(report["digest"].as_str().expect("a digest")), "{row}\n{report:#}");
    // Similarity checkers expect one folder per student.
    assert!(scratch.path().join("out/sources/Ana_María/solve.c").is_file());
    assert!(scratch.read("out/junit.xml").contains("testsuite"));
}

/// The files that `eyesim new --lab` writes beside the program (checks, opponents, the module for editors) are not
/// programs of the student.
#[test]
fn the_folder_of_a_lab_can_be_handed_in_as_it_is() {
    if tests::lacks_sandbox() {
        return;
    }
    for (lab, number, language, extension) in [("mapping", "07", "python", "py"), ("relay", "09", "c", "c")] {
        let scratch = Scratch::new();
        let ran = scratch.eyesim(&["new", "--lab", lab, "--lang", language]);
        assert_eq!(ran.code, Some(0), "{ran:#?}");
        let solution = tests::root().join(format!("labs/{number}-{lab}/solutions/{lab}.{extension}"));
        std::fs::copy(solution, scratch.path().join(format!("{lab}/{lab}.{extension}"))).expect("a solution");
        let folder = tests::root().join(format!("labs/{number}-{lab}"));
        let suite = format!("{lab}.suite.toml");
        for entry in std::fs::read_dir(&folder).expect("a lab").flatten().filter(|entry| entry.path().is_file()) {
            let text = std::fs::read_to_string(entry.path()).expect("a text");
            let name = entry.file_name().into_string().expect("plain text");
            scratch.write(&format!("teacher/{name}"), &text.replace("\"1..20\"", "\"1..2\""));
        }
        std::fs::create_dir(scratch.path().join("in")).expect("a folder");
        std::fs::rename(scratch.path().join(lab), scratch.path().join("in/ana")).expect("a submission");
        let ran = scratch.eyesim(&["grade", &format!("teacher/{suite}"), "--submissions", "in", "-o", "out"]);
        assert!(ran.stdout.contains("1 submissions: 1 passed"), "{lab}: {ran:#?}");
    }
}

#[test]
fn replays_have_the_files_that_options_name() {
    if tests::lacks_sandbox() {
        return;
    }
    let scratch = lab();
    let suite = scratch
        .read("lab/lab.suite.toml")
        .replace("noise = \"mild\"", "noise = [\"one.noise.toml\", \"two.noise.toml\"]");
    scratch.write("lab/lab.suite.toml", &suite.replace("until_s = 20", "until_s = 20\nstdin = \"words.txt\""));
    scratch.write("lab/one.noise.toml", "base = \"mild\"\n");
    scratch.write("lab/two.noise.toml", "base = \"harsh\"\n");
    scratch.write("lab/words.txt", "400\n");
    let way = "int way = 0; if (scanf(\"%d\", &way) == 1) VWStraight(way, 200); VWWait();";
    scratch.write("in/ana.c", &String::from_utf8(program(way)).expect("a text"));
    grade(&scratch, &["--submissions", "in", "-o", "out"]);
    let page = scratch.read("out/students/ana/index.html");
    let rows = scratch.read("out/rows.csv");
    let folder = Scratch::new();
    std::fs::copy(scratch.path().join("out/students/ana/replay.zip"), folder.path().join("replay.zip"))
        .expect("a copy");
    for noise in ["one.noise.toml", "two.noise.toml"] {
        let words =
            page.split("eyesim view replay.zip ").skip(1).map(|rest| rest.split(" --at").next().expect("words"));
        let words = words.map(|words| words.split('<').next().expect("words").trim());
        let words = words.into_iter().find(|words| words.contains(noise)).unwrap_or_else(|| panic!("{noise}: {page}"));
        assert!(words.contains("--stdin=words.txt") && words.contains("--forbid"), "{words}");
        let line = format!("exec \"$EYESIM\" run replay.zip --report r.json {}", words.replace("&#39;", "'"));
        let ran =
            Command::new("sh").args(["-c", &line]).env("EYESIM", eyesim_path()).current_dir(folder.path()).output();
        let report: Value = serde_json::from_str(&folder.read("r.json")).unwrap_or_else(|_| panic!("{ran:?}"));
        assert!(rows.contains(report["digest"].as_str().expect("a digest")), "{rows}\n{report:#}");
    }
}

#[test]
fn a_passed_check_does_not_show_the_message_of_a_failed_one() {
    if tests::lacks_sandbox() {
        return;
    }
    let scratch = lab();
    let suite = scratch.read("lab/lab.suite.toml") + "points = 0\n";
    scratch.write("lab/lab.suite.toml", &suite);
    scratch.write("in/ana.c", &String::from_utf8(program("VWStraight(100, 200); VWWait();")).expect("a text"));
    scratch.write("in/bob.c", &String::from_utf8(program("exit(1);")).expect("a text"));
    grade(&scratch, &["--submissions", "in", "-o", "out"]);
    let outputs = |name: &str| {
        let results = result(&scratch.path().join("out/students").join(name), "");
        ["goal", "no contact"].map(|check| {
            let mut tests = results["tests"].as_array().expect("tests").iter();
            let test = tests.find(|test| test["name"] == check).expect("a test of the check");
            test["output"].as_str().expect("a text").to_owned()
        })
    };
    let [goal, contact] = outputs("ana");
    assert!(goal.contains("r1 was never within"), "{goal}");
    assert_eq!(contact, "met in 1 of 1 cases\n");
    assert!(outputs("bob")[1].contains("exit"), "a program that fails loses the points of all checks");
}

#[test]
fn forbidden_calls_are_named_to_students() {
    if tests::lacks_sandbox() {
        return;
    }
    let scratch = lab();
    let way = "SIMSetRobot(0, 1400, 500, 0, 0); SIMSetRobot(0, 1400, 500, 0, 0); VWStraight(900, 200); VWWait();";
    scratch.write("in/ana.c", &String::from_utf8(program(way)).expect("a text"));
    grade(&scratch, &["--submissions", "in", "-o", "out"]);
    let message = "r1 `SIMSetRobot` 2 times";
    assert!(scratch.read("out/students/ana/index.html").contains(message));
    let results = result(&scratch.path().join("out/students/ana"), "");
    assert!(results["output"].as_str().expect("a text").contains(message), "{results:#}");
    assert_eq!(results["score"], 4.0, "that alone costs nothing");
}

#[test]
fn the_autograder_grades_by_its_own_script_in_an_empty_folder() {
    if tests::lacks_sandbox() {
        return;
    }
    let scratch = lab();
    scratch.write("seeds.txt", "12..13\n");
    let ran = scratch.eyesim(&[
        "grade",
        "lab/lab.suite.toml",
        "--gradescope",
        "autograder.zip",
        "--hidden-seeds",
        "seeds.txt",
    ]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    let home = Scratch::new();
    let source = home.path().join("source");
    let unzipped = Command::new("python3")
        .args(["-m", "zipfile", "-e"])
        .arg(scratch.path().join("autograder.zip"))
        .arg(&source)
        .status()
        .expect("python3");
    assert!(unzipped.success());
    for (body, points) in
        [("VWStraight(900, 200); VWWait();", 4.0), ("VWStraight(300, 200); VWWait();", 1.0), ("x", 0.0)]
    {
        home.write("submission/solve.c", &String::from_utf8(program(body)).expect("a text"));
        _ = std::fs::remove_dir_all(home.path().join("results"));
        let ran = Command::new("bash")
            .arg("-c")
            .arg("chmod +x source/eyesim && exec bash source/run_autograder")
            .current_dir(home.path())
            .env_clear()
            .env("PATH", std::env::var_os("PATH").expect("a path"))
            .env("EYESIM_AUTOGRADER", home.path())
            .env("EYESIM_CACHE", home.path().join("cache"))
            .output()
            .expect("bash");
        assert!(ran.status.success(), "{ran:?}");
        let results: Value = serde_json::from_str(&home.read("results/results.json")).expect("JSON");
        validate(&results);
        assert_eq!(results["score"], points, "{results:#}");
    }
}

#[test]
fn opponents_and_headers_are_those_of_the_suite_and_of_each_robot() {
    if tests::lacks_sandbox() {
        return;
    }
    let scratch = lab();
    let scene = scratch.read("lab/lab.scene.toml");
    scratch.write(
        "lab/lab.scene.toml",
        &format!("{scene}\n[[robot]]\ntype = \"S4\"\nprogram = \"opponent.c\"\nx_mm = 500\ny_mm = 800\n"),
    );
    scratch.write("lab/opponent.c", &String::from_utf8(honest(100)).expect("a text"));
    scratch.write(
        "in/ana/main.c",
        "#include \"eyebot.h\"\n#include \"way.h\"\nint main() { VWStraight(WAY, 200); VWWait(); return 0; }\n",
    );
    scratch.write("in/ana/way.h", "#define WAY 900\n");
    scratch.write("in/ana/opponent.h", "#error\n");
    let ran = grade(&scratch, &["--submissions", "in", "-o", "out"]);
    assert!(ran.stdout.contains("1 passed"), "{}", ran.stdout);
    // With another opponent the class is graded again.
    scratch.write("lab/opponent.c", "int main( {\n");
    let ran = scratch.eyesim(&["grade", "lab/lab.suite.toml", "--submissions", "in", "-o", "out"]);
    assert!(ran.code == Some(2) && ran.stderr.contains("opponent.c"), "{ran:#?}");
    scratch.write("lab/opponent.c", &String::from_utf8(honest(101)).expect("a text"));
    let ran = grade(&scratch, &["--submissions", "in", "-o", "out"]);
    assert!(ran.stdout.contains("[1/1] ana: 1 of 1 cases passed"), "{}", ran.stdout);
}

#[test]
fn wrong_arguments_are_reported() {
    if tests::lacks_sandbox() {
        return;
    }
    let scratch = lab();
    scratch.write("in/ana.c", "int main() { return 0; }\n");
    scratch.write("used/mine.txt", "mine");
    scratch.write("seeds.txt", "1\nx\n");
    let base = scratch.read("lab/lab.suite.toml");
    let check = |suite: &str, args: &[&str], part: &str| {
        scratch.write("lab/lab.suite.toml", suite);
        let ran = scratch.eyesim(&[&["grade", "lab/lab.suite.toml"], args].concat());
        assert!(ran.code == Some(2) && ran.stderr.contains(part), "{args:?}: {ran:#?}");
    };
    let all = ["--submissions", "in", "-o", "out"];
    check(&base, &["--submissions", "in"], "nothing is written");
    check(&base, &["--submissions", "nowhere", "-o", "out"], "nowhere");
    check(&base, &["--submissions", "in", "-o", "used"], "expected an empty folder");
    check(&base, &[&all[..], &["--hidden-seeds", "seeds.txt"]].concat(), "line 2: `x` is not a seed");
    check(&base.replace("submit =", "# "), &all, "which files of a submission are programs");
    check(&base.replace("{ 1 =", "{ 7 ="), &all, "robot 7");
    check(&base.replace("[\"*.c\", \"*.cpp\", \"*.so\"]", "[]"), &all, "names no files");
    check(&base.replace("[\"*.c\", \"*.cpp\", \"*.so\"]", "3"), &all, "is of type integer");
}
