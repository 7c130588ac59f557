//! Python programs: RoBIOS-7 through `eye.py`, each program in its own process, as deterministic as a C program.

use std::process::Command;

use serde_json::Value;
use tests::{Scratch, write_scene};

/// Returns true if Python is installed; otherwise prints why the test is skipped.
fn has_python() -> bool {
    let has = Command::new("python3").arg("--version").output().is_ok_and(|out| out.status.success());
    if !has {
        println!("skipped: there is no `python3`");
    }
    has
}

/// Writes a scene `a.sim`: a room of 4 m by 4 m with robots 1 m apart that run these programs.
fn scratch(programs: &[&str]) -> Scratch {
    let scratch = Scratch::new();
    let robot = |(index, program): (usize, &&str)| format!("S4 1000 {} 0 {program}\n", 1000 + 1000 * index);
    let robots: String = programs.iter().enumerate().map(robot).collect();
    scratch.write("room.wld", "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n");
    scratch.write("a.sim", &format!("world room.wld\n{robots}"));
    scratch
}

/// Lines of robot 1's standard output.
fn said(scratch: &Scratch, args: &[&str], code: i32) -> Vec<String> {
    scratch.report("a.sim", &[args, &["--trace", "t.jsonl"]].concat(), code);
    said_as(scratch, "stdout")
}

/// Lines of robot 1's output in the last trace, on one stream.
fn said_as(scratch: &Scratch, stream: &str) -> Vec<String> {
    let is_said = |event: &&Value| event["event"] == stream && event["robot"] == 1;
    let text = |event: &Value| event["text"].as_str().expect("text").to_owned();
    scratch.trace("t.jsonl").iter().filter(is_said).map(text).collect()
}

const WANDERER: &str = r#"
import random
import time
from eye import *

ticks = 0

def tick():
    global ticks
    ticks += 1

timer = OSAttachTimer(100, tick)
seen = {"wall", "door", "ball"}
for step in range(5):
    VWStraight(random.randint(50, 200), 200)
    VWWait()
    VWTurn(random.choice([-90, 90]), 90)
    VWWait()
    print(step, VWGetPosition(), PSDGet(PSD_FRONT), LIDARGet()[180], list(seen), ticks, time.time())
OSDetachTimer(timer)
"#;

const NEIGHBOUR: &str = r#"#include "eyebot.h"
int main(void)
{
    int i;
    for (i = 0; i < 8; i++) {
        VWStraight(rand() % 100, 100);
        VWWait();
        VWTurn(45, 90);
        VWWait();
    }
    return 0;
}
"#;

