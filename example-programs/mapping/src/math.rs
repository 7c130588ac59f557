//! Elementary functions with the same bits on every platform: all come from `libm`, as in the simulator.

/// Sine of an angle in rad.
pub fn sin(angle: f64) -> f64 {
    libm::sin(angle)
}

/// Cosine of an angle in rad.
pub fn cos(angle: f64) -> f64 {
    libm::cos(angle)
}

/// Sine and cosine of an angle in rad.
pub fn sin_cos(angle: f64) -> (f64, f64) {
    libm::sincos(angle)
}

/// Tangent of an angle in rad.
pub fn tan(angle: f64) -> f64 {
    libm::tan(angle)
}

/// Angle whose sine is `value`, rad in [-pi/2, pi/2]; values that rounding has put outside [-1, 1] are clamped.
pub fn asin(value: f64) -> f64 {
    libm::asin(value.clamp(-1.0, 1.0))
}

/// Angle whose cosine is `value`, rad in [0, pi]; values that rounding has put outside [-1, 1] are clamped.
pub fn acos(value: f64) -> f64 {
    libm::acos(value.clamp(-1.0, 1.0))
}

/// Angle of the vector (x, y) from the x axis, rad in [-pi, pi].
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// e to the power of `value`.
pub fn exp(value: f64) -> f64 {
    libm::exp(value)
}

/// Natural logarithm.
pub fn ln(value: f64) -> f64 {
    libm::log(value)
}

/// Length of the vector (x, y).
pub fn hypot(x: f64, y: f64) -> f64 {
    libm::hypot(x, y)
}
