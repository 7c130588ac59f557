// Keys that work anywhere on the page, and their list for the help.

/** A key and its effect. */
export interface Shortcut {
  /** As in `KeyboardEvent.key`. */
  key: string;
  /** Its name, if the key is not a letter. */
  name?: string;
  what: string;
  run: () => void;
}

const shortcuts: Shortcut[] = [];

/** Registers a key. */
export function shortcut(key: string, what: string, run: () => void, name = key): void {
  shortcuts.push({ key, name, what, run });
}

/** All registered keys. */
export function allShortcuts(): readonly Shortcut[] {
  return shortcuts;
}

/** Handles registered keys, except in text fields. Space on a focused control activates the control instead. */
export function listen(): void {
  document.addEventListener("keydown", (event) => {
    if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
    const target = event.target instanceof Element ? event.target : document.body;
    if (target.closest("input:not([type=checkbox], [type=radio], [type=range]), textarea, select, dialog")) return;
    if (event.key === " " && target.closest("button, summary, input, a")) return;
    const found = shortcuts.find(({ key }) => key === event.key);
    if (!found) return;
    event.preventDefault();
    if (!event.repeat || found.key === ".") found.run();
  });
}
