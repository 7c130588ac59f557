//! Legs and gaits.

use serde_json::json;

use super::kind::{Bounded, Custom, Kind, TABLE, TABLES, TEXT, TablesUpTo, Word, Words};
use super::{Form, Keys};
use crate::Span;
use crate::code::Code;
use crate::line::Quantity;
use crate::spec::{DEFAULT_DUTY, DEFAULT_PERIOD, GaitSpec, LegSpec, LegsSpec, RobiSpec};
use crate::table::Reader;
use sim_core::build;
use sim_core::drive::DriveKind;
use sim_core::drive::legged::Foot;
use sim_core::unit;

/// Maximum number of legs of a robot, and of gaits.
const MAX_COUNT: usize = 16;
const OFFSET: Quantity = Quantity::number("offset", 0.0, 1.0);

/// Declares `[legs]` and `[[leg]]` of a robot type.
pub(crate) fn leg_keys(keys: &mut Keys<'_>, robi: &mut RobiSpec) {
    let mut legs = robi.legs.take();
    let mut leg_list = legs.as_ref().map_or_else(Vec::new, |legs| legs.legs.clone());
    let mut common = legs.clone().filter(|legs| LegsSpec { legs: Vec::new(), ..legs.clone() } != LegsSpec::default());
    keys.key("legs", "Gaits and common properties of the legs; for `kind = \"legged\"`.").nullable(TABLE, &mut common);
    keys.key("leg", "The legs.").list(TABLES, &mut leg_list);
    if let Some((reader, section)) = keys.reading() {
        let key = ["leg", "legs"].into_iter().find(|key| section.has(key));
        let span = key.map_or(section.span, |key| reader.key_span(section, key));
        let read = LegsSpec { legs: leg_list, ..common.unwrap_or_default() };
        legs = reader.check_legs(read, robi.drive.kind == DriveKind::Legged, key.is_some(), span);
    }
    robi.legs = legs;
}

impl Form for LegsSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("LegsForm", "Gaits and common properties of a robot's legs; for `kind = \"legged\"`.");
        keys.key("step_height_mm", "Lift of a foot above the higher of its two footholds, in mm; default: 30.")
            .optional(Quantity::length("height of a step"), &mut self.step_height);
        keys.key("radius_mm", "Radius of thighs and shanks in mm, for contacts; default: 20.")
            .optional(Quantity::length("radius of thighs and shanks"), &mut self.radius);
        keys.key("gait", "Gaits; the robot starts with the first one; default: one foot after the other.")
            .list(TablesUpTo(MAX_COUNT), &mut self.gaits);
    }
}

impl Form for GaitSpec {
    fn defaults() -> Self {
        Self { period: DEFAULT_PERIOD, duty: DEFAULT_DUTY, ..Self::default() }
    }

    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("GaitForm", "A gait.");
        let period = Quantity::milliseconds("period").within(10.0, 3.6e6);
        let mut curve = if self.has_natural_curve { Curve::Natural } else { Curve::Plain };
        keys.span(&mut self.span);
        keys.key("name", "Its name.").required(TEXT, &mut self.name);
        keys.key("period_ms", "Time from one lift-off of a foot to its next in ms; default: 1000.")
            .optional(Bounded(period), &mut self.period);
        keys.key("duty", "Fraction of the period during which a foot is on the ground; default: 0.8.")
            .optional(Bounded(Quantity::number("duty factor", 0.05, 0.98)), &mut self.duty);
        keys.key("offsets", "Fraction of the period after which each leg lifts off; default: at equal distances.")
            .list(OFFSETS, &mut self.offsets);
        keys.key(
            "curve",
            "Motion of the joints: from the path of the foot (`plain`, the default) or from joint angles of people (`natural`).",
        )
        .optional(Word, &mut curve);
        self.has_natural_curve = curve == Curve::Natural;
    }
}

/// Motion of the joints in a gait.
#[derive(Clone, Copy, PartialEq)]
enum Curve {
    Plain,
    Natural,
}

impl Words for Curve {
    const NAME: &'static str = "CurveForm";
    const ABOUT: &'static str = "Motion of the joints in a gait.";
    const WORDS: &'static [(Self, &'static str, &'static str)] = &[
        (Curve::Plain, "plain", "The path of the foot alone."),
        (Curve::Natural, "natural", "Joint angles of people, for two legs with feet."),
    ];
}

/// Phase offsets as fractions of a period, one per leg.
const OFFSETS: Custom<Vec<f64>> = Custom {
    read: |context| {
        let items = context.reader.array(context.section, context.key, "an array of numbers, one a leg")?;
        Some(items.iter().filter_map(|item| context.reader.as_number(context.key, item, &OFFSET)).collect())
    },
    print: |offsets| offsets.clone().into(),
    describe: |definitions| json!({ "type": "array", "items": OFFSET.describe(definitions) }),
};

