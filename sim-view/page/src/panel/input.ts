// Standard input of the chosen robot's program: a line to type.

import { element } from "../dom";
import type { Model } from "../model";
import { button, section, setReason } from "./control";
import { act, onRights, whyNot } from "./notice";

export function inputPanel(model: Model): HTMLElement {
  const line = element("input", { type: "text", testid: "input-line", label: "Line for the program", placeholder: "a line for the program" });
  const send = button("Send", "input-send", () => void sendLine());
  line.addEventListener("keydown", (event) => {
    if (event.key === "Enter") void sendLine();
  });
  const panel = section("Standard input", "input-panel", true, [element("div", { className: "row" }, [line, send])]);
  onRights(model, () => setReason([line, send], whyNot(model)));
  return panel;

  async function sendLine(): Promise<void> {
    if (model.chosen === null || whyNot(model)) return;
    const typed = line.value;
    if (await act(model, { do: "type", robot: model.chosen, line: typed })) line.value = "";
  }
}
