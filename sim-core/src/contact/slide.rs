//! Sliding of a disc that its wheels push against walls: the solution of the quasi-static contact problem as intervals
//! of motion.
//!
//! docs/motion.md, section Sliding, gives the formulas and frames and shows that the solution is unique. The motion in
//! each interval has a closed form. An interval ends where the kind of contact changes, where a wall ends, or where the
//! disc reaches another wall.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::DVec2;

use super::{LengthLaw, Pace, Path, SKIN, TOUCH, first_contact};
use crate::{
    math,
    pose::Twist,
    scene::{Bounds, Segment, WallId, Walls},
};

/// Difference in rad up to which two angles are regarded as equal.
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

/// The motion of a pushed disc in one interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slide {
    /// Path of the centre.
    pub path: Path,
    /// Duration in seconds. Infinite for motion without contact, because the caller searches for the next wall.
    pub duration: f64,
    /// Wall against which the disc is pressed, and the touched point; `None` for motion without contact.
    pub pressed_wall: Option<(WallId, DVec2)>,
    /// Wall at which the interval ends, if the disc did not touch that wall before.
    pub next_wall: Option<WallId>,
}

impl Push {
    /// Motion of the disc from the start of its free path, for at most `duration` seconds. The touched walls are
    /// determined at the start; the wall `met` is always regarded as touched.
    pub fn slide(&self, walls: &Walls, met: Option<WallId>, duration: f64) -> Slide {
        let touched = self.touched(walls, met);
        if !touched.iter().any(|contact| self.is_approached(&self.free, contact, duration)) {
            return Slide { path: self.free, duration: f64::INFINITY, pressed_wall: None, next_wall: None };
        }
        let tracks: Vec<_> =
            touched.iter().filter_map(|contact| Some((contact, self.track_along(contact, false)?))).collect();
        // Without a track, the disc approaches walls only by rounding errors, so that it exerts no pressure on them.
        let grazed =
            touched.iter().filter(|contact| tracks.is_empty() && self.is_approached(&self.free, contact, duration));
        let grazing_tracks: Vec<_> =
            grazed.filter_map(|contact| Some((contact, self.track_along(contact, true)?))).collect();
        let mut best: Option<(f64, Slide)> = None;
        for (contact, (slip, track)) in tracks.into_iter().chain(grazing_tracks) {
            if best.as_ref().is_some_and(|(min_slip, _)| *min_slip <= slip) {
                continue;
            }
            if let Some(slide) = self.follow(walls, &touched, contact, track, duration) {
                best = Some((slip, slide));
            }
        }
        best.map_or_else(|| self.rest(&touched), |(_, slide)| slide)
    }

