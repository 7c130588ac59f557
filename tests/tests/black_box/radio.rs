//! The radio: results of calls, waits between robots, and the ends of runs.

use std::process::Command;

use tests::radio::{ECHO_7, IS, RECEIVER, SENDER, causes, messages, micros, printed, reasons, row, traced};

const CODES_6: &str = r#"
static RadioIOParameters with(int interface, int speed, int id, int remote, int images, int debug)
{
    RadioIOParameters p = { interface, speed, id, remote, images, debug };
    return p;
}
static int set(RadioIOParameters p) { return RADIOSetIoctl(&p); }
int main(void)
{
    BYTE from = 0, buffer[64], hello[64] = "hello";
    int i, n = 0;
    RadioIOParameters p;
    RadioStatus s;
    /* Off. */
    IS(RADIOTerm(), -1);
    IS(RADIOSend(2, 5, hello), 1);
    IS(RADIOCheck(), 0);
    IS(RADIORecv(&from, &n, buffer), -1);
    IS(RADIOGetStatus(&s), -1);
    /* Settings. */
    IS(RADIOGetIoctl(NULL), -1);
    IS(RADIOSetIoctl(NULL), -1);
    IS(RADIOGetIoctl(&p), 0);
    IS(p.interface, SERIAL1);
    IS(p.speed, SER115200);
    IS(p.id, OSMachineID());
    IS(p.remoteOn + p.imageTransfer + p.debug, 0);
    IS(set(with(0, SER9600, 1, 0, 0, 0)), -1);
    IS(set(with(SERIAL3, 1234, 1, 0, 0, 0)), -1);
    IS(set(with(SERIAL3, SER9600, 0, 0, 0, 0)), -1);
    IS(set(with(SERIAL3, SER9600, 256, 0, 0, 0)), -1);
    IS(set(with(SERIAL3, SER9600, 1, 2, 0, 0)), -1);
    IS(set(with(SERIAL3, SER9600, 1, 0, 3, 0)), -1);
    IS(set(with(SERIAL3, SER9600, 1, 0, 0, 101)), -1);
    IS(set(with(SERIAL3, SER115200, 77, 1, 2, 50)), 0);
    IS(RADIOGetIoctl(&p), 0);
    IS(p.interface, SERIAL3);
    IS(p.speed, SER115200);
    IS(p.id, 77);
    IS(p.remoteOn, 1);
    IS(p.imageTransfer, 2);
    IS(p.debug, 50);
    /* On. */
    IS(RADIOInit(), 0);
    IS(RADIOInit(), -1);
    IS(RADIOSetIoctl(&p), -1);
    OSWait(50);
    IS(RADIOSend(2, -1, hello), 1);
    IS(RADIOSend(2, 5, NULL), 1);
    IS(RADIOSend(2, 0, NULL), 1);
    IS(RADIOSend(2, MAXMSGLEN + 1, hello), 1);
    IS(RADIOSend(2, 1 << 30, hello), 1);
    IS(RADIOSend(2, 5, hello), 0);
    IS(RADIOSend(2, 0, hello), 0);
    IS(RADIOSend(BROADCAST, MAXMSGLEN, hello), 0);
    IS(RADIORecv(&from, &n, NULL), -1);
    /* The answers: sizes 5, 0, MAXMSGLEN. */
    for (i = 0; i < 3; i++) {
        IS(RADIORecv(i == 1 ? NULL : &from, i == 2 ? NULL : &n, buffer), 0);
        IS(from, 2);
        IS(n, i == 0 ? 5 : 0);
        IS(i == 0 && memcmp(buffer, "hello", 5), 0);
    }
    IS(RADIOGetStatus(NULL), -1);
    IS(RADIOGetStatus(&s), 0);
    IS(s.id, 77);
    IS(s.sent, 3);
    IS(s.received, 3);
    IS(s.waiting, 0);
    IS(RADIOTerm(), 0);
    IS(RADIOTerm(), -1);
    IS(RADIOInit(), 0);
    IS(RADIOGetStatus(&s), 0);
    IS(s.id, 77);
    printf("done\n");
    return 0;
}
"#;

