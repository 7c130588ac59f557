// Display and keys of the chosen robot, drawn like the device.

import { element } from "../dom";
import type { Model } from "../model";
import type { Detail, Lcd } from "../protocol";
import { button, labelled, numberField, numberOf, section, setReason, setText, throttled } from "./control";
import { shortcut } from "./keyboard";
import { act, onRights, whyNot } from "./notice";

const KEYS = ["KEY1", "KEY2", "KEY3", "KEY4"] as const;
const REMOTE = ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "RED", "GREEN", "YELLOW", "BLUE"];
const REMOTE_TOO = ["LEFT", "RIGHT", "UP", "DOWN", "OK", "POWER"];

export function lcdPanel(model: Model): HTMLElement {
  const picture = element("img", { className: "pixels", testid: "lcd", alt: "Display; its text follows", draggable: false });
  const text = element("pre", { className: "hidden", testid: "lcd-text", label: "Text on the display" });
  const keys = KEYS.map((key, index) => {
    const pressed = button("", key.toLowerCase(), () => press(key), `${key} (${index + 1})`);
    pressed.classList.add("key");
    shortcut(String(index + 1), `Press ${key} of the chosen robot`, () => press(key));
    return pressed;
  });
  const screen = element("div", { className: "screen" }, [picture, text]);
  const device = element("div", { className: "device", testid: "device" }, [screen, element("div", { className: "keys" }, keys)]);
  const [x, y] = [numberField("touch-x", { min: "0" }), numberField("touch-y", { min: "0" })];
  const touch = button("Touch", "touch", () => void touchAt(numberOf(x), numberOf(y)));
  const touching = element("div", { className: "row" }, [labelled("x", x), labelled("y", y), touch]);
  const names = [...REMOTE, ...REMOTE_TOO].map((name) => element("option", { value: `IRTV_${name}`, textContent: name }));
  const remote = element("select", { testid: "remote" }, names);
  const send = button("Press", "remote-press", () => press(remote.value));
  const more = element("details", { testid: "more-input" }, [
    element("summary", { textContent: "Touch a place, use a remote control" }),
    touching,
    element("div", { className: "row" }, [labelled("Remote control", remote), send]),
  ]);
  const panel = section("Display and keys", "lcd-panel", true, [device, more]);

  picture.onpointerdown = (event) => {
    const lcd = chosenLcd();
    if (!lcd?.has_colours || whyNot(model)) return;
    event.preventDefault();
    const { left, top, width, height } = picture.getBoundingClientRect();
    touchAt(((event.clientX - left) / width) * lcd.size_px[0], ((event.clientY - top) / height) * lcd.size_px[1]);
  };
  const draw = throttled(drawNow, 50);
  for (const topic of ["detail", "scene", "chosen"] as const) model.subscribe(topic, draw);
  onRights(model, () => setReason([...keys, touch, send], whyNot(model)));
  return panel;

  function chosenLcd(): Lcd | undefined {
    return model.scene?.robots.find(({ id }) => id === model.chosen)?.lcd;
  }

  function press(key: string): void {
    if (model.chosen !== null && !whyNot(model)) void act(model, { do: "press", robot: model.chosen, key });
  }

  function touchAt(x: number | undefined, y: number | undefined): void {
    if (x !== undefined && y !== undefined) press(`TOUCH(${Math.floor(x)},${Math.floor(y)})`);
  }

  function drawNow(): void {
    const lcd = chosenLcd();
    const detail = model.chosen === null ? undefined : model.details.get(model.chosen);
    panel.hidden = !lcd;
    if (!lcd) return;
    device.dataset["kind"] = lcd.has_colours ? "colour" : "classic";
    screen.style.aspectRatio = lcd.size_px.join(" / ");
    touching.hidden = !lcd.has_colours;
    picture.classList.toggle("touchable", lcd.has_colours);
    showPicture(picture, text, detail);
    const menu = menuOf(detail?.lcd_text ?? [], lcd.has_colours);
    keys.forEach((key, index) => setText(key, menu[index] || `${index + 1}`));
    keys.forEach((key, index) => (key.ariaLabel = menu[index] ? `KEY${index + 1}: ${menu[index]}` : `KEY${index + 1}`));
  }
}

/** Shows the pixels, or the text alone if there are none, as in a recording. */
function showPicture(picture: HTMLImageElement, text: HTMLElement, detail: Detail | undefined): void {
  const url = detail?.lcd?.url ?? "";
  picture.hidden = url === "";
  if (url && picture.src !== url) picture.src = url;
  text.classList.toggle("hidden", url !== "");
  setText(text, (detail?.lcd_text ?? []).join("\n").trimEnd());
}

/** Texts of the four keys: the last line of the display. */
export function menuOf(lines: readonly string[], hasColours: boolean): string[] {
  const last = lines.at(-1) ?? "";
  if (!hasColours) return [0, 4, 8, 12].map((at) => last.slice(at, at + 4).trim());
  // The server has cut the blank before an empty last text.
  const texts = `${last} `.split(" | ");
  return texts.length === KEYS.length ? texts.map((text) => text.trim()) : [];
}
