import type { Model } from "../model";

/** All panels in the order in which they stand; those of class `bar` stand in the bar above the 3D view. */
export function panels(_model: Model): HTMLElement[] {
  return [];
}
