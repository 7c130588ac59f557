//! Bit errors and lost messages, compared with the binary symmetric channel.

use accuracy::statistics::{binomial, chi_squared, uncorrelated};
use accuracy::world::Random;

use super::*;

const MILLION: usize = 1_000_000;
/// Number of bits of a message.
const BITS: usize = 256;

/// Outcome of sending messages of [`BITS`] bits through a channel.
struct Sample {
    /// Positions of the bit errors of each message that arrived, ascending.
    messages: Vec<Vec<u16>>,
    lost: u64,
}

/// Sends `count` messages of zeros from robot 2 to robot 1.
fn sample(errors: RadioNoise, count: usize) -> Sample {
    let mut channel = channel(RadioModel::default(), vec![errors], 2);
    let mut messages = Vec::new();
    let mut lost = 0;
    for batch in 0..count.div_ceil(1000) {
        let sequences = 1000 * batch..(1000 * (batch + 1)).min(count);
        let one = |sequence| {
            let sent = Time::from_millis(sequence as i64);
            message_from(2, sequence as u64 + 1, Address::One(1), vec![0; BITS / 8], sent)
        };
        for delivery in channel.exchange(Time::from_millis(1000 * batch as i64), sequences.map(one).collect()) {
            match delivery.outcome {
                Ok(arrived) => messages.push(wrong_bits(&arrived)),
                Err(loss) => {
                    assert_eq!(loss, Loss::Packet);
                    lost += 1;
                }
            }
        }
    }
    assert_eq!(messages.len() + lost, count);
    Sample { messages, lost: lost as u64 }
}

fn wrong_bits(arrived: &Arrived) -> Vec<u16> {
    let bytes = || arrived.payload.iter().enumerate().filter(|(_, byte)| **byte != 0);
    let bits = |(index, byte): (usize, &u8)| {
        let byte = *byte;
        (0..8).filter(move |bit| byte >> bit & 1 == 1).map(move |bit| (8 * index + bit) as u16)
    };
    let wrong: Vec<u16> = bytes().flat_map(bits).collect();
    assert_eq!(wrong.len(), arrived.bit_errors as usize);
    wrong
}

/// p-values of a sample under the hypothesis of independent bit errors with probability `p`, each with the name of its
/// test.
fn p_values(messages: &[Vec<u16>], p: f64) -> Vec<(String, f64)> {
    let bits = (messages.len() * BITS) as u64;
    let wrong_positions = || messages.iter().flatten();
    let errors = wrong_positions().count();
    let mut results = vec![("rate".to_owned(), binomial(errors as u64, bits, p))];

    let mut positions = vec![0.0; BITS];
    wrong_positions().for_each(|bit| positions[usize::from(*bit)] += 1.0);
    results.push(("positions".to_owned(), chi_squared(&positions, &[errors as f64 / BITS as f64; BITS])));

    // Joining the messages without a gap keeps the gaps between errors geometric.
    let wrong_bits = messages
        .iter()
        .enumerate()
        .flat_map(|(message, wrong)| wrong.iter().map(move |bit| (message * BITS + usize::from(*bit)) as u64));
    let wrong_bits: Vec<u64> = wrong_bits.collect();
    let longest = (10.0 / p) as usize + 2;
    let mut gaps = vec![0.0; longest];
    wrong_bits.windows(2).for_each(|pair| gaps[((pair[1] - pair[0] - 1) as usize).min(longest - 1)] += 1.0);
    let mut remaining = wrong_bits.len() as f64 - 1.0;
    let mut expected = Vec::new();
    for _ in 1..longest {
        expected.push(remaining * p);
        remaining *= 1.0 - p;
    }
    expected.push(remaining);
    results.push(("gaps".to_owned(), chi_squared(&gaps, &expected)));

    for lag in [1, 2, 7, 8, 16, BITS as u64] {
        let mut pairs = 0;
        let mut ahead = 0;
        for (index, bit) in wrong_bits.iter().enumerate() {
            ahead = ahead.max(index);
            while ahead < wrong_bits.len() && wrong_bits[ahead] < bit + lag {
                ahead += 1;
            }
            pairs += u64::from(wrong_bits.get(ahead) == Some(&(bit + lag)));
        }
        results.push((format!("bits {lag} apart"), binomial(pairs, bits - lag, p * p)));
    }

    let counts: Vec<f64> = messages.iter().map(|wrong| wrong.len() as f64).collect();
    results.push(("one message after another".to_owned(), uncorrelated(&counts[1..], &counts[..counts.len() - 1])));
    results
}

/// Significance level: one in a thousand good samples has a lower p-value.
const MIN_P_VALUE: f64 = 0.001;

#[test]
fn million_messages_have_the_configured_error_rates() {
    for (bit_error_rate, packet_loss) in [(0.0, 0.2), (1e-4, 0.01), (1e-3, 0.001), (0.02, 0.5), (0.5, 0.9)] {
        let Sample { messages, lost } = sample(RadioNoise { bit_error_rate, packet_loss }, MILLION);
        let p = binomial(lost, MILLION as u64, packet_loss);
        assert!(p > MIN_P_VALUE, "{lost} lost at {packet_loss}: {p}");
        let wrong = messages.iter().map(|wrong| wrong.len() as u64).sum();
        let p = binomial(wrong, (messages.len() * BITS) as u64, bit_error_rate);
        assert!(p > MIN_P_VALUE, "{wrong} bits wrong at {bit_error_rate}: {p}");
    }
}

