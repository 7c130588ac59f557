//! Messages of the results of checks: what happened, when and where, and what was expected.

use glam::DVec2;
use sim_core::check::Finding;
use sim_core::record::Obstacle;
use sim_core::spec::{CheckKind, CountLimits, Region, SwarmMetric};
use sim_core::time::Time;
use sim_core::unit;

use super::tally::Count;

/// Turns a name that the report uses into words: `no_program` becomes `no program`.
pub(super) fn spaced(name: &str) -> String {
    name.replace('_', " ")
}

/// `12.345 s`.
fn seconds(seconds: f64) -> String {
    format!("{seconds:.3} s")
}

/// `230.1 mm`, or `230 mm` without a decimal for whole millimetres.
fn mm(metres: f64) -> String {
    let rounded = (unit::mm_from_metres(metres) * 10.0).round() / 10.0;
    // A value rounded to zero gets no minus sign.
    format!("{} mm", if rounded == 0.0 { 0.0 } else { rounded })
}

/// `(1250, 830.5) mm`.
fn point(point: DVec2) -> String {
    let [x, y] = point.to_array().map(|metres| mm(metres).trim_end_matches(" mm").to_owned());
    format!("({x}, {y}) mm")
}

fn percent(fraction: f64) -> String {
    // Rounds down, so that a fraction below a limit never looks as if it reached the limit.
    format!("{:.1} %", (fraction * 1000.0 + 1e-6).floor() / 10.0)
}

fn deadline_text(by: Option<Time>) -> String {
    by.map(|by| format!(" by {} s", by.seconds())).unwrap_or_default()
}

/// `at 5.200 s at (1250, 830) mm`.
fn at_text(finding: &Finding) -> String {
    let instant = finding.at.map(|at| format!("at {}", seconds(at)));
    let location = finding.position.map(|position| format!("at {}", point(position)));
    instant.into_iter().chain(location).collect::<Vec<_>>().join(" ")
}

fn region_text(region: &Region) -> String {
    match region {
        Region::Disc { centre, radius } => format!("within {} of {}", mm(*radius), point(*centre)),
        Region::Polygon(_) => "in the area".to_owned(),
    }
}

/// Returns true if the minimum `distance` of a body, m, shows that it was inside the region. The distance is measured
/// from the centre of a disc or from the border of a polygon. A body that was inside a polygon has crossed the border,
/// so its minimum distance is 0.
fn is_inside(region: &Region, distance: f64) -> bool {
    match region {
        Region::Disc { radius, .. } => distance <= *radius,
        Region::Polygon(_) => distance < 1e-6,
    }
}

