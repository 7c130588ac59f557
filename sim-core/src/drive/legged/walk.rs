//! The sequence of footholds of a walk.
//!
//! All decisions about the feet are made at the instants of a clock of the gait, 48 per period, from the robot's pose
//! and twist just before the instant. So the decisions depend neither on slots nor on the times of queries. Decisions
//! before the present slot are final; later decisions are made again whenever the plan of the motion changes.

use std::collections::VecDeque;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::{
    FootState, Footfall, LegCommand, LegCommandError, Legs, Stance,
    curve::{HEEL_OFF, NaturalGait, TOE_OFF, natural_pitch},
    gait::{Clock, GRID, Gait},
    leg::{Foot, Leg, MIN_HIP_HEIGHT, Sole},
    smooth::{SmoothValue, elapsed_fraction, smooth},
};
use crate::{
    drive::{HISTORY, Piece},
    math,
    pose::{Heading, Pose, Twist},
    scene::Ground,
    sort::sort_few,
    time::Time,
};

/// Tolerance (m, and rad) within which a foot of a standing robot is regarded as in its neutral position and is not
/// lifted. Our choice.
const NEUTRAL_TOLERANCE: f64 = 5e-3;
/// Minimum change (m, and rad) of the goal of a foot in the air; smaller changes are ignored. Our choice.
const MIN_GOAL_CHANGE: f64 = 1e-3;
/// Fraction of the swing duration before touch-down in which a foot keeps its goal. Our choice.
const FIXED_GOAL_FRACTION: f64 = 0.25;
/// Angle between body and standing foot beyond which the foot is lifted before its scheduled lift-off, rad: 60 degrees.
/// Our choice.
const MAX_FOOT_YAW: f64 = std::f64::consts::FRAC_PI_3;
/// Maximum change of the goal of a foot in the air, as a multiple of the excursion times the remaining fraction of the
/// swing. Our choice.
const MAX_GOAL_SHIFT: f64 = 1.6;
/// Maximum scale of the natural joint angles. Our choice.
const MAX_SCALE: f64 = 1.2;
/// Minimum change of the scale of the body's bob; smaller changes are ignored. Our choice.
const MIN_SCALE_CHANGE: f64 = 0.02;
/// Maximum number of times that the goal of a foot is moved towards the body.
const TRIED_POSITIONS: i32 = 16;
/// Number of intervals between two footholds; the height of the ground is sampled at the ends of each interval.
const GROUND_INTERVALS: i32 = 8;
/// Maximum step up or down, as a fraction of the hip's height. Our choice.
const MAX_STEP: f64 = 0.4;
/// Maximum number of steps kept per leg until its footfalls are taken.
const MAX_KEPT_STEPS: usize = 64;

/// One piece of the body's motion, valid from its start until the start of the next piece.
#[derive(Clone, Copy, Debug)]
pub(in crate::drive) struct MotionPiece {
    pub piece: Piece,
    /// Position of the axle in front of the robot's centre, m.
    pub axis_offset: f64,
    /// True if the piece begins with a placement of the robot.
    pub is_placed: bool,
}

/// The planned motion of the body, which the legs follow.
pub(in crate::drive) trait Plan {
    /// Number of changes of the plan so far.
    fn revision(&self) -> u64;

    /// The pieces of motion that are valid from `from` to `to`, both included.
    fn pieces(&mut self, from: Time, to: Time) -> Vec<MotionPiece>;
}

impl MotionPiece {
    fn start(&self) -> Time {
        self.piece.start
    }

    fn pose(&self, at: Time) -> Pose {
        let axle = self.piece.world_from_axle(at);
        Pose { position: axle.transform_point(DVec2::new(-self.axis_offset, 0.0)), ..axle }
    }

    /// Twist of the centre.
    fn twist(&self, at: Time) -> Twist {
        self.piece.rates(at).truth.at_offset(DVec2::new(-self.axis_offset, 0.0))
    }
}

/// Commanded settings of the legs.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::drive) struct LegSettings {
    pub gait: usize,
    pub step_height: f64,
    /// For each leg, the shift of its footholds in the robot's frame, m, and the additional lift of the foot, m.
    pub corrections: Vec<(DVec2, f64)>,
}

/// The feet of one robot as a function of virtual time.
#[derive(Clone, Debug)]
pub(in crate::drive) struct Walk {
    legs: Arc<Legs>,
    ground: Arc<Ground>,
    /// For each leg, its natural gait; `None` for a leg without a foot.
    natural: Vec<Option<NaturalGait>>,
    /// Settings with their start times, in ascending order; the first also applies before its start.
    settings: VecDeque<(Time, LegSettings)>,
    /// Number of commands that changed the settings.
    revision: u64,
    /// Final decisions, for instants before the present slot.
    final_steps: Steps,
    /// Final and tentative decisions, valid for these revisions of the motion and of the settings.
    tentative: Option<((u64, u64), Steps)>,
    /// Time up to which footfalls have been taken.
    reported_until: Time,
}

