// The camera of the view: orbit, pan and zoom, home and top view, following a robot, a robot's own view.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { Model } from "../model";
import type { Robot, Scene } from "../protocol";
import type { Bodies, Shown } from "./bodies";

const FIELD_DEG = 38;
const TRAVEL_MS = 450;

export type Mode = "free" | "follow" | "robot";

/** Camera position relative to a target: azimuth from x in the plane, polar angle from the vertical, distance. */
interface Look {
  target: THREE.Vector3;
  turn: number;
  tilt: number;
  distance: number;
}

interface Travel {
  from: Look;
  to: Look;
  age_ms: number;
}

export class ViewCamera {
  readonly camera = new THREE.PerspectiveCamera(FIELD_DEG, 1, 0.01, 1000);
  readonly controls: OrbitControls;
  mode: Mode = "free";
  /** Called when the mode or the view has changed. */
  onchange: () => void = () => {};
  private travel: Travel | null = null;
  private readonly last = new THREE.Vector3();
  private readonly now = new THREE.Vector3();
  private followed: Shown | null = null;
  private readonly turn = new THREE.Quaternion();
  private readonly heading = new THREE.Quaternion();

  constructor(
    private readonly model: Model,
    private readonly bodies: Bodies,
    private readonly surface: HTMLElement,
    private readonly isReduced: () => boolean,
  ) {
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, surface);
    this.controls.maxPolarAngle = 0.495 * Math.PI;
    this.controls.enableDamping = false;
    this.controls.zoomToCursor = true;
    this.controls.screenSpacePanning = false;
    this.controls.addEventListener("change", () => this.onchange());
    this.controls.addEventListener("start", () => (this.travel = null));
  }

  /** Follows the chosen robot, looks through its camera, or neither. */
  setMode(mode: Mode): void {
    if (this.mode === "robot" && mode !== "robot") {
      this.mode = mode;
      this.camera.fov = FIELD_DEG;
      this.resize();
      this.home(false);
    }
    this.mode = mode;
    this.followed = null;
    this.controls.enabled = mode !== "robot";
    this.onchange();
  }

  resize(): void {
    this.camera.aspect = this.surface.clientWidth / Math.max(1, this.surface.clientHeight);
    this.camera.updateProjectionMatrix();
    this.onchange();
  }

  /** Shows the whole world obliquely, as close as it fits. */
  home(isSmooth = true): void {
    this.lookFrom(new THREE.Vector3(0.08, -0.62, 0.86), isSmooth);
  }

  /** Shows the whole world from straight above, y upwards. */
  top(isSmooth = true): void {
    this.lookFrom(new THREE.Vector3(0, -1e-3, 1), isSmooth);
  }

  /** Moves a body to the centre of the view. */
  centre(body: Shown): void {
    if (this.mode === "robot") return;
    const target = new THREE.Vector3(body.pose.x_m, body.pose.y_m, 0);
    const way = this.camera.position.clone().sub(this.controls.target);
    const near = Math.min(way.length(), 30 * body.extent.radius_m);
    this.go(target.clone().addScaledVector(way.normalize(), near), target, true);
  }

  /** Rotates the camera about its target by steps, for keys. */
  orbit(left: number, up: number): void {
    if (this.mode === "robot") return;
    this.travel = null;
    const { target, turn, tilt, distance } = this.look;
    const most = this.controls.maxPolarAngle;
    this.look = { target, turn: turn + left, tilt: Math.min(most, Math.max(1e-3, tilt - up)), distance };
  }

  zoom(factor: number): void {
    if (this.mode === "robot") return;
    this.travel = null;
    const way = this.camera.position.clone().sub(this.controls.target);
    const length = Math.min(this.controls.maxDistance, Math.max(this.controls.minDistance, way.length() * factor));
    this.camera.position.copy(this.controls.target).addScaledVector(way.normalize(), length);
    this.controls.update();
  }

  shift(right: number, ahead: number): void {
    if (this.mode === "robot") return;
    this.travel = null;
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
  get robot(): Shown | null {
    return this.mode === "robot" ? (this.bodies.robot(this.model.chosen) ?? null) : null;
  }

  /** Pixels per metre at the centre of the view. */
  get px_per_m(): number {
    const distance = this.mode === "robot" ? 1 : this.camera.position.distanceTo(this.controls.target);
    return this.surface.clientHeight / (2 * distance * Math.tan((this.camera.fov * Math.PI) / 360));
  }

  update(passed_ms: number): void {
    if (this.mode === "robot") return this.lookThrough();
    if (this.travel) this.move(passed_ms);
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

  private lookFrom(way: THREE.Vector3, isSmooth: boolean): void {
    const scene = this.model.scene;
    if (!scene) return;
    if (this.mode === "robot") return this.setMode("free");
    if (this.mode === "follow") this.setMode("free");
    const [[left, low], [right, high]] = scene.bounds_m;
    way.normalize();
    const target = new THREE.Vector3(0.5 * (left + right), 0.5 * (low + high), 0);
    const tall = Math.max(0.1, ...scene.robots.map(({ body }) => body.height_m));
    const corners = [0, tall].flatMap((z) =>
      [left, right].flatMap((x) => [low, high].map((y) => new THREE.Vector3(x, y, z))),
    );
    // Bisects for the distance from which all corners are visible, with their middle at the centre of the view.
    const camera = this.camera.clone();
    const size = Math.hypot(right - left, high - low);
    let [near, far] = [0.1 * size, 8 * size];
    for (let i = 0; i < 30; i++) {
      const distance = 0.5 * (near + far);
      const [width, height] = this.extent(camera, corners, target, way, distance);
      if (width < 1.86 && height < 1.8) far = distance;
      else near = distance;
    }
    this.go(target.clone().addScaledVector(way, far), target, isSmooth);
  }

  /** Width and height of the corners' bounding box in the view (which spans 2); moves the target to the centre of the box. */
  private extent(
    camera: THREE.PerspectiveCamera,
    corners: readonly THREE.Vector3[],
    target: THREE.Vector3,
    way: THREE.Vector3,
    distance: number,
  ): [number, number] {
    const box = new THREE.Box2();
    for (let pass = 0; pass < 3; pass++) {
      camera.position.copy(target).addScaledVector(way, distance);
      camera.lookAt(target);
      camera.updateMatrixWorld();
      box.makeEmpty();
      for (const corner of corners) {
        const seen = corner.clone().project(camera);
        if (seen.z > 1) return [Infinity, Infinity];
        box.expandByPoint(new THREE.Vector2(seen.x, seen.y));
      }
      const middle = new THREE.Vector3(0.5 * (box.min.x + box.max.x), 0.5 * (box.min.y + box.max.y), 0.5).unproject(camera);
      const ray = middle.sub(camera.position).normalize();
      if (ray.z < -1e-3) target.copy(camera.position).addScaledVector(ray, -camera.position.z / ray.z);
    }
    return [box.max.x - box.min.x, box.max.y - box.min.y];
  }

  private go(to: THREE.Vector3, toTarget: THREE.Vector3, isSmooth: boolean): void {
    const goal = lookOf(to, toTarget);
    this.travel = isSmooth && !this.isReduced() ? { from: this.look, to: goal, age_ms: 0 } : null;
    if (!this.travel) this.look = goal;
    this.onchange();
  }

  private move(passed_ms: number): void {
    const travel = this.travel!;
    travel.age_ms += passed_ms;
    const s = Math.min(1, travel.age_ms / TRAVEL_MS);
    const share = s * s * (3 - 2 * s);
    const { from, to } = travel;
    const turn = Math.atan2(Math.sin(to.turn - from.turn), Math.cos(to.turn - from.turn));
    this.look = {
      target: from.target.clone().lerp(to.target, share),
      turn: from.turn + share * turn,
      tilt: from.tilt + share * (to.tilt - from.tilt),
      distance: from.distance * (to.distance / from.distance) ** share,
    };
    if (s === 1) this.travel = null;
    this.onchange();
  }

  private get look(): Look {
    return lookOf(this.camera.position, this.controls.target);
  }

  private set look({ target, turn, tilt, distance }: Look) {
    const flat = distance * Math.sin(tilt);
    this.controls.target.copy(target);
    this.camera.position.set(flat * Math.cos(turn), flat * Math.sin(turn), distance * Math.cos(tilt)).add(target);
    this.controls.update();
  }

  private follow(): void {
    const body = this.bodies.robot(this.model.chosen);
    if (!body?.isThere) return;
    this.now.set(body.pose.x_m, body.pose.y_m, 0);
    if (this.followed !== body) {
      if (!this.followed) this.centre(body);
      this.followed = body;
      if (this.travel) {
        this.last.copy(this.now);
        return;
      }
      this.last.copy(this.controls.target).setZ(0);
    }
    const move = this.last.sub(this.now).negate();
    if (move.lengthSq() > 0) {
      this.camera.position.add(move);
      this.controls.target.add(move);
      if (this.travel) {
        this.travel.from.target.add(move);
        this.travel.to.target.add(move);
      }
      this.controls.update();
    }
    this.last.copy(this.now);
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
    if (robot.camera) this.turn.set(...robot.camera.mount.rotation);
    else this.turn.identity();
    this.camera.quaternion.copy(this.heading).multiply(this.turn).multiply(LOOK_AHEAD);
    const [, vertical] = this.field(robot);
    if (this.camera.fov !== vertical) {
      this.camera.fov = vertical;
      this.camera.updateProjectionMatrix();
    }
  }

  /** Horizontal and vertical field of view, in degrees, that contain the field of view of a robot's camera. */
  private field(robot: Robot): [number, number] {
    const { horizontal_rad, vertical_rad } = robot.camera ?? { horizontal_rad: 1, vertical_rad: 0.8 };
    const tan = (angle: number) => Math.tan(Math.min(angle, 2.4) / 2);
    const up = Math.max(tan(vertical_rad), tan(horizontal_rad) / this.camera.aspect) * 1.04;
    return [(2 * Math.atan(up * this.camera.aspect) * 180) / Math.PI, (2 * Math.atan(up) * 180) / Math.PI];
  }

  /** Shares of the view's width and height that the robot's camera sees; null in other views or for a wide lens. */
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

function lookOf(from: THREE.Vector3, target: THREE.Vector3): Look {
  const way = from.clone().sub(target);
  const distance = way.length();
  const flat = Math.hypot(way.x, way.y);
  return { target: target.clone(), turn: flat > 0 ? Math.atan2(way.y, way.x) : -Math.PI / 2, tilt: Math.atan2(flat, way.z), distance };
}

const UP = new THREE.Vector3(0, 0, 1);
/** Rotation from the camera of three.js (looks along -z, y up) to the robot's (looks along x, z up). */
const LOOK_AHEAD = new THREE.Quaternion().setFromRotationMatrix(
  new THREE.Matrix4().makeBasis(new THREE.Vector3(0, -1, 0), new THREE.Vector3(0, 0, 1), new THREE.Vector3(-1, 0, 0)),
);
