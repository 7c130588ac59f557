// The bar of the run: run, pause, step, speed, restart.

import { element } from "../dom";
import type { Model } from "../model";
import type { Seed, Snapshot } from "../protocol";
import { button, labelled, numberField, numberOf, setReason, setText, setValue, throttled } from "./control";
import { shortcut } from "./keyboard";
import { onRights, send, whyNot } from "./notice";

/** Steps of the slider; null is as fast as possible. */
const SPEEDS: readonly (number | null)[] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, null];
const LAST = SPEEDS.length - 1;

export function runPanel(model: Model): HTMLElement {
  const toggle = button("Pause", "run-pause", runOrPause, "Space");
  toggle.classList.add("primary");
  const step = button("Step", "step", oneSlot, "One slot (.)");
  const slider = element("input", { type: "range", min: "0", max: String(LAST), step: "1", testid: "speed", label: "Speed" });
  slider.oninput = () => (slider.ariaValueText = speedName(SPEEDS[slider.valueAsNumber] ?? null));
  slider.onchange = () => setSpeed(SPEEDS[slider.valueAsNumber] ?? null);
  const exact = numberField("speed-exact", { min: "0.001", placeholder: "max", ariaLabel: "Speed, exactly" });
  exact.onchange = () => {
    if (exact.validity.badInput) exact.value = speedText();
    else setSpeed(numberOf(exact) ?? null);
  };
  const restart = button("Restart", "restart", () => start("same"), "With the same seed");
  const another = button("New seed", "restart-new", () => start("new"), "Restart with a new seed");
  const seed = element("input", { type: "text", inputMode: "numeric", pattern: "[0-9]{1,20}", testid: "seed", size: 8, required: true });
  const typed = element("form", { className: "row" }, [labelled("Seed", seed), submit("Restart with it", "restart-seed")]);
  typed.onsubmit = (event) => {
    event.preventDefault();
    start({ number: seed.value.trim() });
  };
  const time = element("output", { className: "number time", testid: "time", ariaLive: "off", label: "Virtual time" });
  const rate = element("output", { className: "number muted", testid: "rate", ariaLive: "off", label: "Rate reached", title: "Simulated seconds for each second of real time" });
  const state = element("output", { className: "state", testid: "run-state", ariaLive: "polite" });
  const clock = element("div", { className: "row" }, [time, rate, state]);
  const speeds = element("div", { className: "row" }, [labelled("Speed", slider), exact, "×"]);
  const restarts = element("div", { className: "row" }, [restart, another]);
  const panel = element("div", { className: "bar run", role: "group", label: "Run", testid: "run" }, [
    element("div", { className: "row" }, [toggle, step]),
    speeds,
    restarts,
    typed,
    clock,
  ]);

  shortcut(" ", "Run or pause", runOrPause, "Space");
  shortcut(".", "One slot, then pause", oneSlot);
  const draw = throttled(drawNow);
  for (const topic of ["snapshot", "scene", "player"] as const) model.subscribe(topic, draw);
  onRights(model, allow);
  return panel;

  function isRunning(): boolean {
    const { player, snapshot } = model;
    return player ? player.isPlaying : snapshot?.state.is === "running" || snapshot?.state.is === "idle";
  }

  function isOver(): boolean {
    return !model.player && model.snapshot?.state.is === "ended";
  }

  function runOrPause(): void {
    const { player } = model;
    const run = !isRunning();
    if (isOver()) void (whyNot(model) || start("same"));
    else if (!player) void (whyNot(model) || send(model, { command: run ? "run" : "pause" }));
    else if (run) player.play();
    else player.pause();
  }

  function oneSlot(): void {
    if (step.disabled) return;
    const { player, scene, clock } = model;
    if (!player) return void send(model, { command: "step" });
    const slot_s = scene?.slot_s ?? 0.05;
    player.pause();
    player.seek(Math.min(player.duration_s, (Math.floor(clock.t_s / slot_s + 1e-6) + 1) * slot_s));
  }

  function speedText(): string {
    return String(model.snapshot?.speed ?? "");
  }

  function setSpeed(factor: number | null): void {
    void send(model, { command: "speed", factor });
  }

  function start(seed: Seed): void {
    void send(model, { command: "restart", seed });
  }

  /** Enables the controls. Controls that a recording lacks are hidden: it has a timeline instead, and cannot restart. */
  function allow(): void {
    for (const part of [toggle, speeds, restarts, typed, rate]) part.hidden = model.player !== null;
    const why = whyNot(model);
    setReason([toggle, slider, exact, restart, another, seed, typed.querySelector("button")!], why);
    setReason([step], model.player ? "" : why);
    drawNow();
  }

  function drawNow(): void {
    const { snapshot, scene } = model;
    setText(toggle, isOver() ? "Run again" : isRunning() ? "Pause" : "Run");
    const speed = snapshot?.speed ?? null;
    setValue(exact, speedText());
    if (document.activeElement !== slider || slider.ariaValueText === null) {
      setValue(slider, String(nearest(speed)));
      slider.ariaValueText = speedName(speed);
    }
    seed.placeholder = scene?.seed ?? "";
    if (!snapshot) return;
    setText(time, `${snapshot.t_s.toFixed(2)} s`);
    setText(rate, rateName(snapshot.rate));
    seed.title = `A whole number from 0; the seed of this run is ${scene?.seed ?? "unknown"}`;
    setText(state, stateName(model, snapshot));
    state.dataset["is"] = snapshot.state.is;
  }
}

function submit(text: string, testid: string): HTMLButtonElement {
  return element("button", { type: "submit", textContent: text, testid });
}

/** State of a run, in words. */
export function stateName(model: Model, { state, robots }: Snapshot): string {
  switch (state.is) {
    case "running":
      return model.player ? "recording, playing" : "running";
    case "paused":
      return model.player ? "recording, paused" : "paused";
    case "ended":
      return `ended: ${state.why}; digest ${state.digest}`;
    case "idle": {
      const waiting = robots.filter(({ standing }) => standing === "waiting");
      const names = waiting.slice(0, 2).map(({ id, why }) => {
        const name = model.scene?.robots.find((robot) => robot.id === id)?.name ?? id;
        return `${name}: ${why}`;
      });
      const more = waiting.length > 2 ? ` and ${waiting.length - 2} more` : "";
      return `idle until somebody acts${names.length > 0 ? ` (${names.join(", ")}${more})` : ""}`;
    }
  }
}

function speedName(factor: number | null): string {
  if (factor === null) return "as fast as possible";
  if (factor === 1) return "real time";
  return factor < 1 ? `${factor} times real time, slow motion` : `${factor} times real time`;
}

function rateName(rate: number): string {
  return `${rate >= 100 ? rate.toFixed(0) : rate.toPrecision(2)}×`;
}

/** Index of the step nearest to a speed. */
function nearest(factor: number | null): number {
  if (factor === null) return LAST;
  const distances = SPEEDS.map((speed) => (speed === null ? Infinity : Math.abs(Math.log(speed / factor))));
  return distances.indexOf(Math.min(...distances));
}