/// Position and heading of a standing foot. The position is the point under the ankle of a flat foot, or the tip of the
/// leg.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Foothold {
    point: DVec3,
    heading: f64,
}

/// One step of a foot: lift-off, swing, and stance until the next step.
#[derive(Clone, Debug)]
struct Step {
    /// Start of the roll-off over the toe; equal to `lift_off` if there is no roll-off.
    heel_off: Time,
    /// Planned duration of the roll-off; the actual one may be shorter.
    roll_duration: Time,
    lift_off: Time,
    touch_down: Time,
    /// Planned duration of the stance phase after touch-down.
    stance_duration: Time,
    /// Foothold before the step.
    start: Foothold,
    /// Pitch of the foot at `heel_off`, rad.
    start_pitch: f64,
    /// Scale of the natural pitch of the foot.
    scale: f64,
    /// Goals of the foot and apex heights (m), each with the instant from which it is valid; the first is valid from
    /// lift-off on.
    goals: Vec<(Time, Foothold, f64)>,
    /// True if the foot is at its foothold because of a placement of the robot, not because of a step.
    is_placed: bool,
}

/// Steps of all feet from some instant in the past up to `until`.
#[derive(Clone, Debug)]
struct Steps {
    until: Time,
    /// Clocks, each with the scale of the body's bob in the gait of the clock; the last clock is current.
    clocks: Vec<(Clock, SmoothValue)>,
    is_walking: bool,
    feet: Vec<VecDeque<Step>>,
}

/// Inputs of the decisions except the motion.
struct DecisionInputs<'a> {
    legs: &'a Legs,
    ground: &'a Ground,
    natural: &'a [Option<NaturalGait>],
    settings: &'a VecDeque<(Time, LegSettings)>,
}

/// Pose and twist of the robot just before a decision instant.
struct BodyState {
    at: Time,
    pose: Pose,
    twist: Twist,
}

impl Walk {
    pub fn new(legs: Arc<Legs>, ground: Arc<Ground>) -> Self {
        let settings = LegSettings {
            gait: 0,
            step_height: legs.step_height,
            corrections: vec![(DVec2::ZERO, 0.0); legs.legs.len()],
        };
        let natural = legs.legs.iter().map(NaturalGait::new).collect();
        let never = Time(i64::MIN);
        let final_steps =
            Steps { until: never, clocks: Vec::new(), is_walking: false, feet: vec![VecDeque::new(); legs.legs.len()] };
        Self {
            legs,
            ground,
            natural,
            settings: VecDeque::from([(never, settings)]),
            revision: 0,
            final_steps,
            tentative: None,
            reported_until: never,
        }
    }

    pub fn legs(&self) -> &Legs {
        &self.legs
    }

    pub fn ground(&self) -> &Ground {
        &self.ground
    }

    pub fn settings_at(&self, at: Time) -> &LegSettings {
        settings_at(&self.settings, at)
    }

    pub fn command(&mut self, at: Time, command: LegCommand) -> Result<(), LegCommandError> {
        let (since, last) = self.settings.back().expect("a walk has settings");
        let mut settings = last.clone();
        match command {
            LegCommand::Gait(gait) => {
                let gaits = self.legs.gaits.len();
                settings.gait = if gait < gaits { gait } else { return Err(LegCommandError::NoGait { gaits }) };
            }
            LegCommand::StepHeight(height) => {
                let max_reach = self.legs.legs.iter().map(Leg::reach).fold(0.0, f64::max);
                settings.step_height =
                    if (0.0..=max_reach).contains(&height) { height } else { return Err(LegCommandError::Length) };
            }
            LegCommand::ShiftFoothold { leg, shift, lift } => {
                let legs = self.legs.legs.len();
                let reach = self.legs.legs.get(leg).ok_or(LegCommandError::NoLeg { legs })?.reach();
                if !(shift.length() <= reach && (0.0..=reach).contains(&lift)) {
                    return Err(LegCommandError::Length);
                }
                settings.corrections[leg] = (shift, lift);
            }
        }
        if settings != *last {
            let at = at.max(*since);
            if at == *since {
                self.settings.pop_back();
            }
            self.settings.push_back((at, settings));
            self.revision += 1;
        }
        Ok(())
    }

    pub fn stance(&mut self, plan: &mut impl Plan, at: Time, world_from_robot: &Pose) -> Stance {
        self.extend(plan, at);
        let steps = if at <= self.final_steps.until { &self.final_steps } else { self.tentative_steps() };
        steps.stance(&self.legs, &self.natural, &self.ground, at, world_from_robot)
    }

    pub fn take_footfalls(&mut self, plan: &mut impl Plan, until: Time) -> Vec<Footfall> {
        let last = until - Time(1);
        self.extend(plan, last);
        let steps = if last <= self.final_steps.until { &self.final_steps } else { self.tentative_steps() };
        let footfalls = steps.footfalls(self.reported_until, until);
        self.reported_until = self.reported_until.max(until);
        footfalls
    }

