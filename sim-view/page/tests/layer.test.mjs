// Contents of the 3D view, with a server that simulates a crowd; no simulator is needed.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { launch, skip } from "./browser.mjs";
import { crowd } from "./crowd.mjs";

const COUNT = 12;
let mock, browser, page;

if (!skip) {
  before(async () => {
    mock = await crowd(COUNT);
    browser = await launch(true);
    page = await browser.newPage({ viewport: { width: 480, height: 320 } });
    // The tests count the calls of WebGL; the drawing itself would take seconds without a graphics card.
    await page.addInitScript(() => {
      const { prototype } = WebGL2RenderingContext;
      for (const name of ["clear", "drawArrays", "drawArraysInstanced", "drawElements", "drawElementsInstanced"]) prototype[name] = () => {};
    });
    await page.goto(mock.url);
    await page.waitForFunction(() => globalThis.eyesim?.view?.drawn.triangles > 0);
  });
  after(async () => {
    await browser.close();
    mock.close();
  });
}

/** Returns the counts of the first frame drawn after the frame with this number. */
const afterFrame = async (frames) => {
  await page.waitForFunction((frames) => globalThis.eyesim.view.times.frames > frames, frames);
  return page.evaluate(() => ({ ...globalThis.eyesim.view.drawn }));
};
/** Calls `what` and returns the counts of the next frame drawn after the call began. */
const drawn = async (what) => {
  const frames = await page.evaluate(() => globalThis.eyesim.view.times.frames);
  await what();
  return afterFrame(frames);
};
/** Switches a layer; returns the counts of the next frame, whose number is read together with the switch: a frame that was due before
 * does not count. */
const toggle = async (layer) =>
  afterFrame(
    await page.getByTestId(`layer-${layer}`).evaluate((box) => {
      box.click();
      return globalThis.eyesim.view.times.frames;
    }),
  );
const at = (t_s, turn = 0) => ({
  type: "snapshot",
  run: 1,
  t_s,
  state: { is: "paused" },
  speed: 1,
  rate: 0,
  robots: Array.from({ length: COUNT }, (_, i) => ({
    id: i + 1,
    motion: [{ t_s, from: { x_m: 0.2 + 0.1 * i, y_m: 1, phi_rad: turn }, v_m_per_s: 0, left_m_per_s: 0, omega_rad_per_s: 0, lasts_s: 0.05 }], lift_m: 0, joints_rad: [],
    standing: "running",
    now_s: t_s,
    why: "",
    is_stalled: false,
  })),
  objects: [],
  checks: [],
  beams: [{ robot: 1, sensor: 0, from_m: [0.2, 1, 0.05], to_m: [0.2, 1.3, 0.05], is_hit: true }],
});

test("each layer is drawn unless it is switched off", { skip }, async () => {
  await drawn(async () => mock.send(at(0.05)));
  const { run } = mock.scene;
  mock.send({ type: "detail", ...detail(run) });
  await page.waitForFunction(() => globalThis.eyesim.model.details.get(1)?.scan);
  for (const layer of ["walls", "robots", "surroundings", "rings", "labels", "beams", "scan", "frusta", "odometry", "axes", "grid", "shadows"]) {
    const isOn = await page.getByTestId(`layer-${layer}`).isChecked();
    if (!isOn) await toggle(layer);
    const without = await toggle(layer);
    const withIt = await toggle(layer);
    assert(withIt.calls > without.calls, `${layer}: ${without.calls} draw calls without, ${withIt.calls} with it`);
    if (!isOn) await toggle(layer);
  }
});

