// State of the page in one place: sources write it, views read it and subscribe to changes.

import { Clock } from "./clock";
import { type MotionSource, SnapshotMotion } from "./motion";
import type { Answer, Build, Command, Detail, Event, Layer, Message, Pose, Reading, Scene, Snapshot, Welcome } from "./protocol";

/** State of the connection to the run. */
export type Connection =
  | { is: "connecting" }
  | { is: "open" }
  /** Lost; the next attempt is at `again_ms` (of `performance.now()`). */
  | { is: "lost"; why: string; again_ms: number }
  /** Refused permanently, such as for a wrong token. */
  | { is: "refused"; why: string }
  /** There is no server: a recording plays. */
  | { is: "recorded" };

/** Details that the page requests. */
export interface Look {
  robot: number | null;
  camera: boolean;
  calls: boolean;
}

/** Source of a run. */
export interface Source {
  /** The timeline of a recording; none for a live run. */
  readonly player: Player | null;
  /** Requests a command; rejects with the reason if it is refused. */
  act(command: Command): Promise<void>;
  /** Requests details of a robot. */
  look(look: Look): void;
}

/** Playback control of a recording. */
export interface Player {
  readonly duration_s: number;
  readonly isPlaying: boolean;
  /** Simulated seconds for each second of real time. */
  readonly speed: number;
  /** All events of the recording. */
  readonly events: readonly Event[];
  /** Number of events that the recording omits. */
  readonly eventsLeftOut: number;
  play(): void;
  pause(): void;
  setSpeed(speed: number): void;
  seek(t_s: number): void;
}

/** Topics of subscriptions. */
export type Topic =
  | "connection"
  | "welcome"
  | "scene"
  | "snapshot"
  | "detail"
  | "layer"
  | "events"
  | "build"
  | "chosen"
  /** Another robot or object is selected. */
  | "selected"
  /** The history has new readings. */
  | "history"
  /** The 3D view must bring a robot into sight. */
  | "centre"
  /** The player of a recording has started, paused, changed its speed or moved. */
  | "player";

/** Selection in the 3D view: a robot (which is then the chosen one) or an object. */
export type Selection = { robot: number } | { object: number };

/** Values of one reading over time; `null` is a gap. */
export interface Curve {
  unit: string;
  times_s: number[];
  values: (number | null)[];
}

const MAX_EVENTS = 20_000;
const MAX_CALLS = 5000;
const MAX_SAMPLES = 6000;

export class Model {
  connection: Connection = { is: "connecting" };
  welcome: Welcome | null = null;
  scene: Scene | null = null;
  snapshot: Snapshot | null = null;
  /** The last detail of each robot, by its number; an `lcd` of `null` is replaced by the previous picture. */
  readonly details = new Map<number, Detail>();
  /** The last layers that the programs of robots have shown, by the robot's number and the layer's name. */
  readonly layers = new Map<number, Map<string, Layer>>();
  /** The last events, oldest first, without calls. */
  events: Event[] = [];
  /** The last RoBIOS calls of the robots whose calls were requested, oldest first. */
  calls: Event[] = [];
  /** Number of events that the page has missed or dropped. */
  missedEvents = 0;
  build: Build | null = null;
  /** Number of the robot whose panels are shown. */
  chosen: number | null = null;
  /** The body that the arrow keys move in the 3D view. */
  selected: Selection | null = null;
  /** The robot that the 3D view must bring into sight. */
  centred: number | null = null;
  /** Takes a PNG of the 3D view; null before there is one. */
  screenshot: (() => Promise<Blob>) | null = null;
  /** Curves of the readings of each robot, by its number and by the reading's name. */
  readonly history = new Map<number, Map<string, Curve>>();
  /** The displayed time, which advances smoothly between snapshots. */
  readonly clock = new Clock();
  /** Poses of bodies at the displayed time. */
  motion: MotionSource = new SnapshotMotion();

  private source: Source | null = null;
  private wanted: Look = { robot: null, camera: true, calls: false };
  private readonly listeners = new Map<Topic, Set<() => void>>();

  /** Calls `f` now and after each change of the topic, until the returned function is called. */
  subscribe(topic: Topic, f: () => void): () => void {
    let set = this.listeners.get(topic);
    if (!set) this.listeners.set(topic, (set = new Set()));
    set.add(f);
    f();
    return () => void set.delete(f);
  }

  /** Notifies the subscribers of a topic. */
  notify(topic: Topic): void {
    for (const f of this.listeners.get(topic) ?? []) f();
  }

  /** Sets the source. */
  attach(source: Source): void {
    this.source = source;
    source.look(this.wanted);
    this.notify("player");
  }

  /** The timeline of a recording; none for a live run. */
  get player(): Player | null {
    return this.source?.player ?? null;
  }

  /** True if the page is connected and has the right to act. */
  get mayAct(): boolean {
    return this.connection.is === "open" && (this.welcome?.may_act ?? false);
  }

  /** Requests a command; rejects with the reason if it is refused. */
  act(command: Command): Promise<void> {
    return this.source ? this.source.act(command) : Promise.reject(new Error("not connected"));
  }

  /** Requests the chosen robot's camera image and calls, or stops them. */
  look(change: { camera?: boolean; calls?: boolean }): void {
    this.want({ ...this.wanted, ...change });
  }

  /** Shows the panels of a robot; null for no robot. */
  choose(robot: number | null): void {
    if (robot === this.chosen) return;
    this.chosen = robot;
    this.want({ ...this.wanted, robot });
    this.notify("chosen");
    this.select(robot === null ? null : { robot });
  }

