// Native controls, each created by one call.

import { element } from "../dom";

/** A button; its text is its name. */
export function button(text: string, testid: string, click: () => void, title = ""): HTMLButtonElement {
  return element("button", { type: "button", textContent: text, testid, title, onclick: click });
}

/** A control preceded by its label. */
export function labelled(text: string, control: HTMLElement): HTMLLabelElement {
  return element("label", { className: "field" }, [element("span", { textContent: text }), control]);
}

/** A field for a number. */
export function numberField(testid: string, properties: Partial<HTMLInputElement> = {}): HTMLInputElement {
  return element("input", { type: "number", step: "any", testid, ...properties });
}

/** A drop-down list. */
export function choice(testid: string, label: string, change: () => void): HTMLSelectElement {
  return element("select", { testid, label, onchange: change });
}

/** A checkbox followed by its label. */
export function checkbox(text: string, testid: string, checked: boolean, change: (checked: boolean) => void) {
  const box = element("input", { type: "checkbox", testid, checked, onchange: () => change(box.checked) });
  return element("label", { className: "check" }, [box, text]);
}

/** A collapsible section, which remembers whether it is open. */
export function section(title: string, testid: string, open: boolean, children: (Node | string)[]): HTMLDetailsElement {
  const memory = `eyesim.open.${testid}`;
  const summary = element("summary", {}, [element("h2", { textContent: title })]);
  const details = element("details", { className: "panel", testid }, [summary, element("div", { className: "body" }, children)]);
  details.open = recall(memory, open ? "1" : "0") === "1";
  details.addEventListener("toggle", () => remember(memory, details.open ? "1" : "0"));
  return details;
}

/** Returns a function that schedules `draw` while the section is open; opening the section also schedules it. */
export function whileOpen(panel: HTMLDetailsElement, draw: () => void, pause_ms = 100): () => void {
  const scheduleDraw = throttled(draw, pause_ms);
  panel.addEventListener("toggle", () => panel.open && scheduleDraw());
  return () => panel.open && scheduleDraw();
}

/** Throttles `f`: calls it at once, then at most once per pause; calls during a pause run `f` once at its end. */
export function throttled(f: () => void, pause_ms = 100): () => void {
  let isPausing = false;
  let isLate = false;
  const run = () => {
    isLate = false;
    isPausing = true;
    f();
    setTimeout(() => {
      isPausing = false;
      if (isLate) run();
    }, pause_ms);
  };
  return () => {
    if (isPausing) isLate = true;
    else run();
  };
}

/** Changes a text only if it differs, which spares layout and assistive technology. */
export function setText(node: Element, text: string): void {
  if (node.textContent !== text) node.textContent = text;
}

/** Sets a value, unless the user is typing there. */
export function setValue(input: HTMLInputElement, value: string): void {
  if (document.activeElement !== input && input.value !== value) input.value = value;
}

/** Replaces the options if they differ; keeps the selected one if it still exists. */
export function setOptions(select: HTMLSelectElement, options: [value: string, text: string][]): void {
  const key = JSON.stringify(options);
  if (select.dataset["options"] === key) return;
  select.dataset["options"] = key;
  const chosen = select.value;
  select.replaceChildren(...options.map(([value, textContent]) => element("option", { value, textContent })));
  if (options.some(([value]) => value === chosen)) select.value = chosen;
}

/** Disables controls with a reason, or enables them if it is empty. */
export function setReason(controls: readonly (HTMLButtonElement | HTMLInputElement | HTMLSelectElement)[], why: string): void {
  for (const control of controls) {
    control.disabled = why !== "";
    control.dataset["title"] ??= control.title;
    control.title = why || control.dataset["title"];
  }
}

/** The number in a field; undefined if there is none. */
export function numberOf(input: HTMLInputElement): number | undefined {
  return input.value.trim() !== "" && Number.isFinite(input.valueAsNumber) ? input.valueAsNumber : undefined;
}

/** Downloads a file to the user. */
export function saveAs(name: string, content: Blob): void {
  const href = URL.createObjectURL(content);
  element("a", { href, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(href), 10_000);
}

/** Reads a stored value; the browser may forbid storage, such as for a page from disk. */
export function recall(key: string, otherwise: string): string {
  try {
    return localStorage.getItem(key) ?? otherwise;
  } catch {
    return otherwise;
  }
}

/** Stores a value for the next visit, if that is allowed. */
export function remember(key: string, value: string): void {
  try {
    localStorage.setItem(key, value);
  } catch {
    // Without storage, the page only forgets the value.
  }
}
