// Messages between server and page, generated from `sim-view/src/protocol`:
// INSTA_UPDATE=always cargo test -p sim-view typescript

/** Version of the protocol. */
export const PROTOCOL = 2;

/** User intervention at the start of a slot. Traces contain it in this form, so that a run can be repeated. */
export type Action = { "do": "press",
  /** Number of the robot. */
  robot: number,
  /** Key in the notation of `--keys`: `KEY1` to `KEY4`, `TOUCH(120,40)`, `IRTV_OK`. */
  key: string, } | { "do": "type",
  /** Number of the robot. */
  robot: number,
  /** The line, without its line break. */
  line: string, } | { "do": "place_robot",
  /** Number of the robot. */
  robot: number,
  /** World x coordinate. */
  x_m: number,
  /** World y coordinate. */
  y_m: number,
  /** Heading, counter-clockwise from x. */
  phi_rad: number, } | { "do": "place_object",
  /** Number of the object. */
  object: number,
  /** World x coordinate. */
  x_m: number,
  /** World y coordinate. */
  y_m: number,
  /** Heading, counter-clockwise from x. */
  phi_rad: number, } | { "do": "set_noise",
  /** Number of the robot; none for all. */
  robot: number | null,
  /** Table and key of the noise profile, such as `psd.sigma_mm`. */
  parameter: string,
  /** Value in the profile's unit. */
  value: number, } | { "do": "switch_sensor",
  /** Number of the robot. */
  robot: number,
  /** Name of the sensor. */
  sensor: string,
  /** True to switch it on. */
  on: boolean, } | { "do": "add_robot",
  /** Name of the type, one of those that can be added (`addable_types` of the scene). */
  kind: string,
  /** Number of the robot whose program it runs; none for a robot without a program. */
  program_of: number | null,
  /** World x coordinate. */
  x_m: number,
  /** World y coordinate. */
  y_m: number,
  /** Heading, counter-clockwise from x. */
  phi_rad: number, } | { "do": "remove_robot",
  /** Number of the robot. */
  robot: number, } | { "do": "add_object",
  /** Name of the type, one of those that can be added (`addable_types` of the scene). */
  kind: string,
  /** World x coordinate. */
  x_m: number,
  /** World y coordinate. */
  y_m: number,
  /** Heading, counter-clockwise from x. */
  phi_rad: number, } | { "do": "remove_object",
  /** Number of the object. */
  object: number, } | { "do": "end", };

/** Types of bodies that can be added to a scene. */
export type AddableTypes = {
  /** Types of robots. */
  robots: Array<string>,
  /** Types of movable objects. */
  objects: Array<string>, };

/** Outcome of a command. */
export type Answer = {
  /** Number that the page gave the command. */
  number: number,
  /** Reason for the refusal; `None` if the command was carried out. */
  refused: string | null, };

/** Attachment of a part. */
export type Attachment = { "on": "world",
  /** Kind of the part: `wall`, `object` or `terrain`. */
  what: string,
  /** Pose of its frame in the world frame. */
  at: Point, } | { "on": "robot",
  /** Its number. */
  robot: number, } | { "on": "link",
  /** Number of the robot. */
  robot: number,
  /** Index of the link in [`Robot::links`]. */
  link: number, } | { "on": "object",
  /** Its number. */
  object: number, };

/** A beam of a range or infrared sensor. */
export type Beam = {
  /** Number of the robot. */
  robot: number,
  /** Index of the sensor in [`Robot::sensors`](super::Robot::sensors). */
  sensor: number,
  /** Origin of the beam. */
  from_m: [number, number, number],
  /** End of the beam: the measured point, or the end of the range if there is no hit. */
  to_m: [number, number, number],
  /** True if the beam hits something within its range. */
  is_hit: boolean, };

/** Cylinder around a body; its axis passes through the origin of the body's frame. */
export type Body = {
  /** Radius. */
  radius_m: number,
  /** Height above the floor. */
  height_m: number, };

/** Progress of building the programs. */
export type Build = { "state": "running" } | { "state": "done" } | { "state": "failed",
  /** Output of the compiler. */
  output: string, };

/** A camera of a robot. */
export type Camera = {
  /** Pose in the robot's frame; the camera looks along its own x axis, z points upwards. */
  mount: Point,
  /** Full horizontal angle of view. */
  horizontal_rad: number,
  /** Full vertical angle of view. */
  vertical_rad: number, };