    /// Motion with the centre at rest for `duration` seconds, while the body can turn.
    pub fn resting(&self, duration: f64, pressed_wall: Option<(WallId, DVec2)>) -> Slide {
        let twist = Twist { vx: 0.0, vy: 0.0, omega: self.omega() };
        Slide { path: Path { twist, ..self.free }, duration, pressed_wall, next_wall: None }
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
            // If the centre is on a wall, the disc can leave the wall to either side, so the wall is not a contact.
            if (distance - self.radius <= TOUCH || met == Some(wall)) && distance > 0.0 {
                let normal = offset / distance;
                let alpha = wrapped(push_angle - math::atan2(normal.y, normal.x));
                touched.push(Contact { wall, segment: *segment, point, normal, distance, alpha });
            }
        });
        touched
    }

    /// Returns true if `path`, which starts at the centre with constant twist, approaches a touched wall from the start
    /// on.
    fn is_approached(&self, path: &Path, contact: &Contact, duration: f64) -> bool {
        if contact.distance - self.radius > TOUCH {
            // The disc is so far from the world's origin that the rounding of positions exceeds the skin.
            return path.velocity(0.0).dot(contact.normal) < 0.0;
        }
        first_contact(path, self.radius, &contact.segment, duration).is_some_and(|contact| contact.seconds == 0.0)
    }

    /// Motion that this contact allows if it is the only one: the slip speed of the wheels over the floor, m/s, and the
    /// track of the centre. `is_grazed` is true if the disc approaches the wall only by a rounding error, so that it
    /// touches the wall without pressure.
    fn track_along(&self, contact: &Contact, is_grazed: bool) -> Option<(f64, Track)> {
        let is_end = |fraction: f64| fraction <= 0.0 || fraction >= 1.0;
        let mut is_round = is_end(contact.position_along());
        let mut motion = self.motion_at(contact, is_round, is_grazed)?;
        let scale = 16.0 * f64::EPSILON * (self.free.origin.abs().max_element() + self.radius);
        // If the face ends at the contact (within rounding), the disc turns around the end; if a face begins there, the
        // disc moves along the face.
        let has_ended = |is_round: bool, sense: f64| match is_round {
            false => contact.length_to_face_end(sense) <= scale,
            true => contact.angle_to_face(sense) * contact.distance <= scale,
        };
        if motion.sense != 0.0 && has_ended(is_round, motion.sense) {
            is_round = !is_round;
            motion = self.motion_at(contact, is_round, is_grazed)?;
        }
        let SlideMotion { sense, regime, .. } = motion;
        let length = match is_round {
            _ if sense == 0.0 => 0.0,
            false => contact.length_to_face_end(sense),
            true => contact.angle_to_face(sense).min(TAU) * contact.distance,
        };
        let (pressed, along) = self.components(contact.alpha);
        let speed = regime.speed(self, contact, contact.alpha);
        let slip = math::hypot(pressed.max(0.0), along - speed);
        Some((slip, Track { sense, is_round, regime, length, seconds: motion.seconds }))
    }

    /// Motion at a contact from the start on: along a face or, if `is_round`, around an end of the wall.
    fn motion_at(&self, contact: &Contact, is_round: bool, is_grazed: bool) -> Option<SlideMotion> {
        let alpha = contact.alpha;
        let rate = match (is_round, self.regime(contact, alpha)) {
            (true, Regime::Rolling) => 0.0,
            (true, regime) => self.omega() - regime.speed(self, contact, alpha) / contact.distance,
            (false, _) => self.omega(),
        };
        let next_change = if rate == 0.0 { None } else { self.next_angle(contact, rate.signum()) };
        let (mut regime, sample_alpha) = match next_change {
            Some(angle) => (self.regime(contact, alpha + 0.5 * angle), alpha + 0.5 * angle),
            None => (self.regime(contact, alpha), alpha),
        };
        if matches!(regime, Regime::Separate) {
            if !is_grazed {
                return None;
            }
            let (_, along) = self.components(alpha);
            regime = Regime::Sliding(if along < self.omega() * contact.distance { -1.0 } else { 1.0 });
        }
        let speed = regime.speed(self, contact, sample_alpha);
        let sense = if speed == 0.0 { 0.0 } else { speed.signum() };
        let seconds = match next_change {
            None => f64::INFINITY,
            Some(angle) if !is_round => angle / self.omega(),
            Some(_) if matches!(regime, Regime::Rolling) => f64::INFINITY,
            Some(angle) => self.law(contact, is_round, regime, sense).seconds_to_turn(angle),
        };
        Some(SlideMotion { regime, sense, seconds })
    }

    /// Components of the push, m/s: into the wall, and along the tangent of the contact. `alpha` is the angle from the
    /// normal of the contact to the push.
    fn components(&self, alpha: f64) -> (f64, f64) {
        let (sin, cos) = math::sin_cos(alpha);
        (-self.speed() * cos, self.speed() * sin)
    }

    fn regime(&self, contact: &Contact, alpha: f64) -> Regime {
        let (pressed, along) = self.components(alpha);
        let rolling = self.omega() * contact.distance;
        if pressed <= 0.0 {
            Regime::Separate
        } else if along - self.friction * pressed > rolling {
            Regime::Sliding(1.0)
        } else if along + self.friction * pressed < rolling {
            Regime::Sliding(-1.0)
        } else {
            Regime::Rolling
        }
    }

    /// Maximum speed along the tangent of a contact, m/s, and the angle of friction, rad.
    fn max_speed_and_friction_angle(&self) -> (f64, f64) {
        (self.speed() * math::hypot(1.0, self.friction), math::atan(self.friction))
    }

    /// Signed change of alpha, in the direction of `sense`, after which the regime or the direction of motion along the
    /// wall may change.
    fn next_angle(&self, contact: &Contact, sense: f64) -> Option<f64> {
        let (max_speed, friction_angle) = self.max_speed_and_friction_angle();
        let ratio = self.omega() * contact.distance / max_speed;
        let mut critical_angles = [f64::NAN; 10];
        critical_angles[..2].copy_from_slice(&[FRAC_PI_2, -FRAC_PI_2]);
        for (index, shift) in [friction_angle, -friction_angle].into_iter().enumerate() {
            let beta = if ratio.abs() <= 1.0 { math::asin(ratio) } else { f64::NAN };
            critical_angles[2 + 4 * index..6 + 4 * index].copy_from_slice(&[
                beta - shift,
                PI - beta - shift,
                -shift,
                PI - shift,
            ]);
        }
        // If the push is within a quarter turn of the normal, it points away from the wall; a critical angle there has
        // no effect.
        let has_effect = |angle: &f64| math::cos(*angle) < 1e-9;
        let changes = critical_angles.into_iter().filter(has_effect).map(|critical| {
            let angle = (sense * (critical - contact.alpha)).rem_euclid(TAU);
            if angle <= SAME_ANGLE || angle >= TAU - SAME_ANGLE { TAU } else { angle }
        });
        changes.reduce(f64::min).map(|angle| sense * angle)
    }

    /// Length covered along the track as a function of time.
    fn law(&self, contact: &Contact, is_round: bool, regime: Regime, sense: f64) -> LengthLaw {
        let (speed, friction_angle) = self.max_speed_and_friction_angle();
        let omega = self.omega();
        match regime {
            Regime::Separate => LengthLaw::Steady(0.0),
            Regime::Rolling => LengthLaw::Steady((omega * contact.distance).abs()),
            Regime::Sliding(side) => {
                let phase = contact.alpha + side * friction_angle;
                if is_round {
                    LengthLaw::Round { radius: contact.distance, speed, phase, rate: omega, sense }
                } else if omega == 0.0 {
                    LengthLaw::Steady(sense * speed * math::sin(phase))
                } else {
                    LengthLaw::Wave { speed: sense * speed, phase, rate: omega }
                }
            }
        }
    }

    /// The motion along the track of a contact; `None` if the track approaches another touched wall from the start on.
    fn follow(
        &self,
        walls: &Walls,
        touched: &[Contact],
        contact: &Contact,
        track: Track,
        duration: f64,
    ) -> Option<Slide> {
        let pressed_wall = Some((contact.wall, contact.point));
        if track.sense == 0.0 {
            return Some(self.resting(track.seconds, pressed_wall));
        }
        let law = self.law(contact, track.is_round, track.regime, track.sense);
        let tangent = contact.normal.perp() * track.sense;
        let curvature = if track.is_round { track.sense / contact.distance } else { 0.0 };
        let track_path = Path {
            origin: self.free.origin,
            direction: tangent,
            twist: Twist::new(1.0, curvature),
            pace: Pace::ConstantTwist,
        };
        let mut seconds = track.seconds.min(duration);
        let mut length = track.length;
        if seconds.is_finite() {
            length = length.min(law.length(seconds).max(0.0));
        }
        let others = touched.iter().filter(|other| other.wall != contact.wall);
        for other in others {
            if self.is_approached(&track_path, other, length) {
                return None;
            }
        }
        let first_wall = self.first_wall(walls, &track_path, contact.wall, length);
        let next_wall = first_wall.filter(|(contact_length, ..)| *contact_length < length);
        if let Some((contact_length, ..)) = next_wall {
            length = contact_length;
        }
        if next_wall.is_some() || length == track.length {
            seconds = seconds_of(&law, length, seconds);
        }
        let path = Path { pace: Pace::Sliding { omega: self.omega(), law }, ..track_path };
        let next_wall = next_wall.filter(|(.., is_fresh)| *is_fresh).map(|(_, wall, _)| wall);
        Some(Slide { path, duration: seconds, pressed_wall, next_wall })
    }

    /// The first wall other than `except` that a disc reaches on `path`, a path at 1 m/s, within `length` metres.
    /// Returns the length up to the contact, the wall, and true if the disc did not touch that wall at the start.
    fn first_wall(&self, walls: &Walls, path: &Path, except: WallId, length: f64) -> Option<(f64, WallId, bool)> {
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
                if contact.seconds <= to
                    && first.is_none_or(|(seconds, best, _)| (contact.seconds, wall) < (seconds, best))
                {
                    first = Some((contact.seconds, wall, contact.fresh));
                }
            });
            if first.is_some() {
                return first;
            }
            (from, step) = (to, 2.0 * step);
        }
        None
    }

    /// Rest at the contacts until the push has turned so far that the regime of a contact may change.
    fn rest(&self, touched: &[Contact]) -> Slide {
        let mut seconds = f64::INFINITY;
        let mut most_pressed: Option<(f64, &Contact)> = None;
        for contact in touched {
            let (pressed, _) = self.components(contact.alpha);
            if most_pressed.is_none_or(|(max_pressed, _)| pressed > max_pressed) {
                most_pressed = Some((pressed, contact));
            }
            if let Some(angle) = self.next_angle(contact, self.omega().signum()).filter(|_| self.omega() != 0.0) {
                seconds = seconds.min(angle / self.omega());
            }
        }
        self.resting(seconds, most_pressed.map(|(_, contact)| (contact.wall, contact.point)))
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
    /// Position of the touched point on the wall: 0 and 1 at the ends of the wall, 0.5 in between.
    fn position_along(&self) -> f64 {
        if self.point == self.segment.a {
            0.0
        } else if self.point == self.segment.b {
            1.0
        } else {
            0.5
        }
    }

    /// Length in metres from the touched point to the end of the face. The direction is that of the contact's tangent,
    /// to the left of the normal (`sense` 1), or the opposite one (-1).
    fn length_to_face_end(&self, sense: f64) -> f64 {
        let tangent = self.normal.perp() * sense;
        let length_to = |end: DVec2| (end - self.point).dot(tangent);
        length_to(self.segment.a).max(length_to(self.segment.b)).max(0.0)
    }

    /// Angle in rad by which the normal must turn around the wall's end until it is perpendicular to the wall. The
    /// normal turns to the left (`sense` 1) or to the right (-1). Infinite for a wall of length 0.
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
        // In either sense, the normal is perpendicular to the wall a quarter turn before it has the direction of the
        // wall.
        (if angle >= 0.0 { angle } else { angle + TAU } - FRAC_PI_2).max(0.0)
    }
}

