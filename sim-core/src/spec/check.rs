//! Checks: conditions on a run of a scene. See `docs/checks.md`.

use glam::DVec2;

use crate::record::{Kind, Outcome};
use crate::spec::{Span, SpannedText};
use crate::time::Time;
use crate::{ObjectId, RobotId};

/// A condition that a run of the scene must meet.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckSpec {
    /// Name, unique in its scene; if empty, [`CheckSpec::title`] makes one.
    pub name: String,
    /// Points for a run that meets the condition, 0 or more.
    pub points: f64,
    /// True if a run that does not meet the condition gets no points at all.
    pub is_required: bool,
    /// The condition.
    pub kind: CheckKind,
    /// Location of its table in the file.
    pub span: Span,
}

impl CheckSpec {
    /// A check of this kind, without a name and worth one point.
    pub fn new(kind: CheckKind) -> Self {
        Self { name: String::new(), points: 1.0, is_required: false, kind, span: Span::default() }
    }

    /// Its name, or the word for its kind.
    pub fn title(&self) -> &str {
        if self.name.is_empty() { self.kind.word() } else { &self.name }
    }
}

impl Default for CheckSpec {
    fn default() -> Self {
        Self::new(CheckKind::Contacts { robot: None, with: ObstacleFilter::Anything, max: 0 })
    }
}

