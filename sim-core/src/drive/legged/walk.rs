//! The chain of footfalls of a walk.
//!
//! Everything about the feet is decided at instants of the gait's own clock, 48 a period, from pose and twist just before
//! them: so it depends neither on slots nor on who asks when. What was decided before the present slot stands; what lies
//! ahead is decided anew whenever the plan of the motion changes.

use std::collections::VecDeque;
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::{
    FootState, Footfall, LegCommand, LegCommandError, Legs, Stance,
    curve::{HEEL_OFF, Natural, TOE_OFF, natural_pitch},
    gait::{Clock, GRID, Gait},
    glide::{Glide, share, smooth},
    leg::{Foot, LOWEST_HIP, Leg, Sole},
};
use crate::{
    drive::{HISTORY, Piece},
    math,
    pose::{Heading, Pose, Twist},
    scene::Ground,
    time::Time,
};

/// A foot nearer to its place than this (m, and rad) stays where it is when the robot stands. Our choice.
const AT_PLACE: f64 = 5e-3;
/// A change of its goal by less does not turn a foot in the air from its way, m and rad. Our choice.
const SAME_GOAL: f64 = 1e-3;
/// A foot keeps its goal for this last share of its way. Our choice.
const KEPT: f64 = 0.25;
/// A foot that the body has turned away from by more than this is taken up before its turn, rad: 60 degrees. Our choice.
const MOST_TWISTED: f64 = std::f64::consts::FRAC_PI_3;
/// A foot in the air turns from its goal by this many excursions at most, times the share of its way that is left. Our choice.
const MOST_TURNED: f64 = 1.6;
/// The greatest share of the natural curves. Our choice.
const MOST_LEVEL: f64 = 1.2;
/// A change of that share by less is none. Our choice.
const SAME_LEVEL: f64 = 0.02;
/// Places that are tried for a foot between its goal and the body.
const TRIED_PLACES: i32 = 16;
/// Places between two footholds at which the ground is asked for its height.
const ASKED_PLACES: i32 = 8;
/// Height of a step up or down that a leg takes, as a share of its hip's height. Our choice.
const TALLEST_STEP: f64 = 0.4;
/// Steps of a leg that are remembered at most, until somebody asks for footfalls.
const REMEMBERED: usize = 64;

/// One piece of the body's motion, from its start on until the next.
#[derive(Clone, Copy, Debug)]
pub(in crate::drive) struct Course {
    pub piece: Piece,
    /// From the robot's centre to its axle along x, m.
    pub axis_offset: f64,
    /// The robot was put here.
    pub is_placed: bool,
}

/// The planned motion of the body, as far as its legs follow it.
pub(in crate::drive) trait Plan {
    /// Number of its changes so far.
    fn revision(&self) -> u64;

    /// The pieces of motion since the one in force just before `from`, until `to`.
    fn courses(&mut self, from: Time, to: Time) -> Vec<Course>;
}

impl Course {
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

/// What the legs are told.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::drive) struct LegOrders {
    pub gait: usize,
    pub step_height: f64,
    /// For each leg the shift of its coming foothold in the robot's frame and its additional lift.
    pub corrections: Vec<(DVec2, f64)>,
}

/// The feet of one robot as a function of virtual time.
#[derive(Clone, Debug)]
pub(in crate::drive) struct Walk {
    legs: Arc<Legs>,
    ground: Arc<Ground>,
    /// By leg what natural walking makes of it.
    natural: Vec<Option<Natural>>,
    /// In ascending order, the first from the start of all times.
    orders: VecDeque<(Time, LegOrders)>,
    /// Counts the commands.
    revision: u64,
    /// What was decided before the present slot.
    firm: Steps,
    /// What is decided beyond, for these revisions of the motion and of the orders.
    ahead: Option<((u64, u64), Steps)>,
    /// Footfalls before this have been asked for.
    taken: Time,
}

/// Where a foot stands: the point under the ankle of a level foot, or the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Foothold {
    point: DVec3,
    heading: f64,
}

