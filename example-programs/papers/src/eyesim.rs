//! Koestler and Bräunl, *Mobile Robot Simulation with Realistic Error Models*: the paper on the original simulator,
//! statement by statement.
//!
//! A program of `eyesim/` tests each statement. This module computes the expected values from the paper's formulas,
//! without the simulator's models.

use std::f64::consts::{FRAC_PI_2, PI};

use accuracy::statistics::{Moments, binomial, kolmogorov, normal_cdf, two_sided};
use anyhow::Context as _;
use glam::DVec2;
use sim_core::math;

use crate::page::{Basis, Claim, Page, Weight};
use crate::run::{Job, Run, Scene};
use crate::trace::{Entry, Event, Trace};

/// p-value below which a statement about random numbers is rejected.
const REJECT: f64 = 0.001;

/// `robis/scout.robi`: wheel diameter and track, m; maximum rate of a wheel, rad/s.
const SCOUT: [f64; 3] = [0.054, 0.1, 20.0 * PI];
/// `robis/mecanum.robi`: wheel diameter and track, m; maximum rate of a wheel, rad/s.
const MECANUM: [f64; 3] = [0.1, 0.22, 4.0 * PI];
/// Wheelbase of the Mecanum robot, m.
const WHEELBASE: f64 = 0.24;
/// The scout's PSDs in the order of `eyesim/spin.c`: name, and the angle of its position on the circle and of its ray,
/// rad.
const PSDS: [(&str, f64); 4] =
    [("PSD_FRONT", 0.0), ("PSD_LEFT", FRAC_PI_2), ("PSD_RIGHT", -FRAC_PI_2), ("PSD_BACK", PI)];
/// Distance of the PSDs from the robot's centre, m.
const PSD_RADIUS: f64 = 0.08;
/// Size of the room in which PSDs and cameras look at walls, m.
const ROOM: DVec2 = DVec2::new(1.6, 1.2);
/// Position of the robot in the room, m.
const PLACE: DVec2 = DVec2::new(0.9, 0.5);

/// Standard deviation of the noise on PSD readings, m.
const PSD_SIGMA: f64 = 0.02;
/// Standard deviation of the noise on speeds, m/s.
const SPEED_SIGMA: f64 = 0.05;
/// Probability P_e of impulse noise in a pixel.
const IMPULSE: f64 = 0.05;
/// Fraction of white pixels in the impulse noise.
const SALT: f64 = 0.3;
/// Bit error probability P_b of the radio.
const BIT_ERRORS: f64 = 1e-3;
/// Packet loss probability P_p of the radio.
const PACKET_LOSS: f64 = 0.05;
/// Number of messages that `eyesim/channel.c` sends.
const MESSAGES: u64 = 4000;
/// Number of bits in each message.
const BITS: u64 = 32 * 8;
/// Virtual time of a PSDGet call, as the table in the scene sets it, us.
const COST_US: f64 = 1500.0;
/// Number of robots with a camera.
const CROWD: usize = 300;
/// Number of robots that send the time to each other.
const SENDERS: usize = 8;

/// Tolerance of positions and distances, m.
const EXACT_M: f64 = 1e-9;
/// Tolerance of angles, rad.
const EXACT_RAD: f64 = 1e-9;

/// Makes the page.
///
/// # Errors
/// If a scene does not run to its end, or a program prints other values than expected.
pub fn run(job: &Job) -> anyhow::Result<Page> {
    let source = "A. Koestler, T. Bräunl: Mobile Robot Simulation with Realistic Error Models";
    let mut page = Page::new("EyeSim, statement by statement", source);
    page.text(
        "Each statement is tried by a program in example-programs/papers/eyesim. The expected values come from the paper's formulas, computed \
         on their own; p is the probability of a deviation at least as large if the statement is true.",
    );
    let traces = job.run(&scenes(job), |_, trace| Ok(trace))?;
    let [wheels, mecanum, drives, spin, readings, straight, clean, frames, channel, costs, future, tasks, loose, crowd] =
        &traces[..]
    else {
        anyhow::bail!("{} traces", traces.len());
    };
    page.claims = vec![
        differential(wheels)?,
        omnidirectional(mecanum)?,
        printed_turn_row(mecanum)?,
        v_omega(drives)?,
        rays(spin)?,
        gaussian_readings(readings)?,
        white_readings(readings),
        gaussian_speed(straight)?,
        impulses(clean, frames)?,
        salt(frames)?,
        lost(channel)?,
        flipped(channel)?,
        table(costs)?,
        no_future(future)?,
        semaphores(tasks, loose)?,
        suspended(tasks)?,
        many(crowd)?,
    ];
    Ok(page)
}

