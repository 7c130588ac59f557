//! Motion of the fake robot: it carries out commands exactly and without delay.

use std::time::Duration;

use crate::drive::Position;
use crate::unit::{Angle, Length};

/// Track width of the fake robot, in metres.
pub const TRACK_M: f64 = 0.1;

/// Speed of a wheel of the fake robot at full power, in m/s.
pub const FULL_SPEED_MPS: f64 = 0.5;

/// Position in metres, and heading in radians.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    pub x: f64,
    pub y: f64,
    pub phi: f64,
}

impl Pose {
    /// The pose after a motion with constant twist, given by its lengths ahead and to the left and its change of
    /// heading.
    pub fn moved(self, ahead: f64, left: f64, angle: f64) -> Self {
        // The chord of the arc differs in direction from the initial heading by half of the change of heading.
        let half = angle / 2.0;
        let sinc = if half.abs() < 1e-8 { 1.0 } else { libm::sin(half) / half };
        let (sin, cos) = (libm::sin(self.phi + half), libm::cos(self.phi + half));
        Self {
            x: self.x + sinc * (ahead * cos - left * sin),
            y: self.y + sinc * (ahead * sin + left * cos),
            phi: self.phi + angle,
        }
    }

    /// Transforms a pose from the frame of this pose to the outer frame.
    pub fn compose(self, inner: Self) -> Self {
        let (sin, cos) = (libm::sin(self.phi), libm::cos(self.phi));
        Self {
            x: self.x + cos * inner.x - sin * inner.y,
            y: self.y + sin * inner.x + cos * inner.y,
            phi: self.phi + inner.phi,
        }
    }

    /// Transforms a pose from the outer frame to the frame of this pose.
    pub fn relative(self, other: Self) -> Self {
        let (sin, cos) = (libm::sin(self.phi), libm::cos(self.phi));
        let (dx, dy) = (other.x - self.x, other.y - self.y);
        Self { x: cos * dx + sin * dy, y: cos * dy - sin * dx, phi: other.phi - self.phi }
    }

    pub fn position(self) -> Position {
        Position { x: Length::metres(self.x), y: Length::metres(self.y), phi: Angle::radians(self.phi) }
    }
}

/// Motion by one command, from its start on.
#[derive(Clone, Copy, Debug)]
struct Piece {
    start_us: u64,
    start_pose: Pose,
    /// Distances rolled by the wheels before the start, in metres, left and right.
    rolled: [f64; 2],
    length: f64,
    /// Length to the left, for walking robots.
    left: f64,
    angle: f64,
    /// Duration in seconds. `None` for a motion without end: then `length`, `left` and `angle` are rates per second.
    span: Option<f64>,
}

impl Piece {
    /// Arc length, length to the left and change of heading since the start.
    fn progress(&self, now_us: u64) -> [f64; 3] {
        let elapsed = Duration::from_micros(now_us.saturating_sub(self.start_us)).as_secs_f64();
        let factor = match self.span {
            None => elapsed,
            Some(span) if elapsed >= span => 1.0,
            Some(span) => elapsed / span,
        };
        [self.length * factor, self.left * factor, self.angle * factor]
    }

    fn end_us(&self) -> Option<u64> {
        self.span.map(|span| self.start_us.saturating_add((span * 1e6).ceil() as u64))
    }
}

/// Motions by all commands so far.
#[derive(Debug)]
pub struct Motion(Vec<Piece>);

impl Motion {
    pub fn new() -> Self {
        let standing = Piece {
            start_us: 0,
            start_pose: Pose::default(),
            rolled: [0.0; 2],
            length: 0.0,
            left: 0.0,
            angle: 0.0,
            span: Some(0.0),
        };
        Self(vec![standing])
    }

    /// Sets speeds until the next command, in m/s and rad/s.
    pub fn set_speed(&mut self, now_us: u64, v: f64, w: f64) {
        self.push(now_us, [v, 0.0, w], None);
    }

