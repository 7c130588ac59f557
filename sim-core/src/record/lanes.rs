//! BLAKE3 of several short messages in parallel, one in each SIMD lane. One short message alone does not fill the lanes.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch, u32x8};

/// Number of messages that are hashed in parallel.
pub(super) const LANES: usize = 8;

/// Maximum length of a message, in bytes: one chunk of the hash tree.
pub(super) const MAX_LEN: usize = blake3::CHUNK_LEN;

/// Length of a block in bytes.
const BLOCK_LEN: usize = blake3::BLOCK_LEN;

/// Number of words of a block.
const WORDS: usize = BLOCK_LEN / 4;

/// Initial chaining value. Source of this and of the remaining constants and functions: BLAKE3 specification, section 2.2.
const IV: [u32; 8] =
    [0x6a09_e667, 0xbb67_ae85, 0x3c6e_f372, 0xa54f_f53a, 0x510e_527f, 0x9b05_688c, 0x1f83_d9ab, 0x5be0_cd19];

const CHUNK_START: u32 = 1;
const CHUNK_END: u32 = 2;
const ROOT: u32 = 8;

/// Order of the words of a block in each round.
const SCHEDULE: [[usize; WORDS]; 7] = schedule();

const fn schedule() -> [[usize; WORDS]; 7] {
    const PERMUTATION: [usize; WORDS] = [2, 6, 3, 10, 7, 0, 4, 13, 1, 11, 12, 5, 9, 14, 15, 8];
    let mut rounds = [[0; WORDS]; 7];
    let mut index = 0;
    while index < WORDS {
        rounds[0][index] = index;
        index += 1;
    }
    let mut round = 1;
    while round < 7 {
        index = 0;
        while index < WORDS {
            rounds[round][index] = rounds[round - 1][PERMUTATION[index]];
            index += 1;
        }
        round += 1;
    }
    rounds
}

/// Hashes each of the messages.
///
/// # Panics
/// If a message is longer than [`MAX_LEN`].
pub(super) fn hash(level: Level, messages: &[&[u8]; LANES]) -> [[u8; 32]; LANES] {
    assert!(messages.iter().all(|message| message.len() <= MAX_LEN), "a lane takes one chunk");
    dispatch!(level, simd => hash_lanes(simd, messages))
}

#[inline(always)]
fn hash_lanes<S: Simd>(simd: S, messages: &[&[u8]; LANES]) -> [[u8; 32]; LANES] {
    let mut hashes = [[0; 32]; LANES];
    let mut value = IV.map(|word| u32x8::splat(simd, word));
    let mut blocks = [0; LANES];
    let mut max_blocks = 0;
    for lane in 0..LANES {
        blocks[lane] = messages[lane].len().div_ceil(BLOCK_LEN).max(1);
        max_blocks = max_blocks.max(blocks[lane]);
    }
    for block in 0..max_blocks {
        let mut words = [[0_u32; LANES]; WORDS];
        let (mut lens, mut flags) = ([0; LANES], [0; LANES]);
        for lane in 0..LANES {
            let rest = messages[lane].get(block * BLOCK_LEN..).unwrap_or_default();
            lens[lane] = rest.len().min(BLOCK_LEN) as u32;
            if block == 0 {
                flags[lane] |= CHUNK_START;
            }
            if block + 1 == blocks[lane] {
                flags[lane] |= CHUNK_END | ROOT;
            }
            let mut padded = [0; BLOCK_LEN];
            let bytes = if let Some(whole) = rest.first_chunk() {
                whole
            } else {
                padded[..rest.len()].copy_from_slice(rest);
                &padded
            };
            for (word, bytes) in words.iter_mut().zip(bytes.as_chunks().0) {
                word[lane] = u32::from_le_bytes(*bytes);
            }
        }
        value = compress(simd, value, &words, lens, flags);
        let mut is_any_done = false;
        for &block_count in &blocks {
            is_any_done |= block + 1 == block_count;
        }
        if is_any_done {
            for index in 0..8 {
                for lane in 0..LANES {
                    if block + 1 == blocks[lane] {
                        hashes[lane][4 * index..][..4].copy_from_slice(&value[index][lane].to_le_bytes());
                    }
                }
            }
        }
    }
    hashes
}

