// Banner for problems of the connection and their remedies.

import { element } from "../dom";
import type { Model } from "../model";
import { PROTOCOL } from "../protocol";
import { button, setText } from "./control";

export function bannerPanel(model: Model): HTMLElement {
  const text = element("span", { testid: "banner-text" });
  const reload = button("Load again", "reload", () => location.reload());
  const panel = element("div", { className: "bar banner", testid: "banner", role: "alert", hidden: true }, [text, reload]);
  for (const topic of ["connection", "welcome"] as const) model.subscribe(topic, draw);
  return panel;

  function draw(): void {
    const words = problem();
    panel.hidden = words === "";
    panel.dataset["is"] = model.connection.is;
    setText(text, words);
    reload.hidden = model.connection.is === "open" && model.welcome?.protocol === PROTOCOL;
  }

  function problem(): string {
    const { connection, welcome } = model;
    if (connection.is === "refused") return `eyesim refused this page: ${connection.why}. Use the address that eyesim printed.`;
    if (connection.is === "lost") return "The connection to eyesim is lost; what you see is how it was. The page connects again by itself.";
    if (welcome && welcome.protocol !== PROTOCOL)
      return `This page is of another version than eyesim ${welcome.version}, which speaks protocol ${welcome.protocol}, not ${PROTOCOL}.`;
    if (connection.is === "open" && welcome && !welcome.may_act) return "You are watching: only the teacher's page can change the simulation.";
    return "";
  }
}
