//! A disc that its wheels push against walls: the quasi-static contact problem, and the stretch of motion that comes of it.
//!
//! Formulas, frames and why the solution is unique: docs/motion.md, section Sliding. A stretch is a closed form, and ends where
//! another one begins: at an angle at which what holds the body changes, at an end of a wall, at another wall.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec2;

use super::{Law, Pace, Path, SKIN, TOUCH, first_contact};
use crate::{
    math,
    pose::Twist,
    scene::{Bounds, Segment, WallId, Walls},
};

/// Angles in rad that are nearer than this count as equal.
const SAME_ANGLE: f64 = 1e-12;

/// A disc under a push.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Push {
    /// Where the centre would go without contacts: a path of even pace.
    pub free: Path,
    /// Radius of the disc, m.
    pub radius: f64,
    /// Coefficient of friction between the body and walls.
    pub friction: f64,
}

/// A stretch of the motion of a pushed disc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slide {
    /// Path of the centre.
    pub path: Path,
    /// Seconds until something changes; of a free stretch infinite, whatever it meets.
    pub after: f64,
    /// What the disc is pressed against; `None` for a free stretch.
    pub against: Option<(WallId, DVec2)>,
    /// What ends the stretch, if it is a wall that was not touched before.
    pub meets: Option<WallId>,
}

impl Push {
    /// How the disc goes on from the start of its free path, with the walls that it touches there, `met` among them, for at most
    /// `duration` seconds.
    pub fn slide(&self, walls: &Walls, met: Option<WallId>, duration: f64) -> Slide {
        let touched = self.touched(walls, met);
        if !touched.iter().any(|contact| self.is_approached(&self.free, contact, duration)) {
            return Slide { path: self.free, after: f64::INFINITY, against: None, meets: None };
        }
        let tracks: Vec<_> =
            touched.iter().filter_map(|contact| Some((contact, self.track_along(contact, false)?))).collect();
        // What is approached by a rounding error alone is pressed by nothing.
        let grazed =
            touched.iter().filter(|contact| tracks.is_empty() && self.is_approached(&self.free, contact, duration));
        let grazing: Vec<_> = grazed.filter_map(|contact| Some((contact, self.track_along(contact, true)?))).collect();
        let mut best: Option<(f64, Slide)> = None;
        for (contact, (slip, track)) in tracks.into_iter().chain(grazing) {
            if best.as_ref().is_some_and(|(least, _)| *least <= slip) {
                continue;
            }
            if let Some(slide) = self.follow(walls, &touched, contact, track, duration) {
                best = Some((slip, slide));
            }
        }
        best.map_or_else(|| self.rest(&touched), |(_, slide)| slide)
    }

    /// The disc stays where it is, though it turns, for `seconds`.
    pub fn resting(&self, seconds: f64, against: Option<(WallId, DVec2)>) -> Slide {
        let twist = Twist { vx: 0.0, vy: 0.0, omega: self.omega() };
        Slide { path: Path { twist, ..self.free }, after: seconds, against, meets: None }
    }

