//! The keys of a noise profile, with their units and ranges.

use super::{Accessor, CompassNoise, ImageNoise, MotionNoise, RadioNoise, RangeNoise};
use crate::unit::Quantity;

/// A key of a section and the parameter of the model that it sets.
pub struct Key<M: 'static> {
    /// Name of the key.
    pub name: &'static str,
    /// Description for users, one sentence.
    pub about: &'static str,
    /// Quantity of the parameter, with its unit and bounds.
    pub quantity: Quantity,
    /// Accessor of the parameter in the model.
    pub accessor: Accessor<M>,
}

/// Keys of a section, in the order in which a profile prints them.
pub type Keys<M> = &'static [Key<M>];

const fn key<M>(name: &'static str, about: &'static str, quantity: Quantity, accessor: Accessor<M>) -> Key<M> {
    Key { name, about, quantity, accessor }
}

/// Maximum error of a distance, mm: more than the range of any sensor.
const MAX_DISTANCE_ERROR: f64 = 1e6;
/// Maximum error of a drive's speed, mm/s.
const MAX_SPEED_ERROR: f64 = 1e5;

const fn magnitude(name: &'static str) -> Quantity {
    Quantity::length(name).within(0.0, MAX_DISTANCE_ERROR)
}

const fn signed_length(name: &'static str) -> Quantity {
    Quantity::coordinate(name).within(-MAX_DISTANCE_ERROR, MAX_DISTANCE_ERROR)
}

const fn relative(name: &'static str) -> Quantity {
    Quantity::percent(name, 0.0, 1000.0)
}

const fn probability(name: &'static str) -> Quantity {
    Quantity::number(name, 0.0, 1.0)
}

const fn angle_error(name: &'static str, low: f64) -> Quantity {
    Quantity::angle(name).within(low, 360.0)
}

/// Keys of all distance sensors.
pub const RANGE: Keys<RangeNoise> = &[
    key("sigma_mm", "Standard deviation of each reading in mm.", magnitude("standard deviation"), |range| {
        &mut range.sigma
    }),
    key(
        "sigma_percent",
        "Standard deviation of each reading in percent of the distance.",
        relative("standard deviation"),
        |range| &mut range.sigma_share,
    ),
    key(
        "sigma_per_m",
        "Coefficient k in 1/m of a standard deviation k d^2 of each reading, where d is the distance.",
        Quantity::per_metre("coefficient of the standard deviation", 1000.0),
        |range| &mut range.sigma_per_m,
    ),
    key("bias_mm", "Error of all readings in mm.", signed_length("bias"), |range| &mut range.bias),
    key(
        "bias_sigma_mm",
        "Standard deviation of a constant error, drawn once for each sensor, in mm.",
        magnitude("standard deviation of the bias"),
        |range| &mut range.bias_sigma,
    ),
    key("step_mm", "Step of the readings in mm.", magnitude("step"), |range| &mut range.step),
    key(
        "outlier",
        "Probability of a reading anywhere in the sensor's range.",
        probability("probability of an outlier"),
        |range| &mut range.outlier,
    ),
    key("dropout", "Probability of no return.", probability("probability of a drop-out"), |range| &mut range.dropout),
    key("drift_mm", "Error at the start of the run in mm; it decays exponentially.", signed_length("drift"), |range| {
        &mut range.drift
    }),
    key(
        "drift_s",
        "Time in s in which the drift decays to 1/e; default: 60.",
        Quantity::seconds("time of the drift").within(1e-3, 1e9),
        |range| &mut range.drift_time,
    ),
];

/// Keys of distance sensors whose sensor model contains noise.
pub const DEVICE_NOISE: Keys<RangeNoise> = &[key(
    "device",
    "Factor on the sensor's own noise, which its `sigma` and `mean` define; 1: unchanged.",
    Quantity::number("share of the device's own noise", 0.0, 1000.0),
    |range| &mut range.device,
)];

/// Keys of the compass.
pub const COMPASS: Keys<CompassNoise> = &[
    key(
        "sigma_deg",
        "Standard deviation of each reading in degrees.",
        angle_error("standard deviation", 0.0),
        |angle| &mut angle.sigma,
    ),
    key("bias_deg", "Error of all readings in degrees.", angle_error("bias", -360.0), |angle| &mut angle.bias),
    key(
        "bias_sigma_deg",
        "Standard deviation of a constant error, drawn once for each compass, in degrees.",
        angle_error("standard deviation of the bias", 0.0),
        |angle| &mut angle.bias_sigma,
    ),
    key("step_deg", "Step of the readings in degrees.", angle_error("step", 0.0), |angle| &mut angle.step),
];