/// Kind of contact between disc and wall.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Regime {
    /// The disc is not pressed against the wall.
    Separate,
    /// The touching point of the disc slides along the wall: to the left of the normal (1) or to the right (-1).
    Sliding(f64),
    /// The touching point of the disc does not slide: the disc rolls along the wall, or rests.
    Rolling,
}

impl Regime {
    /// Speed of the centre along the tangent, m/s, for the angle `alpha` from the normal to the push.
    fn speed(self, push: &Push, contact: &Contact, alpha: f64) -> f64 {
        let (pressed, along) = push.components(alpha);
        match self {
            Self::Separate => along,
            Self::Sliding(side) => along - side * push.friction * pressed,
            Self::Rolling => push.omega() * contact.distance,
        }
    }
}

/// Motion that a contact allows until its regime may change.
#[derive(Clone, Copy, Debug)]
struct SlideMotion {
    regime: Regime,
    /// Direction of the motion: 1 along the tangent, -1 opposite to it, 0 at rest.
    sense: f64,
    seconds: f64,
}

/// Track of the centre at a contact.
#[derive(Clone, Copy, Debug)]
struct Track {
    sense: f64,
    /// True for a track around the wall's end, false for a track along its face.
    is_round: bool,
    regime: Regime,
    /// Length until the face ends or, for a track around the wall's end, until the face begins, m.
    length: f64,
    /// Seconds for which the regime is valid.
    seconds: f64,
}

/// `angle` in rad minus whole turns, in (-pi, pi].
fn wrapped(angle: f64) -> f64 {
    let angle = angle.rem_euclid(TAU);
    if angle > PI { angle - TAU } else { angle }
}

/// Seconds until `law` has covered `length` metres, at most `max_seconds`; `max_seconds` if it never covers that
/// length.
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
            // A length that is not covered within 1e9 s, about 30 years, is regarded as never covered.
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
