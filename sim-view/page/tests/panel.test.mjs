// Panels, with a server for situations that are hard to provoke with the real server.

import assert from "node:assert/strict";
import { after, before, beforeEach, afterEach, test } from "node:test";
import { launch, open, skip, unfold } from "./browser.mjs";
import { detail, events, Mock, snapshot } from "./mock.mjs";

let browser, mock, page, control, received, close;

if (!skip) {
  before(async () => (browser = await launch()));
  after(() => browser.close());
  beforeEach(async () => {
    mock = await Mock.open();
    ({ page, control, received, close } = await open(browser, mock.url));
    await received.until("a snapshot", ({ snapshot }) => snapshot);
  });
  afterEach(async () => {
    await close();
    mock.close();
    assert.deepEqual(received.errors, []);
  });
}

const texts = (locator) => locator.allTextContents();

test("the page handles 20,000 events", { skip }, async () => {
  for (let from = 1; from <= 20_000; from += 1000) mock.send({ type: "events", ...events(1000, from) });
  const last = page.locator("#events-20000");
  await last.waitFor();
  assert((await control("events").locator("[role=option]").count()) < 60, "only lines in sight are elements");
  assert.match(await control("events-count").textContent(), /^20000 of 20000 events$/);
  await control("events").press("Home");
  await page.locator("#events-1").waitFor();
  await control("events-kind").selectOption("contact");
  await control("events-robot").selectOption("1");
  const shown = control("events").locator("[role=option]").first();
  await page.waitForFunction(() => document.querySelector("[data-testid=events] [role=option]")?.dataset.kind === "contact");
  assert.match(await shown.textContent(), /eve contact/);
  await control("events-words").fill("event 19945");
  await page.waitForFunction(() => document.querySelector("[data-testid=events-count]").textContent.startsWith("1 of 20000"));
});

test("an event jumps to its robot", { skip }, async () => {
  mock.send({ type: "events", ...events(8) });
  await page.locator("#events-8").waitFor();
  await control("events").press("Home");
  await control("events").press("ArrowDown");
  await control("events").press("Enter");
  await mock.request(({ type, robot }) => type === "look" && robot === 2);
  assert.equal(await control("robot-2").getAttribute("aria-selected"), "true");
});

test("the output of the compiler stays until the next successful build", { skip }, async () => {
  assert(await control("build").isHidden());
  mock.send({ type: "build", state: "failed", output: "drive.c:3: error: expected `;` <b>\n" });
  await control("build").waitFor();
  assert.equal(await control("build-output").textContent(), "drive.c:3: error: expected `;` <b>\n");
  mock.send({ type: "build", state: "running" });
  await control("build-output").waitFor({ state: "hidden" });
  mock.send({ type: "build", state: "done" });
  await control("build").waitFor({ state: "hidden" });
});

test("a refusal is shown as a notice with its reason", { skip }, async () => {
  mock.answers = () => "the run is over";
  await control("step").click();
  await control("notice").waitFor();
  assert.match(await control("notice").textContent(), /the run is over/);
  await control("close-notice").click();
  await control("notice").waitFor({ state: "detached" });
});

test("curves are drawn, zoomed, and saved as SVG and CSV", { skip }, async () => {
  const send = (from, to) => {
    for (let slot = from; slot < to; slot++) {
      mock.send({ type: "snapshot", ...snapshot(slot / 20) });
      mock.send({ type: "detail", ...detail(1, slot / 20) });
    }
  };
  send(1, 41);
  for (const name of ["PSD_FRONT", "PSD_LEFT", "true heading"]) await page.getByLabel(`Plot ${name}`, { exact: true }).check();
  await control("plot").locator("canvas").waitFor();
  const ink = () =>
    control("plot").locator("canvas").evaluate((canvas) => {
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      const colours = new Set();
      for (let at = 0; at < data.length; at += 4) if (data[at + 3] === 255) colours.add(data.slice(at, at + 3).join());
      return colours.size;
    });
  await page.waitForFunction(() => document.querySelector("[data-testid=plot]").getAttribute("aria-label").includes("true heading"));
  assert((await ink()) >= 3, "each curve has its colour");

  const download = async (button) => {
    const [file] = await Promise.all([page.waitForEvent("download"), control(button).click()]);
    const parts = [];
    for await (const part of await file.createReadStream()) parts.push(part);
    return Buffer.concat(parts).toString();
  };
  const rows = (await download("plot-csv")).trim().split("\n");
  assert.equal(rows[0], "t_s,PSD_FRONT (mm),PSD_LEFT (mm),true heading (°)");
  assert.equal(rows.length, 41);
  const [t_s, front] = rows[20].split(",").map(Number);
  assert.equal(t_s, 1);
  assert(Math.abs(front - (300 + 200 * Math.sin(1))) < 1e-9);
  const svg = await download("plot-svg");
  assert.equal(svg.match(/<path fill="none"/g).length, 6, "three curves and their keys");
  await control("plot-in").click();
  assert((await download("plot-csv")).trim().split("\n").length < 30);

  await control("plot-pause").click();
  await control("plot-clear").click();
  assert.equal((await download("plot-csv")).trim(), "t_s");
});