    /// Speed that is pushed for, m/s.
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
            // Of a wall through the centre both sides are equal: it may go to either.
            if (distance - self.radius <= TOUCH || met == Some(wall)) && distance > 0.0 {
                let normal = offset / distance;
                let alpha = wrapped(push_angle - math::atan2(normal.y, normal.x));
                touched.push(Contact { wall, segment: *segment, point, normal, distance, alpha });
            }
        });
        touched
    }

    /// Whether a path that starts at the centre, of even pace, comes nearer to a touched wall from its start on.
    fn is_approached(&self, path: &Path, contact: &Contact, duration: f64) -> bool {
        if contact.distance - self.radius > TOUCH {
            // So far from the origin of the world that positions have lost the digits of the skin.
            return path.velocity(0.0).dot(contact.normal) < 0.0;
        }
        first_contact(path, self.radius, &contact.segment, duration).is_some_and(|contact| contact.after == 0.0)
    }

    /// How the contact alone would let the disc go: speed of its slip over the floor, and its track.
    /// `is_grazed`: it is pressed by nothing, but in the way.
    fn track_along(&self, contact: &Contact, is_grazed: bool) -> Option<(f64, Track)> {
        let is_end = |share: f64| share <= 0.0 || share >= 1.0;
        let mut round = is_end(contact.share());
        let mut motion = self.motion_at(contact, round, is_grazed)?;
        let scale = 16.0 * f64::EPSILON * (self.free.origin.abs().max_element() + self.radius);
        // A face of which nothing is left is an end, and an end whose face begins here is a face.
        let is_over = |round: bool, sense: f64| match round {
            false => contact.left_of_face(sense) <= scale,
            true => contact.angle_to_face(sense) * contact.distance <= scale,
        };
        if motion.sense != 0.0 && is_over(round, motion.sense) {
            round = !round;
            motion = self.motion_at(contact, round, is_grazed)?;
        }
        let Motion { sense, regime, .. } = motion;
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

    /// What holds the disc at a contact from now on: against a face, or around a point.
    fn motion_at(&self, contact: &Contact, round: bool, is_grazed: bool) -> Option<Motion> {
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
        Some(Motion { regime, sense, seconds })
    }

    /// Pressing and tangential part of the push where it makes the angle `alpha` with the contact's normal, m/s.
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

    /// Greatest speed along a contact's tangent, m/s, and the angle of friction.
    fn edge(&self) -> (f64, f64) {
        (self.speed() * math::hypot(1.0, self.friction), math::atan(self.friction))
    }

    /// The angle by which alpha has to change in the direction of `sense` until what holds the disc, or the sense in which it goes,
    /// may change.
    fn next_angle(&self, contact: &Contact, sense: f64) -> Option<f64> {
        let (most, edge) = self.edge();
        let ratio = self.omega() * contact.distance / most;
        let mut marks = [f64::NAN; 10];
        marks[..2].copy_from_slice(&[FRAC_PI_2, -FRAC_PI_2]);
        for (index, edge) in [edge, -edge].into_iter().enumerate() {
            let turned = if ratio.abs() <= 1.0 { math::asin(ratio) } else { f64::NAN };
            marks[2 + 4 * index..6 + 4 * index].copy_from_slice(&[turned - edge, PI - turned - edge, -edge, PI - edge]);
        }
        // The disc is not pressed at an angle of less than a quarter turn: what would change there changes nothing.
        let counts = |mark: &f64| math::cos(*mark) < 1e-9;
        let ahead = marks.into_iter().filter(counts).map(|mark| {
            let angle = (sense * (mark - contact.alpha)).rem_euclid(TAU);
            if angle <= SAME_ANGLE || angle >= TAU - SAME_ANGLE { TAU } else { angle }
        });
        ahead.reduce(f64::min).map(|angle| sense * angle)
    }

    /// The length along the track, as a function of time.
    fn law(&self, contact: &Contact, round: bool, regime: Regime, sense: f64) -> Law {
        let (speed, edge) = self.edge();
        let omega = self.omega();
        match regime {
            Regime::Off => Law::Steady(0.0),
            Regime::Rolling => Law::Steady((omega * contact.distance).abs()),
            Regime::Sliding(side) => {
                let phase = contact.alpha + side * edge;
                if round {
                    Law::Round { radius: contact.distance, speed, phase, rate: omega, sense }
                } else if omega == 0.0 {
                    Law::Steady(sense * speed * math::sin(phase))
                } else {
                    Law::Wave { speed: sense * speed, phase, rate: omega }
                }
            }
        }
    }

    /// The slide along a contact's track; `None` if another touched wall is in the way from the start.
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
        let way = Path { origin: self.free.origin, direction: tangent, twist: Twist::new(1.0, bend), pace: Pace::Even };
        let mut seconds = track.seconds.min(duration);
        let mut length = track.length;
        if seconds.is_finite() {
            length = length.min(law.length(seconds).max(0.0));
        }
        let others = touched.iter().filter(|other| other.wall != contact.wall);
        for other in others {
            if self.is_approached(&way, other, length) {
                return None;
            }
        }
        let first = self.first_on(walls, &way, contact.wall, length);
        let meets = first.filter(|(at, ..)| *at < length);
        if let Some((at, ..)) = meets {
            length = at;
        }
        if meets.is_some() || length == track.length {
            seconds = seconds_of(&law, length, seconds);
        }
        let path = Path { pace: Pace::Led { omega: self.omega(), law }, ..way };
        let meets = meets.filter(|(.., is_fresh)| *is_fresh).map(|(_, wall, _)| wall);
        Some(Slide { path, after: seconds, against, meets })
    }

    /// The first wall other than `but` that a disc meets on its `way`, at 1 m/s, within `length` metres: where, which, and
    /// whether it is touched anew.
    fn first_on(&self, walls: &Walls, way: &Path, but: WallId, length: f64) -> Option<(f64, WallId, bool)> {
        let mut from = 0.0;
        let mut stretch = 4.0 * self.radius;
        while from < length {
            let to = (from + stretch).min(length);
            let mut first: Option<(f64, WallId, bool)> = None;
            walls.for_each_in(way.bounds(from, to).grown(self.radius + 2.0 * SKIN), |wall, segment| {
                if wall == but {
                    return;
                }
                let Some(contact) = first_contact(way, self.radius, segment, length) else { return };
                if contact.after <= to && first.is_none_or(|(at, best, _)| (contact.after, wall) < (at, best)) {
                    first = Some((contact.after, wall, contact.fresh));
                }
            });
            if first.is_some() {
                return first;
            }
            (from, stretch) = (to, 2.0 * stretch);
        }
        None
    }

    /// The disc rests among its contacts, until the push has turned so far that it may not.
    fn rest(&self, touched: &[Contact]) -> Slide {
        let mut seconds = f64::INFINITY;
        let mut against: Option<(f64, &Contact)> = None;
        for contact in touched {
            let (pressed, _) = self.components(contact.alpha);
            if against.is_none_or(|(most, _)| pressed > most) {
                against = Some((pressed, contact));
            }
            if let Some(angle) = self.next_angle(contact, self.omega().signum()).filter(|_| self.omega() != 0.0) {
                seconds = seconds.min(angle / self.omega());
            }
        }
        self.resting(seconds, against.map(|(_, contact)| (contact.wall, contact.point)))
    }
}

