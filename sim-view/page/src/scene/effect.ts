// Short-lived events: messages in flight with their outcome, and contacts.

import * as THREE from "three";
import type { Model } from "../model";
import type { Event } from "../protocol";
import type { Bodies } from "./bodies";
import { Pen, type Colour } from "./pen";
import { Sprites } from "./sprite";

/**
 * Real time for which a message is shown in flight, and for which it is visible in total; both are independent of its simulated time of
 * flight.
 */
const FLIGHT_MS = 550;
const SHOWN_MS = 1200;
const CONTACT_MS = 900;
const MAX_FLIGHTS = 200;
const MAX_CONTACTS = 64;

const AIR: Colour = [0.25, 0.55, 1];
const ARRIVED: Colour = [0.15, 0.75, 0.35];
const DAMAGED: Colour = [0.95, 0.65, 0.1];
const LOST: Colour = [0.95, 0.2, 0.2];
const CONTACT: Colour = [1, 0.25, 0.1];

type Outcome = "arrived" | "damaged" | "lost";

/** A message from one robot to another; if the message is lost at the sender, both are the sender. */
interface Flight {
  from: number;
  to: number;
  outcome: Outcome;
  /** Real time for which it has been shown. While the run is paused, it stops at an age at which the outcome is visible. */
  age_ms: number;
}

interface Contact {
  x_m: number;
  y_m: number;
  age_ms: number;
}

export class EventEffects {
  readonly radio = new THREE.Group();
  readonly contacts = new THREE.Group();
  /** Called when a robot is placed elsewhere. */
  onplaced: (robot: number, t_s: number) => void = () => {};
  private readonly arcs = new Pen("lines", { renderOrder: 9, depthTest: false });
  private readonly dots = new Pen("points", { size_px: 11, renderOrder: 10, depthTest: false });
  private readonly bursts = new Pen("triangles", { renderOrder: 8 });
  private readonly outcomes: Sprites;
  private readonly flights: Flight[] = [];
  private readonly recentContacts: Contact[] = [];
  private last = 0;

  constructor(
    private readonly model: Model,
    private readonly bodies: Bodies,
  ) {
    const mark = (text: string, plate: string) => ({ text, plate, colour: "#ffffff" });
    const marks = [mark("✓", "#1d9a4b"), mark("~", "#b97a10"), mark("✕", "#d0342c")];
    this.outcomes = new Sprites(Array.from({ length: MAX_FLIGHTS }, () => marks).flat(), 0, 21);
    this.radio.add(this.arcs.object, this.dots.object, this.outcomes.mesh);
    this.contacts.add(this.bursts.object);
  }

  rebuild(): void {
    this.flights.length = 0;
    this.recentContacts.length = 0;
    // Events from before the page was opened are not played.
    this.last = this.model.events.at(-1)?.number ?? 0;
  }

  /** Reads the model's new events. */
  takeEvents(): void {
    const { events } = this.model;
    const newest = events.at(-1)?.number ?? 0;
    if (newest < this.last) return this.rebuild();
    let first = events.length;
    while (first > 0 && events[first - 1]!.number > this.last) first--;
    // After a jump in time only the latest events are played.
    for (const event of events.slice(Math.max(first, events.length - 2 * MAX_FLIGHTS))) this.take(event);
    this.last = newest;
  }

  /** Draws messages and contacts; returns true while any is animated. */
  update(passed_ms: number, prefersReducedMotion: boolean, width_px: number, height_px: number): boolean {
    const isStill = this.model.snapshot?.state.is === "paused" || this.model.player?.isPlaying === false;
    age(this.flights, passed_ms, SHOWN_MS, isStill);
    age(this.recentContacts, passed_ms, CONTACT_MS, isStill);
    this.drawFlights(prefersReducedMotion, width_px, height_px);
    this.drawContacts();
    const isPlaying = (item: { age_ms: number }, max_ms: number) => !isStill || item.age_ms < 0.6 * max_ms;
    const isFlying = this.flights.some((flight) => isPlaying(flight, SHOWN_MS));
    return isFlying || this.recentContacts.some((contact) => isPlaying(contact, CONTACT_MS));
  }

  dispose(): void {
    for (const pen of [this.arcs, this.dots, this.bursts]) pen.dispose();
    this.outcomes.dispose();
  }

