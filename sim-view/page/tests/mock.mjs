// A server that implements the protocol without a simulator, for situations that are hard to provoke with the real
// server. It serves `dist/`, answers commands by `Mock.answers`, and sends the messages of the test. Started by hand:
// `node tests/mock.mjs [PORT]`.

import { createHash } from "node:crypto";
import { readFile } from "node:fs/promises";
import { createServer } from "node:http";
import { fileURLToPath } from "node:url";

const DIST = fileURLToPath(new URL("../dist/", import.meta.url));
const TIMEOUT_MS = 60_000;
const TYPES = { html: "text/html", js: "text/javascript", css: "text/css" };

export class Mock {
  /** Messages of the pages, in order. */
  requests = [];
  /** Called with each command; returns the reason if the command is refused, otherwise null. */
  answers = () => null;
  welcome = { type: "welcome", protocol: 2, version: "0.1.0", title: "Mock", may_act: true };
  scene = scene();
  #sockets = new Set();
  #waiting = [];

  static async open(port = 0) {
    const mock = new Mock();
    mock.server = createServer(serve);
    mock.server.on("upgrade", (request, socket) => mock.#upgrade(request, socket));
    await new Promise((done) => mock.server.listen(port, "127.0.0.1", done));
    mock.url = `http://127.0.0.1:${mock.server.address().port}/`;
    return mock;
  }

  /** Sends a message to all pages. */
  send(message) {
    for (const socket of this.#sockets) socket.write(frame(JSON.stringify(message)));
  }

  /** Waits for a request for which `is` returns true, and returns it; it may already have arrived. */
  async request(is) {
    const deadline = Date.now() + TIMEOUT_MS;
    for (;;) {
      const found = this.requests.find(is);
      if (found) return found;
      if (Date.now() > deadline) throw new Error(`no such request; the last requests: ${JSON.stringify(this.requests.slice(-5))}`);
      await new Promise((done) => {
        this.#waiting.push(done);
        setTimeout(done, TIMEOUT_MS).unref();
      });
    }
  }

  /** Disconnects all pages. */
  cut() {
    for (const socket of this.#sockets) socket.destroy();
  }

  close() {
    this.cut();
    this.server.close();
  }

  #upgrade(request, socket) {
    const key = createHash("sha1").update(`${request.headers["sec-websocket-key"]}258EAFA5-E914-47DA-95CA-C5AB0DC85B11`);
    socket.write(
      "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n" +
        `Sec-WebSocket-Accept: ${key.digest("base64")}\r\n\r\n`,
    );
    this.#sockets.add(socket);
    socket.on("close", () => this.#sockets.delete(socket));
    socket.on("error", () => socket.destroy());
    let rest = Buffer.alloc(0);
    socket.on("data", (data) => {
      rest = Buffer.concat([rest, data]);
      for (let read; (read = unframe(rest)); rest = rest.subarray(read.length)) {
        if (read.opcode === 8) socket.end();
        if (read.opcode === 1) this.#receive(JSON.parse(read.text));
      }
    });
  }

  #receive(request) {
    this.requests.push(request);
    for (const done of this.#waiting.splice(0)) done();
    if (request.type === "hello") {
      this.send(this.welcome);
      this.send({ type: "scene", ...this.scene });
      this.send({ type: "snapshot", ...snapshot() });
    }
    if (request.type === "act") this.send({ type: "answer", number: request.number, refused: this.answers(request.command) });
  }
}

async function serve(request, response) {
  const name = request.url === "/" ? "index.html" : request.url.slice(1);
  try {
    const file = await readFile(DIST + name);
    response.setHeader("content-type", TYPES[name.split(".").at(-1)] ?? "application/octet-stream");
    response.end(file);
  } catch {
    response.statusCode = 404;
    response.end(`no ${name}`);
  }
}

/** Encodes a text frame of a server. */
function frame(text) {
  const payload = Buffer.from(text);
  const size = payload.length;
  const head = Buffer.alloc(size < 126 ? 2 : size < 65536 ? 4 : 10);
  head[0] = 0x81;
  head[1] = size < 126 ? size : size < 65536 ? 126 : 127;
  if (head.length === 4) head.writeUInt16BE(size, 2);
  if (head.length === 10) head.writeBigUInt64BE(BigInt(size), 2);
  return Buffer.concat([head, payload]);
}

/** Decodes the first frame of a client, which is masked; undefined while the frame is incomplete. */
function unframe(data) {
  if (data.length < 6) return undefined;
  const short = data[1] & 127;
  const start = short === 126 ? 4 : short === 127 ? 10 : 2;
  const size = short === 126 ? data.readUInt16BE(2) : short === 127 ? Number(data.readBigUInt64BE(2)) : short;
  const length = start + 4 + size;
  if (data.length < length) return undefined;
  const mask = data.subarray(start, start + 4);
  const text = Buffer.from(data.subarray(start + 4, length)).map((byte, at) => byte ^ mask[at % 4]);
  return { opcode: data[0] & 15, length, text: text.toString() };
}

const SENSORS = ["PSD_FRONT", "PSD_LEFT", "PSD_RIGHT"];

const robot = (id, name, program, colour, has_colours) => ({
  id,
  name,
  kind: has_colours ? "S4" : "Eve",
  program,
  colour,
  body: { radius_m: 0.1, height_m: 0.12 },
  links: [],
  standing_rad: [],
  sensors: SENSORS.map((name) => ({ name, kind: "psd", mount: null, range_m: [0.05, 1], half_angle_rad: 0 })),
  camera: { mount: { position_m: [0.05, 0, 0.1], rotation: [0, 0, 0, 1] }, horizontal_rad: 1, vertical_rad: 0.8 },
  lcd: { size_px: has_colours ? [320, 480] : [128, 64], has_colours },
});

export function scene() {
  return {
    run: 1,
    title: "Mock",
    seed: "18446744073709551615",
    slot_s: 0.05,
    bounds_m: [[0, 0], [2, 1]],
    images: [],
    meshes: [],
    parts: [],
    ground: { colour: [200, 200, 200], floor: { size_m: [2, 1], colour: [230, 220, 200], image: null }, spots: [] },
    light: { towards: [0, 0, 1], ambient: 0.5, diffuse: 0.5, shadows: false },
    sky: { horizon: [200, 220, 240], zenith: [100, 150, 220] },
    robots: [
      robot(1, "eve", "wander.c", [214, 39, 40], false),
      robot(2, "soccer", "goalkeeper.rs", [31, 119, 180], true),
      robot(3, "post", "", [44, 160, 44], true),
    ],
    objects: [{ id: 1, kind: "golf", body: { radius_m: 0.021, height_m: 0.042 } }],
    addable_types: { robots: ["Eve", "S4"], objects: ["golf", "can"] },
  };
}

const pose = (id, t_s) => ({ x_m: 0.3 * id + 0.1 * Math.cos(t_s), y_m: 0.5 + 0.1 * Math.sin(t_s), phi_rad: t_s + Math.PI / 2 });

export function snapshot(t_s = 0, state = { is: "running" }, checks = []) {
  const robotState = (id) => ({
    id,
    motion: [{ t_s, from: pose(id, t_s), v_m_per_s: 0.1, left_m_per_s: 0, omega_rad_per_s: 1, lasts_s: 0.05 }], lift_m: 0, joints_rad: [],
    standing: ["running", "waiting", "no_program"][id - 1],
    now_s: t_s,
    why: id === 2 ? "waits for KEY1" : "",
    is_stalled: false,
  });
  const objects = [{ id: 1, pose: { x_m: 1.5, y_m: 0.5, phi_rad: 0 } }];
  return { run: 1, t_s, state, speed: 1, rate: 0.998, robots: [1, 2, 3].map(robotState), objects, beams: [], checks };
}

export function detail(robot, t_s) {
  const reading = (name, value, unit = "m") => ({ name, value, unit, at_s: t_s });
  const parameter = (name, what, value, range, unit) => ({ name, what, value, range, unit });
  const { size_px, has_colours } = scene().robots[robot - 1].lcd;
  return {
    run: 1,
    robot,
    t_s,
    pose: pose(robot, t_s),
    odometry: pose(robot, t_s * 0.98),
    lcd: { url: picture(size_px, has_colours ? "#123" : "#9cac84", has_colours ? "#fff" : "#263024"), size_px },
    lcd_text: has_colours ? ["Hello", "GO | STOP |  | END"] : ["Hello", "", "", "", "", "", "GO  STOP    END "],
    camera: { url: picture([160, 120], "#7aa", "#a31"), size_px: [160, 120] },
    readings: [
      reading("PSD_FRONT", 0.3 + 0.2 * Math.sin(t_s)),
      reading("PSD_LEFT", 0.2 + 0.05 * Math.cos(3 * t_s)),
      reading("PSD_RIGHT", null),
      reading("QUAD_LEFT", Math.round(t_s * 100), ""),
    ],
    sensors: SENSORS.map((name) => ({ name, is_on: true })),
    noise: [
      parameter("psd.sigma_mm", "standard deviation", 2, [0, 1e6], "mm"),
      parameter("psd.bias_mm", "error of all readings", -5, [-1e6, 1e6], "mm"),
      parameter("psd.dropout", "share of readings of nothing", 0.01, [0, 1], ""),
      parameter("drive.left_percent", "left wheel too large", 0, [-50, 100], "%"),
    ],
    scan: null,
  };
}

/** Returns `count` events with consecutive numbers from `from` on. */
export function events(count, from = 1) {
  const kinds = ["contact", "radio_sent", "lcd_text", "key", "distance"];
  const event = (number) => ({
    number,
    t_s: number / 100,
    robot: number % 4 || null,
    kind: kinds[number % 5],
    text: `event ${number}`,
    fields: {},
  });
  return { events: Array.from({ length: count }, (_, at) => event(from + at)), missed: 0 };
}

function picture([width, height], paper, ink) {
  const size = `width="${width}" height="${height}"`;
  const text = `<rect ${size} fill="${paper}"/><text x="4" y="14" font-size="12" fill="${ink}">Hello</text>`;
  return `data:image/svg+xml,${encodeURIComponent(`<svg xmlns="http://www.w3.org/2000/svg" ${size}>${text}</svg>`)}`;
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const mock = await Mock.open(Number(process.argv[2] ?? 7700));
  let [number, t_s] = [1, 0];
  setInterval(() => {
    t_s += 0.05;
    mock.send({ type: "snapshot", ...snapshot(t_s) });
    for (const id of [1, 2, 3]) mock.send({ type: "detail", ...detail(id, t_s) });
    mock.send({ type: "events", ...events(3, number) });
    number += 3;
  }, 50);
  console.log(mock.url);
}
