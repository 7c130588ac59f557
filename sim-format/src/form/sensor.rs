//! Mounting poses of devices, and distance sensors.

use std::mem::discriminant;

use glam::DVec3;
use serde_json::{Value as Json, json};
use toml::Value;

use super::kind::{Bounded, HiddenBounds, Kind, ReadContext, TABLE, TEXT, Word, Words};
use super::{Definitions, Form, Keys, print, reference};
use crate::code::Code;
use crate::line::Quantity;
use crate::robi::{LIDAR_SWEEP, LIDAR_TILT, MAX_LIDAR_POINTS};
use crate::spec::{
    Axis, BODY, DEFAULT_PSD_RANGE, LidarSpec, LinkJointSpec, LinkSpec, MountSpec, PsdSpec, RangeSpec, SpannedText,
    Surface,
};
use sim_core::sensor::{Echo, RangeModel, SideLobes, Sonar};
use sim_core::unit::mm_from_metres;

/// Maximum number of a bus; a robot hardly has a hundred microcontrollers for its sonars.
const MAX_BUS: i64 = 100;
/// Maximum number of rays of a sonar.
const MAX_RAYS: i64 = 4096;

const PITCH: Quantity = Quantity::angle("pitch");
pub(crate) const POINT_3D: [Quantity; 3] =
    [Quantity::coordinate("x"), Quantity::coordinate("y"), Quantity::coordinate("z")];

/// Declares the name and the number of a device.
pub(crate) fn device_keys(keys: &mut Keys<'_>, about: &'static str, name: &mut String, id: &mut Option<i32>) {
    keys.key("name", about).required(TEXT, name);
    number_key(keys, id);
}

/// Declares the number of a device.
pub(crate) fn number_key(keys: &mut Keys<'_>, id: &mut Option<i32>) {
    let any = HiddenBounds(i64::from(i32::MIN)..=i64::from(i32::MAX));
    keys.key("id", "Its number for programs; default: from `hdt_sem.h`.").nullable(any, id);
}

/// Declares the position of a device on the body.
pub(crate) fn position_keys(keys: &mut Keys<'_>, [x, y, z]: [Quantity; 3], position: &mut DVec3) {
    keys.key("x_mm", "Position forward of the robot's centre in mm; default: 0.").optional(x, &mut position.x);
    keys.key("y_mm", "Position to the left in mm; default: 0.").optional(y, &mut position.y);
    keys.key("z_mm", "Height in mm; default: 0.").optional(z, &mut position.z);
}

/// Declares a 3D pose on the body or on a link.
fn mount_keys(keys: &mut Keys<'_>, mount: &mut MountSpec) {
    let MountSpec { link, position, roll, pitch, yaw } = mount;
    let [x, y, z] = POINT_3D;
    link_key(keys, link);
    keys.key("x_mm", "Position forward in mm; default: 0.").optional(x, &mut position.x);
    keys.key("y_mm", "Position to the left in mm; default: 0.").optional(y, &mut position.y);
    keys.key("z_mm", "Position upwards in mm; default: 100 for a laser scanner, otherwise 0.")
        .optional(z, &mut position.z);
    keys.key(
        "roll_deg",
        "Rotation about x, left side upwards, in degrees; the first of the three rotations; default: 0.",
    )
    .optional(Quantity::angle("roll"), roll);
    keys.key("pitch_deg", "Rotation upwards in degrees; the second of the three rotations; default: 0.")
        .optional(PITCH, pitch);
    keys.key("yaw_deg", "Rotation to the left in degrees; the third of the three rotations; default: 0.")
        .optional(Quantity::angle("yaw"), yaw);
}

/// Declares the link that a device is mounted on.
pub(crate) fn link_key(keys: &mut Keys<'_>, link: &mut Option<SpannedText>) {
    keys.key("on", "The link on which it is mounted; default: `body`.").nullable(TEXT, link);
    link.take_if(|name| name.text == BODY);
}

impl Words for Axis {
    const NAME: &'static str = "AxisForm";
    const ABOUT: &'static str = "An axis of a body's frame.";
    const WORDS: &'static [(Self, &'static str, &'static str)] =
        &[(Axis::X, "x", "Forward."), (Axis::Y, "y", "To the left."), (Axis::Z, "z", "Upwards.")];
}