/// The scenes, in the order of their use.
fn scenes(job: &Job) -> Vec<Run> {
    let walls = format!(
        "floor_mm = [{x}, {y}]\nwall = [\n    {{ from_mm = [0, 0], to_mm = [{x}, 0] }},\n    {{ from_mm = [{x}, 0], to_mm = [{x}, {y}] }},\n    \
         {{ from_mm = [{x}, {y}], to_mm = [0, {y}] }},\n    {{ from_mm = [0, {y}], to_mm = [0, 0] }},\n]",
        x = 1e3 * ROOM.x,
        y = 1e3 * ROOM.y
    );
    let open = "floor_mm = [40000, 40000]";
    let robot = |robi: &str, program: &str, argument: &str, section: &str| {
        format!(
            "[[robot]]\ntype = \"%sim%/robis/{robi}.robi\"\nprogram = \"%sim%/example-programs/papers/eyesim/{program}.c\"\narguments = \
             [{argument}]\n{section}\n"
        )
    };
    let at = |section: DVec2| format!("x_mm = {}\ny_mm = {}\nheading_deg = 0", 1e3 * section.x, 1e3 * section.y);
    let grid = |count: usize| {
        format!("count = {count}\nlayout = {{ kind = \"grid\", from_mm = [1000, 1000], spacing_mm = [600, 600] }}")
    };
    let in_open = |robi, program, argument| robot(robi, program, argument, &at(DVec2::splat(20.0)));
    let in_room = |program, argument| robot("scout", program, argument, &at(PLACE));
    let run = |name: &str, scene: &str, world: &str, robots: &str| Run {
        name: name.to_owned(),
        scene: Scene::Text(format!("[scene]\nuntil_s = 3000\n{scene}\n\n[world]\n{world}\n\n{robots}")),
        options: job.options(),
    };
    let psd_noise = format!("noise = {{ psd = {{ sigma_mm = {} }} }}", 1e3 * PSD_SIGMA);
    let speed_noise = format!("noise = {{ drive = {{ v_sigma_mm_s = {} }} }}", 1e3 * SPEED_SIGMA);
    let impulse_noise = format!("noise = {{ camera = {{ salt_and_pepper = {IMPULSE}, salt = {SALT} }} }}");
    let radio_noise = format!("noise = {{ radio = {{ bit_error_rate = {BIT_ERRORS}, packet_loss = {PACKET_LOSS} }} }}");
    let pair = in_room("channel", "") + &robot("scout", "channel", "", &at(PLACE - DVec2::X * 0.4));
    vec![
        run("wheels", "", open, &in_open("scout", "wheels", "")),
        run("mecanum", "", open, &in_open("mecanum", "wheels", "\"4\"")),
        run("drives", "", open, &in_open("scout", "drives", "")),
        run("spin", "", &walls, &in_room("spin", "")),
        run("readings", &psd_noise, &walls, &in_room("readings", "")),
        run("straight", &speed_noise, open, &in_open("scout", "straight", "")),
        run("clean", "", &walls, &in_room("frames", "")),
        run("frames", &impulse_noise, &walls, &in_room("frames", "")),
        run("channel", &radio_noise, &walls, &pair),
        run(
            "costs",
            &format!("costs = {{ robios6 = {{ PSDGet = {COST_US} }} }}"),
            &walls,
            &in_room("readings", "\"compute\""),
        ),
        run("future", "", open, &robot("scout", "future", "", &grid(SENDERS))),
        run("tasks", "", &walls, &in_room("tasks", "")),
        run("loose", "", &walls, &in_room("tasks", "\"loose\"")),
        run("crowd", "", open, &robot("scout", "look", "", &grid(CROWD))),
    ]
}

/// A claim whose result comes from a measurement.
fn claim(section: &str, paper: &str, ours: &str, number: String, holds: bool) -> Claim {
    let (section, paper, ours) = (section.to_owned(), paper.to_owned(), ours.to_owned());
    Claim { section, paper, ours, number, holds, weight: Weight::Must, basis: Basis::Found }
}

/// Parses the numbers of a line.
fn numbers(line: &str) -> anyhow::Result<Vec<f64>> {
    line.split_whitespace().map(|word| word.parse().with_context(|| format!("`{line}`"))).collect()
}

