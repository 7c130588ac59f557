//! The radio: what programs are answered, when messages come, and what becomes of each.

use std::collections::BTreeMap;
use std::process::Command;

use serde_json::Value;
use tests::{Ran, Scratch};

/// A room of 4 m by 4 m with a wall in its middle half, and robots of these programs at these places in mm, in `scene.scene.toml`.
fn scene(robots: &[(&str, i32, i32)], tables: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write(
        "room.wld",
        "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n2000 1000 2000 3000\n",
    );
    let mut text = format!("[world]\nfile = \"room.wld\"\n{tables}\n");
    for (program, x, y) in robots {
        text += &format!("[[robot]]\ntype = \"S4\"\nprogram = \"{program}\"\nx_mm = {x}\ny_mm = {y}\n");
    }
    scratch.write("scene.scene.toml", &text);
    scratch
}

/// The same with the robots in a row, 300 mm apart.
fn row(programs: &[&str], tables: &str) -> Scratch {
    let robots: Vec<_> =
        programs.iter().enumerate().map(|(index, program)| (*program, 300 + 300 * index as i32, 500)).collect();
    scene(&robots, tables)
}

/// The digest of a run and its trace.
fn traced(scratch: &Scratch, args: &[&str], code: i32) -> (Value, Vec<Value>) {
    let report = scratch.report("scene.scene.toml", &[args, &["--trace", "t.jsonl"]].concat(), code);
    (report["digest"].clone(), scratch.trace("t.jsonl"))
}

/// What robot `id` printed, a line each.
fn said(trace: &[Value], id: u64) -> Vec<&str> {
    let is_said = |event: &&Value| event["event"] == "stdout" && event["robot"] == id;
    trace.iter().filter(is_said).map(|event| event["text"].as_str().expect("text")).collect()
}

fn micros(seconds: &Value) -> i64 {
    (seconds.as_f64().unwrap_or_else(|| panic!("{seconds} is a time")) * 1e6).round() as i64
}

fn integer(event: &Value, key: &str) -> i64 {
    event[key].as_i64().unwrap_or_else(|| panic!("`{key}` in {event}"))
}

/// A message that was sent, and what the trace says of it; times in microseconds.
#[derive(Debug)]
struct Sent {
    at: i64,
    to: Option<i64>,
    begins: Option<i64>,
    data: Value,
    /// For each receiver when its fate was known, when it arrived, and why not, if it did not.
    fates: BTreeMap<i64, (i64, i64, Option<String>)>,
}

/// Robot and number of a message.
type Name = (i64, i64);

/// All messages of a trace.
fn messages(trace: &[Value]) -> BTreeMap<Name, Sent> {
    let mut sent = BTreeMap::new();
    for event in trace.iter().filter(|event| event["event"] == "radio_sent") {
        let name = (integer(event, "robot"), integer(event, "message"));
        let begins = (!event["begins_s"].is_null()).then(|| micros(&event["begins_s"]));
        let (at, data) = (micros(&event["t_s"]), event["data"].clone());
        let before = sent.insert(name, Sent { at, to: event["to"].as_i64(), begins, data, fates: BTreeMap::new() });
        assert!(before.is_none(), "{event}");
    }
    for event in trace {
        let loss = match event["event"].as_str() {
            Some("radio_arrived") => None,
            Some("radio_lost") => Some(event["cause"].as_str().expect("a cause").to_owned()),
            _ => continue,
        };
        let name = (integer(event, "from"), integer(event, "message"));
        let sent: &mut Sent = sent.get_mut(&name).unwrap_or_else(|| panic!("never sent: {event}"));
        let fate = (micros(&event["t_s"]), micros(&event["arrived_s"]), loss);
        let before = sent.fates.insert(integer(event, "robot"), fate);
        assert!(before.is_none(), "a second fate: {event}");
    }
    sent
}

/// The causes of the messages that were lost, in order of sender, number and receiver.
fn causes(trace: &[Value]) -> Vec<String> {
    let messages = messages(trace);
    messages.values().flat_map(|sent| sent.fates.values()).filter_map(|(_, _, loss)| loss.clone()).collect()
}