impl Form for LegSpec {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form(
            "LegForm",
            "A leg: yaw and roll in the hip, thigh, knee, shank, and a foot with its ankle, a wheel or a bare tip.",
        );
        let coordinate = Quantity::coordinate("coordinate of the hip");
        keys.span(&mut self.span);
        keys.key(
            "name",
            "Its name; sensors can be mounted on the links `NAME.thigh`, `NAME.shank` and, with a foot, `NAME.foot`.",
        )
        .required(TEXT, &mut self.name);
        keys.key("x_mm", "Position of the hip forward of the robot's centre in mm; default: 0.")
            .optional(coordinate, &mut self.hip.x);
        keys.key("y_mm", "Position of the hip to the left in mm; default: 0.").optional(coordinate, &mut self.hip.y);
        keys.key("z_mm", "Height of the hip of the robot at rest, in mm.")
            .required(Quantity::size("height of the hip"), &mut self.hip.z);
        keys.key("thigh_mm", "Length from hip to knee in mm.")
            .required(Quantity::size("length of the thigh"), &mut self.thigh);
        keys.key("shank_mm", "Length from knee to ankle or tip in mm.")
            .required(Quantity::size("length of the shank"), &mut self.shank);
        keys.key("foot", "Its foot.").nullable(TABLE, &mut self.foot);
        keys.key("wheel_mm", "Diameter in mm of a wheel instead of a foot; it rolls and is never lifted.")
            .nullable(Quantity::size("diameter of the wheel"), &mut self.wheel);
        if let Some((reader, section)) = keys.reading()
            && self.foot.is_some()
            && self.wheel.take().is_some()
        {
            let span = reader.key_span(section, "wheel_mm");
            reader.sink.error(Code::TomlConflict, span, "`foot` and `wheel_mm` exclude each other", "one of the two");
        }
    }
}

impl Form for Foot {
    fn keys(&mut self, keys: &mut Keys<'_>) {
        keys.form("FootForm", "A flat foot.");
        keys.key("heel_mm", "From the ankle back to the heel in mm.")
            .required(Quantity::length("length of the heel"), &mut self.heel);
        keys.key("toe_mm", "From the ankle ahead to the toe on which it rolls off, in mm.")
            .required(Quantity::length("length to the toe"), &mut self.toe);
        keys.key("height_mm", "Height of the ankle above the sole in mm.")
            .required(Quantity::length("height of the ankle"), &mut self.height);
    }
}

impl Reader {
    /// Validates the legs of a robot type: reports inconsistencies, and removes legs on which the robot cannot stand.
    fn check_legs(&mut self, mut legs: LegsSpec, is_legged: bool, has_legs: bool, span: Span) -> Option<LegsSpec> {
        if legs.legs.len() > MAX_COUNT {
            let message = format!("the robot has {} legs", legs.legs.len());
            self.sink.error(Code::NumberRange, span, message, format!("at most {MAX_COUNT} legs"));
            legs.legs.truncate(MAX_COUNT);
        }
        if !is_legged {
            if has_legs {
                let message = "the robot has legs but drives on wheels; the legs are left out";
                let expected = "`drive LEGGED_DRIVE` in the robi, or `kind = \"legged\"` in `drive`";
                self.sink.error(Code::LegDrive, span, message, expected);
            }
            return None;
        }
        let count = legs.legs.len();
        for gait in &mut legs.gaits {
            if !gait.offsets.is_empty() && gait.offsets.len() != count {
                let message = format!("gait `{}` has {} offsets for {count} legs", gait.name, gait.offsets.len());
                self.sink.error(Code::LegGait, gait.span, message, "`offsets` with one number for each `[[leg]]`");
                gait.offsets.clear();
            }
        }
        legs.legs.retain(|spec| {
            let leg = build::leg(spec);
            let (min, max) = leg.standing_heights();
            let can_stand = (min..=max).contains(&spec.hip.z);
            if !can_stand {
                let [min, max] = [min.max(0.0), max].map(|metres| unit::mm_from_metres(metres).floor());
                let message = format!("leg `{}` cannot stand with its hip at this height", spec.name.text);
                self.sink.error(Code::LegReach, spec.span, message, format!("`z_mm` from {min} to {max}"));
            }
            can_stand
        });
        if legs.legs.len() < count {
            // The offsets belong to the complete list of legs.
            legs.gaits.iter_mut().for_each(|gait| gait.offsets.clear());
        }
        if legs.legs.is_empty() {
            let message = "the robot is to walk and has no legs: it glides";
            self.sink.error(Code::LegDrive, span, message, "a table `[[leg]]` for each leg");
        }
        Some(legs)
    }
}
