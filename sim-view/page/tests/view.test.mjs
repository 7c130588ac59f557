// Every control of the page, with a real `eyesim view`; the tests check the messages of the simulation.

import assert from "node:assert/strict";
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { Eyesim, launch, open, skip, unfold } from "./browser.mjs";

const folder = mkdtempSync(join(tmpdir(), "eyesim-view-"));
const [KEYS, TOUCH, CAN] = [1, 2, 1];
let browser, eyesim, page, received, control, close;

if (!skip) {
  before(async () => {
    cpSync(fileURLToPath(new URL("room", import.meta.url)), folder, { recursive: true });
    eyesim = await Eyesim.start(["view", "room.scene.toml", "--no-open", "--port", "0"], { cwd: folder });
    browser = await launch();
    ({ page, received, control, close } = await open(browser, eyesim.url, { hasTouch: true, acceptDownloads: true }));
    await received.until("a snapshot", ({ snapshot }) => snapshot);
  });
  after(async () => {
    await close?.();
    await browser?.close();
    Eyesim.stopAll();
    rmSync(folder, { recursive: true });
    assert.deepEqual(received.errors, []);
  });
}

const state = (is) => received.until(is, ({ snapshot }) => snapshot.state.is === is);
const lcd = (robot, text) =>
  received.until(`"${text}" on the display`, ({ details }) => details.get(robot)?.lcd_text.join("\n").includes(text));
const isNear = (a, b, tolerance = 1e-6) => Math.abs(a - b) <= tolerance;

test("the page shows the scene", { skip }, async () => {
  assert.deepEqual(received.scene.robots.map(({ program }) => program.split("/").at(-1)), ["panel.c", "touch.c"]);
  assert.equal(await control("robots").locator("[role=option]").count(), 2);
  await lcd(KEYS, "ready");
  await page.waitForFunction(() => document.querySelector("[data-testid=key1]").textContent === "GO");
  assert.match(await control("lcd-text").textContent(), /ready/);
  await page.waitForFunction(() => document.querySelector("[data-testid=lcd]").naturalWidth > 0);
});

test("pause, single slots, run", { skip }, async () => {
  await control("run-pause").click();
  await state("paused");
  const { t_s } = received.snapshot;
  const { slot_s } = received.scene;
  for (const slot of [1, 2, 3]) {
    await control("step").click();
    await received.until("a slot more", ({ snapshot }) => isNear(snapshot.t_s, t_s + slot * slot_s));
  }
  assert.equal(received.snapshot.state.is, "paused");
  await control("run-pause").click();
  await state("running");
  await received.until("time goes on", ({ snapshot }) => snapshot.t_s > t_s + 5 * slot_s);
});

test("speed from slow motion to as fast as possible", { skip }, async () => {
  await control("speed").press("Home");
  await received.until("slow motion", ({ snapshot }) => snapshot.speed === 0.01 && snapshot.rate < 0.05);
  await control("speed-exact").fill("3.5");
  await control("speed-exact").press("Enter");
  await received.until("3.5", ({ snapshot }) => snapshot.speed === 3.5);
  // Ten times slow motion: a loaded machine may not reach real time.
  await received.until("faster", ({ snapshot }) => snapshot.rate > 0.1);
  await control("speed").press("End");
  await received.until("as fast as possible", ({ snapshot }) => snapshot.speed === null && snapshot.rate > 0.1);
  await control("speed-exact").fill("1");
  await control("speed-exact").press("Enter");
  await received.until("real time", ({ snapshot }) => snapshot.speed === 1);
});

test("restart with the same, a new and a chosen seed", { skip }, async () => {
  const { run } = received.scene;
  const again = (what, is) => received.until(what, ({ scene, snapshot }) => is(scene) && snapshot.run === scene.run && snapshot.t_s > 0);
  await control("restart").click();
  await again("the same seed", (scene) => scene.run === run + 1 && scene.seed === "7");
  await control("restart-new").click();
  await again("a new seed", (scene) => scene.run === run + 2 && scene.seed !== "7");
  // The browser shows the title when the text in the field is no seed.
  assert.match(await control("seed").getAttribute("title"), /^A whole number from 0; the seed of this run is \d+$/);
  await control("seed").fill("18446744073709551615");
  await control("restart-seed").click();
  await again("that seed", (scene) => scene.run === run + 3 && scene.seed === "18446744073709551615");
});

test("keys by mouse, keyboard and touch reach the program", { skip }, async () => {
  await lcd(KEYS, "ready");
  await control("key1").click();
  await lcd(KEYS, "go");
  await received.until("it drives", () => received.robot(KEYS).motion.some(({ v_m_per_s }) => isNear(v_m_per_s, 0.1)));
  await page.keyboard.press("2");
  await lcd(KEYS, "stop");
  await received.until("it stands", () => received.robot(KEYS).motion.every(({ v_m_per_s }) => v_m_per_s === 0));
  await control("key3").tap();
  await lcd(KEYS, "third");
});

