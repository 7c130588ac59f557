// Noise models of the chosen robot, with a slider and a field for each parameter.

import { element } from "../dom";
import type { Model } from "../model";
import type { Parameter } from "../protocol";
import { button, choice, numberField, numberOf, section, setOptions, setReason, setText, setValue, whileOpen } from "./control";
import { act, onRights, whyNot } from "./notice";

const STEPS = 1000;
/** Width of a range above which its slider resolves small numbers more finely. */
const WIDE = 200;

interface Row {
  element: HTMLElement;
  slider: HTMLInputElement;
  field: HTMLInputElement;
  parameter: Parameter;
}

export function noisePanel(model: Model): HTMLElement {
  const whom = choice("noise-whom", "Whose error models", () => undefined);
  setOptions(whom, [["this", "of this robot"], ["all", "of all robots"]]);
  const reset = button("Reset", "noise-reset", resetAll, "Back to what they were when this page first saw them");
  const groups = element("div", { testid: "noise" });
  const none = element("p", { className: "muted" });
  const panel = section("Error models", "noise-panel", false, [
    element("div", { className: "row" }, ["Change those", whom, reset]),
    none,
    groups,
  ]);
  const rows = new Map<string, Row>();
  /** Values when first seen, by run and robot. */
  const first = new Map<string, Map<string, number>>();
  let keyOfRows = "";
  const scheduleDraw = whileOpen(panel, draw);
  for (const topic of ["detail", "chosen"] as const) model.subscribe(topic, scheduleDraw);
  // After a reconnection, a run with the same number may be another one.
  model.subscribe("welcome", () => first.clear());
  onRights(model, allow);
  return panel;

  function draw(): void {
    const detail = model.chosen === null ? undefined : model.details.get(model.chosen);
    const noise = detail?.noise ?? [];
    setText(none, model.player ? "A recording does not know them." : "This robot has none.");
    none.hidden = noise.length > 0;
    if (detail) rememberFirst(detail.run, detail.robot, noise);
    const key = JSON.stringify(noise.map(({ name, range }) => [name, range]));
    if (key !== keyOfRows) makeRows(noise);
    keyOfRows = key;
    for (const parameter of noise) {
      const row = rows.get(parameter.name);
      if (row) fill(row, parameter);
    }
  }

  function rememberFirst(run: number, robot: number, noise: readonly Parameter[]): void {
    const key = `${run} ${robot}`;
    if (!first.has(key)) first.set(key, new Map(noise.map(({ name, value }) => [name, value])));
  }

  function makeRows(noise: readonly Parameter[]): void {
    const open = new Set([...groups.querySelectorAll("details")].filter((group) => group.open).map((group) => group.dataset["group"]));
    rows.clear();
    const bodies = new Map<string, HTMLElement>();
    for (const parameter of noise) {
      const row = rowOf(parameter);
      rows.set(parameter.name, row);
      const group = groupOf(parameter.name);
      if (!bodies.has(group)) bodies.set(group, element("div", { className: "body" }));
      bodies.get(group)!.append(row.element);
    }
    const tableRows = [...bodies].map(([name, body]) => {
      const group = element("details", { open: open.has(name) || bodies.size === 1 }, [element("summary", { textContent: name }), body]);
      group.dataset["group"] = name;
      return group;
    });
    groups.replaceChildren(...tableRows);
    allow();
  }

  function rowOf(parameter: Parameter): Row {
    const { name, what, unit, range } = parameter;
    const label = `${what}${unit && ` in ${unit}`} (${name})`;
    const slider = element("input", { type: "range", min: "0", max: String(STEPS), step: "1", label, testid: `noise-slider-${name}` });
    const field = numberField(`noise-${name}`, { min: String(range[0]), max: String(range[1]), ariaLabel: label });
    const row: Row = {
      element: element("div", { className: "parameter", title: name }, [element("span", { textContent: what }), slider, field, element("span", { textContent: unit })]),
      slider,
      field,
      parameter,
    };
    const fromSlider = () => tidy(fromStep(slider.valueAsNumber, range));
    slider.oninput = () => {
      field.value = String(fromSlider());
      slider.ariaValueText = `${field.value} ${unit}`;
    };
    slider.onchange = () => set(name, fromSlider());
    field.onchange = () => {
      const value = numberOf(field);
      if (value !== undefined) set(name, value);
    };
    return row;
  }

  function fill(row: Row, parameter: Parameter): void {
    row.parameter = parameter;
    const { value, range, unit } = parameter;
    setValue(row.field, String(tidy(value)));
    if (document.activeElement === row.slider && tidy(fromStep(row.slider.valueAsNumber, range)) !== tidy(value)) return;
    row.slider.value = String(toStep(value, range));
    row.slider.ariaValueText = `${tidy(value)} ${unit}`;
  }

  function set(parameter: string, value: number, robot = whom.value === "all" ? null : model.chosen): Promise<boolean> {
    return act(model, { do: "set_noise", robot, parameter, value });
  }

  /** Resets the chosen robot, or all: each robot that the page has seen to its own values, the others to those of the chosen one. */
  async function resetAll(): Promise<void> {
    const { scene, chosen } = model;
    const valuesOf = (robot: number | null) => first.get(`${scene?.run} ${robot}`) ?? new Map<string, number>();
    const [isAll, values] = [whom.value === "all", valuesOf(chosen)];
    const changes: [string, number, number | null][] = [];
    for (const [name, value] of values) {
      if (isAll) changes.push([name, value, null]);
      else if (value !== rows.get(name)?.parameter.value) changes.push([name, value, chosen]);
    }
    for (const { id } of isAll ? (scene?.robots ?? []) : [])
      for (const [name, value] of valuesOf(id)) if (value !== values.get(name)) changes.push([name, value, id]);
    // One after the other: the server refuses too many commands at once.
    for (const change of changes) if (!(await set(...change))) return;
  }

  function allow(): void {
    const controls = [...rows.values()].flatMap(({ slider, field }) => [slider, field]);
    setReason([reset, whom, ...controls], whyNot(model));
  }
}

function groupOf(name: string): string {
  return name.slice(0, Math.max(0, name.lastIndexOf("."))) || "all";
}

/** Value at a slider step: linear, or cubic in wide ranges, so that small numbers can be set. */
export function fromStep(step: number, [low, high]: [number, number]): number {
  const fraction = step / STEPS;
  if (high - low <= WIDE) return low + fraction * (high - low);
  if (low >= 0) return low + fraction ** 3 * (high - low);
  const side = 2 * fraction - 1;
  return side ** 3 * (side < 0 ? -low : high);
}

/** Slider step nearest to a value. */
export function toStep(value: number, [low, high]: [number, number]): number {
  if (high - low <= WIDE) return Math.round(((value - low) / (high - low || 1)) * STEPS);
  if (low >= 0) return Math.round(Math.cbrt((value - low) / (high - low)) * STEPS);
  return Math.round(((Math.cbrt(value / (value < 0 ? -low : high)) + 1) / 2) * STEPS);
}

function tidy(value: number): number {
  return Number(value.toPrecision(4));
}
