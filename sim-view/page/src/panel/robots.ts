// List of all robots and their states.

import { element } from "../dom";
import type { Model } from "../model";
import type { Robot, RobotState, Standing } from "../protocol";
import { section, setText, whileOpen } from "./control";

const STANDING: Record<Standing, string> = {
  running: "running",
  waiting: "waiting",
  finished: "finished",
  failed: "failed",
  no_program: "no program",
};

interface Row {
  element: HTMLElement;
  name: HTMLElement;
  standing: HTMLElement;
  time: HTMLElement;
  why: HTMLElement;
}

export function robotsPanel(model: Model): HTMLElement {
  const list = element("div", { className: "robots", role: "listbox", tabIndex: 0, testid: "robots", label: "Robots" });
  const panel = section("Robots", "robots-panel", true, [list]);
  const rows = new Map<number, Row>();
  list.onclick = (event) => {
    const row = (event.target as Element).closest<HTMLElement>("[role=option]");
    if (row) model.choose(Number(row.dataset["robot"]));
  };
  list.onkeydown = (event) => {
    const step = ({ ArrowDown: 1, ArrowUp: -1 } as const)[event.key as string];
    const robots = model.scene?.robots ?? [];
    if (step) model.moveSelection(step);
    else if (event.key === "Home") model.choose(robots[0]?.id ?? null);
    else if (event.key === "End") model.choose(robots.at(-1)?.id ?? null);
    else return;
    event.preventDefault();
    event.stopPropagation();
  };
  const drawStates = whileOpen(panel, draw, 200);
  model.subscribe("scene", makeRows);
  model.subscribe("snapshot", drawStates);
  model.subscribe("chosen", mark);
  return panel;

  function makeRows(): void {
    rows.clear();
    for (const robot of model.scene?.robots ?? []) rows.set(robot.id, rowOf(robot));
    list.replaceChildren(...[...rows.values()].map((row) => row.element));
    mark();
    draw();
  }

  function mark(): void {
    for (const [id, row] of rows) row.element.ariaSelected = String(id === model.chosen);
    const chosen = model.chosen === null ? undefined : rows.get(model.chosen)?.element;
    list.setAttribute("aria-activedescendant", chosen?.id ?? "");
    if (document.activeElement === list) chosen?.scrollIntoView({ block: "nearest" });
  }

  function draw(): void {
    for (const state of model.snapshot?.robots ?? []) {
      const row = rows.get(state.id);
      if (row) fill(row, state);
    }
  }
}

function rowOf({ id, name, program, kind, colour }: Robot): Row {
  const swatch = element("span", { className: "swatch", ariaHidden: "true" });
  swatch.style.background = `rgb(${colour.join(" ")})`;
  const row: Row = {
    element: element("div", { id: `robot-${id}`, className: "robot", role: "option", testid: `robot-${id}` }),
    name: element("strong", { textContent: `${id} ${name}`, title: kind }),
    standing: element("span", { className: "standing" }),
    time: element("span", { className: "number" }),
    why: element("span", { className: "why muted" }),
  };
  const file = element("span", { className: "program muted", textContent: program.split("/").at(-1) ?? "", title: program });
  row.element.dataset["robot"] = String(id);
  row.element.append(swatch, row.name, file, row.standing, row.time, row.why);
  return row;
}

function fill(row: Row, { standing, now_s, why, is_stalled }: RobotState): void {
  setText(row.standing, is_stalled ? `${STANDING[standing]}, stalled` : STANDING[standing]);
  row.standing.dataset["is"] = is_stalled ? "stalled" : standing;
  setText(row.time, `${now_s.toFixed(2)} s`);
  setText(row.why, why);
  row.why.title = why;
}
