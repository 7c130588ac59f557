//! A hull under water: velocity and height from the thrust of its thrusters, against linear and quadratic drag.
//!
//! Surge, sway, turn and heave each follow a closed form. While the hull turns, its momentum keeps its direction in the
//! world. This is computed by Strang splitting: half of the tick's turn, then the closed forms along the heading in the
//! middle of the tick, then the other half of the turn. See docs/water.md.

use super::model::{Model, ModelError, Wheels};
use crate::{math, time::TICK};

/// Drag along one axis: `linear` v + `quadratic` |v| v.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drag {
    /// Linear coefficient, N per m/s; for a turn N m per rad/s.
    pub linear: f64,
    /// Quadratic coefficient, N per (m/s)²; for a turn N m per (rad/s)².
    pub quadratic: f64,
}

impl From<[f64; 2]> for Drag {
    fn from([linear, quadratic]: [f64; 2]) -> Self {
        Self { linear, quadratic }
    }
}

impl From<Drag> for [f64; 2] {
    fn from(Drag { linear, quadratic }: Drag) -> Self {
        [linear, quadratic]
    }
}

/// Constant properties of a hull that is neutrally buoyant and stays upright.
///
/// The hull has four thrusters: the left and right thrusters push ahead, the front and back thrusters push up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hull {
    /// Force of a thruster at its maximum rate, N; the force is proportional to the rate.
    pub thrust: f64,
    /// Drag of surge (ahead), sway (sideways), turn and heave (up).
    pub drag: [Drag; 4],
    /// Maximum height of the robot's frame above the floor, m; at this height the top of the hull is at the surface of
    /// the water.
    pub ceiling: f64,
}

/// State of a hull at the end of a tick.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct HullState {
    /// Velocity: m/s ahead, m/s to the left, rad/s, m/s up.
    pub velocity: [f64; 4],
    /// Height of the robot's frame above the floor, m.
    pub height: f64,
}

/// Fraction of the terminal velocity below which a hull without thrust is set to rest. Our choice.
const REST_FRACTION: f64 = 1e-9;

/// Fraction of the terminal velocity below which the change during a tick is ignored. So the motion becomes constant
/// after a finite time and needs no further pieces. Our choice.
const SETTLED_FRACTION: f64 = 1e-12;

/// Maximum velocity, m/s or rad/s: at higher velocities a tick would be too long for the splitting.
const MAX_VELOCITY: f64 = 50.0;

impl Hull {
    /// Checks that all values are within their ranges for a robot of this model.
    ///
    /// # Errors
    /// The first value that is out of range, with the accepted values.
    pub fn check(&self, model: &Model) -> Result<(), ModelError> {
        let check = |field, value: f64, accepted, ok: bool| {
            if ok { Ok(()) } else { Err(ModelError { field, value, accepted }) }
        };
        check("thrust", self.thrust, "a number greater than 0", self.thrust.is_finite() && self.thrust > 0.0)?;
        check(
            "depth of the water over the hull",
            self.ceiling,
            "0 or more",
            self.ceiling.is_finite() && self.ceiling >= 0.0,
        )?;
        for Drag { linear, quadratic } in self.drag {
            check("linear drag", linear, "a number greater than 0", linear.is_finite() && linear > 0.0)?;
            check("quadratic drag", quadratic, "0 or more", quadratic.is_finite() && quadratic >= 0.0)?;
        }
        self.terminal_velocities(model).into_iter().try_for_each(|max_velocity| {
            check("velocity at full thrust", max_velocity, "up to 50 m/s and 50 rad/s", max_velocity <= MAX_VELOCITY)
        })
    }

    /// Forces (N) and torque (N m) in the order of [`HullState::velocity`]. The argument gives the rates of the
    /// thrusters left, front, right, back as fractions of their maximum rate.
    fn forces(&self, model: &Model, [left, front, right, back]: [f64; 4]) -> [f64; 4] {
        let turn = 0.5 * model.track * (right - left);
        [left + right, 0.0, turn, front + back].map(|fraction| self.thrust * fraction)
    }

    /// Terminal velocity along each axis at full thrust without motion along the other axes. Since no thruster pushes
    /// sideways, the sideways axis has the value of the forward axis.
    fn terminal_velocities(&self, model: &Model) -> [f64; 4] {
        let forces = [[1.0, 0.0, 1.0, 0.0], [-1.0, 0.0, 1.0, 0.0], [0.0, 1.0, 0.0, 1.0]];
        let [ahead, turn, up] = forces.map(|fractions| self.forces(model, fractions));
        let reached = |axis: usize, force: f64| terminal(force, self.drag[axis].linear, self.drag[axis].quadratic);
        [reached(0, ahead[0]), reached(0, ahead[0]), reached(2, turn[2]), reached(3, up[3])]
    }

