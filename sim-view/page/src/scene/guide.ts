// Guides for lengths and directions: grid, axes, scale bar.

import * as THREE from "three";
import { element } from "../dom";
import type { Scene } from "../protocol";
import { Pen, type Colour } from "./pen";
import { Sprites } from "./sprite";

const GRID: Colour = [0.35, 0.4, 0.42];
const AXES: readonly Colour[] = [
  [0.88, 0.2, 0.18],
  [0.15, 0.6, 0.25],
  [0.2, 0.4, 0.95],
];

export class Guides {
  readonly grid = new THREE.Group();
  readonly axes = new THREE.Group();
  /** Scale bar in a corner of the view. */
  readonly bar = element("output", { className: "scale-bar number", testid: "scale-bar", label: "Scale" });
  private readonly gridPen = new Pen("lines", { renderOrder: -1 });
  private readonly axesPen = new Pen("lines", { renderOrder: 11, depthTest: false });
  private readonly names = new Sprites(
    ["x", "y", "z"].map((text, i) => ({ text, plate: null, colour: ["#e0332e", "#1d8a3c", "#3565f0"][i]! })),
    0,
    22,
  );
  private length_m = 1;
  private shown = "";

  constructor() {
    this.grid.add(this.gridPen.object);
    this.axes.add(this.axesPen.object, this.names.mesh);
  }

  rebuild(scene: Scene): void {
    const [[left, low], [right, high]] = scene.bounds_m;
    const size = Math.max(right - left, high - low);
    const step = round(size / 16);
    this.length_m = 0.12 * size;
    this.gridPen.begin();
    const line = (x0: number, y0: number, x1: number, y1: number, i: number) => {
      const opacity = i % 5 === 0 ? 0.45 : 0.18;
      this.gridPen.to(x0, y0, 0, GRID, opacity);
      this.gridPen.to(x1, y1, 0, GRID, opacity);
    };
    const [i0, i1] = [Math.ceil(left / step - 1e-9), Math.floor(right / step + 1e-9)];
    const [k0, k1] = [Math.ceil(low / step - 1e-9), Math.floor(high / step + 1e-9)];
    for (let i = i0; i <= i1; i++) line(i * step, low, i * step, high, i);
    for (let k = k0; k <= k1; k++) line(left, k * step, right, k * step, k);
    this.gridPen.end();

    this.axesPen.begin();
    AXES.forEach((colour, axis) => {
      const tip = [0, 0, 0];
      tip[axis] = this.length_m;
      this.axesPen.to(0, 0, 0, colour, 1);
      this.axesPen.to(tip[0]!, tip[1]!, tip[2]!, colour, 1);
      for (const side of [-1, 1]) {
        const back = [...tip];
        back[axis] = 0.85 * this.length_m;
        back[(axis + 1) % 3] = 0.06 * side * this.length_m;
        this.axesPen.to(tip[0]!, tip[1]!, tip[2]!, colour, 1);
        this.axesPen.to(back[0]!, back[1]!, back[2]!, colour, 1);
      }
      tip[axis]! *= 1.2;
      this.names.put(axis, tip[0]!, tip[1]!, tip[2]!, 1);
    });
    this.axesPen.end();
  }

  /** Fits the scale bar to the pixels per metre at the centre of the view. */
  update(px_per_m: number, width_px: number, height_px: number): void {
    this.names.end(width_px, height_px);
    const length_m = round(110 / px_per_m);
    const width = `${Math.round(length_m * px_per_m)}px`;
    const text = length_m >= 1 ? `${length_m} m` : length_m >= 0.01 ? `${+(100 * length_m).toFixed(1)} cm` : `${+(1000 * length_m).toFixed(2)} mm`;
    if (this.shown === text + width) return;
    this.shown = text + width;
    this.bar.style.width = width;
    this.bar.textContent = text;
  }

  dispose(): void {
    for (const pen of [this.gridPen, this.axesPen]) pen.dispose();
    this.names.dispose();
  }
}

/** The largest 1, 2 or 5 times a power of ten that is not greater. */
function round(length: number): number {
  const power = 10 ** Math.floor(Math.log10(length));
  const digit = length / power;
  return +((digit >= 5 ? 5 : digit >= 2 ? 2 : 1) * power).toPrecision(3);
}
