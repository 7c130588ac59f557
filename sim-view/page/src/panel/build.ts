// Progress of building the programs, with the compiler's output if it fails.

import { element } from "../dom";
import type { Model } from "../model";
import { setText } from "./control";

export function buildPanel(model: Model): HTMLElement {
  const title = element("strong", { role: "status" });
  const output = element("pre", { testid: "build-output", tabIndex: 0, label: "What the compiler said" });
  const panel = element("div", { className: "bar build", testid: "build", hidden: true }, [title, output]);
  model.subscribe("build", draw);
  return panel;

  function draw(): void {
    const { build } = model;
    panel.hidden = build === null || build.state === "done";
    if (build === null) return;
    panel.dataset["is"] = build.state;
    output.hidden = build.state !== "failed";
    setText(output, build.state === "failed" ? build.output : "");
    setText(title, build.state === "failed" ? "The program was not built; the run before goes on" : "Building the program …; then the run starts again");
  }
}