    /// Returns true if the body moves or a foot is not yet in its neutral position on the ground.
    pub fn is_walking(&self) -> bool {
        self.tentative_steps().is_walking
    }

    /// Makes the decisions before `end`, the end of the present slot, final.
    pub fn commit(&mut self, plan: &mut impl Plan, end: Time) {
        let last = end - Time(1);
        if last <= self.final_steps.until {
            return;
        }
        self.decide(plan, last, true);
        let past = self.reported_until.min(end - HISTORY);
        self.final_steps.forget(past);
        while self.settings.len() > 1 && self.settings[1].0 <= past {
            self.settings.pop_front();
        }
        self.tentative = None;
    }

    fn tentative_steps(&self) -> &Steps {
        self.tentative.as_ref().map_or(&self.final_steps, |(_, steps)| steps)
    }

    fn extend(&mut self, plan: &mut impl Plan, at: Time) {
        if at > self.final_steps.until {
            self.decide(plan, at, false);
        }
    }

    /// Makes all decisions up to `at`: final ones, or tentative ones for the present plan.
    fn decide(&mut self, plan: &mut impl Plan, at: Time, is_final: bool) {
        let key = (plan.revision(), self.revision);
        let mut steps = match self.tentative.take() {
            Some((known, steps)) if known == key && !(is_final && steps.until > at) => steps,
            _ => self.final_steps.clone(),
        };
        if steps.until < at {
            let pieces = plan.pieces(steps.until, at);
            let Self { legs, ground, natural, settings, .. } = self;
            let inputs = DecisionInputs { legs, ground, natural, settings };
            steps.extend(&inputs, &pieces, at);
        }
        if is_final {
            self.final_steps = steps;
        } else {
            self.tentative = Some((key, steps));
        }
    }
}

/// The settings in force at `at`.
fn settings_at(settings: &VecDeque<(Time, LegSettings)>, at: Time) -> &LegSettings {
    let current = settings.iter().rev().find(|(since, _)| *since <= at).or(settings.front());
    current.map(|(_, settings)| settings).expect("a walk has settings")
}

impl Steps {
    /// Makes all decisions after `until` up to `to`. `pieces` are the pieces of the motion that are valid from `until`
    /// to `to`.
    fn extend(&mut self, inputs: &DecisionInputs, pieces: &[MotionPiece], to: Time) {
        loop {
            let opening = pieces.iter().find(|piece| piece.start() > self.until).filter(|piece| piece.start() <= to);
            let change =
                inputs.settings.iter().find(|(since, _)| *since > self.until).filter(|(since, _)| *since <= to);
            let tick = self.clock().map(|clock| clock.next_after(self.until)).map(|index| (index, self.instant(index)));
            let tick = tick.filter(|(_, instant)| *instant <= to);
            let first =
                [opening.map(MotionPiece::start), change.map(|(since, _)| *since), tick.map(|(_, instant)| instant)];
            let Some(at) = first.into_iter().flatten().min() else { break };
            if let Some((index, _)) = tick.filter(|(_, instant)| *instant == at) {
                self.tick(inputs, &state_before(pieces, at), index);
            }
            if change.is_some_and(|(since, _)| *since == at) {
                self.change_gait(inputs, at);
            }
            if let Some(piece) = opening.filter(|piece| piece.start() == at) {
                self.open(inputs, piece);
            }
            self.until = at;
        }
        self.until = to;
    }

    /// The current clock; `None` if the robot does not walk.
    fn clock(&self) -> Option<&Clock> {
        self.clocks.last().map(|(clock, _)| clock).filter(|_| self.is_walking)
    }

    fn instant(&self, index: i64) -> Time {
        self.clock().map_or(Time::NEVER, |clock| clock.instant(index))
    }

    /// Handles the start of a piece of motion.
    fn open(&mut self, inputs: &DecisionInputs, piece: &MotionPiece) {
        let at = piece.start();
        if piece.is_placed || self.feet.iter().all(VecDeque::is_empty) {
            self.place(inputs, at, &piece.pose(at));
        }
        if !self.is_walking && !piece.twist(at).is_zero() {
            let index = settings_at(inputs.settings, at).gait;
            self.clocks.push((Clock::starting(at, &inputs.legs.gaits[index], index), SmoothValue::default()));
            self.is_walking = true;
        }
    }

    /// Places all feet at their neutral positions; the body no longer bobs.
    fn place(&mut self, inputs: &DecisionInputs, at: Time, pose: &Pose) {
        for (leg, steps) in inputs.legs.legs.iter().zip(&mut self.feet) {
            let hip = pose.transform_point(leg.hip.truncate());
            let start = Foothold { point: hip.extend(inputs.ground.height(hip)), heading: pose.heading.remainder() };
            let goals = vec![(at, start, 0.0)];
            let (roll_duration, stance_duration) = (Time::ZERO, Time::ZERO);
            let (heel_off, lift_off, touch_down) = (at, at, at);
            let (start_pitch, scale, is_placed) = (0.0, 0.0, true);
            steps.push_back(Step {
                heel_off,
                roll_duration,
                lift_off,
                touch_down,
                stance_duration,
                start,
                start_pitch,
                scale,
                goals,
                is_placed,
            });
        }
        self.clocks.iter_mut().for_each(|(_, scale)| scale.end(at));
        self.is_walking = false;
    }

