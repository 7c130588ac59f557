// Shared by the browser tests: Chromium, pages with the messages that they receive, and `eyesim` itself.

import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { once } from "node:events";
import { existsSync } from "node:fs";
import { chromium } from "playwright-core";

const TIMEOUT_MS = 40_000;
const FLAGS = [
  "--no-sandbox",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
  "--no-first-run",
];
/** Flags for a 3D view in software, which starts and draws slowly, and for none. */
const GRAPHICS = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
const NO_GRAPHICS = ["--disable-gpu", "--disable-3d-apis"];

/** Debian's Chromium, or the one that `CHROMIUM` names. */
export const CHROMIUM = process.env.CHROMIUM ?? "/usr/bin/chromium";

/** Reason why browser tests cannot run here; false if they can. */
export const skip = existsSync(CHROMIUM) ? false : `there is no ${CHROMIUM}: apt install chromium, or set CHROMIUM`;

/** A browser, with or without a 3D view; the caller closes it. */
export function launch(graphics = false) {
  return chromium.launch({ executablePath: CHROMIUM, args: [...FLAGS, ...(graphics ? GRAPHICS : NO_GRAPHICS)] });
}

/** The messages that a page has received: they show the state of the simulation, not what the page shows. */
export class Received {
  scene;
  snapshot;
  events = [];
  details = new Map();
  answers = [];
  builds = [];
  welcomes = [];
  errors = [];
  #waiting = new Set();

  constructor(page) {
    page.on("pageerror", (error) => this.errors.push(error));
    page.on("websocket", (socket) => socket.on("framereceived", ({ payload }) => this.#receive(JSON.parse(String(payload)))));
  }

  /** Waits until `is` returns a true value for the received messages; returns that value. */
  async until(what, is) {
    const deadline = Date.now() + TIMEOUT_MS;
    for (;;) {
      const value = is(this);
      if (value) return value;
      let wake;
      const received = new Promise((done) => this.#waiting.add((wake = done)));
      const timer = setTimeout(wake, deadline - Date.now());
      await received;
      clearTimeout(timer);
      this.#waiting.delete(wake);
      assert(Date.now() < deadline, `never received: ${what}; ${this}`);
    }
  }

  robot(id) {
    return this.snapshot?.robots.find((robot) => robot.id === id);
  }

  reading(robot, name) {
    return this.details.get(robot)?.readings.find((reading) => reading.name === name);
  }

  /** Pose of a robot. */
  pose(id) {
    return this.robot(id)?.motion[0]?.from;
  }

  toString() {
    const { t_s, state, speed, robots } = this.snapshot ?? {};
    const last = this.events.slice(-5).map(({ kind, text }) => `${kind} ${text}`);
    const refused = this.answers.filter((answer) => answer.refused !== null);
    return JSON.stringify({ t_s, state, speed, robots, last, refused });
  }

  #receive(message) {
    switch (message.type) {
      case "welcome":
        this.welcomes.push(message);
        break;
      case "scene":
        if (message.run !== this.scene?.run) this.events = [];
        this.scene = message;
        break;
      case "snapshot":
        this.snapshot = message;
        break;
      case "detail":
        this.details.set(message.robot, { ...message, lcd: message.lcd ?? this.details.get(message.robot)?.lcd });
        break;
      case "events":
        this.events.push(...message.events);
        break;
      case "build":
        this.builds.push(message);
        break;
      case "answer":
        this.answers.push(message);
        break;
    }
    for (const wake of this.#waiting) wake();
  }
}

/** Opens a page with its own browser context; returns it with its received messages. */
export async function open(browser, url, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1000, height: 700 }, ...options });
  context.setDefaultTimeout(TIMEOUT_MS);
  const page = await context.newPage();
  const received = new Received(page);
  await page.goto(url);
  return { page, received, control: (testid) => page.getByTestId(testid), close: () => context.close() };
}

/** Opens closed sections. */
export async function unfold(page, ...testids) {
  for (const testid of testids) await page.getByTestId(testid).evaluate((section) => (section.open = true));
}

/** A running `eyesim`; the environment variable `EYESIM` names the binary. */
export class Eyesim {
  static #running = new Set();
  output = "";

  static async start(args, options = {}) {
    const eyesim = new Eyesim();
    Eyesim.#running.add(eyesim);
    eyesim.child = spawn(process.env.EYESIM, args, { stdio: ["ignore", "pipe", "pipe"], ...options });
    eyesim.ended = once(eyesim.child, "exit");
    const address = new Promise((done, fail) => {
      const read = (data) => {
        eyesim.output += data;
        // With `--listen`, the teacher's address is printed second.
        const before = args.includes("--listen") ? "teacher: +" : "";
        const found = eyesim.output.match(new RegExp(`${before}(https?://[\\w.:[\\]-]+/(#token=\\S+)?)`));
        if (found) done(found[1]);
      };
      eyesim.child.stdout.on("data", read);
      eyesim.child.stderr.on("data", read);
      eyesim.ended.then(([code]) => fail(new Error(`eyesim ended with ${code}:\n${eyesim.output}`)));
    });
    eyesim.url = await address;
    return eyesim;
  }

  get port() {
    return new URL(this.url).port;
  }

  /** Ends the processes that failed tests have left running. */
  static stopAll() {
    for (const { child } of Eyesim.#running) child.kill("SIGKILL");
  }

  /** Ends the process, as Ctrl+C does. */
  async stop() {
    if (this.child.exitCode === null && this.child.signalCode === null) this.child.kill("SIGINT");
    await this.ended;
    Eyesim.#running.delete(this);
  }
}
