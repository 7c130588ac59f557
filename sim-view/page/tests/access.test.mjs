// Who may do what, and what becomes of a page whose server goes away, with a real `eyesim view`.

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

test("a class watches, the teacher acts, a wrong token is refused", { skip }, async () => {
  const eyesim = await view("--listen", "127.0.0.1", "--port", "0", "--token", "right-token-0123");
  const address = eyesim.url.replace(/#.*/, "");
  const watching = await open(browser, address);
  await watching.heard.until("a welcome", ({ welcomes }) => welcomes.length > 0);
  assert.equal(watching.heard.welcomes[0].may_act, false);
  await watching.control("banner").getByText("watching").waitFor();
  assert(await watching.control("run-pause").isDisabled());
  await watching.close();

  const wrong = await open(browser, `${address}#token=wrong`);
  await wrong.page.waitForFunction(() => globalThis.eyesim?.model.connection.is === "refused");
  assert.match(await wrong.control("banner-text").textContent(), /refused this page: the token is wrong/);
  assert.equal(wrong.heard.snapshot, undefined, "it has seen nothing");
  await wrong.close();

  const teacher = await open(browser, `${address}#token=right-token-0123`);
  await teacher.heard.until("the run", ({ snapshot }) => snapshot);
  assert(!teacher.page.url().includes("token"), "the address bar does not show the token");
  await teacher.control("run-pause").click();
  await teacher.heard.until("paused", ({ snapshot }) => snapshot.state.is === "paused");
  await teacher.close();
  await eyesim.stop();
});

test("the page connects again when the server is back", { skip }, async () => {
  const first = await view("--port", "0");
  const { page, heard, control, close } = await open(browser, first.url);
  await heard.until("the run", ({ snapshot }) => snapshot);
  await first.stop();
  await control("banner").getByText("lost").waitFor();
  assert(await control("run-pause").isDisabled());
  const second = await view("--port", first.port);
  await heard.until("another welcome", ({ welcomes }) => welcomes.length === 2);
  await control("banner").waitFor({ state: "hidden" });
  await control("key1").click();
  await heard.until("the key is taken", ({ events }) => events.some(({ kind }) => kind === "key"));
  await close();
  await second.stop();
  assert.deepEqual(heard.errors, []);
});

test("an idle run waits for its user; all by keyboard", { skip }, async () => {
  const eyesim = await view("--port", "0");
  const { page, heard, control, close } = await open(browser, eyesim.url);
  await heard.until("idle", ({ snapshot }) => snapshot?.state.is === "idle");
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
  await heard.until("paused", ({ snapshot }) => snapshot.state.is === "paused");
  const { t_s } = heard.snapshot;
  await tabTo("step");
  await page.keyboard.press("Space");
  await heard.until("a slot", ({ snapshot }) => snapshot.t_s > t_s);
  await tabTo("key1");
  await page.keyboard.press("Enter");
  await page.keyboard.press(".");
  await page.keyboard.press(".");
  await heard.until("the key", ({ events }) => events.some(({ kind }) => kind === "key"));
  await tabTo("events");
  await tabTo("run-pause");
  await page.keyboard.press("Enter");
  await page.keyboard.press("4");
  await heard.until("the end", ({ snapshot }) => snapshot.state.is === "ended");
  assert.match(heard.snapshot.state.digest, /^[0-9a-f]{64}$/);
  await control("run-pause").getByText("Run again").waitFor();
  const { run } = heard.scene;
  await control("run-pause").click();
  await heard.until("another run", ({ scene, snapshot }) => scene.run === run + 1 && snapshot.run === scene.run);
  await control("run-pause").getByText("Pause").waitFor();
  await close();
  await eyesim.stop();
});

test("a saved program is built and run again; what the compiler says is shown", { skip }, async () => {
  const eyesim = await view("--port", "0", "--watch");
  const { heard, control, close } = await open(browser, eyesim.url);
  await heard.until("the run", ({ scene, snapshot }) => scene && snapshot?.run === scene.run);
  const program = join(folder, "wait.c");
  const source = readFileSync(program, "utf8");
  const { run } = heard.scene;
  writeFileSync(program, source.replace("int key = KEYGet();", "int key = KEYGet()"));
  await control("build-output").getByText("expected").waitFor();
  assert.equal(heard.scene.run, run, "the run before goes on");
  writeFileSync(program, source.replace('"GO"', '"NEW"'));
  await heard.until("another run", ({ scene, snapshot }) => scene.run === run + 1 && snapshot.run === scene.run);
  await control("build").waitFor({ state: "hidden" });
  await control("key1").getByText("NEW").waitFor();
  assert.equal(heard.scene.seed, "7");
  await close();
  await eyesim.stop();
});

test("a line typed on the page reaches the program", { skip }, async () => {
  const program = '#include "eyebot.h"\nint main(void) { char name[20]; scanf("%19s", name); LCDPrintf("hello %s\\n", name); return 0; }\n';
  writeFileSync(join(folder, "read.c"), program);
  const scene = readFileSync(join(folder, "wait.scene.toml"), "utf8").replace("wait.c", "read.c").replace("api = 6", "api = 7");
  writeFileSync(join(folder, "read.scene.toml"), scene);
  const eyesim = await Eyesim.start(["view", "read.scene.toml", "--no-open", "--port", "0"], { cwd: folder });
  const { page, heard, control, close } = await open(browser, eyesim.url);
  await heard.until("the wait", ({ snapshot }) => snapshot?.robots[0].why.startsWith("waits for a line typed"));
  await control("input-line").fill("Ada 1");
  await page.keyboard.press("Enter");
  await heard.until("the end", ({ snapshot }) => snapshot.state.is === "ended");
  await control("lcd-text").getByText("hello Ada").waitFor({ state: "attached" });
  assert.equal(await control("input-line").inputValue(), "");
  await close();
  await eyesim.stop();
  assert.deepEqual(heard.errors, []);
});

test("a page that comes late shows the trails from the start", { skip }, async () => {
  const program = '#include "eyebot.h"\nint main(void) { VWSetSpeed(200, 0); while (1) OSWait(100); }\n';
  writeFileSync(join(folder, "drive.c"), program);
  const scene = readFileSync(join(folder, "wait.scene.toml"), "utf8").replace("wait.c", "drive.c").replace("api = 6", "api = 7");
  writeFileSync(join(folder, "drive.scene.toml"), scene);
  const eyesim = await Eyesim.start(["view", "drive.scene.toml", "--no-open", "--port", "0"], { cwd: folder });
  const first = await open(browser, eyesim.url);
  await first.heard.until("some way", ({ snapshot }) => snapshot?.t_s > 1);
  await first.control("run-pause").click();
  await first.heard.until("paused", ({ snapshot }) => snapshot.state.is === "paused");
  // Nothing moves any more: what is drawn is what was before.
  const graphical = await launch(true);
  const late = await open(graphical, eyesim.url);
  await late.heard.until("the run", ({ snapshot }) => snapshot);
  await late.page.waitForFunction(() => globalThis.eyesim.view.trails.used > 0);
  assert.equal(await late.page.locator("#loading").count(), 0);
  await late.close();
  await graphical.close();
  await first.close();
  await eyesim.stop();
  assert.deepEqual([...first.heard.errors, ...late.heard.errors], []);
});
