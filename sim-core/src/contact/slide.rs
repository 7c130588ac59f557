//! Sliding of a disc that its wheels push against walls: the quasi-static contact problem, and the segments of motion
//! that solve it.
//!
//! docs/motion.md, section Sliding, gives the formulas and frames and shows that the solution is unique. Each segment
//! has a closed form. It ends where the kind of contact changes, where a wall ends, or where the disc meets another
//! wall.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec2;

use super::{LengthLaw, Pace, Path, SKIN, TOUCH, first_contact};
use crate::{
    math,
    pose::Twist,
    scene::{Bounds, Segment, WallId, Walls},
};

/// Difference in rad up to which two angles count as equal.
const SAME_ANGLE: f64 = 1e-12;

/// A disc that is pushed along a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// Path of the centre without contacts, at constant twist.
    pub free: Path,
    /// Radius of the disc, m.
    pub radius: f64,
    /// Coefficient of friction between the body and walls.
    pub friction: f64,
}

/// A segment of the motion of a pushed disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slide {
    /// Path of the centre.
    pub path: Path,
    /// Duration in seconds. Infinite for a free segment, because the search for its end at the next wall is elsewhere.
    pub after: f64,
    /// Wall against which the disc is pressed, and the touched point; `None` for a free segment.
    pub against: Option<(WallId, DVec2)>,
    /// Wall at which the segment ends, if the disc did not touch that wall before.
    pub meets: Option<WallId>,
}

impl Push {
    /// Motion of the disc from the start of its free path, for at most `duration` seconds. The touched walls are
    /// determined at the start; `met` always counts as touched.
    pub fn slide(&self, walls: &Walls, met: Option<WallId>, duration: f64) -> Slide {
        let touched = self.touched(walls, met);
        if !touched.iter().any(|contact| self.is_approached(&self.free, contact, duration)) {
            return Slide { path: self.free, after: f64::INFINITY, against: None, meets: None };
        }
        let tracks: Vec<_> =
            touched.iter().filter_map(|contact| Some((contact, self.track_along(contact, false)?))).collect();
        // A wall that the disc approaches only by a rounding error exerts no pressure.
        let grazed =
            touched.iter().filter(|contact| tracks.is_empty() && self.is_approached(&self.free, contact, duration));
        let grazing: Vec<_> = grazed.filter_map(|contact| Some((contact, self.track_along(contact, true)?))).collect();
        let mut best: Option<(f64, Slide)> = None;
        for (contact, (slip, track)) in tracks.into_iter().chain(grazing) {
            if best.as_ref().is_some_and(|(min_slip, _)| *min_slip <= slip) {
                continue;
            }
            if let Some(slide) = self.follow(walls, &touched, contact, track, duration) {
                best = Some((slip, slide));
            }
        }
        best.map_or_else(|| self.rest(&touched), |(_, slide)| slide)
    }

    /// The centre is at rest for `seconds`, while the body may turn.
    pub fn resting(&self, seconds: f64, against: Option<(WallId, DVec2)>) -> Slide {
        let twist = Twist { vx: 0.0, vy: 0.0, omega: self.omega() };
        Slide { path: Path { twist, ..self.free }, after: seconds, against, meets: None }
    }

    /// Speed of the push, m/s.
    fn speed(&self) -> f64 {
        self.free.speed()
    }

    fn omega(&self) -> f64 {
        self.free.twist.omega
    }

    /// The walls in contact, in the order of their numbers.
    fn touched(&self, walls: &Walls, met: Option<WallId>) -> Vec<Contact> {
        let centre = self.free.origin;
        let push = self.free.velocity(0.0);
        let push_angle = math::atan2(push.y, push.x);
        let mut touched = Vec::new();
        walls.for_each_in(Bounds::of_disc(centre, self.radius + 2.0 * SKIN), |wall, segment| {
            let point = segment.nearest_point(centre);
            let offset = centre - point;
            let distance = math::hypot(offset.x, offset.y);
            // A wall through the centre has no side on which the disc is, so the disc may leave it to either side.
            if (distance - self.radius <= TOUCH || met == Some(wall)) && distance > 0.0 {
                let normal = offset / distance;
                let alpha = wrapped(push_angle - math::atan2(normal.y, normal.x));
                touched.push(Contact { wall, segment: *segment, point, normal, distance, alpha });
            }
        });
        touched
    }

    /// Returns true if `path`, which starts at the centre with constant twist, approaches a touched wall from its
    /// start.
    fn is_approached(&self, path: &Path, contact: &Contact, duration: f64) -> bool {
        if contact.distance - self.radius > TOUCH {
            // The disc is so far from the world's origin that the rounding of positions exceeds the skin.
            return path.velocity(0.0).dot(contact.normal) < 0.0;
        }
        first_contact(path, self.radius, &contact.segment, duration).is_some_and(|contact| contact.after == 0.0)
    }

