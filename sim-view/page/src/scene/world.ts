// The scene that cameras see: world, floor, sky, light and the bodies' meshes, in the simulator's colours and light.

import * as THREE from "three";
import type { Scene } from "../protocol";
import type { Bodies, BodyView } from "./bodies";
import { GeometryMerger } from "./surface";

/** An instanced mesh, and the bodies that carry it: on the link with this index or, if it is null, on the body itself. */
interface InstanceGroup {
  mesh: THREE.InstancedMesh;
  bodies: BodyView[];
  link: number | null;
}

const WHITE = new THREE.Color(1, 1, 1);
const IDENTITY = new THREE.Matrix4();

export class World {
  readonly group = new THREE.Group();
  readonly walls = new THREE.Group();
  readonly robots = new THREE.Group();
  readonly objects = new THREE.Group();
  readonly surroundings = new THREE.Group();
  readonly sun = new THREE.DirectionalLight();
  /** The robot whose camera is shown, which does not see itself. */
  hidden: BodyView | null = null;
  private readonly instanceGroups: InstanceGroup[] = [];
  private readonly textures: THREE.Texture[] = [];
  private readonly materials: THREE.MeshLambertMaterial[] = [];
  private readonly disposables: { dispose(): void }[] = [];
  private hasTextures = true;

  /** `changed` is called when a texture has loaded. */
  constructor(
    private readonly scene: Scene,
    private readonly bodies: Bodies,
    private readonly changed: () => void,
  ) {
    this.group.add(this.walls, this.robots, this.objects, this.surroundings);
    this.addLight();
    this.addFloor();
    this.addSky();
    this.addFixed();
    this.addBodies();
  }

  /** Switches textures; without them a surface has its plain colour. */
  showTextures(isOn: boolean): void {
    this.hasTextures = isOn;
    for (const material of this.materials) this.applyTexture(material);
  }

  showShadows(isOn: boolean): void {
    this.sun.castShadow = isOn;
    for (const material of this.materials) material.needsUpdate = true;
  }

  /** Moves the meshes to the poses of their bodies. */
  update(): void {
    for (const { mesh, bodies, link } of this.instanceGroups) {
      const numbers = mesh.instanceMatrix.array;
      for (let i = 0; i < bodies.length; i++) write(numbers, 16 * i, bodies[i]!, bodies[i] !== this.hidden, link);
      mesh.instanceMatrix.needsUpdate = true;
    }
  }

  dispose(): void {
    this.group.removeFromParent();
    this.sun.dispose();
    for (const { mesh } of this.instanceGroups) mesh.dispose();
    for (const item of [...this.disposables, ...this.textures, ...this.materials]) item.dispose();
  }

  /** Adds the three lights of the simulator's cameras: ambient light, the sun, and a fill light from the opposite side. */
  private addLight(): void {
    const { ambient, diffuse } = this.scene.light;
    const towards = new THREE.Vector3(...this.scene.light.towards);
    const fill = new THREE.HemisphereLight(0xffffff, 0x000000, Math.PI * Math.max(0, 1 - ambient - diffuse));
    fill.position.set(-towards.x, -towards.y, towards.z);
    this.sun.intensity = Math.PI * diffuse;

    const [[left, low], [right, high]] = this.scene.bounds_m;
    const radius = 0.5 * Math.hypot(right - left, high - low) + 0.3;
    this.sun.target.position.set(0.5 * (left + right), 0.5 * (low + high), 0);
    this.sun.position.copy(this.sun.target.position).addScaledVector(towards, 2 * radius + 1);
    const { shadow } = this.sun;
    shadow.mapSize.set(2048, 2048);
    Object.assign(shadow.camera, { left: -radius, right: radius, bottom: -radius, top: radius, near: 0.5, far: 4 * radius + 2 });
    shadow.normalBias = radius / 250;
    shadow.bias = -0.001;
    this.group.add(new THREE.AmbientLight(0xffffff, Math.PI * ambient), fill, this.sun, this.sun.target);
  }

