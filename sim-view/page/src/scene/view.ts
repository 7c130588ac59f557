// The 3D view: displays the model's scene and keeps it up to date.

import * as THREE from "three";
import { element } from "../dom";
import type { Model } from "../model";
import { shortcut } from "../panel/keyboard";
import { Beams } from "./beam";
import { Bodies } from "./bodies";
import { ViewCamera, type Mode } from "./camera";
import { Guides } from "./guide";
import { DragControl } from "./drag";
import { EventEffects } from "./effect";
import { layerList, type Layer } from "./layer";
import { Marks } from "./marks";
import { ProgramLayers } from "./program";
import { Trails, trailsBefore } from "./trail";
import { World } from "./world";

// Colours are mixed as in the simulator's cameras: without conversion of colour spaces.
THREE.ColorManagement.enabled = false;

/** Number of frames, and the times of the page's own code in the last frame, for measurements. */
export interface FrameTimes {
  frames: number;
  /** Time for updating poses and buffers. */
  update_ms: number;
  /** Time for passing them to the graphics card. */
  render_ms: number;
}

export class View {
  readonly element = element("section", { className: "scene", testid: "scene", label: "3D view" });
  readonly times: FrameTimes = { frames: 0, update_ms: 0, render_ms: 0 };
  readonly bodies: Bodies;
  private readonly scene = new THREE.Scene();
  /** Overlays that cameras do not see. */
  private readonly added = new THREE.Group();
  private readonly marks: Marks;
  private readonly trails: Trails;
  private readonly beams: Beams;
  private readonly effects: EventEffects;
  private readonly guides = new Guides();
  private readonly program: ProgramLayers;
  private readonly frame = element("div", { className: "camera-frame" });
  private readonly layers: Layer[];
  private readonly reduced = matchMedia("(prefers-reduced-motion: reduce)");
  private readonly dark = matchMedia("(prefers-color-scheme: dark)");
  private readonly renderer: THREE.WebGLRenderer;
  private readonly canvas: HTMLCanvasElement;
  private readonly modes = new Map<Mode, HTMLButtonElement>();
  private world: World | null = null;
  private viewCamera: ViewCamera | null = null;
  private size: { width: number; height: number } = { width: 1, height: 1 };
  private lastTitle = "";
  private lastRun = 0;
  private last_ms = 0;
  private isStale = true;
  private isMoved = true;

