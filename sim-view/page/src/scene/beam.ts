// Views of sensors: beams of range sensors with the measured points, the laser scan, fields of view of cameras.

import * as THREE from "three";
import type { Model } from "../model";
import { poseOnPieces } from "../motion";
import type { Pose, Robot } from "../protocol";
import type { Bodies, BodyView } from "./bodies";
import { Pen, type Colour } from "./pen";

const BEAM: Colour = [1, 0.45, 0.05];
const SONAR: Colour = [0.15, 0.6, 0.95];
const SCAN: Colour = [0.1, 0.75, 0.35];
const VIEW: Colour = [0.95, 0.8, 0.15];

/** Beams in the frames of their robots; they move with the robots between snapshots. */
export class Beams {
  readonly beams = new THREE.Group();
  readonly scan = new THREE.Group();
  readonly frusta = new THREE.Group();
  private readonly lines = new Pen("lines", { renderOrder: 6 });
  private readonly cones = new Pen("triangles", { renderOrder: 5 });
  private readonly hits = new Pen("points", { size_px: 7, renderOrder: 7 });
  private readonly scanFan = new Pen("triangles", { renderOrder: 5 });
  private readonly scanHits = new Pen("points", { size_px: 4, renderOrder: 7 });
  private readonly frustumLines = new Pen("lines", { renderOrder: 6 });
  private readonly frustumFaces = new Pen("triangles", { renderOrder: 5 });
  /** For each beam: from, to (robot's frame), half angle, 1 for a hit. */
  private numbers = new Float32Array(0);
  private owners: (BodyView | undefined)[] = [];
  private scanNumbers = new Float32Array(0);
  private scanOwner: BodyView | undefined;
  private views: { body: BodyView; corners: Float32Array }[] = [];
  private readonly base: Pose = { x_m: 0, y_m: 0, phi_rad: 0 };
  private readonly at = new Float32Array(3);

  constructor(
    private readonly model: Model,
    private readonly bodies: Bodies,
  ) {
    this.beams.add(this.cones.object, this.lines.object, this.hits.object);
    this.scan.add(this.scanFan.object, this.scanHits.object);
    this.frusta.add(this.frustumFaces.object, this.frustumLines.object);
  }

  rebuild(): void {
    this.owners = [];
    this.scanOwner = undefined;
    this.views = (this.model.scene?.robots ?? []).flatMap((robot) => {
      const body = this.bodies.robot(robot.id);
      return body && robot.camera ? [{ body, corners: frustum(robot) }] : [];
    });
  }

  /** Copies the beams of the model's snapshot. */
  takeBeams(): void {
    const { snapshot, scene } = this.model;
    const beams = snapshot?.beams ?? [];
    if (this.numbers.length < 8 * beams.length) this.numbers = new Float32Array(16 * beams.length);
    this.owners.length = beams.length;
    beams.forEach((beam, i) => {
      const pieces = snapshot?.robots.find((robot) => robot.id === beam.robot)?.motion ?? [];
      if (!snapshot || !poseOnPieces(pieces, snapshot.t_s, this.base)) {
        this.owners[i] = undefined;
        return;
      }
      this.owners[i] = this.bodies.robot(beam.robot);
      into(this.base, beam.from_m, this.numbers, 8 * i);
      into(this.base, beam.to_m, this.numbers, 8 * i + 3);
      const sensor = scene?.robots.find((robot) => robot.id === beam.robot)?.sensors[beam.sensor];
      this.numbers[8 * i + 6] = sensor?.half_angle_rad ?? 0;
      this.numbers[8 * i + 7] = beam.is_hit ? 1 : 0;
    });
  }

  /** Copies the scan of the chosen robot's detail. */
  takeScan(): void {
    const detail = this.model.chosen === null ? undefined : this.model.details.get(this.model.chosen);
    this.scanOwner = detail?.scan ? this.bodies.robot(detail.robot) : undefined;
    if (!detail?.scan) return;
    const { from_m, points_m } = detail.scan;
    const size = 3 * (points_m.length + 1);
    if (this.scanNumbers.length !== size) this.scanNumbers = new Float32Array(size);
    into(detail.pose, from_m, this.scanNumbers, 0);
    points_m.forEach((point, i) => into(detail.pose, point, this.scanNumbers, 3 * (i + 1)));
  }

  update(): void {
    if (this.beams.visible) this.drawBeams();
    if (this.scan.visible) this.drawScan();
    if (this.frusta.visible) this.drawFrusta();
  }

  dispose(): void {
    for (const pen of [this.lines, this.cones, this.hits, this.scanFan, this.scanHits, this.frustumLines, this.frustumFaces])
      pen.dispose();
  }