test("a touch of the display reaches the program with its position", { skip }, async () => {
  await control("robots").press("End");
  await received.until("details of the other robot", ({ details }) => details.get(TOUCH)?.lcd);
  const [width, height] = received.scene.robots[1].lcd.size_px;
  await page.waitForFunction(() => document.querySelector("[data-testid=lcd]").naturalWidth > 0);
  await control("lcd").waitFor({ state: "visible" });
  const box = await control("lcd").boundingBox();
  await control("lcd").click({ position: { x: box.width / 4, y: box.height / 2 } });
  const touched = await received.until("a touch", ({ details }) => /touched (\d+) (\d+)/.exec(details.get(TOUCH).lcd_text.join()));
  assert(isNear(Number(touched[1]), width / 4, 2) && isNear(Number(touched[2]), height / 2, 2), touched[0]);
  await unfold(page, "more-input");
  await control("touch-x").fill("11");
  await control("touch-y").fill("22");
  await control("touch").click();
  await lcd(TOUCH, "touched 11 22");
});

test("camera images are requested only while they are shown", { skip }, async () => {
  await control("robots").press("Home");
  await received.until("an image", ({ details }) => details.get(KEYS)?.camera);
  await page.waitForFunction(() => document.querySelector("[data-testid=camera]").naturalWidth > 0);
  await control("camera-panel").locator("summary").click();
  await received.until("no image", ({ details }) => details.get(KEYS).camera === null);
  await control("camera-panel").locator("summary").click();
});

test("readings are in the table, and plotted when they are ticked", { skip }, async () => {
  const reading = await received.until("a reading", () => received.reading(KEYS, "PSD_FRONT"));
  assert.equal(reading.unit, "m");
  const shown = page.locator("[data-reading=PSD_FRONT] td.number").first();
  await page.waitForFunction((text) => document.querySelector("[data-reading=PSD_FRONT] td.number").textContent === text, shownText(reading.value));
  assert.match(await shown.textContent(), /mm$/);
  await page.getByLabel("Plot PSD_FRONT", { exact: true }).check();
  await control("plot").locator("canvas").waitFor();
});

function shownText(value_m) {
  const mm = value_m * 1000;
  return `${Number.isInteger(mm) ? mm : mm.toFixed(1)} mm`;
}

test("changes of noise models take effect immediately, and are reset", { skip }, async () => {
  await unfold(page, "noise-panel");
  await page.locator("[data-group=psd] > summary").click();
  const parameter = (name) => received.details.get(KEYS).noise.find((one) => one.name === name).value;
  assert.equal(parameter("psd.sigma_mm"), 0);
  await control("noise-psd.sigma_mm").fill("40");
  await control("noise-psd.sigma_mm").press("Enter");
  await received.until("noise", () => parameter("psd.sigma_mm") === 40);
  const values = new Set();
  await received.until("readings differ", () => values.add(received.reading(KEYS, "PSD_FRONT").value).size > 4);
  await control("noise-slider-psd.dropout").press("End");
  await received.until("drop-outs", () => parameter("psd.dropout") === 1 && received.reading(KEYS, "PSD_FRONT").value === null);
  await control("noise-psd.sigma_mm").fill("-5");
  await control("noise-psd.sigma_mm").press("Enter");
  await control("notice").first().waitFor();
  assert(received.answers.at(-1).refused, "less than nothing is refused");
  await control("noise-reset").click();
  await received.until("no noise", () => parameter("psd.sigma_mm") === 0 && parameter("psd.dropout") === 0);
  await received.until("exact readings", () => received.reading(KEYS, "PSD_FRONT").value !== null);
});

test("a sensor that is switched off detects nothing", { skip }, async () => {
  await unfold(page, "sensors-panel");
  const isOn = () => received.details.get(KEYS).sensors.find(({ name }) => name === "PSD_FRONT").is_on;
  for (let round = 0; round < 5; round++) {
    await control("sensor-PSD_FRONT").uncheck();
    await received.until("it is off", () => !isOn() && received.reading(KEYS, "PSD_FRONT").value === null);
    await control("sensor-PSD_FRONT").check();
    await received.until("it is on", () => isOn() && received.reading(KEYS, "PSD_FRONT").value !== null);
  }
  // Two quick changes: the switch keeps the last position, even if older states arrive meanwhile.
  const seen = await control("sensor-PSD_FRONT").evaluate((box) => {
    const seen = new Set();
    const end = performance.now() + 500;
    box.click();
    box.click();
    return new Promise((resolve) => {
      const look = () => {
        seen.add(box.checked);
        if (performance.now() < end) requestAnimationFrame(look);
        else resolve([...seen]);
      };
      look();
    });
  });
  assert.deepEqual(seen, [true]);
  await received.until("it is on", () => isOn() && received.reading(KEYS, "PSD_FRONT").value !== null);
});

