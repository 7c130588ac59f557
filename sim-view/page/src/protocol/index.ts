// What server and page say to each other, made from `sim-view/src/protocol`:
// UPDATE_TYPES=1 cargo test -p sim-view typescript

/** Version of the protocol. */
export const PROTOCOL = 1;

/**
 * One thing that a person does to a simulation, at the start of a slot. Traces hold it in this form, so that a run can be
 * repeated.
 */
export type Action = { "do": "press",
  /** Number of the robot. */
  robot: number,
  /** As in a script of `--keys`: `KEY1` to `KEY4`, `TOUCH(120,40)`, `IRTV_OK`. */
  key: string, } | { "do": "place_robot",
  /** Number of the robot. */
  robot: number,
  /** World coordinate to the right. */
  x_m: number,
  /** World coordinate upwards. */
  y_m: number,
  /** Heading, counter-clockwise from x. */
  phi_rad: number, } | { "do": "place_object",
  /** Number of the object. */
  object: number,
  /** World coordinate to the right. */
  x_m: number,
  /** World coordinate upwards. */
  y_m: number,
  /** Heading, counter-clockwise from x. */
  phi_rad: number, } | { "do": "set_noise",
  /** Number of the robot; none for all. */
  robot: number | null,
  /** Table and key of the noise profile, such as `psd.sigma_mm`. */
  parameter: string,
  /** In the profile's unit. */
  value: number, } | { "do": "switch_sensor",
  /** Number of the robot. */
  robot: number,
  /** Name of the sensor. */
  sensor: string,
  /** Off or on. */
  on: boolean, } | { "do": "add_robot",
  /** Name of the type, one of those in the scene's workshop. */
  kind: string,
  /** The program of the robot that has this number; none for one that only stands there. */
  program_of: number | null,
  /** World coordinate to the right. */
  x_m: number,
  /** World coordinate upwards. */
  y_m: number,
  /** Heading, counter-clockwise from x. */
  phi_rad: number, } | { "do": "remove_robot",
  /** Number of the robot. */
  robot: number, } | { "do": "add_object",
  /** Name of the type, one of those in the scene's workshop. */
  kind: string,
  /** World coordinate to the right. */
  x_m: number,
  /** World coordinate upwards. */
  y_m: number,
  /** Heading, counter-clockwise from x. */
  phi_rad: number, } | { "do": "remove_object",
  /** Number of the object. */
  object: number, } | { "do": "end", };

/** What became of a command. */
export type Answer = {
  /** The page's number of the command. */
  number: number,
  /** Why it was refused; none when it was carried out. */
  refused: string | null, };

/** A beam of a range sensor. */
export type Beam = {
  /** Number of the robot. */
  robot: number,
  /** Place of the sensor in [`Robot::sensors`](super::Robot::sensors). */
  sensor: number,
  /** Where it begins. */
  from_m: [number, number, number],
  /** Where it ends: at the point that is measured, else at the end of the range. */
  to_m: [number, number, number],
  /** Whether it has met something. */
  is_hit: boolean, };

/** The cylinder around a body, in whose middle its frame has its origin. */
export type Body = {
  /** Radius. */
  radius_m: number,
  /** Height above the floor. */
  height_m: number, };

/** How the building of programs goes. */
export type Build = { "state": "running" } | { "state": "done" } | { "state": "failed",
  /** What the compiler said. */
  output: string, };

/** A camera of a robot. */
export type Camera = {
  /** Where it sits, in the robot's frame; x of its own frame is where it looks, z upwards. */
  mount: Point,
  /** Whole horizontal angle of view. */
  horizontal_rad: number,
  /** Whole vertical angle of view. */
  vertical_rad: number, };

/** What a page can have done. */
export type Command = { "command": "run", } | { "command": "pause", } | { "command": "step", } | { "command": "speed",
  /** Simulated seconds for each second of real time; none for as fast as possible. */
  factor: number | null, } | { "command": "restart",
  /** With which seed. */
  seed: Seed, } | { "command": "act",
  /** What. */
  action: Action, };

