// The RoBIOS calls of the chosen robot.

import { element } from "../dom";
import type { Model } from "../model";
import { button, section, setText, whileOpen } from "./control";
import { type Line, LongList } from "./list";
import { notify } from "./notice";

export function callsPanel(model: Model): HTMLElement {
  const list = new LongList("calls", "RoBIOS calls", () => undefined);
  const words = element("input", { type: "search", testid: "calls-words", label: "Words in calls", placeholder: "VWStraight", oninput: draw });
  const copy = button("Copy", "calls-copy", () => void copyAll());
  const clear = button("Clear", "calls-clear", clearAll);
  const count = element("p", { className: "muted number", testid: "calls-count" });
  const panel = section("RoBIOS calls", "calls-panel", false, [element("div", { className: "row" }, [words, copy, clear]), list.element, count]);
  let shown: Line[] = [];
  panel.addEventListener("toggle", () => model.look({ calls: panel.open }));
  model.look({ calls: panel.open });
  const scheduleDraw = whileOpen(panel, draw, 250);
  for (const topic of ["events", "chosen"] as const) model.subscribe(topic, scheduleDraw);
  return panel;

  function draw(): void {
    const query = words.value.toLowerCase();
    const calls = model.calls.filter(({ robot }) => robot === model.chosen);
    shown = calls
      .filter(({ text }) => text.toLowerCase().includes(query))
      .map(({ number, t_s, text }) => ({ key: number, time: t_s.toFixed(6), who: "", kind: "", text }));
    list.show(shown);
    const none = model.player ? "a recording has no calls" : "no calls since this was opened";
    setText(count, calls.length === 0 ? none : `${shown.length} of ${calls.length} calls`);
  }

  async function copyAll(): Promise<void> {
    const text = shown.map(({ time, text }) => `${time} ${text}\n`).join("");
    try {
      await navigator.clipboard.writeText(text);
      notify(`${shown.length} calls copied`);
    } catch {
      notify("This browser lets only pages of this machine or with https copy to the clipboard");
    }
  }

  function clearAll(): void {
    model.calls = model.calls.filter(({ robot }) => robot !== model.chosen);
    draw();
  }
}