    /// Computes one tick for thrusters with these `rates`, rad/s. Returns the state at the end of the tick, and
    /// constant velocities in the robot's frame. With these velocities, the robot moves along an arc from the pose at
    /// the start to the pose at the end.
    pub(super) fn step(&self, model: &Model, rates: &Wheels, before: &HullState) -> (Wheels, HullState) {
        let seconds = TICK.seconds();
        let forces = self.forces(model, rates.map(|rate| rate / model.max_wheel_rate));
        let inertia = [model.mass, model.mass, model.inertia(), model.mass];
        let flow = |axis: usize, velocity: f64| {
            let Drag { linear, quadratic } = self.drag[axis];
            let per_mass = |value: f64| value / inertia[axis];
            flow(per_mass(forces[axis]), per_mass(linear), per_mass(quadratic), velocity, seconds)
        };
        let [ahead, sideways, turn, up] = before.velocity;
        let (turn, angle) = flow(2, turn);
        // The momentum keeps its direction in the world while the hull turns.
        let (sin, cos) = math::sin_cos(0.5 * angle);
        let in_turned_frame = |x: f64, y: f64| (x * cos + y * sin, y * cos - x * sin);
        let (ahead, sideways) = in_turned_frame(ahead, sideways);
        let ((ahead, ahead_distance), (sideways, sideways_distance)) = (flow(0, ahead), flow(1, sideways));
        let (ahead, sideways) = in_turned_frame(ahead, sideways);
        let (up, climb) = flow(3, up);
        let unlimited_height = before.height + climb;
        let height = unlimited_height.clamp(0.0, self.ceiling);
        let mut velocity = [ahead, sideways, turn, if height == unlimited_height { up } else { 0.0 }];
        let terminal = self.terminal_velocities(model);
        for axis in 0..4 {
            if forces[axis] == 0.0 && velocity[axis].abs() <= REST_FRACTION * terminal[axis] {
                velocity[axis] = 0.0;
            }
        }
        let is_settled =
            |axis: usize| (velocity[axis] - before.velocity[axis]).abs() <= SETTLED_FRACTION * terminal[axis];
        if (0..4).all(is_settled) {
            velocity = before.velocity;
        }
        // The chord of the arc is shorter than the arc by the factor sinc, and points along the heading in the middle
        // of the tick.
        let chord_seconds = seconds * math::sinc(0.5 * angle);
        let mean = [
            ahead_distance / chord_seconds,
            sideways_distance / chord_seconds,
            angle / seconds,
            (height - before.height) / seconds,
        ];
        (mean, HullState { velocity, height })
    }
}

/// Terminal velocity under `force` against this drag.
fn terminal(force: f64, linear: f64, quadratic: f64) -> f64 {
    if force == 0.0 { 0.0 } else { 2.0 * force / (linear + (linear * linear + 4.0 * quadratic * force).sqrt()) }
}

/// Solution of dv/dt = `f` - `a` v - `b` |v| v in closed form: velocity and displacement after `t` seconds from the
/// velocity `v`.
///
/// `a` and `b` must be 0 or more, and not both 0 if `f` is not 0.
fn flow(f: f64, a: f64, b: f64, v: f64, t: f64) -> (f64, f64) {
    if v < 0.0 || v == 0.0 && f < 0.0 {
        let (v, x) = flow(-f, a, b, -v, t);
        return (-v, -x);
    }
    let discriminant = a * a + 4.0 * b * f;
    let until_rest = if f < 0.0 { seconds_to_rest(f, a, v, discriminant) } else { f64::INFINITY };
    if until_rest < t {
        let (_, x) = flow_ahead(f, a, b, v, discriminant, until_rest);
        let (reverse_speed, reverse_distance) = flow(-f, a, b, 0.0, t - until_rest);
        return (-reverse_speed, x - reverse_distance);
    }
    flow_ahead(f, a, b, v, discriminant, t)
}

/// Seconds until a velocity `v` of 0 or more is stopped by a force `f` < 0.
fn seconds_to_rest(f: f64, a: f64, v: f64, discriminant: f64) -> f64 {
    let q = 0.5 * discriminant.abs().sqrt();
    let ratio = v / (0.5 * a * v - f);
    let x = q * ratio;
    if q == 0.0 {
        ratio
    } else if discriminant < 0.0 {
        math::atan(x) / q
    } else {
        0.5 * math::ln_1p(2.0 * x / (1.0 - x)) / q
    }
}