  /** Selects a robot, which also becomes the chosen one, or an object. */
  select(selection: Selection | null): void {
    this.selected = selection;
    if (selection && "robot" in selection) this.choose(selection.robot);
    this.notify("selected");
  }

  /** Brings a robot into sight. */
  centreOn(robot: number): void {
    this.centred = robot;
    this.notify("centre");
  }

  /** Chooses the next (1) or previous (-1) robot in order of their numbers. */
  moveSelection(step: 1 | -1): void {
    const ids = this.scene?.robots.map((robot) => robot.id) ?? [];
    if (ids.length === 0) return;
    const at = this.chosen === null ? -1 : ids.indexOf(this.chosen);
    const next = at < 0 ? (step > 0 ? 0 : ids.length - 1) : (at + step + ids.length) % ids.length;
    this.choose(ids[next] ?? null);
  }

  setConnection(connection: Connection): void {
    this.connection = connection;
    this.notify("connection");
  }

  /** Handles a message of the server. */
  receive(message: Exclude<Message, { type: "answer" } & Answer>): void {
    switch (message.type) {
      case "welcome":
        this.welcome = message;
        // What is shown came over an earlier connection, perhaps from another eyesim that numbers its runs alike.
        this.restart();
        break;
      case "scene":
        this.takeScene(message);
        break;
      case "snapshot":
        if (message.run !== this.scene?.run) return;
        this.snapshot = message;
        this.clock.snapshot(message, this.scene.slot_s);
        this.motion.snapshot?.(message);
        break;
      case "detail":
        if (message.run !== this.scene?.run) return;
        this.takeDetail(message);
        break;
      case "layer":
        if (message.run !== this.scene?.run) return;
        this.layers.set(message.robot, (this.layers.get(message.robot) ?? new Map<string, Layer>()).set(message.name, message));
        break;
      case "events":
        this.takeEvents(message.events, message.missed);
        break;
      case "build":
        this.build = message;
        break;
    }
    this.notify(message.type);
  }

  /** Clears events and history: another run begins, or a recording has moved back. */
  forget(): void {
    this.events = [];
    this.calls = [];
    this.missedEvents = 0;
    this.history.clear();
    this.notify("events");
    this.notify("history");
  }

  /** Clears the state of the run: it is sent again. */
  private restart(): void {
    this.snapshot = null;
    this.details.clear();
    this.layers.clear();
    this.clock.restart();
    this.motion.restart?.();
    this.forget();
    this.notify("detail");
    this.notify("layer");
  }

  private takeScene(scene: Scene): void {
    const isAnotherRun = this.scene?.run !== scene.run;
    this.scene = scene;
    if (isAnotherRun) this.restart();
    if (!scene.robots.some((robot) => robot.id === this.chosen)) this.choose(scene.robots[0]?.id ?? null);
    const selected = this.selected;
    if (selected && "object" in selected && !scene.objects.some((object) => object.id === selected.object)) this.select(null);
  }

  private takeDetail(detail: Detail): void {
    detail.lcd ??= this.details.get(detail.robot)?.lcd ?? null;
    const odometryReadings = this.player ? [] : poseReadings("believed", detail.odometry, detail.t_s);
    detail.readings = [...poseReadings("true", detail.pose, detail.t_s), ...odometryReadings, ...detail.readings].map(asShown);
    this.details.set(detail.robot, detail);
    let curves = this.history.get(detail.robot);
    if (!curves) this.history.set(detail.robot, (curves = new Map()));
    for (const reading of detail.readings) addSample(curves, reading);
    this.notify("history");
  }

  private takeEvents(events: Event[], missed: number): void {
    this.missedEvents += missed;
    for (const event of events) (event.kind === "call" ? this.calls : this.events).push(event);
    cut(this.calls, MAX_CALLS);
    this.missedEvents += cut(this.events, MAX_EVENTS);
  }

  private want(look: Look): void {
    this.wanted = look;
    this.source?.look(look);
  }
}

/** Drops the oldest events if there are clearly more than `max`; returns their number. */
function cut(events: Event[], max: number): number {
  const surplus = events.length - max;
  return surplus > 500 ? events.splice(0, surplus).length : 0;
}

/** A pose as readings. */
function poseReadings(word: string, { x_m, y_m, phi_rad }: Pose, at_s: number): Reading[] {
  return [
    { name: `${word} x`, value: x_m, unit: "m", at_s },
    { name: `${word} y`, value: y_m, unit: "m", at_s },
    { name: `${word} heading`, value: phi_rad, unit: "rad", at_s },
  ];
}

/** Converts a reading to millimetres and degrees. */
function asShown(reading: Reading): Reading {
  const [base, per] = reading.unit.split("/");
  const [factor, shown] = base === "m" ? [1000, "mm"] : base === "rad" ? [180 / Math.PI, "°"] : [1, base];
  const value = reading.value === null ? null : reading.value * factor;
  return { ...reading, value, unit: per === undefined ? (shown ?? "") : `${shown}/${per}` };
}

function addSample(curves: Map<string, Curve>, reading: Reading): void {
  let curve = curves.get(reading.name);
  if (!curve) curves.set(reading.name, (curve = { unit: reading.unit, times_s: [], values: [] }));
  const last = curve.times_s.at(-1);
  if (last !== undefined && reading.at_s <= last) return;
  curve.times_s.push(reading.at_s);
  curve.values.push(reading.value);
  if (curve.times_s.length > MAX_SAMPLES + 500) {
    curve.times_s.splice(0, 500);
    curve.values.splice(0, 500);
  }
}