test("noise models are set by slider, by number and for all robots, and are reset", { skip }, async () => {
  await unfold(page, "noise-panel");
  mock.send({ type: "detail", ...detail(1, 1) });
  await page.locator("[data-group=psd] > summary").click();
  const asked = (value, robot = 1) =>
    mock.request(({ command }) => {
      const action = command?.action;
      return action?.do === "set_noise" && action.robot === robot && Math.abs(action.value - value) < 1e-9;
    });
  await control("noise-psd.sigma_mm").fill("7.5");
  await control("noise-psd.sigma_mm").press("Enter");
  assert.equal((await asked(7.5)).command.action.parameter, "psd.sigma_mm");
  await control("noise-slider-psd.dropout").press("End");
  assert.equal((await asked(1)).command.action.parameter, "psd.dropout");
  await control("noise-whom").selectOption("all");
  await control("noise-psd.sigma_mm").fill("9");
  await control("noise-psd.sigma_mm").press("Enter");
  await asked(9, null);
  await control("noise-whom").selectOption("this");
  const changed = detail(1, 2);
  changed.noise[0].value = 9;
  mock.send({ type: "detail", ...changed });
  await page.waitForFunction(() => document.querySelector("[data-testid='noise-psd.sigma_mm']").value === "9");
  await control("noise-reset").click();
  assert.equal((await asked(2)).command.action.parameter, "psd.sigma_mm");
});

test("noise of all robots is reset by one command after the other", { skip }, async () => {
  await unfold(page, "noise-panel");
  for (const robot of [2, 1]) {
    const seen = detail(robot, 1);
    seen.noise[0].value = robot;
    await page.evaluate((robot) => globalThis.eyesim.model.choose(robot), robot);
    mock.send({ type: "detail", ...seen });
    await page.waitForFunction((value) => document.querySelector("[data-testid='noise-psd.sigma_mm']")?.value === value, String(robot));
  }
  const values = () => mock.requests.flatMap(({ command }) => (command?.action?.do === "set_noise" ? [command.action] : []));
  await control("noise-whom").selectOption("all");
  await control("noise-reset").click();
  await mock.request(({ command }) => command?.action?.robot === 2);
  assert.deepEqual(values().map(({ robot }) => robot), [null, null, null, null, 2], "robot 2 had another value");
  assert.deepEqual([values()[0], values()[4]].map(({ parameter, value }) => [parameter, value]), [["psd.sigma_mm", 1], ["psd.sigma_mm", 2]]);
  mock.answers = () => "the run is over";
  await control("noise-reset").click();
  await control("notice").waitFor();
  assert.equal(values().length, 6, "the first refusal ends it");
});

test("what is no number is no speed", { skip }, async () => {
  await control("speed-exact").click();
  await page.keyboard.press("Control+A");
  await page.keyboard.type("1e");
  await page.keyboard.press("Enter");
  assert.equal(await control("speed-exact").inputValue(), "1");
  await control("speed-exact").fill("");
  await control("speed-exact").press("Enter");
  await mock.request(({ command }) => command?.command === "speed");
  assert.equal(mock.requests.filter(({ command }) => command?.command === "speed").length, 1, "an empty field is one");
});

test("a page that reconnects discards what it had", { skip }, async () => {
  const shown = (text) => page.waitForFunction((text) => document.querySelector("[data-testid=events-count]").textContent === text, text);
  mock.send({ type: "events", ...events(8) });
  mock.send({ type: "detail", ...detail(1, 9) });
  await shown("8 of 8 events");
  mock.cut();
  await received.until("another welcome", ({ welcomes }) => welcomes.length === 2);
  mock.send({ type: "events", ...events(8), missed: 3 });
  await shown("8 of 8 events, 3 more left out");
  assert.equal(await page.evaluate(() => globalThis.eyesim.model.history.size), 0);
});

test("a page of another version shows the mismatch", { skip }, async () => {
  mock.welcome = { ...mock.welcome, protocol: 99, version: "9.9.9" };
  mock.cut();
  await control("banner").getByText("version").waitFor();
  assert.match(await control("banner-text").textContent(), /9\.9\.9/);
});

test("a page that may only watch shows this and offers no controls", { skip }, async () => {
  mock.welcome = { ...mock.welcome, may_act: false };
  mock.cut();
  await control("banner").getByText("watching").waitFor();
  for (const testid of ["run-pause", "step", "speed", "restart", "restart-new", "key1"]) {
    assert(await control(testid).isDisabled(), testid);
    assert.match(await control(testid).getAttribute("title"), /only watches/);
  }
});