/// [`flow`] of a velocity that stays 0 or more: solution of a Riccati equation with this discriminant.
fn flow_ahead(f: f64, a: f64, b: f64, v: f64, discriminant: f64, t: f64) -> (f64, f64) {
    let root = discriminant.abs().sqrt();
    if discriminant < 0.0 {
        let (sin, cos) = math::sin_cos(0.5 * root * t);
        let sine_part = 2.0 * sin / root;
        let growth = cos + (b * v + 0.5 * a) * sine_part;
        let velocity = (v * cos + (f - 0.5 * a * v) * sine_part) / growth;
        return (velocity.max(0.0), (math::ln(growth) - 0.5 * a * t) / b);
    }
    // The difference from the terminal velocity follows a Bernoulli equation.
    let terminal = if f == 0.0 { 0.0 } else { 2.0 * f / (a + root) };
    let (decay, decay_integral) = (math::exp(-root * t), if root == 0.0 { t } else { -math::exp_m1(-root * t) / root });
    let excess = v - terminal;
    let distance = excess * decay_integral;
    let excess_distance = if b == 0.0 { distance } else { math::ln_1p(b * distance) / b };
    ((terminal + excess * decay / (1.0 + b * distance)).max(0.0), terminal * t + excess_distance)
}

#[cfg(test)]
mod tests {
    use super::super::DriveKind;
    use super::*;
    use crate::pose::{Pose, Twist};

    fn model() -> Model {
        Model {
            kind: DriveKind::Thrusters,
            wheel_diameter: 0.1,
            max_wheel_rate: 10.0,
            ticks_per_turn: 1.0,
            track: 0.6,
            wheelbase: 0.6,
            axis_offset: 0.0,
            max_speed: 1.0,
            max_turn: 1.0,
            body_radius: 0.6,
            wheel_lag: 0.0,
            max_steering: 0.0,
            mass: 40.0,
            traction: 0.0,
        }
    }

    fn hull() -> Hull {
        let drag = |linear, quadratic| Drag { linear, quadratic };
        Hull {
            thrust: 20.0,
            drag: [drag(12.0, 30.0), drag(30.0, 90.0), drag(3.0, 6.0), drag(30.0, 90.0)],
            ceiling: 1.5,
        }
    }