/// Echoes three messages to their senders.
const ECHO_6: &str = r#"
int main(void)
{
    BYTE from, buffer[MAXMSGLEN];
    int i, n;
    IS(RADIOInit(), 0);
    for (i = 0; i < 3; i++) {
        IS(RADIORecv(&from, &n, buffer), 0);
        IS(from, 77);
        IS(RADIOSend(from, n, buffer), 0);
    }
    OSWait(10);
    printf("done\n");
    return 0;
}
"#;

#[test]
fn robios_6_answers_as_documented() {
    let scratch = row(&["codes.c", "echo.c"], "");
    scratch.write("codes.c", &format!("{IS}{CODES_6}"));
    scratch.write("echo.c", &format!("{IS}{ECHO_6}"));
    for exec in ["thread", "process"] {
        let (_, trace) = traced(&scratch, &["--exec", exec], 0);
        assert_eq!([printed(&trace, 1), printed(&trace, 2)], [["done"], ["done"]]);
        let hints: Vec<_> =
            trace.iter().filter(|event| event["event"] == "hint").map(|it| it["text"].as_str()).collect();
        let tells = |words: &str| hints.iter().flatten().any(|hint| hint.contains(words));
        assert!(tells("`RADIOSend` returned 1: the radio is off: `RADIOInit` switches it on"), "{hints:?}");
        assert!(tells("`RADIOInit` returned -1: the radio is on already"), "{hints:?}");
        assert!(tells("`RADIOGetIoctl` returned -1: the pointer for the settings is null"), "{hints:?}");
    }
}

const CODES_7: &str = r#"
int main(void)
{
    int id = 0, ids[256], i;
    static char text[2000];
    memset(ids, 0, sizeof ids);
    /* Off. */
    IS(RADIOGetID(), 1);
    IS(RADIORelease(), 1);
    IS(RADIOSend(2, "hello"), 1);
    IS(RADIOCheck(), 0);
    IS(RADIOReceive(&id, text, 100), 1);
    IS(RADIOStatus(ids), 0);
    /* On. */
    IS(RADIOInit(), 0);
    IS(RADIOInit(), 1);
    IS(RADIOStatus(NULL), 0);
    OSWait(200);
    IS(RADIOStatus(ids), 3);
    IS(ids[0] * 100 + ids[1] * 10 + ids[2], 123);
    IS(RADIOSend(-1, "hello"), 1);
    IS(RADIOSend(2, NULL), 1);
    memset(text, 'x', 1024);
    IS(RADIOSend(2, text), 1);
    text[1023] = 0;
    IS(RADIOSend(2, text), 0);
    IS(RADIOSend(2, "full"), 1);
    IS(RADIOReceive(&id, NULL, 100), 1);
    IS(RADIOReceive(&id, text, 0), 1);
    IS(RADIOReceive(&id, text, -5), 1);
    memset(text, 0, sizeof text);
    IS(RADIOReceive(&id, text, sizeof text), 0);
    IS(id, 2);
    IS(strlen(text), 1023);
    IS(RADIOSend(2, "hello"), 0);
    OSWait(200);
    IS(RADIOSend(0, ""), 0);
    memset(text, 'y', sizeof text);
    IS(RADIOReceive(NULL, text, 4), 0);
    IS(memcmp(text, "hel\0y", 5), 0);
    /* Both robots answer a broadcast. */
    IS(RADIOReceive(&id, text, 1), 0);
    IS(memcmp(text, "\0el", 3), 0);
    IS(RADIOReceive(&id, text, 100), 0);
    IS(text[0], 0);
    IS(RADIOCheck(), 0);
    IS(RADIOCheck(&i), 0);
    IS(RADIORelease(), 0);
    IS(RADIORelease(), 1);
    IS(RADIOStatus(ids), 0);
    printf("done\n");
    return 0;
}
"#;

