// Switches of the chosen robot's sensors.

import { element } from "../dom";
import type { Model } from "../model";
import { section, setText, whileOpen } from "./control";
import { act, onRights, whyNot } from "./notice";

/** Time for which a switch that the user has changed ignores the reported state, which may change later than the answer arrives. */
const HOLDS_MS = 1000;

export function sensorsPanel(model: Model): HTMLElement {
  const list = element("ul", { className: "switches", testid: "sensors" });
  const none = element("p", { className: "muted" });
  const panel = section("Sensors on and off", "sensors-panel", false, [none, list]);
  const boxes = new Map<string, HTMLInputElement>();
  const held = new Map<HTMLInputElement, ReturnType<typeof setTimeout>>();
  let key = "";
  const scheduleDraw = whileOpen(panel, draw);
  for (const topic of ["detail", "chosen"] as const) model.subscribe(topic, scheduleDraw);
  onRights(model, draw);
  return panel;

  function draw(): void {
    const sensors = (model.chosen === null ? undefined : model.details.get(model.chosen))?.sensors ?? [];
    none.hidden = sensors.length > 0;
    setText(none, model.player ? "A recording does not know them." : "This robot has no sensors.");
    const needed = JSON.stringify([model.chosen, sensors.map(({ name }) => name)]);
    if (needed !== key) makeBoxes(sensors.map(({ name }) => name));
    key = needed;
    const why = whyNot(model);
    for (const { name, is_on } of sensors) {
      const box = boxes.get(name);
      if (box && !held.has(box)) box.checked = is_on;
    }
    for (const box of boxes.values()) {
      box.disabled = why !== "";
      box.title = why;
    }
  }

  function makeBoxes(names: readonly string[]): void {
    boxes.clear();
    const kinds = new Map(model.scene?.robots.find(({ id }) => id === model.chosen)?.sensors.map(({ name, kind }) => [name, kind]));
    const items = names.map((name) => {
      const box = element("input", { type: "checkbox", role: "switch", testid: `sensor-${name}` });
      box.onchange = () => void change(name, box);
      boxes.set(name, box);
      const kind = element("span", { className: "muted", textContent: kinds.get(name) ?? "" });
      return element("li", {}, [element("label", { className: "check" }, [box, name, kind])]);
    });
    list.replaceChildren(...items);
  }

  async function change(sensor: string, box: HTMLInputElement): Promise<void> {
    if (model.chosen === null) return;
    const release = () => {
      clearTimeout(held.get(box));
      held.delete(box);
      scheduleDraw();
    };
    clearTimeout(held.get(box));
    const timer = setTimeout(release, HOLDS_MS);
    held.set(box, timer);
    const isDone = await act(model, { do: "switch_sensor", robot: model.chosen, sensor, on: box.checked });
    // If the switch was changed again meanwhile, it keeps the newer position.
    if (!isDone && held.get(box) === timer) release();
  }
}