/** More of one robot. */
export type Detail = {
  /** Number of the run. */
  run: number,
  /** Number of the robot. */
  robot: number,
  /** Simulated time. */
  t_s: number,
  /** Where it is. */
  pose: Pose,
  /** Where it believes to be. */
  odometry: Pose,
  /** The display; none while it shows what it showed in the detail before. */
  lcd: Picture | null,
  /** The lines of text on the display, the menu last. */
  lcd_text: Array<string>,
  /** What its camera sees now, without errors, if the page wants it. */
  camera: Picture | null,
  /** What its program has read last of each device, and what it commanded. */
  readings: Array<Reading>,
  /** Its sensors, in the order of the scene. */
  sensors: Array<SensorState>,
  /** Its error models. */
  noise: Array<Parameter>,
  /** The last scan of its laser scanner. */
  scan: Scan | null, };

/** Something that happened. */
export type Event = {
  /** Its number within the run, from 1. */
  number: number,
  /** Virtual time. */
  t_s: number,
  /** Whose it is; none for the world. */
  robot: number | null,
  /** The name of `docs/trace.md`, such as `contact` or `radio_sent`. */
  kind: string,
  /** In words. */
  text: string,
  /** The fields of `docs/trace.md`. */
  fields: Record<string, unknown>, };

/** A batch of events. */
export type Events = {
  /** In order. */
  events: Array<Event>,
  /** How many before them this page has not got, since it was too slow or came too late. */
  missed: number, };

/** A rectangle with one corner in the origin. */
export type Floor = {
  /** Along x and y. */
  size_m: [number, number],
  /** Where it has no image. */
  colour: [number, number, number],
  /** Place in [`Scene::images`] of what is stretched over it. */
  image: number | null, };

/** The plane z = 0. */
export type Ground = {
  /** Around the floor. */
  colour: [number, number, number],
  /** The world's floor. */
  floor: Floor | null,
  /** Discs painted on it; later ones cover earlier ones. */
  spots: Array<Spot>, };

/** An image. */
export type Image = {
  /** Its PNG as a `data:` URL. */
  url: string, };

/** A display. */
export type Lcd = {
  /** Width and height. */
  size_px: [number, number],
  /** True for the display of RoBIOS-7, which has colours and feels touches. */
  has_colours: boolean, };

/** Motion at constant rates, in the body's own frame. */
export type Leg = {
  /** When it starts. */
  t_s: number,
  /** Where it starts: the pose of the robot's frame. */
  from: Pose,
  /** Speed ahead. */
  v_m_per_s: number,
  /** Speed to the left. */
  left_m_per_s: number,
  /** Turning speed. */
  omega_rad_per_s: number,
  /** How long it lasts; then the body rests. */
  lasts_s: number, };

/** What became of a robot. */
export type Life = {
  /** Where it was. */
  track: Track,
  /** How its program stood, from when on; in order of time. */
  standings: Array<Stood>,
  /** The texts on its display, from when on; in order of time. */
  lcd: Array<Shown>, };

/** The sun. */
export type Light = {
  /** Unit vector towards it. */
  towards: [number, number, number],
  /** Share of light from everywhere. */
  ambient: number,
  /** Share of the sun. */
  diffuse: number,
  /** Whether things throw shadows. */
  shadows: boolean, };

/** How a range of triangles looks. */
export type Material = {
  /** Number of triangles that have it. */
  triangles: number,
  /** Its colour; that of the image is multiplied with it. */
  colour: [number, number, number],
  /** Place of its texture in [`Scene::images`]. */
  image: number | null, };

/** A surface of triangles, seen from both sides, in its own frame. Numbers are little endian, in base64. */
export type Mesh = {
  /** Three corners of each triangle, x, y and z of each in metres, `f32`: 36 bytes a triangle. */
  positions: string,
  /** Unit normals of the corners, `f32`, where they are smooth: else the triangles are flat. */
  normals: string | null,
  /** Texture coordinates of the corners, u to the right and v upwards, `f32`: 24 bytes a triangle. */
  uvs: string | null,
  /** The materials, each for the triangles from the end of the one before. */
  materials: Array<Material>, };

/** What the server says. */
export type Message = { "type": "welcome" } & Welcome | { "type": "scene" } & Scene | { "type": "snapshot" } & Snapshot | { "type": "detail" } & Detail | { "type": "events" } & Events | { "type": "build" } & Build | { "type": "answer" } & Answer;

