// What the page knows, in one place: sources write it, views read it and are told of changes.

import { Clock } from "./clock";
import { type Motion, SnapshotMotion } from "./motion";
import type { Answer, Build, Command, Detail, Event, Message, Pose, Reading, Scene, Snapshot, Welcome } from "./protocol";

/** How the page hears of the run. */
export type Connection =
  | { is: "connecting" }
  | { is: "open" }
  /** Lost; it is tried again at `again_ms` (of `performance.now()`). */
  | { is: "lost"; why: string; again_ms: number }
  /** Refused for good, such as for a wrong token. */
  | { is: "refused"; why: string }
  /** There is no server: a recording plays. */
  | { is: "recorded" };

/** What the page wants to see more of. */
export interface Look {
  robot: number | null;
  camera: boolean;
  calls: boolean;
}

/** Where a run comes from. */
export interface Source {
  /** The timeline of a recording; none for a live run. */
  readonly player: Player | null;
  /** Has a command carried out; rejects with the reason when it is refused. */
  act(command: Command): Promise<void>;
  /** Says what the page wants to see more of. */
  look(look: Look): void;
}

/** What can be done with a recording. */
export interface Player {
  readonly duration_s: number;
  readonly isPlaying: boolean;
  /** Simulated seconds for each second of real time. */
  readonly speed: number;
  /** All that has happened. */
  readonly events: readonly Event[];
  play(): void;
  pause(): void;
  setSpeed(speed: number): void;
  seek(t_s: number): void;
}

/** What can be subscribed to. */
export type Topic =
  | "connection"
  | "welcome"
  | "scene"
  | "snapshot"
  | "detail"
  | "events"
  | "build"
  | "chosen"
  /** Another selected object. */
  | "selected"
  /** More readings in the history. */
  | "history"
  /** The 3D view is to bring a robot into sight. */
  | "centre"
  /** The player of a recording was played, paused, set to another speed or has moved. */
  | "player";

/** What is selected in the 3D view: a robot (then it is the chosen one) or an object. */
export type Selection = { robot: number } | { object: number };

/** One reading's values over time; a value of `null` is a gap. */
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
  /** The last detail of each robot, by its number; an `lcd` of `null` is replaced by the picture before. */
  readonly details = new Map<number, Detail>();
  /** The last events, oldest first, without calls. */
  events: Event[] = [];
  /** The last RoBIOS calls of robots that were looked at, oldest first. */
  calls: Event[] = [];
  /** How many events the page has not got or has dropped. */
  missedEvents = 0;
  build: Build | null = null;
  /** Number of the robot whose panels are shown. */
  chosen: number | null = null;
  /** What moves when the arrow keys are pressed in the 3D view. */
  selected: Selection | null = null;
  /** The robot that the 3D view is to bring into sight. */
  centred: number | null = null;
  /** The 3D view as a PNG; none before there is one. */
  screenshot: (() => Promise<Blob>) | null = null;
  /** Curves of the readings of each robot, by its number and by the reading's name. */
  readonly history = new Map<number, Map<string, Curve>>();
  /** The time that is shown: goes on smoothly between snapshots. */
  readonly clock = new Clock();
  /** Where bodies are at the time that is shown. */
  motion: Motion = new SnapshotMotion();

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

  /** Tells those who have subscribed. */
  tell(topic: Topic): void {
    for (const f of this.listeners.get(topic) ?? []) f();
  }

  /** Takes a source. */
  attach(source: Source): void {
    this.source = source;
    source.look(this.wanted);
    this.tell("player");
  }

  /** The timeline of a recording; none for a live run. */
  get player(): Player | null {
    return this.source?.player ?? null;
  }

  /** Whether commands have a chance. */
  get mayAct(): boolean {
    return this.connection.is === "open" && (this.welcome?.may_act ?? false);
  }

  /** Has a command carried out; rejects with the reason when it is refused. */
  act(command: Command): Promise<void> {
    return this.source ? this.source.act(command) : Promise.reject(new Error("not connected"));
  }

  /** Says whether the chosen robot's camera image and calls are wanted. */
  look(wish: { camera?: boolean; calls?: boolean }): void {
    this.want({ ...this.wanted, ...wish });
  }

  /** Shows the panels of a robot; none for no robot. */
  choose(robot: number | null): void {
    if (robot === this.chosen) return;
    this.chosen = robot;
    this.want({ ...this.wanted, robot });
    this.tell("chosen");
    this.select(robot === null ? null : { robot });
  }

  /** Selects a robot, which is chosen then, or an object. */
  select(selection: Selection | null): void {
    this.selected = selection;
    if (selection && "robot" in selection) this.choose(selection.robot);
    this.tell("selected");
  }

  /** Brings a robot into sight. */
  centreOn(robot: number): void {
    this.centred = robot;
    this.tell("centre");
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
    this.tell("connection");
  }

  /** Takes what the server says. */
  receive(message: Exclude<Message, { type: "answer" } & Answer>): void {
    switch (message.type) {
      case "welcome":
        this.welcome = message;
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
      case "events":
        this.takeEvents(message.events, message.missed);
        break;
      case "build":
        this.build = message;
        break;
    }
    this.tell(message.type);
  }

  /** Forgets what belongs to a time that a recording has left. */
  forget(): void {
    this.events = [];
    this.calls = [];
    this.missedEvents = 0;
    this.history.clear();
    this.tell("events");
    this.tell("history");
  }

  private takeScene(scene: Scene): void {
    const isAnotherRun = this.scene?.run !== scene.run;
    this.scene = scene;
    if (isAnotherRun) {
      this.snapshot = null;
      this.details.clear();
      this.clock.restart();
      this.motion.restart?.();
      this.forget();
      this.tell("detail");
    }
    if (!scene.robots.some((robot) => robot.id === this.chosen)) this.choose(scene.robots[0]?.id ?? null);
    const selected = this.selected;
    if (selected && "object" in selected && !scene.objects.some((object) => object.id === selected.object)) this.select(null);
  }

  private takeDetail(detail: Detail): void {
    detail.lcd ??= this.details.get(detail.robot)?.lcd ?? null;
    const believed = this.player ? [] : place("believed", detail.odometry, detail.t_s);
    detail.readings = [...place("true", detail.pose, detail.t_s), ...believed, ...detail.readings].map(asShown);
    this.details.set(detail.robot, detail);
    let curves = this.history.get(detail.robot);
    if (!curves) this.history.set(detail.robot, (curves = new Map()));
    for (const reading of detail.readings) addSample(curves, reading);
    this.tell("history");
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

/** Drops the oldest where there are clearly more than `most`; how many. */
function cut(events: Event[], most: number): number {
  const surplus = events.length - most;
  return surplus > 500 ? events.splice(0, surplus).length : 0;
}

/** A pose as readings. */
function place(word: string, { x_m, y_m, phi_rad }: Pose, at_s: number): Reading[] {
  return [
    { name: `${word} x`, value: x_m, unit: "m", at_s },
    { name: `${word} y`, value: y_m, unit: "m", at_s },
    { name: `${word} heading`, value: phi_rad, unit: "rad", at_s },
  ];
}

/** In millimetres and degrees. */
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