  /** Adds floor and ground. They write no depth and are drawn first, one over the other, which prevents z-fighting. */
  private addFloor(): void {
    const { ground } = this.scene;
    if (!ground) return;
    const [[left, low], [right, high]] = this.scene.bounds_m;
    const size = Math.hypot(right - left, high - low);
    const plain = this.flat(new THREE.CircleGeometry(60 * size, 64), ground.colour, null, -20);
    plain.position.set(0.5 * (left + right), 0.5 * (low + high), 0);
    this.surroundings.add(plain);
    if (ground.floor) {
      const [width, height] = ground.floor.size_m;
      const floor = this.flat(new THREE.PlaneGeometry(width, height), ground.floor.colour, ground.floor.image, -19);
      floor.position.set(width / 2, height / 2, 0);
      this.group.add(floor);
    }
    ground.spots.forEach((spot, i) => {
      const [r, g, b, opacity] = spot.colour;
      const disc = this.flat(new THREE.CircleGeometry(spot.radius_m, 48), [r, g, b], null, -18 + i / 1000);
      disc.material.transparent = true;
      disc.material.opacity = opacity / 255;
      disc.position.set(...spot.centre_m, 0);
      this.group.add(disc);
    });
  }

  private flat(
    geometry: THREE.BufferGeometry,
    [r, g, b]: [number, number, number],
    image: number | null,
    renderOrder: number,
  ): THREE.Mesh<THREE.BufferGeometry, THREE.MeshLambertMaterial> {
    const material = this.material(image);
    material.vertexColors = false;
    material.depthWrite = false;
    // An image on the floor has its own colours.
    material.userData["colour"] = new THREE.Color(r / 255, g / 255, b / 255);
    this.applyTexture(material);
    const mesh = new THREE.Mesh(geometry, material);
    mesh.receiveShadow = true;
    mesh.renderOrder = renderOrder;
    this.disposables.push(geometry);
    return mesh;
  }

  private addSky(): void {
    const colour = ([r, g, b]: [number, number, number]) => new THREE.Vector3(r, g, b).divideScalar(255);
    const material = new THREE.ShaderMaterial({
      side: THREE.BackSide,
      depthTest: false,
      depthWrite: false,
      uniforms: { horizon: { value: colour(this.scene.sky.horizon) }, zenith: { value: colour(this.scene.sky.zenith) } },
      vertexShader: `varying vec3 way; void main() { way = position; vec4 at = projectionMatrix * mat4(mat3(viewMatrix)) * vec4(position, 1.0); gl_Position = at.xyww; }`,
      fragmentShader: `uniform vec3 horizon, zenith; varying vec3 way; void main() { gl_FragColor = vec4(mix(horizon, zenith, clamp(normalize(way).z, 0.0, 1.0)), 1.0); }`,
    });
    const geometry = new THREE.SphereGeometry(1, 24, 16);
    const sky = new THREE.Mesh(geometry, material);
    sky.frustumCulled = false;
    sky.renderOrder = -30;
    this.disposables.push(geometry, material);
    this.surroundings.add(sky);
  }

  private addFixed(): void {
    const merger = new GeometryMerger();
    for (const { mesh, place } of this.scene.parts) {
      const surface = this.scene.meshes[mesh];
      if (place.on !== "world" || !surface) continue;
      const { position_m, rotation } = place.at;
      const at = new THREE.Matrix4().compose(
        new THREE.Vector3(...position_m),
        new THREE.Quaternion(...rotation),
        new THREE.Vector3(1, 1, 1),
      );
      merger.add(surface, at);
    }
    const gathered = merger.finish();
    if (!gathered) return;
    const mesh = new THREE.Mesh(gathered.geometry, gathered.images.map((image) => this.material(image)));
    mesh.castShadow = mesh.receiveShadow = true;
    this.disposables.push(gathered.geometry);
    this.walls.add(mesh);
  }

