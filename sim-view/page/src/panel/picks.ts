// Selection of the plotted readings: one for all robots, stored for the next visit.

import { recall, remember } from "./control";

const STORAGE_KEY = "eyesim.plotted";
/** Maximum number of picked readings: the number of curve colours. */
export const MAX_SELECTED = 8;

export class PlotSelection {
  private names: string[] = recall(STORAGE_KEY, "").split("\n").filter((name) => name !== "");
  private readonly listeners: (() => void)[] = [];

  /** Picked readings in the order of picking. */
  get all(): readonly string[] {
    return this.names;
  }

  has(name: string): boolean {
    return this.names.includes(name);
  }

  /** Picks or unpicks a reading; beyond [`MAX_SELECTED`] the oldest is dropped. */
  set(name: string, isPicked: boolean): void {
    const others = this.names.filter((other) => other !== name);
    this.change(isPicked ? [...others, name].slice(-MAX_SELECTED) : others);
  }

  clear(): void {
    this.change([]);
  }

  /** Calls `f` after each change. */
  subscribe(f: () => void): void {
    this.listeners.push(f);
  }

  private change(names: string[]): void {
    this.names = names;
    remember(STORAGE_KEY, names.join("\n"));
    for (const f of this.listeners) f();
  }
}