/** What is known of a movable object from the start. */
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
  /** Where it is. */
  pose: Pose, };

/** A number of an error model that can be set. */
export type Parameter = {
  /** Table and key of the noise profile, such as `psd.sigma_mm`. */
  name: string,
  /** What it is, in a few words. */
  what: string,
  /** Its value. */
  value: number,
  /** Least and greatest value. */
  range: [number, number],
  /** Unit of the value; empty for a share. */
  unit: string, };

/** A surface that stands somewhere. */
export type Part = {
  /** Place of its surface in [`Scene::meshes`]. */
  mesh: number,
  /** Where it stands. */
  place: Place, };

/** A picture. */
export type Picture = {
  /** Its PNG as a `data:` URL. */
  url: string,
  /** Width and height. */
  size_px: [number, number], };

/** Where a part stands. */
export type Place = { "on": "world",
  /** What it is: `wall`, `object` or `terrain`. */
  what: string,
  /** Its frame in that of the world. */
  at: Point, } | { "on": "robot",
  /** Its number. */
  robot: number, } | { "on": "object",
  /** Its number. */
  object: number, };

/** A pose in space. */
export type Point = {
  /** x, y, z. */
  position_m: [number, number, number],
  /** Quaternion x, y, z, w. */
  rotation: [number, number, number, number], };

/** A pose in the plane. */
export type Pose = {
  /** World coordinate to the right. */
  x_m: number,
  /** World coordinate upwards. */
  y_m: number,
  /** Heading, counter-clockwise from x; whole turns are in it. */
  phi_rad: number, };

/** What was read of a device. */
export type Reading = {
  /** Name of the device, or of what is read: `PSD_FRONT`, `odometry x`. */
  name: string,
  /** Its value; none when there was nothing to measure. */
  value: number | null,
  /** Unit of the value; empty for a count. */
  unit: string,
  /** When it was read. */
  at_s: number, };

/** A recorded run: `GET /recording.json` of a replay, and the text of the element `recording` in a page that is one file. */
export type Recording = {
  /** The world and all bodies that have ever been in it. */
  scene: Scene,
  /** Simulated time at the end. */
  duration_s: number,
  /** Why the run ended, in words. */
  why: string,
  /** Digest of the run; empty where the trace is not complete. */
  digest: string,
  /** What the user should know: that the trace is cut off, or that the scene's files have changed since. */
  remarks: Array<string>,
  /** One for each robot of the scene, in the same order. */
  robots: Array<Life>,
  /** One for each movable object of the scene, in the same order. */
  objects: Array<Track>,
  /** What happened, in order. */
  events: Array<Event>,
  /** How many events are left out, of kinds that come too often to be kept. */
  events_left_out: number, };

/** What a page says. */
export type Request = { "type": "hello",
  /** The page's version of the protocol. */
  protocol: number,
  /** The teacher's token, where the page has one. */
  token: string | null, } | { "type": "look",
  /** Number of the robot; none for no robot. */
  robot: number | null,
  /** With what its camera sees. */
  camera: boolean,
  /** With its RoBIOS calls among the events. */
  calls: boolean, } | { "type": "act",
  /** The page's own number of the command. */
  number: number,
  /** What to do. */
  command: Command, };

/** What is known of a robot from the start. */
export type Robot = {
  /** Its number. */
  id: number,
  /** Its name. */
  name: string,
  /** Name of its type. */
  kind: string,
  /** Its program; empty for none. */
  program: string,
  /** Colour by which it is told from others. */
  colour: [number, number, number],
  /** Its extent. */
  body: Body,
  /** Its sensors. */
  sensors: Array<Sensor>,
  /** Its camera. */
  camera: Camera | null,
  /** Its display. */
  lcd: Lcd, };

/** A robot at one instant. */
export type RobotState = {
  /** Its number. */
  id: number,
  /** How it moves from the snapshot's time to the slot's end; the first leg holds at the snapshot's time. */
  legs: Array<Leg>,
  /** How its program stands. */
  standing: Standing,
  /** Its virtual time. */
  now_s: number,
  /** What its program waits for, or why it ended; empty where there is nothing to say. */
  why: string,
  /** Whether its wheels stall. */
  is_stalled: boolean, };