/// The reasons that the report gives, in the order of the robots.
fn reasons(scratch: &Scratch) -> Vec<String> {
    let report: Value = serde_json::from_str(&scratch.read("report.json")).expect("a report is JSON");
    let robots = report["robots"].as_array().expect("robots");
    robots.iter().map(|robot| robot["reason"].as_str().unwrap_or_default().to_owned()).collect()
}

/// Lines that a C program needs to check answers: `IS(call, answer)`.
const IS: &str = r#"
#include "eyebot.h"
#include <stdio.h>
#include <string.h>
#define IS(call, answer) do { long is = (long)(call); \
    if (is != (long)(answer)) printf("line %d: %s is %ld\n", __LINE__, #call, is); } while (0)
"#;

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

/// Sends three messages back to where they come from.
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
        assert_eq!([said(&trace, 1), said(&trace, 2)], [["done"], ["done"]]);
        let hints: Vec<_> =
            trace.iter().filter(|event| event["event"] == "hint").map(|it| it["text"].as_str()).collect();
        let tells = |words: &str| hints.iter().flatten().any(|hint| hint.contains(words));
        assert!(tells("`RADIOSend` returned 1: the radio is off: `RADIOInit` switches it on"), "{hints:?}");
        assert!(tells("`RADIOInit` returned -1: the radio is on already"), "{hints:?}");
        assert!(tells("`RADIOGetIoctl` returned -1: no place for the settings"), "{hints:?}");
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
    /* Both answer to what goes to everybody. */
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

const ECHO_7: &str = r#"
int main(void)
{
    int id;
    static char text[1024];
    IS(RADIOInit(), 0);
    while (RADIOReceive(&id, text, sizeof text) == 0)
        IS(RADIOSend(id, text), 0);
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
        assert_eq!([said(&trace, 1), said(&trace, 2), said(&trace, 3)], [vec!["done"], vec![], vec![]]);
        let reason = &reasons(&scratch)[1];
        assert!(reason.contains("(all programs that have not ended wait for messages from each other)"), "{reason}");
    }
}

/// Sends at random, and takes what comes; robots 1 and 2 also wait for it.
const RANDOM_6: &str = r#"
#include "eyebot.h"
#include <stdlib.h>
int main(void)
{
    BYTE from, buffer[MAXMSGLEN];
    int i, j, n;
    srand(OSMachineID());
    RADIOInit();
    for (;;) {
        switch (rand() % 4) {
        case 0:
            OSWait(rand() % 8);
            break;
        case 1:
            for (i = rand() % 4; i > 0; i--) {
                n = rand() % (MAXMSGLEN + 1);
                for (j = 0; j < n; j++)
                    buffer[j] = rand();
                RADIOSend(rand() % 2 ? BROADCAST : 1 + rand() % 4, n, buffer);
            }
            break;
        case 2:
            while (RADIOCheck() > 0)
                RADIORecv(&from, &n, buffer);
            break;
        case 3:
            if (OSMachineID() <= 2 && rand() % 4 == 0)
                RADIORecv(&from, &n, buffer);
        }
    }
}
"#;

const RANDOM_7: &str = r#"
#include "eyebot.h"
#include <stdlib.h>
int main(void)
{
    int i, j, n, id;
    char text[200];
    srand(RADIOGetID());
    RADIOInit();
    for (;;) {
        OSWait(rand() % 40);
        for (i = rand() % 4; i > 0; i--) {
            n = rand() % 200;
            for (j = 0; j < n; j++)
                text[j] = 1 + rand() % 255;
            text[j] = 0;
            RADIOSend(rand() % 5, text);
        }
        if (rand() % 3 == 0)
            while (RADIOCheck() > 0)
                RADIOReceive(&id, text, sizeof text);
    }
}
"#;

