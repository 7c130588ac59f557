//! Noise model of a robot's motion and odometry, as defined in a profile; `drive` applies it.

/// Noise model of a robot's drive and odometry, as defined in a profile. The default has no errors.
///
/// [`Imperfection`](crate::drive::Imperfection) is this model for one robot: `left`, `right` and `diameter_sigma`
/// become the diameters of the wheels, and the other fields are copied.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotionNoise {
    /// Relative excess of the diameter of the left wheels (for a car: of the driven wheels) over the nominal diameter.
    pub left: f64,
    /// Relative excess of the diameter of the right wheels over the nominal diameter.
    pub right: f64,
    /// Standard deviation of a further relative excess, drawn once for each wheel.
    pub diameter_sigma: f64,
    /// Mean slip ratio.
    pub slip: f64,
    /// Standard deviation of the slip ratio, drawn for each tick.
    pub slip_sigma: f64,
    /// Noise between the commanded and the true twist.
    pub command: TwistNoise,
    /// Maximum errors at the target of a drive.
    pub bound: DriveBound,
    /// Noise between the twist of the wheels and the twist that odometry integrates.
    pub odometry: TwistNoise,
    /// Resolution of odometry readings.
    pub resolution: Resolution,
}

/// Gaussian noise of mean 0 on a twist, drawn for each tick of 10 ms and held until the next.
///
/// The standard deviation of each component is sqrt(a^2 + (b x)^2), with the absolute part a, the relative part b, and
/// the component x of the wheels' twist. Example: a straight drive at v m/s starts on a tick and lasts for N ticks of
/// length h = 10 ms. After this drive, to first order in the noise, the variance is h^2 N speed^2 for the distance, h^2
/// N turn^2 for the heading, and v^2 h^4 turn^2 (N^3 / 3 - N / 12) for the lateral position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TwistNoise {
    /// Absolute part for the speed, m/s; an omni drive has this noise along both axes.
    pub speed: f64,
    /// Relative part for the speed.
    pub speed_share: f64,
    /// Absolute part for the turning speed, rad/s.
    pub turn: f64,
    /// Relative part for the turning speed.
    pub turn_share: f64,
}

/// Maximum errors at the target of a drive; with 0 a drive ends exactly at its target.
///
/// The error is drawn for each drive, uniform between the negative bound and the bound. It is never larger than the
/// drive itself: a drive of 1 mm with a bound of 4 mm ends between 0 and 2 mm. The wheels stop at this end, so encoders
/// and odometry include the error. Source: tolerances that robotics courses require of real robots; the uniform
/// distribution is our choice.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveBound {
    /// Maximum error of the arc length, m.
    pub length: f64,
    /// Maximum error of the angle, rad.
    pub angle: f64,
}

/// Resolution of odometry: positions and headings are rounded to multiples of these steps; 0 for no rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resolution {
    /// Step of the position, m.
    pub length: f64,
    /// Step of the heading, rad.
    pub angle: f64,
}
