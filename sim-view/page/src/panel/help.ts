// The keys of the page.

import { element } from "../dom";
import type { Model } from "../model";
import { button } from "./control";
import { allShortcuts, shortcut } from "./keyboard";

/** Keys that depend on the focus. */
const ELSEWHERE: [keys: string, what: string][] = [
  ["Tab, Shift+Tab", "To the next or previous control"],
  ["↑ ↓ Home End", "In the list of robots: choose; in other lists: move"],
  ["Enter", "In the list of events: jump there; in fields: do it"],
  ["Arrows, + -", "In the 3D view: look from elsewhere, nearer, farther"],
  ["Alt+arrows", "In the 3D view: shift it"],
  ["Page Up, Page Down", "In the 3D view: choose another robot"],
  ["Shift+arrows, [ ]", "In the 3D view: move and turn what is selected"],
  ["Escape", "Close this help; in the 3D view: leave what is moved where it was"],
];

export function helpPanel(_model: Model): HTMLElement {
  const list = element("dl");
  const close = button("Close", "help-close", () => dialog.close());
  const dialog = element("dialog", { testid: "help", label: "Keys" }, [element("h2", { textContent: "Keys" }), list, close]);
  const open = button("?", "help-open", show, "Keys (?)");
  open.ariaLabel = "Help: keys";
  shortcut("?", "This help", show);
  return element("div", { className: "bar" }, [open, dialog]);

  function show(): void {
    const rows = new Map<string, string[]>();
    for (const { key, name, what } of allShortcuts()) rows.set(what, [...(rows.get(what) ?? []), name ?? key]);
    const all = [...[...rows].map(([what, keys]): [string, string] => [keys.join(", "), what]), ...ELSEWHERE];
    list.replaceChildren(...all.flatMap(([keys, what]) => [element("dt", {}, [element("kbd", { textContent: keys })]), element("dd", { textContent: what })]));
    if (!dialog.open) dialog.showModal();
  }
}
