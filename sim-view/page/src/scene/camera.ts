// The camera of the view: orbit, pan and zoom, home and top view, following a robot, a robot's own view.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Model } from "../model";
import type { Robot, Scene } from "../protocol";
import type { Bodies, BodyView } from "./bodies";

const FOV_DEG = 38;
const TRANSITION_MS = 450;

export type Mode = "free" | "follow" | "robot";

/** Camera position relative to a target: azimuth from x in the plane, polar angle from the vertical, distance. */
interface OrbitPose {
  target: THREE.Vector3;
  azimuth: number;
  polar: number;
  distance: number;
}

interface Transition {
  from: OrbitPose;
  to: OrbitPose;
  age_ms: number;
}

export class ViewCamera {
  readonly camera = new THREE.PerspectiveCamera(FOV_DEG, 1, 0.01, 1000);
  readonly controls: OrbitControls;
  mode: Mode = "free";
  /** Called when the mode or the view has changed. */
  onchange: () => void = () => {};
  private transition: Transition | null = null;
  /** Direction from which the whole world is shown; null after the user has changed the view. */
  private wholeFrom: THREE.Vector3 | null = null;
  /** True between press and release of a pointer on the view. */
  private isHeld = false;
  private readonly lastPosition = new THREE.Vector3();
  private readonly position = new THREE.Vector3();
  private followed: BodyView | null = null;
  private readonly mountRotation = new THREE.Quaternion();
  private readonly heading = new THREE.Quaternion();