/// A condition on a run. Distances are in metres, world frame, and always true values, never readings of sensors or
/// odometry.
#[derive(Clone, Debug, PartialEq)]
pub enum CheckKind {
    /// The centre of a body reaches a place.
    Reach {
        /// The body.
        body: BodyRef,
        /// The place.
        region: Region,
        /// Time by which the body must have reached the place.
        by: Option<Time>,
        /// Time for which the body must stay in the place without interruption.
        stay: Time,
    },
    /// The centre of a body visits several places.
    Visits {
        /// The body.
        body: BodyRef,
        /// Centres of the places.
        places: Vec<DVec2>,
        /// Maximum distance from the centre of a place.
        within: f64,
        /// Time by which the last place must be visited.
        by: Option<Time>,
        /// True if the places may be visited in any order.
        any_order: bool,
    },
    /// The centre of a body never leaves a place.
    StaysIn {
        /// The body.
        body: BodyRef,
        /// The place.
        region: Region,
    },
    /// A body passes a gate a number of times.
    Laps {
        /// The body whose centre passes.
        body: BodyRef,
        /// Ends of the gate. A passage from the right to the left of the line from the first end to the second adds 1;
        /// an opposite passage subtracts 1.
        gate: [DVec2; 2],
        /// Minimum number of passages.
        min: u64,
        /// Time by which the passages must be complete.
        by: Option<Time>,
    },
    /// The gap between a robot's body and other bodies or walls is never smaller than a limit.
    Clearance {
        /// The robot.
        robot: RobotId,
        /// Minimum gap.
        min: f64,
        /// Bodies to which the gap is measured.
        to: Neighbours,
    },
    /// A robot drives along walls: for a fraction of its path, the gap to the nearest wall is within limits.
    FollowsWall {
        /// The robot.
        robot: RobotId,
        /// Minimum and maximum gap between body and wall.
        gap: [f64; 2],
        /// Minimum fraction of the length of the path, 0 to 1.
        share: f64,
    },
    /// A tool of this `width`, at the centre of each robot, covers a fraction of an area.
    Coverage {
        /// The robots; if empty, all robots of the scene.
        robots: Vec<RobotId>,
        /// Width of the tool.
        width: f64,
        /// Corners of the area; `None` for the floor.
        area: Option<Vec<DVec2>>,
        /// Side of the squares into which the area is divided; a square is covered if its centre is covered.
        cell: f64,
        /// Minimum fraction of the squares, 0 to 1.
        share: f64,
        /// Time by which this fraction must be reached.
        by: Option<Time>,
    },
    /// A swarm metric stays within limits; it is evaluated every 100 ms.
    Swarm {
        /// The robots; if empty, all robots of the scene.
        robots: Vec<RobotId>,
        /// The metric.
        metric: SwarmMetric,
        /// Minimum value.
        min: Option<f64>,
        /// Maximum value.
        max: Option<f64>,
        /// Time from which the limits apply.
        since: Time,
        /// True if the limits apply only at the end of the run.
        at_end: bool,
    },
    /// Odometry never deviates from the true pose by more than a limit.
    OdometryError {
        /// The robot.
        robot: RobotId,
        /// Maximum distance between the axle's odometry pose and its true pose.
        max: f64,
        /// True if the limit applies only at the end of the run.
        at_end: bool,
    },
    /// The number of contacts does not exceed a limit.
    Contacts {
        /// The robot; `None` for all robots together.
        robot: Option<RobotId>,
        /// The obstacles whose contacts are counted.
        with: ObstacleFilter,
        /// Maximum number.
        max: u64,
    },
    /// A number of the report is within limits.
    Metric {
        /// Path into the report, such as `robots[0].path_m`.
        path: String,
        /// Minimum value.
        min: Option<f64>,
        /// Maximum value.
        max: Option<f64>,
        /// Value that gives all points.
        full: Option<f64>,
        /// Value that gives no points; between the two values, points are interpolated linearly.
        zero: Option<f64>,
    },
    /// A program prints something.
    Prints {
        /// The robot.
        robot: RobotId,
        /// Output of the program.
        output: ProgramOutput,
        /// The expected text or numbers.
        expected: ExpectedOutput,
    },
    /// Programs end with a given outcome.
    Outcome {
        /// The robot; `None` for each robot that has a program.
        robot: Option<RobotId>,
        /// The outcome.
        outcome: Outcome,
    },
    /// Events of a kind happen a number of times.
    Event {
        /// The robot; `None` for all robots together.
        robot: Option<RobotId>,
        /// Kind of the events.
        event: Kind,
        /// Bounds of the number of times.
        count: CountLimits,
        /// Time by which the minimum number must be reached.
        by: Option<Time>,
    },
    /// A function of RoBIOS is called a number of times.
    Calls {
        /// The robot; `None` for all robots together.
        robot: Option<RobotId>,
        /// Name of the function.
        function: String,
        /// Bounds of the number of times.
        count: CountLimits,
    },
    /// Messages are read from the radio a number of times.
    Message {
        /// The sender; `None` for any sender.
        from: Option<RobotId>,
        /// The receiver; `None` for any receiver.
        to: Option<RobotId>,
        /// Text that the message contains; `None` for any message.
        text: Option<String>,
        /// Bounds of the number of times.
        count: CountLimits,
    },
    /// A program of the user judges the report and the trace.
    Script {
        /// The program, from `folder`.
        program: SpannedText,
        /// Arguments before the paths of report and trace.
        arguments: Vec<String>,
        /// Wall-clock time after which the program is killed.
        timeout: Time,
        /// Folder of the file that contains the check: the program's working folder.
        folder: String,
    },
}

impl CheckKind {
    /// Word for the kind in files and in the report.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Reach { .. } => "reach",
            Self::Visits { .. } => "visits",
            Self::StaysIn { .. } => "stays_in",
            Self::Laps { .. } => "laps",
            Self::Clearance { .. } => "clearance",
            Self::FollowsWall { .. } => "follows_wall",
            Self::Coverage { .. } => "coverage",
            Self::OdometryError { .. } => "odometry_error",
            Self::Contacts { .. } => "contacts",
            Self::Metric { .. } => "metric",
            Self::Prints { .. } => "prints",
            Self::Outcome { .. } => "outcome",
            Self::Event { .. } => "event",
            Self::Swarm { .. } => "swarm",
            Self::Calls { .. } => "calls",
            Self::Message { .. } => "message",
            Self::Script { .. } => "script",
        }
    }

    /// The robots and objects that the check names.
    pub fn bodies(&self) -> Vec<BodyRef> {
        let robot = |id: &RobotId| BodyRef::Robot(*id);
        match self {
            Self::Reach { body, .. }
            | Self::Visits { body, .. }
            | Self::StaysIn { body, .. }
            | Self::Laps { body, .. } => {
                vec![*body]
            }
            Self::Clearance { robot: id, .. }
            | Self::FollowsWall { robot: id, .. }
            | Self::OdometryError { robot: id, .. }
            | Self::Prints { robot: id, .. } => vec![robot(id)],
            Self::Coverage { robots, .. } | Self::Swarm { robots, .. } => robots.iter().map(robot).collect(),
            Self::Contacts { robot: id, .. }
            | Self::Outcome { robot: id, .. }
            | Self::Event { robot: id, .. }
            | Self::Calls { robot: id, .. } => id.iter().map(robot).collect(),
            Self::Message { from, to, .. } => from.iter().chain(to).map(robot).collect(),
            Self::Metric { .. } | Self::Script { .. } => Vec::new(),
        }
    }

    /// Returns true if the check counts calls of robot `id`, which may be spawned during the run.
    pub fn counts_calls_of(&self, id: RobotId) -> bool {
        matches!(self, Self::Calls { robot, .. } if robot.is_none_or(|robot| robot == id))
    }
}