/// Message of the result of a check on motion.
pub(super) fn of_finding(kind: &CheckKind, finding: &Finding) -> String {
    let (value, is_met) = (finding.value.unwrap_or_default(), finding.is_met);
    let when = finding.at.map(seconds).unwrap_or_default();
    match kind {
        // The body was there from 0 s.
        CheckKind::Reach { stay, .. } if is_met && finding.at == Some(stay.seconds()) => {
            format!("at {when}; it started there")
        }
        CheckKind::Reach { .. } if is_met => format!("at {when}"),
        CheckKind::Reach { body, region, by, stay } => match (finding.at, finding.value) {
            (Some(_), Some(distance)) if is_inside(region, distance) => {
                format!("{body} was {}, but never for {} s", region_text(region), stay.seconds())
            }
            (Some(_), Some(distance)) => {
                let to = if matches!(region, Region::Disc { .. }) { "the centre" } else { "the border" };
                format!(
                    "{body} was never {}; its smallest distance from {to} was {} {}",
                    region_text(region),
                    mm(distance),
                    at_text(finding)
                )
            }
            (Some(found), None) if by.is_some_and(|by| found > by.seconds()) => {
                format!("{body} met this only at {when}, not{}", deadline_text(*by))
            }
            (Some(_), None) => format!("{body} was there from {when} on, but not for {} s", stay.seconds()),
            (None, _) => format!("{body} was not there"),
        },
        CheckKind::Visits { places, .. } if is_met => format!("all {}, the last at {when}", places.len()),
        CheckKind::Visits { body, places, any_order, by, .. } => {
            let total = places.len();
            if value as usize == total {
                return format!("{body} visited the last place only at {when}, not{}", deadline_text(*by));
            }
            let missing = match places.get(value as usize).filter(|_| !any_order) {
                Some(next) => format!("; the next one is {}", point(*next)),
                None => String::new(),
            };
            let last = finding.at.map(|at| format!(", the last at {}", seconds(at))).unwrap_or_default();
            format!("{body} visited {value} of {total} places{last}{missing}")
        }
        CheckKind::StaysIn { .. } if is_met => "all the time".to_owned(),
        CheckKind::StaysIn { body, region } => format!("{body} was not {} {}", region_text(region), at_text(finding)),
        CheckKind::Laps { .. } if is_met => format!("{value}, complete at {when}"),
        CheckKind::Laps { body, min, by, .. } => match finding.at {
            Some(_) => format!("{body} completed {min} only at {when}, not{}", deadline_text(*by)),
            None => format!("{body} passed the gate {value} times, not {min}"),
        },
        CheckKind::Clearance { .. } if is_met && finding.value.is_some() => format!("smallest gap {}", mm(value)),
        CheckKind::Clearance { .. } if is_met => "nothing was near".to_owned(),
        CheckKind::Clearance { robot, min, .. } => {
            format!("the gap of {robot} fell below {} {}; the smallest was {}", mm(*min), at_text(finding), mm(value))
        }
        CheckKind::FollowsWall { .. } if is_met => format!("{} of the path", percent(value)),
        CheckKind::FollowsWall { robot, gap, share } => {
            let [min_gap, max_gap] = gap.map(mm);
            format!(
                "{robot} kept a gap of {min_gap} to {max_gap} on {} of its path, not {}",
                percent(value),
                percent(*share)
            )
        }
        CheckKind::Coverage { .. } if is_met => {
            format!("{}{}", percent(value), finding.at.map(|_| format!(", enough at {when}")).unwrap_or_default())
        }
        CheckKind::Coverage { share, by, .. } => match finding.at {
            Some(_) => format!("{} only at {when}, not{}", percent(*share), deadline_text(*by)),
            None => format!("{}, not {}", percent(value), percent(*share)),
        },
        CheckKind::Swarm { metric, .. } => {
            let number = |value: f64| match metric {
                SwarmMetric::Spread => mm(value),
                SwarmMetric::Coverage { .. } => percent(value),
                SwarmMetric::Order | SwarmMetric::Groups { .. } => format!("{}", (value * 1000.0).round() / 1000.0),
            };
            let limits = match kind {
                CheckKind::Swarm { min: Some(min), max: None, .. } => format!("at least {}", number(*min)),
                CheckKind::Swarm { min: None, max: Some(max), .. } => format!("at most {}", number(*max)),
                CheckKind::Swarm { min: Some(min), max: Some(max), .. } => {
                    format!("{} to {}", number(*min), number(*max))
                }
                _ => "any".to_owned(),
            };
            match (is_met, finding.value, finding.at) {
                (true, ..) => format!("{} at the end", number(value)),
                (_, None, _) if matches!(kind, CheckKind::Swarm { at_end: true, .. }) => {
                    "the metric has no value at the end: there is no robot, or none moves".to_owned()
                }
                (_, None, _) => "the metric never had a value: there was no robot, or none moved".to_owned(),
                (_, _, Some(_)) => format!("not {limits} {}; {} at the end", at_text(finding), number(value)),
                _ => format!("{} at the end, not {limits}", number(value)),
            }
        }
        CheckKind::OdometryError { at_end: true, .. } if is_met => format!("{} at the end", mm(value)),
        CheckKind::OdometryError { .. } if is_met => format!("at most {}", mm(value)),
        CheckKind::OdometryError { robot, max, at_end: true } => {
            format!("odometry of {robot} was wrong by {} at the end, not at most {}", mm(value), mm(*max))
        }
        CheckKind::OdometryError { robot, max, .. } => {
            format!(
                "odometry of {robot} was wrong by more than {} {}; the most was {}",
                mm(*max),
                at_text(finding),
                mm(value)
            )
        }
        _ => String::new(),
    }
}