/** How a run stands. */
export type RunState = { "is": "running" } | { "is": "paused" } | { "is": "idle" } | { "is": "ended",
  /** Why, in words. */
  why: string,
  /** Its digest. */
  digest: string, };

/** A scan. */
export type Scan = {
  /** Where the scanner is, in the world. */
  from_m: [number, number, number],
  /** The points that it would measure now, in the world. */
  points_m: Array<[number, number, number]>, };

/** A run and all that is in it. */
export type Scene = {
  /** Number of the run since the window was opened, from 1. */
  run: number,
  /** Name of the scene. */
  title: string,
  /** Seed of the run in decimal digits: JavaScript has no integers of 64 bits. */
  seed: string,
  /** Length of a slot. */
  slot_s: number,
  /** Lower left and upper right corner of all that stands there. */
  bounds_m: [[number, number], [number, number]],
  /** Images of textures. */
  images: Array<Image>,
  /** Surfaces; parts that look alike share one. */
  meshes: Array<Mesh>,
  /** What stands where. */
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
  /** What can be added. */
  workshop: Workshop, };

/** Seed of a run that starts anew. */
export type Seed = "same" | "new" | { "number": string };

/** A sensor of a robot. */
export type Sensor = {
  /** Its name, unique among the robot's. */
  name: string,
  /** What it is. */
  kind: SensorKind,
  /** Where it sits, in the robot's frame; x of its own frame is where it looks. */
  mount: Point | null,
  /** Least and greatest distance that it measures. */
  range_m: [number, number] | null,
  /** Half the angle of its beam; 0 for a ray. */
  half_angle_rad: number, };

/** Kinds of sensors. */
export type SensorKind = "psd" | "laser" | "ultrasonic" | "reflectance" | "sonar" | "lidar" | "infrared" | "bumper" | "compass" | "encoder" | "camera";

/** Whether a sensor is on. */
export type SensorState = {
  /** Its name. */
  name: string,
  /** Off or on. */
  is_on: boolean, };

/** What a display showed. */
export type Shown = {
  /** From when on. */
  t_s: number,
  /** Its lines of text, the menu last. */
  lines: Array<string>, };

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
  /** How the run stands. */
  state: RunState,
  /** The speed that was asked for: simulated seconds for each second of real time; none for as fast as possible. */
  speed: number | null,
  /** Simulated seconds for each second of real time, as they are. */
  rate: number,
  /** All robots that are in the world, in order of their numbers. */
  robots: Array<RobotState>,
  /** All movable objects that are in the world, in order of their numbers. */
  objects: Array<ObjectState>,
  /** What the range sensors would measure now, without errors. */
  beams: Array<Beam>, };

/** A disc on the floor. */
export type Spot = {
  /** Its middle. */
  centre_m: [number, number],
  /** Its radius. */
  radius_m: number,
  /** Red, green, blue and opacity. */
  colour: [number, number, number, number], };

/** How a program stands. */
export type Standing = "running" | "waiting" | "finished" | "failed" | "no_program";

/** How a program stood. */
export type Stood = {
  /** From when on. */
  t_s: number,
  /** How. */
  standing: Standing,
  /** Why; empty where there is nothing to say. */
  why: string, };

/** Where a body was. Thinned: between two points it is on the straight line and turns evenly, to within 2 mm and 1 degree. */
export type Track = {
  /**
   * Times of the points, in order: two at the same time where the body was put elsewhere. Before the first point the body is
   * not in the world; after the last it stays there.
   */
  t_s: Array<number>,
  /** World coordinates to the right, one for each time. */
  x_m: Array<number>,
  /** World coordinates upwards, one for each time. */
  y_m: Array<number>,
  /** Headings, counter-clockwise from x, whole turns in them, one for each time. */
  phi_rad: Array<number>,
  /** When it was taken out of the world; none if it never was. */
  until_s: number | null, };

/** Who speaks to the page, and what it may do. */
export type Welcome = {
  /** [`PROTOCOL`]. */
  protocol: number,
  /** Version of the simulator. */
  version: string,
  /** Name of the scene. */
  title: string,
  /** False for a page that only watches: its commands are refused. */
  may_act: boolean, };

/** What can be added to a scene. */
export type Workshop = {
  /** Types of robots. */
  robots: Array<string>,
  /** Types of movable objects. */
  objects: Array<string>, };