impl Form for Surface {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("SurfaceForm", "How a surface reflects.");
        let fraction = |name| Bounded(Quantity::number(name, 0.0, 1.0));
        keys.key("reflectivity", "Fraction of the energy that is reflected, 0 to 1; default: 1.")
            .optional(fraction("reflectivity"), &mut self.reflectivity);
        keys.key("specular", "Fraction of the reflected energy that is reflected specularly, 0 to 1; default: 0.")
            .optional(fraction("specular share"), &mut self.specular);
    }
}

impl Form for LinkSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("LinkForm", "A rigid part on the body or on another link; a servo may turn it.");
        let mut axis = self.joint.as_ref().map_or(Axis::Z, |joint| joint.axis);
        let mut servo = self.joint.take().map(|joint| joint.servo);
        keys.span(&mut self.span);
        keys.key("name", "Its name, by which sensors and links refer to it.").required(TEXT, &mut self.name);
        mount_keys(keys, &mut self.mount);
        keys.mention_first(&["servo"]);
        keys.key("axis", "Axis about which the servo turns the link: x rolls, y pitches (upwards), z (default) yaws.")
            .optional(Word, &mut axis);
        keys.key("servo", "The servo that turns the link; default: none, a fixed link.").nullable(TEXT, &mut servo);
        if let Some((reader, section)) = keys.reading()
            && section.has("axis")
            && !section.has("servo")
        {
            reader.missing(section, "servo");
        }
        self.joint = servo.map(|servo| LinkJointSpec { axis, servo });
    }
}

impl Form for PsdSpec {
    fn defaults() -> Self {
        Self { range: DEFAULT_PSD_RANGE, ..Self::default() }
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("PsdForm", "A PSD distance sensor.");
        keys.span(&mut self.span);
        device_keys(keys, "Its name, such as `PSD_FRONT`.", &mut self.name, &mut self.id);
        keys.mention_first(&["x_mm", "y_mm", "z_mm"]);
        link_key(keys, &mut self.link);
        position_keys(keys, POINT_3D, &mut self.position);
        keys.mention_first(&["pitch_deg"]);
        keys.key("angle_deg", "Direction in degrees, counter-clockwise from forward; default: 0.")
            .optional(Quantity::angle("angle of the sensor"), &mut self.angle);
        keys.key("pitch_deg", "Angle of the beam upwards in degrees; default: 0.").optional(PITCH, &mut self.pitch);
        keys.key("range_mm", "Range in mm; default: 800.")
            .always_printed(Quantity::size("range of the sensor"), &mut self.range);
    }
}

pub(crate) const RANGE_OF_PSDS: Quantity = Quantity::size("range of the PSDs");

/// Declares the keys of a PSD in a companion.
pub(crate) fn psd_keys(keys: &mut Keys<'_>, psd: &mut PsdSpec) {
    keys.key("range_mm", "Range in mm.").always_printed(RANGE_OF_PSDS, &mut psd.range);
    keys.key("pitch_deg", "Angle of the beam upwards in degrees.").optional(PITCH, &mut psd.pitch);
    link_key(keys, &mut psd.link);
}

impl Form for LidarSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("LidarForm", "The laser scanner.");
        keys.span(&mut self.span);
        mount_keys(keys, &mut self.mount);
        keys.key("range_mm", "Maximum distance along a ray in mm; default: 9999.")
            .optional(Quantity::size("range of the scanner"), &mut self.range);
        keys.mention_first(&["tilt_deg", "sweep_deg"]);
        keys.key("points", "Points of a scan; default: 360.")
            .always_printed(HiddenBounds(1..=i64::from(MAX_LIDAR_POINTS)), &mut self.points);
        keys.key("tilt_deg", "Angle of the scanning plane above the floor plane in degrees; default: 0.")
            .optional(LIDAR_TILT, &mut self.tilt);
        keys.key("sweep_deg", "Angle that a scan covers in degrees; default: 360.")
            .always_printed(LIDAR_SWEEP, &mut self.sweep);
    }
}

/// Name of the TOML table for a kind of range sensor.
pub(crate) fn model_name(model: &RangeModel) -> &'static str {
    match model {
        RangeModel::Psd { .. } => "psd",
        RangeModel::Laser(_) => "laser",
        RangeModel::Ultrasonic(_) => "ultrasonic",
        RangeModel::Reflectance(_) => "reflectance",
        RangeModel::Sonar(_) => "sonar",
    }
}

