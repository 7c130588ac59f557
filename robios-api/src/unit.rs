//! Quantities with their units: what a robot program says and hears are lengths, angles and speeds, not numbers.
//!
//! [`Units`] makes them of plain numbers: `0.4.metres()`, `90.degrees()`, `50.millis()`.

use std::fmt::{self, Display, Formatter};
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use std::time::Duration;

macro_rules! quantity {
    ($(#[$attribute:meta])* $Name:ident in $unit:literal: $new:ident, $get:ident) => {
        $(#[$attribute])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
        pub struct $Name(f64);

        impl $Name {
            /// None of it.
            pub const ZERO: Self = Self(0.0);

            #[doc = concat!("So much, in ", $unit, ".")]
            pub const fn $new(value: f64) -> Self {
                Self(value)
            }

            #[doc = concat!("Its value in ", $unit, ".")]
            pub const fn $get(self) -> f64 {
                self.0
            }

            /// Its size without the sign.
            pub const fn abs(self) -> Self {
                Self(self.0.abs())
            }

            /// The smaller one of two.
            pub const fn min(self, other: Self) -> Self {
                Self(self.0.min(other.0))
            }

            /// The larger one of two.
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
    /// A part of a whole, such as of a motor's full power.
    Ratio in "percent": percent, as_percent
}

macro_rules! crossing {
    ($($Name:ident),*) => {$(
        impl $Name {
            /// As it crosses to RoBIOS.
            pub(crate) const fn to_robios(self) -> f32 {
                self.0 as f32
            }

            /// As it comes from RoBIOS.
            pub(crate) const fn from_robios(value: f32) -> Self {
                Self(value as f64)
            }
        }
    )*};
}
crossing!(Length, Angle, Speed, TurnRate);

macro_rules! crossing7 {
    ($($Name:ident: $new:ident, $get:ident, $unit:literal;)*) => {$(
        impl $Name {
            #[doc = concat!("As it crosses to RoBIOS-7: whole ", $unit, ", rounded.")]
            pub(crate) fn to_robios7(self) -> i32 {
                self.$get().round() as i32
            }

            /// As it comes from RoBIOS-7.
            pub(crate) fn from_robios7(value: i32) -> Self {
                Self::$new(value.into())
            }
        }
    )*};
}
crossing7! {
    Length: millimetres, as_millimetres, "millimetres";
    Angle: degrees, as_degrees, "degrees";
    Speed: millimetres_per_second, as_millimetres_per_second, "millimetres per second";
    TurnRate: degrees_per_second, as_degrees_per_second, "degrees per second";
}

impl Speed {
    /// So much, in millimetres per second.
    pub const fn millimetres_per_second(value: f64) -> Self {
        Self(value / 1000.0)
    }

    /// Its value in millimetres per second.
    pub const fn as_millimetres_per_second(self) -> f64 {
        self.0 * 1000.0
    }
}

impl Length {
    /// So much, in millimetres.
    pub const fn millimetres(value: f64) -> Self {
        Self(value / 1000.0)
    }

    /// Its value in millimetres.
    pub const fn as_millimetres(self) -> f64 {
        self.0 * 1000.0
    }

    /// The distance of a point from the origin.
    pub fn of_vector(x: Self, y: Self) -> Self {
        Self(libm::hypot(x.0, y.0))
    }
}

impl Angle {
    /// So much, in degrees.
    pub const fn degrees(value: f64) -> Self {
        Self(value.to_radians())
    }

    /// Its value in degrees.
    pub const fn as_degrees(self) -> f64 {
        self.0.to_degrees()
    }

    /// Its sine. As all functions here it is the same on every platform, which those of `std` are not.
    pub fn sin(self) -> f64 {
        libm::sin(self.0)
    }

    /// Its cosine.
    pub fn cos(self) -> f64 {
        libm::cos(self.0)
    }

    /// Its tangent.
    pub fn tan(self) -> f64 {
        libm::tan(self.0)
    }

    /// The direction of a point, from -180 to 180 degrees; 0 for the origin.
    pub fn towards(x: Length, y: Length) -> Self {
        Self(libm::atan2(y.0, x.0))
    }

    /// The same direction, from -180 to 180 degrees.
    pub fn wrapped(self) -> Self {
        Self(libm::remainder(self.0, std::f64::consts::TAU))
    }
}

impl TurnRate {
    /// So much, in degrees per second.
    pub const fn degrees_per_second(value: f64) -> Self {
        Self(value.to_radians())
    }

    /// Its value in degrees per second.
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

macro_rules! shown {
    ($($Name:ident: $get:ident, $unit:literal;)*) => {$(
        /// With its unit; width and precision are those of the number: `{:.3}` gives three decimals.
        impl Display for $Name {
            fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
                self.$get().fmt(f)?;
                f.write_str($unit)
            }
        }
    )*};
}
shown! {
    Length: as_metres, " m";
    Angle: as_degrees, "°";
    Speed: as_metres_per_second, " m/s";
    TurnRate: as_degrees_per_second, "°/s";
    Frequency: as_hertz, " Hz";
    Ratio: as_percent, " %";
}

/// Quantities of plain numbers.
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
    /// So many metres.
    fn metres(self) -> Length {
        Length::metres(self.into())
    }
    /// So many millimetres.
    fn millimetres(self) -> Length {
        Length::millimetres(self.into())
    }
    /// So many radians, counter-clockwise.
    fn radians(self) -> Angle {
        Angle::radians(self.into())
    }
    /// So many degrees, counter-clockwise.
    fn degrees(self) -> Angle {
        Angle::degrees(self.into())
    }
    /// So many metres per second.
    fn metres_per_second(self) -> Speed {
        Speed::metres_per_second(self.into())
    }
    /// So many millimetres per second.
    fn millimetres_per_second(self) -> Speed {
        Speed::millimetres_per_second(self.into())
    }
    /// So many radians per second, counter-clockwise.
    fn radians_per_second(self) -> TurnRate {
        TurnRate::radians_per_second(self.into())
    }
    /// So many degrees per second, counter-clockwise.
    fn degrees_per_second(self) -> TurnRate {
        TurnRate::degrees_per_second(self.into())
    }
    /// So many hertz.
    fn hertz(self) -> Frequency {
        Frequency::hertz(self.into())
    }
    /// So many hundredths.
    fn percent(self) -> Ratio {
        Ratio::percent(self.into())
    }
    /// So many seconds.
    ///
    /// # Panics
    /// If the number is negative, not finite or beyond [`Duration::MAX`].
    fn seconds(self) -> Duration {
        Duration::from_secs_f64(self.into())
    }
    /// So many milliseconds.
    ///
    /// # Panics
    /// If the number is negative, not finite or beyond [`Duration::MAX`].
    fn millis(self) -> Duration {
        Duration::from_secs_f64(self.into() / 1000.0)
    }
}

impl Units for f64 {}
impl Units for i32 {}