/// A robot or a movable object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum BodyRef {
    /// The robot with this number.
    Robot(RobotId),
    /// The movable object with this number.
    Object(ObjectId),
}

impl std::fmt::Display for BodyRef {
    /// Formats the body as `r1` or `o2`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Robot(robot) => robot.fmt(f),
            Self::Object(object) => object.fmt(f),
        }
    }
}

/// A region of the floor, border included.
#[derive(Clone, Debug, PartialEq)]
pub enum Region {
    /// All points within a distance of a point.
    Disc {
        /// The point.
        centre: DVec2,
        /// The distance; 0 or more.
        radius: f64,
    },
    /// The inside of a polygon with at least three corners.
    Polygon(Vec<DVec2>),
}

/// Bodies to which a clearance is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Neighbours {
    /// Walls, fixed objects and robots.
    #[default]
    All,
    /// Walls and fixed objects.
    Walls,
    /// Robots.
    Robots,
}

/// Obstacles whose contacts are counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ObstacleFilter {
    /// Walls, terrain, robots, objects.
    #[default]
    Anything,
    /// Walls, fixed objects and terrain.
    Walls,
    /// Robots.
    Robots,
    /// Movable objects.
    Objects,
}

/// Output of a program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProgramOutput {
    /// Its standard output.
    #[default]
    Stdout,
    /// Its display, as it is at the end of the run.
    Display,
}

/// Text or numbers that a program must print.
#[derive(Clone, Debug, PartialEq)]
pub enum ExpectedOutput {
    /// A text within a line.
    Text(String),
    /// A whole line that matches a pattern, in which `*` matches any text.
    Pattern(String),
    /// Numbers, row by row, each within a tolerance; other words and lines may come before and after them.
    Numbers {
        /// The rows.
        rows: Vec<Vec<f64>>,
        /// Maximum deviation of a number.
        tolerance: f64,
    },
}

/// Minimum and maximum of a number of times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CountLimits {
    /// Minimum number.
    pub min: u64,
    /// Maximum number.
    pub max: Option<u64>,
}

impl Default for CountLimits {
    /// At least once.
    fn default() -> Self {
        Self { min: 1, max: None }
    }
}

impl CountLimits {
    /// Returns true if `count` is between minimum and maximum.
    pub fn contains(&self, count: u64) -> bool {
        self.min <= count && self.max.is_none_or(|max| count <= max)
    }
}

/// A metric of a swarm of robots.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum SwarmMetric {
    /// Mean distance of the robots from their centroid, m.
    #[default]
    Spread,
    /// Length of the mean of the moving robots' direction vectors: 1 if all robots move in the same direction.
    Order,
    /// Number of groups of robots that are connected by distances of at most `reach`.
    Groups {
        /// Maximum distance between neighbours, m.
        reach: f64,
    },
    /// Fraction of an area that a tool at each robot's centre has covered, 0 to 1.
    Coverage {
        /// Width of the tool, m.
        width: f64,
        /// Corners of the area; `None` for the floor.
        area: Option<Vec<DVec2>>,
        /// Side of the squares into which the area is divided, m; a square is covered if its centre is covered.
        cell: f64,
    },
}
