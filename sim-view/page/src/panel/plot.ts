// Curves of the ticked readings of the chosen robot over virtual time.

import uPlot from "uplot";
import { element } from "../dom";
import type { Model } from "../model";
import { button, choice, saveAs, section, setOptions, setText, throttled } from "./control";
import { csvOf, nameOf, type Series, svgOf } from "./figure";
import type { PlotSelection } from "./picks";

const HEIGHT_PX = 220;
/** Colours for paper: dark enough on white. */
const PRINTED = ["#0b6e99", "#b3400a", "#1c7d3c", "#8a2be2", "#8a6d00", "#a01c5a", "#444444", "#2244cc"];
const WINDOWS: [value: string, text: string][] = [["5", "last 5 s"], ["20", "last 20 s"], ["60", "last minute"], ["all", "all"]];

export function plotPanel(model: Model, picks: PlotSelection): HTMLElement {
  const container = element("div", { className: "plot", testid: "plot", role: "img" });
  const none = element("p", { className: "muted", textContent: "Tick readings in the table above to see their curves." });
  const pause = button("Pause plot", "plot-pause", () => setPaused(!isPaused));
  const wide = choice("plot-window", "Time that is shown", () => follow());
  setOptions(wide, WINDOWS);
  wide.value = "20";
  const buttons = [
    pause,
    wide,
    button("Zoom in", "plot-in", () => zoom(0.5)),
    button("Zoom out", "plot-out", () => zoom(2)),
    button("Clear", "plot-clear", clear, "Forget the readings so far"),
    button("Save SVG", "plot-svg", () => save("svg")),
    button("Save CSV", "plot-csv", () => save("csv")),
  ];
  const panel = section("Plots", "plot-panel", true, [none, container, element("div", { className: "row" }, buttons)]);

  let plot: uPlot | undefined;
  let shown: Series[] = [];
  let key = "";
  let isPaused = false;
  /** Zoomed range of time; undefined while the plot follows the run. */
  let zoomed: [number, number] | undefined;
  const scheduleDraw = throttled(() => panel.open && !isPaused && draw(), 150);
  panel.addEventListener("toggle", scheduleDraw);
  for (const topic of ["history", "chosen", "scene"] as const) model.subscribe(topic, scheduleDraw);
  picks.subscribe(() => panel.open && draw());
  new ResizeObserver(() => plot?.setSize({ width: container.clientWidth, height: HEIGHT_PX })).observe(container);
  for (const query of ["(prefers-color-scheme: dark)", "(forced-colors: active)"])
    matchMedia(query).addEventListener("change", () => plot?.redraw());
  return panel;

  function draw(): void {
    const curves = model.history.get(model.chosen ?? -1);
    shown = picks.all.flatMap((name) => {
      const curve = curves?.get(name);
      return curve ? [{ name, ...curve }] : [];
    });
    none.hidden = shown.length > 0;
    container.hidden = shown.length === 0;
    const name = model.scene?.robots.find(({ id }) => id === model.chosen)?.name ?? "";
    container.ariaLabel = `Curves of ${name}: ${shown.map(nameOf).join(", ")}`;
    const needed = JSON.stringify(shown.map(nameOf));
    if (needed !== key || !plot) {
      plot?.destroy();
      plot = shown.length > 0 ? make(shown) : undefined;
      key = needed;
    }
    if (!plot) return;
    const [min, max] = range();
    plot.setData(dataOf(shown, [min, max]), false);
    plot.setScale("x", { min, max });
  }

  function make(series: readonly Series[]): uPlot {
    const units = [...new Set(series.map(({ unit }) => unit))];
    const line = () => colourOf("--text", container);
    const grid = { stroke: () => colourOf("--line", container), width: 1 };
    const chart = new uPlot(
      {
        width: container.clientWidth || 300,
        height: HEIGHT_PX,
        scales: { x: { time: false } },
        cursor: { drag: { x: true, y: false, setScale: false } },
        legend: { live: true },
        hooks: { setSelect: [selected] },
        series: [
          { label: "t", value: (_, t) => (t === null ? "–" : `${t.toFixed(3)} s`) },
          ...series.map(({ name, unit }, at) => ({
            label: name,
            scale: unit || "count",
            stroke: () => colourOf(`--curve-${at + 1}`, container),
            width: 1.5,
            dash: [[], [6, 3], [2, 3]][Math.floor(at / 3) % 3]!,
            points: { show: false },
            value: (_: uPlot, value: number | null) => (value === null ? "–" : `${value.toFixed(2)} ${unit}`),
          })),
        ],
        axes: [
          { label: "virtual time in s", labelSize: 18, size: 34, stroke: line, grid, ticks: grid },
          ...units.map((unit, at) => ({
            scale: unit || "count",
            label: unit || "count",
            labelSize: 18,
            size: 58,
            side: at % 2 === 0 ? 3 : 1,
            stroke: line,
            ticks: grid,
            grid: at === 0 ? grid : { show: false },
          })),
        ],
      },
      dataOf(series, range()),
      container,
    );
    chart.over.addEventListener("dblclick", follow);
    return chart;
  }

  function selected(at: uPlot): void {
    const { left, width } = at.select;
    if (width < 4) return;
    zoomed = [at.posToVal(left, "x"), at.posToVal(left + width, "x")];
    at.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    draw();
  }

  /** Visible range of time. */
  function range(): [number, number] {
    if (zoomed) return zoomed;
    const ends = shown.flatMap(({ times_s }) => times_s.slice(-1));
    const last = Math.max(0, ...ends);
    const first = Math.min(last, ...shown.flatMap(({ times_s }) => times_s.slice(0, 1)));
    const from = wide.value === "all" ? first : Math.max(first, last - Number(wide.value));
    return last > from ? [from, last] : [from, from + 1];
  }

  function zoom(factor: number): void {
    const [from, to] = range();
    const [middle, half] = [(from + to) / 2, ((to - from) / 2) * factor];
    zoomed = [Math.max(0, middle - half), middle + half];
    draw();
  }

  function follow(): void {
    zoomed = undefined;
    draw();
  }

  function setPaused(paused: boolean): void {
    isPaused = paused;
    setText(pause, paused ? "Go on plotting" : "Pause plot");
    if (!paused) draw();
  }

  function clear(): void {
    if (model.chosen !== null) model.history.delete(model.chosen);
    zoomed = undefined;
    draw();
  }

  function save(format: "svg" | "csv"): void {
    const robot = model.scene?.robots.find(({ id }) => id === model.chosen);
    const title = `${model.scene?.title ?? ""}, ${robot?.name ?? ""}`;
    const content = format === "svg" ? svgOf(title, shown, range(), PRINTED) : csvOf(shown, range());
    const type = format === "svg" ? "image/svg+xml" : "text/csv";
    saveAs(`${robot?.name ?? "robot"}-readings.${format}`, new Blob([content], { type }));
  }
}

/** All curves joined on their times, with one more point at either end, so that lines reach the edge. */
function dataOf(series: readonly Series[], [from, to]: [number, number]): uPlot.AlignedData {
  if (series.length === 0) return [[]];
  const tables = series.map(({ times_s, values }) => {
    const first = Math.max(0, times_s.findIndex((t) => t >= from) - 1);
    const after = times_s.findLastIndex((t) => t <= to) + 2;
    return [times_s.slice(first, after), values.slice(first, after)] as uPlot.AlignedData;
  });
  return uPlot.join(tables);
}

/** A colour of the style sheet in a format that canvases accept. */
function colourOf(variable: string, element: HTMLElement): string {
  element.style.color = `var(${variable})`;
  return getComputedStyle(element).color;
}
