//! Noise model of a robot's motion and odometry, as a profile gives it; `drive` applies it.

/// Noise model of a robot's drive, as a profile gives it. The default has no errors.
///
/// All fields except `diameter_sigma` are also in [`Imperfection`](crate::drive::Imperfection), which applies them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionNoise {
    /// Relative excess of the diameter of the left wheels (of a car, the driven wheels) over the nominal diameter.
    pub left: f64,
    /// Relative excess of the diameter of the wheels on the right.
    pub right: f64,
    /// Standard deviation of the relative excess between wheels.
    pub diameter_sigma: f64,
    /// Slip, as a fraction of a wheel's distance travelled.
    pub slip: f64,
    /// Standard deviation of the slip from tick to tick.
    pub slip_sigma: f64,
    /// Noise between the commanded and the true twist.
    pub command: TwistNoise,
    /// Maximum error of the target of a drive.
    pub bound: DriveBound,
    /// Noise between the twist of the wheels and the twist that odometry integrates.
    pub odometry: TwistNoise,
    /// Resolution of odometry readings.
    pub resolution: Resolution,
}

/// Gaussian noise of mean 0 on a twist, drawn for each tick of 10 ms and held until the next.
///
/// The standard deviation of each component is sqrt(a^2 + (b x)^2), with the absolute part a, the share b, and the component x of the
/// wheels' twist. A straight drive of N ticks of h = 10 ms at v m/s that starts on a tick ends, to first order in the noise, with the
/// variances h^2 N speed^2 of its distance, h^2 N turn^2 of its heading, and v^2 h^4 turn^2 (N^3 / 3 - N / 12) of its lateral position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TwistNoise {
    /// Absolute part for the speed, m/s; for an omni drive along both axes.
    pub speed: f64,
    /// Relative part for the speed.
    pub speed_share: f64,
    /// Absolute part for the turning speed, rad/s.
    pub turn: f64,
    /// Relative part for the turning speed.
    pub turn_share: f64,
}

/// Maximum errors at the target of a drive; 0 for a drive that ends exactly there.
///
/// Each drive draws its own error, uniform between the bound and its negative, and never larger than the drive itself: a drive of 1 mm with
/// a bound of 4 mm ends between 0 and 2 mm. The wheels stop there, so encoders and odometry give the end of the drive. Source: the
/// tolerances that courses demand of real robots; the uniform distribution is our choice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveBound {
    /// Maximum error of the arc length, m.
    pub length: f64,
    /// Maximum error of the angle, rad.
    pub angle: f64,
}

/// Resolution of pose readings: each reading is rounded to a multiple of these steps; 0 for no rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resolution {
    /// Step of the position, m.
    pub length: f64,
    /// Step of the heading, rad.
    pub angle: f64,
}
