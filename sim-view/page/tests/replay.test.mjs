// Recorded runs, with a real `eyesim replay` and as one file from disk.

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
    await browser.close();
    rmSync(folder, { recursive: true });
  });
}

/** What the model of the page says: there is no server to ask. */
async function check({ page, heard, control, close }) {
  await page.getByTestId("robots").locator("[role=option]").first().waitFor();
  const time = () => control("time").textContent().then(parseFloat);
  const scrub = (t_s) => control("timeline").evaluate((slider, t_s) => {
    slider.value = String(t_s);
    slider.dispatchEvent(new Event("input", { bubbles: true }));
    slider.dispatchEvent(new Event("change", { bubbles: true }));
  }, t_s);
  const trueX = () => page.locator("[data-reading='true x'] td.number").first().textContent().then(parseFloat);
  const becomes = (what, is) => page.waitForFunction(is, undefined, { polling: 50 }).catch(() => assert.fail(`never ${what}`));
  void becomes;
  if ((await control("run-pause").textContent()) === "Pause") await control("run-pause").click();
  await scrub(0);
  assert(Math.abs((await time()) - 0) < 0.1);
  const start = await trueX();
  await scrub(5);
  await page.waitForFunction(() => Math.abs(parseFloat(document.querySelector("[data-testid=time]").textContent) - 5) < 0.05);
  const end = await trueX();
  // 3 s at 100 mm/s between the two keys.
  assert(Math.abs(end - start - 300) < 12, `from ${start} to ${end}`);
  await control("lcd-text").getByText("stop").waitFor({ state: "attached" });
  await scrub(2);
  await page.waitForFunction(() => !document.querySelector("[data-testid=lcd-text]").textContent.includes("stop"));

  await control("events-kind").selectOption("key");
  await control("events").press("Home");
  await control("events").press("Enter");
  await page.waitForFunction(() => Math.abs(parseFloat(document.querySelector("[data-testid=time]").textContent) - 1) < 0.1);

  for (const testid of ["key1", "restart-new"]) assert.match(await control(testid).getAttribute("title"), /recording/);
  const before = await time();
  await control("run-pause").click();
  await page.waitForFunction((before) => parseFloat(document.querySelector("[data-testid=time]").textContent) > before + 0.2, before);
  assert.deepEqual(heard.errors, []);
  await close();
}

test("a recording plays, scrubs and jumps", { skip }, async () => {
  const eyesim = await Eyesim.start(["replay", "T.jsonl", "--no-open", "--port", "0"], { cwd: folder });
  await check(await open(browser, eyesim.url));
  await eyesim.stop();
});

test("one file plays from disk, without a server", { skip }, async () => {
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