    /// Motion that this contact allows if it is the only one: the slip speed of the wheels over the floor, m/s, and the
    /// track of the centre. `is_grazed`: the disc approaches the wall only by a rounding error, so the wall is in the
    /// way without pressure.
    fn track_along(&self, contact: &Contact, is_grazed: bool) -> Option<(f64, Track)> {
        let is_end = |fraction: f64| fraction <= 0.0 || fraction >= 1.0;
        let mut round = is_end(contact.position_along());
        let mut motion = self.motion_at(contact, round, is_grazed)?;
        let scale = 16.0 * f64::EPSILON * (self.free.origin.abs().max_element() + self.radius);
        // If the face ends here, within rounding, the disc turns around the end; if a face begins here, the disc moves
        // along it.
        let is_over = |round: bool, sense: f64| match round {
            false => contact.left_of_face(sense) <= scale,
            true => contact.angle_to_face(sense) * contact.distance <= scale,
        };
        if motion.sense != 0.0 && is_over(round, motion.sense) {
            round = !round;
            motion = self.motion_at(contact, round, is_grazed)?;
        }
        let SlideMotion { sense, regime, .. } = motion;
        let length = match round {
            _ if sense == 0.0 => 0.0,
            false => contact.left_of_face(sense),
            true => contact.angle_to_face(sense).min(TAU) * contact.distance,
        };
        let (pressed, along) = self.components(contact.alpha);
        let speed = regime.speed(self, contact, contact.alpha);
        let slip = math::hypot(pressed.max(0.0), along - speed);
        Some((slip, Track { sense, round, regime, length, seconds: motion.seconds }))
    }

    /// Motion at a contact from now on: along a face, or with `round` around an end of the wall.
    fn motion_at(&self, contact: &Contact, round: bool, is_grazed: bool) -> Option<SlideMotion> {
        let alpha = contact.alpha;
        let rate = match (round, self.regime(contact, alpha)) {
            (true, Regime::Rolling) => 0.0,
            (true, regime) => self.omega() - regime.speed(self, contact, alpha) / contact.distance,
            (false, _) => self.omega(),
        };
        let ahead = if rate == 0.0 { None } else { self.next_angle(contact, rate.signum()) };
        let (mut regime, at) = match ahead {
            Some(angle) => (self.regime(contact, alpha + 0.5 * angle), alpha + 0.5 * angle),
            None => (self.regime(contact, alpha), alpha),
        };
        if matches!(regime, Regime::Off) {
            if !is_grazed {
                return None;
            }
            let (_, along) = self.components(alpha);
            regime = Regime::Sliding(if along < self.omega() * contact.distance { -1.0 } else { 1.0 });
        }
        let speed = regime.speed(self, contact, at);
        let sense = if speed == 0.0 { 0.0 } else { speed.signum() };
        let seconds = match ahead {
            None => f64::INFINITY,
            Some(angle) if !round => angle / self.omega(),
            Some(_) if matches!(regime, Regime::Rolling) => f64::INFINITY,
            Some(angle) => self.law(contact, round, regime, sense).seconds_to_turn(angle),
        };
        Some(SlideMotion { regime, sense, seconds })
    }

    /// Components of the push in m/s, into the wall and along the contact's tangent, for the angle `alpha` from the
    /// contact's normal to the push.
    fn components(&self, alpha: f64) -> (f64, f64) {
        let (sin, cos) = math::sin_cos(alpha);
        (-self.speed() * cos, self.speed() * sin)
    }

    fn regime(&self, contact: &Contact, alpha: f64) -> Regime {
        let (pressed, along) = self.components(alpha);
        let rolling = self.omega() * contact.distance;
        if pressed <= 0.0 {
            Regime::Off
        } else if along - self.friction * pressed > rolling {
            Regime::Sliding(1.0)
        } else if along + self.friction * pressed < rolling {
            Regime::Sliding(-1.0)
        } else {
            Regime::Rolling
        }
    }

    /// Maximum speed along a contact's tangent, m/s, and the angle of friction, rad.
    fn edge(&self) -> (f64, f64) {
        (self.speed() * math::hypot(1.0, self.friction), math::atan(self.friction))
    }