/// Checks a trace of four robots whose radios are on from the start, on a free medium: when messages begin, arrive and can be
/// seen, that each has a fate at each receiver, and that they are taken in order.
fn check_traffic(trace: &[Value], slot: i64, baud: i64, latency: i64) -> usize {
    let all = messages(trace);
    let end = micros(&trace.last().expect("events")["t_s"]);
    let mut free = BTreeMap::new();
    for ((from, number), sent) in &all {
        let begins = sent.at.max(free.get(from).copied().unwrap_or_default());
        assert_eq!(sent.begins, Some(begins), "{from} {number} {sent:?}");
        let bits = 10 * (sent.data.as_array().expect("bytes").len() as i64 + 7);
        let ends = begins + (bits * 1_000_000 + baud - 1) / baud;
        free.insert(*from, ends);
        let receivers: Vec<i64> = match sent.to {
            None => (1..=4).filter(|robot| robot != from).collect(),
            Some(to) => vec![to],
        };
        assert_eq!(sent.fates.keys().copied().collect::<Vec<_>>(), receivers, "{from} {number} {sent:?}");
        let arrives = ends + latency;
        let visible = arrives.max((sent.at / slot + 1) * slot);
        for (time, arrived, loss) in sent.fates.values() {
            assert_eq!((*arrived, *time), (arrives, visible.min(end)), "{from} {number} {sent:?}");
            match loss.as_deref() {
                Some("end") => assert!(visible >= end, "{from} {number} {sent:?}"),
                Some("nobody") => assert_eq!(sent.to, Some(*from)),
                None | Some("packet" | "overflow") => {}
                Some(other) => panic!("{other}: {from} {number} {sent:?}"),
            }
        }
    }
    let mut last = BTreeMap::new();
    let mut received = 0;
    for event in trace.iter().filter(|event| event["event"] == "radio_received") {
        let (robot, from, number) = (integer(event, "robot"), integer(event, "from"), integer(event, "message"));
        let (visible, arrived, loss) = &all[&(from, number)].fates[&robot];
        let taken = micros(&event["t_s"]);
        assert!(*visible <= taken && loss.is_none(), "{event}");
        // What came before the last message that was taken cannot have been visible then.
        let key = (*arrived, from, number);
        if let Some((before, when)) = last.insert(robot, (key, taken)) {
            assert!(before < key || *visible > when, "{event} after {before:?}");
        }
        received += 1;
    }
    received
}