test("the help lists the keys and returns the focus", { skip }, async () => {
  await control("robots").focus();
  await page.keyboard.press("?");
  await control("help").waitFor();
  const keys = await texts(control("help").locator("dt"));
  for (const key of ["Space", ".", "1", "?"]) assert(keys.includes(key), `${key} in ${keys}`);
  await page.keyboard.press("Escape");
  await control("help").waitFor({ state: "hidden" });
  assert(await control("robots").evaluate((list) => list === document.activeElement));
});

test("the page fits in 320 pixels, as at 400 % zoom", { skip }, async () => {
  await page.setViewportSize({ width: 320, height: 600 });
  mock.send({ type: "detail", ...detail(2, 1) });
  await unfold(page, "noise-panel", "edit-panel", "save-panel", "calls-panel", "sensors-panel");
  const [room, needed] = await page.evaluate(() => [innerWidth, document.documentElement.scrollWidth]);
  assert(needed <= room, `${needed} pixels wide in ${room}`);
});

for (const colorScheme of ["light", "dark"]) {
  test(`texts are legible and controls have names, ${colorScheme}`, { skip }, async () => {
    await page.emulateMedia({ colorScheme, reducedMotion: "reduce" });
    mock.send({ type: "detail", ...detail(1, 1) });
    mock.send({ type: "events", ...events(20) });
    mock.send({ type: "build", state: "failed", output: "wrong" });
    await page.evaluate(() => document.querySelectorAll("details").forEach((section) => (section.open = true)));
    await control("sensor-PSD_FRONT").waitFor();
    await control("build-output").waitFor();
    const [faint, nameless] = await page.evaluate(findFaults);
    assert.deepEqual(faint, []);
    assert.deepEqual(nameless, []);
  });
}

/**
 * Returns the texts with a contrast below 4.5 (except the scale, which has the 3D view behind it) and the controls without a name. Runs
 * in the page.
 */
function findFaults() {
  const context = Object.assign(document.createElement("canvas"), { width: 1, height: 1 }).getContext("2d", { willReadFrequently: true });
  const over = (colours) => {
    context.clearRect(0, 0, 1, 1);
    for (const colour of colours) {
      context.fillStyle = colour;
      context.fillRect(0, 0, 1, 1);
    }
    return [...context.getImageData(0, 0, 1, 1).data].slice(0, 3);
  };
  const luminance = (rgb) => {
    const [r, g, b] = rgb.map((level) => (level <= 10 ? level / 255 / 12.92 : ((level / 255 + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const faint = new Set();
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let text; (text = texts.nextNode()); ) {
    const element = text.parentElement;
    if (text.data.trim() === "" || !element.checkVisibility({ opacityProperty: true, visibilityProperty: true })) continue;
    if (element.closest(":disabled, option, .hidden, .scale-bar")) continue;
    const below = [];
    for (let at = element; at; at = at.parentElement) below.unshift(getComputedStyle(at).backgroundColor);
    const ground = over(below);
    const ink = over([`rgb(${ground})`, getComputedStyle(element).color]);
    const [light, dark] = [luminance(ground), luminance(ink)].sort((a, b) => b - a);
    if ((light + 0.05) / (dark + 0.05) < 4.5) faint.add(`${element.className || element.tagName}: ${text.data.trim()} ${ink} on ${ground}`);
  }
  const nameless = [...document.querySelectorAll("button, input, select, summary, [role=listbox], [tabindex='0']")]
    .filter((control) => control.checkVisibility())
    .filter((control) => !(control.ariaLabel || control.labels?.[0]?.textContent || control.textContent).trim())
    .map((control) => control.outerHTML);
  return [[...faint], nameless];
}

test("checks show their verdicts, and metrics a curve", { skip }, async () => {
  assert(await control("checks-panel").isHidden(), "a scene without checks has no panel");
  const checks = (verdict, value) => [
    { name: "the goal", verdict, text: "at 2.000 s <b>", value: null },
    { name: "together", verdict: "open", text: "300 mm", value },
  ];
  for (const [t_s, value] of [[1, 100], [2, 300], [3, 200]])
    mock.send({ type: "snapshot", ...snapshot(t_s, { is: "running" }, checks(t_s < 2 ? "open" : "met", value)) });
  await page.waitForFunction(() => document.querySelector("[data-testid=checks] polyline")?.getAttribute("points")?.split(" ").length === 3);
  const rows = control("checks").locator("li");
  assert.equal(await rows.first().getAttribute("data-is"), "met");
  assert.match(await rows.first().textContent(), /metthe goalat 2.000 s <b>/);
  assert.equal(await rows.nth(1).locator("polyline").getAttribute("points"), "0.00,22.00 50.00,2.00 100.00,12.00");
});
