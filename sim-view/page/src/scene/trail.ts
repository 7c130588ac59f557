// Where robots have been: ribbons on the floor, of bounded length.

import * as THREE from "three";
import type { Bodies, Shown } from "./bodies";

/** Pieces of ribbon of all robots together, and at most of one. */
const MAX_PIECES = 60_000;
const MAX_PIECES_EACH = 1500;
/** A robot that has come farther than this many of its radii, and is faster than this, was put there: the ribbon is torn. */
const LEAP = 4;
const FASTEST_M_PER_S = 3;

export class Trails {
  readonly group = new THREE.Group();
  private mesh: THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial> | null = null;
  private each = 0;
  private next = new Int32Array(0);
  private last = new Float64Array(0);
  private since = new Float64Array(0);
  private t_s = 0;
  private hasChanged = false;

  constructor(private readonly bodies: Bodies) {}

  rebuild(): void {
    this.clear();
    const { robots } = this.bodies;
    if (robots.length === 0) return;
    this.each = Math.max(50, Math.min(MAX_PIECES_EACH, Math.floor(MAX_PIECES / robots.length)));
    this.next = new Int32Array(robots.length);
    this.last = new Float64Array(2 * robots.length).fill(NaN);
    this.since = new Float64Array(robots.length);
    const pieces = this.each * robots.length;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(12 * pieces), 3));
    const colours = new Float32Array(12 * pieces);
    robots.forEach(({ colour }, i) => {
      for (let corner = 4 * i * this.each; corner < 4 * (i + 1) * this.each; corner++) colours.set(colour, 3 * corner);
    });
    geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
    const index = new Uint32Array(6 * pieces);
    for (let i = 0; i < pieces; i++) {
      for (let k = 0; k < 6; k++) index[6 * i + k] = 4 * i + CORNERS[k]!;
    }
    geometry.setIndex(new THREE.BufferAttribute(index, 1));
    const material = new THREE.MeshBasicMaterial({
      vertexColors: true,
      transparent: true,
      opacity: 0.55,
      depthWrite: false,
      side: THREE.DoubleSide,
    });
    this.mesh = new THREE.Mesh(geometry, material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 1;
    this.group.add(this.mesh);
  }

  /** Lengthens the ribbons of robots that have moved; a time that goes back begins them anew. */
  update(t_s: number): void {
    if (t_s < this.t_s) this.rebuild();
    this.t_s = t_s;
    if (!this.mesh) return;
    const { robots } = this.bodies;
    for (let i = 0; i < robots.length; i++) this.follow(robots[i]!, i);
    if (!this.hasChanged) return;
    this.hasChanged = false;
    this.mesh.geometry.getAttribute("position").needsUpdate = true;
  }

  clear(): void {
    this.mesh?.removeFromParent();
    this.mesh?.geometry.dispose();
    this.mesh?.material.dispose();
    this.mesh = null;
  }

  private follow(body: Shown, i: number): void {
    const { x_m, y_m } = body.pose;
    const [fromX, fromY] = [this.last[2 * i]!, this.last[2 * i + 1]!];
    const radius = body.extent.radius_m;
    const way = Math.hypot(x_m - fromX, y_m - fromY);
    if (way < 0.2 * radius) return;
    const reach = LEAP * radius + FASTEST_M_PER_S * (this.t_s - this.since[i]!);
    this.since[i] = this.t_s;
    if (!body.isThere || body.held || !(way < reach)) {
      this.last[2 * i] = body.isThere && !body.held ? x_m : NaN;
      this.last[2 * i + 1] = y_m;
      return;
    }
    const half = (0.12 * radius) / way;
    const [acrossX, acrossY] = [-(y_m - fromY) * half, (x_m - fromX) * half];
    const attribute = this.mesh!.geometry.getAttribute("position") as THREE.BufferAttribute;
    const piece = i * this.each + this.next[i]!;
    const numbers = attribute.array;
    const at = 12 * piece;
    numbers[at] = fromX + acrossX;
    numbers[at + 1] = fromY + acrossY;
    numbers[at + 3] = fromX - acrossX;
    numbers[at + 4] = fromY - acrossY;
    numbers[at + 6] = x_m - acrossX;
    numbers[at + 7] = y_m - acrossY;
    numbers[at + 9] = x_m + acrossX;
    numbers[at + 10] = y_m + acrossY;
    if (!this.hasChanged) attribute.clearUpdateRanges();
    this.hasChanged = true;
    attribute.addUpdateRange(at, 12);
    this.next[i] = (this.next[i]! + 1) % this.each;
    this.last[2 * i] = x_m;
    this.last[2 * i + 1] = y_m;
  }
}

const CORNERS = [0, 1, 2, 0, 2, 3] as const;
