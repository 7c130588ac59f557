//! C++ programs: streams, exceptions, static objects, virtual time, and destructors at the end.

use serde_json::Value;
use tests::{Ran, Scratch, write_scene};

/// Writes `files`, runs `program` on `robots` robots and returns the report and the output.
fn run(files: &[(&str, &str)], program: &str, robots: usize, args: &[&str], code: i32) -> (Value, Ran) {
    let scratch = Scratch::new();
    for (name, text) in files {
        scratch.write(name, text);
    }
    write_scene(&scratch, &vec![program; robots]);
    let mut all = vec!["run", "scene.sim", "--report", "r.json"];
    all.extend(args);
    let ran = scratch.eyesim(&all);
    assert_eq!(ran.code, Some(code), "{ran:#?}");
    (serde_json::from_str(&scratch.read("r.json")).expect("a report"), ran)
}

/// Runs `source` as `prog.cpp`.
fn run_cpp(source: &str, robots: usize, args: &[&str], code: i32) -> (Value, Ran) {
    run(&[("prog.cpp", source)], "prog.cpp", robots, args, code)
}

fn reason(report: &Value) -> &str {
    report["robots"][0]["reason"].as_str().unwrap_or_else(|| panic!("a reason in {report:#}"))
}

/// Console lines of a robot, without its number and the times.
fn lines(ran: &Ran, robot: usize) -> Vec<&str> {
    let start = format!("[r{robot} ");
    let own = ran.stdout.lines().filter(|line| line.starts_with(&start));
    own.filter_map(|line| line.split_once("] ")).map(|(_, text)| text.trim()).collect()
}

#[test]
fn streams_print_to_the_robots_console_line_by_line() {
    let source = r#"
        #include <iostream>
        #include <string>
        #include "eyebot.h"
        int main() {
            std::cout << "robot " << int(OSMachineID()) << " starts\n";
            OSWait(100);
            std::cerr << "half";
            std::clog << "way" << std::endl;
            std::string word;
            std::cout << (std::cin >> word ? "input" : "no input") << std::endl;
            std::ios_base::sync_with_stdio(false);
            std::cout << "rest";
        }"#;
    let (report, ran) = run_cpp(source, 2, &[], 0);
    assert!(!ran.stderr.contains("warning") && !ran.stderr.contains(" uses "), "{ran:#?}");
    for robot in [1, 2] {
        let own = lines(&ran, robot);
        assert_eq!(own, [format!("robot {robot} starts").as_str(), "no input", "rest"], "{ran:#?}");
        assert!(ran.stderr.contains(&format!("[r{robot} 1.000 s] halfway\n")), "{ran:#?}");
        assert!(ran.stdout.contains(&format!("[r{robot} 1.0")), "the time of the line's end: {ran:#?}");
        assert_eq!(report["robots"][robot - 1]["outcome"], "finished");
    }
}

#[test]
fn each_robot_has_its_own_objects_of_templates_and_inline_functions() {
    let source = r#"
        #include <iostream>
        #include "eyebot.h"
        template <typename T> struct Count { static T value; };
        template <typename T> T Count<T>::value = 0;
        inline int &calls() { static int n = 0; return n; }
        inline int shared = 0;
        int main() {
            for (int i = 0; i < 5; i++) { Count<int>::value++; calls()++; shared++; OSWait(7); }
            std::cout << Count<int>::value << calls() << shared << std::endl;
        }"#;
    let (_, ran) = run_cpp(source, 3, &["--threads", "2"], 0);
    assert_eq!([lines(&ran, 1), lines(&ran, 2), lines(&ran, 3)], [["555"], ["555"], ["555"]], "{ran:#?}");
}