    fn change_gait(&mut self, inputs: &DecisionInputs, at: Time) {
        let index = settings_at(inputs.settings, at).gait;
        let Some(clock) = self.clock().copied().filter(|clock| clock.gait != index) else { return };
        let gait = &inputs.legs.gaits[index];
        let (_, scale) = self.clocks.last_mut().expect("the robot walks");
        let goal = scale.goal();
        scale.move_to(at, Time(gait.period.0 / 2), 0.0);
        let mut scale = SmoothValue::default();
        scale.move_to(at, Time(gait.period.0 / 2), goal);
        self.clocks.push((clock.with_gait(at, gait, index), scale));
    }

    /// Handles a decision instant.
    fn tick(&mut self, inputs: &DecisionInputs, body: &BodyState, index: i64) {
        let Some(clock) = self.clock().copied() else { return };
        let is_moving = !body.twist.is_zero();
        let mut is_settled = !is_moving;
        for leg_index in 0..inputs.legs.legs.len() {
            if inputs.legs.legs[leg_index].wheel.is_none() {
                is_settled &= self.tick_foot(inputs, body, &clock, index, leg_index);
            }
        }
        self.adapt_bob(inputs, body);
        if is_settled && self.clocks.iter().all(|(_, scale)| scale.goal() == 0.0 && scale.is_constant_from(body.at)) {
            self.is_walking = false;
        }
    }

    /// Handles a decision instant for one foot; returns true if the foot is on the ground in its neutral position.
    fn tick_foot(
        &mut self,
        inputs: &DecisionInputs,
        body: &BodyState,
        clock: &Clock,
        index: i64,
        leg_index: usize,
    ) -> bool {
        let at = body.at;
        let leg = &inputs.legs.legs[leg_index];
        let gait = &inputs.legs.gaits[clock.gait];
        let is_moving = !body.twist.is_zero();
        let soon = (clock.instant(index + 2) - at).seconds();
        let last = self.feet[leg_index].back().expect("a foot has a step");
        if at <= last.lift_off && last.heel_off < at {
            // The foot rolls off and its goal may still change. The roll-off ends early if the foot would otherwise get
            // out of reach.
            let is_shortened = at < last.lift_off && self.is_out_of_reach_soon(inputs, leg_index, body, soon);
            let touch_down = if is_shortened { at + (last.touch_down - last.lift_off) } else { last.touch_down };
            let goal = self.goal(inputs, body, leg_index, clock, touch_down);
            let apex = apex_height(inputs, at, leg_index, &last.start, &goal);
            let step = self.feet[leg_index].back_mut().expect("the foot rolls off");
            if is_shortened {
                (step.lift_off, step.touch_down) = (at, touch_down);
            }
            step.goals = vec![(step.lift_off, goal, apex)];
            return false;
        }
        if at < last.touch_down {
            let remaining = (last.touch_down - at).seconds();
            let swing_duration = (last.touch_down - last.lift_off).seconds();
            if remaining > FIXED_GOAL_FRACTION * swing_duration {
                let goal = self.goal(inputs, body, leg_index, clock, last.touch_down);
                let max_shift = MAX_GOAL_SHIFT * inputs.legs.excursion() * remaining / swing_duration;
                let goal = last.limited_goal(goal, max_shift, inputs.ground);
                let apex = apex_height(inputs, at, leg_index, &last.start, &goal);
                self.feet[leg_index].back_mut().expect("the foot is in the air").change_goal(at, goal, apex);
            }
            return false;
        }
        let start = last.standing();
        let is_displaced = is_away(&start, leg, &body.pose, NEUTRAL_TOLERANCE);
        let instants_to_lift_off = (gait.lift_off_index(leg_index) - index).rem_euclid(GRID);
        let scale = self.scale(inputs, body, gait, leg_index);
        let start_pitch = last.pitch(at, leg);
        let step = |heel_off, lift_off: Time, period| {
            let touch_down = lift_off + gait.swing_duration(period);
            let roll_duration = lift_off - heel_off;
            let stance_duration = Time((gait.duty * gait.period.0 as f64) as i64);
            let goals = vec![(lift_off, start, start.point.z)];
            Step {
                heel_off,
                roll_duration,
                lift_off,
                touch_down,
                stance_duration,
                start,
                start_pitch,
                scale,
                goals,
                is_placed: false,
            }
        };
        let is_lifted = if instants_to_lift_off == 0 {
            is_moving || is_displaced
        } else {
            is_moving && self.is_out_of_reach_soon(inputs, leg_index, body, soon)
        };
        if is_lifted {
            let mut step = step(at, at, clock.period_at(index));
            let goal = self.goal(inputs, body, leg_index, clock, step.touch_down);
            step.goals = vec![(at, goal, apex_height(inputs, at, leg_index, &start, &goal))];
            self.feet[leg_index].push_back(step);
        } else if scale > 0.0 && instants_to_lift_off == gait.roll_off_instants() && start_pitch == 0.0 {
            let lift_off = index + instants_to_lift_off;
            let step = step(at, clock.instant(lift_off), clock.period_at(lift_off));
            self.feet[leg_index].push_back(step);
            return false;
        }
        !is_lifted && !is_displaced
    }

