//! RoBIOS-7 in programs: every function of its header and of older headers, images, files, serial lines and timers.

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::process::Command;

use robios_sys::Robios7Call;
use tests::{Scratch, root};

const ROOM: &str = "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n";
/// A robi file with the minimum that the format requires: a drive.
const BARE: &str = "name Bare\ndiameter 180\nspeed 600\nturn 300\nwheel 54 3600 1100 90\n\
                    drive DIFFERENTIAL_DRIVE MOTOR_LEFT QUAD_LEFT MOTOR_RIGHT QUAD_RIGHT\n";

fn fixture(name: &str) -> PathBuf {
    root().join("tests/fixtures").join(name)
}

fn text_of(name: &str) -> String {
    std::fs::read_to_string(fixture(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Writes a scene with a can and one robot without sensors that runs `program`, in the file `name`.
fn bare(name: &str, program: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("room.wld", ROOM);
    scratch.write("bare.robi", BARE);
    scratch.write(name, program);
    scratch.write("bare.sim", &format!("world room.wld\nrobi bare.robi {name} 1000 1000 0\ncan 3000 3000 0\n"));
    scratch
}

/// Like [`bare`], with a C program whose `main` has this body and returns 0.
fn scene_of(body: &str) -> Scratch {
    bare("main.c", &program_of(body))
}

fn program_of(body: &str) -> String {
    format!("#include \"eyebot.h\"\n\n{body}\n")
}

/// Output of robot 1, and the messages, of a run that ends with the exit code `code`.
fn printed(scratch: &Scratch, args: &[&str], code: i32) -> (Vec<String>, String) {
    let ran = scratch.eyesim(&[&["run", "bare.sim", "--trace", "trace.jsonl"], args].concat());
    let lines = scratch
        .trace("trace.jsonl")
        .iter()
        .filter(|line| line["event"] == "stdout")
        .map(|line| line["text"].as_str().unwrap_or_default().to_owned())
        .collect();
    assert_eq!(ran.code, Some(code), "{lines:#?}\n{}", ran.stderr);
    (lines, ran.stderr)
}

const KEYS: &str = "0:KEY1, 0:KEY2, 0:KEY3, 0:TOUCH(10,20), 1:KEY4, 0:IRTV_OK, 0:IRTV_5";

/// Runs the program that calls every function. Each call must return the result for a robot without devices, and take
/// virtual time.
fn call_every_function(name: &str) {
    let scratch = bare(name, &text_of("every-function.c"));
    let (lines, _) = printed(&scratch, &["--keys", KEYS], 0);
    assert!(lines.last().is_some_and(|line| line.ends_with(" 0 failures")), "{lines:#?}");
    // Runs it again with a cost of 1 ms for each call, the unit of the times in the log of calls.
    scratch.write("costs.toml", "[robios7]\n\"*\" = 1000\n");
    let ran = scratch.eyesim(&["run", "bare.sim", "--keys", KEYS, "--costs", "costs.toml", "-v"]);
    let mut called = BTreeSet::new();
    let mut last = 0.0;
    for line in ran.stderr.lines() {
        let call = line.strip_prefix("[r1 ").and_then(|rest| rest.split_once(" s] "));
        let call = call.and_then(|(time, call)| Some((time.parse::<f64>().ok()?, call.split_once('(')?.0)));
        let Some((end, function)) = call.filter(|(_, function)| Robios7Call::from_name(function).is_some()) else {
            continue;
        };
        assert!(end > last, "{line}: takes no virtual time");
        last = end;
        called.insert(function.to_owned());
    }
    let missing: Vec<&str> =
        Robios7Call::ALL.iter().map(|call| call.name()).filter(|call| !called.contains(*call)).collect();
    assert_eq!(missing, [""; 0], "of {} functions", Robios7Call::ALL.len());
}

#[test]
fn every_function_answers_and_takes_time_in_c() {
    call_every_function("every.c");
}

#[test]
fn every_function_answers_and_takes_time_in_cpp() {
    call_every_function("every.cpp");
}

#[test]
fn variants_of_older_headers_work() {
    for name in ["variants.c", "variants.cpp"] {
        let (lines, _) = printed(&bare(name, &text_of("variants.c")), &[], 0);
        assert_eq!(lines, [""; 0], "{name}");
    }
}

#[test]
fn fixtures_compile_without_a_warning() {
    let scratch = Scratch::new();
    tests::write_headers(scratch.path(), robios_sys::c::HEADERS7);
    for name in ["every-function.c", "variants.c", "course.c"] {
        for (compiler, language, standard) in [("cc", "c", "-std=gnu17"), ("c++", "c++", "-std=c++17")] {
            let mut command = Command::new(compiler);
            command.args(["-Wall", "-Wextra", "-Werror", "-fsyntax-only", standard, "-x", language]);
            command.arg("-I").arg(scratch.path()).arg(fixture(name));
            let output = command.output().expect("a compiler");
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        }
    }
}

#[test]
fn a_program_of_the_university_course_runs() {
    let scratch = Scratch::new();
    scratch.write("room.wld", ROOM);
    scratch.write("course.c", &text_of("course.c"));
    scratch.write("bare.sim", "world room.wld\nS4 1000 2000 0 course.c\n");
    let (lines, messages) = printed(&scratch, &["--keys", "1:KEY1, 2:KEY2, 3:KEY3, 30:KEY4"], 0);
    assert!(!messages.contains("warning"), "{messages}");
    // The front PSD is 60 mm ahead of the robot's centre, and the scanner is at the centre.
    assert_eq!(
        lines[..2],
        ["scan: 360 points, ahead 3000 mm, nearest 1000 mm at -1000/0", "edge: kind P5, 400 edge pixels"]
    );
    assert!(
        lines[2].starts_with("wall: stopped ") && lines[2].ends_with(" mm before it after many steps"),
        "{lines:#?}"
    );
    assert_eq!(lines[4], "timer: on time");
    assert!(lines[5].ends_with(", 0 failures"), "{lines:#?}");
}

#[test]
fn a_timer_at_1_khz_leaves_waits_as_they_are() {
    let scratch = scene_of(
        "static int ticks;
        static void tick(void) { ticks++; }
        static void look(void) { ticks++; PSDGet(1); }
        int main(void)
        {
            int start = OSGetCount();
            TIMER timer = OSAttachTimer(1, tick);
            OSWait(1000);
            printf(\"%d ms, %d ticks\\n\", OSGetCount() - start, ticks);
            OSDetachTimer(timer);
            /* A callback that takes 1 ms: the timer skips every other tick. */
            ticks = 0;
            start = OSGetCount();
            timer = OSAttachTimer(1, look);
            OSWait(1000);
            printf(\"%d ms, %d ticks\\n\", OSGetCount() - start, ticks);
            /* A call's own work makes progress between the callbacks. */
            start = OSGetCount();
            LCDClear();
            CAMGetGray(NULL);
            printf(\"%s\\n\", OSGetCount() - start < 200 ? \"goes on\" : \"starves\");
            OSDetachTimer(timer);
            ticks = 0;
            OSAttachTimer(250, tick);
            OSWait(1001);
            printf(\"%d ticks\\n\", ticks);
            return 0;
        }",
    );
    let (lines, _) = printed(&scratch, &[], 0);
    assert_eq!(lines, ["1000 ms, 1000 ticks", "1000 ms, 500 ticks", "goes on", "4 ticks"]);
}

#[test]
fn a_timer_that_another_timer_detaches_does_not_run() {
    let scratch = scene_of(
        "static TIMER second;
        static int count;
        static void detach(void) { OSDetachTimer(second); }
        static void add(void) { count++; }
        int main(void)
        {
            OSAttachTimer(10, detach);
            second = OSAttachTimer(10, add);
            OSWait(50);
            printf(\"%d\\n\", count);
            return 0;
        }",
    );
    assert_eq!(printed(&scratch, &[], 0).0, ["0"]);
}

#[test]
fn every_line_of_a_list_has_a_key() {
    let scratch = scene_of(
        "int main(void)
        {
            static menuitem_t items[10];
            listmenu_t list = {\"Choose\", WHITE, BLUE};
            list.pitems = items;
            for (list.size = 8; list.size <= 10; list.size++) {
                LCDList(&list);
                printf(\"%d \", list.scroll);
            }
            printf(\"\\n\");
            return 0;
        }",
    );
    // There are keys for 8 items, and room for 10.
    assert_eq!(printed(&scratch, &[], 0).0, ["0 1 1 "]);
}

/// Sets up the scanner, once with an angle that it does not have.
const SCANS: &str = "int main(void)
    {
        int distances[LIDAR_RESOLUTION], i;
        printf(\"%d\\n\", LIDAR_RESOLUTION);
        for (i = 0; i < LIDAR_RESOLUTION; i++) distances[i] = -1;
        LIDARGet(distances);
        printf(\"%d\\n\", distances[LIDAR_RESOLUTION - 1] != -1);
        LIDARSet(400, 0, 90);
        printf(\"%d\\n\", LIDAR_RESOLUTION);
        LIDARSet(180, 0, 90);
        printf(\"%d\\n\", LIDAR_RESOLUTION);
        return 0;
    }";

#[test]
fn lidar_resolution_is_the_number_of_points_of_the_scanner() {
    let scratch = scene_of(SCANS);
    assert_eq!(printed(&scratch, &[], 0).0, ["360", "0", "360", "360"], "there is no scanner");
    scratch.write("bare.robi", &format!("{BARE}lidar 720 0\n"));
    for exec in ["fiber", "process"] {
        assert_eq!(printed(&scratch, &["--exec", exec], 0).0, ["720", "1", "720", "90"], "{exec}");
    }
}

#[test]
fn waiting_in_a_timer_is_an_error() {
    let scratch = scene_of(
        "static void wait(void) { OSWait(1); }
        int main(void) { OSAttachTimer(10, wait); OSWait(100); return VWDone(); }",
    );
    let (_, messages) = printed(&scratch, &[], 1);
    assert!(messages.contains("`OSWait` would wait inside a timer callback"), "{messages}");
}

#[test]
fn serial_lines_carry_what_the_companion_connects() {
    let scratch = scene_of(
        "int main(void)
        {
            unsigned char bytes[256];
            int start = OSGetCount(), count;
            SERInit(1, 9600, 0);
            SERInit(2, 9600, 0);
            SERSend(1, \"echo\", 4);
            printf(\"%c\", SERReceiveChar(1));
            OSWait(10);
            count = SERReceive(1, bytes);
            printf(\"%s %d\\n\", (char *)bytes, count);
            /* 20 bytes of 10 bits at 9600 baud: 21 ms. */
            OSWait(start + 15 - OSGetCount());
            printf(\"%d\\n\", SERCheck(2));
            OSWait(start + 30 - OSGetCount());
            count = SERReceive(2, bytes);
            printf(\"%d %s\\n\", count, (char *)bytes);
            printf(\"%d\\n\", SERCheck(2));
            return 0;
        }",
    );
    scratch.write("bare.toml", "[serial]\n1 = \"loopback\"\n2 = { file = \"gps.txt\" }\n");
    scratch.write("gps.txt", "$GPGGA,123519,4807.0");
    let (lines, _) = printed(&scratch, &[], 0);
    assert_eq!(lines, ["echo 3", "1", "20 $GPGGA,123519,4807.0", "0"]);
    let trace = scratch.trace("trace.jsonl");
    let sent = trace.iter().find(|line| line["event"] == "serial_sent").expect("what was sent is recorded");
    assert_eq!(sent["port"], "SERIAL1");
}

#[test]
fn a_sent_byte_wakes_the_thread_that_waits_for_it() {
    let scratch = scene_of(
        "#include <pthread.h>
        static void *receive(void *p) { int c = SERReceiveChar(1); printf(\"%c at %d\\n\", c, OSGetCount()); return p; }
        int main(void)
        {
            pthread_t thread;
            SERInit(1, 10000, 0);
            pthread_create(&thread, NULL, receive, NULL);
            OSWait(100);
            SERSendChar(1, 'x');
            pthread_join(thread, NULL);
            return 0;
        }",
    );
    scratch.write("bare.toml", "[serial]\n1 = \"loopback\"\n");
    assert_eq!(printed(&scratch, &[], 0).0, ["x at 101"], "10 bits at 10,000 baud take 1 ms");
}

#[test]
fn a_wait_on_a_silent_line_is_reported() {
    let scratch = scene_of("int main(void) { SERInit(3, 9600, 0); SERReceiveChar(3); return 0; }");
    let (_, messages) = printed(&scratch, &[], 1);
    assert!(messages.contains("a byte on SERIAL3, to which nothing is connected"), "{messages}");
}

#[test]
fn hints_name_the_reason_for_which_an_image_is_refused() {
    let scratch = scene_of(
        "static BYTE image[QVGA_SIZE];
        int main(void)
        {
            printf(\"%d \", IPReadFile(\"maps/none.pgm\", image));
            printf(\"%d %d \", IPWriteFile(\"none/a.ppm\", image), IPWriteFileGray(\"\", image));
            printf(\"%d %d %d\\n\", IPSetSize(44), LCDImageSize(44), LCDImage(NULL));
            return 0;
        }",
    );
    let (lines, messages) = printed(&scratch, &[], 0);
    assert_eq!(lines, ["-1 1 1 1 1 1"]);
    for expected in [
        "`IPReadFile` returned -1: `maps/none.pgm`: there is no such file in `",
        "`IPWriteFile` returned 1: `none/a.ppm`: there is no folder `none`",
        "`IPWriteFileGray` returned 1: ``: the name of the file is empty",
        "`IPSetSize` returned 1: 44 is not a resolution: expected QQVGA, QVGA, ",
        "`LCDImageSize` returned 1: 44 is not a resolution: expected QQVGA, QVGA, ",
        "`LCDImage` returned 1: it is given no image",
    ] {
        assert!(messages.contains(expected), "{expected}: {messages}");
    }
}

#[test]
fn images_come_from_files_of_all_kinds() {
    let scratch = scene_of(
        "static BYTE image[3 * 640 * 480], edges[640 * 480];
        int main(void)
        {
            int i, sum = 0;
            IP_WIDTH = 4, IP_HEIGHT = 2;
            IPSetSize(CUSTOM);
            printf(\"%d: \", IPReadFile(\"images/a.pbm\", image));
            for (i = 0; i < 8; i++)
                printf(\"%d \", image[i]);
            printf(\"\\n%d: \", IPReadFile(\"a.ppm\", image));
            for (i = 0; i < 24; i++)
                printf(\"%d \", image[i]);
            printf(\"\\n%d \", IPReadFile(\"cut.pgm\", image));
            printf(\"%d\\n\", IPReadFile(\"cut.pgm\", image));
            IPSetSize(VGA);
            for (i = 0; i < 640 * 480; i++)
                image[i] = (BYTE)(i % 640 < 320 ? 0 : 255);
            IPSobel(image, edges);
            for (i = 0; i < 640 * 480; i++)
                sum += edges[i] == 255;
            IPSobel(image, image);
            printf(\"%d %d\\n\", sum, memcmp(image, edges, sizeof edges));
            return 0;
        }",
    );
    scratch.write("images/a.pbm", "P1\n# a comment\n2 3\n1 0\n0 1\n1 1\n");
    scratch.write("a.ppm", "P3 2 1 15 15 0 5  0 15 10\n");
    scratch.write("cut.pgm", "P2 4 2 255 1 2 3\n");
    let (lines, messages) = printed(&scratch, &[], 0);
    assert_eq!(
        lines,
        [
            "1: 0 255 0 0 255 0 0 0 ",
            "3: 255 0 85 0 255 170 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 ",
            "-1 -1",
            // Two columns of 478 rows each, inside the border.
            "956 0",
        ]
    );
    assert_eq!(messages.matches("`IPReadFile` returned -1: `cut.pgm`").count(), 1, "{messages}");
}

#[test]
fn robots_see_files_of_others_from_the_next_slot_on() {
    let program = "#include \"eyebot.h\"
        static BYTE image[QQVGA_PIXELS];
        int main(void)
        {
            int me = OSMachineID(), other = 3 - me;
            char name[32];
            IPSetSize(QQVGA);
            image[0] = (BYTE)me;
            sprintf(name, \"%d.pgm\", me);
            IPWriteFileGray(name, image);
            printf(\"%d \", IPReadFile(name, image));
            sprintf(name, \"%d.pgm\", other);
            printf(\"%d \", IPReadFile(name, image));
            OSWait(100);
            printf(\"%d \", IPReadFile(name, image));
            printf(\"%d\\n\", image[0]);
            /* Both robots write the same file: the later content remains. */
            OSWait(me);
            image[0] = (BYTE)me;
            IPWriteFileGray(\"both.pgm\", image);
            return 0;
        }\n";
    let scratch = bare("main.c", program);
    scratch.write("bare.sim", "world room.wld\nrobi bare.robi main.c 1000 1000 0\nrobi bare.robi main.c 3000 1000 0\n");
    let (lines, _) = printed(&scratch, &[], 0);
    assert_eq!(lines, ["5 -1 5 2", "5 -1 5 1"]);
    let both = std::fs::read(scratch.path().join("both.pgm")).expect("it was written");
    assert_eq!(both["P5\n160 120\n255\n".len()], 2);
}

#[test]
fn commands_run_only_where_they_are_allowed() {
    let program = "int main(void)
        {
            char out[4096] = \"nothing\";
            int result = OSExecute(\"echo hello; echo world\", out);
            printf(\"%d %s\\n\", result, out);
            printf(\"%d\\n\", OSExecute(\"exit 3\", out));
            return 0;
        }";
    let scratch = scene_of(program);
    let (lines, messages) = printed(&scratch, &[], 0);
    assert_eq!(lines, ["1 nothing", "1"]);
    assert!(messages.contains("`--allow-execute` on the command line allows it"), "{messages}");
    let (lines, messages) = printed(&scratch, &["--allow-execute"], 0);
    assert_eq!(lines, ["0 hello", "world", "", "1"]);
    assert!(messages.contains("outside of the simulation"), "{messages}");
}

#[test]
fn sounds_and_inputs_are_those_of_files() {
    let scratch = scene_of(
        "int main(void)
        {
            BYTE sample[8];
            printf(\"%d \", AUPlay(\"beep.wav\"));
            printf(\"%d \", AUDone());
            OSWait(499);
            printf(\"%d \", AUDone());
            OSWait(2);
            printf(\"%d\\n\", AUDone());
            AURecord(sample, 1, 8000);
            printf(\"%d %d %d\\n\", AUMicrophone(), sample[7], ANALOGRead(8));
            printf(\"%d %d %d\\n\", DIGITALRead(3), DIGITALReadAll(), ANALOGVoltage());
            printf(\"%d %d\\n\", ANALOGRead(2), ANALOGRead(9));
            /* A streamed file, whose header states no length. */
            printf(\"%d %d\\n\", AUPlay(\"RIFF\\xff\\xff\\xff\\xffWAVEfmt \\x10\\0\\0\\0\\1\\0\\1\\0\\x40\\x1f\\0\\0\\x40\\x1f\\0\\0\\1\\0\\b\\0\"
                                    \"data\\xff\\xff\\xff\\xff\"), AUPlay(\"RIFFle.wav\"));
            return 0;
        }",
    );
    // A sound of 4,000 bytes at 8,000 bytes per second.
    let mut wave =
        b"RIFF\0\0\0\0WAVEfmt \x10\0\0\0\x01\0\x01\0\x40\x1f\0\0\x40\x1f\0\0\x01\0\x08\0data\xa0\x0f\0\0".to_vec();
    wave.resize(wave.len() + 4_000, 128);
    std::fs::write(scratch.path().join("beep.wav"), wave).expect("a file for a test");
    scratch
        .write("bare.toml", "[input]\ndigital = { 3 = 1 }\nanalog = { 2 = 700 }\nvoltage_v = 6.85\nmicrophone = 200\n");
    let (lines, _) = printed(&scratch, &[], 0);
    assert_eq!(lines, ["0 0 0 1", "200 200 800", "1 4 685", "700 -1", "0 1"]);
}

#[test]
fn motors_continue_when_a_program_has_ended_with_0() {
    let end = |body: &str, args: &[&str], code| {
        let report = scene_of(&format!("int main(void) {{ {body} return 0; }}")).report("bare.sim", args, code);
        let robot = &report["robots"][0];
        (tests::number(robot, "path_m"), report["sim_time_s"].as_f64().expect("a time"))
    };
    // A drive with an end is completed. A speed command continues for the time set by `--linger`.
    let (path, time) = end("VWStraight(500, 250);", &[], 0);
    assert!((path - 0.5).abs() < 1e-9 && (2.0..2.1).contains(&time), "{path} m in {time} s");
    let (path, time) = end("VWSetSpeed(100, 10);", &[], 0);
    assert!(path < 0.02 && time < 0.2, "{path} m in {time} s");
    let (path, time) = end("VWSetSpeed(100, 10);", &["--linger", "3"], 0);
    assert!((path - 0.3).abs() < 0.01 && (3.0..3.2).contains(&time), "{path} m in {time} s");
    let (path, _) = end("VWSetSpeed(100, 10);", &["--linger", "1000", "--until", "5"], 0);
    assert!((path - 0.5).abs() < 0.01, "{path}");
    // The robot of a failed program stops.
    let (path, time) = end("VWStraight(500, 250); return 3;", &["--linger", "3"], 1);
    assert!(path < 0.02 && time < 0.2, "{path} m in {time} s");
}
