// Selecting and moving bodies by mouse, touch and keyboard.

import * as THREE from "three";
import type { Model } from "../model";
import { act } from "../panel/notice";
import type { Pose } from "../protocol";
import type { Bodies, BodyView } from "./bodies";
import type { ViewCamera } from "./camera";
import type { Marks } from "./marks";

/** Maximum motion of the pointer in a click, and tolerance for hitting a body, in pixels. */
const CLICK_PX = 4;
const NEAR_PX = 8;
const STEP_M = 0.01;
const TURN_RAD = Math.PI / 36;
/** A body moved by keys is placed after this time without a key press. */
const REST_MS = 600;

interface Drag {
  pointer: number;
  body: BodyView;
  isTurning: boolean;
  start: Pose;
  /** Point on the drag plane where the drag started; its pointer position is `x_px`, `y_px`. */
  at: THREE.Vector3;
  height_m: number;
  x_px: number;
  y_px: number;
  isMoving: boolean;
}

export class DragControl {
  private drag: Drag | null = null;
  private pressed: { x: number; y: number; pointer: number } | null = null;
  private resting = 0;
  /** The body that keys have moved, until it is placed. */
  private nudged: BodyView | null = null;
  private readonly ray = new THREE.Raycaster();
  private readonly spot = new THREE.Vector3();
  private readonly seen = new THREE.Vector3();

  /** Listens before the orbit controls do, and disables them during a drag. */
  constructor(
    private readonly model: Model,
    private readonly bodies: Bodies,
    private readonly marks: Marks,
    private readonly surface: HTMLElement,
    private readonly viewCamera: () => ViewCamera,
    private readonly changed: () => void,
  ) {
    surface.addEventListener("pointerdown", (event) => this.press(event));
    surface.addEventListener("pointermove", (event) => this.move(event));
    surface.addEventListener("pointerup", (event) => this.release(event));
    surface.addEventListener("pointercancel", () => this.drop(true));
    surface.addEventListener("keydown", (event) => this.key(event));
  }

  /** Cancels all moves: dragged bodies return to their poses. */
  cancel(): void {
    clearTimeout(this.resting);
    this.nudged = null;
    for (const body of this.bodies.all) body.held = null;
    this.drag = null;
    this.changed();
  }

  private press(event: PointerEvent): void {
    if (event.button !== 0 || !event.isPrimary) return;
    this.pressed = { x: event.clientX, y: event.clientY, pointer: event.pointerId };
    const viewCamera = this.viewCamera();
    if (viewCamera.mode === "robot") return;
    this.aim(event);
    const selected = this.bodies.selected;
    const isTurning = selected !== undefined && this.isAtHandle(event);
    const body = isTurning ? selected : this.pick();
    if (!body || !this.model.mayAct) return;
    const height_m = isTurning || event.shiftKey ? 0 : body.posture.lift_m + 0.5 * body.extent.height_m;
    if (!this.onPlane(height_m, this.spot)) return;
    viewCamera.controls.enabled = false;
    this.surface.setPointerCapture(event.pointerId);
    this.drag = {
      pointer: event.pointerId,
      body,
      isTurning: isTurning || event.shiftKey,
      start: { ...body.pose },
      at: this.spot.clone(),
      height_m,
      x_px: event.clientX,
      y_px: event.clientY,
      isMoving: false,
    };
  }

  private move(event: PointerEvent): void {
    const { drag } = this;
    if (!drag) return this.hover(event);
    if (event.pointerId !== drag.pointer) return;
    if (!drag.isMoving && Math.hypot(event.clientX - drag.x_px, event.clientY - drag.y_px) < CLICK_PX) return;
    drag.isMoving = true;
    this.surface.style.cursor = "grabbing";
    this.aim(event);
    if (!this.onPlane(drag.height_m, this.spot)) return;
    const held = (drag.body.held ??= { ...drag.start });
    if (drag.isTurning) {
      const bearing = (point: THREE.Vector3) => Math.atan2(point.y - drag.start.y_m, point.x - drag.start.x_m);
      held.phi_rad = drag.start.phi_rad + bearing(this.spot) - bearing(drag.at);
    } else {
      held.x_m = drag.start.x_m + this.spot.x - drag.at.x;
      held.y_m = drag.start.y_m + this.spot.y - drag.at.y;
    }
    this.changed();
  }