/// Parses the numbers of the only line that a robot prints.
fn only<const N: usize>(trace: &Trace, robot: u32) -> anyhow::Result<[f64; N]> {
    let lines: Vec<_> = trace.printed(robot).collect();
    anyhow::ensure!(lines.len() == 1, "one line from robot {robot}, not {}", lines.len());
    numbers(lines[0].1)?.try_into().map_err(|numbers| anyhow::anyhow!("{N} numbers, not {numbers:?}"))
}

/// True poses of robot 1 at the ends of slots: time, position, heading.
fn poses(trace: &Trace) -> Vec<(f64, DVec2, f64)> {
    let pose = |entry: &Entry| match entry.event {
        Event::Pose { x_m, y_m, phi_rad } => Some((entry.at, DVec2::new(x_m, y_m), phi_rad)),
        _ => None,
    };
    trace.of_robot(1).filter_map(pose).collect()
}

/// Angle from one heading to another, in (-pi, pi].
fn turn(from: f64, to: f64) -> f64 {
    let turn = (to - from).rem_euclid(2.0 * PI);
    if turn > PI { turn - 2.0 * PI } else { turn }
}

/// Displacement in the robot's frame after a time at a constant twist (forwards, left, turning).
fn displacement([vx, vy, omega]: [f64; 3], seconds: f64) -> (DVec2, f64) {
    let angle = omega * seconds;
    let (along, lateral) = if angle.abs() < 1e-9 {
        (seconds, 0.5 * angle * seconds)
    } else {
        (math::sin(angle) / omega, (1.0 - math::cos(angle)) / omega)
    };
    (DVec2::new(vx * along - vy * lateral, vx * lateral + vy * along), angle)
}

/// Maximum deviations of the motion in each slot from the twist that the wheel rates imply (m, rad), and the number of
/// slots.
fn slots(trace: &Trace, twist: impl Fn(&[f64]) -> [f64; 3]) -> anyhow::Result<(f64, f64, usize)> {
    let poses = poses(trace);
    let (mut off, mut turned, mut count) = (0.0_f64, 0.0_f64, 0);
    for (since, line) in trace.printed(1) {
        let twist = twist(&numbers(line)?);
        for [(begin, from, phi), (end, to, psi)] in poses.array_windows() {
            // The rates of all wheels are constant for a second after the printed line.
            if *begin < since || *end > since + 1.0 {
                continue;
            }
            let (step, angle) = displacement(twist, end - begin);
            off = off.max((DVec2::from_angle(*phi).rotate(step) - (*to - *from)).length());
            turned = turned.max((turn(*phi, *psi) - turn(0.0, angle)).abs());
            count += 1;
        }
    }
    anyhow::ensure!(count > 50, "{count} slots");
    Ok((off, turned, count))
}

/// Speeds of the wheels over the ground, m/s.
fn speeds([diameter, _, rate]: [f64; 3], percents: &[f64]) -> Vec<f64> {
    percents.iter().map(|percent| 0.01 * percent * rate * 0.5 * diameter).collect()
}

fn exact((off, turned, count): (f64, f64, usize)) -> (String, bool) {
    let number = format!("{off:.1e} m, {turned:.1e} rad in {count} slots");
    (number, off < EXACT_M && turned < EXACT_RAD)
}

fn differential(trace: &Trace) -> anyhow::Result<Claim> {
    let twist = |percents: &[f64]| {
        let speed = speeds(SCOUT, percents);
        [0.5 * (speed[0] + speed[1]), 0.0, (speed[1] - speed[0]) / SCOUT[1]]
    };
    let (number, holds) = exact(slots(trace, twist)?);
    let ours = "motors at 7 pairs of rates: true motion in each slot against the matrix, integrated in closed form";
    Ok(claim("2", "forward kinematics of the differential drive", ours, number, holds))
}

fn omnidirectional(trace: &Trace) -> anyhow::Result<Claim> {
    let twist = |percents: &[f64]| {
        let s = speeds(MECANUM, percents);
        let turning = (-s[0] + s[1] - s[2] + s[3]) / (2.0 * (MECANUM[1] + WHEELBASE));
        [0.25 * (s[0] + s[1] + s[2] + s[3]), 0.25 * (-s[0] + s[1] + s[2] - s[3]), turning]
    };
    let (number, holds) = exact(slots(trace, twist)?);
    let ours = "motors at 6 sets of rates: true motion against the first two rows, and a third row (-, +, -, +) c / (2 (track + wheelbase))";
    Ok(claim("2", "forward kinematics of the drive with four Mecanum wheels", ours, number, holds))
}