  private take({ kind, robot, t_s, fields }: Event): void {
    const number = (key: string) => (typeof fields[key] === "number" ? fields[key] : null);
    if (kind === "placed" && robot !== null) {
      this.onplaced(robot, t_s);
    } else if (kind === "contact") {
      const [x_m, y_m] = [number("x_m"), number("y_m")];
      if (x_m === null || y_m === null) return;
      if (this.recentContacts.length === MAX_CONTACTS) this.recentContacts.shift();
      this.recentContacts.push({ x_m, y_m, age_ms: 0 });
    } else if ((kind === "radio_arrived" || kind === "radio_lost") && robot !== null) {
      const outcome = kind === "radio_lost" ? "lost" : (number("bit_errors") ?? 0) > 0 ? "damaged" : "arrived";
      if (this.flights.length === MAX_FLIGHTS) this.flights.shift();
      this.flights.push({ from: number("from") ?? robot, to: robot, outcome, age_ms: 0 });
    }
  }

  private drawFlights(prefersReducedMotion: boolean, width_px: number, height_px: number): void {
    const { arcs, dots, outcomes } = this;
    arcs.begin();
    dots.begin();
    for (let i = 0; i < 3 * MAX_FLIGHTS; i++) outcomes.put(i, 0, 0, 0, 0);
    for (let i = 0; i < this.flights.length; i++) {
      const flight = this.flights[i]!;
      const from = this.bodies.robot(flight.from);
      const to = this.bodies.robot(flight.to);
      if (!from?.isPresent || !to?.isPresent) continue;
      const progress = prefersReducedMotion ? 1 : Math.min(1, flight.age_ms / FLIGHT_MS);
      const rest = Math.max(0, (SHOWN_MS - flight.age_ms) / (SHOWN_MS - FLIGHT_MS));
      const opacity = prefersReducedMotion ? 1 : Math.min(1, rest);
      const colour = progress < 1 ? AIR : COLOURS[flight.outcome];
      // A lost message ends about half-way.
      const goal = flight.outcome === "lost" ? 0.55 : 1;
      const end = goal * progress;
      const z0 = from.extent.height_m + 0.02;
      const z1 = to.extent.height_m + 0.02;
      const distance = Math.hypot(to.pose.x_m - from.pose.x_m, to.pose.y_m - from.pose.y_m);
      const rise = flight.from === flight.to ? 0.15 : 0.18 * distance;
      const parts = 20;
      for (let p = 0; p <= parts; p++) {
        const s = (end * p) / parts;
        at[0] = from.pose.x_m + s * (to.pose.x_m - from.pose.x_m);
        at[1] = from.pose.y_m + s * (to.pose.y_m - from.pose.y_m);
        at[2] = z0 + s * (z1 - z0) + 4 * rise * s * (1 - s);
        // Each inner vertex ends one line and begins the next.
        if (p > 0) arcs.to(at[0], at[1], at[2], colour, opacity);
        if (p < parts) arcs.to(at[0], at[1], at[2], colour, opacity * (p / parts));
      }
      dots.to(at[0]!, at[1]!, at[2]!, colour, opacity);
      if (progress === 1) outcomes.put(3 * i + OUTCOMES[flight.outcome], at[0]!, at[1]!, at[2]!, 0.9 * opacity);
    }
    arcs.end();
    dots.end();
    outcomes.end(width_px, height_px);
  }

  /** Draws each contact as a star that grows and fades. */
  private drawContacts(): void {
    const pen = this.bursts;
    pen.begin();
    for (const { x_m, y_m, age_ms } of this.recentContacts) {
      const progress = age_ms / CONTACT_MS;
      const size = 0.02 + 0.05 * progress;
      for (let ray = 0; ray < 8; ray++) {
        const turn = (ray * Math.PI) / 4;
        const [cos, sin] = [Math.cos(turn), Math.sin(turn)];
        const opacity = 0.95 * (1 - progress);
        const inner = 0.35 * size;
        pen.to(x_m + inner * cos - 0.2 * inner * sin, y_m + inner * sin + 0.2 * inner * cos, 0.06, CONTACT, opacity);
        pen.to(x_m + inner * cos + 0.2 * inner * sin, y_m + inner * sin - 0.2 * inner * cos, 0.06, CONTACT, opacity);
        pen.to(x_m + size * cos, y_m + size * sin, 0.06, CONTACT, opacity);
      }
    }
    pen.end();
  }
}

const COLOURS: Record<Outcome, Colour> = { arrived: ARRIVED, damaged: DAMAGED, lost: LOST };
const OUTCOMES: Record<Outcome, number> = { arrived: 0, damaged: 1, lost: 2 };
const at = new Float64Array(3);

/** Ages items and drops old ones; while the run is paused they stop at an age where they are fully visible. */
function age(items: { age_ms: number }[], passed_ms: number, max_ms: number, isStill: boolean): void {
  for (const item of items) {
    const next = item.age_ms + passed_ms;
    item.age_ms = isStill ? Math.max(item.age_ms, Math.min(next, 0.6 * max_ms)) : next;
  }
  while (items.length > 0 && items[0]!.age_ms > max_ms) items.shift();
}
