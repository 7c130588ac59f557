//! Uses of the RoBIOS-7 headers and of `eye.py` that involve several names: all types of results, threads, long
//! imports, headers of other years, collisions of names, C++ standards, generations. `names.rs` tests each name by
//! itself.

use serde_json::Value;
use tests::{Ran, Scratch};

fn run(files: &[(&str, &str)], robot: &str, args: &[&str]) -> (Scratch, Ran) {
    let scratch = Scratch::new();
    files.iter().for_each(|(name, text)| drop(scratch.write(name, text)));
    scratch.write("room.wld", "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n");
    scratch.write("a.sim", &format!("world room.wld\nS4 1000 1000 0 {robot}\ncan 3000 3000 0\n"));
    let presses: Vec<String> =
        (1..40).map(|second| format!("{second}:KEY1, {second}.2:TOUCH(100,100), {second}.4:IRTV_OK")).collect();
    let keys = presses.join(", ");
    let ran = scratch.eyesim(&[&["run", "a.sim", "--keys", keys.as_str(), "--until", "120"], args].concat());
    (scratch, ran)
}

fn has(command: &str, code: &str) -> bool {
    let has = std::process::Command::new(command).args(["-c", code]).output().is_ok_and(|out| out.status.success());
    if !has {
        println!("skipped: `{command}` cannot run `{code}`");
    }
    has
}

#[test]
fn results_serve_as_numbers_as_values_of_ctypes_and_as_arrays() {
    if !has("python3", "pass") {
        return;
    }
    let program = r#"
from eye import lib
from eye import *
x, y, z, phi = SIMGetRobot(1)
assert (x.value, x) == (1000, 1000) and VWGetPosition() == (0, 0, 0) == tuple(VWGetPosition())
assert "%d %d %d" % VWGetPosition() == "0 0 0" and VWGetPosition() == [0, 0, 0]
own = VWGetPosition(); own[2] += 90; assert own == (0, 0, 90) and "%d %d %d" % own == "0 0 90"
x, y, phi = SIMGetObject(2); assert (x, y, phi) == (3000, 3000, 0)
x, y, z, phi = SIMGetObject(2); assert (x, y, z, phi.value) == (3000, 3000, 0, 0)
a, b, c = c_int(7), c_int(7), ctypes.c_int(7)
assert VWGetPosition(a, byref(b), pointer(c)) == 0 and (a.value, b.value, c.value) == (0, 0, 0)
buf = ctypes.create_string_buffer(32); assert OSVersion(buf) == 0 and buf.value == b"1.0" and OSVersion("") == "1.0"
CAMInit(QQVGA); img = CAMGet(); LCDImageStart(0, 0, QQVGA_X, QQVGA_Y)
p = ctypes.cast(img, POINTER(c_byte)); assert p[0] & 255 == img[0] == bytes(img)[0] and img[0:3] == list(img)[0:3]
for use in (img, p, byref(img), pointer(img), bytes(img), bytearray(img), list(img), memoryview(img)):
    LCDClear(); LCDImage(use); assert LCDGetPixel(3, 3) == IPPRGB2Col(*img[3 * 483 : 3 * 483 + 3]), use
for bad in (b"short", (c_byte * 100)(), 5):
    try:
        LCDImage(bad); assert False
    except (ValueError, TypeError) as error:
        assert "LCDImage" in str(error)
assert IPWriteFile("b.ppm", img) == 0 and len(IPReadFile("b.ppm")) == QVGA_SIZE // 4
result, again = IPReadFile("b.ppm"); assert result == 6 and again == img
LCDPrintf("text\n", ""); LCDPrintf("100%\n"); LCDPrintf("%d%%\n", c_int(5)); assert LCDGetPos() == (3, 0)
RADIOInit(); number, ids = RADIOStatus(); assert number == 1 and ids[0] == 1 and len(RADIOStatus()) == 1
SIMSetRobot(1500, 1200, 0, 90); assert SIMGetRobot(0) == (1500, 1200, 0, 90)
assert ctypes.CDLL("libeyesim.so") is lib and lib.PSDGet(c_int(1)) == PSDGet(PSD_FRONT) and KEYWait != ANYKEY
assert ctypes.cast(LIDARGet(), POINTER(c_int))[180] == LIDARGet()[180] == min(LIDARGet()[170:190])
print("all well")
"#;
    let (_, ran) = run(&[("a.py", program)], "a.py", &[]);
    assert!(ran.stdout.contains("all well"), "{ran:#?}");
}

