// The moving bodies and their displayed poses.

import * as THREE from "three";
import type { Model } from "../model";
import type { Posture } from "../motion";
import type { Body, Link, Pose, Robot } from "../protocol";

/** A robot or a movable object on display. */
export interface BodyView {
  readonly what: "robot" | "object";
  readonly id: number;
  readonly extent: Body;
  /** Red, green and blue from 0 to 1. */
  readonly colour: readonly [number, number, number];
  /** Displayed pose. */
  readonly pose: Pose;
  /** Displayed posture; the standing posture until the run reports another one. */
  readonly posture: Posture;
  /** The links of its legs, parents before children, and the displayed pose of each in the world. */
  readonly links: readonly Link[];
  readonly frames: readonly THREE.Matrix4[];
  /** Pose to which the user drags the body, until the run has placed the body there; null if it is not dragged. */
  held: Pose | null;
  /** The body is in the world. */
  isPresent: boolean;
  isStalled: boolean;
}

/** All moving bodies. */
export class Bodies {
  robots: BodyView[] = [];
  objects: BodyView[] = [];
  /** Robots, then objects. */
  all: BodyView[] = [];
  private readonly byRobot = new Map<number, BodyView>();
  private readonly byObject = new Map<number, BodyView>();
  private readonly pose: Pose = { x_m: 0, y_m: 0, phi_rad: 0 };
  private readonly posture: Posture = { lift_m: 0, joints_rad: [] };

  constructor(private readonly model: Model) {}

  robot(id: number | null): BodyView | undefined {
    return id === null ? undefined : this.byRobot.get(id);
  }

  object(id: number): BodyView | undefined {
    return this.byObject.get(id);
  }

  /** The selected body. */
  get selected(): BodyView | undefined {
    const selected = this.model.selected;
    if (!selected) return undefined;
    return "robot" in selected ? this.robot(selected.robot) : this.object(selected.object);
  }

  /** Creates the bodies of the model's scene. */
  rebuild(): void {
    const scene = this.model.scene;
    this.robots = (scene?.robots ?? []).map((robot) => shown("robot", robot.id, robot.body, robot.colour, robot));
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
      let isPresent = body.what === "robot" ? motion.robot(body.id, t_s, this.pose) : motion.object(body.id, t_s, this.pose);
      const to = body.held ?? this.pose;
      if (body.held) isPresent = true;
      const { pose } = body;
      if (isPresent !== body.isPresent || pose.x_m !== to.x_m || pose.y_m !== to.y_m || pose.phi_rad !== to.phi_rad) {
        hasMoved = true;
        body.isPresent = isPresent;
        pose.x_m = to.x_m;
        pose.y_m = to.y_m;
        pose.phi_rad = to.phi_rad;
        placeLinks(body);
      }
      if (body.what === "robot" && motion.posture(body.id, t_s, this.posture) && takePosture(body, this.posture)) {
        hasMoved = true;
        placeLinks(body);
      }
    }
    return hasMoved;
  }
}

/** Displays a posture; returns false if it is displayed already. */
function takePosture({ posture }: BodyView, to: Posture): boolean {
  const { joints_rad } = posture;
  if (posture.lift_m === to.lift_m && joints_rad.every((angle, i) => angle === to.joints_rad[i])) return false;
  posture.lift_m = to.lift_m;
  for (let i = 0; i < joints_rad.length; i++) joints_rad[i] = to.joints_rad[i] ?? joints_rad[i]!;
  return true;
}

const base = new THREE.Matrix4();
const turned = new THREE.Matrix4();
const position = new THREE.Vector3();
const turn = new THREE.Quaternion();
const bend = new THREE.Quaternion();
const axis = new THREE.Vector3();
const UNIT = new THREE.Vector3(1, 1, 1);

/** Computes the poses of a body's links from its pose and posture. */
function placeLinks({ links, frames, pose, posture }: BodyView): void {
  if (links.length === 0) return;
  base.makeRotationZ(pose.phi_rad).setPosition(pose.x_m, pose.y_m, posture.lift_m);
  links.forEach(({ parent, origin, axis: about, joint }, i) => {
    bend.setFromAxisAngle(axis.set(...about), joint === null ? 0 : (posture.joints_rad[joint] ?? 0));
    turned.compose(position.set(...origin.position_m), turn.set(...origin.rotation).multiply(bend), UNIT);
    frames[i]!.multiplyMatrices(parent === null ? base : frames[parent]!, turned);
  });
}

function shown(what: BodyView["what"], id: number, extent: Body, [r, g, b]: [number, number, number], robot?: Robot): BodyView {
  const links = robot?.links ?? [];
  return {
    what,
    id,
    extent,
    colour: [r / 255, g / 255, b / 255],
    pose: { x_m: 0, y_m: 0, phi_rad: 0 },
    posture: { lift_m: 0, joints_rad: [...(robot?.standing_rad ?? [])] },
    links,
    frames: links.map(() => new THREE.Matrix4()),
    held: null,
    isPresent: false,
    isStalled: false,
  };
}
