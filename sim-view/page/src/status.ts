// State of the connection, in words.

import { element } from "./dom";
import type { Model } from "./model";

export function connectionStatus(model: Model): HTMLElement {
  const status = element("p", { className: "connection", testid: "connection", role: "status" });
  model.subscribe("connection", show);
  model.subscribe("welcome", show);
  return status;

  function show(): void {
    const connection = model.connection;
    status.dataset["is"] = connection.is;
    switch (connection.is) {
      case "connecting":
        status.textContent = "connecting";
        break;
      case "open":
        status.textContent = model.welcome?.may_act === false ? "connected, watching only" : "connected";
        break;
      case "lost": {
        const wait_s = Math.max(0, connection.again_ms - performance.now()) / 1000;
        status.textContent = `connection lost: ${connection.why}; trying again in ${Math.ceil(wait_s)} s`;
        break;
      }
      case "refused":
        status.textContent = `refused: ${connection.why}`;
        break;
      case "recorded":
        status.textContent = "recording";
        break;
    }
  }
}
