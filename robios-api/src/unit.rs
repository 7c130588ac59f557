//! Quantities with units: the API takes and returns lengths, angles and speeds instead of numbers.
//!
//! [`Units`] converts plain numbers to quantities: `0.4.metres()`, `90.degrees()`, `50.millis()`.

use std::fmt::{self, Display, Formatter};
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use std::time::Duration;

macro_rules! quantity {
    ($(#[$attribute:meta])* $Name:ident in $unit:literal: $new:ident, $get:ident) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
        pub struct $Name(f64);

        impl $Name {
            /// Zero.
            pub const ZERO: Self = Self(0.0);

            #[doc = concat!("Creates the quantity from its value in ", $unit, ".")]
            pub const fn $new(value: f64) -> Self {
                Self(value)
            }

            #[doc = concat!("Value in ", $unit, ".")]
            pub const fn $get(self) -> f64 {
                self.0
            }

            /// Absolute value.
            pub const fn abs(self) -> Self {
                Self(self.0.abs())
            }

            /// The smaller of two quantities.
            pub const fn min(self, other: Self) -> Self {
                Self(self.0.min(other.0))
            }

            /// The larger of two quantities.
            pub const fn max(self, other: Self) -> Self {
                Self(self.0.max(other.0))
            }
        }

        impl Add for $Name {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                Self(self.0 + other.0)
            }
        }
        impl Sub for $Name {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                Self(self.0 - other.0)
            }
        }
        impl AddAssign for $Name {
            fn add_assign(&mut self, other: Self) {
                self.0 += other.0;
            }
        }
        impl SubAssign for $Name {
            fn sub_assign(&mut self, other: Self) {
                self.0 -= other.0;
            }
        }
        impl Neg for $Name {
            type Output = Self;
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }
        impl Mul<f64> for $Name {
            type Output = Self;
            fn mul(self, factor: f64) -> Self {
                Self(self.0 * factor)
            }
        }
        impl Mul<$Name> for f64 {
            type Output = $Name;
            fn mul(self, quantity: $Name) -> $Name {
                quantity * self
            }
        }
        impl Div<f64> for $Name {
            type Output = Self;
            fn div(self, divisor: f64) -> Self {
                Self(self.0 / divisor)
            }
        }
        impl Div for $Name {
            type Output = f64;
            fn div(self, other: Self) -> f64 {
                self.0 / other.0
            }
        }
    };
}

quantity! {
    /// A length or distance.
    Length in "metres": metres, as_metres
}
quantity! {
    /// An angle, positive counter-clockwise.
    Angle in "radians": radians, as_radians
}
quantity! {
    /// A speed, positive forward.
    Speed in "metres per second": metres_per_second, as_metres_per_second
}
quantity! {
    /// A rate of turn, positive counter-clockwise.
    TurnRate in "radians per second": radians_per_second, as_radians_per_second
}
quantity! {
    /// A frequency.
    Frequency in "hertz": hertz, as_hertz
}
quantity! {
    /// A ratio in percent, such as of a motor's power to its full power.
    Ratio in "percent": percent, as_percent
}

macro_rules! robios6_conversion {
    ($($Name:ident),*) => {$(
        impl $Name {
            /// Converts to the number passed to RoBIOS 6.
            pub(crate) const fn to_robios(self) -> f32 {
                self.0 as f32
            }

            /// Converts from the number returned by RoBIOS 6.
            pub(crate) const fn from_robios(value: f32) -> Self {
                Self(value as f64)
            }
        }
    )*};
}
robios6_conversion!(Length, Angle, Speed, TurnRate);

macro_rules! robios7_conversion {
    ($($Name:ident: $new:ident, $get:ident, $unit:literal;)*) => {$(
        impl $Name {
            #[doc = concat!("Converts to the number passed to RoBIOS-7: whole ", $unit, ", rounded.")]
            pub(crate) fn to_robios7(self) -> i32 {
                self.$get().round() as i32
            }

            /// Converts from the number returned by RoBIOS-7.
            pub(crate) fn from_robios7(value: i32) -> Self {
                Self::$new(value.into())
            }
        }
    )*};
}
robios7_conversion! {
    Length: millimetres, as_millimetres, "millimetres";
    Angle: degrees, as_degrees, "degrees";
    Speed: millimetres_per_second, as_millimetres_per_second, "millimetres per second";
    TurnRate: degrees_per_second, as_degrees_per_second, "degrees per second";
}

impl Speed {
    /// Creates the quantity from its value in millimetres per second.
    pub const fn millimetres_per_second(value: f64) -> Self {
        Self(value / 1000.0)
    }

    /// Value in millimetres per second.
    pub const fn as_millimetres_per_second(self) -> f64 {
        self.0 * 1000.0
    }
}

impl Length {
    /// Creates the quantity from its value in millimetres.
    pub const fn millimetres(value: f64) -> Self {
        Self(value / 1000.0)
    }

    /// Value in millimetres.
    pub const fn as_millimetres(self) -> f64 {
        self.0 * 1000.0
    }

