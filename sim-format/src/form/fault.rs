//! Injected faults.

use super::check::ROBOT_NUMBER;
use super::kind::{Bounded, TEXT, Word, Words};
use super::{Form, Keys, Variant, Variants};
use crate::code::Code;
use crate::line::Quantity;
use crate::spec::{FaultKind, FaultSpec, FaultTime, SlippingWheels};

const DURATION: Bounded = Bounded(Quantity::seconds("time").within(0.0, 1e9));

impl Form for FaultSpec {
    fn bare(&self) -> Self {
        Self::VARIANTS[self.variant_index()].2()
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("FaultForm", "An injected fault; docs/faults.md has an example of each kind.");
        if !keys.variant(self) {
            return;
        }
        keys.span(&mut self.span);
        let mut name = (!self.name.is_empty()).then(|| self.name.clone());
        keys.key("name", "Its name, which with the seed determines its random times; default: the kind.")
            .nullable(TEXT, &mut name);
        self.name = name.unwrap_or_default();
        keys.key("robot", "Number of the robot; default: 1.").optional(ROBOT_NUMBER, &mut self.robot);
        match &mut self.kind {
            FaultKind::Dies | FaultKind::RadioOff => {}
            FaultKind::SensorOff { sensor } => {
                keys.key("sensor", "Name of the sensor, which then sees nothing.").required(TEXT, sensor);
            }
            FaultKind::SensorStuck { sensor } => {
                keys.key("sensor", "Name of the PSD or other distance sensor, which then repeats its last reading.")
                    .required(TEXT, sensor);
            }
            FaultKind::Slip { wheels, share } => {
                keys.key("wheels", "Wheels that slip; default: all.").optional(Word, wheels);
                keys.key(
                    "slip_percent",
                    "Fraction of a wheel's distance that is lost, in percent; at most 50 for one side.",
                )
                .required(Bounded(Quantity::percent("slip", 0.0, 100.0)), share);
                if let Some((reader, section)) = keys.reading()
                    && *wheels != SlippingWheels::All
                    && *share > 0.5
                {
                    let span = reader.value_span(section, "slip_percent");
                    let message = "wheels of one side slip by more than 50 percent";
                    reader.sink.error(Code::NumberRange, span, message, "a number from 0 to 50, or all wheels");
                }
            }
            FaultKind::Noise { parameter, value } => {
                keys.key("parameter", "Table and key of the noise profile, such as `psd.sigma_mm`.")
                    .required(TEXT, parameter);
                keys.key("value", "Value during the fault, in the unit of the key.")
                    .required(Quantity::number("value", -1e9, 1e9), value);
            }
        }
        time_keys(keys, &mut self.time);
        let is_end = matches!(self.kind, FaultKind::Dies);
        if !is_end {
            keys.key("for_s", "Duration in seconds; default: until the end of the run.")
                .nullable(DURATION, &mut self.duration);
        }
    }
}

/// Declares when a fault begins.
fn time_keys(keys: &mut Keys<'_>, time: &mut FaultTime) {
    let (mut at, mut probability, mut rate) = match *time {
        FaultTime::Once { at, probability } => (Some(at), probability, None),
        FaultTime::Random { per_minute } => (None, 1.0, Some(per_minute)),
    };
    if keys.reading().is_some() {
        at = None;
    }
    keys.key("at_s", "Simulated seconds at which it begins.").nullable(DURATION, &mut at);
    keys.key("probability", "Probability that the fault occurs at all; default: 1.")
        .optional(Bounded(Quantity::number("probability", 0.0, 1.0)), &mut probability);
    keys.key("per_minute", "Mean number of random beginnings per minute, instead of `at_s`.")
        .nullable(Bounded(Quantity::number("rate", 1e-6, 1e3)), &mut rate);
    let Some((reader, section)) = keys.reading() else { return };
    if section.has("per_minute") {
        let is_clean = reader.exclude(section, "per_minute", &["at_s", "probability"]);
        match rate.filter(|_| is_clean) {
            Some(per_minute) => *time = FaultTime::Random { per_minute },
            None => keys.refuse(),
        }
        return;
    }
    if !section.has("at_s") {
        let message = "a fault has no `at_s`";
        let expected = "`at_s = ...` for one instant, or `per_minute = ...` for random ones";
        reader.sink.error(Code::TomlMissing, section.span, message, expected);
    }
    match at {
        Some(at) => *time = FaultTime::Once { at, probability },
        None => keys.refuse(),
    }
}

impl Variants for FaultSpec {
    const VARIANTS: &'static [Variant<Self>] = &[
        ("dies", "The robot's program ends, its motors stop, its radio is silent; its body stays.", || {
            fault(FaultKind::Dies)
        }),
        ("sensor_off", "A sensor sees nothing.", || fault(FaultKind::SensorOff { sensor: String::new() })),
        ("sensor_stuck", "A distance sensor repeats its last reading.", || {
            fault(FaultKind::SensorStuck { sensor: String::new() })
        }),
        ("slip", "Wheels slip.", || fault(FaultKind::Slip { wheels: SlippingWheels::All, share: 0.0 })),
        ("radio_off", "The radio neither sends nor receives.", || fault(FaultKind::RadioOff)),
        ("noise", "A number of the noise models has another value.", || {
            fault(FaultKind::Noise { parameter: String::new(), value: 0.0 })
        }),
    ];

    fn variant_index(&self) -> usize {
        Self::VARIANTS.iter().position(|(word, ..)| *word == self.kind.word()).unwrap_or_default()
    }
}

/// A fault of this kind with default properties.
fn fault(kind: FaultKind) -> FaultSpec {
    FaultSpec { kind, ..FaultSpec::default() }
}

impl Words for SlippingWheels {
    const NAME: &'static str = "SlippingWheelsForm";
    const ABOUT: &'static str = "Wheels that slip.";
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (SlippingWheels::All, "all", "All wheels."),
        (SlippingWheels::Left, "left", "Those on the left."),
        (SlippingWheels::Right, "right", "Those on the right."),
    ];
}