  private release(event: PointerEvent): void {
    const { drag, pressed } = this;
    this.pressed = null;
    if (drag?.isMoving) return this.drop(false);
    this.drop(true);
    if (!pressed || Math.hypot(event.clientX - pressed.x, event.clientY - pressed.y) >= CLICK_PX) return;
    if (this.viewCamera().mode === "robot") return;
    this.aim(event);
    const body = drag?.body ?? this.pick();
    if (body) this.model.select(body.what === "robot" ? { robot: body.id } : { object: body.id });
    this.surface.focus();
  }

  /** Ends a drag: places the body, or returns it. */
  private drop(isBack: boolean): void {
    const { drag } = this;
    this.drag = null;
    const viewCamera = this.viewCamera();
    viewCamera.controls.enabled = viewCamera.mode !== "robot";
    this.surface.style.cursor = "";
    if (!drag) return;
    if (isBack) {
      drag.body.held = null;
      this.changed();
    } else {
      void this.place(drag.body);
    }
  }

  /** Requests that the run place a body at its dragged pose; the body is displayed there until the run has answered. */
  private async place(body: BodyView): Promise<void> {
    const { held } = body;
    if (!held) return;
    const pose = { x_m: held.x_m, y_m: held.y_m, phi_rad: held.phi_rad };
    const isPlaced = await act(
      this.model,
      body.what === "robot" ? { do: "place_robot", robot: body.id, ...pose } : { do: "place_object", object: body.id, ...pose },
    );
    const release = () => {
      // The user may have moved the body further in the meantime.
      const isSame = body.held?.x_m === pose.x_m && body.held.y_m === pose.y_m && body.held.phi_rad === pose.phi_rad;
      if (isSame) body.held = null;
      this.changed();
    };
    // The snapshot with the new pose follows the answer.
    if (isPlaced) setTimeout(release, 150);
    else release();
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey) return;
    const viewCamera = this.viewCamera();
    const arrow = ARROWS[event.key];
    const body = this.bodies.selected;
    if (event.key === "Escape") this.cancel();
    else if (event.key === "Enter" && body?.held) this.settle(body);
    else if (event.key === "PageDown" || event.key === "PageUp") this.model.moveSelection(event.key === "PageDown" ? 1 : -1);
    else if (event.key === "+" || event.key === "=") viewCamera.zoom(1 / 1.15);
    else if (event.key === "-") viewCamera.zoom(1.15);
    else if (event.key === "[" || event.key === "]") this.nudge(body, 0, 0, event.key === "[" ? TURN_RAD : -TURN_RAD);
    else if (arrow && event.shiftKey) this.push(body, arrow[0], arrow[1]);
    else if (arrow && event.altKey) viewCamera.pan(arrow[0], arrow[1]);
    else if (arrow) viewCamera.orbit(-0.08 * arrow[0], 0.06 * arrow[1]);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  /** Moves a body by a step along the floor axis that is closest to the arrow's direction on the screen. */
  private push(body: BodyView | undefined, right: number, ahead: number): void {
    const [x, y] = this.viewCamera().axes();
    const offset = x.multiplyScalar(right).add(y.multiplyScalar(ahead));
    const isAlongX = Math.abs(offset.x) >= Math.abs(offset.y);
    this.nudge(body, isAlongX ? STEP_M * Math.sign(offset.x) : 0, isAlongX ? 0 : STEP_M * Math.sign(offset.y), 0);
  }

