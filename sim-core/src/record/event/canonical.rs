//! Canonical form of events: their postcard encoding, written here without a serializer for speed.

use serde::Serialize;

use super::{ActionText, FloatList, Obstacle, Outcome};

/// Type of an event field that can write its postcard encoding.
pub trait Canonical {
    /// Appends the value to `bytes`.
    fn write(&self, bytes: &mut Vec<u8>);
}

/// Appends `value` seven bits at a time, the lowest first; all bytes but the last have the highest bit set.
#[inline]
fn write_varint(value: u64, bytes: &mut Vec<u8>) {
    if value < 0x80 { bytes.push(value as u8) } else { write_long_varint(value, bytes) }
}

/// Implements [`write_varint`] for values of several bytes. It is a separate function, so that the case of one byte is
/// inlined.
#[inline(never)]
fn write_long_varint(mut value: u64, bytes: &mut Vec<u8>) {
    if value < 1 << 56 {
        // Spreads groups of seven bits over bytes, in halves, quarters and eighths of the word, without a loop.
        let mut spread = (value & 0xfff_ffff) | (value & 0xff_ffff_f000_0000) << 4;
        spread = (spread & 0x3fff_0000_3fff) | (spread & 0xfff_c000_0fff_c000) << 2;
        spread = (spread & 0x7f_007f_007f_007f) | (spread & 0x3f80_3f80_3f80_3f80) << 1;
        let continuation_bytes = (63 - spread.leading_zeros()) / 8;
        let continuation_bits = 0x8080_8080_8080_8080 & ((1 << (8 * continuation_bytes)) - 1);
        let len = bytes.len() + continuation_bytes as usize + 1;
        bytes.extend_from_slice(&(spread | continuation_bits).to_le_bytes());
        bytes.truncate(len);
        return;
    }
    while value >= 0x80 {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

impl Canonical for f64 {
    #[inline]
    fn write(&self, bytes: &mut Vec<u8>) {
        bytes.extend_from_slice(&self.to_le_bytes());
    }
}

impl Canonical for i64 {
    #[inline]
    fn write(&self, bytes: &mut Vec<u8>) {
        write_varint((self << 1 ^ self >> 63) as u64, bytes);
    }
}

impl Canonical for i32 {
    fn write(&self, bytes: &mut Vec<u8>) {
        i64::from(*self).write(bytes);
    }
}

impl Canonical for u64 {
    fn write(&self, bytes: &mut Vec<u8>) {
        write_varint(*self, bytes);
    }
}

impl Canonical for u32 {
    fn write(&self, bytes: &mut Vec<u8>) {
        write_varint(u64::from(*self), bytes);
    }
}

impl Canonical for u8 {
    fn write(&self, bytes: &mut Vec<u8>) {
        bytes.push(*self);
    }
}

impl Canonical for &[u8] {
    #[inline]
    fn write(&self, bytes: &mut Vec<u8>) {
        write_varint(self.len() as u64, bytes);
        bytes.extend_from_slice(self);
    }
}

impl Canonical for &str {
    #[inline]
    fn write(&self, bytes: &mut Vec<u8>) {
        self.as_bytes().write(bytes);
    }
}

impl<T: Canonical> Canonical for Option<T> {
    #[inline]
    fn write(&self, bytes: &mut Vec<u8>) {
        bytes.push(u8::from(self.is_some()));
        if let Some(value) = self {
            value.write(bytes);
        }
    }
}

/// Implements [`Canonical`] with postcard's serializer, for rare types.
macro_rules! canonical_by_serde {
    ($($type:ty)*) => {$(
        impl Canonical for $type {
            fn write(&self, bytes: &mut Vec<u8>) {
                write_serialized(self, bytes);
            }
        }
    )*};
}
canonical_by_serde!(Outcome Obstacle ActionText<'_> FloatList<'_>);

/// Appends the postcard encoding of `value` to `bytes`.
fn write_serialized(value: &impl Serialize, bytes: &mut Vec<u8>) {
    let encoding = postcard::to_stdvec(value).expect("memory is the only limit of a journal");
    bytes.extend_from_slice(&encoding);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::event::Event;

    /// Asserts that `value` is written as postcard writes it.
    fn check(value: impl Canonical + Serialize) {
        let mut bytes = vec![7];
        value.write(&mut bytes);
        assert_eq!(bytes[1..], postcard::to_stdvec(&value).unwrap());
    }

    #[test]
    fn fields_match_postcard() {
        let powers = (0..63).flat_map(|bits| [(1_i64 << bits) - 1, 1 << bits]);
        for number in powers.chain([i64::MAX, 0x1234_5678_9abc_def0]) {
            for signed in [number, -number, !number] {
                check(signed);
                check(signed as u64);
                check(signed as i32);
                check(signed as u32);
                check(signed as u8);
                check(Some(signed as i32));
                check(signed as f64 / 3.0);
                check(Some(signed as f64));
            }
        }
        [f64::NAN, f64::INFINITY, -0.0].into_iter().for_each(check);
        ["", "PSD_FRONT", "Hügel"].into_iter().for_each(check);
        check([0_u8, 200, 255].as_slice());
        check([1; 300].as_slice());
        check(None::<f64>);
        check(None::<u32>);
        [Outcome::Finished, Outcome::Removed].into_iter().for_each(check);
        [Obstacle::Wall, Obstacle::Robot(300), Obstacle::Object(1)].into_iter().for_each(check);
        check(ActionText("{}"));
        check(FloatList::new(&[1.5_f64.to_le_bytes()]));
    }

    #[test]
    fn events_match_postcard() {
        check(Event::ProgramStarted { program: "a.c" });
        check(Event::Beep {});
        check(Event::Distance { device: "PSD_LEFT", distance_m: Some(0.25), measured_s: 0.06 });
        check(Event::DriveSpeed { v_m_per_s: -0.0, omega_rad_per_s: f64::NAN });
        check(Event::Contact { at_s: 1.0, with: Obstacle::Robot(1), x_m: 0.0, y_m: 2.0 });
    }
}