  /** Adds the bodies; bodies of equal appearance are drawn in one call. */
  private addBodies(): void {
    const looks = new Map<string, { body: BodyView; link: number | null; meshes: number[] }>();
    for (const part of this.scene.parts) {
      const { place } = part;
      if (place.on === "world") continue;
      const body = place.on === "object" ? this.bodies.object(place.object) : this.bodies.robot(place.robot);
      const link = place.on === "link" ? place.link : null;
      if (!body) continue;
      const key = `${body.what} ${body.id} ${link}`;
      const found = looks.get(key);
      if (found) found.meshes.push(part.mesh);
      else looks.set(key, { body, link, meshes: [part.mesh] });
    }
    const alike = new Map<string, { meshes: number[]; bodies: BodyView[]; link: number | null }>();
    for (const { body, link, meshes } of looks.values()) {
      const key = `${body.what} ${link} ${meshes.join(" ")}`;
      const found = alike.get(key);
      if (found) found.bodies.push(body);
      else alike.set(key, { meshes, bodies: [body], link });
    }
    for (const { meshes, bodies, link } of alike.values()) {
      const merger = new GeometryMerger();
      for (const mesh of meshes) if (this.scene.meshes[mesh]) merger.add(this.scene.meshes[mesh], IDENTITY);
      const gathered = merger.finish();
      if (!gathered) continue;
      const mesh = new THREE.InstancedMesh(
        gathered.geometry,
        gathered.images.map((image) => this.material(image)),
        bodies.length,
      );
      mesh.instanceMatrix.setUsage(THREE.DynamicDrawUsage);
      mesh.frustumCulled = false;
      mesh.castShadow = mesh.receiveShadow = true;
      this.disposables.push(gathered.geometry);
      this.instanceGroups.push({ mesh, bodies, link });
      (bodies[0]?.what === "robot" ? this.robots : this.objects).add(mesh);
    }
  }

  private material(image: number | null): THREE.MeshLambertMaterial {
    const material = new THREE.MeshLambertMaterial({ vertexColors: true, side: THREE.DoubleSide });
    material.userData["image"] = image;
    this.materials.push(material);
    this.applyTexture(material);
    return material;
  }

  private applyTexture(material: THREE.MeshLambertMaterial): void {
    const image = material.userData["image"] as number | null;
    material.map = image !== null && this.hasTextures ? this.texture(image) : null;
    const colour = material.userData["colour"] as THREE.Color | undefined;
    if (colour) material.color.copy(material.map ? WHITE : colour);
    material.needsUpdate = true;
  }

  private texture(image: number): THREE.Texture | null {
    const url = this.scene.images[image]?.url;
    if (url === undefined) return null;
    const texture = (this.textures[image] ??= new THREE.TextureLoader().load(url, this.changed));
    texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
    texture.anisotropy = 8;
    return texture;
  }
}

/** Writes the matrix of the frame of a body or one of its links; it has scale 0 if the body is not in the world or not visible. */
export function write(numbers: THREE.TypedArray, at: number, body: BodyView, isVisible = true, link: number | null = null): void {
  const frame = link === null ? undefined : body.frames[link];
  if (frame && body.isPresent && isVisible) return void frame.toArray(numbers as unknown as number[], at);
  if (frame) return void numbers.fill(0, at, at + 15);
  const size = body.isPresent && isVisible ? 1 : 0;
  const cos = size * Math.cos(body.pose.phi_rad);
  const sin = size * Math.sin(body.pose.phi_rad);
  numbers[at] = cos;
  numbers[at + 1] = sin;
  numbers[at + 4] = -sin;
  numbers[at + 5] = cos;
  numbers[at + 10] = size;
  numbers[at + 12] = body.pose.x_m;
  numbers[at + 13] = body.pose.y_m;
  numbers[at + 14] = body.posture.lift_m;
  numbers[at + 15] = 1;
}

