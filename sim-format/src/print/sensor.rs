//! Links, range sensors and surfaces as forms of a scene.

use super::number::{degrees, mm};
use super::scene::unless;
use crate::scene::form::{AxisForm, EchoForm, LinkForm, MountForm, SideLobesForm, SonarForm, SurfaceForm};
use crate::spec::{Axis, LinkSpec, MountSpec, RangeSpec, Surface};
use sim_core::sensor::{Echo, PAPER_SIGMA, RangeModel, Sonar};

/// The keys of `mount` but for what is as in `usual`.
pub(super) fn mount_form(mount: &MountSpec, usual: &MountSpec) -> MountForm {
    let [x_mm, y_mm, z_mm] = [
        unless(mount.position.x, usual.position.x),
        unless(mount.position.y, usual.position.y),
        unless(mount.position.z, usual.position.z),
    ]
    .map(|place| place.map(mm));
    let [roll_deg, pitch_deg, yaw_deg] =
        [mount.roll, mount.pitch, mount.yaw].map(|angle| unless(angle, 0.0).map(degrees));
    MountForm { on: mount.on.as_ref().map(|on| on.text.clone()), x_mm, y_mm, z_mm, roll_deg, pitch_deg, yaw_deg }
}

/// A surface that is left out where it is the usual one.
pub(super) fn surface_form(surface: Surface) -> Option<SurfaceForm> {
    unless(surface, Surface::default()).map(explicit_surface)
}

/// A surface that is written down in any case.
pub(super) fn explicit_surface(surface: Surface) -> SurfaceForm {
    let usual = Surface::default();
    SurfaceForm {
        reflectivity: unless(surface.reflectivity, usual.reflectivity),
        specular: unless(surface.specular, usual.specular),
    }
}

pub(super) fn axis_form(axis: Axis) -> AxisForm {
    match axis {
        Axis::X => AxisForm::X,
        Axis::Y => AxisForm::Y,
        Axis::Z => AxisForm::Z,
    }
}

pub(super) fn link_form(link: &LinkSpec) -> LinkForm {
    LinkForm {
        name: link.name.clone(),
        mount: mount_form(&link.mount, &MountSpec::default()),
        axis: link.turn.as_ref().and_then(|turn| unless(turn.axis, Axis::Z)).map(axis_form),
        servo: link.turn.as_ref().map(|turn| turn.servo.text.clone()),
    }
}

/// The sensors of one kind with one ray; `echo` tells of which.
pub(super) fn echo_forms(
    ranges: &[RangeSpec],
    usual: Echo,
    echo: impl Fn(&RangeModel) -> Option<&Echo>,
) -> Vec<EchoForm> {
    ranges.iter().filter_map(|range| Some(echo_form(range, echo(&range.model)?, &usual))).collect()
}

fn echo_form(range: &RangeSpec, echo: &Echo, usual: &Echo) -> EchoForm {
    EchoForm {
        name: range.name.clone(),
        id: range.id,
        mount: mount_form(&range.mount, &MountSpec::default()),
        min_mm: unless(echo.min, usual.min).map(mm),
        max_mm: unless(echo.max, usual.max).map(mm),
        incidence_deg: unless(echo.incidence, usual.incidence).map(degrees),
        sigma: unless(range.sigma, PAPER_SIGMA),
        mean: unless(range.mean, 0.0),
    }
}

/// A sonar; `None` for another range sensor.
pub(super) fn sonar_form(range: &RangeSpec) -> Option<SonarForm> {
    let RangeModel::Sonar(sonar) = &range.model else { return None };
    let usual = Sonar::srf08();
    Some(SonarForm {
        name: range.name.clone(),
        id: range.id,
        preset: None,
        mount: mount_form(&range.mount, &MountSpec::default()),
        min_mm: unless(sonar.min, usual.min).map(mm),
        max_mm: unless(sonar.max, usual.max).map(mm),
        half_angle_deg: unless(sonar.half_angle, usual.half_angle).map(degrees),
        side_lobes: sonar.side_lobes.map(|lobes| SideLobesForm {
            angle_deg: degrees(lobes.angle),
            half_width_deg: degrees(lobes.half_width),
            gain: lobes.gain,
        }),
        threshold: unless(sonar.threshold, usual.threshold),
        bus: range.bus.filter(|bus| *bus != 1),
        rays: unless(sonar.rays, usual.rays),
        sigma: unless(range.sigma, PAPER_SIGMA),
        mean: unless(range.mean, 0.0),
    })
}