#[test]
fn time_and_random_numbers_are_the_robots_own() {
    let source = r#"
        #include <chrono>
        #include <cstdlib>
        #include <iostream>
        #include <random>
        #include <thread>
        #include "eyebot.h"
        int main() {
            using namespace std::chrono;
            auto steady = steady_clock::now();
            auto system = system_clock::now();
            std::this_thread::sleep_for(milliseconds(2500));
            std::this_thread::sleep_until(steady_clock::now() + milliseconds(500));
            std::cout << duration_cast<milliseconds>(steady_clock::now() - steady).count() << ' '
                      << duration_cast<milliseconds>(system_clock::now() - system).count() << ' '
                      << duration_cast<milliseconds>(high_resolution_clock::now().time_since_epoch()).count() / 1000 << '\n';
            std::time_t now = system_clock::to_time_t(system_clock::now());
            std::cout << std::gmtime(&now)->tm_year << '\n';
            std::random_device device;
            std::mt19937 twister(device());
            std::cout << device() << ' ' << device() << ' ' << twister() << ' ' << std::rand() << '\n';
        }"#;
    let (_, one) = run_cpp(source, 2, &["--seed", "3", "--threads", "1"], 0);
    let (_, again) = run_cpp(source, 2, &["--seed", "3", "--threads", "2"], 0);
    let (_, other) = run_cpp(source, 2, &["--seed", "4"], 0);
    assert!(lines(&one, 1)[0].starts_with("3000 3000 "), "{one:#?}");
    assert_eq!(lines(&one, 1)[1], "100", "the calendar starts in the year 2000: {one:#?}");
    assert_eq!(lines(&one, 1), lines(&again, 1));
    assert_eq!(lines(&one, 2), lines(&again, 2));
    assert_ne!(lines(&one, 1)[2], lines(&one, 2)[2]);
    assert_ne!(lines(&one, 1)[2], lines(&other, 1)[2]);
}

#[test]
fn exceptions_are_caught_within_the_program() {
    let source = r#"
        #include <iostream>
        #include <stdexcept>
        #include <vector>
        #include "eyebot.h"
        static void deep(int n) { if (n == 0) throw std::runtime_error("deep"); deep(n - 1); }
        int main() {
            try { deep(20); } catch (const std::exception &e) { std::cout << "caught " << e.what() << '\n'; }
            try { std::vector<int> v(3); v.at(7) = 1; } catch (const std::out_of_range &) { std::cout << "range\n"; }
            try { throw 42; } catch (...) { std::cout << "any\n"; }
            return 0;
        }"#;
    let (_, ran) = run_cpp(source, 1, &[], 0);
    assert_eq!(lines(&ran, 1), ["caught deep", "range", "any"], "{ran:#?}");
}

#[test]
fn an_uncaught_exception_fails_only_its_robot() {
    let thrown = |what: &str| {
        let source = format!(
            r#"
            #include <stdexcept>
            #include "eyebot.h"
            struct Collision {{ int x; }};
            namespace maze {{ struct Lost : std::logic_error {{ using std::logic_error::logic_error; }}; }}
            int main() {{
                OSWait(10);
                if (OSMachineID() == 1) {{ {what}; }}
                OSWait(100);
            }}"#
        );
        let (report, _) = run_cpp(&source, 2, &[], 1);
        assert_eq!(report["robots"][0]["outcome"], "failed", "{report:#}");
        assert_eq!(report["robots"][1]["outcome"], "finished", "{report:#}");
        reason(&report).to_owned()
    };
    assert!(thrown("throw maze::Lost(\"no way\")").starts_with("uncaught exception `maze::Lost`: no way"));
    assert!(thrown("throw \"a text\"").starts_with("uncaught exception `char const*`: a text"));
    assert!(thrown("throw Collision{3}").starts_with("uncaught exception `Collision`"));
    assert!(thrown("std::terminate()").starts_with("std::terminate was called"));
    assert!(thrown("auto f = []() noexcept { throw 1; }; f()").starts_with("uncaught exception `int`"));
}

#[test]
fn an_exception_in_a_timer_function_fails_the_robot() {
    let source = r#"
        #include <stdexcept>
        #include "eyebot.h"
        void tick() { throw std::runtime_error("in the timer"); }
        int main() {
            OSAttachTimer(10, tick);
            try { OSWait(100); } catch (...) { LCDPrintf("not here"); }
            return 0;
        }"#;
    let (report, _) = run_cpp(source, 1, &[], 1);
    assert!(reason(&report).starts_with("uncaught exception `std::runtime_error`: in the timer"), "{report:#}");
}