  private nudge(body: BodyView | undefined, x_m: number, y_m: number, phi_rad: number): void {
    if (!body?.isPresent || !this.model.mayAct) return;
    if (this.nudged && this.nudged !== body) this.settle(this.nudged);
    this.nudged = body;
    const held = (body.held ??= { ...body.pose });
    held.x_m += x_m;
    held.y_m += y_m;
    held.phi_rad += phi_rad;
    this.changed();
    clearTimeout(this.resting);
    this.resting = window.setTimeout(() => this.settle(body), REST_MS);
  }

  private settle(body: BodyView): void {
    clearTimeout(this.resting);
    this.nudged = null;
    void this.place(body);
  }

  private hover(event: PointerEvent): void {
    if (event.buttons !== 0 || this.viewCamera().mode === "robot") return;
    this.aim(event);
    const isOver = this.isAtHandle(event) || this.pick() !== undefined;
    this.surface.style.cursor = isOver ? (this.model.mayAct ? "grab" : "pointer") : "";
  }

  private aim(event: PointerEvent): void {
    const box = this.surface.getBoundingClientRect();
    const x = ((event.clientX - box.left) / box.width) * 2 - 1;
    const y = 1 - ((event.clientY - box.top) / box.height) * 2;
    this.ray.setFromCamera(new THREE.Vector2(x, y), this.viewCamera().camera);
  }

  /** The nearest body whose upright bounding cylinder is at the pointer, or close to it. */
  private pick(): BodyView | undefined {
    const { origin, direction } = this.ray.ray;
    const slack = NEAR_PX / this.viewCamera().px_per_m;
    let found: BodyView | undefined;
    let nearest = Infinity;
    for (const body of this.bodies.all) {
      if (!body.isPresent) continue;
      const distance = hitCylinder(origin, direction, body, 0.25 * slack) ?? hitCylinder(origin, direction, body, slack);
      if (distance === null || distance >= nearest) continue;
      nearest = distance;
      found = body;
    }
    return found;
  }

  private isAtHandle(event: PointerEvent): boolean {
    if (!this.marks.handle(this.seen)) return false;
    const box = this.surface.getBoundingClientRect();
    this.seen.project(this.viewCamera().camera);
    const x = box.left + (0.5 + 0.5 * this.seen.x) * box.width;
    const y = box.top + (0.5 - 0.5 * this.seen.y) * box.height;
    return Math.hypot(event.clientX - x, event.clientY - y) < (event.pointerType === "mouse" ? 9 : 18);
  }

  private onPlane(height_m: number, out: THREE.Vector3): boolean {
    const { origin, direction } = this.ray.ray;
    const distance = (height_m - origin.z) / direction.z;
    if (!Number.isFinite(distance) || distance <= 0) return false;
    out.copy(origin).addScaledVector(direction, distance);
    return true;
  }
}

const ARROWS: Record<string, readonly [number, number] | undefined> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

/** Distance at which a ray hits a body's upright cylinder, widened by `slack`; null if there is no hit. */
function hitCylinder(origin: THREE.Vector3, direction: THREE.Vector3, body: BodyView, slack: number): number | null {
  const radius = body.extent.radius_m + slack;
  const [dx, dy] = [origin.x - body.pose.x_m, origin.y - body.pose.y_m];
  const a = direction.x ** 2 + direction.y ** 2;
  const b = dx * direction.x + dy * direction.y;
  const c = dx ** 2 + dy ** 2 - radius ** 2;
  const [bottom_m, top_m] = [body.posture.lift_m, body.posture.lift_m + body.extent.height_m];
  // Hit on the top, from above.
  const top = (top_m - origin.z) / direction.z;
  if (top > 0 && (dx + top * direction.x) ** 2 + (dy + top * direction.y) ** 2 <= radius ** 2) return top;
  const root = b * b - a * c;
  if (a < 1e-12 || root < 0) return null;
  const distance = (-b - Math.sqrt(root)) / a;
  const height = origin.z + distance * direction.z;
  return distance > 0 && height >= bottom_m - slack && height <= top_m + slack ? distance : null;
}
