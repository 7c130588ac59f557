//! The sequence of footholds of a walk.
//!
//! All decisions about the feet are made at instants of the gait's own clock, 48 per period, from pose and twist just
//! before the instant. So the decisions depend neither on slots nor on the times of queries. Decisions before the
//! present slot are final; later decisions are repeated whenever the plan of the motion changes.

use std::collections::VecDeque;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::{
    FootState, Footfall, LegCommand, LegCommandError, Legs, Stance,
    curve::{HEEL_OFF, NaturalGait, TOE_OFF, natural_pitch},
    gait::{Clock, GRID, Gait},
    leg::{Foot, LOWEST_HIP, Leg, Sole},
    smooth::{SmoothValue, elapsed_fraction, smooth},
};
use crate::{
    drive::{HISTORY, Piece},
    math,
    pose::{Heading, Pose, Twist},
    scene::Ground,
    time::Time,
};

/// Tolerance (m, and rad) within which a foot of a standing robot counts as in its neutral position and is not lifted.
/// Our choice.
const NEUTRAL_TOLERANCE: f64 = 5e-3;
/// Minimum change of its goal (m, and rad) that redirects a foot in the air. Our choice.
const SAME_GOAL: f64 = 1e-3;
/// Last fraction of the swing in which a foot keeps its goal. Our choice.
const GOAL_KEPT_SHARE: f64 = 0.25;
/// Angle between body and standing foot beyond which the foot is lifted before its turn, rad: 60 degrees. Our choice.
const MAX_TWISTED: f64 = std::f64::consts::FRAC_PI_3;
/// Maximum change of the goal of a foot in the air, as a multiple of the excursion times the remaining fraction of the
/// swing. Our choice.
const MAX_TURNED: f64 = 1.6;
/// Maximum scale of the natural curves. Our choice.
const MAX_LEVEL: f64 = 1.2;
/// Changes of the scale of the natural curves below this value are ignored. Our choice.
const SAME_LEVEL: f64 = 0.02;
/// Number of positions tried for a foot between its goal and the body.
const TRIED_PLACES: i32 = 16;
/// Number of intervals between two footholds at whose ends the height of the ground is sampled.
const ASKED_PLACES: i32 = 8;
/// Maximum step up or down, as a fraction of the hip's height. Our choice.
const TALLEST_STEP: f64 = 0.4;
/// Maximum number of steps kept per leg until footfalls are taken.
const REMEMBERED: usize = 64;

/// One piece of the body's motion, in force from its start until the next.
#[derive(Clone, Copy, Debug)]
pub(in crate::drive) struct MotionPiece {
    pub piece: Piece,
    /// Offset from the robot's centre to its axle along x, m.
    pub axis_offset: f64,
    /// True if the piece begins with a placement of the robot.
    pub is_placed: bool,
}

/// The planned motion of the body, which the legs follow.
pub(in crate::drive) trait Plan {
    /// Number of its changes so far.
    fn revision(&self) -> u64;

    /// The pieces of motion from the one in force just before `from`, up to `to`.
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
    /// For each leg, the shift of the next foothold in the robot's frame and the additional lift.
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
    orders: VecDeque<(Time, LegSettings)>,
    /// Number of commands that changed the settings.
    revision: u64,
    /// Final decisions, for instants before the present slot.
    firm: Steps,
    /// Tentative decisions after the final ones, valid for these revisions of the motion and of the settings.
    ahead: Option<((u64, u64), Steps)>,
    /// Time up to which footfalls have been taken.
    reported_until: Time,
}

/// Position of a standing foot: the point under the ankle of a level foot, or the tip of the leg.
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
    /// Planned duration of the roll-off, which may be cut short.
    roll: Time,
    lift_off: Time,
    touch_down: Time,
    /// Planned duration of the stance after touch-down.
    stand: Time,
    from: Foothold,
    /// Pitch of the foot at `heel_off`.
    from_pitch: f64,
    /// Scale of the natural pitch of the foot.
    level: f64,
    /// Goals and clearance heights, each with the instant from which it is in force; the first holds from lift-off.
    goals: Vec<(Time, Foothold, f64)>,
    /// True if a placement of the robot, not a step, brought the foot here.
    is_placed: bool,
}

