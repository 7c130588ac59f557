//! Properties that depend on several lines: missing values, the track, the size of the body, the wheelbase.

use std::f64::consts::FRAC_PI_2;

use super::dialect::Dialect;
use super::{DRIVE_SYNTAX, Reader, WHEEL_SYNTAX};
use crate::Span;
use crate::code::Code;
use crate::spec::{Collider, DriveKind, MAX_LENGTH, RobiSpec, VR_PSD_RANGE};
use sim_core::math;
use sim_core::unit;

/// Default wheelbase of an Ackermann robot as a fraction of its diameter.
const WHEELBASE_PER_DIAMETER: f64 = 0.6;

/// Default wheelbase of a robot type.
pub(crate) fn default_wheelbase(kind: DriveKind, diameter: f64, track: f64) -> f64 {
    match kind {
        DriveKind::Ackermann => WHEELBASE_PER_DIAMETER * diameter,
        _ => track,
    }
}

impl Reader {
    /// Reports missing lines, and lines that EyeSim VR would reject.
    pub(super) fn check_file(&mut self) {
        if self.wheel_line.is_none() && !matches!(self.robi.drive.kind, DriveKind::Legged | DriveKind::Thrusters) {
            let wheel = &self.robi.wheel;
            let message = format!(
                "no `wheel` line: wheels of {} mm, {} ticks a turn, {} mm apart are used",
                unit::mm_from_metres(wheel.diameter),
                wheel.ticks_per_turn,
                unit::mm_from_metres(wheel.track)
            );
            self.sink.warn(Code::RobiWheelMissing, Span::default(), message, WHEEL_SYNTAX);
        }
        if self.drive_line.is_none() {
            let message = "no `drive` line: a differential drive is used";
            self.sink.warn(Code::RobiDriveMissing, Span::default(), message, DRIVE_SYNTAX);
        }
        if self.dialect < Dialect::Vr2017 {
            self.check_psd_numbers();
            return;
        }
        if let (Some(first), Some(drive)) = (self.first_keyword, self.drive_line)
            && first.line < drive.line
        {
            let message = "`drive` is not the first keyword of this file of EyeSim VR, which needs it there";
            self.sink.warn(Code::RobiDriveFirst, drive, message, "the `drive` line before all others");
        }
        self.check_psd_order();
    }

    /// Computes values that depend on several lines.
    pub(super) fn derive_values(&mut self) {
        let body_diameter = self.body_diameter();
        self.convert_track(body_diameter);
        self.robi.diameter = body_diameter.unwrap_or_else(|| self.diameter_around_wheels());
        self.robi.drive.wheelbase = self.wheelbase();
        if self.dialect >= Dialect::Vr2017 {
            self.robi.psds.iter_mut().for_each(|psd| psd.range = VR_PSD_RANGE);
            self.apply_vr_limits();
        }
    }

    /// Sets the maximum speeds of EyeSim VR, which ignores those of the file: 0.4 m/s at the rims of the wheels (0.5
    /// m/s for a car), and 90 degrees/s. EyeSim VR has no omni robots; their wheels keep the maximum rate of the file.
    fn apply_vr_limits(&mut self) {
        let rim_speed = if self.robi.drive.kind == DriveKind::Ackermann { 0.5 } else { 0.4 };
        (self.robi.max_speed, self.robi.max_turn) = (rim_speed, FRAC_PI_2);
        if self.robi.drive.kind != DriveKind::Omni {
            // Rounded to a millionth of a degree, so that the printed value is exact.
            let rate_deg = unit::degrees_from_radians(2.0 * rim_speed / self.robi.wheel.diameter);
            self.robi.wheel.max_rate = unit::radians_from_degrees((1e6 * rate_deg).round() / 1e6);
        }
    }