test("the layers of the chosen robot's program are drawn, each once", { skip }, async () => {
  const { run } = mock.scene;
  let t_s = 0;
  /** Sends a layer; returns the counts once the page has drawn it. */
  const show = async (name, content, robot = 1) => {
    const frame = { x_m: 0.2, y_m: 0.1, phi_rad: 0.3 };
    mock.send({ type: "layer", run, robot, name, t_s: ++t_s, frame, content });
    const has = ([robot, name, t_s]) => globalThis.eyesim.model.layers.get(robot)?.get(name)?.t_s === t_s;
    await page.waitForFunction(has, [robot, name, t_s]);
    return settled();
  };
  /** Returns the counts once no frame changes any more. */
  const settled = async () => {
    for (let frame = 0; frame < 3; frame++) await page.evaluate(() => new Promise((done) => requestAnimationFrame(done)));
    return page.evaluate(() => ({ calls: globalThis.eyesim.view.drawn.calls, ...globalThis.eyesim.view.memory }));
  };
  const map = (...cells) => ({ kind: "grid", corner_m: [0, 0], cell_m: 0.5, columns: 2, rows: cells.length / 2, cells: Buffer.from(cells).toString("base64") });
  const positions = Buffer.from(Float32Array.of(0, 0, 0, 0.5, 0, 0.2, 1, 0.5, 0).buffer).toString("base64");
  await page.evaluate(() => globalThis.eyesim.model.choose(1));
  // Nothing has moved, so shadows are not drawn again.
  for (let frame = 0; frame < 2; frame++) await drawn(async () => mock.send(at(0.05)));
  const none = await settled();
  assert.equal((await show("map", map(0, 100, 255, 50))).calls, none.calls + 1);
  assert.equal((await show("hits", { kind: "points", positions })).calls, none.calls + 2);
  const all = await show("way", { kind: "line", positions });
  assert.equal(all.calls, none.calls + 3);
  // Other contents replace the earlier ones and take no more memory.
  for (const cells of [[0, 0, 0, 0, 0, 0], [1, 2]]) assert.deepEqual(await show("map", map(...cells)), all);
  assert.equal((await show("hits", { kind: "points", positions: "" })).calls, none.calls + 2, "no points");
  assert.equal((await show("map", map(9, 9), 2)).calls, none.calls + 2, "of another robot");
  assert.equal((await toggle("program")).calls, none.calls);
  assert.equal((await toggle("program")).calls, none.calls + 2);
  await page.evaluate(() => globalThis.eyesim.model.choose(2));
  const other = await settled();
  assert.equal((await toggle("program")).calls, other.calls - 1);
  assert.equal((await toggle("program")).calls, other.calls);
  await page.evaluate(() => globalThis.eyesim.model.choose(1));
});

test("a message in flight is drawn with its outcome", { skip }, async () => {
  const fields = { from: 1, message: 1, arrived_s: 0.05, bit_errors: 0 };
  await drawn(async () => mock.send(at(0.05)));
  // Nothing has moved, so shadows are not drawn again.
  const still = await drawn(async () => mock.send(at(0.05)));
  const event = (number, kind) => ({ number, t_s: 0.05, robot: 2, kind, text: "", fields });
  mock.send({ type: "events", events: [event(1, "radio_arrived"), event(2, "radio_lost")], missed: 0 });
  // The message's line and its head.
  await page.waitForFunction((calls) => globalThis.eyesim.view.drawn.calls === calls + 2, still.calls);
  // The run is paused, so both messages stay visible.
  await page.waitForTimeout(1500);
  assert.equal(await page.evaluate(() => globalThis.eyesim.view.drawn.calls), still.calls + 2);
});

test("the displayed time advances smoothly between snapshots", { skip }, async () => {
  const timer = mock.start();
  await page.waitForFunction(() => globalThis.eyesim.model.snapshot.t_s > 1);
  const samples = await page.evaluate(async () => {
    const found = [];
    while (found.length < 60) {
      await new Promise((done) => requestAnimationFrame(done));
      found.push([globalThis.eyesim.model.clock.t_s, globalThis.eyesim.model.snapshot.t_s]);
    }
    return found;
  });
  clearInterval(timer);
  for (const [i, [shown_s, latest_s]] of samples.entries()) {
    assert(i === 0 || shown_s >= samples[i - 1][0], "it never goes back");
    assert(shown_s <= latest_s + 0.05 + 1e-9, `${shown_s} s is shown, but nothing is known after the slot that begins at ${latest_s} s`);
  }
  const passed_s = samples.at(-1)[0] - samples[0][0];
  assert(passed_s > 0, "it goes on");
});

test("restarted runs take no more memory", { skip }, async () => {
  const memory = () => page.evaluate(() => ({ ...globalThis.eyesim.view.memory }));
  const restart = async (run) => {
    mock.scene.run = run;
    mock.send({ type: "scene", ...mock.scene });
    mock.send({ ...at(0.05), run });
    await page.waitForFunction((run) => globalThis.eyesim.model.snapshot?.run === run, run);
    // The page may draw the scene before it has received the snapshot.
    for (let frame = 0; frame < 3; frame++) await page.evaluate(() => new Promise((done) => requestAnimationFrame(done)));
  };
  await restart(2);
  const before = await memory();
  for (let run = 3; run < 8; run++) await restart(run);
  assert.deepEqual(await memory(), before);
});

function detail(run) {
  const pose = { x_m: 0.2, y_m: 1, phi_rad: 0 };
  const scan = { from_m: [0.2, 1, 0.05], points_m: [[0.5, 1, 0.05], [0.5, 1.02, 0.05], [0.5, 1.04, 0.05]] };
  return { run, robot: 1, t_s: 0.05, pose, odometry: pose, lcd: null, lcd_text: [], camera: null, readings: [], sensors: [], noise: [], scan };
}