/// Steps of all feet from some instant in the past up to `until`.
#[derive(Clone, Debug)]
struct Steps {
    until: Time,
    /// Clocks, each with the scale of the body's natural bob in that gait; the last clock is current.
    clocks: Vec<(Clock, SmoothValue)>,
    is_walking: bool,
    feet: Vec<VecDeque<Step>>,
}

/// Inputs of the decisions other than the motion.
struct DecisionInputs<'a> {
    legs: &'a Legs,
    ground: &'a Ground,
    natural: &'a [Option<NaturalGait>],
    orders: &'a VecDeque<(Time, LegSettings)>,
}

/// State of the robot just before a decision instant.
struct BodyState {
    at: Time,
    pose: Pose,
    twist: Twist,
}

impl Walk {
    pub fn new(legs: Arc<Legs>, ground: Arc<Ground>) -> Self {
        let orders = LegSettings {
            gait: 0,
            step_height: legs.step_height,
            corrections: vec![(DVec2::ZERO, 0.0); legs.legs.len()],
        };
        let natural = legs.legs.iter().map(NaturalGait::new).collect();
        let never = Time(i64::MIN);
        let firm =
            Steps { until: never, clocks: Vec::new(), is_walking: false, feet: vec![VecDeque::new(); legs.legs.len()] };
        Self {
            legs,
            ground,
            natural,
            orders: VecDeque::from([(never, orders)]),
            revision: 0,
            firm,
            ahead: None,
            reported_until: never,
        }
    }

    pub fn legs(&self) -> &Legs {
        &self.legs
    }

    pub fn ground(&self) -> &Ground {
        &self.ground
    }

    pub fn orders_at(&self, at: Time) -> &LegSettings {
        orders_at(&self.orders, at)
    }

    pub fn command(&mut self, at: Time, command: LegCommand) -> Result<(), LegCommandError> {
        let (since, last) = self.orders.back().expect("a walk has orders");
        let mut orders = last.clone();
        match command {
            LegCommand::Gait(gait) => {
                let gaits = self.legs.gaits.len();
                orders.gait = if gait < gaits { gait } else { return Err(LegCommandError::NoGait { gaits }) };
            }
            LegCommand::StepHeight(height) => {
                let max_reach = self.legs.legs.iter().map(Leg::reach).fold(0.0, f64::max);
                orders.step_height =
                    if (0.0..=max_reach).contains(&height) { height } else { return Err(LegCommandError::Length) };
            }
            LegCommand::ShiftFoothold { leg, shift, lift } => {
                let legs = self.legs.legs.len();
                let reach = self.legs.legs.get(leg).ok_or(LegCommandError::NoLeg { legs })?.reach();
                if !(shift.length() <= reach && (0.0..=reach).contains(&lift)) {
                    return Err(LegCommandError::Length);
                }
                orders.corrections[leg] = (shift, lift);
            }
        }
        if orders != *last {
            let at = at.max(*since);
            if at == *since {
                self.orders.pop_back();
            }
            self.orders.push_back((at, orders));
            self.revision += 1;
        }
        Ok(())
    }

    pub fn stance(&mut self, plan: &mut impl Plan, at: Time, world_from_robot: &Pose) -> Stance {
        self.extend(plan, at);
        let steps = if at <= self.firm.until { &self.firm } else { self.ahead_steps() };
        steps.stance(&self.legs, &self.natural, &self.ground, at, world_from_robot)
    }

    pub fn take_footfalls(&mut self, plan: &mut impl Plan, until: Time) -> Vec<Footfall> {
        let last = until - Time(1);
        self.extend(plan, last);
        let steps = if last <= self.firm.until { &self.firm } else { self.ahead_steps() };
        let footfalls = steps.footfalls(self.reported_until, until);
        self.reported_until = self.reported_until.max(until);
        footfalls
    }

    /// Makes the decisions before `end`, the end of the present slot, final.
    pub fn commit(&mut self, plan: &mut impl Plan, end: Time) {
        let last = end - Time(1);
        if last <= self.firm.until {
            return;
        }
        self.decide(plan, last, true);
        let past = self.reported_until.min(end - HISTORY);
        self.firm.forget(past);
        while self.orders.len() > 1 && self.orders[1].0 <= past {
            self.orders.pop_front();
        }
        self.ahead = None;
    }

    fn ahead_steps(&self) -> &Steps {
        self.ahead.as_ref().map_or(&self.firm, |(_, steps)| steps)
    }