/// One step of a foot: off the ground, through the air, and then standing until the next.
#[derive(Clone, Debug)]
struct Step {
    /// From when on it rolls over its toe; `lift_off` for one that does not.
    heel_off: Time,
    /// How long rolling off takes, if it is not cut short.
    roll: Time,
    lift_off: Time,
    touch_down: Time,
    /// How long it is to stand then.
    stand: Time,
    from: Foothold,
    /// Angle of the foot at `heel_off`.
    from_pitch: f64,
    /// The share of the natural angles of a foot that it follows.
    level: f64,
    /// Where it goes, and what it clears on its way: each from an instant on, the first from lift-off.
    goals: Vec<(Time, Foothold, f64)>,
    /// The robot was put there.
    is_placed: bool,
}

/// All feet from some instant in the past until `until`.
#[derive(Clone, Debug)]
struct Steps {
    until: Time,
    /// Clocks with the share of the gait's natural bob that the body follows; the last one counts now.
    clocks: Vec<(Clock, Glide)>,
    is_walking: bool,
    feet: Vec<VecDeque<Step>>,
}

/// What the decisions depend on besides the motion.
struct Around<'a> {
    legs: &'a Legs,
    ground: &'a Ground,
    natural: &'a [Option<Natural>],
    orders: &'a VecDeque<(Time, LegOrders)>,
}

/// The robot at an instant of decision, as it was just before.
struct Present {
    at: Time,
    pose: Pose,
    twist: Twist,
}

impl Walk {
    pub fn new(legs: Arc<Legs>, ground: Arc<Ground>) -> Self {
        let orders = LegOrders {
            gait: 0,
            step_height: legs.step_height,
            corrections: vec![(DVec2::ZERO, 0.0); legs.legs.len()],
        };
        let natural = legs.legs.iter().map(Natural::new).collect();
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
            taken: never,
        }
    }

    pub fn legs(&self) -> &Legs {
        &self.legs
    }

    pub fn ground(&self) -> &Ground {
        &self.ground
    }

    pub fn orders_at(&self, at: Time) -> &LegOrders {
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
                let most = self.legs.legs.iter().map(Leg::reach).fold(0.0, f64::max);
                orders.step_height =
                    if (0.0..=most).contains(&height) { height } else { return Err(LegCommandError::Length) };
            }
            LegCommand::Correct { leg, shift, lift } => {
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
        let footfalls = steps.footfalls(self.taken, until);
        self.taken = self.taken.max(until);
        footfalls
    }

    /// What happened before `end`, the end of the present slot, stands.
    pub fn commit(&mut self, plan: &mut impl Plan, end: Time) {
        let last = end - Time(1);
        if last <= self.firm.until {
            return;
        }
        self.decide(plan, last, true);
        let past = self.taken.min(end - HISTORY);
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

    /// Decides all until `at`: for good, or for the present plan.
    fn decide(&mut self, plan: &mut impl Plan, at: Time, is_firm: bool) {
        let key = (plan.revision(), self.revision);
        let mut steps = match self.ahead.take() {
            Some((known, steps)) if known == key && !(is_firm && steps.until > at) => steps,
            _ => self.firm.clone(),
        };
        if steps.until < at {
            let courses = plan.courses(steps.until, at);
            let Self { legs, ground, natural, orders, .. } = self;
            let around = Around { legs, ground, natural, orders };
            steps.extend(&around, &courses, at);
        }
        if is_firm {
            self.firm = steps;
        } else {
            self.ahead = Some((key, steps));
        }
    }
}

fn orders_at(orders: &VecDeque<(Time, LegOrders)>, at: Time) -> &LegOrders {
    let known = orders.iter().rev().find(|(since, _)| *since <= at).or(orders.front());
    known.map(|(_, orders)| orders).expect("a walk has orders")
}