/** A check of the scene at one instant. */
export type CheckState = {
  /** Its name. */
  name: string,
  /** Its verdict so far. */
  verdict: CheckVerdict,
  /** The verdict in words. */
  text: string,
  /** Current value of a metric that changes over time; none for other checks. */
  value: number | null, };

/** Verdict of a check so far. */
export type CheckVerdict = "open" | "met" | "failed";

/** Command of a page. */
export type Command = { "command": "run", } | { "command": "pause", } | { "command": "step", } | { "command": "speed",
  /** Simulated seconds for each second of real time; none for as fast as possible. */
  factor: number | null, } | { "command": "restart",
  /** Seed of the new run. */
  seed: Seed, } | { "command": "act",
  /** The intervention. */
  action: Action, };

/** Details of one robot. */
export type Detail = {
  /** Number of the run. */
  run: number,
  /** Number of the robot. */
  robot: number,
  /** Simulated time. */
  t_s: number,
  /** True pose. */
  pose: Pose,
  /** Pose according to its odometry. */
  odometry: Pose,
  /** Picture of the display; none if unchanged since the previous detail. */
  lcd: Picture | null,
  /** The lines of text on the display, the menu last. */
  lcd_text: Array<string>,
  /** Noise-free picture of its camera, if the page requests it. */
  camera: Picture | null,
  /** Latest readings of its devices and latest commands of its program. */
  readings: Array<Reading>,
  /** Its sensors, in the order of the scene. */
  sensors: Array<SensorState>,
  /** Parameters of its noise models. */
  noise: Array<Parameter>,
  /** Scan of its laser scanner. */
  scan: Scan | null, };

/** Contents of a display from a time on. */
export type DisplayChange = {
  /** Time at which the contents appear. */
  t_s: number,
  /** The lines of text, the menu last. */
  lines: Array<string>, };

/** Event in a run. */
export type Event = {
  /** Its number within the run, from 1. */
  number: number,
  /** Virtual time. */
  t_s: number,
  /** Number of the robot; none for the world. */
  robot: number | null,
  /** Kind as in `docs/trace.md`, such as `contact` or `radio_sent`. */
  kind: string,
  /** Description in words. */
  text: string,
  /** Fields as in `docs/trace.md`. */
  fields: Record<string, unknown>, };

/** A batch of events. */
export type Events = {
  /** Events in order. */
  events: Array<Event>,
  /** Number of other events that the page misses: it was too slow or connected too late, or too many happened at once. */
  missed: number, };

/** A rectangle with one corner at the origin. */
export type Floor = {
  /** Size along x and y. */
  size_m: [number, number],
  /** Colour if it has no image. */
  colour: [number, number, number],
  /** Index in [`Scene::images`] of the image stretched over it. */
  image: number | null, };

/** The plane z = 0. */
export type Ground = {
  /** Colour around the floor. */
  colour: [number, number, number],
  /** The world's floor. */
  floor: Floor | null,
  /** Discs painted on the floor; later ones cover earlier ones. */
  spots: Array<Spot>, };

/** An image. */
export type Image = {
  /** Its PNG as a `data:` URL. */
  url: string, };

/** A layer that the program of a robot shows. It replaces an earlier layer of the same name. */
export type Layer = {
  /** Number of the run. */
  run: number,
  /** Number of the robot. */
  robot: number,
  /** Name of the layer. */
  name: string,
  /** Virtual time at which the program showed it. */
  t_s: number,
  /** World pose of the frame of its coordinates. */
  frame: Pose,
  /** Its content. */
  content: LayerContent, };

/** Content of a layer. Numbers are little endian, in base64. */
export type LayerContent = { "kind": "grid",
  /** Corner with the smallest coordinates. */
  corner_m: [number, number],
  /** Side of a cell. */
  cell_m: number,
  /** Number of cells along x. */
  columns: number,
  /** Number of cells along y. */
  rows: number,
  /** A byte for each cell, row by row from the smallest y: 0 (free) to 100 (occupied), or 255 (unknown). */
  cells: string, } | { "kind": "points",
  /** x, y and z of each point in metres, `f32`. */
  positions: string, } | { "kind": "line",
  /** x, y and z of each point in metres, `f32`. */
  positions: string, };