    fn extend(&mut self, plan: &mut impl Plan, at: Time) {
        if at > self.firm.until {
            self.decide(plan, at, false);
        }
    }

    /// Makes all decisions up to `at`: final ones, or tentative ones for the present plan.
    fn decide(&mut self, plan: &mut impl Plan, at: Time, is_firm: bool) {
        let key = (plan.revision(), self.revision);
        let mut steps = match self.ahead.take() {
            Some((known, steps)) if known == key && !(is_firm && steps.until > at) => steps,
            _ => self.firm.clone(),
        };
        if steps.until < at {
            let pieces = plan.pieces(steps.until, at);
            let Self { legs, ground, natural, orders, .. } = self;
            let inputs = DecisionInputs { legs, ground, natural, orders };
            steps.extend(&inputs, &pieces, at);
        }
        if is_firm {
            self.firm = steps;
        } else {
            self.ahead = Some((key, steps));
        }
    }
}

fn orders_at(orders: &VecDeque<(Time, LegSettings)>, at: Time) -> &LegSettings {
    let order = orders.iter().rev().find(|(since, _)| *since <= at).or(orders.front());
    order.map(|(_, orders)| orders).expect("a walk has orders")
}

impl Steps {
    /// Makes all decisions after `until` up to `to`. `pieces` are the motion's pieces from the one in force just
    /// before `until`.
    fn extend(&mut self, inputs: &DecisionInputs, pieces: &[MotionPiece], to: Time) {
        loop {
            let opening = pieces.iter().find(|piece| piece.start() > self.until).filter(|piece| piece.start() <= to);
            let order = inputs.orders.iter().find(|(since, _)| *since > self.until).filter(|(since, _)| *since <= to);
            let tick = self.clock().map(|clock| clock.next_after(self.until)).map(|index| (index, self.instant(index)));
            let tick = tick.filter(|(_, instant)| *instant <= to);
            let first =
                [opening.map(MotionPiece::start), order.map(|(since, _)| *since), tick.map(|(_, instant)| instant)];
            let Some(at) = first.into_iter().flatten().min() else { break };
            if let Some((index, _)) = tick.filter(|(_, instant)| *instant == at) {
                self.tick(inputs, &state_before(pieces, at), index);
            }
            if order.is_some_and(|(since, _)| *since == at) {
                self.change_gait(inputs, at);
            }
            if let Some(piece) = opening.filter(|piece| piece.start() == at) {
                self.open(inputs, piece);
            }
            self.until = at;
        }
        self.until = to;
    }

