// Downloads.

import { element } from "../dom";
import type { Model } from "../model";
import { button, saveAs, section } from "./control";
import { notify } from "./notice";

/** Files that the server may offer under `/files/`. */
const FILES = [
  { name: "scene.toml", text: "Scene as TOML", testid: "save-scene", title: "With everybody where they are now" },
  { name: "trace.jsonl", text: "Trace", testid: "save-trace", title: "Events of this run so far, for `eyesim replay`" },
  { name: "run.recording.json", text: "Recording", testid: "save-recording", title: "What a page plays" },
];

export function savePanel(model: Model): HTMLElement {
  const picture = button("Screenshot", "save-picture", () => void screenshot(), "The 3D view as PNG");
  const files = FILES.map(({ name, text, testid, title }) => button(text, testid, () => void save(name), title));
  const panel = section("Save", "save-panel", false, [element("div", { className: "row" }, [picture, ...files])]);
  model.subscribe("player", () => (files[0]!.hidden = model.player !== null));
  return panel;

  function fileName(ending: string): string {
    return `${(model.scene?.title ?? "eyesim").replaceAll(/[^\w.-]+/g, "-")}${ending}`;
  }

  async function screenshot(): Promise<void> {
    const image = await model.screenshot?.();
    if (image) saveAs(fileName(".png"), image);
    else notify("There is no 3D view to take a picture of");
  }

  async function save(file: string): Promise<void> {
    // A live run has no `recording.json`: its presence tells pages that they show a replay.
    const name = model.player ? file.replace("run.", "") : file;
    const embedded = name === "recording.json" ? document.getElementById("recording")?.textContent : undefined;
    if (embedded) return saveAs(fileName(".recording.json"), new Blob([embedded], { type: "application/json" }));
    try {
      const response = await fetch(`files/${name}`);
      if (response.ok) saveAs(fileName(`.${file.replace("run.", "")}`), await response.blob());
      else if (response.status === 404) notify(`eyesim keeps no ${name} of this run`);
      else notify(`${name} was not saved: ${await response.text()}`);
    } catch {
      notify(`${name} was not saved: no answer from eyesim`);
    }
  }
}
