//! Contacts of a disc with walls at known instants, computed by the core and by a simulator that tests for overlap
//! after each step.

use std::f64::consts::PI;

use sim_core::contact::{Path, SKIN, first_contact};
use sim_core::pose::{Pose, Twist};
use sim_core::scene::Segment;

use crate::oracle;
use crate::world::Random;

/// Kind of motion with which a disc approaches its contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Approach {
    /// Straight, along the wall's normal.
    HeadOn,
    /// Straight, at up to 80 degrees from the wall's normal.
    Oblique,
    /// On an arc, against the middle of a wall.
    Arc,
    /// On an arc, against an end of a wall.
    ArcToCorner,
}

impl Approach {
    /// All approaches.
    pub const ALL: [Self; 4] = [Self::HeadOn, Self::Oblique, Self::Arc, Self::ArcToCorner];

    /// Name of the approach in a table.
    pub fn name(self) -> &'static str {
        match self {
            Self::HeadOn => "head on",
            Self::Oblique => "oblique",
            Self::Arc => "on an arc, wall",
            Self::ArcToCorner => "on an arc, corner",
        }
    }
}

/// A disc that moves towards a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// The wall that the disc reaches.
    pub wall: Segment,
    /// The disc's centre and its heading at the start.
    pub start: Pose,
    /// The disc's constant twist.
    pub twist: Twist,
    /// The disc's radius, m.
    pub radius: f64,
    /// Exact time at which the gap has shrunk to the skin, s.
    pub instant: f64,
}

impl Case {
    /// Draws a case at random: a contact within several seconds, with start coordinates of at most 5 m.
    ///
    /// The instant is chosen first, and the wall is placed where it touches the disc at that instant, so the instant is
    /// exact. Cases in which the disc touches the wall earlier are drawn again.
    pub fn draw(random: &mut Random, approach: Approach) -> Self {
        loop {
            let case = Self::draw_any(random, approach);
            let is_clear = |part: u32| {
                let seconds = case.instant * (1.0 - f64::from(part) / 100.0);
                let centre = case.start.moved(case.twist.scaled(seconds)).position;
                oracle::clearance(&[case.wall], centre, case.radius) > SKIN
            };
            if (1..=100).all(is_clear) {
                return case;
            }
        }
    }

    /// Draws a case in which the disc may touch the wall earlier.
    fn draw_any(random: &mut Random, approach: Approach) -> Self {
        let radius = random.between(0.05, 0.3);
        let speed = random.between(0.1, 1.0);
        let turn = random.between(0.2, 2.0);
        let is_left = random.chance(0.5);
        let omega = match approach {
            Approach::HeadOn | Approach::Oblique => 0.0,
            Approach::Arc | Approach::ArcToCorner => {
                if is_left {
                    turn
                } else {
                    -turn
                }
            }
        };
        let twist = Twist::new(speed, omega);
        let instant = random.between(0.2, 2.0);
        let start = Pose::new(random.between(-5.0, 5.0), random.between(-5.0, 5.0), random.between(-PI, PI));
        let at_contact = start.moved(twist.scaled(instant));
        // Angle between the direction of motion at the contact and the direction to the touched point.
        let angle = match approach {
            Approach::HeadOn => 0.0,
            Approach::Oblique => random.between(-1.4, 1.4),
            Approach::Arc | Approach::ArcToCorner => random.between(-1.0, 1.0),
        };
        let towards = at_contact.heading.turned(angle).direction();
        let point = at_contact.position + towards * (radius + SKIN);
        let wall = match approach {
            // The wall extends away from the disc.
            Approach::ArcToCorner => Segment::new(point, point + towards * 0.1),
            _ => Segment::new(point - towards.perp() * 0.5, point + towards.perp() * 0.5),
        };
        Self { wall, start, twist, radius, instant }
    }

    /// Instant of the contact by the core, in seconds.
    pub fn simulate(&self) -> Option<f64> {
        let path = Path::new(&self.start, self.twist);
        first_contact(&path, self.radius, &self.wall, f64::INFINITY).map(|contact| contact.seconds)
    }

    /// Instant of the contact by a simulator that tests for overlap after each step of `step` seconds: the end of the
    /// first step with an overlap. `None` if there is no overlap within `horizon` seconds, since the disc has passed
    /// through the wall.
    pub fn by_steps(&self, step: f64, horizon: f64) -> Option<f64> {
        let is_touching = |seconds: f64| {
            let centre = self.start.moved(self.twist.scaled(seconds)).position;
            oracle::clearance(&[self.wall], centre, self.radius) <= SKIN
        };
        (1..=(horizon / step).ceil() as u64).map(|n| n as f64 * step).find(|&seconds| is_touching(seconds))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn core_finds_the_exact_instant() {
        let mut random = Random::new(3);
        for approach in Approach::ALL {
            for _ in 0..500 {
                let case = Case::draw(&mut random, approach);
                let found = case.simulate().unwrap_or_else(|| panic!("missed {case:?}"));
                // Positions are rounded to some 1e-15 m, and the disc approaches at 0.017 m/s or more.
                assert!((found - case.instant).abs() < 1e-12, "{found} for {case:?}");
            }
        }
    }

    #[test]
    fn steps_find_the_contact_up_to_one_step_late() {
        let mut random = Random::new(4);
        let mut missed = 0;
        for approach in Approach::ALL {
            for _ in 0..100 {
                let case = Case::draw(&mut random, approach);
                match case.by_steps(0.05, case.instant + 0.1) {
                    Some(found) => assert!((-1e-9..=0.05).contains(&(found - case.instant)), "{found} for {case:?}"),
                    None => missed += 1,
                }
            }
        }
        assert!(missed < 10, "{missed}");
    }
}