    /// The current clock, while the robot walks.
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
            let index = orders_at(inputs.orders, at).gait;
            self.clocks.push((Clock::starting(at, &inputs.legs.gaits[index], index), SmoothValue::default()));
            self.is_walking = true;
        }
    }

    /// Puts all feet at their neutral positions.
    fn place(&mut self, inputs: &DecisionInputs, at: Time, pose: &Pose) {
        for (leg, steps) in inputs.legs.legs.iter().zip(&mut self.feet) {
            let hip = pose.transform_point(leg.hip.truncate());
            let from = Foothold { point: hip.extend(inputs.ground.height(hip)), heading: pose.heading.remainder() };
            let goals = vec![(at, from, 0.0)];
            let (roll, stand) = (Time::ZERO, Time::ZERO);
            let (heel_off, lift_off, touch_down) = (at, at, at);
            let (from_pitch, level, is_placed) = (0.0, 0.0, true);
            steps.push_back(Step {
                heel_off,
                roll,
                lift_off,
                touch_down,
                stand,
                from,
                from_pitch,
                level,
                goals,
                is_placed,
            });
        }
        self.is_walking = false;
    }

    fn change_gait(&mut self, inputs: &DecisionInputs, at: Time) {
        let index = orders_at(inputs.orders, at).gait;
        let Some(clock) = self.clock().copied().filter(|clock| clock.gait != index) else { return };
        let gait = &inputs.legs.gaits[index];
        let (_, level) = self.clocks.last_mut().expect("it walks");
        let goal = level.goal();
        level.aim(at, Time(gait.period.0 / 2), 0.0);
        let mut level = SmoothValue::default();
        level.aim(at, Time(gait.period.0 / 2), goal);
        self.clocks.push((clock.changed(at, gait, index), level));
    }

    /// Handles a decision instant.
    fn tick(&mut self, inputs: &DecisionInputs, present: &BodyState, index: i64) {
        let Some(clock) = self.clock().copied() else { return };
        let is_moving = !present.twist.is_zero();
        let mut is_settled = !is_moving;
        for number in 0..inputs.legs.legs.len() {
            if inputs.legs.legs[number].wheel.is_none() {
                is_settled &= self.tick_foot(inputs, present, &clock, index, number);
            }
        }
        self.follow_speed(inputs, present);
        if is_settled && self.clocks.iter().all(|(_, level)| level.goal() == 0.0 && level.is_still(present.at)) {
            self.is_walking = false;
        }
    }

    /// Handles a decision instant for one foot; returns true if the foot is on the ground in its neutral position.
    fn tick_foot(
        &mut self,
        inputs: &DecisionInputs,
        present: &BodyState,
        clock: &Clock,
        index: i64,
        number: usize,
    ) -> bool {
        let at = present.at;
        let leg = &inputs.legs.legs[number];
        let gait = &inputs.legs.gaits[clock.gait];
        let is_moving = !present.twist.is_zero();
        let soon = (clock.instant(index + 2) - at).seconds();
        let last = self.feet[number].back().expect("a foot stands somewhere");
        if at <= last.lift_off && last.heel_off < at {
            // The foot rolls off and its goal may still change. The roll-off is cut short if the leg would not reach
            // otherwise.
            let is_cut = at < last.lift_off && self.is_out_of_reach_soon(inputs, number, present, soon);
            let touch_down = if is_cut { at + (last.touch_down - last.lift_off) } else { last.touch_down };
            let goal = self.goal(inputs, present, number, clock, touch_down);
            let apex = apex(inputs, at, number, &last.from, &goal);
            let step = self.feet[number].back_mut().expect("it rolls");
            if is_cut {
                (step.lift_off, step.touch_down) = (at, touch_down);
            }
            step.goals = vec![(step.lift_off, goal, apex)];
            return false;
        }
        if at < last.touch_down {
            let (left, whole) = ((last.touch_down - at).seconds(), (last.touch_down - last.lift_off).seconds());
            if left > GOAL_KEPT_SHARE * whole {
                let goal = self.goal(inputs, present, number, clock, last.touch_down);
                let goal = last.limited_goal(goal, MAX_TURNED * inputs.legs.excursion() * left / whole, inputs.ground);
                let apex = apex(inputs, at, number, &last.from, &goal);
                self.feet[number].back_mut().expect("it is in the air").turn_to(at, goal, apex);
            }
            return false;
        }
        let from = last.standing();
        let is_displaced = is_away(&from, leg, &present.pose, NEUTRAL_TOLERANCE);
        let slot = gait.slot(number);
        let until_slot = (slot - index).rem_euclid(GRID);
        let level = self.level(inputs, present, gait, number);
        let from_pitch = last.pitch(at, leg);
        let step = |heel_off, lift_off: Time, period| {
            let touch_down = lift_off + gait.swing(period);
            let (roll, stand) = (lift_off - heel_off, Time((gait.duty * gait.period.0 as f64) as i64));
            let goals = vec![(lift_off, from, from.point.z)];
            Step { heel_off, roll, lift_off, touch_down, stand, from, from_pitch, level, goals, is_placed: false }
        };
        let is_lifted = if until_slot == 0 {
            is_moving || is_displaced
        } else {
            is_moving && self.is_out_of_reach_soon(inputs, number, present, soon)
        };
        if is_lifted {
            let mut step = step(at, at, clock.period_at(index));
            let goal = self.goal(inputs, present, number, clock, step.touch_down);
            step.goals = vec![(at, goal, apex(inputs, at, number, &from, &goal))];
            self.feet[number].push_back(step);
        } else if level > 0.0 && until_slot == gait.rolling() && from_pitch == 0.0 {
            let slot = index + until_slot;
            let step = step(at, clock.instant(slot), clock.period_at(slot));
            self.feet[number].push_back(step);
            return false;
        }
        !is_lifted && !is_displaced
    }

    /// Scale of the natural curves for a leg: its forward speed divided by the speed in the source.
    fn level(&self, inputs: &DecisionInputs, present: &BodyState, gait: &Gait, number: usize) -> f64 {
        let Some(natural) = inputs.natural[number].as_ref().filter(|_| gait.is_natural) else { return 0.0 };
        let Twist { vx, omega, .. } = present.twist;
        let speed = vx - omega * inputs.legs.legs[number].hip.y;
        (speed * gait.period.seconds() / natural.stride).clamp(0.0, MAX_LEVEL)
    }

    /// Adapts the bob of the body (its natural rise and fall) to the speed.
    fn follow_speed(&mut self, inputs: &DecisionInputs, present: &BodyState) {
        let Some((clock, level)) = self.clocks.last() else { return };
        let gait = &inputs.legs.gaits[clock.gait];
        let count = inputs.legs.legs.len();
        let goal = (0..count).map(|leg| self.level(inputs, present, gait, leg)).sum::<f64>() / count as f64;
        let span = Time(gait.period.0 / 2);
        if (goal - level.goal()).abs() > SAME_LEVEL || goal == 0.0 && level.goal() != 0.0 {
            self.clocks.last_mut().expect("it walks").1.aim(present.at, span, goal);
        }
    }

    /// Returns true if a standing foot reaches the limit of its leg's reach or turn within `soon` seconds.
    fn is_out_of_reach_soon(&self, inputs: &DecisionInputs, number: usize, present: &BodyState, soon: f64) -> bool {
        let leg = &inputs.legs.legs[number];
        let foot = step_at(&self.feet[number], present.at).foot(present.at, leg, None);
        let lowest = self.base(present.at, inputs.legs) + LOWEST_HIP * leg.hip.z;
        let state = |pose: &Pose| {
            let (to_point, yaw) = hip_to_point(leg, &foot, pose, 0.0);
            let (sin, cos) = math::sin_cos(-yaw);
            let offset = DVec2::new(cos, sin).rotate(to_point.truncate());
            (foot.point.z + leg.max_hip_height(offset, foot.sole).unwrap_or(f64::NEG_INFINITY), yaw.abs())
        };
        let (now, yaw_now) = state(&present.pose);
        let (then, yaw_then) = state(&present.pose.moved(present.twist.scaled(soon)));
        then < lowest && then <= now || yaw_then > MAX_TWISTED && yaw_then > yaw_now
    }

    /// Goal of a foot: its position under the body in the middle of its stance, extrapolated with the present twist.
    fn goal(
        &self,
        inputs: &DecisionInputs,
        present: &BodyState,
        number: usize,
        clock: &Clock,
        touch_down: Time,
    ) -> Foothold {
        let leg = &inputs.legs.legs[number];
        let (shift, _) = orders_at(inputs.orders, present.at).corrections[number];
        let gait = &inputs.legs.gaits[clock.gait];
        let slot = gait.slot(number);
        // In a natural gait, the middle of the stance is not under the hip.
        let ahead = inputs.natural[number].as_ref().map_or(0.0, |natural| natural.ahead);
        let shift = shift + DVec2::new(ahead * self.level(inputs, present, gait, number), 0.0);
        let seconds = (touch_down - present.at).seconds();
        let stands = (clock.next_slot(touch_down, slot) - touch_down).seconds();
        let then = |seconds| present.pose.moved(present.twist.scaled(seconds));
        let (at_touch_down, at_middle) = (then(seconds), then(seconds + 0.5 * stands));
        let hip = leg.hip.truncate();
        let nearest = at_touch_down.transform_point(hip);
        let excursion = at_middle.transform_point(hip + shift) - nearest;
        let excursion = excursion.clamp_length_max(inputs.legs.excursion());
        let base = self.base(present.at, inputs.legs);
        let tallest = TALLEST_STEP * leg.hip.z;
        let heading = at_middle.heading.remainder();
        // Moves towards the body until the step is neither too high nor too deep.
        for tried in 0..=TRIED_PLACES {
            let hip = nearest + excursion * (1.0 - f64::from(tried) / f64::from(TRIED_PLACES));
            let height = inputs.ground.height(hip);
            if (height - base).abs() <= tallest {
                return Foothold { point: hip.extend(height), heading };
            }
        }
        let hip = nearest + excursion;
        let height = inputs.ground.height(hip).clamp(base - tallest, base + tallest);
        Foothold { point: hip.extend(height), heading }
    }

    /// Mean height of the footholds at `at`.
    fn base(&self, at: Time, legs: &Legs) -> f64 {
        let heights = self.feet.iter().zip(&legs.legs).filter(|(_, leg)| leg.wheel.is_none());
        let (sum, count) =
            heights.fold((0.0, 0.0), |(sum, count), (steps, _)| (sum + step_at(steps, at).base(at), count + 1.0));
        if count > 0.0 { sum / count } else { 0.0 }
    }

    /// Contribution of natural walking to the height of the body at `at`.
    fn bob(&self, legs: &Legs, natural: &[Option<NaturalGait>], at: Time) -> f64 {
        let Some((leg, Some(natural))) = legs.legs.first().zip(natural.first()) else { return 0.0 };
        let of_clock = |(clock, level): &(Clock, SmoothValue)| {
            let level = level.at(at);
            if clock.opened > at || level == 0.0 {
                return 0.0;
            }
            let gait = &legs.gaits[clock.gait];
            // Phase since heel strike of the first leg.
            let phase = clock.cycles(at) - gait.slot(0) as f64 / GRID as f64 + gait.duty;
            level * (natural.height(phase) - leg.hip.z)
        };
        self.clocks.iter().map(of_clock).sum()
    }

    fn footfalls(&self, since: Time, until: Time) -> Vec<Footfall> {
        let mut footfalls = Vec::new();
        for (leg, steps) in self.feet.iter().enumerate() {
            let fallen = |step: &&Step| !step.is_placed && step.touch_down >= since && step.touch_down < until;
            let footfall = |step: &Step| Footfall { time: step.touch_down, leg, point: step.standing().point };
            footfalls.extend(steps.iter().filter(fallen).map(footfall));
        }
        footfalls.sort_by_key(|footfall| (footfall.time, footfall.leg));
        footfalls
    }

    /// Drops the history before `past`.
    fn forget(&mut self, past: Time) {
        for steps in &mut self.feet {
            while steps.len() > REMEMBERED || steps.len() > 1 && steps[1].heel_off <= past {
                steps.pop_front();
            }
        }
        self.clocks.iter_mut().for_each(|(_, level)| level.forget(past));
        let last = self.clocks.len().saturating_sub(1);
        let mut index = 0;
        self.clocks.retain(|(_, level)| {
            index += 1;
            index > last || level.goal() != 0.0 || !level.is_still(past)
        });
    }

    fn stance(&self, legs: &Legs, natural: &[Option<NaturalGait>], ground: &Ground, at: Time, pose: &Pose) -> Stance {
        let rolling = |leg: &Leg| {
            let hip = pose.transform_point(leg.hip.truncate());
            let point = hip.extend(ground.height(hip));
            FootState { point, sole: Sole::default(), heading: pose.heading.remainder(), is_down: true }
        };
        let foot = |((leg, steps), natural): ((&Leg, &VecDeque<Step>), &Option<NaturalGait>)| match leg.wheel {
            Some(_) => rolling(leg),
            None => step_at(steps, at).foot(at, leg, natural.as_ref()),
        };
        let feet: Vec<FootState> = legs.legs.iter().zip(&self.feet).zip(natural).map(foot).collect();
        let mut lift = self.base(at, legs) + self.bob(legs, natural, at);
        let free = lift;
        for ((leg, foot), steps) in legs.legs.iter().zip(&feet).zip(&self.feet) {
            let (to_point, yaw) = hip_to_point(leg, foot, pose, 0.0);
            let (sin, cos) = math::sin_cos(-yaw);
            let offset = DVec2::new(cos, sin).rotate(to_point.truncate());
            let max_lift = foot.point.z + leg.max_hip_height(offset, foot.sole).unwrap_or(0.0) - leg.hip.z;
            // A foot in the air limits the body only near lift-off and touch-down.
            let weight = if foot.is_down { 1.0 } else { step_at(steps, at).nearness(at) };
            lift = lift.min(free + (max_lift - free).min(0.0) * weight);
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

    fn turn_to(&mut self, at: Time, goal: Foothold, apex: f64) {
        let (_, last, last_apex) = self.goals.last().expect("a step has a goal");
        let turn = Heading::default().turned(goal.heading - last.heading).remainder().abs();
        if (goal.point - last.point).length() > SAME_GOAL || turn > SAME_GOAL || (apex - last_apex).abs() > SAME_GOAL {
            self.goals.push((at, goal, apex));
        }
    }

    /// Goal and clearance height at `at`, blended from each to the next.
    fn goal_at(&self, at: Time) -> (Foothold, f64) {
        let (_, mut goal, mut apex) = self.goals[0];
        for pair in self.goals.windows(2) {
            let [(_, before, low), (since, after, high)] = [pair[0], pair[1]];
            let part = smooth(elapsed_fraction(at, since, self.touch_down - since));
            goal.point += (after.point - before.point) * part;
            goal.heading += Heading::default().turned(after.heading - before.heading).remainder() * part;
            apex += (high - low) * part;
        }
        (goal, apex)
    }

    /// Contribution of the foot to the mean height of the footholds.
    fn base(&self, at: Time) -> f64 {
        let part = smooth(elapsed_fraction(at, self.lift_off, self.touch_down - self.lift_off));
        let (goal, _) = self.goal_at(at);
        self.from.point.z + (goal.point.z - self.from.point.z) * part
    }

    /// Closeness in time to the ground contact: 1 at lift-off and touch-down, 0 in mid-swing.
    fn nearness(&self, at: Time) -> f64 {
        let part = elapsed_fraction(at, self.lift_off, self.touch_down - self.lift_off);
        1.0 - smooth(4.0 * part) + smooth(4.0 * part - 3.0)
    }

    /// The foothold nearest to `goal` that is at most `max_shift` metres from the last goal.
    fn limited_goal(&self, goal: Foothold, max_shift: f64, ground: &Ground) -> Foothold {
        let last = self.standing();
        let turn = (goal.point - last.point).truncate();
        if turn.length() <= max_shift {
            return goal;
        }
        let foot = last.point.truncate() + turn.clamp_length_max(max_shift);
        let tallest = (last.point.z - goal.point.z).abs();
        let height = ground.height(foot).clamp(last.point.z - tallest, last.point.z + tallest);
        Foothold { point: foot.extend(height), heading: goal.heading }
    }

    /// Pitch of the foot at `at`, toes up, rad.
    fn pitch(&self, at: Time, leg: &Leg) -> f64 {
        if leg.foot.is_none() || self.level == 0.0 && self.from_pitch == 0.0 {
            return 0.0;
        }
        if at >= self.touch_down {
            let stood = elapsed_fraction(at, self.touch_down, self.stand);
            return if stood * TOE_OFF < HEEL_OFF { self.level * natural_pitch(stood * TOE_OFF) } else { 0.0 };
        }
        if at < self.lift_off {
            return self.rolled(at);
        }
        let natural = |part: f64| self.level * natural_pitch(TOE_OFF + (1.0 - TOE_OFF) * part);
        let part = elapsed_fraction(at, self.lift_off, self.touch_down - self.lift_off);
        natural(part) + (self.pitch_at_lift_off() - natural(0.0)) * (1.0 - smooth(2.0 * part))
    }

    /// Pitch of a foot during roll-off, rad.
    fn rolled(&self, at: Time) -> f64 {
        let part = elapsed_fraction(at, self.heel_off, self.roll);
        self.level * natural_pitch(HEEL_OFF + (TOE_OFF - HEEL_OFF) * part)
    }

    fn pitch_at_lift_off(&self) -> f64 {
        if self.heel_off < self.lift_off { self.rolled(self.lift_off) } else { self.from_pitch }
    }

    fn foot(&self, at: Time, leg: &Leg, natural: Option<&NaturalGait>) -> FootState {
        let pitch = self.pitch(at, leg);
        let shape = leg.foot.unwrap_or(Foot { heel: 0.0, toe: 0.0, height: 0.0 });
        // Contact with heel, toe or the whole sole.
        let end = |pitch: f64| match pitch {
            up if up > 0.0 => -shape.heel,
            down if down < 0.0 => shape.toe,
            _ => 0.0,
        };
        let standing = |foothold: Foothold| {
            let sole = Sole { ahead: end(pitch), pitch };
            FootState { point: foothold.ahead(sole.ahead), sole, heading: foothold.heading, is_down: true }
        };
        if at >= self.touch_down {
            return standing(self.standing());
        }
        if at < self.lift_off {
            return standing(self.from);
        }
        let (goal, apex) = self.goal_at(at);
        let part = elapsed_fraction(at, self.lift_off, self.touch_down - self.lift_off);
        // The toe leaves the ground last, and the heel lands first.
        let leaving = if self.pitch_at_lift_off() > 0.0 { -shape.heel } else { shape.toe };
        let ahead = leaving - (leaving + shape.heel) * smooth(part);
        let (start, target) = (self.from.ahead(leaving), goal.ahead(-shape.heel));
        let swing = natural.map_or(DVec2::ZERO, |natural| natural.swing_path(part));
        let gone = smooth(part) + (swing.x - smooth(part)) * self.level.min(1.0);
        let foot = start.truncate().lerp(target.truncate(), gone);
        let end = if part < 0.5 { start.z } else { target.z };
        let height = end + (apex - end) * smooth(2.5 * part.min(1.0 - part)) + self.level * swing.y;
        // Heel and toe stay above the line between the footholds.
        let sin = math::sin(pitch);
        let deepest = ((-shape.heel - ahead) * sin).min((shape.toe - ahead) * sin);
        let height = height.max(start.z + (target.z - start.z) * smooth(part) - deepest);
        let turn = Heading::default().turned(goal.heading - self.from.heading).remainder();
        FootState {
            point: foot.extend(height),
            sole: Sole { ahead, pitch },
            heading: self.from.heading + turn * smooth(part),
            is_down: false,
        }
    }
}

impl Foothold {
    /// The ground point below the position `ahead` of the ankle on a level sole.
    fn ahead(&self, ahead: f64) -> DVec3 {
        let (sin, cos) = math::sin_cos(self.heading);
        self.point + DVec3::new(cos, sin, 0.0) * ahead
    }
}

/// The step in force at `at`.
fn step_at(steps: &VecDeque<Step>, at: Time) -> &Step {
    let current = steps.iter().rev().find(|step| step.heel_off <= at).or(steps.front());
    current.expect("a foot stands somewhere")
}

/// State of the robot just before `at`.
fn state_before(pieces: &[MotionPiece], at: Time) -> BodyState {
    let before = pieces.iter().rev().find(|piece| piece.start() < at).or(pieces.first());
    let piece = before.expect("a motion has a piece");
    BodyState { at, pose: piece.pose(at), twist: piece.twist(at - Time(1)) }
}

/// Clearance height of a swing: highest ground between the footholds, plus step height and lift.
fn apex(inputs: &DecisionInputs, at: Time, leg: usize, from: &Foothold, goal: &Foothold) -> f64 {
    let orders = orders_at(inputs.orders, at);
    let between = |index: i32| {
        let part = f64::from(index) / f64::from(ASKED_PLACES);
        inputs.ground.height(from.point.truncate().lerp(goal.point.truncate(), part))
    };
    let (_, lift) = orders.corrections[leg];
    let highest = (1..ASKED_PLACES).map(between).fold(from.point.z.max(goal.point.z), f64::max);
    // A foot passes through ground that is higher than the leg can step over.
    let max_height = from.point.z.max(goal.point.z) + TALLEST_STEP * inputs.legs.legs[leg].hip.z;
    highest.min(max_height) + orders.step_height + lift
}

/// Returns true if a foot deviates from its neutral position by more than a tolerance, m and rad.
fn is_away(foothold: &Foothold, leg: &Leg, pose: &Pose, tolerance: f64) -> bool {
    let hip = pose.transform_point(leg.hip.truncate());
    (foothold.point.truncate() - hip).length() > tolerance || foot_yaw(foothold, pose).abs() > tolerance
}

/// Angle from the body to the foot.
fn foot_yaw(foothold: &Foothold, pose: &Pose) -> f64 {
    Heading::default().turned(foothold.heading - pose.heading.remainder()).remainder()
}

/// Vector from the hip of a body at height `lift` to the contact point of a foot, in the robot's axes, m; and the yaw
/// of the foot relative to the body, rad.
fn hip_to_point(leg: &Leg, foot: &FootState, pose: &Pose, lift: f64) -> (DVec3, f64) {
    let point = pose.inverse_transform_point(foot.point.truncate()).extend(foot.point.z - lift);
    let yaw = Heading::default().turned(foot.heading - pose.heading.remainder()).remainder();
    (point - leg.hip, yaw)
}