/** A display. */
export type Lcd = {
  /** Width and height. */
  size_px: [number, number],
  /** True for the display of RoBIOS-7, which has colours and a touch screen. */
  has_colours: boolean, };

/** The sun. */
export type Light = {
  /** Unit vector towards the sun. */
  towards: [number, number, number],
  /** Share of ambient light. */
  ambient: number,
  /** Share of direct sunlight. */
  diffuse: number,
  /** True if bodies cast shadows. */
  shadows: boolean, };

/** A rigid part of a robot that turns about an axis. */
export type Link = {
  /** Index of its parent in [`Robot::links`]; none for the body. */
  parent: number | null,
  /** Pose of its frame in its parent's frame at a joint angle of 0. */
  origin: Point,
  /** Axis of its joint through its origin, a unit vector of its frame; angles are right-handed about it. */
  axis: [number, number, number],
  /** Index of the joint's angle in [`RobotState::joints_rad`](super::RobotState::joints_rad); none for a fixed link. */
  joint: number | null, };

/** Material of a range of triangles. */
export type Material = {
  /** Number of triangles that have it. */
  triangles: number,
  /** Colour, multiplied by the colour of the image if there is one. */
  colour: [number, number, number],
  /** Index of its texture in [`Scene::images`]. */
  image: number | null, };

/** A surface of triangles, seen from both sides, in its own frame. Numbers are little endian, in base64. */
export type Mesh = {
  /** Three corners of each triangle, x, y and z of each in metres, `f32`: 36 bytes a triangle. */
  positions: string,
  /** Unit normals of the corners, `f32`, if any are smooth; none if all triangles are flat. */
  normals: string | null,
  /** Texture coordinates of the corners, u to the right and v upwards, `f32`: 24 bytes a triangle. */
  uvs: string | null,
  /** Materials in the order of the triangles: each applies to the next [`Material::triangles`] of them. */
  materials: Array<Material>, };

/** Message from the server to a page. */
export type Message = { "type": "welcome" } & Welcome | { "type": "scene" } & Scene | { "type": "snapshot" } & Snapshot | { "type": "detail" } & Detail | { "type": "layer" } & Layer | { "type": "events" } & Events | { "type": "build" } & Build | { "type": "answer" } & Answer;

/** Piece of motion of a body, with constant rates in the body's frame. */
export type MotionPiece = {
  /** Start time. */
  t_s: number,
  /** Pose of the robot's frame at the start. */
  from: Pose,
  /** Forward speed. */
  v_m_per_s: number,
  /** Speed to the left. */
  left_m_per_s: number,
  /** Turning speed. */
  omega_rad_per_s: number,
  /** Duration; the body is at rest afterwards. */
  lasts_s: number, };

/** Constant properties of a movable object. */
export type Object = {
  /** Its number. */
  id: number,
  /** Name of its type. */
  kind: string,
  /** Its extent. */
  body: Body, };

/** A movable object at one instant. */
export type ObjectState = {
  /** Its number. */
  id: number,
  /** Its pose. */
  pose: Pose, };

/** Parameter of a noise model that can be set. */
export type Parameter = {
  /** Table and key of the noise profile, such as `psd.sigma_mm`. */
  name: string,
  /** Short description. */
  what: string,
  /** Its value. */
  value: number,
  /** Minimum and maximum value. */
  range: [number, number],
  /** Unit of the value; empty for a ratio. */
  unit: string, };

/** Mesh placed in the world or on a body. */
export type Part = {
  /** Index of its mesh in [`Scene::meshes`]. */
  mesh: number,
  /** Attachment of the mesh. */
  place: Attachment, };

/** A picture. */
export type Picture = {
  /** Its PNG as a `data:` URL. */
  url: string,
  /** Width and height. */
  size_px: [number, number], };

/** A pose in space. */
export type Point = {
  /** x, y, z. */
  position_m: [number, number, number],
  /** Quaternion x, y, z, w. */
  rotation: [number, number, number, number], };

/** A pose in the plane. */
export type Pose = {
  /** World x coordinate. */
  x_m: number,
  /** World y coordinate. */
  y_m: number,
  /** Heading, counter-clockwise from x, including whole turns. */
  phi_rad: number, };

