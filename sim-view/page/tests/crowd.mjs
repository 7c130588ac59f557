// A crowd without a simulator: any number of robots that drive on circles among walls, with beams and messages. Used by
// `scripts/frames.mjs`, or started by hand: `node tests/crowd.mjs [ROBOTS] [PORT]`.

import { fileURLToPath } from "node:url";
import { Mock, scene as mockScene } from "./mock.mjs";

const SLOT_S = 0.05;
const BEAMS = 6;

/** A crowd in a hall; `start()` lets it drive in real time. */
export async function crowd(count, port = 0) {
  const mock = await Mock.open(port);
  const size_m = Math.max(2, 0.6 * Math.sqrt(count));
  mock.scene = scene(count, size_m);
  const motions = Array.from({ length: count }, (_, i) => motion(i, count, size_m));
  let [t_s, number] = [0, 0];
  mock.start = () =>
    setInterval(() => {
      t_s += SLOT_S;
      mock.send(snapshot(motions, t_s));
      const events = [0, 1].map(() => fate(++number, t_s, count));
      if (number % 20 < 2) mock.send({ type: "events", events, missed: 0 });
    }, 1000 * SLOT_S);
  return mock;
}

function scene(count, size_m) {
  const wall = (x, y, length, angle, colour) => ({ x, y, length, angle, colour });
  const walls = [
    wall(0, 0, size_m, 0, [214, 120, 60]),
    wall(size_m, 0, size_m, 90, [90, 140, 200]),
    wall(size_m, size_m, size_m, 180, [214, 120, 60]),
    wall(0, size_m, size_m, 270, [90, 140, 200]),
  ];
  const at = (x, y, angle) => {
    const half = (angle * Math.PI) / 360;
    return { position_m: [x, y, 0], rotation: [0, 0, Math.sin(half), Math.cos(half)] };
  };
  const [base] = mockScene().robots;
  return {
    ...mockScene(),
    title: `${count} robots`,
    slot_s: SLOT_S,
    bounds_m: [[0, 0], [size_m, size_m]],
    meshes: [robotMesh(), ...walls.map(({ length, colour }) => box(length, 0.01, 0.12, colour))],
    parts: [
      ...walls.map(({ x, y, angle }, i) => ({ mesh: i + 1, place: { on: "world", what: "wall", at: at(x, y, angle) } })),
      ...Array.from({ length: count }, (_, i) => ({ mesh: 0, place: { on: "robot", robot: i + 1 } })),
    ],
    ground: { colour: [120, 140, 110], floor: { size_m: [size_m, size_m], colour: [206, 204, 198], image: null }, spots: [] },
    light: { towards: [-0.321, -0.557, 0.766], ambient: 0.35, diffuse: 0.45, shadows: false },
    robots: Array.from({ length: count }, (_, i) => ({
      ...base,
      id: i + 1,
      name: `robot${i + 1}`,
      colour: hue((360 * i * 0.618) % 360),
      body: { radius_m: 0.08, height_m: 0.09 },
      sensors: Array.from({ length: BEAMS }, (_, k) => ({ ...base.sensors[0], name: `PSD_${k}` })),
    })),
    objects: [],
  };
}

function motion(i, count, size_m) {
  const side = Math.ceil(Math.sqrt(count));
  const cell = size_m / side;
  const [x, y] = [cell * ((i % side) + 0.5), cell * (Math.floor(i / side) + 0.5)];
  const [radius, omega] = [0.25 * cell, (i % 2 ? 1 : -1) * (0.8 + 0.05 * (i % 7))];
  return (t_s) => {
    const angle = i + omega * t_s;
    return {
      pose: { x_m: x + radius * Math.cos(angle), y_m: y + radius * Math.sin(angle), phi_rad: angle + (Math.sign(omega) * Math.PI) / 2 },
      v_m_per_s: radius * Math.abs(omega),
      omega_rad_per_s: omega,
    };
  };
}