#[test]
fn sizes_of_images_are_set_where_they_are_imported() {
    let scratch = scratch(&["a.py"]);
    scratch.write("helper.py", "from eye import *\nIP_WIDTH = 3\ndef sizes():\n    return CAMHEIGHT, IP_WIDTH\n");
    scratch.write(
        "a.py",
        r#"
from eye import *
from helper import sizes
CAMHEIGHT = QVGA_Y
CAMInit(QQVGA)
print(CAMWIDTH, CAMHEIGHT, CAMPIXELS, CAMSIZE, CAMMODE, IP_WIDTH, sizes())
IPSetSize(CUSTOM, 4, 2)
print(CAMWIDTH, IP_WIDTH, IP_HEIGHT, IP_PIXELS, IP_SIZE, sizes(), len(bytes(IP_SIZE)))
LCDImageStart(0, 0, 2, 2)
try:
    LCDImageGray([[1, 2], [3, 4]])
except TypeError as error:
    print(error)
"#,
    );
    let ran = scratch.eyesim(&["run", "a.sim"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    for expected in [
        "160 240 19200 57600 0 160 (120, 3)",
        "160 4 2 8 24 (120, 3) 24",
        "LCDImageGray: expected a list of numbers from 0 to 255, got one with [1, 2]: write `[pixel for row in image for pixel in row]`",
    ] {
        assert!(ran.stdout.contains(expected), "{expected}: {}", ran.stdout);
    }
}

#[test]
fn the_same_program_gives_the_same_digest_twenty_times_and_beside_programs_in_c() {
    if !has_python() {
        return;
    }
    let scratch = scratch(&["walk.py", "walk.py", "other.c"]);
    scratch.write("walk.py", WANDERER);
    scratch.write("other.c", NEIGHBOUR);
    let digest = |threads: &str, exec: &str| {
        scratch.report("a.sim", &["--threads", threads, "--exec", exec, "--seed", "7"], 0)["digest"].take()
    };
    let first = digest("1", "thread");
    for round in 1..20 {
        let [threads, exec] = [["2", "1"][round % 2], ["thread", "process"][round / 2 % 2]];
        assert_eq!(digest(threads, exec), first, "round {round}");
    }
    assert_ne!(scratch.report("a.sim", &["--seed", "8"], 0)["digest"], first, "random numbers come from the seed");
}

#[test]
fn names_of_parameters_are_also_those_of_eyesim_vr() {
    if !has_python() {
        return;
    }
    let scratch = scratch(&["a.py"]);
    scratch.write(
        "a.py",
        "from eye import *\nprint(VWStraight(dist=100, speed=100), VWTurn(speed=20, ang=9), VWStraight(100, lin_speed=50))\n\
         LCDSetPrintf(row=1, column=2, format='x')\nSIMSetRobot(id=1, x=700, y=600, z=0, phi=0)\n\
         print(int.from_bytes(SIMGetRobot(1)[0], 'little'))\n",
    );
    assert_eq!(said(&scratch, &[], 0), ["0 0 0", "700"]);
}

#[test]
fn polling_loops_advance_time_in_longer_steps() {
    if !has_python() {
        return;
    }
    let scratch = scratch(&["a.py"]);
    scratch.write(
        "a.py",
        "from eye import *\nturns = 0\nwhile OSGetCount() < 3000:\n    KEYRead()\n    turns += 1\nprint(1000 < turns < 5000, OSGetCount())\n\
         for i in range(2000):\n    KEYRead()\n    LCDSetPos(0, 0)\nprint(OSGetCount() < 3500)\n",
    );
    let said = said(&scratch, &[], 0);
    assert!(said[0].starts_with("True 30") && said[1] == "True", "{said:?}");
}

#[test]
fn output_parameters_of_c_are_returned_in_python() {
    if !has_python() {
        return;
    }
    let scratch = scratch(&["a.py"]);
    scratch.write(
        "a.py",
        r#"
from eye import *
import sys
print(sys.argv[1:], __name__)
print(VWStraight(500, 200), VWWait(), VWGetPosition())
VWTurn(90, 60); VWWait()
print(VWGetPosition(), SIMGetRobot(0), SIMGetRobotCount(), OSMachineID())
print(len(LIDARGet()), LIDARGet()[180])
print(PSDGet(9), KEYRead(), KEYReadXY(), LCDGetSize())
LCDPrintf("%d %s\n", 3, "x"); LCDPrintf("100%\n")
IPSetSize(QQVGA)
image = bytearray(IP_SIZE) if False else bytearray(160 * 120 * 3)
image[0:3] = b"\xff\x00\x00"
grey = IPCol2Gray(image)
print(len(grey), type(grey[0]).__name__, len(IPSobel(grey)), len(IPCol2HSI(image)))
print(IPPCol2RGB(ORANGE), IPWriteFile("a.ppm", image), len(IPReadFile("a.ppm")), IPReadFile("none.ppm"))
n = []
t = OSAttachTimer(10, lambda: n.append(OSGetCount()))
OSWait(100)
print(len(n), OSDetachTimer(t), OSDetachTimer(t))
try:
    VWStraight("far", 200)
except TypeError as error:
    print(error)
try:
    VWStraight(1e12, 200)
except OverflowError as error:
    print(error)
try:
    VWSetSpeed("100", 0)
except TypeError as error:
    print(error)
"#,
    );
    let said = said(&scratch, &["--args", "1:--kp 0.5"], 0);
    assert_eq!(said[0], "['--kp', '0.5'] __main__");
    assert_eq!(said[1], "0 0 (500, 0, 0)");
    assert_eq!(said[2], "(500, 0, 90) (1500, 1000, 0, 90) 1 1");
    assert_eq!(said[3], "360 3000");
    assert_eq!(said[4], "0 0 None (480, 320)");
    assert_eq!(said[5], "19200 int 19200 3");
    assert_eq!(said[6], "(255, 165, 0) 0 57600 None");
    assert!(said[7].ends_with(" 0 1") && !said[7].starts_with("0 "), "{}", said[7]);
    assert_eq!(said[8], "VWStraight: expected a number, got 'far'");
    assert!(said[9].starts_with("VWStraight: 1000000000000 is not within"), "{}", said[9]);
    assert_eq!(said[10], "VWSetSpeed: expected a number, got '100': `int('100')` is one");
}

#[test]
fn time_and_random_numbers_are_the_robots_own() {
    if !has_python() {
        return;
    }
    let scratch = scratch(&["a.py", "a.py"]);
    let program = "import os, random, secrets, time, uuid\nstart = time.monotonic()\ntime.sleep(2)\n\
                   print(2 <= time.monotonic() - start < 2.001, 2 <= time.time() < 2.001)\n\
                   print(random.random(), os.urandom(4).hex(), secrets.token_hex(4), uuid.uuid4(), hash('x'))\n";
    scratch.write("a.py", program);
    let first = said(&scratch, &["--seed", "3"], 0);
    assert_eq!(first[0], "True True");
    assert_eq!(said(&scratch, &["--seed", "3"], 0), first);
    let others: Vec<String> = scratch
        .trace("t.jsonl")
        .iter()
        .filter(|event| event["event"] == "stdout" && event["robot"] == 2)
        .map(|event| event["text"].as_str().expect("text").to_owned())
        .collect();
    assert_ne!(others[1], first[1]);
}

#[test]
fn an_uncaught_exception_ends_its_robot_with_a_traceback() {
    if !has_python() {
        return;
    }
    let scratch = scratch(&["bad.py", "good.py", "exit.py", "loop.py"]);
    scratch.write("bad.py", "from eye import *\n\ndef f(x):\n    return 1 // x\n\nOSWait(100)\nf(0)\n");
    scratch.write("good.py", "from eye import *\nVWStraight(300, 100)\nVWWait()\nprint(VWGetPosition())\n");
    scratch.write("exit.py", "import sys\nfrom eye import *\nOSWait(5)\nsys.exit(3)\n");
    scratch.write("loop.py", "from eye import *\nOSWait(5)\nwhile True:\n    pass\n");
    let report = scratch.report("a.sim", &["--trace", "t.jsonl", "--timeout", "1"], 1);
    let robots = report["robots"].as_array().expect("robots");
    assert_eq!((&robots[0]["outcome"], &robots[1]["outcome"]), (&"failed".into(), &"finished".into()));
    assert_eq!((&robots[2]["exit_code"], &robots[3]["outcome"]), (&3.into(), &"timeout".into()));
    let reason = |index: usize| robots[index]["reason"].as_str().expect("a reason").to_owned();
    assert!(reason(0).contains("ZeroDivisionError") && reason(0).contains("bad.py:4"), "{}", reason(0));
    assert!(reason(3).contains("loop.py:"), "{}", reason(3));
    let trace = scratch.trace("t.jsonl");
    let traceback = trace.iter().filter(|event| event["event"] == "stderr" && event["robot"] == 1);
    let traceback: String = traceback.map(|event| format!("{}\n", event["text"].as_str().expect("text"))).collect();
    assert!(traceback.starts_with("Traceback (most recent call last):"), "{traceback}");
    assert!(traceback.contains("line 7, in <module>") && traceback.contains("line 4, in f"), "{traceback}");
    assert!(!traceback.contains("eye.py"), "{traceback}");
}

#[test]
fn an_exception_of_a_timer_is_raised_by_the_interrupted_call() {
    if !has_python() {
        return;
    }
    let tick = "from eye import *\ndef tick():\n    raise ValueError('from the timer')\nOSAttachTimer(100, tick)\n";
    let caught = "try:\n    OSWait(1000)\nexcept ValueError as error:\n    print('caught', error)\n\
                  OSWait(5)\nprint('goes on', OSGetCount())\n";
    let scratch = scratch(&["uncaught.py", "caught.py"]);
    scratch.write("uncaught.py", &format!("{tick}OSWait(1000)\nprint('never')\n"));
    scratch.write("caught.py", &format!("{tick}{caught}"));
    let report = scratch.report("a.sim", &["--until", "20", "--trace", "t.jsonl"], 1);
    let robots = &report["robots"];
    assert_eq!(robots[0]["outcome"], "failed", "{report:#}");
    assert_eq!(robots[0]["reason"], "ValueError: from the timer at uncaught.py:3");
    assert_eq!((&robots[1]["outcome"], &robots[1]["exit_code"]), (&"finished".into(), &0.into()), "{report:#}");
    let trace = scratch.trace("t.jsonl");
    let printed = |robot: u64, stream: &'static str| -> Vec<String> {
        let of_robot = trace.iter().filter(|line| line["robot"] == robot && line["event"] == stream);
        of_robot.map(|line| line["text"].as_str().expect("a text").to_owned()).collect()
    };
    assert!(printed(1, "stderr").iter().any(|line| line.contains("Traceback")), "{:?}", printed(1, "stderr"));
    assert_eq!(printed(1, "stdout"), [""; 0]);
    assert_eq!(printed(2, "stdout")[0], "caught from the timer");
    assert!(printed(2, "stdout")[1].starts_with("goes on"), "{:?}", printed(2, "stdout"));
}

#[test]
fn a_program_that_is_not_python_or_has_no_interpreter_is_reported() {
    if !has_python() {
        return;
    }
    let scratch = scratch(&["a.py"]);
    scratch.write("a.py", "from eye import *\nif True\n    pass\n");
    let report = scratch.report("a.sim", &[], 1);
    let reason = report["robots"][0]["reason"].as_str().expect("a reason");
    assert!(reason.contains("SyntaxError") && reason.contains("a.py:2"), "{reason}");
    let ran = scratch.command(&["run", "a.sim"]).env("PYTHON", "no-such-python").output().expect("it runs");
    let said = String::from_utf8_lossy(&ran.stderr);
    assert_eq!(ran.status.code(), Some(2), "{said}");
    assert!(said.contains("`no-such-python`, which Python programs need, cannot be run"), "{said}");
}

#[test]
fn a_file_eye_py_beside_the_program_is_not_imported() {
    if !has_python() {
        return;
    }
    let scratch = scratch(&["a.py"]);
    scratch.write("eye.py", "raise RuntimeError('another eye')\n");
    scratch.write("helper.py", "from eye import *\ndef ahead():\n    return PSDGet(PSD_FRONT) > 0\n");
    scratch.write("a.py", "import eye, helper\nprint(helper.ahead(), eye.OSMachineID())\n");
    assert_eq!(said(&scratch, &[], 0), ["True 1"]);
    let hints = || said_as(&scratch, "stderr");
    let hint = |own: &str| {
        format!(
            "a.py: hint: `import eye` gives the simulator's module, not {own} beside the program: a module of your own needs another name"
        )
    };
    assert_eq!(hints(), [hint("`eye.py`")]);
    std::fs::remove_file(scratch.path().join("eye.py")).expect("the module");
    scratch.write("eye/__init__.py", "");
    assert_eq!(said(&scratch, &[], 0), ["True 1"]);
    assert_eq!(hints(), [hint("the folder `eye`")]);
    scratch.write("a.py", "print('no robot')\n");
    assert_eq!((said(&scratch, &[], 0), hints()), (vec!["no robot".to_owned()], vec![]));
}

#[test]
fn a_copy_of_our_module_beside_the_program_causes_no_hint() {
    if !has_python() {
        return;
    }
    let scratch = Scratch::new();
    let ran = scratch.eyesim(&["new", "mine", "--lang", "python", "--api", "7"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    let ran = scratch.eyesim(&["run", "mine/mine.sim", "--until", "5"]);
    assert!(!ran.stderr.contains("hint: `import eye`"), "{ran:#?}");
}

#[test]
fn a_wrong_number_of_arguments_is_reported_with_the_names_of_the_parameters() {
    if !has_python() {
        return;
    }
    let scratch = scratch(&["a.py"]);
    let calls = [
        ("SIMSetRobot(1, 700, 600, 90)", "SIMSetRobot: expected (id, x, y, z, phi), got 4 arguments"),
        ("SIMSetRobot(0, 700, 90)", "SIMSetRobot: expected (id, x, y, z, phi), got 3 arguments"),
        ("SIMSetRobot(1500)", "SIMSetRobot: expected (id, x, y, z, phi), got 1 argument"),
        ("SIMSetObject(2, 5)", "SIMSetObject: expected (id, x, y, z, phi) or (id, x, y, phi), got 2 arguments"),
        ("SIMGetObject(2, 5)", "SIMGetObject: expected (id), (id, x, y, phi) or (id, x, y, z, phi), got 2 arguments"),
        ("RADIOReceive(1, 2)", "RADIOReceive: expected (size) or (id, buf, size), got 2 arguments"),
        ("AURecord(100)", "AURecord: expected (time, freq) or (buf, time, freq), got 1 argument"),
    ];
    let program: String = calls
        .iter()
        .map(|(call, _)| {
            format!("try:\n    {call}\n    print('accepted')\nexcept TypeError as error:\n    print(error)\n")
        })
        .collect();
    let forms =
        "SIMSetRobot(1500, 1200, 0, 90)\nprint(SIMGetRobot(0))\nSIMSetRobot(1200, 1500, 45)\nprint(SIMGetRobot(0))\n";
    scratch.write("a.py", &format!("from eye import *\n{program}{forms}VWTurn(90, 45, 1)\n"));
    let said = said(&scratch, &[], 1);
    let expected: Vec<&str> = calls.iter().map(|(_, message)| *message).collect();
    assert_eq!(said[..calls.len()], expected);
    assert_eq!(said[calls.len()..], ["(1500, 1200, 0, 90)", "(1200, 1500, 0, 45)"]);
    let error = said_as(&scratch, "stderr").pop().unwrap_or_default();
    assert!(error.starts_with("TypeError: ") && error.ends_with(": it is `VWTurn(angle, ang_speed)`"), "{error}");
}

#[test]
fn what_python_2_wrote_is_answered_by_what_python_3_writes() {
    if !has_python() {
        return;
    }
    let programs = [
        ("raw_input('go')", "it belongs to Python 2: Python 3 writes `input`"),
        ("for i in xrange(4): pass", "it belongs to Python 2: Python 3 writes `range`"),
        ("import Queue", "write `import queue`"),
        ("try:\n    pass\nexcept ValueError, error:\n    pass", "Python 3 writes `except ValueError as error:`"),
        ("raise ValueError, 'no wall'", "Python 3 writes `raise ValueError('no wall')`"),
        ("print(\u{201C}go\u{201D})", "`\u{201C}` comes from a page or a word processor: write `\"`"),
    ];
    let names: Vec<String> = (0..programs.len()).map(|index| format!("p{index}.py")).collect();
    let scratch = Scratch::new();
    write_scene(&scratch, &names.iter().map(String::as_str).collect::<Vec<_>>());
    for (name, (program, _)) in names.iter().zip(programs) {
        scratch.write(name, &format!("from eye import *\n{program}\n"));
    }
    let report = scratch.report("scene.sim", &["--api", "7"], 1);
    for (index, (program, advice)) in programs.iter().enumerate() {
        let reason = report["robots"][index]["reason"].as_str().unwrap_or_default();
        assert!(reason.contains(advice), "{program}: {reason}");
    }
}

#[test]
fn a_file_that_open_does_not_find_is_reported_with_its_folder_and_name() {
    if !has_python() {
        return;
    }
    let scratch = Scratch::new();
    scratch.write("lab/a.sim", "world %sim%/worlds/empty.wld\nS4 500 500 0 a.py\n");
    scratch.write("lab/map.txt", "1\n");
    scratch.write("maps/map.txt", "1\n");
    let here = scratch.path().canonicalize().expect("the folder").display().to_string();
    let place = format!("relative paths begin in `{here}`, the folder in which eyesim runs");
    let beside = "write `lab/map.txt`, which is beside the program";
    for (path, advice) in [
        ("gone.txt", place.clone()),
        ("map.txt", format!("{place}; {beside}")),
        ("data/map.txt", format!("{place}; {beside}")),
        ("/no/map.txt", beside.to_owned()),
        (r"maps\\map.txt", "`/` stands between folders, not a backslash: write `maps/map.txt`".to_owned()),
        (
            r"..\\maps\\gone.txt",
            format!(
                "`/` stands between folders, not a backslash: write `../maps/gone.txt`; relative paths begin in `{here}`, the folder in which eyesim runs"
            ),
        ),
        (
            r"d\t.txt",
            format!(
                "`/` stands between folders, not a backslash: write `d/t.txt`; relative paths begin in `{here}`, the folder in which eyesim runs"
            ),
        ),
        (r"C:\\eyesim\\maps\\map.txt", "there is no drive `C:` here: write `maps/map.txt`".to_owned()),
        ("D:/x/map.txt", format!("there is no drive `D:` here: {beside}")),
        (
            "D:/x/gone.txt",
            format!("there is no drive `D:` here: write a path from `{here}`, the folder in which eyesim runs"),
        ),
    ] {
        scratch.write("lab/a.py", &format!("open('{path}')\n"));
        let ran = scratch.eyesim(&["run", "lab/a.sim"]);
        let line = ran.stderr.lines().find(|line| line.contains("FileNotFoundError: ")).unwrap_or_default();
        assert!(line.ends_with(&format!("': {advice}")), "{path}: {ran:#?}");
    }
}

/// Waits for input of all kinds while another thread works.
const WAITER: &str = r#"
import threading
from eye import *

print(LIDAR_RESOLUTION)
SERInit(1, 10000, 0)
count = 0

def work():
    global count
    for step in range(35):
        OSWait(100)
        count += 1
    SERSendChar(1, ord("x"))
    OSWait(100)
    count += 1

thread = threading.Thread(target=work)
thread.start()
for wait in (lambda: KEYWait(KEY4), KEYGetXY, lambda: OSError("stuck", 3, 0), lambda: chr(SERReceiveChar(1))):
    print(wait(), count, OSGetCount() // 100)
print(SERReceiveChar(2), RADIOReceive(), count)
thread.join()
KEYGet()
"#;

#[test]
fn threads_run_while_another_waits_for_any_input() {
    if !has_python() {
        return;
    }
    let scratch = scratch(&["a.py"]);
    scratch.write("a.py", WAITER);
    let robi = "name Bare\ndiameter 180\nspeed 600\nturn 300\nwheel 54 3600 1100 90\n\
                drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\nlidar 720 0\n";
    scratch.write("bare.robi", robi);
    scratch.write("bare.toml", "[serial]\n1 = \"loopback\"\n");
    scratch.write("a.sim", "world room.wld\nrobi bare.robi a.py 1000 1000 0\n");
    let keys = "0.5:KEY1, 1.05:KEY4, 2.05:TOUCH(10,20), 3.05:KEY2";
    let lines = said(&scratch, &["--keys", keys], 1);
    assert_eq!(lines, ["720", "8 10 10", "(10, 20) 20 20", "0 30 30", "x 35 35", "0 (0, '') 35"]);
    // At the end no thread can press a key.
    let reason = &scratch.report("a.sim", &["--keys", keys], 1)["robots"][0]["reason"];
    assert!(reason.as_str().is_some_and(|reason| reason.starts_with("waits for any key")), "{reason}");
}

/// Passes output arguments to calls that fail, and sizes and texts that C accepts.
const ARGUMENTS: &str = r#"
from ctypes import c_int, create_string_buffer
from eye import *

x, y, name = c_int(7), c_int(7), create_string_buffer(b"old", 8)
print(SERVOGet(99), SIMGetObject(99, x, y, c_int(7)), x.value, y.value, SIMGetObject(99))
print(SERReceive(1, name), name.value)
print(IPSetSize(CUSTOM, 6000, 6000), IP_WIDTH, IPSetSize(CUSTOM, 0, 5), CAMInit(CUSTOM, -1, 10))
print(IPReadFile("a.ppm"))
RADIOInit()
print(RADIOSend(0, "hello", 100), lib.LCDSetPrintf(1, 2, b"x"), lib.LIDARSet(180, 0, 90, 1, 2), LIDAR_RESOLUTION)
"#;

#[test]
fn arguments_that_a_call_does_not_set_stay_as_in_c() {
    if !has_python() {
        return;
    }
    let scratch = scratch(&["a.py"]);
    scratch.write("a.py", ARGUMENTS);
    let expected = ["-1 None 7 7 (0, 0, 0)", "0 b'old'", "1 320 1 1", "None", "0 0 0 360"];
    assert_eq!(said(&scratch, &[], 0), expected);
}

#[test]
fn only_turns_by_a_part_of_pi_are_taken_for_radians() {
    if !has_python() {
        return;
    }
    let scratch = scratch(&["a.py"]);
    let hints = |calls: &str| {
        scratch.write("a.py", &format!("from eye import *\nimport math\n{calls}VWWait()\n"));
        let ran = scratch.eyesim(&["run", "a.sim"]);
        assert_eq!(ran.code, Some(0), "{ran:#?}");
        ran.stderr.lines().filter(|line| line.contains("not radians")).count()
    };
    for radians in ["VWTurn(math.pi / 2, 1)\n", "VWTurn(1.57, 1)\nVWTurn(3.14, 1)\n", "VWTurn(-4.71, 3)\n"] {
        assert_eq!(hints(radians), 1, "{radians}");
    }
    for degrees in
        ["VWTurn(3, 3)\n", "VWTurn(2.5, 5)\n", "VWTurn(5.5, 1.57)\n", "for i in range(5): VWTurn(3, 3); VWWait()\n"]
    {
        assert_eq!(hints(degrees), 0, "{degrees}");
    }
    assert_eq!(hints("for i in range(4): VWStraight(100, 100); VWWait(); VWTurn(2, 1); VWWait()\n"), 1);
}
