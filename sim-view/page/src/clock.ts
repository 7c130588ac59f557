// The displayed simulated time.

import type { Snapshot } from "./protocol";

/** Time constant with which an error of the clock decays, in real time. */
const SETTLE_MS = 120;

/**
* Advances smoothly at the measured rate, while snapshots arrive in steps. A snapshot describes the motion of bodies until its slot
* ends. While every slot has a snapshot, the displayed time is within the latest slot; in a faster run it is between the last two
* snapshots.
*/
export class Clock {
  /** The displayed time, in seconds. */
  t_s = 0;
  private isNew = true;
  private isMoving = false;
  private rate = 0;
  private previous_s = 0;
  private latest_s = 0;
  private received_ms = 0;
  private last_ms = 0;
  private slot_s = 0;

  restart(): void {
    this.isNew = true;
    this.isMoving = false;
    this.t_s = 0;
  }

  /** Jumps to a time, for recordings. */
  set(t_s: number): void {
    this.restart();
    this.t_s = t_s;
  }

  snapshot(snapshot: Snapshot, slot_s: number, now_ms = performance.now()): void {
    this.isMoving = snapshot.state.is === "running" || (snapshot.state.is === "idle" && snapshot.rate > 0);
    this.previous_s = this.isNew ? snapshot.t_s : this.latest_s;
    this.latest_s = snapshot.t_s;
    this.received_ms = now_ms;
    this.slot_s = slot_s;
    this.rate = snapshot.rate;
    if (this.isNew) {
      this.isNew = false;
      this.t_s = snapshot.t_s;
      this.last_ms = now_ms;
    }
  }

  /** Advances to now; called once per frame. */
  tick(now_ms: number): void {
    if (this.isNew) return;
    const passed_ms = Math.max(0, now_ms - this.last_ms);
    this.last_ms = now_ms;
    if (!this.isMoving) {
      this.t_s += (this.latest_s - this.t_s) * settle(passed_ms);
      if (Math.abs(this.latest_s - this.t_s) < 1e-4) this.t_s = this.latest_s;
      return;
    }
    const step_s = this.latest_s - this.previous_s;
    const behind_s = Math.max(0, step_s - this.slot_s);
    const target_s = this.latest_s - behind_s + (this.rate * (now_ms - this.received_ms)) / 1000;
    const limit_s = this.latest_s + this.slot_s;
    let next_s = this.t_s + (this.rate * passed_ms) / 1000;
    const error_s = target_s - next_s;
    next_s = Math.abs(error_s) > 4 * (step_s + this.slot_s) ? target_s : next_s + error_s * settle(passed_ms);
    this.t_s = Math.min(limit_s, Math.max(this.t_s, next_s));
  }
}

function settle(passed_ms: number): number {
  return 1 - Math.exp(-passed_ms / SETTLE_MS);
}