  /** Throws if there is no WebGL. */
  constructor(private readonly model: Model) {
    this.bodies = new Bodies(model);
    this.marks = new Marks(model, this.bodies);
    this.trails = new Trails(this.bodies, async () => (model.player ? null : trailsBefore()));
    this.beams = new Beams(model, this.bodies);
    this.effects = new EventEffects(model, this.bodies);
    this.program = new ProgramLayers(model);
    this.canvas = element("canvas", { testid: "canvas", tabIndex: 0 });
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", "The world in 3D. Keys are listed in the help.");
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: true, powerPreference: "high-performance" });
    this.renderer.outputColorSpace = THREE.LinearSRGBColorSpace;
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = THREE.PCFShadowMap;
    this.renderer.shadowMap.autoUpdate = false;

    const { marks, beams, effects, guides } = this;
    this.added.add(marks.rings, marks.labels, marks.selection, marks.ghost, this.trails.group);
    this.added.add(beams.beams, beams.scan, beams.frusta, effects.radio, effects.contacts, guides.grid, guides.axes, this.program.group);
    this.scene.add(this.added);
    this.layers = this.allLayers();
    const stale = () => void (this.isStale = true);
    new DragControl(model, this.bodies, marks, this.canvas, () => this.viewCamera!, stale);
    this.viewCamera = new ViewCamera(model, this.bodies, this.canvas, () => this.reduced.matches);
    this.viewCamera.onchange = () => this.showCamera();
    const list = layerList(this.layers, stale);
    this.element.append(this.canvas, this.frame, this.buttons(), list, guides.bar);

    new ResizeObserver(() => this.resize()).observe(this.element);
    this.dark.addEventListener("change", () => this.showScheme());
    this.listen();
    model.screenshot = () => this.screenshot();
    this.showScheme();
    requestAnimationFrame((now) => this.tick(now));
  }

  /** The current view as a PNG. */
  private screenshot(): Promise<Blob> {
    this.draw();
    return new Promise((done, fail) =>
      this.canvas.toBlob((blob) => (blob ? done(blob) : fail(new Error("the browser made no image"))), "image/png"),
    );
  }

  /** Draw calls and triangles of the last frame. */
  get drawn(): { calls: number; triangles: number } {
    return this.renderer.info.render;
  }

  /** Numbers of resources on the graphics card. */
  get memory(): { geometries: number; textures: number } {
    return this.renderer.info.memory;
  }

  /** Position on the page, in its pixels, of a point of the world. */
  where(x_m: number, y_m: number, z_m: number): { x: number; y: number } {
    const at = new THREE.Vector3(x_m, y_m, z_m).project(this.viewCamera!.camera);
    const box = this.canvas.getBoundingClientRect();
    return { x: box.left + (0.5 + 0.5 * at.x) * box.width, y: box.top + (0.5 - 0.5 * at.y) * box.height };
  }

  private listen(): void {
    const { model } = this;
    const stale = () => void (this.isStale = true);
    // After a reconnection, a run with the same number may be another one.
    model.subscribe("welcome", () => void (this.lastRun = 0));
    model.subscribe("scene", () => this.rebuild());
    model.subscribe("snapshot", () => {
      this.bodies.mark();
      this.marks.paint();
      this.beams.takeBeams();
      stale();
    });
    const detail = () => {
      this.beams.takeScan();
      this.marks.takeOdometry();
      stale();
    };
    const program = () => {
      this.program.take();
      stale();
    };
    model.subscribe("detail", detail);
    model.subscribe("chosen", detail);
    model.subscribe("layer", program);
    model.subscribe("chosen", program);
    model.subscribe("selected", stale);
    model.subscribe("player", () => {
      if (model.player) this.trails.takeRecording(model.player.events);
      stale();
    });
    this.effects.onplaced = (robot, t_s) => {
      if (!model.player) this.trails.interrupt(robot, Math.max(t_s, model.snapshot?.t_s ?? 0));
    };
    model.subscribe("events", () => {
      this.effects.takeEvents();
      stale();
    });
    model.subscribe("centre", () => {
      const body = this.bodies.robot(model.centred);
      if (body?.isPresent) this.viewCamera?.centre(body);
    });
  }

  /** Rebuilds the view for the model's scene, and frees the resources of the previous one. */
  private rebuild(): void {
    const { scene } = this.model;
    this.world?.dispose();
    this.world = null;
    if (!scene) return;
    this.bodies.rebuild();
    this.world = new World(scene, this.bodies, () => (this.isStale = true));
    this.scene.add(this.world.group);
    this.marks.rebuild();
    this.trails.rebuild();
    void this.trails.join(scene.run);
    if (this.lastRun !== scene.run) {
      this.marks.restart();
      this.trails.restart();
    }
    this.lastRun = scene.run;
    this.beams.rebuild();
    this.effects.rebuild();
    this.guides.rebuild(scene);
    for (const layer of this.layers) layer.show(layer.isOn);
    // The view is kept if the same world is shown again.
    if (this.lastTitle !== scene.title) this.viewCamera?.fit(scene);
    this.lastTitle = scene.title;
    this.isStale = this.isMoved = true;
  }

  private tick(now_ms: number): void {
    requestAnimationFrame((next) => this.tick(next));
    this.show(now_ms);
  }

  /** Draws a frame at an instant of real time, if anything has changed. */
  show(now_ms: number): void {
    const passed_ms = Math.min(250, now_ms - this.last_ms);
    this.last_ms = now_ms;
    const began = performance.now();
    const { clock } = this.model;
    clock.tick(now_ms);
    if (!this.world || !this.viewCamera) return;
    if (this.bodies.update(clock.t_s)) this.isMoved = this.isStale = true;
    this.trails.update(clock.t_s);
    this.viewCamera.update(passed_ms);
    const { width, height } = this.size;
    const isHappening = this.effects.update(passed_ms, this.reduced.matches, width, height);
    if (!this.isStale && !isHappening) return;
    this.isStale = false;
    this.world.hidden = this.viewCamera.robot;
    // A robot's camera always sees sky and ground, and no overlays.
    this.world.surroundings.visible = this.viewCamera.mode === "robot" || this.isOn("surroundings");
    this.added.visible = this.viewCamera.mode !== "robot";
    this.world.update();
    this.marks.update(width, height, this.viewCamera.robot);
    this.beams.update();
    this.guides.update(this.viewCamera.px_per_m, width, height);
    const updated = performance.now();
    this.draw();
    this.times.frames++;
    this.times.update_ms = updated - began;
    this.times.render_ms = performance.now() - updated;
  }

  private draw(): void {
    if (!this.viewCamera) return;
    if (this.isMoved) this.renderer.shadowMap.needsUpdate = true;
    this.isMoved = false;
    this.renderer.render(this.scene, this.viewCamera.camera);
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (width === 0 || height === 0) return;
    this.size = { width, height };
    this.element.style.setProperty("--height", `${height}px`);
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.renderer.setSize(width, height, false);
    this.viewCamera?.resize();
    this.showCamera();
    // Resizing has cleared the canvas.
    this.draw();
  }

  private showScheme(): void {
    this.renderer.setClearColor(new THREE.Color(this.dark.matches ? "#14181a" : "#e9eeee"));
    this.isStale = true;
  }

  private showCamera(): void {
    const viewCamera = this.viewCamera;
    if (!viewCamera) return;
    this.isStale = true;
    for (const [mode, button] of this.modes) button.ariaPressed = String(viewCamera.mode === mode);
    const frame = viewCamera.frame();
    this.frame.hidden = frame === null;
    if (frame) {
      this.frame.style.width = `${100 * frame[0]}%`;
      this.frame.style.height = `${100 * frame[1]}%`;
    }
    this.guides.bar.hidden = viewCamera.mode === "robot";
  }

  private isOn(id: string): boolean {
    return this.layers.some((layer) => layer.id === id && layer.isOn);
  }

  private buttons(): HTMLElement {
    const toggle = (mode: Mode) => () => this.viewCamera?.setMode(this.viewCamera.mode === mode ? "free" : mode);
    const button = (text: string, testid: string, key: string, what: string, run: () => void, mode?: Mode) => {
      shortcut(key, what, run);
      const node = element("button", { type: "button", textContent: text, testid, title: `${what} (${key})`, onclick: run });
      if (mode) this.modes.set(mode, node);
      return node;
    };
    return element("div", { className: "eyes", role: "toolbar", label: "View" }, [
      button("Home", "view-home", "h", "The whole world", () => this.viewCamera?.home()),
      button("Top", "view-top", "t", "From above", () => this.viewCamera?.top()),
      button("Follow", "view-follow", "f", "Follow the chosen robot", toggle("follow"), "follow"),
      button("Robot’s view", "view-robot", "v", "Through the camera of the chosen robot", toggle("robot"), "robot"),
    ]);
  }

  private allLayers(): Layer[] {
    const { marks, beams, effects, guides } = this;
    const layer = (id: string, name: string, isOn: boolean, show: (isOn: boolean) => void) => ({ id, name, isOn, show });
    const group = (id: string, name: string, isOn: boolean, ...groups: THREE.Object3D[]) =>
      layer(id, name, isOn, (on) => groups.forEach((one) => (one.visible = on)));
    const part = (id: string, name: string, pick: (world: World) => THREE.Object3D, isOn = true) =>
      layer(id, name, isOn, (on) => {
        if (this.world) pick(this.world).visible = on;
        this.isMoved = true;
      });
    return [
      part("walls", "Walls", (world) => world.walls),
      layer("textures", "Textures", true, (on) => this.world?.showTextures(on)),
      part("robots", "Robots", (world) => world.robots),
      part("objects", "Objects", (world) => world.objects),
      part("surroundings", "Sky and ground", (world) => world.surroundings, false),
      layer("shadows", "Shadows", true, (on) => {
        this.world?.showShadows(on);
        this.isMoved = true;
      }),
      group("rings", "Rings", true, marks.rings),
      group("labels", "Labels", true, marks.labels),
      group("trails", "Trails", true, this.trails.group),
      group("beams", "Beams", true, beams.beams),
      group("scan", "Laser scan", true, beams.scan),
      group("program", "Program’s map", true, this.program.group),
      group("frusta", "Camera views", false, beams.frusta),
      group("radio", "Radio", true, effects.radio),
      group("contacts", "Contacts", true, effects.contacts),
      group("odometry", "Odometry", false, marks.ghost),
      group("axes", "Axes", false, guides.axes),
      layer("grid", "Grid and scale", true, (on) => {
        guides.grid.visible = on;
        guides.bar.classList.toggle("off", !on);
      }),
    ];
  }
}

/** The 3D view or, without WebGL, a message instead. */
export function sceneView(model: Model): { element: HTMLElement; view: View | null } {
  try {
    const view = new View(model);
    return { element: view.element, view };
  } catch (error) {
    const why = error instanceof Error ? error.message : String(error);
    const text = `The 3D view needs WebGL, which this browser does not offer (${why}). Everything else works.`;
    return { element: element("p", { className: "no-scene", role: "alert", testid: "no-webgl", textContent: text }), view: null };
  }
}
