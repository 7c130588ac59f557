import type { Model } from "../model";
import { bannerPanel } from "./banner";
import { buildPanel } from "./build";
import { callsPanel } from "./calls";
import { cameraPanel } from "./camera";
import { checksPanel } from "./checks";
import { editPanel } from "./edit";
import { eventsPanel } from "./events";
import { helpPanel } from "./help";
import { inputPanel } from "./input";
import { listen } from "./keyboard";
import { lcdPanel } from "./lcd";
import { noisePanel } from "./noise";
import { noticePanel } from "./notice";
import { PlotSelection } from "./picks";
import { plotPanel } from "./plot";
import { readingsPanel } from "./readings";
import { robotsPanel } from "./robots";
import { runPanel } from "./run";
import { savePanel } from "./save";
import { sensorsPanel } from "./sensors";

/** All panels in order; those of class `bar` go into the bar above the 3D view. */
export function panels(model: Model): HTMLElement[] {
  const picks = new PlotSelection();
  const panels = [
    runPanel(model),
    helpPanel(model),
    bannerPanel(model),
    buildPanel(model),
    robotsPanel(model),
    checksPanel(model),
    lcdPanel(model),
    inputPanel(model),
    cameraPanel(model),
    readingsPanel(model, picks),
    plotPanel(model, picks),
    eventsPanel(model),
    callsPanel(model),
    sensorsPanel(model),
    noisePanel(model),
    editPanel(model),
    savePanel(model),
    noticePanel(model),
  ];
  listen();
  return panels;
}
