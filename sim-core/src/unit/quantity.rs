//! Numbers as people write them: in millimetres, degrees and percent, within bounds.

/// What a number in a file stands for, with its unit and bounds in that unit.
#[derive(Clone, Copy, Debug)]
pub struct Quantity {
    /// What it is, in a few words.
    pub name: &'static str,
    unit: &'static str,
    low: f64,
    high: f64,
    to_si: fn(f64) -> f64,
    /// The scene is the same without it, so that a value out of bounds is only warned about.
    is_minor: bool,
}

/// Largest coordinate or size that a file may have, in metres.
pub const MAX_LENGTH: f64 = 1e6;

const MAX_LENGTH_MM: f64 = MAX_LENGTH * 1000.0;
/// Smallest size that is not absurd, in millimetres.
const MIN_SIZE_MM: f64 = 1e-3;

impl Quantity {
    const fn new(name: &'static str, unit: &'static str, low: f64, high: f64, to_si: fn(f64) -> f64) -> Self {
        Self { name, unit, low, high, to_si, is_minor: false }
    }

    /// A coordinate: millimetres of either sign.
    pub const fn coordinate(name: &'static str) -> Self {
        Self::new(name, "mm", -MAX_LENGTH_MM, MAX_LENGTH_MM, super::metres_from_mm)
    }

    /// A length that may be 0: millimetres.
    pub const fn length(name: &'static str) -> Self {
        Self::new(name, "mm", 0.0, MAX_LENGTH_MM, super::metres_from_mm)
    }

    /// A size: millimetres above 0.
    pub const fn size(name: &'static str) -> Self {
        Self::new(name, "mm", MIN_SIZE_MM, MAX_LENGTH_MM, super::metres_from_mm)
    }

    /// An angle in degrees.
    pub const fn angle(name: &'static str) -> Self {
        Self::new(name, "degrees", -1e6, 1e6, super::radians_from_degrees)
    }

    /// A speed above 0 in mm/s.
    pub const fn speed(name: &'static str) -> Self {
        Self::new(name, "mm/s", MIN_SIZE_MM, 1e9, super::metres_from_mm)
    }

    /// A turning rate above 0 in degrees/s.
    pub const fn rate(name: &'static str) -> Self {
        Self::new(name, "degrees/s", 1e-3, 1e9, super::radians_from_degrees)
    }

    /// A span of time in milliseconds, of at most an hour.
    pub const fn milliseconds(name: &'static str) -> Self {
        Self::new(name, "ms", 0.0, 3.6e6, seconds_from_ms)
    }

    /// A span of time in seconds.
    pub const fn seconds(name: &'static str) -> Self {
        Self::new(name, "s", 0.0, 1e9, std::convert::identity)
    }

    /// A mass above 0 in kilograms.
    pub const fn mass(name: &'static str) -> Self {
        Self::new(name, "kg", 1e-6, 1e6, std::convert::identity)
    }

    /// A pure number.
    pub const fn number(name: &'static str, low: f64, high: f64) -> Self {
        Self::new(name, "", low, high, std::convert::identity)
    }

    /// A share, written in percent.
    pub const fn percent(name: &'static str, low: f64, high: f64) -> Self {
        Self::new(name, "percent", low, high, share_from_percent)
    }

    /// The same quantity between other bounds, in its own unit.
    pub const fn within(self, low: f64, high: f64) -> Self {
        Self { low, high, ..self }
    }

    /// The same quantity as one that may be left out without harm.
    pub const fn minor(self) -> Self {
        Self { is_minor: true, ..self }
    }

    /// A value of its own unit in SI units, whatever the bounds.
    pub fn si(&self, value: f64) -> f64 {
        (self.to_si)(value)
    }

    /// A value in SI units in its own unit, to twelve digits, so that what was written comes back.
    pub fn in_own_unit(&self, si: f64) -> f64 {
        let value = si / (self.to_si)(1.0);
        format!("{value:.11e}").parse().unwrap_or(value)
    }

    /// Its unit; empty for a pure number.
    pub const fn unit(&self) -> &'static str {
        self.unit
    }

    /// Least and greatest value in its own unit.
    pub const fn bounds(&self) -> [f64; 2] {
        [self.low, self.high]
    }

    /// True for one whose value out of bounds does no harm: the scene is the same without it.
    pub const fn is_minor(&self) -> bool {
        self.is_minor
    }

    /// What the reader of a message should have written.
    pub fn expected(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" in {}", self.unit) };
        format!("a number{unit} from {} to {}", self.low, self.high)
    }

    /// The value in SI units, if it is finite and within the bounds.
    pub fn check(&self, value: f64) -> Option<f64> {
        (value >= self.low && value <= self.high).then(|| self.si(value))
    }
}

fn seconds_from_ms(ms: f64) -> f64 {
    ms / 1000.0
}

fn share_from_percent(percent: f64) -> f64 {
    percent / 100.0
}