fn printed_turn_row(trace: &Trace) -> anyhow::Result<Claim> {
    let twist = |percents: &[f64]| {
        let s = speeds(MECANUM, percents);
        let v_left = 0.25 * (-s[0] + s[1] + s[2] - s[3]);
        [0.25 * (s[0] + s[1] + s[2] + s[3]), v_left, v_left / MECANUM[1]]
    };
    let (number, holds) = exact(slots(trace, twist)?);
    let ours = "the same motion against the matrix as printed, whose third row repeats the second: no rates would turn the robot on the spot";
    let claim = claim("2", "the third row of that matrix has the signs (-, +, +, -)", ours, number, holds);
    Ok(Claim { weight: Weight::Told, ..claim })
}

fn v_omega(trace: &Trace) -> anyhow::Result<Claim> {
    let poses = poses(trace);
    let (mut at, mut heading) = (DVec2::splat(20.0), 0.0);
    let (mut off, mut turned, mut count) = (0.0_f64, 0.0_f64, 0);
    for (time, line) in trace.printed(1) {
        let drive: [f64; 2] = numbers(line)?.try_into().ok().with_context(|| format!("`{line}`"))?;
        let (step, angle) = displacement([drive[0], 0.0, drive[1]], 1.0);
        at += DVec2::from_angle(heading).rotate(step);
        heading += angle;
        let (_, position, phi) = poses.iter().rfind(|(end, ..)| *end <= time + 1e-9).context("a pose")?;
        off = off.max((*position - at).length());
        turned = turned.max(turn(*phi, heading).abs());
        count += 1;
    }
    anyhow::ensure!(count == 12, "{count} drives");
    let number = format!("{off:.1e} m, {turned:.1e} rad over {count} drives in a row");
    let ours =
        "VWDriveStraight, VWDriveTurn and VWDriveCurve: true poses after each against the commanded lengths and angles";
    Ok(claim(
        "2",
        "driving functions for straight and curve segments and turns on the spot",
        ours,
        number,
        off < EXACT_M && turned < EXACT_RAD,
    ))
}

/// Distance from a point in the room to its walls, along a direction, m.
fn to_wall(from: DVec2, direction: DVec2) -> f64 {
    let along = |from: f64, component: f64, size: f64| {
        if component > 0.0 { (size - from) / component } else { -from / component }
    };
    let x = if direction.x == 0.0 { f64::INFINITY } else { along(from.x, direction.x, ROOM.x) };
    let y = if direction.y == 0.0 { f64::INFINITY } else { along(from.y, direction.y, ROOM.y) };
    x.min(y)
}

fn rays(trace: &Trace) -> anyhow::Result<Claim> {
    let poses = poses(trace);
    let (mut worst, mut count) = (0.0_f64, 0);
    for entry in trace.of_robot(1) {
        let Event::Distance { device, distance_m: Some(distance), measured_s } = &entry.event else { continue };
        let (_, angle) = PSDS.iter().find(|(name, _)| name == device).context("a PSD of the scout")?;
        let Some([(begin, _, from), (end, _, to)]) = poses.array_windows().find(|[_, (end, ..)]| *end >= *measured_s)
        else {
            continue;
        };
        if *begin > *measured_s {
            continue;
        }
        // Within a slot the robot turns at a constant rate.
        let heading = from + turn(*from, *to) * (measured_s - begin) / (end - begin);
        let direction = DVec2::from_angle(heading + angle);
        worst = worst.max((to_wall(PLACE + PSD_RADIUS * direction, direction) - distance).abs());
        count += 1;
    }
    anyhow::ensure!(count > 500, "{count} readings");
    let ours = "four PSDs while the robot turns in a room: readings, before they become whole millimetres, against the distances to its walls";
    Ok(claim(
        "4.1",
        "a PSD measures the distance to the obstacle that its ray hits",
        ours,
        format!("{worst:.1e} m at most, of {count} readings"),
        worst < EXACT_M,
    ))
}

/// Errors of the readings of `eyesim/readings.c`, m.
fn reading_errors(trace: &Trace) -> Vec<f64> {
    let truth = to_wall(PLACE + PSD_RADIUS * DVec2::X, DVec2::X);
    let error = |entry: &Entry| match entry.event {
        Event::Distance { distance_m: Some(distance), .. } => Some(distance - truth),
        _ => None,
    };
    trace.of_robot(1).filter_map(error).collect()
}