/// Declares the range sensors other than PSDs, one array of tables per kind.
pub(crate) fn range_sensor_keys(keys: &mut Keys<'_>, ranges: &mut Vec<RangeSpec>) {
    keys.key("laser", "Laser range finders.").list(RangeSensors(RangeModel::Laser(Echo::LASER)), ranges);
    keys.key("ultrasonic", "Ultrasonic range sensors with one ray.")
        .list(RangeSensors(RangeModel::Ultrasonic(Echo::ULTRASONIC)), ranges);
    keys.key("reflectance", "Reflectance sensors.")
        .list(RangeSensors(RangeModel::Reflectance(Echo::REFLECTANCE)), ranges);
    keys.key("sonar", "Sonars: ultrasonic range sensors with a beam.")
        .list(RangeSensors(RangeModel::Sonar(Sonar::srf08())), ranges);
}

/// Range sensors of one kind, with the model as their default.
struct RangeSensors(RangeModel);

impl RangeSensors {
    fn defaults(&self) -> RangeSpec {
        RangeSpec { model: self.0, ..RangeSpec::defaults() }
    }
}

impl Kind<Vec<RangeSpec>> for RangeSensors {
    fn read(&self, context: ReadContext<'_, '_>, _: Option<&Vec<RangeSpec>>) -> Option<Vec<RangeSpec>> {
        let sections = context.reader.sections(context.section, context.key);
        Some(sections.into_iter().filter_map(|section| context.reader.form(section, self.defaults())).collect())
    }

    fn print(&self, values: &Vec<RangeSpec>) -> Value {
        let of_kind = values.iter().filter(|range| discriminant(&range.model) == discriminant(&self.0));
        Value::Array(of_kind.map(|range| print(range).into()).collect())
    }

    fn describe(&self, definitions: &mut Definitions) -> Json {
        let items = reference(definitions, |keys| self.defaults().keys(keys));
        json!({ "type": "array", "items": items })
    }
}

impl Form for RangeSpec {
    fn bare(&self) -> Self {
        let model = match self.model {
            RangeModel::Laser(_) => RangeModel::Laser(Echo::LASER),
            RangeModel::Ultrasonic(_) => RangeModel::Ultrasonic(Echo::ULTRASONIC),
            RangeModel::Reflectance(_) => RangeModel::Reflectance(Echo::REFLECTANCE),
            RangeModel::Sonar(_) => RangeModel::Sonar(Sonar::srf08()),
            RangeModel::Psd { .. } => self.model,
        };
        Self { model, ..Self::default() }
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.span(&mut self.span);
        if let RangeModel::Sonar(_) = self.model {
            keys.form("SonarForm", "A sonar: an ultrasonic sensor with a beam.");
            keys.mention_first(&[
                "preset",
                "min_mm",
                "max_mm",
                "half_angle_deg",
                "threshold",
                "rays",
                "side_lobes",
                "bus",
            ]);
            device_keys(keys, "Its name, such as `SONAR_FRONT`.", &mut self.name, &mut self.id);
            keys.key("preset", "The device whose values are the defaults; default: `SRF08`.")
                .nullable(Word, &mut None::<SonarPreset>);
        } else {
            keys.form("EchoForm", "A range sensor with one ray: a laser, an ultrasonic or a reflectance sensor.");
            keys.mention_first(&["min_mm", "max_mm", "incidence_deg"]);
            device_keys(keys, "Its name, such as `LASER_FRONT`.", &mut self.name, &mut self.id);
        }
        mount_keys(keys, &mut self.mount);
        match &mut self.model {
            RangeModel::Psd { .. } => {}
            RangeModel::Laser(echo) | RangeModel::Ultrasonic(echo) | RangeModel::Reflectance(echo) => {
                echo_keys(keys, echo)
            }
            RangeModel::Sonar(sonar) => sonar_keys(keys, sonar, self.bus.get_or_insert(1)),
        }
        keys.key("sigma", "Standard deviation of its noise, relative to the reading; default: 0.01.")
            .optional(Bounded(Quantity::number("standard deviation", 0.0, 1e3)), &mut self.sigma);
        keys.key("mean", "Mean of its noise, relative to the reading; default: 0.")
            .optional(Bounded(Quantity::number("mean", -1e3, 1e3)), &mut self.mean);
    }
}