/// Message of the result of a check on events.
pub(super) fn of_count(kind: &CheckKind, count: &Count) -> String {
    let number = count.number;
    match kind {
        CheckKind::Contacts { .. } if number == 0 => "no contact".to_owned(),
        CheckKind::Contacts { max, .. } if number <= *max => format!("{} of {max}", times(number)),
        CheckKind::Contacts { max, .. } => {
            let (robot, obstacle) =
                (count.robot.map(|robot| robot.to_string()).unwrap_or_default(), obstacle_text(count.obstacle));
            let when = count.at.map(seconds).unwrap_or_default();
            let touch_position = count.position.map(|position| point(DVec2::from(position))).unwrap_or_default();
            let first = if *max == 0 { "first" } else { "first above the limit" };
            let more = if number > 1 { format!("; {number} contacts in total") } else { String::new() };
            format!("{robot} touched {obstacle} at {when} at {touch_position} ({first}){more}")
        }
        CheckKind::Prints { robot, .. } => {
            let when = count.at.map(|at| format!(" at {}", seconds(at))).unwrap_or_default();
            count.search.as_ref().map(|search| search.explain(*robot, "printed") + &when).unwrap_or_default()
        }
        CheckKind::Event { count: wanted, by, event, .. } => {
            if count.is_late(*wanted, *by) {
                return format!(
                    "`{}` only at {}, not{}",
                    event.name(),
                    seconds(count.at.unwrap_or_default()),
                    deadline_text(*by)
                );
            }
            number_text(count, *wanted)
        }
        CheckKind::Calls { count: wanted, .. } | CheckKind::Message { count: wanted, .. } => {
            number_text(count, *wanted)
        }
        _ => String::new(),
    }
}

fn obstacle_text(obstacle: Option<Obstacle>) -> String {
    match obstacle {
        Some(Obstacle::Robot(id)) => format!("r{id}"),
        Some(Obstacle::Object(id)) => format!("o{id}"),
        Some(Obstacle::Terrain) => "the terrain".to_owned(),
        Some(Obstacle::Wall) | None => "a wall".to_owned(),
    }
}

fn number_text(count: &Count, wanted: CountLimits) -> String {
    let bounds = match wanted {
        _ if wanted.contains(count.number) => return times(count.number),
        CountLimits { min, max: None } => format!("at least {}", times(min)),
        CountLimits { min: 0, max: Some(max) } => format!("at most {}", times(max)),
        CountLimits { min, max: Some(max) } => format!("{min} to {max} times"),
    };
    // The number is outside the limits, so a number above the minimum is above the maximum.
    let is_too_often = count.number > wanted.min;
    let (what, since) = if wanted.max == Some(0) {
        ("allowed is none".to_owned(), "first at")
    } else {
        (format!("not {bounds}"), "too often since")
    };
    let since = count.at.filter(|_| is_too_often).map(|at| format!(", {since} {}", seconds(at)));
    let robot = count.robot.filter(|_| is_too_often).map(|robot| format!(" ({robot})"));
    format!("{}, {what}{}{}", times(count.number), since.unwrap_or_default(), robot.unwrap_or_default())
}

fn times(number: u64) -> String {
    match number {
        0 => "never".to_owned(),
        1 => "once".to_owned(),
        number => format!("{number} times"),
    }
}