#[test]
fn robios_7_answers_as_documented() {
    let scratch = row(&["codes.c", "echo.c", "echo.c"], "");
    scratch.write("codes.c", &format!("{IS}{CODES_7}"));
    scratch.write("echo.c", &format!("{IS}{ECHO_7}"));
    for exec in ["thread", "process"] {
        let (_, trace) = traced(&scratch, &["--exec", exec, "--api", "7"], 1);
        assert_eq!([printed(&trace, 1), printed(&trace, 2), printed(&trace, 3)], [vec!["done"], vec![], vec![]]);
        let reason = &reasons(&scratch)[1];
        assert!(reason.contains("(all programs that have not ended wait for messages from each other)"), "{reason}");
    }
}

#[test]
fn receiving_with_a_timer_and_with_a_drive_in_progress() {
    // A timer runs on while its program waits for a message, and the program receives the message at its time.
    let scratch = row(&["sender.c", "receiver.c"], "[radio]\nbaud = 1200\n");
    scratch.write("sender.c", SENDER);
    let with_timer = RECEIVER
        .replace("int main", "static int ticks;\nstatic void tick(void) { ticks++; }\nint main")
        .replace("RADIOInit();", "RADIOInit();\n    OSAttachTimer(1, tick);")
        .replace("printf(", "printf(\"%d ticks, \", ticks); printf(");
    scratch.write("receiver.c", &with_timer);
    let (_, trace) = traced(&scratch, &[], 0);
    assert_eq!(printed(&trace, 2), ["36 ticks, 35 bytes from 1: from the sender"]);
    let sent = &messages(&trace)[&(1, 1)];
    let received = trace.iter().find(|event| event["event"] == "radio_received").expect("a message");
    assert_eq!(micros(&received["t_s"]), sent.at + 350_000);

    // The timer's callback may receive a message, but must not wait for one.
    let in_callback = "
        #include \"eyebot.h\"
        static void tick(void) { BYTE b[MAXMSGLEN]; RADIORecv(0, 0, b); }
        int main(void) { RADIOInit(); OSAttachTimer(1, tick); OSWait(100); return 0; }";
    scratch.write("receiver.c", in_callback);
    traced(&scratch, &[], 1);
    assert_eq!(reasons(&scratch)[1], "`RADIORecv` would wait inside a timer callback at receiver.c:3");
}

#[test]
fn buffers_have_room_for_1024_bytes() {
    let sender = r#"
        #include "eyebot.h"
        #include <stdio.h>
        int main(void)
        {
            BYTE bytes[32] = {0};
            int i, sent = 0, refused = 0;
            RADIOInit();
            for (i = 0; i < 100; i++)
                if (RADIOSend(2, 32, bytes) == 0) sent++; else refused++;
            printf("%d sent, %d refused\n", sent, refused);
            OSWait(500);
            return 0;
        }"#;
    let receiver = r#"
        #include "eyebot.h"
        #include <stdio.h>
        int main(void)
        {
            BYTE bytes[MAXMSGLEN];
            int n, got = 0;
            RADIOInit();
            OSWait(400);
            printf("%d wait\n", RADIOCheck());
            while (RADIOCheck() > 0) { RADIORecv(0, &n, bytes); got += n; }
            printf("%d bytes\n", got);
            return 0;
        }"#;
    // At 9600 baud a message takes 40.6 ms and a call 0.5 ms, so 100 calls end before two messages are transmitted.
    let scratch = row(&["sender.c", "receiver.c"], "[radio]\nbaud = 9600\n");
    scratch.write("sender.c", sender);
    scratch.write("receiver.c", receiver);
    let (_, trace) = traced(&scratch, &[], 0);
    let all = messages(&trace);
    assert_eq!(printed(&trace, 1), [format!("{} sent, {} refused", all.len(), 100 - all.len())]);
    assert!((32..36).contains(&all.len()), "{}", all.len());
    let overflows = all.len() - 32;
    assert_eq!(causes(&trace), vec!["overflow"; overflows]);
    assert_eq!(printed(&trace, 2), ["32 wait", "1024 bytes"]);
}