    /// Solution of dv/dt = f - a v - b |v| v by 20,000 steps of the classic Runge-Kutta method.
    fn runge_kutta(f: f64, a: f64, b: f64, mut v: f64, t: f64) -> (f64, f64) {
        let h = t / 20_000.0;
        let rate = |v: f64| f - a * v - b * v.abs() * v;
        let mut x = 0.0;
        for _ in 0..20_000 {
            let k1 = rate(v);
            let k2 = rate(v + 0.5 * h * k1);
            let k3 = rate(v + 0.5 * h * k2);
            let k4 = rate(v + h * k3);
            x += h * (v + h * (k1 + k2 + k3) / 6.0);
            v += h * (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
        }
        (v, x)
    }

    #[test]
    fn closed_form_matches_runge_kutta() {
        for f in [0.0, 0.8, -0.8, 3.0, -3.0] {
            for (a, b) in [(0.3, 0.0), (0.3, 0.7), (0.0, 0.7), (2.0, 1e-9), (1e-9, 2.0)] {
                for v in [0.0, 0.5, -0.5, 2.0, -2.0] {
                    for t in [0.01, 0.7, 5.0] {
                        let (closed, stepped) = (flow(f, a, b, v, t), runge_kutta(f, a, b, v, t));
                        let error = (closed.0 - stepped.0).abs().max((closed.1 - stepped.1).abs());
                        assert!(error < 1e-9, "{f} {a} {b} {v} {t}: {closed:?}, by steps {stepped:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn two_flows_in_sequence_equal_one() {
        for (f, v) in [(0.8, 0.0), (-0.8, 1.5), (0.0, -2.0), (-3.0, 0.4)] {
            let (whole, distance) = flow(f, 0.3, 0.7, v, 1.0);
            let (half, first) = flow(f, 0.3, 0.7, v, 0.4);
            let (end, second) = flow(f, 0.3, 0.7, half, 0.6);
            assert!((end - whole).abs() < 1e-14 && (first + second - distance).abs() < 1e-14, "{f} {v}");
        }
    }

    /// Pose and state of the hull after `ticks` with thrusters at these rates.
    fn moved(rates: Wheels, ticks: usize) -> (Pose, HullState) {
        let (mut pose, mut state) = (Pose::default(), HullState { height: 1.5, ..HullState::default() });
        for _ in 0..ticks {
            let ([vx, vy, omega, _], next) = hull().step(&model(), &rates, &state);
            pose = pose.moved(Twist { vx, vy, omega }.scaled(TICK.seconds()));
            state = next;
        }
        (pose, state)
    }

    #[test]
    fn surge_and_heave_match_the_closed_form() {
        let (pose, state) = moved([10.0, -4.0, 10.0, -4.0], 300);
        let (v, x) = flow(1.0, 0.3, 0.75, 0.0, 3.0);
        let (w, z) = flow(-0.4, 0.75, 2.25, 0.0, 3.0);
        assert!((pose.position.x - x).abs() < 1e-12 && pose.position.y == 0.0, "{pose:?}, not {x}");
        assert!((state.velocity[0] - v).abs() < 1e-13 && (state.velocity[3] - w).abs() < 1e-13, "{state:?}");
        assert!((state.height - (1.5 + z)).abs() < 1e-12, "{state:?}");
        assert_eq!(moved([0.0, -4.0, 0.0, -4.0], 3000).1, HullState::default(), "at rest on the floor");
    }

    /// Solution of the equations of motion of the whole hull, dv/dt = (forces - drag) / mass - omega x v, by the
    /// classic Runge-Kutta method. The elements are position, heading, velocity ahead and to the left, and turning
    /// speed.
    fn reference(rates: Wheels, seconds: f64, steps: usize) -> [f64; 6] {
        let (hull, model) = (hull(), model());
        let forces = hull.forces(&model, rates.map(|rate| rate / model.max_wheel_rate));
        let rate = |[_, _, phi, u, v, r]: [f64; 6]| {
            let force_less_drag = |axis: usize, v: f64| {
                forces[axis] - hull.drag[axis].linear * v - hull.drag[axis].quadratic * v.abs() * v
            };
            let (sin, cos) = math::sin_cos(phi);
            [
                u * cos - v * sin,
                u * sin + v * cos,
                r,
                force_less_drag(0, u) / model.mass + r * v,
                force_less_drag(1, v) / model.mass - r * u,
                force_less_drag(2, r) / model.inertia(),
            ]
        };
        let h = seconds / steps as f64;
        let plus = |y: [f64; 6], k: [f64; 6], h: f64| std::array::from_fn(|i| y[i] + h * k[i]);
        let mut y = [0.0; 6];
        for _ in 0..steps {
            let k1 = rate(y);
            let k2 = rate(plus(y, k1, 0.5 * h));
            let k3 = rate(plus(y, k2, 0.5 * h));
            let k4 = rate(plus(y, k3, h));
            y = std::array::from_fn(|i| y[i] + h * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]) / 6.0);
        }
        y
    }

    #[test]
    fn a_curve_is_within_a_hundredth_of_a_millimetre_of_the_reference() {
        for (rates, ticks) in
            [([10.0, 0.0, 2.0, 0.0], 1000), ([-10.0, 0.0, 10.0, 0.0], 300), ([3.0, 0.0, 10.0, 0.0], 100)]
        {
            let seconds = 0.01 * ticks as f64;
            let [x, y, phi, ..] = reference(rates, seconds, 100 * ticks);
            let (pose, _) = moved(rates, ticks);
            let distance = math::hypot(pose.position.x - x, pose.position.y - y);
            let turned = pose.heading.turns() as f64 * std::f64::consts::TAU + pose.heading.remainder();
            println!("{rates:?}: {distance:e} m, {:e} rad", turned - phi);
            assert!(distance < 1e-5, "{rates:?}: {distance} m from the reference");
            assert!((turned - phi).abs() < 1e-9, "{rates:?}: heading {turned}, not {phi}");
        }
    }

    #[test]
    fn velocity_becomes_constant() {
        for rates in [[10.0, 0.0, 10.0, 0.0], [10.0, 0.0, 4.0, 0.0], [0.0; 4]] {
            let start = HullState { velocity: [0.3, -0.2, 0.1, 0.0], height: 1.0 };
            let settled = (0..20_000).try_fold(start, |state, _| {
                let (_, next) = hull().step(&model(), &rates, &state);
                if next == state { Err(next) } else { Ok(next) }
            });
            let end = settled.expect_err("the state is constant after 200 s");
            assert_eq!(end.velocity == [0.0; 4], rates == [0.0; 4], "{rates:?}: {end:?}");
        }
    }

    #[test]
    fn check_names_the_value_out_of_range() {
        let wrong = Hull { ceiling: -0.1, ..hull() };
        let error = wrong.check(&model()).expect_err("too shallow").to_string();
        assert_eq!(error, "`depth of the water over the hull` is -0.1, accepted: 0 or more");
        assert!(Hull { drag: [Drag::default(); 4], ..hull() }.check(&model()).is_err());
        assert!(Hull { thrust: 1e9, ..hull() }.check(&model()).is_err(), "faster than 50 m/s");
        assert_eq!(hull().check(&model()), Ok(()));
    }
}