    /// Diameter of the body, if the file determines it: `diameter`, otherwise that of the smallest disc around the
    /// robot's centre that contains all colliders. In a classic file without `diameter` and colliders, it is the
    /// default.
    fn body_diameter(&self) -> Option<f64> {
        if self.has_diameter {
            return Some(self.robi.diameter);
        }
        let reach = self.robi.colliders.iter().map(Collider::reach).reduce(f64::max);
        let around_colliders = reach.map(|reach| (2.0 * reach).min(MAX_LENGTH));
        around_colliders.or((self.dialect < Dialect::Vr2017).then_some(self.robi.diameter))
    }

    /// Converts the last number of `wheel`, which in files of EyeSim VR is half the distance between the wheels.
    ///
    /// Exceptions: for an omni drive, which EyeSim VR does not load, files state the full distance, as classic files
    /// do. If the wheels would be outside the body, the number is taken as the full distance, with a warning.
    fn convert_track(&mut self, body_diameter: Option<f64>) {
        let (track, is_omni) = (self.robi.wheel.track, self.robi.drive.kind == DriveKind::Omni);
        if self.dialect < Dialect::Vr2017 || is_omni || !self.is_wheel_read {
            return;
        }
        if let (Some(body_diameter), Some(span)) = (body_diameter, self.wheel_line)
            && 2.0 * track > body_diameter
            && track <= body_diameter
        {
            let [track_mm, body_mm] = [track, body_diameter].map(unit::mm_from_metres);
            let message = format!(
                "wheels at {track_mm} mm to either side, as EyeSim VR reads this, would stand outside the body of \
                 {body_mm:.0} mm; {track_mm} mm are used as their distance"
            );
            self.sink.warn(Code::RobiTrackWide, span, message, "half the distance of the wheels");
        } else {
            self.robi.wheel.track = (2.0 * track).min(MAX_LENGTH);
        }
    }

    /// Diameter of the smallest disc around the robot's centre that contains the driven and steered wheels, without
    /// their width.
    fn diameter_around_wheels(&mut self) -> f64 {
        let RobiSpec { wheel, drive, axis_offset, .. } = &self.robi;
        let axis = *axis_offset;
        let axles = match (drive.kind, self.axles.map(|axle| axle.map(|(offset, _)| offset))) {
            (DriveKind::Omni, _) => [axis - 0.5 * wheel.track, axis + 0.5 * wheel.track],
            (DriveKind::Ackermann, [driven, steered]) => [driven.unwrap_or(axis), steered.unwrap_or(axis)],
            (DriveKind::Differential | DriveKind::Legged | DriveKind::Thrusters, _) => [axis; 2],
        };
        let radii = axles.map(|x| math::hypot(x.abs() + 0.5 * wheel.diameter, 0.5 * wheel.track));
        let diameter = (2.0 * radii[0].max(radii[1])).min(MAX_LENGTH);
        let diameter_mm = unit::mm_from_metres(diameter);
        let message =
            format!("neither `diameter` nor `collider`: a body of {diameter_mm:.0} mm around the wheels is used");
        self.sink.warn(Code::RobiBodyMissing, Span::default(), message, "`diameter D` in mm, or `collider` lines");
        diameter
    }

    /// Distance between the axles, or the default; moves the axis of a car to the driven axle.
    fn wheelbase(&mut self) -> f64 {
        let robi = &mut self.robi;
        let default = default_wheelbase(robi.drive.kind, robi.diameter, robi.wheel.track);
        if robi.drive.kind != DriveKind::Ackermann {
            return default;
        }
        if let [Some((driven, _)), _] = self.axles {
            robi.axis_offset = driven;
        }
        match self.axles {
            [Some((driven, _)), Some((steered, _))] if steered - driven > 1e-6 => (steered - driven).min(MAX_LENGTH),
            [Some(_), Some((_, span))] => {
                let mm = unit::mm_from_metres(default);
                let message =
                    format!("the steered axle is not ahead of the driven axle; a wheelbase of {mm:.0} mm is used");
                let expected = "`axel turn` with a larger FORWARD than `axel drive`";
                self.sink.warn(Code::RobiAxelOrder, span, message, expected);
                default
            }
            _ => default,
        }
    }
}
