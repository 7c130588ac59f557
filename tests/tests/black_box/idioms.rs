//! Idioms of programs from the field, each in a small program of its own, with the expected output.

use tests::{Scratch, write_scene};

/// Name of the program, its text, and the lines that it prints.
const IDIOMS: &[(&str, &str, &[&str])] = &[
    (
        "event-loop.py",
        "import asyncio\nfrom eye import *\nasync def drive():\n    VWStraight(100, 100)\n    while not VWDone():\n        \
         await asyncio.sleep(0.05)\n    return VWGetPosition()\nasync def tick():\n    await asyncio.sleep(0.5)\n    \
         return OSGetCount() // 100\nasync def main():\n    print(await asyncio.gather(drive(), tick()))\nasyncio.run(main())\n",
        &["[(100, 0, 0), 5]"],
    ),
    (
        "time-limits.py",
        "import queue, threading, time\nfrom eye import *\ndef now():\n    return round(time.time(), 1)\n\
         print(threading.Event().wait(0.5), now())\ntry:\n    queue.Queue().get(timeout=0.5)\nexcept queue.Empty:\n    \
         print('empty', now())\nfired = threading.Event()\nthreading.Timer(1.0, lambda: (print('fired', now()), fired.set())).start()\n\
         VWStraight(200, 100)\nVWWait()\nprint(fired.is_set(), fired.wait(5), VWGetPosition())\n",
        &["False 0.5", "empty 1.0", "fired 2.0", "True True (200, 0, 0)"],
    ),
    (
        "copies.py",
        "import copy, pickle\nfrom eye import *\nCAMInit(QQVGA)\nfor own in (VWGetPosition(), CAMGet(), SIMGetObject(2), PSDGet(1), LIDARGet()):\n    \
         for other in (pickle.loads(pickle.dumps(own)), copy.copy(own), copy.deepcopy(own)):\n        \
         assert other == own and type(other) is type(own), other\nx, y, z, phi = copy.copy(SIMGetObject(2))\nprint(x, y, z, phi)\n",
        &["3000 3000 0 0"],
    ),
    (
        "right-angle.c",
        "#include \"eyebot.h\"\nint main()\n{\n    VWHandle vw = VWInit(VW_DRIVE, 1); PositionType pos;\n    \
         VWDriveTurn(vw, M_PI / 2, 1.0);\n    VWDriveWait(vw);\n    VWGetPosition(vw, &pos);\n    printf(\"%.2f\\n\", pos.phi);\n    return 0;\n}\n",
        &["1.57"],
    ),
    (
        "truth.c",
        "#include \"librobi/librobi.h\"\nBOOL done(int n) { return n > 2 ? TRUE : FALSE; }\nint main()\n{ int n = 0;\n  \
         while (done(n) == FALSE) { VWStraight(50, 100); VWWait(); n++; }\n  printf(\"%d\\n\", n);\n}\n",
        &["3"],
    ),
    (
        "own-truth.c",
        "#include \"eyebot.h\"\ntypedef enum { FALSE, TRUE } BOOL;\nBOOL far(psd) int psd; { return PSDGet(psd) > 100; }\n\
         main() { printf(\"%d %d\\n\", far(PSD_FRONT), strcmp(\"a\", \"a\")); }\n",
        &["1 0"],
    ),
    (
        "old-names6.c",
        "#include \"eyebot.h\"\nTIMER tick;\nint main()\n{ VWHandle vw = VWInit(VW_DRIVE, 1); LCDPutChar(NL); OSWait(CAMWAIT);\n  \
         printf(\"%d %d %d\\n\", SERVO16 - SERVO13, SERVOInit(SERVO13), tick); return vw == 0; }\n",
        &["-3 0 0"],
    ),
    (
        "old-names7.cpp",
        "#include \"eyebot.h\"\n#include <cstdio>\nTimerHandle timer;\nint main()\n{ keycode_t key = KEYRead(); VWStraight(10, 100);\n  \
         printf(\"%d %d %d %d\\n\", SERInit(1, 9600, NONE), RTSCTS, (int)key, (int)timer); }\n",
        &["0 1 0 0"],
    ),
    (
        "algorithm.cpp",
        "#include \"eyebot.h\"\n#include <cstdio>\nusing namespace std;\nint main()\n{ int d[3] = {3, 1, 2}; VWStraight(10, 100);\n  \
         sort(d, d + 3); printf(\"%d %d %d\\n\", d[0], std::max(d[1], 7), std::accumulate(d, d + 3, 0)); }\n",
        &["1 7 6"],
    ),
    (
        "own-none.c",
        "#include \"eyebot.h\"\nenum { FORWARD = 3, NONE, NL };\nint main() { VWStraight(10, 100); printf(\"%d %d %d\\n\", NONE, NL, TRUE); return 0; }\n",
        &["4 5 1"],
    ),
    (
        "single-keys.c",
        "#include <stdio.h>\n#include <termios.h>\n#include <unistd.h>\n#include \"eyebot.h\"\nint getch(void)\n{\n    \
         struct termios old, raw; int c;\n    if (tcgetattr(STDIN_FILENO, &old)) return -2;\n    raw = old; raw.c_lflag &= ~(ICANON | ECHO);\n    \
         tcsetattr(STDIN_FILENO, TCSANOW, &raw); c = getchar(); tcsetattr(STDIN_FILENO, TCSANOW, &old);\n    return c;\n}\n\
         int main() { printf(\"%d\\n\", getch()); return 0; }\n",
        &["-1"],
    ),
    (
        "clock.py",
        "import time\nfrom eye import *\nstart = time.time()\nwhile time.time() - start < 3:\n    pass\nprint(round(time.time() - start, 2))\n",
        &["3.0"],
    ),
    (
        "locks.py",
        "import threading, time\nfrom eye import *\ndef now():\n    return round(time.time(), 1)\nlock = threading.Lock()\nlock.acquire()\n\
         print(lock.acquire(timeout=0.5), lock.acquire(blocking=False), lock.locked(), now())\nthreading.Timer(0.5, lock.release).start()\n\
         print(lock.acquire(timeout=5), now())\nt = threading.Thread(target=lambda: time.sleep(2))\nt.start()\nt.join(timeout=0.5)\n\
         print(t.is_alive(), now())\nt.join()\nprint(t.is_alive(), now())\nprint(threading.Semaphore(0).acquire(timeout=0.5), now())\n\
         try:\n    threading.Barrier(2, timeout=0.5).wait()\nexcept threading.BrokenBarrierError:\n    print('broken', now())\n\
         barrier = threading.Barrier(2)\nthreading.Timer(0.5, barrier.wait).start()\nbarrier.wait()\nprint('met', now())\n\
         again = threading.RLock()\nwith again, again:\n    print(again.acquire(timeout=1), again.acquire(False))\n\
         held = threading.Thread(target=lambda: print(again.acquire(timeout=0.5), now()))\nagain.acquire()\nheld.start()\nheld.join()\n",
        &[
            "False False True 0.5",
            "True 1.0",
            "True 1.5",
            "False 3.0",
            "False 3.5",
            "broken 4.0",
            "met 4.5",
            "True True",
            "False 5.0",
        ],
    ),
];

