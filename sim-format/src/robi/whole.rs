//! Properties that depend on the whole file: defaults, the meaning of the wheels' numbers, the size of the body.

use std::f64::consts::FRAC_PI_2;

use super::dialect::Dialect;
use super::{DRIVE_FORM, Reader, WHEEL_FORM};
use crate::Span;
use crate::code::Code;
use crate::spec::{Collider, DriveKind, MAX_LENGTH, RobiSpec, VR_PSD_RANGE};
use sim_core::math;
use sim_core::unit;

/// Default wheelbase of an Ackermann robot as a fraction of its diameter.
const WHEELBASE_OF_DIAMETER: f64 = 0.6;

/// Default wheelbase of a robot type.
pub(crate) fn usual_wheelbase(kind: DriveKind, diameter: f64, track: f64) -> f64 {
    match kind {
        DriveKind::Ackermann => WHEELBASE_OF_DIAMETER * diameter,
        _ => track,
    }
}

impl Reader {
    /// Reports missing lines, and lines that EyeSim VR would reject.
    pub(super) fn check_whole(&mut self) {
        if self.wheel.is_none() && !matches!(self.robi.drive.kind, DriveKind::Legged | DriveKind::Thrusters) {
            let wheel = &self.robi.wheel;
            let message = format!(
                "no `wheel` line: wheels of {} mm, {} ticks a turn, {} mm apart are taken",
                unit::mm_from_metres(wheel.diameter),
                wheel.ticks_per_turn,
                unit::mm_from_metres(wheel.track)
            );
            self.sink.warn(Code::RobiWheelMissing, Span::default(), message, WHEEL_FORM);
        }
        if self.drive.is_none() {
            let message = "no `drive` line: a differential drive is taken";
            self.sink.warn(Code::RobiDriveMissing, Span::default(), message, DRIVE_FORM);
        }
        if self.dialect < Dialect::Vr {
            return;
        }
        if let (Some(first), Some(drive)) = (self.first, self.drive)
            && first.line < drive.line
        {
            let message = "`drive` is not the first keyword of this file of EyeSim VR, which needs it there";
            self.sink.warn(Code::RobiDriveFirst, drive, message, "the `drive` line before all others");
        }
        self.check_psd_order();
    }

    /// Computes values that depend on several lines.
    pub(super) fn settle(&mut self) {
        let body = self.body();
        self.settle_track(body);
        self.robi.diameter = body.unwrap_or_else(|| self.body_around_the_wheels());
        self.robi.drive.wheelbase = self.wheelbase();
        if self.dialect >= Dialect::Vr {
            self.robi.psds.iter_mut().for_each(|psd| psd.range = VR_PSD_RANGE);
            self.settle_limits();
        }
    }

    /// Limits the speeds as EyeSim VR does, regardless of the file: 0.4 m/s at the rims of all wheels (0.5 m/s for a
    /// car), and 90 degrees/s. EyeSim VR has no omni robots; their wheels keep the rate of the file.
    fn settle_limits(&mut self) {
        let rim = if self.robi.drive.kind == DriveKind::Ackermann { 0.5 } else { 0.4 };
        (self.robi.max_speed, self.robi.max_turn) = (rim, FRAC_PI_2);
        if self.robi.drive.kind != DriveKind::Omni {
            // Rounded to a millionth of a degree, so that the printed value is exact.
            let rate_deg = unit::degrees_from_radians(2.0 * rim / self.robi.wheel.diameter);
            self.robi.wheel.max_rate = unit::radians_from_degrees((1e6 * rate_deg).round() / 1e6);
        }
    }

    /// Diameter of the body, if the file determines it: `diameter`, otherwise the smallest disc around the robot's centre that contains all
    /// colliders; in a classic file without either, the default.
    fn body(&self) -> Option<f64> {
        if self.has_diameter {
            return Some(self.robi.diameter);
        }
        let reach = self.robi.colliders.iter().map(Collider::reach).reduce(f64::max);
        let around_colliders = reach.map(|reach| (2.0 * reach).min(MAX_LENGTH));
        around_colliders.or((self.dialect < Dialect::Vr).then_some(self.robi.diameter))
    }

    /// Converts the last number of `wheel`, which in files of EyeSim VR is half the distance between the wheels.
    ///
    /// Exception: omni drives. EyeSim VR does not load them, and files with such a drive have the same line as classic
    /// files. If the wheels would be outside the body, the number is taken as the full distance, with a warning.
    fn settle_track(&mut self, body: Option<f64>) {
        let (track, is_omni) = (self.robi.wheel.track, self.robi.drive.kind == DriveKind::Omni);
        if self.dialect < Dialect::Vr || is_omni || !self.is_wheel_read {
            return;
        }
        if let (Some(body), Some(span)) = (body, self.wheel)
            && 2.0 * track > body
            && track <= body
        {
            let [whole, body] = [track, body].map(unit::mm_from_metres);
            let message = format!(
                "wheels at {whole} mm to either side, as EyeSim VR reads this, would stand outside the body of \
                 {body:.0} mm; {whole} mm are taken as their distance"
            );
            self.sink.warn(Code::RobiTrackWide, span, message, "half the distance of the wheels");
        } else {
            self.robi.wheel.track = (2.0 * track).min(MAX_LENGTH);
        }
    }

    /// Diameter of the smallest disc around the robot's centre that contains the driven and steered wheels, without
    /// their width.
    fn body_around_the_wheels(&mut self) -> f64 {
        let RobiSpec { wheel, drive, axis_offset, .. } = &self.robi;
        let middle = *axis_offset;
        let axles = match (drive.kind, self.axles.map(|axle| axle.map(|(offset, _)| offset))) {
            (DriveKind::Omni, _) => [middle - 0.5 * wheel.track, middle + 0.5 * wheel.track],
            (DriveKind::Ackermann, [driven, steered]) => [driven.unwrap_or(middle), steered.unwrap_or(middle)],
            (DriveKind::Differential | DriveKind::Legged | DriveKind::Thrusters, _) => [middle; 2],
        };
        let reach = axles.map(|x| math::hypot(x.abs() + 0.5 * wheel.diameter, 0.5 * wheel.track));
        let diameter = (2.0 * reach[0].max(reach[1])).min(MAX_LENGTH);
        let mm = unit::mm_from_metres(diameter);
        let message = format!("neither `diameter` nor `collider`: a body of {mm:.0} mm around the wheels is taken");
        self.sink.warn(Code::RobiBodyMissing, Span::default(), message, "`diameter D` in mm, or `collider` lines");
        diameter
    }

    fn wheelbase(&mut self) -> f64 {
        let robi = &mut self.robi;
        let suggested = usual_wheelbase(robi.drive.kind, robi.diameter, robi.wheel.track);
        if robi.drive.kind != DriveKind::Ackermann {
            return suggested;
        }
        if let [Some((driven, _)), _] = self.axles {
            robi.axis_offset = driven;
        }
        match self.axles {
            [Some((driven, _)), Some((steered, _))] if steered - driven > 1e-6 => (steered - driven).min(MAX_LENGTH),
            [Some(_), Some((_, span))] => {
                let mm = unit::mm_from_metres(suggested);
                let message =
                    format!("the steered axle is not ahead of the driven axle; a wheelbase of {mm:.0} mm is used");
                let expected = "`axel turn` with a larger FORWARD than `axel drive`";
                self.sink.warn(Code::RobiAxelOrder, span, message, expected);
                suggested
            }
            _ => suggested,
        }
    }
}