/// Returns the chaining values after one more block of each message.
#[inline(always)]
fn compress<S: Simd>(
    simd: S,
    value: [u32x8<S>; 8],
    words: &[[u32; LANES]; WORDS],
    lens: [u32; LANES],
    flags: [u32; LANES],
) -> [u32x8<S>; 8] {
    let [a, b, c, d, e, f, g, h] = value;
    let zero = u32x8::splat(simd, 0);
    let mut state = [
        a,
        b,
        c,
        d,
        e,
        f,
        g,
        h,
        u32x8::splat(simd, IV[0]),
        u32x8::splat(simd, IV[1]),
        u32x8::splat(simd, IV[2]),
        u32x8::splat(simd, IV[3]),
        zero,
        zero,
        u32x8::simd_from(simd, lens),
        u32x8::simd_from(simd, flags),
    ];
    for order in &SCHEDULE {
        mix(simd, &mut state, [0, 4, 8, 12], words, [order[0], order[1]]);
        mix(simd, &mut state, [1, 5, 9, 13], words, [order[2], order[3]]);
        mix(simd, &mut state, [2, 6, 10, 14], words, [order[4], order[5]]);
        mix(simd, &mut state, [3, 7, 11, 15], words, [order[6], order[7]]);
        mix(simd, &mut state, [0, 5, 10, 15], words, [order[8], order[9]]);
        mix(simd, &mut state, [1, 6, 11, 12], words, [order[10], order[11]]);
        mix(simd, &mut state, [2, 7, 8, 13], words, [order[12], order[13]]);
        mix(simd, &mut state, [3, 4, 9, 14], words, [order[14], order[15]]);
    }
    let [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = state;
    [a ^ i, b ^ j, c ^ k, d ^ l, e ^ m, f ^ n, g ^ o, h ^ p]
}

/// Mixes four words of the state with two words of the block.
#[inline(always)]
fn mix<S: Simd>(
    simd: S,
    state: &mut [u32x8<S>; 16],
    [a, b, c, d]: [usize; 4],
    words: &[[u32; LANES]; WORDS],
    [first, second]: [usize; 2],
) {
    state[a] = state[a] + state[b] + u32x8::simd_from(simd, words[first]);
    state[d] = rotate_right(state[d] ^ state[a], 16);
    state[c] += state[d];
    state[b] = rotate_right(state[b] ^ state[c], 12);
    state[a] = state[a] + state[b] + u32x8::simd_from(simd, words[second]);
    state[d] = rotate_right(state[d] ^ state[a], 8);
    state[c] += state[d];
    state[b] = rotate_right(state[b] ^ state[c], 7);
}

/// Rotates the words right by `count` bits.
#[inline(always)]
fn rotate_right<S: Simd>(words: u32x8<S>, count: u32) -> u32x8<S> {
    words >> count | words << (32 - count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parallel_hashes_match_the_blake3_crate() {
        let bytes: Vec<u8> = (0..MAX_LEN).map(|index| (index * 31 % 251) as u8).collect();
        let simd_levels = [Level::fallback(), Level::baseline(), Level::new()];
        for level in simd_levels {
            for first in [0, 1, 31, 57, 60, 63, 64, 65, 127, 128, 300, 500, 960, 1_017] {
                let messages = std::array::from_fn(|lane| &bytes[..(first + lane * lane % 7).min(MAX_LEN)]);
                let expected = messages.map(|message| *blake3::hash(message).as_bytes());
                assert_eq!(hash(level, &messages), expected, "from {first} bytes on");
            }
            let lens = [0, 1024, 64, 3, 1000, 65, 352, 128];
            let messages = lens.map(|len| &bytes[..len]);
            assert_eq!(hash(level, &messages), messages.map(|message| *blake3::hash(message).as_bytes()), "mixed");
        }
    }
}
