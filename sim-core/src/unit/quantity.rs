//! Numbers in files: their units (millimetres, degrees, percent and others) and their bounds.

/// Meaning of a number in a file, with its unit and its bounds in that unit.
#[derive(Clone, Copy, Debug)]
pub struct Quantity {
    /// Meaning in a few words.
    pub name: &'static str,
    unit: Unit,
    low: f64,
    high: f64,
    /// True if the number has no effect on the scene, so that a value out of bounds only causes a warning.
    is_minor: bool,
}

/// Maximum coordinate or size that a file may contain, in metres.
pub const MAX_LENGTH: f64 = 1e6;

/// A unit of numbers in files.
#[derive(Clone, Copy, Debug)]
struct Unit {
    name: &'static str,
    to_si: fn(f64) -> f64,
    from_si: fn(f64) -> f64,
}

impl Unit {
    const MM: Self = Self { name: "mm", to_si: super::metres_from_mm, from_si: super::mm_from_metres };
    const DEGREES: Self =
        Self { name: "degrees", to_si: super::radians_from_degrees, from_si: super::degrees_from_radians };
    const MS: Self = Self { name: "ms", to_si: |ms| ms / 1e3, from_si: |seconds| seconds * 1e3 };
    const PERCENT: Self =
        Self { name: "percent", to_si: |percent| percent / 100.0, from_si: |fraction| fraction * 100.0 };

    /// An SI unit, which needs no conversion.
    const fn si(name: &'static str) -> Self {
        Self { name, to_si: std::convert::identity, from_si: std::convert::identity }
    }

    /// This unit per second.
    const fn per_second(self, name: &'static str) -> Self {
        Self { name, ..self }
    }
}

const MAX_LENGTH_MM: f64 = MAX_LENGTH * 1000.0;
/// Minimum accepted size, in millimetres.
const MIN_SIZE_MM: f64 = 1e-3;

impl Quantity {
    const fn new(name: &'static str, unit: Unit, low: f64, high: f64) -> Self {
        Self { name, unit, low, high, is_minor: false }
    }

    /// A coordinate in millimetres, positive or negative.
    pub const fn coordinate(name: &'static str) -> Self {
        Self::new(name, Unit::MM, -MAX_LENGTH_MM, MAX_LENGTH_MM)
    }

    /// A length in millimetres, 0 or more.
    pub const fn length(name: &'static str) -> Self {
        Self::new(name, Unit::MM, 0.0, MAX_LENGTH_MM)
    }

    /// A size in millimetres, greater than 0.
    pub const fn size(name: &'static str) -> Self {
        Self::new(name, Unit::MM, MIN_SIZE_MM, MAX_LENGTH_MM)
    }

    /// An angle in degrees.
    pub const fn angle(name: &'static str) -> Self {
        Self::new(name, Unit::DEGREES, -1e6, 1e6)
    }

    /// A speed in mm/s, greater than 0.
    pub const fn speed(name: &'static str) -> Self {
        Self::new(name, Unit::MM.per_second("mm/s"), MIN_SIZE_MM, 1e9)
    }

    /// A turning rate in degrees/s, greater than 0.
    pub const fn rate(name: &'static str) -> Self {
        Self::new(name, Unit::DEGREES.per_second("degrees/s"), 1e-3, 1e9)
    }

    /// A span of time in milliseconds, of at most an hour.
    pub const fn milliseconds(name: &'static str) -> Self {
        Self::new(name, Unit::MS, 0.0, 3.6e6)
    }

    /// A span of time in seconds.
    pub const fn seconds(name: &'static str) -> Self {
        Self::new(name, Unit::si("s"), 0.0, 1e9)
    }

    /// A mass in kilograms, greater than 0.
    pub const fn mass(name: &'static str) -> Self {
        Self::new(name, Unit::si("kg"), 1e-6, 1e6)
    }

    /// A pure number.
    pub const fn number(name: &'static str, low: f64, high: f64) -> Self {
        Self::new(name, Unit::si(""), low, high)
    }

    /// A fraction, written in percent.
    pub const fn percent(name: &'static str, low: f64, high: f64) -> Self {
        Self::new(name, Unit::PERCENT, low, high)
    }

    /// A coefficient per metre, 0 or more.
    pub const fn per_metre(name: &'static str, high: f64) -> Self {
        Self::new(name, Unit::si("1/m"), 0.0, high)
    }

    /// This quantity with other bounds, given in its unit.
    pub const fn within(self, low: f64, high: f64) -> Self {
        Self { low, high, ..self }
    }

    /// This quantity, marked as having no effect on the scene.
    pub const fn minor(self) -> Self {
        Self { is_minor: true, ..self }
    }

    /// Converts `value` from the quantity's unit to SI units without checking the bounds.
    pub fn si(&self, value: f64) -> f64 {
        (self.unit.to_si)(value)
    }

    /// Converts `si` from SI units to the quantity's unit.
    pub fn in_unit(&self, si: f64) -> f64 {
        (self.unit.from_si)(si)
    }

    /// Converts `si` from SI units to the quantity's unit and rounds to twelve digits, so that a number that was read
    /// from a file is printed as it was written.
    pub fn in_own_unit(&self, si: f64) -> f64 {
        let value = si / (self.unit.to_si)(1.0);
        format!("{value:.11e}").parse().unwrap_or(value)
    }

    /// Name of the unit; empty for a pure number.
    pub const fn unit(&self) -> &'static str {
        self.unit.name
    }

    /// Minimum and maximum value in the quantity's unit.
    pub const fn bounds(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// Returns true if the number has no effect on the scene, so that a value out of bounds does no harm.
    pub const fn is_minor(&self) -> bool {
        self.is_minor
    }

    /// Description of the accepted values, for messages.
    pub fn expected(&self) -> String {
        let unit = if self.unit().is_empty() { String::new() } else { format!(" in {}", self.unit()) };
        format!("a number{unit} from {} to {}", self.low, self.high)
    }

    /// Converts `value` to SI units; `None` if it is not finite or out of bounds.
    pub fn check(&self, value: f64) -> Option<f64> {
        (value >= self.low && value <= self.high).then(|| self.si(value))
    }
}
