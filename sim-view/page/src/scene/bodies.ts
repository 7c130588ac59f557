// The moving bodies and their displayed poses.

import type { Model } from "../model";
import type { Body, Pose } from "../protocol";

/** A robot or a movable object on display. */
export interface Shown {
  readonly what: "robot" | "object";
  readonly id: number;
  readonly extent: Body;
  /** Red, green and blue from 0 to 1. */
  readonly colour: readonly [number, number, number];
  /** Displayed pose. */
  readonly pose: Pose;
  /** Pose to which the user drags it, until the run has placed it there; null if it is not dragged. */
  held: Pose | null;
  /** The body is in the world. */
  isThere: boolean;
  isStalled: boolean;
}

/** All moving bodies. */
export class Bodies {
  robots: Shown[] = [];
  objects: Shown[] = [];
  /** Robots, then objects. */
  all: Shown[] = [];
  private readonly byRobot = new Map<number, Shown>();
  private readonly byObject = new Map<number, Shown>();
  private readonly pose: Pose = { x_m: 0, y_m: 0, phi_rad: 0 };

  constructor(private readonly model: Model) {}

  robot(id: number | null): Shown | undefined {
    return id === null ? undefined : this.byRobot.get(id);
  }

  object(id: number): Shown | undefined {
    return this.byObject.get(id);
  }

  /** The selected body. */
  get selected(): Shown | undefined {
    const selected = this.model.selected;
    if (!selected) return undefined;
    return "robot" in selected ? this.robot(selected.robot) : this.object(selected.object);
  }

  /** Creates the bodies of the model's scene. */
  rebuild(): void {
    const scene = this.model.scene;
    this.robots = (scene?.robots ?? []).map((robot) => shown("robot", robot.id, robot.body, robot.colour));
    this.objects = (scene?.objects ?? []).map((object) => shown("object", object.id, object.body, [200, 200, 200]));
    this.all = [...this.robots, ...this.objects];
    this.byRobot.clear();
    this.byObject.clear();
    for (const body of this.robots) this.byRobot.set(body.id, body);
    for (const body of this.objects) this.byObject.set(body.id, body);
  }

  /** Copies the states other than poses from the snapshot. */
  mark(): void {
    for (const body of this.robots) body.isStalled = false;
    for (const state of this.model.snapshot?.robots ?? []) {
      const body = this.byRobot.get(state.id);
      if (body) body.isStalled = state.is_stalled;
    }
  }

  /** Moves all bodies to their poses at a time; returns true if any has moved. */
  update(t_s: number): boolean {
    let hasMoved = false;
    for (const body of this.all) {
      const motion = this.model.motion;
      let isThere = body.what === "robot" ? motion.robot(body.id, t_s, this.pose) : motion.object(body.id, t_s, this.pose);
      const to = body.held ?? this.pose;
      if (body.held) isThere = true;
      const { pose } = body;
      if (isThere !== body.isThere || pose.x_m !== to.x_m || pose.y_m !== to.y_m || pose.phi_rad !== to.phi_rad) {
        hasMoved = true;
        body.isThere = isThere;
        pose.x_m = to.x_m;
        pose.y_m = to.y_m;
        pose.phi_rad = to.phi_rad;
      }
    }
    return hasMoved;
  }
}

function shown(what: Shown["what"], id: number, extent: Body, [r, g, b]: [number, number, number]): Shown {
  const pose = { x_m: 0, y_m: 0, phi_rad: 0 };
  return { what, id, extent, colour: [r / 255, g / 255, b / 255], pose, held: null, isThere: false, isStalled: false };
}
