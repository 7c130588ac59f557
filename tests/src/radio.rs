//! Helpers for the tests of the radio: a scene, and the events of its trace by message.

use std::collections::BTreeMap;

use serde_json::Value;

use crate::Scratch;

/// Writes `scene.scene.toml`: a room of 4 m by 4 m with a wall of 2 m in its middle, and robots with these programs
/// at these positions in mm.
pub fn scene(robots: &[(&str, i32, i32)], tables: &str) -> Scratch {
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

/// Writes the same scene as [`scene`] with the robots in a row, 300 mm apart.
pub fn row(programs: &[&str], tables: &str) -> Scratch {
    let robots: Vec<_> =
        programs.iter().enumerate().map(|(index, program)| (*program, 300 + 300 * index as i32, 500)).collect();
    scene(&robots, tables)
}

/// Runs the scene and returns the digest and the trace.
pub fn traced(scratch: &Scratch, args: &[&str], code: i32) -> (Value, Vec<Value>) {
    let report = scratch.report("scene.scene.toml", &[args, &["--trace", "t.jsonl"]].concat(), code);
    (report["digest"].clone(), scratch.trace("t.jsonl"))
}

/// Lines printed by robot `id`.
///
/// # Panics
/// If the trace is malformed.
pub fn printed(trace: &[Value], id: u64) -> Vec<&str> {
    let is_said = |event: &&Value| event["event"] == "stdout" && event["robot"] == id;
    trace.iter().filter(is_said).map(|event| event["text"].as_str().expect("text")).collect()
}

/// Converts a time in seconds to microseconds.
///
/// # Panics
/// If the value is not a time.
pub fn micros(seconds: &Value) -> i64 {
    (seconds.as_f64().unwrap_or_else(|| panic!("{seconds} is a time")) * 1e6).round() as i64
}

/// A field of an event.
///
/// # Panics
/// If the field is not an integer.
pub fn integer(event: &Value, key: &str) -> i64 {
    event[key].as_i64().unwrap_or_else(|| panic!("`{key}` in {event}"))
}

/// A sent message and its events in the trace; times in microseconds.
#[derive(Debug)]
pub struct Sent {
    /// Time at which the program sent the message.
    pub at: i64,
    /// Address of the receiver; `None` for a broadcast.
    pub to: Option<i64>,
    /// Start of the transmission, if the sender knows it.
    pub begins: Option<i64>,
    /// Bytes of the message.
    pub data: Value,
    /// For each receiver: time at which the message's fate was known, time of arrival, and cause of loss if the message
    /// was lost.
    pub fates: BTreeMap<i64, (i64, i64, Option<String>)>,
}

/// Sender and number of a message.
pub type Name = (i64, i64);

/// All messages of a trace.
///
/// # Panics
/// If a fate is reported twice, or for a message that was never sent.
pub fn messages(trace: &[Value]) -> BTreeMap<Name, Sent> {
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
pub fn causes(trace: &[Value]) -> Vec<String> {
    let messages = messages(trace);
    messages.values().flat_map(|sent| sent.fates.values()).filter_map(|(_, _, loss)| loss.clone()).collect()
}

/// The reasons of the robots in the report, in the order of the robots.
///
/// # Panics
/// If there is no report.
pub fn reasons(scratch: &Scratch) -> Vec<String> {
    let report: Value = serde_json::from_str(&scratch.read("report.json")).expect("a report is JSON");
    let robots = report["robots"].as_array().expect("robots");
    robots.iter().map(|robot| robot["reason"].as_str().unwrap_or_default().to_owned()).collect()
}

/// First lines of a C program that checks return values: `IS(call, expected)`.
pub const IS: &str = r#"
#include "eyebot.h"
#include <stdio.h>
#include <string.h>
#define IS(call, answer) do { long is = (long)(call); \
    if (is != (long)(answer)) printf("line %d: %s is %ld\n", __LINE__, #call, is); } while (0)
"#;

/// Echoes every text to its sender.
pub const ECHO_7: &str = r#"
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

/// Sends a message of 35 bytes as soon as its radio is on, and keeps running.
pub const SENDER: &str = r#"
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

/// Prints the first message that it receives.
pub const RECEIVER: &str = r#"
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
