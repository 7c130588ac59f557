// Checks of the scene and their verdicts up to now; metrics of swarms as curves.

import { element } from "../dom";
import type { Model } from "../model";
import type { CheckState, CheckVerdict } from "../protocol";
import { section, setText, whileOpen } from "./control";

const VERDICT: Record<CheckVerdict, string> = { open: "open", met: "met", failed: "failed" };
const SVG = "http://www.w3.org/2000/svg";
/** Maximum number of points of a curve; more points are thinned. */
const MAX_POINTS = 2000;

interface Row {
  element: HTMLElement;
  verdict: HTMLElement;
  text: HTMLElement;
  curve: SVGPolylineElement | null;
  points: [t_s: number, value: number][];
}

export function checksPanel(model: Model): HTMLElement {
  const list = element("ul", { className: "checks", testid: "checks", label: "Checks" });
  const panel = section("Checks", "checks-panel", true, [list]);
  let rows: Row[] = [];
  let key = "";
  const scheduleDraw = whileOpen(panel, draw, 200);
  model.subscribe("snapshot", () => {
    const checks = model.snapshot?.checks ?? [];
    panel.hidden = checks.length === 0;
    const needed = JSON.stringify([model.scene?.run, checks.map(({ name, value }) => [name, value !== null])]);
    if (needed !== key) {
      key = needed;
      rows = checks.map(rowOf);
      list.replaceChildren(...rows.map((row) => row.element));
    }
    checks.forEach((check, index) => add(rows[index]!, check));
    scheduleDraw();
  });
  return panel;

  function add({ points }: Row, { value }: CheckState): void {
    const t_s = model.snapshot?.t_s ?? 0;
    if (value === null || t_s <= (points.at(-1)?.[0] ?? -1)) return;
    points.push([t_s, value]);
    if (points.length > MAX_POINTS) for (let at = points.length - 2; at > 0; at -= 2) points.splice(at, 1);
  }

  function draw(): void {
    for (const [index, check] of (model.snapshot?.checks ?? []).entries()) {
      const row = rows[index];
      if (!row) continue;
      row.element.dataset["is"] = check.verdict;
      setText(row.verdict, VERDICT[check.verdict]);
      setText(row.text, check.text);
      row.curve?.setAttribute("points", curveOf(row.points));
    }
  }
}

function rowOf({ name, value }: CheckState): Row {
  const verdict = element("span", { className: "verdict" });
  const text = element("span", { className: "muted" });
  const item = element("li", {}, [verdict, element("span", { className: "name", textContent: name }), text]);
  if (value === null) return { element: item, verdict, text, curve: null, points: [] };
  const picture = document.createElementNS(SVG, "svg");
  picture.setAttribute("viewBox", "0 0 100 24");
  picture.setAttribute("preserveAspectRatio", "none");
  picture.setAttribute("aria-hidden", "true");
  const curve = document.createElementNS(SVG, "polyline");
  picture.append(curve);
  item.append(picture);
  return { element: item, verdict, text, curve, points: [] };
}

/** Corners of a curve that fills a picture of 100 by 24, with a margin of 2 above and below. */
function curveOf(points: readonly [number, number][]): string {
  const [first, last] = [points[0], points.at(-1)];
  if (!first || !last) return "";
  const values = points.map(([, value]) => value);
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const xOf = (t_s: number) => (100 * (t_s - first[0])) / (last[0] - first[0] || 1);
  const yOf = (value: number) => (high > low ? 22 - (20 * (value - low)) / (high - low) : 12);
  return points.map(([t_s, value]) => `${xOf(t_s).toFixed(2)},${yOf(value).toFixed(2)}`).join(" ");
}