const OBJECTS: &str = r#"
    #include <cstdlib>
    #include <iostream>
    #include "eyebot.h"
    struct Named {
        const char *name;
        Named(const char *name) : name(name) { std::cout << "+" << name << " " << OSGetCount() << std::endl; }
        ~Named() { std::cout << "-" << name << std::endl; }
    };
    Named a("a"), b("b");
    thread_local Named t("t");
    static void at_exit() { std::cout << "atexit" << std::endl; }
    int main(int argc, char **) {
        Named local("local");
        (void)t.name;
        std::atexit(at_exit);
        OSWait(10);
        switch (argc) {
            case 2: std::exit(0);
            case 3: for (;;) OSWait(100);
            case 4: std::abort();
        }
        return 0;
    }
"#;

#[test]
fn static_objects_live_as_long_as_the_program() {
    let names = |args: &[&str], code| {
        let (_, ran) = run_cpp(OBJECTS, 1, args, code);
        lines(&ran, 1).into_iter().map(|line| line.split(' ').next().unwrap_or_default().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(names(&[], 0), ["+a", "+b", "+local", "+t", "-local", "-t", "atexit", "-b", "-a"]);
    // As in C++, `exit` does not destroy automatic objects.
    assert_eq!(names(&["--args", "1"], 0), ["+a", "+b", "+local", "+t", "-t", "atexit", "-b", "-a"]);
    // If the simulator stops a program, it destroys all objects and calls no exit handlers.
    assert_eq!(names(&["--args", "1 2", "--until", "2"], 0), ["+a", "+b", "+local", "+t", "-local", "-t", "-b", "-a"]);
    assert_eq!(names(&["--args", "1 2 3"], 1), ["+a", "+b", "+local", "+t"]);
}

#[test]
fn a_program_that_catches_its_stop_is_abandoned() {
    let body = |body: &str| {
        let source = format!("#include <iostream>\n#include \"eyebot.h\"\n{body}");
        let (report, ran) = run_cpp(&source, 2, &["--until", "1"], 0);
        assert_eq!(report["robots"][0]["outcome"], "running", "{report:#}");
        ran
    };
    body("int main() { for (;;) { try { OSWait(10); } catch (...) { } } }");
    body("int main() { for (;;) { try { OSWait(10); } catch (...) { OSWait(10); throw; } } }");
    body("static void quiet() noexcept { for (;;) OSWait(10); }\nint main() { quiet(); }");
    body(
        "struct Loop { ~Loop() { while (KEYRead() == 0) OSWait(1); } };\nint main() { Loop loop; for (;;) OSWait(10); }",
    );
    let said = body(
        "struct Say { ~Say() { std::cout << \"stopped\" << std::endl; } };\n\
         int main() { Say say; for (;;) OSWait(10); }",
    );
    assert_eq!(lines(&said, 1), ["stopped"]);
}

#[test]
fn a_log_that_is_open_at_the_end_is_written() {
    let scratch = Scratch::new();
    scratch.write(
        "log.cpp",
        r#"
        #include <fstream>
        #include "eyebot.h"
        std::ofstream all("global.txt");
        int main() {
            std::ofstream log("local.txt");
            for (int i = 0;; i++) { log << i << '\n'; all << i << '\n'; OSWait(10); }
        }"#,
    );
    write_scene(&scratch, &["log.cpp"]);
    scratch.report("scene.sim", &["--until", "1"], 0);
    assert!(scratch.read("local.txt").ends_with("8\n9\n"), "{}", scratch.read("local.txt"));
    assert_eq!(scratch.read("global.txt"), scratch.read("local.txt"));
}

#[test]
fn c_and_cpp_files_make_one_program() {
    let main = "#include <iostream>\n#include \"map.h\"\n#include \"plan.hpp\"\n\
                int main() { std::cout << map_size() << plan(2) << std::endl; }\n";
    let files = [
        ("prog/main.cpp", main),
        ("prog/plan.cc", "#include \"plan.hpp\"\nint plan(int x) { return 2 * x; }\n"),
        ("prog/plan.hpp", "int plan(int);\n"),
        ("prog/map.c", "#include \"map.h\"\nint map_size(void) { int new = 3; return new; }\n"),
        (
            "prog/map.h",
            "#ifdef __cplusplus\nextern \"C\" {\n#endif\nint map_size(void);\n#ifdef __cplusplus\n}\n#endif\n",
        ),
    ];
    for program in ["prog", "prog/main.cpp,prog/map.c,prog/plan.cc"] {
        let (_, ran) = run(&files, program, 1, &[], 0);
        assert_eq!(lines(&ran, 1), ["34"], "{ran:#?}");
    }
}

#[test]
fn names_of_other_systems_lead_to_the_cpp_source_beside() {
    for program in ["prog.x", "prog.exe", "prog.dll", "prog.so"] {
        let (report, _) = run(&[("prog.cc", "int main() { return 0; }\n")], program, 1, &[], 0);
        assert_eq!(report["robots"][0]["outcome"], "finished", "{program}");
    }
}

#[test]
fn a_function_of_c_that_is_declared_as_one_of_cpp_is_reported_with_its_file() {
    let scratch = Scratch::new();
    scratch.write("main.cpp", "int map_size(int);\nint main() { return map_size(1); }\n");
    scratch.write("map.c", "int map_size(int x) { return x; }\n");
    let ran = scratch.eyesim(&["cc", "main.cpp", "map.c", "-o", "maze.so"]);
    assert_eq!(ran.code, Some(2), "{ran:#?}");
    let hint = "`map_size` is defined in map.c as C and used from main.cpp as C++: declare it `extern \"C\"` for C++";
    assert!(ran.stderr.contains(hint), "{ran:#?}");
    assert!(!ran.stderr.contains("not defined:"), "{ran:#?}");
}

#[test]
fn a_pure_virtual_function_that_is_called_fails_the_robot_with_its_cause() {
    let source = "#include \"eyebot.h\"\nclass Base { public: Base() { go(); } virtual void drive() = 0; void go() { drive(); } };\n\
                  class Robot : public Base { public: void drive() { OSWait(1); } };\nint main() { Robot robot; return 0; }\n";
    let (report, _) = run_cpp(source, 1, &[], 1);
    assert!(reason(&report).contains("a pure virtual function (`= 0`) is called"), "{report:#}");
}

#[test]
fn cpp_from_before_2017_still_compiles() {
    let source = r#"
        #include <iostream>
        #include "eyebot.h"
        using namespace std;
        typedef unsigned char byte;
        int data[3];
        void check(int n) throw(int) { if (n > 5) throw n; }
        int main() { register int i; byte b = 200; for (i = 0; i < 3; i++) data[i] = i; check(3); cout << data[2] + b << endl; OSWait(1); }"#;
    let (_, ran) = run_cpp(source, 1, &[], 0);
    assert_eq!(lines(&ran, 1), ["202"], "{ran:#?}");
}

#[test]
fn cpp_of_its_time_still_compiles() {
    let source = r#"
        #include <iostream>
        #include <vector>
        #include "eyebot.h"
        using namespace std;
        class Cell { public: int x, y; Cell(int x, int y) : x(x), y(y) {} };
        int main()
        {
            int ratio[2] = { 3.5, 2 };
            vector<Cell> path;
            path.push_back(Cell(ratio[0], ratio[1]));
            LCDPutString("plain text");
            cout << path[0].x << endl;
        }"#;
    let (_, ran) = run_cpp(source, 1, &[], 0);
    assert_eq!(lines(&ran, 1), ["3"], "{ran:#?}");
    assert!(ran.stderr.contains("-Wnarrowing") && !ran.stderr.contains("ISO C++ forbids"), "{ran:#?}");
}