    /// Distance of a point from the origin.
    pub fn of_vector(x: Self, y: Self) -> Self {
        Self(libm::hypot(x.0, y.0))
    }
}

impl Angle {
    /// Creates the quantity from its value in degrees.
    pub const fn degrees(value: f64) -> Self {
        Self(value.to_radians())
    }

    /// Value in degrees.
    pub const fn as_degrees(self) -> f64 {
        self.0.to_degrees()
    }

    /// Sine. The results of all functions of `Angle` are bit-identical on every platform, unlike those of `std`.
    pub fn sin(self) -> f64 {
        libm::sin(self.0)
    }

    /// Cosine.
    pub fn cos(self) -> f64 {
        libm::cos(self.0)
    }

    /// Tangent.
    pub fn tan(self) -> f64 {
        libm::tan(self.0)
    }

    /// Direction from the origin to a point, from -180 to 180 degrees; 0 for the origin itself.
    pub fn towards(x: Length, y: Length) -> Self {
        Self(libm::atan2(y.0, x.0))
    }

    /// Equivalent angle from -180 to 180 degrees.
    pub fn wrapped(self) -> Self {
        Self(libm::remainder(self.0, std::f64::consts::TAU))
    }
}

impl TurnRate {
    /// Creates the quantity from its value in degrees per second.
    pub const fn degrees_per_second(value: f64) -> Self {
        Self(value.to_radians())
    }

    /// Value in degrees per second.
    pub const fn as_degrees_per_second(self) -> f64 {
        self.0.to_degrees()
    }
}

impl Mul<Duration> for Speed {
    type Output = Length;
    fn mul(self, span: Duration) -> Length {
        Length(self.0 * span.as_secs_f64())
    }
}

impl Mul<Duration> for TurnRate {
    type Output = Angle;
    fn mul(self, span: Duration) -> Angle {
        Angle(self.0 * span.as_secs_f64())
    }
}

macro_rules! displayed {
    ($($Name:ident: $get:ident, $unit:literal;)*) => {$(
        /// Formats the quantity with its unit; width and precision apply to the number: `{:.3}` gives three decimals.
        impl Display for $Name {
            fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
                self.$get().fmt(f)?;
                f.write_str($unit)
            }
        }
    )*};
}
displayed! {
    Length: as_metres, " m";
    Angle: as_degrees, "°";
    Speed: as_metres_per_second, " m/s";
    TurnRate: as_degrees_per_second, "°/s";
    Frequency: as_hertz, " Hz";
    Ratio: as_percent, " %";
}

/// Conversion of plain numbers to quantities.
///
/// ```
/// use robios_api::prelude::*;
///
/// assert_eq!(0.4.metres(), 400.millimetres());
/// assert_eq!(format!("{:.1}", 0.5.metres() * 3.0), "1.5 m");
/// assert!(90.degrees() > 1.5.radians());
/// assert!((450.degrees().wrapped() - 90.degrees()).abs() < 0.000_001.degrees());
/// assert_eq!(0.2.metres_per_second() * 5.seconds(), 1.metres());
/// ```
pub trait Units: Into<f64> {
    /// Length in metres.
    fn metres(self) -> Length {
        Length::metres(self.into())
    }
    /// Length in millimetres.
    fn millimetres(self) -> Length {
        Length::millimetres(self.into())
    }
    /// Angle in radians, counter-clockwise.
    fn radians(self) -> Angle {
        Angle::radians(self.into())
    }
    /// Angle in degrees, counter-clockwise.
    fn degrees(self) -> Angle {
        Angle::degrees(self.into())
    }
    /// Speed in metres per second.
    fn metres_per_second(self) -> Speed {
        Speed::metres_per_second(self.into())
    }
    /// Speed in millimetres per second.
    fn millimetres_per_second(self) -> Speed {
        Speed::millimetres_per_second(self.into())
    }
    /// Rate of turn in radians per second, counter-clockwise.
    fn radians_per_second(self) -> TurnRate {
        TurnRate::radians_per_second(self.into())
    }
    /// Rate of turn in degrees per second, counter-clockwise.
    fn degrees_per_second(self) -> TurnRate {
        TurnRate::degrees_per_second(self.into())
    }
    /// Frequency in hertz.
    fn hertz(self) -> Frequency {
        Frequency::hertz(self.into())
    }
    /// Ratio in percent.
    fn percent(self) -> Ratio {
        Ratio::percent(self.into())
    }
    /// Duration in seconds.
    ///
    /// # Panics
    /// If the number is negative, not finite or beyond [`Duration::MAX`].
    fn seconds(self) -> Duration {
        Duration::from_secs_f64(self.into())
    }
    /// Duration in milliseconds.
    ///
    /// # Panics
    /// If the number is negative, not finite or beyond [`Duration::MAX`].
    fn millis(self) -> Duration {
        Duration::from_secs_f64(self.into() / 1000.0)
    }
}

impl Units for f64 {}
impl Units for i32 {}
