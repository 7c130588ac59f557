//! Noise model of a radio.

use super::Stream;
use crate::math::{ln, ln_1p};

/// Noise model of the channel to one receiver, as defined in a profile. The default has no errors.
///
/// The channel is a binary symmetric channel with packet loss. Source: Koestler & Bräunl, section 5.1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RadioNoise {
    /// Probability P_b that a bit of the payload arrives inverted, in [0, 1].
    pub bit_error_rate: f64,
    /// Probability P_p that a message does not arrive, in [0, 1].
    pub packet_loss: f64,
}

impl RadioNoise {
    /// Returns true if every message arrives as it was sent.
    pub fn is_perfect(&self) -> bool {
        self.bit_error_rate <= 0.0 && self.packet_loss <= 0.0
    }

    /// Inverts random bits of `payload`; returns their number, or `None` if the message is lost.
    ///
    /// The random numbers come from `stream`: always one for the loss first, then one for each gap between bit errors.
    /// Bit errors therefore keep their positions if P_p changes.
    pub fn garble(&self, stream: &mut Stream, payload: &mut [u8]) -> Option<u32> {
        if stream.unit() < self.packet_loss {
            return None;
        }
        let mut errors = 0;
        if self.bit_error_rate > 0.0 {
            let bits = payload.len() as u64 * 8;
            let ln_correct = ln_1p(-self.bit_error_rate);
            let mut bit = gap(interval(stream), ln_correct);
            while bit < bits {
                payload[(bit / 8) as usize] ^= 1 << (bit % 8);
                errors += 1;
                bit = bit.saturating_add(1).saturating_add(gap(interval(stream), ln_correct));
            }
        }
        Some(errors)
    }

    /// Cumulative hazard of a frame of `bits` bits: -ln of the probability that it arrives without loss or bit error;
    /// infinite if that probability is 0.
    pub fn hazard(&self, bits: u32) -> f64 {
        let without_bit_error =
            if self.bit_error_rate > 0.0 { f64::from(bits) * ln_1p(-self.bit_error_rate) } else { 0.0 };
        let without_loss = if self.packet_loss > 0.0 { ln_1p(-self.packet_loss) } else { 0.0 };
        -(without_loss + without_bit_error)
    }
}

/// Draws the index of one of the 2^52 intervals of equal length into which (0, 1) is divided.
fn interval(stream: &mut Stream) -> u64 {
    stream.bits() >> 12
}

/// Number of correct bits before the next bit error; at least k with probability (1 - P_b)^k, within 2^-52.
///
/// Computed as the logarithm of the midpoint of an interval divided by the logarithm of 1 - P_b: the inverse of the
/// geometric distribution. Source: Devroye 1986, "Non-Uniform Random Variate Generation", X.2.
fn gap(interval: u64, ln_correct: f64) -> u64 {
    // `as` saturates, and rounds down because the quotient of two non-positive logarithms is not negative.
    (ln((interval as f64 + 0.5) / INTERVALS) / ln_correct) as u64
}

