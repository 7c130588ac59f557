//! The keys of a noise profile, with their units and ranges.

use super::{Angle, Image, Motion, Place, Radio, Range};
use crate::unit::Quantity;

/// A key of a section and the number of the model that it sets.
pub struct Key<M: 'static> {
    /// Name of the key.
    pub name: &'static str,
    /// Physical quantity, unit and range of the number.
    pub quantity: Quantity,
    /// Accessor of the number in the model.
    pub place: Place<M>,
}

/// Keys of a section, in the order of a profile.
pub type Keys<M> = &'static [Key<M>];

const fn key<M>(name: &'static str, quantity: Quantity, place: Place<M>) -> Key<M> {
    Key { name, quantity, place }
}

/// Greatest error of a distance, mm: more than the range of any sensor.
const FAR: f64 = 1e6;
/// Greatest error of a drive's speed, mm/s and degrees/s.
const FAST: f64 = 1e5;

const fn spread(name: &'static str) -> Quantity {
    Quantity::length(name).within(0.0, FAR)
}

const fn offset(name: &'static str) -> Quantity {
    Quantity::coordinate(name).within(-FAR, FAR)
}

const fn share(name: &'static str) -> Quantity {
    Quantity::percent(name, 0.0, 1000.0)
}

const fn probability(name: &'static str) -> Quantity {
    Quantity::number(name, 0.0, 1.0)
}

const fn turn(name: &'static str, low: f64) -> Quantity {
    Quantity::angle(name).within(low, 360.0)
}

/// Keys of all distance sensors.
pub const RANGE: Keys<Range> = &[
    key("sigma_mm", spread("standard deviation"), |range| &mut range.sigma),
    key("sigma_percent", share("standard deviation"), |range| &mut range.sigma_share),
    key("bias_mm", offset("bias"), |range| &mut range.bias),
    key("bias_sigma_mm", spread("standard deviation of the bias"), |range| &mut range.bias_sigma),
    key("step_mm", spread("step"), |range| &mut range.step),
    key("outlier", probability("probability of an outlier"), |range| &mut range.outlier),
    key("dropout", probability("probability of a drop-out"), |range| &mut range.dropout),
    key("drift_mm", offset("drift"), |range| &mut range.drift),
    key("drift_s", Quantity::seconds("time of the drift").within(1e-3, 1e9), |range| &mut range.drift_time),
];

/// Additional keys of distance sensors whose own model has noise.
pub const OWN: Keys<Range> =
    &[key("device", Quantity::number("share of the device's own noise", 0.0, 1000.0), |range| &mut range.device)];

/// Keys of the compass.
pub const COMPASS: Keys<Angle> = &[
    key("sigma_deg", turn("standard deviation", 0.0), |angle| &mut angle.sigma),
    key("bias_deg", turn("bias", -360.0), |angle| &mut angle.bias),
    key("bias_sigma_deg", turn("standard deviation of the bias", 0.0), |angle| &mut angle.bias_sigma),
    key("step_deg", turn("step", 0.0), |angle| &mut angle.step),
];

/// Keys of the camera.
pub const CAMERA: Keys<Image> = &[
    key("blur", Quantity::number("blur", 0.0, 20.0), |image| &mut image.blur),
    key("sigma", Quantity::number("standard deviation", 0.0, 255.0), |image| &mut image.sigma),
    key("salt_and_pepper", probability("probability of salt and pepper"), |image| &mut image.salt_and_pepper),
    key("salt", probability("share of salt"), |image| &mut image.salt),
    key("hundreds_and_thousands", probability("probability of hundreds and thousands"), |image| {
        &mut image.hundreds_and_thousands
    }),
];

/// Keys of the errors between command and motion.
pub const DRIVE: Keys<Motion> = &[
    key("left_percent", Quantity::percent("error of the left wheels", -50.0, 100.0), |motion| &mut motion.left),
    key("right_percent", Quantity::percent("error of the right wheels", -50.0, 100.0), |motion| &mut motion.right),
    key("diameter_sigma_percent", Quantity::percent("standard deviation of the diameters", 0.0, 5.0), |motion| {
        &mut motion.diameter_sigma
    }),
    key("slip_percent", Quantity::percent("slip", -100.0, 100.0), |motion| &mut motion.slip),
    key("slip_sigma_percent", Quantity::percent("standard deviation of the slip", 0.0, 100.0), |motion| {
        &mut motion.slip_sigma
    }),
    key("v_sigma_mm_s", SPEED, |motion| &mut motion.command.speed),
    key("v_sigma_percent", share("standard deviation of the speed"), |motion| &mut motion.command.speed_share),
    key("omega_sigma_deg_s", TURN, |motion| &mut motion.command.turn),
    key("omega_sigma_percent", share("standard deviation of the turning speed"), |motion| {
        &mut motion.command.turn_share
    }),
];

/// Keys of the errors between motion and odometry.
pub const ODOMETRY: Keys<Motion> = &[
    key("v_sigma_mm_s", SPEED, |motion| &mut motion.odometry.speed),
    key("v_sigma_percent", share("standard deviation of the speed"), |motion| &mut motion.odometry.speed_share),
    key("omega_sigma_deg_s", TURN, |motion| &mut motion.odometry.turn),
    key("omega_sigma_percent", share("standard deviation of the turning speed"), |motion| {
        &mut motion.odometry.turn_share
    }),
    key("step_mm", spread("step"), |motion| &mut motion.resolution.length),
    key("step_deg", turn("step", 0.0), |motion| &mut motion.resolution.angle),
];

/// Keys of the radio's reception.
pub const RADIO: Keys<Radio> = &[
    key("bit_error_rate", probability("bit error rate"), |radio| &mut radio.bit_error_rate),
    key("packet_loss", probability("probability of a lost message"), |radio| &mut radio.packet_loss),
];

const SPEED: Quantity = Quantity::speed("standard deviation of the speed").within(0.0, FAST);
const TURN: Quantity = Quantity::rate("standard deviation of the turning speed").within(0.0, 50_000.0);
