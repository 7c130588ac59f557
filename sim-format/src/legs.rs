//! Legs and gaits in tables of TOML: the same words in a companion and in a scene.

use glam::DVec3;

use super::Span;
use super::code::Code;
use super::line::Quantity;
use super::spec::{DEFAULT_DUTY, DEFAULT_PERIOD, GaitSpec, LegSpec, LegsSpec, RobiSpec};
use super::table::{Reader, Section};
use sim_core::build;
use sim_core::drive::DriveKind;
use sim_core::drive::legged::Foot;
use sim_core::unit;

/// Most legs of a robot, and most gaits.
const MOST: usize = 16;
/// What the joints follow between footholds: the path of the foot alone, or people's joint angles.
const CURVES: [&str; 2] = ["plain", "natural"];
const DUTY: Quantity = Quantity::number("duty factor", 0.05, 0.98);
const OFFSET: Quantity = Quantity::number("offset", 0.0, 1.0);

impl Reader<'_> {
    /// `[legs]` and `[[leg]]`.
    pub(super) fn legs(&mut self, parent: &mut Section<'_, '_>, robi: &mut RobiSpec) {
        let has_legs = parent.has("legs") || parent.has("leg");
        let mut legs = LegsSpec::default();
        if let Some(section) = self.section(parent, "legs") {
            self.gaits(section, &mut legs);
        }
        for section in self.sections(parent, "leg") {
            legs.legs.extend(self.leg(section));
        }
        let key = if parent.has("leg") { "leg" } else { "legs" };
        let span = if has_legs { self.key_span(parent, key) } else { parent.span };
        if legs.legs.len() > MOST {
            let message = format!("the robot has {} legs", legs.legs.len());
            self.sink.error(Code::NumberRange, span, message, format!("at most {MOST} legs"));
            legs.legs.truncate(MOST);
        }
        let is_legged = robi.drive.kind == DriveKind::Legged;
        if has_legs && !is_legged {
            let message = "the robot has legs but drives on wheels; the legs are left out";
            let expected = "`drive LEGGED_DRIVE` in the robi, or `kind = \"legged\"` in `drive`";
            self.sink.error(Code::LegDrive, span, message, expected);
            return;
        }
        if is_legged {
            self.settle_legs(&mut legs, span);
            robi.legs = Some(legs);
        }
    }

    fn gaits(&mut self, mut section: Section<'_, '_>, legs: &mut LegsSpec) {
        self.set(&mut section, "step_height_mm", &Quantity::length("height of a step"), &mut legs.step_height);
        self.set(&mut section, "radius_mm", &Quantity::length("radius of thighs and shanks"), &mut legs.radius);
        for gait in self.sections(&mut section, "gait").into_iter().take(MOST) {
            legs.gaits.extend(self.gait(gait));
        }
        self.unknown_keys(&section);
    }

    fn gait(&mut self, mut section: Section<'_, '_>) -> Option<GaitSpec> {
        let name = self.required_reference(&mut section, "name");
        let [mut period, mut duty] = [DEFAULT_PERIOD, DEFAULT_DUTY];
        let milliseconds = Quantity::milliseconds("period").within(10.0, 3.6e6);
        self.set(&mut section, "period_ms", &milliseconds, &mut period);
        self.set(&mut section, "duty", &DUTY, &mut duty);
        let mut offsets = Vec::new();
        for item in self.array(&mut section, "offsets", "an array of numbers, one a leg").unwrap_or_default() {
            offsets.extend(self.as_number("offsets", item, &OFFSET));
        }
        let is_natural = self.choice(&mut section, "curve", &CURVES) == Some(1);
        self.unknown_keys(&section);
        Some(GaitSpec { name: name?.text, period, duty, offsets, is_natural, span: section.span })
    }

    fn leg(&mut self, mut section: Section<'_, '_>) -> Option<LegSpec> {
        let name = self.required_reference(&mut section, "name");
        let coordinate = Quantity::coordinate("coordinate of the hip");
        let [mut x, mut y] = [0.0; 2];
        self.set(&mut section, "x_mm", &coordinate, &mut x);
        self.set(&mut section, "y_mm", &coordinate, &mut y);
        let z = self.required(&mut section, "z_mm", &Quantity::size("height of the hip"));
        let thigh = self.required(&mut section, "thigh_mm", &Quantity::size("length of the thigh"));
        let shank = self.required(&mut section, "shank_mm", &Quantity::size("length of the shank"));
        let foot = self.section(&mut section, "foot").and_then(|foot| self.foot(foot));
        let mut wheel = self.number(&mut section, "wheel_mm", &Quantity::size("diameter of the wheel"));
        if foot.is_some() && wheel.is_some() {
            let span = self.key_span(&section, "wheel_mm");
            self.sink.error(Code::TomlConflict, span, "`foot` and `wheel_mm` exclude each other", "one of the two");
            wheel = None;
        }
        self.unknown_keys(&section);
        let (name, thigh, shank) = (name?, thigh?, shank?);
        Some(LegSpec { name, hip: DVec3::new(x, y, z?), thigh, shank, foot, wheel, span: section.span })
    }

    fn foot(&mut self, mut section: Section<'_, '_>) -> Option<Foot> {
        let heel = self.required(&mut section, "heel_mm", &Quantity::length("length of the heel"));
        let toe = self.required(&mut section, "toe_mm", &Quantity::length("length to the toe"));
        let height = self.required(&mut section, "height_mm", &Quantity::length("height of the ankle"));
        self.unknown_keys(&section);
        Some(Foot { heel: heel?, toe: toe?, height: height? })
    }

    /// Reports legs that a robot cannot stand or walk on.
    fn settle_legs(&mut self, legs: &mut LegsSpec, span: Span) {
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
            let (least, most) = leg.standing_heights();
            let is_good = (least..=most).contains(&spec.hip.z);
            if !is_good {
                let [least, most] = [least.max(0.0), most].map(|metres| unit::mm_from_metres(metres).floor());
                let message = format!("leg `{}` cannot stand with its hip at this height", spec.name.text);
                self.sink.error(Code::LegReach, spec.span, message, format!("`z_mm` from {least} to {most}"));
            }
            is_good
        });
        if legs.legs.len() < count {
            // What the offsets were for is no longer there.
            legs.gaits.iter_mut().for_each(|gait| gait.offsets.clear());
        }
        if legs.legs.is_empty() {
            let message = "the robot is to walk and has no legs: it glides";
            self.sink.error(Code::LegDrive, span, message, "a table `[[leg]]` for each leg");
        }
    }
}
