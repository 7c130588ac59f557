// Poses of bodies at a time: closed form of their legs, linear interpolation in gaps.

import type { MotionPiece, Pose, Snapshot } from "./protocol";

/** Poses of bodies. Results are written to `out`, so that frames do not allocate; returns false if a body is unknown. */
export interface Motion {
  robot(id: number, t_s: number, out: Pose): boolean;
  object(id: number, t_s: number, out: Pose): boolean;
  snapshot?(snapshot: Snapshot): void;
  restart?(): void;
}

/** Pose at a time on a leg: constant rates in the body's frame. */
export function poseOnPiece(leg: MotionPiece, t_s: number, out: Pose): void {
  const t = Math.min(Math.max(0, t_s - leg.t_s), leg.lasts_s);
  const turn = leg.omega_rad_per_s * t;
  // Integrals of cosine and sine of the heading over the leg; series for small turns.
  const isSmall = Math.abs(turn) < 1e-4;
  const along = isSmall ? t * (1 - (turn * turn) / 6) : Math.sin(turn) / leg.omega_rad_per_s;
  const aside = isSmall ? (t * turn) / 2 : (1 - Math.cos(turn)) / leg.omega_rad_per_s;
  const forward = leg.v_m_per_s * along - leg.left_m_per_s * aside;
  const left = leg.v_m_per_s * aside + leg.left_m_per_s * along;
  const cos = Math.cos(leg.from.phi_rad);
  const sin = Math.sin(leg.from.phi_rad);
  out.x_m = leg.from.x_m + forward * cos - left * sin;
  out.y_m = leg.from.y_m + forward * sin + left * cos;
  out.phi_rad = leg.from.phi_rad + turn;
}

/** Pose at a time on a chain of legs. */
export function poseOnPieces(legs: readonly MotionPiece[], t_s: number, out: Pose): boolean {
  let leg = legs[0];
  if (!leg) return false;
  for (let i = 1; i < legs.length; i++) {
    const next = legs[i]!;
    if (next.t_s > t_s) break;
    leg = next;
  }
  poseOnPiece(leg, t_s, out);
  return true;
}

/** Motion from the last two snapshots. */
export class SnapshotMotion implements Motion {
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
    // A snapshot of the same time, such as after an intervention, replaces the one before.
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
    const first = now.legs[0];
    if (t_s >= this.latest.t_s || !before || !first || !this.previous) return poseOnPieces(now.legs, t_s, out);
    if (!poseOnPieces(before.legs, t_s, out)) return false;
    const last = before.legs[before.legs.length - 1]!;
    const known_s = last.t_s + last.lasts_s;
    if (t_s <= known_s) return true;
    poseOnPieces(now.legs, this.latest.t_s, this.end);
    mix(out, this.end, (t_s - known_s) / (this.latest.t_s - known_s));
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
    const share = (t_s - this.previous.t_s) / (this.latest.t_s - this.previous.t_s);
    mix(out, before.pose, 1 - Math.max(0, share));
    return true;
  }
}

/** Moves `out` a share of the way to `to`. */
export function mix(out: Pose, to: Pose, share: number): void {
  out.x_m += (to.x_m - out.x_m) * share;
  out.y_m += (to.y_m - out.y_m) * share;
  out.phi_rad += (to.phi_rad - out.phi_rad) * share;
}
