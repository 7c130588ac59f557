// What server and page say to each other; the same names as in `sim-view/src/protocol`.

export type Action =
  | { do: "press"; robot: number; key: string }
  | { do: "place_robot"; robot: number; x_m: number; y_m: number; phi_rad: number }
  | { do: "place_object"; object: number; x_m: number; y_m: number; phi_rad: number }
  | { do: "set_noise"; robot: number | null; parameter: string; value: number }
  | { do: "switch_sensor"; robot: number; sensor: string; on: boolean }
  | { do: "add_robot"; kind: string; program_of: number | null; x_m: number; y_m: number; phi_rad: number }
  | { do: "remove_robot"; robot: number }
  | { do: "add_object"; kind: string; x_m: number; y_m: number; phi_rad: number }
  | { do: "remove_object"; object: number }
  | { do: "end" };

export type Event = {
  number: number;
  t_s: number;
  robot: number | null;
  kind: string;
  text: string;
  fields: Record<string, unknown>;
};
export type Events = { events: Event[]; missed: number };

export type Seed = "same" | "new" | { number: string };
export type Command =
  | { command: "run" }
  | { command: "pause" }
  | { command: "step" }
  | { command: "speed"; factor: number | null }
  | { command: "restart"; seed: Seed }
  | { command: "act"; action: Action };
export type Request =
  | { type: "hello"; protocol: number; token: string | null }
  | { type: "look"; robot: number | null; camera: boolean; calls: boolean }
  | { type: "act"; number: number; command: Command };

export type Welcome = { protocol: number; version: string; title: string; may_act: boolean };
export type Build = { state: "running" } | { state: "done" } | { state: "failed"; output: string };
export type Answer = { number: number; refused: string | null };
export type Message =
  | ({ type: "welcome" } & Welcome)
  | ({ type: "scene" } & Scene)
  | ({ type: "snapshot" } & Snapshot)
  | ({ type: "detail" } & Detail)
  | ({ type: "events" } & Events)
  | ({ type: "build" } & Build)
  | ({ type: "answer" } & Answer);

export type Image = { url: string };
export type Material = { triangles: number; colour: [number, number, number]; image: number | null };
export type Mesh = { positions: string; normals: string | null; uvs: string | null; materials: Material[] };
export type Point = { position_m: [number, number, number]; rotation: [number, number, number, number] };
export type Place =
  | { on: "world"; what: string; at: Point }
  | { on: "robot"; robot: number }
  | { on: "object"; object: number };
export type Part = { mesh: number; place: Place };
export type Floor = { size_m: [number, number]; colour: [number, number, number]; image: number | null };
export type Spot = { centre_m: [number, number]; radius_m: number; colour: [number, number, number, number] };
export type Ground = { colour: [number, number, number]; floor: Floor | null; spots: Spot[] };
export type Light = { towards: [number, number, number]; ambient: number; diffuse: number; shadows: boolean };
export type Sky = { horizon: [number, number, number]; zenith: [number, number, number] };
export type Body = { radius_m: number; height_m: number };
export type SensorKind =
  | "psd"
  | "laser"
  | "ultrasonic"
  | "reflectance"
  | "sonar"
  | "lidar"
  | "infrared"
  | "bumper"
  | "compass"
  | "encoder"
  | "camera";
export type Sensor = {
  name: string;
  kind: SensorKind;
  mount: Point | null;
  range_m: [number, number] | null;
  half_angle_rad: number;
};
export type Camera = { mount: Point; horizontal_rad: number; vertical_rad: number };
export type Lcd = { size_px: [number, number]; has_colours: boolean };
export type Robot = {
  id: number;
  name: string;
  kind: string;
  program: string;
  colour: [number, number, number];
  body: Body;
  sensors: Sensor[];
  camera: Camera | null;
  lcd: Lcd;
};
export type Object = { id: number; kind: string; body: Body };
export type Workshop = { robots: string[]; objects: string[] };
export type Scene = {
  run: number;
  title: string;
  seed: string;
  slot_s: number;
  bounds_m: [[number, number], [number, number]];
  images: Image[];
  meshes: Mesh[];
  parts: Part[];
  ground: Ground | null;
  light: Light;
  sky: Sky;
  robots: Robot[];
  objects: Object[];
  workshop: Workshop;
};

export type RunState =
  | { is: "running" }
  | { is: "paused" }
  | { is: "idle" }
  | { is: "ended"; why: string; digest: string };
export type Pose = { x_m: number; y_m: number; phi_rad: number };
export type Leg = {
  t_s: number;
  from: Pose;
  v_m_per_s: number;
  left_m_per_s: number;
  omega_rad_per_s: number;
  lasts_s: number;
};
export type Standing = "running" | "waiting" | "finished" | "failed" | "no_program";
export type RobotState = {
  id: number;
  legs: Leg[];
  standing: Standing;
  now_s: number;
  why: string;
  is_stalled: boolean;
};
export type ObjectState = { id: number; pose: Pose };
export type Beam = {
  robot: number;
  sensor: number;
  from_m: [number, number, number];
  to_m: [number, number, number];
  is_hit: boolean;
};
export type Snapshot = {
  run: number;
  t_s: number;
  state: RunState;
  speed: number | null;
  rate: number;
  robots: RobotState[];
  objects: ObjectState[];
  beams: Beam[];
};
export type Picture = { url: string; size_px: [number, number] };
export type Reading = { name: string; value: number | null; unit: string; at_s: number };
export type SensorState = { name: string; is_on: boolean };
export type Parameter = { name: string; what: string; value: number; range: [number, number]; unit: string };
export type Scan = { from_m: [number, number, number]; points_m: [number, number, number][] };
export type Detail = {
  run: number;
  robot: number;
  t_s: number;
  pose: Pose;
  odometry: Pose;
  lcd: Picture | null;
  lcd_text: string[];
  camera: Picture | null;
  readings: Reading[];
  sensors: SensorState[];
  noise: Parameter[];
  scan: Scan | null;
};
