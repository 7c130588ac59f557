// Marks on bodies: coloured rings that distinguish robots, numbers, the selection with its handle, the odometry's ghost.

import * as THREE from "three";
import type { Model } from "../model";
import type { Pose } from "../protocol";
import type { Bodies, BodyView } from "./bodies";
import { Pen, type Colour } from "./pen";
import { Sprites, inkOn } from "./sprite";
import { write } from "./world";

const STALLED: Colour = [1, 0.2, 0.15];
const SELECTED: Colour = [1, 1, 1];
const GHOST: Colour = [0.62, 0.35, 0.95];
/** Distance of the handle from the body's centre, in radii. */
const HANDLE = 1.9;
const LABEL_LIFT_PX = 16;
/** If odometry and true motion between two details differ by more, the program has set the odometry or the user has placed the robot. */
const SET_M = 0.1;

export class Marks {
  readonly rings = new THREE.Group();
  readonly labels = new THREE.Group();
  readonly selection = new THREE.Group();
  readonly ghost = new THREE.Group();
  private ringMesh: THREE.InstancedMesh | null = null;
  private sprites: Sprites | null = null;
  private readonly selectionPen = new Pen("triangles", { renderOrder: 3 });
  private readonly handlePen = new Pen("triangles", { renderOrder: 12, depthTest: false });
  private readonly ghostPen = new Pen("lines", { renderOrder: 4 });
  private readonly ghostFill = new Pen("triangles", { renderOrder: 3 });
  private readonly colour = new THREE.Color();
  private readonly ghostPose: Pose = { x_m: 0, y_m: 0, phi_rad: 0 };
  /** By robot number: pose and odometry when the odometry's frame was located, and the latest pose and odometry. */
  private readonly anchors = new Map<number, { pose: Pose; odometry: Pose; lastPose: Pose; lastOdometry: Pose }>();

  constructor(
    private readonly model: Model,
    private readonly bodies: Bodies,
  ) {
    this.selection.add(this.selectionPen.object, this.handlePen.object);
    this.ghost.add(this.ghostPen.object, this.ghostFill.object);
  }

  /** Forgets the odometry's frames: another run has begun. */
  restart(): void {
    this.anchors.clear();
  }

  /**
   * Reads the chosen robot's odometry. Its frame is located when the robot is seen first, when its program sets the odometry, and when
   * the user places the robot.
   */
  takeOdometry(): void {
    const detail = this.model.chosen === null ? undefined : this.model.details.get(this.model.chosen);
    if (!detail) return;
    const { robot, pose, odometry } = detail;
    const anchor = this.anchors.get(robot);
    const step = (from: Pose, to: Pose) => Math.hypot(to.x_m - from.x_m, to.y_m - from.y_m);
    const isSet =
      anchor && Math.abs(step(anchor.lastPose, pose) - step(anchor.lastOdometry, odometry)) > SET_M;
    if (!anchor || isSet) this.anchors.set(robot, { pose, odometry, lastPose: pose, lastOdometry: odometry });
    else [anchor.lastPose, anchor.lastOdometry] = [pose, odometry];
  }

