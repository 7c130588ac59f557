// Layers that the program of the chosen robot shows: grids on the floor, points and lines.

import * as THREE from "three";
import type { Model } from "../model";
import type { Layer } from "../protocol";
import { Pen, type Colour } from "./pen";
import { bytes, floats } from "./surface";

const FREE: Colour = [0.72, 0.88, 0.78];
const OCCUPIED: Colour = [0.05, 0.16, 0.42];
const UNKNOWN = 255;
const POINTS: Colour = [0.85, 0.1, 0.55];
const LINE: Colour = [0.55, 0.15, 0.85];
/** Height of grids above the floor, below all other marks. */
const LIFT_M = 0.002;

interface Drawn {
  layer: Layer;
  object: THREE.Object3D;
  dispose: () => void;
}

export class ProgramLayers {
  readonly group = new THREE.Group();
  private drawn = new Map<string, Drawn>();

  constructor(private readonly model: Model) {}

  /** Draws the layers of the chosen robot that have changed, and removes those of others. */
  take(): void {
    const layers = this.model.layers.get(this.model.chosen ?? -1) ?? new Map<string, Layer>();
    for (const [name, { layer, object, dispose }] of this.drawn) {
      if (layers.get(name) === layer) continue;
      object.removeFromParent();
      dispose();
      this.drawn.delete(name);
    }
    for (const [name, layer] of layers) {
      if (this.drawn.has(name)) continue;
      const drawn = draw(layer);
      drawn.object.position.set(layer.frame.x_m, layer.frame.y_m, 0);
      drawn.object.rotation.z = layer.frame.phi_rad;
      this.group.add(drawn.object);
      this.drawn.set(name, { layer, ...drawn });
    }
  }
}

function draw(layer: Layer): Omit<Drawn, "layer"> {
  const { content } = layer;
  if (content.kind === "grid") return grid(content);
  const positions = floats(content.positions);
  const isLine = content.kind === "line";
  const pen = new Pen(isLine ? "lines" : "points", { size_px: 5, depthTest: false, renderOrder: 8 });
  const to = (k: number) => pen.to(positions[k]!, positions[k + 1]!, positions[k + 2]!, isLine ? LINE : POINTS, 0.9);
  pen.begin();
  for (let k = isLine ? 3 : 0; k < positions.length; k += 3) {
    if (isLine) to(k - 3);
    to(k);
  }
  pen.end();
  return { object: pen.object, dispose: () => pen.dispose() };
}

function grid(content: Extract<Layer["content"], { kind: "grid" }>): Omit<Drawn, "layer"> {
  const { columns, rows, cell_m, corner_m } = content;
  const texture = new THREE.DataTexture(colours(bytes(content.cells)), columns, rows, THREE.RGBAFormat);
  // Cells are squares, not blurred.
  texture.magFilter = texture.minFilter = THREE.NearestFilter;
  texture.needsUpdate = true;
  const [width, height] = [columns * cell_m, rows * cell_m];
  const geometry = new THREE.PlaneGeometry(width, height).translate(corner_m[0] + width / 2, corner_m[1] + height / 2, LIFT_M);
  const material = new THREE.MeshBasicMaterial({ map: texture, transparent: true, depthWrite: false });
  // The floor must not flicker through from far away.
  Object.assign(material, { polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -1 });
  const object = new THREE.Mesh(geometry, material);
  object.renderOrder = 1;
  const dispose = () => [geometry, material, texture].forEach((one) => one.dispose());
  return { object, dispose };
}

/** Colours of cells, red, green, blue and opacity: undecided cells are faint, unknown ones are left out. */
function colours(cells: Uint8Array): Uint8Array {
  const pixels = new Uint8Array(4 * cells.length);
  cells.forEach((cell, at) => {
    if (cell === UNKNOWN) return;
    const occupied = Math.min(1, cell / 100);
    const sure = Math.abs(2 * occupied - 1);
    for (let part = 0; part < 3; part++)
      pixels[4 * at + part] = 255 * (FREE[part]! + occupied * (OCCUPIED[part]! - FREE[part]!));
    pixels[4 * at + 3] = 255 * (0.15 + 0.65 * sure);
  });
  return pixels;
}