/** Postures of a robot over time, at most 50 a second. */
export type Postures = {
  /** Times, in order. Before the first, the robot is at rest in its standing posture. */
  t_s: Array<number>,
  /** Heights of the robot's frame above the floor's plane, one for each time. */
  lift_m: Array<number>,
  /** Angles of all joints at each time, one time after the other. */
  joints_rad: Array<number>, };

/** Latest reading of a device. */
export type Reading = {
  /** Name of the device or of the quantity: `PSD_FRONT`, `odometry x`. */
  name: string,
  /** Its value; none when there was nothing to measure. */
  value: number | null,
  /** Unit of the value; empty for a count. */
  unit: string,
  /** Virtual time of the reading. */
  at_s: number, };

/** A recorded run: `GET /recording.json` of a replay, and the text of the element `recording` in a single-file page. */
export type Recording = {
  /** The world and all bodies that were in it at any time. */
  scene: Scene,
  /** Simulated time at the end. */
  duration_s: number,
  /** Reason why the run ended, in words. */
  why: string,
  /** Digest of the run; empty if the trace is not complete. */
  digest: string,
  /** Notices for the user: the trace is truncated, or the scene's files have changed since. */
  remarks: Array<string>,
  /** Histories of the robots, in the order of the scene. */
  robots: Array<RobotHistory>,
  /** Tracks of the movable objects, in the order of the scene. */
  objects: Array<Track>,
  /** Events in order. */
  events: Array<Event>,
  /** Number of events omitted because their kinds are too frequent. */
  events_left_out: number, };

/** Message of a page. */
export type Request = { "type": "hello",
  /** The page's version of the protocol. */
  protocol: number,
  /** The teacher's token, if the page has one. */
  token: string | null, } | { "type": "look",
  /** Number of the robot; none for no robot. */
  robot: number | null,
  /** True to include pictures of its camera. */
  camera: boolean,
  /** True to include its RoBIOS calls in the events. */
  calls: boolean, } | { "type": "act",
  /** Number of the command, chosen by the page. */
  number: number,
  /** The command. */
  command: Command, };

/** Constant properties of a robot. */
export type Robot = {
  /** Its number. */
  id: number,
  /** Its name. */
  name: string,
  /** Name of its type. */
  kind: string,
  /** Its program; empty for none. */
  program: string,
  /** Colour that distinguishes the robot from other robots. */
  colour: [number, number, number],
  /** Its extent. */
  body: Body,
  /** The links of its legs, parents before children. */
  links: Array<Link>,
  /** Angles of its joints while it stands. */
  standing_rad: Array<number>,
  /** Its sensors. */
  sensors: Array<Sensor>,
  /** Its camera. */
  camera: Camera | null,
  /** Its display. */
  lcd: Lcd, };

/** History of a robot. */
export type RobotHistory = {
  /** Its poses. */
  track: Track,
  /** Its postures; empty for a robot that has no legs and is not in the water. */
  postures: Postures,
  /** States of its program, in order of time. */
  standings: Array<StandingChange>,
  /** Texts on its display, in order of time. */
  lcd: Array<DisplayChange>, };

/** A robot at one instant. */
export type RobotState = {
  /** Its number. */
  id: number,
  /** Pieces of motion until the slot's end, in order of time; the first covers the snapshot's time. */
  motion: Array<MotionPiece>,
  /** Height of its frame above the floor's plane. */
  lift_m: number,
  /** Angles of its joints, one for each joint of [`Robot::links`](super::Robot::links). */
  joints_rad: Array<number>,
  /** State of its program. */
  standing: Standing,
  /** Its virtual time. */
  now_s: number,
  /** Reason why its program waits or has ended; empty if there is none. */
  why: string,
  /** True if the wheels are stalled. */
  is_stalled: boolean, };

/** State of a run. */
export type RunState = { "is": "running" } | { "is": "paused" } | { "is": "idle" } | { "is": "ended",
  /** Reason, in words. */
  why: string,
  /** Digest of the run. */
  digest: string, };

/** A scan. */
export type Scan = {
  /** Position of the scanner in the world frame. */
  from_m: [number, number, number],
  /** Points that it would measure now, in the world frame. */
  points_m: Array<[number, number, number]>, };

