//! Mutated seeds, with pieces changed, removed, duplicated and exchanged, like a fuzzer's first steps; they are part of
//! every test run.

use std::fs;
use std::path::Path;

use fuzzing::{TARGETS, check};
use proptest::prelude::*;
use proptest::sample::Index;

/// Tokens with a meaning in one of the formats, or similar to such tokens.
const PIECES: &[&str] = &[
    "\n",
    "\r",
    "\r\n",
    "\t",
    " ",
    ";",
    "#",
    "\"",
    "'",
    "|",
    "_",
    "-",
    "(",
    ")",
    ",",
    "=",
    "[",
    "]",
    "{",
    "}",
    "0",
    "-0",
    "1e308",
    "-1e9",
    "1e9",
    "nan",
    "inf",
    "255",
    "256",
    "360",
    "0.5",
    "pop\n",
    "push 9e8 0 45\n",
    "\u{feff}",
    "\u{fffd}",
    "é",
    "\0",
    "\u{1b}[2J",
    "\u{2028}",
    "\u{202e}",
    "-- b.wld --\n",
];

/// One change of an input.
#[derive(Clone, Debug)]
enum Change {
    Byte(Index, u8),
    Remove(Index, Index),
    Insert(Index, Index),
    /// Copies the first piece to the second position.
    Copy(Index, Index, Index),
}

fn change() -> impl Strategy<Value = Change> {
    let index = any::<Index>;
    prop_oneof![
        (index(), any::<u8>()).prop_map(|(at, byte)| Change::Byte(at, byte)),
        (index(), index()).prop_map(|(from, to)| Change::Remove(from, to)),
        (index(), index()).prop_map(|(at, piece)| Change::Insert(at, piece)),
        (index(), index(), index()).prop_map(|(from, to, at)| Change::Copy(from, to, at)),
    ]
}

fn apply(change: &Change, bytes: &mut Vec<u8>) {
    let at = |index: &Index| index.index(bytes.len() + 1);
    let range = |from: &Index, to: &Index| at(from).min(at(to))..at(from).max(at(to));
    match change {
        Change::Byte(position, byte) => {
            let position = at(position);
            if let Some(old) = bytes.get_mut(position) {
                *old = *byte;
            }
        }
        Change::Remove(from, to) => drop(bytes.drain(range(from, to))),
        Change::Insert(position, piece) => {
            let position = at(position);
            drop(bytes.splice(position..position, PIECES[piece.index(PIECES.len())].bytes()));
        }
        Change::Copy(from, to, position) => {
            let (copy, position) = (bytes[range(from, to)].to_vec(), at(position));
            drop(bytes.splice(position..position, copy));
        }
    }
}

fn seeds(target: &str) -> Vec<Vec<u8>> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../fuzz/seeds")).join(target);
    let mut paths: Vec<_> = fs::read_dir(folder).expect("seeds").map(|entry| entry.expect("a file").path()).collect();
    paths.sort();
    paths.iter().map(|path| fs::read(path).expect("a readable file")).collect()
}

/// Input with a `Debug` output as a byte string.
#[derive(Clone)]
struct ByteString(Vec<u8>);

impl std::fmt::Debug for ByteString {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "b\"{}\"", self.0.escape_ascii())
    }
}

#[test]
fn mutated_seeds_cause_no_failure() {
    for target in TARGETS {
        let seeds = seeds(target.name);
        let input = (any::<Index>(), prop::collection::vec(change(), 1..12)).prop_map(|(seed, changes)| {
            let mut bytes = seeds[seed.index(seeds.len())].clone();
            changes.iter().for_each(|change| apply(change, &mut bytes));
            ByteString(bytes)
        });
        let mut runner = proptest::test_runner::TestRunner::new(ProptestConfig {
            cases: 512,
            failure_persistence: None,
            ..ProptestConfig::default()
        });
        runner
            .run(&input, |input| {
                check(target.name, &input.0);
                Ok(())
            })
            .unwrap_or_else(|error| panic!("{}: {error}", target.name));
    }
}