#[test]
fn messages_come_when_they_should_and_the_same_everywhere() {
    for (slot, baud, latency) in [(1, 115_200, 0), (7, 38_400, 2_500), (50, 115_200, 0), (200, 9_600, 100_000)] {
        let tables = format!(
            "[scene]\nnoise = {{ radio = {{ packet_loss = 0.1 }} }}\n\
             [radio]\nbaud = {baud}\nlatency_ms = {}\n",
            f64::from(latency) / 1e3
        );
        let scratch = row(&["six.c", "six.c", "seven.c", "seven.c"], &tables);
        scratch.write("six.c", RANDOM_6);
        scratch.write("seven.c", RANDOM_7);
        let (slot_ms, until) = (format!("{slot}"), if slot == 1 { "3" } else { "8" });
        let args = |rest: &[&'static str]| [&["--until", until, "--slot", &slot_ms], rest].concat();
        let (digest, trace) = traced(&scratch, &args(&[]), 0);
        let received = check_traffic(&trace, 1000 * slot, baud.into(), latency.into());
        assert!(received > 100, "{slot} ms: {received} messages");
        for rest in [&["--threads", "1"][..], &["--threads", "2"], &["--exec", "process"]] {
            assert_eq!(traced(&scratch, &args(rest), 0).0, digest, "{slot} ms {rest:?}");
        }
    }
}

#[test]
fn the_order_in_which_robots_are_listed_changes_nothing() {
    let robots = [("six.c", 300, 500), ("seven.c", 1700, 2000), ("six.c", 2300, 2000), ("seven.c", 3500, 3500)];
    for medium in ["free", "aloha", "token_ring"] {
        let run = |places: [usize; 4], threads: &str| {
            let robot = |place: usize| {
                let ((program, x, y), id) = (robots[place], place + 1);
                format!("[[robot]]\ntype = \"S4\"\nprogram = \"{program}\"\nid = {id}\nx_mm = {x}\ny_mm = {y}\n")
            };
            let tables = format!(
                "[scene]\nseed = 4\nnoise = {{ radio = {{ bit_error_rate = 1e-4, packet_loss = 0.05 }} }}\n\
                 [radio]\nmedium = \"{medium}\"\nlatency_ms = 1\nrange_mm = 4000\nline_of_sight = true\n{}",
                places.map(robot).concat()
            );
            let scratch = scene(&[], &tables);
            scratch.write("six.c", RANDOM_6);
            scratch.write("seven.c", RANDOM_7);
            let (digest, trace) = traced(&scratch, &["--until", "4", "--threads", threads], 0);
            let is_of_radio = |event: &Value| event["event"].as_str().is_some_and(|event| event.starts_with("radio"));
            (digest, trace.into_iter().filter(is_of_radio).collect::<Vec<_>>())
        };
        let (digest, events) = run([0, 1, 2, 3], "1");
        for event in ["radio_sent", "radio_arrived", "radio_lost", "radio_received"] {
            assert!(events.iter().filter(|it| it["event"] == event).count() > 20, "{medium}: {event}");
        }
        for (places, threads) in [([3, 2, 1, 0], "1"), ([2, 0, 3, 1], "2")] {
            let (other_digest, other_events) = run(places, threads);
            let differs = events.iter().zip(&other_events).find(|(one, other)| one != other);
            assert!(differs.is_none() && events.len() == other_events.len(), "{medium} {places:?}: {differs:?}");
            assert_eq!(digest, other_digest, "{medium} {places:?}");
        }
    }
}

/// Sends a message of 35 bytes as soon as it is on, and stays.
const SENDER: &str = r#"
#include "eyebot.h"
int main(void)
{
    BYTE bytes[MAXMSGLEN] = "from the sender";
    OSWait(1);
    RADIOInit();
    RADIOSend(BROADCAST, MAXMSGLEN, bytes);
    OSWait(200);
    return 0;
}
"#;

const RECEIVER: &str = r#"
#include "eyebot.h"
#include <stdio.h>
int main(void)
{
    BYTE from, bytes[MAXMSGLEN];
    int n;
    RADIOInit();
    RADIORecv(&from, &n, bytes);
    printf("%d bytes from %d: %s\n", n, from, bytes);
    return 0;
}
"#;

#[test]
fn a_robot_that_waits_is_woken_within_a_slot_when_its_message_is_visible() {
    // 42 bytes at 1200 baud take 350 ms.
    let scratch = row(&["sender.c", "receiver.c"], "[radio]\nbaud = 1200\n");
    scratch.write("sender.c", SENDER);
    scratch.write("receiver.c", RECEIVER);
    for slot in ["50", "80", "300"] {
        let (_, trace) = traced(&scratch, &["--slot", slot], 0);
        assert_eq!(said(&trace, 2), ["35 bytes from 1: from the sender"]);
        let sent = &messages(&trace)[&(1, 1)];
        let received = trace.iter().find(|event| event["event"] == "radio_received").expect("a message");
        assert_eq!(sent.begins, Some(sent.at));
        assert_eq!(micros(&received["t_s"]), sent.at + 350_000, "{slot}");
    }
}

#[test]
fn what_robots_do_with_a_wait_in_a_timer_or_beside_a_drive() {
    // A timer goes on while its program waits for a message, and the message is taken at its time.
    let scratch = row(&["sender.c", "receiver.c"], "[radio]\nbaud = 1200\n");
    scratch.write("sender.c", SENDER);
    let with_timer = RECEIVER
        .replace("int main", "static int ticks;\nstatic void tick(void) { ticks++; }\nint main")
        .replace("RADIOInit();", "RADIOInit();\n    OSAttachTimer(1, tick);")
        .replace("printf(", "printf(\"%d ticks, \", ticks); printf(");
    scratch.write("receiver.c", &with_timer);
    let (_, trace) = traced(&scratch, &[], 0);
    assert_eq!(said(&trace, 2), ["36 ticks, 35 bytes from 1: from the sender"]);
    let sent = &messages(&trace)[&(1, 1)];
    let received = trace.iter().find(|event| event["event"] == "radio_received").expect("a message");
    assert_eq!(micros(&received["t_s"]), sent.at + 350_000);

    // Its callback may take a message, but not wait for one.
    let in_callback = "
        #include \"eyebot.h\"
        static void tick(void) { BYTE b[MAXMSGLEN]; RADIORecv(0, 0, b); }
        int main(void) { RADIOInit(); OSAttachTimer(1, tick); OSWait(100); return 0; }";
    scratch.write("receiver.c", in_callback);
    traced(&scratch, &[], 1);
    assert_eq!(reasons(&scratch)[1], "`RADIORecv` would wait inside a timer callback");
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
    // At 9600 baud a message takes 40.6 ms, a call 0.5 ms: 100 calls end before two are sent.
    let scratch = row(&["sender.c", "receiver.c"], "[radio]\nbaud = 9600\n");
    scratch.write("sender.c", sender);
    scratch.write("receiver.c", receiver);
    let (_, trace) = traced(&scratch, &[], 0);
    let all = messages(&trace);
    assert_eq!(said(&trace, 1), [format!("{} sent, {} refused", all.len(), 100 - all.len())]);
    assert!((32..36).contains(&all.len()), "{}", all.len());
    let overflows = all.len() - 32;
    assert_eq!(causes(&trace), vec!["overflow"; overflows]);
    assert_eq!(said(&trace, 2), ["32 wait", "1024 bytes"]);
}

#[test]
fn range_and_walls_are_those_at_the_time_of_sending() {
    // Robot 1 at the left; 2 behind the wall, 3 behind it and far away, 4 beside the wall.
    let robots = [("sender.c", 1000, 2000), ("wait.c", 2500, 2000), ("wait.c", 3900, 2000), ("wait.c", 2500, 300)];
    let wait = "#include \"eyebot.h\"\nint main(void) { RADIOInit(); OSWait(100); return 0; }";
    for (radio, expected) in [
        ("", [None; 3]),
        ("line_of_sight = true", [Some("sight"), Some("sight"), None]),
        ("range_mm = 2500", [None, Some("range"), None]),
        ("range_mm = 2500\nline_of_sight = true", [Some("sight"), Some("range"), None]),
        ("range_mm = 1499", [Some("range"); 3]),
        ("range_mm = 1500", [None, Some("range"), Some("range")]),
    ] {
        let scratch = scene(&robots, &format!("[radio]\n{radio}\n"));
        scratch.write("sender.c", SENDER);
        scratch.write("wait.c", wait);
        let (_, trace) = traced(&scratch, &[], 0);
        let fates: Vec<_> = messages(&trace)[&(1, 1)].fates.values().map(|(_, _, loss)| loss.clone()).collect();
        assert_eq!(fates.iter().map(Option::as_deref).collect::<Vec<_>>(), expected, "{radio}");
    }
}

#[test]
fn who_waits_for_whom_is_told() {
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
    // The first ends while one of its messages is on the air and others wait; the second never hears the third message of the other.
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
fn what_is_on_its_way_when_the_run_ends_is_in_the_trace() {
    let scratch = row(&["sender.c", "receiver.c"], "[radio]\nbaud = 1200\n");
    scratch.write("sender.c", SENDER);
    scratch.write("receiver.c", RECEIVER);
    let (_, trace) = traced(&scratch, &["--until", "0.2"], 0);
    let (time, arrived, loss) = &messages(&trace)[&(1, 1)].fates[&2];
    assert_eq!((*time, loss.as_deref()), (200_000, Some("end")));
    assert!(*arrived > 350_000, "{arrived}");
    // The program of the receiver ends first: the message goes to nobody that lives.
    scratch.write("receiver.c", "#include \"eyebot.h\"\nint main(void) { RADIOInit(); OSWait(20); return 0; }");
    let (_, trace) = traced(&scratch, &[], 0);
    let (_, _, loss) = &messages(&trace)[&(1, 1)].fates[&2];
    assert_eq!(loss.as_deref(), Some("off"));
}

#[test]
fn garbled_messages_arrive_garbled_and_lost_ones_do_not() {
    let sender = "
        #include \"eyebot.h\"
        int main(void)
        {
            BYTE bytes[32] = {0};
            int i;
            RADIOInit();
            OSWait(10);
            for (i = 0; i < 500; i++) { RADIOSend(2, 32, bytes); OSWait(2); }
            return 0;
        }";
    let receiver = r#"
        #include "eyebot.h"
        #include <stdio.h>
        int main(void)
        {
            BYTE bytes[MAXMSGLEN];
            int i, n, got = 0, wrong = 0;
            RADIOInit();
            while (OSGetCount() < 1200) {
                while (RADIOCheck() > 0) {
                    RADIORecv(0, &n, bytes);
                    got++;
                    for (i = 0; i < 8 * n; i++) wrong += bytes[i / 8] >> i % 8 & 1;
                }
                OSWait(1);
            }
            printf("%d %d\n", got, wrong);
            return 0;
        }"#;
    let tables = "[scene]\nnoise = { radio = { bit_error_rate = 0.01, packet_loss = 0.2 } }\n";
    let scratch = row(&["sender.c", "receiver.c"], tables);
    scratch.write("sender.c", sender);
    scratch.write("receiver.c", receiver);
    let (_, trace) = traced(&scratch, &[], 0);
    let arrived: Vec<&Value> = trace.iter().filter(|event| event["event"] == "radio_arrived").collect();
    let wrong: i64 = arrived.iter().map(|event| integer(event, "bit_errors")).sum();
    assert_eq!(said(&trace, 2), [format!("{} {wrong}", arrived.len())]);
    assert_eq!(causes(&trace).len() + arrived.len(), 500);
    // Means of 400 and 1024, standard deviations of 9 and 32.
    assert!((350..450).contains(&arrived.len()) && (850..1200).contains(&wrong), "{} {wrong}", arrived.len());
    let received = trace.iter().filter(|event| event["event"] == "radio_received");
    for (event, arrived) in received.zip(&arrived) {
        let bytes = event["data"].as_array().expect("bytes").iter().map(|byte| byte.as_u64().expect("a byte"));
        assert_eq!(bytes.map(u64::count_ones).sum::<u32>() as i64, integer(arrived, "bit_errors"));
    }
}

#[test]
fn a_flood_of_messages_stays_in_bounds() {
    // Empty ones take no room but that of their headers.
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
    let mut command = Command::new("sh");
    // 64 MiB of address space more than a run of these programs takes would do; a list without bound takes more than a GiB.
    command.args(["-c", "ulimit -v 4000000; exec \"$0\" run scene.scene.toml"]).arg(tests::eyesim_path());
    let ran = Ran::from(command.current_dir(scratch.path()).output().expect("a shell"));
    assert_eq!(ran.code, Some(0), "{ran:#?}");
    assert!(ran.stdout.contains(" sent"), "{ran:#?}");
}

#[test]
fn each_task_of_a_robot_can_wait_for_messages() {
    // 22 bytes at 1200 baud take 183334 us.
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
        assert_eq!(said(&trace, 2), [format!("fifteen letters at {}", (sent.at + 183_334) / 1000)]);
    }
}

#[test]
fn of_messages_that_meet_in_the_air_none_is_heard() {
    let sender = |ms: u32| {
        format!(
            "#include \"eyebot.h\"\nint main(void) {{ RADIOInit(); OSWait({ms}); RADIOSend(3, \"123\"); OSWait(200); return 0; }}"
        )
    };
    let listener = "#include \"eyebot.h\"\nint main(void) { RADIOInit(); OSWait(300); return 0; }";
    // 10 bytes at 9600 baud take 10.4 ms.
    for (medium, first, second, expected) in [
        ("aloha", 100, 100, vec!["collision"; 2]),
        ("aloha", 100, 110, vec!["collision"; 2]),
        ("aloha", 100, 111, vec![]),
        ("token_ring", 100, 100, vec![]),
        ("free", 100, 100, vec![]),
    ] {
        let scratch =
            row(&["first.c", "second.c", "listener.c"], &format!("[radio]\nmedium = \"{medium}\"\nbaud = 9600\n"));
        scratch.write("first.c", &sender(first));
        scratch.write("second.c", &sender(second));
        scratch.write("listener.c", listener);
        let (_, trace) = traced(&scratch, &["--api", "7"], 0);
        assert_eq!(causes(&trace), expected, "{medium} {first} {second}");
        let heard = trace.iter().filter(|event| event["event"] == "radio_arrived").count();
        assert_eq!(heard, 2 - expected.len(), "{medium} {first} {second}");
    }
}

/// Four robots that send at random, on another medium, with errors; `order` is that in which the scene lists them.
fn crowd(medium: &str, order: [usize; 4]) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("room.wld", "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n");
    scratch.write("six.c", RANDOM_6);
    scratch.write("seven.c", RANDOM_7);
    let mut text = format!(
        "[scene]\nnoise = \"harsh\"\n[world]\nfile = \"room.wld\"\n[radio]\nmedium = \"{medium}\"\nlatency_ms = 3\n\
         range_mm = 2000\n"
    );
    for id in order {
        let program = ["six.c", "six.c", "seven.c", "seven.c"][id - 1];
        let x = 800 * id;
        text += &format!("[[robot]]\nid = {id}\ntype = \"S4\"\nprogram = \"{program}\"\nx_mm = {x}\ny_mm = 500\n");
    }
    scratch.write("scene.scene.toml", &text);
    scratch
}

