// Rights of pages, and pages whose server ends, with a real `eyesim view`.

import assert from "node:assert/strict";
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import { Eyesim, launch, open, skip } from "./browser.mjs";

const folder = mkdtempSync(join(tmpdir(), "eyesim-access-"));
let browser;

if (!skip) {
  before(async () => {
    cpSync(fileURLToPath(new URL("room", import.meta.url)), folder, { recursive: true });
    browser = await launch();
  });
  after(async () => {
    Eyesim.stopAll();
    await browser.close();
    rmSync(folder, { recursive: true });
  });
}

const view = (...args) => Eyesim.start(["view", "wait.scene.toml", "--no-open", ...args], { cwd: folder });

test("the pages of a class only watch, the teacher's page acts, a wrong token is refused", { skip }, async () => {
  const eyesim = await view("--listen", "127.0.0.1", "--port", "0", "--token", "right-token-0123");
  const address = eyesim.url.replace(/#.*/, "");
  const watching = await open(browser, address);
  await watching.received.until("a welcome", ({ welcomes }) => welcomes.length > 0);
  assert.equal(watching.received.welcomes[0].may_act, false);
  await watching.control("banner").getByText("watching").waitFor();
  assert(await watching.control("run-pause").isDisabled());
  await watching.close();

  const wrong = await open(browser, `${address}#token=wrong`);
  await wrong.page.waitForFunction(() => globalThis.eyesim?.model.connection.is === "refused");
  assert.match(await wrong.control("banner-text").textContent(), /refused this page: the token is wrong/);
  assert.equal(wrong.received.snapshot, undefined, "it has seen nothing");
  // The right address in the same tab changes only the fragment.
  await wrong.page.evaluate(() => (location.hash = "token=right-token-0123"));
  await wrong.received.until("a welcome", ({ welcomes }) => welcomes.length > 0);
  assert.equal(wrong.received.welcomes[0].may_act, true);
  assert(!wrong.page.url().includes("token"), "the address bar does not show the token");
  await wrong.close();

  const teacher = await open(browser, `${address}#token=right-token-0123`);
  await teacher.received.until("the run", ({ snapshot }) => snapshot);
  assert(!teacher.page.url().includes("token"), "the address bar does not show the token");
  await teacher.control("run-pause").click();
  await teacher.received.until("paused", ({ snapshot }) => snapshot.state.is === "paused");
  await teacher.close();
  await eyesim.stop();
});

test("the page reconnects when the server has restarted", { skip }, async () => {
  const first = await view("--port", "0");
  const { page, received, control, close } = await open(browser, first.url);
  await received.until("the run", ({ snapshot }) => snapshot);
  await first.stop();
  await control("banner").getByText("lost").waitFor();
  assert(await control("run-pause").isDisabled());
  const second = await view("--port", first.port);
  await received.until("another welcome", ({ welcomes }) => welcomes.length === 2);
  await control("banner").waitFor({ state: "hidden" });
  await control("key1").click();
  await received.until("the key is taken", ({ events }) => events.some(({ kind }) => kind === "key"));
  await close();
  await second.stop();
  assert.deepEqual(received.errors, []);
});

test("an idle run waits for its user; the keyboard controls everything", { skip }, async () => {
  const eyesim = await view("--port", "0");
  const { page, received, control, close } = await open(browser, eyesim.url);
  await received.until("idle", ({ snapshot }) => snapshot?.state.is === "idle");
  await page.getByTestId("run-state").getByText("idle").waitFor();
  const tabTo = async (testid) => {
    for (let stops = 0; stops < 120; stops++) {
      await page.keyboard.press("Tab");
      if (await page.evaluate((testid) => document.activeElement?.dataset.testid === testid, testid)) return;
    }
    assert.fail(`Tab never comes to ${testid}`);
  };
  await tabTo("run-pause");
  await page.keyboard.press("Enter");
  await received.until("paused", ({ snapshot }) => snapshot.state.is === "paused");
  const { t_s } = received.snapshot;
  await tabTo("step");
  await page.keyboard.press("Space");
  await received.until("a slot", ({ snapshot }) => snapshot.t_s > t_s);
  await tabTo("key1");
  await page.keyboard.press("Enter");
  await page.keyboard.press(".");
  await page.keyboard.press(".");
  await received.until("the key", ({ events }) => events.some(({ kind }) => kind === "key"));
  await tabTo("events");
  await tabTo("run-pause");
  await page.keyboard.press("Enter");
  await page.keyboard.press("4");
  await received.until("the end", ({ snapshot }) => snapshot.state.is === "ended");
  assert.match(received.snapshot.state.digest, /^[0-9a-f]{64}$/);
  await control("run-pause").getByText("Run again").waitFor();
  const { run } = received.scene;
  await control("run-pause").click();
  await received.until("another run", ({ scene, snapshot }) => scene.run === run + 1 && snapshot.run === scene.run);
  await control("run-pause").getByText("Pause").waitFor();
  await close();
  await eyesim.stop();
});

test("a saved program is rebuilt and rerun; the output of the compiler is shown", { skip }, async () => {
  const eyesim = await view("--port", "0", "--watch");
  const { received, control, close } = await open(browser, eyesim.url);
  await received.until("the run", ({ scene, snapshot }) => scene && snapshot?.run === scene.run);
  const program = join(folder, "wait.c");
  const source = readFileSync(program, "utf8");
  const { run } = received.scene;
  writeFileSync(program, source.replace("int key = KEYGet();", "int key = KEYGet()"));
  await control("build-output").getByText("expected").waitFor();
  assert.equal(received.scene.run, run, "the run before goes on");
  writeFileSync(program, source.replace('"GO"', '"NEW"'));
  await received.until("another run", ({ scene, snapshot }) => scene.run === run + 1 && snapshot.run === scene.run);
  await control("build").waitFor({ state: "hidden" });
  await control("key1").getByText("NEW").waitFor();
  assert.equal(received.scene.seed, "7");
  await close();
  await eyesim.stop();
});

test("a line typed on the page reaches the program", { skip }, async () => {
  const program = '#include "eyebot.h"\nint main(void) { char name[20]; scanf("%19s", name); LCDPrintf("hello %s\\n", name); return 0; }\n';
  writeFileSync(join(folder, "read.c"), program);
  const scene = readFileSync(join(folder, "wait.scene.toml"), "utf8").replace("wait.c", "read.c").replace("api = 6", "api = 7");
  writeFileSync(join(folder, "read.scene.toml"), scene);
  const eyesim = await Eyesim.start(["view", "read.scene.toml", "--no-open", "--port", "0"], { cwd: folder });
  const { page, received, control, close } = await open(browser, eyesim.url);
  await received.until("the wait", ({ snapshot }) => snapshot?.robots[0].why.startsWith("waits for a line typed"));
  await control("input-line").fill("Ada 1");
  await page.keyboard.press("Enter");
  await received.until("the end", ({ snapshot }) => snapshot.state.is === "ended");
  await control("lcd-text").getByText("hello Ada").waitFor({ state: "attached" });
  assert.equal(await control("input-line").inputValue(), "");
  await close();
  await eyesim.stop();
  assert.deepEqual(received.errors, []);
});

test("a page that connects late shows the trails from the start", { skip }, async () => {
  const program = '#include "eyebot.h"\nint main(void) { VWSetSpeed(200, 0); while (1) OSWait(100); }\n';
  writeFileSync(join(folder, "drive.c"), program);
  const scene = readFileSync(join(folder, "wait.scene.toml"), "utf8").replace("wait.c", "drive.c").replace("api = 6", "api = 7");
  writeFileSync(join(folder, "drive.scene.toml"), scene);
  const eyesim = await Eyesim.start(["view", "drive.scene.toml", "--no-open", "--port", "0"], { cwd: folder });
  const first = await open(browser, eyesim.url);
  await first.received.until("some way", ({ snapshot }) => snapshot?.t_s > 1);
  await first.control("run-pause").click();
  await first.received.until("paused", ({ snapshot }) => snapshot.state.is === "paused");
  // The run is paused, so the second page draws only trails of the past.
  const graphical = await launch(true);
  const late = await open(graphical, eyesim.url);
  await late.received.until("the run", ({ snapshot }) => snapshot);
  await late.page.waitForFunction(() => globalThis.eyesim.view.trails.used > 0);
  assert.equal(await late.page.locator("#loading").count(), 0);
  // A body that comes or goes changes the scene, and keeps the trails.
  const action = { do: "add_object", kind: "Can", x_m: 0.3, y_m: 0.3, phi_rad: 0 };
  await first.page.evaluate((action) => globalThis.eyesim.model.act({ command: "act", action }), action);
  await late.received.until("a can", ({ scene }) => scene.objects.length === 1);
  await late.page.waitForFunction(() => globalThis.eyesim.model.scene.objects.length === 1 && globalThis.eyesim.view.trails.used > 0);
  await late.close();
  await graphical.close();
  await first.close();
  await eyesim.stop();
  assert.deepEqual([...first.received.errors, ...late.received.errors], []);
});
