import "uplot/dist/uPlot.min.css";
import "./style/base.css";
import "./style/layout.css";
import "./style/scene.css";
import "./style/panel.css";
import { LiveSource } from "./connection";
import { element } from "./dom";
import { Model } from "./model";
import { panels } from "./panel";
import { notify } from "./panel/notice";
import { findRecording, RecordedSource } from "./recorded";
import { sceneView } from "./scene/view";
import { connectionStatus } from "./status";
import { timeline } from "./timeline";

const model = new Model();
const recording = await findRecording();

const title = element("h1", { className: "title", textContent: "eyesim" });
const bar = element("header", { className: "top" }, [title]);
const scene = sceneView(model);
const line = timeline(model, recording?.events ?? null);
line.append(connectionStatus(model));
const view = element("main", { className: "view" }, [scene.element, line]);
const side = element("aside", { className: "side", label: "Panels" });
for (const panel of panels(model)) (panel.classList.contains("bar") ? bar : side).append(panel);
document.getElementById("loading")?.remove();
document.body.append(bar, view, side);

model.subscribe("scene", () => {
  if (!model.scene) return;
  title.textContent = model.scene.title;
  document.title = `${model.scene.title} · eyesim`;
});

if (recording) {
  document.body.classList.add("recorded");
  model.attach(new RecordedSource(model, recording));
  for (const remark of recording.remarks) notify(remark);
} else {
  model.attach(new LiveSource(model));
}

// For tests and for the browser's console.
Object.assign(globalThis, { eyesim: { model, view: scene.view } });
