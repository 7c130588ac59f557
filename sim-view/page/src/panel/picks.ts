// Which readings are plotted: one choice for all robots, kept for the next visit.

import { recall, remember } from "./control";

const MEMORY = "eyesim.plotted";
/** There are as many colours. */
export const MOST_PICKS = 8;

export class Picks {
  private names: string[] = recall(MEMORY, "").split("\n").filter((name) => name !== "");
  private readonly listeners: (() => void)[] = [];

  /** In the order in which they were picked. */
  get all(): readonly string[] {
    return this.names;
  }

  has(name: string): boolean {
    return this.names.includes(name);
  }

  /** Picks a reading, or no more; of too many the oldest goes. */
  set(name: string, isPicked: boolean): void {
    const others = this.names.filter((other) => other !== name);
    this.change(isPicked ? [...others, name].slice(-MOST_PICKS) : others);
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
    remember(MEMORY, names.join("\n"));
    for (const f of this.listeners) f();
  }
}