#[test]
fn other_media_give_one_digest_however_they_are_run_and_listed() {
    for medium in ["free", "aloha", "token_ring"] {
        let listed = crowd(medium, [1, 2, 3, 4]);
        let (digest, trace) = traced(&listed, &["--until", "5"], 0);
        let all = messages(&trace);
        assert!(all.len() > 100, "{medium}: {}", all.len());
        assert!(
            all.values().all(|sent| !sent.fates.is_empty()),
            "{medium}: {:?}",
            all.iter().find(|(_, sent)| sent.fates.is_empty())
        );
        for (from, sent) in &all {
            let fates = sent.fates.values().filter(|(_, _, loss)| loss.is_none());
            for (time, arrived, _) in fates {
                assert!(sent.at < *arrived && arrived <= time, "{medium} {from:?} {sent:?}");
                assert!(medium == "free" || time - arrived <= 50_000, "{medium} {from:?} {sent:?}");
            }
        }
        let arrived = trace.iter().filter(|event| event["event"] == "radio_arrived").count();
        let seen = |cause: &str| causes(&trace).iter().any(|it| it == cause);
        assert!(arrived > 100 && seen("packet") && seen("range"), "{medium}: {arrived}");
        assert_eq!(seen("collision"), medium == "aloha");
        let other = crowd(medium, [3, 1, 4, 2]);
        for args in [&["--threads", "1"][..], &["--threads", "2"], &["--exec", "process"]] {
            for scratch in [&listed, &other] {
                assert_eq!(traced(scratch, &[args, &["--until", "5"]].concat(), 0).0, digest, "{medium} {args:?}");
            }
        }
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
        said(&trace, 1),
        ["1 (0, '') 0 []", "0 1 1", "[1, 2] 0 0 1", "2 (2, 'hello') (2, 'by')", "0 1"],
        "{:?}",
        said(&trace, 1)
    );
}