impl Steps {
    /// Decides all after `until` up to `to`. `courses`: the motion's pieces since the one in force just before `until`.
    fn extend(&mut self, around: &Around, courses: &[Course], to: Time) {
        loop {
            let opening =
                courses.iter().find(|course| course.start() > self.until).filter(|course| course.start() <= to);
            let order = around.orders.iter().find(|(since, _)| *since > self.until).filter(|(since, _)| *since <= to);
            let tick = self.clock().map(|clock| clock.next_after(self.until)).map(|index| (index, self.instant(index)));
            let tick = tick.filter(|(_, instant)| *instant <= to);
            let first = [opening.map(Course::start), order.map(|(since, _)| *since), tick.map(|(_, instant)| instant)];
            let Some(at) = first.into_iter().flatten().min() else { break };
            if let Some((index, _)) = tick.filter(|(_, instant)| *instant == at) {
                self.tick(around, &present(courses, at), index);
            }
            if order.is_some_and(|(since, _)| *since == at) {
                self.change_gait(around, at);
            }
            if let Some(course) = opening.filter(|course| course.start() == at) {
                self.open(around, course);
            }
            self.until = at;
        }
        self.until = to;
    }

    /// The clock that counts, while the robot walks.
    fn clock(&self) -> Option<&Clock> {
        self.clocks.last().map(|(clock, _)| clock).filter(|_| self.is_walking)
    }

    fn instant(&self, index: i64) -> Time {
        self.clock().map_or(Time::NEVER, |clock| clock.instant(index))
    }

    /// A piece of motion begins.
    fn open(&mut self, around: &Around, course: &Course) {
        let at = course.start();
        if course.is_placed || self.feet.iter().all(VecDeque::is_empty) {
            self.place(around, at, &course.pose(at));
        }
        if !self.is_walking && !course.twist(at).is_zero() {
            let index = orders_at(around.orders, at).gait;
            self.clocks.push((Clock::starting(at, &around.legs.gaits[index], index), Glide::default()));
            self.is_walking = true;
        }
    }

