// Converts the protocol's meshes to geometries: vertex colours, and one group for each texture.

import * as THREE from "three";
import type { Material, Mesh } from "../protocol";

/** Attributes of the triangle corners that share an image, or have none. */
interface Batch {
  positions: number[];
  normals: number[];
  uvs: number[];
  colours: number[];
}

/** Merges meshes into one geometry with a group for each image. */
export class GeometryMerger {
  private readonly batches = new Map<number | null, Batch>();
  private readonly at = new THREE.Vector3();

  /** Adds a mesh, transformed by a matrix. */
  add(mesh: Mesh, matrix: THREE.Matrix4): void {
    const positions = floats(mesh.positions);
    const normals = mesh.normals === null ? null : floats(mesh.normals);
    const uvs = mesh.uvs === null ? null : floats(mesh.uvs);
    const turn = new THREE.Matrix3().getNormalMatrix(matrix);
    const face = new THREE.Vector3();
    const [a, b] = [new THREE.Vector3(), new THREE.Vector3()];
    let corner = 0;
    for (const material of mesh.materials) {
      const batch = this.batch(material);
      const end = Math.min(corner + 3 * material.triangles, positions.length / 3);
      for (; corner < end; corner++) {
        if (!normals && corner % 3 === 0) {
          const first = this.at.fromArray(positions, 3 * corner);
          a.fromArray(positions, 3 * corner + 3).sub(first);
          b.fromArray(positions, 3 * corner + 6).sub(first);
          face.crossVectors(a, b).normalize();
        }
        const normal = normals ? a.fromArray(normals, 3 * corner) : a.copy(face);
        normal.applyMatrix3(turn).normalize();
        this.at.fromArray(positions, 3 * corner).applyMatrix4(matrix);
        batch.positions.push(this.at.x, this.at.y, this.at.z);
        batch.normals.push(normal.x, normal.y, normal.z);
        batch.uvs.push(uvs?.[2 * corner] ?? 0, uvs?.[2 * corner + 1] ?? 0);
        for (const part of material.colour) batch.colours.push(part / 255);
      }
    }
  }

  /** One geometry with a group for each image, and the images in the order of the groups; null if nothing was added. */
  finish(): { geometry: THREE.BufferGeometry; images: (number | null)[] } | null {
    const batches = [...this.batches.values()];
    const geometry = new THREE.BufferGeometry();
    const attribute = (name: string, size: number, key: keyof Batch) => {
      const numbers = new Float32Array(batches.reduce((sum, batch) => sum + batch[key].length, 0));
      let start = 0;
      for (const batch of batches) {
        numbers.set(batch[key], start);
        start += batch[key].length;
      }
      geometry.setAttribute(name, new THREE.BufferAttribute(numbers, size));
    };
    attribute("position", 3, "positions");
    attribute("normal", 3, "normals");
    attribute("color", 3, "colours");
    if ([...this.batches.keys()].some((image) => image !== null)) attribute("uv", 2, "uvs");
    let start = 0;
    batches.forEach((batch, i) => {
      geometry.addGroup(start, batch.positions.length / 3, i);
      start += batch.positions.length / 3;
    });
    if (start === 0) return null;
    geometry.computeBoundingSphere();
    return { geometry, images: [...this.batches.keys()] };
  }

  private batch(material: Material): Batch {
    let batch = this.batches.get(material.image);
    if (!batch) this.batches.set(material.image, (batch = { positions: [], normals: [], uvs: [], colours: [] }));
    return batch;
  }
}

/** Decodes bytes from base64. */
export function bytes(base64: string): Uint8Array {
  const text = atob(base64);
  const bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  return bytes;
}

/** Decodes 32-bit little-endian floats from base64. */
export function floats(base64: string): Float32Array {
  const view = new DataView(bytes(base64).buffer);
  const numbers = new Float32Array(Math.floor(view.byteLength / 4));
  for (let i = 0; i < numbers.length; i++) numbers[i] = view.getFloat32(4 * i, true);
  return numbers;
}
