//! Noise model of a radio.

use super::Stream;
use crate::math::{ln, ln_1p};

/// Noise model of the channel to one receiver, as a profile gives it. The default has no errors.
///
/// Source: Koestler & Bräunl, section 5.1: the binary symmetric channel with a bit error rate, and packet loss.
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

    /// Inverts bits of `payload` drawn from `stream`; returns their number, or `None` if the message is lost.
    ///
    /// The loss is always drawn first, then the gaps between bit errors, so a change of P_p does not move the bit
    /// errors.
    pub fn garble(&self, stream: &mut Stream, payload: &mut [u8]) -> Option<u32> {
        if stream.unit() < self.packet_loss {
            return None;
        }
        let mut errors = 0;
        if self.bit_error_rate > 0.0 {
            let bits = payload.len() as u64 * 8;
            let ln_right = ln_1p(-self.bit_error_rate);
            let mut bit = gap(cell(stream), ln_right);
            while bit < bits {
                payload[(bit / 8) as usize] ^= 1 << (bit % 8);
                errors += 1;
                bit = bit.saturating_add(1).saturating_add(gap(cell(stream), ln_right));
            }
        }
        Some(errors)
    }

    /// -ln of the probability that a frame of `bits` bits arrives without loss and bit error; infinite if that probability is 0.
    pub fn hazard(&self, bits: u32) -> f64 {
        let hit = if self.bit_error_rate > 0.0 { f64::from(bits) * ln_1p(-self.bit_error_rate) } else { 0.0 };
        let lost = if self.packet_loss > 0.0 { ln_1p(-self.packet_loss) } else { 0.0 };
        -(lost + hit)
    }
}

/// Draws one of 2^52 equal cells of (0, 1).
fn cell(stream: &mut Stream) -> u64 {
    stream.bits() >> 12
}

/// Number of correct bits before the next bit error; it is at least k with probability (1 - P_b)^k, within 2^-52.
///
/// Computed as the logarithm of the middle of a cell divided by the logarithm of 1 - P_b: the inverse of the geometric
/// distribution. Source: Devroye 1986, "Non-Uniform Random Variate Generation", X.2.
fn gap(cell: u64, ln_right: f64) -> u64 {
    // `as` saturates, and rounds down because the quotient of two non-positive logarithms is not negative.
    (ln((cell as f64 + 0.5) / CELLS) / ln_right) as u64
}

const CELLS: f64 = (1_u64 << 52) as f64;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::RobotId;
    use crate::noise::Purpose;

    /// Fraction of the cells that give at least `count` correct bits. Gaps decrease with the cell, so bisection finds the boundary.
    fn at_least(count: u64, ln_right: f64) -> f64 {
        let (mut low, mut high) = (0, 1_u64 << 52);
        while low < high {
            let middle = low.midpoint(high);
            if gap(middle, ln_right) >= count { low = middle + 1 } else { high = middle }
        }
        low as f64 / CELLS
    }

    #[test]
    fn gaps_are_geometric_to_the_last_cell() {
        for p in [1e-9, 1e-3, 0.1, 0.5, 0.75, 0.999] {
            let ln_right = ln_1p(-p);
            let mut expected = 1.0;
            for count in 0..64 {
                let found = at_least(count, ln_right);
                // The boundary lies within one cell; logarithm, quotient and product have rounding errors of some units in the last place.
                assert!((found - expected).abs() < 64.0 / CELLS, "{count} right bits at {p}: {found} {expected}");
                expected *= 1.0 - p;
            }
        }
    }

    #[test]
    fn every_pattern_of_a_small_message_has_the_probability_of_bit_by_bit() {
        const BITS: u64 = 8;
        for p in [0.01, 0.3, 0.5, 0.9] {
            let ln_right = ln_1p(-p);
            let exactly = |gap: u64| at_least(gap, ln_right) - at_least(gap + 1, ln_right);
            for pattern in 0_u64..1 << BITS {
                // The algorithm under test skips from error to error: a gap before each error, and a last gap beyond
                // the end.
                let (mut skipping, mut next) = (1.0, 0);
                for bit in (0..BITS).filter(|bit| pattern >> bit & 1 == 1) {
                    skipping *= exactly(bit - next);
                    next = bit + 1;
                }
                skipping *= at_least(BITS - next, ln_right);
                let wrong = pattern.count_ones() as i32;
                let bit_by_bit = f64::powi(p, wrong) * f64::powi(1.0 - p, BITS as i32 - wrong);
                assert!((skipping - bit_by_bit).abs() < 1e-13, "{pattern:08b} at {p}: {skipping} {bit_by_bit}");
            }
        }
    }

    #[test]
    fn certain_rates_are_certain() {
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
            // The smallest cell is 2^-52, so rates as small as these never give an error.
            for tiny in [1e-17, 1e-300, f64::MIN_POSITIVE, 5e-324] {
                assert_eq!(garbled(tiny, 0.0, number).0, Some(0));
            }
            let one_less = 1.0 - f64::EPSILON / 2.0;
            assert_eq!(garbled(one_less, 0.0, number).0, Some(800));
        }
        let mut nothing = [];
        assert_eq!(RadioNoise { bit_error_rate: 1.0, packet_loss: 0.0 }.garble(&mut stream(0), &mut nothing), Some(0));
    }

    #[test]
    fn another_loss_leaves_the_errors_where_they_are() {
        let payload_at = |packet_loss, number| {
            let mut payload = [0; 64];
            let errors = RadioNoise { bit_error_rate: 0.02, packet_loss };
            let mut stream = Stream::new(5, RobotId(1), Purpose::Radio, 2, number);
            errors.garble(&mut stream, &mut payload).map(|_| payload)
        };
        let arrived = (0..200).filter_map(|number| Some((number, payload_at(0.5, number)?)));
        let count = arrived.inspect(|(number, payload)| assert_eq!(Some(*payload), payload_at(0.0, *number))).count();
        assert!((60..140).contains(&count), "{count}");
    }

    #[test]
    fn the_hazard_is_that_of_the_frame() {
        let hazard = |bit_error_rate, packet_loss| RadioNoise { bit_error_rate, packet_loss }.hazard(56);
        assert_eq!(hazard(0.0, 0.0), 0.0);
        assert_eq!(hazard(1.0, 0.0), f64::INFINITY);
        assert_eq!(hazard(0.0, 1.0), f64::INFINITY);
        let survival = crate::math::exp(-hazard(0.01, 0.2));
        assert!((survival - 0.8 * f64::powi(0.99, 56)).abs() < 1e-15);
    }
}