  constructor(
    private readonly model: Model,
    private readonly bodies: Bodies,
    private readonly element: HTMLElement,
    private readonly prefersReducedMotion: () => boolean,
  ) {
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, element);
    this.controls.maxPolarAngle = 0.495 * Math.PI;
    this.controls.enableDamping = false;
    this.controls.zoomToCursor = true;
    this.controls.screenSpacePanning = false;
    this.controls.addEventListener("change", () => {
      if (this.isHeld) this.wholeFrom = null;
      this.onchange();
    });
    this.controls.addEventListener("start", () => {
      this.transition = null;
      this.isHeld = true;
    });
    this.controls.addEventListener("end", () => {
      this.isHeld = false;
    });
  }

  /** Follows the chosen robot, looks through its camera, or neither. */
  setMode(mode: Mode): void {
    this.wholeFrom = null;
    if (this.mode === "robot" && mode !== "robot") {
      this.mode = mode;
      this.camera.fov = FOV_DEG;
      this.resize();
      this.home(false);
    }
    if (mode !== "free") this.wholeFrom = null;
    this.mode = mode;
    this.followed = null;
    this.controls.enabled = mode !== "robot";
    this.onchange();
  }

  resize(): void {
    this.camera.aspect = this.element.clientWidth / Math.max(1, this.element.clientHeight);
    this.camera.updateProjectionMatrix();
    if (this.wholeFrom) this.viewFrom(this.wholeFrom, false);
    this.onchange();
  }

  /** Shows the whole world obliquely, as close as it fits. */
  home(isSmooth = true): void {
    this.viewFrom(new THREE.Vector3(0.08, -0.62, 0.86), isSmooth);
  }

  /** Shows the whole world from straight above, y upwards. */
  top(isSmooth = true): void {
    this.viewFrom(new THREE.Vector3(0, -1e-3, 1), isSmooth);
  }

  /** Moves a body to the centre of the view. */
  centre(body: BodyView): void {
    if (this.mode === "robot") return;
    this.wholeFrom = null;
    const target = new THREE.Vector3(body.pose.x_m, body.pose.y_m, 0);
    const offset = this.camera.position.clone().sub(this.controls.target);
    const distance = Math.min(offset.length(), 30 * body.extent.radius_m);
    this.go(target.clone().addScaledVector(offset.normalize(), distance), target, true);
  }

  /** Rotates the camera about its target by steps, for keys. */
  orbit(left: number, up: number): void {
    if (this.mode === "robot") return;
    this.release();
    const { target, azimuth, polar, distance } = this.orbitPose;
    const maxPolar = this.controls.maxPolarAngle;
    this.orbitPose = { target, azimuth: azimuth + left, polar: Math.min(maxPolar, Math.max(1e-3, polar - up)), distance };
  }

  zoom(factor: number): void {
    if (this.mode === "robot") return;
    this.release();
    const offset = this.camera.position.clone().sub(this.controls.target);
    const length = Math.min(this.controls.maxDistance, Math.max(this.controls.minDistance, offset.length() * factor));
    this.camera.position.copy(this.controls.target).addScaledVector(offset.normalize(), length);
    this.controls.update();
  }

  pan(right: number, ahead: number): void {
    if (this.mode === "robot") return;
    this.release();
    const step = 0.06 * this.camera.position.distanceTo(this.controls.target);
    const [x, y] = this.axes();
    const move = new THREE.Vector3(x.x * right + y.x * ahead, x.y * right + y.y * ahead, 0).multiplyScalar(step);
    this.camera.position.add(move);
    this.controls.target.add(move);
    this.controls.update();
  }

  /** Directions on the floor that point to the right and ahead on the screen. */
  axes(): [THREE.Vector2, THREE.Vector2] {
    const right = new THREE.Vector3().setFromMatrixColumn(this.camera.matrixWorld, 0);
    const x = new THREE.Vector2(right.x, right.y).normalize();
    return [x, new THREE.Vector2(-x.y, x.x)];
  }

  /** The robot whose camera is shown. */
  get robot(): BodyView | null {
    return this.mode === "robot" ? (this.bodies.robot(this.model.chosen) ?? null) : null;
  }

  /** Pixels per metre at the centre of the view. */
  get px_per_m(): number {
    const distance = this.mode === "robot" ? 1 : this.camera.position.distanceTo(this.controls.target);
    return this.element.clientHeight / (2 * distance * Math.tan((this.camera.fov * Math.PI) / 360));
  }

  update(passed_ms: number): void {
    if (this.mode === "robot") return this.lookThrough();
    if (this.transition) this.move(passed_ms);
    if (this.mode === "follow") this.follow();
  }

  /** Adapts distances and the view to a new world. */
  fit(scene: Scene): void {
    const [[left, low], [right, high]] = scene.bounds_m;
    const size = Math.hypot(right - left, high - low);
    this.camera.near = size / 400;
    this.camera.far = 80 * size;
    this.controls.minDistance = size / 60;
    this.controls.maxDistance = 6 * size;
    this.resize();
    this.home(false);
  }

  /** Leaves the view to the user. */
  private release(): void {
    this.transition = null;
    this.wholeFrom = null;
  }

  private viewFrom(direction: THREE.Vector3, isSmooth: boolean): void {
    const scene = this.model.scene;
    if (!scene) return;
    if (this.mode === "robot") return this.setMode("free");
    if (this.mode === "follow") this.setMode("free");
    this.wholeFrom = direction;
    const [[left, low], [right, high]] = scene.bounds_m;
    direction.normalize();
    const target = new THREE.Vector3(0.5 * (left + right), 0.5 * (low + high), 0);
    const tall = Math.max(0.1, ...scene.robots.map(({ body }) => body.height_m));
    const corners = [0, tall].flatMap((z) =>
      [left, right].flatMap((x) => [low, high].map((y) => new THREE.Vector3(x, y, z))),
    );
    // Bisects for the smallest distance at which all corners are visible, with their middle at the centre of the view.
    const camera = this.camera.clone();
    const size = Math.hypot(right - left, high - low);
    let [lower, upper] = [0.1 * size, 8 * size];
    for (let i = 0; i < 30; i++) {
      const distance = 0.5 * (lower + upper);
      const [width, height] = this.extent(camera, corners, target, direction, distance);
      if (width < 1.86 && height < 1.8) upper = distance;
      else lower = distance;
    }
    this.go(target.clone().addScaledVector(direction, upper), target, isSmooth);
  }

  /** Width and height of the corners' bounding box in the view (which spans 2); moves the target to the centre of the box. */
  private extent(
    camera: THREE.PerspectiveCamera,
    corners: readonly THREE.Vector3[],
    target: THREE.Vector3,
    direction: THREE.Vector3,
    distance: number,
  ): [number, number] {
    const box = new THREE.Box2();
    for (let pass = 0; pass < 3; pass++) {
      camera.position.copy(target).addScaledVector(direction, distance);
      camera.lookAt(target);
      camera.updateMatrixWorld();
      box.makeEmpty();
      for (const corner of corners) {
        const projected = corner.clone().project(camera);
        if (projected.z > 1) return [Infinity, Infinity];
        box.expandByPoint(new THREE.Vector2(projected.x, projected.y));
      }
      const middle = new THREE.Vector3(0.5 * (box.min.x + box.max.x), 0.5 * (box.min.y + box.max.y), 0.5).unproject(camera);
      const ray = middle.sub(camera.position).normalize();
      if (ray.z < -1e-3) target.copy(camera.position).addScaledVector(ray, -camera.position.z / ray.z);
    }
    return [box.max.x - box.min.x, box.max.y - box.min.y];
  }

  private go(to: THREE.Vector3, toTarget: THREE.Vector3, isSmooth: boolean): void {
    const goal = orbitPoseOf(to, toTarget);
    this.transition = isSmooth && !this.prefersReducedMotion() ? { from: this.orbitPose, to: goal, age_ms: 0 } : null;
    if (!this.transition) this.orbitPose = goal;
    this.onchange();
  }

  private move(passed_ms: number): void {
    const transition = this.transition!;
    transition.age_ms += passed_ms;
    const s = Math.min(1, transition.age_ms / TRANSITION_MS);
    const progress = s * s * (3 - 2 * s);
    const { from, to } = transition;
    const deltaAzimuth = Math.atan2(Math.sin(to.azimuth - from.azimuth), Math.cos(to.azimuth - from.azimuth));
    this.orbitPose = {
      target: from.target.clone().lerp(to.target, progress),
      azimuth: from.azimuth + progress * deltaAzimuth,
      polar: from.polar + progress * (to.polar - from.polar),
      distance: from.distance * (to.distance / from.distance) ** progress,
    };
    if (s === 1) this.transition = null;
    this.onchange();
  }

  private get orbitPose(): OrbitPose {
    return orbitPoseOf(this.camera.position, this.controls.target);
  }

  private set orbitPose({ target, azimuth, polar, distance }: OrbitPose) {
    const horizontal = distance * Math.sin(polar);
    this.controls.target.copy(target);
    this.camera.position.set(horizontal * Math.cos(azimuth), horizontal * Math.sin(azimuth), distance * Math.cos(polar)).add(target);
    this.controls.update();
  }

  private follow(): void {
    const body = this.bodies.robot(this.model.chosen);
    if (!body?.isPresent) return;
    this.position.set(body.pose.x_m, body.pose.y_m, 0);
    if (this.followed !== body) {
      if (!this.followed) this.centre(body);
      this.followed = body;
      if (this.transition) {
        this.lastPosition.copy(this.position);
        return;
      }
      this.lastPosition.copy(this.controls.target).setZ(0);
    }
    const move = this.lastPosition.sub(this.position).negate();
    if (move.lengthSq() > 0) {
      this.camera.position.add(move);
      this.controls.target.add(move);
      if (this.transition) {
        this.transition.from.target.add(move);
        this.transition.to.target.add(move);
      }
      this.controls.update();
    }
    this.lastPosition.copy(this.position);
  }

  /** Looks through the robot's camera or, if it has none, ahead from its front. */
  private lookThrough(): void {
    const body = this.robot;
    const robot = this.model.scene?.robots.find(({ id }) => id === this.model.chosen);
    if (!body || !robot) return this.setMode("free");
    const { pose } = body;
    const mount = robot.camera?.mount.position_m ?? [0.8 * body.extent.radius_m, 0, body.extent.height_m];
    this.heading.setFromAxisAngle(UP, pose.phi_rad);
    this.camera.position.set(mount[0], mount[1], mount[2]).applyQuaternion(this.heading);
    this.camera.position.x += pose.x_m;
    this.camera.position.y += pose.y_m;
    this.camera.position.z += body.posture.lift_m;
    if (robot.camera) this.mountRotation.set(...robot.camera.mount.rotation);
    else this.mountRotation.identity();
    this.camera.quaternion.copy(this.heading).multiply(this.mountRotation).multiply(ROBOT_FROM_OPTICAL);
    const [, vertical] = this.fovFor(robot);
    if (this.camera.fov !== vertical) {
      this.camera.fov = vertical;
      this.camera.updateProjectionMatrix();
    }
  }

  /** Horizontal and vertical field of view, in degrees, that contain the field of view of a robot's camera. */
  private fovFor(robot: Robot): [number, number] {
    const { horizontal_rad, vertical_rad } = robot.camera ?? { horizontal_rad: 1, vertical_rad: 0.8 };
    const tan = (angle: number) => Math.tan(Math.min(angle, 2.4) / 2);
    const up = Math.max(tan(vertical_rad), tan(horizontal_rad) / this.camera.aspect) * 1.04;
    return [(2 * Math.atan(up * this.camera.aspect) * 180) / Math.PI, (2 * Math.atan(up) * 180) / Math.PI];
  }

  /** Fractions of the view's width and height covered by the image of the robot's camera; null in other views or for a wide lens. */
  frame(): [number, number] | null {
    const robot = this.model.scene?.robots.find(({ id }) => id === this.model.chosen);
    if (this.mode !== "robot" || !robot?.camera || robot.camera.horizontal_rad > 2.4) return null;
    const up = Math.tan((this.camera.fov * Math.PI) / 360);
    return [
      Math.tan(robot.camera.horizontal_rad / 2) / (up * this.camera.aspect),
      Math.tan(robot.camera.vertical_rad / 2) / up,
    ];
  }

  dispose(): void {
    this.controls.dispose();
  }
}

function orbitPoseOf(from: THREE.Vector3, target: THREE.Vector3): OrbitPose {
  const offset = from.clone().sub(target);
  const distance = offset.length();
  const horizontal = Math.hypot(offset.x, offset.y);
  return { target: target.clone(), azimuth: horizontal > 0 ? Math.atan2(offset.y, offset.x) : -Math.PI / 2, polar: Math.atan2(horizontal, offset.z), distance };
}

const UP = new THREE.Vector3(0, 0, 1);
/** Rotation from the camera of three.js (looks along -z, y up) to the robot's (looks along x, z up). */
const ROBOT_FROM_OPTICAL = new THREE.Quaternion().setFromRotationMatrix(
  new THREE.Matrix4().makeBasis(new THREE.Vector3(0, -1, 0), new THREE.Vector3(0, 0, 1), new THREE.Vector3(-1, 0, 0)),
);