    /// Like [`set_speed`](Self::set_speed), with a speed to the left.
    pub fn set_twist(&mut self, now_us: u64, v: f64, left: f64, w: f64) {
        self.push(now_us, [v, left, w], None);
    }

    /// Drives an arc length and a change of heading in `span` seconds.
    pub fn drive(&mut self, now_us: u64, length: f64, angle: f64, span: f64) {
        self.push(now_us, [length, 0.0, angle], Some(span));
    }

    fn push(&mut self, now_us: u64, [length, left, angle]: [f64; 3], span: Option<f64>) {
        let piece = Piece {
            start_us: now_us,
            start_pose: self.pose(now_us),
            rolled: self.rolled(now_us),
            length,
            left,
            angle,
            span,
        };
        self.0.push(piece);
    }

    fn piece(&self, now_us: u64) -> &Piece {
        let started = self.0.partition_point(|piece| piece.start_us <= now_us);
        &self.0[started.max(1) - 1]
    }

    /// The true pose; it starts at 0.
    pub fn pose(&self, now_us: u64) -> Pose {
        let piece = self.piece(now_us);
        let [ahead, left, angle] = piece.progress(now_us);
        piece.start_pose.moved(ahead, left, angle)
    }

    /// Distances rolled by the wheels since the start of the program, in metres, left and right.
    pub fn rolled(&self, now_us: u64) -> [f64; 2] {
        let piece = self.piece(now_us);
        let [length, _, angle] = piece.progress(now_us);
        let [left, right] = piece.rolled;
        [left + length - angle * TRACK_M / 2.0, right + length + angle * TRACK_M / 2.0]
    }

    /// Speeds in m/s and rad/s.
    pub fn speed(&self, now_us: u64) -> (f64, f64) {
        let piece = self.piece(now_us);
        match piece.span {
            None => (piece.length, piece.angle),
            Some(_) if piece.end_us().is_some_and(|end| end <= now_us) => (0.0, 0.0),
            Some(span) => (piece.length / span, piece.angle / span),
        }
    }

    /// End of the drive in progress; `None` if there is none.
    pub fn drive_end_us(&self, now_us: u64) -> Option<u64> {
        self.piece(now_us).end_us().filter(|end| *end > now_us)
    }

    /// Returns true if the current piece of motion has no length, as in a turn on the spot.
    pub fn is_turn(&self, now_us: u64) -> bool {
        self.piece(now_us).length == 0.0
    }

    /// Remainder of the drive in progress, without a sign: length, or angle if the drive has no length.
    pub fn remaining(&self, now_us: u64) -> f64 {
        let piece = self.piece(now_us);
        if self.drive_end_us(now_us).is_none() {
            return 0.0;
        }
        let [length, _, angle] = piece.progress(now_us);
        (if piece.length == 0.0 { piece.angle - angle } else { piece.length - length }).abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quarter_circle_ends_at_the_exact_pose() {
        let mut motion = Motion::new();
        motion.drive(1_000_000, std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2, 2.0);
        let end = motion.pose(3_000_000);
        // Radius 1 m, to the left; within a nanometre.
        assert!((end.x - 1.0).abs() < 1e-9 && (end.y - 1.0).abs() < 1e-9, "{end:?}");
        assert_eq!(motion.pose(500_000), Pose::default());
        assert_eq!(motion.drive_end_us(2_000_000), Some(3_000_000));
        let [left, right] = motion.rolled(3_000_000);
        assert!((left - 0.95 * std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert!((right - 1.05 * std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }

    #[test]
    fn relative_undoes_compose() {
        let (outer, inner) = (Pose { x: 1.0, y: -2.0, phi: 0.7 }, Pose { x: 0.3, y: 0.4, phi: -0.2 });
        let back = outer.relative(outer.compose(inner));
        assert!((back.x - inner.x).abs() < 1e-12 && (back.y - inner.y).abs() < 1e-12);
    }
}
