// A plot as a file: SVG for printing, CSV for computing.

import type { Curve } from "../model";

/** A curve with the name of its reading. */
export interface Series extends Curve {
  name: string;
}

const [WIDTH, HEIGHT] = [900, 420];
const EDGE = { left: 64, right: 64, top: 24, bottom: 48 };
const DASHES = ["", "6 3", "2 3", "8 3 2 3"];

/** SVG drawing of the curves between two times; `colours` has one for each curve. */
export function svgOf(title: string, series: readonly Series[], range_s: [number, number], colours: string[]): string {
  const [from, to] = range_s;
  const units = [...new Set(series.map(({ unit }) => unit))];
  const spans = units.map((unit) => spanOf(series.filter((one) => one.unit === unit), range_s));
  const inner = { width: WIDTH - EDGE.left - EDGE.right, height: HEIGHT - EDGE.top - EDGE.bottom };
  const x = (t: number) => EDGE.left + ((t - from) / (to - from || 1)) * inner.width;
  const y = (value: number, unit: string) => {
    const [low, high] = spans[units.indexOf(unit)]!;
    return EDGE.top + (1 - (value - low) / (high - low)) * inner.height;
  };
  const parts = [
    `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${WIDTH} ${HEIGHT}" font-family="sans-serif" font-size="12">`,
    `<title>${escape(title)}</title><rect width="${WIDTH}" height="${HEIGHT}" fill="#fff"/>`,
  ];
  for (const tick of ticks(from, to)) {
    parts.push(`<path d="M${f(x(tick))} ${EDGE.top}v${inner.height}" stroke="#ddd"/>`);
    parts.push(text(x(tick), HEIGHT - EDGE.bottom + 16, "middle", label(tick)));
  }
  parts.push(text(EDGE.left + inner.width / 2, HEIGHT - 10, "middle", "virtual time in s"));
  units.slice(0, 2).forEach((unit, side) => {
    const [at, anchor] = side === 0 ? [EDGE.left - 6, "end"] : [WIDTH - EDGE.right + 6, "start"];
    for (const tick of ticks(...spans[side]!)) {
      if (side === 0) parts.push(`<path d="M${EDGE.left} ${f(y(tick, unit))}h${inner.width}" stroke="#ddd"/>`);
      parts.push(text(at, y(tick, unit) + 4, anchor, label(tick)));
    }
    parts.push(text(at, EDGE.top - 8, anchor, unit || "count"));
  });
  parts.push(`<rect x="${EDGE.left}" y="${EDGE.top}" width="${inner.width}" height="${inner.height}" fill="none" stroke="#444"/>`);
  series.forEach((one, place) => {
    const style = `fill="none" stroke="${colours[place]}" stroke-width="1.5" stroke-dasharray="${DASHES[place % DASHES.length]}"`;
    parts.push(`<path ${style} d="${path(one, range_s, x, y)}"/>`);
    const at = EDGE.top + 16 + 16 * place;
    parts.push(`<path ${style} d="M${EDGE.left + 10} ${at - 4}h24"/>`, text(EDGE.left + 40, at, "start", nameOf(one)));
  });
  return [...parts, "</svg>\n"].join("\n");
}

/** CSV table of the points between two times: a column for the time and one for each curve, empty without a reading. */
export function csvOf(series: readonly Series[], range_s: [number, number]): string {
  const rows = new Map<number, string[]>();
  series.forEach((one, place) => {
    one.times_s.forEach((t, at) => {
      if (t < range_s[0] || t > range_s[1]) return;
      const row = rows.get(t) ?? series.map(() => "");
      row[place] = String(one.values[at] ?? "");
      rows.set(t, row);
    });
  });
  const header = ["t_s", ...series.map(nameOf)].map(quote).join(",");
  const lines = [...rows].sort(([a], [b]) => a - b).map(([t, row]) => [t, ...row].join(","));
  return [header, ...lines, ""].join("\n");
}

/** Name and unit. */
export function nameOf({ name, unit }: Series): string {
  return unit ? `${name} (${unit})` : name;
}

function path(one: Series, [from, to]: [number, number], x: (t: number) => number, y: (v: number, unit: string) => number) {
  let isDrawing = false;
  return one.times_s
    .map((t, at) => {
      const value = one.values[at];
      const isPoint = t >= from && t <= to && value !== null && value !== undefined;
      const step = isPoint ? `${isDrawing ? "L" : "M"}${f(x(t))} ${f(y(value, one.unit))}` : "";
      isDrawing = isPoint;
      return step;
    })
    .join("");
}

function spanOf(series: readonly Series[], [from, to]: [number, number]): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const { times_s, values } of series) {
    values.forEach((value, at) => {
      if (value === null || times_s[at]! < from || times_s[at]! > to) return;
      [low, high] = [Math.min(low, value), Math.max(high, value)];
    });
  }
  if (low > high) return [0, 1];
  return low === high ? [low - 1, high + 1] : [low - (high - low) / 20, high + (high - low) / 20];
}

function ticks(from: number, to: number): number[] {
  const rough = (to - from || 1) / 6;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5].find((factor) => factor * power >= rough) ?? 10);
  const first = Math.ceil(from / step);
  return Array.from({ length: Math.max(0, Math.floor(to / step) - first + 1) }, (_, at) => (first + at) * step);
}

function text(x: number, y: number, anchor: string, content: string): string {
  return `<text x="${f(x)}" y="${f(y)}" text-anchor="${anchor}">${escape(content)}</text>`;
}

function label(value: number): string {
  return String(Number(value.toPrecision(6)));
}

function f(value: number): string {
  return String(Math.round(value * 100) / 100);
}

function escape(content: string): string {
  return content.replace(/[&<>"]/g, (letter) => `&#${letter.charCodeAt(0)};`);
}

function quote(cell: string): string {
  return /[",\n]/.test(cell) ? `"${cell.replaceAll('"', '""')}"` : cell;
}
