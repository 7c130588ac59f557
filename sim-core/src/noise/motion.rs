//! What a noise profile says of a robot's motion and odometry; `drive` carries it out.

/// How a robot's drive differs from a perfect one: what a noise profile says of it. The default: not at all.
///
/// All but `diameter_sigma` is what [`Imperfection`](crate::drive::Imperfection) has, too, which carries it out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// By what share the wheels on the left (of a car: the driven ones) are larger than their nominal diameter.
    pub left: f64,
    /// The same on the right.
    pub right: f64,
    /// Standard deviation between wheels of that share.
    pub diameter_sigma: f64,
    /// Share of a wheel's way that it slips.
    pub slip: f64,
    /// Standard deviation of that share from tick to tick.
    pub slip_sigma: f64,
    /// Between the commanded and the true twist.
    pub command: TwistNoise,
    /// Between the twist of the wheels and what odometry takes from it.
    pub odometry: TwistNoise,
    /// Steps in which odometry is read.
    pub resolution: Resolution,
}

/// Gaussian noise of mean 0 on a twist, drawn for each tick of 10 ms and held until the next.
///
/// The standard deviation of each component is sqrt(a^2 + (b x)^2), with the absolute part a and the share b of what the
/// wheels tell of it, x. A straight drive of N ticks of h = 10 ms at v m/s that starts on a tick ends, to first order in
/// the noise, with the variances h^2 N speed^2 of its way, h^2 N turn^2 of its heading, and v^2 h^4 turn^2 (N^3 / 3 - N / 12)
/// across.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TwistNoise {
    /// Absolute part for the speed, m/s; for an omni drive along both axes.
    pub speed: f64,
    /// Part that grows with the speed, a share of it.
    pub speed_share: f64,
    /// Absolute part for the turning speed, rad/s.
    pub turn: f64,
    /// Part that grows with the turning speed, a share of it.
    pub turn_share: f64,
}

/// Steps to the nearest of which a pose is rounded as it is read; 0 for none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resolution {
    /// Of a position, m.
    pub length: f64,
    /// Of a heading, rad.
    pub angle: f64,
}
