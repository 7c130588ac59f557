// Source that replays a recorded run.

import type { Model, Player, Source } from "./model";
import { blend, type MotionSource, mix, type Posture } from "./motion";
import type { Detail, Pose, Postures, Recording, RobotHistory, RobotState, Snapshot, Track } from "./protocol";

/** Interval at which panels are updated during playback. */
const UPDATE_MS = 100;

/** Maximum time between two postures of one continuous motion. */
const STEP_S = 0.1;

/** Plays a recording into the model as if it were a live run. */
export class RecordedSource implements Source, Player {
  readonly player = this;
  isPlaying = false;
  speed = 1;
  private t_s = 0;
  private nextEvent = 0;
  private last_ms = 0;
  private updated_ms = 0;
  private readonly histories = new Map<number, RobotHistory>();

  constructor(
    private readonly model: Model,
    private readonly recording: Recording,
  ) {
    const { scene, robots, objects } = recording;
    scene.robots.forEach((robot, i) => this.histories.set(robot.id, robots[i]!));
    const tracks = new Map(scene.objects.map((object, i) => [object.id, objects[i]!]));
    model.motion = new RecordedMotion(this.histories, tracks);
    model.receive({ type: "scene", ...scene });
    model.setConnection({ is: "recorded" });
    this.seek(0);
    requestAnimationFrame((now) => this.tick(now));
  }

  get duration_s(): number {
    return this.recording.duration_s;
  }

  /** Notices on the recording for the user. */
  get remarks(): readonly string[] {
    return this.recording.remarks;
  }

  /** All events, for the timeline. */
  get events(): Recording["events"] {
    return this.recording.events;
  }

  get eventsLeftOut(): number {
    return this.recording.events_left_out;
  }

  play(): void {
    if (this.t_s >= this.duration_s) this.seek(0);
    this.isPlaying = true;
    this.updateModel();
  }

  pause(): void {
    this.isPlaying = false;
    this.updateModel();
  }

  setSpeed(speed: number): void {
    this.speed = speed;
    this.updateModel();
  }

  seek(t_s: number): void {
    const to = Math.min(this.duration_s, Math.max(0, t_s));
    if (to < this.t_s) {
      this.nextEvent = 0;
      this.model.forget();
    }
    this.t_s = to;
    this.updateModel();
  }

  act(): Promise<void> {
    return Promise.reject(new Error("a recorded run cannot be changed"));
  }

  look(): void {
    this.updateDetail();
  }

  private tick(now_ms: number): void {
    requestAnimationFrame((next) => this.tick(next));
    const passed_ms = Math.min(250, now_ms - this.last_ms);
    this.last_ms = now_ms;
    if (!this.isPlaying) return;
    this.t_s = Math.min(this.duration_s, this.t_s + (this.speed * passed_ms) / 1000);
    this.model.clock.set(this.t_s);
    if (this.t_s >= this.duration_s) this.isPlaying = false;
    if (now_ms - this.updated_ms < UPDATE_MS && this.isPlaying) return;
    this.updated_ms = now_ms;
    this.updateModel();
  }

  /** Updates the model to the time of the playback. */
  private updateModel(): void {
    const { model, recording } = this;
    const first = this.nextEvent;
    while ((recording.events[this.nextEvent]?.t_s ?? Infinity) <= this.t_s) this.nextEvent++;
    if (this.nextEvent > first) model.receive({ type: "events", events: recording.events.slice(first, this.nextEvent), missed: 0 });
    model.receive({ type: "snapshot", ...this.snapshot() });
    model.clock.set(this.t_s);
    this.updateDetail();
    model.notify("player");
  }

  private snapshot(): Snapshot {
    const { scene, why, digest } = this.recording;
    const isOver = this.t_s >= this.duration_s;
    return {
      run: scene.run,
      t_s: this.t_s,
      state: isOver ? { is: "ended", why, digest } : this.isPlaying ? { is: "running" } : { is: "paused" },
      speed: this.speed,
      rate: this.isPlaying ? this.speed : 0,
      robots: scene.robots.flatMap(({ id }) => this.robotState(id)),
      objects: scene.objects.flatMap(({ id }) => {
        const pose: Pose = { x_m: 0, y_m: 0, phi_rad: 0 };
        return this.model.motion.object(id, this.t_s, pose) ? [{ id, pose }] : [];
      }),
      beams: [],
      checks: [],
    };
  }

