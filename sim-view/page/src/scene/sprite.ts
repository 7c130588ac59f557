// Short texts that face the camera at a constant size: one draw call for all.

import * as THREE from "three";

const CELL = { width: 96, height: 40 };
const COLUMNS = 16;
const HEIGHT_PX = 20;

export interface Text {
  text: string;
  /** Colour of the plate behind the text; null for no plate. */
  plate: string | null;
  colour: string;
}

/** Texts at positions that can change. */
export class Sprites {
  readonly mesh: THREE.Mesh<THREE.InstancedBufferGeometry, THREE.ShaderMaterial>;
  private readonly positions: THREE.InstancedBufferAttribute;

  /** Each text is drawn `lift_px` pixels above its position. */
  constructor(texts: readonly Text[], lift_px: number, renderOrder = 20) {
    const rows = Math.max(1, Math.ceil(texts.length / COLUMNS));
    const canvas = document.createElement("canvas");
    canvas.width = COLUMNS * CELL.width;
    canvas.height = rows * CELL.height;
    const context = canvas.getContext("2d");
    const widths = texts.map((text, i) => (context ? draw(context, text, i) : CELL.width));
    const atlas = new THREE.CanvasTexture(canvas);
    atlas.generateMipmaps = false;
    atlas.minFilter = THREE.LinearFilter;

    const geometry = new THREE.InstancedBufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0], 3));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    this.positions = new THREE.InstancedBufferAttribute(new Float32Array(4 * texts.length), 4);
    this.positions.setUsage(THREE.DynamicDrawUsage);
    geometry.setAttribute("place", this.positions);
    const cells = new Float32Array(texts.flatMap((_, i) => [i % COLUMNS, Math.floor(i / COLUMNS), widths[i]! / CELL.width]));
    geometry.setAttribute("cell", new THREE.InstancedBufferAttribute(cells, 3));
    geometry.instanceCount = texts.length;
    const material = new THREE.ShaderMaterial({
      transparent: true,
      depthTest: false,
      depthWrite: false,
      uniforms: {
        atlas: { value: atlas },
        grid: { value: new THREE.Vector2(COLUMNS, rows) },
        size: { value: new THREE.Vector2(CELL.width / CELL.height, 1).multiplyScalar(HEIGHT_PX) },
        screen: { value: new THREE.Vector2(1, 1) },
        lift: { value: 2 * lift_px },
      },
      // place.w is the scale; 0 hides the text.
      vertexShader: `
        attribute vec4 place; attribute vec3 cell; varying vec2 at;
        uniform vec2 grid, size, screen; uniform float lift;
        void main() {
          at = (cell.xy + vec2(0.5 + 0.5 * position.x * cell.z, 0.5 - 0.5 * position.y)) / grid;
          at.y = 1.0 - at.y;
          gl_Position = projectionMatrix * viewMatrix * vec4(place.xyz, 1.0);
          gl_Position.xy += (position.xy * vec2(cell.z, 1.0) * size + vec2(0.0, lift)) * place.w / screen * gl_Position.w;
        }`,
      fragmentShader: `uniform sampler2D atlas; varying vec2 at; void main() { gl_FragColor = texture2D(atlas, at); if (gl_FragColor.a < 0.02) discard; }`,
    });
    this.mesh = new THREE.Mesh(geometry, material);
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = renderOrder;
  }

  /** Positions a text; size 0 hides it. */
  put(text: number, x: number, y: number, z: number, size: number): void {
    this.positions.setXYZW(text, x, y, z, size);
  }

  /** Uploads the positions, for a view of this size. */
  end(width_px: number, height_px: number): void {
    this.positions.needsUpdate = true;
    (this.mesh.material.uniforms["screen"]!.value as THREE.Vector2).set(width_px, height_px);
  }

  dispose(): void {
    this.mesh.removeFromParent();
    (this.mesh.material.uniforms["atlas"]!.value as THREE.Texture).dispose();
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}

/** Draws a text into its cell; returns its width. */
function draw(context: CanvasRenderingContext2D, { text, plate, colour }: Text, cell: number): number {
  const x = (cell % COLUMNS) * CELL.width;
  const top = Math.floor(cell / COLUMNS) * CELL.height;
  context.font = `600 25px system-ui, "DejaVu Sans", sans-serif`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  const width = Math.min(CELL.width, Math.max(CELL.height, context.measureText(text).width + 20));
  if (plate !== null) {
    context.beginPath();
    context.roundRect(x + 0.5 * (CELL.width - width) + 2, top + 2, width - 4, CELL.height - 4, 0.5 * CELL.height - 2);
    context.fillStyle = plate;
    context.fill();
    context.lineWidth = 2.5;
    context.strokeStyle = "rgb(255 255 255 / 90%)";
    context.stroke();
  }
  context.fillStyle = colour;
  context.fillText(text, x + 0.5 * CELL.width, top + 0.54 * CELL.height, CELL.width - 12);
  return width;
}

/** Text colour that is legible on a plate of this colour (red, green, blue from 0 to 1). */
export function inkOn([r, g, b]: readonly [number, number, number]): string {
  return 0.299 * r + 0.587 * g + 0.114 * b > 0.6 ? "#10181a" : "#ffffff";
}