#[test]
fn the_waits_of_robots_for_each_other_are_reported() {
    let waits = "#include \"eyebot.h\"\nint main(void)\n{\n    BYTE b[MAXMSGLEN];\n    RADIOInit();\n    OSWait(30);\n    \
                 RADIORecv(0, 0, b);\n    return 0;\n}\n";
    let ends = "#include \"eyebot.h\"\nint main(void) { OSWait(200); return 0; }\n";
    let seven = "#include \"eyebot.h\"\nint main(void)\n{\n    char b[9]; int id;\n    RADIOInit();\n    \
                 RADIOReceive(&id, b, 9);\n    return 0;\n}\n";
    let key = "#include \"eyebot.h\"\nint main(void) { KEYGet(); return OSMachineType() + VWStalled(0); }\n";
    let each = "(all programs that have not ended wait for messages from each other)";
    let wait = |advice: &str| format!("waits for a message since 0.305 s in RADIORecv at waits.c:7{advice}");
    let run = |programs: &[&str], exec: &str| {
        let scratch = row(programs, "");
        let files = [("waits.c", waits), ("ends.c", ends), ("seven.c", seven), ("key.c", key)];
        files.iter().for_each(|(name, text)| drop(scratch.write(name, text)));
        let ran = scratch.eyesim(&["run", "scene.scene.toml", "--report", "report.json", "--exec", exec]);
        assert_eq!(ran.code, Some(1), "{ran:#?}");
        (ran, reasons(&scratch))
    };
    for exec in ["thread", "process"] {
        let (ran, reasons) = run(&["waits.c", "seven.c", "ends.c"], exec);
        let seven = format!("waits for a message since 0.005 s in RADIOReceive at seven.c:6 {each}");
        assert_eq!(reasons, [wait(&format!(" {each}")), seven.clone(), String::new()]);
        assert!(ran.stderr.contains(&format!("r2 (`seven.c`) {seven}")), "{ran:#?}");
        assert!(ran.stdout.contains(&reasons[0]), "{ran:#?}");
        let (_, reasons) = run(&["waits.c", "ends.c", "ends.c"], exec);
        assert_eq!(reasons[0], wait(" (all other programs have ended)"));
        let (_, reasons) = run(&["waits.c"], exec);
        assert_eq!(reasons[0], wait(" (no other robot has a program)"));
        let (_, reasons) = run(&["waits.c", "key.c"], exec);
        assert_eq!(reasons[0], wait(""));
    }
}

#[test]
fn the_radio_ends_with_its_program() {
    // The first program ends while one of its messages is being transmitted and others wait. The second robot never
    // receives the third message.
    let hasty = "
        #include \"eyebot.h\"
        int main(void)
        {
            BYTE bytes[MAXMSGLEN] = {0};
            int i;
            RADIOInit();
            OSWait(10);
            for (i = 0; i < 3; i++) RADIOSend(2, MAXMSGLEN, bytes);
            return 0;
        }";
    let listens = "
        #include \"eyebot.h\"
        int main(void)
        {
            BYTE bytes[MAXMSGLEN];
            RADIOInit();
            RADIORecv(0, 0, bytes);
            OSWait(50);
            return 0;
        }";
    let scratch = row(&["hasty.c", "listens.c"], "[radio]\nbaud = 9600\n");
    scratch.write("hasty.c", hasty);
    scratch.write("listens.c", listens);
    let (_, trace) = traced(&scratch, &[], 0);
    let all = messages(&trace);
    let fates: Vec<_> =
        all.values().flat_map(|sent| &sent.fates).map(|(to, (_, _, loss))| (*to, loss.clone())).collect();
    assert_eq!(fates, [(2, None), (1, Some("unsent".to_owned())), (1, Some("unsent".to_owned()))]);
    let hint = trace.iter().find(|event| event["event"] == "hint").expect("a hint");
    assert!(hint["text"].as_str().is_some_and(|text| text.contains("before 2 messages were sent")), "{hint}");
}