/// Keys of the camera.
pub const CAMERA: Keys<ImageNoise> = &[
    key(
        "blur",
        "Standard deviation of the lens's point spread, in pixels.",
        Quantity::number("blur", 0.0, 20.0),
        |image| &mut image.blur,
    ),
    key(
        "sigma",
        "Standard deviation of each channel of each pixel, in levels of 0 to 255.",
        Quantity::number("standard deviation", 0.0, 255.0),
        |image| &mut image.sigma,
    ),
    key(
        "salt_and_pepper",
        "Probability of a white or black pixel.",
        probability("probability of salt and pepper"),
        |image| &mut image.salt_and_pepper,
    ),
    key(
        "salt",
        "Fraction of white pixels among the white and black pixels; default: 0.5.",
        probability("share of salt"),
        |image| &mut image.salt,
    ),
    key(
        "hundreds_and_thousands",
        "Probability of a pixel of random colour.",
        probability("probability of hundreds and thousands"),
        |image| &mut image.hundreds_and_thousands,
    ),
];

/// Keys of the errors between command and motion.
pub const DRIVE: Keys<MotionNoise> = &[
    key(
        "left_percent",
        "Excess of the diameter of the left wheels over the nominal diameter, in percent.",
        Quantity::percent("error of the left wheels", -50.0, 100.0),
        |motion| &mut motion.left,
    ),
    key(
        "right_percent",
        "Excess of the diameter of the right wheels over the nominal diameter, in percent.",
        Quantity::percent("error of the right wheels", -50.0, 100.0),
        |motion| &mut motion.right,
    ),
    key(
        "diameter_sigma_percent",
        "Standard deviation of a further excess in percent, drawn once for each wheel.",
        Quantity::percent("standard deviation of the diameters", 0.0, 5.0),
        |motion| &mut motion.diameter_sigma,
    ),
    key(
        "slip_percent",
        "Slip ratio in percent of the rolled distance.",
        Quantity::percent("slip", -100.0, 100.0),
        |motion| &mut motion.slip,
    ),
    key(
        "slip_sigma_percent",
        "Standard deviation of the slip in percent, drawn for each wheel every 10 ms.",
        Quantity::percent("standard deviation of the slip", 0.0, 100.0),
        |motion| &mut motion.slip_sigma,
    ),
    key("v_sigma_mm_s", "Standard deviation of the speed in mm/s, drawn every 10 ms.", SPEED, |motion| {
        &mut motion.command.speed
    }),
    key(
        "v_sigma_percent",
        "Standard deviation of the speed, in percent of the speed, drawn every 10 ms.",
        relative("standard deviation of the speed"),
        |motion| &mut motion.command.speed_share,
    ),
    key(
        "omega_sigma_deg_s",
        "Standard deviation of the turning speed in degrees/s, drawn every 10 ms.",
        TURN,
        |motion| &mut motion.command.turn,
    ),
    key(
        "omega_sigma_percent",
        "Standard deviation of the turning speed, in percent of the turning speed, drawn every 10 ms.",
        relative("standard deviation of the turning speed"),
        |motion| &mut motion.command.turn_share,
    ),
    key(
        "distance_bound_mm",
        "Maximum error of the distance of a drive in mm; the error of each drive is uniform within this bound.",
        magnitude("bound of the distance"),
        |motion| &mut motion.bound.length,
    ),
    key(
        "angle_bound_deg",
        "Maximum error of the angle of a drive in degrees; the error of each drive is uniform within this bound.",
        angle_error("bound of the angle", 0.0),
        |motion| &mut motion.bound.angle,
    ),
];

/// Keys of the errors between motion and odometry.
pub const ODOMETRY: Keys<MotionNoise> = &[
    key("v_sigma_mm_s", "Standard deviation of the speed in mm/s, drawn every 10 ms.", SPEED, |motion| {
        &mut motion.odometry.speed
    }),
    key(
        "v_sigma_percent",
        "Standard deviation of the speed, in percent of the speed, drawn every 10 ms.",
        relative("standard deviation of the speed"),
        |motion| &mut motion.odometry.speed_share,
    ),
    key(
        "omega_sigma_deg_s",
        "Standard deviation of the turning speed in degrees/s, drawn every 10 ms.",
        TURN,
        |motion| &mut motion.odometry.turn,
    ),
    key(
        "omega_sigma_percent",
        "Standard deviation of the turning speed, in percent of the turning speed, drawn every 10 ms.",
        relative("standard deviation of the turning speed"),
        |motion| &mut motion.odometry.turn_share,
    ),
    key("step_mm", "Step of positions in mm.", magnitude("step"), |motion| &mut motion.resolution.length),
    key("step_deg", "Step of headings in degrees.", angle_error("step", 0.0), |motion| &mut motion.resolution.angle),
];

/// Keys of the radio's reception.
pub const RADIO: Keys<RadioNoise> = &[
    key(
        "bit_error_rate",
        "Probability that a bit of the payload arrives inverted.",
        probability("bit error rate"),
        |radio| &mut radio.bit_error_rate,
    ),
    key(
        "packet_loss",
        "Probability that a message does not arrive.",
        probability("probability of a lost message"),
        |radio| &mut radio.packet_loss,
    ),
];

const SPEED: Quantity = Quantity::speed("standard deviation of the speed").within(0.0, MAX_SPEED_ERROR);
const TURN: Quantity = Quantity::rate("standard deviation of the turning speed").within(0.0, 50_000.0);