    /// Scale of the natural joint angles for a leg: the forward speed of its hip divided by the natural speed of the
    /// gait.
    fn scale(&self, inputs: &DecisionInputs, body: &BodyState, gait: &Gait, leg_index: usize) -> f64 {
        let Some(natural) = inputs.natural[leg_index].as_ref().filter(|_| gait.is_natural) else { return 0.0 };
        let Twist { vx, omega, .. } = body.twist;
        let speed = vx - omega * inputs.legs.legs[leg_index].hip.y;
        (speed * gait.period.seconds() / natural.stride).clamp(0.0, MAX_SCALE)
    }

    /// Adapts the scale of the body's bob, its rise and fall during a stride, to the speed.
    fn adapt_bob(&mut self, inputs: &DecisionInputs, body: &BodyState) {
        let Some((clock, scale)) = self.clocks.last() else { return };
        let gait = &inputs.legs.gaits[clock.gait];
        let count = inputs.legs.legs.len();
        let goal = (0..count).map(|leg| self.scale(inputs, body, gait, leg)).sum::<f64>() / count as f64;
        let span = Time(gait.period.0 / 2);
        if (goal - scale.goal()).abs() > MIN_SCALE_CHANGE || goal == 0.0 && scale.goal() != 0.0 {
            self.clocks.last_mut().expect("the robot walks").1.move_to(body.at, span, goal);
        }
    }

    /// Returns true if a standing foot reaches the limit of its leg's reach or of its yaw within `soon` seconds.
    fn is_out_of_reach_soon(&self, inputs: &DecisionInputs, leg_index: usize, body: &BodyState, soon: f64) -> bool {
        let leg = &inputs.legs.legs[leg_index];
        let foot = step_at(&self.feet[leg_index], body.at).foot(body.at, leg, None);
        let min_height = self.foothold_height(body.at, inputs.legs) + MIN_HIP_HEIGHT * leg.hip.z;
        let hip_limit_and_yaw = |pose: &Pose| {
            let (to_point, yaw) = hip_to_point(leg, &foot, pose, 0.0);
            let (sin, cos) = math::sin_cos(-yaw);
            let offset = DVec2::new(cos, sin).rotate(to_point.truncate());
            (foot.point.z + leg.max_hip_height(offset, foot.sole).unwrap_or(f64::NEG_INFINITY), yaw.abs())
        };
        let (now, yaw_now) = hip_limit_and_yaw(&body.pose);
        let (later, yaw_later) = hip_limit_and_yaw(&body.pose.moved(body.twist.scaled(soon)));
        later < min_height && later <= now || yaw_later > MAX_FOOT_YAW && yaw_later > yaw_now
    }

    /// Goal of a foot: its neutral position at the middle of its next stance phase, extrapolated with the present
    /// twist.
    fn goal(
        &self,
        inputs: &DecisionInputs,
        body: &BodyState,
        leg_index: usize,
        clock: &Clock,
        touch_down: Time,
    ) -> Foothold {
        let leg = &inputs.legs.legs[leg_index];
        let (shift, _) = settings_at(inputs.settings, body.at).corrections[leg_index];
        let gait = &inputs.legs.gaits[clock.gait];
        let lift_off_index = gait.lift_off_index(leg_index);
        // In a natural gait, the foothold is not under the hip at the middle of the stance phase.
        let offset = inputs.natural[leg_index].as_ref().map_or(0.0, |natural| natural.foothold_offset);
        let shift = shift + DVec2::new(offset * self.scale(inputs, body, gait, leg_index), 0.0);
        let until_touch_down = (touch_down - body.at).seconds();
        let stance_duration = (clock.next_lift_off(touch_down, lift_off_index) - touch_down).seconds();
        let pose_after = |seconds| body.pose.moved(body.twist.scaled(seconds));
        let (at_touch_down, at_middle) =
            (pose_after(until_touch_down), pose_after(until_touch_down + 0.5 * stance_duration));
        let hip = leg.hip.truncate();
        let neutral = at_touch_down.transform_point(hip);
        let excursion = at_middle.transform_point(hip + shift) - neutral;
        let excursion = excursion.clamp_length_max(inputs.legs.excursion());
        let foothold_height = self.foothold_height(body.at, inputs.legs);
        let max_step = MAX_STEP * leg.hip.z;
        let heading = at_middle.heading.remainder();
        // Moves the goal towards the body until the step is neither too high nor too deep.
        for index in 0..=TRIED_POSITIONS {
            let position = neutral + excursion * (1.0 - f64::from(index) / f64::from(TRIED_POSITIONS));
            let height = inputs.ground.height(position);
            if (height - foothold_height).abs() <= max_step {
                return Foothold { point: position.extend(height), heading };
            }
        }
        let position = neutral + excursion;
        let height = inputs.ground.height(position).clamp(foothold_height - max_step, foothold_height + max_step);
        Foothold { point: position.extend(height), heading }
    }

