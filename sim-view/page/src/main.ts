import "uplot/dist/uPlot.min.css";
import "./style/base.css";
import "./style/layout.css";
import "./style/panel.css";
import { LiveSource } from "./connection";
import { element } from "./dom";
import { Model } from "./model";
import { panels } from "./panel";
import { connectionStatus } from "./status";

const model = new Model();

const title = element("h1", { className: "title", textContent: "eyesim" });
const bar = element("header", { className: "top" }, [title]);
const view = element("main", { className: "view" });
const side = element("aside", { className: "side", ariaLabel: "Panels" });
for (const panel of panels(model)) (panel.classList.contains("bar") ? bar : side).append(panel);
bar.append(connectionStatus(model));
document.body.append(bar, view, side);

model.subscribe("scene", () => {
  if (!model.scene) return;
  title.textContent = model.scene.title;
  document.title = `${model.scene.title} · eyesim`;
});

model.attach(new LiveSource(model));