  rebuild(): void {
    this.clear();
    const { robots } = this.bodies;
    if (robots.length === 0) return;
    const material = new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.9, depthWrite: false });
    this.ringMesh = new THREE.InstancedMesh(ring(), material, robots.length);
    this.ringMesh.frustumCulled = false;
    this.ringMesh.renderOrder = 2;
    this.rings.add(this.ringMesh);
    this.paint();
    const css = (colour: Colour) => `rgb(${colour.map((part) => Math.round(255 * part)).join(" ")})`;
    this.sprites = new Sprites(
      robots.map(({ id, colour }) => ({ text: String(id), plate: css(colour), colour: inkOn(colour) })),
      LABEL_LIFT_PX,
    );
    this.labels.add(this.sprites.mesh);
  }

  /** Colours the rings: red if the robot is stalled. */
  paint(): void {
    this.bodies.robots.forEach((body, i) => {
      const [r, g, b] = body.isStalled ? STALLED : body.colour;
      this.ringMesh?.setColorAt(i, this.colour.setRGB(r, g, b));
    });
    if (this.ringMesh?.instanceColor) this.ringMesh.instanceColor.needsUpdate = true;
  }

  update(width_px: number, height_px: number, hidden: BodyView | null): void {
    const { robots, selected } = this.bodies;
    if (this.ringMesh) {
      const numbers = this.ringMesh.instanceMatrix.array;
      for (let i = 0; i < robots.length; i++) {
        const body = robots[i]!;
        write(numbers, 16 * i, body, body !== hidden);
        for (let k = 0; k < 6; k++) numbers[16 * i + k]! *= body.extent.radius_m;
      }
      this.ringMesh.instanceMatrix.needsUpdate = true;
    }
    if (this.sprites) {
      for (let i = 0; i < robots.length; i++) {
        const body = robots[i]!;
        const isSeen = body.isPresent && body !== hidden;
        const { height_m, radius_m } = body.extent;
        const z = body.posture.lift_m + height_m + 0.5 * radius_m;
        this.sprites.put(i, body.pose.x_m, body.pose.y_m, z, isSeen ? (body === selected ? 1.25 : 1) : 0);
      }
      this.sprites.end(width_px, height_px);
    }
    this.drawSelection(selected, hidden);
    this.drawGhost();
  }

  /** Position of the selected body's handle, on the floor; false if there is none. */
  handle(out: THREE.Vector3): boolean {
    const body = this.bodies.selected;
    if (!body?.isPresent) return false;
    const reach = HANDLE * body.extent.radius_m;
    out.set(body.pose.x_m + reach * Math.cos(body.pose.phi_rad), body.pose.y_m + reach * Math.sin(body.pose.phi_rad), 0);
    return true;
  }

  clear(): void {
    if (this.ringMesh) {
      this.ringMesh.removeFromParent();
      this.ringMesh.geometry.dispose();
      (this.ringMesh.material as THREE.Material).dispose();
      this.ringMesh.dispose();
      this.ringMesh = null;
    }
    this.sprites?.dispose();
    this.sprites = null;
  }

  dispose(): void {
    this.clear();
    for (const pen of [this.selectionPen, this.handlePen, this.ghostPen, this.ghostFill]) pen.dispose();
  }

  /** Draws a white ring, and a round handle ahead that turns the body. */
  private drawSelection(body: BodyView | undefined, hidden: BodyView | null): void {
    const { selectionPen: pen, handlePen: knob } = this;
    pen.begin();
    knob.begin();
    if (body?.isPresent && body !== hidden) {
      const { x_m, y_m, phi_rad } = body.pose;
      const radius = body.extent.radius_m;
      band(pen, x_m, y_m, 1.38 * radius, 1.5 * radius, SELECTED, 0.95);
      band(pen, x_m, y_m, 1.5 * radius, 1.54 * radius, BLACK, 0.4);
      const cos = Math.cos(phi_rad);
      const sin = Math.sin(phi_rad);
      const [hx, hy] = [x_m + HANDLE * radius * cos, y_m + HANDLE * radius * sin];
      band(knob, hx, hy, 0, 0.2 * radius, SELECTED, 0.95);
      band(knob, hx, hy, 0.2 * radius, 0.27 * radius, BLACK, 0.6);
    }
    pen.end();
    knob.end();
  }

  /** Draws the chosen robot at its odometry pose, according to its last detail. */
  private drawGhost(): void {
    const { ghostPen: lines, ghostFill: fill } = this;
    lines.begin();
    fill.begin();
    const body = this.bodies.robot(this.model.chosen);
    const detail = this.model.chosen === null ? undefined : this.model.details.get(this.model.chosen);
    const anchor = detail && this.anchors.get(detail.robot);
    if (body?.isPresent && anchor && detail.run === this.model.scene?.run) {
      // Odometry pose in the world frame; between two details it moves with the robot.
      relate(anchor.odometry, detail.odometry, anchor.pose, this.ghostPose);
      relate(detail.pose, { ...this.ghostPose }, body.pose, this.ghostPose);
      const { x_m, y_m, phi_rad } = this.ghostPose;
      const radius = body.extent.radius_m;
      const z = body.extent.height_m;
      const cos = Math.cos(phi_rad);
      const sin = Math.sin(phi_rad);
      const sides = 32;
      for (let i = 0; i < sides; i++) {
        const [a, b] = [(2 * Math.PI * i) / sides, (2 * Math.PI * (i + 1)) / sides];
        const [ax, ay] = [x_m + radius * Math.cos(a), y_m + radius * Math.sin(a)];
        const [bx, by] = [x_m + radius * Math.cos(b), y_m + radius * Math.sin(b)];
        for (const height of [0.002, z]) {
          lines.to(ax, ay, height, GHOST, 0.9);
          lines.to(bx, by, height, GHOST, 0.9);
        }
        if (i % 4 === 0) {
          lines.to(ax, ay, 0.002, GHOST, 0.5);
          lines.to(ax, ay, z, GHOST, 0.5);
        }
        fill.to(x_m, y_m, z, GHOST, 0.18);
        fill.to(ax, ay, z, GHOST, 0.18);
        fill.to(bx, by, z, GHOST, 0.18);
      }
      const [tipX, tipY] = [x_m + 1.5 * radius * cos, y_m + 1.5 * radius * sin];
      lines.to(x_m, y_m, z, GHOST, 1);
      lines.to(tipX, tipY, z, GHOST, 1);
      for (const side of [1, -1]) {
        lines.to(tipX, tipY, z, GHOST, 1);
        lines.to(tipX - 0.3 * radius * (cos + side * sin), tipY - 0.3 * radius * (sin - side * cos), z, GHOST, 1);
      }
    }
    lines.end();
    fill.end();
  }
}

