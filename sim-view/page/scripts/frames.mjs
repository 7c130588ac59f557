// Measures the time that the page's own code takes for a frame with many robots: `npm run build && node
// scripts/frames.mjs [ROBOTS]`. "update" computes all poses and fills the buffers, "render" passes them to WebGL. The
// drawing itself is not measured: a graphics card or, without one, a software rasteriser in another process does it.
import { crowd } from "../tests/crowd.mjs";
import { launch } from "../tests/browser.mjs";

const FRAMES = 300;
const count = Number(process.argv[2] ?? 100);
const mock = await crowd(count, 0, 3);
const browser = await launch(true);
const page = await browser.newPage({ viewport: { width: 320, height: 240 } });
await page.addInitScript(() => {
  const { prototype } = WebGL2RenderingContext;
  for (const name of ["clear", "drawArrays", "drawArraysInstanced", "drawElements", "drawElementsInstanced"]) prototype[name] = () => {};
});
await page.goto(mock.url);
await page.waitForFunction(() => globalThis.eyesim?.model.snapshot);
const timer = mock.start();
const measured = await page.evaluate(async (most) => {
  const { view } = globalThis.eyesim;
  const frames = [];
  while (frames.length < most) {
    const { frames: before } = view.times;
    await new Promise((done) => requestAnimationFrame(done));
    if (view.times.frames > before) frames.push([view.times.update_ms, view.times.render_ms]);
  }
  return { frames, ...view.drawn };
}, FRAMES);
const share = (part, share) => measured.frames.map((frame) => frame[part]).sort((a, b) => a - b)[Math.floor(share * (FRAMES - 1))].toFixed(2);
console.log(
  `${count} robots, ${FRAMES} frames: update ${share(0, 0.5)} ms (95 %: ${share(0, 0.95)}), render ${share(1, 0.5)} ms (95 %: ${share(1, 0.95)}); ` +
    `${measured.calls} draw calls`,
);
await browser.close();
clearInterval(timer);
mock.close();