/// A touched wall.
#[derive(Clone, Copy, Debug)]
struct Contact {
    wall: WallId,
    segment: Segment,
    /// The wall's point that is nearest to the centre.
    point: DVec2,
    /// Unit vector from there to the centre.
    normal: DVec2,
    /// Distance of the centre from there, m.
    distance: f64,
    /// Angle of the push from the normal, rad.
    alpha: f64,
}

impl Contact {
    /// Where along the wall the point is: 0 at one end, 1 at the other.
    fn share(&self) -> f64 {
        if self.point == self.segment.a {
            0.0
        } else if self.point == self.segment.b {
            1.0
        } else {
            0.5
        }
    }

    /// Length of the face from the point on, m, along the contact's tangent (`sense` 1: left of the normal) or against it.
    fn left_of_face(&self, sense: f64) -> f64 {
        let tangent = self.normal.perp() * sense;
        let ahead = |end: DVec2| (end - self.point).dot(tangent);
        ahead(self.segment.a).max(ahead(self.segment.b)).max(0.0)
    }

    /// Angle by which the normal has to turn around the wall's end, to the left (`sense` 1) or right, until it is upright on the
    /// wall; infinite for a wall without length.
    fn angle_to_face(&self, sense: f64) -> f64 {
        let Segment { a, b } = self.segment;
        // The point may be off the end by rounding.
        let is_at_a = self.point.distance_squared(a) <= self.point.distance_squared(b);
        let other = if is_at_a { b } else { a };
        let along = other - self.point;
        if along == DVec2::ZERO {
            return f64::INFINITY;
        }
        let angle = sense * math::atan2(self.normal.perp_dot(along), self.normal.dot(along));
        // From a quarter turn to the wall's direction on, either way round.
        (if angle >= 0.0 { angle } else { angle + TAU } - FRAC_PI_2).max(0.0)
    }
}

/// What holds a disc at a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Regime {
    /// It is not pressed.
    Off,
    /// Its touching point slides along the wall, to the left of the normal (1) or to the right (-1).
    Sliding(f64),
    /// Its touching point stays: the disc rolls along the wall, or rests.
    Rolling,
}

impl Regime {
    /// Speed of the centre along the tangent where the push makes the angle `alpha` with the normal, m/s.
    fn speed(self, push: &Push, contact: &Contact, alpha: f64) -> f64 {
        let (pressed, along) = push.components(alpha);
        match self {
            Self::Off => along,
            Self::Sliding(side) => along - side * push.friction * pressed,
            Self::Rolling => push.omega() * contact.distance,
        }
    }
}

/// How a contact lets a disc go for some time.
#[derive(Clone, Copy, Debug)]
struct Motion {
    regime: Regime,
    /// Along the tangent 1, against it -1, at rest 0.
    sense: f64,
    seconds: f64,
}

/// Where a contact leads a disc.
#[derive(Clone, Copy, Debug)]
struct Track {
    sense: f64,
    /// Around the wall's end, not along its face.
    round: bool,
    regime: Regime,
    /// Length until the face ends or begins, m.
    length: f64,
    /// Seconds for which the regime holds.
    seconds: f64,
}

/// `angle` less whole turns, in (-pi, pi].
fn wrapped(angle: f64) -> f64 {
    let angle = angle.rem_euclid(TAU);
    if angle > PI { angle - TAU } else { angle }
}

/// The seconds, up to `most`, after which a law has covered `length`; `most` where it does not.
fn seconds_of(law: &Law, length: f64, most: f64) -> f64 {
    if let Law::Steady(speed) = law {
        return (length / speed).min(most);
    }
    if length <= 0.0 {
        return 0.0;
    }
    let mut high = most;
    if high == f64::INFINITY {
        high = 1e-3;
        while law.length(high) < length {
            high *= 2.0;
            // A law that comes to its end only after years has none.
            if high > 1e9 {
                return most;
            }
        }
    } else if law.length(high) <= length {
        return most;
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
