//! Transcendental functions that are bit-identical on every platform; all calls to `libm` go through this module.

/// Sine of an angle in radians.
pub fn sin(x: f64) -> f64 {
    libm::sin(x)
}

/// Cosine of an angle in radians.
pub fn cos(x: f64) -> f64 {
    libm::cos(x)
}

/// Sine and cosine of an angle in radians.
pub fn sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// Tangent of an angle in radians.
pub fn tan(x: f64) -> f64 {
    libm::tan(x)
}

/// Angle of the vector (x, y) in (-pi, pi], in radians; 0 for the zero vector.
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// Angle whose tangent is `x`, in radians.
pub fn atan(x: f64) -> f64 {
    libm::atan(x)
}

/// Length of the vector (x, y) without intermediate overflow or underflow.
pub fn hypot(x: f64, y: f64) -> f64 {
    libm::hypot(x, y)
}

/// e to the power of `x`.
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// e to the power of `x`, minus 1, without loss of digits for small x.
pub fn exp_m1(x: f64) -> f64 {
    libm::expm1(x)
}

/// Hyperbolic tangent of `x`.
pub fn tanh(x: f64) -> f64 {
    libm::tanh(x)
}

/// Angle in [-pi/2, pi/2] whose sine is `x`, in radians; NaN if `x` is outside [-1, 1].
pub fn asin(x: f64) -> f64 {
    libm::asin(x)
}

/// Natural logarithm of `x`.
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// Natural logarithm of 1 + `x`, without loss of digits for small x.
pub fn ln_1p(x: f64) -> f64 {
    libm::log1p(x)
}

/// 1 - erf(x), without cancellation for large x. For x >= 0 this is the probability that a standard normal number
/// exceeds sqrt(2) x in absolute value.
pub fn erfc(x: f64) -> f64 {
    libm::erfc(x)
}

/// sin(x) / x, and 1 at 0; full precision for every x.
pub fn sinc(x: f64) -> f64 {
    // Below 1e-4 the next term of the series, x^4 / 120, is under half a unit in the last place of 1.
    if x.abs() < 1e-4 { 1.0 - x * x / 6.0 } else { sin(x) / x }
}

/// (1 - cos(x)) / x, and 0 at 0, without cancellation.
pub fn cosc(x: f64) -> f64 {
    let half = sinc(0.5 * x);
    0.5 * x * half * half
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sinc_and_cosc_match_their_series() {
        for x in [1e-300, 1e-9, 0.99e-4, 1.01e-4, 1e-2] {
            let (sinc_series, cosc_series) =
                (1.0 - x * x / 6.0 + x * x * x * x / 120.0, x / 2.0 - x * x * x / 24.0 + x * x * x * x * x / 720.0);
            assert!((sinc(x) - sinc_series).abs() < 1e-15, "sinc({x})");
            assert!((cosc(x) / cosc_series - 1.0).abs() < 1e-13, "cosc({x})");
        }
        assert_eq!(sinc(0.0), 1.0);
        assert_eq!(cosc(0.0), 0.0);
        assert!((cosc(-2.0) - (1.0 - cos(2.0)) / -2.0).abs() < 1e-15);
    }
}