    /// Signed change of alpha, in the direction of `sense`, after which the regime or the direction of motion along the
    /// wall may change.
    fn next_angle(&self, contact: &Contact, sense: f64) -> Option<f64> {
        let (max_speed, edge) = self.edge();
        let ratio = self.omega() * contact.distance / max_speed;
        let mut critical_angles = [f64::NAN; 10];
        critical_angles[..2].copy_from_slice(&[FRAC_PI_2, -FRAC_PI_2]);
        for (index, edge) in [edge, -edge].into_iter().enumerate() {
            let turned = if ratio.abs() <= 1.0 { math::asin(ratio) } else { f64::NAN };
            critical_angles[2 + 4 * index..6 + 4 * index].copy_from_slice(&[
                turned - edge,
                PI - turned - edge,
                -edge,
                PI - edge,
            ]);
        }
        // Within a quarter turn of the normal the push leads away from the wall, so a critical angle there has no effect.
        let counts = |angle: &f64| math::cos(*angle) < 1e-9;
        let ahead = critical_angles.into_iter().filter(counts).map(|critical| {
            let angle = (sense * (critical - contact.alpha)).rem_euclid(TAU);
            if angle <= SAME_ANGLE || angle >= TAU - SAME_ANGLE { TAU } else { angle }
        });
        ahead.reduce(f64::min).map(|angle| sense * angle)
    }

    /// Length covered along the track as a function of time.
    fn law(&self, contact: &Contact, round: bool, regime: Regime, sense: f64) -> LengthLaw {
        let (speed, edge) = self.edge();
        let omega = self.omega();
        match regime {
            Regime::Off => LengthLaw::Steady(0.0),
            Regime::Rolling => LengthLaw::Steady((omega * contact.distance).abs()),
            Regime::Sliding(side) => {
                let phase = contact.alpha + side * edge;
                if round {
                    LengthLaw::Round { radius: contact.distance, speed, phase, rate: omega, sense }
                } else if omega == 0.0 {
                    LengthLaw::Steady(sense * speed * math::sin(phase))
                } else {
                    LengthLaw::Wave { speed: sense * speed, phase, rate: omega }
                }
            }
        }
    }

    /// The segment along a contact's track; `None` if the track approaches another touched wall from the start.
    fn follow(
        &self,
        walls: &Walls,
        touched: &[Contact],
        contact: &Contact,
        track: Track,
        duration: f64,
    ) -> Option<Slide> {
        let against = Some((contact.wall, contact.point));
        if track.sense == 0.0 {
            return Some(self.resting(track.seconds, against));
        }
        let law = self.law(contact, track.round, track.regime, track.sense);
        let tangent = contact.normal.perp() * track.sense;
        let bend = if track.round { track.sense / contact.distance } else { 0.0 };
        let slide = Path {
            origin: self.free.origin,
            direction: tangent,
            twist: Twist::new(1.0, bend),
            pace: Pace::ConstantTwist,
        };
        let mut seconds = track.seconds.min(duration);
        let mut length = track.length;
        if seconds.is_finite() {
            length = length.min(law.length(seconds).max(0.0));
        }
        let others = touched.iter().filter(|other| other.wall != contact.wall);
        for other in others {
            if self.is_approached(&slide, other, length) {
                return None;
            }
        }
        let first = self.first_on(walls, &slide, contact.wall, length);
        let meets = first.filter(|(at, ..)| *at < length);
        if let Some((at, ..)) = meets {
            length = at;
        }
        if meets.is_some() || length == track.length {
            seconds = seconds_of(&law, length, seconds);
        }
        let path = Path { pace: Pace::Sliding { omega: self.omega(), law }, ..slide };
        let meets = meets.filter(|(.., is_fresh)| *is_fresh).map(|(_, wall, _)| wall);
        Some(Slide { path, after: seconds, against, meets })
    }

    /// The first wall other than `except` that a disc meets on `way`, a path at 1 m/s, within `length` metres: the length up to the
    /// contact, the wall, and true if the disc did not touch that wall at the start.
    fn first_on(&self, walls: &Walls, path: &Path, except: WallId, length: f64) -> Option<(f64, WallId, bool)> {
        let mut from = 0.0;
        let mut step = 4.0 * self.radius;
        while from < length {
            let to = (from + step).min(length);
            let mut first: Option<(f64, WallId, bool)> = None;
            walls.for_each_in(path.bounds(from, to).grown(self.radius + 2.0 * SKIN), |wall, segment| {
                if wall == except {
                    return;
                }
                let Some(contact) = first_contact(path, self.radius, segment, length) else { return };
                if contact.after <= to && first.is_none_or(|(at, best, _)| (contact.after, wall) < (at, best)) {
                    first = Some((contact.after, wall, contact.fresh));
                }
            });
            if first.is_some() {
                return first;
            }
            (from, step) = (to, 2.0 * step);
        }
        None
    }

    /// The disc is at rest at its contacts until the push has turned so far that a regime may change.
    fn rest(&self, touched: &[Contact]) -> Slide {
        let mut seconds = f64::INFINITY;
        let mut against: Option<(f64, &Contact)> = None;
        for contact in touched {
            let (pressed, _) = self.components(contact.alpha);
            if against.is_none_or(|(max_pressed, _)| pressed > max_pressed) {
                against = Some((pressed, contact));
            }
            if let Some(angle) = self.next_angle(contact, self.omega().signum()).filter(|_| self.omega() != 0.0) {
                seconds = seconds.min(angle / self.omega());
            }
        }
        self.resting(seconds, against.map(|(_, contact)| (contact.wall, contact.point)))
    }
}