#[test]
fn programs_with_common_idioms_print_what_they_intend() {
    let python = std::env::var("PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let has_python =
        std::process::Command::new(&python).arg("--version").output().is_ok_and(|out| out.status.success());
    for (name, text, lines) in IDIOMS {
        if name.ends_with(".py") && !has_python {
            println!("skipped {name}: there is no `{python}`");
            continue;
        }
        let scratch = Scratch::new();
        write_scene(&scratch, &[]);
        scratch.write(name, text);
        let lines_7 = format!("S4 1000 1000 0 {name}\ncan 3000 3000 0\n");
        let lines_6 = format!("robi bot.robi {name} 1000 1000 0\n");
        let is_classic = text.contains("VWInit");
        scratch.write("my.sim", &format!("world room.wld\n{}", if is_classic { lines_6 } else { lines_7 }));
        let ran = scratch.eyesim(&["run", "my.sim", "--until", "60", "--trace", "t.jsonl"]);
        assert_eq!(ran.code, Some(0), "{name}: {ran:#?}");
        let trace = scratch.trace("t.jsonl");
        let said = trace
            .iter()
            .filter(|event| event["event"] == "stdout")
            .map(|event| event["text"].as_str().expect("text").trim());
        assert_eq!(said.collect::<Vec<_>>(), *lines, "{name}: {ran:#?}");
    }
}
