// Lines, triangles and points that are redrawn for each frame in the same memory.

import * as THREE from "three";

export type Colour = readonly [number, number, number];

type Kind = "lines" | "triangles" | "points";

export class Pen {
  readonly object: THREE.LineSegments | THREE.Mesh | THREE.Points;
  private positions = new Float32Array(0);
  private colours = new Float32Array(0);
  private used = 0;
  private readonly geometry = new THREE.BufferGeometry();
  private readonly material: THREE.Material;

  /** `size_px` is the size of points. */
  constructor(kind: Kind, options: { size_px?: number; depthTest?: boolean; renderOrder?: number } = {}) {
    const look = { vertexColors: true, transparent: true, depthWrite: false, depthTest: options.depthTest ?? true };
    if (kind === "lines") {
      this.material = new THREE.LineBasicMaterial(look);
      this.object = new THREE.LineSegments(this.geometry, this.material);
    } else if (kind === "triangles") {
      this.material = new THREE.MeshBasicMaterial({ ...look, side: THREE.DoubleSide, forceSinglePass: true });
      this.object = new THREE.Mesh(this.geometry, this.material);
    } else {
      const points = new THREE.PointsMaterial({ ...look, size: options.size_px ?? 6, sizeAttenuation: false });
      // Round, not square.
      points.onBeforeCompile = (shader) => {
        shader.fragmentShader = shader.fragmentShader.replace(
          "#include <color_fragment>",
          "#include <color_fragment>\nfloat off = 2.0 * length(gl_PointCoord - 0.5); if (off > 1.0) discard;",
        );
      };
      this.material = points;
      this.object = new THREE.Points(this.geometry, this.material);
    }
    this.object.frustumCulled = false;
    this.object.renderOrder = options.renderOrder ?? 0;
    this.reserve(64);
  }

  /** Clears the drawing. */
  begin(): void {
    this.used = 0;
  }

  /** Adds a vertex: position, colour and opacity. */
  to(x: number, y: number, z: number, colour: Colour, opacity: number): void {
    if (this.used === this.positions.length / 3) this.reserve(2 * this.used);
    const [at, of] = [3 * this.used, 4 * this.used];
    this.positions[at] = x;
    this.positions[at + 1] = y;
    this.positions[at + 2] = z;
    this.colours[of] = colour[0];
    this.colours[of + 1] = colour[1];
    this.colours[of + 2] = colour[2];
    this.colours[of + 3] = opacity;
    this.used++;
  }

  /** Shows what was drawn since `begin`. */
  end(): void {
    this.geometry.setDrawRange(0, this.used);
    for (const [name, size] of SIZES) {
      const attribute = this.geometry.getAttribute(name) as THREE.BufferAttribute;
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, size * this.used);
      attribute.needsUpdate = this.used > 0;
    }
    this.object.visible = this.used > 0;
  }

  dispose(): void {
    this.object.removeFromParent();
    this.geometry.dispose();
    this.material.dispose();
  }

  private reserve(corners: number): void {
    const [positions, colours] = [new Float32Array(3 * corners), new Float32Array(4 * corners)];
    positions.set(this.positions);
    colours.set(this.colours);
    this.positions = positions;
    this.colours = colours;
    // Frees the renderer's buffers of the old size.
    this.geometry.dispose();
    this.geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3).setUsage(THREE.DynamicDrawUsage));
    this.geometry.setAttribute("color", new THREE.BufferAttribute(colours, 4).setUsage(THREE.DynamicDrawUsage));
  }
}

const SIZES = [
  ["position", 3],
  ["color", 4],
] as const;
