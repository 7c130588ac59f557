// Poses of bodies at a time: closed form of their pieces of motion, linear interpolation in gaps.

import type { MotionPiece, Pose, Snapshot } from "./protocol";

/** Poses of bodies. Results are written to `out`, so that frames do not allocate; returns false if a body is unknown. */
export interface MotionSource {
  robot(id: number, t_s: number, out: Pose): boolean;
  object(id: number, t_s: number, out: Pose): boolean;
  /** Posture of a robot; false for a robot without one. */
  posture(id: number, t_s: number, out: Posture): boolean;
  snapshot?(snapshot: Snapshot): void;
  restart?(): void;
}

/** Height of a robot's frame above the floor's plane, and the angles of its joints. */
export interface Posture {
  lift_m: number;
  joints_rad: number[];
}

/** Pose at a time on a piece of motion: constant rates in the body's frame. */
export function poseOnPiece(piece: MotionPiece, t_s: number, out: Pose): void {
  const t = Math.min(Math.max(0, t_s - piece.t_s), piece.lasts_s);
  const turn = piece.omega_rad_per_s * t;
  // Integrals of cosine and sine of the heading over the piece; series for small turns.
  const isSmall = Math.abs(turn) < 1e-4;
  const along = isSmall ? t * (1 - (turn * turn) / 6) : Math.sin(turn) / piece.omega_rad_per_s;
  const lateral = isSmall ? (t * turn) / 2 : (1 - Math.cos(turn)) / piece.omega_rad_per_s;
  const forward = piece.v_m_per_s * along - piece.left_m_per_s * lateral;
  const left = piece.v_m_per_s * lateral + piece.left_m_per_s * along;
  const cos = Math.cos(piece.from.phi_rad);
  const sin = Math.sin(piece.from.phi_rad);
  out.x_m = piece.from.x_m + forward * cos - left * sin;
  out.y_m = piece.from.y_m + forward * sin + left * cos;
  out.phi_rad = piece.from.phi_rad + turn;
}

/** Pose at a time on a chain of pieces of motion. */
export function poseOnPieces(pieces: readonly MotionPiece[], t_s: number, out: Pose): boolean {
  let piece = pieces[0];
  if (!piece) return false;
  for (let i = 1; i < pieces.length; i++) {
    const next = pieces[i]!;
    if (next.t_s > t_s) break;
    piece = next;
  }
  poseOnPiece(piece, t_s, out);
  return true;
}

/** MotionSource from the last two snapshots. */
export class SnapshotMotion implements MotionSource {
  private latest: Snapshot | null = null;
  private previous: Snapshot | null = null;
  private robots = new Map<number, number>();
  private objects = new Map<number, number>();
  private robotsBefore = new Map<number, number>();
  private objectsBefore = new Map<number, number>();
  private readonly end: Pose = { x_m: 0, y_m: 0, phi_rad: 0 };

  restart(): void {
    this.latest = this.previous = null;
  }

  snapshot(snapshot: Snapshot): void {
    // A snapshot of the same time, such as after an intervention, replaces the previous one.
    if (this.latest && snapshot.t_s > this.latest.t_s) {
      this.previous = this.latest;
      [this.robots, this.robotsBefore] = [this.robotsBefore, this.robots];
      [this.objects, this.objectsBefore] = [this.objectsBefore, this.objects];
    } else if (this.latest && snapshot.t_s === this.latest.t_s) {
      this.previous = null;
    }
    this.latest = snapshot;
    this.robots.clear();
    this.objects.clear();
    snapshot.robots.forEach((robot, i) => this.robots.set(robot.id, i));
    snapshot.objects.forEach((object, i) => this.objects.set(object.id, i));
  }

  robot(id: number, t_s: number, out: Pose): boolean {
    const now = this.latest?.robots[this.robots.get(id) ?? -1];
    if (!this.latest || !now) return false;
    const before = this.previous?.robots[this.robotsBefore.get(id) ?? -1];
    const first = now.motion[0];
    if (t_s >= this.latest.t_s || !before || !first || !this.previous) return poseOnPieces(now.motion, t_s, out);
    if (!poseOnPieces(before.motion, t_s, out)) return false;
    const last = before.motion[before.motion.length - 1]!;
    const known_s = last.t_s + last.lasts_s;
    if (t_s <= known_s) return true;
    poseOnPieces(now.motion, this.latest.t_s, this.end);
    mix(out, this.end, (t_s - known_s) / (this.latest.t_s - known_s));
    return true;
  }

  posture(id: number, t_s: number, out: Posture): boolean {
    const now = this.latest?.robots[this.robots.get(id) ?? -1];
    if (!this.latest || !now) return false;
    const before = this.previous?.robots[this.robotsBefore.get(id) ?? -1];
    const isBetween = this.previous !== null && before !== undefined && t_s < this.latest.t_s;
    const fraction = isBetween ? (t_s - this.previous!.t_s) / (this.latest.t_s - this.previous!.t_s) : 1;
    blend(isBetween ? before : now, now, Math.max(0, fraction), out);
    return true;
  }

  object(id: number, t_s: number, out: Pose): boolean {
    const now = this.latest?.objects[this.objects.get(id) ?? -1];
    if (!this.latest || !now) return false;
    const before = this.previous?.objects[this.objectsBefore.get(id) ?? -1];
    out.x_m = now.pose.x_m;
    out.y_m = now.pose.y_m;
    out.phi_rad = now.pose.phi_rad;
    if (t_s >= this.latest.t_s || !before || !this.previous) return true;
    const fraction = (t_s - this.previous.t_s) / (this.latest.t_s - this.previous.t_s);
    mix(out, before.pose, 1 - Math.max(0, fraction));
    return true;
  }
}

/** Moves `out` a fraction of the way to `to`. */
export function mix(out: Pose, to: Pose, fraction: number): void {
  out.x_m += (to.x_m - out.x_m) * fraction;
  out.y_m += (to.y_m - out.y_m) * fraction;
  out.phi_rad += (to.phi_rad - out.phi_rad) * fraction;
}

/** Posture that lies a fraction of the way from one to another. */
export function blend(from: Posture, to: Posture, fraction: number, out: Posture): void {
  out.lift_m = from.lift_m + (to.lift_m - from.lift_m) * fraction;
  out.joints_rad.length = to.joints_rad.length;
  to.joints_rad.forEach((angle, i) => {
    const start = from.joints_rad[i] ?? angle;
    out.joints_rad[i] = start + (angle - start) * fraction;
  });
}