fn gaussian_readings(trace: &Trace) -> anyhow::Result<Claim> {
    let mut errors = reading_errors(trace);
    anyhow::ensure!(errors.len() == 3000, "{} readings", errors.len());
    let moments = Moments::of(&errors);
    let mean = moments.mean_is(0.0, PSD_SIGMA * PSD_SIGMA);
    let spread = moments.variance_is(PSD_SIGMA * PSD_SIGMA);
    let shape = kolmogorov(&mut errors, |error| normal_cdf(error / PSD_SIGMA));
    let number = format!(
        "{:+.2} mm and {:.2} mm over 3000 readings; p {mean:.2}, {spread:.2}, of the distribution {shape:.2}",
        1e3 * moments.mean,
        1e3 * moments.variance.sqrt()
    );
    let ours = "mean and standard deviation of a PSD's errors against 0 and 20 mm, and Kolmogorov-Smirnov";
    Ok(claim(
        "5",
        "the noise of PSDs is additive, Gaussian, with mean zero",
        ours,
        number,
        mean.min(spread).min(shape) >= REJECT,
    ))
}

fn white_readings(trace: &Trace) -> Claim {
    let errors = reading_errors(trace);
    let products: f64 = errors.array_windows().map(|[first, second]| first * second).sum();
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    let correlation = products / squares;
    let p = two_sided(correlation * (errors.len() as f64).sqrt());
    let ours = "correlation of each error with the next";
    claim("5", "the noise is white", ours, format!("{correlation:+.3}, p {p:.2}"), p >= REJECT)
}

fn gaussian_speed(trace: &Trace) -> anyhow::Result<Claim> {
    let poses = poses(trace);
    let mut errors = Vec::new();
    let mut before = 20.0;
    for (index, (time, _)) in trace.printed(1).enumerate() {
        let (_, position, _) = poses.iter().rfind(|(end, ..)| *end <= time + 1e-9).context("a pose")?;
        let ahead = if index % 2 == 0 { 1.0 } else { -1.0 };
        errors.push(ahead * (position.x - before) - 0.3);
        before = position.x;
    }
    anyhow::ensure!(errors.len() == 400, "{} drives", errors.len());
    // A drive of 1 s has 100 ticks of 10 ms, each with its own error: docs/noise.md.
    let sigma = 0.01 * 100_f64.sqrt() * SPEED_SIGMA;
    let moments = Moments::of(&errors);
    let (mean, spread) = (moments.mean_is(0.0, sigma * sigma), moments.variance_is(sigma * sigma));
    let shape = kolmogorov(&mut errors, |error| normal_cdf(error / sigma));
    let number = format!(
        "{:+.2} mm and {:.2} mm over 400 drives; p {mean:.2}, {spread:.2}, of the distribution {shape:.2}",
        1e3 * moments.mean,
        1e3 * moments.variance.sqrt()
    );
    let ours = "noise of 50 mm/s on the speed: mean and standard deviation of the lengths of drives of 0.3 m against 0 and 5 mm";
    Ok(claim(
        "5",
        "the noise of the v-omega interface is additive, Gaussian, with mean zero",
        ours,
        number,
        mean.min(spread).min(shape) >= REJECT,
    ))
}

fn impulses(clean: &Trace, frames: &Trace) -> anyhow::Result<Claim> {
    let [black, white, _] = only(clean, 1)?;
    let [noisy_black, noisy_white, all] = only(frames, 1)?;
    let count = (noisy_black + noisy_white) as u64;
    let p = binomial(count, all as u64, IMPULSE);
    let number =
        format!("{:.3} % of {all:.0} pixels, p {p:.2}; without noise {:.0}", 100.0 * count as f64 / all, black + white);
    let ours = "black and white pixels of grey images against P_e = 5 %";
    Ok(claim(
        "5",
        "salt and pepper noise replaces a pixel with probability P_e",
        ours,
        number,
        p >= REJECT && black + white == 0.0,
    ))
}

fn salt(frames: &Trace) -> anyhow::Result<Claim> {
    let [black, white, _] = only(frames, 1)?;
    let p = binomial(white as u64, (black + white) as u64, SALT);
    let number = format!("{:.2} % of {:.0}, p {p:.2}", 100.0 * white / (black + white), black + white);
    let ours = "white pixels among these, compared with the 30 % that the profile sets (the paper gives no number)";
    Ok(claim("5", "a replaced pixel is randomly white or black", ours, number, p >= REJECT))
}