    /// Mean height of the footholds at `at`.
    fn foothold_height(&self, at: Time, legs: &Legs) -> f64 {
        let heights = self.feet.iter().zip(&legs.legs).filter(|(_, leg)| leg.wheel.is_none());
        let (sum, count) = heights
            .fold((0.0, 0.0), |(sum, count), (steps, _)| (sum + step_at(steps, at).foothold_height(at), count + 1.0));
        if count > 0.0 { sum / count } else { 0.0 }
    }

    /// Bob of the body at `at`: contribution of natural walking to its height, m.
    fn bob(&self, legs: &Legs, natural: &[Option<NaturalGait>], at: Time) -> f64 {
        let Some((leg, Some(natural))) = legs.legs.first().zip(natural.first()) else { return 0.0 };
        let contribution = |(clock, scale): &(Clock, SmoothValue)| {
            let scale = scale.at(at);
            if clock.valid_from > at || scale == 0.0 {
                return 0.0;
            }
            let gait = &legs.gaits[clock.gait];
            // Phase since heel strike of the first leg.
            let phase = clock.cycles(at) - gait.lift_off_index(0) as f64 / GRID as f64 + gait.duty;
            scale * (natural.height(phase) - leg.hip.z)
        };
        self.clocks.iter().map(contribution).sum()
    }

    /// The footfalls from `since` up to but not including `until`.
    fn footfalls(&self, since: Time, until: Time) -> Vec<Footfall> {
        let mut footfalls = Vec::new();
        for (leg, steps) in self.feet.iter().enumerate() {
            let is_footfall = |step: &&Step| !step.is_placed && step.touch_down >= since && step.touch_down < until;
            let footfall = |step: &Step| Footfall { time: step.touch_down, leg, point: step.standing().point };
            footfalls.extend(steps.iter().filter(is_footfall).map(footfall));
        }
        sort_few(&mut footfalls, |footfall| (footfall.time, footfall.leg));
        footfalls
    }

    /// Drops the steps and clocks that are not needed after `past`.
    fn forget(&mut self, past: Time) {
        for steps in &mut self.feet {
            while steps.len() > MAX_KEPT_STEPS || steps.len() > 1 && steps[1].heel_off <= past {
                steps.pop_front();
            }
        }
        self.clocks.iter_mut().for_each(|(_, scale)| scale.forget(past));
        let last = self.clocks.len().saturating_sub(1);
        let mut index = 0;
        self.clocks.retain(|(_, scale)| {
            index += 1;
            index > last || scale.goal() != 0.0 || !scale.is_constant_from(past)
        });
    }

    fn stance(&self, legs: &Legs, natural: &[Option<NaturalGait>], ground: &Ground, at: Time, pose: &Pose) -> Stance {
        let wheel_contact = |leg: &Leg| {
            let hip = pose.transform_point(leg.hip.truncate());
            let point = hip.extend(ground.height(hip));
            FootState { point, sole: Sole::default(), heading: pose.heading.remainder(), is_down: true }
        };
        let foot = |((leg, steps), natural): ((&Leg, &VecDeque<Step>), &Option<NaturalGait>)| match leg.wheel {
            Some(_) => wheel_contact(leg),
            None => step_at(steps, at).foot(at, leg, natural.as_ref()),
        };
        let feet: Vec<FootState> = legs.legs.iter().zip(&self.feet).zip(natural).map(foot).collect();
        let mut lift = self.foothold_height(at, legs) + self.bob(legs, natural, at);
        let free_lift = lift;
        for ((leg, foot), steps) in legs.legs.iter().zip(&feet).zip(&self.feet) {
            let (to_point, yaw) = hip_to_point(leg, foot, pose, 0.0);
            let (sin, cos) = math::sin_cos(-yaw);
            let offset = DVec2::new(cos, sin).rotate(to_point.truncate());
            let max_lift = foot.point.z + leg.max_hip_height(offset, foot.sole).unwrap_or(0.0) - leg.hip.z;
            // A foot in the air limits the body only near lift-off and touch-down.
            let weight = if foot.is_down { 1.0 } else { step_at(steps, at).ground_proximity(at) };
            lift = lift.min(free_lift + (max_lift - free_lift).min(0.0) * weight);
        }
        let joints_of = |(leg, foot): (&Leg, &FootState)| {
            let (to_point, yaw) = hip_to_point(leg, foot, pose, lift);
            let joints = leg.joints(to_point, yaw, foot.sole).to_array();
            joints.into_iter().take(leg.joint_count())
        };
        let joints = legs.legs.iter().zip(&feet).flat_map(joints_of).collect();
        Stance { lift, joints, feet }
    }
}

