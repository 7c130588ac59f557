// The timeline below the 3D view: marks of past events and, for a recording, the playback time.

import { element } from "./dom";
import type { Model } from "./model";
import type { Event } from "./protocol";

/** Kinds of events that are marked, each with its colour. Later entries are rarer, and their marks are taller and drawn on top. */
const MARKS: readonly { kinds: readonly string[]; name: string; colour: string }[] = [
  { kinds: ["radio_arrived", "radio_sent"], name: "radio", colour: "--radio" },
  { kinds: ["radio_lost"], name: "message lost", colour: "--warn" },
  { kinds: ["contact"], name: "contact", colour: "--contact" },
  { kinds: ["intervention"], name: "by the user", colour: "--accent" },
  { kinds: ["program_ended", "fault"], name: "program ended", colour: "--bad" },
];
const STEP_S = 0.05;

export function timeline(model: Model, all: readonly Event[] | null): HTMLElement {
  const play = element("button", { type: "button", testid: "play", onclick: playOrPause });
  const range = element("input", { type: "range", testid: "timeline", label: "Time", min: "0", step: String(STEP_S) });
  range.oninput = () => model.player?.seek(Number(range.value));
  range.onkeydown = (event) => {
    const leap = event.key === "PageUp" ? 1 : event.key === "PageDown" ? -1 : 0;
    if (leap === 0 || !model.player) return;
    event.preventDefault();
    model.player.seek(Number(range.value) + leap * Math.max(1, model.player.duration_s / 20));
  };
  const marks = element("canvas", { className: "marks", testid: "marks" });
  marks.setAttribute("role", "img");
  const legend = element("p", { className: "legend" });
  const time = element("output", { className: "number", testid: "shown-time", label: "Time shown" });
  const line = element("div", { className: "line" }, [marks, range]);
  const section = element("section", { className: "timeline", label: "Timeline" }, [play, line, time, legend]);
  marks.onclick = (event) => {
    const box = marks.getBoundingClientRect();
    model.player?.seek((model.player.duration_s * (event.clientX - box.left)) / box.width);
  };

  const seen = new Set<string>();
  let drawnKey = "";
  let isWaiting = false;
  model.subscribe("player", show);
  model.subscribe("scene", () => {
    seen.clear();
    scheduleDraw();
  });
  model.subscribe("events", scheduleDraw);
  model.subscribe("snapshot", scheduleDraw);
  new ResizeObserver(scheduleDraw).observe(marks);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    drawnKey = "";
    scheduleDraw();
  });
  return section;

  function playOrPause(): void {
    const { player } = model;
    if (player) player.isPlaying ? player.pause() : player.play();
  }

  function show(): void {
    const { player } = model;
    for (const control of [play, range, time]) control.hidden = player === null;
    if (player) {
      play.textContent = player.isPlaying ? "Pause" : "Play";
      range.max = String(player.duration_s);
      const t_s = model.snapshot?.t_s ?? 0;
      range.value = String(t_s);
      range.setAttribute("aria-valuetext", `${t_s.toFixed(2)} of ${player.duration_s.toFixed(2)} seconds`);
    }
    scheduleDraw();
  }

  /** Updates the displayed time, and schedules a redraw of the marks at most four times a second. */
  function scheduleDraw(): void {
    const end_s = model.player?.duration_s;
    const t_s = model.snapshot?.t_s ?? 0;
    time.textContent = end_s === undefined ? `${t_s.toFixed(2)} s` : `${t_s.toFixed(2)} / ${end_s.toFixed(2)} s`;
    if (isWaiting) return;
    isWaiting = true;
    setTimeout(() => {
      isWaiting = false;
      draw();
    }, 250);
  }

  function draw(): void {
    const events = all ?? model.events;
    const end_s = Math.max(model.player?.duration_s ?? model.snapshot?.t_s ?? 0, 1e-3);
    const [width, height] = [marks.clientWidth * devicePixelRatio, marks.clientHeight * devicePixelRatio];
    const key = `${width} ${height} ${events.length} ${events.at(-1)?.number} ${end_s}`;
    const context = marks.getContext("2d");
    if (key === drawnKey || !context || width === 0) return;
    drawnKey = key;
    marks.width = width;
    marks.height = height;
    const probe = section.appendChild(element("i"));
    MARKS.forEach(({ kinds, name, colour }, row) => {
      probe.style.color = `var(${colour})`;
      context.fillStyle = getComputedStyle(probe).color;
      const fraction = 0.55 + (0.45 * (row + 1)) / MARKS.length;
      let last = -Infinity;
      for (const event of events) {
        if (!kinds.includes(event.kind)) continue;
        seen.add(name);
        const x = Math.round((event.t_s / end_s) * (width - 2 * devicePixelRatio));
        if (x === last) continue;
        last = x;
        context.fillRect(x, height * (1 - fraction), 2 * devicePixelRatio, height * fraction);
      }
    });
    probe.remove();
    legend.replaceChildren(
      ...MARKS.filter(({ name }) => seen.has(name)).map(({ name, colour }) => {
        const swatch = element("i");
        swatch.style.background = `var(${colour})`;
        return element("span", {}, [swatch, name]);
      }),
    );
    const counts = MARKS.map(({ kinds, name }) => `${events.filter(({ kind }) => kinds.includes(kind)).length} ${name}`);
    marks.setAttribute("aria-label", `What has happened: ${counts.join(", ")}`);
  }
}