/// Contact of the disc with a wall.
#[derive(Clone, Copy, Debug)]
struct Contact {
    wall: WallId,
    segment: Segment,
    /// The point of the wall that is nearest to the centre.
    point: DVec2,
    /// Unit vector from `point` to the centre.
    normal: DVec2,
    /// Distance of the centre from `point`, m.
    distance: f64,
    /// Angle from the normal to the push, rad counter-clockwise.
    alpha: f64,
}

impl Contact {
    /// Position of the point on the wall: 0 and 1 at its ends, 0.5 in between.
    fn position_along(&self) -> f64 {
        if self.point == self.segment.a {
            0.0
        } else if self.point == self.segment.b {
            1.0
        } else {
            0.5
        }
    }

    /// Length in metres from the point to the end of the face, along the contact's tangent (`sense` 1: to the left of
    /// the normal) or against it (-1).
    fn left_of_face(&self, sense: f64) -> f64 {
        let tangent = self.normal.perp() * sense;
        let ahead = |end: DVec2| (end - self.point).dot(tangent);
        ahead(self.segment.a).max(ahead(self.segment.b)).max(0.0)
    }

    /// Angle in rad by which the normal has to turn around the wall's end, to the left (`sense` 1) or to the right
    /// (-1), until it is perpendicular to the wall; infinite for a wall without length.
    fn angle_to_face(&self, sense: f64) -> f64 {
        let Segment { a, b } = self.segment;
        // Because of rounding, the point may differ from the wall's end.
        let is_at_a = self.point.distance_squared(a) <= self.point.distance_squared(b);
        let other = if is_at_a { b } else { a };
        let along = other - self.point;
        if along == DVec2::ZERO {
            return f64::INFINITY;
        }
        let angle = sense * math::atan2(self.normal.perp_dot(along), self.normal.dot(along));
        // The normal is perpendicular to the wall a quarter turn before the wall's direction, for either sense.
        (if angle >= 0.0 { angle } else { angle + TAU } - FRAC_PI_2).max(0.0)
    }
}

/// Kind of contact between disc and wall.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Regime {
    /// The disc is not pressed against the wall.
    Off,
    /// The disc's touching point slides along the wall: to the left of the normal (1) or to the right (-1).
    Sliding(f64),
    /// The disc's touching point does not slide: the disc rolls along the wall, or rests.
    Rolling,
}

impl Regime {
    /// Speed of the centre along the tangent, m/s, for the angle `alpha` from the normal to the push.
    fn speed(self, push: &Push, contact: &Contact, alpha: f64) -> f64 {
        let (pressed, along) = push.components(alpha);
        match self {
            Self::Off => along,
            Self::Sliding(side) => along - side * push.friction * pressed,
            Self::Rolling => push.omega() * contact.distance,
        }
    }
}

/// Motion that a contact allows for some time.
#[derive(Clone, Copy, Debug)]
struct SlideMotion {
    regime: Regime,
    /// Direction of the motion: 1 along the tangent, -1 against it, 0 at rest.
    sense: f64,
    seconds: f64,
}

/// Track of the centre at a contact.
#[derive(Clone, Copy, Debug)]
struct Track {
    sense: f64,
    /// True for a track around the wall's end, false for a track along its face.
    round: bool,
    regime: Regime,
    /// Length until the face ends, or until it begins for a track around the wall's end, m.
    length: f64,
    /// Seconds for which the regime holds.
    seconds: f64,
}

/// `angle` in rad minus whole turns, in (-pi, pi].
fn wrapped(angle: f64) -> f64 {
    let angle = angle.rem_euclid(TAU);
    if angle > PI { angle - TAU } else { angle }
}

/// Seconds, at most `max_seconds`, after which a law has covered `length` metres; `max_seconds` if the law never covers them.
fn seconds_of(law: &LengthLaw, length: f64, max_seconds: f64) -> f64 {
    if let LengthLaw::Steady(speed) = law {
        return (length / speed).min(max_seconds);
    }
    if length <= 0.0 {
        return 0.0;
    }
    let mut high = max_seconds;
    if high == f64::INFINITY {
        high = 1e-3;
        while law.length(high) < length {
            high *= 2.0;
            // A length that is not covered within 1e9 s, about 30 years, counts as never covered.
            if high > 1e9 {
                return max_seconds;
            }
        }
    } else if law.length(high) <= length {
        return max_seconds;
    }
    let mut low = 0.0;
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return high;
        }
        if law.length(middle) < length {
            low = middle;
        } else {
            high = middle;
        }
    }
}