#[test]
fn output_of_threads_is_not_lost() {
    if !has("python3", "pass") {
        return;
    }
    let program = "import threading, time\nfrom eye import *\n\
        def work(name):\n    for i in range(3):\n        print(name, i)\n        time.sleep(0.5)\n    OSWait(100)\n    print(name, end=' rest')\n\
        threads = [threading.Thread(target=work, args=(name,)) for name in 'ab']\n\
        [thread.start() for thread in threads]\nVWStraight(100, 100)\nVWWait()\nprint('main')\n";
    let (_, ran) = run(&[("a.py", program)], "a.py", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    for said in ["a 0", "a 2", "b 2", "main", "a rest", "b rest"] {
        assert!(ran.stdout.contains(&format!("] {said}\n")), "{said}: {ran:#?}");
    }
}

/// Threads that share a queue and a lock, a pool of threads, threads of asyncio, one that a timer starts, one that
/// waits outside of Python's locks, and a loop that waits for a variable.
const THREADS: &str = r#"
import asyncio, os, queue, random, threading, time
from concurrent.futures import ThreadPoolExecutor
from eye import *
jobs, done, lock = queue.Queue(3), queue.SimpleQueue(), threading.RLock()
def produce(name):
    for number in range(5):
        jobs.put((name, number, PSDGet(1)))
        OSWait(random.randrange(30))
    done.put(name)
def consume():
    for name, number, distance in iter(jobs.get, None):
        with lock, lock:
            print(name, number, distance, OSGetCount())
            OSWait(5)
producers = [threading.Thread(target=produce, args=(name,)) for name in "abc"]
consumers = [threading.Thread(target=consume) for _ in range(2)]
[thread.start() for thread in producers + consumers]
VWStraight(200, 100)
VWWait()
[thread.join() for thread in producers]
jobs.put(None), jobs.put(None)
[thread.join() for thread in consumers]
print([done.get() for _ in range(3)], [thread.is_alive() for thread in consumers])
with ThreadPoolExecutor(3) as pool:
    start = OSGetCount()
    print(list(pool.map(lambda ms: (OSWait(ms), OSGetCount() - start)[1], [30, 10, 20])))
async def gather():
    loop, start = asyncio.get_running_loop(), OSGetCount()
    await asyncio.gather(loop.run_in_executor(None, OSWait, 50), asyncio.sleep(0.1), loop.run_in_executor(None, time.sleep, 0.3))
    print("gathered", OSGetCount() - start)
asyncio.run(gather())
reader, writer = os.pipe()
outside = threading.Thread(target=lambda: print("read", os.read(reader, 1)))
outside.start()
OSWait(100)
os.write(writer, b"x")
outside.join()
is_set = False
def set_it():
    global is_set
    OSWait(100)
    is_set = True
threading.Thread(target=set_it).start()
while not is_set:
    pass
ticks = 0
def tick():
    global ticks
    ticks += 1
    if ticks == 3:
        threading.Thread(target=print, args=("tick", 3)).start()
timer = OSAttachTimer(20, tick)
OSWait(200)
OSDetachTimer(timer)
def fail():
    raise ValueError
timer = OSAttachTimer(20, fail)
try:
    threading.Event().wait(1)
except ValueError:
    print("raised in the main thread", threading.current_thread() is threading.main_thread())
OSDetachTimer(timer)
def spin():
    while True:
        OSWait(1)
threading.Thread(target=spin, daemon=True).start()
ThreadPoolExecutor(2).submit(lambda: (OSWait(100), print("last")))
"#;

#[test]
fn threads_of_python_call_in_the_same_order_in_each_run() {
    if !has("python3", "pass") {
        return;
    }
    let ran = [(); 2].map(|()| run(&[("a.py", THREADS)], "a.py", &[]).1);
    assert_eq!(ran[0].code, Some(0), "{ran:#?}");
    let digest = |ran: &Ran| ran.stdout.lines().find(|line| line.starts_with("digest ")).expect("a digest").to_owned();
    assert_eq!(digest(&ran[0]), digest(&ran[1]), "{ran:#?}");
    for said in [
        "['a', 'b', 'c'] [False, False]",
        "[30, 10, 20]",
        "gathered 300",
        "read b'x'",
        "tick 3",
        "raised in the main thread True",
        "last",
    ] {
        assert!(ran[0].stdout.contains(&format!("] {said}\n")), "{said}: {ran:#?}");
    }
}

#[test]
fn a_thread_of_python_that_polls_without_a_call_is_reported() {
    if !has("python3", "pass") {
        return;
    }
    let program = "import queue, threading\nfrom eye import *\njobs = queue.Queue()\n\
        threading.Thread(target=lambda: (OSWait(50), jobs.put(1))).start()\n\
        def take():\n    while True:\n        try:\n            return jobs.get_nowait()\n        except queue.Empty:\n            pass\n\
        print('took', take())\n";
    let (_, ran) = run(&[("a.py", program)], "a.py", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stdout.contains("] took 1\n"), "{ran:#?}");
    let hint = "hint: this thread has run for 0.2 s of processor time without a call;";
    assert_eq!(ran.stderr.matches(hint).count(), 1, "{ran:#?}");
}

#[test]
fn threads_of_python_that_wait_for_each_other_are_reported() {
    if !has("python3", "pass") {
        return;
    }
    let program = "import threading\nfrom eye import *\na, b = threading.Lock(), threading.Lock()\n\
        def crossed():\n    with b:\n        OSWait(10)\n        a.acquire()\nthreading.Thread(target=crossed).start()\n\
        with a:\n    OSWait(10)\n    b.acquire()\n";
    let (_, ran) = run(&[("a.py", program)], "a.py", &["--timeout", "2"]);
    assert!(ran.stdout.contains("too long without a RoBIOS call at a.py:11"), "{ran:#?}");
}

#[test]
fn a_slow_import_is_not_an_endless_loop() {
    if !has("python3", "pass") {
        return;
    }
    let heavy = "import os\ndef burn(seconds):\n    end = sum(os.times()[:2]) + seconds\n    \
                 while sum(os.times()[:2]) < end:\n        pass\nburn(2.5)\n";
    let program = "from eye import *\nprint('begins')\nimport heavy\nprint('imported')\nheavy.burn(30)\n";
    let (scratch, ran) =
        run(&[("a.py", program), ("heavy.py", heavy)], "a.py", &["--timeout", "1", "--report", "r.json"]);
    assert!(ran.stdout.contains("imported"), "{ran:#?}");
    let report: Value = serde_json::from_str(&scratch.read("r.json")).expect("a report");
    assert_eq!(report["robots"][0]["outcome"], "timeout", "what it does afterwards is: {report:#}");
}

#[test]
fn eyesims_headers_replace_headers_of_another_year_beside_a_program() {
    let header = "#ifndef EYEBOT_H_\n#define EYEBOT_H_\n#include \"types.h\"\nint VWStraight(float m);\nint LCDClear(void);\n#endif\n";
    let types = "#include <X11/NoSuch.h>\n#define QVGA_X 1\n#define QVGA_Y 1\n#define QVGA_SIZE 3\n#define KEY_LIST1 1\n#define KEY_LIST2 2\n\
                 #define KEY_LIST3 3\n#define IRTV_OK 1\n#define IRTV_UP 2\n#define LCD_SCROLLING 3\n";
    let program = "#include \"eyebot.h\"\n#include \"own.h\"\nint main(void) { VWStraight(100, 100); VWWait(); printf(\"%s %d\\n\", __FILE__, OWN); return 0; }\n";
    let files = [("a.c", program), ("eyebot.h", header), ("types.h", types), ("own.h", "#define OWN 42\n")];
    let (_, ran) = run(&files, "a.c", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stdout.contains("] a.c 42"), "{ran:#?}");
    let said = "`eyebot.h`, `types.h` beside the program is RoBIOS's own: eyesim's is used instead";
    assert!(ran.stderr.contains(said), "{ran:#?}");
    // A wrapper of the simulator's header, and types that the program defines itself, stay in use.
    let wrapper = "#include_next <eyebot.h>\nstatic inline int go(void) { return VWStraight(100, 100); }\n";
    let program =
        "#include \"eyebot.h\"\n#include \"types.h\"\nint main(void) { Cell c = go(); VWWait(); return c; }\n";
    let files = [("a.c", program), ("eyebot.h", wrapper), ("types.h", "typedef int Cell;\n")];
    let (_, ran) = run(&files, "a.c", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(!ran.stderr.contains("RoBIOS's own"), "{ran:#?}");
    // A header whose functions take other values than the simulator's is used with a warning.
    let header = "int VWDriveStraight(int distance, int speed);\nint VWDriveWait(void);\n";
    let program = "#include \"eyebot.h\"\nint main(void) { VWDriveStraight(300, 100); VWDriveWait(); return 0; }\n";
    let (_, ran) = run(&[("a.c", program), ("eyebot.h", header)], "a.c", &[]);
    assert!(ran.stderr.contains("`eyebot.h` beside the program is used, and may differ"), "{ran:#?}");
}

#[test]
fn functions_without_a_declaration_receive_converted_arguments() {
    let program = "void f(float s) { sleep(s); }\nint main(void) { f(18.0f); VWStraight(100.7, 100.2); VWWait(); OSWait(0.5 + sqrt(4.0)); return 0; }\n";
    let (_, ran) = run(&[("a.c", program)], "a.c", &["--report", "r.json"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stderr.contains("the headers that declare `sleep`"), "{ran:#?}");
    assert!(ran.stdout.contains("19.") || ran.stdout.contains("20."), "18 s and a drive: {ran:#?}");
}

#[test]
fn names_that_collide_with_what_the_headers_bring_stay_the_programs_own() {
    let program = "#include \"eyebot.h\"\nint y1 = 3;\nvoid pause(int ms) { OSWait(ms); }\nint main(void) { pause(y1); VWWait(); return 0; }\n";
    let (_, ran) = run(&[("a.c", program)], "a.c", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
}

#[test]
fn cpp_is_compiled_in_the_newest_standard_or_in_that_of_its_time() {
    let new = "#include \"eyebot++.h\"\n#include <concepts>\ntemplate <std::integral T> T twice(T x) { return 2 * x; }\n\
               int main() { VWStraight(twice(50), 100); VWWait(); }\n";
    let (_, ran) = run(&[("a.cpp", new)], "a.cpp", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    let old = "#include \"eyebot++.h\"\nint main() { int concept = 1, requires = 2; VWStraight(concept + requires, 100); VWWait(); }\n";
    let (_, ran) = run(&[("a.cpp", old)], "a.cpp", &[]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
}

#[test]
fn a_program_that_compiles_for_one_generation_only_has_that_generation() {
    // Both generations have `OSVersion`, but these statements compile only for RoBIOS-7.
    let program = "#include \"eyebot.h\"\nint main(void) { char text[32]; BYTE grey[9]; COLOR red = 3; OSVersion(text); return red == 4 && grey[0]; }\n";
    let (scratch, _) = run(&[("a.c", program)], "a.c", &[]);
    scratch.write("classic.sim", "world room.wld\nrobi %sim%/robis/scout.robi a.c 1000 1000 0\n");
    scratch.write("a.c", &format!("{program}\n/* new */\n"));
    let ran = scratch.eyesim(&["run", "classic.sim"]);
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stderr.contains("a.c: RoBIOS-7, as it does not compile for RoBIOS 6"), "{ran:#?}");
}
