// List of past events, with filters; choosing one jumps to it.

import { element } from "../dom";
import type { Model } from "../model";
import type { Event } from "../protocol";
import { choice, section, setOptions, setText, whileOpen } from "./control";
import { type Line, LongList } from "./list";

export function eventsPanel(model: Model): HTMLElement {
  const list = new LongList("events", "Events", ({ key }) => jump(key));
  const kind = choice("events-kind", "Kind of events", draw);
  const robot = choice("events-robot", "Whose events", draw);
  const words = element("input", { type: "search", testid: "events-words", label: "Words in events", placeholder: "words", oninput: draw });
  const count = element("p", { className: "muted number", testid: "events-count" });
  const panel = section("Events", "events-panel", true, [element("div", { className: "row" }, [kind, robot, words]), list.element, count]);
  const scheduleDraw = whileOpen(panel, draw, 250);
  for (const topic of ["events", "scene", "chosen"] as const) model.subscribe(topic, scheduleDraw);
  return panel;

  function draw(): void {
    const all = model.player?.events ?? model.events;
    const kinds = [...new Set(all.map((event) => event.kind))].sort();
    setOptions(kind, [["", "all kinds"], ...kinds.map((name): [string, string] => [name, name.replaceAll("_", " ")])]);
    const robots = model.scene?.robots ?? [];
    const names = new Map(robots.map(({ id, name }) => [id, `${id} ${name}`]));
    setOptions(robot, [["", "all robots"], ["chosen", "the chosen robot"], ["world", "the world"], ...[...names].map(([id, name]): [string, string] => [String(id), name])]);
    const visible = all.filter(isWanted);
    list.show(visible.map((event) => lineOf(event, names)));
    const missed = model.player?.eventsLeftOut ?? model.missedEvents;
    setText(count, `${visible.length} of ${all.length} events${missed > 0 ? `, ${missed} more left out` : ""}`);
  }

  function isWanted(event: Event): boolean {
    if (kind.value !== "" && event.kind !== kind.value) return false;
    if (robot.value === "world" && event.robot !== null) return false;
    if (robot.value === "chosen" && event.robot !== model.chosen) return false;
    if (/^\d/.test(robot.value) && event.robot !== Number(robot.value)) return false;
    return words.value === "" || `${event.kind} ${event.text}`.toLowerCase().includes(words.value.toLowerCase());
  }

  function jump(number: number): void {
    const event = (model.player?.events ?? model.events).find((event) => event.number === number);
    if (!event) return;
    model.player?.seek(event.t_s);
    if (event.robot === null) return;
    model.choose(event.robot);
    model.centreOn(event.robot);
  }
}

/** An event as a line of a list. */
export function lineOf(event: Event, names: ReadonlyMap<number, string>): Line {
  const who = event.robot === null ? "" : (names.get(event.robot) ?? `${event.robot}`);
  return { key: event.number, time: event.t_s.toFixed(3), who, kind: event.kind, text: event.text };
}
