// Table of the chosen robot's latest readings and commands; ticked ones are plotted.

import { element } from "../dom";
import type { Model } from "../model";
import type { Reading } from "../protocol";
import { button, section, setText, whileOpen } from "./control";
import type { PlotSelection } from "./picks";

interface Row {
  element: HTMLElement;
  box: HTMLInputElement;
  value: HTMLElement;
  at: HTMLElement;
}

export function readingsPanel(model: Model, picks: PlotSelection): HTMLElement {
  const body = element("tbody", { testid: "readings" });
  const head = ["Plot", "Reading", "Value", "At"].map((textContent) => element("th", { textContent, scope: "col" }));
  const none = element("p", { className: "muted", textContent: "Nothing has been read yet." });
  const clear = button("Untick all", "untick", () => picks.clear());
  const table = element("table", { className: "readings" }, [element("thead", {}, [element("tr", {}, head)]), body]);
  const panel = section("Readings", "readings-panel", true, [none, table, clear]);
  const rows = new Map<string, Row>();
  const scheduleDraw = whileOpen(panel, draw);
  model.subscribe("detail", scheduleDraw);
  model.subscribe("chosen", scheduleDraw);
  picks.subscribe(() => rows.forEach(({ box }, name) => (box.checked = picks.has(name))));
  return panel;

  function draw(): void {
    const detail = model.chosen === null ? undefined : model.details.get(model.chosen);
    const readings = detail?.readings ?? [];
    none.hidden = readings.length > 0;
    table.hidden = clear.hidden = readings.length === 0;
    const names = new Set(readings.map(({ name }) => name));
    for (const [name, row] of rows) {
      if (names.has(name)) continue;
      row.element.remove();
      rows.delete(name);
    }
    for (const reading of readings) fill(reading);
  }

  function fill({ name, value, unit, at_s }: Reading): void {
    let row = rows.get(name);
    if (!row) {
      rows.set(name, (row = rowOf(name, picks)));
      body.append(row.element);
    }
    setText(row.value, value === null ? "nothing" : `${valueText(value)}${unit && ` ${unit}`}`);
    setText(row.at, `${at_s.toFixed(2)} s`);
  }
}

function rowOf(name: string, picks: PlotSelection): Row {
  const box = element("input", { type: "checkbox", label: `Plot ${name}`, checked: picks.has(name) });
  box.onchange = () => picks.set(name, box.checked);
  const [value, at] = [element("td", { className: "number" }), element("td", { className: "number muted" })];
  const cells = [element("td", {}, [box]), element("th", { scope: "row", textContent: name }), value, at];
  const row = element("tr", {}, cells);
  row.dataset["reading"] = name;
  return { element: row, box, value, at };
}

function valueText(value: number): string {
  return Number.isInteger(value) ? String(value) : value.toFixed(Math.abs(value) < 10 ? 3 : 1);
}
