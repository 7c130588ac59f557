//! Radio traffic: arrival times and fates of messages, equal for all executors, thread counts and slot lengths.

use std::collections::BTreeMap;

use serde_json::Value;
use tests::Scratch;
use tests::radio::{RECEIVER, SENDER, causes, integer, messages, micros, printed, row, scene, traced};

/// Sends and receives at random; robots 1 and 2 also wait for messages.
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

/// Checks a trace of four robots on a free medium whose radios are on from the start: when each message begins, arrives
/// and becomes visible, that it has a fate at each receiver, and that messages are received in order. Returns the
/// number of received messages.
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
        let received_at = micros(&event["t_s"]);
        assert!(*visible <= received_at && loss.is_none(), "{event}");
        // A message that arrived before the previous received one cannot have been visible when that one was received.
        let key = (*arrived, from, number);
        if let Some((before, when)) = last.insert(robot, (key, received_at)) {
            assert!(before < key || *visible > when, "{event} after {before:?}");
        }
        received += 1;
    }
    received
}

#[test]
fn messages_arrive_on_time_and_identically_on_every_kind_of_flow() {
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
        let run = |positions: [usize; 4], threads: &str| {
            let robot = |position: usize| {
                let ((program, x, y), id) = (robots[position], position + 1);
                format!("[[robot]]\ntype = \"S4\"\nprogram = \"{program}\"\nid = {id}\nx_mm = {x}\ny_mm = {y}\n")
            };
            let tables = format!(
                "[scene]\nseed = 4\nnoise = {{ radio = {{ bit_error_rate = 1e-4, packet_loss = 0.05 }} }}\n\
                 [radio]\nmedium = \"{medium}\"\nlatency_ms = 1\nrange_mm = 4000\nline_of_sight = true\n{}",
                positions.map(robot).concat()
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
        for (positions, threads) in [([3, 2, 1, 0], "1"), ([2, 0, 3, 1], "2")] {
            let (other_digest, other_events) = run(positions, threads);
            let differs = events.iter().zip(&other_events).find(|(one, other)| one != other);
            assert!(differs.is_none() && events.len() == other_events.len(), "{medium} {positions:?}: {differs:?}");
            assert_eq!(digest, other_digest, "{medium} {positions:?}");
        }
    }
}

#[test]
fn a_robot_that_waits_is_woken_within_a_slot_when_its_message_is_visible() {
    // A message of 42 bytes takes 350 ms at 1200 baud.
    let scratch = row(&["sender.c", "receiver.c"], "[radio]\nbaud = 1200\n");
    scratch.write("sender.c", SENDER);
    scratch.write("receiver.c", RECEIVER);
    for slot in ["50", "80", "300"] {
        let (_, trace) = traced(&scratch, &["--slot", slot], 0);
        assert_eq!(printed(&trace, 2), ["35 bytes from 1: from the sender"]);
        let sent = &messages(&trace)[&(1, 1)];
        let received = trace.iter().find(|event| event["event"] == "radio_received").expect("a message");
        assert_eq!(sent.begins, Some(sent.at));
        assert_eq!(micros(&received["t_s"]), sent.at + 350_000, "{slot}");
    }
}

#[test]
fn range_and_walls_are_those_at_the_time_of_sending() {
    // Robot 1 is at the left, 2 behind the wall, 3 behind it and far away, 4 beside the wall.
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
    assert_eq!(printed(&trace, 2), [format!("{} {wrong}", arrived.len())]);
    assert_eq!(causes(&trace).len() + arrived.len(), 500);
    // The expected means are 400 and 1024, with standard deviations of 9 and 32.
    assert!((350..450).contains(&arrived.len()) && (850..1200).contains(&wrong), "{} {wrong}", arrived.len());
    let received = trace.iter().filter(|event| event["event"] == "radio_received");
    for (event, arrived) in received.zip(&arrived) {
        let bytes = event["data"].as_array().expect("bytes").iter().map(|byte| byte.as_u64().expect("a byte"));
        assert_eq!(bytes.map(u64::count_ones).sum::<u32>() as i64, integer(arrived, "bit_errors"));
    }
}

#[test]
fn colliding_messages_are_lost_except_on_the_free_medium() {
    let sender = |ms: u32| {
        format!(
            "#include \"eyebot.h\"\nint main(void) {{ RADIOInit(); OSWait({ms}); RADIOSend(3, \"123\"); OSWait(200); return 0; }}"
        )
    };
    let listener = "#include \"eyebot.h\"\nint main(void) { RADIOInit(); OSWait(300); return 0; }";
    // A message of 10 bytes takes 10.4 ms at 9600 baud.
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
        let arrivals = trace.iter().filter(|event| event["event"] == "radio_arrived").count();
        assert_eq!(arrivals, 2 - expected.len(), "{medium} {first} {second}");
    }
}

/// Writes a scene with four robots that send at random on this medium, with transmission errors.
fn crowd(medium: &str) -> Scratch {
    let scratch = Scratch::new();
    scratch.write("room.wld", "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n");
    scratch.write("six.c", RANDOM_6);
    scratch.write("seven.c", RANDOM_7);
    let mut text = format!(
        "[scene]\nnoise = \"harsh\"\n[world]\nfile = \"room.wld\"\n[radio]\nmedium = \"{medium}\"\nlatency_ms = 3\n\
         range_mm = 2000\n"
    );
    for id in 1..=4 {
        let program = ["six.c", "six.c", "seven.c", "seven.c"][id - 1];
        let x = 800 * id;
        text += &format!("[[robot]]\ntype = \"S4\"\nprogram = \"{program}\"\nx_mm = {x}\ny_mm = 500\n");
    }
    scratch.write("scene.scene.toml", &text);
    scratch
}

#[test]
fn other_media_give_one_digest_however_they_are_run() {
    for medium in ["free", "aloha", "token_ring"] {
        let scratch = crowd(medium);
        let (digest, trace) = traced(&scratch, &["--until", "5"], 0);
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
        let has_cause = |cause: &str| causes(&trace).iter().any(|it| it == cause);
        assert!(arrived > 100 && has_cause("packet") && has_cause("range"), "{medium}: {arrived}");
        assert_eq!(has_cause("collision"), medium == "aloha");
        for args in [&["--threads", "1"][..], &["--threads", "2"], &["--exec", "process"]] {
            assert_eq!(traced(&scratch, &[args, &["--until", "5"]].concat(), 0).0, digest, "{medium} {args:?}");
        }
    }
}
