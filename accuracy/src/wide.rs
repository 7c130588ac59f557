//! Double-double numbers of about 32 digits, for references with negligible rounding errors.
//!
//! Source: Dekker, A floating-point technique for extending the available precision, 1971.

use std::f64::consts::FRAC_PI_2;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Number as the sum of two `f64`; the second is at most half a unit in the last place of the first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wide {
    high: f64,
    low: f64,
}

/// Half of pi, in double-double precision.
const HALF_PI: Wide = Wide { high: FRAC_PI_2, low: 6.123_233_995_736_766e-17 };

impl Wide {
    /// The nearest `f64`.
    pub fn rounded(self) -> f64 {
        self.high
    }

    /// Sum of two `f64` including its rounding error.
    fn of_sum(a: f64, b: f64) -> Self {
        let high = a + b;
        let added = high - a;
        Self { high, low: (a - (high - added)) + (b - added) }
    }

    /// Sine and cosine of an angle in radians; error 1e-31, plus 1e-33 per quarter turn.
    pub fn sin_cos(self) -> (Self, Self) {
        let quarters = (self.high / FRAC_PI_2).round();
        let remainder = self - HALF_PI * Self::from(quarters);
        let square = remainder * remainder;
        // Taylor series of sine and cosine, summed from the last term: (pi/4)^28 / 28! is 1e-33.
        let series = |first: i32| {
            (first..=28).rev().filter(|power| (power - first) % 2 == 0).fold(Self::default(), |sum, power| {
                Self::from(1.0) - sum * square / Self::from(f64::from((power + 1) * (power + 2)))
            })
        };
        let (sin, cos) = (remainder * series(1), series(0));
        match quarters.rem_euclid(4.0) as u8 {
            0 => (sin, cos),
            1 => (cos, -sin),
            2 => (-sin, -cos),
            _ => (-cos, sin),
        }
    }
}

impl From<f64> for Wide {
    fn from(value: f64) -> Self {
        Self { high: value, low: 0.0 }
    }
}

impl Add for Wide {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (high, low) = (Self::of_sum(self.high, other.high), Self::of_sum(self.low, other.low));
        let sum = Self::of_sum(high.high, high.low + low.high);
        Self::of_sum(sum.high, sum.low + low.low)
    }
}

impl Neg for Wide {
    type Output = Self;
    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Wide {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Wide {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        // Split into halves of 26 bits, whose products are exact.
        let split = |value: f64| {
            let scaled = 134_217_729.0 * value;
            let high = scaled - (scaled - value);
            (high, value - high)
        };
        let product = self.high * other.high;
        let ((a, b), (c, d)) = (split(self.high), split(other.high));
        let error = ((a * c - product) + a * d + b * c) + b * d;
        Self::of_sum(product, error + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Wide {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let mut quotient = Self::from(self.high / other.high);
        for _ in 0..2 {
            quotient = quotient + Self::from((self - quotient * other).high / other.high);
        }
        quotient
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn assert_close(found: Wide, expected: Wide, error: f64) {
        assert!((found - expected).high.abs() <= error, "{found:?} instead of {expected:?}");
    }

    #[test]
    fn arithmetic_keeps_digits_that_f64_loses() {
        let third = Wide::from(1.0) / Wide::from(3.0);
        assert_close(third * Wide::from(3.0), Wide::from(1.0), 1e-31);
        assert_eq!((Wide::from(1.0) + Wide::from(1e-25) - Wide::from(1.0)).high, 1e-25);
        let product = Wide::from(1.0 + 1e-9) * Wide::from(1.0 - 1e-9);
        let [a, b] = [1.0 + 1e-9, 1.0 - 1e-9].map(|value: f64| Wide::from(value - 1.0));
        assert_close(product, Wide::from(1.0) + a + b + a * b, 1e-31);
    }

    #[test]
    fn sine_and_cosine_match_published_values() {
        // sin 1 and cos 1 to 32 digits, as sums of two doubles.
        let (sin, cos) = Wide::from(1.0).sin_cos();
        assert_close(sin, Wide { high: 0.841_470_984_807_896_5, low: 1.776_845_092_935_536e-18 }, 1e-31);
        assert_close(cos, Wide { high: 0.540_302_305_868_139_8, low: -4.760_954_612_604_417e-17 }, 1e-31);
        for angle in [-300.0, -2.0, -0.1, 0.0, 0.7, 1.6, 3.2, 5.0, 1000.0] {
            let (sin, cos) = Wide::from(angle).sin_cos();
            assert_close(sin * sin + cos * cos, Wide::from(1.0), 1e-30);
            let (twice, _) = Wide::from(2.0 * angle).sin_cos();
            assert_close(twice, sin * cos * Wide::from(2.0), 1e-29);
            assert!((sin.high - sim_core::math::sin(angle)).abs() < 1e-15);
        }
    }
}