  private drawBeams(): void {
    const { lines, cones, hits, numbers, at } = this;
    lines.begin();
    cones.begin();
    hits.begin();
    for (let i = 0; i < this.owners.length; i++) {
      const body = this.owners[i];
      if (!body?.isPresent) continue;
      const k = 8 * i;
      const half = numbers[k + 6]!;
      const isHit = numbers[k + 7] === 1;
      const colour = half > 0 ? SONAR : BEAM;
      out(body, numbers, k, at);
      const [fx, fy, fz] = [at[0]!, at[1]!, at[2]!];
      out(body, numbers, k + 3, at);
      const [tx, ty, tz] = [at[0]!, at[1]!, at[2]!];
      lines.to(fx, fy, fz, colour, isHit ? 0.95 : 0.45);
      lines.to(tx, ty, tz, colour, isHit ? 0.95 : 0.08);
      if (isHit) hits.to(tx, ty, tz, colour, 1);
      if (half === 0) continue;
      const [reach, middle] = [Math.hypot(tx - fx, ty - fy), Math.atan2(ty - fy, tx - fx)];
      const parts = 8;
      for (let p = 0; p < parts; p++) {
        const [a, b] = [middle + half * ((2 * p) / parts - 1), middle + half * ((2 * (p + 1)) / parts - 1)];
        cones.to(fx, fy, fz, colour, 0.3);
        cones.to(fx + reach * Math.cos(a), fy + reach * Math.sin(a), tz, colour, isHit ? 0.12 : 0.02);
        cones.to(fx + reach * Math.cos(b), fy + reach * Math.sin(b), tz, colour, isHit ? 0.12 : 0.02);
      }
    }
    lines.end();
    cones.end();
    hits.end();
  }

  private drawScan(): void {
    const { scanFan: fan, scanHits: hits, scanNumbers: numbers, scanOwner: body, at } = this;
    fan.begin();
    hits.begin();
    if (body?.isPresent) {
      out(body, numbers, 0, at);
      const [fx, fy, fz] = [at[0]!, at[1]!, at[2]!];
      let [lastX, lastY, lastZ, lastTurn] = [NaN, NaN, NaN, NaN];
      for (let k = 3; k < numbers.length; k += 3) {
        out(body, numbers, k, at);
        const [x, y, z] = [at[0]!, at[1]!, at[2]!];
        hits.to(x, y, z, SCAN, 1);
        const turn = Math.atan2(y - fy, x - fx);
        const step = Math.abs(((turn - lastTurn + 3 * Math.PI) % (2 * Math.PI)) - Math.PI);
        // Adjacent points across a gap without returns do not span a triangle.
        if (step < 0.1) {
          fan.to(fx, fy, fz, SCAN, 0.12);
          fan.to(lastX, lastY, lastZ, SCAN, 0.12);
          fan.to(x, y, z, SCAN, 0.12);
        }
        [lastX, lastY, lastZ, lastTurn] = [x, y, z, turn];
      }
    }
    fan.end();
    hits.end();
  }

  private drawFrusta(): void {
    const { frustumLines: lines, frustumFaces: faces, at } = this;
    lines.begin();
    faces.begin();
    for (const { body, corners } of this.views) {
      if (!body.isPresent) continue;
      const isChosen = body.what === "robot" && body.id === this.model.chosen;
      const { lift_m } = body.posture;
      const opacity = isChosen ? 0.9 : 0.4;
      for (let i = 0; i < 4; i++) {
        const ends = [0, 3 * (i + 1), 3 * (i + 1), 3 * (((i + 1) % 4) + 1)];
        for (const end of ends) {
          out(body, corners, end, at);
          lines.to(at[0]!, at[1]!, at[2]! + lift_m, VIEW, opacity);
        }
        if (!isChosen) continue;
        for (const end of [0, 3 * (i + 1), 3 * (((i + 1) % 4) + 1)]) {
          out(body, corners, end, at);
          faces.to(at[0]!, at[1]!, at[2]! + lift_m, VIEW, 0.1);
        }
      }
    }
    lines.end();
    faces.end();
  }
}

/** Apex and four corners of a camera's view frustum, in the robot's frame. */
function frustum(robot: Robot): Float32Array {
  const camera = robot.camera!;
  const position = new THREE.Vector3(...camera.mount.position_m);
  const turn = new THREE.Quaternion(...camera.mount.rotation);
  const depth = 3 * robot.body.radius_m;
  const corners = new Float32Array(15);
  position.toArray(corners, 0);
  // A full fisheye has no pyramid: the frustum is limited to 150 degrees.
  const maxHalfAngle = (75 * Math.PI) / 180;
  const side = depth * Math.tan(Math.min(maxHalfAngle, camera.horizontal_rad / 2));
  const up = depth * Math.tan(Math.min(maxHalfAngle, camera.vertical_rad / 2));
  [
    [1, 1],
    [-1, 1],
    [-1, -1],
    [1, -1],
  ].forEach(([left, high], i) => {
    new THREE.Vector3(depth, left! * side, high! * up).applyQuaternion(turn).add(position).toArray(corners, 3 * (i + 1));
  });
  return corners;
}

/** Transforms a point of the world into the frame of a pose. */
function into(pose: Pose, [x, y, z]: [number, number, number], numbers: Float32Array, at: number): void {
  const [dx, dy] = [x - pose.x_m, y - pose.y_m];
  const [cos, sin] = [Math.cos(pose.phi_rad), Math.sin(pose.phi_rad)];
  numbers[at] = dx * cos + dy * sin;
  numbers[at + 1] = dy * cos - dx * sin;
  numbers[at + 2] = z;
}

/** Transforms a point of a body's frame into the world. */
function out(body: BodyView, numbers: Float32Array, at: number, to: Float32Array): void {
  const { x_m, y_m, phi_rad } = body.pose;
  const [cos, sin] = [Math.cos(phi_rad), Math.sin(phi_rad)];
  const [x, y] = [numbers[at]!, numbers[at + 1]!];
  to[0] = x_m + x * cos - y * sin;
  to[1] = y_m + x * sin + y * cos;
  to[2] = numbers[at + 2]!;
}
