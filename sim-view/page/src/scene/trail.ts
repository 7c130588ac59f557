// Trails of robots: ribbons on the floor, of bounded length.

import * as THREE from "three";
import type { Event } from "../protocol";
import type { Bodies, BodyView } from "./bodies";

/** Maximum number of pieces of ribbon of all robots together; new pieces replace the oldest ones. */
const MAX_PIECES = 24_000;
/** Length of a piece and half its width, in radii of the robot. */
const STEP = 0.25;
const HALF_WIDTH = 0.12;
/** The ribbon is cut if a robot has moved this many radii farther than it can drive between two frames: it was placed by hand. */
const LEAP = 4;
const FASTEST_M_PER_S = 3;
/** Longest time between two frames over which the path is interpolated. */
const BLINK_S = 0.5;

/** Trails of a run so far: for each robot, in order of their numbers, its lines, of points in metres. */
export interface TrailsBefore {
  run: number;
  trails: [number, number][][][];
}

/** Requests the trails of the run so far; repeats the request later if the server is busy with other pages' requests. */
export async function trailsBefore(): Promise<TrailsBefore | null> {
  for (let attempt = 0; attempt < 8; attempt++) {
    const answer = await fetch("files/trails.json").catch(() => null);
    if (answer?.ok) return (await answer.json()) as TrailsBefore;
    if (answer?.status !== 503) return null;
    await new Promise((done) => setTimeout(done, 200 + 800 * Math.random()));
  }
  return null;
}

export class Trails {
  readonly group = new THREE.Group();
  private readonly positions = new THREE.BufferAttribute(new Float32Array(12 * MAX_PIECES), 3);
  private readonly colours = new THREE.BufferAttribute(new Float32Array(12 * MAX_PIECES), 3);
  /** Number of calls of `join`: the answer to an earlier call is dropped. */
  private joins = 0;
  /** By robot number: displayed times between which its ribbon is interrupted, since the robot is placed elsewhere. */
  private readonly cuts = new Map<number, [from_s: number, until_s: number][]>();
  private recorded: readonly Event[] = [];
  private readonly mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial>;
  private next = 0;
  private used = 0;
  /** For each robot: end point of its ribbon, and the time at that point. */
  private last = new Float64Array(0);
  private t_s = 0;
  private hasChanged = false;

  /** `before` returns the trails so far of a run that continues; null if there are none. */
  constructor(
    private readonly bodies: Bodies,
    private readonly before: (run: number) => Promise<TrailsBefore | null>,
  ) {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", this.positions.setUsage(THREE.DynamicDrawUsage));
    geometry.setAttribute("color", this.colours.setUsage(THREE.DynamicDrawUsage));
    const index = new Uint32Array(6 * MAX_PIECES);
    for (let i = 0; i < MAX_PIECES; i++) {
      for (let k = 0; k < 6; k++) index[6 * i + k] = 4 * i + CORNERS[k]!;
    }
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    const material = new THREE.MeshBasicMaterial({ vertexColors: true, transparent: true, opacity: 0.55, depthWrite: false });
    this.mesh = new THREE.Mesh(geometry, material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 1;
    this.group.add(this.mesh);
    this.rebuild();
  }

  /** Adds the trails so far to the ribbons, which begin now. */
  async join(run: number): Promise<void> {
    const join = ++this.joins;
    const before = await this.before(run);
    if (before?.run !== run || this.joins !== join) return;
    before.trails.forEach((lines, i) => {
      const body = this.bodies.robot(i + 1);
      if (!body) return;
      for (const line of lines) {
        for (let k = 1; k < line.length; k++) {
          const [[x, y], [x0, y0]] = [line[k]!, line[k - 1]!];
          this.lay(body, x, y, x - x0, y - y0);
        }
      }
    });
  }

  /** Interrupts the ribbon of a robot from now to a displayed time, at which it has been placed elsewhere. */
  interrupt(robot: number, until_s: number): void {
    this.cuts.set(robot, [[this.t_s, until_s]]);
  }

  /** Interrupts the ribbons where robots are placed elsewhere in a recording. */
  takeRecording(events: readonly Event[]): void {
    if (events === this.recorded) return;
    this.recorded = events;
    this.cuts.clear();
    for (const { kind, robot, t_s } of events) {
      if (kind !== "placed" || robot === null) continue;
      this.cuts.set(robot, [...(this.cuts.get(robot) ?? []), [t_s, t_s]]);
    }
  }

  /** Forgets the interruptions of another run. */
  restart(): void {
    this.cuts.clear();
  }

  /** Restarts all ribbons. */
  rebuild(): void {
    this.t_s = 0;
    this.last = new Float64Array(3 * this.bodies.robots.length).fill(NaN);
    this.next = this.used = 0;
    this.mesh.geometry.setDrawRange(0, 0);
  }

  /** Extends the ribbons of robots that have moved; restarts them if time goes back. */
  update(t_s: number): void {
    // The clock may go back to the start of a slot when the run pauses.
    if (t_s < this.t_s - BLINK_S) this.rebuild();
    this.t_s = t_s;
    const { robots } = this.bodies;
    for (let i = 0; i < robots.length; i++) this.follow(robots[i]!, 3 * i);
    if (!this.hasChanged) return;
    this.hasChanged = false;
    this.positions.needsUpdate = this.colours.needsUpdate = true;
    this.mesh.geometry.setDrawRange(0, 6 * this.used);
  }

  private follow(body: BodyView, i: number): void {
    const { last } = this;
    const { x_m, y_m } = body.pose;
    const [dx, dy] = [x_m - last[i]!, y_m - last[i + 1]!];
    const radius = body.extent.radius_m;
    const distance = Math.hypot(dx, dy);
    if (distance < STEP * radius) return;
    const isPresent = body.isPresent && !body.held;
    const seen_s = Math.min(BLINK_S, this.t_s - last[i + 2]!);
    const isCut = this.cuts.get(body.id)?.some(([from_s, until_s]) => from_s <= this.t_s && last[i + 2]! <= until_s);
    if (isPresent && !isCut && distance < LEAP * radius + FASTEST_M_PER_S * seen_s) this.lay(body, x_m, y_m, dx, dy);
    last[i] = isPresent ? x_m : NaN;
    last[i + 1] = y_m;
    last[i + 2] = this.t_s;
  }

  /** Adds the piece of a robot's ribbon that ends at a point. */
  private lay(body: BodyView, x_m: number, y_m: number, dx: number, dy: number): void {
    const half = (HALF_WIDTH * body.extent.radius_m) / Math.max(Math.hypot(dx, dy), 1e-9);
    const [acrossX, acrossY] = [-dy * half, dx * half];
    const first = 4 * this.next;
    this.positions.setXY(first, x_m - dx - acrossX, y_m - dy - acrossY);
    this.positions.setXY(first + 1, x_m - acrossX, y_m - acrossY);
    this.positions.setXY(first + 2, x_m + acrossX, y_m + acrossY);
    this.positions.setXY(first + 3, x_m - dx + acrossX, y_m - dy + acrossY);
    const [r, g, b] = body.colour;
    for (let corner = first; corner < first + 4; corner++) this.colours.setXYZ(corner, r, g, b);
    for (const attribute of [this.positions, this.colours]) {
      if (!this.hasChanged) attribute.clearUpdateRanges();
      attribute.addUpdateRange(3 * first, 12);
    }
    this.hasChanged = true;
    this.next = (this.next + 1) % MAX_PIECES;
    this.used = Math.max(this.used, this.next === 0 ? MAX_PIECES : this.next);
  }
}

const CORNERS = [0, 1, 2, 0, 2, 3] as const;