const BLACK: Colour = [0, 0, 0];

/** Computes `out` so that its pose relative to `now` is that of `other` relative to `base`. */
export function relate(base: Pose, other: Pose, now: Pose, out: Pose): void {
  const [dx, dy] = [other.x_m - base.x_m, other.y_m - base.y_m];
  const turn = now.phi_rad - base.phi_rad;
  const [cos, sin] = [Math.cos(turn), Math.sin(turn)];
  out.x_m = now.x_m + dx * cos - dy * sin;
  out.y_m = now.y_m + dx * sin + dy * cos;
  out.phi_rad = other.phi_rad + turn;
}

/** Draws a ring on the floor between two radii. */
function band(pen: Pen, x: number, y: number, inner: number, outer: number, colour: Colour, opacity: number): void {
  const sides = 40;
  for (let i = 0; i < sides; i++) {
    const [a, b] = [(2 * Math.PI * i) / sides, (2 * Math.PI * (i + 1)) / sides];
    const [ca, sa, cb, sb] = [Math.cos(a), Math.sin(a), Math.cos(b), Math.sin(b)];
    pen.to(x + inner * ca, y + inner * sa, 0, colour, opacity);
    pen.to(x + outer * ca, y + outer * sa, 0, colour, opacity);
    pen.to(x + outer * cb, y + outer * sb, 0, colour, opacity);
    if (inner === 0) continue;
    pen.to(x + inner * ca, y + inner * sa, 0, colour, opacity);
    pen.to(x + outer * cb, y + outer * sb, 0, colour, opacity);
    pen.to(x + inner * cb, y + inner * sb, 0, colour, opacity);
  }
}

/** Ring around a body of radius 1, with a tip ahead. */
function ring(): THREE.BufferGeometry {
  const shape = new THREE.Shape().absarc(0, 0, 1.28, 0.2, 2 * Math.PI - 0.2);
  shape.lineTo(1.62, 0);
  shape.closePath();
  shape.holes.push(new THREE.Path().absarc(0, 0, 1.12, 0, 2 * Math.PI, true));
  return new THREE.ShapeGeometry(shape, 24);
}