/** A run and all bodies in it. */
export type Scene = {
  /** Number of the run since the window was opened, from 1. */
  run: number,
  /** Name of the scene. */
  title: string,
  /** Seed of the run in decimal digits: JavaScript has no integers of 64 bits. */
  seed: string,
  /** Length of a slot. */
  slot_s: number,
  /** Lower left and upper right corner of the occupied area. */
  bounds_m: [[number, number], [number, number]],
  /** Images of textures. */
  images: Array<Image>,
  /** Surfaces; parts that look alike share one. */
  meshes: Array<Mesh>,
  /** Meshes placed in the world or on bodies. */
  parts: Array<Part>,
  /** The floor. */
  ground: Ground | null,
  /** The sun. */
  light: Light,
  /** The sky. */
  sky: Sky,
  /** All robots that are in the world, in order of their numbers. */
  robots: Array<Robot>,
  /** All movable objects that are in the world, in order of their numbers. */
  objects: Array<Object>,
  /** Types that can be added. */
  addable_types: AddableTypes, };

/** Seed of a restarted run. */
export type Seed = "same" | "new" | { "number": string };

/** A sensor of a robot. */
export type Sensor = {
  /** Its name, unique among the robot's sensors. */
  name: string,
  /** Its kind. */
  kind: SensorKind,
  /** Pose in the robot's frame; the sensor looks along its own x axis. */
  mount: Point | null,
  /** Minimum and maximum distance that it measures. */
  range_m: [number, number] | null,
  /** Half the angle of its beam, scan, sector or view; 0 for a ray. */
  half_angle_rad: number, };

/** Kinds of sensors. */
export type SensorKind = "psd" | "laser" | "ultrasonic" | "reflectance" | "sonar" | "lidar" | "infrared" | "bumper" | "compass" | "encoder" | "camera";

/** State of a sensor. */
export type SensorState = {
  /** Its name. */
  name: string,
  /** True if the sensor is switched on. */
  is_on: boolean, };

/** Colours of the sky. */
export type Sky = {
  /** At the horizon. */
  horizon: [number, number, number],
  /** Straight above. */
  zenith: [number, number, number], };

/** A run at one instant. */
export type Snapshot = {
  /** Number of the run, as in the scene. */
  run: number,
  /** Simulated time: the start of a slot. */
  t_s: number,
  /** State of the run. */
  state: RunState,
  /** Requested speed: simulated seconds for each second of real time; none for as fast as possible. */
  speed: number | null,
  /** Measured speed: simulated seconds for each second of real time. */
  rate: number,
  /** All robots that are in the world, in order of their numbers. */
  robots: Array<RobotState>,
  /** All movable objects that are in the world, in order of their numbers. */
  objects: Array<ObjectState>,
  /** Noise-free beams of the range and infrared sensors. */
  beams: Array<Beam>,
  /** The checks of the scene, in the order of the file. */
  checks: Array<CheckState>, };

/** A disc on the floor. */
export type Spot = {
  /** Its centre. */
  centre_m: [number, number],
  /** Its radius. */
  radius_m: number,
  /** Red, green, blue and opacity. */
  colour: [number, number, number, number], };

/** State of a program. */
export type Standing = "running" | "waiting" | "finished" | "failed" | "no_program";

/** State of a program from a time on. */
export type StandingChange = {
  /** Time at which the state begins. */
  t_s: number,
  /** The state. */
  standing: Standing,
  /** Reason; empty if there is none. */
  why: string, };

/** Poses of a body over time, thinned: linear interpolation between two points is accurate to 2 mm and 1 degree. */
export type Track = {
  /**
   * Times of the points, in order; two points have the same time where the body was placed elsewhere. Before the
   * first point the body is not in the world; after the last it stays there.
   */
  t_s: Array<number>,
  /** World x coordinates, one for each time. */
  x_m: Array<number>,
  /** World y coordinates, one for each time. */
  y_m: Array<number>,
  /** Headings, counter-clockwise from x, including whole turns, one for each time. */
  phi_rad: Array<number>,
  /** Time of its removal from the world; none if it was not removed. */
  until_s: number | null, };

/** Version of the server, and the rights of the page. */
export type Welcome = {
  /** Version of the protocol: [`PROTOCOL`]. */
  protocol: number,
  /** Version of the simulator. */
  version: string,
  /** Name of the scene. */
  title: string,
  /** False for a page that only watches: its commands are refused. */
  may_act: boolean, };
