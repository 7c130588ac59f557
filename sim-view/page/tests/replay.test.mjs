// Recorded runs, with a real `eyesim replay` and as a single file from disk.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cpSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";
import { Eyesim, launch, open, skip } from "./browser.mjs";

const folder = mkdtempSync(join(tmpdir(), "eyesim-replay-"));
const run = (...args) => execFileSync(process.env.EYESIM, args, { cwd: folder, stdio: "pipe" }).toString();
let browser;

if (!skip) {
  before(async () => {
    cpSync(fileURLToPath(new URL("room", import.meta.url)), folder, { recursive: true });
    run("run", "room.scene.toml", "--until", "6", "--keys", "1:1:KEY1,1:4:KEY2,2:2:TOUCH(100,100)", "--trace", "T.jsonl");
    browser = await launch();
  });
  after(async () => {
    Eyesim.stopAll();
    await browser.close();
    rmSync(folder, { recursive: true });
  });
}

/** Checks what the page shows of the trace, since a recording has no server to query. */
async function check({ page, received, control, close }) {
  await control("robots").locator("[role=option]").first().waitFor();
  const isAt = (t_s) => page.waitForFunction((t_s) => Math.abs(globalThis.eyesim.model.snapshot?.t_s - t_s) < 0.06, t_s);
  const scrub = async (t_s) => {
    await control("timeline").fill(String(t_s));
    await isAt(t_s);
  };
  const x_mm = () => page.evaluate(() => globalThis.eyesim.model.snapshot.robots[0].motion[0].from.x_m * 1000);
  if ((await control("play").textContent()) === "Pause") await control("play").click();
  await scrub(0);
  const start = await x_mm();
  await scrub(5);
  const way = (await x_mm()) - start;
  assert(Math.abs(way - 300) < 12, `3 s at 100 mm/s between the two keys, not ${way}`);
  await control("lcd-text").getByText("stop").waitFor();
  await scrub(2);
  await page.waitForFunction(() => !document.querySelector("[data-testid=lcd-text]").textContent.includes("stop"));
  const x_at_2_s = await x_mm();
  await page.waitForFunction((x_mm) => Math.abs(parseFloat(document.querySelector("[data-reading='true x'] td.number").textContent) - x_mm) < 1, x_at_2_s);

  await control("events-kind").selectOption("key");
  await control("events").press("End");
  await control("events").press("Enter");
  await isAt(4);

  for (const testid of ["run-pause", "restart-new", "speed"]) assert(await control(testid).isHidden(), testid);
  for (const testid of ["key1", "edit-place"]) assert.match(await control(testid).getAttribute("title"), /recording/);
  const before = await page.evaluate(() => globalThis.eyesim.model.snapshot.t_s);
  await control("robots").focus();
  await page.keyboard.press("Space");
  await page.waitForFunction((before) => globalThis.eyesim.model.snapshot.t_s > before + 0.2, before);
  await page.keyboard.press("Space");
  await page.keyboard.press(".");
  assert.equal(await page.evaluate(() => globalThis.eyesim.model.player.isPlaying), false);
  assert.deepEqual(received.errors, []);
  await close();
}

test("a recording plays, scrubs and jumps", { skip }, async () => {
  const eyesim = await Eyesim.start(["replay", "T.jsonl", "--no-open", "--port", "0"], { cwd: folder });
  await check(await open(browser, eyesim.url));
  await eyesim.stop();
});

test("a single file plays from disk, without a server", { skip }, async () => {
  run("replay", "T.jsonl", "--html", "run.html");
  const html = readFileSync(join(folder, "run.html"), "utf8");
  assert(!/(src|href)="(?!data:)[^#"]/.test(html.slice(0, 5000)), "nothing is loaded from elsewhere");
  const requests = [];
  const opened = await open(browser, "about:blank");
  opened.page.on("request", (request) => requests.push(request.url()));
  await opened.page.goto(pathToFileURL(join(folder, "run.html")).href);
  await check(opened);
  assert.deepEqual(requests.filter((url) => /^(https?|wss?):/.test(url)), []);
});