#[test]
fn messages_in_flight_at_the_end_of_the_run_are_in_the_trace() {
    let scratch = row(&["sender.c", "receiver.c"], "[radio]\nbaud = 1200\n");
    scratch.write("sender.c", SENDER);
    scratch.write("receiver.c", RECEIVER);
    let (_, trace) = traced(&scratch, &["--until", "0.2"], 0);
    let (time, arrived, loss) = &messages(&trace)[&(1, 1)].fates[&2];
    assert_eq!((*time, loss.as_deref()), (200_000, Some("end")));
    assert!(*arrived > 350_000, "{arrived}");
    // The receiver's program ends first, so the message has no receiver whose radio is on.
    scratch.write("receiver.c", "#include \"eyebot.h\"\nint main(void) { RADIOInit(); OSWait(20); return 0; }");
    let (_, trace) = traced(&scratch, &[], 0);
    let (_, _, loss) = &messages(&trace)[&(1, 1)].fates[&2];
    assert_eq!(loss.as_deref(), Some("off"));
}

#[test]
fn a_flood_of_messages_stays_in_bounds() {
    // Empty messages take only the space of their headers.
    let flood = r#"
        #include "eyebot.h"
        #include <stdio.h>
        int main(void)
        {
            BYTE bytes[1] = {0};
            int i, sent = 0;
            RADIOInit();
            for (i = 0; i < 100000; i++) sent += RADIOSend(BROADCAST, 0, bytes) == 0;
            printf("%d sent\n", sent);
            return 0;
        }"#;
    let deaf = "#include \"eyebot.h\"\nint main(void) { RADIOInit(); OSWait(6000); return 0; }";
    let scratch = row(&["flood.c", "deaf.c"], "");
    scratch.write("flood.c", flood);
    scratch.write("deaf.c", deaf);
    let (_, trace) = traced(&scratch, &[], 0);
    // A message of 70 bits takes 608 us at 115200 baud. The start and 100000 calls of 500 us take 50.05 s. In this time
    // 82,320 messages are transmitted, and 1024 wait. The receiver also holds 1024 waiting messages.
    let sent = messages(&trace).len();
    assert!((83_200..83_500).contains(&sent), "{sent}");
    assert_eq!(printed(&trace, 1), [format!("{sent} sent")]);
    let arrived = trace.iter().filter(|event| event["event"] == "radio_arrived").count();
    let causes = causes(&trace);
    let lost = |cause: &str| causes.iter().filter(|it| *it == cause).count();
    assert_eq!((arrived, lost("overflow") + lost("unsent") + arrived), (1024, sent));
}