fn echo_keys(keys: &mut Keys<'_>, echo: &mut Echo) {
    let incidence = Quantity::angle("greatest incidence").within(0.0, 90.0);
    let about = [
        "Minimum distance in mm; default: 100 for an ultrasonic sensor, otherwise 0.",
        "Maximum distance in mm; default: 2000 for a laser, otherwise 1000.",
    ];
    limit_keys(keys, about, [&mut echo.min, &mut echo.max]);
    keys.key(
        "incidence_deg",
        "Maximum angle of incidence in degrees; default: 45 for a laser, 15 for an ultrasonic sensor, otherwise 90.",
    )
    .optional(Bounded(incidence), &mut echo.max_incidence);
}

fn sonar_keys(keys: &mut Keys<'_>, sonar: &mut Sonar, bus: &mut u32) {
    let half_angle = Quantity::angle("half of the beam's angle").within(0.1, 90.0);
    let about = [
        "Minimum distance in mm; default: from the preset, 30.",
        "Maximum distance in mm; default: from the preset, 6000.",
    ];
    limit_keys(keys, about, [&mut sonar.min, &mut sonar.max]);
    keys.key("half_angle_deg", "Half of the beam's angle at -6 dB, in degrees; default: from the preset, 27.5.")
        .optional(Bounded(half_angle), &mut sonar.half_angle);
    keys.key("side_lobes", "A ring of sensitivity around the main lobe; default: none.")
        .nullable(TABLE, &mut sonar.side_lobes);
    keys.key(
        "threshold",
        "Minimum energy of a detectable echo; a perfect reflector 1 m ahead returns 1; default: from the preset.",
    )
    .optional(Bounded(Quantity::number("threshold", 0.0, 1e9)), &mut sonar.threshold);
    keys.key("bus", "Its bus, with at most 16 sonars on each; default: 1.").optional(1..=MAX_BUS, bus);
    keys.key("rays", "Number of rays; default: from the preset, 64.").optional(1..=MAX_RAYS, &mut sonar.rays);
}

/// Declares minimum and maximum distance; reports an empty range and restores the defaults.
fn limit_keys(keys: &mut Keys<'_>, about: [&'static str; 2], [min, max]: [&mut f64; 2]) {
    let defaults = [*min, *max];
    keys.key("min_mm", about[0]).optional(Bounded(Quantity::length("least distance")), min);
    keys.key("max_mm", about[1]).optional(Bounded(Quantity::size("greatest distance")), max);
    if let Some((reader, section)) = keys.reading()
        && *min >= *max
    {
        let key = if section.has("min_mm") { "min_mm" } else { "max_mm" };
        let [min_mm, max_mm] = [*min, *max].map(mm_from_metres);
        let message = format!("the least distance, {min_mm} mm, is not below the greatest, {max_mm} mm");
        let span = reader.key_span(section, key);
        reader.sink.error(Code::RobiRange, span, message, "`min_mm` below `max_mm`");
        [*min, *max] = defaults;
    }
}

/// Sonar models with built-in parameters.
#[derive(Clone, Copy, PartialEq)]
enum SonarPreset {
    Srf08,
}

impl Words for SonarPreset {
    const NAME: &'static str = "SonarPresetForm";
    const ABOUT: &'static str = "Sonars with built-in parameters.";
    const WORDS: &'static [(Self, &'static str, &'static str)] =
        &[(SonarPreset::Srf08, "SRF08", "The SRF08 by Devantech.")];
}

impl Form for SideLobes {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("SideLobesForm", "A ring of sensitivity around the main lobe of a sonar.");
        let angle = Quantity::angle("angle of the side lobes").within(0.0, 90.0);
        let half_width = Quantity::angle("half of the side lobes' width").within(0.01, 90.0);
        let gain = Quantity::number("gain of the side lobes", 0.0, 1.0);
        keys.key("angle_deg", "Angle between the line of sight and the middle of the ring in degrees.")
            .required(Bounded(angle), &mut self.angle);
        keys.key(
            "half_width_deg",
            "Half width of the ring in degrees, where the gain has fallen by 6 dB from the middle.",
        )
        .required(Bounded(half_width), &mut self.half_width);
        keys.key("gain", "Gain in the middle of the ring, relative to the main lobe.")
            .required(Bounded(gain), &mut self.gain);
    }
}