fn lost(channel: &Trace) -> anyhow::Result<Claim> {
    let [arrived, _] = only(channel, 2)?;
    let missing = MESSAGES - arrived as u64;
    let p = binomial(missing, MESSAGES, PACKET_LOSS);
    let number = format!("{:.2} % of {MESSAGES}, p {p:.2}", 100.0 * missing as f64 / MESSAGES as f64);
    Ok(claim(
        "5.1",
        "whole packages are dropped with probability P_p",
        "messages that did not arrive against P_p = 5 %",
        number,
        p >= REJECT,
    ))
}

fn flipped(channel: &Trace) -> anyhow::Result<Claim> {
    let [arrived, wrong] = only(channel, 2)?;
    let bits = arrived as u64 * BITS;
    let p = binomial(wrong as u64, bits, BIT_ERRORS);
    let number = format!("{:.2e} of {bits} bits, p {p:.2}", wrong / bits as f64);
    Ok(claim(
        "5.1",
        "the binary symmetric channel swaps each bit with probability P_b",
        "wrong bits of the others against P_b = 0.001",
        number,
        p >= REJECT,
    ))
}

fn table(trace: &Trace) -> anyhow::Result<Claim> {
    let times: Vec<f64> =
        trace.of_robot(1).filter(|entry| matches!(entry.event, Event::Distance { .. })).map(|entry| entry.at).collect();
    anyhow::ensure!(times.len() == 3000, "{} readings", times.len());
    let worst = times.array_windows().map(|[one, next]| (1e6 * (next - one) - COST_US).abs()).fold(0.0, f64::max);
    let ours = "PSDGet, 1500 us in the table, 3000 times with computing of different lengths between: deviation of the time between two calls";
    Ok(claim(
        "6.1",
        "virtual time adds up the table's execution times of RoBIOS calls; native C is neglected",
        ours,
        format!("{worst:.3} us at most"),
        worst < 1e-3,
    ))
}

fn no_future(trace: &Trace) -> anyhow::Result<Claim> {
    let (mut received, mut future) = (0.0, 0.0);
    for robot in 1..=SENDERS as u32 {
        let [messages, early] = only(trace, robot)?;
        received += messages;
        future += early;
    }
    let number = format!("{future:.0} of {received:.0}");
    let ours =
        "messages that were received before the time that they carry, among 8 robots that send at random instants";
    Ok(claim(
        "6.2",
        "synchronization excludes messages from the future",
        ours,
        number,
        future == 0.0 && received > 1000.0,
    ))
}

fn semaphores(tasks: &Trace, loose: &Trace) -> anyhow::Result<Claim> {
    let [count, ..] = only::<4>(tasks, 1)?;
    let [without, ..] = only::<4>(loose, 1)?;
    let number = format!("{count:.0} of 200 counts; without the semaphore {without:.0}");
    let ours = "four pre-emptive tasks count to 50 each and wait within each count, under a semaphore and without";
    Ok(claim(
        "7",
        "semaphores are available for secure inter-thread communication",
        ours,
        number,
        count == 200.0 && without < 200.0,
    ))
}

fn suspended(tasks: &Trace) -> anyhow::Result<Claim> {
    let [_, turns, while_suspended, after_kill] = only(tasks, 1)?;
    let number = format!("{while_suspended:.0} while suspended, {after_kill:.0} after the kill, of {turns:.0}");
    let ours = "turns of a task that another suspends, readies and kills";
    Ok(claim(
        "7",
        "threads can be suspended, resumed and terminated by other threads",
        ours,
        number,
        while_suspended == 0.0 && after_kill == 0.0 && turns > 100.0,
    ))
}

fn many(trace: &Trace) -> anyhow::Result<Claim> {
    let seeing = (1..=CROWD as u32).map(|robot| only::<1>(trace, robot)).collect::<anyhow::Result<Vec<_>>>()?;
    let seeing = seeing.iter().filter(|[levels]| *levels > 1.0).count();
    let ours = "robots in one scene that took an image with more than one grey level";
    Ok(claim(
        "8",
        "no restrictions in the number of robots with vision systems",
        ours,
        format!("{seeing} of {CROWD}"),
        seeing == CROWD,
    ))
}
