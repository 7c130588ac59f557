// Camera image of the chosen robot.

import { element } from "../dom";
import type { Model } from "../model";
import { section, setText } from "./control";

export function cameraPanel(model: Model): HTMLElement {
  const picture = element("img", { className: "pixels camera", testid: "camera", alt: "What the robot's camera sees" });
  const none = element("p", { className: "muted" });
  const panel = section("Camera", "camera-panel", true, [picture, none]);
  panel.addEventListener("toggle", () => model.look({ camera: panel.open }));
  model.look({ camera: panel.open });
  for (const topic of ["detail", "scene", "chosen"] as const) model.subscribe(topic, draw);
  return panel;

  function draw(): void {
    const robot = model.scene?.robots.find(({ id }) => id === model.chosen);
    panel.hidden = !robot?.camera;
    if (!robot?.camera || !panel.open) return;
    const image = model.details.get(robot.id)?.camera ?? null;
    picture.hidden = image === null;
    none.hidden = image !== null;
    if (image === null) return setText(none, model.player ? "A recording has no camera images." : "No image yet.");
    if (picture.src === image.url) return;
    picture.src = image.url;
    [picture.width, picture.height] = image.size_px;
  }
}
