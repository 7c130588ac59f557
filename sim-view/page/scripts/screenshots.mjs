// Takes the pictures of the window in docs/: `npm run build && node scripts/screenshots.mjs [EYESIM]`; EYESIM is the
// path of the binary, by default the debug build. Check the pictures before you commit them.
import { spawn } from "node:child_process";
import { once } from "node:events";
import { fileURLToPath } from "node:url";
import { launch } from "../tests/browser.mjs";

const ROOT = fileURLToPath(new URL("../../..", import.meta.url));
const EYESIM = process.argv[2] ?? `${ROOT}target/debug/eyesim`;

const browser = await launch(true);
await shoot("window", "sims/soccer.sim", { until_s: 3.2, width: 1360, height: 880 });
await shoot("window-radio", "sims/token.scene.toml", { until_s: 0.5, width: 1360, height: 880, colorScheme: "dark" });
await browser.close();

/** Runs a scene until a time, pauses, and takes a picture of the page. */
async function shoot(name, scene, { until_s, width, height, colorScheme = "light", prepare = () => {} }) {
  const eyesim = spawn(EYESIM, ["view", scene, "--no-open", "--port", "0"], { cwd: ROOT, stdio: ["ignore", "pipe", "inherit"] });
  try {
    const [url] = /http:\S+/.exec(String(await once(eyesim.stdout, "data")));
    const page = await browser.newPage({ viewport: { width, height }, colorScheme });
    await page.goto(url);
    await page.waitForFunction(() => globalThis.eyesim?.view?.times.frames > 0, null, { timeout: 120_000 });
    // Restarts the run once the page shows it, and slowly enough for a software rasteriser.
    await page.evaluate(() => globalThis.eyesim.model.act({ command: "speed", factor: 0.25 }));
    const run = await page.evaluate(() => globalThis.eyesim.model.scene.run);
    await page.evaluate(() => globalThis.eyesim.model.act({ command: "restart", seed: "same" }));
    await page.waitForFunction((run) => globalThis.eyesim.model.scene.run > run, run, { timeout: 120_000 });
    await page.waitForFunction(() => globalThis.eyesim.model.snapshot, null, { timeout: 120_000 });
    await page.waitForFunction((t_s) => globalThis.eyesim.model.snapshot.t_s >= t_s, until_s, { timeout: 120_000 });
    await page.evaluate(() => globalThis.eyesim.model.act({ command: "pause" }));
    await page.waitForTimeout(1000);
    await prepare(page);
    await page.waitForTimeout(1000);
    await page.screenshot({ path: `${ROOT}docs/${name}.png` });
    await page.close();
  } finally {
    eyesim.kill("SIGINT");
  }
}
