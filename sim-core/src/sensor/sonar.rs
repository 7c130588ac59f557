use std::f64::consts::PI;

use crate::math;

/// An ultrasonic sensor with a beam: sender and receiver in one, equally sensitive to both ways.
///
/// Gains are of energy, one way, and 1 along the line of sight. The energy of an echo is in units of what a perfect
/// reflector returns that stands 1 m ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sonar {
    /// Least distance that it measures, m: echoes from nearer return while it still sends.
    pub min: f64,
    /// Greatest distance that it measures, m.
    pub max: f64,
    /// Half of the beam's angle, rad: where the main lobe has fallen by 6 dB, to half of the pressure and a quarter of the
    /// energy. So data sheets of transducers give it.
    pub half_angle: f64,
    /// Lobes beside the main one.
    pub side_lobes: Option<SideLobes>,
    /// Least energy of an echo that it notices.
    pub threshold: f64,
    /// Number of rays of its fan; at least 1.
    pub rays: u32,
}

/// A ring of sensitivity around the main lobe.
///
/// Source: France et al. 1999, Figures 4 and 5 (the pattern); a single Gaussian ring: our choice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SideLobes {
    /// Angle between the line of sight and the middle of the ring, rad.
    pub angle: f64,
    /// Half of the ring's width, where it has fallen by 6 dB from its middle, rad.
    pub half_width: f64,
    /// Gain in the middle of the ring, against 1 for the main lobe.
    pub gain: f64,
}

impl Sonar {
    /// The SRF08 by Devantech.
    ///
    /// Published: 3 cm to 6 m, and about 55 degrees of beam, which is the angle between the points of -6 dB of its 40 kHz
    /// transducers; its range is "actually much larger" than 6 m (Gois & Hiller, section 6). The threshold, 0.00186, is our
    /// estimate: that it just notices a rod of 3 cm 2 m ahead, as is said of its family. So a wall would return enough
    /// from 23 m. No side lobes are given. 64 rays: our choice.
    pub fn srf08() -> Self {
        Self {
            min: 0.03,
            max: 6.0,
            half_angle: 27.5 / 180.0 * PI,
            side_lobes: None,
            threshold: 0.015 / 2.015 / 4.0,
            rays: 64,
        }
    }

    /// Gain at `angle` rad from the line of sight: a Gaussian over the angle, and one around the side lobes' middle where
    /// they are stronger; 0 behind.
    ///
    /// Source: Gois & Hiller, section 2.1 (a Gaussian approximates the gain with very good precision).
    pub fn gain(&self, angle: f64) -> f64 {
        if angle > 0.5 * PI {
            return 0.0;
        }
        // A quarter where the ratio is 1.
        let lobe = |ratio: f64| math::exp(-(2.0 * std::f64::consts::LN_2) * ratio * ratio);
        let main = lobe(angle / self.half_angle);
        let side = self.side_lobes.map_or(0.0, |ring| ring.gain * lobe((angle - ring.angle) / ring.half_width));
        main.max(side)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_beam_falls_by_6_db_at_its_half_angle() {
        let sonar = Sonar::srf08();
        assert_eq!(sonar.gain(0.0), 1.0);
        assert!((sonar.gain(sonar.half_angle) - 0.25).abs() < 1e-15);
        assert!((sonar.gain(2.0 * sonar.half_angle) - 1.0 / 256.0).abs() < 1e-15);
        assert_eq!(sonar.gain(0.51 * PI), 0.0);
    }

    #[test]
    fn side_lobes_stand_out_where_the_main_lobe_is_weak() {
        let ring = SideLobes { angle: 1.0, half_width: 0.1, gain: 0.05 };
        let sonar = Sonar { half_angle: 0.25, side_lobes: Some(ring), ..Sonar::srf08() };
        assert_eq!(sonar.gain(0.0), 1.0);
        assert_eq!(sonar.gain(1.0), 0.05);
        assert!(sonar.gain(0.7) < 0.01, "a dip lies between the lobes");
    }
}