#[test]
fn errors_are_uniform_and_independent() {
    for (p, count) in [(0.001, MILLION), (0.01, 200_000), (0.3, 10_000)] {
        let Sample { messages, .. } = sample(RadioNoise { bit_error_rate: p, packet_loss: 0.1 }, count);
        for (test, p_value) in p_values(&messages, p) {
            assert!(p_value > MIN_P_VALUE, "{test} at {p}: {p_value}");
        }
    }
}

#[test]
fn tests_reject_biased_generators() {
    const P: f64 = 0.01;
    let mut random = Random::new(7);
    let mut generate = |probability: &mut dyn FnMut(u16, &[u16], &mut Random) -> f64| -> Vec<Vec<u16>> {
        let mut message = || {
            let mut wrong = Vec::new();
            for bit in 0..BITS as u16 {
                let probability = probability(bit, &wrong, &mut random);
                if random.chance(probability) {
                    wrong.push(bit);
                }
            }
            wrong
        };
        (0..20_000).map(|_| message()).collect()
    };
    let is_wrong = |bit: u16, wrong: &[u16], lag: u16| bit >= lag && wrong.contains(&(bit - lag));
    // Of these biased generators only the first has a wrong overall rate.
    let higher_rate = generate(&mut |_, _, _| 1.05 * P);
    let first_of_byte = generate(&mut |bit, _, _| if bit % 8 == 0 { 1.7 * P } else { 0.9 * P });
    let rising = generate(&mut |bit, _, _| P * (0.85 + 0.3 * f64::from(bit) / (BITS as f64 - 1.0)));
    let burst = generate(&mut |bit, wrong, _| if is_wrong(bit, wrong, 1) { 5.0 * P } else { 0.9596 * P });
    let no_neighbours = generate(&mut |bit, wrong, _| if is_wrong(bit, wrong, 1) { 0.0 } else { P / (1.0 - P) });
    let repeated_in_next_byte =
        generate(&mut |bit, wrong, _| if is_wrong(bit, wrong, 8) { 5.0 * P } else { 0.9596 * P });
    let mut rate = P;
    let fading = generate(&mut |bit, _, random| {
        if bit == 0 && random.chance(0.2) {
            rate = random.between(0.0, 2.0 * P);
        }
        rate
    });
    // The gaps are sums of two dice: the error rate is right, but the distribution of the gaps is wrong.
    let regular: Vec<Vec<u16>> = {
        let mut errors = vec![Vec::new(); 20_000];
        let (mut bit_index, mut dice) = (0, Random::new(8));
        while bit_index < 20_000 * BITS {
            errors[bit_index / BITS].push((bit_index % BITS) as u16);
            bit_index += 1 + dice.below(100) + dice.below(100);
        }
        errors
    };
    let reject = |messages: &[Vec<u16>], test: &str| {
        let results = p_values(messages, P);
        let (_, p_value) = results.iter().find(|(name, _)| name == test).unwrap_or_else(|| panic!("no test `{test}`"));
        assert!(*p_value < 1e-6, "{test} does not reject: {results:?}");
    };
    reject(&higher_rate, "rate");
    reject(&first_of_byte, "positions");
    reject(&rising, "positions");
    reject(&burst, "bits 1 apart");
    reject(&burst, "gaps");
    reject(&no_neighbours, "bits 1 apart");
    reject(&repeated_in_next_byte, "bits 8 apart");
    reject(&fading, "one message after another");
    reject(&regular, "gaps");
    // Errors drawn bit by bit pass all tests.
    for (test, p_value) in p_values(&generate(&mut |_, _, _| P), P) {
        assert!(p_value > MIN_P_VALUE, "{test}: {p_value}");
    }
}

#[test]
fn errors_of_receivers_senders_and_messages_are_independent() {
    const COUNT: u64 = 20_000;
    let errors = RadioNoise { bit_error_rate: 0.01, packet_loss: 0.3 };
    let mut channel = channel(RadioModel::default(), vec![errors; 4], 4);
    let mut heard = vec![[None; 5]; COUNT as usize];
    for message in 0..COUNT {
        // Robots 1 and 2 send to all stations. Robots 3 and 4 receive the messages of both, with equal message numbers.
        let broadcast = |from| message_from(from, message + 1, Address::All, vec![0; BITS / 8], Time::ZERO);
        for delivery in channel.exchange(Time::ZERO, vec![broadcast(1), broadcast(2)]) {
            let index = match (delivery.from.0, delivery.to.0) {
                (1, 3) => 0,
                (1, 4) => 1,
                (2, 3) => 2,
                (2, 4) => 3,
                _ => continue,
            };
            heard[message as usize][index] = Some(delivery.outcome.ok().map(|arrived| arrived.bit_errors));
        }
    }
    let column = |index: usize, value_of: fn(Option<u32>) -> f64| -> Vec<f64> {
        heard.iter().map(|outcomes| value_of(outcomes[index].expect("each message is decided"))).collect()
    };
    let is_lost = |bit_errors: Option<u32>| f64::from(u8::from(bit_errors.is_none()));
    for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
        let p = uncorrelated(&column(a, is_lost), &column(b, is_lost));
        assert!(p > MIN_P_VALUE, "losses of {a} and {b}: {p}");
        let received_both = heard.iter().filter_map(|outcomes| Some((outcomes[a]??, outcomes[b]??)));
        let (errors_a, errors_b): (Vec<f64>, Vec<f64>) =
            received_both.map(|(a, b)| (f64::from(a), f64::from(b))).unzip();
        let p = uncorrelated(&errors_a, &errors_b);
        assert!(errors_a.len() > 9_000 && p > MIN_P_VALUE, "errors of {a} and {b}: {p}");
    }
}