test("RoBIOS calls are listed while the section is open, filtered and copied", { skip }, async () => {
  assert(!received.events.some(({ kind }) => kind === "call"));
  await unfold(page, "calls-panel");
  await received.until("calls", ({ events }) => events.some(({ kind, text }) => kind === "call" && text.includes("PSDGet")));
  await control("calls-words").fill("OSWait");
  const first = control("calls").locator("[role=option]").first();
  await page.waitForFunction(() => {
    const shown = [...document.querySelectorAll("[data-testid=calls] [role=option]")];
    return shown.length > 0 && shown.every((row) => row.textContent.includes("OSWait"));
  });
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
  await control("calls-copy").click();
  await page.getByText(/calls copied/).waitFor();
  assert.match(await page.evaluate(() => navigator.clipboard.readText()), /^\d+\.\d{6} OSWait\(50\)/);
  assert.match(await first.textContent(), /OSWait\(50\)/);
  await control("calls-clear").click();
  await control("calls-panel").evaluate((section) => (section.open = false));
});

test("a robot and an object are placed by numbers and steps", { skip }, async () => {
  await unfold(page, "edit-panel");
  await control("edit-which").selectOption(`robot ${KEYS}`);
  await place(600, 250, 90);
  const at = (pose, x_mm, y_mm, turn_deg) =>
    pose && isNear(pose.x_m * 1000, x_mm, 0.6) && isNear(pose.y_m * 1000, y_mm, 0.6) && isNear(Math.cos(pose.phi_rad - (turn_deg * Math.PI) / 180), 1, 1e-3);
  const robotAt = (...place) => received.until(`the robot at ${place}`, () => at(received.pose(KEYS), ...place));
  await robotAt(600, 250, 90);
  const steps = { "edit-right": [650, 250, 90], "edit-up": [650, 300, 90], "edit-left": [600, 300, 90], "edit-down": [600, 250, 90] };
  for (const [step, pose] of Object.entries({ ...steps, "edit-turn-left": [600, 250, 105], "edit-turn-right": [600, 250, 90] })) {
    await control(step).click();
    await robotAt(...pose);
  }
  await control("edit-which").selectOption(`object ${CAN}`);
  await place(1200, 800, 0);
  const can = () => received.snapshot.objects.find(({ id }) => id === CAN)?.pose;
  await received.until("the can is there", () => at(can(), 1200, 800, 0));
});

async function place(x_mm, y_mm, turn_deg) {
  await control("edit-x").fill(String(x_mm));
  await control("edit-y").fill(String(y_mm));
  await control("edit-heading").fill(String(turn_deg));
  await control("edit-place").click();
}

test("robots and objects are added and removed", { skip }, async () => {
  const add = async (kind, x_mm, y_mm) => {
    await control("add-kind").selectOption(kind);
    await control("add-x").fill(String(x_mm));
    await control("add-y").fill(String(y_mm));
    await control("add").click();
  };
  await control("add-kind").selectOption("robot S4");
  await control("add-program").selectOption(String(KEYS));
  await add("robot S4", 1500, 300);
  const robot = await received.until("a third robot", ({ scene }) => scene.robots.find(({ id }) => id > TOUCH));
  assert.match(robot.program, /panel\.c$/);
  await received.until("it stands there", () => isNear(received.pose(robot.id)?.x_m, 1.5));
  await lcd(robot.id, "ready");
  await control("edit-remove").click();
  await received.until("it is gone", ({ scene, snapshot }) => scene.robots.length === 2 && snapshot.robots.length === 2);

  await add("object Can", 1700, 300);
  const object = await received.until("a second can", ({ scene }) => scene.objects.find(({ id }) => id > CAN));
  await received.until("it stands there", ({ snapshot }) => isNear(snapshot.objects.find(({ id }) => id === object.id)?.pose.x_m, 1.7));
  await page.waitForFunction((name) => document.querySelector("[data-testid=edit-which]").value === name, `object ${object.id}`);
  await control("edit-remove").click();
  await received.until("it is gone", ({ scene, snapshot }) => scene.objects.length === 1 && snapshot.objects.length === 1);
});

test("the current state of the scene is saved", { skip }, async () => {
  await unfold(page, "save-panel");
  const save = async (button) => {
    const [file] = await Promise.all([page.waitForEvent("download"), control(button).click()]);
    return readFileSync(await file.path());
  };
  const scene = String(await save("save-scene"));
  assert.match(scene, /x_mm = 600/, "the robot is where it was put");
  writeFileSync(join(folder, "saved.scene.toml"), scene);
});

test("events are listed and jump to their robot", { skip }, async () => {
  const { number, robot } = await received.until("a key", ({ events }) => events.find(({ kind }) => kind === "key"));
  await control("robots").press("End");
  await control("events-kind").selectOption("key");
  await page.locator(`#events-${number}`).click();
  await page.waitForFunction((id) => document.querySelector(`[data-testid=robot-${id}]`).getAttribute("aria-selected") === "true", robot);
});

test("a page that connects later shows the same state", { skip }, async () => {
  const second = await open(browser, eyesim.url);
  await second.received.until("the run", ({ snapshot }) => snapshot);
  assert.equal(second.received.scene.seed, received.scene.seed);
  await second.control("run-pause").click();
  await state("paused");
  await second.control("run-pause").click();
  await state("running");
  await second.close();
});
