//! Legs as forms of a scene.

use super::number::{mm, shortest};
use super::scene::unless;
use crate::scene::form::{CurveForm, FootForm, GaitForm, LegForm, LegsForm};
use crate::spec::{
    DEFAULT_DUTY, DEFAULT_LIMB_RADIUS, DEFAULT_PERIOD, DEFAULT_STEP_HEIGHT, GaitSpec, LegSpec, LegsSpec,
};

pub(super) fn legs_form(legs: &LegsSpec) -> LegsForm {
    LegsForm {
        step_height_mm: unless(legs.step_height, DEFAULT_STEP_HEIGHT).map(mm),
        radius_mm: unless(legs.radius, DEFAULT_LIMB_RADIUS).map(mm),
        gait: legs.gaits.iter().map(gait_form).collect(),
    }
}

fn gait_form(gait: &GaitSpec) -> GaitForm {
    GaitForm {
        name: gait.name.clone(),
        period_ms: unless(gait.period, DEFAULT_PERIOD).map(|period| shortest(period * 1e3, |ms| ms / 1e3 == period)),
        duty: unless(gait.duty, DEFAULT_DUTY),
        offsets: gait.offsets.clone(),
        curve: gait.is_natural.then_some(CurveForm::Natural),
    }
}

pub(super) fn leg_form(leg: &LegSpec) -> LegForm {
    LegForm {
        name: leg.name.text.clone(),
        x_mm: unless(mm(leg.hip.x), 0.0),
        y_mm: unless(mm(leg.hip.y), 0.0),
        z_mm: mm(leg.hip.z),
        thigh_mm: mm(leg.thigh),
        shank_mm: mm(leg.shank),
        foot: leg.foot.map(|foot| FootForm {
            heel_mm: mm(foot.heel),
            toe_mm: mm(foot.toe),
            height_mm: mm(foot.height),
        }),
        wheel_mm: leg.wheel.map(mm),
    }
}
