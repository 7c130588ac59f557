// The 3D view, drawn in software, with a real `eyesim view`.

import assert from "node:assert/strict";
import { cpSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { Eyesim, launch, open, skip, unfold } from "./browser.mjs";

const folder = mkdtempSync(join(tmpdir(), "eyesim-scene-"));
const [ROBOT, OTHER, CAN] = [1, 2, 1];
let browser, page, received, control;

if (!skip) {
  before(async () => {
    cpSync(fileURLToPath(new URL("room", import.meta.url)), folder, { recursive: true });
    const eyesim = await Eyesim.start(["view", "room.scene.toml", "--no-open", "--port", "0", "--paused"], { cwd: folder });
    browser = await launch(true);
    ({ page, received, control } = await open(browser, eyesim.url, { viewport: { width: 800, height: 500 } }));
    await received.until("a snapshot", ({ snapshot }) => snapshot);
    await page.waitForFunction(() => globalThis.eyesim.view?.drawn.triangles > 0);
    // On a busy machine the page may still be laid out: waits until positions in the view no longer change.
    await page.waitForFunction(() => {
      const { model, view } = globalThis.eyesim;
      const { x, y } = view.where(0, 0, 0);
      const seen = `${x} ${y} ${model.snapshot !== null}`;
      if (globalThis.seen !== seen) [globalThis.seen, globalThis.since] = [seen, performance.now()];
      return model.snapshot && performance.now() - globalThis.since > 500;
    });
  });
  after(async () => {
    Eyesim.stopAll();
    await browser.close();
    rmSync(folder, { recursive: true });
    assert.deepEqual(received.errors, []);
  });
}

const where = (...point) => page.evaluate((point) => globalThis.eyesim.view.where(...point), point);
const middle = (body) => body.body.height_m / 2;
const can = () => received.snapshot.objects.find(({ id }) => id === CAN).pose;

async function drag(from, to) {
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move((from.x + to.x) / 2, (from.y + to.y) / 2);
  await page.mouse.move(to.x, to.y);
  await page.mouse.up();
}

test("the whole world stays in view when the window becomes narrow, until the user changes the view", { skip }, async () => {
  const isWhole = () => {
    const { model, view } = globalThis.eyesim;
    const [[left, low], [right, high]] = model.scene.bounds_m;
    const box = document.querySelector("canvas").getBoundingClientRect();
    return [left, right].every((x) => [low, high].every((y) => {
      const at = view.where(x, y, 0);
      return at.x > box.left && at.x < box.right && at.y > box.top && at.y < box.bottom;
    }));
  };
  const resize = async (width, height) => {
    await page.setViewportSize({ width, height });
    await page.waitForFunction(() => {
      const { clientWidth, clientHeight } = document.querySelector("canvas");
      return Math.abs(globalThis.eyesim.view.viewCamera.camera.aspect - clientWidth / clientHeight) < 1e-3;
    });
  };
  assert(await page.evaluate(isWhole));
  await resize(360, 700);
  assert(await page.evaluate(isWhole));
  await control("canvas").focus();
  await page.keyboard.press("-");
  const distance = () => page.evaluate(() => globalThis.eyesim.view.viewCamera.camera.position.length());
  const chosen = await distance();
  await resize(800, 500);
  assert.equal(await distance(), chosen);
  await page.keyboard.press("h");
  await page.waitForFunction(() => globalThis.eyesim.view.viewCamera.transition === null);
  assert(await page.evaluate(isWhole));
});

test("dragging moves a robot and an object", { skip }, async () => {
  await control("canvas").focus();
  const z = middle(received.scene.robots[0]);
  const { x_m, y_m } = received.pose(ROBOT);
  await drag(await where(x_m, y_m, z), await where(0.9, 0.4, z));
  await received.until("the robot there", () => Math.hypot(received.pose(ROBOT).x_m - 0.9, received.pose(ROBOT).y_m - 0.4) < 0.02);
  const high = middle(received.scene.objects[0]);
  await drag(await where(can().x_m, can().y_m, high), await where(1.7, 0.3, high));
  await received.until("the can there", () => Math.hypot(can().x_m - 1.7, can().y_m - 0.3) < 0.02);
});

test("dragging with Shift turns a robot", { skip }, async () => {
  const { x_m, y_m, phi_rad } = received.pose(ROBOT);
  const from = await where(x_m + 0.02, y_m, 0);
  const to = await where(x_m, y_m + 0.3, 0);
  await page.keyboard.down("Shift");
  await drag(from, to);
  await page.keyboard.up("Shift");
  await received.until("it is turned", () => Math.abs(received.pose(ROBOT).phi_rad - phi_rad) > 0.5);
  assert(Math.hypot(received.pose(ROBOT).x_m - x_m, received.pose(ROBOT).y_m - y_m) < 1e-6, "in its place");
});

test("a click chooses a body, arrow keys move it", { skip }, async () => {
  const { x_m, y_m } = received.pose(OTHER);
  const at = await where(x_m, y_m, middle(received.scene.robots[1]));
  await page.mouse.click(at.x, at.y);
  await received.until("details of the other", ({ details }) => details.has(OTHER));
  assert.equal(await control(`robot-${OTHER}`).getAttribute("aria-selected"), "true");
  await page.keyboard.press("Shift+ArrowRight");
  await page.keyboard.press("Shift+ArrowRight");
  await received.until("it has moved", () => Math.hypot(received.pose(OTHER).x_m - x_m, received.pose(OTHER).y_m - y_m) > 0.015);
  // A body that keys have moved is placed although keys move another one before its time is up.
  const before = [ROBOT, OTHER].map((id) => received.pose(id).phi_rad);
  for (const id of [OTHER, ROBOT]) {
    await page.evaluate((id) => globalThis.eyesim.model.choose(id), id);
    await page.keyboard.press("[");
  }
  await received.until("both are turned", () => [ROBOT, OTHER].every((id, i) => Math.abs(received.pose(id).phi_rad - before[i]) > 0.08));
});

test("a picture of the view is saved", { skip }, async () => {
  await unfold(page, "save-panel");
  const [file] = await Promise.all([page.waitForEvent("download"), control("save-picture").click()]);
  const picture = readFileSync(await file.path());
  assert.equal(picture.subarray(1, 4).toString(), "PNG");
  const colours = await page.evaluate(async (src) => {
    const image = Object.assign(new Image(), { src });
    await image.decode();
    const context = new OffscreenCanvas(image.width, image.height).getContext("2d");
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    const seen = new Set();
    for (let at = 0; at < data.length; at += 4) seen.add((data[at] << 16) | (data[at + 1] << 8) | data[at + 2]);
    return seen.size;
  }, `data:image/png;base64,${picture.toString("base64")}`);
  assert(colours > 20, `${colours} colours`);
});