function snapshot(motions, t_s) {
  const now = motions.map((at) => at(t_s));
  return {
    type: "snapshot",
    run: 1,
    t_s,
    state: { is: "running" },
    speed: 1,
    rate: 1,
    robots: now.map(({ pose, v_m_per_s, omega_rad_per_s }, i) => ({
      id: i + 1,
      motion: [{ t_s, from: pose, v_m_per_s, left_m_per_s: 0, omega_rad_per_s, lasts_s: SLOT_S }], lift_m: 0, joints_rad: [],
      standing: "running",
      now_s: t_s,
      why: "",
      is_stalled: i % 40 === 7,
    })),
    objects: [],
    checks: [],
    beams: now.flatMap(({ pose: { x_m, y_m, phi_rad } }, i) =>
      Array.from({ length: BEAMS }, (_, sensor) => {
        const angle = phi_rad + (2 * Math.PI * sensor) / BEAMS;
        const [dx, dy] = [Math.cos(angle), Math.sin(angle)];
        const to_m = [x_m + 0.3 * dx, y_m + 0.3 * dy, 0.05];
        return { robot: i + 1, sensor, from_m: [x_m + 0.08 * dx, y_m + 0.08 * dy, 0.05], to_m, is_hit: sensor % 2 === 0 };
      }),
    ),
  };
}

function fate(number, t_s, count) {
  const [from, robot] = [1 + ((number * 7) % count), 1 + ((number * 13 + 5) % count)];
  const kind = number % 3 === 0 ? "radio_lost" : "radio_arrived";
  const fields = { from, message: number, arrived_s: t_s, bit_errors: 0, cause: "range" };
  return { number, t_s, robot, kind, text: `message ${number} of ${from}`, fields };
}

/** A round hull with a wedge at the front, with about as many triangles as the simulator's own robots. */
function robotMesh() {
  const sides = 96;
  const [body, wedge] = [[], []];
  const at = (radius, i, z) => [radius * Math.cos((2 * Math.PI * i) / sides), radius * Math.sin((2 * Math.PI * i) / sides), z];
  for (let i = 0; i < sides; i++) {
    for (const [r0, z0, r1, z1] of [[0.08, 0.01, 0.08, 0.07], [0.08, 0.07, 0.07, 0.085]])
      body.push(at(r0, i, z0), at(r0, i + 1, z0), at(r1, i + 1, z1), at(r0, i, z0), at(r1, i + 1, z1), at(r1, i, z1));
    body.push([0, 0, 0.085], at(0.07, i, 0.085), at(0.07, i + 1, 0.085));
  }
  wedge.push([0.06, 0, 0.087], [-0.03, 0.035, 0.087], [-0.03, -0.035, 0.087]);
  return mesh([...body, ...wedge], [
    { triangles: body.length / 3, colour: [70, 80, 90], image: null },
    { triangles: 1, colour: [250, 250, 250], image: null },
  ]);
}

function box(length, width, height, colour) {
  const c = (x, y, z) => [x * length, (y - 0.5) * width, z * height];
  const face = (a, b, c, d) => [a, b, c, a, c, d];
  const corners = [
    ...face(c(0, 0, 0), c(1, 0, 0), c(1, 0, 1), c(0, 0, 1)),
    ...face(c(0, 1, 0), c(1, 1, 0), c(1, 1, 1), c(0, 1, 1)),
    ...face(c(0, 0, 1), c(1, 0, 1), c(1, 1, 1), c(0, 1, 1)),
    ...face(c(0, 0, 0), c(0, 1, 0), c(0, 1, 1), c(0, 0, 1)),
    ...face(c(1, 0, 0), c(1, 1, 0), c(1, 1, 1), c(1, 0, 1)),
  ];
  return mesh(corners, [{ triangles: corners.length / 3, colour, image: null }]);
}

function mesh(corners, materials) {
  const positions = Buffer.from(new Float32Array(corners.flat()).buffer).toString("base64");
  return { positions, normals: null, uvs: null, materials };
}

function hue(degrees) {
  const part = (n) => {
    const k = (n + degrees / 60) % 6;
    return Math.round(255 * (0.85 - 0.65 * Math.max(0, Math.min(k, 4 - k, 1))));
  };
  return [part(5), part(3), part(1)];
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const mock = await crowd(Number(process.argv[2] ?? 100), Number(process.argv[3] ?? 7700));
  mock.start();
  console.log(mock.url);
}