impl Step {
    /// Foothold at the end of the step, as currently known.
    fn standing(&self) -> Foothold {
        self.goals.last().expect("a step has a goal").1
    }

    /// Changes the goal and the apex height from `at` on, if the change is not too small.
    fn change_goal(&mut self, at: Time, goal: Foothold, apex: f64) {
        let (_, last, last_apex) = self.goals.last().expect("a step has a goal");
        let turn = Heading::default().turned(goal.heading - last.heading).remainder().abs();
        if (goal.point - last.point).length() > MIN_GOAL_CHANGE
            || turn > MIN_GOAL_CHANGE
            || (apex - last_apex).abs() > MIN_GOAL_CHANGE
        {
            self.goals.push((at, goal, apex));
        }
    }

    /// Goal and apex height at `at`; a smooth transition leads from each goal to the next.
    fn goal_at(&self, at: Time) -> (Foothold, f64) {
        let (_, mut goal, mut apex) = self.goals[0];
        for pair in self.goals.windows(2) {
            let [(_, goal_before, apex_before), (since, goal_after, apex_after)] = [pair[0], pair[1]];
            let part = smooth(elapsed_fraction(at, since, self.touch_down - since));
            goal.point += (goal_after.point - goal_before.point) * part;
            goal.heading += Heading::default().turned(goal_after.heading - goal_before.heading).remainder() * part;
            apex += (apex_after - apex_before) * part;
        }
        (goal, apex)
    }

    /// Contribution of the foot to the mean height of the footholds: the height of its foothold, m, with a smooth
    /// transition during the swing.
    fn foothold_height(&self, at: Time) -> f64 {
        let part = smooth(elapsed_fraction(at, self.lift_off, self.touch_down - self.lift_off));
        let (goal, _) = self.goal_at(at);
        self.start.point.z + (goal.point.z - self.start.point.z) * part
    }

    /// Measure of how near in time a lift-off or touch-down is: 1 at these instants, 0 in mid-swing.
    fn ground_proximity(&self, at: Time) -> f64 {
        let part = elapsed_fraction(at, self.lift_off, self.touch_down - self.lift_off);
        1.0 - smooth(4.0 * part) + smooth(4.0 * part - 3.0)
    }

    /// The foothold nearest to `goal` that is at most `max_shift` metres, in plan view, from the last goal.
    fn limited_goal(&self, goal: Foothold, max_shift: f64, ground: &Ground) -> Foothold {
        let last = self.standing();
        let shift = (goal.point - last.point).truncate();
        if shift.length() <= max_shift {
            return goal;
        }
        let foot = last.point.truncate() + shift.clamp_length_max(max_shift);
        let max_step = (last.point.z - goal.point.z).abs();
        let height = ground.height(foot).clamp(last.point.z - max_step, last.point.z + max_step);
        Foothold { point: foot.extend(height), heading: goal.heading }
    }

    /// Pitch of the foot at `at`, toes up, rad.
    fn pitch(&self, at: Time, leg: &Leg) -> f64 {
        if leg.foot.is_none() || self.scale == 0.0 && self.start_pitch == 0.0 {
            return 0.0;
        }
        if at >= self.touch_down {
            let stance_phase = TOE_OFF * elapsed_fraction(at, self.touch_down, self.stance_duration);
            return if stance_phase < HEEL_OFF { self.scale * natural_pitch(stance_phase) } else { 0.0 };
        }
        if at < self.lift_off {
            return self.roll_off_pitch(at);
        }
        let natural = |part: f64| self.scale * natural_pitch(TOE_OFF + (1.0 - TOE_OFF) * part);
        let part = elapsed_fraction(at, self.lift_off, self.touch_down - self.lift_off);
        natural(part) + (self.pitch_at_lift_off() - natural(0.0)) * (1.0 - smooth(2.0 * part))
    }

    /// Pitch of a foot during roll-off, rad.
    fn roll_off_pitch(&self, at: Time) -> f64 {
        let part = elapsed_fraction(at, self.heel_off, self.roll_duration);
        self.scale * natural_pitch(HEEL_OFF + (TOE_OFF - HEEL_OFF) * part)
    }

    fn pitch_at_lift_off(&self) -> f64 {
        if self.heel_off < self.lift_off { self.roll_off_pitch(self.lift_off) } else { self.start_pitch }
    }