/// Number of intervals into which [`interval`] divides (0, 1).
const INTERVALS: f64 = (1_u64 << 52) as f64;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RobotId;
    use crate::noise::Purpose;

    /// Fraction of the intervals for which at least `count` correct bits come before an error. Gaps decrease with the
    /// interval, so bisection finds the boundary.
    fn fraction_with_gap(count: u64, ln_correct: f64) -> f64 {
        let (mut low, mut high) = (0, 1_u64 << 52);
        while low < high {
            let middle = low.midpoint(high);
            if gap(middle, ln_correct) >= count { low = middle + 1 } else { high = middle }
        }
        low as f64 / INTERVALS
    }

    #[test]
    fn gaps_are_geometric_within_one_interval() {
        for p in [1e-9, 1e-3, 0.1, 0.5, 0.75, 0.999] {
            let ln_correct = ln_1p(-p);
            let mut expected = 1.0;
            for count in 0..64 {
                let found = fraction_with_gap(count, ln_correct);
                // The boundary lies within one interval; logarithm, quotient and product have rounding errors of a few
                // units in the last place.
                assert!(
                    (found - expected).abs() < 64.0 / INTERVALS,
                    "{count} correct bits at {p}: {found} instead of {expected}"
                );
                expected *= 1.0 - p;
            }
        }
    }

    #[test]
    fn error_patterns_of_a_byte_have_binomial_probabilities() {
        const BITS: u64 = 8;
        for p in [0.01, 0.3, 0.5, 0.9] {
            let ln_correct = ln_1p(-p);
            let gap_probability =
                |gap: u64| fraction_with_gap(gap, ln_correct) - fraction_with_gap(gap + 1, ln_correct);
            for pattern in 0_u64..1 << BITS {
                // The algorithm under test skips from error to error: one gap before each error, and a last gap that
                // ends beyond the message.
                let (mut skipping, mut next) = (1.0, 0);
                for bit in (0..BITS).filter(|bit| pattern >> bit & 1 == 1) {
                    skipping *= gap_probability(bit - next);
                    next = bit + 1;
                }
                skipping *= fraction_with_gap(BITS - next, ln_correct);
                let errors = pattern.count_ones() as i32;
                let bit_by_bit = f64::powi(p, errors) * f64::powi(1.0 - p, BITS as i32 - errors);
                assert!(
                    (skipping - bit_by_bit).abs() < 1e-13,
                    "{pattern:08b} at {p}: {skipping} instead of {bit_by_bit}"
                );
            }
        }
    }

    #[test]
    fn rates_of_zero_and_one_are_exact() {
        let stream = |number| Stream::new(1, RobotId(2), Purpose::Radio, 1, number);
        let garbled = |bit_error_rate, packet_loss, number| {
            let mut payload = [0b1010_0110; 100];
            let errors = RadioNoise { bit_error_rate, packet_loss }.garble(&mut stream(number), &mut payload);
            (errors, payload)
        };
        for number in 0..100 {
            assert_eq!(garbled(0.0, 0.0, number), (Some(0), [0b1010_0110; 100]));
            assert_eq!(garbled(1.0, 0.0, number), (Some(800), [0b0101_1001; 100]));
            assert_eq!(garbled(0.3, 1.0, number).0, None);
            // An interval has the length 2^-52, so such small rates never give an error.
            for tiny in [1e-17, 1e-300, f64::MIN_POSITIVE, 5e-324] {
                assert_eq!(garbled(tiny, 0.0, number).0, Some(0));
            }
            let one_less = 1.0 - f64::EPSILON / 2.0;
            assert_eq!(garbled(one_less, 0.0, number).0, Some(800));
        }
        let mut empty = [];
        assert_eq!(RadioNoise { bit_error_rate: 1.0, packet_loss: 0.0 }.garble(&mut stream(0), &mut empty), Some(0));
    }

    #[test]
    fn packet_loss_does_not_move_bit_errors() {
        let received = |packet_loss, number| {
            let mut payload = [0; 64];
            let model = RadioNoise { bit_error_rate: 0.02, packet_loss };
            let mut stream = Stream::new(5, RobotId(1), Purpose::Radio, 2, number);
            model.garble(&mut stream, &mut payload).map(|_| payload)
        };
        let arrived = (0..200).filter_map(|number| Some((number, received(0.5, number)?)));
        let count = arrived.inspect(|(number, payload)| assert_eq!(Some(*payload), received(0.0, *number))).count();
        assert!((60..140).contains(&count), "{count}");
    }

    #[test]
    fn hazard_is_minus_ln_of_the_survival_probability() {
        let hazard = |bit_error_rate, packet_loss| RadioNoise { bit_error_rate, packet_loss }.hazard(56);
        assert_eq!(hazard(0.0, 0.0), 0.0);
        assert_eq!(hazard(1.0, 0.0), f64::INFINITY);
        assert_eq!(hazard(0.0, 1.0), f64::INFINITY);
        let survival = crate::math::exp(-hazard(0.01, 0.2));
        assert!((survival - 0.8 * f64::powi(0.99, 56)).abs() < 1e-15);
    }
}