  private robotState(id: number): RobotState[] {
    const from: Pose = { x_m: 0, y_m: 0, phi_rad: 0 };
    if (!this.model.motion.robot(id, this.t_s, from)) return [];
    const programState = latest(this.histories.get(id)?.standings ?? [], this.t_s);
    const posture: Posture = { lift_m: 0, joints_rad: [] };
    this.model.motion.posture(id, this.t_s, posture);
    const piece = { t_s: this.t_s, from, v_m_per_s: 0, left_m_per_s: 0, omega_rad_per_s: 0, lasts_s: 0 };
    const [standing, why] = [programState?.standing ?? "running", programState?.why ?? ""];
    return [{ id, motion: [piece], ...posture, standing, now_s: this.t_s, why, is_stalled: false }];
  }

  private updateDetail(): void {
    const robot = this.model.chosen;
    const history = robot === null ? undefined : this.histories.get(robot);
    if (robot === null || !history) return;
    const pose: Pose = { x_m: 0, y_m: 0, phi_rad: 0 };
    this.model.motion.robot(robot, this.t_s, pose);
    const detail: Detail = {
      run: this.recording.scene.run,
      robot,
      t_s: this.t_s,
      pose,
      odometry: pose,
      lcd: null,
      lcd_text: latest(history.lcd, this.t_s)?.lines ?? [],
      camera: null,
      readings: [],
      sensors: [],
      noise: [],
      scan: null,
    };
    this.model.receive({ type: "detail", ...detail });
  }
}

/** Recorded motion of bodies. */
class RecordedMotion implements MotionSource {
  private readonly end: Pose = { x_m: 0, y_m: 0, phi_rad: 0 };

  constructor(
    private readonly histories: ReadonlyMap<number, RobotHistory>,
    private readonly tracks: ReadonlyMap<number, Track>,
  ) {}

  robot(id: number, t_s: number, out: Pose): boolean {
    return this.on(this.histories.get(id)?.track, t_s, out);
  }

  posture(id: number, t_s: number, out: Posture): boolean {
    const postures = this.histories.get(id)?.postures;
    if (!postures || postures.t_s.length === 0 || t_s < postures.t_s[0]!) return false;
    const i = before(postures.t_s, t_s);
    const [from_s, to_s] = [postures.t_s[i]!, postures.t_s[i + 1] ?? Infinity];
    // After a longer pause the robot stands still until shortly before the next posture.
    const fraction = Math.max(0, 1 - (to_s - t_s) / Math.min(to_s - from_s, STEP_S));
    blend(posture(postures, i), posture(postures, to_s < Infinity ? i + 1 : i), fraction, out);
    return true;
  }

  object(id: number, t_s: number, out: Pose): boolean {
    return this.on(this.tracks.get(id), t_s, out);
  }

  private on(track: Track | undefined, t_s: number, out: Pose): boolean {
    if (!track || track.t_s.length === 0 || t_s < track.t_s[0]! || t_s >= (track.until_s ?? Infinity)) return false;
    const i = before(track.t_s, t_s);
    point(track, i, out);
    const [from_s, to_s] = [track.t_s[i]!, track.t_s[i + 1]];
    if (to_s === undefined || to_s <= from_s) return true;
    point(track, i + 1, this.end);
    mix(out, this.end, (t_s - from_s) / (to_s - from_s));
    return true;
  }
}

function posture({ lift_m, joints_rad, t_s }: Postures, i: number): Posture {
  const count = joints_rad.length / t_s.length;
  return { lift_m: lift_m[i]!, joints_rad: joints_rad.slice(i * count, (i + 1) * count) };
}

function point(track: Track, i: number, out: Pose): void {
  out.x_m = track.x_m[i]!;
  out.y_m = track.y_m[i]!;
  out.phi_rad = track.phi_rad[i]!;
}

/** Index of the last of the ascending times that is not after `t_s`. */
function before(times_s: readonly number[], t_s: number): number {
  let [low, high] = [0, times_s.length];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times_s[middle]! <= t_s) low = middle;
    else high = middle;
  }
  return low;
}

function latest<T extends { t_s: number }>(items: readonly T[], t_s: number): T | undefined {
  return items.findLast((item) => item.t_s <= t_s);
}

/** The recording in the page, or the one that the server of a replay offers; null for a live run. */
export async function findRecording(): Promise<Recording | null> {
  const inside = document.getElementById("recording")?.textContent;
  if (inside) return JSON.parse(inside) as Recording;
  if (location.protocol === "file:") return null;
  const answer = await fetch(new URL("recording.json", document.baseURI)).catch(() => null);
  const isRecording = answer?.ok && answer.headers.get("content-type")?.includes("json");
  return isRecording ? ((await answer.json()) as Recording) : null;
}