    fn foot(&self, at: Time, leg: &Leg, natural: Option<&NaturalGait>) -> FootState {
        let pitch = self.pitch(at, leg);
        let shape = leg.foot.unwrap_or(Foot { heel: 0.0, toe: 0.0, height: 0.0 });
        // The contact is at the heel, at the toe or at the whole sole.
        let contact_from_ankle = |pitch: f64| match pitch {
            up if up > 0.0 => -shape.heel,
            down if down < 0.0 => shape.toe,
            _ => 0.0,
        };
        let standing = |foothold: Foothold| {
            let sole = Sole { from_ankle: contact_from_ankle(pitch), pitch };
            FootState { point: foothold.sole_point(sole.from_ankle), sole, heading: foothold.heading, is_down: true }
        };
        if at >= self.touch_down {
            return standing(self.standing());
        }
        if at < self.lift_off {
            return standing(self.start);
        }
        let (goal, apex) = self.goal_at(at);
        let part = elapsed_fraction(at, self.lift_off, self.touch_down - self.lift_off);
        // The toe leaves the ground last, and the heel lands first.
        let last_contact = if self.pitch_at_lift_off() > 0.0 { -shape.heel } else { shape.toe };
        let from_ankle = last_contact - (last_contact + shape.heel) * smooth(part);
        let (start, target) = (self.start.sole_point(last_contact), goal.sole_point(-shape.heel));
        let swing = natural.map_or(DVec2::ZERO, |natural| natural.swing_path(part));
        let covered = smooth(part) + (swing.x - smooth(part)) * self.scale.min(1.0);
        let foot = start.truncate().lerp(target.truncate(), covered);
        let end_height = if part < 0.5 { start.z } else { target.z };
        let height = end_height + (apex - end_height) * smooth(2.5 * part.min(1.0 - part)) + self.scale * swing.y;
        // Heel and toe stay above the line between the footholds.
        let sin = math::sin(pitch);
        let lowest_sole_point = ((-shape.heel - from_ankle) * sin).min((shape.toe - from_ankle) * sin);
        let height = height.max(start.z + (target.z - start.z) * smooth(part) - lowest_sole_point);
        let turn = Heading::default().turned(goal.heading - self.start.heading).remainder();
        FootState {
            point: foot.extend(height),
            sole: Sole { from_ankle, pitch },
            heading: self.start.heading + turn * smooth(part),
            is_down: false,
        }
    }
}

impl Foothold {
    /// The point under a flat sole that is `from_ankle` m in front of the ankle.
    fn sole_point(&self, from_ankle: f64) -> DVec3 {
        let (sin, cos) = math::sin_cos(self.heading);
        self.point + DVec3::new(cos, sin, 0.0) * from_ankle
    }
}

/// The step that contains `at`.
fn step_at(steps: &VecDeque<Step>, at: Time) -> &Step {
    let current = steps.iter().rev().find(|step| step.heel_off <= at).or(steps.front());
    current.expect("a foot has a step")
}

/// State of the robot just before `at`.
fn state_before(pieces: &[MotionPiece], at: Time) -> BodyState {
    let before = pieces.iter().rev().find(|piece| piece.start() < at).or(pieces.first());
    let piece = before.expect("a motion has a piece");
    BodyState { at, pose: piece.pose(at), twist: piece.twist(at - Time(1)) }
}

/// Apex height of a swing, m: highest ground between the footholds, plus step height and additional lift.
fn apex_height(inputs: &DecisionInputs, at: Time, leg: usize, start: &Foothold, goal: &Foothold) -> f64 {
    let settings = settings_at(inputs.settings, at);
    let ground_between = |index: i32| {
        let part = f64::from(index) / f64::from(GROUND_INTERVALS);
        inputs.ground.height(start.point.truncate().lerp(goal.point.truncate(), part))
    };
    let (_, lift) = settings.corrections[leg];
    let highest = (1..GROUND_INTERVALS).map(ground_between).fold(start.point.z.max(goal.point.z), f64::max);
    // If the ground between the footholds is higher than the leg can step over, the foot passes through the ground.
    let max_height = start.point.z.max(goal.point.z) + MAX_STEP * inputs.legs.legs[leg].hip.z;
    highest.min(max_height) + settings.step_height + lift
}

/// Returns true if a foot deviates from its neutral position by more than `tolerance`, m and rad.
fn is_away(foothold: &Foothold, leg: &Leg, pose: &Pose, tolerance: f64) -> bool {
    let hip = pose.transform_point(leg.hip.truncate());
    (foothold.point.truncate() - hip).length() > tolerance || foot_yaw(foothold, pose).abs() > tolerance
}

/// Angle from the body to the foot.
fn foot_yaw(foothold: &Foothold, pose: &Pose) -> f64 {
    Heading::default().turned(foothold.heading - pose.heading.remainder()).remainder()
}

/// Vector from the hip of a body at height `lift` to the contact point of a foot, in the robot's axes, m. The second
/// value is the yaw of the foot relative to the body, rad.
fn hip_to_point(leg: &Leg, foot: &FootState, pose: &Pose, lift: f64) -> (DVec3, f64) {
    let point = pose.inverse_transform_point(foot.point.truncate()).extend(foot.point.z - lift);
    let yaw = Heading::default().turned(foot.heading - pose.heading.remainder()).remainder();
    (point - leg.hip, yaw)
}