#[test]
fn each_task_of_a_robot_can_wait_for_messages() {
    // A message of 22 bytes takes 183334 us at 1200 baud.
    let sender = "
        #include \"eyebot.h\"
        int main(void) { RADIOInit(); OSWait(100); RADIOSend(2, \"fifteen letters\"); OSWait(1000); return 0; }";
    let receiver = r#"
        #include "eyebot.h"
        #include <pthread.h>
        #include <stdio.h>
        static void *listen(void *p)
        {
            char text[100];
            int id;
            RADIOReceive(&id, text, sizeof text);
            printf("%s at %d\n", text, OSGetCount());
            return p;
        }
        int main(void)
        {
            pthread_t task;
            RADIOInit();
            pthread_create(&task, NULL, listen, NULL);
            OSWait(7000);
            pthread_join(task, NULL);
            return 0;
        }"#;
    let scratch = row(&["sender.c", "receiver.c"], "[radio]\nbaud = 1200\n");
    scratch.write("sender.c", sender);
    scratch.write("receiver.c", receiver);
    for exec in ["thread", "process"] {
        let (_, trace) = traced(&scratch, &["--exec", exec, "--api", "7"], 0);
        let sent = &messages(&trace)[&(1, 1)];
        let received = trace.iter().find(|event| event["event"] == "radio_received").expect("a message");
        assert_eq!(micros(&received["t_s"]), sent.at + 183_334);
        assert_eq!(printed(&trace, 2), [format!("fifteen letters at {}", (sent.at + 183_334) / 1000)]);
    }
}

#[test]
fn programs_in_python_talk_with_programs_in_c() {
    if !Command::new("python3").arg("--version").output().is_ok_and(|output| output.status.success()) {
        println!("skipped: there is no `python3`");
        return;
    }
    let python = "
from eye import *
print(RADIOSend(2, 'off'), RADIOReceive(), RADIOCheck(), RADIOStatus())
print(RADIOInit(), RADIOInit(), RADIOGetID())
OSWait(100)
print(RADIOStatus(), RADIOSend(2, 'hello'), RADIOSend(2, b'bytes'), RADIOSend(2, 'x' * 1024))
OSWait(200)
print(RADIOCheck(), RADIOReceive(), RADIOReceive(3))
print(RADIORelease(), RADIORelease())
";
    let scratch = row(&["talk.py", "echo.c"], "");
    scratch.write("talk.py", python);
    scratch.write("echo.c", &format!("{IS}{ECHO_7}"));
    let (_, trace) = traced(&scratch, &[], 1);
    assert_eq!(
        printed(&trace, 1),
        ["1 (0, '') 0 []", "0 1 1", "[1, 2] 0 0 1", "2 (2, 'hello') (2, 'by')", "0 1"],
        "{:?}",
        printed(&trace, 1)
    );
}

#[test]
fn threads_in_python_receive_one_message_each() {
    if !Command::new("python3").arg("--version").output().is_ok_and(|output| output.status.success()) {
        println!("skipped: there is no `python3`");
        return;
    }
    let scratch = row(&["receive.py", "send.py"], "");
    let receive = "
import threading
from eye import *
RADIOInit()
def receive():
    sender, text = RADIOReceive()
    print(sender, text, OSGetCount() // 100)
thread = threading.Thread(target=receive)
thread.start()
receive()
thread.join()
";
    scratch.write("receive.py", receive);
    scratch.write(
        "send.py",
        "from eye import *\nRADIOInit()\nfor text in 'ab':\n    OSWait(1000)\n    RADIOSend(1, text)\n",
    );
    let (_, trace) = traced(&scratch, &[], 0);
    assert_eq!(printed(&trace, 1), ["2 a 10", "2 b 20"], "a thread that waits does not hold back the other");
}

#[test]
fn sent_messages_of_a_robios_7_program_are_transmitted_after_its_end() {
    let leader = "
        #include \"eyebot.h\"
        int main(void)
        {
            int i; char text[20];
            RADIOInit();
            OSWait(100);
            for (i = 0; i < 5; i++) { sprintf(text, \"go %d\", i); RADIOSend(2, text); }
            RADIOSend(2, \"stop\");
            RADIORelease();
            return 0;
        }";
    let follower = "
        #include \"eyebot.h\"
        #include <string.h>
        int main(void)
        {
            int id, n = 0; char text[20];
            RADIOInit();
            do { RADIOReceive(&id, text, 20); n++; } while (strcmp(text, \"stop\") != 0);
            printf(\"%d\\n\", n);
            RADIORelease();
            return 0;
        }";
    for medium in ["free", "aloha"] {
        let scratch = row(&["leader.c", "follower.c"], &format!("[radio]\nmedium = \"{medium}\"\nbaud = 9600\n"));
        scratch.write("leader.c", leader);
        scratch.write("follower.c", follower);
        let (_, trace) = traced(&scratch, &["--api", "7"], 0);
        let said = trace.iter().find(|event| event["event"] == "stdout").expect("what the follower says");
        assert_eq!(said["text"].as_str().map(str::trim), Some("6"), "{medium}");
    }
}

#[test]
fn robots_that_start_together_find_each_other() {
    let program = "
        #include \"eyebot.h\"
        int main(void)
        {
            int ids[256];
            RADIOInit();
            printf(\"%d\\n\", RADIOStatus(ids));
            return 0;
        }";
    let scratch = row(&["hello.c", "hello.c", "hello.py"], "");
    scratch.write("hello.c", program);
    scratch.write("hello.py", "from eye import *\nRADIOInit()\nprint(len(RADIOStatus()))\n");
    let (_, trace) = traced(&scratch, &["--api", "7"], 0);
    for robot in 1..=3 {
        assert_eq!(printed(&trace, robot), ["3"]);
    }
}