    /// Puts all feet at their places.
    fn place(&mut self, around: &Around, at: Time, pose: &Pose) {
        for (leg, steps) in around.legs.legs.iter().zip(&mut self.feet) {
            let place = pose.transform_point(leg.hip.truncate());
            let from = Foothold { point: place.extend(around.ground.height(place)), heading: pose.heading.remainder() };
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

    fn change_gait(&mut self, around: &Around, at: Time) {
        let index = orders_at(around.orders, at).gait;
        let Some(clock) = self.clock().copied().filter(|clock| clock.gait != index) else { return };
        let gait = &around.legs.gaits[index];
        let (_, level) = self.clocks.last_mut().expect("it walks");
        let goal = level.goal();
        level.aim(at, Time(gait.period.0 / 2), 0.0);
        let mut level = Glide::default();
        level.aim(at, Time(gait.period.0 / 2), goal);
        self.clocks.push((clock.changed(at, gait, index), level));
    }

    /// An instant of decision.
    fn tick(&mut self, around: &Around, present: &Present, index: i64) {
        let Some(clock) = self.clock().copied() else { return };
        let is_moving = !present.twist.is_zero();
        let mut is_settled = !is_moving;
        for number in 0..around.legs.legs.len() {
            if around.legs.legs[number].wheel.is_none() {
                is_settled &= self.tick_foot(around, present, &clock, index, number);
            }
        }
        self.follow_speed(around, present);
        if is_settled && self.clocks.iter().all(|(_, level)| level.goal() == 0.0 && level.is_still(present.at)) {
            self.is_walking = false;
        }
    }

    /// The same for one foot; true if it stands at its place.
    fn tick_foot(&mut self, around: &Around, present: &Present, clock: &Clock, index: i64, number: usize) -> bool {
        let at = present.at;
        let leg = &around.legs.legs[number];
        let gait = &around.legs.gaits[clock.gait];
        let is_moving = !present.twist.is_zero();
        let soon = (clock.instant(index + 2) - at).seconds();
        let last = self.feet[number].back().expect("a foot stands somewhere");
        if at <= last.lift_off && last.heel_off < at {
            // It rolls off, and its goal is not yet needed; cut short where the leg would not reach.
            let is_cut = at < last.lift_off && self.is_left_behind(around, number, present, soon);
            let touch_down = if is_cut { at + (last.touch_down - last.lift_off) } else { last.touch_down };
            let goal = self.goal(around, present, number, clock, touch_down);
            let apex = apex(around, at, number, &last.from, &goal);
            let step = self.feet[number].back_mut().expect("it rolls");
            if is_cut {
                (step.lift_off, step.touch_down) = (at, touch_down);
            }
            step.goals = vec![(step.lift_off, goal, apex)];
            return false;
        }
        if at < last.touch_down {
            let (left, whole) = ((last.touch_down - at).seconds(), (last.touch_down - last.lift_off).seconds());
            if left > KEPT * whole {
                let goal = self.goal(around, present, number, clock, last.touch_down);
                let goal = last.turnable(goal, MOST_TURNED * around.legs.excursion() * left / whole, around.ground);
                let apex = apex(around, at, number, &last.from, &goal);
                self.feet[number].back_mut().expect("it is in the air").turn_to(at, goal, apex);
            }
            return false;
        }
        let from = last.standing();
        let is_displaced = is_away(&from, leg, &present.pose, AT_PLACE);
        let slot = gait.slot(number);
        let until_slot = (slot - index).rem_euclid(GRID);
        let level = self.level(around, present, gait, number);
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
            is_moving && self.is_left_behind(around, number, present, soon)
        };
        if is_lifted {
            let mut step = step(at, at, clock.period_at(index));
            let goal = self.goal(around, present, number, clock, step.touch_down);
            step.goals = vec![(at, goal, apex(around, at, number, &from, &goal))];
            self.feet[number].push_back(step);
        } else if level > 0.0 && until_slot == gait.rolling() && from_pitch == 0.0 {
            let slot = index + until_slot;
            let step = step(at, clock.instant(slot), clock.period_at(slot));
            self.feet[number].push_back(step);
            return false;
        }
        !is_lifted && !is_displaced
    }

    /// The share of the natural curves that a leg follows: its forward speed over that of the source.
    fn level(&self, around: &Around, present: &Present, gait: &Gait, number: usize) -> f64 {
        let Some(natural) = around.natural[number].as_ref().filter(|_| gait.is_natural) else { return 0.0 };
        let Twist { vx, omega, .. } = present.twist;
        let speed = vx - omega * around.legs.legs[number].hip.y;
        (speed * gait.period.seconds() / natural.stride).clamp(0.0, MOST_LEVEL)
    }

    /// The body goes up and down as much as it is fast.
    fn follow_speed(&mut self, around: &Around, present: &Present) {
        let Some((clock, level)) = self.clocks.last() else { return };
        let gait = &around.legs.gaits[clock.gait];
        let count = around.legs.legs.len();
        let goal = (0..count).map(|leg| self.level(around, present, gait, leg)).sum::<f64>() / count as f64;
        let span = Time(gait.period.0 / 2);
        if (goal - level.goal()).abs() > SAME_LEVEL || goal == 0.0 && level.goal() != 0.0 {
            self.clocks.last_mut().expect("it walks").1.aim(present.at, span, goal);
        }
    }

    /// Whether a foot on the ground comes to the end of its leg's reach, or of its turn, within `soon` seconds.
    fn is_left_behind(&self, around: &Around, number: usize, present: &Present, soon: f64) -> bool {
        let leg = &around.legs.legs[number];
        let foot = step_at(&self.feet[number], present.at).foot(present.at, leg, None);
        let lowest = self.base(present.at, around.legs) + LOWEST_HIP * leg.hip.z;
        let state = |pose: &Pose| {
            let (to_point, yaw) = hip_to_point(leg, &foot, pose, 0.0);
            let (sin, cos) = math::sin_cos(-yaw);
            let offset = DVec2::new(cos, sin).rotate(to_point.truncate());
            (foot.point.z + leg.greatest_height(offset, foot.sole).unwrap_or(f64::NEG_INFINITY), yaw.abs())
        };
        let (now, yaw_now) = state(&present.pose);
        let (then, yaw_then) = state(&present.pose.moved(present.twist.scaled(soon)));
        then < lowest && then <= now || yaw_then > MOST_TWISTED && yaw_then > yaw_now
    }

    /// Where a foot shall come down: under the body in the middle of its time on the ground, if the body goes on as now.
    fn goal(&self, around: &Around, present: &Present, number: usize, clock: &Clock, touch_down: Time) -> Foothold {
        let leg = &around.legs.legs[number];
        let (shift, _) = orders_at(around.orders, present.at).corrections[number];
        let gait = &around.legs.gaits[clock.gait];
        let slot = gait.slot(number);
        // A natural gait does not stand in the middle under the hip.
        let ahead = around.natural[number].as_ref().map_or(0.0, |natural| natural.ahead);
        let shift = shift + DVec2::new(ahead * self.level(around, present, gait, number), 0.0);
        let seconds = (touch_down - present.at).seconds();
        let stands = (clock.next_slot(touch_down, slot) - touch_down).seconds();
        let then = |seconds| present.pose.moved(present.twist.scaled(seconds));
        let (at_touch_down, at_middle) = (then(seconds), then(seconds + 0.5 * stands));
        let place = leg.hip.truncate();
        let nearest = at_touch_down.transform_point(place);
        let wanted = at_middle.transform_point(place + shift) - nearest;
        let wanted = wanted.clamp_length_max(around.legs.excursion());
        let base = self.base(present.at, around.legs);
        let tallest = TALLEST_STEP * leg.hip.z;
        let heading = at_middle.heading.remainder();
        // Towards the body, until a place is not too high or too deep.
        for tried in 0..=TRIED_PLACES {
            let place = nearest + wanted * (1.0 - f64::from(tried) / f64::from(TRIED_PLACES));
            let height = around.ground.height(place);
            if (height - base).abs() <= tallest {
                return Foothold { point: place.extend(height), heading };
            }
        }
        let place = nearest + wanted;
        let height = around.ground.height(place).clamp(base - tallest, base + tallest);
        Foothold { point: place.extend(height), heading }
    }

    /// Mean height of the footholds at `at`.
    fn base(&self, at: Time, legs: &Legs) -> f64 {
        let heights = self.feet.iter().zip(&legs.legs).filter(|(_, leg)| leg.wheel.is_none());
        let (sum, count) =
            heights.fold((0.0, 0.0), |(sum, count), (steps, _)| (sum + step_at(steps, at).base(at), count + 1.0));
        if count > 0.0 { sum / count } else { 0.0 }
    }

    /// What natural walking adds to the height of the body at `at`.
    fn bob(&self, legs: &Legs, natural: &[Option<Natural>], at: Time) -> f64 {
        let Some((leg, Some(natural))) = legs.legs.first().zip(natural.first()) else { return 0.0 };
        let of_clock = |(clock, level): &(Clock, Glide)| {
            let level = level.at(at);
            if clock.opened > at || level == 0.0 {
                return 0.0;
            }
            let gait = &legs.gaits[clock.gait];
            // Since the heel of the first leg has struck.
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

    /// Forgets how it was before `past`.
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

    fn stance(&self, legs: &Legs, natural: &[Option<Natural>], ground: &Ground, at: Time, pose: &Pose) -> Stance {
        let rolling = |leg: &Leg| {
            let place = pose.transform_point(leg.hip.truncate());
            let point = place.extend(ground.height(place));
            FootState { point, sole: Sole::default(), heading: pose.heading.remainder(), is_down: true }
        };
        let foot = |((leg, steps), natural): ((&Leg, &VecDeque<Step>), &Option<Natural>)| match leg.wheel {
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
            let most = foot.point.z + leg.greatest_height(offset, foot.sole).unwrap_or(0.0) - leg.hip.z;
            // A foot in the air follows the body, not the body the foot.
            let weight = if foot.is_down { 1.0 } else { step_at(steps, at).nearness(at) };
            lift = lift.min(free + (most - free).min(0.0) * weight);
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
    /// Where it stands in the end, as far as is known.
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

    /// Its goal and what it clears, each on its way to the last.
    fn goal_at(&self, at: Time) -> (Foothold, f64) {
        let (_, mut goal, mut apex) = self.goals[0];
        for pair in self.goals.windows(2) {
            let [(_, before, low), (since, after, high)] = [pair[0], pair[1]];
            let part = smooth(share(at, since, self.touch_down - since));
            goal.point += (after.point - before.point) * part;
            goal.heading += Heading::default().turned(after.heading - before.heading).remainder() * part;
            apex += (high - low) * part;
        }
        (goal, apex)
    }

    /// What it adds to the height of the body.
    fn base(&self, at: Time) -> f64 {
        let part = smooth(share(at, self.lift_off, self.touch_down - self.lift_off));
        let (goal, _) = self.goal_at(at);
        self.from.point.z + (goal.point.z - self.from.point.z) * part
    }

    /// How near it is to the ground in time: 1 at lift-off and touch-down, 0 in the middle.
    fn nearness(&self, at: Time) -> f64 {
        let part = share(at, self.lift_off, self.touch_down - self.lift_off);
        1.0 - smooth(4.0 * part) + smooth(4.0 * part - 3.0)
    }

    /// Where a foot can be turned to that goes to its last goal, by `most` metres at most.
    fn turnable(&self, goal: Foothold, most: f64, ground: &Ground) -> Foothold {
        let last = self.standing();
        let turn = (goal.point - last.point).truncate();
        if turn.length() <= most {
            return goal;
        }
        let place = last.point.truncate() + turn.clamp_length_max(most);
        let tallest = (last.point.z - goal.point.z).abs();
        let height = ground.height(place).clamp(last.point.z - tallest, last.point.z + tallest);
        Foothold { point: place.extend(height), heading: goal.heading }
    }

    /// Angle of the foot at `at`, toes up, rad.
    fn pitch(&self, at: Time, leg: &Leg) -> f64 {
        if leg.foot.is_none() || self.level == 0.0 && self.from_pitch == 0.0 {
            return 0.0;
        }
        if at >= self.touch_down {
            let stood = share(at, self.touch_down, self.stand);
            return if stood * TOE_OFF < HEEL_OFF { self.level * natural_pitch(stood * TOE_OFF) } else { 0.0 };
        }
        if at < self.lift_off {
            return self.rolled(at);
        }
        let natural = |part: f64| self.level * natural_pitch(TOE_OFF + (1.0 - TOE_OFF) * part);
        let part = share(at, self.lift_off, self.touch_down - self.lift_off);
        natural(part) + (self.pitch_at_lift_off() - natural(0.0)) * (1.0 - smooth(2.0 * part))
    }

    /// Angle of a foot that rolls off, rad.
    fn rolled(&self, at: Time) -> f64 {
        let part = share(at, self.heel_off, self.roll);
        self.level * natural_pitch(HEEL_OFF + (TOE_OFF - HEEL_OFF) * part)
    }

    fn pitch_at_lift_off(&self) -> f64 {
        if self.heel_off < self.lift_off { self.rolled(self.lift_off) } else { self.from_pitch }
    }

    fn foot(&self, at: Time, leg: &Leg, natural: Option<&Natural>) -> FootState {
        let pitch = self.pitch(at, leg);
        let shape = leg.foot.unwrap_or(Foot { heel: 0.0, toe: 0.0, height: 0.0 });
        // On heel, toe or the whole sole.
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
        let part = share(at, self.lift_off, self.touch_down - self.lift_off);
        // It leaves the ground with its toe and comes down on its heel.
        let leaving = if self.pitch_at_lift_off() > 0.0 { -shape.heel } else { shape.toe };
        let ahead = leaving - (leaving + shape.heel) * smooth(part);
        let (start, target) = (self.from.ahead(leaving), goal.ahead(-shape.heel));
        let way = natural.map_or(DVec2::ZERO, |natural| natural.way(part));
        let gone = smooth(part) + (way.x - smooth(part)) * self.level.min(1.0);
        let place = start.truncate().lerp(target.truncate(), gone);
        let end = if part < 0.5 { start.z } else { target.z };
        let height = end + (apex - end) * smooth(2.5 * part.min(1.0 - part)) + self.level * way.y;
        // Neither heel nor toe goes below the line between the footholds.
        let sin = math::sin(pitch);
        let deepest = ((-shape.heel - ahead) * sin).min((shape.toe - ahead) * sin);
        let height = height.max(start.z + (target.z - start.z) * smooth(part) - deepest);
        let turn = Heading::default().turned(goal.heading - self.from.heading).remainder();
        FootState {
            point: place.extend(height),
            sole: Sole { ahead, pitch },
            heading: self.from.heading + turn * smooth(part),
            is_down: false,
        }
    }
}

impl Foothold {
    /// The point of the ground on which the place `ahead` of the ankle on a level sole stands.
    fn ahead(&self, ahead: f64) -> DVec3 {
        let (sin, cos) = math::sin_cos(self.heading);
        self.point + DVec3::new(cos, sin, 0.0) * ahead
    }
}

/// The step in force at `at`.
fn step_at(steps: &VecDeque<Step>, at: Time) -> &Step {
    let known = steps.iter().rev().find(|step| step.heel_off <= at).or(steps.front());
    known.expect("a foot stands somewhere")
}

/// The robot just before `at`.
fn present(courses: &[Course], at: Time) -> Present {
    let before = courses.iter().rev().find(|course| course.start() < at).or(courses.first());
    let course = before.expect("a motion has a piece");
    Present { at, pose: course.pose(at), twist: course.twist(at - Time(1)) }
}

/// What a foot clears on its way: the ground in between, and what is told.
fn apex(around: &Around, at: Time, leg: usize, from: &Foothold, goal: &Foothold) -> f64 {
    let orders = orders_at(around.orders, at);
    let between = |index: i32| {
        let part = f64::from(index) / f64::from(ASKED_PLACES);
        around.ground.height(from.point.truncate().lerp(goal.point.truncate(), part))
    };
    let (_, lift) = orders.corrections[leg];
    let highest = (1..ASKED_PLACES).map(between).fold(from.point.z.max(goal.point.z), f64::max);
    // Where the ground in between is higher than the leg can go over, it goes through.
    let most = from.point.z.max(goal.point.z) + TALLEST_STEP * around.legs.legs[leg].hip.z;
    highest.min(most) + orders.step_height + lift
}

/// Whether a foot is away from its place by more than a tolerance, m and rad.
fn is_away(foothold: &Foothold, leg: &Leg, pose: &Pose, tolerance: f64) -> bool {
    let place = pose.transform_point(leg.hip.truncate());
    (foothold.point.truncate() - place).length() > tolerance || twisted(foothold, pose).abs() > tolerance
}

/// Angle from the body to the foot.
fn twisted(foothold: &Foothold, pose: &Pose) -> f64 {
    Heading::default().turned(foothold.heading - pose.heading.remainder()).remainder()
}

/// From the hip of a body at `lift` to the point of a foot, in the robot's axes, and the foot's angle to the body.
fn hip_to_point(leg: &Leg, foot: &FootState, pose: &Pose, lift: f64) -> (DVec3, f64) {
    let point = pose.inverse_transform_point(foot.point.truncate()).extend(foot.point.z - lift);
    let yaw = Heading::default().turned(foot.heading - pose.heading.remainder()).remainder();
    (point - leg.hip, yaw)
}
