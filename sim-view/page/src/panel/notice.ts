// Notices that the user need not confirm: refusals of commands, and confirmations.

import { element } from "../dom";
import type { Model } from "../model";
import type { Action, Command } from "../protocol";
import { button } from "./control";

const STAYS_MS = 8000;
const MAX_NOTICES = 4;

const region = element("div", { className: "notices", testid: "notices", role: "status" });

/** The region of the notices. */
export function noticePanel(_model: Model): HTMLElement {
  return region;
}

/** Shows a notice for some seconds, or until it is closed. */
export function notify(text: string): void {
  const notice = element("div", { className: "notice", testid: "notice" }, [element("span", { textContent: text })]);
  const remove = () => notice.remove();
  const close = button("×", "close-notice", remove);
  close.ariaLabel = "Close the notice";
  notice.append(close);
  let timer = setTimeout(remove, STAYS_MS);
  for (const event of ["pointerenter", "focusin"]) notice.addEventListener(event, () => clearTimeout(timer));
  for (const event of ["pointerleave", "focusout"])
    notice.addEventListener(event, () => (timer = setTimeout(remove, STAYS_MS)));
  region.append(notice);
  if (region.childElementCount > MAX_NOTICES) region.firstElementChild?.remove();
}

/** Sends a command; shows the reason if it is refused. */
export async function send(model: Model, command: Command): Promise<boolean> {
  try {
    await model.act(command);
    return true;
  } catch (error) {
    notify(error instanceof Error ? error.message : String(error));
    return false;
  }
}

/** Sends an intervention; shows the reason if it is refused. */
export function act(model: Model, action: Action): Promise<boolean> {
  return send(model, { command: "act", action });
}

/** Reason why this page cannot act; empty if it can. */
export function whyNot(model: Model): string {
  if (model.player) return "This is a recording: it cannot be changed";
  if (model.connection.is !== "open") return "Not connected";
  if (!model.mayAct) return "This page only watches: acting needs the teacher's address";
  return "";
}

/** Calls `f` when the result of [`whyNot`] may have changed. */
export function onRights(model: Model, f: () => void): void {
  for (const topic of ["connection", "welcome", "player"] as const) model.subscribe(topic, f);
}
